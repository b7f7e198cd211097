//! The arena of expressions, in which equal ones are one node. Nodes are made by what applies the local rules:
//! `arithmetic`, `power` and `condition`.
//!
//! Rules are local: they look at a node's operands and at what those are made of, never further. Nothing is expanded or
//! flattened, because the shape of the recursion that was written is what keeps the generated code short.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};
use std::rc::Rc;

use super::function::{Binary, Function};
use super::number::Number;
use super::range::Range;
use super::spline::{Spline, SplineDerivative};
use super::table::Finder;

/// Number of a node in its graph; operands have smaller numbers than what is made of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(pub(crate) u32);

impl Id {
    /// For tables over all nodes.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Symbol {
    /// Time `t`.
    Time,
    /// Generalized coordinate `q_i`.
    Coordinate(u32),
    /// Generalized velocity `q̇_i`.
    Velocity(u32),
    /// Generalized acceleration `q̈_i`.
    Acceleration(u32),
    /// Parameter, constant in time.
    Parameter(u32),
    /// Input, given from outside at each instant.
    Input(u32),
    /// Prescribed motion, given from outside at each instant: its number, and how often it is differentiated (0, 1 or
    /// 2).
    Prescribed(u32, u8),
    /// Lagrange multiplier of a constraint row.
    Multiplier(u32),
}

/// An exponent that is a multiple of one half: a power, a square root, or their reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HalfInteger(pub(super) i32);

impl HalfInteger {
    /// 1/2
    pub const HALF: HalfInteger = HalfInteger(1);
    /// −1
    pub const MINUS_ONE: HalfInteger = HalfInteger(-2);

    /// `n/2`
    pub const fn halves(n: i32) -> HalfInteger {
        HalfInteger(n)
    }

    /// `n`
    pub const fn integer(n: i32) -> HalfInteger {
        HalfInteger(2 * n)
    }

    /// Twice its value.
    pub const fn to_halves(self) -> i32 {
        self.0
    }

    /// Its value, where it is an integer.
    pub const fn to_integer(self) -> Option<i32> {
        if self.0 % 2 == 0 { Some(self.0 / 2) } else { None }
    }

    /// Its value.
    pub fn to_number(self) -> Number {
        Number::integer(i64::from(self.0)) * Number::rational(1, 2).expect("one half")
    }
}

/// Powers are not gathered beyond this many halves.
pub(super) const LARGEST_EXPONENT: i32 = 2000;

/// One node. Quotients are products with a reciprocal, square roots are powers with exponent one half.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant.
    Constant(Number),
    /// A symbol.
    Symbol(Symbol),
    /// Total time derivative, not yet carried out; only in a verbatim graph.
    Rate(Id),
    /// `−a`
    Neg(Id),
    /// `a + b`
    Add(Id, Id),
    /// `a − b`
    Sub(Id, Id),
    /// `a · b`
    Mul(Id, Id),
    /// `a^n`
    Power(Id, HalfInteger),
    /// `f(a)`
    Call(Function, Id),
    /// `f(a, b)`
    Call2(Binary, Id, Id),
    /// A derivative of a spline at a
    Spline(SplineDerivative, Id),
    /// Whether `a < b`: 1 or 0; only as a condition.
    Less(Id, Id),
    /// Whether `a <= b`: not where one of them is NaN, unlike `!(b < a)`.
    LessEqual(Id, Id),
    /// Whether both conditions hold.
    And(Id, Id),
    /// Whether a condition does not hold.
    Not(Id),
    /// `if condition { a } else { b }`
    Select(Id, Id, Id),
}

impl Node {
    /// The operands, in order.
    pub fn operands(self) -> impl Iterator<Item = Id> {
        let none = Id(0);
        let (operands, count) = match self {
            Node::Constant(_) | Node::Symbol(_) => ([none; 3], 0),
            Node::Rate(a) | Node::Neg(a) | Node::Power(a, _) | Node::Call(_, a) | Node::Spline(_, a) | Node::Not(a) => {
                ([a, none, none], 1)
            }
            Node::Add(a, b)
            | Node::Sub(a, b)
            | Node::Mul(a, b)
            | Node::Call2(_, a, b)
            | Node::Less(a, b)
            | Node::LessEqual(a, b)
            | Node::And(a, b) => ([a, b, none], 2),
            Node::Select(c, a, b) => ([c, a, b], 3),
        };
        operands.into_iter().take(count)
    }
}

