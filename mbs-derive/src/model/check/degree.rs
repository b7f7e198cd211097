//! What must hold of the energies and constraints as functions of the velocities.
//!
//! L is quadratic in q̇ and V does not depend on it; constraints are linear in it and independent; every motion that
//! they leave has inertia. A declaration that fails has no equations of motion of the form `M q̈ + C q̇ + G + ∂D/∂q̇ =
//! Q + Aᵀλ`.
//!
//! Degrees are decided on the expressions (`velocity`), signs and sizes at random states (`inertia`, `rank`).

use std::fmt;

use crate::diagnostic::Code;
use crate::expr::{
    Dual, Expr, Graph, Number, Residue, Rounded, Symbol, Tape, Value, carry_out, generic, gradient, substitute,
};
use crate::numeric::Random;
use crate::state::State;
use crate::variable::component_names;

use crate::model::check::inertia::{self, Motion};
use crate::model::check::rank::VelocityEquations;
use crate::model::check::relation::Relation;
use crate::model::check::sample::default_parameters;
use crate::model::check::velocity;
use crate::model::frame::Edge;
use crate::model::lagrangian::{Constraint, ConstraintKind, Draft};
use crate::model::names::element::shown;

/// A mistake in the energies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Problem {
    /// The kinetic term with this number is not a polynomial of degree two in the velocities.
    KineticNotQuadratic(usize),
    /// The lagrangian term with this number is not a polynomial of degree two in the velocities.
    LagrangianNotQuadratic(usize),
    /// The potential term with this number depends on velocities.
    PotentialDependsOnVelocity(usize),
    /// The kinetic term with this number divides by what vanishes at rest.
    KineticUndefinedAtRest(usize),
    /// The lagrangian term with this number divides by what vanishes at rest.
    LagrangianUndefinedAtRest(usize),
    /// A row of the constraint with this number divides by what vanishes at rest.
    ConstraintUndefinedAtRest(usize),
    /// Moving this coordinate costs no kinetic energy, at any sampled state.
    NoInertia(usize),
    /// Some motion of these coordinates together costs no kinetic energy, at any sampled state.
    DependentInertia(Vec<usize>),
    /// Moving this coordinate, or it with others, costs negative kinetic energy.
    NegativeInertia(usize),
    /// Moving this coordinate, or it with others, costs negative kinetic energy where this signal is negative, and
    /// never where it is not.
    NegativeSignal(usize, String),
    /// The kinetic term with this number is never positive, and the energy of some motion is negative.
    NegativeKinetic(usize),
    /// The energies are not finite at any sampled state.
    NeverFinite,
    /// The constraint with this number is not linear in the velocities.
    ConstraintNotLinear(usize),
    /// Of the constraint with this number these rows are determined by other rows, in this way.
    DependentConstraint(usize, Vec<usize>, Relation),
    /// The gradient of a row of the constraint with this number vanishes wherever the row holds.
    DegenerateConstraint(usize),
}

impl Problem {
    /// Its code.
    pub(crate) fn code(&self) -> Code {
        match self {
            Problem::KineticNotQuadratic(_) | Problem::LagrangianNotQuadratic(_) => Code::NotQuadratic,
            Problem::PotentialDependsOnVelocity(_) => Code::VelocityInPotential,
            Problem::KineticUndefinedAtRest(_)
            | Problem::LagrangianUndefinedAtRest(_)
            | Problem::ConstraintUndefinedAtRest(_) => Code::UndefinedAtRest,
            Problem::NoInertia(_) => Code::NoInertia,
            Problem::DependentInertia(_) => Code::DependentInertia,
            Problem::NegativeInertia(_) | Problem::NegativeSignal(..) | Problem::NegativeKinetic(_) => {
                Code::NegativeEnergy
            }
            Problem::NeverFinite => Code::NeverFinite,
            Problem::ConstraintNotLinear(_) => Code::ConstraintNotLinear,
            Problem::DependentConstraint(..) => Code::DependentConstraint,
            Problem::DegenerateConstraint(_) => Code::DegenerateConstraint,
        }
    }

