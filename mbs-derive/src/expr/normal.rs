//! Multiple-angle normal form: sums of monomials times a sine or cosine of a sum of angles, as in a textbook.
//!
//! Products of sines and cosines become sums, `cos a cos b = ½ (cos(a − b) + cos(a + b))`, so that what cancels cancels
//! and a double pendulum shows `m2 l1 l2 cos(θ1 − θ2)`. The form can be exponentially longer than the graph it stands
//! for, so it is given up when it grows past a bound; then the graph's own form is the better one.
//!
//! - [`combination`]: linear combinations and polynomials;
//! - [`wave`]: sines and cosines of sums of angles;
//! - [`half_angle`]: doubled angles halved again, `sin²θ` for `½ (1 − cos 2θ)`;
//! - [`kept`]: sums that stay factors, so that no digits are lost;
//! - `digits`: whether a form has lost some all the same;
//! - [`factor`]: polynomials as expressions, with common factors taken out and products shared.

pub mod combination;
mod digits;
pub mod factor;
pub mod half_angle;
pub mod kept;
pub mod wave;

use std::borrow::Cow;

use super::graph::{Expr, Graph, HalfInteger, Id, IdMap, Node};
use super::number::Number;
use super::{Function, Symbol};

use combination::{Combination, Polynomial, Powers, power_of_powers, product_of_powers};
pub use factor::weight;
use half_angle::{Double, Doubled, halved};
pub use kept::Kept;
use kept::{Beside, Turned};
use wave::{Angle, Wave, cosine, sine};

/// The expressions in normal form, with common factors taken out again; `None` where one of them has more than `limit`
/// terms on the way.
///
/// Equal polynomials give the same expression, where nothing is kept: that is for reading and comparing, because
/// differences are multiplied out that have digits to lose.
pub fn normal_form<'g>(roots: &[Expr<'g>], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some(first) = roots.first() else { return Some(Vec::new()) };
    let mut expansion = Expansion::new(first.graph(), kept, Turned::Kept, limit);
    let form = |root: &Expr<'g>| {
        let sum = expansion.of(root.id())?;
        expansion.expression(&sum)
    };
    roots.iter().map(form).collect()
}

/// The expressions in the cheapest of the forms that texts use, all of them in the same: multiple angles, or doubled
/// angles halved; with common factors taken out, or shared products named. What is kept is not multiplied out. Forms
/// that lose digits do not count; where all of them do, the expressions stay as they are. `None` where one of them has
/// more than `limit` terms on the way.
pub fn cheapest_form<'g>(roots: &[Expr<'g>], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some(first) = roots.first() else { return Some(Vec::new()) };
    let graph = first.graph();
    let forms = |&turned: &Turned| {
        let mut expansion = Expansion::new(graph, kept, turned, limit);
        let sums: Option<Vec<Sum>> = roots.iter().map(|root| expansion.of(root.id())).collect();
        Doubled::ALL.into_iter().filter_map(move |doubled| {
            let polynomials: Option<Vec<_>> =
                sums.as_ref()?.iter().map(|sum| expansion.polynomial(sum, Some(doubled))).collect();
            polynomials.map(|polynomials| factor::shared(graph, &polynomials))
        })
    };
    cheapest(roots, kept.ways().iter().flat_map(forms).collect())
}

/// Of equally cheap ones the first, among those that keep the digits of what they stand for; that itself where none
/// does, `None` where there are no forms.
fn cheapest<'g>(given: &[Expr<'g>], mut forms: Vec<Vec<Expr<'g>>>) -> Option<Vec<Expr<'g>>> {
    if forms.is_empty() {
        return None;
    }
    forms.sort_by_cached_key(|form| weight(form));
    forms.dedup();
    Some(forms.into_iter().find(|form| digits::are_kept(given, form)).unwrap_or_else(|| given.to_vec()))
}

