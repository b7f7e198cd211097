//! Derivatives against dual numbers and differences, optima against closed forms, limits in flight.

use std::vec::Vec;

use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_models::{At, Error, Failure};
use mbs_platform::geometry::attitude;
use mbs_runtime::control::discrete_lqr;
use mbs_runtime::{Dual, Scalar, to_matrix};
use nalgebra::{Matrix1, Matrix2, SMatrix, Vector1, Vector2, Vector3};

use super::controller::{Descent, Horizon, Memory, PredictiveController};
use super::flight::{Replanning, fly};
use super::limits::{Limits, Sight};
use super::problem::{Condition, Cost, FreeEnd, OptimalControl, Plan, Step};
use super::sequential::{Options, Sequential};
use super::shortest::ShortestLanding;
use super::step::{InputVector, Prediction, ROTORS, STATES, StateVector};
use crate::quadrotor::deck::HeavingDeck;
use crate::quadrotor::gear::Gear;
use crate::quadrotor::heave::Heave;
use crate::quadrotor::landing::{Landing, Plant};

const X: [f64; 12] = [11.0, 7.5, 4.0, 0.3, -0.2, 0.4, 1.0, -2.0, -3.0, 0.5, -0.7, 0.3];
const U: [f64; 4] = [1.1, 0.7, 0.9, 1.3];

fn deck() -> HeavingDeck<4> {
    HeavingDeck { heave: Heave::CASE_I, place: [12.0, 7.0] }
}

/// The classical method typed once more, for any numbers, by accelerations alone.
fn rk4<T: Scalar>(vehicle: &QuadrotorEuler<T>, x: [T; 12], speeds: [T; 4], felt: [f64; 3], h: T) -> [T; 12] {
    let f = |x: [T; 12]| {
        let (q, qd) = (core::array::from_fn(|i| x[i]), core::array::from_fn(|i| x[6 + i]));
        let qdd = vehicle.forward_dynamics(&[[T::zero(); 3]; 3], &q, &qd, &speeds);
        core::array::from_fn::<T, 12, _>(|i| match i {
            0..6 => qd[i],
            6..9 => qdd[i - 6] + T::from_f64(felt[i - 6]),
            _ => qdd[i - 6],
        })
    };
    let ahead = |k: &[T; 12], part: f64| core::array::from_fn(|i| x[i] + T::from_f64(part) * h * k[i]);
    let k1 = f(x);
    let k2 = f(ahead(&k1, 0.5));
    let k3 = f(ahead(&k2, 0.5));
    let k4 = f(ahead(&k3, 1.0));
    let two = T::from_f64(2.0);
    core::array::from_fn(|i| x[i] + h / T::from_f64(6.0) * (k1[i] + two * k2[i] + two * k3[i] + k4[i]))
}

#[test]
fn derivatives_of_a_step_are_those_of_dual_numbers() {
    let felt = [0.3, -0.2, 0.5];
    for steps in [1, 3] {
        let prediction = Prediction { disturbance: felt, steps, ..Prediction::new(Params::default()) };
        let (unit, length) = (prediction.hover_speed(), 0.12);
        let step = prediction.step(&StateVector::from(X), &InputVector::from(U), length);
        let vehicle = QuadrotorEuler::<Dual<f64>>::new(Params::default());
        for direction in 0..17 {
            let number = |value: f64, i: usize| Dual { value, derivative: f64::from(u8::from(i == direction)) };
            let mut x: [Dual<f64>; 12] = core::array::from_fn(|i| number(X[i], i));
            let speeds = core::array::from_fn(|i| Dual::constant(unit) * number(U[i], 12 + i));
            for _ in 0..steps {
                x = rk4(&vehicle, x, speeds, felt, number(length, 16) / Dual::constant(steps as f64));
            }
            for (i, x) in x.iter().enumerate() {
                let found = match direction {
                    0..12 => step.by_state[(i, direction)],
                    12..16 => step.by_input[(i, direction - 12)],
                    _ => step.by_length[i],
                };
                assert!((step.end[i] - x.value).abs() < 1e-12);
                assert!((found - x.derivative).abs() < 1e-11 * (1.0 + found.abs()), "{direction} {i}: {found} {x:?}");
            }
        }
    }
}

