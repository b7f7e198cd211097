//! How many motions constraints leave: as their rows are counted, and as their rank says.

use std::collections::BTreeSet;

use mbs_derive::expr::Number;
use mbs_derive::interpret::State;
use mbs_derive::optimise::Derivation;
use mbs_runtime::RedundantRows;

use crate::equations::Equations;
use crate::failure::Failure;
use crate::output;
use crate::state::Point;
use crate::words::{abridged, plural};

/// This many guesses of each size are brought onto the constraints.
const GUESSES: usize = 6;

/// Mechanisms are as large as a machine, or as small as a watch; angles and plain numbers are of the order of 1.
const SIZES: [f64; 3] = [1.0, 1e-2, 1e-4];

/// How many motions there are, with default parameters.
pub(crate) struct Freedom {
    coordinates: usize,
    /// Rows of all constraints.
    pub(crate) rows: usize,
    /// The ranks that are found, rising: where there are several ways to close a loop, they may differ. Empty where no
    /// state was found that satisfies the constraints.
    ranks: Vec<usize>,
    /// Whether they are those of states that were given.
    is_of_states: bool,
}

impl Freedom {
    /// Counted, and tried near the origin.
    pub(crate) fn of(derivation: &Derivation) -> Result<Self, Failure> {
        let (coordinates, rows) = (derivation.dof(), derivation.constraints.len());
        let mut ranks = if rows == 0 { vec![0] } else { ranks(derivation, &origin(derivation))? };
        // Where it can be assembled so that it moves, it is not meant to be so that it does not.
        if ranks.first().is_some_and(|&least| least < coordinates) {
            ranks.retain(|&rank| rank < coordinates);
        }
        Ok(Freedom { coordinates, rows, ranks, is_of_states: false })
    }

    /// As the mechanism is assembled at given states, or nearest to them.
    ///
    /// # Errors
    /// No state near one of them satisfies the constraints.
    pub(crate) fn at(derivation: &Derivation, points: &[Point]) -> Result<Self, Failure> {
        let (coordinates, rows) = (derivation.dof(), derivation.constraints.len());
        let mut ranks: Vec<usize> = points.iter().map(|point| rank_at(derivation, point)).collect::<Result<_, _>>()?;
        ranks.sort_unstable();
        ranks.dedup();
        Ok(Freedom { coordinates, rows, ranks, is_of_states: true })
    }

    /// Degrees of freedom: the most that are found.
    pub(crate) fn count(&self) -> Option<usize> {
        self.counts().first().copied()
    }

    /// Degrees of freedom of all the ways to assemble it that are found, the most first.
    pub(crate) fn counts(&self) -> Vec<usize> {
        self.ranks.iter().map(|rank| self.coordinates - rank).collect()
    }

    /// `, 2 constraint rows: 1 degree of freedom`; empty without constraints.
    pub(crate) fn summary(&self) -> String {
        let Freedom { coordinates, rows, .. } = *self;
        if rows == 0 {
            return String::new();
        }
        let count = plural(rows, "constraint row", "constraint rows");
        let free = |rank: usize| plural(coordinates - rank, "degree of freedom", "degrees of freedom");
        let counted = coordinates as i64 - rows as i64;
        let there = if self.is_of_states { " at the state" } else { "" };
        match self.ranks[..] {
            [] => format!(", {count} that no state near the origin was found to satisfy"),
            [rank] if rank == rows => format!(", {count}: {}{there}", free(rank)),
            [rank] => format!(", {count} of rank {rank}{there}: {} (Grübler counts {counted})", free(rank)),
            [_, ..] => {
                let listed = |numbers: &[usize]| numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" or ");
                format!(
                    ", {count} of rank {}: {} degrees of freedom, as it is assembled (Grübler counts {counted})",
                    listed(&self.ranks),
                    listed(&self.counts()),
                )
            }
        }
    }
}

/// Beyond this many operations the rank at a state is not looked at.
const MOST_OPERATIONS: usize = 100_000_000;

/// Of a mechanism at several states: where fewer rows of the constraints are independent than elsewhere, it has more
/// degrees of freedom, or a row is missing.
pub(crate) struct LostRank<'d> {
    derivation: &'d Derivation,
    /// With these parameters, the rank at other states.
    elsewhere: Option<(Vec<f64>, usize)>,
}

impl<'d> LostRank<'d> {
    pub(crate) fn of(derivation: &'d Derivation) -> Self {
        LostRank { derivation, elsewhere: None }
    }

