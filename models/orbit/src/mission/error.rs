//! Why a mission does not end at the port.

use core::fmt;

use super::coast::CoastError;
use super::glideslope::GlideslopeError;
use crate::clohessy_wiltshire::TargetingError;
use crate::elements::ElementsError;
use crate::kepler::KeplerError;
use crate::lambert::LambertError;
use crate::lvlh::FrameError;
use crate::yamanaka_ankersen::TransitionError;

/// Why a mission did not end at the port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MissionError {
    /// What must be positive and finite is not.
    NotPositive {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// What must not be negative is, or is not finite.
    Negative {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// A duration is longer than a mission may take, the corridor opens to half a space, or corrections are too many.
    TooLarge {
        /// Its name.
        parameter: &'static str,
        /// Its value \[s\], \[rad\] or \[1\].
        value: f64,
        /// At most this.
        limit: f64,
    },
    /// Station or vehicle are on no orbit.
    Orbit(ElementsError),
    /// The station or the vehicle was not propagated.
    Kepler(KeplerError),
    /// The station has no frame.
    Frame(FrameError),
    /// The approach or docking has no slope.
    Glideslope(GlideslopeError),
    /// A coast ended early.
    Coast {
        /// When it began \[s\].
        time: f64,
        /// Why.
        error: CoastError,
    },
    /// No plan of phasing arrives: within the longest wait, above the lowest altitude.
    NoPhasing {
        /// \[s\]
        longest_wait: f64,
        /// \[m\]
        lowest_altitude: f64,
    },
    /// A correction of phasing was not found.
    Lambert {
        /// When \[s\].
        time: f64,
        /// Why.
        error: LambertError,
    },
    /// A burn was not found by Clohessy and Wiltshire's equations.
    Targeting {
        /// When \[s\].
        time: f64,
        /// Why.
        error: TargetingError,
    },
    /// A burn was not found by Yamanaka and Ankersen's matrix.
    Transition {
        /// When \[s\].
        time: f64,
        /// Why.
        error: TransitionError,
    },
    /// The thrusters gave NaN or an infinite value.
    Thrust {
        /// When \[s\].
        time: f64,
    },
    /// The vehicle has not come to the port in thrice the time that it should have taken.
    NoContact {
        /// \[s\]
        time: f64,
        /// Distance to go \[m\].
        distance: f64,
    },
    /// The vehicle crossed the plane of the port outside the keep-out sphere: that is no docking.
    Missed {
        /// When \[s\].
        time: f64,
        /// From the port \[m\].
        distance: f64,
    },
}

impl fmt::Display for MissionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MissionError::NotPositive { parameter, value } => write!(f, "{parameter} must be positive, it is {value}"),
            MissionError::Negative { parameter, value } => write!(f, "{parameter} must not be negative, it is {value}"),
            MissionError::TooLarge { parameter, value, limit } => {
                write!(f, "{parameter} must be at most {limit}, it is {value}")
            }
            MissionError::Orbit(error) => error.fmt(f),
            MissionError::Kepler(error) => error.fmt(f),
            MissionError::Frame(error) => error.fmt(f),
            MissionError::Glideslope(error) => error.fmt(f),
            MissionError::Coast { time, error } => write!(f, "the coast from t = {time} s ended early: {error}"),
            MissionError::NoPhasing { longest_wait, lowest_altitude } => write!(
                f,
                "no plan gets behind the station that waits at most {longest_wait} s and stays {lowest_altitude} m up"
            ),
            MissionError::Lambert { time, error } => write!(f, "no correction at t = {time} s: {error}"),
            MissionError::Targeting { time, error } => write!(f, "no burn at t = {time} s: {error}"),
            MissionError::Transition { time, error } => write!(f, "no burn at t = {time} s: {error}"),
            MissionError::Thrust { time } => write!(f, "the thrusters give NaN or an infinite value at t = {time} s"),
            MissionError::NoContact { time, distance } => {
                write!(f, "no contact until t = {time} s, {distance} m before the port")
            }
            MissionError::Missed { time, distance } => {
                write!(f, "the vehicle passes the plane of the port at t = {time} s, {distance} m beside it")
            }
        }
    }
}

impl core::error::Error for MissionError {}

impl From<KeplerError> for MissionError {
    fn from(error: KeplerError) -> Self {
        MissionError::Kepler(error)
    }
}

impl From<FrameError> for MissionError {
    fn from(error: FrameError) -> Self {
        MissionError::Frame(error)
    }
}

impl From<GlideslopeError> for MissionError {
    fn from(error: GlideslopeError) -> Self {
        MissionError::Glideslope(error)
    }
}
