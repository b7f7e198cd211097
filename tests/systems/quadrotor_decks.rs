//! Landings on decks that move in six degrees of freedom and on the driven platform, in wind and near the ground, each
//! against the same motion seen another way: from the deck, from a turned frame, by a closed form.

use mbs_landing::quadrotor::approach::Approach;
use mbs_landing::quadrotor::deck::{Deck, DeckState, HeavingDeck, MovingDeck};
use mbs_landing::quadrotor::driven::Drive;
use mbs_landing::quadrotor::ground_effect::GroundEffect;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Controller, Landing, Plant};
use mbs_landing::quadrotor::lqr::{Lqr, Weights};
use mbs_landing::quadrotor::small_angle;
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::check::{Invalid, Must};
use mbs_models::quadrotor_euler::{Params, QuadrotorEuler};
use mbs_models::{At, Error, Failure};
use mbs_platform::limits::{ActuatorLimits, Quantity};
use mbs_platform::{Coordinates, HOME, Motion, Platform, PlatformMotion, Superposition};
use mbs_runtime::State;
use mbs_runtime::control::ComputedTorque;
use mbs_tests::random::{Random, states};
use nalgebra::{Matrix3, Rotation3, Vector3};

const PLACE: [f64; 2] = [12.0, 7.0];

#[track_caller]
fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, not {expected}");
}

/// All six coordinates at once, two sines each.
fn tossing() -> Superposition<2> {
    let other = Motion {
        mean: [0.0; 6],
        sine: [0.0, 0.04, 0.1, 0.03, -0.05, 0.0],
        cosine: [0.1, 0.0, 0.0, 0.0, 0.02, 0.06],
        frequency: [0.4, 1.9, 0.8, 1.1, 0.6, 0.9],
    };
    Superposition([Motion::COMBINED, other])
}

fn at_the_place<M: PlatformMotion>(motion: M, point: [f64; 3]) -> MovingDeck<M> {
    MovingDeck { motion, base: [PLACE[0], PLACE[1], -HOME[2]], point }
}

fn rotation(state: &DeckState) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| state.rotation[i][j])
}

/// Central differences of the fourth order.
fn slope<const N: usize>(f: impl Fn(f64) -> [f64; N], t: f64) -> [f64; N] {
    let h = 1e-3;
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| f(t + k * h));
    std::array::from_fn(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * h))
}

#[test]
fn a_deck_moves_as_its_platform_does() {
    let (motion, point) = (tossing(), [0.4, -0.3, 0.3]);
    let deck = at_the_place(motion, point);
    for t in [0.0, 0.7, 3.1, 12.9] {
        let state = deck.at(t);
        let [q, qd, _] = motion.at(t);
        let turned = Rotation3::from_euler_angles(q[3], q[4], q[5]);
        let place = Vector3::new(PLACE[0] + q[0], PLACE[1] + q[1], q[2] - HOME[2]) + turned * Vector3::from(point);
        assert!((rotation(&state) - turned.matrix()).norm() < 1e-14);
        let velocity = slope(|t| deck.at(t).position, t);
        let acceleration = slope(|t| deck.at(t).velocity, t);
        // Ṙ Rᵀ = ω×
        let turning: [f64; 9] = slope(|t| deck.at(t).rotation.concat().try_into().expect("nine"), t);
        let spin = Matrix3::from_row_slice(&turning) * turned.matrix().transpose();
        for i in 0..3 {
            close(state.position[i], place[i], 1e-14);
            close(state.velocity[i], velocity[i], 1e-10);
            close(state.acceleration[i], acceleration[i], 1e-10);
            let [j, k] = [(i + 1) % 3, (i + 2) % 3];
            close(state.angular_velocity[i], spin[(k, j)], 1e-10);
        }
        assert_eq!((state.heading.value, state.heading.rate), (q[5], qd[5]));
    }
}

