//! Forces, depth and tilt of the three ways, one figure a hole.

use std::path::Path;

use mbs_arm::assembly::Sample;
use mbs_chart::{Figure, Line, Panel};
use mbs_examples::{Failure, output};

use crate::ASSUMED;
use crate::cases::Run;

/// The friction that is drawn.
const FRICTION: f64 = 0.3;

pub(crate) fn write(folder: &Path, runs: &[Run]) -> Result<(), Failure> {
    let shown: Vec<&Run> = runs.iter().filter(|run| run.friction == FRICTION).collect();
    let ways = shown.len() / 3;
    for hole in 0..ways {
        let of_hole: Vec<&Run> = shown.iter().skip(hole).step_by(ways).copied().collect();
        let [aside, tilt] = of_hole[0].error.map(|error| 1e3 * error);
        let title = format!("Peg into a hole {aside} mm aside that leans by {tilt} mrad, μ = {FRICTION}");
        let name = format!("assembly_cell_{}", hole + 1);
        let panels = vec![
            panel("push of the wrist [N]", &of_hole, &|s| -s.push[2]),
            panel("its force to the side [N]", &of_hole, &|s| s.push[0]),
            panel("depth of the tip [mm]", &of_hole, &|s| 1e3 * s.depth),
            panel("peg leans by [mrad]", &of_hole, &|s| 1e3 * s.tilt),
        ];
        let figure = Figure { title, size: (1000, 950), panels };
        output::write_figure(folder, &name, &figure, &ASSUMED)?;
        for run in of_hole {
            table(folder, &format!("{name}_{}", run.way.replace(' ', "_")), run)?;
        }
    }
    Ok(())
}

/// From just before the peg is at the hole.
fn panel(label: &str, runs: &[&Run], value: &dyn Fn(&Sample) -> f64) -> Panel {
    let end = runs.iter().map(|run| run.found.end).fold(0.0, f64::max);
    let from = runs[0].insertion;
    let line = |run: &&Run| {
        let seen = run.samples.iter().filter(|sample| sample.t >= from);
        Line::new(run.way, seen.map(|sample| (sample.t, value(sample))).collect())
    };
    Panel::over_time(label, from..end, runs.iter().map(line).collect())
}

fn table(folder: &Path, name: &str, run: &Run) -> Result<(), Failure> {
    let corners = "corner_left_N corner_right_N edge_left_N edge_right_N";
    let words = format!("t_s push_x_N push_y_N push_z_N {corners} depth_m tilt_rad");
    let row = |s: &Sample| [&[s.t][..], &s.push, &s.normal, &[s.depth, s.tilt]].concat();
    output::write_table(folder, name, &words, run.samples.iter().map(row))
}
