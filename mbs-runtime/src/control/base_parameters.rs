//! Base parameters: the combinations of inertial parameters that forces depend on.

use core::error::Error;
use core::fmt;

use crate::scalar::length;

/// Regressors of many states on top of each other, kept as the triangle of their QR factorization.
///
/// Rows are taken in by Givens rotations, so that there may be any number of them: `P²` numbers are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct RegressorStack<const P: usize> {
    triangle: [[f64; P]; P],
    rows: usize,
}

/// A regressor with an entry that is infinite or NaN was taken in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NotFiniteRegressor {
    /// The parameter whose column it is, counted from 0.
    pub parameter: usize,
}

impl fmt::Display for NotFiniteRegressor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column {} of a regressor has an entry that is infinite or NaN", self.parameter)
    }
}

impl Error for NotFiniteRegressor {}

impl<const P: usize> Default for RegressorStack<P> {
    fn default() -> Self {
        Self { triangle: [[0.0; P]; P], rows: 0 }
    }
}

impl<const P: usize> RegressorStack<P> {
    /// Puts the N rows of a regressor below those there are.
    pub fn add<const N: usize>(&mut self, regressor: &[[f64; P]; N]) {
        for row in regressor {
            self.add_row(*row);
        }
        self.rows += N;
    }

    fn add_row(&mut self, mut row: [f64; P]) {
        for k in 0..P {
            let (a, b) = (self.triangle[k][k], row[k]);
            if b == 0.0 {
                continue;
            }
            let length = length([a, b].into_iter());
            let (cos, sin) = (a / length, b / length);
            for j in k..P {
                let (above, below) = (self.triangle[k][j], row[j]);
                self.triangle[k][j] = cos * above + sin * below;
                row[j] = cos * below - sin * above;
            }
        }
    }

    /// How many rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Which parameters the rows tell apart.
    ///
    /// Columns are scaled to length 1, so that units do not count; one that is shorter than `1e-12` of the longest is
    /// what rounding left of nothing, and counts as zero. Then the one is taken that is longest across those already
    /// taken, until none is longer than `tolerance`; `1e-9` is well above rounding and well below what a mechanism of a
    /// few links leaves. With a tolerance of NaN the rank is 0.
    ///
    /// ```
    /// use mbs_runtime::control::RegressorStack;
    ///
    /// // Two masses that only move together: what is told is their sum.
    /// let mut stack = RegressorStack::default();
    /// stack.add(&[[1.0, 1.0, 0.5], [2.0, 2.0, -1.0], [0.3, 0.3, 4.0]]);
    /// let base = stack.base(1e-9).unwrap();
    /// assert_eq!((base.rank(), base.dependent().len()), (2, 1));
    /// let values = base.values(&[3.0, 4.0, 7.0]);
    /// assert!(base.independent().iter().zip(values).all(|(_, value)| (value - 7.0_f64).abs() < 1e-12));
    /// ```
    ///
    /// # Errors
    /// [`NotFiniteRegressor`].
    ///
    /// # Source
    /// M. Gautier, *Numerical calculation of the base inertial parameters of robots*, Journal of Robotic Systems 8:4,
    /// 1991; the pivots: P. Businger and G. H. Golub, *Linear least squares solutions by Householder transformations*,
    /// Numerische Mathematik 7, 1965.
    pub fn base(&self, tolerance: f64) -> Result<BaseParameters<P>, NotFiniteRegressor> {
        let lengths: [f64; P] = core::array::from_fn(|j| length(self.triangle.iter().map(|row| row[j])));
        if let Some(parameter) = lengths.iter().position(|length| !length.is_finite()) {
            return Err(NotFiniteRegressor { parameter });
        }
        let least = ROUNDING * lengths.iter().fold(0.0, |most: f64, length| most.max(*length));
        let told = lengths.map(|length| length > least);
        let scale: [f64; P] = core::array::from_fn(|j| if told[j] { lengths[j] } else { 1.0 });
        let mut a = self.triangle.map(|row| core::array::from_fn(|j| if told[j] { row[j] / scale[j] } else { 0.0 }));
        let mut order: [usize; P] = core::array::from_fn(|j| j);
        let mut pivots = [0.0; P];
        let mut rank = P;
        for k in 0..P {
            let left = |j: usize| length(a[k..].iter().map(|row: &[f64; P]| row[j]));
            let best = (k..P).fold(k, |best, j| if left(j) > left(best) { j } else { best });
            pivots[k] = left(best);
            let is_told = pivots[k] > tolerance && pivots[k] > 0.0;
            if !is_told {
                rank = k;
                break;
            }
            order.swap(k, best);
            a.iter_mut().for_each(|row| row.swap(k, best));
            reflect(&mut a, k);
        }
        // R₁ X = R₂, column by column, and back to the parameters' own units.
        let mut regrouping = [[0.0; P]; P];
        for j in rank..P {
            for i in (0..rank).rev() {
                let known: f64 = (i + 1..rank).map(|k| a[i][k] * regrouping[k][j]).sum();
                regrouping[i][j] = (a[i][j] - known) / a[i][i];
            }
        }
        for (i, row) in regrouping.iter_mut().enumerate() {
            (rank..P).for_each(|j| row[j] *= scale[order[j]] / scale[order[i]]);
        }
        Ok(BaseParameters { order, rank, regrouping, pivots })
    }
}

