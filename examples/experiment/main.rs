//! How large may a landing be that an arm on a rail repeats over a small platform?
//!
//! Chapter 6 of the thesis: the flange of the IRB 7600 plays the quadrotor of chapter 5, its simulated landing scaled
//! down; the platform of chapter 4 heaves to the same scale. The greatest feasible scale is searched, and the arm,
//! heavier than its controller knows, is simulated at that scale up to the contact with the deck.
//!
//! `--case II` takes the faster platform, `--scale S` another scale, feasible or not, `--attitude level` lets the tool
//! point straight down instead of taking on the vehicle's attitude. `--out DIR` writes figures as SVG and PNG, and CSV.

mod assumed;
mod figures;
mod run;
mod summary;

use mbs_examples::Failure;
use mbs_examples::arguments::{Arguments, one_of};
use mbs_examples::quadrotor_landing::flight::CASES;
use mbs_landing::experiment::plan::Attitude;

use run::{Case, Run};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// The landing of chapter 5.
    #[arg(long, default_value = "I", value_parser = one_of(CASES.map(|(name, heave)| (name, Case { name, heave }))))]
    case: Case,
    /// The scale of the laboratory; the greatest feasible one without.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Of the vehicle at the flange.
    #[arg(long, default_value = "flown", value_parser = one_of(ATTITUDES))]
    attitude: Attitude,
}

const ATTITUDES: [(&str, Attitude); 2] = [("flown", Attitude::Flown), ("level", Attitude::Level)];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let Options { case, scale, attitude } = arguments.options;
    let experiment = run::experiment(&case, attitude)?;
    let mut run = Run::of(&experiment, case, scale)?;
    let from_afar = run::inbound(&case, attitude)?;
    let inbound = Run::of(&from_afar, case, scale)?;
    if let Some(folder) = arguments.folder()? {
        run = run.compared()?;
        figures::write(folder, "case", &run)?;
        figures::write(folder, "inbound", &inbound)?;
    }
    arguments.answer(summary::to_json(&run, &inbound), &summary::text(&run, &inbound), &[]);
    Ok(())
}
