//! Points with times: the 4-3-…-3-4 trajectory.

use super::{ACCELERATION, JointState, POSITION, Piecewise, VELOCITY, quintic};
use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};

/// A posture and when it is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot<const N: usize> {
    /// Since the start \[s\].
    pub time: f64,
    /// Joint angles \[rad\].
    pub q: [f64; N],
}

/// From `start` through the knots, at their times, to the last of them with the velocities `final_velocity` and no
/// acceleration.
///
/// Quartics first and last, cubics in between; angles, velocities and accelerations are continuous, and all six
/// conditions at the ends hold. One knot alone is reached by a quintic. The velocities at the inner knots solve a
/// tridiagonal system that is diagonally dominant, from the continuity of the acceleration: with the way `Δ` and the
/// time `h` of a piece, the acceleration of a cubic is `6Δ/h² − (4v₀ + 2v₁)/h` at its start and `−6Δ/h² + (2v₀ +
/// 4v₁)/h` at its end, that of a quartic that starts with `v₀` and `a₀` is `a₀ − 12(Δ − v₀h − a₀h²/2)/h² + 6(v₁ − v₀ −
/// a₀h)/h` at its end.
///
/// # Errors
/// Times that are not increasing, or not finite; a number that is not finite; all knots equal to a start at rest, and
/// no velocity at the end.
///
/// # Source
/// The 4-3-4 trajectory of K. S. Fu, R. C. Gonzalez, C. S. G. Lee, *Robotics: control, sensing, vision, and
/// intelligence*, 1987, section 4.3, for any number of knots.
pub fn through<const N: usize, const P: usize>(
    start: &JointState<N>,
    knots: &[Knot<N>; P],
    final_velocity: [f64; N],
) -> Result<Piecewise<N, P>, Error> {
    check(start, knots, &final_velocity)?;
    let mut length = [0.0; P];
    let mut before = 0.0;
    for (h, knot) in length.iter_mut().zip(knots) {
        (*h, before) = (knot.time - before, knot.time);
    }
    let mut coefficients = [[[0.0; 6]; N]; P];
    for joint in 0..N {
        if P == 1 {
            let stop = JointState { q: knots[0].q, qd: final_velocity, qdd: [0.0; N] };
            coefficients[0][joint] = quintic::coefficients(start, &stop, joint, length[0]);
            continue;
        }
        let boundary = Boundary {
            start: [start.q[joint], start.qd[joint], start.qdd[joint]],
            stop: final_velocity[joint],
            way: core::array::from_fn(|k| {
                knots[k].q[joint] - if k == 0 { start.q[joint] } else { knots[k - 1].q[joint] }
            }),
            length,
        };
        let velocity = boundary.velocities();
        for k in 0..P {
            let from = if k == 0 { start.q[joint] } else { knots[k - 1].q[joint] };
            coefficients[k][joint] = boundary.piece(k, from, &velocity);
        }
    }
    Piecewise::new(knots.map(|knot| knot.time), coefficients)
}

fn check<const N: usize>(start: &JointState<N>, knots: &[Knot<N>], final_velocity: &[f64; N]) -> Result<(), Error> {
    check::finite(POSITION, start.q)?;
    check::finite(VELOCITY, start.qd)?;
    check::finite(ACCELERATION, start.qdd)?;
    check::finite(VELOCITY, *final_velocity)?;
    let mut before = 0.0;
    for (index, knot) in knots.iter().enumerate() {
        check::finite(POSITION, knot.q)?;
        let in_order = Must::BeMoreThan(before).check("time of knot", knot.time);
        in_order.and(check::finite("time of knot", knot.time)).map_err(|error| error.of(index))?;
        before = knot.time;
    }
    let stands = *start == JointState::at_rest(start.q) && *final_velocity == [0.0; N];
    if stands && knots.iter().all(|knot| knot.q == start.q) { Err(Failure::NoMotion.into()) } else { Ok(()) }
}

/// One joint's conditions; `P > 1`.
struct Boundary<const P: usize> {
    /// Angle, velocity and acceleration at the start.
    start: [f64; 3],
    /// Velocity at the stop.
    stop: f64,
    /// The angle that each piece covers \[rad\].
    way: [f64; P],
    /// The duration of each piece \[s\].
    length: [f64; P],
}

impl<const P: usize> Boundary<P> {
    /// Velocities at the end of each piece, by Thomas' elimination.
    fn velocities(&self) -> [f64; P] {
        let [_, v0, a0] = self.start;
        let (mut diagonal, mut right) = ([0.0; P], [0.0; P]);
        for k in 0..P - 1 {
            // The acceleration at the end of piece k, less that at the start of piece k + 1.
            let (h, way) = (self.length[k], self.way[k]);
            let (end, constant) = if k == 0 {
                (6.0 / h, a0 - 12.0 * (way - v0 * h - 0.5 * a0 * h * h) / (h * h) - 6.0 * (v0 + a0 * h) / h)
            } else {
                (4.0 / h, -6.0 * way / (h * h))
            };
            let (h, way) = (self.length[k + 1], self.way[k + 1]);
            let (begin, next) = if k + 2 == P {
                // A quartic that ends with the velocity v and no acceleration, backwards.
                (-6.0 / h, (12.0 * (way - self.stop * h) + 6.0 * self.stop * h) / (h * h))
            } else {
                (-4.0 / h, 6.0 * way / (h * h))
            };
            diagonal[k] = end - begin;
            right[k] = next - constant;
            if k > 0 {
                // Both neighbours of the diagonal are 2/h of the piece between the two knots.
                let factor = 2.0 / self.length[k] / diagonal[k - 1];
                diagonal[k] -= factor * 2.0 / self.length[k];
                right[k] -= factor * right[k - 1];
            }
        }
        let mut velocity = [0.0; P];
        velocity[P - 1] = self.stop;
        for k in (0..P - 1).rev() {
            let beyond = if k + 2 < P { 2.0 / self.length[k + 1] * velocity[k + 1] } else { 0.0 };
            velocity[k] = (right[k] - beyond) / diagonal[k];
        }
        velocity
    }

    /// Coefficients of piece `k`, which starts at the angle `from`.
    fn piece(&self, k: usize, from: f64, velocity: &[f64; P]) -> [f64; 6] {
        let (h, way) = (self.length[k], self.way[k]);
        if k == 0 {
            let (v0, a0) = (self.start[1] * h, self.start[2] * h * h);
            let (d, e) = (way - v0 - 0.5 * a0, velocity[0] * h - v0 - a0);
            return [from, v0, 0.5 * a0, 4.0 * d - e, e - 3.0 * d, 0.0];
        }
        let (v0, v1) = (velocity[k - 1] * h, velocity[k] * h);
        if k + 1 == P {
            // q₁ − v₁ r + c₃ r³ + c₄ r⁴, r = 1 − s.
            let (d, e) = (v1 - way, v1 - v0);
            let mut coefficients = super::quartic::backwards(from + way, 4.0 * d - e, e - 3.0 * d);
            coefficients[0] -= v1;
            coefficients[1] += v1;
            return coefficients;
        }
        [from, v0, 3.0 * way - 2.0 * v0 - v1, v0 + v1 - 2.0 * way, 0.0, 0.0]
    }
}
