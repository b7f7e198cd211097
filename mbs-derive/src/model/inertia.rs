//! Whether every motion that the constraints leave has inertia: the mass matrix of the declared energies.

use crate::expr::{Dual, Expr, Residue, Rounded, Symbol, Tape, Value};

use super::degree::{Line, Problem};
use super::echelon::Echelon;
use super::rank::VelocityEquations;

/// `L + V`, which carries all velocities.
pub(super) struct Motion {
    tape: Tape,
}

impl Motion {
    pub(super) fn new(sum: Expr<'_>) -> Self {
        Motion { tape: Tape::new(&[sum]) }
    }

    /// `Mᵢⱼ = L(eᵢ + eⱼ) − L(eᵢ) − L(eⱼ) + L(0)`, the polarization of a quadratic polynomial.
    fn mass_matrix<V: Value>(&self, n: usize, at: impl Fn(&dyn Fn(u32) -> V, Symbol) -> Dual<V>) -> Vec<V> {
        let with = |i: Option<usize>, j: Option<usize>| {
            let one = |k: u32, index: Option<usize>| f64::from(u8::from(index == Some(k as usize)));
            let velocity = |k: u32| V::constant(one(k, i) + one(k, j));
            self.tape.run(|symbol| at(&velocity, symbol))[0].value
        };
        let rest = with(None, None);
        let single: Vec<V> = (0..n).map(|i| with(Some(i), None)).collect();
        let entry = |i: usize, j: usize| with(Some(i), Some(j)).sub(single[i]).sub(single[j]).add(rest);
        let lower: Vec<V> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
        let at = |i: usize, j: usize| lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        (0..n * n).map(|k| at(k / n, k % n)).collect()
    }
}

/// What is wrong with the inertia of a mechanism, if anything.
pub(super) fn problem(motion: &Motion, constraints: &VelocityEquations, lines: &[Line], n: usize) -> Option<Problem> {
    let matrix = |line: &Line| {
        let mass = motion.mass_matrix(n, |velocity, symbol| line.rounded(velocity, symbol));
        on_allowed_motions(mass, &constraints.pfaffian(line, n), n)
    };
    // Of a large mechanism, whose matrix takes n² evaluations, fewer states have to do.
    let tried = lines.iter().take(if n > 20 { 2 } else { lines.len() });
    let found: Vec<(Elimination, f64)> = tried.map(matrix).map(|m| eliminate_rounded(&m, n)).collect();
    if let Some((negative, _)) = found.iter().find(|(e, rounding)| e.smallest < -rounding) {
        return Some(Problem::NegativeInertia(negative.last));
    }
    if found.iter().any(|(e, rounding)| e.smallest > *rounding) {
        return None;
    }
    without_inertia(motion, constraints, lines, n)
}

/// The coordinates of a motion that has no inertia at any state, decided in a finite field at the defaults of the parameters;
/// where it has no values, none is said to be.
fn without_inertia(motion: &Motion, constraints: &VelocityEquations, lines: &[Line], n: usize) -> Option<Problem> {
    let first = dependence::<0>(motion, constraints, lines, n);
    let second = dependence::<1>(motion, constraints, lines, n);
    // In a field in which nothing has a value, nothing is decided.
    let coordinates = match (first, second) {
        (Some(first), Some(second)) => second.and(first),
        (only, None) | (None, only) => only.flatten(),
    }?;
    Some(match coordinates.as_slice() {
        &[alone] => Problem::NoInertia(alone),
        _ => Problem::DependentInertia(coordinates),
    })
}

/// The coordinates of a motion without inertia in one of the fields, if there is one; `None` where nothing has a value.
fn dependence<const K: usize>(
    motion: &Motion,
    constraints: &VelocityEquations,
    lines: &[Line],
    n: usize,
) -> Option<Option<Vec<usize>>> {
    const TRIED: u64 = 64;
    let line = lines.first()?;
    let echelons = (0..TRIED).filter_map(|point| {
        let mass = motion.mass_matrix(n, |velocity, symbol| line.in_field(point, velocity, symbol));
        let rows = constraints.pfaffian_in_field::<K>(line, point, n);
        // A motion without inertia is in the null space of both.
        Echelon::of(mass.chunks(n).map(<[Residue<K>]>::to_vec).chain(rows).collect())
    });
    let singular: Vec<Option<Vec<usize>>> = echelons.take(2).map(|echelon| echelon.shortest_dependence()).collect();
    (!singular.is_empty()).then(|| singular.into_iter().collect::<Option<Vec<_>>>()?.pop())
}

