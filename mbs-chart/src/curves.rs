//! Lines over one horizontal axis, with a legend above.

use std::ops::Range;

use crate::axis::{self, BELOW_LABEL, BELOW_TICKS, LABEL_SIZE, Scale};
use crate::font::Typeface;
use crate::legend::{Legend, ROW};
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::stroke;

/// The size of words at points \[px\].
const MARK_SIZE: f64 = 12.5;
/// A line has at most this many points; beyond that a bucket of points is drawn by its extremes.
const POINTS: usize = 4000;

/// Some lines on common axes.
#[derive(Clone, Debug)]
pub struct Curves {
    /// What the horizontal axis says, with its unit.
    pub x_label: String,
    /// What the vertical axis says, with its unit.
    pub y_label: String,
    /// From where to where; lines are cut there, and the vertical axis goes as far as what is left of them.
    pub x_range: Range<f64>,
    /// At least one.
    pub lines: Vec<Line>,
}

/// One line and its name in the legend.
#[derive(Clone, Debug)]
pub struct Line {
    name: String,
    points: Vec<(f64, f64)>,
    /// What all points take of the horizontal axis, those that are left out, too.
    extent: Option<[f64; 2]>,
    marks: Vec<((f64, f64), String)>,
}

impl Line {
    /// The points in the order of their `x`; of more than some thousands the lowest and the highest of each bucket are
    /// kept.
    #[must_use]
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        let extent = axis::extent(points.iter().map(|point| point.0));
        let points = if points.len() <= POINTS {
            points
        } else {
            points.chunks(points.len().div_ceil(POINTS / 2)).flat_map(extremes).collect()
        };
        Line { name: name.into(), points, extent, marks: Vec::new() }
    }

    /// With a dot and a word at a point.
    #[must_use]
    pub fn marked(mut self, at: (f64, f64), word: impl Into<String>) -> Self {
        self.marks.push((at, word.into()));
        self
    }
}

/// What lines take of the horizontal axis together, and this part of it more on both sides.
pub(crate) fn range_of(lines: &[Line], margin: f64) -> Range<f64> {
    let extents = lines.iter().filter_map(|line| line.extent).flatten();
    let [low, high] = axis::extent(extents).unwrap_or_default();
    let margin = margin * (high - low);
    low - margin..high + margin
}

/// Lines named `one` with its number, from 1, or `many` with their numbers where they are alike to a millionth of the
/// greatest value: what lies on each other is not told apart by gaps.
#[must_use]
pub fn numbered([one, many]: [&str; 2], lines: &[Vec<(f64, f64)>]) -> Vec<Line> {
    let greatest = lines.iter().flatten().fold(0.0_f64, |most, point| most.max(point.1.abs()));
    let are_alike = |a: &[(f64, f64)], b: &[(f64, f64)]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a.1 - b.1).abs() <= 1e-6 * greatest)
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (i, line) in lines.iter().enumerate() {
        match groups.iter_mut().find(|group| are_alike(&lines[group[0]], line)) {
            Some(group) => group.push(i),
            None => groups.push(vec![i]),
        }
    }
    let name = |group: &[usize]| match group {
        [i] => format!("{one} {}", i + 1),
        _ => format!("{many} {}", group.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(", ")),
    };
    groups.iter().map(|group| Line::new(name(group), lines[group[0]].clone())).collect()
}

/// The lowest and the highest point, in order of `x`, and a gap behind them where there is one among the points.
fn extremes(bucket: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let points = || bucket.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
    let by_value = |a: &(f64, f64), b: &(f64, f64)| a.1.total_cmp(&b.1);
    let mut kept: Vec<(f64, f64)> = points().min_by(by_value).into_iter().chain(points().max_by(by_value)).collect();
    kept.sort_by(|a, b| a.0.total_cmp(&b.0));
    if points().count() < bucket.len() {
        kept.push((kept.last().or(bucket.first()).map_or(f64::NAN, |point| point.0), f64::NAN));
    }
    kept
}

