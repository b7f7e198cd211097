//! What came of it, as text and as JSON.

use std::fmt::Write as _;

use mbs_runtime::control::{BaseParameters, BodyParameters};
use serde_json::{Value, json};

use crate::arm::{self, PAYLOAD_MASS, RANK_TOLERANCE, torque_ratio};
use crate::quadrotor::{self, Flight};
use crate::run::{Errors, LyapunovCheck, Run};

/// The quadrotor's four numbers.
pub(crate) const VEHICLE: [&str; 4] = ["m", "I_xx", "I_yy", "I_zz"];

pub(crate) fn to_json(arm: &arm::Study, quadrotor: &quadrotor::Study) -> Value {
    let [table_2, sines] = &arm.payload;
    let flights = quadrotor.flights.iter().map(|flight| (flight.reference.to_string(), flown(quadrotor, flight)));
    json!({
        "arm": {
            "payload_mass": PAYLOAD_MASS,
            "base_parameters": base(&arm.base, &arm.truth),
            "payload": {
                table_2.motion: compared(table_2),
                sines.motion: compared(sines),
            },
            "all_links": compared(&arm.links),
        },
        "quadrotor": flights.collect::<Value>(),
    })
}

/// The name of one of the arm's numbers: of a link counted from 1, or of the last one.
fn name<const P: usize>(k: usize) -> String {
    let link = if P == 10 { 6 } else { 1 + k / 10 };
    format!("{}{link}", BodyParameters::NAMES[k % 10])
}

fn base<const P: usize>(base: &BaseParameters<P>, truth: &[f64; P]) -> Value {
    let values = base.values(truth);
    let named = |(k, value): (&usize, &f64)| json!({ "name": name::<P>(*k), "value": value });
    json!({
        "parameters": P,
        "rank": base.rank(),
        "tolerance": RANK_TOLERANCE,
        "gap": base.gap(),
        "base": base.independent().iter().zip(&values).map(named).collect::<Vec<_>>(),
    })
}

fn errors(Errors { greatest, root_mean_square }: Errors) -> Value {
    json!({ "max": greatest, "rms": root_mean_square })
}

/// At the beginning and at the end \[m\].
fn ends(run: &Run, duration: f64, window: f64) -> Value {
    json!({ "start": errors(run.errors(0.0, window)), "end": errors(run.errors(duration - window, duration)) })
}

fn lyapunov(check: &LyapunovCheck) -> Value {
    json!({
        "never_increases": check.holds(),
        "start": check.first,
        "end": check.last,
        "greatest_rise": check.greatest_rise,
        "greatest_imbalance": check.greatest_imbalance,
        "looks": check.looks,
    })
}

fn learnt(name: &str, [truth, initial, estimate]: [f64; 3]) -> Value {
    json!({ "name": name, "true": truth, "initial": initial, "estimated": estimate })
}

fn compared<const P: usize>(of: &arm::Comparison<P>) -> Value {
    let estimate: &[f64] = &of.adaptive.end().seen.estimate;
    let estimate: [f64; P] = std::array::from_fn(|k| estimate[k]);
    let [truth, first, last] = [&of.truth, &of.initial, &estimate].map(|numbers| of.told.values(numbers));
    let row = |k: usize| learnt(&name::<P>(of.told.independent()[k]), [truth[k], first[k], last[k]]);
    let error = |run: &Run| ends(run, of.duration, of.window);
    json!({
        "duration": of.duration,
        "window": of.window,
        "flange_error": {
            "computed_torque_wrong": error(&of.wrong),
            "computed_torque_right": error(&of.right),
            "adaptive": error(&of.adaptive),
        },
        "torque_ratio_max": torque_ratio(&of.adaptive),
        "lyapunov": lyapunov(&of.adaptive.check),
        "told": { "rank": of.told.rank(), "gap": of.told.gap() },
        "base_parameters": (0..of.told.rank()).map(row).collect::<Vec<_>>(),
    })
}

fn flown(study: &quadrotor::Study, of: &quadrotor::Comparison) -> Value {
    let estimate = &of.adaptive.run.end().seen.estimate;
    let row = |k: usize| learnt(VEHICLE[k], [study.truth[k], study.initial[k], estimate[k]]);
    let of_flight = |flight: &Flight| {
        json!({
            "error": ends(&flight.run, of.duration, of.window),
            "touchdown_time": flight.touchdown.map(|[time, _]| time),
            "touchdown_velocity": flight.touchdown.map(|[_, speed]| speed),
            "thrust_max": flight.run.greatest_force(0),
            "rotors_limited": flight.limited,
        })
    };
    json!({
        "duration": of.duration,
        "window": of.window,
        "backstepping_wrong": of_flight(&of.wrong),
        "backstepping_right": of_flight(&of.right),
        "adaptive": of_flight(&of.adaptive),
        "lyapunov": lyapunov(&of.adaptive.run.check),
        "told": { "rank": of.told.0, "gap": of.told.1 },
        "parameters": (0..4).map(row).collect::<Vec<_>>(),
    })
}

