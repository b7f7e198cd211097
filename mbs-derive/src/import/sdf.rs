//! SDF, the format of Gazebo: one model, its links and joints; `file`: which model, what is left out, frames; `link`:
//! poses, what links weigh and look like.
//!
//! Poses of links are in the frame of the model, those of joints in the frame of their child, unless `relative_to` says
//! otherwise; axes are in the frame of the joint, unless `expressed_in` does.
//!
//! Source: *SDFormat specification* 1.6 to 1.11, `sdf/*.sdf` of the library sdformat.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::identifier::spare;
use super::pose::{Pose, transposed, turned};
use super::robot::{Body, Joint, Kind, Mimic, Robot, Shape};
use super::xml::{Reader, child, children, content, place, tag};
use link::{inertia, is_true, pose_of, relative_to, shape};

mod file;
mod link;

/// Gravity of a world that states none, m/s².
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.8];

/// A limit of this size or more is no limit: SDF writes 1e16 where a joint goes on for ever.
const ENDLESS: f64 = 1e15;

/// A model, its links in the frame of the model.
struct Model<'a, 'i> {
    links: Vec<Node<'a, 'i>>,
    names: BTreeMap<&'a str, usize>,
    /// Of each frame of the model the link that it moves with.
    carriers: BTreeMap<&'a str, usize>,
    /// Where the model is in the world.
    pose: Pose,
    /// Places of links, frames and joints by their names, in the frame of the model.
    poses: BTreeMap<&'a str, Pose>,
    /// Poses of joints as they are stated.
    joints: BTreeMap<&'a str, Pose>,
    /// Of each joint the names of its coordinates: one, or two where it turns about two axes.
    coordinates: BTreeMap<&'a str, Vec<String>>,
}

/// A robot; what is wrong is noted.
pub(super) fn robot(root: Node<'_, '_>, reader: &mut Reader) -> Option<Robot> {
    let version = root.attribute("version").and_then(|version| version.trim().parse::<f64>().ok());
    // 1.10 and 1.11 are later ones.
    let is_old = version.is_some_and(|version| version < 1.5)
        && !root.attribute("version").is_some_and(|v| v.starts_with("1.1"));
    if is_old {
        let message = "versions of SDF before 1.5, which state axes in the frame of the model, are not imported";
        reader.refuse(place(root, "version"), message, "`gz sdf -p model.sdf` writes the current one");
    }
    let world = child(root, "world");
    let (model, still) = file::model(root, world, reader)?;
    for name in ["include", "model"] {
        if let Some(inner) = child(model, name) {
            reader.refuse(
                tag(inner),
                format!("`{name}` in a model is not imported"),
                "write its links and joints into the model",
            );
        }
    }
    if let Some(joint) = world.and_then(|world| child(world, "joint")) {
        let help = "write it into the model, whose joints may have the parent `world`";
        reader.refuse(tag(joint), "a joint outside of the model is not imported", help);
    }
    if let Some(node) = child(model, "static").filter(|node| is_true(*node, reader)) {
        let message = format!("the model `{}` is static: nothing of it moves", model.attribute("name").unwrap_or(""));
        reader.refuse(tag(node), message, "leave out `<static>`");
    }
    let gravity = world.and_then(|world| child(world, "gravity")).and_then(|node| reader.content(node, "gravity"));
    let mut robot = Robot {
        name: model.attribute("name").unwrap_or("model").to_string(),
        gravity: gravity.unwrap_or(GRAVITY),
        ..Robot::default()
    };
    robot.notes = file::left_out(world, model, &still);
    let read = Model::of(model, reader)?;
    read.tree(model, &mut robot, reader)?;
    Some(robot)
}

impl<'a, 'i> Model<'a, 'i> {
    fn of(model: Node<'a, 'i>, reader: &mut Reader) -> Option<Self> {
        let links: Vec<Node<'a, 'i>> = children(model, "link").collect();
        let names = reader.named_links(&links);
        if links.is_empty() {
            reader.refuse(tag(model), "the model has no links", "write `<link name=\"…\">…</link>`");
        }
        let coordinates = coordinates(model);
        let (poses, joints) = (BTreeMap::new(), BTreeMap::new());
        let carriers = file::carriers(model, &names);
        let mut read = Model { links, names, carriers, pose: Pose::default(), poses, joints, coordinates };
        read.place(model, reader);
        if reader.errors.has_errors() {
            return None;
        }
        read.pose = read.pose_of_model(model, reader);
        Some(read)
    }

