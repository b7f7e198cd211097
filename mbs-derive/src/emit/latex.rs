//! Textbook output: a LaTeX fragment (amsmath) with the energies, M, C, G and the equations of motion.
//!
//! Each entry is tried in several forms (multiple angles, half angles, as derived) and written in the shortest. On paper a
//! sum is a list of products, so that is what everything here becomes: numbers, parameters, coordinates, trigonometric
//! functions, in this order. Nothing recurses on the depth of an expression; what is longer than anybody would write is
//! left out, and a comment says so.
//!
//! In reading order: the page and its blocks; entries and their forms; [`Algebra`], sums of products; how products and sums
//! are written; [`Notation`], names of symbols; numbers and units.

use std::cmp::Reverse;
use std::collections::btree_map::Entry::Vacant;
use std::collections::{BTreeMap, BTreeSet};

use crate::derive::textbook::{MOST_COORDINATES, MOST_TERMS};
use crate::derive::{Equations, Rows, time_derivative};
use crate::expr::{Binary, Expr, Function, Graph, HalfInteger, Id, Node, Number, Symbol, carry_out, normal_form};
use crate::model::lagrangian::component_names;
use crate::model::{Lagrangian, Variable};

/// Entries with more terms are left out.
const LONGEST_SUM: usize = 40;

/// Entries with more characters are left out.
const LONGEST_TEXT: usize = 2_000;

/// What fits on a line, in symbols as seen on paper.
const LINE: usize = 64;

/// Blocks of more lines may be broken across pages.
const LINES: usize = 30;

/// The equations of motion as a person would write them: a LaTeX fragment that needs amsmath.
///
/// Matrices and equations of mechanisms with more than four coordinates are left out with their sizes.
pub(super) fn latex(lagrangian: &Lagrangian<'_>, equations: &[Equations<'_>]) -> String {
    let Some(equations) = equations.first() else { return String::new() };
    let graph = equations.lagrange.kinetic_energy.graph();
    let algebra = Algebra { graph, notation: Notation::of(lagrangian), sums: BTreeMap::new(), atoms: BTreeMap::new() };
    let mut page = Page { algebra, left_out: Vec::new(), text: String::new() };
    page.title(lagrangian);
    page.symbols(lagrangian);
    page.energies(lagrangian, equations);
    if lagrangian.dof() <= MOST_COORDINATES {
        page.terms(equations);
        page.equations_of_motion(equations);
    } else {
        page.sizes(equations);
    }
    page.conserved(equations);
    page.text
}

/// What is written so far.
struct Page<'g> {
    algebra: Algebra<'g>,
    /// Comments about entries that were too long, for the block that is being written.
    left_out: Vec<String>,
    text: String,
}

impl<'g> Page<'g> {
    fn title(&mut self, lagrangian: &Lagrangian<'_>) {
        self.text.push_str(&format!("% {}\n", one_line(&lagrangian.name)));
        for line in lagrangian.docs.iter().flat_map(|doc| doc.lines()) {
            self.text.push_str(format!("% {}", line.trim()).trim_end());
            self.text.push('\n');
        }
    }

    fn symbols(&mut self, lagrangian: &Lagrangian<'_>) {
        let notation = &self.algebra.notation;
        let kinds = [
            ("coordinate", &lagrangian.coordinates, &notation.coordinates),
            ("parameter", &lagrangian.parameters, &notation.parameters),
            ("input", &lagrangian.inputs, &notation.inputs),
        ];
        let mut rows = String::new();
        for (kind, variables, names) in kinds {
            for variable in variables {
                let names: Vec<String> =
                    names.iter().skip(variable.first).take(variable.count()).map(Name::text).collect();
                let docs = one_line(&variable.docs.join(" "));
                let row = format!("  {} & {kind} & {} \\\\ % {docs}", listed(&names), unit(&variable.unit));
                rows.push_str(row.trim_end_matches([' ', '%']));
                rows.push('\n');
            }
        }
        let q: Vec<String> = notation.coordinates.iter().map(Name::text).collect();
        let q = if q.len() > 6 { format!("{}, \\dots, {}", q[0], q[q.len() - 1]) } else { q.join(", ") };
        let table = format!("\\begin{{tabular}}{{lll}}\n{rows}\\end{{tabular}}\n");
        self.text.push_str(&format!("\n\\paragraph{{Symbols.}} $\\mathbf{{q}} = ({q})^{{\\mathsf{{T}}}}$.\n\n{table}"));
    }

    fn energies(&mut self, lagrangian: &Lagrangian<'_>, equations: &Equations<'g>) {
        let graph = self.algebra.graph;
        let carried_out = |terms: &[Expr<'_>]| {
            let terms = carry_out(terms, graph, |symbol| time_derivative(symbol, graph));
            terms.into_iter().fold(graph.integer(0), |sum, term| sum + term)
        };
        let mut rows = self.definition("T", equations.lagrange.kinetic_energy);
        rows.extend(self.definition("V", equations.lagrange.potential_energy));
        if !lagrangian.lagrangian.is_empty() {
            rows.extend(self.definition("L - T + V", carried_out(&lagrangian.lagrangian)));
        }
        if !lagrangian.dissipation.is_empty() {
            rows.extend(self.definition("D", carried_out(&lagrangian.dissipation)));
        }
        self.block("Energies.", rows);
    }

    fn terms(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let column = |entries: &[Expr<'g>]| entries.iter().map(|&entry| vec![entry]).collect::<Rows<'g>>();
        let mut rows = self.matrix("\\mathbf{M}", "M", &lagrange.mass_matrix);
        rows.extend(self.matrix("\\mathbf{C}", "C", &lagrange.coriolis_matrix));
        rows.extend(self.matrix("\\mathbf{G}", "G", &column(&lagrange.gravity)));
        if has_any(&lagrange.dissipation_force) {
            let name = "\\partial D / \\partial \\dot{\\mathbf{q}}";
            rows.extend(self.matrix(name, "R", &column(&lagrange.dissipation_force)));
        }
        if has_any(&lagrange.generalized_force) {
            rows.extend(self.matrix("\\mathbf{Q}", "Q", &column(&lagrange.generalized_force)));
        }
        self.block(&format!("Terms of $\\displaystyle {}$.", equation_of_motion(equations)), rows);
    }

    fn equations_of_motion(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let mut rows = Vec::new();
        for (i, (&left, &right)) in lagrange.inverse_dynamics.iter().zip(&lagrange.generalized_force).enumerate() {
            let forms = [self.algebra.left_side(equations, i), self.algebra.shortest(left)];
            let shortest = self.algebra.shortest_of(forms.into_iter().flatten().collect());
            let left = self.written(&format!("left side of equation {}", i + 1), left, shortest);
            let right = self.entry(&format!("right side of equation {}", i + 1), right);
            rows.push((left.lines(), right.lines()));
        }
        // Equations of one line each are aligned at the equals sign, others at their beginning.
        let short = rows.iter().all(|(left, right)| left.len() == 1 && right.len() == 1);
        let row = |(left, right): (Vec<String>, Vec<String>)| match (short, left.last()) {
            (false, Some(last)) => {
                let fits = width(last) + width(&right[0]) <= LINE;
                let equals = if fits { " = " } else { " \\\\\n  & \\quad = " };
                let [left, right] = [left, right].map(|lines| lines.join(" \\\\\n  & \\quad "));
                format!("& {left}{equals}{right}")
            }
            _ => format!("{} &= {}", left.concat(), right.concat()),
        };
        self.block("Equations of motion.", rows.into_iter().map(row).collect());
    }

    /// What stands in for the matrices and equations of a large mechanism.
    fn sizes(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let n = lagrange.momentum.len();
        let square = format!("${n} \\times {n}$");
        let column = format!("${n} \\times 1$");
        let sizes = [
            ("$\\mathbf{M}$", &square, lagrange.mass_matrix.concat()),
            ("$\\mathbf{C}$", &square, lagrange.coriolis_matrix.concat()),
            ("$\\mathbf{G}$", &column, lagrange.gravity.clone()),
            ("$\\partial D / \\partial \\dot{\\mathbf{q}}$", &column, lagrange.dissipation_force.clone()),
            ("$\\mathbf{Q}$", &column, lagrange.generalized_force.clone()),
            ("the left sides of the equations", &column, lagrange.inverse_dynamics.clone()),
        ];
        let listed: Vec<String> = sizes
            .iter()
            .filter(|(_, _, entries)| has_any(entries))
            .map(|(name, size, entries)| format!("  {name} & {size} & {} operations \\\\\n", operations(entries)))
            .collect();
        self.text.push_str(&format!(
            "\n\\paragraph{{Equations of motion.}} ${}$.\nWith {n} coordinates they are too long to be written out; left out \
             are\n\n\\begin{{tabular}}{{lll}}\n{}\\end{{tabular}}\n",
            equation_of_motion(equations),
            listed.concat()
        ));
    }

    fn conserved(&mut self, equations: &Equations<'g>) {
        let coordinates = component_names_of(&self.algebra.notation.coordinates);
        let mut rows = Vec::new();
        for quantity in &equations.conserved {
            let coordinate = quantity.name.strip_prefix("p_").and_then(|name| coordinates.get(name));
            let name = coordinate.map_or("E".to_string(), |text| subscripted("p", text));
            rows.extend(self.definition(&name, quantity.value));
        }
        if !rows.is_empty() {
            let mut without = Vec::new();
            if equations.symbols.u.len() == 1 {
                without.push(format!("${} = 0$", self.algebra.notation.inputs[0].text()));
            } else if !equations.symbols.u.is_empty() {
                without.push("all inputs are zero".to_string());
            }
            if has_any(&equations.lagrange.dissipation_force) {
                without.push("$D = 0$".to_string());
            }
            let condition =
                if without.is_empty() { String::new() } else { format!(" where {}", without.join(" and ")) };
            self.block(&format!("Conserved{condition}."), rows);
        }
    }

    /// `name = value`
    fn definition(&mut self, name: &str, value: Expr<'g>) -> Vec<String> {
        let entry = self.entry(name, value);
        vec![format!("{name} &= {}", entry.lines().join(" \\\\\n  &\\quad "))]
    }

    /// `name = [entries]`; entries that are too wide get a name and a row of their own.
    fn matrix(&mut self, name: &str, letter: &str, rows: &Rows<'g>) -> Vec<String> {
        let columns = rows[0].len();
        let symmetric = letter == "M";
        let named = |i: usize, j: usize| {
            let (i, j) = if symmetric { (i.min(j), i.max(j)) } else { (i, j) };
            let index = if columns == 1 { format!("{}", i + 1) } else { format!("{}{}", i + 1, j + 1) };
            subscripted(letter, &index)
        };
        let mut written: BTreeMap<String, Entry> = BTreeMap::new();
        for (i, row) in rows.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                if let Vacant(place) = written.entry(named(i, j)) {
                    let entry = self.entry(place.key(), value);
                    place.insert(entry);
                }
            }
        }
        let widest = LINE / columns;
        let mut below = Vec::new();
        let mut below_of = BTreeSet::new();
        let mut shown_rows = Vec::new();
        for i in 0..rows.len() {
            let shown: Vec<String> = (0..columns)
                .map(|j| {
                    let entry = &written[&named(i, j)];
                    let inline = entry.lines().concat();
                    if width(&inline) <= widest {
                        return inline;
                    }
                    if below_of.insert(named(i, j)) {
                        below.push(format!("{} &= {}", named(i, j), entry.lines().join(" \\\\\n  &\\quad ")));
                    }
                    named(i, j)
                })
                .collect();
            shown_rows.push(format!("    {}", shown.join(" & ")));
        }
        let matrix = shown_rows.join(" \\\\\n");
        below.insert(0, format!("{name} &= \\begin{{bmatrix}}\n{matrix}\n  \\end{{bmatrix}}"));
        below
    }

    fn entry(&mut self, name: &str, value: Expr<'g>) -> Entry {
        let shortest = self.algebra.shortest(value);
        self.written(name, value, shortest)
    }

    fn written(&mut self, name: &str, value: Expr<'g>, sum: Option<Sum>) -> Entry {
        let entry = self.algebra.entry(sum);
        if let Entry::TooLong(terms) = entry {
            let terms = if terms == 0 { "too many terms".to_string() } else { format!("{terms} terms") };
            self.left_out.push(format!("% Left out: {name} ({terms}; {} operations).\n", operations(&[value])));
        }
        entry
    }

    fn block(&mut self, title: &str, rows: Vec<String>) {
        let rows: Vec<String> = rows.into_iter().map(|row| format!("  {row}")).collect();
        let comments: String = self.left_out.drain(..).collect();
        let rows = rows.join(" \\\\\n");
        let align = format!("\\begin{{align*}}\n{rows}\n\\end{{align*}}");
        let long = align.lines().count() > LINES;
        let align = if long { format!("{{\\allowdisplaybreaks\n{align}}}") } else { align };
        self.text.push_str(&format!("\n\\paragraph{{{title}}}\n{comments}{align}\n"));
    }
}

