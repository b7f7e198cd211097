//! The landings of the thesis in gusts and sheared wind.

use std::cell::RefCell;

use mbs_chart::{Figure, Line, Panel};
use mbs_landing::quadrotor::deck::HeavingDeck;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_landing::quadrotor::wind::{Gusts, Shear, Wind};
use mbs_models::Error;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::flight::{KEPT, heaving};
use super::members::{self, PERIOD};
use crate::Failure;

/// At 20 ft over the ground \[m/s\].
const WIND: f64 = 6.0;
/// Where it blows to \[°\].
const DIRECTION: f64 = 30.0;
/// Mean height of the deck over the ground \[m\].
const DECK: f64 = 3.0;
/// Landings of each case.
const MEMBERS: u64 = 200;

/// What the landings in gusts rest on, beside what every landing does.
pub const ASSUMED: [&str; 2] = ["landing.wind", "landing.wind_shear"];

/// The assumed wind.
///
/// # Errors
/// None for the assumed values.
pub fn wind() -> Result<Wind, Failure> {
    Ok(Wind::new(WIND, DIRECTION.to_radians(), Shear::LANDING, -DECK)?)
}

/// One moment of a landing in gusts.
pub struct Gust {
    /// When \[s\].
    pub t: f64,
    /// Velocity of the air at the vehicle, in world axes \[m/s\].
    pub wind: [f64; 3],
    /// The vehicle's offset from the middle of the deck \[m\].
    pub offset: [f64; 2],
    /// Roll and pitch \[rad\].
    pub tilt: [f64; 2],
}

/// Many landings of a case in gusts, the first one with its way.
pub struct InGusts {
    /// The case of the thesis.
    pub case: &'static str,
    /// Of the first landing, every 10 ms.
    pub moments: Vec<Gust>,
    /// In the mean wind without gusts.
    pub steady: Touchdown,
    /// Those of all seeds that touched down, in the order of the seeds.
    pub touchdowns: Vec<Touchdown>,
}

/// A landing in the turbulence of a seed.
fn landed(
    landing: &Landing<HeavingDeck<4>>,
    wind: &Wind,
    seed: u64,
    mut see: impl FnMut(Gust),
) -> Result<Touchdown, Error> {
    let mut normal = members::deviates(seed);
    let mut deviates = move || -> [f64; 5] { std::array::from_fn(|_| normal()) };
    let mut gusts = Gusts::stationary(&deviates());
    landing.simulate_in_wind(
        Landing::initial_state(),
        PERIOD,
        |_, state| *state,
        |t, state| {
            let [x, y, z, phi, theta, _] = state.q;
            let [xd, yd, zd, ..] = state.qd;
            let wind = wind.blow(&mut gusts, z, &[xd, yd, zd], PERIOD, &deviates());
            let [x_deck, y_deck] = landing.deck.place;
            see(Gust { t, wind, offset: [x - x_deck, y - y_deck], tilt: [phi, theta] });
            wind
        },
    )
}

type Series = (&'static str, fn(&Gust) -> f64);

impl InGusts {
    /// Flies all landings of a case.
    ///
    /// # Errors
    /// Where the landing without gusts, or the first one in gusts, has no touchdown.
    pub fn of(case: &'static str, heave: Heave<4>) -> Result<Self, Failure> {
        let (landing, wind) = (Landing::on(Plant::Exact, heaving(heave)), wind()?);
        let moments = RefCell::new((Vec::new(), 0));
        landed(&landing, &wind, 0, |gust| {
            let (kept, seen) = &mut *moments.borrow_mut();
            if *seen % KEPT == 0 {
                kept.push(gust);
            }
            *seen += 1;
        })?;
        let steady = landing.simulate_in_wind(
            Landing::initial_state(),
            PERIOD,
            |_, state| *state,
            |_, state| wind.mean(state.q[2]),
        )?;
        let touchdowns: Vec<_> =
            (0..MEMBERS).into_par_iter().filter_map(|seed| landed(&landing, &wind, seed, |_| ()).ok()).collect();
        Ok(InGusts { case, moments: moments.into_inner().0, steady, touchdowns })
    }

    /// Mean and standard deviation of a result.
    fn spread(&self, of: fn(&Touchdown) -> f64) -> [f64; 2] {
        members::spread(self.touchdowns.iter().map(of))
    }

    fn greatest(&self, of: impl Fn(&Touchdown) -> f64) -> f64 {
        self.touchdowns.iter().map(of).fold(0.0, f64::max)
    }

    /// SI units; spreads are mean and standard deviation over the seeds.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let steady = &self.steady;
        json!({
            "members": MEMBERS,
            "failed": MEMBERS - self.touchdowns.len() as u64,
            "steady_wind": {
                "touchdown_time": steady.time,
                "relative_velocity": steady.relative_velocity,
                "horizontal_offset": steady.horizontal_offset,
            },
            "touchdown_time": self.spread(|end| end.time),
            "relative_velocity": self.spread(|end| end.relative_velocity),
            "horizontal_offset": self.spread(|end| end.horizontal_offset),
            "horizontal_offset_max": self.greatest(|end| end.horizontal_offset),
            "horizontal_speed": self.spread(|end| end.horizontal_speed),
        })
    }

    /// A line of a summary.
    #[must_use]
    pub fn summary(&self) -> String {
        let [time, time_sd] = self.spread(|end| end.time);
        let [velocity, velocity_sd] = self.spread(|end| end.relative_velocity);
        let [offset, offset_sd] = self.spread(|end| end.horizontal_offset);
        format!(
            "  {:<6} {} of {MEMBERS} down at {time:.4} ± {time_sd:.4} s, {velocity:.4} ± {velocity_sd:.4} m/s, {offset:.3} ± {offset_sd:.3} m off, at most {:.3} m; without gusts {:.3} m\n",
            self.case,
            self.touchdowns.len(),
            self.greatest(|end| end.horizontal_offset),
            self.steady.horizontal_offset,
        )
    }

    /// Wind, offset and tilt on the way of the first landing.
    #[must_use]
    pub fn drawn(&self) -> (String, Figure) {
        let end = self.moments.last().map_or(1.0, |last| last.t);
        let panel = |label: &str, series: &[Series]| {
            let line =
                |&(name, of): &Series| Line::new(name, self.moments.iter().map(|gust| (gust.t, of(gust))).collect());
            Panel::over_time(label, 0.0..end, series.iter().map(line).collect())
        };
        let panels = vec![
            panel("wind [m/s]", &[("x", |g| g.wind[0]), ("y", |g| g.wind[1]), ("z", |g| g.wind[2])]),
            panel("beside the middle [m]", &[("x − 12 m", |g| g.offset[0]), ("y − 7 m", |g| g.offset[1])]),
            panel("angle [°]", &[("roll φ", |g| g.tilt[0].to_degrees()), ("pitch θ", |g| g.tilt[1].to_degrees())]),
        ];
        let title = format!("Landing in sheared wind and gusts, case {}", self.case);
        (format!("case_{}_gusts", self.case), Figure { title, size: (900, 900), panels })
    }
}
