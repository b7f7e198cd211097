//! Vectors with three components, and products of matrices of 3 × 3 with them. A matrix is an array of its rows.

use mbs_runtime::Scalar;

/// `a·b`
#[inline]
pub(crate) fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`
#[inline]
pub(crate) fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + b`
#[inline]
pub(crate) fn plus<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a − b`
#[inline]
pub(crate) fn minus<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `A x`
#[inline]
pub(crate) fn product<T: Scalar>(matrix: &[[T; 3]; 3], x: &[T; 3]) -> [T; 3] {
    matrix.map(|row| dot(&row, x))
}
