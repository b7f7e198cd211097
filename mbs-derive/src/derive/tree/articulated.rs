//! Articulated bodies: accelerations by one sweep back and one out, at a cost that grows with the number of links.
//!
//! The links beyond a joint, their own joints free, resist an acceleration (α, a) of the first of them, in its axes and
//! about its origin, like one body whose inertia depends on the direction:
//!
//! ```text
//! f = M a + H α + p        n = Hᵀ a + J α + m
//! ```
//!
//! Here (α, a) is what the accelerations q̈ of the joints add to the motion with `q̈ = 0`, which is swept already, and
//! (p, m) the wrench that this motion takes, less the loads. A joint with the unit motion s takes the momentum
//! `U = (M, H, J) s`; with `D = s·U + I` and the force τ along it, I being what moves with the joint alone, such as the
//! rotor of its motor
//!
//! ```text
//! u = τ − s·(p, m)     q̈ = (u − U·(α, a))/D     (M, H, J)' = (M, H, J) − U Uᵀ/D     (p, m)' = (p, m) + U u/D
//! ```
//!
//! where primes are what the parent feels, and (α, a) is the parent's, carried to the link. The D are the pivots of
//! `M = L D Lᵀ` eliminated from the tips: positive where the mass matrix is.
//!
//! Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, section 7.3, with the accelerations of rest in p.

use crate::expr::{Expr, Matrix, Vector};
use crate::mistake::rule;

use super::inertia::{Inertia, Symmetric};
use super::linkage::{Edge, Linkage};
use super::notation;
use super::wrench::{Wrench, turned_about};

/// What acts along a joint, and what moves with it alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive<'g> {
    /// τ
    pub(super) force: Expr<'g>,
    /// I
    pub(super) inertia: Expr<'g>,
}

/// q̈ of each joint that is driven, from the wrenches that the links take at `q̈ = 0`.
pub(super) fn accelerations<'g>(
    linkage: &Linkage<'g>,
    inertias: &[Inertia<'g>],
    mut wrenches: Vec<Wrench<'g>>,
    drives: &[Option<Drive<'g>>],
) -> Vec<Option<Expr<'g>>> {
    let joints = linkage.joints();
    let mut bodies: Vec<Articulated<'g>> = inertias.iter().map(Articulated::of).collect();
    let mut freed: Vec<Option<Freed<'g>>> = vec![None; linkage.links.len()];
    // What no joint is beyond is a rigid body, and is called as elsewhere.
    let mut is_rigid = vec![true; linkage.links.len()];
    for (number, link) in linkage.links.iter().enumerate().rev() {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { continue };
        if !is_rigid[number] {
            bodies[number].note(joints[number]);
        }
        if let Some(drive) = drives[number] {
            let joint = Freed::of(&bodies[number], &wrenches[number], &edge, drive);
            joint.note(joints[number], is_rigid[number]);
            bodies[number] = bodies[number].beyond(&joint, &edge);
            wrenches[number] = joint.transmitted(wrenches[number], &edge);
            freed[number] = Some(joint);
            is_rigid[number] = false;
        }
        is_rigid[parent] &= is_rigid[number];
        bodies[parent] = bodies[parent].plus(&bodies[number].across(&edge));
        wrenches[parent] = wrenches[parent].plus(wrenches[number].across(&edge));
        notation::wrench("a", joints[parent], &wrenches[parent]);
    }
    let mut found = vec![None; linkage.links.len()];
    let zero = Vector::zero(inertias[0].mass.graph());
    let mut added = vec![Added { angular: zero, linear: zero }];
    for (number, link) in linkage.links.iter().enumerate().skip(1) {
        let (Some(parent), Some(edge)) = (link.parent, link.edge) else { unreachable!("only the base has no parent") };
        let mut motion = added[parent].carried(&edge);
        if let Some(joint) = &freed[number] {
            let acceleration = joint.acceleration(&motion);
            motion = motion.plus_along(&edge, acceleration);
            found[number] = Some(acceleration);
        }
        notation::vector("wda", joints[number], motion.angular);
        notation::vector("aa", joints[number], motion.linear);
        added.push(motion);
    }
    found
}

/// How the links beyond a joint resist, their own joints free.
#[derive(Clone, Copy, Debug)]
struct Articulated<'g> {
    /// M
    mass: Symmetric<'g>,
    /// H
    coupling: Matrix<'g>,
    /// J
    moment: Symmetric<'g>,
}

