//! Landings on decks, in winds and by vehicles that are turned over, infinite or NaN: each is refused by name, or is
//! what it should be.

use std::f64::consts::{FRAC_PI_2, PI};

use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::{Deck, DeckState, HeavingDeck, MovingDeck};
use mbs_landing::quadrotor::driven::{Drive, SIDE, TrackingError};
use mbs_landing::quadrotor::ground_effect::GroundEffect;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Controller, HEIGHT, LEVEL, Landing, MOST_MOMENTS, Plant};
use mbs_landing::quadrotor::lqr::{Lqr, Weights};
use mbs_landing::quadrotor::touchdown::LEAVING;
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::check::Must;
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_models::{At, Error, Failure};
use mbs_platform::{HOME, Motion, NOT_FINITE, Platform, Superposition};
use mbs_runtime::State;
use mbs_runtime::control::ComputedTorque;

const PERIOD: f64 = 0.002;

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

fn case_i() -> Landing {
    Landing::new(Plant::Exact, Heave::CASE_I)
}

fn regulated() -> Landing {
    let mut landing = case_i();
    let lqr = Lqr::new(*landing.vehicle.params(), &Weights::default()).expect("a regulator");
    landing.controller = Controller::Lqr(lqr);
    landing
}

/// On a platform over a base in the place of the cases, which moves about home.
fn on<M>(motion: M) -> Landing<MovingDeck<M>> {
    Landing::on(Plant::Exact, MovingDeck { motion, base: [12.0, 7.0, -HOME[2]], point: [0.0; 3] })
}

/// About home, each coordinate by a sine of half a radian per second.
fn swing(sine: [f64; 6]) -> Motion {
    Motion { mean: HOME, sine, cosine: [0.0; 6], frequency: [0.5; 6] }
}

fn drive() -> Drive {
    let platform = Platform::default().with_payload(0.0).expect("a platform");
    Drive { platform, control: ComputedTorque::critically_damped(8.0).expect("a gain") }
}

/// What both simulations on a deck that moves exactly end with.
fn both<D: Deck>(landing: &Landing<D>, start: State<[f64; 6]>) -> [Result<Touchdown, Error>; 2] {
    [landing.simulate(start, |_, _, _| ()), landing.simulate_sampled(start, PERIOD, |_, state| *state)]
}

#[track_caller]
fn refused<D: Deck>(landing: &Landing<D>, start: State<[f64; 6]>, expected: impl Fn(&Error) -> bool) {
    for end in both(landing, start) {
        assert!(end.as_ref().is_err_and(&expected), "{end:?}");
    }
}

/// Whether a number of this name, with its index, was refused for this.
fn is_invalid(error: &Error, name: &str, must: &str) -> bool {
    error.invalid().is_some_and(|wrong| wrong.to_string().starts_with(&format!("{name} {must}")))
}

