//! Sums, differences, products and quotients of expressions, with their local rules.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::mistake::rule;

use super::function::Function;
use super::graph::{Expr, Graph, HalfInteger, Id, LARGEST_EXPONENT, Node};
use super::number::Number;

impl<'g> Neg for Expr<'g> {
    type Output = Expr<'g>;

    fn neg(self) -> Expr<'g> {
        let graph = self.graph;
        match self.node() {
            Node::Neg(a) if !graph.verbatim => graph.expr(a),
            Node::Constant(value) if value.is_zero() => self,
            _ => graph.intern(Node::Neg(self.id)),
        }
    }
}

impl<'g> Add for Expr<'g> {
    type Output = Expr<'g>;

    fn add(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Add(self.id, other.id));
        }
        if let (Some(a), Some(b)) = (self.as_constant(), other.as_constant()) {
            return graph.constant(a + b);
        }
        match (self.node(), other.node()) {
            (Node::Constant(c), _) if c.is_zero() => other,
            (_, Node::Constant(c)) if c.is_zero() => self,
            (Node::Neg(a), Node::Neg(b)) => -(graph.expr(a) + graph.expr(b)),
            (_, Node::Neg(b)) => self - graph.expr(b),
            (Node::Neg(a), _) => other - graph.expr(a),
            // (a − b) + b = a
            (Node::Sub(a, b), _) if b == other.id => graph.expr(a),
            (_, Node::Sub(a, b)) if b == self.id => graph.expr(a),
            _ => self.sum_of_like_terms(other).unwrap_or_else(|| {
                let (a, b) = if graph.precedes(self.id, other.id) { (self, other) } else { (other, self) };
                graph.intern(Node::Add(a.id, b.id))
            }),
        }
    }
}

impl<'g> Expr<'g> {
    /// `c·x + d·x = (c + d)·x`, `sin²x + cos²x = 1`
    fn sum_of_like_terms(self, other: Expr<'g>) -> Option<Expr<'g>> {
        let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
        if x.id == y.id {
            return Some(self.graph.scaled(c + d, x));
        }
        if c == d && x.is_square_of_sine_beside_cosine(y) {
            return Some(self.graph.constant(rule!("sin² + cos² = 1", c, c + c)));
        }
        None
    }

    fn is_square_of_sine_beside_cosine(self, other: Expr<'g>) -> bool {
        let squared = |e: Expr<'g>| match e.node() {
            Node::Power(base, n) if n == HalfInteger::integer(2) => match e.graph.node(base) {
                Node::Call(function @ (Function::Sin | Function::Cos), x) => Some((function, x)),
                _ => None,
            },
            _ => None,
        };
        matches!((squared(self), squared(other)), (Some((f, x)), Some((g, y))) if f != g && x == y)
    }
}

impl<'g> Sub for Expr<'g> {
    type Output = Expr<'g>;

    fn sub(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Sub(self.id, other.id));
        }
        if let (Some(a), Some(b)) = (self.as_constant(), other.as_constant()) {
            return graph.constant(a + -b);
        }
        if self.id == other.id {
            return graph.integer(0);
        }
        match (self.node(), other.node()) {
            (Node::Constant(c), _) if c.is_zero() => -other,
            (_, Node::Constant(c)) if c.is_zero() => self,
            (Node::Neg(a), Node::Neg(b)) => graph.expr(b) - graph.expr(a),
            (_, Node::Neg(b)) => self + graph.expr(b),
            (Node::Neg(a), _) => -(graph.expr(a) + other),
            // (a + b) − b = a, a − (a + b) = −b, (a − b) − a = −b, a − (a − b) = b
            (Node::Add(a, b), _) if b == other.id => graph.expr(a),
            (Node::Add(a, b), _) if a == other.id => graph.expr(b),
            (_, Node::Add(a, b)) if a == self.id => -graph.expr(b),
            (_, Node::Add(a, b)) if b == self.id => -graph.expr(a),
            (Node::Sub(a, b), _) if a == other.id => -graph.expr(b),
            (_, Node::Sub(a, b)) if a == self.id => rule!("a − (a − b) = b", graph.expr(b), -graph.expr(b)),
            _ => {
                let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
                if x.id == y.id {
                    return graph.scaled(c + -d, x);
                }
                // One sign for a difference and its negative, whichever was built first.
                if graph.precedes(self.id, other.id) {
                    graph.intern(Node::Sub(self.id, other.id))
                } else {
                    -graph.intern(Node::Sub(other.id, self.id))
                }
            }
        }
    }
}

