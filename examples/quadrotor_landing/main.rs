//! How does a quadrotor come down on a platform that moves under it?
//!
//! Cases I and II of the thesis, where the platform heaves, each by the exact equations and by those for small angles,
//! under backstepping control in continuous time; for comparison by a linear quadratic regulator, and with rotors that
//! push harder near the deck. In case II the platform falls faster than a quadrotor can follow: look at the thrust,
//! which is at its limits for a part of the time, and at the attitude, which takes longer to settle. Without guidance
//! the vehicle follows the elevation of the platform itself and is down in three seconds: look at its offset then.
//!
//! Then a deck at sea, which heaves, rolls, pitches and yaws: look at the offset and the attitude in the axes of the
//! deck.
//!
//! Then cases I and II in wind that grows with height and brings gusts, two hundred each: look at how far from the
//! middle they come down.
//!
//! Then the same decks on the Stewart platform of chapter 4 under its own control, with sampled controllers: look at
//! what that changes, and at how far beyond its limits the platform would have to go.
//!
//! `--out DIR` writes figures 5.2 to 5.9, the unguided descents beside the guided ones and those of the other decks as
//! SVG and PNG, and every curve as CSV.

mod figures;
mod landings;
mod summary;

use mbs_examples::quadrotor_landing::{flight::Kind, gusts};
use mbs_examples::{Failure, arguments::Arguments, assumed, output};

use landings::Landings;

/// What the landings rest on, beside what every leg and the wind does.
const ASSUMED: [&str; 9] = [
    "gravity",
    "platform.attitude",
    "platform.limits",
    "quadrotor.",
    "landing.sampling",
    "landing.tolerance",
    "landing.platform_control",
    "landing.marine",
    "landing.marine_frequencies",
];

/// What every number rests on.
fn assumed_keys() -> Vec<&'static str> {
    [&assumed::PLATFORM.concat()[..], &gusts::ASSUMED, &ASSUMED].concat()
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let landings = Landings::simulated()?;
    if let Some(folder) = arguments.folder()? {
        for flight in &landings.flights {
            figures::write_table(folder, flight)?;
            if flight.kind == Kind::Exact {
                let legs = landings.legs(flight.case, flight.touchdown.time)?;
                figures::write_legs(folder, flight.case, &legs)?;
                figures::write(folder, flight, &legs)?;
            }
        }
        let of_kind = |kind: Kind| landings.flights.iter().filter(move |flight| flight.kind == kind);
        for (guided, unguided) in of_kind(Kind::Exact).zip(of_kind(Kind::Unguided)) {
            figures::write_unguided(folder, guided, unguided)?;
        }
        for on_platform in &landings.heaving {
            figures::write_platform(folder, on_platform)?;
        }
        figures::write_platform(folder, &landings.marine)?;
        for in_gusts in &landings.gusts {
            let (name, figure) = in_gusts.drawn();
            output::write_figure(folder, &name, &figure, &assumed_keys())?;
        }
    }
    arguments.answer(summary::to_json(&landings)?, &summary::text(&landings)?, &assumed_keys());
    Ok(())
}
