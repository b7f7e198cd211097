//! The quadratic program of a problem that is linearized about a plan, and its solution by [`clarabel`].
//!
//! Unknown are the corrections Δx₀ … Δx_N, Δu₀ … Δu_{N−1}, ΔT, and for each condition a σ ≥ 0, by which it may be
//! broken, at the price ρ σ. So every program has a solution, and where the problem has one, σ is zero if ρ is greater
//! than the multipliers (an exact penalty).
//!
//! ```text
//! A_k Δx_k + B_k Δu_k + F_T/N ΔT − Δx_{k+1} = x_{k+1} − F_k,   g_k + ∂g/∂x Δx_k + ∂g/∂t k/N ΔT + σ ≥ 0
//! ```
//!
//! # Source
//! R. Fletcher, *Practical methods of optimization*, 2nd edition, 1987, section 14.4 (Sℓ₁QP); P. J. Goulart and Y.
//! Chen, *Clarabel: an interior-point solver for conic programs with quadratic objectives*, 2024.

use std::vec::Vec;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT, ZeroConeT,
};
use mbs_models::{Error, Failure};
use nalgebra::{SMatrix, SVector};

use super::problem::{Condition, Cost, FreeEnd, OptimalControl, Plan, Step};
use super::sequential::Worst;

/// A problem about a plan.
pub(super) struct Linearized<const X: usize, const U: usize> {
    plan: Plan<X, U>,
    initial: SVector<f64, X>,
    bounds: Vec<[SVector<f64, U>; 2]>,
    free_end: Option<FreeEnd>,
    steps: Vec<Step<X, U>>,
    costs: Vec<Cost<X, U>>,
    /// Of the nodes after the first.
    conditions: Vec<Vec<Condition<X>>>,
}

/// What a program says, with multipliers of its rows.
pub(super) struct Correction<const X: usize, const U: usize> {
    pub(super) states: Vec<SVector<f64, X>>,
    pub(super) inputs: Vec<SVector<f64, U>>,
    pub(super) duration: f64,
    /// σ, in the order of the conditions.
    pub(super) relaxed: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
    pub(super) iterations: u32,
}

/// How far a plan is from what Karush, Kuhn and Tucker ask of an optimum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// The greatest component of the gradient of Lagrange's function.
    pub stationarity: f64,
    /// The greatest jump of the motion at a node, in the unit of the state.
    pub continuity: f64,
    /// The greatest product of a multiplier and the room that its condition has left.
    pub complementarity: f64,
}

impl Residual {
    /// Of a plan that nothing is known of.
    pub(super) const UNKNOWN: Self =
        Residual { stationarity: f64::INFINITY, continuity: f64::INFINITY, complementarity: f64::INFINITY };

    /// The greatest of them.
    #[must_use]
    pub fn greatest(&self) -> f64 {
        self.stationarity.max(self.continuity).max(self.complementarity)
    }
}

impl<const X: usize, const U: usize> Linearized<X, U> {
    pub(super) fn about(problem: &impl OptimalControl<X, U>, plan: &Plan<X, U>) -> Result<Self, Error> {
        let intervals = problem.intervals();
        let length = plan.duration / intervals as f64;
        let mut conditions = Vec::with_capacity(intervals);
        let steps: Vec<_> = (0..intervals).map(|k| problem.step(&plan.states[k], &plan.inputs[k], length)).collect();
        for node in 1..=intervals {
            let time = plan.time(node);
            let mut rows = Vec::new();
            problem.conditions(node, time, &plan.states[node], &mut rows);
            let finite = |v: &SVector<f64, X>| v.iter().all(|x| x.is_finite());
            let step = &steps[node - 1];
            let good = rows.iter().all(|row| row.value.is_finite() && finite(&row.by_state) && row.by_time.is_finite())
                && finite(&step.end)
                && step.by_state.iter().chain(step.by_input.iter()).all(|x| x.is_finite());
            if !good {
                return Err(Failure::NotFinite("the plan").at_time(time));
            }
            conditions.push(rows);
        }
        Ok(Linearized {
            plan: plan.clone(),
            initial: problem.initial_state(),
            bounds: (0..intervals).map(|node| problem.bounds(node)).collect(),
            free_end: problem.free_end(),
            costs: (0..=intervals).map(|node| problem.cost(node, plan.time(node))).collect(),
            steps,
            conditions,
        })
    }

