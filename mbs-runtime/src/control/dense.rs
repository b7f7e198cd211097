//! Small dense matrices: arrays of rows.

/// `A B`
pub(super) fn product<const M: usize, const K: usize, const N: usize>(
    a: &[[f64; K]; M],
    b: &[[f64; N]; K],
) -> [[f64; N]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..K).map(|k| a[i][k] * b[k][j]).sum()))
}

/// `Aᵀ`
pub(super) fn transpose<const M: usize, const N: usize>(a: &[[f64; N]; M]) -> [[f64; M]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

/// `A + B`
pub(super) fn sum<const M: usize, const N: usize>(a: &[[f64; N]; M], b: &[[f64; N]; M]) -> [[f64; N]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// `A − B`
pub(super) fn difference<const M: usize, const N: usize>(a: &[[f64; N]; M], b: &[[f64; N]; M]) -> [[f64; N]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] - b[i][j]))
}

/// `k A`
pub(super) fn scaled<const M: usize, const N: usize>(k: f64, a: &[[f64; N]; M]) -> [[f64; N]; M] {
    a.map(|row| row.map(|entry| k * entry))
}

/// `k 1`
pub(super) fn identity<const N: usize>(k: f64) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { k } else { 0.0 }))
}

/// `½ (A + Aᵀ)`
pub(super) fn symmetric<const N: usize>(a: &[[f64; N]; N]) -> [[f64; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * a[i][j] + 0.5 * a[j][i]))
}

/// The largest sum of a column's sizes.
pub(super) fn norm<const M: usize, const N: usize>(a: &[[f64; N]; M]) -> f64 {
    (0..N).map(|j| a.iter().map(|row| row[j].abs()).sum::<f64>()).fold(0.0, f64::max)
}

pub(super) fn is_finite<const M: usize, const N: usize>(a: &[[f64; N]; M]) -> bool {
    a.iter().flatten().all(|entry| entry.is_finite())
}

/// `A⁻¹ B` by Gaussian elimination, the pivot of a column being the largest of what is left in units of its row; `None`
/// where there is none, or the result is not finite.
pub(super) fn solve<const N: usize, const K: usize>(
    mut a: [[f64; N]; N],
    mut b: [[f64; K]; N],
) -> Option<[[f64; K]; N]> {
    let mut size: [f64; N] = core::array::from_fn(|i| a[i].iter().fold(0.0, |most: f64, entry| most.max(entry.abs())));
    for k in 0..N {
        let better =
            |best: usize, i: usize| if a[i][k].abs() * size[best] > a[best][k].abs() * size[i] { i } else { best };
        let pivot = (k + 1..N).fold(k, better);
        if a[pivot][k] == 0.0 {
            return None;
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        size.swap(k, pivot);
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            if factor != 0.0 {
                (k..N).for_each(|j| a[i][j] -= factor * a[k][j]);
                (0..K).for_each(|j| b[i][j] -= factor * b[k][j]);
            }
        }
    }
    for k in (0..N).rev() {
        for j in 0..K {
            let known: f64 = (k + 1..N).map(|i| a[k][i] * b[i][j]).sum();
            b[k][j] = (b[k][j] - known) / a[k][k];
        }
    }
    is_finite(&b).then_some(b)
}

/// Powers of two `d` such that rows and columns of `D⁻¹ A D` are of the same size, `also` being counted with the rows.
///
/// B. N. Parlett and C. Reinsch, *Balancing a matrix for calculation of eigenvalues and eigenvectors*, 1969.
pub(super) fn balance<const N: usize, const K: usize>(a: &mut [[f64; N]; N], also: &mut [[f64; K]; N]) -> [f64; N] {
    let mut scale = [1.0; N];
    // Each change makes the norm less by a twentieth; a few sweeps do.
    for _ in 0..100 {
        let mut done = true;
        for i in 0..N {
            let column: f64 = (0..N).filter(|&j| j != i).map(|j| a[j][i].abs()).sum();
            let others: f64 = (0..N).filter(|&j| j != i).map(|j| a[i][j].abs()).sum();
            let row = others + also[i].iter().map(|entry| entry.abs()).sum::<f64>();
            if column == 0.0 || row == 0.0 || !(column + row).is_finite() {
                continue;
            }
            let (mut factor, mut new) = (1.0, column);
            while new < 0.5 * row && factor < 1e100 {
                (factor, new) = (2.0 * factor, 4.0 * new);
            }
            while new >= 2.0 * row && factor > 1e-100 {
                (factor, new) = (0.5 * factor, 0.25 * new);
            }
            if (new + row) / factor < 0.95 * (column + row) {
                done = false;
                scale[i] *= factor;
                a[i].iter_mut().for_each(|entry| *entry /= factor);
                also[i].iter_mut().for_each(|entry| *entry /= factor);
                a.iter_mut().for_each(|row| row[i] *= factor);
            }
        }
        if done {
            break;
        }
    }
    scale
}
