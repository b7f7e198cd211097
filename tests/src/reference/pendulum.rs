//! A point mass on a massless rod, hinged at the origin; viscous friction in the hinge.
//!
//! `θ` is measured from straight down: `r = l [sin θ, 0, −cos θ]`.
//!
//! # Source
//!
//! Landau, Lifshitz, *Mechanics*, 3rd edition 1976, §5 (problem 1 with one mass); Rayleigh's function: Goldstein,
//! Poole, Safko, *Classical Mechanics*, 3rd edition 2002, section 1.5.

use super::EquationsOfMotion;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum {
    /// Mass of the bob, in kg.
    pub m: f64,
    /// Length of the rod, in m.
    pub l: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Viscous friction of the hinge, in N·m·s.
    pub b: f64,
}

impl EquationsOfMotion<1> for Pendulum {
    fn mass_matrix(&self, _q: &[f64; 1]) -> [[f64; 1]; 1] {
        [[self.m * self.l * self.l]]
    }

    fn coriolis_matrix(&self, _q: &[f64; 1], _qd: &[f64; 1]) -> [[f64; 1]; 1] {
        [[0.0]]
    }

    fn gravity(&self, &[theta]: &[f64; 1]) -> [f64; 1] {
        [self.m * self.g * self.l * theta.sin()]
    }

    fn kinetic_energy(&self, _q: &[f64; 1], &[thetad]: &[f64; 1]) -> f64 {
        0.5 * self.m * (self.l * thetad).powi(2)
    }

    /// Zero at the height of the hinge.
    fn potential_energy(&self, &[theta]: &[f64; 1]) -> f64 {
        -self.m * self.g * self.l * theta.cos()
    }

    fn dissipation_force(&self, &[thetad]: &[f64; 1]) -> [f64; 1] {
        [self.b * thetad]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::lagrange::{Number, Particles};
    use crate::reference::tests::agrees_with_lagrange;

    impl Particles<1> for Pendulum {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[theta]: &[S; 1]) -> Vec<(f64, [S; 3])> {
            vec![(self.m, [theta.sin() * self.l, S::constant(0.0), theta.cos() * -self.l])]
        }
    }

    const PENDULUM: Pendulum = Pendulum { m: 1.3, l: 0.7, g: 9.81, b: 0.2 };

    #[test]
    fn agrees_with_lagrange_over_positions() {
        agrees_with_lagrange(&PENDULUM);
    }

    /// Energy balance `d/dt (T + V) = −b θ̇²` with `θ̈` from the equation of motion, by the chain rule.
    #[test]
    fn friction_takes_energy() {
        let Pendulum { m, l, g, b } = PENDULUM;
        let (q, qd) = ([0.8], [1.1]);
        let qdd = [-(PENDULUM.gravity(&q)[0] + PENDULUM.dissipation_force(&qd)[0]) / PENDULUM.mass_matrix(&q)[0][0]];
        let power = m * l * l * qd[0] * qdd[0] + m * g * l * q[0].sin() * qd[0];
        assert!((power + b * qd[0] * qd[0]).abs() < 1e-14, "two products of order one, rounded");
    }
}
