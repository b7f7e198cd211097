//! Conditions of piecewise expressions: `x < r`, `r \le x`, `\land`, `\lor`.

use crate::expr::{Id, Node};

use super::algebra::{Algebra, LONGEST_TEXT};

/// How a condition is written, and how its negation is.
#[derive(Clone, Debug)]
pub(super) struct Condition {
    pub(super) holds: Clause,
    pub(super) fails: Clause,
}

/// A condition as it is written.
#[derive(Clone, Debug)]
pub(super) enum Clause {
    /// A comparison, or several that must hold together.
    All(String),
    /// Several of which one must hold.
    Any(String),
}

impl Clause {
    pub(super) fn text(&self) -> String {
        match self {
            Clause::All(text) | Clause::Any(text) => text.clone(),
        }
    }

    fn and(&self, other: &Clause) -> Clause {
        let bracketed = |clause: &Clause| match clause {
            Clause::All(text) => text.clone(),
            Clause::Any(text) => format!("({text})"),
        };
        Clause::All(format!("{} \\land {}", bracketed(self), bracketed(other)))
    }

    fn or(&self, other: &Clause) -> Clause {
        Clause::Any(format!("{} \\lor {}", self.text(), other.text()))
    }

    fn is_short(&self) -> bool {
        self.text().len() <= LONGEST_TEXT
    }
}

impl Algebra<'_> {
    /// Of numbers: where `a < b` fails, `b ≤ a` holds.
    fn comparison(&self, a: Id, sign: &str, b: Id, opposite: &str) -> Option<Condition> {
        let [a, b] = [a, b].map(|id| self.sums[&id].as_ref().and_then(|sum| self.text(sum)));
        let (a, b) = (a?, b?);
        let (holds, fails) = (format!("{a} {sign} {b}"), format!("{b} {opposite} {a}"));
        Some(Condition { holds: Clause::All(holds), fails: Clause::All(fails) })
    }

    /// A condition whose operands have been written; `None` where it is too long.
    pub(super) fn condition(&self, id: Id) -> Option<Condition> {
        let condition = match self.graph.node(id) {
            Node::Less(a, b) => self.comparison(a, "<", b, "\\le")?,
            Node::LessEqual(a, b) => self.comparison(a, "\\le", b, "<")?,
            Node::And(a, b) => {
                let (a, b) = (self.conditions.get(&a)?, self.conditions.get(&b)?);
                Condition { holds: a.holds.and(&b.holds), fails: a.fails.or(&b.fails) }
            }
            Node::Not(a) => {
                let Condition { holds, fails } = self.conditions.get(&a)?.clone();
                Condition { holds: fails, fails: holds }
            }
            _ => return None,
        };
        (condition.holds.is_short() && condition.fails.is_short()).then_some(condition)
    }
}
