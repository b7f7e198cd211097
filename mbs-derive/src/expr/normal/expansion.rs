//! A graph multiplied out: every node a sum of products of powers and waves, but for what is kept.

use std::borrow::Cow;

use super::combination::{Combination, Polynomial, Powers, power_of_powers, product_of_powers};
use super::factor;
use super::half_angle::{Double, Doubled, halved};
use super::kept::{Beside, Kept, Turned};
use super::wave::{self, Angle, Wave, cosine, sine};
use crate::expr::graph::{Expr, Graph, HalfInteger, Id, IdMap, Node};
use crate::expr::number::Number;
use crate::expr::{Function, Symbol};

/// A product of powers times a wave.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Term {
    powers: Powers,
    wave: Wave,
}

impl Term {
    fn times(&self, other: &Term) -> Option<Vec<(Term, Number)>> {
        let powers = product_of_powers(&self.powers, &other.powers)?;
        let of_wave = |(factor, wave)| (Term { powers: powers.clone(), wave }, factor);
        Some(self.wave.times(&other.wave).into_iter().map(of_wave).collect())
    }
}

/// A sum of products of powers and waves.
pub(crate) type Sum = Combination<Term>;

impl Sum {
    fn constant(value: Number) -> Self {
        Combination::term(Term { powers: Powers::new(), wave: Wave::One }, value)
    }

    fn power_of_atom(id: Id, halves: i32) -> Self {
        Combination::term(Term { powers: [(id, halves)].into(), wave: Wave::One }, Number::ONE)
    }

    fn times_sum(&self, other: &Sum, limit: usize) -> Option<Self> {
        self.product(other, limit, Term::times)
    }

    /// The one term without a wave that this is.
    fn as_monomial(&self) -> Option<(&Powers, Number)> {
        match self.as_term()? {
            (Term { powers, wave: Wave::One }, coefficient) => Some((powers, coefficient)),
            _ => None,
        }
    }
}

/// Angles with larger multiples are left to the graph.
const LARGEST_MULTIPLE: i128 = 1_000_000;

/// Nodes expanded so far.
pub(super) struct Expansion<'g, 'k> {
    graph: &'g Graph,
    kept: &'k Kept,
    turned: Turned,
    limit: usize,
    sums: IdMap<Sum>,
    /// What vanishes with a sum that is multiplied out beside others: the same with such sums as factors.
    unexpanded: IdMap<Sum>,
}

impl<'g, 'k> Expansion<'g, 'k> {
    pub(super) fn new(graph: &'g Graph, kept: &'k Kept, turned: Turned, limit: usize) -> Self {
        Expansion { graph, kept, turned, limit, sums: IdMap::default(), unexpanded: IdMap::default() }
    }

    pub(super) fn of(&mut self, root: Id) -> Option<Sum> {
        for id in self.graph.reachable([root]) {
            if !self.sums.contains_key(&id) {
                let sum = self.node(id)?;
                if sum.0.len() > self.limit {
                    return None;
                }
                self.sums.insert(id, sum);
                if let Some(unexpanded) = self.unexpanded(id)? {
                    self.unexpanded.insert(id, unexpanded);
                }
            }
        }
        Some(self.sums[&root].clone())
    }

