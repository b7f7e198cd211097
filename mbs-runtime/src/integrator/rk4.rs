//! The classical Runge–Kutta method of order 4, with a fixed step.
//!
//! ```text
//!  0  |
//! 1/2 | 1/2
//! 1/2 |  0   1/2
//!  1  |  0    0    1
//! ----+--------------------
//!     | 1/6  1/3  1/3  1/6
//! ```
//!
//! Source: W. Kutta, *Beitrag zur näherungsweisen Integration totaler Differentialgleichungen*, 1901; E. Hairer, S. P.
//! Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, table II.1.2. Between the ends of
//! a step: cubic Hermite polynomials.

use super::run::{Fault, Method, Span, System};
use super::{Acceleration, Outcome, hermite};
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// The classical Runge–Kutta method of order 4: four evaluations in a step of fixed length.
///
/// No error control, no branches: right for real time, and for lanes, which have to go in step. [`Rk4Stepper`] makes
/// single steps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rk4 {
    /// The longest step, up to rounding \[s\]. The steps are equal and as many as needed, so that the last one ends
    /// where it should.
    pub step: f64,
    /// The number of steps allowed in one integration.
    pub max_steps: usize,
}

equal_steps! { Rk4: |first| Rk4Stepper::new(first) }

/// What single steps of [`Rk4`] work in; made once, nothing is allocated in a step.
///
/// ```
/// use mbs_runtime::{Rk4Stepper, State};
///
/// let mut state = State::new([1.0_f32], [0.0]);
/// let mut stepper = Rk4Stepper::new(&state);
/// for i in 0..100 {
///     stepper.step(|_, q, _, qdd| qdd[0] = -q[0], 0.01 * i as f32, 0.01, &mut state).unwrap();
/// }
/// assert!((state.q[0] - 1.0_f32.cos()).abs() < 1e-6);
/// ```
#[derive(Clone, Debug)]
pub struct Rk4Stepper<V> {
    /// The accelerations of the four stages, and the one at the end of the step where it was asked for.
    k: [V; 5],
    /// The velocities of the stages after the first.
    v: [V; 3],
    /// The coordinates of the stage at hand.
    q: V,
}

impl<V: Coordinates> Rk4Stepper<V> {
    /// Room for mechanisms with as many coordinates as `like` has.
    #[must_use]
    pub fn new(like: &State<V>) -> Self {
        Self {
            k: core::array::from_fn(|_| like.q.clone()),
            v: core::array::from_fn(|_| like.q.clone()),
            q: like.q.clone(),
        }
    }

    /// Carries `state` from the time `t` to `t + h` in one step. `h` may be negative.
    ///
    /// # Errors
    /// Those of `acceleration`; `state` is then untouched. Numbers that are not finite are
    /// not looked for: [`State::is_finite`] does.
    pub fn step<F, R>(
        &mut self,
        mut acceleration: F,
        t: V::Scalar,
        h: V::Scalar,
        state: &mut State<V>,
    ) -> Result<(), R::Error>
    where
        F: FnMut(V::Scalar, &V, &V, &mut V) -> R,
        R: Outcome,
    {
        acceleration(t, &state.q, &state.qd, &mut self.k[0]).into_result()?;
        let middle = t + V::Scalar::from_f64(0.5) * h;
        self.stages(h, state, |stage, q, qd, qdd| {
            acceleration(if stage == 3 { t + h } else { middle }, q, qd, qdd).into_result()
        })?;
        self.finish(h, state);
        Ok(())
    }

    /// A step of the length `h` from `old` to `new`, by right-hand sides that do not refuse.
    #[cfg(feature = "std")]
    pub(super) fn step_with(
        &mut self,
        h: V::Scalar,
        old: &State<V>,
        new: &mut State<V>,
        mut evaluate: impl FnMut(usize, &V, &V, &mut V),
    ) {
        evaluate(0, &old.q, &old.qd, &mut self.k[0]);
        let Ok(()) = self.stages::<core::convert::Infallible>(h, old, |stage, q, qd, qdd| {
            evaluate(stage, q, qd, qdd);
            Ok(())
        });
        new.copy_from(old);
        self.finish(h, new);
    }

