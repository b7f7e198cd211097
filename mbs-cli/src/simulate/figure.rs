//! The motion as a figure: coordinates, velocities and energies over time, one panel each.

use std::ops::Range;

use mbs_cli::chart::{self, Curves, Figure, Format, Line, Panel};

use super::motion::{Motion, Row};
use crate::failure::Failure;

/// Width and height in pixels.
const SIZE: (u32, u32) = (1100, 1000);

/// The bytes of the figure.
pub(crate) fn draw(motion: &Motion, format: Format) -> Result<Vec<u8>, Failure> {
    let figure = Figure { title: motion.name.clone(), size: SIZE, panels: panels(motion) };
    chart::draw(&figure, format).map_err(Failure::new)
}

fn panels(motion: &Motion) -> Vec<Panel> {
    let rates: Vec<String> = motion.units.iter().map(|unit| rate_unit(unit)).collect();
    let names: Vec<String> = motion.coordinates.iter().map(|name| format!("d{name}/dt")).collect();
    let energies = vec![
        line(motion, "kinetic T", |row| row.kinetic),
        line(motion, "potential V", |row| row.potential),
        line(motion, "T + V", |row| row.kinetic + row.potential),
    ];
    vec![
        of_components(motion, "coordinates", &motion.coordinates, &motion.units, |row, i| row.q[i]),
        of_components(motion, "velocities", &names, &rates, |row, i| row.qd[i]),
        over_time(motion, "energy [J]".to_string(), energies),
    ]
}

/// `rad/s`, `1/s`, `(m/s)/s`
fn rate_unit(unit: &str) -> String {
    if unit.contains('/') { format!("({unit})/s") } else { format!("{unit}/s") }
}

/// The unit is at the axis where all have the same, else in the legend.
fn of_components(
    motion: &Motion,
    what: &str,
    names: &[String],
    units: &[String],
    value: impl Fn(&Row, usize) -> f64,
) -> Panel {
    let common = units.iter().all(|unit| *unit == units[0]);
    let label = match units.first() {
        Some(unit) if common => format!("{what} [{unit}]"),
        _ => what.to_string(),
    };
    let name = |i: usize| if common { names[i].clone() } else { format!("{} [{}]", names[i], units[i]) };
    let lines = (0..names.len()).map(|i| line(motion, &name(i), |row| value(row, i))).collect();
    over_time(motion, label, lines)
}

fn over_time(motion: &Motion, y_label: String, lines: Vec<Line>) -> Panel {
    Panel::Curves(Curves { x_label: "t [s]".to_string(), y_label, x_range: time_range(motion), lines })
}

fn line(motion: &Motion, name: &str, value: impl Fn(&Row) -> f64) -> Line {
    Line::new(name, motion.rows.iter().map(|row| (row.t, value(row))).collect())
}

fn time_range(motion: &Motion) -> Range<f64> {
    let first = motion.rows.first().map_or(0.0, |row| row.t);
    let last = motion.rows.last().map_or(0.0, |row| row.t);
    if first < last { first..last } else { first - 0.5..first + 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_rates() {
        assert_eq!(["rad", "1", "m/s"].map(rate_unit), ["rad/s", "1/s", "(m/s)/s"]);
    }
}
