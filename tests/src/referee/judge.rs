//! One text, read by both: the generated functions, interpreted, against the referee's numbers.
//!
//! How far a number may be off follows from the text and the state: the referee calculates in doubles too, with inputs
//! and every operation off by a rounding, several times; what those differ from the truth is what rounding explains.
//! The bound is a multiple of that.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mbs_derive::expr::Graph;
use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::{Derivation, Function, FunctionKind};
use mbs_derive::source::{Sources, Unreadable};
use mbs_derive::verify::{Failure, Proof};
use mbs_derive::{Analysis, Error};

use super::conserved::unchanged;
use super::evaluate::State;
use super::gauge::{Treatment, treatment};
use super::manifold::held;
use super::mechanism::{Mechanism, count};
use super::number::{Noisy, reseed};
use super::quantities::{Directions, Quantities, Rank, free_motion, quantities};
use super::wide::Wide;
use crate::random::{Random, onto_the_sphere};

/// How many times what rounding explains a number may be off.
const MULTIPLE: f64 = 1000.0;

/// What a function may return where everything that it should return is 0.
const ZERO: f64 = 1.0;

/// This many calculations with roundings.
const SAMPLES: u64 = 3;

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Fault {
    /// The generator refuses a text that the referee understands, and which was drawn to be right.
    Refused(String),
    /// The generator panics.
    Panic(String),
    /// The referee does not understand a text that the generator accepts.
    NotUnderstood(String),
    /// A number is wrong.
    Wrong {
        /// The function that the value is of.
        function: String,
        /// Which number of which function at which state, and what it should be.
        report: String,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::Refused(report) => write!(f, "refused:\n{report}"),
            Fault::Panic(report) => write!(f, "panic: {report}"),
            Fault::NotUnderstood(report) => write!(f, "the referee does not understand: {report}"),
            Fault::Wrong { function, report } => write!(f, "wrong {function}: {report}"),
        }
    }
}

impl Fault {
    /// What two faults have in common that are probably one.
    pub fn kind(&self) -> String {
        let plain =
            |text: &str| text.lines().next().unwrap_or_default().chars().filter(|c| !c.is_ascii_digit()).collect();
        match self {
            // What is said of a proof has the claim in its second line.
            Fault::Refused(report) => {
                let claim = report.lines().find(|line| line.trim_start().starts_with("claim:"));
                plain(report) + claim.map(plain).as_deref().unwrap_or_default()
            }
            Fault::Panic(report) | Fault::NotUnderstood(report) => plain(report),
            Fault::Wrong { function, .. } => function.clone(),
        }
    }
}

/// What was compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Judged {
    /// At how many states.
    pub states: usize,
    /// How many numbers.
    pub numbers: usize,
    /// How many of them rounding leaves no certain digit of, or that have no finite value.
    pub undetermined: usize,
}

/// A text and what it imports.
pub type Text<'a> = (&'a str, &'a BTreeMap<String, String>);

/// Holds the generator's functions against the referee's at `states` random states.
///
/// # Errors
/// The first fault.
pub fn judge((text, imports): Text<'_>, seed: u64, states: usize) -> Result<Judged, Fault> {
    let import = |path: &str| imports.get(path).cloned();
    let sources = gathered(text, imports);
    let derivation = catch_unwind(AssertUnwindSafe(|| derivation(&sources)));
    let derivation = derivation.map_err(|payload| Fault::Panic(said(payload.as_ref())))?.map_err(Fault::Refused)?;
    let mechanism = Mechanism::read(text, &import).map_err(Fault::NotUnderstood)?;
    let mut court = Court { mechanism: &mechanism, derivation: &derivation, judged: Judged::default() };
    court.declarations()?;
    let mut random = Random::new(seed);
    for k in 0..states {
        court.state(&mut random, k)?;
    }
    Ok(court.judged)
}

/// Derives and proves a text that was drawn to be right, and does no more. `None` where its energies are finite at too
/// few states.
///
/// # Errors
/// That it is refused, or a panic.
pub fn proved((text, imports): Text<'_>) -> Result<Option<Proof>, Fault> {
    let sources = gathered(text, imports);
    let attempt = || {
        let graph = Graph::verbatim();
        let refused = |error: &Error| Fault::Refused(error.render_in(&sources));
        let analysis = Analysis::of(&sources, &graph).map_err(|error| refused(&error))?;
        match Proof::of(analysis.lagrangian(), analysis.programs()) {
            Ok(proof) => Ok(Some(proof)),
            Err(Failure::TooFewStates { .. }) => Ok(None),
            Err(failure) => Err(Fault::Refused(failure.to_string())),
        }
    };
    catch_unwind(AssertUnwindSafe(attempt)).map_err(|payload| Fault::Panic(said(payload.as_ref())))?
}

