//! A pendulum whose pivot is shaken, on a thread of changing length.
//!
//! # Source
//!
//! The tangential component of `m (r̈ + g e_z) = S` at `r = p + l [sin θ, 0, −cos θ]`, with `e_θ = [cos θ, 0, sin θ]`:
//! `l θ̈ + 2 l̇ θ̇ + p̈ₓ cos θ + (p̈_z + g) sin θ = 0`. The shaken pivot is Landau, Lifshitz, *Mechanics*, 3rd edition
//! 1976, §5, problem 3, and §30.

use super::dynamics::Dynamics;

/// Parameters, and what is prescribed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShakenPendulum {
    /// Mass, in kg.
    pub m: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Length and its rate, in m and m/s.
    pub length: [f64; 2],
    /// Acceleration of the pivot, right and up, in m/s².
    pub pivot: [f64; 2],
}

impl Dynamics<1> for ShakenPendulum {
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[self.m * self.length[0].powi(2)]]
    }

    fn bias(&self, &[theta]: &[f64; 1], &[thetad]: &[f64; 1]) -> [f64; 1] {
        let [l, ld] = self.length;
        let [right, up] = self.pivot;
        [self.m * l * (2.0 * ld * thetad + right * theta.cos() + (up + self.g) * theta.sin())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::lagrange::{Dual, Number};
    use crate::reference::tests::ROUND_OFF;

    /// `m r̈ · ∂r/∂θ` with `r(t)` differentiated twice as a dual number of a dual number.
    #[test]
    fn agrees_with_the_position_differentiated_twice() {
        let pendulum = ShakenPendulum { m: 1.3, g: 9.81, length: [0.8, -0.6], pivot: [2.0, -3.0] };
        let curve = |value: f64, rate: f64, acceleration: f64| Dual {
            value: Dual { value, derivative: rate },
            derivative: Dual { value: rate, derivative: acceleration },
        };
        for state in states::<1>(8, 30) {
            let theta = curve(state.q[0], state.qd[0], state.qdd[0]);
            let [l, ld] = pendulum.length;
            // l̈ does not matter; the pivot's place and rate neither.
            let length = curve(l, ld, 5.0);
            let x = curve(0.3, 0.4, pendulum.pivot[0]) + theta.sin() * length;
            let z = curve(-0.2, 0.7, pendulum.pivot[1]) - theta.cos() * length;
            let [ax, az] = [x, z].map(|r| r.derivative.derivative);
            let torque = pendulum.m * l * (ax * state.q[0].cos() + (az + pendulum.g) * state.q[0].sin());
            let got = pendulum.mass_matrix(&state.q)[0][0] * state.qdd[0] + pendulum.bias(&state.q, &state.qd)[0];
            assert_close("torque", &[got], &[torque], ROUND_OFF);
        }
    }
}
