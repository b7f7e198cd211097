//! A leg in spherical coordinates: its length ρ, the azimuth α and the angle β from the vertical.
//!
//! ```text
//! P = B + ρ e,   e = (cos α sin β, sin α sin β, cos β)                                          (4.6)
//! ẋ_P = C (ρ̇, α̇, β̇),   det C = −ρ² sin β                                                      (4.7)
//! a_P = ρ̈ e + ω̇ × ρ e + ω × (2 ρ̇ e + ω × ρ e)                                                 (4.8)
//! ω = (−β̇ sin α, β̇ cos α, α̇)                                                                  (4.10) its derivative
//! (ρ̈, α̈, β̈) = C⁻¹ h                                                                            (4.11)
//! ```
//!
//! In (4.7) the thesis prints coordinates for rates (E12), in (4.8) `ρ̇` for `2 ρ̇` (E13), in the third row of (4.11)
//! it has a stray `cos β` (E14 of `docs/thesis/errata.md`); here they are right. A vertical leg has no azimuth: there
//! these coordinates are singular, which the dynamics, written with the unit vector `e`, is not.

use mbs_models::{Error, Failure, check};
use mbs_runtime::{Dual, Scalar, to_matrix};
use nalgebra::Vector3;

use super::geometry::Geometry;
use super::{Coordinates, NOT_FINITE, Platform, all_finite};

/// `(ρ, α, β)` \[m, rad\], their rates or accelerations.
pub type Spherical = [f64; 3];

/// How small `sin β` is where a leg counts as vertical.
pub const VERTICAL: f64 = 1e-9;

/// A leg's motion in spherical coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegMotion {
    /// `(ρ, α, β)` \[m, rad\].
    pub position: Spherical,
    /// `(ρ̇, α̇, β̇)` \[m/s, rad/s\].
    pub rate: Spherical,
    /// `(ρ̈, α̈, β̈)` \[m/s², rad/s²\].
    pub acceleration: Spherical,
}

impl LegMotion {
    /// From the motion of the platform's joint against the base's: its place, velocity and acceleration \[m, s\].
    ///
    /// ```
    /// use mbs_platform::leg::LegMotion;
    ///
    /// // A point that falls past a leg of 1 m that lies along x.
    /// let motion = LegMotion::of_joint(&[1.0, 0.0, 0.0], &[0.0, 0.0, -2.0], &[0.0, 0.0, 0.0]).unwrap();
    /// // β grows by 2 rad/s, and the leg gets longer the faster the farther it falls.
    /// assert!((motion.rate[2] - 2.0).abs() < 1e-15 && (motion.acceleration[0] - 4.0).abs() < 1e-15);
    /// ```
    ///
    /// # Errors
    /// [`Failure::Invalid`] for a leg without length, [`Failure::Undetermined`] for a vertical one, [`NOT_FINITE`].
    ///
    /// # Source
    /// Thesis, equations (4.6), (4.7), (4.11), corrected.
    pub fn of_joint(place: &[f64; 3], velocity: &[f64; 3], acceleration: &[f64; 3]) -> Result<Self, Error> {
        if !all_finite(&[place, velocity, acceleration]) {
            return Err(NOT_FINITE.into());
        }
        let [x, y, z] = *place;
        let across = Scalar::sqrt(x * x + y * y);
        let rho = Vector3::from(*place).norm();
        check::positive("length of the leg", rho)?;
        if across <= VERTICAL * rho {
            return Err(Failure::Undetermined("the azimuth of a vertical leg").into());
        }
        let position = [rho, Scalar::atan2(y, x), Scalar::atan2(across, z)];
        let rate = solve_rates(&position, velocity);
        let acceleration = solve_rates(&position, &centripetal(&position, &rate, acceleration));
        let motion = Self { position, rate, acceleration };
        if all_finite(&[&motion.rate, &motion.acceleration]) { Ok(motion) } else { Err(NOT_FINITE.into()) }
    }

    /// `e`, from the base's joint to the platform's.
    #[must_use]
    pub fn direction(&self) -> [f64; 3] {
        let ((sin_a, cos_a), (sin_b, cos_b)) = (Scalar::sin_cos(self.position[1]), Scalar::sin_cos(self.position[2]));
        [cos_a * sin_b, sin_a * sin_b, cos_b]
    }