    /// What the plan costs, with a price on every jump and every condition that is broken.
    pub(super) fn merit(&self, jump: f64, broken: f64) -> f64 {
        let last = self.steps.len();
        let mut merit = self.free_end.map_or(0.0, |end| end.weight * self.plan.duration);
        for (node, cost) in self.costs.iter().enumerate() {
            let off = self.plan.states[node] - cost.target;
            merit += 0.5 * off.dot(&(cost.state * off));
            if node < last {
                let off = self.plan.inputs[node] - cost.input_target;
                merit += 0.5 * off.dot(&(cost.input * off));
                merit += jump * (self.steps[node].end - self.plan.states[node + 1]).lp_norm(1);
            }
        }
        let excess: f64 = self.conditions.iter().flatten().map(|row| (-row.value).max(0.0)).sum();
        merit + jump * (self.initial - self.plan.states[0]).lp_norm(1) + broken * excess
    }

    /// The condition that is broken most.
    pub(super) fn worst(&self) -> Option<Worst> {
        let all = self.conditions.iter().enumerate().flat_map(|(i, rows)| rows.iter().map(move |row| (i + 1, row)));
        let excess = all.map(|(node, row)| Worst { condition: row.name, node, excess: 0.0 - row.value });
        excess.max_by(|a, b| a.excess.total_cmp(&b.excess))
    }

    fn input_column(&self, node: usize) -> usize {
        (self.steps.len() + 1) * X + node * U
    }

    fn duration_column(&self) -> usize {
        self.input_column(self.steps.len())
    }

    fn first_relaxation(&self) -> usize {
        self.duration_column() + usize::from(self.free_end.is_some())
    }

    fn columns(&self) -> usize {
        self.first_relaxation() + self.conditions.iter().map(Vec::len).sum::<usize>()
    }

    fn equations(&self) -> usize {
        (self.steps.len() + 1) * X
    }

    /// P and q of `½ vᵀ P v + qᵀ v`, P above its diagonal; corrections cost a little more by a damping.
    fn objective(&self, damping: f64, broken: f64, p: &mut Entries, q: &mut Vec<f64>) {
        q.clear();
        q.resize(self.columns(), 0.0);
        for (node, cost) in self.costs.iter().enumerate() {
            let slope = cost.state * (self.plan.states[node] - cost.target);
            q[node * X..][..X].copy_from_slice(slope.as_slice());
            p.put_block(node * X, &cost.state, damping);
            if node < self.steps.len() {
                let first = self.input_column(node);
                let slope = cost.input * (self.plan.inputs[node] - cost.input_target);
                q[first..][..U].copy_from_slice(slope.as_slice());
                p.put_block(first, &cost.input, damping);
            }
        }
        if let Some(end) = self.free_end {
            q[self.duration_column()] = end.weight;
            p.put(self.duration_column(), self.duration_column(), damping);
        }
        q[self.first_relaxation()..].fill(broken);
    }

