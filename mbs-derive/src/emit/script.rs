//! Languages that are not compiled, by the walk of `walk`.
//!
//! - `js`, `python`, `matlab`: the languages, each with what its files share beside it;
//! - `loops`: what loops over links need in them;
//! - `pieces`: of that the part that one file needs.

pub(super) mod js;
mod loops;
pub(super) mod matlab;
mod pieces;
pub(super) mod python;

use super::walk::indented;
pub(super) use pieces::pieces;

/// A longer list has an element a line.
const WIDEST: usize = 100;

/// On one line where that is short.
fn list(values: &[String], [open, close]: [&str; 2]) -> String {
    let short = format!("{open}{}{close}", values.join(", "));
    if values.is_empty() || (short.len() <= WIDEST && !short.contains('\n')) {
        return if values.is_empty() { short.replace(' ', "") } else { short };
    }
    let lines = values.iter().flat_map(|value| format!("{value},").lines().map(String::from).collect::<Vec<_>>());
    let lines: Vec<String> = lines.collect();
    let inside: String = indented(&lines, 2).map(|line| line + "\n").collect();
    format!("{}\n{inside}{}", open.trim(), close.trim())
}
