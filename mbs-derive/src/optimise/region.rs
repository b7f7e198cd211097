//! Which values are needed on one side of a branch only.
//!
//! A [`Region`] is a part of a program that is executed as a whole or not at all: the body, the sides of a [`Branch`],
//! and what a value needs that is computed on demand. Regions nest. From the results back to the leaves each value is
//! put where all that use it can see it, and no further out:
//!
//! - what one side of a branch uses, and nothing else, belongs to that side;
//! - what both sides use, or something around the branch, belongs around it;
//! - what sides of several branches use, and nothing that is certain to be executed, is computed when first asked for.
//!
//! So whatever is executed is needed. Selections on one condition are one branch, where none of them depends on
//! another.

use std::collections::BTreeMap;

use super::program::{Instruction, Value};

/// Branches are nested at most this deep; sides of deeper ones are computed on demand.
const NESTING: u32 = 64;

/// At most this many values of a program are computed on demand; the others are computed in any case, as loops without
/// end would make them.
const ON_DEMAND: usize = 1000;

/// A part of a program that is executed as a whole or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Region(u32);

impl Region {
    /// What is executed at each call.
    pub const BODY: Region = Region(0);

    /// For tables over all regions.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where a value is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Place {
    /// The region in which it is known.
    pub region: Region,
    /// Whether it is computed whenever that region is executed; conditions that are not are asked where they are
    /// needed.
    pub certain: bool,
    /// The region of what it alone needs, if it is computed when first asked for.
    pub on_demand: Option<Region>,
}

/// Selections on one condition, made together.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Branch {
    /// The condition.
    pub condition: Value,
    /// The selections, in order.
    pub selections: Vec<Value>,
    /// What is executed where the condition holds, and where it does not.
    pub sides: [Region; 2],
}

/// The regions of a program; of one without branches there is the body alone.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Regions {
    /// Of each value; none where all are certain.
    places: Vec<Place>,
    branches: Vec<Branch>,
    /// Of each value that is a selection of a branch.
    branch_of: BTreeMap<Value, usize>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Node {
    parent: Region,
    depth: u32,
    /// Branch and side.
    side: Option<(usize, usize)>,
}

impl Regions {
    /// Where a value is computed.
    pub fn place(&self, value: Value) -> Place {
        let certain = Place { region: Region::BODY, certain: true, on_demand: None };
        self.places.get(value.index()).copied().unwrap_or(certain)
    }

    /// Whether all values are computed at each call.
    pub fn are_certain(&self) -> bool {
        self.places.is_empty()
    }

    /// Whether a value is computed at each call.
    pub fn is_certain(&self, value: Value) -> bool {
        let place = self.place(value);
        place.region == Region::BODY && place.certain
    }

    /// The branch that makes this selection; none where both sides are known without it.
    pub fn branch(&self, selection: Value) -> Option<&Branch> {
        self.branch_of.get(&selection).map(|&number| &self.branches[number])
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.nodes.len().max(1)
    }

    /// The same regions where the values of `order` come in this order and have the numbers that `number` gives them.
    pub(super) fn renumbered(mut self, order: &[Value], number: impl Fn(Value) -> Value) -> Regions {
        for branch in &mut self.branches {
            branch.condition = number(branch.condition);
            branch.selections.iter_mut().for_each(|selection| *selection = number(*selection));
        }
        let places = order.iter().map(|old| self.places[old.index()]).collect();
        let branch_of = self.branch_of.into_iter().map(|(value, branch)| (number(value), branch)).collect();
        Regions { places, branch_of, ..self }
    }

    /// The sides that enclose a region, from outside to inside: condition, and whether it holds.
    pub fn conditions(&self, region: Region) -> Vec<(Value, bool)> {
        let (mut found, mut region) = (Vec::new(), region);
        while region != Region::BODY {
            let node = self.nodes[region.index()];
            found.extend(node.side.map(|(branch, side)| (self.branches[branch].condition, side == 0)));
            region = node.parent;
        }
        found.reverse();
        found
    }
}

