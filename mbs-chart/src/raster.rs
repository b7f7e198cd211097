//! A scene as pixels: each is covered by as much of a shape as of its 3 × 3 parts are.

use crate::scene::{Anchor, BASELINE, INDEX_DROP, Scene, Shape, Text};
use crate::style::{Color, Stroke};

/// Parts of a pixel's side.
const PARTS: usize = 3;

/// Rows of red, green and blue.
pub(crate) fn pixels(scene: &Scene<'_>, (width, height): (u32, u32)) -> Vec<u8> {
    let mut image =
        Image { size: [width as usize, height as usize], channels: vec![255; 3 * (width * height) as usize] };
    for shape in &scene.shapes {
        match shape {
            Shape::Line { points, stroke } => image.line(points, stroke),
            Shape::Area { points, fill } => {
                let mut mask = Mask::around(points, 0.0, image.size);
                mask.polygon(points);
                image.paint(&mask, *fill);
            }
            Shape::Dot { centre, radius, fill } => {
                let mut mask = Mask::around(&[*centre], *radius, image.size);
                mask.disc(*centre, *radius);
                image.paint(&mask, *fill);
            }
            Shape::Text(text) => image.text(text, scene),
        }
    }
    image.channels
}

struct Image {
    size: [usize; 2],
    channels: Vec<u8>,
}

impl Image {
    fn line(&mut self, points: &[[f64; 2]], stroke: &Stroke) {
        let half = 0.5 * stroke.width;
        let mut mask = Mask::around(points, half, self.size);
        for [a, b] in dashes(points, stroke.dash) {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            if length > 0.0 {
                let [nx, ny] = [-half * (b[1] - a[1]) / length, half * (b[0] - a[0]) / length];
                mask.polygon(&[
                    [a[0] + nx, a[1] + ny],
                    [b[0] + nx, b[1] + ny],
                    [b[0] - nx, b[1] - ny],
                    [a[0] - nx, a[1] - ny],
                ]);
            }
        }
        if stroke.dash.is_empty() {
            points.iter().for_each(|point| mask.disc(*point, half));
        }
        self.paint(&mask, stroke.color);
    }

