//! The estimator against differences of its own equations, a filter that is solved by hand, a measurement that is not
//! late, and the truth.

use mbs_landing::estimator::filter::{ALL, Estimate, Filter, Linearized, Uncertainty};
use mbs_landing::estimator::measurement;
use mbs_landing::estimator::nominal::{ERRORS, Nominal, VELOCITY, right_jacobian};
use mbs_landing::quadrotor::deck::{Deck, DeckState, HeavingDeck};
use mbs_landing::quadrotor::estimated::{inertial_state, vehicle_state};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_landing::sensors::imu::{Biases, ImuSample};
use mbs_landing::sensors::{Pose, Sensors};
use mbs_models::Failure;
use mbs_models::sensors::strapdown::{Params, Strapdown};
use mbs_runtime::{Dual, State};
use mbs_tests::random::Random;
use nalgebra::{SVector, UnitQuaternion, Vector3};

const SENSORS: Sensors = Sensors::TYPICAL;
const ORIGIN: Vector3<f64> = Vector3::new(12.0, 7.0, 0.0);
const G: f64 = 9.80665;

fn three(random: &mut Random, size: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.uniform(-size..size))
}

/// A state some metres over the deck, turned by half a radian or so.
fn state(random: &mut Random) -> Nominal {
    Nominal {
        pose: Pose {
            place: ORIGIN + Vector3::new(0.5, -0.4, 6.0) + three(random, 0.5),
            attitude: UnitQuaternion::from_scaled_axis(three(random, 0.3)),
        },
        velocity: three(random, 2.0),
        biases: Biases { gyro: three(random, 0.01), accelerometer: three(random, 0.1) },
    }
}

fn sample(random: &mut Random) -> ImuSample {
    ImuSample { rate: three(random, 3.0), specific_force: Vector3::new(0.0, 0.0, G) + three(random, 4.0) }
}

fn deck() -> DeckState {
    DeckState::of_platform(&[[12.0, 7.0, 0.4, 0.1, -0.15, 0.3], [0.0; 6], [0.0; 6]], &[0.1, 0.2, 0.0])
}

fn still() -> Nominal {
    let level = State::new([12.0, 7.0, 5.0, 0.0, 0.0, 0.0], [0.0; 6]);
    inertial_state(&level, &SENSORS, Biases::default())
}

/// What an IMU at rest says.
const REST: ImuSample = ImuSample { rate: Vector3::new(0.0, 0.0, 0.0), specific_force: Vector3::new(0.0, 0.0, G) };

fn unit<const N: usize>(i: usize, size: f64) -> SVector<f64, N> {
    SVector::from_fn(|j, _| if i == j { size } else { 0.0 })
}

#[test]
fn errors_are_those_that_were_made() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let (estimate, errors) =
            (state(&mut random), SVector::<f64, ERRORS>::from_fn(|_, _| random.uniform(-0.3..0.3)));
        let found = estimate.errors(&estimate.with(&errors, &ORIGIN), &ORIGIN);
        assert!((found - errors).norm() < 1e-13);
    }
}

/// F and G against differences of the step, errors against errors.
#[test]
fn transition_and_input_are_differences_of_the_step() {
    let mut random = Random::new(2);
    let model = Strapdown::new(Params { interval: SENSORS.imu.interval, g: G });
    for _ in 0..10 {
        let (estimate, said) = (state(&mut random), sample(&mut random));
        let step = estimate.step(&model, &said, &ORIGIN);
        let h = 1e-6;
        for i in 0..ERRORS {
            let end = |side: f64| {
                let moved = estimate.with(&unit(i, side * h), &ORIGIN);
                step.next.errors(&moved.step(&model, &said, &ORIGIN).next, &ORIGIN)
            };
            let difference = (end(1.0) - end(-1.0)) / (2.0 * h);
            assert!((difference - step.transition.column(i)).norm() < 1e-8, "error {i}");
        }
        for i in 0..6 {
            // Noise is what was said too much.
            let end = |side: f64| {
                let mut less = said;
                let change = if i < 3 { &mut less.rate[i] } else { &mut less.specific_force[i - 3] };
                *change -= side * h;
                step.next.errors(&estimate.step(&model, &less, &ORIGIN).next, &ORIGIN)
            };
            let difference = (end(1.0) - end(-1.0)) / (2.0 * h);
            assert!((difference - step.input.column(i)).norm() < 1e-8, "noise {i}");
        }
    }
}

