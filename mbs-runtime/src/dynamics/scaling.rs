//! Powers of two that bring `M` and `A` to order one, and which coordinate each row of `A` is solved for.
//!
//! With `D = diag(2^−sᵢ)` and `R = diag(2^−tₖ)` the scaled system has `D M D`, `R A D`. A change of units multiplies
//! rows and columns by powers of two; what is scaled stays the same to the bit, because scales follow from exponents of
//! entries alone, by differences that units drop out of:
//!
//! 1. Each row takes the coordinate that it moves most easily: rows are assigned to coordinates so that
//!    `Π aₖᵢ² / Mᵢᵢ` is greatest over all assignments, coordinates without inertia before all others.
//! 2. A coordinate is scaled to an inertia of one, `dᵢ = 1/√Mᵢᵢ`; one that a row has taken to a greater one where
//!    another row would else have an entry greater than the one it has taken.
//! 3. A coordinate without inertia is scaled so that the entry taken is as great as the greatest of its row.
//! 4. A row is scaled to a greatest entry of one. Rows of one vector share a unit: where another of them moves the same
//!    coordinates more, that is scaled to one; a row of zeros has the scale of its vector.
//!
//! So a zero that rounding has turned into 1e-16 changes nothing: not in the diagonal of `M`, because what has next to
//! no inertia is taken and scaled by rows, and not in `A`, because it is not taken, and pivots are those that are.
//!
//! Source: I. S. Duff, J. Koster, *On algorithms for permuting large entries to the diagonal of a sparse matrix*, SIAM
//! J. Matrix Anal. Appl. 22 (2001), section 2 (greatest product, scaling by its dual variables); I. S. Duff, S.
//! Pralet, *Strategies for scaling and pivoting for sparse symmetric indefinite problems*, SIAM J. Matrix Anal. Appl.
//! 27 (2005), section 3; R. Jonker, A. Volgenant, *A shortest augmenting path algorithm for dense and sparse linear
//! assignment problems*, Computing 38 (1987).

use crate::scalar::{Mask, Scalar};

/// Twice an exponent; those of units, which need not be even, stay apart from those of squares.
type Doubled = i64;

/// A coordinate without inertia is taken before all others: more than the exponents of a path through all rows add up
/// to.
const WEIGHTLESS: Doubled = 1 << 32;

/// Of an entry that is zero: so far below all others that sums with others are, too.
const ABSENT: Doubled = -(1 << 59);

/// An entry that is less than another of its vector in the same coordinate by more than this exponent is rounding.
const ROUNDING: Doubled = 46;

/// Farther than any, nearer than what is absent.
const UNREACHABLE: Doubled = 1 << 58;

/// Not of zeros.
fn is_present(size: Doubled) -> bool {
    size > -UNREACHABLE
}

/// `q = 2^−column q̂`, `λ = 2^(mass − row) λ̂`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scales<const N: usize, const K: usize> {
    /// The row that takes each coordinate.
    pub(crate) taken: [Option<usize>; N],
    pub(crate) columns: [i32; N],
    pub(crate) rows: [i32; K],
    /// By which power of two the greatest entry of a row is less than that of its vector.
    pub(crate) small: [i32; K],
    /// The power of two that M is scaled by.
    pub(crate) mass: i32,
}

impl<const N: usize, const K: usize> Scales<N, K> {
    /// Of a finite system; `vectors` has the number of the vector that each row is of.
    #[inline]
    pub(crate) fn of<T: Scalar>(m: &[[T; N]; N], a: &[[T; N]; K], vectors: &[usize; K]) -> Self {
        let (mut inertia, mut slopes) = ([ABSENT; N], [[ABSENT; N]; K]);
        for i in 0..N {
            inertia[i] = doubled(m[i][i]);
        }
        for k in 0..K {
            for i in 0..N {
                slopes[k][i] = doubled(a[k][i]);
            }
        }
        forget_rounding(&mut slopes, vectors);
        let taken = assignment(&inertia, &slopes);
        let sizes = sizes(&inertia, &slopes, &taken);
        // Differences from one of them, so that units of odd exponents move all of them alike.
        let reference = inertia.iter().copied().find(|&size| is_present(size)).unwrap_or(0);
        let (mut columns, mut rows, mut small) = ([0; N], [0; K], [0; K]);
        for i in 0..N {
            columns[i] = ((sizes[i] - reference).div_euclid(2)) as i32;
        }
        for k in 0..K {
            let [own, size] = row_sizes(&slopes, &columns, vectors, k);
            (rows[k], small[k]) = (size as i32, (size - own) as i32);
        }
        Scales { taken, columns, rows, small, mass: reference as i32 }
    }

