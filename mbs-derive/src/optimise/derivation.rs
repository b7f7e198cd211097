//! A mechanism with all its Programs.

use std::ops::Deref;

use super::{Function, Program};
use crate::expr::Elimination;
use crate::model::Reaction;
use crate::model::requirement::Requirement;
use crate::variable::Variable;

/// A mechanism ready to be proved, emitted or interpreted.
///
/// With the feature `serde` it can be written and read again, by the same version of this crate; reading does not prove
/// it.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let names: Vec<&str> = analysis.programs().functions.iter().map(|f| f.name.as_str()).collect();
/// assert!(names.contains(&"forward_dynamics"));
/// ```
///
/// Everybody reads it, as a struct with the fields `name`, `docs`, `coordinates`, `parameters`, `inputs`,
/// `prescribed`, `constraints`, `constraint_vectors`, `holonomic`, `constraint_units`, `reactions`, `conserved`,
/// `output_units`, `depends_on_time`, `constructor`, `requirements`, `required`, `elimination` and `functions`; this
/// pass alone writes it. It may be [altered](Derivation::altered) to see that a proof notices.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Derivation(pub(in crate::optimise) Derived);

impl Derivation {
    /// To be changed: what was proved of it holds no longer.
    pub fn altered(&mut self) -> &mut Derived {
        &mut self.0
    }
}

impl Deref for Derivation {
    type Target = Derived;

    fn deref(&self) -> &Derived {
        &self.0
    }
}

/// The parts of a [`Derivation`].
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Derived {
    /// In upper camel case, as declared.
    pub name: String,
    /// Doc comments.
    pub docs: Vec<String>,
    /// Generalized coordinates.
    pub coordinates: Vec<Variable>,
    /// Parameters.
    pub parameters: Vec<Variable>,
    /// Inputs.
    pub inputs: Vec<Variable>,
    /// Prescribed motions, each with two derivatives; where there are any, all functions take them.
    pub prescribed: Vec<Variable>,
    /// The rows of the constraints by name: `closure`, or `closure_0`, `closure_1`, ….
    pub constraints: Vec<String>,
    /// For each row the first one of the same constraint in the same unit: those are the components of a vector.
    pub constraint_vectors: Vec<usize>,
    /// Which of the rows are holonomic.
    pub holonomic: Vec<bool>,
    /// The units of the rows and of their multipliers, in SI base units.
    pub constraint_units: Vec<[String; 2]>,
    /// Joints whose wrenches are asked for.
    pub reactions: Vec<Reaction>,
    /// The first integrals by name: `energy_integral`, or `p_` and the coordinate.
    pub conserved: Vec<String>,
    /// The units of the components of the outputs in declaration order, in SI base units: `kg·m²/s²`.
    pub output_units: Vec<Vec<String>>,
    /// Whether any function depends on t; then all of them take it.
    pub depends_on_time: bool,
    /// From parameters to the values that depend on them alone, computed once.
    pub constructor: Program,
    /// What parameters must satisfy.
    pub requirements: Vec<Requirement>,
    /// From parameters to the numbers that the requirements are about, `Condition::count` for each in turn.
    pub required: Program,
    /// How systems with constraints are eliminated, where most of their entries are zero.
    pub elimination: Option<Elimination>,
    /// The generated functions, in the order of the documentation.
    pub functions: Vec<Function>,
}
