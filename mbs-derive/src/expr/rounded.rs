//! Numbers that know how far rounding may have carried them: running error analysis.
//!
//! Source: Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, section 3.3.

mod definite;

use std::iter::Sum;
use std::ops::{Add, Mul, Neg, Sub};

use super::constrained::{NullSpace, remainder};
use super::dual::slope;
use super::evaluate::{Solution, Solutions, Terms, Value};
use super::function::{Binary, Function};
use super::number::Number;
use super::sparse::{self, Elimination};
use definite::Factors;

/// Of more unknowns an inverse is bounded, and not computed, where there are no constraints.
const FEW: usize = 64;

/// Below this no result is told from zero. Its square is still a normal number: arithmetic with those that are not is
/// slow.
const FLOOR: f64 = 1e-150;

/// A double and a bound, to first order, on its distance from the exact result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounded {
    /// The value, as doubles give it.
    pub value: f64,
    /// How far it may be from the exact one.
    pub error: f64,
}

impl Rounded {
    /// A value that is exact.
    pub fn exact(value: f64) -> Self {
        Rounded { value, error: 0.0 }
    }

    /// The result of an operation whose operands bring in the error `inherited`.
    fn of(value: f64, inherited: f64) -> Self {
        Rounded { value, error: inherited + value.abs() * f64::EPSILON + FLOOR }
    }
}

impl From<Number> for Rounded {
    fn from(number: Number) -> Self {
        Rounded { value: number.to_f64(), error: number.error() }
    }
}

impl Add for Rounded {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Rounded::of(self.value + other.value, self.error + other.error)
    }
}

impl Sub for Rounded {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Rounded::of(self.value - other.value, self.error + other.error)
    }
}

impl Mul for Rounded {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let inherited = self.value.abs() * other.error + other.value.abs() * self.error + self.error * other.error;
        Rounded::of(self.value * other.value, inherited)
    }
}

impl Neg for Rounded {
    type Output = Self;
    fn neg(self) -> Self {
        Rounded { value: -self.value, error: self.error }
    }
}

impl Sum for Rounded {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Rounded::default(), |sum, term| sum + term)
    }
}

