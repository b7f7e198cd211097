//! What is too long to be multiplied out: by the recursion with which it is computed, a name for each intermediate
//! result that is used more than once or would not fit on a line.
//!
//! Names are those of the sweeps where these have given any (`expr/note.rs`, the key is in [`KEY`]), else `k_1`, `k_2`,
//! … for what depends on parameters alone and `b_1`, `b_2`, … for the rest. Each node of the graph is looked at once.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::normal::combination::Polynomial;
use crate::expr::{Expr, HalfInteger, Id, Node, Symbol};

use super::algebra::{Algebra, single_atom};
use super::atom::{Atom, Kind, Place, Shape};
use super::layout::{Entry, lines, sum_text, width};

/// Products this wide are written where they are used, however often.
const SHORT: usize = 9;

/// Sums wider than this stand in no bracket and no argument: they get a name.
const WIDE: usize = 40;

/// Sums of more terms are written in parts.
const MOST_SUMMANDS: usize = 24;

/// Symbols that stand for sums in brackets and for abbreviations have numbers from here on.
const FRESH: u32 = 1 << 30;

/// What the letters of the sweeps mean: note, letter on paper, meaning.
pub(super) const KEY: [(&str, &str, &str); 18] = [
    ("w", "\\omega", "angular velocity of the link behind joint $j$"),
    ("v", "v", "velocity of the origin of that link"),
    ("wd", "\\dot{\\omega}", "rate of the angular velocity"),
    ("a", "a", "acceleration of the origin less gravity"),
    ("u", "U", "entries of $[\\dot{\\omega}]_\\times + [\\omega]_\\times [\\omega]_\\times$"),
    ("fi", "\\tilde{f}", "force that moves the link alone"),
    ("ni", "\\tilde{n}", "couple that moves the link alone"),
    ("f", "f", "force that the joint transmits"),
    ("n", "n", "couple that the joint transmits"),
    ("mc", "\\hat{m}", "mass of all behind the joint, as one body"),
    ("hc", "\\hat{h}", "first moments of all behind the joint"),
    ("sc", "\\hat{S}", "second moments of all behind the joint"),
    ("pc", "\\hat{P}", "moments of what moves within that body"),
    ("lc", "\\hat{L}", "momentum of what moves within that body"),
    ("mr", "\\bar{m}", "mass regrouped: what the joint does not feel is moved to the link before"),
    ("hr", "\\bar{h}", "first moments regrouped"),
    ("sr", "\\bar{S}", "second moments regrouped"),
    ("m", "m", "mass"),
];

/// The recursion so far.
#[derive(Default)]
pub(super) struct Recursion {
    /// How often each node is used by what is written by recursion.
    uses: BTreeMap<Id, u32>,
    /// What nodes are to be called.
    labels: BTreeMap<Id, Label>,
    /// Sums in brackets: the symbol, and whether it stands for the negative.
    brackets: BTreeMap<Id, (Id, bool)>,
    /// Definitions that are not on the page yet.
    pub(super) definitions: Vec<(String, Vec<String>)>,
    /// What has a name: the name, the node, and whether the name is that of its negative.
    pub(super) named: Vec<(String, Id, bool)>,
    /// Which letters of the key are on the page.
    pub(super) letters: BTreeSet<&'static str>,
    fresh: u32,
    numbers: [u32; 2],
}

/// A name that a node has before it is written, and whether it is that of the negative.
#[derive(Clone)]
struct Label {
    name: Called,
    negative: bool,
}

/// What something is called.
#[derive(Clone)]
pub(super) enum Called {
    /// The name of an entry, by which it is known elsewhere on the page.
    Exactly(String),
    /// A stem and a subscript; if another is called so, something like it.
    Like(String, String),
}

impl<'g> Algebra<'g> {
    /// Says what will be written by recursion, so that each intermediate result has its name once.
    pub(super) fn plan(&mut self, roots: &[Id]) {
        let order = self.graph.reachable(roots.iter().copied());
        let uses = &mut self.recursion.uses;
        roots.iter().for_each(|&root| *uses.entry(root).or_insert(0) += 1);
        for &id in order.iter().rev() {
            self.graph.node(id).operands().for_each(|operand| *uses.entry(operand).or_insert(0) += 1);
        }
    }

    /// Calls a node so where it is written by recursion: the first name stays.
    pub(super) fn label(&mut self, expr: Expr<'g>, name: Called) {
        let (id, negative) = match expr.node() {
            Node::Constant(_) | Node::Symbol(_) => return,
            Node::Neg(a) => (a, true),
            _ => (expr.id(), false),
        };
        self.recursion.labels.entry(id).or_insert(Label { name, negative });
    }

    /// The value by its recursion, whose definitions are added to those that wait; too long where a part of it cannot
    /// be written.
    pub(super) fn recursive(&mut self, root: Expr<'g>) -> Entry {
        self.switch();
        let entry = match self.follow(root.id()) {
            Some(sum) => Entry::Written(self.terms(&sum)),
            None => Entry::TooLong,
        };
        self.switch();
        entry
    }

