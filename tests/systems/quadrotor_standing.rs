//! What becomes of the vehicle after the touchdown, against closed forms and balances.

mod carried;

use mbs_landing::estimator::filter::{Filter, Uncertainty};
use mbs_landing::quadrotor::backstepping::Reference;
use mbs_landing::quadrotor::deck::{Deck, DeckState, MovingDeck};
use mbs_landing::quadrotor::estimated::inertial_state;
use mbs_landing::quadrotor::gear::{Damping, Gear};
use mbs_landing::quadrotor::landing::{HEIGHT, Landing, Plant};
use mbs_landing::quadrotor::standing::{Ending, Moment, Planned, Settled, Standing, Start, twist, with_quaternion};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_landing::sensors::Sensors;
use mbs_landing::sensors::imu::Biases;
use mbs_models::quadrotor_euler::QuadrotorEuler;
use mbs_models::quadrotor_quaternion::{Params, QuadrotorQuaternion};
use mbs_models::{Error, Failure};
use mbs_platform::Superposition;
use mbs_runtime::{State, to_matrix, to_rows};
use mbs_tests::random::states;
use nalgebra::{Matrix3, Rotation3, Vector3};

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

const G: f64 = 9.80665;
const M: f64 = 40.0;

/// A deck through the origin that turns about x: roll, its rate.
#[derive(Clone, Copy)]
struct Ramp {
    roll: f64,
    rate: f64,
}

impl Deck for Ramp {
    fn at(&self, t: f64) -> DeckState {
        let (sin, cos) = (self.roll + self.rate * t).sin_cos();
        DeckState {
            position: [0.0; 3],
            velocity: [0.0; 3],
            acceleration: [0.0; 3],
            rotation: [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]],
            angular_velocity: [self.rate, 0.0, 0.0],
            heading: Reference::default(),
        }
    }
}

const LEVEL: Planned<Ramp> = Planned(Ramp { roll: 0.0, rate: 0.0 });

/// In a vacuum, with this gravity.
fn in_vacuum(gear: Gear, g: f64) -> Standing {
    let vehicle = QuadrotorQuaternion::new(Params { drag_coefficient: 0.0, g, ..Params::default() });
    Standing { vehicle, ..Standing::new(gear) }
}

/// Over the origin of a deck with this roll, parallel to it, the feet this far over it, with a velocity in its axes.
fn parallel(gear: &Gear, roll: f64, gap: f64, velocity: [f64; 3]) -> Start {
    let (sin, cos) = roll.sin_cos();
    let height = gear.height + gap;
    let [x, y, z] = velocity;
    let q = [0.0, -sin * height, cos * height, roll, 0.0, 0.0];
    let qd = [x, cos * y - sin * z, sin * y + cos * z, 0.0, 0.0, 0.0];
    Start::at_rest(0.0, with_quaternion(&State::new(q, qd)))
}

fn followed(standing: &Standing, deck: Planned<Ramp>, start: &Start) -> (Settled, Vec<Moment>) {
    let mut moments = Vec::new();
    let end = standing.simulate(&deck, start, |moment| moments.push(*moment)).unwrap();
    (end, moments)
}

#[test]
fn both_attitudes_are_the_same() {
    let (angles, quaternion) = (QuadrotorEuler::<f64>::default(), QuadrotorQuaternion::<f64>::default());
    let still = [[0.0; 3]; 3];
    for state in states::<6>(5, 30) {
        let state = State::new(state.q, state.qd);
        let other = with_quaternion(&state);
        let (a, b) = (angles.pose(&still, &state.q), quaternion.pose(&still, &other.q));
        let rates =
            [angles.pose_velocity(&still, &state.q, &state.qd), quaternion.pose_velocity(&still, &other.q, &other.qd)];
        for i in 0..3 {
            (0..3).for_each(|j| close(b.rotation[i][j], a.rotation[i][j], 1e-13));
        }
        (0..6).for_each(|i| close(rates[1][i], rates[0][i], 1e-12 * (1.0 + rates[0][i].abs())));
    }
}

