//! Values between samples: tables of section 6 of the manual, from the definitions in the sources.

use super::number::Real;
use super::value::{Moving, Value, number};

/// The numbers of an array.
pub(super) fn column<S: Real>(array: &Value<S>) -> Result<Vec<Moving<S>>, String> {
    match array {
        Value::Array(entries) => entries.iter().map(|entry| entry.number()).collect(),
        _ => Err("a table wants arrays".to_string()),
    }
}

/// The last sample that x is not before, if it is behind any.
fn interval<S: Real>(x: Moving<S>, xs: &[Moving<S>]) -> Option<usize> {
    xs.iter().rposition(|place| !x.less(*place))
}

/// Straight lines, constant outside.
pub(super) fn lines<S: Real>(x: Moving<S>, xs: &[Moving<S>], ys: &[Moving<S>]) -> Moving<S> {
    match interval(x, xs) {
        None => ys[0],
        Some(i) if i + 1 == xs.len() => ys[i],
        Some(i) => ys[i] + (ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]) * (x - xs[i]),
    }
}

/// The cubic with these slopes at both ends of the interval, by Hermite's polynomials; the tangent outside.
fn hermite<S: Real>(x: Moving<S>, xs: &[Moving<S>], ys: &[Moving<S>], slopes: &[Moving<S>]) -> Moving<S> {
    let last = xs.len() - 1;
    let i = match interval(x, xs) {
        None => return ys[0] + slopes[0] * (x - xs[0]),
        Some(i) if i == last => return ys[last] + slopes[last] * (x - xs[last]),
        Some(i) => i,
    };
    let width = xs[i + 1] - xs[i];
    let s = (x - xs[i]) / width;
    let (one, two, three) = (number::<S>(1.0), number::<S>(2.0), number::<S>(3.0));
    let rest = one - s;
    let (from, to) = (rest * rest * (one + two * s), s * s * (three - two * s));
    ys[i] * from + ys[i + 1] * to + width * s * rest * (slopes[i] * rest - slopes[i + 1] * s)
}

fn secants<S: Real>(xs: &[Moving<S>], ys: &[Moving<S>]) -> (Vec<Moving<S>>, Vec<Moving<S>>) {
    let widths: Vec<_> = xs.windows(2).map(|x| x[1] - x[0]).collect();
    let secants = ys.windows(2).zip(&widths).map(|(y, &h)| (y[1] - y[0]) / h).collect();
    (widths, secants)
}

/// Fritsch and Butland's slopes: 0 at a summit, else the harmonic mean of the secants, weighted by the intervals
/// (equation 5 of their paper); at the ends Moler's, of the parabola through three samples, as far as it keeps the
/// samples monotone.
pub(super) fn monotone<S: Real>(x: Moving<S>, xs: &[Moving<S>], ys: &[Moving<S>]) -> Moving<S> {
    let (widths, secants) = secants(xs, ys);
    let (two, three, zero) = (number::<S>(2.0), number::<S>(3.0), number::<S>(0.0));
    let end = |i: usize, j: usize| {
        let (h, k, d, e) = (widths[i], widths[j], secants[i], secants[j]);
        let slope = ((two * h + k) * d - h * e) / (h + k);
        if slope.signum().value() != d.signum().value() {
            zero
        } else if d.signum().value() != e.signum().value() && (three * d.abs()).less(slope.abs()) {
            three * d
        } else {
            slope
        }
    };
    let n = secants.len();
    if n == 1 {
        return hermite(x, xs, ys, &[secants[0], secants[0]]);
    }
    let inner = (1..n).map(|i| {
        let (before, behind) = (secants[i - 1], secants[i]);
        if before.signum().value() * behind.signum().value() <= 0.0 {
            return zero;
        }
        let part = (widths[i - 1] + two * widths[i]) / (three * (widths[i - 1] + widths[i]));
        before * behind / (part * behind + (number::<S>(1.0) - part) * before)
    });
    let slopes: Vec<_> = [end(0, 1)].into_iter().chain(inner).chain([end(n - 1, n - 2)]).collect();
    hermite(x, xs, ys, &slopes)
}

/// The spline without curvature at its ends, from the curvatures at the samples: Gauss' elimination of three diagonals.
pub(super) fn spline<S: Real>(x: Moving<S>, xs: &[Moving<S>], ys: &[Moving<S>]) -> Moving<S> {
    let (widths, secants) = secants(xs, ys);
    let (n, six, two) = (widths.len(), number::<S>(6.0), number::<S>(2.0));
    // h₀ c₀ + 2 (h₀ + h₁) c₁ + h₁ c₂ = 6 (d₁ − d₀)
    let (mut diagonal, mut right) = (Vec::new(), Vec::new());
    for i in 1..n {
        let mut own = two * (widths[i - 1] + widths[i]);
        let mut side = six * (secants[i] - secants[i - 1]);
        if i > 1 {
            let factor = widths[i - 1] / diagonal[i - 2];
            own = own - factor * widths[i - 1];
            side = side - factor * right[i - 2];
        }
        diagonal.push(own);
        right.push(side);
    }
    let mut curvatures = vec![number::<S>(0.0); n + 1];
    for i in (1..n).rev() {
        curvatures[i] = (right[i - 1] - widths[i] * curvatures[i + 1]) / diagonal[i - 1];
    }
    let from = |i: usize| secants[i] - widths[i] * (two * curvatures[i] + curvatures[i + 1]) / six;
    let mut slopes: Vec<_> = (0..n).map(from).collect();
    slopes.push(secants[n - 1] + widths[n - 1] * curvatures[n - 1] / six);
    hermite(x, xs, ys, &slopes)
}