#[test]
fn numbers_that_are_none_are_told_by_name() {
    type Damage = fn(&mut Landing, f64);
    let finite: [(&str, Damage); 9] = [
        ("rotor_inertia", |landing, x| damaged(landing, |params| params.rotor_inertia = x)),
        ("drag_coefficient", |landing, x| damaged(landing, |params| params.drag_coefficient = x)),
        ("area", |landing, x| damaged(landing, |params| params.area = x)),
        ("air_density", |landing, x| damaged(landing, |params| params.air_density = x)),
        ("approach.height", |landing, x| landing.approach.height = x),
        ("approach.last_height", |landing, x| landing.approach.last_height = x),
        ("wind[0]", |landing, x| landing.wind[0] = x),
        ("wind[1]", |landing, x| landing.wind[1] = x),
        ("wind[2]", |landing, x| landing.wind[2] = x),
    ];
    for (name, damage) in finite {
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut landing = case_i();
            damage(&mut landing, x);
            let is_named = |e: &Error| is_invalid(e, name, "must be finite");
            refused(&landing, Landing::initial_state(), is_named);
        }
    }
    let positive: [(&str, Damage); 11] = [
        ("m", |landing, x| damaged(landing, |params| params.m = x)),
        ("g", |landing, x| damaged(landing, |params| params.g = x)),
        ("inertias[1]", |landing, x| damaged(landing, |params| params.inertias[1] = x)),
        ("arm", |landing, x| damaged(landing, |params| params.arm = x)),
        ("thrust_factor", |landing, x| damaged(landing, |params| params.thrust_factor = x)),
        ("drag_factor", |landing, x| damaged(landing, |params| params.drag_factor = x)),
        ("approach.duration", |landing, x| landing.approach.duration = x),
        ("t_end", |landing, x| landing.t_end = x),
        ("controller.params.m", |landing, x| controlled(landing, |c| c.params.m = x)),
        ("controller.mixer.arm", |landing, x| controlled(landing, |c| c.mixer.arm = x)),
        ("controller.yaw.k2", |landing, x| controlled(landing, |c| c.yaw.k2 = x)),
    ];
    for (name, damage) in positive {
        for x in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let mut landing = case_i();
            damage(&mut landing, x);
            let is_named = |e: &Error| is_invalid(e, name, "must be positive");
            refused(&landing, Landing::initial_state(), is_named);
        }
    }
    let bounded: [(&str, Damage); 6] = [
        ("touchdown_height", |landing, x| landing.touchdown_height = x),
        ("approach.sink_rate", |landing, x| landing.approach.sink_rate = x),
        ("controller.thrust_range[0]", |landing, x| controlled(landing, |c| c.thrust_range[0] = x)),
        ("controller.thrust_range[1]", |landing, x| controlled(landing, |c| c.thrust_range[1] = x)),
        ("controller.greatest_tilt", |landing, x| controlled(landing, |c| c.greatest_tilt = x)),
        ("controller.mixer.greatest_speed", |landing, x| controlled(landing, |c| c.mixer.greatest_speed = x)),
    ];
    for (name, damage) in bounded {
        for x in [-1.0, f64::NAN] {
            let mut landing = case_i();
            damage(&mut landing, x);
            let is_named = |e: &Error| is_invalid(e, name, "must be between");
            refused(&landing, Landing::initial_state(), is_named);
        }
    }
    let mut landing = regulated();
    if let Controller::Lqr(regulator) = &mut landing.controller {
        regulator.gain[(2, 5)] = f64::NAN;
    }
    let named = |e: &Error| is_invalid(e, "controller.gain", "must be finite");
    refused(&landing, Landing::initial_state(), named);
}

fn damaged(landing: &mut Landing, damage: impl FnOnce(&mut Params<f64>)) {
    let mut params = *landing.vehicle.params();
    damage(&mut params);
    landing.vehicle = QuadrotorEuler::new(params);
}

fn controlled(landing: &mut Landing, damage: impl FnOnce(&mut mbs_landing::quadrotor::backstepping::Backstepping)) {
    match &mut landing.controller {
        Controller::Backstepping(controller) => damage(controller),
        Controller::Lqr(_) => panic!("a regulator"),
    }
}

#[test]
fn states_that_are_none_are_told_by_name() {
    const NAMES: [[&str; 6]; 2] =
        [["q[0]", "q[1]", "q[2]", "q[3]", "q[4]", "q[5]"], ["qd[0]", "qd[1]", "qd[2]", "qd[3]", "qd[4]", "qd[5]"]];
    for i in 0..12 {
        let mut start = Landing::initial_state();
        if i < 6 {
            start.q[i] = f64::NAN
        } else {
            start.qd[i - 6] = f64::INFINITY
        }
        let name = NAMES[i / 6][i % 6];
        refused(&case_i(), start, |e| is_invalid(e, name, "must be finite"));
        let driven = on(Superposition::MARINE).simulate_driven(start, &drive(), PERIOD, |_| ());
        assert!(driven.as_ref().is_err_and(|e| is_invalid(e, name, "must be finite")), "{driven:?}");
    }
}

/// More moments than can be looked at are refused at once, not counted.
#[test]
fn endless_landings_are_refused() {
    let start = Landing::initial_state();
    let mut landing = case_i();
    let refused = landing.simulate_sampled(start, 1e-300, |_, state| *state);
    let too_many =
        |moments| Err(Must::BeAtMost(f64::from(MOST_MOMENTS)).broken_by("number of moments", moments).into());
    assert_eq!(refused, too_many(60.0 / 1e-300));
    let refused = on(Superposition::MARINE).simulate_driven(start, &drive(), 1e-9, |_| ());
    assert!(refused.is_err_and(|error| is_invalid(&error, "number of moments", "must be at most")));
    landing.t_end = f64::MAX;
    assert_eq!(landing.simulate(start, |_, _, _| ()), too_many(f64::MAX / PERIOD));
    landing.t_end = PERIOD * f64::from(MOST_MOMENTS);
    assert!(landing.simulate(start, |_, _, _| ()).is_ok());
}

