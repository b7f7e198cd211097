//! What constraints leave of the state that a member is to start with.
//!
//! What a plan names is held, what it does not name follows. Where that asks for more than the constraints leave free,
//! what the key `hold` names comes first, then what varies, for the table tells it of each member, and then, without
//! that key, what is fixed, in the order of the plan. A member that cannot have what the table says of it stops; of
//! fixed values that others had to be taken for, there is a warning.

use std::sync::{Mutex, PoisonError};

use mbs_derive::optimise::Derivation;
use mbs_derive::variable::component_names;
use mbs_runtime::{Constraints, RedundantRows};

use super::names::Slot;
use crate::equations::{Equations, Motion as Moving};
use crate::simulate::assembly::{Held, assemble, moved};
use crate::words::{abridged, plural, without_noise};

/// Which rules decide where members start: another number where a change of them moves the members of a plan.
pub(super) const RULES: &str = "on constraints, 2";

/// A position or a velocity: the number of the coordinate, and whether it is the velocity.
type Place = (usize, bool);

/// How members start.
#[derive(Debug)]
pub(super) struct Start {
    /// The names of the coordinates.
    names: Vec<String>,
    /// What the table has of each member.
    varied: Vec<Place>,
    /// What is the same for all.
    fixed: Vec<Place>,
    /// What the key `hold` says.
    held: Option<Held>,
    /// How many members started with other fixed values, the first of them, and with which.
    others: Mutex<(usize, Option<(u64, String)>)>,
}

impl Start {
    /// Of a plan that varies and fixes this.
    pub(super) fn new(derivation: &Derivation, varied: &[Slot], fixed: &[Slot], held: Option<Held>) -> Self {
        let place = |slot: &Slot| match slot {
            Slot::Coordinate(i) => Some((*i, false)),
            Slot::Rate(i) => Some((*i, true)),
            Slot::Parameter(_) | Slot::Input(_) => None,
        };
        let places = |slots: &[Slot]| slots.iter().filter_map(place).collect();
        let names = component_names(&derivation.coordinates);
        Start { names, varied: places(varied), fixed: places(fixed), held, others: Mutex::default() }
    }

