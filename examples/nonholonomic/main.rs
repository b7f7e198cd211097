//! What do constraints on velocities do that constraints on places cannot?
//!
//! Three mechanisms of (7.1), (7.2) whose motions are known in closed form. A knife edge on an incline, let go from
//! rest: it does not slide down but goes across, along a cycloid. Chaplygin's sleigh, pushed backwards: it turns
//! round, its energy stays and its momentum does not. A coin that leans: it goes round on a circle, and one that rolls
//! straight on nods and swerves at a frequency of its own. Each is integrated with its multipliers and projected onto
//! its constraints. Look at how far it comes from the closed form.
//!
//! `--out DIR` writes paths and differences as SVG and PNG, and as CSV.

mod coin;
mod edge;
mod figures;
mod flown;
mod sleigh;

use mbs_examples::{Failure, arguments::Arguments};
use serde_json::json;

mbs_runtime::include_mechanism!("knife_edge");
mbs_runtime::include_mechanism!("chaplygin_sleigh");
mbs_runtime::include_mechanism!("rolling_coin");

/// What the motions rest on.
const ASSUMED: [&str; 2] = ["gravity", "nonholonomic."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let (edge, sleigh, coin) = (edge::run()?, sleigh::run()?, coin::run()?);
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &edge, &sleigh, &coin)?;
    }
    let results = json!({
        "knife_edge": edge.to_json(),
        "chaplygin_sleigh": sleigh.to_json(),
        "rolling_coin": coin.to_json(),
    });
    arguments.answer(results, &[edge.text(), sleigh.text(), coin.text()].concat(), &ASSUMED);
    Ok(())
}
