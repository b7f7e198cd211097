//! Two objectives, little time and little effort, by the ε-constraint method: the least effort in each time.
//!
//! # Source
//! Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, *On a bicriterion formulation of the problems of integrated system
//! identification and system optimization*, IEEE Transactions on Systems, Man, and Cybernetics 1:3, 1971.

use std::vec;
use std::vec::Vec;

use mbs_models::check::Must;
use mbs_models::{Error, Failure};
use mbs_runtime::{Dual, Mechanism};

use super::{MinimumEffort, Transfer, minimum_effort};

/// Motions of least effort, the fastest first; the last one has the least effort of all.
#[derive(Clone, Debug)]
pub struct Front<const N: usize, const U: usize> {
    /// None of them is better than another in both.
    pub motions: Vec<MinimumEffort<N, U>>,
    /// Slower ones, which those of the front dominate.
    pub dominated: Vec<MinimumEffort<N, U>>,
    /// For the shortest time that was found none was found that is shorter by this \[s\].
    pub gap: f64,
}

/// Time, effort, and the derivative of the effort by the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// T \[s\]
    pub duration: f64,
    /// J \[s\]
    pub effort: f64,
    /// `dJ/dT = H`
    pub slope: f64,
}

impl Choice {
    /// H in the middle of the motion, where it is known best.
    #[must_use]
    pub fn of<const N: usize, const U: usize>(motion: &MinimumEffort<N, U>) -> Self {
        let points = motion.points();
        let (end, middle) = (&points[points.len() - 1], &points[points.len() / 2]);
        Self { duration: end.t, effort: motion.effort(), slope: middle.hamiltonian }
    }
}

/// How a front is searched.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Intervals of each motion.
    pub intervals: usize,
    /// Points of the front, both ends included; three at least.
    pub points: usize,
    /// Bisections for the shortest time, from what the speeds' limits alone would allow on.
    pub bisections: usize,
    /// What counts as zero of H, at the end of the front.
    pub flat: f64,
}

impl Search {
    /// The front between the states of a transfer whose duration is one in which it is done with ease.
    ///
    /// # Errors
    /// [`Error`] of [`minimum_effort`]; `Invalid` for fewer than three points; `NotConverged` where H does not vanish.
    pub fn front<const N: usize, const U: usize>(
        &self,
        mechanism: &impl Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
        transfer: &Transfer<N, U>,
    ) -> Result<Front<N, U>, Error> {
        Must::BeAtLeast(3.0).check("points", self.points as f64)?;
        let within = |duration: f64, guess: Option<&MinimumEffort<N, U>>| {
            minimum_effort(mechanism, &Transfer { duration, ..*transfer }, self.intervals, guess)
        };
        let easy = within(transfer.duration, None)?;
        let (fastest, gap) = self.fastest(&within, &easy, transfer)?;
        let calmest = self.calmest(&within, &easy, transfer.duration)?;
        let [first, last] = [&fastest, &calmest].map(|motion| Choice::of(motion).duration);
        // Denser where time is short: there the front is steep.
        let part = |k: usize| k as f64 / (self.points - 1) as f64;
        let time = |k: usize| first + (last - first) * (part(k) * part(k));
        let mut motions = vec![calmest];
        for k in (1..self.points - 1).rev() {
            let next = within(time(k), motions.last())?;
            motions.push(next);
        }
        motions.push(fastest);
        motions.reverse();
        let mut dominated: Vec<MinimumEffort<N, U>> = Vec::new();
        for k in 1..=6 {
            let guess = dominated.last().or(motions.last());
            dominated.push(within(last + 0.1 * f64::from(k), guess)?);
        }
        Ok(Front { motions, dominated, gap })
    }

    /// The shortest time by bisection, between what the speeds' limits alone would allow and a time that is enough.
    fn fastest<const N: usize, const U: usize>(
        &self,
        within: &impl Fn(f64, Option<&MinimumEffort<N, U>>) -> Result<MinimumEffort<N, U>, Error>,
        easy: &MinimumEffort<N, U>,
        transfer: &Transfer<N, U>,
    ) -> Result<(MinimumEffort<N, U>, f64), Error> {
        let alone = |i: usize| (transfer.stop[0][i] - transfer.start[0][i]).abs() / transfer.limits.speed[i];
        let mut too_short = (0..N).map(alone).fold(0.0, f64::max);
        let (mut best, mut enough) = (easy.clone(), transfer.duration);
        for _ in 0..self.bisections {
            let duration = 0.5 * (too_short + enough);
            match within(duration, Some(&best)) {
                Ok(motion) => (best, enough) = (motion, duration),
                Err(Error { failure: Failure::NotConverged { .. }, .. }) => too_short = duration,
                Err(other) => return Err(other),
            }
        }
        Ok((best, enough - too_short))
    }

    /// Where `H = dJ/dT` vanishes, by the secant method from a time nearby.
    fn calmest<const N: usize, const U: usize>(
        &self,
        within: &impl Fn(f64, Option<&MinimumEffort<N, U>>) -> Result<MinimumEffort<N, U>, Error>,
        easy: &MinimumEffort<N, U>,
        duration: f64,
    ) -> Result<MinimumEffort<N, U>, Error> {
        let mut before = Choice::of(easy);
        let mut motion = within(0.9 * duration, Some(easy))?;
        let mut iterations = 0;
        while iterations < STEPS {
            iterations += 1;
            let at = Choice::of(&motion);
            if at.slope.abs() < self.flat {
                return Ok(motion);
            }
            let next = at.duration - at.slope * (at.duration - before.duration) / (at.slope - before.slope);
            before = at;
            // Where slopes hardly differ, the secant leads anywhere.
            if !(next > 0.0 && next.is_finite()) {
                break;
            }
            motion = within(next, Some(&motion))?;
        }
        let what = "the search of the time of least effort";
        Err(Failure::NotConverged { what, iterations, residual: before.slope.abs(), unit: "of dJ/dT" }.into())
    }
}

/// Steps of the secant method at most.
const STEPS: usize = 12;
