//! How hard does a quadrotor land where mass, inertia, drag, wind, start, sensors and sea are drawn by a plan?
//!
//! The plan is `examples/ensembles/landing.toml`, or the one of `--plan FILE`, such as `landing_seas.toml` beside it;
//! each member is a closure of its values with generated code, the landing's controller at 500 Hz, and a noisy sensor,
//! whose random numbers are the member's own. The table goes to `--table FILE`, which a killed run continues.
//! `--out DIR` writes histograms (SVG and PNG). `--compare` measures what the ensemble costs beside the bare loop over
//! its closures, on one thread, and nothing else.

mod landings;

use std::path::PathBuf;
use std::time::Instant;

use mbs_ensemble::statistics::{Moments, quantile, quantile_interval};
use mbs_ensemble::{Member, Share, Sweep};
use mbs_examples::dispersion::Dispersion;
use mbs_examples::quadrotor_landing::members;
use mbs_examples::{Failure, arguments::Arguments, assumed, histograms, output, println};
use serde_json::{Value, json};

use landings::{Landings, QUANTITIES, VARIABLES};

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
        Some(path) => (path.display().to_string(), std::fs::read_to_string(path)?),
        None => ("landing.toml".to_string(), include_str!("../ensembles/landing.toml").to_string()),
    };
    let members = options.members;
    let dispersion = Dispersion::planned("landing_sweep", (&name, &text), members, VARIABLES, &QUANTITIES)?;
    let landings = Landings::of(&dispersion.design)?;
    if options.compare {
        let folder = tempfile::tempdir()?;
        return compare(&landings, &dispersion.sweep(folder.path().join("landings.csv")));
    }
    let land = |member: &Member| landings.land(member);
    let folder = arguments.folder()?;
    let (outcome, mut columns) =
        dispersion.columns(options.table.as_deref(), options.threads.map(usize::from), &land)?;
    columns.iter_mut().for_each(|column| column.retain(|value| value.is_finite()));
    let keys = [assumed::LANDING, &members::ASSUMED].concat();
    if let Some(folder) = folder {
        if columns[0].is_empty() {
            return Err(Failure::new("no landing touched down: there is nothing to draw"));
        }
        output::write_figure(folder, "landings", &histograms::figure("landings", &QUANTITIES, &columns), &keys)?;
    }
    let (object, text) = report(&outcome, columns);
    arguments.answer(object, &text, &keys);
    Ok(())
}

/// What all landings say together.
fn report(outcome: &mbs_ensemble::sweep::Outcome, columns: Vec<Vec<f64>>) -> (Value, String) {
    let mut object = json!({ "members": outcome.members, "stopped": outcome.stopped });
    let mut text = format!("{} landings, {} without a touchdown\n", outcome.members, outcome.stopped);
    for ((name, unit), mut column) in QUANTITIES.into_iter().zip(columns) {
        let moments: Moments = column.iter().copied().collect();
        column.sort_by(f64::total_cmp);
        let [low, high] = moments.mean_interval(0.95);
        let (median, last) = (quantile(&column, 0.5), quantile(&column, 0.99));
        let bounds = quantile_interval(&column, 0.99, 0.95);
        object[name] = json!({
            "mean": moments.mean, "sd": moments.deviation(), "ci95": [low, high],
            "median": median, "q99": last, "q99_ci95": bounds,
        });
        let bounds = bounds.map_or(String::new(), |[low, high]| format!(" ({low:.5} to {high:.5})"));
        text += &format!(
            "{name:<18} mean {:.5} ({low:.5} to {high:.5}), median {median:.5}, 99 % {last:.5}{bounds} {unit}\n",
            moments.mean
        );
    }
    (object, text)
}

/// Members a second on one thread: of the loop over the closures alone, and of the ensemble with its journal and table.
fn compare(landings: &Landings, sweep: &Sweep<'_>) -> Result<(), Failure> {
    let members = sweep.design.members();
    let mut rates = [Vec::new(), Vec::new()];
    for _ in 0..5 {
        let began = Instant::now();
        let mut sum = 0.0;
        for index in 0..members {
            sum += landings.land(&sweep.design.member(index)).map_or(0.0, |row| row[0]);
        }
        rates[0].push(members as f64 / began.elapsed().as_secs_f64());
        if !sum.is_finite() {
            return Err(Failure::new("a touchdown time is not finite"));
        }
        let began = Instant::now();
        sweep.run(&|member: &Member| landings.land(member), Share::WHOLE, 1, &|_| ())?;
        sweep.merge(|_| ())?;
        rates[1].push(members as f64 / began.elapsed().as_secs_f64());
        std::fs::remove_file(&sweep.table)?;
    }
    let [bare, ensemble] = rates.map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        quantile(&rates, 0.5)
    });
    println!("{bare:.1} members/s in the bare loop, {ensemble:.1} in the ensemble: {:.3}", ensemble / bare);
    Ok(())
}
