//! The functions of a mechanism.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::expr::Symbol;
use crate::optimise::{Argument, Completion, Function, FunctionKind};
use crate::shape::Shape;
use crate::variable;

use super::super::body::Body;
use super::super::expression::Tree;
use super::super::text::each_leaf;
use super::super::{doc, item, shape};
use super::expression::{Printer, identifier};
use super::{Header, assigned, block, comment, head};

/// What a function takes and gives.
pub(super) struct Signature {
    pub(super) name: String,
    /// Names of arguments, and how many numbers each is; a number has none.
    pub(super) arguments: Vec<(&'static str, Option<usize>)>,
    /// Names of results, and how many numbers each is; none where a number is returned.
    pub(super) outputs: Vec<(String, usize)>,
    pub(super) returns: bool,
}

impl Header<'_> {
    pub(super) fn signature(&self, number: usize, function: &Function) -> Signature {
        let returns = matches!(function.results.as_slice(), [part] if part.shape == Shape::Scalar);
        let parts = function.results.iter().filter(|_| !returns).map(|part| {
            let name = if part.name.is_empty() { "result".to_string() } else { format!("by_{}", part.name) };
            (name, entries(part.shape))
        });
        let name = format!("{}_{}", self.prefix, plain(&self.names.functions[number]));
        let outputs = parts.filter(|(_, count)| *count > 0).collect();
        Signature { name, arguments: self.arguments(function), outputs, returns }
    }

    pub(super) fn function(&self, number: usize, function: &Function) -> String {
        let signature = self.signature(number, function);
        let results = signature.outputs.iter().map(|(name, count)| format!("mbs_real {name}[{count}]"));
        let declared: Vec<String> = self.declared(&signature.arguments).chain(results).collect();
        let kind = if signature.returns { "mbs_real" } else { "void" };
        let mut text = comment(&doc::function(self.derivation, function), "");
        text += &head(&format!("MBS_FN {kind} {}", signature.name), &declared);
        text += &unused(&signature.arguments);
        text += &self.body(function, &signature);
        text + "}\n\n"
    }

