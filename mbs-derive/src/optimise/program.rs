//! Straight-line programs.

use std::fmt;

use crate::expr::{Binary, Function, Number, Spline, SplineDerivative, Symbol};

use super::region::{self, Regions};

/// Number of the instruction that makes a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Value(pub(crate) u32);

impl Value {
    /// For tables over all values of a program.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One step; operands are values of earlier steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Instruction {
    /// A constant.
    Constant(Number),
    /// An argument's component, t, or a parameter.
    Symbol(Symbol),
    /// A value that the constructor computed.
    Hoisted(u32),
    /// `−a`
    Neg(Value),
    /// `a + b`
    Add(Value, Value),
    /// `a − b`
    Sub(Value, Value),
    /// `a · b`
    Mul(Value, Value),
    /// `a / b`
    Div(Value, Value),
    /// `√a`
    Sqrt(Value),
    /// `f(a)`
    Call(Function, Value),
    /// `f(a, b)`
    Call2(Binary, Value, Value),
    /// A derivative of one of the program's splines at a
    Spline(SplineDerivative, Value),
    /// Whether `a < b`
    Less(Value, Value),
    /// Whether `a <= b`
    LessEqual(Value, Value),
    /// Whether both conditions hold
    And(Value, Value),
    /// Whether a condition does not hold
    Not(Value),
    /// `if condition { a } else { b }`
    Select(Value, Value, Value),
}

impl Instruction {
    /// The operands, in order.
    pub fn operands(self) -> impl Iterator<Item = Value> {
        let none = Value(0);
        let (operands, count) = match self {
            Instruction::Constant(_) | Instruction::Symbol(_) | Instruction::Hoisted(_) => ([none; 3], 0),
            Instruction::Neg(a)
            | Instruction::Sqrt(a)
            | Instruction::Call(_, a)
            | Instruction::Spline(_, a)
            | Instruction::Not(a) => ([a, none, none], 1),
            Instruction::Add(a, b)
            | Instruction::Sub(a, b)
            | Instruction::Mul(a, b)
            | Instruction::Div(a, b)
            | Instruction::Less(a, b)
            | Instruction::LessEqual(a, b)
            | Instruction::And(a, b)
            | Instruction::Call2(_, a, b) => ([a, b, none], 2),
            Instruction::Select(c, a, b) => ([c, a, b], 3),
        };
        operands.into_iter().take(count)
    }
}

impl Instruction {
    /// The same operation on other operands.
    pub(crate) fn with_operands(self, new: impl Fn(Value) -> Value) -> Instruction {
        match self {
            Instruction::Constant(_) | Instruction::Symbol(_) | Instruction::Hoisted(_) => self,
            Instruction::Neg(a) => Instruction::Neg(new(a)),
            Instruction::Add(a, b) => Instruction::Add(new(a), new(b)),
            Instruction::Sub(a, b) => Instruction::Sub(new(a), new(b)),
            Instruction::Mul(a, b) => Instruction::Mul(new(a), new(b)),
            Instruction::Div(a, b) => Instruction::Div(new(a), new(b)),
            Instruction::Sqrt(a) => Instruction::Sqrt(new(a)),
            Instruction::Call(function, a) => Instruction::Call(function, new(a)),
            Instruction::Call2(function, a, b) => Instruction::Call2(function, new(a), new(b)),
            Instruction::Spline(derivative, a) => Instruction::Spline(derivative, new(a)),
            Instruction::Less(a, b) => Instruction::Less(new(a), new(b)),
            Instruction::LessEqual(a, b) => Instruction::LessEqual(new(a), new(b)),
            Instruction::And(a, b) => Instruction::And(new(a), new(b)),
            Instruction::Not(a) => Instruction::Not(new(a)),
            Instruction::Select(c, a, b) => Instruction::Select(new(c), new(a), new(b)),
        }
    }
}

/// Instructions in order of execution, where they are executed, and which of their values are the results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Program {
    /// In order; every value is used, by an instruction or as a result.
    pub instructions: Vec<Instruction>,
    /// The results.
    pub results: Vec<Value>,
    /// Which instructions are executed on one side of a branch only.
    pub regions: Regions,
    /// The splines that instructions evaluate.
    pub splines: Vec<Spline>,
    /// What values are called where they were derived, in order.
    pub notes: Vec<(Value, String)>,
}

