//! A pendulum on a cart, in a fluid whose drag is controlled, and a flywheel that a clutch drags along.
//!
//! # Source
//!
//! The cart-pole ([`cart_pole`](super::cart_pole)) and a wheel; the drag `−c v` on the bob, whose velocity is
//! `v = [ẋ + l θ̇ cos θ, l θ̇ sin θ]`, gives `Q = (∂v/∂q̇)ᵀ (−c v)`, and the clutch turns the wheel by `b (ω − φ̇)`.

use super::EquationsOfMotion;
use super::cart_pole::CartPole;
use super::dynamics::Dynamics;

/// Parameters and inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrivenDampers {
    /// Cart, pole and friction of the rail.
    pub cart_pole: CartPole,
    /// Moment of inertia of the flywheel, in kg·m².
    pub moment: f64,
    /// Damping of the clutch b, in N·m·s.
    pub clutch: f64,
    /// Drag c on the bob, in N·s/m.
    pub drag: f64,
    /// Speed ω of the clutch, in rad/s.
    pub speed: f64,
}

/// Coordinates `[x, θ, φ]`.
impl Dynamics<3> for DrivenDampers {
    fn mass_matrix(&self, &[x, theta, _]: &[f64; 3]) -> [[f64; 3]; 3] {
        let [[m11, m12], [m21, m22]] = self.cart_pole.mass_matrix(&[x, theta]);
        [[m11, m12, 0.0], [m21, m22, 0.0], [0.0, 0.0, self.moment]]
    }

    fn bias(&self, &[x, theta, _]: &[f64; 3], &[xd, thetad, _]: &[f64; 3]) -> [f64; 3] {
        let [h1, h2] = self.cart_pole.bias(&[x, theta], &[xd, thetad]);
        [h1, h2, 0.0]
    }

    fn force(&self, &[_, theta, _]: &[f64; 3], &[xd, thetad, phid]: &[f64; 3]) -> [f64; 3] {
        let CartPole { length: l, b, .. } = self.cart_pole;
        let drag = [xd + l * thetad * theta.cos(), l * thetad * theta.sin()].map(|v| -self.drag * v);
        let torque = l * (drag[0] * theta.cos() + drag[1] * theta.sin());
        [drag[0] - b * xd, torque, self.clutch * (self.speed - phid)]
    }
}
