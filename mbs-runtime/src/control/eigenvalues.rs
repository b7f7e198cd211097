//! Eigenvalues of a real matrix: Francis' double steps on its Hessenberg form.

use core::ops::{Index, IndexMut};

use super::dense::{balance, is_finite};
use super::{Complex, ControlError};
use crate::scalar::Scalar;

/// Steps for one eigenvalue; after every tenth without success the shift is an exceptional one. Of a million matrices
/// of zeros, noise and numbers some need more than 120, next to a fourfold zero.
const STEPS: usize = 300;
/// After this many steps it is enough that an entry is rounding beside the greatest ones. Where its neighbours on the
/// diagonal are noise, or nearly zero, it does not get smaller than that.
const PATIENCE: usize = 20;

/// A square matrix, row by row.
struct Square<'a> {
    count: usize,
    entries: &'a mut [f64],
}

impl Index<usize> for Square<'_> {
    type Output = [f64];

    fn index(&self, row: usize) -> &[f64] {
        &self.entries[row * self.count..(row + 1) * self.count]
    }
}

impl IndexMut<usize> for Square<'_> {
    fn index_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.entries[row * self.count..(row + 1) * self.count]
    }
}

pub(super) fn eigenvalues<const N: usize>(a: &[[f64; N]; N]) -> Result<[Complex; N], ControlError> {
    let mut h = *a;
    if is_finite(a) {
        balance(&mut h, &mut [[]; N]);
    }
    let mut values = [Complex::new(0.0, 0.0); N];
    eigenvalues_in_place(h.as_flattened_mut(), &mut values)?;
    Ok(values)
}

/// The eigenvalues of a real matrix of any size, in no order but that complex ones stand in pairs; small ones beside
/// large ones are more accurate where the matrix is balanced first, as [`StateSpace::poles`](super::StateSpace::poles)
/// does it.
///
/// | argument | meaning | length |
/// |---|---|---|
/// | `matrix` | the matrix, row by row; undefined afterwards | n² |
/// | `values` | receives the eigenvalues | n |
///
/// ```
/// use mbs_runtime::control::{Complex, eigenvalues_in_place};
/// let mut values = [Complex::default(); 2];
/// eigenvalues_in_place(&mut [0.0, 1.0, -4.0, 0.0], &mut values)?;
/// assert_eq!(values, [Complex::new(0.0, 2.0), Complex::new(0.0, -2.0)]);
/// # Ok::<(), mbs_runtime::control::ControlError>(())
/// ```
///
/// # Errors
/// [`ControlError::NotFinite`]: an entry or an eigenvalue is infinite or NaN.
/// [`ControlError::NotConverged`]: the iteration did not split all eigenvalues off.
///
/// # Panics
/// The lengths of the slices do not fit.
pub fn eigenvalues_in_place(matrix: &mut [f64], values: &mut [Complex]) -> Result<(), ControlError> {
    let count = values.len();
    assert_eq!(matrix.len(), count * count, "a matrix has as many eigenvalues as rows and columns");
    let is_finite = matrix.iter().all(|entry| entry.is_finite());
    let mut h = Square { count, entries: matrix };
    if is_finite {
        reduce(&mut h);
        deflate(&mut h, values)?;
    }
    let finite = is_finite && values.iter().all(|value| value.re.is_finite() && value.im.is_finite());
    if finite { Ok(()) } else { Err(ControlError::NotFinite { matrix: 'A' }) }
}

/// To Hessenberg form, column by column, by Householder's reflections. The vector of one stands in the column that it
/// clears.
fn reduce(h: &mut Square<'_>) {
    let n = h.count;
    for k in 1..n.saturating_sub(1) {
        let greatest = (k..n).fold(0.0, |most: f64, i| most.max(h[i][k - 1].abs()));
        if greatest == 0.0 {
            continue;
        }
        (k..n).for_each(|i| h[i][k - 1] /= greatest);
        let squares = |h: &Square<'_>| (k..n).map(|i| h[i][k - 1] * h[i][k - 1]).sum::<f64>();
        let length = Scalar::sqrt(squares(h)).copysign(h[k][k - 1]);
        h[k][k - 1] += length;
        let half = 0.5 * squares(h);
        for j in k..n {
            let along = (k..n).map(|i| h[i][k - 1] * h[i][j]).sum::<f64>() / half;
            (k..n).for_each(|i| h[i][j] -= along * h[i][k - 1]);
        }
        for i in 0..n {
            let along = (k..n).map(|j| h[i][j] * h[j][k - 1]).sum::<f64>() / half;
            (k..n).for_each(|j| h[i][j] -= along * h[j][k - 1]);
        }
        h[k][k - 1] = -length * greatest;
        (k + 1..n).for_each(|i| h[i][k - 1] = 0.0);
    }
}