impl<'g> Articulated<'g> {
    /// One rigid body: `M = m 1`, `H = −[h]×`, `J = tr(Σ) 1 − Σ`.
    fn of(inertia: &Inertia<'g>) -> Self {
        let zero = inertia.mass.graph().integer(0);
        let [x, y, z] = inertia.first.0;
        Articulated {
            mass: Symmetric { diagonal: [inertia.mass; 3], products: [zero; 3] },
            coupling: Matrix([[zero, z, -y], [-z, zero, x], [y, -x, zero]]),
            moment: Symmetric {
                diagonal: [0, 1, 2].map(|i| inertia.axial(i)),
                products: inertia.second.products.map(|e| -e),
            },
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Articulated {
            mass: self.mass.plus(other.mass),
            coupling: self.coupling + other.coupling,
            moment: self.moment.plus(other.moment),
        }
    }

    /// `U = (M, H, J) s` for the unit motion of the edge.
    fn momentum(&self, edge: &Edge<'g>) -> Wrench<'g> {
        match *edge {
            Edge::Revolute { axis, .. } => {
                let column = |m: &Matrix<'g>| Vector([0, 1, 2].map(|i| m.0[i][axis]));
                Wrench::new(column(&self.coupling), column(&self.moment.matrix()))
            }
            Edge::Slide { direction, .. } => {
                Wrench::new(self.mass.matrix() * direction, self.coupling.transpose() * direction)
            }
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => Wrench::zero(self.mass.diagonal[0].graph()),
        }
    }

    /// `(M, H, J) − U Uᵀ/D`: what the parent feels of it.
    ///
    /// What moves along a joint that has no inertia of its own is not felt at all: entries that are zero for that
    /// reason are not computed.
    fn beyond(&self, joint: &Freed<'g>, edge: &Edge<'g>) -> Self {
        let ([f, n], [f_d, n_d]) = (joint.momentum, joint.per_unit);
        let zero = self.mass.diagonal[0].graph().integer(0);
        let (turn, slide) = match *edge {
            _ if !joint.is_bare() => (None, None),
            Edge::Revolute { axis, .. } => (Some(axis), None),
            _ => (None, edge.slides_along()),
        };
        let left = |old: Expr<'g>, a: Expr<'g>, b: Expr<'g>| rule!("what a free joint transmits", old - a * b, old);
        Articulated {
            mass: Symmetric::from_fn(|i, j| match Some(i) == slide || Some(j) == slide {
                true => zero,
                false => left(self.mass.entry(i, j), f.0[i], f_d.0[j]),
            }),
            coupling: Matrix([0, 1, 2].map(|i| {
                [0, 1, 2].map(|j| match Some(i) == slide || Some(j) == turn {
                    true => zero,
                    false => left(self.coupling.0[i][j], f.0[i], n_d.0[j]),
                })
            })),
            moment: Symmetric::from_fn(|i, j| match Some(i) == turn || Some(j) == turn {
                true => zero,
                false => left(self.moment.entry(i, j), n.0[i], n_d.0[j]),
            }),
        }
    }

    /// About the parent's origin, in its axes.
    fn across(&self, edge: &Edge<'g>) -> Self {
        match *edge {
            Edge::Turn(r) => Articulated {
                mass: self.mass.turned(r),
                coupling: r * self.coupling * r.transpose(),
                moment: self.moment.turned(r),
            },
            Edge::Revolute { axis, sin, cos, .. } | Edge::Tilt { axis, sin, cos } => Articulated {
                mass: self.mass.turned_about(axis, sin, cos),
                coupling: matrix_turned_about(&self.coupling, axis, sin, cos),
                moment: self.moment.turned_about(axis, sin, cos),
            },
            Edge::Shift(t) => self.shifted(t),
            Edge::Slide { direction, displacement } => self.shifted(direction.scale(displacement)),
        }
    }

    /// `H' = H − M [t]×`, `J' = J + [t]× H' + ([t]× H)ᵀ`: the parent's origin accelerates by `a − α × t`.
    fn shifted(&self, t: Vector<'g>) -> Self {
        let mass = self.mass.matrix();
        // A row of M [t]× is the row of M times t.
        let rows = [0, 1, 2].map(|i| Vector(self.coupling.0[i]) - Vector(mass.0[i]).cross(t));
        let coupling = Matrix(rows.map(|row| row.0));
        let column = |m: &Matrix<'g>, j: usize| Vector([0, 1, 2].map(|i| m.0[i][j]));
        let moment = Symmetric::from_fn(|i, j| match i == j {
            true => {
                let both = column(&coupling, i) + column(&self.coupling, i);
                self.moment.diagonal[i] + t.cross(both).0[i]
            }
            false => {
                let [own, other] = [t.cross(column(&coupling, j)).0[i], t.cross(column(&self.coupling, i)).0[j]];
                self.moment.entry(i, j) + (own + other)
            }
        });
        Articulated { coupling, moment, ..*self }
    }

    fn note(&self, joint: usize) {
        notation::matrix("ma", joint, &self.mass.matrix());
        notation::matrix("ha", joint, &self.coupling);
        notation::matrix("ja", joint, &self.moment.matrix());
    }
}

/// A joint that is free to move.
#[derive(Clone, Copy, Debug)]
struct Freed<'g> {
    drive: Drive<'g>,
    /// U, force and couple.
    momentum: [Vector<'g>; 2],
    /// `U/D`
    per_unit: [Vector<'g>; 2],
    /// u
    force: Expr<'g>,
    /// `u/D`
    own: Expr<'g>,
}

impl<'g> Freed<'g> {
    fn of(body: &Articulated<'g>, wrench: &Wrench<'g>, edge: &Edge<'g>, drive: Drive<'g>) -> Self {
        let momentum = body.momentum(edge);
        let graph = drive.force.graph();
        let zero = graph.integer(0);
        let along = |wrench: &Wrench<'g>| wrench.along(edge).unwrap_or(zero);
        let reciprocal = (along(&momentum) + drive.inertia).powi(-1);
        let momentum = [momentum.force, momentum.couple];
        let per_unit = momentum.map(|part| part.scale(reciprocal));
        let force = drive.force - along(wrench);
        let mut freed = Freed { drive, momentum, per_unit, force, own: force * reciprocal };
        if let Edge::Revolute { axis, .. } = *edge
            && freed.is_bare()
        {
            freed.per_unit[1].0[axis] = graph.integer(1);
        }
        freed
    }

    /// Whether nothing moves with the joint alone.
    fn is_bare(&self) -> bool {
        self.drive.inertia.is_zero()
    }

    /// `(p, m) + U u/D`; along a joint that has no inertia of its own that is the force that drives it.
    fn transmitted(&self, wrench: Wrench<'g>, edge: &Edge<'g>) -> Wrench<'g> {
        let [f, n] = self.momentum.map(|part| part.scale(self.own));
        let mut transmitted = wrench.plus(Wrench::new(f, n));
        if let Edge::Revolute { axis, .. } = *edge
            && self.is_bare()
        {
            transmitted.couple.0[axis] = self.drive.force - wrench.about_edge;
        }
        transmitted
    }

    /// `(u − U·(α, a))/D`
    fn acceleration(&self, motion: &Added<'g>) -> Expr<'g> {
        let [f, n] = self.per_unit;
        self.own - (f.dot(motion.linear) + n.dot(motion.angular))
    }

    fn note(&self, joint: usize, is_rigid: bool) {
        let [f, n] = self.momentum;
        if !is_rigid {
            notation::vector("fu", joint, f);
            notation::vector("nu", joint, n);
        }
        let [f, n] = self.per_unit;
        notation::vector("fd", joint, f);
        notation::vector("nd", joint, n);
        notation::scalar("tu", joint, self.force);
        notation::scalar("td", joint, self.own);
    }
}

/// What the accelerations of the joints add to the motion of a link with `q̈ = 0`.
#[derive(Clone, Copy, Debug)]
struct Added<'g> {
    /// α
    angular: Vector<'g>,
    /// a
    linear: Vector<'g>,
}

impl<'g> Added<'g> {
    /// To the link behind an edge that stands still.
    fn carried(&self, edge: &Edge<'g>) -> Self {
        let Added { angular, linear } = *self;
        let shifted = |t: Vector<'g>| Added { angular, linear: linear + angular.cross(t) };
        match *edge {
            Edge::Shift(t) => shifted(t),
            Edge::Slide { direction, displacement } => shifted(direction.scale(displacement)),
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Revolute { .. } => {
                Added { angular: edge.turned_back(angular), linear: edge.turned_back(linear) }
            }
        }
    }

    fn plus_along(mut self, edge: &Edge<'g>, acceleration: Expr<'g>) -> Self {
        match *edge {
            Edge::Revolute { axis, .. } => self.angular.0[axis] = self.angular.0[axis] + acceleration,
            Edge::Slide { direction, .. } => self.linear = self.linear + direction.scale(acceleration),
            Edge::Turn(_) | Edge::Tilt { .. } | Edge::Shift(_) => {}
        }
        self
    }
}

/// `R A Rᵀ` for the rotation by an angle with this sine and cosine about a coordinate axis.
///
/// In the plane of x and y, with `u = s (Axx − Ayy) + c (Axy + Ayx)`: `Axx − s u`, `c u − Ayx`, `c u − Axy`,
/// `Ayy + s u`: what is skew stays.
fn matrix_turned_about<'g>(a: &Matrix<'g>, axis: usize, s: Expr<'g>, c: Expr<'g>) -> Matrix<'g> {
    let (i, j, k) = ((axis + 1) % 3, (axis + 2) % 3, axis);
    let a = &a.0;
    let u = s * (a[i][i] - a[j][j]) + c * (a[i][j] + a[j][i]);
    let mut turned = *a;
    turned[i][i] = a[i][i] - s * u;
    turned[j][j] = a[j][j] + s * u;
    turned[i][j] = c * u - a[j][i];
    turned[j][i] = c * u - a[i][j];
    // The column and the row of the axis turn as vectors do.
    let column = turned_about(Vector([a[0][k], a[1][k], a[2][k]]), axis, s, c);
    let row = turned_about(Vector(a[k]), axis, s, c);
    for m in [i, j] {
        turned[m][k] = column.0[m];
        turned[k][m] = row.0[m];
    }
    Matrix(turned)
}

