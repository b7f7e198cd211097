//! What must hold of the energies as functions of the velocities, tried at random states.
//!
//! L is quadratic in q̇ and V does not depend on it; constraints are linear in it and independent; every motion that they
//! leave has inertia. A declaration that fails has no equations of motion of the form
//! `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀλ`.

use std::fmt;

use crate::expr::{Dual, Expr, Symbol, Tape};
use crate::interpret::State;

use super::frame::Edge;
use super::lagrangian::{ConstraintKind, Lagrangian, component_names};
use super::sample::{Random, default_parameters};

/// A mistake in the energies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Problem {
    /// The kinetic term with this number is not a polynomial of degree two in the velocities.
    KineticNotQuadratic(usize),
    /// The lagrangian term with this number is not a polynomial of degree two in the velocities.
    LagrangianNotQuadratic(usize),
    /// The potential term with this number depends on velocities.
    PotentialDependsOnVelocity(usize),
    /// Moving this coordinate costs no kinetic energy, at any sampled state.
    NoInertia(usize),
    /// Some motion of these coordinates together costs no kinetic energy, at any sampled state.
    DependentInertia(Vec<usize>),
    /// Moving this coordinate, or it with others, costs negative kinetic energy.
    NegativeInertia(usize),
    /// The kinetic term with this number is never positive, and the energy of some motion is negative.
    NegativeKinetic(usize),
    /// The energies are not finite at any sampled state.
    NeverFinite,
    /// The constraint with this number is not linear in the velocities.
    ConstraintNotLinear(usize),
    /// The constraint with this number has a row that the rows before it determine.
    DependentConstraint(usize),
    /// So many rows of constraints are more than there are coordinates.
    TooManyConstraints(usize),
}

impl Problem {
    /// In words, with the coordinates' names; lower case, no full stop.
    pub fn message(&self, lagrangian: &Lagrangian<'_>) -> String {
        let names = component_names(&lagrangian.coordinates);
        match self {
            Problem::KineticNotQuadratic(_) => "kinetic energy must be quadratic in the velocities".to_string(),
            Problem::LagrangianNotQuadratic(_) => "a term of L must be at most quadratic in the velocities".to_string(),
            Problem::PotentialDependsOnVelocity(_) => "potential energy must not depend on velocities".to_string(),
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
            Problem::NegativeKinetic(_) => "kinetic energy is never negative, this term is".to_string(),
            Problem::NeverFinite => "the energies are not finite at any of the sampled states".to_string(),
            Problem::ConstraintNotLinear(_) => "a constraint must be linear in the velocities".to_string(),
            Problem::DependentConstraint(i) => {
                format!(
                    "the constraint `{}` follows from the others, or contradicts them",
                    lagrangian.constraints[*i].name
                )
            }
            Problem::TooManyConstraints(rows) => {
                format!("{rows} rows of constraints on {} coordinates leave no motion", lagrangian.dof())
            }
        }
    }

