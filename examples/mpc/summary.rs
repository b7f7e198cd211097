//! What is printed of the landings.

use mbs_landing::quadrotor::predictive::controller::Horizon;
use mbs_landing::quadrotor::predictive::sequential::Optimum;
use mbs_landing::quadrotor::predictive::step::{ROTORS, STATES};
use mbs_landing::quadrotor::touchdown::Touchdown;
use mbs_models::quadrotor_euler::Params;
use serde_json::{Value, json};

use crate::flights::{Case, Flown};

const AIR: [&str; 2] = ["calm", "windy"];

pub(crate) fn to_json(cases: &[Case], saved: &[(&str, f64)], horizon: &Horizon) -> Value {
    let of_case = |case: &Case| {
        let (shortest, seconds) = &case.shortest;
        let mut plan = of_plan(shortest);
        plan["computing_time"] = json!(seconds);
        let flights = |flown: &[Flown; 2]| -> Value {
            AIR.iter().zip(flown).map(|(air, flown)| ((*air).to_string(), of_flight(flown))).collect()
        };
        let results = json!({
            "deck_fall_bound": case.heave.acceleration_bound(),
            "shortest": plan,
            "with_reserve": of_plan(&case.first),
            "replanned": flights(&case.replanned),
            "predictive": flights(&case.predictive),
            "guided": of_touchdown(&case.guided.touchdown),
        });
        (case.name.to_string(), results)
    };
    json!({
        "horizon": { "duration": horizon.duration, "intervals": horizon.intervals, "period": horizon.period },
        "cases": cases.iter().map(of_case).collect::<Value>(),
        "looser": saved.iter().map(|(name, time)| ((*name).to_string(), json!(time))).collect::<Value>(),
    })
}

fn of_plan(found: &Optimum<STATES, ROTORS>) -> Value {
    json!({
        "touchdown_time": found.plan.duration,
        "stationarity": found.residual.stationarity,
        "continuity": found.residual.continuity,
        "complementarity": found.residual.complementarity,
        "programs": found.programs,
    })
}

fn of_touchdown(end: &Touchdown) -> Value {
    json!({
        "touchdown_time": end.time,
        "relative_velocity": end.relative_velocity,
        "offset": end.horizontal_offset,
        "horizontal_speed": end.horizontal_speed,
    })
}

fn of_flight(flown: &Flown) -> Value {
    let ([tilt, visibility, height, least, greatest], [median, worst]) = (flown.extremes(), flown.planning());
    let mut results = of_touchdown(&flown.touchdown);
    results["greatest_tilt_deg"] = json!(tilt.to_degrees());
    results["least_visibility"] = json!(visibility);
    results["least_height"] = json!(height);
    results["rotor_thrust"] = json!([least, greatest]);
    results["limits_broken"] = json!(flown.broken());
    results["plans"] = json!(flown.plans.len());
    results["computing_time"] = json!({ "first": flown.plans[0].1, "median": median, "worst": worst });
    results
}

pub(crate) fn text(cases: &[Case], saved: &[(&str, f64)], horizon: &Horizon) -> String {
    let mut text = String::from("shortest landings, planned:\n");
    for case in cases {
        let (found, seconds) = &case.shortest;
        text += &format!(
            "case {:<3} {:.4} s, with thrust left aside {:.4} s; {} quadratic programs, residual {:.1e}, found in {seconds:.1} s\n",
            case.name,
            found.plan.duration,
            case.first.plan.duration,
            found.programs,
            found.residual.greatest(),
        );
    }
    text += "\nshortest landing in case I where one limit is looser:\n";
    for (name, time) in saved {
        text += &format!("  {name:<28} {time:.4} s\n");
    }
    text += &format!(
        "\npredictive control looks {} s ahead in {} intervals, every {} ms; times of planning are those of one core of this machine\n\n\
         case  landing      air      touchdown  rel. velocity  offset    most tilt visible by  plans  median      worst       there is\n",
        horizon.duration,
        horizon.intervals,
        1e3 * horizon.period,
    );
    for case in cases {
        let kinds = [("shortest", &case.replanned, 0.05), ("predictive", &case.predictive, horizon.period)];
        for (kind, flights, there_is) in kinds {
            for (air, flown) in AIR.iter().zip(flights) {
                let (end, [median, worst]) = (&flown.touchdown, flown.planning());
                let [tilt, visibility, ..] = flown.extremes();
                text += &format!(
                    "{:<5} {kind:<12} {air:<8} {:>7.4} s {:>10.4} m/s {:>7.4} m {:>6.2}° {visibility:>10.3} m {:>6} {:>7.2} ms {:>8.2} ms {:>8.0} ms\n",
                    case.name,
                    end.time,
                    end.relative_velocity,
                    end.horizontal_offset,
                    tilt.to_degrees(),
                    flown.plans.len(),
                    1e3 * median,
                    1e3 * worst,
                    1e3 * there_is,
                );
                let broken = flown.broken();
                if !broken.is_empty() {
                    text += &format!("      its limits are not kept: {}\n", broken.join(", "));
                }
            }
        }
        let end = &case.guided.touchdown;
        text += &format!(
            "{:<5} {:<12} {:<8} {:>7.4} s {:>10.4} m/s {:>7.4} m\n",
            case.name, "guided", "calm", end.time, end.relative_velocity, end.horizontal_offset
        );
        let (fall, g) = (case.guided.touchdown.deck_fall, Params::<f64>::default().g);
        if fall > g {
            text += &format!(
                "      the platform falls with up to {fall:.3} m/s² on the way, faster than freely; for a moment a vehicle can be as fast\n"
            );
        }
    }
    text
}
