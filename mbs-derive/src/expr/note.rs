//! What nodes are called by those who made them: `w3x` for an angular velocity. The emitter names locals so; nothing
//! else looks at it.

use std::fmt::Arguments;
use std::rc::Rc;

use super::graph::{Expr, Graph, Id, Node};

impl Graph {
    /// What a node is called.
    pub fn note(&self, id: Id) -> Option<Rc<str>> {
        self.notes.borrow().get(&id).cloned()
    }
}

impl Expr<'_> {
    /// Calls it so, unless it has a name: the first one stays. What a sign is before is called `…_neg`.
    pub(crate) fn note(self, name: Arguments<'_>) {
        let is_leaf = |node| matches!(node, Node::Constant(_) | Node::Symbol(_));
        let mut notes = self.graph.notes.borrow_mut();
        match self.node() {
            node if is_leaf(node) => return,
            Node::Neg(a) if is_leaf(self.graph.node(a)) => return,
            Node::Neg(a) => drop(notes.entry(a).or_insert_with(|| negative(&name.to_string()).into())),
            _ => {}
        }
        notes.entry(self.id).or_insert_with(|| name.to_string().into());
    }

    /// Calls it as another node.
    pub(super) fn note_of(self, id: Id, graph: &Graph) {
        if let Some(name) = graph.note(id) {
            self.note(format_args!("{name}"));
        }
    }

    /// Calls it the derivative by a node that has a name, which is no derivative itself.
    pub(super) fn note_derivative_by(self, id: Id) {
        if let Some(name) = self.graph.note(id).filter(|name| !name.starts_with("by_")) {
            self.note(format_args!("by_{name}"));
        }
    }
}

fn negative(name: &str) -> String {
    name.strip_suffix("_neg").map_or_else(|| format!("{name}_neg"), str::to_string)
}