/// Whether it chooses between two values.
pub(super) fn is_selection(instruction: &Instruction) -> bool {
    matches!(instruction, Instruction::Select(..))
}

/// The regions of instructions whose operands come before them, and an order in which the results need them and the
/// selections of each branch can be made together. Where a selection depends on another one of its condition, only
/// those are one branch that have equally many selections below.
pub(super) fn regions(instructions: &[Instruction], results: &[Value]) -> (Regions, Vec<Value>) {
    let together = regions_by_rank(instructions, results, vec![0; instructions.len()]);
    if let Some(order) = order(instructions, results, &together) {
        return (together, order);
    }
    let apart = regions_by_rank(instructions, results, ranks(instructions));
    let order = order(instructions, results, &apart).expect("what depends on a selection ranks higher");
    (apart, order)
}

/// How often selections stand in what a value is made of, one in another, itself included.
fn ranks(instructions: &[Instruction]) -> Vec<u32> {
    let mut ranks: Vec<u32> = Vec::with_capacity(instructions.len());
    for instruction in instructions {
        let below = instruction.operands().map(|operand| ranks[operand.index()]).max().unwrap_or(0);
        ranks.push(below + u32::from(is_selection(instruction)));
    }
    ranks
}

/// Depth first, a branch after what any of its selections needs; `None` where that goes round in a circle.
fn order(instructions: &[Instruction], results: &[Value], regions: &Regions) -> Option<Vec<Value>> {
    let selections = |value: Value| regions.branch(value).map_or(vec![value], |branch| branch.selections.clone());
    // Whether it is begun, and whether it is done.
    let mut states = vec![(false, false); instructions.len()];
    let mut order = Vec::with_capacity(instructions.len());
    let mut stack: Vec<(Value, bool)> = results.iter().rev().map(|&result| (result, false)).collect();
    while let Some((value, operands_done)) = stack.pop() {
        let group = selections(value);
        let state = &mut states[group[0].index()];
        match *state {
            (true, true) => {}
            _ if operands_done => {
                *state = (true, true);
                order.extend(group);
            }
            (true, false) => return None,
            (false, _) => {
                *state = (true, false);
                stack.push((value, true));
                let operands = group.iter().flat_map(|selection| instructions[selection.index()].operands());
                let operands: Vec<Value> = operands.collect();
                stack.extend(operands.into_iter().rev().map(|operand| (operand, false)));
            }
        }
    }
    Some(order)
}

/// The regions where selections of one region, condition and rank are one branch.
fn regions_by_rank(instructions: &[Instruction], results: &[Value], ranks: Vec<u32>) -> Regions {
    let body = Node { parent: Region::BODY, depth: 0, side: None };
    let regions = Regions { nodes: vec![body], ..Regions::default() };
    let (uses, keys) = (vec![None; instructions.len()], BTreeMap::new());
    let mut sweep = Sweep { instructions, ranks, uses, keys, on_demand: 0, regions };
    results.iter().for_each(|&result| sweep.use_in(result, Region::BODY, true));
    let mut places: Vec<Place> = (0..instructions.len()).rev().map(|i| sweep.place(Value(i as u32))).collect();
    places.reverse();
    sweep.regions.branches.iter_mut().for_each(|branch| branch.selections.reverse());
    Regions { places, ..sweep.regions }
}

/// The users of a value are placed before it.
struct Sweep<'p> {
    instructions: &'p [Instruction],
    ranks: Vec<u32>,
    /// The innermost region that sees all users so far, and whether the value is needed whenever that is executed.
    uses: Vec<Option<(Region, bool)>>,
    /// Branches by region, condition and rank; those of one rank do not depend on each other.
    keys: BTreeMap<(Region, Value, u32), usize>,
    on_demand: usize,
    regions: Regions,
}