    /// The matrix `C` of (4.7); columns belong to ρ, α, β.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        let rho = self.position[0];
        let ((sin_a, cos_a), (sin_b, cos_b)) = (Scalar::sin_cos(self.position[1]), Scalar::sin_cos(self.position[2]));
        [
            [cos_a * sin_b, -rho * sin_a * sin_b, rho * cos_a * cos_b],
            [sin_a * sin_b, rho * cos_a * sin_b, rho * sin_a * cos_b],
            [cos_b, 0.0, -rho * sin_b],
        ]
    }

    /// Velocity of the platform's joint \[m/s\]: `C (ρ̇, α̇, β̇)`.
    #[must_use]
    pub fn joint_velocity(&self) -> [f64; 3] {
        (to_matrix(&self.matrix()) * Vector3::from(self.rate)).into()
    }

    /// `ω = (−β̇ sin α, β̇ cos α, α̇)` \[rad/s\].
    #[must_use]
    pub fn angular_velocity(&self) -> [f64; 3] {
        let (sin, cos) = Scalar::sin_cos(self.position[1]);
        [-self.rate[2] * sin, self.rate[2] * cos, self.rate[1]]
    }

    /// `ω̇` of (4.10) \[rad/s²\].
    #[must_use]
    pub fn angular_acceleration(&self) -> [f64; 3] {
        let (sin, cos) = Scalar::sin_cos(self.position[1]);
        let ([_, ad, bd], [_, add, bdd]) = (self.rate, self.acceleration);
        [-bdd * sin - ad * bd * cos, bdd * cos - ad * bd * sin, add]
    }

    /// Acceleration of the platform's joint \[m/s²\], by (4.8) with (4.9), corrected.
    #[must_use]
    pub fn joint_acceleration(&self) -> [f64; 3] {
        let e = Vector3::from(self.direction());
        let (w, wd) = (Vector3::from(self.angular_velocity()), Vector3::from(self.angular_acceleration()));
        let rho = e * self.position[0];
        let around = w.cross(&(e * (2.0 * self.rate[0]) + w.cross(&rho)));
        (e * self.acceleration[0] + wd.cross(&rho) + around).into()
    }
}

/// `C⁻¹ v`.
fn solve_rates(&[rho, alpha, beta]: &Spherical, v: &[f64; 3]) -> Spherical {
    let ((sin_a, cos_a), (sin_b, cos_b)) = (Scalar::sin_cos(alpha), Scalar::sin_cos(beta));
    let outward = cos_a * v[0] + sin_a * v[1];
    [
        sin_b * outward + cos_b * v[2],
        (cos_a * v[1] - sin_a * v[0]) / (rho * sin_b),
        (cos_b * outward - sin_b * v[2]) / rho,
    ]
}

/// `h` of (4.11), the third row corrected: the acceleration less `Ċ (ρ̇, α̇, β̇)`.
fn centripetal(&[rho, alpha, beta]: &Spherical, &[rd, ad, bd]: &Spherical, a: &[f64; 3]) -> [f64; 3] {
    let ((sa, ca), (sb, cb)) = (Scalar::sin_cos(alpha), Scalar::sin_cos(beta));
    let turning = rho * (ad * ad + bd * bd);
    [
        a[0] - 2.0 * rd * bd * ca * cb + 2.0 * rd * ad * sa * sb + 2.0 * rho * ad * bd * sa * cb + turning * ca * sb,
        a[1] - 2.0 * rd * bd * sa * cb - 2.0 * rd * ad * ca * sb - 2.0 * rho * ad * bd * ca * cb + turning * sa * sb,
        a[2] + 2.0 * rd * bd * sb + rho * bd * bd * cb,
    ]
}

impl Platform {
    /// The motion of one leg, counted from 0, in spherical coordinates.
    ///
    /// # Errors
    /// [`Error`]: among others where the leg is vertical.
    ///
    /// # Panics
    /// If `leg` is not below 6.
    pub fn spherical_leg(
        &self,
        leg: usize,
        q: &Coordinates,
        qd: &Coordinates,
        qdd: &Coordinates,
    ) -> Result<LegMotion, Error> {
        self.legs(q)?;
        let [place, velocity, acceleration] = self.joint_motion(leg, q, qd, qdd);
        let base = self.geometry().base[leg];
        LegMotion::of_joint(&[0, 1, 2].map(|i| place[i] - base[i]), &velocity, &acceleration)
    }

    /// Place, velocity and acceleration of a joint of the platform, in the axes of the base \[m, s\].
    ///
    /// `q(t + ε) = q + q̇ ε + ½ q̈ ε²`, carried through the geometry by dual numbers.
    ///
    /// # Panics
    /// If `leg` is not below 6.
    #[must_use]
    pub fn joint_motion(&self, leg: usize, q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> [[f64; 3]; 3] {
        let constant = |x: f64| Dual::constant(Dual::constant(x));
        let lift = |joints: &[[f64; 3]; 6]| joints.map(|joint| joint.map(constant));
        let geometry = Geometry { base: lift(&self.geometry().base), platform: lift(&self.geometry().platform) };
        let moving = core::array::from_fn(|i| Dual {
            value: Dual { value: q[i], derivative: qd[i] },
            derivative: Dual { value: qd[i], derivative: qdd[i] },
        });
        let joint = geometry.joint(leg, &moving);
        [joint.map(|x| x.value.value), joint.map(|x| x.value.derivative), joint.map(|x| x.derivative.derivative)]
    }
}
