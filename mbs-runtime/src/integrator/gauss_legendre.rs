//! The Gauss–Legendre method of order 4, implicit and symplectic, with a fixed step.
//!
//! ```text
//! 1/2 − √3/6 |    1/4      1/4 − √3/6
//! 1/2 + √3/6 | 1/4 + √3/6     1/4
//! -----------+------------------------
//!            |    1/2         1/2
//! ```
//!
//! With `ā = a²`, `b̄ = aᵀb` and the accelerations `k` of the stages as unknowns, which are iterated:
//!
//! ```text
//! Qᵢ = q₀ + h cᵢ q̇₀ + h² Σ āᵢⱼ kⱼ,    Q̇ᵢ = q̇₀ + h Σ aᵢⱼ kⱼ,    kᵢ = f(t₀ + cᵢ h, Qᵢ, Q̇ᵢ)
//! q₁ = q₀ + h q̇₀ + h² Σ b̄ᵢ kᵢ,        q̇₁ = q̇₀ + h Σ bᵢ kᵢ
//! ```
//!
//! Source: P. C. Hammer and J. W. Hollingsworth, *Trapezoidal methods of approximating solutions of differential
//! equations*, 1955; E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006, table II.1.1
//! (tableau), theorem VI.4.2 (symplectic), sections VIII.6.1 and VIII.5 (iteration, rounding). Between the ends of a
//! step: cubic Hermite polynomials.

use super::compensation::Compensation;
use super::run::{Fault, Method, Span, System};
use super::{Acceleration, Integrator, Observer, Summary, fixed, hermite};
use crate::error::IntegrationError;
use crate::scalar::{Real, Scalar};
use crate::state::{Coordinates, State};

/// `√3`.
const ROOT: f64 = 1.732_050_807_568_877_2;
const C: [f64; 2] = [0.5 - ROOT / 6.0, 0.5 + ROOT / 6.0];
const A: [[f64; 2]; 2] = [[0.25, 0.25 - ROOT / 6.0], [0.25 + ROOT / 6.0, 0.25]];
/// `ā = a²`.
const A_BAR: [[f64; 2]; 2] = [[1.0 / 24.0, 0.125 - ROOT / 12.0], [0.125 + ROOT / 12.0, 1.0 / 24.0]];
/// `b̄ = aᵀb`.
const B_BAR: [f64; 2] = [0.25 + ROOT / 12.0, 0.25 - ROOT / 12.0];

/// The Gauss–Legendre method of order 4: implicit, symmetric, symplectic for every mechanism without dissipation whose
/// state is `(q, M q̇)` in canonical coordinates; steps of fixed length.
///
/// The equations of the two stages (see the table in `gauss_legendre.rs`) are iterated until the accelerations change
/// by no more than `tolerance` relative to the largest of them, or by rounding alone; two evaluations an iteration, six
/// to ten iterations where the step is a hundredth of the shortest period. Rounding errors are compensated.
///
/// ```
/// use core::ops::ControlFlow;
/// use mbs_runtime::{GaussLegendre4, Integrator, State};
///
/// let mut state = State::new([1.0], [0.0]);
/// GaussLegendre4::new(0.01)
///     .integrate(|_, q, _, qdd| qdd[0] = -q[0], 0.0, 1.0, &mut state, |_| ControlFlow::Continue(()))
///     .unwrap();
/// assert!((state.q[0] - 1.0_f64.cos()).abs() < 1e-10);
/// ```
///
/// # Source
/// E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006, table II.1.1, theorem VI.4.2,
/// section VIII.6.1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GaussLegendre4 {
    /// The longest step, up to rounding \[s\]. The steps are equal and as many as needed, so that the last one ends
    /// where it should.
    pub step: f64,
    /// The relative change of the accelerations at which the iteration ends, positive.
    pub tolerance: f64,
    /// The number of iterations allowed in one step.
    pub max_iterations: usize,
    /// The number of steps allowed in one integration.
    pub max_steps: usize,
}

impl GaussLegendre4 {
    /// Steps of `step` seconds, or a little less, any number of them; iterated to `1e-15`, fifty times at the most.
    #[must_use]
    pub const fn new(step: f64) -> Self {
        Self { step, tolerance: 1e-15, max_iterations: 50, max_steps: usize::MAX }
    }
}

