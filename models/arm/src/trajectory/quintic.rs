//! One polynomial of degree five per joint: all six conditions.

use super::{ACCELERATION, JointState, POSITION, Piecewise, VELOCITY, quartic};
use mbs_models::{Error, Failure, check};

/// One quintic per joint, from `start` with the velocity `velocity` and no acceleration, to `stop` with neither.
///
/// From rest `q = start + D (10 s³ − 15 s⁴ + 6 s⁵)`, `s = t/T`. Arguments and errors are those of
/// [`quartic`](super::quartic()).
///
/// # Errors
/// As [`quartic`](super::quartic()).
pub fn quintic<const N: usize>(
    start: [f64; N],
    velocity: [f64; N],
    stop: [f64; N],
    duration: f64,
) -> Result<Piecewise<N, 1>, Error> {
    quartic::check(&start, &velocity, &stop, duration)?;
    quintic_between(&JointState { q: start, qd: velocity, qdd: [0.0; N] }, &JointState::at_rest(stop), duration)
}

/// One quintic per joint between two states of motion.
///
/// With `D = q₁ − q₀ − v₀T − a₀T²/2`, `E = (v₁ − v₀ − a₀T) T` and `F = (a₁ − a₀) T²`:
/// `q = q₀ + v₀T s + ½a₀T² s² + (10D − 4E + F/2) s³ + (7E − 15D − F) s⁴ + (6D − 3E + F/2) s⁵`.
///
/// # Errors
/// A duration that is not positive and finite, a number that is not finite, and two equal states at rest.
pub fn quintic_between<const N: usize>(
    start: &JointState<N>,
    stop: &JointState<N>,
    duration: f64,
) -> Result<Piecewise<N, 1>, Error> {
    check::positive("duration", duration)?;
    for state in [start, stop] {
        check::finite(POSITION, state.q)?;
        check::finite(VELOCITY, state.qd)?;
        check::finite(ACCELERATION, state.qdd)?;
    }
    if start == stop && *start == JointState::at_rest(start.q) {
        return Err(Failure::NoMotion.into());
    }
    Piecewise::new([duration], [core::array::from_fn(|i| coefficients(start, stop, i, duration))])
}

/// Those of joint `i`, over the part of the time that is over.
pub(super) fn coefficients<const N: usize>(
    start: &JointState<N>,
    stop: &JointState<N>,
    i: usize,
    duration: f64,
) -> [f64; 6] {
    let (v, a) = (start.qd[i] * duration, start.qdd[i] * duration * duration);
    let d = stop.q[i] - start.q[i] - v - 0.5 * a;
    let e = stop.qd[i] * duration - v - a;
    let f = stop.qdd[i] * duration * duration - a;
    [start.q[i], v, 0.5 * a, 10.0 * d - 4.0 * e + 0.5 * f, 7.0 * e - 15.0 * d - f, 6.0 * d - 3.0 * e + 0.5 * f]
}
