//! The fastest motion along a path: against closed forms where there are, and against its limits where there are none.

use mbs_arm::trajectory::time_optimal::{MotorLimits, SPEED, TimeOptimal, retime};
use mbs_arm::trajectory::{
    JointPath, JointState, Knot, Motion, PathPoint, RateLimits, StraightPath, VELOCITY, through,
};
use mbs_models::check::Must;
use mbs_models::irb7600::Irb7600;
use mbs_models::pendulum::{Params, Pendulum};
use mbs_models::{At, Error, Failure};

use super::table2_ends;

const UNLIMITED: f64 = f64::INFINITY;

/// `m l² = 2` kg·m²: gravity and friction only as asked for.
fn pendulum(g: f64, b: f64) -> Pendulum<f64> {
    Pendulum::new(Params { m: 2.0, l: 1.0, g, b })
}

fn one_joint(speed: f64, acceleration: f64, torque: f64) -> MotorLimits<1> {
    MotorLimits { rates: RateLimits { speed: [speed], acceleration: [acceleration] }, torque: [torque] }
}

/// Along 0 … 3 rad.
fn duration(limits: &MotorLimits<1>, intervals: usize) -> f64 {
    let path = StraightPath::new([0.0], [3.0]).unwrap();
    retime(path, &pendulum(0.0, 0.0), limits, intervals).unwrap().duration()
}

#[test]
fn one_joint_goes_full_speed_and_brakes() {
    // Bang-bang: 2 √(D/a), by the limit of acceleration or by the torque over the inertia.
    let bang_bang = 2.0 * (3.0_f64 / 0.75).sqrt();
    for limits in [one_joint(UNLIMITED, 0.75, UNLIMITED), one_joint(UNLIMITED, UNLIMITED, 1.5)] {
        let found = duration(&limits, 200);
        assert!((found / bang_bang - 1.0).abs() < 1e-8, "{found}, {bang_bang}");
    }
    // A limit of speed: D/v + v/a. It is reached within an interval, which costs a little.
    let limits = one_joint(1.0, 0.75, UNLIMITED);
    let trapezoid = 3.0 / 1.0 + 1.0 / 0.75;
    let [coarse, fine] = [200, 400].map(|intervals| duration(&limits, intervals) / trapezoid - 1.0);
    assert!((-1e-9..1e-4).contains(&fine) && fine <= coarse, "{coarse}, {fine}");
}

/// Against gravity: `m l² θ̈ + m g l sin θ = τ`; energies give the closed form of the time by quadrature.
#[test]
fn gravity_helps_to_brake() {
    let pendulum = pendulum(9.0, 0.0);
    let limits = one_joint(UNLIMITED, UNLIMITED, 30.0);
    let path = StraightPath::new([0.0], [1.0]).unwrap();
    let found = retime(path, &pendulum, &limits, 2000).unwrap().duration();
    // ½ m l² θ̇² = ± τ θ − m g l (1 − cos θ), switching where both branches meet: τ(2θ − 1) = m g l (1 − cos 1) … from
    // the stop backwards: ½ m l² θ̇² = τ (1 − θ) + m g l (cos θ − cos 1).
    let square = |theta: f64| {
        let up = 30.0 * theta - 18.0 * (1.0 - theta.cos());
        let down = 30.0 * (1.0 - theta) + 18.0 * (theta.cos() - 1.0_f64.cos());
        up.min(down)
    };
    // θ = sin²(z) takes the roots at both ends away.
    let steps = 400_000;
    let time: f64 = (0..steps)
        .map(|k| {
            let z = std::f64::consts::FRAC_PI_2 * (f64::from(k) + 0.5) / f64::from(steps);
            2.0 * z.sin() * z.cos() / square(z.sin().powi(2)).sqrt()
        })
        .sum::<f64>()
        * std::f64::consts::FRAC_PI_2
        / f64::from(steps);
    assert!((found / time - 1.0).abs() < 1e-4, "{found}, {time}");
}

