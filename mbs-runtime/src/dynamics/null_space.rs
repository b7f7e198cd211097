//! Motions that constraints leave: `M q̈ − Aᵀ λ = f`, `A q̈ = c`, solved in a basis of the null space of `A`.
//!
//! Of the scaled system (`scaling.rs`), in this order, each operation rounded by itself, sums from left to right:
//!
//! ```text
//! A = L (U₁ U₂)        complete pivoting: the largest entry of all rows and columns that are left, or one nearly as large
//!                      that its row has taken; r pivots
//! W = U₁⁻¹ U₂          q₁ = p − W q₂: dependent coordinates by independent ones
//! V = M₂₁ᵀ − M₁₁ W     the rest of M in that basis:
//! S = M₂₂ − M₂₁ W − Wᵀ V
//! S = L D Lᵀ           the pivot that has kept the greatest part of its inertia first
//!
//! y = L⁻¹ c,  p = U₁⁻¹ y,  g = f − M p
//! q₂ = S⁻¹ (g₂ − Wᵀ g₁),  q₁ = p − W q₂
//! h = M q − f in the dependent coordinates,  λ = L⁻ᵀ U₁⁻ᵀ h
//! ```
//!
//! Sources: M. Benzi, G. H. Golub, J. Liesen, *Numerical solution of saddle point problems*, Acta Numerica 14 (2005), section 6
//! (null space methods); G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, sections 3.4.8 (complete pivoting)
//! and 4.2.8 (symmetric pivoting); N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, chapters 9, 10.

use super::scaling::{Scales, exponent, scaled};
use crate::scalar::{Mask, Scalar};

/// Why a system has no solution, or more than one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault<T> {
    /// An entry is infinite or NaN.
    NonFinite,
    /// A motion that A leaves has no inertia: the pivot, and the coordinate that moves most.
    Singular { pivot: T, index: usize },
    /// A row depends on others and asks for something else: what is left of it.
    Contradiction { row: usize, residual: T },
}

/// The factorization, to solve with more than once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NullSpace<T, const N: usize, const K: usize> {
    scales: Scales<N, K>,
    /// M, scaled, both triangles.
    mass: [[T; N]; N],
    /// Of A with rows and columns in the order of the pivots: L below, U₁ and its diagonal, W beside it.
    basis: [[T; N]; K],
    /// `1/U₁ᵢᵢ`
    reciprocals: [T; K],
    /// How many rows are independent.
    rank: usize,
    /// Rows of A in the order of the pivots, those that depend on others last.
    rows: [usize; K],
    /// Coordinates: the dependent ones in the order of the pivots, then the independent ones in that of theirs.
    columns: [usize; N],
    /// S in the order of its pivots: L below the diagonal, D on it.
    inertia: [[T; N]; N],
    /// `1/D`
    compliance: [T; N],
    /// Of `1 + G Gᵀ`, where `G` gives the rows that depend on others by those that do not: L and D.
    gram: [[T; K]; K],
}

/// Rows of which less than this is left depend on others: what rounding of states leaves of them where they do.
fn least_slope<T: Scalar>() -> T {
    T::from_f64(root(T::ROUNDING) * 1e-2)
}

/// The square root of a power of four or twice one, from above; without a library.
fn root(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    f64::from_bits(((1023 + exponent.div_euclid(2) + exponent.rem_euclid(2)) as u64) << 52)
}

fn is_less<T: Scalar>(a: T, b: T) -> bool {
    a.less(b).all()
}

/// `|x|`; a sign costs nothing.
fn magnitude<T: Scalar>(x: T) -> T {
    if is_less(x, T::zero()) { -x } else { x }
}

fn is_finite<T: Scalar>(x: T) -> bool {
    is_less(magnitude(x), T::from_f64(f64::INFINITY))
}

impl<T: Scalar, const N: usize, const K: usize> NullSpace<T, N, K> {
    /// Factorizes M, of which the lower triangle is read, and A.
    pub(crate) fn new(m: &[[T; N]; N], a: &[[T; N]; K]) -> Result<Self, Fault<T>> {
        let lower = (0..N).all(|i| m[i][..=i].iter().all(|&x| is_finite(x)));
        if !(lower && a.as_flattened().iter().all(|&x| is_finite(x))) {
            return Err(Fault::NonFinite);
        }
        let mut system = Self::scaled(m, a);
        system.eliminate();
        system.solve_for_dependent_coordinates();
        let bounds = system.reduce();
        system.factorize(bounds)?;
        system.relate_redundant_rows();
        Ok(system)
    }