fn gathered(text: &str, imports: &BTreeMap<String, String>) -> Sources {
    let read = |path: &str| {
        let text = imports.get(path).map(|text| text.clone().into_bytes());
        text.ok_or_else(|| Unreadable::new("there is no such file", ""))
    };
    Sources::gather("random.mbs", text, read)
}

fn said(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().cloned();
    text.or_else(|| payload.downcast_ref::<&str>().map(ToString::to_string)).unwrap_or_default()
}

fn derivation(sources: &Sources) -> Result<Derivation, String> {
    let graph = Graph::verbatim();
    let analysis = Analysis::of(sources, &graph).map_err(|error| error.render_in(sources))?;
    analysis.prove(analysis.programs()).map_err(|error| error.to_string())?;
    Ok(analysis.into_programs())
}

struct Court<'a> {
    mechanism: &'a Mechanism,
    derivation: &'a Derivation,
    judged: Judged,
}

/// A state, and what the referee says of it.
struct Case {
    state: State<f64>,
    given: interpret::State,
    truth: Quantities,
    samples: Vec<Quantities>,
    rank: Rank,
    /// Whether the constraints hold.
    holds: bool,
    /// Whether some derivatives of the equations are known.
    differentiated: bool,
}

fn wrong(function: &str, report: String) -> Fault {
    Fault::Wrong { function: function.to_string(), report }
}

