//! Multiple-angle normal form: sums of monomials times a sine or cosine of a sum of angles, as in a textbook.
//!
//! Products of sines and cosines become sums, `cos a cos b = ½ (cos(a − b) + cos(a + b))`, so that what cancels cancels and a
//! double pendulum shows `m2 l1 l2 cos(θ1 − θ2)`. The form can be exponentially longer than the graph it stands for, so it
//! is given up when it grows past a bound; then the graph's own form is the better one.

use std::collections::BTreeMap;

use super::Function;
use super::graph::{Expr, Graph, HalfInteger, Id, IdMap, Node, Symbol};
use super::number::Number;

/// The expressions in normal form, with common factors taken out again; `None` where one of them has more than `limit`
/// terms on the way.
pub fn normal_form<'g>(roots: &[Expr<'g>], limit: usize) -> Option<Vec<Expr<'g>>> {
    let Some(first) = roots.first() else { return Some(Vec::new()) };
    let mut expansion = Expansion { graph: first.graph(), limit, sums: IdMap::default() };
    roots.iter().map(|root| expansion.of(root.id()).map(|sum| sum.factored(root.graph()))).collect()
}

/// Powers beyond so many halves are left to the graph.
const HIGHEST: i32 = 200;

/// An angle: integer multiples of indivisible expressions, the first of them positive.
type Angle = BTreeMap<Id, i32>;

/// What a monomial is multiplied with.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Wave {
    One,
    Cos(Angle),
    Sin(Angle),
}

/// Powers, in halves, of indivisible expressions, and a coefficient.
type Monomial = (BTreeMap<Id, i32>, Number);

/// Powers, in halves, of indivisible expressions, times a wave.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Term {
    powers: BTreeMap<Id, i32>,
    wave: Wave,
}

impl Term {
    const fn one() -> Self {
        Term { powers: BTreeMap::new(), wave: Wave::One }
    }
}

/// Terms with their coefficients, none of them zero.
#[derive(Clone, Debug, Default)]
struct Sum(BTreeMap<Term, Number>);

impl Sum {
    fn constant(value: Number) -> Self {
        let mut sum = Sum::default();
        sum.add_term(Term::one(), value);
        sum
    }

    fn atom(id: Id, halves: i32) -> Self {
        Sum([(Term { powers: [(id, halves)].into(), wave: Wave::One }, Number::ONE)].into())
    }

    fn add_term(&mut self, term: Term, coefficient: Number) {
        let sum = self.0.get(&term).copied().unwrap_or(Number::ZERO) + coefficient;
        if sum.is_zero() {
            self.0.remove(&term);
        } else {
            self.0.insert(term, sum);
        }
    }

    fn plus(&self, other: &Sum, sign: Number) -> Self {
        let mut sum = self.clone();
        other.0.iter().for_each(|(term, &coefficient)| sum.add_term(term.clone(), coefficient * sign));
        sum
    }

    fn times(&self, other: &Sum, limit: usize) -> Option<Self> {
        let mut product = Sum::default();
        for (a, &x) in &self.0 {
            for (b, &y) in &other.0 {
                let powers = product_of_powers(&a.powers, &b.powers);
                if powers.values().any(|halves| halves.abs() > HIGHEST) {
                    return None;
                }
                for (factor, wave) in product_of_waves(&a.wave, &b.wave) {
                    product.add_term(Term { powers: powers.clone(), wave }, x * y * factor);
                }
            }
            if product.0.len() > limit {
                return None;
            }
        }
        Some(product)
    }

    /// The one term without a wave that this is.
    fn as_monomial(&self) -> Option<(&BTreeMap<Id, i32>, Number)> {
        match self.0.first_key_value() {
            Some((Term { powers, wave: Wave::One }, &coefficient)) if self.0.len() == 1 => Some((powers, coefficient)),
            _ => None,
        }
    }
}

fn product_of_powers(a: &BTreeMap<Id, i32>, b: &BTreeMap<Id, i32>) -> BTreeMap<Id, i32> {
    let mut product = a.clone();
    for (&id, &halves) in b {
        let power = product.entry(id).or_insert(0);
        *power += halves;
        if *power == 0 {
            product.remove(&id);
        }
    }
    product
}

