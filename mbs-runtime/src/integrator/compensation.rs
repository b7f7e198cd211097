//! Sums whose rounding errors are kept: a symplectic method is only as good over a million steps as its additions.
//!
//! Source: W. Kahan, *Further remarks on reducing truncation errors*, 1965; E. Hairer, C. Lubich and G. Wanner,
//! *Geometric Numerical Integration*, 2nd ed. 2006, section VIII.5, algorithm 5.1.

use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// What rounding left out of a state: the state and this together are what the method computed.
#[derive(Clone, Debug)]
pub(super) struct Compensation<V> {
    /// Left out at the beginning of the step.
    old: State<V>,
    /// Left out at its end.
    new: State<V>,
}

impl<V: Coordinates> Compensation<V> {
    pub(super) fn new(like: &State<V>) -> Self {
        let mut zero = Self { old: like.clone(), new: like.clone() };
        zero.clear();
        zero
    }

    /// Nothing is left out of a state that is given.
    pub(super) fn clear(&mut self) {
        for state in [&mut self.old, &mut self.new] {
            for numbers in [&mut state.q, &mut state.qd] {
                numbers.as_mut_slice().fill(V::Scalar::zero());
            }
        }
    }

    /// The end of the step becomes the beginning of the next.
    pub(super) fn proceed(&mut self) {
        core::mem::swap(&mut self.old, &mut self.new);
    }

    /// The part of `q̇ᵢ` at the beginning that rounding left out.
    #[inline]
    pub(super) fn velocity(&self, i: usize) -> V::Scalar {
        self.old.qd.as_slice()[i]
    }

    /// `qᵢ + increment` and what it leaves out.
    #[inline]
    pub(super) fn add_to_coordinate(&mut self, i: usize, q: V::Scalar, increment: V::Scalar) -> V::Scalar {
        let (sum, rest) = add(q, increment + self.old.q.as_slice()[i]);
        self.new.q.as_mut_slice()[i] = rest;
        sum
    }

    /// `q̇ᵢ + increment` and what it leaves out.
    #[inline]
    pub(super) fn add_to_velocity(&mut self, i: usize, qd: V::Scalar, increment: V::Scalar) -> V::Scalar {
        let (sum, rest) = add(qd, increment + self.old.qd.as_slice()[i]);
        self.new.qd.as_mut_slice()[i] = rest;
        sum
    }
}

/// `a + b = sum + rest`, exactly, whichever is larger (D. E. Knuth, *The Art of Computer Programming* 2, section 4.2.2,
/// theorem B).
#[inline]
fn add<T: Scalar>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::add;

    #[test]
    fn a_sum_and_its_rest_are_exact() {
        let tiny = f64::EPSILON / 8.0;
        for (a, b, expected) in [
            (1.0, tiny, (1.0, tiny)),
            (tiny, 1.0, (1.0, tiny)),
            (-tiny, 1.0, (1.0, -tiny)),
            (1e16, 1.5, (1e16 + 2.0, -0.5)),
            (0.5, 0.25, (0.75, 0.0)),
        ] {
            assert_eq!(add(a, b), expected, "{a} + {b}");
        }
    }
}