impl Sweep<'_> {
    fn place(&mut self, value: Value) -> Place {
        let Some((region, certain)) = self.uses[value.index()] else {
            return Place { region: Region::BODY, certain: false, on_demand: None };
        };
        if self.is_free(value) {
            self.instructions[value.index()].operands().for_each(|leaf| self.use_in(leaf, Region::BODY, true));
            return Place { region: Region::BODY, certain: true, on_demand: None };
        }
        let instruction = self.instructions[value.index()];
        if is_condition(instruction) {
            instruction.operands().for_each(|operand| self.use_in(operand, region, certain));
            return Place { region, certain, on_demand: None };
        }
        let certain = certain || self.on_demand == ON_DEMAND;
        let on_demand = (!certain).then(|| {
            self.on_demand += 1;
            self.region(region, None)
        });
        self.operands(value, on_demand.unwrap_or(region));
        Place { region, certain, on_demand }
    }

    /// Leaves and their negatives are written wherever they are used.
    fn is_free(&self, value: Value) -> bool {
        match self.instructions[value.index()] {
            Instruction::Constant(_) | Instruction::Symbol(_) | Instruction::Hoisted(_) => true,
            Instruction::Neg(a) => self.instructions[a.index()].operands().next().is_none(),
            _ => false,
        }
    }

    fn operands(&mut self, value: Value, region: Region) {
        let Instruction::Select(condition, a, b) = self.instructions[value.index()] else {
            let operands = self.instructions[value.index()].operands();
            return operands.for_each(|operand| self.use_in(operand, region, true));
        };
        self.use_in(condition, region, true);
        if self.is_free(a) && self.is_free(b) {
            return [a, b].into_iter().for_each(|arm| self.use_in(arm, Region::BODY, true));
        }
        let mut outer = region;
        while self.node(outer).depth > NESTING {
            outer = self.node(outer).parent;
        }
        if self.node(outer).depth == NESTING {
            [a, b].into_iter().for_each(|arm| self.use_in(arm, outer, false));
        } else {
            let sides = self.branch(region, condition, value);
            self.use_in(a, sides[0], true);
            self.use_in(b, sides[1], true);
        }
    }

    /// The sides of the branch that makes this selection.
    fn branch(&mut self, region: Region, condition: Value, selection: Value) -> [Region; 2] {
        let next = self.regions.branches.len();
        let number = *self.keys.entry((region, condition, self.ranks[selection.index()])).or_insert(next);
        if number == next {
            let sides = [0, 1].map(|side| self.region(region, Some((number, side))));
            self.regions.branches.push(Branch { condition, selections: Vec::new(), sides });
        }
        self.regions.branch_of.insert(selection, number);
        let branch = &mut self.regions.branches[number];
        branch.selections.push(selection);
        branch.sides
    }

    fn region(&mut self, parent: Region, side: Option<(usize, usize)>) -> Region {
        let depth = self.node(parent).depth + 1;
        self.regions.nodes.push(Node { parent, depth, side });
        Region(u32::try_from(self.regions.nodes.len() - 1).expect("fewer than 2³² regions"))
    }

    fn node(&self, region: Region) -> Node {
        self.regions.nodes[region.index()]
    }

    fn use_in(&mut self, value: Value, region: Region, certain: bool) {
        let known = self.uses[value.index()];
        self.uses[value.index()] = Some(known.map_or((region, certain), |known| self.around(known, (region, certain))));
    }

    /// Around two uses.
    fn around(&self, a: (Region, bool), b: (Region, bool)) -> (Region, bool) {
        let (x, y) = (self.node(a.0).side, self.node(b.0).side);
        if let (Some((branch, side)), Some((other, other_side))) = (x, y)
            && (branch == other && side != other_side && a.1 && b.1)
        {
            return (self.node(a.0).parent, true);
        }
        let common = self.common(a.0, b.0);
        (common, [a, b].into_iter().any(|(region, certain)| certain && region == common))
    }

    /// The innermost region around two.
    fn common(&self, mut a: Region, mut b: Region) -> Region {
        while a != b {
            if self.node(a).depth >= self.node(b).depth {
                a = self.node(a).parent;
            } else {
                b = self.node(b).parent;
            }
        }
        a
    }
}