impl Court<'_> {
    /// Numbers of everything, and defaults.
    fn declarations(&self) -> Result<(), Fault> {
        let (mechanism, derivation) = (self.mechanism, self.derivation);
        let size = |what: &str, one: usize, other: usize| {
            if one == other { Ok(()) } else { Err(wrong(what, format!("there are {one}, not {other}"))) }
        };
        size("number of coordinates", derivation.dof(), mechanism.dof())?;
        let kinds: Vec<bool> = mechanism.rows.iter().map(|&(_, holonomic)| holonomic).collect();
        if derivation.holonomic != kinds {
            return Err(wrong("rows of constraints", format!("{:?}, not {kinds:?}", derivation.holonomic)));
        }
        let defaults: Vec<f64> = self.defaults();
        size("number of parameters", defaults.len(), mechanism.defaults.len())?;
        for (i, (found, expected)) in defaults.iter().zip(&mechanism.defaults).enumerate() {
            if (found - expected).abs() > 2.0 * f64::EPSILON * expected.abs() {
                return Err(wrong("default of a parameter", format!("number {i} is {found}, not {expected}")));
            }
        }
        Ok(())
    }

    fn defaults(&self) -> Vec<f64> {
        self.derivation.parameters.iter().flat_map(|p| &p.defaults).map(|d| d.to_f64()).collect()
    }

    fn state(&mut self, random: &mut Random, k: usize) -> Result<(), Fault> {
        let drawn = self.draw(random, k);
        let wants_held = !self.mechanism.rows.is_empty() && random.one_in(2);
        let held = if wants_held { held(self.mechanism, &drawn).map_err(Fault::NotUnderstood)? } else { None };
        let (state, holds) = held.map_or((drawn, false), |state| (state, true));
        let directions = (k == 0 || random.one_in(2)).then(|| self.directions(random));
        let directions = directions.as_ref();
        let exact = state.map(&mut Wide::from);
        let understood = |result: Result<(Quantities, Rank), String>| result.map_err(Fault::NotUnderstood);
        let (truth, rank) = understood(quantities(self.mechanism, &exact, directions, None, holds))?;
        let mut samples = Vec::new();
        for sample in 0..SAMPLES {
            reseed(sample + 1);
            let noisy = state.map(&mut Noisy::rounded);
            samples.push(understood(quantities(self.mechanism, &noisy, directions, Some(rank.found), holds))?.0);
        }
        let given = self.given(&state);
        self.first_integrals(&state, &given, rank)?;
        let case = Case { state, given, truth, samples, rank, holds, differentiated: directions.is_some() };
        for function in &self.derivation.functions {
            self.function(function, &case)?;
        }
        self.judged.states += 1;
        Ok(())
    }

    fn function(&mut self, function: &Function, case: &Case) -> Result<(), Fault> {
        let Case { state, given, truth, samples, rank, .. } = case;
        let Some((key, determined)) = self.key(&function.kind, &function.name, *rank) else { return Ok(()) };
        let Some(expected) = truth.get(&key) else {
            let missing = case.differentiated && determined;
            let fault = || wrong(&function.name, "the referee knows no such function".to_string());
            return if missing { Err(fault()) } else { Ok(()) };
        };
        let interpreter = Interpreter::with_parameters(self.derivation, state.parameters.clone());
        let found = catch_unwind(AssertUnwindSafe(|| interpreter.evaluate(function, given)));
        let mut found = found.map_err(|payload| Fault::Panic(said(payload.as_ref())))?;
        if key == "constraint_force" {
            found = carried(&truth["constraint_jacobian"], &found);
        }
        let solved = matches!(
            function.kind,
            FunctionKind::ForwardDynamics
                | FunctionKind::Multipliers
                | FunctionKind::Reaction(_)
                | FunctionKind::Linearize
                | FunctionKind::LinearizeParameters
        );
        // There all is NaN, as generated functions say, even if some of it would not depend on that motion.
        if solved && rank.may_have_no_answer && found.iter().all(|x| x.is_nan()) {
            self.judged.undetermined += found.len();
            return Ok(());
        }
        let report = if function.kind == FunctionKind::ForwardDynamics && !rank.determined() {
            undetermined(&found, case)
        } else {
            let mut compared = [vec![found, expected.clone()], samples_of(samples, &key)].concat();
            if !self.mechanism.quaternions.is_empty() {
                // At constant rates the quaternion would leave the sphere.
                let treatment = if key.ends_with("_slope") { Treatment::Not } else { treatment(&function.kind) };
                if treatment == Treatment::Not {
                    return Ok(());
                }
                compared.iter_mut().for_each(|values| treatment.apply(values, &state.q, &self.mechanism.quaternions));
            }
            let floors = floors(function, expected, case, &self.derivation.holonomic);
            self.compare(&compared[0], &compared[1], &compared[2..], &floors)
        };
        if solved && rank.has_component_near_zero && report.is_err() {
            self.judged.undetermined += expected.len();
            return Ok(());
        }
        report.map_err(|report| wrong(&function.name, format!("{report}\n{}", shown(state))))
    }

    /// Of mechanisms without constraints: with constraints they hold only where these do.
    fn first_integrals(&self, state: &State<f64>, given: &interpret::State, rank: Rank) -> Result<(), Fault> {
        for function in &self.derivation.functions {
            let names = &self.derivation.conserved;
            if function.kind != FunctionKind::Conserved
                || names.is_empty()
                || !self.mechanism.rows.is_empty()
                || !rank.regular
            {
                continue;
            }
            let understood = |result: Result<Vec<f64>, String>| result.map_err(Fault::NotUnderstood);
            let qdd = understood(free_motion(self.mechanism, &state.map(&mut Wide::from)))?;
            reseed(1);
            let rough = understood(free_motion(self.mechanism, &state.map(&mut Noisy::rounded)))?;
            // Accelerations are what is left of terms; what rounding leaves of these says how large they are.
            let sizes: Vec<f64> =
                qdd.iter().zip(&rough).map(|(x, rough)| x.abs() + (x - rough).abs() / f64::EPSILON).collect();
            let u = vec![0.0; given.u.len()];
            let moving = interpret::State { qdd, u, ..given.clone() };
            let unchanged = unchanged(self.derivation, function, names, &state.parameters, &moving, &sizes);
            unchanged.map_err(|report| wrong(&function.name, format!("{report}\n{}", shown(state))))?;
        }
        Ok(())
    }

    /// What the referee calls the results of a function, and whether it has them at every state with derivatives.
    fn key(&self, kind: &FunctionKind, name: &str, rank: Rank) -> Option<(String, bool)> {
        let full = rank.found == rank.full;
        match kind {
            // Where λ is not determined, what it does is.
            FunctionKind::Multipliers if !full && rank.determined() => Some(("constraint_force".to_string(), false)),
            FunctionKind::Multipliers | FunctionKind::Reaction(_) if !full => None,
            FunctionKind::Linearize | FunctionKind::LinearizeParameters => Some((name.to_string(), full)),
            FunctionKind::CoriolisMatrix => Some((name.to_string(), false)),
            FunctionKind::Conserved => None,
            FunctionKind::OutputJacobian(number) => {
                let output = name.strip_suffix("_jacobian").unwrap_or(name);
                let moves = self.derivation.function(FunctionKind::OutputVelocity(*number)).is_some();
                Some((format!("{output}_{}", if moves { "jacobian" } else { "slope" }), true))
            }
            _ => Some((name.to_string(), true)),
        }
    }

    /// Beside what rounding explains, numbers may be off by `floors`.
    fn compare(&mut self, found: &[f64], expected: &[f64], samples: &[Vec<f64>], floors: &[f64]) -> Result<(), String> {
        if found.len() != expected.len() {
            return Err(format!("there are {} numbers, not {}", found.len(), expected.len()));
        }
        let largest = expected.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        for (i, (&found, &expected)) in found.iter().zip(expected).enumerate() {
            let spread = samples.iter().map(|sample| (sample[i] - expected).abs()).fold(0.0, nan_max);
            // What is zero by structure, or of which the referee's own terms leave nothing, may be a difference of
            // other terms on another way.
            let structural = expected.abs() + spread <= 1e-14 * largest || expected.abs() <= 1e-10 * spread;
            let residue = if structural { ZERO.max(largest) } else { expected.abs() };
            let bound = MULTIPLE * spread + 32.0 * f64::EPSILON * residue + floors.get(i).unwrap_or(&0.0);
            // Nobody asked for it, or nobody knows it.
            if expected.is_nan() {
                continue;
            }
            if !bound.is_finite() || bound > 0.1 * expected.abs() && spread > 0.0 {
                self.judged.undetermined += 1;
            }
            if !bound.is_finite() {
                continue;
            }
            self.judged.numbers += 1;
            let error = (found - expected).abs();
            if error.is_nan() || error > bound {
                return Err(format!(
                    "number {i} is {found:e}, not {expected:e}: off by {error:.1e}, rounding explains {spread:.1e}"
                ));
            }
        }
        Ok(())
    }

    /// A few columns of each kind.
    fn directions(&self, random: &mut Random) -> Directions {
        let mut some = |wanted: u64, count: usize| {
            let mut columns: Vec<usize> = (0..wanted).map(|_| (random.bits() % count.max(1) as u64) as usize).collect();
            columns.sort_unstable();
            columns.dedup();
            columns.retain(|&j| j < count);
            columns
        };
        let (n, inputs, parameters) =
            (self.mechanism.dof(), count(&self.mechanism.inputs), self.mechanism.defaults.len());
        let (q, qd, u, parameters) = (some(2, n), some(1, n), some(1, inputs), some(2, parameters));
        Directions { q, qd, u, parameters, coriolis: random.one_in(2) }
    }

    fn draw(&self, random: &mut Random, k: usize) -> State<f64> {
        let mechanism = self.mechanism;
        let n = mechanism.dof();
        let zeros = k > 0 && random.one_in(4);
        let mut q = if zeros { Vec::new() } else { places(random, k, n) };
        let mut some = |n: usize, size: f64| {
            let one = |random: &mut Random| if zeros && random.one_in(3) { 0.0 } else { random.uniform(-size..size) };
            (0..n).map(|_| one(random)).collect::<Vec<f64>>()
        };
        if zeros {
            q = some(n, 2.0);
        }
        let (mut qd, mut qdd) = (some(n, 1.5), some(n, 3.0));
        let u = some(count(&mechanism.inputs), 2.0);
        let prescribed = some(3 * count(&mechanism.prescribed), 1.0).chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
        let t = some(1, 2.0)[0];
        for &first in &mechanism.quaternions {
            let part = first..first + 4;
            onto_the_sphere(&mut q[part.clone()], &mut qd[part.clone()], &mut qdd[part]);
        }
        let near = |value: &f64| if k == 0 { *value } else { value * random.uniform(0.8..1.25) };
        let parameters = self.defaults().iter().map(near).collect();
        State { t, q, qd, qdd, u, prescribed, parameters }
    }

    /// The state for the interpreter, which is given the signals without a formula only.
    fn given(&self, state: &State<f64>) -> interpret::State {
        let State { t, q, qd, qdd, u, prescribed, .. } = state.clone();
        let signals = self.derivation.prescribed.iter().flat_map(|variable| {
            let known = self.mechanism.prescribed.iter().find(|(name, ..)| name.as_ref() == variable.name);
            let (first, length) = known.map_or((0, 0), |(_, first, length)| (*first, length.unwrap_or(1)));
            prescribed[first..first + length].to_vec()
        });
        let prescribed = signals.collect();
        interpret::State { t, q, qd, qdd, u, prescribed }
    }
}

