//! Direct kinematics: the pose from the lengths of the legs, by Newton's method, damped and bounded.
//!
//! ```text
//! f_i = (|R P_i + p − B_i|² − l_i²) / (2 l_i) = 0,   i = 0 … 5
//! ```
//!
//! which is the leg's excess length, up to its square. The unknowns are the place `p` and a rotation matrix, which each
//! step turns by a vector: no angle is evaluated between start and end, and none can be singular. A step that does not
//! lessen `Σ f_i²` is halved. Steps are bounded in number, so that lengths which belong to no pose end in an error, not
//! in an endless loop.
//!
//! A platform has up to forty poses with the same lengths (J.-P. Merlet, *Parallel Robots*, 2nd ed. 2006, section
//! 4.3.2); the one found is that which the start leads to. In tracking a motion that is the last pose.

use mbs_models::{Error, Failure, check};
use mbs_runtime::{Scalar, to_matrix, to_vector};

use super::geometry::attitude;
use super::{Coordinates, LegVector, Platform};
use crate::geometry::{cross, dot};

/// A pose found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectKinematics {
    /// `(x, y, z, φ, θ, ψ)` \[m, rad\], θ between ±90°, φ and ψ between ±180°.
    pub pose: Coordinates,
    /// Steps that it took: solutions of six linear equations.
    pub iterations: usize,
    /// The largest difference of a leg's length at this pose from the length wanted \[m\].
    pub residual: f64,
}

/// How the pose is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// The largest `|f_i|` of a pose that is taken \[m\]; never less than what rounding leaves of the lengths.
    pub tolerance: f64,
    /// The most steps.
    pub iterations: usize,
}

impl Default for Newton {
    /// To 1e-13 m, in 50 steps.
    fn default() -> Self {
        Self { tolerance: 1e-13, iterations: 50 }
    }
}

/// What does not converge where the steps allowed were used up, or no part of a step brought the lengths nearer: they
/// may belong to no pose, or to one on the other side of a singularity.
pub const SEARCH: &str = "the search of the pose";
/// What does not converge where the legs of a pose that it came to do not determine the next step.
pub const SEARCH_AT_SINGULAR: &str = "the search of the pose, at a singular one,";

/// The least part of a step that is tried.
const SMALLEST_PART: f64 = 1e-3;
/// Rounding of `f_i`, as a part of the longest leg.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A pivot that is no larger than this part of the matrix' norm is one of rounding.
const ROUNDED_PIVOT: f64 = 1e-14;

impl Platform {
    /// The pose at which the legs have these lengths \[m\]: [`Newton::solve`] with its default options.
    ///
    /// # Errors
    /// [`Error`].
    pub fn direct(&self, lengths: &LegVector, start: &Coordinates) -> Result<DirectKinematics, Error> {
        Newton::default().solve(self, lengths, start)
    }
}

impl Newton {
    /// The pose at which the legs have these lengths, searched from `start`.
    ///
    /// | argument  | meaning                     | unit   |
    /// |-----------|-----------------------------|--------|
    /// | `lengths` | of the legs                 | m      |
    /// | `start`   | a pose near the one wanted  | m, rad |
    ///
    /// # Errors
    /// [`Failure::NotConverged`] after [`iterations`](Newton::iterations) steps at the latest, of [`SEARCH`], or of
    /// [`SEARCH_AT_SINGULAR`] where the search comes to a singular pose; else what is wrong with the input.
    ///
    /// # Source
    /// Thesis, equation (4.5), solved as it proposes, by Newton and Raphson, with damping and an end.
    pub fn solve(
        &self,
        platform: &Platform,
        lengths: &LegVector,
        start: &Coordinates,
    ) -> Result<DirectKinematics, Error> {
        check::positive("length of leg", *lengths)?;
        check::finite("start", *start)?;
        check::positive("tolerance", self.tolerance)?;
        let longest = lengths.iter().fold(0.0, |longest: f64, length| longest.max(*length));
        let tolerance = self.tolerance.max(ROUNDING * longest);
        let reciprocal = lengths.map(|length| 1.0 / length);
        let excess = |at: &Place| platform.excess(at, lengths, &reciprocal);
        // What is NaN is not closed, and nothing is nearer.
        let is_closed = |excess: &Excess| excess.largest <= tolerance;

        let given_up =
            |what, iterations, residual| Error::from(Failure::NotConverged { what, iterations, residual, unit: "m" });

        let mut place = Place { position: [start[0], start[1], start[2]], rotation: attitude(start) };
        let mut now = excess(&place);
        let mut iterations = 0;
        while !is_closed(&now) {
            if iterations == self.iterations {
                return Err(given_up(SEARCH, iterations, now.largest));
            }
            let jacobian = to_matrix(&now.jacobian(&reciprocal));
            let (lu, least) = (jacobian.lu(), ROUNDED_PIVOT * jacobian.norm());
            // NaN is larger than nothing.
            let is_regular = lu.u().diagonal().iter().all(|pivot| pivot.abs() > least);
            let Some(step) = lu.solve(&to_vector(&now.f)).filter(|_| is_regular) else {
                return Err(given_up(SEARCH_AT_SINGULAR, iterations, now.largest));
            };
            iterations += 1;
            let mut part = 1.0;
            loop {
                let trial = place.moved(step.as_ref(), -part);
                let then = excess(&trial);
                if then.merit < now.merit || is_closed(&then) {
                    (place, now) = (trial, then);
                    break;
                }
                part *= 0.5;
                if part < SMALLEST_PART {
                    return Err(given_up(SEARCH, iterations, now.largest));
                }
            }
        }
        let residual = (0..6).fold(0.0, |largest: f64, i| {
            largest.max((Scalar::sqrt(dot(&now.vector[i], &now.vector[i])) - lengths[i]).abs())
        });
        Ok(DirectKinematics { pose: place.pose(), iterations, residual })
    }
}

