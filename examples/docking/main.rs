//! How does a vehicle get to a station and dock, and what does it cost?
//!
//! From a circle 80 km below the station and 18° behind: phasing, homing, closing, glide slope, docking. Burns are
//! planned by the equations of Clohessy and Wiltshire, and flown in the nonlinear motion by thrusters with errors of 1
//! % and 0.5°, the same ones in every run. Look at the position at the port: it is what corrections leave of those
//! errors; perfect thrusters leave nanometres, which is what the linear equations neglect over the last metres. The
//! last lines fly the same with a station that attracts.
//!
//! `--axis v-bar` approaches from behind, `--axis r-bar` from below. `--out DIR` writes figures as SVG and PNG, and the
//! way and the burns as CSV.

mod figures;
mod flight;

use mbs_examples::{Failure, arguments::Arguments, assumed, output};
use mbs_examples::{print, println};
use mbs_orbit::mission::coast::Attraction;
use mbs_orbit::mission::phasing::Method;
use mbs_orbit::mission::{Axis, Mission, Phase, Report, STATION_ATTRACTION};
use serde_json::{Value, json};

use flight::{Flight, Thrusters};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// The side of the station from which it is approached.
    #[arg(long, value_enum, default_value_t = Side::VBar)]
    axis: Side,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Side {
    VBar,
    RBar,
}

/// What the mission rests on.
const ASSUMED: [&str; 3] = ["orbit.altitude", "orbit.station_mass", "docking."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let axis = match arguments.options.axis {
        Side::VBar => Axis::VBar,
        Side::RBar => Axis::RBar,
    };
    let mission = Mission::to_the_station(axis);
    let massive = Mission { attraction: Attraction { station: STATION_ATTRACTION, ..mission.attraction }, ..mission };
    let flown = Flight::of(&mission, Thrusters::WithErrors)?;
    let perfect = Flight::of(&mission, Thrusters::Perfect)?;
    let attracted = Flight::of(&massive, Thrusters::Perfect)?;
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
        figures::write(folder, &flown)?;
        figures::write_tables(folder, &flown)?;
    }
    if arguments.json {
        let mut all = results(&flown.report);
        all["axis"] = json!(axis_name(axis));
        all["phasing"] = phasing(&flown.report);
        all["phases"] =
            Phase::ALL.into_iter().map(|phase| (phase.name().to_string(), of_phase(&flown, phase))).collect();
        all["perfect_thrusters"] = results(&perfect.report);
        all["station_mass"] = results(&attracted.report);
        println!("{}", assumed::with(all, &ASSUMED));
    } else {
        print!("{}{}", summary(&flown, &perfect, &attracted), assumed::text(&ASSUMED));
    }
    Ok(())
}

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

fn phasing(report: &Report) -> Value {
    let plan = &report.plan;
    json!({
        "method": method_name(report),
        "wait": plan.wait,
        "duration": plan.duration,
        "delta_v": plan.delta_v,
        "miss": plan.miss,
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

fn summary(flown: &Flight, perfect: &Flight, attracted: &Flight) -> String {
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
