//! What does it take to put a peg into a hole that is not quite where the robot believes it to be?
//!
//! A SCARA takes a peg from a feeder, carries it over and presses it into a chamfered hole that is to the side by up to
//! a millimetre and leans. It does so in three ways: position control with a rigid wrist; impedance control, the arm
//! soft to the sides; position control with a remote-centre compliance, a wrist whose springs meet at the tip of the
//! peg. Look at the greatest force, at the depth, and at why it ends: a peg may jam or wedge between two contacts, and
//! the arm stops at a force that would break something.
//!
//! An arm whose axes are all upright can give way to the side, but not lean: what the hole leans, only a wrist can.
//!
//! `--out DIR` writes figures (SVG and PNG) and curves (CSV).

mod cases;
mod cycle;
mod figures;
mod summary;

use mbs_examples::{Failure, arguments::Arguments};

/// What forces and times rest on.
const ASSUMED: [&str; 2] = ["gravity", "assembly."];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let runs = cases::all()?;
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &runs)?;
    }
    arguments.answer(summary::to_json(&runs), &summary::text(&runs), &ASSUMED);
    Ok(())
}