/// Limits as assumed for the example, torques so that they matter.
fn motors() -> MotorLimits<6> {
    let degrees = |values: [f64; 6]| values.map(f64::to_radians);
    let rates = RateLimits {
        speed: degrees([75.0, 50.0, 55.0, 100.0, 100.0, 160.0]),
        acceleration: degrees([90.0, 60.0, 70.0, 150.0, 150.0, 250.0]),
    };
    MotorLimits { rates, torque: [2e3, 10e3, 4e3, 300.0, 200.0, 5.0] }
}

/// The largest ratio of each instant to its limits.
fn loads<P: JointPath<6>>(motion: &TimeOptimal<6, P>, limits: &MotorLimits<6>) -> Vec<f64> {
    let arm = Irb7600::<f64>::default();
    let samples = 20_000;
    let load = |k: usize| {
        let JointState { q, qd, qdd } = motion.at(motion.duration() * (k as f64 / samples as f64)).unwrap();
        let torque = arm.inverse_dynamics(&q, &qd, &qdd);
        let ratio = |values: [f64; 6], limits: [f64; 6]| {
            values.iter().zip(limits).fold(0.0_f64, |worst, (value, limit)| worst.max(value.abs() / limit))
        };
        let ratios =
            [ratio(qd, limits.rates.speed), ratio(qdd, limits.rates.acceleration), ratio(torque, limits.torque)];
        ratios.into_iter().fold(0.0, f64::max)
    };
    (0..=samples).map(load).collect()
}

fn check(path: impl JointPath<6> + Copy) -> f64 {
    let arm = Irb7600::<f64>::default();
    let limits = motors();
    let motion = retime(path, &arm, &limits, 800).unwrap();
    let loads = loads(&motion, &limits);
    let worst = loads.iter().copied().fold(0.0, f64::max);
    // Checked at quarters of the intervals, sampled anywhere.
    assert!(worst <= 1.0 + 2e-6, "{worst}");
    let full = loads.iter().filter(|load| **load > 0.99).count() as f64 / loads.len() as f64;
    assert!(full > 0.99, "at a limit {full} of the time");
    let finer = retime(path, &arm, &limits, 1600).unwrap();
    assert!((finer.duration() / motion.duration() - 1.0).abs() < 5e-4, "{} {}", finer.duration(), motion.duration());
    // Its derivatives are those of its angles.
    for k in 1..50 {
        let t = motion.duration() * f64::from(k) / 50.0;
        let h = 1e-6;
        let [before, at, after] = [t - h, t, t + h].map(|t| motion.at(t).unwrap());
        for i in 0..6 {
            assert!(((after.q[i] - before.q[i]) / (2.0 * h) - at.qd[i]).abs() < 1e-5);
        }
    }
    for (t, q) in [(0.0, path.point(0.0).unwrap().q), (motion.duration(), path.point(path.length()).unwrap().q)] {
        let state = motion.at(t).unwrap();
        assert!(state.qd.iter().all(|qd| qd.abs() < 1e-6), "{:?}", state.qd);
        assert!(state.q.iter().zip(q).all(|(found, expected)| (found - expected).abs() < 1e-9));
    }
    motion.duration()
}

#[test]
fn the_arm_along_a_straight_path_is_at_a_limit_all_the_time() {
    let [start, stop] = table2_ends();
    let time = check(StraightPath::new(start, stop).unwrap());
    assert!((1.0..10.0).contains(&time), "{time}");
}

#[test]
fn the_arm_along_a_curve_is_at_a_limit_all_the_time() {
    let [start, stop] = table2_ends();
    let between = std::array::from_fn(|i| 0.5 * (start[i] + stop[i]) + 0.2 * (i as f64 - 2.0));
    // Not at rest at the ends, where the tangent of a path must not vanish.
    let tangent = std::array::from_fn(|i| stop[i] - start[i]);
    let first = JointState { qd: tangent, ..JointState::at_rest(start) };
    let curve = through(&first, &[Knot { time: 0.5, q: between }, Knot { time: 1.0, q: stop }], tangent).unwrap();
    let time = check(curve);
    assert!((1.0..10.0).contains(&time), "{time}");
}

