//! Systems with constraints over 200 bits: the whole bordered matrix, scaled and eliminated with complete pivoting.
//!
//! ```text
//! ⎡ M  Aᵀ ⎤ ⎡  q̈ ⎤   ⎡ f ⎤
//! ⎣ A  0  ⎦ ⎣ −λ ⎦ = ⎣ c ⎦
//! ```
//!
//! Nothing of the runtime's solution is in it, neither its scales nor its basis.

use mbs_derive::expr::{Symbol, Value};
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Completion, Function, FunctionKind, Shape};
use nalgebra::DMatrix;

use super::exact::Exact;

/// Of the scaled matrix, singular values less than this are those of rows that depend on others, or of motions without
/// inertia.
const NOTHING: f64 = 1e-12;

/// Pivots less than this are, because rows that differ by δ leave pivots of δ².
const NO_PIVOT: f64 = 1e-24;

/// Rows that depend on others agree with them so well.
const AGREEMENT: f64 = 1e-8;

/// Scales `s` of rows and columns, powers of two, with which the greatest entry of each row is about one.
fn scales(matrix: &DMatrix<f64>) -> Vec<f64> {
    let size = matrix.nrows();
    let mut scales = vec![1.0_f64; size];
    for _ in 0..40 {
        let largest = |i: usize| (0..size).map(|j| (matrix[(i, j)] * scales[j]).abs()).fold(0.0, f64::max) * scales[i];
        let factor = |i: usize| if largest(i) > 0.0 { 1.0 / largest(i).sqrt() } else { 1.0 };
        scales = (0..size).map(|i| scales[i] * factor(i)).collect();
    }
    scales.iter().map(|scale| scale.log2().round().exp2()).collect()
}

fn bordered<T: Copy>(n: usize, mass: impl Fn(usize, usize) -> T, jacobian: &[T], zero: T) -> Vec<Vec<T>> {
    let size = n + jacobian.len() / n.max(1);
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => mass(i, j),
        (true, false) => jacobian[(j - n) * n + i],
        (false, true) => jacobian[(i - n) * n + j],
        (false, false) => zero,
    };
    (0..size).map(|i| (0..size).map(|j| entry(i, j)).collect()).collect()
}

/// What is to be known of a system beside its solution.
#[derive(Clone, Debug)]
pub(crate) struct Conditioned {
    /// Of q̈ and λ, in which the scaled solution has one unit.
    pub(crate) units: Vec<f64>,
    /// The condition of the scaled matrix, rows that depend on others left out; infinite where a motion has no inertia.
    pub(crate) condition: f64,
    /// Whether rows depend on others.
    pub(crate) is_redundant: bool,
}

impl Conditioned {
    /// Of M and A in full, row by row.
    pub(crate) fn of(n: usize, mass_matrix: &[f64], jacobian: &[f64]) -> Self {
        let rows = bordered(n, |i, j| mass_matrix[i * n + j], jacobian, 0.0);
        let size = rows.len();
        let matrix = DMatrix::from_fn(size, size, |i, j| rows[i][j]);
        let units = scales(&matrix);
        if matrix.iter().any(|x| !x.is_finite()) {
            return Conditioned { units, condition: f64::INFINITY, is_redundant: false };
        }
        let scaled = DMatrix::from_fn(size, size, |i, j| matrix[(i, j)] * units[i] * units[j]);
        let rank = |singular: &[f64]| {
            let largest = singular.iter().copied().fold(0.0, f64::max);
            singular.iter().filter(|&&s| s > NOTHING * largest).count()
        };
        let of_rows = scaled.view((n, 0), (size - n, n)).clone_owned().svd(false, false);
        let missing = size - n - rank(of_rows.singular_values.as_slice());
        let mut singular = scaled.svd(false, false).singular_values.as_slice().to_vec();
        singular.sort_by(|a, b| b.total_cmp(a));
        let least = singular[size - 1 - missing];
        let condition = if least > NOTHING * singular[0] { singular[0] / least } else { f64::INFINITY };
        Conditioned { units, condition, is_redundant: missing > 0 }
    }
}

