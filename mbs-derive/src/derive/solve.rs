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
//! Of many unknowns, most of which are not coupled, the system is eliminated in an order that is chosen here
//! (`expr/sparse.rs`). Nocedal & Wright, *Numerical Optimization*, 2nd ed. 2006, section 16.2.

use std::collections::BTreeSet;

use crate::equations::{Constraints, Factorization, ForwardDynamics, Lagrange, Rows, Step};
use crate::expr::sparse::{self, Order};
use crate::expr::{Elimination, Expr, Symbol, Tape};
use crate::mistake::rule;
use crate::model::Lagrangian;
use crate::model::sample::default_parameters;
use crate::numeric::Random;

/// Up to this many coordinates the factorization of M is unrolled in the generated function, whatever M; of more where
/// zeros of M make each of them cost no more than in a full matrix of this many. Else the runtime's loop takes the mass
/// matrix, because `n³/6` statements would be slower than a loop.
pub const LARGEST_UNROLLED: usize = 8;

/// The elimination has to go through at this many random states.
const STATES_TRIED: usize = 4;

/// Sets up `M q̈ = Q − h − ∂D/∂q̇`, with constraints if it has any, and solves it if it has no constraints and M is
/// small or mostly zero.
pub(crate) fn forward_dynamics<'g>(lagrange: &Lagrange<'g>, constraints: &Constraints<'g>) -> ForwardDynamics<'g> {
    let mut right_side = lagrange.free_force.clone();
    right_side.extend(constraints.bias.iter().map(|&bias| -bias));
    let (mass_matrix, jacobian) = (lagrange.mass_matrix.clone(), constraints.jacobian.clone());
    let factorization = jacobian.is_empty().then(|| Factorization::new(&mass_matrix)).flatten();
    let unrolled = factorization.as_ref().map(|factorization| factorization.solve(&right_side));
    let factorization = factorization.filter(Factorization::is_short);
    let articulated = lagrange.accelerations.clone().filter(|_| jacobian.is_empty());
    ForwardDynamics { mass_matrix, jacobian, right_side, unrolled, factorization, articulated, elimination: None }
}

