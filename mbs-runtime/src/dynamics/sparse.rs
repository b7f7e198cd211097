//! Forward dynamics with many constraints, most of whose system is zero: eliminated in an order that was chosen before.
//!
//! ```text
//! ⎡ M  Aᵀ ⎤ ⎡  q̈ ⎤   ⎡ f ⎤
//! ⎣ A  0  ⎦ ⎣ −λ ⎦ = ⎣ c ⎦        K = L D Lᵀ
//! ```
//!
//! A multiplier is eliminated after all coordinates of its row. Where M is positive definite, pivots of coordinates
//! are then positive and those of multipliers negative, so that no entry has to be exchanged for another; each row
//! may be off by a small share `e` of its multiplier, so that this holds where it depends on others, too. The
//! operations, each rounded by itself, with steps in the order of elimination:
//!
//! ```text
//! for k in steps of coordinates:                      e[i] += (K[i][k]·K[i][k]) / K[k][k], i of multipliers
//! for i in steps of multipliers:                      d[i] = −share·e[i], or −1 where e[i] is no greater than zero
//! for k in steps:                                     r[k] = 1 / d[k]
//!     for i behind k in the column of k:              l[i][k] = u[i][k]·r[k]
//!                                                     d[i] −= u[i][k]·l[i][k]
//!         for j behind i in the column of k:          u[j][i] −= l[i][k]·u[j][k]
//! solve:  for k in steps, for i in the column of k:   x[i] −= l[i][k]·x[k]
//!         for k in steps, last first:                 x[k] = ((x[k]·r[k] − l[i][k]·x[i]) − l[j][k]·x[j]) − …
//! ```
//!
//! What is left, `b − K x`, is solved for and added until it is rounding of the terms, among them a share of `√Mᵢᵢ s`
//! and of `√e s` with the greatest `s = √Mᵢᵢ |q̈ᵢ|`, and of what a row is off by, `share·e |λ|`: of a chain that hangs
//! at rest accelerations are nothing but rounding of forces, which rows are told from by that. It takes back what the
//! shares and the order of the pivots have lost, and finds rows that contradict each other, since a share of what they
//! are off by is less than that. Of rows that depend on others the multipliers are those of least `Σ e λ²`.
//!
//! Sources: R. J. Vanderbei, *Symmetric quasidefinite matrices*, SIAM Journal on Optimization 5, 1995; P. E. Gill, M.
//! A. Saunders, J. R. Shinnerl, *On the stability of Cholesky factorization for symmetric quasidefinite systems*,
//! SIAM Journal on Matrix Analysis and Applications 17, 1996; R. T. Rockafellar, *Augmented Lagrangians and
//! applications of the proximal point algorithm in convex programming*, Mathematics of Operations Research 1, 1976.

use crate::scalar::{Mask, Real, Scalar};

mod derivative;

/// The share of what its multiplier moves by which a row may be off, in roundings.
const SHARE: f64 = 1e3;

/// Less than this is left of the terms of a coordinate's pivot where it has no inertia, in roundings.
const NOTHING: f64 = 1e4;

/// What is left of an equation is rounding: of its terms and of a share of what moves most, in roundings.
const EXACT: [f64; 2] = [16.0, 1e-6];

/// What is left agrees with its equation, likewise.
const AGREES: [f64; 2] = [1e6, 1e-4];

/// What is left is no more than this share of its terms, however few digits there are.
const LOOSEST: f64 = 1e-3;

/// How often what is left is solved for at most.
const ROUNDS: usize = 25;

/// No more than this share of what its multiplier moves is left of a row that depends on others, and no more than
/// twice the square root of the share by which rows may be off: of rows that are parallel but for an angle `ε` a third
/// one is off by that share over `ε²`.
const DEPENDENT: f64 = 1e-5;

