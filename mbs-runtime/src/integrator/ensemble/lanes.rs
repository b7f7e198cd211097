//! Numbers of several lanes, and what is made of them lane by lane.

use crate::scalar::{Real, Scalar};

/// A [`Scalar`] of one number or several, each of which can be read and set.
pub trait Lanes: Scalar + Send + Sync {
    /// What one lane has.
    type Real: Real + Send + Sync;
    /// The number of lanes, 1 to 16.
    const COUNT: usize;

    /// The numbers of the lanes.
    fn from_fn(number: impl FnMut(usize) -> Self::Real) -> Self;

    /// The number of one lane.
    ///
    /// # Panics
    /// If there is no such lane.
    fn lane(self, lane: usize) -> Self::Real;
}

macro_rules! one_lane {
    ($($float:ty)+) => {$(
        impl Lanes for $float {
            type Real = $float;
            const COUNT: usize = 1;

            #[inline]
            fn from_fn(mut number: impl FnMut(usize) -> $float) -> Self {
                number(0)
            }

            #[inline]
            fn lane(self, lane: usize) -> $float {
                [self][lane]
            }
        }
    )+};
}
one_lane!(f64 f32);

#[cfg(feature = "wide")]
macro_rules! lanes {
    ($($lanes:ident of $float:ty),+) => {$(
        impl Lanes for wide::$lanes {
            type Real = $float;
            const COUNT: usize = size_of::<Self>() / size_of::<$float>();

            #[inline]
            fn from_fn(number: impl FnMut(usize) -> $float) -> Self {
                Self::from(core::array::from_fn(number))
            }

            #[inline]
            fn lane(self, lane: usize) -> $float {
                self.as_array()[lane]
            }
        }
    )+};
}
#[cfg(feature = "wide")]
lanes!(f64x2 of f64, f64x4 of f64, f64x8 of f64, f32x4 of f32, f32x8 of f32, f32x16 of f32);

/// A number, a vector or a matrix in lanes.
pub trait Packed<L: Lanes> {
    /// A number, a vector or a matrix of one lane.
    type Each;

    /// What one lane has of it.
    fn each(&self, lane: usize) -> Self::Each;
}

impl<L: Lanes> Packed<L> for L {
    type Each = L::Real;

    #[inline]
    fn each(&self, lane: usize) -> L::Real {
        self.lane(lane)
    }
}

impl<L: Lanes, P: Packed<L>, const K: usize> Packed<L> for [P; K] {
    type Each = [P::Each; K];

    #[inline]
    fn each(&self, lane: usize) -> Self::Each {
        self.each_ref().map(|part| part.each(lane))
    }
}