/// Anywhere at first; then near 0, far away, near each other and at right angles as well.
fn places(random: &mut Random, k: usize, n: usize) -> Vec<f64> {
    let kind = if k == 0 { 0 } else { random.bits() % 7 };
    let common = random.uniform(-2.0..2.0);
    let one = |random: &mut Random| match kind {
        0..3 => random.uniform(-2.0..2.0),
        3 => random.uniform(-2e-9..2e-9),
        4 => random.uniform(-2e7..2e7),
        5 => common + random.uniform(-1e-9..1e-9),
        _ => (random.bits() % 5) as f64 * FRAC_PI_2 - PI,
    };
    (0..n).map(|_| one(random)).collect()
}

/// What each number of a function may be off by because of others. An output may have been turned from the axes of a
/// pose, which leaves a rounding of its largest component in all of them, and in its derivatives one of the components
/// times how fast the axes turn; so may the force and the moment of a reaction.
/// What a parameter changes of an acceleration is a difference of changes that forces and inertias make each by itself.
/// The value of a constraint that holds is a difference that a rounding of any coordinate changes, but one of so few
/// digits that the calculations with roundings may all agree by chance.
fn floors(function: &Function, expected: &[f64], Case { state, truth, .. }: &Case, holonomic: &[bool]) -> Vec<f64> {
    let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let speed: f64 = state.qd.iter().map(|v| v.abs()).sum();
    let turned = |turning: f64| {
        let outputs = ["_velocity", "_jacobian", "_jacobian_rate"].map(|end| function.name.strip_suffix(end));
        let output = outputs.into_iter().flatten().find_map(|output| truth.get(output));
        let value = output.map_or(0.0, |value| turning * largest(value));
        vec![4.0 * f64::EPSILON * (largest(expected) + value); expected.len()]
    };
    match &function.kind {
        FunctionKind::Output(_) => turned(0.0),
        FunctionKind::OutputVelocity(_) => turned(speed),
        FunctionKind::OutputJacobian(_) => turned(1.0),
        FunctionKind::OutputJacobianQd(_) | FunctionKind::OutputJacobianU(_) => turned(0.0),
        FunctionKind::OutputJacobianRate(_) => turned(speed),
        FunctionKind::Reaction(_) => {
            expected.chunks(3).flat_map(|vector| vec![4.0 * f64::EPSILON * largest(vector); vector.len()]).collect()
        }
        FunctionKind::Constraint => {
            let terms = |(row, holonomic): (&[f64], &bool)| {
                let along = if *holonomic { &state.q } else { &state.qd };
                row.iter().zip(along).map(|(a, x)| (a * x).abs()).sum::<f64>()
            };
            let rows = truth["constraint_jacobian"].chunks(state.q.len()).zip(holonomic);
            rows.map(|row| 4.0 * f64::EPSILON * terms(row)).collect()
        }
        FunctionKind::LinearizeParameters => {
            let acceleration = truth.get("forward_dynamics").map_or(0.0, |qdd| largest(qdd));
            let by = |p: &f64| if *p == 0.0 { 0.0 } else { 4.0 * f64::EPSILON * acceleration / p.abs() };
            state.parameters.iter().map(by).cycle().take(expected.len()).collect()
        }
        _ => Vec::new(),
    }
}

