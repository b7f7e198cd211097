//! The semi-implicit (symplectic) Euler method, with a fixed step.
//!
//! ```text
//! q̇₁ = q̇₀ + h f(t₀, q₀, q̇₀)
//! q₁ = q₀ + h q̇₁
//! ```
//!
//! Source: R. de Vogelaere, *Methods of integration which preserve the contact transformation property of the
//! Hamiltonian equations*, 1956; E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006,
//! formula I.1.9. Between the ends of a step `q` is the cubic Hermite polynomial, `q̇` the straight line.

use super::compensation::Compensation;
use super::run::{Fault, Method, Span, System};
use super::{Acceleration, hermite};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// The semi-implicit Euler method of order 1: one evaluation in a step of fixed length.
///
/// The velocity first, the coordinate with the new velocity: `q̇₁ = q̇₀ + h f(t₀, q₀, q̇₀)`, `q₁ = q₀ + h q̇₁`.
/// Symplectic where the acceleration comes from a potential and a constant mass matrix; the energy then oscillates by
/// `O(h)` and does not drift. Rounding errors are compensated.
///
/// ```
/// use core::ops::ControlFlow;
/// use mbs_runtime::{Integrator, SemiImplicitEuler, State};
///
/// let mut state = State::new([1.0], [0.0]);
/// SemiImplicitEuler::new(1e-3)
///     .integrate(|_, q, _, qdd| qdd[0] = -q[0], 0.0, 1.0, &mut state, |_| ControlFlow::Continue(()))
///     .unwrap();
/// assert!((state.q[0] - 1.0_f64.cos()).abs() < 1e-3);
/// ```
///
/// # Source
/// E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration*, 2nd ed. 2006, formula I.1.9.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SemiImplicitEuler {
    /// The longest step, up to rounding \[s\]. The steps are equal and as many as needed, so that the last one ends
    /// where it should.
    pub step: f64,
    /// The number of steps allowed in one integration.
    pub max_steps: usize,
}

equal_steps! {
    SemiImplicitEuler: |first|
    Work { a: core::array::from_fn(|_| first.q.clone()), rounding: Compensation::new(first) }
}

/// What the steps of one integration work in.
struct Work<V> {
    /// The accelerations at the beginning and at the end, which is evaluated before the step is accepted: a state
    /// without an acceleration is not handed out.
    a: [V; 2],
    rounding: Compensation<V>,
}

impl<V: Coordinates> Method<V> for Work<V> {
    type Error = ();

    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.rounding.clear();
        system.evaluate(t, &state.q, &state.qd, &mut self.a[0])
    }

    fn proceed<F: Acceleration<V>>(
        &mut self,
        _: &mut System<F>,
        _: f64,
        _: &State<V>,
        _: bool,
    ) -> Result<(), Fault<F::Error>> {
        self.rounding.proceed();
        self.a.swap(0, 1);
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
        let h = V::Scalar::from_f64(length);
        let (q, qd, a) = (old.q.as_slice(), old.qd.as_slice(), self.a[0].as_slice());
        for i in 0..q.len() {
            let velocity = self.rounding.add_to_velocity(i, qd[i], h * a[i]);
            new.qd.as_mut_slice()[i] = velocity;
            new.q.as_mut_slice()[i] = self.rounding.add_to_coordinate(i, q[i], h * velocity);
        }
        if !new.is_finite() {
            return Err(Fault::NonFinite);
        }
        system.evaluate(t + length, &new.q, &new.qd, &mut self.a[1])
    }

    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        hermite::interpolate(span, [&self.a[0], &self.a[0]], theta, state);
    }
}
