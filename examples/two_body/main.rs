//! Do two bodies that attract each other keep to Kepler's laws?
//!
//! The Earth and a Moon that starts slowly, both in inertial axes, by the generated equations; and an ellipse of
//! eccentricity 0.6 in units in which all is about one, by Kepler's equation and by DOP853. Look at the drift of what
//! is conserved: energy, angular momentum, Laplace's vector, and the barycentre, which does not move.
//!
//! `--out DIR` writes the paths as SVG and PNG, and as CSV.

mod earth_moon;
mod ellipse;
mod figures;
mod summary;

use mbs_examples::{Failure, arguments::Arguments};

/// What the motion of the Earth and the Moon rests on.
const ASSUMED: [&str; 1] = ["two_body.start"];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of(include_str!("main.rs"));
    let ellipse = ellipse::run()?;
    let earth_moon = earth_moon::run()?;
    if let Some(folder) = arguments.folder()? {
        figures::write(folder, &earth_moon)?;
    }
    arguments.answer(summary::to_json(&ellipse, &earth_moon), &summary::text(&ellipse, &earth_moon), &ASSUMED);
    Ok(())
}
