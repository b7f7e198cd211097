//! Imposed motions: every coordinate swings about a mean by itself; the eight cases of the thesis, and sums of such
//! motions.
//!
//! The thesis says that there are eight and prints two, tables 3 and 4, without their frequency; the others are
//! proposals (which, and why so: `docs/thesis/chapter_4.md`), and the frequency π/2 rad/s is assumed. A
//! [`Superposition`] has as many sines in each coordinate as it has motions: a deck at sea.

use core::f64::consts::FRAC_PI_2;

use mbs_runtime::Scalar;

use super::{Coordinates, HOME};

/// A motion of the platform that is given as a function of time.
pub trait PlatformMotion {
    /// Coordinates, rates and accelerations at a time \[s\].
    fn at(&self, t: f64) -> [Coordinates; 3];
}

/// `q_i(t) = mean_i + sine_i sin(ω_i t) + cosine_i cos(ω_i t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T = f64> {
    /// The mean \[m, rad\].
    pub mean: Coordinates<T>,
    /// The amplitude of the sine \[m, rad\].
    pub sine: Coordinates<T>,
    /// The amplitude of the cosine \[m, rad\].
    pub cosine: Coordinates<T>,
    /// `ω_i` \[rad/s\]
    pub frequency: Coordinates<T>,
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
    /// With z from the base instead, the platform of the assumed geometry passes through a singular pose where φ is
    /// 10°.
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
}

impl<T: Scalar> Motion<T> {
    /// Coordinates, rates and accelerations at a time \[s\].
    ///
    /// ```
    /// use mbs_platform::Motion;
    ///
    /// let [q, qd, qdd] = Motion::TABLE_3.at(0.0);
    /// assert_eq!((q[2], qd[2]), (1.1 - 0.08, 0.0));
    /// assert!((qdd[2] - 0.08 * (core::f64::consts::FRAC_PI_2).powi(2)).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn at(&self, t: f64) -> [Coordinates<T>; 3] {
        let mut motion = [self.mean, [T::zero(); 6], [T::zero(); 6]];
        for i in 0..6 {
            let w = self.frequency[i];
            let (sin, cos) = (w * T::from_f64(t)).sin_cos();
            let swing = self.sine[i] * sin + self.cosine[i] * cos;
            motion[0][i] = motion[0][i] + swing;
            motion[1][i] = w * (self.sine[i] * cos - self.cosine[i] * sin);
            motion[2][i] = -(w * w) * swing;
        }
        motion
    }
}

impl PlatformMotion for Motion {
    fn at(&self, t: f64) -> [Coordinates; 3] {
        Motion::at(self, t)
    }
}

/// Several motions at once: coordinates, rates and accelerations are the sums of theirs.
///
/// ```text
/// q_i(t) = Σ_k mean_ik + sine_ik sin(ω_ik t) + cosine_ik cos(ω_ik t)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superposition<const K: usize>(pub [Motion; K]);

/// What swings by itself, about zero.
const SWING: Motion = Motion { mean: [0.0; 6], ..STILL };

impl Superposition<2> {
    /// A deck at sea, about home: heave, roll, pitch and yaw, each a swell and a shorter wave.
    ///
    /// | coordinate | swell                  | shorter wave              |
    /// |------------|------------------------|---------------------------|
    /// | heave      | 0.6 m, 0.7 rad/s       | 0.2 m, 1.15 rad/s         |
    /// | roll       | 5°, 0.8 rad/s          | 1.5°, 1.3 rad/s           |
    /// | pitch      | 2.5°, 0.7 rad/s        | 1°, 1.15 rad/s            |
    /// | yaw        | 2°, 0.5 rad/s          | 0.5°, 1.0 rad/s           |
    ///
    /// # Source
    /// The thesis names a marine platform with four degrees of freedom and says neither which nor how they move. These
    /// four are one reading: those of a ship that keeps its place. Amplitudes, frequencies and phases are assumed.
    pub const MARINE: Self = Self([
        Motion {
            sine: [0.0, 0.0, 0.6, 5.0 * DEGREE, 0.0, 2.0 * DEGREE],
            cosine: [0.0, 0.0, 0.0, 0.0, 2.5 * DEGREE, 0.0],
            frequency: [0.0, 0.0, 0.7, 0.8, 0.7, 0.5],
            ..STILL
        },
        Motion {
            sine: [0.0, 0.0, 0.0, 1.5 * DEGREE, 1.0 * DEGREE, 0.0],
            cosine: [0.0, 0.0, 0.2, 0.0, 0.0, 0.5 * DEGREE],
            frequency: [0.0, 0.0, 1.15, 1.3, 1.15, 1.0],
            ..SWING
        },
    ]);
}

impl<const K: usize> Superposition<K> {
    /// A heave `z = middle + Σ A_k sin(ω_k t)` \[m\], level over the middle of the base.
    ///
    /// | argument    | meaning | unit  |
    /// |-------------|---------|-------|
    /// | `middle`    | mean height of the frame over the base | m |
    /// | `amplitude` | `A_k`   | m     |
    /// | `frequency` | `ω_k`   | rad/s |
    ///
    /// Without sines it stands still at a height of zero.
    #[must_use]
    pub fn heave(middle: f64, amplitude: &[f64; K], frequency: &[f64; K]) -> Self {
        Self(core::array::from_fn(|k| {
            let in_z = |value: f64| [0.0, 0.0, value, 0.0, 0.0, 0.0];
            let mean = in_z(if k == 0 { middle } else { 0.0 });
            Motion { mean, sine: in_z(amplitude[k]), frequency: [frequency[k]; 6], ..SWING }
        }))
    }

