//! Rust, as far as it is emitted. Functions' bodies are read here and not by `syn`, which would take as long as all of
//! the derivation; what stands around them is little, and read by `syn`.
//!
//! - `tree`: what stands in functions; `parse`: how it is read;
//! - `cut`: functions without their bodies, and the bodies.

mod cut;
mod parse;
mod tree;

use super::reading::Reading;
use super::token::{Lexis, Lines, Token};

pub(super) use cut::{body_of, cut};
pub(super) use parse::{block, expression};
pub(super) use tree::{Block, Expression, ExpressionKind, Pattern, PatternKind, Statement, compact};

/// How Rust is told from its comments and texts.
const LEXIS: Lexis = Lexis {
    comment: "//",
    has_blocks: false,
    joints: &["#"],
    has_directives: false,
    quotes: "\"",
    has_docstrings: false,
    lines: Lines::Free,
};

/// All of a text but spaces and comments up to the ends of lines; of others the marks, which nothing knows.
fn tokens(text: &str) -> Reading<Vec<Token<'_>>> {
    super::token::tokens(text, &LEXIS)
}
