//! What a wrapper of the header needs to know: how it calls things, and the comparisons that forward dynamics makes.

use std::fmt::Write;

use crate::expr::{self, Number, Symbol};
use crate::optimise::{Derivation, FunctionKind, Instruction, Program, Value};
use crate::variable::{self, Variable};

use super::super::Options;
use super::super::body::Component;
use super::super::walk::Walk;
use super::{Dialect, Header, inside};

/// A header of C for those who integrate from event to event, how it calls things, and C that is to follow it.
///
/// Forward dynamics compares what it is told: behind the inputs u has a number for each comparison, negative where the
/// left side is less. So the equations stay smooth until an event changes that number, however far a step of an
/// integrator looks ahead.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let interface = mbs_derive::emit::Interface::of(analysis.programs(), "spring.mbs");
/// assert_eq!((interface.prefix.as_str(), interface.parameters.as_slice()), ("spring", ["k".to_string()].as_slice()));
/// assert_eq!(interface.functions[0], "spring_kinetic_energy");
/// ```
#[derive(Clone, Debug)]
pub struct Interface {
    /// The header.
    pub header: String,
    /// What all names begin with; the struct of the mechanism is called so.
    pub prefix: String,
    /// The derivation's functions.
    pub functions: Vec<String>,
    /// Where each component of the parameters is within the struct of parameters: `length[0]`.
    pub parameters: Vec<String>,
    /// How many comparisons forward dynamics makes.
    pub comparisons: usize,
    /// How many numbers `mbs_fmu_switches` gives: those of comparisons, then those of signs.
    pub switches: usize,
    /// `mbs_fmu_switches(self, t, prescribed, q, qd, u, result)`: of every comparison the left side less the right one,
    /// and the argument of every sign; where a difference is zero, the least number with the sign of the side that is
    /// taken there.
    pub definitions: String,
    /// The mechanism whose forward dynamics is told which comparisons hold.
    pub(crate) told: Derivation,
}

impl Interface {
    /// Of a mechanism; `source` is what the header's first line calls the declaration.
    pub fn of(derivation: &Derivation, source: &str) -> Interface {
        let dynamics = derivation.function(FunctionKind::ForwardDynamics).map(|function| &function.program);
        let dynamics = dynamics.cloned().unwrap_or_default();
        let sides = Sides::of(&dynamics);
        let told = sides.told(derivation);
        let header = Header::new(Walk::new(&told, source, &Options::default()), Dialect::C);
        let (text, definitions) = (header.written(), header.switches(&dynamics, &sides));
        let functions = header.walk.names.functions.iter().map(|function| header.name(function)).collect();
        let parameters = (0..variable::count(&derivation.parameters)).map(|i| header.field(i)).collect();
        Interface {
            header: text,
            functions,
            parameters,
            comparisons: sides.comparisons.len(),
            switches: sides.comparisons.len() + sides.signs.len(),
            definitions,
            prefix: header.prefix,
            told,
        }
    }
}

/// What a program compares: each pair of values once, and whether they may be equal.
struct Sides {
    comparisons: Vec<(Value, Value, bool)>,
    signs: Vec<Value>,
}

impl Sides {
    fn of(program: &Program) -> Self {
        let mut sides = Sides { comparisons: Vec::new(), signs: Vec::new() };
        for instruction in &program.instructions {
            match comparison(*instruction) {
                Some(comparison) if !sides.comparisons.contains(&comparison) => sides.comparisons.push(comparison),
                None => {
                    if let Instruction::Call(expr::Function::Signum, a) = *instruction
                        && !sides.signs.contains(&a)
                    {
                        sides.signs.push(a);
                    }
                }
                Some(_) => {}
            }
        }
        sides
    }

    /// A mechanism whose forward dynamics is told which comparisons hold, by inputs behind its own.
    fn told(&self, derivation: &Derivation) -> Derivation {
        let mut told = derivation.clone();
        let count = self.comparisons.len();
        if count == 0 {
            return told;
        }
        let mut name = "side".to_string();
        while derivation.inputs.iter().any(|input| input.name.starts_with(&name)) {
            name += "_";
        }
        let first = variable::count(&derivation.inputs);
        told.altered().inputs.push(Variable {
            name,
            docs: vec!["Which side of each comparison is less: negative, if it is the left one.".to_string()],
            unit: "1".to_string(),
            length: Some(count),
            columns: None,
            first,
            defaults: Vec::new(),
            declared_unit: None,
            positive: false,
        });
        for function in told.altered().functions.iter_mut().filter(|f| f.kind == FunctionKind::ForwardDynamics) {
            function.program = self.replaced(&function.program, first);
        }
        told
    }

