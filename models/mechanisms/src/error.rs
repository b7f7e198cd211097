//! Why a system has no answer: one error for all of them.
//!
//! ```
//! use mbs_models::check::{self, Must};
//! use mbs_models::{At, Error, Failure};
//!
//! fn fall(mass: f64) -> Result<f64, Error> {
//!     check::positive("mass", mass)?;
//!     Err(Failure::NotFinite("the wind").at_time(0.5))
//! }
//!
//! assert_eq!(fall(-1.0), Err(Must::BePositive.broken_by("mass", -1.0).into()));
//! let error = fall(1.0).unwrap_err();
//! assert_eq!((error.failure, error.at), (Failure::NotFinite("the wind"), Some(At::Time(0.5))));
//! assert_eq!(error.to_string(), "t = 0.5 s: the wind is NaN or infinite");
//! ```

use core::{error, fmt};

use mbs_runtime::attitude::NotARotation;
use mbs_runtime::control::ControlError;
use mbs_runtime::{IntegrationError, ParameterError};

use crate::check::Invalid;

/// Why a system has no answer, and where it came to that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// What failed.
    pub failure: Failure,
    /// Where on the way; `None` where there is no way, or before it begins.
    pub at: Option<At>,
}

/// A place on a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A time \[s\].
    Time(f64),
    /// A path parameter.
    Path(f64),
}

/// What failed. Joints, legs and what else is several are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Failure {
    /// A number, given or come to on the way, that a system does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Something that is evaluated on the way is NaN or infinite.
    #[error("{0} is NaN or infinite")]
    NotFinite(&'static str),
    /// Numbers on the way are too large or too small for `f64`.
    #[error("the motion leaves the range of floating-point numbers")]
    OutOfRange,
    /// What was given leaves something open.
    #[error("{0} is not determined")]
    Undetermined(&'static str),
    /// There is nothing of this name or kind among what there is.
    #[error("there is no {0}")]
    Missing(&'static str),
    /// A Jacobian loses motions, or nearly.
    #[error("{of} is singular: singular values from {largest} down to {smallest:e}, {unit}")]
    Singular {
        /// What cannot be solved there.
        of: &'static str,
        /// The smallest singular value.
        smallest: f64,
        /// The largest one.
        largest: f64,
        /// What they are in, or relative to.
        unit: &'static str,
    },
    /// A search was given up.
    #[error("{what} does not converge: {residual:e} {unit} is left after {iterations} iterations")]
    NotConverged {
        /// What was searched, or solved.
        what: &'static str,
        /// How often it was tried.
        iterations: usize,
        /// What is left of what was to become zero.
        residual: f64,
        /// Its unit, or what it is relative to.
        unit: &'static str,
    },
    /// A limit cannot be kept together with the others.
    #[error("no motion keeps all limits: {limit} is off by {excess} in SI units")]
    Infeasible {
        /// The one that the best motion breaks most.
        limit: &'static str,
        /// By how much, in the SI unit of the limit: m, m/s, rad.
        excess: f64,
    },
    /// A joint, an axis or a leg goes beyond a limit.
    #[error("{quantity} {index} comes to {value} {unit}, its limit is {limit} {unit}")]
    LimitExceeded {
        /// The name of what is limited, as in `velocity of joint`.
        quantity: &'static str,
        /// Its unit.
        unit: &'static str,
        /// The number of the joint, axis or leg.
        index: usize,
        /// The value it comes to.
        value: f64,
        /// The greatest or least value it may have.
        limit: f64,
    },
    /// A place where a motion is lost, or nearly: joints would have to jump.
    #[error("the {0} is singular")]
    Degenerate(&'static str),
    /// A pose is farther than a stretched arm reaches.
    #[error("the wrist is out of reach by {by} m")]
    TooFar {
        /// By how much \[m\].
        by: f64,
    },
    /// A pose is nearer than a folded arm reaches.
    #[error("the wrist is too near to the shoulder by {by} m")]
    TooNear {
        /// By how much \[m\].
        by: f64,
    },
    /// Start and stop are the same, or a path stands still.
    #[error("nothing moves: start and stop are the same, or the path stands still")]
    NoMotion,
    /// Bodies do not meet in time.
    #[error("no contact, {distance} m are left")]
    NoContact {
        /// How far they are apart then \[m\].
        distance: f64,
    },
    /// Bodies meet that are not to.
    #[error("collision at a distance of {distance} m")]
    Collision {
        /// How far their places are apart \[m\].
        distance: f64,
    },
    /// A body comes through the plane of a port beside it.
    #[error("the vehicle passes the plane of the port {distance} m beside it")]
    Missed {
        /// From the port \[m\].
        distance: f64,
    },
    /// A motion along a straight line meets the centre on the way, as far as rounding lets tell.
    #[error("falls into the centre of attraction after {time} s")]
    Falls {
        /// When, from the given state on \[s\]; negative before it.
        time: f64,
    },
    /// An orbit is so nearly a straight line that its elements, as they are rounded, would not give the state back.
    #[error(
        "at the distance {distance} m an orbit of the semi-latus rectum {semi_latus_rectum} m is too nearly a straight \
         line: its elements would not give the state back"
    )]
    NearlyStraight {
        /// `p = h²/μ` \[m\].
        semi_latus_rectum: f64,
        /// r \[m\]
        distance: f64,
    },
    /// The integration failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
    /// There is no regulator.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The mechanism refuses its parameters.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// Nine numbers are no rotation.
    #[error(transparent)]
    Rotation(#[from] NotARotation),
}

impl Failure {
    /// The error of this failure at a time \[s\].
    #[must_use]
    pub const fn at_time(self, time: f64) -> Error {
        Error { failure: self, at: Some(At::Time(time)) }
    }

    /// The error of this failure at a path parameter.
    #[must_use]
    pub const fn at_path(self, s: f64) -> Error {
        Error { failure: self, at: Some(At::Path(s)) }
    }
}

impl Invalid {
    /// The error of this number at a time \[s\].
    #[must_use]
    pub const fn at_time(self, time: f64) -> Error {
        Failure::Invalid(self).at_time(time)
    }

    /// The error of this number at a path parameter.
    #[must_use]
    pub const fn at_path(self, s: f64) -> Error {
        Failure::Invalid(self).at_path(s)
    }
}

impl Error {
    /// The same error at a time \[s\], unless it says already where it was.
    #[must_use]
    pub fn or_at_time(self, time: f64) -> Self {
        Self { at: self.at.or(Some(At::Time(time))), ..self }
    }

    /// The same error at a path parameter, unless it says already where it was.
    #[must_use]
    pub fn or_at_path(self, s: f64) -> Self {
        Self { at: self.at.or(Some(At::Path(s))), ..self }
    }

    /// The number that does not hold, where it is one that failed.
    #[must_use]
    pub const fn invalid(&self) -> Option<Invalid> {
        match self.failure {
            Failure::Invalid(invalid) => Some(invalid),
            _ => None,
        }
    }
}

impl<F: Into<Failure>> From<F> for Error {
    fn from(failure: F) -> Self {
        Self { failure: failure.into(), at: None }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.at {
            Some(At::Time(time)) => write!(f, "t = {time} s: ")?,
            Some(At::Path(s)) => write!(f, "s = {s}: ")?,
            None => {}
        }
        self.failure.fmt(f)
    }
}

impl error::Error for Error {
    fn source(&self) -> Option<&(dyn error::Error + 'static)> {
        self.failure.source()
    }
}