    /// What to write instead.
    pub fn help(&self, lagrangian: &Lagrangian<'_>) -> String {
        let names = component_names(&lagrangian.coordinates);
        match self {
            Problem::KineticNotQuadratic(_) => {
                "a speed enters squared, `1/2 * m * dt(x)^2`; terms of other kinds belong in `lagrangian +=` or `dissipation +=`"
                    .to_string()
            }
            Problem::LagrangianNotQuadratic(_) => {
                "only `½ q̇ᵀ M q̇ + aᵀ q̇ + L₀` leads to equations that are linear in the accelerations".to_string()
            }
            Problem::PotentialDependsOnVelocity(_) => {
                "a velocity-dependent potential U goes into `lagrangian += -U`, friction into `dissipation +=`".to_string()
            }
            Problem::NoInertia(i) => format!("add `kinetic += …` with `dt({})`, or make it an input or a parameter", names[*i]),
            Problem::DependentInertia(_) if lagrangian.frames.iter().any(|f| matches!(f.edge, Some(Edge::Quaternion(_)))) => {
                "the length of a quaternion needs a constraint: `constraint unit: w^2 + x^2 + y^2 + z^2 = 1;`".to_string()
            }
            Problem::DependentInertia(_) => {
                "leave out coordinates that the others determine, or give each motion a mass".to_string()
            }
            Problem::NegativeKinetic(_) => {
                "leave out the minus, or check the sign of the mass; the energy of springs and weights is `potential += …;`"
                    .to_string()
            }
            Problem::NegativeInertia(_) => "check the signs of the kinetic terms, and masses and inertias".to_string(),
            Problem::NeverFinite => {
                "check the domains of `sqrt`, `ln`, `asin`, `acos`, divisions, and the defaults of the parameters".to_string()
            }
            Problem::ConstraintNotLinear(_) => {
                "only `a(q, t)·q̇ + b(q, t) = 0` leads to a constraint force `Aᵀλ`".to_string()
            }
            Problem::DependentConstraint(_) => "leave it out".to_string(),
            Problem::TooManyConstraints(_) => "leave some out".to_string(),
        }
    }
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

impl Lagrangian<'_> {
    /// Checks what `derive` relies on; the language does so by itself.
    ///
    /// # Errors
    /// [`Malformed`] lists what is wrong.
    pub fn check(&self) -> Result<(), Malformed> {
        let problems = problems(self);
        let messages: Vec<String> = problems.iter().map(|p| p.message(self)).collect();
        if messages.is_empty() { Ok(()) } else { Err(Malformed { messages }) }
    }
}

/// All problems, found at up to eight states where the energies are finite.
pub fn problems(lagrangian: &Lagrangian<'_>) -> Vec<Problem> {
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
    let constraints = Constraints::new(lagrangian);
    let mut found = energies.degrees(&states);
    found.extend(constraints.problems(lagrangian, &states));
    if found.is_empty() {
        found.extend(inertia(&energies, &constraints, &states, lagrangian.dof()));
    }
    if let [Problem::NegativeInertia(_)] = found.as_slice() {
        let culprits = energies.never_positive(&states);
        found = if culprits.is_empty() { found } else { culprits };
    }
    found
}

/// A state and a direction of velocities through it.
struct Line {
    state: State,
    direction: Vec<f64>,
    parameters: Vec<f64>,
}

impl Line {
    fn random(lagrangian: &Lagrangian<'_>, random: &mut Random) -> Self {
        let n = lagrangian.dof();
        Line {
            state: random.state(lagrangian),
            direction: random.vector(n, 2.0),
            parameters: default_parameters(lagrangian),
        }
    }

    /// The value of every symbol at `q̇ + s · direction`.
    fn point(&self, s: f64) -> impl Fn(Symbol) -> Dual<f64> {
        let velocity = move |i: u32| self.state.qd[i as usize] + s * self.direction[i as usize];
        self.point_with(velocity)
    }

    fn point_with(&self, velocity: impl Fn(u32) -> f64) -> impl Fn(Symbol) -> Dual<f64> {
        move |symbol| match symbol {
            Symbol::Time => Dual::new(self.state.t, 1.0),
            Symbol::Coordinate(i) => Dual::new(self.state.q[i as usize], velocity(i)),
            Symbol::Velocity(i) => Dual::fixed(velocity(i)),
            Symbol::Acceleration(_) => Dual::fixed(0.0),
            Symbol::Parameter(i) => Dual::fixed(self.parameters[i as usize]),
            Symbol::Input(i) => Dual::fixed(self.state.u[i as usize]),
            Symbol::Prescribed(i, order) => {
                let signal = self.state.prescribed[i as usize];
                Dual::new(signal[usize::from(order)], signal[(usize::from(order) + 1).min(2)])
            }
            Symbol::Multiplier(_) => Dual::fixed(0.0),
        }
    }
}

