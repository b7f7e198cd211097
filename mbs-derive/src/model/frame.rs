//! Frames: a tree of edges from the world, each frame with its pose and its twist.
//!
//! A frame carries its angular velocity and the velocity of its origin in its *own* axes. Along an edge
//! (Luh, Walker & Paul, *On-line computational scheme for mechanical manipulators*, 1980)
//!
//! - rotation about the unit axis e by θ, with matrix R: `ω' = Rᵀ ω + e θ̇`, `v' = Rᵀ v`;
//! - rotation by a unit quaternion (w, x, y, z): `ω' = Rᵀ ω + 2 (w u̇ − ẇ u − u × u̇)` with u = (x, y, z), `v' = Rᵀ v`;
//! - translation by t: `ω' = ω`, `v' = v + ω × t + ṫ`,
//!
//! so that a chain of n bodies costs O(n), and a velocity is turned into other axes only where it must be.

use crate::expr::{Expr, Graph, Matrix, Vector};

use crate::model::landmark::is_still;

/// Number of a frame in its [`Frames`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FrameId(usize);

impl FrameId {
    /// The inertial frame.
    pub const WORLD: FrameId = FrameId(0);

    /// For tables over all frames.
    pub fn index(self) -> usize {
        self.0
    }
}

/// How a frame moves in its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge<'g> {
    /// Turned by an angle about a unit axis, which is the same in both frames.
    Rotation {
        /// Unit vector, constant in time.
        axis: Vector<'g>,
        /// Any expression of coordinates, time and parameters.
        angle: Expr<'g>,
    },
    /// Turned by a quaternion (w, x, y, z), the scalar part first. Its length must be 1: coordinates need a constraint
    /// that keeps it so.
    Quaternion([Expr<'g>; 4]),
    /// Shifted, in the parent's axes.
    Translation(Vector<'g>),
}

impl Edge<'_> {
    /// The motion of the parent in the frame.
    pub fn reversed(self) -> Self {
        match self {
            Edge::Rotation { axis, angle } => Edge::Rotation { axis, angle: -angle },
            Edge::Quaternion([w, x, y, z]) => Edge::Quaternion([w, -x, -y, -z]),
            Edge::Translation(t) => Edge::Translation(-t),
        }
    }
}

impl<'g> Edge<'g> {
    /// From the frame's axes to the parent's; `None` where they are the same.
    pub(in crate::model) fn rotation(&self) -> Option<Matrix<'g>> {
        match *self {
            Edge::Rotation { axis, angle } => Some(Matrix::rotation(axis, angle)),
            Edge::Quaternion(q) => Some(rotation_by(q)),
            Edge::Translation(_) => None,
        }
    }

    /// Whether it leads back to where the other came from: `pose.inverse() * pose`.
    fn undoes(&self, other: &Edge<'g>) -> bool {
        let opposite = |a: Expr<'g>, b: Expr<'g>| a == -b || -a == b;
        match (self, other) {
            (Edge::Rotation { axis, angle }, Edge::Rotation { axis: other_axis, angle: other_angle }) => {
                axis == other_axis && opposite(*angle, *other_angle)
            }
            (Edge::Quaternion([w, u @ ..]), Edge::Quaternion([other_w, v @ ..])) => {
                w == other_w && u.iter().zip(v).all(|(&a, &b)| opposite(a, b))
            }
            (Edge::Translation(t), Edge::Translation(other)) => t.0.iter().zip(other.0).all(|(&a, b)| opposite(a, b)),
            (Edge::Rotation { .. } | Edge::Quaternion(_) | Edge::Translation(_), _) => false,
        }
    }
}

/// One frame of the tree.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'g> {
    /// The frame it is attached to; the world has none.
    pub parent: Option<FrameId>,
    /// How it moves in its parent; the world does not.
    pub edge: Option<Edge<'g>>,
    /// Own axes → world axes.
    pub rotation: Matrix<'g>,
    /// The origin, in world axes.
    pub position: Vector<'g>,
    /// `ω`, in own axes.
    pub angular_velocity: Vector<'g>,
    /// Velocity of the origin, in own axes.
    pub velocity: Vector<'g>,
}

/// The tree; parents come before children, the world first.
#[derive(Clone, Debug)]
pub struct Frames<'g> {
    frames: Vec<Frame<'g>>,
    /// Of each frame those that are attached to it.
    children: Vec<Vec<FrameId>>,
}

impl<'g> Frames<'g> {
    /// Only the world.
    pub fn new(graph: &'g Graph) -> Self {
        let zero = Vector::zero(graph);
        let world = Frame {
            parent: None,
            edge: None,
            rotation: Matrix::identity(graph),
            position: zero,
            angular_velocity: zero,
            velocity: zero,
        };
        Frames { frames: vec![world], children: vec![Vec::new()] }
    }