/// `m δ̈ + 4c δ̇ + 4k δ = m g` from `δ = 0`, `δ̇ = √(2gh)` until the force is zero, that is `δ̈ = g`; then a throw.
#[test]
fn a_drop_on_springs_and_dampers_is_the_closed_form() {
    let (drop, stiffness, damper) = (0.3, 1e4, 120.0);
    let gear = Gear { stiffness, damping: Damping::Viscous(damper), ..Gear::default() };
    let mut standing = in_vacuum(gear, G);
    let (end, moments) = followed(&standing, LEVEL, &parallel(&gear, 0.0, drop, [0.0; 3]));

    let (w, speed) = ((4.0 * stiffness / M).sqrt(), (2.0 * G * drop).sqrt());
    let (sag, decay) = (G / (w * w), 2.0 * damper / M);
    let damped = (w * w - decay * decay).sqrt();
    let (a, b) = (-sag, (speed - decay * sag) / damped);
    let depth = |t: f64| sag + (-decay * t).exp() * (a * (damped * t).cos() + b * (damped * t).sin());
    let rate = |t: f64| {
        (-decay * t).exp()
            * ((damped * b - decay * a) * (damped * t).cos() - (damped * a + decay * b) * (damped * t).sin())
    };
    let force = |t: f64| 4.0 * (stiffness * depth(t) + damper * rate(t));
    let (mut pushing, mut free) = (1.57 / damped, 4.0 / damped);
    assert!(force(pushing) > 0.0 && force(free) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (pushing + free);
        if force(middle) > 0.0 { pushing = middle } else { free = middle }
    }
    let rebound = rate(free).powi(2) / (2.0 * G) - depth(free);
    let touch = (2.0 * drop / G).sqrt();
    close(end.first_touch.unwrap(), touch, 1e-9);
    let height = |moment: &Moment| moment.vehicle.q[2] - gear.height;
    let highest = moments.iter().filter(|m| m.time > touch + free).map(height).fold(0.0, f64::max);
    // The top between two milliseconds is off by at most ½ g (0.5 ms)².
    close(highest, rebound, 2e-6);
    let deepest = (0..2000).map(|i| depth(f64::from(i) * free / 2000.0)).fold(0.0, f64::max);
    close(end.greatest_depth, deepest, 1e-5);
    assert!(
        matches!(end.ending, Ending::Rest { .. }) && end.rebounds == end.touches - 1 && end.rebounds >= 2,
        "{end:?}"
    );
    assert!(end.energy_error < 1e-8, "{}", end.energy_error);

    // At rest for long.
    standing.still.duration = 3.0;
    let (end, _) = followed(&standing, LEVEL, &parallel(&gear, 0.0, 0.0, [0.0; 3]));
    for depth in end.last.contact.depth {
        close(depth, M * G / (4.0 * stiffness), 1e-9);
        close(depth, gear.static_depth(M * G), 1e-9);
    }
}

/// Without damping nothing is lost, whatever the spring.
#[test]
fn springs_give_back_what_they_take() {
    for exponent in [1.0, 1.5] {
        let gear = Gear { exponent, damping: Damping::HuntCrossley(0.0), friction: 0.0, ..Gear::default() };
        let mut standing = in_vacuum(gear, G);
        standing.duration = 2.0;
        let (end, moments) = followed(&standing, LEVEL, &parallel(&gear, 0.0, 0.2, [0.0; 3]));
        let highest = moments.iter().filter(|m| m.time > 0.3).map(|m| m.vehicle.q[2]).fold(0.0, f64::max);
        close(highest, 0.2 + gear.height, 2e-6);
        assert!(end.rebounds >= 2 && end.last.dissipated == 0.0 && end.energy_error < 1e-8, "{end:?}");
    }
}

