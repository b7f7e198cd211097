//! The motion as CSV: `t,<coordinates>,<coordinates>_dot,energy`, then multipliers and residuals of constraints, then
//! what was asked for besides.

use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};

use super::column::Column;
use super::motion::Motion;

/// One line a row; every number with as many digits as it takes to read the same number. With units the names of the
/// columns end in them. A last line, `# stopped: …`, where the motion did not come to its end.
pub(crate) fn csv(motion: &Motion, units: bool) -> String {
    let mut text = header(motion, units).join(",") + "\n";
    for row in &motion.rows {
        // `{:?}` is the shortest text that reads as the same number. Writing to a string does not fail.
        let _ = write!(text, "{:?}", row.t);
        for number in &row.values {
            let _ = write!(text, ",{number:?}");
        }
        text.push('\n');
    }
    if let Some(reason) = &motion.stopped {
        let _ = writeln!(text, "# stopped: {}", reason.replace('\n', " "));
    }
    text
}

/// `{"columns": ["t", …], "rows": [[0, …], …], "written": […]}`; infinity and NaN are `null`. With `"stopped": "…"`
/// where the motion did not come to its end.
pub(crate) fn object(motion: &Motion, units: bool, written: &[&Path]) -> Value {
    let rows = motion.rows.iter().map(|row| std::iter::once(row.t).chain(row.values.iter().copied()).collect());
    let rows: Vec<Vec<f64>> = rows.collect();
    let written: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    let mut object = json!({ "columns": header(motion, units), "rows": rows, "written": written });
    if let Some(reason) = &motion.stopped {
        object["stopped"] = reason.as_str().into();
    }
    object
}

fn header(motion: &Motion, units: bool) -> Vec<String> {
    let name = |column: &Column| if units { column.name_with_unit() } else { column.name.clone() };
    let time = Column::new("time", "t", "s");
    [&time].into_iter().chain(&motion.columns).map(name).collect()
}
