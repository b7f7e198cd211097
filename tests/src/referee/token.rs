//! Names, numbers and signs of a text.

use std::ops::Range;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(String),
    Name(String),
    Text(String),
    Sign(&'static str),
    End,
}

const SIGNS: [&str; 32] = [
    "#![", "..", "+=", "<=", ">=", "==", "!=", "&&", "||", "+", "-", "*", "/", "^", "(", ")", "[", "]", "{", "}", ",",
    ";", ":", "=", "<", ">", "!", ".", "#", "?", "%", "@",
];

/// Tokens and their places; comments and documentation are left out.
pub(super) fn tokens(text: &str) -> Result<Vec<(Token, Range<usize>)>, String> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &text[at..];
        let first = bytes[at];
        if first.is_ascii_whitespace() {
            at += 1;
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += comment(rest);
        } else if first == b'"' {
            let length = rest[1..].find('"').ok_or("a path that does not end")?;
            found.push((Token::Text(rest[1..=length].to_string()), at..at + length + 2));
            at += length + 2;
        } else if first.is_ascii_alphanumeric() || first == b'_' {
            let (token, length) = word(rest);
            found.push((token, at..at + length));
            at += length;
        } else {
            let sign = SIGNS.into_iter().find(|sign| rest.starts_with(sign));
            let sign = sign.ok_or_else(|| format!("no token begins with `{}`", &rest[..rest.len().min(10)]))?;
            found.push((Token::Sign(sign), at..at + sign.len()));
            at += sign.len();
        }
    }
    found.push((Token::End, at..at));
    Ok(found)
}

/// The length of a comment in brackets, which nests.
fn comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        if text[at..].starts_with("/*") {
            depth += 1;
            at += 2;
        } else if text[at..].starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                break;
            }
        } else {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    at
}

/// A name or a number. `0..n` holds two numbers.
fn word(text: &str) -> (Token, usize) {
    let bytes = text.as_bytes();
    let digit = |i: usize| bytes.get(i).is_some_and(|b| b.is_ascii_digit() || *b == b'_');
    let letter = |i: usize| bytes.get(i).is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_');
    let mut end = 0;
    if !bytes[0].is_ascii_digit() {
        while letter(end) {
            end += 1;
        }
        return (Token::Name(text[..end].to_string()), end);
    }
    while digit(end) {
        end += 1;
    }
    if bytes.get(end) == Some(&b'.') && bytes.get(end + 1) != Some(&b'.') && !letter_after_dot(bytes, end) {
        end += 1;
        while digit(end) {
            end += 1;
        }
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = matches!(bytes.get(end + 1), Some(b'+' | b'-'));
        if bytes.get(end + 1 + usize::from(signed)).is_some_and(u8::is_ascii_digit) {
            end += 2 + usize::from(signed);
            while digit(end) {
                end += 1;
            }
        }
    }
    (Token::Number(text[..end].replace('_', "")), end)
}

/// Whether what follows `2.` is a name.
fn letter_after_dot(bytes: &[u8], dot: usize) -> bool {
    bytes.get(dot + 1).is_some_and(u8::is_ascii_alphabetic) && !matches!(bytes[dot + 1], b'e' | b'E')
}
