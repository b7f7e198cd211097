//! How the flange rings after the stop, under control of the motors' own angles.

use std::ops::ControlFlow;

use mbs_arm::elastic::ElasticArm;
use mbs_arm::trajectory::Motion;
use mbs_arm::{Arm, JointVector};
use mbs_examples::Failure;
use mbs_runtime::{Dop853, Integrator, State};

use crate::CONTROL;

/// Recorded from this long before the stop to this long behind it \[s\].
pub(crate) const BEFORE: f64 = 0.5;
pub(crate) const BEHIND: f64 = 2.0;
/// Between records \[s\].
const SAMPLE: f64 = 0.002;

/// The flange against where the motion wants it: time after the stop \[s\], distance up \[m\].
pub(crate) type Ringing = Vec<(f64, f64)>;

/// Motors under control of their own angles: feed-forward of weight, inertia and springs, and feedback that is
/// critically damped.
pub(crate) fn ringing(arm: &Arm, elastic: &ElasticArm, motion: &impl Motion<6>) -> Result<Ringing, Failure> {
    let (inertia, stiffness) = (elastic.rotor_inertia(), elastic.model.params().stiffness);
    // Joint torques wanted, and the motors' angles that give them.
    let wanted = |t: f64| {
        let state = motion.held_at(t)?;
        let torque = arm.model.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        let theta: JointVector = std::array::from_fn(|i| state.q[i] + torque[i] / stiffness[i]);
        Ok::<_, mbs_models::Error>((state, torque, theta))
    };
    let (state, _, theta) = wanted(0.0)?;
    let start = std::array::from_fn(|i| if i < 6 { state.q[i] } else { theta[i - 6] });
    let mut state = State::new(start, [0.0; 12]);
    let duration = motion.duration();
    let mut found = Vec::new();
    let moving = |t: f64, q: &[f64; 12], qd: &[f64; 12], qdd: &mut [f64; 12]| {
        let (state, torque, theta) = wanted(t)?;
        let tau = std::array::from_fn(|i| {
            let back = CONTROL * CONTROL * (theta[i] - q[6 + i]) + 2.0 * CONTROL * (state.qd[i] - qd[6 + i]);
            torque[i] + inertia[i] * (state.qdd[i] + back)
        });
        *qdd = elastic.model.forward_dynamics(q, qd, &tau);
        Ok::<(), mbs_models::Error>(())
    };
    let settings = Dop853::new(1e-12, 1e-13);
    // In pieces, so that no step leads over the stop.
    let first = duration - BEFORE;
    settings.integrate(moving, 0.0, first, &mut state, |_| ControlFlow::Continue(()))?;
    let count = ((BEFORE + BEHIND) / SAMPLE).round() as usize;
    let time = |k: usize| first + (BEFORE + BEHIND) * k as f64 / count as f64;
    for k in 0..=count {
        let (t, q) = (time(k), std::array::from_fn(|i| state.q[i]));
        let height = arm.pose(&q).position[2] - arm.pose(&motion.held_at(t)?.q).position[2];
        found.push((t - duration, height));
        if k < count {
            settings.integrate(moving, t, time(k + 1), &mut state, |_| ControlFlow::Continue(()))?;
        }
    }
    Ok(found)
}
