//! A peg and a hole with a chamfer, in the plane: where they touch, and with which forces.
//!
//! On each side two things can touch: the lower corner of the peg the solid around the hole, and the edge between
//! chamfer and bore the side of the peg. Peg and solid are convex there, so the depth is that below the nearest face:
//!
//! ```text
//! corner in the solid:  δ = min(X − R, ((X − R) h − z w)/√(w² + h²), h − z)     bore, chamfer, top
//! edge in the peg:      δ = min(r − b, a)                                       side, bottom of the peg
//! ```
//!
//! with X the distance of the corner from the axis of the hole, z its height over the edge, a and b the edge's place
//! along and across the peg. Both at once on different sides is two-point contact.

use mbs_models::check::{Invalid, not_negative, positive};
use mbs_runtime::Scalar;

/// Two numbers: to the right and up.
pub type Plane = [f64; 2];

/// What hangs below the wrist: a peg, with the gripper that holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peg {
    /// r \[m\]
    pub radius: f64,
    /// The mass of all of it \[kg\].
    pub mass: f64,
    /// About its mass centre, across the axis \[kg·m²\].
    pub inertia: f64,
    /// Height of its mass centre over the tip \[m\].
    pub centre: f64,
}

/// A hole with a chamfer; heights count from the edge between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// R \[m\]
    pub radius: f64,
    /// Width w and height h of the chamfer \[m\].
    pub chamfer: [f64; 2],
    /// The middle of its mouth, at the height of the edge, in the world \[m\].
    pub place: Plane,
    /// By which its axis leans \[rad\].
    pub tilt: f64,
}

/// What a contact gives: `N = k δ max(0, 1 + a δ̇)`, `T = −μ N v/√(v² + v_s²)`.
///
/// # Source
/// K. H. Hunt and F. R. E. Crossley, *Coefficient of restitution interpreted as damping in vibroimpact*, Journal of
/// Applied Mechanics 42:2, 1975, with exponent 1; Coulomb's friction, made smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// k \[N/m\]
    pub stiffness: f64,
    /// a \[s/m\]
    pub damping: f64,
    /// μ
    pub friction: f64,
    /// v_s \[m/s\]
    pub creep_speed: f64,
}

/// Where the peg's mass centre is and how the peg leans, or the rates of it \[m, rad\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PegMotion {
    /// Mass centre, velocity of it.
    pub centre: Plane,
    /// Angle, rate of it.
    pub tilt: f64,
}

/// What the hole does to the peg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Forces {
    /// On x and z of the mass centre \[N\], on the tilt \[N·m\].
    pub generalized: [f64; 3],
    /// Normal forces \[N\]: corner left and right, edge left and right.
    pub normal: [f64; 4],
    /// Elastic energy `Σ ½ k δ²` \[J\].
    pub energy: f64,
    /// Power that damping and friction take off, zero or less \[W\].
    pub power: f64,
    /// How deep the tip is below the edge, along the axis of the hole \[m\].
    pub depth: f64,
}

impl Peg {
    /// All positive and finite.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("peg.radius", self.radius)?;
        positive("peg.mass", self.mass)?;
        positive("peg.inertia", self.inertia)?;
        positive("peg.centre", self.centre)
    }
}

impl Hole {
    /// Wider than the peg, with a chamfer, leaning by less than a quarter of a radian.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not; a hole that is too narrow by its clearance.
    pub fn check(&self, peg: &Peg) -> Result<(), Invalid> {
        positive("hole.radius", self.radius)?;
        positive("hole.chamfer", self.chamfer)?;
        mbs_models::check::finite("hole.place", self.place)?;
        mbs_models::check::within("hole.tilt", self.tilt, [-0.25, 0.25])?;
        positive("clearance", self.radius - peg.radius)
    }
}

impl Contact {
    /// A positive stiffness and creep speed, no negative damping and friction.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not.
    pub fn check(&self) -> Result<(), Invalid> {
        positive("contact.stiffness", self.stiffness)?;
        not_negative("contact.damping", self.damping)?;
        not_negative("contact.friction", self.friction)?;
        positive("contact.creep_speed", self.creep_speed)
    }