#[test]
fn decks_above_the_vehicle_and_decks_turned_over_are_refused() {
    let start = Landing::initial_state();
    let above = Superposition::heave(HOME[2] + 10.5, &[0.1], &[1.0]);
    let named = |e: &Error, name: &str| e.invalid().filter(|wrong| wrong.parameter == name).map(|wrong| wrong.value);
    let is_above = |e: &Error| named(e, HEIGHT).is_some_and(|height| (height + 0.5).abs() < 1e-12);
    refused(&on(above), start, is_above);
    let driven = on(above).simulate_driven(start, &drive(), PERIOD, |_| ());
    assert!(driven.as_ref().is_err_and(is_above), "{driven:?}");
    // On its edge and upside down, from the beginning.
    for (angles, expected) in [([0.0, FRAC_PI_2, 0.0], 0.0), ([PI, 0.0, 0.0], -1.0), ([2.0, 0.0, 0.0], 2.0_f64.cos())] {
        let turned = Motion { mean: [0.0, 0.0, HOME[2], angles[0], angles[1], angles[2]], ..swing([0.0; 6]) };
        let is_turned = |e: &Error| {
            let upward = named(e, "upward component of the deck's normal");
            e.at == Some(At::Time(0.0)) && upward.is_some_and(|upward| (upward - expected).abs() < 1e-15)
        };
        refused(&on(turned), start, is_turned);
    }
    // On the way: the plane of the deck comes up to the vehicle.
    for sine in [[0.0, 0.0, 0.0, 1.8, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.8, 0.0]] {
        let is_turned = |e: &Error| {
            matches!(e.at, Some(At::Time(time)) if time > 2.0)
                && named(e, "upward component of the deck's normal").is_some()
        };
        refused(&on(swing(sine)), start, is_turned);
    }
}

/// A state of a deck that is broken in a time.
struct Broken {
    damage: fn(&mut DeckState),
    times: [f64; 2],
}

impl Deck for Broken {
    fn at(&self, t: f64) -> DeckState {
        let mut state = HeavingDeck { heave: Heave::CASE_I, place: [12.0, 7.0] }.at(t);
        let [from, to] = self.times;
        if from < t && t < to {
            (self.damage)(&mut state);
        }
        state
    }
}

/// Whatever of a deck is NaN, however briefly, is reported with its time under either controller.
#[test]
fn decks_that_are_lost_for_a_while_are_told_of() {
    let start = Landing::initial_state();
    let damages: [fn(&mut DeckState); 6] = [
        |deck| deck.position[0] = f64::NAN,
        |deck| deck.velocity[1] = f64::NAN,
        |deck| deck.acceleration[2] = f64::NAN,
        |deck| deck.rotation[0][1] = f64::NAN,
        |deck| deck.angular_velocity[2] = f64::INFINITY,
        |deck| deck.heading.value = f64::NAN,
    ];
    for damage in damages {
        for controller in [case_i().controller, regulated().controller] {
            let mut landing = Landing::on(Plant::Exact, Broken { damage, times: [2.0, 2.5] });
            landing.controller = controller;
            refused(&landing, start, |e| {
                e.failure == Failure::NotFinite("the deck")
                    && matches!(e.at, Some(At::Time(time)) if time > 2.0 && time < 2.01)
            });
        }
    }
}

