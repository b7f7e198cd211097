//! Lagrange's equations as a person would write them, and solved as a person would solve them.

use crate::equations::{Factorization, ForwardDynamics, Step};
use crate::expr::normal::weight;
use crate::expr::{Expr, Kept, cheapest_form, quotients};

use super::lagrange::{add, sub};
use super::solve;
use super::{Constraints, Lagrange, Rows};

/// Mechanisms with more coordinates keep the graph's own form: theirs has more terms than anybody would write.
pub(crate) const MOST_COORDINATES: usize = 4;

/// Expressions with more terms on the way keep the graph's own form.
pub(crate) const MOST_TERMS: usize = 300;

/// How equations are written.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form<'k> {
    /// As the sweeps give them.
    AsDerived,
    /// As in a textbook, where that is not too long, but for sums that stay factors.
    Textbook(&'k Kept),
}

impl Form<'_> {
    /// Expressions that are computed together, in this form.
    pub(crate) fn list<'g>(self, expressions: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let form = match self {
            Form::AsDerived => None,
            Form::Textbook(kept) => cheapest_form(expressions, kept, MOST_TERMS),
        };
        form.unwrap_or_else(|| expressions.to_vec())
    }

    /// Rows of expressions that are computed together, in this form.
    pub(crate) fn rows<'g>(self, rows: &Rows<'g>) -> Rows<'g> {
        let mut flat = self.list(&rows.concat()).into_iter();
        rows.iter().map(|row| flat.by_ref().take(row.len()).collect()).collect()
    }

    /// Accelerations, found in this form.
    pub(crate) fn forward_dynamics<'g>(
        self,
        lagrange: &Lagrange<'g>,
        constraints: &Constraints<'g>,
    ) -> ForwardDynamics<'g> {
        let forward = solve::forward_dynamics(lagrange, constraints);
        match self {
            Form::AsDerived => forward,
            Form::Textbook(kept) => forward_dynamics(forward, kept),
        }
    }
}

/// The equations in the form of a textbook, each function that is short enough; `None` for mechanisms with more
/// coordinates, or with a longer kinetic energy, than anybody writes out.
pub(crate) fn normal_form<'g>(plain: &Lagrange<'g>, kept: &Kept) -> Option<Lagrange<'g>> {
    if plain.momentum.len() > MOST_COORDINATES {
        return None;
    }
    let kinetic_energy = cheapest_form(&[plain.kinetic_energy], kept, MOST_TERMS)?[0];
    let list = |expressions: &[Expr<'g>]| Form::Textbook(kept).list(expressions);
    let one = |expression: Expr<'g>| list(&[expression])[0];
    let [bias, dissipation_force, generalized_force, inverse_dynamics] =
        [&plain.bias, &plain.dissipation_force, &plain.generalized_force, &plain.inverse_dynamics].map(|e| list(e));
    Some(Lagrange {
        kinetic_energy,
        potential_energy: one(plain.potential_energy),
        momentum: list(&plain.momentum),
        mass_matrix: Form::Textbook(kept).rows(&plain.mass_matrix),
        coriolis_matrix: Form::Textbook(kept).rows(&plain.coriolis_matrix),
        gravity: list(&plain.gravity),
        residual: sub(&inverse_dynamics, &generalized_force),
        free_force: sub(&generalized_force, &add(&bias, &dissipation_force)),
        bias,
        dissipation_force,
        generalized_force,
        inverse_dynamics,
        position_gradient: list(&plain.position_gradient),
        accelerations: None,
        slopes: None,
    })
}

/// Forward dynamics, unrolled the cheapest way: by `L D Lᵀ` as it stands, or by elimination in the form of a textbook.
fn forward_dynamics<'g>(forward: ForwardDynamics<'g>, kept: &Kept) -> ForwardDynamics<'g> {
    let (Some(factorization), Some(unrolled)) = (forward.factorization.clone(), forward.unrolled.clone()) else {
        return forward;
    };
    let right_side = Form::Textbook(kept).list(&forward.right_side);
    let mut ways = vec![(factorization, unrolled)];
    for last_first in [false, true] {
        let Some((factorization, pivots)) = eliminate(forward.mass_matrix.clone(), kept, last_first) else { continue };
        ways.push((factorization.clone(), factorization.solve(&right_side)));
        let reduced = factorization.reduce(&right_side);
        let pairs: Vec<_> = reduced.into_iter().zip(pivots).collect();
        if let Some(scaled) = quotients(&pairs, kept, MOST_TERMS) {
            let solution = factorization.substitute_back(scaled);
            ways.push((factorization, solution));
        }
    }
    // Of equally cheap ones the first.
    let cheapest = ways.into_iter().min_by_key(|(_, solution)| weight(solution));
    let (factorization, unrolled) = cheapest.unzip();
    ForwardDynamics { factorization, unrolled, ..forward }
}

/// `L D Lᵀ` of a symmetric matrix and D, simple pivots first, with every step brought into the form of a textbook: what
/// is left of M shows `i1 sin²θ` where the rest cancels. `None` where a step has too many terms.
fn eliminate<'g>(mut m: Rows<'g>, kept: &Kept, last_first: bool) -> Option<(Factorization<'g>, Vec<Expr<'g>>)> {
    let mut remaining: Vec<usize> = (0..m.len()).collect();
    let mut steps = Vec::new();
    while let Some(pivot) = simplest_pivot(&m, &remaining, last_first) {
        remaining.retain(|&other| other != pivot);
        let coupled: Vec<usize> = remaining.iter().copied().filter(|&i| !m[i][pivot].is_zero()).collect();
        let pairs: Vec<_> = coupled.iter().map(|&i| (m[i][pivot], m[pivot][pivot])).collect();
        let column: Vec<_> = coupled.iter().copied().zip(quotients(&pairs, kept, MOST_TERMS)?).collect();
        for &(i, factor) in &column {
            for &j in &coupled {
                m[i][j] = cheapest_form(&[m[i][j] - factor * m[pivot][j]], kept, MOST_TERMS)?[0];
            }
        }
        steps.push(Step { pivot, column, reciprocal: m[pivot][pivot].powi(-1) });
    }
    let pivots = (0..m.len()).map(|i| m[i][i]).collect();
    Some((Factorization { steps }, pivots))
}

/// Of equally simple ones the first, or the last.
fn simplest_pivot(m: &Rows<'_>, remaining: &[usize], last_first: bool) -> Option<usize> {
    let pivots = remaining.iter().copied();
    let key = |&i: &usize| weight(&[m[i][i]]);
    if last_first { pivots.rev().min_by_key(key) } else { pivots.min_by_key(key) }
}
