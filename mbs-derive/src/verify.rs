//! Pass 5: the Programs proved against the energies.
//!
//! At random states, exact zeros among them, each optimised Program is interpreted and compared with the declared
//! energies evaluated by nested dual numbers: no symbolic derivative, no rewrite, no structure of the generator is
//! shared. An error here is a bug of the generator, whatever the declaration says; it stops the build and prints the
//! state.
//!
//! Every side of every branch is to be taken: where the random states do not, others are sought (`coverage`), and what
//! was taken nowhere is said. Where a branch compares what doubles hold exactly, its edge is a state, too.
//!
//! - `witness`: Lagrange's equations from the verbatim energies, by dual numbers;
//! - `claim`: what is compared, one function per claim of the catalogue: those about forces here, those about motions
//!   in `acceleration`, those about outputs in `output`; `group`: many columns at once; `allowed`: states that hold
//!   constraints; `motion`: the motion with constraints, and its derivatives;
//! - `system`: what is claimed of systems that are solved at run time;
//! - `tested`: the numbers that claims are made of; `exact`: the same claims in prime fields, without rounding;
//!   `nodes`: what of a declaration fields cannot decide.

mod acceleration;
mod allowed;
mod claim;
mod coverage;
mod exact;
mod group;
mod inertia;
mod linear;
mod motion;
#[cfg(test)]
mod mutants;
mod nodes;
mod output;
mod system;
mod tested;
mod witness;

use std::collections::BTreeSet;
use std::fmt;

use crate::catalogue::{Claim, FunctionKind};
use crate::derive::time_derivative;
use crate::diagnostic::{Code, Diagnostics};
use crate::expr::{Expr, Graph, Id, Node, Rounded, Symbol, carry_out};
use crate::interpret::State;
use crate::model::Lagrangian;
use crate::model::sample::default_parameters;
use crate::numeric::Random;
use crate::optimise::{Derivation, Instruction, Program};
use crate::variable::count;

use claim::{Trial, doubles};
use coverage::{Choices, Coverage};
use exact::Evidence;
pub use witness::Witness;
use witness::exact;

/// At this many generic states both must agree.
pub const STATES: usize = 20;

/// Until this many states have been met, doubles are asked for what is proved exactly, too: whether the order of
/// operations that is emitted keeps rounding within its bound. A state on constraints is met together with another.
const STATES_OF_KNOWN: usize = 7;

/// Largest relative difference, beside what rounding explains.
pub(crate) const TOLERANCE: f64 = 1e-9;

/// What was proved.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let proof = analysis.prove(analysis.programs()).unwrap();
/// assert!(proof.states >= mbs_derive::verify::STATES && proof.singular == 0);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Proof {
    /// At how many states functions were tried in doubles, those with exact zeros included: what is proved exactly is
    /// compared at the first seven or eight only.
    pub states: usize,
    /// At how many of them some motion has no inertia: Euler angles and polar coordinates have such states.
    pub singular: usize,
    /// The sides of choices that no state was found to take, of which nothing is proved: the number of the choice in
    /// the graph of the declaration, and whether it is the side where its condition holds.
    pub unproved: Vec<(Id, bool)>,
    /// How much holds in prime fields, without rounding.
    pub evidence: Evidence,
    /// The sides that were taken only where something declared has no derivative, as `abs(x)` where x is zero: nothing
    /// is proved of them either.
    pub at_corners: Vec<(Id, bool)>,
}