/// The generated Jacobians of the step against the same step in dual numbers.
#[test]
fn the_generated_step_and_dual_numbers_agree() {
    let mut random = Random::new(3);
    let (model, dual) = (Strapdown::<f64>::default(), Strapdown::<Dual<f64>>::default());
    let q = state(&mut random).pose.coordinates();
    let (qd, u): ([f64; 7], [f64; 6]) = (random.array(-1.0..1.0), random.array(-5.0..5.0));
    let along = |values: &[f64], k: Option<usize>| -> Vec<Dual<f64>> {
        let part = |(i, &value): (usize, &f64)| Dual { value, derivative: f64::from(u8::from(k == Some(i))) };
        values.iter().enumerate().map(part).collect()
    };
    for k in 0..7 {
        let (q, qd, u) = (along(&q, Some(k)), along(&qd, None), along(&u, None));
        let (q, qd, u) = (q.try_into().unwrap(), qd.try_into().unwrap(), u.try_into().unwrap());
        let by = [dual.next_place(&q, &qd, &u), dual.next_velocity(&q, &qd, &u)].concat();
        let q = q.map(|x| x.value);
        let u = u.map(|x| x.value);
        let jacobian = [model.next_place_jacobian(&q, &u), model.next_velocity_jacobian(&q, &u)].concat();
        for (found, expected) in jacobian.iter().zip(by) {
            assert!((found[k] - expected.derivative).abs() < 1e-12);
        }
    }
    for k in 0..6 {
        let (q, u) = (along(&q, None), along(&u, Some(k)));
        let (q, u): ([Dual<f64>; 7], [Dual<f64>; 6]) = (q.try_into().unwrap(), u.try_into().unwrap());
        let by = dual.next_attitude(&q, &u);
        let jacobian = model.next_attitude_jacobian_u(&q.map(|x| x.value), &u.map(|x| x.value));
        for (found, expected) in jacobian.iter().zip(by) {
            assert!((found[k] - expected.derivative).abs() < 1e-12);
        }
    }
}

/// A turn by a constant rate is that of the exponential, and a specific force that is constant in the world moves by
/// ½ a t².
#[test]
fn the_step_is_exact_where_it_can_be() {
    let model = Strapdown::new(Params { interval: 0.005, g: G });
    let mut nominal = still();
    let (start, rate) = (nominal, Vector3::new(0.0, 0.0, 2.0));
    for _ in 0..200 {
        let said = ImuSample { rate, specific_force: Vector3::new(0.0, 0.0, G + 1.0) };
        nominal = nominal.step(&model, &said, &ORIGIN).next;
    }
    let turn = (start.pose.attitude.inverse() * nominal.pose.attitude).scaled_axis();
    assert!((turn - rate).norm() < 1e-12, "{turn}");
    assert!((nominal.pose.place - start.pose.place - Vector3::new(0.0, 0.0, 0.5)).norm() < 1e-12);
    assert!((nominal.velocity - Vector3::new(0.0, 0.0, 1.0)).norm() < 1e-12);
}

fn check_jacobian<const M: usize>(estimate: &Estimate, measured: impl Fn(&Estimate) -> Linearized<M>, tolerance: f64) {
    let about = measured(estimate);
    let h = 1e-6;
    for i in 0..ALL {
        let residual = |side: f64| measured(&estimate.with(&unit(i, side * h))).residual;
        let difference = (residual(-1.0) - residual(1.0)) / (2.0 * h);
        assert!((difference - about.jacobian.column(i)).norm() < tolerance, "error {i}");
    }
}

#[test]
fn measurement_matrices_are_differences() {
    let mut random = Random::new(4);
    let head = SENSORS.head();
    for _ in 0..10 {
        let nominal = state(&mut random);
        let clone = state(&mut random).pose;
        let estimate = Estimate { nominal, clone, origin: ORIGIN };
        let mut image = [Some([300.0, 200.0]); 8];
        image[5] = None;
        check_jacobian(&estimate, |at| measurement::range(&SENSORS, &head, &deck(), 3.0, at), 1e-7);
        check_jacobian(&estimate, |at| measurement::image(&SENSORS, &head, &deck(), &image, at), 1e-5);
        let about = measurement::image(&SENSORS, &head, &deck(), &image, &estimate);
        assert_eq!(about.freedom, 14);
        assert_eq!((about.residual[10], about.jacobian.row(11).norm()), (0.0, 0.0), "a marker that was not seen");
    }
}

#[test]
fn the_right_jacobian_is_that_of_the_exponential() {
    let turn = Vector3::new(0.2, -0.3, 0.25);
    let h = 1e-6;
    for i in 0..3 {
        let change = |side: f64| {
            let moved = UnitQuaternion::from_scaled_axis(turn + unit(i, side * h));
            (UnitQuaternion::from_scaled_axis(turn).inverse() * moved).scaled_axis()
        };
        let difference = (change(1.0) - change(-1.0)) / (2.0 * h);
        assert!((difference - right_jacobian(&turn).column(i)).norm() < 1e-8);
    }
}

