//! Numerical inverse kinematics: coordinates at which a body of any mechanism takes a given pose, by damped least squares.
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
//! with the Jacobian's first three rows divided by `L`. Where that is so short that their squares might overflow, both halves are
//! made smaller by one factor, which changes nothing. The damping fades with the error, so that regular solutions are
//! approached quadratically, but for a small `w`, so that singular ones do no harm. `μ` begins at 1; it grows where a step makes the
//! error larger, which is then taken back, and shrinks with every other, so that the best place is found soon where the target is
//! out of reach. Coordinates at a limit that the error pushes against are held there; the others go on.
//!
//! The method is local: it finds a solution near the guess, or a place that is the best around it. Start it from several
//! guesses to find several.
//!
//! # Source
//! Y. Nakamura and H. Hanafusa, *Inverse kinematic solutions with singularity robustness for robot manipulator control*,
//! Journal of Dynamic Systems, Measurement, and Control 108:3, 1986; C. W. Wampler, *Manipulator inverse kinematic solutions
//! based on vector formulations and damped least-squares methods*, IEEE Transactions on Systems, Man, and Cybernetics 16:1,
//! 1986; the damping by the error: T. Sugihara, *Solvability-unconcerned inverse kinematics by the Levenberg–Marquardt
//! method*, IEEE Transactions on Robotics 27:5, 2011.

use core::error::Error;
use core::fmt;

use nalgebra::Vector3;

use crate::attitude::{self, NotARotation};
use crate::dynamics::try_ldlt_solve;
use crate::matrix::to_matrix;
use crate::mechanism::Pose;
use crate::scalar::Scalar;

/// What is asked of the solution, and what may be spent on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedLeastSquares<const N: usize> {
    /// Smallest coordinates, `−∞` where there is no limit.
    pub lower: [f64; N],
    /// Largest coordinates, `∞` where there is no limit.
    pub upper: [f64; N],
    /// How far from its place the body may be \[m\].
    pub position_tolerance: f64,
    /// How far it may be turned from its attitude \[rad\].
    pub rotation_tolerance: f64,
    /// The length that counts as one radian \[m\]: that of the mechanism. Places or attitudes that it makes a millionth or less
    /// of what is weighed against them are found slowly, and beyond that not at all: [`NotReached::LengthOutOfProportion`].
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
pub enum NotReached<const N: usize> {
    /// Nothing near these coordinates is nearer to the target: it is out of reach, or the search ended in a local minimum.
    Stationary(Approach<N>),
    /// The same, and coordinates are held by their limits.
    AtLimits {
        /// The best coordinates.
        best: Approach<N>,
        /// Which of them are held.
        held: [bool; N],
    },
    /// The length that counts as one radian is so far from that of the mechanism that one half of the error hides the other.
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
    missing: [Vector3<f64>; 2],
    /// Both, and the Jacobian, as they are weighed.
    jacobian: [[f64; N]; 6],
    error: [f64; 6],
    /// `E`.
    cost: f64,
    /// Whether every entry of the pose and of the Jacobian is finite, and `E` is.
    is_finite: bool,
}

