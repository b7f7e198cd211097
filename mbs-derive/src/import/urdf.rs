//! URDF, the Unified Robot Description Format.
//!
//! Source: the package urdfdom of ROS, `urdf_parser/src/`, and the pages *XML Robot Description Format* of its wiki.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::pose::{Pose, plus, turned_inertia};
use super::robot::{Body, Form, Inertial, Joint, Kind, Mimic, Robot, Shape};
use super::xml::{Reader, child, children, place, tag};

/// Gravity where the format says nothing of it, m/s².
const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// A robot; what is wrong is noted.
pub(super) fn robot(root: Node<'_, '_>, reader: &mut Reader) -> Option<Robot> {
    refuse_xacro(root, reader);
    let name = root.attribute("name").unwrap_or("robot").to_string();
    let links: Vec<Node<'_, '_>> = children(root, "link").collect();
    let joints: Vec<Node<'_, '_>> = children(root, "joint").collect();
    let numbers = reader.named_links(&links);
    if links.is_empty() {
        reader.refuse(tag(root), format!("the robot `{name}` has no links"), "write `<link name=\"base\">…</link>`");
    }
    let hangs = edges(&joints, &numbers, reader);
    if reader.errors.has_errors() {
        return None;
    }
    let order = walk(&links, &hangs, reader)?;
    let mut robot = Robot { name, gravity: GRAVITY, ..Robot::default() };
    let mut places = vec![0; links.len()];
    for (link, by) in order {
        places[link] = robot.bodies.len();
        let mut body = body(links[link], reader);
        if let Some((parent, joint)) = by {
            body.parent = Some(places[parent]);
            moved(&mut body, joints[joint], reader);
        }
        robot.bodies.push(body);
    }
    let left_out: Vec<&str> = ["transmission", "gazebo", "ros2_control", "sensor"]
        .into_iter()
        .filter(|name| child(root, name).is_some())
        .collect();
    if !left_out.is_empty() {
        robot.notes.push(format!("Left out: {}.", left_out.join(", ")));
    }
    Some(robot)
}

/// Macros that have not been expanded.
fn refuse_xacro(root: Node<'_, '_>, reader: &mut Reader) {
    let is_xacro = |node: &Node<'_, '_>| {
        node.is_element() && node.tag_name().namespace().is_some_and(|space| space.contains("xacro"))
    };
    if let Some(node) = root.descendants().find(is_xacro) {
        let message = format!("this file is xacro: `{}` is not expanded", node.tag_name().name());
        let help = "run `xacro robot.urdf.xacro > robot.urdf` first, and import what it writes";
        reader.refuse(tag(node), message, help);
    }
}

/// Of each joint, the numbers of its parent and its child.
fn edges(joints: &[Node<'_, '_>], numbers: &BTreeMap<&str, usize>, reader: &mut Reader) -> Vec<(usize, usize)> {
    let (mut edges, mut names) = (Vec::new(), BTreeMap::new());
    for joint in joints {
        let Some(name) = reader.wanted(*joint, "name", "this joint") else { continue };
        if names.insert(name, ()).is_some() {
            reader.refuse(place(*joint, "name"), format!("a second joint is called `{name}`"), "names are unique");
        }
        let mut end = |which: &str| {
            let Some(node) = child(*joint, which) else {
                reader.refuse(
                    tag(*joint),
                    format!("the joint `{name}` has no `{which}`"),
                    "write `<parent link=\"…\"/>` and `<child link=\"…\"/>`",
                );
                return None;
            };
            let link = reader.wanted(node, "link", &format!("the {which} of the joint `{name}`"))?;
            let number = numbers.get(link).copied();
            if number.is_none() {
                let message = format!("the {which} of the joint `{name}` is the link `{link}`, which is not there");
                reader.refuse(place(node, "link"), message, "");
            }
            number
        };
        let (parent, own) = (end("parent"), end("child"));
        if let (Some(parent), Some(own)) = (parent, own) {
            edges.push((parent, own));
        }
    }
    edges
}

/// A link, and the parent and the joint that it hangs on.
type Hung = (usize, Option<(usize, usize)>);

