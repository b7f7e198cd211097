//! Sensors of the vehicle against what a hand calculation says of simple motions and places.

use mbs_landing::quadrotor::deck::DeckState;
use mbs_landing::quadrotor::estimated::inertial_state;
use mbs_landing::sensors::camera::Image;
use mbs_landing::sensors::imu::{Biases, Imu, ImuSample};
use mbs_landing::sensors::motion::Motion;
use mbs_landing::sensors::{Pose, Sensors};
use mbs_models::check::Must;
use mbs_models::quadrotor_euler::QuadrotorEuler;
use mbs_runtime::State;
use mbs_tests::random::Random;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

const SENSORS: Sensors = Sensors::TYPICAL;
const G: f64 = 9.80665;

#[track_caller]
fn close(found: Vector3<f64>, expected: Vector3<f64>, tolerance: f64) {
    assert!((found - expected).norm() <= tolerance, "{found} instead of {expected}");
}

/// No noise.
fn silent() -> impl FnMut() -> f64 {
    || 0.0
}

fn ideal(q: [f64; 6], qd: [f64; 6], qdd: [f64; 6]) -> ImuSample {
    SENSORS.imu.ideal(&Motion::of_quadrotor(&q, &qd, &qdd))
}

#[test]
fn at_rest_an_imu_feels_gravity_upwards() {
    let level = ideal([1.0, 2.0, 3.0, 0.0, 0.0, 0.7], [0.0; 6], [0.0; 6]);
    close(level.specific_force, Vector3::new(0.0, 0.0, G), 1e-14);
    close(level.rate, Vector3::zeros(), 0.0);
    // Rolled by φ, the y axis points up by sin φ.
    let (sin, cos) = 0.3_f64.sin_cos();
    close(
        ideal([0.0, 0.0, 0.0, 0.3, 0.0, 0.0], [0.0; 6], [0.0; 6]).specific_force,
        Vector3::new(0.0, G * sin, G * cos),
        1e-14,
    );
}

#[test]
fn in_free_fall_an_imu_feels_nothing() {
    let fall = ideal([0.0, 0.0, 5.0, 0.4, -0.2, 1.0], [1.0, 0.0, -3.0, 0.0, 0.0, 0.0], [0.0, 0.0, -G, 0.0, 0.0, 0.0]);
    close(fall.specific_force, Vector3::zeros(), 1e-14);
}

/// About the vertical, with the IMU at r beside it: ω² r towards the axis, ω̇ r along the circle.
#[test]
fn turning_about_an_axis_an_imu_beside_it_feels_the_lever_arm() {
    let (rate, rise) = (3.0, 0.8);
    let spin = ideal([0.0, 0.0, 0.0, 0.0, 0.0, 0.9], [0.0, 0.0, 0.0, 0.0, 0.0, rate], [0.0, 0.0, 0.0, 0.0, 0.0, rise]);
    let [x, y, _] = SENSORS.imu.place;
    let expected = Vector3::new(-rate * rate * x - rise * y, -rate * rate * y + rise * x, G);
    close(spin.specific_force, expected, 1e-13);
    close(spin.rate, Vector3::new(0.0, 0.0, rate), 1e-14);
}

/// Velocity and acceleration of the IMU's place are differences of it along the same motion.
#[test]
fn the_motion_of_a_point_is_the_rate_of_its_place() {
    let mut random = Random::new(7);
    let vehicle = QuadrotorEuler::<f64>::default();
    let calm = [[0.0; 3]; 3];
    for _ in 0..20 {
        let [q, qd, qdd]: [[f64; 6]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| random.uniform(-1.0..1.0)));
        let place = |t: f64| {
            let q = std::array::from_fn(|i| q[i] + t * (qd[i] + 0.5 * t * qdd[i]));
            Vector3::from(vehicle.pose(&calm, &q).transform_point(SENSORS.imu.place))
        };
        let here = Motion::of_quadrotor(&q, &qd, &qdd).at(&SENSORS.imu.place);
        let h = 1e-4;
        close(here.place, place(0.0), 1e-14);
        close(here.velocity, (place(h) - place(-h)) / (2.0 * h), 1e-7);
        close(here.acceleration, (place(h) - 2.0 * place(0.0) + place(-h)) / (h * h), 1e-6);
    }
}

