//! The page and its blocks.

use std::collections::btree_map::Entry::Vacant;
use std::collections::{BTreeMap, BTreeSet};

use crate::derive::textbook::MOST_TERMS;
use crate::derive::{Equations, Rows, time_derivative};
use crate::expr::normal::combination::Polynomial;
use crate::expr::{Expr, Graph, Id, Node, carry_out};
use crate::model::Lagrangian;

use super::algebra::Algebra;
use super::layout::{Entry, LINE, LINES, width};
use super::notation::{Name, Notation, by_declared_name, listed, subscripted, unit};
use super::prose::{escaped, paragraphs};

/// Nothing that is not in every installation.
const PREAMBLE: &str = "\
\\documentclass{article}
\\usepackage[utf8]{inputenc}
\\usepackage[T1]{fontenc}
\\usepackage{amsmath}
\\usepackage[a4paper, margin=20mm]{geometry}
\\setlength{\\parindent}{0pt}
\\begin{document}
";

/// What is written so far.
pub(super) struct Page<'g> {
    algebra: Algebra<'g>,
    /// Comments about entries that were too long, for the block that is being written.
    left_out: Vec<String>,
    pub(super) text: String,
}

impl<'g> Page<'g> {
    pub(super) fn new(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Self {
        let algebra = Algebra::new(graph, Notation::of(lagrangian));
        Page { algebra, left_out: Vec::new(), text: String::new() }
    }

    pub(super) fn title(&mut self, lagrangian: &Lagrangian<'_>) {
        let docs = paragraphs(&lagrangian.docs);
        let docs = if docs.is_empty() { docs } else { format!("{docs}\n") };
        let name = escaped(&lagrangian.name);
        self.text.push_str(&format!("{PREAMBLE}\n\\section*{{{name}}}\n{docs}"));
    }

    pub(super) fn end(&mut self) {
        self.text.push_str("\n\\end{document}\n");
    }

    pub(super) fn symbols(&mut self, lagrangian: &Lagrangian<'_>) {
        let notation = &self.algebra.notation;
        let kinds = [
            ("coordinate", &lagrangian.coordinates, &notation.coordinates),
            ("parameter", &lagrangian.parameters, &notation.parameters),
            ("input", &lagrangian.inputs, &notation.inputs),
            ("prescribed", &lagrangian.prescribed, &notation.prescribed),
        ];
        let mut rows = String::new();
        for (kind, variables, names) in kinds {
            for variable in variables {
                let names: Vec<String> =
                    names.iter().skip(variable.first).take(variable.count()).map(Name::text).collect();
                let docs = escaped(&one_line(&variable.docs.join(" ")));
                let docs = if docs.is_empty() { docs } else { format!(" & {docs}") };
                let row = format!("  {} & {kind} & {}{docs} \\\\\n", listed(&names), unit(&variable.unit));
                rows.push_str(&row);
            }
        }
        let q: Vec<String> = lagrangian.coordinates.iter().map(|variable| notation.components(variable)).collect();
        let q = q.join(", ");
        let table = format!("\\begin{{tabular}}{{lllp{{0.55\\linewidth}}}}\n{rows}\\end{{tabular}}\n");
        self.text.push_str(&format!("\n\\paragraph{{Symbols.}} $\\mathbf{{q}} = ({q})^{{\\mathsf{{T}}}}$.\n\n{table}"));
    }

    pub(super) fn energies(&mut self, lagrangian: &Lagrangian<'_>, equations: &Equations<'g>) {
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

    pub(super) fn terms(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
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

    pub(super) fn equations_of_motion(&mut self, equations: &Equations<'g>) {
        let lagrange = &equations.lagrange;
        let mut rows = Vec::new();
        let reactions = equations.constraints.force(lagrange.momentum.len(), self.algebra.graph);
        let forces = lagrange.generalized_force.iter().zip(reactions).map(|(&force, reaction)| force + reaction);
        for (i, (&left, right)) in lagrange.inverse_dynamics.iter().zip(forces).enumerate() {
            let forms = [self.algebra.left_side(equations, i), self.algebra.shortest(left)];
            let shortest = self.algebra.shortest_of(forms.into_iter().flatten().collect());
            let left = self.written(&format!("the left side of equation {}", i + 1), left, shortest);
            let left = match left {
                // Its terms stand above.
                Entry::TooLong(_) => Entry::of_text(subscripted(
                    &format!("\\bigl({}\\bigr)", left_side(equations)),
                    &(i + 1).to_string(),
                )),
                Entry::Written(_) => left,
            };
            let right = self.entry(&format!("the right side of equation {}", i + 1), right);
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
        rows.extend(self.matrix("\\mathbf{A}", "A", &constraints.jacobian));
        rows.extend(self.matrix("\\boldsymbol{\\gamma}", "\\gamma", &column(&constraints.bias)));
        let title =
            "Constraints, $\\displaystyle \\mathbf{A} \\ddot{\\mathbf{q}} + \\boldsymbol{\\gamma} = \\mathbf{0}$.";
        self.block(title, rows);
    }

    /// What stands in for the matrices and equations of a large mechanism.
    pub(super) fn sizes(&mut self, equations: &Equations<'g>) {
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

    pub(super) fn conserved(&mut self, equations: &Equations<'g>) {
        let coordinates = by_declared_name(&self.algebra.notation.coordinates);
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

    /// `name = value = 0`
    fn equation(&mut self, name: &str, value: Expr<'g>) -> Vec<String> {
        let entry = self.entry(name, value);
        vec![format!("{name} &= {} = 0", entry.lines().join(" \\\\\n  &\\quad "))]
    }

    /// `name = [entries]`; entries that are too wide get a name and a row of their own.
    fn matrix(&mut self, name: &str, letter: &str, rows: &Rows<'g>) -> Vec<String> {
        let columns = rows[0].len();
        if !has_any(&rows.concat()) {
            let zero = if rows.len() * columns == 1 { "0" } else { "\\mathbf{0}" };
            return vec![format!("{name} &= {zero}")];
        }
        if rows.len() * columns == 1 {
            return self.definition(name, rows[0][0]);
        }
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

    fn written(&mut self, name: &str, value: Expr<'g>, sum: Option<Polynomial>) -> Entry {
        let sum = sum.map(|sum| self.algebra.with_squares(sum));
        let entry = self.algebra.entry(sum);
        if let Entry::TooLong(terms) = entry {
            let terms = if terms == 0 { format!("more than {MOST_TERMS} terms") } else { format!("{terms} terms") };
            let name = if name.starts_with("the ") { name.to_string() } else { format!("${name}$") };
            self.left_out.push(format!("{name} ({terms}; generated in {} operations)", operations(&[value])));
        }
        entry
    }

    fn block(&mut self, title: &str, rows: Vec<String>) {
        let rows: Vec<String> = rows.into_iter().map(|row| format!("  {row}")).collect();
        let left_out: Vec<String> = self.left_out.drain(..).collect();
        let left_out = match left_out.as_slice() {
            [] => String::new(),
            all => format!("Not written out, because multiplied out they are long: {}.\n", all.join(", ")),
        };
        let rows = rows.join(" \\\\\n");
        let align = format!("\\begin{{align*}}\n{rows}\n\\end{{align*}}");
        let long = align.lines().count() > LINES;
        let align = if long { format!("{{\\allowdisplaybreaks\n{align}}}") } else { align };
        self.text.push_str(&format!("\n\\paragraph{{{title}}}\n{align}\n{left_out}"));
    }
}

/// `M q̈ + C q̇ + G + ∂D/∂q̇`, without what is zero.
fn left_side(equations: &Equations<'_>) -> String {
    let has_dissipation = has_any(&equations.lagrange.dissipation_force);
    let dissipation = if has_dissipation { " + \\partial D / \\partial \\dot{\\mathbf{q}}" } else { "" };
    format!("\\mathbf{{M}} \\ddot{{\\mathbf{{q}}}} + \\mathbf{{C}} \\dot{{\\mathbf{{q}}}} + \\mathbf{{G}}{dissipation}")
}

/// `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`, without what is zero.
fn equation_of_motion(equations: &Equations<'_>) -> String {
    let lagrange = &equations.lagrange;
    let forces = has_any(&lagrange.generalized_force).then_some("\\mathbf{Q}");
    let reactions = (equations.constraints.count() > 0).then_some("\\mathbf{A}^{\\mathsf{T}} \\boldsymbol{\\lambda}");
    let right: Vec<&str> = forces.into_iter().chain(reactions).collect();
    let right = if right.is_empty() { "\\mathbf{0}".to_string() } else { right.join(" + ") };
    format!("{} = {right}", left_side(equations))
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

/// A text on one line.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
