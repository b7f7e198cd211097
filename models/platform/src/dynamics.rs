//! Forces of the legs for an imposed motion, what they depend on, and how far the thesis' diagonal mass matrix is off.
//!
//! ```text
//! M(q) q̈ + C(q, q̇) q̇ + G(q) = J_qᵀ F                                                          (4.17)
//! ```
//!
//! `M`, `C` and `G` are those of [`StewartPlatform`], with the cylinders and pistons of
//! the legs.

use mbs_models::{Error, Failure};
use mbs_runtime::{Dual, Scalar, to_matrix, to_vector};

use super::geometry::Geometry;
use super::jacobian::{SINGULAR, by_coordinates, extreme_angular_rates, solved_transposed};
use super::limits::LegState;
use super::{Coordinates, LegVector, NOT_FINITE, Platform, all_finite};
use mbs_models::stewart_platform::{Params, StewartPlatform};

/// A parameter of which forces are differentiated, or several in step: the rates at which they grow.
///
/// The units of a derivative are N over that of the parameter.
pub type Direction = Params<f64>;

/// No parameter grows: a [`Direction`] to name parameters in.
///
/// ```
/// use mbs_platform::dynamics::{Direction, STILL};
/// use mbs_platform::{HOME, Platform};
///
/// let platform = Platform::default();
/// let payload = Direction { payload_mass: 1.0, ..STILL };
/// let rest = [0.0; 6];
/// let per_kilogram = platform.leg_forces_along(&payload, &HOME, &rest, &rest).unwrap();
/// // At home the six legs share what another kilogram weighs.
/// let legs = platform.legs(&HOME).unwrap();
/// let carried: f64 = (0..6).map(|i| per_kilogram[i] * legs.direction[i][2]).sum();
/// assert!((carried - 9.80665).abs() < 1e-12);
/// ```
pub const STILL: Direction = Params {
    base_radius: 0.0,
    platform_radius: 0.0,
    base_half_angle: 0.0,
    platform_half_angle: 0.0,
    platform_mass: 0.0,
    platform_inertia: [0.0; 3],
    payload_mass: 0.0,
    payload_size: [0.0; 3],
    cylinder_mass: 0.0,
    cylinder_centre: 0.0,
    cylinder_inertia: 0.0,
    piston_mass: 0.0,
    piston_centre: 0.0,
    piston_inertia: 0.0,
    g: 0.0,
};

impl Platform {
    /// Generalized force of the motion: `M q̈ + C q̇ + G` \[N, N·m\].
    #[must_use]
    pub fn generalized_force(&self, q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> Coordinates {
        self.model().inverse_dynamics(q, qd, qdd)
    }

    /// Forces of the legs \[N\] that make the platform move so: `F = J_q⁻ᵀ (M q̈ + C q̇ + G)`.
    ///
    /// | argument         | meaning                                      | unit         |
    /// |------------------|----------------------------------------------|--------------|
    /// | `q`, `qd`, `qdd` | the imposed coordinates, rates, accelerations | m, rad, s   |
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Singular`] where the legs cannot hold the platform.
    ///
    /// # Source
    /// Thesis, equation (4.17), solved for τ.
    pub fn leg_forces(&self, q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> Result<LegVector, Error> {
        let force = self.generalized_force(q, qd, qdd);
        solved_transposed(&self.coordinate_jacobian(q)?, &force)
    }

    /// The forces of the legs that do what a generalized force τ does: `J_q⁻ᵀ τ` \[N\].
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Singular`] where the legs cannot hold the platform.
    pub fn legs_against(&self, q: &Coordinates, force: &Coordinates) -> Result<LegVector, Error> {
        solved_transposed(&self.coordinate_jacobian(q)?, force)
    }

