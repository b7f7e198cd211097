//! Between which values expressions stay, whatever their symbols are.

use super::function::{Binary, Function};
use super::graph::{HalfInteger, Id, Node};

/// A closed interval, wherever the expression has a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    lower: f64,
    upper: f64,
}

const REALS: Range = Range { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
const NOT_NEGATIVE: Range = Range { lower: 0.0, upper: f64::INFINITY };
const UNIT: Range = Range { lower: -1.0, upper: 1.0 };

impl Range {
    /// Of a node whose operands have these ranges.
    pub(super) fn of(node: Node, range: impl Fn(Id) -> Range) -> Range {
        match node {
            Node::Constant(value) => Range { lower: value.to_f64(), upper: value.to_f64() },
            Node::Symbol(_) | Node::Rate(_) => REALS,
            Node::Neg(a) => range(a).negative(),
            Node::Add(a, b) => range(a).plus(range(b)),
            Node::Sub(a, b) => range(a).plus(range(b).negative()),
            Node::Mul(a, b) => range(a).times(range(b)),
            Node::Power(a, n) => range(a).power(n),
            Node::Call(function, a) => of_call(function, range(a)),
            Node::Call2(Binary::Powf, a, _) if range(a).is_not_negative() => NOT_NEGATIVE,
            Node::Call2(Binary::Atan2 | Binary::Powf, ..) | Node::Spline(..) => REALS,
            Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => REALS,
            Node::Select(_, a, b) => {
                let (a, b) = (range(a), range(b));
                Range { lower: a.lower.min(b.lower), upper: a.upper.max(b.upper) }
            }
        }
    }

    pub(super) fn is_not_negative(self) -> bool {
        self.lower >= 0.0
    }

    pub(super) fn is_not_positive(self) -> bool {
        self.upper <= 0.0
    }

    fn negative(self) -> Range {
        Range { lower: -self.upper, upper: -self.lower }
    }

    fn plus(self, other: Range) -> Range {
        Range { lower: below(self.lower, other.lower), upper: -below(-self.upper, -other.upper) }
    }

    fn times(self, other: Range) -> Range {
        if self.is_not_negative() && other.is_not_negative() {
            return Range { lower: 0.0, ..NOT_NEGATIVE };
        }
        match (self.negative().is_not_negative(), other.negative().is_not_negative()) {
            (true, true) => NOT_NEGATIVE,
            (true, false) if other.is_not_negative() => NOT_NEGATIVE.negative(),
            (false, true) if self.is_not_negative() => NOT_NEGATIVE.negative(),
            _ => self.within(other),
        }
    }

    /// Of a product whose factors are bounded.
    fn within(self, other: Range) -> Range {
        let size = |range: Range| range.lower.abs().max(range.upper.abs());
        let (a, b) = (size(self), size(other));
        let most = a * b;
        // Rounded up, unless the product is that of the doubles.
        let most = if libm::fma(a, b, -most) == 0.0 { most } else { most.next_up() };
        if most.is_finite() { Range { lower: -most, upper: most } } else { REALS }
    }

    fn power(self, exponent: HalfInteger) -> Range {
        let most = self.lower.abs().max(self.upper.abs());
        match exponent.to_integer() {
            Some(n) if n > 0 && n % 2 == 0 && most <= 1.0 => Range { lower: 0.0, upper: 1.0 },
            Some(n) if n % 2 == 0 => NOT_NEGATIVE,
            Some(_) if !self.is_not_negative() => REALS,
            // A root is not negative, and has no value where its argument is.
            _ => NOT_NEGATIVE,
        }
    }
}

/// A bound from below of the sum of two such bounds.
fn below(a: f64, b: f64) -> f64 {
    let sum = a + b;
    // The sum of doubles is their rounded sum where subtracting gives them back.
    if sum - a == b && sum - b == a || !sum.is_finite() { sum } else { sum.next_down() }
}

fn of_call(function: Function, argument: Range) -> Range {
    match function {
        Function::Sin | Function::Cos | Function::Tanh | Function::Signum => UNIT,
        Function::Exp | Function::Abs | Function::Acos => NOT_NEGATIVE,
        Function::Sech => Range { lower: 0.0, upper: 1.0 },
        Function::Cosh => Range { lower: 1.0, ..NOT_NEGATIVE },
        Function::Asin | Function::Atan | Function::Sinh if argument.is_not_negative() => NOT_NEGATIVE,
        Function::Tan | Function::Asin | Function::Atan | Function::Sinh | Function::Ln => REALS,
    }
}

#[cfg(test)]
mod tests {
    use crate::expr::{Binary, Expr, Function, Graph, Symbol};

    fn size(e: Expr<'_>) -> Expr<'_> {
        e.call(Function::Abs)
    }

    #[test]
    fn the_size_of_what_is_not_negative_is_itself() {
        let graph = Graph::new();
        let [x, y, m] = [Symbol::Coordinate(0), Symbol::Coordinate(1), Symbol::Parameter(0)].map(|s| graph.symbol(s));
        let zero = graph.integer(0);
        for e in [
            x * x,
            x.powi(2) + y.powi(2),
            3 * x.powi(4) + x.powi(2) * y.powi(2) + 1,
            1 - x.sin(),
            2 + x.cos() - y.sin().powi(2),
            1 + x.sin() * y.cos(),
            x.call(Function::Exp) / (1 + y.powi(2)),
            (x.powi(2) + 1).sqrt(),
            graph.select(x.less(zero), x.powi(2), size(x) * y.powi(2)),
            (-x.powi(2)) * (-y.powi(2)),
            x.powi(2).call2(Binary::Powf, y),
        ] {
            assert_eq!(size(e), e);
            assert_eq!(size(-e), e);
            assert_eq!(e.powi(2).sqrt(), e);
        }
        // (−2)³ is −8.
        let power = x.call2(Binary::Powf, m);
        for e in [x, x * y, x.powi(2) - y.powi(2), m * x.powi(2), 1 - 2 * x.sin(), x.powi(3), 1 - x.powi(2), power] {
            assert_ne!(size(e), e);
            assert_ne!(e.powi(2).sqrt(), e);
        }
    }
}