/// `M q̈ + C q̇ + G + ∂D/∂q̇ = Q`, without what is zero.
fn equation_of_motion(equations: &Equations<'_>) -> String {
    let lagrange = &equations.lagrange;
    let dissipation =
        if has_any(&lagrange.dissipation_force) { " + \\partial D / \\partial \\dot{\\mathbf{q}}" } else { "" };
    let right = if has_any(&lagrange.generalized_force) { "\\mathbf{Q}" } else { "\\mathbf{0}" };
    format!(
        "\\mathbf{{M}} \\ddot{{\\mathbf{{q}}}} + \\mathbf{{C}} \\dot{{\\mathbf{{q}}}} + \\mathbf{{G}}{dissipation} = {right}"
    )
}

fn has_any(entries: &[Expr<'_>]) -> bool {
    entries.iter().any(|entry| !entry.is_zero())
}

/// Nodes that compute something; what is shared counts once.
fn operations(entries: &[Expr<'_>]) -> usize {
    let Some(first) = entries.first() else { return 0 };
    let graph = first.graph();
    let computes = |id: &Id| match graph.node(*id) {
        Node::Constant(_) | Node::Symbol(_) | Node::Neg(_) => false,
        Node::Rate(_) | Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Power(..) => true,
        Node::Call(..) | Node::Call2(..) | Node::Less(..) | Node::And(..) | Node::Not(_) | Node::Select(..) => true,
    };
    graph.reachable(entries.iter().map(|entry| entry.id())).iter().filter(|id| computes(id)).count()
}

/// An expression as it is written.
enum Entry {
    Written(Vec<Signed>),
    /// So many terms; 0 where they were not counted.
    TooLong(usize),
}

impl Entry {
    /// The text in lines; all but the first begin with a sign.
    fn lines(&self) -> Vec<String> {
        match self {
            Entry::Written(terms) => lines(terms),
            Entry::TooLong(_) => vec!["\\ldots".to_string()],
        }
    }
}

/// A term of a sum and its sign.
#[derive(Clone, Debug)]
struct Signed {
    negative: bool,
    text: String,
}

fn sum_text(terms: &[Signed]) -> String {
    let mut text = String::new();
    for (i, term) in terms.iter().enumerate() {
        text.push_str(match (i, term.negative) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => " + ",
            (_, true) => " - ",
        });
        text.push_str(&term.text);
    }
    if terms.is_empty() { "0".to_string() } else { text }
}

fn lines(terms: &[Signed]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut start = 0;
    for end in 1..=terms.len() {
        let fits = end < terms.len() && width(&sum_text(&terms[start..=end])) <= LINE;
        if !fits {
            let continues = if start == 0 { "" } else { "{} + " };
            let text = sum_text(&terms[start..end]);
            // A sign at the beginning of a line is an operator all the same.
            lines.push(match text.strip_prefix('-') {
                Some(rest) if start > 0 => format!("{{}} - {rest}"),
                _ => format!("{continues}{text}"),
            });
            start = end;
        }
    }
    if lines.is_empty() { vec!["0".to_string()] } else { lines }
}

/// How many symbols are seen on paper, roughly.
fn width(text: &str) -> usize {
    let mut width = 0;
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '\\' => {
                let mut command = String::new();
                while let Some(letter) = rest.next_if(char::is_ascii_alphabetic) {
                    command.push(letter);
                }
                width += match command.as_str() {
                    "frac" | "left" | "right" | "dot" | "ddot" | "mathrm" | "operatorname" => 0,
                    "sin" | "cos" | "tan" => 3,
                    _ => 1,
                };
            }
            '{' | '}' | '^' | '_' | ' ' => {}
            '+' | '-' | '=' => width += 2,
            _ => width += 1,
        }
    }
    width
}

/// Powers, in halves, of atoms: symbols, functions, and sums under a power.
type Powers = BTreeMap<Id, i32>;

/// A sum of products, none with the coefficient zero.
#[derive(Clone, Debug, Default)]
struct Sum(BTreeMap<Powers, Number>);

impl Sum {
    fn product(powers: Powers, coefficient: Number) -> Self {
        let mut sum = Sum::default();
        sum.add(powers, coefficient);
        sum
    }

    fn atom(id: Id, halves: i32) -> Self {
        Sum::product([(id, halves)].into(), Number::ONE)
    }

    fn add(&mut self, powers: Powers, coefficient: Number) {
        let sum = self.0.get(&powers).copied().unwrap_or(Number::ZERO) + coefficient;
        if sum.is_zero() {
            self.0.remove(&powers);
        } else {
            self.0.insert(powers, sum);
        }
    }

    fn plus(&self, other: &Sum, sign: i64) -> Self {
        let mut sum = self.clone();
        let sign = Number::integer(sign);
        other.0.iter().for_each(|(powers, &coefficient)| sum.add(powers.clone(), coefficient * sign));
        sum
    }

    fn times(&self, other: &Sum) -> Option<Self> {
        let mut product = Sum::default();
        for (a, &x) in &self.0 {
            for (b, &y) in &other.0 {
                let powers = times(a, b);
                if powers.values().any(|halves| halves.abs() > HIGHEST) {
                    return None;
                }
                product.add(powers, x * y);
            }
            if product.0.len() > MOST_TERMS {
                return None;
            }
        }
        Some(product)
    }

    fn negative(&self) -> Self {
        Sum::default().plus(self, -1)
    }

    /// The only product, where there is one.
    fn as_product(&self) -> Option<(&Powers, Number)> {
        match self.0.first_key_value() {
            Some((powers, &coefficient)) if self.0.len() == 1 => Some((powers, coefficient)),
            _ => None,
        }
    }
}

/// The atom that the sum consists of.
fn single_atom(sum: &Sum) -> Option<Id> {
    let (powers, coefficient) = sum.as_product()?;
    let (&id, &halves) = powers.first_key_value()?;
    (powers.len() == 1 && halves == 2 && coefficient.is_one()).then_some(id)
}

