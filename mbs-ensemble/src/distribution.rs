//! Distributions, by their quantiles: so every sequence of points, correlated or not, is made into values one way.

use statrs::distribution::{ContinuousCDF, Normal, Triangular};

/// The distribution of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// All values of an interval alike.
    Uniform {
        /// The lowest value.
        low: f64,
        /// The highest value.
        high: f64,
    },
    /// Densities that rise and fall along straight lines.
    Triangular {
        /// The lowest value.
        low: f64,
        /// The most likely value.
        mode: f64,
        /// The highest value.
        high: f64,
    },
    /// Gauss' distribution.
    Normal {
        /// The mean.
        mean: f64,
        /// The standard deviation.
        deviation: f64,
    },
    /// Gauss' distribution of what lies within two bounds.
    TruncatedNormal {
        /// The mean before it is cut off.
        mean: f64,
        /// The standard deviation before it is cut off.
        deviation: f64,
        /// The lowest value.
        low: f64,
        /// The highest value.
        high: f64,
    },
    /// The logarithm has Gauss' distribution.
    Lognormal {
        /// Half of the values are below it.
        median: f64,
        /// The standard deviation of the logarithm.
        deviation: f64,
    },
}

/// Beyond this many deviations from the middle hardly anything of a normal distribution is left.
pub(crate) const FAR: f64 = 12.0;

