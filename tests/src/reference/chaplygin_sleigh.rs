//! Chaplygin's sleigh: a plate whose blade does not slip sideways; the blade is at `[x, y]`, the mass centre `a` ahead.
//!
//! # Source
//!
//! Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972, and Bloch, *Nonholonomic Mechanics and Control*, 2nd
//! edition 2015, on the Chaplygin sleigh: with the speed `v` along the blade and `ω = φ̇`, `v̇ = a ω²`, `ω̇ = −m a v
//! ω/(I + m a²)`; push and torque are added.

use super::dynamics::Dynamics;

/// Parameters and inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaplyginSleigh {
    /// Mass, in kg.
    pub m: f64,
    /// Moment of inertia about the mass centre, in kg·m².
    pub moment: f64,
    /// From the blade to the mass centre, in m.
    pub a: f64,
    /// Force along the blade, in N, and torque, in N·m.
    pub inputs: [f64; 2],
}

impl ChaplyginSleigh {
    /// `[v̇, ω̇]` of the reduced equations.
    pub fn reduced(&self, v: f64, omega: f64) -> [f64; 2] {
        let [push, tau] = self.inputs;
        let turning = self.moment + self.m * self.a * self.a;
        [self.a * omega * omega + push / self.m, (tau - self.m * self.a * v * omega) / turning]
    }

    /// The force of the ice on the blade, to its left: `m (v ω + a ω̇)`, the mass centre's acceleration across.
    pub fn side_force(&self, v: f64, omega: f64) -> f64 {
        self.m * (v * omega + self.a * self.reduced(v, omega)[1])
    }
}

/// Coordinates `[x, y, φ]`.
impl Dynamics<3> for ChaplyginSleigh {
    fn mass_matrix(&self, &[_, _, phi]: &[f64; 3]) -> [[f64; 3]; 3] {
        let (m, lever, (s, c)) = (self.m, self.m * self.a, phi.sin_cos());
        [[m, 0.0, -lever * s], [0.0, m, lever * c], [-lever * s, lever * c, self.moment + lever * self.a]]
    }

    fn bias(&self, &[_, _, phi]: &[f64; 3], &[_, _, omega]: &[f64; 3]) -> [f64; 3] {
        let pull = self.m * self.a * omega * omega;
        [-pull * phi.cos(), -pull * phi.sin(), 0.0]
    }

    fn force(&self, &[_, _, phi]: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        let [push, tau] = self.inputs;
        [push * phi.cos(), push * phi.sin(), tau]
    }

    /// `−ẋ sin φ + ẏ cos φ = 0`.
    fn constraints(&self, &[_, _, phi]: &[f64; 3], &[xd, yd, omega]: &[f64; 3]) -> Vec<([f64; 3], f64)> {
        let (s, c) = phi.sin_cos();
        vec![([-s, c, 0.0], -(xd * c + yd * s) * omega)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::dynamics::motion;

    /// Multipliers and the reduced equations say the same.
    #[test]
    fn agrees_with_the_reduced_equations() {
        let sleigh = ChaplyginSleigh { m: 1.3, moment: 0.4, a: 0.6, inputs: [2.0, -0.7] };
        for state in states::<3>(13, 40) {
            let ([_, _, phi], [v, _, omega]) = (state.q, state.qd);
            let (s, c) = phi.sin_cos();
            let qd = [v * c, v * s, omega];
            let motion = motion(&sleigh, &state.q, &qd).expect("regular");
            let [along, turn] = sleigh.reduced(v, omega);
            // d/dt [v cos φ, v sin φ].
            let want = [along * c - v * s * omega, along * s + v * c * omega, turn];
            assert_close("q̈", &motion.accelerations, &want, 1e-11);
            assert_close("λ", &motion.multipliers, &[sleigh.side_force(v, omega)], 1e-11);
        }
    }
}
