//! What do the six legs of the Stewart platform PS-6TL-1500 do, and how hard do they push, for an imposed motion?
//!
//! Chapter 4 of the thesis: tables 3 and 4 and the figures made of them, eight motions against the limits of the
//! actuators, what the forces depend on, and control. Look at the flags: the motion of table 4 asks for legs a metre
//! longer than the actuators are. And at the legs' own weight, nearly a third of the force where there is no payload.
//!
//! `--out DIR` writes figures 4.5 to 4.12, lengths, speeds, forces and powers of the legs in all eight cases
//! (`case_1` to `case_8`), and of every output the largest derivative by every parameter (`sensitivity_case_1.csv` to
//! `sensitivity_case_8.csv`). `--sensitivity force_1:base_radius` gives the derivative of one output by one parameter
//! over time, in all cases; a wrong name is answered by the list of names.

mod along;
mod control;
mod histories;
mod sensitivity;
mod summary;

use along::{Course, Pair, Table};
use histories::History;
use mbs_examples::platform_dynamics::figures;
use mbs_examples::platform_dynamics::tables::{Samples, TABLE_4, table_3, table_4};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_examples::{print, println};
use mbs_platform::{Coordinates, DirectKinematics, HOME, Motion, Platform};
use serde_json::{Value, json};
use summary::Study;

/// The lengths of this pose are given to the direct kinematics, which starts at home.
const POSE: Coordinates = [0.05, -0.04, 1.15, 0.1, -0.08, 0.2];
/// The moment of the combined motion at which matrices are shown \[s\].
const MOMENT: f64 = 0.3;

/// What every length and force rests on.
const ASSUMED: [&str; 2] = ["gravity", "platform."];

/// What the histories of the eight cases rest on.
const CASES: [&str; 14] = [
    "gravity",
    "platform.radii",
    "platform.half_angles",
    "platform.home",
    "platform.attitude",
    "platform.plate",
    "platform.payload",
    "platform.cylinders",
    "platform.pistons",
    "platform.frequency",
    "platform.height",
    "platform.cases",
    "platform.combined",
    "platform.combined_frequencies",
];

/// Besides `--json` and `--out`.
#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// One output by one parameter over time, in all cases.
    #[arg(long, value_name = "OUTPUT:PARAMETER")]
    sensitivity: Option<Pair>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let platform = Platform::default();
    let results = Results {
        studies: summary::studies(&platform)?,
        histories: histories::all(&platform)?,
        tables: along::tables(&platform)?,
        pair: match arguments.options.sensitivity {
            Some(pair) => Some((pair, along::courses(&platform, pair)?)),
            None => None,
        },
    };
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
        figures::write(folder, &platform)?;
        sensitivity::write(folder, &platform)?;
        summary::write(folder, &results.studies)?;
        histories::write(folder, &results.histories)?;
        along::write(folder, &results.tables)?;
        if let Some((pair, courses)) = &results.pair {
            along::write_pair(folder, courses, *pair)?;
        }
    }
    if arguments.json {
        println!("{}", assumed::with(report(&platform, &results)?, &ASSUMED));
    } else {
        summary::print(&platform, &results)?;
        print!("{}", assumed::text(&ASSUMED));
    }
    Ok(())
}

/// What is computed of all eight cases.
struct Results {
    studies: Vec<Study>,
    histories: Vec<History>,
    tables: Vec<Table>,
    pair: Option<(Pair, Vec<Course>)>,
}

fn direct(platform: &Platform) -> Result<DirectKinematics, Failure> {
    Ok(platform.direct(&platform.lengths(&POSE)?, &HOME)?)
}

/// The tables at t = 0, 0.5, …, 4 s, the equations of motion at one moment, and the eight cases.
fn report(platform: &Platform, results: &Results) -> Result<Value, Failure> {
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
    let mut report = json!({
        "table3": {"lengths": table_3[0].lengths, "forces": forces},
        "table4": by_angles,
        "direct_kinematics": {"pose": found.pose, "iterations": found.iterations, "residual": found.residual},
        "mass_matrix": platform.model().mass_matrix(&q),
        "coriolis_matrix": platform.model().coriolis_matrix(&q, &qd),
        "gravity": platform.model().gravity(&q),
        "cases": histories::to_json(&results.histories, results.studies.iter().map(|study| &study.with_actuators)),
        "sensitivity": along::to_json(&results.tables),
    });
    if let Some((pair, courses)) = &results.pair {
        report["sensitivity_of"] = along::pair_to_json(courses, *pair);
    }
    Ok(report)
}