    /// Where the model is in the world: its pose is that of the frame in it that `placement_frame` names.
    fn pose_of_model(&self, model: Node<'a, 'i>, reader: &mut Reader) -> Pose {
        let pose = pose_of(model, "the model", reader);
        if let Some(of) = relative_to(model).filter(|of| *of != "world") {
            let help = "write its pose in the world";
            reader.refuse(tag(model), format!("the model is placed relative to `{of}`, which is not imported"), help);
        }
        let Some(of) = model.attribute("placement_frame").filter(|of| !of.is_empty()) else { return pose };
        match self.frame(of) {
            Some(placed) => pose.then(&placed.inverse()),
            None => {
                let message = format!("the model is placed by `{of}`, which is not there");
                reader.refuse(place(model, "placement_frame"), message, "links, joints and frames of it are known");
                pose
            }
        }
    }

    /// Places of links, frames and joints, each behind what it is relative to; joints are placed in their children.
    fn place(&mut self, model: Node<'a, 'i>, reader: &mut Reader) {
        let mut waiting: Vec<Node<'a, 'i>> = self.links.clone();
        waiting.extend(children(model, "frame"));
        let names: BTreeSet<&str> = waiting.iter().filter_map(|node| node.attribute("name")).collect();
        let child_of = |joint: Node<'a, 'i>| child(joint, "child").map(|node| content(node).trim().to_string());
        let is_placed = |joint: &Node<'a, 'i>| {
            let is_other = joint.attribute("name").is_some_and(|name| !names.contains(name));
            is_other && child_of(*joint).is_some_and(|end| names.contains(end.as_str()))
        };
        waiting.extend(children(model, "joint").filter(is_placed));
        while !waiting.is_empty() {
            let before = waiting.len();
            for node in std::mem::take(&mut waiting) {
                let name = node.attribute("name").unwrap_or_default();
                let link = child_of(node);
                let without = match node.tag_name().name() {
                    "joint" => link.as_deref(),
                    _ => node.attribute("attached_to"),
                };
                let relative = relative_to(node).or(without).filter(|of| !of.is_empty() && *of != "__model__");
                let base = match relative.map(|of| self.poses.get(of)) {
                    None => Pose::default(),
                    Some(Some(base)) => *base,
                    Some(None) => {
                        waiting.push(node);
                        continue;
                    }
                };
                let own = pose_of(node, &format!("`{name}`"), reader);
                self.poses.insert(name, base.then(&own));
                if node.tag_name().name() == "joint" {
                    self.joints.insert(name, own);
                }
            }
            if waiting.len() == before {
                let node = waiting[0];
                let name = node.attribute("name").unwrap_or_default();
                reader.refuse(
                    tag(node),
                    format!("`{name}` is placed relative to what is not there, or to itself"),
                    "links, joints and frames of the model are known",
                );
                return;
            }
        }
    }

    /// Bodies in an order in which each stands behind its parent.
    fn tree(&self, model: Node<'a, 'i>, robot: &mut Robot, reader: &mut Reader) -> Option<()> {
        let joints: Vec<Node<'a, 'i>> = children(model, "joint").collect();
        let mut by: Vec<Option<(Option<usize>, Node<'a, 'i>)>> = vec![None; self.links.len()];
        let mut names = BTreeMap::new();
        for joint in joints {
            let Some(name) = reader.wanted(joint, "name", "this joint") else { continue };
            if names.insert(name, ()).is_some() {
                reader.refuse(place(joint, "name"), format!("a second joint is called `{name}`"), "names are unique");
            }
            let (parent, own) = (self.end(joint, "parent", name, reader), self.end(joint, "child", name, reader));
            let (Some(parent), Some(own)) = (parent, own) else { continue };
            let Some(own) = own else {
                reader.refuse(
                    tag(joint),
                    format!("the child of the joint `{name}` is the world"),
                    "exchange parent and child",
                );
                continue;
            };
            if by[own].is_some() {
                let link = self.links[own].attribute("name").unwrap_or_default();
                let message = format!("the link `{link}` is the child of two joints");
                reader.refuse(tag(joint), message, "close loops by a constraint in a .mbs that imports the file");
            }
            by[own] = Some((parent, joint));
        }
        if reader.errors.has_errors() {
            return None;
        }
        let mut numbers: Vec<Option<usize>> = vec![None; self.links.len()];
        let mut left: Vec<usize> = (0..self.links.len()).collect();
        while !left.is_empty() {
            let before = left.len();
            for link in std::mem::take(&mut left) {
                let parent = match by[link] {
                    Some((Some(parent), _)) if numbers[parent].is_none() => {
                        left.push(link);
                        continue;
                    }
                    Some((parent, _)) => parent,
                    None => None,
                };
                numbers[link] = Some(robot.bodies.len());
                let joint = by[link].map(|(_, joint)| joint);
                let body = self.body(link, parent, parent.and_then(|parent| numbers[parent]), joint, reader);
                robot.bodies.push(body);
            }
            if left.len() == before {
                let link = self.links[left[0]];
                let name = link.attribute("name").unwrap_or_default();
                let message =
                    format!("the joints lead in a circle: the link `{name}` hangs on itself, or on a link that does");
                reader.refuse(tag(link), message, "close loops by a constraint in a .mbs that imports the file");
                return None;
            }
        }
        Some(())
    }

