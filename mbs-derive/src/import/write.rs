//! A robot as a text of the model language.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Options;
use super::identifier::{Identifiers, of_mechanism, shown as quoted};
use super::pose::{Pose, coordinate_axis, factors, from_z, listed, norm, plus, shown, turned};
use super::robot::{Body, Form, Inertial, Joint, Kind, Robot, Shape};
use super::xml::Reader;

mod coupling;
mod effects;

/// The text of a robot, and the names in it.
pub(super) struct Writer<'r> {
    robot: &'r Robot,
    options: &'r Options<'r>,
    text: String,
    /// Of each body its name, and whether anything moves it.
    bodies: Vec<(String, bool)>,
    /// Of each joint of the file: its name in the text, and what it is.
    joints: BTreeMap<String, (String, Kind)>,
    /// What the value of each joint is called: a coordinate, or a `let` of one that follows another.
    names: Names,
}

/// Of body number i, joint number k.
type Names = BTreeMap<(usize, usize), String>;

/// Writes a robot; what cannot be written is noted.
pub(super) fn text(
    robot: &Robot,
    file: &str,
    format: &str,
    options: &Options<'_>,
    reader: &mut Reader,
) -> Option<String> {
    let mut identifiers = Identifiers::new();
    let is_word = options.is_word;
    let (mut names, mut joints) = (Names::new(), BTreeMap::new());
    for (i, body) in robot.bodies.iter().enumerate() {
        for (k, joint) in body.joints.iter().enumerate() {
            let name = identifiers.claim("the joint", &joint.name, "joint", suffixes(joint), is_word);
            names.insert((i, k), name.clone());
            joints.insert(joint.name.clone(), (name, joint.kind));
        }
    }
    let mut bodies: Vec<(String, bool)> = Vec::new();
    for body in &robot.bodies {
        let name = identifiers.claim("the link", &body.name, "link", &SUFFIXES_OF_LINKS, is_word);
        let moves = !body.joints.is_empty() || body.parent.is_some_and(|parent| bodies[parent].1);
        bodies.push((name, moves));
    }
    let couplings = coupling::names(robot, is_word, &mut identifiers);
    let mut writer = Writer { robot, options, text: String::new(), bodies, joints, names };
    writer.head(file, format, &identifiers);
    writer.coordinates(reader)?;
    writer.links(reader);
    writer.couplings(&couplings, reader);
    writer.text.push_str("}\n");
    (!reader.errors.has_errors()).then_some(writer.text)
}

/// What is declared behind the name of a joint.
#[rustfmt::skip]
fn suffixes(joint: &Joint) -> &'static [&'static str] {
    match joint.kind {
        _ if joint.mimic.is_some() => &[
            "_at", "_ref", "_ratio", "_offset", "_damping", "_armature", "_stiffness", "_rest", "_friction", "_slow",
        ],
        Kind::Hinge => &[
            "_at", "_ref", "_torque", "_damping", "_armature", "_stiffness", "_rest", "_dot", "_friction", "_slow",
        ],
        Kind::Slide => &[
            "_at", "_ref", "_force", "_damping", "_armature", "_stiffness", "_rest", "_dot", "_friction", "_slow",
        ],
        Kind::Planar => &[
            "_at", "_x", "_y", "_angle", "_damping_0", "_damping_1", "_armature_0", "_armature_1", "_friction_0",
            "_friction_1", "_slow_0", "_slow_1",
        ],
        Kind::Ball => &["_at", "_torque", "_attitude", "_unit", "_damping", "_armature", "_friction", "_slow"],
        Kind::Free => &[
            "_at", "_place", "_attitude", "_unit", "_damping_0", "_damping_1", "_armature_0", "_armature_1",
            "_friction_0", "_friction_1", "_slow_0", "_slow_1",
        ],
    }
}

const SUFFIXES_OF_LINKS: [&str; 7] = ["_mass", "_com", "_inertia", "_at", "_back_at", "_turning", "_centre"];

macro_rules! line {
    ($writer:expr, $($arguments:tt)*) => {
        // To write to a string does not fail.
        let _ = writeln!($writer.text, $($arguments)*);
    };
}
use line;

