//! What the numbers rest on, and what nobody looked at.

use mbs_examples::assumed;
use mbs_landing::experiment::tracking::{LINK_EXCESS, MODULE_EXCESS};
use serde_json::{Value, json};

/// What the experiment rests on beside [`assumed::LANDING`] and [`assumed::PLATFORM`]. The thesis' summary gives one
/// number of it, the length of the rail.
const ASSUMED: [&str; 10] = [
    "arm.masses",
    "arm.mass_centres",
    "arm.inertias",
    "arm.ranges",
    "arm.senses",
    "arm.speeds",
    "arm.accelerations",
    "arm.torques",
    "platform.limits",
    "experiment.",
];
const NOT_CHECKED: [&str; 1] = ["collisions with anything but arm, vehicle and platform: rail, floor, walls, cables"];

/// The keys of all that the experiment rests on.
pub(crate) fn keys() -> Vec<&'static str> {
    [assumed::LANDING, &assumed::PLATFORM.concat(), &ASSUMED].concat()
}

pub(crate) fn to_json() -> Value {
    let told = |recalled: bool| {
        let rows = assumed::of(&keys()).into_iter().filter(|row| (row.status == "recalled") == recalled);
        rows.map(|row| row.what).collect::<Vec<_>>()
    };
    json!({
        "remembered": told(true),
        "chosen": told(false),
        "values": assumed::to_json(&keys()),
        "not_checked": NOT_CHECKED,
        "link_excess": LINK_EXCESS,
        "module_excess": MODULE_EXCESS,
    })
}

pub(crate) fn text() -> String {
    format!("{}not checked: {}\n", assumed::text(&keys()), NOT_CHECKED.join(", "))
}