/// Of Hunt and Crossley, `e = 1 − α v` with `λ = (3/2) α k`, for slow impacts; here λ is over k. Without gravity.
#[test]
fn the_coefficient_of_restitution_is_hunts_and_crossleys() {
    for (exponent, speed) in [(1.0, 0.1), (1.5, 0.1), (1.0, 0.05)] {
        let damping = 0.2;
        let gear = Gear { exponent, damping: Damping::HuntCrossley(damping), ..Gear::default() };
        let mut standing = in_vacuum(gear, 0.0);
        standing.duration = 2.0;
        let (end, _) = followed(&standing, LEVEL, &parallel(&gear, 0.0, 0.01, [0.0, 0.0, -speed]));
        let lost = 1.0 - end.last.vehicle.qd[2] / speed;
        let expected = 2.0 / 3.0 * damping * speed;
        close(lost, expected, 2.0 * expected * expected);
        assert!(matches!(end.ending, Ending::Airborne) && end.rebounds == 1, "{end:?}");
    }
}

/// `g (sin α − μ cos α)` down the slope.
#[test]
fn a_vehicle_slides_down_what_is_too_steep() {
    let (roll, friction) = (0.45_f64, 0.3);
    let gear = Gear { friction, height: 0.3, damping: Damping::HuntCrossley(6.0), ..Gear::default() };
    let mut standing = in_vacuum(gear, G);
    standing.duration = 3.0;
    let depth = gear.static_depth(M * G * roll.cos());
    let start = parallel(&gear, roll, -depth, [0.0, -0.5, 0.0]);
    let (end, moments) = followed(&standing, Planned(Ramp { roll, rate: 0.0 }), &start);
    let speed = |moment: &Moment| -(moment.vehicle.qd[1] * roll.cos() + moment.vehicle.qd[2] * roll.sin());
    let found = (speed(&moments[2900]) - speed(&moments[1900])) / 1.0;
    let expected = G * (roll.sin() - friction * roll.cos());
    close(found, expected, 1e-4 * expected);
    assert!(end.ending == Ending::Sliding && end.slid > 5.0 && end.energy_error < 1e-8, "{end:?}");
    close(end.slid, end.displaced, 0.02);
}

/// Where friction could hold more, it creeps with `v_s s/√(1 − s²)`, `s = tan α/μ`.
#[test]
fn a_vehicle_rests_on_what_is_less_steep_but_for_its_creep() {
    let (roll, friction) = (0.3_f64, 0.6);
    let gear = Gear { friction, ..Gear::default() };
    let mut standing = in_vacuum(gear, G);
    standing.still.duration = 2.0;
    let start = parallel(&gear, roll, 0.002, [0.0; 3]);
    let (end, _) = followed(&standing, Planned(Ramp { roll, rate: 0.0 }), &start);
    let part = roll.tan() / friction;
    let creep = gear.creep_speed * part / (1.0 - part * part).sqrt();
    for slip in end.last.contact.slip {
        close(slip, creep, 1e-3 * creep);
    }
    assert!(matches!(end.ending, Ending::Rest { since } if since < 3.0), "{end:?}");
    assert!(end.slid < 0.02, "{}", end.slid);
}

/// A deck that is slowly turned: the upper feet leave it where `tan α = half track/height`, and the vehicle falls over.
#[test]
fn the_tipping_angle_is_that_of_a_block() {
    let gear = Gear { stiffness: 2e5, friction: 2.0, damping: Damping::HuntCrossley(20.0), ..Gear::default() };
    let ramp = Ramp { roll: 0.55, rate: 0.02 };
    let mut standing = in_vacuum(gear, G);
    standing.duration = 15.0;
    standing.still.duration = 15.0;
    let start = parallel(&gear, ramp.roll, -gear.static_depth(M * G * ramp.roll.cos()), [0.0; 3]);
    let (end, moments) = followed(&standing, Planned(ramp), &start);
    assert!(matches!(end.ending, Ending::TippedOver { .. }), "{end:?}");
    let lifted = moments.iter().find(|m| m.time > 2.0 && m.contact.normal.iter().filter(|&&n| n == 0.0).count() == 2);
    let angle = ramp.roll + ramp.rate * lifted.expect("two feet leave").time;
    close(angle.tan(), gear.half_track / gear.height, 4e-3);
    close(gear.tipping_angle().tan(), gear.half_track / gear.height, 1e-15);
    assert!(end.greatest_tilt > standing.tipped - 1e-9 && end.energy_error < 1e-7, "{end:?}");
}

