//! The structured route: bodies on a tree of frames, by Newton–Euler and composite bodies.
//!
//! Where a mechanism is declared by bodies on frames, its equations follow in a form that is shorter than what differentiation
//! of the energies gives:
//!
//! - [`linkage`]: the declared frames, reduced to what moves;
//! - [`inertia`]: pseudo-inertias, mass with its first and second moments;
//! - [`regroup`]: masses move towards the base as far as joints cannot tell;
//! - [`newton_euler`]: motions out, wrenches back: inverse dynamics, bias, gravity;
//! - [`composite`]: the mass matrix.
//!
//! What is no body is derived plainly and added.

mod composite;
pub(super) mod inertia;
pub(super) mod linkage;
mod newton_euler;
mod regroup;
mod wrench;

use crate::expr::{Expr, Symbol, Tangent, Vector};

use super::lagrange::{Lagrange, add, at_rest};
use super::lift::Lifted;
use super::{Rows, Symbols};
use inertia::Inertia;
use linkage::{Edge, Linkage};

/// Lagrange's equations of the bodies by sweeps over their tree, of everything else plainly; `rest` is the latter.
pub fn equations<'g>(lifted: &Lifted<'g>, plain: &Lagrange<'g>, rest: &Lagrange<'g>, symbols: &Symbols) -> Lagrange<'g> {
    let tree = Tree::new(lifted, symbols);
    let bias = add(&tree.forces(false), &rest.bias);
    Lagrange {
        mass_matrix: sum(&tree.mass_matrix(), &rest.mass_matrix),
        gravity: at_rest(&bias),
        inverse_dynamics: add(&tree.forces(true), &rest.inverse_dynamics),
        bias,
        ..plain.clone()
    }
}

/// The tree with its masses grouped, and how its joints follow the coordinates.
struct Tree<'g> {
    linkage: Linkage<'g>,
    inertias: Vec<Inertia<'g>>,
    gravity: Vector<'g>,
    /// The links behind a moving edge, in order.
    moving: Vec<usize>,
    /// `∂(displacement)/∂q`, a row per moving edge.
    slopes: Rows<'g>,
}

impl<'g> Tree<'g> {
    fn new(lifted: &Lifted<'g>, symbols: &Symbols) -> Self {
        let linkage = lifted.linkage.clone();
        let inertias = regroup::regrouped(&linkage, lifted.inertias.clone());
        let displacement = |link: usize| match linkage.links[link].edge {
            Some(Edge::Revolute { angle, .. }) => Some(angle),
            Some(Edge::Slide { displacement, .. }) => Some(displacement),
            Some(Edge::Turn(_) | Edge::Shift(_)) | None => None,
        };
        let moving: Vec<usize> = (0..linkage.links.len()).filter(|&link| displacement(link).is_some()).collect();
        let slopes = moving.iter().filter_map(|&link| displacement(link)).map(|d| slope(d, &symbols.q)).collect();
        Tree { linkage, inertias, gravity: lifted.gravity, moving, slopes }
    }

    /// `M q̈ + C q̇ + G` of the bodies.
    fn forces(&self, accelerated: bool) -> Vec<Expr<'g>> {
        let joint = newton_euler::joint_forces(&self.linkage, &self.inertias, self.gravity, accelerated);
        let joint: Vec<_> = self.moving.iter().filter_map(|&link| joint[link]).collect();
        self.on_coordinates(&joint)
    }

    /// M of the bodies.
    fn mass_matrix(&self) -> Rows<'g> {
        let composites = composite::composites(&self.linkage, &self.inertias);
        let m = composite::mass_matrix(&self.linkage, &self.moving, &composites);
        // Sᵀ M S
        let half: Rows<'g> = m.iter().map(|row| self.on_coordinates(row)).collect();
        let columns = super::lagrange::transpose(&half, self.slopes.first().map_or(0, Vec::len));
        columns.iter().map(|column| self.on_coordinates(column)).collect()
    }

    /// `Sᵀ f`: what forces along the joints are along the coordinates.
    fn on_coordinates(&self, forces: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let zero = self.gravity.0[0].graph().integer(0);
        let n = self.slopes.first().map_or(0, Vec::len);
        let on = |k: usize| forces.iter().zip(&self.slopes).fold(zero, |sum, (&f, slope)| sum + slope[k] * f);
        (0..n).map(on).collect()
    }
}

/// `∂e/∂q`
fn slope<'g>(e: Expr<'g>, q: &[Symbol]) -> Vec<Expr<'g>> {
    let one = e.graph().integer(1);
    q.iter().map(|&symbol| Tangent::new(|other| (other == symbol).then_some(one)).of(e)).collect()
}

fn sum<'g>(a: &Rows<'g>, b: &Rows<'g>) -> Rows<'g> {
    a.iter().zip(b).map(|(a, b)| add(a, b)).collect()
}
