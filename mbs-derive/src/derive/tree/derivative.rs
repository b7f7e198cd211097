//! Derivatives of inverse dynamics by the displacements and rates of joints, from composite bodies.
//!
//! With `T_b` the pose of a body as a 4 × 4 matrix, `P_b` its pseudo-inertia, and in the frame of a joint its unit
//! twist S, the twist V of its link and `U = V̇ + V²`, by which points accelerate, `τ_a = Σ_b tr(∂_a T_b P_b T̈_bᵀ)`.
//! Since `∂_d T_b = S_d T_b`, and `∂_d T̈_b`, `∂T̈_b/∂ṡ_d` are the second rate of that and twice its rate,
//!
//! ```text
//! ∂τ_a/∂s_d = S_a · wrench((U S − S U) P + 2 Ṡ Π + S Q + Q Sᵀ)       for every joint a from d to the base
//! ∂τ_a/∂ṡ_d = S_a · wrench(2 [ω]× S P + 2 S Π)
//! ∂τ_d/∂s_a = S̈_a · (f, n) + Ṡ_a · (0, 2 vee(S (V P + Π)ᵀ))          for every other one
//! ∂τ_d/∂ṡ_a = S_a · (0, 2 vee(S (V P + Π)ᵀ)) + 2 Ṡ_a · (f, n)        with (f, n) the wrench of S P
//! ```
//!
//! where P and Π are those of the composite body beyond d (`coriolis.rs`), the wrench of Q is what moves all of it, so
//! that `S Q + Q Sᵀ` has the wrench `(e × f, e × n)` of a turn, `(0, d × f)` of a slide, and of a turn
//!
//! ```text
//! Ṡ = (ω × e, v × e)        S̈ = (U e, a × e + 2 v × (ω × e))        U S − S U = [U ê − ê U   a × e]
//! ```
//!
//! of a slide `Ṡ = (0, ω × d)`, `S̈ = (0, U d)`. Where all velocities have one more in common nothing changes; so what
//! the base slides along fixed directions is left out of v, and in the own frame of a joint v is 0. Derivatives by
//! rates are twice C where poses do not depend on t.
//!
//! Wrenches are carried towards the base from link to link, either in the axes of each link, or in those of the base:
//! these are turned once a link and not once a pair, which is cheaper for long chains.
//!
//! Sources: Carpentier & Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018; Singh, Russell &
//! Wensing, *Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra*, 2022, for the
//! recursion by joints; the pseudo-inertia form is derived above.

use crate::expr::normal::weight;
use crate::expr::{Expr, Graph, Matrix, Vector};
use crate::mistake::rule;

use super::super::Rows;
use super::composite::momentum;
use super::coriolis::{Within, moved_couple, own_change, skew, vee, within};
use super::inertia::Inertia;
use super::linkage::{Accelerations, Edge, Link, Linkage};
use super::newton_euler::{self, Motion};
use super::notation;
use super::twist::{self, Twist};
use super::wrench::Wrench;

/// `∂τ̂/∂s` and `∂τ̂/∂ṡ` over the moving edges, in the order of `moving`.
#[derive(Clone, Debug)]
pub(super) struct Slopes<'g> {
    pub(super) displacement: Rows<'g>,
    pub(super) rate: Rows<'g>,
}

/// Those of what it takes to move these masses, in the axes that are cheaper; pairs on different branches are 0.
pub(super) fn slopes<'g>(
    linkage: &Linkage<'g>,
    moving: &[usize],
    inertias: &[Inertia<'g>],
    composites: &[Inertia<'g>],
    gravity: Vector<'g>,
) -> Slopes<'g> {
    let joints = joints(linkage, moving, inertias, composites, gravity);
    let (of_links, of_base) = (in_axes_of_links(linkage, moving, &joints), in_axes_of_base(linkage, moving, &joints));
    if of_base.weight() < of_links.weight() { of_base } else { of_links }
}

fn in_axes_of_links<'g>(linkage: &Linkage<'g>, moving: &[usize], joints: &[Joint<'g>]) -> Slopes<'g> {
    let across = |link: usize, wrench: Wrench<'g>| match linkage.links[link].edge {
        Some(edge) => wrench.across(&edge),
        None => wrench,
    };
    over_pairs(linkage, moving, joints, across)
}