/// Of the longest column, what may be rounding.
const ROUNDING: f64 = 1e-12;

/// Householder's reflection that makes column k of rows k and below a multiple of the first unit vector.
fn reflect<const P: usize>(a: &mut [[f64; P]; P], k: usize) {
    let length = length(a[k..].iter().map(|row| row[k]));
    let alpha = if a[k][k] > 0.0 { -length } else { length };
    let mut v: [f64; P] = core::array::from_fn(|i| if i < k { 0.0 } else { a[i][k] });
    v[k] -= alpha;
    let square: f64 = v.iter().map(|entry| entry * entry).sum();
    if square == 0.0 {
        return;
    }
    for j in k..P {
        let along: f64 = 2.0 * (k..P).map(|i| v[i] * a[i][j]).sum::<f64>() / square;
        (k..P).for_each(|i| a[i][j] -= along * v[i]);
    }
}

/// Parameters of which each is told apart from the others, and how the rest counts with them.
///
/// ```text
/// Y π = Σₖ Y[·][independent k] βₖ,   βₖ = π[independent k] + Σⱼ Xₖⱼ π[dependent j]
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BaseParameters<const P: usize> {
    /// The independent parameters, then the others.
    order: [usize; P],
    rank: usize,
    /// X, in its first `rank` rows and its last `P − rank` columns.
    regrouping: [[f64; P]; P],
    pivots: [f64; P],
}

impl<const P: usize> BaseParameters<P> {
    /// How many base parameters there are.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The parameters whose columns are the base, in the order in which they were taken.
    #[must_use]
    pub fn independent(&self) -> &[usize] {
        &self.order[..self.rank]
    }

    /// The parameters that count only together with those.
    #[must_use]
    pub fn dependent(&self) -> &[usize] {
        &self.order[self.rank..]
    }

    /// `Xₖⱼ`: by how much base parameter k grows with dependent parameter j, both as the slices count them.
    ///
    /// # Panics
    /// If there is no base parameter, or no dependent one, of this number.
    #[must_use]
    pub fn coefficient(&self, base: usize, dependent: usize) -> f64 {
        assert!(base < self.rank, "base parameter {base} of {}", self.rank);
        self.regrouping[base][self.rank + dependent]
    }

    /// `β`, the first `rank` numbers; the rest is zero.
    #[must_use]
    pub fn values(&self, parameters: &[f64; P]) -> [f64; P] {
        let value = |k: usize| {
            let others: f64 = (self.rank..P).map(|j| self.regrouping[k][j] * parameters[self.order[j]]).sum();
            parameters[self.order[k]] + others
        };
        core::array::from_fn(|k| if k < self.rank { value(k) } else { 0.0 })
    }