/// A vehicle on a path of its own: the deck sees `Rᵀ (x − p)` change, and the rest of the two rotations.
#[test]
fn the_deck_sees_the_vehicle_move() {
    let deck = at_the_place(tossing(), [0.4, -0.3, 0.3]);
    let vehicle = Motion { mean: [13.0, 6.0, 2.0, 0.1, -0.2, 0.5], ..Motion::COMBINED };
    let seen = |t: f64| {
        let [q, qd, _] = vehicle.at(t);
        deck.at(t).relative(&q, &qd)
    };
    for t in [0.2, 1.9, 7.3] {
        let relative = seen(t);
        let (state, [q, ..]) = (deck.at(t), vehicle.at(t));
        let d = Vector3::new(q[0], q[1], q[2]) - Vector3::from(state.position);
        let offset = rotation(&state).transpose() * d;
        let rate = slope(|t| seen(t).offset, t);
        for i in 0..3 {
            close(relative.offset[i], offset[i], 1e-14);
            close(relative.velocity[i], rate[i], 1e-10);
        }
        close(state.height(&[q[0], q[1], q[2]]), offset.z, 1e-14);
        let between = Rotation3::from_matrix_unchecked(rotation(&state)).inverse()
            * Rotation3::from_euler_angles(q[3], q[4], q[5]);
        let (roll, pitch, yaw) = between.euler_angles();
        for (found, expected) in relative.attitude.into_iter().zip([roll, pitch, yaw]) {
            close(found, expected, 1e-14);
        }
    }
}

fn results(end: &Touchdown) -> [f64; 4] {
    [end.time, end.relative_velocity, end.horizontal_offset, end.horizontal_speed]
}

#[track_caller]
fn alike(a: &Touchdown, b: &Touchdown, tolerance: f64) {
    for (a, b) in results(a).into_iter().zip(results(b)) {
        close(a, b, tolerance);
    }
    for (a, b) in [(a.relative.offset, b.relative.offset), (a.relative.velocity, b.relative.velocity)] {
        (0..3).for_each(|i| close(a[i], b[i], tolerance));
    }
    (0..3).for_each(|i| close(a.relative.attitude[i], b.relative.attitude[i], tolerance));
}

#[test]
fn a_platform_that_only_heaves_is_the_deck_of_the_thesis() {
    for heave in [Heave::CASE_I, Heave::CASE_II] {
        let level = Landing::new(Plant::Exact, heave);
        let moving = Landing::on(Plant::Exact, at_the_place(heave.about(HOME[2]), [0.0; 3]));
        let start = Landing::initial_state();
        let [a, b] = [level.simulate(start, |_, _, _| ()), moving.simulate(start, |_, _, _| ())];
        alike(&a.expect("a touchdown"), &b.expect("a touchdown"), 1e-8);
    }
}

/// A deck that drifts steadily, seen from a frame that drifts with it.
struct Drifting<D> {
    deck: D,
    /// The velocity \[m/s\].
    velocity: [f64; 3],
}

impl<D: Deck> Deck for Drifting<D> {
    fn at(&self, t: f64) -> DeckState {
        let state = self.deck.at(t);
        DeckState {
            position: std::array::from_fn(|i| state.position[i] + self.velocity[i] * t),
            velocity: std::array::from_fn(|i| state.velocity[i] + self.velocity[i]),
            ..state
        }
    }
}

#[test]
fn a_drifting_deck_is_one_in_wind() {
    let velocity = [2.0, -1.5, 0.4];
    for plant in [Plant::Exact, Plant::SmallAngle] {
        let deck = at_the_place(tossing(), [0.3, 0.1, 0.2]);
        let drifting = Landing::on(plant, Drifting { deck, velocity });
        let mut windy = Landing::on(plant, deck);
        windy.wind = velocity.map(|v| -v);
        let start = Landing::initial_state();
        let mut against = start;
        (0..3).for_each(|i| against.qd[i] -= velocity[i]);
        let seen = windy.simulate(against, |_, _, _| ()).expect("a touchdown");
        alike(&drifting.simulate(start, |_, _, _| ()).expect("a touchdown"), &seen, 1e-8);
        // The wind is felt, and both plants see it.
        let calm = Landing::on(plant, deck).simulate(against, |_, _, _| ()).expect("a touchdown");
        assert!((calm.relative.offset[0] - seen.relative.offset[0]).abs() > 1e-3, "{seen:?}");
    }
}

