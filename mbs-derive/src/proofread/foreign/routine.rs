//! The functions of a text, found among its tokens.

use std::collections::BTreeMap;

use super::super::reader::Reading;
use super::dialect::{Dialect, Family};
use super::token::{Kind, Token, tokens};

/// A function: what stands in its brackets and in its body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routine<'r, 't> {
    /// The tokens before its name on the line: of MATLAB what it gives.
    pub(super) head: &'r [Token<'t>],
    pub(super) arguments: &'r [Token<'t>],
    pub(super) body: &'r [Token<'t>],
}

/// Tokens as text, a space between each.
pub(super) fn written(tokens: &[Token<'_>]) -> String {
    let words = tokens.iter().filter(|token| token.kind != Kind::End).map(|token| token.text);
    words.collect::<Vec<_>>().join(" ")
}

/// The same of a text.
pub(super) fn spaced(dialect: &Dialect, text: &str) -> Reading<String> {
    Ok(written(&tokens(text, &dialect.lexis)?))
}

/// All functions of the mechanism by name, and what else there is in front of them; of those that are there twice, as
/// what a header has for different compilers, there is none.
pub(super) fn routines<'r, 't>(
    dialect: &Dialect,
    tokens: &'r [Token<'t>],
) -> Reading<BTreeMap<&'t str, Option<Routine<'r, 't>>>> {
    let mut found = BTreeMap::new();
    let mut at = class(dialect, tokens);
    while at < tokens.len() {
        let Some((name, head)) = begins(dialect, tokens, at) else {
            at += 1;
            continue;
        };
        let has_arguments = tokens.get(name + 1).is_some_and(|token| token.is("("));
        let close = if has_arguments { closing(tokens, name + 1)? } else { name };
        let arguments = if has_arguments { &tokens[name + 2..close] } else { &[] };
        let body = match dialect.family {
            Family::C | Family::Js => {
                let open = close + 1 + ends(&tokens[close + 1..]);
                // A declaration, or a call.
                if !tokens.get(open).is_some_and(|token| token.is("{")) {
                    at = close + 1;
                    continue;
                }
                open + 1..closing(tokens, open)?
            }
            Family::Python => {
                let own = tokens[at].indent;
                let start = close + 2;
                let is_outside = |token: &Token<'_>| token.kind != Kind::End && token.indent <= own;
                let length = tokens[start..].iter().position(is_outside).unwrap_or(tokens.len() - start);
                start..start + length
            }
            Family::Matlab => close + 1..end_of_function(tokens, close + 1),
        };
        at = body.end;
        let routine = Routine { head: &tokens[head], arguments, body: &tokens[body] };
        found.entry(tokens[name].text).and_modify(|known| *known = None).or_insert(Some(routine));
    }
    Ok(found)
}

/// Where the class of the mechanism begins, which is the last one; without classes the text.
fn class(dialect: &Dialect, tokens: &[Token<'_>]) -> usize {
    let is_class = |token: &Token<'_>| token.is("class") && token.indent == 0;
    match dialect.family {
        Family::Js | Family::Python => tokens.iter().rposition(is_class).unwrap_or_default(),
        Family::C | Family::Matlab => 0,
    }
}

/// Where the name of a function is that begins here, and what is before it.
fn begins(dialect: &Dialect, tokens: &[Token<'_>], at: usize) -> Option<(usize, std::ops::Range<usize>)> {
    let is_name = |i: usize| tokens.get(i).is_some_and(|token| token.kind == Kind::Name);
    let is = |i: usize, mark: &str| tokens.get(i).is_some_and(|token| token.is(mark));
    match dialect.family {
        Family::C => (is(at, "MBS_FN") && is_name(at + 2) && is(at + 3, "(")).then_some((at + 2, at + 1..at + 2)),
        // A method stands at the beginning of a line.
        Family::Js => {
            let first = if is(at, "static") { at + 1 } else { at };
            let is_line = at == 0 || tokens[at - 1].kind == Kind::End;
            let is_method = is_line && tokens[at].indent == 2 && is_name(first) && is(first + 1, "(");
            is_method.then_some((first, at..first))
        }
        Family::Python => (is(at, "def") && tokens[at].indent == 4).then_some((at + 1, at..at + 1)),
        Family::Matlab => {
            if !is(at, "function") {
                return None;
            }
            let line = tokens[at..].iter().position(|token| token.kind == Kind::End)?;
            let sign = (at..at + line).find(|&i| is(i, "="));
            sign.map_or(Some((at + 1, at..at)), |sign| Some((sign + 1, at + 1..sign)))
        }
    }
}

fn ends(tokens: &[Token<'_>]) -> usize {
    tokens.iter().take_while(|token| token.kind == Kind::End).count()
}

/// Where the bracket closes that opens here.
fn closing(tokens: &[Token<'_>], open: usize) -> Reading<usize> {
    let mut depth = 0usize;
    for (i, token) in tokens.iter().enumerate().skip(open).filter(|(_, token)| token.kind == Kind::Mark) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => {
                depth -= 1;
                if depth == 0 {
                    return Ok(i);
                }
            }
            _ => {}
        }
    }
    Err("a bracket is not closed".to_string())
}

/// Where the `end` of a function is whose body begins here.
fn end_of_function(tokens: &[Token<'_>], start: usize) -> usize {
    let (mut depth, mut brackets) = (1usize, 0usize);
    for (i, token) in tokens.iter().enumerate().skip(start) {
        match token.text {
            "(" | "[" | "{" => brackets += 1,
            ")" | "]" | "}" => brackets = brackets.saturating_sub(1),
            "if" | "for" | "while" | "switch" if brackets == 0 => depth += 1,
            "end" if brackets == 0 => {
                depth -= 1;
                if depth == 0 {
                    return i;
                }
            }
            _ => {}
        }
    }
    tokens.len()
}
