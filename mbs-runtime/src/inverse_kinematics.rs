//! Numerical inverse kinematics: coordinates at which a body of any mechanism takes a given pose, by damped least
//! squares.
//!
//! The error of the pose is six numbers, in world axes:
//!
//! ```text
//! e = [ (p* − p)/L ; log(R* Rᵀ) ],   E = ½ eᵀe
//! ```
//!
//! where `L` is the length that counts as one radian. A step solves
//!
//! ```text
//! (JᵀJ + λ 1) Δq = Jᵀ e,   λ = μ E + max(μ, 1) w
//! ```
//!
//! with the Jacobian's first three rows divided by `L`. Where that is so short that their squares might overflow, both
//! halves are made smaller by one factor, which changes nothing. The damping fades with the error, so that regular
//! solutions are approached quadratically, but for a small `w`, so that singular ones do no harm. `μ` begins at 1; it
//! grows where a step makes the error larger, which is then taken back, and shrinks with every other, so that the best
//! place is found soon where the target is out of reach. Coordinates at a limit that the error pushes against are held
//! there; the others go on.
//!
//! The method is local: it finds a solution near the guess, or a place that is the best around it. Start it from
//! several guesses to find several. Where no step leads away from the guess, as from an arm that is stretched towards
//! the target, it starts a little beside.
//!
//! # Source
//! Y. Nakamura and H. Hanafusa, *Inverse kinematic solutions with singularity robustness for robot manipulator
//! control*, Journal of Dynamic Systems, Measurement, and Control 108:3, 1986; C. W. Wampler, *Manipulator inverse
//! kinematic solutions based on vector formulations and damped least-squares methods*, IEEE Transactions on Systems,
//! Man, and Cybernetics 16:1, 1986; the damping by the error: T. Sugihara, *Solvability-unconcerned inverse kinematics
//! by the Levenberg–Marquardt method*, IEEE Transactions on Robotics 27:5, 2011.

use core::error::Error;
use core::fmt;

use crate::attitude::{self, NotARotation};
use crate::dynamics::try_ldlt_solve;
use crate::mechanism::Pose;
use crate::scalar::{Scalar, length};

/// What is asked of the solution, and what may be spent on it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DampedLeastSquares<const N: usize> {
    /// Smallest coordinates, `−∞` where there is no limit.
    pub lower: [f64; N],
    /// Largest coordinates, `∞` where there is no limit.
    pub upper: [f64; N],
    /// How far from its place the body may be \[m\].
    pub position_tolerance: f64,
    /// How far it may be turned from its attitude \[rad\].
    pub rotation_tolerance: f64,
    /// The length that counts as one radian \[m\]: that of the mechanism. Places or attitudes that it makes a millionth
    /// or less of what is weighed against them are found slowly, and beyond that not at all:
    /// [`NotReached::LengthOutOfProportion`].
    pub length: f64,
    /// How often the pose and the Jacobian may be evaluated.
    pub evaluations: usize,
}

impl<const N: usize> Default for DampedLeastSquares<N> {
    /// No limits; 1e-10 m and 1e-10 rad; one metre; 200 evaluations.
    fn default() -> Self {
        Self {
            lower: [f64::NEG_INFINITY; N],
            upper: [f64::INFINITY; N],
            position_tolerance: 1e-10,
            rotation_tolerance: 1e-10,
            length: 1.0,
            evaluations: 200,
        }
    }
}

/// Coordinates, and how near to the target they bring the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach<const N: usize> {
    /// Coordinates, within the limits.
    pub q: [f64; N],
    /// The distance from the target's position \[m\].
    pub position_error: f64,
    /// The angle from the target's attitude \[rad\].
    pub rotation_error: f64,
    /// How often the pose and the Jacobian were evaluated.
    pub evaluations: usize,
}

