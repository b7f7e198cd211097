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
mod summary;

use mbs_examples::quadrotor_landing::flight::{self, CASES, Flight, Kind, MARINE};
use mbs_examples::quadrotor_landing::gusts::{self, InGusts};
use mbs_examples::quadrotor_landing::platform::{self, OnPlatform};
use mbs_examples::{Failure, arguments::Arguments, output};
use mbs_platform::limits::LegState;
use mbs_platform::{HOME, Superposition};

/// All landings.
struct Landings {
    flights: Vec<Flight>,
    /// The cases of the thesis on the Stewart platform.
    heaving: Vec<OnPlatform<4>>,
    marine: OnPlatform<2>,
    /// The cases of the thesis in gusts.
    gusts: Vec<InGusts>,
}

impl Landings {
    fn simulated() -> Result<Self, Failure> {
        let (mut flights, mut heaving) = (Vec::new(), Vec::new());
        for (case, heave) in CASES {
            for kind in Kind::ALL.into_iter().chain([Kind::Unguided]) {
                flights.push(Flight::of(case, kind, flight::heaving(heave))?);
            }
            heaving.push(OnPlatform::of(case, &heave.about(HOME[2]), [0.0; 3])?);
        }
        for kind in Kind::ALL {
            flights.push(Flight::of(MARINE, kind, flight::marine(Superposition::MARINE))?);
        }
        let marine = OnPlatform::of(MARINE, &Superposition::MARINE, flight::FIELD)?;
        let gusts = CASES.map(|(case, heave)| InGusts::of(case, heave)).into_iter().collect::<Result<_, _>>()?;
        Ok(Landings { flights, heaving, marine, gusts })
    }

    /// Of a case of the thesis.
    fn on_platform(&self, case: &str) -> Option<&OnPlatform<4>> {
        self.heaving.iter().find(|on_platform| on_platform.case == case)
    }

    /// What the legs do along the motion of a case in full, exactly as it is to be, up to a time \[s\].
    fn legs(&self, case: &str, end: f64) -> Result<Vec<(f64, LegState)>, Failure> {
        match self.on_platform(case) {
            Some(on_platform) => platform::legs(&on_platform.full.motion, end),
            None => platform::legs(&self.marine.full.motion, end),
        }
    }
}

/// What the landings rest on.
const ASSUMED: [&str; 17] = [
    "gravity",
    "platform.radii",
    "platform.half_angles",
    "platform.home",
    "platform.attitude",
    "platform.plate",
    "platform.cylinders",
    "platform.pistons",
    "platform.limits",
    "quadrotor.",
    "landing.sampling",
    "landing.tolerance",
    "landing.platform_control",
    "landing.marine",
    "landing.marine_frequencies",
    gusts::ASSUMED[0],
    gusts::ASSUMED[1],
];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let landings = Landings::simulated()?;
    if let Some(folder) = &arguments.out {
        output::create_folder(folder)?;
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
            output::write_figure(folder, &name, &figure, &ASSUMED)?;
        }
    }
    arguments.answer(summary::to_json(&landings)?, &summary::text(&landings)?, &ASSUMED);
    Ok(())
}
