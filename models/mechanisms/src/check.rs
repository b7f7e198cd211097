//! What systems ask of the numbers that they are given, and the error that names the number that does not hold.
//!
//! ```
//! use mbs_models::check::{Invalid, Must, positive};
//!
//! assert_eq!(positive("mass", 2.0), Ok(()));
//! let error: Invalid = positive("mass", [2.0, -1.0]).unwrap_err();
//! assert_eq!((error.index, error.must), (Some(1), Must::BePositive));
//! assert_eq!(error.to_string(), "mass[1] must be positive, it is -1");
//! ```

use core::{error, fmt};

/// A number that a system does not work with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invalid {
    /// Its name.
    pub parameter: &'static str,
    /// Which of several, counted from 0.
    pub index: Option<usize>,
    /// Its value, in the unit that it was given in.
    pub value: f64,
    /// What does not hold.
    pub must: Must,
}

/// What a number must be; NaN is nothing of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Must {
    /// Neither infinite nor NaN.
    BeFinite,
    /// More than zero, and finite.
    BePositive,
    /// Zero or more, and finite.
    NotBeNegative,
    /// Neither less than the first nor more than the second.
    BeWithin([f64; 2]),
    /// This or more.
    BeAtLeast(f64),
    /// This or less.
    BeAtMost(f64),
    /// More than this.
    BeMoreThan(f64),
    /// Less than this.
    BeLessThan(f64),
}

impl Invalid {
    /// Says which one of several numbers it is, counted from 0.
    #[must_use]
    pub const fn of(self, index: usize) -> Self {
        Self { index: Some(index), ..self }
    }
}

impl Must {
    /// The error of a number for which this does not hold.
    #[must_use]
    pub const fn broken_by(self, parameter: &'static str, value: f64) -> Invalid {
        Invalid { parameter, index: None, value, must: self }
    }

    fn holds(self, value: f64) -> bool {
        match self {
            Self::BeFinite => value.is_finite(),
            Self::BePositive => value > 0.0 && value.is_finite(),
            Self::NotBeNegative => value >= 0.0 && value.is_finite(),
            Self::BeWithin([least, greatest]) => least <= value && value <= greatest,
            Self::BeAtLeast(least) => value >= least,
            Self::BeAtMost(most) => value <= most,
            Self::BeMoreThan(bound) => value > bound,
            Self::BeLessThan(bound) => value < bound,
        }
    }

    /// Refuses a number for which this does not hold.
    ///
    /// # Errors
    /// [`Invalid`], the first of these.
    pub fn check(self, parameter: &'static str, values: impl Numbers) -> Result<(), Invalid> {
        let values = values.numbers();
        match values.iter().position(|&value| !self.holds(value)) {
            Some(at) => {
                Err(Invalid { index: (values.len() > 1).then_some(at), ..self.broken_by(parameter, values[at]) })
            }
            None => Ok(()),
        }
    }
}

/// A number, or several under one name.
pub trait Numbers {
    /// All of them.
    fn numbers(&self) -> &[f64];
}

impl Numbers for f64 {
    fn numbers(&self) -> &[f64] {
        core::slice::from_ref(self)
    }
}

impl<const N: usize> Numbers for [f64; N] {
    fn numbers(&self) -> &[f64] {
        self
    }
}

/// Refuses what is not finite.
///
/// # Errors
/// [`Invalid`], the first that is not.
pub fn finite(parameter: &'static str, values: impl Numbers) -> Result<(), Invalid> {
    Must::BeFinite.check(parameter, values)
}

/// Refuses what is not positive and finite.
///
/// # Errors
/// [`Invalid`], the first that is not.
pub fn positive(parameter: &'static str, values: impl Numbers) -> Result<(), Invalid> {
    Must::BePositive.check(parameter, values)
}

/// Refuses what is negative or not finite.
///
/// # Errors
/// [`Invalid`], the first that is.
pub fn not_negative(parameter: &'static str, values: impl Numbers) -> Result<(), Invalid> {
    Must::NotBeNegative.check(parameter, values)
}

/// Refuses what is below the first bound, above the second, or NaN.
///
/// # Errors
/// [`Invalid`], the first that is.
pub fn within(parameter: &'static str, values: impl Numbers, range: [f64; 2]) -> Result<(), Invalid> {
    Must::BeWithin(range).check(parameter, values)
}

/// Refuses by one check what is given by name, one after the other.
///
/// # Errors
/// [`Invalid`], the first that the check refuses.
pub fn each(
    check: fn(&'static str, f64) -> Result<(), Invalid>,
    parameters: impl IntoIterator<Item = (&'static str, f64)>,
) -> Result<(), Invalid> {
    parameters.into_iter().try_for_each(|(parameter, value)| check(parameter, value))
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.parameter)?;
        if let Some(index) = self.index {
            write!(f, "[{index}]")?;
        }
        match self.must {
            Must::BeFinite => f.write_str(" must be finite")?,
            Must::BePositive if self.value.is_finite() => f.write_str(" must be positive")?,
            Must::BePositive => f.write_str(" must be positive and finite")?,
            Must::NotBeNegative if self.value.is_finite() => f.write_str(" must not be negative")?,
            Must::NotBeNegative => f.write_str(" must be finite and not negative")?,
            Must::BeWithin([least, greatest]) => write!(f, " must be between {least} and {greatest}")?,
            Must::BeAtLeast(least) => write!(f, " must be at least {least}")?,
            Must::BeAtMost(most) => write!(f, " must be at most {most}")?,
            Must::BeMoreThan(bound) => write!(f, " must be more than {bound}")?,
            Must::BeLessThan(bound) => write!(f, " must be less than {bound}")?,
        }
        write!(f, ", it is {}", self.value)
    }
}

impl error::Error for Invalid {}
