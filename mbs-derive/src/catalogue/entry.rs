//! What an entry says of a function.

use crate::equations::{Derivatives, Equations, ForwardDynamics, Route, Rows};
use crate::expr::{Expr, Node, Symbol};
use crate::shape::{ResultPart, Shape};

/// A generated function.
pub(crate) struct Entry {
    /// Its name in generated code, in `mbs ops` and in `mbs eval`; an output's or a reaction's name stands before it.
    pub name: &'static str,
    /// What it takes beside t and prescribed motions; of an output or a reaction also what its roots depend on.
    pub arguments: &'static [Argument],
    /// What it computes, in which shape; `None` where there is no such function.
    pub roots: for<'g> fn(&Equations<'g>, usize) -> Option<Roots<'g>>,
    /// The first line of its documentation.
    pub doc: fn(&About<'_>) -> String,
    /// Units, the meaning of rows and columns, and where there are no results.
    pub notes: fn(&About<'_>) -> Vec<String>,
    /// The trait of the runtime that it is a function of.
    pub of_trait: Option<Trait>,
    /// What is proved of it.
    pub claim: Claim,
}

/// An argument of a generated function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Argument {
    /// q
    Q,
    /// q̇
    Qd,
    /// q̈
    Qdd,
    /// u
    U,
    /// λ
    Multipliers,
}

impl Argument {
    /// What it is called in generated code and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Argument::Q => "q",
            Argument::Qd => "qd",
            Argument::Qdd => "qdd",
            Argument::U => "u",
            Argument::Multipliers => "multipliers",
        }
    }
}

/// What is still to be done with a program's values.
///
/// A solution is one step, whatever it takes: its meaning is the solution of its system. Right sides come part by part,
/// each as many rows as the system has; where the program depends on q̈ (or λ), forward dynamics (multipliers) is
/// called first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Completion {
    /// Nothing: they are the results.
    None,
    /// They are the lower triangle of M and then right sides f; the results are `M⁻¹ f`, found by the runtime's LDLᵀ.
    Solve,
    /// They are the lower triangle of M, the rows of A, and then right sides f and c; the results are q̈ of
    /// `M q̈ − Aᵀ λ = f`, `A q̈ = c`, found by the runtime's `constrained_solve`. Of M and A they are the entries that
    /// the mechanism's `elimination` lists where it has one; `sparse_solve` then finds q̈.
    SolveConstrained,
    /// The system of `SolveConstrained`, of which λ are the results.
    SolveMultipliers,
}

impl Completion {
    /// Whether there is a system to be solved.
    pub fn solves(self) -> bool {
        self != Completion::None
    }

    /// Whether there is one with constraints.
    pub fn is_constrained(self) -> bool {
        matches!(self, Completion::SolveConstrained | Completion::SolveMultipliers)
    }
}

/// A trait of the runtime.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trait {
    /// `Dynamics`
    Dynamics,
    /// `Energies`
    Energies,
    /// `Linearized`
    Linearized,
    /// `Constrained`
    Constrained,
    /// `Mechanism`
    Mechanism,
}

impl Trait {
    /// Each after those that it rests on.
    pub(crate) const ALL: [Trait; 5] =
        [Trait::Dynamics, Trait::Energies, Trait::Linearized, Trait::Mechanism, Trait::Constrained];

    /// Its name in the runtime.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Trait::Dynamics => "Dynamics",
            Trait::Energies => "Energies",
            Trait::Linearized => "Linearized",
            Trait::Constrained => "Constrained",
            Trait::Mechanism => "Mechanism",
        }
    }

    /// How many of the numbers of coordinates, inputs and constraint rows it is generic over.
    pub(crate) fn sizes(self) -> usize {
        if self == Trait::Constrained { 3 } else { 2 }
    }

    /// The traits that it extends.
    pub(crate) fn rests_on(self) -> &'static [Trait] {
        match self {
            Trait::Dynamics => &[],
            Trait::Energies | Trait::Linearized | Trait::Constrained => &[Trait::Dynamics],
            Trait::Mechanism => &[Trait::Dynamics, Trait::Energies, Trait::Linearized],
        }
    }
}

