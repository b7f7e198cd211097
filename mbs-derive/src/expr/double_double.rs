//! Numbers of about 100 bits, each the sum of two doubles: what constants are folded in, so that what is emitted is
//! rounded once. The same bits on every machine.
//!
//! Sources: Dekker, *A floating-point technique for extending the available precision*, Numerische Mathematik 18, 1971;
//! Knuth, *The Art of Computer Programming*, vol. 2, section 4.2.2; the operations and their bounds are those of
//! Joldes, Muller, Popescu, *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*, ACM
//! Transactions on Mathematical Software 44:2, 2017, by the number of the algorithm; the root is that of Lefèvre,
//! Louvet, Muller, Picot, Rideau, *Accurate calculation of Euclidean norms using double-word arithmetic*, ibid. 49:1,
//! 2023.

use super::evaluate::Value;
use super::function::{Binary, Function, signum};
use super::number::Number;

/// `high + low`, where `high` is the double nearest to the sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DoubleDouble {
    pub(super) high: f64,
    pub(super) low: f64,
}

impl DoubleDouble {
    const ZERO: Self = Self::of(0.0);
    const ONE: Self = Self::of(1.0);
    /// π
    pub(super) const PI: Self = DoubleDouble { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    /// A bound on the relative error of every operation and function here. The largest is that of `exp(b ln a)`, a
    /// thousand times 2⁻¹⁰³.
    pub(super) const UNIT: f64 = 1.0 / (1u128 << 92) as f64;
    /// Below this, products of low parts are less than any double: numbers are as good as doubles.
    const SMALL: f64 = 1e-280;

    /// A bound on the error of an operation or function with this result.
    pub(super) fn rounding(self) -> f64 {
        let size = self.high.abs();
        if size < Self::SMALL { size * f64::EPSILON + 64.0 * f64::from_bits(1) } else { size * Self::UNIT }
    }

    pub(super) const fn of(double: f64) -> Self {
        DoubleDouble { high: double, low: 0.0 }
    }

    pub(super) fn of_integer(n: i128) -> Self {
        let high = n as f64;
        Self::fast_sum(high, n.saturating_sub(high as i128) as f64)
    }

    /// Knuth's sum of two doubles, exactly.
    fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_in_sum = high - a;
        DoubleDouble { high, low: (a - (high - b_in_sum)) + (b - b_in_sum) }
    }

