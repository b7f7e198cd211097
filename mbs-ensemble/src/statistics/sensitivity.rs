//! Sobol' indices: which part of a variance comes from which variable.
//!
//! Of a function `f` of independent variables the first-order index `Sᵢ = V(E(f | xᵢ)) / V(f)` is what would vanish of
//! the variance if `xᵢ` were known; the total index `Tᵢ = E(V(f | all but xᵢ)) / V(f)` is what would be left if all
//! others were.
//!
//! They are estimated from rows of `d + 2` evaluations: at a point A, at another point B, and at A with one coordinate
//! of B after the other, which is what the design `saltelli` of a plan draws.
//!
//! Source: A. Saltelli, P. Annoni, I. Azzini, F. Campolongo, M. Ratto and S. Tarantola, *Variance based sensitivity
//! analysis of model output*, Computer Physics Communications 181, 2010, table 2: (b) for `Sᵢ`, (f), which is Jansen's,
//! for `Tᵢ`.

use chacha20::rand_core::Rng;

use super::quantile;
use crate::sequence::{Purpose, random};

/// An estimate with its bounds at a confidence of 0.95.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// The bounds.
    pub interval: [f64; 2],
}

/// The indices of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Indices {
    /// Sᵢ
    pub first: Estimate,
    /// Tᵢ
    pub total: Estimate,
}

/// How often rows are drawn again, to see how much the indices change.
const RESAMPLES: u64 = 200;

/// The indices of each variable, from evaluations in rows of `variables + 2`; rows with one that is not finite are left
/// out. `None` where fewer than two are left, or nothing varies.
///
/// The bounds are those of a bootstrap of rows.
///
/// ```
/// use mbs_ensemble::statistics::sensitivity::{indices, points};
/// // x₁ + 2 x₂: a fifth and four fifths of the variance.
/// let values: Vec<f64> = points(2, 1024, 1).map(|x| x[0] + 2.0 * x[1]).collect();
/// let [x1, x2] = indices(&values, 2, 1).unwrap()[..] else { panic!("two variables") };
/// assert!((x1.first.value - 0.2).abs() < 0.01 && (x2.total.value - 0.8).abs() < 0.01);
/// ```
pub fn indices(values: &[f64], variables: usize, seed: u64) -> Option<Vec<Indices>> {
    let is_whole = |row: &&[f64]| row.iter().all(|value| value.is_finite());
    let rows: Vec<&[f64]> = values.chunks_exact(variables + 2).filter(is_whole).collect();
    let estimates = estimated(&rows, variables)?;
    let mut resampled: Vec<Vec<[f64; 2]>> = Vec::new();
    for number in 0..RESAMPLES {
        let mut random = random(seed, Purpose::Whole, 1 + number);
        let count = rows.len() as u64;
        let drawn: Vec<&[f64]> = rows.iter().map(|_| rows[(random.next_u64() % count) as usize]).collect();
        resampled.extend(estimated(&drawn, variables));
    }
    let estimate = |variable: usize, which: usize| {
        let mut found: Vec<f64> = resampled.iter().map(|estimates| estimates[variable][which]).collect();
        found.sort_by(f64::total_cmp);
        Estimate { value: estimates[variable][which], interval: [quantile(&found, 0.025), quantile(&found, 0.975)] }
    };
    Some((0..variables).map(|i| Indices { first: estimate(i, 0), total: estimate(i, 1) }).collect())
}

/// Sᵢ and Tᵢ of each variable.
fn estimated(rows: &[&[f64]], variables: usize) -> Option<Vec<[f64; 2]>> {
    let count = rows.len() as f64;
    let mean = |f: &dyn Fn(&[f64]) -> f64| rows.iter().map(|row| f(row)).sum::<f64>() / count;
    let centre = mean(&|row| (row[0] + row[1]) / 2.0);
    let variance = mean(&|row| ((row[0] - centre).powi(2) + (row[1] - centre).powi(2)) / 2.0);
    if rows.len() < 2 || !super::varies(centre, variance) {
        return None;
    }
    let of = |i: usize| {
        let first = mean(&|row| (row[1] - centre) * (row[2 + i] - row[0]));
        let total = mean(&|row| (row[0] - row[2 + i]).powi(2) / 2.0);
        [first / variance, total / variance]
    };
    Some((0..variables).map(of).collect())
}