settings! {
    GaussLegendre4:
    "The relative change of the accelerations at which the iteration ends, positive." with_tolerance tolerance f64 = tolerance;
    "The number of iterations allowed in one step." with_max_iterations max_iterations usize = max_iterations;
    "The number of steps allowed in one integration." with_max_steps max_steps usize = max_steps;
}

impl<T: Real> Integrator<T> for GaussLegendre4 {
    /// # Errors
    /// [`IntegrationError::InvalidStep`] if `step` is not positive; [`IntegrationError::InvalidTolerance`] if
    /// `tolerance` is not; [`IntegrationError::TooManySteps`] at once if `max_steps` are too few;
    /// [`IntegrationError::NotConverged`] if the iteration does not end; otherwise [`IntegrationError`] where the first
    /// bad number appears.
    fn run<V, F>(
        &self,
        acceleration: F,
        t: f64,
        t_end: f64,
        state: &mut State<V>,
        observer: impl Observer<V, F::Error>,
    ) -> Result<Summary, IntegrationError<F::Error>>
    where
        V: Coordinates<Scalar = T>,
        F: Acceleration<V>,
    {
        let tolerance = self.tolerance;
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(IntegrationError::InvalidTolerance { relative: tolerance, absolute: tolerance });
        }
        let work = Work {
            k: core::array::from_fn(|_| state.q.clone()),
            ends: core::array::from_fn(|_| state.q.clone()),
            stage: state.clone(),
            next: state.q.clone(),
            rounding: Compensation::new(state),
            tolerance: T::from_f64(tolerance),
            max_iterations: self.max_iterations,
        };
        fixed::integrate((self.step, self.max_steps), work, acceleration, t, t_end, state, observer)
    }
}

/// What the steps of one integration work in.
struct Work<V: Coordinates> {
    /// The accelerations of the stages.
    k: [V; 2],
    /// The accelerations at the beginning and the end, where they were asked for.
    ends: [V; 2],
    /// The state of the stage at hand.
    stage: State<V>,
    /// Its acceleration.
    next: V,
    rounding: Compensation<V>,
    tolerance: V::Scalar,
    max_iterations: usize,
}

