//! Polynomials as expressions: parameters gathered into coefficients, common factors taken out, products shared.
//!
//! Several ways are tried on all polynomials together, with common factors taken out and without, and the cheapest is
//! kept; in all of them, products that occur more than once are computed once. Source of the idea: Hosangadi, Fallah,
//! Kastner, *Optimizing polynomial expressions by algebraic factorization and common subexpression elimination*, IEEE
//! Transactions on Computer-Aided Design 2006; here every choice is the most frequent one, and none is taken back.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Expr, Function, Graph, HalfInteger, Id, Node, Number};

use super::combination::{Combination, Polynomial, Powers, power_of_powers};

/// Longer lists of polynomials are written with common factors taken out, without looking for shared products.
const MOST_SHARED: usize = 150;

/// The polynomials as expressions, with common factors taken out, the most common first.
pub(crate) fn factored<'g>(graph: &'g Graph, polynomials: &[Polynomial]) -> Vec<Expr<'g>> {
    let mut sheet = Sheet::empty(graph, Brackets::First);
    polynomials.iter().for_each(|polynomial| sheet.write(products(graph, polynomial)));
    sheet.expressions()
}

/// The polynomials as expressions that share what they have in common.
pub(crate) fn shared<'g>(graph: &'g Graph, polynomials: &[Polynomial]) -> Vec<Expr<'g>> {
    if polynomials.iter().map(|p| p.0.len()).sum::<usize>() > MOST_SHARED {
        return factored(graph, polynomials);
    }
    let products: Vec<_> = polynomials.iter().map(|polynomial| products(graph, polynomial)).collect();
    let ways = [Brackets::First, Brackets::Last, Brackets::None].map(|brackets| {
        let mut sheet = Sheet::empty(graph, brackets);
        products.iter().cloned().for_each(|products| sheet.write(products));
        sheet.share();
        sheet.expressions()
    });
    // Of equally cheap ones the first.
    ways.into_iter().min_by_key(|way| weight(way)).unwrap_or_default()
}

/// What the expressions cost together, in units of an addition, as `optimise` counts it; what depends on parameters
/// alone is free, because it is computed once.
pub(crate) fn weight(roots: &[Expr<'_>]) -> usize {
    let Some(first) = roots.first() else { return 0 };
    let graph = first.graph();
    let mut angles: BTreeSet<Id> = BTreeSet::new();
    let mut weight = 0;
    for id in graph.reachable(roots.iter().map(|root| root.id())) {
        weight += match graph.node(id) {
            _ if graph.is_parametric(id) => 0,
            Node::Constant(_) | Node::Symbol(_) | Node::Rate(_) | Node::Neg(_) | Node::And(..) | Node::Not(_) => 0,
            Node::Add(..) | Node::Sub(..) | Node::Mul(..) => 1,
            Node::Power(_, n) => weight_of_power(n),
            Node::Call(Function::Sin | Function::Cos, angle) => {
                if angles.insert(angle) {
                    20
                } else {
                    0
                }
            }
            Node::Spline(..) => 20,
            Node::Call(..) | Node::Call2(..) | Node::Less(..) | Node::LessEqual(..) | Node::Select(..) => 20,
        };
    }
    weight
}

/// A reciprocal costs 3, because the product with it is counted apart, and is the division itself.
fn weight_of_power(n: HalfInteger) -> usize {
    let halves = n.to_halves().unsigned_abs();
    let whole = halves / 2;
    let products = if whole > 1 { whole.ilog2() + whole.count_ones() - 1 } else { 0 };
    let root = if halves % 2 == 1 { 6 + u32::from(whole > 0) } else { 0 };
    let division = if n.to_halves() < 0 { 3 } else { 0 };
    (products + root + division) as usize
}

/// Which common factors are taken out of sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Brackets {
    /// Of the most common ones the first.
    First,
    /// Of the most common ones the last.
    Last,
    /// None.
    None,
}

/// A factor of a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Factor {
    /// An indivisible expression.
    Atom(Id),
    /// A sine.
    Sine(Id),
    /// A cosine.
    Cosine(Id),
    /// What depends on parameters alone, or a number.
    Coefficient(Id),
    /// One of the sheet's sums.
    Sum(usize),
    /// One of the sheet's shared products.
    Pair(usize),
}

/// Its factors in order; one that occurs twice is squared.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Product {
    negative: bool,
    factors: Vec<Factor>,
}

impl Product {
    fn without(&self, factor: Factor) -> Option<Product> {
        let at = self.factors.iter().position(|&other| other == factor)?;
        let mut rest = self.clone();
        rest.factors.remove(at);
        Some(rest)
    }

    fn without_pair(&self, [a, b]: [Factor; 2]) -> Option<Product> {
        self.without(a).and_then(|rest| rest.without(b))
    }

