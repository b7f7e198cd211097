//! Motion about one centre: `r̈ = −μ r/|r|³`, for every conic and every time.
//!
//! ```text
//! α = 2/r − v²/μ,   h = r × v,   p = h²/μ,   e² = 1 − α p,   q = p/(1 + e)
//! ```
//!
//! The state gives the conic and the place on it, counted from its nearest point (`universal.rs`); the time goes on,
//! whole revolutions are taken off, and Kepler's equation gives the new place. Circles, parabolas and straight lines
//! are no special cases but one: a straight line ends where it falls into the centre.
//!
//! # Accuracy
//! The result is that of a state which differs from the given one by some roundings: what is lost besides is what one
//! unit in the last place of the given state causes. On the way back from a result, errors are of the size that its own
//! rounding causes; the tests measure both.
//!
//! This module carries states; [`mbs_models::kepler`] is the generated mechanism of the same motion, to
//! be integrated, with thrust if need be.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, chapter 4; counting from an apsis
//! is ours.

use core::f64::consts::PI;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::integrals::{Double, angular_momentum, reciprocal_axis, with_integrals};
use super::universal::Shape;
use super::vector::{StateVector, Vector, combined, cross, dot, norm, scaled};

/// A state that was propagated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propagation {
    /// The state then.
    pub state: StateVector,
    /// How often Kepler's equation was evaluated to solve it.
    pub iterations: u32,
}

/// The state after a time, which may be negative.
///
/// ```
/// use mbs_orbit::{EARTH_MU, kepler, vector::StateVector};
///
/// // 400 km above the equator, on a circle: a quarter of a revolution.
/// let (r, v) = (6_778_137.0, (EARTH_MU / 6_778_137.0_f64).sqrt());
/// let state = StateVector::new([r, 0.0, 0.0], [0.0, v, 0.0]);
/// let quarter = 0.5 * std::f64::consts::PI * r / v;
/// let found = kepler::propagate(EARTH_MU, &state, quarter).unwrap().state;
/// assert!((found.position[1] - r).abs() < 1e-8 && (found.velocity[0] + v).abs() < 1e-11);
/// ```
///
/// | argument | meaning                        | unit                   |
/// |----------|--------------------------------|------------------------|
/// | `mu`     | G times the mass of the centre | m³/s²                  |
/// | `state`  | relative to the centre         | m, m/s                 |
/// | `time`   | how far to go                  | s                      |
///
/// Any consistent units do.
///
/// # Errors
/// [`Error`].
pub fn propagate(mu: f64, state: &StateVector, time: f64) -> Result<Propagation, Error> {
    let conic = Conic::through(mu, state)?;
    check::finite("time", time)?;
    if time == 0.0 {
        return Ok(Propagation { state: *state, iterations: 0 });
    }
    let arrival = conic.after(time)?;
    Ok(Propagation { state: arrival.state, iterations: arrival.iterations })
}

/// A conic, and the place on it where a state is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conic {
    mu: f64,
    sqrt_mu: f64,
    energy: Double,
    momentum: Vector,
    pub(super) shape: Shape,
    sqrt_p: f64,
    /// Where the state is, and `√μ` times the time since the apsis.
    s: f64,
    time: f64,
    /// Towards the apsis that the shape is seen from, and a quarter of a revolution on.
    axes: [Vector; 2],
}

/// A place on a conic that a time leads to.
pub(super) struct Arrival {
    pub(super) state: StateVector,
    pub(super) iterations: u32,
    /// From an apsis, `half_revolutions` after that of the state before.
    pub(super) s: f64,
    pub(super) half_revolutions: f64,
}

/// After more half revolutions rounding leaves nothing of the anomaly.
const MOST_REVOLUTIONS: f64 = 1e15;

/// An angular momentum below this fraction of `r v` is zero to rounding.
const STRAIGHT: f64 = 4.0 * f64::EPSILON;

impl Conic {
    /// The conic of a state.
    pub(super) fn through(mu: f64, state: &StateVector) -> Result<Self, Error> {
        check::positive("μ", mu)?;
        state.check()?;
        let (position, velocity) = (&state.position, &state.velocity);
        if *position == [0.0; 3] {
            return Err(Must::BePositive.broken_by("distance from the centre", 0.0).into());
        }
        let sqrt_mu = Scalar::sqrt(mu);
        let (r, square) = (norm(position), dot(velocity, velocity));
        let energy = reciprocal_axis(mu, state);
        let alpha = energy.high;
        let sigma = dot(position, velocity) / sqrt_mu;
        let mut momentum = angular_momentum(state);
        let mut h = norm(&momentum);
        if h * h <= STRAIGHT * STRAIGHT * (r * r * square) {
            (momentum, h) = ([0.0; 3], 0.0);
        }
        let p = h * h / mu;
        let along = 1.0 - alpha * r;
        // Near the circle 1 − α p cancels, near the parabola the sum of squares does not know how near it is.
        let e = Scalar::sqrt(if alpha * p < 0.5 { 1.0 - alpha * p } else { along * along + alpha * sigma * sigma });
        let shape = Shape { alpha, q: p / (1.0 + e), e };
        let at_far_end = alpha > 0.0 && along < 0.0;
        let shape = if at_far_end { shape.seen_from_the_other_apsis() } else { shape };
        let (s, universal) = shape.of_state(r, sigma);
        let sqrt_p = h / sqrt_mu;
        // Turn back by the angle from the apsis.
        let (x, y) = (shape.q - universal.u2, sqrt_p * universal.u1);
        let distance = shape.q + shape.e * universal.u2;
        let (cos, sin) = (x / distance, y / distance);
        let radial = scaled(1.0 / r, position);
        let across = if h > 0.0 { cross(&scaled(1.0 / h, &momentum), &radial) } else { [0.0; 3] };
        let axes = [combined(cos, &radial, -sin, &across), combined(sin, &radial, cos, &across)];
        let conic = Self { mu, sqrt_mu, energy, momentum, shape, sqrt_p, s, time: shape.time(s, &universal), axes };
        let numbers = [sqrt_mu, alpha, shape.q, e, sqrt_p, s, conic.time];
        let finite = numbers.iter().chain(&axes[0]).chain(&axes[1]).all(|x| x.is_finite());
        if finite { Ok(conic) } else { Err(Failure::OutOfRange.into()) }
    }

