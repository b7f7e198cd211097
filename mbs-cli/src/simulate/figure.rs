//! The motion as a figure over time: a panel for the coordinates of each unit, for the velocities, for the energies,
//! and for what was recorded besides.

use std::ops::Range;

use mbs_chart::{Curves, Figure, Format, Line, Panel};

use super::motion::{Motion, Row};
use crate::failure::Failure;

/// Width in pixels, the least height, and the height of a panel.
const WIDTH: u32 = 1100;
const LEAST_HEIGHT: u32 = 1000;
const PANEL_HEIGHT: u32 = 300;

/// The bytes of the figure.
pub(crate) fn draw(motion: &Motion, format: Format) -> Result<Vec<u8>, Failure> {
    let panels = panels(motion);
    let height = LEAST_HEIGHT.max(PANEL_HEIGHT * u32::try_from(panels.len()).unwrap_or(u32::MAX / PANEL_HEIGHT));
    let last = motion.rows.last().map_or(0.0, |row| row.t);
    let title = match motion.stopped {
        Some(_) => format!("{}, stopped after t = {last:.4} s", motion.name),
        None => motion.name.clone(),
    };
    let figure = Figure { title, size: (WIDTH, height), panels };
    mbs_chart::draw(&figure, format).map_err(Failure::new)
}

/// Multipliers and residuals of constraints are in the table alone.
fn panels(motion: &Motion) -> Vec<Panel> {
    let mut groups: Vec<((&str, &str), Vec<usize>)> = Vec::new();
    for (i, column) in motion.columns.iter().enumerate() {
        let key = (column.what, column.unit.as_str());
        match groups.iter_mut().find(|(own, _)| *own == key) {
            _ if matches!(column.what, "multipliers" | "residuals") => {}
            Some((_, numbers)) => numbers.push(i),
            None => groups.push((key, vec![i])),
        }
    }
    let panel = |((what, unit), numbers): ((&str, &str), Vec<usize>)| {
        let of_column = |i: usize| line(motion, &motion.columns[i].label, |row| row.values[i]);
        let lines = if what == "energy" { energies(motion) } else { numbers.into_iter().map(of_column).collect() };
        let y_label = if matches!(unit, "" | "1") { what.to_string() } else { format!("{what} [{unit}]") };
        Panel::Curves(Curves { x_label: "t [s]".to_string(), y_label, x_range: time_range(motion), lines })
    };
    groups.into_iter().map(panel).collect()
}

fn energies(motion: &Motion) -> Vec<Line> {
    vec![
        line(motion, "kinetic T", |row| row.kinetic),
        line(motion, "potential V", |row| row.potential),
        line(motion, "T + V", |row| row.kinetic + row.potential),
    ]
}

fn line(motion: &Motion, name: &str, value: impl Fn(&Row) -> f64) -> Line {
    Line::new(name, motion.rows.iter().map(|row| (row.t, value(row))).collect())
}

fn time_range(motion: &Motion) -> Range<f64> {
    let first = motion.rows.first().map_or(0.0, |row| row.t);
    let last = motion.rows.last().map_or(0.0, |row| row.t);
    if first < last { first..last } else { first - 0.5..first + 0.5 }
}
