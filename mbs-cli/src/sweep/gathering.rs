//! What is taken of one motion: values at its end, extrema, means, and when a formula passes zero.
//!
//! Extrema are looked for at nine places of each step of the integrator, on its dense output, and then bracketed; means
//! are Simpson's rule over these places, of halves and their halves where nine places are too few. What comes and goes
//! between them is not seen.

use mbs_ensemble::plan::{Direction, Reduction};
use mbs_runtime::{Event, Response};

use crate::equations::{Equations, Motion as Moving};
use crate::simulate::formula::{Formula, runtime};
use crate::simulate::motion::{Inside, Onlooker, Run};

/// A quantity that is wanted.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) name: String,
    pub(super) formula: Formula,
    pub(super) reduction: Reduction,
}

impl Wanted {
    /// The passages of zero that it is about.
    fn direction(&self) -> Option<Direction> {
        match self.reduction {
            Reduction::TimeOf(direction) | Reduction::Count(direction) | Reduction::Happened(direction) => {
                Some(direction)
            }
            Reduction::Final | Reduction::Min | Reduction::Max | Reduction::Mean => None,
        }
    }

    /// Its value at a time, which must be a number.
    fn at(&self, equations: &Equations<'_>, t: f64, moving: &Moving) -> Result<f64, String> {
        self.finite(t, self.formula.value(equations, t, moving))
    }

    fn finite(&self, t: f64, value: f64) -> Result<f64, String> {
        if value.is_finite() { Ok(value) } else { Err(format!("`{}` is {value:?} at t = {t:?}", self.name)) }
    }
}

/// The quantities of a motion to this time, or until a formula passes zero.
pub(super) fn quantities(
    run: Run<'_, '_>,
    end: f64,
    wanted: &[Wanted],
    until: Option<(Formula, Direction)>,
) -> Result<Vec<f64>, String> {
    let (equations, start) = (run.equations, run.equations.start_time());
    let passages = || wanted.iter().filter_map(|wanted| Some((wanted.formula, wanted.direction()?)));
    let functions: Vec<_> = passages()
        .chain(until)
        .map(|(formula, _)| move |t: f64, moving: &Moving| formula.value(equations, t, moving))
        .collect();
    let mut first = vec![f64::NAN; passages().count()];
    let mut notes: Vec<_> = first
        .iter_mut()
        .map(|first| {
            move |t: f64, _: &mut Moving| {
                if first.is_nan() {
                    *first = t;
                }
                Response::Continue
            }
        })
        .collect();
    let mut events: Vec<Event<'_, Vec<f64>>> = Vec::new();
    for (((_, direction), function), note) in passages().zip(&functions).zip(&mut notes) {
        events.push(Event::new(function).direction(runtime(direction)).with_action(note));
    }
    if let (Some((_, direction)), Some(function)) = (until, functions.last()) {
        events.push(Event::new(function).direction(runtime(direction)).terminal());
    }
    let tracks = vec![Track::default(); wanted.len()];
    let mut gathering = Gathering { equations, wanted, tracks, moving: equations.start() };
    let named = wanted.iter().filter(|wanted| wanted.direction().is_some()).map(|wanted| wanted.name.as_str());
    let names: Vec<&str> = named.chain(until.map(|_| "until")).collect();
    let (summary, last) = run.follow(end, (&mut events, &names), &mut gathering)?;
    let counts: Vec<usize> = events.iter().map(Event::count).collect();
    drop(events);
    drop(notes);
    let mut passed = first.into_iter().zip(counts);
    let values = wanted.iter().zip(gathering.tracks).map(|(wanted, track)| match wanted.reduction {
        Reduction::Final => wanted.at(equations, summary.time, &last),
        Reduction::Min => Ok(track.least),
        Reduction::Max => Ok(track.greatest),
        Reduction::Mean => Ok(track.integral / (summary.time - start)),
        Reduction::TimeOf(_) => Ok(passed.next().map_or(f64::NAN, |(first, _)| first)),
        Reduction::Count(_) => Ok(passed.next().map_or(f64::NAN, |(_, count)| count as f64)),
        Reduction::Happened(_) => Ok(passed.next().map_or(f64::NAN, |(_, count)| f64::from(u8::from(count > 0)))),
    });
    values.collect()
}

/// What is known of a quantity so far.
#[derive(Clone, Copy)]
struct Track {
    least: f64,
    greatest: f64,
    /// Over time.
    integral: f64,
}

impl Default for Track {
    fn default() -> Self {
        Track { least: f64::INFINITY, greatest: f64::NEG_INFINITY, integral: 0.0 }
    }
}

struct Gathering<'a, 'd> {
    equations: &'a Equations<'d>,
    wanted: &'a [Wanted],
    tracks: Vec<Track>,
    moving: Moving,
}

/// Into how many parts a step is divided.
const PARTS: usize = 8;

impl Onlooker for Gathering<'_, '_> {
    fn begin(&mut self, _: f64, _: &Moving) -> Result<(), String> {
        Ok(())
    }

