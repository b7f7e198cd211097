//! Lines in space, in parallel projection, with the walls behind them and their shadow on the floor.

use std::ops::Range;

use crate::axis::{LABEL_SIZE, Scale, TICK_SIZE, extent, round_step};
use crate::camera::Camera;
use crate::font::Typeface;
use crate::legend::Legend;
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::{BLACK, Color, GRID, Stroke, stroke};

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

/// Ticks on an axis, about.
const TICKS: f64 = 5.0;
/// The color of shadows.
const SHADOW: Color = Color(178, 178, 178);

/// Around the values, at least a quarter as long as `longest`, from tick to tick.
fn scale(values: impl Iterator<Item = f64>, longest: f64) -> Scale {
    let [low, high] = extent(values).unwrap_or([-0.5, 0.5]);
    let room = (0.25 * longest - (high - low)).max(0.0) / 2.0;
    let (low, high) = (low - room, high + room);
    let step = round_step(longest.max(high - low).max(1e-9) / TICKS);
    Scale { range: (low / step).floor() * step..(high / step).ceil() * step, step }
}

/// From the box to the screen.
struct View {
    scale: f64,
    /// The place of the box's origin on the screen.
    shift: [f64; 2],
}

impl View {
    /// The box in the middle of an area, within margins at its sides, above and below for its labels.
    fn new(axes: &[Scale; 3], area: Rect, [sides, above, below]: [f64; 3]) -> Self {
        let corner = |k: usize, i: usize| if k >> i & 1 == 0 { axes[i].range.start } else { axes[i].range.end };
        let corners: Vec<[f64; 2]> = (0..8).map(|k| Camera::USUAL.flat([0, 1, 2].map(|i| corner(k, i)))).collect();
        let range = |i: usize| -> Range<f64> {
            let (low, high) = corners
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[i]), high.max(p[i])));
            low..high
        };
        let ([x, y], inner) = ([range(0), range(1)], area.inset([sides, above, sides, below]));
        let scale = f64::min(inner.width / (x.end - x.start), inner.height / (y.end - y.start));
        let shift = [
            inner.x + 0.5 * (inner.width - scale * (x.start + x.end)),
            inner.y + 0.5 * (inner.height + scale * (y.start + y.end)),
        ];
        View { scale, shift }
    }

    fn pixel(&self, point: [f64; 3]) -> [f64; 2] {
        let [right, up] = Camera::USUAL.flat(point);
        [self.shift[0] + self.scale * right, self.shift[1] - self.scale * up]
    }
}

impl Space {
    fn legend<'a>(&'a self, face: &'a Typeface, width: f64) -> Legend<'a> {
        Legend::new(self.lines.iter().map(|line| line.name.as_str()).collect(), face, width)
    }

    /// Above and below the box \[px\].
    pub(crate) fn margins(&self, face: &Typeface, width: f64) -> [f64; 2] {
        [8.0 + self.legend(face, width).height(), 0.0]
    }

    pub(crate) fn draw(&self, scene: &mut Scene<'_>, area: Rect) {
        let face = scene.face;
        let legend = self.legend(face, area.width);
        legend.draw(scene, area.right(), area.y - legend.height());
        let component = |i: usize| self.lines.iter().flat_map(|line| &line.points).map(move |point| point[i]);
        let span = |i: usize| extent(component(i)).map_or(1.0, |[low, high]| high - low);
        let longest = span(0).max(span(1)).max(span(2));
        // What stays at a point has a box, too; of greater numbers the next one is further away than 1.
        let greatest =
            [0, 1, 2].into_iter().flat_map(component).filter(|x| x.is_finite()).fold(0.0, |m: f64, x| m.max(x.abs()));
        let longest = if longest.is_normal() { longest } else { (1e-9 * greatest).max(1.0) };
        let axes = [0, 1, 2].map(|i| scale(component(i), longest));
        let view = View::new(&axes, area, [70.0, 14.0, 52.0]);
        self.draw_box(scene, &axes, &view);
        let floor = axes[2].range.start;
        for line in &self.lines {
            scene.line(line.points.iter().map(|[x, y, _]| view.pixel([*x, *y, floor])), Stroke::new(SHADOW, 1.0));
        }
        for (i, line) in self.lines.iter().enumerate() {
            let own = stroke(i, self.lines.len());
            scene.line(line.points.iter().map(|point| view.pixel(*point)), own);
            for (point, word) in &line.marks {
                let [x, y, _] = *point;
                let at = view.pixel(*point);
                scene.line([at, view.pixel([x, y, floor])], Stroke::new(SHADOW, 1.0));
                scene.dot(at, 4.0, own.color);
                // Outwards, where there is room.
                let is_left = at[0] < area.x + 0.5 * area.width;
                let (side, anchor) = if is_left { (-9.0, Anchor::End) } else { (9.0, Anchor::Start) };
                scene.text(Text::new([at[0] + side, at[1] - 10.0], word, 13.0, anchor));
            }
        }
    }

