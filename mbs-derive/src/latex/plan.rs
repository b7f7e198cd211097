//! What a page shows: of each generated function the entries, as they are multiplied out and by the cheapest route.

use crate::derive::{Equations, OutputEquations, Rows, time_derivative};
use crate::expr::normal::weight;
use crate::expr::{Expr, Graph, carry_out};
use crate::model::Lagrangian;
use crate::shape::Shape;

use super::notation::{Name, Notation, subscripted};
use super::recursion::Called;

/// A generated function: what it is called, the entries that are written, as they are multiplied out and by recursion,
/// and the names of these.
pub(super) struct Shown<'g> {
    pub(super) function: String,
    pub(super) closed: Vec<Expr<'g>>,
    pub(super) recursive: Vec<Expr<'g>>,
    pub(super) names: Vec<String>,
}

/// What the entries of a matrix or column are called: a letter, and what stands before the numbers.
#[derive(Clone, Debug)]
pub(super) struct Entries {
    pub(super) letter: String,
    pub(super) prefix: String,
    pub(super) symmetric: bool,
}

impl Entries {
    pub(super) fn new(letter: &str) -> Self {
        Entries { letter: letter.to_string(), prefix: String::new(), symmetric: letter == "M" }
    }

    /// `M_{12}`, `M_{1,12}`, `J_{\mathrm{flange},12}`; of a column `G_1`.
    pub(super) fn name(&self, i: usize, j: usize, columns: usize) -> String {
        let (i, j) = if self.symmetric { (i.min(j), i.max(j)) } else { (i, j) };
        let index = match columns {
            1 => (i + 1).to_string(),
            _ if i < 9 && j < 9 => format!("{}{}", i + 1, j + 1),
            _ => format!("{},{}", i + 1, j + 1),
        };
        let comma = if self.prefix.is_empty() { "" } else { "," };
        subscripted(&self.letter, &format!("{}{comma}{index}", self.prefix))
    }

    fn names(&self, rows: usize, columns: usize) -> Vec<String> {
        (0..rows).flat_map(|i| (0..columns).map(move |j| self.name(i, j, columns))).collect()
    }
}

/// A part of an output: how it is written, its entries' names, and its rows.
pub(super) struct Part<'g> {
    pub(super) symbol: String,
    pub(super) entries: Entries,
    pub(super) rows: Rows<'g>,
}

/// The value of an output in parts, then its Jacobians.
pub(super) fn parts<'g>(output: &OutputEquations<'g>) -> Vec<Part<'g>> {
    let name = Name::new(&output.name);
    let bold = |letter: &str, prefix: &str| format!("\\mathbf{{{letter}}}_{{{prefix}}}");
    let own = name.text();
    let lettered = |letter: &str, prefix: &str, rows: Rows<'g>| Part {
        symbol: bold(letter, prefix),
        entries: Entries { letter: letter.to_string(), prefix: prefix.to_string(), symmetric: false },
        rows,
    };
    let named = |number: Option<usize>, rows: Rows<'g>| {
        let number = number.map(|n| (n + 1).to_string());
        let prefix: Vec<String> =
            [Some(name.subscript.clone()).filter(|text| !text.is_empty()), number].into_iter().flatten().collect();
        let prefix = prefix.join(",");
        let symbol = format!("\\mathbf{{{}}}", subscripted(&name.stem, &prefix));
        Part { symbol, entries: Entries { letter: name.stem.clone(), prefix, symmetric: false }, rows }
    };
    let rows =
        |values: &[Expr<'g>], columns: usize| values.chunks(columns.max(1)).map(<[_]>::to_vec).collect::<Rows<'g>>();
    let pose = |own: &str, values: &[Expr<'g>]| {
        [lettered("p", own, rows(&values[..3], 1)), lettered("R", own, rows(&values[3..12], 3))]
    };
    let value = &output.value;
    let mut parts: Vec<Part<'g>> = match output.shape {
        Shape::Pose => pose(&own, value).into(),
        Shape::Poses(_) => {
            let numbered = value.chunks(12).enumerate();
            numbered.flat_map(|(i, pose_of)| pose(&format!("{own},{}", i + 1), pose_of)).collect()
        }
        Shape::Matrix(_, columns) => vec![named(None, rows(value, columns))],
        Shape::Matrices(_, m, columns) => {
            let matrices = value.chunks((m * columns).max(1)).enumerate();
            matrices.map(|(i, matrix)| named(Some(i), rows(matrix, columns))).collect()
        }
        Shape::Scalar | Shape::Vector(_) | Shape::Symmetric(_) | Shape::Wrench | Shape::Wrenches(_) => {
            vec![named(None, rows(value, 1))]
        }
    };
    parts.push(lettered("J", &own, output.jacobian.clone()));
    parts.extend(output.jacobian_qd.iter().map(|jacobian| lettered("K", &own, jacobian.clone())));
    parts.extend(output.jacobian_u.iter().map(|jacobian| lettered("L", &own, jacobian.clone())));
    parts
}

