//! A pendulum in Cartesian coordinates, the hinge at the origin, y upwards: `m q̈ = m g + λ [x, y]`, `x² + y² = l²`.
//!
//! # Source
//!
//! Goldstein, Poole, Safko, *Classical Mechanics*, 3rd edition 2002, section 2.4, on Lagrange's multipliers; the motion
//! as that of one angle. Whittaker, Watson, *A Course of Modern Analysis*, 4th edition 1927, 22.301 and Gauss: period
//! by the arithmetic–geometric mean.

use super::dynamics::Dynamics;

/// Parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianPendulum {
    /// Mass, in kg.
    pub m: f64,
    /// Length, in m.
    pub l: f64,
    /// Gravity, in m/s².
    pub g: f64,
}

impl CartesianPendulum {
    /// `T = 2π √(l/g) / agm(1, cos(α/2))` of the swing with the amplitude `α`.
    pub fn period(&self, amplitude: f64) -> f64 {
        std::f64::consts::TAU * (self.l / self.g).sqrt() / arithmetic_geometric_mean(1.0, (0.5 * amplitude).cos())
    }

    /// `θ̈` and the tension of the rod at the angle `θ` from straight down: `−g/l sin θ` and `m (g cos θ + l θ̇²)`.
    pub fn swing(&self, theta: f64, rate: f64) -> [f64; 2] {
        [-self.g / self.l * theta.sin(), self.m * (self.g * theta.cos() + self.l * rate * rate)]
    }
}

/// The arithmetic–geometric mean of two positive numbers.
pub fn arithmetic_geometric_mean(mut a: f64, mut b: f64) -> f64 {
    // It converges quadratically: six turns are enough for any two numbers within a factor of a thousand.
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Coordinates `[x, y]`.
impl Dynamics<2> for CartesianPendulum {
    fn mass_matrix(&self, _: &[f64; 2]) -> [[f64; 2]; 2] {
        [[self.m, 0.0], [0.0, self.m]]
    }

    fn bias(&self, _: &[f64; 2], _: &[f64; 2]) -> [f64; 2] {
        [0.0, self.m * self.g]
    }

    /// `(x² + y² − l²)/2 = 0`.
    fn constraints(&self, q: &[f64; 2], &[xd, yd]: &[f64; 2]) -> Vec<([f64; 2], f64)> {
        vec![(*q, xd * xd + yd * yd)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::random::states;
    use crate::reference::dynamics::motion;

    const PENDULUM: CartesianPendulum = CartesianPendulum { m: 1.3, l: 0.7, g: 9.81 };

    /// The angle's acceleration and the tension.
    #[test]
    fn agrees_with_the_angle() {
        for state in states::<1>(41, 40) {
            let ([theta], [rate]) = (state.q, state.qd);
            let ((s, c), l) = (theta.sin_cos(), PENDULUM.l);
            let (q, qd) = ([l * s, -l * c], [l * c * rate, l * s * rate]);
            let motion = motion(&PENDULUM, &q, &qd).expect("regular");
            let [turn, tension] = PENDULUM.swing(theta, rate);
            let want = [l * (c * turn - s * rate * rate), l * (s * turn + c * rate * rate)];
            assert_close("q̈", &motion.accelerations, &want, 1e-12);
            assert_close("λ", &motion.multipliers, &[-tension / l], 1e-12);
        }
    }

    /// `orbit.constraint_pendulum` of the reference data.
    #[test]
    fn period_from_60_degrees() {
        let pendulum = CartesianPendulum { m: 1.0, l: 1.0, g: 9.80665 };
        let period = pendulum.period(60f64.to_radians());
        assert!((period - 2.153_242_351_783_842_6).abs() < 1e-15, "{period}");
    }
}
