//! True, eccentric, hyperbolic and mean anomaly.
//!
//! | conic     | anomaly in between                                | mean anomaly     | rate of the mean anomaly |
//! |-----------|---------------------------------------------------|------------------|--------------------------|
//! | ellipse   | `tan(E/2) = √((1−e)/(1+e)) tan(ν/2)`               | `E − e sin E`    | `√(μ/a³)`                |
//! | parabola  | `D = tan(ν/2)`                                     | `D + D³/3`       | `2 √(μ/p³)`              |
//! | hyperbola | `sinh H = √(e²−1) sin ν/(1 + e cos ν)`             | `e sinh H − H`   | `√(μ/|a|³)`              |
//!
//! e is the eccentricity, 0 or more. ν, E, H and the mean anomaly are in radians, a parabola's D and its mean anomaly
//! are numbers. All are zero at the nearest point. On an ellipse whole turns are kept. Near the parabola nothing
//! cancels: what is lost is a few times what rounding the anomaly given would change.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, sections 4.2 to 4.4.

use core::f64::consts::PI;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::integrals::product;
use super::kepler::{is_odd, rounded};
use super::universal::{Shape, Universal, asinh};

/// The parabola on which `s = D`: `√μ t = s/2 + s³/6` is half of the mean anomaly.
const PARABOLA: Shape = Shape { alpha: 0.0, q: 0.5, e: 1.0 };

/// What is left of π by its first double.
const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;

/// Beyond, an angle is not known to half a turn, and all anomalies are the same to the last place but one.
const WHOLE: f64 = 9_007_199_254_740_992.0;

/// An angle on an ellipse without its whole turns, carried over by a function, and the turns put back.
fn within_half_a_turn(angle: f64, function: impl FnOnce(f64) -> f64) -> f64 {
    carried(angle, 2.0 * rounded(angle / (2.0 * PI)), function)
}

/// An angle on an ellipse, carried over by a function of the eccentricity and of the angle from the nearer apsis.
///
/// All anomalies agree at the apsides; from the farther one the same equations hold with −e for e.
fn from_nearer_apsis(e: f64, angle: f64, function: impl FnOnce(f64, f64) -> f64) -> f64 {
    let half_turns = rounded(angle / PI);
    carried(angle, half_turns, |rest| function(if is_odd(half_turns) { -e } else { e }, rest))
}

/// The multiple of π is kept to twice the precision, so that what is left of the angle is as exact as the angle.
fn carried(angle: f64, half_turns: f64, function: impl FnOnce(f64) -> f64) -> f64 {
    if angle.abs() > WHOLE {
        return angle;
    }
    let whole = product(half_turns, PI);
    let low = whole.low + half_turns * PI_LOW;
    whole.high + (low + function(angle - whole.high - low))
}

/// The ellipse with a = 1 from its nearest point, with −e from its farthest one.
fn ellipse(e: f64) -> Shape {
    Shape { alpha: 1.0, q: 1.0 - e, e }
}

/// The hyperbola with a = −1.
fn hyperbola(e: f64) -> Shape {
    Shape { alpha: -1.0, q: e - 1.0, e }
}

/// Half of the angle at the centre for one of the foci, or with −e the reverse: `tan(E/2) = √((1−e)/(1+e)) tan(ν/2)`.
fn half_angle(e: f64, half: f64) -> f64 {
    let (sin, cos) = Scalar::sin_cos(half);
    Scalar::atan2(Scalar::sqrt(1.0 - e) * sin, Scalar::sqrt(1.0 + e) * cos)
}

fn check(e: f64, anomaly: f64) -> Result<(), Error> {
    check::not_negative("eccentricity", e)?;
    Ok(check::finite("anomaly", anomaly)?)
}

/// The true anomaly that an open orbit tends to \[rad\].
pub(super) fn asymptote(e: f64) -> f64 {
    2.0 * Scalar::atan2(Scalar::sqrt(e + 1.0), Scalar::sqrt(e - 1.0))
}

fn finite(anomaly: f64) -> Result<f64, Error> {
    if anomaly.is_finite() { Ok(anomaly) } else { Err(Failure::OutOfRange.into()) }
}

/// The anomaly in between of a true anomaly: E or H \[rad\], or D.
///
/// | argument       | meaning                 | unit |
/// |----------------|-------------------------|------|
/// | `e`            | eccentricity, 0 or more | 1    |
/// | `true_anomaly` | ν                       | rad  |
///
/// # Errors
/// [`Error`].
pub fn eccentric_from_true(e: f64, true_anomaly: f64) -> Result<f64, Error> {
    check(e, true_anomaly)?;
    if e < 1.0 {
        return Ok(within_half_a_turn(true_anomaly, |rest| 2.0 * half_angle(e, 0.5 * rest)));
    }
    let (less, more) = (Scalar::sqrt(e - 1.0), Scalar::sqrt(e + 1.0));
    let (sin, cos) = Scalar::sin_cos(0.5 * true_anomaly);
    // 1 + e cos ν, which is p/r, is the product of the two: so it does not cancel next to the parabola.
    let (near, far) = (more * cos - less * sin.abs(), more * cos + less * sin.abs());
    // Beyond half a turn cosines repeat themselves.
    if !(near > 0.0 && true_anomaly.abs() <= PI) {
        return Err(Must::BeLessThan(asymptote(e)).broken_by("|true_anomaly|", true_anomaly.abs()).into());
    }
    finite(if e > 1.0 {
        asinh(2.0 * (less * sin / near) * (more * cos / far))
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
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn true_from_eccentric(e: f64, anomaly: f64) -> Result<f64, Error> {
    check(e, anomaly)?;
    if e < 1.0 {
        return Ok(within_half_a_turn(anomaly, |rest| 2.0 * half_angle(-e, 0.5 * rest)));
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
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn mean_from_eccentric(e: f64, anomaly: f64) -> Result<f64, Error> {
    check(e, anomaly)?;
    let time = |shape: Shape, s: f64| shape.time(s, &Universal::at(s, shape.alpha));
    finite(if e < 1.0 {
        within_half_a_turn(anomaly, |rest| time(ellipse(e), rest))
    } else if e > 1.0 {
        time(hyperbola(e), anomaly)
    } else {
        anomaly + anomaly * anomaly * anomaly / 3.0
    })
}

/// E or H \[rad\], or D, of a mean anomaly: Kepler's equation, solved.
///
/// | argument | meaning                 | unit |
/// |----------|-------------------------|------|
/// | `e`      | eccentricity, 0 or more | 1    |
/// | `mean`   | mean anomaly            | rad  |
///
/// # Errors
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn eccentric_from_mean(e: f64, mean: f64) -> Result<f64, Error> {
    check(e, mean)?;
    finite(if e < 1.0 {
        from_nearer_apsis(e, mean, |e, rest| ellipse(e).place(rest).s)
    } else if e > 1.0 {
        hyperbola(e).place(mean).s
    } else {
        PARABOLA.place(0.5 * mean).s
    })
}

/// The mean anomaly \[rad\] of a true one.
///
/// | argument       | meaning                 | unit |
/// |----------------|-------------------------|------|
/// | `e`            | eccentricity, 0 or more | 1    |
/// | `true_anomaly` | ν                       | rad  |
///
/// # Errors
/// [`Error`].
pub fn mean_from_true(e: f64, true_anomaly: f64) -> Result<f64, Error> {
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
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn true_from_mean(e: f64, mean: f64) -> Result<f64, Error> {
    true_from_eccentric(e, eccentric_from_mean(e, mean)?)
}
