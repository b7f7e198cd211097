//! Names of a file made into names of the language.

use std::collections::BTreeSet;

/// Names that are taken, and what has been made of others.
pub(super) struct Identifiers {
    taken: BTreeSet<String>,
    /// What is called otherwise than in the file: what it is, its name there, its name here.
    pub(super) changed: Vec<(String, String)>,
}

/// What a table of a motion or every mechanism calls otherwise, and the units of the text: `0.1 m` could not be told
/// from a product where a coordinate is called `m`.
const TAKEN: [&str; 20] = [
    "energy",
    "g",
    "gravity",
    "part",
    "shape",
    "at",
    "world",
    "translation",
    "rotation",
    "rpy",
    "quaternion",
    "particle",
    "rigid_body",
    "inertia",
    "sqrt",
    "m",
    "rad",
    "kg",
    "N",
    "s",
];

impl Identifiers {
    /// `is_taken` tells keywords and the like.
    pub(super) fn new() -> Self {
        Identifiers { taken: TAKEN.into_iter().map(str::to_string).collect(), changed: Vec::new() }
    }

    /// A name that nothing has, for what the file calls `name`, with `kind` behind it where it is taken; with
    /// `suffixes` behind it, it is taken as well.
    pub(super) fn claim(
        &mut self,
        what: &str,
        name: &str,
        kind: &str,
        suffixes: &[&str],
        is_word: impl Fn(&str) -> bool,
    ) -> String {
        let plain = plain(name);
        let mut number = 1;
        let found = loop {
            let candidate = match number {
                1 => plain.clone(),
                2 if !kind.is_empty() => format!("{plain}_{kind}"),
                n => format!("{plain}_{n}"),
            };
            let all = || std::iter::once(candidate.clone()).chain(suffixes.iter().map(|s| format!("{candidate}{s}")));
            if !is_word(&candidate) && all().all(|name| !self.taken.contains(&name)) {
                self.taken.extend(all());
                break candidate;
            }
            number += 1;
        };
        if found != name {
            self.changed.push((format!("{what} `{}`", shown(name)), found.clone()));
        }
        found
    }
}

/// A name in the file's own letters for what has none there: `base`, with a number behind it where it is taken.
pub(super) fn spare(base: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{base}_{number}"));
    std::iter::once(base.to_string()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
}

/// ASCII letters, digits and `_`, no digit first.
fn plain(name: &str) -> String {
    let text: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let text = text.trim_matches('_');
    match text.chars().next() {
        None => "unnamed".to_string(),
        Some(first) if first.is_ascii_digit() => format!("n{text}"),
        // Longer names are no easier to tell apart.
        Some(_) => text.chars().take(80).collect(),
    }
}

/// In a comment: on one line, without what would end the quotation.
pub(super) fn shown(name: &str) -> String {
    let text: String = name.chars().take(200).map(|c| if c.is_control() || c == '`' { '?' } else { c }).collect();
    text.trim().to_string()
}

/// The name of a mechanism: `UpperCamelCase`.
pub(super) fn of_mechanism(name: &str) -> String {
    let mut text = String::new();
    for word in plain(name).split('_').filter(|word| !word.is_empty()) {
        let mut letters = word.chars();
        text.extend(letters.next().map(|first| first.to_ascii_uppercase()));
        text.extend(letters);
    }
    if text.is_empty() { "Robot".to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_of_letters_and_unique() {
        let mut names = Identifiers::new();
        let mut claim = |name: &str| names.claim("the link", name, "", &["_mass"], |word| word == "for");
        let expected = [
            ("base link", "base_link"),
            ("base-link", "base_link_2"),
            ("base_link_2", "base_link_2_2"),
            ("arm", "arm"),
            ("arm_mass", "arm_mass_2"),
            ("for", "for_2"),
            ("7dof", "n7dof"),
            ("", "unnamed"),
            ("ärm/θ", "rm"),
            ("energy", "energy_2"),
            ("m", "m_2"),
        ];
        for (name, identifier) in expected {
            assert_eq!(claim(name), identifier, "{name}");
        }
        assert_eq!(names.changed.len(), 10);
        assert_eq!(names.changed[0], ("the link `base link`".to_string(), "base_link".to_string()));
        assert_eq!(["ur5", "my robot-2", "7", "…"].map(of_mechanism), ["Ur5", "MyRobot2", "N7", "Unnamed"]);
    }
}
