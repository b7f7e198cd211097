//! Statements that are the same for each link of a long chain, once, in loops over the links.
//!
//! Groups of statements of links that follow each other, outwards or inwards, are one loop where they are the same
//! trees: with own locals in the place of own locals, those of the neighbour, or of the same link in an earlier sweep,
//! in the place of those, arguments of the neighbour in the place of arguments, and numbers in the place of numbers,
//! which then come from a table, as parameters and what is known before the loop come from a list. Signs may alternate:
//! then the groups of two links are a turn of the loop. What other groups read is kept in arrays with a component for
//! each link. Run through, the loops are the statements that there were, and their values have the same bits.
//!
//! - `printer`: the loops, in all languages alike but for how a number of a table is read;
//! - `lines`: how a language writes them.

mod lines;
mod printer;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::ops::Range;

use crate::expr::Symbol;

use super::body::Body;
use super::expression::Tree;
use super::statement::Statement;
pub(super) use lines::{Loops, lines};
use printer::Printer;

/// Fewer groups than these stay as they are.
const FEW: usize = 8;

/// A turn of a loop is of at most this many links.
const LONGEST_TURN: usize = 4;

/// A loop has at least this many turns.
const FEWEST_TURNS: usize = 4;

/// Where at most this many groups have another number than all others, these stay as they are, and no table is needed.
const OTHERWISE: usize = 3;

/// In this many rounds at most, groups at the ends that differ from the rest are set apart.
const ROUNDS: usize = 40;

/// A body in loops.
struct Rolled {
    /// The texts of locals, those of the body first; of what is kept in arrays and tables and of arguments these are
    /// `q[i - 1]`.
    locals: Vec<String>,
    /// Names and lengths of arrays.
    arrays: Vec<(String, usize)>,
    /// Names and numbers of tables.
    tables: Vec<(String, Vec<f64>)>,
    steps: Vec<Step>,
    /// The results, each a component of an array.
    results: Vec<Tree>,
}

/// A step of a rolled body.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    /// `let local = tree;`
    Let(usize, Tree),
    /// `let list = [tree, tree];`
    List(String, Vec<Tree>),
    /// `array[i] = tree;`
    Keep(usize, Tree),
    /// What follows is of this link.
    Link(i64),
    /// What follows is of the links from one to another.
    Links([i64; 2]),
    /// `let (sines, cosines) = T::sin_cos_all(angles);` of this many angles.
    SinesAndCosines { names: [String; 2], angles: String, count: usize },
    /// A loop.
    Loop(Turns, Vec<Step>),
}

/// The turns of a loop, outwards from the first index to before the end, or inwards from the last one to the first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Turns {
    pub(super) index: String,
    pub(super) first: usize,
    pub(super) end: usize,
    pub(super) stride: usize,
    pub(super) is_inwards: bool,
}

impl Turns {
    /// The index of the turn that is furthest outwards.
    pub(super) fn last(&self) -> usize {
        self.first + (self.end - 1 - self.first) / self.stride * self.stride
    }
}

/// What groups of one statement each are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sink {
    Angles,
    Results,
}

/// Statements of one link; or one angle, or one result.
struct Group {
    /// That of the link, of the angle, or of the result.
    number: i64,
    sink: Option<Sink>,
    bindings: Vec<(usize, Tree)>,
    /// What they are, but for what differs between links.
    shape: Vec<Token>,
    /// What may differ: leaves that are no locals of the group.
    leaves: Vec<Tree>,
}

/// A part of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token {
    Operation(&'static str),
    /// The local that this statement of the group binds.
    Own(usize),
    /// One of another group.
    Other,
    /// An angle or a result that is just the local of a statement of a group.
    Statement(usize),
    Number,
    /// Component of an argument.
    Argument(&'static str),
    /// A parameter, or what depends on parameters alone.
    Given,
    /// What is the same for all links.
    Symbol(Symbol),
}

/// Where a local is bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Home {
    /// By a statement of a group.
    Binding(usize, usize),
    /// As the sine (0) or the cosine (1) of an angle.
    OfAngle(usize, i64),
}

