//! The motion as CSV: `t,<coordinates>,<coordinates>_dot,energy`, then multipliers and residuals of constraints, then
//! what was asked for besides.

use std::fmt::Write;

use super::column::Column;
use super::motion::Motion;

/// One line a row; every number with as many digits as it takes to read the same number. With units the names of the
/// columns end in them.
pub(crate) fn csv(motion: &Motion, units: bool) -> String {
    let name = |column: &Column| if units { column.name_with_unit() } else { column.name.clone() };
    let time = Column::new("time", "t", "s");
    let header: Vec<String> = [&time].into_iter().chain(&motion.columns).map(name).collect();
    let mut text = header.join(",") + "\n";
    for row in &motion.rows {
        // `{:?}` is the shortest text that reads as the same number. Writing to a string does not fail.
        let _ = write!(text, "{:?}", row.t);
        for number in &row.values {
            let _ = write!(text, ",{number:?}");
        }
        text.push('\n');
    }
    text
}