/// q̈ and λ of a column of f and c; NaN where a motion has no inertia, or rows contradict each other. Where rows depend
/// on others, λ is one of many.
pub(crate) struct Bordered {
    n: usize,
    scales: Vec<f64>,
    /// L and U, rows and columns in the order of the pivots.
    factors: Vec<Vec<Exact>>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    rank: usize,
    is_determined: bool,
}

impl Bordered {
    /// Of the lower triangle of M and of A, row by row.
    pub(crate) fn new(n: usize, mass: &[Exact], jacobian: &[Exact]) -> Self {
        let m = |i: usize, j: usize| mass[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        let mut factors = bordered(n, m, jacobian, Exact::constant(0.0));
        let size = factors.len();
        let scales = scales(&DMatrix::from_fn(size, size, |i, j| factors[i][j].to_f64()));
        for (i, row) in factors.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = entry.mul(Exact::constant(scales[i] * scales[j]));
            }
        }
        let order = || (0..size).collect();
        let mut system = Bordered { n, scales, factors, rows: order(), columns: order(), rank: 0, is_determined: true };
        system.eliminate();
        // A free column must be that of a multiplier, and move nothing but multipliers.
        let size = system.rows.len();
        for free in system.rank..size {
            let mut along = vec![Exact::constant(0.0); size];
            for p in 0..system.rank {
                along[p] = system.factors[p][free].neg();
            }
            system.substitute_back(&mut along);
            let moves = |p: usize| system.columns[p] < n && along[p].to_f64().abs() > AGREEMENT;
            system.is_determined &= system.columns[free] >= n && !(0..system.rank).any(moves);
        }
        system
    }

    fn eliminate(&mut self) {
        let size = self.rows.len();
        while self.rank < size {
            let p = self.rank;
            let magnitude = |&(i, j): &(usize, usize)| self.factors[i][j].to_f64().abs();
            let entries = (p..size).flat_map(|i| (p..size).map(move |j| (i, j)));
            let Some(best) = entries.max_by(|a, b| magnitude(a).total_cmp(&magnitude(b))) else { return };
            // NaN is an entry like others, and spreads.
            if magnitude(&best) < NO_PIVOT {
                return;
            }
            self.factors.swap(p, best.0);
            self.rows.swap(p, best.0);
            self.factors.iter_mut().for_each(|row| row.swap(p, best.1));
            self.columns.swap(p, best.1);
            let pivots = self.factors[p].clone();
            for row in &mut self.factors[p + 1..] {
                if row[p].to_f64() == 0.0 {
                    continue;
                }
                row[p] = row[p].div(pivots[p]);
                for j in p + 1..size {
                    row[j] = row[j].sub(row[p].mul(pivots[j]));
                }
            }
            self.rank += 1;
        }
    }

    fn substitute_back(&self, x: &mut [Exact]) {
        for p in (0..self.rank).rev() {
            let rest = (p + 1..self.rank).fold(x[p], |rest, j| rest.sub(self.factors[p][j].mul(x[j])));
            x[p] = rest.div(self.factors[p][p]);
        }
    }

    /// q̈, then λ.
    pub(crate) fn solve(&self, column: &[Exact]) -> Vec<Exact> {
        let size = self.rows.len();
        let scaled = |i: usize| column[i].mul(Exact::constant(self.scales[i]));
        let mut x: Vec<Exact> = self.rows.iter().map(|&i| scaled(i)).collect();
        let largest = x.iter().map(|x| x.to_f64().abs()).fold(0.0, f64::max);
        for p in 0..size {
            x[p] = (0..p.min(self.rank)).fold(x[p], |rest, j| rest.sub(self.factors[p][j].mul(x[j])));
        }
        let agrees = x[self.rank..].iter().all(|rest| rest.to_f64().abs() <= AGREEMENT * largest);
        if !agrees || !self.is_determined {
            return vec![Exact::constant(f64::NAN); size];
        }
        self.substitute_back(&mut x);
        x[self.rank..].fill(Exact::constant(0.0));
        let mut ordered = x.clone();
        for (&column, &x) in self.columns.iter().zip(&x) {
            let x = x.mul(Exact::constant(self.scales[column]));
            ordered[column] = if column < self.n { x } else { x.neg() };
        }
        ordered
    }
}

