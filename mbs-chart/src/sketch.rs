//! Drawings without axes: lines, arrows, areas and words, to one scale, as large as they can be.

use crate::font::Typeface;
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::{BLACK, Color, SOLID, Stroke};

/// The size of words, unless said \[px\].
const SIZE: f64 = 15.0;
/// Of arrows: length and half the width of the head \[px\].
const HEAD: [f64; 2] = [10.0, 3.6];
/// Around everything \[px\].
const MARGIN: f64 = 14.0;

/// What is drawn, in the order of calls; places are to the right and up, in any unit.
#[derive(Clone, Debug, Default)]
pub struct Sketch {
    marks: Vec<Mark>,
}

#[derive(Clone, Debug)]
enum Mark {
    Line { points: Vec<[f64; 2]>, stroke: Stroke },
    Arrow { points: Vec<[f64; 2]>, stroke: Stroke, is_double: bool },
    Area { points: Vec<[f64; 2]>, color: Color },
    Dot { at: [f64; 2], radius: f64, color: Color },
    Word { at: [f64; 2], word: String, shift: [f64; 2], size: f64, color: Color },
}

impl Sketch {
    /// A line through some points.
    pub fn line(&mut self, points: impl Into<Vec<[f64; 2]>>, stroke: Stroke) {
        self.marks.push(Mark::Line { points: points.into(), stroke });
    }

    /// A line with a head at its end; the head lies along the last stretch.
    pub fn arrow(&mut self, points: impl Into<Vec<[f64; 2]>>, stroke: Stroke) {
        self.marks.push(Mark::Arrow { points: points.into(), stroke, is_double: false });
    }

    /// A line with heads at both ends, for a length or an angle.
    pub fn dimension(&mut self, points: impl Into<Vec<[f64; 2]>>, stroke: Stroke) {
        self.marks.push(Mark::Arrow { points: points.into(), stroke, is_double: true });
    }

    /// What is inside a closed line.
    pub fn area(&mut self, points: impl Into<Vec<[f64; 2]>>, color: Color) {
        self.marks.push(Mark::Area { points: points.into(), color });
    }

    /// A dot with a radius in pixels.
    pub fn dot(&mut self, at: [f64; 2], radius: f64, color: Color) {
        self.marks.push(Mark::Dot { at, radius, color });
    }

    /// A word at a place, moved by pixels to the right and down: one that is moved to the left ends there, one that
    /// is moved up or down alone is centred. What follows a `_`, a letter or all in braces, is an index.
    pub fn word(&mut self, at: [f64; 2], word: impl Into<String>, shift: [f64; 2]) {
        self.styled_word(at, word, shift, SIZE, BLACK);
    }

    /// A [word](Self::word) of this size \[px\] and colour.
    pub fn styled_word(&mut self, at: [f64; 2], word: impl Into<String>, shift: [f64; 2], size: f64, color: Color) {
        self.marks.push(Mark::Word { at, word: word.into(), shift, size, color });
    }

    /// As large as the area allows, in its middle.
    pub(crate) fn draw(&self, scene: &mut Scene<'_>, area: Rect) {
        let scale = self.scale(scene.face, area);
        let [[left, right], [low, high]] = self.bounds(scene.face, scale);
        let origin = [area.x + 0.5 * (area.width - left - right), area.y + 0.5 * (area.height - low - high)];
        let pixel = |[x, y]: [f64; 2]| [origin[0] + scale * x, origin[1] - scale * y];
        for mark in &self.marks {
            match mark {
                Mark::Line { points, stroke } => scene.line(points.iter().map(|point| pixel(*point)), *stroke),
                Mark::Area { points, color } => scene.area(points.iter().map(|point| pixel(*point)).collect(), *color),
                Mark::Dot { at, radius, color } => scene.dot(pixel(*at), *radius, *color),
                Mark::Word { at, .. } => scene.text(placed(mark, pixel(*at))),
                Mark::Arrow { points, stroke, is_double } => {
                    let mut line: Vec<[f64; 2]> = points.iter().map(|point| pixel(*point)).collect();
                    let mut heads = vec![head(&mut line)];
                    if *is_double {
                        line.reverse();
                        heads.push(head(&mut line));
                    }
                    scene.line(line, *stroke);
                    heads.into_iter().for_each(|head| scene.area(head, stroke.color));
                }
            }
        }
    }

