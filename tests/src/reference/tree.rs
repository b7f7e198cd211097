//! Trees of rigid bodies with hinges, slides, ball joints, prescribed motions and coupled joints, five ways:
//!
//! - inverse dynamics by Newton–Euler, with 3-vectors in world axes ([`Tree::newton_euler`]);
//! - mass matrix by composite rigid bodies, with spatial vectors in the axes of the bodies
//!   ([`Tree::composite_bodies`]);
//! - accelerations by articulated bodies, where every joint has coordinates of its own ([`Tree::articulated_bodies`]);
//! - mass matrix by Jacobians of the mass centres, over any [`Number`] ([`Tree::jacobian_mass_matrix`]);
//! - Coriolis matrix by Christoffel symbols, from the derivatives of the latter by dual numbers
//!   ([`Tree::coriolis_matrix`]).
//!
//! A tree moves with `x`: the coordinates `q`, then the signals that prescribe the rest of its motion. A joint's
//! variable is a function of `x` ([`Law`]), its rates are `ν = N(x) ẋ`, and `ν̇ = N ẍ + Ṅ ẋ`; of a ball joint `ν = 2
//! vec(q̄ q̇)`, and `Ṅ ẋ = 2 vec(q̄̇ q̇) = 0`. Each algorithm works with ν, and N takes its results to `x`.

use super::lagrange::{Dual, Number};
use super::rigid_body::{blocks, spatial};
use nalgebra::{DMatrix, DVector, Matrix3, Matrix6, Rotation3, Unit, Vector3, Vector6};
use std::array::from_fn;

mod articulated;
mod geometry;

use geometry::{add, ball_rates, cross, dot, into, product, quaternion_rotation, sub, times, turn, unit};

/// What a hinge's angle or a slide's displacement is of the tree's variables: `z + bend · z²` with
/// `z = offset + Σ ratio · x[number]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// z where all variables are zero.
    pub offset: f64,
    /// Number and ratio of each variable it depends on; no number twice.
    pub terms: Vec<(usize, f64)>,
    /// Zero for what depends on its variables linearly.
    pub bend: f64,
}

impl Law {
    /// The variable itself.
    pub fn of(number: usize) -> Self {
        Self::sum(&[(number, 1.0)])
    }

    /// `Σ ratio · x[number]`
    pub fn sum(terms: &[(usize, f64)]) -> Self {
        Law { offset: 0.0, terms: terms.to_vec(), bend: 0.0 }
    }

    fn at<S: Number>(&self, x: &[S]) -> S {
        let z = self.argument(x);
        z + z * z * self.bend
    }

    fn argument<S: Number>(&self, x: &[S]) -> S {
        self.terms.iter().fold(S::constant(self.offset), |sum, &(k, ratio)| sum + x[k] * ratio)
    }

    /// Derivative by each of its variables: `(1 + 2 bend z) ratio`.
    fn slopes<S: Number>(&self, x: &[S]) -> Vec<(usize, S)> {
        let slope = S::constant(1.0) + self.argument(x) * (2.0 * self.bend);
        self.terms.iter().map(|&(k, ratio)| (k, slope * ratio)).collect()
    }

    /// Its second time derivative while `ẍ = 0`: `2 bend ż²`.
    fn curvature(&self, xd: &[f64]) -> f64 {
        let rate: f64 = self.terms.iter().map(|&(k, ratio)| ratio * xd[k]).sum();
        2.0 * self.bend * rate * rate
    }
}

/// How a frame moves, beyond its constant [`Place`].
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Not at all.
    Fixed,
    /// About an axis, by an angle.
    Turn([f64; 3], Law),
    /// Along an axis of length 1, by a displacement.
    Slide([f64; 3], Law),
    /// As the unit quaternion `x[first..first + 4]` says, scalar part first.
    Ball {
        /// Number of the scalar part.
        first: usize,
    },
}

/// A constant shift, then a constant turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// In the axes before.
    pub shift: [f64; 3],
    /// About this axis, which need not have length 1.
    pub axis: [f64; 3],
    /// By this angle.
    pub angle: f64,
}

