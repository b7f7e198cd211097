//! Lagrange's top: symmetric, spinning about a fixed point on its axis, under gravity.
//!
//! Euler angles ZXZ, `R = Rz(φ) Rx(θ) Rz(ψ)`: `φ` precession, `θ` nutation (0 is upright), `ψ` spin. `M` is singular at
//! `θ = 0`, where `φ` and `ψ` turn about the same axis.
//!
//! # Source
//!
//! Goldstein, Poole, Safko, *Classical Mechanics*, 3rd edition 2002, section 5.7 for `T`, `V` and steady
//! precession, (4.87) for the angular velocity in body axes, (5.39) for Euler's equations.

use super::EquationsOfMotion;
use super::lagrange::{Dual, Number};

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavyTop {
    /// Moment of inertia across the axis, about the fixed point, in kg·m².
    pub i1: f64,
    /// Moment of inertia about the axis, in kg·m².
    pub i3: f64,
    /// Mass, in kg.
    pub m: f64,
    /// Distance from the fixed point to the mass centre, in m.
    pub l: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl HeavyTop {
    /// `ω` in body axes, Goldstein (4.87):
    /// `[φ̇ sin θ sin ψ + θ̇ cos ψ, φ̇ sin θ cos ψ − θ̇ sin ψ, φ̇ cos θ + ψ̇]`.
    pub fn angular_velocity_body<S: Number>(&self, &[_, theta, psi]: &[S; 3], qd: &[S; 3]) -> [S; 3] {
        let &[phid, thetad, psid] = qd;
        [
            phid * theta.sin() * psi.sin() + thetad * psi.cos(),
            phid * theta.sin() * psi.cos() - thetad * psi.sin(),
            phid * theta.cos() + psid,
        ]
    }

    /// The torque beside gravity's that Euler's equations ask for, in body axes, in N·m; zero in free motion.
    ///
    /// `N = I ω̇ + ω × I ω − l e₃ × Rᵀ(−m g e_z)`, Goldstein (5.39), with `ω̇` by dual numbers and
    /// `Rᵀ e_z = [sin θ sin ψ, sin θ cos ψ, cos θ]` (the last row of `R`).
    pub fn euler_torque_body(&self, q: &[f64; 3], qd: &[f64; 3], qdd: &[f64; 3]) -> [f64; 3] {
        let path = std::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] });
        let rates = std::array::from_fn(|i| Dual { value: qd[i], derivative: qdd[i] });
        let [w1, w2, w3] = self.angular_velocity_body(&path, &rates);
        let (sin_theta, sin_psi, cos_psi) = (q[1].sin(), q[2].sin(), q[2].cos());
        let mgl = self.m * self.g * self.l;
        [
            self.i1 * w1.derivative + (self.i3 - self.i1) * w2.value * w3.value - mgl * sin_theta * cos_psi,
            self.i1 * w2.derivative - (self.i3 - self.i1) * w3.value * w1.value + mgl * sin_theta * sin_psi,
            self.i3 * w3.derivative,
        ]
    }

    /// Generalized force of a torque in body axes: `Qᵢ = N · ∂ω/∂q̇ᵢ`, by virtual work.
    pub fn generalized_force(&self, q: &[f64; 3], torque_body: &[f64; 3]) -> [f64; 3] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rate| {
            let omega = self.angular_velocity_body(q, &rate);
            omega.iter().zip(torque_body).map(|(omega, torque)| omega * torque).sum()
        })
    }

    /// `ψ̇` at which the top precesses steadily at `φ̇ ≠ 0` and constant `θ`:
    /// `m g l = φ̇ (I₃ ω₃ − I₁ φ̇ cos θ)` with `ω₃ = ψ̇ + φ̇ cos θ`, Goldstein section 5.7.
    pub fn steady_spin(&self, theta: f64, phid: f64) -> f64 {
        let omega3 = (self.m * self.g * self.l / phid + self.i1 * phid * theta.cos()) / self.i3;
        omega3 - phid * theta.cos()
    }

    /// The slow and the fast precession at the spin `ω₃` about the axis, in this order; none where the top is too slow,
    /// `(I₃ ω₃)² < 4 I₁ m g l cos θ`, Goldstein section 5.7. The same condition as [`steady_spin`](Self::steady_spin),
    /// solved for `φ̇`; `θ` is not `π/2`.
    pub fn steady_precession(&self, theta: f64, omega3: f64) -> Option<[f64; 2]> {
        let (spin, mgl, across) = (self.i3 * omega3, self.m * self.g * self.l, self.i1 * theta.cos());
        let discriminant = spin * spin - 4.0 * across * mgl;
        // The larger root first, the smaller from their product: no cancellation for a fast top.
        let larger = (spin + spin.signum() * discriminant.sqrt()) / (2.0 * across);
        (discriminant >= 0.0).then(|| [mgl / (across * larger), larger])
    }
}

