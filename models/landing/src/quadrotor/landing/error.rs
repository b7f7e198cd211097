//! Why a landing has no touchdown.

use core::fmt;

use mbs_runtime::IntegrationError;

use super::MOST_MOMENTS;
use mbs_platform::PoseError;
use mbs_platform::limits::InvalidLimits;

/// Why there is no touchdown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LandingError {
    /// What must be positive is not (or is NaN or infinite).
    NotPositive {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// What has bounds is beyond them, or NaN.
    OutOfRange {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// The bounds.
        range: [f64; 2],
    },
    /// What must be a finite number is none.
    NotFinite {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// The vehicle does not stand over the platform at the beginning.
    NotAbove {
        /// Over the deck \[m\].
        height: f64,
    },
    /// More than [`MOST_MOMENTS`] would have to be looked at.
    TooManyMoments {
        /// When it would be given up \[s\].
        t_end: f64,
        /// From one to the next \[s\].
        period: f64,
    },
    /// A coordinate of the deck is infinite or NaN.
    Deck {
        /// When \[s\].
        time: f64,
    },
    /// The deck stands upright or hangs over where something is to stand on it.
    Overturned {
        /// When \[s\].
        time: f64,
        /// Vertical component of its normal.
        upward: f64,
    },
    /// The vehicle's pitch is within 1° of ±90° or beyond: its angles do not tell its attitude.
    Pitch {
        /// When \[s\].
        time: f64,
        /// θ \[rad\].
        pitch: f64,
    },
    /// The vehicle leaves the deck where it is to reach it: the period does not resolve the motion, or the velocity of
    /// the deck is not the rate of its position.
    Unresolved {
        /// When \[s\].
        time: f64,
        /// Along the normal, upwards \[m/s\].
        relative_velocity: f64,
    },
    /// It has not touched down in time.
    NoTouchdown {
        /// When it was given up \[s\].
        time: f64,
        /// Over the deck then \[m\].
        height: f64,
    },
    /// A sensor gave a value that is NaN or infinite.
    Sensor {
        /// When \[s\].
        time: f64,
    },
    /// The integration failed.
    Integration(IntegrationError),
    /// The legs of a driven platform cannot hold it.
    Platform {
        /// When \[s\].
        time: f64,
        /// Why.
        error: PoseError,
    },
    /// A driven platform has come through a pose in which its legs could not hold it: through or past them.
    ThroughSingularity {
        /// When it was beyond \[s\].
        time: f64,
        /// Determinant of the Jacobian of its legs by coordinates then \[m³\].
        determinant: f64,
        /// The same at the beginning \[m³\], of the other sign.
        before: f64,
    },
    /// Nothing can keep the limits of a driven platform.
    Limits(InvalidLimits),
}

impl fmt::Display for LandingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LandingError::NotPositive { parameter, value } => write!(f, "{parameter} must be positive, it is {value}"),
            LandingError::OutOfRange { parameter, value, range: [least, greatest] } => {
                write!(f, "{parameter} must be between {least} and {greatest}, it is {value}")
            }
            LandingError::NotFinite { parameter, value } => write!(f, "{parameter} must be finite, it is {value}"),
            LandingError::NotAbove { height } => write!(f, "the vehicle begins {height} m over the platform"),
            LandingError::NoTouchdown { time, height } => {
                write!(f, "no touchdown until t = {time} s, {height} m over the platform")
            }
            LandingError::Pitch { time, pitch } => {
                write!(f, "at t = {time} s the pitch is {pitch} rad, near ±90° or beyond")
            }
            LandingError::Unresolved { time, relative_velocity } => {
                write!(
                    f,
                    "at t = {time} s the vehicle would leave the deck with {relative_velocity} m/s where it reaches it"
                )
            }
            LandingError::TooManyMoments { t_end, period } => {
                write!(f, "moments every {period} s until {t_end} s are more than {MOST_MOMENTS}")
            }
            LandingError::Sensor { time } => write!(f, "a sensor gives NaN or an infinite value at t = {time} s"),
            LandingError::Deck { time } => write!(f, "a coordinate of the deck is NaN or infinite at t = {time} s"),
            LandingError::Overturned { time, upward } => {
                write!(f, "the deck is turned over at t = {time} s: its normal has the vertical component {upward}")
            }
            LandingError::Integration(error) => error.fmt(f),
            LandingError::Platform { time, error } => write!(f, "the platform at t = {time} s: {error}"),
            LandingError::ThroughSingularity { time, determinant, before } => {
                write!(
                    f,
                    "the platform is beyond a singular pose at t = {time} s: determinant {determinant} m³, {before} m³ before"
                )
            }
            LandingError::Limits(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for LandingError {}

impl From<IntegrationError> for LandingError {
    fn from(error: IntegrationError) -> Self {
        LandingError::Integration(error)
    }
}
