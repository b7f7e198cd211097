//! Numerical values of expressions, over any kind of number: doubles, or dual numbers that carry derivatives.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::constrained::{NullSpace, power};
use super::factors::Factors;
use super::function::{Binary, Function};
use super::graph::{Expr, Id, Node, Symbol};
use super::number::Number;
use super::sparse::{self, Elimination};
use super::spline::{Spline, SplineDerivative};
use super::table::Table;

/// What solves a system with constraints for one right side after the other.
pub(crate) type Solution<'a, V> = Box<dyn Fn(&[V]) -> Vec<V> + 'a>;

/// What solves it for several right sides that belong together.
pub(crate) type Solutions<'a, V> = Box<dyn Fn(&[Vec<V>], &Terms<V>) -> Vec<Vec<V>> + 'a>;

/// What tells rounding from a contradiction of rows, as the runtime's `Terms`; each may be empty.
#[derive(Clone, Debug, Default)]
pub struct Terms<V> {
    /// Of each column, how large the terms of its targets are.
    pub sizes: Vec<Vec<V>>,
    /// q̈ of the motion of which the columns are derivatives.
    pub motion: Vec<V>,
    /// How large that is by which each column is a derivative, with any sign; zero where it is not known.
    pub scales: Vec<V>,
}

/// What expressions can be evaluated over.
pub trait Value: Copy {
    /// Whether conditions are numbers between 0 and 1, so to say, and both sides of a choice are evaluated.
    const TAKES_BOTH_SIDES: bool = false;
    /// An exact constant, rounded.
    fn constant(value: f64) -> Self;
    /// A constant of the graph.
    fn number(number: Number) -> Self {
        Self::constant(number.to_f64())
    }
    /// `−a`
    fn neg(self) -> Self;
    /// `a + b`
    fn add(self, other: Self) -> Self;
    /// `a − b`
    fn sub(self, other: Self) -> Self;
    /// `a · b`
    fn mul(self, other: Self) -> Self;
    /// `a / b`
    fn div(self, other: Self) -> Self;
    /// `a^(halves/2)`
    fn power(self, halves: i32) -> Self;
    /// `f(a)`
    fn call(self, function: Function) -> Self;
    /// `f(a)` by the standard library, where that differs from [`call`](Self::call).
    fn call_library(self, function: Function) -> Self {
        self.call(function)
    }
    /// `f(a, b)`
    fn call2(self, function: Binary, other: Self) -> Self;
    /// `a^b` where b does not change, so that there are derivatives where a is negative.
    fn raised_to(self, exponent: Self) -> Self {
        self.call2(Binary::Powf, exponent)
    }
    /// A derivative of a spline at a.
    fn spline(self, spline: &Spline, order: usize) -> Self {
        spline.derivative(self, order)
    }
    /// The total time derivative, for numbers that carry it.
    fn rate(self) -> Self;
    /// Whether `a < b`; derivatives do not count.
    fn less(self, other: Self) -> bool;
    /// Whether `a <= b`, as IEEE 754 has it: not where one of them is NaN.
    fn less_equal(self, other: Self) -> bool;
    /// `a < b`, or `a <= b`, as a number.
    fn condition(self, other: Self, or_equal: bool) -> Self {
        truth(if or_equal { self.less_equal(other) } else { self.less(other) })
    }
    /// `if self { a } else { b }` of a condition.
    fn select(self, a: Self, b: Self) -> Self {
        if holds(self) { a } else { b }
    }
    /// Whether it is zero and known to be exactly that, so that products with it can be left out.
    fn is_exactly_zero(self) -> bool {
        false
    }
    /// `M⁻¹ x` in the place of each column x, of a symmetric matrix given by its lower triangle, row by row.
    fn solve_symmetric(triangle: &[Self], columns: &mut [Vec<Self>]) {
        let Some(first) = columns.first() else { return };
        let factors = Factors::new(first.len(), triangle);
        columns.iter_mut().for_each(|column| factors.solve(column));
    }
    /// What gives q̈, then λ, of `M q̈ − Aᵀ λ = f`, `A q̈ = c` for a column of f, then c, of `n` coordinates; M is its
    /// lower triangle, both are row by row; rows of the same number in `vectors` are of one vector. NaN where there is
    /// no solution, or more than one q̈.
    fn constrained<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solution<'a, Self>
    where
        Self: 'a,
    {
        let solve = Self::constrained_columns(n, mass, jacobian, vectors);
        let none = Terms { sizes: Vec::new(), motion: Vec::new(), scales: Vec::new() };
        Box::new(move |column| solve(&[column.to_vec()], &none).remove(0))
    }
    /// What [`constrained`](Self::constrained) gives, for several columns.
    fn constrained_columns<'a>(n: usize, mass: Vec<Self>, jacobian: Vec<Self>, vectors: &[usize]) -> Solutions<'a, Self>
    where
        Self: 'a,
    {
        let system = NullSpace::new(n, &mass, &jacobian, vectors);
        let rows = n + vectors.len();
        let undefined = move || vec![Self::constant(f64::NAN); rows];
        Box::new(move |columns, terms| match &system {
            Some(system) => system.solve(columns, terms).into_iter().map(|x| x.unwrap_or_else(undefined)).collect(),
            None => columns.iter().map(|_| undefined()).collect(),
        })
    }
    /// What gives q̈, then λ, of the system with constraints of these entries, for a column of f, then c. NaN where a
    /// coordinate has no inertia, rows contradict each other, or something is not finite.
    fn eliminated<'a>(elimination: &'a Elimination, entries: Vec<Self>) -> Solution<'a, Self>
    where
        Self: 'a,
    {
        let factors = sparse::Factors::new(elimination, &entries);
        let found = move |column: &[Self]| factors.as_ref()?.solution(elimination, column);
        Box::new(move |column| match found(column) {
            Some(solution) => elimination.signed(solution),
            None => vec![Self::constant(f64::NAN); column.len()],
        })
    }
    /// `⌊log₂ |a|⌋`, of a subnormal number that of the smallest normal one.
    fn exponent(self) -> i32 {
        let size = if self.less(Self::constant(0.0)) { self.neg() } else { self };
        let (mut least, mut beyond) = (-1022_i32, 1024_i32);
        while beyond - least > 1 {
            let middle = (least + beyond).div_euclid(2);
            if size.less(power(middle)) { beyond = middle } else { least = middle }
        }
        least
    }
}