    /// What it swings about \[m, rad\].
    #[must_use]
    pub fn mean(&self) -> Coordinates {
        core::array::from_fn(|i| self.0.iter().map(|motion| motion.mean[i]).sum())
    }

    /// The motion about another mean \[m, rad\].
    #[must_use]
    pub fn about(&self, mean: &Coordinates) -> Self {
        let mut motions = self.0.map(|motion| Motion { mean: [0.0; 6], ..motion });
        if let Some(first) = motions.first_mut() {
            first.mean = *mean;
        }
        Self(motions)
    }

    /// The motion with all swings larger by a factor, about the same mean.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |swing: Coordinates| swing.map(|amplitude| factor * amplitude);
        Self(self.0.map(|motion| Motion { sine: scaled(motion.sine), cosine: scaled(motion.cosine), ..motion }))
    }
}

impl<const K: usize> PlatformMotion for Superposition<K> {
    fn at(&self, t: f64) -> [Coordinates; 3] {
        let mut total = [[0.0; 6]; 3];
        for motion in self.0.map(|motion| motion.at(t)) {
            for (total, part) in total.as_flattened_mut().iter_mut().zip(motion.as_flattened()) {
                *total += part;
            }
        }
        total
    }
}

/// Value, rate and acceleration at the part `s` of an interval of the length `h`, from those at its ends.
///
/// With `p(s) = p₀ + v₀ s + ½ a₀ s² + s³ (c₃ + c₄ s + c₅ s²)`, velocities times h and accelerations times h², and what
/// is missing at the end, `D = p₁ − p₀ − v₀ − ½ a₀`, `E = v₁ − v₀ − a₀`, `F = a₁ − a₀`: `c₃ = 10 D − 4 E + ½ F`, `c₄ =
/// −15 D + 7 E − F`, `c₅ = 6 D − 3 E + ½ F`.
///
/// # Source
/// E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*, section II.6, for Hermite's
/// interpolation.
#[must_use]
pub fn hermite([p0, v0, a0]: [f64; 3], [p1, v1, a1]: [f64; 3], h: f64, s: f64) -> [f64; 3] {
    let (v0, v1, a0, a1) = (v0 * h, v1 * h, a0 * h * h, a1 * h * h);
    let (d, e, f) = (p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0);
    let (c3, c4, c5) = (10.0 * d - 4.0 * e + 0.5 * f, -15.0 * d + 7.0 * e - f, 6.0 * d - 3.0 * e + 0.5 * f);
    [
        p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5)))),
        (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h,
        (a0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the theorems of addition and by hand: two sines of one frequency are one, means and factors act where they
    /// should.
    #[test]
    fn motions_add_up() {
        let t = 1.7;
        let two = Superposition([Motion::COMBINED, Motion { mean: [0.0; 6], ..Motion::COMBINED }]);
        let twice = Superposition([Motion::COMBINED]).scaled(2.0);
        let (found, expected) = (two.at(t), twice.at(t));
        let pairs = found.as_flattened().iter().zip(expected.as_flattened());
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-15), "{found:?} {expected:?}");
        assert_eq!((two.mean(), twice.mean()), (HOME, HOME));
        let raised = two.about(&[0.0, 0.0, 2.0, 0.0, 0.0, 0.1]).at(t);
        assert!((raised[0][2] - found[0][2] - 0.9).abs() < 1e-15 && (raised[0][5] - found[0][5] - 0.1).abs() < 1e-15);
        assert_eq!(raised[1..], found[1..]);
    }

    #[test]
    fn the_marine_platform_has_four_degrees_of_freedom() {
        let marine = Superposition::MARINE;
        let h = 1e-4;
        for t in [0.0, 0.9, 6.3, 20.0] {
            let [before, here, after] = [t - h, t, t + h].map(|t| marine.at(t));
            for i in 0..6 {
                assert!((after[0][i] - before[0][i] - 2.0 * h * here[1][i]).abs() < 1e-11);
                assert!((after[1][i] - before[1][i] - 2.0 * h * here[2][i]).abs() < 1e-11);
                let moves = here[1][i] != 0.0;
                assert_eq!(moves, i >= 2, "{i}");
            }
        }
    }

    #[test]
    fn polynomials_of_degree_5_are_kept() {
        // 1 − t + 2t² − 3t³ + t⁴/2 − t⁵, from 0.3 to 0.8.
        let at = |t: f64| {
            [
                1.0 - t + 2.0 * t * t - 3.0 * t.powi(3) + 0.5 * t.powi(4) - t.powi(5),
                -1.0 + 4.0 * t - 9.0 * t * t + 2.0 * t.powi(3) - 5.0 * t.powi(4),
                4.0 - 18.0 * t + 6.0 * t * t - 20.0 * t.powi(3),
            ]
        };
        for s in [0.0, 0.2, 0.7, 1.0] {
            let (found, expected) = (hermite(at(0.3), at(0.8), 0.5, s), at(0.3 + 0.5 * s));
            assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-13), "{s}: {found:?}, not {expected:?}");
        }
    }
}