/// What of a line is within a range, with a gap where it is not.
fn cut(points: &[(f64, f64)], range: &Range<f64>) -> Vec<[f64; 2]> {
    let is_inside = |x: f64| (range.start..=range.end).contains(&x);
    let mut kept = Vec::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        if i > 0 && x != points[i - 1].0 {
            let (x0, y0) = points[i - 1];
            let mut edges = [range.start, range.end];
            if x < x0 {
                edges.reverse();
            }
            for edge in edges.into_iter().filter(|edge| x0.min(x) < *edge && *edge < x0.max(x)) {
                kept.push([edge, y0 + (y - y0) * (edge - x0) / (x - x0)]);
                // Out of the range, or into it behind a gap.
                if !is_inside(x) {
                    kept.push([f64::NAN; 2]);
                }
            }
        }
        if is_inside(x) {
            kept.push([x, y]);
        }
    }
    kept
}

/// From the lowest to the highest value with a margin; what varies by rounding alone stays a flat line.
fn value_range<'a>(lines: impl Iterator<Item = &'a Vec<[f64; 2]>>) -> Range<f64> {
    let Some([lowest, highest]) = axis::extent(lines.flatten().map(|point| point[1])) else { return -1.0..1.0 };
    let magnitude = lowest.abs().max(highest.abs());
    let least = if magnitude > 0.0 { 1e-3 * magnitude } else { 1.0 };
    let (middle, half) = (0.5 * (lowest + highest), 0.54 * (highest - lowest).max(least));
    middle - half..middle + half
}

/// A panel of curves, ready to be drawn into any area.
pub(crate) struct Prepared<'a> {
    curves: &'a Curves,
    x_range: Range<f64>,
    /// Within the range.
    lines: Vec<Vec<[f64; 2]>>,
    values: Range<f64>,
    /// Whether the panel above says what the lines are called, and whether the one below has the same axis.
    pub(crate) is_named_above: bool,
    pub(crate) is_continued: bool,
}

impl<'a> Prepared<'a> {
    pub(crate) fn new(curves: &'a Curves) -> Self {
        let x_range = axis::with_length(curves.x_range.clone());
        let lines: Vec<_> = curves.lines.iter().map(|line| cut(&line.points, &x_range)).collect();
        let values = value_range(lines.iter());
        Prepared { curves, x_range, lines, values, is_named_above: false, is_continued: false }
    }

