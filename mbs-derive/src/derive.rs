//! Pass 3: [`Lagrangian`] → `Equations`: mechanics, still symbolic.
//!
//! With `L = T − V + Σ lagrangian terms = ½ q̇ᵀ M q̇ + aᵀ q̇ + L₀`, an overdot the total time derivative, and D
//! Rayleigh's dissipation function, Lagrange's equations are
//!
//! ```text
//! M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ        A q̈ + γ = 0
//! ```
//!
//! - `lagrange`: momenta, mass matrix, Christoffel form, gravity, bias, inverse dynamics;
//! - `textbook`: the same in multiple-angle normal form, for small mechanisms;
//! - `lift` and `gravity`: bodies and the field they are in, found again among the energies; `tree`: the same equations
//!   by sweeps over their tree (`docs/structured.md`);
//! - `solve`: forward dynamics: LDLᵀ of M, unrolled or left to the runtime, or the constrained system at run time; for
//!   long chains articulated bodies, which are among the sweeps;
//! - `linearize`: Jacobians of the equations of motion, by differentiation or from those of the sweeps;
//! - `constraint`: what must vanish, its Jacobian and its bias;
//! - `conserved`: cyclic coordinates and the energy integral;
//! - `output`: outputs, their velocities and Jacobians;
//! - `reaction`: forces and moments that joints transmit.

pub(crate) mod conserved;
pub(crate) mod constraint;
mod gravity;
pub(crate) mod lagrange;
mod lift;
pub(crate) mod linearize;
pub(crate) mod output;
pub(crate) mod reaction;
pub(crate) mod solve;
pub(crate) mod textbook;
mod tree;

use std::cell::OnceCell;

use crate::expr::table::Table;
use crate::expr::{Elimination, Expr, Graph, Kept, Node, Symbol, carry_out, gradient, gradient_of_combination};
use crate::mistake::rule;
use crate::model::{Lagrangian, PointForce};
use crate::shape::Shape;
use crate::variable::Variable;

pub(crate) use crate::equations::Equations;
pub use crate::equations::Route;
pub(crate) use crate::equations::{
    Conserved, Constraints, Lagrange, LeftOut, OutputEquations, Rows, Slopes, Symbols, Wrenches,
};
pub use solve::LARGEST_UNROLLED;
pub(crate) use textbook::Form;

use conserved::Exact;
use lift::Lifted;
use reaction::Reactions;
use tree::Masses;

/// Up to this many coordinates all that costs little is derived besides what is asked for; of longer chains what grows
/// with their length alone.
pub(crate) const FEW_COORDINATES: usize = 30;

impl Symbols {
    fn of(lagrangian: &Lagrangian<'_>) -> Symbols {
        let n = lagrangian.dof() as u32;
        let count = |variables: &[Variable]| variables.iter().map(|v| v.count() as u32).sum::<u32>();
        Symbols {
            q: (0..n).map(Symbol::Coordinate).collect(),
            qd: (0..n).map(Symbol::Velocity).collect(),
            qdd: (0..n).map(Symbol::Acceleration).collect(),
            u: (0..count(&lagrangian.inputs)).map(Symbol::Input).collect(),
            parameters: (0..count(&lagrangian.parameters)).map(Symbol::Parameter).collect(),
        }
    }
}

impl Route {
    /// How what is derived by it is written.
    fn form(self, kept: &Kept) -> Form<'_> {
        match self {
            Route::Textbook | Route::MultipliedOut => Form::Textbook(kept),
            Route::Plain | Route::Structured | Route::Articulated | Route::Recursive | Route::Ungrouped => {
                Form::AsDerived
            }
        }
    }
}

/// Derives the equations of motion into `graph`, by every route that applies.
///
/// The routes are equal in value, each function of a mechanism may take another: the cheapest is chosen by `optimise`.
/// A long chain that is nothing but bodies, or one whose M is left out, is derived by its structure alone:
/// differentiation would only take time to lose.
pub(crate) fn routes<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph, left_out: LeftOut) -> Vec<Equations<'g>> {
    derived_by(lagrangian, graph, &[Route::Plain, Route::Textbook, Route::Structured], left_out)
}