/// What is proved at a state, in this order: a claim rests on those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Claim {
    /// T and V are those declared, and the twists that they are made of are the rates of the frames' poses.
    Energies,
    /// `p = ∂L/∂q̇`
    Momentum,
    /// `∂D/∂q̇`
    DissipationForce,
    /// Q is the one declared.
    GeneralizedForce,
    /// `d/dt ∂L/∂q̇ − ∂L/∂q + ∂D/∂q̇`
    InverseDynamics,
    /// `q̇ᵀ M q̇ = 2 L₂`
    MassMatrix,
    /// `M q̈ + h + ∂D/∂q̇` is inverse dynamics.
    Bias,
    /// `C q̇ + G = h`, and C is that of Christoffel's symbols.
    CoriolisMatrix,
    /// The derivatives of inverse dynamics.
    InverseDynamicsJacobian,
    /// The rows are those declared.
    Constraint,
    /// `A q̇ + b` is the rate of φ, or the Pfaffian row.
    ConstraintRate,
    /// `∂(A q̇ + b)/∂q`
    ConstraintRateJacobian,
    /// `A q̈ + γ` is the rate of `A q̇ + b`.
    ConstraintBias,
    /// `M q̈ + h + ∂D/∂q̇ = Q + Aᵀ λ` and `A q̈ + γ = 0`, where accelerations are determined.
    ForwardDynamics,
    /// The derivatives of q̈ in q, q̇ and u, there.
    Linearization,
    /// Those in the parameters, there.
    LinearizationInParameters,
    /// First integrals keep their values along motions with `u = 0`, `D = 0`, there; and the balance of energy.
    Conserved,
    /// Wrenches hold the auxiliary coordinates of joints at zero.
    Reactions,
    /// Outputs are those declared; their velocities and Jacobians are their derivatives.
    Outputs,
}

impl Claim {
    /// Whether it is made only where accelerations are determined.
    pub(crate) fn is_of_accelerations(self) -> bool {
        matches!(
            self,
            Claim::ForwardDynamics | Claim::Linearization | Claim::LinearizationInParameters | Claim::Conserved
        )
    }
}

/// What a function computes, before it is scheduled.
pub(crate) struct Roots<'g> {
    /// What it returns.
    pub results: Vec<ResultPart>,
    /// The values of its program: of the results, or of a system to be completed.
    pub values: Vec<Expr<'g>>,
    /// What is still to be done with them.
    pub completion: Completion,
    /// Whether a system of the equations of motion is solved for it, here or at run time.
    pub is_solved: bool,
}

impl<'g> Roots<'g> {
    /// One value of this shape.
    pub(crate) fn of(shape: Shape, values: Vec<Expr<'g>>) -> Option<Self> {
        Self::parts([("", shape)], values)
    }

