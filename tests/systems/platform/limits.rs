//! What the actuators allow: motions beyond it, limits that nothing can keep, computed torque with forces that are cut.

use std::cell::RefCell;
use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use mbs_models::check::{Invalid, Must};
use mbs_models::{At, Error, Failure};
use mbs_platform::{ActuatorLimits, Coordinates, HOME, LegVector, Motion, Platform, PlatformMotion, Quantity};
use mbs_runtime::control::ComputedTorque;
use mbs_runtime::{Dop853, Integrator, State};

#[test]
fn motions_beyond_the_limits_are_flagged_with_leg_and_time() {
    let platform = Platform::default();
    let still = Motion { sine: [0.0; 6], cosine: [0.0; 6], ..Motion::COMBINED };
    assert!(platform.survey(&still, 4.0, 0.01).unwrap().is_clear());
    let survey = platform.survey(&Motion::TABLE_4, 4.0, 0.01).unwrap();
    let first = survey.excesses[0][1].expect("leg 0 is too long").first;
    // It starts 0.23 m beyond the stroke.
    assert_eq!((first.leg, first.quantity, first.time, first.limit), (0, Quantity::TooLong, 0.0, 1.70));
    assert!((first.value - 1.931_618_313_528).abs() < 1e-9);
    assert_eq!(first.to_string(), "t = 0.000 s, leg 1: stroke 1.9316 m, the limit is 1.7 m");
    let worst = survey.excesses[0][1].expect("as above").worst;
    assert!(worst.value > 2.4 && worst.time > 0.5, "{worst:?}");
    // The same motion three times as fast asks for too much speed and force.
    let fast = Motion { frequency: Motion::TABLE_4.frequency.map(|w| 3.0 * w), ..Motion::TABLE_4 };
    let survey = platform.survey(&fast, 4.0, 0.01).unwrap();
    assert!(survey.speed > 0.6 && survey.excesses.iter().any(|leg| leg[2].is_some()));
    assert!(survey.force > 10e3 && survey.excesses.iter().any(|leg| leg[3].is_some()));
    let weak = ActuatorLimits { force: 100.0, ..platform.limits };
    assert!(weak.saturated(&[f64::NAN; 6]).iter().all(|force| force.is_nan()));
    assert_eq!(weak.saturated(&[50.0, 200.0, -200.0, 0.0, -50.0, 100.0]), [50.0, 100.0, -100.0, 0.0, -50.0, 100.0]);
}

/// A motion that notes when it was asked.
struct Noted<'a>(Motion, &'a RefCell<Vec<f64>>);

impl PlatformMotion for Noted<'_> {
    fn at(&self, t: f64) -> [Coordinates; 3] {
        self.1.borrow_mut().push(t);
        self.0.at(t)
    }
}

#[test]
fn surveys_without_samples_or_without_end_are_refused() {
    let (platform, motion) = (Platform::default(), Motion::COMBINED);
    let bad = [
        (4.0, 0.0),
        (4.0, -0.01),
        (4.0, f64::NAN),
        (4.0, f64::INFINITY),
        (f64::NAN, 0.01),
        (-1.0, 0.01),
        (f64::INFINITY, 0.01),
        // 10⁷ + 1 samples, more than a counter of 32 bits holds, and more than any.
        (1e5, 0.01),
        (4.0, 1e-10),
        (4.0, f64::MIN_POSITIVE),
    ];
    for (end, step) in bad {
        let named = platform.survey(&motion, end, step).unwrap_err().invalid().expect("a number").parameter;
        assert!(["step", "end", "number of samples"].contains(&named), "{end} {step}: {named}");
    }
    // One sample: the start.
    for (end, step) in [(0.0, 0.01), (0.5, 1.0)] {
        let survey = platform.survey(&motion, end, step).unwrap();
        assert_eq!(survey.condition.1, 0.0);
        let lengths = platform.lengths(&motion.at(0.0)[0]).unwrap();
        assert_eq!(survey.length[1], lengths.into_iter().fold(0.0, f64::max));
    }
    // 3 · 0.1 is more than 0.3: the last sample is the end all the same.
    for (end, step, count) in [(0.3, 0.1, 4), (0.7, 0.1, 8), (0.65, 0.1, 7), (4.0, 0.01, 401)] {
        let times = RefCell::new(Vec::new());
        platform.survey(&Noted(motion, &times), end, step).unwrap();
        let times = times.into_inner();
        let last = *times.last().unwrap();
        assert!(times.len() == count && last <= end && (end == 0.65 || last == end), "{end} {step}: {times:?}");
    }
    // The moment at which a pose ends it: level at 0 s, upended after a second.
    let turning = Motion { sine: [0.0, 0.0, 0.0, 0.0, FRAC_PI_2, 0.0], ..Motion::TABLE_3 };
    let upended = platform.survey(&turning, 4.0, 1.0);
    assert!(
        matches!(upended, Err(Error { failure: Failure::Singular { .. }, at: Some(At::Time(1.0)) })),
        "{upended:?}"
    );
}

