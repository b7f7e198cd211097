//! Motion near a station on a circle, linear: the equations of Hill, Clohessy and Wiltshire.
//!
//! ```text
//! ẍ − 2 n ẏ − 3 n² x = 0,   ÿ + 2 n ẋ = 0,   z̈ + n² z = 0,   n = √(μ/r³)
//! ```
//!
//! in the axes of [`lvlh`](super::lvlh): x away from the centre, y along the motion, z along the orbital angular
//! momentum.
//!
//! # Source
//! Clohessy, Wiltshire, *Terminal guidance system for satellite rendezvous*, Journal of the Aerospace Sciences
//! 27(9), 1960.

use super::universal::Universal;
use super::vector::{StateVector, Vector, transformed};
use mbs_models::{Error, Failure, check};

/// The state transition matrix: position, then velocity, `matrix[row][column]`.
///
/// | argument | meaning                    | unit  |
/// |----------|----------------------------|-------|
/// | `n`      | mean motion of the station | rad/s |
/// | `time`   | how far to go              | s     |
///
/// # Errors
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn state_transition(n: f64, time: f64) -> Result<[[f64; 6]; 6], Error> {
    check::positive("mean motion", n)?;
    check::finite("time", time)?;
    // With α = 1 the universal functions are cos, sin, 1 − cos and nt − sin, the last two without cancellation.
    let Universal { u0: c, u1: s, u2: versine, u3: lag } = Universal::at(n * time, 1.0);
    let matrix = [
        [1.0 + 3.0 * versine, 0.0, 0.0, s / n, 2.0 * versine / n, 0.0],
        [-6.0 * lag, 1.0, 0.0, -2.0 * versine / n, (s - 3.0 * lag) / n, 0.0],
        [0.0, 0.0, c, 0.0, 0.0, s / n],
        [3.0 * n * s, 0.0, 0.0, c, 2.0 * s, 0.0],
        [-6.0 * n * versine, 0.0, 0.0, -2.0 * s, 1.0 - 4.0 * versine, 0.0],
        [0.0, 0.0, -n * s, 0.0, 0.0, c],
    ];
    if matrix.iter().flatten().all(|x| x.is_finite()) { Ok(matrix) } else { Err(Failure::OutOfRange.into()) }
}

/// The state after a time.
///
/// | argument | meaning                    | unit   |
/// |----------|----------------------------|--------|
/// | `n`      | mean motion of the station | rad/s  |
/// | `state`  | in the station's frame     | m, m/s |
/// | `time`   | how far to go              | s      |
///
/// # Errors
/// [`Failure::Invalid`], [`Failure::OutOfRange`].
pub fn propagate(n: f64, state: &StateVector, time: f64) -> Result<StateVector, Error> {
    let matrix = state_transition(n, time)?;
    state.check()?;
    let end = transformed(&matrix, state);
    if end.is_finite() { Ok(end) } else { Err(Failure::OutOfRange.into()) }
}

/// A coast from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// Relative velocity at the beginning \[m/s\].
    pub departure: Vector,
    /// Relative velocity at the end \[m/s\].
    pub arrival: Vector,
}

/// What is not [determined](Failure::Undetermined) after whole revolutions, and some other times, the first 1.406 of a
/// revolution: the place within the orbital plane does not depend on some velocities then.
pub const IN_PLANE: &str = "the velocity to a place in the orbital plane";
/// What is not [determined](Failure::Undetermined) after half revolutions: the place across the orbital plane does not
/// depend on the velocity then.
pub const ACROSS: &str = "the velocity to a place across the orbital plane";

/// A determinant that is smaller than this part of the squares that it is made of is none.
const SINGULAR: f64 = 1e-9;

/// The velocities of the coast that leads from one place to another in a time.
///
/// Two impulses make it a transfer: from the velocity before to [`departure`](Transfer::departure), and from
/// [`arrival`](Transfer::arrival) to the one after.
///
/// | argument     | meaning                       | unit  |
/// |--------------|-------------------------------|-------|
/// | `n`          | mean motion of the station    | rad/s |
/// | `from`, `to` | places                        | m     |
/// | `time`       | from one to the other         | s     |
///
/// # Errors
/// [`Error`].
pub fn transfer(n: f64, from: &Vector, to: &Vector, time: f64) -> Result<Transfer, Error> {
    let phi = state_transition(n, time)?;
    check::positive("time", time)?;
    check::finite("from", *from)?;
    check::finite("to", *to)?;
    let coast: Vector = core::array::from_fn(|i| (0..3).map(|j| phi[i][j] * from[j]).sum());
    let missing = [to[0] - coast[0], to[1] - coast[1], to[2] - coast[2]];
    // | x |   | a  b | | u |
    // | y | = | −b d | | v |
    let (a, b, d) = (phi[0][3], phi[0][4], phi[1][4]);
    let determinant = a * d + b * b;
    if determinant.abs() <= SINGULAR * (a * a + b * b + d * d) {
        return Err(Failure::Undetermined(IN_PLANE).at_time(time));
    }
    let u = (d * missing[0] - b * missing[1]) / determinant;
    let v = (b * missing[0] + a * missing[1]) / determinant;
    let across = phi[2][5];
    let w = if across.abs() * n > SINGULAR {
        missing[2] / across
    } else if missing[2] == 0.0 {
        0.0
    } else {
        return Err(Failure::Undetermined(ACROSS).at_time(time));
    };
    let departure = [u, v, w];
    let end = transformed(&phi, &StateVector::new(*from, departure));
    // An overflow on the way to the velocity reaches the end.
    if end.is_finite() { Ok(Transfer { departure, arrival: end.velocity }) } else { Err(Failure::OutOfRange.into()) }
}
