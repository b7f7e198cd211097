//! Names: what each stands for, from the innermost block outwards.

use std::collections::BTreeMap;

use crate::model::names::element::Elements;
use crate::model::value::Value;
use crate::parse::syntax::Span;

/// How a name came to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) enum Origin {
    /// `param`
    Parameter,
    /// `coord`: the number of its first component.
    Coordinate(usize),
    /// `input`
    Input,
    /// `prescribed`
    Prescribed,
    /// `const`
    Constant,
    /// `let`
    Local,
    /// `let mut`
    Mutable,
    /// `for`
    Loop,
    /// `fn f(x)`
    Argument,
    /// `link arm(m);`
    Part,
}

impl Origin {
    /// As the end of a sentence: "`m` is a parameter".
    pub(in crate::model) fn described(self) -> &'static str {
        match self {
            Origin::Parameter => "a parameter",
            Origin::Coordinate(_) => "a coordinate",
            Origin::Input => "an input",
            Origin::Prescribed => "a prescribed motion",
            Origin::Constant => "a constant",
            Origin::Local => "a `let`",
            Origin::Mutable => "a `let mut`",
            Origin::Loop => "a loop variable",
            Origin::Argument => "an argument",
            Origin::Part => "a part",
        }
    }

    /// Whether functions see what is declared so.
    fn is_everywhere(self) -> bool {
        match self {
            Origin::Parameter | Origin::Coordinate(_) | Origin::Input | Origin::Prescribed | Origin::Constant => true,
            Origin::Local | Origin::Mutable | Origin::Loop | Origin::Argument | Origin::Part => false,
        }
    }
}

/// What a name stands for.
#[derive(Clone, Debug)]
pub(in crate::model) struct Binding<'g> {
    pub(in crate::model) origin: Origin,
    /// `None` where its declaration was wrong: what is made of it is silently given up.
    pub(in crate::model) value: Option<Value<'g>>,
    pub(in crate::model) span: Span,
    /// Where the value is used first, since it was given.
    pub(in crate::model) used: Option<Span>,
    /// Whether its value is in units of the SI: that of a constant with a unit, or made of such.
    pub(in crate::model) has_unit: bool,
    /// In place of a value: elements that are given theirs one by one.
    pub(in crate::model) elements: Option<Elements<'g>>,
}

impl<'g> Binding<'g> {
    /// A value that nothing has used yet.
    pub(in crate::model) fn new(origin: Origin, value: Option<Value<'g>>, span: Span) -> Self {
        Binding { origin, value, span, used: None, has_unit: false, elements: None }
    }
}

/// The blocks that are open: what imported files declare, then the mechanism, then its inner blocks.
#[derive(Debug)]
pub(in crate::model) struct Scope<'g> {
    blocks: Vec<BTreeMap<String, Binding<'g>>>,
    /// The bodies of functions that are being called and parts that are being built: nothing is seen through the last
    /// of them but what is the mechanism's own.
    functions: Vec<Body>,
}

#[derive(Clone, Copy, Debug)]
struct Body {
    /// Its outermost block.
    first: usize,
    /// How many of the outermost blocks are seen through it.
    seen: usize,
    is_part: bool,
}

/// What imported files declare, and the mechanism.
const OUTERMOST: usize = 2;

impl<'g> Scope<'g> {
    /// Only the block of imported files; the next one is the mechanism's own.
    pub(in crate::model) fn new() -> Self {
        Scope { blocks: vec![BTreeMap::new()], functions: Vec::new() }
    }

    /// Opens a block.
    pub(in crate::model) fn enter(&mut self) {
        self.blocks.push(BTreeMap::new());
    }

    /// Opens the body of a function of the mechanism.
    pub(in crate::model) fn enter_function(&mut self) {
        self.functions.push(Body { first: self.blocks.len(), seen: OUTERMOST, is_part: false });
        self.enter();
    }

    /// Opens the body of a part, of an imported file or of the mechanism.
    pub(in crate::model) fn enter_part(&mut self, is_shared: bool) {
        let seen = if is_shared { 1 } else { OUTERMOST };
        self.functions.push(Body { first: self.blocks.len(), seen, is_part: true });
        self.enter();
    }

    /// Opens the body of a function of an imported file.
    pub(in crate::model) fn enter_shared_function(&mut self) {
        self.functions.push(Body { first: self.blocks.len(), seen: 1, is_part: false });
        self.enter();
    }

    /// Closes the innermost block.
    pub(in crate::model) fn leave(&mut self) {
        self.blocks.pop();
        if self.functions.last().is_some_and(|body| body.first == self.blocks.len()) {
            self.functions.pop();
        }
    }

    /// Whether a part is being built.
    pub(in crate::model) fn is_in_part(&self) -> bool {
        self.functions.last().is_some_and(|body| body.is_part)
    }