/// Of a state whose angles are turned by whole turns nothing is another, and a vehicle rights itself.
#[test]
fn vehicles_upside_down_right_themselves() {
    let start = Landing::initial_state();
    let turned = |turns: [f64; 3]| {
        let mut turned = start;
        (0..3).for_each(|i| turned.q[3 + i] += 2.0 * PI * turns[i]);
        turned
    };
    for landing in [case_i(), regulated()] {
        let expected = landing.simulate(start, |_, _, _| ()).expect("a touchdown");
        for turns in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-2.0, 1.0, 1.0]] {
            let end = landing.simulate(turned(turns), |_, _, _| ()).expect("a touchdown");
            close(end.time, expected.time, 1e-7);
            close(end.horizontal_offset, expected.horizontal_offset, 1e-7);
            (0..2).for_each(|i| close(end.greatest_tilt[i], expected.greatest_tilt[i], 1e-6));
            close(end.settling_time, expected.settling_time, 1e-9);
        }
    }
    for roll in [FRAC_PI_2, 2.0, PI, -3.0, 4.0] {
        let mut over = start;
        over.q[3] = roll;
        for end in both(&case_i(), over) {
            let end = end.expect("a touchdown");
            close(end.relative_velocity, -0.2, 1e-3);
            assert!(end.relative.attitude.iter().all(|angle| angle.abs() < 1e-4), "{end:?}");
            close(end.greatest_tilt[0], roll.abs().min(2.0 * PI - roll.abs()), 0.05);
        }
    }
    // Where the angles do not tell the attitude.
    for pitch in [FRAC_PI_2, -FRAC_PI_2, 1.6, PI] {
        let mut over = start;
        over.q[4] = pitch;
        let is_steep =
            |e: &Error| e.at == Some(At::Time(0.0)) && e.invalid().is_some_and(|wrong| wrong.parameter == LEVEL);
        assert!(both(&case_i(), over).iter().all(|end| end.as_ref().is_err_and(is_steep)), "{pitch}");
        let driven = on(Superposition::MARINE).simulate_driven(over, &drive(), PERIOD, |_| ());
        assert!(driven.as_ref().is_err_and(is_steep), "{driven:?}");
    }
    let mut spinning = start;
    spinning.qd[4] = 60.0;
    refused(&case_i(), spinning, |e| {
        matches!(e.at, Some(At::Time(time)) if time > 0.0 && time < 0.1)
            && e.invalid().is_some_and(|wrong| wrong.parameter == LEVEL)
    });
}

/// What a period does not resolve is not taken for a landing.
#[test]
fn motions_that_are_not_resolved_are_no_landings() {
    let start = Landing::initial_state();
    let coarse = case_i().simulate_sampled(start, 5.0, |_, state| *state);
    let leaves = |e: &Error| e.invalid().is_some_and(|wrong| wrong.parameter == LEAVING && wrong.value > 1.0);
    assert!(coarse.as_ref().is_err_and(leaves), "{coarse:?}");
    // A deck that says that it sinks, and rises.
    let unlike = Broken { damage: |deck| deck.velocity[2] -= 3.0, times: [-1.0, f64::INFINITY] };
    let mut landing = Landing::on(Plant::Exact, unlike);
    landing.controller = case_i().controller;
    refused(&landing, start, leaves);
    // Huge winds, and heaves faster than anything: NaN, or what such a deck does.
    let mut windy = case_i();
    windy.wind[0] = 1e200;
    refused(&windy, start, |e| matches!(e.failure, Failure::Integration(_)));
    let rising = Landing::new(Plant::Exact, Heave { amplitude: [1e3; 4], frequency: [1.0; 4] });
    let hit = rising.simulate(start, |_, _, _| ()).expect("a touchdown");
    // 10 m at 4000 m/s.
    close(hit.time, 0.0025, 1e-5);
    close(hit.relative_velocity, -4000.0, 1.0);
    let frantic = Landing::new(Plant::Exact, Heave { amplitude: [1.0; 4], frequency: [1e300; 4] });
    refused(&frantic, start, |e| *e == Failure::NotFinite("the deck").at_time(0.0));
}

#[test]
fn ground_effect_is_bounded_by_its_least_height() {
    let start = Landing::initial_state();
    let still = Landing::new(Plant::Exact, Heave { amplitude: [0.0; 4], frequency: [1.0; 4] });
    let with = |effect: GroundEffect| {
        let mut landing = still.clone();
        landing.ground_effect = Some(effect);
        landing.simulate(start, |_, _, _| ())
    };
    let without = still.simulate(start, |_, _, _| ()).expect("a touchdown");
    let small = with(GroundEffect::new(1e-300).expect("rotors")).expect("a touchdown");
    close(small.time, without.time, 1e-7);
    // With the least height above all heights thrust is 4/3 of what the controller, which cannot see it, asks for. It
    // sinks above its way by e, where `4/3 (g − (1 + k₁ k₂) e)` is the weight.
    let huge = with(GroundEffect::new(1e300).expect("rotors")).expect("a touchdown");
    let Controller::Backstepping(controller) = still.controller else { panic!("backstepping") };
    let stiffness = 1.0 + controller.vertical.k1 * controller.vertical.k2;
    let above = still.vehicle.params().g / 4.0 / stiffness;
    close(huge.time - without.time, above / still.approach.sink_rate, 1e-3);
    // Right above a quarter of a radius nothing comes through.
    let closed = with(GroundEffect::with_least_height(0.4, 0.25_f64.next_up()).expect("rotors"));
    assert!(
        matches!(closed, Err(Error { failure: Failure::NoContact { distance }, .. }) if distance > 0.1),
        "{closed:?}"
    );
    let nothing = GroundEffect::new(0.4).expect("rotors");
    assert!(nothing.factor(f64::NAN).is_nan() && nothing.factor(1e308) == 1.0 && nothing.factor(-1e308) == 4.0 / 3.0);
}

