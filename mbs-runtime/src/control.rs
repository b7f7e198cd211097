//! Linear systems and their regulators, for matrices of a size known to the compiler: nothing is allocated.
//!
//! ```text
//! ẋ = A x + B u,   y = C x + D u          continuous
//! x' = Φ x + Γ u,  y = C x + D u          sampled, u held from one sample to the next
//! ```
//!
//! | asked for                                          | here                                                                  |
//! |----------------------------------------------------|-----------------------------------------------------------------------|
//! | poles, natural frequencies, damping                | [`StateSpace::poles`], [`natural_frequency`], [`damping_ratio`]       |
//! | what inputs reach, what outputs show               | [`StateSpace::controllability_rank`], [`StateSpace::observability_rank`] |
//! | the sampled system                                 | [`StateSpace::sampled`]                                               |
//! | feedback that is the best for a quadratic cost     | [`lqr`], [`discrete_lqr`]                                             |
//! | forces that make errors die as designed            | [`ComputedTorque`]                                                    |
//! | forces that learn the masses they are to move      | [`AdaptiveControl`], [`regressor`], [`BodyParameters`]                |
//! | which of the masses a motion shows                 | [`RegressorStack`], [`BaseParameters`]                                |
//! | a controller that computes for a while, in the loop | [`SampledLoop`]                                                      |
//!
//! A and B of a mechanism are the first derivatives of its motion, [`Linearization`]: with `x = (δq, δq̇)`
//!
//! ```
//! use mbs_runtime::Linearization;
//! use mbs_runtime::control::{StateSpace, lqr};
//!
//! // An inverted pendulum of 0.5 m that a torque turns, 0.05 kg m²; upright.
//! let upright = Linearization { q: [[9.81 / 0.5]], qd: [[0.0]], u: [[1.0 / 0.05]] };
//! let (a, b) = ([[0.0, 1.0], [upright.q[0][0], upright.qd[0][0]]], [[0.0], upright.u[0]]);
//! let plant = StateSpace { a, b, c: [[1.0, 0.0]], d: [[0.0]] };
//! assert!(plant.poles().unwrap().iter().any(|pole| pole.re > 0.0) && plant.controllability_rank() == Ok(2));
//!
//! // A tenth of a radian counts as much as a radian per second and as a fifth of a newton metre.
//! let regulator = lqr(&a, &b, &[[100.0, 0.0], [0.0, 1.0]], &[[25.0]]).unwrap();
//! let closed = plant.with_feedback(&regulator.gain);
//! assert!(closed.poles().unwrap().iter().all(|pole| pole.re < 0.0));
//! ```
//!
//! [`Linearization`]: crate::Linearization

mod adaptive;
mod base_parameters;
mod body_parameters;
mod computed_torque;
mod dense;
mod discretization;
mod eigenvalues;
mod rank;
mod regulator;
mod sampled_loop;
mod stability;

use core::error::Error;
use core::fmt;

pub use adaptive::{AdaptiveControl, InvalidAdaptiveGain, Sliding, regressor};
pub use base_parameters::{BaseParameters, NotFiniteRegressor, RegressorStack};
pub use body_parameters::BodyParameters;
pub use computed_torque::{ComputedTorque, InvalidGain};
pub use eigenvalues::eigenvalues_in_place;
pub use regulator::{Regulator, discrete_lqr, lqr};
pub use sampled_loop::SampledLoop;

use dense::{difference, is_finite, product, transpose};

use crate::scalar::Scalar;

/// A complex number, as poles are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// The real part.
    pub re: f64,
    /// The imaginary part.
    pub im: f64,
}

impl Complex {
    /// `re + i im`.
    #[must_use]
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }
}

/// A linear system: N states, U inputs, Y outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateSpace<const N: usize, const U: usize, const Y: usize> {
    /// A, of the states: their rates, or of a sampled system the next ones.
    pub a: [[f64; N]; N],
    /// B, of the inputs.
    pub b: [[f64; U]; N],
    /// C, of the states: the outputs.
    pub c: [[f64; N]; Y],
    /// D, of the inputs: the outputs.
    pub d: [[f64; U]; Y],
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ControlError {
    /// An entry of a matrix is infinite or NaN, or so large that the computation overflows.
    NotFinite {
        /// A, B, C, Q or R.
        matrix: char,
    },
    /// A weight is not symmetric.
    NotSymmetric {
        /// Q or R.
        matrix: char,
        /// The row of an entry that is not that of its mirror image.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// A weight is not positive: R must be positive definite, Q must not be negative for any state.
    NotPositive {
        /// Q or R.
        matrix: char,
        /// The pivot that shows it, in the units of the matrix.
        pivot: f64,
        /// Its row.
        index: usize,
    },
    /// No feedback makes the loop stable at the least cost: an unstable motion is out of the reach of the inputs, or
    /// one that does not decay by itself costs nothing; both as the ranks count. Or the system is so unstable that
    /// rounding hides the solution.
    NotStabilizable,
    /// The sample time is not positive and finite.
    SampleTime {
        /// Its value \[s\].
        value: f64,
    },
    /// The iteration for the eigenvalues does not converge; it is not known to happen with finite numbers.
    NotConverged,
}

impl fmt::Display for ControlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { matrix } => write!(f, "{matrix} has an entry that is infinite, NaN, or too large"),
            Self::NotSymmetric { matrix, row, column } => {
                write!(f, "{matrix} must be symmetric, entries [{row}][{column}] and [{column}][{row}] differ")
            }
            Self::NotPositive { matrix, pivot, index } => {
                let kind = if matrix == 'Q' { "semidefinite" } else { "definite" };
                write!(f, "{matrix} must be positive {kind}, pivot {index} is {pivot:?}")
            }
            Self::NotStabilizable => f.write_str(
                "no feedback makes the loop stable: an unstable motion is not reached by the inputs, or one that does not \
                 decay by itself costs nothing, or the system is so unstable that rounding hides the solution",
            ),
            Self::SampleTime { value } => write!(f, "the sample time must be positive and finite, it is {value:?} s"),
            Self::NotConverged => f.write_str("the eigenvalues were not found"),
        }
    }
}

