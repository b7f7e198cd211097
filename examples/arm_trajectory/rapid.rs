//! The joint angles as a RAPID module: joint targets, one a second, and the moves between them.
//!
//! The robot's own second angle is that of Denavit and Hartenberg plus 90°. That all senses are the same was not
//! verified against a drawing. Beside the printed motion, which leaves the ranges of axes 2 and 3, stands a variant
//! that keeps them.

use std::fmt::Write;

use mbs_arm::Arm;
use mbs_arm::trajectory::{Motion, quartic};
use mbs_examples::Failure;

use mbs_examples::arm_trajectory::cases::{self, Case, DURATION};

/// Seconds between targets.
const STEP: usize = 1;

/// Start and stop of the variant, the robot's own angles \[°\]: the numbers of Table 2 taken for these, axes 2 and 3
/// stopped 5° before the ends of their ranges.
const IN_RANGE: [[f64; 6]; 2] = [[20.0, 10.0, 10.0, 10.0, 20.0, 10.0], [50.0, 80.0, 55.0, 80.0, 60.0, 100.0]];

/// Both modules of a case, each with the name of its file: the motion as printed, and the variant within the ranges.
pub(crate) fn modules(arm: &Arm, case: &Case) -> Result<[(String, String); 2], Failure> {
    let number = case.number;
    let printed = &*case.runs[0].motion;
    let remarks = [
        format!("IRB 7600-500/2.55, Table 2 of the thesis, case {number}: one quartic per joint, {DURATION} s."),
        "Angles are the robot's own, in degrees; the second is that of Denavit and Hartenberg plus 90.".to_string(),
    ];
    let warnings = warnings(arm, printed)?.into_iter().map(|warning| format!("OUT OF RANGE: {warning}"));
    let text = module(&format!("Case{number}"), remarks.into_iter().chain(warnings), printed)?;
    let velocity = printed.at(0.0)?.qd;
    let [start, stop] = IN_RANGE.map(|angles| denavit_hartenberg(&angles));
    let variant = quartic(start, velocity, stop, DURATION)?;
    let remarks = [
        format!("IRB 7600-500/2.55, a variant of Table 2 of the thesis, case {number}: one quartic per joint."),
        "The numbers of Table 2 are taken for the robot's own angles; axes 2 and 3 stop at 80 and 55 deg.".to_string(),
    ];
    if let Some(warning) = self::warnings(arm, &variant)?.first() {
        return Err(Failure::new(format!("the variant of case {number} is out of range: {warning}")));
    }
    let within = module(&format!("Case{number}InRange"), remarks, &variant)?;
    Ok([(format!("{}.mod", case.name), text), (format!("{}_in_range.mod", case.name), within)])
}

fn module(name: &str, remarks: impl IntoIterator<Item = String>, motion: &dyn Motion<6>) -> Result<String, Failure> {
    let count = DURATION as usize / STEP;
    let mut text = format!("MODULE {name}\n");
    for remark in remarks {
        writeln!(text, "  ! {remark}")?;
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

/// Back from the robot's own angles \[°\] \[rad\].
fn denavit_hartenberg(angles: &[f64; 6]) -> [f64; 6] {
    let mut q = *angles;
    q[1] -= 90.0;
    q.map(f64::to_radians)
}

/// Which axes leave their ranges, and when.
pub(crate) fn warnings(arm: &Arm, motion: &dyn Motion<6>) -> Result<Vec<String>, Failure> {
    let (lower, upper) = (own_angles(&arm.limits.lower), own_angles(&arm.limits.upper));
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
