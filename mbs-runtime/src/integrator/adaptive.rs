//! Steps by error control, for explicit Runge–Kutta pairs.
//!
//! Source: E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, section
//! II.4 (step control, initial step); K. Gustafsson, *Control theoretic techniques for stepsize selection in explicit
//! Runge–Kutta methods*, 1991, and in the form of E. Hairer and G. Wanner, *Solving Ordinary Differential Equations
//! II*, 2nd ed. 1996, section IV.2, formula 2.43c (the PI controller).

use super::run::{Fault, Method, Next, Run, System};
use super::{Acceleration, Observer, Summary};
use crate::error::IntegrationError;
use crate::scalar::{Real, Scalar};
use crate::state::{Coordinates, State};

/// A stage and what it counts for.
pub(super) type Weight = (usize, f64);

/// How much of the step that would just do is taken.
const SAFETY: f64 = 0.9;

/// What the caller sets, and what the method adds.
pub(super) struct Control {
    pub(super) rtol: f64,
    pub(super) atol: f64,
    pub(super) first_step: Option<f64>,
    pub(super) min_step: f64,
    pub(super) max_step: f64,
    pub(super) max_steps: usize,
    /// `β`, the weight of the error of the step before.
    pub(super) beta: f64,
    /// `α`, the weight of the error of this step.
    pub(super) alpha: f64,
    /// How far the next step may be shorter or longer than this one.
    pub(super) factors: [f64; 2],
}

impl Control {
    /// Refuses what makes no sense at the start `t`.
    pub(super) fn check<T: Real>(&self, t: f64) -> Result<(), IntegrationError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let rounded = |x: f64| T::from_f64(x).to_f64();
        if !(positive(rounded(self.rtol)) && positive(rounded(self.atol))) {
            return Err(IntegrationError::InvalidTolerance { relative: self.rtol, absolute: self.atol });
        }
        // The step would follow the error before more than this one.
        if !(self.beta >= 0.0 && self.alpha > self.beta) {
            return Err(IntegrationError::InvalidGain { beta: self.beta });
        }
        let first = self.first_step.unwrap_or(1.0);
        for (step, good) in [
            (first, positive(first)),
            (self.min_step, self.min_step == 0.0 || positive(self.min_step)),
            (self.max_step, self.max_step > 0.0),
            (self.min_step, self.min_step <= self.max_step),
            (self.max_step, self.shortest::<T>(t) <= self.max_step),
        ] {
            if !good {
                return Err(IntegrationError::InvalidStep { step });
            }
        }
        Ok(())
    }

    /// The shortest step to try at the time `t`.
    #[inline]
    fn shortest<T: Real>(&self, t: f64) -> f64 {
        self.min_step.max(16.0 * f64::EPSILON * t.abs()).max(T::MIN_POSITIVE.to_f64())
    }

    /// How much longer the next step may be: `0.9 error^(−α) previous^β` within bounds, the shortest for NaN.
    #[inline]
    fn factor<T: Real>(&self, error: T, previous: f64) -> f64 {
        if !error.is_finite() {
            return self.factors[0];
        }
        // An error of zero gives infinity, and so the upper bound.
        let root = if self.alpha == 1.0 / 8.0 {
            // A tenth of the time of a step goes into the library's power otherwise.
            T::one() / error.sqrt().sqrt().sqrt()
        } else {
            error.powf(T::from_f64(-self.alpha))
        };
        let mut factor = SAFETY * root.to_f64();
        if self.beta != 0.0 {
            factor *= T::from_f64(previous).powf(T::from_f64(self.beta)).to_f64();
        }
        factor.clamp(self.factors[0], self.factors[1])
    }
}

/// An explicit Runge–Kutta pair, whose error is in units of the tolerance.
pub(super) trait Pair<V: Coordinates>: Method<V, Error = V::Scalar> {
    /// The length of the first step, positive \[s\], from where the method has begun; `longest` at the most.
    fn initial_step<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        direction: f64,
        longest: f64,
        state: &State<V>,
    ) -> f64;
}

