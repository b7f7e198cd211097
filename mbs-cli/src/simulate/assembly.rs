//! A first state on the constraints, and what there is to say where there is none.

use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::variable::component_names;
use mbs_runtime::{ConstraintError, Constraints, RedundantRows};

use super::collapse;
use crate::equations::{Equations, Motion};
use crate::words::{abridged, vector};

/// A change of a coordinate by less than this, relative to 1 or its size, is rounding of the input.
const NOTICEABLE: f64 = 1e-9;

/// What stays as given while a first state is brought onto the constraints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Held {
    /// Of each coordinate, whether its position stays.
    pub(crate) positions: Vec<bool>,
    /// Of each coordinate, whether its velocity stays.
    pub(crate) velocities: Vec<bool>,
    /// How the user says what stays: an option, or a key of a plan.
    pub(crate) by: &'static str,
}

impl Held {
    /// Nothing of this many coordinates.
    pub(crate) fn nothing(count: usize) -> Self {
        Held { positions: vec![false; count], velocities: vec![false; count], by: "--hold" }
    }

    /// These coordinates with their velocities, an array's name standing for all of its components; or the number of a
    /// name that is none of a coordinate.
    pub(crate) fn named<'n>(
        names: impl Iterator<Item = &'n str>,
        derivation: &Derivation,
        by: &'static str,
    ) -> Result<Self, usize> {
        let components = component_names(&derivation.coordinates);
        let mut held = vec![false; components.len()];
        for (number, name) in names.enumerate() {
            let array = derivation.coordinates.iter().find(|variable| variable.name == name);
            let one = || components.iter().position(|component| component == name).map(|i| i..i + 1);
            let range = array.map(|variable| variable.first..variable.first + variable.count()).or_else(one);
            held[range.ok_or(number)?].fill(true);
        }
        Ok(Held { positions: held.clone(), velocities: held, by })
    }

    fn is_anything(&self) -> bool {
        self.positions.contains(&true) || self.velocities.contains(&true)
    }

    /// Brings the state onto the constraints.
    fn assemble(
        &self,
        equations: &Equations<'_>,
        motion: &mut Motion,
        redundant_rows: RedundantRows,
    ) -> Result<(), ConstraintError> {
        let (t, mut projector) = (equations.start_time(), equations.projector(redundant_rows));
        projector.assemble_separately(equations, t, motion, |i| self.positions[i], |i| self.velocities[i])
    }

    /// Whether there is a state on the constraints with all of this as given, but for rounding.
    pub(crate) fn is_possible(&self, equations: &Equations<'_>, given: &Motion, redundant_rows: RedundantRows) -> bool {
        let mut motion = given.clone();
        // What little the first leaves of the rows would be taken away as soon as the motion starts.
        let all = [self, &Held::nothing(self.positions.len())];
        let is_found = all.iter().all(|held| held.assemble(equations, &mut motion, redundant_rows).is_ok());
        let stays =
            |held: &[bool], from: &[f64], to: &[f64]| (0..held.len()).all(|i| !held[i] || !moved(from[i], to[i]));
        is_found && stays(&self.positions, &given.q, &motion.q) && stays(&self.velocities, &given.qd, &motion.qd)
    }
}

/// Whether a number has changed by more than rounding.
pub(crate) fn moved(from: f64, to: f64) -> bool {
    (from - to).abs() > NOTICEABLE * (1.0 + from.abs())
}

/// Brings the state onto the constraints, but for what is held; what there is to say where that is more than rounding.
pub(crate) fn assemble(
    equations: &Equations<'_>,
    motion: &mut Motion,
    held: &Held,
    redundant_rows: RedundantRows,
) -> Result<Option<String>, String> {
    let given = motion.clone();
    if let Err(error) = held.assemble(equations, motion, redundant_rows) {
        return Err(unassembled(equations, error, &given, held));
    }
    let moved = |from: &[f64], to: &[f64]| from.iter().zip(to).any(|(&a, &b)| moved(a, b));
    let mut changes = Vec::new();
    for (name, from, to) in [("q", &given.q, &motion.q), ("qd", &given.qd, &motion.qd)] {
        if moved(from, to) {
            changes.push(format!("{name} = {}", vector(to)));
        }
    }
    let starts = "the state does not satisfy the constraints; the motion starts from";
    Ok((!changes.is_empty()).then(|| format!("{starts} {}", changes.join(", "))))
}

