//! A cart on a rail and a chain of five uniform rods, angles from straight down, positive towards +x.
//!
//! # Source
//!
//! Lagrange's equations, worked out by hand as for [`n_pendulum`](super::n_pendulum) with rods and a cart; verified
//! here against rods made of three particles.

use super::dynamics::Dynamics;

/// Parameters and input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartWithFiveLinks {
    /// Mass of the cart, in kg.
    pub m_cart: f64,
    /// Masses of the rods, in kg.
    pub m: [f64; 5],
    /// Lengths of the rods, in m.
    pub l: [f64; 5],
    /// Gravity, in m/s².
    pub g: f64,
    /// Viscous friction of the rail, in N·s/m.
    pub b: f64,
    /// Push on the cart, in N.
    pub push: f64,
}

impl CartWithFiveLinks {
    /// `μᵢ = ½ mᵢ + Σ_{k>i} mₖ`: what rod `i` carries at its end, its own mass halfway.
    fn carried(&self, i: usize) -> f64 {
        0.5 * self.m[i] + self.m[i + 1..].iter().sum::<f64>()
    }
}

/// Coordinates `[x, θ₁ … θ₅]`.
impl Dynamics<6> for CartWithFiveLinks {
    /// `M_xx = Σ m`, `M_xi = μᵢ lᵢ cos θᵢ`, `M_ij = μ_max(i,j) lᵢ lⱼ cos(θᵢ − θⱼ)`, `M_ii = (⅓ mᵢ + Σ_{k>i} mₖ) lᵢ²`.
    fn mass_matrix(&self, q: &[f64; 6]) -> [[f64; 6]; 6] {
        let mut matrix = [[0.0; 6]; 6];
        matrix[0][0] = self.m_cart + self.m.iter().sum::<f64>();
        for i in 0..5 {
            let along = self.carried(i) * self.l[i] * q[i + 1].cos();
            (matrix[0][i + 1], matrix[i + 1][0]) = (along, along);
            for j in 0..5 {
                let angle = q[i + 1] - q[j + 1];
                let mass = if i == j { self.carried(i) - self.m[i] / 6.0 } else { self.carried(i.max(j)) };
                matrix[i + 1][j + 1] = mass * self.l[i] * self.l[j] * angle.cos();
            }
        }
        matrix
    }

    /// `h_x = −Σ μᵢ lᵢ sin θᵢ θ̇ᵢ²`, `hᵢ = Σ_{j≠i} μ_max(i,j) lᵢ lⱼ sin(θᵢ − θⱼ) θ̇ⱼ² + μᵢ g lᵢ sin θᵢ`.
    fn bias(&self, q: &[f64; 6], qd: &[f64; 6]) -> [f64; 6] {
        let mut bias = [0.0; 6];
        for i in 0..5 {
            bias[0] -= self.carried(i) * self.l[i] * q[i + 1].sin() * qd[i + 1].powi(2);
            bias[i + 1] = self.carried(i) * self.g * self.l[i] * q[i + 1].sin();
            for j in (0..5).filter(|&j| j != i) {
                let lever = self.carried(i.max(j)) * self.l[i] * self.l[j];
                bias[i + 1] += lever * (q[i + 1] - q[j + 1]).sin() * qd[j + 1].powi(2);
            }
        }
        bias
    }

    fn force(&self, _: &[f64; 6], qd: &[f64; 6]) -> [f64; 6] {
        [self.push - self.b * qd[0], 0.0, 0.0, 0.0, 0.0, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::dynamics::tests::agrees_with_lagrange;
    use crate::reference::lagrange::{Number, Particles, rod};

    impl Particles<6> for CartWithFiveLinks {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, q: &[S; 6]) -> Vec<(f64, [S; 3])> {
            let zero = S::constant(0.0);
            let mut joint = [q[0], zero, zero];
            let mut particles = vec![(self.m_cart, joint)];
            for i in 0..5 {
                let [x, _, z] = joint;
                let next = [x + q[i + 1].sin() * self.l[i], zero, z - q[i + 1].cos() * self.l[i]];
                particles.extend(rod(self.m[i], joint, next));
                joint = next;
            }
            particles
        }
    }

    #[test]
    fn agrees_with_lagrange_over_particles() {
        let [m, l] = [[0.5, 0.3, 0.7, 0.2, 0.9], [0.6, 0.9, 0.4, 1.1, 0.3]];
        let cart = CartWithFiveLinks { m_cart: 1.7, m, l, g: 9.81, b: 0.2, push: 3.0 };
        agrees_with_lagrange(&cart, &cart);
    }
}
