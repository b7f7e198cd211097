//! Pass 4: `Equations` → [`Derivation`]: one straight-line [`Program`] per function, scheduled from its own roots.
//!
//! - `derivation`: what comes of it; `program`: what a Program is;
//! - `region`: what is computed on one side of a branch only;
//! - `lower`: graph nodes → instructions; powers become products, quotients and square roots;
//! - `schedule`: order, and hoisting of what depends on parameters alone;
//! - `cost`: operation counts, the figures quoted in docs, snapshots and commits.
//!
//! Mechanics ends here: this pass only preserves values.

pub(crate) mod cost;
mod derivation;
pub(crate) mod lower;
pub(crate) mod program;
pub(crate) mod region;
pub(crate) mod schedule;

use crate::catalogue::{self, Roots};
use crate::derive;
use crate::equations::{Equations, Route};
use crate::expr::{Expr, Graph, Spline, Symbol, without_vanishing_sums};
use crate::model::requirement::{Condition, Requirement, requirements};
use crate::model::{Constraint, Lagrangian};
use crate::variable::Variable;

pub use crate::catalogue::{Argument, Completion, FunctionKind};
pub use crate::shape::{ResultPart, Shape};
pub use cost::Operations;
pub use derivation::Derivation;
pub(crate) use derivation::Derived;
pub(crate) use program::Value;
pub use program::{Instruction, Program};

use schedule::{Forms, Hoisting};

/// One generated function.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Function {
    /// Its name in the generated code, in `mbs ops` and in `mbs eval`.
    pub name: String,
    /// What it computes.
    pub kind: FunctionKind,
    /// Which arguments it takes beside t.
    pub arguments: Vec<Argument>,
    /// What it returns: one value, or named ones.
    pub results: Vec<ResultPart>,
    /// How it is computed; one value per component of the results, row by row, lower triangle for symmetric matrices.
    pub program: Program,
    /// What is still to be done with the program's values.
    pub completion: Completion,
    /// What one call costs.
    pub operations: Operations,
    /// How it was derived.
    pub route: Route,
}

/// Makes the Programs, each function by its cheapest route; the routes are equal in value, the first wins a draw.
pub(crate) fn straight_line(lagrangian: &Lagrangian<'_>, routes: &[Equations<'_>]) -> Derivation {
    let mut forms = Forms::default();
    let chosen = cheapest(ways(routes), &mut forms);
    let hoisting = Hoisting::of(chosen.iter().map(|way| way.roots.values.as_slice()), &mut forms);
    let conserved =
        chosen.iter().find(|way| way.kind == FunctionKind::Conserved).map(|way| way.equations.conserved.iter());
    let conserved = conserved.into_iter().flatten().map(|integral| integral.name.clone()).collect();
    let mut functions: Vec<Function> = chosen.into_iter().map(|way| way.into_function(&hoisting)).collect();
    count_constrained_motion(&mut functions);
    let graph = Graph::new();
    let (requirements, required) = requirements(lagrangian, &graph);
    let depends_on_time = functions.iter().any(|f| f.program.uses(|symbol| symbol == Symbol::Time));
    Derivation(Derived {
        name: lagrangian.name.clone(),
        docs: lagrangian.docs.clone(),
        coordinates: lagrangian.coordinates.clone(),
        parameters: lagrangian.parameters.clone(),
        inputs: lagrangian.inputs.clone(),
        prescribed: lagrangian.prescribed.clone(),
        constraints: lagrangian.constraints.iter().flat_map(Constraint::row_names).collect(),
        constraint_vectors: lagrangian.constraint_vectors(),
        holonomic: lagrangian.holonomic_rows(),
        constraint_units: lagrangian.constraints.iter().flat_map(|constraint| constraint.units.clone()).collect(),
        reactions: lagrangian.reactions.clone(),
        conserved,
        output_units: lagrangian.outputs.iter().map(|output| output.units.clone()).collect(),
        depends_on_time,
        constructor: hoisting.constructor,
        requirements,
        required: lower::program(&required, &Hoisting::none()),
        elimination: routes.iter().find_map(|equations| equations.forward_dynamics.elimination.clone()),
        functions,
    })
}