/// Height over a level deck by ranges alone, moved by white acceleration: the filter of α and β, whose steady state is
/// known in closed form. Paul R. Kalata, *The tracking index: a generalized parameter for α-β and α-β-γ target
/// trackers*, 1984.
#[test]
fn a_filter_of_height_and_its_rate_settles_as_by_hand() {
    let mut sensors = SENSORS;
    sensors.imu.gyro.density = 0.0;
    sensors.imu.gyro.walk = 0.0;
    sensors.imu.accelerometer.walk = 0.0;
    sensors.imu.accelerometer.density = 0.5;
    let mut deviations = SVector::<f64, ERRORS>::zeros();
    (deviations[2], deviations[VELOCITY + 2]) = (1.0, 1.0);
    let mut filter = Filter::new(&sensors.imu, still(), ORIGIN, &deviations);
    let (head, level) = (
        sensors.head(),
        HeavingDeck { heave: Heave::<1> { amplitude: [0.0], frequency: [1.0] }, place: [12.0, 7.0] }.at(0.0),
    );
    for _ in 0..4000 {
        filter.propagate(&REST);
        let true_range = 5.0 + sensors.altimeter.place[2];
        filter.correct(|at| measurement::range(&sensors, &head, &level, true_range, at));
    }
    let (period, noise) = (sensors.imu.interval, sensors.altimeter.noise);
    let index = sensors.imu.accelerometer.density / period.sqrt() * period * period / noise;
    let r = (4.0 + index - (8.0 * index + index * index).sqrt()) / 4.0;
    let alpha = 1.0 - r * r;
    let beta = 2.0 * (2.0 - alpha) - 4.0 * (1.0 - alpha).sqrt();
    let p = filter.state_covariance();
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found}, not {expected}");
    close(p[(2, 2)], alpha * noise * noise);
    close(p[(2, VELOCITY + 2)], beta / period * noise * noise);
    // Sideways nothing is measured: n accelerations of the variance q are summed twice, q T⁴ Σ (k − ½)² for k up to n.
    let (q, n) = (sensors.imu.accelerometer.density.powi(2) / period, 4000.0_f64);
    close(p[(0, 0)], q * period.powi(4) * (n.powi(3) / 3.0 - n / 12.0));
}

/// Where nothing else is measured meanwhile, an image that is told of late is worth what it was worth at once.
#[test]
fn a_late_image_is_worth_as_much_as_at_once() {
    let deviations = Uncertainty { place: 1e-3, velocity: 1e-3, attitude: 1e-4 }.deviations(&SENSORS.imu);
    let head = SENSORS.head();
    let mut random = Random::new(5);
    let truth = still();
    // Small against what is uncertain, so that both filters propagate by nearly the same matrices.
    let said = truth.with(&deviations.map(|deviation| 0.1 * deviation * random.uniform(-1.0..1.0)), &ORIGIN);
    let image = SENSORS.camera.look(&head, &truth.pose, &deck(), &SENSORS.markers, &mut || 0.03);
    assert!(image.iter().all(Option::is_some));
    let mut at_once = Filter::new(&SENSORS.imu, said, ORIGIN, &deviations);
    let mut late = at_once.clone();
    let correct = |filter: &mut Filter| filter.correct(|at| measurement::image(&SENSORS, &head, &deck(), &image, at));
    at_once.clone_pose();
    late.clone_pose();
    let first = correct(&mut at_once);
    for _ in 0..16 {
        at_once.propagate(&REST);
        late.propagate(&REST);
    }
    let before = late.clone();
    let second = correct(&mut late);
    assert!((first.squared - second.squared).abs() < 1e-6 * first.squared && first.freedom == 16);
    // Of estimate and covariance: how far from what the image at once leaves, against how far before the late one.
    let far = |filter: &Filter| {
        let errors = at_once.estimate.nominal.errors(&filter.estimate.nominal, &ORIGIN);
        [errors.norm(), (at_once.state_covariance() - filter.state_covariance()).norm()]
    };
    for (after, before) in far(&late).into_iter().zip(far(&before)) {
        assert!(after < 1e-3 * before && before > 0.0, "{after} against {before}");
    }
}

