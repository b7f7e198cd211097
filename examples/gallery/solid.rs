//! Drawings of bodies in space, seen from a side.

use mbs_chart::style::{BLACK, Color, Stroke};
use mbs_chart::{Camera, Figure, Panel, Sketch};
use mbs_runtime::Pose;

pub(crate) type Point = [f64; 3];

/// From the words of axes to their tips \[px\].
const BESIDE: f64 = 13.0;

/// A drawing of which places are given in space.
pub(crate) struct Solid {
    camera: Camera,
    /// Where the origin of space is in the drawing, and how long a unit of it.
    place: ([f64; 2], f64),
    /// What is drawn so far.
    pub(crate) sketch: Sketch,
}

impl Solid {
    /// Seen from an azimuth and an elevation \[°\].
    pub(crate) fn new(azimuth: f64, elevation: f64) -> Self {
        Solid { camera: Camera { azimuth, elevation }, place: ([0.0; 2], 1.0), sketch: Sketch::default() }
    }

    /// Upon a drawing, with the origin of space there, and a unit this long.
    pub(crate) fn on(self, sketch: Sketch, origin: [f64; 2], unit: f64) -> Self {
        Solid { place: (origin, unit), sketch, ..self }
    }

    fn flat_point(&self, point: Point) -> [f64; 2] {
        let (([x0, y0], unit), [x, y]) = (self.place, self.camera.flat(point));
        [x0 + unit * x, y0 + unit * y]
    }

    fn flat(&self, points: &[Point]) -> Vec<[f64; 2]> {
        points.iter().map(|point| self.flat_point(*point)).collect()
    }

    pub(crate) fn line(&mut self, points: &[Point], stroke: Stroke) {
        self.sketch.line(self.flat(points), stroke);
    }

    pub(crate) fn arrow(&mut self, points: &[Point], stroke: Stroke) {
        self.sketch.arrow(self.flat(points), stroke);
    }

    pub(crate) fn area(&mut self, points: &[Point], color: Color) {
        self.sketch.area(self.flat(points), color);
    }

    pub(crate) fn dot(&mut self, at: Point, radius: f64, color: Color) {
        self.sketch.dot(self.flat_point(at), radius, color);
    }

    pub(crate) fn word(&mut self, at: Point, word: &str, shift: [f64; 2]) {
        self.sketch.word(self.flat_point(at), word, shift);
    }

    /// A word in a colour.
    pub(crate) fn tinted(&mut self, at: Point, word: &str, shift: [f64; 2], color: Color) {
        self.sketch.styled_word(self.flat_point(at), word, shift, 15.0, color);
    }

    /// The axes of a frame, as long as said, with their names at their tips.
    pub(crate) fn frame(&mut self, pose: &Pose<f64>, length: f64, names: [&str; 3], color: Color) {
        for (axis, name) in names.into_iter().enumerate() {
            let tip = pose.transform_point(unit(axis).map(|x| length * x));
            self.arrow(&[pose.position, tip], Stroke::new(color, 1.6));
            let ([x0, y0], [x1, y1]) = (self.flat_point(pose.position), self.flat_point(tip));
            let size = (x1 - x0).hypot(y1 - y0).max(1e-9);
            let [right, up] = [(x1 - x0) / size, (y1 - y0) / size];
            // Above or below a steep axis the name is centred.
            let right = if right.abs() < 0.35 { 0.0 } else { right };
            self.tinted(tip, name, [0.8 * BESIDE * right, -BESIDE * up], color);
        }
    }
}

/// A frame at a place, with the axes of the world.
pub(crate) fn upright(position: Point) -> Pose<f64> {
    Pose { position, rotation: [unit(0), unit(1), unit(2)] }
}

pub(crate) fn unit(axis: usize) -> Point {
    std::array::from_fn(|i| f64::from(u8::from(i == axis)))
}

/// `a + k b`
pub(crate) fn plus(a: Point, k: f64, b: Point) -> Point {
    std::array::from_fn(|i| a[i] + k * b[i])
}

/// Part of a circle around a centre, from the direction `u` on towards `v`, which are unit vectors across each other.
pub(crate) fn arc(centre: Point, [u, v]: [Point; 2], radius: f64, [from, to]: [f64; 2]) -> Vec<Point> {
    let at = |k: usize| {
        let (sin, cos) = (from + (to - from) * k as f64 / 48.0).sin_cos();
        plus(plus(centre, radius * cos, u), radius * sin, v)
    };
    (0..=48).map(at).collect()
}

/// Part of a circle in a plane.
pub(crate) fn plane_arc([x, y]: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let at = |k: usize| {
        let (sin, cos) = (from + (to - from) * k as f64 / 144.0).sin_cos();
        [x + radius * cos, y + radius * sin]
    };
    (0..=144).map(at).collect()
}

/// A figure that is one drawing.
pub(crate) fn drawing(title: &str, size: (u32, u32), sketch: Sketch) -> Figure {
    Figure { title: title.to_string(), size, panels: vec![Panel::Sketch(sketch)] }
}

/// The colour of arms, legs and vehicles.
pub(crate) const STEEL: Color = Color(176, 186, 198);
/// The stroke of auxiliary lines.
pub(crate) const THIN: Stroke = Stroke::new(BLACK, 1.0);
