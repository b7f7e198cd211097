//! What the numbers rest on, and what nobody looked at.

use mbs_landing::experiment::tracking::{LINK_EXCESS, MODULE_EXCESS};
use serde_json::{Value, json};

/// From memory of the manufacturer's specification.
const REMEMBERED: [&str; 2] = ["ranges of the joints", "speeds of the joints"];
/// Of a plausible size.
const CHOSEN: [&str; 7] = [
    "accelerations and torques of the joints",
    "speed, acceleration and force of the rail's drive",
    "masses and inertias of the arm",
    "geometry, masses and limits of the platform",
    "places of rail, platform and deck",
    "the arm's controller",
    "the errors of the masses that it knows",
];
const NOT_CHECKED: [&str; 1] = ["collisions of arm, vehicle, rail and platform"];

pub(crate) fn to_json() -> Value {
    json!({
        "remembered": REMEMBERED,
        "chosen": CHOSEN,
        "not_checked": NOT_CHECKED,
        "link_excess": LINK_EXCESS,
        "module_excess": MODULE_EXCESS,
    })
}

/// Two lines.
pub(crate) fn text() -> String {
    format!(
        "remembered, not looked up: {}; assumed: {}\nnot checked: {}\n",
        REMEMBERED.join(", "),
        CHOSEN.join("; "),
        NOT_CHECKED.join(", ")
    )
}
