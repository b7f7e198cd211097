//! The arena of expressions; its constructors, the only way to make a node, apply the local rules.
//!
//! Rules are local: they look at a node's operands and at what those are made of, never further. Nothing is expanded or
//! flattened, because the shape of the recursion that was written is what keeps the generated code short.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::evaluate::Value;
use super::function::{Binary, Function};
use super::number::Number;
use super::range::Range;
use super::rounded::Rounded;
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
    /// Prescribed motion, given from outside at each instant: its number, and how often it is differentiated (0, 1 or 2).
    Prescribed(u32, u8),
    /// Lagrange multiplier of a constraint row.
    Multiplier(u32),
}

/// An exponent that is a multiple of one half: a power, a square root, or their reciprocal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HalfInteger(i32);

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
const LARGEST_EXPONENT: i32 = 2000;

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
            Node::Rate(a) | Node::Neg(a) | Node::Power(a, _) | Node::Call(_, a) | Node::Not(a) => ([a, none, none], 1),
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
pub struct Graph {
    arena: RefCell<Arena>,
    verbatim: bool,
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
}

impl Graph {
    /// A graph whose constructors apply the local rules.
    #[allow(clippy::new_without_default)]
    pub fn new() -> Graph {
        Graph { arena: RefCell::default(), verbatim: false }
    }

    /// A graph that keeps expressions as they were written, time derivatives included.
    pub fn verbatim() -> Graph {
        Graph { arena: RefCell::default(), verbatim: true }
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
        let arena = self.arena.borrow();
        let roots: Vec<Id> = roots.into_iter().collect();
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

    fn intern(&self, node: Node) -> Expr<'_> {
        let mut arena = self.arena.borrow_mut();
        let arena = &mut *arena;
        let key = arena.key(node);
        let known = arena.ids.find_or_add(key, |number| arena.nodes[number as usize] == node);
        let number = known.unwrap_or_else(|| {
            arena.parametric.push(arena.is_parametric(node));
            arena.ranges.push(Range::of(node, |id| arena.ranges[id.index()]));
            arena.nodes.push(node);
            arena.keys.push(key);
            arena.nodes.len() as u32 - 1
        });
        Expr { graph: self, id: Id(number) }
    }

    /// Whether the node depends on parameters alone, or on nothing.
    pub fn is_parametric(&self, id: Id) -> bool {
        self.arena.borrow().parametric[id.index()]
    }

    /// Whether the node is nowhere negative.
    fn is_not_negative(&self, id: Id) -> bool {
        self.arena.borrow().ranges[id.index()].is_not_negative()
    }

    fn has_one_sign(&self, id: Id) -> bool {
        self.is_not_negative(id) || self.is_not_positive(id)
    }

    /// Whether the node is nowhere positive.
    fn is_not_positive(&self, id: Id) -> bool {
        self.arena.borrow().ranges[id.index()].is_not_positive()
    }

    /// Whether `a` comes before `b` in the order of operands.
    fn precedes(&self, a: Id, b: Id) -> bool {
        let arena = self.arena.borrow();
        (arena.keys[a.index()], a) < (arena.keys[b.index()], b)
    }
}

impl Arena {
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
    graph: &'g Graph,
    id: Id,
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

