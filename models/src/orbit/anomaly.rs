//! True, eccentric, hyperbolic and mean anomaly.
//!
//! | conic     | anomaly in between                                | mean anomaly     | rate of the mean anomaly |
//! |-----------|---------------------------------------------------|------------------|--------------------------|
//! | ellipse   | `tan(E/2) = √((1−e)/(1+e)) tan(ν/2)`               | `E − e sin E`    | `√(μ/a³)`                |
//! | parabola  | `D = tan(ν/2)`                                     | `D + D³/3`       | `2 √(μ/p³)`              |
//! | hyperbola | `sinh H = √(e²−1) sin ν/(1 + e cos ν)`             | `e sinh H − H`   | `√(μ/|a|³)`              |
//!
//! e is the eccentricity, 0 or more. ν, E, H and the mean anomaly are in radians, a parabola's D and its mean anomaly are numbers.
//! All are zero at the nearest point. On an ellipse whole turns are kept. Near the parabola nothing cancels.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, sections 4.2 to 4.4.

use core::f64::consts::PI;
use core::fmt;

use mbs_runtime::Scalar;

use super::universal::{Shape, Universal, asinh};

/// Why there is no such anomaly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnomalyError {
    /// The eccentricity is negative, infinite or no number.
    Eccentricity {
        /// Its value \[1\].
        e: f64,
    },
    /// The anomaly is infinite or no number.
    NotFinite {
        /// Its value \[rad\]; a parabola's D has no unit.
        anomaly: f64,
    },
    /// A parabola or hyperbola does not reach this true anomaly.
    BeyondAsymptote {
        /// The true anomaly \[rad\].
        true_anomaly: f64,
        /// Less than this, either way \[rad\].
        limit: f64,
    },
    /// What was asked for is too large for `f64`.
    OutOfRange,
}

impl fmt::Display for AnomalyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AnomalyError::Eccentricity { e } => {
                write!(f, "the eccentricity must be zero or positive and finite, it is {e}")
            }
            AnomalyError::NotFinite { anomaly } => write!(f, "the anomaly must be finite, it is {anomaly}"),
            AnomalyError::BeyondAsymptote { true_anomaly, limit } => {
                write!(f, "the true anomaly {true_anomaly} rad is not within ±{limit} rad, where the asymptotes are")
            }
            AnomalyError::OutOfRange => write!(f, "the anomaly leaves the range of floating-point numbers"),
        }
    }
}

impl core::error::Error for AnomalyError {}

/// The conic of this eccentricity with `|a| = 1`, or q = 1 for a parabola.
fn shape(e: f64) -> Shape {
    if e < 1.0 {
        Shape { alpha: 1.0, q: 1.0 - e, e }
    } else if e > 1.0 {
        Shape { alpha: -1.0, q: e - 1.0, e }
    } else {
        Shape { alpha: 0.0, q: 1.0, e }
    }
}

/// For a parabola q = 1 has `√μ t = s + s³/6` with `s = √2 D`.
const ROOT_2: f64 = core::f64::consts::SQRT_2;

/// Whole turns of an angle \[rad\], and what is left, within half a turn.
fn turns(angle: f64) -> (f64, f64) {
    let whole = 2.0 * PI * super::kepler::rounded(angle / (2.0 * PI));
    (whole, angle - whole)
}

fn check(e: f64, anomaly: f64) -> Result<(), AnomalyError> {
    if !(e >= 0.0 && e.is_finite()) {
        Err(AnomalyError::Eccentricity { e })
    } else if !anomaly.is_finite() {
        Err(AnomalyError::NotFinite { anomaly })
    } else {
        Ok(())
    }
}

fn finite(anomaly: f64) -> Result<f64, AnomalyError> {
    if anomaly.is_finite() { Ok(anomaly) } else { Err(AnomalyError::OutOfRange) }
}

/// The anomaly in between of a true anomaly: E or H \[rad\], or D.
///
/// | argument       | meaning                 | unit |
/// |----------------|-------------------------|------|
/// | `e`            | eccentricity, 0 or more | 1    |
/// | `true_anomaly` | ν                       | rad  |
///
/// # Errors
/// [`AnomalyError`].
pub fn eccentric_from_true(e: f64, true_anomaly: f64) -> Result<f64, AnomalyError> {
    check(e, true_anomaly)?;
    if e < 1.0 {
        let (whole, rest) = turns(true_anomaly);
        let (sin, cos) = Scalar::sin_cos(0.5 * rest);
        return Ok(whole + 2.0 * Scalar::atan2(Scalar::sqrt(1.0 - e) * sin, Scalar::sqrt(1.0 + e) * cos));
    }
    let limit = Scalar::acos(-1.0 / e);
    let (sin, cos) = Scalar::sin_cos(true_anomaly);
    // As 1 + e cos ν, which is p/r; beyond half a turn cosines repeat themselves.
    let ratio = 1.0 + e * cos;
    if !(ratio > 0.0 && true_anomaly.abs() < limit) {
        return Err(AnomalyError::BeyondAsymptote { true_anomaly, limit });
    }
    finite(if e > 1.0 {
        // A product of roots: of squares of large numbers there is none.
        asinh(Scalar::sqrt(e - 1.0) * Scalar::sqrt(e + 1.0) * sin / ratio)
    } else {
        Scalar::tan(0.5 * true_anomaly)
    })
}