    /// The link at an end of a joint, or that which carries the frame there; nothing within for the world.
    fn end(&self, joint: Node<'a, 'i>, which: &str, name: &str, reader: &mut Reader) -> Option<Option<usize>> {
        let Some(node) = child(joint, which) else {
            reader.refuse(tag(joint), format!("the joint `{name}` has no `{which}`"), "");
            return None;
        };
        let text = content(node);
        let link = text.trim();
        if link == "world" {
            return Some(None);
        }
        let number = self.names.get(link).or(self.carriers.get(link)).copied();
        if number.is_none() {
            reader.refuse(
                tag(node),
                format!("the {which} of the joint `{name}` is `{link}`, which is no link or frame of the model"),
                "",
            );
        }
        number.map(Some)
    }

    fn body(
        &self,
        link: usize,
        parent: Option<usize>,
        number: Option<usize>,
        joint: Option<Node<'a, 'i>>,
        reader: &mut Reader,
    ) -> Body {
        let node = self.links[link];
        let name = node.attribute("name").unwrap_or_default();
        let pose_of_link = |link: usize| {
            self.poses.get(self.links[link].attribute("name").unwrap_or_default()).copied().unwrap_or_default()
        };
        let own = pose_of_link(link);
        let pose = parent.map_or_else(|| self.pose.then(&own), |parent| pose_of_link(parent).inverse().then(&own));
        let shapes = children(node, "visual").filter_map(|visual| {
            let placed = relative_to(visual)
                .map(|of| self.related(of, &own, &format!("a visual of the link `{name}`"), visual, reader));
            let shape = shape(visual, name, reader)?;
            Some(Shape { pose: placed.unwrap_or_default().then(&shape.pose), ..shape })
        });
        let shapes = shapes.collect();
        refuse_motions(node, name, reader);
        let mut body = Body {
            parent: number,
            pose,
            inertial: inertia(node, name, reader),
            is_weightless: child(node, "gravity").is_some_and(|gravity| !is_true(gravity, reader)),
            shapes,
            ..Body::new(name, tag(node))
        };
        match joint {
            Some(joint) => self.moved(&mut body, joint, &own, reader),
            None => {
                let is_taken = |name: &str| self.coordinates.values().flatten().any(|taken| taken == name);
                let name = spare(&format!("{name}_free"), is_taken);
                body.joints.push(Joint::new(&name, Kind::Free, "free", tag(node)));
            }
        }
        body
    }

