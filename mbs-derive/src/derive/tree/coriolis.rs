//! C of the bodies, in Christoffel form, without a derivative of M.
//!
//! With `T_b` the pose of a body as a 4 × 4 matrix and `P_b = [Σ h; hᵀ m]` its pseudo-inertia, `C_ij = Σ_b tr(∂_i T_b
//! P_b (d∂_j T_b/dt)ᵀ)`. In the frame of a joint d, S its unit twist as a matrix `[ê 0; 0 0]` or `[0 d; 0 0]`, V the
//! twist of its link, P the composite body beyond it, and `Π = Σ_b (V_b − V) P_b = [A l; 0 0]`, what moves within that
//! body:
//!
//! ```text
//! C_ad = S_a · wrench([ω]× S P + S Π)                              for every joint a from d to the base
//! C_da = e_a · vee(S (V P + Π)ᵀ) + (ω_a × e_a) · n + (v_a × e_a) · f        with (f, n) the wrench of S P
//! ```
//!
//! where a wrench of `[X x; 0 0]` has the force x and the couple vee(X). Source: Echeandia & Wensing, *Numerical
//! methods to compute the Coriolis matrix and Christoffel symbols for rigid-body systems*, 2021, for the recursion by
//! joints; the pseudo-inertia form is derived above.

use crate::expr::{Expr, Matrix, Vector};
use crate::mistake::rule;

use super::super::Rows;
use super::composite::{momentum, on_joints};
use super::inertia::Inertia;
use super::linkage::{Edge, Linkage, rate};
use super::notation;
use super::twist::{Twist, twists};
use super::wrench::{Wrench, turned_about};

/// `Π = [A l; 0 0]`
#[derive(Clone, Copy, Debug)]
pub(super) struct Within<'g> {
    /// A
    pub(super) moments: Matrix<'g>,
    /// l
    pub(super) momentum: Vector<'g>,
}

/// C over the moving edges, in the order of `moving`; pairs on different branches are 0.
pub(super) fn coriolis_matrix<'g>(linkage: &Linkage<'g>, moving: &[usize], composites: &[Inertia<'g>]) -> Rows<'g> {
    let zero = composites[0].mass.graph().integer(0);
    let twists = twists(linkage, zero);
    let within = within(linkage, composites);
    let mut c = vec![vec![zero; moving.len()]; moving.len()];
    for (d, &joint) in moving.iter().enumerate() {
        let Some(edge) = linkage.links[joint].edge else { continue };
        let (body, inner, twist) = (&composites[joint], &within[joint], &twists[joint]);
        for (a, part) in on_joints(linkage, moving, joint, own_change(&edge, body, inner, twist)) {
            c[a][d] = part;
        }
        let others = others_change(linkage, moving, joint, (body, inner), &twists);
        for (a, part) in others {
            c[d][a] = part;
        }
    }
    c
}

/// Π beyond each edge, in the axes of the link behind it.
pub(super) fn within<'g>(linkage: &Linkage<'g>, composites: &[Inertia<'g>]) -> Vec<Within<'g>> {
    let zero = Vector::zero(composites[0].mass.graph());
    let nothing = Within { moments: Matrix([zero.0; 3]), momentum: zero };
    let mut within = vec![nothing; linkage.links.len()];
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        let moved = within[number].with_own_motion(&edge, &composites[number]).across(&edge);
        within[parent] = within[parent].plus(moved);
    }
    for (within, joint) in within.iter().zip(linkage.joints()) {
        notation::matrix("pc", joint, &within.moments);
        notation::vector("lc", joint, within.momentum);
    }
    within
}

impl<'g> Within<'g> {
    fn plus(self, other: Self) -> Self {
        Within { moments: self.moments + other.moments, momentum: self.momentum + other.momentum }
    }

    /// Seen from the parent the body moves with the edge, too: `Π + ṡ S P`.
    fn with_own_motion(self, edge: &Edge<'g>, body: &Inertia<'g>) -> Self {
        match *edge {
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => self,
            Edge::Revolute { axis, angle, .. } => {
                let rate = rate(angle);
                let turning = skew(Vector::unit(rate.graph(), axis).scale(rate));
                self.plus(Within { moments: turning * body.second.matrix(), momentum: turning * body.first })
            }
            Edge::Slide { direction, displacement } => {
                let rate = rate(displacement);
                let velocity = direction.scale(rate);
                self.plus(Within { moments: velocity.outer(body.first), momentum: velocity.scale(body.mass) })
            }
        }
    }

    fn across(self, edge: &Edge<'g>) -> Self {
        let Within { moments, momentum } = self;
        match *edge {
            Edge::Turn(r) => Within { moments: r * moments * r.transpose(), momentum: r * momentum },
            Edge::Shift(t) => Within { moments: moments + momentum.outer(t), momentum },
            Edge::Slide { direction, displacement } => {
                Within { moments: moments + momentum.outer(direction.scale(displacement)), momentum }
            }
            Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => self.turned_about(axis, sin, cos),
        }
    }

    fn turned_about(self, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Self {
        let moments = block_turned_about(self.moments, axis, s, c);
        Within { moments, momentum: turned_about(self.momentum, axis, s, c) }
    }
}

/// `R A Rᵀ` for the rotation by the angle with this sine and cosine about a coordinate axis.
///
/// In the plane of x and y, with `u = s (Axx − Ayy) + c (Axy + Ayx)`: `Axx − s u`, `Ayy + s u`, `c u − Ayx`, `c u −
/// Axy`.
fn block_turned_about<'g>(a: Matrix<'g>, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Matrix<'g> {
    let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
    let mut turned = a;
    let u = s * (a.0[i][i] - a.0[j][j]) + c * (a.0[i][j] + a.0[j][i]);
    turned.0[i][i] = a.0[i][i] - s * u;
    turned.0[j][j] = a.0[j][j] + s * u;
    turned.0[i][j] = c * u - a.0[j][i];
    turned.0[j][i] = c * u - a.0[i][j];
    turned.0[i][k] = c * a.0[i][k] - s * a.0[j][k];
    turned.0[j][k] = s * a.0[i][k] + c * a.0[j][k];
    turned.0[k][i] = c * a.0[k][i] - s * a.0[k][j];
    turned.0[k][j] = s * a.0[k][i] + c * a.0[k][j];
    turned
}

/// The wrench of `[ω]× S P + S Π`.
pub(super) fn own_change<'g>(
    edge: &Edge<'g>,
    body: &Inertia<'g>,
    within: &Within<'g>,
    twist: &Twist<'g>,
) -> Wrench<'g> {
    let w = twist.angular;
    let graph = body.mass.graph();
    match *edge {
        Edge::Revolute { axis, .. } => {
            let e = Vector::unit(graph, axis);
            // vee([ω]× ê Σ) = (Σ ω) × e, because [ω]× ê = e ωᵀ − (ω·e) 1 and Σ is symmetric.
            let own = (body.second.matrix() * w).cross(e);
            let couple = rule!("the motion within a composite", own + vee(skew(e) * within.moments), own);
            Wrench::new(w.cross(e.cross(body.first)) + e.cross(within.momentum), couple)
        }
        Edge::Slide { direction, .. } => {
            let carried = w.cross(direction);
            Wrench::new(carried.scale(body.mass), body.first.cross(carried))
        }
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => Wrench::zero(graph),
    }
}