    /// Stages 1 to 3 from stage 0.
    #[inline]
    fn stages<E>(
        &mut self,
        h: V::Scalar,
        old: &State<V>,
        mut evaluate: impl FnMut(usize, &V, &V, &mut V) -> Result<(), E>,
    ) -> Result<(), E> {
        let half = V::Scalar::from_f64(0.5) * h;
        for stage in 1..4 {
            let length = if stage == 3 { h } else { half };
            let (known, rest) = self.v.split_at_mut(stage - 1);
            let velocity = known.last().unwrap_or(&old.qd);
            advance(&mut self.q, &old.q, length, velocity);
            advance(&mut rest[0], &old.qd, length, &self.k[stage - 1]);
            evaluate(stage, &self.q, &rest[0], &mut self.k[stage])?;
        }
        Ok(())
    }

    /// `y + h/6 (k₁ + 2 k₂ + 2 k₃ + k₄)` in place.
    #[inline]
    fn finish(&self, h: V::Scalar, state: &mut State<V>) {
        let sixth = h / V::Scalar::from_f64(6.0);
        let [k1, k2, k3, k4, _] = self.k.each_ref().map(V::as_slice);
        let [v2, v3, v4] = self.v.each_ref().map(V::as_slice);
        let (q, qd) = (state.q.as_mut_slice(), state.qd.as_mut_slice());
        for i in 0..q.len() {
            let (v, k) = (v2[i] + v3[i], k2[i] + k3[i]);
            q[i] = q[i] + sixth * (qd[i] + v + v + v4[i]);
            qd[i] = qd[i] + sixth * (k1[i] + k + k + k4[i]);
        }
    }
}

/// `base + h · slope`.
#[inline]
fn advance<V: Coordinates>(out: &mut V, base: &V, h: V::Scalar, slope: &V) {
    let (out, base, slope) = (out.as_mut_slice(), base.as_slice(), slope.as_slice());
    for i in 0..out.len() {
        out[i] = base[i] + h * slope[i];
    }
}

