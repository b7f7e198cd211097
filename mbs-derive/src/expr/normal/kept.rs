//! Sums that stay factors: the differences that springs, dampers and forces were written with.
//!
//! `k (r − r₀)` is exact where r is near r₀, and so is `(r − r₀)²`; `k r − k r₀` and `r² − 2 r r₀ + r₀²` have lost the
//! digits that the two share. So a sum that an energy or a force takes in a product, a power or a function is one
//! symbol wherever it is multiplied, in all that is derived from it. Where it is only added to others, its terms are
//! added to theirs.
//!
//! A sum of terms that parameters scale, `b z − c y`, is rounded in each of them as it stands: other factors that are
//! constant in time may join these. And the error of `r cos θ − a` is that of a cosine, however small the sum is; that
//! of `k r cos θ − k a` is no greater, but `(r cos θ − a)²` is as small as the error of `r² cos²θ − 2 a r cos θ + a²`.
//! So where sines and cosines cancel, one such sum of a product may be multiplied out (`Turned`), while all others are
//! kept, as are powers.

use std::cell::RefCell;
use std::collections::BTreeMap;

use crate::expr::{Expr, Function, Graph, Id, Node};

/// The nodes that stay factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    /// Those that are written anew join them.
    sums: RefCell<BTreeMap<Id, Terms>>,
    /// Whether sums with sines and cosines in their terms are multiplied out even where that costs more by itself.
    expands_turned: bool,
}

/// What the terms of a sum are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Terms {
    /// Whether one is not scaled by a parameter, so that it may be exact, and a factor has no constant to join.
    have_digits: bool,
    /// Whether sines or cosines are factors of one.
    are_turned: bool,
}

/// What becomes of a sum with sines and cosines in its terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turned {
    /// It is kept like others.
    Kept,
    /// One of a product is multiplied out.
    MultipliedOut,
}

/// A factor that a sum is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beside {
    /// What is constant in time.
    Constant,
    /// What need not vanish where the sum does.
    Other,
    /// What may vanish with the sum and is multiplied out, too; or the sum itself.
    Small,
}

impl Kept {
    /// The sums that these energies are not linear in, and that these forces are made of.
    pub(crate) fn of(energies: &[Expr<'_>], forces: &[Expr<'_>]) -> Self {
        let kept = Kept::default();
        for (roots, is_force) in [(energies, false), (forces, true)] {
            let Some(graph) = roots.first().map(|root| root.graph()) else { continue };
            for id in graph.reachable(roots.iter().map(|root| root.id())) {
                for (sum, is_scaled) in factors(graph, id).into_iter().flatten() {
                    let terms = Terms::of(graph, sum);
                    // Weight falls with the height, whatever that is measured from.
                    if !is_scaled || (is_force && terms.have_digits) {
                        kept.sums.borrow_mut().insert(sum, terms);
                    }
                }
            }
        }
        kept
    }

    /// And the differences of parameters that these expressions multiply, as of lengths: `(a − b) x`.
    pub(crate) fn and_constants_of(self, expressions: &[Expr<'_>]) -> Self {
        let Some(graph) = expressions.first().map(|e| e.graph()) else { return self };
        for id in graph.reachable(expressions.iter().map(|e| e.id())) {
            let node = graph.node(id);
            if matches!(node, Node::Mul(..) | Node::Power(..)) {
                let behind_signs = node.operands().map(|operand| behind_sign(graph, operand));
                let is_difference = |id: &Id| graph.is_parametric(*id) && matches!(graph.node(*id), Node::Sub(..));
                self.sums
                    .borrow_mut()
                    .extend(behind_signs.filter(is_difference).map(|difference| (difference, Terms::EXACT)));
            }
        }
        self
    }

    /// That one of them is written as another node.
    pub(super) fn rewritten(&self, sum: Id, anew: Id) {
        let mut sums = self.sums.borrow_mut();
        if let Some(&terms) = sums.get(&sum) {
            sums.entry(anew).or_insert(terms);
        }
    }

    /// Whether a node is one of them with sines and cosines in its terms.
    pub(super) fn is_turned(&self, id: Id) -> bool {
        self.sums.borrow().get(&id).is_some_and(|terms| terms.are_turned)
    }

    /// These sums, with those of which sines and cosines may cancel multiplied out, if there are any: what costs more
    /// by itself may cost less in what is derived from it.
    pub(crate) fn turned_sums_multiplied_out(&self) -> Option<Self> {
        (self.ways().len() > 1).then(|| Kept { expands_turned: true, ..self.clone() })
    }

    /// What may become of such a node.
    pub(super) fn ways(&self) -> &'static [Turned] {
        let any = self.sums.borrow().values().any(|terms| terms.are_turned);
        match (any, self.expands_turned) {
            (false, _) => &[Turned::Kept],
            (true, false) => &[Turned::Kept, Turned::MultipliedOut],
            (true, true) => &[Turned::MultipliedOut],
        }
    }

    /// Whether a node is one of them, beside such a factor.
    pub(super) fn contains(&self, id: Id, beside: Beside, turned: Turned) -> bool {
        self.sums.borrow().get(&id).is_some_and(|terms| match turned {
            Turned::MultipliedOut if terms.are_turned => beside == Beside::Small,
            Turned::Kept | Turned::MultipliedOut => terms.have_digits || beside != Beside::Constant,
        })
    }
}