/// Splits off one or two eigenvalues at the lower end at a time.
fn deflate(h: &mut Square<'_>, values: &mut [Complex]) -> Result<(), ControlError> {
    let size: f64 = h.entries.iter().map(|entry| entry.abs()).sum();
    // Rows from `end` on are done; `shifted` was taken off the diagonal of the others.
    let (mut end, mut steps, mut shifted) = (h.count, 0, 0.0);
    while end > 0 {
        let last = end - 1;
        let least = if steps < PATIENCE { 0.0 } else { size };
        let first = start_of_block(h, last, size, least);
        if first == last {
            values[last] = Complex::new(h[last][last] + shifted, 0.0);
            (end, steps) = (last, 0);
        } else if first + 1 == last {
            let pair = pair(h[first][first], h[first][last], h[last][first], h[last][last]);
            [values[first], values[last]] = pair.map(|value| Complex::new(value.re + shifted, value.im));
            (end, steps) = (first, 0);
        } else if steps == STEPS {
            return Err(ControlError::NotConverged);
        } else {
            double_step(h, first, last, &mut shifted, steps);
            steps += 1;
        }
    }
    Ok(())
}

/// The first row of the block that ends with the row `last`: above it the subdiagonal is zero to rounding, of its
/// neighbours, or of `least` where that is more.
fn start_of_block(h: &mut Square<'_>, last: usize, size: f64, least: f64) -> usize {
    for row in (1..=last).rev() {
        let near = h[row - 1][row - 1].abs() + h[row][row].abs();
        let near = if near == 0.0 { size } else { near.max(least) };
        if h[row][row - 1].abs() <= f64::EPSILON * near {
            h[row][row - 1] = 0.0;
            return row;
        }
    }
    0
}

/// The eigenvalues of `[[a, b], [c, d]]`.
fn pair(a: f64, b: f64, c: f64, d: f64) -> [Complex; 2] {
    let half = 0.5 * (a - d);
    // The discriminant `half² + b c` in units of its parts, as squares may overflow.
    let unit = half.abs().max(b.abs()).max(c.abs());
    if unit == 0.0 {
        return [Complex::new(a, 0.0), Complex::new(d, 0.0)];
    }
    let (p, bc) = (half / unit, (b / unit) * (c / unit));
    let square = p * p + bc;
    let root = Scalar::sqrt(square.abs());
    if square < 0.0 {
        let (re, im) = (0.5 * a + 0.5 * d, unit * root);
        return [Complex::new(re, im), Complex::new(re, -im)];
    }
    // The larger distance from d by a sum that does not cancel, the other from their product.
    let far = p + root.copysign(p);
    let near = if far == 0.0 { 0.0 } else { -bc / far };
    [Complex::new(d + unit * far, 0.0), Complex::new(d + unit * near, 0.0)]
}

