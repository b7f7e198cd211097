//! Constants that are a rational number and a part of π, `0.5 + π/6`: as angles they are the one and then the other.

use crate::expr::ratio::Ratio;

use super::Number;

impl Number {
    /// The fraction of 64 bits that it is.
    fn ratio(self) -> Option<Ratio> {
        match self {
            Number::Exact { numerator, denominator, pi: 0 } => Ratio::of(numerator, denominator),
            Number::Exact { .. } | Number::Real { .. } => None,
        }
    }

    /// r and s of `r + s·π`.
    pub(in crate::expr) fn parts(self) -> Option<[Ratio; 2]> {
        match self {
            Number::Exact { pi: 0, .. } => Some([self.ratio()?, Ratio::ZERO]),
            Number::Exact { numerator, denominator, pi: 1 } => {
                Some([Ratio::ZERO, Number::rational(numerator, denominator)?.ratio()?])
            }
            Number::Exact { .. } | Number::Real { parts: [_, 0, ..], .. } => None,
            Number::Real { parts: [r, over_r, s, over_s], .. } => {
                let ratio = |numerator: i32, denominator: i32| Ratio {
                    numerator: numerator.into(),
                    denominator: denominator.into(),
                };
                Some([ratio(r, over_r), ratio(s, over_s)])
            }
        }
    }

    /// The same constant, which is `r + s·π`; these are kept where they are short.
    fn with_parts(self, parts: Option<[Ratio; 2]>) -> Number {
        let short = |n: i64| i32::try_from(n).ok().filter(|n| *n != i32::MIN);
        let all = |[r, s]: [Ratio; 2]| {
            Some([short(r.numerator)?, short(r.denominator)?, short(s.numerator)?, short(s.denominator)?])
        };
        match (self, parts) {
            (Number::Exact { .. }, _) => self,
            (_, Some([r, Ratio::ZERO])) => {
                Number::Exact { numerator: r.numerator.into(), denominator: r.denominator.into(), pi: 0 }
            }
            (_, Some([Ratio::ZERO, s])) => {
                Number::Exact { numerator: s.numerator.into(), denominator: s.denominator.into(), pi: 1 }
            }
            (Number::Real { value, rest, error, images, .. }, parts) => match parts.and_then(all) {
                Some(parts) => Number::Real { value, rest, error, images, parts },
                None => self,
            },
        }
    }

    /// The same constant, which is the sum of two.
    pub(super) fn as_sum(self, a: Number, b: Number) -> Number {
        // Sums of one power of π are long, and no angles of two parts.
        let is_of_parts = match (a, b) {
            (Number::Exact { pi, .. }, Number::Exact { pi: other, .. }) => pi != other,
            _ => [a, b].iter().all(|n| matches!(n, Number::Exact { .. }) || n.parts().is_some()),
        };
        if !is_of_parts {
            return self;
        }
        let parts = a.parts().zip(b.parts());
        self.with_parts(parts.and_then(|([a, b], [c, d])| Some([a.plus(c)?, b.plus(d)?])))
    }

    /// The same constant, which is the product of two.
    pub(super) fn as_product(self, a: Number, b: Number) -> Number {
        let is_exact = matches!((a, b), (Number::Exact { .. }, Number::Exact { .. }));
        match (a.parts(), b.parts()) {
            (Some([r, s]), Some([c, Ratio::ZERO])) | (Some([c, Ratio::ZERO]), Some([r, s])) if !is_exact => {
                self.with_parts(r.times(c).zip(s.times(c)).map(|(r, s)| [r, s]))
            }
            _ => self,
        }
    }
}