    /// Accelerations under these forces of the legs \[N\].
    ///
    /// A pose that the legs cannot hold has accelerations too. One near θ = ±90° has none: M is singular there. Its
    /// condition grows as the square of that of the [matrix of angular rates](super::jacobian::angular_rates).
    ///
    /// # Errors
    /// [`Error`]; [`Failure::Singular`], with the singular values of the matrix of angular rates, where the square of
    /// their ratio is at most [`SINGULAR`], within 0.004° of ±90°.
    pub fn accelerations(&self, q: &Coordinates, qd: &Coordinates, forces: &LegVector) -> Result<Coordinates, Error> {
        self.legs(q)?;
        let [smallest, largest] = extreme_angular_rates(q);
        if smallest * smallest <= SINGULAR * (largest * largest) {
            return Err(Failure::Singular { of: "the attitude", smallest, largest, unit: "plain numbers" }.into());
        }
        let accelerations = self.model().forward_dynamics(q, qd, forces);
        if all_finite(&[&accelerations]) { Ok(accelerations) } else { Err(NOT_FINITE.into()) }
    }

    /// Derivatives of the legs' forces while parameters grow in this direction, the motion staying the same.
    ///
    /// Exact: the equations are evaluated in dual numbers.
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces).
    pub fn leg_forces_along(
        &self,
        direction: &Direction,
        q: &Coordinates,
        qd: &Coordinates,
        qdd: &Coordinates,
    ) -> Result<LegVector, Error> {
        self.leg_forces(q, qd, qdd)?;
        let params = lifted(self.params(), direction);
        dual_forces(&params, &q.map(Dual::constant), qd, qdd)
    }

    /// Derivatives of the legs' forces along a displacement `dq` of the platform, its rates and accelerations staying
    /// the same.
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces).
    pub fn leg_forces_displaced(
        &self,
        dq: &Coordinates,
        q: &Coordinates,
        qd: &Coordinates,
        qdd: &Coordinates,
    ) -> Result<LegVector, Error> {
        self.leg_forces(q, qd, qdd)?;
        let params = lifted(self.params(), &STILL);
        let q = core::array::from_fn(|i| Dual { value: q[i], derivative: dq[i] });
        dual_forces(&params, &q, qd, qdd)
    }

    /// Derivatives of the legs' forces by the stiffness `k` \[N/m\] that all legs have, where it is finite.
    ///
    /// A leg under the force F gives way by `F/k`, and the platform by `δq = −J_q⁻¹ F/k`; its drives do not make up for
    /// that. The forces change by `δF = (∂F/∂q) δq`, so that `∂F/∂k = (∂F/∂q) J_q⁻¹ F/k²`, to first order in `1/k`, the
    /// rates of δq left out.
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces); [`NOT_FINITE`] where `k` is zero or NaN.
    pub fn leg_forces_by_stiffness(
        &self,
        stiffness: f64,
        q: &Coordinates,
        qd: &Coordinates,
        qdd: &Coordinates,
    ) -> Result<LegVector, Error> {
        let shortening = self.leg_forces(q, qd, qdd)?.map(|force| force / (stiffness * stiffness));
        let displacement = self.coordinate_rates(q, &shortening)?;
        self.leg_forces_displaced(&displacement, q, qd, qdd)
    }

    /// The mass matrix as the thesis prints it: diagonal, with the mass and the moments of inertia of platform and
    /// payload about the axes of the platform's frame; without actuators \[kg, kg·m²\].
    ///
    /// It is right where the frame is at the mass centre, the angles φ and θ are zero, and the legs have no mass.
    ///
    /// # Source
    /// Thesis, equation (4.15).
    #[must_use]
    pub fn printed_mass_matrix(&self) -> Coordinates {
        let p = self.params();
        let mass = p.platform_mass + p.payload_mass;
        let [length, width, height] = p.payload_size;
        let lever = 0.5 * height;
        let moment = |a: f64, b: f64| p.payload_mass * (a * a + b * b) / 12.0;
        let offset = p.payload_mass * lever * lever;
        [
            mass,
            mass,
            mass,
            p.platform_inertia[0] + moment(width, height) + offset,
            p.platform_inertia[1] + moment(length, height) + offset,
            p.platform_inertia[2] + moment(length, width),
        ]
    }

    /// Forces of the legs \[N\] with the [printed mass matrix](Self::printed_mass_matrix) in the place of M; C and G
    /// are right.
    ///
    /// # Errors
    /// As [`leg_forces`](Self::leg_forces).
    pub fn printed_leg_forces(&self, q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> Result<LegVector, Error> {
        let (right, printed) = (self.model().mass_matrix(q), self.printed_mass_matrix());
        let (force, inertial) = (self.generalized_force(q, qd, qdd), to_matrix(&right) * to_vector(qdd));
        let force = core::array::from_fn(|i| force[i] - inertial[i] + printed[i] * qdd[i]);
        solved_transposed(&self.coordinate_jacobian(q)?, &force)
    }
}

