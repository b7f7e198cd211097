//! Lines in space, in parallel projection, with the walls behind them and their shadow on the floor.

use std::ops::Range;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::{Canvas, Drawn, GRID, color, draw_legend, tick};

/// Some lines in a box with axes, all three to the same scale.
#[derive(Clone, Debug)]
pub struct Space {
    /// What the axes say, with their units: to the right, away, up.
    pub labels: [String; 3],
    /// At least one.
    pub lines: Vec<SpaceLine>,
}

/// One line, its name in the legend, and points marked on it.
#[derive(Clone, Debug)]
pub struct SpaceLine {
    /// In the legend.
    pub name: String,
    /// In order.
    pub points: Vec<[f64; 3]>,
    /// Points with a word beside them.
    pub marks: Vec<([f64; 3], String)>,
}

/// From where the box is seen: to the right of the second axis' negative end, and from above \[°\].
const AZIMUTH: f64 = -60.0;
const ELEVATION: f64 = 24.0;
/// Ticks on an axis, about.
const TICKS: f64 = 5.0;
/// Of shadows.
const SHADOW: RGBColor = RGBColor(170, 170, 170);

/// Multiples of 1, 2 or 5 times a power of ten.
struct Axis {
    range: Range<f64>,
    step: f64,
}

impl Axis {
    /// Around the values, at least a quarter as long as `longest`.
    fn new(values: impl Iterator<Item = f64> + Clone, longest: f64) -> Self {
        let (low, high) = values
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        let (low, high) = if low > high { (-0.5, 0.5) } else { (low, high) };
        let room = (0.25 * longest - (high - low)).max(0.0) / 2.0;
        let (low, high) = (low - room, high + room);
        let rough = longest.max(high - low).max(1e-9) / TICKS;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(10.0 * power);
        Axis { range: (low / step).floor() * step..(high / step).ceil() * step, step }
    }

    fn ticks(&self) -> impl Iterator<Item = f64> {
        let (start, step) = (self.range.start, self.step);
        let count = ((self.range.end - start) / step).round() as usize;
        (0..=count).map(move |k| start + k as f64 * step)
    }
}

/// From the box to the screen.
struct View {
    scale: f64,
    /// Of the screen's origin.
    shift: (f64, f64),
}

impl View {
    /// To the right and up, in the unit of the box.
    fn flat([x, y, z]: [f64; 3]) -> (f64, f64) {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (AZIMUTH.to_radians().sin_cos(), ELEVATION.to_radians().sin_cos());
        (cos_a * y - sin_a * x, cos_e * z - sin_e * (cos_a * x + sin_a * y))
    }

