//! Operation counts.

use std::collections::BTreeSet;
use std::ops::Add;

use crate::expr::{Elimination, Function};

use super::program::{Instruction, Program};
use super::{ResultPart, Shape};

/// What a program costs. Negations are free, a subtraction is an addition, a sine and a cosine of one angle are one.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, optimise::FunctionKind, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// let mass_matrix = analysis.programs().function(FunctionKind::MassMatrix).unwrap();
/// assert_eq!(mass_matrix.operations.flops(), 0); // a constant
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
pub(crate) fn operations(program: &Program) -> Operations {
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
            | Instruction::Spline(..)
            | Instruction::Call(..)
            | Instruction::Call2(..) => count.other += 1,
        }
    }
    Operations { sincos: angles.len(), ..count }
}

/// How many right sides the results have.
fn columns(results: &[ResultPart]) -> usize {
    results.iter().fold(0, |sum, part| match part.shape {
        Shape::Vector(_) => sum + 1,
        Shape::Matrix(_, columns) => sum + columns,
        Shape::Scalar
        | Shape::Symmetric(_)
        | Shape::Pose
        | Shape::Wrench
        | Shape::Wrenches(_)
        | Shape::Matrices(..)
        | Shape::Poses(_) => unreachable!("right sides are vectors or matrices"),
    })
}

impl Operations {
    /// What the runtime's `constrained_solve` costs for these right sides, of `n` coordinates and `k` rows that are
    /// independent, where no entry is zero. With `s = n − k` independent coordinates, pairs of a product and a sum:
    ///
    /// | step                                  | pairs                                            | products          | quotients |
    /// |---------------------------------------|--------------------------------------------------|-------------------|-----------|
    /// | scales of M and A                     |                                                  | n(n+1)/2 + k n    |           |
    /// | `A = L (U₁ U₂)`                       | Σ (k−1−p)(n−1−p), p < k                          | k(k−1)/2 + k      | k         |
    /// | `W = U₁⁻¹ U₂`                         | s k(k−1)/2                                       | s k               |           |
    /// | `V`, `S`                              | s k² + s(s+1) k                                  |                   |           |
    /// | what pivots of S are compared with    | s k                                              | s k + s           | s         |
    /// | `S = L D Lᵀ`                          | Σ p(p+1)/2, p < s                                | s(s−1)/2 + s²     | s         |
    /// | each right side                       | 2k(k−1) + 2n k + 2s k + s(s−1)                   | 2n + 2k + 2k + s  |           |
    ///
    /// (`s²` and one of the `k` compare pivots.) Where rows depend on others, or more of them than coordinates, it
    /// costs otherwise.
    pub fn of_constrained_solve([n, k]: [usize; 2], results: &[ResultPart]) -> Operations {
        let (k, columns) = (k.min(n), columns(results));
        let s = n - k;
        let triangle = |x: usize| x * x.saturating_sub(1) / 2;
        let elimination: usize = (0..k).map(|p| (k - 1 - p) * (n - 1 - p)).sum();
        let factorization: usize = (0..s).map(|p| p * (p + 1) / 2).sum();
        let reduction = s * triangle(k) + s * k * k + s * (s + 1) * k + s * k;
        let pairs = elimination + reduction + factorization;
        let products = n * (n + 1) / 2 + k * n + triangle(k) + k + 2 * s * k + s + triangle(s) + s * s;
        let column_pairs = 4 * triangle(k) + 2 * n * k + 2 * s * k + 2 * triangle(s);
        let column_products = 2 * (n + k) + 2 * k + s;
        Operations {
            add: pairs + columns * column_pairs,
            mul: pairs + products + columns * (column_pairs + column_products),
            div: k + 2 * s,
            ..Operations::default()
        }
    }
}

/// What the runtime's elimination of a system costs for these right sides.
pub(crate) fn eliminate(elimination: &Elimination, results: &[ResultPart]) -> Operations {
    let ([factorization, solution], columns, size) = (elimination.pairs(), columns(results), elimination.order.len());
    let pairs = factorization + columns * solution;
    Operations {
        // What pivots are compared with is summed up.
        add: pairs + solution / 2,
        // Entries by reciprocal pivots, what is left of a pivot, and right sides by reciprocal pivots.
        mul: pairs + solution / 2 + size + columns * size,
        div: size,
        ..Operations::default()
    }
}

/// What the runtime's LDLᵀ of a system of `n` rows and its substitutions cost for these right sides.
pub(crate) fn solve(n: usize, results: &[ResultPart]) -> Operations {
    let columns = columns(results);
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
    use crate::equations::Factorization;
    use crate::expr::{Expr, Graph, Symbol};
    use crate::optimise::{lower, schedule::Hoisting};

    #[test]
    fn the_loop_costs_what_its_unrolling_costs() {
        let graph = Graph::new();
        let n = 5;
        let symbol = |i: usize| graph.symbol(Symbol::Coordinate(i as u32));
        let m: Vec<Vec<Expr<'_>>> = (0..n).map(|i| (0..n).map(|j| symbol(i.max(j) * n + i.min(j))).collect()).collect();
        let factorization = Factorization::new(&m).expect("a small matrix");
        let column = |k: usize| factorization.solve(&(0..n).map(|i| symbol(100 * k + i)).collect::<Vec<_>>());
        // Two columns: with one, the last pivot's reciprocal is used once and becomes a division.
        let unrolled = [column(1), column(2)].concat();
        let counted = operations(&lower::program(&unrolled, &Hoisting::none()));
        assert_eq!(counted, solve(n, &[ResultPart { name: "", shape: Shape::Matrix(n, 2) }]));
    }
}
