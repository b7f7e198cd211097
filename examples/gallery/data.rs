//! The figures with data, by the calculations and drawings of the programs of their chapters.

use mbs_arm::Arm;
use mbs_chart::Figure;
use mbs_examples::quadrotor_landing::flight::{CASES, Flight, Kind, heaving};
use mbs_examples::quadrotor_landing::platform::{OnPlatform, legs};
use mbs_examples::{Failure, arm_trajectory, platform_dynamics, quadrotor_landing, relative_motion};
use mbs_platform::{HOME, Platform};
use platform_dynamics::tables::Samples;

/// Figures 3.4, 3.6, 3.8 and 3.10 of the first case, those between them of the second.
pub(crate) fn arm(case: usize) -> Result<Vec<Figure>, Failure> {
    let arm = Arm::default();
    Ok(unnamed(arm_trajectory::figures::drawn(&arm, &arm_trajectory::cases::both(&arm)?[case])?))
}

/// Figures 4.5, 4.6, 4.8 and 4.7.
pub(crate) fn table_3() -> Result<Vec<Figure>, Failure> {
    let samples = Samples::fine();
    let drawings = platform_dynamics::figures::along_table_3(&Platform::default(), &samples)?;
    Ok(drawings.iter().map(|drawing| drawing.figure(&samples)).collect())
}

/// Figures 4.9 to 4.12.
pub(crate) fn table_4() -> Result<Vec<Figure>, Failure> {
    let samples = Samples::fine();
    let drawings = platform_dynamics::figures::along_table_4(&Platform::default(), &samples)?;
    Ok(drawings.iter().map(|drawing| drawing.figure(&samples)).collect())
}

/// Figures 5.2 to 5.5 of the first case, 5.6 to 5.9 of the second.
pub(crate) fn landing(case: usize) -> Result<Vec<Figure>, Failure> {
    let (case, heave) = CASES[case];
    let flight = Flight::of(case, Kind::Exact, heaving(heave))?;
    let on_platform = OnPlatform::of(case, &heave.about(HOME[2]), [0.0; 3])?;
    let legs = legs(&on_platform.full.motion, flight.touchdown.time)?;
    Ok(unnamed(quadrotor_landing::figures::drawn(&flight, &legs)))
}

/// Figures 7.3 and 7.4.
pub(crate) fn about_a_station() -> Result<Vec<Figure>, Failure> {
    use relative_motion::{cases, figures, flight::Flight};
    let flights: Vec<_> = cases::circular()?.into_iter().map(Flight::of).collect::<Result<_, _>>()?;
    Ok(unnamed(figures::drawn(&flights)))
}

fn unnamed(drawn: Vec<(String, Figure)>) -> Vec<Figure> {
    drawn.into_iter().map(|(_, figure)| figure).collect()
}
