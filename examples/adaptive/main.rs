//! What does a controller do that does not know what it moves?
//!
//! The thesis' arm carries a payload that its controller has never heard of. Computed torque sags and lags by what the
//! payload weighs; Slotine's and Li's adaptive control learns mass, first moments and inertias on the way, and follows.
//! It is done once more with all six links unknown, and for the quadrotor, whose mass and inertias are unknown.
//! Look at the errors at the beginning and at the end, at the estimates beside the truth, and at V, which must never
//! grow: it is measured, with the work that damping has done.
//!
//! Regressors come from the generated equations, which are linear in these numbers. Which of the sixty an arm can tell
//! at all is found by factorizing many regressors on top of each other.
//!
//! `--out DIR` writes figures as SVG and PNG, and the curves as CSV.

mod arm;
mod figures;
mod motion;
mod quadrotor;
mod run;
mod summary;

use mbs_examples::{Failure, arguments::Arguments, assumed};

/// What the numbers rest on, beside what every landing does.
const ASSUMED: [&str; 5] = ["arm.masses", "arm.mass_centres", "arm.inertias", "arm.torques", "adaptive."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let (arm, quadrotor) = (arm::study()?, quadrotor::study()?);
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &arm, &quadrotor)?;
    }
    let keys = [assumed::LANDING, &ASSUMED].concat();
    arguments.answer(summary::to_json(&arm, &quadrotor), &summary::text(&arm, &quadrotor), &keys);
    Ok(())
}