impl<const N: usize> DampedLeastSquares<N> {
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
    ///     let pose = Pose { position: [c1 + c12, s1 + s12, 0.0], rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] };
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
        loop {
            let approach = self.approach(&at, evaluations);
            if approach.position_error <= self.position_tolerance && approach.rotation_error <= self.rotation_tolerance
            {
                return Ok(approach);
            }
            let Step { change, held, gain } = self.step(&at, factor);
            let next = self.admitted(&core::array::from_fn(|i| at.q[i] + change[i]));
            if factor > MOST || gain <= LEAST_GAIN * at.cost || next == at.q {
                return Err(if let Some(reach) = self.out_of_proportion(&at.jacobian) {
                    NotReached::LengthOutOfProportion { best: approach, length: self.length, reach }
                } else if held.contains(&true) {
                    NotReached::AtLimits { best: approach, held }
                } else {
                    NotReached::Stationary(approach)
                });
            }
            if evaluations >= self.evaluations {
                return Err(NotReached::TooManyEvaluations(approach));
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
    fn checked(&self, target: &Pose<f64>, guess: &[f64; N]) -> Result<Target, NotReached<N>> {
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
        let rotation = attitude::orthonormalized(&to_matrix(&target.rotation))?;
        Ok(Target { position: Vector3::from(target.position), rotation })
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

    fn evaluation(&self, q: [f64; N], pose: &Pose<f64>, mut jacobian: [[f64; N]; 6], target: &Target) -> Evaluation<N> {
        let missing = [
            target.position - Vector3::from(pose.position),
            attitude::log(&(target.rotation * to_matrix(&pose.rotation).transpose())),
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
        let [position_error, rotation_error] = at.missing.map(|missing| norm(&missing));
        Approach { q: at.q, position_error, rotation_error, evaluations }
    }

    /// How far coordinates move the body \[m\] and turn it \[rad\], where the length of a radian weighs one of the two away.
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

struct Step<const N: usize> {
    /// `Δq`.
    change: [f64; N],
    /// The coordinates left at their limits.
    held: [bool; N],
    /// By how much `E` would fall to first order, were the damping not increased.
    gain: f64,
}

/// The Euclidean norm, whatever the size of the components.
fn norm(x: &Vector3<f64>) -> f64 {
    let greatest = x.amax();
    if greatest > 0.0 && greatest.is_finite() {
        greatest * Scalar::sqrt((x / greatest).norm_squared())
    } else {
        greatest
    }
}

struct Target {
    position: Vector3<f64>,
    rotation: nalgebra::Matrix3<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    /// Two links of one metre in the x, y plane, and a hand that turns.
    fn planar(q: &[f64; 3]) -> (Pose<f64>, [[f64; 3]; 6]) {
        let [(s1, c1), (s12, c12), (s, c)] = [q[0], q[0] + q[1], q[0] + q[1] + q[2]].map(Scalar::sin_cos);
        let pose = Pose { position: [c1 + c12, s1 + s12, 0.0], rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] };
        let mut jacobian = [[0.0; 3]; 6];
        jacobian[0] = [-s1 - s12, -s12, 0.0];
        jacobian[1] = [c1 + c12, c12, 0.0];
        jacobian[5] = [1.0; 3];
        (pose, jacobian)
    }

    /// The same with a fourth link of half a metre between: one coordinate more than needed.
    fn redundant(q: &[f64; 4]) -> (Pose<f64>, [[f64; 4]; 6]) {
        let mut angle = 0.0;
        let mut position = [0.0; 3];
        let mut jacobian = [[0.0; 4]; 6];
        for (i, length) in [1.0, 0.5, 1.0, 0.0].into_iter().enumerate() {
            angle += q[i];
            let (s, c) = Scalar::sin_cos(angle);
            position[0] += length * c;
            position[1] += length * s;
            for k in 0..=i {
                jacobian[0][k] -= length * s;
                jacobian[1][k] += length * c;
            }
            jacobian[5][i] = 1.0;
        }
        let (s, c) = Scalar::sin_cos(angle);
        (Pose { position, rotation: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] }, jacobian)
    }

    fn difference(a: &Pose<f64>, b: &Pose<f64>) -> f64 {
        let entries = |pose: &Pose<f64>| [pose.position, pose.rotation[0], pose.rotation[1], pose.rotation[2]];
        let (a, b) = (entries(a), entries(b));
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_regular_pose_is_found_in_a_few_steps() {
        let (target, _) = planar(&[0.4, -1.1, 2.0]);
        let solver = DampedLeastSquares { position_tolerance: 1e-13, rotation_tolerance: 1e-13, ..Default::default() };
        let found = solver.solve(planar, &target, &[0.0, -0.5, 1.5]).expect("reached");
        assert!(difference(&planar(&found.q).0, &target) < 1e-13);
        assert!(found.evaluations <= 10, "{}", found.evaluations);
    }

    #[test]
    fn a_redundant_mechanism_has_a_solution_near_the_guess() {
        let guess = [0.3, 0.4, -0.2, 0.1];
        let (target, _) = redundant(&[0.35, 0.3, -0.1, 0.2]);
        let found = DampedLeastSquares::default().solve(redundant, &target, &guess).expect("reached");
        assert!(difference(&redundant(&found.q).0, &target) < 1e-10);
        assert!(found.q.iter().zip(guess).all(|(q, guess)| (q - guess).abs() < 0.3));
    }

    #[test]
    fn a_singular_guess_is_left() {
        // Stretched, a pull inwards moves nothing to first order; sideways it does.
        let (target, _) = planar(&[0.2, 1.0, -0.3]);
        let found = DampedLeastSquares::default().solve(planar, &target, &[0.0, 0.0, 0.0]).expect("reached");
        assert!(difference(&planar(&found.q).0, &target) < 1e-9);
    }

    #[test]
    fn out_of_reach_the_best_is_told() {
        let target = Pose { position: [2.5, 0.0, 0.0], ..planar(&[0.0; 3]).0 };
        let best = match DampedLeastSquares::default().solve(planar, &target, &[0.3, 0.4, -0.5]) {
            Err(NotReached::Stationary(best) | NotReached::TooManyEvaluations(best)) => best,
            other => panic!("{other:?}"),
        };
        // The damping shrinks with every good step: 19 evaluations to nine digits.
        assert!((best.position_error - 0.5).abs() < 1e-9 && best.evaluations <= 25, "{best:?}");
    }

    /// The planar arm in another unit of length, of which `scale` make a metre.
    fn scaled(scale: f64) -> impl Fn(&[f64; 3]) -> (Pose<f64>, [[f64; 3]; 6]) {
        move |q| {
            let (mut pose, mut jacobian) = planar(q);
            pose.position.iter_mut().chain(jacobian[..3].iter_mut().flatten()).for_each(|x| *x *= scale);
            (pose, jacobian)
        }
    }

    /// The search is the same in millimetres and in miles, and the length of a radian counts.
    #[test]
    fn the_unit_of_length_does_not_matter() {
        let wanted = [0.4, -1.1, 2.0];
        for length in [0.03, 0.5, 1.0, 40.0] {
            let mut evaluations = None;
            for scale in [1.0, 1024.0, 2.0_f64.powi(-20), 2.0_f64.powi(400), 2.0_f64.powi(-400)] {
                let model = scaled(scale);
                let (target, _) = model(&wanted);
                let solver = DampedLeastSquares {
                    length: length * scale,
                    position_tolerance: 1e-12 * scale,
                    rotation_tolerance: 1e-12,
                    ..Default::default()
                };
                let found = solver.solve(&model, &target, &[0.0, -0.5, 1.5]).expect("reached");
                assert!(found.evaluations <= 12 && found.q.iter().zip(wanted).all(|(q, w)| (q - w).abs() < 1e-11));
                // To the last evaluation, which rounding may make needless.
                let first = *evaluations.get_or_insert(found.evaluations);
                assert!(first.abs_diff(found.evaluations) <= 1, "{length} {scale}: {found:?}");
            }
        }
    }

    /// The finding: a miss of 0.65 m was returned as reached, because its square, weighed with such a length, is zero.
    #[test]
    fn a_length_out_of_proportion_is_refused() {
        let (target, _) = planar(&[0.2, 1.0, -0.3]);
        let guess = [0.0, 0.5, 0.4];
        for length in [1e300, f64::MAX, 1e160, 1e100, 1e20, 1e-20, 1e-100, 1e-160, 1e-300, f64::MIN_POSITIVE] {
            let solver = DampedLeastSquares { length, ..Default::default() };
            let (best, reach) = match solver.solve(planar, &target, &guess) {
                Err(NotReached::LengthOutOfProportion { best, length: told, reach }) if told == length => (best, reach),
                other => panic!("{length:e}: {other:?}"),
            };
            let (pose, _) = planar(&best.q);
            let miss = (Vector3::from(pose.position) - Vector3::from(target.position)).norm();
            assert!((best.position_error - miss).abs() < 1e-15, "{length:e}: {best:?}, not {miss}");
            assert!(best.position_error > 1e-10 || best.rotation_error > 1e-10, "{best:?}");
            assert!((0.5..=2.0).contains(&reach[0]) && reach[1] == 1.0, "{reach:?}");
        }
    }

    #[test]
    fn lower_limits_hold_and_let_go() {
        // The mirror image of a limit above: the second joint must not go below −0.5, where the target is.
        let (target, _) = planar(&[-0.2, -1.0, 0.3]);
        let narrow = DampedLeastSquares { upper: [PI, -0.2, PI], lower: [-PI, -0.5, -PI], ..Default::default() };
        match narrow.solve(planar, &target, &[-0.2, -0.3, 0.3]) {
            Err(NotReached::AtLimits { best, held }) => {
                assert_eq!(held, [false, true, false]);
                assert_eq!(best.q[1], -0.5);
            }
            other => panic!("{other:?}"),
        }
        // At a limit that the error pulls away from nothing is held, at either end.
        for (lower, upper, sign) in [(0.0, 2.0, 1.0), (-2.0, 0.0, -1.0)] {
            let (target, _) = planar(&[0.2 * sign, sign, -0.3 * sign]);
            let limits = DampedLeastSquares { lower: [-PI, lower, -PI], upper: [PI, upper, PI], ..Default::default() };
            let found = limits.solve(planar, &target, &[0.5 * sign, 0.0, 0.0]).expect("reached");
            assert!((found.q[1] - sign).abs() < 1e-8, "{found:?}");
        }
    }

    #[test]
    fn limits_hold() {
        // Elbow up is forbidden: the other configuration is found from the other side of it, or nothing.
        let (target, _) = planar(&[0.2, 1.0, -0.3]);
        let within = DampedLeastSquares { upper: [PI, 0.0, PI], lower: [-PI; 3], ..Default::default() };
        let found = within.solve(planar, &target, &[0.9, -0.4, 0.0]).expect("reached with the elbow down");
        assert!((found.q[1] + 1.0).abs() < 1e-8, "{found:?}");
        // No configuration has the second joint within these.
        let narrow = DampedLeastSquares { upper: [PI, 0.5, PI], lower: [-PI, 0.2, -PI], ..Default::default() };
        match narrow.solve(planar, &target, &[0.2, 0.3, -0.3]) {
            Err(NotReached::AtLimits { best, held }) => {
                assert_eq!(held, [false, true, false]);
                assert_eq!(best.q[1], 0.5);
                assert!(best.position_error > 0.05);
            }
            other => panic!("{other:?}"),
        }
        // A guess beyond the limits starts at them.
        let found = within.solve(planar, &target, &[0.9, 3.0, 0.0]);
        assert!(found.is_ok_and(|found| found.q[1] <= 0.0));
    }

    #[test]
    fn bad_input_is_refused() {
        let (target, _) = planar(&[0.4, -1.1, 2.0]);
        let solver = DampedLeastSquares::default();
        let guess = [0.0, 1.0, 0.0];
        let nowhere = Pose { position: [0.0, f64::NAN, 0.0], ..target };
        assert_eq!(solver.solve(planar, &nowhere, &guess), Err(NotReached::NonFiniteTarget { component: 1 }));
        let mirror = Pose { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]], ..target };
        let reflection = NotReached::Rotation(NotARotation::Reflection { determinant: -1.0 });
        assert_eq!(solver.solve(planar, &mirror, &guess), Err(reflection));
        let found = solver.solve(planar, &target, &[0.0, f64::NAN, 0.0]);
        assert!(matches!(found, Err(NotReached::InvalidLimits { coordinate: 1, .. })), "{found:?}");
        let crossed = DampedLeastSquares { lower: [1.0; 3], upper: [1.0, 1.0, 0.0], ..Default::default() };
        let found = crossed.solve(planar, &target, &guess);
        assert_eq!(found, Err(NotReached::InvalidLimits { coordinate: 2, lower: 1.0, guess: 0.0, upper: 0.0 }));
        let exact = DampedLeastSquares { rotation_tolerance: 0.0, ..Default::default() };
        let found = exact.solve(planar, &target, &guess);
        assert_eq!(found, Err(NotReached::InvalidTolerance { position: 1e-10, rotation: 0.0, length: 1.0 }));
        let nan = |_: &[f64; 3]| (target, [[f64::NAN; 3]; 6]);
        assert_eq!(solver.solve(nan, &target, &guess), Err(NotReached::NonFinite { q: guess }));
        for entry in 0..12 {
            let broken = |q: &[f64; 3]| {
                let (mut pose, jacobian) = planar(q);
                let mut entries = pose.position.iter_mut().chain(pose.rotation.iter_mut().flatten());
                *entries.nth(entry).expect("twelve entries") = f64::NAN;
                (pose, jacobian)
            };
            // At the solution nothing but the NaN is off.
            let found = solver.solve(broken, &target, &[0.4, -1.1, 2.0]);
            assert_eq!(found, Err(NotReached::NonFinite { q: [0.4, -1.1, 2.0] }), "entry {entry}");
        }
        let short = DampedLeastSquares { evaluations: 2, ..Default::default() };
        let found = short.solve(planar, &target, &guess);
        assert!(matches!(found, Err(NotReached::TooManyEvaluations(best)) if best.evaluations == 2), "{found:?}");
    }
}
