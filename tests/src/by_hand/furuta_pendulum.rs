//! A pendulum on the end of a driven arm that turns in the horizontal plane.
//!
//! # Source
//!
//! Cazzolato & Prime, *On the dynamics of the Furuta pendulum*, Journal of Control Science and Engineering 2011. With θ
//! from straight down, the pendulum's moments about its mass centre `J` across and `J_a` along its length, `J₀ =
//! J_arm + m r² + J_a`, `J₂ = J + m l²`, `K = J₂ − J_a`,
//!
//! ```text
//! (J₀ + K sin²θ) φ̈ + m r l cos θ θ̈ + K sin 2θ φ̇ θ̇ − m r l sin θ θ̇² + b₁ φ̇ = τ
//! m r l cos θ φ̈ + J₂ θ̈ − ½ K sin 2θ φ̇² + m g l sin θ + b₂ θ̇ = 0
//! ```
//!
//! solved by Cramer's rule.

use mbs_runtime::Scalar;

use super::ByHand;

/// What depends on parameters alone.
pub struct FurutaPendulum<T> {
    /// `J_arm + m r² + J_a`
    j0: T,
    /// `J + m l²`
    j2: T,
    /// `J₂ − J_a`
    k: T,
    /// `m r l`
    coupling: T,
    /// `m g l`
    weight: T,
    b1: T,
    b2: T,
}

impl<T: Scalar> FurutaPendulum<T> {
    /// From the parameters in the order of the file.
    pub fn new([j_arm, r, m, l, j, j_along, g, b1, b2]: [T; 9]) -> Self {
        let j2 = j + m * l * l;
        let (coupling, weight) = (m * r * l, m * g * l);
        FurutaPendulum { j0: j_arm + m * r * r + j_along, j2, k: j2 - j_along, coupling, weight, b1, b2 }
    }
}

impl<T: Scalar> ByHand<T, 2, 1> for FurutaPendulum<T> {
    fn mass_matrix(&self, &[_, theta]: &[T; 2]) -> [[T; 2]; 2] {
        let (s, c) = theta.sin_cos();
        let coupling = self.coupling * c;
        [[self.j0 + self.k * (s * s), coupling], [coupling, self.j2]]
    }

    fn coriolis_matrix(&self, &[_, theta]: &[T; 2], &[phi_dot, theta_dot]: &[T; 2]) -> [[T; 2]; 2] {
        let (s, c) = theta.sin_cos();
        let k = self.k * s * c;
        let around = k * phi_dot;
        [[k * theta_dot, around - self.coupling * s * theta_dot], [-around, T::zero()]]
    }

    fn gravity(&self, &[_, theta]: &[T; 2]) -> [T; 2] {
        [T::zero(), self.weight * theta.sin()]
    }

    fn bias(&self, &[_, theta]: &[T; 2], &[phi_dot, theta_dot]: &[T; 2]) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        let around = self.k * c * phi_dot;
        [s * theta_dot * (T::from_f64(2.0) * around - self.coupling * theta_dot), s * (self.weight - around * phi_dot)]
    }

    fn inverse_dynamics(&self, q: &[T; 2], qd: &[T; 2], &[phi_ddot, theta_ddot]: &[T; 2]) -> [T; 2] {
        let &[_, theta] = q;
        let &[phi_dot, theta_dot] = qd;
        let (s, c) = theta.sin_cos();
        let along = self.coupling * c;
        let around = self.k * c * phi_dot;
        [
            (self.j0 + self.k * (s * s)) * phi_ddot
                + along * theta_ddot
                + s * theta_dot * (T::from_f64(2.0) * around - self.coupling * theta_dot)
                + self.b1 * phi_dot,
            along * phi_ddot + self.j2 * theta_ddot + s * (self.weight - around * phi_dot) + self.b2 * theta_dot,
        ]
    }

    fn forward_dynamics(&self, q: &[T; 2], qd: &[T; 2], &[torque]: &[T; 1]) -> [T; 2] {
        let &[_, theta] = q;
        let &[phi_dot, theta_dot] = qd;
        let (s, c) = theta.sin_cos();
        let along = self.coupling * c;
        let across = self.k * (s * s);
        let around = self.k * c * phi_dot;
        let f1 = torque - self.b1 * phi_dot - s * theta_dot * (T::from_f64(2.0) * around - self.coupling * theta_dot);
        let f2 = s * (around * phi_dot - self.weight) - self.b2 * theta_dot;
        let m11 = self.j0 + across;
        let determinant = m11 * self.j2 - along * along;
        [(self.j2 * f1 - along * f2) / determinant, (m11 * f2 - along * f1) / determinant]
    }
}
