//! Which values are needed on one side of a branch only.
//!
//! A [`Region`] is a part of a program that is executed as a whole or not at all: the body, the sides of a [`Branch`], and
//! what a value needs that is computed on demand. Regions nest. From the results back to the leaves each value is put where
//! all that use it can see it, and no further out:
//!
//! - what one side of a branch uses, and nothing else, belongs to that side;
//! - what both sides use, or something around the branch, belongs around it;
//! - what sides of several branches use, and nothing that is certain to be executed, is computed when first asked for.
//!
//! So whatever is executed is needed. Selections on one condition are one branch, where none of them depends on another.

use std::collections::BTreeMap;

use super::program::{Instruction, Value};

/// Branches are nested so deep; sides of deeper ones are computed on demand.
const NESTING: u32 = 8;

/// So many values of a program are computed on demand; more are computed in any case, as loops without end would make them.
const ON_DEMAND: usize = 1000;

/// A part of a program that is executed as a whole or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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
pub struct Place {
    /// The region in which it is known.
    pub region: Region,
    /// Whether it is computed whenever that region is executed; conditions that are not are asked where they are needed.
    pub certain: bool,
    /// The region of what it alone needs, if it is computed when first asked for.
    pub on_demand: Option<Region>,
}

/// Selections on one condition, made together.
#[derive(Clone, Debug, PartialEq, Eq)]
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
pub struct Regions {
    /// Of each value; none where all are certain.
    places: Vec<Place>,
    branches: Vec<Branch>,
    /// Of each value that is a selection of a branch.
    branch_of: BTreeMap<Value, usize>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// How often selections stand in what a value is made of, one in another, itself included.
pub(super) fn ranks(instructions: &[Instruction]) -> Vec<u32> {
    let mut ranks: Vec<u32> = Vec::with_capacity(instructions.len());
    for instruction in instructions {
        let below = instruction.operands().map(|operand| ranks[operand.index()]).max().unwrap_or(0);
        ranks.push(below + u32::from(is_selection(instruction)));
    }
    ranks
}

/// Whether it chooses between two values.
pub(super) fn is_selection(instruction: &Instruction) -> bool {
    matches!(instruction, Instruction::Select(..))
}

/// The regions of instructions in order; what the results do not need is left out.
pub(super) fn regions(instructions: &[Instruction], results: &[Value]) -> Regions {
    let body = Node { parent: Region::BODY, depth: 0, side: None };
    let regions = Regions { nodes: vec![body], ..Regions::default() };
    let (ranks, keys) = (ranks(instructions), BTreeMap::new());
    let uses = vec![None; instructions.len()];
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
        | Instruction::Select(..) => false,
    }
}
