//! States and accelerations that satisfy constraints.
//!
//! Holonomic rows `φ(q, t) = 0` and Pfaffian rows `a(q, t)·q̇ + b(q, t) = 0` restrict velocities to `A q̇ + b = 0`,
//! with `A = ∂φ/∂q` and `b = ∂φ/∂t` of the holonomic ones, and accelerations to `A q̈ + γ = 0`. An integrator keeps
//! neither `φ` nor `A q̇ + b` exactly at zero; [`Projector`] brings a state back by the smallest change in the metric
//! of the mass matrix:
//!
//! ```text
//! δq = −M⁻¹ Aᵀ (A M⁻¹ Aᵀ)⁻¹ φ    (repeated, Newton's method),    δq̇ = −M⁻¹ Aᵀ (A M⁻¹ Aᵀ)⁻¹ (A q̇ + b)
//! ```
//!
//! `A M⁻¹ Aᵀ` is never formed. With `M + Aᵀ A = L Lᵀ` of the system scaled to inertias and rows of order one, rows `L⁻¹
//! aᵢ` are made orthogonal one after the other, those that are left with the greatest share of their length first; a
//! row that is left with nothing depends on those before: it is redundant. `Aᵀ A` changes nothing, because `A δ` is
//! given, and makes up for what M lacks where rows hold a motion.
//!
//! | step                                                        | file              |
//! |-------------------------------------------------------------|-------------------|
//! | least change in the metric of M                             | `least_change.rs` |
//! | linearization in independent coordinates and speeds         | `reduction.rs`    |
//!
//! Source: E. Hairer, C. Lubich, G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006, section IV.4 (projection);
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, sections 5.2.8 (modified Gram–Schmidt), 5.4.2
//! (pivoting), 6.2.

use crate::error::{ConstraintError, SingularMassMatrix};
use crate::scalar::Real;
use crate::state::{Coordinates, State};

mod least_change;
pub mod reduction;

use least_change::Workspace;

/// The constraints of a mechanism with its parameters and inputs, as [`Projector`] evaluates them.
///
/// Results are written into slices: `n` numbers a coordinate, `k` a row; matrices row by row.
pub trait Constraints<T: Real> {
    /// The number of rows `k`.
    fn rows(&self) -> usize;

    /// Whether a row is holonomic, `φ(q, t) = 0`; otherwise it is `a·q̇ + b = 0`.
    fn is_holonomic(&self, row: usize) -> bool;

    /// Writes `M(q, t)`, `n × n`.
    fn mass_matrix(&self, t: T, q: &[T], m: &mut [T]);

    /// Writes `φ(q, t)` of holonomic rows; what stands in the others is not looked at.
    fn position(&self, t: T, q: &[T], phi: &mut [T]);

    /// Writes `A q̇ + b`.
    fn rate(&self, t: T, q: &[T], qd: &[T], rate: &mut [T]);

    /// Writes `A(q, t)`, `k × n`.
    fn jacobian(&self, t: T, q: &[T], a: &mut [T]);

    /// Writes the δ of least `δᵀ M δ` with `A δ = target`, and returns the rank of A. A mechanism with many rows may
    /// find δ in less time than it takes to write M and A in full. Where it returns `None`, as this default does, a
    /// [`Projector`] finds δ from M and A; where the rank is smaller than the number of rows, it finds out from them
    /// which rows depend on others.
    fn least_change(&self, t: T, q: &[T], target: &[T], change: &mut [T]) -> Option<usize> {
        let _ = (t, q, target, change);
        None
    }
}

/// Brings states back onto constraints, in the metric of the mass matrix.
///
/// It works in memory that it is given: an array of [`SIZE`](Self::size) numbers, or a `Vec`.
///
/// ```
/// use mbs_runtime::{Constraints, Projector, State};
///
/// /// A point of mass 2 on a circle of radius 1.
/// struct Circle;
///
/// impl Constraints<f64> for Circle {
///     fn rows(&self) -> usize {
///         1
///     }
///     fn is_holonomic(&self, _: usize) -> bool {
///         true
///     }
///     fn mass_matrix(&self, _: f64, _: &[f64], m: &mut [f64]) {
///         m.copy_from_slice(&[2.0, 0.0, 0.0, 2.0]);
///     }
///     fn position(&self, _: f64, q: &[f64], phi: &mut [f64]) {
///         phi[0] = (q[0] * q[0] + q[1] * q[1] - 1.0) / 2.0;
///     }
///     fn rate(&self, _: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
///         rate[0] = q[0] * qd[0] + q[1] * qd[1];
///     }
///     fn jacobian(&self, _: f64, q: &[f64], a: &mut [f64]) {
///         a.copy_from_slice(q);
///     }
/// }
///
/// let mut state = State::new([0.6, 0.9], [1.0, 0.0]);
/// let mut projector = Projector::new([0.0; Projector::<f64, [f64; 0]>::size(2, 1)]);
/// projector.project(&Circle, 0.0, &mut state).unwrap();
/// assert!((state.q[0].hypot(state.q[1]) - 1.0).abs() < 1e-15);
/// assert!((state.q[0] * state.qd[0] + state.q[1] * state.qd[1]).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct Projector<T, S> {
    memory: S,
    /// Rows that depend on others: whether they are left out, as long as they are satisfied, or refused.
    pub redundant_rows: RedundantRows,
    _scalar: core::marker::PhantomData<T>,
}

