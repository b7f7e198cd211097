//! Imposed motions: every coordinate swings about a mean by itself; the eight cases of the thesis.
//!
//! The thesis says that there are eight and prints two, tables 3 and 4, without their frequency; the others are proposals, and
//! the frequency π/2 rad/s is assumed.

use core::f64::consts::FRAC_PI_2;

use mbs_runtime::Scalar;

use super::{Coordinates, HOME};

/// `q_i(t) = mean_i + sine_i sin(ω_i t) + cosine_i cos(ω_i t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// \[m, rad\]
    pub mean: Coordinates,
    /// \[m, rad\]
    pub sine: Coordinates,
    /// \[m, rad\]
    pub cosine: Coordinates,
    /// `ω_i` \[rad/s\]
    pub frequency: Coordinates,
}

const DEGREE: f64 = core::f64::consts::PI / 180.0;

/// At home, still.
const STILL: Motion = Motion { mean: HOME, sine: [0.0; 6], cosine: [0.0; 6], frequency: [FRAC_PI_2; 6] };

impl Motion {
    /// Case 1, table 3: heave beside the middle; `x = −0.2`, `y = −0.3`, `z = −0.08 cos ωt` from home \[m\].
    pub const TABLE_3: Self =
        Self { mean: [-0.2, -0.3, HOME[2], 0.0, 0.0, 0.0], cosine: [0.0, 0.0, -0.08, 0.0, 0.0, 0.0], ..STILL };

    /// Case 6, table 4: `x = −0.3 + 0.25 sin ωt`, `y = −0.4 sin ωt`, `z = 0.7 + 0.5 sin ωt` from home \[m\], ψ = 20°.
    ///
    /// With z from the base instead, the platform of the assumed geometry passes through a singular pose where φ is 10°.
    pub const TABLE_4: Self = Self {
        mean: [-0.3, 0.0, HOME[2] + 0.7, 0.0, 0.0, 20.0 * DEGREE],
        sine: [0.25, -0.4, 0.5, 0.0, 0.0, 0.0],
        ..STILL
    };

    /// All coordinates at once, each at a frequency of its own.
    pub const COMBINED: Self = Self {
        sine: [0.05, 0.0, 0.06, 0.1, 0.0, 0.15],
        cosine: [0.0, 0.07, 0.0, 0.0, 0.12, 0.0],
        frequency: [1.3, 1.1, 0.9, 1.3, 1.3, 1.7],
        ..STILL
    };

    /// The eight cases by name.
    pub const CASES: [(&'static str, Self); 8] = [
        ("heave", Self::TABLE_3),
        ("surge", Self { sine: [0.15, 0.0, 0.0, 0.0, 0.0, 0.0], ..STILL }),
        ("sway", Self { sine: [0.0, 0.15, 0.0, 0.0, 0.0, 0.0], ..STILL }),
        ("roll", Self { sine: [0.0, 0.0, 0.0, 10.0 * DEGREE, 0.0, 0.0], ..STILL }),
        ("pitch", Self { sine: [0.0, 0.0, 0.0, 0.0, 10.0 * DEGREE, 0.0], ..STILL }),
        ("table 4", Self::TABLE_4),
        ("yaw", Self { sine: [0.0, 0.0, 0.0, 0.0, 0.0, 15.0 * DEGREE], ..STILL }),
        ("combined", Self::COMBINED),
    ];

    /// The motion of table 4 with other angles φ, θ, ψ \[rad\], which stay constant.
    #[must_use]
    pub fn table_4_turned(angles: [f64; 3]) -> Self {
        let [x, y, z, ..] = Self::TABLE_4.mean;
        Self { mean: [x, y, z, angles[0], angles[1], angles[2]], ..Self::TABLE_4 }
    }

    /// Coordinates, rates and accelerations at a time \[s\].
    ///
    /// ```
    /// use mbs_models::platform::Motion;
    ///
    /// let [q, qd, qdd] = Motion::TABLE_3.at(0.0);
    /// assert_eq!((q[2], qd[2]), (1.1 - 0.08, 0.0));
    /// assert!((qdd[2] - 0.08 * (core::f64::consts::FRAC_PI_2).powi(2)).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn at(&self, t: f64) -> [Coordinates; 3] {
        let mut motion = [self.mean, [0.0; 6], [0.0; 6]];
        for i in 0..6 {
            let w = self.frequency[i];
            let (sin, cos) = Scalar::sin_cos(w * t);
            let swing = self.sine[i] * sin + self.cosine[i] * cos;
            motion[0][i] += swing;
            motion[1][i] = w * (self.sine[i] * cos - self.cosine[i] * sin);
            motion[2][i] = -(w * w) * swing;
        }
        motion
    }
}
