//! Computed torque with the forces that the actuators can give: from rest at home onto the combined motion.

use std::ops::ControlFlow;

use mbs_examples::Failure;
use mbs_platform::{HOME, Motion, Platform};
use mbs_runtime::control::ComputedTorque;
use mbs_runtime::{Dop853, IntegrationError, Integrator, State};

/// The natural frequency of the errors \[rad/s\].
const NATURAL_FREQUENCY: f64 = 8.0;
/// How long it takes \[s\].
pub(crate) const DURATION: f64 = 4.0;

/// How the platform follows.
pub(crate) struct Following {
    /// Largest force that an actuator may give \[N\].
    pub(crate) limit: f64,
    /// Largest force asked for \[N\].
    pub(crate) asked: f64,
    /// How long one actuator at least gave all that it can \[s\].
    pub(crate) saturated: f64,
    /// Distance \[m\] and largest angle \[rad\] from the motion at the end.
    pub(crate) error: [f64; 2],
    /// When the legs could not hold the platform any more \[s\].
    pub(crate) lost: Option<f64>,
}

pub(crate) fn follow(platform: &Platform, limit: f64) -> Result<Following, Failure> {
    let mut platform = platform.clone();
    platform.limits.force = limit;
    let control = ComputedTorque::critically_damped(NATURAL_FREQUENCY)?;
    let motion = Motion::COMBINED;
    let mut state = State::new(HOME, [0.0; 6]);
    let mut following = Following { limit, asked: 0.0, saturated: 0.0, error: [0.0; 2], lost: None };
    let run = Dop853::new(1e-9, 1e-10).integrate(
        |t, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
            // Where the legs cannot hold the platform the integration ends, at its last good state.
            let forces = platform.limited_forces(&control, &motion.at(t), q, qd).unwrap_or([f64::NAN; 6]);
            *qdd = platform.model().forward_dynamics(q, qd, &forces);
        },
        0.0,
        DURATION,
        &mut state,
        |step| {
            let (t, now) = (step.time(), step.state());
            let wanted = platform.computed_forces(&control, &motion.at(t), &now.q, &now.qd).unwrap_or([f64::NAN; 6]);
            let largest = wanted.iter().fold(0.0, |largest: f64, force| largest.max(force.abs()));
            following.asked = following.asked.max(largest);
            if largest > limit {
                following.saturated += t - step.previous_time();
            }
            ControlFlow::Continue(())
        },
    );
    following.lost = match run {
        Ok(_) => None,
        Err(IntegrationError::NonFiniteState { time } | IntegrationError::StepTooSmall { time, .. }) => Some(time),
        Err(other) => return Err(other.into()),
    };
    let wanted = motion.at(DURATION)[0];
    let off = |i: usize| wanted[i] - state.q[i];
    following.error = [off(0).hypot(off(1)).hypot(off(2)), (3..6).map(|i| off(i).abs()).fold(0.0, f64::max)];
    Ok(following)
}