/// A level deck without friction gives no horizontal momentum, and no angular momentum about the vertical.
#[test]
fn what_has_no_friction_keeps_its_momentum_along_the_deck() {
    let gear = Gear { friction: 0.0, ..Gear::default() };
    let standing = in_vacuum(gear, G);
    let start = State::new([0.0, 0.0, 0.7, 0.1, -0.15, 0.3], [0.6, -0.4, -0.5, 0.3, 0.2, -0.5]);
    let (end, moments) = followed(&standing, LEVEL, &Start::at_rest(0.0, with_quaternion(&start)));
    let vertical = |moment: &Moment| {
        let own = twist(&standing.vehicle, &moment.vehicle);
        let inertia = Matrix3::from_diagonal(&Vector3::from(standing.vehicle.params().inertias));
        (own.rotation * inertia * own.rotation.transpose() * own.angular_velocity).z
    };
    let spin = vertical(&moments[0]);
    for moment in &moments {
        let [x, y, ..] = moment.vehicle.qd;
        close(x, 0.6, 1e-9);
        close(y, -0.4, 1e-9);
        close(vertical(moment), spin, 1e-8);
    }
    assert!(end.touches >= 1 && end.energy_error < 1e-8, "{end:?}");
}

/// On a deck at sea, in wind, with rotors that run down: everything that does work is in the balance.
#[test]
fn the_balance_of_energy_holds_on_a_deck_at_sea() {
    let deck = MovingDeck { motion: Superposition::MARINE, base: [0.0; 3], point: [0.4, -0.3, 0.3] };
    let gear = Gear::default();
    let standing = Standing { wind: [3.0, -2.0, 0.5], ..Standing::new(gear) };
    let under = deck.at(10.0);
    let [x, y, z] = under.position;
    let q = [x, y, z + 0.6, 0.05, -0.1, 0.2];
    let [xd, yd, zd] = under.velocity;
    let vehicle = with_quaternion(&State::new(q, [xd + 0.3, yd, zd - 0.8, 0.2, 0.1, 0.0]));
    let start = Start { time: 10.0, rotor_speed: [280.0, 290.0, 285.0, 288.0], ..Start::at_rest(10.0, vehicle) };
    let end = standing.simulate(&Planned(deck), &start, |_| ()).unwrap();
    assert!(matches!(end.ending, Ending::Rest { since } if since > 10.3), "{end:?}");
    assert!(end.energy_error < 1e-8 && end.last.dissipated > 10.0, "{end:?}");
    // The unit quaternion stays one.
    let [.., a, b, c, d] = end.last.vehicle.q;
    close(a * a + b * b + c * c + d * d, 1.0, 1e-8);
}

/// How fast the deepest foot comes to be deeper, by differences: vehicle and deck a moment before and after \[m/s\].
fn sinking(gear: &Gear, end: &Touchdown) -> f64 {
    let h = 1e-5;
    let deepest = |h: f64| {
        let State { q, qd } = &end.state;
        let vehicle = State::new(core::array::from_fn(|i| q[i] + h * qd[i]), *qd);
        let turn = Rotation3::new(h * Vector3::from(end.deck.angular_velocity)) * to_matrix(&end.deck.rotation);
        let position = core::array::from_fn(|i| end.deck.position[i] + h * end.deck.velocity[i]);
        let deck = DeckState { position, rotation: to_rows(&turn), ..end.deck };
        gear.contact(&twist(&QuadrotorQuaternion::default(), &with_quaternion(&vehicle)), &deck).deepest()
    };
    (deepest(h) - deepest(-h)) / (2.0 * h)
}

