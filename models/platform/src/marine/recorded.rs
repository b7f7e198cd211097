//! A motion that was computed and is played back.
//!
//! Between two samples each coordinate is the quintic polynomial with the values, rates and accelerations of both:
//! rates and accelerations are the derivatives of the coordinates exactly, and continuous.

use crate::motion::hermite;
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

/// The quintics at a part s of a step.
fn between(before: &[Coordinates; 3], after: &[Coordinates; 3], step: f64, s: f64) -> [Coordinates; 3] {
    let mut motion = [[0.0; 6]; 3];
    for i in 0..6 {
        let found = hermite(before.map(|of| of[i]), after.map(|of| of[i]), step, s);
        (0..3).for_each(|order| motion[order][i] = found[order]);
    }
    motion
}