/// Upright without drag: `z + v h + ½ a h²`, `a = g (Σ u²/4 − 1)`.
#[test]
fn a_step_straight_up_is_that_of_constant_acceleration() {
    let prediction = Prediction::new(Params { drag_coefficient: 0.0, ..Params::default() });
    let (g, h, v, u) = (9.80665, 0.3, 2.0, 1.2);
    let mut x = StateVector::zeros();
    x[8] = v;
    let step = prediction.step(&x, &InputVector::repeat(u), h);
    let a = g * (u * u - 1.0);
    let close = |found: f64, is: f64| assert!((found - is).abs() < 1e-12, "{found} {is}");
    close(step.end[2], v * h + 0.5 * a * h * h);
    close(step.by_state[(2, 8)], h);
    close(step.by_input[(2, 1)], 0.5 * h * h * g * u / 2.0);
    close(step.by_input[(8, 3)], h * g * u / 2.0);
    close(step.by_length[2], v + a * h);
    close(step.by_length[8], a);
}

#[test]
fn derivatives_of_conditions_are_their_differences() {
    let (vehicle, limits, deck) = (QuadrotorEuler::default(), Limits::default(), deck());
    let rows = |t: f64, x: &StateVector| {
        let sight = Sight::new(&vehicle, &limits, &deck, t, x);
        let mut rows = std::vec![sight.tilt(), sight.visibility(), sight.height(), sight.sink_rate(1.3)];
        sight.touchdown(&mut rows);
        rows
    };
    let (t, x, step) = (0.7, StateVector::from(X), 1e-5);
    for (k, row) in rows(t, &x).iter().enumerate() {
        let close = |found: f64, after: f64, before: f64| {
            let is = (after - before) / (2.0 * step);
            assert!((found - is).abs() < 1e-6 * (1.0 + is.abs()), "{}: {found} {is}", row.name);
        };
        close(row.by_time, rows(t + step, &x)[k].value, rows(t - step, &x)[k].value);
        for i in 0..STATES {
            let moved = |by: f64| {
                let mut x = x;
                x[i] += by;
                rows(t, &x)[k].value
            };
            close(row.by_state[i], moved(step), moved(-step));
        }
    }
}

#[test]
fn a_mark_on_the_edge_of_the_cone_is_seen_by_nothing() {
    let limits = Limits::default();
    // 3 m over the deck, level: the edge of the mark is on that of the cone.
    let aside = 3.0 * 30.0_f64.to_radians().tan() + 0.5;
    let at_rest = HeavingDeck { heave: Heave { amplitude: [0.0; 4], frequency: [1.0; 4] }, place: [0.0; 2] };
    let mut x = StateVector::zeros();
    (x[1], x[2]) = (aside, 3.0);
    let vehicle = QuadrotorEuler::default();
    let level = Sight::new(&vehicle, &limits, &at_rest, 0.0, &x).visibility().value;
    assert!(level.abs() < 1e-4, "{level}");
    // Rolled towards the mark, which lies to the right, the camera looks away from it.
    x[3] = 0.1;
    assert!(Sight::new(&vehicle, &limits, &at_rest, 0.0, &x).visibility().value.abs() > 0.2);
}

/// `ḧ = u` between bounds, down to h = 0 as fast as can be, where it is to sink with 0.3 m/s at most.
struct Falling {
    intervals: usize,
    bounds: [f64; 2],
}

const SINK: f64 = 0.3;

impl OptimalControl<2, 1> for Falling {
    fn intervals(&self) -> usize {
        self.intervals
    }

    fn start(&self) -> f64 {
        0.0
    }

    fn initial_state(&self) -> Vector2<f64> {
        Vector2::new(10.0, 0.0)
    }

    fn step(&self, x: &Vector2<f64>, u: &Vector1<f64>, h: f64) -> Step<2, 1> {
        Step {
            end: Vector2::new(x[0] + h * x[1] + 0.5 * h * h * u[0], x[1] + h * u[0]),
            by_state: Matrix2::new(1.0, h, 0.0, 1.0),
            by_input: Vector2::new(0.5 * h * h, h),
            by_length: Vector2::new(x[1] + h * u[0], u[0]),
        }
    }

    fn bounds(&self, _node: usize) -> [Vector1<f64>; 2] {
        self.bounds.map(Vector1::new)
    }

