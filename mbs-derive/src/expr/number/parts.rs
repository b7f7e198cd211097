//! Constants that are a rational number and a part of π, `0.5 + π/6`: as angles they are the one and then the other.

use crate::expr::ratio::Ratio;

use super::Number;

impl Number {
    /// r and s of `r + s·π`.
    pub(in crate::expr) fn parts(self) -> Option<[Ratio; 2]> {
        let ratio =
            |numerator: i32, denominator: i32| Ratio { numerator: numerator.into(), denominator: denominator.into() };
        match self {
            Number::Exact { numerator, denominator, pi: 0 } => Some([Ratio::of(numerator, denominator)?, Ratio::ZERO]),
            Number::Exact { numerator, denominator, pi: 1 } => Some([Ratio::ZERO, Ratio::of(numerator, denominator)?]),
            Number::Exact { .. } | Number::Real { parts: [_, 0, ..], .. } => None,
            Number::Real { parts: [r, over_r, s, over_s], .. } => Some([ratio(r, over_r), ratio(s, over_s)]),
        }
    }

    /// The same constant, which is `r + s·π`; these are kept where they are short.
    fn with_parts(self, [r, s]: [Ratio; 2]) -> Number {
        let short = |n: i64| i32::try_from(n).ok().filter(|n| *n != i32::MIN);
        let all = || Some([short(r.numerator)?, short(r.denominator)?, short(s.numerator)?, short(s.denominator)?]);
        let exact = |ratio: Ratio, pi: i8| Number::Exact {
            numerator: ratio.numerator.into(),
            denominator: ratio.denominator.into(),
            pi,
        };
        match self {
            Number::Exact { .. } => self,
            _ if s == Ratio::ZERO => exact(r, 0),
            _ if r == Ratio::ZERO => exact(s, 1),
            Number::Real { value, rest, error, images, parts } => {
                Number::Real { value, rest, error, images, parts: all().unwrap_or(parts) }
            }
        }
    }

    /// The same constant, which is the sum of two.
    pub(super) fn as_sum(self, a: Number, b: Number) -> Number {
        let parts = a.parts().zip(b.parts()).and_then(|([a, b], [c, d])| Some([a.plus(c)?, b.plus(d)?]));
        parts.map_or(self, |parts| self.with_parts(parts))
    }

    /// The same constant, which is the product of two.
    pub(super) fn as_product(self, a: Number, b: Number) -> Number {
        let parts = match (a.parts(), b.parts()) {
            (Some([r, s]), Some([c, Ratio::ZERO])) | (Some([c, Ratio::ZERO]), Some([r, s])) => {
                r.times(c).zip(s.times(c))
            }
            _ => None,
        };
        parts.map_or(self, |(r, s)| self.with_parts([r, s]))
    }
}