impl Place {
    /// Here.
    pub const HERE: Place = Place::at([0.0; 3]);

    /// A shift alone.
    pub const fn at(shift: [f64; 3]) -> Self {
        Place { shift, axis: [0.0, 0.0, 1.0], angle: 0.0 }
    }
}

/// A mass, its centre, and `[xx, yy, zz, xy, xz, yz]` of the inertia tensor about the centre, in the axes of its frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// In kg.
    pub mass: f64,
    /// In m.
    pub center: [f64; 3],
    /// In kg·m².
    pub inertia: [f64; 6],
}

/// A frame, and the body that is fixed in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The frame that it is attached to, an earlier one; the world where there is none.
    pub parent: Option<usize>,
    /// Where it is in its parent while its joint is at zero.
    pub place: Place,
    /// Its joint.
    pub motion: Motion,
    /// Its body.
    pub body: Option<Body>,
}

/// A forest of frames on the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// Number of coordinates; the variables beyond are prescribed.
    pub coordinates: usize,
    /// Number of prescribed variables.
    pub signals: usize,
    /// Parents come before children.
    pub nodes: Vec<Node>,
    /// In world axes, in m/s².
    pub gravity: [f64; 3],
    /// Inertia of the drive of each coordinate; missing ones are zero.
    pub drives: Vec<f64>,
}

/// Axes (columns of `rotation`) and origin of a frame, in world axes.
#[derive(Clone, Copy, Debug)]
struct Frame<S> {
    rotation: [[S; 3]; 3],
    position: [S; 3],
}

impl Frame<f64> {
    fn axes(&self) -> Matrix3<f64> {
        Matrix3::from_fn(|i, j| self.rotation[i][j])
    }

    fn origin(&self) -> Vector3<f64> {
        Vector3::from(self.position)
    }
}

/// `ω`, `ω̇` and `p̈` of a frame, in world axes.
#[derive(Clone, Copy, Default)]
struct Moving {
    omega: Vector3<f64>,
    alpha: Vector3<f64>,
    acceleration: Vector3<f64>,
}

impl Moving {
    /// `p̈ + ω̇ × r + ω × (ω × r)`
    fn acceleration_at(&self, r: &Vector3<f64>) -> Vector3<f64> {
        self.acceleration + self.alpha.cross(r) + self.omega.cross(&self.omega.cross(r))
    }

    /// Force on a body, and moment about the frame's origin, that make it move so.
    fn wrench(&self, body: &Body, axes: &Matrix3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (c, tensor) = (axes * Vector3::from(body.center), axes * body.tensor() * axes.transpose());
        let force = body.mass * self.acceleration_at(&c);
        (force, c.cross(&force) + tensor * self.alpha + self.omega.cross(&(tensor * self.omega)))
    }
}

impl Body {
    fn tensor(&self) -> Matrix3<f64> {
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// `I = [I_C + m c× c×ᵀ, m c×; m c×ᵀ, m 1]` at the frame, RBDA (2.63).
    fn spatial_inertia(&self) -> Matrix6<f64> {
        let cross = Vector3::from(self.center).cross_matrix();
        let moment = self.mass * cross;
        let rotational = self.tensor() + moment * cross.transpose();
        blocks([[rotational, moment], [moment.transpose(), self.mass * Matrix3::identity()]])
    }
}

impl Tree {
    /// Number of variables: coordinates and signals.
    pub fn variables(&self) -> usize {
        self.coordinates + self.signals
    }

