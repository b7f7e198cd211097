//! Two point masses on massless rods, the second hinged on the first; absolute angles from straight down.
//!
//! `r₁ = l₁ [sin θ₁, 0, −cos θ₁]`, `r₂ = r₁ + l₂ [sin θ₂, 0, −cos θ₂]`.
//!
//! # Source
//!
//! Landau, Lifshitz, *Mechanics*, 3rd edition 1976, §5, problem 1.

use super::EquationsOfMotion;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoublePendulum {
    /// Mass of the upper bob, in kg.
    pub m1: f64,
    /// Mass of the lower bob, in kg.
    pub m2: f64,
    /// Length of the upper rod, in m.
    pub l1: f64,
    /// Length of the lower rod, in m.
    pub l2: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl EquationsOfMotion<2> for DoublePendulum {
    fn mass_matrix(&self, &[theta1, theta2]: &[f64; 2]) -> [[f64; 2]; 2] {
        let Self { m1, m2, l1, l2, .. } = self;
        let coupling = m2 * l1 * l2 * (theta1 - theta2).cos();
        [[(m1 + m2) * l1 * l1, coupling], [coupling, m2 * l2 * l2]]
    }

    /// `Γ₁₂₂ = m₂ l₁ l₂ sin(θ₁ − θ₂) = −Γ₂₁₁`; the others are zero.
    fn coriolis_matrix(&self, &[theta1, theta2]: &[f64; 2], &[theta1d, theta2d]: &[f64; 2]) -> [[f64; 2]; 2] {
        let gamma = self.m2 * self.l1 * self.l2 * (theta1 - theta2).sin();
        [[0.0, gamma * theta2d], [-gamma * theta1d, 0.0]]
    }

    fn gravity(&self, &[theta1, theta2]: &[f64; 2]) -> [f64; 2] {
        let Self { m1, m2, l1, l2, g } = self;
        [(m1 + m2) * g * l1 * theta1.sin(), m2 * g * l2 * theta2.sin()]
    }

    /// `½ (m₁ + m₂) l₁² θ̇₁² + ½ m₂ l₂² θ̇₂² + m₂ l₁ l₂ θ̇₁ θ̇₂ cos(θ₁ − θ₂)`.
    fn kinetic_energy(&self, &[theta1, theta2]: &[f64; 2], &[theta1d, theta2d]: &[f64; 2]) -> f64 {
        let Self { m1, m2, l1, l2, .. } = self;
        0.5 * (m1 + m2) * (l1 * theta1d).powi(2)
            + 0.5 * m2 * (l2 * theta2d).powi(2)
            + m2 * l1 * l2 * theta1d * theta2d * (theta1 - theta2).cos()
    }

    /// Zero with both bobs at the height of the hinge: `−(m₁ + m₂) g l₁ cos θ₁ − m₂ g l₂ cos θ₂`.
    fn potential_energy(&self, &[theta1, theta2]: &[f64; 2]) -> f64 {
        let Self { m1, m2, l1, l2, g } = self;
        -(m1 + m2) * g * l1 * theta1.cos() - m2 * g * l2 * theta2.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::lagrange::{Number, Particles};
    use crate::reference::tests::agrees_with_lagrange;

    impl Particles<2> for DoublePendulum {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[theta1, theta2]: &[S; 2]) -> Vec<(f64, [S; 3])> {
            let zero = S::constant(0.0);
            let [x1, z1] = [theta1.sin() * self.l1, theta1.cos() * -self.l1];
            let [x2, z2] = [x1 + theta2.sin() * self.l2, z1 - theta2.cos() * self.l2];
            vec![(self.m1, [x1, zero, z1]), (self.m2, [x2, zero, z2])]
        }
    }

    #[test]
    fn agrees_with_lagrange_over_positions() {
        agrees_with_lagrange(&DoublePendulum { m1: 1.2, m2: 0.7, l1: 0.8, l2: 1.1, g: 9.81 });
    }
}
