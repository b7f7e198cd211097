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

use std::path::PathBuf;

use mbs_ensemble::statistics::Moments;
use mbs_ensemble::statistics::sensitivity::{Estimate, Indices, indices};
use mbs_ensemble::{Design, Distribution, Member};
use mbs_examples::dispersion::Dispersion;
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_platform::sensitivity::Parameter;
use serde_json::{Value, json};

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
    let named = || QUANTITIES.iter().zip(&results);
    let object: Value = named().map(|(name, quantity)| (name.to_string(), quantity.object(&study))).collect();
    let text: String = named().map(|(name, quantity)| quantity.text(name, &study)).collect();
    arguments.answer(object, &text, &ASSUMED);
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

    fn object(&self, study: &Study) -> Value {
        let entry = |place: usize| {
            let Indices { first, total } = self.indices[place];
            let value = json!({
                "by_gradient": self.shares[place],
                "first": first.value, "first_ci95": first.interval,
                "total": total.value, "total_ci95": total.interval,
            });
            (study.parameters[place].name().to_string(), value)
        };
        let parameters: Value = (0..self.shares.len()).map(entry).collect();
        json!({ "sd_by_gradient": self.deviations[0], "sd": self.deviations[1], "parameters": parameters })
    }

    /// The parameters that decide, in order.
    fn text(&self, name: &str, study: &Study) -> String {
        const SHOWN: usize = 8;
        let [by_gradient, by_members] = self.deviations;
        let mut text = format!(
            "{name} of the forces: deviation {by_gradient:.2} N by gradients, {by_members:.2} N by members\n  \
             parameter             gradient   first order                 total\n"
        );
        for place in self.order().into_iter().take(SHOWN) {
            let Indices { first, total } = self.indices[place];
            let bounded = |e: Estimate| format!("{:.3} ({:.3} to {:.3})", e.value, e.interval[0], e.interval[1]);
            let (share, first, total) = (self.shares[place], bounded(first), bounded(total));
            text += &format!("  {:<20}  {share:<9.3}  {first:<26}  {total}\n", study.parameters[place].name());
        }
        text
    }
}
