//! A knife edge on an incline: x down the slope, y across it, the heading `φ` from x towards y.
//!
//! # Source
//!
//! Neimark, Fufaev, *Dynamics of Nonholonomic Systems*, 1972, on the skate on an inclined plane: with the speed `v`
//! along the blade, `v̇ = g sin α cos φ`, `φ̈ = 0`; from rest at the origin with `φ = ω t` it draws a cycloid, `x = a
//! sin²ωt`, `y = a (ωt − ½ sin 2ωt)`, `a = g sin α/(2ω²)`: it does not get lower than `a`.

use super::dynamics::Dynamics;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnifeEdge {
    /// Mass, in kg.
    pub m: f64,
    /// Moment of inertia, in kg·m².
    pub moment: f64,
    /// Angle of the slope, in rad.
    pub slope: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl KnifeEdge {
    /// `g sin α`
    fn pull(&self) -> f64 {
        self.g * self.slope.sin()
    }

    /// Where it is at `t`, from rest at the origin and turning with `ω`.
    pub fn cycloid(&self, omega: f64, t: f64) -> [f64; 2] {
        let (a, angle) = (0.5 * self.pull() / (omega * omega), omega * t);
        [a * angle.sin().powi(2), a * (angle - 0.5 * (2.0 * angle).sin())]
    }

    /// The force of the slope on the blade, to its right, at the speed `v` along it: `−m (v ω + g sin α sin φ)`.
    pub fn side_force(&self, phi: f64, v: f64, omega: f64) -> f64 {
        -self.m * (v * omega + self.pull() * phi.sin())
    }
}

/// Coordinates `[x, y, φ]`.
impl Dynamics<3> for KnifeEdge {
    fn mass_matrix(&self, _: &[f64; 3]) -> [[f64; 3]; 3] {
        [[self.m, 0.0, 0.0], [0.0, self.m, 0.0], [0.0, 0.0, self.moment]]
    }

    fn bias(&self, _: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        [-self.m * self.pull(), 0.0, 0.0]
    }

    /// `ẋ sin φ − ẏ cos φ = 0`.
    fn constraints(&self, &[_, _, phi]: &[f64; 3], &[xd, yd, omega]: &[f64; 3]) -> Vec<([f64; 3], f64)> {
        let (s, c) = phi.sin_cos();
        vec![([s, -c, 0.0], omega * (xd * c + yd * s))]
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
        let edge = KnifeEdge { m: 1.7, moment: 0.3, slope: 0.4, g: 9.81 };
        for state in states::<3>(42, 40) {
            let ([_, _, phi], [v, _, omega]) = (state.q, state.qd);
            let (s, c) = phi.sin_cos();
            let motion = motion(&edge, &state.q, &[v * c, v * s, omega]).expect("regular");
            let along = edge.pull() * c;
            assert_close(
                "q̈",
                &motion.accelerations,
                &[along * c - v * omega * s, along * s + v * omega * c, 0.0],
                1e-12,
            );
            assert_close("λ", &motion.multipliers, &[edge.side_force(phi, v, omega)], 1e-12);
        }
    }

    /// `orbit.constraint_knife_edge` of the reference data.
    #[test]
    fn the_cycloid_is_that_of_the_reference_data() {
        let edge = KnifeEdge { m: 1.0, moment: 1.0, slope: 20f64.to_radians(), g: 9.80665 };
        for (t, place) in [
            (1.0, [1.420_402_975_033_200_8, 0.709_403_768_523_874_7]),
            (2.0, [3.323_649_620_933_192_5, 4.218_278_993_490_296]),
            (5.0, [0.421_137_509_304_311_54, 10.854_552_357_524_872]),
        ] {
            assert_close("place", &edge.cycloid(0.7, t), &place, 1e-14);
        }
    }
}