/// Derivatives of the forces where the rates and accelerations stay.
fn dual_forces(
    params: &Params<Dual<f64>>,
    q: &Coordinates<Dual<f64>>,
    qd: &Coordinates,
    qdd: &Coordinates,
) -> Result<LegVector, Error> {
    Ok(dual_legs(params, &[*q, qd.map(Dual::constant), qdd.map(Dual::constant)])?.force.map(|force| force.derivative))
}

/// Lengths, rates and forces of the legs, and their derivatives: `J_qᵀ F = τ` gives `J_qᵀ δF = δτ − δJ_qᵀ F`.
pub(crate) fn dual_legs(
    params: &Params<Dual<f64>>,
    [q, qd, qdd]: &[Coordinates<Dual<f64>>; 3],
) -> Result<LegState<Dual<f64>>, Error> {
    let legs = Geometry::unchecked(params).legs(q);
    let jacobian = by_coordinates(&legs, q);
    let rate = jacobian.map(|row| row.iter().zip(qd).fold(Dual::zero(), |sum, (&entry, &qd)| sum + entry * qd));
    let wrench = StewartPlatform::new(*params).inverse_dynamics(q, qd, qdd);
    let (value, slope) = (jacobian.map(|row| row.map(|x| x.value)), jacobian.map(|row| row.map(|x| x.derivative)));
    let forces = solved_transposed(&value, &wrench.map(|x| x.value))?;
    let by_slope = to_matrix(&slope).tr_mul(&to_vector(&forces));
    let slopes = solved_transposed(&value, &core::array::from_fn(|i| wrench[i].derivative - by_slope[i]))?;
    let force = core::array::from_fn(|i| Dual { value: forces[i], derivative: slopes[i] });
    Ok(LegState { length: legs.length, rate, force })
}

/// The parameters, which grow in the direction.
pub(crate) fn lifted(of: &Params, along: &Direction) -> Params<Dual<f64>> {
    let lift = |value: f64, derivative: f64| Dual { value, derivative };
    let lift_three = |value: [f64; 3], derivative: [f64; 3]| [0, 1, 2].map(|i| lift(value[i], derivative[i]));
    Params {
        base_radius: lift(of.base_radius, along.base_radius),
        platform_radius: lift(of.platform_radius, along.platform_radius),
        base_half_angle: lift(of.base_half_angle, along.base_half_angle),
        platform_half_angle: lift(of.platform_half_angle, along.platform_half_angle),
        platform_mass: lift(of.platform_mass, along.platform_mass),
        platform_inertia: lift_three(of.platform_inertia, along.platform_inertia),
        payload_mass: lift(of.payload_mass, along.payload_mass),
        payload_size: lift_three(of.payload_size, along.payload_size),
        cylinder_mass: lift(of.cylinder_mass, along.cylinder_mass),
        cylinder_centre: lift(of.cylinder_centre, along.cylinder_centre),
        cylinder_inertia: lift(of.cylinder_inertia, along.cylinder_inertia),
        piston_mass: lift(of.piston_mass, along.piston_mass),
        piston_centre: lift(of.piston_centre, along.piston_centre),
        piston_inertia: lift(of.piston_inertia, along.piston_inertia),
        g: lift(of.g, along.g),
    }
}