impl Proof {
    /// Proves every Program of a derivation.
    ///
    /// ```
    /// use mbs_derive::{Analysis, expr::Graph, source::Sources};
    /// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; }";
    /// let graph = Graph::verbatim();
    /// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
    /// let proof = mbs_derive::verify::Proof::of(analysis.lagrangian(), analysis.programs()).unwrap();
    /// assert!(proof.states >= mbs_derive::verify::STATES && proof.unproved.is_empty());
    /// ```
    ///
    /// # Errors
    /// [`Failure::Disagreement`] is a bug of the generator; all others concern the declaration.
    pub fn of(lagrangian: &Lagrangian<'_>, derivation: &Derivation) -> Result<Proof, Failure> {
        if let Some(function) = malformed(derivation) {
            return Err(Failure::Malformed { function });
        }
        if let Some(function) = overflowing(derivation) {
            return Err(Failure::Overflow { function });
        }
        let (witness, choices) = (Witness::new(lagrangian), Choices::of(lagrangian));
        let verdict = exact::decide(&witness, derivation);
        let mut prover = Prover {
            witness: &witness,
            derivation,
            known: &verdict.known,
            coverage: Coverage::new(&choices, lagrangian),
            states: 0,
            singular: 0,
        };
        let mut random = Random::new(0x6d62_7300);
        for (state, parameters) in states_with_zeros(lagrangian, &mut random) {
            prover.prove(&state, &parameters, true)?;
        }
        let tried = 100 * STATES;
        let mut generic = 0;
        for attempt in 0..tried {
            let state = random.state(lagrangian);
            let defaults = default_parameters(lagrangian);
            let as_declared = attempt % 2 == 0;
            let parameters = if as_declared { defaults } else { random.parameters_near(&defaults) };
            // Masses and inertias varied by themselves need not be those of a body.
            generic += usize::from(prover.prove(&state, &parameters, as_declared)?);
            if generic == STATES {
                prover.prove_other_sides()?;
                let Prover { states, singular, coverage, .. } = prover;
                let [unproved, at_corners] = coverage.missing();
                let evidence = verdict.settled(&witness, derivation, coverage.inside())?;
                return Ok(Proof { states, singular, unproved, evidence, at_corners });
            }
        }
        Err(Failure::TooFewStates { finite: generic, tried })
    }

    /// Warns of each branch of which nothing is proved.
    pub fn warn(&self, lagrangian: &Lagrangian<'_>, warnings: &mut Diagnostics) {
        let corners = self.at_corners.iter().map(|side| (side, true));
        for ((id, yes), is_at_corner) in self.unproved.iter().map(|side| (side, false)).chain(corners) {
            let Some(choice) = lagrangian.choices.get(id).filter(|_| remains(lagrangian.graph.expr(*id))) else {
                continue;
            };
            let which = match (lagrangian.graph.node(*id), yes) {
                (Node::Select(..), true) if choice.is_condition => "at which this condition holds",
                (Node::Select(..), false) if choice.is_condition => "at which this condition does not hold",
                (Node::Select(..), true) => "at which the first of these is the smaller one",
                (Node::Select(..), false) => "at which the first of these is not the smaller one",
                (_, true) => "at which what this is of is positive",
                (_, false) => "at which what this is of is negative",
            };
            let found = if is_at_corner { "no state with derivatives was found" } else { "no state was found" };
            let message = format!("{found} {which}: the equations there are not proved");
            let help = match is_at_corner {
                true => {
                    "it comes out so at a corner, as `abs(x) > 0` does not hold at x = 0: compare with a little more than that"
                }
                false => "is the limit in the right unit? what never happens can be left out",
            };
            warnings.warning(Code::NotProved, choice.place.clone(), message).help(help);
        }
    }
}

/// Whether a choice is one: what cannot be negative has no `abs` in the equations.
fn remains(choice: Expr<'_>) -> bool {
    let Node::Call(..) = choice.node() else { return true };
    let graph = Graph::new();
    matches!(carry_out(&[choice], &graph, |symbol| time_derivative(symbol, &graph))[0].node(), Node::Call(..))
}

/// Why there is no proof.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Failure {
    /// The energies are finite at so few of the sampled states that nothing can be said.
    TooFewStates {
        /// At how many they are.
        finite: usize,
        /// How many were tried.
        tried: usize,
    },
    /// The declared kinetic energy is negative for some motion: a mistake in the declaration.
    NegativeInertia {
        /// Where.
        q: Vec<f64>,
    },
    /// A constant of a derived function is beyond what a double holds, though all that was declared is finite.
    Overflow {
        /// Which function.
        function: String,
    },
    /// An instruction uses a value that no instruction before it makes, or that there is not: programs that were
    /// altered.
    Malformed {
        /// Which function.
        function: String,
    },
    /// The generated code and the energies disagree, by less than doubles tell: a bug of the generator.
    Inexact {
        /// What was claimed.
        claim: &'static str,
        /// Which component.
        component: usize,
    },
    /// The generated code and the energies disagree: a bug of the generator.
    Disagreement {
        /// What was claimed.
        claim: &'static str,
        /// Which component.
        component: usize,
        /// What the Program gives.
        found: f64,
        /// What the energies give.
        expected: f64,
        /// Where.
        state: Box<State>,
        /// With which parameters.
        parameters: Vec<f64>,
    },
    /// The emitted text is not the Program that was proved: a bug of the generator.
    Misprint {
        /// In which function, or in which part of the text.
        function: String,
        /// What differs.
        what: String,
    },
}