impl Value for Rounded {
    fn constant(value: f64) -> Self {
        Rounded { value, error: value.abs() * f64::EPSILON }
    }
    fn number(number: Number) -> Self {
        number.into()
    }
    fn neg(self) -> Self {
        -self
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        Rounded::of(quotient, (self.error + quotient.abs() * other.error) / other.value.abs())
    }
    fn power(self, halves: i32) -> Self {
        // Whatever x is: the slope below would be 0 · ∞ at zero.
        if halves == 0 {
            return Rounded::exact(1.0);
        }
        let slope = f64::from(halves) / 2.0 * self.value.power(halves - 2);
        Rounded::of(self.value.power(halves), f64::from(halves.abs()) * f64::EPSILON * self.value.power(halves).abs())
            .widened(slope, self.error)
    }
    fn call(self, function: Function) -> Self {
        Rounded::of(function.value(self.value), 0.0).widened(slope(function, self.value), self.error)
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        let value = function.value(a, b);
        let [by_a, by_b] = match function {
            Binary::Atan2 => [b / (a * a + b * b), a / (a * a + b * b)],
            // Of the size: a power of a negative number has an integer for its exponent, and is of either sign.
            Binary::Powf => [b * a.powf(b - 1.0), if value == 0.0 { 0.0 } else { value * a.abs().ln() }],
        };
        Rounded::of(value, 0.0).widened(by_a, self.error).widened(by_b, other.error)
    }
    fn rate(self) -> Self {
        Rounded::exact(f64::NAN)
    }
    fn is_exactly_zero(self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }
    fn less(self, other: Self) -> bool {
        self.value < other.value
    }
    fn less_equal(self, other: Self) -> bool {
        self.value <= other.value
    }
    /// The solution in doubles, and how far it may be from the exact one: `|K⁻¹| |b − K x|`, where the remainder
    /// carries what rounding has done to K, to b and to itself. So the bound follows the condition of the constrained
    /// motion, and knows nothing of how the solution was found.
    ///
    /// Source: Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, sections 7.1 and 15.1.
    fn constrained_columns<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solutions<'a, Self>
    where
        Self: 'a,
    {
        let doubles = |numbers: &[Self]| numbers.iter().map(|number| number.value).collect::<Vec<f64>>();
        let is_large = vectors.is_empty() && n > FEW;
        if let Some(factors) = is_large.then(|| Factors::of(n, &doubles(&mass))).flatten() {
            return Box::new(move |columns, _| columns.iter().map(|column| bounded(&factors, &mass, column)).collect());
        }
        let is_large = n + vectors.len() > FEW;
        if let Some((elimination, entries)) =
            is_large.then(|| Elimination::of_values(n, &mass, &jacobian, |x| x.is_exactly_zero())).flatten()
            && let Some(factors) = sparse::Factors::new(&elimination, &doubles(&entries))
        {
            let vectors = vectors.to_vec();
            return Box::new(move |columns, terms| {
                let bounded = |column: &Vec<Self>| bounded_by_pivots(&elimination, &entries, &factors, column);
                let found: Option<Vec<_>> = columns.iter().map(bounded).collect();
                found.unwrap_or_else(|| in_full(n, mass.clone(), jacobian.clone(), &vectors)(columns, terms))
            });
        }
        in_full(n, mass, jacobian, vectors)
    }
    fn eliminated<'a>(elimination: &'a Elimination, entries: Vec<Self>) -> Solution<'a, Self>
    where
        Self: 'a,
    {
        let values: Vec<f64> = entries.iter().map(|entry| entry.value).collect();
        let factors = sparse::Factors::new(elimination, &values);
        Box::new(move |column| {
            let found = factors.as_ref().and_then(|factors| bounded_by_pivots(elimination, &entries, factors, column));
            found.unwrap_or_else(|| vec![Rounded { value: f64::NAN, error: f64::NAN }; column.len()])
        })
    }
    fn exponent(self) -> i32 {
        self.value.exponent()
    }
}

/// q̈ and λ by the basis of the motions that A leaves, and how far they may be from the exact ones.
fn in_full<'a>(n: usize, mass: Vec<Rounded>, jacobian: Vec<Rounded>, vectors: &[usize]) -> Solutions<'a, Rounded> {
    let doubles = |numbers: &[Rounded]| numbers.iter().map(|number| number.value).collect::<Vec<f64>>();
    let system = NullSpace::new(n, &doubles(&mass), &doubles(&jacobian), vectors);
    let size = n + vectors.len();
    let unit = |j: usize| (0..size).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
    // Rows that depend on others take no part: they have agreed.
    let response = |system: &NullSpace<f64>, j: usize| system.solve_independent_rows(&unit(j));
    let inverse: Option<Vec<Vec<f64>>> = system.as_ref().and_then(|s| (0..size).map(|j| response(s, j)).collect());
    let undefined = move || vec![Rounded { value: f64::NAN, error: f64::NAN }; size];
    let bounded = move |column: &[Rounded], solution: &[f64], inverse: &[Vec<f64>]| {
        let exact: Vec<Rounded> = solution.iter().map(|&x| Rounded::exact(x)).collect();
        let rest = remainder(&mass, &jacobian, column, &exact, n);
        let mut bounded = exact;
        for (rest, response) in rest.iter().zip(inverse) {
            let rest = rest.value.abs() + rest.error;
            bounded.iter_mut().zip(response).for_each(|(x, to)| x.error += to.abs() * rest);
        }
        bounded
    };
    Box::new(move |columns, terms| {
        let Some((system, inverse)) = system.as_ref().zip(inverse.as_ref()) else {
            return columns.iter().map(|_| undefined()).collect();
        };
        let terms = Terms {
            sizes: terms.sizes.iter().map(|sizes| doubles(sizes)).collect(),
            motion: doubles(&terms.motion),
            scales: doubles(&terms.scales),
        };
        let values: Vec<Vec<f64>> = columns.iter().map(|column| doubles(column)).collect();
        let solutions = system.solve(&values, &terms).into_iter().zip(columns);
        solutions.map(|(x, column)| x.map_or_else(undefined, |x| bounded(column, &x, inverse))).collect()
    })
}

