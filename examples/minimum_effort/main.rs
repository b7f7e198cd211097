//! How little can the drives of the IRB 7600 do between the postures of the thesis' Table 2, and what does haste cost?
//!
//! The effort `J = ∫ Σ (τ/τ_max)² dt` is minimized by direct collocation, under ranges, speeds and torques, and
//! compared with that of a polynomial of degree five. Table 2 is taken within the ranges of the real axes, since its
//! own postures are not. Look at the forearm, which turns up to the end of its range at full speed and stays there for
//! most of the way, where its weight costs least; at `H`, which Pontryagin's principle keeps constant; and at the front
//! of time and effort, whose slope is `H`, too: it ends where more time saves nothing any more.
//!
//! `--out DIR` writes both motions, and the front, as figures (SVG and PNG) and as tables (CSV).

mod figures;
mod front;
mod motion;

use std::fmt::Write;

use mbs_examples::{Failure, arguments::Arguments};
use serde_json::{Value, json};

use front::Front;
use motion::Comparison;

/// What efforts and limits rest on.
const ASSUMED: [&str; 9] = [
    "gravity",
    "arm.masses",
    "arm.mass_centres",
    "arm.inertias",
    "arm.ranges",
    "arm.senses",
    "arm.speeds",
    "arm.torques",
    "effort.",
];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let comparison = Comparison::new()?;
    let front = Front::new()?;
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &comparison, &front)?;
        figures::write_tables(folder, &comparison, &front)?;
    }
    arguments.answer(
        json!({ "within_ranges": comparison.to_json(), "front": front.to_json() }),
        &(comparison.text()? + &front.text()?),
        &ASSUMED,
    );
    Ok(())
}
