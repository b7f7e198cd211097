//! Why a landing has no touchdown.

use mbs_models::check::Invalid;
use mbs_runtime::IntegrationError;

use super::MOST_MOMENTS;
use mbs_platform::PoseError;
use mbs_platform::limits::InvalidLimits;

/// Why there is no touchdown.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LandingError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// The vehicle begins at or below the height at which it has landed.
    #[error("the vehicle begins {height} m over the platform, where it has landed already")]
    NotAbove {
        /// Over the deck \[m\].
        height: f64,
    },
    /// More than [`MOST_MOMENTS`] would have to be looked at.
    #[error("moments every {period} s until {t_end} s are more than {MOST_MOMENTS}")]
    TooManyMoments {
        /// When it would be given up \[s\].
        t_end: f64,
        /// From one to the next \[s\].
        period: f64,
    },
    /// A coordinate of the deck is infinite or NaN.
    #[error("a coordinate of the deck is NaN or infinite at t = {time} s")]
    Deck {
        /// When \[s\].
        time: f64,
    },
    /// The deck stands upright or hangs over where something is to stand on it.
    #[error("the deck is turned over at t = {time} s: its normal has the vertical component {upward}")]
    Overturned {
        /// When \[s\].
        time: f64,
        /// Vertical component of its normal.
        upward: f64,
    },
    /// The vehicle's pitch is within 1° of ±90° or beyond: its angles do not tell its attitude.
    #[error("at t = {time} s the pitch is {pitch} rad, near ±90° or beyond")]
    Pitch {
        /// When \[s\].
        time: f64,
        /// θ \[rad\].
        pitch: f64,
    },
    /// The vehicle leaves the deck where it is to reach it: the period does not resolve the motion, or the velocity of
    /// the deck is not the rate of its position.
    #[error("at t = {time} s the vehicle would leave the deck with {relative_velocity} m/s where it reaches it")]
    Unresolved {
        /// When \[s\].
        time: f64,
        /// Along the normal, upwards \[m/s\].
        relative_velocity: f64,
    },
    /// It has not touched down in time.
    #[error("no touchdown until t = {time} s, {height} m over the platform")]
    NoTouchdown {
        /// When it was given up \[s\].
        time: f64,
        /// Over the deck then \[m\].
        height: f64,
    },
    /// A sensor gave a value that is NaN or infinite.
    #[error("a sensor gives NaN or an infinite value at t = {time} s")]
    Sensor {
        /// When \[s\].
        time: f64,
    },
    /// The wind is NaN or infinite.
    #[error("the wind is NaN or infinite at t = {time} s")]
    Wind {
        /// When \[s\].
        time: f64,
    },
    /// The integration failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// The legs of a driven platform cannot hold it.
    #[error("the platform at t = {time} s: {error}")]
    Platform {
        /// When \[s\].
        time: f64,
        /// Why.
        error: PoseError,
    },
    /// A driven platform has come through a pose in which its legs could not hold it: through or past them.
    #[error("the platform is beyond a singular pose at t = {time} s: determinant {determinant} m³, {before} m³ before")]
    ThroughSingularity {
        /// When it was beyond \[s\].
        time: f64,
        /// Determinant of the Jacobian of its legs by coordinates then \[m³\].
        determinant: f64,
        /// The determinant at the beginning \[m³\], of the other sign.
        before: f64,
    },
    /// Nothing can keep the limits of a driven platform.
    #[error(transparent)]
    Limits(InvalidLimits),
}