    /// `self^n`
    pub fn powi(self, n: i32) -> Expr<'g> {
        self.power(HalfInteger::integer(n))
    }

    /// The square root.
    pub fn sqrt(self) -> Expr<'g> {
        self.power(HalfInteger::HALF)
    }

    /// The sine.
    pub fn sin(self) -> Expr<'g> {
        self.call(Function::Sin)
    }

    /// The cosine.
    pub fn cos(self) -> Expr<'g> {
        self.call(Function::Cos)
    }

    /// `self^n` for a multiple of one half.
    pub fn power(self, n: HalfInteger) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Power(self.id, n));
        }
        match (self.node(), n.0) {
            (_, 0) => graph.integer(1),
            (_, 2) => self,
            (Node::Constant(value), halves) => match value.power(halves) {
                Some(folded) => graph.constant(folded),
                None => graph.intern(Node::Power(self.id, n)),
            },
            (Node::Neg(a), halves) if halves % 2 == 0 => {
                let power = graph.expr(a).power(n);
                if halves % 4 == 0 { power } else { -power }
            }
            // (x^a)^b = x^(a b) holds for an integer b wherever the left side exists.
            (Node::Power(a, inner), halves)
                if halves % 2 == 0 && i64::from(inner.0) * i64::from(halves) <= 2 * i64::from(LARGEST_EXPONENT) =>
            {
                graph.expr(a).power(HalfInteger(inner.0 * (halves / 2)))
            }
            // For any b where x has one sign, or x^a is the square of a square, it holds of |x|.
            (Node::Power(a, inner), halves)
                if inner.0 % 4 == 0 && (inner.0 % 8 == 0 || graph.has_one_sign(a)) && inner.0.abs() <= 64 =>
            {
                let size = if graph.is_not_positive(a) { -graph.expr(a) } else { graph.expr(a) };
                size.power(HalfInteger(inner.0 / 2 * halves))
            }
            (Node::Call(Function::Abs, a), halves) if halves % 4 == 0 => graph.expr(a).power(n),
            (Node::Mul(c, x), halves) if halves % 2 == 0 && graph.is_constant(c) => {
                graph.expr(c).power(n) * graph.expr(x).power(n)
            }
            _ => graph.intern(Node::Power(self.id, n)),
        }
    }

    /// `function(self)`
    pub fn call(self, function: Function) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Call(function, self.id));
        }
        if let Some(value) = self.as_constant() {
            let rounded =
                || Number::rounded(function.folded(value.to_f64()), Rounded::from(value).call(function).error);
            let folded = exact_value(function, value).unwrap_or_else(rounded);
            if folded.to_f64().is_finite() {
                return graph.constant(folded);
            }
        }
        match (self.node(), function) {
            (_, Function::Abs) if graph.is_not_negative(self.id) => self,
            (_, Function::Abs) if graph.is_not_positive(self.id) => -self,
            (Node::Neg(a), f) if f.is_even() => graph.expr(a).call(f),
            (Node::Neg(a), f) if f.is_odd() => -graph.expr(a).call(f),
            (Node::Add(c, x) | Node::Add(x, c) | Node::Sub(c, x) | Node::Sub(x, c), Function::Sin | Function::Cos)
                if graph.quarter_turns(c).is_some() =>
            {
                self.turned(function, c, x)
            }
            _ => graph.intern(Node::Call(function, self.id)),
        }
    }

    /// sin or cos of `x ± c` or `c − x`, where `c` is a number of quarter turns.
    fn turned(self, function: Function, c: Id, x: Id) -> Expr<'g> {
        let graph = self.graph;
        let (quarters, x) = match self.node() {
            Node::Sub(a, _) if a == x => (-graph.quarter_turns(c).unwrap_or(0), graph.expr(x)),
            Node::Sub(..) => (graph.quarter_turns(c).unwrap_or(0), -graph.expr(x)),
            _ => (graph.quarter_turns(c).unwrap_or(0), graph.expr(x)),
        };
        // sin(x + k π/2), with cos x = sin(x + π/2)
        let k = quarters + i64::from(function == Function::Cos);
        match k.rem_euclid(4) {
            0 => x.sin(),
            1 => x.cos(),
            2 => -x.sin(),
            _ => -x.cos(),
        }
    }

    /// `function(self, other)`
    pub fn call2(self, function: Binary, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if !graph.verbatim
            && let (Some(a), Some(b)) = (self.as_constant(), other.as_constant())
        {
            let folded = function.folded(a.to_f64(), b.to_f64());
            if folded.is_finite() {
                let error = Rounded::from(a).call2(function, Rounded::from(b)).error;
                return graph.constant(Number::rounded(folded, error));
            }
        }
        graph.intern(Node::Call2(function, self.id, other.id))
    }

    /// Splits `c · x`, and `(c · p) · x` where p depends on parameters alone, into c and `x` or `p · x`; c is 1 where there is
    /// no number.
    fn split_coefficient(self) -> (Number, Expr<'g>) {
        let graph = self.graph;
        let constant = |e: Expr<'g>| match e.node() {
            Node::Mul(c, x) => match graph.node(c) {
                Node::Constant(value) => Some((value, graph.expr(x))),
                _ => None,
            },
            _ => None,
        };
        let inside = || {
            let (parameters, x) = self.split_parameters()?;
            constant(parameters).map(|(c, p)| (c, graph.ordered_product(p, x)))
        };
        match self.node() {
            Node::Constant(value) => (value, graph.integer(1)),
            _ => constant(self).or_else(inside).unwrap_or((Number::ONE, self)),
        }
    }

    /// Whether the number in this product is multiplied with parameters, beside which the other factor has none.
    fn keeps_number_beside(self, other: Expr<'g>) -> bool {
        let graph = self.graph;
        let parametric = graph.is_parametric(self.id) && !graph.is_constant(self.id);
        self.split_parameters().is_some() || (parametric && !graph.is_parametric(other.id))
    }

    /// Splits `p · x`, where p depends on parameters alone and is no number, and x does not.
    fn split_parameters(self) -> Option<(Expr<'g>, Expr<'g>)> {
        let Node::Mul(a, b) = self.node() else { return None };
        let graph = self.graph;
        match (graph.is_parametric(a), graph.is_parametric(b)) {
            (true, false) if !graph.is_constant(a) => Some((graph.expr(a), graph.expr(b))),
            (false, true) => Some((graph.expr(b), graph.expr(a))),
            _ => None,
        }
    }
}