#[test]
fn limits_that_nothing_can_keep_are_refused() {
    let mut platform = Platform::default();
    let good = platform.limits;
    assert_eq!(good.check(), Ok(()));
    let free = ActuatorLimits { shortest: 0.0, longest: f64::INFINITY, speed: f64::INFINITY, force: f64::INFINITY };
    assert_eq!(free.check(), Ok(()));
    let crossed = ActuatorLimits { shortest: 1.8, ..good };
    assert_eq!(crossed.check(), Err(Must::BeAtLeast(1.8).broken_by("longest length", 1.70)));
    for limits in [
        ActuatorLimits { shortest: -0.1, ..good },
        ActuatorLimits { shortest: f64::NAN, ..good },
        ActuatorLimits { longest: f64::NAN, ..good },
    ] {
        assert!(matches!(limits.check(), Err(Invalid { must: Must::BeAtLeast(_), .. })), "{limits:?}");
    }
    let control = ComputedTorque::critically_damped(5.0).unwrap();
    for bad in [0.0, -1.0, f64::NAN] {
        for (limits, of) in [
            (ActuatorLimits { speed: bad, ..good }, "largest speed"),
            (ActuatorLimits { force: bad, ..good }, "largest force"),
        ] {
            let refused = limits.check().unwrap_err();
            assert!(refused.parameter == of && refused.value.to_bits() == bad.to_bits(), "{refused:?}");
            // Who uses them refuses them.
            platform.limits = limits;
            let survey = platform.survey(&Motion::COMBINED, 1.0, 0.1);
            assert_eq!(survey.unwrap_err().to_string(), refused.to_string());
            let forces = platform.limited_forces(&control, &Motion::COMBINED.at(0.0), &HOME, &[0.0; 6]);
            assert_eq!(forces.unwrap_err().to_string(), refused.to_string());
        }
    }
    let weak = ActuatorLimits { force: -5.0, ..good }.check().unwrap_err();
    assert_eq!(weak.to_string(), "largest force must be more than 0, it is -5");
}

/// The errors obey `ë + 2 ω ė + ω² e = 0`, of which the solution is known.
#[test]
fn computed_torque_makes_the_errors_oscillators() {
    let platform = Platform::default();
    let omega = 5.0_f64;
    let control = ComputedTorque::critically_damped(omega).unwrap();
    let motion = Motion::COMBINED;
    let [reference, rate, _] = motion.at(0.0);
    let off = [0.02, -0.03, 0.01, 0.05, -0.04, 0.03];
    let mut state = State::new(std::array::from_fn(|i| reference[i] - off[i]), rate);
    simulate(&platform, 1.0, &mut state, |t, q, qd| platform.computed_forces(&control, &motion.at(t), q, qd).unwrap());
    let decay = (1.0 + omega) * (-omega).exp();
    for i in 0..6 {
        let error = motion.at(1.0)[0][i] - state.q[i];
        assert!((error - off[i] * decay).abs() < 1e-9, "coordinate {i}: {error} {}", off[i] * decay);
    }
}

/// Heave with a load that the legs carry by a margin of a tenth: limited they start late, and still arrive.
#[test]
fn limited_actuators_saturate_and_recover() {
    let mut platform = Platform::default().with_payload(1250.0).unwrap();
    let control = ComputedTorque::critically_damped(6.0).unwrap();
    let target = Motion { mean: [0.0, 0.0, 1.2, 0.0, 0.0, 0.0], sine: [0.0; 6], ..Motion::TABLE_3 };
    let target = Motion { cosine: [0.0; 6], ..target };
    let weight = platform.leg_forces(&HOME, &[0.0; 6], &[0.0; 6]).unwrap();
    platform.limits.force = 1.1 * weight[0];
    let mut saturated = false;
    let mut state = State::new(HOME, [0.0; 6]);
    simulate(&platform, 4.0, &mut state, |t, q, qd| {
        let wanted = platform.computed_forces(&control, &target.at(t), q, qd).unwrap();
        let given = platform.limited_forces(&control, &target.at(t), q, qd).unwrap();
        assert!(given.iter().all(|force| force.abs() <= platform.limits.force));
        saturated |= wanted != given;
        given
    });
    assert!(saturated, "the first moment asks for 3.6 m/s²");
    assert!((0..6).all(|i| (state.q[i] - target.mean[i]).abs() < 1e-6), "{state:?}");
    assert!(
        ComputedTorque::<6>::critically_damped(0.0).is_err()
            && ComputedTorque::<6>::critically_damped(f64::NAN).is_err()
    );
}

fn simulate(
    platform: &Platform,
    end: f64,
    state: &mut State<Coordinates>,
    mut forces: impl FnMut(f64, &Coordinates, &Coordinates) -> LegVector,
) {
    let motion = |t: f64, q: &Coordinates, qd: &Coordinates, qdd: &mut Coordinates| {
        *qdd = platform.accelerations(q, qd, &forces(t, q, qd)).expect("a regular pose");
    };
    Dop853::new(1e-11, 1e-12)
        .integrate(motion, 0.0, end, state, |_| ControlFlow::Continue(()))
        .expect("a smooth motion");
}