    fn free_end(&self) -> Option<FreeEnd> {
        Some(FreeEnd { range: [0.1, 20.0], weight: 1.0 })
    }

    fn cost(&self, _node: usize, _t: f64) -> Cost<2, 1> {
        let input = Matrix1::new(1e-8);
        Cost { state: Matrix2::zeros(), target: Vector2::zeros(), input, input_target: Vector1::zeros() }
    }

    fn conditions(&self, node: usize, _t: f64, x: &Vector2<f64>, rows: &mut Vec<Condition<2>>) {
        let row = |name, value, by_state| Condition { name, value, by_state, by_time: 0.0 };
        if node == self.intervals {
            rows.push(row("contact", -x[0], Vector2::new(-1.0, 0.0)));
            rows.push(row("sink rate", x[1] + SINK, Vector2::new(0.0, 1.0)));
        } else {
            rows.push(row("height", x[0], Vector2::new(1.0, 0.0)));
        }
    }
}

/// From rest down with a, then up with b to the speed v₀: `h = v²/2a + (v² − v₀²)/2b`, `T = v/a + (v − v₀)/b`.
#[test]
fn the_shortest_fall_switches_once() {
    let (a, b) = (9.0, 12.0);
    let speed = ((10.0 + SINK * SINK / (2.0 * b)) / (0.5 / a + 0.5 / b)).sqrt();
    let shortest = speed / a + (speed - SINK) / b;
    let mut before = f64::INFINITY;
    for intervals in [10, 20, 40] {
        let falling = Falling { intervals, bounds: [-a, b] };
        let nodes = 0..=intervals;
        let states = nodes.map(|node| Vector2::new(10.0 * (1.0 - node as f64 / intervals as f64), -3.0)).collect();
        let guess = Plan { start: 0.0, duration: 3.0, states, inputs: std::vec![Vector1::zeros(); intervals] };
        let found = Sequential::new(Options { tolerance: 1e-6, ..Options::default() }).solve(&falling, guess).unwrap();
        let late = found.plan.duration - shortest;
        // An input that is held over the switch costs (a + b) l²/8 of height at most, passed at the greatest speed; of
        // grids that are parts of each other the finer one is not worse.
        let held = found.plan.duration / intervals as f64;
        assert!(late > -1e-6 && late < (a + b) * held * held / (8.0 * speed) && late < before + 1e-6, "{late}");
        assert!(found.residual.greatest() < 1e-6);
        let switched = found.plan.inputs.iter().filter(|u| (u[0] + a).abs() > 1e-2 && (u[0] - b).abs() > 1e-2).count();
        assert!(switched <= 1, "{:?}", found.plan.inputs);
        before = late;
    }
}

/// A linear system with a cost whose part after the horizon is that of the regulator.
struct Regulated {
    a: Matrix2<f64>,
    b: Vector2<f64>,
    last: Matrix2<f64>,
}

impl OptimalControl<2, 1> for Regulated {
    fn intervals(&self) -> usize {
        8
    }

    fn start(&self) -> f64 {
        0.0
    }

    fn initial_state(&self) -> Vector2<f64> {
        Vector2::new(0.7, -0.4)
    }

    fn step(&self, x: &Vector2<f64>, u: &Vector1<f64>, _h: f64) -> Step<2, 1> {
        Step { end: self.a * x + self.b * u, by_state: self.a, by_input: self.b, by_length: Vector2::zeros() }
    }

    fn bounds(&self, _node: usize) -> [Vector1<f64>; 2] {
        [-100.0, 100.0].map(Vector1::new)
    }

    fn free_end(&self) -> Option<FreeEnd> {
        None
    }

    fn cost(&self, node: usize, _t: f64) -> Cost<2, 1> {
        let state = if node == 8 { self.last } else { Matrix2::new(2.0, 0.0, 0.0, 1.0) };
        Cost { state, target: Vector2::zeros(), input: Matrix1::new(0.5), input_target: Vector1::zeros() }
    }

    fn conditions(&self, _node: usize, _t: f64, _x: &Vector2<f64>, _rows: &mut Vec<Condition<2>>) {}
}