    /// The program with inputs from this number on in the place of comparisons.
    fn replaced(&self, program: &Program, first: usize) -> Program {
        let count = self.comparisons.len();
        let behind = |value: Value| Value((value.index() + count + 1) as u32);
        let mut instructions: Vec<Instruction> =
            (0..count).map(|k| Instruction::Symbol(Symbol::Input((first + k) as u32))).collect();
        instructions.push(Instruction::Constant(Number::ZERO));
        let number = |k: usize| Value(k as u32);
        instructions.extend(program.instructions.iter().map(|&instruction| {
            let known = comparison(instruction).and_then(|own| self.comparisons.iter().position(|one| *one == own));
            match known {
                Some(k) => Instruction::Less(number(k), number(count)),
                None => instruction.with_operands(behind),
            }
        }));
        let results = program.results.iter().map(|&value| behind(value)).collect();
        let notes = program.notes.iter().map(|(value, name)| (behind(*value), name.clone())).collect();
        Program { splines: program.splines.clone(), ..Program::new(instructions, results, notes) }
    }
}

fn comparison(instruction: Instruction) -> Option<(Value, Value, bool)> {
    match instruction {
        Instruction::Less(a, b) => Some((a, b, false)),
        Instruction::LessEqual(a, b) => Some((a, b, true)),
        _ => None,
    }
}

impl Header<'_> {
    /// The function of what a program compares.
    fn switches(&self, program: &Program, sides: &Sides) -> String {
        let operands = sides.comparisons.iter().flat_map(|&(a, b, _)| [a, b]).chain(sides.signs.iter().copied());
        let of = Program::new(program.instructions.clone(), operands.collect(), Vec::new());
        let of = Program { splines: program.splines.clone(), ..of };
        let mut text = format!(
            "#define MBS_TINY 2.2250738585072014e-308\n\n\
             /* What comparisons compare: left less right. */\n\
             static void mbs_fmu_switches(\n    const {} *self, mbs_real t, const mbs_real *prescribed, const mbs_real *q, \
             const mbs_real *qd, const mbs_real *u,\n    mbs_real *result)\n{{\n",
            self.prefix
        );
        for name in ["self", "t", "prescribed", "q", "qd", "u", "result"] {
            let _ = writeln!(text, "    (void){name};");
        }
        let all: Vec<Component> = (0..of.results.len()).map(|i| Component::Result(i, String::new())).collect();
        let (lines, values) = self.walk.evaluated(&of, &all, self.walk.names.function_scope(), &self.in_function());
        text += &inside(&lines);
        let (pairs, signs) = values.split_at(2 * sides.comparisons.len());
        let differences = pairs.chunks(2).zip(&sides.comparisons).map(|(pair, (_, _, equal_too))| {
            (format!("({}) - ({})", pair[0], pair[1]), if *equal_too { "-MBS_TINY" } else { "MBS_TINY" })
        });
        let all = differences.chain(signs.iter().map(|sign| (sign.clone(), "MBS_TINY")));
        for (k, (difference, at_zero)) in all.enumerate() {
            let _ = writeln!(text, "    result[{k}] = {difference};");
            let _ = writeln!(text, "    if (!(result[{k}] < 0.0 || result[{k}] > 0.0)) result[{k}] = {at_zero};");
        }
        text + "}\n\n"
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
        let interface = Interface::of(crate::Analysis::of(&sources, &graph).unwrap().programs(), "stop.mbs");
        assert_eq!((interface.comparisons, interface.switches), (1, 2), "{}", interface.definitions);
        assert!(interface.definitions.contains("result[0] = (x) - (edge);"), "{}", interface.definitions);
        let (_, dynamics) = interface.header.split_once("stop_forward_dynamics(").unwrap();
        let (dynamics, _) = dynamics.split_once("\n}").unwrap();
        assert!(dynamics.contains("side_0 < MBS_C(0.0)") && !dynamics.contains("x < edge"), "{dynamics}");
    }
}
