//! What all formats say of a robot: bodies on joints, in the order of a walk from the base to the tips.

use std::collections::BTreeSet;

use super::identifier::spare;
use super::pose::{Pose, norm};
use super::xml::Reader;
use crate::numeric::moments::{Impossible, principal_moments};
use crate::span::Span;

/// A robot as a file has it.
#[derive(Debug, Default)]
pub(super) struct Robot {
    pub(super) name: String,
    /// m/s²
    pub(super) gravity: [f64; 3],
    /// Each behind the one that it hangs on.
    pub(super) bodies: Vec<Body>,
    pub(super) couplings: Vec<Coupling>,
    /// What the text says of the whole file.
    pub(super) notes: Vec<String>,
}

/// A link, and the joints by which it moves against its parent.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) name: String,
    /// None of what stands in the world.
    pub(super) parent: Option<usize>,
    /// Where it is in the frame of its parent while its joints are at zero; of a free body whose place is counted from
    /// the frame of its parent, where it is at first.
    pub(super) pose: Pose,
    /// In the order in which they act; none of a fixed body.
    pub(super) joints: Vec<Joint>,
    /// What a fixed joint is called, where it has a name.
    pub(super) fixed_by: Option<String>,
    /// It stands in the world where the file has it, whatever is asked for.
    pub(super) is_held: bool,
    pub(super) inertial: Option<Inertial>,
    /// Gravity does not act on it.
    pub(super) is_weightless: bool,
    pub(super) shapes: Vec<Shape>,
    pub(super) notes: Vec<String>,
    pub(super) span: Span,
}

impl Body {
    /// A body without mass at the origin of the world.
    pub(super) fn new(name: &str, span: Span) -> Self {
        Body {
            name: name.to_string(),
            parent: None,
            pose: Pose::default(),
            joints: Vec::new(),
            fixed_by: None,
            is_held: false,
            inertial: None,
            is_weightless: false,
            shapes: Vec::new(),
            notes: Vec::new(),
            span,
        }
    }

    /// What is computed from what the file says, and may have overflowed.
    fn numbers(&self) -> Vec<f64> {
        let mut found = self.pose.shift.to_vec();
        for Shape { form, pose } in &self.shapes {
            found.extend(pose.shift);
            match form {
                Form::Box(sizes) | Form::Mesh(_, sizes, _) => found.extend(sizes),
                Form::Cylinder(radius, length) | Form::Capsule(radius, length) => found.extend([radius, length]),
                Form::Sphere(radius) => found.push(*radius),
            }
        }
        if let Some(Inertial { mass, com, inertia, .. }) = &self.inertial {
            found.push(*mass);
            found.extend(com.iter().chain(inertia));
        }
        for joint in &self.joints {
            found.extend(joint.anchor);
            found.extend([norm(&joint.axis), joint.zero, joint.damping]);
        }
        found
    }
}

/// Mass, mass centre in the frame of the body, inertia about it in these axes: `xx yy zz xy xz yz`.
#[derive(Clone, Debug)]
pub(super) struct Inertial {
    pub(super) mass: f64,
    pub(super) com: [f64; 3],
    pub(super) inertia: [f64; 6],
    pub(super) span: Span,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    /// All turns about a point.
    Ball,
    /// All motions.
    Free,
    /// Two shifts, and a turn about their normal.
    Planar,
}

/// A joint.
#[derive(Clone, Debug)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// As the file calls its kind.
    pub(super) word: String,
    /// In the frame of the body.
    pub(super) axis: [f64; 3],
    /// A point of it, in the frame of the body.
    pub(super) anchor: [f64; 3],
    /// The value of its coordinate where the body is at its pose.
    pub(super) zero: f64,
    /// Of a free joint: its place and attitude are counted from the body's pose; else from the frame of the parent.
    pub(super) is_from_pose: bool,
    pub(super) mimic: Option<Mimic>,
    pub(super) damping: f64,
    pub(super) friction: f64,
    pub(super) armature: f64,
    pub(super) stiffness: f64,
    /// Where its spring is relaxed.
    pub(super) rest: f64,
    /// What the text says of its limits.
    pub(super) limits: String,
    pub(super) span: Span,
}

