//! What is emitted is read as what it is, and what is damaged is not.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::*;
use crate::Analysis;
use crate::emit::Trigonometry;
use crate::expr::Graph;
use crate::source::Sources;

/// Damages that are made to the text of one mechanism.
const DAMAGES: usize = 400;

/// Derived, not proved; `None` in a package, which has no mechanisms beside it.
pub(super) fn derivation(name: &str) -> Option<Derivation> {
    let path = Path::new("..").join(name).with_extension("mbs");
    let text = std::fs::read_to_string(&path).ok()?;
    Some(derived(&path, text))
}

pub(super) fn derived(path: &Path, text: String) -> Derivation {
    let (name, graph) = (path.display().to_string(), Graph::verbatim());
    match Analysis::of(&Sources::new(&name, &text), &graph) {
        Ok(analysis) => analysis.into_programs(),
        Err(error) => panic!("{}", error.render(&name, &text)),
    }
}

fn emitted(derivation: &Derivation, options: &Options) -> String {
    emit::rust(derivation, "x.mbs", options)
}

#[track_caller]
fn check(derivation: &Derivation, options: &Options) {
    let read = derivation.proofread(Language::Rust, options, &emitted(derivation, options));
    assert!(read.is_ok(), "{}: {}", derivation.name, read.unwrap_err());
}

/// Mechanisms of all constructs that are derived at once.
pub(super) const QUICK: [&str; 17] = [
    "models/mechanisms/pendulum",
    "models/mechanisms/cart_pole",
    "models/mechanisms/double_pendulum",
    "models/mechanisms/four_bar",
    "models/mechanisms/heavy_top",
    "models/mechanisms/kepler",
    "models/mechanisms/n_pendulum",
    "models/mechanisms/quadrotor_quaternion",
    "tests/mechanisms/arm_with_reactions",
    "tests/mechanisms/bouncing_pendulum",
    "tests/mechanisms/branches",
    "tests/mechanisms/keywords",
    "tests/mechanisms/long_branches",
    "tests/mechanisms/measured_slider",
    "tests/mechanisms/rolling_coin",
    "tests/mechanisms/shaken_pendulum",
    "tests/mechanisms/turntable",
];

#[test]
fn what_is_emitted_is_the_programs() {
    let options = [
        Options::default(),
        Options::default().infix(true).serde(true),
        Options::default().trigonometry(Trigonometry::Library),
        Options::default().functions(["linearize", "mass_matrix", "forward_dynamics"]),
    ];
    for derivation in QUICK.iter().filter_map(|name| derivation(name)) {
        options.iter().for_each(|options| check(&derivation, options));
    }
}

// ---- damages

/// A token of the text and where it stands; comments and attributes are left out.
#[derive(Clone, Debug)]
struct Token {
    range: Range<usize>,
    /// How many braces, and how many other brackets, are open around it.
    depth: [usize; 2],
}

fn tokens(code: &str) -> Vec<Token> {
    let (mut tokens, mut at, mut depth) = (Vec::new(), 0, [0, 0]);
    while let Some(c) = code[at..].chars().next() {
        let rest = &code[at..];
        let to = |end: Option<usize>| at + end.unwrap_or(rest.len());
        if c.is_whitespace() {
            at += c.len_utf8();
        } else if rest.starts_with("//") || rest.starts_with("#[") || rest.starts_with("#![") {
            let is_attribute = rest.starts_with('#');
            at = if is_attribute { to(rest.find("]\n").map(|i| i + 1)) } else { to(rest.find('\n')) };
        } else {
            let is_word = |c: char| c.is_alphanumeric() || c == '_';
            let end = if c == '"' {
                to(rest[1..].find('"').map(|i| i + 2))
            } else if c.is_ascii_digit() {
                let of_number = |(i, c): (usize, char)| {
                    let before = rest[..i].chars().last();
                    let digit_behind = rest[i + 1..].starts_with(|c: char| c.is_ascii_digit());
                    !(is_word(c) || (c == '.' && digit_behind) || (c == '-' && before == Some('e')))
                };
                to(rest.char_indices().skip(1).find(|&at| of_number(at)).map(|(i, _)| i))
            } else if is_word(c) {
                to(rest.find(|c: char| !is_word(c)))
            } else if ["::", "->", ".."].iter().any(|two| rest.starts_with(two)) {
                at + 2
            } else {
                at + c.len_utf8()
            };
            match c {
                '}' => depth[0] -= 1,
                ']' | ')' => depth[1] -= 1,
                _ => {}
            }
            tokens.push(Token { range: at..end, depth });
            match c {
                '{' => depth[0] += 1,
                '[' | '(' => depth[1] += 1,
                _ => {}
            }
            at = end;
        }
    }
    tokens
}

