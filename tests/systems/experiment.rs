//! The experiment of chapter 6: the arm on its rail against Newton's laws and the arm alone, plans against reference
//! values and against geometry typed by hand, the simulated arm against what its mass error predicts, and bad input.

mod bad_input;
mod landed;
mod plans;
mod rail;
mod tracks;

use mbs_landing::experiment::Experiment;
use mbs_landing::experiment::collision::Shapes;
use mbs_landing::experiment::flight::Flight;
use mbs_landing::quadrotor::heave::Heave;
use mbs_landing::quadrotor::landing::{Landing, Plant};

/// The landing of a case as it is flown.
fn flown(heave: Heave<4>) -> Experiment {
    let landing = Landing::new(Plant::Exact, heave);
    Experiment::new(Flight::simulated(&landing, Landing::initial_state()).expect("a landing"))
}

/// Case I as its guidance asks for it.
fn guided() -> Experiment {
    Experiment::new(Flight::guided(&Landing::new(Plant::Exact, Heave::CASE_I)).expect("a landing"))
}

/// Case I as its guidance asks for it, where bodies may overlap: what is left are the limits of the drives.
fn limits_alone() -> Experiment {
    Experiment { shapes: Shapes::AXES, ..guided() }
}
