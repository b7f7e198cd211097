//! Where along a motion a function of the posture changes sign: the crossing of a singularity, of a plane, of a limit.

use super::{INTERVALS, Motion};
use mbs_models::{Error, Failure, check};

/// The times at which `function` of the joint angles changes sign along `motion`, in order \[s\].
///
/// The motion is looked at `intervals` equal intervals of time; a change of sign within one is found by bisection, to
/// the resolution of the clock. Two changes within one interval are not seen, nor is a zero without a change of sign.
///
/// ```
/// use mbs_arm::trajectory::{quintic, sign_change::sign_changes};
///
/// let motion = quintic([-1.0], [0.0], [1.0], 10.0)?;
/// let crossing: Vec<f64> = sign_changes(&motion, |q| q[0], 100)?.collect::<Result<_, _>>()?;
/// assert_eq!(crossing, [5.0]);
/// # Ok::<(), mbs_models::Error>(())
/// ```
///
/// # Errors
/// [`Failure::Invalid`] without intervals. The iterator gives [`Failure::NotFinite`]
/// where the function is infinite or NaN, and ends there.
pub fn sign_changes<const N: usize, M, F>(
    motion: M,
    function: F,
    intervals: usize,
) -> Result<SignChanges<N, M, F>, Error>
where
    M: Motion<N>,
    F: FnMut(&[f64; N]) -> f64,
{
    check::positive(INTERVALS, intervals as f64)?;
    Ok(SignChanges { motion, function, intervals, next: 0, last: None })
}

/// What [`sign_changes`] gives.
#[derive(Clone, Debug)]
pub struct SignChanges<const N: usize, M, F> {
    motion: M,
    function: F,
    intervals: usize,
    /// The next point of the grid; beyond `intervals` there is none.
    next: usize,
    /// The last time at which the function was not zero, and whether it was negative.
    last: Option<(f64, bool)>,
}

impl<const N: usize, M: Motion<N>, F: FnMut(&[f64; N]) -> f64> SignChanges<N, M, F> {
    fn value(&mut self, time: f64) -> Result<f64, Error> {
        let value = (self.function)(&self.motion.at(time)?.q);
        if value.is_finite() { Ok(value) } else { Err(Failure::NotFinite("the function").at_time(time)) }
    }

    /// Between a time with the sign given and one with the other.
    fn bisect(&mut self, (mut low, negative): (f64, bool), mut high: f64) -> Result<f64, Error> {
        loop {
            let middle = low + 0.5 * (high - low);
            if middle <= low || middle >= high {
                return Ok(middle);
            }
            let value = self.value(middle)?;
            if value == 0.0 {
                return Ok(middle);
            }
            if (value < 0.0) == negative {
                low = middle;
            } else {
                high = middle;
            }
        }
    }

    /// The sign at the next point of the grid, and the change since the last one.
    fn step(&mut self) -> Result<Option<f64>, Error> {
        let time = self.motion.duration() * (self.next as f64 / self.intervals as f64);
        self.next += 1;
        let value = self.value(time)?;
        if value == 0.0 {
            return Ok(None);
        }
        match self.last.replace((time, value < 0.0)) {
            Some(before) if before.1 != (value < 0.0) => self.bisect(before, time).map(Some),
            _ => Ok(None),
        }
    }
}

impl<const N: usize, M: Motion<N>, F: FnMut(&[f64; N]) -> f64> Iterator for SignChanges<N, M, F> {
    type Item = Result<f64, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        while self.next <= self.intervals {
            match self.step() {
                Ok(Some(time)) => return Some(Ok(time)),
                Ok(None) => {}
                Err(error) => {
                    self.next = self.intervals + 1;
                    return Some(Err(error));
                }
            }
        }
        None
    }
}
