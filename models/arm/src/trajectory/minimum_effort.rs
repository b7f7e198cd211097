//! The motion between two states that asks least of the drives, in a given time, under limits: direct collocation.
//!
//! ```text
//! minimize   J = ∫₀ᵀ Σ (uᵢ/Fᵢ)² dt      such that   q̈ = M⁻¹ (Q(q, q̇, u) − h − ∂D/∂q̇),   lower ≤ q, q̇, u ≤ upper
//! ```
//!
//! Each of K intervals has its states and inputs at both ends and in the middle; between them q̇ and q̈ are parabolas
//! through these three (Hermite–Simpson), which is right to the fourth order of the interval. What is left is a finite
//! problem with some thousands of unknowns whose derivatives are exact and sparse: the first ones are blocks of the
//! generated `linearize`, the second ones are the same function evaluated in dual numbers. An interior-point method
//! solves it; its linear systems are banded, because intervals know their neighbours alone.
//!
//! The multipliers of the defects are the costates of Pontryagin's principle. Where the mechanism does not depend on
//! the time, `H = Σ (uᵢ/Fᵢ)² + pᵀ ẋ` is the same all along the motion, and `dJ/dT = H`.
//!
//! ```
//! use mbs_arm::trajectory::minimum_effort::{Limits, Transfer, minimum_effort};
//! use mbs_models::pendulum::{Params, Pendulum};
//! use mbs_runtime::Dual;
//!
//! // A wheel of 2 kg m², turned by 1 rad in 3 s: the angle is a cubic of the time, J = 12 (d I)²/T³.
//! let wheel = Pendulum::new(Params { m: Dual::constant(2.0), g: Dual::constant(0.0), ..Params::default() });
//! let (start, stop) = ([[0.0], [0.0]], [[1.0], [0.0]]);
//! let transfer = Transfer { start, stop, duration: 3.0, scale: [1.0], limits: Limits::NONE };
//! let motion = minimum_effort(&wheel, &transfer, 4, None)?;
//! assert!((motion.effort() - 12.0 * 4.0 / 27.0).abs() < 1e-6);
//! # Ok::<(), mbs_models::Error>(())
//! ```
//!
//! # Source
//! C. R. Hargraves, S. W. Paris, *Direct trajectory optimization using nonlinear programming and collocation*, Journal
//! of Guidance 10:4, 1987; J. T. Betts, *Practical Methods for Optimal Control and Estimation Using Nonlinear
//! Programming*, 2nd ed. 2010, chapter 4; M. Kelly, *An introduction to trajectory optimization*, SIAM Review 59:4,
//! 2017.

mod banded;
pub mod front;
mod interior_point;
mod transcription;

use std::vec::Vec;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::{Dual, Mechanism};

use super::{INTERVALS, JointState, Motion, POSITION, VELOCITY};
use interior_point::{Bounds, Iterate};
use transcription::{Layout, Transcription};

/// What does [not converge](Failure::NotConverged) where limits leave no motion, or it was not found.
pub const SEARCH: &str = "the search of the motion of least effort";

pub use interior_point::Residual;

/// What a motion must keep to at every point; infinite where it need not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<const N: usize, const U: usize> {
    /// The smallest coordinates \[rad, for joints that turn\].
    pub lower: [f64; N],
    /// The largest coordinates.
    pub upper: [f64; N],
    /// The largest velocities, either way \[rad/s\].
    pub speed: [f64; N],
    /// The largest inputs, either way \[N·m\].
    pub input: [f64; U],
}

impl<const N: usize, const U: usize> Limits<N, U> {
    /// No limits.
    pub const NONE: Self = Self {
        lower: [f64::NEG_INFINITY; N],
        upper: [f64::INFINITY; N],
        speed: [f64::INFINITY; N],
        input: [f64::INFINITY; U],
    };
}

impl From<&crate::JointLimits> for Limits<6, 6> {
    fn from(limits: &crate::JointLimits) -> Self {
        Self { lower: limits.lower, upper: limits.upper, speed: limits.speed, input: limits.torque }
    }
}