/// The equations by every route, those that are there for comparison only included; accelerations by articulated bodies
/// and derivatives by recursion are among the structured ones.
pub(crate) fn all_routes<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Vec<Equations<'g>> {
    let routes = Route::ALL.into_iter().filter(|route| !matches!(route, Route::Articulated | Route::Recursive));
    derived_by(lagrangian, graph, &routes.collect::<Vec<_>>(), LeftOut::default())
}

pub(crate) fn derived_by<'g>(
    lagrangian: &Lagrangian<'_>,
    graph: &'g Graph,
    routes: &[Route],
    left_out: LeftOut,
) -> Vec<Equations<'g>> {
    let symbols = Symbols::of(lagrangian);
    let energies = Energies::carried_out(lagrangian, graph);
    let (symbols, energies) = (&symbols, &energies);
    let lifted = lift::lifted(lagrangian, energies, graph);
    let is_long_chain = symbols.q.len() > solve::LARGEST_UNROLLED && lifted.as_ref().is_some_and(Lifted::is_all);
    let has_outputs = !lagrangian.outputs.is_empty() || !lagrangian.reactions.is_empty();
    let is_long = symbols.q.len() > FEW_COORDINATES;
    let may_leave_out = left_out.mass_matrix && is_long && (left_out.outputs || !has_outputs);
    // Outputs need M: where bodies are not all that there is, they are kept.
    let is_chain = is_long_chain
        || (left_out.outputs || !has_outputs) && lifted.as_ref().is_some_and(|lifted| lifted.has_all_inertia(symbols));
    let leaves_out_of_chain = left_out.mass_matrix && is_long && is_chain && lagrangian.constraints.is_empty();
    let left_out = LeftOut { mass_matrix: leaves_out_of_chain, ..left_out };
    let plain = (!is_long_chain && !leaves_out_of_chain).then(|| lagrange::equations(energies, symbols, left_out));
    let rest_of = |lifted: &Lifted<'g>, left_out| lagrange::equations(&lifted.rest, symbols, left_out);
    let rest = lifted.as_ref().map(|lifted| rest_of(lifted, left_out));
    let by_bodies = |masses| {
        let (lifted, rest) = (lifted.as_ref()?, rest.as_ref()?);
        let found = tree::equations(lifted, masses, energies, rest, symbols, left_out);
        if !left_out.mass_matrix || found.accelerations.is_some() {
            return Some(found);
        }
        // Nothing but M gives the accelerations.
        let left_out = LeftOut { mass_matrix: false, ..left_out };
        Some(tree::equations(lifted, masses, energies, &rest_of(lifted, left_out), symbols, left_out))
    };
    let (kept, nothing) = (energies.factors(), Kept::default());
    let turned = kept.turned_sums_multiplied_out();
    // As in a textbook in two ways, where there are two.
    let kept = |route: Route| match route {
        Route::MultipliedOut => vec![&nothing],
        Route::Textbook => std::iter::once(&kept).chain(&turned).collect(),
        Route::Plain | Route::Structured | Route::Articulated | Route::Recursive | Route::Ungrouped => vec![&kept],
    };
    let by = |route: Route, kept: &Kept| match route {
        Route::Plain => plain.clone(),
        Route::Textbook | Route::MultipliedOut => textbook::normal_form(plain.as_ref()?, kept),
        Route::Structured => by_bodies(Masses::Regrouped),
        Route::Articulated => by_bodies(Masses::Regrouped)
            .filter(|lagrange| lagrangian.constraints.is_empty() && lagrange.accelerations.is_some()),
        Route::Recursive => by_bodies(Masses::Regrouped).filter(|lagrange| lagrange.slopes.is_some()),
        Route::Ungrouped => by_bodies(Masses::AsDeclared),
    };
    let constraints = constraint::constraints(lagrangian, graph, symbols);
    let unfolded = Graph::verbatim();
    let exact = Exact::new(lagrangian, &unfolded);
    let (outputs, elimination) = (OnceCell::new(), OnceCell::new());
    let mechanism =
        Mechanism { lagrangian, left_out, may_leave_out, symbols, energies, constraints, exact, outputs, elimination };
    let ways = routes.iter().flat_map(|&route| kept(route).into_iter().map(move |kept| (route, kept)));
    let mut found: Vec<_> =
        ways.filter_map(|(route, kept)| Some(mechanism.equations(route, kept, by(route, kept)?))).collect();
    // Reactions come last, so that all else is the same without them.
    let asks_for_all = found.iter().all(|equations| !equations.left_out.mass_matrix);
    if let Some(reactions) = asks_for_all.then(|| Reactions::of(lagrangian, graph)).flatten() {
        for equations in &mut found {
            let wrenches = reactions.by(equations.route).or_else(|| reactions.by(Route::Plain)).unwrap_or_default();
            let wrenches = lagrangian.reactions.iter().zip(wrenches).map(|(reaction, values)| Wrenches {
                name: reaction.name.clone(),
                shape: reaction.length.map_or(Shape::Wrench, Shape::Wrenches),
                values,
            });
            equations.reactions = wrenches.collect();
        }
    }
    found
}