/// Tapes of the terms of T, V and L, of `L + V`, which carries all velocities, and of L.
struct Energies {
    kinetic: Tape,
    potential: Tape,
    lagrangian: Tape,
    motion: Tape,
    total: Tape,
}

impl Energies {
    fn new<'g>(lagrangian: &Lagrangian<'g>) -> Self {
        let sum = |terms: &[Expr<'g>]| terms.iter().fold(lagrangian.graph.integer(0), |sum, &term| sum + term);
        let motion = sum(&lagrangian.kinetic) + sum(&lagrangian.lagrangian);
        let total = motion - sum(&lagrangian.potential);
        Energies {
            kinetic: Tape::new(&lagrangian.kinetic),
            potential: Tape::new(&lagrangian.potential),
            lagrangian: Tape::new(&lagrangian.lagrangian),
            motion: Tape::new(&[motion]),
            total: Tape::new(&[total]),
        }
    }

    fn is_finite(&self, line: &Line) -> bool {
        [0.0, 1.0, 2.0, 3.0].iter().all(|&s| self.total.run(line.point(s))[0].value.is_finite())
    }

    fn degrees(&self, lines: &[Line]) -> Vec<Problem> {
        // All terms at once at each point of each line.
        let failing = |tape: &Tape, differs: fn([f64; 4]) -> bool, problem: fn(usize) -> Problem| {
            let mut fails = vec![false; tape.run(lines[0].point(0.0)).len()];
            for line in lines {
                let values = [0.0, 1.0, 2.0, 3.0].map(|s| tape.run(line.point(s)));
                for (term, fails) in fails.iter_mut().enumerate() {
                    *fails |= differs([0, 1, 2, 3].map(|s| values[s][term].value));
                }
            }
            (0..fails.len()).filter(|&term| fails[term]).map(problem).collect::<Vec<_>>()
        };
        [
            failing(&self.kinetic, is_not_quadratic, Problem::KineticNotQuadratic),
            failing(&self.lagrangian, is_not_quadratic, Problem::LagrangianNotQuadratic),
            failing(&self.potential, is_not_constant, Problem::PotentialDependsOnVelocity),
        ]
        .concat()
    }

    /// The kinetic terms that are negative somewhere and positive nowhere.
    fn never_positive(&self, lines: &[Line]) -> Vec<Problem> {
        let values: Vec<Vec<Dual<f64>>> = lines.iter().map(|line| self.kinetic.run(line.point(0.0))).collect();
        let of = |term: usize| values.iter().map(move |values| values[term].value);
        let negative = |term: &usize| of(*term).all(|value| value <= 0.0) && of(*term).any(|value| value < 0.0);
        (0..values[0].len()).filter(negative).map(Problem::NegativeKinetic).collect()
    }

    /// `Mᵢⱼ = L(eᵢ + eⱼ) − L(eᵢ) − L(eⱼ) + L(0)`, the polarization of a quadratic polynomial.
    fn mass_matrix(&self, line: &Line, n: usize) -> Vec<f64> {
        let with = |i: Option<usize>, j: Option<usize>| {
            let one = |k: u32, index: Option<usize>| f64::from(u8::from(index == Some(k as usize)));
            self.motion.run(line.point_with(|k| one(k, i) + one(k, j)))[0].value
        };
        let rest = with(None, None);
        let single: Vec<f64> = (0..n).map(|i| with(Some(i), None)).collect();
        let entry = |i: usize, j: usize| with(Some(i), Some(j)) - single[i] - single[j] + rest;
        (0..n * n).map(|k| entry(k / n, k % n)).collect()
    }
}

/// The third difference of a polynomial of degree two vanishes.
fn is_not_quadratic(f: [f64; 4]) -> bool {
    let size = f.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    (f[3] - 3.0 * f[2] + 3.0 * f[1] - f[0]).abs() > 1e-9 * size
}

fn is_not_constant(f: [f64; 4]) -> bool {
    let size = f.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    f.iter().any(|x| (x - f[0]).abs() > 1e-9 * size)
}