fn product_of_waves(a: &Wave, b: &Wave) -> Vec<(Number, Wave)> {
    let half = Number::rational(1, 2).unwrap_or(Number::ONE);
    let (plus, minus) = (Number::ONE, -Number::ONE);
    let [(x, cos_x), (y, cos_y)] = match [a, b].map(|wave| match wave {
        Wave::One => None,
        Wave::Cos(angle) => Some((angle, true)),
        Wave::Sin(angle) => Some((angle, false)),
    }) {
        [Some(x), Some(y)] => [x, y],
        [None, _] => return vec![(plus, b.clone())],
        [_, None] => return vec![(plus, a.clone())],
    };
    let (sum, difference) = (combine(x, y, 1), combine(x, y, -1));
    let signed = match (cos_x, cos_y) {
        (true, true) => [(plus, cosine(difference)), (plus, cosine(sum))],
        (false, false) => [(plus, cosine(difference)), (minus, cosine(sum))],
        (false, true) => [(plus, sine(sum)), (plus, sine(difference))],
        (true, false) => [(plus, sine(sum)), (minus, sine(difference))],
    };
    let scaled = signed.into_iter().map(|(sign, (factor, wave))| (half * sign * factor, wave));
    scaled.filter(|(factor, _)| !factor.is_zero()).collect()
}

fn combine(a: &Angle, b: &Angle, sign: i32) -> Angle {
    let mut sum = a.clone();
    for (&id, &n) in b {
        let multiple = sum.entry(id).or_insert(0);
        *multiple += sign * n;
        if *multiple == 0 {
            sum.remove(&id);
        }
    }
    sum
}

/// `cos` of an angle: even, and 1 at 0.
fn cosine(angle: Angle) -> (Number, Wave) {
    match leading(&angle) {
        0 => (Number::ONE, Wave::One),
        n if n < 0 => (Number::ONE, Wave::Cos(negative(angle))),
        _ => (Number::ONE, Wave::Cos(angle)),
    }
}

/// `sin` of an angle: odd, and 0 at 0.
fn sine(angle: Angle) -> (Number, Wave) {
    match leading(&angle) {
        0 => (Number::ZERO, Wave::One),
        n if n < 0 => (-Number::ONE, Wave::Sin(negative(angle))),
        _ => (Number::ONE, Wave::Sin(angle)),
    }
}

fn leading(angle: &Angle) -> i32 {
    angle.first_key_value().map_or(0, |(_, &n)| n)
}

fn negative(angle: Angle) -> Angle {
    angle.into_iter().map(|(id, n)| (id, -n)).collect()
}

/// Nodes expanded so far.
struct Expansion<'g> {
    graph: &'g Graph,
    limit: usize,
    sums: IdMap<Sum>,
}

impl<'g> Expansion<'g> {
    fn of(&mut self, root: Id) -> Option<Sum> {
        for id in self.graph.reachable([root]) {
            if !self.sums.contains_key(&id) {
                let sum = self.node(id)?;
                if sum.0.len() > self.limit {
                    return None;
                }
                self.sums.insert(id, sum);
            }
        }
        Some(self.sums[&root].clone())
    }

    fn node(&self, id: Id) -> Option<Sum> {
        let minus = -Number::ONE;
        Some(match self.graph.node(id) {
            Node::Constant(value) => Sum::constant(value),
            Node::Symbol(_) => Sum::atom(id, 2),
            Node::Rate(_) => unreachable!("time derivatives were carried out by derive"),
            Node::Neg(a) => Sum::default().plus(&self.sums[&a], minus),
            Node::Add(a, b) => self.sums[&a].plus(&self.sums[&b], Number::ONE),
            Node::Sub(a, b) => self.sums[&a].plus(&self.sums[&b], minus),
            Node::Mul(a, b) => self.sums[&a].times(&self.sums[&b], self.limit)?,
            Node::Power(a, n) => self.power(&self.sums[&a], n)?,
            Node::Call(function @ (Function::Sin | Function::Cos), a) => match angle_of(&self.sums[&a], self.graph) {
                Some(angle) => {
                    let (factor, wave) = if function == Function::Sin { sine(angle) } else { cosine(angle) };
                    let mut sum = Sum::default();
                    sum.add_term(Term { powers: BTreeMap::new(), wave }, factor);
                    sum
                }
                None => Sum::atom(self.inner(a).call(function).id(), 2),
            },
            Node::Call(function, a) => self.opaque(self.inner(a).call(function)),
            Node::Call2(function, a, b) => self.opaque(self.inner(a).call2(function, self.inner(b))),
            Node::Less(..) | Node::And(..) | Node::Not(_) | Node::Select(..) => self.opaque(self.graph.expr(id)),
        })
    }

    /// An indivisible expression, unless the local rules made a constant of it.
    fn opaque(&self, expr: Expr<'g>) -> Sum {
        match expr.as_constant() {
            Some(value) => Sum::constant(value),
            None => Sum::atom(expr.id(), 2),
        }
    }

