//! Matrices at the boundary of generated code are arrays of rows, `m[row][column]`; here they become nalgebra's.
//!
//! nalgebra's own conversions of nested arrays take them as *columns*; these do not.

use nalgebra::{SMatrix, SVector};

/// The matrix with these rows: `matrix[(i, j)] = rows[i][j]`.
///
/// ```
/// use mbs_runtime::to_matrix;
///
/// let matrix = to_matrix(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
/// assert_eq!((matrix.nrows(), matrix.ncols(), matrix[(0, 2)]), (2, 3, 3.0));
/// ```
pub fn to_matrix<T: nalgebra::Scalar, const ROWS: usize, const COLUMNS: usize>(
    rows: &[[T; COLUMNS]; ROWS],
) -> SMatrix<T, ROWS, COLUMNS> {
    SMatrix::from_fn(|i, j| rows[i][j].clone())
}

/// The rows of this matrix: `rows[i][j] = matrix[(i, j)]`.
pub fn to_rows<T: nalgebra::Scalar, const ROWS: usize, const COLUMNS: usize>(
    matrix: &SMatrix<T, ROWS, COLUMNS>,
) -> [[T; COLUMNS]; ROWS] {
    core::array::from_fn(|i| core::array::from_fn(|j| matrix[(i, j)].clone()))
}

/// The column vector with these components.
pub fn to_vector<T: nalgebra::Scalar, const N: usize>(components: &[T; N]) -> SVector<T, N> {
    SVector::from_fn(|i, _| components[i].clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stay_rows() {
        let rows = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
        let matrix = to_matrix(&rows);
        assert_eq!(matrix[(2, 0)], 5.0);
        assert_eq!(to_rows(&matrix), rows);
        assert_eq!(to_vector(&[7, 8])[1], 8);
    }
}
