//! What is said of a record of a motion or of a sea.

use mbs_runtime::Scalar;

/// What is said of a record with equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// The mean value.
    pub mean: f64,
    /// Standard deviation.
    pub rms: f64,
    /// The greatest deviation from the mean.
    pub greatest: f64,
    /// Mean time between two upward crossings of the mean, in steps; NaN where it crosses less than twice.
    pub crossing: f64,
}

impl Statistics {
    /// What is said of these values.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let rms = Scalar::sqrt(values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / count);
        let greatest = values.iter().fold(0.0_f64, |most, value| most.max((value - mean).abs()));
        let pairs = values.windows(2).enumerate();
        let mut crossings = pairs.filter(|(_, pair)| pair[0] < mean && pair[1] >= mean).map(|(k, _)| k as f64);
        let first = crossings.next().unwrap_or(0.0);
        let (between, last) = crossings.fold((0.0, first), |(count, _), last| (count + 1.0, last));
        Statistics { mean, rms, greatest, crossing: (last - first) / between }
    }

    /// Of a normal process the mean of the greatest third of the double amplitudes, about.
    #[must_use]
    pub fn significant_double_amplitude(&self) -> f64 {
        4.0 * self.rms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_its_period_and_its_amplitude() {
        let values: [f64; 1000] =
            core::array::from_fn(|k| 3.0 + 2.0 * Scalar::sin(core::f64::consts::TAU * (k as f64 + 0.5) / 50.0));
        let found = Statistics::of(&values);
        assert!((found.mean - 3.0).abs() < 1e-12 && (found.rms - 2.0_f64.sqrt()).abs() < 1e-12);
        assert!((found.greatest - 2.0).abs() < 0.01 && (found.crossing - 50.0).abs() < 1e-12);
        assert!(Statistics::of(&[1.0, 2.0]).crossing.is_nan());
    }
}
