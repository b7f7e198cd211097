//! Piecewise polynomials: what generated code evaluates for the tables of a model.

use crate::scalar::{Mask, Scalar};

/// Polynomials in the distance from a place, one on each interval between increasing places.
///
/// Row `k` holds from place `k − 1` on and before place `k`, so that there is one row more than places. A row is
/// `[a, c₀, c₁, …]`, and its value `c₀ + c₁ s + c₂ s² + …` with `s = x − a`, of `R − 2` as the highest power.
///
/// ```
/// use mbs_runtime::Spline;
///
/// // 0 before 1, from there on (x − 1)².
/// let ramp = Spline::new(&[1.0], &[[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 1.0]]);
/// assert_eq!(ramp.derivatives(3.0), [4.0, 4.0, 2.0]);
/// assert_eq!(ramp.derivatives(0.0), [0.0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spline<'a, const R: usize> {
    places: &'a [f64],
    rows: &'a [[f64; R]],
}

impl<'a, const R: usize> Spline<'a, R> {
    /// Of places and rows.
    ///
    /// # Panics
    /// Where there is not one row more than places, or a row has fewer than two numbers.
    pub const fn new(places: &'a [f64], rows: &'a [[f64; R]]) -> Self {
        assert!(rows.len() == places.len() + 1, "a spline has one row more than places");
        assert!(R >= 2, "a row of a spline is a place and coefficients");
        Self { places, rows }
    }

    /// The value at `x` and its derivatives, `D` numbers in all; NaN where `x` is NaN or infinite. At a place those of
    /// the row behind it.
    ///
    /// The interval is found by bisection. Lanes that lie in different intervals go through those between them in turn.
    pub fn derivatives<T: Scalar, const D: usize>(&self, x: T) -> [T; D] {
        let place = |k: usize| T::from_f64(self.places[k]);
        let (mut first, mut last) = (0, self.places.len());
        while first < last {
            let middle = first + (last - first) / 2;
            let is_before = x.less(place(middle));
            if is_before.all() {
                last = middle;
            } else if is_before.any() {
                break;
            } else {
                first = middle + 1;
            }
        }
        let mut found = self.on(first, x);
        for k in first..last {
            let (is_before, behind) = (x.less(place(k)), self.on::<T, D>(k + 1, x));
            found = core::array::from_fn(|order| T::blend(is_before, found[order], behind[order]));
        }
        found
    }

    /// The derivatives of one row's polynomial, by Horner's rule.
    #[inline]
    fn on<T: Scalar, const D: usize>(&self, row: usize, x: T) -> [T; D] {
        let row = &self.rows[row];
        let s = x - T::from_f64(row[0]);
        core::array::from_fn(|order| {
            // NaN stays NaN where the polynomial is a constant.
            let mut sum = s * T::zero();
            for power in (order..R - 1).rev() {
                let factor: usize = (power + 1 - order..=power).product();
                sum = T::from_f64(factor as f64 * row[1 + power]) + s * sum;
            }
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    const PLACES: [f64; 4] = [-1.0, 0.0, 0.5, 2.0];

    /// The cubic `k + s + k s² + s³` behind place `k − 1`.
    fn rows() -> [[f64; 5]; 5] {
        core::array::from_fn(|k| [PLACES[k.saturating_sub(1)], k as f64, 1.0, k as f64, 1.0])
    }

    fn by_hand(x: f64) -> [f64; 4] {
        let k = PLACES.iter().filter(|&&place| place <= x).count();
        let (s, k) = (x - PLACES[k.saturating_sub(1)], k as f64);
        [k + s * (1.0 + s * (k + s)), 1.0 + s * (2.0 * k + 3.0 * s), 2.0 * k + 6.0 * s, 6.0]
    }

    #[test]
    fn every_interval_has_its_polynomial() {
        let rows = rows();
        let spline = Spline::new(&PLACES, &rows);
        for x in [-7.0, -1.0, -0.25, -0.0, 0.0, 0.25, 0.5, 1.75, 2.0, 9.0] {
            assert_eq!(spline.derivatives(x), by_hand(x), "{x}");
            assert_eq!(spline.derivatives(x as f32).map(f64::from), by_hand(x), "{x} as f32");
            let [value, slope] = spline.derivatives(Dual { value: x, derivative: 2.0 });
            let [f, df, ddf, _] = by_hand(x);
            assert_eq!([value.value, value.derivative, slope.value, slope.derivative], [f, 2.0 * df, df, 2.0 * ddf]);
        }
        let [value, .., third] = spline.derivatives::<f64, 4>(f64::NAN);
        assert!(value.is_nan() && third.is_nan());
    }

    #[test]
    #[cfg(feature = "wide")]
    fn lanes_go_their_own_ways() {
        let rows = rows();
        let spline = Spline::new(&PLACES, &rows);
        for lanes in [[-7.0, 9.0, 0.25, -1.0], [0.1, 0.2, 0.5, 0.4], [0.75, 1.0, 0.5, 1.5], [0.0, f64::NAN, 3.0, -2.0]]
        {
            let found: [_; 2] = spline.derivatives(wide::f64x4::from(lanes));
            for (lane, x) in lanes.into_iter().enumerate() {
                for order in 0..2 {
                    let found = found[order].to_array()[lane];
                    assert!(found == by_hand(x)[order] || (found.is_nan() && x.is_nan()), "{lanes:?}: {found}");
                }
            }
        }
    }
}
