//! Lagrange's equations as a person would write them.

use crate::expr::{Expr, normal_form as expressions_in_normal_form};

use super::Rows;
use super::lagrange::Lagrange;

/// Mechanisms with more coordinates keep the graph's own form: theirs has more terms than anybody would write.
pub const MOST_COORDINATES: usize = 4;

/// Expressions with more terms on the way keep the graph's own form.
pub const MOST_TERMS: usize = 300;

/// The equations in multiple-angle normal form, each function that is short enough; `None` for larger mechanisms.
pub fn normal_form<'g>(plain: &Lagrange<'g>) -> Option<Lagrange<'g>> {
    if plain.momentum.len() > MOST_COORDINATES {
        return None;
    }
    let list = |expressions: &[Expr<'g>]| {
        expressions_in_normal_form(expressions, MOST_TERMS).unwrap_or_else(|| expressions.to_vec())
    };
    let one = |expression: Expr<'g>| list(&[expression])[0];
    let rows = |rows: &Rows<'g>| {
        let flat = list(&rows.concat());
        flat.chunks(rows[0].len()).map(<[_]>::to_vec).collect()
    };
    Some(Lagrange {
        kinetic_energy: one(plain.kinetic_energy),
        potential_energy: one(plain.potential_energy),
        momentum: list(&plain.momentum),
        mass_matrix: rows(&plain.mass_matrix),
        coriolis_matrix: rows(&plain.coriolis_matrix),
        gravity: list(&plain.gravity),
        bias: list(&plain.bias),
        dissipation_force: list(&plain.dissipation_force),
        generalized_force: list(&plain.generalized_force),
        inverse_dynamics: list(&plain.inverse_dynamics),
        position_gradient: list(&plain.position_gradient),
    })
}
