//! Motions that constraints leave: `M q̈ − Aᵀ λ = f`, `A q̈ = c`, solved in a basis of the null space of `A`.
//!
//! Of the scaled system (`scaling.rs`), in this order, each operation rounded by itself, sums from left to right:
//!
//! ```text
//! A = L (U₁ U₂)        complete pivoting: the largest entry of all rows and columns left, or one nearly as large
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
//! Sources: M. Benzi, G. H. Golub, J. Liesen, *Numerical solution of saddle point problems*, Acta Numerica 14 (2005),
//! section 6 (null space methods); G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, sections 3.4.8
//! (complete pivoting) and 4.2.8 (symmetric pivoting); N. J. Higham, *Accuracy and Stability of Numerical Algorithms*,
//! 2nd ed. 2002, chapters 9, 10.

use super::scaling::{Scales, exponent, power, scaled};
use crate::scalar::{Mask, Scalar};

mod solution;

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
    /// M, scaled, in the order of `columns`; exchanges of independent coordinates are kept in the rows of dependent
    /// ones alone.
    ordered: [[T; N]; N],
    /// A, scaled.
    slopes: [[T; N]; K],
    /// Of A with rows and columns in the order of the pivots: L below, U₁ and its diagonal, W beside it; beside the
    /// rows that depend on others, what is left of them.
    basis: [[T; N]; K],
    /// `1/U₁ᵢᵢ`
    reciprocals: [T; K],
    /// How many rows are independent.
    rank: usize,
    /// The vector that each row is of.
    vectors: [usize; K],
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
    /// Whether all that it is of was.
    is_finite: bool,
}

/// What tells rounding from a contradiction and from an independent row, beside the numbers themselves: these may be
/// what is left of larger terms.
#[derive(Clone, Copy, Debug)]
pub struct Terms<'a, T, const N: usize, const K: usize, const C: usize> {
    /// The number of the vector that each row is of: its rows share a unit, and a row that is small among them is known
    /// as well as they are. Without it each row is by itself.
    pub vectors: Option<&'a [usize; K]>,
    /// How large the terms of each target are.
    pub sizes: Option<&'a [[T; C]; K]>,
    /// q̈ of the motion of which the columns are derivatives; without it each column is judged by itself.
    pub motion: Option<&'a [T; N]>,
    /// How large that is by which a column is a derivative, with any sign; zero where it is not known.
    pub scales: [T; C],
}

impl<T: Scalar, const N: usize, const K: usize, const C: usize> Terms<'_, T, N, K, C> {
    /// Nothing but the columns.
    #[inline]
    pub fn unknown() -> Self {
        Terms { vectors: None, sizes: None, motion: None, scales: [T::zero(); C] }
    }
}

/// A row of which no more than this is left depends on others: what rounding of states leaves of it where it does. Of a
/// row that is small in its vector by a power of two it is as much less, down to what rounding leaves of the vector.
fn least_slope<T: Scalar>(small: i32) -> T {
    let least = T::from_f64(root(T::ROUNDING) * 1e-2);
    if small == 0 { least } else { larger(scaled(least, -small), T::from_f64(16.0 * T::ROUNDING)) }
}

/// The square root of a power of four or twice one, from above; without a library.
fn root(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    f64::from_bits(((1023 + exponent.div_euclid(2) + exponent.rem_euclid(2)) as u64) << 52)
}

#[inline]
fn is_less<T: Scalar>(a: T, b: T) -> bool {
    a.less(b).all()
}

/// `|x|`; a sign costs nothing.
#[inline]
fn magnitude<T: Scalar>(x: T) -> T {
    if is_less(x, T::zero()) { -x } else { x }
}

#[inline]
fn is_finite<T: Scalar>(x: T) -> bool {
    is_less(magnitude(x), T::from_f64(f64::INFINITY))
}

#[inline]
fn larger<T: Scalar>(a: T, b: T) -> T {
    T::blend(a.less(b), b, a)
}

/// The greatest `|x|`, 0 of none; four at a time.
#[inline]
fn largest<T: Scalar>(row: &[T]) -> T {
    let mut found = [T::zero(); 4];
    let (fours, rest) = row.as_chunks::<4>();
    for four in fours {
        for i in 0..4 {
            found[i] = larger(found[i], four[i].abs());
        }
    }
    for &x in rest {
        found[0] = larger(found[0], x.abs());
    }
    larger(larger(found[0], found[1]), larger(found[2], found[3]))
}

