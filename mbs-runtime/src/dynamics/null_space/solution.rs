//! Motions and multipliers from the factors, and whether they solve the system.

use super::super::scaling::{Scales, scaled};
use super::{Fault, NullSpace, Terms, is_finite, is_less, larger, largest, magnitude, root};
use crate::scalar::{Mask, Scalar};

impl<T: Scalar, const N: usize, const K: usize> NullSpace<T, N, K> {
    #[inline(always)]
    pub(super) fn scaled_right_side(&self, force: &[T; N], target: &[T; K]) -> ([T; N], [T; K]) {
        let Scales { columns: s, rows: t, mass, .. } = &self.scales;
        let (mut force, mut target) = (*force, *target);
        (0..N).for_each(|i| force[i] = scaled(force[i], -s[i] - mass));
        (0..K).for_each(|k| target[k] = scaled(target[k], -t[k]));
        (force, target)
    }

    /// How large, scaled, the terms of a column's targets are, as far as it is known by itself.
    pub(super) fn given_sizes<const C: usize>(
        &self,
        terms: &Terms<'_, T, N, K, C>,
        j: usize,
        target: &[T; K],
    ) -> [T; K] {
        core::array::from_fn(|k| {
            let given = terms.sizes.map_or(T::zero(), |sizes| scaled(sizes[k][j], -self.scales.rows[k]));
            larger(magnitude(target[k]), given)
        })
    }

    /// Of each row the greatest terms, scaled, that its targets may be the rest of: of all accelerations, because the
    /// slopes of a row may know coordinates that the row does not, and of its targets; in the motion and in all
    /// columns, where that by which they are derivatives changes by its own size. A row of zeros has no scale: there
    /// only its targets count.
    pub(super) fn greatest_sizes<const C: usize>(
        &self,
        terms: &Terms<'_, T, N, K, C>,
        column: impl Fn(usize) -> ([T; N], [T; K]),
    ) -> [T; K] {
        let mut greatest = [T::zero(); K];
        let Some(motion) = terms.motion else { return greatest };
        let motion: [T; N] = core::array::from_fn(|i| scaled(motion[i], self.scales.columns[i]));
        let mut fastest = largest(&motion);
        for j in 0..C {
            let ((force, target), scale) = (column(j), terms.scales[j].abs());
            fastest = larger(fastest, largest(&self.motion(self.rank, &force, &target)) * scale);
            let given = self.given_sizes(terms, j, &target);
            (0..K).for_each(|k| greatest[k] = larger(greatest[k], given[k] * scale));
        }
        for k in 0..K {
            if is_less(T::zero(), largest(&self.slopes[k])) {
                greatest[k] = larger(greatest[k], fastest);
            }
        }
        greatest
    }

    /// `Σ |Aₖᵢ| |qᵢ|`, scaled.
    fn along(&self, row: usize, motion: &[T; N]) -> T {
        (0..N).fold(T::zero(), |sum, i| sum + magnitude(self.slopes[row][i]) * magnitude(motion[i]))
    }

    /// q̈ and λ for a right side that is scaled.
    #[inline(always)]
    pub(super) fn solution(
        &self,
        r: usize,
        force: &[T; N],
        target: &[T; K],
        sizes: &[T; K],
    ) -> Result<([T; N], [T; K]), Fault<T>> {
        let Scales { columns: s, rows: t, mass, .. } = &self.scales;
        let mut motion = self.motion(r, force, target);
        self.check(r, &motion, target, sizes)?;
        let mut multipliers = self.multipliers(r, &motion, force);
        (0..N).for_each(|i| motion[i] = scaled(motion[i], -s[i]));
        (0..K).for_each(|k| multipliers[k] = scaled(multipliers[k], mass - t[k]));
        if motion.iter().chain(&multipliers).all(|&x| is_finite(x)) {
            Ok((motion, multipliers))
        } else {
            Err(Fault::NonFinite)
        }
    }