/// Groups that are a loop, `period` of them a turn.
struct Run {
    groups: Range<usize>,
    step: i64,
    period: usize,
}

impl Run {
    /// The groups that are at this place in a turn.
    fn at(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        (self.groups.start + place..self.groups.end).step_by(self.period)
    }
}

/// Values that an array keeps, one for each link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Family {
    /// Those of a statement of the loop with this number.
    OfRun(usize, usize),
    OfAngles(usize),
}

/// How a leaf is written for each link of a loop.
#[derive(Clone, Debug, PartialEq)]
enum Form {
    /// As it is, the same for all.
    Same,
    /// The component of the link, shifted.
    Component(Family, i64),
    Argument(&'static str, i64),
    Table(Vec<u64>),
    List(Vec<Tree>),
}

/// The body in loops; `None` where nothing is gained, or where there are branches.
fn rolled(body: &Body<'_>, loops: &dyn Loops) -> Option<Rolled> {
    let parts = Parts::of(body)?;
    let mut excluded = vec![false; parts.groups.len()];
    for _ in 0..ROUNDS {
        let runs = parts.runs(&excluded);
        match parts.forms(&runs) {
            Ok((forms, seeds)) => {
                let rolled: usize = runs.iter().map(|run| run.groups.len()).sum();
                return (rolled > 2 * FEW).then(|| Printer::new(body, loops, &parts, &runs, &forms, &seeds).print());
            }
            Err(wrong) => wrong.into_iter().flatten().for_each(|group| excluded[group] = true),
        }
    }
    None
}

/// A body in groups.
struct Parts {
    groups: Vec<Group>,
    /// Before which group sines and cosines are computed.
    sines_at: Option<usize>,
    /// The locals of the sine and the cosine of each angle.
    angles: Vec<[Option<usize>; 2]>,
    homes: BTreeMap<usize, Home>,
}

/// Of each run and each place in its turns the forms of all leaves.
type Forms = Vec<Vec<Vec<Form>>>;

/// Values that come from elsewhere than the loop whose array they are kept in, by the local.
type Seeds = BTreeMap<(Family, i64), usize>;

impl Parts {
    fn of(body: &Body<'_>) -> Option<Parts> {
        let mut parts = Parts { groups: Vec::new(), sines_at: None, angles: Vec::new(), homes: BTreeMap::new() };
        let mut next = body.locals.len();
        let mut single = |number: usize, sink, tree: &Tree| {
            next += 1;
            let bindings = vec![(next - 1, tree.clone())];
            Group { number: number as i64, sink: Some(sink), bindings, shape: Vec::new(), leaves: Vec::new() }
        };
        for statement in &body.block.statements {
            match statement {
                Statement::Let(local, tree) => {
                    let is_last = parts.sines_at != Some(parts.groups.len());
                    let open = parts.groups.last_mut().filter(|group| is_last && group.sink.is_none());
                    let link = body.links[*local].map(|link| link as i64);
                    match open.filter(|group| link.is_none_or(|link| link == group.number)) {
                        Some(group) => group.bindings.push((*local, tree.clone())),
                        None => parts.groups.push(Group {
                            number: link.unwrap_or(0),
                            sink: None,
                            bindings: vec![(*local, tree.clone())],
                            shape: Vec::new(),
                            leaves: Vec::new(),
                        }),
                    }
                }
                Statement::SinCos(angles) if parts.sines_at.is_none() => {
                    let groups = angles.iter().enumerate().map(|(k, angle)| single(k, Sink::Angles, &angle.tree));
                    parts.groups.extend(groups);
                    parts.sines_at = Some(parts.groups.len());
                    parts.angles = angles.iter().map(|angle| [angle.sin, angle.cos]).collect();
                }
                Statement::SinCos(_) | Statement::Spline { .. } | Statement::Branch(..) | Statement::OnDemand(..) => {
                    return None;
                }
            }
        }
        let results = body.block.results.iter().enumerate().map(|(k, tree)| single(k, Sink::Results, tree));
        parts.groups.extend(results);
        for (k, locals) in parts.angles.iter().enumerate() {
            for (which, local) in locals.iter().enumerate() {
                parts.homes.extend(local.map(|local| (local, Home::OfAngle(which, k as i64))));
            }
        }
        for (number, group) in parts.groups.iter_mut().enumerate() {
            for (at, (local, _)) in group.bindings.iter().enumerate() {
                parts.homes.insert(*local, Home::Binding(number, at));
            }
            let own = |local: usize| match parts.homes.get(&local) {
                Some(Home::Binding(other, at)) if *other == number => Some(*at),
                _ => None,
            };
            match (group.sink, group.bindings.as_slice()) {
                (Some(_), [(_, tree @ Tree::Local(local))])
                    if let Some(Home::Binding(_, at)) = parts.homes.get(local) =>
                {
                    group.shape.push(Token::Statement(*at));
                    group.leaves.push(tree.clone());
                }
                (_, bindings) => {
                    bindings.iter().for_each(|(_, tree)| describe(tree, &own, &mut group.shape, &mut group.leaves));
                }
            }
        }
        Some(parts)
    }

