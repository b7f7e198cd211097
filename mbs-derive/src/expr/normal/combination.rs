//! Linear combinations, and polynomials among them.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use crate::expr::{Id, Number};

pub(crate) use super::powers::Powers;

/// Products with powers beyond this many halves are not formed.
const HIGHEST: i32 = 200;

/// Products of more than this many different expressions are not formed: sums that stay factors would gather without
/// end.
const MOST_FACTORS: usize = 100;

/// Terms with their coefficients, none of them zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Combination<K>(pub BTreeMap<K, Number>);

/// A sum of products of powers, in halves, none of them zero.
pub(crate) type Polynomial = Combination<Powers>;

impl<K> Default for Combination<K> {
    fn default() -> Self {
        Combination(BTreeMap::new())
    }
}

impl<K: Ord + Clone> Combination<K> {
    /// One term.
    pub(crate) fn term(key: K, coefficient: Number) -> Self {
        let mut sum = Self::default();
        sum.add(key, coefficient);
        sum
    }

    /// Adds a term.
    pub(crate) fn add(&mut self, key: K, coefficient: Number) {
        match self.0.entry(key) {
            Entry::Vacant(_) if coefficient.is_zero() => {}
            Entry::Vacant(place) => {
                place.insert(coefficient);
            }
            Entry::Occupied(mut known) => {
                let sum = *known.get() + coefficient;
                if sum.is_zero() {
                    known.remove();
                } else {
                    known.insert(sum);
                }
            }
        }
    }

    /// The coefficient of a term, 0 where there is none.
    pub(crate) fn coefficient(&self, key: &K) -> Number {
        self.0.get(key).copied().unwrap_or(Number::ZERO)
    }

    /// `self + factor · other`
    pub(crate) fn plus(&self, other: &Self, factor: Number) -> Self {
        let mut sum = self.clone();
        other.0.iter().for_each(|(key, &coefficient)| sum.add(key.clone(), coefficient * factor));
        sum
    }

    /// `−self`
    pub(crate) fn negative(&self) -> Self {
        Self::default().plus(self, -Number::ONE)
    }

    /// The only term, where there is one.
    pub(crate) fn as_term(&self) -> Option<(&K, Number)> {
        match self.0.first_key_value() {
            Some((key, &coefficient)) if self.0.len() == 1 => Some((key, coefficient)),
            _ => None,
        }
    }

    /// The product, given that of two terms; `None` beyond `limit` terms, or where two terms or coefficients have no
    /// product.
    pub(crate) fn product(
        &self,
        other: &Self,
        limit: usize,
        of_terms: impl Fn(&K, &K) -> Option<Vec<(K, Number)>>,
    ) -> Option<Self> {
        let mut product = Self::default();
        for (a, &x) in &self.0 {
            for (b, &y) in &other.0 {
                for (key, factor) in of_terms(a, b)? {
                    product.add(key, x.times(y)?.times(factor)?);
                }
            }
            if product.0.len() > limit {
                return None;
            }
        }
        Some(product)
    }
}

impl Polynomial {
    /// A power, in halves, of one indivisible expression.
    pub(crate) fn atom(id: Id, halves: i32) -> Self {
        Combination::term([(id, halves)].into(), Number::ONE)
    }

    /// `self · other`; `None` beyond `limit` terms, or where a power is too high.
    pub(crate) fn times(&self, other: &Self, limit: usize) -> Option<Self> {
        self.product(other, limit, |a, b| Some(vec![(product_of_powers(a, b)?, Number::ONE)]))
    }

    /// A whole power of the only term, where there is one.
    pub(crate) fn monomial_power(&self, n: i32) -> Option<Self> {
        let (powers, coefficient) = self.as_term()?;
        Some(Combination::term(power_of_powers(powers, n)?, coefficient.kept_power(n.checked_mul(2)?)?))
    }
}

/// The product of two products of powers; `None` where a power is too high, or factors are too many.
pub(crate) fn product_of_powers(a: &Powers, b: &Powers) -> Option<Powers> {
    let product = a.plus(b, 1);
    let is_too_high = |id| product.get(id).is_some_and(|halves| halves.abs() > HIGHEST);
    (product.len() <= MOST_FACTORS && !b.keys().any(is_too_high)).then_some(product)
}

/// A whole power of a product of powers; `None` where a power is too high.
pub(crate) fn power_of_powers(powers: &Powers, n: i32) -> Option<Powers> {
    let power = |(&id, &halves): (&Id, &i32)| match halves.checked_mul(n) {
        Some(product) if product.abs() <= HIGHEST => Some((id, product)),
        _ => None,
    };
    if n == 0 { Some(Powers::new()) } else { powers.iter().map(power).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_cancel_and_stop_growing() {
        let [x, y] = [Id(0), Id(1)].map(|id| Polynomial::atom(id, 2));
        let (sum, difference) = (x.plus(&y, Number::ONE), x.plus(&y, -Number::ONE));
        let squares = sum.times(&difference, 10).unwrap();
        let expected = Polynomial::atom(Id(0), 4).plus(&Polynomial::atom(Id(1), 4), -Number::ONE);
        assert_eq!(squares, expected);
        assert_eq!(sum.times(&sum, 2), None);
        assert_eq!(x.monomial_power(-3), Some(Polynomial::atom(Id(0), -6)));
        assert_eq!(x.monomial_power(101), None);
        assert_eq!(sum.monomial_power(2), None);
        assert_eq!(x.times(&Polynomial::atom(Id(0), -2), 10).unwrap().as_term(), Some((&Powers::new(), Number::ONE)));
    }
}
