//! Polynomials that are orthonormal under a distribution, and Gauss' rules that integrate over it.
//!
//! They are polynomials of the distribution's [germ](Distribution::at_germ): Hermite's of a normal one, Legendre's of a
//! uniform one, and of others those that their densities define.
//!
//! Source: W. Gautschi, *Orthogonal Polynomials: Computation and Approximation*, 2004, sections 1.3 (recurrence), 2.2
//! (Stieltjes' procedure on a discrete measure) and 3.1 (Gauss' rule by eigenvalues, after Golub and Welsch).

use nalgebra::DMatrix;

use crate::distribution::{Distribution, FAR};

/// `p₀ … p_n`, orthonormal: `√βₖ₊₁ pₖ₊₁ = (ξ − αₖ) pₖ − √βₖ pₖ₋₁`.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomials {
    alpha: Vec<f64>,
    /// `β₀ = 1`: all of the probability.
    beta: Vec<f64>,
}

/// A point of a rule, as a value of the germ, and its share of the probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// ξ
    pub germ: f64,
    /// From 0 to 1; those of a rule sum up to 1.
    pub weight: f64,
}

impl Polynomials {
    /// Up to this degree.
    pub fn of(distribution: &Distribution, degree: usize) -> Self {
        match *distribution {
            Distribution::Uniform { .. } => Self::legendre(degree),
            Distribution::Normal { .. } | Distribution::Lognormal { .. } => {
                let beta = (0..=degree).map(|k| if k == 0 { 1.0 } else { k as f64 }).collect();
                Polynomials { alpha: vec![0.0; degree + 1], beta }
            }
            Distribution::Triangular { low, mode, high } => {
                let mode = (2.0 * mode - low - high) / (high - low);
                let density = |x: f64| {
                    if x < mode { (x + 1.0) / (mode + 1.0) } else { (1.0 - x) / (1.0 - mode) }
                };
                Self::stieltjes(&measure(&[-1.0, mode, 1.0], density), degree)
            }
            Distribution::TruncatedNormal { mean, deviation, .. } => {
                let [low, high] = distribution.bounds();
                let half = (high - low) / 2.0;
                let (centre, spread) = ((mean - low) / half - 1.0, deviation / half);
                let middle = centre.clamp(-1.0, 1.0);
                let [from, to] = [-FAR, FAR].map(|far| (middle + far * spread).clamp(-1.0, 1.0));
                let panels: Vec<f64> = (0..=24).map(|k| from + (to - from) * f64::from(k) / 24.0).collect();
                let peak = ((middle - centre) / spread).powi(2);
                let density = |x: f64| ((peak - ((x - centre) / spread).powi(2)) / 2.0).exp();
                Self::stieltjes(&measure(&panels, density), degree)
            }
        }
    }

    /// Those of numbers that are alike from −1 to 1.
    fn legendre(degree: usize) -> Self {
        let beta = |k: usize| if k == 0 { 1.0 } else { (k * k) as f64 / (4 * k * k - 1) as f64 };
        Polynomials { alpha: vec![0.0; degree + 1], beta: (0..=degree).map(beta).collect() }
    }

    /// Those of a measure that has far more nodes than the polynomials have degrees.
    fn stieltjes(measure: &[Node], degree: usize) -> Self {
        let integral = |f: &dyn Fn(usize) -> f64| -> f64 {
            measure.iter().enumerate().map(|(number, node)| node.weight * f(number)).sum()
        };
        let (mut before, mut now) = (vec![0.0; measure.len()], vec![1.0; measure.len()]);
        let (mut alpha, mut beta, mut last) = (Vec::new(), Vec::new(), 1.0);
        for k in 0..=degree {
            let square = integral(&|i| now[i] * now[i]);
            alpha.push(integral(&|i| measure[i].germ * now[i] * now[i]) / square);
            beta.push(if k == 0 { 1.0 } else { square / last });
            last = square;
            let next =
                (0..measure.len()).map(|i| (measure[i].germ - alpha[k]) * now[i] - beta[k] * before[i]).collect();
            before = std::mem::replace(&mut now, next);
        }
        Polynomials { alpha, beta }
    }

    /// The highest degree.
    pub fn degree(&self) -> usize {
        self.alpha.len() - 1
    }

    /// All polynomials at a place, and their slopes there.
    ///
    /// ```
    /// use mbs_ensemble::{Distribution, statistics::orthogonal::Polynomials};
    /// // Hermite's: 1, ξ, (ξ² − 1)/√2.
    /// let [values, slopes] = Polynomials::of(&Distribution::Normal { mean: 0.0, deviation: 1.0 }, 2).at(3.0);
    /// assert!((values[2] - 8.0 / 2.0_f64.sqrt()).abs() < 1e-14 && (slopes[2] - 6.0 / 2.0_f64.sqrt()).abs() < 1e-14);
    /// ```
    pub fn at(&self, germ: f64) -> [Vec<f64>; 2] {
        let (mut values, mut slopes) = (vec![1.0], vec![0.0]);
        for k in 0..self.degree() {
            let (value, slope) = (values[k], slopes[k]);
            let [value_before, slope_before] = if k == 0 { [0.0; 2] } else { [values[k - 1], slopes[k - 1]] };
            let (own, next) = (self.beta[k].sqrt(), self.beta[k + 1].sqrt());
            values.push(((germ - self.alpha[k]) * value - own * value_before) / next);
            slopes.push((value + (germ - self.alpha[k]) * slope - own * slope_before) / next);
        }
        [values, slopes]
    }

