//! Coordinates, parameters and inputs: names, units, defaults.

use crate::expr::Number;

/// A coordinate, parameter or input: one, or an array of them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Variable {
    /// As declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// Its unit as written (`kg`, `N*m`, `1`), in SI base or derived units without prefixes.
    pub unit: String,
    /// How many, where it is an array.
    pub length: Option<usize>,
    /// How many of them are a row, where it is a matrix.
    pub columns: Option<usize>,
    /// The number of its first component among all components of its kind.
    pub first: usize,
    /// Default values of parameters in SI units, one per component; empty for coordinates and inputs.
    pub defaults: Vec<Number>,
    /// The unit that its default was declared in, where that is another: `deg`.
    pub declared_unit: Option<String>,
    /// Whether each component must be positive: a parameter that was declared so.
    pub positive: bool,
}

impl Variable {
    /// How many components.
    pub fn count(&self) -> usize {
        self.length.unwrap_or(1)
    }

    /// Whether the component with this number, among all of its kind, is one of its own.
    pub fn contains(&self, number: usize) -> bool {
        (self.first..self.first + self.count()).contains(&number)
    }

    /// The lengths that it was declared with: `[]`, `[n]`, or `[rows, columns]`.
    pub fn lengths(&self) -> Vec<usize> {
        match (self.length, self.columns) {
            (None, _) => Vec::new(),
            (Some(n), None) => vec![n],
            (Some(n), Some(columns)) => vec![n / columns, columns],
        }
    }

    /// The names of the components: `x`, or `q_0`, `q_1`, …; of a matrix `a_0_0`, `a_0_1`, …, row by row.
    pub fn component_names(&self) -> Vec<String> {
        let name = &self.name;
        match (self.length, self.columns) {
            (None, _) => vec![name.clone()],
            (Some(n), None) => (0..n).map(|i| format!("{name}_{i}")).collect(),
            (Some(n), Some(columns)) => (0..n).map(|i| format!("{name}_{}_{}", i / columns, i % columns)).collect(),
        }
    }
}

/// The names of all components of some variables, flattened in declaration order.
///
/// ```
/// let graph = mbs_derive::expr::Graph::verbatim();
/// let text = "mechanism Balls { coord x[2]: m; kinetic += 1 kg*(dt(x[0])^2 + dt(x[1])^2); }";
/// let (lagrangian, _) = mbs_derive::declared(text, &graph, &[]).unwrap();
/// assert_eq!(mbs_derive::variable::component_names(&lagrangian.coordinates), ["x_0", "x_1"]);
/// ```
pub fn component_names(variables: &[Variable]) -> Vec<String> {
    variables.iter().flat_map(Variable::component_names).collect()
}

/// How many components some variables have.
pub(crate) fn count(variables: &[Variable]) -> usize {
    variables.iter().map(Variable::count).sum()
}
