//! Lagrange's top in Euler angles z, x, z.
//!
//! # Source
//!
//! Goldstein, Poole & Safko, *Classical Mechanics*, 3rd ed. 2002, section 5.7, for the Lagrangian. With the spin about
//! the axis `ω₃ = ψ̇ + φ̇ cos θ` its equations are
//!
//! ```text
//! I₃ ω̇₃ = 0
//! I₁ θ̈ = sin θ (I₁ φ̇² cos θ − I₃ ω₃ φ̇ + m g l)
//! I₁ φ̈ sin θ = θ̇ (I₃ ω₃ − 2 I₁ φ̇ cos θ)
//! ```

use mbs_runtime::Scalar;

use super::ByHand;

/// What depends on parameters alone.
pub struct HeavyTop<T> {
    i1: T,
    i3: T,
    /// `I₁ − I₃`
    difference: T,
    /// `I₃ / 2`
    half: T,
    /// `I₃ / I₁`
    ratio: T,
    /// `m g l`
    weight: T,
    /// `m g l / I₁`
    weight_by_i1: T,
}

impl<T: Scalar> HeavyTop<T> {
    /// From the parameters in the order of the file: mass, distance, moments of inertia, gravity.
    pub fn new([m, l, i1, i3, g]: [T; 5]) -> Self {
        let weight = m * g * l;
        HeavyTop {
            i1,
            i3,
            difference: i1 - i3,
            half: i3 / T::from_f64(2.0),
            ratio: i3 / i1,
            weight,
            weight_by_i1: weight / i1,
        }
    }
}

impl<T: Scalar> ByHand<T, 3, 0> for HeavyTop<T> {
    fn mass_matrix(&self, &[_, theta, _]: &[T; 3]) -> [[T; 3]; 3] {
        let (zero, (s, c)) = (T::zero(), theta.sin_cos());
        let along = self.i3 * c;
        [[self.i1 * s * s + along * c, zero, along], [zero, self.i1, zero], [along, zero, self.i3]]
    }

    fn coriolis_matrix(&self, &[_, theta, _]: &[T; 3], &[phi_dot, theta_dot, psi_dot]: &[T; 3]) -> [[T; 3]; 3] {
        let (zero, (s, c)) = (T::zero(), theta.sin_cos());
        let half = self.half * s;
        let k = self.difference * s * c;
        let around = k * phi_dot - half * psi_dot;
        let (nodding, turning) = (half * theta_dot, half * phi_dot);
        [[k * theta_dot, around, -nodding], [-around, zero, turning], [-nodding, -turning, zero]]
    }

    fn gravity(&self, &[_, theta, _]: &[T; 3]) -> [T; 3] {
        [T::zero(), -(self.weight * theta.sin()), T::zero()]
    }

    fn bias(&self, &[_, theta, _]: &[T; 3], &[phi_dot, theta_dot, psi_dot]: &[T; 3]) -> [T; 3] {
        let (s, c) = theta.sin_cos();
        let k = self.difference * c * phi_dot;
        let spin = self.i3 * psi_dot;
        let nodding = theta_dot * s;
        [
            nodding * (T::from_f64(2.0) * k - spin),
            s * (phi_dot * (spin - k) - self.weight),
            -(self.i3 * phi_dot * nodding),
        ]
    }

    fn inverse_dynamics(
        &self,
        &[_, theta, _]: &[T; 3],
        &[phi_dot, theta_dot, psi_dot]: &[T; 3],
        &[phi_ddot, theta_ddot, psi_ddot]: &[T; 3],
    ) -> [T; 3] {
        let (s, c) = theta.sin_cos();
        let along = self.i3 * c;
        let k = self.difference * c * phi_dot;
        let spin = self.i3 * psi_dot;
        let nodding = theta_dot * s;
        [
            (self.i1 * s * s + along * c) * phi_ddot + along * psi_ddot + nodding * (T::from_f64(2.0) * k - spin),
            self.i1 * theta_ddot + s * (phi_dot * (spin - k) - self.weight),
            along * phi_ddot + self.i3 * (psi_ddot - phi_dot * nodding),
        ]
    }

    fn forward_dynamics(&self, &[_, theta, _]: &[T; 3], &[phi_dot, theta_dot, psi_dot]: &[T; 3], _: &[T; 0]) -> [T; 3] {
        let (s, c) = theta.sin_cos();
        let along = phi_dot * c;
        let spin = self.ratio * (psi_dot + along);
        let phi_ddot = theta_dot * (spin - T::from_f64(2.0) * along) / s;
        let theta_ddot = s * (phi_dot * (along - spin) + self.weight_by_i1);
        [phi_ddot, theta_ddot, phi_dot * theta_dot * s - phi_ddot * c]
    }
}