/// What is done about rows of A that depend on others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum RedundantRows {
    /// [`ConstraintError::Redundant`] names the row.
    #[default]
    Refuse,
    /// They are left out, which gives multipliers of the least norm; where they contradict the others,
    /// [`ConstraintError::Contradiction`] names the row.
    LeaveOut,
}

/// Newton's method converges quadratically near the constraints; from afar it is given some time.
const MOST_ITERATIONS: usize = 100;
/// How often a step of Newton's method is halved at most.
const MOST_HALVINGS: usize = 10;

impl<T: Real, S: AsMut<[T]>> Projector<T, S> {
    /// How many numbers it works in for `n` coordinates and `k` rows: `n² + k² + 4 k n + 9 n + 9 k`.
    #[must_use]
    pub const fn size(n: usize, k: usize) -> usize {
        // The second one is for multipliers.
        Workspace::<T>::size(n, k) + Workspace::<T>::size(k, n)
    }

    /// In this memory; redundant rows are refused.
    ///
    /// It panics later, where it is used with less memory than [`size`](Self::size) says.
    pub const fn new(memory: S) -> Self {
        Self { memory, redundant_rows: RedundantRows::Refuse, _scalar: core::marker::PhantomData }
    }

    /// Redundant rows are treated so.
    #[must_use]
    pub fn with_redundant_rows(mut self, redundant_rows: RedundantRows) -> Self {
        self.redundant_rows = redundant_rows;
        self
    }

    /// Brings positions onto `φ = 0`, then velocities onto `A q̇ + b = 0`, by the smallest change in the metric of M.
    ///
    /// # Errors
    /// As [`assemble`](Self::assemble); `state` is then as it was.
    pub fn project<C, V>(&mut self, constraints: &C, t: f64, state: &mut State<V>) -> Result<(), ConstraintError>
    where
        C: Constraints<T>,
        V: Coordinates<Scalar = T>,
    {
        self.assemble(constraints, t, state, |_| false)
    }

    /// Finds a state that satisfies the constraints from a guess of which some coordinates are held, and their
    /// velocities too.
    ///
    /// Newton's method with steps no longer than the largest coordinate or 1, that are halved while the residual grows;
    /// bounded. On the way from the guess rows may depend on others; in the state that is found they must not, unless
    /// such rows are left out.
    ///
    /// # Errors
    /// [`ConstraintError`]: a row stays open, which may be for want of another guess or of fewer coordinates that are
    /// held; a row is redundant, or contradicts others; M is singular on the motions that A leaves; something is not
    /// finite. `state` is then as it was.
    pub fn assemble<C, V>(
        &mut self,
        constraints: &C,
        t: f64,
        state: &mut State<V>,
        held: impl Fn(usize) -> bool,
    ) -> Result<(), ConstraintError>
    where
        C: Constraints<T>,
        V: Coordinates<Scalar = T>,
    {
        self.assemble_separately(constraints, t, state, &held, &held)
    }

