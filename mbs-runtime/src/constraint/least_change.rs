//! The least change, in the metric of a mass matrix, that satisfies linear equations.
//!
//! Coordinates are scaled by powers of two, to inertias of about one; those without inertia by the rows. M itself may
//! be singular, or next to it, where rows hold the motion: `M + Aᵀ A` of the scaled system stands in its place, which
//! changes nothing, because `A δ` is given.

use super::RedundantRows;
use crate::dynamics::scaled;
use crate::error::{ConstraintError, SingularMassMatrix};
use crate::scalar::Real;

/// What a projection works in, for `n` coordinates and `k` rows.
pub(super) struct Workspace<'m, T> {
    /// Coordinates, on their way.
    pub(super) q: &'m mut [T],
    /// Velocities, on their way.
    pub(super) qd: &'m mut [T],
    /// Where a step of Newton's method begins.
    pub(super) begin: &'m mut [T],
    /// The change δ that was found.
    pub(super) change: &'m mut [T],
    /// Powers of two, `δ = scales δ̂`.
    pub(super) scales: &'m mut [T],
    /// M, `n × n`; its lower triangle becomes L, of the scaled coordinates.
    pub(super) metric: &'m mut [T],
    /// A, `k × n`.
    pub(super) jacobian: &'m mut [T],
    /// What the rows are instead of zero.
    pub(super) residual: &'m mut [T],
    /// Rows `L⁻¹ aᵢ`, less and less of them as they are made orthogonal.
    rows: &'m mut [T],
    /// What δ is still to contribute to the rows.
    pub(super) targets: &'m mut [T],
    /// The rows' lengths at first.
    lengths: &'m mut [T],
    /// One where a row has been dealt with.
    done: &'m mut [T],
}

impl<'m, T: Real> Workspace<'m, T> {
    pub(super) const fn size(n: usize, k: usize) -> usize {
        n * n + 2 * k * n + 5 * n + 4 * k
    }

    pub(super) fn new(memory: &'m mut [T], n: usize, k: usize) -> Self {
        let (q, memory) = memory.split_at_mut(n);
        let (qd, memory) = memory.split_at_mut(n);
        let (begin, memory) = memory.split_at_mut(n);
        let (change, memory) = memory.split_at_mut(n);
        let (scales, memory) = memory.split_at_mut(n);
        let (metric, memory) = memory.split_at_mut(n * n);
        let (jacobian, memory) = memory.split_at_mut(k * n);
        let (rows, memory) = memory.split_at_mut(k * n);
        let (residual, memory) = memory.split_at_mut(k);
        let (targets, memory) = memory.split_at_mut(k);
        let (lengths, memory) = memory.split_at_mut(k);
        let done = &mut memory[..k];
        Self { q, qd, begin, change, scales, metric, jacobian, residual, rows, targets, lengths, done }
    }