/// `a / b` for each pair, in the cheapest of the forms that texts use; what is common to a and to a b of one term
/// cancels.
pub fn quotients<'g>(pairs: &[(Expr<'g>, Expr<'g>)], kept: &Kept, limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some((first, _)) = pairs.first() else { return Some(Vec::new()) };
    let graph = first.graph();
    let forms = |&turned: &Turned| {
        let mut expansion = Expansion::new(graph, kept, turned, limit);
        let sums: Option<Vec<[Sum; 2]>> =
            pairs.iter().map(|(a, b)| Some([expansion.of(a.id())?, expansion.of(b.id())?])).collect();
        Doubled::ALL.into_iter().filter_map(move |doubled| {
            let quotient = |[a, b]: &[Sum; 2]| {
                let [a, b] = [expansion.polynomial(a, Some(doubled))?, expansion.polynomial(b, Some(doubled))?];
                let reciprocal = b.monomial_power(-1).unwrap_or_else(|| factor::reciprocal(graph, &b));
                a.times(&reciprocal, limit)
            };
            let polynomials: Option<Vec<_>> = sums.as_ref()?.iter().map(quotient).collect();
            polynomials.map(|polynomials| factor::shared(graph, &polynomials))
        })
    };
    let given: Vec<_> = pairs.iter().map(|&(a, b)| a / b).collect();
    cheapest(&given, kept.ways().iter().flat_map(forms).collect())
}

/// A product of powers times a wave.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Term {
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
pub type Sum = Combination<Term>;

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
struct Expansion<'g, 'k> {
    graph: &'g Graph,
    kept: &'k Kept,
    turned: Turned,
    limit: usize,
    sums: IdMap<Sum>,
    /// What vanishes with a sum that is multiplied out beside others: the same with such sums as factors.
    unexpanded: IdMap<Sum>,
}

impl<'g, 'k> Expansion<'g, 'k> {
    fn new(graph: &'g Graph, kept: &'k Kept, turned: Turned, limit: usize) -> Self {
        Expansion { graph, kept, turned, limit, sums: IdMap::default(), unexpanded: IdMap::default() }
    }

    fn of(&mut self, root: Id) -> Option<Sum> {
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

    fn expression(&self, sum: &Sum) -> Option<Expr<'g>> {
        Some(factor::factored(self.graph, &[self.polynomial(sum, None)?])[0])
    }