/// Where the platform is, without angles.
#[derive(Clone, Copy)]
struct Place {
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
}

/// The legs at a place, and how far their lengths are off.
struct Excess {
    /// `L_i = R P_i + p − B_i`
    vector: [[f64; 3]; 6],
    /// `R P_i`
    lever: [[f64; 3]; 6],
    /// `f_i`
    f: [f64; 6],
    /// The largest `|f_i|`, NaN where one is.
    largest: f64,
    /// `Σ f_i²`
    merit: f64,
}

impl Platform {
    #[inline]
    fn excess(&self, at: &Place, lengths: &LegVector, reciprocal: &LegVector) -> Excess {
        let geometry = self.geometry();
        // Plain loops: closures over arrays are not always inlined, and then take as long as all the rest.
        let mut excess = Excess { vector: [[0.0; 3]; 6], lever: [[0.0; 3]; 6], f: [0.0; 6], largest: 0.0, merit: 0.0 };
        for i in 0..6 {
            // The joints are in the plane z = 0 of their plates: (4.2).
            let [x, y, _] = geometry.platform[i];
            for axis in 0..3 {
                excess.lever[i][axis] = at.rotation[axis][0] * x + at.rotation[axis][1] * y;
                excess.vector[i][axis] = at.position[axis] + excess.lever[i][axis] - geometry.base[i][axis];
            }
            let square = dot(&excess.vector[i], &excess.vector[i]);
            let f = 0.5 * (square - lengths[i] * lengths[i]) * reciprocal[i];
            excess.f[i] = f;
            excess.merit += f * f;
            excess.largest = if f.abs() <= excess.largest { excess.largest } else { f.abs() + 0.0 * excess.largest };
        }
        excess
    }
}

impl Excess {
    /// Rows `∂f_i/∂(p, rotation vector) = [L_i, R P_i × L_i] / l_i`.
    #[inline]
    fn jacobian(&self, reciprocal: &LegVector) -> [[f64; 6]; 6] {
        let mut rows = [[0.0; 6]; 6];
        for i in 0..6 {
            let [x, y, z] = self.vector[i];
            let u = [x * reciprocal[i], y * reciprocal[i], z * reciprocal[i]];
            let moment = cross(&self.lever[i], &u);
            rows[i] = [u[0], u[1], u[2], moment[0], moment[1], moment[2]];
        }
        rows
    }
}

impl Place {
    /// Moved by `part` of the step: shifted, and turned about `w = part · step[3..]` by Cayley's rotation
    /// `1 + (w× + ½ (w×)²) / (1 + ¼ |w|²)`, whose angle is `2 atan(|w|/2)`.
    #[inline]
    fn moved(&self, step: &[f64; 6], part: f64) -> Self {
        let w = [part * step[3], part * step[4], part * step[5]];
        let scale = 1.0 / (1.0 + 0.25 * dot(&w, &w));
        let mut moved = *self;
        for j in 0..3 {
            let r = [self.rotation[0][j], self.rotation[1][j], self.rotation[2][j]];
            let once = cross(&w, &r);
            let twice = cross(&w, &once);
            for i in 0..3 {
                moved.rotation[i][j] = r[i] + scale * (once[i] + 0.5 * twice[i]);
            }
            moved.position[j] += part * step[j];
        }
        moved
    }

    fn pose(&self) -> Coordinates {
        let r = &self.rotation;
        // cos θ as the length of the row, so that θ is accurate near ±90°.
        let phi = Scalar::atan2(r[2][1], r[2][2]);
        let theta = Scalar::atan2(-r[2][0], Scalar::sqrt(r[2][1] * r[2][1] + r[2][2] * r[2][2]));
        let psi = Scalar::atan2(r[1][0], r[0][0]);
        [self.position[0], self.position[1], self.position[2], phi, theta, psi]
    }
}
