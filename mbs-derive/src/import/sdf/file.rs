//! The robot among the models of a file, what of it is left out, and what its frames move with.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::super::identifier::shown;
use super::super::xml::{Reader, child, children, content, tag};
use super::link::is_true;

/// The model that is the robot: the only one, or of several the only one that is not static. The names of the others.
pub(super) fn model<'a, 'i>(
    root: Node<'a, 'i>,
    world: Option<Node<'a, 'i>>,
    reader: &mut Reader,
) -> Option<(Node<'a, 'i>, Vec<String>)> {
    let mut models: Vec<Node<'_, '_>> = children(root, "model").collect();
    models.extend(world.into_iter().flat_map(|world| children(world, "model")));
    let mut still = Vec::new();
    if models.len() > 1 {
        let is_still = |model: &Node<'_, '_>| child(*model, "static").is_some_and(|node| is_true(node, reader));
        (still, models) = models.into_iter().partition(is_still);
    }
    match (models.as_slice(), still.as_slice()) {
        ([one], still) => {
            let name = |model: &Node<'_, '_>| shown(model.attribute("name").unwrap_or("model"));
            Some((*one, still.iter().map(name).collect()))
        }
        ([], []) => {
            reader.refuse(tag(root), "there is no model in this file", "write `<model name=\"…\">…</model>`");
            None
        }
        ([], [first, ..]) => {
            reader.refuse(tag(*first), "all models in this file are static: nothing moves", "leave out `<static>`");
            None
        }
        ([_, second, ..], _) => {
            reader.refuse(
                tag(*second),
                "there is a second model in this file",
                "a mechanism has one robot: put each in a file of its own, or make what does not move `<static>`",
            );
            None
        }
    }
}

/// What is in the file, and not in the mechanism.
pub(super) fn left_out(world: Option<Node<'_, '_>>, model: Node<'_, '_>, still: &[String]) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    for (parent, inside) in [(Some(model), &["plugin", "gripper"][..]), (world, &["include", "actor", "wind"])] {
        names.extend(inside.iter().filter(|name| parent.is_some_and(|parent| child(parent, name).is_some())));
    }
    let parts = || model.children().filter(Node::is_element);
    let has = |name: &&str| parts().any(|part| child(part, name).is_some());
    names.extend(["sensor", "light", "projector", "battery"].iter().filter(|name| has(name)));
    let mut notes = Vec::new();
    if !names.is_empty() {
        notes.push(format!("Left out: {}.", names.join(", ")));
    }
    if !still.is_empty() {
        let quoted: Vec<String> = still.iter().map(|name| format!("`{name}`")).collect();
        notes.push(format!("Left out, being static models: {}.", quoted.join(", ")));
    }
    for joint in parts().filter(|part| part.tag_name().name() == "joint") {
        let name = shown(joint.attribute("name").unwrap_or("joint"));
        let axes = || ["axis", "axis2"].into_iter().filter_map(|axis| child(joint, axis));
        if joint.attribute("type") == Some("ball") && axes().next().is_some() {
            notes.push(format!(
                "The axis of the ball joint `{name}` is left out, and what it says of damping and limits."
            ));
        }
        let starts = axes().filter_map(|axis| child(axis, "initial_position"));
        if starts.filter_map(|node| content(node).trim().parse().ok()).any(|start: f64| start != 0.0) {
            notes.push(format!("The initial position of the joint `{name}` is left out: a simulation states its own."));
        }
    }
    notes
}

/// Of each frame of a model the link that it moves with: by way of other frames, and of joints, which move with their
/// children. What is attached to nothing moves with the first link, or the one that the model names.
pub(super) fn carriers<'a>(model: Node<'a, '_>, links: &BTreeMap<&'a str, usize>) -> BTreeMap<&'a str, usize> {
    let canonical = model.attribute("canonical_link").filter(|link| links.contains_key(link));
    let canonical = canonical.map(str::to_string).or_else(|| {
        let first = model.children().find(|part| part.tag_name().name() == "link");
        first.and_then(|link| link.attribute("name")).map(str::to_string)
    });
    let mut next: BTreeMap<&'a str, String> = BTreeMap::new();
    for part in model.children().filter(Node::is_element) {
        let of = match part.tag_name().name() {
            "frame" => {
                let of = part.attribute("attached_to").filter(|of| !of.is_empty() && *of != "__model__");
                of.map(str::to_string).or_else(|| canonical.clone())
            }
            "joint" => child(part, "child").map(|node| content(node).trim().to_string()),
            _ => None,
        };
        if let (Some(name), Some(of)) = (part.attribute("name"), of) {
            next.insert(name, of);
        }
    }
    // What was found is not looked for again; of what leads in a circle, nothing is.
    let mut found: BTreeMap<&str, Option<usize>> = links.iter().map(|(name, link)| (*name, Some(*link))).collect();
    for name in next.keys() {
        let (mut way, mut at) = (Vec::new(), *name);
        while let (None, Some(of)) = (found.get(at), next.get(at)) {
            found.insert(at, None);
            way.push(at);
            at = of;
        }
        let link = found.get(at).copied().flatten();
        found.extend(way.into_iter().map(|frame| (frame, link)));
    }
    next.keys().filter_map(|name| Some((*name, (*found.get(name)?)?))).collect()
}
