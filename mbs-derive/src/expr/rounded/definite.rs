//! Positive definite systems of many unknowns, most entries of which are zero: `L D Lᵀ` by what is not zero, and bounds
//! on the inverse by the sizes of the entries of L.

/// `M = L D Lᵀ` in doubles, in the order of the rows.
pub(super) struct Factors {
    /// D
    pivots: Vec<f64>,
    /// The columns of L below its diagonal, where they are not zero: row and entry, rows rising.
    columns: Vec<Vec<(usize, f64)>>,
}

impl Factors {
    /// Of the lower triangle of M, row by row; `None` where M is not positive definite, or not clearly.
    pub(super) fn of(n: usize, lower: &[f64]) -> Option<Self> {
        let mut factors = Factors { pivots: Vec::new(), columns: vec![Vec::new(); n] };
        for i in 0..n {
            // y = (L D)ᵢ, from M's row on.
            let row = &lower[i * (i + 1) / 2..][..=i];
            let (mut y, own) = (row[..i].to_vec(), row[i]);
            let mut pivot = own;
            for j in 0..i {
                if y[j] == 0.0 {
                    continue;
                }
                let (known, entry) = (y[j], y[j] / factors.pivots[j]);
                for &(k, factor) in factors.columns[j].iter().take_while(|(k, _)| *k < i) {
                    y[k] -= factor * known;
                }
                pivot -= known * entry;
                factors.columns[j].push((i, entry));
            }
            let rounding = 16.0 * n as f64 * f64::EPSILON * own;
            if pivot.is_nan() || pivot <= rounding {
                return None;
            }
            factors.pivots.push(pivot);
        }
        Some(factors)
    }

    /// `M⁻¹ b`
    pub(super) fn solve(&self, b: &[f64]) -> Vec<f64> {
        self.substituted(b, |sum, factor, x| sum - factor * x)
    }

    /// Bounds on `|M⁻¹| b` for `b ≥ 0`: since `|L⁻¹|` is at most the inverse of the factor whose entries below the
    /// diagonal are `−|Lᵢⱼ|`.
    ///
    /// Source: Higham, *Accuracy and Stability of Numerical Algorithms*, 2nd ed. 2002, section 8.3.
    pub(super) fn bounds(&self, b: &[f64]) -> Vec<f64> {
        self.substituted(b, |sum, factor, x| sum + factor.abs() * x)
    }

    fn substituted(&self, b: &[f64], less: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
        let mut x = b.to_vec();
        for (j, column) in self.columns.iter().enumerate() {
            column.iter().for_each(|&(i, factor)| x[i] = less(x[i], factor, x[j]));
        }
        for (j, column) in self.columns.iter().enumerate().rev() {
            x[j] = column.iter().fold(x[j] / self.pivots[j], |sum, &(i, factor)| less(sum, factor, x[i]));
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of masses with `Mᵢᵢ = 4`, `Mᵢ,ᵢ₋₁ = −1` and `Mₙ₁ = 0.5`, times x is b.
    #[test]
    fn solutions_fit_and_bounds_bound() {
        let n = 9;
        let entry = |i: usize, j: usize| match i - j {
            0 => 4.0,
            1 => -1.0,
            8 => 0.5,
            _ => 0.0,
        };
        let lower: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| entry(i, j))).collect();
        let factors = Factors::of(n, &lower).expect("a positive definite matrix");
        let x: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        let b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i.max(j), i.min(j)) * x[j]).sum()).collect();
        let found = factors.solve(&b);
        assert!(found.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {x:?}");
        let unit = |j: usize| -> Vec<f64> { (0..n).map(|i| f64::from(u8::from(i == j))).collect() };
        let inverse: Vec<Vec<f64>> = (0..n).map(|j| factors.solve(&unit(j))).collect();
        let bounds = factors.bounds(&[1.0; 9]);
        for i in 0..n {
            let sum: f64 = inverse.iter().map(|column| column[i].abs()).sum();
            assert!(sum <= bounds[i] * (1.0 + 1e-12) && bounds[i] < 3.0 * sum, "{i}: {sum} {}", bounds[i]);
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        assert!(Factors::of(2, &[1.0, 1.0, 1.0]).is_none());
        assert!(Factors::of(2, &[1.0, 2.0, 1.0]).is_none());
        assert!(Factors::of(1, &[f64::NAN]).is_none());
        assert!(Factors::of(1, &[0.0]).is_none());
    }
}