/// The operators, for formulas.
macro_rules! operators {
    ([$($generic:tt)*] $number:ty) => {
        impl<$($generic)*> std::ops::Add for $number {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                $crate::expr::Value::add(self, other)
            }
        }

        impl<$($generic)*> std::ops::Sub for $number {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                $crate::expr::Value::sub(self, other)
            }
        }

        impl<$($generic)*> std::ops::Mul for $number {
            type Output = Self;
            fn mul(self, other: Self) -> Self {
                $crate::expr::Value::mul(self, other)
            }
        }

        impl<$($generic)*> std::ops::Neg for $number {
            type Output = Self;
            fn neg(self) -> Self {
                $crate::expr::Value::neg(self)
            }
        }

        impl<$($generic)*> std::iter::Sum for $number {
            fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
                terms.fold(Self::default(), |sum, term| sum + term)
            }
        }

        impl<$($generic)*> Default for $number {
            fn default() -> Self {
                $crate::expr::Value::constant(0.0)
            }
        }
    };
}

pub(super) use operators;

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
    fn sub(self, other: f64) -> f64 {
        self - other
    }
    fn mul(self, other: f64) -> f64 {
        self * other
    }
    fn div(self, other: f64) -> f64 {
        self / other
    }
    fn power(self, halves: i32) -> f64 {
        match halves {
            1 => self.sqrt(),
            even if even % 2 == 0 => self.powi(even / 2),
            odd => self.sqrt().powi(odd),
        }
    }
    fn call(self, function: Function) -> f64 {
        function.value(self)
    }
    fn call_library(self, function: Function) -> f64 {
        function.library_value(self)
    }
    fn call2(self, function: Binary, other: f64) -> f64 {
        function.value(self, other)
    }
    fn rate(self) -> f64 {
        f64::NAN
    }
    fn less(self, other: f64) -> bool {
        self < other
    }
    fn less_equal(self, other: f64) -> bool {
        self <= other
    }
    fn exponent(self) -> i32 {
        (((self.to_bits() >> 52) & 0x7ff) as i32 - 1023).max(-1022)
    }
}

