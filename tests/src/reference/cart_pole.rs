//! A pendulum hinged on a cart that slides on a straight rail; the cart is pushed, the rail has friction.
//!
//! The bob is at `[x + l sin θ, 0, −l cos θ]`: `θ = 0` hangs straight down.
//!
//! # Source
//!
//! Landau, Lifshitz, *Mechanics*, 3rd edition 1976, §5, problem 2; Florian, *Correct equations for the dynamics of the
//! cart-pole system*, 2007 (there the angle is from straight up and the pole is a rod).

use super::EquationsOfMotion;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartPole {
    /// Mass of the cart, in kg.
    pub m_cart: f64,
    /// Mass of the bob, in kg.
    pub m_bob: f64,
    /// Length of the pole, in m.
    pub length: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Viscous friction of the rail, in N·s/m.
    pub b: f64,
}

impl CartPole {
    /// `Q` of a horizontal push on the cart, in N.
    pub fn generalized_force(&self, push: f64) -> [f64; 2] {
        [push, 0.0]
    }
}

impl EquationsOfMotion<2> for CartPole {
    fn mass_matrix(&self, &[_, theta]: &[f64; 2]) -> [[f64; 2]; 2] {
        let coupling = self.m_bob * self.length * theta.cos();
        [[self.m_cart + self.m_bob, coupling], [coupling, self.m_bob * self.length.powi(2)]]
    }

    /// `Γ_xθθ = −m l sin θ`; the others are zero.
    fn coriolis_matrix(&self, &[_, theta]: &[f64; 2], &[_, thetad]: &[f64; 2]) -> [[f64; 2]; 2] {
        [[0.0, -self.m_bob * self.length * theta.sin() * thetad], [0.0, 0.0]]
    }

    fn gravity(&self, &[_, theta]: &[f64; 2]) -> [f64; 2] {
        [0.0, self.m_bob * self.g * self.length * theta.sin()]
    }

    /// `½ (M + m) ẋ² + m l ẋ θ̇ cos θ + ½ m l² θ̇²`.
    fn kinetic_energy(&self, &[_, theta]: &[f64; 2], &[xd, thetad]: &[f64; 2]) -> f64 {
        0.5 * (self.m_cart + self.m_bob) * xd * xd
            + self.m_bob * self.length * xd * thetad * theta.cos()
            + 0.5 * self.m_bob * (self.length * thetad).powi(2)
    }

    /// Zero at the height of the rail.
    fn potential_energy(&self, &[_, theta]: &[f64; 2]) -> f64 {
        -self.m_bob * self.g * self.length * theta.cos()
    }

    fn dissipation_force(&self, &[xd, _]: &[f64; 2]) -> [f64; 2] {
        [self.b * xd, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::lagrange::{Number, Particles};
    use crate::reference::tests::{ROUND_OFF, agrees_with_lagrange};

    impl Particles<2> for CartPole {
        fn g(&self) -> f64 {
            self.g
        }
        fn particles<S: Number>(&self, &[x, theta]: &[S; 2]) -> Vec<(f64, [S; 3])> {
            let zero = S::constant(0.0);
            let bob = [x + theta.sin() * self.length, zero, theta.cos() * -self.length];
            vec![(self.m_cart, [x, zero, zero]), (self.m_bob, bob)]
        }
    }

    const CART_POLE: CartPole = CartPole { m_cart: 1.1, m_bob: 0.3, length: 0.6, g: 9.81, b: 0.05 };

    #[test]
    fn agrees_with_lagrange_over_positions() {
        agrees_with_lagrange(&CART_POLE);
    }

    /// Newton's second law of the whole, horizontally: the push less the friction moves the mass centre,
    /// `(M + m) ẍ + m l (θ̈ cos θ − θ̇² sin θ)`.
    #[test]
    fn push_moves_the_mass_centre() {
        let CartPole { m_cart, m_bob, length, b, .. } = CART_POLE;
        for state in states::<2>(5, 20) {
            let ([_, theta], [xd, thetad], [xdd, thetadd]) = (state.q, state.qd, state.qdd);
            let bob = length * (thetadd * theta.cos() - thetad * thetad * theta.sin());
            let push = m_cart * xdd + m_bob * (xdd + bob) + b * xd;
            let force = CART_POLE.inverse_dynamics(&state.q, &state.qd, &state.qdd);
            assert_close("push", &force[..1], &CART_POLE.generalized_force(push)[..1], ROUND_OFF);
        }
    }
}
