//! A grid of coloured cells over two axes, with a bar that says what the colours mean.

use std::ops::Range;

use crate::axis::{self, BELOW_LABEL, BELOW_TICKS, LABEL_SIZE, Scale, TICK_SIZE};
use crate::font::Typeface;
use crate::legend::ROW;
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::{BLACK, Color, GRAY, Stroke, WHITE};

/// Left of the axis: its numbers \[px\].
pub(crate) const LEFT: f64 = 76.0;
/// Between chart and bar, the bar's width, and its numbers \[px\].
const BAR: [f64; 3] = [14.0, 14.0, 52.0];
/// By how much a cell reaches under its neighbours, so that no background shines through \[px\].
const SEAM: f64 = 0.8;
/// Of what a cell without a value says \[px\].
const WORD: f64 = 11.0;

/// Values over a grid; a cell without a value says why.
#[derive(Clone, Debug)]
pub struct Cells {
    /// What the axes say, with their unit: to the right, up.
    pub labels: [String; 2],
    /// The lines between columns and between rows, ascending: one more than there are cells.
    pub edges: [Vec<f64>; 2],
    /// Row by row from below, each from the left.
    pub values: Vec<Vec<Cell>>,
    /// What the colours mean, with the unit.
    pub value_label: String,
    /// Values of the ends of the bar; those beyond have the end's colour.
    pub range: [f64; 2],
    /// What cells without a value mean, by their number.
    pub reasons: Vec<String>,
}

/// What is in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A value; NaN leaves the cell white.
    Value(f64),
    /// None, for the reason with this number.
    None(usize),
}

/// From low to high: dark blue over green to yellow, rising in lightness, so that it reads without colours, too.
///
/// Points of viridis (S. van der Walt and N. Smith, 2015), linear in between.
const COLORS: [Color; 9] = [
    Color(68, 1, 84),
    Color(71, 44, 122),
    Color(59, 81, 139),
    Color(44, 113, 142),
    Color(33, 144, 141),
    Color(39, 173, 129),
    Color(92, 200, 99),
    Color(170, 220, 50),
    Color(253, 231, 37),
];

/// Of cells without a value, by the reason: white and grey, each with a stroke of its own through it.
const EMPTY: [Color; 3] = [Color(238, 238, 238), WHITE, Color(205, 205, 205)];

