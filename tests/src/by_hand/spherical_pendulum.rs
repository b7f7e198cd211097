//! A point mass on a massless rod that swings in every direction.
//!
//! # Source
//!
//! Landau & Lifshitz, *Mechanics*, 3rd ed. 1976, section 14, problem 1, for the Lagrangian. Its equations, with θ from
//! straight down, are `θ̈ = sin θ cos θ φ̇² − (g/l) sin θ` and `sin θ φ̈ = −2 cos θ θ̇ φ̇`.

use mbs_runtime::Scalar;

use super::ByHand;

/// What depends on parameters alone.
pub struct SphericalPendulum<T> {
    /// `m l²`
    moment: T,
    /// `m g l`
    weight: T,
    /// `g / l`
    g_by_l: T,
}

impl<T: Scalar> SphericalPendulum<T> {
    /// From the parameters in the order of the file: mass, length, gravity.
    pub fn new([m, l, g]: [T; 3]) -> Self {
        SphericalPendulum { moment: m * l * l, weight: m * g * l, g_by_l: g / l }
    }
}

impl<T: Scalar> ByHand<T, 2, 0> for SphericalPendulum<T> {
    fn mass_matrix(&self, &[theta, _]: &[T; 2]) -> [[T; 2]; 2] {
        let s = theta.sin();
        [[self.moment, T::zero()], [T::zero(), self.moment * (s * s)]]
    }

    fn coriolis_matrix(&self, &[theta, _]: &[T; 2], &[theta_dot, phi_dot]: &[T; 2]) -> [[T; 2]; 2] {
        let (s, c) = theta.sin_cos();
        let k = self.moment * s * c;
        let around = k * phi_dot;
        [[T::zero(), -around], [around, k * theta_dot]]
    }

    fn gravity(&self, &[theta, _]: &[T; 2]) -> [T; 2] {
        [self.weight * theta.sin(), T::zero()]
    }

    fn bias(&self, &[theta, _]: &[T; 2], &[theta_dot, phi_dot]: &[T; 2]) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        let around = self.moment * c * phi_dot;
        [s * (self.weight - around * phi_dot), T::from_f64(2.0) * s * around * theta_dot]
    }

    fn inverse_dynamics(
        &self,
        &[theta, _]: &[T; 2],
        &[theta_dot, phi_dot]: &[T; 2],
        &[theta_ddot, phi_ddot]: &[T; 2],
    ) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        let around = c * phi_dot;
        [
            self.moment * (theta_ddot - s * around * phi_dot) + self.weight * s,
            self.moment * s * (s * phi_ddot + T::from_f64(2.0) * around * theta_dot),
        ]
    }

    fn forward_dynamics(&self, &[theta, _]: &[T; 2], &[theta_dot, phi_dot]: &[T; 2], _: &[T; 0]) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        let around = c * phi_dot;
        [s * (around * phi_dot - self.g_by_l), -(T::from_f64(2.0) * around * theta_dot / s)]
    }
}
