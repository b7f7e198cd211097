//! What rounding does to the functions along a motion, and what the motion itself keeps.

use mbs_derive::expr::Rounded;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::Derivation;
use mbs_runtime::RedundantRows;

use crate::failure::Failure;
use crate::simulate::assembly::Held;
use crate::simulate::drive::Driven;
use crate::simulate::method::{Accuracy, Method};
use crate::simulate::motion::{Drift, Motion, Settings};
use crate::simulate::record::Recorder;
use crate::state::Point;

/// The number of equal intervals of the motion at whose ends rounding is looked at.
const INTERVALS: usize = 20;

/// Rows of the motion.
const ROWS: usize = 200;

/// A function and a bound on its error, relative to its largest component, the worst of all states; `None` where it is
/// never finite.
pub(super) struct Bound {
    pub(super) function: String,
    pub(super) relative: Option<f64>,
}

/// Motions of more steps are not waited for; pages give up after as many.
const MOST_STEPS: usize = 50_000;

/// What a motion keeps.
pub(super) struct Kept {
    /// By how much T + V changes at most, and of T or V the largest.
    pub(super) energy: [f64; 2],
    /// What is left of constraints at most.
    pub(super) residual: f64,
}

/// The motion over `seconds`, if there is one.
pub(super) fn motion(derivation: &Derivation, start: &Point, seconds: f64) -> Result<Motion, Failure> {
    let t = start.state.t;
    let times: Vec<f64> = (0..=ROWS).map(|i| t + seconds * i as f64 / ROWS as f64).collect();
    let step = seconds / ROWS as f64;
    let settings = Settings {
        method: Method::Dop853,
        accuracy: Accuracy { relative: 1e-10, absolute: 1e-12, step, longest: step, most_steps: MOST_STEPS },
        drift: Drift::Projected,
        redundant_rows: RedundantRows::LeaveOut,
        held: Held::nothing(derivation.dof()),
    };
    Motion::integrate(derivation, start, &times, &settings, Driven::default(), &Recorder::new(derivation, &[]), None)?
        .whole()
}

/// What it has kept.
pub(super) fn kept(derivation: &Derivation, motion: &Motion) -> Kept {
    let [first, ..] = motion.rows.as_slice() else { return Kept { energy: [0.0; 2], residual: 0.0 } };
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, x| most.max(x.abs()));
    let start = first.kinetic + first.potential;
    let change = largest(&mut motion.rows.iter().map(|row| row.kinetic + row.potential - start));
    let size = largest(&mut motion.rows.iter().flat_map(|row| [row.kinetic, row.potential]));
    let (n, k) = (derivation.dof(), derivation.constraints.len());
    let residuals = 2 * n + 1 + k..2 * n + 1 + 2 * k;
    let residual = largest(&mut motion.rows.iter().flat_map(|row| row.values[residuals.clone()].iter().copied()));
    Kept { energy: [change, size], residual }
}

/// Running error bounds of every function at states of the motion.
///
/// Source: N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, section 3.3.
pub(super) fn bounds(derivation: &Derivation, start: &Point, motion: &Motion) -> Vec<Bound> {
    let exact = |values: &[f64]| values.iter().copied().map(Rounded::exact).collect::<Vec<_>>();
    let interpreter = Interpreter::with_parameters(derivation, exact(&start.parameters));
    let n = derivation.dof();
    let rows = motion.rows.iter().step_by(ROWS / INTERVALS);
    let states: Vec<State<Rounded>> = rows
        .map(|row| State {
            t: Rounded::exact(row.t),
            q: exact(&row.values[..n]),
            qd: exact(&row.values[n..2 * n]),
            qdd: exact(&vec![1.0; n]),
            u: exact(&start.state.u),
            prescribed: start.state.prescribed.iter().map(|signal| signal.map(Rounded::exact)).collect(),
        })
        .collect();
    let bound = |function| {
        let at = |state: &State<Rounded>| {
            let values = interpreter.evaluate(function, state);
            let size = values.iter().fold(0.0, |size: f64, x| size.max(x.value.abs()));
            let error = values.iter().fold(0.0, |error: f64, x| error.max(x.error));
            let relative = error / size;
            (size > 0.0 && relative.is_finite()).then_some(relative)
        };
        states.iter().filter_map(at).reduce(f64::max)
    };
    let functions = derivation.functions.iter();
    functions.map(|function| Bound { function: function.name.clone(), relative: bound(function) }).collect()
}
