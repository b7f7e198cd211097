//! Pseudo-inertias: mass, first and second moments, which add up and move from frame to frame.
//!
//! A body is `(m, h, Σ)` with `h = ∫ r dm` and `Σ = ∫ r rᵀ dm` about the origin of its frame, in its axes; the inertia
//! tensor is `J = tr(Σ) 1 − Σ`. Moments, unlike the data of a body with a mass centre, are linear in the mass: bodies
//! that move as one are one sum, and what a joint cannot see is subtracted from one frame and added to another.

use crate::expr::{Expr, Graph, Matrix, Vector};
use crate::mistake::rule;

use super::wrench::turned_about;

/// A symmetric matrix by its six entries.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric<'g> {
    /// xx, yy, zz
    pub(crate) diagonal: [Expr<'g>; 3],
    /// yz, zx, xy: each opposite to its axis.
    pub(crate) products: [Expr<'g>; 3],
}

impl<'g> Symmetric<'g> {
    /// 0
    pub(crate) fn zero(graph: &'g Graph) -> Self {
        let zero = graph.integer(0);
        Symmetric { diagonal: [zero; 3], products: [zero; 3] }
    }

    /// With this entry in row `i`, column `j`.
    pub(crate) fn from_fn(entry: impl Fn(usize, usize) -> Expr<'g>) -> Self {
        Symmetric { diagonal: [0, 1, 2].map(|i| entry(i, i)), products: [entry(1, 2), entry(2, 0), entry(0, 1)] }
    }

    /// The symmetric part that a symmetric matrix is.
    pub(crate) fn of(matrix: &Matrix<'g>) -> Self {
        Self::from_fn(|i, j| matrix.0[i][j])
    }

    /// Entry in row `i`, column `j`.
    pub(crate) fn entry(&self, i: usize, j: usize) -> Expr<'g> {
        if i == j { self.diagonal[i] } else { self.products[3 - i - j] }
    }

    /// Each entry changed by `f`.
    pub(crate) fn map(self, f: impl Fn(Expr<'g>) -> Expr<'g>) -> Self {
        Symmetric { diagonal: self.diagonal.map(&f), products: self.products.map(&f) }
    }

    /// Entry by entry.
    pub(crate) fn plus(self, other: Self) -> Self {
        Symmetric {
            diagonal: [0, 1, 2].map(|i| self.diagonal[i] + other.diagonal[i]),
            products: [0, 1, 2].map(|i| self.products[i] + other.products[i]),
        }
    }

    /// As a full matrix.
    pub(crate) fn matrix(self) -> Matrix<'g> {
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| self.entry(i, j))))
    }

    /// `R A Rᵀ`
    pub(crate) fn turned(self, r: Matrix<'g>) -> Self {
        Symmetric::of(&(r * self.matrix() * r.transpose()))
    }

    /// `R A Rᵀ` for the rotation by an angle with this sine and cosine about a coordinate axis.
    ///
    /// In the plane of x and y, with `u = s (Axx − Ayy) + 2 c Axy`: `Axx − s u`, `Ayy + s u`, `c u − Axy`: five
    /// products where squares of sine and cosine would take more.
    pub(crate) fn turned_about(self, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Self {
        let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
        let ([di, dj], [pi, pj, pk]) = ([self.diagonal[i], self.diagonal[j]], [i, j, k].map(|n| self.products[n]));
        let u = s * (di - dj) + 2 * (c * pk);
        let mut turned = self;
        turned.diagonal[i] = di - s * u;
        turned.diagonal[j] = dj + s * u;
        turned.products[k] = c * u - pk;
        // A_jk is opposite to i: (A_ik, A_jk) turns as a vector of the plane.
        turned.products[j] = c * pj - s * pi;
        turned.products[i] = s * pj + c * pi;
        turned
    }
}

/// Mass, first and second moments of what moves as one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inertia<'g> {
    /// m
    pub(crate) mass: Expr<'g>,
    /// h
    pub(crate) first: Vector<'g>,
    /// Σ
    pub(crate) second: Symmetric<'g>,
}

impl<'g> Inertia<'g> {
    /// Nothing.
    pub(crate) fn zero(graph: &'g Graph) -> Self {
        Inertia { mass: graph.integer(0), first: Vector::zero(graph), second: Symmetric::zero(graph) }
    }

    /// A body with its mass centre at `com` and its inertia about it: `Σ = ½ tr(I) 1 − I + m c cᵀ`.
    pub(crate) fn of_body(mass: Expr<'g>, com: Vector<'g>, about_com: Option<Matrix<'g>>) -> Self {
        let point = Symmetric::of(&com.outer(com).scale(mass));
        let second = about_com.map_or(point, |i| point.plus(second_moments(&Symmetric::of(&i))));
        Inertia { mass, first: com.scale(mass), second }
    }