    fn node(&self, id: Id) -> Option<Sum> {
        let minus = -Number::ONE;
        Some(match self.graph.node(id) {
            Node::Constant(value) => Sum::constant(value),
            Node::Symbol(_) => Sum::power_of_atom(id, 2),
            Node::Rate(_) => unreachable!("time derivatives were carried out by derive"),
            Node::Neg(a) => self.sums[&a].negative(),
            Node::Add(a, b) => self.sums[&a].plus(&self.sums[&b], Number::ONE),
            Node::Sub(a, b) => self.sums[&a].plus(&self.sums[&b], minus),
            Node::Mul(a, b) => {
                // Of two sums one may be multiplied out.
                let beside_a = if self.as_factor(a) == Beside::Small { Beside::Other } else { self.as_factor(a) };
                self.product(&*self.factor(a, self.as_factor(b))?, &*self.factor(b, beside_a)?)?
            }
            Node::Power(a, n) => self.power(&*self.factor(a, Beside::Small)?, n)?,
            Node::Call(function @ (Function::Sin | Function::Cos), a) => match angle_of(&self.sums[&a], self.graph) {
                Some(angle) => {
                    let (factor, wave) = if function == Function::Sin { sine(angle) } else { cosine(angle) };
                    Combination::term(Term { powers: Powers::new(), wave }, factor)
                }
                None => Sum::power_of_atom(self.inner(a)?.call(function).id(), 2),
            },
            Node::Call(function, a) => self.opaque(self.inner(a)?.call(function)),
            Node::Call2(function, a, b) => self.opaque(self.inner(a)?.call2(function, self.inner(b)?)),
            Node::Spline(derivative, a) => self.opaque(self.graph.spline_derivative(derivative, self.inner(a)?)),
            Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) | Node::Select(..) => {
                self.opaque(self.graph.expr(id))
            }
        })
    }

    /// What an operand of a product is to the other one.
    fn as_factor(&self, id: Id) -> Beside {
        match self.unexpanded.contains_key(&id) {
            _ if self.graph.is_parametric(id) => Beside::Constant,
            true => Beside::Small,
            false => Beside::Other,
        }
    }

    /// A node with all sums as factors that are multiplied out only beside what does not vanish with them, if it
    /// vanishes with one.
    fn unexpanded(&self, id: Id) -> Option<Option<Sum>> {
        if self.turned == Turned::Kept {
            return Some(None);
        }
        let of = |id: Id| self.unexpanded.get(&id);
        Some(match self.graph.node(id) {
            _ if self.kept.is_turned(id) => Some(self.factor(id, Beside::Small)?.into_owned()),
            Node::Neg(a) => of(a).map(Sum::negative),
            Node::Mul(a, b) if of(a).is_some() || of(b).is_some() => {
                Some(self.product(&*self.factor(a, Beside::Small)?, &*self.factor(b, Beside::Small)?)?)
            }
            Node::Add(a, b) => of(a).zip(of(b)).map(|(a, b)| a.plus(b, Number::ONE)),
            Node::Sub(a, b) => of(a).zip(of(b)).map(|(a, b)| a.plus(b, -Number::ONE)),
            _ => None,
        })
    }

    /// An operand of a product or a power.
    fn factor(&self, id: Id, beside: Beside) -> Option<Cow<'_, Sum>> {
        if let Some(unexpanded) = self.unexpanded.get(&id).filter(|_| beside == Beside::Small) {
            return Some(Cow::Borrowed(unexpanded));
        }
        let behind_sign = if let Node::Neg(a) = self.graph.node(id) { a } else { id };
        let sum = &self.sums[&id];
        if sum.0.len() < 2 || !self.kept.contains(behind_sign, beside, self.turned) {
            return Some(Cow::Borrowed(sum));
        }
        let written = self.expression(sum)?;
        self.kept.rewritten(behind_sign, if let Node::Neg(a) = written.node() { a } else { written.id() });
        Some(Cow::Owned(self.opaque(written)))
    }

    /// Sums multiplied out.
    fn product(&self, a: &Sum, b: &Sum) -> Option<Sum> {
        self.beside(a, b)?.times_sum(self.beside(b, a)?.as_ref(), self.limit)
    }

    /// A factor as it is multiplied out: a sum of coordinates stays one beside a factor that holds a power or a
    /// function; beside a sine or cosine, whose square it would be multiplied by where a place is turned; and beside
    /// another one, which may be itself.
    fn beside<'a>(&self, factor: &'a Sum, other: &Sum) -> Option<Cow<'a, Sum>> {
        let is_turned = other.0.keys().any(|term| term.wave != Wave::One);
        let is_kept = self.is_difference_of_places(factor)
            && (is_turned
                || self.has_atom(other, |node| !matches!(node, Node::Symbol(_)))
                || (self.is_at_rest(factor) && self.is_difference_of_places(other) && self.is_at_rest(other)));
        Some(if is_kept { Cow::Owned(self.factors(self.expression(factor)?)) } else { Cow::Borrowed(factor) })
    }

    /// Whether there are no rates in it, but for those that all terms have in common.
    fn is_at_rest(&self, sum: &Sum) -> bool {
        let is_rate =
            |id: Id| matches!(self.graph.node(id), Node::Symbol(Symbol::Velocity(_) | Symbol::Acceleration(_)));
        let rates = |term: &Term| term.powers.iter().filter(|(id, _)| is_rate(**id)).map(|(&id, &n)| (id, n)).collect();
        let mut all = sum.0.keys().map(rates);
        let first: Option<Powers> = all.next();
        all.all(|rates| Some(rates) == first)
    }

    /// A product of what is not a product: of indivisible expressions.
    fn factors(&self, expr: Expr<'g>) -> Sum {
        let (mut waiting, mut product) = (vec![expr.id()], Sum::constant(Number::ONE));
        while let Some(id) = waiting.pop() {
            let factor = match self.graph.node(id) {
                Node::Mul(a, b) => {
                    waiting.extend([a, b]);
                    continue;
                }
                Node::Neg(a) => {
                    waiting.push(a);
                    Sum::constant(-Number::ONE)
                }
                Node::Power(a, n) => Sum::power_of_atom(a, n.to_halves()),
                _ => self.opaque(self.graph.expr(id)),
            };
            let Some(longer) = product.times_sum(&factor, self.limit) else { return self.opaque(expr) };
            product = longer;
        }
        product
    }

    /// Whether powers of the sum are kept, and its products with powers and functions: a sum like x + a of coordinates,
    /// in which no sines and cosines could cancel. Near x = −a, where two points come together, x² + 2 a x + a² has
    /// lost the digits that (x + a)² has. The price is that (x + a)² − x² does not become a (a + 2 x).
    fn is_difference_of_places(&self, sum: &Sum) -> bool {
        sum.0.len() > 1
            && sum.0.keys().all(|term| term.wave == Wave::One)
            && self.has_atom(sum, |node| matches!(node, Node::Symbol(Symbol::Coordinate(_))))
    }

    fn has_atom(&self, sum: &Sum, is_it: impl Fn(Node) -> bool) -> bool {
        sum.0.keys().any(|term| term.powers.keys().any(|&id| is_it(self.graph.node(id))))
    }

    /// An indivisible expression, unless the local rules made a constant of it.
    fn opaque(&self, expr: Expr<'g>) -> Sum {
        match (expr.as_constant(), expr.node()) {
            (Some(value), _) => Sum::constant(value),
            (None, Node::Neg(a)) => Sum::power_of_atom(a, 2).negative(),
            (None, _) => Sum::power_of_atom(expr.id(), 2),
        }
    }

    /// An operand in normal form, as an expression.
    fn inner(&self, id: Id) -> Option<Expr<'g>> {
        self.expression(&self.sums[&id])
    }

    pub(super) fn expression(&self, sum: &Sum) -> Option<Expr<'g>> {
        Some(factor::factored(self.graph, &[self.polynomial(sum, None)?])[0])
    }

    /// The sum with waves as indivisible expressions, its doubled angles halved if a way is given.
    pub(super) fn polynomial(&self, sum: &Sum, doubled: Option<Doubled>) -> Option<Polynomial> {
        let mut polynomial = Polynomial::default();
        let mut doubles: IdMap<Double> = IdMap::default();
        for (term, &coefficient) in &sum.0 {
            let (powers, sign) = self.indivisible(&term.wave).as_term().map(|(p, c)| (p.clone(), c))?;
            if let (Some((&id, _)), Some(double)) = (powers.first_key_value(), self.double(&term.wave, sign)) {
                doubles.insert(id, double);
            }
            polynomial.add(product_of_powers(&term.powers, &powers)?, coefficient * sign);
        }
        let Some(doubled) = doubled else { return Some(polynomial) };
        halved(&polynomial, doubled, self.limit, |id| doubles.get(&id).cloned())
    }

    /// What `sign · wave` is the double of.
    fn double(&self, wave: &Wave, sign: Number) -> Option<Double> {
        let (function, angle) = match wave {
            Wave::One => return None,
            Wave::Sin(angle) => (Function::Sin, angle),
            Wave::Cos(angle) => (Function::Cos, angle),
        };
        let half = wave::half(angle)?;
        let is_fourfold = wave::half(&half).is_some();
        let [sine, cosine] = [Wave::Sin(half.clone()), Wave::Cos(half)].map(|wave| self.indivisible(&wave));
        Some(Double { function, sine: Polynomial::default().plus(&sine, sign), cosine, is_fourfold })
    }

    /// A wave as an indivisible expression; its sign is that of the graph's own form of the angle.
    fn indivisible(&self, wave: &Wave) -> Polynomial {
        let expr = wave.expression(self.graph);
        match (expr.as_constant(), expr.node()) {
            (Some(value), _) => Polynomial::term(Powers::new(), value),
            (None, Node::Neg(a)) => Polynomial::atom(a, 2).negative(),
            (None, _) => Polynomial::atom(expr.id(), 2),
        }
    }

    fn power(&self, base: &Sum, n: HalfInteger) -> Option<Sum> {
        if let Some(k @ 0..=4) = n.to_integer()
            && !self.is_difference_of_places(base)
        {
            return (0..k).try_fold(Sum::constant(Number::ONE), |product, _| product.times_sum(base, self.limit));
        }
        if let (Some((powers, coefficient)), Some(k)) = (base.as_monomial(), n.to_integer()) {
            let powers = power_of_powers(powers, k)?;
            return Some(Combination::term(Term { powers, wave: Wave::One }, coefficient.kept_power(n.to_halves())?));
        }
        let base = self.expression(base)?;
        Some(match base.as_constant() {
            Some(_) => self.opaque(base.power(n)),
            None => Sum::power_of_atom(base.id(), n.to_halves()),
        })
    }
}

/// The argument of a sine as integer multiples of indivisible expressions.
fn angle_of(sum: &Sum, graph: &Graph) -> Option<Angle> {
    let multiple = |(term, coefficient): (&Term, &Number)| match (*coefficient, &term.wave) {
        (Number::Exact { numerator, denominator: 1, pi: 0 }, Wave::One)
            if !term.powers.is_empty() && numerator.abs() <= LARGEST_MULTIPLE =>
        {
            let monomial = term
                .powers
                .iter()
                .fold(graph.integer(1), |product, (&id, &n)| product * graph.expr(id).power(HalfInteger::halves(n)));
            Some((monomial.id(), i32::try_from(numerator).ok()?))
        }
        _ => None,
    };
    sum.0.iter().map(multiple).collect()
}
