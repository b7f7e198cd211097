//! Both cases of Table 2 against `tests/data/trajectory.json`.

use mbs_arm::trajectory::{Motion, Piecewise, quartic, quintic, sign_change::sign_changes, two_piece_quartic, work};
use mbs_models::irb7600::Irb7600;
use mbs_tests::compare::assert_close;
use serde_json::Value;

use super::{DURATION, table2_ends};

/// Of the two cases, with the velocities at the start \[rad/s\].
fn cases() -> [(&'static str, [f64; 6]); 2] {
    [("case1", [0.0; 6]), ("case2", [1.5_f64.to_radians(); 6])]
}

fn reference(case: &str, method: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("../../data/trajectory.json")).unwrap();
    all[case][method].clone()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn degrees(q: [f64; 6]) -> [f64; 6] {
    q.map(f64::to_degrees)
}

/// Angles, velocities and accelerations at the times of the reference, in degrees, to 1e-12 of the largest.
fn check_samples(motion: &impl Motion<6>, reference: &Value) {
    for (row, t) in numbers(&reference["t_s"]).into_iter().enumerate() {
        let state = motion.at(t).unwrap();
        for (key, found) in
            [("position_deg", state.q), ("velocity_deg_s", state.qd), ("acceleration_deg_s2", state.qdd)]
        {
            assert_close(&format!("{key} at {t} s"), &degrees(found), &numbers(&reference[key][row]), 1e-12);
        }
    }
}

fn check_coefficients<const P: usize>(motion: &Piecewise<6, P>, piece: usize, reference: &Value) {
    for (joint, expected) in reference.as_array().unwrap().iter().enumerate() {
        let mut expected = numbers(expected);
        expected.resize(6, 0.0);
        let found = degrees(motion.coefficients(piece, joint));
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            // Each power by itself, in what it adds at the end of the piece.
            let scale = motion.ends()[0].powi(k as i32);
            assert!((found - expected).abs() * scale < 2e-12, "joint {joint}, power {k}: {found}, {expected}");
        }
    }
}

#[test]
fn the_quartics_are_those_of_the_reference() {
    let arm = Irb7600::<f64>::default();
    let [start, stop] = table2_ends();
    for (case, velocity) in cases() {
        let reference = reference(case, "default_quartic");
        let motion = quartic(start, velocity, stop, DURATION).unwrap();
        check_samples(&motion, &reference);
        check_coefficients(&motion, 0, &reference["coeff_a0_to_a4_deg_per_s_n"]);
        let end = motion.at(DURATION).unwrap();
        assert_close("a(T)", &degrees(end.qdd), &numbers(&reference["final_acceleration_deg_s2"]), 1e-12);
        for (row, t) in numbers(&reference["t_s"]).into_iter().enumerate() {
            let state = motion.at(t).unwrap();
            let torque = arm.inverse_dynamics(&state.q, &state.qd, &state.qdd);
            let expected = numbers(&reference["tau_N_m"][row]);
            for (joint, (found, expected)) in torque.iter().zip(&expected).enumerate() {
                assert!((found - expected).abs() < 1e-8, "τ{joint} at {t} s: {found}, {expected}");
            }
            let flange = arm.flange(&state.q).position;
            assert_close("flange", &flange, &numbers(&reference["end_effector_P_m"][row]), 1e-13);
        }
    }
}

#[test]
fn the_alternatives_are_those_of_the_reference() {
    let [start, stop] = table2_ends();
    for (case, velocity) in cases() {
        let expected = reference(case, "alternative_quintic");
        let motion = quintic(start, velocity, stop, DURATION).unwrap();
        check_samples(&motion, &expected);
        check_coefficients(&motion, 0, &expected["coeff_a0_to_a5_deg_per_s_n"]);

        let expected = reference(case, "alternative_two_piece_quartic_C3");
        let motion = two_piece_quartic(start, velocity, stop, DURATION).unwrap();
        assert_eq!(motion.ends()[0], expected["knot_time_s"].as_f64().unwrap());
        check_coefficients(&motion, 0, &expected["piece1_a0_to_a4"]);
        check_coefficients(&motion, 1, &expected["piece2_local_time_a0_to_a4"]);
        let middle = motion.at(25.0).unwrap();
        for (key, found) in
            [("mid_position_deg", middle.q), ("mid_velocity_deg_s", middle.qd), ("mid_acceleration_deg_s2", middle.qdd)]
        {
            assert_close(key, &degrees(found), &numbers(&expected[key]), 1e-12);
        }
        let end = motion.at(DURATION).unwrap();
        let stop_state = [stop, [0.0; 6], [0.0; 6]];
        for (found, expected) in [end.q, end.qd, end.qdd].iter().zip(stop_state) {
            assert_close("end", found, &expected, 1e-14);
        }
    }
}

