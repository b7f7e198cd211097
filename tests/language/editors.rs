//! What editors are given about the language: its words are those of the grammars in `editors/`, and what is written in
//! place of a mistake mends it.

use std::path::Path;

use mbs_derive::diagnostic::Diagnostic;
use mbs_derive::source::Sources;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(ROOT).join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The words of a text.
fn words(text: &str) -> Vec<&str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').collect()
}

#[test]
fn grammars_know_the_words_of_the_language() {
    let texts = [
        ("unit", "editors/tree-sitter-mbs/src/scanner.c"),
        ("unit", "editors/vscode/syntaxes/mbs.tmLanguage.json"),
        ("function", "editors/tree-sitter-mbs/queries/highlights.scm"),
        ("function", "editors/vscode/syntaxes/mbs.tmLanguage.json"),
        ("constant", "editors/tree-sitter-mbs/queries/highlights.scm"),
        ("constant", "editors/vscode/syntaxes/mbs.tmLanguage.json"),
        ("keyword", "editors/tree-sitter-mbs/grammar.js"),
        ("keyword", "editors/tree-sitter-mbs/queries/highlights.scm"),
        ("keyword", "editors/vscode/syntaxes/mbs.tmLanguage.json"),
    ];
    // Functions that are written in the language itself are coloured as those of the user.
    let library = ["spring", "coulomb_stribeck", "contact"];
    for (wanted, path) in texts {
        // The words behind `\b` of a regular expression are words.
        let text = read(path).replace("\\\\b", " ");
        let known = words(&text);
        for (kind, word, _) in Sources::words() {
            let is_known = known.contains(&word.as_str());
            assert!(
                kind != wanted || is_known || library.contains(&word.as_str()),
                "{path} does not know the {kind} `{word}`"
            );
        }
    }
}

/// The first error with what may be written instead.
fn fixable(sources: &Sources) -> Option<(Diagnostic, std::ops::Range<usize>, String)> {
    let (errors, _) = sources.surveyed();
    let text = sources.main().text.as_deref().ok()?;
    errors.iter().find_map(|error| error.replacement(text).map(|(span, with)| (error.clone(), span, with)))
}

#[test]
fn what_is_written_instead_mends_it() {
    let folder = Path::new(ROOT).join("tests/bad");
    let mut files: Vec<_> = std::fs::read_dir(folder).expect("bad/").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let mut mended = 0;
    for file in files.iter().filter(|file| file.extension().is_some_and(|extension| extension == "mbs")) {
        let Ok(mut text) = std::fs::read_to_string(file) else { continue };
        let folder = file.parent().expect("a folder");
        let missing = |_: std::io::Error| mbs_derive::source::Unreadable::new("there is no such file", "");
        let gathered =
            |text: &str| Sources::gather("bad.mbs", text, |name| std::fs::read(folder.join(name)).map_err(missing));
        for _ in 0..20 {
            let sources = gathered(&text);
            let Some((error, span, with)) = fixable(&sources) else { break };
            text.replace_range(span.clone(), &with);
            let again = gathered(&text);
            let (errors, _) = again.surveyed();
            let is_there = errors.iter().any(|other| other.message == error.message && other.span.start == span.start);
            assert!(!is_there, "{}: `{with}` does not mend: {error}\n{text}", file.display());
            mended += 1;
        }
    }
    assert!(mended > 15, "{mended}");
}