/// A sum of declared terms, time derivatives carried out.
pub(super) fn carried_out<'g>(terms: &[Expr<'_>], graph: &'g Graph) -> Expr<'g> {
    let terms = carry_out(terms, graph, |symbol| time_derivative(symbol, graph));
    terms.into_iter().fold(graph.integer(0), |sum, term| sum + term)
}

/// What local names and functions of the mechanism stand for, counted from 1 on paper, time derivatives carried out.
pub(super) fn locals<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Vec<(Called, Expr<'g>)> {
    let verbatim: Vec<Expr<'_>> = lagrangian.locals.iter().map(|local| local.value).collect();
    let values = carry_out(&verbatim, graph, |symbol| time_derivative(symbol, graph));
    let called = lagrangian.locals.iter().map(|local| {
        let Name { stem, subscript, .. } = Name::new(&local.name);
        let numbers = local.numbers.iter().map(|number| (number + 1).to_string());
        let parts: Vec<String> = [subscript].into_iter().chain(numbers).chain([local.axis.to_string()]).collect();
        let parts: Vec<&str> = parts.iter().map(String::as_str).filter(|part| !part.is_empty()).collect();
        Called::Like(stem, parts.join(","))
    });
    called.zip(values).collect()
}

/// All that the page shows, in the order of the page.
pub(super) fn shown<'g>(lagrangian: &Lagrangian<'_>, routes: &[Equations<'g>], notation: &Notation) -> Vec<Shown<'g>> {
    let graph = routes[0].lagrange.kinetic_energy.graph();
    let n = lagrangian.dof();
    let shown = |function: &str, names: Vec<String>, roots: &dyn Fn(&Equations<'g>) -> Vec<Expr<'g>>| {
        let recursive = routes.iter().map(roots).min_by_key(|roots| weight(roots)).unwrap_or_default();
        Shown { function: function.to_string(), closed: roots(&routes[0]), recursive, names }
    };
    let (square, column) =
        (|letter: &str| Entries::new(letter).names(n, n), |letter: &str| Entries::new(letter).names(n, 1));
    let mut all = Vec::new();
    for output in &routes[0].outputs {
        for Part { entries, rows, .. } in parts(output) {
            let columns = rows.first().map_or(1, Vec::len);
            let names = entries.names(rows.len(), columns);
            all.push(shown(&output.name, names, &|_| rows.concat()));
        }
    }
    all.push(shown("kinetic_energy", vec!["T".to_string()], &|e| vec![e.lagrange.kinetic_energy]));
    all.push(shown("potential_energy", vec!["V".to_string()], &|e| vec![e.lagrange.potential_energy]));
    let [dissipation, _] = lagrangian.dissipation_without_and_with_inputs();
    let [other, dissipation] = [&lagrangian.lagrangian, &dissipation].map(|terms| carried_out(terms, graph));
    all.push(shown("momentum", vec!["L_{0}".to_string()], &|_| vec![other]));
    all.push(shown("dissipation_force", vec!["D".to_string()], &|_| vec![dissipation]));
    all.push(shown("mass_matrix", square("M"), &|e| e.lagrange.mass_matrix.concat()));
    all.push(shown("coriolis_matrix", square("C"), &|e| e.lagrange.coriolis_matrix.concat()));
    all.push(shown("gravity", column("G"), &|e| e.lagrange.gravity.clone()));
    all.push(shown("dissipation_force", column("R"), &|e| e.lagrange.dissipation_force.clone()));
    all.push(shown("generalized_force", column("Q"), &|e| e.lagrange.generalized_force.clone()));
    let m = routes[0].constraints.count();
    all.push(shown("constraint", Entries::new("\\varphi").names(m, 1), &|e| e.constraints.value.clone()));
    all.push(shown("constraint_jacobian", Entries::new("A").names(m, n), &|e| e.constraints.jacobian.concat()));
    all.push(shown("constraint_bias", Entries::new("\\gamma").names(m, 1), &|e| e.constraints.bias.clone()));
    let names = routes[0].conserved.iter().map(|quantity| conserved_name(&quantity.name, notation)).collect();
    // Of these each route may find others.
    let values: Vec<Expr<'g>> = routes[0].conserved.iter().map(|quantity| quantity.value).collect();
    all.push(shown("conserved", names, &|e| {
        let own: Option<Vec<Expr<'g>>> = routes[0]
            .conserved
            .iter()
            .map(|quantity| e.conserved.iter().find(|other| other.name == quantity.name).map(|other| other.value))
            .collect();
        own.unwrap_or_else(|| values.clone())
    }));
    all
}

/// `E`, `p_\theta`
pub(super) fn conserved_name(name: &str, notation: &Notation) -> String {
    let coordinate =
        name.strip_prefix("p_").and_then(|name| notation.coordinates.iter().find(|known| known.declared == name));
    coordinate.map_or("E".to_string(), |coordinate| subscripted("p", &coordinate.text()))
}