    /// The state after a time.
    pub(super) fn after(&self, time: f64) -> Result<Arrival, Error> {
        if self.sqrt_p == 0.0 {
            self.check_fall(time)?;
        }
        let (alpha, going) = (self.shape.alpha, self.sqrt_mu * time);
        let (mut shape, [mut toward, mut ahead]) = (self.shape, self.axes);
        let (mut target, mut half_revolutions) = (self.time + going, 0.0);
        if alpha > 0.0 {
            let half = 0.5 * self.period();
            half_revolutions = rounded(target / half);
            if half_revolutions.abs() > MOST_REVOLUTIONS {
                return Err(Failure::OutOfRange.into());
            }
            if half_revolutions != 0.0 {
                // What is left of the way first: it is nearly as long as the half revolutions, so that their difference
                // is exact.
                target = (going - half_revolutions * half) + self.time;
            }
            if is_odd(half_revolutions) {
                shape = shape.seen_from_the_other_apsis();
                (toward, ahead) = (scaled(-1.0, &toward), scaled(-1.0, &ahead));
            }
        }
        let place = shape.place(target);
        let u = place.universal;
        let r = shape.q + shape.e * u.u2;
        let position = combined(shape.q - u.u2, &toward, self.sqrt_p * u.u1, &ahead);
        let speed = self.sqrt_mu / r;
        let velocity = combined(-speed * u.u1, &toward, speed * self.sqrt_p * u.u0, &ahead);
        let state = with_integrals(self.mu, &StateVector { position, velocity }, self.energy, &self.momentum);
        if state.is_finite() && r > 0.0 {
            Ok(Arrival { state, iterations: place.iterations, s: place.s, half_revolutions })
        } else {
            Err(Failure::OutOfRange.into())
        }
    }

    /// Whether a fall along a straight line meets the centre within a time.
    fn check_fall(&self, time: f64) -> Result<(), Error> {
        let period = if self.shape.alpha > 0.0 { self.period() } else { f64::INFINITY };
        // Since the centre, counted in the direction of the motion.
        let since = time.signum()
            * if self.shape.e < 0.0 { self.time + (0.5 * period).copysign(-self.time) } else { self.time };
        let until = if since < 0.0 { -since } else { period - since };
        let meeting = time.signum() * until / self.sqrt_mu;
        if time.abs() >= meeting.abs() { Err(Failure::Falls { time: meeting }.into()) } else { Ok(()) }
    }

    /// `√μ` times the period of an ellipse.
    fn period(&self) -> f64 {
        let alpha = self.shape.alpha;
        // Of the energy as it is, not as its first double says.
        2.0 * PI / (alpha * Scalar::sqrt(alpha)) * (1.0 - 1.5 * self.energy.low / alpha)
    }

    /// Distance of the nearest point.
    pub(super) fn nearest(&self) -> f64 {
        if self.shape.e < 0.0 { self.shape.seen_from_the_other_apsis().q } else { self.shape.q }
    }

    /// e
    pub(super) fn eccentricity(&self) -> f64 {
        self.shape.e.abs()
    }

    /// `1/a`
    pub(super) fn alpha(&self) -> f64 {
        self.shape.alpha
    }

    /// The way in s to an arrival, and what is left of it without whole revolutions.
    pub(super) fn way(&self, arrival: &Arrival) -> (f64, f64) {
        let rest = arrival.s - self.s;
        if arrival.half_revolutions == 0.0 {
            return (rest, rest);
        }
        let half = PI / Scalar::sqrt(self.shape.alpha);
        let odd = if is_odd(arrival.half_revolutions) { half } else { 0.0 };
        (rest + arrival.half_revolutions * half, rest + odd)
    }
}

/// Whether a whole number is odd.
#[inline]
pub(super) fn is_odd(whole: f64) -> bool {
    2.0 * rounded(0.5 * whole) != whole
}

/// To the nearest whole number.
#[inline]
pub(super) fn rounded(x: f64) -> f64 {
    // What is larger has no fraction.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    if x.abs() < WHOLE { (x.abs() + WHOLE - WHOLE).copysign(x) } else { x }
}