    /// One frame.
    pub fn get(&self, id: FrameId) -> &Frame<'g> {
        &self.frames[id.0]
    }

    /// All frames, parents first.
    pub fn iter(&self) -> impl Iterator<Item = &Frame<'g>> {
        self.frames.iter()
    }

    /// A frame that moves in `parent` as `edge` says; the same edge on the same parent is the same frame, and an edge
    /// that undoes that of `parent` leads to the frame that this one is attached to.
    pub fn attach(&mut self, parent: FrameId, edge: Edge<'g>) -> FrameId {
        if let Frame { parent: Some(before), edge: Some(last), .. } = self.get(parent)
            && edge.undoes(last)
        {
            return *before;
        }
        let known = self.children[parent.0].iter().find(|child| self.get(**child).edge == Some(edge));
        known.copied().unwrap_or_else(|| {
            let (id, frame) = (FrameId(self.frames.len()), self.moved(parent, edge));
            self.frames.push(frame);
            self.children.push(Vec::new());
            self.children[parent.0].push(id);
            id
        })
    }

    /// The edges from the world to `frame`.
    pub fn path(&self, frame: FrameId) -> Vec<Edge<'g>> {
        self.path_from(FrameId::WORLD, frame)
    }

    /// The edges from a frame to another that hangs from it.
    pub fn path_from(&self, base: FrameId, frame: FrameId) -> Vec<Edge<'g>> {
        let ancestors = std::iter::successors(Some(frame), |id| self.get(*id).parent);
        let mut edges: Vec<_> = ancestors.take_while(|id| *id != base).filter_map(|id| self.get(id).edge).collect();
        edges.reverse();
        edges
    }

    /// A frame and those that it hangs from, the world last.
    pub fn way_to_world(&self, frame: FrameId) -> impl Iterator<Item = &Frame<'g>> {
        std::iter::successors(Some(self.get(frame)), |at| at.parent.map(|parent| self.get(parent)))
    }

    /// The nearest frame that both hang from, or are.
    pub fn nearest_common(&self, mut a: FrameId, mut b: FrameId) -> FrameId {
        // Parents have smaller numbers than their children.
        while a != b {
            let later = if a > b { &mut a } else { &mut b };
            *later = self.get(*later).parent.unwrap_or(FrameId::WORLD);
        }
        a
    }

    /// `v·v` of the origin, and how many times as large it is in the axes of the frame: 1, but behind quaternions e
    /// `|e|⁴`.
    ///
    /// Turns about the origin do not change it. So what slides along fixed axes, or turns by a quaternion, has it in
    /// the axes in which it was last shifted, the squares of its coordinates' rates; elsewhere sines and cosines cancel
    /// by themselves, and forms are shorter in the axes of the frame.
    pub fn speed_squared(&self, frame: FrameId) -> (Expr<'g>, Expr<'g>) {
        let own = self.get(frame).velocity;
        let mut stretch = None;
        let mut way = self.way_to_world(frame);
        let is_shifted = |at: &&Frame<'g>| match at.edge {
            Some(Edge::Rotation { .. }) => false,
            Some(Edge::Quaternion(e)) => {
                let [ww, xx, yy, zz] = e.map(|c| c.powi(2));
                let factor = (ww + xx + yy + zz).powi(2);
                stretch = Some(stretch.map_or(factor, |stretch: Expr<'g>| stretch * factor));
                false
            }
            Some(Edge::Translation(_)) | None => true,
        };
        let shifted = way.find(is_shifted).map_or(own, |at| at.velocity);
        let axes_are_fixed = way.all(|above| match above.edge {
            Some(Edge::Rotation { angle, .. }) => is_still(angle),
            Some(Edge::Quaternion(e)) => e.into_iter().all(is_still),
            Some(Edge::Translation(_)) | None => true,
        });
        let is_longer = stretch.is_none() && !axes_are_fixed;
        let velocity = if is_longer { own } else { shifted };
        (velocity.norm_squared(), stretch.unwrap_or_else(|| own.0[0].graph().integer(1)))
    }

    fn moved(&self, parent: FrameId, edge: Edge<'g>) -> Frame<'g> {
        let above = self.get(parent);
        match edge {
            Edge::Rotation { axis, angle } => {
                let r = Matrix::rotation(axis, angle);
                Frame {
                    parent: Some(parent),
                    edge: Some(edge),
                    rotation: above.rotation * r,
                    position: above.position,
                    angular_velocity: r.transpose() * above.angular_velocity + axis.scale(angle.rate()),
                    velocity: r.transpose() * above.velocity,
                }
            }
            Edge::Quaternion(q) => {
                let r = rotation_by(q);
                Frame {
                    parent: Some(parent),
                    edge: Some(edge),
                    rotation: above.rotation * r,
                    position: above.position,
                    angular_velocity: r.transpose() * above.angular_velocity + angular_velocity_of(q),
                    velocity: r.transpose() * above.velocity,
                }
            }
            Edge::Translation(t) => Frame {
                parent: Some(parent),
                edge: Some(edge),
                rotation: above.rotation,
                position: above.position + above.rotation * t,
                angular_velocity: above.angular_velocity,
                velocity: above.velocity + above.angular_velocity.cross(t) + t.map(Expr::rate),
            },
        }
    }
}

/// The rotation matrix of a unit quaternion, its diagonal in the homogeneous form `w² + x² − y² − z²`.
fn rotation_by<'g>([w, x, y, z]: [Expr<'g>; 4]) -> Matrix<'g> {
    let [ww, xx, yy, zz] = [w, x, y, z].map(|c| c.powi(2));
    Matrix([
        [ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz],
    ])
}

/// `ω = 2 q̄ q̇` in the turned axes, for `|q| = 1`.
fn angular_velocity_of<'g>(q: [Expr<'g>; 4]) -> Vector<'g> {
    let ([w, x, y, z], [dw, dx, dy, dz]) = (q, q.map(Expr::rate));
    Vector([
        2 * (w * dx - x * dw + z * dy - y * dz),
        2 * (w * dy - y * dw + x * dz - z * dx),
        2 * (w * dz - z * dw + y * dx - x * dy),
    ])
}
