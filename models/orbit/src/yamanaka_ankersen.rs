//! Motion near a station on an ellipse, linear: the state transition matrix of Yamanaka and Ankersen.
//!
//! Tschauner and Hempel's equations, with the true anomaly θ instead of the time and distances multiplied by `ρ = 1 + e
//! cos θ`, have solutions without singularities and with one integral, which is the time itself:
//!
//! ```text
//! J = (h/p²) (t − t₀),   s = ρ sin θ,   c = ρ cos θ
//! ```
//!
//! # Source
//! Yamanaka, Ankersen, *New state transition matrix for relative motion on an arbitrary elliptical orbit*, Journal of
//! Guidance, Control, and Dynamics 25(1), 2002: the transition in the plane and its inverse at the beginning. Their x,
//! y, z are y, −z, −x here.

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::clohessy_wiltshire::Transfer;
use super::integrals::angular_momentum;
use super::kepler::propagate;
use super::lvlh::Frame;
use super::vector::{StateVector, Vector, dot, norm, transformed};

/// One end of the time.
struct Anomaly {
    e: f64,
    sin: f64,
    cos: f64,
    rho: f64,
}

impl Anomaly {
    fn new(e: f64, theta: f64) -> Self {
        let (sin, cos) = Scalar::sin_cos(theta);
        Self { e, sin, cos, rho: 1.0 + e * cos }
    }

    /// Solutions in the orbital plane: rows x̃, z̃, x̃', z̃' of the authors' `Φ_θ`.
    fn solutions(&self, j: f64) -> [[f64; 4]; 4] {
        let Self { e, rho, .. } = *self;
        let (s, c) = (rho * self.sin, rho * self.cos);
        let (s_dash, c_dash) = self.derivatives();
        let inverse = 1.0 / rho;
        [
            [1.0, -c * (1.0 + inverse), s * (1.0 + inverse), 3.0 * rho * rho * j],
            [0.0, s, c, 2.0 - 3.0 * e * s * j],
            [0.0, 2.0 * s, 2.0 * c - e, 3.0 * (1.0 - 2.0 * e * s * j)],
            [0.0, s_dash, c_dash, -3.0 * e * (s_dash * j + s * inverse * inverse)],
        ]
    }

    /// The inverse of [`solutions`](Self::solutions) at J = 0.
    fn constants(&self) -> [[f64; 4]; 4] {
        let Self { e, rho, .. } = *self;
        let (s, c) = (rho * self.sin, rho * self.cos);
        let inverse = 1.0 / rho;
        let part = 1.0 / (1.0 - e * e);
        let rows = [
            [1.0 - e * e, 3.0 * e * s * inverse * (1.0 + inverse), -e * s * (1.0 + inverse), 2.0 - e * c],
            [0.0, -3.0 * s * inverse * (1.0 + e * e * inverse), s * (1.0 + inverse), c - 2.0 * e],
            [0.0, -3.0 * (c * inverse + e), c * (1.0 + inverse) + e, -s],
            [0.0, 3.0 * rho + e * e - 1.0, -rho * rho, e * s],
        ];
        rows.map(|row| row.map(|x| part * x))
    }

    /// `s'` and `c'` by θ.
    fn derivatives(&self) -> (f64, f64) {
        let Self { e, sin, cos, .. } = *self;
        (cos + e * (cos * cos - sin * sin), -(sin + 2.0 * e * sin * cos))
    }
}

