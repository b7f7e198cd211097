//! What can go wrong, one small enum or struct per operation, with the numbers that matter.

use core::convert::Infallible;
use core::error::Error;
use core::fmt;

/// Why an integration ended before its time.
///
/// `E` is what the right-hand side or the observer stops with; [`Infallible`] where neither does.
///
/// The caller's state is then the last accepted one, at [`time`](IntegrationError::time): it can be looked at, or
/// integrated further with other settings. An error without a time refuses what was asked for; the state is the last
/// accepted one all the same, which is the initial one if the arguments themselves are at fault.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum IntegrationError<E = Infallible> {
    /// A tolerance is not a positive finite number, or not after it was rounded to the precision of the state.
    InvalidTolerance {
        /// The relative tolerance given.
        relative: f64,
        /// The absolute tolerance given.
        absolute: f64,
    },
    /// A fixed step, or a limit of the step, is zero, negative or NaN; or the longest step is below the shortest one,
    /// or below the resolution of the time.
    InvalidStep {
        /// The step given \[s\].
        step: f64,
    },
    /// The gain `β` of the step control is negative, NaN, or outweighs that of the last error.
    InvalidGain {
        /// The gain given.
        beta: f64,
    },
    /// A time is not finite, an output time lies before its predecessor, or an observer asked for a time outside the
    /// step.
    InvalidTime {
        /// The time refused \[s\].
        time: f64,
    },
    /// `q` and `q̇` are of different length.
    DimensionMismatch {
        /// The number of coordinates.
        coordinates: usize,
        /// The number of velocities.
        velocities: usize,
    },
    /// No step longer than the smallest one satisfies the tolerances: they ask for more than the arithmetic holds, or
    /// the solution ends here; or the longest step has fallen below the resolution of the time.
    StepTooSmall {
        /// The time of the last accepted state \[s\].
        time: f64,
        /// The step that was refused \[s\].
        step: f64,
    },
    /// The state or its acceleration is infinite or NaN, however short the step from here.
    NonFiniteState {
        /// The time of the last accepted state \[s\].
        time: f64,
    },
    /// The right-hand side refused, however short the step from here; or the observer ended the integration.
    Stopped {
        /// The time of the last accepted state; of an observer, the end of the step that it saw \[s\].
        time: f64,
        /// What it said.
        error: E,
    },
    /// No state on the constraints is near the end of the step, or near a state inside it that was asked for; see
    /// [`Projected`](crate::Projected).
    Constraint {
        /// The end of the step, or the time asked for \[s\].
        time: f64,
        /// What the projection said.
        error: ConstraintError,
    },
    /// The equations of an implicit method's stages were not solved: the step is too long for the iteration.
    NotConverged {
        /// The time of the last accepted state \[s\].
        time: f64,
        /// The number of iterations allowed.
        iterations: usize,
    },
    /// An event's function is infinite or NaN right after `time`.
    NonFiniteEvent {
        /// The time of the state left, where the function was last finite, or the first time \[s\].
        time: f64,
        /// The index of the event, counted from 0.
        event: usize,
    },
    /// Events follow each other too closely to be told apart, as the bounces of a ball that comes to rest do.
    EventsAccumulate {
        /// The time of the last event \[s\].
        time: f64,
        /// The index of the event, counted from 0.
        event: usize,
    },
    /// The allowed number of steps was used up, or is too small for steps of fixed length; or these were cut short by
    /// events, or by the observer, a million times within the time of one.
    TooManySteps {
        /// The time of the last accepted state \[s\].
        time: f64,
        /// The number of steps allowed, rejected ones included, of fixed ones at most 2⁵³; where these were cut short,
        /// the number of steps made.
        steps: usize,
    },
}

impl<E> IntegrationError<E> {
    /// The time of the state that the integrator left \[s\]; `None` where it refused what was asked for.
    #[must_use]
    pub fn time(&self) -> Option<f64> {
        match *self {
            Self::InvalidTolerance { .. }
            | Self::InvalidStep { .. }
            | Self::InvalidGain { .. }
            | Self::InvalidTime { .. }
            | Self::DimensionMismatch { .. } => None,
            Self::StepTooSmall { time, .. }
            | Self::NonFiniteState { time }
            | Self::Stopped { time, .. }
            | Self::Constraint { time, .. }
            | Self::NotConverged { time, .. }
            | Self::NonFiniteEvent { time, .. }
            | Self::EventsAccumulate { time, .. }
            | Self::TooManySteps { time, .. } => Some(time),
        }
    }

