//! Bounds of the χ² distribution.
//!
//! # Source
//! E. B. Wilson and M. M. Hilferty, *The distribution of chi-square*, 1931: `∛(χ²/n)` is nearly normal, of the mean
//! `1 − 2/(9n)` and the variance `2/(9n)`.

use mbs_runtime::Scalar;

/// 97.5 % of a normal distribution are below this: the two-sided bound of 95 %.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;
/// The same for 99 %.
pub const NORMAL_99: f64 = 2.575_829_303_548_901;

/// The χ² of n degrees of freedom that is exceeded as often as a normal deviate exceeds `normal`; off by less than 4e-4
/// of itself from 100 degrees on, by less than 8 in 1000 from 10 on. Of fewer degrees the far tail is overestimated:
/// beyond the quantile of one in 100 000 are three in a million for one degree.
#[must_use]
pub fn quantile(normal: f64, freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * freedom);
    let root = 1.0 - variance + normal * Scalar::sqrt(variance);
    freedom * root * root * root
}

/// Two-sided bounds of the mean of `runs` values of χ² with n degrees of freedom each.
#[must_use]
pub fn bounds_of_mean(normal: f64, freedom: f64, runs: f64) -> [f64; 2] {
    [-normal, normal].map(|side| quantile(side, freedom * runs) / runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables: M. Abramowitz and I. Stegun, *Handbook of mathematical functions*, 1964, table 26.8.
    #[test]
    fn bounds_are_those_of_tables() {
        for (normal, freedom, table, tolerance) in [
            (-NORMAL_95, 10.0, 3.246_97, 8e-3),
            (NORMAL_95, 10.0, 20.483_2, 1e-3),
            (NORMAL_99, 30.0, 53.672_0, 8e-4),
            (-NORMAL_95, 100.0, 74.221_9, 1e-4),
            (NORMAL_95, 100.0, 129.561, 1e-4),
            (-NORMAL_99, 100.0, 67.327_6, 4e-4),
        ] {
            let bound = quantile(normal, freedom);
            assert!((bound / table - 1.0).abs() < tolerance, "χ²({freedom}) at {normal}: {bound}, {table}");
        }
    }

    /// Of many degrees: mean n, variance 2 n.
    #[test]
    fn a_mean_of_many_is_nearly_normal() {
        let [low, high] = bounds_of_mean(NORMAL_95, 15.0, 500.0);
        let half = NORMAL_95 * (2.0 * 15.0 / 500.0_f64).sqrt();
        assert!((high - low - 2.0 * half).abs() < 1e-3 && (0.5 * (low + high) - 15.0).abs() < 5e-3, "{low} {high}");
    }
}