/// Entries with powers beyond so many halves are left out.
const HIGHEST: i32 = 200;

fn times(a: &Powers, b: &Powers) -> Powers {
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

/// Where a factor stands in a product: the kind of thing it is, its number or its first coordinate, then its text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    kind: Kind,
    number: u32,
    text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Parameter,
    ParametricFunction,
    Coordinate,
    Velocity,
    Acceleration,
    Input,
    Time,
    Function,
    /// Last, because it takes everything that follows for its argument.
    Trigonometric,
}

/// A factor that is not taken apart.
#[derive(Clone, Debug)]
struct Atom {
    place: Place,
    /// Whether it depends on parameters alone.
    parametric: bool,
    /// The first coordinate that it depends on.
    first_coordinate: u32,
    shape: Shape,
}

/// What its powers look like.
#[derive(Clone, Debug)]
enum Shape {
    /// `x`, `x^2`
    Symbol(String),
    /// `\sin x`, `\sin^2 x`
    Named(&'static str, String),
    /// `f(x)`, `\left(f(x)\right)^2`
    Closed(String),
    /// `a + b`, `(a + b)^2`
    Sum(String),
}

impl Shape {
    /// Its power, for `halves > 0`.
    fn power(&self, halves: i32) -> String {
        let exponent = match halves {
            1 => return format!("\\sqrt{{{}}}", self.inside()),
            2 => None,
            n if n % 2 == 0 => Some(script('^', &(n / 2).to_string())),
            n => Some(script('^', &format!("{n}/2"))),
        };
        match (self, exponent) {
            (Shape::Sum(text), None) => bracketed(text),
            (_, None) => self.inside(),
            (Shape::Symbol(text), Some(exponent)) => format!("{text}{exponent}"),
            (Shape::Named(name, argument), Some(exponent)) if halves % 2 == 0 => {
                applied(&format!("{name}{exponent}"), argument)
            }
            (Shape::Named(..) | Shape::Closed(_) | Shape::Sum(_), Some(exponent)) => {
                format!("{}{exponent}", bracketed(&self.inside()))
            }
        }
    }

    /// Without brackets.
    fn inside(&self) -> String {
        match self {
            Shape::Symbol(text) | Shape::Closed(text) | Shape::Sum(text) => text.clone(),
            Shape::Named(name, argument) => applied(name, argument),
        }
    }
}

fn applied(function: &str, argument: &str) -> String {
    let space = if argument.starts_with(|c: char| c.is_ascii_alphanumeric()) { " " } else { "" };
    format!("{function}{space}{argument}")
}

fn bracketed(text: &str) -> String {
    let tall = ["\\frac", "\\left", "\\sqrt"].iter().any(|command| text.contains(command));
    if tall { format!("\\left({text}\\right)") } else { format!("({text})") }
}

/// Expressions as sums of products, and how they are written.
struct Algebra<'g> {
    graph: &'g Graph,
    notation: Notation,
    /// Nodes expanded so far; `None` where there are too many terms.
    sums: BTreeMap<Id, Option<Sum>>,
    atoms: BTreeMap<Id, Atom>,
}

impl<'g> Algebra<'g> {
    /// An expression in its shortest form: multiple angles, half angles, as derived.
    fn shortest(&mut self, value: Expr<'g>) -> Option<Sum> {
        let textbook = normal_form(&[value], MOST_TERMS).and_then(|forms| self.expand(forms[0]));
        let plain = self.expand(value);
        let forms = [textbook, plain].into_iter().flatten().flat_map(|sum| self.with_half_angles(sum)).collect();
        self.shortest_of(forms)
    }

    /// Of equally short ones the first.
    fn shortest_of(&self, forms: Vec<Sum>) -> Option<Sum> {
        forms.into_iter().min_by_key(|sum| (self.groups(sum).len(), sum.0.len()))
    }

    /// `M q̈ + C q̇ + G + ∂D/∂q̇` in row i, from the forms in which these are written.
    fn left_side(&mut self, equations: &Equations<'g>, i: usize) -> Option<Sum> {
        let (lagrange, symbols) = (&equations.lagrange, &equations.symbols);
        let accelerations = lagrange.mass_matrix[i].iter().zip(&symbols.qdd);
        let velocities = lagrange.coriolis_matrix[i].iter().zip(&symbols.qd);
        let mut sum = self.shortest(lagrange.gravity[i])?.plus(&self.shortest(lagrange.dissipation_force[i])?, 1);
        for (&entry, &symbol) in accelerations.chain(velocities) {
            let factor = self.expand(self.graph.symbol(symbol))?;
            sum = sum.plus(&self.shortest(entry)?.times(&factor)?, 1);
        }
        Some(sum)
    }

    /// As written, unless it is too long.
    fn entry(&self, sum: Option<Sum>) -> Entry {
        let Some(sum) = sum else { return Entry::TooLong(0) };
        let count = self.groups(&sum).len();
        if count > LONGEST_SUM {
            return Entry::TooLong(count);
        }
        let terms = self.terms(&sum);
        if sum_text(&terms).len() > LONGEST_TEXT { Entry::TooLong(count) } else { Entry::Written(terms) }
    }

    /// An expression as a sum of products; `None` where there are too many.
    fn expand(&mut self, root: Expr<'g>) -> Option<Sum> {
        for id in self.graph.reachable([root.id()]) {
            if !self.sums.contains_key(&id) {
                let sum = self.node(id).filter(|sum| sum.0.len() <= MOST_TERMS);
                self.sums.insert(id, sum);
            }
        }
        self.sums[&root.id()].clone()
    }

    fn node(&mut self, id: Id) -> Option<Sum> {
        let sum = |algebra: &Self, id: Id| algebra.sums[&id].clone();
        match self.graph.node(id) {
            Node::Constant(value) => Some(Sum::product(Powers::new(), value)),
            Node::Symbol(symbol) => {
                let atom = self.symbol(symbol);
                self.atoms.insert(id, atom);
                Some(Sum::atom(id, 2))
            }
            Node::Rate(_) => unreachable!("time derivatives were carried out by derive"),
            Node::Less(..) | Node::And(..) | Node::Not(_) => Some(Sum::product(Powers::new(), Number::ZERO)),
            Node::Select(c, a, b) => self.cases(id, c, a, b),
            Node::Neg(a) => Some(sum(self, a)?.negative()),
            Node::Add(a, b) => Some(sum(self, a)?.plus(&sum(self, b)?, 1)),
            Node::Sub(a, b) => Some(sum(self, a)?.plus(&sum(self, b)?, -1)),
            Node::Mul(a, b) => sum(self, a)?.times(&sum(self, b)?),
            Node::Power(a, n) => self.power(a, n),
            Node::Call(function, a) => self.call(id, function, a),
            Node::Call2(function, a, b) => {
                let (a, b) = (sum(self, a)?, sum(self, b)?);
                let (x, y) = (self.text(&a)?, self.text(&b)?);
                let text = match function {
                    Binary::Atan2 => format!("\\operatorname{{atan2}}({x}, {y})"),
                    Binary::Powf if self.is_one_symbol(&a) => format!("{x}^{{{y}}}"),
                    Binary::Powf => format!("{}^{{{y}}}", bracketed(&x)),
                };
                self.function(id, Shape::Closed(text), &[&a, &b]);
                Some(Sum::atom(id, 2))
            }
        }
    }

    /// `a` where the condition holds, else `b`.
    fn cases(&mut self, id: Id, condition: Id, a: Id, b: Id) -> Option<Sum> {
        let (yes, no) = (self.sums[&a].clone()?, self.sums[&b].clone()?);
        let (x, y) = (self.text(&yes)?, self.text(&no)?);
        let condition = self.condition(condition)?;
        let text =
            format!("\\begin{{cases}} {x} & \\text{{if }} {condition} \\\\ {y} & \\text{{otherwise}} \\end{{cases}}");
        self.function(id, Shape::Closed(text), &[&yes, &no]);
        Some(Sum::atom(id, 2))
    }

