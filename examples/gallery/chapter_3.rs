//! Figures 3.4 to 3.11, by the code of `arm_trajectory`.

#[path = "../arm_trajectory/cases.rs"]
#[allow(dead_code, reason = "arm_trajectory also looks at limits, and at the fastest motion")]
mod cases;
#[path = "../arm_trajectory/figures.rs"]
#[allow(dead_code, reason = "arm_trajectory also draws torques, and writes files")]
mod figures;

use mbs_arm::Arm;
use mbs_chart::Figure;
use mbs_examples::Failure;

/// Figures 3.4, 3.6, 3.8 and 3.10 of the first case, those between them of the second.
pub(crate) fn case(index: usize) -> Result<Vec<Figure>, Failure> {
    let arm = Arm::default();
    let drawn = figures::drawn(&arm, &cases::both(&arm)?[index])?;
    Ok(drawn.into_iter().map(|(_, figure)| figure).collect())
}