    /// Groups whose shapes repeat and whose numbers follow each other, as far as none of them is excluded.
    fn runs(&self, excluded: &[bool]) -> Vec<Run> {
        let (mut runs, mut start) = (Vec::new(), 0);
        while start < self.groups.len() {
            let longest = (1..=LONGEST_TURN).map(|period| self.run(start, period, excluded));
            let longest = longest.flatten().max_by_key(|run| (run.groups.len(), LONGEST_TURN - run.period));
            // The first may not belong to those behind it.
            start = longest.as_ref().map_or(start + 1, |run| run.groups.end);
            runs.extend(longest);
        }
        runs
    }

    /// The run from a group on whose turns are of `period` groups, if it is long enough.
    fn run(&self, start: usize, period: usize, excluded: &[bool]) -> Option<Run> {
        let step = self.groups.get(start + 1)?.number - self.groups[start].number;
        let belongs = |end: &usize| {
            let (group, before) = (&self.groups[*end], &self.groups[*end - 1]);
            let follows = group.number - before.number == step && group.sink == before.sink;
            // A component of an array is bound at each place of a turn.
            let repeats = match end.checked_sub(period).filter(|before| *before >= start) {
                Some(before) => {
                    group.shape == self.groups[before].shape && self.are_apart(before, *end, step * period as i64)
                }
                None => group.bindings.len() == self.groups[start].bindings.len(),
            };
            follows && repeats && !excluded[*end] && self.sines_at != Some(*end)
        };
        let count = 1 + (start + 1..self.groups.len()).take_while(belongs).count();
        let count = count - count % period;
        let is_one = step.abs() == 1 && !excluded[start] && count >= FEW.max(FEWEST_TURNS * period);
        is_one.then_some(Run { groups: start..start + count, step, period })
    }

    /// Whether two angles or results, where they are just locals of statements, are those of links this far apart.
    fn are_apart(&self, before: usize, group: usize, distance: i64) -> bool {
        let link = |group: usize| match self.groups[group].leaves.as_slice() {
            [Tree::Local(local)] if self.groups[group].sink.is_some() => match self.homes.get(local) {
                Some(Home::Binding(home, _)) => Some(self.groups[*home].number),
                _ => None,
            },
            _ => None,
        };
        link(before).zip(link(group)).is_none_or(|(before, group)| group - before == distance)
    }