    fn condition(&mut self, id: Id) -> Option<String> {
        Some(match self.graph.node(id) {
            Node::Less(a, b) => {
                let (a, b) = (self.sums[&a].clone()?, self.sums[&b].clone()?);
                format!("{} < {}", self.text(&a)?, self.text(&b)?)
            }
            Node::And(a, b) => format!("{} \\land {}", self.condition(a)?, self.condition(b)?),
            Node::Not(a) => format!("\\lnot ({})", self.condition(a)?),
            _ => return None,
        })
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

    fn power(&mut self, base: Id, n: HalfInteger) -> Option<Sum> {
        let sum = self.sums[&base].clone()?;
        if let Some(k @ 0..=4) = n.to_integer() {
            return (0..k).try_fold(Sum::product(Powers::new(), Number::ONE), |product, _| product.times(&sum));
        }
        let product = sum.as_product().map(|(powers, coefficient)| (powers.clone(), coefficient));
        if let (Some((powers, coefficient)), Some(k)) = (product, n.to_integer()) {
            let powers: Powers =
                powers.iter().map(|(&id, &halves)| Some((id, halves.checked_mul(k)?))).collect::<Option<_>>()?;
            if powers.values().any(|halves| halves.abs() > HIGHEST) {
                return None;
            }
            return Some(Sum::product(powers, coefficient.power(n.to_halves())?));
        }
        if let Some(atom) = single_atom(&sum) {
            return Some(Sum::atom(atom, n.to_halves()));
        }
        let (sum, flipped) = if n.to_integer().is_some() { self.leading_positive(sum) } else { (sum, false) };
        let base = if flipped { -self.graph.expr(base) } else { self.graph.expr(base) };
        // The base itself may be the number of a function whose argument has changed its sign.
        let id = base.sqrt().id();
        self.function(id, Shape::Sum(self.text(&sum)?), &[&sum]);
        let power = Sum::atom(id, n.to_halves());
        Some(if flipped && n.to_integer().is_some_and(|k| k % 2 != 0) { power.negative() } else { power })
    }

    fn call(&mut self, id: Id, function: Function, argument: Id) -> Option<Sum> {
        let sum = self.sums[&argument].clone()?;
        let parity = parity(function);
        let (sum, flipped) = if parity == 0 { (sum, false) } else { self.leading_positive(sum) };
        let text = self.text(&sum)?;
        let argument = if self.is_one_symbol(&sum) { text.clone() } else { bracketed(&text) };
        self.function(id, shape(function, argument, &text), &[&sum]);
        let atom = Sum::atom(id, 2);
        Some(if flipped && parity < 0 { atom.negative() } else { atom })
    }

    fn function(&mut self, id: Id, shape: Shape, arguments: &[&Sum]) {
        let atoms = || arguments.iter().flat_map(|sum| sum.0.keys()).flat_map(BTreeMap::keys).map(|id| &self.atoms[id]);
        let parametric = atoms().all(|atom| atom.parametric);
        let first_coordinate = atoms().map(|atom| atom.first_coordinate).min().unwrap_or(u32::MAX);
        let (kind, text) = match &shape {
            // One symbol before sums, the sine before the cosine of the same argument.
            Shape::Named(name, argument) => {
                let length = if argument.ends_with(')') { width(argument) } else { 0 };
                let name = if *name == "\\sin" { "" } else { name };
                (Kind::Trigonometric, format!("{length:4} {argument} {name}"))
            }
            _ if parametric => (Kind::ParametricFunction, shape.inside()),
            _ => (Kind::Function, shape.inside()),
        };
        let place = Place { kind, number: first_coordinate, text };
        self.atoms.insert(id, Atom { place, parametric, first_coordinate, shape });
    }

    fn is_one_symbol(&self, sum: &Sum) -> bool {
        single_atom(sum).is_some_and(|id| matches!(self.atoms[&id].shape, Shape::Symbol(_)))
    }

    /// The sum or its negative, whichever is written with a positive first term, and whether it is the negative.
    fn leading_positive(&self, sum: Sum) -> (Sum, bool) {
        let negative = self.terms(&sum).first().is_some_and(|term| term.negative);
        if negative { (sum.negative(), true) } else { (sum, false) }
    }

    /// As written; `None` where that is too long.
    fn text(&self, sum: &Sum) -> Option<String> {
        let text = sum_text(&self.terms(sum));
        (text.len() <= LONGEST_TEXT).then_some(text)
    }

    /// `1 − cos 2x = 2 sin²x`, `1 + cos 2x = 2 cos²x`, `sin 2x = 2 sin x cos x`: the sum with such angles halved, and as it
    /// is.
    fn with_half_angles(&mut self, sum: Sum) -> Vec<Sum> {
        let mut halved = sum.clone();
        for powers in sum.0.keys() {
            for (&id, &halves) in powers {
                let Node::Call(function @ (Function::Sin | Function::Cos), argument) = self.graph.node(id) else {
                    continue;
                };
                let (Some(&coefficient), 2) = (halved.0.get(powers), halves) else { continue };
                let Some((sine, cosine)) = self.half_angle(argument) else { continue };
                let mut rest = powers.clone();
                rest.remove(&id);
                let constant = halved.0.get(&rest).copied();
                let replacement = match function {
                    Function::Sin => sine.times(&cosine),
                    _ if constant == Some(coefficient) => cosine.times(&cosine),
                    _ if constant == Some(-coefficient) => sine.times(&sine).map(|square| square.negative()),
                    _ => None,
                };
                let scale = Sum::product(rest.clone(), coefficient * Number::integer(2));
                let Some(replacement) = replacement.and_then(|product| product.times(&scale)) else { continue };
                halved.0.remove(powers);
                if function == Function::Cos {
                    halved.0.remove(&rest);
                }
                halved = halved.plus(&replacement, 1);
            }
        }
        vec![halved, sum]
    }

    /// Sine and cosine of half an angle that is twice a sum of whole multiples, not all of them even.
    fn half_angle(&mut self, angle: Id) -> Option<(Sum, Sum)> {
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
            half = half
                + powers.iter().fold(unit, |product, (&id, &halves)| {
                    product * self.graph.expr(id).power(HalfInteger::halves(halves))
                });
        }
        if !odd {
            return None;
        }
        Some((self.expand(half.sin())?, self.expand(half.cos())?))
    }

    /// The products with a common dependence on the state, in the order in which they are written.
    fn groups(&self, sum: &Sum) -> BTreeMap<GroupOrder, Group> {
        let mut groups: BTreeMap<GroupOrder, Group> = BTreeMap::new();
        for (powers, &coefficient) in &sum.0 {
            let (parameters, state): (Powers, Powers) =
                powers.iter().map(|(&id, &halves)| (id, halves)).partition(|(id, _)| self.atoms[id].parametric);
            let group = groups.entry(self.group_order(&state)).or_insert_with(|| Group { state, parts: Vec::new() });
            group.parts.push((parameters, coefficient));
        }
        for group in groups.values_mut() {
            group.parts.sort_by_cached_key(|(powers, _)| self.places(powers));
            // `m (l + 1)`: what is left as a number comes last.
            let (common, _) = group.common();
            group.parts.sort_by_key(|(powers, _)| *powers == common);
        }
        groups
    }

    /// Accelerations first, then by falling degree in the velocities, products without waves before those with.
    fn group_order(&self, state: &Powers) -> GroupOrder {
        let places = self.places(state);
        let of_kind = |kind: Kind| places.iter().filter(move |(place, _)| place.kind == kind);
        GroupOrder {
            acceleration: of_kind(Kind::Acceleration).map(|(place, _)| place.number).next().unwrap_or(u32::MAX),
            velocities: Reverse(of_kind(Kind::Velocity).map(|(_, Reverse(halves))| halves / 2).sum()),
            waves: of_kind(Kind::Trigonometric).count(),
            places,
        }
    }

    fn places(&self, powers: &Powers) -> Vec<(Place, Reverse<i32>)> {
        let mut places: Vec<_> =
            powers.iter().map(|(id, &halves)| (self.atoms[id].place.clone(), Reverse(halves))).collect();
        places.sort();
        places
    }

    /// The terms of a sum, in the order in which they are written.
    fn terms(&self, sum: &Sum) -> Vec<Signed> {
        let groups = self.groups(sum);
        let mut terms = Vec::new();
        let mut groups = groups.into_iter().peekable();
        while let Some((order, group)) = groups.next() {
            let mut same = vec![group];
            while let Some((_, next)) = groups.next_if(|(next, _)| order.shares_acceleration(next)) {
                same.push(next);
            }
            match same.as_slice() {
                [group] => terms.extend(self.group_terms(group)),
                several => terms.push(self.acceleration_term(several)),
            }
        }
        terms
    }

    /// One product, or several where nothing is common to them.
    fn group_terms(&self, group: &Group) -> Vec<Signed> {
        let (common, factor) = group.common();
        if group.parts.len() == 1 || (group.state.is_empty() && common.is_empty()) {
            return group.parts.iter().map(|(p, c)| self.product(&times(p, &group.state), *c, None)).collect();
        }
        let inverse: Powers = common.iter().map(|(&id, &halves)| (id, -halves)).collect();
        let unit = factor.power(-2).unwrap_or(Number::ONE);
        let inside: Vec<Signed> =
            group.parts.iter().map(|(p, c)| self.product(&times(p, &inverse), *c * unit, None)).collect();
        let first = group.parts.first().map(|(p, _)| times(p, &inverse));
        let place = first.and_then(|powers| self.places(&powers).first().map(|(place, _)| place.clone()));
        vec![self.product(&times(&common, &group.state), factor, Some((place, sum_text(&inside))))]
    }

    /// `(a + b) q̈`
    fn acceleration_term(&self, groups: &[Group]) -> Signed {
        let is_acceleration = |id: &Id| self.atoms[id].place.kind == Kind::Acceleration;
        let mut acceleration = Powers::new();
        let mut factor = Sum::default();
        for group in groups {
            for (parameters, coefficient) in &group.parts {
                let (common, state): (Powers, Powers) =
                    group.state.iter().map(|(&id, &halves)| (id, halves)).partition(|(id, _)| is_acceleration(id));
                acceleration = common;
                factor.add(times(parameters, &state), *coefficient);
            }
        }
        let (factor, flipped) = self.leading_positive(factor);
        let text = sum_text(&self.terms(&factor));
        let term = self.product(&acceleration, Number::ONE, Some((None, text)));
        Signed { negative: flipped, text: term.text }
    }