/// One implicit step with two shifts, on the rows `first` to `last`.
fn double_step(h: &mut Square<'_>, first: usize, last: usize, shifted: &mut f64, steps: usize) {
    let (mut x, mut y) = (h[last][last], h[last - 1][last - 1]);
    let mut w = h[last][last - 1] * h[last - 1][last];
    if steps % 10 == 9 {
        *shifted += x;
        (0..=last).for_each(|i| h[i][i] -= x);
        let size = h[last][last - 1].abs() + h[last - 1][last - 2].abs();
        (x, y, w) = (0.75 * size, 0.75 * size, -0.4375 * size * size);
    }
    // The first column of (H − s₁)(H − s₂), begun where two subdiagonal entries in succession are small.
    let mut m = last - 2;
    let mut column: [f64; 3];
    loop {
        let z = h[m][m];
        let (r, s) = (x - z, y - z);
        column = [(r * s - w) / h[m + 1][m] + h[m][m + 1], h[m + 1][m + 1] - z - r - s, h[m + 2][m + 1]];
        let size: f64 = column.iter().map(|entry| entry.abs()).sum();
        column = column.map(|entry| entry / size);
        if m == first {
            break;
        }
        let beside = h[m][m - 1].abs() * (column[1].abs() + column[2].abs());
        let around = h[m - 1][m - 1].abs() + z.abs() + h[m + 1][m + 1].abs();
        if beside <= f64::EPSILON * column[0].abs() * around {
            break;
        }
        m -= 1;
    }
    for i in m + 2..=last {
        h[i][i - 2] = 0.0;
        if i > m + 2 {
            h[i][i - 3] = 0.0;
        }
    }
    for k in m..last {
        let three = k + 1 < last;
        let mut size = 1.0;
        if k > m {
            column = [h[k][k - 1], h[k + 1][k - 1], if three { h[k + 2][k - 1] } else { 0.0 }];
            size = column.iter().map(|entry| entry.abs()).sum();
            if size == 0.0 {
                continue;
            }
            column = column.map(|entry| entry / size);
        }
        let [p, q, r] = column;
        let length = Scalar::sqrt(p * p + q * q + r * r).copysign(p);
        if length == 0.0 {
            continue;
        }
        if k > m {
            h[k][k - 1] = -length * size;
        } else if first != m {
            h[k][k - 1] = -h[k][k - 1];
        }
        reflect(h, k, first, last, [p + length, q, r], length);
    }
}

/// The reflection of the rows and columns k to k + 2 that takes `(p, q, r)` to the first axis; `v` is `(p + length, q,
/// r)`.
fn reflect(h: &mut Square<'_>, k: usize, first: usize, last: usize, v: [f64; 3], length: f64) {
    let count = if k + 1 < last { 3 } else { 2 };
    let left = v.map(|entry| entry / length);
    let right = v.map(|entry| entry / v[0]);
    for j in k..=last {
        let along: f64 = (0..count).map(|i| right[i] * h[k + i][j]).sum();
        (0..count).for_each(|i| h[k + i][j] -= along * left[i]);
    }
    for i in first..=last.min(k + 3) {
        let row = &mut h[i];
        let along: f64 = (0..count).map(|i| left[i] * row[k + i]).sum();
        (0..count).for_each(|i| row[k + i] -= along * right[i]);
    }
}

#[cfg(test)]
mod tests {
    use super::{Complex, eigenvalues_in_place, pair};

    /// But for rounding, a chain of four states: `x₁' = x₂`, …, and so a fourfold zero; and a state by itself.
    #[test]
    fn a_fourfold_zero_beside_noise() {
        let mut matrix = [
            [8.905747765611948e-31, 0.0, -1.4980828940173423e-29, -5.806703051018799e-17, 0.0],
            [0.0, -0.005999849004384439, 0.0, 0.0, 0.0],
            [0.0, 0.07805046944030569, 0.0, 5.100904499967477e-19, -0.41767849796643886],
            [0.4251141231676281, 0.0, 0.1448530766738696, -1.5510592598593792e-17, 0.0],
            [-0.45299013333762406, 0.0, 0.0, 2.1569653192512136e-31, 0.0],
        ];
        let mut values = [Complex::default(); 5];
        eigenvalues_in_place(matrix.as_flattened_mut(), &mut values).unwrap();
        let far = |value: &&Complex| value.re.hypot(value.im) > 1e-3;
        assert_eq!(values.iter().filter(far).count(), 1, "{values:?}");
        let alone = values.iter().find(far).unwrap();
        assert!((alone.re + 0.005999849004384439).abs() < 1e-16 && alone.im == 0.0, "{alone:?}");
    }

    #[test]
    fn pairs_of_real_eigenvalues() {
        // Their sum is the trace, their product the determinant.
        for [a, b, c, d] in [[2.0, 1.0, 1.0, 2.0], [5.0, 2.0, -1.0, 2.0], [1.0, 1e8, 1e-8, -3.0], [4.0, 0.0, 7.0, -4.0]]
        {
            let [x, y] = pair(a, b, c, d).map(|z| z.re);
            assert!((x + y - (a + d)).abs() < 1e-14 * 5.0, "{x} {y}");
            assert!((x * y - (a * d - b * c)).abs() < 1e-14 * 20.0, "{x} {y}");
        }
    }
}