/// The programs of the values of the outputs, and of nothing else: no function of the mechanism is there.
pub(crate) fn of_outputs(lagrangian: &Lagrangian<'_>) -> Derivation {
    let graph = Graph::new();
    let roots = derive::output::values(lagrangian, &graph).into_iter().filter_map(|(of, value)| Roots::of(of, value));
    let roots: Vec<Roots<'_>> = roots.collect();
    let hoisting = Hoisting::of(roots.iter().map(|roots| roots.values.as_slice()), &mut Forms::default());
    let named = lagrangian.outputs.iter().zip(roots).enumerate();
    let functions: Vec<Function> = named
        .map(|(number, (output, roots))| {
            let (kind, program) = (FunctionKind::Output(number), lower::program(&roots.values, &hoisting));
            Function {
                name: output.name.clone(),
                kind,
                arguments: kind.arguments(&roots),
                results: roots.results,
                operations: cost::operations(&program),
                program,
                completion: Completion::None,
                route: Route::Plain,
            }
        })
        .collect();
    let depends_on_time = functions.iter().any(|f| f.program.uses(|symbol| symbol == Symbol::Time));
    Derivation(Derived {
        name: lagrangian.name.clone(),
        docs: Vec::new(),
        coordinates: lagrangian.coordinates.clone(),
        parameters: lagrangian.parameters.clone(),
        inputs: lagrangian.inputs.clone(),
        prescribed: lagrangian.prescribed.clone(),
        constraints: Vec::new(),
        constraint_vectors: Vec::new(),
        holonomic: Vec::new(),
        constraint_units: Vec::new(),
        reactions: Vec::new(),
        conserved: Vec::new(),
        output_units: lagrangian.outputs.iter().map(|output| output.units.clone()).collect(),
        depends_on_time,
        constructor: hoisting.constructor,
        requirements: Vec::new(),
        required: Program::default(),
        elimination: None,
        functions,
    })
}

/// The functions by each route, without sums that vanish: of all of them at once, since they have most nodes in common.
/// Accelerations and their derivatives keep them: they are differences of equations, and what these have in common has
/// to round alike, where a coordinate has 1e-8 of the inertia of another.
fn ways<'e, 'g>(routes: &'e [Equations<'g>]) -> Vec<Vec<Way<'e, 'g>>> {
    let functions = |equations| catalogue::functions(equations).into_iter();
    let way = |equations: &'e Equations<'g>, (kind, roots)| {
        let are_derivatives = matches!(kind, FunctionKind::InverseDynamicsJacobian | FunctionKind::Linearize);
        let route = if are_derivatives { equations.derivatives.route } else { equations.route };
        Way { kind, roots, equations, route }
    };
    let articulated = |equations: &'e Equations<'g>| {
        let roots = Roots::accelerations(equations.forward_dynamics.articulated.as_ref()?)?;
        Some(Way { kind: FunctionKind::ForwardDynamics, roots, equations, route: Route::Articulated })
    };
    let recursive = |equations: &'e Equations<'g>| {
        let (left_out, derivatives) = (equations.left_out, equations.recursive.as_ref()?);
        let jacobian = || Roots::inverse_dynamics_jacobian(equations, derivatives);
        let linearization = || Roots::linearization(equations, derivatives);
        let found = [
            (FunctionKind::InverseDynamicsJacobian, (!left_out.inverse_dynamics_jacobian).then(jacobian).flatten()),
            (FunctionKind::Linearize, (!left_out.linearization).then(linearization).flatten()),
        ];
        let way = |(kind, roots)| Some(Way { kind, roots: roots?, equations, route: derivatives.route });
        Some(found.into_iter().filter_map(way))
    };
    let others = |equations| articulated(equations).into_iter().chain(recursive(equations).into_iter().flatten());
    let by = |equations| functions(equations).map(|function| way(equations, function)).chain(others(equations));
    let mut ways: Vec<Vec<Way<'e, 'g>>> = routes.iter().map(|equations| by(equations).collect()).collect();
    let simplified = ways.iter_mut().flatten().map(|way| &mut way.roots).filter(|roots| !roots.is_solved);
    let mut roots: Vec<&mut Expr<'g>> = simplified.flat_map(|roots| &mut roots.values).collect();
    let all: Vec<Expr<'g>> = roots.iter().map(|root| **root).collect();
    roots.iter_mut().zip(without_vanishing_sums(&all)).for_each(|(root, new)| **root = new);
    ways
}