/// Without the drag, which is that along the world's axes, no direction is special: all turned by one angle lands
/// alike.
#[test]
fn the_vehicle_follows_the_heading_of_the_deck() {
    let turn: f64 = 0.6;
    let (sin, cos) = turn.sin_cos();
    let landed = |angle: f64, start: State<[f64; 6]>| {
        let mean = [0.0, 0.0, HOME[2], 0.05, 0.0, angle];
        let sine = [0.0, 0.0, 0.2, 0.03, 0.05, 0.1];
        let swing = Motion { mean, sine, cosine: [0.0; 6], frequency: [0.8; 6] };
        let mut landing = Landing::on(Plant::Exact, MovingDeck { motion: swing, base: [0.0; 3], point: [0.0; 3] });
        landing.vehicle = QuadrotorEuler::new(Params { drag_coefficient: 0.0, ..Params::default() });
        landing.simulate(start, |_, _, _| ()).expect("a touchdown")
    };
    let start = State::new([1.0, -0.5, 10.0, 0.05, 0.1, 0.2], [0.0; 6]);
    let mut turned = start;
    turned.q[0] = cos * start.q[0] - sin * start.q[1];
    turned.q[1] = sin * start.q[0] + cos * start.q[1];
    turned.q[5] += turn;
    let (a, b) = (landed(0.0, start), landed(turn, turned));
    alike(&a, &b, 1e-9);
    assert!(a.relative.attitude[2].abs() < 0.01 && b.state.q[5] > 0.4, "{a:?} {b:?}");
}

/// On the plane of the deck, from above, where another integrator finds it too.
#[test]
fn landings_on_decks_that_toss() {
    let marine = at_the_place(Superposition::MARINE, [0.4, -0.3, 0.3]);
    let six = at_the_place(tossing(), [0.4, -0.3, 0.3]);
    for deck in [marine, six] {
        let mut landing = Landing::on(Plant::Exact, deck);
        let start = Landing::initial_state();
        let mut lowest = f64::INFINITY;
        let end = landing
            .simulate(start, |t, state, _| {
                let d = Vector3::new(state.q[0], state.q[1], state.q[2]) - Vector3::from(deck.at(t).position);
                lowest = lowest.min((rotation(&deck.at(t)).transpose() * d).z);
            })
            .expect("a touchdown");
        assert!(lowest > 0.0 && lowest < 1e-3, "{lowest}");
        close(end.relative.offset[2], 0.0, 1e-12);
        close(end.relative.velocity[2], end.relative_velocity, 0.0);
        close(end.relative_velocity, -0.2, 0.02);
        assert!(end.horizontal_offset < 0.05 && end.horizontal_speed < 0.1, "{end:?}");
        // The vehicle is nearly upright, so the deck's tilt is what it sees.
        let tilt = end.relative.attitude[0].hypot(end.relative.attitude[1]);
        close(tilt, end.deck.rotation[2][2].acos(), 0.02);
        assert!(tilt > 0.01);

        let sampled = landing.simulate_sampled(start, 0.002, |_, state| *state).expect("a touchdown");
        let finer = landing.simulate_sampled(start, 0.0005, |_, state| *state).expect("a touchdown");
        let [off, less] = [&sampled, &finer].map(|other| (other.time - end.time).abs());
        assert!(off < 5e-3 && less < 0.4 * off, "{off} {less}");

        let lqr = Lqr::new(*landing.vehicle.params(), &Weights::default()).expect("a regulator");
        landing.controller = Controller::Lqr(lqr);
        let regulated = landing.simulate(start, |_, _, _| ()).expect("a touchdown");
        close(regulated.relative_velocity, -0.2, 0.05);
        assert!(regulated.horizontal_offset < 0.05, "{regulated:?}");
    }
}

/// Positions of both plants obey the same equations; only the attitude is approximate.
#[test]
fn both_plants_drift_alike_in_wind() {
    let (params, mut random) = (Params::default(), Random::new(3));
    for state in states::<6>(7, 50) {
        let (wind, speeds): ([f64; 3], [f64; 4]) = (random.array(-9.0..9.0), random.array(0.0..400.0));
        let q: Coordinates = std::array::from_fn(|i| if i == 4 { state.q[i].sin() } else { state.q[i] });
        let exact = QuadrotorEuler::new(params).forward_dynamics(&wind.map(|v| [v, 0.0, 0.0]), &q, &state.qd, &speeds);
        let approximate = small_angle::accelerations(&params, &wind, &q, &state.qd, &speeds);
        (0..3).for_each(|i| close(approximate[i], exact[i], 1e-12 * (1.0 + exact[i].abs())));
    }
}