/// In which order the unknowns of a symmetric system are eliminated, and where its entries are, as the generator has
/// found it: of `U` unknowns, accelerations and behind them multipliers, `E` entries that are not zero, and `L` below
/// the diagonal of the factor.
///
/// The numbers have to be those of an elimination that goes through; [`sparse_solve`] panics where one of them points
/// nowhere.
#[derive(Clone, Copy, Debug)]
pub struct Elimination<const U: usize, const E: usize, const L: usize> {
    /// The unknown of each step.
    pub order: &'static [u16; U],
    /// Where the column of each step ends in `rows`.
    pub ends: &'static [u32; U],
    /// The steps that have entries in the columns of the factor, rising in each.
    pub rows: &'static [u16; L],
    /// Where each entry of the system stands: on the diagonal the number of its step, below it `U` and its place in
    /// `rows`.
    pub places: &'static [u32; E],
}

impl<const U: usize, const E: usize, const L: usize> Elimination<U, E, L> {
    /// Writes M in full, row by row, to `m`, which has `N²` numbers; entries of A are left out.
    ///
    /// # Panics
    /// If `m` has fewer numbers.
    pub fn write_mass_matrix<T: Scalar>(&self, entries: &[T; E], coordinates: usize, m: &mut [T]) {
        let n = coordinates;
        m.fill(T::zero());
        for ([i, j], entry) in self.unknowns().zip(entries) {
            if i < n {
                (m[i * n + j], m[j * n + i]) = (*entry, *entry);
            }
        }
    }

    /// Writes A in full, row by row, to `a`, which has `K·N` numbers; entries of M are left out.
    ///
    /// # Panics
    /// If `a` has fewer numbers.
    pub fn write_jacobian<T: Scalar>(&self, entries: &[T; E], coordinates: usize, a: &mut [T]) {
        a.fill(T::zero());
        for ([i, j], entry) in self.unknowns().zip(entries) {
            if i >= coordinates {
                a[(i - coordinates) * coordinates + j] = *entry;
            }
        }
    }

    /// The two unknowns that each entry couples, the greater first.
    fn unknowns(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.places.iter().map(|&place| {
            let [row, column] = match (place as usize).checked_sub(U) {
                None => [place as usize; 2],
                Some(of_rows) => [self.rows[of_rows].into(), self.ends.partition_point(|&end| end as usize <= of_rows)],
            };
            let [a, b] = [row, column].map(|step| usize::from(self.order[step]));
            [a.max(b), a.min(b)]
        })
    }
}

/// Accelerations and multipliers of a mechanism with many constraints, most of which are not coupled:
/// `M q̈ − Aᵀ λ = f`, `A q̈ = c`.
///
/// | argument      | meaning                                                              | shape |
/// |---------------|----------------------------------------------------------------------|-------|
/// | `elimination` | the order of elimination                                             |       |
/// | `entries`     | the entries of M's lower triangle and of A that are not zero         | `E`   |
/// | `force`       | `f = Q − C q̇ − G − ∂D/∂q̇`                                            | `N`   |
/// | `target`      | `c = −γ`                                                             | `K`   |
///
/// Of `U = N + K` unknowns. Of dual numbers the derivatives are a second solution, `q̈′ = K⁻¹ (b′ − K′ x)`, and NaN
/// where that one contradicts itself. M has to be positive definite. Rows that depend on others and agree with them
/// (to about 2e-10 of the terms, 1e-3 for `f32`) leave `q̈` and `Aᵀ λ` as they are. Everything is NaN where a
/// coordinate has no inertia, where rows contradict each other, and where a number is infinite or NaN.
/// [`constrained_solve`](crate::constrained_solve) takes M that is singular, too, in time that grows with the cube of
/// the unknowns.
///
/// ```
/// use mbs_runtime::{Elimination, sparse_solve};
/// // Two beads of masses 1 and 2 on a rod along the line that they move on, the first one pulled with 6.
/// let elimination = Elimination { order: &[0, 1, 2], ends: &[1, 2, 2], rows: &[2, 2], places: &[0, 1, 3, 4] };
/// let (q, l) = sparse_solve(&elimination, [1.0, 2.0, -1.0, 1.0], [6.0, 0.0], [0.0]);
/// assert_eq!((q, l), ([2.0, 2.0], [4.0]));
/// ```
///
/// Source: R. J. Vanderbei, *Symmetric quasidefinite matrices*, SIAM Journal on Optimization 5, 1995.
#[must_use]
pub fn sparse_solve<T: Scalar, const N: usize, const K: usize, const U: usize, const E: usize, const L: usize>(
    elimination: &Elimination<U, E, L>,
    entries: [T; E],
    force: [T; N],
    target: [T; K],
) -> ([T; N], [T; K]) {
    Factors::new(elimination, N, &entries).solve(elimination, &force, &target)
}

