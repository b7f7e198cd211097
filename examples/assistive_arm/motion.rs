//! The arm in a person's hand: what is pushed, and how it moves.

use std::ops::ControlFlow;

use mbs_arm::assistive::{Admittance, balancing_rates};
use mbs_examples::Failure;
use mbs_models::assistive_arm::{AssistiveArm, Params};
use mbs_runtime::{Dop853, Integrator, State};

/// Yaw of shoulder and elbow, elevation of both links at the start \[°\].
const START: [f64; 4] = [20.0, 90.0, 0.0, -40.0];
/// How long it takes \[s\].
pub(crate) const DURATION: f64 = 4.0;
pub(crate) const SAMPLES: usize = 400;
/// A push: when it begins and how long it lasts \[s\], its greatest force in the axes of the base \[N\].
const PUSHES: [(f64, f64, [f64; 3]); 2] = [(0.2, 1.0, [0.0, 0.0, 6.0]), (1.8, 1.0, [3.0, -4.0, 0.0])];
/// What the hand feels.
const FEEL: Admittance = Admittance { mass: 2.0, damping: 10.0, settling: 5.0 };
/// By how much the forearm is heavier than the springs of the second arm know \[kg\].
const EXCESS: f64 = 0.3;

/// One arm's run.
pub(crate) struct Run {
    pub(crate) name: &'static str,
    /// Time \[s\], place of the hand \[m\], torques of the motors \[N·m\].
    pub(crate) samples: Vec<(f64, [f64; 3], [f64; 4])>,
}

/// The balanced arm, and the runs: without springs, balanced, and with springs for a lighter forearm.
pub(crate) fn all() -> Result<(Params<f64>, [Run; 3]), Failure> {
    FEEL.check()?;
    let bare = Params::default();
    let balanced = Params { rate: balancing_rates(&bare), ..bare };
    let lighter = Params { rate: balancing_rates(&Params { payload: bare.payload - EXCESS, ..bare }), ..bare };
    Ok((balanced, [run("without springs", bare)?, run("balanced", balanced)?, run("0.3 kg too heavy", lighter)?]))
}

/// The person's force at the hand \[N\].
pub(crate) fn push(t: f64) -> [f64; 3] {
    let mut force = [0.0; 3];
    for (begin, length, most) in PUSHES {
        let part = (t - begin) / length;
        if (0.0..1.0).contains(&part) {
            let rise = (std::f64::consts::PI * part).sin().powi(2);
            force = most.map(|most| rise * most);
        }
    }
    force
}

fn run(name: &'static str, params: Params<f64>) -> Result<Run, Failure> {
    let arm = AssistiveArm::try_new(params)?;
    let torques = |t: f64, q: &[f64; 4], qd: &[f64; 4]| {
        FEEL.torques(&arm, q, qd, &push(t)).ok_or_else(|| Failure::new(format!("singular at {t} s")))
    };
    let mut state = State::new(START.map(f64::to_radians), [0.0; 4]);
    let mut samples = Vec::new();
    let time = |k: usize| DURATION * k as f64 / SAMPLES as f64;
    for k in 0..=SAMPLES {
        samples.push((time(k), arm.hand_place(&state.q), torques(time(k), &state.q, &state.qd)?));
        if k == SAMPLES {
            break;
        }
        let moving = |t: f64, q: &[f64; 4], qd: &[f64; 4], qdd: &mut [f64; 4]| {
            let force = push(t);
            // Where there are no torques the accelerations are NaN, which the integrator reports.
            let torque = FEEL.torques(&arm, q, qd, &force).unwrap_or([f64::NAN; 4]);
            *qdd = arm.forward_dynamics(
                q,
                qd,
                &[torque[0], torque[1], torque[2], torque[3], force[0], force[1], force[2]],
            );
        };
        let settings = Dop853::new(1e-10, 1e-12);
        settings.integrate(moving, time(k), time(k + 1), &mut state, |_| ControlFlow::Continue(()))?;
    }
    Ok(Run { name, samples })
}

impl Run {
    /// The greatest torque of each motor \[N·m\].
    pub(crate) fn peak(&self) -> [f64; 4] {
        std::array::from_fn(|i| self.samples.iter().map(|sample| sample.2[i].abs()).fold(0.0, f64::max))
    }

    /// From the start to where the hand came to rest \[m\].
    pub(crate) fn way(&self) -> [f64; 3] {
        let (start, stop) = (self.samples[0].1, self.samples[SAMPLES].1);
        std::array::from_fn(|i| stop[i] - start[i])
    }
}
