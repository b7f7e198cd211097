//! The Stewart platform PS-6TL-1500 as chapter 4 of the thesis treats it: what surrounds the generated dynamics of
//! [`stewart_platform`](mbs_models::stewart_platform).
//!
//! | thesis        | here                                                                                              |
//! |---------------|---------------------------------------------------------------------------------------------------|
//! | (4.1)–(4.4)   | [`Platform::lengths`]: inverse kinematics                                                         |
//! | (4.5)         | [`direct`]: direct kinematics by damped Newton                                                    |
//! | (4.6)–(4.11)  | [`leg`]: a leg in spherical coordinates, corrected                                                |
//! | (4.12)–(4.18) | the generated mechanism; [`dynamics`]: forces of the legs for an imposed motion; [`control`] by it |
//! | table 3, 4    | [`motion`]: the imposed motions, and sums of them                                                 |
//! | 4.3           | [`sensitivity`]: of what the legs do to every parameter of platform and motion                    |
//! | chapter 6     | [`marine`]: a platform at sea, which heaves, rolls, pitches and yaws by dynamics of its own         |
//!
//! Coordinates are `q = (x, y, z, φ, θ, ψ)`: the place of the platform's frame \[m\] and the angles of `R = Rz(ψ) Ry(θ)
//! Rx(φ)` \[rad\]. The frame lies in the plane of the platform's joints, the base's joints lie in the plane z = 0, z is
//! up. A leg's force is positive where it pushes.
//!
//! ```
//! use mbs_platform::{HOME, Platform};
//!
//! let platform = Platform::default();
//! let q = [0.05, -0.04, 1.15, 0.1, -0.08, 0.2];
//! let lengths = platform.lengths(&q).unwrap();
//! // Back from the lengths to the pose, from home.
//! let found = platform.direct(&lengths, &HOME).unwrap();
//! assert!(found.iterations <= 5);
//! assert!((0..6).all(|i| (found.pose[i] - q[i]).abs() < 1e-12));
//! ```
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 4. Geometry, masses and limits are
//! assumed: no data of the manufacturer was at hand.
#![no_std]

#[cfg(feature = "std")]
extern crate std;

pub mod control;
pub mod direct;
pub mod dynamics;
pub mod geometry;
pub mod jacobian;
pub mod leg;
pub mod limits;
pub mod marine;
pub mod motion;
pub mod sensitivity;

pub use direct::DirectKinematics;
pub use geometry::Geometry;
pub use limits::{ActuatorLimits, Quantity, Violation};
use mbs_models::check::Must;
use mbs_models::stewart_platform::{Params, StewartPlatform};
use mbs_models::{Error, Failure};
pub use motion::{Motion, PlatformMotion, Superposition};

/// `(x, y, z, φ, θ, ψ)` \[m, rad\], their rates or accelerations.
pub type Coordinates<T = f64> = [T; 6];
/// Six numbers, one a leg.
pub type LegVector<T = f64> = [T; 6];

/// The pose that motions start from and are measured from: level, 1.1 m above the base, in the middle of the stroke.
pub const HOME: Coordinates = [0.0, 0.0, 1.1, 0.0, 0.0, 0.0];

/// Why a pose or a motion has no legs, no forces or no rates of them, if something in it is NaN or infinite.
pub const NOT_FINITE: Failure = Failure::NotFinite("a coordinate, rate, acceleration or force");

/// A leg shorter than this part of the base's radius has no direction.
pub const SHORTEST: f64 = 1e-9;

/// The platform: its generated dynamics, its joints, and what its actuators allow.
#[derive(Clone, Debug)]
pub struct Platform {
    /// Equations of motion, energies and outputs; made of the parameters that `geometry` is made of.
    model: StewartPlatform<f64>,
    /// Its joints, of which no two coincide.
    geometry: Geometry<f64>,
    /// Stroke, speed and force of the legs.
    pub limits: ActuatorLimits,
}

