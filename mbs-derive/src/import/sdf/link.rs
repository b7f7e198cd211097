//! Links of SDF: their poses, what they weigh and look like.

use roxmltree::Node;

use super::super::identifier::shown;
use super::super::pose::{Pose, turned_inertia};
use super::super::robot::{Form, Inertial, Shape};
use super::super::xml::{Reader, child, content, place, tag};
use crate::span::Span;

/// `<pose>x y z roll pitch yaw</pose>` of an element.
pub(super) fn pose_of(node: Node<'_, '_>, of: &str, reader: &mut Reader) -> Pose {
    let Some(pose) = child(node, "pose").filter(|pose| !content(*pose).trim().is_empty()) else {
        return Pose::default();
    };
    let what = format!("the pose of {of}");
    match pose.attribute("rotation_format").unwrap_or("euler_rpy") {
        "euler_rpy" => {
            let Some([x, y, z, mut rpy @ ..]) = reader.content::<6>(pose, &what) else { return Pose::default() };
            let degrees = pose.attribute("degrees");
            if degrees.is_some_and(|word| truth(word, place(pose, "degrees"), "`degrees`", reader)) {
                rpy = rpy.map(f64::to_radians);
            } else {
                reader.doubt_angles(rpy, tag(pose), of);
            }
            Pose::of_rpy([x, y, z], rpy)
        }
        "quat_xyzw" => match reader.content::<7>(pose, &what) {
            Some([x, y, z, quaternion @ ..]) => {
                reader.attitude([x, y, z], quaternion, tag(pose), &format!("the attitude of {of}"))
            }
            None => Pose::default(),
        },
        other => {
            let message = format!("{what} is in a format that is not known, `{}`", shown(other));
            reader.refuse(place(pose, "rotation_format"), message, "there are `euler_rpy` and `quat_xyzw`");
            Pose::default()
        }
    }
}

/// What the pose of an element is relative to; `frame` is an older name of it.
pub(super) fn relative_to<'a>(node: Node<'a, '_>) -> Option<&'a str> {
    let pose = child(node, "pose")?;
    pose.attribute("relative_to").or(pose.attribute("frame")).filter(|of| !of.is_empty())
}

/// Whether an element says `true`, or 1; what is neither true nor false is reported.
pub(super) fn is_true(node: Node<'_, '_>, reader: &mut Reader) -> bool {
    truth(&content(node), tag(node), &format!("`{}`", node.tag_name().name()), reader)
}

fn truth(word: &str, place: Span, what: &str, reader: &mut Reader) -> bool {
    match word.trim().to_ascii_lowercase().as_str() {
        "true" | "1" => true,
        "false" | "0" => false,
        _ => {
            reader.refuse(place, format!("{what} is neither true nor false: `{}`", shown(word)), "");
            false
        }
    }
}

/// What a link weighs: of what is not stated the specification gives a kilogram, and a kg·m² about each axis.
pub(super) fn inertia(link: Node<'_, '_>, name: &str, reader: &mut Reader) -> Option<Inertial> {
    let Some(node) = child(link, "inertial") else {
        let inertia = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        return Some(Inertial { mass: 1.0, com: [0.0; 3], inertia, span: tag(link) });
    };
    let of = format!("the inertial of the link `{name}`");
    let auto = node.attribute("auto");
    if auto.is_some_and(|word| truth(word, place(node, "auto"), "`auto`", reader)) {
        let message = format!("{of} is to be computed from its collisions, by `auto`, which is not imported");
        let help = "write `<mass>` and `<inertia>`, which `gz sdf --inertial-stats` shows, without `auto`";
        reader.refuse(place(node, "auto"), message, help);
        return None;
    }
    if let Some(added) = child(node, "fluid_added_mass") {
        let message = format!("{of} has the mass of a fluid, by `fluid_added_mass`, which is not imported");
        reader.refuse(tag(added), message, "leave it out, and write it as an energy beside the import");
    }
    if let Some(other) = relative_to(node) {
        let message = format!("{of} is placed relative to `{other}`, which is not imported");
        reader.refuse(tag(node), message, "write its pose in the frame of the link");
    }
    let pose = pose_of(node, &of, reader);
    let mut number =
        |parent: Option<Node<'_, '_>>, what: &str, without: f64| match parent.and_then(|node| child(node, what)) {
            Some(node) => reader.content::<1>(node, &format!("`{what}` of the link `{name}`")).map(|[number]| number),
            None => Some(without),
        };
    let mass = number(Some(node), "mass", 1.0)?;
    let entries = child(node, "inertia");
    let mut values = [0.0; 6];
    for (value, what) in values.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
        let is_moment = ["ixx", "iyy", "izz"].contains(&what);
        *value = number(entries, what, if is_moment { 1.0 } else { 0.0 })?;
    }
    Some(Inertial { mass, com: pose.shift, inertia: turned_inertia(&pose.turn, values), span: tag(node) })
}

pub(super) fn shape(visual: Node<'_, '_>, link: &str, reader: &mut Reader) -> Option<Shape> {
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
            Form::Mesh(content(file).trim().to_string(), scale.unwrap_or([1.0; 3]), tag(file))
        }
        _ => return None,
    };
    Some(Shape { form, pose })
}