    /// The error with another reason where the right-hand side or the observer stopped: `f` makes it.
    pub fn map<G>(self, f: impl FnOnce(E) -> G) -> IntegrationError<G> {
        use IntegrationError as To;
        match self {
            Self::InvalidTolerance { relative, absolute } => To::InvalidTolerance { relative, absolute },
            Self::InvalidStep { step } => To::InvalidStep { step },
            Self::InvalidGain { beta } => To::InvalidGain { beta },
            Self::InvalidTime { time } => To::InvalidTime { time },
            Self::DimensionMismatch { coordinates, velocities } => To::DimensionMismatch { coordinates, velocities },
            Self::StepTooSmall { time, step } => To::StepTooSmall { time, step },
            Self::NonFiniteState { time } => To::NonFiniteState { time },
            Self::Stopped { time, error } => To::Stopped { time, error: f(error) },
            Self::Constraint { time, error } => To::Constraint { time, error },
            Self::NotConverged { time, iterations } => To::NotConverged { time, iterations },
            Self::NonFiniteEvent { time, event } => To::NonFiniteEvent { time, event },
            Self::EventsAccumulate { time, event } => To::EventsAccumulate { time, event },
            Self::TooManySteps { time, steps } => To::TooManySteps { time, steps },
        }
    }
}

impl IntegrationError {
    /// An error that nobody stopped with, among those that somebody may.
    pub(crate) fn widen<E>(self) -> IntegrationError<E> {
        self.map(|never| match never {})
    }
}

impl<E: fmt::Display> fmt::Display for IntegrationError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidTolerance { relative, absolute } => {
                write!(f, "tolerances must be positive and finite, found relative {relative:?}, absolute {absolute:?}")
            }
            Self::InvalidStep { step } => {
                write!(f, "a step must be positive, and the longest no shorter than the shortest: found {step:?} s")
            }
            Self::InvalidGain { beta } => write!(f, "the gain of the step control is out of range: {beta:?}"),
            Self::InvalidTime { time } => {
                write!(f, "{time:?} s is not finite, out of order, or outside the step asked")
            }
            Self::DimensionMismatch { coordinates, velocities } => {
                write!(f, "{coordinates} coordinates, but {velocities} velocities")
            }
            Self::StepTooSmall { time, step } => {
                write!(f, "the tolerances are not met at t = {time:?} s even by a step of {step:e} s")
            }
            Self::NonFiniteState { time } => {
                write!(f, "state or acceleration become infinite or NaN right after t = {time:?} s")
            }
            Self::Stopped { time, error } => write!(f, "stopped at t = {time:?} s: {error}"),
            Self::Constraint { time, error } => write!(f, "off the constraints at t = {time:?} s: {error}"),
            Self::NotConverged { time, iterations } => {
                write!(
                    f,
                    "the stages do not converge in {iterations} iterations at t = {time:?} s: a shorter step helps"
                )
            }
            Self::NonFiniteEvent { time, event } => {
                write!(f, "the function of event {event} is infinite or NaN right after t = {time:?} s")
            }
            Self::EventsAccumulate { time, event } => {
                write!(f, "event {event} follows itself ever closer and ends the motion at t = {time:?} s")
            }
            Self::TooManySteps { time, steps } => write!(f, "more than {steps} steps are needed at t = {time:?} s"),
        }
    }
}

impl<E: Error + 'static> Error for IntegrationError<E> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Stopped { error, .. } => Some(error),
            Self::Constraint { error, .. } => Some(error),
            _ => None,
        }
    }
}

/// A mass matrix that is not positive definite: a massless coordinate, coordinates that are singular in this place
/// (the poles of Euler angles), or an argument that is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SingularMassMatrix {
    /// The pivot of the factorization that is not positive beyond rounding, in the units of the mass matrix.
    pub pivot: f64,
    /// Its row, counted from 0: the first coordinate without inertia of its own.
    pub index: usize,
}

impl SingularMassMatrix {
    /// That this pivot, in the row of this coordinate, is not positive.
    #[must_use]
    pub const fn new(pivot: f64, index: usize) -> Self {
        Self { pivot, index }
    }
}

impl fmt::Display for SingularMassMatrix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "mass matrix is not positive definite: pivot {} is {:?} in the unit of its inertia",
            self.index, self.pivot
        )
    }
}

impl Error for SingularMassMatrix {}

/// Why no state satisfies the constraints.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConstraintError {
    /// The row stays open: no small change of the coordinates brings it closer to zero.
    Open {
        /// Which row, counted from 0 through all constraints.
        row: usize,
        /// What it is instead of zero, in its unit.
        residual: f64,
    },
    /// The row depends on the others: it restricts no motion that they do not.
    Redundant {
        /// Which row.
        row: usize,
    },
    /// The row depends on the others and asks for something else than they do.
    Contradiction {
        /// Which row.
        row: usize,
        /// What is left of it when the others are satisfied, in its unit.
        residual: f64,
    },
    /// A motion that the constraints leave has no inertia.
    SingularMassMatrix(SingularMassMatrix),
    /// A constraint or its derivative is infinite or NaN.
    NonFinite,
}

