//! Polynomial chaos: a quantity as a polynomial of what varies, from which mean, variance and Sobol' indices follow.
//!
//! `f(ξ) ≈ Σ c_a ψ_a(ξ)`, with products `ψ_a = Π pₐᵢ(ξᵢ)` of [orthonormal polynomials](super::orthogonal), of a total
//! degree that is chosen: the mean is the coefficient of 1, the variance the sum of the squares of all others, and what
//! a variable has a share in the sum of those whose product it is in. Where `f` is smooth, few evaluations are enough;
//! where it has kinks or jumps, or many variables, take random members.
//!
//! Coefficients come from [Gauss' rules](Chaos::of_grid), as the design `chaos` of a plan evaluates them, or by [least
//! squares](Chaos::of_samples) from values anywhere, and gradients where they are known: those of a motion are exact by
//! dual numbers, with which generated code and the integrators are called like with any other scalar.
//!
//! Sources: D. Xiu and G. E. Karniadakis, *The Wiener–Askey polynomial chaos for stochastic differential equations*,
//! SIAM Journal on Scientific Computing 24:2, 2002; B. Sudret, *Global sensitivity analysis using polynomial chaos
//! expansions*, Reliability Engineering and System Safety 93, 2008, equations 36 to 39.

use nalgebra::{DMatrix, DVector};

use super::orthogonal::{Node, Polynomials};
use crate::distribution::Distribution;

/// A quantity as a polynomial of independent variables.
///
/// ```
/// use mbs_ensemble::{Distribution, statistics::chaos::{Chaos, grid}};
/// let normal = Distribution::Normal { mean: 1.0, deviation: 0.1 };
/// let distributions = [normal, Distribution::Uniform { low: 0.0, high: 1.0 }];
/// let values: Vec<f64> = grid(&distributions, 2).iter().map(|x| x[0] * x[0] + 3.0 * x[1]).collect();
/// let chaos = Chaos::of_grid(&distributions, 2, &values).unwrap();
/// // E x² = μ² + σ², V x² = 4 μ² σ² + 2 σ⁴; V 3 u = 9/12.
/// assert!((chaos.mean() - 2.51).abs() < 1e-13 && (chaos.variance() - (0.0402 + 0.75)).abs() < 1e-13);
/// assert!((chaos.first(1) - 0.75 / 0.7902).abs() < 1e-13);
/// ```
#[derive(Clone, Debug)]
pub struct Chaos {
    distributions: Vec<Distribution>,
    polynomials: Vec<Polynomials>,
    terms: Vec<Term>,
}

/// `c ψ_a`
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The degree in each variable.
    pub degrees: Vec<usize>,
    /// c
    pub coefficient: f64,
}

/// An evaluation of a quantity.
#[derive(Clone, Debug)]
pub struct Sample {
    /// What varies.
    pub point: Vec<f64>,
    /// The quantity.
    pub value: f64,
    /// Its derivatives by what varies; empty where they are not known.
    pub gradient: Vec<f64>,
}

/// Why there is no polynomial.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChaosError {
    /// An evaluation is infinite or NaN, or there are more or fewer of them than are asked for.
    #[error("the evaluation {number} is {value:?}: all must be there, and finite")]
    Value {
        /// From 0.
        number: usize,
        /// What it is; NaN where it is missing.
        value: f64,
    },
    /// Samples do not decide on the coefficients.
    #[error("{samples} values and derivatives do not decide on {terms} coefficients: more of them, or a lower degree")]
    Undecided {
        /// How many numbers there are.
        samples: usize,
        /// How many coefficients there are.
        terms: usize,
    },
}

/// Where Gauss' rules evaluate a quantity: all combinations, the last variable first, a value more than the degree of
/// each.
pub fn grid(distributions: &[Distribution], degree: usize) -> Vec<Vec<f64>> {
    let values: Vec<Vec<f64>> = distributions.iter().map(|distribution| nodes(distribution, degree)).collect();
    let count = values.iter().map(Vec::len).product();
    (0..count)
        .map(|number| digits(number, &values).map(|(variable, digit)| values[variable][digit]).collect())
        .collect()
}

/// The values of a variable at which Gauss' rule of a degree evaluates.
pub fn nodes(distribution: &Distribution, degree: usize) -> Vec<f64> {
    Polynomials::of(distribution, degree).rule().iter().map(|node| distribution.at_germ(node.germ)).collect()
}

/// Which value of each variable a number stands for.
fn digits<T>(number: usize, values: &[Vec<T>]) -> impl Iterator<Item = (usize, usize)> + '_ {
    let behind = |variable: usize| values[variable + 1..].iter().map(Vec::len).product::<usize>();
    (0..values.len()).map(move |variable| (variable, number / behind(variable) % values[variable].len()))
}