#[test]
fn noise_and_biases_have_their_deviations() {
    let mut random = Random::new(3);
    // The sum of twelve uniform deviates of variance 1/12 has mean 6 and variance 1.
    let mut normal = || (0..12).map(|_| random.uniform(0.0..1.0)).sum::<f64>() - 6.0;
    let body = Motion::of_quadrotor(&[0.0; 6], &[0.0; 6], &[0.0; 6]);
    let Imu { gyro, accelerometer, interval, .. } = SENSORS.imu;
    let (mut white, mut walk) = ([0.0; 2], [0.0; 2]);
    let (count, mut biases) = (20_000, Biases::default());
    for _ in 0..count {
        let before = biases;
        let sample = SENSORS.imu.measure(&body, &mut biases, &mut normal);
        let noise =
            [sample.rate - before.gyro, sample.specific_force - Vector3::new(0.0, 0.0, G) - before.accelerometer];
        let steps = [biases.gyro - before.gyro, biases.accelerometer - before.accelerometer];
        for i in 0..2 {
            white[i] += noise[i].norm_squared() / (3.0 * f64::from(count));
            walk[i] += steps[i].norm_squared() / (3.0 * f64::from(count));
        }
    }
    for (i, sensor) in [gyro, accelerometer].into_iter().enumerate() {
        // Five standard deviations of a variance from 60 000 deviates are 3 %.
        assert!((white[i] * interval / sensor.density.powi(2) - 1.0).abs() < 0.03, "{white:?}");
        assert!((walk[i] / interval / sensor.walk.powi(2) - 1.0).abs() < 0.03, "{walk:?}");
    }
}

fn deck(attitude: [f64; 3]) -> DeckState {
    let [phi, theta, psi] = attitude;
    DeckState::of_platform(&[[0.0, 0.0, 0.0, phi, theta, psi], [0.0; 6], [0.0; 6]], &[0.0; 3])
}

/// Of a body with its mass centre here.
fn imu_pose(place: [f64; 3], attitude: [f64; 3]) -> Pose {
    let ([x, y, z], [phi, theta, psi]) = (place, attitude);
    inertial_state(&State::new([x, y, z, phi, theta, psi], [0.0; 6]), &SENSORS, Biases::default()).pose
}

/// A plane that is turned by α about x rises as y tan α: a level vehicle sees its own height less that.
#[test]
fn ranges_over_a_tilted_plane() {
    let head = SENSORS.head();
    let range = |place: [f64; 3], attitude: [f64; 3], tilt: f64| {
        SENSORS.altimeter.measure(&head, &imu_pose(place, attitude), &deck([tilt, 0.0, 0.3]), &mut silent())
    };
    let [_, beside, above] = SENSORS.altimeter.place;
    let tilt = 0.25_f64;
    // `deck` yaws last: seen from a vehicle with the same yaw the plane rises along its own y.
    let seen = range([0.0, 0.0, 4.0], [0.0, 0.0, 0.3], tilt).unwrap();
    assert!((seen - (4.0 + above - beside * tilt.tan())).abs() < 1e-12, "{seen}");
    // Over a level plane the beam of a vehicle that rolls by φ is longer by 1/cos φ, its laser higher by y sin φ.
    let roll = 0.2_f64;
    let seen = range([0.0, 0.0, 4.0], [roll, 0.0, 0.0], 0.0).unwrap();
    assert!((seen - (4.0 + beside * roll.sin()) / roll.cos()).abs() < 1e-12, "{seen}");
    let limit = SENSORS.altimeter.greatest_incidence;
    assert!(range([0.0, 0.0, 4.0], [limit - 1e-6, 0.0, 0.0], 0.0).is_some());
    assert!(range([0.0, 0.0, 4.0], [limit + 1e-6, 0.0, 0.0], 0.0).is_none(), "too oblique");
    assert!(range([0.0, 0.0, 31.0], [0.0; 3], 0.0).is_none(), "too far");
    assert!(range([0.0, 0.0, 0.05], [0.0; 3], 0.0).is_none(), "too near");
    assert!(range([0.0, 0.0, 4.0], [3.1, 0.0, 0.0], 0.0).is_none(), "upside down");
}

fn image(place: [f64; 3], attitude: [f64; 3]) -> Image {
    let camera = &SENSORS.camera;
    camera.look(&SENSORS.head(), &imu_pose(place, attitude), &deck([0.0; 3]), &SENSORS.markers, &mut silent())
}

