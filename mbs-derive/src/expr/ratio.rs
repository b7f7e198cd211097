//! Rational numbers of 64 bits, known as long as they fit.

use super::number::Number;

/// In lowest terms, with a positive denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Ratio {
    pub(super) numerator: i64,
    pub(super) denominator: i64,
}

impl Ratio {
    pub(super) const ZERO: Ratio = Ratio { numerator: 0, denominator: 1 };
    pub(super) const ONE: Ratio = Ratio { numerator: 1, denominator: 1 };
    pub(super) const TWO: Ratio = Ratio { numerator: 2, denominator: 1 };

    pub(super) fn of(numerator: i128, denominator: i128) -> Option<Ratio> {
        match Number::rational(numerator, denominator)? {
            Number::Exact { numerator, denominator, .. } => {
                let (numerator, denominator) = (i64::try_from(numerator).ok()?, i64::try_from(denominator).ok()?);
                (numerator != i64::MIN).then_some(Ratio { numerator, denominator })
            }
            Number::Real { .. } => None,
        }
    }

    pub(super) fn plus(self, other: Ratio) -> Option<Ratio> {
        if other.numerator == 0 {
            return Some(self);
        }
        if (self.denominator, other.denominator) == (1, 1) {
            let numerator = self.numerator.checked_add(other.numerator).filter(|&n| n != i64::MIN)?;
            return Some(Ratio { numerator, denominator: 1 });
        }
        let [a, b, c, d] = [self.numerator, self.denominator, other.numerator, other.denominator].map(i128::from);
        Ratio::of(a * d + c * b, b * d)
    }

    pub(super) fn times(self, other: Ratio) -> Option<Ratio> {
        let [a, b, c, d] = [self.numerator, self.denominator, other.numerator, other.denominator].map(i128::from);
        Ratio::of(a * c, b * d)
    }

    pub(super) fn negative(self) -> Ratio {
        Ratio { numerator: -self.numerator, ..self }
    }

    pub(super) fn reciprocal(self) -> Option<Ratio> {
        Ratio::of(i128::from(self.denominator), i128::from(self.numerator))
    }

    pub(super) fn integer(self) -> Option<i64> {
        (self.denominator == 1).then_some(self.numerator)
    }

    pub(super) fn root(self) -> Option<Ratio> {
        let exact = |n: i64| n.checked_isqrt().filter(|root| root * root == n);
        Some(Ratio { numerator: exact(self.numerator)?, denominator: exact(self.denominator)? })
    }
}
