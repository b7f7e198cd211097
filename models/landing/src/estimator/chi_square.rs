//! Bounds of the χ² distribution.
//!
//! # Source
//! E. B. Wilson and M. M. Hilferty, *The distribution of chi-square*, 1931: `∛(χ²/n)` is nearly normal, of the mean
//! `1 − 2/(9n)` and the variance `2/(9n)`.

use mbs_runtime::Scalar;

/// 97.5 % of a normal distribution are below this: the two-sided bound of 95 %.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;
/// 99.5 % of a normal distribution are below this: the two-sided bound of 99 %.
pub const NORMAL_99: f64 = 2.575_829_303_548_901;

/// The χ² of n degrees of freedom, 10 at least, that is exceeded as often as a normal deviate z exceeds `normal`.
///
/// It is off by less than 2e-5 of itself for deviates up to 1.96, and by less than 2e-3 for deviates up to 3; from 26
/// degrees on by less than 1e-5. With fewer than 10 degrees it is far off, and may be negative.
///
/// # Source
/// H. Goldberg and H. Levine, *Approximate formulas for the percentage points and normalization of t and χ²*, Annals of
/// Mathematical Statistics 17:2, 1946: Cornish's and Fisher's expansion up to n^(−5/2).
#[must_use]
pub fn quantile(normal: f64, freedom: f64) -> f64 {
    let (n, r, z) = (freedom, Scalar::sqrt(2.0 * freedom), normal);
    let z2 = z * z;
    let terms = [
        n + r * z + 2.0 / 3.0 * (z2 - 1.0),
        z * (z2 - 7.0) / (9.0 * r),
        -(z2 * (6.0 * z2 + 14.0) - 32.0) / (405.0 * n),
        z * (z2 * (9.0 * z2 + 256.0) - 433.0) / (4860.0 * n * r),
        (z2 * (z2 * (12.0 * z2 - 243.0) - 923.0) + 1472.0) / (25_515.0 * n * n),
        -z * (z2 * (z2 * (3753.0 * z2 + 4353.0) - 289_517.0) - 289_717.0) / (9_185_400.0 * n * n * r),
    ];
    terms.iter().sum()
}

/// A χ² of any number of degrees of freedom that is exceeded at most as often as a normal deviate exceeds `normal`,
/// which is 3 at least.
///
/// # Source
/// E. B. Wilson and M. M. Hilferty, *The distribution of chi-square*, Proceedings of the National Academy of Sciences
/// 17:12, 1931: their cube of a normal deviate, which is beyond the quantile there.
#[must_use]
pub fn gate(normal: f64, freedom: f64) -> f64 {
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

    /// Tables: M. Abramowitz and I. Stegun, *Handbook of mathematical functions*, 1964, table 26.8; at −3 by bisection
    /// of the probability.
    #[test]
    fn bounds_are_those_of_tables() {
        for (normal, freedom, table, accuracy) in [
            (-3.0, 10.0, 1.583_721, 2e-3),
            (-NORMAL_99, 10.0, 2.155_86, 3e-4),
            (-NORMAL_95, 10.0, 3.246_97, 2e-5),
            (NORMAL_95, 10.0, 20.483_2, 2e-5),
            (-NORMAL_99, 30.0, 13.786_7, 1e-5),
            (NORMAL_99, 30.0, 53.672_0, 1e-5),
            (-NORMAL_95, 100.0, 74.221_9, 1e-5),
            (NORMAL_95, 100.0, 129.561, 1e-5),
            (-NORMAL_99, 100.0, 67.327_6, 1e-5),
        ] {
            let bound = quantile(normal, freedom);
            assert!((bound / table - 1.0).abs() < accuracy, "χ²({freedom}) at {normal}: {bound}, {table}");
        }
    }

    /// Exactly: z of half the part for one degree, an exponential distribution for two, the expansion beyond.
    #[test]
    fn the_gate_is_beyond_the_quantile_of_one_in_a_hundred_thousand() {
        let normal = 4.264_890_793_922_825;
        for (freedom, exact) in [(1.0, 4.417_173_413_469_022_f64.powi(2)), (2.0, -2.0 * 1e-5_f64.ln())] {
            let found = gate(normal, freedom);
            assert!(found >= exact && found < 1.12 * exact, "{freedom}: {found}, {exact}");
        }
        for freedom in [16.0, 100.0, 7500.0] {
            let (found, accurate) = (gate(normal, freedom), quantile(normal, freedom));
            assert!(found >= accurate && found < 1.02 * accurate, "{freedom}: {found}, {accurate}");
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
