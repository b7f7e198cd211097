//! The spatial circular restricted three-body problem in rotating axes, primaries at `[−μ, 0, 0]` and `[1 − μ, 0, 0]`.
//!
//! # Source
//!
//! Szebehely, *Theory of Orbits*, 1967, chapters 1 and 10; Murray, Dermott, *Solar System Dynamics*, 1999, chapter 3:
//! `ẍ − 2 ẏ = ∂U/∂x`, `ÿ + 2 ẋ = ∂U/∂y`, `z̈ = ∂U/∂z` with `U = ½ (x² + y²) + (1 − μ)/r₁ + μ/r₂`, and Jacobi's `2 U −
//! v²`.

use super::dynamics::Dynamics;

/// The mass of the smaller primary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestrictedThreeBody {
    /// `μ`.
    pub mu: f64,
}

impl RestrictedThreeBody {
    /// `C = x² + y² + 2 (1 − μ)/r₁ + 2 μ/r₂ − v²`.
    pub fn jacobi_constant(&self, q: &[f64; 3], qd: &[f64; 3]) -> f64 {
        let [r1, r2] = self.distances(q);
        let speed2: f64 = qd.iter().map(|rate| rate * rate).sum();
        q[0] * q[0] + q[1] * q[1] + 2.0 * (1.0 - self.mu) / r1 + 2.0 * self.mu / r2 - speed2
    }

    fn distances(&self, &[x, y, z]: &[f64; 3]) -> [f64; 2] {
        [-self.mu, 1.0 - self.mu].map(|primary| ((x - primary).powi(2) + y * y + z * z).sqrt())
    }
}

impl Dynamics<3> for RestrictedThreeBody {
    fn mass_matrix(&self, _: &[f64; 3]) -> [[f64; 3]; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    }

    fn bias(&self, q: &[f64; 3], &[xd, yd, _]: &[f64; 3]) -> [f64; 3] {
        let (&[x, y, z], mu) = (q, self.mu);
        let [first, second] = self.distances(q);
        let [first, second] = [(1.0 - mu) / first.powi(3), mu / second.powi(3)];
        [
            -2.0 * yd - x + first * (x + mu) + second * (x - 1.0 + mu),
            2.0 * xd - y + (first + second) * y,
            (first + second) * z,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::reference::tests::ROUND_OFF;

    /// At the corner of the equilateral triangle nothing pulls: L₄, with `C = 3 − μ (1 − μ)`.
    #[test]
    fn lagranges_triangle_rests() {
        let system = RestrictedThreeBody { mu: 0.0121505856 };
        let corner = [0.5 - system.mu, 0.75_f64.sqrt(), 0.0];
        assert_close("h", &system.bias(&corner, &[0.0; 3]), &[0.0; 3], ROUND_OFF);
        let want = 3.0 - system.mu * (1.0 - system.mu);
        assert_close("C", &[system.jacobi_constant(&corner, &[0.0; 3])], &[want], ROUND_OFF);
    }

    /// `Ċ = 2 q̇ · (∂U/∂q − q̈) = 0`: at the accelerations of the equations C does not change.
    #[test]
    fn the_equations_keep_jacobis_constant() {
        let system = RestrictedThreeBody { mu: 0.3 };
        let (q, qd, step) = ([0.4, 0.7, -0.2], [0.3, -0.9, 0.5], 1e-4);
        let qdd = system.bias(&q, &qd).map(|h| -h);
        let along = |s: f64| {
            let q = std::array::from_fn(|i| q[i] + s * qd[i] + 0.5 * s * s * qdd[i]);
            system.jacobi_constant(&q, &std::array::from_fn(|i| qd[i] + s * qdd[i]))
        };
        let rate = (along(step) - along(-step)) / (2.0 * step);
        assert!(rate.abs() < 1e-6, "{rate:e}, where the central difference is good to step²");
    }
}