    /// Dekker's sum of two doubles, of which the first is not smaller, exactly.
    fn fast_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        DoubleDouble { high, low: b - (high - a) }
    }

    /// The product of two doubles, exactly.
    fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        DoubleDouble { high, low: libm::fma(a, b, -high) }
    }

    fn is_negative(self) -> bool {
        self.high < 0.0
    }

    fn sqrt(self) -> Self {
        if self.high == 0.0 {
            return Self::ZERO;
        }
        let root = libm::sqrt(self.high);
        let rest = libm::fma(-root, root, self.high) + self.low;
        Self::fast_sum(root, rest / (2.0 * root))
    }

    /// By repeated squaring.
    pub(super) fn powi(self, exponent: i32) -> Self {
        let (mut result, mut square, mut n) = (Self::ONE, self, exponent.unsigned_abs());
        while n > 0 {
            if n % 2 == 1 {
                result = result.mul(square);
            }
            n /= 2;
            if n > 0 {
                square = square.mul(square);
            }
        }
        if exponent < 0 { Self::ONE.div(result) } else { result }
    }

    /// `self − k c`, of a constant in three parts.
    fn without(self, k: f64, parts: [f64; 3]) -> Self {
        parts.iter().fold(self, |rest, &part| rest.sub(Self::product(k, part)))
    }

    /// `first (1 + x/(a₁) (1 + x/(a₂) (1 + …)))`, up to where terms vanish; `divisor(k)` is `a_k`.
    fn series(first: Self, x: Self, divisor: impl Fn(f64) -> f64) -> Self {
        let (mut sum, mut term) = (first, first);
        for k in 1..40 {
            term = term.mul(x).div(Self::of(divisor(f64::from(k))));
            sum = sum.add(term);
        }
        sum
    }

    fn exp(self) -> Self {
        const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17, 5.707_708_438_416_212e-34];
        let k = libm::round(self.high / LN_2[0]);
        if k.abs() > 1070.0 {
            return Self::of(libm::exp(self.high));
        }
        let power = Self::series(Self::ONE, self.without(k, LN_2), |k| k);
        let scaled = |part| libm::scalbn(part, k as i32);
        Self::fast_sum(scaled(power.high), scaled(power.low))
    }

    /// Near 1 `2 artanh((x − 1)/(x + 1))`, elsewhere that of the double and `ln (1 + t) = t − t²/2` of what is left.
    fn ln(self) -> Self {
        let above_one = self.sub(Self::ONE);
        if above_one.high.abs() < 0.1 {
            let s = above_one.div(self.add(Self::ONE));
            let (mut sum, mut power) = (s, s);
            for k in 1..40 {
                power = power.mul(s).mul(s);
                sum = sum.add(power.div(Self::of(f64::from(2 * k + 1))));
            }
            return sum.add(sum);
        }
        let near = Self::of(libm::log(self.high));
        let rest = self.mul(near.neg().exp()).sub(Self::ONE);
        near.add(rest.sub(rest.mul(rest).div(Self::of(2.0))))
    }

    /// Sine and cosine.
    fn sin_cos(self) -> [Self; 2] {
        const RIGHT_ANGLE: [f64; 3] =
            [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
        let (mut x, mut quarters) = (self, 0.0);
        // The number of right angles in a large angle is rounded itself: what that leaves is large, and reduced again.
        while x.high.abs() > 0.8 {
            let k = libm::round(x.high / RIGHT_ANGLE[0]);
            (x, quarters) = (x.without(k, RIGHT_ANGLE), quarters + libm::fmod(k, 4.0));
        }
        let minus_square = x.mul(x).neg();
        let sin = Self::series(x, minus_square, |k| 2.0 * k * (2.0 * k + 1.0));
        let cos = Self::series(Self::ONE, minus_square, |k| 2.0 * k * (2.0 * k - 1.0));
        match (quarters as i64).rem_euclid(4) {
            0 => [sin, cos],
            1 => [cos, sin.neg()],
            2 => [sin.neg(), cos.neg()],
            _ => [cos.neg(), sin],
        }
    }

    fn sinh(self) -> Self {
        if self.high.abs() < 0.5 {
            return Self::series(self, self.mul(self), |k| 2.0 * k * (2.0 * k + 1.0));
        }
        self.exp().sub(self.neg().exp()).div(Self::of(2.0))
    }

    fn cosh(self) -> Self {
        self.exp().add(self.neg().exp()).div(Self::of(2.0))
    }

    /// The angle of the point (x, y): that in doubles, and what is left of it when the point is turned back.
    fn atan2(self, x: Self) -> Self {
        let y = self;
        let near = Self::of(libm::atan2(y.high, x.high));
        if near.high.abs() < Self::SMALL {
            return near;
        }
        let [sin, cos] = near.sin_cos();
        let (across, along) = (y.mul(cos).sub(x.mul(sin)), x.mul(cos).add(y.mul(sin)));
        near.add(across.div(along))
    }

    /// `√(1 − x²)`
    fn beside_on_circle(self) -> Self {
        Self::ONE.sub(self).mul(Self::ONE.add(self)).sqrt()
    }

    fn powf(self, exponent: Self) -> Self {
        let is_integer = exponent.high.fract() == 0.0 && exponent.low == 0.0 && exponent.high.abs() <= 1000.0;
        match (is_integer, self.high == 0.0) {
            (_, true) => Self::of(libm::pow(0.0, exponent.high)),
            (true, _) => self.powi(exponent.high as i32),
            (false, _) if self.is_negative() => Self::of(f64::NAN),
            (false, _) => exponent.mul(self.ln()).exp(),
        }
    }
}

