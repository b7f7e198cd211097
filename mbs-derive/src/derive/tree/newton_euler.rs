//! Newton–Euler: motions swept from the base to the tips, wrenches back.
//!
//! In the axes of each link, with ω, ω̇ and a the acceleration of its origin (the base accelerates against gravity) and
//! `U = [ω̇]× + [ω]×[ω]×`, so that a point at r accelerates by `a + U r`:
//!
//! ```text
//! f = m a + U h        n = vee(U Σ − (U Σ)ᵀ) + h × a        vee(W) = (W₃₂ − W₂₃, W₁₃ − W₃₁, W₂₁ − W₁₂)
//! ```
//!
//! Sources: Luh, Walker & Paul, *On-line computational scheme for mechanical manipulators*, 1980, for the recursion;
//! Khalil & Dombre, *Modeling, Identification and Control of Robots*, 2002, section 9.5, for U.

use crate::expr::{Expr, Matrix, Vector};
use crate::mistake::rule;

use super::inertia::{Inertia, Symmetric};
use super::linkage::{Accelerations, Edge, Linkage, rates};
use super::notation;
use super::place;
use super::wrench::{Wrench, turned_about};

/// How a link moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion<'g> {
    /// ω
    angular_velocity: Vector<'g>,
    /// ω̇
    angular_acceleration: Vector<'g>,
    /// a
    pub(super) acceleration: Vector<'g>,
    pub(super) spin: Spin<'g>,
}

/// What a turning frame does to its points; shared by links of one attitude.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spin<'g> {
    /// ω², by component.
    squares: [Expr<'g>; 3],
    /// U
    pub(super) matrix: Matrix<'g>,
}

impl<'g> Spin<'g> {
    fn of(w: Vector<'g>, wd: Vector<'g>) -> Self {
        let squares = w.0.map(|c| c.powi(2));
        let entry = |i: usize, j: usize| {
            let k = (6 - i - j) % 3;
            match (3 + j - i) % 3 {
                0 => -(squares[(i + 1) % 3] + squares[(i + 2) % 3]),
                1 => w.0[i] * w.0[j] - wd.0[k],
                _ => w.0[i] * w.0[j] + wd.0[k],
            }
        };
        Spin { squares, matrix: Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))) }
    }

    /// `U ê − ê U`, what U changes by if the axes turn about one of them, and the motion does not.
    pub(super) fn turned_back(&self, axis: usize) -> Matrix<'g> {
        let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
        let u = &self.matrix.0;
        let mut turned = Matrix([[self.squares[0].graph().integer(0); 3]; 3]);
        let (both, difference) = (u[i][j] + u[j][i], self.squares[j] - self.squares[i]);
        (turned.0[i][i], turned.0[j][j]) = (both, -both);
        (turned.0[i][j], turned.0[j][i]) = (difference, difference);
        (turned.0[i][k], turned.0[j][k]) = (u[j][k], -u[i][k]);
        (turned.0[k][i], turned.0[k][j]) = (u[k][j], -u[k][i]);
        turned
    }

    /// `vee(U Σ − (U Σ)ᵀ)`, with the differences of U's diagonal, `U₃₃ − U₂₂ = ω₃² − ω₂²` as differences of squares.
    fn couple(&self, second: &Symmetric<'g>) -> Vector<'g> {
        let u = &self.matrix.0;
        let component = |i: usize| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            // W_kj − W_jk of W = U Σ
            let outside = u[k][i] * second.entry(i, j) - u[j][i] * second.entry(i, k);
            let inside = u[k][j] * second.diagonal[j] - u[j][k] * second.diagonal[k];
            let centrifugal = (self.squares[k] - self.squares[j]) * second.entry(j, k);
            rule!("the centrifugal couple", outside + inside + centrifugal, outside + inside)
        };
        Vector([0, 1, 2].map(component))
    }
}

/// What it takes to move the links: swept back, it is `M q̈ + C q̇ + G` of the bodies.
///
/// Where accelerations are zero it is the bias.
pub(super) fn wrenches<'g>(
    linkage: &Linkage<'g>,
    inertias: &[Inertia<'g>],
    gravity: Vector<'g>,
    accelerations: Accelerations,
) -> Vec<Wrench<'g>> {
    let motions = motions(linkage, gravity, accelerations);
    let mut wrenches: Vec<Wrench<'g>> = inertias.iter().zip(&motions).map(|(i, m)| inertial(i, m)).collect();
    // Where others hang from a place, what they take is turned from link to link in any case.
    for links in linkage.places().into_iter().filter(|links| !linkage.bears_others(links)) {
        let arms: Vec<Vector<'g>> = links.iter().map(|&link| inertias[link].first).collect();
        let Some(first) = links.last() else { continue };
        let moments = place::moments(linkage, &links, &arms, motions[*first].acceleration);
        for (&link, moment) in links.iter().zip(moments.unwrap_or_default()) {
            wrenches[link] = spinning(&inertias[link], &motions[link]).plus(moment);
        }
    }
    wrenches.iter().zip(linkage.joints()).for_each(|(wrench, joint)| notation::wrench("i", joint, wrench));
    wrenches
}