    /// How the leaves of the runs are written; or groups that differ from the others of their run.
    fn forms(&self, runs: &[Run]) -> Result<(Forms, Seeds), Vec<Range<usize>>> {
        let mut seeds = Seeds::new();
        let mut run_of = vec![None; self.groups.len()];
        for (number, run) in runs.iter().enumerate() {
            run.groups.clone().for_each(|group| run_of[group] = Some(number));
        }
        let (mut forms, mut wrong) = (Vec::new(), Vec::new());
        for run in runs {
            let mut of_place = |place: usize| {
                let leaves = 0..self.groups[run.groups.start + place].leaves.len();
                leaves.map(|leaf| self.form(runs, &run_of, run, (place, leaf), &mut seeds)).collect()
            };
            let found: Result<Vec<Vec<Form>>, usize> = (0..run.period).map(&mut of_place).collect();
            match found {
                Ok(found) => forms.push(found),
                Err(at) if at - run.groups.start < run.groups.len() / 2 => wrong.push(run.groups.start..at + 1),
                Err(at) => wrong.push(at..run.groups.end),
            }
        }
        if wrong.is_empty() { Ok((forms, seeds)) } else { Err(wrong) }
    }

    /// How a leaf of a run is written; or the first group where it is something else.
    fn form(
        &self,
        runs: &[Run],
        run_of: &[Option<usize>],
        run: &Run,
        (place, leaf): (usize, usize),
        seeds: &mut Seeds,
    ) -> Result<Form, usize> {
        let groups = || run.at(place).map(|group| (group, self.groups[group].number));
        let leaf_of = |group: usize| &self.groups[group].leaves[leaf];
        let middle = run.groups.start + place + run.groups.len() / run.period / 2 * run.period;
        if groups().all(|(group, _)| leaf_of(group) == leaf_of(middle)) {
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
            Tree::Local(local) if self.is_alone(*local, run_of) && self.are_known_before(run, (place, leaf)) => {
                Ok(self.listed(run, (place, leaf)))
            }
            Tree::Symbol(symbol) => {
                let (argument, index) = argument(*symbol).ok_or(middle)?;
                let (shift, component) =
                    (index - self.groups[middle].number, |symbol: &Symbol| self::argument(*symbol));
                let differs = |&(group, number): &(usize, i64)| match leaf_of(group) {
                    Tree::Symbol(symbol) => component(symbol) != Some((argument, number + shift)),
                    _ => true,
                };
                groups().find(differs).map_or(Ok(Form::Argument(argument, shift)), |(group, _)| Err(group))
            }
            Tree::Local(local) => {
                let (family, slot) = match self.homes[local] {
                    Home::OfAngle(which, angle) => (Family::OfAngles(which), angle),
                    Home::Binding(home, at) => {
                        (Family::OfRun(run_of[home].ok_or(middle)?, at), self.groups[home].number)
                    }
                };
                let shift = slot - self.groups[middle].number;
                for (group, number) in groups() {
                    let Tree::Local(local) = leaf_of(group) else { return Err(group) };
                    let slot = number + shift;
                    match self.member(runs, family, slot) {
                        Some(member) if member == *local => {}
                        Some(_) => return Err(group),
                        None => {
                            let is_before = self.is_bound_before(*local, run.groups.start);
                            let is_array = matches!(family, Family::OfRun(..)) && slot >= -1;
                            if !is_before || !is_array || *seeds.entry((family, slot)).or_insert(*local) != *local {
                                return Err(group);
                            }
                        }
                    }
                }
                Ok(Form::Component(family, shift))
            }
            _ => Err(middle),
        }
    }

    /// Whether a local is bound by a group that is in no loop.
    fn is_alone(&self, local: usize, run_of: &[Option<usize>]) -> bool {
        matches!(self.homes[&local], Home::Binding(home, _) if run_of[home].is_none())
    }

    /// Whether a leaf of all groups at a place in the turns of a run is a local that has its value before the run.
    fn are_known_before(&self, run: &Run, (place, leaf): (usize, usize)) -> bool {
        run.at(place).all(|group| match self.groups[group].leaves[leaf] {
            Tree::Local(local) => self.is_bound_before(local, run.groups.start),
            _ => false,
        })
    }

