//! Joints that follow polynomials, one after the other.

use super::polynomial::{COEFFICIENTS, Polynomial};
use super::{ACCELERATION, JointState, Motion, POSITION, RateLimits, VELOCITY};
use crate::limits::LIMIT_TOLERANCE;
use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};

/// `P` polynomials of degree five at most for each of `N` joints, one after the other in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piecewise<const N: usize, const P: usize> {
    /// When each piece ends \[s\]: increasing, the last one is the duration. A piece without length is never evaluated.
    ends: [f64; P],
    /// Angles over the part of a piece's time that is over, which goes from 0 to 1.
    pieces: [[Polynomial; N]; P],
}

/// The largest or smallest value of something, and when it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremum {
    /// The value, in the unit of what it is of.
    pub value: f64,
    /// The first time it is reached \[s\].
    pub time: f64,
}

/// Both ends of the range that something goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrema {
    /// The smallest value.
    pub lowest: Extremum,
    /// The largest value.
    pub highest: Extremum,
}

impl Extrema {
    /// The one that is farther from zero.
    #[must_use]
    pub fn farthest(&self) -> Extremum {
        if -self.lowest.value > self.highest.value { self.lowest } else { self.highest }
    }

    fn include(&mut self, value: f64, time: f64) {
        if value < self.lowest.value {
            self.lowest = Extremum { value, time };
        }
        if value > self.highest.value {
            self.highest = Extremum { value, time };
        }
    }
}

impl<const N: usize, const P: usize> Piecewise<N, P> {
    /// Pieces that end at `ends`, with the coefficients of `Σ cₖ sᵏ`, `s` from 0 to 1 within each; refused where an
    /// angle, a velocity or an acceleration overflows.
    pub(super) fn new(ends: [f64; P], coefficients: [[[f64; COEFFICIENTS]; N]; P]) -> Result<Self, Error> {
        const { assert!(P > 0, "a motion has at least one piece") };
        let motion = Self { ends, pieces: coefficients.map(|piece| piece.map(Polynomial)) };
        for piece in (0..P).filter(|&piece| motion.interval(piece).1 > 0.0) {
            let length = motion.interval(piece).1;
            for (joint, Polynomial(c)) in motion.pieces[piece].iter().enumerate() {
                // No value of a derivative is larger than the sum of its coefficients.
                let sum =
                    |factor: fn(f64) -> f64| -> f64 { (0..COEFFICIENTS).map(|k| factor(k as f64) * c[k].abs()).sum() };
                for (quantity, bound) in [
                    (POSITION, sum(|_| 1.0)),
                    (VELOCITY, sum(|k| k) / length),
                    (ACCELERATION, sum(|k| k * (k - 1.0)) / (length * length)),
                ] {
                    check::finite(quantity, bound).map_err(|error| error.of(joint))?;
                }
            }
        }
        Ok(motion)
    }

    /// When each piece ends \[s\]; the last one is the duration.
    #[must_use]
    pub const fn ends(&self) -> &[f64; P] {
        &self.ends
    }

    /// Coefficients of `q_joint = Σ cₖ τᵏ`, where τ \[s\] is the time since the beginning of the piece, the constant
    /// first \[rad/sᵏ\].
    ///
    /// # Panics
    /// If there is no such piece or joint.
    #[must_use]
    pub fn coefficients(&self, piece: usize, joint: usize) -> [f64; 6] {
        let (_, length) = self.interval(piece);
        let mut power = 1.0;
        self.pieces[piece][joint].0.map(|c| {
            let coefficient = if c == 0.0 { 0.0 } else { c / power };
            power *= length;
            coefficient
        })
    }

    /// When the piece begins, and how long it lasts.
    fn interval(&self, piece: usize) -> (f64, f64) {
        let start = if piece == 0 { 0.0 } else { self.ends[piece - 1] };
        (start, self.ends[piece] - start)
    }

    /// The smallest and the largest angle of each joint \[rad\], from the zeros of the velocity.
    #[must_use]
    pub fn position_extrema(&self) -> [Extrema; N] {
        self.extrema(0)
    }

    /// The smallest and the largest velocity of each joint \[rad/s\], from the zeros of the acceleration.
    #[must_use]
    pub fn velocity_extrema(&self) -> [Extrema; N] {
        self.extrema(1)
    }

    /// The smallest and the largest acceleration of each joint \[rad/s²\]; where it jumps, both sides count.
    #[must_use]
    pub fn acceleration_extrema(&self) -> [Extrema; N] {
        self.extrema(2)
    }

    /// Of the derivative of this order.
    fn extrema(&self, order: usize) -> [Extrema; N] {
        core::array::from_fn(|joint| {
            let none = Extremum { value: f64::NAN, time: 0.0 };
            let mut extrema = Extrema {
                lowest: Extremum { value: f64::INFINITY, ..none },
                highest: Extremum { value: f64::NEG_INFINITY, ..none },
            };
            for piece in (0..P).filter(|&piece| self.interval(piece).1 > 0.0) {
                let (start, length) = self.interval(piece);
                let (mut curve, mut scale) = (self.pieces[piece][joint], 1.0);
                for _ in 0..order {
                    (curve, scale) = (curve.derivative(), scale / length);
                }
                let (turns, count) = curve.derivative().sign_changes();
                extrema.include(curve.value(0.0) * scale, start);
                turns[..count].iter().for_each(|&s| extrema.include(curve.value(s) * scale, start + s * length));
                extrema.include(curve.value(1.0) * scale, self.ends[piece]);
            }
            extrema
        })
    }

