//! Steps of fixed length.

use super::run::{Method, Next, Run};
use super::{Acceleration, Observer, Summary};
use crate::error::IntegrationError;
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// More steps than these are not allowed: beyond them whole numbers are not told apart.
const MOST_STEPS: u64 = 1 << 53;

/// That more steps are needed than are allowed.
pub(super) fn too_many<E>(time: f64, max_steps: usize) -> IntegrationError<E> {
    let most = usize::try_from(MOST_STEPS).unwrap_or(usize::MAX);
    IntegrationError::TooManySteps { time, steps: max_steps.min(most) }
}

/// What `t_end − t` may be off by where both times are rounded \[s\]: a sum of a product each. At most a hundredth of a
/// step, so that one stays one where the clock hardly tells its ends apart.
pub(crate) fn rounding_of_clock(t: f64, t_end: f64, step: f64) -> f64 {
    (2.0 * f64::EPSILON * t.abs().max(t_end.abs())).min(0.01 * step)
}

/// How many steps it takes from `t` to `t_end`.
pub(super) fn count(t: f64, t_end: f64, step: f64, allowed: usize) -> Option<usize> {
    // 0.3/0.1 is not 3, nor 1000.1 − 1000 a tenth: what is beyond a whole number by rounding alone makes no step of its
    // own.
    let duration = (t_end - t).abs();
    let ratio = (duration - rounding_of_clock(t, t_end, step)) / step * (1.0 - 4.0 * f64::EPSILON);
    // In 64 bits wherever this runs: 2^53 steps are more than a `usize` of 32 bits counts.
    let whole = ratio as u64;
    let steps = if (whole as f64) < ratio { whole.saturating_add(1) } else { whole.max(1) };
    let allowed = u64::try_from(allowed).unwrap_or(u64::MAX).min(MOST_STEPS);
    let steps = (steps <= allowed && duration.is_finite()).then_some(steps)?;
    usize::try_from(steps).ok()
}

/// An observer may cut steps short at most this many times within the time of one: what goes on that way does not end.
const MOST_CUTS: usize = 1_000_000;

/// Equal steps of `step` seconds or a little less, as many as needed, so that the last one ends at `t_end`; `max_steps`
/// of them at the most. They are longer than `step` by rounding alone, that of the clock included.
///
/// The length is the same number for all of them: the clock is rounded, a symplectic method's step is not.
pub(super) fn integrate<T, V, M, F>(
    (step, max_steps): (f64, usize),
    method: M,
    acceleration: F,
    t: f64,
    t_end: f64,
    state: &mut State<V>,
    observer: impl Observer<V, F::Error>,
) -> Result<Summary, IntegrationError<F::Error>>
where
    T: Scalar,
    V: Coordinates<Scalar = T>,
    M: Method<V, Error = ()>,
    F: Acceleration<V>,
{
    let mut run = Run::new(method, acceleration, t, t_end, state, observer)?;
    if step.is_nan() || step <= 0.0 {
        return Err(IntegrationError::InvalidStep { step });
    }
    run.summary.next_step = step;
    // How often steps were cut since the time `mark`.
    let (mut cuts, mut mark) = (0, t);
    while run.summary.time != t_end {
        let origin = run.summary.time;
        let Some(steps) = count(origin, t_end, step, max_steps - run.summary.accepted) else {
            return Err(too_many(origin, max_steps));
        };
        let h = (t_end - origin) / steps as f64;
        for i in 1..=steps {
            let start = run.summary.time;
            let end = if i == steps { t_end } else { origin + i as f64 * h };
            run.ready().and_then(|()| run.advance(h)).map_err(|fault| fault.at(start, h))?;
            match run.accept(end)? {
                Next::Step => {}
                Next::Again => {
                    let time = run.summary.time;
                    (cuts, mark) = if (time - mark).abs() < step { (cuts + 1, mark) } else { (0, time) };
                    if cuts > MOST_CUTS {
                        return Err(IntegrationError::TooManySteps { time, steps: run.summary.accepted });
                    }
                    break;
                }
                Next::Stop => return Ok(run.summary),
            }
        }
    }
    Ok(run.summary)
}

#[cfg(test)]
mod tests {
    use super::count;

    /// Whole steps are counted as such, wherever the motion begins.
    #[test]
    fn the_rounding_of_the_clock_makes_no_step() {
        let steps = |t, t_end, step| count(t, t_end, step, usize::MAX);
        assert_eq!(steps(1000.0, 1000.1, 0.1), Some(1));
        for step in [0.1, 0.05, 0.02, 0.01, 0.001, 1e-4] {
            for k in 0..10_000 {
                let (t, t_end) = (f64::from(k) * step, f64::from(k + 1) * step);
                assert_eq!((steps(t, t_end, step), steps(t_end, t, step)), (Some(1), Some(1)), "{k} of {step}");
            }
            for start in [1.0, 8.0, 10.0, 100.0, 399.0, -1000.0, 1e6, 1.7e9] {
                for n in [1, 2, 10, 99, 1000] {
                    let end = start + f64::from(n) * step;
                    assert_eq!(steps(start, end, step), Some(n as usize), "{n} of {step} from {start}");
                }
            }
        }
    }

    /// What is more than rounding is not stepped over, nor is a time that is longer than the clock's rounding.
    #[test]
    fn steps_are_no_longer_than_asked_for() {
        assert_eq!(count(0.0, 1.0, 0.3, 10), Some(4));
        assert_eq!(count(1000.0, 1000.1 + 1e-11, 0.1, 10), Some(2));
        assert_eq!(count(1e16, 1e16 + 2.0, 0.1, 100), Some(20));
        assert_eq!(count(0.0, 1.0, f64::MIN_POSITIVE, usize::MAX), None);
        assert_eq!(count(5.0, 5.0 + 1e-15, 0.1, 1), Some(1));
    }
}
