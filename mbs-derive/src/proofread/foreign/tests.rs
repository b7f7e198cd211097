//! What is emitted in other languages is read as what it is, and what is damaged is not.

use std::collections::BTreeMap;
use std::ops::Range;

use super::super::tests::{QUICK, derivation, derived};
use super::*;
use crate::Analysis;
use crate::emit::Trigonometry;
use crate::expr::Graph;
use crate::source::Sources;

fn others() -> impl Iterator<Item = Language> {
    Language::ALL.into_iter().filter(|language| *language != Language::Rust)
}

#[test]
fn what_is_emitted_in_other_languages_is_the_programs() {
    let mut faults = Vec::new();
    let library = Options::default().trigonometry(Trigonometry::Library);
    let some = Options::default().functions(["linearize", "mass_matrix", "forward_dynamics"]);
    let all = [Options::default(), library, some];
    for (i, derivation) in QUICK.iter().filter_map(|name| derivation(name)).enumerate() {
        // What options change is the same in all mechanisms.
        for options in if i % 4 == 0 { &all[..] } else { &all[..1] } {
            for language in others() {
                let text = language.write(&derivation, "x.mbs", options);
                let read = derivation.proofread(language, options, &text);
                faults.extend(read.err().map(|fault| format!("{} {}: {fault}", derivation.name, language.name())));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

// ---- damages

/// What to write in place of a part of a text, and what kind of damage that is.
type Damage = (&'static str, Range<usize>, String);

/// Where a text has what files share.
fn shared(dialect: &Dialect, code: &str) -> Vec<Range<usize>> {
    let pieces = emit::shared(dialect.language).into_iter();
    pieces.filter_map(|piece| code.find(piece).map(|start| start..start + piece.len())).collect()
}

/// Damages at all tokens of a text but those that files share.
fn damages(dialect: &Dialect, code: &str) -> Vec<Damage> {
    let all = tokens(code, &dialect.lexis).expect("tokens");
    let shared = shared(dialect, code);
    let is_shared = |at: usize| shared.iter().any(|range| range.contains(&at));
    let place = |token: &Token<'_>| {
        let at = token.text.as_ptr() as usize - code.as_ptr() as usize;
        at..at + token.text.len()
    };
    let of_statements = all.iter().filter(|token| !matches!(token.kind, Kind::Line | Kind::Directive));
    let own = of_statements.map(|token| (place(token), *token)).filter(|(range, _)| !is_shared(range.start));
    let own: Vec<(Range<usize>, Token<'_>)> = own.collect();
    let mut damages = Vec::new();
    for (i, (range, token)) in own.iter().enumerate() {
        let mut one = |what, with: &str| damages.push((what, range.clone(), with.to_string()));
        let is_next = |mark: &str| own.get(i + 1).is_some_and(|(_, next)| next.is(mark));
        match (token.kind, token.text) {
            (Kind::Mark, "+") => one("a sign", "-"),
            (Kind::Mark, "-") => one("a sign", "+"),
            (Kind::Mark, "*") => one("an operation", "/"),
            (Kind::Mark, "/") => one("an operation", "*"),
            (Kind::Mark, "<") => one("a comparison", "<="),
            (Kind::Mark, "<=") => one("a comparison", "<"),
            (Kind::Mark, "&&" | "&") => one("an operation", "+"),
            (Kind::Number, digits) => {
                let at = digits.find('e').unwrap_or(digits.len());
                let digit = digits[..at].chars().last().and_then(|digit| digit.to_digit(10)).expect("a digit");
                let other = format!("{}{}{}", &digits[..at - 1], (digit + 1) % 10, &digits[at..]);
                if other.parse::<f64>() != digits.parse::<f64>() {
                    one("a last digit", &other);
                }
            }
            (Kind::Name, text) => {
                for function in ["sin", "less", "forward", "position", "qdd", "const"] {
                    if text.contains(function) {
                        one("a part of a name", &text.replace(function, "cos"));
                    }
                }
                let around = own[i.saturating_sub(20)..].iter().take(40);
                let mut others = around.filter(|(_, other)| other.kind == Kind::Name && other.text != text);
                if let Some((_, other)) = others.nth(i % 3) {
                    one("a name", other.text);
                }
            }
            (Kind::Text, text) => one("a text", &format!("{}x{}", &text[..1], &text[1..])),
            _ => {}
        }
        // A comma behind the last entry is there or not.
        let is_trailing = token.is(",") && ["]", ")", "}"].iter().any(|mark| is_next(mark));
        if !is_trailing {
            one("a token left out", "");
        }
    }
    // Operands that change places, and entries of lists.
    for (i, window) in own.windows(3).enumerate() {
        let [(first, a), (_, between), (last, b)] = window else { continue };
        let is_word = |token: &Token<'_>| matches!(token.kind, Kind::Name | Kind::Number);
        let is_alone = ["-", "/", ",", "<"].iter().any(|mark| between.is(mark))
            && own.get(i + 3).is_none_or(|(_, next)| [",", ")", ";", "]"].iter().any(|mark| next.is(mark)))
            && i.checked_sub(1).is_some_and(|before| ["(", "=", ",", "["].iter().any(|mark| own[before].1.is(mark)));
        // Names are declared in any order.
        let line = code[..first.start].rfind('\n').map_or(0, |at| at + 1);
        let begin = code[line..first.start].trim_start();
        let is_declaration = ["mbs_real ", "let "].iter().any(|word| begin.starts_with(word)) && !begin.contains('=');
        if is_word(a) && is_word(b) && a.text != b.text && is_alone && !is_declaration {
            let swapped = format!("{} {} {}", b.text, between.text, a.text);
            damages.push(("an order", first.start..last.end, swapped));
        }
    }
    damages
}

/// Lines left out that are statements by themselves, and lines of two sides exchanged.
fn lines_left_out(dialect: &Dialect, code: &str) -> Vec<Damage> {
    let (mut damages, shared) = (Vec::new(), shared(dialect, code));
    let mut at = 0;
    for line in code.split_inclusive('\n') {
        let range = at..at + line.len();
        at = range.end;
        let is_inside = line.starts_with("  ") || dialect.family == Family::Matlab;
        let is_statement = line.contains(" = ") && [";\n", ")\n", "]\n"].iter().any(|end| line.ends_with(end));
        let is_comment = [" *", " /*", "%", "#"].iter().any(|start| line.trim_start_matches("   ").starts_with(start));
        let is_shared = shared.iter().any(|shared| shared.contains(&range.start));
        if is_inside && is_statement && !is_comment && !is_shared {
            damages.push(("a statement", range, String::new()));
        }
    }
    damages
}

/// Makes this many of all damages, spread over the text, each of which is to be refused.
#[track_caller]
fn damage(
    derivation: &Derivation,
    language: Language,
    options: &Options,
    count: usize,
) -> BTreeMap<&'static str, usize> {
    let code = language.write(derivation, "x.mbs", options);
    let dialect = Dialect::of(language, options.trigonometry).expect("another language");
    let mut all = damages(&dialect, &code);
    all.extend(lines_left_out(&dialect, &code));
    let (mut refused, mut missed) = (BTreeMap::new(), Vec::new());
    for (what, range, with) in all.iter().step_by(all.len().div_ceil(count)) {
        let text = [&code[..range.start], with.as_str(), &code[range.end..]].concat();
        match derivation.proofread(language, options, &text) {
            Err(Failure::Misprint { .. }) => *refused.entry(*what).or_default() += 1,
            Err(other) => panic!("{other}"),
            Ok(()) => {
                let line = code[..range.start].rfind('\n').map_or(0, |at| at + 1);
                let shown = code[line..].lines().next().unwrap_or_default().trim();
                missed.push(format!("{what} `{}` → `{with}` in `{shown}`", &code[range.clone()]));
            }
        }
    }
    let (name, missing) = (&derivation.name, missed.join("\n"));
    assert!(missed.is_empty(), "{name} {}: {} missed\n{missing}", language.name(), missed.len());
    refused
}

#[test]
fn damaged_texts_of_other_languages_are_refused() {
    let names = ["models/mechanisms/four_bar", "tests/mechanisms/branches", "tests/mechanisms/measured_slider"];
    let count = std::env::var("MBS_CASES").ok().and_then(|count| count.parse().ok()).unwrap_or(100);
    for derivation in names.iter().filter_map(|name| derivation(name)) {
        for language in others() {
            let refused = damage(&derivation, language, &Options::default(), count);
            println!("{} {}: {refused:?}", derivation.name, language.name());
            assert!(refused.values().sum::<usize>() > count / 3, "{} {}", derivation.name, language.name());
        }
    }
}

#[test]
fn damaged_loops_are_refused() {
    let text = "mechanism Chain {
        coord q[40]: rad;
        let mut link = world;
        for i in 0..40 {
            link = link * rot_z(q[i]) * rot_x(1) * translation([1 m, 0, 0]);
            kinetic += particle(2 kg, link.point([1 m, 2 m, 0]));
        }
    }";
    let options = Options::default().functions(["inverse_dynamics"]);
    let graph = Graph::verbatim();
    let analysis = Analysis::with_options(&Sources::new("chain.mbs", text), &graph, &options).expect("a chain");
    let derivation = analysis.programs();
    for (language, begin, index) in [
        (Language::C, "for (int i = ", "const mbs_real i = MBS_C(3.0);"),
        (Language::Js, "for (let i = ", "const i = 3.0;"),
        (Language::Python, "for i in ", "            i = 3.0"),
        (Language::Matlab, "for k = ", "k = 3.0;"),
    ] {
        let refused = damage(derivation, language, &options, 100);
        assert!(refused.values().sum::<usize>() > 33, "{}", language.name());
        // The index may not be given another value.
        let code = language.write(derivation, "chain.mbs", &options);
        let head = code.find(begin).expect("a loop");
        let behind = head + code[head..].find('\n').expect("a line") + 1;
        let wrong = [&code[..behind], index, "\n", &code[behind..]].concat();
        assert!(derivation.proofread(language, &options, &wrong).is_err(), "{}", language.name());
    }
}

/// Blanks part the entries of a row in MATLAB, and `%{` begins a comment of several lines.
#[test]
fn blanks_within_brackets_of_matlab_are_read() {
    let text = "mechanism Cable {
        param m[40]: kg = 1;
        coord q[40]: rad;
        let mut link = world;
        for i in 0..40 {
            link = link * rot_z(q[i]) * rot_x(1) * translation([1 m, 0, 0]);
            kinetic += particle(m[i], link.point([1 m, 2 m, 0]));
        }
    }";
    let options = Options::default().functions(["inverse_dynamics"]);
    let graph = Graph::verbatim();
    let analysis = Analysis::with_options(&Sources::new("cable.mbs", text), &graph, &options).expect("a chain");
    let code = Language::Matlab.write(analysis.programs(), "cable.mbs", &options);
    let read = |code: &str| analysis.programs().proofread(Language::Matlab, &options, code);
    let (before, list) = code.split_once("values = [ ...\n    ").expect("a list");
    for entry in ["- ", "0.0 -", "0.0 - "] {
        assert!(read(&[before, "values = [ ...\n    ", entry, list].concat()).is_err(), "{entry}");
    }
    let (before, head) = code.split_once("for k = ").expect("a loop");
    assert!(read(&[before, "%{\n%}\nfor k = ", head].concat()).is_err());
    assert!(read(&code).is_ok());
}

/// Operands of a product may change places, those of a quotient not; and a report says where and what.
#[test]
fn what_has_the_same_value_is_told_from_what_has_not() {
    let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
    let derivation = derived(std::path::Path::new("spring.mbs"), text.to_string());
    for language in others() {
        let code = language.write(&derivation, "spring.mbs", &Options::default());
        let read = |with: &str| {
            assert!(code.contains("k * x"), "{code}");
            derivation.proofread(language, &Options::default(), &code.replace("k * x", with))
        };
        assert!(read("x * k").is_ok(), "{}", language.name());
        assert!(read("(x * k)").is_ok(), "{}", language.name());
        match read("k / x") {
            Err(Failure::Misprint { what, .. }) => assert_eq!(what, "`(p_0 / q_0)` instead of `(p_0 * q_0)`"),
            other => panic!("{}: {other:?}", language.name()),
        }
        assert!(read("x / k").is_err() && read("k * k").is_err(), "{}", language.name());
    }
}

/// Names of pieces that files share, of macros of C++ and of modules of Python, and such words in documentation.
#[test]
fn names_that_are_taken_are_read_as_others() {
    let text = "mechanism Mbs {
        /// Read with math, a dataclass, a SimpleNamespace and mbs_solve.
        param EOF: kg = 1;
        coord math: m; coord errno: m; input SimpleNamespace: N;
        kinetic += EOF*(dt(math)^2 + dt(errno)^2)/2;
        force math += SimpleNamespace;
        output mbs_height = 2*math; output MBS_FN = errno; output np = math; output std = errno;
    }";
    let derivation = derived(std::path::Path::new("mbs.mbs"), text.to_string());
    for language in others() {
        let options = Options::default();
        let text = language.write(&derivation, "mbs.mbs", &options);
        derivation.proofread(language, &options, &text).unwrap_or_else(|fault| panic!("{}: {fault}", language.name()));
        if language == Language::Python {
            assert!(text.contains("def np_2(") && !text.contains("import math"), "{text}");
        }
    }
}

/// `c_q` is what C calls a coordinate `q`, and a coordinate of this name beside it another.
#[test]
fn names_that_read_like_others_are_told_apart() {
    let text = "#![dimensionless] mechanism Namesakes { param k: 1 = 2; param py_in: 1 = 3;
        coord q: 1; coord c_q: 1; coord js_q: 1; coord py_q: 1; coord m_q: 1;
        kinetic += (dt(q)^2 + dt(c_q)^2 + dt(js_q)^2 + dt(py_q)^2 + dt(m_q)^2)/2;
        potential += k*q^2*c_q + q*js_q^2*py_in + q*py_q^3 + q*m_q^4;
        output coordinates = q; output coordinates_2 = c_q; }";
    let derivation = derived(std::path::Path::new("namesakes.mbs"), text.to_string());
    for language in others() {
        let options = Options::default();
        let text = language.write(&derivation, "namesakes.mbs", &options);
        derivation.proofread(language, &options, &text).unwrap_or_else(|fault| panic!("{}: {fault}", language.name()));
    }
}
