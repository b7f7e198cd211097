//! What is known of the nodes of a verbatim graph: what each depends on, and the exact values of constants.

use crate::expr::graph::IdMap;
use crate::expr::{Expr, Fingerprints, Graph, Id, Node, Number, Symbol};

/// What an expression depends on: a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::model) struct Dependence(u8);

impl Dependence {
    pub(in crate::model) const TIME: Dependence = Dependence(1);
    pub(in crate::model) const COORDINATE: Dependence = Dependence(2);
    pub(in crate::model) const PARAMETER: Dependence = Dependence(4);
    pub(in crate::model) const INPUT: Dependence = Dependence(8);
    /// Holds a time derivative, of whatever.
    pub(in crate::model) const RATE: Dependence = Dependence(16);
    /// Holds a time derivative of something that coordinates move.
    pub(in crate::model) const VELOCITY: Dependence = Dependence(32);
    /// Holds a constant that is not a finite real number.
    pub(in crate::model) const UNDEFINED: Dependence = Dependence(64);

    /// A run-time signal that prescribes a motion.
    pub(in crate::model) const PRESCRIBED: Dependence = Dependence(128);

    /// Whether there is anything of `other` in it.
    pub(in crate::model) fn on(self, other: Dependence) -> bool {
        self.0 & other.0 != 0
    }

    #[must_use]
    pub(in crate::model) fn or(self, other: Dependence) -> Dependence {
        Dependence(self.0 | other.0)
    }

    /// Whether there is anything in it that changes in time.
    pub(in crate::model) fn moves(self) -> bool {
        let Dependence(moving) =
            Self::TIME.or(Self::COORDINATE).or(Self::INPUT).or(Self::VELOCITY).or(Self::PRESCRIBED);
        self.0 & moving != 0
    }
}

/// Operands come before what is made of them, so that one loop over the new nodes keeps the table complete.
#[derive(Default)]
pub(in crate::model) struct Facts {
    dependence: Vec<Dependence>,
    constants: IdMap<Number>,
    fingerprints: Fingerprints,
    calculator: Calculator,
}

impl Facts {
    /// What `expr` depends on.
    pub(in crate::model) fn dependence(&mut self, expr: Expr<'_>) -> Dependence {
        self.complete(expr.graph());
        self.dependence[expr.id().index()]
    }

    /// The value of an expression of numbers alone.
    pub(in crate::model) fn constant(&mut self, expr: Expr<'_>) -> Option<Number> {
        self.complete(expr.graph());
        self.constants.get(&expr.id()).copied()
    }

    /// The value of an expression of numbers alone, where it is an integer.
    pub(in crate::model) fn integer(&mut self, expr: Expr<'_>) -> Option<i64> {
        match self.constant(expr)? {
            Number::Exact { numerator, denominator: 1, pi: 0 } => i64::try_from(numerator).ok(),
            _ => None,
        }
    }

    /// Whether two expressions are equal for all values of their symbols.
    pub(in crate::model) fn are_equal(&mut self, a: Expr<'_>, b: Expr<'_>) -> bool {
        self.fingerprints.are_equal(a, b)
    }

    fn complete(&mut self, graph: &Graph) {
        for index in self.dependence.len()..graph.len() {
            let id = Id(index as u32);
            let node = graph.node(id);
            let mut dependence = self.local(node);
            if dependence == Dependence::default() {
                if let Some(value) = self.fold(graph, node).filter(|value| value.to_f64().is_finite()) {
                    self.constants.insert(id, value);
                } else {
                    dependence = Dependence::UNDEFINED;
                }
            }
            self.dependence.push(dependence);
        }
    }

    fn local(&self, node: Node) -> Dependence {
        let operands = node.operands().map(|a| self.dependence[a.index()]).fold(Dependence::default(), Dependence::or);
        match node {
            Node::Symbol(Symbol::Time) => Dependence::TIME,
            Node::Symbol(Symbol::Coordinate(_)) => Dependence::COORDINATE,
            Node::Symbol(Symbol::Velocity(_) | Symbol::Acceleration(_)) => Dependence::VELOCITY.or(Dependence::RATE),
            Node::Symbol(Symbol::Parameter(_)) => Dependence::PARAMETER,
            Node::Symbol(Symbol::Input(_) | Symbol::Multiplier(_)) => Dependence::INPUT,
            Node::Symbol(Symbol::Prescribed(_, 0)) => Dependence::PRESCRIBED,
            Node::Symbol(Symbol::Prescribed(..)) => Dependence::PRESCRIBED.or(Dependence::RATE),
            Node::Rate(_) if operands.on(Dependence::COORDINATE) => {
                operands.or(Dependence::RATE).or(Dependence::VELOCITY)
            }
            Node::Rate(_) if operands != Dependence::default() => operands.or(Dependence::RATE),
            Node::Rate(_)
            | Node::Constant(_)
            | Node::Neg(_)
            | Node::Add(..)
            | Node::Sub(..)
            | Node::Mul(..)
            | Node::Power(..)
            | Node::Call(..)
            | Node::Call2(..)
            | Node::Spline(..)
            | Node::Less(..)
            | Node::LessEqual(..)
            | Node::And(..)
            | Node::Not(_)
            | Node::Select(..) => operands,
        }
    }

