//! Characters that are no part of the language, and what was probably meant by them.

/// Symbols of mathematics and what they are in the language.
const LOOKALIKES: [(&str, &str); 17] = [
    ("·×⋅∙∗", "*"),
    ("÷∕⁄", "/"),
    ("−–—‐‑‒", "-"),
    ("⁰", "^0"),
    ("¹", "^1"),
    ("²", "^2"),
    ("³", "^3"),
    ("⁴", "^4"),
    ("⁻", "^-"),
    ("½", "1/2"),
    ("⅓", "1/3"),
    ("¼", "1/4"),
    ("¾", "3/4"),
    ("√", "sqrt(…)"),
    ("°", "deg"),
    ("′´‘’", "dt(x)"),
    ("∂∇∫", "dt(x)"),
];

/// Letters and their names, in the order of Unicode from alpha on; the final sigma has its own place.
const GREEK: [&str; 25] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
];

/// `θ1` as `theta1`, `q̇` as `dt(q)`; nothing for letters that are neither ASCII nor Greek.
pub(super) fn transliterated(word: &str) -> Option<String> {
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

/// What stands for a symbol of mathematics in the language.
pub(super) fn meant(c: char) -> Option<&'static str> {
    LOOKALIKES.iter().find(|(symbols, _)| symbols.contains(c)).map(|&(_, ascii)| ascii)
}

pub(super) fn is_lookalike(c: char) -> bool {
    !c.is_ascii() && meant(c).is_some()
}
