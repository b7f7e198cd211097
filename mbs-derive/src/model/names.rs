//! What names stand for. In reading order:
//!
//! - [`scope`]: blocks, from the innermost outwards; [`element`]: arrays that loops fill; [`family`]: declarations with
//!   an index;
//! - [`function`]: functions written in the language; [`part`]: statements that are used many times;
//! - [`import`]: what imported files declare.

pub(in crate::model) mod element;
pub(in crate::model) mod family;
pub(in crate::model) mod function;
pub(in crate::model) mod import;
pub(in crate::model) mod part;
pub(in crate::model) mod scope;