impl Default for Platform {
    /// With the declared geometry and masses, and [`ActuatorLimits::PS_6TL_1500`].
    fn default() -> Self {
        let params = Params::default();
        Self {
            model: StewartPlatform::new(params),
            geometry: Geometry::unchecked(&params),
            limits: ActuatorLimits::PS_6TL_1500,
        }
    }
}

impl Platform {
    /// The platform of these parameters, with the limits [`ActuatorLimits::PS_6TL_1500`].
    ///
    /// ```
    /// use mbs_platform::Platform;
    /// use mbs_models::check::Must;
    /// use mbs_models::stewart_platform::Params;
    ///
    /// let overdrawn = Params { payload_mass: -1.0, ..Params::default() };
    /// let refused = Must::NotBeNegative.broken_by("payload_mass", -1.0);
    /// assert_eq!(Platform::new(overdrawn).unwrap_err(), refused.into());
    /// ```
    ///
    /// # Errors
    /// [`Failure::Invalid`] where a radius is not positive, two joints coincide, a mass is negative, the platform has
    /// no inertia, or something is not finite.
    pub fn new(params: Params) -> Result<Self, Error> {
        geometry::check(&params)?;
        let geometry = Geometry::unchecked(&params);
        geometry.check_joints(&params)?;
        Ok(Self { model: StewartPlatform::new(params), geometry, limits: ActuatorLimits::PS_6TL_1500 })
    }

    /// The generated mechanism.
    #[must_use]
    pub fn model(&self) -> &StewartPlatform<f64> {
        &self.model
    }

    /// Where its joints are.
    #[must_use]
    #[inline]
    pub fn geometry(&self) -> &Geometry<f64> {
        &self.geometry
    }

    /// The parameters that it is made of.
    #[must_use]
    pub fn params(&self) -> &Params {
        self.model.params()
    }

    /// The same platform with another payload: a box of this mass \[kg\].
    ///
    /// # Errors
    /// [`Failure::Invalid`].
    pub fn with_payload(&self, mass: f64) -> Result<Self, Error> {
        let params = Params { payload_mass: mass, ..*self.params() };
        Ok(Self { limits: self.limits, ..Self::new(params)? })
    }

    /// The same platform on legs without mass: what the thesis' (4.13)–(4.16) have, as they are printed.
    #[must_use]
    pub fn without_actuator_inertia(&self) -> Self {
        let params = Params {
            cylinder_mass: 0.0,
            cylinder_inertia: 0.0,
            piston_mass: 0.0,
            piston_inertia: 0.0,
            ..*self.params()
        };
        Self { model: StewartPlatform::new(params), ..self.clone() }
    }

    /// Inverse kinematics: lengths of the legs, from joint to joint \[m\].
    ///
    /// ```text
    /// L_i = R P_i + p − B_i,   l_i = |L_i|
    /// ```
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`] for a leg without length.
    ///
    /// # Source
    /// Thesis, equations (4.1)–(4.3); (4.4) is their square, written out.
    pub fn lengths(&self, q: &Coordinates) -> Result<LegVector, Error> {
        Ok(self.legs(q)?.length)
    }

    /// Lengths and directions of the legs, and the levers of their joints.
    ///
    /// # Errors
    /// [`NOT_FINITE`], [`Failure::Invalid`] for a leg without length.
    pub fn legs(&self, q: &Coordinates) -> Result<geometry::Legs<f64>, Error> {
        let legs = self.geometry.legs(q);
        if !all_finite(&[&legs.length]) {
            return Err(NOT_FINITE.into());
        }
        Must::BeMoreThan(SHORTEST * self.params().base_radius).check("length of leg", legs.length)?;
        Ok(legs)
    }
}

#[inline]
fn all_finite(values: &[&[f64]]) -> bool {
    values.iter().all(|values| values.iter().all(|x| x.is_finite()))
}
