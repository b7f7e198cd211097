//! The thesis' equations of motion in cylindrical coordinates about a moving origin, (7.7) to (7.11), and the orbit
//! (7.13): typed, as printed and as corrected.
//!
//! # Source
//!
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 7; `docs/thesis/chapter_7.md`.

use crate::random::Random;

/// A station anywhere, and a body near it, in units in which all numbers are about one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylindrical {
    /// G times the mass of the centre.
    pub mu: f64,
    /// G times the mass of the station.
    pub station_mu: f64,
    /// r_t, ν with their derivatives.
    pub frame: [[f64; 3]; 2],
    /// r, θ, z
    pub q: [f64; 3],
    /// Their rates.
    pub qd: [f64; 3],
    /// Their accelerations.
    pub qdd: [f64; 3],
}

impl Cylindrical {
    /// One drawn at random.
    pub fn random(random: &mut Random) -> Self {
        let r_t = [random.uniform(1.0..3.0), random.uniform(-1.0..1.0), random.uniform(-1.0..1.0)];
        Self {
            mu: random.uniform(0.5..2.0),
            station_mu: random.uniform(0.1..1.0),
            frame: [r_t, random.array(-2.0..2.0)],
            q: [random.uniform(0.2..2.0), random.uniform(-3.0..3.0), random.uniform(-1.0..1.0)],
            qd: random.array(-2.0..2.0),
            qdd: random.array(-2.0..2.0),
        }
    }

    /// Φ, ∂Φ/∂θ, and their total time derivatives.
    pub fn phi(&self) -> [f64; 4] {
        let ([[r, rd, rdd], [_, nd, ndd]], theta, td) = (self.frame, self.q[1], self.qd[1]);
        let (sin, cos) = theta.sin_cos();
        [
            rd * cos + r * nd * sin,
            -rd * sin + r * nd * cos,
            rdd * cos - rd * sin * td + (rd * nd + r * ndd) * sin + r * nd * cos * td,
            -rdd * sin - rd * cos * td + (rd * nd + r * ndd) * cos - r * nd * sin * td,
        ]
    }

    /// The left sides of (7.8), (7.9) corrected, (7.10).
    pub fn left_sides(&self) -> [f64; 3] {
        let ([r, _, _], [rd, td, _], [rdd, tdd, zdd], [_, [_, nd, ndd]]) = (self.q, self.qd, self.qdd, self.frame);
        let [phi, slope, phi_rate, slope_rate] = self.phi();
        let turn = td + nd;
        let rate_of_square = 2.0 * r * rd * turn + r * r * (tdd + ndd);
        let rate_of_bracket = rate_of_square + rd * slope + r * slope_rate;
        [rdd - r * turn * turn + phi_rate - turn * slope, rate_of_bracket - rd * slope + r * turn * phi, zdd]
    }

    /// What (7.9) as printed has more: its factors of 2.
    pub fn surplus_of_7_9(&self) -> f64 {
        let [phi, slope, ..] = self.phi();
        -self.qd[0] * slope + self.q[0] * (self.qd[1] + self.frame[1][1]) * phi
    }

    /// The right sides of (7.11), corrected: forces per mass.
    pub fn right_sides(&self) -> [f64; 3] {
        let ([r, theta, z], r_t) = (self.q, self.frame[0][0]);
        let (sin, cos) = theta.sin_cos();
        let d = (r_t * r_t + r * r + 2.0 * r_t * r * cos + z * z).powf(1.5);
        let own = self.station_mu / (r * r + z * z).powf(1.5);
        [-self.mu * (r + r_t * cos) / d - own * r, self.mu * r_t * r * sin / d, -self.mu * z / d - own * z]
    }

    /// Left less right sides of (7.11) as printed, row by row.
    pub fn printed_7_11(&self) -> [f64; 3] {
        let ([r, theta, z], [rd, td, _], [rdd, tdd, zdd], [[r_t, ..], [_, nd, ndd]]) =
            (self.q, self.qd, self.qdd, self.frame);
        let [phi, slope, phi_rate, slope_rate] = self.phi();
        let (turn, (sin, cos)) = (nd + td, theta.sin_cos());
        let d = (r_t * r_t + r * r + 2.0 * r_t * r * cos + z * z).powf(1.5);
        let rate_of_square = 2.0 * r * rd * turn + r * r * (ndd + tdd);
        [
            rdd + phi_rate - r * turn * turn - turn * slope + self.mu * (r + r_t * cos) / d + self.station_mu / (r * r),
            rate_of_square + r * slope_rate - rd * slope + r * turn * phi - self.mu * r_t * r * sin / d,
            zdd + self.mu * z / d,
        ]
    }

    /// (7.7), halved: the kinetic energy per mass.
    pub fn kinetic_energy_7_7(&self) -> f64 {
        let ([r, _, _], [rd, td, zd], [[r_t, r_td, _], [_, nd, _]]) = (self.q, self.qd, self.frame);
        let [phi, slope, ..] = self.phi();
        let turn = td + nd;
        let transport = r_td * r_td + r_t * r_t * nd * nd;
        0.5 * (transport + rd * rd + r * r * turn * turn + zd * zd + 2.0 * rd * phi + 2.0 * r * turn * slope)
    }
}

/// (7.13) along a motion about a station: both sides, the factor of u'' to this power. u = 1/r, ' = d/dθ.
///
/// | argument           | meaning                                                       |
/// |--------------------|---------------------------------------------------------------|
/// | `r`, `rd`, `rdd`   | distance from the station, its rate and acceleration          |
/// | `td`, `tdd`        | rate and acceleration of the angle                            |
/// | `omega`            | rate of the station on its circle                             |
/// | `station_mu`       | G times its mass                                              |
/// | `exponent`         | of `C_r − r²`: 1 as printed, 2 as corrected                   |
pub fn equation_7_13(
    [r, rd, rdd]: [f64; 3],
    [td, tdd]: [f64; 2],
    omega: f64,
    station_mu: f64,
    exponent: i32,
) -> [f64; 2] {
    let slope = -rd / (r * r * td);
    let curvature = (-rdd / (r * r * td) + 2.0 * rd * rd / (r * r * r * td) + rd * tdd / (r * r * td * td)) / td;
    let c = r * r * (1.0 + td / omega);
    let areas = c - r * r;
    [
        areas.powi(exponent) / (r * r) * curvature + 2.0 * r * areas * slope * slope + c * c / (r * r * r),
        r + station_mu / (omega * omega * r * r),
    ]
}