    /// Warns of a state where rank is lost.
    pub(crate) fn warn(&mut self, point: &Point, place: &str) -> Result<(), Failure> {
        let derivation = self.derivation;
        let (coordinates, rows) = (derivation.dof(), derivation.constraints.len());
        if rows == 0 || coordinates.saturating_mul(rows).saturating_mul(rows) > MOST_OPERATIONS {
            return Ok(());
        }
        let equations = Equations::new(derivation, point)?;
        let mut dependent = Vec::new();
        let mut projector = equations.projector(RedundantRows::LeaveOut);
        let found = projector.rank(&equations, point.state.t, &point.state.q, |row| dependent.push(row));
        // What is not finite there is reported as such.
        let Ok(here) = found else { return Ok(()) };
        let elsewhere = if here < rows { self.elsewhere(point, here)? } else { here };
        if here < elsewhere {
            let names: Vec<String> =
                dependent.iter().map(|&row| format!("`{}`", derivation.constraints[row])).collect();
            let depend = if names.len() == 1 { "depends" } else { "depend" };
            let free = plural(coordinates - here, "degree of freedom", "degrees of freedom");
            output::warn(format_args!(
                "at {place} the rank of the constraints is {here}, at other states {elsewhere}, as {} {depend} on other \
                 rows there, which leaves {free} instead of {}; if the mechanism does not really gain a freedom there, a \
                 row is missing: `mbs explain MBS1006`",
                abridged(&names),
                coordinates - elsewhere
            ));
        }
        Ok(())
    }

    /// The rank at other states than this one, with its parameters. Time and signals are those of the first state with
    /// them, as the rank takes too long to be found for each state of a motion. Where none is found it is this one's.
    fn elsewhere(&mut self, point: &Point, here: usize) -> Result<usize, Failure> {
        if let Some((parameters, rank)) = &self.elsewhere
            && *parameters == point.parameters
        {
            return Ok(*rank);
        }
        let found = ranks(self.derivation, point)?.first().copied().unwrap_or(here);
        self.elsewhere = Some((point.parameters.clone(), found));
        Ok(found)
    }
}

/// The origin at rest, at t = 0, with default parameters.
fn origin(derivation: &Derivation) -> Point {
    let coordinates = derivation.dof();
    let defaults = derivation.parameters.iter().flat_map(|p| &p.defaults).copied().map(Number::to_f64);
    let state = State {
        q: vec![0.0; coordinates],
        qd: vec![0.0; coordinates],
        qdd: vec![0.0; coordinates],
        u: vec![0.0; derivation.inputs.iter().map(|input| input.count()).sum()],
        prescribed: vec![[0.0; 3]; derivation.prescribed.iter().map(|signal| signal.count()).sum()],
        t: 0.0,
    };
    Point { state, accelerations_are_given: false, parameters: defaults.collect() }
}

/// The rank of the constraints at the state nearest to a point that satisfies them.
fn rank_at(derivation: &Derivation, point: &Point) -> Result<usize, Failure> {
    let (equations, t) = (Equations::new(derivation, point)?, point.state.t);
    let mut projector = equations.projector(RedundantRows::LeaveOut);
    let mut motion = equations.start();
    motion.qd.fill(0.0);
    let found = projector.project(&equations, t, &mut motion).ok();
    let rank = found.and_then(|_| projector.rank(&equations, t, &motion.q, |_| ()).ok());
    rank.ok_or_else(|| Failure::new("no state near the one that is given was found to satisfy the constraints"))
}

/// The ranks of the constraints at the states that guesses of several sizes lead to, rising, with the parameters, time
/// and signals of a point.
fn ranks(derivation: &Derivation, point: &Point) -> Result<Vec<usize>, Failure> {
    let (equations, t) = (Equations::new(derivation, point)?, point.state.t);
    let mut projector = equations.projector(RedundantRows::LeaveOut);
    let is_plain = derivation.coordinates.iter().flat_map(|v| vec![matches!(v.unit.as_str(), "1" | "rad"); v.count()]);
    let is_plain: Vec<bool> = is_plain.collect();
    let guesses = (0..GUESSES * SIZES.len()).map(|guess| (SIZES[guess / GUESSES], guess));
    let ranks: BTreeSet<usize> = guesses
        .filter_map(|(size, guess)| {
            let mut motion = equations.start();
            motion.qd.fill(0.0);
            // Nothing special about them.
            for (i, q) in motion.q.iter_mut().enumerate() {
                *q = (1.0 + 2.3 * i as f64 + 1.7 * guess as f64).sin() * if is_plain[i] { 1.0 } else { size };
            }
            projector.project(&equations, t, &mut motion).ok()?;
            projector.rank(&equations, t, &motion.q, |_| ()).ok()
        })
        .collect();
    Ok(ranks.into_iter().collect())
}