/// From where to where, how long, and what it may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer<const N: usize, const U: usize> {
    /// Coordinates and velocities at the start \[rad, rad/s\].
    pub start: [[f64; N]; 2],
    /// Those at the stop.
    pub stop: [[f64; N]; 2],
    /// The duration \[s\].
    pub duration: f64,
    /// The inputs F that count as full effort \[N·m\].
    pub scale: [f64; U],
    /// At every point.
    pub limits: Limits<N, U>,
}

/// One of the points: the ends and the middles of intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<const N: usize, const U: usize> {
    /// When \[s\].
    pub t: f64,
    /// Coordinates and their derivatives.
    pub state: JointState<N>,
    /// Inputs \[N·m\].
    pub input: [f64; U],
    /// By how much J grows with each coordinate and each velocity there: `p = ∂J/∂(q, q̇)` \[s/rad, s²/rad\].
    pub costate: [[f64; N]; 2],
    /// `H = Σ (uᵢ/Fᵢ)² + pᵀ (q̇, q̈)`.
    pub hamiltonian: f64,
}

/// A motion of least effort, as [`minimum_effort`] finds it.
#[derive(Clone, Debug)]
pub struct MinimumEffort<const N: usize, const U: usize> {
    duration: f64,
    effort: f64,
    points: Vec<Point<N, U>>,
    residual: Residual,
    iterations: usize,
    iterate: Iterate,
}

/// The parameter of the first barrier.
const BARRIER: f64 = 1e-3;
/// The barrier to begin with, from the solution of a problem nearby.
const WARM_BARRIER: f64 = 1e-5;

/// The motion of a transfer that minimizes `∫ Σ (uᵢ/Fᵢ)² dt`, on a number of equal intervals.
///
/// The search begins at `guess`, the solution of a problem nearby on as many intervals, such as a somewhat other
/// duration; without one at the cubic between both states, without inputs. What is found is a local minimum.
///
/// # Errors
/// - [`Failure::NotConverged`] where the search ends elsewhere: no motion keeps to the limits in this time, or it
///   was not found;
/// - [`Failure::LimitExceeded`] for a start or a stop beyond the limits;
/// - [`Failure::Invalid`] without intervals, or where the guess has another number of them;
/// - [`Failure::Invalid`] for what is
///   given.
pub fn minimum_effort<const N: usize, const U: usize>(
    mechanism: &impl Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
    transfer: &Transfer<N, U>,
    intervals: usize,
    guess: Option<&MinimumEffort<N, U>>,
) -> Result<MinimumEffort<N, U>, Error> {
    transfer.check()?;
    check::positive(INTERVALS, intervals as f64)?;
    let layout = Layout { coordinates: N, inputs: U, intervals };
    let problem = Transcription { mechanism, layout, duration: transfer.duration, scale: transfer.scale };
    let bounds = transfer.bounds(layout);
    let (z, barrier) = match guess {
        Some(motion) if motion.iterate.z.len() != layout.len() => {
            let (known, wanted) = ((motion.points.len() / 2) as f64, intervals as f64);
            return Err(Must::BeWithin([wanted, wanted]).broken_by("intervals of the guess", known).into());
        }
        Some(motion) => (motion.iterate.z.clone(), WARM_BARRIER),
        None => (transfer.cubic(layout), BARRIER),
    };
    let start = inside(z, &bounds, barrier);
    match interior_point::solve(&problem, &bounds, start, barrier) {
        Ok((iterate, residual, iterations)) => Ok(MinimumEffort::new(&problem, iterate, residual, iterations)),
        Err((Residual { stationarity, defect, .. }, iterations)) => {
            let residual = if stationarity > defect { stationarity } else { defect };
            Err(Failure::NotConverged { what: SEARCH, iterations, residual, unit: "in scaled variables" }.into())
        }
    }
}

/// Variables moved off their bounds, by a hundredth of the range at most, and multipliers as the barrier has them.
fn inside(mut z: Vec<f64>, bounds: &Bounds, barrier: f64) -> Iterate {
    let (mut lower, mut upper) = (std::vec![0.0; z.len()], std::vec![0.0; z.len()]);
    for i in 0..z.len() {
        let (least, greatest) = (bounds.lower[i], bounds.upper[i]);
        if least == greatest {
            z[i] = least;
            continue;
        }
        let off = |bound: f64| (1e-2 * bound.abs().max(1.0)).min(1e-2 * (greatest - least));
        z[i] = z[i].max(least + off(least)).min(greatest - off(greatest));
        lower[i] = barrier / (z[i] - least);
        upper[i] = barrier / (greatest - z[i]);
    }
    Iterate { z, lower, upper }
}