/// [`sparse_solve`] for the derivatives of accelerations: column by column what it gives, to the bit.
#[must_use]
pub fn sparse_slopes<
    T: Scalar,
    const N: usize,
    const K: usize,
    const C: usize,
    const U: usize,
    const E: usize,
    const L: usize,
>(
    elimination: &Elimination<U, E, L>,
    entries: [T; E],
    force: [[T; C]; N],
    target: [[T; C]; K],
) -> [[T; C]; N] {
    let factors = Factors::new(elimination, N, &entries);
    let mut slopes = [[T::zero(); C]; N];
    for column in 0..C {
        let (force, target) = (force.map(|row| row[column]), target.map(|row| row[column]));
        let (accelerations, _) = factors.solve(elimination, &force, &target);
        slopes.iter_mut().zip(accelerations).for_each(|(row, slope)| row[column] = slope);
    }
    slopes
}

/// The δ of least `δᵀ M δ` with `A δ = target`, and the rank of A, as [`Constraints::least_change`] gives them; `None`
/// where [`sparse_solve`] is NaN.
///
/// The arguments are those of [`sparse_solve`]. Rows count as dependent where they are parallel to others but for an
/// angle of 3e-3 (0.15 for `f32`) in the metric of M: a rank of all rows is certain, a smaller one is not.
///
/// ```
/// use mbs_runtime::{Elimination, sparse_least_change};
/// // Two beads of masses 1 and 2 on a line, to be brought apart by 3.
/// let elimination = Elimination { order: &[0, 1, 2], ends: &[1, 2, 2], rows: &[2, 2], places: &[0, 1, 3, 4] };
/// let (change, rank) = sparse_least_change(&elimination, [1.0, 2.0, -1.0, 1.0], [3.0]).unwrap();
/// assert_eq!((change, rank), ([-2.0, 1.0], 1));
/// ```
///
/// [`Constraints::least_change`]: crate::Constraints::least_change
#[must_use]
pub fn sparse_least_change<T: Real, const N: usize, const K: usize, const U: usize, const E: usize, const L: usize>(
    elimination: &Elimination<U, E, L>,
    entries: [T; E],
    target: [T; K],
) -> Option<([T; N], usize)> {
    let factors = Factors::new(elimination, N, &entries);
    let (change, _) = factors.solve(elimination, &[T::zero(); N], &target);
    // The root is the scalar's: without `std` and `libm` `f64` has none.
    let least = T::from_f64(DEPENDENT).maximum(T::from_f64(2.0) * T::from_f64(SHARE * T::ROUNDING).sqrt());
    let is_dependent = |&(_, (&reciprocal, &weight)): &(&u16, (&T, &T))| {
        weight <= T::zero() || -T::one() / reciprocal <= least * (weight * weight)
    };
    let steps = elimination.order.iter().zip(factors.reciprocals.iter().zip(&factors.weights));
    let dependent = steps.filter(|(unknown, _)| usize::from(**unknown) >= N).filter(is_dependent).count();
    change.iter().all(|x| x.is_finite()).then_some((change, K - dependent))
}

/// `K = L D Lᵀ`, each row off by a share of its multiplier.
pub struct Factors<T: Scalar, const U: usize, const L: usize> {
    /// K itself: its diagonal, and its entries at the places of L.
    diagonal: [T; U],
    entries: [T; L],
    /// `√Mᵢᵢ` of coordinates, `√e` of multipliers.
    weights: [T; U],
    /// `1/D`
    reciprocals: [T; U],
    /// The columns of L.
    lower: [T; L],
    /// Whether all pivots have been sound.
    is_sound: T::Mask,
}