    /// The outermost block of the part or the mechanism that is being built.
    fn body(&mut self) -> &mut BTreeMap<String, Binding<'g>> {
        let own = self.functions.last().map_or(OUTERMOST - 1, |body| body.first);
        // A file to be imported, in which parts are misplaced, has no block of a mechanism.
        let last = self.blocks.len() - 1;
        &mut self.blocks[own.min(last)]
    }

    /// What a name stands for in the outermost block of the part or the mechanism, to which loops may add.
    pub(in crate::model) fn in_body(&mut self, name: &str) -> Option<&mut Binding<'g>> {
        self.body().get_mut(name)
    }

    /// Declares a name there.
    pub(in crate::model) fn declare_in_body(&mut self, name: &str, binding: Binding<'g>) {
        self.body().insert(name.to_string(), binding);
    }

    /// What the innermost block declares.
    pub(in crate::model) fn innermost(&self) -> impl Iterator<Item = (&String, &Binding<'g>)> {
        self.blocks.last().into_iter().flatten()
    }

    /// Whether the innermost block is the mechanism's own, or that of imported files.
    pub(in crate::model) fn is_outermost(&self) -> bool {
        self.functions.is_empty() && self.blocks.len() <= OUTERMOST
    }

    /// Whether the innermost block is that of imported files.
    pub(in crate::model) fn is_shared(&self) -> bool {
        self.functions.is_empty() && self.blocks.len() == 1
    }

    /// Declares a name in the innermost block.
    ///
    /// # Errors
    /// What the name is already, if this block has it; the mechanism has what imported files have.
    pub(in crate::model) fn declare(&mut self, name: &str, binding: Binding<'g>) -> Result<(), Origin> {
        let same = if self.is_outermost() { 0 } else { self.blocks.len() - 1 };
        match self.blocks[same..].iter().find_map(|block| block.get(name)) {
            Some(known) => Err(known.origin),
            None => {
                let block = self.blocks.last_mut().expect("the outermost block is never closed");
                block.insert(name.to_string(), binding);
                Ok(())
            }
        }
    }

    /// What a name stands for.
    pub(in crate::model) fn get(&self, name: &str) -> Option<&Binding<'g>> {
        let Some(&Body { first: body, seen, .. }) = self.functions.last() else {
            return self.blocks.iter().rev().find_map(|block| block.get(name));
        };
        let inner = self.blocks[body..].iter().rev().find_map(|block| block.get(name));
        let seen = &self.blocks[..seen.min(body)];
        let outer = || seen.iter().find_map(|block| block.get(name).filter(|b| b.origin.is_everywhere()));
        inner.or_else(outer)
    }

    /// How a name came to be that the function being called does not see.
    pub(in crate::model) fn hidden(&self, name: &str) -> Option<Origin> {
        match self.get(name) {
            Some(_) => None,
            None => self.blocks.iter().rev().find_map(|block| block.get(name)).map(|binding| binding.origin),
        }
    }

    /// What a name stands for, to give it a new value.
    pub(in crate::model) fn get_mut(&mut self, name: &str) -> Option<&mut Binding<'g>> {
        self.blocks.iter_mut().rev().find_map(|block| block.get_mut(name))
    }

    /// Whether the value of a name has a unit.
    pub(in crate::model) fn note_unit(&mut self, name: &str, has_unit: bool) {
        if let Some(binding) = self.get_mut(name) {
            binding.has_unit = has_unit;
        }
    }

    /// That the value of a name is used here; what functions do with their arguments is no use of the name.
    pub(in crate::model) fn note_use(&mut self, name: &str, place: &Span) {
        if self.functions.last().is_none_or(|body| body.is_part)
            && let Some(binding) = self.get_mut(name)
        {
            binding.used.get_or_insert_with(|| place.clone());
        }
    }

    /// All names, those of inner blocks first.
    pub(in crate::model) fn names(&self) -> impl Iterator<Item = (&str, &Binding<'g>)> {
        let all = self.blocks.iter().rev().flatten().map(|(name, binding)| (name.as_str(), binding));
        all.filter(|(name, _)| self.functions.is_empty() || self.get(name).is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_see_what_is_the_mechanisms_own() {
        let binding = |origin| Binding::new(origin, None, 0..0);
        let mut scope = Scope::new();
        scope.enter();
        for (name, origin) in [("m", Origin::Parameter), ("a", Origin::Local), ("b", Origin::Local)] {
            assert_eq!(scope.declare(name, binding(origin)), Ok(()));
        }
        scope.enter_function();
        assert_eq!(scope.declare("a", binding(Origin::Argument)), Ok(()));
        assert_eq!(scope.get("a").map(|b| b.origin), Some(Origin::Argument));
        assert_eq!(scope.get("m").map(|b| b.origin), Some(Origin::Parameter));
        assert!(scope.get("b").is_none());
        assert_eq!((scope.hidden("b"), scope.hidden("a")), (Some(Origin::Local), None));
        scope.leave();
        assert_eq!(scope.get("b").map(|b| b.origin), Some(Origin::Local));
        assert_eq!(scope.hidden("b"), None);
    }

    #[test]
    fn imported_names_are_the_mechanisms_and_not_the_other_way() {
        let binding = |origin| Binding::new(origin, None, 0..0);
        let mut scope = Scope::new();
        assert!(scope.is_shared());
        assert_eq!(scope.declare("k", binding(Origin::Constant)), Ok(()));
        scope.enter_shared_function();
        assert_eq!(scope.declare("k", binding(Origin::Argument)), Ok(()), "called by a constant");
        scope.leave();
        scope.enter();
        assert!(scope.is_outermost() && !scope.is_shared());
        assert_eq!(scope.declare("k", binding(Origin::Parameter)), Err(Origin::Constant));
        assert_eq!(scope.declare("m", binding(Origin::Parameter)), Ok(()));
        scope.enter_shared_function();
        assert!(scope.get("k").is_some() && scope.get("m").is_none());
        assert_eq!(scope.hidden("m"), Some(Origin::Parameter));
        scope.enter_function();
        assert!(scope.get("k").is_some() && scope.get("m").is_some());
        scope.leave();
        assert!(scope.get("m").is_none());
        scope.leave();
        scope.enter();
        assert_eq!(scope.declare("k", binding(Origin::Local)), Ok(()), "an inner block may hide it");
    }

    #[test]
    fn inner_blocks_shadow_and_end() {
        let binding = |origin| Binding::new(origin, None, 0..0);
        let mut scope = Scope::new();
        scope.enter();
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