/// Whether it is a condition: made of names, and written wherever it is asked.
fn is_condition(instruction: Instruction) -> bool {
    match instruction {
        Instruction::Less(..) | Instruction::LessEqual(..) | Instruction::And(..) | Instruction::Not(_) => true,
        Instruction::Constant(_)
        | Instruction::Symbol(_)
        | Instruction::Hoisted(_)
        | Instruction::Neg(_)
        | Instruction::Add(..)
        | Instruction::Sub(..)
        | Instruction::Mul(..)
        | Instruction::Div(..)
        | Instruction::Sqrt(_)
        | Instruction::Call(..)
        | Instruction::Call2(..)
        | Instruction::Spline(..)
        | Instruction::Select(..) => false,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::Program;
    use super::super::lower::program;
    use super::super::schedule::Hoisting;
    use super::*;
    use crate::expr::{Expr, Function, Graph, Symbol};

    fn lowered(build: impl for<'g> Fn([Expr<'g>; 3], &'g Graph) -> Vec<Expr<'g>>) -> String {
        let graph = Graph::new();
        let symbols = [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)));
        program(&build(symbols, &graph), &Hoisting::none()).to_string()
    }

    #[track_caller]
    fn check(expected: &str, build: impl for<'g> Fn([Expr<'g>; 3], &'g Graph) -> Vec<Expr<'g>>) {
        let text = lowered(build);
        assert!(text.contains(expected), "{expected} not in\n{text}");
    }

    #[test]
    fn what_one_side_needs_belongs_to_it() {
        let text = lowered(|[x, y, _], graph| vec![graph.select(x.less(y), x.sqrt(), y.call(Function::Ln))]);
        let sides =
            "v2 = v0 < v1\nv3 = sqrt(v0) where v2\nv4 = ln(v1) where !v2\nv5 = if v2 { v3 } else { v4 }\nreturn v5\n";
        assert_eq!(text, format!("v0 = q_0\nv1 = q_1\n{sides}"));
        check("sqrt(v0) where v2, !v4", |[x, y, z], graph| {
            vec![graph.select(x.less(y), graph.select(z.less(y), z, x.sqrt()), y)]
        });
    }

    #[test]
    fn what_is_needed_in_any_case_belongs_around() {
        check("= sqrt(v0)\n", |[x, y, _], graph| vec![graph.select(x.less(y), x.sqrt(), x.sqrt() + 1)]);
        check("= sqrt(v0)\n", |[x, y, _], graph| vec![graph.select(x.less(y), x.sqrt(), y), x.sqrt() + 1]);
        check("= sqrt(v0)\n", |[x, y, _], graph| vec![graph.select(x.sqrt().less(y), x.sqrt() * 2, y)]);
        check("= sqrt(v3) where v2\n", |[x, y, z], graph| {
            vec![graph.select(y.less(z), graph.select(x.less(y), x.sqrt(), x.sqrt() + 1), y)]
        });
    }

    #[test]
    fn selections_on_one_condition_share_what_their_sides_need() {
        let value_and_slope = |[x, y, _]: [Expr<'_>; 3], graph: &Graph| {
            let sides = [x.sqrt().sin(), x.sqrt().cos()].map(|side| graph.select(x.less(y), side, y).id());
            sides.map(|id| id.index())
        };
        let graph = Graph::new();
        let symbols = [0, 1, 2].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let roots = value_and_slope(symbols, &graph).map(|index| graph.expr(crate::expr::Id(index as u32)));
        let program = program(&roots, &Hoisting::none());
        assert!(program.to_string().contains("= sqrt(v0) where v2\n"), "{program}");
        let branch = program.regions.branch(program.results[0]).expect("a branch");
        assert_eq!(branch.selections, program.results);
    }

    #[test]
    fn a_selection_that_depends_on_another_one_of_its_condition_comes_after_it() {
        check("= sqrt(v0) on demand", |[x, y, _], graph| {
            let first = graph.select(x.less(y), x.sqrt(), y);
            vec![graph.select(x.less(y), x.sqrt() * first.sin(), first.cos()), first]
        });
    }

    #[test]
    fn what_several_branches_may_need_is_computed_on_demand() {
        check("= sqrt(v0) on demand", |[x, y, z], graph| {
            vec![graph.select(x.less(y), x.sqrt(), y) + graph.select(x.less(z), x.sqrt() * 2, z)]
        });
        // Below, between, above.
        check("= sqrt(v0) on demand", |[x, y, z], graph| {
            let above = graph.select(x.less(z), y, x.sqrt() * 2);
            vec![graph.select(x.less(y), x.sqrt(), above)]
        });
    }

    // ---- what is executed is needed, and the other way round

    /// Numbers from a fixed sequence: `x ← 6364136223846793005 x + 1442695040888963407`, its upper half.
    struct Sequence(u64);

    impl Sequence {
        fn below(&mut self, n: usize) -> usize {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as usize % n
        }
    }

    /// Sums, roots, selections and conditions, each of values made before.
    fn random_program(sequence: &mut Sequence, length: usize, conditions: usize) -> Program {
        let mut instructions: Vec<Instruction> = (0..3).map(|i| Instruction::Symbol(Symbol::Coordinate(i))).collect();
        let (mut numbers, mut truths) = (vec![0, 1, 2], Vec::new());
        for _ in 0..length {
            let mut pick = |from: &[usize]| Value(from[from.len() - 1 - sequence.below(from.len().min(8))] as u32);
            let (a, b) = (pick(&numbers), pick(&numbers));
            let made = instructions.len();
            if truths.len() < conditions && sequence.below(4) == 0 {
                let both = truths.len() > 1 && sequence.below(3) == 0;
                let pair = || (Value(truths[0] as u32), Value(truths[truths.len() - 1] as u32));
                instructions.push(if both { Instruction::And(pair().0, pair().1) } else { Instruction::Less(a, b) });
                truths.push(made);
                continue;
            }
            instructions.push(match sequence.below(5) {
                0 => Instruction::Add(a, b),
                1 => Instruction::Sqrt(a),
                _ if truths.is_empty() => Instruction::Mul(a, b),
                _ => Instruction::Select(Value(truths[sequence.below(truths.len())] as u32), a, b),
            });
            numbers.push(made);
        }
        let results = (0..1 + sequence.below(3)).map(|i| Value(numbers[numbers.len() - 1 - i] as u32)).collect();
        Program::new(instructions, results, Vec::new())
    }

    /// What emitted code does where the conditions have these truth values.
    struct Execution<'p> {
        program: &'p Program,
        holds: &'p [bool],
        executed: BTreeSet<Value>,
    }

    impl Execution<'_> {
        fn holds(&self, condition: Value) -> bool {
            match self.program.instructions[condition.index()] {
                Instruction::And(a, b) => self.holds(a) && self.holds(b),
                _ => self.holds[condition.index()],
            }
        }

        fn region(&mut self, region: Region) {
            for i in 0..self.program.instructions.len() {
                let (value, program) = (Value(i as u32), self.program);
                let place = program.regions.place(value);
                if place.region == region && place.certain && !self.executed.contains(&value) {
                    match program.regions.branch(value) {
                        Some(branch) => self.branch(branch, region),
                        None => self.value(value, region),
                    }
                }
            }
        }

        fn branch(&mut self, branch: &Branch, region: Region) {
            self.ask(branch.condition, region);
            let side = usize::from(!self.holds(branch.condition));
            self.region(branch.sides[side]);
            for &selection in &branch.selections {
                let Instruction::Select(_, a, b) = self.program.instructions[selection.index()] else { panic!() };
                self.ask([a, b][side], branch.sides[side]);
                self.executed.insert(selection);
            }
        }

        fn value(&mut self, value: Value, region: Region) {
            match self.program.instructions[value.index()] {
                Instruction::Select(condition, a, b) => {
                    self.ask(condition, region);
                    self.ask(if self.holds(condition) { a } else { b }, region);
                }
                other => other.operands().for_each(|operand| self.ask(operand, region)),
            }
            self.executed.insert(value);
        }

        /// A value is known, or is computed now; it is seen from where it is needed.
        fn ask(&mut self, value: Value, from: Region) {
            let place = self.program.regions.place(value);
            let mut around = from;
            while around != place.region {
                assert_ne!(around, Region::BODY, "{value:?} cannot be seen in\n{}", self.program);
                around = self.program.regions.nodes[around.index()].parent;
            }
            let instruction = self.program.instructions[value.index()];
            if is_condition(instruction) {
                self.value(value, place.region);
            } else if let Some(own) = place.on_demand
                && !self.executed.contains(&value)
            {
                self.region(own);
                match self.program.regions.branch(value) {
                    Some(branch) => self.branch(branch, own),
                    None => self.value(value, own),
                }
            }
            assert!(self.executed.contains(&value), "{value:?} is not known in\n{}", self.program);
        }

        /// What the results need.
        fn needed(&self) -> BTreeSet<Value> {
            let (mut needed, mut stack) = (BTreeSet::new(), self.program.results.clone());
            while let Some(value) = stack.pop() {
                if needed.insert(value) {
                    match self.program.instructions[value.index()] {
                        Instruction::Select(c, a, b) => stack.extend([c, if self.holds(c) { a } else { b }]),
                        other => stack.extend(other.operands()),
                    }
                }
            }
            needed
        }
    }

    #[test]
    fn what_is_executed_is_what_is_needed() {
        let mut sequence = Sequence(7);
        let (mut on_demand, mut shared) = (0, 0);
        for length in (5..65).cycle().take(1500) {
            let program = random_program(&mut sequence, length, 1 + length / 8);
            if program.regions.places.is_empty() {
                continue;
            }
            let values = || (0..program.instructions.len()).map(|i| Value(i as u32));
            on_demand += values().filter(|&value| program.regions.place(value).on_demand.is_some()).count();
            shared += program.regions.branches.iter().filter(|branch| branch.selections.len() > 1).count();
            for _ in 0..8 {
                let holds: Vec<bool> = values().map(|_| sequence.below(2) == 0).collect();
                let mut execution = Execution { program: &program, holds: &holds, executed: BTreeSet::new() };
                execution.region(Region::BODY);
                program.results.iter().for_each(|&result| execution.ask(result, Region::BODY));
                let computes = |value: &Value| program.instructions[value.index()].operands().next().is_some();
                let needed: BTreeSet<Value> = execution.needed().into_iter().filter(computes).collect();
                let executed: BTreeSet<Value> = execution.executed.into_iter().filter(computes).collect();
                assert_eq!(executed, needed, "in\n{program}");
            }
        }
        assert!(on_demand > 1000 && shared > 100, "{on_demand} on demand, {shared} shared: too few to say anything");
    }

    #[test]
    fn branches_within_branches_are_no_recursion() {
        let graph = Graph::new();
        let [x, y] = [0, 1].map(|i| graph.symbol(Symbol::Coordinate(i)));
        let knot = |i: i64| graph.integer(i);
        let deep = (0..100_000).fold(x, |f, i| graph.select(x.less(knot(i)), f * y, x.sqrt() + i));
        let program = program(&[deep], &Hoisting::none());
        let nodes = &program.regions.nodes;
        assert!(nodes.iter().all(|node| node.depth <= NESTING + 1));
        assert!(nodes.len() <= 2 * NESTING as usize + 1 + ON_DEMAND);
    }
}
