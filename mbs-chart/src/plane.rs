//! Paths in a plane, both axes to the same scale, with a legend to the right.

use std::ops::Range;

use plotters::prelude::*;

use crate::{Axis, Canvas, Drawn, color, draw_axes, draw_legend};

/// Points that are drawn as one line: where a line in a PNG crosses itself it is not filled.
const PIECE: usize = 32;

/// Some paths on common axes of one scale.
#[derive(Clone, Debug)]
pub struct Plane {
    /// What the axes say, with their unit: to the right, up.
    pub labels: [String; 2],
    /// At least one.
    pub lines: Vec<PlaneLine>,
    /// Points with a word beside them.
    pub marks: Vec<([f64; 2], String)>,
}

/// One path and its name in the legend.
#[derive(Clone, Debug)]
pub struct PlaneLine {
    name: String,
    points: Vec<[f64; 2]>,
}

impl PlaneLine {
    /// The points in the order in which they are passed.
    #[must_use]
    pub fn new(name: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.into(), points }
    }
}

/// From the least to the greatest; a range of no length where there is nothing.
fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values
        .filter(|x| x.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low > high { [0.0, 0.0] } else { [low, high] }
}

/// Ranges of one scale in an area of `pixels`, with a margin all around.
fn ranges(extents: [[f64; 2]; 2], pixels: [f64; 2]) -> [Range<f64>; 2] {
    let length = |axis: usize| extents[axis][1] - extents[axis][0];
    let magnitude = extents.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let least = if magnitude > 0.0 { 1e-9 * magnitude } else { 1.0 };
    let scale = 1.08 * (length(0).max(least) / pixels[0]).max(length(1).max(least) / pixels[1]);
    [0, 1].map(|axis| {
        let middle = 0.5 * (extents[axis][0] + extents[axis][1]);
        let half = 0.5 * scale * pixels[axis];
        middle - half..middle + half
    })
}

pub(super) fn draw<D: DrawingBackend>(plane: &Plane, canvas: &Canvas<D>) -> Drawn<D> {
    let (width, height) = canvas.area.dim_in_pixel();
    let (chart_area, legend_area) = canvas.area.split_horizontally(width.saturating_sub(canvas.length(170)));
    let [margin, below, left] = [10, 44, 86].map(|length| canvas.length(length));
    let inner =
        [width.saturating_sub(canvas.length(170) + 2 * margin + left), height.saturating_sub(2 * margin + below)];
    let coordinates = |axis: usize| {
        let points = plane.lines.iter().flat_map(|line| &line.points);
        points.chain(plane.marks.iter().map(|(point, _)| point)).map(move |point| point[axis])
    };
    let [x, y] = ranges([extent(coordinates(0)), extent(coordinates(1))], inner.map(|pixels| f64::from(pixels.max(1))));
    let mut chart = ChartBuilder::on(&chart_area)
        .margin(margin)
        .x_label_area_size(below)
        .y_label_area_size(left)
        .build_cartesian_2d(x.clone(), y.clone())?;
    let [right, up] = &plane.labels;
    let axes = [Axis { label: right, range: x, ticks: 8 }, Axis { label: up, range: y, ticks: 8 }];
    draw_axes(&mut chart, &axes, canvas)?;
    for (i, line) in plane.lines.iter().enumerate() {
        let is_finite = |point: &&[f64; 2]| point.iter().all(|x| x.is_finite());
        let finite: Vec<(f64, f64)> = line.points.iter().filter(is_finite).map(|&[x, y]| (x, y)).collect();
        for start in (0..finite.len()).step_by(PIECE) {
            let piece = finite[start..finite.len().min(start + PIECE + 1)].iter().copied();
            chart.draw_series(LineSeries::new(piece, canvas.stroke(color(i, plane.lines.len()), 2)))?;
        }
    }
    for ([x, y], word) in &plane.marks {
        let dot = || Circle::new((0, 0), canvas.length(3), BLACK.filled());
        let text = Text::new(word.clone(), canvas.place(6, -16), canvas.font(14));
        chart.plotting_area().draw(&(EmptyElement::at((*x, *y)) + dot() + text))?;
    }
    let names: Vec<&str> = plane.lines.iter().map(|line| line.name.as_str()).collect();
    draw_legend(&names, &canvas.with(legend_area))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_one_scale() {
        let [x, y] = ranges([[-1.0, 3.0], [0.0, 1.0]], [800.0, 400.0]);
        assert!(((x.end - x.start) / 800.0 - (y.end - y.start) / 400.0).abs() < 1e-12);
        assert!(x.start < -1.0 && x.end > 3.0 && y.start < 0.0 && y.end > 1.0);
        // Nothing, and a single point, still have a scale.
        for at in [0.0, 5.0] {
            assert!(ranges([[at, at], [at, at]], [800.0, 400.0]).iter().all(|range| range.end > range.start));
        }
    }
}