    /// The value of a node whose operands are constants; `None` where it has none.
    fn fold(&self, graph: &Graph, node: Node) -> Option<Number> {
        let value = |id: Id| self.constants[&id];
        match node {
            Node::Constant(value) => Some(value),
            Node::Symbol(_) => None,
            Node::Rate(_) => Some(Number::ZERO),
            Node::Neg(a) => Some(-value(a)),
            Node::Add(a, b) => Some(value(a) + value(b)),
            Node::Sub(a, b) => Some(value(a) + -value(b)),
            Node::Mul(a, b) => Some(value(a) * value(b)),
            Node::Power(_, n) if n.to_halves() == 0 => Some(Number::ONE),
            Node::Power(a, n) => value(a).power(n.to_halves()),
            Node::Call(function, a) => self.calculator.number(value(a)).call(function).as_constant(),
            Node::Call2(function, a, b) => {
                self.calculator.number(value(a)).call2(function, self.calculator.number(value(b))).as_constant()
            }
            Node::Spline(derivative, a) => {
                let spline = graph.spline_of(derivative.spline);
                Some(value(a).spline(&spline, derivative.order as usize))
            }
            Node::Less(a, b) => Some(truth((value(a) + -value(b)).is_negative())),
            Node::LessEqual(a, b) => Some(truth(!(value(b) + -value(a)).is_negative())),
            Node::And(a, b) => Some(truth(!value(a).is_zero() && !value(b).is_zero())),
            Node::Not(a) => Some(truth(value(a).is_zero())),
            Node::Select(condition, a, b) => Some(value(if value(condition).is_zero() { b } else { a })),
        }
    }
}

fn truth(value: bool) -> Number {
    if value { Number::ONE } else { Number::ZERO }
}

/// A graph with rules: functions of constants fold in it as they will in the finished equations.
struct Calculator(Graph);

impl Calculator {
    fn number(&self, value: Number) -> Expr<'_> {
        self.0.constant(value)
    }
}

impl Default for Calculator {
    fn default() -> Self {
        Calculator(Graph::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Binary, Function};

    #[test]
    fn constants_fold_exactly() {
        let graph = Graph::verbatim();
        let mut facts = Facts::default();
        let half = 1 / graph.integer(2);
        let right_angle = graph.constant(Number::PI) * half;
        assert_eq!(facts.constant(half), Number::rational(1, 2));
        assert_eq!(facts.constant(-right_angle.cos() + half), Number::rational(1, 2));
        assert_eq!(facts.constant(graph.integer(16).sqrt()), Some(Number::integer(4)));
        assert_eq!(facts.constant(graph.integer(1).call2(Binary::Powf, half)), Some(Number::ONE));
        assert_eq!(facts.constant(half.rate()), Some(Number::ZERO));
        assert_eq!(facts.integer(graph.integer(7) - graph.integer(4)), Some(3));
        assert_eq!(facts.integer(half), None);
        assert_eq!(facts.constant(graph.symbol(Symbol::Parameter(0))), None);
    }

    #[test]
    fn conditions_of_constants_fold() {
        let graph = Graph::verbatim();
        let mut facts = Facts::default();
        let [one, two, q] = [graph.integer(1), graph.integer(2), graph.symbol(Symbol::Coordinate(0))];
        let mut chosen = |condition| facts.constant(graph.select(condition, one, two));
        assert_eq!(chosen(one.less(two)), Some(Number::ONE));
        assert_eq!(chosen(two.less_equal(two)), Some(Number::ONE));
        assert_eq!(chosen(one.less(two).not().or(two.less(one))), Some(Number::integer(2)));
        assert_eq!(chosen(q.less(two)), None);
        assert!(facts.dependence(graph.select(q.less(two), one, two)).on(Dependence::COORDINATE));
    }

    #[test]
    fn what_has_no_finite_value_is_undefined() {
        let graph = Graph::verbatim();
        let mut facts = Facts::default();
        let zero = graph.integer(0);
        let huge = graph.constant(Number::rounded(1e300, 0.0));
        for expr in [1 / zero, zero.call(Function::Ln), graph.integer(-1).sqrt(), huge * huge, (1 / zero) * 2] {
            assert_eq!(facts.constant(expr), None);
            assert!(facts.dependence(expr).on(Dependence::UNDEFINED), "{expr}");
        }
    }

    #[test]
    fn dependences_add_up() {
        let graph = Graph::verbatim();
        let mut facts = Facts::default();
        let [q, p, t] = [Symbol::Coordinate(0), Symbol::Parameter(0), Symbol::Time].map(|s| graph.symbol(s));
        assert!(!facts.dependence(p * 2).moves());
        assert!(facts.dependence(p * t).moves());
        assert!(facts.dependence((p * q).rate()).on(Dependence::VELOCITY));
        assert!(!facts.dependence(t.sin().rate()).on(Dependence::VELOCITY));
        assert!(facts.dependence(t.sin().rate()).on(Dependence::RATE));
    }
}
