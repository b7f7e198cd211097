//! What numbers of a prime field have in common, whatever else is known of them.

use super::evaluate::Value;
use super::number::Number;
use super::ratio::Ratio;

/// A number of a prime field: a [`Residue`](super::Residue), by which the generator decides what is equal, or an
/// [`Image`](super::Image), with which claims are proved.
pub(super) trait Element: Value {
    /// What has no value: 1/0, the root of what is no square.
    const NOT_DEFINED: Self;

    /// A rational number.
    fn rational(ratio: Ratio) -> Self;

    /// An integer whose digits are too many for a [`Ratio`].
    fn long(n: i128) -> Self;

    /// The root that is a square, of a square.
    fn root(self) -> Self;

    /// `n/2`
    fn halved(n: i64) -> Self {
        let whole = Ratio { numerator: n / 2, denominator: 1 };
        Self::rational(if n % 2 == 0 { whole } else { Ratio { numerator: n, denominator: 2 } })
    }

    /// The number that a double stands for.
    fn of_double(value: f64) -> Self {
        const SHORT: f64 = (1u64 << 53) as f64;
        let doubled = 2.0 * value;
        if doubled.fract() == 0.0 && doubled.abs() < SHORT {
            return Self::halved(doubled as i64);
        }
        Number::from_f64(value).map_or(Self::NOT_DEFINED, Self::number)
    }

    /// What a double holds, to the last bit.
    fn dyadic(value: f64) -> Self {
        let (mantissa, exponent) = libm::frexp(value);
        Self::long((mantissa * (1u64 << 53) as f64) as i128).mul(Self::long(2).power(2 * (exponent - 53)))
    }

    /// `self^(halves/2)`, of what has a value.
    fn to_half_power(self, halves: i32) -> Self {
        let base = if halves % 2 == 0 { self } else { self.root() };
        let exponent = if halves % 2 == 0 { halves / 2 } else { halves };
        let (mut power, mut square, mut rest) = (Self::rational(Ratio::ONE), base, exponent.unsigned_abs());
        while rest > 0 {
            if rest % 2 == 1 {
                power = power.mul(square);
            }
            rest /= 2;
            if rest > 0 {
                square = square.mul(square);
            }
        }
        if exponent < 0 { Self::rational(Ratio::ONE).div(power) } else { power }
    }
}