    /// Refuses a motion that leaves the ranges of its joints by more than [`LIMIT_TOLERANCE`]; `ranges` are lowest and
    /// highest angles \[rad\], equal ones for a joint that must not move.
    ///
    /// # Errors
    /// [`Failure::LimitExceeded`] with the first joint that leaves its range, at its farthest;
    /// [`Failure::Invalid`] if a range is empty or NaN.
    pub fn check_ranges(&self, ranges: &[[f64; 2]; N]) -> Result<(), Error> {
        for (index, (Extrema { lowest, highest }, [low, high])) in
            self.position_extrema().into_iter().zip(*ranges).enumerate()
        {
            Must::BeAtLeast(low).check("largest angle of joint", high).map_err(|error| error.of(index))?;
            for (Extremum { value, time }, limit, beyond) in [
                (lowest, low, lowest.value < low - LIMIT_TOLERANCE),
                (highest, high, highest.value > high + LIMIT_TOLERANCE),
            ] {
                if beyond {
                    let (quantity, unit) = (POSITION, "rad");
                    return Err(Failure::LimitExceeded { quantity, unit, index, value, limit }.at_time(time));
                }
            }
        }
        Ok(())
    }

    /// Refuses a motion that is too fast.
    ///
    /// # Errors
    /// [`Failure::LimitExceeded`] with the first joint beyond a limit, speeds first, at its fastest;
    /// [`Failure::Invalid`] if a limit is not positive.
    pub fn check_rates(&self, limits: &RateLimits<N>) -> Result<(), Error> {
        limits.check()?;
        let velocity = (VELOCITY, "rad/s", self.velocity_extrema(), &limits.speed);
        let acceleration = (ACCELERATION, "rad/s²", self.acceleration_extrema(), &limits.acceleration);
        for (quantity, unit, extrema, limits) in [velocity, acceleration] {
            for (index, (extrema, &limit)) in extrema.iter().zip(limits).enumerate() {
                let Extremum { value, time } = extrema.farthest();
                if value.abs() > limit {
                    return Err(Failure::LimitExceeded { quantity, unit, index, value, limit }.at_time(time));
                }
            }
        }
        Ok(())
    }
}

impl<const N: usize, const P: usize> Motion<N> for Piecewise<N, P> {
    fn duration(&self) -> f64 {
        self.ends[P - 1]
    }

    /// At a time between two pieces the later one counts, but at the end of the motion.
    fn at(&self, t: f64) -> Result<JointState<N>, Error> {
        let duration = self.duration();
        check::within("time", t, [0.0, duration])?;
        let last = (0..P).rev().find(|&piece| self.interval(piece).1 > 0.0).unwrap_or(P - 1);
        let piece = self.ends.iter().position(|&end| t < end).unwrap_or(last);
        let (start, length) = self.interval(piece);
        let s = (t - start) / length;
        let [mut q, mut qd, mut qdd] = [[0.0; N]; 3];
        for (joint, curve) in self.pieces[piece].iter().enumerate() {
            let velocity = curve.derivative();
            q[joint] = curve.value(s);
            qd[joint] = velocity.value(s) / length;
            qdd[joint] = velocity.derivative().value(s) / (length * length);
        }
        Ok(JointState { q, qd, qdd })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{quintic, two_piece_quartic};

    #[test]
    fn a_motion_may_start_and_stop_on_a_limit() {
        let [low, high] = [-150.0, 60.0].map(f64::to_radians);
        for (start, stop) in [(low, high), (high, low)] {
            // To the end of the range, and an ulp further, as rounding may have it.
            for (start, stop) in
                [(start, stop), (start.next_down(), stop.next_up()), (start.next_up(), stop.next_down())]
            {
                let quintic = quintic([start], [0.0], [stop], 7.0).expect("a motion");
                assert_eq!(quintic.check_ranges(&[[low, high]]), Ok(()), "{start} to {stop}");
                let quartics = two_piece_quartic([start], [0.0], [stop], 7.0).expect("a motion");
                assert_eq!(quartics.check_ranges(&[[low, high]]), Ok(()), "{start} to {stop}");
            }
        }
        let beyond = quintic([low], [0.0], [high + 2.0 * LIMIT_TOLERANCE], 7.0).expect("a motion");
        let refused = beyond.check_ranges(&[[low, high]]);
        let failure = refused.unwrap_err().failure;
        assert!(matches!(failure, Failure::LimitExceeded { index: 0, limit, .. } if limit == high), "{failure}");
    }

    #[test]
    fn a_joint_that_must_not_move_has_a_range_of_one_angle() {
        let motion = quintic([0.0, 0.7], [0.0; 2], [1.0, 0.7], 2.0).expect("a motion");
        assert_eq!(motion.check_ranges(&[[0.0, 1.0], [0.7, 0.7]]), Ok(()));
        let refused = motion.check_ranges(&[[0.0, 0.0], [0.7, 0.7]]);
        let failure = refused.unwrap_err().failure;
        assert!(matches!(failure, Failure::LimitExceeded { index: 0, limit: 0.0, .. }), "{failure}");
        let refused = motion.check_ranges(&[[0.0, 1.0], [0.7_f64.next_up(), 0.7]]);
        let empty = Must::BeAtLeast(0.7_f64.next_up()).broken_by("largest angle of joint", 0.7).of(1);
        assert_eq!(refused, Err(empty.into()));
    }
}