    /// `change` ← δ of least `δᵀ M δ` with `A δ = −residual`, for the rows that take part; M is factorized.
    pub(super) fn least_change(
        &mut self,
        redundant_rows: RedundantRows,
        takes_part: impl Fn(usize) -> bool,
    ) -> Result<(), ConstraintError> {
        let n = self.q.len();
        self.rows.copy_from_slice(self.jacobian);
        for (row, a) in self.rows.chunks_exact_mut(n.max(1)).enumerate() {
            multiply(a, self.scales);
            forward(self.metric, a);
            self.targets[row] = -self.residual[row];
            self.lengths[row] = dot(a, a).sqrt();
            self.done[row] = if takes_part(row) { T::zero() } else { T::one() };
        }
        self.change.iter_mut().for_each(|x| *x = T::zero());
        while let Some((row, share)) = self.longest() {
            if share.is_nan() {
                return Err(ConstraintError::NonFinite);
            }
            if share <= T::EPSILON.sqrt() * T::from_f64(1e-2) {
                match redundant_rows {
                    RedundantRows::Refuse => return Err(ConstraintError::Redundant { row }),
                    RedundantRows::LeaveOut => break,
                }
            }
            self.satisfy(row);
        }
        backward(self.metric, self.change);
        multiply(self.change, self.scales);
        if self.change.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(ConstraintError::NonFinite) }
    }

    /// Whether the row is among those that were satisfied, or took no part.
    pub(super) fn is_done(&self, row: usize) -> bool {
        self.done[row] != T::zero()
    }

    /// A row that was left out and asks for something else than those that were satisfied, where all rows took part and
    /// `begin` is what was changed; and what is left of it.
    ///
    /// What is nothing but rounding agrees: of the terms, and of rows about as large as coordinates of one or more, per
    /// s², which is what stabilization makes of a mechanism at rest.
    pub(super) fn contradiction(&self, bias: &[T]) -> Option<(usize, T)> {
        let n = self.q.len();
        let done = self.targets.iter().zip(&*self.done).filter(|(_, done)| **done != T::zero());
        let change = done.fold(T::zero(), |sum, (&target, _)| sum + target * target).sqrt();
        let size = self.q.iter().fold(T::one(), |size, &q| size.maximum(q.abs()));
        let allowed = |row: usize| {
            let a = &self.jacobian[row * n..(row + 1) * n];
            let terms = a.iter().zip(&*self.begin).fold(bias[row].abs(), |sum, (&a, &x)| sum + (a * x).abs());
            let slopes = a.iter().fold(T::zero(), |sum, a| sum + a.abs());
            T::EPSILON.sqrt() * (terms + self.lengths[row] * change) + T::from_f64(1e4) * T::EPSILON * size * slopes
        };
        let mut left = (0..bias.len()).filter(|&row| !self.is_done(row));
        left.find(|&row| self.targets[row].abs() > allowed(row)).map(|row| (row, -self.targets[row]))
    }

    /// The row of which the greatest share of its length is left, among those that have not been dealt with.
    fn longest(&self) -> Option<(usize, T)> {
        let n = self.q.len();
        let share = |row: usize| {
            let rest = &self.rows[row * n..(row + 1) * n];
            let rest = dot(rest, rest).sqrt();
            // A row of zeros has no share of anything.
            if rest == T::zero() { rest } else { rest / self.lengths[row] }
        };
        let waiting = (0..self.residual.len()).filter(|&row| self.done[row] == T::zero());
        waiting.map(|row| (row, share(row))).reduce(|a, b| if b.1 > a.1 || b.1.is_nan() { b } else { a })
    }

    /// Adds to the change what this row asks for, and makes the others orthogonal to it.
    fn satisfy(&mut self, row: usize) {
        let n = self.q.len();
        self.done[row] = T::one();
        let length = {
            let rest = &self.rows[row * n..(row + 1) * n];
            dot(rest, rest).sqrt()
        };
        let target = self.targets[row] / length;
        self.targets[row] = target;
        for i in 0..n {
            self.rows[row * n + i] = self.rows[row * n + i] / length;
            self.change[i] = self.change[i] + target * self.rows[row * n + i];
        }
        for other in (0..self.residual.len()).filter(|&other| self.done[other] == T::zero()) {
            let along = dot(&self.rows[row * n..(row + 1) * n], &self.rows[other * n..(other + 1) * n]);
            for i in 0..n {
                self.rows[other * n + i] = self.rows[other * n + i] - along * self.rows[row * n + i];
            }
            self.targets[other] = self.targets[other] - along * target;
        }
    }
}