/// By similar triangles: f X/Z to the right, f Y/Z up, from the middle of the image.
#[test]
fn pixels_of_markers() {
    let (camera, height) = (SENSORS.camera, 5.0);
    let scale = camera.focal / height;
    for (seen, [x, y, _]) in image([0.0, 0.0, height], [0.0; 3]).into_iter().zip(SENSORS.markers) {
        let [right, down] = seen.unwrap();
        assert!((right - (320.0 + scale * (x - camera.place[0]))).abs() < 1e-10, "{right}");
        assert!((down - (240.0 - scale * y)).abs() < 1e-10, "{down}");
    }
    // Yawed by 90°, x of the deck points down in the image, y to the right.
    let quarter = std::f64::consts::FRAC_PI_2;
    for (seen, [x, y, _]) in image([0.0, 0.0, height], [0.0, 0.0, quarter]).into_iter().zip(SENSORS.markers) {
        let [right, down] = seen.unwrap();
        assert!((right - (320.0 + scale * (y - camera.place[0]))).abs() < 1e-10, "{right}");
        assert!((down - (240.0 + scale * x)).abs() < 1e-10, "{down}");
    }
    // Pitched by θ what was straight below the lens is f tan θ to the right: the nose, which +x is, goes down.
    let markers = [[0.0, 0.0, 0.0]; 8];
    let pitch = 0.1_f64;
    let [x, _, _] = camera.place;
    let place = [-x * pitch.cos(), 0.0, height + x * pitch.sin()];
    let pose = imu_pose(place, [0.0, pitch, 0.0]);
    let seen = camera.look(&SENSORS.head(), &pose, &deck([0.0; 3]), &markers, &mut silent())[0].unwrap();
    assert!((seen[0] - (320.0 + camera.focal * pitch.tan())).abs() < 1e-9, "{seen:?}");
}

#[test]
fn markers_out_of_view_are_not_seen() {
    let seen = |image: Image| image.map(|marker| marker.is_some());
    assert_eq!(seen(image([0.0, 0.0, 5.0], [0.0; 3])), [true; 8]);
    assert_eq!(seen(image([0.0, 0.0, 5.0], [3.0, 0.0, 0.0])), [false; 8], "behind the lens");
    let near = seen(image([0.0, 0.0, 0.6], [0.0; 3]));
    assert_eq!(near, [false, false, false, false, true, true, true, true], "the outer ones are beside the image");
    assert_eq!(seen(image([0.0, 0.0, 0.1], [0.0; 3])), [false; 8], "not sharp");
}

#[test]
fn what_no_sensor_can_be_is_refused_by_name() {
    assert_eq!(SENSORS.check(), Ok(()));
    let refused = |change: fn(&mut Sensors)| {
        let mut sensors = SENSORS;
        change(&mut sensors);
        sensors.check().unwrap_err()
    };
    let error = refused(|sensors| sensors.imu.interval = f64::NAN);
    assert_eq!((error.parameter, error.must), ("imu.interval", Must::BePositive));
    let error = refused(|sensors| sensors.imu.gyro.walk = -1.0);
    assert_eq!((error.parameter, error.index, error.value), ("imu.gyro", Some(1), -1.0));
    let error = refused(|sensors| sensors.camera.delay = 0.1);
    assert_eq!((error.parameter, error.value), ("camera.delay", 0.1), "not less than the period");
    let error = refused(|sensors| sensors.camera.period = 0.101);
    assert_eq!((error.parameter, error.value), ("camera.period", 0.101), "not a whole number of intervals");
    assert_eq!(refused(|sensors| sensors.altimeter.period = 1e-4).parameter, "altimeter.period");
    assert_eq!(refused(|sensors| sensors.altimeter.noise = 0.0).parameter, "altimeter.noise");
    assert_eq!(refused(|sensors| sensors.markers[3][1] = f64::INFINITY).parameter, "markers");
}

/// The pose of the IMU is that of the vehicle's output, for any attitude.
#[test]
fn the_inertial_state_is_that_of_the_vehicle() {
    let mut random = Random::new(11);
    for _ in 0..20 {
        let [q, qd]: [[f64; 6]; 2] = [random.array(-3.0..3.0), random.array(-3.0..3.0)];
        let nominal = inertial_state(&State::new(q, qd), &SENSORS, Biases::default());
        let rotation = Rotation3::from_euler_angles(q[3], q[4], q[5]);
        let expected = UnitQuaternion::from_rotation_matrix(&rotation);
        assert!(nominal.pose.attitude.angle_to(&expected) < 1e-7);
        close(nominal.pose.place, Vector3::new(q[0], q[1], q[2]) + rotation * Vector3::from(SENSORS.imu.place), 1e-13);
    }
}