/// The links in an order in which each stands behind its parent.
fn walk(links: &[Node<'_, '_>], hangs: &[(usize, usize)], reader: &mut Reader) -> Option<Vec<Hung>> {
    let name = |link: usize| links[link].attribute("name").unwrap_or_default();
    let mut by: Vec<Option<(usize, usize)>> = vec![None; links.len()];
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for (joint, &(parent, own)) in hangs.iter().enumerate() {
        if by[own].is_some() {
            let message = format!("the link `{}` is the child of two joints", name(own));
            reader.refuse(tag(links[own]), message, "close loops by a constraint in a .mbs that imports the file");
            // Reached from both, a link above them would be walked through without end.
            continue;
        }
        by[own] = Some((parent, joint));
        below[parent].push(own);
    }
    let roots: Vec<usize> = (0..links.len()).filter(|&link| by[link].is_none()).collect();
    if let [first, second, ..] = roots.as_slice() {
        let message =
            format!("there are two roots: neither `{}` nor `{}` is the child of a joint", name(*first), name(*second));
        reader.refuse(tag(links[*second]), message, "a robot is one tree: join them by a fixed joint");
    }
    let mut order = Vec::new();
    let mut waiting = roots;
    while let Some(link) = waiting.pop() {
        order.push(link);
        waiting.extend(below[link].iter().rev());
    }
    if order.len() < links.len() {
        let mut reached = vec![false; links.len()];
        order.iter().for_each(|&link| reached[link] = true);
        let lost = reached.iter().position(|reached| !reached).unwrap_or(0);
        // Along the parents it comes back to where it was.
        let (mut at, mut seen) = (lost, vec![false; links.len()]);
        while !seen[at] {
            seen[at] = true;
            at = by[at].map_or(at, |(parent, _)| parent);
        }
        let message = format!("the joints lead in a circle: the link `{}` hangs on itself", name(at));
        reader.refuse(tag(links[at]), message, "close loops by a constraint in a .mbs that imports the file");
    }
    if reader.errors.has_errors() {
        return None;
    }
    Some(order.into_iter().map(|link| (link, by[link])).collect())
}

fn body(link: Node<'_, '_>, reader: &mut Reader) -> Body {
    let name = link.attribute("name").unwrap_or_default().to_string();
    let visuals = children(link, "visual").filter_map(|visual| shape(visual, &name, reader)).collect();
    let inertial = child(link, "inertial").and_then(|inertial| inertia(inertial, &name, reader));
    Body { inertial, shapes: visuals, ..Body::new(&name, tag(link)) }
}

/// `<origin xyz="…" rpy="…"/>` of an element, or `quat_xyzw` in place of `rpy`; nowhere else where there is none.
fn origin(node: Node<'_, '_>, of: &str, reader: &mut Reader) -> Pose {
    let Some(origin) = child(node, "origin") else { return Pose::default() };
    let shift = reader.array(origin, "xyz", &format!("the origin of {of}")).unwrap_or_default();
    let what = format!("the attitude of {of}");
    if let Some(rpy) = reader.array(origin, "rpy", &what) {
        reader.doubt_angles(rpy, place(origin, "rpy"), of);
        if origin.has_attribute("quat_xyzw") {
            reader.refuse(tag(origin), format!("{what} is stated twice"), "leave out `rpy` or `quat_xyzw`");
        }
        return Pose::of_rpy(shift, rpy);
    }
    match reader.array(origin, "quat_xyzw", &what) {
        Some(quaternion) => reader.attitude(shift, quaternion, place(origin, "quat_xyzw"), &what),
        None => Pose { shift, ..Pose::default() },
    }
}

fn inertia(node: Node<'_, '_>, link: &str, reader: &mut Reader) -> Option<Inertial> {
    let about = origin(node, &format!("the inertial of the link `{link}`"), reader);
    let Some(mass) = child(node, "mass") else {
        reader.refuse(
            tag(node),
            format!("the inertial of the link `{link}` has no mass"),
            "write `<mass value=\"…\"/>`",
        );
        return None;
    };
    reader.wanted(mass, "value", &format!("the mass of the link `{link}`"))?;
    let mass = reader.number(mass, "value", &format!("the mass of the link `{link}`"))?;
    let Some(entries) = child(node, "inertia") else {
        let help = "write `<inertia ixx=\"…\" ixy=\"…\" ixz=\"…\" iyy=\"…\" iyz=\"…\" izz=\"…\"/>`";
        reader.refuse(tag(node), format!("the inertial of the link `{link}` has no inertia"), help);
        return None;
    };
    let mut values = [0.0; 6];
    for (value, name) in values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        reader.wanted(entries, name, &format!("the inertia of the link `{link}`"))?;
        *value = reader.number(entries, name, &format!("`{name}` of the link `{link}`"))?;
    }
    Some(Inertial { mass, com: about.shift, inertia: turned_inertia(&about.turn, values), span: tag(node) })
}

fn shape(visual: Node<'_, '_>, link: &str, reader: &mut Reader) -> Option<Shape> {
    let of = format!("a visual of the link `{link}`");
    let pose = origin(visual, &of, reader);
    let form = child(visual, "geometry")?.children().find(Node::is_element)?;
    let what = format!("the size of {of}");
    let form = match form.tag_name().name() {
        "box" => Form::Box(reader.array(form, "size", &what)?),
        "cylinder" => Form::Cylinder(reader.number(form, "radius", &what)?, reader.number(form, "length", &what)?),
        "capsule" => Form::Capsule(reader.number(form, "radius", &what)?, reader.number(form, "length", &what)?),
        "sphere" => Form::Sphere(reader.number(form, "radius", &what)?),
        "mesh" => {
            let file = reader.wanted(form, "filename", &format!("the mesh of {of}"))?.to_string();
            let scale = reader.array(form, "scale", &format!("the scale of {of}")).unwrap_or([1.0; 3]);
            Form::Mesh(file, scale, place(form, "filename"))
        }
        _ => return None,
    };
    Some(Shape { form, pose })
}