    fn moved(&self, body: &mut Body, node: Node<'a, 'i>, own: &Pose, reader: &mut Reader) {
        let name = node.attribute("name").unwrap_or_default();
        let Some(word) = reader.wanted(node, "type", &format!("the joint `{name}`")) else { return };
        let kind = match word {
            "fixed" => {
                body.fixed_by = Some(name.to_string());
                return;
            }
            "revolute" | "continuous" => Kind::Hinge,
            "prismatic" => Kind::Slide,
            "ball" => Kind::Ball,
            "universal" | "revolute2" => Kind::Hinge,
            _ => {
                let help =
                    "there are `fixed`, `revolute`, `continuous`, `prismatic`, `ball`, `universal` and `revolute2`";
                reader.refuse(
                    place(node, "type"),
                    format!("the joint `{name}` is of a kind that is not imported, `{word}`"),
                    help,
                );
                return;
            }
        };
        let of_joint = format!("the joint `{name}`");
        let stated = self.joints.get(name).copied();
        let mut here = stated.unwrap_or_else(|| pose_of(node, &of_joint, reader));
        // Of a joint without a frame of its own that of its child, which is the link, or another frame on it.
        let end = child(node, "child").map(content).unwrap_or_default();
        let end = Some(end.trim()).filter(|end| !self.names.contains_key(end));
        if let Some(of) = relative_to(node).or(end) {
            here = self.related(of, own, &of_joint, node, reader).then(&here);
        }
        let axes: &[&str] = match word {
            "universal" | "revolute2" => &["axis", "axis2"],
            "ball" => &[""],
            _ => &["axis"],
        };
        for (axis, coordinate) in axes.iter().zip(&self.coordinates[name]) {
            let mut joint = Joint::new(coordinate, kind, word, tag(node));
            joint.anchor = here.shift;
            if let Some(axis) = child(node, axis) {
                self.axis(&mut joint, axis, &here, own, reader);
            } else if kind != Kind::Ball {
                reader.refuse(
                    tag(node),
                    format!("the joint `{name}` has no `{axis}`"),
                    "write `<axis><xyz>0 0 1</xyz></axis>`",
                );
            }
            body.joints.push(joint);
        }
    }

    /// What is placed relative to `of`, in the frame of the body at `own`: the frame `of`.
    fn related(&self, of: &str, own: &Pose, what: &str, node: Node<'a, 'i>, reader: &mut Reader) -> Pose {
        match self.frame(of) {
            Some(base) => own.inverse().then(&base),
            None => {
                let message = format!("{what} is placed relative to `{of}`, which is not there");
                reader.refuse(tag(node), message, "");
                Pose::default()
            }
        }
    }

    fn frame(&self, name: &str) -> Option<Pose> {
        if name == "__model__" { Some(Pose::default()) } else { self.poses.get(name).copied() }
    }

    fn axis(&self, joint: &mut Joint, node: Node<'a, 'i>, here: &Pose, own: &Pose, reader: &mut Reader) {
        let name = joint.name.clone();
        let mut number = |parent: Node<'_, '_>, what: &str| {
            let node = child(parent, what)?;
            reader.content::<1>(node, &format!("`{what}` of the joint `{name}`")).map(|[number]| number)
        };
        if let Some(dynamics) = child(node, "dynamics") {
            joint.damping = number(dynamics, "damping").unwrap_or(0.0);
            joint.friction = number(dynamics, "friction").unwrap_or(0.0);
            joint.stiffness = number(dynamics, "spring_stiffness").unwrap_or(0.0);
            joint.rest = number(dynamics, "spring_reference").unwrap_or(0.0);
        }
        if let Some(limit) = child(node, "limit") {
            joint.limits = limits(&name, joint.kind, limit, reader);
        }
        if [joint.damping, joint.friction, joint.stiffness].iter().any(|&number| number < 0.0) {
            let message = format!("the joint `{name}` has negative damping, friction or stiffness");
            reader.refuse(tag(node), message, "");
        }
        self.mimicked(joint, node, reader);
        let xyz = child(node, "xyz");
        let stated = xyz.map(|xyz| reader.content::<3>(xyz, &format!("the axis of the joint `{name}`")));
        let Some(axis) = stated.unwrap_or(Some(joint.axis)) else { return };
        let of_model = |base: &Pose| turned(&transposed(&own.turn), turned(&base.turn, axis));
        let in_model_frame = child(node, "use_parent_model_frame").is_some_and(|node| is_true(node, reader));
        joint.axis = match xyz.and_then(|xyz| xyz.attribute("expressed_in")).filter(|of| !of.is_empty()) {
            None if in_model_frame => of_model(&Pose::default()),
            None => turned(&here.turn, axis),
            Some(of) => match self.frame(of) {
                Some(base) => of_model(&base),
                None => {
                    reader.refuse(
                        xyz.map_or(tag(node), |xyz| place(xyz, "expressed_in")),
                        format!("the axis of the joint `{name}` is expressed in `{of}`, which is not there"),
                        "",
                    );
                    axis
                }
            },
        };
    }

