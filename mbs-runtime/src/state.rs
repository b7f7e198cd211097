//! The state of a mechanism, and what coordinates may be stored in.

use crate::scalar::Scalar;

/// Coordinates and velocities `(q, q̇)`.
///
/// | field | meaning                    | shape | unit                    |
/// |-------|----------------------------|-------|-------------------------|
/// | `q`   | generalized coordinates    | `N`   | as declared             |
/// | `qd`  | generalized velocities `q̇` | `N`   | as declared, per second |
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State<V> {
    /// Generalized coordinates.
    pub q: V,
    /// Generalized velocities.
    pub qd: V,
}

impl<V> State<V> {
    /// The state `(q, q̇)`.
    pub const fn new(q: V, qd: V) -> Self {
        Self { q, qd }
    }
}

impl<V: Coordinates> State<V> {
    /// Whether all coordinates and velocities are finite.
    #[must_use]
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.q.is_finite() && self.qd.is_finite()
    }

    /// Takes over the numbers of `other`, without allocation.
    #[inline]
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.q.copy_from(&other.q);
        self.qd.copy_from(&other.qd);
    }
}

/// A vector with one number per coordinate.
///
/// Arrays serve generated code: their length is known to the compiler, nothing is allocated. `Vec` (feature `std`)
/// serves mechanisms whose number of coordinates is known at run time only: an integrator clones it when it starts
/// and allocates nothing after. nalgebra's vectors (feature `nalgebra`) are there for those who
/// compute with them.
///
/// The length of a vector must not change while it is integrated.
pub trait Coordinates: Clone {
    /// The type of the numbers.
    type Scalar: Scalar;

    /// The numbers in the order of the coordinates.
    fn as_slice(&self) -> &[Self::Scalar];

    /// The numbers in the order of the coordinates.
    fn as_mut_slice(&mut self) -> &mut [Self::Scalar];

    /// Whether all numbers are finite.
    #[inline]
    fn is_finite(&self) -> bool {
        // No early exit: numbers are nearly always finite, and so the loop is one of vectors.
        self.as_slice().iter().fold(true, |finite, x| finite & x.is_finite())
    }

    /// Takes over the numbers of `other`, without allocation.
    #[inline]
    fn copy_from(&mut self, other: &Self) {
        let (to, from) = (self.as_mut_slice(), other.as_slice());
        let count = to.len().min(from.len());
        to[..count].copy_from_slice(&from[..count]);
    }
}

impl<T: Scalar, const N: usize> Coordinates for [T; N] {
    type Scalar = T;

    #[inline]
    fn as_slice(&self) -> &[T] {
        self
    }

    #[inline]
    fn as_mut_slice(&mut self) -> &mut [T] {
        self
    }
}

#[cfg(feature = "nalgebra")]
impl<T: Scalar, const N: usize> Coordinates for nalgebra::SVector<T, N> {
    type Scalar = T;

    #[inline]
    fn as_slice(&self) -> &[T] {
        self.data.as_slice()
    }

    #[inline]
    fn as_mut_slice(&mut self) -> &mut [T] {
        self.data.as_mut_slice()
    }
}

#[cfg(feature = "std")]
impl<T: Scalar> Coordinates for std::vec::Vec<T> {
    type Scalar = T;

    #[inline]
    fn as_slice(&self) -> &[T] {
        self
    }

    #[inline]
    fn as_mut_slice(&mut self) -> &mut [T] {
        self
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    #[test]
    fn a_nan_anywhere_is_found() {
        assert!(State::new([1.0, 2.0], [3.0, 4.0]).is_finite());
        assert!(!State::new([1.0, f64::NAN], [3.0, 4.0]).is_finite());
        assert!(!State::new([1.0, 2.0], [f64::INFINITY, 4.0]).is_finite());
        #[cfg(feature = "nalgebra")]
        assert!(State::new(nalgebra::Vector1::new(1.0_f32), nalgebra::Vector1::new(2.0)).is_finite());
    }

    #[test]
    fn copies_are_exact() {
        let mut state = State::new([0.0; 3], [0.0; 3]);
        let other = State::new([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
        state.copy_from(&other);
        assert_eq!(state, other);
    }
}
