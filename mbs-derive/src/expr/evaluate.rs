//! Numerical values of expressions, over any kind of number: doubles, or dual numbers that carry derivatives.

use super::function::{Binary, Function};
use super::graph::{Expr, Id, IdMap, Node, Symbol};

/// What a graph can be evaluated over.
pub trait Value: Copy {
    /// An exact constant, rounded.
    fn constant(value: f64) -> Self;
    /// `−a`
    fn neg(self) -> Self;
    /// `a + b`
    fn add(self, other: Self) -> Self;
    /// `a · b`
    fn mul(self, other: Self) -> Self;
    /// `a^(halves/2)`
    fn power(self, halves: i32) -> Self;
    /// `f(a)`
    fn call(self, function: Function) -> Self;
    /// `f(a, b)`
    fn call2(self, function: Binary, other: Self) -> Self;
    /// The total time derivative, for numbers that carry it.
    fn rate(self) -> Self;
}

impl Value for f64 {
    fn constant(value: f64) -> f64 {
        value
    }
    fn neg(self) -> f64 {
        -self
    }
    fn add(self, other: f64) -> f64 {
        self + other
    }
    fn mul(self, other: f64) -> f64 {
        self * other
    }
    fn power(self, halves: i32) -> f64 {
        if halves % 2 == 0 { self.powi(halves / 2) } else { self.sqrt().powi(halves) }
    }
    fn call(self, function: Function) -> f64 {
        function.value(self)
    }
    fn call2(self, function: Binary, other: f64) -> f64 {
        function.value(self, other)
    }
    fn rate(self) -> f64 {
        f64::NAN
    }
}

/// The values of `roots` where each symbol has the value that `point` gives it.
pub fn evaluate<V: Value>(roots: &[Expr<'_>], point: impl Fn(Symbol) -> V) -> Vec<V> {
    let Some(first) = roots.first() else { return Vec::new() };
    let graph = first.graph();
    let mut values: IdMap<V> = IdMap::default();
    for id in graph.reachable(roots.iter().map(|root| root.id())) {
        let v = |operand: Id| values[&operand];
        let value = match graph.node(id) {
            Node::Constant(value) => V::constant(value.to_f64()),
            Node::Symbol(symbol) => point(symbol),
            Node::Rate(a) => v(a).rate(),
            Node::Neg(a) => v(a).neg(),
            Node::Add(a, b) => v(a).add(v(b)),
            Node::Sub(a, b) => v(a).add(v(b).neg()),
            Node::Mul(a, b) => v(a).mul(v(b)),
            Node::Power(a, n) => v(a).power(n.to_halves()),
            Node::Call(function, a) => v(a).call(function),
            Node::Call2(function, a, b) => v(a).call2(function, v(b)),
        };
        values.insert(id, value);
    }
    roots.iter().map(|root| values[&root.id()]).collect()
}