impl<T: Scalar, const U: usize, const L: usize> Factors<T, U, L> {
    fn new<const E: usize>(elimination: &Elimination<U, E, L>, coordinates: usize, entries: &[T; E]) -> Self {
        let Elimination { order, ends, rows, places } = elimination;
        let (mut diagonal, mut lower) = ([T::zero(); U], [T::zero(); L]);
        for (&place, &entry) in places.iter().zip(entries) {
            match (place as usize).checked_sub(U) {
                None => diagonal[place as usize] = entry,
                Some(place) => lower[place] = entry,
            }
        }
        let is_coordinate = |step: usize| usize::from(order[step]) < coordinates;
        let rounding = |count: f64| T::from_f64(count * T::ROUNDING);
        let (entries, mut pivots) = (lower, diagonal);
        // What each multiplier moves, in the places of its pivot.
        for step in (0..U).filter(|&step| is_coordinate(step)) {
            for a in start(ends, step)..ends[step] as usize {
                let row = usize::from(rows[a]);
                if !is_coordinate(row) {
                    pivots[row] = pivots[row] + entries[a] * entries[a] / diagonal[step];
                }
            }
        }
        let weights = pivots.map(T::sqrt);
        for step in (0..U).filter(|&step| !is_coordinate(step)) {
            let own = -(rounding(SHARE) * pivots[step]);
            pivots[step] = T::blend(T::zero().less(pivots[step]), own, -T::one());
        }
        let mut terms = pivots.map(T::abs);
        let mut reciprocals = [T::zero(); U];
        let mut is_sound = T::zero().less(T::one());
        for step in 0..U {
            let (pivot, end) = (pivots[step], ends[step] as usize);
            let (signed, least) = match is_coordinate(step) {
                true => (pivot, rounding(NOTHING) * terms[step]),
                false => (-pivot, T::zero()),
            };
            is_sound = is_sound & least.less(signed) & signed.less(T::from_f64(f64::INFINITY));
            reciprocals[step] = T::one() / pivot;
            for a in start(ends, step)..end {
                let (row, entry) = (usize::from(rows[a]), lower[a]);
                let factor = entry * reciprocals[step];
                lower[a] = factor;
                let product = entry * factor;
                pivots[row] = pivots[row] - product;
                terms[row] = terms[row] + product.abs();
                // The entries behind are those of the pivot's column still, and have places in this row's column.
                let mut place = start(ends, row);
                for b in a + 1..end {
                    while rows[place] != rows[b] {
                        place += 1;
                    }
                    lower[place] = lower[place] - factor * lower[b];
                }
            }
        }
        Factors { diagonal, entries, weights, reciprocals, lower, is_sound }
    }

    fn solve<const N: usize, const K: usize, const E: usize>(
        &self,
        elimination: &Elimination<U, E, L>,
        force: &[T; N],
        target: &[T; K],
    ) -> ([T; N], [T; K]) {
        let right_side = elimination.order.map(|unknown| {
            let unknown = usize::from(unknown);
            if unknown < N { force[unknown] } else { target[unknown - N] }
        });
        let x = T::sparse_solve::<N, U, E, L>(elimination, self, &right_side, &right_side.map(T::abs));
        let (mut accelerations, mut multipliers) = ([T::zero(); N], [T::zero(); K]);
        for (&unknown, &x) in elimination.order.iter().zip(&x) {
            let unknown = usize::from(unknown);
            if unknown < N { accelerations[unknown] = x } else { multipliers[unknown - N] = -x }
        }
        (accelerations, multipliers)
    }

    /// The unknowns in the order of elimination, NaN where they do not solve `K x = b`; `sizes` are those of the terms
    /// that `b` is the sum of.
    pub(crate) fn refined<const N: usize, const E: usize>(
        &self,
        elimination: &Elimination<U, E, L>,
        right_side: &[T; U],
        sizes: &[T; U],
    ) -> [T; U] {
        let mut x = *right_side;
        self.substitute(elimination, &mut x);
        for round in 0..ROUNDS {
            let (mut rest, exact) = self.rest::<N, E>(elimination, (right_side, sizes), &x, EXACT);
            if round > 0 && exact.all() {
                break;
            }
            self.substitute(elimination, &mut rest);
            for step in 0..U {
                let changed = x[step] + rest[step];
                x[step] = if round > 0 { T::blend(exact, x[step], changed) } else { changed };
            }
        }
        let is_solved = self.is_sound & self.rest::<N, E>(elimination, (right_side, sizes), &x, AGREES).1;
        x.map(|x| T::blend(is_solved, x, T::from_f64(f64::NAN)))
    }