    /// In words, with the coordinates' names; lower case, no full stop.
    pub(crate) fn message(&self, lagrangian: &Draft<'_>) -> String {
        let names = component_names(&lagrangian.coordinates);
        match self {
            Problem::KineticNotQuadratic(_) => "kinetic energy must be at most quadratic in the velocities".to_string(),
            Problem::LagrangianNotQuadratic(_) => "a term of L must be at most quadratic in the velocities".to_string(),
            Problem::PotentialDependsOnVelocity(_) => "potential energy must not depend on velocities".to_string(),
            Problem::KineticUndefinedAtRest(_) | Problem::LagrangianUndefinedAtRest(_) => {
                "this energy has no value at rest: it divides by what vanishes there".to_string()
            }
            Problem::ConstraintUndefinedAtRest(i) => format!(
                "the constraint `{}` has no value at rest: it divides by what vanishes there",
                lagrangian.constraints[*i].name
            ),
            Problem::NoInertia(i) => {
                format!("coordinate `{}` has no inertia: no kinetic energy belongs to its velocity", names[*i])
            }
            Problem::DependentInertia(coordinates) => {
                let names: Vec<String> = coordinates.iter().map(|&i| format!("`{}`", names[i])).collect();
                format!(
                    "the mass matrix is singular at every state: {} can move together without kinetic energy",
                    names.join(", ")
                )
            }
            Problem::NegativeInertia(i) => format!("the kinetic energy is negative for some motion of `{}`", names[*i]),
            Problem::NegativeSignal(i, signal) => format!(
                "the kinetic energy is negative for some motion of `{}` where the signal `{signal}` is negative, as it may be \
                 at run time",
                names[*i]
            ),
            Problem::NegativeKinetic(_) => "kinetic energy is never negative, this term is".to_string(),
            Problem::NeverFinite => "the energies are not finite at any of the sampled states".to_string(),
            Problem::ConstraintNotLinear(_) => "a constraint must be linear in the velocities".to_string(),
            Problem::DependentConstraint(i, rows, _) => dependent_rows(&lagrangian.constraints[*i], rows),
            Problem::DegenerateConstraint(i) => format!(
                "where the constraint `{}` holds its gradient vanishes or is not finite: no force can keep it",
                lagrangian.constraints[*i].name
            ),
        }
    }

    /// What to write instead.
    pub(crate) fn help(&self, lagrangian: &Draft<'_>) -> String {
        let names = component_names(&lagrangian.coordinates);
        match self {
            Problem::KineticNotQuadratic(_) => {
                "a speed enters squared, `1/2 * m * dt(x)^2`; what is linear in it belongs in `lagrangian +=`, friction in \
                 `dissipation +=`; where inertia itself depends on the speed there is no mass matrix M(q)"
                    .to_string()
            }
            Problem::LagrangianNotQuadratic(_) => {
                "only `½ q̇ᵀ M q̇ + aᵀ q̇ + L₀` leads to equations that are linear in the accelerations".to_string()
            }
            Problem::PotentialDependsOnVelocity(_) => {
                "a velocity-dependent potential U goes into `lagrangian += -U`, friction into `dissipation +=`".to_string()
            }
            Problem::KineticUndefinedAtRest(_)
            | Problem::LagrangianUndefinedAtRest(_)
            | Problem::ConstraintUndefinedAtRest(_) => {
                "divide it out: `dt(x) + dt(y)` for `(dt(x)^2 - dt(y)^2)/(dt(x) - dt(y))`".to_string()
            }
            Problem::NoInertia(i) => format!("add `kinetic += …` with `dt({})`, or make it an input or a parameter", names[*i]),
            Problem::DependentInertia(coordinates) if holds_a_quaternion(lagrangian, coordinates) => {
                "the length of a quaternion needs a constraint: `constraint unit: w^2 + x^2 + y^2 + z^2 = 1;`".to_string()
            }
            Problem::DependentInertia(_) => {
                "leave out coordinates that the others determine, or give each motion a mass".to_string()
            }
            Problem::NegativeKinetic(_) => {
                "leave out the minus, or check the sign of the mass; the energy of springs and weights is `potential += …;`"
                    .to_string()
            }
            Problem::NegativeSignal(_, signal) => format!(
                "where it never is, say so: write `max({signal}, …)` in its place, with the least value that it takes; or \
                 declare it by a formula"
            ),
            Problem::NegativeInertia(_) => "check the signs of the kinetic terms, and masses and inertias".to_string(),
            Problem::NeverFinite => {
                "check the domains of `sqrt`, `ln`, `asin`, `acos`, divisions, and the defaults of the parameters".to_string()
            }
            Problem::ConstraintNotLinear(_) => {
                "only `a(q, t)·q̇ + b(q, t) = 0` leads to a constraint force `Aᵀλ`".to_string()
            }
            Problem::DependentConstraint(i, rows, relation) => {
                let is_all = rows.len() == lagrangian.constraints[*i].rows.len();
                let leave = if is_all { "leave it out" } else { "keep its other rows only" };
                leave.to_string() + if *relation == Relation::Constant { "" } else { IF_INDEPENDENT }
            }
            Problem::DegenerateConstraint(_) => {
                "write what is zero itself, not its square, its length or its greatest value: `x + y = 0` for `(x + y)^2 = 0`, \
                 `a = b` for `(a - b).norm() = 0`, `theta = pi/2` for `sin(theta) = 1`"
                    .to_string()
            }
        }
    }
}