impl<const N: usize, const U: usize> Transfer<N, U> {
    fn check(&self) -> Result<(), Error> {
        check::positive("duration", self.duration)?;
        check::positive("scale", self.scale)?;
        let limits = &self.limits;
        Must::BeMoreThan(0.0).check("largest speed", limits.speed)?;
        Must::BeMoreThan(0.0).check("largest input", limits.input)?;
        for joint in 0..N {
            let (lower, upper) = (limits.lower[joint], limits.upper[joint]);
            Must::BeMoreThan(lower).check("largest angle of joint", upper).map_err(|error| error.of(joint))?;
        }
        for ([q, qd], time) in [(&self.start, 0.0), (&self.stop, self.duration)] {
            check::finite(POSITION, *q)?;
            check::finite(VELOCITY, *qd)?;
            for index in 0..N {
                let exceeded = |quantity, unit, value, limit| {
                    Err(Failure::LimitExceeded { quantity, unit, index, value, limit }.at_time(time))
                };
                let nearest = q[index].clamp(limits.lower[index], limits.upper[index]);
                if nearest != q[index] {
                    return exceeded(POSITION, "rad", q[index], nearest);
                }
                if qd[index].abs() > limits.speed[index] {
                    return exceeded(VELOCITY, "rad/s", qd[index], limits.speed[index]);
                }
            }
        }
        Ok(())
    }

    /// Those of all points; at both ends states are given.
    fn bounds(&self, layout: Layout) -> Bounds {
        let (mut lower, mut upper) =
            (std::vec![f64::NEG_INFINITY; layout.len()], std::vec![f64::INFINITY; layout.len()]);
        for j in 0..=layout.last() {
            let first = layout.point(j);
            let speed = self.limits.speed.map(|speed| speed * self.duration);
            let input: [f64; U] = core::array::from_fn(|i| self.limits.input[i] / self.scale[i]);
            lower[first..first + N].copy_from_slice(&self.limits.lower);
            upper[first..first + N].copy_from_slice(&self.limits.upper);
            lower[first + N..first + 2 * N].copy_from_slice(&speed.map(|speed| -speed));
            upper[first + N..first + 2 * N].copy_from_slice(&speed);
            lower[first + 2 * N..first + 2 * N + U].copy_from_slice(&input.map(|input| -input));
            upper[first + 2 * N..first + 2 * N + U].copy_from_slice(&input);
        }
        for ([q, qd], j) in [(&self.start, 0), (&self.stop, layout.last())] {
            let state = [*q, qd.map(|qd| qd * self.duration)].concat();
            for bound in [&mut lower, &mut upper] {
                bound[layout.point(j)..][..2 * N].copy_from_slice(&state);
            }
        }
        Bounds { lower, upper }
    }

    /// The cubic with both states at its ends, without inputs.
    fn cubic(&self, layout: Layout) -> Vec<f64> {
        let mut z = std::vec![0.0; layout.len()];
        let ([start, v], [stop, w]) = (self.start, self.stop);
        for j in 0..=layout.last() {
            let s = j as f64 / layout.last() as f64;
            for i in 0..N {
                let (v, w, d) = (v[i] * self.duration, w[i] * self.duration, stop[i] - start[i]);
                let (square, cube) = (3.0 * d - 2.0 * v - w, v + w - 2.0 * d);
                z[layout.point(j) + i] = start[i] + s * (v + s * (square + s * cube));
                z[layout.point(j) + N + i] = v + s * (2.0 * square + 3.0 * s * cube);
            }
        }
        z
    }
}