impl<'g> Mul for Expr<'g> {
    type Output = Expr<'g>;

    fn mul(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Mul(self.id, other.id));
        }
        match (self.node(), other.node()) {
            (Node::Neg(a), Node::Neg(b)) => return graph.expr(a) * graph.expr(b),
            (Node::Neg(a), _) => return -(graph.expr(a) * other),
            (_, Node::Neg(b)) => return -(self * graph.expr(b)),
            (Node::Constant(a), Node::Constant(b)) => {
                let product = a.times(b).map(|product| graph.constant(product));
                return product.unwrap_or_else(|| graph.ordered_product(self, other));
            }
            (_, Node::Constant(_)) => return other * self,
            (Node::Constant(c), _) if c.is_zero() => return self,
            (Node::Constant(c), _) if c.is_one() => return other,
            _ => {}
        }
        let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
        // A number stays with parameters that it multiplies, so that both are multiplied once; 2 x · (1/2 p) y = p x y.
        let in_place = |e: Expr<'g>, c: Number, beside: Expr<'g>| c.is_one() || e.keeps_number_beside(beside);
        let both = !c.is_one() && !d.is_one() && self.id != other.id;
        if !both && in_place(self, c, other) && in_place(other, d, self) {
            return self.product_of_powers(other);
        }
        let product = if x.is_one() { y } else { x.product_of_powers(y) };
        let Some(coefficient) = c.times(d) else {
            return graph.intern(Node::Mul(graph.constant(c).id, graph.scaled(d, product).id));
        };
        if coefficient.is_one() {
            return product;
        }
        if let Some((p, z)) = product.split_parameters() {
            return graph.ordered_product(graph.constant(coefficient) * p, z);
        }
        match product.node() {
            Node::Constant(_) => graph.scaled(coefficient, product),
            Node::Neg(a) => -graph.scaled(coefficient, graph.expr(a)),
            Node::Mul(e, z) if graph.is_constant(e) => graph.scaled(coefficient, graph.expr(e)) * graph.expr(z),
            _ => graph.intern(Node::Mul(graph.constant(coefficient).id, product.id)),
        }
    }
}

impl<'g> Expr<'g> {
    /// `x^a · x^b = x^(a + b)`
    fn product_of_powers(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        let power = |e: Expr<'g>| match e.node() {
            Node::Power(base, n) => (base, n.0),
            _ => (e.id, 2),
        };
        let ((x, a), (y, b)) = (power(self), power(other));
        // √x · 1/√x is left alone: it says that x is positive.
        let cancels_roots = i64::from(a) + i64::from(b) == 0 && a % 2 != 0;
        match a.checked_add(b).filter(|sum| sum.abs() <= LARGEST_EXPONENT) {
            Some(sum) if x == y && !cancels_roots => return graph.expr(x).power(HalfInteger(sum)),
            _ => {}
        }
        if let Some(product) = self.with_root(other).or_else(|| other.with_root(self)) {
            return product;
        }
        graph.ordered_product(self, other)
    }
}

impl Graph {
    /// `c · x` for a positive constant; constants stand first.
    fn scaled<'g>(&'g self, c: Number, x: Expr<'g>) -> Expr<'g> {
        self.constant(c) * x
    }

    fn ordered_product<'g>(&'g self, a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
        let (a, b) = if self.precedes(a.id, b.id) { (a, b) } else { (b, a) };
        self.intern(Node::Mul(a.id, b.id))
    }
}

