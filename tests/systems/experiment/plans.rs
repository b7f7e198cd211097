//! Plans at a scale, and the greatest of them.

use mbs_landing::experiment::error::Infeasible;
use mbs_landing::experiment::limits::AxisQuantity;
use mbs_landing::experiment::plan::{Attitude, turned_over};
use mbs_landing::experiment::search::Search;
use mbs_landing::experiment::{Experiment, flight::Flight};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_runtime::attitude::log;
use mbs_runtime::{Dop853, Integrator, to_matrix, to_rows};
use mbs_tests::compare::assert_close;
use serde_json::Value;

use crate::experiment::{flown, guided, limits_alone};

fn reference() -> Value {
    serde_json::from_str(include_str!("../../data/experiment.json")).expect("the data file is JSON")
}

fn six(value: &Value) -> [f64; 6] {
    std::array::from_fn(|i| value[i].as_f64().expect("a number"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn a_tenth_has_the_reference_values() {
    let (experiment, reference) = (guided(), reference());
    let expected = &reference["combined_scaled"];
    let plan = experiment.plan_at(0.1, number(&expected["flange_xy_m"][0])).expect("a plan");
    for (t, name) in [(0.0, "start_dh_deg"), (number(&expected["t_end_s"]), "end_dh_deg")] {
        let q = plan.axes(t).expect("reachable").q;
        assert_eq!(q[0], 23.3 - 1.6);
        let degrees: [f64; 6] = std::array::from_fn(|i| q[1 + i].to_degrees());
        assert_close(name, &degrees, &six(&expected[name]), 1e-9);
    }
    let survey = plan.survey().expect("reachable");
    assert!(survey.is_feasible(), "{:?}", survey.broken);
    // The reference is sampled more coarsely: extremes of angles to 1e-3 of a degree, of rates to 2e-3 of them.
    let speeds = six(&expected["max_joint_speed_deg_s"]);
    let (least, greatest) = (six(&expected["abb_axis_min_deg"]), six(&expected["abb_axis_max_deg"]));
    for joint in 0..6 {
        let found = survey.speeds[1 + joint].to_degrees();
        assert!((found - speeds[joint]).abs() <= 2e-3 * (1.0 + speeds[joint]), "joint {joint}: {found} °/s");
        let robot = if joint == 1 { 90.0 } else { 0.0 };
        let [from, to] = survey.positions[1 + joint].map(|angle| angle.to_degrees() + robot);
        // The last tenth of a second, which the reference leaves out, goes further.
        assert!(from - least[joint] <= 1e-3 && from >= least[joint] - 0.4, "joint {joint}: from {from}°");
        assert!(greatest[joint] - to <= 1e-3 && to <= greatest[joint] + 0.4, "joint {joint}: to {to}°");
    }
    let legs = &reference["combined_platform_scaled"];
    let [shortest, longest] = survey.leg_length;
    assert!((shortest - number(&legs["leg_length_range_m"][0])).abs() < 1e-6, "{shortest}");
    assert!((longest - number(&legs["leg_length_range_m"][1])).abs() < 1e-6, "{longest}");
    assert!((survey.platform_stroke() - number(&legs["stroke_needed_m"])).abs() < 2e-6);
}

#[test]
fn scales_are_as_feasible_as_the_reference_says() {
    let experiment = limits_alone();
    for row in reference()["combined_scaled_scan"].as_array().expect("rows") {
        let (scale, standoff) = (number(&row["scale"]), number(&row["flange_x_m"]));
        let survey = experiment.plan_at(scale, standoff).expect("a plan").survey();
        let feasible = survey.is_ok_and(|survey| survey.is_feasible());
        assert_eq!(feasible, row["feasible"].as_bool().expect("a flag"), "{row}");
    }
}

/// The tool points down in the plane of axis 1, so that `θ₅ = −(θ₂ + θ₃)`, and that triangle is solved by the law of
/// cosines.
fn greatest_wrist_angle(scale: f64, standoff: f64, height: impl Fn(f64) -> f64) -> f64 {
    let (reach, lower) = (1.075_f64, 1.056_f64.hypot(0.165));
    let forward = standoff.hypot(0.15) - 0.41;
    (0..=1325).fold(0.0, |greatest, k| {
        // The wrist is 0.25 m over the flange, axis 2 is 0.78 m over the base.
        let up = 0.6 + scale * height(f64::from(k) * 0.01) + 0.25 - 0.78;
        let distance = forward.hypot(up);
        let at_shoulder =
            ((reach * reach + distance * distance - lower * lower) / (2.0 * reach * distance)).clamp(-1.0, 1.0).acos();
        let at_elbow =
            ((reach * reach + lower * lower - distance * distance) / (2.0 * reach * lower)).clamp(-1.0, 1.0).acos();
        // Elevation of the upper arm, then of the forearm's line from axis 3 to the wrist.
        let upper_arm = up.atan2(forward) + at_shoulder;
        let forearm = upper_arm - (std::f64::consts::PI - at_elbow);
        // The forearm's own axis is bent from that line by atan(a₃/d₄); the tool hangs by what is left to the vertical.
        let bend = (forearm - 0.165_f64.atan2(1.056)) + std::f64::consts::FRAC_PI_2;
        f64::max(greatest, bend)
    })
}

#[test]
fn the_greatest_scale_is_where_the_wrist_ends() {
    let experiment = limits_alone();
    let found = experiment.greatest_scale(&Search::default()).expect("a scale");
    let (next, broken) = found.next.expect("not all of it");
    assert!(found.survey.is_feasible() && next - found.plan.scale() <= 1e-4);
    let Infeasible::Axis(violation) = broken else { panic!("{broken}") };
    assert_eq!((violation.axis, violation.quantity), (5, AxisQuantity::Position));
    assert!((violation.limit.to_degrees() - 100.0).abs() < 1e-12 && violation.value > violation.limit);

    let landing = Landing::new(Plant::Exact, Heave::CASE_I);
    let height = |t: f64| Heave::CASE_I.at(t).value + landing.approach.at(t).value;
    let best = |scale: f64| {
        (200..=400).map(|k| greatest_wrist_angle(scale, 0.005 * f64::from(k), height)).fold(f64::INFINITY, f64::min)
    };
    let (mut feasible, mut not) = (0.1, 0.13);
    for _ in 0..12 {
        let middle = 0.5 * (feasible + not);
        if best(middle).to_degrees() <= 100.0 { feasible = middle } else { not = middle }
    }
    assert!((found.plan.scale() - feasible).abs() < 1.5e-4, "{} instead of {feasible}", found.plan.scale());
}

#[test]
fn both_cases_are_feasible_at_a_tenth_and_not_at_an_eighth() {
    for heave in [Heave::CASE_I, Heave::CASE_II] {
        let experiment = flown(heave);
        let survey = experiment.plan(0.1).expect("a plan").survey().expect("reachable");
        assert!(survey.is_feasible(), "{:?}", survey.broken);
        assert!(survey.speed_ratio.value < 1.0 && survey.force_ratio.value < 1.0);
        let more = experiment.plan(0.125).expect("a plan").survey().expect("reachable");
        assert!(matches!(more.broken, Some(Infeasible::Axis(axis)) if axis.axis == 5), "{:?}", more.broken);
        // The carriage takes the horizontal motion along the rail.
        let [from, to] = survey.positions[0];
        assert!(to - from > 0.01 && survey.speeds[0] > 0.02, "{from} to {to}");
        let found = experiment.greatest_scale(&Search { step: 0.06, ..Search::default() }).expect("a scale").plan;
        assert!(found.survey().expect("reachable").is_feasible(), "{}", found.scale());
        // A hundredth more, and no stand-off is feasible, even where only every fifth moment is looked at.
        let coarse = Experiment { sampling: 0.05, ..experiment.clone() };
        for k in 0..=50 {
            let other = coarse.plan_at(1.01 * found.scale(), 1.0 + 0.02 * f64::from(k)).expect("a plan");
            assert!(
                !other.survey().is_ok_and(|survey| survey.is_feasible()),
                "{} at {}",
                other.scale(),
                other.standoff()
            );
        }
    }
}

#[test]
fn the_chosen_standoff_is_the_clearest() {
    let experiment = guided();
    let plan = experiment.plan(0.1).expect("a plan");
    let best = plan.clearance().expect("reachable");
    for k in 0..=100 {
        let other = experiment.plan_at(0.1, 1.0 + 0.01 * f64::from(k)).expect("a plan");
        assert!(other.clearance().is_ok_and(|clearance| clearance <= best + 1e-9), "{}", other.standoff());
    }
}

/// No stand-off that is left by a short rail allows more than is found.
#[test]
fn a_short_rail_leaves_the_greatest_scale() {
    let mut experiment = limits_alone();
    experiment.sampling = 0.05;
    experiment.robot.rail.range = [0.0, 21.6];
    let feasible = |scale: f64, standoff: f64| {
        experiment.plan_at(scale, standoff).expect("a plan").survey().is_ok_and(|survey| survey.is_feasible())
    };
    let found = experiment.greatest_scale(&Search::default()).expect("a scale");
    let scale = found.plan.scale();
    assert!(scale > 0.1 && feasible(0.1, 1.7), "{scale}");
    let standoff = found.plan.standoff();
    assert!((1.7 - 1e-12..=2.0).contains(&standoff), "{standoff}");
    for k in 0..=50 {
        let standoff = 1.5 + 0.01 * f64::from(k);
        assert!(!feasible(scale + 2e-4, standoff), "{standoff} m allows more than {scale}");
    }

    // The carriage is bolted down where it stands at 0.1.
    experiment.robot.rail.range = [21.836; 2];
    let plan = experiment.plan(0.1).expect("a plan");
    assert!(plan.survey().expect("reachable").is_feasible() && (plan.standoff() - 1.464).abs() < 1e-12);
    assert!(experiment.greatest_scale(&Search::default()).expect("a scale").plan.scale() >= 0.1);
    // Where it moves along the rail it is not: the carriage leaves its place.
    let mut moving = flown(Heave::CASE_II);
    moving.robot.rail.range = [21.836; 2];
    let broken = moving.plan(0.1).expect("a plan").survey().expect("reachable").broken.expect("it breaks");
    assert!(matches!(broken, Infeasible::Axis(axis) if axis.axis == 0 && axis.quantity == AxisQuantity::Position));
}

#[test]
fn standoffs_that_may_be_anything_are_those_in_reach() {
    let mut experiment = guided();
    experiment.sampling = 0.05;
    // What is nearest to its end does not depend on the stand-off there: many are equally good.
    let near = experiment.plan(0.1).and_then(|plan| plan.clearance()).expect("a plan in reach");
    for standoffs in [[-1e9, 1e9], [f64::MIN, f64::MAX], [-100.0, 3.0]] {
        let wide = Experiment { standoffs, ..experiment.clone() };
        let found = wide.plan(0.1).and_then(|plan| plan.clearance()).expect("a plan in reach");
        assert!((found - near).abs() < 1e-12, "{standoffs:?}: {found}, not {near}");
    }
    let far = Experiment { standoffs: [10.0, 1e9], ..experiment };
    let found = far.plan(0.1).expect_err("out of reach");
    assert!(matches!(found, Infeasible::Arm { time: 0.0, .. }), "{found}");
}

/// Rates and accelerations of the axes against differences of their positions; poses against the flight.
#[test]
fn the_plan_moves_as_the_flight_does() {
    let experiment = flown(Heave::CASE_II);
    let plan = experiment.plan(0.1).expect("a plan");
    let h = 1e-4;
    for t in [0.3, 0.777, 2.5, 5.001, 9.2, 13.1] {
        let [before, at, after] = [-h, 0.0, h].map(|d| plan.axes(t + d).expect("reachable"));
        let slope: [f64; 7] = std::array::from_fn(|i| (after.q[i] - before.q[i]) / (2.0 * h));
        let bend: [f64; 7] = std::array::from_fn(|i| (after.qd[i] - before.qd[i]) / (2.0 * h));
        assert_close("rates", &slope, &at.qd, 1e-6);
        assert_close("accelerations", &bend, &at.qdd, 1e-5);

        let [vehicle, ..] = experiment.flight.at(t).expect("in flight");
        let flange = experiment.robot.pose(&at.q);
        let place = [23.3 + 0.1 * (vehicle[0] - 12.0), 0.15 + 0.1 * (vehicle[1] - 7.0), 0.6 + 0.1 * vehicle[2]];
        assert_close("place", &flange.position, &place, 1e-12);
        let turn = |axis: usize, angle: f64| {
            let mut vector = nalgebra::Vector3::zeros();
            vector[axis] = angle;
            nalgebra::Rotation3::new(vector)
        };
        let attitude = turn(2, vehicle[5]) * turn(1, vehicle[4]) * turn(0, vehicle[3]);
        let apart = to_matrix(&turned_over(flange.rotation)) * attitude.matrix().transpose();
        assert!(nalgebra::Vector3::from(log(&to_rows(&apart))).norm() < 1e-12, "attitude at {t} s");
    }
}

/// Between the moments that are kept, and after the touchdown.
#[test]
fn a_flight_is_the_landing() {
    let landing = Landing::new(Plant::Exact, Heave::CASE_II);
    let flight = Flight::simulated(&landing, Landing::initial_state()).expect("a landing");
    let times = [0.0011, 0.8873, 4.001, 9.9999, 13.2, 13.31, 13.7];
    let mut compared = 0;
    Dop853::new(1e-12, 1e-13)
        .sample(
            |t, q: &[f64; 6], qd: &[f64; 6], qdd: &mut [f64; 6]| {
                *qdd = landing.accelerations(t, q, qd, &landing.command(t, q, qd).rotors.speed);
            },
            0.0,
            &times,
            &mut Landing::initial_state(),
            |t, state| {
                let [q, qd, _] = flight.at(t).expect("in flight");
                assert_close("q", &q, &state.q, 1e-9);
                assert_close("rates", &qd, &state.qd, 1e-7);
                compared += 1;
            },
        )
        .expect("it flies");
    assert_eq!(compared, times.len());
    assert!((flight.touchdown() - 13.253_187_5).abs() < 1e-5 && flight.end() > flight.touchdown() + 0.5);
}

#[test]
fn a_level_tool_needs_less_of_the_wrist() {
    let flown = flown(Heave::CASE_I);
    let level = Experiment { attitude: Attitude::Level, ..flown.clone() };
    let [flown, level] =
        [&flown, &level].map(|experiment| experiment.plan(0.1).expect("a plan").survey().expect("reachable"));
    assert!(level.speeds[5] < 0.5 * flown.speeds[5] && level.forces[5] < flown.forces[5]);
    // Axis 4 does not move at all.
    assert!(level.speeds[4] < 1e-12 && flown.speeds[4] > 0.01);
}
