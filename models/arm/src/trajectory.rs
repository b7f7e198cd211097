//! Motions of an arm from one posture to another: section 3.6 of the thesis, and what it leaves open.
//!
//! | function | motion | honours |
//! |---|---|---|
//! | [`quartic`] | one polynomial of degree 4 | start, its velocity, zero acceleration; stop at rest; the last acceleration is an output |
//! | [`two_piece_quartic`] | "start–move–stop": two of degree 4, C³ | the same, and zero acceleration at the stop |
//! | [`quintic`], [`quintic_between`] | one polynomial of degree 5 | position, velocity and acceleration at both ends |
//! | [`trapezoidal`], [`trapezoidal_within`] | constant acceleration, constant speed, constant deceleration | rest at both ends; with limits: the fastest such motion |
//! | [`through`] | degrees 4, 3 … 3, 4 | points with times, C² |
//! | [`time_optimal::retime`] | the fastest motion along a path | limits of speed, acceleration and torque |
//! | `minimum_effort` (feature `std`) | least `∫ Σ (τ/τ_max)² dt` between two states, by direct collocation | limits of angle, speed and torque |
//! | [`cartesian`] | the flange along a straight line | one branch of the inverse kinematics |
//! | [`ThereAndBack`], [`Sines`] | the way back; sums of sines, which show a model's numbers | |
//! | [`AlongPath`] | along a path by a law of time | |
//!
//! The first five rows are [`Piecewise`] polynomials: [`Motion::at`] evaluates q, q̇ and q̈, and extrema are found
//! exactly, from the zeros of derivatives. [`work`] integrates the work and the effort of any [`Motion`];
//! [`sign_change`] finds where a function of the posture, such as the determinant of the Jacobian, changes sign.
//!
//! Angles are in radians, times in seconds; nothing depends on which mechanism the joints belong to but [`cartesian`].
//!
//! ```
//! use mbs_arm::trajectory::{Motion, quartic};
//!
//! // From rest at 0 to rest at 1 rad in 2 s; fastest at two thirds of the time.
//! let motion = quartic([0.0], [0.0], [1.0], 2.0)?;
//! assert_eq!(motion.at(2.0)?.q, [1.0]);
//! let speed = motion.velocity_extrema()[0].highest;
//! assert!((speed.time - 4.0 / 3.0).abs() < 1e-15 && (speed.value - 16.0 / 18.0).abs() < 1e-15);
//! // The acceleration at the stop is an output: −12 D/T².
//! assert_eq!(motion.at(2.0)?.qdd, [-3.0]);
//! # Ok::<(), mbs_models::Error>(())
//! ```

mod path;
mod piecewise;
mod polynomial;
mod quartic;
mod quintic;
mod sines;
mod trapezoidal;
mod via;

pub mod cartesian;
#[cfg(feature = "std")]
pub mod minimum_effort;
pub mod sign_change;
#[cfg(feature = "std")]
pub mod time_optimal;
pub mod work;

use mbs_models::Error;
use mbs_models::check::{Invalid, Must};

pub use path::{AlongPath, JointPath, PathPoint, StraightPath};
pub use piecewise::{Extrema, Extremum, Piecewise};
pub use quartic::{quartic, two_piece_quartic};
pub use quintic::{quintic, quintic_between};
pub use sines::{Sines, ThereAndBack};
pub use trapezoidal::{trapezoidal, trapezoidal_within};
pub use via::{Knot, through};

/// Angles, velocities and accelerations of `N` joints at one instant \[rad, rad/s, rad/s²\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<const N: usize> {
    /// Joint angles.
    pub q: [f64; N],
    /// Joint velocities.
    pub qd: [f64; N],
    /// Joint accelerations.
    pub qdd: [f64; N],
}

impl<const N: usize> JointState<N> {
    /// Standing still at `q`.
    #[must_use]
    pub const fn at_rest(q: [f64; N]) -> Self {
        Self { q, qd: [0.0; N], qdd: [0.0; N] }
    }
}

/// What [`Failure`](mbs_models::Failure) calls the number of intervals of a grid.
pub const INTERVALS: &str = "intervals";
/// What [`Failure`](mbs_models::Failure) calls a joint angle \[rad\].
pub const POSITION: &str = "position of joint";
/// What [`Failure`](mbs_models::Failure) calls a joint velocity \[rad/s\].
pub const VELOCITY: &str = "velocity of joint";
/// What [`Failure`](mbs_models::Failure) calls a joint acceleration \[rad/s²\].
pub const ACCELERATION: &str = "acceleration of joint";
/// What [`Failure`](mbs_models::Failure) calls a joint torque \[N·m\].
pub const TORQUE: &str = "torque of joint";

/// The joints as functions of time, from 0 to a duration.
pub trait Motion<const N: usize> {
    /// How long it lasts \[s\], positive.
    fn duration(&self) -> f64;

    /// The joints at the time `t`.
    ///
    /// # Errors
    /// [`Failure::Invalid`](mbs_models::Failure::Invalid) if `t` is before 0, after the duration, or NaN.
    fn at(&self, t: f64) -> Result<JointState<N>, Error>;

    /// The joints at the time `t`, at rest before the start and after the stop: what a controller follows that does not
    /// stop asking.
    ///
    /// # Errors
    /// [`Failure::Invalid`](mbs_models::Failure::Invalid) if `t` is NaN.
    fn held_at(&self, t: f64) -> Result<JointState<N>, Error> {
        if (0.0..=self.duration()).contains(&t) || t.is_nan() {
            return self.at(t);
        }
        self.at(t.clamp(0.0, self.duration())).map(|end| JointState::at_rest(end.q))
    }
}

impl<const N: usize, M: Motion<N> + ?Sized> Motion<N> for &M {
    fn duration(&self) -> f64 {
        (**self).duration()
    }

    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        (**self).at(t)
    }
}

/// Symmetric limits of speed and acceleration of every joint \[rad/s, rad/s²\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLimits<const N: usize> {
    /// The largest speed.
    pub speed: [f64; N],
    /// The largest acceleration, either way.
    pub acceleration: [f64; N],
}

impl<const N: usize> RateLimits<N> {
    /// Positive numbers all of them; infinite where a joint has no limit.
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        Must::BeMoreThan(0.0).check("largest speed", self.speed)?;
        Must::BeMoreThan(0.0).check("largest acceleration", self.acceleration)
    }
}
