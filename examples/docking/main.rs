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
mod summary;

use mbs_examples::Failure;
use mbs_examples::arguments::{Arguments, one_of};
use mbs_orbit::mission::coast::Attraction;
use mbs_orbit::mission::{Axis, Mission, STATION_ATTRACTION};

use flight::{Flight, Thrusters};

#[derive(Clone, Debug, clap::Args)]
struct Options {
    /// The side of the station from which it is approached.
    #[arg(long, default_value = "v-bar", value_parser = one_of([("v-bar", Axis::VBar), ("r-bar", Axis::RBar)]))]
    axis: Axis,
}

/// What the mission rests on.
const ASSUMED: [&str; 3] = ["orbit.altitude", "orbit.station_mass", "docking."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Options>::with_options(include_str!("main.rs"));
    let mission = Mission::to_the_station(arguments.options.axis);
    let massive = Mission { attraction: Attraction { station: STATION_ATTRACTION, ..mission.attraction }, ..mission };
    let flown = Flight::of(&mission, Thrusters::WithErrors)?;
    let perfect = Flight::of(&mission, Thrusters::Perfect)?;
    let attracted = Flight::of(&massive, Thrusters::Perfect)?;
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &flown)?;
        figures::write_tables(folder, &flown)?;
    }
    let flights = [&flown, &perfect, &attracted];
    arguments.answer(summary::to_json(flights), &summary::text(flights), &ASSUMED);
    Ok(())
}
