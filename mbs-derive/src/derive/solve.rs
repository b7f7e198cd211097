//! Forward dynamics: `q̈ = M⁻¹ (Q − h − ∂D/∂q̇)` by a factorization, never by an inverse.
//!
//! With constraints accelerations and multipliers solve one symmetric system,
//!
//! ```text
//! ⎡ M  Aᵀ ⎤ ⎡  q̈ ⎤   ⎡ Q − h − ∂D/∂q̇ ⎤
//! ⎣ A  0  ⎦ ⎣ −λ ⎦ = ⎣      −γ       ⎦
//! ```
//!
//! whose `L D Lᵀ` eliminates the accelerations first: the range-space method, for a regular M and independent rows of A.
//! Where M itself is singular (unit quaternions), `M + Aᵀ A` stands in its place and `−Aᵀ γ` is added above: the same solution,
//! because `A q̈ = −γ`, from a matrix that is regular wherever M is on the motions that A allows.
//! Nocedal & Wright, *Numerical Optimization*, 2nd ed. 2006, section 16.2.

use crate::expr::{Expr, evaluate};
use crate::model::degree::eliminate;

use super::Rows;
use super::conserved::generic_value;
use super::constraint::Constraints;
use super::lagrange::Lagrange;

/// Up to this many coordinates the factorization is unrolled in the generated function; beyond, the runtime's loop
/// takes the mass matrix, because `n³/6` statements would be slower than a loop.
pub const LARGEST_UNROLLED: usize = 8;

/// How accelerations are found.
#[derive(Clone, Debug)]
pub struct ForwardDynamics<'g> {
    /// M, bordered by A where there are constraints.
    pub matrix: Rows<'g>,
    /// `Q − h − ∂D/∂q̇`, and −γ where there are constraints.
    pub right_side: Vec<Expr<'g>>,
    /// q̈ and −λ, where the factorization is unrolled.
    pub unrolled: Option<Vec<Expr<'g>>>,
    /// That factorization.
    pub factorization: Option<Factorization<'g>>,
    /// Whether `M + Aᵀ A` stands in the place of M.
    pub augmented: bool,
}

/// Sets up `M q̈ = Q − h − ∂D/∂q̇`, with constraints if there are any, and solves it where the mechanism is small.
pub fn forward_dynamics<'g>(lagrange: &Lagrange<'g>, constraints: &Constraints<'g>) -> ForwardDynamics<'g> {
    let mut right_side = lagrange.free_force.clone();
    right_side.extend(constraints.bias.iter().map(|&bias| -bias));
    let a = &constraints.jacobian;
    let augmented = is_singular(&lagrange.mass_matrix);
    if augmented {
        augment(&mut right_side, a);
    }
    let mass_matrix = if augmented { with_gram_matrix(&lagrange.mass_matrix, a) } else { lagrange.mass_matrix.clone() };
    let matrix = bordered(&mass_matrix, a);
    let factorization = (matrix.len() <= LARGEST_UNROLLED).then(|| Factorization::new(&matrix));
    let unrolled = factorization.as_ref().map(|factorization| factorization.solve(&right_side));
    ForwardDynamics { matrix, right_side, unrolled, factorization, augmented }
}

/// Adds `Aᵀ` times the lower part of a right side to its upper part.
pub(super) fn augment<'g>(right_side: &mut [Expr<'g>], a: &Rows<'g>) {
    let n = right_side.len() - a.len();
    for i in 0..n {
        right_side[i] = (0..a.len()).fold(right_side[i], |sum, k| sum + a[k][i] * right_side[n + k]);
    }
}

/// `M + Aᵀ A`
fn with_gram_matrix<'g>(m: &Rows<'g>, a: &Rows<'g>) -> Rows<'g> {
    let entry = |i: usize, j: usize| a.iter().fold(m[i][j], |sum, row| sum + row[i] * row[j]);
    (0..m.len()).map(|i| (0..m.len()).map(|j| entry(i, j)).collect()).collect()
}

/// Whether M is singular for all values of its symbols: tried at a point with no special relation.
fn is_singular(m: &Rows<'_>) -> bool {
    let values: Vec<f64> = evaluate(&m.concat(), |symbol| generic_value(symbol, 0));
    let finite = values.iter().all(|value| value.is_finite());
    finite && eliminate(&values, m.len()).smallest < 1e-11
}

/// M with A below, Aᵀ beside and 0 in the corner.
fn bordered<'g>(m: &Rows<'g>, a: &Rows<'g>) -> Rows<'g> {
    let zero = m[0][0].graph().integer(0);
    let upper = m.iter().enumerate().map(|(i, row)| row.iter().copied().chain(a.iter().map(|row| row[i])).collect());
    let lower = a.iter().map(|row| row.iter().copied().chain(vec![zero; a.len()]).collect());
    upper.chain(lower).collect()
}

/// `M = L D Lᵀ` with unit lower triangular L, rows and columns in the order of elimination.
///
/// Source: Golub & Van Loan, *Matrix Computations*, 4th ed. 2013, algorithm 4.1.1.
#[derive(Clone, Debug)]
pub struct Factorization<'g> {
    /// In the order of elimination.
    pub steps: Vec<Step<'g>>,
}

/// The elimination of one unknown.
#[derive(Clone, Debug)]
pub struct Step<'g> {
    /// Its number.
    pub pivot: usize,
    /// Of what is eliminated later: its number, and its entry in the pivot's column of L.
    pub column: Vec<(usize, Expr<'g>)>,
    /// `1/Dₚ`
    pub reciprocal: Expr<'g>,
}

impl<'g> Factorization<'g> {
    /// Factorizes the lower triangle of `m`, in the order of its rows.
    pub fn new(m: &Rows<'g>) -> Self {
        let mut lower: Rows<'g> = Vec::new();
        let mut reciprocal: Vec<Expr<'g>> = Vec::new();
        for i in 0..m.len() {
            // (L D)ᵢⱼ = Mᵢⱼ − Σₖ (L D)ᵢₖ Lⱼₖ, k < j < i
            let mut scaled: Vec<Expr<'g>> = Vec::new();
            for j in 0..i {
                scaled.push((0..j).fold(m[i][j], |sum, k| sum - scaled[k] * lower[j][k]));
            }
            let row: Vec<_> = (0..i).map(|j| scaled[j] * reciprocal[j]).collect();
            // Dᵢ = Mᵢᵢ − Σₖ (L D)ᵢₖ Lᵢₖ
            let pivot = (0..i).fold(m[i][i], |sum, k| sum - scaled[k] * row[k]);
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
    pub fn solve(&self, b: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let mut x = self.reduce(b);
        for step in &self.steps {
            x[step.pivot] = x[step.pivot] * step.reciprocal;
        }
        self.substitute_back(x)
    }

    /// `L⁻¹ b`
    pub fn reduce(&self, b: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let mut x = b.to_vec();
        for step in &self.steps {
            for &(i, factor) in &step.column {
                x[i] = x[i] - factor * x[step.pivot];
            }
        }
        x
    }

    /// `L⁻ᵀ x`
    pub fn substitute_back(&self, mut x: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        for step in self.steps.iter().rev() {
            x[step.pivot] = step.column.iter().fold(x[step.pivot], |sum, &(j, factor)| sum - factor * x[j]);
        }
        x
    }
}