/// Coordinates `[φ, θ, ψ]`.
impl EquationsOfMotion<3> for HeavyTop {
    fn mass_matrix(&self, &[_, theta, _]: &[f64; 3]) -> [[f64; 3]; 3] {
        let Self { i1, i3, .. } = self;
        let (s, c) = theta.sin_cos();
        [[i1 * s * s + i3 * c * c, 0.0, i3 * c], [0.0, *i1, 0.0], [i3 * c, 0.0, *i3]]
    }

    /// With `k = ½ ∂M_φφ/∂θ = (I₁ − I₃) sin θ cos θ` and `s = −½ ∂M_φψ/∂θ = ½ I₃ sin θ`:
    /// `Γ_φφθ = Γ_φθφ = −Γ_θφφ = k`, `Γ_θφψ = Γ_θψφ = s`, `Γ_φθψ = Γ_φψθ = Γ_ψφθ = Γ_ψθφ = −s`; the others are zero.
    fn coriolis_matrix(&self, &[_, theta, _]: &[f64; 3], &[phid, thetad, psid]: &[f64; 3]) -> [[f64; 3]; 3] {
        let k = (self.i1 - self.i3) * theta.sin() * theta.cos();
        let s = 0.5 * self.i3 * theta.sin();
        [
            [k * thetad, k * phid - s * psid, -s * thetad],
            [-k * phid + s * psid, 0.0, s * phid],
            [-s * thetad, -s * phid, 0.0],
        ]
    }

    fn gravity(&self, &[_, theta, _]: &[f64; 3]) -> [f64; 3] {
        [0.0, -self.m * self.g * self.l * theta.sin(), 0.0]
    }

    /// `½ I₁ (θ̇² + φ̇² sin²θ) + ½ I₃ (ψ̇ + φ̇ cos θ)²`.
    fn kinetic_energy(&self, &[_, theta, _]: &[f64; 3], &[phid, thetad, psid]: &[f64; 3]) -> f64 {
        0.5 * self.i1 * (thetad * thetad + (phid * theta.sin()).powi(2))
            + 0.5 * self.i3 * (psid + phid * theta.cos()).powi(2)
    }

    /// Zero at the height of the fixed point.
    fn potential_energy(&self, &[_, theta, _]: &[f64; 3]) -> f64 {
        self.m * self.g * self.l * theta.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::lagrange::Energies;
    use crate::reference::tests::{ROUND_OFF, agrees_with_lagrange};

    const TOP: HeavyTop = HeavyTop { i1: 0.031, i3: 0.012, m: 0.8, l: 0.17, g: 9.81 };

    /// Energies from the rotation matrix alone: `T = ½ tr(Ṙ J Ṙᵀ)` with `J = ∫ r rᵀ dm` in body axes, `V = m g l R₃₃`.
    impl Energies<3> for HeavyTop {
        fn kinetic<S: Number>(&self, q: &[S; 3], qd: &[S; 3]) -> S {
            let path = std::array::from_fn(|i| Dual { value: q[i], derivative: qd[i] });
            // I₃ = 2 J₁ and I₁ = J₁ + J₃, the axis being the third.
            let second_moments = [0.5 * self.i3, 0.5 * self.i3, self.i1 - 0.5 * self.i3];
            rotation(&path).iter().fold(S::constant(0.0), |energy, row| {
                row.iter().zip(second_moments).fold(energy, |energy, (entry, moment)| {
                    energy + entry.derivative * entry.derivative * (0.5 * moment)
                })
            })
        }
        fn potential<S: Number>(&self, q: &[S; 3]) -> S {
            rotation(q)[2][2] * (self.m * self.g * self.l)
        }
    }

    /// `Rz(φ) Rx(θ) Rz(ψ)`, multiplied out factor by factor.
    fn rotation<S: Number>(&[phi, theta, psi]: &[S; 3]) -> [[S; 3]; 3] {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        let about_z =
            |angle: S| [[angle.cos(), -angle.sin(), zero], [angle.sin(), angle.cos(), zero], [zero, zero, one]];
        let about_x = [[one, zero, zero], [zero, theta.cos(), -theta.sin()], [zero, theta.sin(), theta.cos()]];
        multiply(&multiply(&about_z(phi), &about_x), &about_z(psi))
    }

    fn multiply<S: Number>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> [[S; 3]; 3] {
        a.map(|row| std::array::from_fn(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]))
    }