/// Where rows follow from others by multiples that change with the state, the rows that are left may be too few.
pub(in crate::model) const IF_INDEPENDENT: &str = ", if the rows that are left are independent at every state; else write \
     rows in axes that turn with the mechanism: `v.dot(pose*[1, 0, 0]) = 0`";

/// Whether a quaternion is made of these coordinates alone: its length is a motion of theirs.
fn holds_a_quaternion(lagrangian: &Draft<'_>, coordinates: &[usize]) -> bool {
    lagrangian.frames.iter().any(|frame| match &frame.edge {
        Some(Edge::Quaternion(parts)) => {
            let of = Tape::new(parts).coordinates();
            !of.is_empty() && of.iter().all(|i| coordinates.contains(i))
        }
        Some(Edge::Rotation { .. } | Edge::Translation(_)) | None => false,
    })
}

fn dependent_rows(constraint: &Constraint<'_>, rows: &[usize]) -> String {
    let (name, count) = (&constraint.name, constraint.rows.len());
    if rows.len() == count {
        return format!("the constraint `{name}` follows from the others, or contradicts them");
    }
    let numbers: Vec<String> = rows.iter().map(|row| (row + 1).to_string()).collect();
    let (row, follow, contradict) =
        if rows.len() == 1 { ("row", "follows", "contradicts") } else { ("rows", "follow", "contradict") };
    format!(
        "{row} {} of {count} of the constraint `{name}` {follow} from the other rows, or {contradict} them",
        numbers.join(", ")
    )
}

/// A mechanism built by the builder API that has no equations of motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Malformed {
    /// What is wrong, in words.
    pub messages: Vec<String>,
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.messages.join("; "))
    }
}

impl std::error::Error for Malformed {}

impl Draft<'_> {
    /// Checks what `derive` relies on; the language does so by itself.
    ///
    /// # Errors
    /// `Malformed` lists what is wrong.
    pub fn check(&self) -> Result<(), Malformed> {
        let problems = problems(self);
        let messages: Vec<String> = problems.iter().map(|p| p.message(self)).collect();
        if messages.is_empty() { Ok(()) } else { Err(Malformed { messages }) }
    }
}

