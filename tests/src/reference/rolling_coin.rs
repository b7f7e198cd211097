//! A coin that rolls on a table without slipping: heading `φ`, lean `θ` from upright, spin `ψ`.
//!
//! Axes that do not spin with the coin: `e₁ = [cos φ, sin φ, 0]` along the track, `e₂ = [−sin φ cos θ, cos φ cos θ, sin
//! θ]` the axis, `e₃ = [sin φ sin θ, −cos φ sin θ, cos θ]` up in the coin's plane; `ω = θ̇ e₁ + (ψ̇ + φ̇ sin θ) e₂ + φ̇
//! cos θ e₃`.
//!
//! # Source
//!
//! Lagrange's equations with multipliers, as Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972, and Greenwood,
//! *Advanced Dynamics*, 2003, treat the rolling disk; verified here by Newton's and Euler's laws in vectors.

use super::dynamics::Dynamics;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingCoin {
    /// Mass, in kg.
    pub m: f64,
    /// Radius, in m.
    pub radius: f64,
    /// Moment of inertia about the axis, in kg·m².
    pub axial: f64,
    /// Moment of inertia about a diameter, in kg·m².
    pub transverse: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl RollingCoin {
    /// `ψ̇` at which the coin goes round at `φ̇ ≠ 0` with the constant lean `θ`: with `Ω = ψ̇ + φ̇ sin θ`,
    /// `(I_a + m r²) Ω φ̇ cos θ = I_t φ̇² sin θ cos θ − m g r sin θ`, the moments about the track through the centre.
    pub fn steady_spin(&self, lean: f64, turn: f64) -> f64 {
        let (s, c) = lean.sin_cos();
        let weight = self.m * self.g * self.radius * s;
        let rolling = self.axial + self.m * self.radius * self.radius;
        (self.transverse * turn * turn * s * c - weight) / (rolling * turn * c) - turn * s
    }

    /// `[ẋ, ẏ]` at which the point of contact rests.
    pub fn rolling_velocity(&self, &[_, _, phi, theta, _]: &[f64; 5], &[turn, lean, spin]: &[f64; 3]) -> [f64; 2] {
        let (along, aside) = (self.radius * (spin + turn * theta.sin()), self.radius * lean * theta.cos());
        [along * phi.cos() + aside * phi.sin(), along * phi.sin() - aside * phi.cos()]
    }
}

/// Coordinates `[x, y, φ, θ, ψ]`, x and y of the centre.
impl Dynamics<5> for RollingCoin {
    /// Of `T = ½ m (ẋ² + ẏ² + r² sin²θ θ̇²) + ½ I_t (θ̇² + φ̇² cos²θ) + ½ I_a (ψ̇ + φ̇ sin θ)²`.
    fn mass_matrix(&self, &[_, _, _, theta, _]: &[f64; 5]) -> [[f64; 5]; 5] {
        let (m, a, t, (s, c)) = (self.m, self.axial, self.transverse, theta.sin_cos());
        [
            [m, 0.0, 0.0, 0.0, 0.0],
            [0.0, m, 0.0, 0.0, 0.0],
            [0.0, 0.0, t * c * c + a * s * s, 0.0, a * s],
            [0.0, 0.0, 0.0, t + m * (self.radius * s).powi(2), 0.0],
            [0.0, 0.0, a * s, 0.0, a],
        ]
    }

    fn bias(&self, &[_, _, _, theta, _]: &[f64; 5], &[_, _, turn, lean, spin]: &[f64; 5]) -> [f64; 5] {
        let (m, r, a, t, (s, c)) = (self.m, self.radius, self.axial, self.transverse, theta.sin_cos());
        [
            0.0,
            0.0,
            2.0 * (a - t) * s * c * lean * turn + a * c * lean * spin,
            m * r * r * s * c * lean * lean - (a - t) * s * c * turn * turn - a * c * turn * spin - m * self.g * r * s,
            a * c * lean * turn,
        ]
    }

    /// `v + ω × (−r e₃) = 0`: `[ẋ, ẏ] + r θ̇ e₂ − r (ψ̇ + φ̇ sin θ) e₁`, the third component vanishes.
    fn constraints(
        &self,
        &[_, _, phi, theta, _]: &[f64; 5],
        &[_, _, turn, lean, spin]: &[f64; 5],
    ) -> Vec<([f64; 5], f64)> {
        let (r, (sp, cp), (s, c)) = (self.radius, phi.sin_cos(), theta.sin_cos());
        let squares = s * (turn * turn + lean * lean) + turn * spin;
        vec![
            ([1.0, 0.0, -r * s * cp, -r * sp * c, -r * cp], r * (sp * squares - 2.0 * c * cp * lean * turn)),
            ([0.0, 1.0, -r * s * sp, r * cp * c, -r * sp], -r * (cp * squares + 2.0 * c * sp * lean * turn)),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::dynamics::motion;
    use crate::reference::lagrange::{Dual, Number};
    use nalgebra::Vector3;

    const COIN: RollingCoin = RollingCoin { m: 0.7, radius: 0.4, axial: 0.09, transverse: 0.05, g: 9.81 };

    /// `e₁`, `e₂`, `e₃`.
    fn axes<S: Number>(phi: S, theta: S) -> [[S; 3]; 3] {
        let (sp, cp, s, c) = (phi.sin(), phi.cos(), theta.sin(), theta.cos());
        [[cp, sp, S::constant(0.0)], [-sp * c, cp * c, s], [sp * s, -cp * s, c]]
    }

    /// Newton: the contact force is `f = m (a + g e_z)`, its level part the multipliers. Euler: its moment about the
    /// centre is the rate of the angular momentum, differentiated as a dual number.
    #[test]
    fn agrees_with_newton_and_euler() {
        for state in states::<5>(21, 60) {
            let (q, qd) = (&state.q, &state.qd);
            let Some(motion) = motion(&COIN, q, qd).filter(|motion| motion.condition < 1e6) else { continue };
            let qdd = motion.accelerations;
            let path = |i: usize| Dual { value: q[i], derivative: qd[i] };
            let rate = |i: usize| Dual { value: qd[i], derivative: qdd[i] };
            let (theta, frame) = (path(3), axes(path(2), path(3)));
            let (turn, lean, spin) = (rate(2), rate(3), rate(4));
            let omega = [lean, spin + turn * theta.sin(), turn * theta.cos()];
            let moments = [COIN.transverse, COIN.axial, COIN.transverse];
            let momentum: [Dual<f64>; 3] = std::array::from_fn(|k| {
                (0..3).fold(Dual::constant(0.0), |sum, i| sum + omega[i] * frame[i][k] * moments[i])
            });
            // ż = −r sin θ θ̇.
            let zdd = (theta.sin() * lean * -COIN.radius).derivative;
            let force = Vector3::new(qdd[0], qdd[1], zdd + COIN.g) * COIN.m;
            let contact = Vector3::from(frame[2].map(|x| x.value)) * -COIN.radius;
            let moment = contact.cross(&force);
            assert_close("L̇", moment.as_slice(), &momentum.map(|l| l.derivative), 1e-10);
            assert_close("λ", &motion.multipliers, &[force.x, force.y], 1e-10);
        }
    }

    #[test]
    fn the_point_of_contact_rests() {
        for state in states::<5>(22, 40) {
            let [_, _, turn, lean, spin] = state.qd;
            let [xd, yd] = COIN.rolling_velocity(&state.q, &[turn, lean, spin]);
            let qd = [xd, yd, turn, lean, spin];
            for (row, _) in COIN.constraints(&state.q, &qd) {
                let slip: f64 = row.iter().zip(qd).map(|(a, rate)| a * rate).sum();
                assert!(slip.abs() < 1e-13, "{slip:e}");
            }
        }
    }

    #[test]
    fn steady_rolling_goes_on() {
        for (lean, turn) in [(0.4, 3.0), (-0.7, 5.0), (1.2, -2.0)] {
            let q = [0.3, -0.2, 0.8, lean, 1.1];
            let spin = COIN.steady_spin(lean, turn);
            let [xd, yd] = COIN.rolling_velocity(&q, &[turn, 0.0, spin]);
            let motion = motion(&COIN, &q, &[xd, yd, turn, 0.0, spin]).expect("regular");
            // The centre goes round: its acceleration is φ̇ e_z × v.
            assert_close("q̈", &motion.accelerations, &[-turn * yd, turn * xd, 0.0, 0.0, 0.0], 1e-12);
        }
    }
}