    /// The generalized forces on all variables that cause `ẍ`; those on signals are what it takes to prescribe them.
    ///
    /// # Source
    ///
    /// Luh, Walker, Paul, *On-line computational scheme for mechanical manipulators*, J. Dyn. Syst. Meas. Control 102,
    /// 1980, here for trees and in world axes. Gravity is an acceleration `−g` of the world.
    pub fn newton_euler(&self, x: &[f64], xd: &[f64], xdd: &[f64]) -> Vec<f64> {
        let (frames, map) = (self.frames(x), self.rates(x));
        let nu = &map * DVector::from_column_slice(xd);
        let nu_dot = &map * DVector::from_column_slice(xdd) + self.curvatures(xd);
        let base = Moving { acceleration: -Vector3::from(self.gravity), ..Moving::default() };
        let mut states: Vec<Moving> = Vec::new();
        let mut wrenches = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            let before = node.parent.map_or(base, |p| states[p]);
            let r = frames[i].origin() - node.parent.map_or(Vector3::zeros(), |p| frames[p].origin());
            let mut state = Moving { acceleration: before.acceleration_at(&r), ..before };
            for (k, turns, axis) in self.axes_of(i, &frames) {
                let (rate, rate_dot) = (axis * nu[k], axis * nu_dot[k]);
                if turns {
                    state.omega += rate;
                    state.alpha += rate_dot + before.omega.cross(&rate);
                } else {
                    state.acceleration += rate_dot + 2.0 * before.omega.cross(&rate);
                }
            }
            let nothing = (Vector3::zeros(), Vector3::zeros());
            wrenches.push(node.body.map_or(nothing, |body| state.wrench(&body, &frames[i].axes())));
            states.push(state);
        }
        let mut forces = DVector::zeros(map.nrows());
        for (i, node) in self.nodes.iter().enumerate().rev() {
            let (force, moment) = wrenches[i];
            for (k, turns, axis) in self.axes_of(i, &frames) {
                forces[k] = axis.dot(if turns { &moment } else { &force });
            }
            if let Some(parent) = node.parent {
                let r = frames[i].origin() - frames[parent].origin();
                wrenches[parent].0 += force;
                wrenches[parent].1 += moment + r.cross(&force);
            }
        }
        let mut result = map.transpose() * forces;
        self.drives.iter().zip(xdd).enumerate().for_each(|(k, (inertia, xdd))| result[k] += inertia * xdd);
        result.iter().copied().collect()
    }

    /// Mass matrix over all variables; the bodies beyond a joint are one.
    ///
    /// # Source
    ///
    /// Featherstone, *Rigid Body Dynamics Algorithms*, 2008 (RBDA), table 6.2.
    pub fn composite_bodies(&self, x: &[f64]) -> DMatrix<f64> {
        let (transforms, map) = (self.motion_transforms(x), self.rates(x));
        let mut composites = self.spatial_inertias();
        let mut h = DMatrix::zeros(map.nrows(), map.nrows());
        for i in (0..self.nodes.len()).rev() {
            if let Some(parent) = self.nodes[i].parent {
                let moved = transforms[i].transpose() * composites[i] * transforms[i];
                composites[parent] += moved;
            }
            for (k, subspace) in self.subspace(i) {
                // `force` is in the axes of node j.
                let (mut force, mut j) = (composites[i] * subspace, i);
                loop {
                    for (l, subspace) in self.subspace(j) {
                        h[(k, l)] = force.dot(&subspace);
                        h[(l, k)] = h[(k, l)];
                    }
                    let Some(parent) = self.nodes[j].parent else { break };
                    force = transforms[j].transpose() * force;
                    j = parent;
                }
            }
        }
        let mut m = map.transpose() * h * map;
        self.drives.iter().enumerate().for_each(|(k, inertia)| m[(k, k)] += inertia);
        m
    }

