//! The fastest motion along a path under limits of speed, acceleration and torque.
//!
//! Along a path q(s) the torques are linear in `u = s̈` and `x = ṡ²`:
//!
//! ```text
//! τ = M q′ u + (M q″ + C(q, q′) q′) x + G,   q̇² = q′² x,   q̈ = q′ u + q″ x
//! ```
//!
//! so that every limit is a strip of the (u, x) plane at each point of a grid of s, and `x` changes by `2 Δ u` from one
//! point to the next where u is constant between. Backwards from the stop, the speeds are found from which it can still
//! be reached; forwards from the start, the largest u is taken that stays among them. No switching points are looked
//! for, and zero-inertia points need no care.
//!
//! # Source
//! H. Pham, Q.-C. Pham, *A new approach to time-optimal path parameterization based on reachability analysis*, IEEE
//! Transactions on Robotics 34:3, 2018, sections III and IV, with constraints at both ends of an interval
//! ("interpolation scheme"). The problem is that of J. E. Bobrow, S. Dubowsky, J. S. Gibson, *Time-optimal control of
//! robotic manipulators along specified paths*, 1985, and of K. G. Shin, N. D. McKay, *Minimum-time control of robotic
//! manipulators with geometric path constraints*, 1985.

use std::vec::Vec;

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Mechanism;

use super::{
    ACCELERATION, INTERVALS, JointPath, JointState, Motion, POSITION, PathPoint, RateLimits, TORQUE, VELOCITY,
};

/// What is [missing](Failure::Missing) where no speed along the path satisfies all limits, at the best approach and
/// continuation.
pub const SPEED: &str = "speed along the path that satisfies the limits";

/// Symmetric limits of every joint; infinite where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorLimits<const N: usize> {
    /// The limits of speed and acceleration.
    pub rates: RateLimits<N>,
    /// The largest torque, either way \[N·m\].
    pub torque: [f64; N],
}

/// The fewest intervals of a grid.
const LEAST_INTERVALS: usize = 4;
/// Limits are taken smaller by this fraction from the start, against rounding.
const MARGIN: f64 = 1e-9;
/// Within each interval limits are checked at this many points.
const CHECKS: usize = 3;
/// A square of the path's speed beyond any that limits leave.
const FASTEST: f64 = 1e100;
/// How often limits are tightened by what they are exceeded between the points of the grid.
const ROUNDS: usize = 12;

/// The fastest motion along `path` from rest to rest.
///
/// `intervals` is the number of equal intervals of the grid, some hundreds; the time converges with their number.
/// Limits hold between the points of the grid, too: where they are exceeded at a quarter, half or three quarters of an
/// interval, they are tightened by as much, joint by joint, and the motion is found again.
///
/// The mechanism must be autonomous, without forces that grow with the velocity.
///
/// # Errors
/// - [`Failure::Missing`] with the place at which no [`SPEED`] satisfies the limits;
/// - [`Failure::NoMotion`] where the tangent of the path vanishes, as it does at the ends of a motion
///   from rest;
/// - [`Failure::Invalid`] for fewer than four intervals, or where limits are exceeded between the points
///   of the grid however much they are tightened;
/// - [`Failure::Invalid`] for what is given.
pub fn retime<const N: usize, const U: usize, P: JointPath<N>>(
    path: P,
    mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
    limits: &MotorLimits<N>,
    intervals: usize,
) -> Result<TimeOptimal<N, P>, Error> {
    limits.rates.check()?;
    Must::BeMoreThan(0.0).check("largest torque", limits.torque)?;
    let length = path.length();
    check::positive("length", length)?;
    Must::BeAtLeast(LEAST_INTERVALS as f64).check(INTERVALS, intervals as f64)?;
    let limited = |i: usize| {
        [limits.rates.speed[i], limits.rates.acceleration[i], limits.torque[i]].iter().any(|l| l.is_finite())
    };
    if !(0..N).any(limited) {
        return Err(Must::BeFinite.broken_by("largest speed", f64::INFINITY).of(0).into());
    }
    // Points of the grid, and those between them at which limits are checked.
    let count = intervals * (CHECKS + 1);
    let place = |k: usize| length * (k as f64 / count as f64);
    let points = (0..=count).map(|k| Load::new(&path, mechanism, place(k))).collect::<Result<Vec<_>, _>>()?;
    let mut tightened = limits.scaled(1.0 - MARGIN);
    for _ in 0..ROUNDS {
        let grid = Grid { points: &points, limits: &tightened, length, interval: length / intervals as f64 };
        let squares = grid.fastest()?;
        let excess = grid.excess(&squares, limits);
        if excess.iter().flatten().all(|ratio| *ratio <= 1.0) {
            return TimeOptimal::new(path, squares);
        }
        tightened.tighten(&excess);
    }
    Err(Must::BeAtLeast(2.0 * intervals as f64).broken_by(INTERVALS, intervals as f64).into())
}

