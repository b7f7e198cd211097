//! Parameters, their defaults, what they must satisfy, and what depends on them alone.

use std::fmt::Write;

use crate::model::requirement::Condition;
use crate::variable::Variable;

use super::super::body::{Body, Component};
use super::super::doc;
use super::expression::{Printer, constant, identifier};
use super::{Header, block, comment, head};

impl Header<'_> {
    /// The struct of parameters, their defaults, and the struct of the mechanism.
    pub(super) fn parameters(&self) -> String {
        let (prefix, parameters) = (&self.prefix, &self.derivation.parameters);
        let mut text = comment(&[format!("Parameters of {}.", self.derivation.name)], "");
        let _ = writeln!(text, "typedef struct {prefix}_parameters {{");
        for (parameter, field) in parameters.iter().zip(&self.names.fields) {
            text += &comment(&doc::parameter(parameter), "    ");
            let lengths: String = parameter.lengths().iter().map(|n| format!("[{n}]")).collect();
            let _ = writeln!(text, "    mbs_real {}{lengths};", identifier(field));
        }
        if parameters.is_empty() {
            text += "    /** There are none. */\n    mbs_real none;\n";
        }
        let _ = writeln!(text, "}} {prefix}_parameters;\n");

        text += &comment(&["The declared parameters.".to_string()], "");
        let _ = writeln!(text, "MBS_FN {prefix}_parameters {prefix}_default_parameters(void)\n{{");
        let _ = writeln!(text, "    const {prefix}_parameters params = {{");
        for parameter in parameters {
            let _ = writeln!(text, "        {},", defaults(parameter));
        }
        if parameters.is_empty() {
            text += "        MBS_C(0.0),\n";
        }
        text += "    };\n    return params;\n}\n\n";

        text += &comment(&["Parameters, and what depends on them alone.".to_string()], "");
        let _ = writeln!(text, "typedef struct {prefix} {{\n    {prefix}_parameters params;");
        for k in self.hoisted() {
            let _ = writeln!(text, "    mbs_real {};", identifier(&self.names.hoisted[k]));
        }
        let _ = writeln!(text, "}} {prefix};\n");
        text
    }

    /// Where a parameter's component is within the struct.
    pub(super) fn field(&self, i: usize) -> String {
        let parameters = self.derivation.parameters.iter().zip(&self.names.fields);
        let (parameter, field) =
            parameters.into_iter().find(|(parameter, _)| parameter.contains(i)).expect("a parameter of this number");
        let (field, i) = (identifier(field), i - parameter.first);
        match (parameter.length, parameter.columns) {
            (None, _) => field,
            (Some(_), None) => format!("{field}[{i}]"),
            (Some(_), Some(columns)) => format!("{field}[{}][{}]", i / columns, i % columns),
        }
    }

    /// `NAME_check`: what `Params::check` is in Rust.
    pub(super) fn check(&self) -> String {
        let prefix = &self.prefix;
        let mut docs = doc::requirements(self.derivation);
        let errors = docs.iter().position(|line| line == "# Errors").unwrap_or(docs.len());
        docs.truncate(errors);
        docs.push(
            "0, or what does not hold first, one of MBS_FINITE and so on; `quantity` and `value` receive of what."
                .to_string(),
        );
        let mut text = comment(&docs, "");
        let arguments = [
            format!("const {prefix}_parameters *params"),
            "MBS_TEXT const char **quantity".to_string(),
            "mbs_real *value".to_string(),
        ];
        text += &head(&format!("MBS_FN int {prefix}_check"), &arguments);
        text += "    int error = 0;\n    (void)params;\n    *quantity = \"\";\n    *value = MBS_C(0.0);\n";
        for parameter in &self.derivation.parameters {
            for (i, name) in parameter.component_names().iter().enumerate() {
                let field = self.field(parameter.first + i);
                text += &require("MBS_FINITE", name, &format!("params->{field}"));
            }
        }
        text + &self.required() + "    return error;\n}\n\n"
    }

    /// The conditions on expressions of parameters.
    fn required(&self) -> String {
        let program = &self.derivation.required;
        let components: Vec<Component> =
            (0..program.results.len()).map(|k| Component::Result(k, String::new())).collect();
        if components.is_empty() {
            return String::new();
        }
        let body = Body::new(program, &components, self.names, self.names.constructor_scope());
        let printer = Printer { body: &body, header: self, own: "self." };
        let mut text = String::from("    if (error) {\n        return error;\n    }\n");
        text += &self.symbols(&body, "params->");
        text += &block(&body.block, &printer, 1);
        let values: Vec<String> = body.block.results.iter().map(|tree| printer.tree(tree)).collect();
        for (number, (requirement, values)) in self.derivation.conditions(&values).enumerate() {
            let (quantity, condition) = (&requirement.quantity, condition(requirement.condition));
            match values {
                [value] => text += &require(condition, quantity, value),
                _ => {
                    let (name, values) = (format!("mbs_inertia_{number}"), values.join(", "));
                    let _ = writeln!(text, "    const mbs_real {name}[6] = {{{values}}};");
                    let call = format!("mbs_require_inertia({condition}, {quantity:?}, {name}, quantity, value)");
                    let _ = writeln!(text, "    error = error ? error : {call};");
                }
            }
        }
        text
    }

    pub(super) fn constructor(&self) -> String {
        let (prefix, hoisted) = (&self.prefix, self.hoisted());
        let components: Vec<Component> =
            hoisted.iter().map(|&k| Component::Result(k, self.names.hoisted[k].clone())).collect();
        let body = Body::new(&self.derivation.constructor, &components, self.names, self.names.constructor_scope());
        let docs = format!("The mechanism with these parameters, which are not looked at: {prefix}_check does that.");
        let mut text = comment(&[docs], "");
        let _ = writeln!(text, "MBS_FN {prefix} {prefix}_new(const {prefix}_parameters *params)\n{{");
        let _ = writeln!(text, "    {prefix} self;");
        let printer = Printer { body: &body, header: self, own: "self." };
        text += &self.symbols(&body, "params->");
        text += &block(&body.block, &printer, 1);
        text += "    self.params = *params;\n";
        for (&k, tree) in hoisted.iter().zip(&body.block.results) {
            let _ = writeln!(text, "    self.{} = {};", identifier(&self.names.hoisted[k]), printer.tree(tree));
        }
        text += "    return self;\n}\n\n";
        text
    }
}

/// A parameter's declared value, as an initializer.
fn defaults(parameter: &Variable) -> String {
    let values: Vec<String> = parameter.defaults.iter().map(|value| constant(value.to_f64())).collect();
    match (parameter.length, parameter.columns) {
        (None, _) => values[0].clone(),
        (Some(_), None) => format!("{{{}}}", values.join(", ")),
        (Some(_), Some(columns)) => {
            let rows: Vec<String> = values.chunks(columns).map(|row| format!("{{{}}}", row.join(", "))).collect();
            format!("{{{}}}", rows.join(", "))
        }
    }
}

fn require(condition: &str, quantity: &str, value: &str) -> String {
    format!("    error = error ? error : mbs_require({condition}, {quantity:?}, {value}, quantity, value);\n")
}

fn condition(condition: Condition) -> &'static str {
    match condition {
        Condition::Finite => "MBS_FINITE",
        Condition::NotZero => "MBS_NOT_ZERO",
        Condition::NotNegative => "MBS_NOT_NEGATIVE",
        Condition::Positive => "MBS_POSITIVE",
        Condition::SemiDefinite => "MBS_SEMI_DEFINITE",
        Condition::InertiaOfABody => "MBS_INERTIA_OF_A_BODY",
    }
}