impl Value for DoubleDouble {
    fn constant(value: f64) -> Self {
        Self::of(value)
    }
    fn number(number: Number) -> Self {
        number.to_double_double()
    }
    fn neg(self) -> Self {
        DoubleDouble { high: -self.high, low: -self.low }
    }
    /// Algorithm 6.
    fn add(self, other: Self) -> Self {
        let (highs, lows) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let sum = Self::fast_sum(highs.high, highs.low + lows.high);
        Self::fast_sum(sum.high, lows.low + sum.low)
    }
    fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }
    /// Algorithm 12.
    fn mul(self, other: Self) -> Self {
        let highs = Self::product(self.high, other.high);
        let crossed = libm::fma(self.low, other.high, libm::fma(self.high, other.low, self.low * other.low));
        Self::fast_sum(highs.high, highs.low + crossed)
    }
    /// Algorithm 17.
    fn div(self, other: Self) -> Self {
        let quotient = self.high / other.high;
        let product = other.mul(Self::of(quotient));
        let rest = (self.high - product.high) + (self.low - product.low);
        Self::fast_sum(quotient, rest / other.high)
    }
    fn power(self, halves: i32) -> Self {
        if halves % 2 == 0 { self.powi(halves / 2) } else { self.sqrt().powi(halves) }
    }
    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.sin_cos()[0],
            Function::Cos => self.sin_cos()[1],
            Function::Tan => {
                let [sin, cos] = self.sin_cos();
                sin.div(cos)
            }
            Function::Asin => self.atan2(self.beside_on_circle()),
            Function::Acos => self.beside_on_circle().atan2(self),
            Function::Atan => self.atan2(Self::ONE),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            // The next double is nearer than e⁻⁸⁰.
            Function::Tanh if self.high.abs() > 40.0 => Self::of(signum(self.high)),
            Function::Tanh => self.sinh().div(self.cosh()),
            Function::Sech => Self::ONE.div(self.cosh()),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Abs if self.is_negative() => self.neg(),
            Function::Abs => self,
            Function::Signum => Self::of(signum(self.high)),
        }
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        match function {
            Binary::Atan2 => self.atan2(other),
            Binary::Powf => self.powf(other),
        }
    }
    fn rate(self) -> Self {
        Self::of(f64::NAN)
    }
    fn less(self, other: Self) -> bool {
        self.high < other.high || self.high == other.high && self.low < other.low
    }
    fn less_equal(self, other: Self) -> bool {
        self.high < other.high || self.high == other.high && self.low <= other.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(found: DoubleDouble, expected: DoubleDouble) -> bool {
        found.sub(expected).high.abs() <= DoubleDouble::UNIT * expected.high.abs()
    }

    /// The digits of π, e, ln 10, √2 and sin 1, from tables; each as two doubles.
    #[test]
    fn constants_have_30_digits() {
        let one = DoubleDouble::ONE;
        let decimal = |digits: &str| {
            // Blocks of ten digits behind the point.
            let (whole, rest) = digits.split_once('.').expect("a decimal");
            let block = |i: usize| rest[10 * i..10 * i + 10].parse::<f64>().expect("digits");
            let scale = DoubleDouble::of(1e10);
            let fraction =
                [2, 1, 0].iter().fold(DoubleDouble::ZERO, |sum, &i| sum.add(DoubleDouble::of(block(i))).div(scale));
            DoubleDouble::of(whole.parse().expect("digits")).add(fraction)
        };
        let is = |found: DoubleDouble, digits: &str| {
            let error = found.sub(decimal(digits)).high.abs();
            assert!(error < 1e-29, "{found:?} is not {digits}: {error:e}");
        };
        is(DoubleDouble::PI, "3.141592653589793238462643383279502884");
        is(one.exp(), "2.718281828459045235360287471352662498");
        is(DoubleDouble::of(10.0).ln(), "2.302585092994045684017991454684364208");
        is(DoubleDouble::of(2.0).sqrt(), "1.414213562373095048801688724209698079");
        is(one.sin_cos()[0], "0.841470984807896506652502321630298999");
        is(one.call(Function::Atan).mul(DoubleDouble::of(4.0)), "3.141592653589793238462643383279502884");
    }

    /// The tangent, and what the second part of a large angle does to it, by mpmath 1.3 with 60 digits.
    #[test]
    fn large_angles_are_reduced_with_both_parts() {
        let angle = DoubleDouble { high: 3.857_537_770_932_99e16, low: 1.613_546_770_441_779_2 };
        let [sin, cos] = angle.sin_cos();
        let found = sin.div(cos).high;
        assert!((found + 0.106_397_360_860_925_96).abs() < 1e-16, "{found}");
        let [sin, cos] = DoubleDouble::of(1e22).sin_cos();
        assert!((sin.high + 0.852_200_849_767_188_8).abs() < 2e-16, "{sin:?}");
        assert!(sin.mul(sin).add(cos.mul(cos)).sub(DoubleDouble::ONE).high.abs() < 1e-27);
        assert!(DoubleDouble::of(f64::INFINITY).sin_cos()[0].high.is_nan());
    }

    #[test]
    fn inverse_functions_lead_back() {
        use Function::{Acos, Asin, Atan, Cos, Exp, Ln, Sin, Sinh, Tan};
        for x in [1e-9, 0.03, 0.3, 0.999, 1.0, 1.04] {
            let x = DoubleDouble::of(x).div(DoubleDouble::of(1.1));
            for (function, inverse) in [(Asin, Sin), (Acos, Cos), (Atan, Tan), (Ln, Exp), (Exp, Ln)] {
                if x.high < 0.01 && [Exp, Acos].contains(&function) {
                    continue; // what is next to 1 has lost its digits
                }
                assert!(is_near(x.call(function).call(inverse), x), "{function:?} of {x:?}");
            }
            let sinh = x.call(Sinh);
            let root = sinh.mul(sinh).add(DoubleDouble::ONE).sqrt();
            assert!(is_near(x.cosh(), root), "cosh of {x:?}");
            assert!(is_near(x.powf(DoubleDouble::of(0.5)), x.sqrt()), "power of {x:?}");
        }
        assert!(DoubleDouble::of(1.5).call(Asin).high.is_nan() && DoubleDouble::of(-1.0).ln().high.is_nan());
    }
}