    /// How clear the rank is: the shortest column that was taken and the longest that was not, of columns of length 1
    /// and across those that were taken. 0 where there is none.
    #[must_use]
    pub fn gap(&self) -> [f64; 2] {
        let taken = if self.rank == 0 { 0.0 } else { self.pivots[self.rank - 1] };
        [taken, if self.rank < P { self.pivots[self.rank] } else { 0.0 }]
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use std::string::ToString;

    /// Columns 2 and 3 are made of 0 and 1, column 4 is zero; in units that differ by ten powers of ten.
    #[test]
    fn what_columns_are_made_of() {
        let mut stack = RegressorStack::<5>::default();
        for i in 0..7 {
            let (x, y) = ((1.3 * f64::from(i)).sin(), 1e5 * (0.7 * f64::from(i)).cos());
            stack.add(&[[x, y, 3.0 * x - 2e-5 * y, 1e-5 * x, 0.0]]);
        }
        assert_eq!(stack.rows(), 7);
        let base = stack.base(1e-9).unwrap();
        assert_eq!((base.rank(), base.gap()[0] > 0.1, base.gap()[1] < 1e-14), (2, true, true));
        let parameters = [2.0, 3e-5, 5.0, 7e5, 11.0];
        let values = base.values(&parameters);
        assert!(values[2..].iter().all(|value| *value == 0.0));
        // Y π is the same from either.
        let row = [0.4, 9e3, 3.0 * 0.4 - 2e-5 * 9e3, 1e-5 * 0.4, 0.0];
        let whole: f64 = (0..5).map(|k| row[k] * parameters[k]).sum();
        let short: f64 = base.independent().iter().zip(values).map(|(&k, value)| row[k] * value).sum();
        assert!((whole - short).abs() < 1e-11 * whole.abs(), "{whole} {short}");
        for (j, &dependent) in base.dependent().iter().enumerate() {
            let made: f64 = (0..2).map(|k| row[base.independent()[k]] * base.coefficient(k, j)).sum();
            assert!((made - row[dependent]).abs() < 1e-12, "{dependent}");
        }
    }

    /// Squares of the entries underflow, or overflow.
    #[test]
    fn units_do_not_count() {
        for unit in [1.0, 1e-170, 1e-300, 1e170] {
            let mut stack = RegressorStack::<3>::default();
            stack.add(&[
                [unit, unit, 0.5 * unit],
                [2.0 * unit, 2.0 * unit, -unit],
                [0.3 * unit, 0.3 * unit, 4.0 * unit],
            ]);
            let base = stack.base(1e-9).unwrap();
            assert_eq!((base.rank(), base.dependent().len()), (2, 1), "{unit}");
            let values = base.values(&[3.0, 4.0, 7.0]);
            assert!(values[..2].iter().all(|value| (value - 7.0).abs() < 1e-12), "{unit}: {values:?}");
            assert_eq!(stack.base(f64::NAN).unwrap().rank(), 0);
        }
        // One column, and one that is nothing, is of rank one, whatever the tolerance.
        let mut stack = RegressorStack::<2>::default();
        stack.add(&[[1.0, 0.0]]);
        assert_eq!([-1.0, 0.0].map(|tolerance| stack.base(tolerance).unwrap().rank()), [1, 1]);
    }

    #[test]
    fn nothing_tells_nothing() {
        let base = RegressorStack::<3>::default().base(1e-9).unwrap();
        assert_eq!((base.rank(), base.gap(), base.values(&[1.0; 3])), (0, [0.0; 2], [0.0; 3]));
        let mut stack = RegressorStack::<3>::default();
        stack.add(&[[1.0, f64::NAN, 0.0]]);
        let error = stack.base(1e-9).unwrap_err();
        assert!(error.to_string().starts_with("column "), "{error}");
    }
}