    /// The equations of a member, from a state on the constraints; why there is none that the table would be right
    /// about.
    pub(super) fn on_constraints<'d>(
        &self,
        equations: Equations<'d>,
        member: u64,
        redundant_rows: RedundantRows,
    ) -> Result<Equations<'d>, String> {
        if equations.rows() == 0 {
            return Ok(equations);
        }
        let given = equations.start();
        let mut found = self.assembled(&equations, &given, redundant_rows);
        if let (true, Some(guess)) = (self.may_be_for_the_guess(&given, &found), self.other_guess(&given)) {
            let other = self.assembled(&equations, &guess, redundant_rows);
            if other.as_ref().is_ok_and(|motion| self.wrong(&given, motion).iter().all(Vec::is_empty)) {
                found = other;
            }
        }
        let motion = found?;
        let [varied, fixed] = self.wrong(&given, &motion);
        if !varied.is_empty() {
            let unnamed: Vec<String> = self.unnamed().map(|i| format!("`{}`", self.names[i])).collect();
            let other = match unnamed[..] {
                [] => String::new(),
                _ => format!(
                    "; or it was not found from the guess, `[fixed]` may give another of {}",
                    abridged(&unnamed)
                ),
            };
            return Err(format!(
                "the constraints do not let it start as the table says: {}; vary what they leave free, the rest \
                 follows{other}",
                abridged(&varied)
            ));
        }
        if !fixed.is_empty() {
            let mut others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
            others.0 += 1;
            if others.1.as_ref().is_none_or(|(first, _)| member < *first) {
                others.1 = Some((member, abridged(&fixed)));
            }
        }
        Ok(equations.starting_from(motion))
    }

    /// Of a state that was found: what varies and is not as given, and what is fixed; where the plan says what is held,
    /// the latter is a guess.
    fn wrong(&self, given: &Moving, found: &Moving) -> [Vec<String>; 2] {
        let fixed = if self.held.is_none() { self.fixed.as_slice() } else { &[] };
        [self.changes(&self.varied, "would start", given, found), self.changes(fixed, "starts", given, found)]
    }

    /// Whether another guess may lead to what is named: Newton's method does not leave a place where what is not held
    /// changes no constraint, as that of a circle is at its centre. An error says more where nothing is held.
    fn may_be_for_the_guess(&self, given: &Moving, found: &Result<Moving, String>) -> bool {
        match found {
            Ok(motion) => self.wrong(given, motion).iter().any(|changes| !changes.is_empty()),
            Err(_) => self.held.is_some(),
        }
    }

    /// The coordinates that the plan does not name and does not hold.
    fn unnamed(&self) -> impl Iterator<Item = usize> {
        let is_held = |i: usize| self.held.as_ref().is_some_and(|held| held.positions[i]);
        let is_named = |i: usize| self.varied.iter().chain(&self.fixed).any(|place| *place == (i, false));
        (0..self.names.len()).filter(move |&i| !is_held(i) && !is_named(i))
    }

    /// The guess with a part of the largest coordinate for those that are not named, nothing special about them.
    fn other_guess(&self, given: &Moving) -> Option<Moving> {
        let largest = given.q.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
        let size = if largest > 0.0 { largest } else { 1.0 };
        let mut guess = given.clone();
        let mut is_other = false;
        for i in self.unnamed() {
            guess.q[i] = size * (0.3 + 0.1 * (1.0 + 2.3 * i as f64).sin());
            is_other = true;
        }
        is_other.then_some(guess)
    }

    /// The state on the constraints that is nearest to a guess, but for what is held.
    fn assembled(
        &self,
        equations: &Equations<'_>,
        guess: &Moving,
        redundant_rows: RedundantRows,
    ) -> Result<Moving, String> {
        let held = self.possible(equations, guess, redundant_rows);
        let mut motion = guess.clone();
        assemble(equations, &mut motion, &held, redundant_rows)?;
        // As far as the motion itself goes then: what is held may leave a little of the rows.
        assemble(equations, &mut motion, &Held::nothing(self.names.len()), redundant_rows)?;
        Ok(motion)
    }

    /// What the key `hold` says, and as much of what is named besides as can be held: all, or one after the other,
    /// positions first. Where the key is given, what is fixed is a guess.
    fn possible(&self, equations: &Equations<'_>, given: &Moving, redundant_rows: RedundantRows) -> Held {
        let nothing = || Held { by: "hold", ..Held::nothing(self.names.len()) };
        let mut held = self.held.clone().unwrap_or_else(nothing);
        let is_possible = |held: &Held| held.is_possible(equations, given, redundant_rows);
        let hold = |held: &mut Held, places: &mut dyn Iterator<Item = &Place>| {
            places.for_each(|&(i, is_velocity)| {
                let list = if is_velocity { &mut held.velocities } else { &mut held.positions };
                list[i] = true;
            });
        };
        let fixed = if self.held.is_none() { self.fixed.as_slice() } else { &[] };
        let named: Vec<Place> = self.varied.iter().chain(fixed).copied().collect();
        let mut all = held.clone();
        hold(&mut all, &mut named.iter());
        if is_possible(&all) {
            return all;
        }
        for is_velocity in [false, true] {
            let places: Vec<&Place> = named.iter().filter(|place| place.1 == is_velocity).collect();
            let mut together = held.clone();
            hold(&mut together, &mut places.iter().copied());
            if is_possible(&together) {
                held = together;
                continue;
            }
            for place in places {
                let mut more = held.clone();
                hold(&mut more, &mut std::iter::once(place));
                if is_possible(&more) {
                    held = more;
                }
            }
        }
        held
    }

    /// What is not as given, by more than rounding.
    fn changes(&self, places: &[Place], starts: &str, given: &Moving, motion: &Moving) -> Vec<String> {
        let change = |&(i, is_velocity): &Place| {
            let (from, to) = if is_velocity { (given.qd[i], motion.qd[i]) } else { (given.q[i], motion.q[i]) };
            let suffix = if is_velocity { "_dot" } else { "" };
            let to = without_noise(&[from, to])[1];
            moved(from, to).then(|| format!("`{}{suffix}` {starts} at {to:?} instead of {from:?}", self.names[i]))
        };
        places.iter().filter_map(change).collect()
    }

    /// What there is to say of members that started with other values than those of `[fixed]`.
    pub(super) fn moved(&self) -> Option<String> {
        let others = self.others.lock().unwrap_or_else(PoisonError::into_inner);
        let (first, changes) = others.1.as_ref()?;
        let members = plural(others.0, "member", "members");
        Some(format!(
            "the constraints do not let {members} start as `[fixed]` says; the first is {first}: {changes}; \
             `hold = […]` in `[motion]` names what is meant, the rest is then a guess"
        ))
    }
}
