//! Probabilities of what hardly any member does: subset simulation.
//!
//! What is rare is reached in steps each of which is not: of many points a tenth that comes nearest to failure is kept,
//! and from these chains lead to more points at least as near. The probability is the product of the tenths.
//!
//! Source: S.-K. Au and J. L. Beck, *Estimation of small failure probabilities in high dimensions by subset
//! simulation*, Probabilistic Engineering Mechanics 16, 2001; chains by I. Papaioannou, W. Betz, K. Zwirglmaier and
//! D. Straub, *MCMC algorithms for subset simulation*, Probabilistic Engineering Mechanics 41, 2015, section 3.3.

use chacha20::rand_core::Rng;
use statrs::distribution::ContinuousCDF;

use crate::distribution::standard;
use crate::sequence::{Purpose, random, unit};

/// How to look for what is rare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsetSimulation {
    /// How many standard normal numbers a point has; [`Distribution::at_deviate`](crate::Distribution::at_deviate)
    /// makes values of them.
    pub dimensions: usize,
    /// How many points a level has: a multiple of ten.
    pub points: usize,
    /// After how many levels it gives up: each is a tenth.
    pub most_levels: usize,
    /// What all random numbers come from.
    pub seed: u64,
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct RareEvent {
    /// The probability that the function is not positive.
    pub probability: f64,
    /// The standard deviation of the probability, relative to it. Points of a chain are counted as what they depend on
    /// each other, levels as independent.
    pub variation: f64,
    /// The values of the function that the levels reach; the last is 0 where failure was found.
    pub thresholds: Vec<f64>,
    /// How often the function was evaluated.
    pub evaluations: usize,
}

/// Of each level this part is kept.
const PART: f64 = 0.1;

/// How much of its place a chain keeps at a step: the correlation of neighbours.
const MEMORY: f64 = 0.8;

impl SubsetSimulation {
    /// The probability that a function of standard normal numbers is zero or negative: that it fails, where it is the
    /// distance from failure. Values that are not finite count as farthest from it. Without points or levels nothing is
    /// found: the probability is NaN, its variation infinite.
    ///
    /// ```
    /// use mbs_ensemble::statistics::rare::SubsetSimulation;
    /// let method = SubsetSimulation { dimensions: 2, points: 1000, most_levels: 10, seed: 1 };
    /// // Beyond four standard deviations: 3.2e-5.
    /// let rare = method.run(|z| 4.0 - (z[0] + z[1]) / 2.0_f64.sqrt());
    /// assert!((rare.probability / 3.17e-5).ln().abs() < 0.6 && rare.evaluations < 6000);
    /// ```
    pub fn run(&self, function: impl Fn(&[f64]) -> f64) -> RareEvent {
        if self.points == 0 || self.most_levels == 0 {
            let (probability, variation) = (f64::NAN, f64::INFINITY);
            return RareEvent { probability, variation, thresholds: Vec::new(), evaluations: 0 };
        }
        let kept = ((self.points as f64 * PART) as usize).max(1);
        let value = |z: &[f64]| Some(function(z)).filter(|value| value.is_finite()).unwrap_or(f64::INFINITY);
        // The points of a chain stand behind each other.
        let mut points: Vec<(Vec<f64>, f64)> = (0..self.points as u64)
            .map(|index| {
                let z = self.normal(0, index);
                let value = value(&z);
                (z, value)
            })
            .collect();
        let mut event =
            RareEvent { probability: 1.0, variation: 0.0, thresholds: Vec::new(), evaluations: self.points };
        let mut squares = 0.0;
        for level in 1..=self.most_levels as u64 {
            let mut sorted: Vec<f64> = points.iter().map(|(_, value)| *value).collect();
            sorted.sort_by(f64::total_cmp);
            let threshold = sorted[kept.min(sorted.len() - 1)].max(0.0);
            let is_last = threshold == 0.0 || level == self.most_levels as u64;
            let fails = |value: f64| if is_last { value <= 0.0 } else { value <= threshold };
            let chain = if level == 1 { 1 } else { self.points / kept };
            let count = points.iter().filter(|(_, value)| fails(*value)).count();
            let part = count as f64 / points.len() as f64;
            event.probability *= part;
            event.thresholds.push(if is_last { 0.0 } else { threshold });
            squares += variation(&points.iter().map(|(_, value)| fails(*value)).collect::<Vec<_>>(), chain).powi(2);
            if is_last || count == 0 {
                break;
            }
            points.retain(|(_, value)| fails(*value));
            points.truncate(kept);
            let steps = self.points / kept;
            let mut next = Vec::with_capacity(self.points);
            for (number, seed) in points.into_iter().enumerate() {
                let mut at = seed;
                for step in 0..steps {
                    let noise = self.normal(level, (number * steps + step) as u64);
                    let mix = |(z, noise): (&f64, f64)| MEMORY * z + (1.0 - MEMORY * MEMORY).sqrt() * noise;
                    let candidate: Vec<f64> = at.0.iter().zip(noise).map(mix).collect();
                    let found = value(&candidate);
                    event.evaluations += 1;
                    if found <= threshold {
                        at = (candidate, found);
                    }
                    next.push(at.clone());
                }
            }
            points = next;
        }
        event.variation = squares.sqrt();
        event
    }

