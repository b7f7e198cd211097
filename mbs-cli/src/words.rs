//! Names and counts as messages write them.

/// At most eight names.
pub(crate) fn abridged(names: &[String]) -> String {
    match names {
        [head @ .., last] if names.len() > 8 => format!("{}, …, {last}", head[..6].join(", ")),
        _ => names.join(", "),
    }
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
