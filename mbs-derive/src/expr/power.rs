//! Powers and functions of one expression, with their local rules.

use crate::mistake::rule;

use super::function::{Binary, Function};
use super::graph::{Expr, Graph, HalfInteger, Id, LARGEST_EXPONENT, Node};
use super::number::Number;

impl<'g> Expr<'g> {
    /// `self^n`
    pub fn powi(self, n: i32) -> Expr<'g> {
        self.power(HalfInteger::integer(n))
    }

    /// The square root.
    pub fn sqrt(self) -> Expr<'g> {
        self.power(HalfInteger::HALF)
    }

    /// The sine.
    pub fn sin(self) -> Expr<'g> {
        self.call(Function::Sin)
    }

    /// The cosine.
    pub fn cos(self) -> Expr<'g> {
        self.call(Function::Cos)
    }

    /// `self^n` for a multiple of one half.
    pub fn power(self, n: HalfInteger) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Power(self.id, n));
        }
        match (self.node(), n.0) {
            (_, 0) => graph.integer(1),
            (_, 2) => self,
            (Node::Constant(value), halves) => match value.kept_power(halves) {
                Some(folded) => graph.constant(folded),
                None => graph.intern(Node::Power(self.id, n)),
            },
            (Node::Neg(a), halves) if halves % 2 == 0 => {
                let power = graph.expr(a).power(n);
                rule!("a power of −x", if halves % 4 == 0 { power } else { -power }, power)
            }
            // (x^a)^b = x^(a b) holds for an integer b wherever the left side exists.
            (Node::Power(a, inner), halves)
                if halves % 2 == 0
                    && (i64::from(inner.0) * i64::from(halves)).abs() <= 2 * i64::from(LARGEST_EXPONENT) =>
            {
                graph.expr(a).power(HalfInteger(inner.0 * (halves / 2)))
            }
            // For any b where x has one sign, or x^a is the square of a square, it holds of |x|.
            (Node::Power(a, inner), halves)
                if inner.0 % 4 == 0 && (inner.0 % 8 == 0 || graph.has_one_sign(a)) && inner.0.abs() <= 64 =>
            {
                let size = if graph.is_not_positive(a) { -graph.expr(a) } else { graph.expr(a) };
                size.power(HalfInteger(inner.0 / 2 * halves))
            }
            (Node::Call(Function::Abs, a), halves) if halves % 4 == 0 => graph.expr(a).power(n),
            // Not where that has no finite power: it would be ∞·0 at x = 0.
            (Node::Mul(c, x), halves)
                if halves % 2 == 0 && graph.expr(c).as_constant().is_some_and(|c| c.kept_power(halves).is_some()) =>
            {
                graph.expr(c).power(n) * graph.expr(x).power(n)
            }
            _ => graph.intern(Node::Power(self.id, n)),
        }
    }

    /// `function(self)`
    pub fn call(self, function: Function) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Call(function, self.id));
        }
        if let Some(value) = self.as_constant() {
            let folded = exact_value(function, value).unwrap_or_else(|| value.call(function));
            if folded.to_f64().is_finite() {
                return graph.constant(folded);
            }
        }
        match (self.node(), function) {
            (_, Function::Abs) if graph.is_not_negative(self.id) => self,
            (_, Function::Abs) if graph.is_not_positive(self.id) => -self,
            (Node::Neg(a), f) if f.is_even() => graph.expr(a).call(f),
            (Node::Neg(a), f) if f.is_odd() => -graph.expr(a).call(f),
            (Node::Add(c, x) | Node::Add(x, c) | Node::Sub(c, x) | Node::Sub(x, c), Function::Sin | Function::Cos)
                if graph.quarter_turns(c).is_some() =>
            {
                self.turned(function, c, x)
            }
            _ => graph.intern(Node::Call(function, self.id)),
        }
    }

    /// sin or cos of `x ± c` or `c − x`, where `c` is a number of quarter turns.
    fn turned(self, function: Function, c: Id, x: Id) -> Expr<'g> {
        let graph = self.graph;
        let (quarters, x) = match self.node() {
            Node::Sub(a, _) if a == x => (-graph.quarter_turns(c).unwrap_or(0), graph.expr(x)),
            Node::Sub(..) => (graph.quarter_turns(c).unwrap_or(0), -graph.expr(x)),
            _ => (graph.quarter_turns(c).unwrap_or(0), graph.expr(x)),
        };
        // sin(x + k π/2), with cos x = sin(x + π/2)
        let k = quarters + i64::from(function == Function::Cos);
        match k.rem_euclid(4) {
            0 => x.sin(),
            1 => x.cos(),
            2 => rule!("half a turn", -x.sin(), x.sin()),
            _ => -x.cos(),
        }
    }

    /// `function(self, other)`
    pub fn call2(self, function: Binary, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if !graph.verbatim
            && let (Some(a), Some(b)) = (self.as_constant(), other.as_constant())
        {
            let folded = a.call2(function, b);
            if folded.to_f64().is_finite() {
                return graph.constant(folded);
            }
        }
        graph.intern(Node::Call2(function, self.id, other.id))
    }
}

