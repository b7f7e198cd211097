//! Arm and platform through the contact: statics by hand, the impact's direction, and what is refused.

use mbs_landing::experiment::Experiment;
use mbs_landing::experiment::collision::{Body, Shapes};
use mbs_landing::experiment::error::Infeasible;
use mbs_landing::experiment::flight::Flight;
use mbs_landing::experiment::inbound::Inbound;
use mbs_landing::experiment::landed::{Landed, Meeting};
use mbs_landing::experiment::tracking::Tracking;
use mbs_landing::quadrotor::gear::Gear;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};
use mbs_runtime::to_matrix;
use nalgebra::Vector6;

use crate::experiment::guided;

/// A deck that does not heave, and an arm that is as its controller knows it.
fn still() -> Experiment {
    let landing = Landing::new(Plant::Exact, Heave { amplitude: [0.0; 4], frequency: [1.0; 4] });
    Experiment::new(Flight::guided(&landing).expect("a landing"))
}

/// The deck carries the vehicle's weight, m g, and is pressed down by m g/(M_zz ω²) against a controller without an
/// integral; its legs carry their platform and the vehicle.
#[test]
fn a_vehicle_at_rest_weighs_on_the_legs() {
    let experiment = still();
    let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
    let exact = Landed::new(Tracking::exact(&experiment.robot));
    // Hardly any spring that would share the load, and enough time for its damping.
    let landed = Landed { soft_frequency: 0.02, after: 6.0, ..exact };
    let mut last: Option<Meeting> = None;
    let standing = plan.land(&landed, 12.5, |meeting| last = Some(*meeting)).expect("a contact");
    let weight = experiment.robot.model.params().module_mass * experiment.robot.model.params().g;
    assert!((standing.resting / weight - 1.0).abs() < 2e-3, "{} N, {weight} N", standing.resting);
    assert_eq!(standing.rebounds, 0);
    assert!(standing.force.value > weight && standing.slid < 1e-3, "{standing:?}");

    let last = last.expect("looks");
    let (platform, q) = (&experiment.platform, last.platform.q);
    let mass = platform.model().mass_matrix(&q)[2][2];
    let sag = last.load / (mass * landed.platform_frequency.powi(2));
    assert!((last.platform_error / sag - 1.0).abs() < 2e-3, "{} m, {sag} m", last.platform_error);
    let jacobian = to_matrix(&platform.coordinate_jacobian(&q).expect("a pose"));
    let held: Vector6<f64> = jacobian.tr_mul(&Vector6::from(last.legs));
    let carried = held[2] - platform.model().gravity(&q)[2];
    assert!((carried / last.load - 1.0).abs() < 2e-3, "{carried} N, {} N", last.load);
}

/// With a platform that follows exactly the flange comes down when the plan without a platform's dynamics says: feet
/// and mass centre are in one plane, and the tool points down.
#[test]
fn the_contact_is_that_of_the_plan() {
    let experiment = guided();
    let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
    let tracking = Tracking::exact(&experiment.robot);
    let planned = plan.track(&tracking, |_| ()).expect("a contact").contact.time;
    let mut stands = None;
    let standing = plan
        .land(&Landed::new(tracking), 12.0, |meeting| {
            if meeting.stands && stands.is_none() {
                stands = Some(meeting.time);
            }
        })
        .expect("a contact");
    assert!((standing.time - planned).abs() < 0.012, "{} s, {planned} s", standing.time);
    // The arm feels it a little later than the first touch, whose force is below the threshold.
    assert!(stands.is_some_and(|stands| (0.0..0.05).contains(&(stands - standing.time))), "{stands:?}");
    let [before, after] = standing.leg_force;
    assert!(after > before && standing.platform_error[0] < 1e-4, "{standing:?}");
}