#[cfg(test)]
mod tests {
    use super::super::composite;
    use super::super::trial::{body, joint, linkage, value};
    use super::*;
    use crate::expr::{Graph, Symbol};

    /// Turns, a shift and slides, one of them skew, on two branches, some of which have an inertia of their own: `M q̈`
    /// with M by composite bodies is the force less what the wrenches do along the joints.
    #[test]
    fn accelerations_solve_the_equations_with_the_mass_matrix() {
        let graph = Graph::new();
        let slide = |direction: [i64; 3], coordinate| Edge::Slide {
            direction: Vector(direction.map(|c| graph.integer(c))),
            displacement: graph.symbol(Symbol::Coordinate(coordinate)),
        };
        let linkage = linkage(&[
            (0, joint(2, 0, &graph)),
            (1, Edge::Shift(Vector([1, 2, 3].map(|c| graph.integer(c))))),
            (2, joint(0, 1, &graph)),
            (3, slide([0, 2, 0], 2)),
            (2, slide([1, -1, 2], 3)),
            (5, joint(1, 4, &graph)),
        ]);
        let inertias: Vec<Inertia<'_>> = (0..7)
            .map(|link| if [0, 2].contains(&link) { Inertia::zero(&graph) } else { heavy(body(link, &graph)) })
            .collect();
        let wrenches: Vec<Wrench<'_>> = (0..7)
            .map(|link| {
                let part = |i: i64| Vector([1, 2, 3].map(|c| graph.integer(7 * link - 5 * i * c)));
                Wrench::new(part(1), part(2))
            })
            .collect();
        let moving = [1, 3, 4, 5, 6];
        let own = |link: usize| [0, 30, 0, 0, 50, 70, 0][link];
        let mut drives = vec![None; 7];
        for link in moving {
            let [force, inertia] = [100 * link as i64, own(link)].map(|number| graph.integer(number));
            drives[link] = Some(Drive { force, inertia });
        }

        let found = accelerations(&linkage, &inertias, wrenches.clone(), &drives);
        let found: Vec<f64> = moving.iter().map(|&link| value(found[link].expect("it moves"))).collect();
        let taken = super::super::newton_euler::joint_forces(&linkage, wrenches);
        let composites = composite::composites(&linkage, &inertias);
        let mass_matrix = composite::mass_matrix(&linkage, &moving, &composites);
        for ((row, &link), alone) in mass_matrix.iter().zip(&moving).zip(&found) {
            let inertial = row.iter().zip(&found).map(|(entry, acceleration)| value(*entry) * acceleration);
            let inertial = inertial.sum::<f64>() + own(link) as f64 * alone;
            let expected = 100.0 * link as f64 - value(taken[link].expect("it moves"));
            assert!((inertial - expected).abs() <= 1e-9 * expected.abs(), "{inertial} {expected}");
        }
    }

    /// With second moments that a body can have.
    fn heavy(inertia: Inertia<'_>) -> Inertia<'_> {
        let graph = inertia.mass.graph();
        let added = Symmetric { diagonal: [graph.integer(100); 3], products: [graph.integer(0); 3] };
        Inertia { second: inertia.second.plus(added), ..inertia }
    }

    #[test]
    fn matrices_turn_as_by_full_rotations() {
        let graph = Graph::new();
        let symbol = |i| graph.symbol(Symbol::Coordinate(i));
        let a = Matrix([[0, 1, 2], [3, 4, 5], [6, 7, 8]].map(|row| row.map(symbol)));
        for axis in 0..3 {
            let turned = matrix_turned_about(&a, axis, symbol(9).sin(), symbol(9).cos());
            let r = Matrix::rotation(Vector::unit(&graph, axis), symbol(9));
            let expected = r * a * r.transpose();
            for (found, expected) in turned.0.as_flattened().iter().zip(expected.0.as_flattened()) {
                assert!((value(*found) - value(*expected)).abs() < 1e-12, "{axis}");
            }
        }
    }
}
