//! The explicit Runge–Kutta method of order 8(5,3) by Dormand and Prince, with step control and dense output.
//!
//! Source: P. J. Prince and J. R. Dormand, *High order embedded Runge–Kutta formulae*, 1981, as modified in E. Hairer,
//! S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, section II.5 (formulas),
//! II.4 (step control, initial step), II.6 (dense output), and in their code DOP853.
//!
//! Where we differ from that code: the end of a step is evaluated before the step is accepted, so that a state without
//! an acceleration is never handed out; a step into infinities or NaN is rejected and shortened; the third-order error
//! is taken in the same norm over `q` and `q̇` together; the mass of details for Fortran's `IOUT`, stiffness and `NRD`
//! is left out.

use super::Acceleration;
use super::adaptive::{Control, Pair, Stages, weighted};
use super::run::{Fault, Method, Span, System};
use crate::scalar::{Real, Scalar};
use crate::state::{Coordinates, State};

mod tableau;

pub(super) use tableau::NODES;
use tableau::{A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A13, A14, A15, B, D4, D5, D6, D7, E3, E5};

/// The stages of a step, those of the dense output included.
const STAGES: usize = 16;
/// The stage at the end of the step, which is the first one of the next.
pub(super) const END: usize = 12;

/// Dormand and Prince's method of order 8 with error control: twelve evaluations a step, smooth problems, tight
/// tolerances.
///
/// The pair `(q, q̇)` is integrated as a system of `2N` equations of first order. A step is accepted if
///
/// ```text
/// error = |h| e₅² / √(e₅² + e₃²/100) ≤ 1,    eₖ² = mean of (errorₖ / scale)² over q and q̇,
/// scale = atol + rtol · max(|y₀|, |y₁|)
/// ```
///
/// with the errors of the embedded formulas of order 5 and 3, and the next one is `0.9 error^(β/5 − 1/8) previous^β`
/// times as long, from a third to six times, not longer right after a rejected step; `previous` is the error of the
/// step before, `1e-4` at least. `β = 0`, the default, makes it the elementary controller, `β > 0` a PI controller.
///
/// ```
/// use mbs_runtime::Dop853;
///
/// let integrator = Dop853::new(1e-9, 1e-12).with_max_step(0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Dop853 {
    /// Relative tolerance of each number in `q` and `q̇`, positive.
    pub rtol: f64,
    /// Absolute tolerance, positive, in the units of `q` and `q̇` alike.
    pub atol: f64,
    /// The length of the first step, positive \[s\]; `None` to have it chosen (Hairer, section II.4).
    pub first_step: Option<f64>,
    /// The shortest step that may be tried, the last one excepted \[s\]. Steps below the resolution of `t` (16 units in
    /// the last place) are not tried either way.
    pub min_step: f64,
    /// The longest step, up to rounding, positive and no shorter than the shortest one \[s\]; infinity for no limit.
    pub max_step: f64,
    /// The number of steps allowed in one integration, rejected ones included.
    pub max_steps: usize,
    /// `β` of the step control, from 0 to 0.1.
    pub beta: f64,
}

impl Dop853 {
    /// These tolerances; the first step chosen, no limits of the step, a million steps, `β = 0`.
    #[must_use]
    pub const fn new(rtol: f64, atol: f64) -> Self {
        let max_step = f64::INFINITY;
        Self { rtol, atol, first_step: None, min_step: 0.0, max_step, max_steps: 1_000_000, beta: 0.0 }
    }

    pub(super) fn control(&self) -> Control {
        let Self { rtol, atol, first_step, min_step, max_step, max_steps, beta } = *self;
        let alpha = 1.0 / 8.0 - 0.2 * beta;
        Control { rtol, atol, first_step, min_step, max_step, max_steps, beta, alpha, factors: [1.0 / 3.0, 6.0] }
    }
}

controlled_steps! {
    Dop853: |first, control|
    Work { sweep: Sweep::new(first, control), parts: core::array::from_fn(|_| first.clone()) }
}