/// Where there are no accelerations, or many, all are NaN.
fn undetermined(found: &[f64], Case { rank, holds, truth, .. }: &Case) -> Result<(), String> {
    // What is nearly singular may be taken for regular; where constraints hold to rounding they are not contradictory.
    let is_nan = found.iter().all(|x| x.is_nan());
    if is_nan && rank.regular && !rank.contradictory && !rank.may_have_no_answer {
        return Err("everything is NaN, although each motion has inertia that is more than rounding".to_string());
    }
    // Without constraints pivots are not checked: what is singular to rounding gives what rounding makes of it.
    if !rank.clear || *holds || is_nan || truth.get("constraint_jacobian").is_none_or(Vec::is_empty) {
        return Ok(());
    }
    let why = if rank.contradictory { "the rows contradict each other" } else { "some motion has no inertia" };
    Err(format!("{found:?}, although {why}"))
}

/// `Aᵀλ`
fn carried(jacobian: &[f64], multipliers: &[f64]) -> Vec<f64> {
    let n = jacobian.len() / multipliers.len();
    let rows = || jacobian.chunks(n).zip(multipliers);
    (0..n).map(|j| rows().map(|(row, l)| row[j] * l).sum()).collect()
}

fn samples_of(samples: &[Quantities], key: &str) -> Vec<Vec<f64>> {
    samples.iter().filter_map(|sample| sample.get(key)).cloned().collect()
}

fn shown(state: &State<f64>) -> String {
    let State { t, q, qd, qdd, u, prescribed, parameters } = state;
    format!(
        "t = {t:?}\nq = {q:?}\nqd = {qd:?}\nqdd = {qdd:?}\nu = {u:?}\nprescribed = {prescribed:?}\n\
         parameters = {parameters:?}"
    )
}

/// The greater, NaN if either is.
fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
