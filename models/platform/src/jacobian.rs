//! The Jacobian of the legs' lengths, by twists and by coordinates; its singularities; stiffness.
//!
//! ```text
//! l̇ = J [v; ω] = J_q q̇,   J_q = J · blockdiag(1, T),   τ = J_qᵀ F
//! ```
//!
//! Rows are legs. `v` is the velocity of the platform's frame and `ω` the angular velocity, in the axes of the base;
//! `T` turns rates of the angles into ω. Where J loses rank the platform moves with its legs held, or cannot be held by
//! them.

use mbs_models::{Error, Failure};
use mbs_runtime::{Scalar, to_matrix, to_vector};
use nalgebra::{Matrix6, SVD};

use super::geometry::Legs;
use super::{Coordinates, LegVector, NOT_FINITE, Platform, all_finite};

/// Rows are legs; columns `v` and `ω`, or the rates of the coordinates.
pub type Jacobian<T = f64> = [[T; 6]; 6];

/// How small the smallest singular value is, against the largest, where a pose counts as singular.
pub const SINGULAR: f64 = 1e-9;

/// How far a pose is from a singular one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regularity {
    /// Determinant of the Jacobian by twists \[m³\]; its sign changes where a motion passes through a singularity.
    pub determinant: f64,
    /// The largest singular value over the smallest, metres and radians alike; infinite where the pose is singular.
    pub condition: f64,
    /// The smallest singular value.
    pub smallest: f64,
    /// The largest one.
    pub largest: f64,
}

impl Regularity {
    /// True where the smallest singular value is at most [`SINGULAR`] of the largest.
    #[must_use]
    pub fn is_singular(&self) -> bool {
        self.smallest <= SINGULAR * self.largest
    }
}

/// `T` with `ω = T (φ̇, θ̇, ψ̇)`, in the axes of the base; `det T = cos θ`.
///
/// It is `R` times the matrix that gives ω in the axes of the platform, which is
/// `[[1, 0, −sin θ], [0, cos φ, sin φ cos θ], [0, −sin φ, cos φ cos θ]]`.
#[must_use]
pub fn angular_rates<T: Scalar>(q: &Coordinates<T>) -> [[T; 3]; 3] {
    let ([s2, c2], [s3, c3]) = (<[T; 2]>::from(q[4].sin_cos()), <[T; 2]>::from(q[5].sin_cos()));
    [[c3 * c2, -s3, T::zero()], [s3 * c2, c3, T::zero()], [-s2, T::zero(), T::one()]]
}

/// The smallest and the largest singular value of [`angular_rates`]: `|cos θ| / √(1 + |sin θ|)` and `√(1 + |sin θ|)`.
///
/// The third one is 1. In this form the smallest one does not suffer from cancellation.
pub(crate) fn extreme_angular_rates(q: &Coordinates) -> [f64; 2] {
    let (sin, cos) = Scalar::sin_cos(q[4]);
    let largest = Scalar::sqrt(1.0 + sin.abs());
    [cos.abs() / largest, largest]
}

/// `J_q` of these legs.
#[must_use]
pub fn by_coordinates<T: Scalar>(legs: &Legs<T>, q: &Coordinates<T>) -> Jacobian<T> {
    let rates = angular_rates(q);
    legs.jacobian().map(|row| {
        let turned = |j: usize| row[3] * rates[0][j] + row[4] * rates[1][j] + row[5] * rates[2][j];
        [row[0], row[1], row[2], turned(0), turned(1), turned(2)]
    })
}

