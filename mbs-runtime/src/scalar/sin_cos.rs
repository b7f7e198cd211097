//! Sines and cosines of several angles at once, from additions, subtractions and multiplications alone.
//!
//! Each of these is rounded once, the same on every machine and in every language with IEEE arithmetic: what computes
//! the steps below in this order, without contracting `a·b + c` and without extended precision, gives the same bits.
//! For one angle `x` with `|x| ≤ REACH`, otherwise the functions of the standard library or of libm:
//!
//! ```text
//! k = (x·TURNS + MAGIC) − MAGIC                   the integer nearest to x·2/π
//! r = x − k·P1                                    exact, as k·P1 and k·P2 are: 2 P1, 2 P2, 2 P3 sum up to π
//! w = k·P2        h = r − w
//! t = k·P3 − ((r − h) − w)
//! y = h − t       e = t − (h − y)                 x − k·π/2 = y − e, |y| ≤ π/4 (1 + 2⁻¹⁴), |e| ≤ a half ulp of y
//! z = y·y
//! p = S[0] + z·S[1] + …                           (sin y − y)/y³
//! q = C[0] + z·C[1] + …                           (cos y − 1 + y²/2)/y⁴
//! half = 0.5·z    one = 1 − half
//! sin = y − (e·one − (z·y)·p)
//! cos = one + (((1 − one) − half) + ((z·z)·q + y·e))
//!
//! k mod 4     0             1             2             3
//! result  (sin, cos)   (cos, −sin)  (−sin, −cos)   (−cos, sin)
//! ```
//!
//! The polynomials are summed in pairs (Estrin), `z2 = z·z`, `z4 = z2·z2`:
//! of six terms `((S[0] + z·S[1]) + z2·(S[2] + z·S[3])) + z4·(S[4] + z·S[5])` for `f64`,
//! of three terms `(S[0] + z·S[1]) + z2·S[2]` for `f32`.
//! In these orders −0 has the sine −0, and a subnormal angle is its own sine.
//!
//! | | `f64` | `f32` |
//! |---|---|---|
//! | `REACH` | 1e5 | 400 |
//! | largest error found within it, ulp | 0.84 | 0.84 |
//!
//! Of `f32` all numbers within reach were tried, of `f64` all multiples of π/4 with their neighbours and 11 million
//! others.
//!
//! The reduction is that of W. J. Cody and W. Waite, Software Manual for the Elementary Functions, Prentice-Hall 1980,
//! ch. 8, in three parts, with its rounding kept in `e` (J.-M. Muller, Elementary Functions, 3rd ed., Birkhäuser 2016,
//! sections 11.2 and 11.3); `MAGIC` rounds to integers by shifting all other bits out. The coefficients are minimax
//! for the relative error, computed by Remez's exchange in 200 bits, each rounded before the next is fitted: the
//! errors are 2⁻⁵⁷·⁹ and 2⁻⁶³·⁹ for `f64`, 2⁻²⁷·⁹ and 2⁻³³·⁰ for `f32`.

/// How many angles are computed in lockstep at most. Compilers turn 8, 4 and 2 into vector instructions; five as four
/// and one take 0.8 of the time of five filled up to eight.
const BLOCK: usize = 8;

/// Whether the target has vector instructions. Without them each angle is a call: the same bits from less code.
const LOCKSTEP: bool = cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128"));

