//! What a mission came to, as JSON and as text.

use mbs_orbit::mission::phasing::Method;
use mbs_orbit::mission::{Axis, Phase, Report};
use serde_json::{Value, json};

use crate::flight::Flight;

fn axis_name(axis: Axis) -> &'static str {
    match axis {
        Axis::VBar => "v-bar",
        Axis::RBar => "r-bar",
    }
}

fn method_name(report: &Report) -> &'static str {
    match report.plan.method {
        Method::TwoImpulse => "half an ellipse",
        Method::Lambert => "Lambert's arc",
    }
}

fn results(report: &Report) -> Value {
    json!({
        "total_delta_v": report.total_delta_v(),
        "port_position_error": report.port_position_error(),
        "port_velocity": report.port_velocity(),
        "duration": report.duration(),
        "keep_out_violations": report.keep_out_violations,
        "corridor_violations": report.corridor_violations,
        "contact_position": report.contact.position,
        "contact_velocity": report.contact.velocity,
        "station_below_surface": report.warnings.station_below_surface,
        "vehicle_below_surface": report.warnings.vehicle_below_surface,
    })
}

fn of_phase(flight: &Flight, phase: Phase) -> Value {
    let report = &flight.report.phases[phase as usize];
    json!({
        "delta_v": report.delta_v,
        "burns": report.burns,
        "duration": report.duration,
        "end_position": report.end.position,
        "end_velocity": report.end.velocity,
        "drift_clearance": report.drift_clearance,
    })
}

/// As flown, then by perfect thrusters, then with a station that attracts.
pub(crate) fn to_json([flown, perfect, attracted]: [&Flight; 3]) -> Value {
    let (mut all, plan) = (results(&flown.report), &flown.report.plan);
    all["axis"] = json!(axis_name(flown.mission.axis));
    all["phasing"] = json!({
        "method": method_name(&flown.report),
        "wait": plan.wait,
        "duration": plan.duration,
        "delta_v": plan.delta_v,
        "miss": plan.miss,
    });
    all["phases"] = Phase::ALL.into_iter().map(|phase| (phase.name().to_string(), of_phase(flown, phase))).collect();
    all["perfect_thrusters"] = results(&perfect.report);
    all["station_mass"] = results(&attracted.report);
    all
}

pub(crate) fn text([flown, perfect, attracted]: [&Flight; 3]) -> String {
    let report = &flown.report;
    let mut text = format!(
        "station on a circle 400 km above the Earth; start 80 km lower, 18° behind, 0.01° out of plane; keep-out sphere of {:.0} m\n\
         approach along the {}; phasing by {} after a wait of {:.0} s; places and speeds in the station's axes, before the burn that ends a phase\n\n",
        flown.mission.keep_out,
        axis_name(flown.mission.axis),
        method_name(report),
        report.plan.wait
    );
    text += "phase       burns      Δv [m/s]   time [s]   ends at x, y, z [m]                     clearance without more burns\n";
    for phase in Phase::ALL {
        let part = &report.phases[phase as usize];
        let [x, y, z] = part.end.position;
        let clearance = part.drift_clearance.map_or(String::new(), |clearance| format!("{clearance:.0} m"));
        text += &format!(
            "{:<10} {:>6} {:>13.4} {:>10.1}   {x:>10.3} {y:>12.3} {z:>10.3}      {clearance}\n",
            phase.name(),
            part.burns,
            part.delta_v,
            part.duration
        );
    }
    text += "\nthrusters              Δv [m/s]   time [s]   beside the port [m]   speed [m/s]   in the sphere, out of the corridor   out of the corridor\n";
    for (name, flight) in [("errors 1 %, 0.5°", flown), ("perfect", perfect), ("perfect, station 420 t", attracted)] {
        let report = &flight.report;
        text += &format!(
            "{name:<22} {:>8.4} {:>10.1} {:>21.3e} {:>13.5} {:>35} {:>21}\n",
            report.total_delta_v(),
            report.duration(),
            report.port_position_error(),
            report.port_velocity(),
            report.keep_out_violations,
            report.corridor_violations
        );
    }
    for (who, altitude) in
        [("station", report.warnings.station_below_surface), ("vehicle", report.warnings.vehicle_below_surface)]
    {
        if let Some(altitude) = altitude {
            text += &format!("warning: the orbit of the {who} goes {:.0} m below the surface\n", -altitude);
        }
    }
    text
}