/// Sinking slowly over ground that stands still: thrust is the weight, so that `g (R/4h)² = (1 + k₁ k₂) (h − r)`.
#[test]
fn the_vehicle_floats_on_its_ground_effect() {
    let ground = Heave { amplitude: [0.0; 4], frequency: [1.0; 4] };
    let radius = 0.4;
    let sink_rate = 1e-4;
    for plant in [Plant::Exact, Plant::SmallAngle] {
        let mut landing = Landing::new(plant, ground);
        landing.approach = Approach { height: 10.0, last_height: 0.4, sink_rate, duration: 8.0 };
        landing.t_end = 30.0;
        let Controller::Backstepping(controller) = landing.controller else { panic!("backstepping") };
        let stiffness = 1.0 + controller.vertical.k1 * controller.vertical.k2; // [1/s²]
        let g = landing.vehicle.params().g;
        let mut floats = |effect: Option<GroundEffect>| {
            landing.ground_effect = effect;
            let (mut last, mut count) = ([0.0; 2], 0);
            let refused = landing.simulate(Landing::initial_state(), |t, state, _| {
                last = [t, state.q[2]];
                count += 1;
            });
            assert!(
                matches!(refused, Err(Error { failure: Failure::NoContact { .. }, .. })) && count > 10_000,
                "{refused:?}"
            );
            let height = last[1];
            (height, height - (0.4 - sink_rate * (last[0] - 8.0)))
        };
        let (height, above) = floats(Some(GroundEffect::new(radius).expect("rotors")));
        close(stiffness * above, g * (radius / (4.0 * height)).powi(2), 2e-4);
        assert!(above > 0.05);
        // Without it the error is that of the drag alone.
        assert!(floats(None).1.abs() < 1e-6);
    }
}

/// The deck of [`HeavingDeck`], but late by the error that computed torque lets die from rest: `e = ė₀ t exp(−ω t)`.
struct Late {
    deck: HeavingDeck<4>,
    natural_frequency: f64,
}

impl Late {
    fn error(&self, t: f64) -> [f64; 2] {
        let (w, rate) = (self.natural_frequency, self.deck.heave.at(0.0).rate);
        let decay = rate * (-w * t).exp();
        [decay * t, decay * (1.0 - w * t)]
    }
}

impl Deck for Late {
    fn at(&self, t: f64) -> DeckState {
        let (mut state, [error, rate]) = (self.deck.at(t), self.error(t));
        state.position[2] -= error;
        state.velocity[2] -= rate;
        state
    }
}

fn unladen() -> Platform {
    Platform::default().with_payload(0.0).expect("a platform")
}

fn drive(natural_frequency: f64) -> Drive {
    Drive { platform: unladen(), control: ComputedTorque::critically_damped(natural_frequency).expect("a gain") }
}

/// The driven platform is a linear oscillator where its model is right: as the controllers are sampled faster, the
/// landing comes to be that on the deck of the closed form.
#[test]
fn the_driven_platform_is_late_as_its_gains_say() {
    let middle = 2.3;
    let start = Landing::initial_state();
    let late = Late { deck: HeavingDeck { heave: Heave::CASE_I, place: PLACE }, natural_frequency: 8.0 };
    let expected = Landing::on(Plant::Exact, late).simulate(start, |_, _, _| ()).expect("a touchdown");
    let deck = MovingDeck { motion: Heave::CASE_I.about(middle), base: [PLACE[0], PLACE[1], -middle], point: [0.0; 3] };
    let landing = Landing::on(Plant::Exact, deck);
    let mut moments = 0;
    let [coarse, fine] = [0.004, 0.001].map(|period| {
        landing
            .simulate_driven(start, &drive(8.0), period, |moment| {
                close(moment.deck.position[2], moment.platform.q[2] - middle, 1e-12);
                moments += 1;
            })
            .expect("a touchdown")
    });
    assert!(moments > 13 * 1000);
    let off = |f: fn(&Touchdown) -> f64| [&coarse, &fine].map(|end| (f(&end.touchdown) - f(&expected)).abs());
    for [coarse, fine] in [off(|end| end.time), off(|end| end.relative_velocity)] {
        assert!(fine < 0.3 * coarse && coarse < 3e-3, "{coarse} {fine}");
    }
    // At 1/ω the error is greatest: ė₀ / e ω.
    let greatest = Heave::CASE_I.at(0.0).rate / (8.0 * std::f64::consts::E);
    close(fine.greatest_error.distance, greatest, 0.01 * greatest);
    assert!(fine.greatest_error.angle < 1e-9 && fine.last_error.distance < 1e-4);

    // What the legs cannot do is reported.
    assert!(!fine.survey.is_clear());
    let lengths = unladen().lengths(&[0.0, 0.0, middle + 1.451_656, 0.0, 0.0, 0.0]).expect("legs");
    let too_long = fine.survey.excesses[0].iter().flatten().find(|e| e.worst.quantity == Quantity::TooLong);
    close(too_long.expect("out of stroke").worst.value, lengths[0], 1e-3);
}