    /// `M = Σ m J_vᵀ J_v + J_ωᵀ R I Rᵀ J_ω` over all variables.
    ///
    /// # Source
    ///
    /// Spong, Hutchinson, Vidyasagar, *Robot Modeling and Control*, 2006, section 7.2.
    pub fn jacobian_mass_matrix<S: Number>(&self, x: &[S]) -> Vec<Vec<S>> {
        let frames = self.frames(x);
        let mut m = vec![vec![S::constant(0.0); x.len()]; x.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            let Some(body) = node.body else { continue };
            let center = add(frames[i].position, times(&frames[i].rotation, body.center.map(S::constant)));
            let columns = self.point_columns(i, center, x, &frames);
            // In the axes of the body: I Rᵀ ω.
            let [xx, yy, zz, xy, xz, yz] = body.inertia.map(S::constant);
            let tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
            let turned: Vec<[S; 3]> = columns.iter().map(|(_, _, w)| into(&frames[i].rotation, *w)).collect();
            let momenta: Vec<[S; 3]> = turned.iter().map(|w| times(&tensor, *w)).collect();
            for (a, (k, v, _)) in columns.iter().enumerate() {
                for (b, (l, other, _)) in columns.iter().enumerate() {
                    m[*k][*l] = m[*k][*l] + dot(*v, *other) * body.mass + dot(turned[a], momenta[b]);
                }
            }
        }
        self.drives.iter().enumerate().for_each(|(k, inertia)| m[k][k] = m[k][k] + S::constant(*inertia));
        m
    }

    /// `C` with `C q̇ + G = h`, over the coordinates: `Cᵢⱼ = Γᵢⱼₖ q̇ₖ + 2 Γᵢⱼₛ ẋₛ`, k over coordinates, s over signals.
    ///
    /// `Γᵢⱼₖ = ½(∂Mᵢⱼ/∂xₖ + ∂Mᵢₖ/∂xⱼ − ∂Mⱼₖ/∂xᵢ)` over all variables. In the equation of a coordinate each product of a
    /// coordinate's and a signal's rate occurs twice, and both are counted to C; products of two signals' rates to G.
    /// With `a = M_qs ẋₛ` that is `½(Ṁ + ∂M/∂t + P − Pᵀ) + ∂aᵢ/∂qⱼ − ∂aⱼ/∂qᵢ`, as in the manual. Rows.
    ///
    /// # Panics
    ///
    /// Where there are ball joints: a derivative by one component of a unit quaternion has no meaning of its own.
    pub fn coriolis_matrix(&self, x: &[f64], xd: &[f64]) -> Vec<Vec<f64>> {
        assert!(!self.has_ball_joints(), "Christoffel symbols by single components of a quaternion");
        let slopes: Vec<Vec<Vec<f64>>> = (0..x.len())
            .map(|k| {
                let seed = |(l, &value)| Dual { value, derivative: if l == k { 1.0 } else { 0.0 } };
                let along: Vec<Dual<f64>> = x.iter().enumerate().map(seed).collect();
                let m = self.jacobian_mass_matrix(&along);
                m.into_iter().map(|row| row.into_iter().map(|entry| entry.derivative).collect()).collect()
            })
            .collect();
        let entry = |i: usize, j: usize| {
            let term = |k: usize| {
                let symbol = 0.5 * (slopes[k][i][j] + slopes[j][i][k] - slopes[i][j][k]);
                if k < self.coordinates { symbol * xd[k] } else { 2.0 * symbol * xd[k] }
            };
            (0..x.len()).map(term).sum()
        };
        (0..self.coordinates).map(|i| (0..self.coordinates).map(|j| entry(i, j)).collect()).collect()
    }

    /// `T = ½ ẋᵀ M ẋ`.
    pub fn kinetic_energy(&self, x: &[f64], xd: &[f64]) -> f64 {
        let m = self.jacobian_mass_matrix(x);
        0.5 * xd.iter().zip(&m).map(|(a, row)| a * row.iter().zip(xd).map(|(m, b)| m * b).sum::<f64>()).sum::<f64>()
    }

    /// `V = −Σ m g · r`, zero with every mass centre at the world's origin.
    pub fn potential_energy(&self, x: &[f64]) -> f64 {
        let frames = self.frames(x);
        let weight = |(node, frame): (&Node, &Frame<f64>)| {
            node.body.map_or(0.0, |body| {
                -body.mass * dot(self.gravity, add(frame.position, times(&frame.rotation, body.center)))
            })
        };
        self.nodes.iter().zip(&frames).map(weight).sum()
    }