/// Why no coordinates were found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotReached<const N: usize> {
    /// To first order nothing near these coordinates is nearer to the target: it is out of reach, or the search ended
    /// in a local minimum. A guess that is such a place may be a singular one: the search has begun again beside it.
    Stationary(Approach<N>),
    /// To first order nothing near these coordinates is nearer to the target, and some are held by their limits.
    AtLimits {
        /// The best coordinates.
        best: Approach<N>,
        /// Which of them are held.
        held: [bool; N],
    },
    /// The length that counts as one radian is so far from that of the mechanism that one half of the error hides the
    /// other.
    LengthOutOfProportion {
        /// The best coordinates.
        best: Approach<N>,
        /// The length that counts as one radian \[m\].
        length: f64,
        /// How far a unit of a coordinate moves the body at the most \[m\], and how far it turns it \[rad\].
        reach: [f64; 2],
    },
    /// The allowed number of evaluations was used up on the way.
    TooManyEvaluations(Approach<N>),
    /// The pose, the Jacobian, or one of their squares is infinite or NaN at the guess.
    NonFinite {
        /// The coordinates, within the limits.
        q: [f64; N],
    },
    /// The position of the target is infinite or NaN.
    NonFiniteTarget {
        /// Its component, counted from 0.
        component: usize,
    },
    /// The attitude of the target is none.
    Rotation(NotARotation),
    /// A coordinate of the guess is NaN, or its limits are not in order.
    InvalidLimits {
        /// Which, counted from 0.
        coordinate: usize,
        /// Its smallest value.
        lower: f64,
        /// Its guess.
        guess: f64,
        /// Its largest value.
        upper: f64,
    },
    /// A tolerance, or the length of a radian, is not a positive number.
    InvalidTolerance {
        /// That of the position \[m\].
        position: f64,
        /// That of the attitude \[rad\].
        rotation: f64,
        /// The length that counts as one radian \[m\].
        length: f64,
    },
}

impl<const N: usize> fmt::Display for NotReached<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stationary(best) => write!(f, "the pose is not reached: nothing near is nearer than {best}"),
            Self::AtLimits { best, held } => {
                let held = held.iter().filter(|&&held| held).count();
                write!(f, "the pose is not reached within the limits, {held} coordinates are at theirs: {best}")
            }
            Self::TooManyEvaluations(best) => {
                write!(f, "the pose is not reached in {} evaluations: {best}", best.evaluations)
            }
            Self::LengthOutOfProportion { best, length, reach: [moved, turned] } => write!(
                f,
                "the length that counts as one radian, {length:e} m, is out of proportion: a coordinate moves the body by \
                 {moved:e} m and turns it by {turned:e} rad at the most; found {best}"
            ),
            Self::NonFinite { q } => {
                write!(f, "the pose, its Jacobian, or one of their squares is infinite or NaN at {q:?}")
            }
            Self::NonFiniteTarget { component } => {
                write!(f, "component {component} of the target's position is infinite or NaN")
            }
            Self::Rotation(error) => error.fmt(f),
            Self::InvalidLimits { coordinate, lower, guess, upper } => {
                write!(f, "coordinate {coordinate} has the limits {lower} and {upper} and the guess {guess}")
            }
            Self::InvalidTolerance { position, rotation, length } => write!(
                f,
                "tolerances and the length of a radian must be positive, found {position} m, {rotation} rad, {length} m"
            ),
        }
    }
}

impl<const N: usize> fmt::Display for Approach<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "off by {:e} m and {:e} rad", self.position_error, self.rotation_error)
    }
}

impl<const N: usize> Error for NotReached<N> {}

impl<const N: usize> From<NotARotation> for NotReached<N> {
    fn from(error: NotARotation) -> Self {
        Self::Rotation(error)
    }
}

/// The damping that stays, as a part of the mean of the diagonal of `JᵀJ`.
const RESIDUAL_DAMPING: f64 = 1e-9;
/// By how much a rejected step damps the next one more.
const GROWTH: f64 = 8.0;
/// The smallest `μ`.
const LEAST: f64 = 1e-6;
/// The `μ` at which a step that still makes the error larger is below rounding.
const MOST: f64 = 1e18;

/// A step that promises less of the error than this part of it leads nowhere; a regular one promises nearly all.
const LEAST_GAIN: f64 = 1e-9;

/// Where the squares of the halves of the Jacobian are farther apart, the damping of one hides the other.
const PROPORTION: f64 = 1e14;