/// The joint that a body hangs on.
fn moved(body: &mut Body, node: Node<'_, '_>, reader: &mut Reader) {
    let name = node.attribute("name").unwrap_or_default();
    body.pose = origin(node, &format!("the joint `{name}`"), reader);
    let Some(word) = reader.wanted(node, "type", &format!("the joint `{name}`")) else { return };
    let kind = match word {
        "fixed" => {
            body.fixed_by = Some(name.to_string());
            return;
        }
        "revolute" | "continuous" => Kind::Hinge,
        "prismatic" => Kind::Slide,
        "planar" => Kind::Planar,
        "floating" => Kind::Free,
        "ball" | "spherical" => Kind::Ball,
        _ => {
            let help = "there are `fixed`, `revolute`, `continuous`, `prismatic`, `planar`, `floating` and `ball`";
            reader.refuse(place(node, "type"), format!("the joint `{name}` is of an unknown kind, `{word}`"), help);
            return;
        }
    };
    let mut joint = Joint { is_from_pose: true, ..Joint::new(name, kind, word, tag(node)) };
    if let Some(axis) = child(node, "axis") {
        joint.axis = reader.array(axis, "xyz", &format!("the axis of the joint `{name}`")).unwrap_or([1.0, 0.0, 0.0]);
    } else {
        joint.axis = [1.0, 0.0, 0.0];
    }
    if let Some(dynamics) = child(node, "dynamics") {
        joint.damping =
            reader.number(dynamics, "damping", &format!("the damping of the joint `{name}`")).unwrap_or(0.0);
        joint.friction =
            reader.number(dynamics, "friction", &format!("the friction of the joint `{name}`")).unwrap_or(0.0);
        if joint.damping < 0.0 || joint.friction < 0.0 {
            reader.refuse(tag(dynamics), format!("the joint `{name}` has negative damping or friction"), "");
        }
    }
    if let Some(mimic) = child(node, "mimic") {
        mimicked(&mut joint, mimic, reader);
    }
    joint.limits = limits(node, &joint, reader);
    body.joints.push(joint);
}

fn mimicked(joint: &mut Joint, node: Node<'_, '_>, reader: &mut Reader) {
    let name = joint.name.clone();
    let Some(other) = reader.wanted(node, "joint", &format!("the mimic of the joint `{name}`")) else { return };
    let factor = reader.number(node, "multiplier", &format!("the multiplier of the joint `{name}`")).unwrap_or(1.0);
    let offset = reader.number(node, "offset", &format!("the offset of the joint `{name}`")).unwrap_or(0.0);
    joint.mimic = Some(Mimic { joint: other.to_string(), factor, offset, span: tag(node) });
}

fn limits(node: Node<'_, '_>, joint: &Joint, reader: &mut Reader) -> String {
    let Some(limit) = child(node, "limit") else { return String::new() };
    let mut read = |name: &str| reader.number(limit, name, &format!("the limit of the joint `{}`", joint.name));
    let (lower, upper) = (read("lower"), read("upper"));
    let (effort, velocity) = (read("effort"), read("velocity"));
    let (way, force) = match joint.kind {
        Kind::Slide => ("m", "N"),
        _ => ("rad", "N·m"),
    };
    let mut parts = Vec::new();
    if joint.word != "continuous" && (lower.is_some() || upper.is_some()) {
        parts.push(format!("from {} to {} {way}", lower.unwrap_or(0.0), upper.unwrap_or(0.0)));
    }
    parts.extend(effort.map(|effort| format!("at most {effort} {force}")));
    parts.extend(velocity.map(|velocity| format!("{velocity} {way}/s")));
    parts.join(", ")
}

/// An inertia about another point, `xx yy zz xy xz yz`: what a mass there adds to it.
pub(super) fn of_a_point(mass: f64, [x, y, z]: [f64; 3]) -> [f64; 6] {
    [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z].map(|square| mass * square)
}

/// Bodies that are fixed to each other as one.
pub(super) fn together(parts: &[Inertial]) -> Option<Inertial> {
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    let first = parts.first()?;
    let moment = parts.iter().fold([0.0; 3], |sum, part| plus(sum, part.com.map(|c| c * part.mass)));
    let com = if mass > 0.0 { moment.map(|c| c / mass) } else { first.com };
    let mut inertia = [0.0; 6];
    for part in parts {
        let arm = std::array::from_fn(|i| part.com[i] - com[i]);
        let shifted = of_a_point(part.mass, arm);
        (0..6).for_each(|i| inertia[i] += part.inertia[i] + shifted[i]);
    }
    Some(Inertial { mass, com, inertia, span: first.span.clone() })
}
