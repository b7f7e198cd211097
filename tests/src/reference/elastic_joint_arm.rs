//! A two-link arm in a vertical plane whose motors turn its joints through springs.
//!
//! # Source
//!
//! Spong, *Modeling and control of elastic joint robots*, ASME Journal of Dynamic Systems, Measurement, and Control
//! 109, 1987: `D(q) q̈ + c(q, q̇) + g(q) + K (q − θ) = 0`, `J θ̈ − K (q − θ) = u`, rotors turning about their own axes
//! only. The arm is the planar elbow manipulator of Spong, Hutchinson, Vidyasagar, *Robot Modeling and Control*, 2006,
//! chapter on dynamics. Joint damping is added.

use super::dynamics::Dynamics;

/// Parameters and inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticJointArm {
    /// Masses of the links, in kg.
    pub m: [f64; 2],
    /// Length of the first link, in m.
    pub l: f64,
    /// From each joint to the mass centre of its link, in m.
    pub centre: [f64; 2],
    /// Moments of inertia about the mass centres, in kg·m².
    pub moment: [f64; 2],
    /// Moments of inertia of the rotors, in kg·m².
    pub rotor: [f64; 2],
    /// Stiffnesses, in N·m/rad.
    pub k: [f64; 2],
    /// Dampings, in N·m·s/rad.
    pub d: [f64; 2],
    /// Gravity, in m/s².
    pub g: f64,
    /// Torques of the motors, in N·m.
    pub tau: [f64; 2],
}

/// Coordinates `[q₁, q₂, θ₁, θ₂]`.
impl Dynamics<4> for ElasticJointArm {
    /// `d₁₁ = m₁ c₁² + m₂ (l² + c₂² + 2 l c₂ cos q₂) + I₁ + I₂`, `d₁₂ = m₂ (c₂² + l c₂ cos q₂) + I₂`, `d₂₂ = m₂ c₂² +
    /// I₂`.
    fn mass_matrix(&self, q: &[f64; 4]) -> [[f64; 4]; 4] {
        let ([m1, m2], [c1, c2], [i1, i2], l) = (self.m, self.centre, self.moment, self.l);
        let d11 = m1 * c1 * c1 + m2 * (l * l + c2 * c2 + 2.0 * l * c2 * q[1].cos()) + i1 + i2;
        let d12 = m2 * (c2 * c2 + l * c2 * q[1].cos()) + i2;
        let d22 = m2 * c2 * c2 + i2;
        let [j1, j2] = self.rotor;
        [[d11, d12, 0.0, 0.0], [d12, d22, 0.0, 0.0], [0.0, 0.0, j1, 0.0], [0.0, 0.0, 0.0, j2]]
    }

    fn bias(&self, q: &[f64; 4], qd: &[f64; 4]) -> [f64; 4] {
        let ([m1, m2], [c1, c2], l) = (self.m, self.centre, self.l);
        let h = -m2 * l * c2 * q[1].sin();
        let lower = m2 * c2 * self.g * (q[0] + q[1]).cos();
        let weight = [(m1 * c1 + m2 * l) * self.g * q[0].cos() + lower, lower];
        let twist = [0, 1].map(|i| self.k[i] * (q[i] - q[i + 2]));
        [
            h * (2.0 * qd[0] * qd[1] + qd[1] * qd[1]) + weight[0] + twist[0],
            -h * qd[0] * qd[0] + weight[1] + twist[1],
            -twist[0],
            -twist[1],
        ]
    }

    fn force(&self, _: &[f64; 4], qd: &[f64; 4]) -> [f64; 4] {
        let drag = [0, 1].map(|i| self.d[i] * (qd[i] - qd[i + 2]));
        [-drag[0], -drag[1], self.tau[0] + drag[0], self.tau[1] + drag[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::dynamics::tests::agrees_with_lagrange;
    use crate::reference::lagrange::{Energies, Number, Particles};

    /// Each link as two halves at the radius of gyration on both sides of its mass centre; a rotor as a particle that
    /// goes round at one metre.
    struct Bodies<'a>(&'a ElasticJointArm);

    impl Particles<4> for Bodies<'_> {
        fn g(&self) -> f64 {
            self.0.g
        }
        fn particles<S: Number>(&self, q: &[S; 4]) -> Vec<(f64, [S; 3])> {
            let (arm, zero) = (self.0, S::constant(0.0));
            let at = |elbow: f64, first: f64, second: f64| {
                let (upper, lower) = (q[0], q[0] + q[1]);
                let x = upper.cos() * (elbow + first) + lower.cos() * second;
                [x, zero, upper.sin() * (elbow + first) + lower.sin() * second]
            };
            let radius = [0, 1].map(|i| (arm.moment[i] / arm.m[i]).sqrt());
            let mut particles = Vec::new();
            for side in [-1.0, 1.0] {
                particles.push((0.5 * arm.m[0], at(0.0, arm.centre[0] + side * radius[0], 0.0)));
                particles.push((0.5 * arm.m[1], at(arm.l, 0.0, arm.centre[1] + side * radius[1])));
            }
            particles.extend([0, 1].map(|i| (arm.rotor[i], [q[i + 2].cos(), q[i + 2].sin(), zero])));
            particles
        }
    }

    impl Energies<4> for ElasticJointArm {
        fn kinetic<S: Number>(&self, q: &[S; 4], qd: &[S; 4]) -> S {
            Bodies(self).kinetic(q, qd)
        }
        fn potential<S: Number>(&self, q: &[S; 4]) -> S {
            let spring = |i: usize| (q[i] - q[i + 2]) * (q[i] - q[i + 2]) * (0.5 * self.k[i]);
            Bodies(self).potential(q) + spring(0) + spring(1)
        }
    }

    #[test]
    fn agrees_with_lagrange_over_particles() {
        let arm = ElasticJointArm {
            m: [1.4, 0.9],
            l: 0.7,
            centre: [0.3, 0.4],
            moment: [0.06, 0.05],
            rotor: [0.2, 0.1],
            k: [20.0, 30.0],
            d: [0.3, 0.2],
            g: 9.81,
            tau: [1.0, -2.0],
        };
        agrees_with_lagrange(&arm, &arm);
    }
}
