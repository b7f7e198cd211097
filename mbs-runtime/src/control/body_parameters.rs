//! The ten numbers of a rigid body that forces are linear in.

use crate::parameter::{ParameterCondition, ParameterError, require, require_inertia};

/// Mass, first moment and inertia of a rigid body about the origin of a frame that it is fixed in.
///
/// ```text
/// h = m c,   L = I + m (c·c 1 − c cᵀ)
/// ```
///
/// with the mass centre c and the inertia I about it. Energies and forces are linear in `(m, h, L)`, not in
/// `(m, c, I)`.
///
/// ```
/// use mbs_runtime::control::BodyParameters;
///
/// // A ball of 2 kg, half a metre along x.
/// let ball = BodyParameters::about_center(2.0, [0.5, 0.0, 0.0], [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]);
/// assert_eq!((ball.moment, ball.inertia), ([1.0, 0.0, 0.0], [0.1, 0.6, 0.6, 0.0, 0.0, 0.0]));
/// // Two bodies that are fixed to each other are one.
/// assert_eq!(ball.plus(&ball).center(), [0.5, 0.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyParameters {
    /// m \[kg\].
    pub mass: f64,
    /// h \[kg·m\].
    pub moment: [f64; 3],
    /// Entries xx, yy, zz, xy, xz, yz of L as they stand in the matrix: `xy = −∫ x y dm` \[kg·m²\].
    pub inertia: [f64; 6],
}

impl BodyParameters {
    /// The names of the ten numbers, in the order of [`to_array`](Self::to_array).
    pub const NAMES: [&str; 10] = ["m", "h_x", "h_y", "h_z", "L_xx", "L_yy", "L_zz", "L_xy", "L_xz", "L_yz"];

    /// The parameters of a mass \[kg\], its centre \[m\], and the inertia about it, entries xx, yy, zz, xy, xz, yz
    /// \[kg·m²\].
    #[must_use]
    pub fn about_center(mass: f64, center: [f64; 3], inertia: [f64; 6]) -> Self {
        let of_a_point = point(mass, center);
        Self { mass, moment: center.map(|x| mass * x), inertia: core::array::from_fn(|i| inertia[i] + of_a_point[i]) }
    }

    /// The mass centre `h/m` \[m\]; infinite or NaN where there is no mass.
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        self.moment.map(|moment| moment / self.mass)
    }

    /// Entries xx, yy, zz, xy, xz, yz of the inertia about the mass centre \[kg·m²\]; NaN where there is no mass.
    #[must_use]
    pub fn inertia_about_center(&self) -> [f64; 6] {
        let of_a_point = point(self.mass, self.center());
        core::array::from_fn(|i| self.inertia[i] - of_a_point[i])
    }

    /// Both bodies, fixed to each other.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let (one, two) = (self.to_array(), other.to_array());
        Self::from_array(&core::array::from_fn(|k| one[k] + two[k]))
    }

    /// `m, h_x, h_y, h_z, L_xx, L_yy, L_zz, L_xy, L_xz, L_yz`
    #[must_use]
    pub fn to_array(&self) -> [f64; 10] {
        let ([x, y, z], [xx, yy, zz, xy, xz, yz]) = (self.moment, self.inertia);
        [self.mass, x, y, z, xx, yy, zz, xy, xz, yz]
    }

    /// Of numbers in the order of [`to_array`](Self::to_array).
    #[must_use]
    pub fn from_array(&[mass, x, y, z, xx, yy, zz, xy, xz, yz]: &[f64; 10]) -> Self {
        Self { mass, moment: [x, y, z], inertia: [xx, yy, zz, xy, xz, yz] }
    }

    /// Whether a body can have these: a mass that is positive, an inertia about the mass centre that is one.
    ///
    /// # Errors
    /// [`ParameterError`] with the number that shows it.
    pub fn check(&self) -> Result<(), ParameterError> {
        require("mass", self.mass, ParameterCondition::Positive)?;
        let [xx, yy, zz, products @ ..] = self.inertia_about_center();
        // What may be left of the difference of two inertias of a point: ten times what one operation rounds.
        let [x, y, z] = self.center();
        let rounding = 10.0 * f64::EPSILON * self.mass * (x * x + y * y + z * z);
        let moments = [xx, yy, zz].map(|moment| moment + rounding);
        let [[xx, yy, zz], [xy, xz, yz]] = [moments, products];
        require_inertia("inertia", [xx, yy, zz, xy, xz, yz], ParameterCondition::InertiaOfABody)
    }
}

/// `m (c·c 1 − c cᵀ)`
fn point(mass: f64, [x, y, z]: [f64; 3]) -> [f64; 6] {
    [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z].map(|entry| mass * entry)
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let (center, inertia) = ([0.3, -0.2, 0.7], [3.0, 4.0, 5.0, 0.2, -0.1, 0.4]);
        let body = BodyParameters::about_center(6.0, center, inertia);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(close(&body.center(), &center) && close(&body.inertia_about_center(), &inertia));
        assert_eq!(BodyParameters::from_array(&body.to_array()), body);
        assert_eq!(body.check(), Ok(()));
        assert_eq!(body.inertia[3], 0.2 + 6.0 * 0.3 * 0.2, "the entry of the matrix, not the integral of x y");
        let inverted = BodyParameters { mass: -1.0, ..body };
        assert_eq!(inverted.check().map_err(|error| (error.quantity, error.value)), Err(("mass", -1.0)));
        assert!(BodyParameters { inertia: [0.0; 6], ..body }.check().is_err());
    }

    /// Points and rods, whose inertia is a difference of equal numbers, and what is less than nothing by more.
    #[test]
    fn bodies_without_extent() {
        assert_eq!(BodyParameters::about_center(3.0, [0.3, 0.2, 0.1], [0.0; 6]).check(), Ok(()));
        let place = |k: i32| [0.7, 1.3, 2.9].map(|step| (step * f64::from(k)).sin() * 10.0_f64.powi(k % 7 - 3));
        for k in 1..1000 {
            let mass = 10.0_f64.powi(k % 5 - 2) * 1.3;
            let point = BodyParameters::about_center(mass, place(k), [0.0; 6]);
            assert_eq!(point.check(), Ok(()), "{k}");
            assert_eq!(point.plus(&point).check(), Ok(()), "{k}");
            let [x, y, z] = place(k);
            let less = -1e-13 * mass * (x * x + y * y + z * z);
            let wrong = BodyParameters::about_center(mass, place(k), [less, less, less, 0.0, 0.0, 0.0]);
            assert!(wrong.check().is_err(), "{k}");
        }
    }
}
