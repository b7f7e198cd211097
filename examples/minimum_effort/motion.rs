//! One transfer: the motion of least effort beside the quintic.

use std::ops::ControlFlow;

use mbs_arm::trajectory::minimum_effort::{Limits, MinimumEffort, Transfer, minimum_effort};
use mbs_arm::trajectory::{JointState, Motion, Piecewise, quintic};
use mbs_arm::{Arm, JointLimits, JointVector};
use mbs_models::irb7600::Irb7600;
use mbs_runtime::{Dop853, Dual, Integrator, State};

use super::*;

/// Table 2 of the thesis, its second angle taken as the robot's own, less 90°; the stop's second and third angle are
/// 5° within their ranges \[°\].
pub(crate) const START: JointVector = [20.0, -80.0, 10.0, 10.0, 20.0, 10.0];
pub(crate) const STOP: JointVector = [50.0, -10.0, 55.0, 80.0, 60.0, 100.0];
/// How long it takes \[s\].
pub(crate) const DURATION: f64 = 3.0;
/// Of the finest motion; the coarser ones have a half and a quarter of them.
const INTERVALS: usize = 80;
/// Points at which motions are drawn and compared.
const SAMPLES: usize = 300;

/// From rest to rest, within all limits.
pub(crate) fn transfer(duration: f64) -> Transfer<6, 6> {
    let limits = JointLimits::IRB7600;
    let [start, stop] = [START, STOP].map(|q| [q.map(f64::to_radians), [0.0; 6]]);
    Transfer { start, stop, duration, scale: limits.torque, limits: Limits::from(&limits) }
}

/// One instant of a motion.
pub(crate) struct Sample {
    pub(crate) t: f64,
    pub(crate) state: JointState<6>,
    /// Over the largest ones.
    pub(crate) torque: JointVector,
}

/// The motion at equal intervals of the time, with the torques of the inverse dynamics.
pub(crate) fn samples(motion: &impl Motion<6>) -> Result<Vec<Sample>, Failure> {
    let arm = Arm::default();
    let sample = |k: usize| {
        let t = motion.duration() * (k as f64 / SAMPLES as f64);
        let state = motion.at(t)?;
        let torque = arm.model.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        Ok(Sample { t, state, torque: std::array::from_fn(|i| torque[i] / arm.limits.torque[i]) })
    };
    (0..=SAMPLES).map(sample).collect()
}