fn in_axes_of_base<'g>(linkage: &Linkage<'g>, moving: &[usize], joints: &[Joint<'g>]) -> Slopes<'g> {
    let axes = axes(linkage, joints[0].momentum.about_edge.graph());
    let turned: Vec<Joint<'g>> = joints.iter().zip(moving).map(|(joint, &link)| joint.turned(&axes[link])).collect();
    let shifts = shifts(linkage, &axes);
    over_pairs(linkage, moving, &turned, |link, wrench| shifts[link].map_or(wrench, |t| wrench.shifted(t)))
}

/// What a joint contributes, in some axes, about the origin of the link behind it.
#[derive(Clone, Copy, Debug)]
struct Joint<'g> {
    /// S
    motion: Twist<'g>,
    /// Ṡ
    rate: Twist<'g>,
    /// S̈
    acceleration: Twist<'g>,
    /// What the displacement changes of the wrench that moves all beyond it.
    by_displacement: Wrench<'g>,
    /// What the rate changes of it.
    by_rate: Wrench<'g>,
    /// The wrench of `S P`.
    momentum: Wrench<'g>,
    /// `2 vee(S (V P + Π)ᵀ)`
    couple: Vector<'g>,
}

/// Those of the moving edges, in the axes of the links.
fn joints<'g>(
    linkage: &Linkage<'g>,
    moving: &[usize],
    inertias: &[Inertia<'g>],
    composites: &[Inertia<'g>],
    gravity: Vector<'g>,
) -> Vec<Joint<'g>> {
    let motions = newton_euler::motions(linkage, gravity, Accelerations::Given);
    let within = within(linkage, composites);
    let twists = twist::twists_on_slides(linkage, gravity.0[0].graph().integer(0));
    let mut wrenches: Vec<Wrench<'g>> =
        inertias.iter().zip(&motions).map(|(inertia, motion)| newton_euler::inertial(inertia, motion)).collect();
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        wrenches[parent] = wrenches[parent].plus(wrenches[number].across(&edge));
    }
    let joint = |&link: &usize| {
        let beyond = Beyond {
            body: &composites[link],
            within: &within[link],
            twist: &twists[link],
            motion: &motions[link],
            wrench: &wrenches[link],
        };
        beyond.joint(&linkage.links[link].edge?)
    };
    let joints: Vec<Joint<'g>> = moving.iter().filter_map(joint).collect();
    for (joint, number) in joints.iter().zip(1..) {
        notation::wrench("q", number, &joint.by_displacement);
        notation::wrench("qd", number, &joint.by_rate);
    }
    joints
}

/// All that is beyond a joint, and how the link behind it moves.
struct Beyond<'a, 'g> {
    /// P
    body: &'a Inertia<'g>,
    /// Π
    within: &'a Within<'g>,
    /// V
    twist: &'a Twist<'g>,
    /// U and a
    motion: &'a Motion<'g>,
    /// What moves all of it.
    wrench: &'a Wrench<'g>,
}

