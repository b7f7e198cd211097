//! Groups that repeat: what is one loop.

use std::ops::Range;

use super::super::expression::Tree;
use super::group::{Groups, Home, argument};

/// Fewer groups than these stay as they are.
pub(super) const FEW: usize = 8;

/// A turn of a loop is of at most this many groups.
const LONGEST_TURN: usize = 6;

/// A loop has at least this many turns.
const FEWEST_TURNS: usize = 4;

/// Groups that are a loop, `period` of them a turn.
pub(super) struct Run {
    pub(super) groups: Range<usize>,
    pub(super) period: usize,
    /// How many links further out a turn is than the one before it.
    pub(super) distance: i64,
    /// The index of the innermost turn: the number of its link where each link is a turn.
    pub(super) first: i64,
}

impl Run {
    pub(super) fn turns(&self) -> i64 {
        (self.groups.len() / self.period) as i64
    }

    /// The groups that are at this place in a turn.
    pub(super) fn at(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        (self.groups.start + place..self.groups.end).step_by(self.period)
    }

    pub(super) fn place_of(&self, group: usize) -> usize {
        (group - self.groups.start) % self.period
    }

    /// The index of the turn that a group belongs to.
    pub(super) fn turn_of(&self, group: usize) -> i64 {
        let turn = ((group - self.groups.start) / self.period) as i64;
        if self.distance < 0 { self.first + self.turns() - 1 - turn } else { self.first + turn }
    }

    /// The group at this place in the turn with this index.
    pub(super) fn group(&self, place: usize, index: i64) -> Option<usize> {
        let turn = index - self.first;
        let turn = if self.distance < 0 { self.turns() - 1 - turn } else { turn };
        let is_one = (0..self.turns()).contains(&turn);
        is_one.then(|| self.groups.start + place + turn as usize * self.period)
    }

    /// A group in the middle of those at a place, and those of the turns before and behind it.
    pub(super) fn middle(&self, place: usize) -> [usize; 3] {
        let middle = self.groups.start + place + self.turns() as usize / 2 * self.period;
        [middle - self.period, middle, middle + self.period]
    }
}

/// Groups that are alike turn by turn, and whose numbers follow each other; none of them is excluded.
pub(super) fn runs(groups: &Groups, excluded: &[bool]) -> Vec<Run> {
    let (mut runs, mut start) = (Vec::new(), 0);
    while start < groups.all.len() {
        let from_here = (1..=LONGEST_TURN).filter_map(|period| run(groups, start, period, excluded));
        let worth = |run: &Run| (run.is_steady(groups), run.groups.len(), LONGEST_TURN - run.period);
        let best = from_here.max_by_key(worth);
        // The first may not belong to those behind it.
        start = best.as_ref().map_or(start + 1, |run| run.groups.end);
        runs.extend(best);
    }
    runs
}

/// The run from a group on whose turns are of `period` groups, if it is long enough.
fn run(groups: &Groups, start: usize, period: usize, excluded: &[bool]) -> Option<Run> {
    let [first, next] = [groups.all.get(start)?, groups.all.get(start + period)?];
    let distance = next.number - first.number;
    if distance == 0 {
        return None;
    }
    // How many links lie between what two angles or results are.
    let between = |before: usize, group: usize| {
        let number = |group: usize| groups.statement_of(group).map(|(home, _)| groups.all[home].number);
        Some(number(group)? - number(before)?)
    };
    let goes_on = |before: usize, group: usize| {
        let first = start + (before - start) % period;
        between(before, group).is_none_or(|links| between(first, first + period) == Some(links))
    };
    let belongs = |&end: &usize| {
        let group = &groups.all[end];
        let repeats = match end.checked_sub(period).filter(|before| *before >= start) {
            Some(before) => {
                let of_before = &groups.all[before];
                let is_alike = group.kind == of_before.kind && group.sink == of_before.sink;
                let is_further = group.number - of_before.number == distance;
                is_alike && is_further && goes_on(before, end)
            }
            None => group.sink == first.sink,
        };
        repeats && !excluded[end] && (end == start || groups.sines_at != Some(end))
    };
    let count = (start..groups.all.len()).take_while(belongs).count();
    let count = count - count % period;
    if count < FEW.max(FEWEST_TURNS * period) {
        return None;
    }
    let innermost = if distance < 0 { start + count - period } else { start };
    let first = groups.all[innermost].number.div_euclid(distance.abs());
    Some(Run { groups: start..start + count, period, distance, first })
}

impl Run {
    /// Whether what the groups read goes on from turn to turn, in the middle of the run.
    fn is_steady(&self, groups: &Groups) -> bool {
        let is_steady = |leaves: [&Tree; 3]| {
            let [Some(before), Some(here), Some(behind)] = leaves.map(|leaf| Component::of(groups, leaf)) else {
                return true;
            };
            let is_one = before.of == here.of && here.of == behind.of;
            before.group.is_some_and(|group| [here.group, behind.group] == [Some(group); 2])
                || is_one && here.number - before.number == behind.number - here.number
        };
        (0..self.period).all(|place| {
            let middle = self.middle(place).map(|group| &groups.all[group].leaves);
            (0..middle[1].len()).all(|leaf| is_steady(middle.map(|leaves| &leaves[leaf])))
        })
    }
}

/// What of the values that go on with the links a leaf is.
struct Component {
    of: Series,
    number: i64,
    /// Where it is bound.
    group: Option<usize>,
}

/// Values that go on with the links.
#[derive(PartialEq, Eq)]
enum Series {
    Argument(&'static str),
    /// Sines or cosines.
    OfAngles(usize),
    /// A statement of the groups of a kind.
    OfKind(usize, usize),
}

impl Component {
    fn of(groups: &Groups, leaf: &Tree) -> Option<Self> {
        let (of, number, group) = match leaf {
            Tree::Symbol(symbol) => {
                let (name, number) = argument(*symbol)?;
                (Series::Argument(name), number, None)
            }
            Tree::Local(local) => match groups.homes[local] {
                Home::OfAngle(which, angle) => (Series::OfAngles(which), angle, None),
                Home::Binding(home, at) => {
                    let group = &groups.all[home];
                    (Series::OfKind(group.kind, at), group.number, Some(home))
                }
            },
            _ => return None,
        };
        Some(Component { of, number, group })
    }
}
