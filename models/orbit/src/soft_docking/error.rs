//! Why a final approach does not come to an end.

use mbs_models::check::Invalid;
use mbs_runtime::{IntegrationError, ParameterError};

use crate::mission::glideslope::GlideslopeError;

/// Why a final approach was not flown to an end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SoftDockingError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Bodies that there cannot be.
    #[error(transparent)]
    Bodies(#[from] ParameterError),
    /// The approach has no slope.
    #[error(transparent)]
    Glideslope(#[from] GlideslopeError),
    /// The integrator gave up.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// The ports did not meet in time.
    #[error("no contact up to t = {time} s, the ports are {distance} m apart")]
    NoContact {
        /// The time \[s\].
        time: f64,
        /// Along the approach \[m\].
        distance: f64,
    },
    /// The propellant took all of the mass.
    #[error("no mass is left at t = {time} s")]
    NoMass {
        /// The time \[s\].
        time: f64,
    },
}
