//! What cannot be planned says why.

use mbs_arm::inverse::Unsolvable;
use mbs_arm::limits::InvalidLimits;
use mbs_landing::experiment::Experiment;
use mbs_landing::experiment::error::{Infeasible, PlanError};
use mbs_landing::experiment::flight::{Flight, OutsideFlight};
use mbs_landing::experiment::limits::AxisQuantity;
use mbs_landing::experiment::plan::{Attitude, BRANCH};
use mbs_landing::experiment::rail_arm::{FlangeMotion, NotFollowed, RailArm};
use mbs_landing::experiment::search::{Search, SearchError};
use mbs_landing::experiment::tracking::{Tracking, TrackingError};
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, LandingError, Plant};
use mbs_models::check::{Invalid, Must};
use mbs_models::irb7600_rail::{Irb7600Rail, Params};
use mbs_platform::Quantity;
use mbs_platform::limits::InvalidLimits as InvalidActuators;

use crate::experiment::guided;

const DOWN: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];

#[test]
fn scales_are_positive_numbers() {
    let experiment = guided();
    for scale in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let found = experiment.plan(scale).expect_err("no scale");
        let PlanError::Invalid(Invalid { parameter: "scale", value, .. }) = found else { panic!("{found}") };
        assert_eq!(value.to_bits(), scale.to_bits());
    }
    assert!(matches!(
        experiment.plan_at(0.1, f64::NAN),
        Err(PlanError::Invalid(Invalid { parameter: "standoff", .. }))
    ));
}

#[test]
fn poses_that_are_none() {
    let robot = RailArm::default();
    let nowhere = FlangeMotion::at_rest([12.0, f64::NAN, 1.0], DOWN);
    let found = robot.follow(&nowhere, 1.6, BRANCH);
    assert!(matches!(found, Err(NotFollowed::Unreachable(Unsolvable::NonFinitePosition { .. }))), "{found:?}");
    let mut skewed = FlangeMotion::at_rest([12.0, 0.1, 1.0], DOWN);
    skewed.pose.rotation[0] = [0.0; 3];
    assert!(matches!(robot.follow(&skewed, 1.6, BRANCH), Err(NotFollowed::Unreachable(_))));
    let still = FlangeMotion::at_rest([12.0, 0.1, 1.0], DOWN);
    assert!(robot.follow(&still, 1.6, BRANCH).is_ok());
    for i in 0..6 {
        let mut moving = still;
        moving.twist[i] = f64::NAN;
        assert_eq!(robot.follow(&moving, 1.6, BRANCH), Err(NotFollowed::NonFinite));
        let mut accelerated = still;
        accelerated.twist_rate[i] = f64::INFINITY;
        assert_eq!(robot.follow(&accelerated, 1.6, BRANCH), Err(NotFollowed::NonFinite));
    }
    assert!(matches!(robot.follow(&still, f64::NAN, BRANCH), Err(NotFollowed::Unreachable(_))));
    assert!(matches!(robot.follow(&still, 4.0, BRANCH), Err(NotFollowed::Unreachable(Unsolvable::TooFar { .. }))));
    // Where the forearm points straight down, so does the tool: axes 4 and 6 are in line.
    let q = [0.0, -1.3, 1.3, 0.0, 0.0, 0.0];
    let straight = mbs_arm::Arm::default().pose(&q);
    let flange = FlangeMotion::at_rest(straight.position, straight.rotation);
    let found = robot.follow(&flange, 0.0, BRANCH);
    assert!(matches!(found, Err(NotFollowed::Singular { margin }) if margin < 1e-8), "{found:?}");
}

#[test]
fn a_start_out_of_reach() {
    let mut experiment = guided();
    experiment.cell.deck = 3.0;
    let found = experiment.plan(0.1).expect_err("too high");
    let PlanError::Infeasible(Infeasible::Arm { time, reason }) = found else { panic!("{found}") };
    assert_eq!(time, 0.0);
    assert!(matches!(reason, NotFollowed::Unreachable(Unsolvable::TooFar { .. })), "{reason}");
    let found = experiment.greatest_scale(&Search::default()).expect_err("too high");
    assert!(matches!(found, SearchError::NoneFeasible { scale, .. } if scale == 0.02), "{found}");
}

