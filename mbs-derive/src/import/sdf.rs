//! SDF, the format of Gazebo: one model, its links and joints.
//!
//! Poses of links are in the frame of the model, those of joints in the frame of their child, unless `relative_to` says
//! otherwise; axes are in the frame of the joint, unless `expressed_in` does.
//!
//! Source: *SDFormat specification* 1.6 to 1.11, `sdf/*.sdf` of the library sdformat.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::Node;

use super::pose::{Pose, transposed, turned, turned_inertia};
use super::robot::{Body, Form, Inertial, Joint, Kind, Mimic, Robot, Shape};
use super::xml::{Reader, child, children, place, tag};

/// Gravity of a world that states none, m/s².
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.8];

/// A limit of this size or more is no limit: SDF writes 1e16 where a joint goes on for ever.
const ENDLESS: f64 = 1e15;

/// A model, its links in the frame of the model.
struct Model<'a, 'i> {
    links: Vec<Node<'a, 'i>>,
    names: BTreeMap<&'a str, usize>,
    /// Places of links and of frames by their names.
    poses: BTreeMap<&'a str, Pose>,
    /// The names of joints that turn about two axes.
    two_axes: BTreeSet<&'a str>,
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
    let mut models: Vec<Node<'_, '_>> = children(root, "model").collect();
    models.extend(world.into_iter().flat_map(|world| children(world, "model")));
    let model = match models.as_slice() {
        [one] => *one,
        [] => {
            reader.refuse(tag(root), "there is no model in this file", "write `<model name=\"…\">…</model>`");
            return None;
        }
        [_, second, ..] => {
            reader.refuse(
                tag(*second),
                "there is a second model in this file",
                "a mechanism has one robot: put each in a file of its own",
            );
            return None;
        }
    };
    for name in ["include", "model"] {
        if let Some(inner) = child(model, name) {
            reader.refuse(
                tag(inner),
                format!("`{name}` in a model is not imported"),
                "write its links and joints into the model",
            );
        }
    }
    let gravity = world.and_then(|world| child(world, "gravity")).and_then(|node| reader.content(node, "gravity"));
    let mut robot = Robot {
        name: model.attribute("name").unwrap_or("model").to_string(),
        gravity: gravity.unwrap_or(GRAVITY),
        ..Robot::default()
    };
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
        let is_of_two = |joint: &Node<'a, 'i>| matches!(joint.attribute("type"), Some("universal" | "revolute2"));
        let two_axes = children(model, "joint").filter(is_of_two).filter_map(|joint| joint.attribute("name")).collect();
        let mut read = Model { links, names, poses: BTreeMap::new(), two_axes };
        read.place(model, reader);
        (!reader.errors.has_errors()).then_some(read)
    }

    /// Places of links and frames, each behind what it is relative to.
    fn place(&mut self, model: Node<'a, 'i>, reader: &mut Reader) {
        let mut waiting: Vec<Node<'a, 'i>> = self.links.clone();
        waiting.extend(children(model, "frame"));
        while !waiting.is_empty() {
            let before = waiting.len();
            for node in std::mem::take(&mut waiting) {
                let name = node.attribute("name").unwrap_or_default();
                let relative = child(node, "pose").and_then(|pose| pose.attribute("relative_to"));
                let relative =
                    relative.or(node.attribute("attached_to")).filter(|of| !of.is_empty() && *of != "__model__");
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
            }
            if waiting.len() == before {
                let node = waiting[0];
                let name = node.attribute("name").unwrap_or_default();
                reader.refuse(
                    tag(node),
                    format!("`{name}` is placed relative to what is not there, or to itself"),
                    "links and frames of the model are known",
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
        let is_static = child(model, "static")
            .and_then(|node| node.text())
            .is_some_and(|text| ["true", "1"].contains(&text.trim()));
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
                let body = self.body(link, parent, parent.and_then(|parent| numbers[parent]), joint, is_static, reader);
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

    /// The link at an end of a joint; nothing within for the world.
    fn end(&self, joint: Node<'a, 'i>, which: &str, name: &str, reader: &mut Reader) -> Option<Option<usize>> {
        let Some(node) = child(joint, which) else {
            reader.refuse(tag(joint), format!("the joint `{name}` has no `{which}`"), "");
            return None;
        };
        let link = node.text().unwrap_or_default().trim();
        if link == "world" {
            return Some(None);
        }
        let number = self.names.get(link).copied();
        if number.is_none() {
            reader.refuse(
                tag(node),
                format!("the {which} of the joint `{name}` is the link `{link}`, which is not there"),
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
        is_static: bool,
        reader: &mut Reader,
    ) -> Body {
        let node = self.links[link];
        let name = node.attribute("name").unwrap_or_default();
        let pose_of_link = |link: usize| {
            self.poses.get(self.links[link].attribute("name").unwrap_or_default()).copied().unwrap_or_default()
        };
        let own = pose_of_link(link);
        let pose = parent.map_or(own, |parent| pose_of_link(parent).inverse().then(&own));
        let mut body = Body {
            name: name.to_string(),
            parent: number,
            pose,
            joints: Vec::new(),
            fixed_by: None,
            inertial: child(node, "inertial").and_then(|inertial| inertia(inertial, name, reader)),
            is_weightless: false,
            shapes: children(node, "visual").filter_map(|visual| shape(visual, name, reader)).collect(),
            notes: Vec::new(),
            span: tag(node),
        };
        match joint {
            Some(joint) => self.moved(&mut body, joint, &own, reader),
            None if is_static => {}
            None => body.joints.push(Joint::new(&format!("{name}_free"), Kind::Free, "free", tag(node))),
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
        let mut here = pose_of(node, &format!("the joint `{name}`"), reader);
        if let Some(of) = child(node, "pose").and_then(|pose| pose.attribute("relative_to")).filter(|of| !of.is_empty())
        {
            match self.frame(of) {
                Some(base) => here = own.inverse().then(&base.then(&here)),
                None => reader.refuse(
                    tag(node),
                    format!("the joint `{name}` is placed relative to `{of}`, which is not there"),
                    "",
                ),
            }
        }
        let axes: &[(&str, &str)] = match word {
            "universal" | "revolute2" => &[("axis", "_1"), ("axis2", "_2")],
            "ball" => &[("", "")],
            _ => &[("axis", "")],
        };
        for (axis, suffix) in axes {
            let mut joint = Joint::new(&format!("{name}{suffix}"), kind, word, tag(node));
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
            let (way, force) = if joint.kind == Kind::Slide { ("m", "N") } else { ("rad", "N·m") };
            let (low, high) = (number(limit, "lower"), number(limit, "upper"));
            let mut parts = Vec::new();
            if let (Some(low), Some(high)) = (low, high)
                && low > -ENDLESS
                && high < ENDLESS
            {
                parts.push(format!("from {low} to {high} {way}"));
            }
            parts.extend(
                number(limit, "effort")
                    .filter(|effort| *effort > 0.0)
                    .map(|effort| format!("at most {effort} {force}")),
            );
            parts.extend(number(limit, "velocity").filter(|rate| *rate > 0.0).map(|rate| format!("{rate} {way}/s")));
            joint.limits = parts.join(", ");
        }
        self.mimicked(joint, node, reader);
        let Some(xyz) = child(node, "xyz") else { return };
        let Some(axis) = reader.content::<3>(xyz, &format!("the axis of the joint `{name}`")) else { return };
        let of_model = |base: &Pose| turned(&transposed(&own.turn), turned(&base.turn, axis));
        let in_model_frame = child(node, "use_parent_model_frame")
            .and_then(|node| node.text())
            .is_some_and(|text| ["true", "1"].contains(&text.trim()));
        joint.axis = match xyz.attribute("expressed_in").filter(|of| !of.is_empty()) {
            None if in_model_frame => of_model(&Pose::default()),
            None => turned(&here.turn, axis),
            Some(of) => match self.frame(of) {
                Some(base) => of_model(&base),
                None => {
                    reader.refuse(
                        place(xyz, "expressed_in"),
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
        let suffix = match (mimic.attribute("axis"), self.two_axes.contains(other)) {
            (Some("axis2"), true) => "_2",
            (_, true) => "_1",
            (_, false) => "",
        };
        let offset = offset - factor * reference;
        joint.mimic = Some(Mimic { joint: format!("{other}{suffix}"), factor, offset, span: tag(mimic) });
    }
}

/// `<pose>x y z roll pitch yaw</pose>` of an element.
fn pose_of(node: Node<'_, '_>, of: &str, reader: &mut Reader) -> Pose {
    let Some(pose) = child(node, "pose").filter(|pose| pose.text().is_some_and(|text| !text.trim().is_empty())) else {
        return Pose::default();
    };
    if pose.attribute("rotation_format").is_some_and(|format| format != "euler_rpy") {
        reader.refuse(
            tag(pose),
            format!("the attitude of {of} is not in roll, pitch and yaw"),
            "write `x y z roll pitch yaw`",
        );
        return Pose::default();
    }
    let Some([x, y, z, mut rpy @ ..]) = reader.content::<6>(pose, &format!("the pose of {of}")) else {
        return Pose::default();
    };
    if pose.attribute("degrees") == Some("true") {
        rpy = rpy.map(f64::to_radians);
    } else {
        reader.doubt_angles(rpy, tag(pose), of);
    }
    Pose::of_rpy([x, y, z], rpy)
}

fn inertia(node: Node<'_, '_>, link: &str, reader: &mut Reader) -> Option<Inertial> {
    let pose = pose_of(node, &format!("the inertial of the link `{link}`"), reader);
    let mut number = |parent: Node<'_, '_>, name: &str| match child(parent, name) {
        Some(node) => reader.content::<1>(node, &format!("`{name}` of the link `{link}`")).map(|[number]| number),
        // Of what is not stated the specification gives a kilogram and a square metre.
        None => Some(if name.len() == 3 && name.as_bytes()[1] != name.as_bytes()[2] { 0.0 } else { 1.0 }),
    };
    let mass = number(node, "mass")?;
    let Some(entries) = child(node, "inertia") else {
        reader.refuse(
            tag(node),
            format!("the inertial of the link `{link}` has no inertia"),
            "write `<inertia>…</inertia>`",
        );
        return None;
    };
    let mut values = [0.0; 6];
    for (value, name) in values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        *value = number(entries, name)?;
    }
    Some(Inertial { mass, com: pose.shift, inertia: turned_inertia(&pose.turn, values), span: tag(node) })
}

fn shape(visual: Node<'_, '_>, link: &str, reader: &mut Reader) -> Option<Shape> {
    let of = format!("a visual of the link `{link}`");
    let pose = pose_of(visual, &of, reader);
    let form = child(visual, "geometry")?.children().find(Node::is_element)?;
    let mut number = |name: &str| {
        child(form, name)
            .and_then(|node| reader.content::<1>(node, &format!("the size of {of}")))
            .map(|[number]| number)
    };
    let form = match form.tag_name().name() {
        "cylinder" => Form::Cylinder(number("radius")?, number("length")?),
        "capsule" => Form::Capsule(number("radius")?, number("length")?),
        "sphere" => Form::Sphere(number("radius")?),
        "box" => Form::Box(reader.content(child(form, "size")?, &format!("the size of {of}"))?),
        "mesh" => {
            let file = child(form, "uri")?;
            let scale = child(form, "scale").and_then(|node| reader.content(node, &format!("the scale of {of}")));
            Form::Mesh(file.text().unwrap_or_default().trim().to_string(), scale.unwrap_or([1.0; 3]), tag(file))
        }
        _ => return None,
    };
    Some(Shape { form, pose })
}
