//! A motion that was computed and is played back.
//!
//! Between two samples each coordinate is the quintic polynomial with the values, rates and accelerations of both:
//! rates and accelerations are the derivatives of the coordinates exactly, and continuous.

use crate::{Coordinates, PlatformMotion};

/// A motion by equidistant samples. Before the first and after the last it is NaN: nothing is known there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recorded<'a> {
    /// From one sample to the next, positive \[s\].
    pub step: f64,
    /// Coordinates, rates and accelerations, the first ones at t = 0.
    pub samples: &'a [[Coordinates; 3]],
}

impl PlatformMotion for Recorded<'_> {
    fn at(&self, t: f64) -> [Coordinates; 3] {
        let place = t / self.step;
        let last = self.samples.len().saturating_sub(1);
        // Negative to 0, and NaN, too: the comparison below refuses both.
        let index = (place as usize).min(last.saturating_sub(1));
        let inside = (0.0..=last as f64).contains(&place);
        match self.samples.get(index..index + 2) {
            Some([before, after]) if inside => between(before, after, self.step, place - index as f64),
            _ => [[f64::NAN; 6]; 3],
        }
    }
}

/// The quintic at a part s of a step.
fn between(before: &[Coordinates; 3], after: &[Coordinates; 3], step: f64, s: f64) -> [Coordinates; 3] {
    let mut motion = [[0.0; 6]; 3];
    for i in 0..6 {
        let [p0, v0, a0] = [before[0][i], step * before[1][i], step * step * before[2][i]];
        let [p1, v1, a1] = [after[0][i], step * after[1][i], step * step * after[2][i]];
        // What the parabola from the first sample misses at the second.
        let (p, v, a) = (p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
        let cubic = 10.0 * p - 4.0 * v + 0.5 * a;
        let quartic = -15.0 * p + 7.0 * v - a;
        let quintic = 6.0 * p - 3.0 * v + 0.5 * a;
        motion[0][i] = p0 + s * (v0 + s * (0.5 * a0 + s * (cubic + s * (quartic + s * quintic))));
        motion[1][i] = (v0 + s * (a0 + s * (3.0 * cubic + s * (4.0 * quartic + s * 5.0 * quintic)))) / step;
        motion[2][i] = (a0 + s * (6.0 * cubic + s * (12.0 * quartic + s * 20.0 * quintic))) / (step * step);
    }
    motion
}