    /// All pairs of its factors, each once.
    fn pairs(&self) -> Vec<[Factor; 2]> {
        let behind = |(i, &a): (usize, &Factor)| self.factors[i + 1..].iter().map(move |&b| [a, b]);
        let mut pairs: Vec<[Factor; 2]> = self.factors.iter().enumerate().flat_map(behind).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    fn with(mut self, factor: Factor) -> Product {
        let at = self.factors.partition_point(|&other| other < factor);
        self.factors.insert(at, factor);
        self
    }
}

/// Sums of products that are to be written together.
struct Sheet<'g> {
    graph: &'g Graph,
    brackets: Brackets,
    /// The first product of each is positive; they refer to earlier ones only.
    sums: Vec<Vec<Product>>,
    known: BTreeMap<Vec<Product>, usize>,
    /// The results: a sign and a sum.
    roots: Vec<(bool, usize)>,
    pairs: Vec<[Factor; 2]>,
}

impl<'g> Sheet<'g> {
    fn empty(graph: &'g Graph, brackets: Brackets) -> Self {
        let (sums, roots, pairs) = (Vec::new(), Vec::new(), Vec::new());
        Sheet { graph, brackets, sums, known: BTreeMap::new(), roots, pairs }
    }

    fn write(&mut self, products: Vec<Product>) {
        let products = self.factored(products);
        let root = self.sum(products);
        self.roots.push(root);
    }

    /// The number of a sum, and whether it is the negative of that.
    fn sum(&mut self, mut products: Vec<Product>) -> (bool, usize) {
        products.sort_by(|a, b| (&a.factors, a.negative).cmp(&(&b.factors, b.negative)));
        let negative = products.first().is_some_and(|product| product.negative);
        products.iter_mut().for_each(|product| product.negative ^= negative);
        let next = self.sums.len();
        let number = *self.known.entry(products.clone()).or_insert(next);
        if number == next {
            self.sums.push(products);
        }
        (negative, number)
    }

    /// `f (a + b) + c` where `f` is the factor that most products share.
    ///
    /// Each level takes one factor out, so the depth is bounded by the number of factors of a product.
    fn factored(&mut self, mut products: Vec<Product>) -> Vec<Product> {
        let mut result = Vec::new();
        while let Some(common) = self.most_common_factor(&products) {
            let (inside, outside): (Vec<_>, Vec<_>) =
                products.into_iter().partition(|product| product.factors.contains(&common));
            let inside = inside.iter().filter_map(|product| product.without(common)).collect();
            let mut inside = self.factored(inside);
            result.push(match (inside.pop(), inside.is_empty()) {
                (Some(only), true) => only.with(common),
                (last, _) => {
                    inside.extend(last);
                    let (negative, sum) = self.sum(inside);
                    Product { negative, factors: vec![common, Factor::Sum(sum)] }
                }
            });
            products = outside;
        }
        result.extend(products);
        result
    }

    /// The factor that most products share, if two do.
    fn most_common_factor(&self, products: &[Product]) -> Option<Factor> {
        let mut counts: BTreeMap<Factor, usize> = BTreeMap::new();
        for product in products {
            // Equal factors are neighbours.
            let distinct = product.factors.chunk_by(|a, b| a == b).map(|equal| equal[0]);
            distinct.for_each(|factor| *counts.entry(factor).or_insert(0) += 1);
        }
        match self.brackets {
            Brackets::First => first_most_frequent(counts.into_iter()),
            Brackets::Last => first_most_frequent(counts.into_iter().rev()),
            Brackets::None => None,
        }
    }

    /// Gives a name to the pair of factors that most products have, as long as there is one that two have.
    fn share(&mut self) {
        let mut counts: BTreeMap<[Factor; 2], usize> = BTreeMap::new();
        let pairs = self.sums.iter().flatten().flat_map(Product::pairs);
        pairs.for_each(|pair| *counts.entry(pair).or_insert(0) += 1);
        while let Some(pair) = first_most_frequent(counts.iter().map(|(pair, count)| (*pair, *count))) {
            let name = Factor::Pair(self.pairs.len());
            self.pairs.push(pair);
            for product in self.sums.iter_mut().flatten().filter(|product| product.without_pair(pair).is_some()) {
                product.pairs().into_iter().for_each(|pair| *counts.entry(pair).or_insert(0) -= 1);
                while let Some(rest) = product.without_pair(pair) {
                    *product = rest.with(name);
                }
                product.pairs().into_iter().for_each(|pair| *counts.entry(pair).or_insert(0) += 1);
            }
            counts.retain(|_, count| *count > 0);
        }
    }

