//! The quadrotor under backstepping with a wrong model, and under adaptive control.

use mbs_examples::Failure;
use mbs_landing::quadrotor::adaptive::{Known, Learning, vehicle_regressor};
use mbs_landing::quadrotor::backstepping::{Backstepping, Reference};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::quadrotor::rotors::{CALM, Rotors, Speeds};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_runtime::control::{AdaptiveControl, RegressorStack, Sliding};

use crate::arm::RANK_TOLERANCE;
use crate::run::{Loop, Run, Sample, Seen, first, simulate};

/// What controllers take for the mass \[kg\] and the principal inertias \[kg·m²\].
const BELIEVED: [f64; 4] = [28.0, 2.0, 2.0, 3.5];
/// Λ of z, roll, pitch, yaw \[1/s\]; times mass and inertias it is the damping.
const CONVERGENCE: [f64; 4] = [2.5, 8.0, 8.0, 4.0];
/// Γ of the mass \[kg²/J\] and of an inertia \[kg²·m⁴/J\].
const ADAPTATION: [f64; 2] = [1.0, 2.0];
/// Of x and y, critically damped \[rad/s\].
const HORIZONTAL_FREQUENCY: f64 = 2.0;
/// Of the filter of the tilt, critically damped \[rad/s\].
const FILTER_FREQUENCY: f64 = 15.0;
/// The least part of g with which thrust is thought to lift where it is to tilt.
const LEAST_LIFT: f64 = 0.3;
/// By how much a landing is flown longer than planned, for those who lag \[s\].
const LAG: f64 = 0.1;
/// How long the eight lasts \[s\].
const EIGHT: f64 = 60.0;

/// What comes of all of it.
pub(crate) struct Study {
    pub(crate) truth: [f64; 4],
    pub(crate) initial: [f64; 4],
    /// The landing of case I, then an eight.
    pub(crate) flights: [Comparison; 2],
}

/// One reference under several controllers.
pub(crate) struct Comparison {
    pub(crate) reference: &'static str,
    pub(crate) duration: f64,
    /// Errors count at the beginning and at the end of a flight for so long \[s\].
    pub(crate) window: f64,
    /// How many of the four numbers the reference shows, and how clearly.
    pub(crate) told: (usize, [f64; 2]),
    pub(crate) wrong: Flight,
    pub(crate) right: Flight,
    pub(crate) adaptive: Flight,
}

/// A run, and how it came down.
pub(crate) struct Flight {
    pub(crate) run: Run,
    /// When the mass centre comes to the deck \[s\], and how fast \[m/s\].
    pub(crate) touchdown: Option<[f64; 2]>,
    /// The part of the samples at which a rotor would have had to turn backwards.
    pub(crate) limited: f64,
}

/// Position and yaw that are to be followed.
type Course<'a> = &'a dyn Fn(f64) -> ([Reference; 3], Reference);

/// Mass and principal inertias of the vehicle.
fn truth() -> [f64; 4] {
    let Params { m, inertias: [x, y, z], .. } = Params::<f64>::default();
    [m, x, y, z]
}

/// All flights.
pub(crate) fn study() -> Result<Study, Failure> {
    let landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let down = |t: f64| (landing.reference(t), Reference::fixed(0.0));
    let approach = landing.approach;
    let planned = approach.duration + approach.last_height / approach.sink_rate;
    let start = Landing::initial_state();
    let deck = |t: f64| landing.reference(t)[2].value - approach.at(t).value;
    let flights = [
        compare("landing_case_I", &down, (planned + LAG, 2.0), [start.q, start.qd], Some(&deck))?,
        compare("eight", &eight, (EIGHT, 10.0), on_the_eight(), None)?,
    ];
    Ok(Study { truth: truth(), initial: BELIEVED, flights })
}

