//! What is measured of a state from which an integrator found no way on, though accelerations are numbers there.

use mbs_derive::interpret::State;
use mbs_derive::optimise::FunctionKind;
use mbs_runtime::Constraints;
use nalgebra::DMatrix;

use crate::eigenvalues::eigenvalues;
use crate::equations::{Equations, Motion, Solver};

/// A step of this length, relative to 1 s or the time, is one on which a smooth motion hardly changes.
const MOMENT: f64 = 1e-9;

/// Measurements, as the end of a sentence: how nearly constraints depend on each other, the condition of the mass
/// matrix, the fastest rate of the linearized motion, and how much the accelerations change in a moment; what of them
/// is out of the ordinary is said to be the probable reason, and where constraints lose rank which way leads past it.
pub(crate) fn hint(
    equations: &Equations<'_>,
    solver: &mut Solver<'_, '_>,
    t: f64,
    motion: &Motion,
    way: &str,
) -> String {
    let state = equations.state(t, &motion.q, &motion.qd);
    let mut measured = Vec::new();
    let mut reason = None;
    if let Some(share) = least_share(equations, &state) {
        measured.push(format!("but for {share:.0e} of it a constraint depends on the others, {way}"));
        reason = Some("constraints nearly lose rank there");
    }
    let mass_matrix = equations.try_call(FunctionKind::MassMatrix, &state);
    if let Some(condition) = mass_matrix.and_then(|m| condition(&m, motion.q.len())) {
        measured.push(format!("the mass matrix, scaled by its diagonal, has a condition of {condition:.1e}"));
        if condition > 1e10 {
            reason = reason.or(Some("a singular configuration is near"));
        }
    }
    if let Some(rate) = fastest_rate(equations, &state) {
        measured.push(format!("the fastest rate of the linearized motion is {rate:.1e} 1/s"));
        if rate > 1e6 {
            reason = reason.or(Some("forces are stiff there"));
        }
    }
    if let Some((change, size)) = change_in_a_moment(equations, solver, t, motion) {
        measured.push(format!("accelerations of {size:.1e} change by {change:.1e} within {MOMENT:e} s"));
        if change > 1e-3 * size {
            reason = reason.or(Some("a force has a kink or a jump there"));
        }
    }
    let reason = reason.map_or(String::new(), |reason| format!("{reason}: "));
    if measured.is_empty() { String::new() } else { format!("; {reason}{}", measured.join(", ")) }
}

/// Of `D^(-1/2) M D^(-1/2)` with the diagonal D of M, in the Euclidean norm; infinite where M is not positive definite.
fn condition(mass_matrix: &[f64], n: usize) -> Option<f64> {
    let m = DMatrix::from_row_slice(n, n, mass_matrix);
    let scale: Vec<f64> = (0..n).map(|i| m[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| m[(i, j)] / (scale[i] * scale[j]));
    if !scaled.iter().all(|x| x.is_finite()) {
        return None;
    }
    let eigenvalues = scaled.symmetric_eigenvalues();
    let (least, greatest) = (eigenvalues.min(), eigenvalues.max());
    Some(if least > 0.0 { greatest / least } else { f64::INFINITY })
}

/// The least singular value beside the greatest of A, in rows of length 1 and in units of the coordinates that make the
/// diagonal of M one, if it is small, but not that of rows which depend on others at all states.
pub(crate) fn least_share(equations: &Equations<'_>, state: &State) -> Option<f64> {
    /// What tolerances leave of the distance from a state without full rank.
    const SMALL: f64 = 1e-6;
    const ROUNDING: f64 = 1e-13;
    let (rows, n) = (equations.rows(), state.q.len());
    let mass_matrix = equations.try_call(FunctionKind::MassMatrix, state).filter(|_| rows > 0)?;
    let unit = |i: usize| if mass_matrix[i * n + i] > 0.0 { mass_matrix[i * n + i].sqrt() } else { 1.0 };
    let a = DMatrix::from_row_slice(rows, n, &equations.rows_of(FunctionKind::ConstraintJacobian, state));
    let mut a = DMatrix::from_fn(rows, n, |row, i| a[(row, i)] / unit(i));
    for mut row in a.row_iter_mut() {
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
    }
    if !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    let values = a.singular_values();
    let shares = values.iter().map(|value| value / values.max());
    shares.filter(|&share| share > ROUNDING && share < SMALL).reduce(f64::min)
}

/// The greatest absolute eigenvalue of `d(q, q̇)/dt = (q̇, q̈)`, linearized.
fn fastest_rate(equations: &Equations<'_>, state: &State) -> Option<f64> {
    let n = state.q.len();
    let derivatives = equations.try_call(FunctionKind::Linearize, state)?;
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, _) => f64::from(u8::from(j == i + n)),
        (false, true) => derivatives[(i - n) * n + j],
        (false, false) => derivatives[n * n + (i - n) * n + j - n],
    };
    if derivatives.len() < 2 * n * n || !derivatives.iter().all(|x| x.is_finite()) {
        return None;
    }
    let values = eigenvalues(DMatrix::from_fn(2 * n, 2 * n, entry))?;
    Some(values.iter().map(|value| value.re.hypot(value.im)).fold(0.0, f64::max))
}

/// The second difference of the accelerations along the motion, and their size.
fn change_in_a_moment(
    equations: &Equations<'_>,
    solver: &mut Solver<'_, '_>,
    t: f64,
    motion: &Motion,
) -> Option<(f64, f64)> {
    let h = MOMENT * (1.0 + t.abs());
    let now = solver.accelerations(&equations.state(t, &motion.q, &motion.qd)).ok()?;
    let mut at = |h: f64| {
        let moved = |from: &[f64], by: &[f64]| -> Vec<f64> { from.iter().zip(by).map(|(x, v)| x + h * v).collect() };
        let state = equations.state(t + h, &moved(&motion.q, &motion.qd), &moved(&motion.qd, &now));
        solver.accelerations(&state).ok()
    };
    let (before, after) = (at(-h)?, at(h)?);
    let size = now.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    let change = (0..now.len()).map(|i| (before[i] - 2.0 * now[i] + after[i]).abs()).fold(0.0, f64::max);
    (change.is_finite() && size > 0.0).then_some((change, size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions() {
        assert!((condition(&[4.0, 0.0, 0.0, 1e-6], 2).unwrap() - 1.0).abs() < 1e-12);
        assert!((condition(&[1.0, 0.5, 0.5, 1.0], 2).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(condition(&[1.0, 2.0, 2.0, 1.0], 2), Some(f64::INFINITY));
        assert_eq!(condition(&[0.0], 1), None);
    }
}