macro_rules! polynomials {
    ($name:ident: $float:ty, $bits:ty; reach $reach:literal, turns $turns:expr, magic $magic:literal,
     parts $parts:expr, sine $sine:expr, cosine $cosine:expr) => {
        pub(super) mod $name {
            use super::{BLOCK, LOCKSTEP};
            use crate::Scalar;

            /// The largest angle that the polynomials are used for.
            pub(super) const REACH: $float = $reach;
            /// 2/π
            pub(super) const TURNS: $float = $turns;
            /// 1.5 times the number whose ulp is 1.
            pub(super) const MAGIC: $float = $magic;
            /// π/2, the first two parts short enough for exact products with `k`.
            pub(super) const P: [$float; 3] = $parts;
            /// Of `(sin y − y)/y³` in `y²`.
            pub(super) const S: &[$float] = &$sine;
            /// Of `(cos y − 1 + y²/2)/y⁴` in `y²`.
            pub(super) const C: &[$float] = &$cosine;

            /// Terms in pairs.
            #[inline(always)]
            fn sum(c: &[$float], z: $float) -> $float {
                let z2 = z * z;
                if c.len() == 3 {
                    (c[0] + z * c[1]) + z2 * c[2]
                } else {
                    ((c[0] + z * c[1]) + z2 * (c[2] + z * c[3])) + (z2 * z2) * (c[4] + z * c[5])
                }
            }

            /// For angles up to [`REACH`]; anything beyond.
            #[inline(always)]
            fn within_reach(x: $float) -> ($float, $float) {
                let shifted = x * TURNS + MAGIC;
                let k = shifted - MAGIC;
                let r = x - k * P[0];
                let w = k * P[1];
                let h = r - w;
                let t = k * P[2] - ((r - h) - w);
                let y = h - t;
                let e = t - (h - y);
                let z = y * y;
                let half = 0.5 * z;
                let one = 1.0 - half;
                let sin = y - (e * one - (z * y) * sum(S, z));
                let cos = one + (((1.0 - one) - half) + ((z * z) * sum(C, z) + y * e));
                // The last bits of `shifted` are those of `k`: an odd one swaps, the next one changes signs.
                const SIGN: u32 = <$bits>::BITS - 2;
                let k = shifted.to_bits();
                let (sin, cos) = (sin.to_bits(), cos.to_bits());
                let swap = (sin ^ cos) & (0 as $bits).wrapping_sub(k & 1);
                let negative = |k: $bits| (k & 2) << SIGN;
                let sin = sin ^ swap ^ negative(k);
                let cos = cos ^ swap ^ negative(k.wrapping_add(1));
                (<$float>::from_bits(sin), <$float>::from_bits(cos))
            }

            /// In lockstep.
            #[inline(always)]
            fn block<const N: usize>(angles: [$float; N]) -> ([$float; N], [$float; N]) {
                let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
                for i in 0..N {
                    (sines[i], cosines[i]) = within_reach(angles[i]);
                }
                if !angles.iter().fold(true, |all, angle| all & (angle.abs() <= REACH)) {
                    beyond(&angles, &mut sines, &mut cosines);
                }
                (sines, cosines)
            }

            fn is_beyond(angle: $float) -> bool {
                angle.is_nan() || angle.abs() > REACH
            }

            /// What is too large for the polynomials, infinite or NaN.
            #[cold]
            #[inline(never)]
            fn beyond(angles: &[$float], sines: &mut [$float], cosines: &mut [$float]) {
                for (i, &angle) in angles.iter().enumerate().filter(|(_, angle)| is_beyond(**angle)) {
                    (sines[i], cosines[i]) = Scalar::sin_cos(angle);
                }
            }

            /// One angle.
            #[inline(never)]
            fn one(angle: $float) -> ($float, $float) {
                let ([sin], [cos]) = block([angle]);
                (sin, cos)
            }

            /// `M` angles from `start` on.
            #[inline(always)]
            fn put<const N: usize, const M: usize>(angles: &[$float; N], start: usize, results: &mut [[$float; N]; 2]) {
                let (sines, cosines) = self::block::<M>(core::array::from_fn(|i| angles[start + i]));
                results[0][start..start + M].copy_from_slice(&sines);
                results[1][start..start + M].copy_from_slice(&cosines);
            }

            /// As many as a vector has.
            #[cfg(feature = "wide")]
            #[inline(always)]
            pub(in crate::scalar) fn lanes<const N: usize>(angles: [$float; N]) -> ([$float; N], [$float; N]) {
                if LOCKSTEP { self::block(angles) } else { all(angles) }
            }

            /// In blocks of sizes that compilers turn into vector instructions.
            #[inline(always)]
            pub(in crate::scalar) fn all<const N: usize>(angles: [$float; N]) -> ([$float; N], [$float; N]) {
                let mut results = [[0.0; N]; 2];
                if !LOCKSTEP {
                    for (i, &angle) in angles.iter().enumerate() {
                        (results[0][i], results[1][i]) = one(angle);
                    }
                    let [sines, cosines] = results;
                    return (sines, cosines);
                }
                let mut start = N - N % BLOCK;
                for start in (0..start).step_by(BLOCK) {
                    put::<N, BLOCK>(&angles, start, &mut results);
                }
                if N - start >= 4 {
                    put::<N, 4>(&angles, start, &mut results);
                    start += 4;
                }
                if N - start >= 2 {
                    put::<N, 2>(&angles, start, &mut results);
                    start += 2;
                }
                if N - start == 1 {
                    put::<N, 1>(&angles, start, &mut results);
                }
                let [sines, cosines] = results;
                (sines, cosines)
            }
        }
    };
}

