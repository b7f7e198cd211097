//! What names stand for. In reading order:
//!
//! - [`scope`]: blocks, from the innermost outwards; [`element`]: arrays that loops fill; [`family`]: declarations with
//!   an index;
//! - [`function`]: functions written in the language; [`part`]: statements that are used many times;
//! - [`import`]: what imported files declare; [`local`]: what local names stand for, for printing on paper;
//!   [`meaning`]: the same in a few words, for editors.

pub(in crate::model) mod element;
pub(in crate::model) mod family;
pub(in crate::model) mod function;
pub(in crate::model) mod import;
pub(crate) mod local;
pub(in crate::model) mod meaning;
pub(in crate::model) mod part;
pub(in crate::model) mod scope;

use std::collections::{BTreeMap, BTreeSet};

use crate::parse::syntax::Expression;
use function::Function;
use meaning::Meanings;
use part::Parts;
use scope::Scope;

/// What is declared, and what of it has been used.
#[derive(Debug)]
pub(in crate::model) struct Names<'d, 'g> {
    pub(in crate::model) scope: Scope<'g>,
    /// The mechanism's own names, with what they are defined by.
    pub(in crate::model) definitions: BTreeMap<&'d str, Option<&'d Expression>>,
    /// The functions that may be called.
    pub(in crate::model) functions: BTreeMap<&'d str, Function<'d>>,
    /// Those that imported files may call.
    pub(in crate::model) shared: BTreeMap<&'d str, Function<'d>>,
    /// Those that have been called.
    pub(in crate::model) called: BTreeSet<&'d str>,
    /// The parts, and those that are being built.
    pub(in crate::model) parts: Parts<'d, 'g>,
    /// The name that is being defined.
    pub(in crate::model) defining: Option<&'d str>,
    /// What names stand for, in words.
    pub(in crate::model) meanings: Meanings,
}

impl Names<'_, '_> {
    pub(in crate::model) fn new() -> Self {
        Names {
            scope: Scope::new(),
            definitions: BTreeMap::new(),
            functions: BTreeMap::new(),
            shared: BTreeMap::new(),
            called: BTreeSet::new(),
            parts: Parts::default(),
            defining: None,
            meanings: Meanings::new(),
        }
    }
}
