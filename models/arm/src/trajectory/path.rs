//! Curves in the joints' space, without time.

use super::{Extrema, JointState, Motion, POSITION, Piecewise};
use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};

/// A point of a path with its tangent and curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint<const N: usize> {
    /// Joint angles \[rad\].
    pub q: [f64; N],
    /// `dq/ds` \[rad\].
    pub tangent: [f64; N],
    /// `d²q/ds²` \[rad\].
    pub curvature: [f64; N],
}

/// Joint angles as functions of a path parameter `s`, from 0 to a length, twice differentiable.
pub trait JointPath<const N: usize> {
    /// The last path parameter, positive.
    fn length(&self) -> f64;

    /// The point at `s`.
    ///
    /// # Errors
    /// [`Failure::Invalid`] if `s` is before 0, beyond the length, or NaN; what the path itself refuses.
    fn point(&self, s: f64) -> Result<PathPoint<N>, Error>;
}

impl<const N: usize, P: JointPath<N> + ?Sized> JointPath<N> for &P {
    fn length(&self) -> f64 {
        (**self).length()
    }

    fn point(&self, s: f64) -> Result<PathPoint<N>, Error> {
        (**self).point(s)
    }
}

/// A straight line between two postures, `0 ≤ s ≤ 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightPath<const N: usize> {
    start: [f64; N],
    stop: [f64; N],
}

impl<const N: usize> StraightPath<N> {
    /// From `start` to `stop` \[rad\].
    ///
    /// # Errors
    /// An angle that is not finite, and equal postures.
    pub fn new(start: [f64; N], stop: [f64; N]) -> Result<Self, Error> {
        check::finite(POSITION, start)?;
        check::finite(POSITION, stop)?;
        if start == stop { Err(Failure::NoMotion.into()) } else { Ok(Self { start, stop }) }
    }
}

impl<const N: usize> JointPath<N> for StraightPath<N> {
    fn length(&self) -> f64 {
        1.0
    }

    fn point(&self, s: f64) -> Result<PathPoint<N>, Error> {
        check::within("path parameter", s, [0.0, 1.0])?;
        let tangent: [f64; N] = core::array::from_fn(|i| self.stop[i] - self.start[i]);
        let q = core::array::from_fn(|i| (1.0 - s) * self.start[i] + s * self.stop[i]);
        Ok(PathPoint { q, tangent, curvature: [0.0; N] })
    }
}

/// The curve that a motion goes along; its parameter is what was time.
impl<const N: usize, const P: usize> JointPath<N> for Piecewise<N, P> {
    fn length(&self) -> f64 {
        self.duration()
    }

    fn point(&self, s: f64) -> Result<PathPoint<N>, Error> {
        check::within("path parameter", s, [0.0, self.duration()])?;
        let state = self.at(s)?;
        Ok(PathPoint { q: state.q, tangent: state.qd, curvature: state.qdd })
    }
}

/// A motion along a path, by a law that says which path parameter is reached when.
///
/// `q̇ = q′ ṡ` and `q̈ = q′ s̈ + q″ ṡ²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlongPath<P, const N: usize, const PIECES: usize> {
    path: P,
    /// Of the path, positive and finite.
    length: f64,
    law: Piecewise<1, PIECES>,
}

impl<const N: usize, const PIECES: usize, P: JointPath<N>> AlongPath<P, N, PIECES> {
    /// Along `path` by `law`, a trajectory of the path parameter as if it were a joint.
    ///
    /// # Errors
    /// [`Failure::Invalid`] if the length of the path is not positive and finite, or if the law leaves the path, by
    /// more than rounding.
    pub fn new(path: P, law: Piecewise<1, PIECES>) -> Result<Self, Error> {
        let length = path.length();
        check::positive("length", length)?;
        let [Extrema { lowest, highest }] = law.position_extrema();
        for s in [lowest.value, highest.value] {
            if s.is_nan() || s < -1e-12 * length || s > length * (1.0 + 1e-12) {
                return Err(Must::BeWithin([0.0, length]).broken_by("path parameter", s).into());
            }
        }
        Ok(Self { path, length, law })
    }
}

impl<const N: usize, const PIECES: usize, P: JointPath<N>> Motion<N> for AlongPath<P, N, PIECES> {
    fn duration(&self) -> f64 {
        self.law.duration()
    }

    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        let JointState { q: [s], qd: [rate], qdd: [acceleration] } = self.law.at(t)?;
        let PathPoint { q, tangent, curvature } = self.path.point(s.clamp(0.0, self.length))?;
        let qdd = core::array::from_fn(|i| tangent[i] * acceleration + curvature[i] * rate * rate);
        Ok(JointState { q, qd: tangent.map(|tangent| tangent * rate), qdd })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::quintic;

    /// A straight line that claims another length.
    #[derive(Clone, Copy, Debug)]
    struct Claimed(f64);

    impl JointPath<1> for Claimed {
        fn length(&self) -> f64 {
            self.0
        }

        fn point(&self, s: f64) -> Result<PathPoint<1>, Error> {
            Ok(PathPoint { q: [s], tangent: [1.0], curvature: [0.0] })
        }
    }

    #[test]
    fn a_path_needs_a_length() {
        let law = quintic([0.0], [0.0], [1.0], 2.0).expect("a motion");
        for length in [f64::NAN, -1.0, 0.0, f64::INFINITY, f64::NEG_INFINITY] {
            match AlongPath::new(Claimed(length), law) {
                Err(error) => {
                    assert_eq!(error.invalid().map(|found| found.value.to_bits()), Some(length.to_bits()));
                }
                other => panic!("{length}: {other:?}"),
            }
        }
        let motion = AlongPath::new(Claimed(1.0), law).expect("the law ends with the path");
        assert_eq!(motion.at(2.0).map(|end| end.q), Ok([1.0]));
    }
}
