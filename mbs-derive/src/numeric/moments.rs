//! Principal moments of inertia, and whether a body can have them.

/// Principal moments are rounded in data sheets.
const TOLERANCE: f64 = 1e-3;

/// Why no distribution of mass has certain principal moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Impossible {
    /// One is negative.
    Negative,
    /// One is greater than the sum of the other two.
    Unequal,
}

impl Impossible {
    /// Of moments in ascending order: those of a body have `0 ≤ a ≤ b ≤ c ≤ a + b`.
    pub(crate) fn of([a, b, c]: [f64; 3]) -> Option<Self> {
        if a < -TOLERANCE * c.abs().max(b.abs()).max(a.abs()) {
            Some(Impossible::Negative)
        } else if a + b < c * (1.0 - TOLERANCE) {
            Some(Impossible::Unequal)
        } else {
            None
        }
    }
}

/// The principal moments of an inertia, given row by row, ascending; `None` of anything but nine entries.
pub(crate) fn principal_moments(entries: &[f64]) -> Option<[f64; 3]> {
    let &[a, b, c, d, e, f, g, h, i] = entries else { return None };
    Some(eigenvalues([[a, b, c], [d, e, f], [g, h, i]]))
}

/// The eigenvalues of a symmetric matrix, ascending.
///
/// Source: Smith, *Eigenvalues of a symmetric 3 × 3 matrix*, Communications of the ACM 4:4, 1961.
fn eigenvalues(m: [[f64; 3]; 3]) -> [f64; 3] {
    let mean = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
    let centred = |i: usize, j: usize| m[i][j] - if i == j { mean } else { 0.0 };
    let squares: f64 = (0..3).flat_map(|i| (0..3).map(move |j| centred(i, j).powi(2))).sum();
    let spread = (squares / 6.0).sqrt();
    if spread <= 1e-300 {
        return [mean; 3];
    }
    let b = |i: usize, j: usize| centred(i, j) / spread;
    let determinant = b(0, 0) * (b(1, 1) * b(2, 2) - b(1, 2) * b(2, 1))
        - b(0, 1) * (b(1, 0) * b(2, 2) - b(1, 2) * b(2, 0))
        + b(0, 2) * (b(1, 0) * b(2, 1) - b(1, 1) * b(2, 0));
    let angle = libm::acos((determinant / 2.0).clamp(-1.0, 1.0)) / 3.0;
    let third_turn = 2.0 * std::f64::consts::FRAC_PI_3;
    let largest = mean + 2.0 * spread * libm::cos(angle);
    let smallest = mean + 2.0 * spread * libm::cos(angle + third_turn);
    [smallest, 3.0 * mean - largest - smallest, largest]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_some_matrices() {
        let check = |matrix: [[f64; 3]; 3], expected: [f64; 3]| {
            let found = eigenvalues(matrix);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        };
        check([[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]], [1.0, 2.0, 3.0]);
        check([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]], [2.0, 2.0, 2.0]);
        check([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 5.0]], [1.0, 3.0, 5.0]);
        check([[0.0; 3]; 3], [0.0; 3]);
        // 4 I + 3 v vᵀ with v = (1, 2, −1), where no entry is zero.
        check([[7.0, 6.0, -3.0], [6.0, 16.0, -6.0], [-3.0, -6.0, 7.0]], [4.0, 4.0, 22.0]);
        // Of determinant 1·4·9: diag(1, 4, 9) in the axes (2, 2, 1)/3, (−2, 1, 2)/3, (1, −2, 2)/3.
        let rotated = [[29.0, -22.0, 4.0], [-22.0, 44.0, -26.0], [4.0, -26.0, 53.0]];
        check(rotated.map(|row| row.map(|entry| entry / 9.0)), [1.0, 4.0, 9.0]);
    }

    /// A rod has (0, c, c), a disk (a, a, 2a): the limits of what bodies have.
    #[test]
    fn moments_of_bodies_are_told_from_others() {
        for possible in [[0.0, 1.0, 1.0], [1.0, 1.0, 2.0], [1.0, 1.0, 2.0015], [-1e-4, 1.0, 1.0], [0.0; 3]] {
            assert_eq!(Impossible::of(possible), None, "{possible:?}");
        }
        assert_eq!(Impossible::of([1.0, 1.0, 2.1]), Some(Impossible::Unequal));
        assert_eq!(Impossible::of([0.0, 1.0, 2.0]), Some(Impossible::Unequal));
        assert_eq!(Impossible::of([-0.1, 1.0, 1.0]), Some(Impossible::Negative));
        assert_eq!(Impossible::of([-1.0, -1.0, 1.0]), Some(Impossible::Negative));
    }
}