    /// `multiplier*(other − reference) + offset`.
    fn mimicked(&self, joint: &mut Joint, node: Node<'a, 'i>, reader: &mut Reader) {
        let Some(mimic) = child(node, "mimic") else { return };
        let name = joint.name.clone();
        let Some(other) = reader.wanted(mimic, "joint", &format!("the mimic of the joint `{name}`")) else { return };
        let mut number = |what: &str, without: f64| {
            let Some(node) = child(mimic, what) else { return without };
            reader.content::<1>(node, &format!("the {what} of the joint `{name}`")).map_or(without, |[number]| number)
        };
        let (factor, offset, reference) = (number("multiplier", 1.0), number("offset", 0.0), number("reference", 0.0));
        // A joint of two axes has two coordinates.
        let of_other = self.coordinates.get(other).map_or(&[][..], Vec::as_slice);
        let followed = match of_other {
            [_, second] if mimic.attribute("axis") == Some("axis2") => second,
            [first, ..] => first,
            [] => other,
        };
        let offset = offset - factor * reference;
        joint.mimic = Some(Mimic { joint: followed.to_string(), factor, offset, span: tag(mimic) });
    }
}

/// Of each joint the names of its coordinates, of which no two are alike.
fn coordinates<'a>(model: Node<'a, '_>) -> BTreeMap<&'a str, Vec<String>> {
    let joints = || model.children().filter(|node| node.is_element() && node.tag_name().name() == "joint");
    let mut taken: BTreeSet<String> =
        joints().filter_map(|joint| joint.attribute("name")).map(str::to_string).collect();
    let mut names = BTreeMap::new();
    for joint in joints() {
        let Some(name) = joint.attribute("name") else { continue };
        let own = match joint.attribute("type") {
            Some("universal" | "revolute2") => ["_1", "_2"]
                .map(|suffix| {
                    let name = spare(&format!("{name}{suffix}"), |name| taken.contains(name));
                    taken.insert(name.clone());
                    name
                })
                .to_vec(),
            _ => vec![name.to_string()],
        };
        names.insert(name, own);
    }
    names
}

/// What the text says of the limits of a joint. What is infinite is no limit: so Gazebo writes what goes on for ever.
fn limits(name: &str, kind: Kind, node: Node<'_, '_>, reader: &mut Reader) -> String {
    let mut limit = |what: &str| {
        let node = child(node, what)?;
        let word = content(node).trim().to_ascii_lowercase();
        if matches!(word.trim_start_matches(['+', '-']), "inf" | "infinity") {
            return None;
        }
        let [number] = reader.content::<1>(node, &format!("`{what}` of the joint `{name}`"))?;
        (number.abs() < ENDLESS).then_some(number)
    };
    let (way, force) = if kind == Kind::Slide { ("m", "N") } else { ("rad", "N·m") };
    let mut parts = Vec::new();
    match (limit("lower"), limit("upper")) {
        (Some(low), Some(high)) => parts.push(format!("from {low} to {high} {way}")),
        (Some(low), None) => parts.push(format!("at least {low} {way}")),
        (None, Some(high)) => parts.push(format!("at most {high} {way}")),
        (None, None) => {}
    }
    let mut above_zero = |what: &str| limit(what).filter(|most| *most > 0.0);
    parts.extend(above_zero("effort").map(|effort| format!("at most {effort} {force}")));
    parts.extend(above_zero("velocity").map(|rate| format!("{rate} {way}/s")));
    parts.join(", ")
}

/// What moves a link besides joints and gravity.
fn refuse_motions(link: Node<'_, '_>, name: &str, reader: &mut Reader) {
    if let Some(node) = child(link, "kinematic").filter(|node| is_true(*node, reader)) {
        let message = format!("the link `{name}` is `kinematic`: forces do not move it, which is not imported");
        reader.refuse(tag(node), message, "leave it out, or fix the link by a joint");
    }
    let Some(decay) = child(link, "velocity_decay") else { return };
    for what in ["linear", "angular"] {
        let rate =
            child(decay, what).and_then(|node| reader.content::<1>(node, &format!("`{what}` of `velocity_decay`")));
        if rate.is_some_and(|[rate]| rate != 0.0) {
            let message = format!("the link `{name}` is slowed by `velocity_decay`, which is not imported");
            reader.refuse(tag(decay), message, "leave it out, and write it as a dissipation beside the import");
        }
    }
}