impl Distribution {
    /// Why there is no such distribution, as the end of a sentence; `None` where there is one.
    pub fn refusal(&self) -> Option<&'static str> {
        let refused = |is_wrong: bool, reason| is_wrong.then_some(reason);
        if !self.is_finite() {
            return Some("all its numbers must be finite");
        }
        match *self {
            Distribution::Uniform { low, high } => refused(low >= high, "the lowest value must be below the highest"),
            Distribution::Triangular { low, mode, high } => refused(
                low >= high || mode < low || mode > high,
                "lowest, most likely and highest must be in this order",
            ),
            Distribution::Normal { deviation, .. } => refused(deviation <= 0.0, "the deviation must be positive"),
            Distribution::TruncatedNormal { deviation, .. } if deviation <= 0.0 => {
                Some("the deviation must be positive")
            }
            Distribution::TruncatedNormal { low, high, .. } if low >= high => {
                Some("the lowest value must be below the highest")
            }
            Distribution::TruncatedNormal { .. } => {
                let [_, within, _] = self.parts();
                refused(within < 1e-12, "hardly anything of the distribution lies within these bounds")
            }
            Distribution::Lognormal { median, deviation } => {
                refused(median <= 0.0 || deviation <= 0.0, "median and deviation must be positive")
            }
        }
    }

    /// Only what cuts off a normal distribution may be infinite.
    fn is_finite(&self) -> bool {
        match *self {
            Distribution::Uniform { low, high } => (high - low).is_finite(),
            Distribution::Triangular { low, mode, high } => (high - low).is_finite() && mode.is_finite(),
            Distribution::Normal { mean, deviation } => mean.is_finite() && deviation.is_finite(),
            Distribution::TruncatedNormal { mean, deviation, low, high } => {
                mean.is_finite() && deviation.is_finite() && !low.is_nan() && !high.is_nan()
            }
            Distribution::Lognormal { median, deviation } => median.is_finite() && deviation.is_finite(),
        }
    }

    /// The probabilities of what is cut off below, of what is left, and of what is cut off above of a normal
    /// distribution.
    fn parts(&self) -> [f64; 3] {
        let Distribution::TruncatedNormal { mean, deviation, low, high } = *self else { return [0.0, 1.0, 0.0] };
        // Φ of a negative number keeps its digits, 1 − Φ does not.
        let below = |value: f64| standard().cdf((value - mean) / deviation);
        let above = |value: f64| standard().cdf((mean - value) / deviation);
        let within = match (low > mean, high < mean) {
            (true, _) => above(low) - above(high),
            (_, true) => below(high) - below(low),
            (false, false) => 1.0 - below(low) - above(high),
        };
        [below(low), within, above(high)]
    }

    /// The value that is not exceeded with this probability, from 0 to 1, both excluded.
    ///
    /// ```
    /// use mbs_ensemble::Distribution;
    /// assert_eq!(Distribution::Uniform { low: 2.0, high: 4.0 }.quantile(0.25), 2.5);
    /// ```
    pub fn quantile(&self, probability: f64) -> f64 {
        self.between(probability, 1.0 - probability)
    }

    /// The value with these probabilities of what is lower and of what is higher.
    fn between(&self, probability: f64, rest: f64) -> f64 {
        match *self {
            Distribution::Uniform { low, high } => low + (high - low) * probability,
            Distribution::Triangular { low, mode, high } => {
                let unit = Triangular::new(0.0, 1.0, (mode - low) / (high - low));
                unit.map_or(f64::NAN, |unit| low + (high - low) * unit.inverse_cdf(probability))
            }
            Distribution::Normal { .. } | Distribution::Lognormal { .. } => {
                self.at_deviate(standard().inverse_cdf(probability))
            }
            Distribution::TruncatedNormal { mean, deviation, low, high } => {
                let [below, within, above] = self.parts();
                let (lower, higher) = (below + probability * within, above + rest * within);
                let deviate = standard().inverse_cdf(lower.min(higher));
                (mean + deviation * if lower < higher { deviate } else { -deviate }).clamp(low, high)
            }
        }
    }

    /// The value at as many standard deviations as a standard normal number has.
    pub fn at_deviate(&self, deviate: f64) -> f64 {
        match *self {
            Distribution::Normal { mean, deviation } => mean + deviation * deviate,
            Distribution::Lognormal { median, deviation } => median * (deviation * deviate).exp(),
            _ => self.between(standard().cdf(deviate), standard().cdf(-deviate)),
        }
    }

    /// The lowest and the highest value, infinite where there is none; where a normal distribution is cut off on one
    /// side, the other bound is 12 deviations from there, or from the mean.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        match *self {
            Distribution::Uniform { low, high } | Distribution::Triangular { low, high, .. } => [low, high],
            Distribution::TruncatedNormal { mean, deviation, low, high } => {
                let (middle, far) = (mean.max(low).min(high), FAR * deviation);
                let bound = |bound: f64, instead: f64| if bound.is_finite() { bound } else { instead };
                [bound(low, middle - far), bound(high, middle + far)]
            }
            Distribution::Normal { .. } | Distribution::Lognormal { .. } => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The value that a plain number stands for, on which polynomials are orthonormal: from −1 to 1 where the
    /// distribution has bounds, else as many deviations from the mean, or of the logarithm. Where a normal distribution
    /// is cut off on one side, what is 12 deviations from there, or from the mean, counts as the other bound.
    ///
    /// ```
    /// use mbs_ensemble::Distribution;
    /// let uniform = Distribution::Uniform { low: 2.0, high: 4.0 };
    /// assert_eq!((uniform.at_germ(-1.0), uniform.germ(3.5), uniform.slope_at_germ(0.0)), (2.0, 0.5, 1.0));
    /// ```
    pub fn at_germ(&self, germ: f64) -> f64 {
        let [low, high] = self.bounds();
        match *self {
            Distribution::Normal { .. } | Distribution::Lognormal { .. } => self.at_deviate(germ),
            Distribution::Uniform { .. } | Distribution::Triangular { .. } | Distribution::TruncatedNormal { .. } => {
                (low + high) / 2.0 + (high - low) / 2.0 * germ
            }
        }
    }

    /// The number that stands for a value: the inverse of [`at_germ`](Self::at_germ).
    pub fn germ(&self, value: f64) -> f64 {
        let [low, high] = self.bounds();
        match *self {
            Distribution::Normal { mean, deviation } => (value - mean) / deviation,
            Distribution::Lognormal { median, deviation } => (value / median).ln() / deviation,
            Distribution::Uniform { .. } | Distribution::Triangular { .. } | Distribution::TruncatedNormal { .. } => {
                (2.0 * value - low - high) / (high - low)
            }
        }
    }

    /// How much the value grows with the number that stands for it.
    pub fn slope_at_germ(&self, germ: f64) -> f64 {
        let [low, high] = self.bounds();
        match *self {
            Distribution::Normal { deviation, .. } => deviation,
            Distribution::Lognormal { deviation, .. } => deviation * self.at_germ(germ),
            Distribution::Uniform { .. } | Distribution::Triangular { .. } | Distribution::TruncatedNormal { .. } => {
                (high - low) / 2.0
            }
        }
    }
}