    /// A and b of `A v + s = b`, with s = 0 in the equations and s ≥ 0 after them.
    fn rows(&self, a: &mut Entries, b: &mut Vec<f64>) {
        let intervals = self.steps.len();
        b.clear();
        for i in 0..X {
            a.put(i, i, 1.0);
            b.push(self.initial[i] - self.plan.states[0][i]);
        }
        for (node, step) in self.steps.iter().enumerate() {
            let jump = self.plan.states[node + 1] - step.end;
            for i in 0..X {
                let row = b.len();
                (0..X).for_each(|j| a.put(row, node * X + j, step.by_state[(i, j)]));
                (0..U).for_each(|j| a.put(row, self.input_column(node) + j, step.by_input[(i, j)]));
                a.put(row, (node + 1) * X + i, -1.0);
                if self.free_end.is_some() {
                    a.put(row, self.duration_column(), step.by_length[i] / intervals as f64);
                }
                b.push(jump[i]);
            }
        }
        for (node, input) in self.plan.inputs.iter().enumerate() {
            let [least, greatest] = &self.bounds[node];
            for i in 0..U {
                a.put(b.len(), self.input_column(node) + i, -1.0);
                b.push(input[i] - least[i]);
                a.put(b.len(), self.input_column(node) + i, 1.0);
                b.push(greatest[i] - input[i]);
            }
        }
        if let Some(end) = self.free_end {
            a.put(b.len(), self.duration_column(), -1.0);
            b.push(self.plan.duration - end.range[0]);
            a.put(b.len(), self.duration_column(), 1.0);
            b.push(end.range[1] - self.plan.duration);
        }
        let mut relaxation = self.first_relaxation();
        for (i, rows) in self.conditions.iter().enumerate() {
            for row in rows {
                (0..X).for_each(|j| a.put(b.len(), (i + 1) * X + j, -row.by_state[j]));
                if self.free_end.is_some() {
                    let part = (i + 1) as f64 / intervals as f64;
                    a.put(b.len(), self.duration_column(), -row.by_time * part);
                }
                a.put(b.len(), relaxation, -1.0);
                b.push(row.value);
                a.put(b.len(), relaxation, -1.0);
                b.push(0.0);
                relaxation += 1;
            }
        }
    }
}

/// Entries of a matrix that always has the same ones, in the order in which they are put, and by columns.
#[derive(Default)]
struct Entries {
    places: Vec<(usize, usize)>,
    values: Vec<f64>,
    /// The entries by columns.
    order: Vec<usize>,
}

impl Entries {
    fn clear(&mut self) {
        self.places.clear();
        self.values.clear();
    }

    /// Row, column, value.
    fn put(&mut self, row: usize, column: usize, value: f64) {
        self.places.push((column, row));
        self.values.push(value);
    }

    /// What is above the diagonal of a symmetric block on the diagonal, with a number more on that.
    fn put_block<const N: usize>(&mut self, first: usize, block: &SMatrix<f64, N, N>, more: f64) {
        for j in 0..N {
            (0..j).for_each(|i| self.put(first + i, first + j, block[(i, j)]));
            self.put(first + j, first + j, block[(j, j)] + more);
        }
    }

    /// The matrix, with the order of its entries kept for the next one.
    fn matrix(&mut self, rows: usize, columns: usize) -> CscMatrix {
        self.order = (0..self.places.len()).collect();
        self.order.sort_by_key(|&i| self.places[i]);
        let mut starts = std::vec![0; columns + 1];
        self.places.iter().for_each(|&(column, _)| starts[column + 1] += 1);
        (0..columns).for_each(|column| starts[column + 1] += starts[column]);
        let row = self.order.iter().map(|&i| self.places[i].1).collect();
        CscMatrix::new(rows, columns, starts, row, self.by_columns())
    }

    fn by_columns(&self) -> Vec<f64> {
        self.order.iter().map(|&i| self.values[i]).collect()
    }
}

/// Solves programs of one shape, one after the other.
#[derive(Default)]
pub(super) struct Programs {
    p: Entries,
    q: Vec<f64>,
    a: Entries,
    b: Vec<f64>,
    solver: Option<DefaultSolver<f64>>,
}

impl Programs {
    /// Writes down the program of a linearized problem.
    fn write<const X: usize, const U: usize>(&mut self, problem: &Linearized<X, U>, damping: f64, broken: f64) {
        self.p.clear();
        self.a.clear();
        problem.objective(damping, broken, &mut self.p, &mut self.q);
        problem.rows(&mut self.a, &mut self.b);
    }