/// Steps whose error is at most 1, to `t_end`.
pub(super) fn integrate<T, V, M, F>(
    control: &Control,
    method: M,
    acceleration: F,
    t: f64,
    t_end: f64,
    state: &mut State<V>,
    observer: impl Observer<V, F::Error>,
) -> Result<Summary, IntegrationError<F::Error>>
where
    T: Real,
    V: Coordinates<Scalar = T>,
    M: Pair<V>,
    F: Acceleration<V>,
{
    let mut run = Run::new(method, acceleration, t, t_end, state, observer)?;
    control.check::<T>(t).map_err(IntegrationError::widen)?;
    if t == t_end {
        return Ok(run.summary);
    }
    let direction = if t_end > t { 1.0 } else { -1.0 };
    run.ready().map_err(|fault| fault.at(t, 0.0))?;
    let longest = (t_end - t).abs().min(control.max_step);
    let first = match control.first_step {
        // What is longer is not tried, and nothing for whoever goes on.
        Some(step) => step.min(longest),
        None => run.method.initial_step(&mut run.system, t, direction, longest, run.state),
    };
    let mut pace = Pace::new(first);
    loop {
        let attempt = pace.attempt::<T, _>(control, &run.summary, t_end)?;
        let error = match run.advance(attempt.end - run.summary.time) {
            Ok(error) if error <= T::one() => error,
            refused => {
                pace.refuse(control, &attempt, &mut run.summary, refused)?;
                continue;
            }
        };
        let next = run.accept(attempt.end)?;
        run.summary.next_step = pace.accept(control, &attempt, error);
        if next == Next::Stop || run.summary.time == t_end {
            return Ok(run.summary);
        }
        run.ready().map_err(|fault| fault.at(run.summary.time, pace.step))?;
    }
}

/// The step control of one motion: from its last errors, how long the next step is.
#[derive(Clone, Copy)]
pub(super) struct Pace {
    /// The length of the next step, positive \[s\].
    step: f64,
    /// The error of the last accepted step.
    previous: f64,
    /// Whether the step before was rejected.
    rejected: bool,
}

/// A step that is tried.
#[derive(Clone, Copy)]
pub(super) struct Attempt {
    /// Where it ends \[s\].
    pub(super) end: f64,
    /// Its length, positive \[s\].
    length: f64,
    /// The shortest step that may be tried here \[s\].
    shortest: f64,
    /// Whether it ends where the integration does.
    last: bool,
}

impl Attempt {
    /// Before the first attempt.
    #[cfg(feature = "std")]
    pub(super) fn none() -> Self {
        Self { end: 0.0, length: 0.0, shortest: 0.0, last: false }
    }
}

impl Pace {
    /// Before the first step, of this length.
    pub(super) fn new(step: f64) -> Self {
        Self { step, previous: 1e-4, rejected: false }
    }

    /// The next step from `summary.time` on the way to `t_end`.
    #[inline]
    pub(super) fn attempt<T: Real, E>(
        &mut self,
        control: &Control,
        summary: &Summary,
        t_end: f64,
    ) -> Result<Attempt, IntegrationError<E>> {
        let start = summary.time;
        if summary.accepted + summary.rejected == control.max_steps {
            return Err(IntegrationError::TooManySteps { time: start, steps: control.max_steps });
        }
        let shortest = control.shortest::<T>(start);
        // Branches, which the processor predicts; for the outcome of `min` and `max` the first stage would wait.
        let mut step = self.step;
        if step > control.max_step {
            step = control.max_step;
        }
        if step < shortest {
            // Far from the start the longest step may fall below what the clock can tell.
            if shortest > control.max_step {
                return Err(IntegrationError::StepTooSmall { time: start, step: control.max_step });
            }
            step = shortest;
        }
        self.step = step;
        let remaining = (t_end - start).abs();
        // A rest of less than a hundredth of a step is worth no step of its own.
        let last = 1.01 * step >= remaining && remaining <= (1.0 + 1e-9) * control.max_step;
        let (end, length) = if last {
            (t_end, remaining)
        } else if t_end > start {
            (start + step, step)
        } else {
            (start - step, step)
        };
        Ok(Attempt { end, length, shortest, last })
    }