impl Graph {
    fn is_constant(&self, id: Id) -> bool {
        matches!(self.node(id), Node::Constant(_))
    }

    fn quarter_turns(&self, id: Id) -> Option<i64> {
        self.expr(id).as_constant()?.quarter_turns()
    }

    /// `c · x` for a positive constant; constants stand first.
    fn scaled<'g>(&'g self, c: Number, x: Expr<'g>) -> Expr<'g> {
        self.constant(c) * x
    }
}

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

/// Values of trigonometric functions that are rational.
fn exact_value(function: Function, argument: Number) -> Option<Number> {
    let sine = |quarters: i64| Number::integer([0, 1, 0, -1][quarters.rem_euclid(4) as usize]);
    match function {
        Function::Sin => argument.quarter_turns().map(sine),
        Function::Cos => argument.quarter_turns().map(|quarters| sine(quarters + 1)),
        Function::Tan | Function::Asin | Function::Atan | Function::Sinh | Function::Tanh if argument.is_zero() => {
            Some(Number::ZERO)
        }
        Function::Exp | Function::Cosh if argument.is_zero() => Some(Number::ONE),
        Function::Abs => Some(if argument.is_negative() { -argument } else { argument }),
        _ => None,
    }
}

impl<'g> Neg for Expr<'g> {
    type Output = Expr<'g>;

    fn neg(self) -> Expr<'g> {
        let graph = self.graph;
        match self.node() {
            Node::Neg(a) if !graph.verbatim => graph.expr(a),
            Node::Constant(value) if value.is_zero() => self,
            _ => graph.intern(Node::Neg(self.id)),
        }
    }
}

impl<'g> Add for Expr<'g> {
    type Output = Expr<'g>;

    fn add(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Add(self.id, other.id));
        }
        if let (Some(a), Some(b)) = (self.as_constant(), other.as_constant()) {
            return graph.constant(a + b);
        }
        match (self.node(), other.node()) {
            (Node::Constant(c), _) if c.is_zero() => other,
            (_, Node::Constant(c)) if c.is_zero() => self,
            (Node::Neg(a), Node::Neg(b)) => -(graph.expr(a) + graph.expr(b)),
            (_, Node::Neg(b)) => self - graph.expr(b),
            (Node::Neg(a), _) => other - graph.expr(a),
            // (a − b) + b = a
            (Node::Sub(a, b), _) if b == other.id => graph.expr(a),
            (_, Node::Sub(a, b)) if b == self.id => graph.expr(a),
            _ => self.sum_of_like_terms(other).unwrap_or_else(|| {
                let (a, b) = if graph.precedes(self.id, other.id) { (self, other) } else { (other, self) };
                graph.intern(Node::Add(a.id, b.id))
            }),
        }
    }
}

impl<'g> Expr<'g> {
    /// `c·x + d·x = (c + d)·x`, `sin²x + cos²x = 1`
    fn sum_of_like_terms(self, other: Expr<'g>) -> Option<Expr<'g>> {
        let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
        if x.id == y.id {
            return Some(self.graph.scaled(c + d, x));
        }
        if c == d && x.is_square_of_sine_beside_cosine(y) {
            return Some(self.graph.constant(c));
        }
        None
    }

    fn is_square_of_sine_beside_cosine(self, other: Expr<'g>) -> bool {
        let squared = |e: Expr<'g>| match e.node() {
            Node::Power(base, n) if n == HalfInteger::integer(2) => match e.graph.node(base) {
                Node::Call(function @ (Function::Sin | Function::Cos), x) => Some((function, x)),
                _ => None,
            },
            _ => None,
        };
        matches!((squared(self), squared(other)), (Some((f, x)), Some((g, y))) if f != g && x == y)
    }
}

impl<'g> Sub for Expr<'g> {
    type Output = Expr<'g>;