/// Of the rows of A in the order of the pivots, what pivots are chosen by.
struct Rows<T, const K: usize> {
    /// Where the coordinate stands that the row has taken.
    taken: [usize; K],
    /// The greatest magnitude that is left; zero where the row depends on others.
    greatest: [T; K],
    /// What is not greater is rounding.
    least: [T; K],
    /// The greatest magnitude beside the entry taken.
    beside: [T; K],
}

impl<T: Scalar, const K: usize> Rows<T, K> {
    /// Of what is left of a row from column `p` on.
    #[inline]
    fn measure(&mut self, k: usize, p: usize, row: &[T]) {
        let taken = self.taken[k];
        if taken < p || taken >= row.len() {
            self.greatest[k] = largest(&row[p..]);
        } else {
            self.beside[k] = larger(largest(&row[p..taken]), largest(&row[taken + 1..]));
            self.greatest[k] = larger(self.beside[k], row[taken].abs());
        }
        if !is_less(self.least[k], self.greatest[k]) {
            self.greatest[k] = T::zero();
        }
    }

    #[inline]
    fn swap(&mut self, k: usize, l: usize) {
        self.taken.swap(k, l);
        self.greatest.swap(k, l);
        self.least.swap(k, l);
        self.beside.swap(k, l);
    }

    #[inline]
    fn swap_columns(&mut self, i: usize, j: usize) {
        for place in &mut self.taken {
            *place = if *place == i {
                j
            } else if *place == j {
                i
            } else {
                *place
            };
        }
    }
}

/// Whether M's lower triangle and A are; all of them are looked at, so that no branch stands between.
#[inline]
fn are_finite<T: Scalar, const N: usize, const K: usize>(m: &[[T; N]; N], a: &[[T; N]; K]) -> bool {
    let infinity = T::from_f64(f64::INFINITY);
    let mut are = true;
    for i in 0..N {
        for j in 0..=i {
            are &= is_less(m[i][j].abs(), infinity);
        }
    }
    for row in a {
        for j in 0..N {
            are &= is_less(row[j].abs(), infinity);
        }
    }
    are
}

impl<T: Scalar, const N: usize, const K: usize> NullSpace<T, N, K> {
    /// M, of which the lower triangle is read, and A in their scales, to be factorized where they are; rows of the same
    /// number in `vectors` are of one vector, without it each is by itself.
    #[inline]
    pub(crate) fn new(m: &[[T; N]; N], a: &[[T; N]; K], vectors: Option<&[usize; K]>) -> Self {
        let vectors = vectors.copied().unwrap_or(core::array::from_fn(|k| k));
        let scales = Scales::of(m, a, &vectors);
        let mut system = Self {
            scales,
            mass: [[T::zero(); N]; N],
            ordered: [[T::zero(); N]; N],
            slopes: [[T::zero(); N]; K],
            basis: [[T::zero(); N]; K],
            reciprocals: [T::zero(); K],
            rank: 0,
            vectors,
            rows: [0; K],
            columns: [0; N],
            inertia: [[T::zero(); N]; N],
            compliance: [T::zero(); N],
            gram: [[T::zero(); K]; K],
            is_finite: are_finite(m, a),
        };
        (0..K).for_each(|k| system.rows[k] = k);
        (0..N).for_each(|i| system.columns[i] = i);
        system.scale(m, a);
        system
    }

    #[inline]
    fn scale(&mut self, m: &[[T; N]; N], a: &[[T; N]; K]) {
        let Scales { columns: s, rows: t, mass, .. } = &self.scales;
        if self.scales.are_small() {
            for i in 0..N {
                for j in 0..=i {
                    self.mass[i][j] = m[i][j] * power(-s[i] - s[j] - mass);
                }
            }
            for k in 0..K {
                for i in 0..N {
                    self.basis[k][i] = a[k][i] * power(-s[i] - t[k]);
                }
            }
        } else {
            for i in 0..N {
                (0..=i).for_each(|j| self.mass[i][j] = scaled(m[i][j], -s[i] - s[j] - mass));
            }
            for k in 0..K {
                (0..N).for_each(|i| self.basis[k][i] = scaled(a[k][i], -s[i] - t[k]));
            }
        }
        for i in 0..N {
            for j in 0..i {
                self.mass[j][i] = self.mass[i][j];
            }
        }
        self.slopes = self.basis;
    }

    /// Factorizes what [`new`](Self::new) has scaled.
    #[inline]
    pub(crate) fn factorize(&mut self) -> Result<(), Fault<T>> {
        if !self.is_finite {
            return Err(Fault::NonFinite);
        }
        self.eliminate();
        // Where all rows are independent, their number is known when this is compiled, and small loops are unrolled.
        if self.rank == K { self.factorize_of_rank(K) } else { self.factorize_of_rank(self.rank) }
    }

