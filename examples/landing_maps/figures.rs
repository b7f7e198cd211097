//! The maps as figures and tables.

use std::path::Path;

use mbs_chart::{Cell, Cells, Figure, Panel};
use mbs_examples::{Failure, output};

use crate::map::{Grid, Map, Outcome, PHASES, REASONS};

/// `landing_time_LAW`: four phases, two by two; all with one bar.
pub(crate) fn write(folder: &Path, grid: &Grid, map: &Map) -> Result<(), Failure> {
    let cell = |outcome: &Outcome| match (outcome, outcome.reason_index()) {
        (Outcome::Lands(time), _) => Cell::Value(*time),
        (_, reason) => Cell::None(reason.unwrap_or(0)),
    };
    let [low, high] = map.range();
    // A map without a landing still has a bar.
    let range = if low < high { [low, high] } else { [0.0, 1.0] };
    let panel = |phase: usize| {
        Panel::Cells(Cells {
            labels: ["amplitude A [m]".to_string(), format!("ω [rad/s], φ = {}°", PHASES[phase])],
            edges: grid.edges(),
            values: map.phases[phase].iter().map(|row| row.iter().map(cell).collect()).collect(),
            value_label: "t [s]".to_string(),
            range,
            reasons: REASONS.map(String::from).into(),
        })
    };
    let panels = vec![Panel::Row(vec![panel(0), panel(1)]), Panel::Row(vec![panel(2), panel(3)])];
    let title = format!("Landing time on a deck that heaves by A sin(ωt + φ): {}", map.law.name());
    let name = format!("landing_time_{}", map.law.key());
    output::write_figure(folder, &name, &Figure { title, size: (1000, 900), panels }, &crate::assumed_keys())?;
    // Rows of what lands.
    let rows = PHASES.iter().zip(&map.phases).flat_map(|(phase, rows)| {
        rows.iter().zip(&grid.frequencies).flat_map(move |(row, w)| {
            row.iter().zip(&grid.amplitudes).filter_map(move |(outcome, a)| match outcome {
                Outcome::Lands(time) => Some(vec![*phase, *w, *a, *time]),
                Outcome::TooLong | Outcome::DeckFalls | Outcome::AttitudeLost => None,
            })
        })
    });
    output::write_table(folder, &name, "phase_deg frequency_rad_s amplitude_m time_s", rows)
}