/// Mean 0, deviation 1.
pub(crate) fn standard() -> Normal {
    Normal::standard()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance by the midpoint rule over the quantiles.
    fn moments(distribution: Distribution) -> [f64; 2] {
        let n = 200_000;
        let values = (0..n).map(|i| distribution.quantile((f64::from(i) + 0.5) / f64::from(n)));
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        [mean, values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n)]
    }

    #[test]
    fn moments_are_those_of_the_formulas() {
        let check = |distribution, expected: [f64; 2]| {
            for (found, expected) in moments(distribution).into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 2e-4 * (1.0 + expected.abs()),
                    "{distribution:?}: {found} {expected}"
                );
            }
        };
        check(Distribution::Uniform { low: 1.0, high: 4.0 }, [2.5, 0.75]);
        let (a, c, b) = (1.0_f64, 2.0_f64, 5.0_f64);
        let variance = (a * a + b * b + c * c - a * b - a * c - b * c) / 18.0;
        check(Distribution::Triangular { low: a, mode: c, high: b }, [(a + b + c) / 3.0, variance]);
        check(Distribution::Triangular { low: 1.0, mode: 1.0, high: 4.0 }, [2.0, 0.5]);
        check(Distribution::Normal { mean: -1.0, deviation: 2.0 }, [-1.0, 4.0]);
        let s2 = 0.01_f64;
        let mean = 3.0 * (s2 / 2.0).exp();
        check(Distribution::Lognormal { median: 3.0, deviation: 0.1 }, [mean, mean * mean * (s2.exp() - 1.0)]);
        // One standard deviation on both sides: the variance is 1 − 2 φ(1) / (Φ(1) − Φ(−1)).
        let variance = 1.0 - 2.0 * 0.241_970_724_519_143_37 / 0.682_689_492_137_085_9;
        check(Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low: -1.0, high: 1.0 }, [0.0, variance]);
    }

    #[test]
    fn deviates_and_quantiles_agree() {
        let all = [
            Distribution::Uniform { low: 1.0, high: 4.0 },
            Distribution::Triangular { low: 1.0, mode: 2.0, high: 4.0 },
            Distribution::Lognormal { median: 3.0, deviation: 0.1 },
            Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low: 0.5, high: 1.0 },
        ];
        for distribution in all {
            assert_eq!(distribution.refusal(), None);
            for deviate in [-3.0, -0.5, 0.0, 1.0, 2.5] {
                let (a, b) = (distribution.at_deviate(deviate), distribution.quantile(standard().cdf(deviate)));
                assert!((a - b).abs() < 1e-9, "{distribution:?} {deviate}: {a} {b}");
            }
        }
    }

    /// `Φ(−x) = Φ(−a) (1 − p)` beyond a bound `a` alone, and its mirror image; by SciPy's `norm.isf`.
    #[test]
    fn tails_of_cut_off_distributions() {
        for (bound, p, expected) in [(7.0, 0.999, 7.9107), (7.0, 0.99999, 8.465), (6.0, 0.999_999_9, 8.2237)] {
            let (low, high) = (3.0 + 0.5 * bound, 3.0 - 0.5 * bound);
            let upper = Distribution::TruncatedNormal { mean: 3.0, deviation: 0.5, low, high: f64::INFINITY };
            let lower = Distribution::TruncatedNormal { mean: 3.0, deviation: 0.5, low: f64::NEG_INFINITY, high };
            for found in [(upper.quantile(p) - 3.0) / 0.5, (3.0 - lower.quantile(1.0 - p)) / 0.5] {
                assert!((found - expected).abs() < 1e-4 * expected, "{bound} {p}: {found} {expected}");
            }
            assert_eq!((upper.refusal(), lower.refusal()), (None, None));
        }
        // What is left of a whole one, with as many digits at both ends.
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let whole = Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low, high };
        for deviate in [-20.0, -1.0, 1.0, 20.0] {
            let found = whole.at_deviate(deviate);
            assert!((found - deviate).abs() < 1e-9, "{deviate}: {found}");
        }
    }

    #[test]
    fn impossible_distributions_are_refused() {
        let wrong = [
            Distribution::Uniform { low: 1.0, high: 1.0 },
            Distribution::Triangular { low: 1.0, mode: 5.0, high: 4.0 },
            Distribution::Normal { mean: 0.0, deviation: 0.0 },
            Distribution::Lognormal { median: -1.0, deviation: 0.1 },
            Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low: 30.0, high: 31.0 },
        ];
        assert!(wrong.iter().all(|distribution| distribution.refusal().is_some()));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let wrong = [
                Distribution::Uniform { low: bad, high: 1.0 },
                Distribution::Uniform { low: 1.0, high: bad },
                Distribution::Triangular { low: bad, mode: 0.0, high: 1.0 },
                Distribution::Triangular { low: 0.0, mode: bad, high: 1.0 },
                Distribution::Triangular { low: 0.0, mode: 1.0, high: bad },
                Distribution::Normal { mean: bad, deviation: 1.0 },
                Distribution::Normal { mean: 0.0, deviation: bad },
                Distribution::Lognormal { median: bad, deviation: 1.0 },
                Distribution::Lognormal { median: 1.0, deviation: bad },
                Distribution::TruncatedNormal { mean: bad, deviation: 1.0, low: -1.0, high: 1.0 },
                Distribution::TruncatedNormal { mean: 0.0, deviation: bad, low: -1.0, high: 1.0 },
            ];
            for distribution in wrong {
                assert_eq!(distribution.refusal(), Some("all its numbers must be finite"), "{distribution:?}");
            }
        }
        for (low, high) in [(f64::NAN, 1.0), (-1.0, f64::NAN), (f64::INFINITY, f64::INFINITY)] {
            let wrong = Distribution::TruncatedNormal { mean: 0.0, deviation: 1.0, low, high };
            assert!(wrong.refusal().is_some(), "{wrong:?}");
        }
    }
}
