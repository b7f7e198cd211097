//! Furuta's pendulum: the arm turns by `α` about the vertical, the pendulum hangs from its end, `θ` from straight down.
//!
//! # Source
//!
//! Cazzolato, Prime, *On the dynamics of the Furuta pendulum*, Journal of Control Science and Engineering, 2011, for a
//! symmetric pendulum; derived anew here for one whose moment of inertia about its own length is kept, and verified
//! against a pendulum made of particles.

use super::dynamics::Dynamics;

/// Parameters and input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FurutaPendulum {
    /// Moment of inertia of the arm about the axis, in kg·m².
    pub arm_moment: f64,
    /// From the axis to the hinge, in m.
    pub arm_length: f64,
    /// Mass of the pendulum, in kg.
    pub m: f64,
    /// From the hinge to the pendulum's mass centre, in m.
    pub l: f64,
    /// Its moment of inertia across its length, about the mass centre, in kg·m².
    pub transverse: f64,
    /// Its moment of inertia about its length, in kg·m².
    pub axial: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Viscous friction of bearing and hinge, in N·m·s.
    pub b: [f64; 2],
    /// Torque on the arm, in N·m.
    pub tau: f64,
}

impl FurutaPendulum {
    /// `J = I + m l²` about the hinge; `J − I_a` swings out.
    fn hinge_moment(&self) -> f64 {
        self.transverse + self.m * self.l * self.l
    }
}

/// Coordinates `[α, θ]`. The pendulum swings about the arm, so that its bob is at `[L, l sin θ, −l cos θ]` in the arm's
/// axes.
impl Dynamics<2> for FurutaPendulum {
    /// `[[J₀ + m L² + J sin²θ + I_a cos²θ, m L l cos θ], [m L l cos θ, J]]`.
    fn mass_matrix(&self, &[_, theta]: &[f64; 2]) -> [[f64; 2]; 2] {
        let (j, (s, c)) = (self.hinge_moment(), theta.sin_cos());
        let about = self.arm_moment + self.m * self.arm_length.powi(2) + j * s * s + self.axial * c * c;
        let coupling = self.m * self.arm_length * self.l * c;
        [[about, coupling], [coupling, j]]
    }

    /// `h_α = (J − I_a) sin 2θ α̇ θ̇ − m L l sin θ θ̇²`, `h_θ = −½ (J − I_a) sin 2θ α̇² + m g l sin θ`.
    fn bias(&self, &[_, theta]: &[f64; 2], &[ad, td]: &[f64; 2]) -> [f64; 2] {
        let swing = (self.hinge_moment() - self.axial) * (2.0 * theta).sin();
        [
            swing * ad * td - self.m * self.arm_length * self.l * theta.sin() * td * td,
            -0.5 * swing * ad * ad + self.m * self.g * self.l * theta.sin(),
        ]
    }

    fn force(&self, _: &[f64; 2], &[ad, td]: &[f64; 2]) -> [f64; 2] {
        [self.tau - self.b[0] * ad, -self.b[1] * td]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::dynamics::tests::agrees_with_lagrange;
    use crate::reference::lagrange::{Number, Particles};

    /// The arm as a particle at one metre, the pendulum as six particles of a sixth of its mass: two along its length
    /// at `±a`, four across it at `±b`, so that `I_a = ⅔ m b²` and `I = ⅓ m (a² + b²)`.
    impl Particles<2> for FurutaPendulum {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[alpha, theta]: &[S; 2]) -> Vec<(f64, [S; 3])> {
            let across = (1.5 * self.axial / self.m).sqrt();
            let along = (3.0 * self.transverse / self.m - across * across).sqrt();
            // In the arm's axes x along the arm, y to its left, z up: a point at (u, v) across and w down the pendulum.
            let at = |u: f64, v: f64, w: f64| {
                let x = S::constant(self.arm_length + u);
                let y = theta.cos() * v + theta.sin() * w;
                let z = theta.sin() * v - theta.cos() * w;
                (self.m / 6.0, [x * alpha.cos() - y * alpha.sin(), x * alpha.sin() + y * alpha.cos(), z])
            };
            let (a, b, l) = (along, across, self.l);
            let arm = (self.arm_moment, [alpha.cos(), alpha.sin(), S::constant(0.0)]);
            let [front, back, left, right] = [at(b, 0.0, l), at(-b, 0.0, l), at(0.0, b, l), at(0.0, -b, l)];
            vec![arm, front, back, left, right, at(0.0, 0.0, l + a), at(0.0, 0.0, l - a)]
        }
    }

    #[test]
    fn agrees_with_lagrange_over_particles() {
        let pendulum = FurutaPendulum {
            arm_moment: 0.03,
            arm_length: 0.4,
            m: 0.6,
            l: 0.5,
            transverse: 0.04,
            axial: 0.03,
            g: 9.81,
            b: [0.1, 0.2],
            tau: 0.7,
        };
        agrees_with_lagrange(&pendulum, &pendulum);
    }
}
