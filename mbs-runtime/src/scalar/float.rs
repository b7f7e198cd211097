//! `f32` and `f64`, with the mathematics of the standard library or of libm.

use super::{Real, Scalar, sin_cos};

/// One elementary function of both types: `inherent name, libm's name for f64, libm's name for f32`.
macro_rules! call {
    ($float:ty, $std:ident, $libm:path; $($argument:expr),+) => {{
        #[cfg(feature = "std")]
        { <$float>::$std($($argument),+) }
        #[cfg(not(feature = "std"))]
        { $libm($($argument),+) }
    }};
}

macro_rules! scalar {
    ($float:ty, $polynomials:ident; $($name:ident = $libm:path),+; atan2 = $atan2:path; powf = $powf:path; fma = $fma:path) => {
        impl Scalar for $float {
            type Mask = bool;

            const ROUNDING: f64 = <$float>::EPSILON as f64;

            #[inline]
            fn exponent(self) -> i32 {
                let exponent = |x: f64| ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
                exponent(f64::from(self)).max(<$float>::MIN_EXP - 1)
            }

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $float
            }

            $(
                #[inline]
                fn $name(self) -> Self {
                    call!($float, $name, $libm; self)
                }
            )+

            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                (Scalar::sin(self), Scalar::cos(self))
            }

            #[inline(always)]
            fn sin_cos_all<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
                sin_cos::$polynomials::all(angles)
            }

            #[inline]
            fn atan2(self, x: Self) -> Self {
                call!($float, atan2, $atan2; self, x)
            }

            #[inline]
            fn powf(self, exponent: Self) -> Self {
                call!($float, powf, $powf; self, exponent)
            }

            #[inline]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }

            #[inline]
            fn signum(self) -> Self {
                if self == 0.0 { 0.0 } else { <$float>::signum(self) }
            }

            #[inline]
            fn mul_add(self, factor: Self, summand: Self) -> Self {
                if cfg!(target_feature = "fma") {
                    call!($float, mul_add, $fma; self, factor, summand)
                } else {
                    self * factor + summand
                }
            }

            #[inline]
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }

            #[inline]
            fn less(self, other: Self) -> bool {
                self < other
            }

            #[inline]
            fn less_equal(self, other: Self) -> bool {
                self <= other
            }

            #[inline]
            fn equal(self, other: Self) -> bool {
                self == other
            }

            #[inline]
            fn blend(mask: bool, then: Self, otherwise: Self) -> Self {
                if mask { then } else { otherwise }
            }
        }

        impl Real for $float {
            const EPSILON: Self = <$float>::EPSILON;
            const MIN_POSITIVE: Self = <$float>::MIN_POSITIVE;

            #[inline]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        }
    };
}

scalar!(f64, double;
    sin = libm::sin, cos = libm::cos, tan = libm::tan, asin = libm::asin, acos = libm::acos, atan = libm::atan,
    sinh = libm::sinh, cosh = libm::cosh, tanh = libm::tanh, exp = libm::exp, ln = libm::log, sqrt = libm::sqrt;
    atan2 = libm::atan2; powf = libm::pow; fma = libm::fma);

scalar!(f32, single;
    sin = libm::sinf, cos = libm::cosf, tan = libm::tanf, asin = libm::asinf, acos = libm::acosf, atan = libm::atanf,
    sinh = libm::sinhf, cosh = libm::coshf, tanh = libm::tanhf, exp = libm::expf, ln = libm::logf, sqrt = libm::sqrtf;
    atan2 = libm::atan2f; powf = libm::powf; fma = libm::fmaf);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signum_of_zero_is_zero() {
        for (x, sign) in [(0.0, 0.0), (-0.0, 0.0), (3.0, 1.0), (-1e-300, -1.0), (f64::INFINITY, 1.0)] {
            assert_eq!(Scalar::signum(x), sign);
        }
        assert!(Scalar::signum(f64::NAN).is_nan());
    }

    #[test]
    fn sine_and_cosine_are_the_same_bits_as_each_alone() {
        for i in 0..10_000 {
            let x = -50.0 + 0.01 * f64::from(i);
            let (sin, cos) = Scalar::sin_cos(x);
            assert_eq!((sin.to_bits(), cos.to_bits()), (Scalar::sin(x).to_bits(), Scalar::cos(x).to_bits()));
            let (sin, cos) = Scalar::sin_cos(x as f32);
            assert_eq!(sin.to_bits(), Scalar::sin(x as f32).to_bits());
            assert_eq!(cos.to_bits(), Scalar::cos(x as f32).to_bits());
        }
    }

    #[test]
    fn argument_order_is_that_of_f64() {
        let quarter: f64 = Scalar::atan2(1.0, 0.0);
        assert_eq!(quarter, core::f64::consts::FRAC_PI_2);
        assert_eq!(Scalar::powf(2.0, 10.0), 1024.0);
        assert_eq!(Scalar::mul_add(2.0, 3.0, 4.0), 10.0);
        assert_eq!(Scalar::ln(1.0_f32), 0.0);
    }

    #[test]
    fn only_the_side_taken_is_evaluated() {
        let taken = f64::select(1.0_f64.less(2.0), || 5.0, || panic!("the other side"));
        assert_eq!(taken, 5.0);
        let taken = f64::select(!1.0_f64.less_equal(1.0), || panic!("the other side"), || 6.0);
        assert_eq!(taken, 6.0);
        let taken = f64::select_each(f64::NAN.less_equal(f64::NAN), || panic!("the other side"), || [7.0, 8.0]);
        assert_eq!(taken, [7.0, 8.0]);
    }

    #[test]
    fn exponents_are_those_of_normal_numbers() {
        for (x, exponent) in [(0.75, -1), (-8.0, 3), (f64::MIN_POSITIVE, -1022), (1e-310, -1022)] {
            assert_eq!(Scalar::exponent(x), exponent, "{x:e}");
        }
        for (x, exponent) in [(0.75_f32, -1), (-8.0, 3), (f32::MIN_POSITIVE, -126), (1e-40, -126)] {
            assert_eq!(Scalar::exponent(x), exponent, "{x:e}");
        }
    }

    #[test]
    fn the_maximum_keeps_a_nan() {
        assert_eq!(1.0.maximum(2.0), 2.0);
        assert!(Scalar::maximum(1.0, f64::NAN).is_nan());
        assert!(Scalar::maximum(f64::NAN, 1.0).is_nan());
    }
}