/// Why there is no first state, where that shows, and what may help.
fn unassembled(equations: &Equations<'_>, error: ConstraintError, given: &Motion, held: &Held) -> String {
    let t = equations.start_time();
    match error {
        // Not in the guess, but in the state that was found.
        ConstraintError::Redundant { .. } => {
            let mut found = given.clone();
            let is_found = held.assemble(equations, &mut found, RedundantRows::LeaveOut).is_ok();
            let at = if is_found { &found } else { given };
            explained(equations, error, t, at)
        }
        ConstraintError::Open { .. } | ConstraintError::Contradiction { .. } if held.is_anything() => {
            explained(equations, error, t, given) + &format!("; `{}` may leave too few coordinates free", held.by)
        }
        ConstraintError::Open { .. } => {
            let rank = equations.projector(RedundantRows::LeaveOut).rank(equations, t, &given.q, |_| ());
            let is_singular = rank.is_ok_and(|rank| rank < equations.rows());
            let hint = if is_singular { "; constraints lose rank there: another guess may do" } else { "" };
            explained(equations, error, t, given) + hint
        }
        _ => explained(equations, error, t, given),
    }
}

/// What there is to say where the state is off the constraints; rows of A that depend on others, though they must not,
/// are an error.
pub(crate) fn leave_open(
    equations: &Equations<'_>,
    motion: &Motion,
    redundant_rows: RedundantRows,
) -> Result<Option<String>, String> {
    let t = equations.start_time();
    check_rows(equations, motion, redundant_rows)?;
    let state = equations.state(t, &motion.q, &motion.qd);
    let [residuals, rates] =
        [FunctionKind::Constraint, FunctionKind::ConstraintRate].map(|kind| equations.rows_of(kind, &state));
    let mut open = Vec::new();
    for (row, name) in equations.row_names().iter().enumerate() {
        if residuals[row].abs() > NOTICEABLE {
            open.push(format!("`{name}` by {:e}", residuals[row]));
        } else if equations.is_holonomic(row) && rates[row].abs() > NOTICEABLE {
            open.push(format!("the rate of `{name}` by {:e}", rates[row]));
        }
    }
    Ok((!open.is_empty()).then(|| format!("the motion starts off the constraints: {}", abridged(&open))))
}

/// Whether no row of A depends on others, or they may.
pub(crate) fn check_rows(
    equations: &Equations<'_>,
    motion: &Motion,
    redundant_rows: RedundantRows,
) -> Result<(), String> {
    let t = equations.start_time();
    let mut rows = Vec::new();
    equations
        .projector(redundant_rows)
        .rank(equations, t, &motion.q, |row| rows.push(row))
        .map_err(|error| explained(equations, error, t, motion))?;
    match (rows.first(), redundant_rows) {
        (Some(&row), RedundantRows::Refuse) => Err(explained(equations, ConstraintError::Redundant { row }, t, motion)),
        _ => Ok(()),
    }
}

/// A projection takes away an integrator's error. Where it takes away more, constraints lose rank there, as those of a
/// flattened parallelogram do, and the nearest state may be on another branch; or steps are too long for the motion.
/// `near` is relative to 1 or the largest number.
pub(crate) fn stays_near(near: f64, free: &Motion, projected: &Motion) -> bool {
    let largest = |numbers: &[f64]| numbers.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let change = |from: &[f64], to: &[f64]| {
        from.iter().zip(to).fold(0.0_f64, |largest, (from, to)| largest.max((to - from).abs()))
    };
    let (positions, velocities) = (change(&free.q, &projected.q), change(&free.qd, &projected.qd));
    positions <= near * (1.0 + largest(&free.q)) && velocities <= near * (1.0 + largest(&free.qd))
}