impl Joint {
    pub(super) fn new(name: &str, kind: Kind, word: &str, span: Span) -> Self {
        Joint {
            name: name.to_string(),
            kind,
            word: word.to_string(),
            axis: [0.0, 0.0, 1.0],
            anchor: [0.0; 3],
            zero: 0.0,
            is_from_pose: false,
            mimic: None,
            damping: 0.0,
            friction: 0.0,
            armature: 0.0,
            stiffness: 0.0,
            rest: 0.0,
            limits: String::new(),
            span,
        }
    }
}

/// A joint that follows another one: `factor*other + offset`.
#[derive(Clone, Debug)]
pub(super) struct Mimic {
    pub(super) joint: String,
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) span: Span,
}

/// What a body looks like.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) form: Form,
    pub(super) pose: Pose,
}

/// Sizes in m.
#[derive(Clone, Debug)]
pub(super) enum Form {
    Box([f64; 3]),
    Cylinder(f64, f64),
    Sphere(f64),
    /// A cylinder of this radius and length with two half balls.
    Capsule(f64, f64),
    /// A path as written, and the place where it is.
    Mesh(String, [f64; 3], Span),
}

/// What couples bodies or coordinates besides the joints of the tree.
#[derive(Debug)]
pub(super) enum Coupling {
    /// Joints: `first = Σ powers[k]·second^k`, both counted from where the bodies are at their poses; without a second
    /// one the first stays.
    Joints { name: String, first: String, second: Option<String>, powers: [f64; 5] },
    /// A sum of coordinates that stays where it is: `Σ factor·(q − q₀) = offset`.
    Sum { name: String, terms: Vec<(f64, String)>, offset: f64 },
    /// Two points, each in the frame of a body.
    Points { name: String, bodies: [Option<usize>; 2], points: [[f64; 3]; 2] },
    /// Two frames, each fixed in a body.
    Frames { name: String, bodies: [Option<usize>; 2], poses: [Pose; 2] },
    /// A spring and a damper along a sum of coordinates.
    Spring { name: String, terms: Vec<(f64, String)>, stiffness: f64, rest: f64, damping: f64 },
}

impl Inertial {
    /// Whether a body can have it.
    pub(super) fn is_possible(&self) -> bool {
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        let moments = principal_moments(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        moments.is_none_or(|moments| Impossible::of(moments).is_none())
    }

    /// Whether it is in no energy.
    pub(super) fn is_nothing(&self) -> bool {
        self.mass == 0.0 && self.inertia.iter().all(|&entry| entry == 0.0)
    }
}

impl Robot {
    /// The bases of the robot move freely.
    pub(super) fn set_free(&mut self) {
        let joints = self.bodies.iter().flat_map(|body| &body.joints);
        let names: BTreeSet<String> = joints.map(|joint| joint.name.clone()).collect();
        for base in self.bases() {
            let body = &mut self.bodies[base];
            let name = spare(&format!("{}_joint", body.name), |name| names.contains(name));
            body.joints.push(Joint::new(&name, Kind::Free, "free", body.span.clone()));
        }
    }

    /// What stands in the world, and no joint holds. Of several bodies those that carry joints: the others are the
    /// robot's surroundings.
    fn bases(&self) -> Vec<usize> {
        let mut carries = vec![false; self.bodies.len()];
        for (i, body) in self.bodies.iter().enumerate().rev() {
            carries[i] |= !body.joints.is_empty();
            if carries[i] {
                body.parent.into_iter().for_each(|parent| carries[parent] = true);
            }
        }
        let any_moves = carries.contains(&true);
        let is_base = |i: &usize| {
            let body = &self.bodies[*i];
            let is_loose = body.parent.is_none() && body.joints.is_empty() && body.fixed_by.is_none() && !body.is_held;
            is_loose && (carries[*i] || !any_moves)
        };
        (0..self.bodies.len()).filter(is_base).collect()
    }