#[test]
fn without_limits_it_is_the_linear_quadratic_regulator() {
    let (a, b) = ([[1.1, 0.2], [-0.1, 0.9]], [[0.1], [0.3]]);
    let regulator = discrete_lqr(&a, &b, &[[2.0, 0.0], [0.0, 1.0]], &[[0.5]]).unwrap();
    let problem = Regulated { a: to_matrix(&a), b: to_matrix(&b), last: to_matrix(&regulator.cost) };
    let options = Options { damping: 0.0, accuracy: 1e-12, ..Options::default() };
    let guess = Plan {
        start: 0.0,
        duration: 1.0,
        states: std::vec![Vector2::zeros(); 9],
        inputs: std::vec![Vector1::zeros(); 8],
    };
    let mut plan = guess;
    Sequential::new(options).iterate(&problem, &mut plan).unwrap();
    let gain: SMatrix<f64, 1, 2> = to_matrix(&regulator.gain);
    for (x, u) in plan.states.iter().zip(&plan.inputs) {
        assert!((u + gain * x).norm() < 1e-8, "{u} {x}");
    }
}

fn shortest(limits: Limits) -> ShortestLanding {
    let prediction = Prediction::new(Params::default());
    ShortestLanding { intervals: 20, ..ShortestLanding::new(prediction, limits, deck(), &Landing::initial_state()) }
}

#[test]
fn looser_limits_never_lengthen_the_landing() {
    let time = |limits: Limits| shortest(limits).plan(Options::default(), &[2.5]).unwrap().plan.duration;
    let strict = Limits::default();
    let with = |change: fn(&mut Limits)| {
        let mut limits = strict;
        change(&mut limits);
        time(limits)
    };
    let bound = time(strict);
    for (name, looser) in [
        ("thrust", with(|limits| limits.thrust = [0.05, 2.5])),
        ("least thrust", with(|limits| limits.thrust = [0.02, 2.2])),
        ("sink rate", with(|limits| limits.touchdown.sink_rate = 0.8)),
        ("tilt", with(|limits| limits.tilt = 0.6)),
        ("visibility", with(|limits| limits.view.half_angle = 0.8)),
    ] {
        assert!(looser < bound + 1e-5, "{name}: {looser} {bound}");
    }
    assert!(with(|limits| limits.thrust = [0.05, 2.5]) < bound - 0.02);
    assert!(with(|limits| limits.touchdown.sink_rate = 0.8) < bound - 0.01);
}

#[test]
fn what_cannot_be_is_told_by_what_it_breaks() {
    let landing = ShortestLanding { duration: [0.02, 1.0], ..shortest(Limits::default()) };
    match landing.plan(Options::default(), &[1.0]) {
        Err(Error { failure: Failure::Infeasible { limit, excess }, at: Some(At::Time(time)) }) => {
            assert!(limit == "sink rate" || limit == "contact", "{limit}");
            assert!(time > 0.5 && excess > 0.1, "{time} {excess}");
        }
        other => panic!("{other:?}"),
    }
    let mut limits = Limits::default();
    limits.touchdown.sink_rate = f64::NAN;
    let error = shortest(limits).plan(Options::default(), &[1.0]).unwrap_err();
    assert_eq!(std::format!("{error}"), "touchdown.sink_rate must be positive and finite, it is NaN");
    assert!(shortest(Limits::default()).plan(Options::default(), &[]).is_err());
    let lost = ShortestLanding { initial: StateVector::repeat(f64::NAN), ..shortest(Limits::default()) };
    assert!(lost.plan(Options::default(), &[1.0]).unwrap_err().invalid().is_some());
}

/// By small steps of Euler's method.
#[test]
fn a_descent_is_that_of_its_rate() {
    let descent = Descent::default();
    for start in [9.0, 3.0, 0.4, -0.1] {
        let (mut height, step) = (start, 1e-5);
        for i in 0..600_000 {
            if i % 100_000 == 0 {
                let [found, rate] = descent.after(start, f64::from(i) * step);
                assert!((found - height).abs() < 1e-4, "{start} {i}: {found} {height}");
                assert!((rate + descent.speed.min(descent.touchdown + descent.slowing * height.max(0.0))).abs() < 1e-3);
            }
            height -= step * descent.speed.min(descent.touchdown + descent.slowing * height.max(0.0));
        }
    }
}

fn windy() -> Landing {
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    landing.wind = [3.0, -2.0, 0.0];
    landing.vehicle = QuadrotorEuler::new(Params { m: 41.2, ..Params::default() });
    landing
}

