//! Pass 4: [`Equations`] → [`Derivation`]: one straight-line [`Program`] per function, scheduled from its own roots.
//!
//! - [`program`]: what a Program is; [`part`]: what functions return;
//! - [`region`]: what is computed on one side of a branch only;
//! - [`lower`]: graph nodes → instructions; powers become products, quotients and square roots;
//! - [`schedule`]: order, and hoisting of what depends on parameters alone;
//! - [`cost`]: operation counts, the figures quoted in docs, snapshots and commits.
//!
//! Mechanics ends here: this pass only preserves values.

pub mod cost;
pub mod lower;
pub mod part;
pub mod program;
pub mod region;
pub mod schedule;

use crate::derive::output::OutputShape;
use crate::derive::{Equations, ForwardDynamics, Route, Rows};
use crate::expr::{Expr, Graph, Spline, Symbol, without_vanishing_sums};
use crate::model::requirement::{Condition, Requirement, requirements};
use crate::model::{Constraint, Lagrangian, Reaction};
use crate::variable::Variable;

pub use cost::Operations;
pub use part::{ResultPart, Shape};
pub use program::{Instruction, Program, Value};

use schedule::{Forms, Hoisting};

/// A mechanism ready to be proved, emitted or interpreted.
///
/// With the feature `serde` it can be written and read again, by the same version of this crate; reading does not prove
/// it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Derivation {
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
    /// The units of the components of the outputs in declaration order, in SI base units: `kg·m²/s²`.
    pub output_units: Vec<Vec<String>>,
    /// Whether any function depends on t; then all of them take it.
    pub depends_on_time: bool,
    /// From parameters to the values that depend on them alone, computed once.
    pub constructor: Program,
    /// What parameters must satisfy.
    pub requirements: Vec<Requirement>,
    /// From parameters to the numbers that the requirements are about, [this many](Condition::count) for each in turn.
    pub required: Program,
    /// The generated functions, in the order of the documentation.
    pub functions: Vec<Function>,
}

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

/// What a function computes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FunctionKind {
    /// T
    KineticEnergy,
    /// V
    PotentialEnergy,
    /// `p = ∂L/∂q̇`
    Momentum,
    /// `M = ∂²L/∂q̇²`
    MassMatrix,
    /// C
    CoriolisMatrix,
    /// G
    Gravity,
    /// `h = C q̇ + G`
    Bias,
    /// `∂D/∂q̇`
    DissipationForce,
    /// Q
    GeneralizedForce,
    /// `M q̈ + C q̇ + G + ∂D/∂q̇`
    InverseDynamics,
    /// q̈
    ForwardDynamics,
    /// `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u`
    Linearize,
    /// `∂q̈/∂parameters`
    LinearizeParameters,
    /// `∂τ/∂q`, `∂τ/∂q̇`
    InverseDynamicsJacobian,
    /// φ, or the Pfaffian rows at q̇
    Constraint,
    /// `A q̇ + b`
    ConstraintRate,
    /// `∂(A q̇ + b)/∂q`
    ConstraintRateJacobian,
    /// A
    ConstraintJacobian,
    /// γ
    ConstraintBias,
    /// λ
    Multipliers,
    /// First integrals, with their names.
    Conserved(Vec<String>),
    /// The value of the output with this number.
    Output(usize),
    /// The velocity of the output with this number.
    OutputVelocity(usize),
    /// The Jacobian of the output with this number.
    OutputJacobian(usize),
    /// The derivatives by q̇ of the output with this number, which depends on velocities.
    OutputJacobianQd(usize),
    /// The derivatives by u of the output with this number, which depends on inputs.
    OutputJacobianU(usize),
    /// The time derivative of the Jacobian of the output with this number.
    OutputJacobianRate(usize),
    /// The wrenches at the joints of the reaction with this number.
    Reaction(usize),
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
    /// They are the lower triangle of M, the rows of A, and then right sides f and c; the results are q̈ of `M q̈ − Aᵀ
    /// λ = f`, `A q̈ = c`, found by the runtime's `constrained_solve`.
    SolveConstrained,
    /// Likewise, but the results are λ.
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

