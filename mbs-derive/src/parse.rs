//! Pass 1: text → [`Declaration`].
//!
//! [`declaration`] is the entry point. It reads every statement even after a mistake, so that one run reports all of
//! them. In reading order:
//!
//! - [`syntax`]: the declaration as it was written, what the next pass is given;
//! - `guard`: comments, brackets and characters, before the text is cut into tokens;
//! - `grammar`: one function a construct;
//! - `keyword`: the words that cannot be names.

mod grammar;
mod guard;
mod keyword;
pub mod syntax;

use crate::diagnostic::Diagnostics;
use syntax::Declaration;

/// Delimiters, signs, powers and components may be nested this deep, all together.
///
/// What comes after the parser may recurse over a declaration: only the left operands of `+ - * /` run deeper, and
/// [`Expression::left_spine`](syntax::Expression::left_spine) walks them without recursion.
pub(crate) const MAX_DEPTH: usize = 256;

/// Reads the text of one `.mbs` file.
///
/// # Errors
/// Everything in the text that is not the model language, in source order.
pub fn declaration(source: &str) -> Result<Declaration, Diagnostics> {
    guard::check(source)?;
    grammar::declaration(source)
}