/// A platform that is to stand still stands: the vehicle lands as on an exact deck, ground effect and wind included.
#[test]
fn a_driven_platform_can_stand() {
    let still =
        Superposition([Motion { mean: [0.0, 0.0, HOME[2], 0.05, -0.03, 0.2], ..Motion::TABLE_3 }; 1]).scaled(0.0);
    let mut landing = Landing::on(Plant::Exact, at_the_place(still, [0.3, 0.2, 0.1]));
    landing.ground_effect = Some(GroundEffect::new(0.4).expect("rotors"));
    landing.wind = [3.0, -1.0, 0.5];
    let start = Landing::initial_state();
    let exact = landing.simulate_sampled(start, 0.002, |_, state| *state).expect("a touchdown");
    let driven = landing.simulate_driven(start, &drive(8.0), 0.002, |_| ()).expect("a touchdown");
    alike(&driven.touchdown, &exact, 1e-9);
    assert!(driven.greatest_error.distance < 1e-12 && driven.survey.is_clear(), "{driven:?}");
    landing.ground_effect = None;
    let without = landing.simulate_sampled(start, 0.002, |_, state| *state).expect("a touchdown");
    assert!(without.time < exact.time - 0.5, "{} {}", without.time, exact.time);
}

/// Actuators that are too weak fall behind, are said to be, and the touchdown is on the platform where it is.
#[test]
fn weak_actuators_are_told_of() {
    let middle = 2.3;
    let deck = MovingDeck { motion: Heave::CASE_I.about(middle), base: [PLACE[0], PLACE[1], -middle], point: [0.0; 3] };
    let landing = Landing::on(Plant::Exact, deck);
    let mut weak = drive(8.0);
    let strong = landing.simulate_driven(Landing::initial_state(), &weak, 0.002, |_| ()).expect("a touchdown");
    weak.platform.limits.force = 640.0;
    let end = landing.simulate_driven(Landing::initial_state(), &weak, 0.002, |_| ()).expect("a touchdown");
    assert!(end.greatest_error.distance > 2.0 * strong.greatest_error.distance, "{:?}", end.greatest_error);
    let force = end.survey.excesses[3].iter().flatten().find(|e| e.worst.quantity == Quantity::Force);
    assert!(force.expect("too weak").worst.value > 640.0);
    assert!(!strong.survey.excesses.as_flattened().iter().flatten().any(|e| e.worst.quantity == Quantity::Force));
    close(end.touchdown.state.q[2], end.platform.q[2] - middle, 1e-9);
}

#[test]
fn motions_are_scaled_to_what_the_legs_allow() {
    let platform = unladen();
    // Of legs that stand on circles: l² = h² + c².
    let c2 = platform.lengths(&HOME).expect("legs")[0].powi(2) - HOME[2].powi(2);
    let ActuatorLimits { shortest, longest, .. } = platform.limits;
    let [low, high] = [shortest, longest].map(|l| (l * l - c2).sqrt());
    let quarter = 10.0;
    let frequency = std::f64::consts::FRAC_PI_2 / quarter;
    for (middle, bound) in [(HOME[2], HOME[2] - low), (1.3, high - 1.3)] {
        let heave = Superposition::heave(middle, &[1.0], &[frequency]);
        let scale = platform.admissible_scale(&heave, 40.0, 0.05).expect("a scale");
        assert!(bound - 1e-3 <= scale && scale <= bound, "{scale}, not {bound}");
        assert!(platform.survey(&heave.scaled(scale), 40.0, 0.05).expect("a survey").is_clear());
    }
    // By speed: `ż h / l` is greatest in the middle of a heave that is quick and small.
    let quick = Superposition::heave(HOME[2], &[0.2], &[4.0]);
    let bound = platform.limits.speed / (0.8 * HOME[2] / (HOME[2].powi(2) + c2).sqrt());
    close(platform.admissible_scale(&quick, 4.0, 0.002).expect("a scale"), bound, 0.02);

    let within = Superposition::heave(HOME[2], &[0.1], &[1.0]);
    assert_eq!(platform.admissible_scale(&within, 10.0, 0.05), Ok(1.0));
    let outside = Superposition::heave(3.0, &[0.1], &[1.0]);
    assert_eq!(platform.admissible_scale(&outside, 10.0, 0.05), Ok(0.0));
    assert!(platform.admissible_scale(&within, 10.0, f64::NAN).is_err());
    let nowhere = Superposition::heave(f64::NAN, &[0.1], &[1.0]);
    assert!(platform.admissible_scale(&nowhere, 10.0, 0.05).is_err());
}