/// Makes the Programs, each function by its cheapest route; the routes are equal in value, the first wins a draw.
pub fn straight_line(lagrangian: &Lagrangian<'_>, routes: &[Equations<'_>]) -> Derivation {
    let mut forms = Forms::default();
    let roots = cheapest(ways(lagrangian, routes), &mut forms);
    let hoisting = Hoisting::of(roots.iter().map(|f| f.roots.as_slice()), &mut forms);
    let mut functions: Vec<Function> = roots.into_iter().map(|f| f.into_function(&hoisting)).collect();
    count_constrained_motion(&mut functions);
    let graph = Graph::new();
    let (requirements, required) = requirements(lagrangian, &graph);
    let depends_on_time = functions.iter().any(|f| f.program.uses(|symbol| symbol == Symbol::Time));
    Derivation {
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
        output_units: lagrangian.outputs.iter().map(|output| output.units.clone()).collect(),
        depends_on_time,
        constructor: hoisting.constructor,
        requirements,
        required: lower::program(&required, &Hoisting::none()),
        functions,
    }
}

/// The functions by each route, without sums that vanish: of all of them at once, since they have most nodes in common.
/// Accelerations and their derivatives keep them: they are differences of equations, and what these have in common has
/// to round alike, where a coordinate has 1e-8 of the inertia of another.
fn ways<'g>(lagrangian: &Lagrangian<'_>, routes: &[Equations<'g>]) -> Vec<(Route, Vec<Roots<'g>>)> {
    let mut ways: Vec<_> = routes.iter().map(|route| (route.route, functions(route, &lagrangian.reactions))).collect();
    let simplified = ways.iter_mut().flat_map(|(_, functions)| functions).filter(|function| !function.kind.is_solved());
    let mut roots: Vec<&mut Expr<'g>> = simplified.flat_map(|function| &mut function.roots).collect();
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

impl FunctionKind {
    /// Whether a system of the equations of motion is solved for it.
    fn is_solved(&self) -> bool {
        use FunctionKind as Kind;
        matches!(self, Kind::ForwardDynamics | Kind::Linearize | Kind::LinearizeParameters | Kind::Multipliers)
    }
}

impl Derivation {
    /// Number of coordinates.
    pub fn dof(&self) -> usize {
        self.coordinates.iter().map(Variable::count).sum()
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

    /// The requirements with the numbers that they are about, of all that [`required`](Self::required) gives.
    pub fn conditions<'d, V>(&'d self, values: &'d [V]) -> impl Iterator<Item = (&'d Requirement, &'d [V])> {
        let mut rest = values;
        self.requirements.iter().map(move |requirement| {
            let (own, behind) = rest.split_at(Condition::count(requirement.condition));
            rest = behind;
            (requirement, own)
        })
    }

    /// The function with this name.
    pub fn function(&self, name: &str) -> Option<&Function> {
        self.functions.iter().find(|f| f.name == name)
    }
}

/// A function before it is scheduled.
struct Roots<'g> {
    name: String,
    kind: FunctionKind,
    arguments: Vec<Argument>,
    results: Vec<ResultPart>,
    roots: Vec<Expr<'g>>,
    completion: Completion,
    /// Coordinates and rows of the system that the completion solves.
    size: [usize; 2],
    route: Route,
}

impl<'g> Roots<'g> {
    fn new(name: &str, kind: FunctionKind, arguments: &[Argument], shape: Shape, roots: Vec<Expr<'g>>) -> Self {
        let results = vec![ResultPart { name: "", shape }];
        let arguments = arguments.to_vec();
        Roots {
            name: name.to_string(),
            kind,
            arguments,
            results,
            roots,
            completion: Completion::None,
            size: [0; 2],
            route: Route::Plain,
        }
    }

    /// What a call would cost if nothing else were generated.
    fn cost(&self, forms: &mut Forms) -> Operations {
        let hoisting = Hoisting::of([self.roots.as_slice()].into_iter(), forms);
        self.completed(cost::operations(&lower::program(&self.roots, &hoisting)))
    }

    /// With what the completion takes.
    fn completed(&self, operations: Operations) -> Operations {
        match self.completion {
            Completion::None => operations,
            Completion::Solve => operations + cost::solve(self.size[0], &self.results),
            Completion::SolveConstrained | Completion::SolveMultipliers => {
                operations + cost::solve_constrained(self.size, &self.results)
            }
        }
    }

    fn into_function(self, hoisting: &Hoisting) -> Function {
        let program = lower::program(&self.roots, hoisting);
        let operations = self.completed(cost::operations(&program));
        let Roots { name, kind, arguments, results, completion, route, .. } = self;
        Function { name, kind, arguments, results, program, completion, operations, route }
    }
}

