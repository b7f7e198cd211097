//! How does a quadrotor come down on a platform that heaves under it?
//!
//! Cases I and II of the thesis, each by the exact equations and by those for small angles, under backstepping control in
//! continuous time; for comparison by a linear quadratic regulator. In case II the platform falls faster than a quadrotor can follow: look at the thrust, which is at its limits
//! for a part of the time, and at the attitude, which takes longer to settle.
//!
//! `--out DIR` writes figures 5.2 to 5.9 as SVG and PNG, and every curve as CSV.

#[path = "quadrotor_landing/figures.rs"]
mod figures;
#[path = "quadrotor_landing/flight.rs"]
mod flight;

use mbs_examples::{Failure, arguments::Arguments};
use mbs_models::quadrotor::landing::Plant;
use serde_json::{Value, json};

use flight::{CASES, Flight, Pilot};

/// What is flown in each case.
const FLIGHTS: [(Plant, Pilot); 3] =
    [(Plant::Exact, Pilot::Backstepping), (Plant::SmallAngle, Pilot::Backstepping), (Plant::Exact, Pilot::Lqr)];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::from_process();
    let mut flights = Vec::new();
    for case in CASES {
        for (plant, pilot) in FLIGHTS {
            flights.push(Flight::of(case, plant, pilot)?);
        }
    }
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder)?;
        for flight in &flights {
            figures::write_table(folder, flight)?;
            if flight.name() == "exact" {
                figures::write(folder, flight)?;
            }
        }
    }
    if arguments.json {
        println!("{}", to_json(&flights));
    } else {
        print!("{}", summary(&flights));
    }
    Ok(())
}

fn to_json(flights: &[Flight]) -> Value {
    let of_case = |case: flight::Case| -> Value {
        let flights = flights.iter().filter(|flight| flight.case.name == case.name);
        flights.map(|flight| (flight.name().to_string(), results(flight))).collect()
    };
    CASES.iter().map(|&case| (case.name.to_string(), of_case(case))).collect()
}

fn results(flight: &Flight) -> Value {
    let end = &flight.touchdown;
    json!({
        "touchdown_time": end.time,
        "relative_velocity": end.relative_velocity,
        "max_phi_deg": end.greatest_tilt[0].to_degrees(),
        "max_theta_deg": end.greatest_tilt[1].to_degrees(),
        "settling_time": end.settling_time,
        "thrust_min": end.thrust_range[0],
        "thrust_max": end.thrust_range[1],
        "horizontal_offset": end.horizontal_offset,
        "rotor_work": end.rotor_work,
    })
}

fn summary(flights: &[Flight]) -> String {
    let mut text = String::from(
        "case flight       touchdown    rel. velocity  offset     max φ   max θ   settled  thrust               at a limit  rotor work\n",
    );
    for flight in flights {
        let end = &flight.touchdown;
        text += &format!(
            "{:<4} {:<12} {:>9.5} s {:>10.5} m/s {:>9.2e} m {:>5.2}° {:>6.2}° {:>6.2} s {:>6.1} to {:>6.1} N {:>8.1} % {:>9.0} J\n",
            flight.case.name,
            flight.name(),
            end.time,
            end.relative_velocity,
            end.horizontal_offset,
            end.greatest_tilt[0].to_degrees(),
            end.greatest_tilt[1].to_degrees(),
            end.settling_time,
            end.thrust_range[0],
            end.thrust_range[1],
            100.0 * end.limited,
            end.rotor_work,
        );
    }
    for case in CASES {
        let bound = case.heave.acceleration_bound();
        if bound > 9.80665 {
            text += &format!(
                "case {}: the platform may fall with {bound:.2} m/s², faster than freely; nothing that only pushes upwards follows\n",
                case.name
            );
        }
    }
    text
}