    fn step(&mut self, from: f64, to: f64, inside: &mut Inside<'_>) -> Result<(), String> {
        use Reduction::{Max, Mean, Min};
        let looks = |wanted: &Wanted| matches!(wanted.reduction, Min | Max | Mean);
        if !self.wanted.iter().any(looks) || from == to {
            return Ok(());
        }
        let times = places(from, to);
        let mut values = vec![[0.0; PARTS + 1]; self.wanted.len()];
        for (k, t) in times.into_iter().enumerate() {
            inside(t, &mut self.moving)?;
            let (equations, wanted) = (self.equations, self.wanted.iter().zip(&mut values));
            equations.at(t, &self.moving.q, &self.moving.qd, |state| {
                wanted.filter(|(wanted, _)| looks(wanted)).try_for_each(|(wanted, values)| {
                    values[k] = wanted.finite(t, wanted.formula.of(equations, state))?;
                    Ok::<(), String>(())
                })
            })?;
        }
        for (number, values) in values.iter().enumerate() {
            match self.wanted[number].reduction {
                Max => self.tracks[number].greatest = self.peak(number, 1.0, values, &times, inside)?,
                Min => self.tracks[number].least = 0.0 - self.peak(number, -1.0, values, &times, inside)?,
                Mean => self.tracks[number].integral += self.integral(number, *values, [from, to], inside)?,
                _ => {}
            }
        }
        Ok(())
    }
}

impl Gathering<'_, '_> {
    /// The integral of a quantity over a step of which these are values: adaptive, to a jump or a kink.
    fn integral(
        &mut self,
        number: usize,
        values: [f64; PARTS + 1],
        [from, to]: [f64; 2],
        inside: &mut Inside<'_>,
    ) -> Result<f64, String> {
        /// The error allowed, as a part of the largest value times the length of the step.
        const TOLERANCE: f64 = 1e-7;
        /// How often an interval is halved at most.
        const DEEPEST: u32 = 24;
        /// How many intervals of one step are halved at most. A few jumps take fewer; rounding noise would take any
        /// number.
        const MOST: usize = 500;
        let size = values.iter().fold(0.0, |size: f64, value| size.max(value.abs()));
        let allowed = TOLERANCE * size * (to - from).abs();
        let (mut sum, mut halved) = (0.0, 0);
        let mut waiting = vec![(values, from, to, 0)];
        while let Some((values, from, to, depth)) = waiting.pop() {
            let fine = simpson(&values, to - from);
            let every_other: [f64; PARTS / 2 + 1] = std::array::from_fn(|k| values[2 * k]);
            if (fine - simpson(&every_other, to - from)).abs() <= allowed || depth == DEEPEST || halved == MOST {
                sum += fine;
                continue;
            }
            halved += 1;
            let middle = from + 0.5 * (to - from);
            for (from, to) in [(middle, to), (from, middle)] {
                let mut values = [0.0; PARTS + 1];
                for (value, t) in values.iter_mut().zip(places(from, to)) {
                    inside(t, &mut self.moving)?;
                    *value = self.wanted[number].at(self.equations, t, &self.moving)?;
                }
                waiting.push((values, from, to, depth + 1));
            }
        }
        Ok(sum)
    }

    /// The greatest value of a quantity, or of its negative, so far and in this step.
    fn peak(
        &mut self,
        number: usize,
        sign: f64,
        values: &[f64; PARTS + 1],
        times: &[f64; PARTS + 1],
        inside: &mut Inside<'_>,
    ) -> Result<f64, String> {
        /// 1/φ
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let so_far = if sign > 0.0 { self.tracks[number].greatest } else { -self.tracks[number].least };
        let values = values.map(|value| sign * value);
        let best = (0..=PARTS).fold(0, |best, k| if values[k] > values[best] { k } else { best });
        let (low, high) = (best.saturating_sub(1), (best + 1).min(PARTS));
        // The vertex of a parabola is above the greatest of three neighbouring values by at most an eighth of their
        // range; so it is at the ends of a step, where the greatest has one neighbour.
        let first = best.clamp(1, PARTS - 1) - 1;
        let rise = values[best] - values[first..first + 3].iter().fold(values[best], |least, value| least.min(*value));
        let mut peak = so_far.max(values[best]);
        if rise == 0.0 || values[best] + rise < so_far {
            return Ok(peak);
        }
        let wanted = &self.wanted[number];
        let mut value = |t: f64| -> Result<f64, String> {
            inside(t, &mut self.moving)?;
            Ok(sign * wanted.at(self.equations, t, &self.moving)?)
        };
        let (mut a, mut b) = (times[low], times[high]);
        let (mut left, mut right) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        let (mut at_left, mut at_right) = (value(left)?, value(right)?);
        // The place is then known to a millionth of the step, the value to the square of that.
        for _ in 0..25 {
            peak = peak.max(at_left).max(at_right);
            if at_left > at_right {
                (b, right, at_right) = (right, left, at_left);
                left = b - GOLDEN * (b - a);
                at_left = value(left)?;
            } else {
                (a, left, at_left) = (left, right, at_right);
                right = a + GOLDEN * (b - a);
                at_right = value(right)?;
            }
        }
        Ok(peak.max(at_left).max(at_right))
    }
}

/// Both ends of a step, and equally far apart what lies between them.
fn places(from: f64, to: f64) -> [f64; PARTS + 1] {
    std::array::from_fn(|k| if k == PARTS { to } else { from + (to - from) * k as f64 / PARTS as f64 })
}

/// The integral over values that are equally far apart, an odd number of them.
fn simpson(values: &[f64], width: f64) -> f64 {
    let parts = values.len() - 1;
    let weight = |k: usize| match k {
        k if k == 0 || k == parts => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = values.iter().enumerate().map(|(k, value)| weight(k) * value).sum();
    sum * width / (3.0 * parts as f64)
}