/// Derivatives are taken along the constrained motion, which is found first.
fn count_constrained_motion(functions: &mut [Function]) {
    let forward_dynamics = functions.iter().find(|f| f.kind == FunctionKind::ForwardDynamics);
    let Some(motion) = forward_dynamics.filter(|f| f.completion.is_constrained()).map(|f| f.operations) else { return };
    let is_slope = |f: &&mut Function| matches!(f.kind, FunctionKind::Linearize | FunctionKind::LinearizeParameters);
    functions.iter_mut().filter(is_slope).for_each(|f| f.operations = f.operations + motion);
}

impl Derivation {
    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.coordinates.iter().map(Variable::count).sum()
    }

    /// How many values of a program that sets up a system are its matrices: those of M, and of A.
    pub fn matrix_entries(&self) -> usize {
        let (n, k) = (self.dof(), self.constraints.len());
        self.elimination.as_ref().map_or(n * (n + 1) / 2 + k * n, |elimination| elimination.entries.len())
    }

    /// Of each coordinate its kind: 0 of those without a unit, and a number for each other unit.
    pub(crate) fn coordinate_kinds(&self) -> Vec<usize> {
        let mut units: Vec<&str> = Vec::new();
        let mut kind = |unit| match unit {
            "1" | "rad" => 0,
            unit => {
                let found = units.iter().position(|&other| other == unit);
                1 + found.unwrap_or_else(|| {
                    units.push(unit);
                    units.len() - 1
                })
            }
        };
        self.coordinates.iter().flat_map(|v| vec![kind(v.unit.as_str()); v.count()]).collect()
    }

    /// The splines of all programs, each once.
    pub fn splines(&self) -> Vec<&Spline> {
        let functions = self.functions.iter().map(|function| &function.program);
        let mut found: Vec<&Spline> = Vec::new();
        for spline in functions.chain([&self.constructor, &self.required]).flat_map(|program| &program.splines) {
            if !found.contains(&spline) {
                found.push(spline);
            }
        }
        found
    }

    /// The requirements with the numbers that they are about, of all that `required` gives.
    pub fn conditions<'d, V>(&'d self, values: &'d [V]) -> impl Iterator<Item = (&'d Requirement, &'d [V])> {
        let mut rest = values;
        self.requirements.iter().map(move |requirement| {
            let (own, behind) = rest.split_at(Condition::count(requirement.condition));
            rest = behind;
            (requirement, own)
        })
    }

    /// The function that computes this; `None` where the mechanism has none.
    pub fn function(&self, kind: FunctionKind) -> Option<&Function> {
        self.functions.iter().find(|f| f.kind == kind)
    }

    /// The function that a user calls by this name.
    pub fn named(&self, name: &str) -> Option<&Function> {
        self.functions.iter().find(|f| f.name == name)
    }
}

/// A way to compute a function, before it is scheduled.
struct Way<'e, 'g> {
    kind: FunctionKind,
    roots: Roots<'g>,
    equations: &'e Equations<'g>,
    route: Route,
}

