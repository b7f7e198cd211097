//! Expressions as polynomials, in their shortest form.

use std::collections::BTreeMap;

use crate::derive::Equations;
use crate::derive::textbook::MOST_TERMS;
use crate::expr::normal::combination::{Polynomial, Powers};
use crate::expr::normal::half_angle::{Double, Doubled, halved};
use crate::expr::{Binary, Expr, Function, Graph, HalfInteger, Id, Kept, Node, Number, Symbol, normal_form};

use super::atom::{Atom, Kind, Place, Shape, parity, shape};
use super::condition::Condition;
use super::layout::{Entry, bracketed, sum_text, width};
use super::notation::Notation;
use super::recursion::Recursion;
use super::square::without_unit_circles;

/// Entries with more terms are left out.
const LONGEST_SUM: usize = 40;

/// Entries with more characters are left out.
pub(super) const LONGEST_TEXT: usize = 2_000;

/// Expressions as sums of products, and how they are written.
pub(super) struct Algebra<'g> {
    pub(super) graph: &'g Graph,
    pub(super) notation: Notation,
    /// Nodes expanded so far; `None` where there are too many terms.
    pub(super) sums: BTreeMap<Id, Option<Polynomial>>,
    pub(super) atoms: BTreeMap<Id, Atom>,
    pub(super) conditions: BTreeMap<Id, Condition>,
    /// Whether sines and cosines are abbreviated: `s_{23}`.
    pub(super) abbreviates: bool,
    /// Whether sums stay as they are derived, now.
    pub(super) is_recursive: bool,
    /// Sums, atoms and conditions of what is written the other way: multiplied out or by recursion.
    others: Caches,
    pub(super) recursion: Recursion,
}

#[derive(Default)]
struct Caches {
    sums: BTreeMap<Id, Option<Polynomial>>,
    atoms: BTreeMap<Id, Atom>,
    conditions: BTreeMap<Id, Condition>,
}

impl<'g> Algebra<'g> {
    pub(super) fn new(graph: &'g Graph, notation: Notation) -> Self {
        Algebra {
            graph,
            notation,
            sums: BTreeMap::new(),
            atoms: BTreeMap::new(),
            conditions: BTreeMap::new(),
            abbreviates: false,
            is_recursive: false,
            others: Caches::default(),
            recursion: Recursion::default(),
        }
    }

    /// From multiplying out to recursion, and back.
    pub(super) fn switch(&mut self) {
        self.is_recursive = !self.is_recursive;
        std::mem::swap(&mut self.sums, &mut self.others.sums);
        std::mem::swap(&mut self.atoms, &mut self.others.atoms);
        std::mem::swap(&mut self.conditions, &mut self.others.conditions);
    }

    /// An expression in its shortest form: multiple angles, half angles, as derived.
    pub(super) fn shortest(&mut self, value: Expr<'g>) -> Option<Polynomial> {
        let textbook = normal_form(&[value], &Kept::default(), MOST_TERMS).and_then(|forms| self.expand(forms[0]));
        let plain = self.expand(value);
        let mut forms = Vec::new();
        // Where sums of angles have names, products of sines are shorter than those that multiple angles make of them.
        let textbook = textbook.filter(|_| !self.abbreviates || plain.is_none());
        for sum in [textbook, plain].into_iter().flatten() {
            let sum = without_unit_circles(self.graph, sum);
            forms.extend(halved(&sum, Doubled::Matched, MOST_TERMS, |id| self.double(id)));
            let sum = self.with_sums_of_angles(sum);
            forms.push(without_unit_circles(self.graph, sum));
        }
        self.shortest_of(forms)
    }

