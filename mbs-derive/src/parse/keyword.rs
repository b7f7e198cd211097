//! The words that cannot be names.

/// What a statement begins with.
pub(super) const STATEMENTS: [&str; 17] = [
    "param",
    "coord",
    "input",
    "prescribed",
    "const",
    "fn",
    "let",
    "for",
    "kinetic",
    "potential",
    "dissipation",
    "lagrangian",
    "force",
    "torque",
    "reaction",
    "constraint",
    "output",
];

/// What else a statement begins with, words that may be names all the same: what stands behind them tells.
pub(super) const CONTEXTUAL: [&str; 3] = ["gravity", "part", "shape"];

/// What `shape pose +=` adds; words that may be names all the same.
pub(super) const SHAPES: [&str; 4] = ["box", "cylinder", "sphere", "mesh"];

/// Parts of statements.
const PARTS: [&str; 6] = ["mechanism", "import", "mut", "in", "if", "else"];

/// Words that have a meaning behind others alone.
const BEHIND: [&str; 4] = ["at", "on", "positive", "jacobian_rate"];

/// Names that every mechanism knows from the start.
const BUILT_IN: [(&str, &str); 4] =
    [("t", "the time"), ("world", "the frame at rest"), ("pi", "the number π"), ("deg", "the degree")];

/// All keywords, and the names that every mechanism knows, with what they are.
pub(super) fn words() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    let keywords = STATEMENTS.into_iter().chain(CONTEXTUAL).chain(PARTS).chain(BEHIND);
    keywords.map(|word| ("keyword", word, "")).chain(BUILT_IN.into_iter().map(|(word, what)| ("constant", word, what)))
}

/// What `word` is, if it is a keyword, as the end of a sentence: `param` is "a keyword of the language".
pub(super) fn keyword(word: &str) -> Option<&'static str> {
    if STATEMENTS.contains(&word) || PARTS.contains(&word) { Some("a keyword of the language") } else { None }
}

/// What `word` is, if it cannot be declared: a keyword or a name that every mechanism knows.
pub(super) fn taken(word: &str) -> Option<&'static str> {
    let built_in = || BUILT_IN.iter().find(|(name, _)| *name == word).map(|&(_, what)| what);
    keyword(word).or_else(built_in)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tells_keywords_from_names() {
        assert_eq!(keyword("force"), Some("a keyword of the language"));
        assert_eq!(keyword("torque"), Some("a keyword of the language"));
        assert_eq!(keyword("else"), Some("a keyword of the language"));
        assert_eq!(taken("match"), None, "code generation escapes the keywords of Rust");
        assert_eq!(keyword("t"), None);
        assert_eq!(taken("t"), Some("the time"));
        assert_eq!(taken("theta"), None);
        assert_eq!(taken("union"), None);
    }

    /// The manual lists the keywords and the built-in names, and no others.
    #[test]
    fn words_are_those_of_the_manual() {
        let Some(manual) = crate::model::manual::manual() else { return };
        let listed = |from: &str, to: &str| {
            let text = manual.split_once(from).and_then(|(_, rest)| rest.split_once(to)).expect("the list").0;
            let mut words: Vec<&str> =
                text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).collect();
            words.sort();
            words
        };
        let sorted = |mut words: Vec<&'static str>| {
            words.sort();
            words
        };
        let keywords = sorted(STATEMENTS.into_iter().chain(PARTS).collect());
        assert_eq!(listed("keywords of the language (`", "`)"), keywords);
        assert_eq!(listed("words that may be names all the same (`", "`)"), sorted(CONTEXTUAL.to_vec()));
        let built_in = sorted(BUILT_IN.iter().map(|(name, _)| *name).collect());
        assert_eq!(listed("and the built-in values ", "`."), built_in);
    }
}
