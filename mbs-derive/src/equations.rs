//! What derivation hands on: the [`Equations`] of a mechanism, expressions in one graph.

use std::fmt;

use crate::expr::{Elimination, Expr, Symbol};
use crate::shape::Shape;

/// Rows of expressions.
pub(crate) type Rows<'g> = Vec<Vec<Expr<'g>>>;

/// The symbols of a mechanism, by kind and in order.
#[derive(Clone, Debug)]
pub(crate) struct Symbols {
    /// q
    pub q: Vec<Symbol>,
    /// q̇
    pub qd: Vec<Symbol>,
    /// q̈
    pub qdd: Vec<Symbol>,
    /// u
    pub u: Vec<Symbol>,
    /// parameters
    pub parameters: Vec<Symbol>,
}

/// How equations were derived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Route {
    /// The energies differentiated.
    Plain,
    /// By differentiation of the energies, in multiple-angle normal form.
    Textbook,
    /// Bodies on their tree of frames by sweeps, all else plainly.
    Structured,
    /// By sweeps, accelerations too: by articulated bodies instead of a factorization of M.
    Articulated,
    /// By sweeps, derivatives of the dynamics too: from composite bodies instead of by differentiation.
    Recursive,
    /// By sweeps, every mass left where it was declared; for comparison.
    Ungrouped,
    /// As in a textbook with all sums multiplied out, whatever digits that costs; for comparison.
    MultipliedOut,
}

impl Route {
    /// All of them, in this order: of equal costs the first one counts.
    pub const ALL: [Route; 7] = [
        Route::Plain,
        Route::Textbook,
        Route::Structured,
        Route::Articulated,
        Route::Recursive,
        Route::Ungrouped,
        Route::MultipliedOut,
    ];
}

impl fmt::Display for Route {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Route::Plain => "plain",
            Route::Textbook => "textbook",
            Route::Structured => "structured",
            Route::Articulated => "articulated",
            Route::Recursive => "recursive",
            Route::Ungrouped => "ungrouped",
            Route::MultipliedOut => "multiplied out",
        })
    }
}

/// Functions whose cost grows with the square of the number of coordinates, or faster, and that nobody asks for: they
/// are not derived.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LeftOut {
    /// C, and G with it, which is proved by C.
    pub coriolis_matrix: bool,
    /// The derivatives of inverse dynamics.
    pub inverse_dynamics_jacobian: bool,
    /// Those of forward dynamics, in the parameters too.
    pub linearization: bool,
    /// M, and what is neither needed nor proved without it: of a long chain all but its dynamics.
    pub mass_matrix: bool,
    /// Outputs and reactions, which keep M elsewhere than in long chains.
    pub outputs: bool,
}

/// Everything that is generated for a mechanism, as roots in one graph.
#[derive(Clone, Debug)]
pub(crate) struct Equations<'g> {
    /// How they were derived.
    pub route: Route,
    /// What is empty because nobody asks for it.
    pub left_out: LeftOut,
    /// The symbols that the roots depend on.
    pub symbols: Symbols,
    /// T, V, p, M, C, G, h and inverse dynamics.
    pub lagrange: Lagrange<'g>,
    /// q̈
    pub forward_dynamics: ForwardDynamics<'g>,
    /// Derivatives of the dynamics, by differentiation.
    pub derivatives: Derivatives<'g>,
    /// Those by recursion, where that is another way.
    pub recursive: Option<Derivatives<'g>>,
    /// Rows of constraints.
    pub constraints: Constraints<'g>,
    /// First integrals.
    pub conserved: Vec<Conserved<'g>>,
    /// Outputs with their velocities and Jacobians.
    pub outputs: Vec<OutputEquations<'g>>,
    /// What the joints of each reaction transmit.
    pub reactions: Vec<Wrenches<'g>>,
}

