//! All landings: cases of the thesis and a deck at sea, on exact decks, on the Stewart platform and in gusts.

use mbs_examples::Failure;
use mbs_examples::quadrotor_landing::flight::{self, CASES, Flight, Kind, MARINE};
use mbs_examples::quadrotor_landing::gusts::InGusts;
use mbs_examples::quadrotor_landing::platform::{self, OnPlatform};
use mbs_platform::limits::LegState;
use mbs_platform::{HOME, Superposition};

/// All landings.
pub(crate) struct Landings {
    pub(crate) flights: Vec<Flight>,
    /// The cases of the thesis on the Stewart platform.
    pub(crate) heaving: Vec<OnPlatform<4>>,
    pub(crate) marine: OnPlatform<2>,
    /// The cases of the thesis in gusts.
    pub(crate) gusts: Vec<InGusts>,
}

impl Landings {
    pub(crate) fn simulated() -> Result<Self, Failure> {
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
    pub(crate) fn on_platform(&self, case: &str) -> Option<&OnPlatform<4>> {
        self.heaving.iter().find(|on_platform| on_platform.case == case)
    }

    /// What the legs do along the motion of a case in full, exactly as it is to be, up to a time \[s\].
    pub(crate) fn legs(&self, case: &str, end: f64) -> Result<Vec<(f64, LegState)>, Failure> {
        match self.on_platform(case) {
            Some(on_platform) => platform::legs(&on_platform.full.motion, end),
            None => platform::legs(&self.marine.full.motion, end),
        }
    }
}
