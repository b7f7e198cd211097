//! A point mass at a fixed distance from the origin.
//!
//! `θ` from straight down, `φ` the azimuth: `r = l [sin θ cos φ, sin θ sin φ, −cos θ]`. `M` is singular at `θ = 0`.
//!
//! # Source
//!
//! Landau, Lifshitz, *Mechanics*, 3rd edition 1976, §14, problem 1 (there `V = −m g l cos θ`, as here).

use super::EquationsOfMotion;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalPendulum {
    /// Mass, in kg.
    pub m: f64,
    /// Length, in m.
    pub l: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl SphericalPendulum {
    /// `p_φ = m l² sin²θ φ̇`: the angular momentum about the vertical, conserved.
    pub fn vertical_momentum(&self, &[theta, _]: &[f64; 2], &[_, phid]: &[f64; 2]) -> f64 {
        self.m * (self.l * theta.sin()).powi(2) * phid
    }
}

/// Coordinates `[θ, φ]`.
impl EquationsOfMotion<2> for SphericalPendulum {
    fn mass_matrix(&self, &[theta, _]: &[f64; 2]) -> [[f64; 2]; 2] {
        let ml2 = self.m * self.l * self.l;
        [[ml2, 0.0], [0.0, ml2 * theta.sin().powi(2)]]
    }

    /// `Γ_φθφ = Γ_φφθ = −Γ_θφφ = m l² sin θ cos θ`; the others are zero.
    fn coriolis_matrix(&self, &[theta, _]: &[f64; 2], &[thetad, phid]: &[f64; 2]) -> [[f64; 2]; 2] {
        let gamma = self.m * self.l * self.l * theta.sin() * theta.cos();
        [[0.0, -gamma * phid], [gamma * phid, gamma * thetad]]
    }

    fn gravity(&self, &[theta, _]: &[f64; 2]) -> [f64; 2] {
        [self.m * self.g * self.l * theta.sin(), 0.0]
    }

    /// `½ m l² (θ̇² + φ̇² sin²θ)`.
    fn kinetic_energy(&self, &[theta, _]: &[f64; 2], &[thetad, phid]: &[f64; 2]) -> f64 {
        0.5 * self.m * self.l * self.l * (thetad * thetad + (phid * theta.sin()).powi(2))
    }

    /// Zero at the height of the origin.
    fn potential_energy(&self, &[theta, _]: &[f64; 2]) -> f64 {
        -self.m * self.g * self.l * theta.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::lagrange::{Number, Particles};
    use crate::reference::tests::agrees_with_lagrange;

    impl Particles<2> for SphericalPendulum {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[theta, phi]: &[S; 2]) -> Vec<(f64, [S; 3])> {
            let rho = theta.sin() * self.l;
            vec![(self.m, [rho * phi.cos(), rho * phi.sin(), theta.cos() * -self.l])]
        }
    }

    const PENDULUM: SphericalPendulum = SphericalPendulum { m: 0.9, l: 1.4, g: 9.81 };

    #[test]
    fn agrees_with_lagrange_over_positions() {
        agrees_with_lagrange(&PENDULUM);
    }

    /// The conical pendulum, `φ̇² = g/(l cos θ)` at constant `θ`, needs no force.
    #[test]
    fn conical_pendulum_is_free() {
        let theta: f64 = 0.7;
        let qd = [0.0, (PENDULUM.g / (PENDULUM.l * theta.cos())).sqrt()];
        let force = PENDULUM.inverse_dynamics(&[theta, 0.3], &qd, &[0.0, 0.0]);
        assert!(force.iter().all(|force| force.abs() < 1e-13), "terms of some 8 N·m cancel: {force:?}");
    }

    /// The azimuth's force is the rate of the vertical momentum, `m l² (φ̈ sin²θ + 2 θ̇ φ̇ sin θ cos θ)`.
    #[test]
    fn azimuth_force_changes_the_vertical_momentum() {
        let (q, qd, qdd, step) = ([0.6, 1.0], [0.8, -1.3], [2.0, -0.7], 1e-5);
        let momentum = |time: f64| {
            let q = std::array::from_fn(|i| q[i] + time * qd[i] + 0.5 * time * time * qdd[i]);
            PENDULUM.vertical_momentum(&q, &std::array::from_fn(|i| qd[i] + time * qdd[i]))
        };
        let rate = (momentum(step) - momentum(-step)) / (2.0 * step);
        let force = PENDULUM.inverse_dynamics(&q, &qd, &qdd)[1];
        // The central difference is good to step² and to 1e-16/step.
        assert!((force - rate).abs() < 1e-8, "{force} {rate}");
    }
}