/// The rows of all constraints.
struct Constraints {
    rows: Tape,
    kinds: Vec<ConstraintKind>,
    /// Of each row the number of its constraint.
    owners: Vec<usize>,
}

impl Constraints {
    fn new(lagrangian: &Lagrangian<'_>) -> Self {
        let all =
            || lagrangian.constraints.iter().enumerate().flat_map(|(i, c)| c.rows.iter().map(move |row| (i, c, row)));
        let rows: Vec<Expr<'_>> = all().map(|(_, _, row)| *row).collect();
        Constraints {
            rows: Tape::new(&rows),
            kinds: all().map(|(_, c, _)| c.kind).collect(),
            owners: all().map(|(i, ..)| i).collect(),
        }
    }

    /// `A q̇ + b` where only the velocity with this number is 1, or none.
    fn rates(&self, line: &Line, moving: Option<usize>) -> Vec<f64> {
        let rows = self.rows.run(line.point_with(|i| f64::from(u8::from(moving == Some(i as usize)))));
        let rate = |(row, kind): (Dual<f64>, &ConstraintKind)| match kind {
            ConstraintKind::Holonomic => row.derivative,
            ConstraintKind::Pfaffian => row.value,
        };
        rows.into_iter().zip(&self.kinds).map(rate).collect()
    }

    /// A, row by row.
    fn pfaffian(&self, line: &Line, n: usize) -> Vec<Vec<f64>> {
        let rest = self.rates(line, None);
        let columns: Vec<Vec<f64>> = (0..n).map(|i| self.rates(line, Some(i))).collect();
        (0..rest.len()).map(|row| columns.iter().map(|column| column[row] - rest[row]).collect()).collect()
    }

    fn problems(&self, lagrangian: &Lagrangian<'_>, lines: &[Line]) -> Vec<Problem> {
        let (rows, n) = (self.owners.len(), lagrangian.dof());
        let bent = |row: usize| {
            let along = |line: &Line| [0.0, 1.0, 2.0, 3.0].map(|s| self.rows.run(line.point(s))[row].value);
            self.kinds[row] == ConstraintKind::Pfaffian && lines.iter().any(|line| is_not_linear(along(line)))
        };
        let mut bent: Vec<usize> = (0..rows).filter(|&row| bent(row)).map(|row| self.owners[row]).collect();
        bent.dedup();
        if !bent.is_empty() {
            return bent.into_iter().map(Problem::ConstraintNotLinear).collect();
        }
        if rows > n {
            return vec![Problem::TooManyConstraints(rows)];
        }
        // The first row that is at no state independent of those before it.
        let finite = lines.iter().map(|line| self.pfaffian(line, n));
        let matrices: Vec<_> = finite.filter(|rows| rows.iter().flatten().all(|x| x.is_finite())).collect();
        let independent = matrices.iter().map(|rows| independent_rows(rows)).max();
        match independent {
            Some(first) if first < rows => vec![Problem::DependentConstraint(self.owners[first])],
            _ => Vec::new(),
        }
    }
}

