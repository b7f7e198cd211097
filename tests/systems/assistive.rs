//! The arm that carries a person's forearm: balance of its springs, and what the hand feels.

use mbs_arm::assistive::{Admittance, balancing_rates};
use mbs_models::assistive_arm::{AssistiveArm, Params};
use mbs_runtime::{Integrator, Rk4, State};

const POSTURE: [f64; 4] = [0.4, 1.5, 0.1, -0.6];

fn balanced() -> Params<f64> {
    let params = Params::default();
    Params { rate: balancing_rates(&params), ..params }
}

/// Heights of all masses and lengths of both springs, by trigonometry.
fn potential_by_hand(p: &Params<f64>, [first, second]: [f64; 2]) -> f64 {
    let elbow = p.height + p.length[0] * first.sin();
    let weight = p.mass[0] * (p.height + p.centre[0] * first.sin())
        + p.mass[1] * (elbow + p.centre[1] * second.sin())
        + p.payload * (elbow + p.length[1] * second.sin());
    let spring = |i: usize, elevation: f64| {
        // Law of cosines, with the angle between post and link.
        let (a, b) = (p.post[i], p.arm[i]);
        0.5 * p.rate[i] * (a * a + b * b - 2.0 * a * b * (std::f64::consts::FRAC_PI_2 - elevation).cos())
    };
    p.g * weight + spring(0, first) + spring(1, second)
}

#[test]
fn balanced_springs_carry_the_arm_in_every_posture() {
    let params = balanced();
    let (arm, bare) = (AssistiveArm::new(params), AssistiveArm::<f64>::default());
    let level = arm.potential_energy(&[0.0; 4]);
    let mut heaviest: f64 = 0.0;
    for i in -9..=9 {
        for j in -9..=9 {
            let elevation = [i, j].map(|k| 0.17 * f64::from(k));
            let q = [0.3, -0.8, elevation[0], elevation[1]];
            let by_hand = potential_by_hand(&params, elevation);
            assert!((arm.potential_energy(&q) - by_hand).abs() < 1e-12 * level, "{elevation:?}");
            assert!((by_hand - level).abs() < 1e-12 * level, "{elevation:?}");
            assert!(arm.gravity(&q).iter().all(|torque| torque.abs() < 1e-12), "{elevation:?}");
            heaviest = heaviest.max(bare.gravity(&q)[2].abs());
        }
    }
    assert!(heaviest > 8.0, "{heaviest}");
    // Another person's forearm is not carried: what is left is its weight.
    let other = AssistiveArm::new(Params { payload: params.payload + 0.5, ..params });
    let left = other.gravity(&POSTURE);
    for (i, length) in params.length.into_iter().enumerate() {
        let want = 0.5 * params.g * length * POSTURE[2 + i].cos();
        assert!((left[2 + i] - want).abs() < 1e-12, "{left:?} {want}");
    }
}

/// Newton's second law of a mass in a viscous medium, by quadrature of its convolution: `v = ∫ F e^(−d (t−s)/m)/m ds`.
#[test]
fn the_hand_feels_a_small_mass() {
    let arm = AssistiveArm::new(balanced());
    let control = Admittance { mass: 1.0, damping: 4.0, settling: 5.0 };
    let push = |t: f64| {
        let pulse = if t < 1.0 { (std::f64::consts::PI * t).sin().powi(2) } else { 0.0 };
        [0.6 * pulse, -0.5 * pulse, -0.9 * pulse]
    };
    let mut state = State::new(POSTURE, [0.0; 4]);
    let moving = |t: f64, q: &[f64; 4], qd: &[f64; 4], qdd: &mut [f64; 4]| {
        let (force, torque) = (push(t), control.torques(&arm, q, qd, &push(t)).expect("a regular posture"));
        let input = [torque[0], torque[1], torque[2], torque[3], force[0], force[1], force[2]];
        *qdd = arm.forward_dynamics(q, qd, &input);
    };
    Rk4::new(1e-3).integrate(moving, 0.0, 1.5, &mut state, |_| std::ops::ControlFlow::Continue(())).unwrap();
    let count = 100_000;
    let step = 1.5 / f64::from(count);
    let mut want = [0.0; 3];
    for k in 0..count {
        let s = step * (f64::from(k) + 0.5);
        let decay = (-control.damping * (1.5 - s) / control.mass).exp() / control.mass;
        want = std::array::from_fn(|i| want[i] + step * decay * push(s)[i]);
    }
    let found = arm.hand_place_velocity(&state.q, &state.qd);
    assert!((0..3).all(|i| (found[i] - want[i]).abs() < 1e-6), "{found:?} {want:?}");
    assert!(want[2] < -5e-3, "{want:?}");
}

#[test]
fn what_cannot_be_is_named() {
    let good = Admittance { mass: 1.0, damping: 4.0, settling: 5.0 };
    assert!(good.check().is_ok());
    let error = Admittance { mass: -1.0, ..good }.check().unwrap_err();
    assert_eq!((error.parameter, error.value), ("mass", -1.0));
    assert_eq!(Admittance { damping: 0.0, ..good }.check().unwrap_err().parameter, "damping");
    assert_eq!(Admittance { settling: f64::NAN, ..good }.check().unwrap_err().parameter, "settling");
    // Stretched upwards the hand cannot go sideways.
    let up = [0.0, 0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2];
    let found = good.torques(&AssistiveArm::new(balanced()), &up, &[0.0; 4], &[1.0, 0.0, 0.0]);
    assert_eq!(found, None);
}