/// What a step works in.
pub(super) struct Sweep<V: Coordinates> {
    pub(super) stages: Stages<V, STAGES, 2>,
}

impl<V: Coordinates> Sweep<V> {
    pub(super) fn new(like: &State<V>, control: &Control) -> Self {
        Self { stages: Stages::new(like, control) }
    }

    /// Stages 1 to 11 of a step of the length `h`, and its end; `at(s, q, q̇, q̈)` is the acceleration of stage `s`.
    #[inline(always)] // the rows are constants: with them in sight the sums unroll
    pub(super) fn step<E>(
        &mut self,
        mut at: impl FnMut(usize, &V, &V, &mut V) -> Result<(), E>,
        h: V::Scalar,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<(), E> {
        self.stages.stage(|q, qd, qdd| at(1, q, qd, qdd), h, old, 1, &A1)?;
        self.stages.stage(|q, qd, qdd| at(2, q, qd, qdd), h, old, 2, &A2)?;
        self.stages.stage(|q, qd, qdd| at(3, q, qd, qdd), h, old, 3, &A3)?;
        self.stages.stage(|q, qd, qdd| at(4, q, qd, qdd), h, old, 4, &A4)?;
        self.stages.stage(|q, qd, qdd| at(5, q, qd, qdd), h, old, 5, &A5)?;
        self.stages.stage(|q, qd, qdd| at(6, q, qd, qdd), h, old, 6, &A6)?;
        self.stages.stage(|q, qd, qdd| at(7, q, qd, qdd), h, old, 7, &A7)?;
        self.stages.stage(|q, qd, qdd| at(8, q, qd, qdd), h, old, 8, &A8)?;
        self.stages.stage(|q, qd, qdd| at(9, q, qd, qdd), h, old, 9, &A9)?;
        self.stages.stage(|q, qd, qdd| at(10, q, qd, qdd), h, old, 10, &A10)?;
        self.stages.stage(|q, qd, qdd| at(11, q, qd, qdd), h, old, 11, &A11)?;
        self.stages.finish(h, old, &B, new);
        Ok(())
    }

    /// The error of the step in units of the tolerance: of order 5, damped where the one of order 3 is larger.
    #[inline(always)]
    pub(super) fn error(&mut self, h: V::Scalar, old: &State<V>, new: &State<V>) -> V::Scalar {
        let [fifth, third] = self.stages.squares([&E5, &E3], old, new);
        let damped = fifth + V::Scalar::from_f64(0.01) * third;
        let count = V::Scalar::from_f64(2.0 * old.q.as_slice().len() as f64);
        let error = h.abs() * fifth / (damped * count).sqrt();
        V::Scalar::blend(damped.equal(V::Scalar::zero()), damped, error)
    }
}

/// What the steps of one integration work in.
struct Work<V: Coordinates> {
    sweep: Sweep<V>,
    /// The parts of the dense output, `r₁` to `r₇`.
    parts: [State<V>; 7],
}

impl<V: Coordinates<Scalar: Real>> Method<V> for Work<V> {
    type Error = V::Scalar;

    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.sweep.stages.begin(system, t, state)
    }

    #[inline]
    fn proceed<F: Acceleration<V>>(
        &mut self,
        _: &mut System<F>,
        _: f64,
        _: &State<V>,
        _: bool,
    ) -> Result<(), Fault<F::Error>> {
        self.sweep.stages.proceed(END);
        Ok(())
    }

    /// All stages of a step, its end, finite, and its error in units of the tolerance.
    fn advance<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<V::Scalar, Fault<F::Error>> {
        let h = V::Scalar::from_f64(length);
        self.sweep.step(|s, q, qd, qdd| system.evaluate(t + NODES[s] * length, q, qd, qdd), h, old, new)?;
        let error = self.sweep.error(h, old, new);
        // An error that overflows, under absurd tolerances, is a large one: the step is rejected and shortened.
        if !new.is_finite() {
            return Err(Fault::NonFinite);
        }
        if error <= V::Scalar::one() {
            self.sweep.stages.end(system, t + length, new, END)?;
        }
        Ok(error)
    }

