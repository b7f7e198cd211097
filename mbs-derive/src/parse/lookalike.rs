//! Characters that are no part of the language, and what was probably meant by them.

use super::in_place::is_unit;
use super::syntax::Span;

/// Symbols of mathematics and what they are in the language.
const LOOKALIKES: [(&str, &str); 9] = [
    ("·×⋅∙∗", "*"),
    ("÷∕⁄", "/"),
    ("−–—‐‑‒", "-"),
    ("≤", "<="),
    ("≥", ">="),
    ("≠", "!="),
    ("√", "sqrt(…)"),
    ("°", "deg"),
    ("′´‘’∂∇∫", "dt(…)"),
];

/// Signs and digits of exponents.
const SUPERSCRIPTS: [(char, char); 12] = [
    ('⁺', '+'),
    ('⁻', '-'),
    ('⁰', '0'),
    ('¹', '1'),
    ('²', '2'),
    ('³', '3'),
    ('⁴', '4'),
    ('⁵', '5'),
    ('⁶', '6'),
    ('⁷', '7'),
    ('⁸', '8'),
    ('⁹', '9'),
];

const FRACTIONS: [(&str, &str); 5] = [("½", "0.5"), ("¼", "0.25"), ("¾", "0.75"), ("⅓", "(1/3)"), ("⅔", "(2/3)")];

/// Letters and their names, in the order of Unicode from alpha on; the final sigma has its own place.
const GREEK: [&str; 25] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
];

/// A word that is no name, behind a text: `θ1` as `theta1`, `q̇` as `dt(q)`, `µm` as `um` where a unit stands, `π`
/// behind a number as `*pi`; nothing for letters that are neither ASCII nor Greek.
pub(super) fn transliterated(before: &str, word: &str) -> Option<String> {
    let begun = before.rsplit([';', '{', '}', '=', '\n']).next().unwrap_or_default();
    let is_behind_number = begun.trim_end().ends_with(|c: char| c.is_ascii_digit());
    let unit = word.replace(['µ', 'μ'], "u").replace(['Ω', '\u{2126}'], "ohm");
    // Behind the name of a constraint there is no unit.
    let is_declared = begun.contains(':') && !begun.trim_start().starts_with("constraint");
    if (is_behind_number || is_declared) && is_unit(&unit) {
        return Some(unit);
    }
    let name = named(word)?;
    Some(if is_behind_number { format!("*{name}") } else { name })
}

fn named(word: &str) -> Option<String> {
    let (mut ascii, mut derivatives) = (String::new(), 0);
    for c in word.chars() {
        match c {
            c if c.is_ascii() => ascii.push(c),
            '\u{307}' => derivatives += 1,
            '\u{308}' => derivatives += 2,
            'µ' => ascii.push_str("mu"),
            'ϑ' => ascii.push_str("theta"),
            'ϕ' => ascii.push_str("phi"),
            'ϵ' => ascii.push_str("epsilon"),
            'α'..='ω' => ascii.push_str(GREEK[(u32::from(c) - u32::from('α')) as usize]),
            'Α'..='Ω' => {
                let name = GREEK[(u32::from(c) - u32::from('Α')) as usize];
                ascii.push_str(&name[..1].to_uppercase());
                ascii.push_str(&name[1..]);
            }
            '₀'..='₉' => ascii.extend(char::from_digit(u32::from(c) - u32::from('₀'), 10)),
            _ => return None,
        }
    }
    (0..derivatives).for_each(|_| ascii = format!("dt({ascii})"));
    Some(ascii)
}

/// What to write for the character at a place, which is no part of the language, and which span of the text that
/// replaces.
pub(super) fn meant(source: &str, at: usize) -> (Span, String) {
    let (before, text) = source.split_at(at);
    let c = text.chars().next().unwrap_or_default();
    if is_small(c) {
        return number(before, text);
    }
    let behind = &text[c.len_utf8()..];
    let digits = [before.chars().next_back(), behind.chars().next()];
    let help = match symbol(c) {
        Some("*") if "·⋅∙".contains(c) && digits.iter().flatten().filter(|c| c.is_ascii_digit()).count() == 2 => {
            "write `*`, or `.` in a decimal number".to_string()
        }
        Some("deg") if before.ends_with(char::is_alphabetic) || behind.starts_with(is_part) => {
            "write `deg` behind a number".to_string()
        }
        Some(ascii) => format!("write `{ascii}`"),
        None => "leave it out".to_string(),
    };
    (at..at + c.len_utf8(), help)
}

/// An exponent or a fraction of small figures, read as a whole: `¹²` as `^12`, `2½` as `2.5`.
fn number(before: &str, text: &str) -> (Span, String) {
    let (run, behind) = text.split_at(text.find(|c| !is_small(c)).unwrap_or(text.len()));
    let (start, end) = (before.len(), before.len() + run.len());
    let figures: Option<String> = run.chars().map(superscript).collect();
    if let Some(figures) = figures {
        let exponent = figures.strip_prefix('+').unwrap_or(&figures);
        let digits = exponent.strip_prefix('-').unwrap_or(exponent);
        let is_number =
            !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit()) && !behind.starts_with(is_part);
        let help = if is_number { format!("write `^{exponent}`") } else { "write an exponent as in `x^2`".to_string() };
        return (start..end, help);
    }
    // Behind digits it is added to them.
    let begun = before.trim_end_matches(' ');
    let whole = &begun[begun.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
    let rest = if whole.is_empty() { before } else { &begun[..begun.len() - whole.len()] };
    let is_alone = !rest.ends_with(is_part) && !rest.trim_end().ends_with('^') && !behind.starts_with(is_part);
    let fraction = FRACTIONS.iter().find(|(symbol, _)| *symbol == run && is_alone).map(|&(_, ascii)| ascii);
    match fraction {
        Some(fraction) if whole.is_empty() => (start..end, format!("write `{fraction}`")),
        Some(fraction) if fraction.starts_with("0.") => (rest.len()..end, format!("write `{whole}{}`", &fraction[1..])),
        _ => (start..end, "write a decimal number".to_string()),
    }
}

/// Whether a character goes on with a name or a number.
fn is_part(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.')
}

fn superscript(c: char) -> Option<char> {
    SUPERSCRIPTS.iter().find(|(small, _)| *small == c).map(|&(_, ascii)| ascii)
}

fn is_small(c: char) -> bool {
    superscript(c).is_some() || FRACTIONS.iter().any(|(symbol, _)| symbol.contains(c))
}

fn symbol(c: char) -> Option<&'static str> {
    LOOKALIKES.iter().find(|(symbols, _)| symbols.contains(c)).map(|&(_, ascii)| ascii)
}

pub(super) fn is_lookalike(c: char) -> bool {
    symbol(c).is_some() || is_small(c)
}