    /// Finds a state that satisfies the constraints from a guess of which some coordinates are held, and the velocities
    /// of others; else it is [`assemble`](Self::assemble).
    ///
    /// # Errors
    /// As [`assemble`](Self::assemble); `state` is then as it was.
    pub fn assemble_separately<C, V>(
        &mut self,
        constraints: &C,
        t: f64,
        state: &mut State<V>,
        held: impl Fn(usize) -> bool,
        held_velocities: impl Fn(usize) -> bool,
    ) -> Result<(), ConstraintError>
    where
        C: Constraints<T>,
        V: Coordinates<Scalar = T>,
    {
        let t = T::from_f64(t);
        let n = state.q.as_slice().len();
        let mut work = Workspace::new(self.memory.as_mut(), n, constraints.rows());
        work.q.copy_from_slice(state.q.as_slice());
        work.close(constraints, t, &held)?;
        work.qd.copy_from_slice(state.qd.as_slice());
        if (0..n).any(|i| held(i) || held_velocities(i)) {
            // Rows that depend on others because of what is held may still be satisfied.
            work.slow(constraints, t, &held_velocities, RedundantRows::LeaveOut)?;
            work.linearize(constraints, t, &|_| false, |_| true)?;
            work.residual.iter_mut().for_each(|x| *x = T::zero());
            work.least_change(self.redundant_rows, |_| true)?;
        } else {
            work.slow(constraints, t, &held_velocities, self.redundant_rows)?;
        }
        if !work.q.iter().chain(&*work.qd).all(|x| x.is_finite()) {
            return Err(ConstraintError::NonFinite);
        }
        state.q.as_mut_slice().copy_from_slice(work.q);
        state.qd.as_mut_slice().copy_from_slice(work.qd);
        Ok(())
    }

    /// Accelerations and multipliers of `M q̈ = f + Aᵀ λ`, `A q̈ + γ = 0`, of least norm where rows are redundant.
    ///
    /// | argument      | meaning                                                                             | length |
    /// |---------------|-------------------------------------------------------------------------------------|--------|
    /// | `q`           | positions                                                                           | n      |
    /// | `force`       | `f = Q − C q̇ − G − ∂D/∂q̇`                                                           | n      |
    /// | `bias`        | `γ`; Baumgarte's stabilization is `γ + 2α (A q̇ + b) + β² φ` \[`α`, `β` in 1/s\]     | k      |
    /// | `qdd`         | receives `q̈`                                                                        | n      |
    /// | `multipliers` | receives `λ`                                                                        | k      |
    ///
    /// The generated `forward_dynamics` and `multipliers` do the same in closed form where all rows are independent.
    ///
    /// Source: J. Baumgarte, *Stabilization of constraints and integrals of motion in dynamical systems*, Computer
    /// Methods in Applied Mechanics and Engineering 1 (1972).
    ///
    /// # Errors
    /// [`ConstraintError`]: a row is redundant, unless such are left out; it asks for something else than the others
    /// (by more than about 1e-8 of its terms, 2e-12 per s² of rows that know coordinates of one, or the same roots of
    /// `f32`); M is singular on the motions that A leaves; something is not finite. What is to be received is then
    /// undefined.
    #[allow(clippy::too_many_arguments)] // two equations with two unknowns
    pub fn accelerations<C: Constraints<T>>(
        &mut self,
        constraints: &C,
        t: f64,
        q: &[T],
        force: &[T],
        bias: &[T],
        qdd: &mut [T],
        multipliers: &mut [T],
    ) -> Result<(), ConstraintError> {
        let (t, n, k) = (T::from_f64(t), q.len(), constraints.rows());
        let (first, second) = self.memory.as_mut().split_at_mut(Workspace::<T>::size(n, k));
        let mut work = Workspace::new(first, n, k);
        work.q.copy_from_slice(q);
        work.linearize(constraints, t, &|_| false, |_| true)?;
        // The nearest to the free accelerations: Gauss's principle of least constraint.
        work.begin.copy_from_slice(force);
        work.solve_begin();
        work.residual_at_begin(bias);
        work.least_change(self.redundant_rows, |_| true)?;
        if let Some((row, residual)) = work.contradiction(bias) {
            return Err(ConstraintError::Contradiction { row, residual: residual.to_f64() });
        }
        for (i, qdd) in qdd.iter_mut().enumerate() {
            *qdd = work.begin[i] + work.change[i];
        }

        // λ of least norm with Aᵀ λ = M q̈ − f.
        constraints.mass_matrix(t, q, work.metric);
        let mut transposed = Workspace::new(second, k, n);
        for i in 0..n {
            let inertia = work.metric[i * n..(i + 1) * n].iter().zip(&*qdd);
            transposed.residual[i] = inertia.fold(force[i], |rest, (&m, &qdd)| rest - m * qdd);
        }
        // A coordinate that a row knows by nothing but rounding says nothing of the row's multiplier: it is measured
        // against the length of the row, not against what other rows know of the coordinate.
        let rounding = T::from_f64(16.0 * n as f64) * T::EPSILON;
        for row in 0..k {
            let a = &work.jacobian[row * n..(row + 1) * n];
            let size = |i: usize| (a[i] * work.scales[i]).abs();
            let length = (0..n).fold(T::zero(), |length, i| length.maximum(size(i)));
            for i in 0..n {
                transposed.jacobian[i * k + row] = if size(i) <= rounding * length { T::zero() } else { a[i] };
            }
        }
        for row in 0..k {
            for column in 0..k {
                transposed.metric[row * k + column] = if row == column { T::one() } else { T::zero() };
            }
        }
        transposed.scales.iter_mut().for_each(|scale| *scale = T::one());
        transposed.least_change(RedundantRows::LeaveOut, |_| true)?;
        multipliers.copy_from_slice(transposed.change);
        if qdd.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(ConstraintError::NonFinite) }
    }

    /// The rank of A at `q`; `redundant` receives the rows that depend on the others.
    ///
    /// # Errors
    /// [`ConstraintError`]: M is singular on the motions that A leaves; something is not finite.
    pub fn rank<C: Constraints<T>>(
        &mut self,
        constraints: &C,
        t: f64,
        q: &[T],
        mut redundant: impl FnMut(usize),
    ) -> Result<usize, ConstraintError> {
        let k = constraints.rows();
        let mut work = Workspace::new(self.memory.as_mut(), q.len(), k);
        work.q.copy_from_slice(q);
        work.residual.iter_mut().for_each(|x| *x = T::zero());
        if work.changed_by(constraints, T::from_f64(t), &|_| false) == Some(k) {
            return Ok(k);
        }
        work.linearize(constraints, T::from_f64(t), &|_| false, |_| true)?;
        work.least_change(RedundantRows::LeaveOut, |_| true)?;
        (0..k).filter(|&row| !work.is_done(row)).for_each(&mut redundant);
        Ok((0..k).filter(|&row| work.is_done(row)).count())
    }
}

