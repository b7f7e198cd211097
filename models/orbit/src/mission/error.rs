//! Why a mission does not end at the port.

use super::coast::CoastError;
use super::glideslope::GlideslopeError;
use crate::clohessy_wiltshire::TargetingError;
use crate::elements::ElementsError;
use crate::kepler::KeplerError;
use crate::lambert::LambertError;
use crate::lvlh::FrameError;
use crate::yamanaka_ankersen::TransitionError;
use mbs_models::check::Invalid;

/// Why a mission did not end at the port.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MissionError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Station or vehicle are on no orbit.
    #[error(transparent)]
    Orbit(ElementsError),
    /// The station or the vehicle was not propagated.
    #[error(transparent)]
    Kepler(#[from] KeplerError),
    /// The station has no frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The approach or docking has no slope.
    #[error(transparent)]
    Glideslope(#[from] GlideslopeError),
    /// A coast ended early.
    #[error("the coast from t = {time} s ended early: {error}")]
    Coast {
        /// When it began \[s\].
        time: f64,
        /// Why.
        error: CoastError,
    },
    /// No plan of phasing arrives: within the longest wait, above the lowest altitude.
    #[error("no plan gets behind the station that waits at most {longest_wait} s and stays {lowest_altitude} m up")]
    NoPhasing {
        /// The longest wait \[s\].
        longest_wait: f64,
        /// The lowest altitude \[m\].
        lowest_altitude: f64,
    },
    /// A correction of phasing was not found.
    #[error("no correction at t = {time} s: {error}")]
    Lambert {
        /// When \[s\].
        time: f64,
        /// Why.
        error: LambertError,
    },
    /// A burn was not found by Clohessy and Wiltshire's equations.
    #[error("no burn at t = {time} s: {error}")]
    Targeting {
        /// When \[s\].
        time: f64,
        /// Why.
        error: TargetingError,
    },
    /// A burn was not found by Yamanaka and Ankersen's matrix.
    #[error("no burn at t = {time} s: {error}")]
    Transition {
        /// When \[s\].
        time: f64,
        /// Why.
        error: TransitionError,
    },
    /// The thrusters gave NaN or an infinite value.
    #[error("the thrusters give NaN or an infinite value at t = {time} s")]
    Thrust {
        /// When \[s\].
        time: f64,
    },
    /// The vehicle has not come to the port in thrice the time that it should have taken.
    #[error("no contact until t = {time} s, {distance} m before the port")]
    NoContact {
        /// The time \[s\].
        time: f64,
        /// Distance to go \[m\].
        distance: f64,
    },
    /// The vehicle crossed the plane of the port outside the keep-out sphere: that is no docking.
    #[error("the vehicle passes the plane of the port at t = {time} s, {distance} m beside it")]
    Missed {
        /// When \[s\].
        time: f64,
        /// From the port \[m\].
        distance: f64,
    },
}
