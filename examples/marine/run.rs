//! One weather, the platform in it with and without control, and the landings on it.

use mbs_examples::Failure;
use mbs_landing::quadrotor::deck::MovingDeck;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::marine_platform::Params;
use mbs_platform::Coordinates;
use mbs_platform::marine::control::{Regulator, Weights};
use mbs_platform::marine::excitation::Excitation;
use mbs_platform::marine::hull::Hull;
use mbs_platform::marine::recorded::Recorded;
use mbs_platform::marine::sea::{Sea, Spreading};
use mbs_platform::marine::simulation::{AtSea, FREEBOARD, Moment};
use mbs_platform::marine::spectrum::{Jonswap, PEAKEDNESS};
use mbs_platform::marine::wind::Wind;
use mbs_runtime::State;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Components of the sea and of the gusts.
const WAVES: usize = 240;
const GUSTS: usize = 60;
/// Where waves and wind go to, from ahead towards the left \[rad\]: they come from ahead on the left.
const DIRECTION: f64 = -135.0 * std::f64::consts::PI / 180.0;
/// Of the controller, of a step of RK4 and of the record \[s\].
pub(crate) const PERIOD: f64 = 0.05;
/// How long the start is forgotten, and how long is counted from then on \[s\].
const RUN_IN: f64 = 200.0;
pub(crate) const DURATION: f64 = 1800.0;
/// The landing field in the axes of the mass centre \[m\].
const FIELD: [f64; 3] = [4.0, -3.0, 9.4];
/// From the start of one landing to that of the next \[s\].
const EVERY: f64 = 180.0;

/// The longest peak period: a record has sixty of them \[s\].
const LONGEST: f64 = 30.0;

/// The weather that is asked for.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct Weather {
    /// Significant wave height in metres.
    #[arg(long, value_name = "M", default_value_t = 2.5, allow_negative_numbers = true)]
    height: f64,
    /// Peak period in seconds.
    #[arg(long, value_name = "S", default_value_t = 10.0, allow_negative_numbers = true)]
    period: f64,
    /// Mean wind in metres per second.
    #[arg(long, value_name = "M/S", default_value_t = 12.0, allow_negative_numbers = true)]
    wind: f64,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value_t = 1973)]
    seed: u64,
}

impl Weather {
    /// Whether it is that of the page of assumed values.
    pub(crate) fn is_assumed(&self) -> bool {
        (self.height, self.period, self.wind) == (2.5, 10.0, 12.0)
    }
}

pub(crate) struct Study {
    pub(crate) spectrum: Jonswap,
    pub(crate) sea: Sea<WAVES>,
    pub(crate) wind: Wind<GUSTS>,
    pub(crate) hull: Hull,
    pub(crate) regulator: Regulator,
    pub(crate) limits: mbs_platform::marine::thrusters::Thrusters,
    /// Without and with control.
    pub(crate) runs: [Run; 2],
}

/// A motion, and what is to be said of it.
pub(crate) struct Run {
    pub(crate) name: &'static str,
    /// From the end of the run-in on.
    pub(crate) moments: Vec<Moment>,
    /// The least height of the deck's underside over the waves at a column, and the least depth of a column \[m\].
    pub(crate) least_air_gap: f64,
    pub(crate) least_depth: f64,
    pub(crate) landings: Vec<Touchdown>,
}

impl Study {
    pub(crate) fn of(weather: &Weather) -> Result<Self, Failure> {
        if weather.period > LONGEST {
            let period = weather.period;
            return Err(Failure::new(format!(
                "the peak period is at most {LONGEST} s for a record of this length, it is {period} s"
            )));
        }
        let mut random = Pcg64Mcg::seed_from_u64(weather.seed);
        let spectrum = Jonswap::new(weather.height, weather.period, PEAKEDNESS)?;
        let sea = Sea::new(&spectrum, DIRECTION, Spreading::CosineSquared, || random.random())?;
        let wind = Wind::new(weather.wind, DIRECTION, || random.random())?;
        let params = Params::default();
        let hull = Hull::new(&params)?;
        let regulator = Regulator::new(&params, &Weights::default())?;
        let free = AtSea::new(&params, Excitation::new(&hull, &sea), wind)?;
        let mut controlled = free.clone();
        controlled.regulator = Some(regulator);
        let runs = [Run::of("uncontrolled", &free, &sea)?, Run::of("controlled", &controlled, &sea)?];
        Ok(Self { spectrum, sea, wind, hull, regulator, limits: controlled.thrusters, runs })
    }

    /// Elevation over the middle of the platform at the moments of the record \[m\].
    pub(crate) fn elevation(&self) -> Vec<f64> {
        self.runs[0].moments.iter().map(|moment| self.sea.elevation([0.0; 2], moment.time)).collect()
    }
}

impl Run {
    fn of(name: &'static str, at_sea: &AtSea<WAVES, GUSTS>, sea: &Sea<WAVES>) -> Result<Self, Failure> {
        let mut moments = Vec::new();
        at_sea.simulate(State::new([0.0; 4], [0.0; 4]), PERIOD, RUN_IN + DURATION, |moment| {
            if moment.time >= RUN_IN {
                moments.push(*moment);
            }
        })?;
        let (hull, mut least_air_gap, mut least_depth) = (at_sea.hull(), f64::INFINITY, f64::INFINITY);
        // Five times a second.
        for moment in moments.iter().step_by(4) {
            for wet in hull.depths_under(&moment.q, |place| sea.elevation(place, moment.time)) {
                least_air_gap = least_air_gap.min(hull.draught + FREEBOARD - wet);
                least_depth = least_depth.min(wet);
            }
        }
        let samples: Vec<[Coordinates; 3]> = moments.iter().map(Moment::in_six).collect();
        let landings = starts(samples.len()).map(|start| landing(&samples[start..])).collect::<Result<_, _>>()?;
        Ok(Run { name, moments, least_air_gap, least_depth, landings })
    }

    /// A coordinate at every moment.
    pub(crate) fn coordinate(&self, i: usize) -> Vec<f64> {
        self.moments.iter().map(|moment| moment.q[i]).collect()
    }
}

/// Indices of samples at which landings begin, a minute at least before the end.
fn starts(samples: usize) -> impl Iterator<Item = usize> {
    let seconds = |t: f64| (t / PERIOD).round() as usize;
    (0..samples.saturating_sub(seconds(60.0))).step_by(seconds(EVERY))
}

/// On a deck that is level with the world's origin at rest.
fn landing(samples: &[[Coordinates; 3]]) -> Result<Touchdown, Failure> {
    let motion = Recorded { step: PERIOD, samples };
    let deck = MovingDeck { motion, base: [12.0 - FIELD[0], 7.0 - FIELD[1], -FIELD[2]], point: FIELD };
    Ok(Landing::on(Plant::Exact, deck).simulate(Landing::initial_state(), |_, _, _| ())?)
}