    /// Both together.
    pub(crate) fn plus(self, other: Self) -> Self {
        Inertia {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            second: self.second.plus(other.second),
        }
    }

    /// What remains where `other` is taken away.
    pub(crate) fn minus(self, other: Self) -> Self {
        let negative = Inertia { mass: -other.mass, first: -other.first, second: other.second.map(|entry| -entry) };
        self.plus(negative)
    }

    /// In the axes of a frame in which this one is turned by R.
    pub(crate) fn turned(self, r: Matrix<'g>) -> Self {
        Inertia { first: r * self.first, second: self.second.turned(r), ..self }
    }

    /// In the axes of a frame in which this one is turned by this angle about a coordinate axis.
    pub(crate) fn turned_about(self, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Self {
        let first = turned_about(self.first, axis, s, c);
        Inertia { first, second: self.second.turned_about(axis, s, c), ..self }
    }

    /// About the origin of a frame in which this one's origin is at t: `h + m t`, `Σ + h tᵀ + t hᵀ + m t tᵀ`.
    pub(crate) fn shifted(self, t: Vector<'g>) -> Self {
        let graph = self.mass.graph();
        // Σ + g tᵀ + t gᵀ with g = h + ½ m t
        let half = rule!("the inertia about another point", self.mass / graph.integer(2), self.mass);
        let g = self.first + t.scale(half);
        let sum = |i: usize, j: usize| g.0[i] * t.0[j] + t.0[i] * g.0[j];
        let added = Symmetric {
            diagonal: [0, 1, 2].map(|i| 2 * (g.0[i] * t.0[i])),
            products: [sum(1, 2), sum(2, 0), sum(0, 1)],
        };
        Inertia { mass: self.mass, first: self.first + t.scale(self.mass), second: self.second.plus(added) }
    }

    /// The part on the axis, a line of mass that a turn about it does not see: m, `(e·h) e`, `(e·Σ e) e eᵀ`.
    pub(crate) fn on_axis(self, axis: usize) -> Self {
        let mut line = Inertia { mass: self.mass, ..Inertia::zero(self.mass.graph()) };
        line.first.0[axis] = self.first.0[axis];
        line.second.diagonal[axis] = self.second.diagonal[axis];
        line
    }

    /// `e·J e`
    pub(crate) fn axial(&self, axis: usize) -> Expr<'g> {
        self.second.diagonal[(axis + 1) % 3] + self.second.diagonal[(axis + 2) % 3]
    }

    /// Whether there is nothing.
    pub(crate) fn is_zero(&self) -> bool {
        let Symmetric { diagonal, products } = self.second;
        [[self.mass; 3], self.first.0, diagonal, products].as_flattened().iter().all(|e| e.is_zero())
    }
}

/// `Σ = ½ tr(I) 1 − I`
fn second_moments<'g>(inertia: &Symmetric<'g>) -> Symmetric<'g> {
    let [x, y, z] = inertia.diagonal;
    let half_trace = (x + y + z) / 2;
    Symmetric { diagonal: inertia.diagonal.map(|d| half_trace - d), products: inertia.products.map(|p| -p) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Symbol, evaluate};

    fn values(symmetric: &Symmetric<'_>) -> Vec<f64> {
        let entries: Vec<_> = symmetric.diagonal.iter().chain(&symmetric.products).copied().collect();
        evaluate(&entries, |symbol| match symbol {
            Symbol::Coordinate(i) => 0.3 + 0.7 * f64::from(i),
            _ => unreachable!("only coordinates here"),
        })
    }

    #[test]
    fn plane_rotations_are_full_ones() {
        let graph = Graph::new();
        let symbol = |i| graph.symbol(Symbol::Coordinate(i));
        let a = Symmetric { diagonal: [0, 1, 2].map(symbol), products: [3, 4, 5].map(symbol) };
        let angle = symbol(6);
        for axis in 0..3 {
            let turned = a.turned_about(axis, angle.sin(), angle.cos());
            let expected = a.turned(Matrix::rotation(Vector::unit(&graph, axis), angle));
            for (found, expected) in values(&turned).iter().zip(values(&expected)) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    #[test]
    fn a_shifted_body_is_the_body_declared_there() {
        let graph = Graph::new();
        let symbol = |i| graph.symbol(Symbol::Coordinate(i));
        let (m, c, t) = (symbol(0), Vector([1, 2, 3].map(symbol)), Vector([4, 5, 6].map(symbol)));
        let inertia = Symmetric { diagonal: [7, 8, 9].map(symbol), products: [10, 11, 12].map(symbol) }.matrix();
        let shifted = Inertia::of_body(m, c, Some(inertia)).shifted(t);
        let expected = Inertia::of_body(m, c + t, Some(inertia));
        for (found, expected) in values(&shifted.second).iter().zip(values(&expected.second)) {
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }
}