/// What there is to say of a state that does not stay near, of a motion that begins with the first, and what may pass
/// such a place.
pub(crate) fn strayed(
    equations: &Equations<'_>,
    first: &Motion,
    t: f64,
    [free, projected]: [&Motion; 2],
    way: &str,
) -> String {
    let rank = |t: f64, motion: &Motion| {
        equations.projector(RedundantRows::LeaveOut).rank(equations, t, &motion.q, |_| ()).ok()
    };
    let before = rank(equations.start_time(), first);
    let is_lost = |motion: &Motion| {
        let state = equations.state(t, &motion.q, &motion.qd);
        collapse::least_share(equations, &state).is_some() || rank(t, motion) < before
    };
    let or = if [free, projected].into_iter().any(is_lost) { "" } else { ", or the steps are too long" };
    format!(
        "the motion comes to a singular state at t = {t:?}, where constraints lose rank and it may branch{or}; {way}; \
         the nearest state on them is far, q = {}, qd = {}, at q = {}, qd = {}",
        vector(&projected.q),
        vector(&projected.qd),
        vector(&free.q),
        vector(&free.qd)
    )
}

/// Which row is open though no coordinate changes it, as that of a unit quaternion is where a state leaves it out.
fn open_for_good(equations: &Equations<'_>, t: f64, motion: &Motion) -> Option<String> {
    let state = equations.state(t, &motion.q, &motion.qd);
    let residuals = equations.rows_of(FunctionKind::Constraint, &state);
    let jacobian = equations.rows_of(FunctionKind::ConstraintJacobian, &state);
    let row = (0..equations.rows()).find(|&row| {
        let slopes = &jacobian[row * motion.q.len()..][..motion.q.len()];
        equations.is_holonomic(row) && residuals[row].abs() > NOTICEABLE && slopes.iter().all(|&slope| slope == 0.0)
    })?;
    let (name, residual) = (&equations.row_names()[row], residuals[row]);
    Some(format!(
        "; `{name}` is open by {residual:e}, and at this state no coordinate changes it: give other values to those \
         that it is about"
    ))
}

/// What went wrong with which row, and where.
pub(crate) fn explained(equations: &Equations<'_>, error: ConstraintError, t: f64, motion: &Motion) -> String {
    let name = |row: usize| &equations.row_names()[row];
    let at = format!("at t = {t:?}, q = {}, qd = {}", vector(&motion.q), vector(&motion.qd));
    match error {
        ConstraintError::Open { row, residual } => {
            format!("the constraints do not close: `{}` stays open by {residual:e}, {at}", name(row))
        }
        ConstraintError::Redundant { row } => {
            let mut rows = Vec::new();
            let found =
                equations.projector(RedundantRows::LeaveOut).rank(equations, t, &motion.q, |row| rows.push(row));
            if found.is_err() || rows.is_empty() {
                rows = vec![row];
            }
            let names: Vec<String> = rows.iter().map(|&row| format!("`{}`", name(row))).collect();
            let [what, depends] = if rows.len() == 1 { ["constraint", "depends"] } else { ["constraints", "depend"] };
            format!(
                "{what} {} {depends} on the others, {at}; `--redundant least-norm` goes on with multipliers \
                 of the least norm",
                abridged(&names)
            )
        }
        ConstraintError::Contradiction { row, residual } => {
            format!("constraint `{}` contradicts the others: {residual:e} is left of it, {at}", name(row))
        }
        ConstraintError::SingularMassMatrix(singular) => {
            let what = if equations.rows() == 0 { "a motion" } else { "a motion that the constraints leave" };
            let open = open_for_good(equations, t, motion).unwrap_or_default();
            format!("{what} has no inertia, {at}: {singular}{open}")
        }
        ConstraintError::NonFinite => format!("a constraint or its derivative is infinite or NaN, {at}"),
        other => format!("{other}, {at}"),
    }
}
