//! Powers of two that bring `M` and `A` to order one, and which coordinate each row of `A` is solved for.
//!
//! With `D = diag(2^−sᵢ)` and `R = diag(2^−tₖ)` the scaled system has `D M D`, `R A D`. A change of units multiplies rows and
//! columns by powers of two; what is scaled stays the same to the bit, because scales follow from exponents of entries alone,
//! by differences that units drop out of:
//!
//! 1. Each row takes the coordinate that it moves most easily: rows are assigned to coordinates so that
//!    `Π aₖᵢ² / Mᵢᵢ` is greatest over all assignments, coordinates without inertia before all others.
//! 2. A coordinate is scaled to an inertia of one, `dᵢ = 1/√Mᵢᵢ`; one that a row has taken to a greater one where another
//!    row would else have an entry greater than the one it has taken.
//! 3. A coordinate without inertia is scaled so that the entry taken is as great as the greatest of its row.
//! 4. A row is scaled to a greatest entry of one.
//!
//! So a zero that rounding has turned into 1e-16 changes nothing: not in the diagonal of `M`, because what has next to no inertia
//! is taken and scaled by rows, and not in `A`, because it is not taken, and pivots are those that are.
//!
//! Source: I. S. Duff, J. Koster, *On algorithms for permuting large entries to the diagonal of a sparse matrix*, SIAM J. Matrix
//! Anal. Appl. 22 (2001), section 2 (greatest product, scaling by its dual variables); I. S. Duff, S. Pralet, *Strategies for
//! scaling and pivoting for sparse symmetric indefinite problems*, SIAM J. Matrix Anal. Appl. 27 (2005), section 3; R. Jonker,
//! A. Volgenant, *A shortest augmenting path algorithm for dense and sparse linear assignment problems*, Computing 38 (1987).

use crate::scalar::{Mask, Scalar};

/// Twice an exponent; those of units, which need not be even, stay apart from those of squares.
type Doubled = i64;

/// A coordinate without inertia is taken before all others: more than the exponents of a path through all rows add up to.
const WEIGHTLESS: Doubled = 1 << 32;

/// Farther than any.
const UNREACHABLE: Doubled = Doubled::MAX / 4;

/// `q = 2^−column q̂`, `λ = 2^(mass − row) λ̂`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scales<const N: usize, const K: usize> {
    /// The row that takes each coordinate.
    pub(crate) taken: [Option<usize>; N],
    pub(crate) columns: [i32; N],
    pub(crate) rows: [i32; K],
    /// Of M.
    pub(crate) mass: i32,
}

impl<const N: usize, const K: usize> Scales<N, K> {
    /// Of a finite system.
    pub(crate) fn of<T: Scalar>(m: &[[T; N]; N], a: &[[T; N]; K]) -> Self {
        let inertia: [Option<Doubled>; N] = core::array::from_fn(|i| exponent(m[i][i]).map(Doubled::from));
        let slopes = a.each_ref().map(|row| row.each_ref().map(|&x| exponent(x).map(Doubled::from)));
        let taken = assignment(&inertia, &slopes);
        let sizes = sizes(&inertia, &slopes, &taken);
        // Differences from one of them, so that units of odd exponents move all of them alike.
        let reference = inertia.iter().find_map(|&size| size).unwrap_or(0);
        let columns = sizes.map(|size| (size - reference).div_euclid(2));
        let largest = |row: &[Option<Doubled>; N]| (0..N).filter_map(|i| Some(row[i]? - columns[i])).max().unwrap_or(0);
        let rows = slopes.each_ref().map(largest);
        Scales { taken, columns: columns.map(|s| s as i32), rows: rows.map(|t| t as i32), mass: reference as i32 }
    }
}

/// Where it is not zero.
pub(super) fn exponent<T: Scalar>(x: T) -> Option<i32> {
    (!x.equal(T::zero()).all()).then(|| x.exponent())
}

