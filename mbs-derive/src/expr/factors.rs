//! Symmetric systems, solved as the runtime solves them.

use super::evaluate::Value;

/// `M = L D Lᵀ` in the order of operations of the runtime's `Ldlt`, so that the results are the same bits.
pub(super) struct Factors<V> {
    lower: Vec<Vec<V>>,
    reciprocal: Vec<V>,
}

impl<V: Value> Factors<V> {
    /// Of a matrix given by its lower triangle, row by row.
    pub(super) fn new(n: usize, triangle: &[V]) -> Self {
        let m = |i: usize, j: usize| triangle[i * (i + 1) / 2 + j];
        let mut lower: Vec<Vec<V>> = Vec::new();
        let mut reciprocal: Vec<V> = Vec::new();
        for i in 0..n {
            let mut scaled: Vec<V> = Vec::new();
            for j in 0..i {
                scaled.push((0..j).fold(m(i, j), |sum, k| less_product(sum, scaled[k], lower[j][k])));
            }
            let divided = |j: usize| if scaled[j].is_exactly_zero() { scaled[j] } else { scaled[j].mul(reciprocal[j]) };
            let row: Vec<V> = (0..i).map(divided).collect();
            let pivot = (0..i).fold(m(i, i), |sum, k| less_product(sum, scaled[k], row[k]));
            reciprocal.push(V::constant(1.0).div(pivot));
            lower.push(row);
        }
        Factors { lower, reciprocal }
    }

    /// `M⁻¹ x` in the place of x.
    pub(super) fn solve(&self, x: &mut [V]) {
        let n = self.reciprocal.len();
        for i in 0..n {
            x[i] = (0..i).fold(x[i], |sum, k| less_product(sum, self.lower[i][k], x[k]));
        }
        for (x, &reciprocal) in x.iter_mut().zip(&self.reciprocal) {
            *x = x.mul(reciprocal);
        }
        for i in (0..n).rev() {
            x[i] = (i + 1..n).fold(x[i], |sum, k| less_product(sum, self.lower[k][i], x[k]));
        }
    }
}

/// `sum − a b`
fn less_product<V: Value>(sum: V, a: V, b: V) -> V {
    if a.is_exactly_zero() || b.is_exactly_zero() { sum } else { sum.sub(a.mul(b)) }
}

/// `M x` of a symmetric matrix given by its lower triangle.
pub(super) fn symmetric_times<V: Value>(triangle: &[V], x: &[V]) -> Vec<V> {
    let entry = |i: usize, j: usize| triangle[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    let row = |i: usize| {
        x.iter().enumerate().fold(V::constant(0.0), |sum, (j, &x)| {
            if entry(i, j).is_exactly_zero() { sum } else { sum.add(entry(i, j).mul(x)) }
        })
    };
    (0..x.len()).map(row).collect()
}

/// The rows of a symmetric matrix given by its lower triangle.
pub(super) fn symmetric<V: Copy>(n: usize, triangle: &[V]) -> Vec<Vec<V>> {
    let entry = |i: usize, j: usize| triangle[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Dual;

    /// The derivative of a solution, with the factors differentiated and without.
    #[test]
    fn a_solution_is_differentiated_by_its_equation() {
        let triangle = [(4.0, 0.3), (1.0, -0.2), (3.0, 0.7), (-0.5, 1.1), (0.25, 0.4), (2.0, -0.6)];
        let triangle = triangle.map(|(value, derivative)| Dual::new(value, derivative));
        let right = [(1.0, 2.0), (-3.0, 0.5), (0.7, -1.0)].map(|(value, derivative)| Dual::new(value, derivative));
        let mut expected = right;
        Factors::new(3, &triangle).solve(&mut expected);
        let mut columns = [right.to_vec()];
        Value::solve_symmetric(&triangle, &mut columns);
        for (found, expected) in columns[0].iter().zip(expected) {
            assert!((found.value - expected.value).abs() < 1e-15);
            assert!((found.derivative - expected.derivative).abs() < 1e-14, "{found:?} {expected:?}");
        }
    }
}