/// All problems, found at up to eight states where the energies are finite.
pub(crate) fn problems(lagrangian: &Draft<'_>) -> Vec<Problem> {
    let energies = Energies::new(lagrangian);
    let mut random = Random::new(0x6465_6772_6565);
    let states: Vec<Line> = (0..400)
        .map(|_| Line::random(lagrangian, &mut random))
        .filter(|line| energies.is_finite(line))
        .take(8)
        .collect();
    if states.is_empty() {
        return vec![Problem::NeverFinite];
    }
    let constraints = VelocityEquations::new(lagrangian);
    let mut found = degrees(lagrangian, &states);
    found.extend(constraints.degrees(lagrangian, &states));
    if found.is_empty() {
        found.extend(undefined_at_rest(lagrangian, &states));
    }
    if found.is_empty() {
        found.extend(constraints.problems(lagrangian, &states));
    }
    if found.is_empty() {
        found.extend(inertia::problem(&energies.motion, &constraints, &states, lagrangian.dof()));
    }
    if let [Problem::NegativeInertia(coordinate)] = *found.as_slice() {
        if let Some(signal) = energies.negative_signal(&constraints, &states, lagrangian) {
            return vec![Problem::NegativeSignal(coordinate, signal)];
        }
        let culprits = energies.never_positive(&states);
        found = if culprits.is_empty() { found } else { culprits };
    }
    found
}

/// A state and a direction of velocities through it.
#[derive(Clone)]
pub(in crate::model) struct Line {
    pub(in crate::model) state: State,
    pub(in crate::model) direction: Vec<f64>,
    parameters: Vec<f64>,
    exact_parameters: Vec<Number>,
}

impl Line {
    fn random(lagrangian: &Draft<'_>, random: &mut Random) -> Self {
        let n = lagrangian.dof();
        let defaults = lagrangian.parameters.iter().flat_map(|p| &p.defaults);
        Line {
            state: random.state(lagrangian),
            direction: random.vector(n, 2.0),
            parameters: default_parameters(lagrangian),
            exact_parameters: defaults.copied().collect(),
        }
    }

    /// The value of every symbol at `q̇ + s · direction`.
    pub(in crate::model) fn point(&self, s: f64) -> impl Fn(Symbol) -> Dual<f64> {
        let velocity = move |i: u32| self.state.qd[i as usize] + s * self.direction[i as usize];
        move |symbol| self.with_velocity(&velocity, symbol)
    }

    /// The value of every symbol at other velocities.
    pub(in crate::model) fn with_velocity(&self, velocity: &dyn Fn(u32) -> f64, symbol: Symbol) -> Dual<f64> {
        match symbol {
            Symbol::Time => Dual::new(self.state.t, 1.0),
            Symbol::Coordinate(i) => Dual::new(self.state.q[i as usize], velocity(i)),
            Symbol::Velocity(i) => Dual::fixed(velocity(i)),
            Symbol::Acceleration(_) | Symbol::Multiplier(_) => Dual::fixed(0.0),
            Symbol::Parameter(i) => Dual::fixed(self.parameters[i as usize]),
            Symbol::Input(i) => Dual::fixed(self.state.u[i as usize]),
            Symbol::Prescribed(i, order) => {
                let signal = self.state.prescribed[i as usize];
                Dual::new(signal[usize::from(order)], signal[(usize::from(order) + 1).min(2)])
            }
        }
    }

    /// A symbol's value and rate, with the errors of its rounding.
    pub(in crate::model) fn rounded(&self, velocity: &dyn Fn(u32) -> Rounded, symbol: Symbol) -> Dual<Rounded> {
        let Dual { value, derivative } = self.with_velocity(&|i| velocity(i).value, symbol);
        Dual::new(Rounded::exact(value), Rounded::exact(derivative))
    }

    /// A value in a finite field for every symbol: those of the parameters are their defaults, all others have no
    /// relation.
    pub(in crate::model) fn in_field<const K: usize>(
        &self,
        point: u64,
        velocity: &dyn Fn(u32) -> Residue<K>,
        symbol: Symbol,
    ) -> Dual<Residue<K>> {
        match symbol {
            Symbol::Time => Dual::new(generic(symbol, point), Residue::constant(1.0)),
            Symbol::Coordinate(i) => Dual::new(generic(symbol, point), velocity(i)),
            Symbol::Velocity(i) => Dual::fixed(velocity(i)),
            Symbol::Parameter(i) => Dual::fixed(Residue::number(self.exact_parameters[i as usize])),
            Symbol::Prescribed(i, order) => {
                Dual::new(generic(symbol, point), generic(Symbol::Prescribed(i, order + 1), point))
            }
            Symbol::Acceleration(_) | Symbol::Multiplier(_) | Symbol::Input(_) => Dual::fixed(generic(symbol, point)),
        }
    }
}