/// A condition as a number.
pub(crate) fn truth<V: Value>(holds: bool) -> V {
    V::constant(if holds { 1.0 } else { 0.0 })
}

/// Whether a condition, as a number, holds.
pub(crate) fn holds<V: Value>(condition: V) -> bool {
    V::constant(0.0).less(condition)
}

/// Whether `a` and `b` cannot be compared: one of them is NaN.
fn unordered<V: Value>(a: V, b: V) -> bool {
    !a.less(b) && !b.less_equal(a)
}

/// 0/0, with all derivatives that the number carries: neither true nor false.
fn undefined<V: Value>() -> V {
    V::constant(0.0).div(V::constant(0.0))
}

/// Expressions in order of evaluation, to be evaluated many times.
#[derive(Default)]
pub struct Tape {
    /// Operands are positions on the tape.
    steps: Vec<Node>,
    splines: Vec<Rc<Spline>>,
    roots: Vec<usize>,
    strict: bool,
    /// Of each step whether it is known not to change; of none on most tapes.
    fixed: Vec<bool>,
}

impl Tape {
    /// The coordinates that it depends on, or whose rates it does, rising.
    pub(crate) fn coordinates(&self) -> Vec<usize> {
        let found = self.steps.iter().filter_map(|step| match step {
            Node::Symbol(Symbol::Coordinate(i) | Symbol::Velocity(i)) => Some(*i as usize),
            _ => None,
        });
        found.collect::<BTreeSet<_>>().into_iter().collect()
    }

    /// Whether it is made of pieces, so that values at some points say nothing about others.
    pub(crate) fn has_pieces(&self) -> bool {
        let is_of_pieces = |step: &Node| match step {
            Node::Call(function, _) => matches!(function, Function::Abs | Function::Signum),
            step => matches!(step, Node::Select(..) | Node::Spline(..)),
        };
        self.steps.iter().any(is_of_pieces)
    }

