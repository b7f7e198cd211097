//! Straight-line programs.

use std::fmt;

use crate::expr::{Binary, Function, Number, Symbol};

/// Number of the instruction that makes a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub(crate) u32);

impl Value {
    /// For tables over all values of a program.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One step; operands are values of earlier steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    /// Whether `a < b`
    Less(Value, Value),
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
        let operands = match self {
            Instruction::Constant(_) | Instruction::Symbol(_) | Instruction::Hoisted(_) => [None; 3],
            Instruction::Neg(a) | Instruction::Sqrt(a) | Instruction::Call(_, a) | Instruction::Not(a) => {
                [Some(a), None, None]
            }
            Instruction::Add(a, b)
            | Instruction::Sub(a, b)
            | Instruction::Mul(a, b)
            | Instruction::Div(a, b)
            | Instruction::Less(a, b)
            | Instruction::And(a, b)
            | Instruction::Call2(_, a, b) => [Some(a), Some(b), None],
            Instruction::Select(c, a, b) => [Some(c), Some(a), Some(b)],
        };
        operands.into_iter().flatten()
    }
}

/// Instructions in order of execution, and which of their values are the results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Program {
    /// In order; every value is used, by an instruction or as a result.
    pub instructions: Vec<Instruction>,
    /// The results.
    pub results: Vec<Value>,
}

impl Program {
    /// Whether it reads a symbol of this kind.
    pub fn uses(&self, chosen: impl Fn(Symbol) -> bool) -> bool {
        self.instructions.iter().any(|i| matches!(i, Instruction::Symbol(symbol) if chosen(*symbol)))
    }

    /// How often each value is used, by instructions and as a result.
    pub fn uses_of_values(&self) -> Vec<usize> {
        let mut uses = vec![0; self.instructions.len()];
        let operands = self.instructions.iter().flat_map(|i| i.operands());
        for value in operands.chain(self.results.iter().copied()) {
            uses[value.index()] += 1;
        }
        uses
    }
}

/// One instruction a line: `v3 = v1 * v2`.
impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, instruction) in self.instructions.iter().enumerate() {
            write!(f, "v{i} = ")?;
            match *instruction {
                Instruction::Constant(value) => writeln!(f, "{value}")?,
                Instruction::Symbol(symbol) => writeln!(f, "{symbol}")?,
                Instruction::Hoisted(k) => writeln!(f, "k{k}")?,
                Instruction::Neg(a) => writeln!(f, "-v{}", a.0)?,
                Instruction::Add(a, b) => writeln!(f, "v{} + v{}", a.0, b.0)?,
                Instruction::Sub(a, b) => writeln!(f, "v{} - v{}", a.0, b.0)?,
                Instruction::Mul(a, b) => writeln!(f, "v{} * v{}", a.0, b.0)?,
                Instruction::Div(a, b) => writeln!(f, "v{} / v{}", a.0, b.0)?,
                Instruction::Sqrt(a) => writeln!(f, "sqrt(v{})", a.0)?,
                Instruction::Call(function, a) => writeln!(f, "{}(v{})", function.name(), a.0)?,
                Instruction::Less(a, b) => writeln!(f, "v{} < v{}", a.0, b.0)?,
                Instruction::And(a, b) => writeln!(f, "v{} && v{}", a.0, b.0)?,
                Instruction::Not(a) => writeln!(f, "!v{}", a.0)?,
                Instruction::Select(c, a, b) => writeln!(f, "if v{} {{ v{} }} else {{ v{} }}", c.0, a.0, b.0)?,
                Instruction::Call2(function, a, b) => writeln!(f, "{}(v{}, v{})", function.name(), a.0, b.0)?,
            }
        }
        let results: Vec<String> = self.results.iter().map(|v| format!("v{}", v.0)).collect();
        writeln!(f, "return {}", results.join(", "))
    }
}