/// `M + Aᵀ A`, with A scaled to the size of M: positive definite where M is so on the motions that constraints leave.
fn on_allowed_motions(mut m: Vec<Rounded>, a: &[Vec<f64>], n: usize) -> Vec<Rounded> {
    let size = (0..n).fold(0.0, |s: f64, i| s.max(m[i * n + i].value.abs()));
    for row in a {
        let squared = row.iter().map(|x| x * x).sum::<f64>();
        if squared.is_finite() && squared > 0.0 {
            (0..n * n).for_each(|k| m[k] = m[k] + Rounded::exact(size / squared * row[k / n] * row[k % n]));
        }
    }
    m
}

/// What elimination tells, and below what a pivot may be nothing but rounding.
pub(crate) fn eliminate_rounded(m: &[Rounded], n: usize) -> (Elimination, f64) {
    // A diagonal that cannot be told from zero is zero.
    let value = |k: usize| if k / n == k % n && m[k].value.abs() <= 8.0 * m[k].error { 0.0 } else { m[k].value };
    let values: Vec<f64> = (0..n * n).map(value).collect();
    let scale = |k: usize| (values[k / n * (n + 1)] * values[k % n * (n + 1)]).sqrt();
    let inherited = (0..n * n).map(|k| if scale(k) > 0.0 { m[k].error / scale(k) } else { 0.0 }).fold(0.0, f64::max);
    // Elimination with the largest pivots is backward stable: Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. 2002,
    // section 10.3.
    let rounding = 64.0 * n as f64 * (inherited + f64::EPSILON);
    (eliminate(&values, n), rounding)
}

/// What a symmetric elimination with the largest pivot first tells of a matrix scaled to a unit diagonal.
#[derive(Clone, Debug)]
pub struct Elimination {
    /// The smallest pivot: 0 where the matrix is singular, negative where it is indefinite.
    pub smallest: f64,
    /// Its row.
    pub(super) last: usize,
}

/// Eliminates `m`, a square matrix given row by row.
pub fn eliminate(m: &[f64], n: usize) -> Elimination {
    let diagonal = |i: usize| m[i * n + i];
    if let Some(i) = (0..n).find(|&i| diagonal(i) < 0.0 || diagonal(i).is_nan()) {
        return Elimination { smallest: -1.0, last: i };
    }
    if let Some(i) = (0..n).find(|&i| diagonal(i) == 0.0) {
        return Elimination { smallest: 0.0, last: i };
    }
    let mut a: Vec<f64> = (0..n * n).map(|k| m[k] / (diagonal(k / n) * diagonal(k % n)).sqrt()).collect();
    let mut left: Vec<usize> = (0..n).collect();
    let mut result = Elimination { smallest: 1.0, last: 0 };
    while let Some(at) = (0..left.len()).max_by(|&i, &j| a[left[i] * (n + 1)].total_cmp(&a[left[j] * (n + 1)])) {
        let k = left[at];
        let pivot = a[k * n + k];
        if pivot < result.smallest {
            (result.smallest, result.last) = (pivot, k);
        }
        // Nothing but rounding may be left, or what is indefinite.
        if pivot <= n as f64 * f64::EPSILON {
            let negative = left.iter().copied().min_by(|&i, &j| a[i * (n + 1)].total_cmp(&a[j * (n + 1)]));
            let last = negative.unwrap_or(k);
            return Elimination { smallest: a[last * (n + 1)], last };
        }
        left.swap_remove(at);
        for &i in &left {
            let factor = a[i * n + k] / pivot;
            left.iter().for_each(|&j| a[i * n + j] -= factor * a[k * n + j]);
        }
    }
    result
}
