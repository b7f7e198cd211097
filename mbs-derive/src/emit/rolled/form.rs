//! How what differs between the turns of a loop is written.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::expr::Symbol;

use super::super::expression::Tree;
use super::group::{Groups, Home, argument};
use super::run::Run;

/// Where at most this many groups have another number than all others, these stay as they are, and no table is needed.
const OTHERWISE: usize = 3;

/// Values that an array keeps, one for each turn of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Family {
    /// Those of a statement, the last number, of the groups at a place in the turns of the loop with the first number.
    OfRun(usize, usize, usize),
    OfAngles(usize),
}

/// Which component it is in each turn: `slope * i + start`, i being the index of the turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Along {
    pub(super) slope: i64,
    pub(super) start: i64,
}

impl Along {
    /// The same component in each turn.
    pub(super) fn only(component: i64) -> Along {
        Along { slope: 0, start: component }
    }

    /// Through two turns, the second of which follows the first; not where it stays or goes back.
    fn through([turn, next]: [(i64, i64); 2]) -> Option<Along> {
        let slope = (next.1 - turn.1) / (next.0 - turn.0);
        (slope > 0).then(|| Along { slope, start: turn.1 - slope * turn.0 })
    }

    fn at(self, index: i64) -> i64 {
        self.slope * index + self.start
    }
}

/// How a leaf is written for each turn of a loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Form {
    /// As it is, the same for all.
    Same,
    Component(Family, Along),
    Argument(&'static str, Along),
    Table(Vec<u64>),
    List(Vec<Tree>),
}

/// Of each run and each place in its turns the forms of all leaves.
pub(super) type Forms = Vec<Vec<Vec<Form>>>;

/// Values that come from elsewhere than the loop whose array they are kept in, by the local.
pub(super) type Seeds = BTreeMap<(Family, i64), usize>;

/// How the leaves of the runs are written; or groups that differ from the others of their run.
pub(super) fn forms(groups: &Groups, runs: &[Run]) -> Result<(Forms, Seeds), Vec<Range<usize>>> {
    let mut finder = Finder { groups, runs, run_of: run_of(groups, runs), seeds: Seeds::new() };
    let (mut forms, mut wrong) = (Vec::new(), Vec::new());
    for run in runs {
        let mut of_place = |place: usize| {
            let leaves = 0..groups.all[run.groups.start + place].leaves.len();
            leaves.map(|leaf| finder.form(run, (place, leaf))).collect()
        };
        let found: Result<Vec<Vec<Form>>, usize> = (0..run.period).map(&mut of_place).collect();
        match found {
            Ok(found) => forms.push(found),
            Err(at) if at - run.groups.start < run.groups.len() / 2 => wrong.push(run.groups.start..at + 1),
            Err(at) => wrong.push(at..run.groups.end),
        }
    }
    if wrong.is_empty() { Ok((forms, finder.seeds)) } else { Err(wrong) }
}

/// The run that each group belongs to, if any.
pub(super) fn run_of(groups: &Groups, runs: &[Run]) -> Vec<Option<usize>> {
    let mut run_of = vec![None; groups.all.len()];
    for (number, run) in runs.iter().enumerate() {
        run.groups.clone().for_each(|group| run_of[group] = Some(number));
    }
    run_of
}

/// Where a local is kept, and which component it is; `None` for those of no loop.
pub(super) fn component_of(
    groups: &Groups,
    runs: &[Run],
    run_of: &[Option<usize>],
    local: usize,
) -> Option<(Family, i64)> {
    match groups.homes[&local] {
        Home::OfAngle(which, angle) => Some((Family::OfAngles(which), angle)),
        Home::Binding(home, at) => {
            let number = run_of[home]?;
            let run = &runs[number];
            Some((Family::OfRun(number, run.place_of(home), at), run.turn_of(home)))
        }
    }
}

struct Finder<'f> {
    groups: &'f Groups,
    runs: &'f [Run],
    run_of: Vec<Option<usize>>,
    seeds: Seeds,
}

