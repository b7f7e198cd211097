//! The frame that goes round with a station, and motions as they are seen from there.
//!
//! x points away from the centre, y along the motion, z along the orbital angular momentum; the frame turns with
//!
//! ```text
//! ω = (h/r²) z,   δr = Rᵀ (r − r_t),   δv = Rᵀ (v − v_t) − ω × δr
//! ```
//!
//! Relative velocities are those that an observer in the turning frame sees.
//!
//! # Source
//! Thesis, section 7.5; Curtis, *Orbital Mechanics for Engineering Students*, 2020, section 7.2.

use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::integrals::angular_momentum;
use super::kepler::{Conic, propagate};
use super::transition::state_transition;
use super::vector::{StateVector, Vector, combined, cross, dot, minus, norm, plus, scaled, transformed};

/// Axes and rate of the frame of a station at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    station: StateVector,
    /// Unit vectors x, y, z in inertial components.
    axes: [Vector; 3],
    /// `h/r²` \[rad/s\].
    rate: f64,
}

impl Frame {
    /// Of a station.
    ///
    /// # Errors
    /// [`Error`].
    pub fn of(station: &StateVector) -> Result<Self, Error> {
        station.check()?;
        let momentum = angular_momentum(station);
        let (r, h) = (norm(&station.position), norm(&momentum));
        if !(h.is_finite() && r.is_finite()) {
            return Err(Failure::OutOfRange.into());
        }
        if h <= 4.0 * f64::EPSILON * r * norm(&station.velocity) {
            return Err(Failure::Undetermined("the frame of a station that moves along a straight line").into());
        }
        let (x, z) = (scaled(1.0 / r, &station.position), scaled(1.0 / h, &momentum));
        let frame = Self { station: *station, axes: [x, cross(&z, &x), z], rate: h / r / r };
        let numbers = frame.axes.iter().flatten().chain([&frame.rate]);
        if numbers.copied().all(f64::is_finite) { Ok(frame) } else { Err(Failure::OutOfRange.into()) }
    }

    /// Unit vectors x, y, z in inertial components: rows of `Rᵀ`.
    #[must_use]
    pub fn axes(&self) -> &[Vector; 3] {
        &self.axes
    }

    /// ω about z \[rad/s\].
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// A state relative to the station, from an inertial one.
    #[must_use]
    pub fn to_relative(&self, inertial: &StateVector) -> StateVector {
        self.turned_in(&StateVector {
            position: minus(&inertial.position, &self.station.position),
            velocity: minus(&inertial.velocity, &self.station.velocity),
        })
    }

    /// An inertial state, from one relative to the station.
    #[must_use]
    pub fn to_inertial(&self, relative: &StateVector) -> StateVector {
        let difference = self.turned_out(relative);
        StateVector {
            position: plus(&self.station.position, &difference.position),
            velocity: plus(&self.station.velocity, &difference.velocity),
        }
    }

    /// A state relative to the station, from the difference of two inertial ones.
    #[must_use]
    pub fn turned_in(&self, difference: &StateVector) -> StateVector {
        let into = |a: &Vector| [dot(&self.axes[0], a), dot(&self.axes[1], a), dot(&self.axes[2], a)];
        let (position, velocity) = (into(&difference.position), into(&difference.velocity));
        let [x, y, _] = position;
        StateVector { position, velocity: plus(&velocity, &[self.rate * y, -self.rate * x, 0.0]) }
    }

    /// The difference of two inertial states, from a state relative to the station.
    #[must_use]
    pub fn turned_out(&self, relative: &StateVector) -> StateVector {
        let out = |a: &Vector| plus(&combined(a[0], &self.axes[0], a[1], &self.axes[1]), &scaled(a[2], &self.axes[2]));
        let [x, y, _] = relative.position;
        let velocity = plus(&relative.velocity, &[-self.rate * y, self.rate * x, 0.0]);
        StateVector { position: out(&relative.position), velocity: out(&velocity) }
    }
}

/// A station and what moves about it, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeMotion {
    /// The station, inertial.
    pub station: StateVector,
    /// The other, in the station's frame.
    pub relative: StateVector,
}

