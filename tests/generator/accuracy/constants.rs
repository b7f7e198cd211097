//! Constants that are folded at build time, against the same operations over 200 bits.

use std::collections::HashMap;

use mbs_derive::expr::{Binary, Expr, Function, Graph, Number, Value};
use mbs_derive::optimise::{Instruction, Program};
use mbs_derive::{declared, derived};
use mbs_tests::random::Random;

use super::measure::exact::{Exact, forgetting};

/// In units of the last place: what rounding once cannot avoid, and a little.
const ALLOWED: f64 = 0.51;

/// How far a double is from what it stands for, in units of its last place.
fn units_off(found: f64, exact: Exact) -> f64 {
    let unit = found.abs().next_up() - found.abs();
    Exact::constant(found).distance(exact) / unit
}

/// Every constant in the code of every mechanism of the repository is the double next to what is meant.
#[test]
fn emitted_constants_are_rounded_once() {
    let (mut fractions, mut folded, mut worst) = (0, 0, 0.0_f64);
    for (name, source) in mbs_models::SOURCES.iter().chain(mbs_tests::mechanisms::SOURCES) {
        forgetting(|| {
            let (derivation, values) = Number::refolded::<Exact, _>(|| {
                let graph = Graph::verbatim();
                let (lagrangian, _) =
                    declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", source)));
                derived(&lagrangian)
            });
            for &(number, exact) in values.iter().filter(|(number, _)| matches!(number, Number::Exact { .. })) {
                // What is taken for an integer is one.
                let error = Exact::number(number).distance(exact);
                assert!(error <= 1e-20, "{name}: {number} is off by {error:e}");
            }
            let values: HashMap<Number, Exact> = values.into_iter().collect();
            let programs = derivation.functions.iter().map(|function| &function.program);
            let constants = |program: &Program| -> Vec<Number> {
                let constant =
                    |i: &Instruction| if let Instruction::Constant(number) = i { Some(*number) } else { None };
                program.instructions.iter().filter_map(constant).collect()
            };
            let in_programs = programs.chain([&derivation.constructor, &derivation.required]).flat_map(constants);
            let defaults = derivation.parameters.iter().flat_map(|p| p.defaults.clone());
            for number in in_programs.chain(defaults) {
                let exact = match number {
                    Number::Exact { .. } => Exact::number(number),
                    Number::Real { .. } => *values.get(&number).expect("it was folded"),
                };
                *(if values.contains_key(&number) { &mut folded } else { &mut fractions }) += 1;
                let off = units_off(number.to_f64(), exact);
                assert!(off <= ALLOWED, "{name}: {number} is off by {off} units in the last place");
                worst = worst.max(off);
            }
        });
    }
    println!("{fractions} fractions, {folded} folded, the worst is off by {worst}");
    assert!(fractions > 1000 && folded > 100, "{fractions} fractions, {folded} folded");
}

/// A random constant, of a few operations.
fn random_constant<'g>(random: &mut Random, graph: &'g Graph) -> Expr<'g> {
    let mut stack: Vec<Expr<'g>> = Vec::new();
    for _ in 0..random.bits() % 12 + 3 {
        let leaf = |random: &mut Random| {
            let numerator = i128::from(random.bits() % 2000) - 1000;
            let fraction = Number::rational(numerator, i128::from(random.bits() % 300) + 1).expect("not over zero");
            graph.constant(if random.one_in(4) { fraction * Number::PI } else { fraction })
        };
        if stack.len() < 2 || random.one_in(3) {
            stack.push(leaf(random));
            continue;
        }
        let mut pop = || stack.pop().expect("two at least");
        let (a, b) = (pop(), pop());
        let value = match random.bits() % 8 {
            0 => a + b,
            1 => a - b,
            2 => a * b,
            3 => a / b,
            4 => a.powi((random.bits() % 9) as i32 - 4) + b,
            5 => a.call(Function::Abs).sqrt() * b,
            6 => b * a.call(Function::ALL[(random.bits() % Function::ALL.len() as u64) as usize]),
            _ => {
                let function = Binary::ALL[(random.bits() % 2) as usize];
                a.call(Function::Abs).call2(function, b)
            }
        };
        // Where there is no such number, another.
        stack.push(if value.as_constant().is_some() { value } else { leaf(random) });
    }
    stack.pop().expect("three at least")
}

/// What is known to the last place is right to the last place, and what is said to be unknown of a constant is more
/// than what is.
#[test]
fn random_constants_are_rounded_once() {
    let mut random = Random::new(0x0063_6f6e_7374);
    let (mut folded, mut unknown, mut worst) = (0, 0, 0.0_f64);
    for seed in 0..10_000 {
        forgetting(|| {
            let graph = Graph::new();
            let (_, values) = Number::refolded::<Exact, _>(|| random_constant(&mut random, &graph));
            // Subnormal doubles have no value over 200 bits: `from_f64` takes them for twice as much.
            let is_zero_or_normal = |value: f64| value == 0.0 || value.is_normal();
            for (number, exact) in values.into_iter().filter(|(number, _)| is_zero_or_normal(number.to_f64())) {
                let (value, error) = (number.to_f64(), Exact::constant(number.to_f64()).distance(exact));
                let unit = value.abs().next_up() - value.abs();
                // Next to a pole nothing is known, nor of what is made of it.
                if exact.to_f64().abs() > 1e28 {
                    break;
                }
                if matches!(number, Number::Exact { .. }) {
                    assert!(error <= 1e-12, "{seed}: {number} is off by {error:e}");
                    continue;
                }
                assert!(error <= number.error(), "{seed}: {number} is off by {error:e}, not {:e}", number.error());
                folded += 1;
                if number.error() > 0.505 * unit {
                    unknown += 1;
                    continue;
                }
                assert!(error <= ALLOWED * unit, "{seed}: {number} is off by {} units", error / unit);
                worst = worst.max(error / unit);
            }
        });
    }
    println!("{folded} folded, of which {unknown} are not known to the last place, the worst is off by {worst}");
    assert!(folded > 20_000 && 100 * unknown < folded, "{folded} folded, {unknown} unknown");
}

/// Fractions of powers of π are rounded once.
#[test]
fn multiples_of_pi_are_rounded_once() {
    let mut random = Random::new(0x7069);
    for _ in 0..1000 {
        forgetting(|| {
            let [numerator, denominator] = [0, 1].map(|_| i128::from(random.bits() >> (random.bits() % 60)) + 1);
            let power = (random.bits() % 9) as i32 - 4;
            let fraction = Number::rational(numerator, denominator).expect("not over zero");
            let number = fraction * Number::PI.power(2 * power).expect("it is finite");
            assert!(units_off(number.to_f64(), Exact::number(number)) <= ALLOWED, "{number}");
        });
    }
}
