//! Where does a vehicle believe it is that lands by its sensors, and how sure may it be?
//!
//! Cases I and II of the thesis, flown by what an IMU, a laser altimeter and a camera say: an error-state Kalman filter
//! makes an estimate of it, which the controller sees in place of the truth. Look at the averages of normalized
//! squares: where a filter errs as much as it says, they are within their bounds about as often as these say. Look at
//! the touchdown then, beside that of the same start on the true state. The last image is of 15 cm over the deck; from
//! there on the IMU alone leads the vehicle.
//!
//! Each landing has random numbers of its own: results are the same for any number of threads. `--members N` says how
//! many landings of each case there are, 10 at least, `--threads N` by how many threads. `--out DIR` writes figures as
//! SVG and PNG, and the errors of one landing of each case as CSV.

mod consistency;
mod figures;
mod monte_carlo;
mod summary;

use mbs_examples::quadrotor_landing::{flight::CASES, members};
use mbs_examples::{Failure, arguments::Arguments, assumed};

use monte_carlo::Run;

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many landings of each case, ten at least: of fewer, the bounds of squares are not known well enough.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(10..=1_000_000))]
    members: u32,
    /// By how many threads; as many as there are cores without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

/// Landings of a case.
struct Case {
    name: &'static str,
    runs: Vec<Run>,
}

/// What the landings rest on, beside what every landing does.
const ASSUMED: [&str; 2] = ["sensors.", "estimator."];

/// What every number rests on.
fn assumed_keys() -> Vec<&'static str> {
    [assumed::LANDING, &ASSUMED].concat()
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let Options { members: count, threads } = arguments.options;
    members::use_threads(threads)?;
    let mut cases = Vec::new();
    for (name, heave) in CASES {
        cases.push(Case { name, runs: monte_carlo::runs(heave, count)? });
    }
    if let Some(folder) = arguments.folder()? {
        for (case, (_, heave)) in cases.iter().zip(CASES) {
            figures::write(folder, case, heave)?;
        }
    }
    let rows = assumed_keys();
    arguments.answer(summary::to_json(&cases), summary::text(&cases).trim_end_matches('\n'), &rows);
    Ok(())
}
