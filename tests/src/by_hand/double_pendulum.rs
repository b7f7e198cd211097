//! Two point masses on massless rods.
//!
//! # Source
//!
//! Landau & Lifshitz, *Mechanics*, 3rd ed. 1976, section 5, problem 1, for the Lagrangian. Its equations, with `δ = θ₁
//! − θ₂`,
//!
//! ```text
//! (m₁ + m₂) l₁² θ̈₁ + m₂ l₁ l₂ cos δ θ̈₂ + m₂ l₁ l₂ sin δ θ̇₂² + (m₁ + m₂) g l₁ sin θ₁ = 0
//! m₂ l₁ l₂ cos δ θ̈₁ + m₂ l₂² θ̈₂ − m₂ l₁ l₂ sin δ θ̇₁² + m₂ g l₂ sin θ₂ = 0
//! ```
//!
//! are solved by Cramer's rule.

use mbs_runtime::Scalar;

use super::ByHand;

/// What depends on parameters alone.
pub struct DoublePendulum<T> {
    /// `(m₁ + m₂) l₁²`
    upper: T,
    /// `m₂ l₂²`
    lower: T,
    /// `m₂ l₁ l₂`
    coupling: T,
    /// `upper · lower`
    determinant: T,
    /// `(m₁ + m₂) g l₁`
    upper_weight: T,
    /// `m₂ g l₂`
    lower_weight: T,
}

impl<T: Scalar> DoublePendulum<T> {
    /// From the parameters in the order of the file: masses, lengths, gravity.
    pub fn new([m1, m2, l1, l2, g]: [T; 5]) -> Self {
        let (upper, lower) = ((m1 + m2) * l1 * l1, m2 * l2 * l2);
        DoublePendulum {
            upper,
            lower,
            coupling: m2 * l1 * l2,
            determinant: upper * lower,
            upper_weight: (m1 + m2) * g * l1,
            lower_weight: m2 * g * l2,
        }
    }
}

impl<T: Scalar> ByHand<T, 2, 0> for DoublePendulum<T> {
    fn mass_matrix(&self, &[theta1, theta2]: &[T; 2]) -> [[T; 2]; 2] {
        let coupling = self.coupling * (theta1 - theta2).cos();
        [[self.upper, coupling], [coupling, self.lower]]
    }

    fn coriolis_matrix(&self, &[theta1, theta2]: &[T; 2], &[theta1_dot, theta2_dot]: &[T; 2]) -> [[T; 2]; 2] {
        let across = self.coupling * (theta1 - theta2).sin();
        [[T::zero(), across * theta2_dot], [-(across * theta1_dot), T::zero()]]
    }

    fn gravity(&self, &[theta1, theta2]: &[T; 2]) -> [T; 2] {
        [self.upper_weight * theta1.sin(), self.lower_weight * theta2.sin()]
    }

    fn bias(&self, q: &[T; 2], &[theta1_dot, theta2_dot]: &[T; 2]) -> [T; 2] {
        let &[theta1, theta2] = q;
        let across = self.coupling * (theta1 - theta2).sin();
        [
            across * (theta2_dot * theta2_dot) + self.upper_weight * theta1.sin(),
            self.lower_weight * theta2.sin() - across * (theta1_dot * theta1_dot),
        ]
    }

    fn inverse_dynamics(
        &self,
        &[theta1, theta2]: &[T; 2],
        &[theta1_dot, theta2_dot]: &[T; 2],
        &[theta1_ddot, theta2_ddot]: &[T; 2],
    ) -> [T; 2] {
        let (s, c) = (theta1 - theta2).sin_cos();
        [
            self.upper * theta1_ddot
                + self.coupling * (c * theta2_ddot + s * (theta2_dot * theta2_dot))
                + self.upper_weight * theta1.sin(),
            self.lower * theta2_ddot
                + self.coupling * (c * theta1_ddot - s * (theta1_dot * theta1_dot))
                + self.lower_weight * theta2.sin(),
        ]
    }

    fn forward_dynamics(&self, q: &[T; 2], &[theta1_dot, theta2_dot]: &[T; 2], _: &[T; 0]) -> [T; 2] {
        let &[theta1, theta2] = q;
        let (s, c) = (theta1 - theta2).sin_cos();
        let (along, across) = (self.coupling * c, self.coupling * s);
        let f1 = -(across * (theta2_dot * theta2_dot) + self.upper_weight * theta1.sin());
        let f2 = across * (theta1_dot * theta1_dot) - self.lower_weight * theta2.sin();
        let determinant = self.determinant - along * along;
        [(self.lower * f1 - along * f2) / determinant, (self.upper * f2 - along * f1) / determinant]
    }
}