/// At a part of the bar, from 0 to 1.
fn color(part: f64) -> Color {
    let last = COLORS.len() - 1;
    let place = part.clamp(0.0, 1.0) * last as f64;
    let i = (place as usize).min(last - 1);
    let (a, b, s) = (COLORS[i], COLORS[i + 1], place - i as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + s * (f64::from(b) - f64::from(a))).round() as u8;
    Color(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

fn corners(x: [f64; 2], y: [f64; 2]) -> Vec<[f64; 2]> {
    vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
}

impl Cells {
    fn legend_rows(&self) -> f64 {
        if self.present().next().is_some() { ROW } else { 0.0 }
    }

    /// The reasons that some cell has.
    fn present(&self) -> impl Iterator<Item = (usize, &String)> {
        let has = |reason: usize| self.values.iter().flatten().any(|cell| *cell == Cell::None(reason));
        self.reasons.iter().enumerate().filter(move |(reason, _)| has(*reason))
    }

    /// Above and below the chart \[px\].
    pub(crate) fn margins(&self, _: &Typeface, _: f64) -> [f64; 2] {
        [8.0 + ROW, BELOW_TICKS + BELOW_LABEL + self.legend_rows()]
    }

    /// Into the area of the chart alone, with the bar at its right.
    pub(crate) fn draw(&self, scene: &mut Scene<'_>, area: Rect) {
        let [gap, wide, numbers] = BAR;
        let area = area.inset([0.0, 0.0, gap + wide + numbers, 0.0]);
        let scale = |edges: &[f64], count: f64| {
            let ends = edges.first().zip(edges.last()).map_or(0.0..1.0, |(low, high)| *low..*high);
            Scale::new(ends, count)
        };
        let x = scale(&self.edges[0], (area.width / 60.0).clamp(2.0, 9.0));
        let y = scale(&self.edges[1], (area.height / 36.0).clamp(2.0, 9.0));
        axis::draw(scene, area, [&x, &y], Some(&self.labels[0]));
        let label = [area.x - 14.0, area.y - 0.5 * ROW - 3.0];
        scene.text(Text::new(label, &self.labels[1], LABEL_SIZE, Anchor::Start));
        let bar_label = [area.right() + gap + wide + numbers, area.y - 0.5 * ROW - 3.0];
        scene.text(Text::new(bar_label, &self.value_label, LABEL_SIZE, Anchor::End));
        let Range { start: low, end: high } = axis::with_length(self.range[0]..self.range[1]);
        for (row, up) in self.values.iter().zip(self.edges[1].windows(2)) {
            for (cell, right) in row.iter().zip(self.edges[0].windows(2)) {
                let mut across = [right[0], right[1]].map(|value| x.pixel(value, area.x, area.right()));
                let mut along = [up[0], up[1]].map(|value| y.pixel(value, area.bottom(), area.y));
                // Neighbours that come later are drawn over the seam.
                across[1] = (across[1] + SEAM).min(area.right());
                along[1] = (along[1] - SEAM).max(area.y);
                match *cell {
                    Cell::Value(value) if value.is_nan() => {}
                    Cell::Value(value) => scene.area(corners(across, along), color((value - low) / (high - low))),
                    Cell::None(reason) => empty(scene, reason, across, along),
                }
            }
        }
        self.bar(scene, area);
        let mut left = area.x;
        let below = area.bottom() + BELOW_TICKS + BELOW_LABEL + 0.5 * ROW;
        for (reason, words) in self.present() {
            empty(scene, reason, [left, left + 14.0], [below + 6.0, below - 6.0]);
            scene.line(closed(corners([left, left + 14.0], [below + 6.0, below - 6.0])), Stroke::new(GRAY, 0.8));
            scene.text(Text::new([left + 20.0, below], words, WORD + 1.0, Anchor::Start));
            left += 20.0 + scene.face.width(words, WORD + 1.0) + 22.0;
        }
    }

    fn bar(&self, scene: &mut Scene<'_>, area: Rect) {
        const STEPS: usize = 64;
        let [low, high] = self.range;
        let scale = Scale::new(low..high, (area.height / 36.0).clamp(2.0, 8.0));
        let across = [area.right() + BAR[0], area.right() + BAR[0] + BAR[1]];
        for i in 0..STEPS {
            let part = |i: usize| area.bottom() - area.height * i as f64 / STEPS as f64;
            scene.area(
                corners(across, [part(i), (part(i + 1) - SEAM).max(area.y)]),
                color((i as f64 + 0.5) / STEPS as f64),
            );
        }
        scene.line(closed(corners(across, [area.bottom(), area.y])), Stroke::new(BLACK, 0.8));
        for value in scale.ticks() {
            let at = scale.pixel(value, area.bottom(), area.y);
            scene.text(Text::new([across[1] + 6.0, at], &scale.number(value), TICK_SIZE, Anchor::Start));
        }
    }
}

fn closed(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    corners.extend(corners.first().copied());
    corners
}

/// Grey or white, with a stroke that tells reasons apart without colours: falling, rising, none.
fn empty(scene: &mut Scene<'_>, reason: usize, across: [f64; 2], along: [f64; 2]) {
    scene.area(corners(across, along), EMPTY[reason % EMPTY.len()]);
    let stroke = Stroke::new(GRAY, 0.8);
    match reason % EMPTY.len() {
        0 => scene.line([[across[0], along[0]], [across[1], along[1]]], stroke),
        1 => scene.line([[across[0], along[1]], [across[1], along[0]]], stroke),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Figure, Format, Panel, draw};

    #[test]
    fn colours_run_from_dark_to_light() {
        assert_eq!((color(-1.0), color(0.0), color(1.0), color(7.0)), (COLORS[0], COLORS[0], COLORS[8], COLORS[8]));
        let lightness = |c: Color| 0.2126 * f64::from(c.0) + 0.7152 * f64::from(c.1) + 0.0722 * f64::from(c.2);
        assert!((0..100).all(|i| lightness(color(f64::from(i) / 100.0)) < lightness(color(f64::from(i + 1) / 100.0))));
    }

    #[test]
    fn a_range_without_length_has_the_middle_of_the_colours() {
        let cells = Cells {
            labels: ["x", "y"].map(String::from),
            edges: [vec![0.0, 1.0, 2.0], vec![0.0, 1.0]],
            values: vec![vec![Cell::Value(3.0), Cell::Value(f64::NAN)]],
            value_label: "t [s]".to_string(),
            range: [3.0, 3.0],
            reasons: Vec::new(),
        };
        let figure = Figure { title: String::new(), size: (500, 300), panels: vec![Panel::Cells(cells)] };
        let svg = String::from_utf8(draw(&figure, Format::Svg).unwrap()).unwrap();
        // None of the bar's steps has it.
        let Color(red, green, blue) = color(0.5);
        assert!(svg.contains(&format!("#{red:02x}{green:02x}{blue:02x}")), "{svg}");
        // The bar's steps, and the one cell that has a value.
        assert_eq!(svg.matches("Z\" fill=").count(), 64 + 1, "{svg}");
    }

    #[test]
    fn a_grid_has_its_bar_and_says_why_a_cell_is_empty() {
        let cells = Cells {
            labels: ["A [m]", "ω [rad/s]"].map(String::from),
            edges: [vec![0.0, 1.0, 2.0], vec![0.0, 1.0]],
            values: vec![vec![Cell::Value(3.0), Cell::None(1)]],
            value_label: "t [s]".to_string(),
            range: [3.0, 4.0],
            reasons: vec!["never".to_string(), "falls".to_string()],
        };
        let figure = Figure { title: String::new(), size: (500, 300), panels: vec![Panel::Cells(cells)] };
        let svg = String::from_utf8(draw(&figure, Format::Svg).unwrap()).unwrap();
        for word in ["A [m]", "ω [rad/s]", "t [s]", "falls", "3.5"] {
            assert!(svg.contains(word), "{word}: {svg}");
        }
        assert!(!svg.contains("never"));
        assert!(draw(&figure, Format::Png).unwrap().starts_with(b"\x89PNG"));
    }
}