    /// The largest at which all fits: words do not grow with it.
    fn scale(&self, face: &Typeface, area: Rect) -> f64 {
        let fits = |scale: f64| {
            let [[left, right], [low, high]] = self.bounds(face, scale);
            right - left <= area.width - 2.0 * MARGIN && high - low <= area.height - 2.0 * MARGIN
        };
        let mut range = [1e-12_f64, 1e12];
        for _ in 0..100 {
            let middle = (range[0] * range[1]).sqrt();
            range[usize::from(!fits(middle))] = middle;
        }
        range[0]
    }

    /// To the right and down from the origin, at a scale \[px\].
    fn bounds(&self, face: &Typeface, scale: f64) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut add = |point: [f64; 2], [x, y]: [f64; 2]| {
            for (bound, (value, room)) in bounds.iter_mut().zip(point.into_iter().zip([x, y])) {
                *bound = [bound[0].min(value - room), bound[1].max(value + room)];
            }
        };
        let pixel = |[x, y]: [f64; 2]| [scale * x, -scale * y];
        for mark in &self.marks {
            match mark {
                Mark::Line { points, .. } | Mark::Arrow { points, .. } | Mark::Area { points, .. } => {
                    points.iter().for_each(|point| add(pixel(*point), [2.0; 2]));
                }
                Mark::Dot { at, radius, .. } => add(pixel(*at), [*radius; 2]),
                Mark::Word { at, .. } => {
                    let text = placed(mark, pixel(*at));
                    let width = text.width(face);
                    let middle = match text.anchor {
                        Anchor::Start => text.at[0] + 0.5 * width,
                        Anchor::Middle => text.at[0],
                        Anchor::End => text.at[0] - 0.5 * width,
                    };
                    add([middle, text.at[1]], [0.5 * width, 0.7 * text.size]);
                }
            }
        }
        bounds
    }
}

/// The text of a word whose place is at a pixel.
fn placed(mark: &Mark, [x, y]: [f64; 2]) -> Text {
    let Mark::Word { word, shift: [right, down], size, color, .. } = mark else {
        return Text::new([x, y], "", SIZE, Anchor::Middle);
    };
    let anchor = match right {
        _ if *right > 0.0 => Anchor::Start,
        _ if *right < 0.0 => Anchor::End,
        _ => Anchor::Middle,
    };
    Text::with_indices([x + right, y + down], word, *size, anchor).colored(*color)
}

/// The head at the end of a line, which ends within it from now on.
fn head(line: &mut [[f64; 2]]) -> Vec<[f64; 2]> {
    let [.., before, tip] = line else { return Vec::new() };
    let way = [tip[0] - before[0], tip[1] - before[1]];
    let length = way[0].hypot(way[1]).max(1e-9);
    let along = [way[0] / length, way[1] / length];
    let [long, wide] = HEAD;
    let at =
        |back: f64, side: f64| [tip[0] - back * along[0] - side * along[1], tip[1] - back * along[1] + side * along[0]];
    let head = vec![at(0.0, 0.0), at(long, wide), at(long, -wide)];
    let inside = at(0.7 * long.min(length), 0.0);
    *tip = inside;
    head
}

/// Without gaps, as thick as outlines are.
pub const OUTLINE: Stroke = Stroke { color: BLACK, width: 1.6, dash: SOLID };

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lines_stay_inside() {
        let mut sketch = Sketch::default();
        sketch.line([[0.0, 0.0], [2.0, 1.0]], OUTLINE);
        sketch.word([2.0, 1.0], "a long word at the end of the line", [8.0, 0.0]);
        let face = Typeface::new().unwrap();
        let area = Rect { x: 0.0, y: 0.0, width: 600.0, height: 400.0 };
        let scale = sketch.scale(&face, area);
        let [[left, right], [low, high]] = sketch.bounds(&face, scale);
        assert!(right - left <= 600.0 && high - low <= 400.0 && scale > 50.0, "{scale}");
    }
}
