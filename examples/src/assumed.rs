//! What results rest on where the thesis gives no number: the rows of `docs/thesis/assumed.md`, the one source of it.
//!
//! Keys are those of the page, or all that begin alike: `arm.` is every row of the arm.

use serde_json::{Map, Value, json};

const PAGE: &str = include_str!("../../docs/thesis/assumed.md");

/// What every guided landing rests on.
pub const LANDING: &[&str] = &[
    "gravity",
    "quadrotor.inertias",
    "quadrotor.rotors",
    "quadrotor.drag",
    "quadrotor.gains",
    "quadrotor.limits",
    "quadrotor.least_lift",
    "quadrotor.guidance",
    "quadrotor.start",
];

/// Where the joints of the platform's legs are.
pub const JOINTS: &[&str] = &["platform.radii", "platform.half_angles"];
/// How high the platform stands at home.
pub const HOME: &[&str] = &["platform.home"];
/// What the platform's legs weigh.
pub const LEGS: &[&str] = &["platform.cylinders", "platform.pistons"];
/// What the platform itself weighs.
pub const PLATE: &[&str] = &["platform.plate"];
/// What every leg of the platform rests on.
pub const PLATFORM: [&[&str]; 4] = [JOINTS, HOME, LEGS, PLATE];

/// A row of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Assumed {
    /// Its name.
    pub key: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Its numbers with their units; a dash where it has none.
    pub value: &'static str,
    /// `assumed`, `recalled` or `reading`.
    pub status: &'static str,
    /// Why it is so.
    pub reason: &'static str,
}

/// All rows, in the order of the page.
pub fn all() -> impl Iterator<Item = Assumed> {
    PAGE.lines().filter(|line| line.starts_with("| `")).filter_map(|line| {
        let mut cells = line.trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`'));
        let mut next = || cells.next();
        Some(Assumed { key: next()?, what: next()?, value: next()?, status: next()?, reason: next()? })
    })
}

/// The rows with these keys, in the order of the page.
///
/// # Panics
/// If no row has one of them: a program names what there is.
#[must_use]
pub fn of(keys: &[&str]) -> Vec<Assumed> {
    let means = |key: &str, row: &Assumed| if key.ends_with('.') { row.key.starts_with(key) } else { row.key == key };
    for key in keys {
        assert!(all().any(|row| means(key, &row)), "docs/thesis/assumed.md has no {key}");
    }
    all().filter(|row| keys.iter().any(|key| means(key, row))).collect()
}

/// The keys of these rows but one, for a run that was told another value.
#[must_use]
pub fn without(keys: &[&str], told: &str) -> Vec<&'static str> {
    of(keys).into_iter().map(|row| row.key).filter(|key| *key != told).collect()
}

/// Lines under a summary: each with its value, and whether it is recalled or a reading.
#[must_use]
pub fn text(keys: &[&str]) -> String {
    let mut text = String::from("\nassumed (reasons: docs/thesis/assumed.md):\n");
    for Assumed { what, value, status, .. } in of(keys) {
        text += &match (value, status) {
            ("–", _) => format!("  {what}\n"),
            (_, "assumed") => format!("  {what}: {value}\n"),
            _ => format!("  {what}: {value} ({status})\n"),
        };
    }
    text
}

/// What a caption says: `assumed: …`, without values.
#[must_use]
pub fn caption(keys: &[&str]) -> String {
    format!("assumed: {}", of(keys).iter().map(|row| row.what).collect::<Vec<_>>().join("; "))
}

/// The rows by their keys.
#[must_use]
pub fn to_json(keys: &[&str]) -> Value {
    let row = |Assumed { key, what, value, status, reason }: Assumed| {
        (key.to_string(), json!({ "what": what, "value": value, "status": status, "reason": reason }))
    };
    of(keys).into_iter().map(row).collect::<Map<_, _>>().into()
}

/// An object of results with these rows as its `assumed`.
#[must_use]
pub fn with(mut results: Value, keys: &[&str]) -> Value {
    results["assumed"] = to_json(keys);
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_as_the_page_has_them() {
        assert!(all().count() > 50);
        assert!(all().all(|row| ["assumed", "recalled", "reading"].contains(&row.status)));
        let [home] = of(&["platform.home"])[..] else { panic!("one row") };
        assert_eq!((home.value, home.status), ("1.1 m", "assumed"));
        assert_eq!(of(&["arm."]).len(), all().filter(|row| row.key.starts_with("arm.")).count());
        assert_eq!(caption(&["platform.home"]), "assumed: height of the plane of the joints at home");
        let found = with(json!({"a": 1}), &["platform.home"]);
        assert_eq!(found["assumed"]["platform.home"]["value"], "1.1 m");
        assert!(
            text(&["platform.home", "arm.case_2"]).ends_with(
                "on all six joints: 1.5 °/s (reading)\n  height of the plane of the joints at home: 1.1 m\n"
            )
        );
    }
}