/// `C_da` for every joint a from d, without d itself, to the base.
fn others_change<'g>(
    linkage: &Linkage<'g>,
    moving: &[usize],
    joint: usize,
    (body, within): (&Inertia<'g>, &Within<'g>),
    twists: &[Twist<'g>],
) -> Vec<(usize, Expr<'g>)> {
    let Some(own) = linkage.links[joint].edge else { return Vec::new() };
    let zero = Vector::zero(body.mass.graph());
    let mut wrench = momentum(body, &own);
    // A pure couple, which is the same about every point.
    let mut couple = Wrench::new(zero, moved_couple(&own, body, within, &twists[joint]));
    let (mut at, mut parts) = (joint, Vec::new());
    while let (Some(parent), Some(edge)) = (linkage.links[at].parent, linkage.links[at].edge) {
        if let (true, Ok(row)) = (at != joint, moving.binary_search(&at)) {
            parts.push((row, couple.along(&edge).map_or(zero.0[0], |c| c + turning_axis(&edge, &twists[at], &wrench))));
        }
        (at, wrench, couple) = (parent, wrench.across(&edge), couple.across(&edge));
    }
    parts
}

/// `vee(S (V P + Π)ᵀ)`
pub(super) fn moved_couple<'g>(
    edge: &Edge<'g>,
    body: &Inertia<'g>,
    within: &Within<'g>,
    twist: &Twist<'g>,
) -> Vector<'g> {
    let Twist { angular: w, linear: v } = *twist;
    match *edge {
        Edge::Revolute { axis, .. } => {
            let b = skew(w) * body.second.matrix() + v.outer(body.first) + within.moments;
            vee(skew(Vector::unit(body.mass.graph(), axis)) * b.transpose())
        }
        Edge::Slide { direction, .. } => {
            let b = w.cross(body.first) + v.scale(body.mass) + within.momentum;
            b.cross(direction)
        }
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => Vector::zero(body.mass.graph()),
    }
}

/// The work of a wrench on the change of an axis that is carried along: `(ω × e)·n + (v × e)·f`, of a slide `(ω ×
/// d)·f`.
fn turning_axis<'g>(edge: &Edge<'g>, twist: &Twist<'g>, wrench: &Wrench<'g>) -> Expr<'g> {
    let Twist { angular: w, linear: v } = *twist;
    let graph = w.0[0].graph();
    match *edge {
        Edge::Revolute { axis, .. } => {
            let e = Vector::unit(graph, axis);
            w.cross(e).dot(wrench.couple) + v.cross(e).dot(wrench.force)
        }
        Edge::Slide { direction, .. } => w.cross(direction).dot(wrench.force),
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => graph.integer(0),
    }
}

/// `[a]×`
pub(super) fn skew<'g>(a: Vector<'g>) -> Matrix<'g> {
    let ([x, y, z], zero) = (a.0, a.0[0].graph().integer(0));
    Matrix([[zero, -z, y], [z, zero, -x], [-y, x, zero]])
}

/// `(W₃₂ − W₂₃, W₁₃ − W₃₁, W₂₁ − W₁₂)`
pub(super) fn vee<'g>(w: Matrix<'g>) -> Vector<'g> {
    Vector([0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        w.0[k][j] - w.0[j][k]
    }))
}
