//! The IRB 7600 between two postures, with less effort than by a quintic.

use std::ops::ControlFlow;

use mbs_arm::JointLimits;
use mbs_arm::trajectory::quintic;
use mbs_models::irb7600::Irb7600;
use mbs_runtime::{Dop853, Integrator, State};

use super::*;

const LIMITS: JointLimits = JointLimits::IRB7600;

fn transfer(duration: f64) -> Transfer<6, 6> {
    let [start, stop] = [[20.0, -80.0, 10.0, 10.0, 20.0, 10.0], [50.0, -10.0, 55.0, 80.0, 60.0, 100.0]]
        .map(|q: [f64; 6]| [q.map(f64::to_radians), [0.0; 6]]);
    Transfer { start, stop, duration, scale: LIMITS.torque, limits: Limits::from(&LIMITS) }
}

/// `∫ Σ (τ/τ_max)² dt` of any motion by the inverse dynamics, with a rule that has nothing to do with the points.
fn effort(motion: &impl Motion<6>) -> f64 {
    let arm = Irb7600::<f64>::default();
    let count = 3000;
    let step = motion.duration() / f64::from(count);
    let at = |k: i32| {
        let state = motion.at(step * (f64::from(k) + 0.5)).unwrap();
        let torque = arm.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        (0..6).map(|i| (torque[i] / LIMITS.torque[i]).powi(2)).sum::<f64>()
    };
    step * (0..count).map(at).sum::<f64>()
}

#[test]
fn the_arm_moves_with_less_effort_than_by_a_quintic() {
    let dual = Irb7600::<Dual<f64>>::default();
    let transfer = transfer(3.0);
    let motion = minimum_effort(&dual, &transfer, 40, None).unwrap();
    assert!(motion.residual().largest() < 1e-9 && motion.iterations() < 60, "{:?}", motion.residual());
    assert!((effort(&motion) / motion.effort() - 1.0).abs() < 1e-3, "{} {}", effort(&motion), motion.effort());
    let quintic = quintic(transfer.start[0], [0.0; 6], transfer.stop[0], 3.0).unwrap();
    let ratio = motion.effort() / effort(&quintic);
    assert!((0.6..0.7).contains(&ratio), "{ratio}");
    for point in motion.points() {
        assert_eq!(LIMITS.violation(&point.state.q), None);
        for i in 0..6 {
            assert!(point.state.qd[i].abs() <= LIMITS.speed[i] && point.input[i].abs() <= LIMITS.torque[i]);
        }
    }
    let hamiltonians: Vec<f64> = motion.points().iter().map(|point| point.hamiltonian).collect();
    let mean = hamiltonians.iter().sum::<f64>() / hamiltonians.len() as f64;
    // Speeds reach their limit, which costs order: costates have corners there.
    assert!(hamiltonians.iter().all(|h| (h - mean).abs() < 2e-3), "{mean} {hamiltonians:?}");
}

/// The torques that were found, and nothing else, from the start on: the arm falls over in a second, so that errors
/// grow along the way.
#[test]
fn the_arm_follows_under_these_torques_alone() {
    let dual = Irb7600::<Dual<f64>>::default();
    let arm = Irb7600::<f64>::default();
    let transfer = transfer(2.0);
    let mut before = f64::INFINITY;
    for (intervals, within) in [(20, 4e-2), (40, 4e-3), (80, 4e-4)] {
        let motion = minimum_effort(&dual, &transfer, intervals, None).unwrap();
        let mut state = State::new(transfer.start[0], [0.0; 6]);
        let mut worst: f64 = 0.0;
        // Inputs have corners where intervals meet.
        for k in 0..intervals {
            let [from, to] = [k, k + 1].map(|k| 2.0 * k as f64 / intervals as f64);
            let free = |t: f64, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
                *qdd = arm.forward_dynamics(q, qd, &motion.input_at(t.clamp(from, to)).unwrap());
            };
            Dop853::new(1e-10, 1e-12).integrate(free, from, to, &mut state, |_| ControlFlow::Continue(())).unwrap();
            let want = motion.at(to).unwrap();
            worst = (0..6).map(|i| (state.q[i] - want.q[i]).abs()).fold(worst, f64::max);
        }
        assert!(worst < within && worst < 0.3 * before, "{intervals}: {worst}");
        before = worst;
    }
}
