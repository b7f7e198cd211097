//! Symplectic methods over many periods: the energy of a Kepler orbit of eccentricity 0.6, period 2π.

use core::ops::ControlFlow;

use crate::{GaussLegendre4, Integrator, SemiImplicitEuler, State, StormerVerlet};

/// Steps in a period.
const STEPS: usize = 200;

fn kepler(_: f64, q: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]) {
    let squared = q[0] * q[0] + q[1] * q[1];
    let cubed = squared * squared.sqrt();
    *qdd = [-q[0] / cubed, -q[1] / cubed];
}

/// How far the mean energy moves from the first to the last tenth of the run, relative to the energy.
fn shift(method: &impl Integrator<f64>, periods: usize) -> f64 {
    let mut state = State::new([0.4, 0.0], [0.0, 2.0]);
    let tenth = periods * STEPS / 10;
    let (mut step, mut first, mut last) = (0, 0.0, 0.0);
    let summary = method.integrate(kepler, 0.0, periods as f64 * core::f64::consts::TAU, &mut state, |done| {
        let State { q, qd } = done.state();
        // Above that of the orbit, so that the sums keep their digits.
        let energy = 0.5 * (qd[0] * qd[0] + qd[1] * qd[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt() + 0.5;
        if step < tenth {
            first += energy;
        } else if step >= 9 * tenth {
            last += energy;
        }
        step += 1;
        ControlFlow::Continue(())
    });
    assert_eq!(summary.unwrap().accepted, periods * STEPS);
    ((last - first) / tenth as f64 / 0.5).abs()
}

/// Increments far below the last place of the velocity, each of them lost but for the compensation.
#[test]
fn velocities_keep_what_rounding_leaves_out() {
    fn check(method: &impl Integrator<f64>) {
        let mut state = State::new([0.0], [1.0]);
        let push = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 1e-17;
        method.integrate(push, 0.0, 1e5, &mut state, |_| ControlFlow::Continue(())).unwrap();
        assert!((state.qd[0] - 1.0 - 1e-12).abs() <= f64::EPSILON, "{:e}", state.qd[0] - 1.0);
        assert!((state.q[0] - 1e5 - 5e-8).abs() <= 3e-11, "{:e}", state.q[0] - 1e5);
    }
    check(&StormerVerlet::new(1.0));
    check(&GaussLegendre4::new(1.0));
    check(&SemiImplicitEuler { max_steps: 100_000, ..SemiImplicitEuler::new(1.0) });
}

#[test]
fn stormer_verlet_keeps_the_energy() {
    let shift = shift(&StormerVerlet::new(core::f64::consts::TAU / STEPS as f64), 100_000);
    assert!(shift <= 1e-7, "{shift:e}");
}

#[test]
fn gauss_legendre_keeps_the_energy() {
    let shift = shift(&GaussLegendre4::new(core::f64::consts::TAU / STEPS as f64), 10_000);
    assert!(shift <= 1e-11, "{shift:e}");
}