impl Chaos {
    /// From evaluations at the points of the [`grid`] of the same degree, in its order.
    ///
    /// # Errors
    /// An evaluation is missing, or not finite.
    pub fn of_grid(distributions: &[Distribution], degree: usize, values: &[f64]) -> Result<Self, ChaosError> {
        let mut chaos = Chaos::blank(distributions, degree);
        let rules: Vec<Vec<Node>> = chaos.polynomials.iter().map(Polynomials::rule).collect();
        let count: usize = rules.iter().map(Vec::len).product();
        check(values, count)?;
        // Of each variable and node all polynomials.
        let tables: Vec<Vec<Vec<f64>>> = rules
            .iter()
            .zip(&chaos.polynomials)
            .map(|(rule, polynomials)| rule.iter().map(|node| polynomials.at(node.germ)[0].clone()).collect())
            .collect();
        for (number, value) in values.iter().enumerate() {
            let places: Vec<usize> = digits(number, &rules).map(|(_, digit)| digit).collect();
            let weight: f64 = places.iter().zip(&rules).map(|(place, rule)| rule[*place].weight).product();
            for term in &mut chaos.terms {
                let factors = term.degrees.iter().zip(&places).zip(&tables);
                let product: f64 = factors.map(|((degree, place), table)| table[*place][*degree]).product();
                term.coefficient += weight * value * product;
            }
        }
        Ok(chaos)
    }

    /// From values anywhere, and gradients where there are some, by least squares: one value with its gradient says as
    /// much as one value more for each variable.
    ///
    /// # Errors
    /// A number is not finite, or there are too few to decide on the coefficients.
    pub fn of_samples(distributions: &[Distribution], degree: usize, samples: &[Sample]) -> Result<Self, ChaosError> {
        let mut chaos = Chaos::blank(distributions, degree);
        let (mut rows, mut right) = (Vec::new(), Vec::new());
        for (number, sample) in samples.iter().enumerate() {
            let is_gradient = [0, distributions.len()].contains(&sample.gradient.len());
            let numbers = [&sample.point[..], &[sample.value], &sample.gradient].concat();
            let wrong = numbers.iter().copied().find(|x| !x.is_finite());
            let wrong = wrong.or((!is_gradient || sample.point.len() != distributions.len()).then_some(f64::NAN));
            if let Some(value) = wrong {
                return Err(ChaosError::Value { number, value });
            }
            let germs: Vec<f64> = distributions.iter().zip(&sample.point).map(|(d, x)| d.germ(*x)).collect();
            let tables: Vec<[Vec<f64>; 2]> = chaos.polynomials.iter().zip(&germs).map(|(p, xi)| p.at(*xi)).collect();
            // A product with the factor of one variable differentiated, if any.
            let product = |degrees: &[usize], by: Option<usize>| -> f64 {
                let factor = |i: usize| tables[i][usize::from(by == Some(i))][degrees[i]];
                (0..degrees.len()).map(factor).product()
            };
            rows.extend(chaos.terms.iter().map(|term| product(&term.degrees, None)));
            right.push(sample.value);
            for (i, slope) in sample.gradient.iter().enumerate() {
                rows.extend(chaos.terms.iter().map(|term| product(&term.degrees, Some(i))));
                right.push(slope * distributions[i].slope_at_germ(germs[i]));
            }
        }
        let (count, terms) = (right.len(), chaos.terms.len());
        let undecided = ChaosError::Undecided { samples: count, terms };
        if count < terms {
            return Err(undecided);
        }
        let svd = DMatrix::from_row_slice(count, terms, &rows).svd(true, true);
        let (least, greatest) = (svd.singular_values.min(), svd.singular_values.max());
        const ROUNDING: f64 = 1e-10;
        if least <= ROUNDING * greatest {
            return Err(undecided);
        }
        let solution = svd.solve(&DVector::from_vec(right), 0.0).map_err(|_| undecided)?;
        chaos.terms.iter_mut().zip(&solution).for_each(|(term, coefficient)| term.coefficient = *coefficient);
        Ok(chaos)
    }

    /// All terms up to a total degree, without coefficients.
    fn blank(distributions: &[Distribution], degree: usize) -> Self {
        let mut all = vec![Vec::new()];
        for _ in distributions {
            let longer = |degrees: &Vec<usize>| {
                let left = degree - degrees.iter().sum::<usize>();
                (0..=left).map(|own| [degrees.as_slice(), &[own]].concat()).collect::<Vec<_>>()
            };
            all = all.iter().flat_map(longer).collect();
        }
        all.sort_by_key(|degrees| degrees.iter().sum::<usize>());
        let polynomials = distributions.iter().map(|distribution| Polynomials::of(distribution, degree)).collect();
        let terms = all.into_iter().map(|degrees| Term { degrees, coefficient: 0.0 }).collect();
        Chaos { distributions: distributions.to_vec(), polynomials, terms }
    }