#[test]
fn decks_that_cannot_be_landed_on_are_told_of() {
    let start = Landing::initial_state();
    // NaN, at once and later.
    let nowhere = at_the_place(Superposition::heave(f64::NAN, &[0.1], &[1.0]), [0.0; 3]);
    let refused = Landing::on(Plant::Exact, nowhere).simulate(start, |_, _, _| ());
    assert_eq!(refused, Err(Failure::NotFinite("the deck").at_time(0.0)));
    let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
    landing.deck.place[1] = f64::INFINITY;
    assert_eq!(landing.simulate(start, |_, _, _| ()), Err(Failure::NotFinite("the deck").at_time(0.0)));
    let lost = Landing::on(Plant::Exact, Lost { after: 2.0 });
    let refused = lost.simulate(start, |_, _, _| ());
    assert!(
        matches!(refused, Err(Error { failure: Failure::NotFinite("the deck"), at: Some(At::Time(time)) }) if (time - 2.0).abs() < 1e-9),
        "{refused:?}"
    );
    let refused = lost.simulate_sampled(start, 0.01, |_, state| *state);
    assert!(
        matches!(refused, Err(Error { failure: Failure::NotFinite("the deck"), at: Some(At::Time(time)) }) if (time - 2.01).abs() < 1e-9),
        "{refused:?}"
    );

    // Faster than free fall: the touchdown reports it.
    for (heave, falls) in [(Heave::CASE_I, 1.42), (Heave::CASE_II, 11.03)] {
        let end = Landing::new(Plant::Exact, heave).simulate(start, |_, _, _| ()).expect("a touchdown");
        close(end.deck_fall, falls, 0.01);
        assert!(end.deck_fall <= heave.acceleration_bound());
    }

    // A platform in its own base, one without a period, one whose limits nothing keeps.
    let deck = at_the_place(Superposition::heave(0.0, &[0.1], &[1.0]), [0.0; 3]);
    let refused = Landing::on(Plant::Exact, deck).simulate_driven(start, &drive(8.0), 0.002, |_| ());
    assert!(
        matches!(refused, Err(Error { failure: Failure::Singular { .. }, at: Some(At::Time(0.0)) })),
        "{refused:?}"
    );
    let landing = Landing::on(Plant::Exact, at_the_place(Superposition::MARINE, [0.0; 3]));
    let refused = landing.simulate_driven(start, &drive(8.0), 0.0, |_| ());
    assert_eq!(refused, Err(Must::BePositive.broken_by("period", 0.0).into()));
    let mut impossible = drive(8.0);
    impossible.platform.limits.force = -1.0;
    let refused = landing.simulate_driven(start, &impossible, 0.002, |_| ());
    let expected = Must::BeMoreThan(0.0).broken_by("largest force", -1.0);
    assert_eq!(refused, Err(expected.into()));
    let refused = landing.simulate_driven(State::new([f64::NAN; 6], [0.0; 6]), &drive(8.0), 0.002, |_| ());
    assert!(
        matches!(refused.as_ref().unwrap_err().invalid(), Some(Invalid { parameter: "q", index: Some(0), .. })),
        "{refused:?}"
    );
}

/// A level deck whose place nobody knows after a time.
struct Lost {
    after: f64,
}

impl Deck for Lost {
    fn at(&self, t: f64) -> DeckState {
        let level = HeavingDeck { heave: Heave::CASE_I, place: PLACE };
        let mut state = level.at(t);
        if t > self.after {
            state.position[0] = f64::NAN;
        }
        state
    }
}