/// The fastest motion along a path, as [`retime`] finds it.
#[derive(Clone, Debug)]
pub struct TimeOptimal<const N: usize, P> {
    path: P,
    /// ṡ² at the points of the grid; zero at both ends alone.
    squares: Vec<f64>,
    /// When they are passed \[s\]: increasing from 0.
    times: Vec<f64>,
}

impl<const N: usize, P: JointPath<N>> TimeOptimal<N, P> {
    fn new(path: P, squares: Vec<f64>) -> Result<Self, Error> {
        let interval = path.length() / (squares.len() - 1) as f64;
        let mut times = Vec::with_capacity(squares.len());
        let mut time = 0.0;
        times.push(time);
        for (i, pair) in squares.windows(2).enumerate() {
            time += 2.0 * interval / (pair[0].sqrt() + pair[1].sqrt());
            if !time.is_finite() {
                return Err(Failure::Missing(SPEED).at_path(i as f64 * interval));
            }
            times.push(time);
        }
        Ok(Self { path, squares, times })
    }

    /// The path.
    pub const fn path(&self) -> &P {
        &self.path
    }

    /// Path parameter, its rate \[1/s\] and its acceleration \[1/s²\] at the time `t`.
    ///
    /// # Errors
    /// [`Failure::Invalid`] as [`Motion::at`].
    pub fn parameter(&self, t: f64) -> Result<[f64; 3], Error> {
        let duration = self.duration();
        check::within("time", t, [0.0, duration])?;
        let intervals = self.squares.len() - 1;
        let i = self.times.partition_point(|time| *time <= t).clamp(1, intervals) - 1;
        let length = self.path.length();
        let interval = length / intervals as f64;
        let acceleration = (self.squares[i + 1] - self.squares[i]) / (2.0 * interval);
        let (rate, elapsed) = (self.squares[i].sqrt(), t - self.times[i]);
        let s = length * (i as f64 / intervals as f64) + (rate + 0.5 * acceleration * elapsed) * elapsed;
        Ok([s.clamp(0.0, length), (rate + acceleration * elapsed).max(0.0), acceleration])
    }
}

impl<const N: usize, P: JointPath<N>> Motion<N> for TimeOptimal<N, P> {
    fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        let [s, rate, acceleration] = self.parameter(t)?;
        let PathPoint { q, tangent, curvature } = self.path.point(s)?;
        let qdd = std::array::from_fn(|i| tangent[i] * acceleration + curvature[i] * rate * rate);
        Ok(JointState { q, qd: tangent.map(|tangent| tangent * rate), qdd })
    }
}

impl From<&crate::JointLimits> for MotorLimits<6> {
    fn from(limits: &crate::JointLimits) -> Self {
        let rates = RateLimits { speed: limits.speed, acceleration: limits.acceleration };
        Self { rates, torque: limits.torque }
    }
}

impl<const N: usize> MotorLimits<N> {
    fn scaled(&self, factor: f64) -> Self {
        let scale = |limits: [f64; N]| limits.map(|limit| limit * factor);
        let rates = RateLimits { speed: scale(self.rates.speed), acceleration: scale(self.rates.acceleration) };
        Self { rates, torque: scale(self.torque) }
    }

    /// By ratios of what there is to what may be: speed, acceleration, torque.
    fn tighten(&mut self, [speed, acceleration, torque]: &[[f64; N]; 3]) {
        let limits =
            [(&mut self.rates.speed, speed), (&mut self.rates.acceleration, acceleration), (&mut self.torque, torque)];
        for (limits, ratios) in limits {
            for (limit, ratio) in limits.iter_mut().zip(ratios).filter(|(_, ratio)| **ratio > 1.0) {
                *limit *= (1.0 - MARGIN) / ratio;
            }
        }
    }
}

/// A point of the path: what speed and acceleration along it ask of the joints.
struct Load<const N: usize> {
    tangent: [f64; N],
    curvature: [f64; N],
    /// Torque per `s̈`: `M q′`.
    inertia: [f64; N],
    /// Torque per `ṡ²`: `M q″ + C q′`.
    centrifugal: [f64; N],
    gravity: [f64; N],
}