#[test]
fn what_cannot_be_timed_is_refused() {
    let path = StraightPath::new([0.0], [3.0]).unwrap();
    let free = pendulum(0.0, 0.0);
    let limits = one_joint(1.0, 1.0, 1.0);
    let refused = |limits: &MotorLimits<1>, intervals| retime(path, &free, limits, intervals).unwrap_err();
    assert_eq!(refused(&limits, 3), Must::BeAtLeast(4.0).broken_by("intervals", 3.0).into());
    let positive = Must::BeMoreThan(0.0);
    for (limits, expected) in [
        (one_joint(0.0, 1.0, 1.0), positive.broken_by("largest speed", 0.0)),
        (one_joint(1.0, -1.0, 1.0), positive.broken_by("largest acceleration", -1.0)),
        (one_joint(1.0, 1.0, 0.0), positive.broken_by("largest torque", 0.0)),
        (one_joint(UNLIMITED, UNLIMITED, UNLIMITED), Must::BeFinite.broken_by("largest speed", UNLIMITED).of(0)),
    ] {
        assert_eq!(refused(&limits, 10), expected.into());
    }
    assert!(retime(path, &free, &one_joint(f64::NAN, 1.0, 1.0), 10).is_err());
    // The weight is too much for the motor from 0.5 rad on, however fast it comes.
    let error = retime(path, &pendulum(9.0, 0.0), &one_joint(0.1, UNLIMITED, 18.0 * 0.5_f64.sin()), 300).unwrap_err();
    let Error { failure: Failure::Missing(SPEED), at: Some(At::Path(s)) } = error else { panic!("{error}") };
    assert!((0.5..3.0).contains(&(3.0 * s)), "{s}");
    let error = retime(path, &pendulum(0.0, 0.3), &limits, 10).unwrap_err();
    assert_eq!(error.at, Some(At::Path(0.0)));
    assert!(error.to_string().contains("force that grows with the velocity of joint"), "{error}");
    // A motion from rest has no tangent there.
    let motion = mbs_arm::trajectory::quintic([0.0], [0.0], [1.0], 1.0).unwrap();
    assert_eq!(retime(motion, &free, &limits, 10).unwrap_err(), Failure::NoMotion.at_path(0.0));
}

/// A path whose length is what it says.
#[derive(Debug)]
struct Claimed(f64);

impl JointPath<1> for Claimed {
    fn length(&self) -> f64 {
        self.0
    }

    fn point(&self, s: f64) -> Result<PathPoint<1>, Error> {
        Ok(PathPoint { q: [s], tangent: [f64::NAN], curvature: [0.0] })
    }
}

#[test]
fn paths_that_are_none_are_refused() {
    let limits = one_joint(1.0, 1.0, 1.0);
    for length in [0.0, -1.0, f64::INFINITY] {
        let error = retime(Claimed(length), &pendulum(0.0, 0.0), &limits, 10).unwrap_err();
        assert_eq!(error, Must::BePositive.broken_by("length", length).into());
    }
    assert!(retime(Claimed(f64::NAN), &pendulum(0.0, 0.0), &limits, 10).is_err());
    let error = retime(Claimed(1.0), &pendulum(0.0, 0.0), &limits, 10).unwrap_err();
    assert!(error.invalid().is_some_and(|wrong| wrong.parameter == VELOCITY), "{error}");
    assert_eq!(
        StraightPath::new([0.0], [1.0]).unwrap().point(1.5).unwrap_err(),
        Must::BeWithin([0.0, 1.0]).broken_by("path parameter", 1.5).into()
    );
}