    /// Standard normal numbers that depend on level and index alone.
    fn normal(&self, level: u64, index: u64) -> Vec<f64> {
        let mut random = random(self.seed, Purpose::Whole, level << 40 | index);
        (0..self.dimensions).map(|_| standard().inverse_cdf(unit(random.next_u64()))).collect()
    }
}

/// The relative deviation of the part of points that fail, in chains of this length one behind the other.
///
/// `δ² = (1 − p)/(p N) (1 + γ)`, `γ = 2 Σₖ (1 − k/L) ρₖ` with the correlation ρₖ of points k steps apart: Au and Beck
/// 2001, (27)–(29).
fn variation(fails: &[bool], length: usize) -> f64 {
    let count = fails.len() as f64;
    let part = fails.iter().filter(|fails| **fails).count() as f64 / count;
    if part == 0.0 || part == 1.0 {
        return if part == 0.0 { f64::INFINITY } else { 0.0 };
    }
    let correlation = |apart: usize| {
        let pairs = fails.chunks(length).flat_map(|chain| chain.iter().zip(chain.iter().skip(apart)));
        let (both, pairs) =
            pairs.fold((0.0, 0.0), |(both, pairs), (a, b)| (both + f64::from(u8::from(*a && *b)), pairs + 1.0));
        (both / pairs - part * part) / (part * (1.0 - part))
    };
    let gamma: f64 = (1..length).map(|k| 2.0 * (1.0 - k as f64 / length as f64) * correlation(k)).sum();
    ((1.0 - part) / (part * count) * (1.0 + gamma).max(0.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane at a distance β in many dimensions: Φ(−β), and as often off by a deviation as it says.
    #[test]
    fn planes_have_the_probability_of_their_distance() {
        let dimensions = 20;
        for beta in [2.0, 3.5, 4.75] {
            let exact = standard().cdf(-beta);
            let runs: Vec<RareEvent> = (0..40)
                .map(|seed| {
                    let method = SubsetSimulation { dimensions, points: 500, most_levels: 12, seed };
                    method.run(|z| beta - z.iter().sum::<f64>() / (dimensions as f64).sqrt())
                })
                .collect();
            let mean = runs.iter().map(|run| run.probability).sum::<f64>() / 40.0;
            let scatter = (runs.iter().map(|run| (run.probability - mean).powi(2)).sum::<f64>() / 39.0).sqrt() / mean;
            // Three deviations of the mean of forty runs.
            assert!((mean / exact - 1.0).abs() < 3.0 * scatter / 40.0_f64.sqrt() + 0.05, "{beta}: {mean:e} {exact:e}");
            let said = runs.iter().map(|run| run.variation).sum::<f64>() / 40.0;
            assert!((0.5..1.6).contains(&(said / scatter)), "{beta}: says {said}, is {scatter}");
            assert!(runs.iter().all(|run| run.thresholds.last() == Some(&0.0)));
        }
    }

    #[test]
    fn what_never_happens_has_no_probability() {
        let method = SubsetSimulation { dimensions: 1, points: 100, most_levels: 3, seed: 1 };
        let never = method.run(|_| 1.0);
        assert_eq!((never.probability, never.variation), (0.0, f64::INFINITY));
        assert_eq!(method.run(|_| f64::NAN).probability, 0.0);
        assert_eq!(method.run(|_| -1.0).probability, 1.0);
        for nothing in [SubsetSimulation { points: 0, ..method }, SubsetSimulation { most_levels: 0, ..method }] {
            let found = nothing.run(|_| 1.0);
            assert_eq!((found.probability.is_nan(), found.variation, found.evaluations), (true, f64::INFINITY, 0));
        }
    }
}