impl<const N: usize> Load<N> {
    fn new<const U: usize>(
        path: &impl JointPath<N>,
        mechanism: &impl Mechanism<N, U, Scalar = f64, Time = f64>,
        s: f64,
    ) -> Result<Self, Error> {
        let PathPoint { q, tangent, curvature } = path.point(s)?;
        for (quantity, values) in [(POSITION, q), (VELOCITY, tangent), (ACCELERATION, curvature)] {
            check::finite(quantity, values)?;
        }
        if tangent.iter().all(|tangent| *tangent == 0.0) {
            return Err(Failure::NoMotion.at_path(s));
        }
        // Limits would not be linear in the square of the speed along the path.
        let dissipation = mechanism.dissipation_force(0.0, &q, &tangent);
        check::within("force that grows with the velocity of joint", dissipation, [0.0, 0.0])
            .map_err(|error| error.at_path(s))?;
        let (mass, gravity) = (mechanism.mass_matrix(0.0, &q), mechanism.gravity(0.0, &q));
        let bias = mechanism.bias(0.0, &q, &tangent);
        let times = |v: &[f64; N], i: usize| (0..N).map(|j| mass[i][j] * v[j]).sum::<f64>();
        let inertia = std::array::from_fn(|i| times(&tangent, i));
        let centrifugal = std::array::from_fn(|i| times(&curvature, i) + bias[i] - gravity[i]);
        for torque in [&inertia, &centrifugal, &gravity] {
            check::finite(TORQUE, *torque)?;
        }
        Ok(Self { tangent, curvature, inertia, centrifugal, gravity })
    }

    /// Speeds, accelerations and torques over their limits.
    fn ratios(&self, square: f64, acceleration: f64, limits: &MotorLimits<N>) -> [[f64; N]; 3] {
        let ratio =
            |value: &dyn Fn(usize) -> f64, limits: &[f64; N]| std::array::from_fn(|i| value(i).abs() / limits[i]);
        [
            ratio(&|i| self.tangent[i] * square.sqrt(), &limits.rates.speed),
            ratio(&|i| self.tangent[i] * acceleration + self.curvature[i] * square, &limits.rates.acceleration),
            ratio(&|i| self.inertia[i] * acceleration + self.centrifugal[i] * square + self.gravity[i], &limits.torque),
        ]
    }
}

struct Grid<'a, const N: usize> {
    /// At the ends of the intervals, and `CHECKS` within each.
    points: &'a [Load<N>],
    limits: &'a MotorLimits<N>,
    length: f64,
    /// Length of an interval.
    interval: f64,
}

impl<const N: usize> Grid<'_, N> {
    fn intervals(&self) -> usize {
        (self.points.len() - 1) / (CHECKS + 1)
    }

    fn load(&self, i: usize) -> &Load<N> {
        &self.points[i * (CHECKS + 1)]
    }

    /// `ṡ²` at the points of the grid.
    fn fastest(&self) -> Result<Vec<f64>, Error> {
        let n = self.intervals();
        let infeasible = |i: usize| Failure::Missing(SPEED).at_path(self.length * (i as f64 / n as f64));
        // Ranges of ṡ² from which the stop can be reached.
        let mut ranges = std::vec![[0.0; 2]; n + 1];
        for i in (0..n).rev() {
            ranges[i] = self.strips(i, ranges[i + 1]).range(self.speed_limit(i)).ok_or(infeasible(i))?;
        }
        let mut squares = Vec::with_capacity(n + 1);
        let mut square = 0.0;
        if ranges[0][0] > 0.0 {
            return Err(infeasible(0));
        }
        squares.push(square);
        for i in 0..n {
            let [low, high] = ranges[i + 1];
            let acceleration = self.strips(i, ranges[i + 1]).bounds(square)[1].at(square);
            square = (square + 2.0 * self.interval * acceleration).clamp(low, high);
            squares.push(square);
        }
        Ok(squares)
    }

    /// The largest ṡ² that the speeds of the joints allow.
    fn speed_limit(&self, i: usize) -> f64 {
        let speeds = self.load(i).tangent.iter().zip(&self.limits.rates.speed);
        // A joint that stands has 0/0 where it has no limit either.
        speeds.filter(|(tangent, _)| **tangent != 0.0).fold(f64::INFINITY, |least, (tangent, limit)| {
            let rate = limit / tangent.abs();
            least.min(rate * rate)
        })
    }

    /// What `u` and `x` at the beginning of interval `i` must satisfy for the limits to hold at both its ends, and for
    /// `x` at its end to be in the range `next`.
    fn strips(&self, i: usize, next: [f64; 2]) -> Strips {
        let mut strips = Strips { lines: Vec::with_capacity(8 * N + 2), lowest: 0.0, highest: f64::INFINITY };
        for (load, ahead) in [(self.load(i), 0.0), (self.load(i + 1), 2.0 * self.interval)] {
            for j in 0..N {
                let acceleration = self.limits.rates.acceleration[j];
                strips.add(
                    load.tangent[j] + ahead * load.curvature[j],
                    load.curvature[j],
                    [-acceleration, acceleration],
                );
                let (torque, gravity) = (self.limits.torque[j], load.gravity[j]);
                strips.add(
                    load.inertia[j] + ahead * load.centrifugal[j],
                    load.centrifugal[j],
                    [-torque - gravity, torque - gravity],
                );
            }
        }
        strips.add(2.0 * self.interval, 1.0, next);
        strips
    }

    /// The largest ratios to `limits` in the motion given by ṡ² at the points of the grid.
    fn excess(&self, squares: &[f64], limits: &MotorLimits<N>) -> [[f64; N]; 3] {
        let mut worst = [[0.0; N]; 3];
        for (i, pair) in squares.windows(2).enumerate() {
            let acceleration = (pair[1] - pair[0]) / (2.0 * self.interval);
            for k in 0..=CHECKS + 1 {
                let part = k as f64 / (CHECKS + 1) as f64;
                let square = (1.0 - part) * pair[0] + part * pair[1];
                let ratios = self.points[i * (CHECKS + 1) + k].ratios(square, acceleration, limits);
                for (worst, ratio) in worst.iter_mut().flatten().zip(ratios.iter().flatten()) {
                    *worst = ratio.max(*worst);
                }
            }
        }
        worst
    }
}