/// The terms of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q`.
#[derive(Clone, Debug)]
pub(crate) struct Lagrange<'g> {
    /// T
    pub kinetic_energy: Expr<'g>,
    /// V
    pub potential_energy: Expr<'g>,
    /// `p = ∂L/∂q̇`
    pub momentum: Vec<Expr<'g>>,
    /// `M = ∂²L/∂q̇²`; no rows where it is left out.
    pub mass_matrix: Rows<'g>,
    /// C
    pub coriolis_matrix: Rows<'g>,
    /// G
    pub gravity: Vec<Expr<'g>>,
    /// `h = C q̇ + G`
    pub bias: Vec<Expr<'g>>,
    /// `∂D/∂q̇`
    pub dissipation_force: Vec<Expr<'g>>,
    /// Q
    pub generalized_force: Vec<Expr<'g>>,
    /// `M q̈ + C q̇ + G + ∂D/∂q̇`
    pub inverse_dynamics: Vec<Expr<'g>>,
    /// `M q̈ + C q̇ + G + ∂D/∂q̇ − Q`, which forward dynamics makes zero.
    pub residual: Vec<Expr<'g>>,
    /// `Q − C q̇ − G − ∂D/∂q̇`, what accelerates.
    pub free_force: Vec<Expr<'g>>,
    /// `∂L/∂q`, which vanishes where the coordinate is cyclic.
    pub position_gradient: Vec<Expr<'g>>,
    /// q̈ without a mass matrix and without constraints, where a sweep gives it.
    pub accelerations: Option<Vec<Expr<'g>>>,
    /// The slopes of `M q̈ + C q̇ + G` of bodies, where a sweep gives them.
    pub slopes: Option<Slopes<'g>>,
}

/// `∂/∂q` and `∂/∂q̇` of a part of the forces, and what is left of them to be differentiated.
#[derive(Clone, Debug)]
pub(crate) struct Slopes<'g> {
    /// `∂/∂q`
    pub q: Rows<'g>,
    /// `∂/∂q̇`
    pub qd: Rows<'g>,
    /// The rest of `M q̈ + C q̇ + G + ∂D/∂q̇`.
    pub other_inverse_dynamics: Vec<Expr<'g>>,
    /// The rest of `M q̈ + C q̇ + G + ∂D/∂q̇ − Q`.
    pub other_residual: Vec<Expr<'g>>,
}

/// How accelerations are found.
#[derive(Clone, Debug)]
pub(crate) struct ForwardDynamics<'g> {
    /// M
    pub mass_matrix: Rows<'g>,
    /// A; no rows where there are no constraints.
    pub jacobian: Rows<'g>,
    /// `Q − h − ∂D/∂q̇`, then −γ.
    pub right_side: Vec<Expr<'g>>,
    /// q̈, where the factorization is unrolled or none is needed.
    pub unrolled: Option<Vec<Expr<'g>>>,
    /// That factorization.
    pub factorization: Option<Factorization<'g>>,
    /// q̈ by articulated bodies, where that is another way.
    pub articulated: Option<Vec<Expr<'g>>>,
    /// How the system with constraints is eliminated, where most of it is zero.
    pub elimination: Option<Elimination>,
}

/// `M = L D Lᵀ` with unit lower triangular L, rows and columns in the order of elimination.
///
/// Source: Golub & Van Loan, *Matrix Computations*, 4th ed. 2013, algorithm 4.1.1.
#[derive(Clone, Debug)]
pub(crate) struct Factorization<'g> {
    /// In the order of elimination.
    pub steps: Vec<Step<'g>>,
}

/// The elimination of one unknown.
#[derive(Clone, Debug)]
pub(crate) struct Step<'g> {
    /// Its number.
    pub pivot: usize,
    /// Of what is eliminated later: its number, and its entry in the pivot's column of L.
    pub column: Vec<(usize, Expr<'g>)>,
    /// `1/Dₚ`
    pub reciprocal: Expr<'g>,
}