/// A landing with legs ends where the first foot meets the deck, whatever the controller sees and when it acts.
#[test]
fn a_vehicle_with_legs_touches_with_its_first_foot() {
    let deck = MovingDeck { motion: Superposition::MARINE, base: [12.0, 7.0, -1.1], point: [0.4, -0.3, 0.3] };
    let gear = Gear::default();
    let landing = Landing { gear: Some(gear), ..Landing::on(Plant::Exact, deck) };
    let start = Landing::initial_state();
    let vehicle = QuadrotorQuaternion::default();
    let sensors = Sensors::TYPICAL;
    let deviations = Uncertainty::START.deviations(&sensors.imu);
    let said = inertial_state(&start, &sensors, Biases::default());
    let filter = Filter::new(&sensors.imu, said, Vector3::new(12.0, 7.0, 0.0), &deviations);
    let ends = [
        landing.simulate(start, |_, _, _| ()),
        landing.simulate_sampled(start, 0.002, |_, state| *state),
        landing.simulate_estimated(start, &sensors, Biases::default(), filter, || 0.0, |_| ()),
    ];
    for end in ends.map(Result::unwrap) {
        let contact = gear.contact(&twist(&vehicle, &with_quaternion(&end.state)), &end.deck);
        close(end.relative_velocity, -sinking(&gear, &end), 1e-6);
        assert!((end.relative_velocity - end.relative.velocity[2]).abs() > 1e-3, "{end:?}");
        close(contact.deepest(), 0.0, 1e-9);
        assert!(contact.depth.iter().filter(|depth| **depth < -1e-3).count() == 3, "{contact:?}");
        assert!(end.relative.offset[2] > 0.35 && end.time < 13.0, "{end:?}");
    }
    let none = Landing { gear: Some(Gear { stiffness: f64::NAN, ..gear }), ..landing };
    let error = none.simulate(start, |_, _, _| ()).unwrap_err();
    assert!(error.invalid().is_some_and(|invalid| invalid.parameter == "gear.stiffness"), "{error}");
}

#[test]
fn what_cannot_stand_is_refused() {
    let gear = Gear::default();
    let good = Standing::new(gear);
    let start = parallel(&gear, 0.0, 0.1, [0.0; 3]);
    let of = |standing: &Standing, start: &Start| standing.simulate(&LEVEL, start, |_| ()).unwrap_err();
    let named = |error: Error| match error.failure {
        Failure::Invalid(invalid) => invalid.parameter,
        other => panic!("{other}"),
    };
    let legs = Standing { gear: Gear { friction: -1.0, ..gear }, ..good.clone() };
    assert_eq!(named(of(&legs, &start)), "gear.friction");
    assert_eq!(named(of(&Standing { duration: f64::NAN, ..good.clone() }, &start)), "duration");
    assert_eq!(named(of(&Standing { wind: [0.0, f64::INFINITY, 0.0], ..good.clone() }, &start)), "wind");
    assert_eq!(named(of(&good, &Start { rotor_speed: [-1.0; 4], ..start })), "start.rotor_speed");
    let mut long = start;
    long.vehicle.q[3] = 1.1;
    assert_eq!(named(of(&good, &long)), "start.vehicle quaternion's square");
    let below = parallel(&gear, 0.0, -0.5, [0.0; 3]);
    assert!(of(&good, &below).invalid().is_some_and(|wrong| wrong.parameter == HEIGHT && wrong.value < 0.0));
    let over = good.simulate(&Planned(Ramp { roll: 2.0, rate: 0.0 }), &start, |_| ()).unwrap_err();
    assert!(over.to_string().contains("upward component of the deck's normal must be more than"), "{over}");
    let lost = good.simulate(&Planned(Ramp { roll: 0.0, rate: f64::NAN }), &start, |_| ()).unwrap_err();
    assert_eq!(lost.failure, Failure::NotFinite("the deck"));
}