    /// The mechanism and the arguments as they are declared.
    pub(super) fn declared(&self, arguments: &[(&'static str, Option<usize>)]) -> impl Iterator<Item = String> {
        let inputs = arguments.iter().map(|(name, count)| match count {
            None => format!("mbs_real {name}"),
            Some(count) => format!("const mbs_real {name}[{count}]"),
        });
        std::iter::once(format!("const {} *self", self.prefix)).chain(inputs)
    }

    pub(super) fn arguments(&self, function: &Function) -> Vec<(&'static str, Option<usize>)> {
        let signals = variable::count(&self.derivation.prescribed);
        let time = self.derivation.depends_on_time.then_some(("t", None));
        let prescribed = (signals > 0).then_some(("prescribed", Some(3 * signals)));
        let state = function.arguments.iter().filter_map(|&argument| {
            let count = match argument {
                Argument::Q | Argument::Qd | Argument::Qdd => self.derivation.dof(),
                Argument::U => variable::count(&self.derivation.inputs),
                Argument::Multipliers => self.derivation.constraints.len(),
            };
            (count > 0).then_some((argument.name(), Some(count)))
        });
        time.into_iter().chain(prescribed).chain(state).collect()
    }

    fn body(&self, function: &Function, signature: &Signature) -> String {
        let (arguments, outputs) = (&signature.arguments, &signature.outputs);
        match (&function.kind, function.completion) {
            (_, Completion::None) => {
                let (text, values) = self.statements(function);
                text + &returned(&values, signature)
            }
            (_, Completion::Solve) => {
                let calls_dynamics = item::calls_forward_dynamics(function);
                let accelerations = if calls_dynamics { self.accelerations(arguments) } else { String::new() };
                let (text, values) = self.statements(function);
                accelerations + &text + &self.solved(&values, outputs)
            }
            (FunctionKind::ForwardDynamics, Completion::SolveConstrained) => {
                let k = self.derivation.constraints.len();
                format!("    mbs_real multipliers[{k}];\n{}", self.motion(arguments, "result", "multipliers"))
            }
            (_, Completion::SolveMultipliers) => {
                format!("    mbs_real qdd[{}];\n{}", self.derivation.dof(), self.motion(arguments, "qdd", "result"))
            }
            (_, Completion::SolveConstrained) => self.constrained_slopes(function, signature),
        }
    }

    /// The statements of a function's program, and its values.
    pub(super) fn statements(&self, function: &Function) -> (String, Vec<String>) {
        let components = shape::components(self.derivation, function);
        let body = Body::new(&function.program, &components, self.names, self.names.function_scope());
        let printer = Printer { body: &body, header: self, own: "self->" };
        let text = self.symbols(&body, "self->params.") + &block(&body.block, &printer, 1);
        (text, body.block.results.iter().map(|tree| printer.tree(tree)).collect())
    }

    /// The accelerations at which a linearization is evaluated.
    fn accelerations(&self, arguments: &[(&'static str, Option<usize>)]) -> String {
        let is_called = |(_, f): &&(usize, &Function)| f.kind == FunctionKind::ForwardDynamics;
        let (number, _) = self.functions.iter().find(is_called).expect("it was selected");
        let given: Vec<&str> = std::iter::once("self").chain(arguments.iter().map(|(name, _)| *name)).collect();
        let name = format!("{}_{}", self.prefix, plain(&self.names.functions[*number]));
        format!("    mbs_real qdd[{}];\n    {name}({}, qdd);\n", self.derivation.dof(), given.join(", "))
    }

    /// Locals for the components of arguments and parameters that a body reads.
    pub(super) fn symbols(&self, body: &Body<'_>, params: &str) -> String {
        let mut symbols = BTreeSet::new();
        each_leaf(body.block.trees().into_iter(), &mut |leaf| {
            if let Tree::Symbol(symbol) = leaf {
                symbols.insert(*symbol);
            }
        });
        let mut text = String::new();
        for symbol in symbols {
            let from = match symbol {
                Symbol::Time => continue,
                Symbol::Coordinate(i) => format!("q[{i}]"),
                Symbol::Velocity(i) => format!("qd[{i}]"),
                Symbol::Acceleration(i) => format!("qdd[{i}]"),
                Symbol::Input(i) => format!("u[{i}]"),
                Symbol::Prescribed(i, order) => format!("prescribed[{}]", 3 * i + u32::from(order)),
                Symbol::Multiplier(i) => format!("multipliers[{i}]"),
                Symbol::Parameter(i) => format!("{params}{}", self.field(i as usize)),
            };
            let _ = writeln!(text, "    const mbs_real {} = {from};", identifier(self.names.symbol(symbol)));
        }
        text
    }
}

/// Compilers are told that an argument may not be read.
pub(super) fn unused(arguments: &[(&'static str, Option<usize>)]) -> String {
    let rest: String = arguments.iter().map(|(name, _)| format!("    (void){name};\n")).collect();
    format!("    (void)self;\n{rest}")
}

/// What a function returns or writes.
fn returned(values: &[String], signature: &Signature) -> String {
    if signature.returns {
        return format!("    return {};\n", values[0]);
    }
    let mut values = values.iter();
    signature.outputs.iter().map(|(name, count)| assigned(name, values.by_ref().take(*count))).collect()
}

/// How many numbers a function returns in this shape.
fn entries(shape: Shape) -> usize {
    match shape {
        Shape::Symmetric(n) => n * n,
        other => other.count(),
    }
}

/// The name of a function after the prefix, where nothing has to be escaped and the header's own names are taken.
pub(super) fn plain(name: &str) -> String {
    let plain = name.strip_prefix("r#").unwrap_or(name);
    let own = ["parameters", "default_parameters", "check", "new", "constrained_solution"];
    let is_taken = own.contains(&plain) || plain.starts_with("table_") || plain.ends_with("_kernel");
    if is_taken { format!("{plain}_2") } else { plain.to_string() }
}