#[test]
fn numbers_that_are_none_have_a_name() {
    let good = guided();
    let with = |change: fn(&mut Experiment)| {
        let mut experiment = good.clone();
        change(&mut experiment);
        experiment.plan(0.1).expect_err("something is wrong")
    };
    let named = |error: PlanError| match error {
        PlanError::Invalid(Invalid { parameter, index, must: Must::BeFinite, .. }) => (parameter, index),
        other => panic!("{other}"),
    };
    assert_eq!(named(with(|e| e.cell.deck = f64::NAN)), ("cell.deck", None));
    assert_eq!(named(with(|e| e.cell.platform[1] = f64::INFINITY)), ("cell.platform", Some(1)));
    assert_eq!(named(with(|e| e.standoffs[0] = f64::NAN)), ("standoffs", Some(0)));
    assert_eq!(named(with(|e| e.heaving = f64::NAN)), ("heaving", None));
    assert!(matches!(with(|e| e.standoffs = [2.0, 1.0]), PlanError::Standoffs { .. }));
    for sampling in [0.0, -1.0, f64::NAN, 1e-9, 0.100_1, 1.0, 1e3, f64::INFINITY] {
        let experiment = Experiment { sampling, ..good.clone() };
        assert!(matches!(experiment.plan(0.1), Err(PlanError::Sampling { .. })), "{sampling}");
    }
    assert!(matches!(
        with(|e| e.robot.joints.torque[2] = 0.0),
        PlanError::Joints(InvalidLimits::Bound { joint: 2, .. })
    ));
    assert!(matches!(
        with(|e| e.platform.limits.force = f64::NAN),
        PlanError::Actuators(InvalidActuators::Bound { .. })
    ));
    assert!(matches!(with(|e| e.robot.rail.range = [22.0, 0.0]), PlanError::Rail { .. }));
    assert!(matches!(with(|e| e.robot.rail.speed = f64::NAN), PlanError::Rail { .. }));
    for search in [
        Search { step: 0.0, ..Search::default() },
        Search { step: 1e-9, ..Search::default() },
        Search { tolerance: f64::NAN, ..Search::default() },
        Search { most: -1.0, ..Search::default() },
    ] {
        assert!(matches!(good.greatest_scale(&search), Err(SearchError::Invalid(_))), "{search:?}");
    }
}

#[test]
fn masses_are_those_of_bodies() {
    let good = guided();
    type Change = fn(&mut Params<f64>);
    let changes: [(&str, Option<usize>, Change); 11] = [
        ("carriage_mass", None, |p| p.carriage_mass = -1.0),
        ("mass", Some(0), |p| p.mass = [0.0; 6]),
        ("mass", Some(3), |p| p.mass[3] = f64::NAN),
        ("i_xx", Some(1), |p| p.i_xx[1] = -1.0),
        ("i_yy", Some(5), |p| p.i_yy[5] = f64::INFINITY),
        ("i_zz", Some(2), |p| p.i_zz[2] = 0.0),
        ("module_mass", None, |p| p.module_mass = -100.0),
        ("module_mass", None, |p| p.module_mass = f64::NAN),
        ("module_inertia", Some(1), |p| p.module_inertia[1] = -1e-3),
        ("com_y", Some(4), |p| p.com_y[4] = f64::NAN),
        ("g", None, |p| p.g = f64::INFINITY),
    ];
    let plan = good.plan_at(0.1, 1.5).expect("a plan");
    for (parameter, index, change) in changes {
        let mut params = *good.robot.model.params();
        change(&mut params);
        let mut experiment = good.clone();
        experiment.robot.model = Irb7600Rail::new(params);
        let found = experiment.plan(0.1).expect_err("no body");
        let PlanError::Invalid(Invalid { parameter: named, index: which, .. }) = found else { panic!("{found}") };
        assert_eq!((named, which), (parameter, index), "{found}");
        assert!(found.to_string().starts_with(parameter), "{found}");

        let tracking = Tracking { plant: experiment.robot.model, ..Tracking::exact(&good.robot) };
        let found = plan.track(&tracking, |_| ()).expect_err("no body");
        assert!(matches!(found, TrackingError::Invalid(wrong) if wrong.parameter == parameter), "{found}");
    }
    // Nothing at the flange.
    let mut experiment = good.clone();
    let params = Params { module_mass: 0.0, module_inertia: [0.0; 3], ..*good.robot.model.params() };
    experiment.robot.model = Irb7600Rail::new(params);
    let plan = experiment.plan(0.1).expect("a plan");
    assert!(plan.survey().expect("reachable").is_feasible());
    assert!(plan.track(&Tracking::exact(&experiment.robot), |_| ()).is_ok());
}