impl<const N: usize, const U: usize> MinimumEffort<N, U> {
    fn new<M>(problem: &Transcription<'_, M, N, U>, iterate: Iterate, residual: Residual, iterations: usize) -> Self
    where
        M: Mechanism<N, U, Scalar = Dual<f64>, Time = Dual<f64>>,
    {
        let (duration, z) = (problem.duration, &iterate.z);
        let points = (0..=problem.layout.last()).map(|j| {
            let values = &z[problem.layout.point(j)..][..problem.layout.size()];
            let accelerations = problem.accelerations(z, j);
            let state = JointState {
                q: core::array::from_fn(|i| values[i]),
                qd: core::array::from_fn(|i| values[N + i] / duration),
                qdd: accelerations.map(|a| a / (duration * duration)),
            };
            let [p_q, p_w] = problem.costates(z, j);
            let effort: f64 = values[2 * N..].iter().map(|u| u * u).sum();
            Point {
                t: duration * j as f64 / problem.layout.last() as f64,
                state,
                input: core::array::from_fn(|i| problem.scale[i] * values[2 * N + i]),
                costate: [p_q.map(|p| duration * p), p_w.map(|p| duration * duration * p)],
                hamiltonian: effort + (0..N).map(|i| p_q[i] * values[N + i] + p_w[i] * accelerations[i]).sum::<f64>(),
            }
        });
        let points = points.collect();
        Self { duration, effort: duration * problem.objective(z), points, residual, iterations, iterate }
    }

    /// `J = ∫ Σ (uᵢ/Fᵢ)² dt` \[s\], by Simpson's rule over the points.
    #[must_use]
    pub const fn effort(&self) -> f64 {
        self.effort
    }

    /// Both ends and the middle of every interval.
    #[must_use]
    pub fn points(&self) -> &[Point<N, U>] {
        &self.points
    }

    /// How far the conditions of optimality are from being satisfied.
    #[must_use]
    pub const fn residual(&self) -> Residual {
        self.residual
    }

    /// Newton steps that were taken.
    #[must_use]
    pub const fn iterations(&self) -> usize {
        self.iterations
    }

    /// The inputs at the time `t` \[N·m\]: a parabola in each interval.
    ///
    /// # Errors
    /// [`Failure::Invalid`] if `t` is before 0, after the duration, or NaN.
    pub fn input_at(&self, t: f64) -> Result<[f64; U], Error> {
        let (r, [begin, middle, end]) = self.interval(t)?;
        Ok(core::array::from_fn(|i| parabola(r, [begin.input[i], middle.input[i], end.input[i]])))
    }

    /// The interval of a time, and which part of it is over.
    fn interval(&self, t: f64) -> Result<(f64, [&Point<N, U>; 3]), Error> {
        check::within("time", t, [0.0, self.duration])?;
        let count = self.points.len() / 2;
        let place = t / self.duration * count as f64;
        let k = (place as usize).min(count - 1);
        Ok((place - k as f64, [&self.points[2 * k], &self.points[2 * k + 1], &self.points[2 * k + 2]]))
    }
}

impl<const N: usize, const U: usize> Motion<N> for MinimumEffort<N, U> {
    fn duration(&self) -> f64 {
        self.duration
    }

    /// q̈ is a parabola in each interval; q and q̇ are the integrals of parabolas through q̇ and q̈.
    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        let (r, points) = self.interval(t)?;
        let h = points[2].t - points[0].t;
        let [begin, middle, end] = points.map(|point| &point.state);
        Ok(JointState {
            q: core::array::from_fn(|i| begin.q[i] + h * integral(r, [begin.qd[i], middle.qd[i], end.qd[i]])),
            qd: core::array::from_fn(|i| begin.qd[i] + h * integral(r, [begin.qdd[i], middle.qdd[i], end.qdd[i]])),
            qdd: core::array::from_fn(|i| parabola(r, [begin.qdd[i], middle.qdd[i], end.qdd[i]])),
        })
    }
}

/// Through three values at 0, ½ and 1.
fn parabola(r: f64, [a, b, c]: [f64; 3]) -> f64 {
    a + r * (4.0 * b - 3.0 * a - c + r * (2.0 * a - 4.0 * b + 2.0 * c))
}

/// Of the parabola, from 0 to r.
fn integral(r: f64, [a, b, c]: [f64; 3]) -> f64 {
    r * (a + r * ((4.0 * b - 3.0 * a - c) / 2.0 + r * (2.0 * a - 4.0 * b + 2.0 * c) / 3.0))
}