pub(crate) fn text(arm: &arm::Study, quadrotor: &quadrotor::Study) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write(&mut text, arm, quadrotor);
    text
}

fn write(text: &mut String, arm: &arm::Study, quadrotor: &quadrotor::Study) -> std::fmt::Result {
    let [taken, left] = arm.base.gap();
    writeln!(
        text,
        "of the arm's 60 numbers {} combinations count; the last column taken has {taken:.1e} of its length left, the next \
         {left:.1e}",
        arm.base.rank()
    )?;
    for of in &arm.payload {
        writeln!(text, "\narm with {PAYLOAD_MASS} kg, {}, {} s:", of.motion, of.duration)?;
        arm_errors(text, of)?;
        parameters(text, &of.truth, &of.initial, &of.adaptive.end().seen.estimate, &|k| name::<10>(k))?;
    }
    let of = &arm.links;
    writeln!(text, "\narm of which no link is known, {}, {} s:", of.motion, of.duration)?;
    arm_errors(text, of)?;
    let last: [f64; 60] = std::array::from_fn(|k| of.adaptive.end().seen.estimate[k]);
    let [truth, first, last] = [&of.truth, &of.initial, &last].map(|numbers| of.told.values(numbers));
    let rank = of.told.rank();
    parameters(text, &truth[..rank], &first[..rank], &last[..rank], &|k| name::<60>(of.told.independent()[k]))?;
    for of in &quadrotor.flights {
        writeln!(text, "\nquadrotor, {}, {:.2} s:", of.reference, of.duration)?;
        for (name, flight) in
            [("backstepping, wrong", &of.wrong), ("backstepping, right", &of.right), ("adaptive", &of.adaptive)]
        {
            error_line(text, name, &flight.run, of.duration, of.window)?;
            if let Some([time, speed]) = flight.touchdown {
                writeln!(text, "    on the deck at {time:.3} s with {speed:.3} m/s")?;
            }
        }
        check_line(text, &of.adaptive.run.check)?;
        let last = &of.adaptive.run.end().seen.estimate;
        parameters(text, &quadrotor.truth, &quadrotor.initial, last, &|k| VEHICLE[k].to_string())?;
    }
    Ok(())
}

fn arm_errors<const P: usize>(text: &mut String, of: &arm::Comparison<P>) -> std::fmt::Result {
    for (name, run) in
        [("computed torque, wrong", &of.wrong), ("computed torque, right", &of.right), ("adaptive", &of.adaptive)]
    {
        error_line(text, name, run, of.duration, of.window)?;
    }
    writeln!(text, "  drives give up to {:.0} % of their torques", 100.0 * torque_ratio(&of.adaptive))?;
    check_line(text, &of.adaptive.check)?;
    writeln!(text, "  the motion tells {} of {P} numbers", of.told.rank())
}

fn error_line(text: &mut String, name: &str, run: &Run, duration: f64, window: f64) -> std::fmt::Result {
    let (start, end) = (run.errors(0.0, window), run.errors(duration - window, duration));
    let [a, b, c, d] = [start.greatest, start.root_mean_square, end.greatest, end.root_mean_square].map(|e| 1e3 * e);
    writeln!(
        text,
        "  {name:<22} first {window} s: up to {a:>9.3} mm, rms {b:>9.3}; last {window} s: {c:>9.3} mm, rms {d:>9.3}"
    )
}

fn check_line(text: &mut String, check: &LyapunovCheck) -> std::fmt::Result {
    let verdict = if check.holds() { "never grows" } else { "grows" };
    writeln!(
        text,
        "  V {verdict}: from {:.4} to {:.4} J, rises {:.1e} J, off its balance {:.1e} J",
        check.first, check.last, check.greatest_rise, check.greatest_imbalance
    )
}

fn parameters(
    text: &mut String,
    truth: &[f64],
    first: &[f64],
    last: &[f64],
    name: &dyn Fn(usize) -> String,
) -> std::fmt::Result {
    writeln!(text, "  {:<8} {:>12} {:>12} {:>12}", "", "true", "at first", "learnt")?;
    for k in 0..truth.len() {
        writeln!(text, "  {:<8} {:>12.4} {:>12.4} {:>12.4}", name(k), truth[k], first[k], last[k])?;
    }
    Ok(())
}