    #[test]
    fn agrees_with_lagrange_over_the_rotation_matrix() {
        agrees_with_lagrange(&TOP);
    }

    /// Vector mechanics and analytical mechanics say the same at every state and acceleration.
    #[test]
    fn agrees_with_eulers_equations() {
        for state in states::<3>(11, 60) {
            let torque = TOP.euler_torque_body(&state.q, &state.qd, &state.qdd);
            let want = TOP.generalized_force(&state.q, &torque);
            let got = TOP.inverse_dynamics(&state.q, &state.qd, &state.qdd);
            assert_close(&format!("Q at {state:?}"), &got, &want, ROUND_OFF);
        }
    }

    /// Without gravity the axis goes round the angular momentum `L` at `φ̇ = L/I₁`, at a constant `θ`, while the body
    /// turns about its axis at `ψ̇ = (I₁ − I₃)/I₃ · φ̇ cos θ`: Landau, Lifshitz 1976, (33.4) and (33.5).
    #[test]
    fn torque_free_precession_is_free() {
        let free = HeavyTop { g: 0.0, ..TOP };
        let (theta, momentum) = (0.9_f64, 0.4);
        let phid = momentum / free.i1;
        let psid = (free.i1 - free.i3) / free.i3 * phid * theta.cos();
        let (q, qd) = ([0.3, theta, -1.2], [phid, 0.0, psid]);
        // Terms of some 3 N·m cancel.
        assert_close("Lagrange", &free.inverse_dynamics(&q, &qd, &[0.0; 3]), &[0.0; 3], ROUND_OFF);
        assert_close("Euler", &free.euler_torque_body(&q, &qd, &[0.0; 3]), &[0.0; 3], ROUND_OFF);
        let [p_phi, p_theta, p_psi] = crate::reference::product(&free.mass_matrix(&q), &qd);
        assert_close("L", &[p_phi, p_theta, p_psi], &[momentum, 0.0, momentum * theta.cos()], ROUND_OFF);
    }

    #[test]
    fn steady_precession_is_free() {
        let (theta, omega3) = (0.6_f64, 60.0);
        let rates = TOP.steady_precession(theta, omega3).expect("(I₃ ω₃)² = 0.52 > 4 I₁ m g l cos θ = 0.14");
        assert!(rates[0] < rates[1]);
        for phid in rates {
            let psid = TOP.steady_spin(theta, phid);
            let (q, qd) = ([0.4, theta, 2.0], [phid, 0.0, psid]);
            assert_close("ω₃", &[psid + phid * theta.cos()], &[omega3], ROUND_OFF);
            // Terms of some 15 N·m cancel.
            assert_close("Lagrange", &TOP.inverse_dynamics(&q, &qd, &[0.0; 3]), &[0.0; 3], ROUND_OFF);
            assert_close("Euler", &TOP.euler_torque_body(&q, &qd, &[0.0; 3]), &[0.0; 3], ROUND_OFF);
        }
        assert_eq!(TOP.steady_precession(theta, 25.0), None, "0.09 < 0.14: the top falls");
    }
}
