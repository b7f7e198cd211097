//! A pendulum on a cart.
//!
//! # Source
//!
//! Tedrake, *Underactuated Robotics* (course notes), "The cart-pole system": with `f` the force on the cart and θ from
//! straight down, `ẍ = (f + m_p sin θ (l θ̇² + g cos θ)) / (m_c + m_p sin²θ)`; the equation of the pole is `l θ̈ = −ẍ
//! cos θ − g sin θ`. The friction of the rail is added to `f`.

use mbs_runtime::Scalar;

use super::ByHand;

/// What depends on parameters alone.
pub struct CartPole<T> {
    m_cart: T,
    m_bob: T,
    total: T,
    length: T,
    inverse_length: T,
    /// `m_bob · length`
    ml: T,
    /// `m_bob · length²`
    mll: T,
    g: T,
    /// `m_bob · g · length`
    mgl: T,
    /// `g / length`
    g_by_l: T,
    b: T,
}

impl<T: Scalar> CartPole<T> {
    /// From the parameters in the order of the file: masses of cart and bob, length, gravity, friction.
    pub fn new([m_cart, m_bob, length, g, b]: [T; 5]) -> Self {
        let ml = m_bob * length;
        CartPole {
            m_cart,
            m_bob,
            total: m_cart + m_bob,
            length,
            inverse_length: T::one() / length,
            ml,
            mll: ml * length,
            g,
            mgl: ml * g,
            g_by_l: g / length,
            b,
        }
    }
}

impl<T: Scalar> ByHand<T, 2, 1> for CartPole<T> {
    fn mass_matrix(&self, &[_, theta]: &[T; 2]) -> [[T; 2]; 2] {
        let coupling = self.ml * theta.cos();
        [[self.total, coupling], [coupling, self.mll]]
    }

    fn coriolis_matrix(&self, &[_, theta]: &[T; 2], &[_, theta_dot]: &[T; 2]) -> [[T; 2]; 2] {
        let zero = T::zero();
        [[zero, -(self.ml * theta.sin() * theta_dot)], [zero, zero]]
    }

    fn gravity(&self, &[_, theta]: &[T; 2]) -> [T; 2] {
        [T::zero(), self.mgl * theta.sin()]
    }

    fn bias(&self, &[_, theta]: &[T; 2], &[_, theta_dot]: &[T; 2]) -> [T; 2] {
        let across = self.ml * theta.sin();
        [-(across * (theta_dot * theta_dot)), self.g * across]
    }

    fn inverse_dynamics(
        &self,
        &[_, theta]: &[T; 2],
        &[x_dot, theta_dot]: &[T; 2],
        &[x_ddot, theta_ddot]: &[T; 2],
    ) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        [
            self.total * x_ddot + self.ml * (c * theta_ddot - s * (theta_dot * theta_dot)) + self.b * x_dot,
            self.ml * (c * x_ddot + self.length * theta_ddot + self.g * s),
        ]
    }

    fn forward_dynamics(&self, &[_, theta]: &[T; 2], &[x_dot, theta_dot]: &[T; 2], &[push]: &[T; 1]) -> [T; 2] {
        let (s, c) = theta.sin_cos();
        let f = push - self.b * x_dot;
        let ms = self.m_bob * s;
        let x_ddot = (f + ms * (self.length * (theta_dot * theta_dot) + self.g * c)) / (self.m_cart + ms * s);
        [x_ddot, -(self.inverse_length * c * x_ddot + self.g_by_l * s)]
    }
}