    /// `x ← (L D Lᵀ)⁻¹ x`
    fn substitute<const E: usize>(&self, elimination: &Elimination<U, E, L>, x: &mut [T; U]) {
        let Elimination { ends, rows, .. } = elimination;
        for step in 0..U {
            for a in start(ends, step)..ends[step] as usize {
                let row = usize::from(rows[a]);
                x[row] = x[row] - self.lower[a] * x[step];
            }
        }
        for step in (0..U).rev() {
            let mut sum = x[step] * self.reciprocals[step];
            for a in start(ends, step)..ends[step] as usize {
                sum = sum - self.lower[a] * x[usize::from(rows[a])];
            }
            x[step] = sum;
        }
    }

    /// `b − K x`, and whether it is no more than as many roundings of its terms, of each lane by itself.
    fn rest<const N: usize, const E: usize>(
        &self,
        elimination: &Elimination<U, E, L>,
        (right_side, sizes): (&[T; U], &[T; U]),
        x: &[T; U],
        [roundings, share]: [f64; 2],
    ) -> ([T; U], T::Mask) {
        let order = elimination.order;
        let moving = order.iter().zip(x.iter().zip(&self.weights)).filter(|(unknown, _)| usize::from(**unknown) < N);
        let size = moving.fold(T::zero(), |size, (_, (&x, &weight))| size.maximum((x * weight).abs()));
        let (size, off) = (T::from_f64(share) * size, T::from_f64(share * SHARE * T::ROUNDING));
        let (mut rest, mut terms) = (*right_side, *sizes);
        for (step, (terms, &weight)) in terms.iter_mut().zip(&self.weights).enumerate() {
            *terms = *terms + weight * size;
            if usize::from(order[step]) >= N {
                *terms = *terms + off * (weight * weight) * x[step].abs();
            }
        }
        take_away(elimination, (&self.diagonal, &self.entries), x, (&mut rest, &mut terms));
        let most = T::from_f64((roundings * T::ROUNDING).min(LOOSEST));
        let agrees = rest.iter().zip(&terms).map(|(rest, &terms)| rest.abs().less_equal(most * terms));
        // An infinite number has infinite terms.
        let is_finite = terms.iter().map(|terms| terms.less(T::from_f64(f64::INFINITY)));
        let all = agrees.chain(is_finite).fold(T::zero().less(T::one()), |all, agrees| all & agrees);
        (rest, all)
    }
}

/// `rest ← rest − K x`, and the sizes of what is taken away added to those of its terms.
fn take_away<T: Scalar, const U: usize, const E: usize, const L: usize>(
    Elimination { ends, rows, .. }: &Elimination<U, E, L>,
    (diagonal, entries): (&[T; U], &[T; L]),
    x: &[T; U],
    (rest, terms): (&mut [T; U], &mut [T; U]),
) {
    let mut take = |step: usize, product: T| {
        rest[step] = rest[step] - product;
        terms[step] = terms[step] + product.abs();
    };
    for step in 0..U {
        take(step, diagonal[step] * x[step]);
        for a in start(ends, step)..ends[step] as usize {
            let row = usize::from(rows[a]);
            take(row, entries[a] * x[step]);
            take(step, entries[a] * x[row]);
        }
    }
}