    /// Number, factors and a bracket in their order, what is below the line below it.
    fn product(&self, powers: &Powers, coefficient: Number, bracket: Option<(Option<Place>, String)>) -> Signed {
        let negative = coefficient.is_negative();
        let magnitude = if negative { -coefficient } else { coefficient };
        let mut factors: Vec<(Option<Place>, Shape, i32)> = powers
            .iter()
            .map(|(id, &halves)| (Some(self.atoms[id].place.clone()), self.atoms[id].shape.clone(), halves))
            .collect();
        factors.extend(bracket.map(|(place, text)| (place, Shape::Sum(text), 2)));
        factors.sort_by(|a, b| a.0.cmp(&b.0));
        let (above, below): (Vec<_>, Vec<_>) = factors.into_iter().partition(|(_, _, halves)| *halves > 0);
        let written = |factors: &[(Option<Place>, Shape, i32)]| -> Vec<String> {
            factors.iter().map(|(_, shape, halves)| shape.power(halves.abs())).collect()
        };
        let text = if below.is_empty() {
            let number = number(magnitude);
            let number = (number != "1" || above.is_empty()).then_some(number);
            juxtaposed(number, written(&above))
        } else {
            let (numerator, denominator) = numerator_and_denominator(magnitude);
            let line = |number: String, factors: &[(Option<Place>, Shape, i32)]| match factors {
                // A sum that is alone on its side of the line needs no brackets.
                [(_, Shape::Sum(text), 2 | -2)] if number == "1" => text.clone(),
                _ => {
                    let number = (number != "1" || factors.is_empty()).then_some(number);
                    juxtaposed(number, written(factors))
                }
            };
            format!("\\frac{{{}}}{{{}}}", line(numerator, &above), line(denominator, &below))
        };
        Signed { negative, text }
    }
}

/// Factors side by side; words are set apart.
fn juxtaposed(number: Option<String>, factors: Vec<String>) -> String {
    let is_word =
        |text: &str| ["\\mathrm", "\\dot{\\mathrm", "\\ddot{\\mathrm"].iter().any(|word| text.starts_with(word));
    let is_wave = |text: &str| ["\\sin", "\\cos", "\\tan"].iter().any(|wave| text.starts_with(wave));
    let mut product = String::new();
    let mut after_word = false;
    for factor in number.into_iter().chain(factors) {
        let apart = is_word(&factor) || (after_word && !is_wave(&factor));
        product.push_str(match (product.is_empty(), apart) {
            (true, _) => "",
            (false, true) => " \\, ",
            (false, false) => " ",
        });
        after_word = is_word(&factor);
        product.push_str(&factor);
    }
    product
}

/// Products with the same dependence on the state; parts are coefficients of parameters and numbers.
struct Group {
    state: Powers,
    parts: Vec<(Powers, Number)>,
}

impl Group {
    /// Powers that all parts have, and the number with its sign that can be taken out of them.
    fn common(&self) -> (Powers, Number) {
        let mut common = self.parts[0].0.clone();
        for (powers, _) in &self.parts[1..] {
            common.retain(|id, halves| match powers.get(id) {
                Some(&other) if other.signum() == halves.signum() => {
                    // Half powers are taken out whole or not at all.
                    let least = if *halves > 0 { other.min(*halves) } else { other.max(*halves) };
                    let whole = (other - least) % 2 == 0 && (*halves - least) % 2 == 0;
                    *halves = least;
                    whole
                }
                _ => false,
            });
        }
        let first = self.parts[0].1;
        let same = self.parts.iter().all(|(_, number)| *number == first || *number == -first);
        let sign = if first.is_negative() { -Number::ONE } else { Number::ONE };
        (common, if same { first } else { sign })
    }
}

/// The order of terms in a sum.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct GroupOrder {
    acceleration: u32,
    velocities: Reverse<i32>,
    waves: usize,
    places: Vec<(Place, Reverse<i32>)>,
}

impl GroupOrder {
    fn shares_acceleration(&self, other: &GroupOrder) -> bool {
        self.acceleration != u32::MAX && self.acceleration == other.acceleration
    }
}

/// 1 for even functions, −1 for odd ones, 0 for others.
fn parity(function: Function) -> i32 {
    match function {
        Function::Cos | Function::Cosh | Function::Abs => 1,
        Function::Sin | Function::Tan | Function::Asin | Function::Atan => -1,
        Function::Sinh | Function::Tanh | Function::Signum => -1,
        Function::Acos | Function::Exp | Function::Ln => 0,
    }
}

/// `argument` has brackets where it needs them, `bare` has none.
fn shape(function: Function, argument: String, bare: &str) -> Shape {
    let closed = |name: &str| Shape::Closed(applied(name, &argument));
    match function {
        Function::Sin => Shape::Named("\\sin", argument),
        Function::Cos => Shape::Named("\\cos", argument),
        Function::Tan => Shape::Named("\\tan", argument),
        Function::Sinh => Shape::Named("\\sinh", argument),
        Function::Cosh => Shape::Named("\\cosh", argument),
        Function::Tanh => Shape::Named("\\tanh", argument),
        Function::Asin => closed("\\arcsin"),
        Function::Acos => closed("\\arccos"),
        Function::Atan => closed("\\arctan"),
        Function::Ln => closed("\\ln"),
        Function::Signum => closed("\\operatorname{sgn}"),
        Function::Exp => Shape::Closed(format!("e^{{{bare}}}")),
        // Its bars are all the brackets it needs.
        Function::Abs => Shape::Symbol(format!("\\left|{bare}\\right|")),
    }
}

/// A positive number: an integer, a fraction or a decimal, as people write it.
fn number(value: Number) -> String {
    let (numerator, denominator) = numerator_and_denominator(value);
    if denominator == "1" { numerator } else { format!("\\frac{{{numerator}}}{{{denominator}}}") }
}

fn numerator_and_denominator(value: Number) -> (String, String) {
    let Number::Exact { numerator, denominator, pi } = value else { return (decimal(value), "1".to_string()) };
    let digits = || if pi == 0 { decimal(value) } else { decimal(value * power_of_pi(-pi)) };
    let terminates = (0..19).fold(denominator, |rest, _| match () {
        () if rest % 5 == 0 => rest / 5,
        () if rest % 2 == 0 => rest / 2,
        () => rest,
    }) == 1;
    // 3/8 and 2/5 are fractions, 9.81 and 0.05 are decimals.
    let fraction = denominator <= 4 || denominator == 8 || denominator == 16 || (denominator == 5 && numerator < 10);
    let long = numerator > 999_999 || denominator > 9_999;
    let (above, below) = match denominator {
        1 if !long => (numerator.to_string(), 1),
        _ if !long && (fraction || !terminates) => (numerator.to_string(), denominator),
        _ => (digits(), 1),
    };
    let symbol = script_power("\\pi", pi.unsigned_abs());
    let with = |number: String| match (number.as_str(), symbol.as_str()) {
        (_, "") => number,
        ("1", _) => symbol.clone(),
        _ => format!("{number} {symbol}"),
    };
    if pi >= 0 { (with(above), below.to_string()) } else { (above, with(below.to_string())) }
}

fn power_of_pi(n: i8) -> Number {
    Number::PI.power(2 * i32::from(n)).unwrap_or(Number::ONE)
}

fn script_power(base: &str, exponent: u8) -> String {
    match exponent {
        0 => String::new(),
        1 => base.to_string(),
        n => format!("{base}{}", script('^', &n.to_string())),
    }
}

/// The shortest decimal, `6.67 \cdot 10^{-11}` for very large and very small ones.
fn decimal(value: Number) -> String {
    let text = format!("{:?}", value.to_f64());
    let text = text.strip_suffix(".0").unwrap_or(&text);
    match text.split_once('e') {
        Some(("1", exponent)) => format!("10^{{{exponent}}}"),
        Some((digits, exponent)) => format!("{digits} \\cdot 10^{{{exponent}}}"),
        None => text.to_string(),
    }
}

/// How the symbols of a mechanism are written.
struct Notation {
    coordinates: Vec<Name>,
    parameters: Vec<Name>,
    inputs: Vec<Name>,
    prescribed: Vec<Name>,
    /// Where each parameter stands in a product.
    ranks: Vec<u32>,
}

impl Notation {
    fn of(lagrangian: &Lagrangian<'_>) -> Self {
        let mut taken: BTreeSet<String> = ["t".to_string()].into();
        let mut names = |variables: &[Variable]| -> Vec<Name> {
            let names = component_names(variables);
            names.iter().map(|declared| Name::unlike(&mut taken, declared)).collect()
        };
        let coordinates = names(&lagrangian.coordinates);
        let parameters = names(&lagrangian.parameters);
        let inputs = names(&lagrangian.inputs);
        let prescribed = names(&lagrangian.prescribed);
        let ranks = ranks(&lagrangian.parameters, &parameters);
        Notation { coordinates, parameters, inputs, prescribed, ranks }
    }

    fn symbol(&self, symbol: Symbol) -> String {
        match symbol {
            Symbol::Time => "t".to_string(),
            Symbol::Coordinate(i) => self.coordinates[i as usize].text(),
            Symbol::Velocity(i) => self.coordinates[i as usize].accented("\\dot"),
            Symbol::Acceleration(i) => self.coordinates[i as usize].accented("\\ddot"),
            Symbol::Parameter(i) => self.parameters[i as usize].text(),
            Symbol::Input(i) => self.inputs[i as usize].text(),
            Symbol::Prescribed(i, 0) => self.prescribed[i as usize].text(),
            Symbol::Prescribed(i, 1) => self.prescribed[i as usize].accented("\\dot"),
            Symbol::Prescribed(i, _) => self.prescribed[i as usize].accented("\\ddot"),
            Symbol::Multiplier(i) => format!("\\lambda_{{{}}}", i + 1),
        }
    }
}