    /// The terms, that of 1 first, by their degrees.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// The mean of the quantity.
    pub fn mean(&self) -> f64 {
        self.terms[0].coefficient
    }

    /// Its variance.
    pub fn variance(&self) -> f64 {
        self.part(|_| true)
    }

    /// Whether it varies by more than rounding leaves.
    pub fn varies(&self) -> bool {
        super::varies(self.mean(), self.variance())
    }

    /// The share of the variance in the terms that are chosen by their degrees; NaN where nothing varies.
    fn share(&self, is_chosen: impl Fn(&[usize]) -> bool) -> f64 {
        if self.varies() { self.part(is_chosen) / self.variance() } else { f64::NAN }
    }

    /// The variance of the terms that are chosen by their degrees, but for the mean.
    fn part(&self, is_chosen: impl Fn(&[usize]) -> bool) -> f64 {
        let chosen = self.terms[1..].iter().filter(|term| is_chosen(&term.degrees));
        chosen.map(|term| term.coefficient * term.coefficient).sum()
    }

    /// `Sᵢ`: the share of the variance that is a variable's alone; NaN where nothing varies.
    pub fn first(&self, variable: usize) -> f64 {
        let alone = |degrees: &[usize]| degrees.iter().enumerate().all(|(i, degree)| (*degree > 0) == (i == variable));
        self.share(alone)
    }

    /// `Tᵢ`: the share of the variance that a variable has a part in; NaN where nothing varies.
    pub fn total(&self, variable: usize) -> f64 {
        self.share(|degrees| degrees[variable] > 0)
    }

    /// The share of the variance in terms of the highest degree: where it is not small, a higher degree is needed. NaN
    /// where nothing varies.
    pub fn highest(&self) -> f64 {
        let sum = |degrees: &[usize]| degrees.iter().sum::<usize>();
        let degree = self.terms.last().map_or(0, |term| sum(&term.degrees));
        self.share(|degrees| sum(degrees) == degree)
    }

    /// The polynomial at a point.
    pub fn value(&self, point: &[f64]) -> f64 {
        let germs = self.distributions.iter().zip(point).map(|(distribution, x)| distribution.germ(*x));
        let tables: Vec<Vec<f64>> =
            self.polynomials.iter().zip(germs).map(|(polynomials, germ)| polynomials.at(germ)[0].clone()).collect();
        let product = |term: &Term| -> f64 { term.degrees.iter().zip(&tables).map(|(k, table)| table[*k]).product() };
        self.terms.iter().map(|term| term.coefficient * product(term)).sum()
    }
}

