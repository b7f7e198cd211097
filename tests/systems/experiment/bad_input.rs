//! What cannot be planned says why.

use mbs_landing::experiment::Experiment;
use mbs_landing::experiment::error::Infeasible;
use mbs_landing::experiment::flight::Flight;
use mbs_landing::experiment::limits::AxisQuantity;
use mbs_landing::experiment::plan::{Attitude, BRANCH};
use mbs_landing::experiment::rail_arm::{FlangeMotion, RailArm};
use mbs_landing::experiment::search::Search;
use mbs_landing::experiment::tracking::Tracking;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{HEIGHT, Landing, Plant};
use mbs_models::check::{Invalid, Must};
use mbs_models::irb7600_rail::{Irb7600Rail, Params};
use mbs_models::{Error, Failure};
use mbs_platform::Quantity;

use crate::experiment::guided;

const DOWN: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];

/// The number that is refused.
#[track_caller]
fn number(found: Infeasible) -> Invalid {
    let Infeasible::Refused(error) = found else { panic!("{found}") };
    error.invalid().unwrap_or_else(|| panic!("{error}"))
}

#[test]
fn scales_are_positive_numbers() {
    let experiment = guided();
    for scale in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let found = number(experiment.plan(scale).expect_err("no scale"));
        assert_eq!((found.parameter, found.value.to_bits()), ("scale", scale.to_bits()));
    }
    assert_eq!(number(experiment.plan_at(0.1, f64::NAN).expect_err("no standoff")).parameter, "standoff");
}

#[test]
fn poses_that_are_none() {
    let robot = RailArm::default();
    let nowhere = FlangeMotion::at_rest([12.0, f64::NAN, 1.0], DOWN);
    let refused = |flange: &FlangeMotion, standoff| robot.follow(flange, standoff, BRANCH).expect_err("not followed");
    let named = |error: Error| error.invalid().expect("a number").parameter;
    assert_eq!(named(refused(&nowhere, 1.6)), "position");
    let mut skewed = FlangeMotion::at_rest([12.0, 0.1, 1.0], DOWN);
    skewed.pose.rotation[0] = [0.0; 3];
    assert!(matches!(refused(&skewed, 1.6).failure, Failure::Rotation(_)));
    let still = FlangeMotion::at_rest([12.0, 0.1, 1.0], DOWN);
    assert!(robot.follow(&still, 1.6, BRANCH).is_ok());
    for i in 0..6 {
        let mut moving = still;
        moving.twist[i] = f64::NAN;
        assert!(matches!(refused(&moving, 1.6).failure, Failure::NotFinite(_)));
        let mut accelerated = still;
        accelerated.twist_rate[i] = f64::INFINITY;
        assert!(matches!(refused(&accelerated, 1.6).failure, Failure::NotFinite(_)));
    }
    assert_eq!(named(refused(&still, f64::NAN)), "position");
    assert!(matches!(refused(&still, 4.0).failure, Failure::TooFar { .. }));
    // Where the forearm points straight down, so does the tool: axes 4 and 6 are in line.
    let q = [0.0, -1.3, 1.3, 0.0, 0.0, 0.0];
    let straight = mbs_arm::Arm::default().pose(&q);
    let flange = FlangeMotion::at_rest(straight.position, straight.rotation);
    let found = refused(&flange, 0.0);
    assert!(matches!(found.failure, Failure::Singular { smallest, .. } if smallest < 1e-8), "{found}");
}

#[test]
fn a_start_out_of_reach() {
    let mut experiment = guided();
    experiment.cell.deck = 3.0;
    let found = experiment.plan(0.1).expect_err("too high");
    let Infeasible::Arm { time, reason } = found else { panic!("{found}") };
    assert_eq!(time, 0.0);
    assert!(matches!(reason.failure, Failure::TooFar { .. }), "{reason}");
    let found = experiment.greatest_scale(&Search::default()).expect_err("too high");
    assert!(matches!(found, Infeasible::Arm { time: 0.0, .. }), "{found}");
}

