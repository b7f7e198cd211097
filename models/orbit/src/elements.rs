//! Classical orbital elements, from states and back.
//!
//! The size is given by p, which every conic has. Angles that a position does not fix are chosen so that a state comes
//! back from its elements:
//!
//! | orbit                              | chosen                                                                 |
//! |------------------------------------|------------------------------------------------------------------------|
//! | in the plane z = 0                 | Ω = 0: ω counts from the x axis, in the direction of the motion         |
//! | a circle                           | ω = 0: ν counts from the ascending node                                 |
//! | a circle in the plane z = 0        | Ω = ω = 0: ν counts from the x axis, in the direction of the motion     |
//!
//! A state comes back to a few roundings times `r/p`. Far out on an orbit that is nearly a straight line that is too
//! much for six numbers of this kind, and there are none: [`Failure::NearlyStraight`]. [`kepler`](super::kepler)
//! carries such states all the same.
//!
//! An inclination or eccentricity counts as zero up to [`NONE`], where it is rounding alone.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, section 3.4.

use core::f64::consts::PI;

use mbs_models::check::{self, Invalid, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::anomaly::asymptote;
use super::integrals::{angular_momentum, reciprocal_axis};
use super::vector::{StateVector, Vector, combined, cross, dot, norm, scaled};

/// Below, an eccentricity or the sine of an inclination is none.
pub const NONE: f64 = 16.0 * f64::EPSILON;

/// Elements that give the state back with a greater error than this part of it are refused.
const LARGEST_LOSS: f64 = 1e-9;

/// A conic and a place on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elements {
    /// `p = a (1 − e²) = h²/μ`, positive \[m\].
    pub semi_latus_rectum: f64,
    /// e
    pub eccentricity: f64,
    /// i, from 0 to π \[rad\].
    pub inclination: f64,
    /// Ω, from 0 to 2π \[rad\].
    pub ascending_node: f64,
    /// ω, from the ascending node to the nearest point, from 0 to 2π \[rad\].
    pub argument_of_periapsis: f64,
    /// ν, from −π to π \[rad\].
    pub true_anomaly: f64,
}

/// From 0 to 2π.
fn positive_angle(angle: f64) -> f64 {
    // A tiny negative angle is rounded to 2π.
    let turned = if angle < 0.0 { angle + 2.0 * PI } else { angle };
    if turned >= 2.0 * PI { 0.0 } else { turned }
}

impl Elements {
    /// The elements of a state \[m, m/s\] about a centre with μ \[m³/s²\].
    ///
    /// ```text
    /// e cos ν = p/r − 1,   e sin ν = √(p/μ) ṙ
    /// ```
    ///
    /// # Errors
    /// [`Error`].
    pub fn from_state(mu: f64, state: &StateVector) -> Result<Self, Error> {
        check::positive("mu", mu)?;
        state.check()?;
        let momentum = angular_momentum(state);
        let (r, v, h) = (norm(&state.position), norm(&state.velocity), norm(&momentum));
        if h <= 4.0 * f64::EPSILON * r * v {
            return Err(Failure::Undetermined("the orbital plane of a motion along a straight line").into());
        }
        let p = h * h / mu;
        let radial = dot(&state.position, &state.velocity) / r;
        let (e_cos, e_sin) = (p / r - 1.0, Scalar::sqrt(p / mu) * radial);
        // Near the parabola the sum of squares does not know how near it is.
        let alpha_p = reciprocal_axis(mu, state).high * p;
        let square = if alpha_p.abs() < 0.5 { 1.0 - alpha_p } else { e_cos * e_cos + e_sin * e_sin };
        let eccentricity = Scalar::sqrt(square);
        let circular = eccentricity <= NONE;
        let horizontal = Scalar::sqrt(momentum[0] * momentum[0] + momentum[1] * momentum[1]);
        let equatorial = horizontal <= NONE * h;
        let node =
            if equatorial { [1.0, 0.0, 0.0] } else { [-momentum[1] / horizontal, momentum[0] / horizontal, 0.0] };
        let beside = scaled(1.0 / h, &cross(&momentum, &node));
        // From the node, in the direction of the motion.
        let argument_of_latitude = Scalar::atan2(dot(&state.position, &beside), dot(&state.position, &node));
        let true_anomaly = if circular { argument_of_latitude } else { Scalar::atan2(e_sin, e_cos) };
        let argument_of_periapsis = if circular { 0.0 } else { positive_angle(argument_of_latitude - true_anomaly) };
        let elements = Self {
            semi_latus_rectum: p,
            eccentricity,
            inclination: Scalar::atan2(horizontal, momentum[2]),
            ascending_node: if equatorial { 0.0 } else { positive_angle(Scalar::atan2(momentum[0], -momentum[1])) },
            argument_of_periapsis,
            true_anomaly,
        };
        elements.check()?;
        if elements.loss(r) <= LARGEST_LOSS {
            Ok(elements)
        } else {
            Err(Failure::NearlyStraight { semi_latus_rectum: p, distance: r }.into())
        }
    }

