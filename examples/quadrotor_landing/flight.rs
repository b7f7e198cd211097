//! One landing, with what is drawn of it.

use mbs_examples::Failure;
use mbs_models::quadrotor::heave::Heave;
use mbs_models::quadrotor::landing::{Controller, Landing, Plant, Touchdown};
use mbs_models::quadrotor::lqr::{Lqr, Weights};
use mbs_runtime::State;

/// A motion of the platform.
#[derive(Clone, Copy)]
pub(crate) struct Case {
    /// In the thesis.
    pub(crate) name: &'static str,
    /// The elevation of the platform.
    pub(crate) heave: Heave<4>,
}

/// Those of the thesis.
pub(crate) const CASES: [Case; 2] =
    [Case { name: "I", heave: Heave::CASE_I }, Case { name: "II", heave: Heave::CASE_II }];

/// What happens at one moment.
pub(crate) struct Moment {
    pub(crate) t: f64,
    pub(crate) state: State<[f64; 6]>,
    /// Elevation of the platform \[m\].
    pub(crate) platform: f64,
    /// The thrust that is asked for \[N\].
    pub(crate) thrust: f64,
    /// Of each rotor \[N\].
    pub(crate) rotor_thrust: [f64; 4],
}

/// Who flies.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pilot {
    Backstepping,
    Lqr,
}

pub(crate) struct Flight {
    pub(crate) case: Case,
    plant: Plant,
    pilot: Pilot,
    /// Every 10 ms.
    pub(crate) moments: Vec<Moment>,
    pub(crate) touchdown: Touchdown,
}

/// Every so many moments that the simulation shows are kept.
const KEPT: usize = 5;

impl Flight {
    pub(crate) fn of(case: Case, plant: Plant, pilot: Pilot) -> Result<Self, Failure> {
        let mut landing = Landing::new(plant, case.heave);
        if pilot == Pilot::Lqr {
            landing.controller = Controller::Lqr(Lqr::new(*landing.vehicle.params(), &Weights::default())?);
        }
        let (mut moments, mut seen) = (Vec::new(), 0);
        let touchdown = landing.simulate(Landing::initial_state(), |t, state, command| {
            if seen % KEPT == 0 {
                moments.push(Moment {
                    t,
                    state: *state,
                    platform: case.heave.at(t).value,
                    thrust: command.effort.thrust,
                    rotor_thrust: command.rotors.speed.map(|o| landing.vehicle.params().thrust_factor * o * o),
                });
            }
            seen += 1;
        })?;
        Ok(Flight { case, plant, pilot, moments, touchdown })
    }

    /// In the JSON.
    pub(crate) fn name(&self) -> &'static str {
        match (self.pilot, self.plant) {
            (Pilot::Backstepping, Plant::Exact) => "exact",
            (Pilot::Backstepping, Plant::SmallAngle) => "small_angle",
            (Pilot::Lqr, Plant::Exact) => "lqr",
            (Pilot::Lqr, Plant::SmallAngle) => "lqr_small_angle",
        }
    }
}
