//! The arm under its controller.

use mbs_landing::experiment::error::Infeasible;
use mbs_landing::experiment::plan::Experiment;
use mbs_landing::experiment::tracking::{Look, Tracking};
use mbs_landing::quadrotor::heave::Heave;
use mbs_models::irb7600_rail::Irb7600Rail;
use mbs_tests::compare::assert_close;
use nalgebra::{Matrix6, SMatrix, SVector};

use crate::experiment::{flown, guided, limits_alone};

#[test]
fn with_the_right_masses_only_the_period_is_left() {
    let experiment = guided();
    let plan = experiment.plan(0.1).expect("a plan");
    let errors = [0.008, 0.004, 0.002].map(|period| {
        let tracking = Tracking { period, ..Tracking::exact(&experiment.robot) };
        let tracked = plan.track(&tracking, |_| ()).expect("a contact");
        assert_eq!(tracked.saturated, 0.0);
        assert!((tracked.contact.time - 13.25).abs() < 1e-3, "{}", tracked.contact.time);
        tracked.error.value
    });
    // Held forces lag by half a period: an error of first order in it.
    assert!(errors[2] < 1e-5 && errors[0] < 1e-4, "{errors:?}");
    for two in errors.windows(2) {
        assert!((1.6..2.6).contains(&(two[0] / two[1])), "{errors:?}");
    }
}

/// What is heavier than known hangs lower: `M(q) ω² e = G(q) of the plant − G(q) of the model`, where the arm is slow.
#[test]
fn the_error_is_that_of_the_masses() {
    let experiment = guided();
    let plan = experiment.plan(0.1).expect("a plan");
    let tracking = Tracking::new(&experiment.robot);
    let mut last: Option<Look> = None;
    let mut least = f64::INFINITY;
    let tracked = plan
        .track(&tracking, |look| {
            last = Some(*look);
            least = least.min(look.error);
        })
        .expect("a contact");
    let look = last.expect("it looks");
    let (model, q) = (&experiment.robot.model, &look.state.q);
    let mass = SMatrix::<f64, 7, 7>::from_fn(|i, j| model.mass_matrix(q)[i][j]);
    let excess = SVector::<f64, 7>::from(tracking.plant.gravity(q)) - SVector::from(model.gravity(q));
    let sag = mass.lu().solve(&excess).expect("a mass matrix") / tracking.natural_frequency.powi(2);
    let jacobian = model.flange_jacobian(q);
    let moved: [f64; 3] = [0, 1, 2].map(|i| (0..7).map(|j| jacobian[i][j] * sag[j]).sum());
    let predicted = moved.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((look.error - predicted).abs() < 0.05 * predicted, "{} instead of {predicted}", look.error);
    assert!(tracked.error.value >= look.error && tracked.error.value < 2e-3 && least < 1e-5);
    // The flange is low, so that it touches down early, by its error over the speed at which it comes.
    let early = 13.25 - tracked.contact.time;
    assert!((early - moved[2] / 0.02).abs() < 0.1 * early, "{early} s, {} m", moved[2]);
}

#[test]
fn the_contact_is_where_flange_and_deck_meet() {
    for (heave, scale) in [(Heave::CASE_I, 0.1), (Heave::CASE_II, 0.12)] {
        let experiment = flown(heave);
        let plan = experiment.plan(scale).expect("a plan");
        let tracking = Tracking::new(&experiment.robot);
        let mut heights = Vec::new();
        let tracked = plan
            .track(&tracking, |look| {
                let z = tracking.plant.flange(&look.state.q).position[2];
                heights.push(z - 0.6 - scale * heave.at(look.time).value);
            })
            .expect("a contact");
        let contact = tracked.contact;
        let pose = tracking.plant.flange(&contact.state.q);
        let velocity = tracking.plant.flange_velocity(&contact.state.q, &contact.state.qd);
        let deck = heave.at(contact.time);
        assert!((pose.position[2] - 0.6 - scale * deck.value).abs() < 1e-9, "{:e}", contact.position[2]);
        let place = [pose.position[0] - 23.3, pose.position[1] - 0.15, 0.0];
        assert_close("place", &contact.position, &place, 1e-9);
        assert_close(
            "velocity",
            &contact.velocity,
            &[velocity[0], velocity[1], velocity[2] - scale * deck.rate],
            1e-12,
        );
        // It is over the deck all the way, and comes down with the scaled speed of the vehicle.
        assert!(heights.iter().all(|&height| height > 0.0), "it touches down before");
        assert!((contact.velocity[2] + 0.2 * scale).abs() < 0.02 * scale, "{}", contact.velocity[2]);
        assert!(contact.attitude.iter().all(|angle| angle.abs() < 2e-3), "{:?}", contact.attitude);
        assert!(tracked.force_ratio.value < 1.0 && tracked.saturated == 0.0);
    }
}

#[test]
fn weak_drives_saturate_and_fall_behind() {
    let mut experiment = limits_alone();
    let reference = experiment.plan(0.1).expect("a plan").track(&Tracking::new(&experiment.robot), |_| ());
    let needed = reference.expect("a contact").force_ratio.value;
    // A little less than joint 2 or 3 needs at its worst.
    for torque in &mut experiment.robot.joints.torque {
        *torque *= 0.995 * needed;
    }
    let tracked = experiment.plan(0.1).expect("a plan").track(&Tracking::new(&experiment.robot), |_| ());
    let tracked = tracked.expect("a contact");
    assert!(tracked.saturated > 0.0 && tracked.force_ratio.value == 1.0 && tracked.error.value > 2e-3, "{tracked:?}");
}

#[test]
fn what_cannot_be_tracked_says_why() {
    let experiment = guided();
    let plan = experiment.plan(0.1).expect("a plan");
    let exact = Tracking::exact(&experiment.robot);
    for natural_frequency in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let found = plan.track(&Tracking { natural_frequency, ..exact.clone() }, |_| ());
        let found = found.expect_err("no frequency");
        assert!(found.to_string().starts_with("natural_frequency must be"), "{found}");
    }
    for period in [0.0, -1.0, f64::NAN, 1e-9] {
        let found = plan.track(&Tracking { period, ..exact.clone() }, |_| ());
        let Err(Infeasible::Refused(error)) = found else { panic!("{found:?}") };
        assert!(
            error.invalid().is_some_and(|wrong| ["period", "number of looks"].contains(&wrong.parameter)),
            "{error}"
        );
    }
    // Without weight the arm is carried too high, and does not come down in time.
    let params = mbs_models::irb7600_rail::Params { g: 0.0, ..*experiment.robot.model.params() };
    let light = Tracking { plant: Irb7600Rail::new(params), ..exact };
    let found = plan.track(&light, |_| ());
    assert!(matches!(found, Err(Infeasible::NoContact { height, .. }) if height > 0.01), "{found:?}");
}

/// The singular values of the arm's Jacobian vanish with its margin.
#[test]
fn the_margin_is_one_from_singularities() {
    let experiment: Experiment = guided();
    let survey = experiment.plan(0.1).expect("a plan").survey().expect("reachable");
    let plan = experiment.plan(0.1).expect("a plan");
    let axes = plan.axes(survey.singularity_margin.time).expect("reachable");
    let jacobian = experiment.robot.model.flange_jacobian(&axes.q);
    let arm = Matrix6::from_fn(|i, j| jacobian[i][1 + j]);
    let margin = survey.singularity_margin.value;
    // The wrist is nearest: the margin is |sin θ₅|.
    assert!((margin - axes.q[5].sin().abs()).abs() < 1e-12, "{margin}");
    assert!(arm.singular_values()[5] > 0.1 * margin);
}