/// What does not depend on the route.
struct Mechanism<'a, 'v, 'g> {
    lagrangian: &'a Lagrangian<'v>,
    left_out: LeftOut,
    /// Whether M is left out where accelerations are written out, or eliminated in a known order.
    may_leave_out: bool,
    symbols: &'a Symbols,
    energies: &'a Energies<'g>,
    constraints: Constraints<'g>,
    exact: Exact<'a, 'a>,
    /// Made after the equations of the first route: where a graph has branches, sums follow the order in which it grew.
    outputs: OnceCell<Vec<OutputEquations<'g>>>,
    /// By the zeros of the first route: what is zero there is zero in all.
    elimination: OnceCell<Option<Elimination>>,
}

impl<'g> Mechanism<'_, '_, 'g> {
    /// Everything that follows from Lagrange's equations.
    fn equations(&self, route: Route, kept: &Kept, mut lagrange: Lagrange<'g>) -> Equations<'g> {
        let &Mechanism { lagrangian, left_out, symbols, energies, ref constraints, ref exact, ref outputs, .. } = self;
        let form = route.form(kept);
        let mut forward_dynamics = form.forward_dynamics(&lagrange, constraints);
        let of_system = || solve::elimination(&forward_dynamics.mass_matrix, &constraints.jacobian, lagrangian);
        forward_dynamics.elimination = self.elimination.get_or_init(of_system).clone();
        let is_eliminated = forward_dynamics.elimination.is_some();
        if self.may_leave_out && (forward_dynamics.unrolled.is_some() || is_eliminated) {
            // They need nothing but its entries that are not zero, and are proved by inverse dynamics.
            if !is_eliminated {
                forward_dynamics.mass_matrix = Rows::new();
            }
            lagrange.mass_matrix = Rows::new();
            lagrange.coriolis_matrix = Rows::new();
        }
        let left_out = LeftOut { mass_matrix: lagrange.mass_matrix.is_empty(), ..left_out };
        let forward_dynamics = match route {
            Route::Articulated => forward_dynamics.by_articulated_bodies(),
            _ => forward_dynamics,
        };
        let asked_for = linearize::Dynamics {
            lagrange: &lagrange,
            forward: &forward_dynamics,
            route,
            form,
            constraints,
            symbols,
            left_out,
        };
        // Of long chains reverse sweeps would take time to lose.
        let by_recursion_alone = route == Route::Recursive || symbols.q.len() > FEW_COORDINATES;
        let (derivatives, recursive) = match &lagrange.slopes {
            Some(slopes) if by_recursion_alone => (asked_for.by_recursion(slopes, true), None),
            slopes => {
                let recursive = slopes.as_ref().map(|slopes| asked_for.by_recursion(slopes, false));
                (asked_for.derivatives(), recursive)
            }
        };
        let graph = lagrange.kinetic_energy.graph();
        let (conserved, outputs) = match left_out.mass_matrix {
            true => (Vec::new(), Vec::new()),
            false => (
                conserved::conserved(&lagrange, energies, constraints, exact, symbols),
                outputs.get_or_init(|| output::outputs(lagrangian, graph, symbols)).clone(),
            ),
        };
        Equations {
            route,
            left_out,
            symbols: symbols.clone(),
            lagrange,
            forward_dynamics,
            derivatives,
            recursive,
            constraints: constraints.clone(),
            conserved,
            outputs,
            reactions: Vec::new(),
        }
    }
}

/// The declared scalars with their time derivatives carried out and the local rules applied.
#[derive(Clone, Debug)]
pub(crate) struct Energies<'g> {
    /// T
    pub kinetic: Expr<'g>,
    /// V
    pub potential: Expr<'g>,
    /// D, without the terms that inputs enter.
    pub dissipation: Expr<'g>,
    /// Terms of L that are neither T nor −V.
    pub other: Expr<'g>,
    /// `L = T − V + Σ lagrangian terms`
    pub lagrangian: Expr<'g>,
    /// Q, one per coordinate.
    pub forces: Vec<Expr<'g>>,
    /// What Q was declared with: forces on coordinates, and components of forces on points and torques on bodies.
    pub declared_forces: Vec<Expr<'g>>,
    /// What T was declared to multiply rates by.
    pub declared_inertias: Vec<Expr<'g>>,
}