    #[inline(always)]
    fn factorize_of_rank(&mut self, r: usize) -> Result<(), Fault<T>> {
        self.solve_for_dependent_coordinates(r);
        let bounds = self.reduce(r);
        self.factorize_inertia(r, bounds)?;
        self.relate_redundant_rows(r);
        Ok(())
    }

    /// `A = L U` with complete pivoting, until what is left is rounding.
    #[inline]
    fn eliminate(&mut self) {
        let zeros = [T::zero(); K];
        let mut rows = Rows { taken: [N; K], greatest: zeros, least: zeros, beside: zeros };
        for i in 0..N {
            if let Some(row) = self.scales.taken[i] {
                rows.taken[row] = i;
            }
        }
        for k in 0..K {
            rows.least[k] = least_slope(self.scales.small[k]);
            rows.measure(k, 0, &self.basis[k]);
        }
        for p in 0..K.min(N) {
            let Some((row, column)) = self.pivot(p, &rows) else { return };
            if row != p {
                self.basis.swap(p, row);
                self.rows.swap(p, row);
                rows.swap(p, row);
            }
            if column != p {
                self.basis.iter_mut().for_each(|row| row.swap(p, column));
                self.columns.swap(p, column);
                rows.swap_columns(p, column);
            }
            let pivots = self.basis[p];
            let reciprocal = T::one() / pivots[p];
            self.reciprocals[p] = reciprocal;
            for k in p + 1..K {
                let row = &mut self.basis[k];
                let factor = row[p] * reciprocal;
                row[p] = factor;
                for j in p + 1..N {
                    row[j] = row[j] - factor * pivots[j];
                }
                if !factor.equal(T::zero()).all() {
                    rows.measure(k, p + 1, row);
                }
            }
            self.rank = p + 1;
        }
    }

    /// The largest entry of the rows and columns that are left, the first of equal ones, if any row is independent.
    /// Entries that their rows have taken are as good while they are no less than half of it; of those the one that
    /// changes the others least.
    #[inline]
    fn pivot(&self, p: usize, rows: &Rows<T, K>) -> Option<(usize, usize)> {
        let greatest = &rows.greatest;
        let row = (p + 1..K).fold(p, |best, k| if is_less(greatest[best], greatest[k]) { k } else { best });
        if !is_less(T::zero(), greatest[row]) {
            return None;
        }
        let enough = greatest[row] * T::from_f64(0.5);
        let mut gentlest: Option<(i32, usize)> = None;
        for k in p..K {
            let i = rows.taken[k];
            if i < p || i >= N || is_less(greatest[k], enough) || is_less(self.basis[k][i].abs(), enough) {
                continue;
            }
            let Some(growth) = self.growth(p, (k, i), rows.beside[k]) else { return Some((k, i)) };
            if gentlest.is_none_or(|(least, _)| growth < least) {
                gentlest = Some((growth, k));
            }
        }
        let first = || (p..N).find(|&i| !is_less(self.basis[row][i].abs(), greatest[row])).unwrap_or(p);
        Some(gentlest.map_or_else(|| (row, first()), |(_, k)| (k, rows.taken[k])))
    }

    /// By which power of two a pivot adds to other entries at most.
    #[inline]
    fn growth(&self, p: usize, (row, column): (usize, usize), beside: T) -> Option<i32> {
        let along = exponent(beside)?;
        let across = |found: T, k: usize| if k == row { found } else { larger(found, self.basis[k][column].abs()) };
        let across = exponent((p..K).fold(T::zero(), across))?;
        Some(along + across - exponent(self.basis[row][column])?)
    }

    /// `W = U₁⁻¹ U₂`
    #[inline(always)]
    fn solve_for_dependent_coordinates(&mut self, r: usize) {
        for p in (0..r).rev() {
            let (before, after) = self.basis.split_at_mut(p + 1);
            let row = &mut before[p];
            for (i, other) in (p + 1..r).zip(after) {
                let factor = row[i];
                for j in r..N {
                    row[j] = row[j] - factor * other[j];
                }
            }
            for j in r..N {
                row[j] = row[j] * self.reciprocals[p];
            }
        }
    }