polynomials!(double: f64, u64;
reach 1e5,
turns core::f64::consts::FRAC_2_PI,
magic 6755399441055744.0,
parts [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21],
sine [
    -0.1666666666666663,
    0.00833333333332184,
    -0.00019841269829358541,
    2.7557313538526334e-6,
    -2.5050734392422683e-8,
    1.5895433544930663e-10,
],
cosine [
    0.041666666666666595,
    -0.001388888888887334,
    2.4801587288999616e-5,
    -2.755731421606095e-7,
    2.087570523233725e-9,
    -1.1358739381498488e-11,
]);

polynomials!(single: f32, u32;
    reach 400.0,
    turns 0.63661975,
    magic 12582912.0,
    parts [1.5707703, 2.6063062e-5, 6.0771006e-11],
    sine [-0.16666655, 0.008332189, -0.00019518285],
    cosine [0.041666647, -0.001388731, 2.4432327e-5]);

#[cfg(test)]
mod tests {
    use crate::Scalar;

    /// The steps as they are written above, for one angle: what other languages compute.
    macro_rules! in_steps {
        ($float:ty, $polynomials:ident, $sum:expr) => {
            |x: $float| -> ($float, $float) {
                use super::$polynomials::*;
                if x.is_nan() || x.abs() > REACH {
                    return (Scalar::sin(x), Scalar::cos(x));
                }
                let k = (x * TURNS + MAGIC) - MAGIC;
                let r = x - k * P[0];
                let w = k * P[1];
                let h = r - w;
                let t = k * P[2] - ((r - h) - w);
                let y = h - t;
                let e = t - (h - y);
                let z = y * y;
                let (p, q): ($float, $float) = ($sum(S, z), $sum(C, z));
                let half = 0.5 * z;
                let one = 1.0 - half;
                let sin = y - (e * one - (z * y) * p);
                let cos = one + (((1.0 - one) - half) + ((z * z) * q + y * e));
                [(sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin)][(k as i64).rem_euclid(4) as usize]
            }
        };
    }

    fn one_by_one(x: f64) -> (f64, f64) {
        in_steps!(f64, double, |c: &[f64], z: f64| {
            let (z2, z4) = (z * z, (z * z) * (z * z));
            ((c[0] + z * c[1]) + z2 * (c[2] + z * c[3])) + z4 * (c[4] + z * c[5])
        })(x)
    }

    fn one_by_one_f32(x: f32) -> (f32, f32) {
        in_steps!(f32, single, |c: &[f32], z: f32| (c[0] + z * c[1]) + (z * z) * c[2])(x)
    }

    const SPECIAL: [f64; 14] = [
        0.0,
        -0.0,
        5e-324,
        -1e-310,
        1e-20,
        core::f64::consts::FRAC_PI_4,
        core::f64::consts::PI,
        -core::f64::consts::FRAC_PI_2,
        399.9,
        1e5,
        -1.000_000_1e5,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];