/// The sums that a node multiplies or takes as arguments, and whether it does no more than to scale them by what is
/// constant in time.
fn factors(graph: &Graph, id: Id) -> [Option<(Id, bool)>; 2] {
    let taken = |operand: Id| behind_parameters(graph, operand).map(|sum| (sum, false));
    match graph.node(id) {
        Node::Mul(a, b) => [(a, b), (b, a)]
            .map(|(operand, other)| behind_parameters(graph, operand).map(|sum| (sum, graph.is_parametric(other)))),
        // Multiples of a sum of angles are sums of multiples.
        Node::Call(Function::Sin | Function::Cos, a) if is_sum(graph, a) => [None, None],
        Node::Power(a, _) | Node::Call(_, a) | Node::Spline(_, a) => [taken(a), None],
        Node::Call2(_, a, b) => [taken(a), taken(b)],
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Less(..)
        | Node::LessEqual(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => [None, None],
    }
}

/// The sum that moves in `p (a + b)`, with a sign or without.
fn behind_parameters(graph: &Graph, mut id: Id) -> Option<Id> {
    loop {
        id = match graph.node(id) {
            Node::Neg(a) => a,
            Node::Mul(a, b) if graph.is_parametric(a) => b,
            Node::Mul(a, b) if graph.is_parametric(b) => a,
            Node::Add(..) | Node::Sub(..) if !graph.is_parametric(id) => return Some(id),
            _ => return None,
        }
    }
}

fn is_sum(graph: &Graph, id: Id) -> bool {
    matches!(graph.node(behind_sign(graph, id)), Node::Add(..) | Node::Sub(..))
}

fn behind_sign(graph: &Graph, id: Id) -> Id {
    if let Node::Neg(a) = graph.node(id) { a } else { id }
}

impl Terms {
    /// Of a difference of inputs.
    const EXACT: Terms = Terms { have_digits: true, are_turned: false };

    fn of(graph: &Graph, sum: Id) -> Self {
        let is_scale = |id: Id| graph.is_parametric(id) && graph.expr(id).as_constant().is_none();
        let mut terms = Terms { have_digits: false, are_turned: false };
        let mut waiting = vec![sum];
        // In loops a sum could double with each turn.
        for _ in 0..100 {
            let Some(id) = waiting.pop() else { return terms };
            match graph.node(id) {
                Node::Add(a, b) | Node::Sub(a, b) => waiting.extend([a, b]),
                Node::Neg(a) => waiting.push(a),
                node => {
                    let is_scaled = matches!(node, Node::Mul(a, b) if is_scale(a) || is_scale(b));
                    terms.have_digits |= !is_scaled;
                    terms.are_turned |= is_turned(graph, id);
                }
            }
        }
        Terms::EXACT
    }
}

/// Whether a term is a product with a sine or cosine that moves.
fn is_turned(graph: &Graph, term: Id) -> bool {
    let mut waiting = vec![term];
    for _ in 0..100 {
        let Some(id) = waiting.pop() else { return false };
        match graph.node(id) {
            Node::Call(Function::Sin | Function::Cos, _) if !graph.is_parametric(id) => return true,
            Node::Mul(a, b) => waiting.extend([a, b]),
            Node::Neg(a) => waiting.push(a),
            _ => {}
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn factors_of_energies_and_forces_are_kept() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let kept = |energies: &[Expr<'_>], forces: &[Expr<'_>], sum: Expr<'_>| {
            let sum = if let Node::Neg(a) = sum.node() { a } else { sum.id() };
            Kept::of(energies, forces).contains(sum, Beside::Constant, Turned::Kept)
        };
        let stretch = x - rest;
        assert!(kept(&[k * stretch.powi(2)], &[], stretch));
        assert!(kept(&[-(k * stretch) * y], &[], stretch));
        assert!(kept(&[(k * stretch).call(Function::Exp)], &[], stretch));
        let distance = (x.powi(2) + y.powi(2)).sqrt() - rest;
        assert!(kept(&[k * distance.powi(2)], &[], distance));
        // Weight falls with the height, whatever that is measured from.
        assert!(!kept(&[k * stretch], &[], stretch));
        assert!(kept(&[], &[-(k * stretch)], stretch));
        let difference = k - rest;
        let kept = Kept::default().and_constants_of(&[difference.powi(2) * x, (k + rest) * y]);
        assert!(kept.contains(
            if let Node::Neg(a) = difference.node() { a } else { difference.id() },
            Beside::Constant,
            Turned::Kept
        ));
        assert!(!kept.contains((k + rest).id(), Beside::Small, Turned::Kept));
    }

    #[test]
    fn factors_join_scaled_terms() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        // Scaled terms are rounded as they stand.
        let moment = k * x - rest * y;
        let id = if let Node::Neg(a) = moment.node() { a } else { moment.id() };
        assert!(!Kept::of(&[], &[k * moment]).contains(id, Beside::Other, Turned::Kept));
        let squared = Kept::of(&[moment.powi(2)], &[]);
        let is_kept = |beside| squared.contains(id, beside, Turned::Kept);
        assert!(is_kept(Beside::Other) && !is_kept(Beside::Constant));
    }

    #[test]
    fn what_is_turned_is_kept_beside_what_vanishes_with_it() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let distance = x * y.cos() - graph.symbol(Symbol::Parameter(0));
        let kept = Kept::of(&[distance.powi(2)], &[]);
        let beside = [Beside::Constant, Beside::Other, Beside::Small];
        let is_kept = |turned| beside.map(|beside| kept.contains(distance.id(), beside, turned));
        assert_eq!(is_kept(Turned::Kept), [true; 3]);
        assert_eq!(is_kept(Turned::MultipliedOut), [false, false, true]);
        assert_eq!(Kept::of(&[(x - y).powi(2)], &[]).ways(), [Turned::Kept]);
    }
}