    /// S, its lower triangle in the order of the columns, and how large its diagonal's terms are.
    #[inline(always)]
    fn reduce(&mut self, r: usize) -> [T; N] {
        let s = N - r;
        for i in 0..N {
            let row = &self.mass[self.columns[i]];
            for j in 0..N {
                self.ordered[i][j] = row[self.columns[j]];
            }
        }
        let (m, w) = (&self.ordered, &self.basis);
        for j in 0..s {
            // A column of V.
            let mut carried = m[r + j];
            for i in 0..r {
                let factor = w[i][r + j];
                for p in 0..r {
                    carried[p] = carried[p] - m[i][p] * factor;
                }
            }
            for i in j..s {
                let mut entry = m[r + i][r + j];
                for p in 0..r {
                    entry = entry - m[r + i][p] * w[p][r + j];
                }
                for p in 0..r {
                    entry = entry - w[p][r + i] * carried[p];
                }
                self.inertia[i][j] = entry;
            }
        }
        let m = |i: usize, j: usize| m[i][j];
        let terms = T::from_f64(r as f64 + 1.0);
        let bound = |i: usize| {
            let own = magnitude(m(r + i, r + i));
            let sum = (0..r).fold(own, |sum, p| sum + w[p][r + i] * w[p][r + i] * magnitude(m(p, p)));
            sum * terms
        };
        core::array::from_fn(|i| if i < s { bound(i) } else { T::one() })
    }

    /// `S = L D Lᵀ`; a pivot of which only rounding is left ends it.
    #[inline(always)]
    fn factorize_inertia(&mut self, r: usize, bounds: [T; N]) -> Result<(), Fault<T>> {
        let s = N - r;
        let mut weights: [T; N] = core::array::from_fn(|i| if i < s { T::one() / bounds[i] } else { bounds[i] });
        let rounding = T::from_f64(16.0 * N as f64 * T::ROUNDING);
        for p in 0..s {
            let share = |i: usize| self.inertia[i][i] * weights[i];
            let pivot = (p + 1..s).fold(p, |best, i| if is_less(share(best), share(i)) { i } else { best });
            if !is_less(rounding, share(pivot)) {
                let index = self.columns[r + pivot];
                return Err(Fault::Singular { pivot: self.unscaled(self.inertia[pivot][pivot], index), index });
            }
            self.exchange(r, p, pivot);
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
    fn exchange(&mut self, r: usize, p: usize, i: usize) {
        if p == i {
            return;
        }
        let s = N - r;
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
        self.basis.iter_mut().for_each(|row| row.swap(r + p, r + i));
        self.ordered[..r].iter_mut().for_each(|row| row.swap(r + p, r + i));
    }

    /// `G = L₂ L₁⁻¹` in the place of L₂, the rows of L that are no pivots; `1 + G Gᵀ`, factorized.
    fn relate_redundant_rows(&mut self, r: usize) {
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
    #[inline]
    pub(crate) fn solve(&self, force: &[T; N], target: &[T; K]) -> Result<([T; N], [T; K]), Fault<T>> {
        if !force.iter().chain(target).all(|&x| is_finite(x)) {
            return Err(Fault::NonFinite);
        }
        let (force, target) = self.scaled_right_side(force, target);
        let sizes = target.map(magnitude);
        if self.rank == K {
            self.solution(K, &force, &target, &sizes)
        } else {
            self.solution(self.rank, &force, &target, &sizes)
        }
    }

    /// q̈ and λ column by column. `solutions` must hold NaN: columns that contradict the rows are not written, and none
    /// is where `terms.motion` is not finite.
    #[inline]
    pub(crate) fn solve_columns<const C: usize>(
        &self,
        force: &[[T; C]; N],
        target: &[[T; C]; K],
        terms: &Terms<'_, T, N, K, C>,
        solutions: (&mut [[T; C]; N], &mut [[T; C]; K]),
    ) {
        if terms.motion.is_some_and(|motion| !motion.iter().all(|&x| is_finite(x))) {
            return;
        }
        let column =
            |j: usize| self.scaled_right_side(&force.each_ref().map(|f| f[j]), &target.each_ref().map(|c| c[j]));
        let greatest = if self.rank == K { [T::zero(); K] } else { self.greatest_sizes(terms, column) };
        for j in 0..C {
            let (force, target) = column(j);
            let solution = if self.rank == K {
                self.solution(K, &force, &target, &target)
            } else {
                let (scale, given) = (terms.scales[j].abs(), self.given_sizes(terms, j, &target));
                let size = |k: usize| {
                    if is_less(T::zero(), scale) { larger(given[k], greatest[k] / scale) } else { given[k] }
                };
                self.solution(self.rank, &force, &target, &core::array::from_fn(size))
            };
            let Ok((q, l)) = solution else { continue };
            (0..N).for_each(|i| solutions.0[i][j] = q[i]);
            (0..K).for_each(|k| solutions.1[k][j] = l[k]);
        }
    }
}
