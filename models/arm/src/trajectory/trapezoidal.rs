//! Trapezoidal speed: constant acceleration, constant speed, constant deceleration.

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::{POSITION, Piecewise, RateLimits, quartic};

/// All joints on a straight line from rest at `start` to rest at `stop`, speeding up for `acceleration_time` \[s\], at
/// constant speed, and slowing down for as long.
///
/// The part of the way covered is `s = t²/(2 ta (T − ta))` while accelerating. With `ta = T/2` the speed is a triangle.
///
/// # Errors
/// A duration that is not positive and finite, an acceleration time that is not within `0 < ta ≤ T/2`, an angle that is
/// not finite, and equal postures.
pub fn trapezoidal<const N: usize>(
    start: [f64; N],
    stop: [f64; N],
    duration: f64,
    acceleration_time: f64,
) -> Result<Piecewise<N, 3>, Error> {
    quartic::check(&start, &[0.0; N], &stop, duration)?;
    check::positive("time of acceleration", acceleration_time)?;
    Must::BeAtMost(0.5 * duration).check("time of acceleration", acceleration_time)?;
    let cruise = duration - 2.0 * acceleration_time;
    // Parts of the way: half of one in each ramp of unit speed.
    let whole = cruise + acceleration_time;
    let (ramp, even) = (0.5 * acceleration_time / whole, cruise / whole);
    let piece = |curve: &dyn Fn(f64, f64, f64) -> [f64; 6]| {
        core::array::from_fn(|i| curve(start[i], stop[i], stop[i] - start[i]))
    };
    Piecewise::new(
        [acceleration_time, duration - acceleration_time, duration],
        [
            piece(&|start, _, d| [start, 0.0, d * ramp, 0.0, 0.0, 0.0]),
            piece(&|start, _, d| [start + d * ramp, d * even, 0.0, 0.0, 0.0, 0.0]),
            piece(&|_, stop, d| [stop - d * ramp, 2.0 * d * ramp, -d * ramp, 0.0, 0.0, 0.0]),
        ],
    )
}

/// The fastest motion with trapezoidal speed along a straight line in the joints' space, all of them in step.
///
/// The way is the same part of each joint's at any time, so that its speed `ṡ ≤ minᵢ vᵢ/|Dᵢ|` and its acceleration
/// `s̈ ≤ minᵢ aᵢ/|Dᵢ|` are those of the joint that is slowest for its way.
///
/// # Errors
/// Limits that are not positive (an infinite one is none, but one joint that moves must have a limit of acceleration),
/// an angle that is not finite, and equal postures.
pub fn trapezoidal_within<const N: usize>(
    start: [f64; N],
    stop: [f64; N],
    limits: &RateLimits<N>,
) -> Result<Piecewise<N, 3>, Error> {
    check::finite(POSITION, start)?;
    check::finite(POSITION, stop)?;
    limits.check()?;
    let least = |limits: &[f64; N]| {
        let ways = start.iter().zip(&stop).zip(limits);
        // A joint that stands has 0/0 where it has no limit either.
        let rates = ways.filter(|((from, to), _)| from != to).map(|((from, to), limit)| limit / (to - from).abs());
        rates.fold(f64::INFINITY, f64::min)
    };
    if start == stop {
        return Err(Failure::NoMotion.into());
    }
    let (speed, acceleration) = (least(&limits.speed), least(&limits.acceleration));
    if acceleration == f64::INFINITY {
        let joint = (0..N).find(|&i| start[i] != stop[i]).unwrap_or(0);
        return Err(Must::BeFinite.broken_by("largest acceleration", limits.acceleration[joint]).of(joint).into());
    }
    // At full speed after v/a; a triangle where half the way is too short for it.
    let acceleration_time = f64::min(speed / acceleration, Scalar::sqrt(1.0 / acceleration));
    let duration = acceleration_time + 1.0 / (acceleration * acceleration_time);
    trapezoidal(start, stop, duration, f64::min(acceleration_time, 0.5 * duration))
}