impl<V: Coordinates> Method<V> for Rk4Stepper<V> {
    type Error = ();

    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        system.evaluate(t, &state.q, &state.qd, &mut self.k[0])
    }

    fn proceed<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
        prepared: bool,
    ) -> Result<(), Fault<F::Error>> {
        if prepared {
            self.k.swap(0, 4);
            return Ok(());
        }
        self.begin(system, t, state)
    }

    fn advance<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.stages(V::Scalar::from_f64(length), old, |stage, q, qd, qdd| {
            system.evaluate(if stage == 3 { t + length } else { t + 0.5 * length }, q, qd, qdd)
        })?;
        new.copy_from(old);
        self.finish(V::Scalar::from_f64(length), new);
        if new.is_finite() { Ok(()) } else { Err(Fault::NonFinite) }
    }

    fn prepare<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        span: &Span<'_, V>,
    ) -> Result<(), Fault<F::Error>> {
        system.evaluate(span.end, &span.new.q, &span.new.qd, &mut self.k[4])
    }

    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        hermite::interpolate(span, [&self.k[0], &self.k[4]], theta, state);
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
    use crate::{IntegrationError, Integrator, Step};
    use core::ops::ControlFlow;

    fn go_on<V: Coordinates>(_: &mut dyn Step<V>) -> ControlFlow<f64> {
        ControlFlow::Continue(())
    }

    fn forced(t: f64, q: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]) {
        qdd[0] = -q[0] + 0.2 * qd[0] + t.sin();
    }

    /// `q̈ = −q + q̇/5 + sin t` as exactly as numbers allow.
    fn exact(t: f64) -> State<[f64; 1]> {
        let mut state = State::new([1.0], [0.3]);
        crate::Dop853::new(1e-14, 1e-15).integrate(forced, 0.0, t, &mut state, go_on).unwrap();
        state
    }

    /// The errors of `q` and `q̇` with the step `h`: at `t = 2`, and within the step that begins at `t = 1`.
    fn errors(h: f64) -> [f64; 4] {
        let mut state = State::new([1.0], [0.3]);
        let mut within = state;
        let inside = 1.0 + 0.4 * h;
        Rk4::new(h)
            .integrate(forced, 0.0, 2.0, &mut state, |step| {
                if step.previous_time() < inside && inside < step.time() {
                    step.interpolate(inside, &mut within).unwrap();
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        let (end, there) = (exact(2.0), exact(inside));
        [state.q[0] - end.q[0], state.qd[0] - end.qd[0], within.q[0] - there.q[0], within.qd[0] - there.qd[0]]
    }

    #[test]
    fn the_order_is_four() {
        let (coarse, fine) = (errors(0.05), errors(0.025));
        for i in 0..4 {
            let order = (coarse[i] / fine[i]).abs().log2();
            assert!((order - 4.0).abs() < 0.35, "order {order} of error {i}");
        }
    }

    #[test]
    fn steps_end_where_they_should() {
        for (step, t_end, accepted) in
            [(0.1, 0.3, 3), (0.1, 1.0, 10), (0.2, 0.3, 2), (1e9, 0.3, 1), (f64::INFINITY, 1.0, 1), (0.1, -0.7, 7)]
        {
            let mut state = State::new([1.0], [0.0]);
            let summary = Rk4::new(step)
                .integrate(|_, q: &[f64; 1], _, qdd: &mut [f64; 1]| qdd[0] = -q[0], 0.0, t_end, &mut state, go_on)
                .unwrap();
            assert_eq!((summary.time, summary.accepted), (t_end, accepted));
            assert_eq!(summary.evaluations, 4 * accepted);
        }
    }

    #[test]
    fn bad_steps_are_refused() {
        for step in [0.0, -1.0, f64::NAN] {
            let result = Rk4::new(step).integrate(
                |_, _: &[f64; 1], _, qdd: &mut [f64; 1]| qdd[0] = 0.0,
                0.0,
                1.0,
                &mut State::default(),
                go_on,
            );
            assert!(matches!(result, Err(IntegrationError::InvalidStep { .. })));
        }
        for step in [1e-300, f64::MIN_POSITIVE / 8.0] {
            let result = Rk4::new(step).integrate(
                |_, _: &[f64; 1], _, qdd: &mut [f64; 1]| qdd[0] = 0.0,
                0.0,
                1.0,
                &mut State::default(),
                go_on,
            );
            let most = usize::try_from(1_u64 << 53).unwrap_or(usize::MAX);
            assert_eq!(result, Err(IntegrationError::TooManySteps { time: 0.0, steps: most }));
        }
    }

    #[test]
    fn the_end_of_a_step_is_evaluated_once() {
        let mut state = State::new([1.0], [0.0]);
        let pull = |_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -q[0];
        let watched = Rk4::new(0.1)
            .integrate(pull, 0.0, 1.0, &mut state, |step| {
                let mut there = State::default();
                step.interpolate(0.5 * (step.time() + step.previous_time()), &mut there).unwrap();
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(watched.evaluations, 41);
        let mut alone = State::new([1.0], [0.0]);
        Rk4::new(0.1).integrate(pull, 0.0, 1.0, &mut alone, go_on).unwrap();
        assert_eq!(state, alone);
    }

    #[test]
    fn a_single_step_is_a_step_of_the_integrator() {
        let pull = |t: f64, q: &[f64; 2], qd: &[f64; 2], qdd: &mut [f64; 2]| {
            *qdd = [-q[0] * q[1] + t, -q[1] + qd[0]];
        };
        let initial = State::new([1.0, 0.5], [0.0, -0.3]);
        let (mut single, mut whole) = (initial, initial);
        Rk4Stepper::new(&single).step(pull, 0.5, 0.25, &mut single).unwrap();
        Rk4::new(0.25).integrate(pull, 0.5, 0.75, &mut whole, go_on).unwrap();
        assert_eq!(single, whole);
    }

    #[cfg(feature = "wide")]
    #[test]
    fn lanes_are_four_runs_at_once() {
        use wide::f64x4;
        let starts = [0.1, -0.4, 1.2, 2.9];
        let mut lanes = State::new([f64x4::from(starts)], [f64x4::zero()]);
        let pendulum = |_, q: &[f64x4; 1], _: &_, qdd: &mut [f64x4; 1]| qdd[0] = -Scalar::sin(q[0]);
        Rk4::new(0.01).integrate(pendulum, 0.0, 3.0, &mut lanes, go_on).unwrap();
        for (lane, start) in starts.into_iter().enumerate() {
            let mut one = State::new([start], [0.0]);
            let pendulum = |_, q: &[f64; 1], _: &_, qdd: &mut [f64; 1]| qdd[0] = -q[0].sin();
            Rk4::new(0.01).integrate(pendulum, 0.0, 3.0, &mut one, go_on).unwrap();
            assert!((lanes.q[0].to_array()[lane] - one.q[0]).abs() < 1e-13);
        }
    }
}
