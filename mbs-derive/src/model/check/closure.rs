//! Whether there is a state at which all holonomic constraints hold.

use crate::expr::{Dual, Expr, Symbol, Tape};
use crate::model::check::sample::default_parameters;
use crate::model::lagrangian::{ConstraintKind, Draft};
use crate::numeric::Random;
use crate::state::State;

/// This many states are tried as starts, with this many steps each.
const STARTS: usize = 48;
const STEPS: usize = 80;

/// Whether the method of Levenberg and Marquardt gets from one of some random states to where all rows vanish.
pub(in crate::model) fn closes(lagrangian: &Draft<'_>) -> bool {
    let holonomic = lagrangian.constraints.iter().filter(|c| c.kind == ConstraintKind::Holonomic);
    let rows: Vec<Expr<'_>> = holonomic.flat_map(|c| c.rows.clone()).collect();
    let search = Search { tape: Tape::new(&rows), parameters: default_parameters(lagrangian) };
    let mut random = Random::new(0x0063_6c6f_7365);
    (0..STARTS).any(|_| search.arrives(random.state(lagrangian)))
}

struct Search {
    tape: Tape,
    parameters: Vec<f64>,
}

impl Search {
    fn arrives(&self, mut state: State) -> bool {
        let mut residual = self.residual(&state);
        let scale: Vec<f64> = residual.iter().map(|r| r.abs().max(f64::MIN_POSITIVE)).collect();
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            if !residual.iter().all(|r| r.is_finite()) {
                return false;
            }
            if residual.iter().zip(&scale).all(|(r, scale)| r.abs() <= 1e-9 * scale) {
                return true;
            }
            let jacobian = self.jacobian(&state);
            let step = damped_step(&jacobian, &residual, damping);
            let q = state.q.iter().zip(&step).map(|(q, step)| q - step).collect();
            let next = State { q, ..state.clone() };
            let moved = self.residual(&next);
            if size(&moved, &jacobian) < size(&residual, &jacobian) {
                (state, residual, damping) = (next, moved, (damping / 10.0).max(1e-12));
            } else {
                damping *= 10.0;
            }
        }
        false
    }

    fn residual(&self, state: &State) -> Vec<f64> {
        self.tape.run(|symbol| self.value(state, symbol, None)).into_iter().map(|row| row.value).collect()
    }

    /// Column by column.
    fn jacobian(&self, state: &State) -> Vec<Vec<f64>> {
        let column = |i: usize| self.tape.run(|symbol| self.value(state, symbol, Some(i)));
        (0..state.q.len()).map(|i| column(i).into_iter().map(|row| row.derivative).collect()).collect()
    }

    fn value(&self, state: &State, symbol: Symbol, along: Option<usize>) -> Dual<f64> {
        match symbol {
            Symbol::Time => Dual::fixed(state.t),
            Symbol::Coordinate(i) => Dual::new(state.q[i as usize], f64::from(u8::from(along == Some(i as usize)))),
            Symbol::Parameter(i) => Dual::fixed(self.parameters[i as usize]),
            Symbol::Prescribed(i, order @ 0..=2) => Dual::fixed(state.prescribed[i as usize][usize::from(order)]),
            Symbol::Velocity(_)
            | Symbol::Prescribed(..)
            | Symbol::Input(_)
            | Symbol::Acceleration(_)
            | Symbol::Multiplier(_) => Dual::fixed(f64::NAN),
        }
    }
}

/// Of each row the length of its gradient, by which it is divided.
fn row_scales(columns: &[Vec<f64>], rows: usize) -> Vec<f64> {
    let length = |row: usize| columns.iter().map(|column| column[row] * column[row]).sum::<f64>().sqrt();
    (0..rows).map(|row| length(row).max(f64::MIN_POSITIVE)).collect()
}

fn size(residual: &[f64], columns: &[Vec<f64>]) -> f64 {
    residual.iter().zip(row_scales(columns, residual.len())).map(|(r, scale)| (r / scale).powi(2)).sum()
}

/// `Aᵀ (A Aᵀ + μ)⁻¹ φ` of rows divided by the lengths of their gradients.
fn damped_step(columns: &[Vec<f64>], residual: &[f64], damping: f64) -> Vec<f64> {
    let m = residual.len();
    let scale = row_scales(columns, m);
    let entry = |i: usize, j: usize| {
        columns.iter().map(|column| column[i] * column[j]).sum::<f64>() / (scale[i] * scale[j])
            + if i == j { damping } else { 0.0 }
    };
    let mut gram: Vec<Vec<f64>> = (0..m).map(|i| (0..m).map(|j| entry(i, j)).collect()).collect();
    let mut y: Vec<f64> = residual.iter().zip(&scale).map(|(r, scale)| r / scale).collect();
    // Positive definite: no pivoting.
    for k in 0..m {
        for i in k + 1..m {
            let factor = gram[i][k] / gram[k][k];
            for j in k..m {
                gram[i][j] -= factor * gram[k][j];
            }
            y[i] -= factor * y[k];
        }
    }
    for k in (0..m).rev() {
        let known: f64 = (k + 1..m).map(|j| gram[k][j] * y[j]).sum();
        y[k] = (y[k] - known) / gram[k][k];
    }
    columns.iter().map(|column| (0..m).map(|i| column[i] / scale[i] * y[i]).sum()).collect()
}
