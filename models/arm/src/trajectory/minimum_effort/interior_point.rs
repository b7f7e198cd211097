//! Newton's method with a barrier before the bounds.

use std::vec::Vec;

use mbs_runtime::{Dual, Mechanism};

use super::banded::{Banded, Factorized};
use super::transcription::{Slopes, Transcription};

/// Bounds of variables; equal where the variable is given. Infinite at the places of multipliers.
pub(super) struct Bounds {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

/// Variables and multipliers of defects, and the multipliers of their bounds, which are not negative.
#[derive(Clone, Debug)]
pub(super) struct Iterate {
    pub(super) z: Vec<f64>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
}

/// How far the conditions of Karush, Kuhn and Tucker are from being satisfied, in the scaled variables.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The largest derivative of the Lagrangian by a variable.
    pub stationarity: f64,
    /// The largest defect.
    pub defect: f64,
    /// The largest product of a bound's multiplier and the distance from it.
    pub complementarity: f64,
}

impl Residual {
    /// The largest of them.
    #[must_use]
    pub fn largest(self) -> f64 {
        self.stationarity.max(self.defect).max(self.complementarity)
    }
}

/// Iterations after which there is no hope.
const ITERATIONS: usize = 300;
/// The residual below which the conditions count as satisfied.
pub(super) const TOLERANCE: f64 = 1e-9;
/// Part of the way to a bound that a step may take, at least.
const FRACTION: f64 = 0.99;
/// Within this part of the barrier's parameter its problem counts as solved.
const SOLVED: f64 = 10.0;
/// Part of the expected decrease that is asked for.
const ARMIJO: f64 = 1e-4;
/// Least curvature along a step, per square of its length.
const CURVATURE: f64 = 1e-10;

/// One barrier after the other is minimized by Newton's method on the primal–dual conditions, with exact second
/// derivatives; where the Lagrangian is not convex along the step, the Hessian is shifted. Steps are shortened until
/// the ℓ₁ merit function decreases enough, with a correction of second order.
///
/// # Errors
/// The last residual, with the number of iterations.
///
/// # Source
/// A. Wächter, L. T. Biegler, *On the implementation of an interior-point filter line-search algorithm for large-scale
/// nonlinear programming*, Mathematical Programming 106, 2006, sections 2.1–2.4 and 3.1; merit function: J. Nocedal,
/// S. J. Wright, *Numerical Optimization*, 2nd ed. 2006, section 18.3; curvature instead of inertia: N.-Y. Chiang, V.
/// M. Zavala, *An inertia-free filter line-search algorithm for large-scale nonlinear programming*, 2016, section 3.
pub(super) fn solve<M, const N: usize, const U: usize>(
    problem: &Transcription<'_, M, N, U>,
    bounds: &Bounds,
    start: Iterate,
    barrier: f64,
) -> Result<(Iterate, Residual, usize), (Residual, usize)>
where
    M: Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
{
    let mut search = Search { problem, bounds, penalty: 0.0, shift: 0.0 };
    let (mut at, mut barrier) = (start, barrier);
    let mut residual = Residual { stationarity: f64::INFINITY, defect: f64::INFINITY, complementarity: f64::INFINITY };
    for iteration in 0..ITERATIONS {
        let local = Local::new(problem, &at);
        residual = search.residual(&at, &local, 0.0);
        if residual.largest() <= TOLERANCE {
            return Ok((at, residual, iteration));
        }
        while barrier > TOLERANCE / SOLVED && search.residual(&at, &local, barrier).largest() <= SOLVED * barrier {
            barrier = (TOLERANCE / SOLVED).max((0.2 * barrier).min(barrier.powf(1.5)));
            search.penalty = 0.0;
        }
        let Some(next) = search.step(&at, &local, barrier) else { return Err((residual, iteration)) };
        at = next;
    }
    Err((residual, ITERATIONS))
}

/// What is known of the problem at one iterate.
struct Local<const N: usize, const U: usize> {
    slopes: Vec<Slopes<N, U>>,
    defects: Vec<f64>,
    /// The gradient of the objective.
    gradient: Vec<f64>,
}

