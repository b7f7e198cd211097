//! Axes of a chart in a plane: round ticks, their numbers, grid and frame.

use std::ops::Range;

use crate::font::Typeface;
use crate::scene::{Anchor, Rect, Scene, Text};
use crate::style::{BLACK, GRID, Stroke, ZERO};

/// The size of an em \[px\]: numbers at ticks, what axes say.
pub(crate) const TICK_SIZE: f64 = 12.5;
pub(crate) const LABEL_SIZE: f64 = 14.0;
/// Under a chart: its ticks' numbers, and what the axis says \[px\].
pub(crate) const BELOW_TICKS: f64 = 24.0;
pub(crate) const BELOW_LABEL: f64 = 22.0;

/// A range with ticks at multiples of 1, 2 or 5 times a power of ten.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    pub(crate) range: Range<f64>,
    pub(crate) step: f64,
}

/// The least and the greatest of the finite values; `None` if no value is finite, or their difference overflows.
pub(crate) fn extent(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (low <= high && (high - low).is_finite()).then_some([low, high])
}

/// A range that has a length, as it is; one of the length 1 instead of what is empty, NaN or not finite: in
/// its middle is where that one starts.
pub(crate) fn with_length(range: Range<f64>) -> Range<f64> {
    let length = range.end - range.start;
    if length > 0.0 && length.is_normal() {
        return range;
    }
    // Of greater numbers the next one is further away than 1.
    let middle = if range.start.abs() < 1e15 { range.start } else { 0.0 };
    middle - 0.5..middle + 0.5
}

/// The least of 1, 2 and 5 times a power of ten that is not less.
pub(crate) fn round_step(rough: f64) -> f64 {
    let power = 10_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough).unwrap_or(10.0 * power)
}

impl Scale {
    /// With at most this many intervals, or as many more as two ticks need; over a range [`with_length`].
    pub(crate) fn new(range: Range<f64>, count: f64) -> Self {
        let range = with_length(range);
        let mut scale = Scale { step: round_step((range.end - range.start) / count.max(1.0)), range };
        while scale.ticks().len() < 2 {
            scale.step = round_step(0.4 * scale.step);
        }
        scale
    }

    pub(crate) fn ticks(&self) -> Vec<f64> {
        let slack = 1e-9 * (self.range.end - self.range.start);
        let first = ((self.range.start - slack) / self.step).ceil();
        let count = ((self.range.end + slack) / self.step - first).floor().max(0.0) as usize;
        (0..=count).map(|k| (first + k as f64) * self.step).collect()
    }

    /// From `low` pixels at the start of the range to `high` at its end.
    pub(crate) fn pixel(&self, value: f64, low: f64, high: f64) -> f64 {
        low + (high - low) * (value - self.range.start) / (self.range.end - self.range.start)
    }

    /// A number at the axis, with the digits that tell it from its neighbours.
    pub(crate) fn number(&self, value: f64) -> String {
        let value = if value.abs() < 1e-9 * self.step { 0.0 } else { value };
        let greatest = self.range.start.abs().max(self.range.end.abs());
        let text = if value == 0.0 {
            "0".to_string()
        } else if (1e-3..1e5).contains(&greatest) {
            decimal(value, self.step)
        } else {
            let exponent = greatest.log10().floor();
            let power = 10_f64.powi(exponent as i32);
            format!("{}·10{}", decimal(value / power, self.step / power), superscript(exponent as i32))
        };
        text.replace('-', "−")
    }

    /// The width of the widest number \[px\].
    pub(crate) fn number_width(&self, face: &Typeface) -> f64 {
        self.ticks().into_iter().map(|value| face.width(&self.number(value), TICK_SIZE)).fold(0.0, f64::max)
    }
}

/// With as many decimals as the step has.
fn decimal(value: f64, step: f64) -> String {
    let decimals = (-(step * 1.0001).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$}")
}

