//! Where the joints are, and the legs between them.

use core::f64::consts::PI;

use mbs_models::check::{self, Invalid, Must};
use mbs_runtime::Scalar;
use nalgebra::Vector3;

use super::{Coordinates, LegVector};
use mbs_models::stewart_platform::Params;

/// The joints of base and platform; leg i joins `base[i]` to `platform[i]`.
///
/// They lie on circles, two by two around three directions 120° apart: on the base at 0°, 120°, 240° and half the angle
/// of a pair to each side; on the platform the pairs are around 60°, 180°, 300°, so that two legs that meet above part
/// below.
///
/// # Source
/// Thesis, equation (4.2): the joints of base and platform are plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<T = f64> {
    /// In the axes of the base \[m\].
    pub base: [[T; 3]; 6],
    /// In the axes of the platform \[m\].
    pub platform: [[T; 3]; 6],
}

/// The legs at one pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legs<T = f64> {
    /// `l_i`, from joint to joint \[m\].
    pub length: LegVector<T>,
    /// `u_i`, the unit vectors from the base's joints to the platform's, in the axes of the base; NaN where the length
    /// is 0.
    pub direction: [[T; 3]; 6],
    /// `R P_i`, from the platform's frame to its joints, in the axes of the base \[m\].
    pub lever: [[T; 3]; 6],
}

/// How near two joints are, as a part of the radius of their circle, where they count as one.
pub const COINCIDENT: f64 = 1e-6;

/// Directions of the pairs, on which side of them a joint is: as declared in `stewart_platform.mbs`.
const PAIR: [f64; 6] = [0.0, 0.0, 2.0 * PI / 3.0, 2.0 * PI / 3.0, 4.0 * PI / 3.0, 4.0 * PI / 3.0];
const SIDE: [f64; 6] = [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0];

impl<T: Scalar> Geometry<T> {
    /// The joints of these parameters, whatever they are.
    pub(crate) fn unchecked(params: &Params<T>) -> Self {
        let on_circle = |radius: T, angle: T| {
            let (sin, cos) = angle.sin_cos();
            [radius * cos, radius * sin, T::zero()]
        };
        let of = |x: f64| T::from_f64(x);
        Self {
            base: core::array::from_fn(|i| {
                on_circle(params.base_radius, of(PAIR[i]) + of(SIDE[i]) * params.base_half_angle)
            }),
            platform: core::array::from_fn(|i| {
                let angle = of(PAIR[i]) + of(SIDE[i]) * (of(PI / 3.0) - params.platform_half_angle);
                on_circle(params.platform_radius, angle)
            }),
        }
    }

    /// The legs at this pose, whatever it is.
    #[must_use]
    pub fn legs(&self, q: &Coordinates<T>) -> Legs<T> {
        self.legs_at(&[q[0], q[1], q[2]], &attitude(q))
    }

    /// The legs with the platform's frame at `position` \[m\], turned by `rotation` (rows).
    #[must_use]
    pub fn legs_at(&self, position: &[T; 3], rotation: &[[T; 3]; 3]) -> Legs<T> {
        let lever = self.platform.map(|joint| rotation.map(|row| dot(&row, &joint)));
        let vector: [[T; 3]; 6] =
            core::array::from_fn(|i| core::array::from_fn(|axis| position[axis] + lever[i][axis] - self.base[i][axis]));
        let length = vector.map(|vector| dot(&vector, &vector).sqrt());
        let direction = core::array::from_fn(|i| vector[i].map(|component| component / length[i]));
        Legs { length, direction, lever }
    }

    /// Where the platform's joint of this leg is, in the axes of the base \[m\].
    #[must_use]
    pub fn joint(&self, leg: usize, q: &Coordinates<T>) -> [T; 3] {
        let rotation = attitude(q);
        core::array::from_fn(|axis| q[axis] + dot(&rotation[axis], &self.platform[leg]))
    }
}

impl<T: Scalar> Legs<T> {
    /// Rows of the Jacobian by twists: `l̇_i = u_i · v + (R P_i × u_i) · ω`.
    #[must_use]
    pub fn jacobian(&self) -> [[T; 6]; 6] {
        core::array::from_fn(|i| {
            let ([a, b, c], [d, e, f]) = (self.direction[i], cross(&self.lever[i], &self.direction[i]));
            [a, b, c, d, e, f]
        })
    }
}

impl Geometry<f64> {
    pub(crate) fn check_joints(&self, params: &Params) -> Result<(), Invalid> {
        let plates = [
            ("clearance of base joint", &self.base, params.base_radius),
            ("clearance of platform joint", &self.platform, params.platform_radius),
        ];
        for (clearance, joints, radius) in plates {
            for (i, j) in (0..6).flat_map(|i| (i + 1..6).map(move |j| (i, j))) {
                let distance = (Vector3::from(joints[i]) - Vector3::from(joints[j])).norm();
                Must::BeMoreThan(COINCIDENT * radius).check(clearance, distance).map_err(|error| error.of(i))?;
            }
        }
        Ok(())
    }
}

/// `R = Rz(ψ) Ry(θ) Rx(φ)`, rows.
#[must_use]
#[inline]
pub fn attitude<T: Scalar>(q: &Coordinates<T>) -> [[T; 3]; 3] {
    let [(s1, c1), (s2, c2), (s3, c3)] = [q[3].sin_cos(), q[4].sin_cos(), q[5].sin_cos()];
    [
        [c3 * c2, c3 * s2 * s1 - s3 * c1, c3 * s2 * c1 + s3 * s1],
        [s3 * c2, s3 * s2 * s1 + c3 * c1, s3 * s2 * c1 - c3 * s1],
        [-s2, c2 * s1, c2 * c1],
    ]
}

/// Masses, inertias and sizes; the joints are checked where they are known.
pub(crate) fn check(params: &Params) -> Result<(), Invalid> {
    check::positive("base_radius", params.base_radius)?;
    check::positive("platform_radius", params.platform_radius)?;
    check::finite("base_half_angle", params.base_half_angle)?;
    check::finite("platform_half_angle", params.platform_half_angle)?;
    check::finite("cylinder_centre", params.cylinder_centre)?;
    check::finite("piston_centre", params.piston_centre)?;
    check::finite("g", params.g)?;
    check::not_negative("payload_mass", params.payload_mass)?;
    check::not_negative("payload_size", params.payload_size)?;
    check::positive("platform_mass", params.platform_mass)?;
    check::positive("platform_inertia", params.platform_inertia)?;
    check::not_negative("cylinder_mass", params.cylinder_mass)?;
    check::not_negative("cylinder_inertia", params.cylinder_inertia)?;
    check::not_negative("piston_mass", params.piston_mass)?;
    check::not_negative("piston_inertia", params.piston_inertia)
}

/// `a·b`, of dual numbers too, which are none of nalgebra's.
#[inline]
pub(crate) fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`, of dual numbers too.
#[inline]
pub(crate) fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