/// How the system of M and A is eliminated, if it has many unknowns and constraints, most of it is zero, and M has an
/// inverse.
pub(crate) fn elimination<'g>(m: &Rows<'g>, a: &Rows<'g>, lagrangian: &Lagrangian<'_>) -> Option<Elimination> {
    let n = m.len();
    if a.is_empty() || n + a.len() <= sparse::FEW_UNKNOWNS {
        return None;
    }
    let triangle = (0..n).flat_map(|i| (0..=i).map(move |j| ([i, j], m[i][j])));
    let rows = (0..a.len()).flat_map(|k| (0..n).map(move |i| ([n + k, i], a[k][i])));
    let (places, entries): (_, Vec<Expr<'g>>) = triangle.chain(rows).filter(|(_, entry)| !entry.is_zero()).unzip();
    let elimination = Elimination::of(n, n + a.len(), places)?;
    let (tape, parameters) = (Tape::new(&entries), default_parameters(lagrangian));
    let mut random = Random::new(0x6f72_6465_7200);
    let mut goes_through = || {
        let state = random.state(lagrangian);
        let values = tape.run(|symbol| match symbol {
            Symbol::Parameter(i) => parameters[i as usize],
            symbol => state.value_of(symbol).unwrap_or(f64::NAN),
        });
        sparse::Factors::new(&elimination, &values).is_some()
    };
    (0..STATES_TRIED).all(|_| goes_through()).then_some(elimination)
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
    /// Factorizes the lower triangle of `m`, in an order in which i, j and k count; `None` where it has too many
    /// statements to be written out.
    pub(crate) fn new(m: &Rows<'g>) -> Option<Self> {
        let Order { unknowns: order, rows } = order(m)?;
        let entry = |i: usize, j: usize| m[order[i].max(order[j])][order[i].min(order[j])];
        // Rows of L: where there is an entry, and it.
        let mut lower: Vec<Vec<(usize, Expr<'g>)>> = Vec::new();
        let (mut reciprocal, mut columns): (Vec<Expr<'g>>, _) = (Vec::new(), vec![Vec::new(); order.len()]);
        for (i, in_row) in rows.iter().enumerate() {
            for &j in in_row.iter().chain([&i]) {
                let (row, column) = (order[i].max(order[j]), order[i].min(order[j]));
                m[row][column].note(format_args!("m_{row}_{column}"));
            }
            // (L D)ᵢⱼ = Mᵢⱼ − Σₖ (L D)ᵢₖ Lⱼₖ, k < j < i
            let mut of_row: Vec<(usize, Expr<'g>)> = Vec::new();
            for &j in in_row {
                let products = common(&of_row, &lower[j]);
                of_row.push((j, products.fold(entry(i, j), |sum, (a, b)| sum - a * b)));
            }
            let row: Vec<_> = of_row.iter().map(|&(j, e)| (j, e * reciprocal[j])).collect();
            for (&(j, e), &(_, factor)) in of_row.iter().zip(&row) {
                e.note(format_args!("ld_{}_{}", order[i], order[j]));
                factor.note(format_args!("l_{}_{}", order[i], order[j]));
                columns[j].push((order[i], factor));
            }
            // Dᵢ = Mᵢᵢ − Σₖ (L D)ᵢₖ Lᵢₖ
            let pairs = of_row.iter().zip(&row);
            let pivot =
                pairs.fold(entry(i, i), |sum, ((_, e), (_, factor))| sum - rule!("a pivot", *e, *factor) * *factor);
            pivot.note(format_args!("d_{}", order[i]));
            reciprocal.push(pivot.powi(-1));
            lower.push(row);
        }
        let steps = order.iter().zip(columns).zip(reciprocal);
        let steps = steps.map(|((&pivot, column), reciprocal)| Step { pivot, column, reciprocal });
        Some(Factorization { steps: steps.collect() })
    }

    /// Whether solutions for as many right sides as a linearization has are written out, too.
    fn is_short(&self) -> bool {
        let (n, entries) = (self.steps.len(), self.steps.iter().map(|step| step.column.len()).sum::<usize>());
        n <= LARGEST_UNROLLED || entries <= n
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

/// The order in which the unknowns of a symmetric matrix are eliminated, by the zeros of its lower triangle; `None`
/// where it has no rows, or too many statements to be written out: more for each unknown than a full matrix of
/// [`LARGEST_UNROLLED`].
fn order(m: &Rows<'_>) -> Option<Order> {
    let n = m.len();
    let mut coupled = vec![BTreeSet::new(); n];
    for i in 0..n {
        for j in (0..i).filter(|&j| !m[i][j].is_zero()) {
            coupled[i].insert(j);
            coupled[j].insert(i);
        }
    }
    let full: usize = (0..LARGEST_UNROLLED).map(sparse::pairs).sum();
    Order::of(coupled, n, full * n / LARGEST_UNROLLED)
}

/// The entries of two rows in the columns in which both have one.
fn common<'a, 'g>(
    a: &'a [(usize, Expr<'g>)],
    b: &'a [(usize, Expr<'g>)],
) -> impl Iterator<Item = (Expr<'g>, Expr<'g>)> + use<'a, 'g> {
    a.iter().filter_map(|(k, e)| Some((*e, b[b.binary_search_by_key(k, |(k, _)| *k).ok()?].1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Graph;

    /// A matrix with ones at these places of its lower triangle and on its diagonal.
    fn eliminated(n: usize, places: &[[usize; 2]]) -> Option<Order> {
        let graph = Graph::new();
        let entry = |i, j| graph.integer(i64::from(i == j || places.contains(&[i, j])));
        order(&(0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
    }

    #[test]
    fn a_full_matrix_is_eliminated_row_by_row_and_unrolled_up_to_its_limit() {
        for n in 1..=LARGEST_UNROLLED + 1 {
            let all: Vec<[usize; 2]> = (0..n).flat_map(|i| (0..i).map(move |j| [i, j])).collect();
            let found = eliminated(n, &all);
            assert_eq!(found.is_some(), n <= LARGEST_UNROLLED);
            let Some(found) = found else { continue };
            assert_eq!(found.unknowns, (0..n).collect::<Vec<_>>());
            assert!(found.rows.iter().enumerate().all(|(i, row)| *row == (0..i).collect::<Vec<_>>()));
        }
        assert!(eliminated(0, &[]).is_none());
    }

    /// A cart, the first coordinate, with pendulums: eliminated first it would couple all of them.
    #[test]
    fn leaves_of_a_tree_come_first_and_nothing_is_filled_in() {
        let n = 40;
        let arrow: Vec<[usize; 2]> = (1..n).map(|i| [i, 0]).collect();
        let found = eliminated(n, &arrow).unwrap();
        assert_eq!(found.unknowns[..n - 2], (1..n - 1).collect::<Vec<_>>());
        assert_eq!(found.rows.iter().map(Vec::len).sum::<usize>(), n - 1);
    }

    /// A square with its corners in a ring: whichever corner goes first couples its two neighbours.
    #[test]
    fn what_a_pivot_fills_in_is_counted() {
        let found = eliminated(4, &[[1, 0], [2, 1], [3, 2], [3, 0]]).unwrap();
        assert_eq!(found.unknowns, [0, 1, 2, 3]);
        assert_eq!(found.rows, [vec![], vec![0], vec![1], vec![0, 1, 2]]);
    }
}
