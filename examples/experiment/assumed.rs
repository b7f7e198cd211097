//! What the numbers rest on, and what nobody looked at.

use mbs_examples::assumed;
use mbs_landing::experiment::tracking::{LINK_EXCESS, MODULE_EXCESS};
use serde_json::{Value, json};

/// The thesis' summary has no number of its experiment but the length of the rail.
pub(crate) const ASSUMED: [&str; 25] = [
    "gravity",
    "arm.masses",
    "arm.mass_centres",
    "arm.inertias",
    "arm.ranges",
    "arm.senses",
    "arm.speeds",
    "arm.accelerations",
    "arm.torques",
    "platform.radii",
    "platform.half_angles",
    "platform.home",
    "platform.plate",
    "platform.cylinders",
    "platform.pistons",
    "platform.limits",
    "quadrotor.inertias",
    "quadrotor.rotors",
    "quadrotor.gains",
    "quadrotor.guidance",
    "experiment.",
    "quadrotor.drag",
    "quadrotor.limits",
    "quadrotor.least_lift",
    "quadrotor.start",
];
const NOT_CHECKED: [&str; 1] = ["collisions with anything but arm, vehicle and platform: rail, floor, walls, cables"];

pub(crate) fn to_json() -> Value {
    let told = |recalled: bool| {
        let rows = assumed::of(&ASSUMED).into_iter().filter(|row| (row.status == "recalled") == recalled);
        rows.map(|row| row.what).collect::<Vec<_>>()
    };
    json!({
        "remembered": told(true),
        "chosen": told(false),
        "values": assumed::to_json(&ASSUMED),
        "not_checked": NOT_CHECKED,
        "link_excess": LINK_EXCESS,
        "module_excess": MODULE_EXCESS,
    })
}

pub(crate) fn text() -> String {
    format!("{}not checked: {}\n", assumed::text(&ASSUMED), NOT_CHECKED.join(", "))
}
