//! The sides of the choices on a tape, and what leads to each.

use super::evaluate::{Tape, Value, holds};
use super::function::Function;
use super::graph::Node;

/// One side of an `if`, or of the corner of an `abs` or `signum`: its value is wanted where the comparisons of
/// [`Branches::way`] come out so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Side {
    /// The position of the choice on the tape.
    pub choice: usize,
    /// Which of its two sides.
    pub yes: bool,
    /// The last link of the chain of conditions.
    link: usize,
}

/// A condition that must hold, or must not, behind others.
#[derive(Clone, Copy, Debug)]
struct Link {
    before: Option<usize>,
    condition: usize,
    holds: bool,
    depth: usize,
}

/// All sides of all choices on a tape that the roots depend on.
pub(crate) struct Branches<'t> {
    tape: &'t Tape,
    links: Vec<Link>,
    sides: Vec<Side>,
}

impl<'t> Branches<'t> {
    /// One pass from the roots down.
    pub(crate) fn of(tape: &'t Tape) -> Self {
        let mut branches = Branches { tape, links: Vec::new(), sides: Vec::new() };
        let steps = tape.steps();
        // Of each step the shortest chain that makes its value wanted, once there is one.
        let mut wanted: Vec<Option<Option<usize>>> = vec![None; steps.len()];
        tape.roots().iter().for_each(|&root| wanted[root] = Some(None));
        for at in (0..steps.len()).rev() {
            let Some(link) = wanted[at] else { continue };
            let mut want = |operand: usize, link: Option<usize>, links: &[Link]| {
                let depth = |link: Option<usize>| link.map_or(0, |link| links[link].depth);
                if wanted[operand].is_none_or(|known| depth(link) < depth(known)) {
                    wanted[operand] = Some(link);
                }
            };
            match steps[at] {
                Node::Select(condition, yes, no) => {
                    want(condition.index(), link, &branches.links);
                    for (holds, side) in [(true, yes), (false, no)] {
                        let next = branches.behind(link, condition.index(), holds);
                        branches.sides.push(Side { choice: at, yes: holds, link: next });
                        want(side.index(), Some(next), &branches.links);
                    }
                }
                Node::Call(Function::Abs | Function::Signum, argument) => {
                    want(argument.index(), link, &branches.links);
                    for positive in [true, false] {
                        let next = branches.behind(link, at, positive);
                        branches.sides.push(Side { choice: at, yes: positive, link: next });
                    }
                }
                node => node.operands().for_each(|operand| want(operand.index(), link, &branches.links)),
            }
        }
        branches
    }

    /// Whether each side is taken where the steps have these values.
    pub(crate) fn taken<V: Value>(&self, values: &[V]) -> Vec<bool> {
        let steps = self.tape.steps();
        let mut wanted = vec![false; steps.len()];
        self.tape.roots().iter().for_each(|&root| wanted[root] = true);
        for (at, step) in steps.iter().enumerate().rev().filter(|(_, step)| step.operands().next().is_some()) {
            if !wanted[at] {
                continue;
            }
            match *step {
                Node::Select(condition, yes, no) => {
                    let side = if holds(values[condition.index()]) { yes } else { no };
                    [condition, side].into_iter().for_each(|operand| wanted[operand.index()] = true);
                }
                step => step.operands().for_each(|operand| wanted[operand.index()] = true),
            }
        }
        let comes_out = |choice: usize| match steps[choice] {
            Node::Select(condition, ..) => holds(values[condition.index()]),
            step => step.operands().all(|argument| V::constant(0.0).less(values[argument.index()])),
        };
        self.sides.iter().map(|side| wanted[side.choice] && comes_out(side.choice) == side.yes).collect()
    }

    fn behind(&mut self, before: Option<usize>, condition: usize, holds: bool) -> usize {
        let depth = before.map_or(0, |link| self.links[link].depth) + 1;
        self.links.push(Link { before, condition, holds, depth });
        self.links.len() - 1
    }

    /// The sides, those of outer choices first.
    pub(crate) fn sides(&self) -> &[Side] {
        &self.sides
    }

    /// Positions of comparisons, or of corners, and how they must come out, or whether what has the corner is positive,
    /// so that a side is taken. The outermost come last. Where an `&&` must not hold, its first operand does not, or
    /// the second one.
    pub(crate) fn way(&self, side: Side, by_the_second: bool) -> Vec<(usize, bool)> {
        let mut way = Vec::new();
        let mut link = Some(side.link);
        while let Some(Link { before, condition, holds, .. }) = link.map(|at| self.links[at]) {
            self.comparisons(condition, holds, by_the_second, &mut way);
            link = before;
        }
        way
    }

    fn comparisons(&self, condition: usize, holds: bool, by_the_second: bool, way: &mut Vec<(usize, bool)>) {
        let mut stack = vec![(condition, holds)];
        while let Some((at, holds)) = stack.pop() {
            match self.tape.steps()[at] {
                Node::Less(..) | Node::LessEqual(..) | Node::Call(..) => way.push((at, holds)),
                Node::Not(a) => stack.push((a.index(), !holds)),
                Node::And(a, b) if holds => stack.extend([(a.index(), true), (b.index(), true)]),
                Node::And(a, b) => stack.push((if by_the_second { b } else { a }.index(), false)),
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Graph, Symbol};

    #[test]
    fn each_side_has_a_way_that_leads_there() {
        let graph = Graph::verbatim();
        let x = graph.symbol(Symbol::Time);
        let [zero, one, two] = [0, 1, 2].map(|n| graph.integer(n));
        // if x < 0 && !(x < 2) { x } else if x < 1 { x + 1 } else { x + 2 }
        let inner = graph.select(x.less(one), x + one, x + two);
        let root = graph.select(x.less(zero).and(x.less(two).not()), x, inner);
        let tape = Tape::new(&[root * root]);
        let branches = Branches::of(&tape);
        let limit = |at: usize| match tape.steps()[at] {
            Node::Less(_, b) => match tape.steps()[b.index()] {
                Node::Constant(value) => value.to_f64(),
                _ => f64::NAN,
            },
            _ => f64::NAN,
        };
        let ways = branches.sides().iter().map(|&side| {
            branches.way(side, false).into_iter().map(|(at, holds)| (limit(at), holds)).collect::<Vec<_>>()
        });
        let expected = [
            vec![(2.0, false), (0.0, true)],
            vec![(0.0, false)],
            vec![(1.0, true), (0.0, false)],
            vec![(1.0, false), (0.0, false)],
        ];
        assert_eq!(ways.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn a_side_is_taken_where_its_value_is_wanted() {
        let graph = Graph::verbatim();
        let x = graph.symbol(Symbol::Time);
        let [one, two] = [1, 2].map(|n| graph.integer(n));
        let root = graph.select(x.less(one), (x - two).call(Function::Abs), (x - two).call(Function::Abs) + one);
        let tape = Tape::new(&[root]);
        let branches = Branches::of(&tape);
        let taken = |at: f64| branches.taken(&tape.all(|_| at));
        // The sides of the `if`, then those of `abs`.
        assert_eq!(taken(0.0), [true, false, false, true]);
        assert_eq!(taken(1.5), [false, true, false, true]);
        assert_eq!(taken(3.0), [false, true, true, false]);
        let chosen = graph.select(x.less(one).and(x.less(two)), x, one);
        let tape = Tape::new(&[chosen]);
        let branches = Branches::of(&tape);
        let [first, second] = [false, true].map(|by_the_second| branches.way(branches.sides()[1], by_the_second));
        assert!(first.len() == 1 && second.len() == 1 && first != second);
    }
}