#[test]
fn predictive_control_lands_within_its_limits() {
    let (limits, deck) = (Limits::default(), deck());
    let (horizon, descent) = (Horizon { period: 0.02, ..Horizon::default() }, Descent::default());
    let mut controller = PredictiveController::new(Params::default(), limits, deck, horizon, descent).unwrap();
    let mut memory = Memory::default();
    let pilot = |t: f64, state: &_| controller.command(&mut memory, t, state);
    let (touchdown, moments) = fly(&windy(), &limits, Landing::initial_state(), horizon.period, pilot).unwrap();
    assert!(touchdown.relative_velocity > -limits.touchdown.sink_rate, "{}", touchdown.relative_velocity);
    assert!(touchdown.horizontal_offset < 0.01, "{}", touchdown.horizontal_offset);
    assert!(moments.iter().all(|moment| moment.tilt < limits.tilt && moment.visibility > 0.0));
    let [least, greatest] = limits.inputs().map(|u| u[0] * Prediction::new(Params::default()).hover_speed());
    let kept = |speed: &f64| (least - 1e-9..=greatest + 1e-9).contains(speed);
    assert!(moments.iter().all(|moment| moment.speeds.iter().all(kept)));
}

#[test]
fn a_landing_that_is_planned_anew_ends_softly_in_wind() {
    let mut landing = shortest(Limits::default());
    (landing.reserve, landing.limits.touchdown.sink_rate, landing.limits.touchdown.offset) = (0.2, 0.2, 0.05);
    let first = landing.plan(Options::default(), &[2.5]).unwrap().plan;
    let mut plans = 0;
    let mut replanning = Replanning::new(landing, first, 0.05, 3);
    let pilot = |t: f64, state: &_| {
        plans += usize::from(replanning.replan(t, state)?.is_some());
        Ok(replanning.speeds(t, 0.01))
    };
    let limits = Limits::default();
    let (touchdown, moments) = fly(&windy(), &limits, Landing::initial_state(), 0.01, pilot).unwrap();
    assert!(touchdown.time < 2.2 && plans > 20, "{} {plans}", touchdown.time);
    assert!(touchdown.relative_velocity > -limits.touchdown.sink_rate, "{}", touchdown.relative_velocity);
    assert!(touchdown.horizontal_offset < limits.touchdown.offset, "{}", touchdown.horizontal_offset);
    assert!(moments.iter().all(|moment| moment.tilt < limits.tilt && moment.visibility > 0.0));
}

/// Its rotors stand: it falls, tilted as it is, until a foot of its legs meets the deck.
#[test]
fn a_flight_with_legs_ends_with_the_first_foot() {
    let gear = Gear::default();
    let landing = Landing { gear: Some(gear), ..windy() };
    let still = |_: f64, _: &_| Ok([0.0; ROTORS]);
    let (touchdown, _) = fly(&landing, &Limits::default(), Landing::initial_state(), 0.01, still).unwrap();
    let [x, y, z, ..] = touchdown.state.q;
    let turned = to_matrix(&attitude(&touchdown.state.q));
    let height = |foot| touchdown.deck.height(&(Vector3::new(x, y, z) + turned * Vector3::from(foot)).into());
    let lowest = gear.feet().map(height).into_iter().fold(f64::INFINITY, f64::min);
    assert!(lowest.abs() < 1e-9, "{lowest}");
}

#[test]
fn no_state_is_no_command() {
    let (horizon, descent) = (Horizon::default(), Descent::default());
    let new =
        |horizon, descent| PredictiveController::new(Params::default(), Limits::default(), deck(), horizon, descent);
    let mut controller = new(horizon, descent).unwrap();
    let mut lost = Landing::initial_state();
    lost.qd[4] = f64::NAN;
    let found = controller.command(&mut Memory::default(), 0.0, &lost);
    assert!(found.unwrap_err().invalid().is_some());
    assert!(new(Horizon { intervals: 0, ..horizon }, descent).is_err());
    assert!(new(horizon, Descent { limit: 0.1, ..descent }).is_err());
    let heavy = Params { m: f64::INFINITY, ..Params::default() };
    assert!(PredictiveController::new(heavy, Limits::default(), deck(), horizon, descent).is_err());
}
