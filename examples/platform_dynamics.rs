//! What do the six legs of the Stewart platform PS-6TL-1500 do, and how hard do they push, for an imposed motion?
//!
//! Chapter 4 of the thesis: tables 3 and 4 and the figures made of them, eight motions against the limits of the
//! actuators, what the forces depend on, and control. Look at the flags: the motion of table 4 asks for legs a metre
//! longer than the actuators are. And at the legs' own weight, nearly a third of the force where there is no payload.

#[path = "platform_dynamics/control.rs"]
mod control;
#[path = "platform_dynamics/sensitivity.rs"]
mod sensitivity;
#[path = "platform_dynamics/summary.rs"]
mod summary;

use mbs_examples::platform_dynamics::figures;
use mbs_examples::platform_dynamics::tables::{Samples, TABLE_4, table_3, table_4};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_platform::{Coordinates, DirectKinematics, HOME, Motion, Platform};
use serde_json::{Value, json};

/// The lengths of this pose are given to the direct kinematics, which starts at home.
const POSE: Coordinates = [0.05, -0.04, 1.15, 0.1, -0.08, 0.2];
/// The moment of the combined motion at which matrices are shown \[s\].
const MOMENT: f64 = 0.3;

/// What every length and force rests on.
const ASSUMED: [&str; 2] = ["gravity", "platform."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("platform_dynamics.rs"));
    let platform = Platform::default();
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
        figures::write(folder, &platform)?;
        sensitivity::write(folder, &platform)?;
        summary::write(folder, &platform)?;
    }
    if arguments.json {
        println!("{}", assumed::with(report(&platform)?, &ASSUMED));
    } else {
        summary::print(&platform)?;
        print!("{}", assumed::text(&ASSUMED));
    }
    Ok(())
}

fn direct(platform: &Platform) -> Result<DirectKinematics, Failure> {
    Ok(platform.direct(&platform.lengths(&POSE)?, &HOME)?)
}

/// The tables at t = 0, 0.5, …, 4 s, and the equations of motion at one moment.
fn report(platform: &Platform) -> Result<Value, Failure> {
    let samples = Samples::coarse();
    let table_3 = table_3(platform, &samples)?;
    let mut forces = serde_json::Map::new();
    for run in &table_3 {
        let both = json!({"with_actuators": run.forces, "without_actuators": run.forces_without_actuators});
        forces.insert(format!("payload_{}", run.payload), both);
    }
    let mut by_angles = serde_json::Map::new();
    for (name, angles) in TABLE_4 {
        let run = table_4(platform, angles, &samples)?;
        let entry = json!({
            "lengths": run.lengths,
            "with_actuators": run.forces,
            "without_actuators": run.forces_without_actuators,
        });
        by_angles.insert(name.to_string(), entry);
    }
    let found = direct(platform)?;
    let [q, qd, _] = Motion::COMBINED.at(MOMENT);
    Ok(json!({
        "table3": {"lengths": table_3[0].lengths, "forces": forces},
        "table4": by_angles,
        "direct_kinematics": {"pose": found.pose, "iterations": found.iterations, "residual": found.residual},
        "mass_matrix": platform.model().mass_matrix(&q),
        "coriolis_matrix": platform.model().coriolis_matrix(&q, &qd),
        "gravity": platform.model().gravity(&q),
    }))
}