impl<T: Real> Workspace<'_, T> {
    /// Newton's method for `φ(q) = 0`.
    fn close<C: Constraints<T>>(
        &mut self,
        constraints: &C,
        t: T,
        held: &impl Fn(usize) -> bool,
    ) -> Result<(), ConstraintError> {
        if (0..constraints.rows()).all(|row| !constraints.is_holonomic(row)) {
            return Ok(());
        }
        let mut residual = self.residual(constraints, t)?;
        for _ in 0..MOST_ITERATIONS {
            if residual == T::zero() {
                return Ok(());
            }
            let are_holonomic = (0..constraints.rows()).all(|row| constraints.is_holonomic(row));
            let is_found = are_holonomic && self.changed_by(constraints, t, held).is_some();
            if !is_found {
                self.linearize(constraints, t, held, |row| constraints.is_holonomic(row))?;
                self.least_change(RedundantRows::LeaveOut, |row| constraints.is_holonomic(row))?;
            }
            let size = self.q.iter().fold(T::one(), |size, &q| size.maximum(q.abs()));
            let step = self.change.iter().fold(T::zero(), |step, &x| step.maximum(x.abs()));
            let start = residual;
            self.begin.copy_from_slice(self.q);
            // Next to where A loses rank Newton's steps are long, and lead anywhere.
            let mut share = if step > size { size / step } else { T::one() };
            for halving in 0..=MOST_HALVINGS {
                for i in 0..self.q.len() {
                    self.q[i] = self.begin[i] + share * self.change[i];
                }
                residual = self.residual(constraints, t).unwrap_or(T::one() / T::zero());
                if residual < start || halving == MOST_HALVINGS {
                    break;
                }
                share = share * T::from_f64(0.5);
            }
            if residual >= start {
                // No change makes it smaller: rounding, or a loop that does not close.
                self.q.copy_from_slice(self.begin);
                self.residual(constraints, t)?;
                return self.closed(constraints, t, size);
            }
            // The next step would be of the order of this one's square.
            if share == T::one() && step <= size * T::EPSILON.sqrt() * T::from_f64(1e-2) {
                return if is_found { Ok(()) } else { self.closed(constraints, t, size) };
            }
        }
        self.closed(constraints, t, T::zero())
    }

    /// `change` ← δ as the mechanism itself finds it, and the rank of A; `None` where it finds none, or a coordinate is
    /// held.
    fn changed_by<C: Constraints<T>>(&mut self, constraints: &C, t: T, held: &impl Fn(usize) -> bool) -> Option<usize> {
        if (0..self.q.len()).any(held) {
            return None;
        }
        let (residual, targets) = (self.residual.iter(), self.targets.iter_mut());
        targets.zip(residual).for_each(|(target, &residual)| *target = -residual);
        let rank = constraints.least_change(t, self.q, self.targets, self.change);
        rank.filter(|_| self.change.iter().all(|x| x.is_finite()))
    }

    /// Whether all rows are zero but for what a change of the coordinates by a small part of their `size` explains.
    fn closed<C: Constraints<T>>(&mut self, constraints: &C, t: T, size: T) -> Result<(), ConstraintError> {
        match self.unexplained(constraints, t, size) {
            Some(row) => Err(ConstraintError::Open { row, residual: self.residual[row].to_f64() }),
            None => Ok(()),
        }
    }

    /// The first row whose residual is more than what changes by a small part of `size` make, of coordinates or
    /// velocities, of those that are held, too.
    fn unexplained<C: Constraints<T>>(&mut self, constraints: &C, t: T, size: T) -> Option<usize> {
        constraints.jacobian(t, self.q, self.jacobian);
        let n = self.q.len();
        let explained = |row: usize| {
            let slopes = self.jacobian[row * n..(row + 1) * n].iter();
            T::EPSILON.sqrt() * size * slopes.fold(T::zero(), |sum, slope| sum + slope.abs())
        };
        (0..self.residual.len()).find(|&row| self.residual[row].is_nan() || self.residual[row].abs() > explained(row))
    }

    /// Velocities with `A q̇ + b = 0`.
    fn slow<C: Constraints<T>>(
        &mut self,
        constraints: &C,
        t: T,
        held: &impl Fn(usize) -> bool,
        redundant_rows: RedundantRows,
    ) -> Result<(), ConstraintError> {
        // A second time for the rounding of the first.
        for _ in 0..2 {
            constraints.rate(t, self.q, self.qd, self.residual);
            if !self.residual.iter().all(|x| x.is_finite()) {
                return Err(ConstraintError::NonFinite);
            }
            let least = if redundant_rows == RedundantRows::Refuse { constraints.rows() } else { 0 };
            if self.changed_by(constraints, t, held).is_none_or(|rank| rank < least) {
                self.linearize(constraints, t, held, |_| true)?;
                self.least_change(redundant_rows, |_| true)?;
            }
            for i in 0..self.qd.len() {
                self.qd[i] = self.qd[i] + self.change[i];
            }
        }
        constraints.rate(t, self.q, self.qd, self.residual);
        let speed = self.qd.iter().fold(T::EPSILON.sqrt(), |speed, &qd| speed.maximum(qd.abs()));
        let is_small = |change: &T| change.abs() <= T::EPSILON.sqrt() * speed;
        if self.changed_by(constraints, t, held).is_some() && self.change.iter().all(is_small) {
            return Ok(());
        }
        match self.unexplained(constraints, t, speed) {
            Some(row) => Err(ConstraintError::Contradiction { row, residual: self.residual[row].to_f64() }),
            None => Ok(()),
        }
    }

    /// φ of the holonomic rows, zero in the others; the largest of them.
    fn residual<C: Constraints<T>>(&mut self, constraints: &C, t: T) -> Result<T, ConstraintError> {
        constraints.position(t, self.q, self.residual);
        for row in 0..self.residual.len() {
            if !constraints.is_holonomic(row) {
                self.residual[row] = T::zero();
            }
        }
        let largest = self.residual.iter().fold(T::zero(), |largest, &x| largest.maximum(x.abs()));
        if largest.is_finite() { Ok(largest) } else { Err(ConstraintError::NonFinite) }
    }

    /// M, factorized, and A at q; coordinates that are held take no part, nor do other rows.
    fn linearize<C: Constraints<T>>(
        &mut self,
        constraints: &C,
        t: T,
        held: &impl Fn(usize) -> bool,
        takes_part: impl Fn(usize) -> bool,
    ) -> Result<(), SingularMassMatrix> {
        let n = self.q.len();
        constraints.mass_matrix(t, self.q, self.metric);
        constraints.jacobian(t, self.q, self.jacobian);
        for i in (0..n).filter(|&i| held(i)) {
            for j in 0..n {
                self.metric[i * n + j] = T::zero();
                self.metric[j * n + i] = T::zero();
            }
            self.metric[i * n + i] = T::one();
            self.jacobian.iter_mut().skip(i).step_by(n).for_each(|a| *a = T::zero());
        }
        self.factorize(takes_part)
    }
}

impl From<SingularMassMatrix> for ConstraintError {
    fn from(error: SingularMassMatrix) -> Self {
        ConstraintError::SingularMassMatrix(error)
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests;