/// What systems are set up over.
pub(crate) trait Entry: Value {
    /// Over 200 bits.
    fn lifted(self) -> Exact;
    /// Rounded, if need be.
    fn lowered(x: Exact) -> Self;
}

impl Entry for f64 {
    fn lifted(self) -> Exact {
        Exact::constant(self)
    }
    fn lowered(x: Exact) -> Self {
        x.to_f64()
    }
}

impl Entry for Exact {
    fn lifted(self) -> Exact {
        self
    }
    fn lowered(x: Exact) -> Self {
        x
    }
}

/// What a function's system comes to that is set up over doubles, or over 200 bits, and solved over 200 bits: what it
/// has lost was lost before it was solved.
pub(crate) fn solved<V: Entry>(mechanism: &Interpreter<'_, V>, function: &Function, state: &State<V>) -> Vec<V> {
    let derivation = mechanism.derivation();
    let n = derivation.dof();
    let of_motion = |symbol| matches!(symbol, Symbol::Acceleration(_) | Symbol::Multiplier(_));
    let (mut state, mut multipliers) = (state.clone(), Vec::new());
    if function.program.uses(of_motion) {
        let forward = derivation.function(FunctionKind::ForwardDynamics).expect("generated for every mechanism");
        let [motion] = &solutions(mechanism, forward, &state, &[])[..] else { unreachable!("one right side") };
        (state.qdd, multipliers) = (motion[..n].to_vec(), motion[n..].to_vec());
    }
    let columns = solutions(mechanism, function, &state, &multipliers);
    if function.kind == FunctionKind::Multipliers {
        return columns[0][n..].to_vec();
    }
    let mut columns = columns.into_iter();
    let part = |width: usize| {
        let part: Vec<Vec<V>> = columns.by_ref().take(width).collect();
        (0..n).flat_map(|i| part.iter().map(|column| column[i]).collect::<Vec<V>>()).collect::<Vec<V>>()
    };
    widths(function).into_iter().flat_map(part).collect()
}

fn widths(function: &Function) -> Vec<usize> {
    let width = |shape| if let Shape::Matrix(_, columns) = shape { columns } else { 1 };
    function.results.iter().map(|part| width(part.shape)).collect()
}

/// q̈ and λ for each right side.
fn solutions<V: Entry>(
    mechanism: &Interpreter<'_, V>,
    function: &Function,
    state: &State<V>,
    multipliers: &[V],
) -> Vec<Vec<V>> {
    let derivation = mechanism.derivation();
    let (n, k) = (derivation.dof(), derivation.constraints.len());
    let system = Function { completion: Completion::None, ..function.clone() };
    let values = mechanism.evaluate_with(&system, state, multipliers);
    let lifted: Vec<Exact> = values.into_iter().map(V::lifted).collect();
    let (matrices, mut right_sides) = lifted.split_at(derivation.matrix_entries());
    let (mass, jacobian) = match &derivation.elimination {
        Some(elimination) => elimination.in_full(matrices),
        None => {
            let (mass, jacobian) = matrices.split_at(n * (n + 1) / 2);
            (mass.to_vec(), jacobian.to_vec())
        }
    };
    let solver = Bordered::new(n, &mass, &jacobian);
    let mut solutions = Vec::new();
    for width in widths(function) {
        let (part, behind) = right_sides.split_at((n + k) * width);
        for column in 0..width {
            let column: Vec<Exact> = part.iter().skip(column).step_by(width).copied().collect();
            solutions.push(solver.solve(&column).into_iter().map(V::lowered).collect());
        }
        right_sides = behind;
    }
    solutions
}