/// The terms of T, L and V that are not of their degree in the velocities.
fn degrees(lagrangian: &Draft<'_>, lines: &[Line]) -> Vec<Problem> {
    let beyond = |degree: usize, terms: &[Expr<'_>], problem: fn(usize) -> Problem| {
        let tape = Tape::new(terms);
        let seems = |term: usize| lines.iter().any(|line| seems_beyond(degree, &tape, term, line));
        velocity::beyond(degree, terms, seems).into_iter().map(problem).collect::<Vec<_>>()
    };
    [
        beyond(2, &lagrangian.kinetic, Problem::KineticNotQuadratic),
        beyond(2, &lagrangian.lagrangian, Problem::LagrangianNotQuadratic),
        beyond(0, &lagrangian.potential, Problem::PotentialDependsOnVelocity),
    ]
    .concat()
}

/// The terms of T and L, and the constraints on velocities, whose coefficients of velocities cannot be taken where
/// nothing moves, because they are 0/0 there.
fn undefined_at_rest(lagrangian: &Draft<'_>, lines: &[Line]) -> Vec<Problem> {
    let energies = |terms: &[Expr<'_>], problem: fn(usize) -> Problem| {
        let suspects = velocity::unbounded(terms);
        let tape = Tape::new(&suspects.iter().map(|&term| terms[term]).collect::<Vec<_>>());
        let values: Vec<_> = lines.iter().map(|line| tape.run(|symbol| line.with_velocity(&|_| 0.0, symbol))).collect();
        let is_undefined = |at: usize| values.iter().all(|values| !values[at].value.is_finite());
        let found = suspects.iter().enumerate().filter(|(at, _)| is_undefined(*at));
        found.map(|(_, &term)| problem(term)).collect::<Vec<_>>()
    };
    let mut found = energies(&lagrangian.kinetic, Problem::KineticUndefinedAtRest);
    found.extend(energies(&lagrangian.lagrangian, Problem::LagrangianUndefinedAtRest));
    let constraints = lagrangian.constraints.iter().enumerate();
    let constraints = constraints.filter(|(_, constraint)| {
        constraint.kind == ConstraintKind::Pfaffian
            && velocity::unbounded(&constraint.rows)
                .into_iter()
                .any(|row| changes_at_rest(constraint.rows[row], lagrangian.dof(), lines))
    });
    found.extend(constraints.map(|(number, _)| Problem::ConstraintUndefinedAtRest(number)));
    found
}

/// Whether the coefficients of the velocities in a row, which is linear in them, are others at rest, as the graph
/// simplifies them, than in motion: at none of the states are they the same.
fn changes_at_rest(row: Expr<'_>, n: usize, lines: &[Line]) -> bool {
    let graph = Graph::new();
    let row = carry_out(&[row], &graph, |symbol| inertia::rate(symbol, &graph))[0];
    let velocities: Vec<Symbol> = (0..n as u32).map(Symbol::Velocity).collect();
    let moving = gradient(row, &velocities);
    let resting = substitute(&moving, |symbol| matches!(symbol, Symbol::Velocity(_)).then(|| graph.integer(0)));
    let tape = Tape::new(&[moving, resting].concat());
    let differs = |(moving, resting): (&Dual<f64>, &Dual<f64>)| {
        let size = moving.value.abs().max(resting.value.abs());
        let difference = (moving.value - resting.value).abs();
        // NaN differs from everything.
        difference.is_nan() || difference > 1e-6 * size
    };
    let states = lines.iter().map(|line| tape.run(line.point(0.0)));
    let mut states = states.filter(|values| values[..n].iter().all(|value| value.value.is_finite())).peekable();
    states.peek().is_some() && states.all(|values| values[..n].iter().zip(&values[n..]).any(differs))
}