    /// Generalized forces of a force at a point and of a torque, all in the axes of node `i`: `Q = J_vᵀ F + J_ωᵀ T`.
    pub fn wrench(&self, i: usize, point: [f64; 3], force: [f64; 3], torque: [f64; 3], x: &[f64]) -> Vec<f64> {
        let frames = self.frames(x);
        let rotation = frames[i].rotation;
        let place = add(frames[i].position, times(&rotation, point));
        let (force, torque) = (times(&rotation, force), times(&rotation, torque));
        let mut forces = vec![0.0; self.coordinates];
        for (k, v, w) in self.point_columns(i, place, x, &frames) {
            if k < self.coordinates {
                forces[k] += dot(v, force) + dot(w, torque);
            }
        }
        forces
    }

    /// Whether a quaternion is among the coordinates.
    pub fn has_ball_joints(&self) -> bool {
        self.balls().next().is_some()
    }

    /// Where the quaternions begin among the coordinates.
    pub fn balls(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().filter_map(|node| match node.motion {
            Motion::Ball { first } => Some(first),
            Motion::Fixed | Motion::Turn(..) | Motion::Slide(..) => None,
        })
    }

    /// Columns of the Jacobians of a point of node `i` and of its rotation, in world axes: number of the variable,
    /// `∂v/∂ẋ`, `∂ω/∂ẋ`; one for each joint and variable on the way to the world.
    fn point_columns<S: Number>(
        &self,
        i: usize,
        point: [S; 3],
        x: &[S],
        frames: &[Frame<S>],
    ) -> Vec<(usize, [S; 3], [S; 3])> {
        let zero = [S::constant(0.0); 3];
        let mut columns = Vec::new();
        let mut next = Some(i);
        while let Some(j) = next {
            let rotation = &frames[j].rotation;
            let arm = sub(point, frames[j].position);
            match &self.nodes[j].motion {
                Motion::Fixed => {}
                Motion::Turn(axis, law) => {
                    let axis = times(rotation, unit(*axis).map(S::constant));
                    let moved = cross(axis, arm);
                    let along = |(k, slope)| (k, moved.map(|c| c * slope), axis.map(|c| c * slope));
                    columns.extend(law.slopes(x).into_iter().map(along));
                }
                Motion::Slide(axis, law) => {
                    let axis = times(rotation, axis.map(S::constant));
                    columns.extend(law.slopes(x).into_iter().map(|(k, slope)| (k, axis.map(|c| c * slope), zero)));
                }
                Motion::Ball { first } => {
                    let rows = ball_rates(from_fn(|k| x[first + k]));
                    columns.extend((0..4).map(|k| {
                        let axis = times(rotation, rows.map(|row| row[k]));
                        (first + k, cross(axis, arm), axis)
                    }));
                }
            }
            next = self.nodes[j].parent;
        }
        columns
    }

    /// The frames of all nodes.
    fn frames<S: Number>(&self, x: &[S]) -> Vec<Frame<S>> {
        let mut frames: Vec<Frame<S>> = Vec::new();
        for node in &self.nodes {
            let step = node.step(x);
            let frame = match node.parent {
                None => step,
                Some(parent) => {
                    let above = frames[parent];
                    let position = add(above.position, times(&above.rotation, step.position));
                    Frame { rotation: product(&above.rotation, &step.rotation), position }
                }
            };
            frames.push(frame);
        }
        frames
    }

    /// The axes of node `i`'s joint in world axes: number of the rate, whether it turns, the axis.
    fn axes_of(&self, i: usize, frames: &[Frame<f64>]) -> Vec<(usize, bool, Vector3<f64>)> {
        let rotation = frames[i].axes();
        self.subspace(i)
            .into_iter()
            .map(|(k, s)| {
                let (turn, slide): (Vector3<f64>, Vector3<f64>) =
                    (s.fixed_rows::<3>(0).into(), s.fixed_rows::<3>(3).into());
                let turns = turn != Vector3::zeros();
                (k, turns, rotation * if turns { turn } else { slide })
            })
            .collect()
    }

