//! How much work does each method need for how much precision, and does another crate need less?
//!
//! Error of the final state against evaluations of the right-hand side, on a Kepler orbit, the Arenstorf orbit and a
//! generated double pendulum: every method of `mbs_runtime`, and DOP853 as other crates have it, at the same
//! tolerances (`russell_ode`, a minute of compilation, with `--features russell`). Look at the slopes (a method of
//! order p gains p digits for ten times the work), and at the last table of a problem: below 1 the other crate needs
//! fewer evaluations, or less time. The column `f` is the time of right-hand sides alone, as many as `mbs_runtime`
//! evaluates: no implementation that makes the same evaluations takes less.
//!
//! `--out DIR` writes the figure (SVG and PNG), all runs as CSV, and the JSON.

mod figure;
mod summary;

use mbs_examples::work_precision::reports;
use mbs_examples::{Failure, arguments::Arguments, output};

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));

    let reports = reports().map_err(|error| Failure::new(error.to_string()))?;
    let results = summary::to_json(&reports);
    if let Some(folder) = arguments.folder()? {
        output::write_json(folder, "work_precision", &results)?;
        output::write_file(&folder.join("work_precision.csv"), summary::csv(&reports).as_bytes())?;
        output::write_figure(folder, "work_precision", &figure::of(&reports), &[])?;
    }
    arguments.answer(results, &summary::text(&reports), &[]);
    Ok(())
}