impl Graph {
    /// How many right angles a constant is.
    fn quarter_turns(&self, id: Id) -> Option<i64> {
        self.expr(id).as_constant()?.quarter_turns()
    }
}

/// Values of trigonometric functions that are rational.
fn exact_value(function: Function, argument: Number) -> Option<Number> {
    let sine = |quarters: i64| Number::integer([0, 1, 0, -1][quarters.rem_euclid(4) as usize]);
    match function {
        Function::Sin => argument.quarter_turns().map(sine),
        Function::Cos => argument.quarter_turns().map(|quarters| sine(quarters + 1)),
        Function::Tan | Function::Asin | Function::Atan | Function::Sinh | Function::Tanh if argument.is_zero() => {
            Some(Number::ZERO)
        }
        Function::Exp | Function::Cosh | Function::Sech if argument.is_zero() => Some(Number::ONE),
        Function::Signum if argument.is_zero() => Some(Number::ZERO),
        Function::Signum => Some(Number::integer(if argument.is_negative() { -1 } else { 1 })),
        Function::Abs => Some(if argument.is_negative() { -argument } else { argument }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    fn symbols(graph: &Graph) -> [Expr<'_>; 3] {
        [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)))
    }

    #[test]
    fn square_roots_cancel_before_they_are_differentiated() {
        let graph = Graph::new();
        let [x, y, _] = symbols(&graph);
        let norm = (x.powi(2) + y.powi(2)).sqrt();
        assert_eq!(norm.powi(2), x.powi(2) + y.powi(2));
        assert_eq!(norm * norm, x.powi(2) + y.powi(2));
        assert_eq!(norm.powi(3), (x.powi(2) + y.powi(2)).power(HalfInteger::halves(3)));
        assert_eq!(x.sqrt() * x.sqrt(), x);
        assert_eq!(y * x.sqrt() * x.sqrt(), y * x);
        assert_eq!(x.sqrt() * (x.sqrt() * y), y * x);
        let size = x.call(Function::Abs);
        assert_eq!((size * size, size.powi(4)), (x.powi(2), x.powi(4)));
        assert_ne!(x.powi(2).sqrt(), x);
    }

    #[test]
    fn powers_of_either_sign_are_gathered_up_to_a_limit() {
        let graph = Graph::new();
        let [x, ..] = symbols(&graph);
        for first in [100, -100] {
            let power = (0..6).fold((x + 1).powi(first), |power, _| power.powi(100));
            assert!(matches!(power.node(), Node::Power(_, n) if n.0.abs() <= LARGEST_EXPONENT), "{power}");
        }
        assert_eq!((x + 1).powi(-10).powi(10), (x + 1).powi(-100));
    }

    /// `(10^160 x)²` is 0 at x = 0; `10^320 x²` would be ∞·0.
    #[test]
    fn factors_stay_where_their_powers_are_not_finite() {
        let graph = Graph::new();
        let [x, ..] = symbols(&graph);
        let [large, small] = [1e160, 1e-160].map(|value| graph.constant(Number::of_double(value)));
        for power in [(large * x).powi(2), (small * x).powi(-2)] {
            assert!(matches!(power.node(), Node::Power(..)), "{power}");
        }
        assert!(matches!((2 * x).powi(2).node(), Node::Mul(..)));
    }

    #[test]
    fn trigonometry_of_constants_is_exact() {
        let graph = Graph::new();
        let [x, ..] = symbols(&graph);
        let right_angle = graph.constant(Number::PI) / graph.integer(2);
        assert!((-right_angle).cos().is_zero());
        assert_eq!((-right_angle).sin(), graph.integer(-1));
        assert_eq!((x - right_angle).sin(), -x.cos());
        assert_eq!((right_angle - x).sin(), x.cos());
        assert_eq!((x + right_angle).cos(), -x.sin());
        assert_eq!((right_angle - x).cos(), x.sin());
        assert_eq!((-x).sin(), -x.sin());
        assert_eq!(x.sin().powi(2) + x.cos().powi(2), graph.integer(1));
        assert_eq!(3 * x.cos().powi(2) + 3 * x.sin().powi(2), graph.integer(3));
    }
}