/// Nodes and weights of Gauss' quadrature of order 8 on (0, 1).
const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

/// What [`spread`] is less than where the quadrature carries the separation; a plain difference would lose two digits
/// and more.
///
/// Over the separation a station's place along its orbit varies by six times the spread on ellipses and at most ten on
/// hyperbolas, in units of q. As a function of complex time Kepler's motion is regular within a distance of q/v_q about
/// real times: without a limit for e = 0, 1.33 for e = 1, 1 for e → ∞. The remainder `(4!)⁴/(9 (8!)³) f⁽⁸⁾` of the
/// quadrature, with `f⁽⁸⁾` of the size `8! (6 · 0.01/1.33)⁸ f` at e → 1, is 4e-16 f.
const NEAR: f64 = 0.01;

/// How far apart two motions may come, in units of the nearest distance q.
///
/// ```text
/// (|δr|/q + |δv|/v_q) (1 + τ min(1/|α q|, 1 + τ)),   v_q² = μ (1 + e)/q,   τ = |t| v_q/q,   α = 1/a
/// ```
///
/// Both, δr and δv, change the energy by `|δα| q ≤ 4 (|δr|/q + |δv|/v_q)` on ellipses, and it the time by `δt/t = 3/2
/// δα/α`; but near the parabola by no more than the part of the way that is fallen through.
fn spread(mu: f64, conic: &Conic, separation: &StateVector, time: f64) -> f64 {
    let (q, e) = (conic.nearest(), conic.eccentricity());
    let speed = Scalar::sqrt(mu / q * (1.0 + e));
    let tau = time.abs() * (speed / q);
    let drift = (1.0 / (conic.alpha() * q).abs()).max(1.0).min(1.0 + tau);
    (norm(&separation.position) / q + norm(&separation.velocity) / speed) * (1.0 + tau * drift)
}

/// The exact relative motion of two bodies that attract each other not, about one centre.
///
/// Bodies that are far apart, or drift apart in the time, are propagated one by one: the error is then that of two
/// places. The separation of two that stay near, which their difference would lose in rounding, is
///
/// ```text
/// δ(t) = ∫₀¹ Φ(t; x_t + λ δ₀) dλ · δ₀
/// ```
///
/// with the state transition matrix Φ of Kepler's motion, by Gauss' quadrature with four nodes: no linearization, and
/// as many digits as Φ has.
///
/// | argument   | meaning                                | unit   |
/// |------------|----------------------------------------|--------|
/// | `mu`       | G times the mass of the centre         | m³/s²  |
/// | `station`  | inertial, relative to the centre       | m, m/s |
/// | `relative` | in the station's frame                 | m, m/s |
/// | `time`     | how far to go                          | s      |
///
/// # Errors
/// [`Error`].
pub fn relative_motion(
    mu: f64,
    station: &StateVector,
    relative: &StateVector,
    time: f64,
) -> Result<RelativeMotion, Error> {
    let frame = Frame::of(station)?;
    let conic = Conic::through(mu, station)?;
    let end = propagate(mu, station, time)?.state;
    let end_frame = Frame::of(&end)?;
    let separation = frame.turned_out(relative);
    if spread(mu, &conic, &separation, time) < NEAR {
        let mut sum = StateVector::default();
        for [node, weight] in GAUSS {
            let between = StateVector {
                position: plus(&station.position, &scaled(node, &separation.position)),
                velocity: plus(&station.velocity, &scaled(node, &separation.velocity)),
            };
            let carried = transformed(&state_transition(mu, &between, time)?.matrix, &separation);
            sum = StateVector {
                position: plus(&sum.position, &scaled(weight, &carried.position)),
                velocity: plus(&sum.velocity, &scaled(weight, &carried.velocity)),
            };
        }
        return finite(RelativeMotion { station: end, relative: end_frame.turned_in(&sum) });
    }
    let other = propagate(mu, &frame.to_inertial(relative), time)?.state;
    finite(RelativeMotion { station: end, relative: end_frame.to_relative(&other) })
}

fn finite(motion: RelativeMotion) -> Result<RelativeMotion, Error> {
    if motion.relative.is_finite() { Ok(motion) } else { Err(Failure::OutOfRange.into()) }
}