/// The cheapest of several ways to compute each function; the first wins a draw.
fn cheapest<'g>(routes: Vec<(Route, Vec<Roots<'g>>)>, forms: &mut Forms) -> Vec<Roots<'g>> {
    let only_one = routes.len() == 1;
    let mut best: Vec<(usize, Roots<'g>)> = Vec::new();
    for (route, functions) in routes {
        for (i, function) in functions.into_iter().enumerate() {
            let cost = if only_one { 0 } else { function.cost(forms).weight() };
            let function = Roots { route, ..function };
            match best.get_mut(i) {
                Some(one) if cost < one.0 => *one = (cost, function),
                Some(_) => {}
                None => best.push((cost, function)),
            }
        }
    }
    best.into_iter().map(|(_, function)| function).collect()
}

/// What each function would cost by each route, in the order of the functions and of the routes; of a route with
/// several ways by the cheapest.
pub fn compared(lagrangian: &Lagrangian<'_>, routes: &[Equations<'_>]) -> Vec<Vec<(Route, Operations)>> {
    let mut forms = Forms::default();
    let ways = ways(lagrangian, routes);
    let mut costs = |functions: &[Roots<'_>]| functions.iter().map(|function| function.cost(&mut forms)).collect();
    let by_route: Vec<Vec<Operations>> = ways.iter().map(|(_, functions)| costs(functions)).collect();
    let function = |i: usize| {
        let mut all: Vec<(Route, Operations)> = Vec::new();
        for (route, costs) in routes.iter().zip(&by_route) {
            match all.iter_mut().find(|(known, _)| *known == route.route) {
                Some((_, known)) if known.weight() <= costs[i].weight() => {}
                Some((_, known)) => *known = costs[i],
                None => all.push((route.route, costs[i])),
            }
        }
        all
    };
    (0..by_route.first().map_or(0, Vec::len)).map(function).collect()
}

/// The functions of a mechanism, in the order of the documentation.
fn functions<'g>(equations: &Equations<'g>, reactions: &[Reaction]) -> Vec<Roots<'g>> {
    use Argument::{Q, Qd, Qdd, U};
    use FunctionKind as Kind;
    let n = equations.symbols.q.len();
    let e = &equations.lagrange;
    let vector = Shape::Vector(n);
    let mut functions = vec![
        Roots::new("kinetic_energy", Kind::KineticEnergy, &[Q, Qd], Shape::Scalar, vec![e.kinetic_energy]),
        Roots::new("potential_energy", Kind::PotentialEnergy, &[Q], Shape::Scalar, vec![e.potential_energy]),
        Roots::new("momentum", Kind::Momentum, &[Q, Qd], vector, e.momentum.clone()),
        Roots::new("mass_matrix", Kind::MassMatrix, &[Q], Shape::Symmetric(n), lower_triangle(&e.mass_matrix)),
        Roots::new("coriolis_matrix", Kind::CoriolisMatrix, &[Q, Qd], Shape::Matrix(n, n), e.coriolis_matrix.concat()),
        Roots::new("gravity", Kind::Gravity, &[Q], vector, e.gravity.clone()),
        Roots::new("bias", Kind::Bias, &[Q, Qd], vector, e.bias.clone()),
        Roots::new("dissipation_force", Kind::DissipationForce, &[Q, Qd], vector, e.dissipation_force.clone()),
        Roots::new("generalized_force", Kind::GeneralizedForce, &[Q, Qd, U], vector, e.generalized_force.clone()),
        Roots::new("inverse_dynamics", Kind::InverseDynamics, &[Q, Qd, Qdd], vector, e.inverse_dynamics.clone()),
        forward_dynamics(equations),
    ];
    functions.extend(linearizations(equations));
    functions.push(inverse_dynamics_jacobian(equations));
    functions.push(conserved(equations));
    if equations.constraints.count() > 0 {
        functions.extend(constraints(equations));
    }
    functions.extend((0..equations.outputs.len()).flat_map(|i| output(equations, i)));
    let wrenches = reactions.iter().zip(&equations.reactions).enumerate();
    functions.extend(wrenches.map(|(i, (joints, wrenches))| reaction(i, joints, wrenches)));
    functions
}

fn lower_triangle<'g>(m: &Rows<'g>) -> Vec<Expr<'g>> {
    m.iter().enumerate().flat_map(|(i, row)| row[..=i].to_vec()).collect()
}

fn forward_dynamics<'g>(equations: &Equations<'g>) -> Roots<'g> {
    let forward = &equations.forward_dynamics;
    let arguments = [Argument::Q, Argument::Qd, Argument::U];
    let shape = Shape::Vector(equations.symbols.q.len());
    let roots = forward.unrolled.clone().unwrap_or_else(|| [system(forward), forward.right_side.clone()].concat());
    let function = Roots::new("forward_dynamics", FunctionKind::ForwardDynamics, &arguments, shape, roots);
    Roots { completion: completion(forward), size: size(forward), ..function }
}

