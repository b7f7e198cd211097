//! Conditions, and expressions that are chosen by them.

use super::graph::{Expr, Graph, Node};

/// A condition of a piecewise expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Condition<'g>(pub(crate) Expr<'g>);

impl<'g> Expr<'g> {
    /// `self < other`
    pub fn less(self, other: Expr<'g>) -> Condition<'g> {
        let graph = self.graph;
        match (self.as_constant(), other.as_constant()) {
            (Some(a), Some(b)) if !graph.verbatim => graph.truth((a + -b).is_negative()),
            _ => Condition(graph.intern(Node::Less(self.id, other.id))),
        }
    }

    /// `self <= other`
    pub fn less_equal(self, other: Expr<'g>) -> Condition<'g> {
        let graph = self.graph;
        match (self.as_constant(), other.as_constant()) {
            (Some(a), Some(b)) if !graph.verbatim => graph.truth(!(b + -a).is_negative()),
            _ => Condition(graph.intern(Node::LessEqual(self.id, other.id))),
        }
    }
}

impl<'g> Condition<'g> {
    /// Both hold.
    pub fn and(self, other: Condition<'g>) -> Condition<'g> {
        let graph = self.0.graph;
        match (self.known(), other.known()) {
            (Some(true), _) => other,
            (_, Some(true)) => self,
            (Some(false), _) | (_, Some(false)) => graph.truth(false),
            _ => Condition(graph.intern(Node::And(self.0.id, other.0.id))),
        }
    }

    /// At least one holds.
    pub fn or(self, other: Condition<'g>) -> Condition<'g> {
        self.not().and(other.not()).not()
    }

    /// It does not hold.
    #[allow(clippy::should_implement_trait)] // beside `and` and `or`
    pub fn not(self) -> Condition<'g> {
        let graph = self.0.graph;
        match (self.known(), self.0.node()) {
            (Some(value), _) => graph.truth(!value),
            (None, Node::Not(a)) => Condition(graph.expr(a)),
            _ => Condition(graph.intern(Node::Not(self.0.id))),
        }
    }

    fn known(self) -> Option<bool> {
        self.0.as_constant().map(|value| !value.is_zero())
    }
}

impl Graph {
    fn truth(&self, value: bool) -> Condition<'_> {
        Condition(self.integer(i64::from(value)))
    }

    /// `if condition { yes } else { no }`
    pub fn select<'g>(&'g self, condition: Condition<'g>, yes: Expr<'g>, no: Expr<'g>) -> Expr<'g> {
        match condition.known() {
            Some(holds) if !self.verbatim => {
                if holds {
                    yes
                } else {
                    no
                }
            }
            _ if yes == no && !self.verbatim => yes,
            _ => self.intern(Node::Select(condition.0.id, yes.id, no.id)),
        }
    }
}
