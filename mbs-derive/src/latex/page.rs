//! The page and its blocks.

use std::collections::btree_map::Entry::Vacant;
use std::collections::{BTreeMap, BTreeSet};

use crate::derive::textbook::MOST_COORDINATES;
use crate::derive::{Equations, Rows};
use crate::expr::normal::combination::Polynomial;
use crate::expr::{Expr, Id, Node, Number};
use crate::model::Lagrangian;
use crate::shape::Shape;
use crate::variable::Variable;

use super::algebra::Algebra;
use super::layout::{Entry, LINE, LINES, LONG_LINE, width};
use super::notation::{Name, Notation, listed, subscripted, unit};
use super::number::decimal;
use super::plan::{Entries, Part, Shown, carried_out, conserved_name, locals, parts, shown};
use super::prose::{escaped, paragraphs};
use super::recursion::{Called, KEY, packed};

/// Nothing that is not in every installation.
const PREAMBLE: &str = "\
\\documentclass{article}
\\usepackage[utf8]{inputenc}
\\usepackage[T1]{fontenc}
\\usepackage[fleqn]{amsmath}
\\usepackage{array}
\\usepackage[a4paper, margin=20mm]{geometry}
\\setlength{\\parindent}{0pt}
\\renewcommand{\\arraystretch}{1.2}
\\newcolumntype{L}[1]{>{\\raggedright\\arraybackslash}p{#1\\linewidth}}
\\begin{document}
";

/// Functions of more operations are left out: nobody reads that.
const MOST_OPERATIONS: usize = 20_000;

/// Entries of more lines are written by recursion, where there are abbreviations.
const MOST_LINES: usize = 4;

/// Where the abbreviations go once all are known.
const ABBREVIATIONS: &str = "%abbreviations%\n";

/// Tables of symbols have this many rows on a page.
const ROWS: usize = 40;

/// What stands on a line if it cannot be broken: entries that do not fit are written by recursion.
const WIDEST_LINE: usize = 96;

/// Expressions of more operations are not tried to be multiplied out, where there are abbreviations.
const MOST_MULTIPLIED_OUT: usize = 300;

/// What is written so far.
pub(super) struct Page<'g> {
    pub(super) algebra: Algebra<'g>,
    /// What is too long to be multiplied out: the same by the cheapest route, and the function that computes it; no
    /// expression where the function is too long, too.
    long: BTreeMap<Id, (Option<Expr<'g>>, String)>,
    /// What is not on the page, for the block that is being written.
    left_out: Vec<String>,
    pub(super) text: String,
}

impl<'g> Page<'g> {
    pub(super) fn new(lagrangian: &Lagrangian<'_>, routes: &[Equations<'g>]) -> Self {
        let graph = routes[0].lagrange.kinetic_energy.graph();
        let mut algebra = Algebra::new(graph, Notation::of(lagrangian));
        algebra.abbreviates = lagrangian.dof() > MOST_COORDINATES;
        let mut page = Page { algebra, long: BTreeMap::new(), left_out: Vec::new(), text: String::new() };
        page.plan(lagrangian, routes);
        page
    }

    /// Finds what is too long to be multiplied out.
    fn plan(&mut self, lagrangian: &Lagrangian<'_>, routes: &[Equations<'g>]) {
        let mut planned = Vec::new();
        for Shown { function, closed, recursive, names } in shown(lagrangian, routes, &self.algebra.notation) {
            let too_long: Vec<_> = closed
                .into_iter()
                .zip(recursive.into_iter().zip(names))
                .filter(|(closed, _)| !self.long.contains_key(&closed.id()) && !self.fits(*closed))
                .collect();
            let roots: Vec<Expr<'g>> = too_long.iter().map(|(_, (recursive, _))| *recursive).collect();
            let is_shown = operations(&roots) <= MOST_OPERATIONS;
            for (closed, (recursive, name)) in too_long {
                self.long.insert(closed.id(), (is_shown.then_some(recursive), function.clone()));
                if is_shown {
                    planned.push(recursive.id());
                    self.algebra.label(recursive, Called::Exactly(name));
                }
            }
        }
        for (local, value) in locals(lagrangian, self.algebra.graph) {
            self.algebra.label(value, local);
        }
        self.algebra.plan(&planned);
    }

    fn fits(&mut self, value: Expr<'g>) -> bool {
        if self.algebra.abbreviates && operations(&[value]) > MOST_MULTIPLIED_OUT {
            return false;
        }
        let shortest = self.algebra.shortest(value);
        match self.multiplied_out(shortest) {
            Entry::TooLong => false,
            entry => !self.algebra.abbreviates || entry.lines().len() <= MOST_LINES,
        }
    }

    pub(super) fn title(&mut self, lagrangian: &Lagrangian<'_>) {
        let docs = paragraphs(&lagrangian.docs);
        let docs = if docs.is_empty() { docs } else { format!("{docs}\n") };
        let name = escaped(&lagrangian.name);
        self.text.push_str(&format!("{PREAMBLE}\n\\section*{{{name}}}\n{docs}"));
    }

    /// The page with its end, and with its abbreviations where they have their place.
    pub(super) fn finished(self) -> String {
        let Page { algebra, mut text, .. } = self;
        text.push_str("\n\\end{document}\n");
        let abbreviations = abbreviations(&algebra, &text);
        text.replacen(ABBREVIATIONS, &abbreviations, 1)
    }

    pub(super) fn symbols(&mut self, lagrangian: &Lagrangian<'_>) {
        let notation = &self.algebra.notation;
        let kinds = [
            ("coordinate", &lagrangian.coordinates, &notation.coordinates),
            ("parameter", &lagrangian.parameters, &notation.parameters),
            ("input", &lagrangian.inputs, &notation.inputs),
            ("prescribed", &lagrangian.prescribed, &notation.prescribed),
        ];
        let mut rows = Vec::new();
        for (kind, variables, names) in kinds {
            for variable in variables {
                let names: Vec<String> =
                    names.iter().skip(variable.first).take(variable.count()).map(Name::text).collect();
                let docs = escaped(&one_line(&variable.docs.join(" ")));
                let cells = [listed(&names), kind.to_string(), unit(&variable.unit), defaults(variable), docs];
                let row = cells.join(" & ");
                rows.push(format!("  {} \\\\\n", row.trim_end_matches([' ', '&'])));
            }
        }
        let q: Vec<String> = lagrangian.coordinates.iter().map(|variable| notation.components(variable)).collect();
        let q = q.join(", ");
        self.text.push_str(&format!("\n\\paragraph{{Symbols.}} $\\mathbf{{q}} = ({q})^{{\\mathsf{{T}}}}$.\n"));
        let head = "  symbol & & unit & default & meaning \\\\ \\hline\n";
        let columns = "{@{}L{0.21}llL{0.18}L{0.3}@{}}";
        for rows in rows.chunks(ROWS) {
            let rows = rows.concat();
            let table = format!("\\begin{{tabular}}{columns}\n{head}{rows}\\end{{tabular}}\n");
            self.text.push_str(&format!("\n\\begin{{small}}\n{table}\\end{{small}}\n"));
        }
        self.text.push_str(ABBREVIATIONS);
    }

    pub(super) fn energies(&mut self, lagrangian: &Lagrangian<'_>, equations: &Equations<'g>) {
        let graph = self.algebra.graph;
        let mut rows = self.definition("T", equations.lagrange.kinetic_energy);
        rows.extend(self.definition("V", equations.lagrange.potential_energy));
        if !lagrangian.lagrangian.is_empty() {
            rows.extend(self.definition("L - T + V", carried_out(&lagrangian.lagrangian, graph)));
        }
        let [dissipation, _] = lagrangian.dissipation_without_and_with_inputs();
        if !dissipation.is_empty() {
            rows.extend(self.definition("D", carried_out(&dissipation, graph)));
        }
        self.block("Energies.", rows);
    }

    /// Values and Jacobians of what was declared with `output`.
    pub(super) fn outputs(&mut self, lagrangian: &Lagrangian<'_>, equations: &Equations<'g>) {
        for (declared, output) in lagrangian.outputs.iter().zip(&equations.outputs) {
            let mut rows = Vec::new();
            for Part { symbol, entries, rows: values } in parts(output) {
                if values.iter().any(|row| !row.is_empty()) {
                    rows.extend(self.matrix(&symbol, &entries, &values));
                }
            }
            let docs = escaped(&one_line(&declared.docs.join(" ")));
            let of = match (output.shape, &output.velocity) {
                (Shape::Pose | Shape::Poses(_), _) => {
                    "position $\\mathbf{p}$, rotation $\\mathbf{R}$; $\\mathbf{J} \\dot{\\mathbf{q}}$ is the velocity of \
                     the origin, then the angular velocity, in world axes"
                }
                (_, Some(_)) => "$\\mathbf{J}$ is its derivative by $\\mathbf{q}$",
                (_, None) => {
                    "its derivatives are $\\mathbf{J}$ by $\\mathbf{q}$, $\\mathbf{K}$ by $\\dot{\\mathbf{q}}$, \
                     $\\mathbf{L}$ by the inputs"
                }
            };
            self.block(&format!("Output \\texttt{{{}}}.", escaped(&output.name)), rows);
            let title = format!("\\paragraph{{Output \\texttt{{{}}}.}}\n", escaped(&output.name));
            let sentence = format!("{docs}{}({of}.)\n", if docs.is_empty() { "" } else { " " });
            self.text = self.text.replacen(&title, &format!("{title}{sentence}"), 1);
        }
    }

    pub(super) fn terms(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let title = format!("Terms of $\\displaystyle {}$.", equation_of_motion(equations));
        let dissipation = "\\partial D / \\partial \\dot{\\mathbf{q}}";
        let matrices = [
            ("\\mathbf{M}", "M", lagrange.mass_matrix.clone()),
            ("\\mathbf{C}", "C", lagrange.coriolis_matrix.clone()),
            ("\\mathbf{G}", "G", column(&lagrange.gravity)),
            (dissipation, "R", column(&lagrange.dissipation_force)),
            ("\\mathbf{Q}", "Q", column(&lagrange.generalized_force)),
        ];
        let mut rows = Vec::new();
        let is_shown = |letter: &str, values: &Rows<'g>| !matches!(letter, "R" | "Q") || has_any(&values.concat());
        for (name, letter, values) in matrices.into_iter().filter(|(_, letter, values)| is_shown(letter, values)) {
            let own = self.matrix(name, &Entries::new(letter), &values);
            if self.algebra.abbreviates {
                let heading = format!("The term ${name}$ of $\\displaystyle {}$.", equation_of_motion(equations));
                self.block(&heading, own);
            } else {
                rows.extend(own);
            }
        }
        if !rows.is_empty() {
            self.block(&title, rows);
        }
    }

    pub(super) fn equations_of_motion(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let (mut rows, mut new) = (Vec::new(), false);
        let reactions = equations.constraints.force(lagrange.momentum.len(), self.algebra.graph);
        let forces = lagrange.generalized_force.iter().zip(reactions).map(|(&force, reaction)| force + reaction);
        for (i, (&left, right)) in lagrange.inverse_dynamics.iter().zip(forces).enumerate() {
            let forms = [self.algebra.left_side(equations, i), self.algebra.shortest(left)];
            let shortest = self.algebra.shortest_of(forms.into_iter().flatten().collect());
            let left = self.multiplied_out(shortest);
            let shortest = self.algebra.shortest(right);
            let right = self.multiplied_out(shortest);
            new |= matches!(left, Entry::Written(_));
            let [left, right] = [(left, left_side(equations)), (right, right_side(equations))].map(|(entry, sum)| {
                // Its terms stand above.
                let above = || subscripted(&format!("\\bigl({sum}\\bigr)"), &(i + 1).to_string());
                if matches!(entry, Entry::TooLong) { Entry::of_text(above()) } else { entry }
            });
            rows.push((left.lines(), right.lines()));
        }
        // Where nothing new is said it has been said above.
        if !new {
            return;
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

    /// What must vanish, A, and γ.
    pub(super) fn constraints(&mut self, lagrangian: &Lagrangian<'_>, equations: &Equations<'g>) {
        let constraints = &equations.constraints;
        if constraints.count() == 0 {
            return;
        }
        let holonomic = lagrangian.holonomic_rows();
        let mut rows = Vec::new();
        for (i, (&value, holonomic)) in constraints.value.iter().zip(holonomic).enumerate() {
            let number = (i + 1).to_string();
            if holonomic {
                rows.extend(self.equation(&subscripted("\\varphi", &number), value));
            } else {
                let [a, b] = ["\\mathbf{a}", "b"].map(|letter| subscripted(letter, &number));
                rows.extend(self.equation(&format!("{a} \\dot{{\\mathbf{{q}}}} + {b}"), value));
            }
        }
        rows.extend(self.matrix("\\mathbf{A}", &Entries::new("A"), &constraints.jacobian));
        rows.extend(self.matrix("\\boldsymbol{\\gamma}", &Entries::new("\\gamma"), &column(&constraints.bias)));
        let title =
            "Constraints, $\\displaystyle \\mathbf{A} \\ddot{\\mathbf{q}} + \\boldsymbol{\\gamma} = \\mathbf{0}$.";
        self.block(title, rows);
    }

    pub(super) fn conserved(&mut self, equations: &Equations<'g>) {
        let mut rows = Vec::new();
        for quantity in &equations.conserved {
            let name = conserved_name(&quantity.name, &self.algebra.notation);
            rows.extend(self.definition(&name, quantity.value));
        }
        if !equations.conserved.is_empty() {
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
        if entry.lines() == [name] {
            return Vec::new();
        }
        vec![format!("{name} &= {}", entry.lines().join(" \\\\\n  &\\quad "))]
    }

    /// `name = value = 0`
    fn equation(&mut self, name: &str, value: Expr<'g>) -> Vec<String> {
        let entry = self.entry(name, value);
        if entry.lines() == [name] {
            return vec![format!("{name} &= 0")];
        }
        vec![format!("{name} &= {} = 0", entry.lines().join(" \\\\\n  &\\quad "))]
    }

    /// `name = [entries]`; entries that are too wide get a name and a row of their own.
    fn matrix(&mut self, name: &str, names: &Entries, rows: &Rows<'g>) -> Vec<String> {
        let columns = rows[0].len();
        if !has_any(&rows.concat()) {
            let zero = if rows.len() * columns == 1 { "0" } else { "\\mathbf{0}" };
            return vec![format!("{name} &= {zero}")];
        }
        if rows.len() * columns == 1 {
            return self.definition(name, rows[0][0]);
        }
        let named = |i: usize, j: usize| names.name(i, j, columns);
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
                    if width(&inline) <= widest || inline == named(i, j) {
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

    /// Multiplied out, or by recursion where that is too long.
    fn entry(&mut self, name: &str, value: Expr<'g>) -> Entry {
        let entry = match self.long.get(&value.id()) {
            Some((Some(recursive), _)) => self.algebra.recursive(*recursive),
            Some((None, _)) => Entry::TooLong,
            None => {
                let shortest = self.algebra.shortest(value);
                self.multiplied_out(shortest)
            }
        };
        if let Entry::TooLong = entry {
            let function = self.long.get(&value.id()).map_or("", |(_, function)| function);
            let computed = format!("\\texttt{{{}}} computes it", escaped(function));
            self.left_out.push(format!("${name}$ ({} operations; {computed})", operations(&[value])));
        }
        entry
    }

    fn multiplied_out(&mut self, sum: Option<Polynomial>) -> Entry {
        let sum = sum.map(|sum| self.algebra.with_squares(sum));
        let entry = self.algebra.entry(sum);
        // A line that is one product cannot be broken.
        if entry.lines().iter().any(|line| width(line) > WIDEST_LINE) { Entry::TooLong } else { entry }
    }

    fn block(&mut self, title: &str, rows: Vec<String>) {
        self.text.push_str(&format!("\n\\paragraph{{{title}}}\n"));
        let definitions: Vec<_> = self.algebra.recursion.definitions.drain(..).collect();
        self.align(packed(&definitions, LONG_LINE));
        self.align(rows);
        let left_out: Vec<String> = self.left_out.drain(..).collect();
        if !left_out.is_empty() {
            let listed = left_out.join(", ");
            self.text.push_str(&format!("Too long for this page; of the generated functions: {listed}.\n"));
        }
    }

    fn align(&mut self, rows: Vec<String>) {
        if rows.is_empty() {
            return;
        }
        let rows: Vec<String> = rows.into_iter().map(|row| format!("  {row}")).collect();
        let rows = rows.join(" \\\\\n");
        let align = format!("\\begin{{align*}}\n{rows}\n\\end{{align*}}");
        let long = align.lines().count() > LINES;
        let align = if long { format!("{{\\allowdisplaybreaks\n{align}}}") } else { align };
        self.text.push_str(&format!("{align}\n"));
    }
}

/// Sines and cosines, and what the letters of the recursion mean.
fn abbreviations(algebra: &Algebra<'_>, page: &str) -> String {
    let mut text = String::new();
    let used = algebra.notation.waves.iter().filter(|(name, _)| page.contains(name.as_str()));
    let waves: Vec<_> = used.map(|(name, is)| (name.clone(), vec![is.clone()])).collect();
    if !waves.is_empty() {
        let rows: Vec<String> = packed(&waves, LONG_LINE).into_iter().map(|row| format!("  {row}")).collect();
        let align = format!("\\begin{{align*}}\n{}\n\\end{{align*}}\n", rows.join(" \\\\\n"));
        text.push_str(&format!("\n\\paragraph{{Abbreviations.}}\n{align}"));
    }
    let key = KEY.iter().filter(|(letter, _, _)| algebra.recursion.letters.contains(letter));
    let key: Vec<String> = key.map(|(_, letter, meaning)| format!("${letter}_j$ {meaning}")).collect();
    if !algebra.recursion.named.is_empty() {
        text.push_str(NAMED);
    }
    if !key.is_empty() {
        text.push_str(&format!("\n{KEY_HEAD} {}.\n", key.join("; ")));
    }
    text
}

const NAMED: &str = "\n\\paragraph{Intermediate results} have names and are used under them from there on, on the whole page: \
                     $b_i$, $k_i$ of parameters alone, those of \\texttt{let} and \\texttt{fn} of the declaration, counted \
                     from 1 where they are repeated, and those of entries.\n";

const KEY_HEAD: &str = "In recursions, $j$ is the number of a joint, from 1 at the base; components $x$, $y$, $z$ are in axes \
                        fixed in the link behind it, about its origin. What differs by its axes alone, or is a part of \
                        what is named, has a letter more in its subscript:";

/// `M q̈ + C q̇ + G + ∂D/∂q̇`, without what is zero.
fn left_side(equations: &Equations<'_>) -> String {
    let has_dissipation = has_any(&equations.lagrange.dissipation_force);
    let dissipation = if has_dissipation { " + \\partial D / \\partial \\dot{\\mathbf{q}}" } else { "" };
    format!("\\mathbf{{M}} \\ddot{{\\mathbf{{q}}}} + \\mathbf{{C}} \\dot{{\\mathbf{{q}}}} + \\mathbf{{G}}{dissipation}")
}

/// `Q + Aᵀ λ`, without what is zero.
fn right_side(equations: &Equations<'_>) -> String {
    let forces = has_any(&equations.lagrange.generalized_force).then_some("\\mathbf{Q}");
    let reactions = (equations.constraints.count() > 0).then_some("\\mathbf{A}^{\\mathsf{T}} \\boldsymbol{\\lambda}");
    let right: Vec<&str> = forces.into_iter().chain(reactions).collect();
    if right.is_empty() { "\\mathbf{0}".to_string() } else { right.join(" + ") }
}

/// `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`, without what is zero.
fn equation_of_motion(equations: &Equations<'_>) -> String {
    format!("{} = {}", left_side(equations), right_side(equations))
}

fn column<'g>(entries: &[Expr<'g>]) -> Rows<'g> {
    entries.iter().map(|&entry| vec![entry]).collect()
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
        Node::Call(..)
        | Node::Call2(..)
        | Node::Spline(..)
        | Node::Less(..)
        | Node::LessEqual(..)
        | Node::And(..)
        | Node::Not(_)
        | Node::Select(..) => true,
    };
    graph.reachable(entries.iter().map(|entry| entry.id())).iter().filter(|id| computes(id)).count()
}

/// Default values of a parameter, those that are all the same once.
fn defaults(variable: &Variable) -> String {
    let degrees = variable.declared_unit.as_deref() == Some("deg");
    let values = variable.defaults.iter().map(|&value| if degrees { in_degrees(value) } else { signed(value) });
    let values: Vec<String> = values.collect();
    match values.as_slice() {
        [] => String::new(),
        [first, rest @ ..] if rest.iter().all(|value| value == first) => format!("${first}$"),
        all => all.iter().map(|value| format!("${value}$")).collect::<Vec<_>>().join(", "),
    }
}

/// `12^\circ`, rounded to what anybody writes.
fn in_degrees(value: Number) -> String {
    let degrees = format!("{:.9}", value.to_f64().to_degrees());
    format!("{}^\\circ", degrees.trim_end_matches('0').trim_end_matches('.'))
}

fn signed(value: Number) -> String {
    if value.is_negative() { format!("-{}", decimal(-value)) } else { decimal(value) }
}

/// A text on one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