/// An eight with a nodding height and a turning nose: `A sin(2π t/T)` in x, y, z \[m, s\] and in ψ \[rad, s\].
fn eight(t: f64) -> ([Reference; 3], Reference) {
    let wave = |middle: f64, amplitude: f64, period: f64| {
        let w = std::f64::consts::TAU / period;
        let (sin, cos) = (w * t).sin_cos();
        let value = middle + amplitude * sin;
        Reference { value, rate: amplitude * w * cos, acceleration: -amplitude * w * w * sin }
    };
    ([wave(0.0, 3.0, 8.0), wave(0.0, 1.0, 4.0), wave(10.0, 1.0, 5.0)], wave(0.0, 0.3, 3.5))
}

/// Level, at the place and with the velocity that the eight begins with.
fn on_the_eight() -> [[f64; 6]; 2] {
    let ([x, y, z], heading) = eight(0.0);
    let of = |value: fn(&Reference) -> f64| [value(&x), value(&y), value(&z), 0.0, 0.0, value(&heading)];
    [of(|r| r.value), of(|r| r.rate)]
}

fn compare(
    name: &'static str,
    course: Course<'_>,
    (duration, window): (f64, f64),
    start: [[f64; 6]; 2],
    deck: Option<&dyn Fn(f64) -> f64>,
) -> Result<Comparison, Failure> {
    let params = Params::default();
    let plant = QuadrotorEuler::new(params);
    let flown = |rotors: &Rotors, act: Control<'_>, learnt: &[f64]| -> Result<_, Failure> {
        let flown = Flown { course, plant: &plant, rotors, act };
        let run = simulate(&flown, start[0], [&start[1], learnt].concat(), duration)?;
        let limited = run.samples.iter().filter(|s| s.seen.limited).count() as f64 / run.samples.len() as f64;
        let touchdown = deck.and_then(|deck| touchdown(&run, deck));
        Ok(Flight { run, touchdown, limited })
    };
    let backstepping = |params: Params<f64>| {
        let control = Backstepping::new(params);
        flown(&Rotors::new(&params), &|t, q, v| backstepped(&control, course, t, q, v), &[])
    };
    let [m, inertias @ ..] = BELIEVED;
    let damping = std::array::from_fn(|i| if i < 2 { 1.0 } else { CONVERGENCE[i - 2] * BELIEVED[i - 2] });
    let convergence = std::array::from_fn(|i| if i < 2 { 1.0 } else { CONVERGENCE[i - 2] });
    let gains = std::array::from_fn(|k| ADAPTATION[usize::from(k > 0)]);
    let control = AdaptiveControl::new(convergence, damping, gains)?;
    let learning = Learning {
        control,
        rotors: Rotors::new(&params),
        horizontal_frequency: HORIZONTAL_FREQUENCY,
        filter_frequency: FILTER_FREQUENCY,
        least_lift: LEAST_LIFT,
    };
    let [[_, _, _, roll, pitch, _], _] = start;
    let act = |t: f64, q: &[f64; 6], v: &[f64]| adapted(&learning, &plant, course, t, q, v);
    let adaptive = flown(&learning.rotors, &act, &[&BELIEVED[..], &[roll, 0.0, pitch, 0.0, 0.0]].concat())?;
    Ok(Comparison {
        reference: name,
        duration,
        window,
        told: told(&adaptive.run)?,
        wrong: backstepping(Params { m, inertias, ..params })?,
        right: backstepping(params)?,
        adaptive,
    })
}

/// When the mass centre comes to the deck, on a straight line between two samples.
fn touchdown(run: &Run, deck: &dyn Fn(f64) -> f64) -> Option<[f64; 2]> {
    let height = |s: &Sample| s.motion[0][2] - deck(s.t);
    run.samples.windows(2).find(|pair| height(&pair[1]) <= 0.0).map(|pair| {
        let (before, after) = (height(&pair[0]), height(&pair[1]));
        let speed = (after - before) / (pair[1].t - pair[0].t);
        [pair[0].t - before / speed, speed]
    })
}