impl Failure {
    pub(crate) fn code(&self) -> Code {
        match self {
            Failure::TooFewStates { .. } => Code::TooFewStates,
            Failure::NegativeInertia { .. } => Code::NegativeSomewhere,
            Failure::Overflow { .. } => Code::Overflow,
            Failure::Malformed { .. } | Failure::Inexact { .. } | Failure::Disagreement { .. } => Code::Disagreement,
            Failure::Misprint { .. } => Code::Misprint,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::TooFewStates { finite, tried } => write!(
                f,
                "the energies are finite at only {finite} of {tried} sampled states, too few to prove the equations \
                 (coordinates, velocities and inputs of order one, parameters near their defaults)"
            ),
            Failure::NegativeInertia { q } => write!(
                f,
                "the kinetic energy is negative for some motion at q = {q:?}: check the signs of its terms, and masses and inertias"
            ),
            Failure::Overflow { function } => write!(
                f,
                "a constant of `{function}` is beyond what a double holds, {:e}: are the declared numbers in their units, is an \
                 exponent meant?",
                f64::MAX
            ),
            Failure::Malformed { function } => write!(
                f,
                "an instruction of `{function}` uses a value that no instruction before it makes: were the programs altered?"
            ),
            Failure::Inexact { claim, component } => write!(
                f,
                "the derived code disagrees with the declared energies, by less than doubles tell; this is a bug of the \
                 generator, please report it\n  claim: {claim}, component {component}"
            ),
            Failure::Disagreement { claim, component, found, expected, state, parameters } => write!(
                f,
                "the derived code disagrees with the declared energies; this is a bug of the generator, please report it\n  \
                 claim: {}, component {}\n  found {:?}, expected {:?}\n  at t = {:?}\n     q = {:?}\n    qd = {:?}\n   \
                 qdd = {:?}\n     u = {:?}\n  parameters = {:?}",
                claim, component, found, expected, state.t, state.q, state.qd, state.qdd, state.u, parameters
            ),
            Failure::Misprint { function, what } => write!(
                f,
                "the emitted code is not the program that was proved; this is a bug of the generator, please report it\n  \
                 in `{function}`: {what}"
            ),
        }
    }
}

impl std::error::Error for Failure {}

/// Proves at one state after another.
struct Prover<'a, 'c, 'l, 'g> {
    witness: &'a Witness<'l, 'g>,
    derivation: &'a Derivation,
    /// What is proved exactly.
    known: &'a BTreeSet<Claim>,
    coverage: Coverage<'c, 'l, 'g>,
    states: usize,
    singular: usize,
}

impl Prover<'_, '_, '_, '_> {
    /// Whether the energies are finite there, and nothing disagrees.
    fn prove(&mut self, at: &State, with: &[f64], is_physical: bool) -> Result<bool, Failure> {
        let (state, parameters) = (exact(at), with.iter().copied().map(Rounded::exact).collect::<Vec<_>>());
        if !self.witness.is_finite(&state, &parameters) {
            self.coverage.meet(at, with);
            return Ok(false);
        }
        let trial = Trial::new(self.witness, self.derivation, &state, &parameters);
        if self.derivation.function(FunctionKind::MassMatrix).is_none() && !trial.has_accelerations() {
            self.coverage.meet(at, with);
            return Ok(false);
        }
        let (none, few) = (BTreeSet::new(), self.states < STATES_OF_KNOWN);
        let known = if few { &none } else { self.known };
        let proved = trial.prove(known).and_then(|()| {
            let is_singular = is_physical && inertia::is_singular(&trial, at, with)?;
            Ok((is_singular, prove_on_constraints(&trial, known, with, is_physical)?))
        });
        let (is_singular, on_constraints) = match proved {
            // Which side is right nobody knows.
            Err(Failure::Disagreement { state, parameters, .. }) if self.coverage.is_undecided(&state, &parameters) => {
                self.coverage.meet(at, with);
                return Ok(false);
            }
            proved => proved?,
        };
        self.coverage.note(at, with);
        self.states += 1 + usize::from(on_constraints.is_some());
        // A mechanism never is where its constraints do not hold: a quaternion of zeros turns nothing.
        let is_singular = if trial.is_constrained() { on_constraints == Some(true) } else { is_singular };
        self.singular += usize::from(is_singular);
        Ok(true)
    }

