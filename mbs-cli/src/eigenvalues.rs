//! The eigenvalues of a matrix of any size.

use mbs_runtime::control::{Complex, eigenvalues_in_place};
use nalgebra::linalg::balancing;
use nalgebra::{DMatrix, DVector};

/// The eigenvalues, in no order; `None` where they leave the range of numbers.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<nalgebra::Complex<f64>>> {
    if matrix.is_empty() {
        return Some(Vec::new());
    }
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let (balanced, unit, _) = balanced(matrix);
    let mut values = vec![Complex::default(); balanced.nrows()];
    // Row by row.
    eigenvalues_in_place(balanced.transpose().as_mut_slice(), &mut values).ok()?;
    let values: Vec<_> = values.iter().map(|value| nalgebra::Complex::new(value.re, value.im) * unit).collect();
    values.iter().all(|value| value.re.hypot(value.im).is_finite()).then_some(values)
}

/// Balanced by powers of two, in units of another one, and the powers `d` with `A = D A_balanced D⁻¹`: balancing
/// squares entries, and does not end where they overflow.
pub(crate) fn balanced(mut matrix: DMatrix<f64>) -> (DMatrix<f64>, f64, DVector<f64>) {
    // About 1e150. The greatest entry is left as large, so that the squares of small ones do not vanish.
    const LARGE: i32 = 498;
    let size = matrix.amax().log2();
    let unit = if size > f64::from(LARGE) && size.is_finite() { 2_f64.powi(size as i32 - LARGE) } else { 1.0 };
    matrix /= unit;
    let scale = balancing::balance_parlett_reinsch(&mut matrix);
    (matrix, unit, scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_of_any_size() {
        let found = eigenvalues(DMatrix::from_row_slice(2, 2, &[0.0, 1e100, -1e-100, 0.0])).unwrap();
        assert!(found.iter().all(|value| value.re == 0.0 && (value.im.abs() - 1.0).abs() < 1e-15), "{found:?}");
        assert_eq!(eigenvalues(DMatrix::zeros(0, 0)), Some(Vec::new()));
        assert_eq!(eigenvalues(DMatrix::from_element(1, 1, f64::NAN)), None);
        assert_eq!(eigenvalues(DMatrix::from_element(2, 2, f64::MAX)), None);
    }
}