/// `m g l`: coefficients before gravity before lengths, one letter's symbols together, else as declared.
fn ranks(parameters: &[Variable], names: &[Name]) -> Vec<u32> {
    let units = parameters.iter().flat_map(|variable| std::iter::repeat_n(variable.unit.as_str(), variable.count()));
    let kind = |unit: &str| match unit {
        unit if unit.contains("kg") || unit.contains(['N', 'J', 'W']) => 0,
        "m/s^2" | "m/s/s" | "m*s^-2" => 1,
        _ => 2,
    };
    let letter = |name: &Name| names.iter().position(|other| other.stem == name.stem);
    let mut order: Vec<_> =
        units.zip(names).enumerate().map(|(i, (unit, name))| (kind(unit), letter(name), i)).collect();
    order.sort();
    let mut ranks = vec![0; order.len()];
    for (rank, (_, _, i)) in order.into_iter().enumerate() {
        ranks[i] = rank as u32;
    }
    ranks
}

fn component_names_of(coordinates: &[Name]) -> BTreeMap<String, String> {
    coordinates.iter().map(|name| (name.declared.clone(), name.text())).collect()
}

/// A letter with its subscripts.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Name {
    declared: String,
    stem: String,
    subscript: String,
}

impl Name {
    /// `theta1` → θ₁, `m_bob` → m with the subscript bob, `lc2` → l with c2, `Ixx` → I with xx.
    fn new(declared: &str) -> Self {
        let mut parts = declared.split('_').filter(|part| !part.is_empty());
        let first = parts.next().unwrap_or("x");
        let word = first.trim_end_matches(|c: char| c.is_ascii_digit());
        let (word, digits) = if word.is_empty() { (first, "") } else { (word, &first[word.len()..]) };
        let (stem, mut letters) = stem_and_letters(word);
        letters.push_str(digits);
        let subscripts: Vec<String> =
            std::iter::once(letters).filter(|text| !text.is_empty()).chain(parts.map(subscript_part)).collect();
        Name { declared: declared.to_string(), stem, subscript: subscripts.join(",") }
    }

    /// A name that looks like none of those taken: `m1` beside `m_1` is written out.
    fn unlike(taken: &mut BTreeSet<String>, declared: &str) -> Self {
        let mut name = Name::new(declared);
        if taken.contains(&name.text()) {
            let stem = format!("\\mathrm{{{}}}", declared.replace('_', "\\_"));
            name = Name { declared: declared.to_string(), stem, subscript: String::new() };
        }
        while taken.contains(&name.text()) {
            name.stem = format!("\\tilde{{{}}}", name.stem);
        }
        taken.insert(name.text());
        name
    }

    fn text(&self) -> String {
        if self.subscript.is_empty() { self.stem.clone() } else { subscripted(&self.stem, &self.subscript) }
    }

    fn accented(&self, accent: &str) -> String {
        let stem = format!("{accent}{{{}}}", self.stem);
        if self.subscript.is_empty() { stem } else { subscripted(&stem, &self.subscript) }
    }
}

/// The letter of a word, and what of it becomes a subscript.
fn stem_and_letters(word: &str) -> (String, String) {
    let letters: Vec<char> = word.chars().collect();
    match (greek(word), letters.as_slice()) {
        (Some(command), _) => (command, String::new()),
        (None, [letter]) => (letter.to_string(), String::new()),
        (None, [letter, one]) => (letter.to_string(), one.to_string()),
        (None, [letter, axes @ ..]) if axes.iter().all(|c| "xyz".contains(*c)) => {
            (letter.to_string(), axes.iter().collect())
        }
        _ => (format!("\\mathrm{{{word}}}"), String::new()),
    }
}

/// Digits, single letters and axes in italics, words upright.
fn subscript_part(part: &str) -> String {
    let word = part.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = &part[word.len()..];
    let italic = word.chars().count() <= 1 || word.chars().all(|c| "xyz".contains(c));
    match greek(word) {
        Some(command) if digits.is_empty() => command,
        Some(command) => format!("{command} {digits}"),
        None if italic => part.to_string(),
        None => format!("\\mathrm{{{word}}}{digits}"),
    }
}

fn greek(word: &str) -> Option<String> {
    const LOWER: [&str; 28] = [
        "alpha",
        "beta",
        "gamma",
        "delta",
        "epsilon",
        "zeta",
        "eta",
        "theta",
        "iota",
        "kappa",
        "lambda",
        "mu",
        "nu",
        "xi",
        "pi",
        "rho",
        "sigma",
        "tau",
        "upsilon",
        "phi",
        "chi",
        "psi",
        "omega",
        "ell",
        "varphi",
        "vartheta",
        "varepsilon",
        "varrho",
    ];
    const UPPER: [&str; 11] =
        ["Gamma", "Delta", "Theta", "Lambda", "Xi", "Pi", "Sigma", "Upsilon", "Phi", "Psi", "Omega"];
    (LOWER.contains(&word) || UPPER.contains(&word)).then(|| format!("\\{word}"))
}

fn subscripted(stem: &str, subscript: &str) -> String {
    format!("{stem}{}", script('_', subscript))
}

/// `_1`, `_{12}`
fn script(mark: char, text: &str) -> String {
    if text.chars().count() == 1 { format!("{mark}{text}") } else { format!("{mark}{{{text}}}") }
}

/// `$q_0, q_1$`, `$q_0, \dots, q_9$`
fn listed(names: &[String]) -> String {
    match names {
        [first, _, _, .., last] => format!("${first}, \\dots, {last}$"),
        few => format!("${}$", few.join(", ")),
    }
}

/// `kg*m^2/s^2` as mathematics, upright.
fn unit(text: &str) -> String {
    let mut unit = String::new();
    let mut rest = text.chars().filter(|c| !c.is_whitespace()).peekable();
    while let Some(c) = rest.next() {
        match c {
            '*' => unit.push_str("\\,"),
            '^' => {
                let in_brackets = rest.next_if_eq(&'(').is_some();
                let mut exponent = String::new();
                let belongs = |c: &char| c.is_ascii_digit() || *c == '-' || (in_brackets && *c == '/');
                while let Some(digit) = rest.next_if(belongs) {
                    exponent.push(digit);
                }
                if in_brackets {
                    rest.next_if_eq(&')');
                }
                unit.push_str(&script('^', &exponent));
            }
            c if c.is_ascii_alphanumeric() || "/().-".contains(c) => unit.push(c),
            _ => {}
        }
    }
    format!("$\\mathrm{{{unit}}}$")
}