/// What to write in place of parts of a text, in the order of the parts.
type Damage = (&'static str, Vec<(Range<usize>, String)>);

fn damages(code: &str) -> Vec<Damage> {
    let tokens = tokens(code);
    let text = |i: usize| tokens.get(i).map_or("", |token| &code[token.range.clone()]);
    let is_name = |text: &str| text.starts_with(|c: char| c.is_alphabetic() || c == '_') && text != "_";
    let mut damages: Vec<Damage> = Vec::new();
    let mut one = |what, i: usize, with: String| damages.push((what, vec![(tokens[i].range.clone(), with)]));
    // The names around, so that a neighbour stands in for each.
    let names: Vec<usize> = (0..tokens.len()).filter(|&i| is_name(text(i))).collect();
    let mut neighbours: BTreeMap<usize, usize> = BTreeMap::new();
    for window in names.windows(12) {
        if let Some(&other) = window.iter().find(|&&other| text(other) != text(window[0])) {
            neighbours.insert(window[0], other);
        }
        if let Some(&other) = window.iter().rev().find(|&&other| text(other) != text(window[11])) {
            neighbours.insert(window[11], other);
        }
    }
    for i in 0..tokens.len() {
        let word = text(i);
        match word {
            "+" => one("a sign", i, "-".to_string()),
            "-" if text(i + 1) != ">" => one("a sign", i, "+".to_string()),
            "*" => one("an operation", i, "/".to_string()),
            "/" => one("an operation", i, "*".to_string()),
            "sin" | "asin" | "sinh" => one("a function", i, word.replace("sin", "cos")),
            "less" => one("a function", i, "less_equal".to_string()),
            _ => {}
        }
        if word == "-" {
            one("a sign left out", i, String::new());
        }
        if word.starts_with(|c: char| c.is_ascii_digit()) {
            let at = word.find('e').unwrap_or(word.len());
            let digit = word[..at].chars().last().and_then(|digit| digit.to_digit(10)).expect("a digit");
            let other = format!("{}{}{}", &word[..at - 1], (digit + 1) % 10, &word[at..]);
            let is_same = |a: &str, b: &str| a.parse::<f64>().ok().is_some_and(|a| Ok(a) == b.parse());
            if !is_same(&other, word) {
                one("a last digit", i, other);
            }
        }
        if let Some(&other) = neighbours.get(&i) {
            one("a name", i, text(other).to_string());
        }
    }
    // Statements left out.
    for (i, end) in tokens.iter().enumerate().filter(|(i, _)| text(*i) == ";") {
        let begins = |j: &usize| {
            let is_mark = matches!(text(*j), ";" | "{" | "}") && tokens[*j].depth[1] == end.depth[1];
            is_mark && tokens[*j].depth[0] + usize::from(text(*j) == "{") == end.depth[0]
        };
        if let Some(before) = (0..i).rev().take(400).find(begins) {
            damages.push(("a statement", vec![(tokens[before].range.end..end.range.end, String::new())]));
        }
    }
    // Neighbours of one list, swapped.
    for (i, comma) in tokens.iter().enumerate().filter(|(i, _)| text(*i) == ",") {
        let is_end = |j: &usize| {
            let token = &tokens[*j];
            let closes = matches!(text(*j), "]" | ")" | "}") && token.depth[1] < comma.depth[1];
            (text(*j) == "," && token.depth == comma.depth) || closes
        };
        let is_start = |j: &usize| {
            let token = &tokens[*j];
            let opens = matches!(text(*j), "[" | "(") && token.depth[1] + 1 == comma.depth[1];
            (text(*j) == "," && token.depth == comma.depth) || opens
        };
        let before = (0..i).rev().take(60).find(is_start);
        let behind = (i + 1..tokens.len()).take(60).find(is_end);
        if let (Some(before), Some(behind), true) = (before, behind, comma.depth[1] > 0) {
            let first = tokens[before].range.end..comma.range.start;
            let second = comma.range.end..tokens[behind].range.start;
            let [a, b] = [&first, &second].map(|range| code[range.clone()].trim().to_string());
            if a != b && !a.is_empty() && !b.is_empty() {
                damages.push(("an order", vec![(first, b), (second, a)]));
            }
        }
    }
    damages
}

fn damaged(code: &str, parts: &[(Range<usize>, String)]) -> String {
    let (mut text, mut at) = (String::with_capacity(code.len()), 0);
    for (range, with) in parts {
        text.push_str(&code[at..range.start]);
        text.push_str(&format!(" {with} "));
        at = range.end;
    }
    text + &code[at..]
}

/// Makes a part of all damages, spread over the text; each that can be read as Rust at all is to be refused.
fn damage(derivation: &Derivation, options: &Options) -> BTreeMap<&'static str, usize> {
    let code = emitted(derivation, options);
    let all = damages(&code);
    let step = all.len().div_ceil(DAMAGES);
    let (mut refused, mut missed) = (BTreeMap::new(), Vec::new());
    for (what, parts) in all.iter().step_by(step) {
        let text = damaged(&code, parts);
        if syn::parse_file(&text).is_err() {
            continue;
        }
        match derivation.proofread(Language::Rust, options, &text) {
            Err(Failure::Misprint { .. }) => *refused.entry(*what).or_insert(0) += 1,
            Err(other) => panic!("{other}"),
            Ok(()) => {
                let line = code[..parts[0].0.start].lines().count();
                let lines: Vec<&str> = text.lines().skip(line.saturating_sub(1)).take(2).collect();
                missed.push(format!("{what} {:?}: {}", parts, lines.join("\n")));
            }
        }
    }
    assert!(missed.is_empty(), "{}: {} missed\n{}", derivation.name, missed.len(), missed.join("\n"));
    refused
}

