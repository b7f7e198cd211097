//! Lines and comments that languages have in common.

use crate::variable::Variable;

use super::Side;

/// A branch by statements: how it begins, what ends each side, and how far to the right they stand.
pub(in crate::emit) fn if_else(
    mut lines: Vec<String>,
    names: &[String],
    sides: &[Side; 2],
    ends: [&str; 2],
    by: usize,
) -> Vec<String> {
    for (side, end) in sides.iter().zip(ends) {
        let results = names.iter().zip(&side.values).map(|(name, value)| format!("{name} = {value};"));
        let within: Vec<String> = side.lines.iter().cloned().chain(results).collect();
        lines.extend(indented(&within, by));
        lines.push(end.to_string());
    }
    lines
}

/// Farther to the right.
pub(in crate::emit) fn indented<'a>(
    lines: impl IntoIterator<Item = &'a String>,
    by: usize,
) -> impl Iterator<Item = String> {
    let indent = " ".repeat(by);
    let lines = lines.into_iter();
    let lines: Vec<String> =
        lines.map(|line| if line.is_empty() { String::new() } else { format!("{indent}{line}") }).collect();
    lines.into_iter()
}

/// A parameter's declared value, with these brackets around lists.
pub(in crate::emit) fn defaults(
    parameter: &Variable,
    constant: &dyn Fn(f64) -> String,
    list: &dyn Fn(&[String]) -> String,
) -> String {
    let values: Vec<String> = parameter.defaults.iter().map(|value| constant(value.to_f64())).collect();
    match (parameter.length, parameter.columns) {
        (None, _) => values[0].clone(),
        (Some(_), None) => list(&values),
        (Some(_), Some(columns)) => list(&values.chunks(columns).map(list).collect::<Vec<_>>()),
    }
}

/// A comment that documentation generators of C and JavaScript read.
pub(in crate::emit) fn block_comment(lines: &[String], by: usize) -> String {
    let indent = " ".repeat(by);
    let lines: Vec<String> = lines.iter().map(|line| line.replace("*/", "* /").replace("/*", "/ *")).collect();
    match lines.as_slice() {
        [line] => format!("{indent}/** {line} */\n"),
        lines => {
            let lines: String =
                lines.iter().map(|line| format!("{indent} * {line}").trim_end().to_string() + "\n").collect();
            format!("{indent}/**\n{lines}{indent} */\n")
        }
    }
}
