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

/// The coefficients of tables, by the textbook's formulas over 200 bits: of straight lines, of monotone cubics, and of
/// the natural spline, whose curvatures are eliminated from both ends here.
#[test]
fn coefficients_of_tables_are_rounded_once() {
    let mut random = Random::new(0x7461_626c_6573);
    let mut worst = 0.0_f64;
    for (kind, tangents) in [
        ("table", None),
        ("table_monotone", Some(monotone_tangents as fn(&[Exact], &[Exact]) -> Vec<Exact>)),
        ("table_spline", Some(spline_tangents)),
    ] {
        for _ in 0..20 {
            forgetting(|| {
                let steps: Vec<u64> = (0..9).map(|_| 1 + random.bits() % 700).collect();
                let places: Vec<f64> = (0..9).map(|k| steps[..=k].iter().sum::<u64>() as f64).collect();
                let values: Vec<f64> = (0..9).map(|_| (random.bits() % 9000) as f64 - 4500.0).collect();
                let [xs, ys] = [&places, &values].map(|all| -> Vec<Exact> {
                    all.iter().map(|&x| Exact::constant(x).div(Exact::constant(1000.0))).collect()
                });
                let written = |all: &[f64]| all.iter().map(|x| format!("{x}e-3")).collect::<Vec<_>>().join(", ");
                let text = format!(
                    "#![dimensionless]\nmechanism A {{ coord x: 1; kinetic += dt(x)^2/2; \
                     force x += {kind}(x, [{}], [{}]); }}",
                    written(&places),
                    written(&values)
                );
                let graph = Graph::verbatim();
                let (lagrangian, _) =
                    declared(&text, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("", &text)));
                let derivation = derived(&lagrangian);
                let [spline] = derivation.splines()[..] else { panic!("one table") };

                let h: Vec<Exact> = xs.windows(2).map(|two| two[1].sub(two[0])).collect();
                let secants: Vec<Exact> = (0..8).map(|k| ys[k + 1].sub(ys[k]).div(h[k])).collect();
                let slopes = tangents.map(|tangents| tangents(&h, &secants));
                for k in 0..8 {
                    let mut expected = vec![xs[k], ys[k]];
                    match &slopes {
                        None => expected.push(secants[k]),
                        Some(slopes) => {
                            let (a, b, twice) = (slopes[k], slopes[k + 1], secants[k].add(secants[k]));
                            let squares = twice.add(secants[k]).sub(a.add(a)).sub(b).div(h[k]);
                            let cubes = a.add(b).sub(twice).div(h[k].mul(h[k]));
                            expected.extend([a, squares, cubes]);
                        }
                    }
                    let row = &spline.rows()[k + 1];
                    assert_eq!(row.len(), expected.len(), "{kind}");
                    for (&found, expected) in row.iter().zip(expected) {
                        // What is zero is zero.
                        let off = if found == 0.0 { expected.to_f64().abs() } else { units_off(found, expected) };
                        assert!(off <= ALLOWED, "{kind}: {found:e} is off by {off} units in the last place");
                        worst = worst.max(off);
                    }
                }
            });
        }
    }
    println!("the worst is off by {worst}");
}

/// Of Fritsch and Butland, and at the ends of Moler, as `docs/language.md` has them.
fn monotone_tangents(h: &[Exact], secants: &[Exact]) -> Vec<Exact> {
    let three = Exact::constant(3.0);
    let agree = |a: Exact, b: Exact| a.to_f64().signum() == b.to_f64().signum() && a.to_f64() * b.to_f64() != 0.0;
    let end = |[h, next]: [Exact; 2], [a, b]: [Exact; 2]| {
        let tangent = h.add(h).add(next).mul(a).sub(h.mul(b)).div(h.add(next));
        if !agree(tangent, a) {
            Exact::constant(0.0)
        } else if !agree(a, b) && tangent.to_f64().abs() > 3.0 * a.to_f64().abs() {
            three.mul(a)
        } else {
            tangent
        }
    };
    let inner = |k: usize| {
        let (a, b) = (secants[k - 1], secants[k]);
        let (v, w) = (h[k].add(h[k]).add(h[k - 1]), h[k].add(h[k - 1]).add(h[k - 1]));
        if agree(a, b) { v.add(w).div(v.div(a).add(w.div(b))) } else { Exact::constant(0.0) }
    };
    let last = h.len() - 1;
    let ends =
        [end([h[0], h[1]], [secants[0], secants[1]]), end([h[last], h[last - 1]], [secants[last], secants[last - 1]])];
    [ends[0]].into_iter().chain((1..=last).map(inner)).chain([ends[1]]).collect()
}

/// The slopes themselves as unknowns: `k_{i−1}/h_{i−1} + 2 (1/h_{i−1} + 1/h_i) k_i + k_{i+1}/h_i = 3 (δ_{i−1}/h_{i−1} +
/// δ_i/h_i)`, and at the ends `2 k_0 + k_1 = 3 δ_0`.
fn spline_tangents(h: &[Exact], secants: &[Exact]) -> Vec<Exact> {
    let (n, zero, one) = (h.len(), Exact::constant(0.0), Exact::constant(1.0));
    let (two, three) = (Exact::constant(2.0), Exact::constant(3.0));
    let mut matrix = vec![vec![zero; n + 1]; n + 1];
    let mut right = vec![zero; n + 1];
    for i in 0..=n {
        for k in [i.checked_sub(1), Some(i)].into_iter().flatten().filter(|&k| k < n) {
            let other = if k == i { i + 1 } else { k };
            matrix[i][i] = matrix[i][i].add(two.div(h[k]));
            matrix[i][other] = one.div(h[k]);
            right[i] = right[i].add(three.mul(secants[k]).div(h[k]));
        }
    }
    for p in 0..=n {
        for i in p + 1..=n {
            let factor = matrix[i][p].div(matrix[p][p]);
            for j in p..=n {
                matrix[i][j] = matrix[i][j].sub(factor.mul(matrix[p][j]));
            }
            right[i] = right[i].sub(factor.mul(right[p]));
        }
    }
    let mut slopes = vec![zero; n + 1];
    for i in (0..=n).rev() {
        let rest = (i + 1..=n).fold(right[i], |rest, j| rest.sub(matrix[i][j].mul(slopes[j])));
        slopes[i] = rest.div(matrix[i][i]);
    }
    slopes
}
