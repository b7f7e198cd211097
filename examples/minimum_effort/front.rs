//! Two objectives: little time and little effort. The ε-constraint method: the least effort in each time.

use mbs_arm::trajectory::minimum_effort::{MinimumEffort, minimum_effort};
use mbs_models::Error;
use mbs_models::irb7600::Irb7600;
use mbs_runtime::Dual;

use super::*;
use crate::motion::transfer;

const INTERVALS: usize = 40;
/// Points of the front, both ends included.
const POINTS: usize = 13;
/// A time in which the arm arrives with ease, from which the search begins \[s\].
const EASY: f64 = 2.0;
/// Bisections for the shortest time, from what the speeds' limits alone would allow on.
const BISECTIONS: usize = 5;
/// Of H, at the end of the front.
const FLAT: f64 = 1e-5;

/// Motions of least effort, the fastest first; the last one has the least effort of all.
///
/// # Source
/// Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, *On a bicriterion formulation of the problems of integrated system
/// identification and system optimization*, IEEE Transactions on Systems, Man, and Cybernetics 1:3, 1971.
pub(crate) struct Front {
    motions: Vec<MinimumEffort<6, 6>>,
    /// Slower ones, which those of the front dominate.
    dominated: Vec<MinimumEffort<6, 6>>,
    /// For the shortest time that was found none was found that is shorter by this \[s\].
    gap: f64,
}

/// Time, effort, and the derivative of the effort by the time.
#[derive(Clone, Copy)]
pub(crate) struct Choice {
    pub(crate) duration: f64,
    pub(crate) effort: f64,
    pub(crate) slope: f64,
}

impl Choice {
    /// H in the middle of the motion, where it is known best.
    fn new(motion: &MinimumEffort<6, 6>) -> Self {
        let points = motion.points();
        Self {
            duration: points[points.len() - 1].t,
            effort: motion.effort(),
            slope: points[points.len() / 2].hamiltonian,
        }
    }
}

impl Front {
    pub(crate) fn new() -> Result<Self, Failure> {
        let arm = Irb7600::<Dual<f64>>::default();
        let within = |duration: f64, guess: Option<&MinimumEffort<6, 6>>| {
            minimum_effort(&arm, &transfer(duration), INTERVALS, guess)
        };
        let easy = within(EASY, None)?;
        let (fastest, gap) = fastest(&within, &easy)?;
        let calmest = calmest(&within, &easy)?;
        let [first, last] = [&fastest, &calmest].map(|motion| Choice::new(motion).duration);
        // Denser where time is short: there the front is steep.
        let time = |k: usize| first + (last - first) * (k as f64 / (POINTS - 1) as f64).powi(2);
        let mut motions = vec![calmest];
        for k in (1..POINTS - 1).rev() {
            let next = within(time(k), motions.last())?;
            motions.push(next);
        }
        motions.push(fastest);
        motions.reverse();
        let mut dominated: Vec<MinimumEffort<6, 6>> = Vec::new();
        for k in 1..=6 {
            let guess = dominated.last().or(motions.last());
            dominated.push(within(last + 0.1 * f64::from(k), guess)?);
        }
        Ok(Self { motions, dominated, gap })
    }

    pub(crate) fn choices(&self) -> Vec<Choice> {
        self.motions.iter().map(Choice::new).collect()
    }

    pub(crate) fn dominated(&self) -> Vec<Choice> {
        self.dominated.iter().map(Choice::new).collect()
    }

    pub(crate) fn to_json(&self) -> Value {
        let list = |choices: Vec<Choice>| {
            let row = |Choice { duration, effort, slope }: Choice| json!({ "duration": duration, "effort": effort, "slope": slope });
            choices.into_iter().map(row).collect::<Value>()
        };
        json!({
            "pareto": list(self.choices()),
            "dominated": list(self.dominated()),
            "shortest_time_within": self.gap,
            "iterations": self.motions.iter().map(MinimumEffort::iterations).collect::<Vec<_>>(),
        })
    }

    pub(crate) fn text(&self) -> Result<String, Failure> {
        let mut text = String::from("\nThe front of time and effort:\n   time [s]   effort [s]   dJ/dT = H\n");
        for Choice { duration, effort, slope } in self.choices() {
            writeln!(text, "{duration:11.4} {effort:12.6} {slope:11.5}")?;
        }
        writeln!(
            text,
            "In {:.4} s less no motion was found. More time than the last costs effort again: start and stop must be held up.",
            self.gap
        )?;
        Ok(text)
    }
}

type Found = Result<MinimumEffort<6, 6>, Error>;

/// The shortest time by bisection, between what the speeds' limits alone would allow and a time that is enough.
fn fastest(
    within: &impl Fn(f64, Option<&MinimumEffort<6, 6>>) -> Found,
    easy: &MinimumEffort<6, 6>,
) -> Result<(MinimumEffort<6, 6>, f64), Failure> {
    let transfer = transfer(EASY);
    let alone = |i: usize| (transfer.stop[0][i] - transfer.start[0][i]).abs() / transfer.limits.speed[i];
    let mut too_short = (0..6).map(alone).fold(0.0, f64::max);
    let mut best = easy.clone();
    let mut enough = EASY;
    for _ in 0..BISECTIONS {
        let duration = 0.5 * (too_short + enough);
        match within(duration, Some(&best)) {
            Ok(motion) => (best, enough) = (motion, duration),
            Err(Error { failure: mbs_models::Failure::NotConverged { .. }, .. }) => too_short = duration,
            Err(other) => return Err(other.into()),
        }
    }
    Ok((best, enough - too_short))
}

/// Where `H = dJ/dT` vanishes, by the secant method from a time nearby.
fn calmest(
    within: &impl Fn(f64, Option<&MinimumEffort<6, 6>>) -> Found,
    easy: &MinimumEffort<6, 6>,
) -> Result<MinimumEffort<6, 6>, Failure> {
    let mut before = Choice::new(easy);
    let mut motion = within(0.9 * EASY, Some(easy))?;
    for _ in 0..12 {
        let at = Choice::new(&motion);
        if at.slope.abs() < FLAT {
            return Ok(motion);
        }
        let next = at.duration - at.slope * (at.duration - before.duration) / (at.slope - before.slope);
        before = at;
        motion = within(next, Some(&motion))?;
    }
    Err(Failure::new("the time of least effort was not found"))
}
