//! The exponential of `[[A, B], [0, 0]] T`, by its blocks.

use super::ControlError;
use super::dense::{balance, difference, identity, is_finite, norm, product, scaled, solve, sum};

/// Coefficients of the Padé approximant of degree 13 of the exponential (Higham, 2005, equation 2.3).
const C: [f64; 14] = [
    64_764_752_532_480_000.0,
    32_382_376_266_240_000.0,
    7_771_770_303_897_600.0,
    1_187_353_796_428_800.0,
    129_060_195_264_000.0,
    10_559_470_521_600.0,
    670_442_572_800.0,
    33_522_128_640.0,
    1_323_241_920.0,
    40_840_800.0,
    960_960.0,
    16_380.0,
    182.0,
    1.0,
];

/// Up to this norm the approximant is exact to rounding (Higham, table 2.3).
const REACH: f64 = 5.371_920_351_148_152;

/// Φ and Γ.
type Sampled<const N: usize, const U: usize> = ([[f64; N]; N], [[f64; U]; N]);

/// `exp(A T)` and `∫₀ᵀ exp(A s) ds B`.
pub(super) fn zero_order_hold<const N: usize, const U: usize>(
    a: &[[f64; N]; N],
    b: &[[f64; U]; N],
    time: f64,
) -> Result<Sampled<N, U>, ControlError> {
    if !(time > 0.0 && time.is_finite()) {
        return Err(ControlError::SampleTime { value: time });
    }
    let (mut a, mut b) = (scaled(time, a), scaled(time, b));
    if !is_finite(&b) {
        return Err(ControlError::NotFinite { matrix: 'B' });
    }
    let overflow = ControlError::NotFinite { matrix: 'A' };
    let unit = balance(&mut a, &mut b);
    let (mut size, mut squarings, mut part) = (norm(&a), 0, 1.0);
    if !size.is_finite() {
        return Err(overflow);
    }
    while size > REACH {
        (size, squarings, part) = (0.5 * size, squarings + 1, 0.5 * part);
    }
    let (mut phi, mut gamma) = approximant(&scaled(part, &a), &scaled(part, &b)).ok_or(overflow)?;
    for _ in 0..squarings {
        gamma = sum(&product(&phi, &gamma), &gamma);
        phi = product(&phi, &phi);
    }
    phi = core::array::from_fn(|i| core::array::from_fn(|j| phi[i][j] / unit[j] * unit[i]));
    gamma = core::array::from_fn(|i| gamma[i].map(|entry| entry * unit[i]));
    if is_finite(&phi) && is_finite(&gamma) { Ok((phi, gamma)) } else { Err(overflow) }
}

/// `r(A)` and, as the blocks of `r([[A, B], [0, 0]])` are polynomials in A times B, its upper right block.
fn approximant<const N: usize, const U: usize>(a: &[[f64; N]; N], b: &[[f64; U]; N]) -> Option<Sampled<N, U>> {
    let a2 = product(a, a);
    let a4 = product(&a2, &a2);
    let a6 = product(&a4, &a2);
    // c[3] A⁶ + c[2] A⁴ + c[1] A² + c[0]
    let polynomial = |c: [f64; 4]| {
        let terms = [scaled(c[3], &a6), scaled(c[2], &a4), scaled(c[1], &a2)];
        terms.iter().fold(identity(c[0]), |all, term| sum(&all, term))
    };
    // The odd part is A W, the even one V; (V − A W) r = V + A W, and above on the right (V − A W) r = 2 W B.
    let w = sum(&product(&a6, &polynomial([0.0, C[9], C[11], C[13]])), &polynomial([C[1], C[3], C[5], C[7]]));
    let v = sum(&product(&a6, &polynomial([0.0, C[8], C[10], C[12]])), &polynomial([C[0], C[2], C[4], C[6]]));
    let odd = product(a, &w);
    let denominator = difference(&v, &odd);
    Some((solve(denominator, sum(&v, &odd))?, solve(denominator, scaled(2.0, &product(&w, b)))?))
}