    /// At states that take the sides of branches that no other state has taken, and at those between two sides.
    fn prove_other_sides(&mut self) -> Result<(), Failure> {
        for (state, parameters) in self.coverage.states_on_edges() {
            self.prove(&state, &parameters, false)?;
        }
        for side in self.coverage.wanted() {
            let states: Vec<_> = self.coverage.states_on(side).collect();
            for (state, parameters) in states {
                if self.coverage.is_covered(side) {
                    break;
                }
                self.prove(&state, &parameters, false)?;
            }
        }
        Ok(())
    }
}

/// All programs with their names, the constructor first.
fn programs(derivation: &Derivation) -> impl Iterator<Item = (&str, &Program)> {
    let functions = derivation.functions.iter().map(|f| (f.name.as_str(), &f.program));
    std::iter::once(("new", &derivation.constructor)).chain(functions)
}

/// The function with an instruction whose operands are not made before it.
fn malformed(derivation: &Derivation) -> Option<String> {
    let hoisted = derivation.constructor.results.len();
    let is_there = |symbol: Symbol| match symbol {
        Symbol::Time => true,
        Symbol::Coordinate(i) | Symbol::Velocity(i) | Symbol::Acceleration(i) => (i as usize) < derivation.dof(),
        Symbol::Parameter(i) => (i as usize) < count(&derivation.parameters),
        Symbol::Input(i) => (i as usize) < count(&derivation.inputs),
        Symbol::Prescribed(i, order) => (i as usize) < count(&derivation.prescribed) && order < 3,
        Symbol::Multiplier(i) => (i as usize) < derivation.constraints.len(),
    };
    let is_sound = |program: &Program| {
        let mut instructions = program.instructions.iter().enumerate();
        instructions.all(|(at, instruction)| match *instruction {
            Instruction::Symbol(symbol) => is_there(symbol),
            Instruction::Hoisted(k) => (k as usize) < hoisted,
            _ => instruction.operands().all(|operand| operand.index() < at),
        }) && program.results.iter().all(|result| result.index() < program.instructions.len())
    };
    programs(derivation).find(|(_, program)| !is_sound(program)).map(|(name, _)| name.to_string())
}

/// The function with a constant that is not finite.
fn overflowing(derivation: &Derivation) -> Option<String> {
    let overflows = |program: &Program| {
        program.instructions.iter().any(|i| matches!(i, Instruction::Constant(c) if !c.to_f64().is_finite()))
    };
    programs(derivation).find(|(_, program)| overflows(program)).map(|(name, _)| name.to_string())
}

/// Proves once more where the constraints hold, if there are any and such a state is near; whether some motion of a
/// physical mechanism has no inertia there.
fn prove_on_constraints(
    trial: &Trial<'_>,
    known: &BTreeSet<Claim>,
    with: &[f64],
    is_physical: bool,
) -> Result<Option<bool>, Failure> {
    match if trial.is_constrained() { trial.consistent_state() } else { None } {
        Some(state) if trial.is_finite_at(&state) => {
            let there = trial.at(&state);
            there.prove(known)?;
            Ok(Some(is_physical && inertia::is_singular(&there, &doubles(&state), with)?))
        }
        _ => Ok(None),
    }
}

/// All zero, at the origin, at rest, and each coordinate zero by itself: where a derivative by rule would be 0/0.
fn states_with_zeros(lagrangian: &Lagrangian<'_>, random: &mut Random) -> Vec<(State, Vec<f64>)> {
    let n = lagrangian.dof();
    let zero = State {
        t: 0.0,
        q: vec![0.0; n],
        qd: vec![0.0; n],
        qdd: vec![0.0; n],
        u: vec![0.0; count(&lagrangian.inputs)],
        prescribed: vec![[0.0; 3]; count(&lagrangian.prescribed)],
    };
    let mut states = vec![zero];
    states.push(State { q: vec![0.0; n], ..random.state(lagrangian) });
    states.push(State { qd: vec![0.0; n], ..random.state(lagrangian) });
    for i in 0..n.min(8) {
        let mut state = random.state(lagrangian);
        (state.q[i], state.qd[i]) = (0.0, 0.0);
        states.push(state);
    }
    let parameters = default_parameters(lagrangian);
    states.into_iter().map(|state| (state, parameters.clone())).collect()
}
