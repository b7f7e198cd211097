//! A particle on a turntable whose centre oscillates: spring to the centre, friction against the table.
//!
//! # Source
//!
//! Relative motion, `m (r'' + ω̇ × r + 2 ω × r' + ω × (ω × r) + Rᵀ c̈) = F` (Goldstein, Poole, Safko, *Classical
//! Mechanics*, 3rd edition 2002, section 4.10, with the acceleration of the origin added), written out in the plane.

use super::dynamics::Dynamics;

/// Parameters, and the motion of the table at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turntable {
    /// Mass, in kg.
    pub m: f64,
    /// Stiffness, in N/m.
    pub k: f64,
    /// Viscous friction, in N·s/m.
    pub c: f64,
    /// Angle of the table, its rate and acceleration, in rad, rad/s, rad/s².
    pub turn: [f64; 3],
    /// Acceleration of the centre along the room's x axis, in m/s².
    pub centre: f64,
}

/// Coordinates `[x, y]` on the table.
impl Dynamics<2> for Turntable {
    fn mass_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
        [[self.m, 0.0], [0.0, self.m]]
    }

    fn bias(&self, &[x, y]: &[f64; 2], &[xd, yd]: &[f64; 2]) -> [f64; 2] {
        let [turn, omega, omega_dot] = self.turn;
        let ax = -omega_dot * y - 2.0 * omega * yd - omega * omega * x + self.centre * turn.cos();
        let ay = omega_dot * x + 2.0 * omega * xd - omega * omega * y - self.centre * turn.sin();
        [self.m * ax + self.k * x, self.m * ay + self.k * y]
    }

    fn force(&self, _: &[f64; 2], qd: &[f64; 2]) -> [f64; 2] {
        qd.map(|rate| -self.c * rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::tests::ROUND_OFF;

    /// A particle at rest in the room while the table turns under it at a constant rate: no force but the spring's.
    #[test]
    fn what_rests_in_the_room_needs_no_force() {
        let table = Turntable { m: 0.7, k: 0.0, c: 0.0, turn: [0.4, 1.9, 0.8], centre: 0.0 };
        let [_, omega, omega_dot] = table.turn;
        for state in states::<2>(6, 30) {
            let [x, y] = state.q;
            // r = Rᵀ p at constant p: r' = −ω × r, r'' = −ω̇ × r + ω × (ω × r).
            let qd = [omega * y, -omega * x];
            let qdd = [omega_dot * y - omega * omega * x, -omega_dot * x - omega * omega * y];
            let h = table.bias(&state.q, &qd);
            assert_close("force", &[h[0] + table.m * qdd[0], h[1] + table.m * qdd[1]], &[0.0, 0.0], ROUND_OFF);
        }
    }
}
