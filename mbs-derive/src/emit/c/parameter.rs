//! Parameters, their defaults, what they must satisfy, and what depends on them alone.

use std::fmt::Write;

use crate::model::requirement::Condition;

use super::super::doc;
use super::super::walk::{Syntax, block_comment, defaults};
use super::name::identifier;
use super::syntax::constant;
use super::{Header, head, inside};

impl Header<'_> {
    /// The struct of parameters, their defaults, and the struct of the mechanism.
    pub(super) fn parameters(&self) -> String {
        let (prefix, parameters) = (&self.prefix, &self.derivation.parameters);
        let mut text = block_comment(&[format!("Parameters of {}.", self.derivation.name)], 0);
        let _ = writeln!(text, "typedef struct {prefix}_parameters {{");
        for (parameter, field) in self.walk.parameters() {
            text += &block_comment(&doc::parameter(parameter), 4);
            let lengths: String = parameter.lengths().iter().map(|n| format!("[{n}]")).collect();
            let _ = writeln!(text, "    mbs_real {}{lengths};", identifier(&field));
        }
        if parameters.is_empty() {
            text += "    /** There are none. */\n    mbs_real none;\n";
        }
        let _ = writeln!(text, "}} {prefix}_parameters;\n");

        text += &block_comment(&["The declared parameters.".to_string()], 0);
        let _ = writeln!(text, "MBS_FN {prefix}_parameters {prefix}_default_parameters(void)\n{{");
        let _ = writeln!(text, "    const {prefix}_parameters params = {{");
        for parameter in parameters {
            let list = |values: &[String]| format!("{{{}}}", values.join(", "));
            let _ = writeln!(text, "        {},", defaults(parameter, &constant, &list));
        }
        if parameters.is_empty() {
            text += "        MBS_C(0.0),\n";
        }
        text += "    };\n    return params;\n}\n\n";

        text += &block_comment(&["Parameters, and what depends on them alone.".to_string()], 0);
        let _ = writeln!(text, "typedef struct {prefix} {{\n    {prefix}_parameters params;");
        for k in self.walk.hoisted() {
            let _ = writeln!(text, "    mbs_real {};", identifier(&self.walk.names.hoisted[k]));
        }
        let _ = writeln!(text, "}} {prefix};\n");
        text
    }

    /// Where a parameter's component is, seen from a pointer to the parameters.
    pub(super) fn field(&self, i: usize) -> String {
        let field = self.in_constructor().read(&self.walk.parameter(i));
        field.strip_prefix("params->").map_or(field.clone(), str::to_string)
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
        let mut text = block_comment(&docs, 0);
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
        let (lines, values) = self.walk.required(&self.in_constructor());
        if values.is_empty() {
            return String::new();
        }
        let mut text = String::from("    if (error) {\n        return error;\n    }\n");
        text += &inside(&lines);
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
        let prefix = &self.prefix;
        let (lines, hoisted) = self.walk.constructor(&self.in_constructor());
        let docs = format!("The mechanism with these parameters, which are not looked at: {prefix}_check does that.");
        let mut text = block_comment(&[docs], 0);
        let _ = writeln!(text, "MBS_FN {prefix} {prefix}_new(const {prefix}_parameters *params)\n{{");
        let _ = writeln!(text, "    {prefix} self;");
        text += &inside(&lines);
        text += "    self.params = *params;\n";
        for (name, value) in &hoisted {
            let _ = writeln!(text, "    self.{} = {value};", identifier(name));
        }
        text += "    return self;\n}\n\n";
        text
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
