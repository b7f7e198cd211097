//! The explicit Runge–Kutta method of order 5(4) by Dormand and Prince, with step control and dense output.
//!
//! ```text
//!   0  |
//!  1/5 |     1/5
//! 3/10 |    3/40         9/40
//!  4/5 |   44/45       −56/15        32/9
//!  8/9 | 19372/6561 −25360/2187  64448/6561  −212/729
//!   1  |  9017/3168   −355/33    46732/5247    49/176  −5103/18656
//!   1  |    35/384       0         500/1113   125/192   −2187/6784    11/84
//! -----+----------------------------------------------------------------------
//!      |    35/384       0         500/1113   125/192   −2187/6784    11/84      0
//!      |  5179/57600     0        7571/16695  393/640 −92097/339200  187/2100  1/40
//! ```
//!
//! Source: J. R. Dormand and P. J. Prince, *A family of embedded Runge–Kutta formulae*, 1980; E. Hairer, S. P. Nørsett
//! and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, table II.5.2, and, for the dense output of
//! order 4 by Shampine, section II.6 and their code DOPRI5.

use super::Acceleration;
use super::adaptive::{Control, Pair, Stages, Weight, weighted};
use super::run::{Fault, Method, Span, System};
use crate::scalar::{Real, Scalar};
use crate::state::{Coordinates, State};

/// The stages of a step; the last one is the end of the step and the first one of the next.
const STAGES: usize = 7;
const END: usize = 6;

/// The nodes `c` of the stages.
const NODES: [f64; STAGES] = [0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0];

/// Rows of `a`.
const A1: [Weight; 1] = [(0, 1.0 / 5.0)];
const A2: [Weight; 2] = [(0, 3.0 / 40.0), (1, 9.0 / 40.0)];
const A3: [Weight; 3] = [(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)];
const A4: [Weight; 4] = [(0, 19372.0 / 6561.0), (1, -25360.0 / 2187.0), (2, 64448.0 / 6561.0), (3, -212.0 / 729.0)];
const A5: [Weight; 5] =
    [(0, 9017.0 / 3168.0), (1, -355.0 / 33.0), (2, 46732.0 / 5247.0), (3, 49.0 / 176.0), (4, -5103.0 / 18656.0)];

/// The weights `b` of the solution, which are the last row of `a`.
const B: [Weight; 5] =
    [(0, 35.0 / 384.0), (2, 500.0 / 1113.0), (3, 125.0 / 192.0), (4, -2187.0 / 6784.0), (5, 11.0 / 84.0)];

/// The error `b − b̂`.
const E: [Weight; 6] = [
    (0, 71.0 / 57600.0),
    (2, -71.0 / 16695.0),
    (3, 71.0 / 1920.0),
    (4, -17253.0 / 339200.0),
    (5, 22.0 / 525.0),
    (6, -1.0 / 40.0),
];

/// The last part of the dense output.
const D: [Weight; 6] = [
    (0, -12715105075.0 / 11282082432.0),
    (2, 87487479700.0 / 32700410799.0),
    (3, -10690763975.0 / 1880347072.0),
    (4, 701980252875.0 / 199316789632.0),
    (5, -1453857185.0 / 822651844.0),
    (6, 69997945.0 / 29380423.0),
];

/// Dormand and Prince's method of order 5 with error control: six evaluations a step, moderate tolerances, dense output
/// for nothing.
///
/// The pair `(q, q̇)` is integrated as a system of `2N` equations of first order. A step is accepted if
///
/// ```text
/// error = √(mean of (h Σ (b − b̂) k / scale)² over q and q̇) ≤ 1,    scale = atol + rtol · max(|y₀|, |y₁|)
/// ```
///
/// with the embedded formula of order 4, and the next one is `0.9 error^(3β/4 − 1/5) previous^β` times as long, from a
/// fifth to ten times, not longer right after a rejected step; `previous` is the error of the step before, `1e-4` at
/// least. This is the PI controller of Gustafsson; `β = 0` makes it the elementary one.
///
/// ```
/// use mbs_runtime::Dopri5;
///
/// let integrator = Dopri5::new(1e-6, 1e-9).with_max_step(0.5);
/// ```
///
/// # Source
/// J. R. Dormand and P. J. Prince, *A family of embedded Runge–Kutta formulae*, Journal of Computational and Applied
/// Mathematics 6, 1980, table 2; E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*,
/// 2nd ed. 1993, sections II.4 to II.6.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Dopri5 {
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
    /// `β` of the step control, from 0 to 0.11.
    pub beta: f64,
}

impl Dopri5 {
    /// These tolerances; the first step chosen, no limits of the step, a million steps, `β = 0.04`.
    #[must_use]
    pub const fn new(rtol: f64, atol: f64) -> Self {
        let max_step = f64::INFINITY;
        Self { rtol, atol, first_step: None, min_step: 0.0, max_step, max_steps: 1_000_000, beta: 0.04 }
    }

