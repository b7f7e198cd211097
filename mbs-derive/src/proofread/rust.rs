//! Rust, as far as it is emitted. Functions' bodies are read here and not by `syn`, which would take as long as all of
//! the derivation; what stands around them is little, and read by `syn`.
//!
//! - `token`: words, numbers, marks;
//! - `tree`: what stands in functions; `parse`: how it is read;
//! - `cut`: functions without their bodies, and the bodies.

mod cut;
mod parse;
mod token;
mod tree;

pub(super) use cut::{body_of, cut};
pub(super) use parse::{block, expression};
pub(super) use tree::{Block, Expression, ExpressionKind, Pattern, PatternKind, Statement, compact};