#[test]
fn limits_that_break_are_named() {
    let good = guided();
    let broken = |change: fn(&mut Experiment)| {
        let mut experiment = good.clone();
        change(&mut experiment);
        let survey = experiment.plan(0.1).expect("a plan").survey().expect("reachable");
        survey.broken.expect("something breaks")
    };
    let axis = |found: Infeasible| match found {
        Infeasible::Axis(violation) => (violation.axis, violation.quantity),
        other => panic!("{other}"),
    };
    assert_eq!(axis(broken(|e| e.robot.rail.range = [0.0, 5.0])), (0, AxisQuantity::Position));
    assert_eq!(axis(broken(|e| e.robot.rail.force = 1.0)), (0, AxisQuantity::Force));
    assert_eq!(axis(broken(|e| e.robot.joints.speed[2] = 0.1)), (3, AxisQuantity::Speed));
    assert_eq!(axis(broken(|e| e.robot.joints.torque[1] = 1e3)), (2, AxisQuantity::Force));
    let leg = |found: Infeasible| match found {
        Infeasible::Leg(violation) => violation.quantity,
        other => panic!("{other}"),
    };
    assert_eq!(leg(broken(|e| e.platform.limits.longest = 1.40)), Quantity::TooLong);
    assert_eq!(leg(broken(|e| e.platform.limits.speed = 0.05)), Quantity::Speed);
    assert_eq!(leg(broken(|e| e.platform.limits.force = 900.0)), Quantity::Force);
    // That it goes too low is seen after the touchdown only.
    let found = broken(|e| e.platform.limits.shortest = 1.2);
    assert_eq!(leg(found), Quantity::TooShort);
    assert!(found.time() > 13.25, "{found}");
    // Of the carriage, in a flight that moves along the rail.
    let mut experiment = crate::experiment::flown(Heave::CASE_II);
    experiment.robot.rail.acceleration = 0.1;
    let survey = experiment.plan(0.1).expect("a plan").survey().expect("reachable");
    assert_eq!(axis(survey.broken.expect("it breaks")), (0, AxisQuantity::Acceleration));
    // Of the joints where they count: an attitude that is flown needs more at once, a level one does not.
    experiment = Experiment { joint_accelerations: true, ..crate::experiment::flown(Heave::CASE_I) };
    let survey = experiment.plan(0.02).expect("a plan").survey().expect("reachable");
    let found = survey.broken.expect("it breaks");
    assert!(axis(found) == (2, AxisQuantity::Acceleration) && found.time() == 0.0, "{found}");
    experiment.attitude = Attitude::Level;
    assert!(experiment.plan(0.1).expect("a plan").survey().expect("reachable").is_feasible());
}

#[test]
fn flights_that_are_none() {
    let good = Landing::new(Plant::Exact, Heave::CASE_I);
    let with = |change: fn(&mut Landing)| {
        let mut landing = good.clone();
        change(&mut landing);
        Flight::guided(&landing).map(|flight| flight.touchdown())
    };
    assert!(matches!(
        with(|l| l.approach.sink_rate = 0.0),
        Err(LandingError::Invalid(Invalid { must: Must::BePositive, .. }))
    ));
    assert!(matches!(
        with(|l| l.approach.duration = f64::NAN),
        Err(LandingError::Invalid(Invalid { must: Must::BePositive, .. }))
    ));
    let restless = Heave { amplitude: [0.2, f64::NAN, 0.5, 0.3], ..Heave::CASE_I };
    let found = Flight::guided(&Landing::new(Plant::Exact, restless)).map(|flight| flight.touchdown());
    assert!(matches!(found, Err(LandingError::Invalid(Invalid { must: Must::BeFinite, .. }))), "{found:?}");
    assert!(matches!(with(|l| l.t_end = 5.0), Err(LandingError::NoTouchdown { .. })));
    for t_end in [0.0, f64::NAN, f64::INFINITY] {
        let found = Flight::guided(&Landing { t_end, ..good.clone() }).map(|flight| flight.touchdown());
        assert!(matches!(found, Err(LandingError::Invalid(Invalid { parameter: "t_end", .. }))), "{t_end}: {found:?}");
    }
    // It comes down, but after more moments than can be kept.
    let slow = with(|l| (l.t_end, l.approach.sink_rate) = (1e9, 2e-7));
    assert!(matches!(slow, Err(LandingError::TooManyMoments { t_end, .. }) if t_end < 1e9), "{slow:?}");
    // A late end alone is none.
    assert!(with(|l| l.t_end = 1e9).is_ok());
    let mut blind = Landing::initial_state();
    blind.q[2] = f64::NAN;
    let found = Flight::simulated(&good, blind).map(|flight| flight.touchdown());
    assert!(matches!(found, Err(LandingError::Invalid(Invalid { parameter: "q", index: Some(2), .. }))), "{found:?}");

    let flight = Flight::guided(&good).expect("a landing");
    for time in [-1e-9, 14.0, f64::NAN] {
        let Err(OutsideFlight { time: named, end }) = flight.at(time) else { panic!("{time} is outside") };
        assert!(named.to_bits() == time.to_bits() && end == flight.end());
    }
    let experiment = Experiment::new(flight);
    assert!(matches!(experiment.plan(0.1).expect("a plan").axes(20.0), Err(Infeasible::Flight(_))));

    // A vehicle below the platform.
    let mut below = good;
    below.approach.height = -1.0;
    let experiment = Experiment::new(Flight::guided(&below).expect("a flight"));
    let found = experiment.plan(0.1).expect("a plan").track(&Tracking::exact(&experiment.robot), |_| ());
    assert!(matches!(found, Err(TrackingError::NotAbove { height }) if height < 0.0), "{found:?}");
}