    fn sub(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Sub(self.id, other.id));
        }
        if let (Some(a), Some(b)) = (self.as_constant(), other.as_constant()) {
            return graph.constant(a + -b);
        }
        if self.id == other.id {
            return graph.integer(0);
        }
        match (self.node(), other.node()) {
            (Node::Constant(c), _) if c.is_zero() => -other,
            (_, Node::Constant(c)) if c.is_zero() => self,
            (Node::Neg(a), Node::Neg(b)) => graph.expr(b) - graph.expr(a),
            (_, Node::Neg(b)) => self + graph.expr(b),
            (Node::Neg(a), _) => -(graph.expr(a) + other),
            // (a + b) − b = a, a − (a + b) = −b, (a − b) − a = −b, a − (a − b) = b
            (Node::Add(a, b), _) if b == other.id => graph.expr(a),
            (Node::Add(a, b), _) if a == other.id => graph.expr(b),
            (_, Node::Add(a, b)) if a == self.id => -graph.expr(b),
            (_, Node::Add(a, b)) if b == self.id => -graph.expr(a),
            (Node::Sub(a, b), _) if a == other.id => -graph.expr(b),
            (_, Node::Sub(a, b)) if a == self.id => graph.expr(b),
            _ => {
                let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
                if x.id == y.id {
                    return graph.scaled(c + -d, x);
                }
                // One sign for a difference and its negative, whichever was built first.
                if graph.precedes(self.id, other.id) {
                    graph.intern(Node::Sub(self.id, other.id))
                } else {
                    -graph.intern(Node::Sub(other.id, self.id))
                }
            }
        }
    }
}

impl<'g> Mul for Expr<'g> {
    type Output = Expr<'g>;

    fn mul(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        if graph.verbatim {
            return graph.intern(Node::Mul(self.id, other.id));
        }
        match (self.node(), other.node()) {
            (Node::Neg(a), Node::Neg(b)) => return graph.expr(a) * graph.expr(b),
            (Node::Neg(a), _) => return -(graph.expr(a) * other),
            (_, Node::Neg(b)) => return -(self * graph.expr(b)),
            (Node::Constant(a), Node::Constant(b)) => return graph.constant(a * b),
            (_, Node::Constant(_)) => return other * self,
            (Node::Constant(c), _) if c.is_zero() => return self,
            (Node::Constant(c), _) if c.is_one() => return other,
            _ => {}
        }
        let ((c, x), (d, y)) = (self.split_coefficient(), other.split_coefficient());
        // A number stays with parameters that it multiplies, so that both are multiplied once; 2 x · (1/2 p) y = p x y.
        let in_place = |e: Expr<'g>, c: Number, beside: Expr<'g>| c.is_one() || e.keeps_number_beside(beside);
        let both = !c.is_one() && !d.is_one() && self.id != other.id;
        if !both && in_place(self, c, other) && in_place(other, d, self) {
            return self.product_of_powers(other);
        }
        let product = if x.is_one() { y } else { x.product_of_powers(y) };
        let coefficient = c * d;
        if coefficient.is_one() {
            return product;
        }
        if let Some((p, z)) = product.split_parameters() {
            return graph.ordered_product(graph.constant(coefficient) * p, z);
        }
        match product.node() {
            Node::Constant(value) => graph.constant(coefficient * value),
            Node::Neg(a) => -graph.scaled(coefficient, graph.expr(a)),
            Node::Mul(e, z) if graph.is_constant(e) => graph.scaled(coefficient, graph.expr(e)) * graph.expr(z),
            _ => graph.intern(Node::Mul(graph.constant(coefficient).id, product.id)),
        }
    }
}

impl<'g> Expr<'g> {
    /// `x^a · x^b = x^(a + b)`
    fn product_of_powers(self, other: Expr<'g>) -> Expr<'g> {
        let graph = self.graph;
        let power = |e: Expr<'g>| match e.node() {
            Node::Power(base, n) => (base, n.0),
            _ => (e.id, 2),
        };
        let ((x, a), (y, b)) = (power(self), power(other));
        // √x · 1/√x is left alone: it says that x is positive.
        let cancels_roots = i64::from(a) + i64::from(b) == 0 && a % 2 != 0;
        match a.checked_add(b).filter(|sum| sum.abs() <= LARGEST_EXPONENT) {
            Some(sum) if x == y && !cancels_roots => return graph.expr(x).power(HalfInteger(sum)),
            _ => {}
        }
        if let Some(product) = self.with_root(other).or_else(|| other.with_root(self)) {
            return product;
        }
        graph.ordered_product(self, other)
    }
}