    fn scaled(m: &[[T; N]; N], a: &[[T; N]; K]) -> Self {
        let scales = Scales::of(m, a);
        let Scales { columns: s, rows: t, mass, .. } = scales;
        let mut scaled_mass = [[T::zero(); N]; N];
        for i in 0..N {
            for j in 0..=i {
                let entry = scaled(m[i][j], -s[i] - s[j] - mass);
                (scaled_mass[i][j], scaled_mass[j][i]) = (entry, entry);
            }
        }
        let basis = core::array::from_fn(|k| core::array::from_fn(|i| scaled(a[k][i], -s[i] - t[k])));
        Self {
            scales,
            mass: scaled_mass,
            basis,
            reciprocals: [T::zero(); K],
            rank: 0,
            rows: core::array::from_fn(|k| k),
            columns: core::array::from_fn(|i| i),
            inertia: [[T::zero(); N]; N],
            compliance: [T::zero(); N],
            gram: [[T::zero(); K]; K],
        }
    }

    /// `A = L U` with complete pivoting, until what is left is rounding.
    fn eliminate(&mut self) {
        let least = least_slope::<T>();
        while let Some((row, column)) = self.pivot(least) {
            let p = self.rank;
            self.basis.swap(p, row);
            self.rows.swap(p, row);
            self.basis.iter_mut().for_each(|row| row.swap(p, column));
            self.columns.swap(p, column);
            let pivots = self.basis[p];
            self.reciprocals[p] = T::one() / pivots[p];
            for row in &mut self.basis[p + 1..] {
                row[p] = row[p] * self.reciprocals[p];
                for j in p + 1..N {
                    row[j] = row[j] - row[p] * pivots[j];
                }
            }
            self.rank += 1;
        }
    }

    /// The largest entry of the rows and columns that are left, the first of equal ones, if it is greater than `least`. Entries
    /// that their rows have taken are as good while they are no less than half of it; of those the one that changes the others
    /// least.
    fn pivot(&self, least: T) -> Option<(usize, usize)> {
        let size = |(k, i): (usize, usize)| magnitude(self.basis[k][i]);
        let entries = || (self.rank..K).flat_map(|k| (self.rank..N).map(move |i| (k, i)));
        let largest = entries().reduce(|best, entry| if is_less(size(best), size(entry)) { entry } else { best })?;
        let enough = size(largest) * T::from_f64(0.5);
        let is_taken = |&(k, i): &(usize, usize)| self.scales.taken[self.columns[i]] == Some(self.rows[k]);
        let taken = entries().filter(is_taken).filter(|&entry| !is_less(size(entry), enough));
        let gentlest = taken.min_by_key(|&entry| self.growth(entry));
        is_less(least, size(largest)).then(|| gentlest.unwrap_or(largest))
    }

    /// By which power of two a pivot adds to other entries at most.
    fn growth(&self, (row, column): (usize, usize)) -> Option<i32> {
        let along = (self.rank..N).filter(|&i| i != column).filter_map(|i| exponent(self.basis[row][i])).max();
        let across = (self.rank..K).filter(|&k| k != row).filter_map(|k| exponent(self.basis[k][column])).max();
        Some(along? + across? - exponent(self.basis[row][column])?)
    }

    /// `W = U₁⁻¹ U₂`
    fn solve_for_dependent_coordinates(&mut self) {
        for p in (0..self.rank).rev() {
            for j in self.rank..N {
                let mut entry = self.basis[p][j];
                for i in p + 1..self.rank {
                    entry = entry - self.basis[p][i] * self.basis[i][j];
                }
                self.basis[p][j] = entry * self.reciprocals[p];
            }
        }
    }