impl fmt::Display for ConstraintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Open { row, residual } => {
                write!(f, "row {row} of the constraints does not close: {residual:e} is left, in its unit")
            }
            Self::Redundant { row } => write!(f, "row {row} of the constraints depends on the others"),
            Self::Contradiction { row, residual } => {
                write!(
                    f,
                    "row {row} of the constraints depends on the others and contradicts them: {residual:e} is left, in its unit"
                )
            }
            Self::SingularMassMatrix(error) => write!(f, "on the motions that the constraints leave: {error}"),
            Self::NonFinite => f.write_str("a constraint or its derivative is infinite or NaN"),
        }
    }
}

impl Error for ConstraintError {}

/// Why a linearization cannot be reduced to the coordinates and speeds that were named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReductionError {
    /// There is no coordinate of this number, or it is named twice.
    InvalidCoordinate {
        /// Counted from 0.
        index: usize,
    },
    /// There is no speed of this number, or it is named twice.
    InvalidSpeed {
        /// Counted from 0.
        index: usize,
    },
    /// The constraints tie the coordinate to the others that are named.
    DependentCoordinate {
        /// Which coordinate.
        index: usize,
    },
    /// The constraints tie the speed to the others that are named.
    DependentSpeed {
        /// The coordinate that the speed is of.
        index: usize,
    },
    /// The coordinate is not named, and does not follow from those that are.
    FreeCoordinate {
        /// Which coordinate.
        index: usize,
    },
    /// The speed is not named, and does not follow from those that are.
    FreeSpeed {
        /// The coordinate that the speed is of.
        index: usize,
    },
    /// The row of the constraints depends on the others in this state alone: a singular one.
    RankChanges {
        /// Which row.
        row: usize,
    },
    /// A constraint's derivative is infinite or NaN.
    NonFinite,
}

impl fmt::Display for ReductionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::InvalidCoordinate { index } => write!(f, "coordinate {index} does not exist or is named twice"),
            Self::InvalidSpeed { index } => write!(f, "speed {index} does not exist or is named twice"),
            Self::DependentCoordinate { index } => {
                write!(f, "coordinate {index} follows from the others that are named as independent")
            }
            Self::DependentSpeed { index } => {
                write!(f, "speed {index} follows from the others that are named as independent")
            }
            Self::FreeCoordinate { index } => {
                write!(f, "coordinate {index} does not follow from those that are named as independent")
            }
            Self::FreeSpeed { index } => {
                write!(f, "speed {index} does not follow from those that are named as independent")
            }
            Self::RankChanges { row } => {
                write!(f, "row {row} of the constraints depends on the others here, but not in neighbouring states")
            }
            Self::NonFinite => f.write_str("a constraint's derivative is infinite or NaN"),
        }
    }
}

impl Error for ReductionError {}

/// A row of another length than the trajectory holds, or tables of different lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DimensionMismatch {
    /// The length it should have.
    pub expected: usize,
    /// The length it has.
    pub found: usize,
}

impl fmt::Display for DimensionMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {} numbers, found {}", self.expected, self.found)
    }
}

impl Error for DimensionMismatch {}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn messages_name_the_numbers() {
        let error: IntegrationError = IntegrationError::StepTooSmall { time: 1.5, step: 1e-17 };
        assert_eq!(error.to_string(), "the tolerances are not met at t = 1.5 s even by a step of 1e-17 s");
        let error = SingularMassMatrix { pivot: -2.0, index: 3 };
        let error = IntegrationError::Stopped { time: 0.0, error };
        assert_eq!(
            error.to_string(),
            "stopped at t = 0.0 s: mass matrix is not positive definite: pivot 3 is -2.0 in the unit of its inertia"
        );
        assert_eq!(
            SingularMassMatrix { pivot: 5e-17, index: 1 }.to_string(),
            "mass matrix is not positive definite: pivot 1 is 5e-17 in the unit of its inertia"
        );
        assert_eq!(error.time(), Some(0.0));
        let error: IntegrationError = IntegrationError::TooManySteps { time: 0.5, steps: 10 };
        assert_eq!(error.to_string(), "more than 10 steps are needed at t = 0.5 s");
        assert_eq!(IntegrationError::<Infallible>::InvalidStep { step: 0.0 }.time(), None);
    }
}