impl<'g> Beyond<'_, 'g> {
    fn joint(&self, edge: &Edge<'g>) -> Option<Joint<'g>> {
        let Beyond { body, within, twist, .. } = *self;
        let graph = body.mass.graph();
        let (zero, two) = (Vector::zero(graph), graph.integer(2));
        let Twist { angular: w, linear: v } = *twist;
        let (u, a) = (self.motion.spin.matrix, self.motion.acceleration);
        let (motion, rate, acceleration, by_displacement) = match *edge {
            Edge::Revolute { axis, .. } => {
                let e = Vector::unit(graph, axis);
                let (turning, b) = (w.cross(e), a.cross(e));
                let swept = v.cross(turning).scale(two);
                let linear = rule!("the second rate of an axis", b + swept, b);
                let acceleration = Twist { angular: u * e, linear };
                let motion = Twist { angular: e, linear: zero };
                let rate = Twist { angular: turning, linear: v.cross(e) };
                (motion, rate, acceleration, self.turned(axis, turning, b))
            }
            Edge::Slide { direction, .. } => {
                let still = |linear: Vector<'g>| Twist { angular: zero, linear };
                let b = u * direction;
                let couple = body.first.cross(b) + direction.cross(self.wrench.force);
                let by_displacement = Wrench::new(b.scale(body.mass), couple);
                (still(direction), still(w.cross(direction)), still(b), by_displacement)
            }
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => return None,
        };
        Some(Joint {
            motion,
            rate,
            acceleration,
            by_displacement,
            by_rate: own_change(edge, body, within, twist).scale(two),
            momentum: momentum(body, edge),
            couple: moved_couple(edge, body, within, twist).scale(two),
        })
    }

    /// The wrench of `(U S − S U) P + 2 Ṡ Π + S Q + Q Sᵀ` of a turn, with `ω × e` and `a × e`.
    fn turned(&self, axis: usize, turning: Vector<'g>, b: Vector<'g>) -> Wrench<'g> {
        let Beyond { body, within, motion, wrench, .. } = *self;
        let graph = body.mass.graph();
        let (e, two) = (Vector::unit(graph, axis), graph.integer(2));
        let k = motion.spin.turned_back(axis);
        let carried =
            Wrench::new(k * body.first + b.scale(body.mass), vee(k * body.second.matrix()) + body.first.cross(b));
        let inner = Wrench::new(turning.cross(within.momentum), vee(skew(turning) * within.moments)).scale(two);
        let along = Wrench::new(e.cross(wrench.force), e.cross(wrench.couple));
        rule!("a wrench that turns along", carried.plus(inner).plus(along), carried.plus(inner))
    }
}

impl<'g> Joint<'g> {
    /// In the axes of a frame in which those of its link are turned so.
    fn turned(&self, r: &Matrix<'g>) -> Self {
        let twist = |twist: Twist<'g>| Twist { angular: *r * twist.angular, linear: *r * twist.linear };
        let wrench = |wrench: Wrench<'g>| Wrench::new(*r * wrench.force, *r * wrench.couple);
        Joint {
            motion: twist(self.motion),
            rate: twist(self.rate),
            acceleration: twist(self.acceleration),
            by_displacement: wrench(self.by_displacement),
            by_rate: wrench(self.by_rate),
            momentum: wrench(self.momentum),
            couple: *r * self.couple,
        }
    }
}

/// The axes of each link in those of the base.
fn axes<'g>(linkage: &Linkage<'g>, graph: &'g Graph) -> Vec<Matrix<'g>> {
    let mut axes = vec![Matrix::identity(graph)];
    for link in linkage.links.iter().skip(1) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { unreachable!("only the base has no parent") };
        // Rows of R turn as vectors of the parent do.
        axes.push(Matrix(axes[parent].0.map(|row| edge.turned_back(Vector(row)).0)));
    }
    axes
}

