//! Forward dynamics: `q̈ = M⁻¹ (Q − h − ∂D/∂q̇)` by a factorization, never by an inverse.
//!
//! Without constraints M is positive definite, and `L D Lᵀ` needs no pivoting: it is unrolled where the mechanism is
//! small. With constraints accelerations and multipliers solve one system,
//!
//! ```text
//! ⎡ M  −Aᵀ ⎤ ⎡ q̈ ⎤   ⎡ Q − h − ∂D/∂q̇ ⎤
//! ⎣ A   0  ⎦ ⎣ λ ⎦ = ⎣      −γ       ⎦
//! ```
//!
//! of which M and A may each be singular as long as the motions that A allows have inertia: unit quaternions, two
//! coordinates that turn about one axis in some states, rows that depend on others. Which coordinates depend on which
//! is then decided at run time, by the runtime's `constrained_solve`; `expr/constrained.rs` does the same in process.
//! Nocedal & Wright, *Numerical Optimization*, 2nd ed. 2006, section 16.2.

use crate::equations::{Constraints, Factorization, ForwardDynamics, Lagrange, Rows, Step};
use crate::expr::Expr;
use crate::mistake::rule;

/// Up to this many coordinates the factorization of M is unrolled in the generated function; beyond, the runtime's loop
/// takes the mass matrix, because `n³/6` statements would be slower than a loop.
pub const LARGEST_UNROLLED: usize = 8;

/// Sets up `M q̈ = Q − h − ∂D/∂q̇`, with constraints if there are any, and solves it where the mechanism is small and
/// has none.
pub(crate) fn forward_dynamics<'g>(lagrange: &Lagrange<'g>, constraints: &Constraints<'g>) -> ForwardDynamics<'g> {
    let mut right_side = lagrange.free_force.clone();
    right_side.extend(constraints.bias.iter().map(|&bias| -bias));
    let (mass_matrix, jacobian) = (lagrange.mass_matrix.clone(), constraints.jacobian.clone());
    let is_unrolled = jacobian.is_empty() && (1..=LARGEST_UNROLLED).contains(&mass_matrix.len());
    let factorization = is_unrolled.then(|| Factorization::new(&mass_matrix));
    let unrolled = factorization.as_ref().map(|factorization| factorization.solve(&right_side));
    let articulated = lagrange.accelerations.clone().filter(|_| jacobian.is_empty());
    ForwardDynamics { mass_matrix, jacobian, right_side, unrolled, factorization, articulated }
}

impl ForwardDynamics<'_> {
    /// Without a factorization, where articulated bodies give the accelerations.
    pub(crate) fn by_articulated_bodies(mut self) -> Self {
        if self.articulated.is_some() {
            (self.unrolled, self.factorization) = (self.articulated.take(), None);
        }
        self
    }
}

impl<'g> Factorization<'g> {
    /// Factorizes the lower triangle of `m`, in the order of its rows.
    pub(crate) fn new(m: &Rows<'g>) -> Self {
        let mut lower: Rows<'g> = Vec::new();
        let mut reciprocal: Vec<Expr<'g>> = Vec::new();
        for i in 0..m.len() {
            // (L D)ᵢⱼ = Mᵢⱼ − Σₖ (L D)ᵢₖ Lⱼₖ, k < j < i
            let mut scaled: Vec<Expr<'g>> = Vec::new();
            (0..=i).for_each(|j| m[i][j].note(format_args!("m_{i}_{j}")));
            for j in 0..i {
                scaled.push((0..j).fold(m[i][j], |sum, k| sum - scaled[k] * lower[j][k]));
            }
            let row: Vec<_> = (0..i).map(|j| scaled[j] * reciprocal[j]).collect();
            for j in 0..i {
                scaled[j].note(format_args!("ld_{i}_{j}"));
                row[j].note(format_args!("l_{i}_{j}"));
            }
            // Dᵢ = Mᵢᵢ − Σₖ (L D)ᵢₖ Lᵢₖ
            let pivot = (0..i).fold(m[i][i], |sum, k| sum - rule!("a pivot", scaled[k], row[k]) * row[k]);
            pivot.note(format_args!("d_{i}"));
            reciprocal.push(pivot.powi(-1));
            lower.push(row);
        }
        let step = |(pivot, reciprocal)| {
            let column = (pivot + 1..m.len()).map(|i| (i, lower[i][pivot])).collect();
            Step { pivot, column, reciprocal }
        };
        Factorization { steps: reciprocal.into_iter().enumerate().map(step).collect() }
    }

    /// `M⁻¹ b`: forward substitution, scaling, back substitution.
    pub(crate) fn solve(&self, b: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let mut x = self.reduce(b);
        for step in &self.steps {
            x[step.pivot] = x[step.pivot] * step.reciprocal;
        }
        self.substitute_back(x)
    }

    /// `L⁻¹ b`
    pub(crate) fn reduce(&self, b: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let mut x = b.to_vec();
        for step in &self.steps {
            for &(i, factor) in &step.column {
                x[i] = x[i] - factor * x[step.pivot];
            }
        }
        x.iter().enumerate().for_each(|(i, y)| y.note(format_args!("y_{i}")));
        x
    }

    /// `L⁻ᵀ x`
    pub(crate) fn substitute_back(&self, mut x: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        for step in self.steps.iter().rev() {
            x[step.pivot] = step.column.iter().fold(x[step.pivot], |sum, &(j, factor)| sum - factor * x[j]);
        }
        x
    }
}