impl<'g> Energies<'g> {
    fn carried_out(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Self {
        let sum = |terms: &[Expr<'_>]| sum(terms, graph);
        let (kinetic, potential) = (sum(&lagrangian.kinetic), sum(&lagrangian.potential));
        let [dissipation, _] = lagrangian.dissipation_without_and_with_inputs();
        let dissipation = sum(&dissipation);
        let other = sum(&lagrangian.lagrangian);
        Energies {
            kinetic,
            potential,
            dissipation,
            other,
            lagrangian: kinetic - potential + other,
            forces: generalized_forces(lagrangian, &lagrangian.point_forces.iter().collect::<Vec<_>>(), graph),
            declared_forces: declared_forces(lagrangian, graph),
            declared_inertias: declared_inertias(lagrangian, graph),
        }
    }

    /// The sums that springs, dampers, forces and moments of inertia were written with.
    fn factors(&self) -> Kept {
        let energies = [self.potential, self.dissipation, self.other].into_iter();
        let written: Vec<_> = energies.chain(self.declared_inertias.iter().copied()).collect();
        let kept = Kept::of(&written, &self.declared_forces);
        kept.and_constants_of(&[self.kinetic, self.potential, self.dissipation, self.other])
    }

    /// The Lagrangian with only these terms of T and V.
    fn with_terms(&self, kinetic: &[Expr<'_>], potential: &[Expr<'_>]) -> Self {
        let graph = self.kinetic.graph();
        let (kinetic, potential) = (sum(kinetic, graph), sum(potential, graph));
        let lagrangian = kinetic - potential + self.other;
        Energies { kinetic, potential, lagrangian, ..self.clone() }
    }
}

/// The sum of verbatim terms, time derivatives carried out.
fn sum<'g>(terms: &[Expr<'_>], graph: &'g Graph) -> Expr<'g> {
    let terms = carry_out(terms, graph, |symbol| time_derivative(symbol, graph));
    terms.into_iter().fold(graph.integer(0), |sum, term| sum + term)
}

/// Some verbatim expressions, time derivatives carried out.
fn carried<'g, const N: usize>(expressions: [Expr<'_>; N], graph: &'g Graph) -> [Expr<'g>; N] {
    let carried = carry_out(&expressions, graph, |symbol| time_derivative(symbol, graph));
    std::array::from_fn(|i| carried[i])
}

fn declared_forces<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Vec<Expr<'g>> {
    let on_coordinates = lagrangian.forces.iter().map(|(_, force)| *force);
    let at_points = lagrangian.point_forces.iter().flat_map(|force| force.force.0);
    carry_out(&on_coordinates.chain(at_points).collect::<Vec<_>>(), graph, |symbol| time_derivative(symbol, graph))
}

