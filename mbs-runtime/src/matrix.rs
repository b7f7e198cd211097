//! Matrices at the boundary of generated code are arrays of rows, `m[row][column]`; here they become nalgebra's.
//!
//! nalgebra's own conversions of nested arrays take them as *columns*; these do not.

use nalgebra::{Isometry3, IsometryMatrix3, RealField, Rotation3, SMatrix, SVector, Translation3, UnitQuaternion};

use crate::mechanism::Pose;

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

/// Exact: the rotation stays a matrix.
impl<T: RealField> From<Pose<T>> for IsometryMatrix3<T> {
    fn from(pose: Pose<T>) -> Self {
        let rotation = Rotation3::from_matrix_unchecked(to_matrix(&pose.rotation));
        Self::from_parts(Translation3::from(pose.position), rotation)
    }
}

/// The rotation becomes a unit quaternion, up to rounding.
impl<T: RealField> From<Pose<T>> for Isometry3<T> {
    fn from(pose: Pose<T>) -> Self {
        let rotation = Rotation3::from_matrix_unchecked(to_matrix(&pose.rotation));
        Self::from_parts(Translation3::from(pose.position), UnitQuaternion::from_rotation_matrix(&rotation))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn rows_stay_rows() {
        let rows = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
        let matrix = to_matrix(&rows);
        assert_eq!(matrix[(2, 0)], 5.0);
        assert_eq!(to_rows(&matrix), rows);
        assert_eq!(to_vector(&[7, 8])[1], 8);
    }

    #[cfg(any(feature = "std", feature = "libm"))]
    #[test]
    fn a_pose_and_its_isometries_agree() {
        // A quarter turn about z: the body's x axis is the world's y axis.
        let pose = Pose { position: [1.0, 2.0, 3.0], rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] };
        assert_eq!(pose.transform_point([1.0, 0.0, 0.0]), [1.0, 3.0, 3.0]);
        let point = Point3::new(0.5, -0.25, 4.0);
        let expected = Point3::from(pose.transform_point([0.5, -0.25, 4.0]));
        let (by_matrix, by_quaternion) = (IsometryMatrix3::from(pose), Isometry3::from(pose));
        assert_eq!(by_matrix * point, expected);
        assert!((by_quaternion * point - expected).norm() < 1e-15);
    }
}
