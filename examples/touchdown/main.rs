//! What becomes of the vehicle once its feet touch, and what does the platform feel of it?
//!
//! Four compliant legs with friction stand on the deck, the rotors run down from the first touch on. First by hand: a
//! vehicle that comes to rest, rebounds, slides and tips over. Then landings on the decks of cases I and II and at sea,
//! under guidance: in case II the deck falls faster than freely, look at the rebounds. Then on the Stewart platform
//! under its own control, which does not know of the vehicle: look at the forces of its legs at the impact, and at how
//! far it gives way under the weight.
//!
//! `--out DIR` writes figures as SVG and PNG, and the forces as CSV.

mod figures;
mod run;
mod summary;

use mbs_examples::{Failure, arguments::Arguments, assumed};
use run::{OnDeck, OnPlatform};

/// All that come down.
struct Touchdowns {
    by_hand: Vec<OnDeck>,
    planned: Vec<OnDeck>,
    carried: Vec<OnPlatform>,
}

/// What they rest on, beside what every landing and every leg does.
const ASSUMED: [&str; 10] = [
    "platform.attitude",
    "platform.limits",
    "quadrotor.field",
    "landing.platform_control",
    "landing.marine",
    "landing.gear",
    "landing.run_down",
    "landing.still",
    "landing.tipped",
    "landing.marine_frequencies",
];

/// What every touchdown rests on.
fn assumed_keys() -> Vec<&'static str> {
    [assumed::LANDING, &assumed::PLATFORM.concat(), &ASSUMED].concat()
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let touchdowns =
        Touchdowns { by_hand: run::by_hand()?, planned: run::on_planned_decks()?, carried: run::on_the_platform()? };
    if let Some(folder) = arguments.folder()? {
        for on_deck in touchdowns.by_hand.iter().chain(&touchdowns.planned) {
            figures::write(folder, on_deck)?;
        }
        for on_platform in &touchdowns.carried {
            figures::write_platform(folder, on_platform)?;
        }
    }
    let keys = assumed_keys();
    arguments.answer(summary::to_json(&touchdowns), &summary::text(&touchdowns), &keys);
    Ok(())
}
