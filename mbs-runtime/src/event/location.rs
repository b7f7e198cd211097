//! When an event happens: the root of its function between two times, and the sign with which it leaves zero.

use super::{Event, Watch};
use crate::error::IntegrationError;
use crate::integrator::{Step, is_between};
use crate::state::Coordinates;

impl<V: Coordinates> Watch<'_, '_, V> {
    /// Looks ever farther from `from` for the sign with which the event's function leaves zero.
    ///
    /// Two values in succession, the second the larger one, are believed, if they exceed the rounding errors.
    pub(super) fn leave_zero(
        &mut self,
        step: &mut dyn Step<V>,
        index: usize,
        from: f64,
        to: f64,
    ) -> Result<(), IntegrationError> {
        let length = to - from;
        let mut distance = (2.0 * resolution(from, to)).max(1e-14 * length.abs());
        let mut previous = 0.0_f64;
        while distance < length.abs() {
            let time = from + distance.copysign(length);
            step.interpolate(time, &mut self.there)?;
            // The motion may be cut before it gets there.
            let Ok(value) = self.value(index, time, from) else { return Ok(()) };
            let event = &mut self.events[index];
            if value.abs() <= 8.0 * event.residue {
                previous = 0.0;
            } else if value * previous.signum() > previous.abs() && previous != 0.0 {
                (event.side, event.since) = (sign(value), time);
                // An impact that leads through the surface all the same, soon after the one before, was the last one.
                if (event.last - from).abs() <= resolution(event.last, from)
                    && event.side != event.came
                    && event.gap.abs() < 1e3 * distance
                {
                    return Err(IntegrationError::EventsAccumulate { time: from, event: index });
                }
                return Ok(());
            } else {
                previous = value;
            }
            distance *= 4.0;
        }
        Ok(())
    }

    /// The first of some times from `time` on, ever farther from the root, at which the corrected state is behind the
    /// zeros of the events that have just happened there; `time` itself without a correction, or where another event
    /// or the end of the step comes first.
    pub(super) fn beyond_correction(
        &mut self,
        step: &mut dyn Step<V>,
        root: f64,
        time: f64,
    ) -> Result<f64, IntegrationError> {
        let Some(correct) = self.correction.as_mut() else { return Ok(time) };
        let length = step.time() - root;
        let mut distance = (time - root).abs().max(resolution(root, time)).max(1e-14 * length.abs());
        let mut later = time;
        while is_between(root, later, step.time()) && distance > 0.0 {
            step.interpolate(later, &mut self.there)?;
            self.after.copy_from(&self.there);
            if !correct(later, &mut self.after) {
                break;
            }
            let (mut is_behind, mut is_alone) = (true, true);
            for event in self.events.iter() {
                if event.last == root {
                    is_behind &= (event.function)(later, &self.after) * event.came <= 0.0;
                } else if event.is_armed() {
                    is_alone &= (event.function)(later, &self.there) * event.side > 0.0;
                }
            }
            if is_behind && (is_alone || later == time) {
                return Ok(later);
            }
            if !is_alone {
                break;
            }
            distance *= 4.0;
            later = root + distance.copysign(length);
        }
        Ok(time)
    }

    /// Finds roots behind which the events' functions are not finite before `to`; whether there are some.
    pub(super) fn find_hidden_roots(&mut self, step: &mut dyn Step<V>, to: f64) -> Result<bool, IntegrationError> {
        let mut found = false;
        for index in 0..self.events.len() {
            if self.events[index].next.is_nan() && self.events[index].is_armed() {
                found |= self.find_hidden_root(step, index, to)?;
            }
        }
        Ok(found)
    }

    /// Bisects between `since` and `to`, where the function is not finite, for the last place at which it is, as long
    /// as that is on the side it came from; where one is not, the root lies before it.
    pub(super) fn find_hidden_root(
        &mut self,
        step: &mut dyn Step<V>,
        index: usize,
        to: f64,
    ) -> Result<bool, IntegrationError> {
        let Event { side, since, .. } = self.events[index];
        let (mut good, mut bad) = (since, to);
        while (bad - good).abs() > resolution(good, bad) {
            let middle = good + 0.5 * (bad - good);
            step.interpolate(middle, &mut self.there)?;
            match self.value(index, middle, since) {
                Err(_) => bad = middle,
                Ok(value) if side * value > 0.0 => good = middle,
                Ok(_) => {
                    return match self.locate(step, index, middle) {
                        Err(IntegrationError::NonFiniteEvent { .. }) => Ok(false),
                        result => result.map(|()| true),
                    };
                }
            }
        }
        Ok(false)
    }

    /// Finds the time between `since` and `to` at which the event's function changes its sign: the last one before it,
    /// or the first one at which it is zero.
    ///
    /// ITP: bisection, where the regula falsi, moved towards the middle, has a say as long as it does no harm.
    pub(super) fn locate(&mut self, step: &mut dyn Step<V>, index: usize, to: f64) -> Result<(), IntegrationError> {
        let Event { side, since, .. } = self.events[index];
        // The function positive before the root and negative after; rounding errors do not count.
        let mut value = |time: f64| -> Result<f64, IntegrationError> {
            step.interpolate(time, &mut self.there)?;
            Ok(side * self.value(index, time, since)?)
        };
        let (mut a, mut b) = (since, to);
        let (mut at_a, mut at_b) = (value(a)?.max(0.0), value(b)?.min(0.0));
        let tolerance = f64::EPSILON * a.abs().max(b.abs());
        let pull = 0.2 / (b - a).abs();
        let mut bound = tolerance.max(f64::MIN_POSITIVE);
        // One iteration more than bisection, so that the regula falsi has its say from the start.
        while bound < 2.0 * (b - a).abs() {
            bound *= 2.0;
        }
        while (b - a).abs() > 2.0 * tolerance {
            let (middle, width) = (a + 0.5 * (b - a), (b - a).abs());
            let falsi = if at_a > 0.0 { a + (b - a) * (at_a / (at_a - at_b)) } else { middle };
            let inwards = middle - falsi;
            let moved = falsi + inwards.abs().min(pull * width * width).copysign(inwards);
            let radius = bound - 0.5 * width;
            let x = if (moved - middle).abs() <= radius { moved } else { middle - radius.copysign(inwards) };
            let x = if is_between(a, x, b) && x != a && x != b { x } else { middle };
            if x == a || x == b {
                break;
            }
            let at_x = value(x)?;
            if at_x > 0.0 {
                (a, at_a) = (x, at_x)
            } else {
                (b, at_b) = (x, at_x)
            }
            bound *= 0.5;
        }
        let event = &mut self.events[index];
        (event.root, event.behind) = (if at_b == 0.0 { b } else { a }, b);
        Ok(())
    }
}

/// Times closer than this are not told apart \[s\]; false for NaN in comparisons.
pub(super) fn resolution(a: f64, b: f64) -> f64 {
    16.0 * f64::EPSILON * a.abs().max(b.abs())
}

/// −1, 0 or 1.
pub(super) fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}