impl<V: Coordinates<Scalar: Real>> Work<V> {
    /// `kᵢ = f(t₀ + cᵢ h, Qᵢ, Q̇ᵢ)` with the `k` at hand; how far it moves, and its size.
    fn iterate<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        i: usize,
    ) -> Result<[V::Scalar; 2], Fault<F::Error>> {
        let (h, c) = (V::Scalar::from_f64(length), V::Scalar::from_f64(C[i]));
        let (a, a_bar) = (A[i].map(V::Scalar::from_f64), A_BAR[i].map(V::Scalar::from_f64));
        let (q, qd) = (old.q.as_slice(), old.qd.as_slice());
        let [k1, k2] = self.k.each_ref().map(V::as_slice);
        let stage = (self.stage.q.as_mut_slice(), self.stage.qd.as_mut_slice());
        for n in 0..q.len() {
            stage.0[n] = q[n] + h * (c * qd[n] + h * (a_bar[0] * k1[n] + a_bar[1] * k2[n]));
            stage.1[n] = qd[n] + h * (a[0] * k1[n] + a[1] * k2[n]);
        }
        system.evaluate(t + C[i] * length, &self.stage.q, &self.stage.qd, &mut self.next)?;
        let (mut change, mut size) = (V::Scalar::zero(), V::Scalar::zero());
        for (k, next) in self.k[i].as_mut_slice().iter_mut().zip(self.next.as_slice()) {
            change = change.maximum((*next - *k).abs());
            size = size.maximum(next.abs());
            *k = *next;
        }
        Ok([change, size])
    }

    /// Iterates the accelerations of both stages until they stay.
    fn solve<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        let h = V::Scalar::from_f64(length);
        let mut least = V::Scalar::zero();
        // For how many iterations the change has not decreased.
        let mut stalled = 0;
        for iteration in 0..self.max_iterations {
            let mut sweep = || {
                let [first, second] = [0, 1].map(|i| self.iterate(system, t, length, old, i));
                let ([c1, s1], [c2, s2]) = (first?, second?);
                Ok([c1.maximum(c2), s1.maximum(s2)])
            };
            let [change, size] = match sweep() {
                // What grows beyond all numbers by itself does not converge.
                Err(Fault::NonFinite) if stalled > 0 => break,
                result => result?,
            };
            if change <= self.tolerance * size {
                return Ok(());
            }
            if iteration == 0 || change < least {
                (least, stalled) = (change, 0);
                continue;
            }
            stalled += 1;
            // Changes that no longer decrease are rounding if the coordinates do not feel them, or hardly and for long,
            // and velocities hardly; or if those of a state as good as this one differ by as much.
            let speed = largest(&old.qd) + h.abs() * size;
            let reach = largest(&old.q) + h.abs() * speed;
            let (nothing, hardly) = (V::Scalar::from_f64(64.0) * V::Scalar::EPSILON, V::Scalar::EPSILON.sqrt());
            let felt = if stalled < 4 { nothing } else { hardly };
            if h * h * change <= felt * reach && h.abs() * change <= hardly * speed {
                return Ok(());
            }
            if h * h * change <= nothing * reach && change <= self.scatter(system, t + C[1] * length)? {
                return Ok(());
            }
        }
        Err(Fault::NotConverged(self.max_iterations))
    }

    /// How far the accelerations of the second stage, which is at hand, move where some ulps are added to its state.
    fn scatter<F: Acceleration<V>>(&mut self, system: &mut System<F>, t: f64) -> Result<V::Scalar, Fault<F::Error>> {
        /// Different numbers, so that neither sums nor differences of equal ones stay.
        const ULPS: [f64; 4] = [8.0, -13.0, 21.0, -34.0];
        for numbers in [self.stage.q.as_mut_slice(), self.stage.qd.as_mut_slice()] {
            for (number, ulps) in numbers.iter_mut().zip(ULPS.into_iter().cycle()) {
                *number = *number + V::Scalar::from_f64(ulps) * V::Scalar::EPSILON * *number;
            }
        }
        match system.evaluate(t, &self.stage.q, &self.stage.qd, &mut self.next) {
            Err(Fault::NonFinite) => return Ok(V::Scalar::zero()),
            result => result?,
        }
        let pairs = self.next.as_slice().iter().zip(self.k[1].as_slice());
        Ok(pairs.fold(V::Scalar::zero(), |most, (next, k)| most.maximum((*next - *k).abs())))
    }
}

/// The largest of the absolute values.
fn largest<V: Coordinates<Scalar: Real>>(numbers: &V) -> V::Scalar {
    numbers.as_slice().iter().fold(V::Scalar::zero(), |largest, x| largest.maximum(x.abs()))
}

impl<V: Coordinates<Scalar: Real>> Method<V> for Work<V> {
    type Error = ();