/// q̈ and λ of a large system with constraints, and how far they may be from the exact ones; `None` where pivots do not
/// find them.
fn bounded_by_pivots(
    elimination: &Elimination,
    entries: &[Rounded],
    factors: &sparse::Factors<f64>,
    column: &[Rounded],
) -> Option<Vec<Rounded>> {
    let b: Vec<f64> = column.iter().map(|number| number.value).collect();
    let solution = factors.solution(elimination, &b)?;
    let solution: Vec<Rounded> = solution.into_iter().map(Rounded::exact).collect();
    let rest = elimination.times(entries, &solution).into_iter().zip(column).map(|(found, &b)| b - found);
    let sizes: Vec<f64> = rest.map(|rest| rest.value.abs() + rest.error).collect();
    let errors = factors.bounds(elimination, &sizes);
    let bounded = solution.into_iter().zip(errors).map(|(x, error)| Rounded { error, ..x }).collect();
    Some(elimination.signed(bounded))
}

/// The solution of a large system without constraints, and how far it may be from the exact one.
fn bounded(factors: &Factors, mass: &[Rounded], column: &[Rounded]) -> Vec<Rounded> {
    let b: Vec<f64> = column.iter().map(|number| number.value).collect();
    let solution: Vec<Rounded> = factors.solve(&b).into_iter().map(Rounded::exact).collect();
    let rest = remainder(mass, &[], column, &solution, column.len());
    let sizes: Vec<f64> = rest.iter().map(|rest| rest.value.abs() + rest.error).collect();
    let errors = factors.bounds(&sizes);
    solution.into_iter().zip(errors).map(|(x, error)| Rounded { error, ..x }).collect()
}

impl Rounded {
    /// With the error that an argument's error causes; none where the argument is exact, even at a vertical slope.
    fn widened(self, slope: f64, error: f64) -> Self {
        let more = if error == 0.0 { 0.0 } else { slope.abs() * error };
        Rounded { error: self.error + more, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancellation_leaves_the_error_of_what_cancelled() {
        let x = Rounded::exact(0.7);
        let unit = x.call(Function::Sin).power(4) + x.call(Function::Cos).power(4);
        let zero = unit - Rounded::exact(1.0);
        assert!(zero.value.abs() <= zero.error);
        assert!(zero.error < 1e-14);
    }

    /// Where x is a zero that was computed, its second derivative is known all the same.
    #[test]
    fn a_square_at_zero_has_a_bound_in_every_derivative() {
        use crate::expr::Dual;
        let zero = Rounded::exact(0.7) - Rounded::exact(0.7);
        let x = Dual::new(Dual::new(zero, Rounded::exact(1.0)), Dual::fixed(Rounded::exact(1.0)));
        let square = x.power(4);
        assert_eq!(square.derivative.derivative.value, 2.0);
        assert!(square.derivative.derivative.error < 1e-14);
    }

    #[test]
    fn powers_of_negative_numbers_have_a_bound() {
        let exponent = Rounded::constant(4.0) - Rounded::constant(1.0);
        let cube = |x| Rounded::constant(x).call2(Binary::Powf, exponent);
        assert_eq!((cube(-2.0).value, cube(-2.0).error), (-8.0, cube(2.0).error));
        assert!(cube(2.0).error < 1e-13 && cube(0.0).error < 1e-13);
    }

    #[test]
    fn an_ill_conditioned_quotient_says_so() {
        let tiny = Rounded::constant(0.1) + Rounded::constant(0.2) - Rounded::constant(0.3);
        let quotient = Rounded::exact(1.0).div(tiny);
        assert!(quotient.error > 0.1 * quotient.value.abs());
    }
}