/// The pose at some coordinates, its Jacobian, and what is missing to the target.
struct Evaluation<const N: usize> {
    q: [f64; N],
    /// What is missing to the position \[m\] and to the attitude \[rad\].
    missing: [[f64; 3]; 2],
    /// Both, and the Jacobian, as they are weighed.
    jacobian: [[f64; N]; 6],
    error: [f64; 6],
    /// `E`.
    cost: f64,
    /// Whether every entry of the pose and of the Jacobian is finite, and `E` is.
    is_finite: bool,
}

impl<const N: usize> DampedLeastSquares<N> {
    /// Smallest and largest coordinates.
    #[must_use]
    pub const fn with_limits(self, lower: [f64; N], upper: [f64; N]) -> Self {
        Self { lower, upper, ..self }
    }

    /// How far from its place \[m\] and from its attitude \[rad\] the body may be.
    #[must_use]
    pub const fn with_tolerances(self, position_tolerance: f64, rotation_tolerance: f64) -> Self {
        Self { position_tolerance, rotation_tolerance, ..self }
    }

    /// The length that counts as one radian \[m\].
    #[must_use]
    pub const fn with_length(self, length: f64) -> Self {
        Self { length, ..self }
    }

    /// How often the pose and the Jacobian may be evaluated.
    #[must_use]
    pub const fn with_evaluations(self, evaluations: usize) -> Self {
        Self { evaluations, ..self }
    }

    /// Coordinates near `guess` at which the body takes the pose `target`.
    ///
    /// | argument | meaning                                                    | shape                        | unit       |
    /// |----------|------------------------------------------------------------|------------------------------|------------|
    /// | `model`  | the pose of the body at `q` and its geometric Jacobian: rows of the velocity of its origin, then of its angular velocity, in world axes, as `<output>_jacobian` is generated | `N` to [`Pose`], `6 × N` | m, rad |
    /// | `target` | the pose wanted, orthonormalized                           |                              | m          |
    /// | `guess`  | where to begin; moved into the limits                      | `N`                          | as declared |
    ///
    /// ```
    /// use mbs_runtime::inverse_kinematics::DampedLeastSquares;
    /// use mbs_runtime::{Pose, Scalar};
    ///
    /// // Two links of one metre in the x, y plane, and a hand that turns.
    /// let arm = |q: &[f64; 3]| {
    ///     let [(s1, c1), (s12, c12), (s, c)] = [q[0], q[0] + q[1], q[0] + q[1] + q[2]].map(f64::sin_cos);
    ///     let rotation = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
    ///     let pose = Pose { position: [c1 + c12, s1 + s12, 0.0], rotation };
    ///     let mut jacobian = [[0.0; 3]; 6];
    ///     jacobian[0] = [-s1 - s12, -s12, 0.0];
    ///     jacobian[1] = [c1 + c12, c12, 0.0];
    ///     jacobian[5] = [1.0; 3];
    ///     (pose, jacobian)
    /// };
    /// let (target, _) = arm(&[0.3, 1.2, -0.4]);
    /// let found = DampedLeastSquares::default().solve(arm, &target, &[0.0, 0.5, 0.0]).unwrap();
    /// assert!((0..3).all(|i| (found.q[i] - [0.3, 1.2, -0.4][i]).abs() < 1e-9));
    /// ```
    ///
    /// # Errors
    /// [`NotReached`], with the best coordinates where the search began.
    pub fn solve(
        &self,
        mut model: impl FnMut(&[f64; N]) -> (Pose<f64>, [[f64; N]; 6]),
        target: &Pose<f64>,
        guess: &[f64; N],
    ) -> Result<Approach<N>, NotReached<N>> {
        let target = self.checked(target, guess)?;
        let mut evaluate = |q: [f64; N]| {
            let (pose, jacobian) = model(&q);
            self.evaluation(q, &pose, jacobian, &target)
        };
        let mut at = evaluate(self.admitted(guess));
        if !at.is_finite {
            return Err(NotReached::NonFinite { q: at.q });
        }
        let mut factor = 1.0;
        let mut evaluations = 1;
        let mut start = None;
        loop {
            let approach = self.approach(&at, evaluations);
            if approach.position_error <= self.position_tolerance && approach.rotation_error <= self.rotation_tolerance
            {
                return Ok(approach);
            }
            let Step { change, gain, .. } = self.step(&at, factor);
            let next = self.admitted(&core::array::from_fn(|i| at.q[i] + change[i]));
            let is_over = factor > MOST || gain <= LEAST_GAIN * at.cost || next == at.q;
            if is_over && evaluations == 1 && self.evaluations > 1 {
                let beside = evaluate(self.beside(&at));
                evaluations += 1;
                if beside.is_finite {
                    start = Some(core::mem::replace(&mut at, beside));
                    continue;
                }
            }
            if is_over {
                return Err(self.stationary(&nearer(start, at), evaluations));
            }
            if evaluations >= self.evaluations {
                return Err(NotReached::TooManyEvaluations(self.approach(&nearer(start, at), evaluations)));
            }
            let candidate = evaluate(next);
            evaluations += 1;
            if candidate.is_finite && candidate.cost < at.cost {
                at = candidate;
                factor = (factor / GROWTH).max(LEAST);
            } else {
                factor *= GROWTH;
            }
        }
    }