/// Where the column of a step begins.
fn start<const U: usize>(ends: &[u32; U], step: usize) -> usize {
    step.checked_sub(1).map_or(0, |before| ends[before] as usize)
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::dual::Dual;
    use crate::dynamics::constrained_solve;

    /// Masses in a row, coupled with their neighbours, and a row for each pair of them.
    const ELIMINATION: Elimination<5, 9, 7> = Elimination {
        order: &[0, 2, 1, 3, 4],
        ends: &[2, 4, 6, 7, 7],
        rows: &[2, 3, 2, 4, 3, 4, 4],
        places: &[0, 5, 2, 7, 1, 6, 9, 10, 8],
    };
    const ENTRIES: [f64; 9] = [2.0, 0.5, 3.0, -0.25, 4.0, 1.0, -1.5, 0.75, 2.0];

    fn full(entries: [f64; 9]) -> ([[f64; 3]; 3], [[f64; 3]; 2]) {
        let [m00, m10, m11, m21, m22, a00, a01, a11, a12] = entries;
        ([[m00, m10, 0.0], [m10, m11, m21], [0.0, m21, m22]], [[a00, a01, 0.0], [0.0, a11, a12]])
    }

    #[test]
    fn it_solves_what_the_null_space_solves() {
        let (m, a) = full(ENTRIES);
        let (force, target) = ([1.0, -2.0, 0.5], [0.3, -0.7]);
        let (q, l) = sparse_solve(&ELIMINATION, ENTRIES, force, target);
        let (expected_q, expected_l) = constrained_solve(m, a, force, target);
        for (found, expected) in q.iter().chain(&l).zip(expected_q.iter().chain(&expected_l)) {
            assert!((found - expected).abs() < 1e-14, "{q:?} {l:?} {expected_q:?} {expected_l:?}");
        }
        let slopes = sparse_slopes(&ELIMINATION, ENTRIES, force.map(|f| [0.0, f]), target.map(|c| [0.0, c]));
        assert_eq!(slopes, q.map(|q| [0.0, q]));
    }

    #[test]
    fn matrices_are_written_in_full_and_changes_are_the_least() {
        let (m, a) = full(ENTRIES);
        let (mut written, mut rows) = ([f64::NAN; 9], [f64::NAN; 6]);
        ELIMINATION.write_mass_matrix(&ENTRIES, 3, &mut written);
        ELIMINATION.write_jacobian(&ENTRIES, 3, &mut rows);
        let lower = |i: usize, j: usize| m[i.max(j)][i.min(j)];
        assert!((0..9).all(|k| written[k].to_bits() == lower(k / 3, k % 3).to_bits()), "{written:?}");
        assert_eq!(rows, *a.as_flattened());
        let (change, rank): ([f64; 3], _) = sparse_least_change(&ELIMINATION, ENTRIES, [0.3, -0.7]).unwrap();
        let (expected, _) = constrained_solve(m, a, [0.0; 3], [0.3, -0.7]);
        assert!(change.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{change:?} {expected:?}");
        assert_eq!(rank, 2);
        // Twice the same row; then one that asks for something else, and a row of zeros.
        let with = |a: [f64; 4]| [2.0, 0.5, 3.0, -0.25, 4.0, a[0], a[1], a[2], a[3]];
        let found = |a: [f64; 4], target| sparse_least_change::<f64, 3, 2, 5, 9, 7>(&ELIMINATION, with(a), target);
        assert_eq!(found([0.0, 1.5, 0.75, 0.0], [0.2, 0.1]).map(|(_, rank)| rank), Some(1));
        assert_eq!(found([0.0, 1.5, 0.75, 0.0], [0.2, 0.3]), None);
        assert_eq!(found([0.0, 0.0, 0.75, 2.0], [0.0, 0.1]).map(|(_, rank)| rank), Some(1));
        // The third row is the sum of the others, which are parallel but for an angle of 7e-5 to 7e-2: their pivots
        // leave of it what rows may be off by, many times over.
        let three = Elimination {
            order: &[0, 1, 2, 3, 4],
            ends: &[3, 6, 8, 9, 9],
            rows: &[2, 3, 4, 2, 3, 4, 3, 4, 4],
            places: &[0, 1, 5, 8, 6, 9, 7, 10],
        };
        for angle in [1e-4, 1e-3, 3e-3, 1e-2, 1e-1] {
            let entries = [1.0, 1.0, 1.0, 0.0, 1.0, angle, 2.0, angle];
            let (change, rank): ([f64; 2], _) = sparse_least_change(&three, entries, [0.5, 0.5, 1.0]).unwrap();
            assert!(rank < 3, "{angle}: {rank}");
            assert!((change[0] - 0.5).abs() < 1e-10 && change[1].abs() < 1e-10 / angle, "{angle}: {change:?}");
        }
        // In single precision as well.
        let single = with([0.0, 1.5, 0.75, 0.0]).map(|x| x as f32);
        let (_, rank) = sparse_least_change::<f32, 3, 2, 5, 9, 7>(&ELIMINATION, single, [0.2, 0.1]).unwrap();
        assert_eq!(rank, 1);
        let (_, rank) =
            sparse_least_change::<f32, 3, 2, 5, 9, 7>(&ELIMINATION, ENTRIES.map(|x| x as f32), [0.2, 0.1]).unwrap();
        assert_eq!(rank, 2);
    }

    #[test]
    fn dual_numbers_differentiate_the_solution() {
        let (force, target) = ([1.0, -2.0, 0.5], [0.3, -0.7]);
        let varied = |change: f64| {
            let mut entries = ENTRIES;
            (entries[2], entries[6]) = (entries[2] + change, entries[6] - 2.0 * change);
            sparse_solve(&ELIMINATION, entries, force, target).0
        };
        let mut entries = ENTRIES.map(Dual::constant);
        (entries[2].derivative, entries[6].derivative) = (1.0, -2.0);
        let (q, _) = sparse_solve(&ELIMINATION, entries, force.map(Dual::constant), target.map(Dual::constant));
        let (before, after) = (varied(-1e-6), varied(1e-6));
        for i in 0..3 {
            let slope = (after[i] - before[i]) / 2e-6;
            assert!((q[i].derivative - slope).abs() < 1e-8, "{i}: {:?} {slope}", q[i]);
        }
        entries[0] = Dual::constant(0.0);
        let (q, _) = sparse_solve(&ELIMINATION, entries, force.map(Dual::constant), target.map(Dual::constant));
        assert!(q.iter().all(|q| q.value.is_nan() && q.derivative.is_nan()));
    }

    /// To the bit what the solution of these numbers is, where values are exact and where derivatives have none.
    #[test]
    fn derivatives_are_solved_for_as_values_are() {
        let check = |entries: [f64; 9], force: [f64; 3], target: [f64; 2]| {
            let rate = |derivative: f64| Dual { value: 0.0, derivative };
            let (q, l) = sparse_solve(&ELIMINATION, entries.map(Dual::constant), force.map(rate), target.map(rate));
            let (expected_q, expected_l) = sparse_solve(&ELIMINATION, entries, force, target);
            for (found, expected) in q.iter().chain(&l).zip(expected_q.iter().chain(&expected_l)) {
                assert!(found.value == 0.0, "{found:?}");
                assert!(found.derivative == *expected || expected.is_nan() && found.derivative.is_nan(), "{found:?}");
            }
            expected_q[0].is_finite()
        };
        for (size, is_solved) in [(1e2, true), (1e5, true), (1e6, true), (1e8, false)] {
            let entries = [size, 0.0, 1.0 / size, 0.0, size, 1.0, -1.0, 1.0, -1.0];
            assert_eq!(check(entries, [1.0, 0.5, 0.5], [0.0; 2]), is_solved, "{size:e}");
        }
        let twice = [2.0, 0.5, 3.0, -0.25, 4.0, 0.0, 1.5, 0.75, 0.0];
        assert!(check(twice, [0.0; 3], [0.2, 0.1]) && !check(twice, [0.0; 3], [0.2, 0.3]));
    }

    #[test]
    fn what_has_no_solution_is_nan() {
        let is_undefined = |entries: [f64; 9], force: f64, target: f64| {
            let (q, l) = sparse_solve(&ELIMINATION, entries, [force, 0.0, 0.0], [0.0, target]);
            assert!(q.iter().chain(&l).all(|x| x.is_nan()) || q.iter().chain(&l).all(|x| x.is_finite()));
            q[0].is_nan()
        };
        assert!(!is_undefined(ENTRIES, 1.0, 1.0));
        // A row of zeros, and one that follows from the other: they may ask for nothing else.
        for a in [[0.0, 0.0, 0.75, 2.0], [0.0, 0.75, 0.75, 0.0], [0.0, 1.5, 0.75, 0.0]] {
            let entries = [2.0, 0.5, 3.0, -0.25, 4.0, a[0], a[1], a[2], a[3]];
            assert!(!is_undefined(entries, 1.0, 0.0), "{a:?}");
            assert_eq!(is_undefined(entries, 1.0, 1.0), a[1] != 0.0, "{a:?}");
        }
        // No inertia, and a negative one.
        assert!(is_undefined([0.0, 0.0, 3.0, -0.25, 4.0, 1.0, -1.5, 0.75, 2.0], 1.0, 0.0));
        assert!(is_undefined([2.0, 0.5, -3.0, -0.25, 4.0, 1.0, -1.5, 0.75, 2.0], 1.0, 0.0));
        // Infinite and NaN.
        assert!(is_undefined([f64::INFINITY, 0.5, 3.0, -0.25, 4.0, 1.0, -1.5, 0.75, 2.0], 1.0, 0.0));
        assert!(is_undefined([2.0, 0.5, 3.0, f64::NAN, 4.0, 1.0, -1.5, 0.75, 2.0], 1.0, 0.0));
        assert!(is_undefined(ENTRIES, f64::NAN, 0.0) && is_undefined(ENTRIES, f64::INFINITY, 0.0));
    }

    /// Three particles that hang below each other on rods: rows hold all of them, and `λ = −(n − i) m g/(2 l)` of rows
    /// `Δy² = l²` holds what is below.
    #[test]
    fn a_chain_at_rest_hangs() {
        let chain = Elimination {
            order: &[0, 1, 2, 3, 4, 5],
            ends: &[2, 4, 5, 6, 7, 7],
            rows: &[3, 4, 4, 5, 5, 4, 5],
            places: &[0, 1, 2, 6, 7, 8, 9, 10],
        };
        for number in 1..1000 {
            let (m, l, g) = (0.3 * f64::from(number), 0.1 + 0.01 * f64::from(number), 9.81);
            let rods = [-2.0 * l, 2.0 * l, -2.0 * l, 2.0 * l, -2.0 * l];
            let entries = [m, m, m, rods[0], rods[1], rods[2], rods[3], rods[4]];
            let (q, multipliers) = sparse_solve(&chain, entries, [-m * g; 3], [0.0; 3]);
            assert!(q.iter().all(|q| q.abs() < 1e-14), "{number}: {q:?}");
            for (below, found) in [3.0, 2.0, 1.0].into_iter().zip(multipliers) {
                let expected = -below * m * g / (2.0 * l);
                assert!((found / expected - 1.0).abs() < 1e-14, "{number}: {multipliers:?}");
            }
        }
    }

    /// Masses that differ by many powers of ten, which rods tie to each other: pivots alone leave few digits, and
    /// where they leave none, that is said.
    #[test]
    fn what_pivots_lose_is_taken_back() {
        for size in [1e2_f64, 1e4, 1e6, 1e8, 1e12] {
            let entries = [size, 0.0, 1.0 / size, 0.0, size, 1.0, -1.0, 1.0, -1.0];
            let (q, l) = sparse_solve(&ELIMINATION, entries, [1.0, 0.5, 0.5], [0.0; 2]);
            if size > 1e6 && q.iter().chain(&l).all(|x| x.is_nan()) {
                continue;
            }
            // One body of all masses.
            let expected = 2.0 / (2.0 * size + 1.0 / size);
            assert!(q.iter().all(|q| (q / expected - 1.0).abs() < 1e-10), "{size:e}: {q:?}");
            let expected = [size * expected - 1.0, 0.5 - size * expected];
            assert!(l.iter().zip(expected).all(|(l, expected)| (l - expected).abs() < 1e-10), "{size:e}: {l:?}");
        }
    }
}
