//! Whether expressions are identically zero, or polynomials of a degree in some of their symbols: decided in a finite
//! field.
//!
//! A function of s is a polynomial of degree k at most if and only if its divided differences of order `k + 1` vanish.
//! They are formed along a random line through a random point, of values in a finite field
//! ([`residue`](super::residue)), so that the answer knows no tolerance: `1e-30 v⁴` is not of degree two, and `(v⁴ −
//! w⁴)/(v² − w²)` is.
//!
//! A function that has the degree is never said not to have it as long as it follows by algebra, by the addition of
//! angles and by `√x² = x`; one that has not is taken for one that has with a probability of its degree over 2⁵¹ at
//! each of the points.

use super::branch::{Branches, Side};
use super::dual::Dual;
use super::evaluate::{Tape, Value, value_of};
use super::field::mixed;
use super::function::{Binary, Function};
use super::graph::{Expr, Graph, Id, Node, Symbol};
use super::residue::Residue;
use super::spline::SplineDerivative;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is so, for all values of the symbols.
    Holds,
    /// It does not follow from the laws that the field knows.
    Fails,
    /// There was no point where all roots exist.
    Undecided,
}

/// Whether an expression of a verbatim graph is zero for all values of its symbols.
pub(crate) fn vanishes(expr: Expr<'_>) -> Verdict {
    Test::new(expr, &|_| false).decide(0)
}

/// Whether an expression is a polynomial of at most this degree in the symbols that vary, the same one on all sides of
/// a condition that depends on them, and where they are zero. Of degree 0 is what does not depend on them.
pub(crate) fn degree_is_at_most(degree: usize, expr: Expr<'_>, varies: impl Fn(Symbol) -> bool) -> Verdict {
    Test::new(expr, &varies).decide(degree + 1)
}

/// This many points decide where nothing but the degree can be a chance.
const POINTS: u64 = 3;

/// This many where signs of roots or the outcomes of comparisons are chances, one in two.
const POINTS_OF_CHOICES: u64 = 64;

/// This many points on a line are tried to find those where all roots exist.
const TRIED_ON_A_LINE: u64 = 64;

/// This many points are tried for the values of one difference. Roots of a dozen sums exist at one in some thousands;
/// what has a value at none of them has none in the field.
const TRIED: usize = 1 << 14;

/// This many where no root depends on a symbol: what has no value at one point has none at others.
const TRIED_WITHOUT_ROOTS: usize = 64;

/// This many steps of evaluation are spent on what does not get to an end.
const BUDGET: usize = 20_000_000;

struct Test<'a> {
    tape: Tape,
    varies: &'a dyn Fn(Symbol) -> bool,
    /// Whether the value of each step varies.
    varying: Vec<bool>,
    has_choices: bool,
    /// How many points are tried for the values of one difference.
    tried: usize,
}

impl<'a> Test<'a> {
    fn new(expr: Expr<'_>, varies: &'a dyn Fn(Symbol) -> bool) -> Self {
        let tape = Tape::strict(&[expr]);
        let varying = varying(&tape, varies);
        // At zero its square is 0, not 1: a function without that law stands for it.
        let tape = tape.with_calls(|at, function| match function {
            Function::Signum if varying[at] => Function::Atan,
            other => other,
        });
        let all = !tape.steps().iter().any(|step| matches!(step, Node::Symbol(s) if varies(*s)));
        let moving = self::varying(&tape, &|_| true);
        let any = |is_meant: &dyn Fn(usize, Chance) -> bool| {
            tape.steps().iter().enumerate().any(|(at, step)| chance(step).is_some_and(|chance| is_meant(at, chance)))
        };
        let has_choices = any(&|at, chance| (all || varying[at]) && chance != Chance::Slope);
        let has_roots = any(&|at, chance| moving[at] && chance != Chance::Outcome);
        let tried = if has_roots { TRIED } else { TRIED_WITHOUT_ROOTS };
        Test { tape, varies, varying, has_choices, tried }
    }

    /// In both fields: what fails in one does not hold, and what one of them cannot decide, the other can.
    fn decide(&self, order: usize) -> Verdict {
        match (self.divided_differences_vanish::<0>(order), self.divided_differences_vanish::<1>(order)) {
            (Verdict::Fails, _) | (_, Verdict::Fails) => Verdict::Fails,
            (Verdict::Undecided, Verdict::Undecided) => Verdict::Undecided,
            _ => Verdict::Holds,
        }
    }

