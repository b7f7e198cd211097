//! The diagram of the introduction: chapters, and the mechanisms that they share.

use mbs_chart::style::{BLACK, BLUE, Color, GRAY, LIGHT, Stroke};
use mbs_chart::{Figure, Sketch};

use crate::solid::drawing;

/// A chapter: where its box is, its name, its mechanisms.
type Box = ([f64; 2], &'static str, &'static str);

const WIDE: f64 = 3.0;
const HIGH: f64 = 0.95;

const BOXES: [Box; 8] = [
    ([0.0, 3.0], "1 Multibody systems", "all mechanisms"),
    ([0.0, 1.3], "2 Kinematics and dynamics", "Lagrange's equations"),
    ([3.9, 3.0], "3 Serial manipulator", "Irb7600"),
    ([3.9, 1.3], "4 Parallel manipulator", "StewartPlatform"),
    ([3.9, -0.4], "7 Rendezvous and docking", "RelativeLvlh, TwoBody, Cr3bp"),
    ([7.8, 1.3], "5 Landing of a vehicle", "QuadrotorEuler"),
    ([7.8, 3.0], "6 Experiment", "Irb7600Rail"),
    ([7.8, -0.4], "8 Conclusions", ""),
];

/// From the right edge of one box to the left of another, or between boxes one above the other.
const ARROWS: [([f64; 2], [f64; 2]); 8] = [
    ([1.5, 3.0], [1.5, 1.3 + HIGH]),
    ([WIDE, 1.3 + 0.7 * HIGH], [3.9, 3.0 + 0.3 * HIGH]),
    ([WIDE, 1.3 + 0.5 * HIGH], [3.9, 1.3 + 0.5 * HIGH]),
    ([WIDE, 1.3 + 0.3 * HIGH], [3.9, -0.4 + 0.7 * HIGH]),
    ([3.9 + WIDE, 1.3 + 0.5 * HIGH], [7.8, 1.3 + 0.5 * HIGH]),
    ([3.9 + WIDE, 3.0 + 0.5 * HIGH], [7.8, 3.0 + 0.5 * HIGH]),
    ([7.8 + 0.5 * WIDE, 1.3 + HIGH], [7.8 + 0.5 * WIDE, 3.0]),
    ([3.9 + WIDE, -0.4 + 0.5 * HIGH], [7.8, -0.4 + 0.5 * HIGH]),
];

pub(crate) fn figure() -> Figure {
    let mut sketch = Sketch::default();
    for ([x, y], name, mechanisms) in BOXES {
        let corners = [[x, y], [x + WIDE, y], [x + WIDE, y + HIGH], [x, y + HIGH]];
        sketch.area(corners, if mechanisms.is_empty() { Color(243, 243, 243) } else { LIGHT });
        sketch.line([&corners[..], &corners[..1]].concat(), Stroke::new(GRAY, 1.2));
        let middle = [x + 0.5 * WIDE, y + 0.5 * HIGH];
        sketch.styled_word(middle, name, [0.0, if mechanisms.is_empty() { 0.0 } else { -11.0 }], 15.0, BLACK);
        sketch.styled_word(middle, mechanisms, [0.0, 13.0], 12.5, BLUE);
    }
    for (from, to) in ARROWS {
        sketch.arrow([from, to], Stroke::new(BLACK, 1.4));
    }
    drawing("The chapters and their mechanisms", (900, 430), sketch)
}