/// Stiffer feet are hit harder; without friction the vehicle is not held.
#[test]
fn feet_make_the_difference() {
    let experiment = guided();
    let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
    let landed = Landed { after: 1.0, ..Landed::new(Tracking::new(&experiment.robot)) };
    let with = |gear: Gear| plan.land(&Landed { gear, ..landed.clone() }, 12.5, |_| ()).expect("a contact");
    let (soft, stiff) = (with(landed.gear), with(Gear { stiffness: 1e6, ..landed.gear }));
    assert!(stiff.force.value > soft.force.value, "{stiff:?} {soft:?}");
    let (held, free) = (soft, with(Gear { friction: 0.0, ..landed.gear }));
    assert!(free.slid > held.slid, "{free:?} {held:?}");
}

#[test]
fn numbers_that_are_none_are_refused() {
    let experiment = guided();
    let plan = experiment.plan_at(0.1, 1.5).expect("a plan");
    let good = Landed { after: 0.1, ..Landed::new(Tracking::new(&experiment.robot)) };
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let gear = good.gear;
        let bad = [
            Landed { gear: Gear { stiffness: value, ..gear }, ..good.clone() },
            Landed { gear: Gear { half_track: value, ..gear }, ..good.clone() },
            Landed { gear: Gear { creep_speed: value, ..gear }, ..good.clone() },
            Landed { threshold: value, ..good.clone() },
            Landed { after: value, ..good.clone() },
            Landed { soft_frequency: value, ..good.clone() },
            Landed { platform_frequency: value, ..good.clone() },
        ];
        for landed in bad {
            let error = plan.land(&landed, 12.5, |_| ()).expect_err("refused");
            assert!(matches!(error, Infeasible::Refused(error) if error.invalid().is_some()), "{error}");
        }
    }
    let outside = plan.land(&good, 20.0, |_| ()).expect_err("after the flight");
    assert!(
        matches!(outside, Infeasible::Refused(error) if error.invalid().is_some_and(|wrong| wrong.parameter == "time")),
        "{outside}"
    );
}

/// Thicker bodies break what was feasible, with their names; a way that takes no time is none.
#[test]
fn bodies_that_overlap_are_named() {
    let mut experiment = guided();
    assert!(experiment.plan(0.08).expect("a plan").survey().expect("a survey").is_feasible());
    experiment.shapes = Shapes { vehicle: [0.75, 0.3], ..Shapes::LABORATORY };
    let survey = experiment.plan(0.08).expect("a plan").survey().expect("a survey");
    let broken = survey.broken.expect("they overlap").to_string();
    assert!(broken.contains("the forearm and the vehicle are -0."), "{broken}");
    assert!(survey.distance.value < 0.0 && survey.nearest == [Body::Forearm, Body::Vehicle]);
    experiment.shapes.leg = f64::NAN;
    assert!(experiment.plan(0.08).expect_err("refused").to_string().contains("shapes"));

    for duration in [0.0, f64::NAN, f64::INFINITY] {
        let landing = Landing::on(Plant::Exact, Inbound { duration, ..Inbound::LABORATORY });
        assert!(Flight::inbound(&landing).expect_err("refused").to_string().contains("duration"));
    }
}

/// From afar the carriage moves by metres, in less than the accelerations that joints are assumed to have.
#[test]
fn a_landing_from_afar_takes_the_carriage_metres() {
    let landing = Landing::on(Plant::Exact, Inbound::LABORATORY);
    let flight = Flight::inbound(&landing).expect("a landing");
    let experiment = Experiment { joint_accelerations: true, sampling: 0.05, ..Experiment::new(flight) };
    let survey = experiment.plan(0.07).expect("a plan").survey().expect("a survey");
    assert!(survey.is_feasible(), "{:?}", survey.broken);
    let [from, to] = survey.positions[0];
    // 40 m at full size, and by how much the vehicle overshoots.
    assert!((to - from - 2.8).abs() < 0.1, "{from} to {to}");
    assert!(survey.acceleration_ratio.value < 1.0);
}