    fn divided_differences_vanish<const K: usize>(&self, order: usize) -> Verdict {
        let branches = Branches::of(&self.tape);
        let anywhere = std::iter::repeat_n(None, if self.has_choices { POINTS_OF_CHOICES } else { POINTS } as usize);
        let on_sides = branches.sides().iter().flat_map(|&side| [Some(side); POINTS as usize]);
        let mut left = BUDGET;
        for (point, side) in anywhere.chain(on_sides).enumerate() {
            let decided = side.map_or(Vec::new(), |side: Side| branches.way(side, false));
            match self.divided_difference::<K>(order, 1 + point as u64, &decided, &mut left) {
                Some(difference) if difference.is_zero() => {}
                Some(_) => return Verdict::Fails,
                // A side that no values of the symbols lead to does not count.
                None if side.is_some() => {}
                None => return Verdict::Undecided,
            }
        }
        Verdict::Holds
    }

    /// `Σ f(sᵢ) Π 1/(sᵢ − sⱼ)`, on a line on which f has this many values.
    fn divided_difference<const K: usize>(
        &self,
        order: usize,
        point: u64,
        decided: &[(usize, bool)],
        left: &mut usize,
    ) -> Option<Residue<K>> {
        let lines = (0..).map(|attempt| mixed(point ^ (attempt << 32)));
        let mut tried = 0;
        for line in lines {
            let mut values: Vec<(Residue<K>, Residue<K>)> = Vec::new();
            for number in 0..TRIED_ON_A_LINE {
                tried += 1;
                *left = left.checked_sub(self.tape.steps().len()).filter(|_| tried <= self.tried)?;
                let s = Residue::random(mixed(line).wrapping_add(number));
                let value = self.value(line, s, decided);
                values.extend(value.is_defined().then_some((s, value)));
                if values.len() > order {
                    return Some(divided_difference(&values));
                }
                // Nothing that varies makes it undefined.
                if order == 0 && number == 0 {
                    break;
                }
            }
        }
        None
    }

    /// The value of the expression at a point of a line.
    fn value<const K: usize>(&self, line: u64, s: Residue<K>, decided: &[(usize, bool)]) -> Residue<K> {
        let at = |symbol: Symbol| {
            let base = generic(symbol, line);
            let direction = || Residue::random(mixed(mixed(line ^ key(symbol))));
            if (self.varies)(symbol) { base.add(s.mul(direction())) } else { base }
        };
        let point = |symbol: Symbol| moving(symbol, at);
        let as_decided = |at: usize, holds: bool| {
            let known = decided.iter().find(|(comparison, _)| *comparison == at && !self.varying[at]);
            known.map_or(holds, |(_, holds)| *holds)
        };
        self.tape.run_deciding(point, as_decided)[0].value
    }
}

/// A value of a symbol with no relation to those of others; the same one for the same point.
pub(crate) fn generic<const K: usize>(symbol: Symbol, point: u64) -> Residue<K> {
    Residue::random(mixed(point ^ key(symbol)))
}

/// A symbol with its rate, of values of symbols.
fn moving<const K: usize>(symbol: Symbol, at: impl Fn(Symbol) -> Residue<K>) -> Dual<Residue<K>> {
    match rate(symbol) {
        Rate::Is(rate) => Dual::new(at(symbol), at(rate)),
        Rate::One => Dual::new(at(symbol), Residue::constant(1.0)),
        Rate::Zero => Dual::fixed(at(symbol)),
    }
}

/// Values of all nodes of a verbatim graph at some points of a finite field: what differs there is not equal. A node
/// has them at once, while [`vanishes`] goes through all that an expression is made of.
#[derive(Default)]
pub(crate) struct Fingerprints(Vec<[Dual<Residue<0>>; FINGERPRINTS]>);

/// A root exists at one point in two.
const FINGERPRINTS: usize = 4;

impl Fingerprints {
    /// Whether two expressions are equal for all values of their symbols, as far as the field knows.
    pub(crate) fn are_equal(&mut self, a: Expr<'_>, b: Expr<'_>) -> bool {
        self.complete(a.graph());
        let pairs = self.0[a.id().index()].iter().zip(&self.0[b.id().index()]);
        let differences: Vec<_> = pairs.map(|(a, b)| a.value.sub(b.value)).filter(|d| d.is_defined()).collect();
        let may_be_equal = !differences.is_empty() && differences.iter().all(|difference| difference.is_zero());
        a == b || may_be_equal && vanishes(a - b) == Verdict::Holds
    }