impl Program {
    /// Of instructions whose operands come before them, in the order in which the results need them; the selections of
    /// one branch stand together.
    pub fn new(instructions: Vec<Instruction>, results: Vec<Value>, notes: Vec<(Value, String)>) -> Self {
        if !instructions.iter().any(region::is_selection) {
            return Program { instructions, results, notes, ..Program::default() };
        }
        let (regions, order) = region::regions(&instructions, &results);
        let mut numbers = vec![Value(0); instructions.len()];
        order.iter().enumerate().for_each(|(new, old)| numbers[old.index()] = Value(new as u32));
        let (number, instructions_before) = (|value: Value| numbers[value.index()], instructions.len());
        let instructions: Vec<_> = order.iter().map(|old| instructions[old.index()].with_operands(number)).collect();
        let results = results.into_iter().map(number).collect();
        let mut is_kept = vec![false; instructions_before];
        order.iter().for_each(|old| is_kept[old.index()] = true);
        let kept = notes.into_iter().filter(|(value, _)| is_kept[value.index()]);
        let mut notes: Vec<_> = kept.map(|(value, name)| (number(value), name)).collect();
        notes.sort_by_key(|(value, _)| *value);
        Program { instructions, results, regions: regions.renumbered(&order, number), splines: Vec::new(), notes }
    }

    /// Whether it reads a symbol of this kind.
    pub fn uses(&self, chosen: impl Fn(Symbol) -> bool) -> bool {
        self.instructions.iter().any(|i| matches!(i, Instruction::Symbol(symbol) if chosen(*symbol)))
    }
}

/// One instruction a line: `v3 = v1 * v2`; `v3 = sqrt(v1) where v2, !v4` on one side of branches, or `on demand`.
impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, instruction) in self.instructions.iter().enumerate() {
            write!(f, "v{i} = ")?;
            match *instruction {
                Instruction::Constant(value) => write!(f, "{value}")?,
                Instruction::Symbol(symbol) => write!(f, "{symbol}")?,
                Instruction::Hoisted(k) => write!(f, "k{k}")?,
                Instruction::Neg(a) => write!(f, "-v{}", a.0)?,
                Instruction::Add(a, b) => write!(f, "v{} + v{}", a.0, b.0)?,
                Instruction::Sub(a, b) => write!(f, "v{} - v{}", a.0, b.0)?,
                Instruction::Mul(a, b) => write!(f, "v{} * v{}", a.0, b.0)?,
                Instruction::Div(a, b) => write!(f, "v{} / v{}", a.0, b.0)?,
                Instruction::Sqrt(a) => write!(f, "sqrt(v{})", a.0)?,
                Instruction::Call(function, a) => write!(f, "{}(v{})", function.name(), a.0)?,
                Instruction::Spline(d, a) => write!(f, "table_{}{}(v{})", d.spline, "'".repeat(d.order as usize), a.0)?,
                Instruction::Less(a, b) => write!(f, "v{} < v{}", a.0, b.0)?,
                Instruction::LessEqual(a, b) => write!(f, "v{} <= v{}", a.0, b.0)?,
                Instruction::And(a, b) => write!(f, "v{} && v{}", a.0, b.0)?,
                Instruction::Not(a) => write!(f, "!v{}", a.0)?,
                Instruction::Select(c, a, b) => write!(f, "if v{} {{ v{} }} else {{ v{} }}", c.0, a.0, b.0)?,
                Instruction::Call2(function, a, b) => write!(f, "{}(v{}, v{})", function.name(), a.0, b.0)?,
            }
            let place = self.regions.place(Value(i as u32));
            let conditions = self.regions.conditions(place.region);
            for (n, (condition, holds)) in conditions.into_iter().enumerate() {
                let (word, sign) = (if n == 0 { " where " } else { ", " }, if holds { "" } else { "!" });
                write!(f, "{word}{sign}v{}", condition.0)?;
            }
            writeln!(f, "{}", if place.on_demand.is_some() { " on demand" } else { "" })?;
        }
        let results: Vec<String> = self.results.iter().map(|v| format!("v{}", v.0)).collect();
        writeln!(f, "return {}", results.join(", "))
    }
}
