//! The landings of a case, with the time that their plans took.

use std::time::Instant;

use mbs_examples::Failure;
use mbs_examples::quadrotor_landing::flight::{Flight, Kind, heaving};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::predictive::controller::{Descent, Horizon, Memory, PredictiveController};
use mbs_landing::quadrotor::predictive::flight::{LOOKS, Moment, Replanning, fly};
use mbs_landing::quadrotor::predictive::limits::Limits;
use mbs_landing::quadrotor::predictive::sequential::{Optimum, Options};
use mbs_landing::quadrotor::predictive::shortest::ShortestLanding;
use mbs_landing::quadrotor::predictive::step::{Prediction, ROTORS, STATES};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::Error;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};

/// Velocity of the air that no plan knows of, assumed \[m/s\].
const WIND: [f64; 3] = [3.0, -2.0, 0.0];

/// By what part the vehicle is heavier than planned, assumed.
const EXCESS: f64 = 0.03;

/// From one plan of the shortest landing to the next, assumed \[s\].
const EVERY: f64 = 0.05;

/// Intervals and programs of such a plan, assumed.
const INTERVALS: usize = 20;
const PROGRAMS: usize = 3;

/// Thrust that such a plan leaves aside, assumed \[m g\].
const RESERVE: f64 = 0.2;

/// What such a plan keeps at the touchdown, assumed: sink rate \[m/s\], offset \[m\].
const TIGHTER: [f64; 2] = [0.2, 0.05];

/// Times of the straight motions from which the shortest one is looked for \[s\].
const GUESSES: [f64; 2] = [2.0, 2.5];

/// A landing as it was flown.
pub(crate) struct Flown {
    pub(crate) touchdown: Touchdown,
    pub(crate) moments: Vec<Moment>,
    /// When plans were made, and how long it took \[s\]; the first one has no plan to begin with.
    pub(crate) plans: Vec<(f64, f64)>,
    /// When the landing was to end by them \[s\], of the shortest one.
    pub(crate) ends: Vec<(f64, f64)>,
}

impl Flown {
    /// Median and greatest time of plans after the first \[s\].
    pub(crate) fn planning(&self) -> [f64; 2] {
        let mut times: Vec<f64> = self.plans.iter().skip(1).map(|plan| plan.1).collect();
        times.sort_by(f64::total_cmp);
        [times.get(times.len() / 2).copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0)]
    }

    /// The greatest tilt \[rad\], the least visibility and height \[m\], and the least and the greatest thrust of a
    /// rotor \[N\], every 2 ms.
    pub(crate) fn extremes(&self) -> [f64; 5] {
        let factor = Params::<f64>::default().thrust_factor;
        let mut found = [0.0, f64::INFINITY, f64::INFINITY, f64::INFINITY, 0.0_f64];
        for moment in &self.moments {
            found[0] = moment.tilt.max(found[0]);
            found[1] = moment.visibility.min(found[1]);
            found[2] = (moment.state.q[2] - moment.deck.position[2]).min(found[2]);
            for speed in moment.speeds {
                found[3] = found[3].min(factor * speed * speed);
                found[4] = found[4].max(factor * speed * speed);
            }
        }
        found
    }

    /// Which of the limits that hold until the touchdown, and at it, were not kept.
    pub(crate) fn broken(&self) -> Vec<&'static str> {
        let (limits, end) = (Limits::default(), &self.touchdown);
        let [tilt, visibility, height, ..] = self.extremes();
        let kept = [
            ("tilt", tilt <= limits.tilt),
            ("visibility", visibility >= 0.0),
            ("height", height >= -1e-6),
            ("sink rate", -end.relative_velocity <= limits.touchdown.sink_rate),
            ("horizontal speed", end.horizontal_speed <= limits.touchdown.horizontal_speed),
            ("offset", end.horizontal_offset <= limits.touchdown.offset),
        ];
        kept.into_iter().filter(|(_, kept)| !kept).map(|(name, _)| name).collect()
    }
}

/// All landings of a case.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) heave: Heave<4>,
    /// The shortest, with all that the limits allow, and how long it took to find \[s\].
    pub(crate) shortest: (Optimum<STATES, ROTORS>, f64),
    /// With what is left aside for flight.
    pub(crate) first: Optimum<STATES, ROTORS>,
    /// In calm air, in wind and heavier.
    pub(crate) replanned: [Flown; 2],
    pub(crate) predictive: [Flown; 2],
    /// By backstepping, in calm air.
    pub(crate) guided: Flight,
}