    /// After an attempt that was not accepted: with too large an error, or a fault.
    pub(super) fn refuse<T: Real, E>(
        &mut self,
        control: &Control,
        attempt: &Attempt,
        summary: &mut Summary,
        refused: Result<T, Fault<E>>,
    ) -> Result<(), IntegrationError<E>> {
        let (fault, factor) = match refused {
            Ok(error) => (Fault::Inaccurate, control.factor(error, 1.0)),
            Err(fault) => (fault, control.factors[0]),
        };
        if attempt.length <= attempt.shortest {
            return Err(fault.at(summary.time, attempt.length));
        }
        summary.rejected += 1;
        self.rejected = true;
        self.step = attempt.length * factor.min(SAFETY);
        Ok(())
    }

    /// After an accepted step with this error; a good length for whoever goes on \[s\].
    #[inline]
    pub(super) fn accept<T: Real>(&mut self, control: &Control, attempt: &Attempt, error: T) -> f64 {
        let factor = control.factor(error, self.previous);
        let proposed = attempt.length * if self.rejected { factor.min(1.0) } else { factor };
        // A last step that was cut short says little about the next one.
        self.step = if attempt.last { proposed.max(self.step) } else { proposed };
        (self.previous, self.rejected) = (error.to_f64().max(1e-4), false);
        self.step.min(control.max_step)
    }
}

/// What the steps of an explicit Runge–Kutta method with `S` stages and `K` estimates of their error work in.
pub(super) struct Stages<V: Coordinates, const S: usize, const K: usize> {
    /// `q̇` of the stages: the slopes of `q`.
    pub(super) v: [V; S],
    /// `q̈` of the stages: the slopes of `q̇`.
    pub(super) a: [V; S],
    /// The coordinates of the current stage; after the last stage `1/scale` of each number.
    q: V,
    /// Scratch of `squares`: `Σ weight · slope / scale` of each number, for each row of weights.
    errors: [V; K],
    rtol: V::Scalar,
    atol: V::Scalar,
}

impl<V: Coordinates, const S: usize, const K: usize> Stages<V, S, K> {
    pub(super) fn new(like: &State<V>, control: &Control) -> Self {
        Self {
            v: core::array::from_fn(|_| like.q.clone()),
            a: core::array::from_fn(|_| like.q.clone()),
            q: like.q.clone(),
            errors: core::array::from_fn(|_| like.q.clone()),
            rtol: V::Scalar::from_f64(control.rtol),
            atol: V::Scalar::from_f64(control.atol),
        }
    }