/// Whether the differences of order `degree + 1`, which vanish of a polynomial of the degree, are more than rounding on
/// a line.
pub(in crate::model) fn seems_beyond(degree: usize, tape: &Tape, root: usize, line: &Line) -> bool {
    let mut values = [0.0, 1.0, 2.0, 3.0].map(|s| tape.run(line.point(s))[root].value).to_vec();
    let size = values.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    for _ in 0..=degree {
        values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    values.iter().any(|difference| difference.abs() > 1e-9 * size)
}

/// Tapes of the terms of T, of `L + V`, which carries all velocities, and of L.
struct Energies {
    kinetic: Tape,
    motion: Motion,
    total: Tape,
}

impl Energies {
    fn new<'g>(lagrangian: &Draft<'g>) -> Self {
        let sum = |terms: &[Expr<'g>]| terms.iter().fold(lagrangian.graph.integer(0), |sum, &term| sum + term);
        let motion = sum(&lagrangian.kinetic) + sum(&lagrangian.lagrangian);
        let total = motion - sum(&lagrangian.potential);
        Energies {
            kinetic: Tape::new(&lagrangian.kinetic),
            motion: Motion::new(motion, lagrangian.dof()),
            total: Tape::new(&[total]),
        }
    }

    fn is_finite(&self, line: &Line) -> bool {
        [0.0, 1.0, 2.0, 3.0].iter().all(|&s| self.total.run(line.point(s))[0].value.is_finite())
    }

    /// The first signal without which there is no negative energy, all others being positive.
    fn negative_signal(
        &self,
        constraints: &VelocityEquations,
        lines: &[Line],
        lagrangian: &Draft<'_>,
    ) -> Option<String> {
        let names = lagrangian.prescribed.iter().flat_map(|signal| match signal.length {
            Some(length) => (0..length).map(|i| shown(&signal.name, &[i])).collect(),
            None => vec![signal.name.clone()],
        });
        let is_negative = |kept: Option<usize>| {
            let positive = |line: &Line| {
                let mut line = line.clone();
                let signals = line.state.prescribed.iter_mut().enumerate().filter(|(i, _)| Some(*i) != kept);
                signals.for_each(|(_, signal)| signal[0] = signal[0].abs());
                line
            };
            let lines: Vec<Line> = lines.iter().map(positive).collect();
            let problem = inertia::problem(&self.motion, constraints, &lines, lagrangian.dof());
            matches!(problem, Some(Problem::NegativeInertia(_)))
        };
        if lagrangian.prescribed.is_empty() || is_negative(None) {
            return None;
        }
        names.enumerate().find(|(number, _)| is_negative(Some(*number))).map(|(_, name)| name)
    }

    /// The kinetic terms that are negative somewhere and positive nowhere.
    fn never_positive(&self, lines: &[Line]) -> Vec<Problem> {
        let values: Vec<Vec<Dual<f64>>> = lines.iter().map(|line| self.kinetic.run(line.point(0.0))).collect();
        let of = |term: usize| values.iter().map(move |values| values[term].value);
        let negative = |term: &usize| of(*term).all(|value| value <= 0.0) && of(*term).any(|value| value < 0.0);
        (0..values[0].len()).filter(negative).map(Problem::NegativeKinetic).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::refusals;

    #[test]
    fn a_signal_that_is_a_mass_may_be_negative() {
        let refused =
            |mass: &str| refusals(&format!("prescribed w[2]: kg; coord s: m; kinetic += 1/2*({mass})*dt(s)^2;"));
        let message = "the kinetic energy is negative for some motion of `s` where the signal `w[1]` is negative, as it may \
                       be at run time; where it never is, say so: write `max(w[1], …)` in its place, with the least value";
        let found = refused("w[1]");
        assert!(found.len() == 1 && found[0].contains(message), "{found:?}");
        assert_eq!(refused("max(w[1], 1 kg)"), [""; 0]);
        // A wrong sign is one, whatever the signal is.
        assert!(refused("-max(w[1], 1 kg)")[0].contains("kinetic energy is never negative, this term is"));
        assert!(refused("m*z/l + abs(w[1])")[0].contains("check the signs of the kinetic terms"));
    }
}