impl Case {
    pub(crate) fn flown(name: &'static str, heave: Heave<4>, horizon: Horizon) -> Result<Self, Failure> {
        let clock = Instant::now();
        let found = landing(heave, Limits::default()).plan(Options::default(), &GUESSES)?;
        let shortest = (found, clock.elapsed().as_secs_f64());
        let mut limits = Limits::default();
        [limits.touchdown.sink_rate, limits.touchdown.offset] = TIGHTER;
        let planned = ShortestLanding { reserve: RESERVE, intervals: INTERVALS, ..landing(heave, limits) };
        let first = planned.plan(Options::default(), &GUESSES)?;
        let worlds = [world(heave, [0.0; 3], 0.0), world(heave, WIND, EXCESS)];
        let [calm, windy] = &worlds;
        let replanned = [replanned(calm, &planned, &first, horizon)?, replanned(windy, &planned, &first, horizon)?];
        let predictive = [predictive(calm, horizon)?, predictive(windy, horizon)?];
        let guided = Flight::of(name, Kind::Exact, heaving(heave))?;
        Ok(Case { name, heave, shortest, first, replanned, predictive, guided })
    }
}

fn landing(heave: Heave<4>, limits: Limits) -> ShortestLanding {
    ShortestLanding::new(Prediction::new(Params::default()), limits, heaving(heave), &Landing::initial_state())
}

/// The vehicle as it is.
fn world(heave: Heave<4>, wind: [f64; 3], excess: f64) -> Landing {
    let params = Params::default();
    let vehicle = QuadrotorEuler::new(Params { m: params.m * (1.0 + excess), ..params });
    Landing { vehicle, wind, t_end: 30.0, ..Landing::new(Plant::Exact, heave) }
}

fn replanned(
    world: &Landing,
    planned: &ShortestLanding,
    first: &Optimum<STATES, ROTORS>,
    horizon: Horizon,
) -> Result<Flown, Error> {
    let mut replanning = Replanning::new(planned.clone(), first.plan.clone(), EVERY, PROGRAMS);
    let (mut plans, mut ends) = (Vec::new(), Vec::new());
    let pilot = |t: f64, state: &_| {
        let clock = Instant::now();
        if let Some(found) = replanning.replan(t, state)? {
            plans.push((t, clock.elapsed().as_secs_f64()));
            ends.push((t, found.plan.start + found.plan.duration));
        }
        Ok(replanning.speeds(t, horizon.period))
    };
    let (touchdown, moments) = fly(world, &Limits::default(), Landing::initial_state(), horizon.period, pilot)?;
    Ok(Flown { touchdown, moments, plans, ends })
}

fn predictive(world: &Landing, horizon: Horizon) -> Result<Flown, Error> {
    let limits = Limits::default();
    let mut controller = PredictiveController::new(Params::default(), limits, world.deck, horizon, Descent::default())?;
    let (mut memory, mut plans) = (Memory::default(), Vec::new());
    let pilot = |t: f64, state: &_| {
        let clock = Instant::now();
        let speeds = controller.command(&mut memory, t, state);
        plans.push((t, clock.elapsed().as_secs_f64()));
        speeds
    };
    let (touchdown, moments) = fly(world, &limits, Landing::initial_state(), horizon.period, pilot)?;
    Ok(Flown { touchdown, moments, plans, ends: Vec::new() })
}

/// The name of a limit that is looser, and what makes it so.
type Change = (&'static str, fn(&mut Limits));

/// Time of the shortest landing in case I with a limit that is looser than the others: name, time \[s\]; the first one
/// has none.
pub(crate) fn looser() -> Result<Vec<(&'static str, f64)>, Failure> {
    let change: [Change; 6] = [
        ("none", |_| ()),
        ("greatest thrust 2.5 m g", |limits| limits.thrust[1] = 2.5),
        ("least thrust 0", |limits| limits.thrust[0] = 0.0),
        ("sink rate 0.6 m/s", |limits| limits.touchdown.sink_rate = 0.6),
        ("offset 0.3 m", |limits| limits.touchdown.offset = 0.3),
        ("half angle of the cone 45°", |limits| limits.view.half_angle = 45.0_f64.to_radians()),
    ];
    let (_, heave) = mbs_examples::quadrotor_landing::flight::CASES[0];
    let time = |(name, change): Change| {
        let mut limits = Limits::default();
        change(&mut limits);
        let shortest = ShortestLanding { intervals: INTERVALS, ..landing(heave, limits) };
        Ok((name, shortest.plan(Options::default(), &[2.5])?.plan.duration))
    };
    change.into_iter().map(time).collect()
}

/// Moments that are drawn and written: those at which the pilot acts.
pub(crate) fn kept(flown: &Flown) -> impl Iterator<Item = &Moment> {
    flown.moments.iter().step_by(LOOKS)
}
