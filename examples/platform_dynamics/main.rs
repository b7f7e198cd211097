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
mod cases;
mod control;
mod sensitivity;
mod summary;

use along::{Course, Pair, Table};
use cases::Case;
use mbs_examples::platform_dynamics::figures;
use mbs_examples::{Failure, arguments::Arguments, assumed, print, println};
use mbs_platform::{Coordinates, DirectKinematics, HOME, Platform};

/// The lengths of this pose are given to the direct kinematics, which starts at home.
const POSE: Coordinates = [0.05, -0.04, 1.15, 0.1, -0.08, 0.2];
/// The moment of the combined motion at which matrices are shown \[s\].
const MOMENT: f64 = 0.3;

/// What every length and force rests on.
const ASSUMED: [&str; 2] = ["gravity", "platform."];

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
        cases: cases::all(&platform)?,
        tables: along::tables(&platform)?,
        pair: match arguments.options.sensitivity {
            Some(pair) => Some((pair, along::courses(&platform, pair)?)),
            None => None,
        },
    };
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &platform)?;
        sensitivity::write(folder, &platform)?;
        cases::write(folder, &results.cases)?;
        along::write(folder, &results.tables)?;
        if let Some((pair, courses)) = &results.pair {
            along::write_pair(folder, courses, *pair)?;
        }
    }
    if arguments.json {
        println!("{}", assumed::with(summary::to_json(&platform, &results)?, &ASSUMED));
    } else {
        summary::print(&platform, &results)?;
        print!("{}", assumed::text(&ASSUMED));
    }
    Ok(())
}

/// What is computed of all eight cases.
struct Results {
    cases: Vec<Case>,
    tables: Vec<Table>,
    pair: Option<(Pair, Vec<Course>)>,
}

fn direct(platform: &Platform) -> Result<DirectKinematics, Failure> {
    Ok(platform.direct(&platform.lengths(&POSE)?, &HOME)?)
}