    /// Of equally short ones the first. A group with a doubled angle counts twice: people write `sin²θ`.
    pub(super) fn shortest_of(&mut self, mut forms: Vec<Polynomial>) -> Option<Polynomial> {
        if self.abbreviates {
            // Better longer than by angles that have no abbreviation.
            let is_wave = |id: &Id| matches!(self.atoms[id].shape, Shape::Named("\\sin" | "\\cos", _));
            let has_wave = |sum: &Polynomial| sum.0.keys().flat_map(Powers::keys).any(is_wave);
            if forms.iter().any(|sum| !has_wave(sum)) {
                forms.retain(|sum| !has_wave(sum));
            }
        }
        let mut length = |sum: &Polynomial| {
            let groups = self.groups(sum);
            let doubled = groups.iter().filter(|(_, group)| group.state.keys().any(|&id| self.double(id).is_some()));
            let doubled = doubled.count();
            (groups.len() + doubled, sum.0.len())
        };
        forms.into_iter().min_by_key(|sum| length(sum))
    }

    /// `M q̈ + C q̇ + G + ∂D/∂q̇` in row i, from the forms in which these are written.
    pub(super) fn left_side(&mut self, equations: &Equations<'g>, i: usize) -> Option<Polynomial> {
        let (lagrange, symbols) = (&equations.lagrange, &equations.symbols);
        let accelerations = lagrange.mass_matrix[i].iter().zip(&symbols.qdd);
        let velocities = lagrange.coriolis_matrix[i].iter().zip(&symbols.qd);
        let mut sum =
            self.shortest(lagrange.gravity[i])?.plus(&self.shortest(lagrange.dissipation_force[i])?, Number::ONE);
        for (&entry, &symbol) in accelerations.chain(velocities) {
            let factor = self.expand(self.graph.symbol(symbol))?;
            sum = sum.plus(&self.shortest(entry)?.times(&factor, MOST_TERMS)?, Number::ONE);
        }
        Some(sum)
    }

    /// As written, unless it is too long.
    pub(super) fn entry(&self, sum: Option<Polynomial>) -> Entry {
        let Some(sum) = sum else { return Entry::TooLong };
        let count = self.groups(&sum).len();
        if count > LONGEST_SUM {
            return Entry::TooLong;
        }
        let terms = self.terms(&sum);
        if sum_text(&terms).len() > LONGEST_TEXT { Entry::TooLong } else { Entry::Written(terms) }
    }

    /// An expression as a sum of products; `None` where there are too many.
    pub(super) fn expand(&mut self, root: Expr<'g>) -> Option<Polynomial> {
        for id in self.graph.reachable([root.id()]) {
            if !self.sums.contains_key(&id) {
                let sum = self.node(id).filter(|sum| sum.0.len() <= MOST_TERMS);
                self.sums.insert(id, sum);
            }
        }
        self.sums[&root.id()].clone()
    }