    /// A leaf of the groups at a place in the turns of a run, by their links: a table of numbers, or a list.
    fn listed(&self, run: &Run, (place, leaf): (usize, usize)) -> Form {
        let group = |group: usize| (self.groups[group].number, &self.groups[group].leaves[leaf]);
        let leaves: BTreeMap<i64, &Tree> = run.at(place).map(group).collect();
        let bits = |leaf: &&Tree| if let Tree::Constant(value) = leaf { Some(value.to_bits()) } else { None };
        let numbers: Option<Vec<u64>> = leaves.values().map(bits).collect();
        numbers.map_or_else(|| Form::List(leaves.into_values().cloned().collect()), Form::Table)
    }

    /// Whether a local has its value before a group.
    fn is_bound_before(&self, local: usize, group: usize) -> bool {
        match self.homes[&local] {
            Home::Binding(home, _) => home < group,
            Home::OfAngle(..) => self.sines_at.is_some_and(|sines_at| sines_at <= group),
        }
    }

    /// The local that a family has for a number by itself.
    fn member(&self, runs: &[Run], family: Family, number: i64) -> Option<usize> {
        match family {
            Family::OfAngles(which) => self.angles.get(usize::try_from(number).ok()?)?[which],
            Family::OfRun(run, at) => {
                let Run { groups, step, .. } = &runs[run];
                let offset = (number - self.groups[groups.start].number) * step;
                let group = groups.start + usize::try_from(offset).ok()?;
                groups.contains(&group).then(|| self.groups[group].bindings[at].0)
            }
        }
    }
}

/// Adds what a tree is to a shape, and what may differ to the leaves.
fn describe(tree: &Tree, own: &dyn Fn(usize) -> Option<usize>, shape: &mut Vec<Token>, leaves: &mut Vec<Tree>) {
    let token = match tree {
        Tree::Constant(_) => Token::Number,
        Tree::Hoisted(_) | Tree::Symbol(Symbol::Parameter(_)) => Token::Given,
        Tree::Symbol(symbol) => argument(*symbol).map_or(Token::Symbol(*symbol), |(name, _)| Token::Argument(name)),
        Tree::Local(local) => own(*local).map_or(Token::Other, Token::Own),
        Tree::Neg(_) => Token::Operation("-a"),
        Tree::Add(..) => Token::Operation("+"),
        Tree::Sub(..) => Token::Operation("-"),
        Tree::Mul(..) => Token::Operation("*"),
        Tree::Div(..) => Token::Operation("/"),
        Tree::Method(name, ..) => Token::Operation(name),
        Tree::Less(..) => Token::Operation("<"),
        Tree::LessEqual(..) => Token::Operation("<="),
        Tree::And(..) => Token::Operation("&"),
        Tree::Not(_) => Token::Operation("!"),
        Tree::Select(..) => Token::Operation("if"),
    };
    shape.push(token);
    if matches!(token, Token::Other | Token::Number | Token::Argument(_) | Token::Given) {
        leaves.push(tree.clone());
    }
    tree.children().into_iter().for_each(|child| describe(child, own, shape, leaves));
}

/// The argument that a symbol is a component of, and its number there.
fn argument(symbol: Symbol) -> Option<(&'static str, i64)> {
    match symbol {
        Symbol::Coordinate(i) => Some(("q", i64::from(i))),
        Symbol::Velocity(i) => Some(("qd", i64::from(i))),
        Symbol::Acceleration(i) => Some(("qdd", i64::from(i))),
        Symbol::Input(i) => Some(("u", i64::from(i))),
        Symbol::Multiplier(i) => Some(("multipliers", i64::from(i))),
        Symbol::Time | Symbol::Parameter(_) | Symbol::Prescribed(..) => None,
    }
}