    /// The target with its attitude orthonormalized, if that and everything else that was given makes sense.
    fn checked(&self, target: &Pose<f64>, guess: &[f64; N]) -> Result<Pose<f64>, NotReached<N>> {
        let [position, rotation, length] = [self.position_tolerance, self.rotation_tolerance, self.length];
        if ![position, rotation, length].iter().all(|&x| x > 0.0 && x.is_finite()) {
            return Err(NotReached::InvalidTolerance { position, rotation, length });
        }
        for coordinate in 0..N {
            let [lower, guess, upper] = [self.lower[coordinate], guess[coordinate], self.upper[coordinate]];
            if guess.is_nan() || lower.is_nan() || upper.is_nan() || lower > upper {
                return Err(NotReached::InvalidLimits { coordinate, lower, guess, upper });
            }
        }
        if let Some(component) = target.position.iter().position(|x| !x.is_finite()) {
            return Err(NotReached::NonFiniteTarget { component });
        }
        Ok(Pose { position: target.position, rotation: attitude::orthonormalized(&target.rotation)? })
    }

    /// `q`, every coordinate moved to its nearer limit if it is beyond.
    fn admitted(&self, q: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| q[i].max(self.lower[i]).min(self.upper[i]))
    }

    /// What a metre and a radian count for.
    fn weights(&self) -> [f64; 2] {
        const MOST: f64 = 1e100;
        if self.length * MOST > 1.0 { [1.0 / self.length, 1.0] } else { [MOST, MOST * self.length] }
    }

    fn evaluation(
        &self,
        q: [f64; N],
        pose: &Pose<f64>,
        mut jacobian: [[f64; N]; 6],
        target: &Pose<f64>,
    ) -> Evaluation<N> {
        let missing = [
            core::array::from_fn(|i| target.position[i] - pose.position[i]),
            attitude::difference(&target.rotation, &pose.rotation),
        ];
        let weights = self.weights();
        let error = core::array::from_fn(|r| weights[r / 3] * missing[r / 3][r % 3]);
        for (r, row) in jacobian.iter_mut().enumerate() {
            row.iter_mut().for_each(|entry| *entry *= weights[r / 3]);
        }
        let cost = 0.5 * error.iter().map(|e| e * e).sum::<f64>();
        let squares: f64 = jacobian.iter().flatten().map(|entry| entry * entry).sum();
        let mut entries = pose.position.iter().chain(pose.rotation.iter().flatten());
        let is_finite = (cost + squares).is_finite() && entries.all(|entry| entry.is_finite());
        Evaluation { q, missing, jacobian, error, cost, is_finite }
    }

    fn approach(&self, at: &Evaluation<N>, evaluations: usize) -> Approach<N> {
        let [position_error, rotation_error] = at.missing.map(|missing| length(missing.into_iter()));
        Approach { q: at.q, position_error, rotation_error, evaluations }
    }

    /// Why nothing is nearer to first order.
    fn stationary(&self, at: &Evaluation<N>, evaluations: usize) -> NotReached<N> {
        let best = self.approach(at, evaluations);
        let Step { held, .. } = self.step(at, 1.0);
        if let Some(reach) = self.out_of_proportion(&at.jacobian) {
            NotReached::LengthOutOfProportion { best, length: self.length, reach }
        } else if held.contains(&true) {
            NotReached::AtLimits { best, held }
        } else {
            NotReached::Stationary(best)
        }
    }

    /// Coordinates some hundredths of a radian beside these, in a direction that no mechanism is built for.
    fn beside(&self, at: &Evaluation<N>) -> [f64; N] {
        const STEP: f64 = 0.02;
        const GOLDEN: f64 = 0.618_033_988_749_894_8;
        let reach = length(at.jacobian.iter().flatten().copied()) / Scalar::sqrt(N as f64);
        let step = if reach > 0.0 { STEP / reach } else { STEP };
        self.admitted(&core::array::from_fn(|i| {
            let part = step * (0.5 + GOLDEN * (i + 1) as f64 % 1.0);
            if at.q[i] + part > self.upper[i] { at.q[i] - part } else { at.q[i] + part }
        }))
    }

    /// How far coordinates move the body \[m\] and turn it \[rad\], where the length of a radian weighs one of the two
    /// away.
    fn out_of_proportion(&self, jacobian: &[[f64; N]; 6]) -> Option<[f64; 2]> {
        let greatest = |rows: &[[f64; N]]| rows.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let weighed = [greatest(&jacobian[..3]), greatest(&jacobian[3..])];
        let weights = self.weights();
        let [moved, turned] = core::array::from_fn(|half| weighed[half] / weights[half]);
        let ratio = moved / self.length / turned;
        let hidden = moved > 0.0 && turned > 0.0 && !(1.0 / PROPORTION..=PROPORTION).contains(&(ratio * ratio));
        // A weight may be so small that nothing is left of an entry.
        let vanished = weights.iter().any(|weight| weight * weight < f64::MIN_POSITIVE);
        (hidden || vanished).then_some([moved, turned])
    }

    /// The step `Δq` with `μ = factor`.
    fn step(&self, at: &Evaluation<N>, factor: f64) -> Step<N> {
        let j = &at.jacobian;
        let gradient: [f64; N] = core::array::from_fn(|i| (0..6).map(|r| j[r][i] * at.error[r]).sum());
        let held: [bool; N] = core::array::from_fn(|i| {
            (at.q[i] <= self.lower[i] && gradient[i] < 0.0) || (at.q[i] >= self.upper[i] && gradient[i] > 0.0)
        });
        let trace: f64 = j.iter().flatten().map(|entry| entry * entry).sum();
        let damping = factor * at.cost + factor.max(1.0) * RESIDUAL_DAMPING * trace / N as f64;
        let mut normal = [[0.0; N]; N];
        for a in 0..N {
            for b in 0..=a {
                normal[a][b] = match (a == b, held[a] || held[b]) {
                    (true, true) => 1.0,
                    (false, true) => 0.0,
                    (same, false) => (0..6).map(|r| j[r][a] * j[r][b]).sum::<f64>() + if same { damping } else { 0.0 },
                };
            }
        }
        let right = core::array::from_fn(|i| if held[i] { 0.0 } else { gradient[i] });
        // The damping is far above the rounding that a pivot may hold; where all is zero, so is the step.
        let change = try_ldlt_solve(normal, right).unwrap_or([0.0; N]);
        let gain = (0..N).map(|i| right[i] * change[i]).sum::<f64>() * factor.max(1.0);
        Step { change, held, gain }
    }
}

/// The one with less of an error.
fn nearer<const N: usize>(start: Option<Evaluation<N>>, at: Evaluation<N>) -> Evaluation<N> {
    match start {
        Some(start) if start.cost <= at.cost => start,
        _ => at,
    }
}

struct Step<const N: usize> {
    /// `Δq`.
    change: [f64; N],
    /// The coordinates left at their limits.
    held: [bool; N],
    /// By how much `E` would fall to first order, were the damping not increased.
    gain: f64,
}

#[cfg(test)]
mod tests;