/// How many of the four numbers a flight shows, looked at ten times a second.
fn told(run: &Run) -> Result<(usize, [f64; 2]), Failure> {
    let mut stack = RegressorStack::default();
    for Sample { motion: [q, qd, qdd], .. } in run.samples.iter().step_by(5) {
        let y = vehicle_regressor(&Sliding { error: [0.0; 6], qd: *qd, qdd: *qdd }, q, qd);
        // Of the rows that adaptive control has.
        stack.add(&[y[2], y[3], y[4], y[5]]);
    }
    let base = stack.base(RANK_TOLERANCE)?;
    Ok((base.rank(), base.gap()))
}

/// What a controller does at a moment.
struct Acted {
    rotors: Speeds,
    /// The rates of what is behind the velocities.
    rates: Vec<f64>,
    estimate: Vec<f64>,
    lyapunov: f64,
    spent: f64,
}

/// Of the time, coordinates and velocities with what is behind them.
type Control<'a> = &'a dyn Fn(f64, &[f64; 6], &[f64]) -> Acted;

/// A vehicle with its controller.
struct Flown<'a> {
    course: Course<'a>,
    plant: &'a QuadrotorEuler<f64>,
    rotors: &'a Rotors,
    act: Control<'a>,
}

impl Loop for Flown<'_> {
    fn rates(&self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]) {
        let (q, qd) = (first(q), first(v));
        let acted = (self.act)(t, &q, v);
        a[..6].copy_from_slice(&self.plant.forward_dynamics(&CALM, &q, &qd, &acted.rotors.speed));
        a[6..].copy_from_slice(&acted.rates);
    }

    fn look(&self, t: f64, q: &[f64], v: &[f64]) -> Seen {
        let q: [f64; 6] = first(q);
        let Acted { rotors: Speeds { speed, limited }, estimate, lyapunov, spent, .. } = (self.act)(t, &q, v);
        let (wanted, _) = (self.course)(t);
        let error = (0..3).map(|i| (q[i] - wanted[i].value).powi(2)).sum::<f64>().sqrt();
        let forces = self.rotors.effort_of(&speed).to_vec();
        Seen { error, forces, limited, estimate, lyapunov, spent }
    }
}

/// Backstepping of the thesis.
fn backstepped(control: &Backstepping, course: Course<'_>, t: f64, q: &[f64; 6], v: &[f64]) -> Acted {
    let (position, heading) = course(t);
    let command = control.command(&position, heading, q, &first(v));
    let rotors = Speeds { speed: command.rotors.speed, limited: command.rotors.saturated };
    Acted { rotors, rates: vec![], estimate: vec![], lyapunov: 0.0, spent: 0.0 }
}

/// Slotine's and Li's; behind the velocities are the estimate, roll and pitch of the filter with their rates, and what
/// V lost.
fn adapted(
    learning: &Learning,
    plant: &QuadrotorEuler<f64>,
    course: Course<'_>,
    t: f64,
    q: &[f64; 6],
    v: &[f64],
) -> Acted {
    let (position, heading) = course(t);
    let known = Known { estimate: first(&v[6..]), tilt: [[v[10], v[11]], [v[12], v[13]]] };
    let acted = learning.act(&position, heading, [q, &first(v)], &known);
    let ([a, b, c, d], [roll, pitch]) = (acted.estimate_rate, acted.tilt_acceleration);
    let control = &learning.control;
    let truth = truth();
    let mistake = std::array::from_fn(|k| known.estimate[k] - truth[k]);
    Acted {
        rotors: acted.rotors,
        rates: vec![a, b, c, d, v[11], roll, v[13], pitch, -control.lyapunov_rate(&acted.error)],
        estimate: known.estimate.to_vec(),
        lyapunov: control.lyapunov(&plant.mass_matrix(&CALM, q), &acted.error, &mistake),
        spent: v[14],
    }
}