    /// What must hold of every robot, whatever its format.
    pub(super) fn check(&self, any_inertia: bool, reader: &mut Reader) {
        for body in &self.bodies {
            if !body.numbers().iter().all(|number| number.is_finite()) {
                let message = format!("numbers of the link `{}` are so large that they overflow", body.name);
                reader.refuse(body.span.clone(), message, "lengths are in m, masses in kg");
            }
            if let Some(inertial) = &body.inertial {
                check_inertial(&body.name, inertial, any_inertia, reader);
            }
        }
        self.check_moving_masses(reader);
        let joints = || self.bodies.iter().flat_map(|body| &body.joints);
        for joint in joints() {
            let axis_counts = matches!(joint.kind, Kind::Hinge | Kind::Slide | Kind::Planar);
            if axis_counts && joint.axis.iter().all(|c| c.abs() < 1e-12) {
                let message = format!("the axis of the joint `{}` has no direction", joint.name);
                reader.refuse(joint.span.clone(), message, "write a vector along it, such as `0 0 1`");
            }
        }
        // Where all joints follow others they follow each other, or what is missing: that is told by the writer.
        if joints().next().is_none() && !reader.errors.has_errors() {
            let place = self.bodies.first().map_or(0..0, |body| body.span.clone());
            let help = if self.bases().is_empty() {
                "a mechanism has coordinates: give a link a joint that moves"
            } else {
                "a mechanism has coordinates: with `mbs import --floating` the base moves freely"
            };
            reader.refuse(place, format!("no joint of the robot `{}` moves", self.name), help);
        }
    }

    /// Behind every joint there is a mass, or an inertia of its own about it.
    fn check_moving_masses(&self, reader: &mut Reader) {
        let mut is_heavy = vec![false; self.bodies.len()];
        for (i, body) in self.bodies.iter().enumerate().rev() {
            let own = body.inertial.as_ref().is_some_and(|inertial| !inertial.is_nothing());
            is_heavy[i] |= own;
            if is_heavy[i] {
                body.parent.into_iter().for_each(|parent| is_heavy[parent] = true);
            }
        }
        for (body, _) in self.bodies.iter().zip(&is_heavy).filter(|(_, is_heavy)| !**is_heavy) {
            let Some(joint) = body.joints.iter().find(|joint| joint.armature == 0.0) else { continue };
            let place = body.inertial.as_ref().map_or(body.span.clone(), |inertial| inertial.span.clone());
            let message = format!(
                "the link `{}` moves by the joint `{}`, and neither it nor what hangs on it has mass",
                body.name, joint.name
            );
            reader.refuse(place, message, "give it an inertia, or fix the joint");
        }
    }
}

/// Positive, and such that a body can have it.
fn check_inertial(name: &str, inertial: &Inertial, any_inertia: bool, reader: &mut Reader) {
    let Inertial { mass, inertia: [xx, yy, zz, xy, xz, yz], span, .. } = inertial;
    if *mass < 0.0 {
        reader.refuse(span.clone(), format!("the mass of the link `{name}` is negative: {mass} kg"), "");
    }
    let Some(moments) = principal_moments(&[*xx, *xy, *xz, *xy, *yy, *yz, *xz, *yz, *zz]) else { return };
    let [a, b, c] = moments;
    let problem = match Impossible::of(moments) {
        Some(Impossible::Negative) => Some(format!("the inertia of the link `{name}` has a negative principal moment")),
        Some(Impossible::Unequal) => Some(format!(
            "no body has the inertia of the link `{name}`: a principal moment is greater than the sum of the other two"
        )),
        None => None,
    };
    let shown = format!("its principal moments are {a:.4e}, {b:.4e} and {c:.4e} kg·m²");
    match problem {
        Some(message) if any_inertia => reader.warn(span.clone(), message, &shown),
        Some(message) => {
            let help = format!("{shown}; `mbs import --any-inertia` takes it as it is");
            reader.refuse(span.clone(), message, &help);
        }
        None if *mass > 0.0 && c / mass > 100.0 => {
            let message = format!("the inertia of the link `{name}` is that of a body of more than ten metres");
            reader.warn(span.clone(), message, "is it in kg·m², and the mass in kg?");
        }
        None if *mass == 0.0 && c > 0.0 => {
            let message = format!("the link `{name}` has an inertia, and no mass");
            reader.warn(span.clone(), message, "what turns has both: is its mass missing?");
        }
        None => {}
    }
}
