//! Programs with one small mistake each, which must be refused unless they compute the same.

use super::super::Proof;
use super::*;
use crate::expr::{Function, Graph, Number};
use crate::interpret::Interpreter;
use crate::numeric::Random;
use crate::optimise::{FunctionKind, Instruction, Program, Value as Step};
use crate::source::Sources;

/// The mistakes.
const KINDS: [&str; 10] =
    ["operation", "operand", "sign", "dropped term", "constant", "exponent", "function", "branch", "result", "hoisted"];

/// How many mutants of a mechanism are tried, unless `MBS_MUTANTS` says how many.
const TRIED: usize = 40;

struct Mutants<'a> {
    derivation: &'a Derivation,
    random: Random,
}

impl Mutants<'_> {
    fn below(&mut self, count: usize) -> usize {
        ((self.random.symmetric() + 1.0) / 2.0 * count as f64) as usize % count
    }

    /// A derivation with one mistake of a kind, and where it is: the number of a function, that of the constructor
    /// last.
    fn next(&mut self, kind: &str) -> Option<(Derivation, usize)> {
        let functions = self.derivation.functions.len();
        let at = self.below(functions + 1);
        let mut mutant = self.derivation.clone();
        let parts = mutant.altered();
        let program = if at == functions { &mut parts.constructor } else { &mut parts.functions[at].program };
        self.change(program, kind, self.derivation.constructor.results.len()).then_some((mutant, at))
    }

    fn change(&mut self, program: &mut Program, kind: &str, hoisted: usize) -> bool {
        if program.instructions.is_empty() || program.results.is_empty() {
            return false;
        }
        if kind == "result" {
            let [a, b] = [self.below(program.results.len()), self.below(program.results.len())];
            program.results.swap(a, b);
            return program.results[a] != program.results[b];
        }
        let at = self.below(program.instructions.len());
        let changed = match (kind, program.instructions[at]) {
            ("operation", Instruction::Add(a, b)) => Instruction::Mul(a, b),
            ("operation", Instruction::Sub(a, b)) => Instruction::Add(a, b),
            ("operation", Instruction::Mul(a, b)) => Instruction::Add(a, b),
            ("operation", Instruction::Div(a, b)) => Instruction::Mul(a, b),
            ("sign", Instruction::Add(a, b)) => Instruction::Sub(a, b),
            ("sign", Instruction::Sub(a, b)) => Instruction::Sub(b, a),
            ("sign", Instruction::Neg(a)) => program.instructions[a.index()],
            ("dropped term", Instruction::Add(a, b) | Instruction::Sub(a, b) | Instruction::Mul(a, b)) => {
                program.instructions[if self.below(2) == 0 { a } else { b }.index()]
            }
            ("constant", Instruction::Constant(number)) => {
                let Some(other) = Number::from_f64(number.to_f64() * (1.0 + 2f64.powi(-40))) else { return false };
                Instruction::Constant(other)
            }
            ("exponent", Instruction::Mul(a, b)) if a == b => program.instructions[a.index()],
            ("exponent", Instruction::Sqrt(a)) => program.instructions[a.index()],
            ("function", Instruction::Call(Function::Sin, a)) => Instruction::Call(Function::Cos, a),
            ("function", Instruction::Call(Function::Cos, a)) => Instruction::Call(Function::Sin, a),
            ("branch", Instruction::Select(condition, a, b)) => Instruction::Select(condition, b, a),
            ("branch", Instruction::Less(a, b)) => Instruction::Less(b, a),
            ("branch", Instruction::LessEqual(a, b)) => Instruction::LessEqual(b, a),
            ("branch", Instruction::And(a, _) | Instruction::Not(a)) => program.instructions[a.index()],
            ("hoisted", Instruction::Hoisted(k)) => {
                let other = self.below(hoisted) as u32;
                if other == k { return false } else { Instruction::Hoisted(other) }
            }
            ("operand", instruction) if instruction.operands().count() > 0 && at > 0 => {
                let (chosen, other) = (instruction.operands().next(), Step(self.below(at) as u32));
                instruction.with_operands(|operand| if Some(operand) == chosen { other } else { operand })
            }
            _ => return false,
        };
        let is_changed = changed != program.instructions[at];
        program.instructions[at] = changed;
        is_changed
    }
}

/// Whether two derivations compute the same where one of them was changed, at a point at which there is something to
/// compute.
fn is_equivalent((state, parameters): &Point<Image<2>>, original: &Derivation, mutant: &Derivation, at: usize) -> bool {
    let multipliers: Vec<_> = (0..original.constraints.len()).map(|k| Image::multiplier(state.t, k)).collect();
    let values = |derivation: &Derivation| {
        let interpreter = Interpreter::with_parameters(derivation, parameters.clone());
        let functions = derivation.functions.iter().enumerate();
        let chosen = functions.filter(|(number, _)| at == derivation.functions.len() || *number == at);
        chosen.flat_map(|(_, function)| interpreter.values(function, state, &multipliers)).collect::<Vec<_>>()
    };
    values(original).iter().zip(&values(mutant)).all(|(a, b)| a.is_equal(*b) || !a.is_defined() && !b.is_defined())
}