fn check(values: &[f64], count: usize) -> Result<(), ChaosError> {
    if let Some(number) = values.iter().position(|value| !value.is_finite()) {
        return Err(ChaosError::Value { number, value: values[number] });
    }
    match values.len() {
        length if length == count => Ok(()),
        length => Err(ChaosError::Value { number: length.min(count), value: f64::NAN }),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::sequence::{Kind, Sequence};

    const ISHIGAMI: [Distribution; 3] = [Distribution::Uniform { low: -PI, high: PI }; 3];
    const A: f64 = 7.0;
    const B: f64 = 0.1;

    fn ishigami(x: &[f64]) -> f64 {
        x[0].sin() + A * x[1].sin().powi(2) + B * x[2].powi(4) * x[0].sin()
    }

    fn ishigami_slopes(x: &[f64]) -> Vec<f64> {
        vec![x[0].cos() * (1.0 + B * x[2].powi(4)), A * (2.0 * x[1]).sin(), 4.0 * B * x[2].powi(3) * x[0].sin()]
    }

    /// Mean, variance, first and total indices in closed form: T. Ishigami and T. Homma, 1990.
    fn check_ishigami(chaos: &Chaos, tolerance: f64) {
        let first = 0.5 * (1.0 + B * PI.powi(4) / 5.0).powi(2);
        let second = A * A / 8.0;
        let both = B * B * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
        let all = first + second + both;
        let check = |found: f64, expected: f64| assert!((found - expected).abs() < tolerance, "{found} {expected}");
        check(chaos.mean() / (A / 2.0), 1.0);
        check(chaos.variance() / all, 1.0);
        for (variable, [alone, total]) in [[first, first + both], [second, second], [0.0, both]].into_iter().enumerate()
        {
            check(chaos.first(variable), alone / all);
            check(chaos.total(variable), total / all);
        }
    }

    #[test]
    fn indices_of_ishigami_are_known() {
        let values: Vec<f64> = grid(&ISHIGAMI, 14).iter().map(|x| ishigami(x)).collect();
        let chaos = Chaos::of_grid(&ISHIGAMI, 14, &values).unwrap();
        check_ishigami(&chaos, 1e-6);
        assert!(chaos.highest() < 1e-6, "{}", chaos.highest());
        let x = [0.3, -1.1, 2.0];
        assert!((chaos.value(&x) - ishigami(&x)).abs() < 1e-3);
    }

    /// A quarter of the points is enough where gradients are known; without them the coefficients are not decided on.
    #[test]
    fn gradients_are_worth_values() {
        let degree = 10;
        let sequence = Sequence::new(Kind::Sobol, 5, 150, 3).unwrap();
        let sample = |number: u64, with_gradient: bool| {
            let point: Vec<f64> = sequence.point(number).iter().map(|p| PI * (2.0 * p - 1.0)).collect();
            let gradient = if with_gradient { ishigami_slopes(&point) } else { Vec::new() };
            Sample { value: ishigami(&point), gradient, point }
        };
        let samples = |with_gradient| (0..150).map(|number| sample(number, with_gradient)).collect::<Vec<_>>();
        let chaos = Chaos::of_samples(&ISHIGAMI, degree, &samples(true)).unwrap();
        check_ishigami(&chaos, 5e-3);
        let undecided = Chaos::of_samples(&ISHIGAMI, degree, &samples(false)).unwrap_err();
        assert_eq!(undecided, ChaosError::Undecided { samples: 150, terms: 286 });
        // Equal points say no more than one.
        let same = vec![sample(1, true); 100];
        assert!(matches!(Chaos::of_samples(&ISHIGAMI, 3, &same), Err(ChaosError::Undecided { .. })));
    }

    /// `2π √(l/g)` with a lognormal length is lognormal, too: moments in closed form; and against Monte Carlo.
    #[test]
    fn periods_of_a_pendulum_are_lognormal() {
        let (length, sigma) = (0.5, 0.2);
        let g = Distribution::TruncatedNormal { mean: 9.8, deviation: 0.02, low: 9.7, high: 9.9 };
        let distributions = [Distribution::Lognormal { median: length, deviation: sigma }, g];
        let period = |x: &[f64]| 2.0 * PI * (x[0] / x[1]).sqrt();
        let values: Vec<f64> = grid(&distributions, 5).iter().map(|x| period(x)).collect();
        let chaos = Chaos::of_grid(&distributions, 5, &values).unwrap();
        let sequence = Sequence::new(Kind::Sobol, 1, 1 << 16, 2).unwrap();
        let points = (0..1 << 16).map(|i| sequence.point(i));
        let drawn: crate::statistics::Moments =
            points.map(|p| period(&[distributions[0].quantile(p[0]), g.quantile(p[1])])).collect();
        assert!((chaos.mean() - drawn.mean).abs() < 1e-5, "{} {}", chaos.mean(), drawn.mean);
        assert!((chaos.variance().sqrt() - drawn.deviation()).abs() < 1e-4, "{}", drawn.deviation());
        let fixed = [distributions[0]];
        let values: Vec<f64> = grid(&fixed, 8).iter().map(|x| period(&[x[0], 9.8])).collect();
        let alone = Chaos::of_grid(&fixed, 8, &values).unwrap();
        let half = sigma * sigma / 4.0;
        let mean = 2.0 * PI * (length / 9.8_f64).sqrt() * (half / 2.0).exp();
        assert!((alone.mean() / mean - 1.0).abs() < 1e-13 && (alone.first(0) - 1.0).abs() < 1e-13);
        assert!((alone.variance() / (mean * mean * half.exp_m1()) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn what_is_missing_is_said() {
        let one = [Distribution::Uniform { low: 0.0, high: 1.0 }];
        let error = |values: &[f64]| Chaos::of_grid(&one, 1, values).unwrap_err().to_string();
        assert_eq!(error(&[1.0, f64::NAN]), "the evaluation 1 is NaN: all must be there, and finite");
        assert_eq!(error(&[1.0]), "the evaluation 1 is NaN: all must be there, and finite");
        let constant = Chaos::of_grid(&one, 1, &[2.0, 2.0]).unwrap();
        assert!((constant.mean() - 2.0).abs() < 1e-15 && constant.variance() < 1e-30);
        // What rounding leaves of a constant is no variance that could be shared.
        let three = [one[0]; 3];
        let constant = Chaos::of_grid(&three, 4, &[36.297; 125]).unwrap();
        let shares = [constant.first(0), constant.total(1), constant.highest()];
        assert!(!constant.varies() && shares.iter().all(|share| share.is_nan()), "{shares:?}");
    }
}
