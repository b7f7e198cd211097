//! Figures 7.3 and 7.4, by the code of `relative_motion`.

#[path = "../relative_motion/cases.rs"]
#[allow(dead_code, reason = "relative_motion has more stations than the thesis")]
mod cases;
#[path = "../relative_motion/figures.rs"]
#[allow(dead_code, reason = "relative_motion also draws other stations, and writes files")]
mod figures;
#[path = "../relative_motion/flight.rs"]
#[allow(dead_code, reason = "relative_motion also compares with other ways to the same motions")]
mod flight;

use mbs_chart::Figure;
use mbs_examples::Failure;

/// Both.
pub(crate) fn about_a_station() -> Result<Vec<Figure>, Failure> {
    let flights: Vec<_> = cases::circular()?.into_iter().map(flight::Flight::of).collect::<Result<_, _>>()?;
    Ok(figures::drawn(&flights).into_iter().map(|(_, figure)| figure).collect())
}