    fn follow(&mut self, root: Id) -> Option<Polynomial> {
        for id in self.undone(root) {
            let sum = self.step(id).map(|sum| self.with_sums_of_angles(sum));
            self.sums.insert(id, sum);
            if self.deserves_a_name(id) {
                self.define(id);
            }
        }
        self.sums[&root].clone()
    }

    /// The nodes below this one that have not been written, operands first.
    fn undone(&self, root: Id) -> BTreeSet<Id> {
        let (mut undone, mut stack) = (BTreeSet::new(), vec![root]);
        while let Some(id) = stack.pop() {
            if !self.sums.contains_key(&id) && undone.insert(id) {
                stack.extend(self.graph.node(id).operands());
            }
        }
        undone
    }

    /// One node, its operands written; sums that are multiplied stay in brackets.
    fn step(&mut self, id: Id) -> Option<Polynomial> {
        match self.graph.node(id) {
            Node::Mul(a, b) => {
                let (a, b) = (self.factor(a)?, self.factor(b)?);
                a.times(&b, MOST_SUMMANDS)
            }
            Node::Power(a, n) => {
                let base = self.factor(a)?;
                self.power_of_factor(&base, n)
            }
            Node::Add(a, b) | Node::Sub(a, b) => {
                let count = |sum: &Option<Polynomial>| sum.as_ref().map_or(0, |sum| sum.0.len());
                let longer = if count(&self.sums[&a]) < count(&self.sums[&b]) { b } else { a };
                if count(&self.sums[&a]) + count(&self.sums[&b]) > MOST_SUMMANDS {
                    self.define(longer);
                }
                self.node(id)
            }
            Node::Constant(_) | Node::Symbol(_) | Node::Neg(_) | Node::Rate(_) | Node::And(..) | Node::Not(_) => {
                self.node(id)
            }
            node @ (Node::Call(..)
            | Node::Call2(..)
            | Node::Spline(..)
            | Node::Less(..)
            | Node::LessEqual(..)
            | Node::Select(..)) => {
                for operand in node.operands() {
                    if self.sums[&operand].as_ref().is_some_and(|sum| self.is_wide(sum)) {
                        self.define(operand);
                    }
                }
                self.node(id)
            }
        }
    }

    /// A node as it stands in a product: one term, of a sum its bracket or its name.
    fn factor(&mut self, id: Id) -> Option<Polynomial> {
        let sum = self.sums[&id].clone()?;
        if sum.0.len() <= 1 {
            return Some(sum);
        }
        if self.is_wide(&sum) {
            self.define(id);
            return self.sums[&id].clone();
        }
        let known = self.recursion.brackets.get(&id).copied();
        let (symbol, negative) = known.unwrap_or_else(|| {
            let (sum, flipped) = self.leading_positive(sum);
            let symbol = self.fresh();
            let place = self.bracket_place(sum.0.keys().cloned());
            let text = sum_text(&self.terms(&sum));
            let place = place.unwrap_or(Place { kind: Kind::Function, number: u32::MAX, text: text.clone() });
            let atom = self.atom(id, place, Shape::Sum(text));
            self.atoms.insert(symbol, atom);
            self.recursion.brackets.insert(id, (symbol, flipped));
            (symbol, flipped)
        });
        let bracket = Polynomial::atom(symbol, 2);
        Some(if negative { bracket.negative() } else { bracket })
    }

    fn power_of_factor(&mut self, base: &Polynomial, n: HalfInteger) -> Option<Polynomial> {
        if let Some(n) = n.to_integer() {
            return base.monomial_power(n);
        }
        if let Some(atom) = single_atom(base) {
            return Some(Polynomial::atom(atom, n.to_halves()));
        }
        // A product under a root.
        let symbol = self.fresh();
        let place = self.bracket_place(base.0.keys().cloned());
        let text = sum_text(&self.terms(base));
        let place = place.unwrap_or(Place { kind: Kind::Function, number: u32::MAX, text: text.clone() });
        let parts = base.0.keys().flat_map(|powers| powers.keys()).map(|id| &self.atoms[id]);
        let parametric = parts.clone().all(|atom| atom.parametric);
        let first_coordinate = parts.map(|atom| atom.first_coordinate).min().unwrap_or(u32::MAX);
        self.atoms.insert(symbol, Atom { place, parametric, first_coordinate, shape: Shape::Sum(text) });
        Some(Polynomial::atom(symbol, n.to_halves()))
    }

    fn fresh(&mut self) -> Id {
        self.recursion.fresh += 1;
        self.graph.symbol(Symbol::Multiplier(FRESH + self.recursion.fresh)).id()
    }

    fn atom(&self, id: Id, place: Place, shape: Shape) -> Atom {
        Atom { place, parametric: self.graph.is_parametric(id), first_coordinate: u32::MAX, shape }
    }

    fn is_wide(&self, sum: &Polynomial) -> bool {
        width(&sum_text(&self.terms(sum))) > WIDE
    }

