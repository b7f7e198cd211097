//! The runs as a table and as JSON.

use std::fmt::Write;

use mbs_arm::assembly::{Outcome, whitney};
use serde_json::{Value, json};

use crate::cases::{CLEARANCE, GREATEST_PUSH, PEG, Run};

pub(crate) fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Inserted => "inserted",
        Outcome::Wedged => "wedged",
        Outcome::Jammed => "jammed",
        Outcome::Overloaded => "overloaded",
    }
}

/// Where both sides began to touch, where they do by geometry with the same lean, and whether they can wedge there.
fn two_points(run: &Run) -> Option<Value> {
    run.found.two_points.map(|[depth, lean]| {
        json!({
            "depth": depth,
            "lean": lean,
            "depth_by_geometry": whitney::two_point_depth(CLEARANCE, lean),
            "can_wedge": whitney::can_wedge(depth, PEG.radius, run.friction),
        })
    })
}

pub(crate) fn to_json(runs: &[Run]) -> Value {
    let row = |run: &Run| {
        json!({
            "way": run.way,
            "hole_aside": run.error[0],
            "hole_tilt": run.error[1],
            "friction": run.friction,
            "outcome": word(run.found.outcome),
            "depth": run.found.depth,
            "contact_force_max": run.found.contact_force,
            "push_max": run.found.push,
            "side_force_max": run.found.side_force,
            "two_points": two_points(run),
            "force_ratio_end": run.found.ratios[0],
            "moment_ratio_end": run.found.ratios[1],
            "carried_error_max": run.found.carried_error,
            "end": run.found.end,
            "cycle_time": run.cycle,
            "energy_imbalance": run.found.energy[0],
            "energy_exchanged": run.found.energy[1],
        })
    };
    json!({ "greatest_push": GREATEST_PUSH, "runs": runs.iter().map(row).collect::<Vec<_>>() })
}

pub(crate) fn text(runs: &[Run]) -> String {
    let mut text = String::from(
        "A SCARA puts a peg into a hole that is aside and leans.\n\n\
         way                aside  leans    μ   outcome     depth   contact     push     side  both at    cycle\n\
         \u{20}                   [mm] [mrad]                    [mm]       [N]      [N]      [N]     [mm]      [s]\n",
    );
    for run in runs {
        let cycle = run.cycle.map_or_else(|| "–".to_string(), |time| format!("{time:.2}"));
        let both = run.found.two_points.map_or_else(|| "–".to_string(), |[depth, _]| format!("{:.2}", 1e3 * depth));
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{:<18} {:>5.1} {:>6.0} {:>5.1}  {:<10} {:>6.2} {:>9.1} {:>8.1} {:>8.1} {both:>8} {cycle:>8}",
            run.way,
            1e3 * run.error[0],
            1e3 * run.error[1],
            run.friction,
            word(run.found.outcome),
            1e3 * run.found.depth,
            run.found.contact_force,
            run.found.push,
            run.found.side_force,
        );
    }
    text + "\nBoth at: the depth from which on both sides of the peg touch, to the end. A cycle has the way back in it, which is planned and not computed.\n"
}