    pub(crate) fn has_roots(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Node::Power(_, n) if n.to_halves() % 2 != 0))
    }

    /// A tape for these expressions.
    pub fn new(roots: &[Expr<'_>]) -> Self {
        let Some(first) = roots.first() else { return Tape::default() };
        let graph = first.graph();
        let order = graph.reachable(roots.iter().map(|root| root.id()));
        let positions = Table::new(&order, ());
        let at = |id: Id| Id(positions.position(id).expect("one of the nodes") as u32);
        let steps = order.iter().map(|&id| match graph.node(id) {
            Node::Rate(a) => Node::Rate(at(a)),
            Node::Neg(a) => Node::Neg(at(a)),
            Node::Add(a, b) => Node::Add(at(a), at(b)),
            Node::Sub(a, b) => Node::Sub(at(a), at(b)),
            Node::Mul(a, b) => Node::Mul(at(a), at(b)),
            Node::Power(a, n) => Node::Power(at(a), n),
            Node::Call(function, a) => Node::Call(function, at(a)),
            Node::Call2(function, a, b) => Node::Call2(function, at(a), at(b)),
            Node::Spline(derivative, a) => Node::Spline(derivative, at(a)),
            Node::Less(a, b) => Node::Less(at(a), at(b)),
            Node::LessEqual(a, b) => Node::LessEqual(at(a), at(b)),
            Node::And(a, b) => Node::And(at(a), at(b)),
            Node::Not(a) => Node::Not(at(a)),
            Node::Select(c, a, b) => Node::Select(at(c), at(a), at(b)),
            leaf @ (Node::Constant(_) | Node::Symbol(_)) => leaf,
        });
        let steps = steps.collect();
        let splines = graph.splines();
        let roots = roots.iter().map(|root| at(root.id()).index()).collect();
        Tape { steps, splines, roots, strict: false, fixed: Vec::new() }
    }

    /// A tape on which nothing hides that a value is undefined: what is decided by a comparison with NaN is NaN, a
    /// power with NaN in it is NaN (`1^NaN` is 1 in IEEE 754), and so are `atan2` on its cut, where the sign of a zero
    /// would decide, and `abs` at its corner, where no derivative is right: 0 for |x| would be 0 for the second
    /// of |x|², which is 2.
    ///
    /// Branches not taken do not count, nor does an operand of `&&` and `||` where the other one decides.
    pub fn strict(roots: &[Expr<'_>]) -> Self {
        Tape { strict: true, ..Tape::new(roots) }
    }

    /// A strict tape on which parameters do not change, as along motions: `x^n` has derivatives where x is negative and
    /// the parameter n an integer.
    pub(crate) fn of_motions(roots: &[Expr<'_>]) -> Self {
        let tape = Tape::strict(roots);
        let mut fixed: Vec<bool> = Vec::with_capacity(tape.steps.len());
        for step in &tape.steps {
            fixed.push(match step {
                Node::Symbol(symbol) => matches!(symbol, Symbol::Parameter(_)),
                step => step.operands().all(|operand| fixed[operand.index()]),
            });
        }
        Tape { fixed, ..tape }
    }

    /// With other functions at some steps.
    pub(super) fn with_calls(mut self, other: impl Fn(usize, Function) -> Function) -> Self {
        for (at, step) in self.steps.iter_mut().enumerate() {
            if let Node::Call(function, _) = step {
                *function = other(at, *function);
            }
        }
        self
    }

    /// The steps, whose operands are positions among them.
    pub(crate) fn steps(&self) -> &[Node] {
        &self.steps
    }

    /// The positions of the roots.
    pub(crate) fn roots(&self) -> &[usize] {
        &self.roots
    }

    /// The values of the roots where each symbol has the value that `point` gives it.
    pub fn run<V: Value>(&self, point: impl Fn(Symbol) -> V) -> Vec<V> {
        self.run_deciding(point, |_, holds| holds)
    }

    /// The values of the roots, with comparisons that come out as `decide` says: of their positions, and of how they
    /// would come out.
    pub(crate) fn run_deciding<V: Value>(
        &self,
        point: impl Fn(Symbol) -> V,
        decide: impl Fn(usize, bool) -> bool,
    ) -> Vec<V> {
        let values = self.all_deciding(&point, &decide);
        self.roots.iter().map(|&root| values[root]).collect()
    }

    /// The values of all steps.
    pub(crate) fn all<V: Value>(&self, point: impl Fn(Symbol) -> V) -> Vec<V> {
        self.all_deciding(&point, &|_, holds| holds)
    }

    /// The values of the roots where some symbols vary from a point at which the values of all steps are `known`: what
    /// the symbols are that `point` gives. A step of which nothing varies is what `fixed` makes of its known value.
    pub(crate) fn run_varied<B: Value, V: Value>(
        &self,
        known: &[B],
        fixed: impl Fn(B) -> V,
        point: impl Fn(Symbol) -> Option<V>,
    ) -> Vec<V> {
        const FIXED: usize = usize::MAX;
        let (mut places, mut values) = (vec![FIXED; self.steps.len()], Vec::new());
        for (at, &step) in self.steps.iter().enumerate() {
            let value = if let Node::Symbol(symbol) = step {
                point(symbol)
            } else if step.operands().any(|operand| places[operand.index()] != FIXED) {
                let v = |operand: Id| match places[operand.index()] {
                    FIXED => fixed(known[operand.index()]),
                    place => values[place],
                };
                Some(self.step(at, v, |_| undefined(), |_, holds| holds))
            } else {
                None
            };
            if let Some(value) = value {
                places[at] = values.len();
                values.push(value);
            }
        }
        let root = |&root: &usize| match places[root] {
            FIXED => fixed(known[root]),
            place => values[place],
        };
        self.roots.iter().map(root).collect()
    }

    /// Compiled once a kind of number, not once a closure.
    fn all_deciding<V: Value>(&self, point: &dyn Fn(Symbol) -> V, decide: &dyn Fn(usize, bool) -> bool) -> Vec<V> {
        let mut values: Vec<V> = Vec::with_capacity(self.steps.len());
        for at in 0..self.steps.len() {
            let value = self.step(at, |operand| values[operand.index()], point, decide);
            values.push(value);
        }
        values
    }

    /// The value of one step, of those of its operands.
    #[inline(always)]
    fn step<V: Value>(
        &self,
        at: usize,
        v: impl Fn(Id) -> V,
        point: impl Fn(Symbol) -> V,
        decide: impl Fn(usize, bool) -> bool,
    ) -> V {
        let step = &self.steps[at];
        // Where both sides are taken, what is undefined says so itself.
        if self.strict
            && !V::TAKES_BOTH_SIDES
            && let Some(value) = strictly(step, &v)
        {
            return value;
        }
        if let Node::Call2(Binary::Powf, a, b) = *step
            && self.fixed.get(b.index()) == Some(&true)
        {
            return v(a).raised_to(v(b));
        }
        let spline = |d: SplineDerivative, a: V| a.spline(&self.splines[d.spline as usize], d.order as usize);
        value_of(step, v, point, spline, |holds| decide(at, holds))
    }
}

/// The value of a node, of those of its operands, of symbols and of derivatives of splines; comparisons come out as
/// `decide` says.
#[inline(always)]
pub(crate) fn value_of<V: Value>(
    node: &Node,
    v: impl Fn(Id) -> V,
    point: impl Fn(Symbol) -> V,
    spline: impl Fn(SplineDerivative, V) -> V,
    decide: impl Fn(bool) -> bool,
) -> V {
    match *node {
        Node::Constant(value) => V::number(value),
        Node::Symbol(symbol) => point(symbol),
        Node::Rate(a) => v(a).rate(),
        Node::Neg(a) => v(a).neg(),
        Node::Add(a, b) => v(a).add(v(b)),
        Node::Sub(a, b) => v(a).sub(v(b)),
        Node::Mul(a, b) => v(a).mul(v(b)),
        Node::Power(a, n) => v(a).power(n.to_halves()),
        Node::Call(function, a) => v(a).call(function),
        Node::Call2(function, a, b) => v(a).call2(function, v(b)),
        Node::Spline(derivative, a) => spline(derivative, v(a)),
        Node::Less(a, b) if V::TAKES_BOTH_SIDES => v(a).condition(v(b), false),
        Node::LessEqual(a, b) if V::TAKES_BOTH_SIDES => v(a).condition(v(b), true),
        Node::And(a, b) if V::TAKES_BOTH_SIDES => v(a).mul(v(b)),
        Node::Not(a) if V::TAKES_BOTH_SIDES => V::constant(1.0).sub(v(a)),
        Node::Select(c, a, b) if V::TAKES_BOTH_SIDES => v(c).select(v(a), v(b)),
        Node::Less(a, b) => truth(decide(v(a).less(v(b)))),
        Node::LessEqual(a, b) => truth(decide(v(a).less_equal(v(b)))),
        Node::And(a, b) => truth(holds(v(a)) && holds(v(b))),
        Node::Not(a) => truth(!holds(v(a))),
        Node::Select(c, a, b) => {
            if holds(v(c)) {
                v(a)
            } else {
                v(b)
            }
        }
    }
}

/// What a step gives on a strict tape, if it is not what it gives on others.
fn strictly<V: Value>(step: &Node, v: impl Fn(Id) -> V) -> Option<V> {
    let zero = V::constant(0.0);
    let is_undecided = |condition: Id| unordered(zero, v(condition));
    let is_false = |condition: Id| v(condition).less_equal(zero);
    let is_zero = |a: Id| v(a).less_equal(zero) && zero.less_equal(v(a));
    let is_undefined = match *step {
        Node::Less(a, b) | Node::LessEqual(a, b) => unordered(v(a), v(b)),
        Node::And(a, b) => (is_undecided(a) || is_undecided(b)) && !is_false(a) && !is_false(b),
        Node::Not(a) | Node::Select(a, _, _) => is_undecided(a),
        Node::Call2(Binary::Atan2, a, b) => v(b).less_equal(zero) && is_zero(a),
        Node::Call(Function::Abs, a) => is_zero(a),
        Node::Call2(Binary::Powf, a, b) => unordered(v(a), v(b)),
        Node::Constant(_)
        | Node::Symbol(_)
        | Node::Rate(_)
        | Node::Neg(_)
        | Node::Add(..)
        | Node::Sub(..)
        | Node::Mul(..)
        | Node::Power(..)
        | Node::Call(..)
        | Node::Spline(..) => false,
    };
    is_undefined.then(undefined)
}

/// The values of `roots` where each symbol has the value that `point` gives it.
pub(crate) fn evaluate<V: Value>(roots: &[Expr<'_>], point: impl Fn(Symbol) -> V) -> Vec<V> {
    Tape::new(roots).run(point)
}

#[cfg(test)]
mod tests;