/// An arena in which equal expressions are one node.
///
/// ```
/// use mbs_derive::expr::{Graph, Symbol, Tape};
/// let graph = Graph::new();
/// let x = graph.symbol(Symbol::Coordinate(0));
/// let sum = x * x + x * x;
/// assert_eq!(Tape::new(&[sum]).run(|_| 3.0), [18.0]);
/// ```
pub struct Graph {
    arena: RefCell<Arena>,
    pub(super) verbatim: bool,
    /// Whether operands are in the order in which they were made.
    by_age: bool,
    /// What nodes are called.
    pub(super) notes: RefCell<IdMap<Rc<str>>>,
}

#[derive(Default)]
struct Arena {
    nodes: Vec<Node>,
    /// A hash of what a node says, whatever else the graph holds: the order of operands must not depend on history.
    keys: Vec<u64>,
    /// Whether a node depends on parameters alone, or on nothing.
    parametric: Vec<bool>,
    /// Between which values a node stays.
    ranges: Vec<Range>,
    ids: Finder,
    /// Each with a hash of what it says.
    splines: Vec<(Rc<Spline>, u64)>,
}

impl Graph {
    /// A graph whose constructors apply the local rules.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Graph {
        Graph { arena: RefCell::default(), verbatim: false, by_age: false, notes: RefCell::default() }
    }

    /// A graph with the local rules, in which operands are in the order in which they were made, whatever they say:
    /// what is made in the same way for each link of a chain is written in the same way.
    pub(crate) fn by_age() -> Graph {
        Graph { by_age: true, ..Graph::new() }
    }

    /// A graph that keeps expressions as they were written, time derivatives included.
    pub fn verbatim() -> Graph {
        Graph { verbatim: true, ..Graph::new() }
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.arena.borrow().nodes.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The node with this number.
    pub fn node(&self, id: Id) -> Node {
        self.arena.borrow().nodes[id.index()]
    }

    /// A handle to the node with this number.
    pub fn expr(&self, id: Id) -> Expr<'_> {
        Expr { graph: self, id }
    }

    /// A constant.
    pub fn constant(&self, value: Number) -> Expr<'_> {
        if value.is_negative() && !self.verbatim {
            return -self.intern(Node::Constant(-value));
        }
        self.intern(Node::Constant(value))
    }

    /// An integer constant.
    pub fn integer(&self, value: i64) -> Expr<'_> {
        self.constant(Number::integer(value))
    }

    /// A symbol.
    pub fn symbol(&self, symbol: Symbol) -> Expr<'_> {
        self.intern(Node::Symbol(symbol))
    }

    /// The nodes that the roots are made of, operands first.
    pub fn reachable(&self, roots: impl IntoIterator<Item = Id>) -> Vec<Id> {
        self.reachable_from(roots.into_iter().collect())
    }

    fn reachable_from(&self, roots: Vec<Id>) -> Vec<Id> {
        let arena = self.arena.borrow();
        // One bit per node. Operands have smaller numbers, so that one pass from above finds all.
        let mut marked = vec![0u64; roots.iter().max().map_or(0, |last| last.index() / 64 + 1)];
        let mark = |marked: &mut [u64], id: Id| marked[id.index() / 64] |= 1 << (id.index() % 64);
        roots.into_iter().for_each(|root| mark(&mut marked, root));
        let mut found = Vec::new();
        for word in (0..marked.len()).rev() {
            let mut above = 0;
            while let rest @ 1.. = marked[word] & !above {
                let highest = rest.ilog2();
                above |= 1 << highest;
                let id = Id(64 * word as u32 + highest);
                found.push(id);
                arena.nodes[id.index()].operands().for_each(|operand| mark(&mut marked, operand));
            }
        }
        found.reverse();
        found
    }

    /// The spline with this number.
    pub fn spline_of(&self, number: u32) -> Rc<Spline> {
        Rc::clone(&self.arena.borrow().splines[number as usize].0)
    }

    /// All splines, by their numbers.
    pub fn splines(&self) -> Vec<Rc<Spline>> {
        self.arena.borrow().splines.iter().map(|(spline, _)| Rc::clone(spline)).collect()
    }

    /// The number of a spline; equal ones are one.
    pub(super) fn spline_number(&self, spline: &Spline) -> u32 {
        let key = spline.key();
        let splines = &mut self.arena.borrow_mut().splines;
        let known = splines.iter().position(|(known, its_key)| *its_key == key && **known == *spline);
        let number = known.unwrap_or_else(|| {
            splines.push((Rc::new(spline.clone()), key));
            splines.len() - 1
        });
        number as u32
    }

    pub(super) fn intern(&self, node: Node) -> Expr<'_> {
        let mut arena = self.arena.borrow_mut();
        let arena = &mut *arena;
        let key = arena.key(node);
        let known = arena.ids.find_or_add(key, |number| arena.nodes[number as usize] == node);
        let id = known.map_or_else(|| arena.push(node, key), Id);
        Expr { graph: self, id }
    }

    /// Whether the node depends on parameters alone, or on nothing.
    pub fn is_parametric(&self, id: Id) -> bool {
        self.arena.borrow().parametric[id.index()]
    }

    /// Whether the node is nowhere negative.
    pub(super) fn is_not_negative(&self, id: Id) -> bool {
        self.arena.borrow().ranges[id.index()].is_not_negative()
    }

    pub(super) fn has_one_sign(&self, id: Id) -> bool {
        self.is_not_negative(id) || self.is_not_positive(id)
    }

    /// Whether the node is nowhere positive.
    pub(super) fn is_not_positive(&self, id: Id) -> bool {
        self.arena.borrow().ranges[id.index()].is_not_positive()
    }

    /// Whether the node is a number.
    pub(super) fn is_constant(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Constant(_))
    }

    /// Whether `a` comes before `b` in the order of operands.
    pub(super) fn precedes(&self, a: Id, b: Id) -> bool {
        let arena = self.arena.borrow();
        if self.by_age { a < b } else { (arena.keys[a.index()], a) < (arena.keys[b.index()], b) }
    }
}

