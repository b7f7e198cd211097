//! The joint angles as a RAPID module: joint targets, one a second, and the moves between them.
//!
//! The robot's own second angle is that of Denavit and Hartenberg plus 90°. That all senses are the same was not
//! verified against a drawing.

use std::fmt::Write;

use mbs_arm::Arm;
use mbs_examples::Failure;

use mbs_examples::arm_trajectory::cases::{self, Case, DURATION};

/// Seconds between targets.
const STEP: usize = 1;

/// The module for the default method, the quartic.
pub(crate) fn module(arm: &Arm, case: &Case) -> Result<String, Failure> {
    let motion = &*case.runs[0].motion;
    let count = DURATION as usize / STEP;
    let mut text = format!("MODULE Case{}\n", case.number);
    writeln!(
        text,
        "  ! IRB 7600-500/2.55, Table 2 of the thesis, case {}: one quartic per joint, {DURATION} s.",
        case.number
    )?;
    writeln!(
        text,
        "  ! Angles are the robot's own, in degrees; the second is that of Denavit and Hartenberg plus 90."
    )?;
    for warning in warnings(arm, case)? {
        writeln!(text, "  ! OUT OF RANGE: {warning}")?;
    }
    for k in 0..=count {
        let q = own_angles(&motion.at((k * STEP) as f64)?.q).map(|angle| format!("{angle:.6}")).join(",");
        writeln!(text, "  CONST jointtarget j{k:02}:=[[{q}],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];")?;
    }
    writeln!(text, "\n  PROC main()\n    MoveAbsJ j00,v100,fine,tool0;")?;
    for k in 1..=count {
        let zone = if k == count { "fine" } else { "z10" };
        writeln!(text, "    MoveAbsJ j{k:02},v100\\T:={STEP},{zone},tool0;")?;
    }
    text += "  ENDPROC\nENDMODULE\n";
    Ok(text)
}

/// Degrees, as the robot's controller has them.
pub(crate) fn own_angles(q: &[f64; 6]) -> [f64; 6] {
    let mut angles = q.map(f64::to_degrees);
    angles[1] += 90.0;
    angles
}

/// Which axes leave their ranges, and when.
pub(crate) fn warnings(arm: &Arm, case: &Case) -> Result<Vec<String>, Failure> {
    let (lower, upper) = (own_angles(&arm.limits.lower), own_angles(&arm.limits.upper));
    let motion = &*case.runs[0].motion;
    let mut warnings = Vec::new();
    for joint in 0..6 {
        for [from, to] in cases::out_of_range(arm, motion, joint)? {
            let [first, last] = [from, to].map(|t| motion.at(t).map(|state| own_angles(&state.q)[joint]));
            warnings.push(format!(
                "axis {} goes from {:.1} to {:.1} deg from {from:.2} to {to:.2} s, its range is {:.0} to {:.0} deg",
                joint + 1,
                first?,
                last?,
                lower[joint],
                upper[joint]
            ));
        }
    }
    Ok(warnings)
}
