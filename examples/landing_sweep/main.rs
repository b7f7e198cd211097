//! How hard does a quadrotor land where mass, inertia, drag, wind, start, sensors and sea are drawn by a plan?
//!
//! The plan is `examples/ensembles/landing.toml`, or the one of `--plan FILE`, such as `landing_seas.toml` beside it;
//! each member is a closure of its values with generated code, the landing's controller at 500 Hz, and a noisy sensor,
//! whose random numbers are the member's own. Where a plan draws members independently, means and quantiles have bounds
//! of 95 %. The table goes to `--table FILE`, which a killed run continues. `--out DIR` writes histograms (SVG and
//! PNG). `--compare` measures what the ensemble costs beside the bare loop over its closures, on one thread, and
//! nothing else.

mod cost;
mod landings;
mod summary;

use std::path::PathBuf;

use mbs_ensemble::Member;
use mbs_ensemble::sequence::Kind;
use mbs_examples::dispersion::Dispersion;
use mbs_examples::quadrotor_landing::members;
use mbs_examples::{Failure, arguments::Arguments, assumed, histograms, output};

use landings::{QUANTITIES, VARIABLES, land};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// Another plan, of the same variables.
    #[arg(long, value_name = "FILE")]
    plan: Option<PathBuf>,
    /// How many landings, instead of as many as the plan says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    members: Option<u64>,
    /// Where the table goes.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// On how many threads; as many as there are cores without.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Measure the ensemble beside the bare loop.
    #[arg(long)]
    compare: bool,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let options = &arguments.options;
    let (name, text) = match &options.plan {
        Some(path) => {
            let unreadable = |error| Failure::new(format!("{}: {error}", path.display()));
            (path.display().to_string(), std::fs::read_to_string(path).map_err(unreadable)?)
        }
        None => ("landing.toml".to_string(), include_str!("../ensembles/landing.toml").to_string()),
    };
    let members = options.members;
    let dispersion = Dispersion::planned("landing_sweep", (&name, &text), members, VARIABLES, &QUANTITIES)?;
    if dispersion.design.kind() == Kind::Chaos {
        let why = "the design \"chaos\" has points with weights, of which this program knows nothing; write \"random\"";
        return Err(Failure::new(format!("{name}: {why}")));
    }
    let land = |member: &Member| land(&dispersion, member);
    if options.compare {
        let folder = tempfile::tempdir()?;
        return cost::compare(&land, &dispersion.sweep(folder.path().join("landings.csv")));
    }
    let folder = arguments.folder()?;
    let (outcome, mut columns) =
        dispersion.columns(options.table.as_deref(), options.threads.map(usize::from), &land)?;
    columns.iter_mut().for_each(|column| column.retain(|value| value.is_finite()));
    let keys = [assumed::LANDING, &members::ASSUMED].concat();
    if let Some(folder) = folder {
        output::write_figure(folder, "landings", &histograms::figure("landings", &QUANTITIES, &columns), &keys)?;
    }
    let (object, text) = summary::of(&outcome, columns, dispersion.design.draws_independently());
    arguments.answer(object, &text, &keys);
    Ok(())
}