/// From the origin of the parent to that of each link, in the axes of the base; `None` where they are the same.
fn shifts<'g>(linkage: &Linkage<'g>, axes: &[Matrix<'g>]) -> Vec<Option<Vector<'g>>> {
    let shift = |(link, r): (&Link<'g>, &Matrix<'g>)| match link.edge? {
        Edge::Shift(t) => Some(*r * t),
        Edge::Slide { direction, displacement } => Some((*r * direction).scale(displacement)),
        Edge::Turn(_) | Edge::Tilt { .. } | Edge::Revolute { .. } => None,
    };
    linkage.links.iter().zip(axes).map(shift).collect()
}

/// Each joint with itself and those on its way to the base; `carried` takes the wrench of a link to its parent.
fn over_pairs<'g>(
    linkage: &Linkage<'g>,
    moving: &[usize],
    joints: &[Joint<'g>],
    carried: impl Fn(usize, Wrench<'g>) -> Wrench<'g>,
) -> Slopes<'g> {
    let zero = joints[0].momentum.about_edge.graph().integer(0);
    let zeros = || vec![vec![zero; moving.len()]; moving.len()];
    let mut slopes = Slopes { displacement: zeros(), rate: zeros() };
    for (d, own) in joints.iter().enumerate() {
        let (mut at, mut by) = (moving[d], [own.by_displacement, own.by_rate, own.momentum]);
        let mut couple = Wrench::new(Vector([zero; 3]), own.couple);
        while let Some(parent) = linkage.links[at].parent {
            if let Ok(a) = moving.binary_search(&at) {
                let other = &joints[a];
                let [by_displacement, by_rate, momentum] = &by;
                slopes.displacement[a][d] = work(by_displacement, &other.motion);
                slopes.rate[a][d] = work(by_rate, &other.motion);
                if a != d {
                    slopes.displacement[d][a] = work(momentum, &other.acceleration) + work(&couple, &other.rate);
                    let turning = work(momentum, &other.rate);
                    let twice = rule!("the derivative by a rate before", 2 * turning, turning);
                    slopes.rate[d][a] = work(&couple, &other.motion) + twice;
                }
            }
            by = by.map(|wrench| carried(at, wrench));
            (couple, at) = (carried(at, couple), parent);
        }
    }
    slopes
}

/// `n·ω + f·v`
fn work<'g>(wrench: &Wrench<'g>, twist: &Twist<'g>) -> Expr<'g> {
    wrench.couple.dot(twist.angular) + wrench.force.dot(twist.linear)
}

impl<'g> Slopes<'g> {
    fn weight(&self) -> usize {
        weight(&[self.displacement.concat(), self.rate.concat()].concat())
    }
}

#[cfg(test)]
mod tests {
    use super::super::composite;
    use super::super::trial::{body, joint, linkage};
    use super::*;
    use crate::expr::{Symbol, evaluate, gradient};

    /// Slides of the base, turns, a shift and slides, one of them skew, on two branches, one joint that follows time
    /// too: in both axes what reverse sweeps over Newton and Euler's equations find.
    #[test]
    fn slopes_are_the_derivatives_of_inverse_dynamics() {
        let graph = Graph::new();
        let coordinate = |i| graph.symbol(Symbol::Coordinate(i));
        let slide = |direction: [i64; 3], displacement| Edge::Slide {
            direction: Vector(direction.map(|c| graph.integer(c))),
            displacement,
        };
        let linkage = linkage(&[
            (0, slide([1, 0, 2], coordinate(0))),
            (1, joint(2, 1, &graph)),
            (2, Edge::Shift(Vector([1, 2, 3].map(|c| graph.integer(c))))),
            (3, Edge::revolute(0, coordinate(2) + graph.symbol(Symbol::Time).powi(2))),
            (4, slide([0, 2, 0], coordinate(3))),
            (5, joint(1, 4, &graph)),
            (3, slide([1, -1, 2], coordinate(5))),
            (7, joint(0, 6, &graph)),
        ]);
        let inertias: Vec<Inertia<'_>> =
            (0..9).map(|link| if link == 3 { Inertia::zero(&graph) } else { body(link, &graph) }).collect();
        let moving = [1, 2, 4, 5, 6, 7, 8];
        let gravity = Vector([1, -2, 9].map(|c| graph.integer(c)));
        let wrenches = newton_euler::wrenches(&linkage, &inertias, gravity, Accelerations::Given);
        let forces = newton_euler::joint_forces(&linkage, wrenches);
        let symbols: Vec<Symbol> = (0..7).map(Symbol::Coordinate).chain((0..7).map(Symbol::Velocity)).collect();
        let rows = moving.iter().map(|&link| gradient(forces[link].expect("it moves"), &symbols));
        let values = |expressions: &[Expr<'_>]| -> Vec<f64> {
            evaluate(expressions, |symbol| match symbol {
                Symbol::Coordinate(i) => 0.3 + 0.7 * f64::from(i),
                Symbol::Velocity(i) => 1.1 - 0.4 * f64::from(i),
                Symbol::Acceleration(i) => 0.2 * f64::from(i) - 0.5,
                Symbol::Time => 0.8,
                _ => unreachable!("nothing else moves"),
            })
        };
        let expected = values(&rows.collect::<Vec<_>>().concat());
        let composites = composite::composites(&linkage, &inertias);
        let joints = joints(&linkage, &moving, &inertias, &composites, gravity);
        for way in [in_axes_of_links, in_axes_of_base] {
            let Slopes { displacement, rate } = way(&linkage, &moving, &joints);
            let rows: Rows<'_> = displacement.iter().zip(&rate).map(|(q, qd)| [q.as_slice(), qd].concat()).collect();
            for (at, (found, expected)) in values(&rows.concat()).iter().zip(&expected).enumerate() {
                let size = expected.abs().max(1.0);
                assert!((found - expected).abs() <= 1e-10 * size, "{} {}: {found} {expected}", at / 14, at % 14);
            }
        }
    }
}
