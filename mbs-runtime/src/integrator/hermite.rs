//! Between the ends of a step: the cubic Hermite polynomials of `(q, q̇)` and `(q̇, q̈)`.
//!
//! Source: E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, section
//! II.6, formula 6.7.

use super::run::Span;
use crate::scalar::Scalar;
use crate::state::{Coordinates, State};

/// The state at the fraction `theta` of the step, whose ends have the accelerations `qdd`.
pub(super) fn interpolate<V: Coordinates>(span: &Span<'_, V>, qdd: [&V; 2], theta: V::Scalar, state: &mut State<V>) {
    let (old, new, h) = (span.old, span.new, V::Scalar::from_f64(span.end - span.start));
    cubic(&mut state.q, theta, h, [&old.q, &new.q], [&old.qd, &new.qd]);
    cubic(&mut state.qd, theta, h, [&old.qd, &new.qd], qdd);
}

/// `(1 − θ) y₀ + θ y₁ + θ (θ − 1) ((1 − 2θ)(y₁ − y₀) + (θ − 1) h y₀' + θ h y₁')`.
pub(super) fn cubic<V: Coordinates>(out: &mut V, theta: V::Scalar, h: V::Scalar, value: [&V; 2], slope: [&V; 2]) {
    let one = V::Scalar::one();
    let ([y0, y1], [s0, s1]) = (value.map(V::as_slice), slope.map(V::as_slice));
    for (i, out) in out.as_mut_slice().iter_mut().enumerate() {
        let rise = y1[i] - y0[i];
        let bend = (one - theta - theta) * rise + h * ((theta - one) * s0[i] + theta * s1[i]);
        *out = y0[i] + theta * rise + theta * (theta - one) * bend;
    }
}