    fn control(&self) -> Control {
        let Self { rtol, atol, first_step, min_step, max_step, max_steps, beta } = *self;
        let alpha = 1.0 / 5.0 - 0.75 * beta;
        Control { rtol, atol, first_step, min_step, max_step, max_steps, beta, alpha, factors: [0.2, 10.0] }
    }
}

controlled_steps! {
    Dopri5: |first, control|
    Work { stages: Stages::new(first, control), parts: core::array::from_fn(|_| first.clone()) }
}

/// What the steps of one integration work in.
struct Work<V: Coordinates> {
    stages: Stages<V, STAGES, 1>,
    /// The parts of the dense output, `r₁` to `r₄`.
    parts: [State<V>; 4],
}

impl<V: Coordinates<Scalar: Real>> Method<V> for Work<V> {
    type Error = V::Scalar;

    fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.stages.begin(system, t, state)
    }

    fn proceed<F: Acceleration<V>>(
        &mut self,
        _: &mut System<F>,
        _: f64,
        _: &State<V>,
        _: bool,
    ) -> Result<(), Fault<F::Error>> {
        self.stages.proceed(END);
        Ok(())
    }

    fn advance<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        length: f64,
        old: &State<V>,
        new: &mut State<V>,
    ) -> Result<V::Scalar, Fault<F::Error>> {
        let h = V::Scalar::from_f64(length);
        let mut at = |s: usize, q: &V, qd: &V, qdd: &mut V| system.evaluate(t + NODES[s] * length, q, qd, qdd);
        self.stages.stage(|q, qd, qdd| at(1, q, qd, qdd), h, old, 1, &A1)?;
        self.stages.stage(|q, qd, qdd| at(2, q, qd, qdd), h, old, 2, &A2)?;
        self.stages.stage(|q, qd, qdd| at(3, q, qd, qdd), h, old, 3, &A3)?;
        self.stages.stage(|q, qd, qdd| at(4, q, qd, qdd), h, old, 4, &A4)?;
        self.stages.stage(|q, qd, qdd| at(5, q, qd, qdd), h, old, 5, &A5)?;
        self.stages.finish(h, old, &B, new);
        if !new.is_finite() {
            return Err(Fault::NonFinite);
        }
        self.stages.end(system, t + length, new, END)?;
        let [square] = self.stages.squares([&E], old, new);
        let count = V::Scalar::from_f64((2 * old.q.as_slice().len()).max(1) as f64);
        Ok(h.abs() * (square / count).sqrt())
    }

    /// `r₁ = Δy`, `r₂ = h y₀' − Δy`, `r₃ = 2Δy − h (y₀' + y₁')`, `r₄ = h Σ d k`.
    fn prepare<F: Acceleration<V>>(&mut self, _: &mut System<F>, span: &Span<'_, V>) -> Result<(), Fault<F::Error>> {
        let Span { start, end, old, new } = *span;
        let h = V::Scalar::from_f64(end - start);
        for (slopes, y0, y1, part) in [
            (&self.stages.v, &old.q, &new.q, (|state| &mut state.q) as fn(&mut State<V>) -> &mut V),
            (&self.stages.a, &old.qd, &new.qd, |state| &mut state.qd),
        ] {
            let (y0, y1) = (y0.as_slice(), y1.as_slice());
            let parts = self.parts.each_mut().map(|state| part(state).as_mut_slice());
            for i in 0..y0.len() {
                let rise = y1[i] - y0[i];
                let first = h * slopes[0].as_slice()[i] - rise;
                parts[0][i] = rise;
                parts[1][i] = first;
                parts[2][i] = rise - h * slopes[END].as_slice()[i] - first;
                parts[3][i] = h * weighted(&D, slopes, i);
            }
        }
        Ok(())
    }

    /// `y₀ + θ (r₁ + (1−θ) (r₂ + θ (r₃ + (1−θ) r₄)))`.
    fn interpolate(&self, span: &Span<'_, V>, theta: V::Scalar, state: &mut State<V>) {
        let rest = V::Scalar::one() - theta;
        let at = |y0: V::Scalar, r: [V::Scalar; 4]| y0 + theta * (r[0] + rest * (r[1] + theta * (r[2] + rest * r[3])));
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
        self.stages.initial_step(system, t, direction, longest, state, 5.0)
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

    fn oscillate(_: f64, q: &[f64; 1], _: &[f64; 1], qdd: &mut [f64; 1]) {
        qdd[0] = -q[0];
    }

    #[test]
    fn rows_sum_to_their_nodes_and_the_error_to_nothing() {
        let rows: [&[Weight]; 6] = [&A1, &A2, &A3, &A4, &A5, &B];
        for (row, node) in rows.into_iter().zip(&NODES[1..]) {
            assert!((row.iter().map(|(_, weight)| weight).sum::<f64>() - node).abs() < 1e-14);
        }
        // The dense output's last part vanishes for polynomials that the other parts hold.
        for row in [E, D] {
            for power in 0..3 {
                let moment: f64 = row.iter().map(|&(stage, weight)| weight * NODES[stage].powi(power)).sum();
                assert!(moment.abs() < 1e-13, "{power}: {moment}");
            }
        }
    }

    #[test]
    fn the_order_between_is_four() {
        // Within the first step the error is that of a polynomial of order 4: h⁵.
        let error = |h: f64| {
            let mut there = State::default();
            Dopri5 { first_step: Some(h), ..Dopri5::new(1e9, 1e9) }
                .integrate(oscillate, 0.0, h, &mut State::new([1.0], [0.5]), |step| {
                    step.interpolate(0.4 * h, &mut there).unwrap();
                    ControlFlow::Continue(())
                })
                .unwrap();
            (there.q[0] - (0.4 * h).cos() - 0.5 * (0.4 * h).sin()).abs()
        };
        let order = (error(0.1) / error(0.05)).log2();
        assert!((order - 5.0).abs() < 0.15, "{order}");
    }

    #[test]
    fn work_is_what_the_method_promises() {
        for beta in [0.0, 0.04] {
            let mut state = State::new([1.0], [0.0]);
            let summary = Dopri5 { beta, ..Dopri5::new(1e-8, 1e-8) }
                .integrate(oscillate, 0.0, 10.0 * TAU, &mut state, go_on)
                .unwrap();
            assert!((state.q[0] - 1.0).abs() < 1e-5 && state.qd[0].abs() < 1e-5, "{state:?}");
            // Two for the first step, six for each other.
            assert_eq!(summary.evaluations, 2 + 6 * (summary.accepted + summary.rejected));
        }
    }

    #[test]
    fn the_proportional_part_calms_the_steps() {
        // Friction that settles at once: stability limits the step, not the error. There the elementary controller is
        // refused every other step, and the PI controller hardly ever.
        let settle = |_: f64, q: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = -q[0] - 200.0 * qd[0];
        let [elementary, pi] = [0.0, 0.08].map(|beta| {
            let mut state = State::new([1.0], [0.0]);
            let summary =
                Dopri5 { beta, ..Dopri5::new(1e-6, 1e-6) }.integrate(settle, 0.0, 20.0, &mut state, go_on).unwrap();
            // The slow root of x² + 200 x + 1.
            assert!((state.q[0] - (-20.0 * (100.0 - 9999.0_f64.sqrt())).exp()).abs() < 1e-3, "{state:?}");
            summary
        });
        assert!(pi.rejected * 5 < elementary.rejected, "{elementary:?} {pi:?}");
    }

    #[test]
    fn steps_keep_within_limits() {
        let limited = Dopri5 { max_step: 0.05, ..Dopri5::new(1e-3, 1e-3) };
        let summary = limited
            .integrate(oscillate, 0.0, 3.0, &mut State::new([1.0], [0.0]), |step| {
                assert!(step.time() - step.previous_time() <= 0.05 * (1.0 + 1e-8));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert!((60..65).contains(&summary.accepted), "{summary:?}");
        let hurried = Dopri5 { min_step: 1.0, ..Dopri5::new(1e-12, 1e-12) };
        let result = hurried.integrate(oscillate, 0.0, 6.0, &mut State::new([1.0], [0.0]), go_on);
        assert_eq!(result, Err(IntegrationError::StepTooSmall { time: 0.0, step: 1.0 }));
    }

    #[test]
    fn bad_settings_are_refused() {
        let go = |dopri5: Dopri5| dopri5.integrate(oscillate, 0.0, 1.0, &mut State::default(), go_on).unwrap_err();
        for bad in [0.0, -1e-9, f64::NAN, f64::INFINITY] {
            assert!(matches!(go(Dopri5::new(bad, 1e-9)), IntegrationError::InvalidTolerance { .. }));
            assert!(matches!(go(Dopri5::new(1e-9, bad)), IntegrationError::InvalidTolerance { .. }));
        }
        let crossed = Dopri5 { min_step: 1.0, max_step: 0.1, ..Dopri5::new(1e-3, 1e-3) };
        assert_eq!(go(crossed), IntegrationError::InvalidStep { step: 1.0 });
        for beta in [-0.1, 0.3, f64::NAN, f64::INFINITY] {
            let error = go(Dopri5 { beta, ..Dopri5::new(1e-9, 1e-9) });
            assert!(matches!(error, IntegrationError::InvalidGain { .. }));
        }
    }

    #[test]
    fn a_solution_that_ends_is_an_error() {
        // q̇ = 1/(1 − t): its acceleration is its square.
        let explosive = |_: f64, _: &[f64; 1], qd: &[f64; 1], qdd: &mut [f64; 1]| qdd[0] = qd[0] * qd[0];
        for beta in [0.0, 0.04] {
            let mut state = State::new([0.0], [1.0]);
            let dopri5 = Dopri5 { beta, ..Dopri5::new(1e-8, 1e-8) };
            let error = dopri5.integrate(explosive, 0.0, 2.0, &mut state, go_on).unwrap_err();
            assert!((error.time().unwrap() - 1.0).abs() < 1e-6 && state.is_finite(), "{error}");
        }
    }
}