    fn expressions(&self) -> Vec<Expr<'g>> {
        let mut written: Vec<Expr<'g>> = Vec::new();
        for products in &self.sums {
            let sum = products.iter().fold(self.graph.integer(0), |sum, product| {
                let factors = product.factors.iter().map(|&factor| self.expression(factor, &written));
                let value = factors.fold(self.graph.integer(1), |value, factor| value * factor);
                if product.negative { sum - value } else { sum + value }
            });
            written.push(sum);
        }
        self.roots.iter().map(|&(negative, sum)| if negative { -written[sum] } else { written[sum] }).collect()
    }

    /// Pairs are nested less deeply than a product has factors.
    fn expression(&self, factor: Factor, sums: &[Expr<'g>]) -> Expr<'g> {
        match factor {
            Factor::Atom(id) | Factor::Sine(id) | Factor::Cosine(id) | Factor::Coefficient(id) => self.graph.expr(id),
            Factor::Sum(number) => sums[number],
            Factor::Pair(number) => {
                let [a, b] = self.pairs[number].map(|factor| self.expression(factor, sums));
                a * b
            }
        }
    }
}

/// `1/a`; where all terms of a depend on the state in the same way, that dependence can be cancelled.
pub(crate) fn reciprocal(graph: &Graph, a: &Polynomial) -> Polynomial {
    let gathered = gathered(graph, a);
    let of_state = match gathered.first_key_value() {
        Some((state, parts)) if gathered.len() == 1 => {
            power_of_powers(state, -1).map(|powers| (powers, coefficient(graph, parts)))
        }
        _ => None,
    };
    let (mut powers, rest) = of_state.unwrap_or_else(|| (Powers::new(), shared(graph, std::slice::from_ref(a))[0]));
    let sign = match rest.node() {
        Node::Neg(_) => -Number::ONE,
        _ => Number::ONE,
    };
    let magnitude = if sign.is_negative() { -rest } else { rest };
    if !magnitude.is_one() {
        powers.insert(magnitude.id(), -2);
    }
    Combination::term(powers, sign)
}

/// The coefficients, of parameters and numbers, of all ways to depend on the state.
fn gathered(graph: &Graph, polynomial: &Polynomial) -> BTreeMap<Powers, Vec<(Powers, Number)>> {
    let mut gathered: BTreeMap<Powers, Vec<(Powers, Number)>> = BTreeMap::new();
    for (powers, &number) in &polynomial.0 {
        let (parameters, state) = powers.iter().partition(|(id, _)| graph.is_parametric(**id));
        gathered.entry(state).or_default().push((parameters, number));
    }
    gathered
}

/// The terms of a polynomial, those with the same dependence on the state gathered.
fn products(graph: &Graph, polynomial: &Polynomial) -> Vec<Product> {
    gathered(graph, polynomial).into_iter().map(|(state, parts)| product(graph, &state, &parts)).collect()
}

fn product(graph: &Graph, state: &Powers, parts: &[(Powers, Number)]) -> Product {
    // The number is a factor of its own, so that `2 m l` and `m l` have `m l` in common.
    let number = parts[0].1;
    let quotients: Option<Vec<_>> =
        parts.iter().map(|(powers, other)| Some((powers.clone(), other.in_units_of(number)?))).collect();
    let (number, rest) = match quotients {
        Some(quotients) => (number, quotients),
        None => (Number::ONE, parts.to_vec()),
    };
    let (number, negative) = if number.is_negative() { (-number, true) } else { (number, false) };
    let coefficient = coefficient(graph, &rest);
    let coefficients = [graph.constant(number), coefficient].into_iter().filter(|factor| !factor.is_one());
    let mut factors = factors(graph, state);
    factors.extend(coefficients.map(|factor| Factor::Coefficient(factor.id())));
    factors.sort();
    Product { negative, factors }
}

/// Whole positive powers are repeated factors; roots and reciprocals are factors of their own.
fn factors(graph: &Graph, powers: &Powers) -> Vec<Factor> {
    let mut factors = Vec::new();
    for (&id, &halves) in powers {
        let atom = |id: Id| match graph.node(id) {
            Node::Call(Function::Sin, _) => Factor::Sine(id),
            Node::Call(Function::Cos, _) => Factor::Cosine(id),
            _ => Factor::Atom(id),
        };
        let power = |halves: i32| atom(graph.expr(id).power(HalfInteger::halves(halves)).id());
        let whole = halves.unsigned_abs() as usize / 2;
        factors.extend(std::iter::repeat_n(power(2 * halves.signum()), whole));
        if halves % 2 != 0 {
            factors.push(power(halves % 2));
        }
    }
    factors.sort();
    factors
}

/// A polynomial of parameters and numbers, common factors taken out.
fn coefficient<'g>(graph: &'g Graph, parts: &[(Powers, Number)]) -> Expr<'g> {
    let products = parts.iter().map(|(powers, number)| {
        let mut factors = factors(graph, powers);
        let magnitude = if number.is_negative() { -*number } else { *number };
        if !magnitude.is_one() {
            factors.push(Factor::Coefficient(graph.constant(magnitude).id()));
        }
        Product { negative: number.is_negative(), factors }
    });
    let mut sheet = Sheet::empty(graph, Brackets::First);
    sheet.write(products.collect());
    sheet.expressions()[0]
}

/// The first of the most frequent ones that occur more than once.
fn first_most_frequent<K>(counts: impl DoubleEndedIterator<Item = (K, usize)>) -> Option<K> {
    let shared = counts.filter(|(_, count)| *count > 1);
    shared.rev().max_by_key(|(_, count)| *count).map(|(key, _)| key)
}