fn superscript(exponent: i32) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32(0x2070 + c.to_digit(10).unwrap_or(0)).unwrap_or(c),
    };
    exponent.to_string().chars().map(digit).collect()
}

/// Grid, frame, numbers, and what the horizontal axis says where that is not said further down.
pub(crate) fn draw(scene: &mut Scene<'_>, area: Rect, [x, y]: [&Scale; 2], x_label: Option<&str>) {
    let grid = |value: f64| Stroke::new(if value == 0.0 { ZERO } else { GRID }, 1.0);
    for value in x.ticks() {
        let at = x.pixel(value, area.x, area.right());
        scene.line([[at, area.y], [at, area.bottom()]], grid(value));
        scene.text(Text::new([at, area.bottom() + 13.0], &x.number(value), TICK_SIZE, Anchor::Middle));
    }
    for value in y.ticks() {
        let at = y.pixel(value, area.bottom(), area.y);
        scene.line([[area.x, at], [area.right(), at]], grid(value));
        scene.text(Text::new([area.x - 7.0, at], &y.number(value), TICK_SIZE, Anchor::End));
    }
    scene.line([[area.x, area.y], [area.x, area.bottom()], [area.right(), area.bottom()]], Stroke::new(BLACK, 1.2));
    if let Some(label) = x_label {
        let at = [area.x + 0.5 * area.width, area.bottom() + 34.0];
        scene.text(Text::new(at, label, LABEL_SIZE, Anchor::Middle));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_tell_them_apart() {
        let number = |value: f64, range: Range<f64>| Scale::new(range, 7.0).number(value);
        assert_eq!(number(0.30000000000000004, 0.0..1.0), "0.3".to_string());
        assert_eq!(number(-1e-17, -1.0..1.0), "0");
        assert_eq!(number(-0.5, -1.0..1.0), "−0.5");
        assert_eq!(number(2000.0, 0.0..8000.0), "2000");
        assert_eq!(number(1000.0002, 1000.0..1000.001), "1000.0002");
        assert_eq!(number(-2e-7, -3e-7..3e-7), "−2·10⁻⁷");
        assert_eq!(number(3e8, 0.0..9e8), "3·10⁸");
    }

    #[test]
    fn ticks_are_round_and_within() {
        assert_eq!(Scale::new(-0.63..1.04, 5.0).ticks(), [-0.5, 0.0, 0.5, 1.0]);
        assert_eq!(Scale::new(0.0..50.0, 10.0).ticks().len(), 11);
        assert_eq!(Scale::new(2.0..2.0, 4.0).range, 1.5..2.5);
        assert_eq!(Scale::new(-0.36..0.45, 2.5).ticks(), [-0.2, 0.0, 0.2, 0.4]);
    }

    #[test]
    fn ranges_that_are_empty_or_not_finite_become_one_of_length_one() {
        const INFINITY: f64 = f64::INFINITY;
        for (range, expected) in [
            (3.0..1.0, 2.5..3.5),
            (0.0..5e-324, -0.5..0.5),
            (2.0..INFINITY, 1.5..2.5),
            (2.0..f64::NAN, 1.5..2.5),
            (f64::NAN..2.0, -0.5..0.5),
            (-INFINITY..INFINITY, -0.5..0.5),
            (INFINITY..-INFINITY, -0.5..0.5),
            (-f64::MAX..f64::MAX, -0.5..0.5),
            (1e300..1e300, -0.5..0.5),
        ] {
            let scale = Scale::new(range.clone(), 4.0);
            assert_eq!(scale.range, expected, "{range:?}");
            assert!((2..=5).contains(&scale.ticks().len()), "{range:?}: {:?}", scale.ticks());
        }
        // Short, or far away, but a range.
        for range in [0.0..1e-300, 1e15..1e15 + 1.0, -1e300..1e300] {
            let scale = Scale::new(range.clone(), 4.0);
            assert_eq!(scale.range, range);
            assert!(scale.ticks().len() > 1, "{range:?}");
        }
    }
}