impl Finder<'_> {
    /// How a leaf of a run is written; or the first group where it is something else.
    fn form(&mut self, run: &Run, (place, leaf): (usize, usize)) -> Result<Form, usize> {
        let groups = self.groups;
        let leaf_of = |group: usize| &groups.all[group].leaves[leaf];
        let [_, middle, next] = run.middle(place);
        if run.at(place).all(|group| leaf_of(group) == leaf_of(middle)) {
            return Ok(Form::Same);
        }
        match leaf_of(middle) {
            Tree::Constant(_) | Tree::Hoisted(_) | Tree::Symbol(Symbol::Parameter(_)) => {
                let others: Vec<usize> = run.at(place).filter(|&group| leaf_of(group) != leaf_of(middle)).collect();
                if others.len() <= OTHERWISE {
                    let last_before = others.iter().rev().find(|&&group| group < middle);
                    return Err(*last_before.or(others.first()).unwrap_or(&middle));
                }
                Ok(self.listed(run, (place, leaf)))
            }
            Tree::Local(local) if self.is_alone(*local) && self.are_known_before(run, (place, leaf)) => {
                Ok(self.listed(run, (place, leaf)))
            }
            Tree::Symbol(symbol) => {
                let (name, here) = argument(*symbol).ok_or(middle)?;
                let component = |group: usize| match leaf_of(group) {
                    Tree::Symbol(symbol) => argument(*symbol).filter(|(other, _)| *other == name).map(|(_, k)| k),
                    _ => None,
                };
                let further = component(next).ok_or(next)?;
                let along = Along::through([(run.turn_of(middle), here), (run.turn_of(next), further)]).ok_or(next)?;
                let differs = |&group: &usize| component(group) != Some(along.at(run.turn_of(group)));
                run.at(place).find(differs).map_or(Ok(Form::Argument(name, along)), Err)
            }
            Tree::Local(local) => {
                let component = |local| component_of(self.groups, self.runs, &self.run_of, local);
                let (family, here) = component(*local).ok_or(middle)?;
                let further = match leaf_of(next) {
                    Tree::Local(local) => component(*local).filter(|(other, _)| *other == family),
                    _ => None,
                };
                let (_, further) = further.ok_or(next)?;
                let along = Along::through([(run.turn_of(middle), here), (run.turn_of(next), further)]).ok_or(next)?;
                for group in run.at(place) {
                    let Tree::Local(local) = leaf_of(group) else { return Err(group) };
                    let number = along.at(run.turn_of(group));
                    match self.member(family, number) {
                        Some(member) if member == *local => {}
                        Some(_) => return Err(group),
                        None => {
                            let is_before = self.groups.is_bound_before(*local, run.groups.start);
                            let is_array = matches!(family, Family::OfRun(..)) && number >= -1;
                            if !is_before
                                || !is_array
                                || *self.seeds.entry((family, number)).or_insert(*local) != *local
                            {
                                return Err(group);
                            }
                        }
                    }
                }
                Ok(Form::Component(family, along))
            }
            _ => Err(middle),
        }
    }

    /// Whether a local is bound by a group that is in no loop.
    fn is_alone(&self, local: usize) -> bool {
        matches!(self.groups.homes[&local], Home::Binding(home, _) if self.run_of[home].is_none())
    }

    /// Whether a leaf of all groups at a place in the turns of a run is a local that has its value before the run.
    fn are_known_before(&self, run: &Run, (place, leaf): (usize, usize)) -> bool {
        run.at(place).all(|group| match self.groups.all[group].leaves[leaf] {
            Tree::Local(local) => self.groups.is_bound_before(local, run.groups.start),
            _ => false,
        })
    }

    /// A leaf of the groups at a place in the turns of a run, outwards: a table of numbers, or a list.
    fn listed(&self, run: &Run, (place, leaf): (usize, usize)) -> Form {
        let mut leaves: Vec<&Tree> = run.at(place).map(|group| &self.groups.all[group].leaves[leaf]).collect();
        if run.distance < 0 {
            leaves.reverse();
        }
        let bits = |leaf: &&Tree| if let Tree::Constant(value) = leaf { Some(value.to_bits()) } else { None };
        let numbers: Option<Vec<u64>> = leaves.iter().map(bits).collect();
        numbers.map_or_else(|| Form::List(leaves.into_iter().cloned().collect()), Form::Table)
    }

    /// The local that a family has for a number by itself.
    fn member(&self, family: Family, number: i64) -> Option<usize> {
        match family {
            Family::OfAngles(which) => self.groups.angles.get(usize::try_from(number).ok()?)?[which],
            Family::OfRun(run, place, at) => {
                let group = self.runs[run].group(place, number)?;
                Some(self.groups.all[group].bindings[at].0)
            }
        }
    }
}
