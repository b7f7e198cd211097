//! What waves do to the platform: pressure on columns and pontoons as it is in the undisturbed wave (Froude and
//! Krylov), and the added mass and damping of the pontoons against water that moves up and down (relative motion).
//!
//! A wave `ζ = A cos τ` at the origin, `τ = ω t + ε`, goes by `c = cos χ` along and `s = sin χ` across the platform.
//! The columns stand at (±X, ±Y) with feet at the depth d, the pontoons lie at ±Y over the length l, at the depth p,
//! their volume is V:
//!
//! ```text
//! heave  (ρ g A_w e^(−kd) C_c − ω² (ρV + a) e^(−kp) C_p) A cos τ − b_z ω e^(−kp) C_p A sin τ
//!        C_c = cos kXc cos kYs,   C_p = sin(q)/q cos kYs,   q = k l c/2
//! ```
//!
//! Moments are those of the same forces at their places, with the horizontal pressure forces on columns and pontoons
//! below the mass centre. In waves much longer than the platform they are `ρ g ∇ GM` times the slope of the surface,
//! and in yaw `ρ g (∫x² dV − ∫y² dV) k² c s A cos τ`.
//!
//! Left out: diffraction of the horizontal motion, drift, the platform's motion and speed in the wave.
//!
//! # Source
//! O. M. Faltinsen, *Sea Loads on Ships and Offshore Structures*, 1990, chapter 3 (long waves, heave of a
//! semi-submersible); J. M. J. Journée and W. W. Massie, *Offshore Hydromechanics*, 2001, chapter 6 (relative motion;
//! the factor e^(−kd) is Smith's).

use mbs_models::marine_platform::Params;
use mbs_runtime::Scalar;

use super::Four;
use super::hull::Hull;
use super::sea::{Sea, Wave};
use super::spectrum::simpson;

/// Of Simpson's rule over what decays a few times at most.
const PANELS: usize = 32;

/// A force of one wave: `cosine cos τ + sine sin τ`, of heave \[N\], roll, pitch and yaw \[N·m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// In phase with the elevation over the mass centre.
    pub cosine: Four,
    /// A quarter of a period behind it.
    pub sine: Four,
}

impl Response {
    /// To a wave of its amplitude on a platform at rest.
    #[must_use]
    pub fn to(hull: &Hull, wave: &Wave) -> Self {
        let Params { column_place: [x, y], pontoon: [length, breadth, height], mass_centre, column_radius, .. } =
            hull.params;
        let Params { density, g, added_mass, heave_damping, turn_damping, .. } = hull.params;
        let (s, c) = Scalar::sin_cos(wave.direction);
        let (k, w) = (wave.number(), wave.frequency);
        let decay = |depth: f64| Scalar::exp(-k * depth);
        let ((sin_x, cos_x), (sin_y, cos_y)) = (Scalar::sin_cos(k * x * c), Scalar::sin_cos(k * y * s));
        let pontoon_depth = hull.draught + 0.5 * height;
        let (at_feet, at_pontoons) = (decay(hull.draught), decay(pontoon_depth));
        let half = 0.5 * length;
        let (mean, first) = along_pontoon(k * half * c);
        // Of the water that is displaced, with its wave's decay: volumes, and moments of depths below the mass centre.
        let to_centre = mass_centre - hull.draught;
        let columns = hull.waterplane * simpson(hull.draught, PANELS, decay);
        let lever = hull.waterplane * simpson(hull.draught, PANELS, |depth| (depth + to_centre) * decay(depth));
        let pontoons = hull.submerged * at_pontoons;
        let under_columns = |height: f64| hull.draught + height;
        let pontoon_lever = hull.submerged / height
            * simpson(height, PANELS, |h| (under_columns(h) + to_centre) * decay(under_columns(h)));
        // Over the unit of elevation \[N/m\].
        let lift = density * g * hull.waterplane * at_feet;
        let inertia = w * w * (density * hull.submerged + added_mass) * at_pontoons;
        let weight = density * g;
        let own = 0.25 * column_radius * column_radius;

        let heave = lift * cos_x * cos_y - inertia * mean * cos_y;
        // Beside the middle of the platform and, less, beside that of a pontoon.
        let beside = y * sin_y + k * s * breadth * breadth / 12.0 * cos_y;
        let sides = lift * (y * sin_y * cos_x + k * s * own * cos_x * cos_y) - inertia * beside * mean;
        let roll = sides - weight * k * s * (lever * cos_x * cos_y + pontoon_lever * mean * cos_y);
        let ends = lift * (x * sin_x * cos_y + k * c * own * cos_x * cos_y) - inertia * half * first * cos_y;
        let pitch = weight * k * c * (lever * cos_x * cos_y + pontoon_lever * mean * cos_y) - ends;
        let yaw_of_columns = columns * (s * x * sin_x * cos_y - c * y * sin_y * cos_x);
        let yaw_of_pontoons = pontoons * (s * half * first * cos_y - c * beside * mean);
        let yaw = weight * k * (yaw_of_columns + yaw_of_pontoons);

        let rise = w * at_pontoons;
        let damped_heave = -heave_damping * rise * mean * cos_y;
        let damped_roll = turn_damping[0] * rise * mean * sin_y / y;
        let damped_pitch = -turn_damping[1] * rise * cos_y * 3.0 * first / half;
        Self {
            cosine: [heave, damped_roll, damped_pitch, yaw].map(|force| wave.amplitude * force),
            sine: [damped_heave, roll, pitch, 0.0].map(|force| wave.amplitude * force),
        }
    }
}