#[test]
fn extrema_are_those_of_the_reference() {
    let [start, stop] = table2_ends();
    for (case, velocity) in cases() {
        let reference = reference(case, "default_quartic");
        let motion = quartic(start, velocity, stop, DURATION).unwrap();
        let (q, v, a) = (motion.position_extrema(), motion.velocity_extrema(), motion.acceleration_extrema());
        for (joint, expected) in reference["extrema"].as_array().unwrap().iter().enumerate() {
            for (key, found) in [
                ("q_max_deg", q[joint].highest),
                ("q_min_deg", q[joint].lowest),
                ("v_max_deg_s", v[joint].highest),
                ("v_min_deg_s", v[joint].lowest),
                ("a_max_deg_s2", a[joint].highest),
                ("a_min_deg_s2", a[joint].lowest),
            ] {
                let expected = expected[key].as_f64().unwrap();
                assert_close(&format!("{case} {key} {joint}"), &[found.value.to_degrees()], &[expected], 1e-12);
            }
            if let [time] = numbers(&expected["interior_stationary_times_s"])[..] {
                // Found from rounded data: a zero of the velocity is sharp to eps · v/a.
                assert!((q[joint].highest.time - time).abs() < 1e-11, "{} s, {time} s", q[joint].highest.time);
            }
        }
    }
}

#[test]
fn the_elbow_singularity_is_crossed_when_the_reference_says() {
    let arm = Irb7600::<f64>::default();
    let [start, stop] = table2_ends();
    let determinant = |q: &[f64; 6]| mbs_runtime::to_matrix(&arm.flange_jacobian(q)).determinant();
    for (case, velocity) in cases() {
        let motion = quartic(start, velocity, stop, DURATION).unwrap();
        let times: Vec<f64> = sign_changes(&motion, determinant, 1000).unwrap().collect::<Result<_, _>>().unwrap();
        let expected = numbers(&reference(case, "default_quartic")["jacobian_det_zero_crossings_s"]);
        assert_eq!(times.len(), expected.len());
        // The determinant is a sum of products that cancel: its zero is sharp to some 1e-13 s.
        assert!((times[0] - expected[0]).abs() < 1e-10, "{times:?}, {expected:?}");
        assert!((motion.at(times[0]).unwrap().q[2].to_degrees() - 98.88065915).abs() < 1e-8);
    }
}

#[test]
fn energies_are_those_of_the_reference() {
    let arm = Irb7600::<f64>::default();
    let [start, stop] = table2_ends();
    let mut spent = Vec::new();
    for (case, velocity) in cases() {
        let motion = quartic(start, velocity, stop, DURATION).unwrap();
        let energy = work::energy(&arm, &motion).unwrap();
        let expected = reference(case, "default_quartic")["integral_abs_mechanical_power_J"].as_f64().unwrap();
        assert!(energy.error < 1e-8 * energy.value, "{energy:?}");
        // The reference is a trapezoidal sum over 20 000 steps.
        assert!((energy.value / expected - 1.0).abs() < 1e-6, "{case}: {energy:?}, {expected}");
        spent.push(energy.value);

        // The motors change kinetic and potential energy by their net work, and spend no less than that.
        let net = work::net_work(&arm, &motion).unwrap();
        let total = |t| {
            let state = motion.at(t).unwrap();
            arm.kinetic_energy(&state.q, &state.qd) + arm.potential_energy(&state.q)
        };
        let gain = total(DURATION) - total(0.0);
        assert!((net.value - gain).abs() < 1e-8, "{net:?}, {gain}");
        assert!(energy.value >= gain.abs());
    }
    // The thesis says that case 2 needs more.
    assert!((spent[1] / spent[0] - 0.9961).abs() < 1e-4);
}

/// Against sums over many small steps, which know no panels.
#[test]
fn work_and_effort_are_integrals() {
    let arm = Irb7600::<f64>::default();
    let [start, stop] = table2_ends();
    let motion = two_piece_quartic(start, cases()[1].1, stop, DURATION).unwrap();
    let steps = 200_000;
    let [mut energy, mut effort] = [0.0; 2];
    for k in 0..steps {
        let state = motion.at(DURATION * (k as f64 + 0.5) / f64::from(steps)).unwrap();
        let torque = arm.inverse_dynamics(&state.q, &state.qd, &state.qdd);
        energy += torque.iter().zip(&state.qd).map(|(torque, qd)| (torque * qd).abs()).sum::<f64>();
        effort += torque.iter().map(|torque| torque * torque).sum::<f64>();
    }
    let step = DURATION / f64::from(steps);
    let (found, expected) = (work::energy(&arm, &motion).unwrap().value, energy * step);
    assert!((found / expected - 1.0).abs() < 1e-8, "{found}, {expected}");
    let (found, expected) = (work::effort(&arm, &motion).unwrap().value, effort * step);
    assert!((found / expected - 1.0).abs() < 1e-9, "{found}, {expected}");
}
