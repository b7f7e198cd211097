//! What the members of an ensemble say together, and how sure that is.
//!
//! - [`Moments`]: mean and variance, value by value;
//! - [`quantile`], [`quantile_interval`]: quantiles, with bounds that assume nothing of the distribution;
//! - [`convergence`]: how the mean settles;
//! - [`sensitivity`]: which variable how much of the variance comes from;
//! - [`chaos`]: a quantity as a polynomial of few variables, by [`orthogonal`] ones;
//! - [`rare`]: probabilities of what hardly any member does.

pub mod chaos;
pub mod orthogonal;
pub mod rare;
pub mod sensitivity;

use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, StudentsT};

/// Mean and variance of values that are given one by one.
///
/// Source: B. P. Welford, *Note on a method for calculating corrected sums of squares and products*, Technometrics 4:3,
/// 1962.
///
/// ```
/// use mbs_ensemble::statistics::Moments;
/// let moments: Moments = [1.0, 2.0, 3.0].into_iter().collect();
/// assert_eq!((moments.count, moments.mean, moments.variance()), (3, 2.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// How many values.
    pub count: u64,
    /// Their mean.
    pub mean: f64,
    /// The sum of the squares of what they differ from the mean by.
    squares: f64,
}

impl Moments {
    /// One more value.
    pub fn push(&mut self, value: f64) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// The variance of what the values were drawn from, without bias; NaN of fewer than two values.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }

    /// The standard deviation.
    pub fn deviation(&self) -> f64 {
        self.variance().sqrt()
    }

    /// The bounds of the mean of what the values were drawn from independently, at this confidence, such as 0.95. They
    /// are those of Student's distribution: exact for normal values, and nearly so for many of any distribution. NaN
    /// for fewer than two.
    pub fn mean_interval(&self, confidence: f64) -> [f64; 2] {
        let student = StudentsT::new(0.0, 1.0, self.count.saturating_sub(1) as f64).ok();
        let factor = student.map_or(f64::NAN, |student| student.inverse_cdf(0.5 + confidence / 2.0));
        let half = factor * self.deviation() / (self.count as f64).sqrt();
        [self.mean - half, self.mean + half]
    }
}

/// Whether a variance is more than what rounding leaves of that of a constant.
fn varies(mean: f64, variance: f64) -> bool {
    const ROUNDING: f64 = 1e-12;
    variance.sqrt() > ROUNDING * mean.abs()
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Moments::default();
        values.into_iter().for_each(|value| moments.push(value));
        moments
    }
}

/// The quantile of values in ascending order, straight between neighbours; NaN of none.
///
/// Source: R. J. Hyndman and Y. Fan, *Sample quantiles in statistical packages*, The American Statistician 50:4, 1996,
/// definition 7.
pub fn quantile(sorted: &[f64], probability: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = probability.clamp(0.0, 1.0) * last as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// Two of the values in ascending order between which the quantile of what they were drawn from lies, at this
/// confidence, whatever its distribution; `None` where there are too few values to say so.
///
/// As many values lie below the quantile as a binomial distribution says.
///
/// Source: H. A. David and H. N. Nagaraja, *Order Statistics*, 3rd ed. 2003, section 7.1.
pub fn quantile_interval(sorted: &[f64], probability: f64, confidence: f64) -> Option<[f64; 2]> {
    let count = sorted.len() as u64;
    let below = Binomial::new(probability, count).ok()?;
    let tail = (1.0 - confidence) / 2.0;
    // P(X₍ᵢ₎ > q) = P(fewer than i lie below q); the smallest place with a probability of more than the tail.
    let least = below.inverse_cdf(tail);
    let greatest = below.inverse_cdf(1.0 - tail);
    // Where the tails do not fit on either side no value is a bound.
    let low = usize::try_from(least).ok()?.checked_sub(1)?;
    let high = usize::try_from(greatest).ok().filter(|&high| high < sorted.len())?;
    Some([sorted[low], sorted[high]])
}

/// The mean of the first values, at numbers of them that double, with its bounds at a confidence of 0.95.
///
/// ```
/// use mbs_ensemble::statistics::convergence;
/// let counts: Vec<u64> = convergence(&[1.0; 100]).iter().map(|moments| moments.count).collect();
/// assert_eq!(counts, [2, 4, 8, 16, 32, 64, 100]);
/// ```
pub fn convergence(values: &[f64]) -> Vec<Moments> {
    let mut moments = Moments::default();
    let mut steps = Vec::new();
    for (number, value) in (1_usize..).zip(values) {
        moments.push(*value);
        if number > 1 && (number.is_power_of_two() || number == values.len()) {
            steps.push(moments);
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use chacha20::rand_core::Rng;

    use super::*;
    use crate::distribution::standard;
    use crate::sequence::{Purpose, random, unit};

    #[test]
    fn quantiles_of_few_values() {
        let sorted = [1.0, 2.0, 4.0, 8.0];
        assert_eq!([0.0, 0.5, 1.0, 1.0 / 6.0].map(|p| quantile(&sorted, p)), [1.0, 3.0, 8.0, 1.5]);
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!(quantile_interval(&sorted, 0.5, 0.95), None);
    }

    /// Of the median of ten values the second and the ninth are bounds, at 97.85 %: David and Nagaraja, table 7.1.
    #[test]
    fn bounds_of_a_median_are_those_of_the_table() {
        let sorted: Vec<f64> = (1..=10).map(f64::from).collect();
        assert_eq!(quantile_interval(&sorted, 0.5, 0.95), Some([2.0, 9.0]));
    }

    /// They hold the true value as often as they say.
    #[test]
    fn intervals_cover_what_they_say() {
        let normal = |p: f64| standard().inverse_cdf(p);
        let (cases, mut mean, mut of_three, mut quantiles) = (2000, 0, 0, 0);
        for case in 0..cases {
            let mut random = random(1, Purpose::Whole, case);
            let mut values: Vec<f64> = (0..100).map(|_| normal(unit(random.next_u64()))).collect();
            let [low, high] = values.iter().copied().collect::<Moments>().mean_interval(0.9);
            mean += u32::from(low < 0.0 && 0.0 < high);
            let [low, high] = values.iter().copied().take(3).collect::<Moments>().mean_interval(0.9);
            of_three += u32::from(low < 0.0 && 0.0 < high);
            values.sort_by(f64::total_cmp);
            let [low, high] = quantile_interval(&values, 0.9, 0.9).unwrap();
            quantiles += u32::from(low < normal(0.9) && normal(0.9) < high);
        }
        // Four deviations of a count of 2000 with probability 0.9 are 54; order statistics cover more, by steps.
        assert!([mean, of_three].iter().all(|count| (1746..=1854).contains(count)), "{mean}, {of_three}");
        assert!((1746..=1940).contains(&quantiles), "{quantiles}");
    }
}
