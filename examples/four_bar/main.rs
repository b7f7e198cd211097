//! How does a four-bar linkage swing about its rest, and does its linearization know?
//!
//! Assembled from a guess, released a hundredth of a radian from rest, kept on its constraints by projection. Look at
//! the two periods: that of the swing, found by events, and that of the linearization reduced to the crank; they differ
//! by the square of the amplitude, `--amplitude RAD`.
//!
//! `--out DIR` draws the curve that the middle of the coupler goes through in a turn of the crank (SVG and PNG).

mod figure;

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_models::four_bar::FourBar;
use mbs_runtime::{
    ConstraintError, Constraints, Dop853, Event, IntegrationError, Integrator, Projected, Projector, Reduction,
    ReductionError, Response, State, accelerations,
};
use serde_json::json;

/// Memory for three coordinates and the two rows of the closure.
const MEMORY: usize = Projector::<f64, [f64; 0]>::size(3, 2);
const CRANK: usize = 0;

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How far from rest it is released.
    #[arg(long, value_name = "RAD", default_value_t = 0.01)]
    amplitude: f64,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let bars = FourBar::<f64>::default();
    let rest = rest(&bars)?;
    let linear = linear_period(&bars, &rest)?;
    let (swing, open) = swing(&bars, at(&bars, rest.q[CRANK] + arguments.options.amplitude)?)?;
    if let Some(folder) = arguments.folder()? {
        output::write_figure(folder, "four_bar", &figure::turn(&bars, &rest)?, &[])?;
    }
    let crank = rest.q[CRANK];
    let results = json!({"rest": crank, "linear_period": linear, "period": swing, "largest_residual": open});
    let text = format!(
        "crank at rest at {crank:.6} rad, period {swing:.8} s, linearized {linear:.8} s\n\
         largest |φ| at accepted steps: {open:.1e} m\n"
    );
    arguments.answer(results, &text, &[]);
    Ok(())
}

/// The linkage at rest with the crank at this angle, the other angles from a guess.
fn at(bars: &FourBar<f64>, crank: f64) -> Result<State<[f64; 3]>, ConstraintError> {
    let mut state = State::new([crank, 0.9, 1.6], [0.0; 3]);
    close(bars, &mut state)?;
    Ok(state)
}

/// Moves all but the crank until the loop is closed.
fn close(bars: &FourBar<f64>, state: &mut State<[f64; 3]>) -> Result<(), ConstraintError> {
    Projector::new([0.0; MEMORY]).assemble(bars, 0.0, state, |i| i == CRANK)
}

/// Where the crank does not start by itself: bisection between two angles at which it starts towards each other.
fn rest(bars: &FourBar<f64>) -> Result<State<[f64; 3]>, ConstraintError> {
    let [mut low, mut high] = [-2.5, 0.0];
    for _ in 0..60 {
        let middle = at(bars, 0.5 * (low + high))?;
        let starts_up = bars.forward_dynamics(&middle.q, &middle.qd, &[0.0])[CRANK] > 0.0;
        *(if starts_up { &mut low } else { &mut high }) = middle.q[CRANK];
    }
    at(bars, low)
}

/// All angles and rates follow from those of the crank: `δq̈ = acceleration_q δq`, a number each.
fn linear_period(bars: &FourBar<f64>, rest: &State<[f64; 3]>) -> Result<f64, ReductionError> {
    let (a, rates) = (bars.constraint_jacobian(&rest.q), bars.constraint_rate_jacobian(&rest.q, &rest.qd));
    let holonomic = |row| Constraints::<f64>::is_holonomic(bars, row);
    let reduction = Reduction::new(&a, &rates, holonomic, [CRANK], [CRANK])?;
    let [[slope]] = reduction.linearize(&bars.linearize(&rest.q, &rest.qd, &[0.0])).acceleration_q;
    Ok(TAU / (-slope).sqrt())
}

/// The time of a whole swing, and the largest `|φ|` of an accepted step.
fn swing(bars: &FourBar<f64>, start: State<[f64; 3]>) -> Result<(f64, f64), IntegrationError> {
    let mut state = start;
    let mut returns = |_, _: &mut State<[f64; 3]>| Response::Stop;
    let mut back = [Event::new(&|_, s: &State<[f64; 3]>| s.qd[CRANK]).falling().with_action(&mut returns)];
    let drift = Projector::new([0.0; MEMORY]).onto(bars);
    let method = Projected { method: Dop853::new(1e-10, 1e-12), drift };
    let mut open = 0.0_f64;
    let motion = accelerations(bars, |_, _, _| [0.0]);
    let summary = method.integrate_with_events(motion, 0.0, 10.0, &mut state, &mut back, |step| {
        let State { q, qd } = step.state();
        open = bars.constraint(q, qd).iter().fold(open, |open, phi| open.max(phi.abs()));
        ControlFlow::Continue(())
    })?;
    Ok((summary.time, open))
}
