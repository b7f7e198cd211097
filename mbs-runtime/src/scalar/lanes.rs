//! SIMD lanes: two to eight `f64` or four to sixteen `f32` that go through the same equations together.
//!
//! With `std` or `libm` every lane has the bits that one number has: sines and cosines are those of
//! [`Scalar::sin_cos_all`], vectorised, and the other elementary functions are the number's own, one lane after the
//! other. Without both they are those of the crate `wide`: vectorised, up to a few units in the last place away.

use wide::{f32x4, f32x8, f32x16, f64x2, f64x4, f64x8};

use super::{Mask, Scalar};
use crate::dynamics::Terms;

/// One lane of a matrix.
fn of_lane<L: Copy, F, const R: usize, const C: usize>(matrix: &[[L; C]; R], lane: impl Fn(L) -> F) -> [[F; C]; R] {
    matrix.map(|row| row.map(&lane))
}

macro_rules! lanes {
    ($lanes:ty, $float:ty, $polynomials:ident) => {
        impl Mask for $lanes {
            #[inline]
            fn all(self) -> bool {
                <$lanes>::all(self)
            }

            #[inline]
            fn any(self) -> bool {
                <$lanes>::any(self)
            }
        }

        impl Scalar for $lanes {
            /// All bits of a lane are set where it is true.
            type Mask = $lanes;

            const ROUNDING: f64 = <$float>::EPSILON as f64;

            /// Lane by lane.
            fn constrained_solve<const N: usize, const K: usize, const C: usize>(
                m: &[[Self; N]; N],
                a: &[[Self; N]; K],
                force: &[[Self; C]; N],
                target: &[[Self; C]; K],
                terms: &Terms<'_, Self, N, K, C>,
            ) -> ([[Self; C]; N], [[Self; C]; K]) {
                let (mut accelerations, mut multipliers) = ([[Self::zero(); C]; N], [[Self::zero(); C]; K]);
                for lane in 0..size_of::<$lanes>() / size_of::<$float>() {
                    let (m, a) = (of_lane(m, |x| x.as_array()[lane]), of_lane(a, |x| x.as_array()[lane]));
                    let (f, c) = (of_lane(force, |x| x.as_array()[lane]), of_lane(target, |x| x.as_array()[lane]));
                    let sizes = terms.sizes.map(|sizes| of_lane(sizes, |x| x.as_array()[lane]));
                    let motion = terms.motion.map(|motion| motion.map(|x| x.as_array()[lane]));
                    let scales = terms.scales.map(|x| x.as_array()[lane]);
                    let vectors = terms.vectors;
                    let terms = Terms { vectors, sizes: sizes.as_ref(), motion: motion.as_ref(), scales };
                    let (q, l) = <$float>::constrained_solve(&m, &a, &f, &c, &terms);
                    let put = |x: &mut Self, value: $float| x.as_mut_array()[lane] = value;
                    accelerations.as_flattened_mut().iter_mut().zip(q.as_flattened()).for_each(|(x, &q)| put(x, q));
                    multipliers.as_flattened_mut().iter_mut().zip(l.as_flattened()).for_each(|(x, &l)| put(x, l));
                }
                (accelerations, multipliers)
            }

            #[inline]
            fn from_f64(value: f64) -> Self {
                <$lanes>::splat(value as $float)
            }

            #[cfg(any(feature = "std", feature = "libm"))]
            lanes!(@each $lanes, $float: tan asin acos atan sinh cosh tanh exp ln);
            #[cfg(not(any(feature = "std", feature = "libm")))]
            lanes!(@unary $lanes: tan asin acos atan sinh cosh tanh exp ln);
            lanes!(@unary $lanes: sqrt abs);

            #[inline]
            fn sin(self) -> Self {
                Scalar::sin_cos(self).0
            }

            #[inline]
            fn cos(self) -> Self {
                Scalar::sin_cos(self).1
            }

            #[cfg(any(feature = "std", feature = "libm"))]
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let (sines, cosines) = super::sin_cos::$polynomials::lanes(self.to_array());
                (sines.into(), cosines.into())
            }

            // Without `map`, whose closures copy vectors through memory.
            #[inline(always)]
            fn sin_cos_all<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
                let (mut sines, mut cosines) = ([Self::zero(); N], [Self::zero(); N]);
                for i in 0..N {
                    (sines[i], cosines[i]) = Scalar::sin_cos(angles[i]);
                }
                (sines, cosines)
            }

            #[cfg(not(any(feature = "std", feature = "libm")))]
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                <$lanes>::sin_cos(self)
            }

            #[cfg(any(feature = "std", feature = "libm"))]
            lanes!(@each_two $lanes, $float: atan2 powf);
            #[cfg(not(any(feature = "std", feature = "libm")))]
            lanes!(@two $lanes: atan2 = atan2, powf = powf_simd);

            #[inline]
            fn signum(self) -> Self {
                // A zero stays as it is; +0 and −0 are the same number.
                self.simd_eq(Self::zero()).select(Self::zero(), <$lanes>::signum(self))
            }

            #[inline]
            fn mul_add(self, factor: Self, summand: Self) -> Self {
                if cfg!(target_feature = "fma") {
                    <$lanes>::mul_add(self, factor, summand)
                } else {
                    self * factor + summand
                }
            }

            #[inline]
            fn is_finite(self) -> bool {
                <$lanes>::is_finite(self).all()
            }

            #[inline]
            fn less(self, other: Self) -> Self {
                self.simd_lt(other)
            }

            #[inline]
            fn less_equal(self, other: Self) -> Self {
                self.simd_le(other)
            }

            #[inline]
            fn equal(self, other: Self) -> Self {
                self.simd_eq(other)
            }

            #[inline]
            fn blend(mask: Self, then: Self, otherwise: Self) -> Self {
                mask.select(then, otherwise)
            }
        }
    };
    (@unary $lanes:ty: $($name:ident)+) => {
        $(
            #[inline]
            fn $name(self) -> Self {
                <$lanes>::$name(self)
            }
        )+
    };
    (@two $lanes:ty: $($name:ident = $vectorised:ident),+) => {
        $(
            #[inline]
            fn $name(self, other: Self) -> Self {
                <$lanes>::$vectorised(self, other)
            }
        )+
    };
    (@each $lanes:ty, $float:ty: $($name:ident)+) => {
        $(
            #[inline]
            fn $name(self) -> Self {
                self.to_array().map(<$float as Scalar>::$name).into()
            }
        )+
    };
    (@each_two $lanes:ty, $float:ty: $($name:ident)+) => {
        $(
            #[inline]
            fn $name(self, other: Self) -> Self {
                let (x, y) = (self.to_array(), other.to_array());
                <$lanes>::from(core::array::from_fn(|i| <$float as Scalar>::$name(x[i], y[i])))
            }
        )+
    };
}

