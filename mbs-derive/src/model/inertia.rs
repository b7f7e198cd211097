//! Whether every motion that the constraints leave has inertia: the mass matrix of the declared energies.

use crate::expr::{Dual, Expr, Residue, Rounded, Scales, Symbol, Tape, Value};

use super::degree::{Line, Problem};
use super::echelon::Echelon;
use super::rank::VelocityEquations;

/// The first-order bounds of rounding errors are allowed this many times.
pub(crate) const ROUNDING: f64 = 8.0;

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
        let rows = constraints.pfaffian(line, n).into_iter().zip(constraints.vectors());
        let (rows, vectors): (Vec<_>, Vec<_>) = rows.filter(|(row, _)| row.iter().all(|x| x.is_finite())).unzip();
        on_allowed_motions(n, mass, rows.concat().into_iter().map(Rounded::exact).collect(), &vectors)
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

/// The coordinates of a motion that has no inertia at any state, decided in a finite field at the defaults of the
/// parameters; where it has no values, none is said to be.
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

/// `M + Aᵀ A`, positive definite where M is so on the motions that A leaves; in the scales of the solution, which are
/// those of the units.
pub(crate) fn on_allowed_motions(
    n: usize,
    mut mass: Vec<Rounded>,
    mut a: Vec<Rounded>,
    vectors: &[usize],
) -> Vec<Rounded> {
    let scales = scales(n, &mass, &a, vectors);
    mass.iter_mut().enumerate().for_each(|(k, x)| *x = scales.mass(k / n, k % n, *x));
    a.iter_mut().enumerate().for_each(|(k, x)| *x = scales.row(k / n, k % n, *x));
    let gram = |i: usize, j: usize| a.chunks(n).map(|row| row[i] * row[j]).sum::<Rounded>();
    (0..n * n).map(|k| mass[k] + gram(k / n, k % n)).collect()
}

/// The scales of M and A, rows of the same number in `vectors` of one vector; what cannot be told from zero is zero.
pub(crate) fn scales(n: usize, mass: &[Rounded], a: &[Rounded], vectors: &[usize]) -> Scales {
    let known = |v: &Rounded| if v.value.abs() <= ROUNDING * v.error { 0.0 } else { v.value };
    let rows: Vec<Vec<f64>> = a.chunks(n).map(|row| row.iter().map(known).collect()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    Scales::of(n, &|i| known(&mass[i * (n + 1)]), &rows, vectors)
}

/// What elimination shows, and below what a pivot may be nothing but rounding.
pub(crate) fn eliminate_rounded(m: &[Rounded], n: usize) -> (Elimination, f64) {
    // A diagonal that cannot be told from zero is zero.
    let value = |k: usize| if k / n == k % n && m[k].value.abs() <= ROUNDING * m[k].error { 0.0 } else { m[k].value };
    let values: Vec<f64> = (0..n * n).map(value).collect();
    let scale = |k: usize| (values[k / n * (n + 1)] * values[k % n * (n + 1)]).sqrt();
    let inherited = (0..n * n).map(|k| if scale(k) > 0.0 { m[k].error / scale(k) } else { 0.0 }).fold(0.0, f64::max);
    // Elimination with the largest pivots is backward stable: Higham, Accuracy and Stability of Numerical Algorithms,
    // 2nd ed. 2002, section 10.3.
    let rounding = 64.0 * n as f64 * (inherited + f64::EPSILON);
    (eliminate(&values, n), rounding)
}

/// What a symmetric elimination with the largest pivot first shows of a matrix scaled to a unit diagonal.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Which sign the inertia of the motions has that a row leaves: 0 where one has none.
    fn sign(mass: [f64; 9], row: [f64; 3]) -> i32 {
        let [mass, row] = [mass.as_slice(), &row].map(|numbers| numbers.iter().copied().map(Rounded::exact).collect());
        let (found, rounding) = eliminate_rounded(&on_allowed_motions(3, mass, row, &[0]), 3);
        i32::from(found.smallest > rounding) - i32::from(found.smallest < -rounding)
    }

    #[test]
    fn units_do_not_change_what_has_inertia() {
        // The second coordinate follows the third: 0.5 + 4·(−1.25), (1, 0.25), nothing at all.
        let cases = [
            ([3.0, 0.0, 0.0, 0.0, -1.25, 0.0, 0.0, 0.0, 0.5], -1),
            ([3.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.25], 1),
            ([3.0, 0.5, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0], 1),
            ([3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0),
        ];
        for units in 0..81 {
            let power = |digit: u32| 2.0_f64.powi(60 * (units / 3_i32.pow(digit) % 3 - 1));
            let unit = [power(0), power(1), power(2)];
            for (mass, expected) in cases {
                let mass = std::array::from_fn(|k| unit[k / 3] * mass[k] * unit[k % 3]);
                let row = std::array::from_fn(|i| power(3) * unit[i] * [0.0, 1.0, -2.0][i]);
                assert_eq!(sign(mass, row), expected, "{unit:?} {mass:?} {row:?}");
            }
        }
    }
}