impl Arena {
    fn push(&mut self, node: Node, key: u64) -> Id {
        self.parametric.push(self.is_parametric(node));
        self.ranges.push(Range::of(node, |id| self.ranges[id.index()]));
        self.nodes.push(node);
        self.keys.push(key);
        Id(self.nodes.len() as u32 - 1)
    }

    fn is_parametric(&self, node: Node) -> bool {
        match node {
            Node::Symbol(symbol) => matches!(symbol, Symbol::Parameter(_)),
            node => node.operands().all(|id| self.parametric[id.index()]),
        }
    }

    fn key(&self, node: Node) -> u64 {
        let mut hasher = MixHasher::default();
        let mut write = |tag: u64, operands: &[Id]| {
            hasher.write_u64(tag);
            operands.iter().for_each(|id| hasher.write_u64(self.keys[id.index()]));
        };
        match node {
            Node::Constant(value) => write(1 ^ value.to_f64().to_bits(), &[]),
            Node::Symbol(symbol) => write(2 + symbol_key(symbol), &[]),
            Node::Rate(a) => write(3, &[a]),
            Node::Neg(a) => write(4, &[a]),
            Node::Add(a, b) => write(5, &[a, b]),
            Node::Sub(a, b) => write(6, &[a, b]),
            Node::Mul(a, b) => write(7, &[a, b]),
            Node::Power(a, n) => write(8 + ((n.0 as u64) << 8), &[a]),
            Node::Call(function, a) => write(9 + ((function as u64) << 8), &[a]),
            Node::Call2(function, a, b) => write(10 + ((function as u64) << 8), &[a, b]),
            Node::Less(a, b) => write(11, &[a, b]),
            Node::And(a, b) => write(12, &[a, b]),
            Node::Not(a) => write(13, &[a]),
            Node::Select(c, a, b) => write(14, &[c, a, b]),
            Node::LessEqual(a, b) => write(15, &[a, b]),
            Node::Spline(SplineDerivative { spline, order }, a) => {
                write(self.splines[spline as usize].1.wrapping_add((u64::from(order) << 8) + 16), &[a]);
            }
        }
        hasher.finish()
    }
}

fn symbol_key(symbol: Symbol) -> u64 {
    let (kind, index) = match symbol {
        Symbol::Time => (1, 0),
        Symbol::Coordinate(i) => (2, i),
        Symbol::Velocity(i) => (3, i),
        Symbol::Acceleration(i) => (4, i),
        Symbol::Parameter(i) => (5, i),
        Symbol::Input(i) => (6, i),
        Symbol::Prescribed(i, order) => (7 + u64::from(order), i),
        Symbol::Multiplier(i) => (10, i),
    };
    (kind << 40) + (u64::from(index) << 8)
}

/// A table over some of the nodes.
pub(crate) type IdMap<V> = HashMap<Id, V, BuildHasherDefault<MixHasher>>;

/// A small hash with a fixed start, so that every process finds the same order.
#[derive(Default)]
pub(crate) struct MixHasher(u64);