    /// What is used more than once and is neither short nor an angle.
    fn deserves_a_name(&self, id: Id) -> bool {
        let is_value = !matches!(
            self.graph.node(id),
            Node::Constant(_) | Node::Symbol(_) | Node::Less(..) | Node::LessEqual(..) | Node::And(..) | Node::Not(_)
        );
        let Some(Some(sum)) = self.sums.get(&id) else { return false };
        let is_shared = self.recursion.uses.get(&id).is_some_and(|&uses| uses > 1);
        let is_named = self.recursion.labels.contains_key(&id);
        if !is_value || !(is_shared || is_named) || self.is_angle(sum) {
            return false;
        }
        let width = width(&sum_text(&self.terms(sum)));
        let is_root = matches!(self.graph.node(id), Node::Power(_, n) if n.to_integer().is_none());
        width > SHORT || (is_named && (is_root || sum.0.len() > 1))
    }

    /// Gives a node its name; from now on it is written so.
    fn define(&mut self, id: Id) {
        let Some(Some(sum)) = self.sums.get(&id).cloned() else { return };
        if sum.0.len() <= 1 && single_atom(&sum).is_some() {
            return;
        }
        let parametric = self.graph.is_parametric(id);
        let (name, negative) = self.name(id, parametric);
        let sum = if negative { sum.negative() } else { sum };
        self.recursion.named.push((name.clone(), id, negative));
        self.recursion.definitions.push((name.clone(), lines(&self.terms(&sum))));
        let kind = if parametric { Kind::ParametricFunction } else { Kind::Function };
        let place = Place { kind, number: u32::MAX, text: name.clone() };
        let symbol = self.fresh();
        let atom = self.atom(id, place, Shape::Symbol(name));
        self.atoms.insert(symbol, atom);
        let named = Polynomial::atom(symbol, 2);
        self.sums.insert(id, Some(if negative { named.negative() } else { named }));
    }

    fn name(&mut self, id: Id, parametric: bool) -> (String, bool) {
        if let Some(Label { name, negative }) = self.recursion.labels.get(&id).cloned() {
            let name = match name {
                Called::Exactly(name) => name,
                Called::Like(stem, subscript) => self.notation.unique(&stem, &subscript),
            };
            return (name, negative);
        }
        if let Some((letter, stem, subscript, negative)) = self.graph.note(id).and_then(|note| of_a_sweep(&note)) {
            self.recursion.letters.insert(letter);
            return (self.notation.unique(stem, &subscript), negative);
        }
        let letters: &[&'static str] = if parametric { &["k", "\\kappa", "K"] } else { &["b", "\\beta", "B"] };
        let letter = self.notation.free_letter(letters);
        let number = &mut self.recursion.numbers[usize::from(parametric)];
        *number += 1;
        let number = number.to_string();
        (self.notation.unique(letter, &number), false)
    }
}

/// `hc5x_neg` → `\hat{h}_{5x}`, the negative.
fn of_a_sweep(note: &str) -> Option<(&'static str, &'static str, String, bool)> {
    let (name, negative) = note.strip_suffix("_neg").map_or((note, false), |name| (name, true));
    let letters = name.trim_start_matches(|c: char| c.is_ascii_lowercase());
    let (letters, subscript) = name.split_at(name.len() - letters.len());
    let joint = subscript.trim_end_matches(['x', 'y', 'z']);
    let is_joint = !joint.is_empty() && joint.chars().all(|c| c.is_ascii_digit());
    let (own, stem, _) = KEY.iter().find(|(own, _, _)| *own == letters).filter(|_| is_joint)?;
    Some((own, stem, subscript.to_string(), negative))
}

/// `a = b`, several on a line where there is room, all aligned at their beginning.
pub(super) fn packed(definitions: &[(String, Vec<String>)], line: usize) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    let mut room = 0;
    for (name, lines) in definitions {
        let text = format!("{name} = {}", lines.join(" \\\\\n  & \\quad "));
        let needs = width(&text) + 3;
        match rows.last_mut() {
            Some(row) if lines.len() == 1 && needs <= room => {
                row.push_str(&format!(", \\quad {text}"));
                room -= needs;
            }
            _ => {
                rows.push(format!("& {text}"));
                room = if lines.len() == 1 { line.saturating_sub(needs) } else { 0 };
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_of_the_sweeps_have_letters() {
        let name = |note| of_a_sweep(note).map(|(_, stem, subscript, negative)| (stem, subscript, negative));
        assert_eq!(name("hc5x_neg"), Some(("\\hat{h}", "5x".to_string(), true)));
        assert_eq!(name("w3z"), Some(("\\omega", "3z".to_string(), false)));
        assert_eq!([name("m_3_0"), name("by_w3x"), name("q"), name("length")], [const { None }; 4]);
    }

    #[test]
    fn definitions_share_lines() {
        let short = |name: &str| (name.to_string(), vec!["x + 1".to_string()]);
        let long = ("c".to_string(), vec!["x".to_string(), "{} + y".to_string()]);
        let rows = packed(&[short("a"), short("b"), long, short("d")], 30);
        assert_eq!(rows, ["& a = x + 1, \\quad b = x + 1", "& c = x \\\\\n  & \\quad {} + y", "& d = x + 1"]);
    }
}