    /// The box in the middle of an area, within a margin for its labels.
    fn new(axes: &[Axis; 3], (width, height): (u32, u32), margin: (u32, u32)) -> Self {
        let corner = |k: usize, i: usize| if k >> i & 1 == 0 { axes[i].range.start } else { axes[i].range.end };
        let corners: Vec<(f64, f64)> = (0..8).map(|k| Self::flat([0, 1, 2].map(|i| corner(k, i)))).collect();
        let range = |of: fn(&(f64, f64)) -> f64| {
            corners.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((left, right), (low, high)) = (range(|p| p.0), range(|p| p.1));
        let room = |size: u32, margin: u32| f64::from(size.saturating_sub(2 * margin).max(1));
        let scale = f64::min(room(width, margin.0) / (right - left), room(height, margin.1) / (high - low));
        let shift =
            (0.5 * (f64::from(width) - scale * (left + right)), 0.5 * (f64::from(height) + scale * (low + high)));
        View { scale, shift }
    }

    fn pixel(&self, point: [f64; 3]) -> (i32, i32) {
        let (right, up) = Self::flat(point);
        ((self.shift.0 + self.scale * right).round() as i32, (self.shift.1 - self.scale * up).round() as i32)
    }
}

pub(super) fn draw<D: DrawingBackend>(space: &Space, canvas: &Canvas<D>) -> Drawn<D> {
    let (width, _) = canvas.area.dim_in_pixel();
    let (area, legend_area) = canvas.area.split_horizontally(width.saturating_sub(canvas.length(170)));
    let canvas = canvas.with(area);
    let component = |i: usize| space.lines.iter().flat_map(|line| &line.points).map(move |point| point[i]);
    let span = |i: usize| {
        let (low, high) = component(i).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        if low > high { 1.0 } else { high - low }
    };
    let longest = span(0).max(span(1)).max(span(2));
    let axes = [0, 1, 2].map(|i| Axis::new(component(i), longest));
    let view = View::new(&axes, canvas.area.dim_in_pixel(), (canvas.length(90), canvas.length(60)));
    draw_box(space, &axes, &view, &canvas)?;
    let floor = axes[2].range.start;
    for line in &space.lines {
        let shadow = line.points.iter().map(|[x, y, _]| view.pixel([*x, *y, floor])).collect::<Vec<_>>();
        canvas.area.draw(&PathElement::new(shadow, canvas.stroke(SHADOW, 1)))?;
    }
    for (i, line) in space.lines.iter().enumerate() {
        let stroke = canvas.stroke(color(i, space.lines.len()), 2);
        let finite = line.points.iter().filter(|point| point.iter().all(|x| x.is_finite()));
        canvas.area.draw(&PathElement::new(finite.map(|point| view.pixel(*point)).collect::<Vec<_>>(), stroke))?;
        for (point, word) in &line.marks {
            let [x, y, _] = *point;
            let (at, below) = (view.pixel(*point), view.pixel([x, y, floor]));
            canvas.area.draw(&PathElement::new(vec![at, below], canvas.stroke(SHADOW, 1)))?;
            canvas.area.draw(&Circle::new(at, canvas.length(4), stroke.filled()))?;
            // Outwards, where there is room.
            let middle = (canvas.area.dim_in_pixel().0 / 2) as i32;
            let (side, anchor) = if at.0 < middle { (-8, HPos::Right) } else { (8, HPos::Left) };
            let style = canvas.font(14).into_text_style(&canvas.area).pos(Pos::new(anchor, VPos::Bottom));
            let (dx, dy) = canvas.place(side, -4);
            canvas.area.draw(&Text::new(word.clone(), (at.0 + dx, at.1 + dy), style))?;
        }
    }
    let names: Vec<&str> = space.lines.iter().map(|line| line.name.as_str()).collect();
    draw_legend(&names, &canvas.with(legend_area))
}

/// Floor and the two walls behind, ticks and labels along the three edges in front.
fn draw_box<D: DrawingBackend>(space: &Space, axes: &[Axis; 3], view: &View, canvas: &Canvas<D>) -> Drawn<D> {
    let [x, y, z] = axes.each_ref().map(|axis| axis.range.clone());
    // Each axis with the edge that it runs along, and where its grid lines turn to on the floor or on the walls.
    let edge = |i: usize, value: f64| match i {
        0 => [[value, y.start, z.start], [value, y.end, z.start], [value, y.end, z.end]],
        1 => [[x.end, value, z.start], [x.start, value, z.start], [x.start, value, z.end]],
        _ => [[x.start, y.start, value], [x.start, y.end, value], [x.end, y.end, value]],
    };
    for (i, axis) in axes.iter().enumerate() {
        for value in axis.ticks() {
            let line = edge(i, value).map(|point| view.pixel(point)).to_vec();
            canvas.area.draw(&PathElement::new(line, canvas.stroke(GRID, 1)))?;
        }
    }
    for (i, axis) in axes.iter().enumerate() {
        let ends = [axis.range.start, axis.range.end].map(|value| view.pixel(edge(i, value)[0]));
        canvas.area.draw(&PathElement::new(ends.to_vec(), canvas.stroke(BLACK, 1)))?;
        // Away from the box: down and out, by the edge.
        let (right, down) = [(0, 18), (14, 12), (-10, 0)][i];
        let anchor = [
            Pos::new(HPos::Right, VPos::Center),
            Pos::new(HPos::Left, VPos::Center),
            Pos::new(HPos::Right, VPos::Center),
        ][i];
        let text = |size: u32| canvas.font(size).into_text_style(&canvas.area).pos(anchor);
        for value in axis.ticks() {
            let (a, b) = view.pixel(edge(i, value)[0]);
            let (dx, dy) = canvas.place(right, down);
            canvas.area.draw(&Text::new(tick(value, &axis.range), (a + dx, b + dy), text(14)))?;
        }
        let middle = view.pixel(edge(i, 0.5 * (axis.range.start + axis.range.end))[0]);
        let (dx, dy) = canvas.place([-40, 48, -48][i], [42, 38, 0][i]);
        canvas.area.draw(&Text::new(space.labels[i].clone(), (middle.0 + dx, middle.1 + dy), text(16)))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_ticks_around_the_values() {
        let axis = Axis::new([-0.63, 1.04].into_iter(), 1.67);
        assert_eq!((axis.range.clone(), axis.step), (-1.0..1.5, 0.5));
        assert_eq!(axis.ticks().collect::<Vec<_>>(), [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5]);
        // One value alone has room around it.
        let axis = Axis::new([2.0, 2.0].into_iter(), 4.0);
        assert!(axis.range.start <= 1.5 && axis.range.end >= 2.5);
        assert!(Axis::new(std::iter::empty(), 1.0).range.start < 0.0);
    }

    #[test]
    fn the_box_fills_its_area_and_keeps_up_up() {
        let axes = [0.0..1.0, 0.0..2.0, 0.0..1.0].map(|range| Axis { range, step: 0.5 });
        let view = View::new(&axes, (800, 600), (50, 50));
        let corners = (0..8).map(|k| {
            view.pixel([0, 1, 2].map(|i| if k >> i & 1 == 0 { axes[i].range.start } else { axes[i].range.end }))
        });
        for (x, y) in corners {
            assert!((50..=750).contains(&x) && (50..=550).contains(&y), "({x}, {y})");
        }
        assert!(view.pixel([0.5, 1.0, 1.0]).1 < view.pixel([0.5, 1.0, 0.0]).1);
        assert!(view.pixel([1.0, 1.0, 0.0]).0 > view.pixel([0.0, 1.0, 0.0]).0);
    }
}