    /// The first stage of the first step.
    pub(super) fn begin<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        state: &State<V>,
    ) -> Result<(), Fault<F::Error>> {
        self.v[0].copy_from(&state.qd);
        system.evaluate(t, &state.q, &state.qd, &mut self.a[0])
    }

    /// The first stage of a later step is the stage `end` of the one before.
    #[inline]
    pub(super) fn proceed(&mut self, end: usize) {
        self.v.swap(0, end);
        self.a.swap(0, end);
    }

    /// Stage `s`: `y₀ + h Σ a[s][j] k[j]` and the acceleration there.
    #[inline(always)] // as `combine`
    pub(super) fn stage<E, const N: usize>(
        &mut self,
        evaluate: impl FnOnce(&V, &V, &mut V) -> Result<(), E>,
        h: V::Scalar,
        old: &State<V>,
        s: usize,
        row: &[Weight; N],
    ) -> Result<(), E> {
        combine(&mut self.q, &old.q, h, row, &self.v);
        combine(&mut self.v[s], &old.qd, h, row, &self.a);
        evaluate(&self.q, &self.v[s], &mut self.a[s])
    }

    /// The end of the step: `y₀ + h Σ b[j] k[j]`.
    #[inline(always)]
    pub(super) fn finish<const N: usize>(&self, h: V::Scalar, old: &State<V>, row: &[Weight; N], new: &mut State<V>) {
        combine(&mut new.q, &old.q, h, row, &self.v);
        combine(&mut new.qd, &old.qd, h, row, &self.a);
    }

    /// The acceleration at the end of the step, as stage `s`.
    #[inline]
    pub(super) fn end<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        new: &State<V>,
        s: usize,
    ) -> Result<(), Fault<F::Error>> {
        self.v[s].copy_from(&new.qd);
        system.evaluate(t, &new.q, &new.qd, &mut self.a[s])
    }

    /// For each row of weights the sum over `q` and `q̇` of `(Σ weight · slope / scale)²`.
    #[inline(always)] // as in `combine`
    pub(super) fn squares<const N: usize>(
        &mut self,
        rows: [&[Weight; N]; K],
        old: &State<V>,
        new: &State<V>,
    ) -> [V::Scalar; K] {
        let mut sums = [V::Scalar::zero(); K];
        for (slopes, y0, y1) in [(&self.v, &old.q, &new.q), (&self.a, &old.qd, &new.qd)] {
            // Line by line over all numbers, so that the compiler makes vectors of them.
            let (y0, y1, per_scale) = (y0.as_slice(), y1.as_slice(), self.q.as_mut_slice());
            for i in 0..per_scale.len() {
                // Not `maximum`, which tests for NaN as well: a state that is not finite is refused by the caller.
                let (size0, size1) = (y0[i].abs(), y1[i].abs());
                let size = V::Scalar::blend(size0.less(size1), size1, size0);
                per_scale[i] = V::Scalar::one() / (self.atol + self.rtol * size);
            }
            for k in 0..K {
                let errors = self.errors[k].as_mut_slice();
                for i in 0..errors.len() {
                    errors[i] = weighted(rows[k], slopes, i) * per_scale[i];
                }
                for i in 0..errors.len() {
                    sums[k] = sums[k] + errors[i] * errors[i];
                }
            }
        }
        sums
    }

    /// The sizes of the state and of its slopes, in the norm of the tolerances.
    pub(super) fn sizes(&self, state: &State<V>) -> (V::Scalar, V::Scalar) {
        (self.norm(state, &state.q, &state.qd), self.norm(state, &self.v[0], &self.a[0]))
    }

    /// Where an explicit Euler step of the length `h` leads: coordinates, and velocities as those of stage 1.
    pub(super) fn euler_step(&mut self, h: V::Scalar, state: &State<V>) {
        combine(&mut self.q, &state.q, h, &[(0, 1.0)], &self.v);
        combine(&mut self.v[1], &state.qd, h, &[(0, 1.0)], &self.a);
    }

    /// Coordinates and velocities after [`euler_step`](Self::euler_step), and the place of the acceleration there.
    pub(super) fn at_euler_step(&mut self) -> (&V, &V, &mut V) {
        (&self.q, &self.v[1], &mut self.a[1])
    }

    /// The size of the second derivative, from the slopes at both ends of an Euler step of the length `h`.
    pub(super) fn bend(&mut self, h: V::Scalar, state: &State<V>) -> V::Scalar {
        for stages in [&mut self.v, &mut self.a] {
            let (first, rest) = stages.split_at_mut(1);
            for (x, x0) in rest[0].as_mut_slice().iter_mut().zip(first[0].as_slice()) {
                *x = *x - *x0;
            }
        }
        self.norm(state, &self.v[1], &self.a[1]) / h.abs()
    }

    /// The root mean square of `(x, y)` in units of the tolerance at `state`.
    fn norm(&self, state: &State<V>, x: &V, y: &V) -> V::Scalar {
        let mut sum = V::Scalar::zero();
        for (at, x) in [(&state.q, x), (&state.qd, y)] {
            for (at, x) in at.as_slice().iter().zip(x.as_slice()) {
                let scaled = *x / (self.atol + self.rtol * at.abs());
                sum = sum + scaled * scaled;
            }
        }
        let count = (2 * x.as_slice().len()).max(1);
        (sum / V::Scalar::from_f64(count as f64)).sqrt()
    }
}

