//! Examples run as outside programs, and what they print.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// Runs a program to its end.
pub(crate) fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).output().unwrap()
}

/// Standard output of a run that ends with 0 and no complaint.
pub(crate) fn good(program: &str, arguments: &[&str]) -> String {
    let output = run(program, arguments);
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
    String::from_utf8(output.stdout).unwrap()
}

/// What a program complains of that is called wrongly, and does nothing else.
#[track_caller]
pub(crate) fn refused(program: &str, arguments: &[&str]) -> String {
    let output = run(program, arguments);
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}: {told}");
    assert!(told.starts_with("error: "), "{arguments:?}: {told}");
    told
}

/// The SVG of a figure, which is there as PNG, too; both are whole, and there is no NaN in the SVG.
#[track_caller]
pub(crate) fn figure(folder: &Path, name: &str) -> String {
    let svg = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"), "{name}");
    let png = std::fs::read(folder.join(format!("{name}.png"))).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 1000, "{name}");
    svg
}

/// The JSON that a program or a file is.
pub(crate) fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// Those of an object, in order.
pub(crate) fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

/// All numbers in a value of nested arrays, in order.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        other => vec![other.as_f64().unwrap_or_else(|| panic!("{other} is not a number"))],
    }
}

/// The number that a value is.
pub(crate) fn number(value: &Value) -> f64 {
    numbers(value)[0]
}