    fn legend(&self, face: &'a Typeface, width: f64) -> Legend<'a> {
        let is_shown = |line: &&'a Line| !self.is_named_above && !line.name.is_empty();
        let names = self.curves.lines.iter().map(|line| if is_shown(&line) { line.name.as_str() } else { "" });
        Legend::new(names.collect(), face, width)
    }

    fn vertical(&self, height: f64) -> Scale {
        Scale::new(self.values.clone(), (height / 34.0).clamp(2.0, 8.0))
    }

    /// Left of the axis: its numbers \[px\].
    pub(crate) fn left(&self, height: f64, face: &Typeface) -> f64 {
        self.vertical(height).number_width(face) + 24.0
    }

    /// Whether the legend stands beside what the vertical axis says.
    fn is_beside(&self, legend: &Legend<'_>, face: &Typeface, width: f64) -> bool {
        let label = face.width(&self.curves.y_label, LABEL_SIZE);
        legend.single_row().is_some_and(|row| row + label + 40.0 < width)
    }

    /// Above and below the chart \[px\].
    pub(crate) fn margins(&self, face: &'a Typeface, width: f64) -> [f64; 2] {
        let legend = self.legend(face, width);
        let rows = if self.is_beside(&legend, face, width) { 0.0 } else { legend.height() };
        let below = if self.is_continued { BELOW_TICKS } else { BELOW_TICKS + BELOW_LABEL };
        [8.0 + rows + ROW, below]
    }

    /// Into the area of the chart alone.
    pub(crate) fn draw(&self, scene: &mut Scene<'a>, area: Rect) {
        let curves = self.curves;
        let legend = self.legend(scene.face, area.width);
        let rows = if self.is_beside(&legend, scene.face, area.width) { 0.0 } else { legend.height() };
        legend.draw(scene, area.right(), area.y - ROW - 3.0 - rows);
        let label = [area.x - 14.0, area.y - 0.5 * ROW - 3.0];
        scene.text(Text::new(label, &curves.y_label, LABEL_SIZE, Anchor::Start));

        let x = Scale::new(self.x_range.clone(), (area.width / 65.0).clamp(2.0, 12.0));
        let y = self.vertical(area.height);
        axis::draw(scene, area, [&x, &y], (!self.is_continued).then_some(curves.x_label.as_str()));
        let pixel = |[a, b]: [f64; 2]| [x.pixel(a, area.x, area.right()), y.pixel(b, area.bottom(), area.y)];
        for (i, line) in self.lines.iter().enumerate() {
            let own = stroke(i, self.lines.len());
            scene.line(line.iter().map(|point| pixel(*point)), own);
            for ((a, b), word) in &curves.lines[i].marks {
                let at = pixel([*a, *b]);
                scene.dot(at, 3.5, own.color);
                let width = scene.face.width(word, MARK_SIZE);
                // Above, then below, first on the side with more room: where no line goes through it.
                let side = if at[0] < area.x + 0.6 * area.width { 1.0 } else { -1.0 };
                let mut places = [(side, -11.0), (-side, -11.0), (side, 12.0), (-side, 12.0)].map(|(side, down)| {
                    let left = at[0] + if side > 0.0 { 8.0 } else { -8.0 - width };
                    Rect { x: left, y: at[1] + down - 8.0, width, height: 16.0 }
                });
                if at[1] < area.y + 20.0 {
                    places.rotate_left(2);
                }
                let is_free = |place: &&Rect| {
                    let is_over = |[x, y]: [f64; 2]| place.overlaps(&Rect { x, y, width: 0.0, height: 0.0 });
                    place.x > area.x && !self.lines.iter().flatten().any(|point| is_over(pixel(*point)))
                };
                let place = places.iter().find(is_free).unwrap_or(&places[0]);
                scene.text(Text::new([place.x, place.y + 8.0], word, MARK_SIZE, Anchor::Start));
            }
        }
    }
}

/// Whether one legend does for both.
pub(crate) fn have_same_names(a: &Curves, b: &Curves) -> bool {
    a.lines.len() == b.lines.len() && a.lines.iter().zip(&b.lines).all(|(a, b)| a.name == b.name)
}

/// Whether one horizontal axis does for both.
pub(crate) fn have_same_axis(a: &Curves, b: &Curves) -> bool {
    a.x_label == b.x_label && a.x_range == b.x_range
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

    #[test]
    fn gaps_hide_no_peak_where_points_are_many() {
        let value = |i: usize| if i % 5 == 3 { f64::NAN } else { (i % 7) as f64 };
        let drawn = Line::new("gaps", (0..9995).map(|i| (i as f64, value(i))).collect()).points;
        assert_eq!(drawn.iter().filter(|point| point.1 == 6.0).count(), (0..9995).filter(|&i| value(i) == 6.0).count());
        assert!(drawn.windows(2).any(|pair| pair.iter().all(|point| point.1.is_finite())));
        assert!(drawn.iter().any(|point| point.1.is_nan()) && drawn.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn lines_that_lie_on_each_other_are_one() {
        let line = |slope: f64| vec![(0.0, 0.0), (1.0, slope)];
        let lines = numbered(["leg", "legs"], &[line(1.0), line(2.0), line(1.0 + 1e-7), line(-1.0)]);
        let names: Vec<&str> = lines.iter().map(|line| line.name.as_str()).collect();
        assert_eq!(names, ["legs 1, 3", "leg 2", "leg 4"]);
    }

    #[test]
    fn lines_are_cut_at_both_ends_of_the_range() {
        let line: Vec<(f64, f64)> = (0..5).map(|i| (f64::from(i), 10.0 * f64::from(i))).collect();
        let kept: Vec<[f64; 2]> = cut(&line, &(0.5..2.5)).into_iter().filter(|point| point[0].is_finite()).collect();
        assert_eq!(kept, [[0.5, 5.0], [1.0, 10.0], [2.0, 20.0], [2.5, 25.0]]);
        // A long step over the whole range.
        let kept = cut(&[(0.0, 0.0), (10.0, 10.0)], &(4.0..5.0));
        assert_eq!(kept.iter().filter(|point| point[0].is_finite()).count(), 2);
    }
}