/// `(1/l) ∫ cos(2qξ/l) dξ = sin(q)/q` and `(2/l²) ∫ ξ sin(2qξ/l) dξ = (sin q − q cos q)/q²` over the length l.
fn along_pontoon(q: f64) -> (f64, f64) {
    if q.abs() < 1e-2 {
        let q2 = q * q;
        return (1.0 - q2 / 6.0 * (1.0 - q2 / 20.0), q / 3.0 * (1.0 - q2 / 10.0 * (1.0 - q2 / 28.0)));
    }
    let (sin, cos) = Scalar::sin_cos(q);
    (sin / q, (sin - q * cos) / (q * q))
}

/// What a sea of N waves does to the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excitation<const N: usize> {
    /// Frequency \[rad/s\], phase \[rad\] and response of each wave.
    waves: [(f64, f64, Response); N],
}

impl<const N: usize> Excitation<N> {
    /// What this sea does to a hull.
    #[must_use]
    pub fn new(hull: &Hull, sea: &Sea<N>) -> Self {
        Self { waves: sea.waves.map(|wave| (wave.frequency, wave.phase, Response::to(hull, &wave))) }
    }

    /// Upward force \[N\] and moments about the platform's axes \[N·m\] at a time \[s\].
    #[must_use]
    pub fn at(&self, t: f64) -> Four {
        let mut force = [0.0; 4];
        for (frequency, phase, response) in &self.waves {
            let (sin, cos) = Scalar::sin_cos(frequency * t + phase);
            for i in 0..4 {
                force[i] += response.cosine[i] * cos + response.sine[i] * sin;
            }
        }
        force
    }
}

/// `|x/A|` of a coordinate in a regular wave of this response, by its linear equation `M ẍ + b ẋ + c x = F`: a forced
/// oscillator \[m/m, rad/m\].
///
/// Drag and the coupling of coordinates are left out.
#[must_use]
pub fn amplitude_operator(hull: &Hull, wave: &Wave) -> Four {
    let Params { heave_damping, turn_damping: [roll, pitch, yaw], .. } = hull.params;
    let (response, w) = (Response::to(hull, wave), wave.frequency);
    let (inertia, stiffness, damping) = (hull.inertia(), hull.stiffness(), [heave_damping, roll, pitch, yaw]);
    let length = |a: f64, b: f64| Scalar::sqrt(a * a + b * b);
    core::array::from_fn(|i| {
        let force = length(response.cosine[i], response.sine[i]) / wave.amplitude;
        force / length(stiffness[i] - w * w * inertia[i], w * damping[i])
    })
}

/// The wave of this frequency \[rad/s\] and direction \[rad\], of 1 m.
///
/// ```
/// use mbs_models::marine_platform::Params;
/// use mbs_platform::marine::excitation::{amplitude_operator, unit_wave};
/// use mbs_platform::marine::hull::Hull;
///
/// // In waves as long as a swell gets the platform goes with the water.
/// let hull = Hull::new(&Params::default()).unwrap();
/// assert!((amplitude_operator(&hull, &unit_wave(0.1, 0.0))[0] - 1.0).abs() < 0.02);
/// ```
#[must_use]
pub fn unit_wave(frequency: f64, direction: f64) -> Wave {
    Wave { amplitude: 1.0, frequency, direction, phase: 0.0 }
}
