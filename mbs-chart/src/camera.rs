//! From space to a plane, by parallel projection.

/// From where space is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// To which side of the negative second axis \[°\].
    pub azimuth: f64,
    /// From how far above \[°\].
    pub elevation: f64,
}

impl Camera {
    /// From the right in front, and from above.
    pub const USUAL: Self = Camera { azimuth: -60.0, elevation: 24.0 };

    /// To the right and up, in the unit of the point.
    #[must_use]
    pub fn flat(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let ((sin_a, cos_a), (sin_e, cos_e)) =
            (self.azimuth.to_radians().sin_cos(), self.elevation.to_radians().sin_cos());
        [cos_a * y - sin_a * x, cos_e * z - sin_e * (cos_a * x + sin_a * y)]
    }
}
