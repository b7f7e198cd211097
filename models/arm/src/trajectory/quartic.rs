//! The quartics of the thesis: one, which leaves the last acceleration open, and two, which close it.

use super::{POSITION, Piecewise, VELOCITY};
use mbs_models::{Error, Failure, check};

/// One quartic per joint, from `start` with the velocity `velocity` and no acceleration, to rest at `stop` after
/// `duration`.
///
/// With `D = stop − start` and `s = t/T`: `q = start + v₀T s + (4D − 3 v₀T) s³ + (2 v₀T − 3D) s⁴`. Five coefficients
/// cannot honour six conditions: the acceleration at the stop is an output, `(6 v₀T − 12 D)/T²`.
///
/// | argument | meaning | unit |
/// |---|---|---|
/// | `start`, `stop` | postures at the ends | rad |
/// | `velocity` | velocities at the start | rad/s |
/// | `duration` | `T` | s |
///
/// # Errors
/// A duration that is not positive and finite, a number that is not finite, and start and stop that are equal with no
/// velocity at the start.
///
/// # Source
/// *Dynamics of multibody systems in a gravitational field*, section 3.6 and Table 2, which asks for zero acceleration
/// at the stop as well: [`two_piece_quartic`] and [`quintic`](super::quintic()) have it.
pub fn quartic<const N: usize>(
    start: [f64; N],
    velocity: [f64; N],
    stop: [f64; N],
    duration: f64,
) -> Result<Piecewise<N, 1>, Error> {
    check(&start, &velocity, &stop, duration)?;
    let coefficients = core::array::from_fn(|i| {
        let (d, v) = (stop[i] - start[i], velocity[i] * duration);
        [start[i], v, 0.0, 4.0 * d - 3.0 * v, 2.0 * v - 3.0 * d, 0.0]
    });
    Piecewise::new([duration], [coefficients])
}

/// "Start–move–stop": two quartics per joint that meet at half the time with three continuous derivatives, from `start`
/// with the velocity `velocity` and no acceleration, to `stop` with neither.
///
/// Ten conditions for ten coefficients. With `D = stop − start`, `V = v₀T/2`, `s = 2t/T` in the first half and `r = 2(1
/// − t/T)` in the second: `q = start + V s + (D − 5V/4) s³ + (9V/16 − D/2) s⁴`, then `q = stop + (3V/4 − D) r³ + (D/2 −
/// 7V/16) r⁴`. At rest the joint is at half the way at half the time, at twice its mean speed.
///
/// Arguments and errors are those of [`quartic`].
///
/// # Errors
/// As [`quartic`].
///
/// # Source
/// The conditions of section 3.6 of the thesis, taken literally.
pub fn two_piece_quartic<const N: usize>(
    start: [f64; N],
    velocity: [f64; N],
    stop: [f64; N],
    duration: f64,
) -> Result<Piecewise<N, 2>, Error> {
    check(&start, &velocity, &stop, duration)?;
    let parts = |i: usize| (stop[i] - start[i], 0.5 * velocity[i] * duration);
    let first = core::array::from_fn(|i| {
        let (d, v) = parts(i);
        [start[i], v, 0.0, d - 1.25 * v, 0.5625 * v - 0.5 * d, 0.0]
    });
    let second = core::array::from_fn(|i| {
        let (d, v) = parts(i);
        backwards(stop[i], 0.75 * v - d, 0.5 * d - 0.4375 * v)
    });
    Piecewise::new([0.5 * duration, duration], [first, second])
}

/// `q + c₃ r³ + c₄ r⁴` in powers of `s = 1 − r`.
pub(super) fn backwards(q: f64, c3: f64, c4: f64) -> [f64; 6] {
    [q + (c3 + c4), -(3.0 * c3 + 4.0 * c4), 3.0 * c3 + 6.0 * c4, -(c3 + 4.0 * c4), c4, 0.0]
}

/// What all polynomials from a posture to rest at another one need.
pub(super) fn check<const N: usize>(
    start: &[f64; N],
    velocity: &[f64; N],
    stop: &[f64; N],
    duration: f64,
) -> Result<(), Error> {
    check::positive("duration", duration)?;
    check::finite(POSITION, *start)?;
    check::finite(VELOCITY, *velocity)?;
    check::finite(POSITION, *stop)?;
    if start == stop && velocity.iter().all(|v| *v == 0.0) { Err(Failure::NoMotion.into()) } else { Ok(()) }
}