/// How many mutants of each kind are refused, hold what is claimed all the same, or survive.
fn score(name: &str, sources: &Sources, tried: usize) -> Vec<[usize; 3]> {
    let graph = Graph::verbatim();
    let analysis = crate::Analysis::of(sources, &graph).unwrap();
    let (witness, derivation) = (Witness::new(analysis.lagrangian()), analysis.programs());
    let nodes = Nodes::of(&witness, derivation);
    let roots = nodes.obstacle(&witness, |number| nth_point(&witness, number)).unwrap();
    let known = Field::of::<1>(&witness, derivation, roots, None).outcomes;
    let points = (0x4000..0x8000).map(|number| nth_point(&witness, number));
    let point = points.into_iter().find(|point| is_defined(&witness, point)).expect("a point with roots");
    let mut mutants = Mutants { derivation, random: Random::new(0x6d75_7461) };
    let mut table = vec![[0; 3]; KINDS.len()];
    let (mut found, mut drawn) = (0, 0);
    while found < tried {
        let number = drawn % KINDS.len();
        drawn += 1;
        assert!(drawn < 1000 * tried, "{name}: there is little to change");
        let Some((mutant, at)) = mutants.next(KINDS[number]) else { continue };
        found += 1;
        // One field is enough, without conditions; what is left to doubles, the whole proof refuses.
        let fails = || {
            let outcomes = Field::of::<1>(&witness, &mutant, roots, None).outcomes;
            known.iter().zip(outcomes).any(|(&known, found)| known == Outcome::Holds && found != Outcome::Holds)
        };
        let is_refused = || !nodes.has_choices && fails() || Proof::of(analysis.lagrangian(), &mutant).is_err();
        // Of `conserved` is claimed that it does not change: with a constant term dropped it is as good.
        let is_integral = derivation.functions.get(at).is_some_and(|function| function.kind == FunctionKind::Conserved);
        let column = match is_equivalent(&point, derivation, &mutant, at) {
            true => 1,
            false if is_refused() => 0,
            false if is_integral => 1,
            false => 2,
        };
        if column == 2 {
            let function = derivation.functions.get(at).map_or("new", |function| &function.name);
            println!("{name}: a mutant of `{function}` survives: {}", KINDS[number]);
        }
        table[number][column] += 1;
    }
    table
}

fn check(name: &str) {
    // A package has no mechanisms beside it.
    if !std::path::Path::new("../models").exists() {
        return;
    }
    let file = format!("../{name}.mbs");
    check_sources(name, &crate::read(std::path::Path::new(&file)).unwrap());
}

fn check_sources(name: &str, sources: &Sources) {
    let tried = std::env::var("MBS_MUTANTS").map_or(TRIED, |count| count.parse().expect("a number of mutants"));
    let table = score(name, sources, tried);
    for (kind, [refused, same, surviving]) in KINDS.iter().zip(&table) {
        println!("| {name} | {kind} | {refused} | {same} | {surviving} |");
    }
    assert_eq!(table.iter().map(|row| row[2]).sum::<usize>(), 0, "{name}");
}

#[test]
fn mutants_of_arms_are_refused() {
    check("models/mechanisms/arm6");
    check("models/mechanisms/arm6_params");
}

#[test]
fn mutants_of_mechanisms_with_constraints_are_refused() {
    check("models/mechanisms/four_bar");
    check("tests/mechanisms/rolling_coin");
    check("tests/mechanisms/whipple_bicycle");
}

#[test]
fn mutants_of_mechanisms_with_roots_are_refused() {
    check("models/mechanisms/stewart_platform");
    check("models/mechanisms/quadrotor_quaternion");
    check("models/mechanisms/kepler");
}

/// A mass between two stops, with dry friction and a motor that pulls up to a limit.
#[test]
fn mutants_of_a_piecewise_mechanism_are_refused() {
    let text = "#![dimensionless]
        mechanism Stops {
            param m: 1 = 2; param k: 1 = 700; param gap: 1 = 0.3; param limit: 1 = 5; param c: 1 = 0.4;
            coord x: 1; coord y: 1; input u: 1;
            kinetic += m*dt(x)^2/2 + if x > y { m*dt(y)^2*(1 + (x - y)^2) } else { m*dt(y)^2 };
            potential += if x > gap { k*(x - gap)^2/2 } else { if x < -gap { k*(x + gap)^2/3 } else { 0 } };
            dissipation += if dt(x) > 0 && x > 0 { c*dt(x)^2 } else { c*dt(x)^2/2 };
            force y += if u < limit { u } else { limit };
        }";
    check_sources("piecewise", &Sources::new("stops.mbs", text));
}