    /// The accelerations of the stages start from the one at the beginning.
    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.rounding.clear();
        let [k1, k2] = &mut self.k;
        system.evaluate(t, &state.q, &state.qd, k1)?;
        k2.copy_from(k1);
        Ok(())
    }

    /// They start from the line through those of the step before: `k(c + 1)` of the next one.
    fn proceed<F: Acceleration<V>>(
        &mut self,
        _: &mut System<F>,
        _: f64,
        _: &State<V>,
        _: bool,
    ) -> Result<(), Fault<F::Error>> {
        self.rounding.proceed();
        let root = V::Scalar::from_f64(ROOT);
        let [k1, k2] = self.k.each_mut().map(V::as_mut_slice);
        for (k1, k2) in k1.iter_mut().zip(k2) {
            let rise = *k2 - *k1;
            *k1 = *k1 + root * rise;
            *k2 = *k2 + root * rise;
        }
        Ok(())
    }

    fn advance<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.solve(system, t, length, old)?;
        let (h, half) = (V::Scalar::from_f64(length), V::Scalar::from_f64(0.5 * length));
        let b_bar = B_BAR.map(V::Scalar::from_f64);
        let (q, qd) = (old.q.as_slice(), old.qd.as_slice());
        let [k1, k2] = self.k.each_ref().map(V::as_slice);
        for i in 0..q.len() {
            let drift = h * self.rounding.velocity(i) + h * h * (b_bar[0] * k1[i] + b_bar[1] * k2[i]);
            new.q.as_mut_slice()[i] = self.rounding.add_to_coordinate(i, q[i], h * qd[i] + drift);
            new.qd.as_mut_slice()[i] = self.rounding.add_to_velocity(i, qd[i], half * (k1[i] + k2[i]));
        }
        if new.is_finite() { Ok(()) } else { Err(Fault::NonFinite) }
    }

    fn prepare<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        span: &Span<'_, V>,
    ) -> Result<(), Fault<F::Error>> {
        let [first, last] = &mut self.ends;
        system.evaluate(span.start, &span.old.q, &span.old.qd, first)?;
        system.evaluate(span.end, &span.new.q, &span.new.qd, last)
    }

    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        hermite::interpolate(span, [&self.ends[0], &self.ends[1]], theta, state);
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
    use crate::Step;
    use core::ops::ControlFlow;

    fn go_on<V: Coordinates>(_: &mut dyn Step<V>) -> ControlFlow<f64> {
        ControlFlow::Continue(())
    }

    #[test]
    fn the_tables_belong_together() {
        for i in 0..2 {
            assert!((A[i][0] + A[i][1] - C[i]).abs() < 1e-16);
            assert!((0.5 * (A[0][i] + A[1][i]) - B_BAR[i]).abs() < 1e-16);
            for j in 0..2 {
                assert!((A[i][0] * A[0][j] + A[i][1] * A[1][j] - A_BAR[i][j]).abs() < 1e-16);
            }
        }
    }

    #[test]
    fn quadratic_invariants_stay() {
        // A charge in a magnetic field, with a force that depends on q̇: |q̇|² is kept to rounding.
        let turn = |_: f64, _: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]| *qdd = [3.0 * qd[1], -3.0 * qd[0]];
        let mut state = State::new([0.0, 0.0], [0.6, 0.8]);
        GaussLegendre4::new(0.1)
            .integrate(turn, 0.0, 1000.0, &mut state, |step| {
                let qd = step.state().qd;
                assert!((qd[0] * qd[0] + qd[1] * qd[1] - 1.0).abs() < 1e-13);
                ControlFlow::Continue(())
            })
            .unwrap();
    }

    #[test]
    fn it_is_symmetric() {
        let pull = |_: f64, q: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -q[0].sin() + 0.3 * qd[0];
        let mut state = State::new([1.0], [0.5]);
        GaussLegendre4::new(0.1).integrate(pull, 0.0, 5.0, &mut state, go_on).unwrap();
        GaussLegendre4::new(0.1).integrate(pull, 5.0, 0.0, &mut state, go_on).unwrap();
        assert!((state.q[0] - 1.0).abs() < 1e-13 && (state.qd[0] - 0.5).abs() < 1e-13, "{state:?}");
    }

    #[test]
    fn an_iteration_that_does_not_end_is_an_error() {
        // A spring so stiff that the step is a thousand times too long for the iteration.
        let stiff = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -1e8 * q[0];
        let mut state = State::new([1.0], [0.0]);
        let result = GaussLegendre4::new(0.1).integrate(stiff, 0.0, 1.0, &mut state, go_on);
        assert!(matches!(result, Err(IntegrationError::NotConverged { time: 0.0, iterations: 50 })), "{result:?}");
        assert_eq!(state, State::new([1.0], [0.0]));
        let few = GaussLegendre4 { max_iterations: 0, ..GaussLegendre4::new(0.1) };
        let result = few.integrate(stiff, 0.0, 1.0, &mut state, go_on);
        assert_eq!(result, Err(IntegrationError::NotConverged { time: 0.0, iterations: 0 }));
        // At rest nothing moves, and that is a solution.
        let mut rest = State::new([0.0], [0.0]);
        GaussLegendre4::new(0.1).integrate(stiff, 0.0, 1.0, &mut rest, go_on).unwrap();
        // Of large forces that cancel there remains rounding.
        let balance = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| {
            qdd[0] = 1e6 * (1.0 - q[0].cos()) - 1e3 * q[0].sin()
        };
        let mut state = State::new([1e-4], [0.0]);
        GaussLegendre4::new(0.01).integrate(balance, 0.0, 10.0, &mut state, go_on).unwrap();
    }

    /// In the second half of a step a force that pushes back and forth, beside a coordinate that is far away: only the
    /// second stage does not settle, and what it moves by is much more than rounding.
    #[test]
    fn an_iteration_that_goes_back_and_forth_is_an_error() {
        let back_and_forth = |t: f64, q: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]| {
            qdd[0] = if t < 0.05 { 0.0 } else { -q[0].signum() };
            qdd[1] = 0.0;
        };
        let mut state = State::new([0.0, 100.0], [0.0, 0.0]);
        let result = GaussLegendre4::new(0.1).integrate(back_and_forth, 0.0, 0.1, &mut state, go_on);
        assert_eq!(result, Err(IntegrationError::NotConverged { time: 0.0, iterations: 50 }));
        // Friction that turns with the velocity, of which places of 1 m feel nothing in a step of 1e-5 s.
        let friction = |_: f64, _: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 1.0 - 5.0 * qd[0].signum();
        for place in [0.0, 1.0, 100.0, 1e5] {
            let mut state = State::new([place], [0.0]);
            let result = GaussLegendre4::new(1e-5).integrate(friction, 0.0, 1e-5, &mut state, go_on);
            assert_eq!(result, Err(IntegrationError::NotConverged { time: 0.0, iterations: 50 }), "{place}");
        }
        // Numbers of 32 bits feel nothing in usual steps.
        let friction = |_: f32, _: &[f32; 1], qd: &[f32; 1], qdd: &mut [f32; 1]| qdd[0] = 1.0 - 5.0 * qd[0].signum();
        for (place, step) in [(0.0, 1e-3), (2.0, 1e-3), (1.0, 5e-4), (1.0, 1e-4)] {
            let mut state = State::new([place], [0.0]);
            let result = GaussLegendre4::new(step).integrate(friction, 0.0, step, &mut state, go_on);
            assert_eq!(result, Err(IntegrationError::NotConverged { time: 0.0, iterations: 50 }), "{place} {step}");
        }
    }

    /// Stiff springs far from the origin, which are off by some ulps: that is all that moves them, and no iteration
    /// tells their accelerations better.
    #[test]
    fn what_rests_far_away_is_rounding() {
        for ratio in [0.25, 0.5, 1.0] {
            for start in [1000.1, 1000.1 + 5e-13] {
                let pull = |_: f64, q: &[f64; 2], _: &[f64; 2], qdd: &mut [f64; 2]| {
                    let stretch = q[1] - q[0] - 0.3;
                    *qdd = [1e6 * ratio * (1000.1 - q[0] + stretch), -1e6 * ratio * stretch];
                };
                let mut state = State::new([start, start + 0.3], [0.0, 0.0]);
                GaussLegendre4::new(1e-3).integrate(pull, 0.0, 1.0, &mut state, go_on).unwrap();
                assert!((state.q[0] - 1000.1).abs() < 1e-11, "{ratio} {start}: {state:?}");
                let pull = |_: f32, q: &[f32; 1], _: &[f32; 1], qdd: &mut [f32; 1]| {
                    qdd[0] = 1e6 * ratio as f32 * (1000.1 - q[0]);
                };
                let mut state = State::new([start as f32 + 1e-4], [0.0]);
                GaussLegendre4::new(1e-3).integrate(pull, 0.0, 1.0, &mut state, go_on).unwrap();
                assert!((state.q[0] - 1000.1).abs() < 2e-3, "{ratio} {start}: {state:?}");
            }
        }
    }

    #[test]
    fn bad_tolerances_are_refused() {
        for tolerance in [0.0, -1e-15, f64::NAN, f64::INFINITY] {
            let gauss = GaussLegendre4 { tolerance, ..GaussLegendre4::new(0.1) };
            let result = gauss.integrate(|_, _, _, _| {}, 0.0, 1.0, &mut State::new([0.0], [0.0]), go_on);
            assert!(matches!(result, Err(IntegrationError::InvalidTolerance { .. })));
        }
    }

    #[test]
    fn single_precision() {
        let mut state = State::new([1.0_f32], [0.0]);
        let pull = |_: f32, q: &[f32; 1], _: &[f32; 1], qdd: &mut [f32; 1]| qdd[0] = -q[0];
        GaussLegendre4::new(0.05).integrate(pull, 0.0, 1.0, &mut state, go_on).unwrap();
        assert!((state.q[0] - 1.0_f32.cos()).abs() < 1e-6);
    }
}