/// The row that takes each coordinate, if one does: the assignment of greatest product, row by row along shortest paths.
fn assignment<const N: usize, const K: usize>(
    inertia: &[Option<Doubled>; N],
    slopes: &[[Option<Doubled>; N]; K],
) -> [Option<usize>; N] {
    let weight = |row: usize, i: usize| Some(2 * slopes[row][i]? - inertia[i].unwrap_or(-WEIGHTLESS));
    let mut taken: [Option<usize>; N] = [None; N];
    let (mut u, mut v): ([Doubled; K], [Doubled; N]) = ([0; K], [0; N]);
    for start in 0..K {
        let (mut distance, mut before, mut visited) = ([UNREACHABLE; N], [N; N], [false; N]);
        let (mut row, mut last, mut so_far) = (start, N, 0);
        u[start] = -(0..N).filter_map(|i| Some(weight(start, i)? + v[i])).max().unwrap_or(0);
        let free = loop {
            for i in (0..N).filter(|&i| !visited[i]) {
                let Some(weight) = weight(row, i) else { continue };
                let through = so_far - weight - u[row] - v[i];
                if through < distance[i] {
                    (distance[i], before[i]) = (through, last);
                }
            }
            let Some(next) = (0..N).filter(|&i| !visited[i]).min_by_key(|&i| distance[i]) else { break None };
            if distance[next] == UNREACHABLE {
                break None;
            }
            (visited[next], so_far, last) = (true, distance[next], next);
            match taken[next] {
                Some(other) => row = other,
                None => break Some(next),
            }
        };
        // A row that reaches no free coordinate depends on the others.
        let Some(mut column) = free else { continue };
        for i in (0..N).filter(|&i| visited[i] && i != column) {
            v[i] -= so_far - distance[i];
            if let Some(row) = taken[i] {
                u[row] += so_far - distance[i];
            }
        }
        u[start] += so_far;
        while before[column] < N {
            taken[column] = taken[before[column]];
            column = before[column];
        }
        taken[column] = Some(start);
    }
    taken
}

/// Twice the exponents of the sizes of the coordinates' inertia.
fn sizes<const N: usize, const K: usize>(
    inertia: &[Option<Doubled>; N],
    slopes: &[[Option<Doubled>; N]; K],
    taken: &[Option<usize>; N],
) -> [Doubled; N] {
    let mut sizes = *inertia;
    raise(&mut sizes, slopes, taken);
    let massless = |i: usize| taken[i].is_some() && inertia[i].is_none();
    (0..N).filter(|&i| massless(i)).for_each(|i| sizes[i] = None);
    relax(&mut sizes, slopes, taken, massless);
    // Rows in which nothing has inertia.
    while let Some(i) = (0..N).find(|&i| massless(i) && sizes[i].is_none()) {
        sizes[i] = lower_bound(&sizes, slopes, taken, i).or(Some(0));
        relax(&mut sizes, slopes, taken, massless);
    }
    core::array::from_fn(|i| sizes[i].or_else(|| lower_bound(&sizes, slopes, taken, i)).unwrap_or(0))
}

/// The least sizes, none below its own, at which no entry of a row is greater than the one taken.
fn raise<const N: usize, const K: usize>(
    sizes: &mut [Option<Doubled>; N],
    slopes: &[[Option<Doubled>; N]; K],
    taken: &[Option<usize>; N],
) {
    for _ in 0..=K {
        let mut changed = false;
        for i in (0..N).filter(|&i| taken[i].is_some()) {
            let bound = lower_bound(sizes, slopes, taken, i);
            if bound > sizes[i] {
                (sizes[i], changed) = (bound, true);
            }
        }
        if !changed {
            return;
        }
    }
}

/// The greatest sizes of coordinates without inertia at which no entry of their rows is greater than the one taken.
fn relax<const N: usize, const K: usize>(
    sizes: &mut [Option<Doubled>; N],
    slopes: &[[Option<Doubled>; N]; K],
    taken: &[Option<usize>; N],
    massless: impl Fn(usize) -> bool,
) {
    for _ in 0..=K {
        let mut changed = false;
        for i in (0..N).filter(|&i| massless(i)) {
            let Some((row, own)) = taken[i].and_then(|row| Some((row, slopes[row][i]?))) else { continue };
            let bound = |j: usize| Some(2 * (own - slopes[row][j]?) + sizes[j]?);
            let least = (0..N).filter(|&j| j != i).filter_map(bound).min();
            if let Some(least) = least.filter(|&least| sizes[i].is_none_or(|size| least < size)) {
                (sizes[i], changed) = (Some(least), true);
            }
        }
        if !changed {
            return;
        }
    }
}

/// The least size of a coordinate at which it is in no row greater than what that has taken.
fn lower_bound<const N: usize, const K: usize>(
    sizes: &[Option<Doubled>; N],
    slopes: &[[Option<Doubled>; N]; K],
    taken: &[Option<usize>; N],
    coordinate: usize,
) -> Option<Doubled> {
    let bound = |i: usize| {
        let row = &slopes[taken[i]?];
        Some(sizes[i]? + 2 * (row[coordinate]? - row[i]?))
    };
    (0..N).filter(|&i| i != coordinate).filter_map(bound).max()
}

/// `2^exponent x`, exactly where the result is a normal number.
pub(crate) fn scaled<T: Scalar>(mut x: T, mut exponent: i32) -> T {
    const MOST: i32 = 100;
    while exponent.abs() > MOST {
        let step = exponent.clamp(-MOST, MOST);
        x = x * power(step);
        exponent -= step;
    }
    x * power(exponent)
}

/// `2^exponent`
fn power<T: Scalar>(exponent: i32) -> T {
    T::from_f64(f64::from_bits(((1023 + exponent) as u64) << 52))
}