/// How many rows from the first on are independent, by orthogonalization.
fn independent_rows(rows: &[Vec<f64>]) -> usize {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for row in rows {
        let mut rest = row.clone();
        // Twice is enough (Giraud, Langou & Rozložník, The loss of orthogonality in the Gram–Schmidt process, 2005).
        for _ in 0..2 {
            for unit in &basis {
                let along = dot(&rest, unit);
                rest.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
        }
        let length = dot(&rest, &rest).sqrt();
        if length <= 1e-9 * dot(row, row).sqrt() {
            break;
        }
        basis.push(rest.iter().map(|x| x / length).collect());
    }
    basis.len()
}

/// The second differences of a linear function vanish.
fn is_not_linear(f: [f64; 4]) -> bool {
    let size = f.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    (f[2] - 2.0 * f[1] + f[0]).abs().max((f[3] - 2.0 * f[2] + f[1]).abs()) > 1e-9 * size
}

/// `M + Aᵀ A`, with A scaled to the size of M: positive definite where M is so on the motions that constraints leave.
fn constrained_mass_matrix(energies: &Energies, constraints: &Constraints, line: &Line, n: usize) -> Vec<f64> {
    let mut m = energies.mass_matrix(line, n);
    let size = (0..n).fold(0.0, |s: f64, i| s.max(m[i * n + i].abs()));
    for row in constraints.pfaffian(line, n) {
        let squared = row.iter().map(|x| x * x).sum::<f64>();
        if squared.is_finite() && squared > 0.0 {
            (0..n * n).for_each(|k| m[k] += size / squared * row[k / n] * row[k % n]);
        }
    }
    m
}

/// The best-conditioned of the sampled mass matrices decides.
fn inertia(energies: &Energies, constraints: &Constraints, lines: &[Line], n: usize) -> Option<Problem> {
    let matrix = |line| constrained_mass_matrix(energies, constraints, line, n);
    // Of a large mechanism, whose matrix takes n² evaluations, fewer states have to do.
    let tried = lines.iter().take(if n > 20 { 2 } else { lines.len() });
    let ranks: Vec<Elimination> = tried.map(|line| eliminate(&matrix(line), n)).collect();
    if let Some(negative) = ranks.iter().find(|e| e.smallest < -1e-9) {
        return Some(Problem::NegativeInertia(negative.last));
    }
    let best = ranks.iter().max_by(|a, b| a.smallest.total_cmp(&b.smallest))?;
    if best.smallest > 1e-11 {
        return None;
    }
    Some(match best.without_diagonal {
        Some(i) => Problem::NoInertia(i),
        None => Problem::DependentInertia(best.dependent.clone()),
    })
}

/// What a symmetric elimination with the largest pivot first tells of a matrix scaled to a unit diagonal.
#[derive(Clone, Debug)]
pub struct Elimination {
    /// The smallest pivot: 0 where the matrix is singular, negative where it is indefinite.
    pub smallest: f64,
    /// Its row.
    last: usize,
    /// A row whose diagonal is zero.
    without_diagonal: Option<usize>,
    /// The rows whose pivots vanish, and those that they depend on.
    dependent: Vec<usize>,
}

/// Eliminates `m`, a square matrix given row by row.
pub fn eliminate(m: &[f64], n: usize) -> Elimination {
    let diagonal = |i: usize| m[i * n + i];
    let without_diagonal = (0..n).find(|&i| diagonal(i) == 0.0);
    if let Some(i) = (0..n).find(|&i| diagonal(i) < 0.0 || diagonal(i).is_nan()).or(without_diagonal) {
        let smallest = if without_diagonal == Some(i) { 0.0 } else { -1.0 };
        return Elimination { smallest, last: i, without_diagonal, dependent: vec![i] };
    }
    let mut a: Vec<f64> = (0..n * n).map(|k| m[k] / (diagonal(k / n) * diagonal(k % n)).sqrt()).collect();
    let mut left: Vec<usize> = (0..n).collect();
    let mut result = Elimination { smallest: 1.0, last: 0, without_diagonal: None, dependent: Vec::new() };
    while let Some(at) = (0..left.len()).max_by(|&i, &j| a[left[i] * (n + 1)].total_cmp(&a[left[j] * (n + 1)])) {
        let k = left[at];
        let pivot = a[k * n + k];
        if pivot < result.smallest {
            (result.smallest, result.last) = (pivot, k);
        }
        if pivot <= 1e-11 {
            result.dependent = (0..n).filter(|&i| left.contains(&i) || m[i * n + k] != 0.0).collect();
            return result;
        }
        left.swap_remove(at);
        for &i in &left {
            let factor = a[i * n + k] / pivot;
            left.iter().for_each(|&j| a[i * n + j] -= factor * a[k * n + j]);
        }
    }
    result
}