/// `∫ Σ (τ/τ_max)² dt` by Simpson's rule over the samples.
pub(crate) fn effort(samples: &[Sample]) -> f64 {
    let last = samples.len() - 1;
    let weight = |k: usize| if k == 0 || k == last { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
    let square = |sample: &Sample| sample.torque.iter().map(|torque| torque * torque).sum::<f64>();
    let sum: f64 = samples.iter().enumerate().map(|(k, sample)| weight(k) * square(sample)).sum();
    sum * samples[last].t / (3 * last) as f64
}

/// The quintic and the motions of least effort on grids of different width.
pub(crate) struct Comparison {
    quintic: Piecewise<6, 1>,
    pub(crate) by_quintic: Vec<Sample>,
    /// The finest last.
    motions: Vec<MinimumEffort<6, 6>>,
    pub(crate) by_optimum: Vec<Sample>,
    /// The angles' largest deviation under the torques alone \[rad\]: half the way, and all of it.
    astray: [f64; 2],
}

impl Comparison {
    pub(crate) fn new() -> Result<Self, Failure> {
        let transfer = transfer(DURATION);
        let quintic = quintic(transfer.start[0], [0.0; 6], transfer.stop[0], DURATION)?;
        let arm = Irb7600::<Dual<f64>>::default();
        let motions = [4, 2, 1]
            .into_iter()
            .map(|part| minimum_effort(&arm, &transfer, INTERVALS / part, None))
            .collect::<Result<Vec<_>, _>>()?;
        let finest = &motions[2];
        let (by_quintic, by_optimum) = (samples(&quintic)?, samples(finest)?);
        let astray = astray(finest)?;
        Ok(Self { quintic, by_quintic, by_optimum, astray, motions })
    }

    pub(crate) fn optimum(&self) -> &MinimumEffort<6, 6> {
        &self.motions[self.motions.len() - 1]
    }

    /// The least and the largest `H` over the points.
    fn hamiltonian(&self) -> [f64; 2] {
        let values = || self.optimum().points().iter().map(|point| point.hamiltonian);
        [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// For each joint the largest speed, of the limit.
    fn speeds(samples: &[Sample]) -> JointVector {
        let limits = JointLimits::IRB7600.speed;
        std::array::from_fn(|i| samples.iter().map(|sample| (sample.state.qd[i] / limits[i]).abs()).fold(0.0, f64::max))
    }

    fn torques(samples: &[Sample]) -> JointVector {
        std::array::from_fn(|i| samples.iter().map(|sample| sample.torque[i].abs()).fold(0.0, f64::max))
    }

    pub(crate) fn to_json(&self) -> Value {
        let residual = self.optimum().residual();
        let grids = self.motions.iter().map(|motion| {
            json!({
                "intervals": motion.points().len() / 2,
                "effort": motion.effort(),
                "iterations": motion.iterations(),
            })
        });
        json!({
            "start_deg": START,
            "stop_deg": STOP,
            "duration": self.quintic.duration(),
            "quintic": {
                "effort": effort(&self.by_quintic),
                "peak_speed_over_limit": Self::speeds(&self.by_quintic),
                "peak_torque_over_limit": Self::torques(&self.by_quintic),
            },
            "optimum": {
                "effort": self.optimum().effort(),
                "effort_by_inverse_dynamics": effort(&self.by_optimum),
                "peak_speed_over_limit": Self::speeds(&self.by_optimum),
                "peak_torque_over_limit": Self::torques(&self.by_optimum),
                "stationarity": residual.stationarity,
                "defect": residual.defect,
                "complementarity": residual.complementarity,
                "hamiltonian": self.hamiltonian(),
                "astray_deg": self.astray.map(f64::to_degrees),
            },
            "grids": grids.collect::<Value>(),
        })
    }

    pub(crate) fn text(&self) -> Result<String, Failure> {
        let mut text = format!(
            "The IRB 7600 from {START:?}° to {STOP:?}° in {DURATION} s; effort J = ∫ Σ (τ/τ_max)² dt.\n\n\
             \x20                effort [s]   peak torque of the limit, joints 1 to 6      peak speed of the limit\n",
        );
        let percent = |values: JointVector| values.map(|value| format!("{:4.0}", 100.0 * value)).join("") + " %";
        for (name, samples) in [("quintic", &self.by_quintic), ("least effort", &self.by_optimum)] {
            let [torques, speeds] = [Self::torques(samples), Self::speeds(samples)].map(percent);
            writeln!(text, "{name:14} {:12.6}          {torques}               {speeds}", effort(samples))?;
        }
        let saved = 1.0 - self.optimum().effort() / effort(&self.by_quintic);
        writeln!(text, "\nThe optimum saves {:.1} % of the effort. On coarser grids:", 100.0 * saved)?;
        for motion in &self.motions {
            let (intervals, steps) = (motion.points().len() / 2, motion.iterations());
            writeln!(text, "  {intervals:3} intervals: {:.9} s in {steps} Newton steps", motion.effort())?;
        }
        let residual = self.optimum().residual();
        writeln!(
            text,
            "Conditions of optimality (scaled): derivative of the Lagrangian {:.1e}, defects {:.1e}, complementarity {:.1e}.",
            residual.stationarity, residual.defect, residual.complementarity
        )?;
        let [least, most] = self.hamiltonian();
        writeln!(text, "H stays between {least:.5} and {most:.5} along the motion.")?;
        let [half, whole] = self.astray.map(f64::to_degrees);
        writeln!(
            text,
            "Under the torques alone (DOP853) the arm is {half:.1e}° astray after half the way, {whole:.1e}° after all of it:\n\
             it stands like an inverted pendulum, errors grow by themselves."
        )?;
        Ok(text)
    }
}

/// Integrates the arm under the inputs of the motion alone: from its start on, interval by interval, since inputs have
/// corners where these meet.
fn astray(motion: &MinimumEffort<6, 6>) -> Result<[f64; 2], Failure> {
    let arm = Irb7600::<f64>::default();
    let ends: Vec<_> = motion.points().iter().step_by(2).collect();
    let mut state = State::new(ends[0].state.q, ends[0].state.qd);
    let (mut worst, mut half): (f64, f64) = (0.0, 0.0);
    for pair in ends.windows(2) {
        let (from, to) = (pair[0].t, pair[1].t);
        let free = |t: f64, q: &JointVector, qd: &JointVector, qdd: &mut JointVector| {
            *qdd = arm.forward_dynamics(q, qd, &motion.input_at(t.clamp(from, to))?);
            Ok::<(), mbs_models::Error>(())
        };
        Dop853::new(1e-10, 1e-12).integrate(free, from, to, &mut state, |_| ControlFlow::Continue(()))?;
        worst = (0..6).map(|i| (state.q[i] - pair[1].state.q[i]).abs()).fold(worst, f64::max);
        if to <= 0.5 * motion.duration() * (1.0 + 1e-9) {
            half = worst;
        }
    }
    Ok([half, worst])
}
