//! The motion as CSV: `t,<coordinates>,<coordinates>_dot,energy`, then multipliers and residuals of constraints.

use std::fmt::Write;

use super::motion::Motion;

/// One line a row; every number with as many digits as it takes to read the same number.
pub(crate) fn csv(motion: &Motion) -> String {
    let velocities = motion.coordinates.iter().map(|name| format!("{name}_dot"));
    let header: Vec<String> = ["t".to_string()]
        .into_iter()
        .chain(motion.coordinates.iter().cloned())
        .chain(velocities)
        .chain(["energy".to_string()])
        .chain(motion.constraints.iter().map(|row| format!("lambda_{row}")))
        .chain(motion.constraints.iter().map(|row| format!("residual_{row}")))
        .collect();
    let mut text = header.join(",") + "\n";
    for row in &motion.rows {
        // `{:?}` is the shortest text that reads as the same number. Writing to a string does not fail.
        let _ = write!(text, "{:?}", row.t);
        for number in row.q.iter().chain(&row.qd).chain(&[row.kinetic + row.potential]).chain(&row.constraints) {
            let _ = write!(text, ",{number:?}");
        }
        text.push('\n');
    }
    text
}
