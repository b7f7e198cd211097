//! Energy and angular momentum of a state, to more than the precision of its numbers.
//!
//! ```text
//! α = 2/r − v²/μ = 1/a,   h = r × v
//! ```
//!
//! An error of α grows with time: after n revolutions a relative error ε is one of 3π n ε in the anomaly. Far out h is
//! a small difference of large products, and says how the centre will be passed. So these two are computed more
//! accurately than the state is given, and results are adjusted to them.
//!
//! # Source
//! Dekker, *A floating-point technique for extending the available precision*, Numerische Mathematik 18, 1971.

use mbs_runtime::Scalar;

use super::vector::{StateVector, Vector, cross, dot, minus, norm, plus, scaled};

/// A number as the sum of a double and a much smaller one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double {
    pub(super) high: f64,
    pub(super) low: f64,
}

/// `a + b`, exactly.
#[inline]
fn sum(a: f64, b: f64) -> Double {
    let high = a + b;
    let part = high - a;
    Double { high, low: (a - (high - part)) + (b - part) }
}

/// `a b`, exactly, while nothing overflows or underflows.
#[inline]
pub(super) fn product(a: f64, b: f64) -> Double {
    #[inline]
    fn halves(a: f64) -> (f64, f64) {
        let c = 134_217_729.0 * a; // 2²⁷ + 1
        let high = c - (c - a);
        (high, a - high)
    }
    let high = a * b;
    let ((a1, a2), (b1, b2)) = (halves(a), halves(b));
    Double { high, low: ((a1 * b1 - high) + a1 * b2 + a2 * b1) + a2 * b2 }
}

/// `|x|²`
#[inline]
fn square(x: &Vector) -> Double {
    let [a, b, c] = [product(x[0], x[0]), product(x[1], x[1]), product(x[2], x[2])];
    let first = sum(a.high, b.high);
    let all = sum(first.high, c.high);
    sum(all.high, all.low + first.low + (a.low + b.low + c.low))
}

/// `α = 2/r − v²/μ`
#[inline]
pub(super) fn reciprocal_axis(mu: f64, state: &StateVector) -> Double {
    let (position, velocity) = (square(&state.position), square(&state.velocity));
    // One step of Newton's method each, for the root and the quotients.
    let r = Scalar::sqrt(position.high);
    let back = product(r, r);
    let r_low = ((position.high - back.high) - back.low + position.low) / (2.0 * r);
    let twice = 2.0 / r;
    let back = product(twice, r);
    let twice_low = ((2.0 - back.high) - back.low - twice * r_low) / r;
    let kinetic = velocity.high / mu;
    let back = product(kinetic, mu);
    let kinetic_low = ((velocity.high - back.high) - back.low + velocity.low) / mu;
    let difference = sum(twice, -kinetic);
    sum(difference.high, difference.low + (twice_low - kinetic_low))
}

/// `a b − c d`, to the last place but one whatever cancels.
#[inline]
fn difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (first, second) = (product(a, b), product(c, d));
    let high = sum(first.high, -second.high);
    high.high + (high.low + (first.low - second.low))
}

/// `h = r × v`
#[inline]
pub(super) fn angular_momentum(state: &StateVector) -> Vector {
    let ([x, y, z], [u, v, w]) = (state.position, state.velocity);
    [difference(y, w, z, v), difference(z, u, x, w), difference(x, v, y, u)]
}

/// A state near a computed one that has the energy α and, within the plane through its position, the angular momentum
/// h, up to the rounding of its own numbers.
///
/// The velocity is changed across the position by `Δh × r/r²`; then position and velocity are stretched by factors `1 +
/// ε` of which the sum of squares is least.
#[inline]
pub(super) fn with_integrals(mu: f64, state: &StateVector, alpha: Double, momentum: &Vector) -> StateVector {
    let distance = norm(&state.position);
    let missing = minus(momentum, &angular_momentum(state));
    let across = cross(&missing, &scaled(1.0 / (distance * distance), &state.position));
    let state = StateVector { velocity: plus(&state.velocity, &across), ..*state };
    let found = reciprocal_axis(mu, &state);
    let excess = (found.high - alpha.high) + (found.low - alpha.low);
    // δα = −(2/r) ε_r − (2 v²/μ) ε_v
    let (potential, kinetic) = (2.0 / distance, 2.0 * dot(&state.velocity, &state.velocity) / mu);
    let part = excess / (potential * potential + kinetic * kinetic);
    let stretched = |x: &Vector, epsilon: f64| plus(x, &scaled(epsilon, x));
    StateVector::new(stretched(&state.position, part * potential), stretched(&state.velocity, part * kinetic))
}