impl Hasher for MixHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }
    fn write_u8(&mut self, value: u8) {
        self.write_u64(u64::from(value));
    }
    fn write_u32(&mut self, value: u32) {
        self.write_u64(u64::from(value));
    }
    fn write_i32(&mut self, value: i32) {
        self.write_u64(value as u64);
    }
    fn write_i8(&mut self, value: i8) {
        self.write_u64(value as u64);
    }
    fn write_isize(&mut self, value: isize) {
        self.write_u64(value as u64);
    }
    fn write_i128(&mut self, value: i128) {
        self.write_u64(value as u64);
        self.write_u64((value >> 64) as u64);
    }
    fn write_u64(&mut self, value: u64) {
        // The finalizer of splitmix64 (Steele, Lea, Flood, Fast splittable pseudorandom number generators, 2014).
        let mut z = (self.0 ^ value).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        self.0 = z ^ (z >> 31);
    }
}
impl fmt::Debug for Graph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Graph of {} nodes", self.len())
    }
}

/// A handle to a node; operators build new nodes in the same graph.
#[derive(Clone, Copy)]
pub struct Expr<'g> {
    pub(super) graph: &'g Graph,
    pub(super) id: Id,
}

impl<'g> Expr<'g> {
    /// The graph that it lives in.
    pub fn graph(self) -> &'g Graph {
        self.graph
    }

    /// Its number.
    pub fn id(self) -> Id {
        self.id
    }

    /// Its node.
    pub fn node(self) -> Node {
        self.graph.node(self.id)
    }

    /// Its value, where it is a constant.
    pub fn as_constant(self) -> Option<Number> {
        match self.node() {
            Node::Constant(value) => Some(value),
            Node::Neg(a) => match self.graph.node(a) {
                Node::Constant(value) => Some(-value),
                _ => None,
            },
            _ => None,
        }
    }

    /// Whether it is the constant 0.
    pub fn is_zero(self) -> bool {
        matches!(self.node(), Node::Constant(value) if value.is_zero())
    }

    /// Whether it is the constant 1.
    pub fn is_one(self) -> bool {
        matches!(self.node(), Node::Constant(value) if value.is_one())
    }

    /// `dt(self)`, in a verbatim graph.
    pub fn rate(self) -> Expr<'g> {
        assert!(self.graph.verbatim, "time derivatives are carried out, not written, in a graph with rules");
        self.graph.intern(Node::Rate(self.id))
    }

    /// The same expression as a node of its own, in a verbatim graph: what is written like it elsewhere is another
    /// node.
    pub(crate) fn distinct(self) -> Expr<'g> {
        assert!(self.graph.verbatim, "equal expressions are one node in a graph with rules");
        let mut arena = self.graph.arena.borrow_mut();
        let (node, key) = (arena.nodes[self.id.index()], arena.keys[self.id.index()]);
        Expr { graph: self.graph, id: arena.push(node, key) }
    }
}

impl PartialEq for Expr<'_> {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.graph, other.graph) && self.id == other.id
    }
}

impl Eq for Expr<'_> {}

impl fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symbols(graph: &Graph) -> [Expr<'_>; 3] {
        [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)))
    }

    #[test]
    fn equal_expressions_are_one_node() {
        let graph = Graph::new();
        let [x, y, z] = symbols(&graph);
        assert_eq!(x * y + z, z + y * x);
        assert_eq!((x - y) + (y - x), graph.integer(0));
        assert_eq!(-(x - y), y - x);
        assert_eq!(2 * x + 3 * x, 5 * x);
        assert_eq!((2 * x) * (3 * y), 6 * (x * y));
        assert_eq!(x * x * x, x.powi(3));
        assert_eq!((x / y) * (x / y), (x / y).powi(2));
        assert_eq!((x + y) - y, x);
        assert_eq!(y - (x + y), -x);
        assert_eq!((-2 * x).powi(3), -8 * x.powi(3));
    }

    #[test]
    fn the_sign_of_a_difference_does_not_depend_on_history() {
        let build = |first_y: bool| {
            let graph = Graph::new();
            if first_y {
                graph.symbol(Symbol::Coordinate(1));
            }
            let [x, y, _] = symbols(&graph);
            matches!((x - y).node(), Node::Neg(_))
        };
        assert_eq!(build(false), build(true));
    }

    #[test]
    fn a_verbatim_graph_keeps_what_was_written() {
        let graph = Graph::verbatim();
        let [x, ..] = symbols(&graph);
        assert_eq!((x + graph.integer(0)).to_string(), "q_0 + 0");
        assert_eq!((x * x).rate().to_string(), "dt(q_0 * q_0)");
    }

    #[test]
    fn a_distinct_node_is_not_found_by_what_is_written_like_it() {
        let graph = Graph::verbatim();
        let [x, y, _] = symbols(&graph);
        let (first, second) = ((x * y).distinct(), (x * y).distinct());
        assert!(first != second && first != x * y && x * y == x * y);
        assert_eq!((first.node(), first.to_string()), ((x * y).node(), (x * y).to_string()));
    }
}