    fn paint(&mut self, mask: &Mask, color: Color) {
        let [width, height] = mask.size.map(|parts| parts / PARTS);
        for y in 0..height {
            for x in 0..width {
                let row = |j: usize| {
                    let start = (PARTS * y + j) * mask.size[0] + PARTS * x;
                    mask.covered[start..start + PARTS].iter().filter(|covered| **covered).count()
                };
                let count: usize = (0..PARTS).map(row).sum();
                if count > 0 {
                    self.blend(mask.corner[0] + x, mask.corner[1] + y, color, count as f64 / (PARTS * PARTS) as f64);
                }
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, Color(red, green, blue): Color, share: f64) {
        let start = 3 * (y * self.size[0] + x);
        for (channel, wanted) in self.channels[start..start + 3].iter_mut().zip([red, green, blue]) {
            *channel = (f64::from(*channel) + share * (f64::from(wanted) - f64::from(*channel))).round() as u8;
        }
    }

    fn text(&mut self, text: &Text, scene: &Scene<'_>) {
        let back = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let mut x = text.at[0] - back * text.width(scene.face);
        let baseline = text.at[1] + BASELINE * text.size;
        for run in &text.runs {
            let y = if run.is_index { baseline + INDEX_DROP * text.size } else { baseline };
            scene.face.draw(&run.text, text.em(run), [x, y], |i, j, covered| {
                if let (Ok(i), Ok(j)) = (usize::try_from(i), usize::try_from(j))
                    && i < self.size[0]
                    && j < self.size[1]
                {
                    self.blend(i, j, text.color, covered.clamp(0.0, 1.0));
                }
            });
            x += scene.face.width(&run.text, text.em(run));
        }
    }
}

/// The stretches of a line that are drawn.
fn dashes(points: &[[f64; 2]], dash: &[f64]) -> Vec<[[f64; 2]; 2]> {
    let segments = points.windows(2).map(|pair| [pair[0], pair[1]]);
    if dash.is_empty() {
        return segments.collect();
    }
    let (mut drawn, mut which, mut left) = (Vec::new(), 0, dash[0]);
    for [a, b] in segments {
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let at = |way: f64| [0, 1].map(|i| a[i] + (b[i] - a[i]) * way / length);
        let mut way = 0.0;
        while way < length {
            let step = left.min(length - way);
            if which % 2 == 0 {
                drawn.push([at(way), at(way + step)]);
            }
            (way, left) = (way + step, left - step);
            if left <= 0.0 {
                which = (which + 1) % dash.len();
                left = dash[which];
            }
        }
    }
    drawn
}

/// Which parts of the pixels around a shape are covered.
struct Mask {
    /// In pixels.
    corner: [usize; 2],
    /// In parts.
    size: [usize; 2],
    covered: Vec<bool>,
}

impl Mask {
    fn around(points: &[[f64; 2]], margin: f64, image: [usize; 2]) -> Self {
        let limit = |axis: usize, value: f64| value.clamp(0.0, image[axis] as f64) as usize;
        let bounds = [0, 1].map(|axis| {
            let (low, high) = points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
            [limit(axis, (low - margin).floor()), limit(axis, (high + margin).ceil() + 1.0)]
        });
        let size = bounds.map(|[low, high]| PARTS * high.saturating_sub(low));
        Mask { corner: bounds.map(|[low, _]| low), size, covered: vec![false; size[0] * size[1]] }
    }

    /// Where the middle of a row of parts is.
    fn middle(&self, row: usize) -> f64 {
        self.corner[1] as f64 + (row as f64 + 0.5) / PARTS as f64
    }

    /// The rows with their middles between two values.
    fn rows(&self, low: f64, high: f64) -> std::ops::Range<usize> {
        let row = |y: f64| ((y - self.corner[1] as f64) * PARTS as f64 - 0.5).ceil().clamp(0.0, self.size[1] as f64);
        row(low) as usize..row(high) as usize
    }

    fn span(&mut self, row: usize, low: f64, high: f64) {
        let part = |x: f64| ((x - self.corner[0] as f64) * PARTS as f64 - 0.5).ceil().clamp(0.0, self.size[0] as f64);
        let (low, high) = (part(low) as usize, part(high) as usize);
        let start = row * self.size[0];
        if low < high {
            self.covered[start + low..start + high].fill(true);
        }
    }

    /// Inside where a ray leaves through an odd number of edges.
    fn polygon(&mut self, points: &[[f64; 2]]) {
        let ys = || points.iter().map(|point| point[1]);
        for row in self.rows(ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max)) {
            let y = self.middle(row);
            let next = |i: usize| points[(i + 1) % points.len()];
            let mut crossings: Vec<f64> = (0..points.len())
                .filter(|&i| (points[i][1] <= y) != (next(i)[1] <= y))
                .map(|i| {
                    let ([x1, y1], [x2, y2]) = (points[i], next(i));
                    x1 + (x2 - x1) * (y - y1) / (y2 - y1)
                })
                .collect();
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                self.span(row, pair[0], pair[1]);
            }
        }
    }

    fn disc(&mut self, [x, y]: [f64; 2], radius: f64) {
        for row in self.rows(y - radius, y + radius) {
            let half = (radius * radius - (self.middle(row) - y).powi(2)).max(0.0).sqrt();
            self.span(row, x - half, x + half);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_are_as_long_as_they_are_to_be_around_corners() {
        let drawn = dashes(&[[0.0, 0.0], [4.0, 0.0], [4.0, 10.0]], &[6.0, 3.0]);
        assert_eq!(drawn, [[[0.0, 0.0], [4.0, 0.0]], [[4.0, 0.0], [4.0, 2.0]], [[4.0, 5.0], [4.0, 10.0]]]);
    }

    #[test]
    fn a_square_covers_its_pixels() {
        let mut mask = Mask::around(&[[1.0, 1.0], [3.0, 2.0]], 0.0, [10, 10]);
        mask.polygon(&[[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0]]);
        assert_eq!(mask.covered.iter().filter(|covered| **covered).count(), 2 * PARTS * PARTS);
    }
}
