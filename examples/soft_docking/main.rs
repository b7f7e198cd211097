//! Do two bodies dock, not two points, and what do jets, plumes and the ring do to them?
//!
//! A chaser comes along the V-bar from 30 m, aside and turned by some degrees, by the frames of the ports: quaternion
//! feedback, 24 jets that fire pulses, their plumes on the station, which nobody controls, and a compliant ring with
//! latches. Look at the ports when they touch, at what the plumes have done to the station up to then, and at the
//! energy, which only falls. Then contacts that are not captured, and the far burns of `docking` flown by engines
//! that need their time: what they lack falls with the square of the duration.
//!
//! `--out DIR` writes figures as SVG and PNG, and the way and the burns as CSV.

mod cases;
mod figures;
mod summary;

use mbs_examples::{Failure, arguments::Arguments};

/// What all of it rests on.
const ASSUMED: [&str; 2] = ["orbit.altitude", "soft_docking."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let flights = cases::flights()?;
    let contacts = cases::contacts()?;
    let burns = cases::burns()?;
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &flights[0], &contacts, &burns)?;
    }
    let results = summary::to_json(&flights, &contacts, &burns);
    arguments.answer(results, &summary::text(&flights, &contacts, &burns), &ASSUMED);
    Ok(())
}