    pub(super) fn node(&mut self, id: Id) -> Option<Polynomial> {
        let sum = |algebra: &Self, id: Id| algebra.sums[&id].clone();
        match self.graph.node(id) {
            Node::Constant(value) => Some(Polynomial::term(Powers::new(), value)),
            Node::Symbol(symbol) => {
                let atom = self.symbol(symbol);
                self.atoms.insert(id, atom);
                Some(Polynomial::atom(id, 2))
            }
            Node::Rate(_) => unreachable!("time derivatives were carried out by derive"),
            Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_) => {
                let condition = self.condition(id)?;
                self.conditions.insert(id, condition);
                Some(Polynomial::default())
            }
            Node::Select(c, a, b) => self.cases(id, c, a, b),
            Node::Neg(a) => Some(sum(self, a)?.negative()),
            Node::Add(a, b) => Some(sum(self, a)?.plus(&sum(self, b)?, Number::ONE)),
            Node::Sub(a, b) => Some(sum(self, a)?.plus(&sum(self, b)?, -Number::ONE)),
            Node::Mul(a, b) => sum(self, a)?.times(&sum(self, b)?, MOST_TERMS),
            Node::Power(a, n) => self.power(a, n),
            Node::Call(function, a) => self.call(id, function, a),
            Node::Spline(derivative, a) => {
                let a = sum(self, a)?;
                let (x, primes) = (self.text(&a)?, "'".repeat(derivative.order as usize));
                let text = format!("\\operatorname{{table}}_{{{}}}{primes}({x})", derivative.spline);
                self.function(id, Shape::Closed(text), &[&a]);
                Some(Polynomial::atom(id, 2))
            }
            Node::Call2(function, a, b) => {
                let (a, b) = (sum(self, a)?, sum(self, b)?);
                let (x, y) = (self.text(&a)?, self.text(&b)?);
                let text = match function {
                    Binary::Atan2 => format!("\\operatorname{{atan2}}({x}, {y})"),
                    Binary::Powf if self.is_one_symbol(&a) => format!("{x}^{{{y}}}"),
                    Binary::Powf => format!("{}^{{{y}}}", bracketed(&x)),
                };
                self.function(id, Shape::Closed(text), &[&a, &b]);
                Some(Polynomial::atom(id, 2))
            }
        }
    }

    /// `a` where the condition holds, else `b`.
    fn cases(&mut self, id: Id, condition: Id, a: Id, b: Id) -> Option<Polynomial> {
        let [yes, no] = [self.sums[&a].clone()?, self.sums[&b].clone()?].map(|sum| self.with_squares(sum));
        let (x, y) = (self.text(&yes)?, self.text(&no)?);
        let condition = self.conditions.get(&condition)?.holds.text();
        let text =
            format!("\\begin{{cases}} {x} & \\text{{if }} {condition} \\\\ {y} & \\text{{otherwise}} \\end{{cases}}");
        self.function(id, Shape::Closed(text), &[&yes, &no]);
        Some(Polynomial::atom(id, 2))
    }

    fn symbol(&self, symbol: Symbol) -> Atom {
        let (kind, number) = match symbol {
            Symbol::Parameter(i) => (Kind::Parameter, self.notation.ranks[i as usize]),
            Symbol::Coordinate(i) => (Kind::Coordinate, i),
            Symbol::Velocity(i) => (Kind::Velocity, i),
            Symbol::Acceleration(i) => (Kind::Acceleration, i),
            Symbol::Input(i) => (Kind::Input, i),
            Symbol::Prescribed(i, order) => (Kind::Input, (1 + u32::from(order)) * 10_000 + i),
            Symbol::Multiplier(i) => (Kind::Input, 40_000 + i),
            Symbol::Time => (Kind::Time, 0),
        };
        Atom {
            place: Place { kind, number, text: String::new() },
            parametric: kind == Kind::Parameter,
            first_coordinate: if kind == Kind::Coordinate { number } else { u32::MAX },
            shape: Shape::Symbol(self.notation.symbol(symbol)),
        }
    }

    fn power(&mut self, base: Id, n: HalfInteger) -> Option<Polynomial> {
        let sum = self.sums[&base].clone()?;
        if let Some(k @ 0..=4) = n.to_integer() {
            return (0..k)
                .try_fold(Polynomial::term(Powers::new(), Number::ONE), |product, _| product.times(&sum, MOST_TERMS));
        }
        if let (Some(_), Some(k)) = (sum.as_term(), n.to_integer()) {
            return sum.monomial_power(k);
        }
        if let Some(atom) = single_atom(&sum) {
            return Some(Polynomial::atom(atom, n.to_halves()));
        }
        let (sum, flipped) = if n.to_integer().is_some() { self.leading_positive(sum) } else { (sum, false) };
        let base = if flipped { -self.graph.expr(base) } else { self.graph.expr(base) };
        // The base itself may be the number of a function whose argument has changed its sign.
        let id = base.sqrt().id();
        let sum = self.with_squares(sum);
        self.function(id, Shape::Sum(self.text(&sum)?), &[&sum]);
        let power = Polynomial::atom(id, n.to_halves());
        Some(if flipped && n.to_integer().is_some_and(|k| k % 2 != 0) { power.negative() } else { power })
    }

    fn call(&mut self, id: Id, function: Function, argument: Id) -> Option<Polynomial> {
        let sum = self.sums[&argument].clone()?;
        let parity = parity(function);
        let (sum, flipped) = if parity == 0 { (sum, false) } else { self.leading_positive(sum) };
        let text = self.text(&sum)?;
        let argument = if self.is_one_symbol(&sum) { text.clone() } else { bracketed(&text) };
        let shape = match self.wave(function, &sum, &argument) {
            Some(name) => Shape::Symbol(name),
            None => shape(function, argument, &text),
        };
        self.function(id, shape, &[&sum]);
        let atom = Polynomial::atom(id, 2);
        Some(if flipped && parity < 0 { atom.negative() } else { atom })
    }

    fn function(&mut self, id: Id, shape: Shape, arguments: &[&Polynomial]) {
        let atoms = || arguments.iter().flat_map(|sum| sum.0.keys()).flat_map(Powers::keys).map(|id| &self.atoms[id]);
        let parametric = self.graph.is_parametric(id);
        let first_coordinate = atoms().map(|atom| atom.first_coordinate).min().unwrap_or(u32::MAX);
        let (kind, text) = match &shape {
            // One symbol before sums, the sine before the cosine of the same argument.
            Shape::Named(name, argument) => {
                let length = if argument.ends_with(')') { width(argument) } else { 0 };
                let name = if *name == "\\sin" { "" } else { name };
                (Kind::Trigonometric, format!("{length:4} {argument} {name}"))
            }
            Shape::Symbol(name) if name.starts_with(['s', 'c']) => (Kind::Trigonometric, format!("{:4} {name}", "")),
            shape if shape.is_open() => (Kind::Trigonometric, shape.inside()),
            _ if parametric => (Kind::ParametricFunction, shape.inside()),
            _ => (Kind::Function, shape.inside()),
        };
        let place = Place { kind, number: first_coordinate, text };
        self.atoms.insert(id, Atom { place, parametric, first_coordinate, shape });
    }

    fn is_one_symbol(&self, sum: &Polynomial) -> bool {
        single_atom(sum).is_some_and(|id| matches!(self.atoms[&id].shape, Shape::Symbol(_)))
    }

    /// The sum or its negative, whichever is written with a positive first term, and whether it is the negative.
    pub(super) fn leading_positive(&self, sum: Polynomial) -> (Polynomial, bool) {
        let negative = self.terms(&sum).first().is_some_and(|term| term.negative);
        if negative { (sum.negative(), true) } else { (sum, false) }
    }

    /// As written; `None` where that is too long.
    pub(super) fn text(&self, sum: &Polynomial) -> Option<String> {
        let text = sum_text(&self.terms(sum));
        (text.len() <= LONGEST_TEXT).then_some(text)
    }

    /// What the sine or cosine of twice a sum of whole multiples is the double of.
    fn double(&mut self, id: Id) -> Option<Double> {
        let Node::Call(function @ (Function::Sin | Function::Cos), angle) = self.graph.node(id) else { return None };
        let (sum, _) = self.leading_positive(self.sums[&angle].clone()?);
        let mut half = self.graph.integer(0);
        let mut odd = false;
        for (powers, coefficient) in &sum.0 {
            let &Number::Exact { numerator, denominator: 1, pi: 0 } = coefficient else { return None };
            if numerator % 2 != 0 {
                return None;
            }
            odd |= numerator % 4 != 0;
            let unit = self.graph.constant(Number::rational(numerator / 2, 1)?);
            half = half + unit * self.expression(powers);
        }
        Some(Double { function, sine: self.expand(half.sin())?, cosine: self.expand(half.cos())?, is_fourfold: !odd })
    }
}

/// The atom that the sum consists of.
pub(super) fn single_atom(sum: &Polynomial) -> Option<Id> {
    let (powers, coefficient) = sum.as_term()?;
    let (&id, &halves) = powers.first_key_value()?;
    (powers.len() == 1 && halves == 2 && coefficient.is_one()).then_some(id)
}