impl<const N: usize, const U: usize> Local<N, U> {
    fn new<M>(problem: &Transcription<'_, M, N, U>, at: &Iterate) -> Self
    where
        M: Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
    {
        let layout = problem.layout;
        let mut gradient = std::vec![0.0; at.z.len()];
        for j in 0..=layout.last() {
            for i in layout.point(j) + 2 * N..layout.row(j) {
                gradient[i] = 2.0 * problem.weight(j) * at.z[i];
            }
        }
        let slopes = (0..=layout.last()).map(|j| problem.slopes(&at.z, j)).collect();
        Self { slopes, defects: problem.defects(&at.z), gradient }
    }
}

/// A solution of the Newton system: steps of variables and new multipliers of defects.
struct Newton {
    factors: Factorized,
    solution: Vec<f64>,
    /// `dᵀ H d` of the step d.
    bend: f64,
}

struct Search<'a, M, const N: usize, const U: usize> {
    problem: &'a Transcription<'a, M, N, U>,
    bounds: &'a Bounds,
    /// Of the defects in the merit function; it never decreases while the barrier stays.
    penalty: f64,
    /// The last shift of the Hessian that was needed.
    shift: f64,
}

impl<M, const N: usize, const U: usize> Search<'_, M, N, U>
where
    M: Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
{
    fn is_free(&self, i: usize) -> bool {
        self.problem.layout.is_variable(i) && self.bounds.lower[i] < self.bounds.upper[i]
    }

    /// With the products of bounds and multipliers compared with the barrier's parameter.
    fn residual(&self, at: &Iterate, local: &Local<N, U>, barrier: f64) -> Residual {
        let mut derivative: Vec<f64> = (0..at.z.len()).map(|i| local.gradient[i] - at.lower[i] + at.upper[i]).collect();
        self.problem.jacobian(&local.slopes, |row, column, value| derivative[column] += value * at.z[row]);
        let mut residual = Residual { stationarity: 0.0, defect: norm(&local.defects), complementarity: 0.0 };
        for i in (0..at.z.len()).filter(|&i| self.is_free(i)) {
            residual.stationarity = largest(residual.stationarity, derivative[i].abs());
            let gaps = [(at.z[i] - self.bounds.lower[i], at.lower[i]), (self.bounds.upper[i] - at.z[i], at.upper[i])];
            for (gap, multiplier) in gaps.into_iter().filter(|(gap, _)| gap.is_finite()) {
                residual.complementarity = largest(residual.complementarity, (gap * multiplier - barrier).abs());
            }
        }
        residual
    }

    /// The barrier function: `φ − μ Σ ln(distance from bounds)`; infinite beyond a bound.
    fn barrier_function(&self, z: &[f64], barrier: f64) -> f64 {
        let logarithm = |i: usize| {
            let gaps = [z[i] - self.bounds.lower[i], self.bounds.upper[i] - z[i]];
            gaps.into_iter().filter(|gap| *gap != f64::INFINITY).map(f64::ln).sum::<f64>()
        };
        let logarithms: f64 = (0..z.len()).filter(|&i| self.is_free(i)).map(logarithm).sum();
        self.problem.objective(z) - barrier * logarithms
    }

    fn step(&mut self, at: &Iterate, local: &Local<N, U>, barrier: f64) -> Option<Iterate> {
        let n = at.z.len();
        let (lower, upper) = (&self.bounds.lower, &self.bounds.upper);
        // The gradient of the barrier function and the Hessian of the barrier.
        let (mut gradient, mut stiffness) = (local.gradient.clone(), std::vec![0.0; n]);
        for i in (0..n).filter(|&i| self.is_free(i)) {
            gradient[i] += barrier * (1.0 / (upper[i] - at.z[i]) - 1.0 / (at.z[i] - lower[i]));
            stiffness[i] = at.lower[i] / (at.z[i] - lower[i]) + at.upper[i] / (upper[i] - at.z[i]);
        }
        let curvature: Vec<Vec<f64>> =
            (0..=self.problem.layout.last()).map(|j| self.problem.curvature(&at.z, j)).collect();
        let newton = self.newton(local, &gradient, &stiffness, &curvature)?;

        // Directions of variables alone; the multipliers follow from them.
        let direction = self.variables(&newton.solution);
        let slope: f64 = gradient.iter().zip(&direction).map(|(g, d)| g * d).sum();
        let violation: f64 = local.defects.iter().map(|c| c.abs()).sum();
        if violation > 0.0 {
            let needed = (slope + 0.5 * newton.bend.max(0.0)) / (0.9 * violation);
            if self.penalty < needed {
                self.penalty = 1.5 * needed;
            }
        }
        let keep = FRACTION.max(1.0 - barrier);
        let longest = self.longest(&at.z, &direction, keep);
        let merit = |search: &Self, z: &[f64], defects: &[f64]| {
            search.barrier_function(z, barrier) + search.penalty * defects.iter().map(|c| c.abs()).sum::<f64>()
        };
        let before = merit(self, &at.z, &local.defects);
        let decrease = slope - self.penalty * violation;
        let accepts =
            |found: f64, length: f64| found <= before + ARMIJO * length * decrease + 1e-14 * before.abs().max(1.0);
        let mut length = longest;
        let mut moved = along(&at.z, &direction, length);
        let mut defects = self.problem.defects(&moved);
        if !accepts(merit(self, &moved, &defects), length) {
            // Once: the same step with the defects that it leaves taken back.
            let mut right: Vec<f64> = (0..n).map(|i| if self.is_free(i) { -gradient[i] } else { 0.0 }).collect();
            for i in 0..n {
                right[i] -= length * local.defects[i] + defects[i];
            }
            newton.factors.solve(&mut right);
            let corrected = self.variables(&right);
            let reach = self.longest(&at.z, &corrected, keep);
            let z = along(&at.z, &corrected, reach);
            let left = self.problem.defects(&z);
            if accepts(merit(self, &z, &left), length) {
                moved = z;
            } else {
                loop {
                    length *= 0.5;
                    if length < 1e-12 {
                        return None;
                    }
                    moved = along(&at.z, &direction, length);
                    defects = self.problem.defects(&moved);
                    if accepts(merit(self, &moved, &defects), length) {
                        break;
                    }
                }
            }
        }
        Some(self.updated(at, moved, &newton.solution, &direction, length, barrier, keep))
    }

    /// The solution of the Newton system, its factors, and the curvature along it; the Hessian is shifted until that is
    /// positive.
    fn newton(
        &mut self,
        local: &Local<N, U>,
        gradient: &[f64],
        stiffness: &[f64],
        curvature: &[Vec<f64>],
    ) -> Option<Newton> {
        let layout = self.problem.layout;
        let (n, size) = (layout.len(), layout.size());
        let mut shift = 0.0;
        loop {
            let mut matrix = Banded::zero(n, layout.bandwidth());
            for (j, block) in curvature.iter().enumerate() {
                let first = layout.point(j);
                for i in 0..size {
                    for k in (0..size).filter(|&k| self.is_free(first + i) && self.is_free(first + k)) {
                        matrix.add(first + i, first + k, 0.5 * (block[i * size + k] + block[k * size + i]));
                    }
                }
            }
            for i in (0..n).filter(|&i| layout.is_variable(i)) {
                matrix.add(i, i, if self.is_free(i) { stiffness[i] + shift } else { 1.0 });
            }
            self.problem.jacobian(&local.slopes, |row, column, value| {
                if self.is_free(column) {
                    matrix.add(row, column, value);
                    matrix.add(column, row, value);
                }
            });
            let right = |i: usize| if self.is_free(i) { -gradient[i] } else { -local.defects[i] };
            let mut solution: Vec<f64> = (0..n).map(right).collect();
            if let Some(factors) = matrix.factorized() {
                factors.solve(&mut solution);
                let (bend, square) = self.bend(&solution, stiffness, curvature, shift);
                if bend >= CURVATURE * square {
                    self.shift = shift;
                    return Some(Newton { factors, solution, bend });
                }
            }
            shift = if shift == 0.0 { (self.shift / 3.0).max(1e-6) } else { 8.0 * shift };
            let hopeless = shift > 1e20 || shift.is_nan();
            if hopeless {
                return None;
            }
        }
    }

    /// `dᵀ H d` and `dᵀ d` of the variables' part of a step.
    fn bend(&self, solution: &[f64], stiffness: &[f64], curvature: &[Vec<f64>], shift: f64) -> (f64, f64) {
        let layout = self.problem.layout;
        let size = layout.size();
        let (mut bend, mut square) = (0.0, 0.0);
        for (j, block) in curvature.iter().enumerate() {
            let first = layout.point(j);
            for i in (0..size).filter(|&i| self.is_free(first + i)) {
                let d = solution[first + i];
                let row = &block[i * size..][..size];
                bend += d * ((stiffness[first + i] + shift) * d);
                bend += d
                    * (0..size).filter(|&k| self.is_free(first + k)).map(|k| row[k] * solution[first + k]).sum::<f64>();
                square += d * d;
            }
        }
        (bend, square)
    }

    /// With zeros for everything but free variables.
    fn variables(&self, solution: &[f64]) -> Vec<f64> {
        (0..solution.len()).map(|i| if self.is_free(i) { solution[i] } else { 0.0 }).collect()
    }

    /// The part of a step, at most 1, that leaves this part of the distance from each bound.
    fn longest(&self, z: &[f64], direction: &[f64], keep: f64) -> f64 {
        let mut length: f64 = 1.0;
        for i in (0..z.len()).filter(|&i| self.is_free(i)) {
            let d = direction[i];
            let gap = if d < 0.0 { self.bounds.lower[i] - z[i] } else { self.bounds.upper[i] - z[i] };
            if d != 0.0 && gap.is_finite() {
                length = length.min(keep * gap / d);
            }
        }
        length
    }

    /// The next iterate: variables where they went, multipliers of defects along the same part of the step, those of
    /// bounds as far as they stay positive, and near to what the barrier asks for.
    fn updated(
        &self,
        at: &Iterate,
        z: Vec<f64>,
        newton: &[f64],
        direction: &[f64],
        length: f64,
        barrier: f64,
        keep: f64,
    ) -> Iterate {
        let (lower, upper) = (&self.bounds.lower, &self.bounds.upper);
        let free: Vec<usize> = (0..z.len()).filter(|&i| self.is_free(i)).collect();
        let change = |i: usize| {
            let (below, above) = (at.z[i] - lower[i], upper[i] - at.z[i]);
            [
                (barrier - at.lower[i] * direction[i]) / below - at.lower[i],
                (barrier + at.upper[i] * direction[i]) / above - at.upper[i],
            ]
        };
        let mut reach: f64 = 1.0;
        for &i in &free {
            for (multiplier, change) in [at.lower[i], at.upper[i]].into_iter().zip(change(i)) {
                if change < 0.0 && multiplier > 0.0 {
                    reach = reach.min(-keep * multiplier / change);
                }
            }
        }
        let mut next = Iterate { z, ..at.clone() };
        for i in (0..newton.len()).filter(|&i| !self.problem.layout.is_variable(i)) {
            next.z[i] = at.z[i] + length * (newton[i] - at.z[i]);
        }
        let near = |multiplier: f64, gap: f64| {
            if gap.is_finite() { multiplier.clamp(barrier / (1e10 * gap), 1e10 * barrier / gap) } else { 0.0 }
        };
        for i in free {
            let [below, above] = change(i);
            next.lower[i] = near(at.lower[i] + reach * below, next.z[i] - lower[i]);
            next.upper[i] = near(at.upper[i] + reach * above, upper[i] - next.z[i]);
        }
        next
    }
}

fn along(z: &[f64], direction: &[f64], length: f64) -> Vec<f64> {
    z.iter().zip(direction).map(|(z, d)| z + length * d).collect()
}

/// The larger one; NaN if one is NaN.
fn largest(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |norm, value| largest(norm, value.abs()))
}
