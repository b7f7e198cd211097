//! What the inputs of a system reach, and what not.

use super::ControlError;
use super::dense::{balance, identity, is_finite, norm, product, transpose};
use crate::scalar::length;

/// What is left of a vector of length 1 beside the others counts as rounding below this.
const NONE: f64 = 1e-10;

/// The dimension of the span of `B, A B, A² B, …`.
pub(super) fn reachable<const N: usize, const U: usize>(
    a: &[[f64; N]; N],
    b: &[[f64; U]; N],
) -> Result<usize, ControlError> {
    Ok(span(a, b)?.1.count)
}

/// A on what the inputs do not reach; all that they reach has the pole that `reached` makes of the norm of A.
pub(super) fn unreached<const N: usize, const U: usize>(
    a: &[[f64; N]; N],
    b: &[[f64; U]; N],
    reached: impl Fn(f64) -> f64,
) -> Result<[[f64; N]; N], ControlError> {
    let (a, mut basis) = span(a, b)?;
    let count = basis.count;
    identity(1.0).into_iter().for_each(|axis| basis.add(axis, 0.0));
    let turned = product(&product(&basis.vectors, &a), &transpose(&basis.vectors));
    let instead = identity::<N>(reached(norm(&a)));
    Ok(core::array::from_fn(|i| core::array::from_fn(|j| if i.min(j) < count { instead[i][j] } else { turned[i][j] })))
}

/// A of balanced states, and a basis of what the inputs reach of them.
fn span<const N: usize, const U: usize>(
    a: &[[f64; N]; N],
    b: &[[f64; U]; N],
) -> Result<([[f64; N]; N], Basis<N>), ControlError> {
    for (matrix, finite) in [('A', is_finite(a)), ('B', is_finite(b))] {
        if !finite {
            return Err(ControlError::NotFinite { matrix });
        }
    }
    let (mut a, mut b) = (*a, *b);
    balance(&mut a, &mut b);
    let size = norm(&a);
    let mut basis = Basis { vectors: [[0.0; N]; N], count: 0 };
    for j in 0..U {
        basis.add(core::array::from_fn(|i| b[i][j]), 0.0);
    }
    // Each vector of the basis is carried on by A, also those that are added on the way.
    let mut next = 0;
    while next < basis.count {
        let from = basis.vectors[next];
        basis.add(core::array::from_fn(|i| (0..N).map(|j| a[i][j] * from[j]).sum()), size * f64::EPSILON);
        next += 1;
    }
    Ok((a, basis))
}

/// Orthonormal vectors, the first `count` of them.
struct Basis<const N: usize> {
    vectors: [[f64; N]; N],
    count: usize,
}

impl<const N: usize> Basis<N> {
    /// Takes in what is new in a vector, unless its length is `rounding` or less.
    fn add(&mut self, mut vector: [f64; N], rounding: f64) {
        let length = length(vector.into_iter());
        if self.count == N || length <= rounding {
            return;
        }
        vector = vector.map(|entry| entry / length);
        // Twice is enough (Parlett, *The symmetric eigenvalue problem*, 1980, section 6.9, after Kahan).
        for _ in 0..2 {
            for known in &self.vectors[..self.count] {
                let along: f64 = (0..N).map(|i| known[i] * vector[i]).sum();
                (0..N).for_each(|i| vector[i] -= along * known[i]);
            }
        }
        let left = self::length(vector.into_iter());
        if left > NONE {
            self.vectors[self.count] = vector.map(|entry| entry / left);
            self.count += 1;
        }
    }
}