    /// An operand in normal form, as an expression.
    fn inner(&self, id: Id) -> Expr<'g> {
        self.sums[&id].factored(self.graph)
    }

    fn power(&self, base: &Sum, n: HalfInteger) -> Option<Sum> {
        if let Some(k @ 0..=4) = n.to_integer() {
            return (0..k).try_fold(Sum::constant(Number::ONE), |product, _| product.times(base, self.limit));
        }
        if let (Some((powers, coefficient)), Some(k)) = (base.as_monomial(), n.to_integer()) {
            let powers: BTreeMap<Id, i32> =
                powers.iter().map(|(&id, &halves)| Some((id, halves.checked_mul(k)?))).collect::<Option<_>>()?;
            if powers.values().any(|halves| halves.abs() > HIGHEST) {
                return None;
            }
            let coefficient = coefficient.power(n.to_halves())?;
            return Some(Sum([(Term { powers, wave: Wave::One }, coefficient)].into()));
        }
        let base = base.factored(self.graph);
        Some(match base.as_constant() {
            Some(_) => self.opaque(base.power(n)),
            None => Sum::atom(base.id(), n.to_halves()),
        })
    }
}

/// The argument of a sine as integer multiples of indivisible expressions.
fn angle_of(sum: &Sum, graph: &Graph) -> Option<Angle> {
    let multiple = |(term, coefficient): (&Term, &Number)| match (*coefficient, &term.wave) {
        (Number::Exact { numerator, denominator: 1, pi: 0 }, Wave::One) if !term.powers.is_empty() => {
            let monomial = monomial(graph, &term.powers);
            Some((monomial.id(), i32::try_from(numerator).ok()?))
        }
        _ => None,
    };
    sum.0.iter().map(multiple).collect()
}

fn monomial<'g>(graph: &'g Graph, powers: &BTreeMap<Id, i32>) -> Expr<'g> {
    powers
        .iter()
        .fold(graph.integer(1), |product, (&id, &halves)| product * graph.expr(id).power(HalfInteger::halves(halves)))
}

fn wave<'g>(graph: &'g Graph, wave: &Wave) -> Expr<'g> {
    let argument =
        |angle: &Angle| angle.iter().fold(graph.integer(0), |sum, (&id, &n)| sum + i64::from(n) * graph.expr(id));
    match wave {
        Wave::One => graph.integer(1),
        Wave::Cos(angle) => argument(angle).cos(),
        Wave::Sin(angle) => argument(angle).sin(),
    }
}

/// A factor that terms may have in common.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Factor {
    /// So many halves of the power of an indivisible expression.
    Power(Id, i32),
    Wave(Wave),
    /// The part that depends on parameters alone.
    Coefficient(Id),
}

/// A product still to be written.
#[derive(Clone, Debug)]
struct Product {
    negative: bool,
    factors: Vec<Factor>,
}

impl Sum {
    /// The sum as an expression: parameters gathered into coefficients, then common factors taken out, the most common
    /// first.
    fn factored<'g>(&self, graph: &'g Graph) -> Expr<'g> {
        let mut coefficients: BTreeMap<Term, Vec<Monomial>> = BTreeMap::new();
        for (term, &number) in &self.0 {
            let (parameters, state) = term.powers.iter().partition(|(id, _)| is_parametric(graph, **id));
            let term = Term { powers: state, wave: term.wave.clone() };
            coefficients.entry(term).or_default().push((parameters, number));
        }
        let products = coefficients.into_iter().map(|(term, parts)| product(graph, term, &parts)).collect();
        sum_of_products(graph, products)
    }
}

fn product(graph: &Graph, term: Term, parts: &[Monomial]) -> Product {
    let coefficient = coefficient(graph, parts);
    let (negative, coefficient) = match coefficient.node() {
        Node::Neg(a) => (true, graph.expr(a)),
        _ => (false, coefficient),
    };
    let mut factors: Vec<Factor> = term.powers.into_iter().map(|(id, halves)| Factor::Power(id, halves)).collect();
    if term.wave != Wave::One {
        factors.push(Factor::Wave(term.wave));
    }
    if !coefficient.is_one() {
        factors.push(Factor::Coefficient(coefficient.id()));
    }
    Product { negative, factors }
}

/// A polynomial of parameters and numbers, common factors taken out.
fn coefficient<'g>(graph: &'g Graph, parts: &[Monomial]) -> Expr<'g> {
    let products = parts.iter().map(|(powers, number)| {
        let mut factors: Vec<Factor> = powers.iter().map(|(&id, &halves)| Factor::Power(id, halves)).collect();
        let magnitude = if number.is_negative() { -*number } else { *number };
        if !magnitude.is_one() {
            factors.push(Factor::Coefficient(graph.constant(magnitude).id()));
        }
        Product { negative: number.is_negative(), factors }
    });
    sum_of_products(graph, products.collect())
}