/// The state transition matrix for states relative to a station, in the axes of [`lvlh`](super::lvlh): position, then
/// velocity, `matrix[row][column]`.
///
/// | argument  | meaning                                     | unit   |
/// |-----------|---------------------------------------------|--------|
/// | `mu`      | G times the mass of the centre              | m³/s²  |
/// | `station` | inertial, relative to the centre, at first  | m, m/s |
/// | `time`    | how far to go                               | s      |
///
/// # Errors
/// [`Error`].
pub fn state_transition(mu: f64, station: &StateVector, time: f64) -> Result<[[f64; 6]; 6], Error> {
    let end = propagate(mu, station, time)?.state;
    let frame = Frame::of(station)?;
    let h = norm(&angular_momentum(station));
    let (r, p) = (norm(&station.position), h * h / mu);
    let (e_cos, e_sin) = (p / r - 1.0, h / mu * dot(&station.position, &station.velocity) / r);
    let e = Scalar::sqrt(e_cos * e_cos + e_sin * e_sin);
    // `e < 1` by the energy would be no surer: e is known to some roundings.
    Must::BeLessThan(1.0).check("eccentricity of the station's orbit", e)?;
    let theta = Scalar::atan2(e_sin, e_cos);
    // What the station has gone round, so that a circle needs no nearest point.
    let [x, y, _] = frame.axes();
    let swept = Scalar::atan2(dot(&end.position, y), dot(&end.position, x));
    let (before, after) = (Anomaly::new(e, theta), Anomaly::new(e, theta + swept));
    let k2 = h / (p * p);
    let (solutions, constants) = (after.solutions(k2 * time), before.constants());
    let plane: [[f64; 4]; 4] =
        core::array::from_fn(|i| core::array::from_fn(|j| (0..4).map(|k| solutions[i][k] * constants[k][j]).sum()));
    // Across: ỹ swings like a pendulum.
    let (sin, cos) = (after.sin * before.cos - after.cos * before.sin, after.cos * before.cos + after.sin * before.sin);
    let across = [[cos, sin], [-sin, cos]];

    // Per axis: x̃ = ρ x, x̃' = −e sin θ x + ẋ/(k² ρ), and back x = x̃/ρ, ẋ = k² (e sin θ x̃ + ρ x̃').
    let into = [[before.rho, 0.0], [-e * before.sin, 1.0 / (k2 * before.rho)]];
    let out = [[1.0 / after.rho, 0.0], [k2 * e * after.sin, k2 * after.rho]];
    let transformed = |block: [[f64; 2]; 2]| product(&out, &product(&block, &into));

    // Theirs in ours: x ← −z, y ← x, z ← −y.
    const PLACE: [(usize, f64); 2] = [(1, -1.0), (0, 1.0)];
    let mut matrix = [[0.0; 6]; 6];
    for (i, (row, row_sign)) in PLACE.into_iter().enumerate() {
        for (j, (column, column_sign)) in PLACE.into_iter().enumerate() {
            let block = transformed([
                [plane[row][column], plane[row][column + 2]],
                [plane[row + 2][column], plane[row + 2][column + 2]],
            ]);
            insert(&mut matrix, i, j, &block.map(|line| line.map(|x| row_sign * column_sign * x)));
        }
    }
    insert(&mut matrix, 2, 2, &transformed(across));
    let finite = matrix.iter().flatten().all(|x| x.is_finite());
    if finite { Ok(matrix) } else { Err(Failure::OutOfRange.into()) }
}

/// Position and velocity of one axis by those of another.
fn insert(matrix: &mut [[f64; 6]; 6], i: usize, j: usize, block: &[[f64; 2]; 2]) {
    for a in 0..2 {
        for b in 0..2 {
            matrix[i + 3 * a][j + 3 * b] = block[a][b];
        }
    }
}

fn product(a: &[[f64; 2]; 2], b: &[[f64; 2]; 2]) -> [[f64; 2]; 2] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// The velocities of the coast that leads from one place to another in a time, as
/// [`clohessy_wiltshire::transfer`](super::clohessy_wiltshire::transfer) gives them on a circle.
///
/// | argument     | meaning                                    | unit   |
/// |--------------|--------------------------------------------|--------|
/// | `mu`         | G times the mass of the centre             | m³/s²  |
/// | `station`    | inertial, relative to the centre, at first | m, m/s |
/// | `from`, `to` | places in the station's frame              | m      |
/// | `time`       | from one to the other; may be negative     | s      |
///
/// # Errors
/// [`Error`]; [`Failure::Undetermined`] where the place after this time does not depend on some velocity.
pub fn transfer(mu: f64, station: &StateVector, from: &Vector, to: &Vector, time: f64) -> Result<Transfer, Error> {
    let phi = state_transition(mu, station, time)?;
    check::finite("from", *from)?;
    check::finite("to", *to)?;
    let missing: Vector = core::array::from_fn(|i| to[i] - (0..3).map(|j| phi[i][j] * from[j]).sum::<f64>());
    // Cramer's rule, in the plane and across.
    let (a, b, c, d) = (phi[0][3], phi[0][4], phi[1][3], phi[1][4]);
    let determinant = a * d - b * c;
    let across = phi[2][5];
    let size = a * a + b * b + c * c + d * d;
    if determinant.abs() <= SINGULAR * size || (across * across <= SINGULAR * SINGULAR * size && missing[2] != 0.0) {
        return Err(Failure::Undetermined("the velocity to a place").at_time(time));
    }
    let w = if missing[2] == 0.0 { 0.0 } else { missing[2] / across };
    let departure =
        [(d * missing[0] - b * missing[1]) / determinant, (a * missing[1] - c * missing[0]) / determinant, w];
    let end = transformed(&phi, &StateVector::new(*from, departure));
    // An overflow on the way to the velocity reaches the end.
    if !end.is_finite() {
        return Err(Failure::OutOfRange.into());
    }
    Ok(Transfer { departure, arrival: end.velocity })
}

/// A determinant that is smaller than this part of the squares that it is made of is none.
const SINGULAR: f64 = 1e-9;
