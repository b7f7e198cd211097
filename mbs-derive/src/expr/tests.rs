//! The calculus against dual numbers: random expressions of every kind of node, with their rules and derivatives by the
//! symbolic sweeps, and as they were written, with derivatives by dual numbers.

use super::{Binary, Dual, Expr, Function, Graph, HalfInteger, Rounded, Symbol, Tangent, Tape, gradient, hessian};
use crate::numeric::Random;

const SYMBOLS: [Symbol; 3] = [Symbol::Coordinate(0), Symbol::Velocity(1), Symbol::Parameter(2)];

/// A node, its operands as numbers of earlier ones.
#[derive(Clone, Copy, Debug)]
enum Step {
    Symbol(usize),
    Integer(i64),
    Neg(usize),
    Add(usize, usize),
    Sub(usize, usize),
    Mul(usize, usize),
    Div(usize, usize),
    Power(usize, i32),
    Call(Function, usize),
    Call2(Binary, usize, usize),
    /// `if a < b { yes } else { no }`, or with `!(b <= a)`
    Choose(bool, [usize; 4]),
}

/// The steps of a random expression, the last of which is its root.
fn drawn(random: &mut Random) -> Vec<Step> {
    let mut steps: Vec<Step> = (0..3).map(Step::Symbol).collect();
    steps.extend([Step::Integer(2), Step::Integer(-3)]);
    while steps.len() < 14 {
        let number = |below: usize, random: &mut Random| ((random.symmetric() + 1.0) / 2.0 * below as f64) as usize;
        let count = steps.len();
        // The last ones more often, so that expressions are deep.
        let operand = |random: &mut Random| {
            let back = number(2, random) * number(count, random) + number(3, random);
            count - 1 - back.min(count - 1)
        };
        let [a, b, c, d] = [(); 4].map(|()| operand(random));
        steps.push(match number(11, random) {
            0 => Step::Neg(a),
            1 => Step::Add(a, b),
            2 => Step::Sub(a, b),
            3 | 4 => Step::Mul(a, b),
            5 => Step::Div(a, b),
            6 => Step::Power(a, [-4, -2, -1, 1, 3, 4, 6][number(7, random)]),
            7 | 8 => Step::Call(Function::ALL[number(Function::ALL.len(), random)], a),
            9 => Step::Call2([Binary::Atan2, Binary::Powf][number(2, random)], a, b),
            _ => Step::Choose(number(2, random) == 0, [a, b, c, d]),
        });
    }
    steps
}

fn built<'g>(steps: &[Step], graph: &'g Graph) -> Expr<'g> {
    let mut made: Vec<Expr<'g>> = Vec::new();
    for &step in steps {
        let e = |k: usize| made[k];
        made.push(match step {
            Step::Symbol(k) => graph.symbol(SYMBOLS[k]),
            Step::Integer(value) => graph.integer(value),
            Step::Neg(a) => -e(a),
            Step::Add(a, b) => e(a) + e(b),
            Step::Sub(a, b) => e(a) - e(b),
            Step::Mul(a, b) => e(a) * e(b),
            Step::Div(a, b) => e(a) / e(b),
            Step::Power(a, halves) => e(a).power(HalfInteger::halves(halves)),
            Step::Call(function, a) => e(a).call(function),
            Step::Call2(function, a, b) => e(a).call2(function, e(b)),
            Step::Choose(true, [a, b, yes, no]) => graph.select(e(a).less(e(b)), e(yes), e(no)),
            Step::Choose(false, [a, b, yes, no]) => graph.select(e(b).less_equal(e(a)).not(), e(yes), e(no)),
        });
    }
    made[made.len() - 1]
}

/// `(value, ∂/∂xᵢ, ∂²/∂xᵢ∂xⱼ)` of what was written, by dual numbers of dual numbers.
fn witness(tape: &Tape, at: [f64; 3], i: usize, j: usize) -> [Rounded; 3] {
    let one = |holds: bool| Rounded::exact(f64::from(u8::from(holds)));
    let value = tape.run(|symbol| {
        let k = SYMBOLS.iter().position(|s| *s == symbol).unwrap();
        Dual::new(Dual::new(Rounded::exact(at[k]), one(k == i)), Dual::new(one(k == j), one(false)))
    })[0];
    [value.value.value, value.value.derivative, value.derivative.derivative]
}

/// Whether two numbers agree within what rounding explains; `None` where that is too much to tell.
fn agree(found: Rounded, expected: Rounded) -> Option<bool> {
    let allowed = 4.0 * (found.error + expected.error);
    let can_tell = expected.value.is_finite() && allowed <= 1e-6 * (1.0 + expected.value.abs());
    can_tell.then(|| (found.value - expected.value).abs() <= allowed)
}

#[test]
fn rules_and_sweeps_agree_with_dual_numbers() {
    let mut random = Random::new(0x6361_6c63_756c_7573);
    let mut told = [0; 4];
    for _ in 0..4000 {
        let steps = drawn(&mut random);
        let (written, graph) = (Graph::verbatim(), Graph::new());
        let (declared, root) = (built(&steps, &written), built(&steps, &graph));
        let one = graph.integer(1);
        let slopes = gradient(root, &SYMBOLS);
        let curvatures = hessian(root, &SYMBOLS);
        let along = SYMBOLS.map(|symbol| Tangent::new(move |other| (other == symbol).then_some(one)).of(root));
        let roots: Vec<_> = [root].into_iter().chain(along).chain(slopes).chain(curvatures.concat()).collect();
        let (ours, theirs) = (Tape::new(&roots), Tape::strict(&[declared]));
        let at = [(); 3].map(|()| 1.5 * random.symmetric());
        let found = ours.run(|symbol| Rounded::exact(at[SYMBOLS.iter().position(|s| *s == symbol).unwrap()]));
        for i in 0..3 {
            for j in 0..3 {
                let [value, slope, curvature] = witness(&theirs, at, i, j);
                let pairs = [
                    (found[0], value),
                    (found[1 + i], slope),
                    (found[4 + i], slope),
                    (found[7 + 3 * i + j], curvature),
                ];
                for (kind, (found, expected)) in pairs.into_iter().enumerate() {
                    let agrees = agree(found, expected);
                    told[kind] += usize::from(agrees.is_some());
                    assert!(
                        agrees != Some(false),
                        "{declared} at {at:?}: {}, ∂{i} ∂{j}: {found:?} for {expected:?}",
                        ["value", "tangent", "gradient", "Hessian"][kind]
                    );
                }
            }
        }
    }
    assert!(told.iter().all(|&count| count > 9 * 1000), "too few comparisons: {told:?}");
}

/// Beyond the largest exponent a square stays a product of equal factors.
#[test]
fn a_product_of_equal_factors_has_twice_their_curvature() {
    let graph = Graph::new();
    let x = graph.symbol(SYMBOLS[0]);
    let power = x.powi(600);
    let found = Tape::new(&hessian(power * power, &SYMBOLS[..1])[0]).run(|_| 1.0_f64)[0];
    assert_eq!(found, 1200.0 * 1199.0);
}
