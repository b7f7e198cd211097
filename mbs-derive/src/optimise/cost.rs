//! Operation counts.

use std::collections::BTreeSet;
use std::ops::Add;

use crate::expr::Function;

use super::program::{Instruction, Program};
use super::{ResultPart, Shape};

/// What a program costs. Negations are free, a subtraction is an addition, a sine and a cosine of one angle are one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub add: usize,
    /// Multiplications.
    pub mul: usize,
    /// Divisions.
    pub div: usize,
    /// Square roots.
    pub sqrt: usize,
    /// Angles of which the sine, the cosine or both are computed.
    pub sincos: usize,
    /// Other functions.
    pub other: usize,
}

impl Operations {
    /// `add + mul`
    pub fn flops(self) -> usize {
        self.add + self.mul
    }

    /// All operations in units of an addition: a division 4, a square root 6, a function 20.
    pub fn weight(self) -> usize {
        self.flops() + 4 * self.div + 6 * self.sqrt + 20 * (self.sincos + self.other)
    }
}

impl Add for Operations {
    type Output = Operations;

    fn add(self, other: Operations) -> Operations {
        Operations {
            add: self.add + other.add,
            mul: self.mul + other.mul,
            div: self.div + other.div,
            sqrt: self.sqrt + other.sqrt,
            sincos: self.sincos + other.sincos,
            other: self.other + other.other,
        }
    }
}

/// Counts the instructions of a program.
pub fn operations(program: &Program) -> Operations {
    let mut count = Operations::default();
    let mut angles = BTreeSet::new();
    for instruction in &program.instructions {
        match *instruction {
            Instruction::Constant(_) | Instruction::Symbol(_) | Instruction::Hoisted(_) | Instruction::Neg(_) => {}
            Instruction::Add(..) | Instruction::Sub(..) => count.add += 1,
            Instruction::Mul(..) => count.mul += 1,
            Instruction::Div(..) => count.div += 1,
            Instruction::Sqrt(_) => count.sqrt += 1,
            Instruction::Call(Function::Sin | Function::Cos, angle) => {
                angles.insert(angle);
            }
            Instruction::And(..) | Instruction::Not(_) => {}
            Instruction::Less(..)
            | Instruction::LessEqual(..)
            | Instruction::Select(..)
            | Instruction::Call(..)
            | Instruction::Call2(..) => count.other += 1,
        }
    }
    Operations { sincos: angles.len(), ..count }
}

/// What the runtime's LDLᵀ of a system of `n` rows and its substitutions cost for these right sides.
pub fn solve(n: usize, results: &[ResultPart]) -> Operations {
    let columns = results.iter().fold(0, |sum, part| match part.shape {
        Shape::Vector(_) => sum + 1,
        Shape::Matrix(_, columns) => sum + columns,
        Shape::Scalar
        | Shape::Symmetric(_)
        | Shape::Pose
        | Shape::Wrench
        | Shape::Wrenches(_)
        | Shape::Matrices(..)
        | Shape::Poses(_) => unreachable!("right sides are vectors or matrices"),
    });
    // Row i: j products and differences for each j < i, i scalings, i products and differences, one division.
    let pairs = (0..n).map(|i| i * i.saturating_sub(1) / 2 + i).sum::<usize>();
    let scalings = n * n.saturating_sub(1) / 2;
    let substitutions = n * n.saturating_sub(1);
    Operations {
        add: pairs + columns * substitutions,
        mul: pairs + scalings + columns * (substitutions + n),
        div: n,
        ..Operations::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::solve::Factorization;
    use crate::expr::{Expr, Graph, Symbol};
    use crate::optimise::{lower, schedule::Hoisting};

    #[test]
    fn the_loop_costs_what_its_unrolling_costs() {
        let graph = Graph::new();
        let n = 5;
        let symbol = |i: usize| graph.symbol(Symbol::Coordinate(i as u32));
        let m: Vec<Vec<Expr<'_>>> = (0..n).map(|i| (0..n).map(|j| symbol(i.max(j) * n + i.min(j))).collect()).collect();
        let factorization = Factorization::new(&m);
        let column = |k: usize| factorization.solve(&(0..n).map(|i| symbol(100 * k + i)).collect::<Vec<_>>());
        // Two columns: with one, the last pivot's reciprocal is used once and becomes a division.
        let unrolled = [column(1), column(2)].concat();
        let counted = operations(&lower::program(&unrolled, &Hoisting::none()));
        assert_eq!(counted, solve(n, &[ResultPart { name: "", shape: Shape::Matrix(n, 2) }]));
    }
}