/// The covariance stays symmetric and positive, and no measurement makes anything less known.
#[test]
fn a_correction_takes_from_the_covariance() {
    let deviations = Uncertainty::START.deviations(&SENSORS.imu);
    let head = SENSORS.head();
    let mut filter = Filter::new(&SENSORS.imu, still(), ORIGIN, &deviations);
    for _ in 0..40 {
        filter.propagate(&REST);
    }
    let before = filter.covariance;
    let image = SENSORS.camera.look(&head, &still().pose, &deck(), &SENSORS.markers, &mut || 0.0);
    filter.clone_pose();
    filter.correct(|at| measurement::image(&SENSORS, &head, &deck(), &image, at));
    assert_eq!(filter.covariance, filter.covariance.transpose());
    for i in 0..ERRORS {
        assert!(filter.covariance[(i, i)] <= before[(i, i)] * 1.001 && filter.covariance[(i, i)] > 0.0, "error {i}");
    }
    assert!(filter.state_covariance().cholesky().is_some());
}

#[test]
fn a_measurement_that_cannot_be_is_refused() {
    let deviations = Uncertainty { place: 0.01, velocity: 0.01, attitude: 0.01 }.deviations(&SENSORS.imu);
    let head = SENSORS.head();
    let mut filter = Filter::new(&SENSORS.imu, still(), ORIGIN, &deviations);
    for wrong in [1.0, f64::NAN] {
        let before = filter.clone();
        let seen = filter.correct(|at| measurement::range(&SENSORS, &head, &deck(), wrong, at));
        assert!(!seen.accepted);
        assert_eq!((filter.estimate, filter.covariance), (before.estimate, before.covariance));
    }
}

fn landing() -> Landing {
    Landing::new(Plant::Exact, Heave::CASE_II)
}

/// Without noise and with a first state that is right the estimate is the truth, but for the step of the integration.
#[test]
fn without_noise_the_estimate_is_the_truth() {
    let landing = landing();
    let start = Landing::initial_state();
    let said = inertial_state(&start, &SENSORS, Biases::default());
    let filter = Filter::new(&SENSORS.imu, said, ORIGIN, &Uncertainty::START.deviations(&SENSORS.imu));
    let mut greatest = SVector::<f64, ERRORS>::zeros();
    let end = landing
        .simulate_estimated(
            start,
            &SENSORS,
            Biases::default(),
            filter,
            || 0.0,
            |moment| {
                greatest = greatest.sup(&moment.filter.estimate.nominal.differences(moment.truth).abs());
            },
        )
        .unwrap();
    // What steps of 5 ms leave of the attitude turns the place 10 m over the deck; sensors leave a hundred times more.
    assert!(greatest.fixed_rows::<3>(6).max() < 2e-5, "{greatest}");
    assert!(greatest.fixed_rows::<3>(0).max() < 10.0 * 2e-5, "{greatest}");
    assert!(greatest.fixed_rows::<3>(VELOCITY).max() < 2e-4, "{greatest}");
    let exact = landing.simulate_sampled(start, SENSORS.imu.interval, |_, state| *state).unwrap();
    assert!((end.time - exact.time).abs() < 1e-3 && end.horizontal_offset < 1e-3, "{} {}", end.time, exact.time);
}

/// Coordinates and rates that the controller sees are those of the vehicle, lever arm included.
#[test]
fn the_state_of_the_vehicle_comes_back() {
    let mut random = Random::new(6);
    for _ in 0..20 {
        let [q, qd]: [[f64; 6]; 2] = [random.array(-1.0..1.0), random.array(-1.0..1.0)];
        let vehicle = State::new(q, qd);
        let body = mbs_landing::sensors::motion::Motion::of_quadrotor(&q, &qd, &[0.0; 6]);
        let nominal = inertial_state(&vehicle, &SENSORS, Biases::default());
        let found = vehicle_state(&nominal, &SENSORS.imu.ideal(&body), &SENSORS);
        let off = (0..6).map(|i| (found.q[i] - q[i]).abs().max((found.qd[i] - qd[i]).abs())).fold(0.0, f64::max);
        assert!(off < 1e-12, "{off}");
    }
}

#[test]
fn sensors_that_cannot_be_and_noise_that_is_none_end_in_errors() {
    let start = Landing::initial_state();
    let said = inertial_state(&start, &SENSORS, Biases::default());
    let filter = Filter::new(&SENSORS.imu, said, ORIGIN, &Uncertainty::START.deviations(&SENSORS.imu));
    let mut sensors = SENSORS;
    sensors.camera.focal = 0.0;
    let end = landing().simulate_estimated(start, &sensors, Biases::default(), filter.clone(), || 0.0, |_| ());
    assert!(
        end.as_ref().is_err_and(|error| error.invalid().is_some_and(|wrong| wrong.parameter == "camera.focal")),
        "{end:?}"
    );
    let end = landing().simulate_estimated(start, &SENSORS, Biases::default(), filter, || f64::NAN, |_| ());
    assert!(end.as_ref().is_err_and(|error| error.failure == Failure::NotFinite("what a sensor gives")), "{end:?}");
}
