//! The motion as a finite problem: minimize a sum over points such that the defects of all intervals vanish.

use std::vec::Vec;

use mbs_runtime::{Dual, Linearization, Mechanism};

/// Where variables and multipliers stand in one vector: point, multipliers of its defects, next point, …
///
/// Points are the ends and the middles of intervals, `2 K + 1` of them, `(q, w, u)` each. Behind the point that begins
/// an interval stand the multipliers of its Hermite defects, behind the one in its middle those of Simpson's.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) coordinates: usize,
    pub(super) inputs: usize,
    pub(super) intervals: usize,
}

impl Layout {
    /// How many numbers a point has.
    pub(super) fn size(self) -> usize {
        2 * self.coordinates + self.inputs
    }

    fn stride(self) -> usize {
        4 * self.coordinates + self.inputs
    }

    /// Points are counted from 0 to here.
    pub(super) fn last(self) -> usize {
        2 * self.intervals
    }

    pub(super) fn point(self, j: usize) -> usize {
        j * self.stride()
    }

    /// Of the multipliers behind a point.
    pub(super) fn row(self, j: usize) -> usize {
        self.point(j) + self.size()
    }

    pub(super) fn len(self) -> usize {
        self.point(self.last()) + self.size()
    }

    /// How far from the diagonal the matrix of the optimality conditions reaches: over one interval.
    pub(super) fn bandwidth(self) -> usize {
        2 * self.stride() - 1
    }

    /// Whether a place of the vector is a variable's, not a multiplier's.
    pub(super) fn is_variable(self, i: usize) -> bool {
        i % self.stride() < self.size()
    }
}

/// The finite problem in scaled variables: time `s = t/T`, velocities `w = T q̇`, inputs `u′ = u/F`.
pub(super) struct Transcription<'a, M, const N: usize, const U: usize> {
    pub(super) mechanism: &'a M,
    pub(super) layout: Layout,
    /// T \[s\]
    pub(super) duration: f64,
    /// F
    pub(super) scale: [f64; U],
}

/// Of the accelerations `dw/ds` at one point, by the scaled variables.
pub(super) type Slopes<const N: usize, const U: usize> = Linearization<f64, N, U>;
/// Time, angles, velocities and inputs in their units.
type State<const N: usize, const U: usize> = (Dual<f64>, [Dual<f64>; N], [Dual<f64>; N], [Dual<f64>; U]);

