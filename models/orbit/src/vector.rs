//! Vectors with three components, and the state of a point that they make.

use mbs_models::check::{self, Invalid};
use mbs_runtime::State;

/// Components along three axes.
pub type Vector = [f64; 3];

/// Where a point is and how it moves, in one frame: cartesian, with the names of a vector's two parts.
///
/// [`State`] is that of a mechanism, in whatever coordinates it has, as integrators move it. Where the coordinates are
/// cartesian `From` leads from each to the other.
///
/// ```
/// use mbs_orbit::vector::StateVector;
/// use mbs_runtime::State;
///
/// let state = State::new([7e6, 0.0, 0.0], [0.0, 7.5e3, 0.0]);
/// assert_eq!(State::from(StateVector::from(state)), state);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateVector {
    /// \[m\], or another unit of length.
    pub position: Vector,
    /// The same unit per unit of time.
    pub velocity: Vector,
}

impl StateVector {
    /// The state at a position, with a velocity.
    #[must_use]
    pub fn new(position: Vector, velocity: Vector) -> Self {
        Self { position, velocity }
    }

    /// Position, then velocity.
    #[must_use]
    pub fn to_array(&self) -> [f64; 6] {
        let ([x, y, z], [u, v, w]) = (self.position, self.velocity);
        [x, y, z, u, v, w]
    }

    /// Of a position and then a velocity.
    #[must_use]
    pub fn from_array([x, y, z, u, v, w]: [f64; 6]) -> Self {
        Self { position: [x, y, z], velocity: [u, v, w] }
    }

    /// True where all six numbers are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.to_array().iter().all(|x| x.is_finite())
    }

    /// Refuses a state that is not finite.
    ///
    /// # Errors
    /// [`Invalid`], the first component that is not.
    pub(crate) fn check(&self) -> Result<(), Invalid> {
        check::finite("position", self.position)?;
        check::finite("velocity", self.velocity)
    }
}

impl From<State<[f64; 3]>> for StateVector {
    fn from(State { q, qd }: State<[f64; 3]>) -> Self {
        Self { position: q, velocity: qd }
    }
}

impl From<StateVector> for State<[f64; 3]> {
    fn from(StateVector { position, velocity }: StateVector) -> Self {
        Self { q: position, qd: velocity }
    }
}

/// `a·b`
#[inline]
pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `|a|`
#[inline]
pub(super) fn norm(a: &Vector) -> f64 {
    mbs_runtime::Scalar::sqrt(dot(a, a))
}

/// `a × b`
#[inline]
pub(super) fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + b`
#[inline]
pub(super) fn plus(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a − b`
#[inline]
pub(super) fn minus(a: &Vector, b: &Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `s a`
#[inline]
pub(super) fn scaled(s: f64, a: &Vector) -> Vector {
    [s * a[0], s * a[1], s * a[2]]
}

/// `s a + t b`
#[inline]
pub(super) fn combined(s: f64, a: &Vector, t: f64, b: &Vector) -> Vector {
    [s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]]
}

/// A product of a matrix of 6 × 6 with a state.
#[inline]
pub(super) fn transformed(matrix: &[[f64; 6]; 6], state: &StateVector) -> StateVector {
    let x = state.to_array();
    StateVector::from_array(core::array::from_fn(|i| (0..6).map(|j| matrix[i][j] * x[j]).sum()))
}
