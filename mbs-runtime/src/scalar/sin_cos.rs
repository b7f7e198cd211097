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
//! | largest error within it found, ulp | 0.84 | 0.81 |
//!
//! The reduction is that of W. J. Cody and W. Waite, Software Manual for the Elementary Functions, Prentice-Hall 1980,
//! ch. 8, in three parts, with its rounding kept in `e` (J.-M. Muller, Elementary Functions, 3rd ed., Birkhäuser 2016,
//! sections 11.2 and 11.3); `MAGIC` rounds to integers by shifting all other bits out. The coefficients are minimax
//! for the relative error, computed by Remez's exchange in 200 bits, each rounded before the next is fitted: the
//! errors are 2⁻⁵⁷·⁹ and 2⁻⁶³·⁹ for `f64`, 2⁻²⁷·⁹ and 2⁻³³·⁰ for `f32`.

/// How many angles are computed in lockstep: what fills the registers of every target and spills on none.
const BLOCK: usize = 8;

macro_rules! polynomials {
    ($name:ident: $float:ty, $bits:ty; reach $reach:literal, turns $turns:literal, magic $magic:literal,
     parts $parts:expr, sine $sine:expr, cosine $cosine:expr) => {
        pub(super) mod $name {
            use super::BLOCK;
            use crate::Scalar;

            /// The largest angle that the polynomials are used for.
            const REACH: $float = $reach;
            /// 2/π
            const TURNS: $float = $turns;
            /// 1.5 times the number whose ulp is 1.
            const MAGIC: $float = $magic;
            /// π/2, the first two parts short enough for exact products with `k`.
            const P: [$float; 3] = $parts;
            /// Of `(sin y − y)/y³` in `y²`.
            const S: &[$float] = &$sine;
            /// Of `(cos y − 1 + y²/2)/y⁴` in `y²`.
            const C: &[$float] = &$cosine;

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
            pub(in crate::scalar) fn block<const N: usize>(angles: [$float; N]) -> ([$float; N], [$float; N]) {
                let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
                for i in 0..N {
                    (sines[i], cosines[i]) = within_reach(angles[i]);
                }
                if !angles.iter().fold(true, |all, angle| all & (angle.abs() <= REACH)) {
                    beyond(&angles, &mut sines, &mut cosines);
                }
                (sines, cosines)
            }

            /// What is too large for the polynomials, infinite or NaN.
            #[cold]
            #[inline(never)]
            fn beyond(angles: &[$float], sines: &mut [$float], cosines: &mut [$float]) {
                for (i, &angle) in angles.iter().enumerate().filter(|(_, angle)| !(angle.abs() <= REACH)) {
                    (sines[i], cosines[i]) = Scalar::sin_cos(angle);
                }
            }

            /// Those from `start` on that fit into a block of `M`.
            #[inline(always)]
            fn put<const N: usize, const M: usize>(angles: &[$float; N], start: usize, results: &mut [[$float; N]; 2]) {
                // Different fillers: of equal ones the compiler would compute one, and not in lockstep.
                let block = core::array::from_fn(|i| if start + i < N { angles[start + i] } else { i as $float });
                let (sines, cosines) = self::block::<M>(block);
                let count = M.min(N - start);
                results[0][start..start + count].copy_from_slice(&sines[..count]);
                results[1][start..start + count].copy_from_slice(&cosines[..count]);
            }

            /// In blocks of sizes that compilers turn into vector instructions.
            #[inline(always)]
            pub(in crate::scalar) fn all<const N: usize>(angles: [$float; N]) -> ([$float; N], [$float; N]) {
                let mut results = [[0.0; N]; 2];
                let whole = N - N % BLOCK;
                for start in (0..whole).step_by(BLOCK) {
                    put::<N, BLOCK>(&angles, start, &mut results);
                }
                match N - whole {
                    0 => {}
                    1 => put::<N, 1>(&angles, whole, &mut results),
                    2 => put::<N, 2>(&angles, whole, &mut results),
                    3 | 4 => put::<N, 4>(&angles, whole, &mut results),
                    _ => put::<N, BLOCK>(&angles, whole, &mut results),
                }
                let [sines, cosines] = results;
                (sines, cosines)
            }
        }
    };
}

polynomials!(double: f64, u64;
reach 1e5,
turns 0.6366197723675814,
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
    cosine [0.041666647, -0.0013887309, 2.4432327e-5]);