fn damage_all(names: &[&str], options: &Options) {
    let Some(derivations) = names.iter().map(|name| derivation(name)).collect::<Option<Vec<_>>>() else { return };
    for derivation in derivations {
        let refused = damage(&derivation, options);
        let total: usize = refused.values().sum();
        println!("{}: {total} damages refused: {refused:?}", derivation.name);
        assert!(total > DAMAGES / 4, "{}: {refused:?}", derivation.name);
    }
}

#[test]
fn damaged_texts_are_refused() {
    damage_all(&["models/mechanisms/cart_pole", "models/mechanisms/four_bar"], &Options::default());
}

#[test]
fn damaged_texts_with_branches_and_tables_are_refused() {
    damage_all(&["tests/mechanisms/branches", "tests/mechanisms/measured_slider"], &Options::default());
}

#[test]
fn damaged_texts_with_sines_of_the_library_are_refused() {
    damage_all(&["tests/mechanisms/shaken_pendulum"], &Options::default().trigonometry(Trigonometry::Library));
}

#[test]
fn damaged_texts_with_serde_are_refused() {
    damage_all(&["tests/mechanisms/rolling_coin"], &Options::default().serde(true));
}

/// What stands for bodies is no name of a mechanism's, and nothing but bodies may have it.
#[test]
fn what_stands_for_bodies_is_a_name_like_others() {
    let text = "mechanism Cut { param cut: N/m = 4; coord fn_cut: m; kinetic += 1 kg*dt(fn_cut)^2/2; \
                potential += cut*fn_cut^2/2; }";
    let derivation = derived(Path::new("cut.mbs"), text.to_string());
    check(&derivation, &Options::default());
    let code = emitted(&derivation, &Options::default());
    let forwarded = code.rfind("self.mass_matrix(q)").expect("an implementation of a trait");
    let damaged = format!("{}cut!(3);{}", &code[..forwarded], &code[forwarded + "self.mass_matrix(q)".len()..]);
    assert!(syn::parse_file(&damaged).is_ok());
    assert!(derivation.proofread(Language::Rust, &Options::default(), &damaged).is_err());
}