    /// Whether products of two scales are exact and one multiplication brings an entry to scale.
    pub(super) fn are_small(&self) -> bool {
        let small = |x: i32| (-MOST / 2..=MOST / 2).contains(&x);
        self.columns.iter().all(|&s| small(s) && small(s + self.mass)) && self.rows.iter().all(|&t| small(t))
    }
}

/// Entries that are rounding beside another of their vector in the same coordinate, such as the zeros of a dead centre,
/// say nothing of scales.
#[inline]
fn forget_rounding<const N: usize, const K: usize>(slopes: &mut [[Doubled; N]; K], vectors: &[usize; K]) {
    for i in 0..N {
        for k in 0..K {
            let is_beside = |l: usize| vectors[l] == vectors[k] && slopes[k][i] < slopes[l][i] - ROUNDING;
            if (0..K).any(is_beside) {
                slopes[k][i] = ABSENT;
            }
        }
    }
}

/// The exponents of the greatest entry of a row, and of the greatest that its vector has in the coordinates that the
/// row moves; that of the whole vector where the row moves none.
#[inline]
fn row_sizes<const N: usize, const K: usize>(
    slopes: &[[Doubled; N]; K],
    columns: &[i32; N],
    vectors: &[usize; K],
    row: usize,
) -> [Doubled; 2] {
    let [mut own, mut moved, mut all] = [ABSENT; 3];
    for i in 0..N {
        let vector = (0..K).filter(|&k| vectors[k] == vectors[row]);
        let greatest = vector.fold(ABSENT, |greatest, k| greatest.max(slopes[k][i])) - Doubled::from(columns[i]);
        all = all.max(greatest);
        if is_present(slopes[row][i]) {
            own = own.max(slopes[row][i] - Doubled::from(columns[i]));
            moved = moved.max(greatest);
        }
    }
    let size = if is_present(moved) { moved } else { all };
    let size = if is_present(size) { size } else { 0 };
    [if is_present(own) { own } else { size - ROUNDING }, size]
}

/// Where it is not zero.
#[inline]
pub(super) fn exponent<T: Scalar>(x: T) -> Option<i32> {
    (!x.equal(T::zero()).all()).then(|| x.exponent())
}

#[inline]
fn doubled<T: Scalar>(x: T) -> Doubled {
    if x.equal(T::zero()).all() { ABSENT } else { Doubled::from(x.exponent()) }
}

/// The row that takes each coordinate, if one does: the assignment of greatest product, row by row along shortest
/// paths.
#[inline]
fn assignment<const N: usize, const K: usize>(
    inertia: &[Doubled; N],
    slopes: &[[Doubled; N]; K],
) -> [Option<usize>; N] {
    let weight =
        |row: usize, i: usize| 2 * slopes[row][i] - if is_present(inertia[i]) { inertia[i] } else { -WEIGHTLESS };
    let mut taken: [Option<usize>; N] = [None; N];
    let (mut u, mut v): ([Doubled; K], [Doubled; N]) = ([0; K], [0; N]);
    for start in 0..K {
        let (mut nearest, mut greatest) = (N, -UNREACHABLE);
        for i in 0..N {
            let value = weight(start, i) + v[i];
            (nearest, greatest) = if value > greatest { (i, value) } else { (nearest, greatest) };
        }
        // A row of zeros takes nothing; and most rows find what they want free.
        if nearest == N {
            continue;
        }
        u[start] = -greatest;
        if taken[nearest].is_none() {
            taken[nearest] = Some(start);
        } else {
            assign(&weight, &mut taken, (&mut u, &mut v), start);
        }
    }
    taken
}