    /// How optimal the plan is, by the multipliers and relaxations of the program before.
    pub(super) fn residual<const X: usize, const U: usize>(
        &mut self,
        problem: &Linearized<X, U>,
        broken: f64,
        multipliers: &[f64],
        relaxed: &[f64],
    ) -> Residual {
        self.write(problem, 0.0, broken);
        let equations = problem.equations();
        let (mut slope, mut room) = (self.q.clone(), self.b.clone());
        for (&(column, row), &value) in self.a.places.iter().zip(&self.a.values) {
            slope[column] += value * multipliers[row];
            if column >= problem.first_relaxation() {
                room[row] -= value * relaxed[column - problem.first_relaxation()];
            }
        }
        let greatest = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0_f64, |a, b| a.max(b.abs()));
        Residual {
            stationarity: greatest(&mut slope.iter().copied()),
            continuity: greatest(&mut self.b[..equations].iter().copied()),
            complementarity: greatest(&mut (equations..room.len()).map(|row| multipliers[row] * room[row])),
        }
    }

    pub(super) fn solve<const X: usize, const U: usize>(
        &mut self,
        problem: &Linearized<X, U>,
        damping: f64,
        broken: f64,
        accuracy: f64,
    ) -> Result<Correction<X, U>, Error> {
        self.write(problem, damping, broken);
        let (rows, columns, equations) = (self.b.len(), problem.columns(), problem.equations());
        let alike = self.solver.as_ref().is_some_and(|solver| {
            (solver.data.m, solver.data.n) == (rows, columns) && solver.data.A.nnz() == self.a.values.len()
        });
        let updated = alike
            && self.solver.as_mut().is_some_and(|solver| {
                solver.update_data(&self.p.by_columns(), &self.q, &self.a.by_columns(), &self.b).is_ok()
            });
        if !updated {
            let (p, a) = (self.p.matrix(columns, columns), self.a.matrix(rows, columns));
            let cones: [SupportedConeT<f64>; 2] = [ZeroConeT(equations), NonnegativeConeT(rows - equations)];
            let solver = DefaultSolver::new(&p, &self.q, &a, &self.b, &cones, settings(accuracy));
            self.solver = Some(solver.map_err(|_| unsolved(0, f64::NAN))?);
        }
        let solver = self.solver.as_mut().expect("made above");
        solver.solve();
        let solution = &solver.solution;
        if !matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            let (iterations, residual) = (solution.iterations, solution.r_prim.max(solution.r_dual));
            self.solver = None;
            return Err(unsolved(iterations, residual));
        }
        let nodes = problem.steps.len();
        let v = &solution.x;
        Ok(Correction {
            states: (0..=nodes).map(|node| SVector::from_column_slice(&v[node * X..][..X])).collect(),
            inputs: (0..nodes).map(|node| SVector::from_column_slice(&v[problem.input_column(node)..][..U])).collect(),
            duration: problem.free_end.map_or(0.0, |_| v[problem.duration_column()]),
            relaxed: v[problem.first_relaxation()..].to_vec(),
            multipliers: solution.z.clone(),
            iterations: solution.iterations,
        })
    }
}

/// A quadratic program that was not solved: the greater one of the residuals of its equations and of its stationarity.
fn unsolved(iterations: u32, residual: f64) -> Error {
    let (what, iterations, unit) = ("a quadratic program", iterations as usize, "in scaled variables");
    Failure::NotConverged { what, iterations, residual, unit }.into()
}

/// The shape of a program is kept, its numbers change: nothing that looks at these alone.
fn settings(accuracy: f64) -> DefaultSettings<f64> {
    DefaultSettings {
        verbose: false,
        max_iter: 100,
        tol_gap_abs: accuracy,
        tol_gap_rel: accuracy,
        tol_feas: accuracy,
        presolve_enable: false,
        input_sparse_dropzeros: false,
        ..DefaultSettings::default()
    }
}
