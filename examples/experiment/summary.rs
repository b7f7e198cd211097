//! What an experiment comes to, as JSON and as text.

use std::fmt::Write;

use mbs_landing::experiment::landed::Standing;
use mbs_landing::experiment::plan::Attitude;
use mbs_landing::experiment::tracking::{LINK_EXCESS, MODULE_EXCESS, Tracked};
use serde_json::{Value, json};

use super::assumed;
use super::run::{Outcome, Run};

/// One object: the landing from above, and within it that from afar.
pub(crate) fn to_json(above: &Run<'_>, inbound: &Run<'_>) -> Value {
    let mut all = results(above);
    all["inbound"] = results(inbound);
    all["assumed"] = assumed::to_json();
    all
}

/// What is not known where the arm cannot follow is null.
fn results(run: &Run<'_>) -> Value {
    let of = |value: fn(&Outcome<'_>) -> Value| run.outcome.as_ref().map_or(Value::Null, value);
    let simulated = run.outcome.as_ref().and_then(|outcome| outcome.simulated.as_ref().ok());
    let tracked = |value: fn(&Tracked) -> Value| simulated.map_or(Value::Null, |simulated| value(&simulated.tracked));
    json!({
        "case": run.case.name,
        "attitude": attitude(run),
        "scale": run.scale,
        "feasible": run.broken.is_none(),
        "limit": run.broken.map(|reason| reason.to_string()),
        "next_scale": run.next.map(|(scale, _)| scale),
        "next_limit": run.next.map(|(_, reason)| reason.to_string()),
        "standoff": of(|o| o.plan.standoff().into()),
        "max_joint_speed_ratio": of(|o| o.survey.speed_ratio.value.into()),
        "max_torque_ratio": of(|o| o.survey.force_ratio.value.into()),
        "max_joint_acceleration_ratio": of(|o| o.survey.acceleration_ratio.value.into()),
        "drive_ratio_max": tracked(|t| t.force_ratio.value.into()),
        "singularity_margin": of(|o| o.survey.singularity_margin.value.into()),
        "joint_range_deg": of(|o| json!(o.survey.positions[1..].iter().map(|ends| ends.map(f64::to_degrees)).collect::<Vec<_>>())),
        "max_joint_speed_deg_s": of(|o| json!(o.survey.speeds[1..].iter().map(|speed| speed.to_degrees()).collect::<Vec<_>>())),
        "max_joint_torque": of(|o| json!(o.survey.forces[1..])),
        "carriage": of(|o| json!({
            "range": o.survey.positions[0],
            "speed": o.survey.speeds[0],
            "acceleration": o.survey.accelerations[0],
            "force": o.survey.forces[0],
        })),
        "platform": of(|o| json!({
            "stroke": o.survey.platform_stroke(),
            "leg_length": o.survey.leg_length,
            "leg_speed": o.survey.leg_speed,
            "leg_force": o.survey.leg_force,
        })),
        "tracking_error_max": tracked(|t| t.error.value.into()),
        "tracking_turn_max_deg": tracked(|t| t.turn.value.to_degrees().into()),
        "saturated": tracked(|t| t.saturated.into()),
        "simulation_error": of(|o| o.simulated.as_ref().err().map(ToString::to_string).into()),
        "touchdown_time": tracked(|t| t.contact.time.into()),
        "planned_touchdown_time": run.experiment.flight.touchdown(),
        "relative_position": tracked(|t| json!(t.contact.position)),
        "relative_velocity": tracked(|t| json!(t.contact.velocity)),
        "relative_attitude_deg": tracked(|t| json!(t.contact.attitude.map(f64::to_degrees))),
        "relative_angular_velocity_deg_s": tracked(|t| json!(t.contact.angular_velocity.map(f64::to_degrees))),
        "contact": of(|o| o.landed.as_ref().map_or(Value::Null, |touched| standing(&touched.standing))),
        "contact_error": of(|o| o.landed.as_ref().err().map(ToString::to_string).into()),
        "nearest": of(|o| json!({
            "distance": o.survey.distance.value,
            "time": o.survey.distance.time,
            "between": o.survey.nearest.map(|body| body.to_string()),
        })),
    })
}

fn standing(of: &Standing) -> Value {
    json!({
        "time": of.time,
        "force_max": of.force.value,
        "force_max_time": of.force.time,
        "force_at_rest": of.resting,
        "rebounds": of.rebounds,
        "slid": of.slid,
        "platform_error": { "before": of.platform_error[0], "after": of.platform_error[1] },
        "leg_force": { "before": of.leg_force[0], "after": of.leg_force[1] },
    })
}

fn attitude(run: &Run<'_>) -> &'static str {
    match run.attitude {
        Attitude::Flown => "flown",
        Attitude::Level => "level",
    }
}

pub(crate) fn text(above: &Run<'_>, inbound: &Run<'_>) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write(&mut text, above);
    text += "\nfrom afar along the rail, accelerations of the joints count:\n";
    let _ = write(&mut text, inbound);
    text + &assumed::text()
}

fn write(text: &mut String, run: &Run<'_>) -> std::fmt::Result {
    let verdict = if run.broken.is_none() { "feasible" } else { "not feasible" };
    writeln!(text, "case {}, attitude {}: the scale {:.5} is {verdict}", run.case.name, attitude(run), run.scale)?;
    if let Some(reason) = run.broken {
        writeln!(text, "  {reason}")?;
    }
    if let Some((scale, reason)) = run.next {
        writeln!(text, "  at {scale:.5} it is not: {reason}")?;
    }
    let Some(Outcome { plan, survey, simulated, landed }) = &run.outcome else { return Ok(()) };
    writeln!(text, "the carriage stays {:.3} m behind the flange", plan.standoff())?;
    writeln!(text, "axis         from        to          speed      force          of its limit")?;
    let robot = &run.experiment.robot;
    let (speeds, forces) = (robot.speed_limits(), robot.force_limits());
    for axis in 0..7 {
        let [from, to] = survey.positions[axis];
        let (speed, force) = (survey.speeds[axis], survey.forces[axis]);
        let parts = format!("{:>5.1} %, {:>5.1} %", 100.0 * speed / speeds[axis], 100.0 * force / forces[axis]);
        match axis {
            0 => writeln!(text, "carriage {from:>9.3} m {to:>9.3} m {speed:>8.3} m/s {force:>9.1} N     {parts}")?,
            joint => writeln!(
                text,
                "joint {joint}  {:>9.2} ° {:>9.2} ° {:>8.2} °/s {force:>9.1} N·m   {parts}",
                from.to_degrees(),
                to.to_degrees(),
                speed.to_degrees()
            )?,
        }
    }
    let counts = if run.experiment.joint_accelerations { "count" } else { "do not count" };
    writeln!(
        text,
        "accelerations are up to {:.2} of those assumed for the joints, which {counts}; of the distances from singularities of \
         shoulder, elbow and wrist the smallest is {:.3} of the largest possible",
        survey.acceleration_ratio.value, survey.singularity_margin.value
    )?;
    writeln!(
        text,
        "{} and {} come nearest to each other, {:.3} m (t = {:.2} s)",
        survey.nearest[0], survey.nearest[1], survey.distance.value, survey.distance.time
    )?;
    writeln!(
        text,
        "platform: legs {:.4} to {:.4} m, a stroke of {:.4} m, {:.3} m/s, {:.0} N",
        survey.leg_length[0],
        survey.leg_length[1],
        survey.platform_stroke(),
        survey.leg_speed,
        survey.leg_force
    )?;
    let heavier = format!(
        "simulated, links {:.0} % and vehicle {:.0} % heavier than the controller knows",
        100.0 * LINK_EXCESS,
        100.0 * MODULE_EXCESS
    );
    let tracked = match simulated {
        Ok(simulated) => &simulated.tracked,
        Err(error) => return writeln!(text, "{heavier}: {error}"),
    };
    let contact = &tracked.contact;
    writeln!(
        text,
        "{heavier}: the flange is off by up to {:.3} mm (t = {:.2} s) and {:.4}°, drives give up to {:.1} % of their limits",
        1e3 * tracked.error.value,
        tracked.error.time,
        tracked.turn.value.to_degrees(),
        100.0 * tracked.force_ratio.value
    )?;
    let [x, y, _] = contact.position.map(|metres| 1e3 * metres);
    let [vx, vy, vz] = contact.velocity.map(|speed| 1e3 * speed);
    writeln!(
        text,
        "contact at {:.4} s (the vehicle's: {:.4} s), {x:.3} and {y:.3} mm from the middle, with {vx:.3}, {vy:.3}, {vz:.3} mm/s",
        contact.time,
        run.experiment.flight.touchdown()
    )?;
    let standing = match landed {
        Ok(touched) => &touched.standing,
        Err(error) => return writeln!(text, "no contact with the platform's own dynamics: {error}"),
    };
    let [before, after] = standing.platform_error.map(|metres| 1e3 * metres);
    writeln!(
        text,
        "on the platform that its legs drive: a foot touches at {:.3} s, up to {:.0} N on the deck, {:.0} N at rest, {} rebounds, \
         slides {:.2} mm; the platform is off by up to {before:.3} mm before and {after:.3} mm after, a leg gives up to {:.0} and {:.0} N",
        standing.time,
        standing.force.value,
        standing.resting,
        standing.rebounds,
        1e3 * standing.slid,
        standing.leg_force[0],
        standing.leg_force[1]
    )
}

#[cfg(test)]
mod tests {
    use mbs_landing::experiment::Experiment;
    use mbs_landing::experiment::flight::Flight;
    use mbs_landing::quadrotor::heave::Heave;
    use mbs_landing::quadrotor::landing::{Landing, Plant};

    use super::super::run::Case;
    use super::*;

    #[test]
    fn a_simulation_that_fails_says_why() {
        // A flight below the platform: the arm can follow, and there is nothing to come down to.
        let mut landing = Landing::new(Plant::Exact, Heave::CASE_I);
        landing.approach.height = -1.0;
        let experiment = Experiment::new(Flight::guided(&landing).expect("a flight"));
        let case = Case { name: "I", heave: Heave::CASE_I };
        let run = Run::of(&experiment, case, Some(0.1)).expect("a plan");
        let found = results(&run);
        let reason = found["simulation_error"].as_str().expect("a reason");
        let begun = reason.strip_prefix("height over the deck at the beginning must be more than 0, it is ");
        let height: f64 = begun.expect(reason).parse().expect("a number");
        assert!((height + 0.1).abs() < 1e-12, "{reason}");
        assert!(found["max_torque_ratio"].is_number() && found["drive_ratio_max"].is_null());
        assert!(text(&run, &run).contains(&format!("heavier than the controller knows: {reason}")));
    }
}