/// `f (a + b) + c` where `f` is the factor that most terms share.
fn sum_of_products(graph: &Graph, mut products: Vec<Product>) -> Expr<'_> {
    // Each level takes one factor out, so the depth is bounded by the number of factors of a term.
    let Some(common) = most_common_factor(&products) else {
        return products.iter().fold(graph.integer(0), |sum, p| {
            let value = p.factors.iter().fold(graph.integer(1), |value, f| value * factor(graph, f));
            if p.negative { sum - value } else { sum + value }
        });
    };
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for product in products.drain(..) {
        match divided(&product, &common) {
            Some(rest) => inside.push(rest),
            None => outside.push(product),
        }
    }
    let bracket = factor(graph, &common) * sum_of_products(graph, inside);
    if outside.is_empty() { bracket } else { bracket + sum_of_products(graph, outside) }
}

fn factor<'g>(graph: &'g Graph, factor: &Factor) -> Expr<'g> {
    match factor {
        Factor::Power(id, halves) => graph.expr(*id).power(HalfInteger::halves(*halves)),
        Factor::Wave(w) => wave(graph, w),
        Factor::Coefficient(id) => graph.expr(*id),
    }
}

/// The factor that at least two products share, the most frequent; of a positive power, one power of it.
fn most_common_factor(products: &[Product]) -> Option<Factor> {
    let mut counts: BTreeMap<Factor, usize> = BTreeMap::new();
    for product in products {
        for factor in &product.factors {
            let unit = match factor {
                Factor::Power(id, halves) if *halves > 2 && halves % 2 == 0 => Factor::Power(*id, 2),
                other => other.clone(),
            };
            *counts.entry(unit).or_insert(0) += 1;
        }
    }
    let shared = counts.into_iter().filter(|(_, count)| *count > 1);
    // The first of the most frequent ones, in the order of factors.
    let (factor, _) = shared.rev().max_by_key(|(_, count)| *count)?;
    let Factor::Power(id, 2) = factor else { return Some(factor) };
    // The highest power that all of them have.
    let powers = products.iter().filter_map(|p| whole_power(p, id));
    powers.min().map(|halves| Factor::Power(id, halves))
}

/// The positive whole power of an indivisible expression in a product, in halves.
fn whole_power(product: &Product, of: Id) -> Option<i32> {
    product.factors.iter().find_map(|factor| match factor {
        Factor::Power(id, halves) if *id == of && *halves >= 2 && halves % 2 == 0 => Some(*halves),
        _ => None,
    })
}

fn divided(product: &Product, by: &Factor) -> Option<Product> {
    let mut rest = product.clone();
    let at = rest.factors.iter().position(|factor| match (factor, by) {
        (Factor::Power(id, halves), Factor::Power(other, least)) if least % 2 == 0 && *least > 0 => {
            id == other && halves >= least && halves % 2 == 0
        }
        (factor, by) => factor == by,
    })?;
    match (&mut rest.factors[at], by) {
        (Factor::Power(_, halves), Factor::Power(_, least)) if *halves > *least && *least > 0 => *halves -= least,
        _ => {
            rest.factors.remove(at);
        }
    }
    Some(rest)
}

/// Whether an indivisible expression depends on parameters alone.
fn is_parametric(graph: &Graph, id: Id) -> bool {
    graph.reachable([id]).into_iter().all(|id| match graph.node(id) {
        Node::Symbol(symbol) => matches!(symbol, Symbol::Parameter(_)),
        _ => true,
    })
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
        assert_eq!(normal_form(&[f], 100), Some(vec![m * l * (a - b).cos()]));
        let unit = a.sin().powi(2) * m + m * a.cos().powi(2);
        assert_eq!(normal_form(&[unit], 100), Some(vec![m]));
    }

    #[test]
    fn common_factors_are_taken_out() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Velocity(i)));
        let [m, l] = [0, 1].map(|i| graph.symbol(Symbol::Parameter(i)));
        let f = m * l.powi(2) * x + l.powi(2) * x;
        assert_eq!(normal_form(&[f], 100), Some(vec![x * ((m + 1) * l.powi(2))]));
        let g = x * y + x * m;
        assert_eq!(normal_form(&[g], 100), Some(vec![x * (y + m)]));
    }

    #[test]
    fn a_long_product_of_sums_is_given_up() {
        let graph = Graph::new();
        let factor = |i: u32| (0..3).fold(graph.integer(1), |sum, k| sum + graph.symbol(Symbol::Coordinate(3 * i + k)));
        let product = (0..9).fold(graph.integer(1), |product, i| product * factor(i));
        assert_eq!(normal_form(&[product], 1000), None);
    }
}