    /// The sum with waves as indivisible expressions, its doubled angles halved if a way is given.
    fn polynomial(&self, sum: &Sum, doubled: Option<Doubled>) -> Option<Polynomial> {
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
            return Some(Combination::term(Term { powers, wave: Wave::One }, coefficient.power(n.to_halves())?));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_waves_become_multiple_angles() {
        let graph = Graph::new();
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let f = m * l * (a.cos() * b.cos() + a.sin() * b.sin());
        assert_eq!(normal_form(&[f], &Kept::default(), 100), Some(vec![m * l * (a - b).cos()]));
        let unit = a.sin().powi(2) * m + m * a.cos().powi(2);
        assert_eq!(normal_form(&[unit], &Kept::default(), 100), Some(vec![m]));
    }

    #[test]
    fn common_factors_are_taken_out() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Velocity(i)));
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let f = m * l.powi(2) * x + l.powi(2) * x;
        assert_eq!(normal_form(&[f], &Kept::default(), 100), Some(vec![x * ((m + 1) * l.powi(2))]));
        let g = x * y + x * m;
        assert_eq!(normal_form(&[g], &Kept::default(), 100), Some(vec![x * (y + m)]));
    }

    #[test]
    fn doubled_angles_are_halved_where_that_is_cheaper() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (x.sin(), x.cos());
        let f = [a * s.powi(2) + b * c.powi(2), (a - b) * s * c];
        let form = cheapest_form(&f, &Kept::default(), 100).unwrap();
        assert!(f.iter().zip(&form).all(|(f, form)| agree(*f, *form)), "{form:?}");
        // (a − b) s², + b, and (a − b) s · c; with the sine and cosine of 2 x it is no less.
        assert_eq!(weight(&form), 20 + 4, "{form:?}");
        // The cosine of 2 x alone is left alone.
        let doubled = (2 * x).cos();
        assert_eq!(cheapest_form(&[c.powi(2) - s.powi(2)], &Kept::default(), 100), Some(vec![doubled]));
    }

    /// `1 − cos 4x` has lost its digits where `2 sin² 2x` has them all, however often the angle was doubled.
    #[test]
    fn a_cosine_beside_its_one_is_halved() {
        let graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        for multiple in [1, 2, 4, 6] {
            let near_zero = a * (b + 1) * (multiple * x).sin().powi(2);
            let near_quarter = a * (multiple * x).cos().powi(2);
            // Where the sine, and where the cosine, is 1e-7.
            for (f, angle) in [(near_zero, 1e-7), (near_quarter, std::f64::consts::FRAC_PI_2 - 1e-7)] {
                let value = |symbol| match symbol {
                    Symbol::Coordinate(_) => angle / multiple as f64,
                    _ => 3.0,
                };
                let form = cheapest_form(&[f], &Kept::default(), 100).unwrap()[0];
                let values: Vec<f64> = crate::expr::evaluate(&[form, f], value);
                assert!((values[0] - values[1]).abs() < 1e-15 * values[1], "{form}: {values:?}");
            }
        }
    }

    #[test]
    fn signs_of_reversed_angles_are_kept() {
        let graph = Graph::new();
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        for (x, y) in [(a, b), (b, a)] {
            // Twice of each, so that halving is cheaper than another pair.
            let f = [(2 * x - 2 * y).sin() + (x - y).sin(), (2 * x - 2 * y).cos() * (x - y).cos()];
            let form = cheapest_form(&f, &Kept::default(), 100).unwrap();
            assert!(f.iter().zip(&form).all(|(f, form)| agree(*f, *form)), "{form:?}");
            let polynomial = |doubled: Doubled| {
                let nothing = Kept::default();
                let mut expansion = Expansion::new(&graph, &nothing, Turned::Kept, 100);
                let sum = expansion.of(f[0].id()).unwrap();
                factor::factored(&graph, &[expansion.polynomial(&sum, Some(doubled)).unwrap()])[0]
            };
            assert!(Doubled::ALL.into_iter().all(|doubled| agree(polynomial(doubled), f[0])));
        }
    }

    #[test]
    fn products_are_shared() {
        let graph = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|i| graph.symbol(Symbol::Velocity(i)));
        let s = graph.symbol(Symbol::Coordinate(0)).sin();
        let m = graph.symbol(Symbol::Parameter(0));
        // m s once, then one product each.
        let form = cheapest_form(&[m * (x * s), (m * y) * s, m * z * s], &Kept::default(), 100).unwrap();
        assert_eq!(weight(&form), 20 + 4, "{form:?}");
        // Sums and their negatives are one.
        let form = cheapest_form(&[m * x - s * y, s * y - m * x], &Kept::default(), 100).unwrap();
        assert_eq!(form[0], -form[1]);
    }

    /// Next to x = −a the square of the difference has digits that the sum of its products has lost.
    #[test]
    fn differences_of_places_are_kept() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, m] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let distance = ((x + a).powi(2) + y.powi(2)).sqrt();
        let product = (m * (x + a)) * ((x + a) * y.sin());
        // Of a product one factor may be rounded in its terms, 1e-11 of it; multiplied out 1e-5 were lost.
        let all = [((x + a).powi(2), 1e-15), (distance, 1e-15), ((x + a) * distance.powi(-3), 1e-15), (product, 1e-9)];
        for (f, tolerance) in all {
            let form = normal_form(&[f], &Kept::default(), 100).unwrap()[0];
            let value = |symbol| match symbol {
                Symbol::Coordinate(0) => 1e-6 - 0.3,
                Symbol::Coordinate(_) => 1e-6,
                _ => 0.3,
            };
            let values: Vec<f64> = crate::expr::evaluate(&[form, f], value);
            assert!((values[0] - values[1]).abs() < tolerance * values[1], "{values:?}");
        }
        // Beside numbers they are multiplied out, so that like terms meet; squares do not meet what they are made of.
        assert_eq!(normal_form(&[m * (x + a) - m * a], &Kept::default(), 100), Some(vec![m * x]));
        let kept = (x + a).powi(2) - x.powi(2) - 2 * a * x;
        assert!(
            normal_form(&[kept], &Kept::default(), 100).unwrap()[0] != a.powi(2)
                && agree(normal_form(&[kept], &Kept::default(), 100).unwrap()[0], kept)
        );
        // With sines and cosines there may be something to cancel.
        let turned = (x * y.cos() + a).powi(2) + (x * y.sin()).powi(2);
        assert!(agree(normal_form(&[turned], &Kept::default(), 100).unwrap()[0], turned));
        assert_eq!(
            normal_form(&[turned - 2 * a * x * y.cos()], &Kept::default(), 100),
            Some(vec![a.powi(2) + x.powi(2)])
        );
    }

    /// A force beside others, and the square of a distance in axes that turn; in a form of a form, too.
    #[test]
    fn what_energies_were_written_with_is_kept() {
        let graph = Graph::new();
        let [x, y, nu] = [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [k, rest, b] = [0, 1, 2].map(|i| graph.symbol(Symbol::Parameter(i)));
        let [[u, v], [p, q]] =
            [[x, y], [rest, b]].map(|[x, y]| [x * nu.cos() - y * nu.sin(), x * nu.sin() + y * nu.cos()]);
        let energy = k * (x - rest).powi(2) + k * ((u - p).powi(2) + (v - q).powi(2));
        let force = k * (x - rest) + k * y * (u - p) * (y - b);
        let kept = Kept::of(&[energy], &[]);
        let once = cheapest_form(&[energy, force], &kept, 100).unwrap();
        let twice = cheapest_form(&[once[0] * k, once[1] * nu.cos() * (x - rest)], &kept, 100).unwrap();
        let (far, near) = (0.3, 0.3 + 1e-9);
        let value = |symbol| match symbol {
            Symbol::Coordinate(0) => near,
            Symbol::Coordinate(1) => 0.7 + 1e-9,
            Symbol::Coordinate(_) => 0.4,
            Symbol::Parameter(i) => [1e9, far, 0.7][i as usize],
            other => unreachable!("{other} is not used here"),
        };
        let expected = [energy, force, energy * k, force * nu.cos() * (x - rest)];
        let found = [once, twice].concat();
        let values: Vec<f64> = crate::expr::evaluate(&[&expected[..], &found].concat(), value);
        // The distance is as near as the places, which are rounded at 1e-16.
        assert!((0..4).all(|i| (values[i + 4] - values[i]).abs() < 1e-6 * values[i].abs()), "{values:?}");
        // Multiplied out, they are noise.
        let expanded = normal_form(&[energy], &Kept::default(), 100).unwrap()[0];
        let noise: Vec<f64> = crate::expr::evaluate(&[expanded], value);
        assert!((noise[0] - values[0]).abs() > 0.5 * values[0], "{noise:?} {values:?}");
    }

    /// One of two sums in which sines and cosines cancel may be multiplied out, not both.
    #[test]
    fn turned_sums_are_multiplied_out_where_that_is_cheaper() {
        let graph = Graph::new();
        let [theta, phi] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (theta.sin(), theta.cos());
        let [u, v] = [a * c - b, a * s - b];
        let kept = Kept::of(&[(u.powi(2) + v.powi(2)) * phi], &[]);
        // The slope of the distance: a b (s − c).
        let slope = cheapest_form(&[v * (a * c) - u * (a * s)], &kept, 100).unwrap();
        assert!(weight(&slope) <= 20 + 3, "{slope:?}");
        let product = (u * s) * (v * c) * phi;
        let form = cheapest_form(&[product], &kept, 100).unwrap()[0];
        // cos θ = sin θ = b/a, nearly.
        let value = |symbol| match symbol {
            Symbol::Coordinate(0) => std::f64::consts::FRAC_PI_4 + 1e-9,
            Symbol::Coordinate(_) => 1.0,
            Symbol::Parameter(0) => 1.0,
            _ => std::f64::consts::FRAC_1_SQRT_2,
        };
        let values: Vec<f64> = crate::expr::evaluate(&[form, product], value);
        assert!((values[0] - values[1]).abs() < 1e-6 * values[1].abs(), "{values:?}");
    }

    #[test]
    fn factors_cancel_in_quotients() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let [a, b] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let (s, c) = (x.sin(), x.cos());
        let d = (a + b) * s.powi(2);
        let pairs = [(a * s * c * y + b * (s * y) * c, d), (y, s + c), (y, a * b)];
        let form = quotients(&pairs, &Kept::default(), 100).unwrap();
        // y c / s
        assert_eq!(weight(&form[..1]), 20 + 5, "{form:?}");
        assert!(form.iter().zip(pairs).all(|(form, (a, b))| agree(*form, a / b)), "{form:?}");
    }

    /// Equal at a point with no special relation.
    fn agree(a: Expr<'_>, b: Expr<'_>) -> bool {
        let value = |symbol| match symbol {
            Symbol::Coordinate(i) => 0.7 + 0.31 * f64::from(i),
            Symbol::Parameter(i) => 1.3 + 0.57 * f64::from(i),
            other => unreachable!("{other} is not used here"),
        };
        let values: Vec<f64> = crate::expr::evaluate(&[a, b], value);
        (values[0] - values[1]).abs() < 1e-13 * values[1].abs()
    }

    #[test]
    fn a_long_product_of_sums_is_given_up() {
        let graph = Graph::new();
        let factor = |i: u32| (0..3).fold(graph.integer(1), |sum, k| sum + graph.symbol(Symbol::Velocity(3 * i + k)));
        let product = (0..9).fold(graph.integer(1), |product, i| product * factor(i));
        assert_eq!(normal_form(&[product], &Kept::default(), 1000), None);
    }
}
