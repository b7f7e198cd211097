//! Which sines and cosines one call computes.
//!
//! Those of one region whose angles can be known when the first of them is asked for: an angle that depends on another
//! one's sine comes with the next call, one that depends on a branch after it.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::Function;
use crate::optimise::region::{Place, Region};
use crate::optimise::{Instruction, Program, Value};

/// An angle at the place where its sine, its cosine or both are computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) angle: Value,
    pub(super) place: Place,
    pub(super) sin: Option<Value>,
    pub(super) cos: Option<Value>,
}

impl Wanted {
    /// Whether both are wanted.
    pub(super) fn is_pair(&self) -> bool {
        self.sin.is_some() && self.cos.is_some()
    }
}

/// All angles of a program, in the order in which they are first asked for.
#[derive(Clone, Debug, Default)]
pub(super) struct Angles {
    wanted: Vec<Wanted>,
    /// By sine and by cosine.
    of: BTreeMap<Value, usize>,
    written: BTreeSet<usize>,
}

impl Angles {
    /// Of the values that are used.
    pub(super) fn new(program: &Program, is_used: impl Fn(Value) -> bool) -> Self {
        let mut angles = Angles::default();
        let mut found: BTreeMap<(Value, Region, Option<Region>), usize> = BTreeMap::new();
        for (i, instruction) in program.instructions.iter().enumerate() {
            let value = Value(i as u32);
            let Instruction::Call(function @ (Function::Sin | Function::Cos), angle) = *instruction else { continue };
            if !is_used(value) {
                continue;
            }
            let place = program.regions.place(value);
            let number = *found.entry((angle, place.region, place.on_demand)).or_insert_with(|| {
                angles.wanted.push(Wanted { angle, place, sin: None, cos: None });
                angles.wanted.len() - 1
            });
            let wanted = &mut angles.wanted[number];
            *if function == Function::Sin { &mut wanted.sin } else { &mut wanted.cos } = Some(value);
            angles.of.insert(value, number);
        }
        angles
    }

    /// All of them.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Wanted> {
        self.wanted.iter()
    }

    /// The angle of a sine or cosine that is used.
    pub(super) fn of(&self, value: Value) -> Option<Wanted> {
        self.of.get(&value).map(|&number| self.wanted[number])
    }

    /// The angles that go with that of `value`, itself first, and the values to compute before; where they are not
    /// written yet.
    pub(super) fn together(
        &mut self,
        program: &Program,
        value: Value,
        is_known: impl Fn(Value) -> bool,
    ) -> (Vec<Wanted>, BTreeSet<Value>) {
        let first = self.of[&value];
        let place = self.wanted[first].place;
        let mut group = vec![self.wanted[first]];
        let mut before = BTreeSet::new();
        self.written.insert(first);
        if place.on_demand.is_none() {
            for number in first + 1..self.wanted.len() {
                let wanted = self.wanted[number];
                if self.written.contains(&number)
                    || wanted.place.region != place.region
                    || wanted.place.on_demand.is_some()
                {
                    continue;
                }
                if let Some(needed) = needed(program, wanted.angle, &before, &is_known) {
                    before.extend(needed);
                    self.written.insert(number);
                    group.push(wanted);
                }
            }
        }
        (group, before)
    }
}

/// What is to be computed for a value beyond what is known and planned, if no branch, spline, sine or cosine is among
/// it.
fn needed(
    program: &Program,
    value: Value,
    planned: &BTreeSet<Value>,
    is_known: impl Fn(Value) -> bool,
) -> Option<BTreeSet<Value>> {
    let (mut needed, mut open) = (BTreeSet::new(), vec![value]);
    while let Some(value) = open.pop() {
        if is_known(value) || planned.contains(&value) || !needed.insert(value) {
            continue;
        }
        let instruction = program.instructions[value.index()];
        let waits = match instruction {
            Instruction::Call(function, _) => matches!(function, Function::Sin | Function::Cos),
            Instruction::Spline(..)
            | Instruction::Less(..)
            | Instruction::LessEqual(..)
            | Instruction::And(..)
            | Instruction::Not(_)
            | Instruction::Select(..) => true,
            Instruction::Constant(_)
            | Instruction::Symbol(_)
            | Instruction::Hoisted(_)
            | Instruction::Neg(_)
            | Instruction::Add(..)
            | Instruction::Sub(..)
            | Instruction::Mul(..)
            | Instruction::Div(..)
            | Instruction::Sqrt(_)
            | Instruction::Call2(..) => false,
        };
        if waits || program.regions.place(value).on_demand.is_some() {
            return None;
        }
        open.extend(instruction.operands());
    }
    Some(needed)
}