    /// q̈, scaled.
    #[inline(always)]
    fn motion(&self, r: usize, force: &[T; N], target: &[T; K]) -> [T; N] {
        let s = N - r;
        let mut q = [T::zero(); N];
        for p in 0..r {
            q[p] = (0..p).fold(target[self.rows[p]], |sum, i| sum - self.basis[p][i] * q[i]);
        }
        for p in (0..r).rev() {
            let rest = (p + 1..r).fold(q[p], |sum, i| sum - self.basis[p][i] * q[i]);
            q[p] = rest * self.reciprocals[p];
        }
        let mut rest = [T::zero(); N];
        (0..N).for_each(|i| rest[i] = force[self.columns[i]]);
        for p in 0..r {
            for i in 0..N {
                rest[i] = rest[i] - self.ordered[p][i] * q[p];
            }
        }
        for p in 0..r {
            let factor = rest[p];
            for i in r..N {
                rest[i] = rest[i] - self.basis[p][i] * factor;
            }
        }
        for i in 0..s {
            q[r + i] = (0..i).fold(rest[r + i], |sum, j| sum - self.inertia[i][j] * q[r + j]);
        }
        for i in (0..s).rev() {
            let scaled = q[r + i] * self.compliance[i];
            q[r + i] = (i + 1..s).fold(scaled, |sum, j| sum - self.inertia[j][i] * q[r + j]);
        }
        for p in 0..r {
            q[p] = (r..N).fold(q[p], |sum, i| sum - self.basis[p][i] * q[i]);
        }
        let mut motion = [T::zero(); N];
        for i in 0..N {
            motion[self.columns[i]] = q[i];
        }
        motion
    }

    /// How large the terms of a row are, scaled: of its target and of `A q̈`, and where the row is small in its vector,
    /// those of the others in it.
    fn size(&self, row: usize, motion: &[T; N], sizes: &[T; K]) -> T {
        let own = sizes[row] + self.along(row, motion);
        if !is_less(largest(&self.slopes[row]), T::one()) {
            return own;
        }
        (0..K).filter(|&k| k != row && self.vectors[k] == self.vectors[row]).fold(own, |size, k| {
            let other = sizes[k] + self.along(k, motion);
            larger(size, scaled(other, self.scales.rows[k] - self.scales.rows[row]))
        })
    }

    /// Whether the rows that depend on others ask for what those give: to what rounding leaves of the terms of the row
    /// and of those it depends on, which are `sizes` and those of `A q̈`; and of what is left of the row, which is not
    /// nothing, to all of it.
    fn check(&self, r: usize, motion: &[T; N], target: &[T; K], sizes: &[T; K]) -> Result<(), Fault<T>> {
        for k in r..K {
            let row = self.rows[k];
            let (mut rest, mut size) = (target[row], self.size(row, motion, sizes));
            for p in 0..r {
                let factor = self.basis[k][p];
                rest = rest - factor * target[self.rows[p]];
                size = size + magnitude(factor) * self.size(self.rows[p], motion, sizes);
            }
            let rounding = size * T::from_f64(root(T::ROUNDING));
            let left = |i: usize| magnitude(self.basis[k][i]) * magnitude(motion[self.columns[i]]);
            let allowed = (r..N).fold(rounding, |sum, i| sum + left(i));
            if !is_less(magnitude(rest), allowed) && !rest.equal(T::zero()).all() {
                return Err(Fault::Contradiction { row, residual: scaled(rest, self.scales.rows[row]) });
            }
        }
        Ok(())
    }

    /// λ, scaled: of least norm where rows depend on others.
    #[inline(always)]
    fn multipliers(&self, r: usize, motion: &[T; N], force: &[T; N]) -> [T; K] {
        let mut l = [T::zero(); K];
        for p in 0..r {
            let row = &self.mass[self.columns[p]];
            l[p] = (0..N).fold(-force[self.columns[p]], |sum, j| sum + row[j] * motion[j]);
        }
        for p in 0..r {
            l[p] = l[p] * self.reciprocals[p];
            for i in p + 1..r {
                l[i] = l[i] - self.basis[p][i] * l[p];
            }
        }
        for p in (0..r).rev() {
            l[p] = (p + 1..r).fold(l[p], |sum, k| sum - self.basis[k][p] * l[k]);
        }
        self.share_with_redundant_rows(r, &mut l);
        let mut multipliers = [T::zero(); K];
        for k in 0..K {
            multipliers[self.rows[k]] = l[k];
        }
        multipliers
    }

    /// From `λ₁` alone to the least `λ₁² + λ₂²` of the same `λ₁ + Gᵀ λ₂`.
    fn share_with_redundant_rows(&self, r: usize, l: &mut [T; K]) {
        for k in r..K {
            let along = (0..r).fold(T::zero(), |sum, p| sum + self.basis[k][p] * l[p]);
            l[k] = (r..k).fold(along, |sum, i| sum - self.gram[k][i] * l[i]);
        }
        for k in (r..K).rev() {
            let scaled = l[k] / self.gram[k][k];
            l[k] = (k + 1..K).fold(scaled, |sum, i| sum - self.gram[i][k] * l[i]);
        }
        for p in 0..r {
            l[p] = (r..K).fold(l[p], |sum, k| sum - self.basis[k][p] * l[k]);
        }
    }
}
