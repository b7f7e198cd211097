//! Names that a crate can have.

use std::path::Path;

use crate::failure::Failure;

/// Keywords of Rust: a crate's name is one of its paths.
const KEYWORDS: [&str; 52] = [
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super", "trait", "true",
    "try", "type", "typeof", "union", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Names that a crate cannot have: crates and folders of the compiler and of cargo, reserved file names of Windows,
/// crates that the new one depends on.
const TAKEN: [&str; 26] = [
    "alloc",
    "aux",
    "build",
    "com1",
    "com2",
    "com3",
    "com4",
    "con",
    "core",
    "deps",
    "examples",
    "incremental",
    "insta",
    "lpt1",
    "lpt2",
    "lpt3",
    "mbs_derive",
    "mbs_runtime",
    "nul",
    "prn",
    "proc_macro",
    "rayon",
    "static",
    "std",
    "test",
    "tests",
];

const LONGEST: usize = 64;

/// The last part of the path, if cargo takes it as a name.
pub(super) fn of(folder: &Path) -> Result<String, Failure> {
    let refused = |why: &str| Failure::new(format_args!("{} cannot name a crate: {why}", folder.display()));
    let name = folder.file_name().ok_or_else(|| refused("write the name of a new folder"))?;
    let name = name.to_str().ok_or_else(|| refused("it is not UTF-8 text"))?;
    match problem(name) {
        None => Ok(name.to_string()),
        Some(why) => Err(refused(why)),
    }
}

fn problem(name: &str) -> Option<&'static str> {
    let plain = name.replace('-', "_").to_ascii_lowercase();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        Some("it begins with a letter")
    } else if !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_') {
        Some("it is made of ASCII letters, digits, `-` and `_`")
    } else if name.len() > LONGEST {
        Some("it is longer than 64 characters")
    } else if KEYWORDS.contains(&name) {
        Some("it is a keyword of Rust")
    } else if TAKEN.contains(&plain.as_str()) {
        Some("the name is taken, by the system, by cargo, or by what the crate depends on")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_cargo_takes() {
        for good in ["pendulum", "my-robot", "a", "Arm_2", "x9", "selfie"] {
            assert_eq!(problem(good), None, "{good}");
        }
        let long = "a".repeat(65);
        for bad in
            ["2r", "", "-a", "_a", "a b", "a.b", "ä", "self", "gen", "test", "Test", "nul", "CON", "mbs-derive", &long]
        {
            assert!(problem(bad).is_some(), "{bad}");
        }
        assert!(of(Path::new("..")).is_err() && of(Path::new("/")).is_err() && of(Path::new("")).is_err());
        assert_eq!(of(Path::new("robots/picker")).unwrap(), "picker");
    }
}