    /// Dense ones up to 7 and far ones up to 1.2e5, among them what is special.
    fn angles() -> impl Iterator<Item = f64> {
        let dense = (0..1400).map(|i| f64::from(i) * 0.01 - 7.0);
        let far = (0..1200).map(|i| f64::from(i) * 200.123_456 - 1.2e5);
        dense.chain(far).enumerate().map(|(i, x)| if i % 37 == 0 { SPECIAL[i / 37 % SPECIAL.len()] } else { x })
    }

    fn of<const N: usize>() {
        let all: [f64; 2600] = core::array::from_fn(|i| angles().nth(i).expect("2600 angles"));
        for chunk in all.windows(N).step_by(N.min(7)) {
            let chunk: [f64; N] = core::array::from_fn(|i| chunk[i]);
            let (sines, cosines) = f64::sin_cos_all(chunk);
            let (floats, float_cosines) = f32::sin_cos_all(chunk.map(|x| x as f32));
            for i in 0..N {
                let (sin, cos) = one_by_one(chunk[i]);
                assert_eq!((sines[i].to_bits(), cosines[i].to_bits()), (sin.to_bits(), cos.to_bits()), "{}", chunk[i]);
                let (sin, cos) = one_by_one_f32(chunk[i] as f32);
                let found = (floats[i].to_bits(), float_cosines[i].to_bits());
                assert_eq!(found, (sin.to_bits(), cos.to_bits()), "{}", chunk[i]);
            }
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_other_angles() {
        of::<1>();
        of::<2>();
        of::<3>();
        of::<4>();
        of::<5>();
        of::<6>();
        of::<7>();
        of::<8>();
        of::<9>();
        of::<13>();
        of::<16>();
        of::<27>();
        assert_eq!(f64::sin_cos_all([]), ([], []));
    }

    #[test]
    fn zeros_subnormals_and_what_is_not_finite() {
        let ([plus, minus, tiny, infinite, nan], cosines) =
            f64::sin_cos_all([0.0, -0.0, -5e-324, f64::INFINITY, f64::NAN]);
        assert_eq!([plus.to_bits(), minus.to_bits(), tiny.to_bits()], [0.0, -0.0, -5e-324].map(f64::to_bits));
        assert_eq!(cosines[..3], [1.0; 3]);
        assert!(infinite.is_nan() && nan.is_nan() && cosines[3].is_nan() && cosines[4].is_nan());
        let ([minus, tiny], _) = f32::sin_cos_all([-0.0, 1e-45]);
        assert_eq!([minus.to_bits(), tiny.to_bits()], [(-0.0_f32).to_bits(), 1]);
    }

    #[cfg(feature = "wide")]
    #[test]
    fn lanes_have_the_bits_of_numbers() {
        let all: [f64; 2600] = core::array::from_fn(|i| angles().nth(i).expect("2600 angles"));
        for chunk in all.chunks_exact(8) {
            let chunk: [f64; 8] = core::array::from_fn(|i| chunk[i]);
            let halves = [0, 4].map(|half| wide::f64x4::from(core::array::from_fn(|i| chunk[half + i])));
            let ([first, second], _) = Scalar::sin_cos_all(halves);
            let singles = Scalar::sin(wide::f32x8::from(chunk.map(|x| x as f32))).to_array();
            for i in 0..8 {
                let sines = [first, second][i / 4].to_array();
                assert_eq!(sines[i % 4].to_bits(), one_by_one(chunk[i]).0.to_bits());
                assert_eq!(singles[i].to_bits(), one_by_one_f32(chunk[i] as f32).0.to_bits());
            }
        }
    }

    #[test]
    fn dual_numbers_carry_the_slope() {
        use crate::Dual;
        let ([sin, _], [cos, _]) = Dual::sin_cos_all([Dual { value: 0.3, derivative: 2.0 }, Dual::constant(1.0)]);
        let ([s, _], [c, _]) = f64::sin_cos_all([0.3, 1.0]);
        assert_eq!((sin.value, sin.derivative, cos.value, cos.derivative), (s, 2.0 * c, c, -2.0 * s));
    }
}