    /// Floor and the two walls behind, ticks and labels along the three edges in front.
    fn draw_box(&self, scene: &mut Scene<'_>, axes: &[Scale; 3], view: &View) {
        let [x, y, z] = axes.each_ref().map(|axis| axis.range.clone());
        // Each axis with the edge that it runs along, and where its grid lines turn to on the floor or on the walls.
        let edge = |i: usize, value: f64| match i {
            0 => [[value, y.start, z.start], [value, y.end, z.start], [value, y.end, z.end]],
            1 => [[x.end, value, z.start], [x.start, value, z.start], [x.start, value, z.end]],
            _ => [[x.start, y.start, value], [x.start, y.end, value], [x.end, y.end, value]],
        };
        for (i, axis) in axes.iter().enumerate() {
            for value in axis.ticks() {
                scene.line(edge(i, value).map(|point| view.pixel(point)), Stroke::new(GRID, 1.0));
            }
        }
        for (i, axis) in axes.iter().enumerate() {
            let ends = [axis.range.start, axis.range.end].map(|value| view.pixel(edge(i, value)[0]));
            scene.line(ends, Stroke::new(BLACK, 1.2));
            // Away from the box: down and out, by the edge.
            let [right, down] = [[-4.0, 14.0], [9.0, 10.0], [-8.0, 0.0]][i];
            let anchor = [Anchor::End, Anchor::Start, Anchor::End][i];
            for value in axis.ticks() {
                let [a, b] = view.pixel(edge(i, value)[0]);
                scene.text(Text::new([a + right, b + down], &axis.number(value), TICK_SIZE, anchor));
            }
            let [a, b] = view.pixel(edge(i, 0.5 * (axis.range.start + axis.range.end))[0]);
            let [right, down] = [[-34.0, 36.0], [40.0, 34.0], [-52.0, 0.0]][i];
            scene.text(Text::new([a + right, b + down], &self.labels[i], LABEL_SIZE, anchor));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_ticks_around_the_values() {
        let axis = scale([-0.63, 1.04].into_iter(), 1.67);
        assert_eq!((axis.range.clone(), axis.step), (-1.0..1.5, 0.5));
        assert_eq!(axis.ticks(), [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5]);
        // One value alone has room around it.
        let axis = scale([2.0, 2.0].into_iter(), 4.0);
        assert!(axis.range.start <= 1.5 && axis.range.end >= 2.5);
        assert!(scale(std::iter::empty(), 1.0).range.start < 0.0);
    }

    #[test]
    fn a_body_that_stays_has_a_box() {
        use crate::{Figure, Format, Panel, draw};
        for place in [0.0, -3.0, 1e20] {
            let line = SpaceLine { name: "still".to_string(), points: vec![[place; 3]; 2], marks: Vec::new() };
            let space = Space { labels: ["x", "y", "z"].map(String::from), lines: vec![line] };
            let figure = Figure { title: String::new(), size: (500, 300), panels: vec![Panel::Space(space)] };
            let svg = String::from_utf8(draw(&figure, Format::Svg).unwrap()).unwrap();
            // At least two ticks on each axis, with their lines.
            assert!(svg.matches("<text").count() >= 9 && svg.matches("<path").count() >= 9, "{place}: {svg}");
        }
    }

    #[test]
    fn the_box_fills_its_area_and_keeps_up_up() {
        let axes = [0.0..1.0, 0.0..2.0, 0.0..1.0].map(|range| Scale { range, step: 0.5 });
        let area = Rect { x: 0.0, y: 0.0, width: 800.0, height: 600.0 };
        let view = View::new(&axes, area, [50.0; 3]);
        let corners = (0..8).map(|k| {
            view.pixel([0, 1, 2].map(|i| if k >> i & 1 == 0 { axes[i].range.start } else { axes[i].range.end }))
        });
        for [x, y] in corners {
            assert!((49.9..=750.1).contains(&x) && (49.9..=550.1).contains(&y), "({x}, {y})");
        }
        assert!(view.pixel([0.5, 1.0, 1.0])[1] < view.pixel([0.5, 1.0, 0.0])[1]);
        assert!(view.pixel([1.0, 1.0, 0.0])[0] > view.pixel([0.0, 1.0, 0.0])[0]);
    }
}