/// The true anomaly \[rad\] of E, D or H.
///
/// | argument  | meaning                 | unit |
/// |-----------|-------------------------|------|
/// | `e`       | eccentricity, 0 or more | 1    |
/// | `anomaly` | E, D or H               | rad  |
///
/// # Errors
/// [`AnomalyError`], not [`BeyondAsymptote`](AnomalyError::BeyondAsymptote).
pub fn true_from_eccentric(e: f64, anomaly: f64) -> Result<f64, AnomalyError> {
    check(e, anomaly)?;
    if e < 1.0 {
        let (whole, rest) = turns(anomaly);
        let (sin, cos) = Scalar::sin_cos(0.5 * rest);
        return Ok(whole + 2.0 * Scalar::atan2(Scalar::sqrt(1.0 + e) * sin, Scalar::sqrt(1.0 - e) * cos));
    }
    let tangent = if e > 1.0 { Scalar::sqrt((e + 1.0) / (e - 1.0)) * Scalar::tanh(0.5 * anomaly) } else { anomaly };
    Ok(2.0 * Scalar::atan(tangent))
}

/// The mean anomaly \[rad\] of E, D or H.
///
/// | argument  | meaning                 | unit |
/// |-----------|-------------------------|------|
/// | `e`       | eccentricity, 0 or more | 1    |
/// | `anomaly` | E, D or H               | rad  |
///
/// # Errors
/// [`AnomalyError`], not [`BeyondAsymptote`](AnomalyError::BeyondAsymptote).
pub fn mean_from_eccentric(e: f64, anomaly: f64) -> Result<f64, AnomalyError> {
    check(e, anomaly)?;
    let shape = shape(e);
    if e == 1.0 {
        return finite(anomaly + anomaly * anomaly * anomaly / 3.0);
    }
    let (whole, rest) = if e < 1.0 { turns(anomaly) } else { (0.0, anomaly) };
    finite(whole + shape.time(rest, &Universal::at(rest, shape.alpha)))
}

/// E or H \[rad\], or D, of a mean anomaly: Kepler's equation, solved.
///
/// | argument | meaning                 | unit |
/// |----------|-------------------------|------|
/// | `e`      | eccentricity, 0 or more | 1    |
/// | `mean`   | mean anomaly            | rad  |
///
/// # Errors
/// [`AnomalyError`], not [`BeyondAsymptote`](AnomalyError::BeyondAsymptote).
pub fn eccentric_from_mean(e: f64, mean: f64) -> Result<f64, AnomalyError> {
    check(e, mean)?;
    let shape = shape(e);
    if e == 1.0 {
        return finite(shape.place(ROOT_2 * mean).s / ROOT_2);
    }
    let (whole, rest) = if e < 1.0 { turns(mean) } else { (0.0, mean) };
    finite(whole + shape.place(rest).s)
}

/// The mean anomaly \[rad\] of a true one.
///
/// | argument       | meaning                 | unit |
/// |----------------|-------------------------|------|
/// | `e`            | eccentricity, 0 or more | 1    |
/// | `true_anomaly` | ν                       | rad  |
///
/// # Errors
/// [`AnomalyError`].
pub fn mean_from_true(e: f64, true_anomaly: f64) -> Result<f64, AnomalyError> {
    mean_from_eccentric(e, eccentric_from_true(e, true_anomaly)?)
}

/// The true anomaly \[rad\] of a mean one.
///
/// | argument | meaning                 | unit |
/// |----------|-------------------------|------|
/// | `e`      | eccentricity, 0 or more | 1    |
/// | `mean`   | mean anomaly            | rad  |
///
/// # Errors
/// [`AnomalyError`], not [`BeyondAsymptote`](AnomalyError::BeyondAsymptote).
pub fn true_from_mean(e: f64, mean: f64) -> Result<f64, AnomalyError> {
    true_from_eccentric(e, eccentric_from_mean(e, mean)?)
}