    /// The columns of node `i`'s motion subspace `S`, which is constant in its own axes, with the numbers of their
    /// rates.
    fn subspace(&self, i: usize) -> Vec<(usize, Vector6<f64>)> {
        let first: usize = self.nodes[..i].iter().map(|node| node.motion.freedom()).sum();
        let columns = match &self.nodes[i].motion {
            Motion::Fixed => Vec::new(),
            Motion::Turn(axis, _) => vec![spatial(Vector3::from(unit(*axis)), Vector3::zeros())],
            Motion::Slide(axis, _) => vec![spatial(Vector3::zeros(), Vector3::from(*axis))],
            Motion::Ball { .. } => {
                (0..3).map(|k| Vector6::from_fn(|row, _| if row == k { 1.0 } else { 0.0 })).collect()
            }
        };
        (first..).zip(columns).collect()
    }

    /// `N` of `ν = N ẋ`.
    fn rates(&self, x: &[f64]) -> DMatrix<f64> {
        let freedom = self.nodes.iter().map(|node| node.motion.freedom()).sum();
        let mut map = DMatrix::zeros(freedom, self.variables());
        let mut row = 0;
        for node in &self.nodes {
            match &node.motion {
                Motion::Fixed => {}
                Motion::Turn(_, law) | Motion::Slide(_, law) => {
                    law.slopes(x).into_iter().for_each(|(k, slope)| map[(row, k)] = slope);
                }
                Motion::Ball { first } => {
                    let rows = ball_rates(from_fn(|k| x[first + k]));
                    (0..3).for_each(|i| (0..4).for_each(|k| map[(row + i, first + k)] = rows[i][k]));
                }
            }
            row += node.motion.freedom();
        }
        map
    }

    /// `Ṅ ẋ`
    fn curvatures(&self, xd: &[f64]) -> DVector<f64> {
        let of = |node: &Node| match &node.motion {
            Motion::Fixed => Vec::new(),
            Motion::Turn(_, law) | Motion::Slide(_, law) => vec![law.curvature(xd)],
            Motion::Ball { .. } => vec![0.0; 3],
        };
        DVector::from_vec(self.nodes.iter().flat_map(of).collect())
    }

    fn spatial_inertias(&self) -> Vec<Matrix6<f64>> {
        self.nodes.iter().map(|node| node.body.map_or(Matrix6::zeros(), |body| body.spatial_inertia())).collect()
    }

    /// Spatial motion from the axes of the parent to the node's: `X = [E, 0; −E r×, E]`, RBDA (2.24).
    fn motion_transforms(&self, x: &[f64]) -> Vec<Matrix6<f64>> {
        let transform = |node: &Node| {
            let step = node.step(x);
            let e = step.axes().transpose();
            blocks([[e, Matrix3::zeros()], [-e * step.origin().cross_matrix(), e]])
        };
        self.nodes.iter().map(transform).collect()
    }
}

impl Motion {
    /// Number of rates.
    fn freedom(&self) -> usize {
        match self {
            Motion::Fixed => 0,
            Motion::Turn(..) | Motion::Slide(..) => 1,
            Motion::Ball { .. } => 3,
        }
    }
}

impl Node {
    /// The node's frame in its parent.
    fn step<S: Number>(&self, x: &[S]) -> Frame<S> {
        let Place { shift, axis, angle } = self.place;
        let axis = Unit::new_normalize(Vector3::from(axis));
        let constant = Rotation3::from_axis_angle(&axis, angle).into_inner();
        let rotation: [[S; 3]; 3] = from_fn(|i| from_fn(|j| S::constant(constant[(i, j)])));
        let position = shift.map(S::constant);
        match &self.motion {
            Motion::Fixed => Frame { rotation, position },
            Motion::Turn(axis, law) => Frame { rotation: product(&rotation, &turn(unit(*axis), law.at(x))), position },
            Motion::Slide(axis, law) => {
                let way = times(&rotation, axis.map(|c| law.at(x) * c));
                Frame { rotation, position: add(position, way) }
            }
            Motion::Ball { first } => {
                let ball = quaternion_rotation(from_fn(|k| x[first + k]));
                Frame { rotation: product(&rotation, &ball), position }
            }
        }
    }
}

#[cfg(test)]
mod tests;