impl<V: Coordinates<Scalar: Real>, const S: usize, const K: usize> Stages<V, S, K> {
    /// Hairer's choice of the first step of a method of the order `order` (section II.4), positive \[s\].
    ///
    /// One explicit Euler step, a hundredth of `|y|/|y'|` long, estimates the second derivative; then the step is such
    /// that `hᵖ max(|y'|, |y''|) = 1/100`, in the norm of the tolerances.
    pub(super) fn initial_step<F: Acceleration<V>>(
        &mut self,
        system: &mut System<F>,
        t: f64,
        direction: f64,
        longest: f64,
        state: &State<V>,
        order: f64,
    ) -> f64 {
        let (d0, d1) = self.sizes(state);
        let guess = first_guess(d0, d1, longest);
        let h = V::Scalar::from_f64(direction * guess);
        self.euler_step(h, state);
        let (q, qd, qdd) = self.at_euler_step();
        if system.evaluate(t + direction * guess, q, qd, qdd).is_err() {
            return guess;
        }
        let d2 = self.bend(h, state);
        first_step(d1, d2, order, guess, longest)
    }
}

/// The length of the Euler step by which the second derivative is estimated \[s\]: a hundredth of `|y|/|y'|`.
pub(super) fn first_guess<T: Real>(d0: T, d1: T, longest: f64) -> f64 {
    let small = T::from_f64(1e-5);
    let guess = if d0 < small || d1 < small { 1e-6 } else { 0.01 * (d0 / d1).to_f64() };
    // Infinite norms (of f32) make NaN here, and `min` drops it.
    guess.min(longest)
}

/// The length of the first step \[s\]: `hᵖ max(|y'|, |y''|) = 1/100`.
pub(super) fn first_step<T: Real>(d1: T, d2: T, order: f64, guess: f64, longest: f64) -> f64 {
    let steepest = d1.maximum(d2);
    let step = if steepest <= T::from_f64(1e-15) {
        (guess * 1e-3).max(1e-6)
    } else {
        (T::from_f64(0.01) / steepest).powf(T::from_f64(1.0 / order)).to_f64()
    };
    step.min(100.0 * guess).min(longest)
}

/// `base + Σ (h weight) · slope`: what waits for the last slope is a product and two sums.
#[inline(always)] // the row is a constant: with it in sight the loop over the stages unrolls
fn combine<V: Coordinates, const N: usize, const S: usize>(
    out: &mut V,
    base: &V,
    h: V::Scalar,
    row: &[Weight; N],
    slopes: &[V; S],
) {
    let (out, base) = (out.as_mut_slice(), base.as_slice());
    for i in 0..out.len() {
        let term = |(stage, weight): Weight| (h * V::Scalar::from_f64(weight)) * slopes[stage].as_slice()[i];
        let mut sum = term(row[0]);
        for &weight in &row[1..] {
            sum = sum + term(weight);
        }
        out[i] = base[i] + sum;
    }
}

/// `Σ weight · slope` of the number `i`.
#[inline(always)]
pub(super) fn weighted<V: Coordinates, const N: usize, const S: usize>(
    row: &[Weight; N],
    slopes: &[V; S],
    i: usize,
) -> V::Scalar {
    let term = |(stage, weight): Weight| V::Scalar::from_f64(weight) * slopes[stage].as_slice()[i];
    let mut sum = term(row[0]);
    for &weight in &row[1..] {
        sum = sum + term(weight);
    }
    sum
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    /// `0.9 error^(−α) previous^β`, between the bounds.
    #[test]
    fn the_controller_weighs_two_errors() {
        let control = |alpha: f64, beta: f64| Control {
            rtol: 1e-6,
            atol: 1e-6,
            first_step: None,
            min_step: 0.0,
            max_step: f64::INFINITY,
            max_steps: 10,
            beta,
            alpha,
            factors: [0.2, 5.0],
        };
        for (alpha, beta) in [(0.125, 0.0), (0.17, 0.04), (0.2, 0.08)] {
            let found = control(alpha, beta).factor(0.3_f64, 0.02);
            let expected = 0.9 * 0.3_f64.powf(-alpha) * 0.02_f64.powf(beta);
            assert!((found - expected).abs() < 1e-14, "{alpha} {beta}: {found}, {expected}");
        }
        assert_eq!(control(0.17, 0.04).factor(0.0_f64, 1.0), 5.0);
        assert_eq!(control(0.17, 0.04).factor(1e9_f64, 1.0), 0.2);
        assert_eq!(control(0.17, 0.04).factor(f64::NAN, 1.0), 0.2);
    }
}
