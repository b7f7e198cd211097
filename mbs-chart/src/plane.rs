//! Paths in a plane, both axes to the same scale, with a legend above.

use std::ops::Range;

use crate::axis::{self, BELOW_LABEL, BELOW_TICKS, LABEL_SIZE, Scale};
use crate::font::Typeface;
use crate::legend::{Legend, ROW};
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::{BLACK, stroke};

/// Left of the axis: its numbers \[px\].
pub(crate) const LEFT: f64 = 76.0;
/// The size of words at points \[px\].
const MARK_SIZE: f64 = 12.5;

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

impl Plane {
    fn legend<'a>(&'a self, face: &'a Typeface, width: f64) -> Legend<'a> {
        Legend::new(self.lines.iter().map(|line| line.name.as_str()).collect(), face, width)
    }

    fn is_beside(&self, legend: &Legend<'_>, face: &Typeface, width: f64) -> bool {
        let label = face.width(&self.labels[1], LABEL_SIZE);
        legend.single_row().is_some_and(|row| row + label + 40.0 < width)
    }

    /// Above and below the chart \[px\].
    pub(crate) fn margins(&self, face: &Typeface, width: f64) -> [f64; 2] {
        let legend = self.legend(face, width);
        let rows = if self.is_beside(&legend, face, width) { 0.0 } else { legend.height() };
        [8.0 + rows + ROW, BELOW_TICKS + BELOW_LABEL]
    }

    /// Into the area of the chart alone.
    pub(crate) fn draw(&self, scene: &mut Scene<'_>, area: Rect) {
        let coordinates = |axis: usize| {
            let points = self.lines.iter().flat_map(|line| &line.points);
            points.chain(self.marks.iter().map(|(point, _)| point)).map(move |point| point[axis])
        };
        let extents = [0, 1].map(|axis| axis::extent(coordinates(axis)).unwrap_or_default());
        let [x, y] = ranges(extents, [area.width, area.height]);
        let (x, mut y) =
            (Scale::new(x, (area.width / 70.0).clamp(2.0, 12.0)), Scale::new(y, (area.height / 40.0).max(2.0)));
        // One step for both, where that leaves ticks enough.
        if x.step > y.step && y.range.end - y.range.start > 3.0 * x.step {
            y.step = x.step;
        }
        axis::draw(scene, area, [&x, &y], Some(&self.labels[0]));
        let face = scene.face;
        let legend = self.legend(face, area.width);
        let rows = if self.is_beside(&legend, face, area.width) { 0.0 } else { legend.height() };
        legend.draw(scene, area.right(), area.y - ROW - 3.0 - rows);
        let label = [area.x - 14.0, area.y - 0.5 * ROW - 3.0];
        scene.text(Text::new(label, &self.labels[1], LABEL_SIZE, Anchor::Start));
        let pixel = |[a, b]: [f64; 2]| [x.pixel(a, area.x, area.right()), y.pixel(b, area.bottom(), area.y)];
        for (i, line) in self.lines.iter().enumerate() {
            scene.line(line.points.iter().map(|point| pixel(*point)), stroke(i, self.lines.len()));
        }
        let dot = |[x, y]: [f64; 2]| Rect { x: x - 4.0, y: y - 4.0, width: 8.0, height: 8.0 };
        let mut taken: Vec<Rect> = self.marks.iter().map(|(point, _)| dot(pixel(*point))).collect();
        for (point, word) in &self.marks {
            let at = pixel(*point);
            scene.dot(at, 3.0, BLACK);
            let width = face.width(word, MARK_SIZE);
            // To the right if there is room, else to the left; above, else below.
            let sides = [(7.0, Anchor::Start), (-7.0, Anchor::End)];
            let places = [-11.0, 13.0].into_iter().flat_map(|down| sides.map(|(right, anchor)| (right, down, anchor)));
            let free = places.map(|(right, down, anchor)| {
                let left = if anchor == Anchor::End { at[0] + right - width } else { at[0] + right };
                (right, down, anchor, Rect { x: left, y: at[1] + down - 8.0, width, height: 16.0 })
            });
            let is_free = |rect: &Rect| {
                rect.x > area.x && rect.right() < area.right() + 4.0 && !taken.iter().any(|other| other.overlaps(rect))
            };
            let all: Vec<_> = free.collect();
            let (right, down, anchor, rect) =
                all.iter().find(|(_, _, _, rect)| is_free(rect)).copied().unwrap_or(all[0]);
            scene.text(Text::new([at[0] + right, at[1] + down], word, MARK_SIZE, anchor));
            taken.push(rect);
        }
    }
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
