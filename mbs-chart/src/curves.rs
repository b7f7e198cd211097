//! Lines over one horizontal axis, with a legend to the right.

use std::ops::Range;

use plotters::prelude::*;

use crate::{Axis, Canvas, Drawn, color, draw_axes, draw_legend};

/// A line has at most this many points; beyond that a bucket of points is drawn by its extremes.
const POINTS: usize = 4000;

/// Some lines on common axes.
#[derive(Clone, Debug)]
pub struct Curves {
    /// What the horizontal axis says, with its unit.
    pub x_label: String,
    /// What the vertical axis says, with its unit.
    pub y_label: String,
    /// From where to where; the vertical axis goes as far as the lines do.
    pub x_range: Range<f64>,
    /// At least one.
    pub lines: Vec<Line>,
}

/// One line and its name in the legend.
#[derive(Clone, Debug)]
pub struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

impl Line {
    /// The points in the order of their `x`; of more than some thousands the lowest and the highest of each bucket are
    /// kept.
    #[must_use]
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        let points = if points.len() <= POINTS {
            points
        } else {
            points.chunks(points.len().div_ceil(POINTS / 2)).flat_map(extremes).collect()
        };
        Line { name: name.into(), points }
    }
}

/// The lowest and the highest point, in order of `x`.
fn extremes(bucket: &[(f64, f64)]) -> [(f64, f64); 2] {
    let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    let lowest = bucket.iter().min_by(by_value).copied().unwrap_or_default();
    let highest = bucket.iter().max_by(by_value).copied().unwrap_or_default();
    if lowest.0 <= highest.0 { [lowest, highest] } else { [highest, lowest] }
}

/// From the lowest to the highest value with a margin; what varies by rounding alone stays a flat line.
fn value_range(lines: &[Line]) -> Range<f64> {
    let values = || lines.iter().flat_map(|line| &line.points).map(|point| point.1).filter(|y| y.is_finite());
    let (lowest, highest) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(y), b.max(y)));
    if lowest > highest {
        return -1.0..1.0;
    }
    let magnitude = lowest.abs().max(highest.abs());
    let least = if magnitude > 0.0 { 1e-3 * magnitude } else { 1.0 };
    let (middle, half) = (0.5 * (lowest + highest), 0.53 * (highest - lowest).max(least));
    middle - half..middle + half
}

pub(super) fn draw<D: DrawingBackend>(curves: &Curves, canvas: &Canvas<D>) -> Drawn<D> {
    let (width, _) = canvas.area.dim_in_pixel();
    let (chart_area, legend_area) = canvas.area.split_horizontally(width.saturating_sub(canvas.length(170)));
    let (abscissas, values) = (curves.x_range.clone(), value_range(&curves.lines));
    let mut chart = ChartBuilder::on(&chart_area)
        .margin(canvas.length(10))
        .x_label_area_size(canvas.length(44))
        .y_label_area_size(canvas.length(76))
        .build_cartesian_2d(abscissas.clone(), values.clone())?;
    let axes = [
        Axis { label: &curves.x_label, range: abscissas, ticks: 11 },
        Axis { label: &curves.y_label, range: values, ticks: 7 },
    ];
    draw_axes(&mut chart, &axes, canvas)?;
    for (i, line) in curves.lines.iter().enumerate() {
        let finite = line.points.iter().copied().filter(|point| point.1.is_finite());
        chart.draw_series(LineSeries::new(finite, canvas.stroke(color(i, curves.lines.len()), 2)))?;
    }
    let names: Vec<&str> = curves.lines.iter().map(|line| line.name.as_str()).collect();
    draw_legend(&names, &canvas.with(legend_area))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_survive_where_points_are_many() {
        let quiet = |i: usize| (i as f64, if i == 70_000 { 5.0 } else { 0.0 });
        let drawn = Line::new("quiet", (0..100_000).map(quiet).collect()).points;
        assert_eq!((drawn.len(), drawn.contains(&(70_000.0, 5.0))), (4000, true));
        assert!(drawn.is_sorted_by(|a, b| a.0 <= b.0));
    }
}