/// A report says in which function, what is there and what should be.
#[test]
fn a_report_says_where_and_what() {
    let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
    let derivation = derived(Path::new("spring.mbs"), text.to_string());
    let code = emitted(&derivation, &Options::default());
    let report = |from: &str, to: &str| {
        assert!(code.contains(from), "{code}");
        match derivation.proofread(Language::Rust, &Options::default(), &code.replacen(from, to, 1)) {
            Err(Failure::Misprint { function, what }) => format!("{function}: {what}"),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(report("[k * x]", "[x]"), "gravity: component 0: `q_0` instead of `(p_0 * q_0)`");
    assert_eq!(report("k: T::from_f64(4.0)", "k: T::from_f64(4.5)"), "default: `k`: `4.5` instead of `4.0`");
    assert_eq!(report("[k * x]", "[k % x]"), "gravity: `k % x` cannot be read");
}

/// A row of masses with rods between neighbours, whose system is eliminated in a known order.
fn eliminated() -> Derivation {
    let text = "mechanism Train { const n = 52; param k: N/m = 3; coord x[n]: m; potential += k*x[0]^2/2;
        for i in 0..n { kinetic += 2 kg*dt(x[i])^2/2; }
        for i in 1..n { constraint rod[i - 1]: x[i]^2/(1 m) - x[i - 1] = 1 m*sin(2 rad/s*t); } }";
    let derivation = derived(Path::new("train.mbs"), text.to_string());
    assert!(derivation.elimination.is_some());
    derivation
}

#[test]
fn damaged_texts_with_an_order_of_elimination_are_refused() {
    let (derivation, functions) = (eliminated(), ["constraint", "constraint_rate", "forward_dynamics"]);
    let options = Options::default().functions(functions);
    check(&derivation, &options);
    let refused = damage(&derivation, &options);
    assert!(refused.values().sum::<usize>() > DAMAGES / 4, "{refused:?}");
    // Another order that nothing but a trait uses, and a module without the trait.
    let code = emitted(&derivation, &options);
    let is_read = |code: &str| derivation.proofread(Language::Rust, &options, code).is_ok();
    let wrong = code.replacen("0, 51, 1, 52, 2,", "1, 51, 0, 52, 2,", 1);
    let [right, other] = [&code, &code.replacen("const ELIMINATION", "const OTHER", 1)].map(|code| is_read(code));
    assert!(right && !other && wrong != code && !is_read(&wrong));
    let shadowed = wrong.replace("sparse_solve(\n                &ELIMINATION", "sparse_solve(&OTHER");
    let second = code
        [code.find("const ELIMINATION").expect("a constant")..code.find("/// Parameters").expect("a struct")]
        .replace("ELIMINATION", "OTHER");
    assert!(shadowed != wrong && !is_read(&shadowed.replacen("/// Parameters", &format!("{second}/// Parameters"), 1)));
    let begin = code.find("impl<T: ::mbs_runtime::Real>").expect("an implementation");
    let end = begin + code[begin..].find("\n    }\n").expect("its end") + 6;
    assert!(!is_read(&format!("{}{}", &code[..begin], &code[end..])));
}

/// Nothing may stand in storage of the caller but the result, and what is there is not read.
#[test]
fn damaged_results_in_storage_are_refused() {
    let text = "mechanism Row { const n = 92; coord x[n]: m; kinetic += 3 kg*dt(x[0])^2/2;
        for i in 1..n { kinetic += 2 kg*(dt(x[i]) + dt(x[i - 1]))^2/2; } }";
    let derivation = derived(Path::new("row.mbs"), text.to_string());
    let options = Options::default().functions(["mass_matrix", "inverse_dynamics"]);
    check(&derivation, &options);
    let code = emitted(&derivation, &options);
    let end = code.find("pub fn inverse_dynamics").expect("the next function");
    let last = code[..end].rfind("];").expect("the last row") + 2;
    let first = code.find("result[0] = [").expect("the first row");
    let second = code.find("result[1] = [").expect("the second row");
    let damages = [
        format!("{}{}", &code[..first], &code[second..]),
        code.replacen("result[1] = [", "result[0] = [", 1),
        code.replacen("result[91] = [", "result[92] = [", 1),
        code.replacen("result: &mut [[T; 92]; 92]", "result: &mut [[T; 92]; 93]", 1),
    ];
    let behind = [
        "let copy = result; copy[0][0] = zero;",
        "for row in result { row[0] = zero; }",
        "let [first, ..] = result; first[0] = zero;",
        "result[0][0] = zero;",
        "*result = [[zero; 92]; 92];",
        "result[0][1] = result[0][0];",
        "zero",
    ];
    let damages = damages.into_iter().chain(behind.map(|text| format!("{}{text}{}", &code[..last], &code[last..])));
    for (number, damaged) in damages.enumerate() {
        assert!(syn::parse_file(&damaged).is_ok() && damaged != code, "{number}");
        let read = derivation.proofread(Language::Rust, &options, &damaged);
        assert!(matches!(read, Err(Failure::Misprint { .. })), "{number}: {read:?}");
    }
}
