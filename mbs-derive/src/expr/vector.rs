//! Vectors and matrices over expressions: three components, three by three.

use std::ops::{Add, Mul, Neg, Sub};

use super::graph::{Expr, Graph};

/// Three components in some axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Vector<'g>(pub [Expr<'g>; 3]);

/// Rows of three; a rotation matrix turns components in the inner axes into components in the outer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Matrix<'g>(pub [[Expr<'g>; 3]; 3]);

impl<'g> Vector<'g> {
    /// The null vector.
    pub fn zero(graph: &'g Graph) -> Self {
        Vector([graph.integer(0); 3])
    }

    /// The unit vector of axis 0, 1 or 2.
    pub fn unit(graph: &'g Graph, axis: usize) -> Self {
        Vector([0, 1, 2].map(|i| graph.integer(i64::from(i == axis))))
    }

    /// `a · b`
    pub fn dot(self, other: Self) -> Expr<'g> {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// `a × b`
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Vector([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// `a bᵀ`
    pub fn outer(self, other: Self) -> Matrix<'g> {
        Matrix(self.0.map(|a| other.0.map(|b| a * b)))
    }

    /// `|a|²`
    pub fn norm_squared(self) -> Expr<'g> {
        let [a, b, c] = self.0.map(|x| x.powi(2));
        a + b + c
    }

    /// `s a`
    pub fn scale(self, s: Expr<'g>) -> Self {
        Vector(self.0.map(|x| s * x))
    }

    /// Each component changed by `f`.
    pub fn map(self, f: impl FnMut(Expr<'g>) -> Expr<'g>) -> Self {
        Vector(self.0.map(f))
    }
}

impl<'g> Matrix<'g> {
    /// The unit matrix.
    pub fn identity(graph: &'g Graph) -> Self {
        Self::diagonal([graph.integer(1); 3])
    }

    /// A diagonal matrix.
    pub fn diagonal(entries: [Expr<'g>; 3]) -> Self {
        let zero = entries[0].graph().integer(0);
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { entries[i] } else { zero })))
    }

    /// `s A`
    pub fn scale(self, s: Expr<'g>) -> Self {
        Matrix(self.0.map(|row| row.map(|x| s * x)))
    }

    /// Its transpose.
    pub fn transpose(self) -> Self {
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| self.0[j][i])))
    }

    /// Rotation about a coordinate axis by the angle of this sine and cosine.
    pub(crate) fn plane_rotation(axis: usize, sin: Expr<'g>, cos: Expr<'g>) -> Self {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut rows = Self::identity(sin.graph()).0;
        rows[i][i] = cos;
        rows[j][j] = cos;
        rows[i][j] = -sin;
        rows[j][i] = sin;
        Matrix(rows)
    }

    /// Rotation by `angle` about a unit axis: `cos 1 + (1 − cos) e eᵀ + sin [e]×` (Rodrigues).
    ///
    /// About a coordinate axis the entries 0 and 1 are written as such.
    pub fn rotation(axis: Vector<'g>, angle: Expr<'g>) -> Self {
        let graph = angle.graph();
        let (c, s) = (angle.cos(), angle.sin());
        if let Some(k) = (0..3).find(|&k| axis == Vector::unit(graph, k)) {
            return Self::plane_rotation(k, s, c);
        }
        let e = axis.0;
        let versine = 1 - c;
        let entry = |i: usize, j: usize| {
            let symmetric = versine * (e[i] * e[j]);
            match (3 + j - i) % 3 {
                0 => c + symmetric,
                1 => symmetric - s * e[(j + 1) % 3],
                _ => symmetric + s * e[(i + 1) % 3],
            }
        };
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))))
    }
}

impl<'g> Mul<Vector<'g>> for Matrix<'g> {
    type Output = Vector<'g>;
    fn mul(self, v: Vector<'g>) -> Vector<'g> {
        Vector(self.0.map(|row| Vector(row).dot(v)))
    }
}

impl<'g> Mul for Matrix<'g> {
    type Output = Matrix<'g>;
    fn mul(self, other: Matrix<'g>) -> Matrix<'g> {
        let columns = other.transpose().0;
        Matrix(self.0.map(|row| columns.map(|column| Vector(row).dot(Vector(column)))))
    }
}

impl<'g> Add for Vector<'g> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Vector([0, 1, 2].map(|i| self.0[i] + other.0[i]))
    }
}

impl<'g> Sub for Vector<'g> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Vector([0, 1, 2].map(|i| self.0[i] - other.0[i]))
    }
}

impl Neg for Vector<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        Vector(self.0.map(|x| -x))
    }
}

impl<'g> Add for Matrix<'g> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| self.0[i][j] + other.0[i][j])))
    }
}

impl<'g> Sub for Matrix<'g> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| self.0[i][j] - other.0[i][j])))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Symbol;
    use super::*;

    #[test]
    fn rodrigues_about_a_coordinate_axis_is_the_plane_rotation() {
        let graph = Graph::new();
        let angle = graph.symbol(Symbol::Coordinate(0));
        let (c, s, one, zero) = (angle.cos(), angle.sin(), graph.integer(1), graph.integer(0));
        let z = Matrix::rotation(Vector::unit(&graph, 2), angle);
        assert_eq!(z, Matrix([[c, -s, zero], [s, c, zero], [zero, zero, one]]));
    }

    /// `v + 2 w (u × v) + 2 u × (u × v)` with the unit quaternion `w = cos ½φ`, `u = e sin ½φ`.
    #[test]
    fn a_general_rotation_is_that_of_its_quaternion() {
        let graph = Graph::new();
        let angle = graph.symbol(Symbol::Coordinate(0));
        let e = Vector([2, -3, 6].map(|n| graph.integer(n) / 7));
        let v = Vector([1, 5, -2].map(|n| graph.integer(n)));
        let (w, s) = ((angle / 2).cos(), (angle / 2).sin());
        let u = Vector(e.0.map(|x| x * s));
        let cross = u.cross(v);
        let twice = u.cross(cross);
        let turned = Vector([0, 1, 2].map(|i| v.0[i] + 2 * (w * cross.0[i]) + 2 * twice.0[i]));
        let difference = Matrix::rotation(e, angle) * v - turned;
        for angle in [0.3, -1.2, 2.9] {
            let left = crate::expr::evaluate(&difference.0, |_| angle);
            assert!(left.iter().all(|x: &f64| x.abs() < 1e-14), "{left:?} at {angle}");
        }
    }

    #[test]
    fn a_general_rotation_keeps_its_axis_and_turns_its_normal() {
        let graph = Graph::new();
        // e = (2, 3, 6)/7, a quarter turn: exact rationals throughout
        let seventh = |n: i64| graph.integer(n) / 7;
        let e = Vector([seventh(2), seventh(3), seventh(6)]);
        let right_angle = graph.constant(crate::expr::Number::PI) / 2;
        let r = Matrix::rotation(e, right_angle);
        assert_eq!(r * e, e);
        let normal = Vector([seventh(3), seventh(-2), seventh(0)]);
        assert_eq!(r * normal, e.cross(normal));
        assert_eq!(r * r.transpose(), Matrix::identity(&graph));
    }
}
