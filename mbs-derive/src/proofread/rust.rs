//! Rust, as far as it is emitted, without the compiler's own parser, for which a module's functions are too long: it
//! would take as long as all of the derivation. What stands around functions is little, and read by it.
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
