//! What is emitted in other languages is read as what it is, and what is damaged is not.

use super::super::tests::{QUICK, derivation};
use super::*;

/// Damages of each language.
const DAMAGES: usize = 200;

fn others() -> impl Iterator<Item = Language> {
    Language::ALL.into_iter().filter(|language| *language != Language::Rust)
}

#[test]
fn what_is_emitted_in_other_languages_is_the_programs() {
    let mut faults = Vec::new();
    for derivation in QUICK.iter().filter_map(|name| derivation(name)) {
        let library = Options::default().trigonometry(Trigonometry::Library);
        let some = Options::default().functions(["linearize", "mass_matrix", "forward_dynamics"]);
        for options in [Options::default(), library, some] {
            for language in others() {
                let text = language.write(&derivation, "x.mbs", &options);
                let read = derivation.proofread(language, &options, &text);
                faults.extend(read.err().map(|fault| format!("{} {}: {fault}", derivation.name, language.name())));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Words without a value of their own.
const KEYWORDS: [&str; 14] = [
    "const", "let", "mbs_real", "int", "return", "if", "else", "end", "void", "for", "new", "function", "self", "this",
];

/// What to write in place of parts of a text, with what that is.
fn damages(dialect: &Dialect, code: &str) -> Vec<(&'static str, std::ops::Range<usize>, String)> {
    let all = tokens(code, &dialect.lexis).expect("tokens");
    let place = |token: &Token<'_>| {
        let at = token.text.as_ptr() as usize - code.as_ptr() as usize;
        at..at + token.text.len()
    };
    let mut damages = Vec::new();
    let routines = routines(dialect, &all).expect("functions");
    let is_own = |name: &str| {
        let shared = name.starts_with("mbs_") || name.starts_with("__") || name == "constructor" || name == "defaults";
        let is_helper =
            ["_new", "_check", "_default_parameters", "_constrained_solution"].iter().any(|end| name.ends_with(end));
        !shared && !is_helper && !name.contains("table_")
    };
    for (_, routine) in routines.iter().filter(|(name, _)| is_own(name)) {
        let Some(routine) = routine else { continue };
        let body = routine.body;
        let is_name = |token: &Token<'_>| token.kind == token::Kind::Name && !KEYWORDS.contains(&token.text);
        let names: Vec<&Token<'_>> = body.iter().filter(|token| is_name(token)).collect();
        let mut line = 0;
        for (i, token) in body.iter().enumerate() {
            if token.kind == token::Kind::End {
                line = i + 1;
                continue;
            }
            // Nothing is computed where compilers are told that an argument may not be read.
            if body[line..i].iter().any(|token| token.is("void")) {
                continue;
            }
            let mut one = |what, with: &str| damages.push((what, place(token), with.to_string()));
            match (token.kind, token.text) {
                (token::Kind::Mark, "+") => one("a sign", "-"),
                (token::Kind::Mark, "-") => one("a sign", "+"),
                (token::Kind::Mark, "*") => one("an operation", "/"),
                (token::Kind::Mark, "/") => one("an operation", "*"),
                (token::Kind::Mark, "<") => one("an operation", "<="),
                (token::Kind::Number, digits) => {
                    let last = digits.chars().last().and_then(|digit| digit.to_digit(10)).expect("a digit");
                    let other = format!("{}{}", &digits[..digits.len() - 1], (last + 1) % 10);
                    if other.parse::<f64>() != digits.parse::<f64>() {
                        one("a last digit", &other);
                    }
                }
                (token::Kind::Name, text) if is_name(token) => {
                    let other = names.iter().filter(|other| other.text != text);
                    if let Some(other) = other.min_by_key(|other| place(other).start.abs_diff(place(token).start)) {
                        one("a name", other.text);
                    }
                }
                _ => {}
            }
        }
        // Lines left out that are statements by themselves.
        for line in body.split(|token| token.kind == token::Kind::End).filter(|line| line.len() > 2) {
            let is_whole = [";", ")", "]"].iter().any(|end| line[line.len() - 1].is(end))
                && !line[0].is("(")
                && !line[0].is("void");
            let closes = |open: &str, close: &str| {
                line.iter().filter(|token| token.is(open)).count()
                    == line.iter().filter(|token| token.is(close)).count()
            };
            if is_whole && closes("(", ")") && closes("[", "]") && closes("{", "}") {
                damages.push(("a statement", place(&line[0]).start..place(&line[line.len() - 1]).end, String::new()));
            }
        }
    }
    damages
}

/// Makes a part of all damages, spread over the text; each is to be refused.
#[test]
fn damaged_texts_of_other_languages_are_refused() {
    let names = ["models/mechanisms/four_bar", "tests/mechanisms/branches", "tests/mechanisms/measured_slider"];
    let Some(derivations) = names.iter().map(|name| derivation(name)).collect::<Option<Vec<_>>>() else { return };
    let (options, mut missed) = (Options::default(), Vec::new());
    for (derivation, language) in derivations.iter().flat_map(|d| others().map(move |language| (d, language))) {
        let code = language.write(derivation, "x.mbs", &options);
        let dialect = Dialect::of(language, options.trigonometry).expect("another language");
        let all = damages(&dialect, &code);
        let mut refused: BTreeMap<&str, usize> = BTreeMap::new();
        for (what, range, with) in all.iter().step_by(all.len().div_ceil(DAMAGES)) {
            let text = [&code[..range.start], " ", with, " ", &code[range.end..]].concat();
            match derivation.proofread(language, &options, &text) {
                Err(_) => *refused.entry(what).or_default() += 1,
                Ok(()) => {
                    let line = code[..range.start].rfind('\n').map_or(0, |at| at + 1);
                    let shown = code[line..].lines().next().unwrap_or_default().trim();
                    let was = &code[range.clone()];
                    missed.push(format!(
                        "{} {}: {what} `{was}` → `{with}` in `{shown}`",
                        derivation.name,
                        language.name()
                    ));
                }
            }
        }
        println!("{} {}: {refused:?}", derivation.name, language.name());
        assert!(
            refused.values().sum::<usize>() + missed.len() > DAMAGES / 4,
            "{} {}",
            derivation.name,
            language.name()
        );
    }
    assert!(missed.is_empty(), "{} missed\n{}", missed.len(), missed.join("\n"));
}