lanes!(f64x2, f64, double);
lanes!(f64x4, f64, double);
lanes!(f64x8, f64, double);
lanes!(f32x4, f32, single);
lanes!(f32x8, f32, single);
lanes!(f32x16, f32, single);

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    /// Every lane has the bits of one number, wherever the other lanes are.
    macro_rules! same_bits {
        ($lanes:ty, $float:ty; $($name:ident * $scale:literal + $shift:literal),+ $(,)?) => {{
            const COUNT: usize = size_of::<$lanes>() / size_of::<$float>();
            for k in 0..200 {
                // Between -1 and 1.
                let x: [$float; COUNT] = core::array::from_fn(|i| ((37 * k + 113 * i) % 2001) as $float * 1e-3 - 1.0);
                $({
                    let x = x.map(|x| $scale * x + $shift);
                    let lanes = Scalar::$name(<$lanes>::from(x)).to_array();
                    let alone = x.map(|x| <$float as Scalar>::$name(x));
                    assert_eq!(lanes.map(<$float>::to_bits), alone.map(<$float>::to_bits), "{} {x:?}", stringify!($name));
                })+
                let (y, z) = (<$lanes>::from(x), <$lanes>::from(x.map(|x| 0.3 - 2.0 * x)));
                let angles = Scalar::atan2(y, z).to_array();
                let powers = Scalar::powf(y * y, z).to_array();
                let (sines, cosines) = <$lanes as Scalar>::sin_cos_all([y]);
                for i in 0..COUNT {
                    let (y, z) = (x[i], 0.3 - 2.0 * x[i]);
                    assert_eq!(angles[i].to_bits(), Scalar::atan2(y, z).to_bits());
                    assert_eq!(powers[i].to_bits(), Scalar::powf(y * y, z).to_bits());
                    let ([sin], [cos]) = <$float as Scalar>::sin_cos_all([y]);
                    assert_eq!(sines[0].to_array()[i].to_bits(), sin.to_bits());
                    assert_eq!(cosines[0].to_array()[i].to_bits(), cos.to_bits());
                }
            }
        }};
    }

    #[test]
    fn every_lane_has_the_bits_of_one_number() {
        macro_rules! all {
            ($($lanes:ident $float:ident),+) => {$(
                same_bits!($lanes, $float; tan * 1.5 + 0.0, asin * 1.0 + 0.0, acos * 0.9 + 0.0, atan * 5.0 + 0.0,
                    sinh * 2.0 + 0.0, cosh * 2.0 + 0.0, tanh * 2.0 + 0.0, exp * 3.0 + 0.0, ln * 1.0 + 4.0,
                    sqrt * 1.0 + 4.0, abs * 1.0 + 0.0);
            )+};
        }
        all!(f64x2 f64, f64x4 f64, f64x8 f64, f32x4 f32, f32x8 f32, f32x16 f32);
    }

    #[test]
    fn functions_of_two_arguments_keep_their_order() {
        let y = f64x4::from([1.0, -1.0, 0.5, 0.0]);
        let x = f64x4::from([0.0, 1.0, -2.0, -1.0]);
        let angles = Scalar::atan2(y, x).to_array();
        for (i, (y, x)) in [(1.0, 0.0), (-1.0, 1.0), (0.5, -2.0), (0.0, -1.0)].into_iter().enumerate() {
            assert!((angles[i] - Scalar::atan2(y, x)).abs() < 1e-15);
        }
        let power = Scalar::powf(f64x4::splat(2.0), f64x4::from([0.0, 1.0, -2.0, 0.5])).to_array();
        for (i, expected) in [1.0, 2.0, 0.25, core::f64::consts::SQRT_2].into_iter().enumerate() {
            assert!((power[i] - expected).abs() < 1e-15, "{power:?}");
        }
    }

    #[test]
    fn a_nan_on_the_side_not_taken_does_not_leak() {
        let x = f64x4::from([4.0, -4.0, 9.0, -9.0]);
        let root = <f64x4 as Scalar>::select(f64x4::zero().less(x), || x.sqrt(), f64x4::zero);
        assert_eq!(root.to_array(), [2.0, 0.0, 3.0, 0.0]);
    }

    #[test]
    fn several_values_are_chosen_with_one_mask() {
        let choose = |x: f64x4| {
            let positive = f64x4::zero().less(x);
            <f64x4 as Scalar>::select_each(positive, || [x.sqrt(), x], || [f64x4::zero(), -x]).map(|v| v.to_array())
        };
        assert_eq!(choose(f64x4::from([4.0, -4.0, 9.0, -9.0])), [[2.0, 0.0, 3.0, 0.0], [4.0, 4.0, 9.0, 9.0]]);
        assert_eq!(choose(f64x4::splat(4.0)), [[2.0; 4], [4.0; 4]]);
        assert_eq!(choose(f64x4::splat(-4.0)), [[0.0; 4], [4.0; 4]]);
    }

    #[test]
    fn sign_and_finiteness() {
        let x = f32x8::from([0.0, -0.0, 2.0, -3.0, 1.0, -1.0, 5.0, -5.0]);
        assert_eq!(Scalar::signum(x).to_array(), [0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        assert!(Scalar::is_finite(x));
        assert!(!Scalar::is_finite(x / f32x8::zero()));
    }
}