    /// Operands come before what is made of them.
    fn complete(&mut self, graph: &Graph) {
        for index in self.0.len()..graph.len() {
            let node = graph.node(Id(index as u32));
            let values = std::array::from_fn(|number| {
                let at = |symbol| generic(symbol, mixed(1 + number as u64));
                let spline =
                    |d: SplineDerivative, a: Dual<Residue<0>>| a.spline(&graph.spline_of(d.spline), d.order as usize);
                let operand = |id: Id| self.0[id.index()][number];
                value_of(&node, operand, |symbol| moving(symbol, at), spline, |holds| holds)
            });
            self.0.push(values);
        }
    }
}

fn divided_difference<const K: usize>(values: &[(Residue<K>, Residue<K>)]) -> Residue<K> {
    let terms = values.iter().enumerate().map(|(i, (s, value))| {
        let others = values.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(*value, |term, (_, (other, _))| term.div(s.sub(*other)))
    });
    terms.fold(Residue::constant(0.0), Residue::add)
}

/// What the field leaves to chance at a step.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Chance {
    /// Which of two roots it is, and whether there is one at all.
    Root,
    /// Whether there is a root that its slope has.
    Slope,
    /// How a comparison comes out.
    Outcome,
}

pub(super) fn chance(step: &Node) -> Option<Chance> {
    match step {
        Node::Power(_, n) if n.to_integer().is_none() => Some(Chance::Root),
        Node::Call(Function::Abs | Function::Signum, _) => Some(Chance::Root),
        Node::Call(Function::Asin | Function::Acos, _) | Node::Call2(Binary::Powf, ..) => Some(Chance::Slope),
        Node::Less(..) | Node::LessEqual(..) => Some(Chance::Outcome),
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Mul(..)
        | Node::Power(..)
        | Node::Call(..)
        | Node::Call2(..)
        | Node::Spline(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => None,
    }
}

/// Whether each step depends on a symbol that varies.
fn varying(tape: &Tape, varies: &dyn Fn(Symbol) -> bool) -> Vec<bool> {
    // Of each step, whether it varies, and whether its rate does.
    let mut found: Vec<(bool, bool)> = Vec::new();
    for step in tape.steps() {
        let any = |which: fn(&(bool, bool)) -> bool| step.operands().any(|a| which(&found[a.index()]));
        let (value, its_rate) = (any(|f| f.0), any(|f| f.1));
        found.push(match *step {
            Node::Symbol(symbol) => {
                (varies(symbol), matches!(rate(symbol), Rate::Is(rate) if varies(rate)) || varies(symbol))
            }
            Node::Rate(_) => (its_rate, its_rate),
            _ => (value, its_rate),
        });
    }
    found.into_iter().map(|(value, _)| value).collect()
}

/// The time derivative of a symbol.
enum Rate {
    Is(Symbol),
    One,
    Zero,
}

fn rate(symbol: Symbol) -> Rate {
    match symbol {
        Symbol::Time => Rate::One,
        Symbol::Coordinate(i) => Rate::Is(Symbol::Velocity(i)),
        Symbol::Velocity(i) => Rate::Is(Symbol::Acceleration(i)),
        Symbol::Prescribed(i, order) => Rate::Is(Symbol::Prescribed(i, order + 1)),
        Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Multiplier(_) => Rate::Zero,
    }
}

/// Another one for each symbol.
pub(super) fn key(symbol: Symbol) -> u64 {
    let (kind, index) = match symbol {
        Symbol::Time => (0, 0),
        Symbol::Coordinate(i) => (1, i),
        Symbol::Velocity(i) => (2, i),
        Symbol::Acceleration(i) => (3, i),
        Symbol::Parameter(i) => (4, i),
        Symbol::Input(i) => (5, i),
        Symbol::Multiplier(i) => (6, i),
        Symbol::Prescribed(i, order) => (7 + u64::from(order), i),
    };
    mixed((kind << 32) + u64::from(index))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, HalfInteger, Number, Spline};

    /// x, y with their rates v, w, and a parameter c.
    struct Symbols<'g> {
        graph: &'g Graph,
        x: Expr<'g>,
        y: Expr<'g>,
        v: Expr<'g>,
        w: Expr<'g>,
        c: Expr<'g>,
    }

    fn degree(build: impl for<'g> Fn(Symbols<'g>) -> Expr<'g>) -> Option<usize> {
        let graph = Graph::verbatim();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let (v, w, c) = (x.rate(), y.rate(), graph.symbol(Symbol::Parameter(0)));
        let expr = build(Symbols { graph: &graph, x, y, v, w, c });
        let is = |k: &usize| degree_is_at_most(*k, expr, |s| matches!(s, Symbol::Velocity(_))) == Verdict::Holds;
        (0..4).find(is)
    }

    #[test]
    fn degrees_of_polynomials() {
        assert_eq!(degree(|s| s.x.sin() * s.c), Some(0));
        assert_eq!(degree(|s| s.x.sin() * s.v), Some(1));
        assert_eq!(degree(|s| s.c * s.v * s.w + s.v), Some(2));
        assert_eq!(degree(|s| s.v.powi(3)), Some(3));
        assert_eq!(degree(|s| (s.x.powi(2) + s.y.powi(2)).sqrt().rate().powi(2)), Some(2));
        let tiny = Number::parse_decimal("1e-30").unwrap();
        assert_eq!(degree(|s| s.v.powi(2) + s.graph.constant(tiny) * s.v.powi(3)), Some(3));
    }

    #[test]
    fn degrees_of_what_cancels() {
        assert_eq!(degree(|s| (s.v.powi(2) - s.w.powi(2)) / (s.v - s.w)), Some(1));
        assert_eq!(degree(|s| (s.v + s.w).powi(4) - (s.w + s.v).powi(4) + s.v), Some(1));
        assert_eq!(degree(|s| (s.v.powi(2) + s.w.powi(2)).sqrt().powi(2)), Some(2));
        assert_eq!(degree(|s| s.v.powi(4).sqrt() * s.v.powi(4).sqrt() / s.v.powi(2)), Some(2));
        assert_eq!(degree(|s| s.v * (s.v.sin().powi(2) + s.v.cos().powi(2))), Some(1));
        assert_eq!(degree(|s| s.v.call(Function::Abs).powi(2)), Some(2));
        assert_eq!(degree(|s| s.v.power(HalfInteger::halves(3)).powi(2) / s.v), Some(2));
        assert_eq!(degree(|s| (s.v.powi(2) + s.w.powi(2)).sqrt() * (s.v.powi(2) + s.w.powi(2))), None);
    }

    #[test]
    fn a_polynomial_is_the_same_on_both_sides() {
        assert_eq!(degree(|s| s.v * s.v.call(Function::Abs)), None);
        assert_eq!(degree(|s| s.v.call(Function::Signum) * s.v.powi(2)), None);
        assert_eq!(degree(|s| s.v.powi(2).sqrt() * s.w), None);
        // signum(v)² is 0 at rest.
        assert_eq!(degree(|s| s.v.call(Function::Signum).powi(2) * s.v.powi(2)), None);
        assert_eq!(degree(|s| s.v * s.v.call(Function::Abs) * s.v.call(Function::Signum)), None);
        assert_eq!(degree(|s| s.x.call(Function::Signum).powi(2) * s.v.powi(2)), Some(2));
        let [zero, two] = [0, 2];
        assert_eq!(degree(|s| s.graph.select(s.v.less(s.graph.integer(zero)), s.v, two * s.v)), None);
        // max(v, 0)² + min(v, 0)² = v²
        assert_eq!(
            degree(|s| {
                let zero = s.graph.integer(0);
                let [larger, smaller] = [(zero, s.v), (s.v, zero)].map(|(a, b)| s.graph.select(s.v.less(zero), a, b));
                larger.powi(2) + smaller.powi(2)
            }),
            Some(2)
        );
    }

    #[test]
    fn every_side_is_looked_at() {
        // if x < 1 { v } else if x < 2 { v } … else { v³ }
        let chain = |last: i32| {
            degree(move |s| {
                let sides = (0..40).map(|k| s.x.less(s.graph.integer(40 - k)));
                sides.fold(s.v.powi(last), |rest, condition| s.graph.select(condition, s.v, rest))
            })
        };
        assert_eq!((chain(2), chain(3)), (Some(2), Some(3)));
    }

    #[test]
    fn what_is_zero_for_all_values() {
        let graph = Graph::verbatim();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let square = (x + y).powi(2) - (x.powi(2) + 2 * x * y + y.powi(2));
        assert_eq!(vanishes(square), Verdict::Holds);
        assert_eq!(vanishes((x + y).sin() - x.sin() * y.cos() - x.cos() * y.sin()), Verdict::Holds);
        assert_eq!(vanishes(square + graph.constant(Number::parse_decimal("1e-40").unwrap())), Verdict::Fails);
        assert_eq!(vanishes(x.powi(2).sqrt() - x), Verdict::Fails);
        assert_eq!(vanishes(x.call(Function::Abs) - x), Verdict::Fails);
        let table = Spline::new(vec![0.0], vec![vec![0.0, 2.0, 3.0], vec![0.0, 2.0, 6.0]]);
        let at = |x| graph.spline(&table, x);
        assert_eq!(vanishes(at(x + y) - at(y + x)), Verdict::Holds);
        assert_eq!(vanishes(at(x) + at(-x)), Verdict::Fails);
        assert_eq!(vanishes(at(x - x)), Verdict::Fails);
        assert_eq!(vanishes((x - y).call2(Binary::Atan2, x) + (y - x).call2(Binary::Atan2, x)), Verdict::Holds);
        assert_eq!(vanishes((x - x).call2(Binary::Atan2, y)), Verdict::Fails);
        let beyond = graph.select(graph.integer(100).less(x), x, graph.integer(0));
        assert_eq!(vanishes(beyond), Verdict::Fails);
        assert_eq!(vanishes(graph.integer(0) / graph.integer(0)), Verdict::Undecided);
    }

    #[test]
    fn fingerprints_tell_what_differs() {
        let graph = Graph::verbatim();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let mut fingerprints = Fingerprints::default();
        let mut equal = |a, b| fingerprints.are_equal(a, b);
        let one = graph.integer(1);
        assert!(equal(x / x, one) && equal(x, x) && equal(x.sin().powi(2) + x.cos().powi(2), one));
        assert!(equal((x * y).rate(), x.rate() * y + x * y.rate()));
        assert!(equal(x.sqrt() / x.sqrt(), one));
        assert!(!equal(x, y) && !equal(x.powi(2).sqrt(), x) && !equal(x.call(Function::Abs), x));
        assert!(!equal(x / x + graph.constant(Number::parse_decimal("1e-40").unwrap()), one));
        // Nowhere is it known what they are.
        assert!(!equal(one / graph.integer(0), y / graph.integer(0)));
    }

    /// Integers that one of the fields takes for zero, or for each other, written as they are or as sums.
    #[test]
    fn moduli_in_a_model_do_no_harm() {
        let [p, q] = [2_305_843_009_208_591_759_i128, 2_305_843_009_207_890_479];
        let [n, h] = [3_202_559_735_011_933, 1_152_921_504_604_295_879];
        let graph = Graph::verbatim();
        let integer = |n: i128| graph.constant(Number::rational(n, 1).unwrap());
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        for modulus in [p, q, 2 * p, -q, n, h, (1 << 61) - 1, p - 1, p + 1] {
            let large = integer(modulus);
            assert_eq!(vanishes(large * x), Verdict::Fails, "{modulus}");
            assert_eq!(vanishes((large * x).sin()), Verdict::Fails, "{modulus}");
            assert_eq!(vanishes((large * x).call(Function::Exp) - integer(1)), Verdict::Fails, "{modulus}");
            assert_eq!(vanishes(x / large - y), Verdict::Fails, "{modulus}");
            assert_eq!(vanishes(integer(modulus + 7) * x - integer(7) * x), Verdict::Fails, "{modulus}");
            assert_eq!(vanishes(large * x * y - y * (x * large)), Verdict::Holds, "{modulus}");
            assert_eq!(degree(|s| s.graph.constant(Number::rational(modulus, 1).unwrap()) * s.v.powi(3)), Some(3));
        }
        assert_ne!(vanishes(integer(p) * x * integer(q)), Verdict::Holds);
        assert_ne!(vanishes(integer(p * q) * x), Verdict::Holds);
    }

    #[test]
    fn exponentials_of_sums() {
        fn exp(x: Expr<'_>) -> Expr<'_> {
            x.call(Function::Exp)
        }
        assert_eq!(degree(|s| exp(s.v + s.x) * exp(s.x - s.v)), Some(0));
        assert_eq!(degree(|s| s.v * exp(s.c * s.w) * exp(-s.c * (s.w + s.x))), Some(1));
        assert_eq!(degree(|s| exp(2 * s.v) - exp(s.v).powi(2)), Some(0));
        assert_eq!(degree(|s| exp(s.v + s.x) * exp(s.x + s.v)), None);
        // An exponent that is one by its functions.
        assert_eq!(degree(|s| exp(s.x * (s.v.sin().powi(2) + s.v.cos().powi(2)))), Some(0));
    }
}
