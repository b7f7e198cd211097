//! A module in which names stand for the bodies that have arithmetic in them.

use super::super::reading::Reading;
use super::super::token::Token;
use super::tokens;

/// A module without its functions' bodies, and the bodies.
pub(in crate::proofread) struct Cut<'t> {
    pub(in crate::proofread) module: String,
    pub(in crate::proofread) bodies: Vec<&'t str>,
}

/// What stands for a body; `cut!(3);` for the fourth one.
const NAME: &str = "cut";

/// The number of the body that stands here, if one does.
pub(in crate::proofread) fn body_of(block: &syn::Block) -> Option<usize> {
    match block.stmts.as_slice() {
        [syn::Stmt::Macro(of)] if of.mac.path.is_ident(NAME) => of.mac.tokens.to_string().parse().ok(),
        _ => None,
    }
}

/// Cuts out the bodies of functions that compute: those of `Params`, where it is checked and has its defaults, and of
/// the mechanism, but for two that do not.
pub(in crate::proofread) fn cut(code: &str) -> Reading<Cut<'_>> {
    let tokens = tokens(code)?;
    if tokens.windows(2).any(|pair| pair[0].is(NAME) && pair[1].is("!")) {
        return Err(format!("`{NAME}!` stands in the text already"));
    }
    let mut cut = Cut { module: String::new(), bodies: Vec::new() };
    let (mut header, mut copied, mut at): (&[Token<'_>], _, _) = (&[], 0, 0);
    while at < tokens.len() {
        let brace = || tokens[at..].iter().position(|token| token.is("{")).map(|count| at + count);
        if tokens[at].is("impl") {
            let end = brace().ok_or("an implementation has no braces")?;
            header = &tokens[at..end];
            at = end;
        } else if tokens[at].is("fn") {
            let name = tokens.get(at + 1).map_or("", |token| token.text);
            let start = brace().ok_or("a function has no body")?;
            let end = closing(&tokens, start).ok_or("a brace is not closed")?;
            let body = tokens[start].start..tokens[end].range().end;
            if computes(header, name) {
                cut.module += &code[copied..body.start];
                cut.module += &format!("{{ {NAME}!({}); }}", cut.bodies.len());
                cut.bodies.push(&code[body.clone()]);
                copied = body.end;
            }
            at = end;
        }
        at += 1;
    }
    cut.module += &code[copied..];
    Ok(cut)
}

/// Where the brace is closed that opens here.
fn closing(tokens: &[Token<'_>], open: usize) -> Option<usize> {
    let mut depth = 0_usize;
    tokens[open..]
        .iter()
        .position(|token| {
            depth = depth + usize::from(token.is("{")) - usize::from(token.is("}"));
            depth == 0
        })
        .map(|count| open + count)
}

/// Whether a function of an implementation has arithmetic in it.
fn computes(header: &[Token<'_>], function: &str) -> bool {
    match header.iter().position(|token| token.is("for")) {
        None => function != "try_new" && function != "params",
        Some(at) => {
            let has = |tokens: &[Token<'_>], name: &str| tokens.iter().any(|token| token.is(name));
            has(&header[..at], "Default") && has(&header[at..], "Params")
        }
    }
}