impl Platform {
    /// The Jacobian by twists: `l̇_i = u_i · v + (R P_i × u_i) · ω` \[1, m\].
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`].
    pub fn jacobian(&self, q: &Coordinates) -> Result<Jacobian, Error> {
        Ok(self.legs(q)?.jacobian())
    }

    /// The Jacobian by coordinates: `J_q = ∂l/∂q` \[1, m\]. It is the J of the thesis' (4.17).
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`].
    pub fn coordinate_jacobian(&self, q: &Coordinates) -> Result<Jacobian, Error> {
        Ok(by_coordinates(&self.legs(q)?, q))
    }

    /// Condition and determinant of the Jacobian by twists.
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`]. A singular pose is none: it has a condition of infinity.
    pub fn regularity(&self, q: &Coordinates) -> Result<Regularity, Error> {
        let jacobian = self.jacobian(q)?;
        let [smallest, largest] = extreme_singular_values(&to_matrix(&jacobian)).ok_or(NOT_FINITE)?;
        let determinant = to_matrix(&jacobian).determinant();
        let condition = if smallest > 0.0 { largest / smallest } else { f64::INFINITY };
        Ok(Regularity { determinant, condition, smallest, largest })
    }

    /// Rates of the legs \[m/s\]: `l̇ = J_q q̇`.
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`].
    pub fn leg_rates(&self, q: &Coordinates, qd: &Coordinates) -> Result<LegVector, Error> {
        let rates: LegVector = (to_matrix(&self.coordinate_jacobian(q)?) * to_vector(qd)).into();
        if all_finite(&[&rates]) { Ok(rates) } else { Err(NOT_FINITE.into()) }
    }

    /// Rates of the coordinates that go with these rates of the legs \[m/s\]: `q̇ = J_q⁻¹ l̇`.
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Singular`] where `J_q` has no inverse.
    pub fn coordinate_rates(&self, q: &Coordinates, leg_rates: &LegVector) -> Result<Coordinates, Error> {
        solved(&self.coordinate_jacobian(q)?, leg_rates)
    }

    /// Stiffness of the platform against twists, its legs being springs at rest: `K = Jᵀ diag(k) J`.
    ///
    /// | argument | meaning                                | unit       |
    /// |----------|----------------------------------------|------------|
    /// | `leg`    | stiffness `k` of the legs along themselves | N/m    |
    ///
    /// Units of K: N/m, N and N·m. Legs under load add terms of their forces, which are not in it.
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`].
    pub fn stiffness(&self, q: &Coordinates, leg: &LegVector) -> Result<[[f64; 6]; 6], Error> {
        let jacobian = self.jacobian(q)?;
        let entry = |i: usize, j: usize| (0..6).map(|k| leg[k] * (jacobian[k][i] * jacobian[k][j])).sum();
        let stiffness: [[f64; 6]; 6] = core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)));
        if all_finite(&[stiffness.as_flattened()]) { Ok(stiffness) } else { Err(NOT_FINITE.into()) }
    }
}

/// `x` with `A x = b`.
pub(crate) fn solved(a: &[[f64; 6]; 6], b: &[f64; 6]) -> Result<[f64; 6], Error> {
    solved_by(&to_matrix(a), b)
}

/// `x` with `Aᵀ x = b`.
pub(crate) fn solved_transposed(a: &[[f64; 6]; 6], b: &[f64; 6]) -> Result<[f64; 6], Error> {
    solved_by(&to_matrix(a).transpose(), b)
}

fn solved_by(a: &Matrix6<f64>, b: &[f64; 6]) -> Result<[f64; 6], Error> {
    if !all_finite(&[a.as_slice(), b]) {
        return Err(NOT_FINITE.into());
    }
    let [smallest, largest] = extreme_singular_values(a).ok_or(NOT_FINITE)?;
    match a.lu().solve(&to_vector(b)) {
        Some(x) if smallest > SINGULAR * largest => {
            if all_finite(&[x.as_slice()]) {
                Ok(x.into())
            } else {
                Err(NOT_FINITE.into())
            }
        }
        _ => Err(Failure::Singular { of: "the pose", smallest, largest, unit: "in m and rad" }.into()),
    }
}

/// The smallest and the largest singular value; `None` where an entry is infinite or NaN.
fn extreme_singular_values(a: &Matrix6<f64>) -> Option<[f64; 2]> {
    if !all_finite(&[a.as_slice()]) {
        return None;
    }
    let svd = SVD::try_new(*a, false, false, f64::EPSILON, SVD_STEPS)?;
    Some([svd.singular_values[5], svd.singular_values[0]])
}

/// Far above the few steps a 6 × 6 matrix takes.
const SVD_STEPS: usize = 1000;