impl Writer<'_> {
    fn head(&mut self, file: &str, format: &str, identifiers: &Identifiers) {
        let robot = self.robot;
        line!(self, "// Imported from {}, {format}. Lengths are in m, angles in rad, masses in kg.", quoted(file));
        for note in &robot.notes {
            line!(self, "// {}", quoted_note(note));
        }
        for (what, name) in &identifiers.changed {
            line!(self, "// {} is `{name}`.", quoted_note(what));
        }
        line!(self, "\n/// The robot `{}`.", quoted(&robot.name));
        line!(self, "mechanism {} {{", of_mechanism(&robot.name));
        let has_weight = |(body, (_, moves)): (&Body, &(String, bool))| {
            *moves && !body.is_weightless && body.inertial.as_ref().is_some_and(|inertial| !inertial.is_nothing())
        };
        match robot.gravity {
            [0.0, 0.0, 0.0] => {
                line!(self, "    // No gravity.");
            }
            _ if !robot.bodies.iter().zip(&self.bodies).any(has_weight) => {
                line!(self, "    // Gravity acts on no link that moves.");
            }
            [0.0, 0.0, z] if z < 0.0 => {
                line!(self, "    /// Acceleration of gravity.\n    param g: m/s^2 = {};", shown(-z));
                line!(self, "    gravity [0, 0, -g];");
            }
            vector => {
                line!(self, "    /// Acceleration of gravity.\n    param g[3]: m/s^2 = {};", listed(&vector));
                line!(self, "    gravity g;");
            }
        }
    }

    // ---- coordinates

    fn coordinates(&mut self, reader: &mut Reader) -> Option<()> {
        line!(self, "\n    // ---- joints");
        let robot = self.robot;
        for (i, body) in robot.bodies.iter().enumerate() {
            for (k, joint) in body.joints.iter().enumerate().filter(|(_, joint)| joint.mimic.is_none()) {
                self.coordinate(body, &self.names[&(i, k)].clone(), joint);
            }
        }
        self.mimics(reader)
    }

    fn coordinate(&mut self, body: &Body, name: &str, joint: &Joint) {
        let parent =
            body.parent.map_or("the world".to_string(), |p| format!("`{}`", quoted(&self.robot.bodies[p].name)));
        let limits = if joint.limits.is_empty() { String::new() } else { format!("; {}", joint.limits) };
        let (word, of) = (quoted(&joint.word), quoted(&joint.name));
        line!(self, "\n    /// Joint `{of}`, {word}, from {parent} to `{}`{limits}.", quoted(&body.name));
        match joint.kind {
            Kind::Hinge => {
                line!(self, "    coord {name}: rad;\n    input {name}_torque: N*m;");
            }
            Kind::Slide => {
                line!(self, "    coord {name}: m;\n    input {name}_force: N;");
            }
            Kind::Planar => {
                line!(self, "    coord {name}_x: m;\n    coord {name}_y: m;\n    coord {name}_angle: rad;");
            }
            Kind::Ball if self.options.angles => {
                line!(
                    self,
                    "    /// Yaw, pitch, roll: singular at a pitch of 90 degrees.\n    coord {name}_attitude[3]: rad;"
                );
            }
            Kind::Ball => {
                line!(self, "    /// A unit quaternion, scalar part first.\n    coord {name}_attitude[4]: 1;");
            }
            Kind::Free => {
                line!(self, "    coord {name}_place[3]: m;");
                if self.options.angles {
                    line!(
                        self,
                        "    /// Yaw, pitch, roll: singular at a pitch of 90 degrees.\n    coord {name}_attitude[3]: rad;"
                    );
                } else {
                    line!(self, "    /// A unit quaternion, scalar part first.\n    coord {name}_attitude[4]: 1;");
                }
            }
        }
        if joint.kind == Kind::Ball {
            line!(self, "    /// Torque of the joint `{of}`, in the axes of `{}`.", quoted(&body.name));
            line!(self, "    input {name}_torque[3]: N*m;");
        }
    }

    /// Joints that follow others: each behind the one that it follows.
    fn mimics(&mut self, reader: &mut Reader) -> Option<()> {
        let robot = self.robot;
        let mut waiting: Vec<((usize, usize), &Joint)> = Vec::new();
        for (i, body) in robot.bodies.iter().enumerate() {
            waiting.extend(body.joints.iter().enumerate().filter(|(_, j)| j.mimic.is_some()).map(|(k, j)| ((i, k), j)));
        }
        let mut pending: Vec<&str> = waiting.iter().map(|(_, joint)| joint.name.as_str()).collect();
        while !waiting.is_empty() {
            let before = waiting.len();
            for (at, joint) in std::mem::take(&mut waiting) {
                let Some(mimic) = &joint.mimic else { continue };
                let Some((other, kind)) = self.joints.get(&mimic.joint).cloned() else {
                    let message =
                        format!("the joint `{}` follows `{}`, which is no joint that moves", joint.name, mimic.joint);
                    reader.refuse(mimic.span.clone(), message, "");
                    return None;
                };
                if !matches!((joint.kind, kind), (Kind::Hinge | Kind::Slide, Kind::Hinge | Kind::Slide)) {
                    let message = format!(
                        "the joint `{}` cannot follow `{}`: both have to turn or slide",
                        joint.name, mimic.joint
                    );
                    reader.refuse(mimic.span.clone(), message, "");
                    return None;
                }
                if pending.contains(&mimic.joint.as_str()) {
                    waiting.push((at, joint));
                    continue;
                }
                pending.retain(|name| *name != joint.name);
                let name = self.names[&at].clone();
                let [unit, of] = [joint.kind, kind].map(|kind| if kind == Kind::Slide { "m" } else { "1" });
                let ratio = match (unit, of) {
                    ("m", "1") => "m",
                    ("1", "m") => "1/m",
                    _ => "1",
                };
                line!(
                    self,
                    "\n    // Joint `{}`, {}, follows `{}`.",
                    quoted(&joint.name),
                    quoted(&joint.word),
                    quoted(&mimic.joint)
                );
                line!(self, "    const {name}_ratio: {ratio} = {};", shown(mimic.factor));
                line!(self, "    const {name}_offset: {unit} = {};", shown(mimic.offset));
                line!(self, "    let {name} = {name}_ratio*{other} + {name}_offset;");
            }
            if waiting.len() == before {
                let (_, joint) = waiting[0];
                let message = format!("the joint `{}` follows itself, by way of others", joint.name);
                reader.refuse(joint.span.clone(), message, "one joint of the circle has a coordinate of its own");
                return None;
            }
        }
        Some(())
    }

    // ---- links

    fn links(&mut self, reader: &mut Reader) {
        line!(self, "\n    // ---- links");
        for number in 0..self.robot.bodies.len() {
            self.link(number, reader);
        }
    }

    fn link(&mut self, number: usize, reader: &mut Reader) {
        let (robot, body) = (self.robot, &self.robot.bodies[number]);
        let (name, moves) = self.bodies[number].clone();
        let by = match (&body.fixed_by, body.parent) {
            (Some(joint), _) => format!(", fixed by `{}`", quoted(joint)),
            (None, Some(parent)) if body.joints.is_empty() => {
                format!(", fixed to `{}`", quoted(&robot.bodies[parent].name))
            }
            (None, None) if body.joints.is_empty() => ", at rest".to_string(),
            _ => String::new(),
        };
        line!(self, "\n    // Link `{}`{by}.", quoted(&body.name));
        for note in &body.notes {
            line!(self, "    // {}", quoted_note(note));
        }
        let pose = self.pose(number);
        line!(self, "    let {name} = {pose};");
        if let Some(inertial) = &body.inertial {
            self.mass(&name, moves, inertial, body.is_weightless);
        }
        for (k, joint) in body.joints.iter().enumerate() {
            let joint_name = self.names[&(number, k)].clone();
            self.effects(&joint_name, joint, reader);
        }
        for shape in &body.shapes {
            self.shape(&name, shape, reader);
        }
    }

    /// The pose of a body, and before it what that is made of.
    fn pose(&mut self, number: usize) -> String {
        let body = &self.robot.bodies[number];
        let name = self.bodies[number].0.clone();
        let mut pose = body.parent.map_or("world".to_string(), |parent| self.bodies[parent].0.clone());
        // A joint that moves about a point elsewhere: there, and back behind the last of the joints.
        let is_from_parent = body.joints.first().is_some_and(|joint| joint.kind == Kind::Free && !joint.is_from_pose);
        let mut fixed = if is_from_parent { Pose::default() } else { body.pose };
        let mut at = if body.joints.len() == 1 { self.names[&(number, 0)].clone() } else { name.clone() };
        for (k, joint) in body.joints.iter().enumerate() {
            let here = Pose { shift: joint.anchor, ..Pose::default() };
            fixed = fixed.then(&here);
            if body.joints.len() > 1 {
                at.clone_from(&self.names[&(number, k)]);
            }
            pose += &self.fixed(&at, &fixed);
            pose += &self.moving(&self.names[&(number, k)].clone(), joint);
            fixed = Pose { shift: joint.anchor.map(|c| -c), ..Pose::default() };
        }
        pose += &self.fixed(&format!("{name}{}", if body.joints.is_empty() { "" } else { "_back" }), &fixed);
        pose.strip_prefix("world * ").map(str::to_string).unwrap_or(pose)
    }

    /// A shift and a turn as factors.
    fn fixed(&mut self, name: &str, pose: &Pose) -> String {
        let mut text = String::new();
        if pose.shift != [0.0; 3] {
            line!(self, "    const {name}_at[3]: m = {};", listed(&pose.shift));
            text += &format!(" * translation({name}_at)");
        }
        text + &factors(pose)
    }

    /// The motion of a joint as factors.
    fn moving(&mut self, name: &str, joint: &Joint) -> String {
        let value = match (joint.zero == 0.0, joint.kind) {
            (false, Kind::Hinge | Kind::Slide) => {
                let unit = if joint.kind == Kind::Slide { "m" } else { "rad" };
                line!(self, "    const {name}_ref: {unit} = {};", shown(joint.zero));
                format!("{name} - {name}_ref")
            }
            _ => name.to_string(),
        };
        let negative = |value: &str| if value.contains(' ') { format!("-({value})") } else { format!("-{value}") };
        match joint.kind {
            Kind::Hinge => match coordinate_axis(joint.axis) {
                Some(k) if k > 0 => format!(" * rot_{}({value})", AXES[k as usize - 1]),
                Some(k) => format!(" * rot_{}({})", AXES[(-k) as usize - 1], negative(&value)),
                None => format!(" * rotation({}, {value})", listed(&joint.axis)),
            },
            Kind::Slide => {
                let length = norm(&joint.axis);
                let signed = coordinate_axis(joint.axis);
                let factor = if value.contains(' ') { format!("({value})") } else { value.clone() };
                let part = |i: usize| match (joint.axis[i] / length, signed) {
                    (_, Some(k)) if k.unsigned_abs() as usize == i + 1 => {
                        if k > 0 {
                            value.clone()
                        } else {
                            negative(&value)
                        }
                    }
                    (_, Some(_)) | (0.0, None) => "0".to_string(),
                    (c, None) => format!("{}*{factor}", shown(c)),
                };
                format!(" * translation([{}, {}, {}])", part(0), part(1), part(2))
            }
            Kind::Planar => {
                let turn = from_z(joint.axis);
                // In the plane along the axes that x and y are turned to.
                let (u, v) = (turned(&turn, [1.0, 0.0, 0.0]), turned(&turn, [0.0, 1.0, 0.0]));
                let part = |i: usize| {
                    let terms: Vec<String> = [(u[i], format!("{name}_x")), (v[i], format!("{name}_y"))]
                        .into_iter()
                        .filter(|(c, _)| *c != 0.0)
                        .map(|(c, of)| match c {
                            1.0 => of,
                            -1.0 => format!("-{of}"),
                            _ => format!("{}*{of}", shown(c)),
                        })
                        .collect();
                    if terms.is_empty() { "0".to_string() } else { terms.join(" + ") }
                };
                let places = format!(" * translation([{}, {}, {}])", part(0), part(1), part(2));
                let angle = Joint { kind: Kind::Hinge, zero: 0.0, ..joint.clone() };
                places + &self.moving(&format!("{name}_angle"), &angle)
            }
            Kind::Ball => self.attitude(name),
            Kind::Free => format!(" * translation({name}_place){}", self.attitude(name)),
        }
    }

    fn attitude(&self, name: &str) -> String {
        if self.options.angles {
            let angle = |axis: char, i: usize| format!(" * rot_{axis}({name}_attitude[{i}])");
            angle('z', 0) + &angle('y', 1) + &angle('x', 2)
        } else {
            format!(" * quaternion({name}_attitude)")
        }
    }

    fn mass(&mut self, name: &str, moves: bool, inertial: &Inertial, is_weightless: bool) {
        let Inertial { mass, com, inertia, .. } = inertial;
        if !moves {
            line!(self, "    // It does not move: its {} kg are in no energy.", shown(*mass));
            return;
        }
        if inertial.is_nothing() {
            line!(self, "    // It has no mass.");
            return;
        }
        let word = if self.options.parameters { "param" } else { "const" };
        line!(self, "    {word} {name}_mass: kg = {};", shown(*mass));
        line!(self, "    {word} {name}_com[3]: m = {};", listed(com));
        let particle = if is_weightless {
            line!(self, "    // Gravity does not act on it: by its motion, on which none does.");
            line!(self, "    let {name}_centre = {name}.point({name}_com);");
            format!("1/2*{name}_mass*dt({name}_centre).norm_squared()")
        } else {
            format!("particle({name}_mass, {name}.point({name}_com))")
        };
        if inertia.iter().all(|&entry| entry == 0.0) {
            line!(self, "    kinetic += {particle};");
            return;
        }
        let (shown, what) = match inertia {
            [xx, yy, zz, 0.0, 0.0, 0.0] if !self.options.parameters => (vec![*xx, *yy, *zz], "xx, yy, zz"),
            all => (all.to_vec(), "xx, yy, zz, xy, xz, yz"),
        };
        line!(
            self,
            "    {word} {name}_inertia[{}]: kg*m^2 = {}; // {what}, about the mass centre",
            shown.len(),
            listed(&shown)
        );
        if inertial.is_possible() && !is_weightless {
            line!(self, "    kinetic += rigid_body({name}_mass, {name}_com, inertia({name}_inertia), {name});");
            return;
        }
        if !inertial.is_possible() {
            line!(self, "    // No body has this inertia: by its motion, which asks nothing of it.");
        }
        line!(self, "    kinetic += {particle};");
        line!(self, "    let {name}_turning = angular_velocity({name});");
        line!(self, "    kinetic += 1/2*{name}_turning.dot(({name}*inertia({name}_inertia))*{name}_turning);");
    }

    // ---- shapes

    fn shape(&mut self, name: &str, shape: &Shape, reader: &mut Reader) {
        let mut pose = name.to_string();
        if shape.pose.shift != [0.0; 3] {
            let numbers: Vec<String> = shape
                .pose
                .shift
                .iter()
                .map(|&c| if c == 0.0 { "0".to_string() } else { format!("{} m", shown(c)) })
                .collect();
            pose += &format!(" * translation([{}])", numbers.join(", "));
        }
        pose += &factors(&shape.pose);
        let metres =
            |numbers: &[f64]| numbers.iter().map(|&n| format!("{} m", shown(n))).collect::<Vec<_>>().join(", ");
        let is_drawn = |sizes: &[f64]| sizes.iter().all(|&size| size > 0.0);
        match &shape.form {
            Form::Box(edges) if is_drawn(edges) => {
                line!(self, "    shape {pose} += box([{}]);", metres(edges));
            }
            Form::Cylinder(radius, length) if is_drawn(&[*radius, *length]) => {
                line!(self, "    shape {pose} += cylinder({});", metres(&[*radius, *length]));
            }
            Form::Sphere(radius) if is_drawn(&[*radius]) => {
                line!(self, "    shape {pose} += sphere({});", metres(&[*radius]));
            }
            Form::Capsule(radius, length) if is_drawn(&[*radius, *length]) => {
                line!(self, "    shape {pose} += cylinder({});", metres(&[*radius, *length]));
                for end in [-0.5, 0.5] {
                    let centre = format!("{pose} * translation([0, 0, {} m])", shown(end * length));
                    line!(self, "    shape {centre} += sphere({});", metres(&[*radius]));
                }
            }
            Form::Mesh(path, scale, span) => {
                let scaled = match scale {
                    [1.0, 1.0, 1.0] => String::new(),
                    [x, y, z] if x == y && y == z => format!(", {}", shown(*x)),
                    all => format!(", {}", listed(all)),
                };
                match (self.options.find)(path) {
                    Some(found)
                        if is_drawn(scale) && !found.contains(['"', '\\']) && !found.contains(char::is_control) =>
                    {
                        line!(self, "    shape {pose} += mesh(\"{found}\"{scaled});");
                    }
                    _ => {
                        let message = format!("the mesh `{}` of the link `{name}` is not drawn", quoted(path));
                        let help = match is_drawn(scale) {
                            true => {
                                "it is not there: its path is seen from the folder of the file, `package://` from the folders above it"
                            }
                            false => "it is scaled by a factor that is not positive",
                        };
                        reader.warn(span.clone(), message, help);
                        line!(self, "    // The mesh `{}` is not drawn: it is not there, or mirrored.", quoted(path));
                    }
                }
            }
            Form::Box(_) | Form::Cylinder(..) | Form::Sphere(_) | Form::Capsule(..) => {
                line!(self, "    // A shape without size is not drawn.");
            }
        }
    }
}

const AXES: [char; 3] = ['x', 'y', 'z'];

/// A note as one line of a comment; names in it are quoted already.
fn quoted_note(note: &str) -> String {
    note.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// Where a body is in the world while all joints are at zero.
pub(super) fn at_rest(robot: &Robot, body: Option<usize>) -> Pose {
    let (mut way, mut at) = (Vec::new(), body);
    while let Some(number) = at {
        way.push(robot.bodies[number].pose);
        at = robot.bodies[number].parent;
    }
    way.into_iter().rev().fold(Pose::default(), |pose, next| pose.then(&next))
}

/// A place given in one body, in the frame of another, while all joints are at zero.
pub(super) fn carried(robot: &Robot, from: Option<usize>, place: [f64; 3], to: Option<usize>) -> [f64; 3] {
    let world = at_rest(robot, from).point(place);
    let back = at_rest(robot, to).inverse();
    plus(back.shift, turned(&back.turn, world))
}
