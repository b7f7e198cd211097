//! What a wrapper of the header needs to know: how it calls things, and the comparisons that forward dynamics makes.

use std::fmt::Write;

use crate::expr;
use crate::optimise::{Derivation, FunctionKind, Instruction, Program};
use crate::variable;

use super::super::body::{Body, Component};
use super::super::{Options, item};
use super::expression::Printer;
use super::function::plain;
use super::{Dialect, Header, Names, block, snake_case};

/// How the header of [`c`](super::c) calls what a mechanism has, and a function that is to follow it.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let interface = mbs_derive::emit::c_interface(analysis.programs());
/// assert_eq!((interface.prefix.as_str(), interface.parameters.as_slice()), ("spring", ["k".to_string()].as_slice()));
/// assert_eq!(interface.functions[0], "spring_kinetic_energy");
/// ```
#[derive(Clone, Debug)]
pub struct Interface {
    /// What all names begin with; the struct of the mechanism is called so.
    pub prefix: String,
    /// The derivation's functions.
    pub functions: Vec<String>,
    /// Where each component of the parameters is within the struct of parameters: `length[0]`.
    pub parameters: Vec<String>,
    /// How many sides of comparisons `mbs_switches` gives.
    pub switches: usize,
    /// `mbs_switches(self, t, prescribed, q, qd, u, result)`: of every comparison that forward dynamics makes the left
    /// side less the right one, and the argument of every sign; where a difference is zero, the least number with the
    /// sign of the side that is taken there.
    pub definitions: String,
}

/// The [`Interface`] of a mechanism.
pub fn interface(derivation: &Derivation) -> Interface {
    let names = Names::of(derivation, true);
    let prefix = super::prefix(&snake_case(&derivation.name));
    let functions = item::selected(derivation, Options::default().functions.as_deref());
    let name = |number: usize| format!("{prefix}_{}", plain(&names.functions[number]));
    let header = Header { derivation, names: &names, prefix: prefix.clone(), functions, dialect: Dialect::C };
    let (switches, definitions) = header.switches();
    Interface {
        functions: (0..derivation.functions.len()).map(name).collect(),
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
        let all: Vec<Component> = (0..of.results.len()).map(|i| Component::Result(i, String::new())).collect();
        let body = Body::new(&of, &all, self.names, self.names.function_scope());
        let printer = Printer { body: &body, table: &|number| self.table(number), own: "self->" };
        text += &self.symbols(&body, "self->params.");
        text += &block(&body.block, &printer, 1);
        let mut values = body.block.results.iter().map(|tree| printer.tree(tree));
        for (k, (_, other, at_zero)) in sides.iter().enumerate() {
            let mut next = || values.next().expect("an operand");
            let difference = match other {
                Some(_) => format!("({}) - ({})", next(), next()),
                None => next(),
            };
            let _ = writeln!(text, "    result[{k}] = {difference};");
            let _ = writeln!(text, "    if (!(result[{k}] < 0.0 || result[{k}] > 0.0)) result[{k}] = {at_zero};");
        }
        (sides.len(), text + "}\n\n")
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
