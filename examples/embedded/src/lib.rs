//! A pendulum on a cart, predicted and balanced in `f32`, with nothing below it but the processor.
//!
//! The generated equations, the Runge–Kutta step and the controller allocate nothing and need no standard library.
#![no_std]
#![forbid(unsafe_code)]

use mbs_runtime::{Rk4Stepper, State};

mbs_runtime::include_mechanism!("balancer");
use balancer::{Balancer, Params};

/// Seconds between two calls of [`Model::step`].
pub const PERIOD: f32 = 1e-3;

/// The model that runs beside the plant.
pub struct Model {
    balancer: Balancer<f32>,
    stepper: Rk4Stepper<[f32; 2]>,
    /// Cart and pole, \[m, rad\] and \[m/s, rad/s\].
    pub state: State<[f32; 2]>,
}

impl Model {
    /// The pole leans by `theta` \[rad\], at rest.
    pub fn new(theta: f32) -> Self {
        let state = State::new([0.0, theta], [0.0, 0.0]);
        Model { balancer: Balancer::new(Params::default()), stepper: Rk4Stepper::new(&state), state }
    }

    /// One period under the controller's push \[N\], which is held.
    pub fn step(&mut self) -> f32 {
        let push = self.push();
        let balancer = &self.balancer;
        let accelerations =
            |_, q: &[f32; 2], qd: &[f32; 2], qdd: &mut [f32; 2]| *qdd = balancer.forward_dynamics(q, qd, &[push]);
        let Ok(()) = self.stepper.step(accelerations, 0.0, PERIOD, &mut self.state);
        push
    }

    /// State feedback, poles near −3 and −8 per second.
    fn push(&self) -> f32 {
        let State { q: [x, theta], qd: [x_dot, theta_dot] } = self.state;
        (2.6 * x + 4.4 * x_dot + 26.0 * theta + 5.0 * theta_dot).clamp(-10.0, 10.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbs_runtime::{Dop853, Integrator};

    #[test]
    fn the_pole_is_balanced() {
        let mut model = Model::new(0.2);
        for _ in 0..10_000 {
            model.step();
        }
        let State { q, qd } = model.state;
        assert!(q.iter().chain(&qd).all(|x| x.abs() < 1e-3), "{:?}", model.state);
    }

    /// A tenth of a second under the same pushes, in doubles and by another method.
    #[test]
    fn steps_in_f32_follow_the_motion() {
        let mut model = Model::new(0.2);
        let reference = Balancer::<f64>::new(Params::default());
        let mut state = State::new([0.0, f64::from(0.2_f32)], [0.0, 0.0]);
        for _ in 0..100 {
            let push = f64::from(model.step());
            let accelerations =
                |_, q: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]| *qdd = reference.forward_dynamics(q, qd, &[push]);
            let period = f64::from(PERIOD);
            Dop853::new(1e-12, 1e-12)
                .integrate(accelerations, 0.0, period, &mut state, |_| core::ops::ControlFlow::Continue(()))
                .unwrap();
        }
        for (found, expected) in model.state.q.iter().zip(state.q) {
            assert!((f64::from(*found) - expected).abs() < 1e-5, "{found} instead of {expected}");
        }
    }
}