    /// `r₁ = Δy`, `r₂ = h y₀' − Δy`, `r₃ = 2Δy − h (y₀' + y₁')`, `r₄ … r₇ = h Σ d k`.
    fn prepare<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        span: &Span<'_, V>,
    ) -> Result<(), Fault<F::Error>> {
        let Span { start, end, old, new } = *span;
        let length = end - start;
        let h = V::Scalar::from_f64(length);
        let stages = &mut self.sweep.stages;
        let mut at = |s: usize, q: &V, qd: &V, qdd: &mut V| system.evaluate(start + NODES[s] * length, q, qd, qdd);
        stages.stage(|q, qd, qdd| at(13, q, qd, qdd), h, old, 13, &A13)?;
        stages.stage(|q, qd, qdd| at(14, q, qd, qdd), h, old, 14, &A14)?;
        stages.stage(|q, qd, qdd| at(15, q, qd, qdd), h, old, 15, &A15)?;
        for (slopes, y0, y1, part) in [
            (&stages.v, &old.q, &new.q, (|state| &mut state.q) as fn(&mut State<V>) -> &mut V),
            (&stages.a, &old.qd, &new.qd, |state| &mut state.qd),
        ] {
            let (y0, y1) = (y0.as_slice(), y1.as_slice());
            let parts = self.parts.each_mut().map(|state| part(state).as_mut_slice());
            for i in 0..y0.len() {
                let rise = y1[i] - y0[i];
                let first = h * slopes[0].as_slice()[i] - rise;
                parts[0][i] = rise;
                parts[1][i] = first;
                parts[2][i] = rise - h * slopes[END].as_slice()[i] - first;
                parts[3][i] = h * weighted(&D4, slopes, i);
                parts[4][i] = h * weighted(&D5, slopes, i);
                parts[5][i] = h * weighted(&D6, slopes, i);
                parts[6][i] = h * weighted(&D7, slopes, i);
            }
        }
        Ok(())
    }

    /// `y₀ + θ (r₁ + (1−θ) (r₂ + θ (r₃ + (1−θ) (r₄ + θ (r₅ + (1−θ) (r₆ + θ r₇))))))`.
    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        let rest = V::Scalar::one() - theta;
        let at = |y0: V::Scalar, r: [V::Scalar; 7]| {
            let inner = r[3] + theta * (r[4] + rest * (r[5] + theta * r[6]));
            y0 + theta * (r[0] + rest * (r[1] + theta * (r[2] + rest * inner)))
        };
        let (q, qd) = (state.q.as_mut_slice(), state.qd.as_mut_slice());
        let parts = self.parts.each_ref().map(|part| (part.q.as_slice(), part.qd.as_slice()));
        for i in 0..q.len() {
            q[i] = at(span.old.q.as_slice()[i], parts.map(|(part, _)| part[i]));
            qd[i] = at(span.old.qd.as_slice()[i], parts.map(|(_, part)| part[i]));
        }
    }
}