    /// Several values by name.
    pub(crate) fn parts<const N: usize>(parts: [(&'static str, Shape); N], values: Vec<Expr<'g>>) -> Option<Self> {
        let results = parts.map(|(name, shape)| ResultPart { name, shape }).to_vec();
        Some(Roots { results, values, completion: Completion::None, is_solved: false })
    }

    /// One for each coordinate, constraint or first integral.
    pub(crate) fn vector(values: &[Expr<'g>]) -> Option<Self> {
        Self::of(Shape::Vector(values.len()), values.to_vec())
    }

    /// q̈, of which nothing is left to be solved.
    pub(crate) fn accelerations(values: &[Expr<'g>]) -> Option<Self> {
        Self::vector(values).map(|roots| Roots { is_solved: true, ..roots })
    }

    /// Rows of this length.
    pub(crate) fn matrix(rows: &Rows<'g>, columns: usize) -> Option<Self> {
        Self::of(Shape::Matrix(rows.len(), columns), rows.concat())
    }

    /// The derivatives of inverse dynamics.
    pub(crate) fn inverse_dynamics_jacobian(e: &Equations<'g>, derivatives: &Derivatives<'g>) -> Option<Self> {
        let (jacobian, square) =
            (&derivatives.inverse_dynamics_jacobian, Shape::Matrix(e.symbols.q.len(), e.symbols.q.len()));
        Roots::parts([("q", square), ("qd", square)], [jacobian.q.concat(), jacobian.qd.concat()].concat())
    }

    /// The derivatives of q̈ in the state and the inputs.
    pub(crate) fn linearization(e: &Equations<'g>, derivatives: &Derivatives<'g>) -> Option<Self> {
        let [q, qd, u] = &derivatives.linearization.state;
        let by = |name, inputs: usize| (name, Shape::Matrix(e.symbols.q.len(), inputs));
        let parts = [by("q", e.symbols.q.len()), by("qd", e.symbols.qd.len()), by("u", e.symbols.u.len())];
        Roots::parts(parts, [q.concat(), qd.concat(), u.concat()].concat())?.solved_by(&e.forward_dynamics)
    }

    /// The derivatives of a solution, which is found with `self` as right sides: with the system before them.
    pub(crate) fn solved_by(self, forward: &ForwardDynamics<'g>) -> Option<Self> {
        let completion = match (&forward.factorization, forward.jacobian.len()) {
            (Some(_), _) => Completion::None,
            (None, 0) => Completion::Solve,
            (None, _) => Completion::SolveConstrained,
        };
        let (m, a) = (&forward.mass_matrix, &forward.jacobian);
        let entry = |&[i, j]: &[usize; 2]| if i < m.len() { m[i][j] } else { a[i - m.len()][j] };
        let system = match (completion, &forward.elimination) {
            (Completion::None, _) => Vec::new(),
            (_, Some(elimination)) => elimination.entries.iter().map(entry).collect(),
            // The lower triangle of M, then A.
            (_, None) => [lower_triangle(m), a.concat()].concat(),
        };
        Some(Roots { values: [system, self.values].concat(), completion, is_solved: true, ..self })
    }

    /// The arguments that the values depend on.
    pub(crate) fn arguments(&self) -> impl Iterator<Item = Argument> {
        let ids = || self.values.iter().map(|value| value.id());
        let nodes = self.values.first().map(|first| {
            let graph = first.graph();
            graph.reachable(ids()).into_iter().map(move |id| graph.node(id))
        });
        nodes.into_iter().flatten().filter_map(|node| match node {
            Node::Symbol(Symbol::Coordinate(_)) => Some(Argument::Q),
            Node::Symbol(Symbol::Velocity(_)) => Some(Argument::Qd),
            Node::Symbol(Symbol::Acceleration(_)) => Some(Argument::Qdd),
            Node::Symbol(Symbol::Input(_)) => Some(Argument::U),
            Node::Symbol(Symbol::Multiplier(_)) => Some(Argument::Multipliers),
            _ => None,
        })
    }
}

/// A symmetric matrix is one's lower triangle, row by row.
pub(super) fn lower_triangle<'g>(m: &Rows<'g>) -> Vec<Expr<'g>> {
    m.iter().enumerate().flat_map(|(i, row)| row[..=i].to_vec()).collect()
}

/// What the documentation of a function depends on.
pub(crate) struct About<'a> {
    /// The output or the reaction that it is of, as declared.
    pub of: &'a str,
    /// Of what it returns first.
    pub shape: Shape,
    pub route: Route,
    pub arguments: &'a [Argument],
    pub parameters: Vec<String>,
    /// The rows of the constraints.
    pub constraints: &'a [String],
    /// Whether systems with constraints are eliminated in a known order.
    pub is_eliminated: bool,
    /// The first integrals.
    pub conserved: &'a [String],
    /// What forces are in, which are conjugate to the coordinates; `None` where the mechanism has no units.
    pub force_units: Option<String>,
    /// Whether the output has poses, a velocity, and changes while the coordinates stand still.
    pub is_pose: bool,
    pub has_velocity: bool,
    pub is_rheonomic: bool,
    /// The doc comments of the reaction.
    pub declared: Vec<String>,
}

impl About<'_> {
    /// A sentence about the units of forces, where there are units.
    pub(crate) fn forces(&self, what: &str) -> Vec<String> {
        self.force_units.iter().map(|units| format!("{what}: {units}.")).collect()
    }

    pub(crate) fn in_joules(&self) -> &'static str {
        if self.force_units.is_some() { " in J" } else { "" }
    }

    pub(crate) fn is_constrained(&self) -> bool {
        !self.constraints.is_empty()
    }

    /// What the rows of constraints are.
    pub(crate) fn rows(&self) -> Vec<String> {
        vec![format!("Rows are the constraints: `{}`.", self.constraints.join("`, `"))]
    }

    /// What there is where accelerations are not determined.
    pub(crate) fn where_singular(&self) -> Vec<String> {
        let text = match self.is_constrained() {
            true if self.is_eliminated => {
                "Where a coordinate has no inertia, or rows contradict each other, all results are NaN; the integrators \
                 report that."
            }
            false => {
                "Where `M` is singular the results are infinite, NaN or rounding; the integrators report what is not \
                 finite."
            }
            true => {
                "Where a motion that `A` leaves has no inertia, or rows contradict each other, all results are NaN; the \
                 integrators report that."
            }
        };
        vec![text.to_string()]
    }
}