impl Graph {
    fn ordered_product<'g>(&'g self, a: Expr<'g>, b: Expr<'g>) -> Expr<'g> {
        let (a, b) = if self.precedes(a.id, b.id) { (a, b) } else { (b, a) };
        self.intern(Node::Mul(a.id, b.id))
    }
}

impl<'g> Expr<'g> {
    /// `(k · √x) · √x = k · x`: roots meet in a product before they are differentiated.
    fn with_root(self, root: Expr<'g>) -> Option<Expr<'g>> {
        let graph = self.graph;
        let odd = |id: Id| match graph.node(id) {
            Node::Power(base, n) if n.0 % 2 != 0 => Some((base, n.0)),
            _ => None,
        };
        let (base, n) = odd(root.id)?;
        let Node::Mul(a, b) = self.node() else { return None };
        let meets = |id: Id| odd(id).is_some_and(|(other, m)| other == base && n + m != 0);
        match (meets(a), meets(b)) {
            (_, true) => Some(graph.expr(a) * (graph.expr(b) * root)),
            (true, _) => Some((graph.expr(a) * root) * graph.expr(b)),
            _ => None,
        }
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // a quotient is a product with a reciprocal
impl<'g> Div for Expr<'g> {
    type Output = Expr<'g>;

    fn div(self, other: Expr<'g>) -> Expr<'g> {
        self * other.power(HalfInteger::MINUS_ONE)
    }
}

macro_rules! operators_with_integers {
    ($($operator:ident $method:ident),*) => {$(
        impl<'g> $operator<i64> for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: i64) -> Expr<'g> {
                self.$method(self.graph.integer(other))
            }
        }
        impl<'g> $operator<Expr<'g>> for i64 {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                other.graph.integer(self).$method(other)
            }
        }
    )*};
}
operators_with_integers!(Add add, Sub sub, Mul mul, Div div);

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
    fn a_number_stays_with_the_parameters_that_it_multiplies() {
        let graph = Graph::new();
        let [x, y, _] = symbols(&graph);
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let half = graph.integer(1) / 2;
        let scaled = |e: Expr<'_>| matches!(e.node(), Node::Mul(a, b) if [a, b].contains(&(half * m).id()));
        assert!(scaled(half * (m * x)) && scaled(m * (half * x)) && scaled((half * m) * x));
        assert_eq!(half * (m * x), (half * m) * x);
        assert_eq!((half * m * x) * (2 * y), (m * x) * y);
        assert_eq!((half * m) * (2 * (l * x)), m * (l * x));
        assert_eq!(half * (m * x) + half * (m * x), m * x);
        assert_eq!(3 * (m * x) - m * x, 2 * (m * x));
        assert_eq!(half * (m * x) - m * x, -(half * (m * x)));
        assert_eq!((half * m * x) * (half * m * x), (half * m * x).powi(2));
    }

    #[test]
    fn square_roots_cancel_before_they_are_differentiated() {
        let graph = Graph::new();
        let [x, y, _] = symbols(&graph);
        let norm = (x.powi(2) + y.powi(2)).sqrt();
        assert_eq!(norm.powi(2), x.powi(2) + y.powi(2));
        assert_eq!(norm * norm, x.powi(2) + y.powi(2));
        assert_eq!(norm.powi(3), (x.powi(2) + y.powi(2)).power(HalfInteger::halves(3)));
        assert_eq!(x.sqrt() * x.sqrt(), x);
        assert_eq!(y * x.sqrt() * x.sqrt(), y * x);
        assert_eq!(x.sqrt() * (x.sqrt() * y), y * x);
        let size = x.call(Function::Abs);
        assert_eq!((size * size, size.powi(4)), (x.powi(2), x.powi(4)));
        assert_ne!(x.powi(2).sqrt(), x);
    }

    #[test]
    fn trigonometry_of_constants_is_exact() {
        let graph = Graph::new();
        let [x, ..] = symbols(&graph);
        let right_angle = graph.constant(Number::PI) / graph.integer(2);
        assert!((-right_angle).cos().is_zero());
        assert_eq!((-right_angle).sin(), graph.integer(-1));
        assert_eq!((x - right_angle).sin(), -x.cos());
        assert_eq!((right_angle - x).sin(), x.cos());
        assert_eq!((x + right_angle).cos(), -x.sin());
        assert_eq!((right_angle - x).cos(), x.sin());
        assert_eq!((-x).sin(), -x.sin());
        assert_eq!(x.sin().powi(2) + x.cos().powi(2), graph.integer(1));
        assert_eq!(3 * x.cos().powi(2) + 3 * x.sin().powi(2), graph.integer(3));
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
}
