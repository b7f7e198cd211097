//! What a wrapper of the header needs to know: how it calls things, and two functions besides.

use std::fmt::Write;

use crate::expr;
use crate::optimise::{Derivation, FunctionKind, Instruction, Program};
use crate::variable;

use super::super::body::{Body, Component};
use super::super::name::Scope;
use super::super::{Options, item};
use super::expression::Printer;
use super::{Header, Names, block, plain, snake_case};

/// How the header of [`c`](super::c) calls what a mechanism has, and C that is to follow it.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let interface = mbs_derive::emit::c_interface(analysis.programs());
/// assert_eq!((interface.prefix.as_str(), interface.parameters.as_slice()), ("spring", ["k".to_string()].as_slice()));
/// assert_eq!(interface.functions[0].as_deref(), Some("spring_kinetic_energy"));
/// ```
#[derive(Clone, Debug)]
pub struct Interface {
    /// What all names begin with; the struct of the mechanism is called so.
    pub prefix: String,
    /// The derivation's functions; `None` of one that the header has not.
    pub functions: Vec<Option<String>>,
    /// Where each component of the parameters is within the struct of parameters: `length[0]`.
    pub parameters: Vec<String>,
    /// How many sides of comparisons `mbs_switches` gives.
    pub switches: usize,
    /// `mbs_switches(self, t, prescribed, q, qd, u, result)`: of every comparison that forward dynamics makes the left
    /// side less the right one, and the argument of every sign; where a difference is zero, the least number with the
    /// sign of the side that is taken there. `mbs_required(params, result)`: what the parameters' requirements are
    /// about.
    pub definitions: String,
}

/// The [`Interface`] of a mechanism.
pub fn interface(derivation: &Derivation) -> Interface {
    let names = Names::of(derivation, true);
    let prefix = super::prefix(&snake_case(&derivation.name));
    let functions = item::selected(derivation, Options::default().functions.as_deref());
    let is_written = |number: usize| !derivation.functions[number].completion.is_constrained();
    let name = |number: usize| format!("{prefix}_{}", plain(&names.functions[number]));
    let called = (0..derivation.functions.len()).map(|number| is_written(number).then(|| name(number))).collect();
    let header = Header { derivation, names: &names, prefix: prefix.clone(), functions, left_out: Vec::new() };
    let (switches, mut definitions) = header.switches();
    definitions += &header.required();
    Interface {
        functions: called,
        parameters: (0..variable::count(&derivation.parameters)).map(|i| header.field(i)).collect(),
        switches,
        definitions,
        prefix,
    }
}

impl Header<'_> {
    /// The function of the comparisons, and how many there are.
    fn switches(&self) -> (usize, String) {
        let dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        let program = dynamics.map(|function| &function.program);
        let mut sides = Vec::new();
        for instruction in program.into_iter().flat_map(|program| &program.instructions) {
            let side = match *instruction {
                Instruction::Less(a, b) => (a, Some(b), "MBS_TINY"),
                Instruction::LessEqual(a, b) => (a, Some(b), "-MBS_TINY"),
                Instruction::Call(expr::Function::Signum, a) => (a, None, "MBS_TINY"),
                _ => continue,
            };
            if !sides.contains(&side) {
                sides.push(side);
            }
        }
        let operands = sides.iter().flat_map(|&(a, b, _)| std::iter::once(a).chain(b)).collect();
        let of = program.map(|program| Program {
            splines: program.splines.clone(),
            ..Program::new(program.instructions.clone(), operands, Vec::new())
        });
        let of = of.unwrap_or_default();
        let arguments = "mbs_real t, const mbs_real *prescribed, const mbs_real *q, const mbs_real *qd, \
                         const mbs_real *u,\n    mbs_real *result";
        let mut text = format!(
            "#define MBS_TINY 2.2250738585072014e-308\n\n\
             /* What comparisons compare: left less right. */\n\
             static void mbs_switches(\n    const {} *self, {arguments})\n{{\n    (void)self;\n    (void)t;\n",
            self.prefix
        );
        for name in ["prescribed", "q", "qd", "u", "result"] {
            let _ = writeln!(text, "    (void){name};");
        }
        let (body_text, values) = self.computed(&of, self.names.function_scope(), "self->", "self->params.");
        text += &body_text;
        let mut values = values.iter();
        for (k, (_, other, at_zero)) in sides.iter().enumerate() {
            let mut next = || values.next().expect("an operand");
            let difference = match other {
                Some(_) => format!("({}) - ({})", next(), next()),
                None => next().clone(),
            };
            let _ = writeln!(text, "    result[{k}] = {difference};");
            let _ = writeln!(text, "    if (!(result[{k}] < 0.0 || result[{k}] > 0.0)) result[{k}] = {at_zero};");
        }
        (sides.len(), text + "}\n\n")
    }

    /// The function of what the requirements are about.
    fn required(&self) -> String {
        let mut text = format!(
            "/* What the requirements on parameters are about. */\n\
             static void mbs_required(const {}_parameters *params, mbs_real *result)\n{{\n    (void)params;\n    (void)result;\n",
            self.prefix
        );
        let (body, values) = self.computed(&self.derivation.required, self.names.constructor_scope(), "", "params->");
        text += &body;
        for (k, value) in values.iter().enumerate() {
            let _ = writeln!(text, "    result[{k}] = {value};");
        }
        text + "}\n\n"
    }

    /// A program's statements, and its results.
    fn computed(&self, program: &Program, scope: Scope, own: &'static str, params: &str) -> (String, Vec<String>) {
        let all = (0..program.results.len()).map(|i| Component::Result(i, String::new()));
        let body = Body::new(program, &all.collect::<Vec<_>>(), self.names, scope);
        let printer = Printer { body: &body, table: &|number| self.table(number), own };
        let text = self.symbols(&body, params) + &block(&body.block, &printer, 1);
        (text, body.block.results.iter().map(|tree| printer.tree(tree)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comparisons_are_differences() {
        let graph = crate::expr::Graph::verbatim();
        let text = "mechanism Stop { param k: N/m = 4; param edge: m = 1; coord x: m; kinetic += 1 kg*dt(x)^2/2; \
                    force x += if x < edge { 0 } else { -k*(x - edge) } - k*edge*signum(dt(x)); }";
        let sources = crate::source::Sources::new("stop.mbs", text);
        let interface = interface(crate::Analysis::of(&sources, &graph).unwrap().programs());
        assert_eq!(interface.switches, 2, "{}", interface.definitions);
        assert!(interface.definitions.contains("result[0] = (x) - (edge);"), "{}", interface.definitions);
    }
}
