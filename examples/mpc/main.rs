//! How fast can a quadrotor land on a platform that moves, and can a plan of it be made while it flies?
//!
//! Cases I and II of the thesis, three times each: the shortest landing in time, planned anew twenty times a second
//! while it is flown; predictive control, which follows a descent and solves one quadratic program a sample, a hundred
//! times a second; and for comparison the guided landing by backstepping. All but the last keep thrust of each rotor,
//! tilt, a cone in which the camera sees the deck, and the velocity of the touchdown. Each is flown in calm air, and
//! once more in wind with a vehicle that is heavier than planned. Derivatives of all plans are exact.
//!
//! Look at the time that plans take, against the time that there is; at the touchdown in wind; and at what a looser
//! limit saves. The platform of case II falls faster than freely for a part of the time: a vehicle comes down on it
//! because it needs to be as fast as the platform at one moment only.
//!
//! `--case I` flies one of them. `--horizon` and `--intervals` change that of predictive control. `--out DIR` writes
//! figures as SVG and PNG, and curves as CSV.

mod figures;
mod flights;
mod summary;

use mbs_examples::quadrotor_landing::flight::CASES;
use mbs_examples::{Failure, arguments::Arguments, assumed};
use mbs_landing::quadrotor::predictive::controller::Horizon;

use flights::{Case, looser};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How far predictive control looks ahead, in seconds.
    #[arg(long, default_value_t = Horizon::default().duration, allow_negative_numbers = true)]
    horizon: f64,
    /// Into how many intervals that time is divided.
    #[arg(long, default_value_t = Horizon::default().intervals as u32, value_parser = clap::value_parser!(u32).range(2..=200))]
    intervals: u32,
    /// Only this case of the thesis.
    #[arg(long, value_parser = ["I", "II"])]
    case: Option<String>,
}

/// What the landings rest on, beside what every landing does.
const ASSUMED: [&str; 1] = ["predictive."];

/// What every number rests on.
fn assumed_keys() -> Vec<&'static str> {
    [assumed::LANDING, &ASSUMED].concat()
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let Options { horizon: duration, intervals, case } = &arguments.options;
    let horizon = Horizon { duration: *duration, intervals: *intervals as usize, ..Horizon::default() };
    horizon.check()?;
    let mut cases = Vec::new();
    for (name, heave) in CASES.into_iter().filter(|(name, _)| case.as_ref().is_none_or(|only| only == name)) {
        cases.push(Case::flown(name, heave, horizon)?);
    }
    let is_assumed =
        (horizon.duration, horizon.intervals) == (Horizon::default().duration, Horizon::default().intervals);
    let told = if is_assumed { "" } else { "predictive.horizon" };
    let keys = assumed::without(&assumed_keys(), told);
    let saved = looser()?;
    if let Some(folder) = arguments.folder()? {
        for case in &cases {
            figures::write(folder, case)?;
        }
    }
    arguments.answer(summary::to_json(&cases, &saved, &horizon), &summary::text(&cases, &saved, &horizon), &keys);
    Ok(())
}
