//! The statements of loops, and of what stays beside them.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::Symbol;

use super::super::body::Body;
use super::super::expression::Tree;
use super::super::name::Scope;
use super::form::{Along, Family, Form, Forms, Seeds, component_of, run_of};
use super::group::{Group, Groups, Sink, argument};
use super::run::Run;
use super::{Loops, Rolled, Step, Turns};

/// An array with what it is called and the number of its first component.
struct Array {
    name: String,
    first: i64,
    count: usize,
}

/// Writes the steps.
pub(super) struct Printer<'p> {
    loops: &'p dyn Loops,
    groups: &'p Groups,
    runs: &'p [Run],
    forms: &'p Forms,
    seeds: BTreeMap<usize, Vec<(Family, i64)>>,
    run_of: Vec<Option<usize>>,
    arrays: BTreeMap<Family, Array>,
    angles: String,
    results: String,
    index: String,
    /// What lists are called.
    list: &'static str,
    scope: Scope,
    locals: Vec<String>,
    texts: BTreeMap<String, usize>,
    tables: Vec<(String, Vec<u64>)>,
    lists: Vec<(String, Vec<Tree>)>,
}

impl<'p> Printer<'p> {
    pub(super) fn new(
        body: &Body<'_>,
        loops: &'p dyn Loops,
        groups: &'p Groups,
        runs: &'p [Run],
        forms: &'p Forms,
        seeds: &Seeds,
    ) -> Self {
        let mut scope = body.scope.clone();
        let run_of = run_of(groups, runs);
        // The first of these that the language has no other use for.
        let free = |names: [&'static str; 2]| names[usize::from(loops.identifier(names[0]) != names[0])];
        let list = free(["values", "listed"]);
        let [index, angles, results] = [free(["i", "k"]), "angles", "results"].map(|name| scope.unique(name));
        let mut read: BTreeSet<Family> = [0, 1].map(Family::OfAngles).into();
        for leaf in groups.all.iter().flat_map(|group| &group.leaves) {
            if let Tree::Local(local) = leaf {
                read.extend(component_of(groups, runs, &run_of, *local).map(|(family, _)| family));
            }
        }
        let mut array = |family: Family| {
            let seeded = seeds.range((family, i64::MIN)..=(family, i64::MAX)).map(|((_, slot), _)| *slot);
            let (name, own) = match family {
                Family::OfAngles(which) => {
                    (["sines", "cosines"][which].to_string(), [0, groups.angles.len() as i64 - 1])
                }
                Family::OfRun(run, place, at) => {
                    let run = &runs[run];
                    let name = of_any_link(&body.locals[groups.all[run.groups.start + place].bindings[at].0]);
                    (name, [run.first, run.first + run.turns() - 1])
                }
            };
            let (least, most) = seeded.fold((own[0], own[1]), |(a, b), slot| (a.min(slot), b.max(slot)));
            let count = usize::try_from(most - least + 1).unwrap_or(0);
            (family, Array { name: scope.unique(&name), first: least, count })
        };
        let arrays = read.into_iter().map(&mut array).collect();
        let mut by_local: BTreeMap<usize, Vec<(Family, i64)>> = BTreeMap::new();
        seeds.iter().for_each(|(&place, &local)| by_local.entry(local).or_default().push(place));
        let singles = groups.all.iter().filter(|group| group.sink.is_some()).count();
        let mut locals = body.locals.clone();
        locals.extend(vec![String::new(); singles]);
        let (texts, tables, lists) = (BTreeMap::new(), Vec::new(), Vec::new());
        Printer {
            loops,
            groups,
            runs,
            forms,
            seeds: by_local,
            run_of,
            arrays,
            angles,
            results,
            index,
            list,
            scope,
            locals,
            texts,
            tables,
            lists,
        }
    }

    pub(super) fn print(mut self) -> Rolled {
        let (mut steps, mut group) = (Vec::new(), 0);
        loop {
            if self.groups.sines_at == Some(group) {
                let names = [0, 1].map(|which| self.arrays[&Family::OfAngles(which)].name.clone());
                let (angles, count) = (self.angles.clone(), self.groups.angles.len());
                steps.push(Step::SinesAndCosines { names, angles, count });
                let locals: Vec<usize> = self.groups.angles.iter().flatten().flatten().copied().collect();
                locals.into_iter().for_each(|local| self.seed(local, &mut steps));
            }
            match self.run_of.get(group) {
                None => break,
                Some(Some(run)) => {
                    let run = *run;
                    let groups = self.runs[run].groups.clone();
                    let [first, last] = [groups.start, groups.end - 1].map(|group| &self.groups.all[group]);
                    if first.sink.is_none() {
                        steps.push(Step::Links([first.number, last.number]));
                    }
                    let (known, turns) = (self.lists.len(), self.run(run));
                    for list in known..self.lists.len() {
                        let (name, values) = self.lists[list].clone();
                        let values = values.iter().map(|value| self.leaf(value)).collect();
                        steps.push(Step::List(name, values));
                    }
                    steps.push(turns);
                    for (local, _) in self.groups.all[groups.clone()].iter().flat_map(|group| &group.bindings) {
                        self.seed(*local, &mut steps);
                    }
                    group = groups.end;
                }
                Some(None) => {
                    self.alone(group, &mut steps);
                    group += 1;
                }
            }
        }
        let results = self.groups.all.iter().filter(|group| group.sink == Some(Sink::Results));
        let numbers: Vec<i64> = results.map(|group| group.number).collect();
        let results = numbers.iter().map(|&k| self.text(self.at(&self.results, Along::only(k)))).collect();
        let kept = self.arrays.iter().filter(|(family, _)| matches!(family, Family::OfRun(..)));
        let mut arrays: Vec<(String, usize)> = kept.map(|(_, array)| (array.name.clone(), array.count)).collect();
        arrays.push((self.results.clone(), numbers.len()));
        if self.groups.sines_at.is_some() {
            arrays.push((self.angles.clone(), self.groups.angles.len()));
        }
        let of_bits = |bits: Vec<u64>| bits.into_iter().map(f64::from_bits).collect();
        let tables = self.tables.into_iter().map(|(name, bits)| (name, of_bits(bits))).collect();
        Rolled { locals: self.locals, arrays, tables, steps, results }
    }

    /// What stands for a text.
    fn text(&mut self, text: String) -> Tree {
        if let Some(&known) = self.texts.get(&text) {
            return Tree::Local(known);
        }
        self.locals.push(text.clone());
        self.texts.insert(text, self.locals.len() - 1);
        Tree::Local(self.locals.len() - 1)
    }

    fn place(&mut self, text: String) -> usize {
        match self.text(text) {
            Tree::Local(local) => local,
            _ => unreachable!("texts are locals"),
        }
    }

    /// Which component it is, as the language counts them.
    fn place_of(&self, Along { slope, start }: Along) -> String {
        let (index, start) = (&self.index, start + self.loops.first());
        let turn = match slope {
            0 => return start.to_string(),
            1 => index.clone(),
            _ => format!("{slope} * {index}"),
        };
        match start {
            0 => turn,
            1.. => format!("{turn} + {start}"),
            _ => format!("{turn} - {}", -start),
        }
    }

    /// A component of an array.
    fn at(&self, name: &str, along: Along) -> String {
        self.loops.component(name, &self.place_of(along))
    }

    /// A component of an argument.
    fn of_argument(&self, name: &str, along: Along) -> String {
        self.loops.argument(name, &self.place_of(along))
    }

    /// A component of the array of a family.
    fn component(&self, family: Family, number: i64) -> String {
        let array = &self.arrays[&family];
        self.at(&array.name, Along::only(number - array.first))
    }

    /// The component of this turn, of what begins with that of the turn `first`.
    fn of_this_turn(&self, name: &str, first: i64) -> String {
        self.at(name, Along { slope: 1, start: -first })
    }

    /// A leaf outside of loops.
    fn leaf(&mut self, leaf: &Tree) -> Tree {
        match leaf {
            Tree::Symbol(symbol) => match argument(*symbol) {
                Some((name, number)) => self.text(self.of_argument(name, Along::only(number))),
                None => leaf.clone(),
            },
            Tree::Local(local) => match component_of(self.groups, self.runs, &self.run_of, *local) {
                Some((family, number)) => self.text(self.component(family, number)),
                None => leaf.clone(),
            },
            _ => leaf.clone(),
        }
    }

    /// The statements of a group that is in no loop.
    fn alone(&mut self, group: usize, steps: &mut Vec<Step>) {
        let Group { number, sink, bindings, .. } = &self.groups.all[group];
        if sink.is_none() && *number > 0 {
            steps.push(Step::Link(*number));
        }
        for (local, tree) in bindings {
            let tree = tree.with_leaves(&mut |leaf| self.leaf(leaf));
            match self.sink(*sink) {
                Some(array) => {
                    let place = self.place(self.at(&array, Along::only(*number)));
                    steps.push(Step::Keep(place, tree));
                }
                None => steps.push(Step::Let(*local, tree)),
            }
            self.seed(*local, steps);
        }
    }

    fn sink(&self, sink: Option<Sink>) -> Option<String> {
        sink.map(|sink| if sink == Sink::Angles { self.angles.clone() } else { self.results.clone() })
    }

    /// Keeps a value where loops look for it.
    fn seed(&mut self, local: usize, steps: &mut Vec<Step>) {
        for (family, number) in self.seeds.get(&local).cloned().unwrap_or_default() {
            let value = self.leaf(&Tree::Local(local));
            let place = self.place(self.component(family, number));
            steps.push(Step::Keep(place, value));
        }
    }

    /// A loop.
    fn run(&mut self, run: usize) -> Step {
        let Run { period, distance, first, .. } = self.runs[run];
        let mut steps = Vec::new();
        for place in 0..period {
            self.turn(run, place, &mut steps);
        }
        let [first, end] = [first, first + self.runs[run].turns()].map(|index| usize::try_from(index).unwrap_or(0));
        Step::Loop(Turns { index: self.index.clone(), first, end, is_inwards: distance < 0 }, steps)
    }

    /// The statements of the groups at this place in the turns of a loop.
    fn turn(&mut self, number: usize, place: usize, steps: &mut Vec<Step>) {
        let (forms, run) = (&self.forms[number][place], &self.runs[number]);
        let group = &self.groups.all[run.groups.start + place];
        let own: BTreeMap<usize, usize> =
            group.bindings.iter().enumerate().map(|(at, (local, _))| (*local, at)).collect();
        let mut places = Vec::new();
        for (at, (local, _)) in group.bindings.iter().enumerate() {
            let kept = match (self.sink(group.sink), self.arrays.get(&Family::OfRun(number, place, at))) {
                (Some(array), _) => {
                    let slope = run.distance.abs();
                    let start = group.number - slope * run.turn_of(run.groups.start + place);
                    Some(self.at(&array, Along { slope, start }))
                }
                (None, array) => array.map(|array| self.of_this_turn(&array.name, array.first)),
            };
            places.push(match kept {
                Some(component) => (self.place(component), true),
                None => {
                    let name = self.scope.unique(&of_any_link(&self.locals[*local]));
                    self.locals.push(name);
                    (self.locals.len() - 1, false)
                }
            });
        }
        let mut forms = forms.iter();
        for ((_, tree), &(kept_at, is_kept)) in group.bindings.iter().zip(&places) {
            let tree = tree.with_leaves(&mut |tree| {
                if let Tree::Local(local) = tree
                    && let Some(&at) = own.get(local)
                {
                    return Tree::Local(places[at].0);
                }
                if matches!(tree, Tree::Symbol(Symbol::Time | Symbol::Prescribed(..))) {
                    return tree.clone();
                }
                match forms.next() {
                    None | Some(Form::Same) => self.leaf(tree),
                    Some(&Form::Argument(name, along)) => self.text(self.of_argument(name, along)),
                    Some(&Form::Component(family, along)) => {
                        let Array { name, first, .. } = &self.arrays[&family];
                        self.text(self.at(name, Along { start: along.start - first, ..along }))
                    }
                    Some(Form::Table(bits)) => {
                        let table = self.table(bits);
                        self.text(self.loops.entry(self.of_this_turn(&table, run.first)))
                    }
                    Some(Form::List(values)) => {
                        let list = self.list(values);
                        self.text(self.of_this_turn(&list, run.first))
                    }
                }
            });
            steps.push(if is_kept { Step::Keep(kept_at, tree) } else { Step::Let(kept_at, tree) });
        }
    }

    /// The name of a table of these numbers.
    fn table(&mut self, bits: &[u64]) -> String {
        named(&mut self.tables, bits, || self.scope.unique("NUMBERS"))
    }

    /// The name of a list of these values.
    fn list(&mut self, values: &[Tree]) -> String {
        named(&mut self.lists, values, || self.scope.unique(self.list))
    }
}

/// What these are called; a name of their own where they are not known yet.
fn named<T: Clone + PartialEq>(known: &mut Vec<(String, Vec<T>)>, of: &[T], name: impl FnOnce() -> String) -> String {
    if let Some((name, _)) = known.iter().find(|(_, known)| known == of) {
        return name.clone();
    }
    known.push((name(), of.to_vec()));
    known[known.len() - 1].0.clone()
}

/// `w12x_a` → `wjx_a`: the name of a local with the number of its link left open.
fn of_any_link(name: &str) -> String {
    let Some(start) = name.find(|c: char| c.is_ascii_digit()) else { return name.to_string() };
    let rest = name[start..].trim_start_matches(|c: char| c.is_ascii_digit());
    format!("{}j{rest}", &name[..start])
}