/// The factors without rates of what T has rates in, but not of what rates are of.
fn declared_inertias<'g>(lagrangian: &Lagrangian<'_>, graph: &'g Graph) -> Vec<Expr<'g>> {
    let verbatim = lagrangian.graph;
    let order = verbatim.reachable(lagrangian.kinetic.iter().map(|term| term.id()));
    let (mut moves, mut is_outside) = (Table::new(&order, false), Table::new(&order, false));
    for &id in &order {
        let node = verbatim.node(id);
        let is_moving = matches!(node, Node::Rate(_) | Node::Symbol(Symbol::Velocity(_)))
            || node.operands().any(|operand| moves[operand]);
        moves[id] = is_moving;
    }
    lagrangian.kinetic.iter().for_each(|term| is_outside[term.id()] = true);
    let mut inertias = Vec::new();
    for &id in order.iter().rev() {
        match verbatim.node(id) {
            Node::Rate(_) => {}
            _ if !is_outside[id] => {}
            node if moves[id] => node.operands().for_each(|operand| is_outside[operand] = true),
            _ if verbatim.is_parametric(id) => {}
            _ => inertias.push(verbatim.expr(id)),
        }
    }
    carry_out(&inertias, graph, |symbol| time_derivative(symbol, graph))
}

/// Q of the forces on coordinates, of these forces on points and torques on bodies, and of the terms of D that inputs
/// enter.
fn generalized_forces<'g>(
    lagrangian: &Lagrangian<'_>,
    point_forces: &[&PointForce<'_>],
    graph: &'g Graph,
) -> Vec<Expr<'g>> {
    let at_points = virtual_work(point_forces, lagrangian.dof(), graph);
    let [_, dissipation] = lagrangian.dissipation_without_and_with_inputs();
    let dissipation_force = gradient(sum(&dissipation, graph), &Symbols::of(lagrangian).qd);
    let force = |i: usize| {
        let terms: Vec<_> = lagrangian.forces.iter().filter(|(c, _)| *c == i).map(|(_, force)| *force).collect();
        let acting = sum(&terms, graph) + at_points[i];
        rule!("dissipation that inputs enter", acting - dissipation_force[i], acting + dissipation_force[i])
    };
    (0..lagrangian.dof()).map(force).collect()
}

/// `Q = Σ (∂v/∂q̇)ᵀ F` over forces on points and torques on bodies: one reverse sweep for all of them.
fn virtual_work<'g>(point_forces: &[&PointForce<'_>], coordinates: usize, graph: &'g Graph) -> Vec<Expr<'g>> {
    let carried = |vectors: Vec<crate::expr::Vector<'_>>| {
        let components: Vec<_> = vectors.iter().flat_map(|v| v.0).collect();
        carry_out(&components, graph, |symbol| time_derivative(symbol, graph))
    };
    let velocities = carried(point_forces.iter().map(|f| f.velocity).collect());
    let forces = carried(point_forces.iter().map(|f| f.force).collect());
    let qd: Vec<Symbol> = (0..coordinates as u32).map(Symbol::Velocity).collect();
    let pairs: Vec<_> = velocities.into_iter().zip(forces).collect();
    if pairs.is_empty() { vec![graph.integer(0); qd.len()] } else { gradient_of_combination(&pairs, &qd) }
}

/// `dq = q̇ dt`, `dq̇ = q̈ dt`
pub(crate) fn time_derivative<'g>(symbol: Symbol, graph: &'g Graph) -> Option<Expr<'g>> {
    match symbol {
        Symbol::Time => Some(graph.integer(1)),
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Velocity(i) => Some(graph.symbol(Symbol::Acceleration(i))),
        Symbol::Prescribed(i, order @ (0 | 1)) => Some(graph.symbol(Symbol::Prescribed(i, order + 1))),
        Symbol::Prescribed(..) => unreachable!("the model refuses accelerations in energies"),
        Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Multiplier(_) => None,
    }
}
