//! A chain of `N` point masses on massless rods in the x–z plane, hung at the origin; absolute angles from straight
//! down.
//!
//! `rᵢ = Σ_{k ≤ i} lₖ [sin θₖ, 0, −cos θₖ]`. With `μᵢⱼ = Σ_{k ≥ max(i,j)} mₖ`, the mass that hangs on both rods, every
//! symbol is a line; for equal links `μᵢⱼ = (N − max(i,j)) m`, counted from zero.
//!
//! # Source
//!
//! Landau, Lifshitz, *Mechanics*, 3rd edition 1976, §5, problem 1, continued to `N` masses: the sum
//! `½ Σ mₖ |ṙₖ|²` with `ṙₖ = Σ_{i ≤ k} lᵢ θ̇ᵢ [cos θᵢ, 0, sin θᵢ]`, ordered by pairs `i, j`.

use super::EquationsOfMotion;
use std::array::from_fn;

/// Parameters, from the hinge to the free end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NPendulum<const N: usize> {
    /// Masses at the ends of the rods, in kg.
    pub m: [f64; N],
    /// Lengths of the rods, in m.
    pub l: [f64; N],
    /// Gravity, in m/s².
    pub g: f64,
}

impl<const N: usize> NPendulum<N> {
    /// Equal links.
    pub fn uniform(m: f64, l: f64, g: f64) -> Self {
        Self { m: [m; N], l: [l; N], g }
    }

    /// `μᵢⱼ = Σ_{k ≥ max(i,j)} mₖ`.
    fn hanging_mass(&self, i: usize, j: usize) -> f64 {
        self.m[i.max(j)..].iter().sum()
    }
}

impl<const N: usize> EquationsOfMotion<N> for NPendulum<N> {
    /// `Mᵢⱼ = μᵢⱼ lᵢ lⱼ cos(θᵢ − θⱼ)`.
    fn mass_matrix(&self, theta: &[f64; N]) -> [[f64; N]; N] {
        let entry = |i, j| self.hanging_mass(i, j) * self.l[i] * self.l[j] * (theta[i] - theta[j]).cos();
        from_fn(|i| from_fn(|j| entry(i, j)))
    }

    /// `Cᵢⱼ = μᵢⱼ lᵢ lⱼ sin(θᵢ − θⱼ) θ̇ⱼ`.
    fn coriolis_matrix(&self, theta: &[f64; N], thetad: &[f64; N]) -> [[f64; N]; N] {
        let entry = |i, j| self.hanging_mass(i, j) * self.l[i] * self.l[j] * (theta[i] - theta[j]).sin() * thetad[j];
        from_fn(|i| from_fn(|j| entry(i, j)))
    }

    /// `Gᵢ = μᵢᵢ g lᵢ sin θᵢ`.
    fn gravity(&self, theta: &[f64; N]) -> [f64; N] {
        from_fn(|i| self.hanging_mass(i, i) * self.g * self.l[i] * theta[i].sin())
    }

    /// `½ Σᵢⱼ μᵢⱼ lᵢ lⱼ θ̇ᵢ θ̇ⱼ cos(θᵢ − θⱼ)`.
    fn kinetic_energy(&self, theta: &[f64; N], thetad: &[f64; N]) -> f64 {
        let momentum = super::product(&self.mass_matrix(theta), thetad);
        0.5 * momentum.iter().zip(thetad).map(|(momentum, rate)| momentum * rate).sum::<f64>()
    }

    /// Zero at the height of the hinge: `−Σ μᵢᵢ g lᵢ cos θᵢ`.
    fn potential_energy(&self, theta: &[f64; N]) -> f64 {
        -(0..N).map(|i| self.hanging_mass(i, i) * self.g * self.l[i] * theta[i].cos()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::{positive, states};
    use crate::reference::double_pendulum::DoublePendulum;
    use crate::reference::lagrange::{Number, Particles};
    use crate::reference::tests::{ROUND_OFF, agrees_with_lagrange};

    impl<const N: usize> Particles<N> for NPendulum<N> {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, theta: &[S; N]) -> Vec<(f64, [S; 3])> {
            let mut end = [S::constant(0.0); 3];
            let mut particles = Vec::new();
            for k in 0..N {
                let [x, y, z] = end;
                end = [x + theta[k].sin() * self.l[k], y, z - theta[k].cos() * self.l[k]];
                particles.push((self.m[k], end));
            }
            particles
        }
    }

    #[test]
    fn ten_equal_links_agree_with_lagrange_over_positions() {
        agrees_with_lagrange(&NPendulum::<10>::uniform(0.4, 0.3, 9.81));
    }

    #[test]
    fn five_unequal_links_agree_with_lagrange_over_positions() {
        agrees_with_lagrange(&NPendulum::<5> { m: positive(1), l: positive(2), g: 9.81 });
    }

    /// For equal links, `Mᵢⱼ = (N − max(i,j)) m l² cos(θᵢ − θⱼ)`.
    #[test]
    fn equal_links_have_the_short_mass_matrix() {
        let theta = states::<10>(3, 1)[0].q;
        let short: [[f64; 10]; 10] =
            from_fn(|i| from_fn(|j| (10 - i.max(j)) as f64 * 0.4 * 0.09 * (theta[i] - theta[j]).cos()));
        let got = NPendulum::<10>::uniform(0.4, 0.3, 9.81).mass_matrix(&theta);
        assert_close("M", &got.concat(), &short.concat(), ROUND_OFF);
    }

    #[test]
    fn two_links_are_the_double_pendulum() {
        let double = DoublePendulum { m1: 1.2, m2: 0.7, l1: 0.8, l2: 1.1, g: 9.81 };
        let chain = NPendulum { m: [1.2, 0.7], l: [0.8, 1.1], g: 9.81 };
        for state in states::<2>(4, 20) {
            let [got, want] = [
                chain.inverse_dynamics(&state.q, &state.qd, &state.qdd),
                double.inverse_dynamics(&state.q, &state.qd, &state.qdd),
            ];
            assert_close("Q", &got, &want, ROUND_OFF);
        }
    }
}
