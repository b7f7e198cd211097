//! Rotations and vectors over any [`Number`].

use nalgebra::Vector3;
use std::array::from_fn;

use super::Number;

/// Rodrigues: `1 + sin θ e× + (1 − cos θ) (e eᵀ − 1)`.
pub(super) fn turn<S: Number>(e: [f64; 3], angle: S) -> [[S; 3]; 3] {
    let (s, c) = (angle.sin(), angle.cos());
    let versed = S::constant(1.0) - c;
    let skew = [[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]];
    from_fn(|i| {
        from_fn(|j| {
            let whole = versed * (e[i] * e[j]) + s * skew[i][j];
            if i == j { whole + c } else { whole }
        })
    })
}

/// The rotation of a unit quaternion: columns are `q e_k q̄`.
pub(super) fn quaternion_rotation<S: Number>([w, x, y, z]: [S; 4]) -> [[S; 3]; 3] {
    let one = S::constant(1.0);
    [
        [one - (y * y + z * z) * 2.0, (x * y - w * z) * 2.0, (x * z + w * y) * 2.0],
        [(x * y + w * z) * 2.0, one - (x * x + z * z) * 2.0, (y * z - w * x) * 2.0],
        [(x * z - w * y) * 2.0, (y * z + w * x) * 2.0, one - (x * x + y * y) * 2.0],
    ]
}

/// Rows of `ω = 2 vec(q̄ q̇)`, in the turned axes.
pub(super) fn ball_rates<S: Number>([w, x, y, z]: [S; 4]) -> [[S; 4]; 3] {
    [[-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]].map(|row| row.map(|c| c * 2.0))
}

pub(super) fn unit(axis: [f64; 3]) -> [f64; 3] {
    Vector3::from(axis).normalize().into()
}

pub(super) fn add<S: Number>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    from_fn(|i| a[i] + b[i])
}

pub(super) fn sub<S: Number>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    from_fn(|i| a[i] - b[i])
}

pub(super) fn dot<S: Number>(a: [S; 3], b: [S; 3]) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<S: Number>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

pub(super) fn times<S: Number>(matrix: &[[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    matrix.map(|row| dot(row, vector))
}

/// `Rᵀ v`
pub(super) fn into<S: Number>(rotation: &[[S; 3]; 3], vector: [S; 3]) -> [S; 3] {
    from_fn(|j| dot(from_fn(|i| rotation[i][j]), vector))
}

pub(super) fn product<S: Number>(a: &[[S; 3]; 3], b: &[[S; 3]; 3]) -> [[S; 3]; 3] {
    a.map(|row| from_fn(|j| dot(row, from_fn(|k| b[k][j]))))
}