    /// By what part rounding of e and ν, half a unit in the last place each, moves the place at the distance r: `r =
    /// p/(1 + e cos ν)`.
    fn loss(&self, r: f64) -> f64 {
        let (sin, cos) = Scalar::sin_cos(self.true_anomaly);
        let rounding = cos.abs() + (self.true_anomaly * sin).abs();
        0.5 * f64::EPSILON * self.eccentricity * rounding * (r / self.semi_latus_rectum)
    }

    /// The state \[m, m/s\] about a centre with μ \[m³/s²\].
    ///
    /// # Errors
    /// [`Error`].
    pub fn to_state(&self, mu: f64) -> Result<StateVector, Error> {
        check::positive("mu", mu)?;
        self.check()?;
        let Self { semi_latus_rectum: p, eccentricity: e, .. } = *self;
        let (sin, cos) = Scalar::sin_cos(self.true_anomaly);
        // 1 + e cos ν and e + cos ν, which cancel far out.
        let half_cos = Scalar::cos(0.5 * self.true_anomaly);
        let versine = 2.0 * half_cos * half_cos;
        let (ratio, along) = ((1.0 - e) + e * versine, versine - (1.0 - e));
        // Also where rounding of the anomaly puts a state far out on its asymptote.
        if ratio <= 0.0 {
            return Err(Must::BeLessThan(asymptote(e)).broken_by("|true_anomaly|", self.true_anomaly.abs()).into());
        }
        let [toward, ahead] = self.axes();
        let (r, speed) = (p / ratio, Scalar::sqrt(mu / p));
        let state = StateVector {
            position: combined(r * cos, &toward, r * sin, &ahead),
            velocity: combined(-speed * sin, &toward, speed * along, &ahead),
        };
        if state.is_finite() && r > 0.0 { Ok(state) } else { Err(Failure::OutOfRange.into()) }
    }

    /// Unit vectors to the nearest point, and a quarter of a turn on.
    #[must_use]
    pub fn axes(&self) -> [Vector; 2] {
        let (sin_node, cos_node) = Scalar::sin_cos(self.ascending_node);
        let (sin_i, cos_i) = Scalar::sin_cos(self.inclination);
        let (sin, cos) = Scalar::sin_cos(self.argument_of_periapsis);
        let node = [cos_node, sin_node, 0.0];
        let beside = [-cos_i * sin_node, cos_i * cos_node, sin_i];
        [combined(cos, &node, sin, &beside), combined(-sin, &node, cos, &beside)]
    }

    /// `a = p/(1 − e²)` \[m\]: negative for hyperbolas, infinite for parabolas.
    #[must_use]
    pub fn semi_major_axis(&self) -> f64 {
        self.semi_latus_rectum / ((1.0 - self.eccentricity) * (1.0 + self.eccentricity))
    }

    /// Distance of the nearest point, `p/(1 + e)` \[m\].
    #[must_use]
    pub fn periapsis(&self) -> f64 {
        self.semi_latus_rectum / (1.0 + self.eccentricity)
    }

    /// Distance of the farthest point \[m\]: infinite for parabolas and hyperbolas.
    #[must_use]
    pub fn apoapsis(&self) -> f64 {
        if self.eccentricity < 1.0 { self.semi_latus_rectum / (1.0 - self.eccentricity) } else { f64::INFINITY }
    }

    /// Rate of the mean anomaly of [`anomaly`](super::anomaly) \[rad/s\].
    #[must_use]
    pub fn mean_motion(&self, mu: f64) -> f64 {
        let p = self.semi_latus_rectum;
        let rate = Scalar::sqrt(mu / p) / p;
        if self.eccentricity == 1.0 {
            return 2.0 * rate;
        }
        let difference = ((1.0 - self.eccentricity) * (1.0 + self.eccentricity)).abs();
        rate * difference * Scalar::sqrt(difference)
    }

    /// Time of one revolution \[s\]: infinite for parabolas and hyperbolas.
    #[must_use]
    pub fn period(&self, mu: f64) -> f64 {
        if self.eccentricity < 1.0 { 2.0 * PI / self.mean_motion(mu) } else { f64::INFINITY }
    }

    fn check(&self) -> Result<(), Invalid> {
        check::positive("semi_latus_rectum", self.semi_latus_rectum)?;
        check::not_negative("eccentricity", self.eccentricity)?;
        check::finite("inclination", self.inclination)?;
        check::finite("ascending_node", self.ascending_node)?;
        check::finite("argument_of_periapsis", self.argument_of_periapsis)?;
        check::finite("true_anomaly", self.true_anomaly)
    }
}
