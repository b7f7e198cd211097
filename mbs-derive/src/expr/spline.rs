//! Piecewise polynomials of one argument, and their derivatives: what tables of samples are made of.

use std::hash::Hasher;

use super::evaluate::Value;
use super::graph::{Expr, Graph, MixHasher, Node};

/// Polynomials in the distance from a place, one on each interval between given places.
///
/// Row `k` holds from place `k − 1` on, and before place `k`, so that there is one row more than places. A row is
/// `[a, c₀, c₁, …]`: the value is `c₀ + c₁ s + c₂ s² + …` with `s = x − a`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spline {
    places: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl Spline {
    /// Of increasing places and rows of one length.
    ///
    /// # Panics
    /// Where places do not increase, rows are too many, too few or of different lengths, or a number is infinite or
    /// NaN.
    pub fn new(places: Vec<f64>, rows: Vec<Vec<f64>>) -> Self {
        assert!(places.windows(2).all(|two| two[0] < two[1]), "places increase");
        assert!(rows.len() == places.len() + 1, "{} places and {} rows", places.len(), rows.len());
        assert!(rows.iter().all(|row| row.len() == rows[0].len() && row.len() > 1), "rows have one length");
        assert!(rows.iter().flatten().chain(&places).all(|x| x.is_finite()), "numbers of a table are finite");
        Spline { places, rows }
    }

    /// Where one polynomial ends and the next begins.
    pub fn places(&self) -> &[f64] {
        &self.places
    }

    /// The polynomials.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// The highest power of all rows.
    pub fn degree(&self) -> usize {
        self.rows[0].len() - 2
    }

    /// The derivative of this order at `x`, by Horner's rule; NaN where `x` is NaN or infinite. The runtime's `Spline`
    /// gives the same bits.
    pub fn derivative<V: Value>(&self, x: V, order: usize) -> V {
        let (mut first, mut last) = (0, self.places.len());
        while first < last {
            let middle = first + (last - first) / 2;
            if x.less(V::constant(self.places[middle])) {
                last = middle;
            } else {
                first = middle + 1;
            }
        }
        let row = &self.rows[first];
        let s = x.sub(V::constant(row[0]));
        let coefficient = |power: usize| {
            let factor: usize = (power + 1 - order..=power).product();
            V::constant(factor as f64 * row[1 + power])
        };
        let mut sum = s.mul(V::constant(0.0));
        for power in (order..=self.degree()).rev() {
            sum = coefficient(power).add(s.mul(sum));
        }
        sum
    }

    /// A hash of what it says.
    pub(super) fn key(&self) -> u64 {
        let mut hasher = MixHasher::default();
        self.places.iter().chain(self.rows.iter().flatten()).for_each(|x| hasher.write_u64(x.to_bits()));
        hasher.finish()
    }
}

impl Eq for Spline {} // its numbers are finite

/// A derivative of the spline with this number in a graph or a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SplineDerivative {
    /// The number of the spline.
    pub spline: u32,
    /// How often it is differentiated.
    pub order: u32,
}

impl SplineDerivative {
    pub(super) fn next(self) -> Self {
        SplineDerivative { order: self.order + 1, ..self }
    }
}

impl Graph {
    /// A spline at `x`.
    pub fn spline<'g>(&'g self, spline: &Spline, x: Expr<'g>) -> Expr<'g> {
        self.spline_derivative(SplineDerivative { spline: self.spline_number(spline), order: 0 }, x)
    }

    pub(super) fn spline_derivative<'g>(&'g self, derivative: SplineDerivative, x: Expr<'g>) -> Expr<'g> {
        let spline = self.spline_of(derivative.spline);
        if derivative.order as usize > spline.degree() {
            return self.integer(0);
        }
        match x.as_constant() {
            Some(x) if !self.verbatim => self.constant(x.spline(&spline, derivative.order as usize)),
            _ => self.intern(Node::Spline(derivative, x.id)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Dual, Number, Symbol, Tangent, Tape, evaluate, gradient, hessian};

    /// −x before −1, 1 up to 0, and behind 0 the cubic 1 + 2 x + 3 x² + 4 x³.
    fn pieces() -> Spline {
        let rows = [[-1.0, 1.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 2.0, 3.0, 4.0]];
        Spline::new(vec![-1.0, 0.0], rows.map(Vec::from).to_vec())
    }

    #[test]
    fn a_row_holds_from_its_place_on() {
        for (x, orders) in [
            (-3.0, [3.0, -1.0, 0.0, 0.0]),
            (-1.0, [1.0, 0.0, 0.0, 0.0]),
            (-0.0, [1.0, 2.0, 6.0, 24.0]),
            (2.0, [49.0, 62.0, 54.0, 24.0]),
        ] {
            assert_eq!([0, 1, 2, 3].map(|order| pieces().derivative(x, order)), orders, "{x}");
        }
        assert!(pieces().derivative(f64::NAN, 0).is_nan());
        let nested = pieces().derivative(Dual::new(Dual::new(2.0, 1.0), Dual::new(1.0, 0.0)), 0);
        assert_eq!(nested.derivative, Dual::new(62.0, 54.0));
    }

    /// By all sweeps, against dual numbers through the polynomials.
    #[test]
    fn sweeps_differentiate_it() {
        let graph = Graph::new();
        let symbols = [0, 1].map(Symbol::Coordinate);
        let [x, y] = symbols.map(|symbol| graph.symbol(symbol));
        let root = graph.spline(&pieces(), x * y) * x;
        let slope = Tangent::new(|symbol| Some(graph.integer(i64::from(symbol == Symbol::Coordinate(0))))).of(root);
        let [by_x, _] = gradient(root, &symbols)[..] else { panic!("two symbols") };
        let curvature = hessian(root, &symbols)[0][1];
        for at in [[0.7, 1.3], [-0.7, 1.3], [-2.0, 3.0]] {
            let point = |symbol| at[usize::from(symbol == Symbol::Coordinate(1))];
            let over = |symbol| match symbol {
                Symbol::Coordinate(0) => Dual::new(Dual::new(at[0], 0.0), Dual::new(1.0, 0.0)),
                _ => Dual::new(Dual::new(at[1], 1.0), Dual::new(0.0, 0.0)),
            };
            let expected = Tape::new(&[root]).run(over)[0].derivative;
            let found = evaluate(&[slope, by_x, curvature], point);
            for (value, expected) in found.iter().zip([expected.value, expected.value, expected.derivative]) {
                assert!((value - expected).abs() <= 1e-13 * expected.abs(), "{at:?}: {value}, {expected}");
            }
        }
    }

    #[test]
    fn equal_splines_are_one_and_constants_fold() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Time);
        assert_eq!(graph.spline(&pieces(), x).id(), graph.spline(&pieces(), x).id());
        assert_eq!(graph.spline(&pieces(), graph.integer(2)).as_constant().map(Number::to_f64), Some(49.0));
    }
}
