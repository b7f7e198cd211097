//! What a figure consists of: lines, areas, dots and texts, in pixels from its upper left corner.

use crate::font::Typeface;
use crate::style::{BLACK, Color, Stroke};

/// Points that are off a line by less are left out \[px\].
const TOLERANCE: f64 = 0.06;

/// A part of the figure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rect {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    /// Without strips at its left, top, right and bottom; nothing is left of what is too small.
    pub(crate) fn inset(self, [left, top, right, bottom]: [f64; 4]) -> Self {
        Rect {
            x: self.x + left,
            y: self.y + top,
            width: (self.width - left - right).max(1.0),
            height: (self.height - top - bottom).max(1.0),
        }
    }

    pub(crate) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.x < other.right() && other.x < self.right() && self.y < other.bottom() && other.y < self.bottom()
    }
}

/// Which point of a text is placed; up and down it is always the middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A piece of a text.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) text: String,
    /// Smaller and lower.
    pub(crate) is_index: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Text {
    pub(crate) at: [f64; 2],
    pub(crate) runs: Vec<Run>,
    /// The size of an em \[px\].
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    pub(crate) color: Color,
}

/// By how much an index is smaller, and lower in ems.
pub(crate) const INDEX: f64 = 0.72;
pub(crate) const INDEX_DROP: f64 = 0.24;
/// From the middle of a text down to its baseline, in ems.
pub(crate) const BASELINE: f64 = 0.36;

impl Text {
    pub(crate) fn new(at: [f64; 2], text: &str, size: f64, anchor: Anchor) -> Self {
        let runs = vec![Run { text: text.to_string(), is_index: false }];
        Text { at, runs, size, anchor, color: BLACK }
    }

    /// With what follows a `_`, a letter or all in braces, as an index.
    pub(crate) fn with_indices(at: [f64; 2], text: &str, size: f64, anchor: Anchor) -> Self {
        let mut runs = Vec::new();
        let mut push = |text: &str, is_index: bool| {
            if !text.is_empty() {
                runs.push(Run { text: text.to_string(), is_index });
            }
        };
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('_') {
            push(before, false);
            let braced = after.strip_prefix('{').and_then(|inner| inner.split_once('}'));
            let single = after.char_indices().nth(1).map_or((after, ""), |(end, _)| after.split_at(end));
            let (index, behind) = braced.unwrap_or(single);
            push(index, true);
            rest = behind;
        }
        push(rest, false);
        Text { at, runs, size, anchor, color: BLACK }
    }

    pub(crate) fn colored(self, color: Color) -> Self {
        Text { color, ..self }
    }

    pub(crate) fn width(&self, face: &Typeface) -> f64 {
        self.runs.iter().map(|run| face.width(&run.text, self.em(run))).sum()
    }

    /// The size of an em in a run.
    pub(crate) fn em(&self, run: &Run) -> f64 {
        if run.is_index { INDEX * self.size } else { self.size }
    }
}

#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Line { points: Vec<[f64; 2]>, stroke: Stroke },
    Area { points: Vec<[f64; 2]>, fill: Color },
    Dot { centre: [f64; 2], radius: f64, fill: Color },
    Text(Text),
}

/// In the order in which they are drawn.
pub(crate) struct Scene<'f> {
    pub(crate) face: &'f Typeface,
    pub(crate) shapes: Vec<Shape>,
}

/// Whether all coordinates of a place are numbers: of what is elsewhere nothing is drawn.
fn is_finite(point: &[f64; 2]) -> bool {
    point.iter().all(|x| x.is_finite())
}

impl Scene<'_> {
    /// A line through all points that are finite, in pieces where some are not.
    pub(crate) fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        let mut piece: Vec<[f64; 2]> = Vec::new();
        for point in points {
            if is_finite(&point) {
                piece.push(point);
            } else {
                self.piece(std::mem::take(&mut piece), stroke);
            }
        }
        self.piece(piece, stroke);
    }

    fn piece(&mut self, points: Vec<[f64; 2]>, stroke: Stroke) {
        if points.len() > 1 {
            self.shapes.push(Shape::Line { points: simplified(&points), stroke });
        }
    }

    pub(crate) fn text(&mut self, text: Text) {
        if is_finite(&text.at) {
            self.shapes.push(Shape::Text(text));
        }
    }

    pub(crate) fn dot(&mut self, centre: [f64; 2], radius: f64, fill: Color) {
        if is_finite(&centre) {
            self.shapes.push(Shape::Dot { centre, radius, fill });
        }
    }

    pub(crate) fn area(&mut self, points: Vec<[f64; 2]>, fill: Color) {
        if points.iter().all(is_finite) {
            self.shapes.push(Shape::Area { points, fill });
        }
    }
}

/// Douglas and Peucker, *Algorithms for the reduction of the number of points required to represent a digitized line*,
/// 1973: the ends, and of the points between them those that the line would miss.
fn simplified(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut is_kept = vec![false; points.len()];
    let (first, last) = (0, points.len() - 1);
    (is_kept[first], is_kept[last]) = (true, true);
    let mut spans = vec![(first, last)];
    while let Some((start, end)) = spans.pop() {
        let farthest = (start + 1..end)
            .map(|i| (i, distance(points[i], points[start], points[end])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((middle, off)) = farthest
            && off > TOLERANCE
        {
            is_kept[middle] = true;
            spans.extend([(start, middle), (middle, end)]);
        }
    }
    points.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(point, _)| *point).collect()
}

/// Of a point from the stretch between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = ab[0] * ab[0] + ab[1] * ab[1];
    let along = if square > 0.0 { ((ap[0] * ab[0] + ap[1] * ab[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (ap[0] - along * ab[0]).hypot(ap[1] - along * ab[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_keep_the_points_that_shape_them() {
        let straight: Vec<[f64; 2]> = (0..100).map(|i| [f64::from(i), 2.0 * f64::from(i)]).collect();
        assert_eq!(simplified(&straight), [[0.0, 0.0], [99.0, 198.0]]);
        assert_eq!(simplified(&[[0.0, 0.0], [5.0, 0.5], [10.0, 0.0]]).len(), 3);
        // There and back again is no point.
        assert_eq!(simplified(&[[0.0, 0.0], [5.0, 0.0], [0.0, 0.0]]), [[0.0, 0.0], [5.0, 0.0], [0.0, 0.0]]);
    }

    #[test]
    fn indices_are_runs_of_their_own() {
        let text = Text::with_indices([0.0; 2], "P_{01} of B_i", 10.0, Anchor::Start);
        let runs: Vec<(&str, bool)> = text.runs.iter().map(|run| (run.text.as_str(), run.is_index)).collect();
        assert_eq!(runs, [("P", false), ("01", true), (" of B", false), ("i", true)]);
    }
}
