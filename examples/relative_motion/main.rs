//! How does an astronaut drift about an orbital station, 1000 km and 3 m away from it?
//!
//! Released at rest relative to the station, or on the station's own orbit; a station on a circle or an ellipse, with
//! and without a mass of its own. Each motion is integrated in the station's axes by the generated equations, and found
//! again as the difference of two Kepler motions. Look at the last table: it says what becomes of a thousandth of a
//! millimetre, and with that whether the motion near the station is chaotic.
//!
//! `--out DIR` writes figures 7.3 and 7.4 and their like as SVG and PNG, and every motion as CSV.

mod sensitivity;
mod summary;

use mbs_examples::relative_motion::flight::Flight;
use mbs_examples::relative_motion::{cases, figures};
use mbs_examples::{Failure, arguments::Arguments};
use mbs_orbit::EARTH_RADIUS;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let flights: Vec<Flight> = cases::all()?.into_iter().map(Flight::of).collect::<Result<_, _>>()?;
    let growths = sensitivity::all()?;
    for flight in &flights {
        if let Some(warning) = flight.case.station.below(EARTH_RADIUS) {
            eprintln!("warning: {}: {warning}", flight.case.name);
        }
    }
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &flights)?;
    }
    arguments.answer(summary::to_json(&flights, &growths), &summary::text(&flights, &growths), &figures::ASSUMED);
    Ok(())
}
