//! A bead on a hoop that is turned about a vertical axis: the hoop leans from the vertical, its centre is off the axis.
//!
//! # Source
//!
//! Newton's second law in the axes of the turning hoop, `r̈ = r'' + ω̇ × r + 2 ω × r' + ω × (ω × r)` (Goldstein, Poole,
//! Safko, *Classical Mechanics*, 3rd edition 2002, section 4.10), along the wire. Without lean and offset it is the
//! bead on a spinning hoop of Taylor, *Classical Mechanics*, 2005, chapter 7.

use nalgebra::Vector3;

use super::dynamics::Dynamics;

/// Parameters, and rate and acceleration of the hoop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeadOnHoop {
    /// Mass, in kg.
    pub m: f64,
    /// Radius of the hoop, in m.
    pub radius: f64,
    /// From the axis to the centre, in m.
    pub offset: f64,
    /// From the vertical, in rad.
    pub lean: f64,
    /// Gravity, in m/s².
    pub g: f64,
    /// Viscous friction, in N·s/m.
    pub b: f64,
    /// Rate and acceleration of the hoop about the axis, in rad/s and rad/s².
    pub omega: [f64; 2],
}

/// Coordinate `θ` from the lowest point.
impl Dynamics<1> for BeadOnHoop {
    fn mass_matrix(&self, _: &[f64; 1]) -> [[f64; 1]; 1] {
        [[self.m * self.radius * self.radius]]
    }

    /// `m ∂r/∂θ · (r̈|_{θ̈ = 0} + g e_z)`, in axes that turn with the hoop.
    fn bias(&self, &[theta]: &[f64; 1], &[thetad]: &[f64; 1]) -> [f64; 1] {
        // In the hoop's plane: x level, and up the slope of the plane.
        let (sin_lean, cos_lean) = self.lean.sin_cos();
        let (level, up) = (Vector3::x(), Vector3::new(0.0, -sin_lean, cos_lean));
        let r = level * (self.offset + self.radius * theta.sin()) - up * (self.radius * theta.cos());
        let tangent = (level * theta.cos() + up * theta.sin()) * self.radius;
        let curvature = (-level * theta.sin() + up * theta.cos()) * self.radius;
        let [omega, omega_dot] = self.omega.map(|rate| Vector3::z() * rate);
        let relative = curvature * thetad * thetad;
        let coriolis = omega.cross(&tangent) * (2.0 * thetad);
        let transport = omega_dot.cross(&r) + omega.cross(&omega.cross(&r));
        [self.m * tangent.dot(&(relative + coriolis + transport + Vector3::z() * self.g))]
    }

    fn force(&self, _: &[f64; 1], &[thetad]: &[f64; 1]) -> [f64; 1] {
        [-self.b * self.radius * self.radius * thetad]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::tests::ROUND_OFF;

    const HOOP: BeadOnHoop =
        BeadOnHoop { m: 0.3, radius: 0.7, offset: 0.0, lean: 0.0, g: 9.81, b: 0.1, omega: [4.0, -3.0] };

    /// `R θ̈ = (ω² R cos θ − g) sin θ`, whatever ω̇: the textbook's hoop about its vertical diameter.
    #[test]
    fn hoop_about_its_diameter() {
        for state in states::<1>(3, 30) {
            let ([theta], [omega, _]) = (state.q, HOOP.omega);
            let driving = (omega * omega * HOOP.radius * theta.cos() - HOOP.g) * theta.sin();
            let want = -HOOP.m * HOOP.radius * driving;
            assert_close("h", &HOOP.bias(&state.q, &state.qd), &[want], ROUND_OFF);
        }
    }

    /// A level hoop about a point of its rim: `R β̈ + ω² R sin β + ω̇ R (1 + cos β) = 0` with β from the far end, in
    /// the sense of ω: a pendulum in the field of the centrifugal force.
    #[test]
    fn level_hoop_about_its_rim() {
        let hoop = BeadOnHoop { lean: std::f64::consts::FRAC_PI_2, offset: HOOP.radius, g: 0.0, ..HOOP };
        for state in states::<1>(4, 30) {
            let ([theta], [omega, omega_dot]) = (state.q, hoop.omega);
            // θ grows against the sense of ω: β = π/2 − θ, and the force on β is minus that on θ.
            let far = std::f64::consts::FRAC_PI_2 - theta;
            let want = -hoop.m * hoop.radius.powi(2) * (omega * omega * far.sin() + omega_dot * (1.0 + far.cos()));
            assert_close("h", &hoop.bias(&state.q, &state.qd), &[want], ROUND_OFF);
        }
    }
}
