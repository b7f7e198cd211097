//! The Störmer–Verlet method, with a fixed step.
//!
//! ```text
//! q̇½ = q̇₀ + h/2 f(t₀, q₀)
//! q₁ = q₀ + h q̇½
//! q̇₁ = q̇½ + h/2 f(t₁, q₁)
//! ```
//!
//! Source: L. Verlet, *Computer "experiments" on classical fluids I*, 1967; E. Hairer, C. Lubich and G. Wanner,
//! *Geometric numerical integration illustrated by the Störmer–Verlet method*, Acta Numerica 2003, formula 1.8 (the
//! velocity form). Between the ends of a step: cubic Hermite polynomials.

use super::compensation::Compensation;
use super::run::{Fault, Method, Span, System};
use super::{Acceleration, hermite};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// The Störmer–Verlet method of order 2: one evaluation in a step of fixed length, for accelerations `f(t, q)`.
///
/// Kick, drift, kick: `q̇½ = q̇₀ + h/2 f(t₀, q₀)`, `q₁ = q₀ + h q̇½`, `q̇₁ = q̇½ + h/2 f(t₁, q₁)`. Symplectic and
/// symmetric where the acceleration comes from a potential and a constant mass matrix (a separable Hamiltonian): the
/// energy oscillates by `O(h²)` and does not drift. Rounding errors are compensated.
///
/// An acceleration that depends on `q̇` is evaluated with the velocity at hand: `q̇½` at the end of a step, and the
/// first kick of the next step takes over that value. The method is then of order 1, and neither symplectic nor
/// symmetric;
/// [`GaussLegendre4`](crate::GaussLegendre4) is both for any mechanism without dissipation.
///
/// ```
/// use core::ops::ControlFlow;
/// use mbs_runtime::{Integrator, State, StormerVerlet};
///
/// let mut state = State::new([1.0], [0.0]);
/// StormerVerlet::new(1e-3)
///     .integrate(|_, q, _, qdd| qdd[0] = -q[0], 0.0, 1.0, &mut state, |_| ControlFlow::Continue(()))
///     .unwrap();
/// assert!((state.q[0] - 1.0_f64.cos()).abs() < 1e-7);
/// ```
///
/// # Source
/// E. Hairer, C. Lubich and G. Wanner, *Geometric numerical integration illustrated by the Störmer–Verlet method*, Acta
/// Numerica 12, 2003, formula 1.8.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StormerVerlet {
    /// The longest step, up to rounding \[s\]. The steps are equal and as many as needed, so that the last one ends
    /// where it should.
    pub step: f64,
    /// The number of steps allowed in one integration.
    pub max_steps: usize,
}

equal_steps! {
    StormerVerlet: |first|
    Work {
        a: core::array::from_fn(|_| first.q.clone()),
        half: first.qd.clone(),
        rounding: Compensation::new(first),
    }
}

/// What the steps of one integration work in.
struct Work<V> {
    /// The accelerations at the beginning and at the end.
    a: [V; 2],
    /// The velocity between the two kicks.
    half: V,
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
        let (h, half) = (V::Scalar::from_f64(length), V::Scalar::from_f64(0.5 * length));
        let (q, qd) = (old.q.as_slice(), old.qd.as_slice());
        let [a0, a1] = &mut self.a;
        for i in 0..q.len() {
            let kick = half * a0.as_slice()[i] + self.rounding.velocity(i);
            self.half.as_mut_slice()[i] = qd[i] + kick;
            // Not `h` times the velocity just rounded: that would be the largest rounding error of all.
            new.q.as_mut_slice()[i] = self.rounding.add_to_coordinate(i, q[i], h * qd[i] + h * kick);
        }
        system.evaluate(t + length, &new.q, &self.half, a1)?;
        for i in 0..q.len() {
            let kicks = half * (a0.as_slice()[i] + a1.as_slice()[i]);
            new.qd.as_mut_slice()[i] = self.rounding.add_to_velocity(i, qd[i], kicks);
        }
        if new.is_finite() { Ok(()) } else { Err(Fault::NonFinite) }
    }

    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        hermite::interpolate(span, [&self.a[0], &self.a[1]], theta, state);
    }
}