    /// S, its lower triangle in the order of the columns, and how large its diagonal's terms are.
    fn reduce(&mut self) -> [T; N] {
        let (r, s, w) = (self.rank, N - self.rank, &self.basis);
        let m = |i: usize, j: usize| self.mass[self.columns[i]][self.columns[j]];
        let mut carried = [[T::zero(); N]; K];
        for p in 0..r {
            for j in 0..s {
                carried[p][j] = (0..r).fold(m(p, r + j), |sum, i| sum - m(p, i) * w[i][r + j]);
            }
        }
        let mut inertia = [[T::zero(); N]; N];
        for i in 0..s {
            for j in 0..=i {
                let direct = (0..r).fold(m(r + i, r + j), |sum, p| sum - m(r + i, p) * w[p][r + j]);
                inertia[i][j] = (0..r).fold(direct, |sum, p| sum - w[p][r + i] * carried[p][j]);
            }
        }
        let terms = T::from_f64(r as f64 + 1.0);
        let bound = |i: usize| {
            let own = magnitude(m(r + i, r + i));
            let sum = (0..r).fold(own, |sum, p| sum + w[p][r + i] * w[p][r + i] * magnitude(m(p, p)));
            sum * terms
        };
        let bounds = core::array::from_fn(|i| if i < s { bound(i) } else { T::one() });
        self.inertia = inertia;
        bounds
    }

    /// `S = L D Lᵀ`; a pivot of which only rounding is left ends it.
    fn factorize(&mut self, bounds: [T; N]) -> Result<(), Fault<T>> {
        let (r, s) = (self.rank, N - self.rank);
        let mut weights: [T; N] = core::array::from_fn(|i| if i < s { T::one() / bounds[i] } else { bounds[i] });
        let rounding = T::from_f64(16.0 * N as f64 * T::ROUNDING);
        for p in 0..s {
            let share = |i: usize| self.inertia[i][i] * weights[i];
            let pivot = (p + 1..s).fold(p, |best, i| if is_less(share(best), share(i)) { i } else { best });
            if !is_less(rounding, share(pivot)) {
                let index = self.columns[r + pivot];
                return Err(Fault::Singular { pivot: self.unscaled(self.inertia[pivot][pivot], index), index });
            }
            self.exchange(p, pivot);
            weights.swap(p, pivot);
            self.compliance[p] = T::one() / self.inertia[p][p];
            let mut column = [T::zero(); N];
            for i in p + 1..s {
                column[i] = self.inertia[i][p] * self.compliance[p];
            }
            for i in p + 1..s {
                let u = self.inertia[i][p];
                for j in p + 1..=i {
                    self.inertia[i][j] = self.inertia[i][j] - u * column[j];
                }
                self.inertia[i][p] = column[i];
            }
        }
        Ok(())
    }

    /// An inertia of a coordinate in the units of M.
    fn unscaled(&self, inertia: T, coordinate: usize) -> T {
        scaled(inertia, 2 * self.scales.columns[coordinate] + self.scales.mass)
    }

    /// Exchanges two independent coordinates, `p ≤ i`, in S, of which the first `p` are factorized.
    fn exchange(&mut self, p: usize, i: usize) {
        if p == i {
            return;
        }
        let (r, s) = (self.rank, N - self.rank);
        let entry = |a: usize, b: usize| (a.max(b), a.min(b));
        for other in (0..s).filter(|&other| other != p && other != i) {
            if other < p {
                let first = self.inertia[p][other];
                self.inertia[p][other] = self.inertia[i][other];
                self.inertia[i][other] = first;
            } else {
                let ((a, b), (c, d)) = (entry(p, other), entry(i, other));
                let first = self.inertia[a][b];
                self.inertia[a][b] = self.inertia[c][d];
                self.inertia[c][d] = first;
            }
        }
        let first = self.inertia[p][p];
        self.inertia[p][p] = self.inertia[i][i];
        self.inertia[i][i] = first;
        self.columns.swap(r + p, r + i);
        self.basis[..r].iter_mut().for_each(|row| row.swap(r + p, r + i));
    }

    /// `G = L₂ L₁⁻¹` in the place of L₂, the rows of L that are no pivots; `1 + G Gᵀ`, factorized.
    fn relate_redundant_rows(&mut self) {
        let r = self.rank;
        for k in r..K {
            for p in (0..r).rev() {
                for i in p + 1..r {
                    self.basis[k][p] = self.basis[k][p] - self.basis[k][i] * self.basis[i][p];
                }
            }
        }
        for k in r..K {
            for l in r..=k {
                let unit = if k == l { T::one() } else { T::zero() };
                let product = (0..r).fold(unit, |sum, p| sum + self.basis[k][p] * self.basis[l][p]);
                self.gram[k][l] =
                    (r..l).fold(product, |sum, i| sum - self.gram[k][i] * self.gram[l][i] * self.gram[i][i]);
                if k != l {
                    self.gram[k][l] = self.gram[k][l] / self.gram[l][l];
                }
            }
        }
    }