    /// Forces of the hole on a peg at `at` that moves with `rate`.
    #[must_use]
    pub fn forces(&self, peg: &Peg, hole: &Hole, at: &PegMotion, rate: &PegMotion) -> Forces {
        let (across, along) = axes(hole.tilt);
        let into = |v: Plane| [dot(v, across), dot(v, along)];
        let from_mouth = into([at.centre[0] - hole.place[0], at.centre[1] - hole.place[1]]);
        let (velocity, (n, u)) = (into(rate.centre), axes(at.tilt - hole.tilt));
        let tip = plus(from_mouth, u, -peg.centre);
        let mut forces = Forces { depth: -tip[1], ..Forces::default() };
        let mut generalized = [0.0; 3];
        for (i, side) in [-1.0, 1.0].into_iter().enumerate() {
            let corner = plus(tip, n, side * peg.radius);
            let edge = [side * hole.radius - tip[0], -tip[1]];
            let (a, b) = (dot(edge, u), dot(edge, n));
            let touches = [
                // Depth, normal towards the peg, and the point: along the peg from the tip, and across.
                (i, hole.depth_of(corner, side), [0.0, side * peg.radius]),
                (2 + i, edge_in_peg(peg.radius, a, side * b, n, u, side), [a, b]),
            ];
            for (which, (depth, normal), [a, b]) in touches {
                if depth <= 0.0 {
                    continue;
                }
                let a = a - peg.centre;
                // ∂(point)/∂(tilt)
                let turning = [a * n[0] - b * u[0], a * n[1] - b * u[1]];
                let slip = plus(velocity, turning, rate.tilt);
                let tangent = [normal[1], -normal[0]];
                let (leaving, sliding) = (dot(slip, normal), dot(slip, tangent));
                let elastic = self.stiffness * depth;
                let push = elastic * f64::max(0.0, 1.0 - self.damping * leaving);
                let rub = -self.friction * push * sliding
                    / Scalar::sqrt(sliding * sliding + self.creep_speed * self.creep_speed);
                let force = plus([push * normal[0], push * normal[1]], tangent, rub);
                generalized[0] += force[0];
                generalized[1] += force[1];
                generalized[2] += dot(force, turning);
                forces.normal[which] = push;
                forces.energy += 0.5 * elastic * depth;
                forces.power += (push - elastic) * leaving + rub * sliding;
            }
        }
        let [x, z, turn] = generalized;
        forces.generalized = [x * across[0] + z * along[0], x * across[1] + z * along[1], turn];
        forces
    }
}

impl Hole {
    /// How deep a point on one side is in the solid, and the normal of the nearest face.
    fn depth_of(&self, [x, z]: Plane, side: f64) -> (f64, Plane) {
        let [w, h] = self.chamfer;
        let (beyond, length) = (side * x - self.radius, Scalar::sqrt(w * w + h * h));
        nearest([
            (beyond, [-side, 0.0]),
            ((beyond * h - z * w) / length, [-side * h / length, w / length]),
            (h - z, [0.0, 1.0]),
        ])
    }
}

/// How deep an edge is in the peg, and where it pushes the peg.
fn edge_in_peg(radius: f64, along: f64, across: f64, n: Plane, u: Plane, side: f64) -> (f64, Plane) {
    nearest([(radius - across, [-side * n[0], -side * n[1]]), (along, u)])
}

fn nearest<const N: usize>(faces: [(f64, Plane); N]) -> (f64, Plane) {
    faces.into_iter().fold((f64::INFINITY, [0.0; 2]), |least, face| if face.0 < least.0 { face } else { least })
}

/// Across and along something that leans.
pub(super) fn axes(tilt: f64) -> (Plane, Plane) {
    let (sin, cos) = Scalar::sin_cos(tilt);
    ([cos, -sin], [sin, cos])
}

fn dot(a: Plane, b: Plane) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// `a + s b`
fn plus(a: Plane, b: Plane, s: f64) -> Plane {
    [a[0] + s * b[0], a[1] + s * b[1]]
}