/// A text that stays within a comment.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::routes;
    use crate::expr::{Vector, evaluate};

    fn output(lagrangian: &Lagrangian<'_>) -> String {
        let graph = Graph::new();
        latex(lagrangian, &routes(lagrangian, &graph))
    }

    fn double_pendulum(graph: &Graph) -> Lagrangian<'_> {
        let mut l = Lagrangian::new(graph, "DoublePendulum");
        l.docs = vec!["Two point masses".to_string(), "on massless rods.".to_string()];
        let [a, b] = ["theta1", "theta_2"].map(|name| l.coordinate(name, "rad", None)[0]);
        // Lengths before masses: products do not depend on it.
        let [l1, l2] = ["l1", "l2"].map(|name| l.parameter(name, "m", Number::ONE));
        let [m1, m2] = ["m1", "m2"].map(|name| l.parameter(name, "kg", Number::ONE));
        let g = l.parameter("g", "m/s^2", Number::ONE);
        let upper = Vector([l1 * a.sin(), graph.integer(0), -l1 * a.cos()]);
        let lower = upper + Vector([l2 * b.sin(), graph.integer(0), -l2 * b.cos()]);
        for (mass, [x, _, z]) in [(m1, upper.0), (m2, lower.0)] {
            l.kinetic.push(mass * (x.rate().powi(2) + z.rate().powi(2)) / 2);
            l.potential.push(mass * g * z);
        }
        l
    }

    fn cart_pole(graph: &Graph) -> Lagrangian<'_> {
        let mut l = Lagrangian::new(graph, "CartPole");
        let [x, theta] = [("x", "m"), ("theta", "rad")].map(|(name, unit)| l.coordinate(name, unit, None)[0]);
        let [cart, bob] = ["M", "m_bob"].map(|name| l.parameter(name, "kg", Number::ONE));
        let length = l.parameter("length", "m", Number::ONE);
        let g = l.parameter("g", "m/s^2", Number::ONE);
        let b = l.parameter("b", "N*s/m", Number::ONE);
        let push = l.input("F", "N", None)[0];
        let [px, pz] = [x + length * theta.sin(), -length * theta.cos()];
        l.kinetic.push(cart * x.rate().powi(2) / 2 + bob * (px.rate().powi(2) + pz.rate().powi(2)) / 2);
        l.potential.push(bob * g * pz);
        l.dissipation.push(b * x.rate().powi(2) / 2);
        l.forces.push((0, push));
        l
    }

    fn spherical_pendulum(graph: &Graph) -> Lagrangian<'_> {
        let mut l = Lagrangian::new(graph, "SphericalPendulum");
        let [theta, phi] = ["theta", "phi"].map(|name| l.coordinate(name, "rad", None)[0]);
        let [m, length, g] =
            [("m", "kg"), ("l", "m"), ("g", "m/s^2")].map(|(name, unit)| l.parameter(name, unit, Number::ONE));
        let bob = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), -theta.cos()].map(|x| length * x);
        let [vx, vy, vz] = bob.map(|x| x.rate().powi(2));
        l.kinetic.push(m * (vx + vy + vz) / 2);
        l.potential.push(m * g * bob[2]);
        l
    }

    /// A particle with terms of every shape.
    fn contrived(graph: &Graph) -> Lagrangian<'_> {
        let mut l = Lagrangian::new(graph, "Contrived");
        let [x, y] = ["x", "y_c"].map(|name| l.coordinate(name, "m", None)[0]);
        let [m, k, gamma] =
            [("m", "kg"), ("k", "N/m"), ("gamma", "rad")].map(|(n, unit)| l.parameter(n, unit, Number::ONE));
        let u = l.input("u", "N", None)[0];
        let (vx, vy) = (x.rate(), y.rate());
        let t = graph.symbol(Symbol::Time);
        let r = (x.powi(2) + y.powi(2)).sqrt();
        l.kinetic.push(m * (vx.powi(2) + vy.powi(2)) / 2 + m * (2 * (y - x)).sin().powi(2) * vx * vy / 8);
        l.potential.push(-m * k / r + k * (r - 1).powi(2) / 2 + k * (y - x).sqrt() / (y - x));
        l.potential
            .push(graph.constant(Number::PI) / 3 * gamma.sin() * x.cos() * y.cos() * (x - y).call(Function::Tan));
        l.potential.push(k * (y - x).call(Function::Tan).sqrt() + (x / (m + k)).call(Function::Atan) / gamma.sqrt());
        l.potential.push(x.call(Function::Abs).call2(Binary::Powf, gamma) + y.call2(Binary::Atan2, x));
        l.dissipation.push(m * vx.call(Function::Cosh).call(Function::Ln) + (m + k) * vy.powi(2) / 4);
        l.lagrangian.push(k * (x * vy - y * vx) * (-t).call(Function::Exp));
        l.forces.push((0, u * (x - y).cos().powi(3) - m * (y * 3).call(Function::Tanh)));
        l.forces.push((1, graph.constant(Number::Real(6.67e-11)) * u / (x - y).powi(3)));
        l
    }

    #[test]
    fn the_double_pendulum_is_that_of_a_textbook() {
        let graph = Graph::verbatim();
        let text = output(&double_pendulum(&graph));
        let expected = r"
\paragraph{Energies.}
\begin{align*}
  T &= \frac{1}{2} (m_1 + m_2) l_1^2 \dot{\theta}_1^2 + \frac{1}{2} m_2 l_2^2 \dot{\theta}_2^2 + m_2 l_1 l_2 \dot{\theta}_1 \dot{\theta}_2 \cos(\theta_1 - \theta_2) \\
  V &= -(m_1 + m_2) g l_1 \cos\theta_1 - m_2 g l_2 \cos\theta_2
\end{align*}

\paragraph{Terms of $\displaystyle \mathbf{M} \ddot{\mathbf{q}} + \mathbf{C} \dot{\mathbf{q}} + \mathbf{G} = \mathbf{0}$.}
\begin{align*}
  \mathbf{M} &= \begin{bmatrix}
    (m_1 + m_2) l_1^2 & m_2 l_1 l_2 \cos(\theta_1 - \theta_2) \\
    m_2 l_1 l_2 \cos(\theta_1 - \theta_2) & m_2 l_2^2
  \end{bmatrix} \\
  \mathbf{C} &= \begin{bmatrix}
    0 & m_2 l_1 l_2 \dot{\theta}_2 \sin(\theta_1 - \theta_2) \\
    -m_2 l_1 l_2 \dot{\theta}_1 \sin(\theta_1 - \theta_2) & 0
  \end{bmatrix} \\
  \mathbf{G} &= \begin{bmatrix}
    (m_1 + m_2) g l_1 \sin\theta_1 \\
    m_2 g l_2 \sin\theta_2
  \end{bmatrix}
\end{align*}

\paragraph{Equations of motion.}
\begin{align*}
  & (m_1 + m_2) l_1^2 \ddot{\theta}_1 + m_2 l_1 l_2 \ddot{\theta}_2 \cos(\theta_1 - \theta_2) + m_2 l_1 l_2 \dot{\theta}_2^2 \sin(\theta_1 - \theta_2) \\
  & \quad {} + (m_1 + m_2) g l_1 \sin\theta_1 = 0 \\
  & m_2 l_1 l_2 \ddot{\theta}_1 \cos(\theta_1 - \theta_2) + m_2 l_2^2 \ddot{\theta}_2 - m_2 l_1 l_2 \dot{\theta}_1^2 \sin(\theta_1 - \theta_2) + m_2 g l_2 \sin\theta_2 = 0
\end{align*}
";
        assert!(text.contains(expected), "{text}");
        assert!(text.starts_with("% DoublePendulum\n% Two point masses\n% on massless rods.\n"), "{text}");
    }

    #[test]
    fn the_cart_pole_has_dissipation_and_an_input() {
        let graph = Graph::verbatim();
        let text = output(&cart_pole(&graph));
        for expected in [
            r"
  \mathbf{M} &= \begin{bmatrix}
    M + m_{\mathrm{bob}} & m_{\mathrm{bob}} \, \mathrm{length} \cos\theta \\
    m_{\mathrm{bob}} \, \mathrm{length} \cos\theta & m_{\mathrm{bob}} \, \mathrm{length}^2
  \end{bmatrix} \\
",
            r"
  \partial D / \partial \dot{\mathbf{q}} &= \begin{bmatrix}
    b \dot{x} \\
    0
  \end{bmatrix} \\
  \mathbf{Q} &= \begin{bmatrix}
    F \\
    0
  \end{bmatrix}
",
            r"
  (M + m_{\mathrm{bob}}) \ddot{x} + m_{\mathrm{bob}} \, \mathrm{length} \, \ddot{\theta} \cos\theta - m_{\mathrm{bob}} \, \mathrm{length} \, \dot{\theta}^2 \sin\theta + b \dot{x} &= F \\
  m_{\mathrm{bob}} \, \mathrm{length} \, \ddot{x} \cos\theta + m_{\mathrm{bob}} \, \mathrm{length}^2 \, \ddot{\theta} + m_{\mathrm{bob}} g \, \mathrm{length} \sin\theta &= 0
",
            r"\paragraph{Conserved where $F = 0$ and $D = 0$.}",
            r"  p_x &= (M + m_{\mathrm{bob}}) \dot{x} + m_{\mathrm{bob}} \, \mathrm{length} \, \dot{\theta} \cos\theta",
            r"  $b$ & parameter & $\mathrm{N\,s/m}$ \\",
        ] {
            assert!(text.contains(expected), "{expected}\nis not in\n{text}");
        }
    }

    #[test]
    fn the_spherical_pendulum_has_squares_of_sines() {
        let graph = Graph::verbatim();
        let text = output(&spherical_pendulum(&graph));
        for expected in [
            r"T &= \frac{1}{2} m l^2 \dot{\theta}^2 + \frac{1}{2} m l^2 \dot{\phi}^2 \sin^2\theta",
            r"
    m l^2 & 0 \\
    0 & m l^2 \sin^2\theta
",
            r"
    0 & -m l^2 \dot{\phi} \sin\theta \cos\theta \\
    m l^2 \dot{\phi} \sin\theta \cos\theta & m l^2 \dot{\theta} \sin\theta \cos\theta
",
            r"
  m l^2 \ddot{\theta} - m l^2 \dot{\phi}^2 \sin\theta \cos\theta + m g l \sin\theta &= 0 \\
  m l^2 \ddot{\phi} \sin^2\theta + 2 m l^2 \dot{\theta} \dot{\phi} \sin\theta \cos\theta &= 0
",
            r"p_{\phi} &= m l^2 \dot{\phi} \sin^2\theta",
        ] {
            assert!(text.contains(expected), "{expected}\nis not in\n{text}");
        }
    }

    #[test]
    fn names_are_letters_with_subscripts() {
        let name = |declared: &str| Name::new(declared).text();
        assert_eq!(["theta", "theta1", "theta_1", "Omega"].map(name), [r"\theta", r"\theta_1", r"\theta_1", r"\Omega"]);
        assert_eq!(
            ["m2", "m_bob", "m_bob2", "m12"].map(name),
            ["m_2", r"m_{\mathrm{bob}}", r"m_{\mathrm{bob}2}", "m_{12}"]
        );
        assert_eq!(["q_3", "q_10", "k_1_2", "i_xx_0"].map(name), ["q_3", "q_{10}", "k_{1,2}", "i_{xx,0}"]);
        assert_eq!(["lc1", "Ixx", "mu", "g"].map(name), ["l_{c1}", "I_{xx}", r"\mu", "g"]);
        assert_eq!(["length", "k_phi", "_a"].map(name), [r"\mathrm{length}", r"k_{\phi}", "a"]);
        assert_eq!(Name::new("theta1").accented("\\dot"), r"\dot{\theta}_1");
        let mut taken = BTreeSet::new();
        assert_eq!(["m_1", "m1"].map(|n| Name::unlike(&mut taken, n).text()), ["m_1", r"\mathrm{m1}"]);
        assert_eq!(unit("kg*m^2/s^(-1/2)"), r"$\mathrm{kg\,m^2/s^{-1/2}}$");
    }

    #[test]
    fn numbers_are_fractions_where_people_write_fractions() {
        let written = |text: &str| number(Number::parse_decimal(text).unwrap_or(Number::ZERO));
        assert_eq!(
            ["2", "0.5", "0.4", "9.81", "0.05", "1e-11"].map(written),
            ["2", r"\frac{1}{2}", r"\frac{2}{5}", "9.81", "0.05", "1 \\cdot 10^{-11}"]
                .map(|text| text.replace("1 \\cdot ", ""))
        );
        assert_eq!(number(Number::PI * Number::rational(3, 2).unwrap_or(Number::ONE)), r"\frac{3 \pi}{2}");
        assert_eq!(number(Number::Real(1.5e-11)), r"1.5 \cdot 10^{-11}");
    }

    #[test]
    fn what_is_too_long_is_left_out_and_said_so() {
        let graph = Graph::verbatim();
        let mut l = Lagrangian::new(&graph, "Long");
        let x = l.coordinate("x", "m", None)[0];
        let k = l.parameter_array("k", "N/m", vec![Number::ONE; 50]);
        l.kinetic.push(x.rate().powi(2) / 2);
        (1..).zip(k).for_each(|(i, k)| l.potential.push(k * (i * x).cos()));
        let text = output(&l);
        assert!(text.contains("% Left out: V (50 terms; "), "{text}");
        assert!(text.contains("V &= \\ldots\n") && text.contains("\\ldots &= 0\n"), "{text}");

        let mut chain = Lagrangian::new(&graph, "Chain");
        let q = chain.coordinate("q", "m", Some(6));
        q.iter().for_each(|q| chain.kinetic.push(q.rate().powi(2) / 2));
        let text = output(&chain);
        assert!(text.contains(r"$\mathbf{M}$ & $6 \times 6$ & 0 operations"), "{text}");
        assert!(!text.contains("bmatrix"));
    }

    #[test]
    fn nothing_recurses_on_the_depth_of_an_expression() {
        let graph = Graph::verbatim();
        let mut l = Lagrangian::new(&graph, "Deep");
        let x = l.coordinate("x", "m", None)[0];
        l.kinetic.push(x.rate().powi(2) / 2);
        let plain = Graph::new();
        let deep = (0..100_000).fold(plain.symbol(Symbol::Coordinate(0)), |deep, _| deep.sin());
        let mut algebra = algebra(&l, &plain);
        assert!(matches!(algebra.shortest(deep).map(|sum| algebra.entry(Some(sum))), None | Some(Entry::TooLong(_))));
    }

    #[test]
    fn braces_and_brackets_are_balanced() {
        let graph = Graph::verbatim();
        for l in [double_pendulum(&graph), cart_pole(&graph), spherical_pendulum(&graph), contrived(&graph)] {
            let text = output(&l);
            for (open, close) in [("{", "}"), ("(", ")"), ("\\left", "\\right"), ("\\begin", "\\end")] {
                assert_eq!(text.matches(open).count(), text.matches(close).count(), "{open} in\n{text}");
            }
            assert!(!text.contains("+ -") && !text.contains("- -") && !text.contains("  +"), "{text}");
        }
    }

    #[test]
    fn what_is_written_is_what_was_derived() {
        let verbatim = Graph::verbatim();
        for l in [double_pendulum(&verbatim), cart_pole(&verbatim), spherical_pendulum(&verbatim), contrived(&verbatim)]
        {
            let graph = Graph::new();
            let equations = &routes(&l, &graph)[0];
            let lagrange = &equations.lagrange;
            let mut algebra = algebra(&l, &graph);
            let values: BTreeMap<String, f64> =
                symbols(equations).into_iter().map(|s| (algebra.notation.symbol(s), value_of(s))).collect();
            let check = |value: Expr<'_>, text: String| {
                let expected: f64 = evaluate(&[value], value_of)[0];
                let read = Reader { rest: &text, values: &values }.sum();
                assert!(
                    (read - expected).abs() <= 1e-9 * expected.abs().max(1.0),
                    "{}: {text}: {read} {expected}",
                    l.name
                );
            };
            let matrices = [lagrange.mass_matrix.concat(), lagrange.coriolis_matrix.concat()].concat();
            let vectors = [&lagrange.gravity, &lagrange.dissipation_force, &lagrange.generalized_force].map(Vec::clone);
            let energies = [lagrange.kinetic_energy, lagrange.potential_energy].to_vec();
            for value in [matrices, vectors.concat(), energies, lagrange.inverse_dynamics.clone()].concat() {
                let sum = algebra.shortest(value).unwrap_or_default();
                check(value, algebra.text(&sum).unwrap_or_default());
            }
            for (i, &value) in lagrange.inverse_dynamics.iter().enumerate() {
                let sum = algebra.left_side(equations, i).unwrap_or_default();
                check(value, algebra.text(&sum).unwrap_or_default());
            }
        }
    }

    fn algebra<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Algebra<'g> {
        Algebra { graph, notation: Notation::of(lagrangian), sums: BTreeMap::new(), atoms: BTreeMap::new() }
    }

    fn symbols(equations: &Equations<'_>) -> Vec<Symbol> {
        let s = &equations.symbols;
        [&s.q, &s.qd, &s.qdd, &s.u, &s.parameters, &vec![Symbol::Time]].map(Vec::clone).concat()
    }

    /// Coordinates grow, so that the roots in `contrived` exist.
    fn value_of(symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Time => 0.37,
            Symbol::Coordinate(i) => 0.31 + 0.53 * f64::from(i),
            Symbol::Velocity(i) => 0.71 - 0.29 * f64::from(i),
            Symbol::Acceleration(i) => -0.43 + 0.97 * f64::from(i),
            Symbol::Parameter(i) => 0.83 + 0.19 * f64::from(i),
            Symbol::Input(i) => 0.61 + 0.11 * f64::from(i),
            Symbol::Prescribed(..) | Symbol::Multiplier(_) => unreachable!("none in these mechanisms"),
        }
    }

    /// Reads what is written, for its value.
    struct Reader<'a> {
        rest: &'a str,
        values: &'a BTreeMap<String, f64>,
    }

    impl Reader<'_> {
        fn accepts(&mut self, token: &str) -> bool {
            let rest = self.rest.trim_start_matches([' ']).trim_start_matches("\\,").trim_start();
            let found = rest.strip_prefix(token);
            self.rest = found.unwrap_or(rest);
            found.is_some()
        }

        fn ends(&mut self) -> bool {
            self.accepts("");
            self.rest.is_empty()
                || [")", "}", "\\right", "+", "-", ",", "/"].iter().any(|end| self.rest.starts_with(end))
        }

        fn sum(&mut self) -> f64 {
            let mut sum = if self.accepts("-") { -self.product() } else { self.product() };
            loop {
                sum += match (self.accepts("+"), self.accepts("-")) {
                    (true, _) => self.product(),
                    (_, true) => -self.product(),
                    _ => return sum,
                };
            }
        }

        fn product(&mut self) -> f64 {
            let mut product = 1.0;
            while !self.ends() {
                let factor = self.factor();
                product *= factor.powf(self.exponent());
            }
            product
        }

        fn exponent(&mut self) -> f64 {
            match (self.accepts("^{"), self.rest.strip_prefix('^')) {
                (true, _) => {
                    let exponent = self.sum();
                    let exponent = if self.accepts("/") { exponent / self.sum() } else { exponent };
                    assert!(self.accepts("}"), "{}", self.rest);
                    exponent
                }
                (_, Some(rest)) => {
                    self.rest = &rest[1..];
                    rest[..1].parse().unwrap_or(f64::NAN)
                }
                _ => 1.0,
            }
        }

        fn closed_by(&mut self, close: &str) -> f64 {
            let value = self.sum();
            assert!(self.accepts(close), "{close} expected: {}", self.rest);
            value
        }

        fn factor(&mut self) -> f64 {
            type Named = (&'static str, fn(f64) -> f64);
            const FUNCTIONS: [Named; 9] = [
                ("\\sinh", f64::sinh),
                ("\\cosh", f64::cosh),
                ("\\tanh", f64::tanh),
                ("\\sin", f64::sin),
                ("\\cos", f64::cos),
                ("\\tan", f64::tan),
                ("\\arctan", f64::atan),
                ("\\ln", f64::ln),
                ("\\operatorname{sgn}", f64::signum),
            ];
            for (name, function) in FUNCTIONS {
                if self.accepts(name) {
                    let exponent = self.exponent();
                    return function(self.factor()).powf(exponent);
                }
            }
            if self.accepts("\\frac{") {
                let above = self.closed_by("}");
                assert!(self.accepts("{"));
                return above / self.closed_by("}");
            }
            if self.accepts("\\operatorname{atan2}(") {
                let y = self.closed_by(",");
                return y.atan2(self.closed_by(")"));
            }
            for (open, close) in [("(", ")"), ("\\left(", "\\right)"), ("\\left|", "\\right|")] {
                if self.accepts(open) {
                    let value = self.closed_by(close);
                    return if open.ends_with('|') { value.abs() } else { value };
                }
            }
            if self.accepts("\\sqrt{") {
                return self.closed_by("}").sqrt();
            }
            for (constant, value) in [("\\pi", std::f64::consts::PI), ("e", std::f64::consts::E), ("\\cdot", 1.0)] {
                if self.accepts(constant) {
                    return value;
                }
            }
            let digits = self.rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(self.rest.len());
            if digits > 0 {
                let value = self.rest[..digits].parse().unwrap_or(f64::NAN);
                self.rest = &self.rest[digits..];
                return value;
            }
            let longest = self.values.iter().filter(|(name, _)| self.rest.starts_with(name.as_str()));
            let Some((name, &value)) = longest.max_by_key(|(name, _)| name.len()) else { panic!("read {}", self.rest) };
            self.rest = &self.rest[name.len()..];
            value
        }
    }
}