    /// q̈ and λ for one right side.
    pub(crate) fn solve(&self, force: [T; N], target: [T; K]) -> Result<([T; N], [T; K]), Fault<T>> {
        let Scales { columns: s, rows: t, mass, .. } = self.scales;
        let force = core::array::from_fn(|i| scaled(force[i], -s[i] - mass));
        let target = core::array::from_fn(|k| scaled(target[k], -t[k]));
        let motion = self.motion(&force, &target);
        self.check(&motion, &target)?;
        let multipliers = self.multipliers(&motion, &force);
        let motion: [T; N] = core::array::from_fn(|i| scaled(motion[i], -s[i]));
        let multipliers: [T; K] = core::array::from_fn(|k| scaled(multipliers[k], mass - t[k]));
        if motion.iter().chain(&multipliers).all(|&x| is_finite(x)) {
            Ok((motion, multipliers))
        } else {
            Err(Fault::NonFinite)
        }
    }

    /// q̈, scaled.
    fn motion(&self, force: &[T; N], target: &[T; K]) -> [T; N] {
        let (r, s) = (self.rank, N - self.rank);
        let m = |i: usize, j: usize| self.mass[self.columns[i]][self.columns[j]];
        let mut q = [T::zero(); N];
        for p in 0..r {
            q[p] = (0..p).fold(target[self.rows[p]], |sum, i| sum - self.basis[p][i] * q[i]);
        }
        for p in (0..r).rev() {
            let rest = (p + 1..r).fold(q[p], |sum, i| sum - self.basis[p][i] * q[i]);
            q[p] = rest * self.reciprocals[p];
        }
        let force: [T; N] =
            core::array::from_fn(|i| (0..r).fold(force[self.columns[i]], |sum, p| sum - m(i, p) * q[p]));
        for i in 0..s {
            let along = (0..r).fold(force[r + i], |sum, p| sum - self.basis[p][r + i] * force[p]);
            q[r + i] = (0..i).fold(along, |sum, j| sum - self.inertia[i][j] * q[r + j]);
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

    /// Whether the rows that depend on others ask for what those give.
    fn check(&self, motion: &[T; N], target: &[T; K]) -> Result<(), Fault<T>> {
        let largest = |largest: T, &x: &T| if is_less(largest, magnitude(x)) { magnitude(x) } else { largest };
        for k in self.rank..K {
            let (mut rest, mut size) = (target[self.rows[k]], magnitude(target[self.rows[k]]));
            for p in 0..self.rank {
                let term = self.basis[k][p] * target[self.rows[p]];
                (rest, size) = (rest - term, size + magnitude(term));
            }
            let allowed = (size + motion.iter().fold(T::zero(), largest)) * T::from_f64(root(T::ROUNDING));
            if !is_less(magnitude(rest), allowed) && !rest.equal(T::zero()).all() {
                let row = self.rows[k];
                return Err(Fault::Contradiction { row, residual: scaled(rest, self.scales.rows[row]) });
            }
        }
        Ok(())
    }

    /// λ, scaled: of least norm where rows depend on others.
    fn multipliers(&self, motion: &[T; N], force: &[T; N]) -> [T; K] {
        let r = self.rank;
        let mut l = [T::zero(); K];
        for p in 0..r {
            let i = self.columns[p];
            let h = (0..N).fold(-force[i], |sum, j| sum + self.mass[i][j] * motion[j]);
            let rest = (0..p).fold(h, |sum, q| sum - self.basis[q][p] * l[q]);
            l[p] = rest * self.reciprocals[p];
        }
        for p in (0..r).rev() {
            l[p] = (p + 1..r).fold(l[p], |sum, k| sum - self.basis[k][p] * l[k]);
        }
        self.share_with_redundant_rows(&mut l);
        let mut multipliers = [T::zero(); K];
        for k in 0..K {
            multipliers[self.rows[k]] = l[k];
        }
        multipliers
    }

    /// From `λ₁` alone to the least `λ₁² + λ₂²` of the same `λ₁ + Gᵀ λ₂`.
    fn share_with_redundant_rows(&self, l: &mut [T; K]) {
        let r = self.rank;
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