impl Way<'_, '_> {
    /// What a call would cost if nothing else were generated.
    fn cost(&self, forms: &mut Forms) -> Operations {
        let hoisting = Hoisting::of([self.roots.values.as_slice()].into_iter(), forms);
        self.completed(cost::operations(&lower::program(&self.roots.values, &hoisting)))
    }

    /// With what the completion takes.
    fn completed(&self, operations: Operations) -> Operations {
        let [n, k] = [self.equations.symbols.q.len(), self.equations.constraints.count()];
        match self.roots.completion {
            Completion::None => operations,
            Completion::Solve => operations + cost::solve(n, &self.roots.results),
            Completion::SolveConstrained | Completion::SolveMultipliers => {
                operations
                    + match &self.equations.forward_dynamics.elimination {
                        Some(elimination) => cost::eliminate(elimination, &self.roots.results),
                        None => cost::Operations::of_constrained_solve([n, k], &self.roots.results),
                    }
            }
        }
    }

    fn into_function(self, hoisting: &Hoisting) -> Function {
        let program = lower::program(&self.roots.values, hoisting);
        let operations = self.completed(cost::operations(&program));
        let Way { kind, roots, equations, route } = self;
        Function {
            name: kind.full_name(equations),
            kind,
            arguments: kind.arguments(&roots),
            results: roots.results,
            program,
            completion: roots.completion,
            operations,
            route,
        }
    }
}

/// The cheapest of several ways to compute each function; the first wins a draw.
fn cheapest<'e, 'g>(ways: Vec<Vec<Way<'e, 'g>>>, forms: &mut Forms) -> Vec<Way<'e, 'g>> {
    let mut by_function: Vec<Vec<Way<'e, 'g>>> = Vec::new();
    for way in ways.into_iter().flatten() {
        match by_function.iter_mut().find(|known| known[0].kind == way.kind) {
            Some(known) => known.push(way),
            None => by_function.push(vec![way]),
        }
    }
    let cheapest = |ways: Vec<Way<'e, 'g>>| match ways.len() {
        1 => ways.into_iter().next(),
        _ => ways.into_iter().min_by_key(|way| way.cost(forms).weight()),
    };
    by_function.into_iter().filter_map(cheapest).collect()
}

/// The programs by one route, for each way that it can go; none where it leads nowhere. Not proved.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// use mbs_derive::{derive::Route, optimise::by_route};
/// assert_eq!(by_route(analysis.lagrangian(), Route::Plain).len(), 1);
/// assert!(by_route(analysis.lagrangian(), Route::Structured).is_empty()); // there are no bodies
/// ```
pub fn by_route(lagrangian: &Lagrangian<'_>, route: Route) -> Vec<Derivation> {
    let graph = Graph::new();
    let ways = derive::derived_by(lagrangian, &graph, &[route], Default::default());
    ways.iter().map(|equations| straight_line(lagrangian, std::slice::from_ref(equations))).collect()
}

/// What each function would cost by each route, in the order of the functions and of the routes; of a route with
/// several ways by the cheapest.
pub(crate) fn compared(routes: &[Equations<'_>]) -> Vec<Vec<(Route, Operations)>> {
    let mut forms = Forms::default();
    let mut all: Vec<(FunctionKind, Vec<(Route, Operations)>)> = Vec::new();
    for way in ways(routes).iter().flatten() {
        let cost = way.cost(&mut forms);
        let Some((_, costs)) = all.iter_mut().find(|(kind, _)| *kind == way.kind) else {
            all.push((way.kind, vec![(way.route, cost)]));
            continue;
        };
        match costs.iter_mut().find(|(route, _)| *route == way.route) {
            Some((_, known)) if known.weight() <= cost.weight() => {}
            Some((_, known)) => *known = cost,
            None => costs.push((way.route, cost)),
        }
    }
    all.into_iter().map(|(_, costs)| costs).collect()
}