impl<V: Coordinates<Scalar: Real>> Pair<V> for Work<V> {
    fn initial_step<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        direction: f64,
        longest: f64,
        state: &State<V>,
    ) -> f64 {
        self.sweep.stages.initial_step(system, t, direction, longest, state, 8.0)
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;
    use crate::{IntegrationError, Integrator, Step};
    use core::ops::ControlFlow;

    const TAU: f64 = core::f64::consts::TAU;

    fn go_on<V: Coordinates>(_: &mut dyn Step<V>) -> ControlFlow<f64> {
        ControlFlow::Continue(())
    }

    /// `r̈ = −r/|r|³` in the plane.
    fn kepler<T: Scalar>(_: T, q: &[T; 2], _: &[T; 2], qdd: &mut [T; 2]) {
        let squared = q[0] * q[0] + q[1] * q[1];
        let cubed = squared * squared.sqrt();
        *qdd = [-q[0] / cubed, -q[1] / cubed];
    }

    /// Periapsis of an orbit of semi-major axis 1; its period is 2π.
    fn periapsis(eccentricity: f64) -> State<[f64; 2]> {
        let speed = Scalar::sqrt((1.0 + eccentricity) / (1.0 - eccentricity));
        State::new([1.0 - eccentricity, 0.0], [0.0, speed])
    }

    fn distance(a: &State<[f64; 2]>, b: &State<[f64; 2]>) -> f64 {
        let differences = [a.q[0] - b.q[0], a.q[1] - b.q[1], a.qd[0] - b.qd[0], a.qd[1] - b.qd[1]];
        differences.into_iter().fold(0.0, |largest, x: f64| largest.max(x.abs()))
    }

    /// Steps of the length `h` only, whatever their error.
    fn fixed(h: f64) -> Dop853 {
        Dop853 { first_step: Some(h), max_step: h, ..Dop853::new(1e9, 1e9) }
    }

    /// The errors of a linear oscillator, forced: at the end, and within a step.
    fn errors(h: f64) -> [f64; 2] {
        // q = cos t + sin(2t)/2 solves q̈ = −q − (3/2) sin 2t.
        let forced = |t: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| {
            qdd[0] = -q[0] - 1.5 * Scalar::sin(2.0 * t);
        };
        let exact = |t: f64| Scalar::cos(t) + 0.5 * Scalar::sin(2.0 * t);
        let mut state = State::new([1.0], [1.0]);
        let mut within: f64 = 0.0;
        fixed(h)
            .integrate(forced, 0.0, 4.0, &mut state, |step| {
                for theta in [0.2, 0.35, 0.5, 0.65, 0.8] {
                    let t = step.previous_time() + theta * (step.time() - step.previous_time());
                    let mut there = State::default();
                    step.interpolate(t, &mut there).unwrap();
                    // Leave out the error at the beginning of the step: it is of order 8.
                    let carried = step.previous_state().q[0] - exact(step.previous_time());
                    within = within.max((there.q[0] - exact(t) - carried).abs());
                }
                ControlFlow::Continue(())
            })
            .unwrap();
        [(state.q[0] - exact(4.0)).abs(), within]
    }

    #[test]
    fn the_order_is_eight_and_seven_between() {
        let (coarse, fine) = (errors(0.5), errors(0.25));
        let orders = [0, 1].map(|i| Scalar::ln(coarse[i] / fine[i]) / core::f64::consts::LN_2);
        assert!((7.6..9.3).contains(&orders[0]), "orders {orders:?}");
        // A polynomial of order 7 deviates by h⁸ within one step.
        assert!((7.5..8.7).contains(&orders[1]), "orders {orders:?}");
    }

    #[test]
    fn an_eccentric_orbit_closes() {
        // SciPy 1.17 ends 2.396e-3, 2.525e-6 and 1.57e-9 away, after 73, 153 and 335 steps.
        for (tolerance, allowed, steps) in [(1e-6, 2.4e-3, 73), (1e-9, 2.6e-6, 153), (1e-12, 1.6e-9, 335)] {
            let initial = periapsis(0.6);
            let mut state = initial;
            let dop853 = Dop853::new(tolerance, tolerance);
            let summary = dop853.integrate(kepler, 0.0, 5.0 * TAU, &mut state, go_on).unwrap();
            assert!(distance(&state, &initial) < allowed, "{tolerance}: {}", distance(&state, &initial));
            assert_eq!(summary.time, 5.0 * TAU);
            assert!(summary.accepted.abs_diff(steps) <= 2, "{summary:?}");
            // And back again, with the error of the way there and as much of its own, amplified by the orbit.
            dop853.integrate(kepler, 5.0 * TAU, 0.0, &mut state, go_on).unwrap();
            assert!(distance(&state, &initial) < 4.0 * allowed, "{tolerance}: {}", distance(&state, &initial));
        }
    }

    #[test]
    fn energy_stays() {
        let energy = |s: &State<[f64; 2]>| {
            0.5 * (s.qd[0] * s.qd[0] + s.qd[1] * s.qd[1]) - 1.0 / Scalar::sqrt(s.q[0] * s.q[0] + s.q[1] * s.q[1])
        };
        let mut state = periapsis(0.3);
        let initial = energy(&state);
        let mut drift: f64 = 0.0;
        Dop853::new(1e-13, 1e-14)
            .integrate(kepler, 0.0, 100.0 * TAU, &mut state, |step| {
                drift = drift.max((energy(step.state()) - initial).abs());
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!(drift < 1e-11, "{drift}");
    }

    #[test]
    fn work_is_what_the_method_promises() {
        let mut state = State::new([1.0], [0.0]);
        let summary = Dop853::new(1e-10, 1e-12)
            .integrate(|_, q: &[f64; 1], _, qdd: &mut [f64; 1]| qdd[0] = -q[0], 0.0, 10.0 * TAU, &mut state, go_on)
            .unwrap();
        assert!((state.q[0] - 1.0).abs() < 1e-8);
        // SciPy 1.17 takes as many.
        assert_eq!((summary.accepted, summary.evaluations), (198, 2378));
        // Two for the first step, twelve for each other, eleven for a rejected one.
        assert_eq!(summary.evaluations, 2 + 12 * summary.accepted + 11 * summary.rejected);
        assert!(summary.next_step > 0.1 && summary.next_step < 5.0);
    }

    #[test]
    fn single_precision() {
        let initial = periapsis(0.3);
        let mut state = State::new(initial.q.map(|x| x as f32), initial.qd.map(|x| x as f32));
        // Tolerances that single precision rounds to zero or infinity are refused.
        for (rtol, atol) in [(1e-6, 1e-46), (1e-46, 1e-6), (1e-6, 1e39)] {
            let refused = Dop853::new(rtol, atol).integrate(kepler, 0.0, TAU, &mut state, go_on);
            let expected = IntegrationError::InvalidTolerance { relative: rtol, absolute: atol };
            assert_eq!(refused, Err(expected));
        }
        Dop853::new(1e-5, 1e-5).integrate(kepler, 0.0, TAU, &mut state, go_on).unwrap();
        let state = State::new(state.q.map(f64::from), state.qd.map(f64::from));
        assert!(distance(&state, &initial) < 1e-3, "{state:?}");
    }

    #[test]
    fn steps_keep_within_limits() {
        let mut state = periapsis(0.6);
        let limited = Dop853 { max_step: 0.05, ..Dop853::new(1e-6, 1e-6) };
        let summary = limited
            .integrate(kepler, 0.0, 3.0, &mut state, |step| {
                assert!(step.time() - step.previous_time() <= 0.05 * (1.0 + 1e-8));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!((60..65).contains(&summary.accepted), "{summary:?}");
        let hurried = Dop853 { min_step: 1.0, ..Dop853::new(1e-12, 1e-12) };
        let result = hurried.integrate(kepler, 0.0, 6.0, &mut periapsis(0.6), go_on);
        assert_eq!(result, Err(IntegrationError::StepTooSmall { time: 0.0, step: 1.0 }));
        let few = Dop853 { max_steps: 10, ..Dop853::new(1e-12, 1e-12) };
        let result = few.integrate(kepler, 0.0, 6.0, &mut periapsis(0.6), go_on);
        assert!(matches!(result, Err(IntegrationError::TooManySteps { steps: 10, time }) if time > 0.0));
    }

    /// Between limits that leave no step, and where the clock cannot tell the longest one.
    #[test]
    fn limits_that_contradict_each_other_are_refused() {
        let drift = |_: f64, _: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = 0.0;
        let go = |dop853: Dop853, t: f64, t_end: f64| {
            dop853.integrate(drift, t, t_end, &mut State::new([0.0], [1.0]), |step| {
                assert!((t..=t_end).contains(&step.time()), "{}", step.time());
                ControlFlow::Continue(())
            })
        };
        let good = Dop853::new(1e-3, 1e-3);
        let crossed = Dop853 { min_step: 1.0, max_step: 0.1, max_steps: 1000, ..good };
        assert_eq!(go(crossed, 0.0, 2.5), Err(IntegrationError::InvalidStep { step: 1.0 }));
        // 16 units in the last place are 6e-6 s after 54 years, and more than those of 1 s right after it.
        let unit = 16.0 * f64::EPSILON;
        let (short, shorter) = (Dop853 { max_step: 1e-6, ..good }, Dop853 { max_step: unit, ..good });
        assert_eq!(go(short, 1.7e9, 1.7e9 + 2e-5), Err(IntegrationError::InvalidStep { step: 1e-6 }));
        let too_small = IntegrationError::StepTooSmall { time: 1.0 + unit, step: unit };
        assert_eq!(go(shorter, 1.0, 1.0 + 1e-10), Err(too_small));
        assert_eq!(go(Dop853 { min_step: 0.5, max_step: 0.5, ..good }, 0.0, 2.0).unwrap().time, 2.0);
    }

    #[test]
    fn bad_settings_are_refused() {
        let go = |dop853: Dop853| dop853.integrate(kepler, 0.0, 1.0, &mut periapsis(0.1), go_on).unwrap_err();
        for bad in [0.0, -1e-9, f64::NAN, f64::INFINITY] {
            assert!(matches!(go(Dop853::new(bad, 1e-9)), IntegrationError::InvalidTolerance { .. }));
            assert!(matches!(go(Dop853::new(1e-9, bad)), IntegrationError::InvalidTolerance { .. }));
            let good = Dop853::new(1e-9, 1e-9);
            let first_step = Some(bad);
            assert!(matches!(go(Dop853 { first_step, ..good }), IntegrationError::InvalidStep { .. }));
            if bad != 0.0 {
                assert!(matches!(go(Dop853 { min_step: bad, ..good }), IntegrationError::InvalidStep { .. }));
            }
            if bad != f64::INFINITY {
                assert!(matches!(go(Dop853 { max_step: bad, ..good }), IntegrationError::InvalidStep { .. }));
            }
        }
    }

    #[test]
    fn a_collision_is_an_error_and_not_a_hang() {
        // Falls into the centre at t = π/√8, where the acceleration is infinite.
        let mut state = State::new([1.0, 0.0], [0.0, 0.0]);
        let error = Dop853::new(1e-10, 1e-12).integrate(kepler, 0.0, 2.0, &mut state, go_on).unwrap_err();
        let time = error.time().unwrap();
        assert!((time - core::f64::consts::PI / Scalar::sqrt(8.0)).abs() < 1e-6, "{error}");
        assert!(state.is_finite() && state.q[0].abs() < 1e-3);
    }

    #[test]
    fn tolerances_below_rounding_end() {
        let dop853 = Dop853 { max_steps: 20_000, ..Dop853::new(1e-30, 1e-30) };
        let result = dop853.integrate(kepler, 1.0, 2.0, &mut periapsis(0.5), go_on);
        assert!(result.is_err());
    }

    #[test]
    fn interpolation_costs_three_evaluations() {
        let count = |watch: bool| {
            Dop853::new(1e-9, 1e-9)
                .integrate(kepler, 0.0, 5.0, &mut periapsis(0.3), |step| {
                    if watch {
                        for theta in [0.1, 0.9] {
                            let t = step.previous_time() + theta * (step.time() - step.previous_time());
                            step.interpolate(t, &mut periapsis(0.0)).unwrap();
                        }
                    }
                    ControlFlow::Continue(())
                })
                .unwrap()
        };
        let (watched, alone) = (count(true), count(false));
        assert_eq!(watched.accepted, alone.accepted);
        assert_eq!(watched.evaluations, alone.evaluations + 3 * alone.accepted);
    }

    #[test]
    fn the_motion_without_coordinates_goes_on() {
        let mut state = State::new([0.0_f64; 0], []);
        let summary = Dop853::new(1e-9, 1e-9).integrate(|_, _, _, _| {}, 0.0, 1.0, &mut state, go_on).unwrap();
        assert_eq!(summary.time, 1.0);
    }
}