impl Error for ControlError {}

impl<const N: usize, const U: usize, const Y: usize> StateSpace<N, U, Y> {
    /// The eigenvalues of A \[1/s\], or \[1\] of a sampled system; complex ones in pairs, the one above the real axis
    /// first.
    ///
    /// A is balanced, brought to Hessenberg form by reflections, and deflated by Francis' double steps, of any size by
    /// [`eigenvalues_in_place`].
    ///
    /// # Errors
    /// [`ControlError::NotFinite`], [`ControlError::NotConverged`].
    ///
    /// # Source
    /// B. N. Parlett and C. Reinsch, *Balancing a matrix for calculation of eigenvalues and eigenvectors*, and R. S.
    /// Martin, G. Peters and J. H. Wilkinson, *The QR algorithm for real Hessenberg matrices*, both in Wilkinson and
    /// Reinsch, *Handbook for Automatic Computation II*, 1971.
    pub fn poles(&self) -> Result<[Complex; N], ControlError> {
        eigenvalues::eigenvalues(&self.a)
    }

    /// How many directions of the state the inputs reach.
    ///
    /// An orthonormal basis of `B, A B, A² B, …` is built vector by vector, after states were scaled by powers of two
    /// that balance A and B; what is left of a vector of length 1 counts as rounding below `1e-10`.
    ///
    /// # Errors
    /// [`ControlError::NotFinite`].
    pub fn controllability_rank(&self) -> Result<usize, ControlError> {
        rank::reachable(&self.a, &self.b)
    }

    /// How many directions of the state the outputs show in time: the controllability rank of `(Aᵀ, Cᵀ)`.
    ///
    /// # Errors
    /// [`ControlError::NotFinite`].
    pub fn observability_rank(&self) -> Result<usize, ControlError> {
        rank::reachable(&transpose(&self.a), &transpose(&self.c))
            .map_err(|_| ControlError::NotFinite { matrix: if is_finite(&self.a) { 'C' } else { 'A' } })
    }

    /// The sampled system, with inputs held from one sample to the next, `sample_time` \[s\] later.
    ///
    /// `Φ = exp(A T)` and `Γ = ∫₀ᵀ exp(A s) ds B` are blocks of the exponential of `[[A, B], [0, 0]] T`, which is
    /// computed by blocks: the Padé approximant of degree 13 of a 2⁻ˢ-th of it, squared s times, after states were
    /// scaled by powers of two that balance A and B. A need not be regular. Squaring doubles what has been rounded:
    /// entries are known to some `2ˢ` roundings, beside a motion that decays with `exp(−1e10 t/T)` to 2e-7.
    ///
    /// # Errors
    /// [`ControlError::SampleTime`], [`ControlError::NotFinite`].
    ///
    /// # Source
    /// N. J. Higham, *The scaling and squaring method for the matrix exponential revisited*, SIAM Journal on Matrix
    /// Analysis 26:4, 2005, algorithm 2.3; the block matrix: C. F. Van Loan, *Computing integrals involving the matrix
    /// exponential*, IEEE Transactions on Automatic Control 23:3, 1978.
    pub fn sampled(&self, sample_time: f64) -> Result<Self, ControlError> {
        let (a, b) = discretization::zero_order_hold(&self.a, &self.b, sample_time)?;
        Ok(Self { a, b, ..*self })
    }

    /// The system with `u = −K x + v`, of which v is the input: `A − B K` and `C − D K`.
    #[must_use]
    pub fn with_feedback(&self, gain: &[[f64; N]; U]) -> Self {
        let a = difference(&self.a, &product(&self.b, gain));
        Self { a, c: difference(&self.c, &product(&self.d, gain)), ..*self }
    }
}

/// `ω₀ = |p|` of a pole p of a continuous system \[rad/s\].
#[must_use]
pub fn natural_frequency(pole: Complex) -> f64 {
    let (large, small) = if pole.re.abs() > pole.im.abs() { (pole.re, pole.im) } else { (pole.im, pole.re) };
    let ratio = if large == 0.0 { 0.0 } else { small / large };
    large.abs() * Scalar::sqrt(1.0 + ratio * ratio)
}

/// `ζ = −Re p/|p|` of a pole p of a continuous system: 1 where it does not swing, negative where it grows; 1 at zero.
#[must_use]
pub fn damping_ratio(pole: Complex) -> f64 {
    let frequency = natural_frequency(pole);
    if frequency == 0.0 { 1.0 } else { 0.0 - pole.re / frequency }
}

/// The pole of a continuous system that is sampled to z: `ln z/T` \[1/s\], the one nearest to the real axis.
#[must_use]
pub fn continuous_pole(z: Complex, sample_time: f64) -> Complex {
    Complex::new(Scalar::ln(natural_frequency(z)) / sample_time, Scalar::atan2(z.im, z.re) / sample_time)
}

#[cfg(all(test, feature = "std"))]
mod tests;
