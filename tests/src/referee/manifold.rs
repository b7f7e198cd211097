//! States at which constraints hold, found by Newton's method: only there rows may be redundant that are not
//! everywhere.

use super::evaluate::State;
use super::lagrange::{Wanted, Written};
use super::mechanism::Mechanism;
use super::number::Real;
use super::solve::solve;
use super::wide::Wide;
use crate::random::onto_the_sphere;

/// This many steps at most.
const STEPS: usize = 12;

/// Steps that are this small, of what they change, are the last.
const SMALL: f64 = 1e-14;

/// The state with the least changes after which the constraints hold, if Newton's method finds it.
///
/// # Errors
/// What the referee does not understand.
pub(super) fn held(mechanism: &Mechanism, state: &State<f64>) -> Result<Option<State<f64>>, String> {
    let mut moving = state.map(&mut Wide::from);
    let mut steps = (0..STEPS).map(|_| step(mechanism, &mut moving));
    if !steps.try_fold(false, |done, step| Ok::<bool, String>(done | step?))? {
        return Ok(None);
    }
    let mut found = moving.map(&mut |x: Wide| x.value());
    for &first in &mechanism.quaternions {
        let part = first..first + 4;
        onto_the_sphere(&mut found.q[part.clone()], &mut found.qd[part.clone()], &mut found.qdd[part]);
    }
    Ok(Some(found))
}

/// One step of the coordinates and of the velocities; whether both were small.
fn step(mechanism: &Mechanism, state: &mut State<Wide>) -> Result<bool, String> {
    let n = mechanism.dof();
    let here = Written::at(mechanism, state)?.equations(state, 0..n, Wanted::Rows);
    let rows: Vec<_> = mechanism.rows.iter().map(|&(row, holonomic)| (&here.rows[row], holonomic)).collect();
    let zero = Wide::from(0.0);
    let mut matrix = vec![vec![zero; n + rows.len()]; n + rows.len()];
    (0..n).for_each(|i| matrix[i][i] = Wide::from(1.0));
    for (k, (row, holonomic)) in rows.iter().enumerate() {
        for (j, &entry) in row.gradient(*holonomic).iter().enumerate() {
            (matrix[n + k][j], matrix[j][n + k]) = (entry, entry);
        }
    }
    let right = |of_row: &dyn Fn(usize) -> Wide| -> Vec<Wide> {
        (0..n).map(|_| zero).chain((0..rows.len()).map(|k| -of_row(k))).collect()
    };
    // A row that is linear in the velocities asks nothing of the coordinates.
    let places = right(&|k| if rows[k].1 { rows[k].0.along[0] } else { zero });
    let rates = right(&|k| rows[k].0.rate(rows[k].1));
    let solution = solve(&matrix, &[places, rates], 1e-9, None, || 0.0);
    let small = |values: &mut [Wide], changes: &[Wide]| {
        values.iter_mut().zip(changes).for_each(|(value, change)| *value = *value + *change);
        let largest = |values: &[Wide]| values.iter().map(|x| x.value().abs()).fold(0.0, f64::max);
        largest(&changes[..values.len()]) <= SMALL * (1.0 + largest(values))
    };
    let (q, qd) = (small(&mut state.q, &solution.columns[0]), small(&mut state.qd, &solution.columns[1]));
    Ok(q && qd)
}