impl<'g> Expr<'g> {
    /// `(k · √x) · √x = k · x`: roots meet in a product before they are differentiated.
    fn with_root(self, root: Expr<'g>) -> Option<Expr<'g>> {
        let graph = self.graph;
        let odd = |id: Id| match graph.node(id) {
            Node::Power(base, n) if n.0 % 2 != 0 => Some((base, n.0)),
            _ => None,
        };
        let (base, n) = odd(root.id)?;
        let Node::Mul(a, b) = self.node() else { return None };
        let meets = |id: Id| odd(id).is_some_and(|(other, m)| other == base && n + m != 0);
        match (meets(a), meets(b)) {
            (_, true) => Some(graph.expr(a) * (graph.expr(b) * root)),
            (true, _) => Some((graph.expr(a) * root) * graph.expr(b)),
            _ => None,
        }
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // a quotient is a product with a reciprocal
impl<'g> Div for Expr<'g> {
    type Output = Expr<'g>;

    fn div(self, other: Expr<'g>) -> Expr<'g> {
        self * other.power(HalfInteger::MINUS_ONE)
    }
}

macro_rules! operators_with_integers {
    ($($operator:ident $method:ident),*) => {$(
        impl<'g> $operator<i64> for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: i64) -> Expr<'g> {
                self.$method(self.graph.integer(other))
            }
        }
        impl<'g> $operator<Expr<'g>> for i64 {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                other.graph.integer(self).$method(other)
            }
        }
    )*};
}
operators_with_integers!(Add add, Sub sub, Mul mul, Div div);

impl<'g> Expr<'g> {
    /// Splits `c · x`, and `(c · p) · x` where p depends on parameters alone, into c and `x` or `p · x`; c is 1 where
    /// there is no factor c.
    fn split_coefficient(self) -> (Number, Expr<'g>) {
        let graph = self.graph;
        let constant = |e: Expr<'g>| match e.node() {
            Node::Mul(c, x) => match graph.node(c) {
                Node::Constant(value) => Some((value, graph.expr(x))),
                _ => None,
            },
            _ => None,
        };
        let inside = || {
            let (parameters, x) = self.split_parameters()?;
            constant(parameters).map(|(c, p)| (c, graph.ordered_product(p, x)))
        };
        match self.node() {
            Node::Constant(value) => (value, graph.integer(1)),
            _ => constant(self).or_else(inside).unwrap_or((Number::ONE, self)),
        }
    }

    /// Whether the number in this product is multiplied with parameters, beside which the other factor has none.
    fn keeps_number_beside(self, other: Expr<'g>) -> bool {
        let graph = self.graph;
        let parametric = graph.is_parametric(self.id) && !graph.is_constant(self.id);
        self.split_parameters().is_some() || (parametric && !graph.is_parametric(other.id))
    }

    /// Splits `p · x`, where p depends on parameters alone and is not a constant, and x does not.
    fn split_parameters(self) -> Option<(Expr<'g>, Expr<'g>)> {
        let Node::Mul(a, b) = self.node() else { return None };
        let graph = self.graph;
        match (graph.is_parametric(a), graph.is_parametric(b)) {
            (true, false) if !graph.is_constant(a) => Some((graph.expr(a), graph.expr(b))),
            (false, true) => Some((graph.expr(b), graph.expr(a))),
            _ => None,
        }
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
    fn a_number_stays_with_the_parameters_that_it_multiplies() {
        let graph = Graph::new();
        let [x, y, _] = symbols(&graph);
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let half = graph.integer(1) / 2;
        let scaled = |e: Expr<'_>| matches!(e.node(), Node::Mul(a, b) if [a, b].contains(&(half * m).id()));
        assert!(scaled(half * (m * x)) && scaled(m * (half * x)) && scaled((half * m) * x));
        assert_eq!(half * (m * x), (half * m) * x);
        assert_eq!((half * m * x) * (2 * y), (m * x) * y);
        assert_eq!((half * m) * (2 * (l * x)), m * (l * x));
        assert_eq!(half * (m * x) + half * (m * x), m * x);
        assert_eq!(3 * (m * x) - m * x, 2 * (m * x));
        assert_eq!(half * (m * x) - m * x, -(half * (m * x)));
        assert_eq!((half * m * x) * (half * m * x), (half * m * x).powi(2));
    }
}