/// A platform that is singular, becomes so, or comes through a singular pose between two moments.
#[test]
fn platforms_in_singular_poses_are_refused() {
    let start = Landing::initial_state();
    let driven = |motion: Motion| on(motion).simulate_driven(start, &drive(), PERIOD, |_| ());
    let yawed = Motion { mean: [0.0, 0.0, HOME[2], 0.0, 0.0, FRAC_PI_2], ..swing([0.0; 6]) };
    for singular in [yawed, Motion { mean: [0.0; 6], ..yawed }] {
        let end = driven(singular);
        let is_refused = matches!(end, Err(Error { failure: Failure::Singular { .. }, at: Some(At::Time(0.0)) }));
        assert!(is_refused, "{end:?}");
    }
    // In yaw, through the base, over the edge in pitch.
    for sine in [[0.0, 0.0, 0.0, 0.0, 0.0, 3.1], [0.0, 0.0, 1.45, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 1.8, 0.0]] {
        let end = driven(swing(sine));
        let error = end.expect_err("through a singular pose");
        assert!(matches!(error.at, Some(At::Time(time)) if time > 0.5), "{error}");
        assert!(error.invalid().is_some_and(|wrong| wrong.parameter == SIDE && wrong.value < 0.0), "{error}");
    }
    // Poses too far for their squares, and none.
    let far = |x: f64| Motion { mean: [x, 0.0, HOME[2], 0.0, 0.0, 0.0], ..yawed };
    let end = driven(far(1e200));
    assert_eq!(end, Err(NOT_FINITE.at_time(0.0)));
    assert_eq!(driven(far(f64::NAN)), Err(Failure::NotFinite("the deck").at_time(0.0)));
    assert_eq!(driven(far(f64::INFINITY)), Err(Failure::NotFinite("the deck").at_time(0.0)));
}

#[test]
fn tracking_errors_of_no_pose_are_no_numbers() {
    let mut there = HOME;
    assert_eq!(TrackingError::between(&HOME, &there), TrackingError::default());
    for angle in [3, 4, 5] {
        there = HOME;
        there[angle] = f64::NAN;
        assert!(TrackingError::between(&HOME, &there).angle.is_nan(), "{angle}");
    }
    there[0] = f64::NAN;
    assert!(TrackingError::between(&HOME, &there).distance.is_nan());
}

#[test]
fn the_approach_rests_before_it_begins() {
    let approach = Approach::default();
    assert_eq!(approach.at(-1.0), approach.at(0.0));
    assert_eq!((approach.at(0.0).value, approach.at(0.0).rate, approach.at(0.0).acceleration), (10.0, 0.0, 0.0));
    assert!(approach.at(f64::NAN).value.is_nan());
}

/// `d Σ Ω³` of what is held, times how long: the last part of a period too.
#[test]
fn rotors_work_as_long_as_their_speeds_are_held() {
    let start = Landing::initial_state();
    let landing = on(Superposition::MARINE);
    let drag_factor = landing.vehicle.params().drag_factor;
    for period in [0.02, 0.002] {
        let work = |held: &[(f64, [f64; 4])], end: f64| {
            let acts = |i: usize| held.get(i + 1).map_or(end, |next| next.0) - held[i].0;
            let power = |i: usize| held[i].1.iter().map(|o| o.powi(3)).sum::<f64>();
            (0..held.len()).map(|i| drag_factor * power(i) * acts(i)).sum::<f64>()
        };
        let mut held = Vec::new();
        let sampled = landing.simulate_sampled(start, period, |t, state| {
            held.push((t, landing.command(t, &state.q, &state.qd).rotors.speed));
            *state
        });
        let sampled = sampled.expect("a touchdown");
        let expected = work(&held, sampled.time);
        close(sampled.rotor_work, expected, 1e-12 * expected);

        let mut held = Vec::new();
        let driven = landing
            .simulate_driven(start, &drive(), period, |moment| held.push((moment.time, moment.command.rotors.speed)));
        let driven = driven.expect("a touchdown").touchdown;
        let expected = work(&held, driven.time);
        close(driven.rotor_work, expected, 1e-12 * expected);
    }
}