/// `∂τ/∂q` and `∂τ/∂q̇` of `τ = M q̈ + C q̇ + G + ∂D/∂q̇`.
#[derive(Clone, Debug, Default)]
pub(crate) struct InverseDynamicsJacobian<'g> {
    /// `∂τ/∂q`
    pub q: Rows<'g>,
    /// `∂τ/∂q̇`
    pub qd: Rows<'g>,
}

/// The derivatives of inverse and of forward dynamics, those that are asked for.
#[derive(Clone, Debug)]
pub(crate) struct Derivatives<'g> {
    /// How they were derived.
    pub route: Route,
    /// `∂τ/∂q`, `∂τ/∂q̇`
    pub inverse_dynamics_jacobian: InverseDynamicsJacobian<'g>,
    /// Those of q̈.
    pub linearization: Linearization<'g>,
}

impl Derivatives<'_> {
    /// Before any is asked for.
    pub(crate) fn none(route: Route) -> Self {
        let (inverse_dynamics_jacobian, linearization) = Default::default();
        Derivatives { route, inverse_dynamics_jacobian, linearization }
    }
}

/// Derivatives of q̈; rows are accelerations.
#[derive(Clone, Debug, Default)]
pub(crate) struct Linearization<'g> {
    /// `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u`, where the factorization is unrolled; else `−∂r/∂x`, the right sides of a solution
    /// at run time, with q̈ and λ left as symbols.
    pub state: [Rows<'g>; 3],
    /// `∂q̈/∂parameters`, likewise.
    pub parameters: Rows<'g>,
}

/// All rows of all constraints, in declaration order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Constraints<'g> {
    /// `φ`, or `a·q̇ + b` of Pfaffian rows.
    pub value: Vec<Expr<'g>>,
    /// `A q̇ + b`
    pub rate: Vec<Expr<'g>>,
    /// `∂(A q̇ + b)/∂q`
    pub rate_jacobian: Rows<'g>,
    /// A
    pub jacobian: Rows<'g>,
    /// b
    pub drift: Vec<Expr<'g>>,
    /// γ
    pub bias: Vec<Expr<'g>>,
    /// λ, as symbols.
    pub multipliers: Vec<Symbol>,
}

/// A quantity that keeps its value for `u = 0`, `D = 0`.
#[derive(Clone, Debug)]
pub(crate) struct Conserved<'g> {
    /// `energy_integral`, or `p_` and the coordinate.
    pub name: String,
    /// Its value.
    pub value: Expr<'g>,
}

/// An output's equations.
#[derive(Clone, Debug)]
pub(crate) struct OutputEquations<'g> {
    /// As declared.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
    /// Its components, row by row; for each pose the position and then the rows of the rotation.
    pub value: Vec<Expr<'g>>,
    /// Its time derivative; for each pose the velocity of its origin and the angular velocity, in world axes.
    /// Absent where the value depends on velocities or inputs.
    pub velocity: Option<Vec<Expr<'g>>>,
    /// `∂velocity/∂q̇`, one row per component; of a value that depends on velocities `∂value/∂q`.
    pub jacobian: Rows<'g>,
    /// `∂value/∂q̇`, where the value depends on velocities.
    pub jacobian_qd: Option<Rows<'g>>,
    /// `∂value/∂u`, where the value depends on inputs.
    pub jacobian_u: Option<Rows<'g>>,
    /// The total time derivative of the Jacobian, `J̇ = Σ ∂J/∂q_k q̇_k + ∂J/∂t`, where it was asked for. With the
    /// velocity `J q̇ + b`, `b = ∂value/∂t`, the acceleration is `J q̈ + J̇ q̇ + ḃ`.
    pub jacobian_rate: Option<Rows<'g>>,
}

/// The wrenches of a reaction.
#[derive(Clone, Debug)]
pub(crate) struct Wrenches<'g> {
    /// As declared.
    pub name: String,
    /// One wrench, or several.
    pub shape: Shape,
    /// The force, then the moment, for each joint: in the axes of its pose, about its origin.
    pub values: Vec<Expr<'g>>,
}