impl<T: Real> Workspace<'_, T> {
    /// `M + Aᵀ A = L Lᵀ` of the scaled system, in the lower triangle, with the rows that take part; where that is
    /// singular, with all of them.
    pub(super) fn factorize(&mut self, takes_part: impl Fn(usize) -> bool) -> Result<(), SingularMassMatrix> {
        let n = self.q.len();
        self.scale();
        for i in 0..n {
            for j in 0..=i {
                let entry = self.metric[j * n + i] * self.scales[i] * self.scales[j];
                (self.metric[i * n + j], self.metric[j * n + i]) = (entry, entry);
            }
        }
        (0..n).for_each(|i| self.change[i] = self.metric[i * n + i]);
        self.add_rows(takes_part);
        if self.decompose().is_ok() {
            return Ok(());
        }
        for i in 0..n {
            (0..i).for_each(|j| self.metric[i * n + j] = self.metric[j * n + i]);
            self.metric[i * n + i] = self.change[i];
        }
        self.add_rows(|_| true);
        self.decompose().map_err(|SingularMassMatrix { pivot, index }| {
            let scale = self.scales[index].to_f64();
            SingularMassMatrix { pivot: pivot / (scale * scale), index }
        })
    }

    /// Scales to inertias of about one, of the coordinates that have inertia; of the others, to the rows.
    fn scale(&mut self) {
        let n = self.q.len();
        let power = |exponent: i32| scaled(T::one(), exponent);
        for i in 0..n {
            let inertia = self.metric[i * n + i];
            let has_inertia = inertia.abs() > T::zero() && inertia.is_finite();
            self.scales[i] = if has_inertia { power(-inertia.exponent().div_euclid(2)) } else { T::zero() };
        }
        for i in (0..n).filter(|&i| self.metric[i * n + i] == T::zero()) {
            let share = |row: &[T]| {
                let size = self.extent(row);
                if size == T::zero() { T::zero() } else { row[i].abs() / size }
            };
            let largest = self.jacobian.chunks_exact(n).map(share).fold(T::zero(), T::maximum);
            let is_moved = largest > T::zero() && largest.is_finite();
            self.begin[i] = if is_moved { power(-largest.exponent()) } else { T::one() };
        }
        for i in (0..n).filter(|&i| self.metric[i * n + i] == T::zero()) {
            self.scales[i] = self.begin[i];
        }
    }

    /// The largest entry of a row of A, scaled; of one that only coordinates without a scale know, unscaled.
    fn extent(&self, row: &[T]) -> T {
        let scaled = row.iter().zip(&*self.scales).fold(T::zero(), |size, (&a, &d)| size.maximum((a * d).abs()));
        if scaled == T::zero() { row.iter().fold(T::zero(), |size, &a| size.maximum(a.abs())) } else { scaled }
    }

    /// Adds `aᵀ a` of these rows, scaled to a largest entry of one, to the lower triangle.
    fn add_rows(&mut self, takes_part: impl Fn(usize) -> bool) {
        let n = self.q.len();
        let rows = self.jacobian.chunks_exact(n.max(1)).enumerate();
        for (_, a) in rows.filter(|&(row, _)| takes_part(row)) {
            let size = self.extent(a);
            // What is infinite or NaN is met again, as a row.
            if !(size > T::zero() && size.is_finite()) {
                continue;
            }
            for i in 0..n {
                let own = a[i] * self.scales[i] / size;
                for j in 0..=i {
                    self.metric[i * n + j] = self.metric[i * n + j] + own * (a[j] * self.scales[j] / size);
                }
            }
        }
    }

    /// `L Lᵀ`
    fn decompose(&mut self) -> Result<(), SingularMassMatrix> {
        let n = self.q.len();
        (0..n).for_each(|i| self.begin[i] = self.metric[i * n + i]);
        cholesky(self.metric, self.begin)
    }
}

impl<T: Real> Workspace<'_, T> {
    /// `begin` ← `M⁻¹ begin`; M is factorized.
    pub(super) fn solve_begin(&mut self) {
        multiply(self.begin, self.scales);
        forward(self.metric, self.begin);
        backward(self.metric, self.begin);
        multiply(self.begin, self.scales);
    }

    /// `residual` ← `A begin + bias`
    pub(super) fn residual_at_begin(&mut self, bias: &[T]) {
        let n = self.q.len();
        for (row, &bias) in bias.iter().enumerate() {
            self.residual[row] = bias + dot(&self.jacobian[row * n..(row + 1) * n], self.begin);
        }
    }
}

/// `M = L Lᵀ` in the lower triangle of `m`, M's diagonal being given; what is above it stays.
///
/// Source: G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, algorithm 4.2.1.
fn cholesky<T: Real>(m: &mut [T], diagonal: &[T]) -> Result<(), SingularMassMatrix> {
    let n = diagonal.len();
    let rounding = T::from_f64(n as f64) * T::EPSILON;
    for j in 0..n {
        for i in j..n {
            let (upper, lower) = (&m[j * n..j * n + j], &m[i * n..i * n + j]);
            m[i * n + j] = m[i * n + j] - dot(upper, lower);
        }
        let pivot = m[j * n + j];
        if pivot.is_nan() || pivot <= rounding * diagonal[j].abs() {
            return Err(SingularMassMatrix { pivot: pivot.to_f64(), index: j });
        }
        let root = pivot.sqrt();
        for i in j..n {
            m[i * n + j] = m[i * n + j] / root;
        }
    }
    Ok(())
}

/// Each number by its scale.
fn multiply<T: Real>(x: &mut [T], scales: &[T]) {
    x.iter_mut().zip(scales).for_each(|(x, &scale)| *x = *x * scale);
}

/// `x ← L⁻¹ x`
fn forward<T: Real>(l: &[T], x: &mut [T]) {
    let n = x.len();
    for i in 0..n {
        x[i] = (x[i] - dot(&l[i * n..i * n + i], &x[..i])) / l[i * n + i];
    }
}

/// `x ← L⁻ᵀ x`
fn backward<T: Real>(l: &[T], x: &mut [T]) {
    let n = x.len();
    for i in (0..n).rev() {
        x[i] = x[i] / l[i * n + i];
        for j in 0..i {
            x[j] = x[j] - l[i * n + j] * x[i];
        }
    }
}

fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (&a, &b)| sum + a * b)
}