    /// Gauss' rule, in ascending order, with a node more than the degree: exact for polynomials of twice the degree,
    /// and one more.
    pub fn rule(&self) -> Vec<Node> {
        let size = self.alpha.len();
        let jacobi = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
            0 => self.alpha[i],
            1 => self.beta[i.max(j)].sqrt(),
            _ => 0.0,
        });
        let eigen = jacobi.symmetric_eigen();
        let node = |k: usize| Node { germ: eigen.eigenvalues[k], weight: eigen.eigenvectors[(0, k)].powi(2) };
        let mut nodes: Vec<Node> = (0..size).map(node).collect();
        nodes.sort_by(|a, b| a.germ.total_cmp(&b.germ));
        nodes
    }
}

/// A density as many nodes: Legendre's rule between places where it is smooth, so dense that more change nothing.
fn measure(places: &[f64], density: impl Fn(f64) -> f64) -> Vec<Node> {
    let rule = Polynomials::legendre(40).rule();
    let mut nodes = Vec::new();
    for panel in places.windows(2).filter(|panel| panel[0] < panel[1]) {
        let [middle, half] = [(panel[0] + panel[1]) / 2.0, (panel[1] - panel[0]) / 2.0];
        nodes.extend(rule.iter().map(|node| {
            let germ = middle + half * node.germ;
            Node { germ, weight: half * node.weight * density(germ) }
        }));
    }
    let whole: f64 = nodes.iter().map(|node| node.weight).sum();
    nodes.iter_mut().for_each(|node| node.weight /= whole);
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Distribution; 8] = [
        Distribution::Uniform { low: 1.0, high: 4.0 },
        Distribution::Triangular { low: 1.0, mode: 2.0, high: 5.0 },
        Distribution::Triangular { low: 1.0, mode: 1.0, high: 5.0 },
        Distribution::Normal { mean: 2.0, deviation: 0.3 },
        Distribution::TruncatedNormal { mean: 0.2, deviation: 0.5, low: 0.0, high: 1.0 },
        Distribution::TruncatedNormal { mean: 2.0, deviation: 0.1, low: 0.0, high: 4.0 },
        Distribution::TruncatedNormal { mean: 0.2, deviation: 0.5, low: 0.0, high: f64::INFINITY },
        Distribution::TruncatedNormal { mean: 0.2, deviation: 0.5, low: f64::NEG_INFINITY, high: -1.0 },
    ];

    /// Under the rule of a degree that integrates their products exactly, and under the quantiles themselves.
    #[test]
    fn polynomials_are_orthonormal() {
        for distribution in ALL.iter().chain(&[Distribution::Lognormal { median: 3.0, deviation: 0.2 }]) {
            let polynomials = Polynomials::of(distribution, 6);
            let rule = Polynomials::of(distribution, 6).rule();
            assert!((rule.iter().map(|node| node.weight).sum::<f64>() - 1.0).abs() < 1e-13, "{distribution:?}");
            for i in 0..=6 {
                for j in 0..=6 {
                    let product = |germ: f64| polynomials.at(germ)[0][i] * polynomials.at(germ)[0][j];
                    let sum: f64 = rule.iter().map(|node| node.weight * product(node.germ)).sum();
                    assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-11, "{distribution:?} {i} {j}: {sum}");
                }
            }
        }
    }

    /// Mean and variance of the values, against quantiles by the midpoint rule.
    #[test]
    fn rules_integrate_over_the_distribution() {
        for distribution in ALL {
            let rule = Polynomials::of(&distribution, 8).rule();
            let n = 400_000;
            let quantiles: Vec<f64> =
                (0..n).map(|i| distribution.quantile((f64::from(i) + 0.5) / f64::from(n))).collect();
            for power in 1..=3 {
                let by_rule: f64 = rule.iter().map(|n| n.weight * distribution.at_germ(n.germ).powi(power)).sum();
                let expected = quantiles.iter().map(|x| x.powi(power)).sum::<f64>() / f64::from(n);
                assert!(
                    (by_rule - expected).abs() < 1e-4 * expected.abs(),
                    "{distribution:?} {power}: {by_rule} {expected}"
                );
            }
        }
    }

    /// M. Abramowitz and I. A. Stegun, *Handbook of Mathematical Functions*, 1964, tables 25.4 and 25.10.
    #[test]
    fn rules_are_those_of_the_tables() {
        let check = |distribution, degree, expected: &[[f64; 2]]| {
            let rule = Polynomials::of(&distribution, degree).rule();
            assert_eq!(rule.len(), expected.len());
            for (node, [germ, weight]) in rule.iter().zip(expected) {
                assert!((node.germ - germ).abs() < 1e-14 && (node.weight - weight).abs() < 1e-14, "{node:?} {germ}");
            }
        };
        let third = 0.6_f64.sqrt();
        let [outer, inner] = [5.0 / 18.0, 8.0 / 18.0];
        check(Distribution::Uniform { low: 0.0, high: 1.0 }, 2, &[[-third, outer], [0.0, inner], [third, outer]]);
        let third = 3.0_f64.sqrt();
        let normal = Distribution::Normal { mean: 0.0, deviation: 1.0 };
        check(normal, 2, &[[-third, 1.0 / 6.0], [0.0, 2.0 / 3.0], [third, 1.0 / 6.0]]);
    }
}
