//! How does a platform at sea move, what can its thrusters do about that, and does a quadrotor land on it?
//!
//! A small moored semi-submersible heaves, rolls, pitches and yaws in a JONSWAP sea with short crests and in gusts: two
//! hundred seconds to forget the start, then half an hour, with and without a linear quadratic regulator of six
//! thrusters. Look at heave: the sea is far stronger than the thrusters, which can damp and no more; and at roll and
//! yaw, where the platform swings slowly and damping tells. The quadrotor of chapter 5 then lands on the deck as it was
//! computed to move, beginning at every third minute.
//!
//! `--height`, `--period` and `--wind` make another weather, `--seed` another sea of the same kind. `--out DIR` writes
//! the spectrum, the response to regular waves and the motion as SVG and PNG, and the motion as CSV.

mod figures;
mod run;
mod summary;

use mbs_examples::{Failure, arguments::Arguments, assumed};

use run::{Study, Weather};

/// What everything here rests on, beside what every landing does.
const ASSUMED: [&str; 2] = ["gravity", "marine."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::<Weather>::with_options(include_str!("main.rs"));
    let study = Study::of(&arguments.options)?;
    let told = if arguments.options.is_assumed() { "" } else { "marine.weather" };
    let keys = |keys: &[&str]| assumed::without(keys, told);
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &study, &keys(&ASSUMED))?;
        figures::write_tables(folder, &study)?;
    }
    let keys = keys(&[&ASSUMED, assumed::LANDING].concat());
    arguments.answer(summary::to_json(&study)?, &summary::text(&study)?, &keys);
    Ok(())
}
