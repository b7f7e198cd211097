//! A good text, damaged: tokens deleted, doubled, swapped, replaced by others of the language; numbers, units and
//! brackets changed; stray bytes; truncation.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};

/// One change. Places count tokens, spaces and comments not among them; noise and truncation count bytes.
#[derive(Clone, Debug)]
pub enum Edit {
    /// A token is left out.
    Delete(Index),
    /// This many tokens are written twice.
    Duplicate(Index, usize),
    /// Two tokens change places.
    Swap(Index, Index),
    /// A token is replaced by one that stands elsewhere in the text.
    Copy(Index, Index),
    /// A token is replaced by a word of the language.
    Replace(Index, &'static str),
    /// A name is replaced by one that stands elsewhere in the text.
    Name(Index, Index),
    /// A word of the language is put before a token.
    Insert(Index, &'static str),
    /// A number is replaced.
    Number(Index, &'static str),
    /// A unit is replaced.
    Unit(Index, &'static str),
    /// A bracket is replaced.
    Bracket(Index, &'static str),
    /// A byte is replaced.
    Noise(Index, u8),
    /// The text ends before a byte.
    Truncate(Index),
}

/// One change of any kind.
pub fn edit() -> impl Strategy<Value = Edit> {
    let at = any::<Index>;
    prop_oneof![
        3 => at().prop_map(Edit::Delete),
        2 => (at(), 1..12_usize).prop_map(|(at, count)| Edit::Duplicate(at, count)),
        2 => (at(), at()).prop_map(|(one, other)| Edit::Swap(one, other)),
        2 => (at(), at()).prop_map(|(to, from)| Edit::Copy(to, from)),
        10 => (at(), at()).prop_map(|(to, from)| Edit::Name(to, from)),
        3 => (at(), select(WORDS)).prop_map(|(at, word)| Edit::Replace(at, word)),
        1 => (at(), select(WORDS)).prop_map(|(at, word)| Edit::Insert(at, word)),
        10 => (at(), select(NUMBERS)).prop_map(|(at, number)| Edit::Number(at, number)),
        4 => (at(), select(UNITS)).prop_map(|(at, unit)| Edit::Unit(at, unit)),
        1 => (at(), select(BRACKETS)).prop_map(|(at, bracket)| Edit::Bracket(at, bracket)),
        1 => (at(), any::<u8>()).prop_map(|(at, byte)| Edit::Noise(at, byte)),
        1 => at().prop_map(Edit::Truncate),
    ]
}

/// A few changes, to be made one after the other.
pub fn edits() -> impl Strategy<Value = Vec<Edit>> {
    vec(edit(), 1..4)
}

/// The text with all changes made.
pub fn damaged(text: &str, edits: &[Edit]) -> Vec<u8> {
    edits.iter().fold(text.as_bytes().to_vec(), applied)
}

fn applied(mut bytes: Vec<u8>, edit: &Edit) -> Vec<u8> {
    match edit {
        Edit::Noise(at, byte) if !bytes.is_empty() => {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
            bytes
        }
        Edit::Truncate(at) if !bytes.is_empty() => {
            bytes.truncate(at.index(bytes.len()));
            bytes
        }
        // What is no text any more has no tokens either.
        edit => match String::from_utf8(bytes) {
            Ok(text) => rewritten(&text, edit).into_bytes(),
            Err(error) => error.into_bytes(),
        },
    }
}

fn rewritten(text: &str, edit: &Edit) -> String {
    let mut parts = tokens(text);
    let among = |wanted: fn(&str) -> bool, at: &Index| {
        let places: Vec<usize> = (0..parts.len()).filter(|&i| wanted(parts[i])).collect();
        if places.is_empty() { None } else { Some(places[at.index(places.len())]) }
    };
    match edit {
        Edit::Delete(at) => {
            if let Some(at) = among(is_token, at) {
                parts.remove(at);
            }
        }
        Edit::Duplicate(at, count) => {
            if let Some(at) = among(is_token, at) {
                let copy = parts[at..parts.len().min(at + count)].to_vec();
                parts.splice(at..at, copy);
            }
        }
        Edit::Swap(one, other) => {
            if let (Some(one), Some(other)) = (among(is_token, one), among(is_token, other)) {
                parts.swap(one, other);
            }
        }
        Edit::Copy(to, from) => {
            if let (Some(to), Some(from)) = (among(is_token, to), among(is_token, from)) {
                parts[to] = parts[from];
            }
        }
        Edit::Name(to, from) => {
            if let (Some(to), Some(from)) = (among(is_name, to), among(is_name, from)) {
                parts[to] = parts[from];
            }
        }
        Edit::Insert(at, word) => {
            if let Some(at) = among(is_token, at) {
                parts.splice(at..at, [*word, " "]);
            }
        }
        Edit::Replace(at, word) => among(is_token, at).into_iter().for_each(|at| parts[at] = word),
        Edit::Number(at, number) => among(is_number, at).into_iter().for_each(|at| parts[at] = number),
        Edit::Unit(at, unit) => among(is_unit, at).into_iter().for_each(|at| parts[at] = unit),
        Edit::Bracket(at, bracket) => among(is_bracket, at).into_iter().for_each(|at| parts[at] = bracket),
        Edit::Noise(..) | Edit::Truncate(_) => {}
    }
    parts.concat()
}

/// The text cut into words, numbers, operators, and what stands between them.
pub fn tokens(text: &str) -> Vec<&str> {
    let (mut found, mut rest) = (Vec::new(), text);
    while !rest.is_empty() {
        let (token, after) = rest.split_at(length(rest));
        found.push(token);
        rest = after;
    }
    found
}

/// How long the first part of a text is that is not empty.
fn length(text: &str) -> usize {
    let of = |belongs: fn(char) -> bool| text.find(|c| !belongs(c)).unwrap_or(text.len());
    if text.starts_with("//") {
        return text.find('\n').unwrap_or(text.len());
    }
    if let Some(operator) =
        ["&&", "||", "<=", ">=", "+=", "..", "#![dimensionless]"].iter().find(|o| text.starts_with(**o))
    {
        return operator.len();
    }
    match text.chars().next() {
        Some(c) if c.is_whitespace() => of(char::is_whitespace),
        Some('0'..='9') => number_length(text),
        Some(c) if is_word(c) => of(is_word),
        Some(c) => c.len_utf8(),
        None => 0,
    }
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Digits, a point that no second one follows, an exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let goes_on = |i: usize| match bytes[i] {
        b'.' => bytes.get(i + 1).is_some_and(u8::is_ascii_digit),
        b'-' | b'+' => matches!(bytes[i - 1], b'e' | b'E'),
        c => c.is_ascii_alphanumeric() || c == b'_',
    };
    (1..bytes.len()).find(|&i| !goes_on(i)).unwrap_or(bytes.len())
}

fn is_token(part: &str) -> bool {
    !part.starts_with("//") && !part.trim().is_empty()
}

fn is_number(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_digit())
}

/// Keywords are among the names that are put elsewhere, but seldom: they are few.
fn is_name(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

fn is_unit(part: &str) -> bool {
    UNITS.contains(&part)
}

fn is_bracket(part: &str) -> bool {
    BRACKETS.contains(&part)
}

const BRACKETS: &[&str] = &["(", ")", "[", "]", "{", "}"];

const UNITS: &[&str] = &[
    "kg", "g", "t", "m", "km", "mm", "um", "s", "ms", "min", "h", "rad", "deg", "N", "kN", "J", "W", "Pa", "GPa", "Hz",
    "A", "V", "C", "T", "Wb", "H", "F", "ohm", "K", "mol", "cd", "1", "1/s", "m^(1/2)", "m^100", "s^-99", "lb",
    "Newton",
];

/// Zero, huge, tiny, negative; lengths of arrays and of loops among them.
const NUMBERS: &[&str] = &[
    "0",
    "1",
    "2",
    "3",
    "-1",
    "0.5",
    "1.5",
    "-0.0",
    "1e300",
    "1e308",
    "9e999",
    "1e-300",
    "1e-400",
    "1e9",
    "1e18",
    "12",
    "257",
    "20000",
    "1000000000",
    "9223372036854775808",
    "340282366920938463463374607431768211456",
    "0.1e-5",
    "1e",
    "1.2.3",
    "0x10",
    "1_000",
    "1.",
    "2/3",
    "(1/0)",
    "(0/0)",
    "1e-17",
    "3.141592653589793",
];

const WORDS: &[&str] = &[
    "mechanism",
    "import",
    "param",
    "coord",
    "input",
    "prescribed",
    "const",
    "fn",
    "let",
    "mut",
    "for",
    "in",
    "if",
    "else",
    "kinetic",
    "potential",
    "dissipation",
    "lagrangian",
    "force",
    "torque",
    "reaction",
    "at",
    "on",
    "constraint",
    "output",
    "jacobian_rate",
    "t",
    "world",
    "pi",
    "deg",
    "match",
    "x",
    "q",
    "m",
    "l",
    "theta",
    "dt",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "ln",
    "sqrt",
    "hypot",
    "abs",
    "signum",
    "min",
    "max",
    "clamp",
    "dot",
    "cross",
    "norm",
    "norm_squared",
    "transpose",
    "inverse",
    "point",
    "origin",
    "rotation",
    "rot_x",
    "rot_y",
    "rot_z",
    "quaternion",
    "translation",
    "dh",
    "angular_velocity",
    "diag",
    "inertia",
    "particle",
    "rigid_body",
    "spring",
    "coulomb_stribeck",
    "contact",
    "+",
    "-",
    "*",
    "/",
    "^",
    "!",
    "<",
    "<=",
    ">",
    ">=",
    "&&",
    "||",
    "==",
    "=",
    "+=",
    "..",
    ".",
    ",",
    ";",
    ":",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "#![dimensionless]",
    "///",
    "/*",
    "*/",
    "\"",
    "'",
    "²",
    "½",
    "\u{0}",
    "\u{feff}",
    "\r",
    "dt(x)",
    "dt(q)",
    "[0, 0, 1]",
    "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]",
    "(-1)",
    "1e400",
    "kg",
    "m/s^2",
];