/// What wrenches on the links do along the joints: swept back, each edge takes what is along it.
pub(super) fn joint_forces<'g>(linkage: &Linkage<'g>, mut wrenches: Vec<Wrench<'g>>) -> Vec<Option<Expr<'g>>> {
    let (mut forces, joints) = (vec![None; linkage.links.len()], linkage.joints());
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        notation::wrench("", joints[number], &wrenches[number]);
        forces[number] = wrenches[number].along(&edge);
        wrenches[parent] = wrenches[parent].plus(wrenches[number].across(&edge));
    }
    forces
}

pub(super) fn motions<'g>(linkage: &Linkage<'g>, gravity: Vector<'g>, accelerations: Accelerations) -> Vec<Motion<'g>> {
    let zero = Vector::zero(gravity.0[0].graph());
    let base = Motion {
        angular_velocity: zero,
        angular_acceleration: zero,
        acceleration: -gravity,
        spin: Spin::of(zero, zero),
    };
    let mut motions: Vec<Motion<'g>> = vec![base];
    for (link, joint) in linkage.links.iter().zip(linkage.joints()).skip(1) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { unreachable!("only the base has no parent") };
        let motion = motions[parent].beyond(&edge, accelerations);
        notation::vector("w", joint, motion.angular_velocity);
        notation::vector("wd", joint, motion.angular_acceleration);
        notation::vector("a", joint, motion.acceleration);
        notation::matrix("u", joint, &motion.spin.matrix);
        motions.push(motion);
    }
    motions
}

impl<'g> Motion<'g> {
    fn beyond(&self, edge: &Edge<'g>, accelerations: Accelerations) -> Self {
        let Motion { angular_velocity: w, angular_acceleration: wd, acceleration: a, spin } = *self;
        match *edge {
            Edge::Shift(t) => Motion { acceleration: a + spin.matrix * t, ..*self },
            Edge::Slide { direction, displacement } => {
                let (rate, acceleration) = rates(displacement, accelerations);
                let coriolis = w.cross(direction).scale(2 * rate);
                let carried = spin.matrix * direction.scale(displacement);
                Motion { acceleration: a + carried + coriolis + direction.scale(acceleration), ..*self }
            }
            Edge::Turn(r) => {
                let back = r.transpose();
                Self::turned(back * w, back * wd, back * a)
            }
            Edge::Tilt { axis, sin, cos } => {
                let [w, wd, a] = [w, wd, a].map(|v| turned_about(v, axis, -sin, cos));
                Self::turned(w, wd, a)
            }
            Edge::Revolute { axis, angle, sin, cos } => {
                let [w, wd, a] = [w, wd, a].map(|v| turned_about(v, axis, -sin, cos));
                let (rate, acceleration) = rates(angle, accelerations);
                let e = Vector::unit(rate.graph(), axis);
                let (spin, own) = (e.scale(rate), e.scale(acceleration));
                Self::turned(w + spin, wd + w.cross(spin) + own, a)
            }
        }
    }

    fn turned(angular_velocity: Vector<'g>, angular_acceleration: Vector<'g>, acceleration: Vector<'g>) -> Self {
        let spin = Spin::of(angular_velocity, angular_acceleration);
        Motion { angular_velocity, angular_acceleration, acceleration, spin }
    }
}

/// What it takes to move these masses so.
pub(super) fn inertial<'g>(inertia: &Inertia<'g>, motion: &Motion<'g>) -> Wrench<'g> {
    let Wrench { force, couple, .. } = spinning(inertia, motion);
    Wrench::new(force, couple + inertia.first.cross(motion.acceleration))
}

/// What it takes to move these masses so, but for the moment `h × a`.
fn spinning<'g>(inertia: &Inertia<'g>, motion: &Motion<'g>) -> Wrench<'g> {
    let Motion { acceleration: a, spin, .. } = motion;
    Wrench::new(a.scale(inertia.mass) + spin.matrix * inertia.first, spin.couple(&inertia.second))
}