impl<M, const N: usize, const U: usize> Transcription<'_, M, N, U>
where
    M: Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
{
    /// `dw/ds = T² q̈` at a point.
    pub(super) fn accelerations(&self, z: &[f64], j: usize) -> [f64; N] {
        let (t, q, qd, u) = self.state(z, j, None);
        self.mechanism.forward_dynamics(t, &q, &qd, &u).map(|qdd| self.duration * self.duration * qdd.value)
    }

    /// Its derivatives, from the generated `linearize`.
    pub(super) fn slopes(&self, z: &[f64], j: usize) -> Slopes<N, U> {
        self.linearized(z, j, None, |x| x.value)
    }

    /// The derivatives of these by one of the point's variables: `linearize` in dual numbers.
    fn slope_rates(&self, z: &[f64], j: usize, variable: usize) -> Slopes<N, U> {
        self.linearized(z, j, Some(variable), |x| x.derivative)
    }

    /// As functions of one variable of the point.
    fn state(&self, z: &[f64], j: usize, variable: Option<usize>) -> State<N, U> {
        let point = &z[self.layout.point(j)..][..self.layout.size()];
        let dual = |i: usize, unit: f64| {
            let derivative = if variable == Some(i) { unit } else { 0.0 };
            Dual { value: unit * point[i], derivative }
        };
        (
            Dual::constant(self.duration * j as f64 / self.layout.last() as f64),
            core::array::from_fn(|i| dual(i, 1.0)),
            core::array::from_fn(|i| dual(N + i, 1.0 / self.duration)),
            core::array::from_fn(|i| dual(2 * N + i, self.scale[i])),
        )
    }

    /// By the chain rule: of `T² q̈(q, w/T, F u′)`.
    fn linearized(
        &self,
        z: &[f64],
        j: usize,
        variable: Option<usize>,
        part: impl Fn(Dual<f64>) -> f64,
    ) -> Slopes<N, U> {
        let (time, q, qd, u) = self.state(z, j, variable);
        let slopes = self.mechanism.linearize(time, &q, &qd, &u);
        let t = self.duration;
        Linearization {
            q: slopes.q.map(|row| row.map(|x| t * t * part(x))),
            qd: slopes.qd.map(|row| row.map(|x| t * part(x))),
            u: slopes.u.map(|row| core::array::from_fn(|i| t * t * self.scale[i] * part(row[i]))),
        }
    }

    /// Weight of a point in Simpson's rule over the whole motion.
    pub(super) fn weight(&self, j: usize) -> f64 {
        let ends = if j == 0 || j == self.layout.last() { 1.0 } else { 2.0 };
        let weight = if j % 2 == 1 { 4.0 } else { ends };
        weight / (6.0 * self.layout.intervals as f64)
    }

    /// `∫ Σ u′² ds`
    pub(super) fn objective(&self, z: &[f64]) -> f64 {
        let inputs = |j: usize| &z[self.layout.point(j) + 2 * self.layout.coordinates..][..U];
        (0..=self.layout.last()).map(|j| self.weight(j) * inputs(j).iter().map(|u| u * u).sum::<f64>()).sum()
    }

    /// The defects, each at the place of its multiplier; zeros at the places of variables.
    ///
    /// ```text
    /// x_c − ½ (x_k + x_{k+1}) − h/8 (f_k − f_{k+1}) = 0           Hermite
    /// x_{k+1} − x_k − h/6 (f_k + 4 f_c + f_{k+1}) = 0             Simpson
    /// ```
    ///
    /// with `x = (q, w)`, `f = (w, T² q̈)` and `h = 1/K`.
    ///
    /// # Source
    /// C. R. Hargraves, S. W. Paris, *Direct trajectory optimization using nonlinear programming and collocation*,
    /// Journal of Guidance 10:4, 1987; separated form: M. Kelly, *An introduction to trajectory optimization*, SIAM
    /// Review 59:4, 2017, equations (4.4) and (4.5).
    pub(super) fn defects(&self, z: &[f64]) -> Vec<f64> {
        let layout = self.layout;
        let h = 1.0 / layout.intervals as f64;
        let accelerations: Vec<[f64; N]> = (0..=layout.last()).map(|j| self.accelerations(z, j)).collect();
        let x = |j: usize, i: usize| z[layout.point(j) + i];
        let f = |j: usize, i: usize| if i < N { x(j, N + i) } else { accelerations[j][i - N] };
        let mut defects = std::vec![0.0; layout.len()];
        for begin in (0..layout.last()).step_by(2) {
            let [middle, end] = [begin + 1, begin + 2];
            for i in 0..2 * N {
                defects[layout.row(begin) + i] =
                    x(middle, i) - 0.5 * (x(begin, i) + x(end, i)) - h / 8.0 * (f(begin, i) - f(end, i));
                defects[layout.row(middle) + i] =
                    x(end, i) - x(begin, i) - h / 6.0 * (f(begin, i) + 4.0 * f(middle, i) + f(end, i));
            }
        }
        defects
    }

    /// All entries of the defects' Jacobian that are not zero by structure, as (row, column, value); those of one place
    /// are to be added up.
    pub(super) fn jacobian(&self, slopes: &[Slopes<N, U>], mut entry: impl FnMut(usize, usize, f64)) {
        let layout = self.layout;
        let h = 1.0 / layout.intervals as f64;
        for begin in (0..layout.last()).step_by(2) {
            let [middle, end] = [begin + 1, begin + 2];
            // Factors of x and of f at a point, in the defects behind another.
            let terms = [
                (begin, middle, 1.0, 0.0),
                (begin, begin, -0.5, -h / 8.0),
                (begin, end, -0.5, h / 8.0),
                (middle, begin, -1.0, -h / 6.0),
                (middle, middle, 0.0, -4.0 * h / 6.0),
                (middle, end, 1.0, -h / 6.0),
            ];
            for (behind, at, of_state, of_rate) in terms {
                let (rows, columns) = (layout.row(behind), layout.point(at));
                for i in 0..2 * N {
                    if of_state != 0.0 {
                        entry(rows + i, columns + i, of_state);
                    }
                }
                if of_rate == 0.0 {
                    continue;
                }
                for i in 0..N {
                    entry(rows + i, columns + N + i, of_rate);
                    let row = [&slopes[at].q[i][..], &slopes[at].qd[i], &slopes[at].u[i]].concat();
                    for (column, slope) in row.into_iter().enumerate() {
                        entry(rows + N + i, columns + column, of_rate * slope);
                    }
                }
            }
        }
    }

    /// What the accelerations of a point are multiplied with in the Lagrangian, given all multipliers.
    fn multipliers(&self, z: &[f64], j: usize) -> [f64; N] {
        let layout = self.layout;
        let h = 1.0 / layout.intervals as f64;
        core::array::from_fn(|i| {
            let of = |j: usize| z[layout.row(j) + N + i];
            if j % 2 == 1 {
                return -4.0 * h / 6.0 * of(j);
            }
            let begins = if j < layout.last() { -h / 8.0 * of(j) - h / 6.0 * of(j + 1) } else { 0.0 };
            let ends = if j > 0 { h / 8.0 * of(j - 2) - h / 6.0 * of(j - 1) } else { 0.0 };
            begins + ends
        })
    }

    /// Second derivatives of the Lagrangian by the variables of a point, rows one after the other: exact, and
    /// symmetric but for rounding.
    pub(super) fn curvature(&self, z: &[f64], j: usize) -> Vec<f64> {
        let size = self.layout.size();
        let multipliers = self.multipliers(z, j);
        let mut curvature = std::vec![0.0; size * size];
        for variable in 0..size {
            let rates = self.slope_rates(z, j, variable);
            let row = &mut curvature[variable * size..][..size];
            for (r, multiplier) in multipliers.into_iter().enumerate() {
                let rates = rates.q[r].iter().chain(&rates.qd[r]).chain(&rates.u[r]);
                for (entry, rate) in row.iter_mut().zip(rates) {
                    *entry += multiplier * rate;
                }
            }
        }
        for i in 2 * N..size {
            curvature[i * size + i] += 2.0 * self.weight(j);
        }
        curvature
    }

    /// The costates `p` of `H = Σ u′² + pᵀ f` at a point, those of angles and those of velocities.
    ///
    /// With the multipliers μ of Hermite's and λ of Simpson's defects: `−λ` is the mean of p over the interval, and
    /// `3/2 μ/h` the mean of ṗ, both to the fourth order of h, as an expansion of the derivatives of the Lagrangian by
    /// states and inputs shows. So `p_k = −½ (λ_{k−1} + λ_k) − ¼ (μ_k − μ_{k−1})` where intervals meet; the middle is
    /// what Simpson's rule makes of mean and ends.
    pub(super) fn costates(&self, z: &[f64], j: usize) -> [[f64; N]; 2] {
        let component = |i: usize| {
            if j % 2 == 1 {
                let mean = -z[self.layout.row(j) + i];
                return (6.0 * mean - self.costate(z, j - 1, i) - self.costate(z, j + 1, i)) / 4.0;
            }
            self.costate(z, j, i)
        };
        [core::array::from_fn(component), core::array::from_fn(|i| component(N + i))]
    }

    /// Component i where intervals meet; at both ends of the motion the third power of h is neglected.
    fn costate(&self, z: &[f64], j: usize, i: usize) -> f64 {
        let last = self.layout.last();
        let hermite = |begin: usize| z[self.layout.row(begin) + i];
        let simpson = |begin: usize| z[self.layout.row(begin + 1) + i];
        let bend = |begin: usize| if last > 2 { (hermite(begin + 2) - hermite(begin)) / 8.0 } else { 0.0 };
        match j {
            0 => bend(0) - simpson(0) - 0.75 * hermite(0),
            _ if j == last => bend(last.saturating_sub(4)) - simpson(last - 2) + 0.75 * hermite(last - 2),
            _ => -0.5 * (simpson(j - 2) + simpson(j)) - 0.25 * (hermite(j) - hermite(j - 2)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mbs_models::irb7600::Irb7600;

    const LAYOUT: Layout = Layout { coordinates: 6, inputs: 6, intervals: 2 };

    /// The derivative by each place of a vector, by central differences of two steps, extrapolated.
    fn differences(z: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
        let quotient = |i: usize, step: f64| {
            let [ahead, behind] = [step, -step].map(|step| {
                let mut moved = z.to_vec();
                moved[i] += step;
                f(&moved)
            });
            ahead.iter().zip(behind).map(|(a, b)| (a - b) / (2.0 * step)).collect::<Vec<_>>()
        };
        let extrapolated = |i: usize| {
            let (coarse, fine) = (quotient(i, 2e-3), quotient(i, 1e-3));
            fine.iter().zip(coarse).map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0).collect()
        };
        (0..z.len()).map(extrapolated).collect()
    }

    /// The Jacobian and the Hessian of the Lagrangian, entry by entry, structural zeros included.
    #[test]
    fn sparse_derivatives_are_those_of_the_defects() {
        let arm = Irb7600::<Dual<f64>>::default();
        let scale = [20e3, 25e3, 12e3, 2.5e3, 2.5e3, 1.2e3];
        let problem = Transcription { mechanism: &arm, layout: LAYOUT, duration: 0.8, scale };
        let n = LAYOUT.len();
        let z: Vec<f64> = (0..n).map(|i| 0.6 * (1.7 * i as f64).sin()).collect();
        let slopes_at = |z: &[f64]| (0..=LAYOUT.last()).map(|j| problem.slopes(z, j)).collect::<Vec<_>>();

        let mut jacobian = std::vec![0.0; n * n];
        problem.jacobian(&slopes_at(&z), |row, column, value| jacobian[row * n + column] += value);
        for (column, want) in differences(&z, |z| problem.defects(z)).into_iter().enumerate() {
            for (row, want) in want.into_iter().enumerate() {
                // Defects do not depend on multipliers, whose columns are zeros in both.
                let found = jacobian[row * n + column];
                assert!((found - want).abs() < 1e-6 * want.abs().max(1.0), "{row} {column}: {found} {want}");
                let far = row.abs_diff(column) > LAYOUT.bandwidth();
                assert!(!far || found == 0.0, "{row} {column}");
            }
        }

        // ∇L = ∇φ + Aᵀ λ.
        let gradient = |z: &[f64]| {
            let mut gradient = std::vec![0.0; n];
            for j in 0..=LAYOUT.last() {
                for i in LAYOUT.point(j) + 12..LAYOUT.row(j) {
                    gradient[i] = 2.0 * problem.weight(j) * z[i];
                }
            }
            problem.jacobian(&slopes_at(z), |row, column, value| gradient[column] += value * z[row]);
            gradient
        };
        let columns = differences(&z, gradient);
        let (size, mut largest) = (LAYOUT.size(), 0.0_f64);
        for j in 0..=LAYOUT.last() {
            let curvature = problem.curvature(&z, j);
            for i in 0..size {
                let column = &columns[LAYOUT.point(j) + i];
                for row in (0..n).filter(|&row| LAYOUT.is_variable(row)) {
                    let inside = (LAYOUT.point(j)..LAYOUT.row(j)).contains(&row);
                    let found = if inside { curvature[i * size + row - LAYOUT.point(j)] } else { 0.0 };
                    let want = column[row];
                    assert!((found - want).abs() < 2e-5 * want.abs().max(1.0), "{j} {i} {row}: {found} {want}");
                    largest = largest.max(want.abs());
                }
            }
        }
        assert!(largest > 1.0, "{largest}");
    }
}
