//! Names: what each stands for, from the innermost block outwards.

use std::collections::BTreeMap;

use super::value::Value;
use crate::parse::syntax::Span;

/// How a name came to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// `param`
    Parameter,
    /// `coord`: the number of its first component.
    Coordinate(usize),
    /// `input`
    Input,
    /// `const`
    Constant,
    /// `let`
    Local,
    /// `let mut`
    Mutable,
    /// `for`
    Loop,
}

impl Origin {
    /// As the end of a sentence: "`m` is a parameter".
    pub(super) fn described(self) -> &'static str {
        match self {
            Origin::Parameter => "a parameter",
            Origin::Coordinate(_) => "a coordinate",
            Origin::Input => "an input",
            Origin::Constant => "a constant",
            Origin::Local => "a `let`",
            Origin::Mutable => "a `let mut`",
            Origin::Loop => "a loop variable",
        }
    }
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub(super) struct Binding<'g> {
    pub(super) origin: Origin,
    /// `None` where its declaration was wrong: what is made of it is silently given up.
    pub(super) value: Option<Value<'g>>,
    pub(super) span: Span,
}

/// The blocks that are open, the mechanism first.
#[derive(Debug)]
pub(super) struct Scope<'g> {
    blocks: Vec<BTreeMap<String, Binding<'g>>>,
}

impl<'g> Scope<'g> {
    /// Only the mechanism's own block.
    pub(super) fn new() -> Self {
        Scope { blocks: vec![BTreeMap::new()] }
    }

    /// Opens a block.
    pub(super) fn enter(&mut self) {
        self.blocks.push(BTreeMap::new());
    }

    /// Closes the innermost block.
    pub(super) fn leave(&mut self) {
        self.blocks.pop();
    }

    /// Whether the innermost block is the mechanism's own.
    pub(super) fn is_outermost(&self) -> bool {
        self.blocks.len() == 1
    }

    /// Declares a name in the innermost block.
    ///
    /// # Errors
    /// What the name is already, if this block has it.
    pub(super) fn declare(&mut self, name: &str, binding: Binding<'g>) -> Result<(), Origin> {
        let block = self.blocks.last_mut().expect("the mechanism's block is never closed");
        match block.get(name) {
            Some(known) => Err(known.origin),
            None => {
                block.insert(name.to_string(), binding);
                Ok(())
            }
        }
    }

    /// What a name stands for.
    pub(super) fn get(&self, name: &str) -> Option<&Binding<'g>> {
        self.blocks.iter().rev().find_map(|block| block.get(name))
    }

    /// What a name stands for, to give it a new value.
    pub(super) fn get_mut(&mut self, name: &str) -> Option<&mut Binding<'g>> {
        self.blocks.iter_mut().rev().find_map(|block| block.get_mut(name))
    }

    /// All names, those of inner blocks first.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, &Binding<'g>)> {
        self.blocks.iter().rev().flatten().map(|(name, binding)| (name.as_str(), binding))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_blocks_shadow_and_end() {
        let binding = |origin| Binding { origin, value: None, span: 0..0 };
        let mut scope = Scope::new();
        assert_eq!(scope.declare("a", binding(Origin::Parameter)), Ok(()));
        assert_eq!(scope.declare("a", binding(Origin::Local)), Err(Origin::Parameter));
        scope.enter();
        assert_eq!(scope.declare("a", binding(Origin::Local)), Ok(()));
        assert_eq!(scope.get("a").map(|b| b.origin), Some(Origin::Local));
        assert_eq!(scope.names().count(), 2);
        scope.leave();
        assert!(scope.is_outermost());
        assert_eq!(scope.get("a").map(|b| b.origin), Some(Origin::Parameter));
        assert!(scope.get("b").is_none());
    }
}