/// How accelerations are found from what a program computes.
fn completion(forward: &ForwardDynamics<'_>) -> Completion {
    match (&forward.unrolled, forward.jacobian.len()) {
        (Some(_), _) => Completion::None,
        (None, 0) => Completion::Solve,
        (None, _) => Completion::SolveConstrained,
    }
}

/// The lower triangle of M, then A, where they are solved with at run time.
fn system<'g>(forward: &ForwardDynamics<'g>) -> Vec<Expr<'g>> {
    match forward.unrolled {
        Some(_) => Vec::new(),
        None => [lower_triangle(&forward.mass_matrix), forward.jacobian.concat()].concat(),
    }
}

/// Coordinates and rows.
fn size(forward: &ForwardDynamics<'_>) -> [usize; 2] {
    [forward.mass_matrix.len(), forward.jacobian.len()]
}

fn linearizations<'g>(equations: &Equations<'g>) -> Vec<Roots<'g>> {
    let forward = &equations.forward_dynamics;
    let (leading, completion) = (system(forward), completion(forward));
    let n = equations.symbols.q.len();
    let part = |name, rows: &Rows<'g>| ResultPart { name, shape: Shape::Matrix(n, rows[0].len()) };
    let [q, qd, u] = &equations.linearization.state;
    let parameters = &equations.linearization.parameters;
    let arguments = vec![Argument::Q, Argument::Qd, Argument::U];
    let state = Roots {
        name: "linearize".to_string(),
        kind: FunctionKind::Linearize,
        arguments: arguments.clone(),
        results: vec![part("q", q), part("qd", qd), part("u", u)],
        roots: [leading.clone(), q.concat(), qd.concat(), u.concat()].concat(),
        completion,
        size: size(forward),
        route: Route::Plain,
    };
    let parameters = (!parameters[0].is_empty()).then(|| Roots {
        name: "linearize_parameters".to_string(),
        kind: FunctionKind::LinearizeParameters,
        arguments,
        results: vec![part("", parameters)],
        roots: [leading, parameters.concat()].concat(),
        completion,
        size: size(forward),
        route: Route::Plain,
    });
    [state].into_iter().chain(parameters).collect()
}

fn inverse_dynamics_jacobian<'g>(equations: &Equations<'g>) -> Roots<'g> {
    let jacobian = &equations.inverse_dynamics_jacobian;
    let n = jacobian.q.len();
    let part = |name| ResultPart { name, shape: Shape::Matrix(n, n) };
    Roots {
        name: "inverse_dynamics_jacobian".to_string(),
        kind: FunctionKind::InverseDynamicsJacobian,
        arguments: vec![Argument::Q, Argument::Qd, Argument::Qdd],
        results: vec![part("q"), part("qd")],
        roots: [jacobian.q.concat(), jacobian.qd.concat()].concat(),
        completion: Completion::None,
        size: [0; 2],
        route: Route::Plain,
    }
}

/// φ, `A q̇ + b` and its slopes, A, γ and λ.
fn constraints<'g>(equations: &Equations<'g>) -> Vec<Roots<'g>> {
    use Argument::{Q, Qd, U};
    let (constraints, forward) = (&equations.constraints, &equations.forward_dynamics);
    let (m, n) = (constraints.count(), equations.symbols.q.len());
    let roots = [system(forward), forward.right_side.clone()].concat();
    let rows = Shape::Vector(m);
    let [jacobian, rate_jacobian] = [&constraints.jacobian, &constraints.rate_jacobian].map(|rows| rows.concat());
    let matrix = Shape::Matrix(m, n);
    let multipliers = Roots::new("multipliers", FunctionKind::Multipliers, &[Q, Qd, U], rows, roots);
    vec![
        Roots::new("constraint", FunctionKind::Constraint, &[Q, Qd], rows, constraints.value.clone()),
        Roots::new("constraint_rate", FunctionKind::ConstraintRate, &[Q, Qd], rows, constraints.rate.clone()),
        Roots::new("constraint_rate_jacobian", FunctionKind::ConstraintRateJacobian, &[Q, Qd], matrix, rate_jacobian),
        Roots::new("constraint_jacobian", FunctionKind::ConstraintJacobian, &[Q], matrix, jacobian),
        Roots::new("constraint_bias", FunctionKind::ConstraintBias, &[Q, Qd], rows, constraints.bias.clone()),
        Roots { completion: Completion::SolveMultipliers, size: size(forward), ..multipliers },
    ]
}