/// `u = intercept + slope · x`
#[derive(Clone, Copy)]
struct Line {
    intercept: f64,
    slope: f64,
}

impl Line {
    fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }

    /// Rounding errors of [`at`](Self::at), with a margin.
    fn rounding(&self, x: f64) -> f64 {
        1e-14 * (self.intercept.abs() + (self.slope * x).abs())
    }
}

/// A convex set of `(u, x)`: between pairs of parallel lines, `x` in a range.
struct Strips {
    /// `low ≤ α u + β x ≤ high`, α not zero: `[α, β, low, high]`.
    lines: Vec<[f64; 4]>,
    lowest: f64,
    highest: f64,
}

impl Strips {
    fn add(&mut self, alpha: f64, beta: f64, [low, high]: [f64; 2]) {
        if alpha != 0.0 {
            self.lines.push([alpha, beta, low, high]);
            return;
        }
        // Without u, a range of x; an empty one where a torque at rest is beyond its limit.
        let [a, b] = [low / beta, high / beta];
        if beta != 0.0 {
            self.lowest = self.lowest.max(a.min(b));
            self.highest = self.highest.min(a.max(b));
        } else if low > 0.0 || high < 0.0 {
            self.highest = f64::NEG_INFINITY;
        }
    }

    /// The lines that bound `u` from below and from above at `x`; crossed where there is no `u`.
    fn bounds(&self, x: f64) -> [Line; 2] {
        let mut low = Line { intercept: f64::NEG_INFINITY, slope: 0.0 };
        let mut high = Line { intercept: f64::INFINITY, slope: 0.0 };
        for &[alpha, beta, from, to] in &self.lines {
            let (from, to) = if alpha > 0.0 { (from, to) } else { (to, from) };
            let [from, to] = [from, to].map(|bound| Line { intercept: bound / alpha, slope: -beta / alpha });
            if from.at(x) > low.at(x) {
                low = from;
            }
            if to.at(x) < high.at(x) {
                high = to;
            }
        }
        [low, high]
    }

    /// The range of `x` at which there is a `u`, up to `limit`; none where the set is empty.
    fn range(&self, limit: f64) -> Option<[f64; 2]> {
        let (lowest, highest) = (self.lowest, self.highest.min(limit));
        let high = self.nearest(highest.min(FASTEST), -1.0)?;
        let low = self.nearest(lowest, 1.0)?;
        (lowest <= low && low <= high).then_some([low, high])
    }

    /// The point nearest to `x` in `direction` at which there is a `u`.
    ///
    /// The length of the range of u is a concave, piecewise linear function of x: Newton's method from outside its zero
    /// never steps over it, and ends after as many steps as there are pieces.
    fn nearest(&self, mut x: f64, direction: f64) -> Option<f64> {
        for _ in 0..=4 * self.lines.len() * self.lines.len() {
            let [low, high] = self.bounds(x);
            if high.at(x) - low.at(x) >= -(low.rounding(x) + high.rounding(x)) {
                return Some(x);
            }
            let crossing = (low.intercept - high.intercept) / (high.slope - low.slope);
            // Away from the set, or no crossing at all: the set is empty.
            if !((crossing - x) * direction > 0.0 && (0.0..=FASTEST).contains(&crossing)) {
                return None;
            }
            x = crossing;
        }
        None
    }
}