#[test]
fn numbers_that_are_none_have_a_name() {
    let good = guided();
    let with = |change: fn(&mut Experiment)| {
        let mut experiment = good.clone();
        change(&mut experiment);
        experiment.plan(0.1).expect_err("something is wrong")
    };
    let named = |found: Infeasible| {
        let Invalid { parameter, index, .. } = number(found);
        (parameter, index)
    };
    assert_eq!(named(with(|e| e.cell.deck = f64::NAN)), ("cell.deck", None));
    assert_eq!(named(with(|e| e.cell.platform[1] = f64::INFINITY)), ("cell.platform", Some(1)));
    assert_eq!(named(with(|e| e.standoffs[0] = f64::NAN)), ("standoffs", Some(0)));
    assert_eq!(named(with(|e| e.heaving = f64::NAN)), ("heaving", None));
    assert_eq!(named(with(|e| e.standoffs = [2.0, 1.0])), ("greatest standoff", None));
    for sampling in [0.0, -1.0, f64::NAN, 1e-9, 0.100_1, 1.0, 1e3, f64::INFINITY] {
        let experiment = Experiment { sampling, ..good.clone() };
        let (named, _) = named(experiment.plan(0.1).expect_err("no sampling"));
        assert!(["sampling", "number of moments"].contains(&named), "{sampling}: {named}");
    }
    assert_eq!(named(with(|e| e.robot.joints.torque[2] = 0.0)), ("largest torque of joint", Some(2)));
    assert_eq!(named(with(|e| e.platform.limits.force = f64::NAN)), ("largest force", None));
    assert_eq!(named(with(|e| e.robot.rail.range = [22.0, 0.0])), ("end of the rail", None));
    assert_eq!(named(with(|e| e.robot.rail.speed = f64::NAN)), ("largest speed on the rail", None));
    for (search, parameter) in [
        (Search { step: 0.0, ..Search::default() }, "step"),
        (Search { step: 1e-9, ..Search::default() }, "number of steps"),
        (Search { tolerance: f64::NAN, ..Search::default() }, "tolerance"),
        (Search { most: -1.0, ..Search::default() }, "most"),
    ] {
        assert_eq!(named(good.greatest_scale(&search).expect_err("no search")), (parameter, None));
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
        let named = number(found);
        assert_eq!((named.parameter, named.index), (parameter, index), "{found}");
        assert!(found.to_string().starts_with(parameter), "{found}");

        let tracking = Tracking { plant: experiment.robot.model, ..Tracking::exact(&good.robot) };
        let found = plan.track(&tracking, |_| ()).expect_err("no body");
        assert_eq!(number(found).parameter, parameter);
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
    assert!(matches!(found, Infeasible::Leg(violation) if violation.time > 13.25), "{found}");
    // Of the carriage, in a flight that moves along the rail.
    let mut experiment = crate::experiment::flown(Heave::CASE_II);
    experiment.robot.rail.acceleration = 0.1;
    let survey = experiment.plan(0.1).expect("a plan").survey().expect("reachable");
    assert_eq!(axis(survey.broken.expect("it breaks")), (0, AxisQuantity::Acceleration));
    // Of the joints where they count: an attitude that is flown needs more at once, a level one does not.
    experiment = Experiment { joint_accelerations: true, ..crate::experiment::flown(Heave::CASE_I) };
    let survey = experiment.plan(0.02).expect("a plan").survey().expect("reachable");
    let found = survey.broken.expect("it breaks");
    assert!(axis(found) == (2, AxisQuantity::Acceleration) && found.to_string().starts_with("t = 0.000 s"), "{found}");
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
    let named = |found: Result<f64, Error>| {
        let Invalid { parameter, must, .. } = found.expect_err("no flight").invalid().expect("a number");
        (parameter, must)
    };
    assert_eq!(named(with(|l| l.approach.sink_rate = 0.0)), ("approach.sink_rate", Must::BePositive));
    assert_eq!(named(with(|l| l.approach.duration = f64::NAN)), ("approach.duration", Must::BePositive));
    let restless = Heave { amplitude: [0.2, f64::NAN, 0.5, 0.3], ..Heave::CASE_I };
    let found = Flight::guided(&Landing::new(Plant::Exact, restless)).map(|flight| flight.touchdown());
    assert!(matches!(found.as_ref().unwrap_err().invalid(), Some(Invalid { must: Must::BeFinite, .. })), "{found:?}");
    assert!(matches!(with(|l| l.t_end = 5.0), Err(Error { failure: Failure::NoContact { .. }, .. })));
    for t_end in [0.0, f64::NAN, f64::INFINITY] {
        let found = Flight::guided(&Landing { t_end, ..good.clone() }).map(|flight| flight.touchdown());
        assert!(
            matches!(found.as_ref().unwrap_err().invalid(), Some(Invalid { parameter: "t_end", .. })),
            "{t_end}: {found:?}"
        );
    }
    // It comes down, but after more moments than can be kept.
    let slow = with(|l| (l.t_end, l.approach.sink_rate) = (1e9, 2e-7));
    assert_eq!(named(slow).0, "number of moments");
    // A late end alone is none.
    assert!(with(|l| l.t_end = 1e9).is_ok());
    let mut blind = Landing::initial_state();
    blind.q[2] = f64::NAN;
    let found = Flight::simulated(&good, blind).map(|flight| flight.touchdown());
    assert!(
        matches!(found.as_ref().unwrap_err().invalid(), Some(Invalid { parameter: "q", index: Some(2), .. })),
        "{found:?}"
    );

    let flight = Flight::guided(&good).expect("a landing");
    for time in [-1e-9, 14.0, f64::NAN] {
        let Err(Invalid { value, must, .. }) = flight.at(time) else { panic!("{time} is outside") };
        assert!(value.to_bits() == time.to_bits() && must == Must::BeWithin([0.0, flight.end()]));
    }
    let experiment = Experiment::new(flight);
    assert_eq!(number(experiment.plan(0.1).expect("a plan").axes(20.0).expect_err("outside")).parameter, "time");

    // A vehicle below the platform.
    let mut below = good;
    below.approach.height = -1.0;
    let experiment = Experiment::new(Flight::guided(&below).expect("a flight"));
    let found = experiment.plan(0.1).expect("a plan").track(&Tracking::exact(&experiment.robot), |_| ());
    let wrong = number(found.expect_err("below"));
    assert!(wrong.parameter == HEIGHT && wrong.value < 0.0, "{wrong}");
}