fn conserved<'g>(equations: &Equations<'g>) -> Roots<'g> {
    let (names, values): (Vec<_>, Vec<_>) = equations.conserved.iter().map(|c| (c.name.clone(), c.value)).unzip();
    let shape = Shape::Vector(values.len());
    Roots::new("conserved", FunctionKind::Conserved(names), &[Argument::Q, Argument::Qd], shape, values)
}

/// An output's value, velocity, Jacobians and their rate; each takes the arguments that it depends on, and q in any
/// case.
fn output<'g>(equations: &Equations<'g>, number: usize) -> Vec<Roots<'g>> {
    let output = &equations.outputs[number];
    let name = &output.name;
    let shape = match output.shape {
        OutputShape::Scalar => Shape::Scalar,
        OutputShape::Array(n) => Shape::Vector(n),
        OutputShape::Matrix(rows, columns) => Shape::Matrix(rows, columns),
        OutputShape::Pose => Shape::Pose,
        OutputShape::Matrices(n, rows, columns) => Shape::Matrices(n, rows, columns),
        OutputShape::Poses(n) => Shape::Poses(n),
    };
    let function = |name: &str, kind, shape, roots: Vec<Expr<'g>>| {
        let arguments = arguments_of(&roots);
        Roots::new(name, kind, &arguments, shape, roots)
    };
    let rate_shape = match shape {
        Shape::Pose => Shape::Vector(6),
        Shape::Poses(n) => Shape::Matrix(n, 6),
        shape => shape,
    };
    let mut functions = vec![function(name, FunctionKind::Output(number), shape, output.value.clone())];
    if let Some(velocity) = &output.velocity {
        let kind = FunctionKind::OutputVelocity(number);
        functions.push(function(&format!("{name}_velocity"), kind, rate_shape, velocity.clone()));
    }
    let jacobian = &output.jacobian;
    let jacobian_shape = Shape::Matrix(jacobian.len(), equations.symbols.q.len());
    let kind = FunctionKind::OutputJacobian(number);
    functions.push(function(&format!("{name}_jacobian"), kind, jacobian_shape, jacobian.concat()));
    for (suffix, kind, rows) in [
        ("jacobian_qd", FunctionKind::OutputJacobianQd(number), &output.jacobian_qd),
        ("jacobian_u", FunctionKind::OutputJacobianU(number), &output.jacobian_u),
    ] {
        if let Some(rows) = rows {
            let shape = Shape::Matrix(rows.len(), rows.first().map_or(0, Vec::len));
            functions.push(function(&format!("{name}_{suffix}"), kind, shape, rows.concat()));
        }
    }
    if let Some(rate) = &output.jacobian_rate {
        let kind = FunctionKind::OutputJacobianRate(number);
        functions.push(function(&format!("{name}_jacobian_rate"), kind, jacobian_shape, rate.concat()));
    }
    functions
}

/// The wrenches of a reaction; it takes q, q̇ and q̈ in any case.
fn reaction<'g>(number: usize, reaction: &Reaction, wrenches: &[Expr<'g>]) -> Roots<'g> {
    let shape = reaction.length.map_or(Shape::Wrench, Shape::Wrenches);
    let mut arguments = vec![Argument::Q, Argument::Qd, Argument::Qdd];
    arguments.extend(arguments_of(wrenches));
    arguments.sort();
    arguments.dedup();
    Roots::new(&reaction.name, FunctionKind::Reaction(number), &arguments, shape, wrenches.to_vec())
}

fn arguments_of(roots: &[Expr<'_>]) -> Vec<Argument> {
    let mut arguments = vec![Argument::Q];
    if let Some(first) = roots.first() {
        let graph = first.graph();
        for id in graph.reachable(roots.iter().map(|root| root.id())) {
            arguments.extend(match graph.node(id) {
                crate::expr::Node::Symbol(symbol) => argument_of(symbol),
                _ => None,
            });
        }
    }
    arguments.sort();
    arguments.dedup();
    arguments
}

/// The argument that a symbol is a component of; time and parameters are not among them.
fn argument_of(symbol: Symbol) -> Option<Argument> {
    match symbol {
        Symbol::Coordinate(_) => Some(Argument::Q),
        Symbol::Velocity(_) => Some(Argument::Qd),
        Symbol::Acceleration(_) => Some(Argument::Qdd),
        Symbol::Input(_) => Some(Argument::U),
        Symbol::Multiplier(_) => Some(Argument::Multipliers),
        Symbol::Time | Symbol::Parameter(_) | Symbol::Prescribed(..) => None,
    }
}