/// Assigns one more row, along a shortest path.
fn assign<const N: usize, const K: usize>(
    weight: &impl Fn(usize, usize) -> Doubled,
    taken: &mut [Option<usize>; N],
    (u, v): (&mut [Doubled; K], &mut [Doubled; N]),
    start: usize,
) {
    let (mut distance, mut before, mut visited) = ([UNREACHABLE; N], [N; N], [false; N]);
    let (mut row, mut last, mut so_far) = (start, N, 0);
    let mut column = loop {
        let (mut next, mut least) = (N, UNREACHABLE);
        for i in 0..N {
            if visited[i] {
                continue;
            }
            let through = so_far - weight(row, i) - u[row] - v[i];
            if through < distance[i] {
                (distance[i], before[i]) = (through, last);
            }
            (next, least) = if distance[i] < least { (i, distance[i]) } else { (next, least) };
        }
        if next == N {
            // A row that reaches no free coordinate depends on the others.
            return;
        }
        (visited[next], so_far, last) = (true, least, next);
        match taken[next] {
            Some(other) => row = other,
            None => break next,
        }
    };
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

/// Twice the exponents of the sizes of the coordinates' inertia.
#[inline]
fn sizes<const N: usize, const K: usize>(
    inertia: &[Doubled; N],
    slopes: &[[Doubled; N]; K],
    taken: &[Option<usize>; N],
) -> [Doubled; N] {
    let mut sizes = *inertia;
    raise(&mut sizes, slopes, taken);
    if inertia.iter().all(|&size| is_present(size)) {
        return sizes;
    }
    let massless = |i: usize| taken[i].is_some() && !is_present(inertia[i]);
    (0..N).filter(|&i| massless(i)).for_each(|i| sizes[i] = ABSENT);
    relax(&mut sizes, slopes, taken, massless);
    let bound = |sizes: &[Doubled; N], i: usize| Some(lower_bound(sizes, slopes, taken, i)).filter(|&x| is_present(x));
    // Rows in which nothing has inertia.
    while let Some(i) = (0..N).find(|&i| massless(i) && !is_present(sizes[i])) {
        sizes[i] = bound(&sizes, i).unwrap_or(0);
        relax(&mut sizes, slopes, taken, massless);
    }
    core::array::from_fn(|i| if is_present(sizes[i]) { sizes[i] } else { bound(&sizes, i).unwrap_or(0) })
}

/// The least sizes, none below its own, at which no entry of a row is greater than the one taken.
#[inline]
fn raise<const N: usize, const K: usize>(
    sizes: &mut [Doubled; N],
    slopes: &[[Doubled; N]; K],
    taken: &[Option<usize>; N],
) {
    // Of each row the size of the coordinate that it has taken, by the slope; adding that of another gives its bound.
    let mut bases = [ABSENT; K];
    for i in 0..N {
        if let Some(row) = taken[i] {
            bases[row] = sizes[i] - 2 * slopes[row][i];
        }
    }
    for _ in 0..=K {
        let mut changed = false;
        for i in 0..N {
            let Some(row) = taken[i] else { continue };
            // Its own row bounds it by its own size, which raises nothing.
            let bound = (0..K).fold(ABSENT, |bound, k| bound.max(bases[k] + 2 * slopes[k][i]));
            if is_present(bound) && bound > sizes[i] {
                (sizes[i], changed) = (bound, true);
                bases[row] = bound - 2 * slopes[row][i];
            }
        }
        if !changed {
            return;
        }
    }
}

/// The greatest sizes of coordinates without inertia at which no entry of their rows is greater than the one taken.
fn relax<const N: usize, const K: usize>(
    sizes: &mut [Doubled; N],
    slopes: &[[Doubled; N]; K],
    taken: &[Option<usize>; N],
    massless: impl Fn(usize) -> bool,
) {
    for _ in 0..=K {
        let mut changed = false;
        for i in (0..N).filter(|&i| massless(i)) {
            let Some(row) = taken[i].map(|row| &slopes[row]) else { continue };
            let bounds = (0..N).filter(|&j| j != i && is_present(row[j]) && is_present(sizes[j]));
            let least = bounds.map(|j| 2 * (row[i] - row[j]) + sizes[j]).min();
            if let Some(least) = least.filter(|&least| !is_present(sizes[i]) || least < sizes[i]) {
                (sizes[i], changed) = (least, true);
            }
        }
        if !changed {
            return;
        }
    }
}

/// The least size of a coordinate at which it is in no row greater than what that has taken; absent where it is in
/// none.
fn lower_bound<const N: usize, const K: usize>(
    sizes: &[Doubled; N],
    slopes: &[[Doubled; N]; K],
    taken: &[Option<usize>; N],
    coordinate: usize,
) -> Doubled {
    let bound = |i: usize| {
        let row = &slopes[taken[i]?];
        let size = sizes[i] + 2 * (row[coordinate] - row[i]);
        is_present(size).then_some(size)
    };
    (0..N).filter(|&i| i != coordinate).filter_map(bound).max().unwrap_or(ABSENT)
}

/// One multiplication scales by at most this power of two.
const MOST: i32 = 100;

/// `2^exponent x`, exactly where the result is a normal number.
#[inline]
pub(crate) fn scaled<T: Scalar>(mut x: T, mut exponent: i32) -> T {
    while exponent.abs() > MOST {
        let step = exponent.clamp(-MOST, MOST);
        x = x * power(step);
        exponent -= step;
    }
    x * power(exponent)
}

/// `2^exponent`
#[inline]
pub(super) fn power<T: Scalar>(exponent: i32) -> T {
    T::from_f64(f64::from_bits(((1023 + exponent) as u64) << 52))
}