/// Where a function on the unit cube is evaluated for its [`indices`], in this order: points of Sobol's sequence, as
/// many rows as are asked for; none where it has not as many dimensions.
pub fn points(variables: usize, rows: u64, seed: u64) -> impl Iterator<Item = Vec<f64>> {
    use crate::sequence::{Kind, Sequence};
    let sequence = Sequence::new(Kind::Saltelli, seed, rows, variables);
    let count = if sequence.is_some() { rows * (variables as u64 + 2) } else { 0 };
    (0..count).filter_map(move |index| sequence.as_ref().map(|sequence| sequence.point(index)))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[track_caller]
    fn check(function: impl Fn(&[f64]) -> f64, expected: &[[f64; 2]], tolerance: f64) {
        let values: Vec<f64> = points(expected.len(), 4096, 3).map(|x| function(&x)).collect();
        let found = indices(&values, expected.len(), 3).unwrap();
        for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
            for (estimate, expected) in [found.first, found.total].iter().zip(expected) {
                assert!((estimate.value - expected).abs() < tolerance, "{i}: {estimate:?} {expected}");
                let [low, high] = estimate.interval;
                assert!(low <= estimate.value && estimate.value <= high && high - low < 0.2, "{i}: {estimate:?}");
                // A point of a low-discrepancy sequence is nearer than bounds of random points say.
                assert!(low - 0.01 <= *expected && *expected <= high + 0.01, "{i}: {estimate:?} {expected}");
            }
        }
    }

    /// T. Ishigami and T. Homma, 1990; a = 7, b = 0.1: variances of the terms in closed form.
    #[test]
    fn indices_of_ishigami_are_known() {
        let (a, b) = (7.0, 0.1);
        let function = |x: &[f64]| {
            let [x, y, z] = [0, 1, 2].map(|i| PI * (2.0 * x[i] - 1.0));
            x.sin() + a * y.sin().powi(2) + b * z.powi(4) * x.sin()
        };
        let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let second = a * a / 8.0;
        let both = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let all = first + second + both;
        check(function, &[[first / all, (first + both) / all], [second / all, second / all], [0.0, both / all]], 0.01);
    }

    /// Sobol' g-function: `Π (|4xᵢ − 2| + aᵢ)/(1 + aᵢ)`.
    #[test]
    fn indices_of_the_g_function_are_known() {
        let a = [0.0, 1.0, 4.5, 9.0, 99.0];
        let function =
            |x: &[f64]| -> f64 { x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product() };
        let parts = a.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        let product: f64 = parts.iter().map(|part| 1.0 + part).product();
        let expected = parts.map(|part| [part, part / (1.0 + part) * product].map(|v| v / (product - 1.0)));
        check(function, &expected, 0.02);
    }

    #[test]
    fn what_rounding_leaves_of_a_constant_has_no_indices() {
        for constant in [1.0, 9.81 * 3.7, 1e-300, 0.0] {
            assert_eq!(indices(&vec![constant; 4 * 256], 2, 1), None);
        }
    }

    #[test]
    fn rows_that_are_not_whole_are_left_out() {
        let mut values: Vec<f64> = points(2, 256, 1).map(|x| x[0]).collect();
        values[5] = f64::NAN;
        let found = indices(&values, 2, 1).unwrap();
        assert!((found[0].first.value - 1.0).abs() < 0.02 && found[1].total.value == 0.0, "{found:?}");
        assert_eq!(indices(&[1.0; 40], 2, 1), None);
    }
}
