//! Which of thirty numbers decide on the forces of a platform's legs?
//!
//! A Stewart platform of chapter 4 moves in all coordinates at once; geometry, masses, inertias, amplitudes and
//! frequencies are known to some hundredths, as the plan `examples/ensembles/platform.toml` says. Once by exact
//! gradients: 30 motions in dual numbers, and the variance as the sum of what each number adds. Once by Sobol' indices
//! of thousands of motions, which assume nothing. Look at how well the first column predicts the others: for the mean
//! square of the forces thirty motions tell what thousands do; for the greatest force they do not, since another one
//! becomes the greatest.
//!
//! The table goes to `--table FILE`, which a killed run continues, and `mbs plot` draws; `--out DIR` writes a figure of
//! the shares of all numbers.

mod figure;
mod study;
mod summary;

use std::path::PathBuf;

use mbs_ensemble::statistics::Moments;
use mbs_ensemble::statistics::sensitivity::{Indices, indices};
use mbs_ensemble::{Design, Distribution, Member};
use mbs_examples::dispersion::Dispersion;
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_platform::sensitivity::Parameter;
use study::Study;

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// How many rows of 32 motions, instead of as many as the plan says.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    rows: Option<u64>,
    /// Where the table goes.
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
}

/// What is measured of a motion \[N\]: the root of the mean square of all forces, and the greatest.
const QUANTITIES: [&str; 2] = ["rms", "peak"];

/// What it rests on.
const ASSUMED: [&str; 2] = ["platform.", "dispersions.platform"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let options = &arguments.options;
    let plan = ("platform.toml", include_str!("../ensembles/platform.toml"));
    let known: Vec<_> = Parameter::all().map(|parameter| (parameter.name(), parameter.unit())).collect();
    let quantities = QUANTITIES.map(|name| (name, "N"));
    let dispersion = Dispersion::planned("platform_sensitivity", plan, options.rows, known, &quantities)?;
    let (design, study) = (&dispersion.design, Study::of(&dispersion.design)?);
    let forces = |member: &Member| study.forces(&member.values);
    let (folder, columns) = (arguments.folder()?, dispersion.all_columns(options.table.as_deref(), &forces)?);
    let of_both = columns.iter().zip(study.gradients()?);
    let results = of_both.map(|(column, gradient)| Quantity::of(design, column, &gradient));
    let results = results.collect::<Result<Vec<_>, _>>()?;
    if let Some(folder) = folder {
        output::write_figure(folder, "platform_sensitivity", &figure::shares(&results), &ASSUMED)?;
    }
    arguments.answer(summary::to_json(&study, &results), &summary::text(&study, &results), &ASSUMED);
    Ok(())
}

/// What is known of a quantity.
struct Quantity {
    /// By the gradients, and by the members \[N\].
    deviations: [f64; 2],
    /// The share of the variance of each parameter by its derivative.
    shares: Vec<f64>,
    indices: Vec<Indices>,
}

impl Quantity {
    fn of(design: &Design, values: &[f64], gradient: &[f64]) -> Result<Self, Failure> {
        let slopes =
            design.distributions().into_iter().map(|distribution: Distribution| distribution.slope_at_germ(0.0));
        let parts: Vec<f64> =
            gradient.iter().zip(slopes).map(|(slope, deviation)| (slope * deviation).powi(2)).collect();
        let variance: f64 = parts.iter().sum();
        // The first of a row is drawn like a member of its own.
        let drawn: Moments = values.chunks(parts.len() + 2).map(|row| row[0]).collect();
        let indices = indices(values, parts.len(), design.seed());
        let indices = indices.ok_or_else(|| Failure::new("the forces do not vary, or there are too few rows"))?;
        let shares = parts.iter().map(|part| part / variance).collect();
        Ok(Quantity { deviations: [variance.sqrt(), drawn.deviation()], shares, indices })
    }

    /// The parameters by their total indices, the greatest first.
    fn order(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.shares.len()).collect();
        order.sort_by(|a, b| self.indices[*b].total.value.total_cmp(&self.indices[*a].total.value));
        order
    }
}
