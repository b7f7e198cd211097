//! Lambert's problem: the conic from one place to another in a given time.
//!
//! Izzo's variable x and parameter λ, with `κ = 1 − x²`, `y = √(1 − λ² κ)`, `η = y − λ x`, give the time of M
//! revolutions as
//!
//! ```text
//! T = ½ U₃(2 ψ/√κ; κ) + 2 λ η + M π/κ^{3/2},   sin ψ = √κ η,   cos ψ = λ + x η
//! ```
//!
//! which is Battin's hypergeometric series in closed form: one expression for ellipses, parabolas and hyperbolas, with
//! the universal function U₃ that Kepler's equation has. Near x = ±1, where ellipses are long, `w = 1 ± x` is what is
//! searched, so that κ keeps its digits.
//!
//! # Source
//! Izzo, *Revisiting Lambert's problem*, Celestial Mechanics and Dynamical Astronomy 121, 2015; Battin, *An
//! Introduction to the Mathematics and Methods of Astrodynamics*, 1999, chapter 7.

use core::f64::consts::{LN_2, PI};

use mbs_models::check::{self, Must};
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use super::universal::{Universal, asinh};
use super::vector::{Vector, combined, cross, dot, minus, norm, plus, scaled};

/// Which of the two conics with the same revolutions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Branch {
    /// With the smaller major axis: Izzo's left one.
    #[default]
    SmallerAxis,
    /// With the larger major axis: Izzo's right one.
    LargerAxis,
}

/// Which of the conics between two places is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Route {
    /// The motion goes round this direction counter-clockwise: `(r × v)·pole > 0`.
    pub pole: Vector,
    /// Whole revolutions on the way.
    pub revolutions: u32,
    /// Without revolutions there is one conic, and this has no effect.
    pub branch: Branch,
}

impl Route {
    /// Round z counter-clockwise, less than one revolution.
    #[must_use]
    pub fn prograde() -> Self {
        Self { pole: [0.0, 0.0, 1.0], revolutions: 0, branch: Branch::SmallerAxis }
    }

    /// Round z clockwise, less than one revolution.
    #[must_use]
    pub fn retrograde() -> Self {
        Self { pole: [0.0, 0.0, -1.0], ..Self::prograde() }
    }

    /// The problem with motion round another direction.
    #[must_use]
    pub fn about(self, pole: Vector) -> Self {
        Self { pole, ..self }
    }

    /// The problem with whole revolutions before the arrival.
    #[must_use]
    pub fn with_revolutions(self, revolutions: u32, branch: Branch) -> Self {
        Self { revolutions, branch, ..self }
    }
}

/// A conic between two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConicArc {
    /// Velocity at the beginning \[m/s\].
    pub departure: Vector,
    /// Velocity at the end \[m/s\].
    pub arrival: Vector,
    /// How often the time was evaluated to find it.
    pub iterations: u32,
}

/// Of two places and the way round.
struct Geometry {
    r1: f64,
    r2: f64,
    /// Length of the chord, and half of the triangle's circumference.
    chord: f64,
    s: f64,
    lambda: f64,
    /// `1 − λ²`, without cancellation.
    rest: f64,
    /// `1 − ρ` and `1 + ρ` with `ρ = (r1 − r2)/c`, and `√(1 − ρ²)`, without cancellation.
    falling: f64,
    rising: f64,
    sigma: f64,
    /// Radial and transverse unit vectors at both places.
    radial: [Vector; 2],
    across: [Vector; 2],
}

/// Sines of angles up to this are rounding.
const COLLINEAR: f64 = 8.0 * f64::EPSILON;

impl Geometry {
    fn new(from: &Vector, to: &Vector, pole: &Vector) -> Result<Self, Error> {
        check::finite("from", *from)?;
        check::finite("to", *to)?;
        check::finite("pole", *pole)?;
        let (r1, r2) = (norm(from), norm(to));
        if !(r1.is_finite() && r2.is_finite()) {
            return Err(Failure::OutOfRange.into());
        }
        check::positive("distance from the centre", [r1, r2])?;
        let radial = [scaled(1.0 / r1, from), scaled(1.0 / r2, to)];
        let separation = minus(from, to);
        let chord = norm(&separation);
        let sum = norm(&plus(&radial[0], &radial[1]));
        // The separation of near places is exact, that of their directions is rounding.
        let (mut normal, sine, difference) = if chord < 0.5 * r1.min(r2) {
            let normal = cross(&radial[0], &scaled(-1.0 / r2, &separation));
            let sine = norm(&normal);
            (normal, sine, 2.0 * sine / sum)
        } else {
            let normal = cross(&radial[0], &radial[1]);
            (normal, norm(&normal), norm(&minus(&radial[0], &radial[1])))
        };
        if sine <= COLLINEAR {
            return Err(Failure::Undetermined("the plane through places in line with the centre").into());
        }
        normal = scaled(1.0 / sine, &normal);
        let sense = dot(&normal, pole);
        if sense.abs() <= COLLINEAR * norm(pole) {
            return Err(Failure::Undetermined("the way round a pole in the plane of the motion").into());
        }
        if sense < 0.0 {
            normal = scaled(-1.0, &normal);
        }
        let s = 0.5 * (r1 + r2 + chord);
        // Half the sum and difference of the unit vectors are cosine and sine of half the angle.
        let root = Scalar::sqrt(r1 / s) * Scalar::sqrt(r2 / s);
        let sigma = difference * root * s / chord;
        let rho = dot(&separation, &plus(from, to)) / (r1 + r2) / chord;
        let (larger, smaller) = (1.0 + rho.abs(), sigma * sigma / (1.0 + rho.abs()));
        let (falling, rising) = if rho < 0.0 { (larger, smaller) } else { (smaller, larger) };
        Ok(Self {
            r1,
            r2,
            chord,
            s,
            lambda: (0.5 * sum * root).copysign(sense),
            rest: chord / s,
            falling,
            rising,
            sigma,
            radial,
            across: [cross(&normal, &radial[0]), cross(&normal, &radial[1])],
        })
    }
}

/// The time of flight in units of `√(s³/2μ)`, and what it is made of.
#[derive(Clone, Copy)]
struct Flight {
    lambda: f64,
    rest: f64,
    revolutions: f64,
    /// x is `side (w − 1)`.
    side: f64,
}

/// A trial of w.
#[derive(Clone, Copy)]
struct Trial {
    x: f64,
    kappa: f64,
    y: f64,
    eta: f64,
    time: f64,
}

impl Flight {
    fn at(&self, w: f64) -> Trial {
        let Self { lambda, rest, revolutions, side } = *self;
        let (x, kappa) = (side * (w - 1.0), w * (2.0 - w));
        let y = Scalar::sqrt(1.0 - lambda * lambda * kappa);
        // y² − λ² x² = 1 − λ²
        let eta = if lambda * x > 0.0 { rest / (y + lambda * x) } else { y - lambda * x };
        let time = if lambda < 0.0 && x > 1.5 {
            // Lancaster's form: here the other cancels.
            let root = Scalar::sqrt(-kappa);
            (x - lambda * y - asinh(root * eta) / root) / -kappa
        } else {
            let s = if kappa > 0.0 {
                let root = Scalar::sqrt(kappa);
                2.0 * Scalar::atan2(root * eta, lambda + x * eta) / root
            } else if kappa < 0.0 {
                let root = Scalar::sqrt(-kappa);
                2.0 * asinh(root * eta) / root
            } else {
                2.0 * eta
            };
            let whole = if revolutions > 0.0 { revolutions * PI / (kappa * Scalar::sqrt(kappa)) } else { 0.0 };
            0.5 * Universal::at(s, kappa).u3 + 2.0 * lambda * eta + whole
        };
        Trial { x, kappa, y, eta, time }
    }

    /// Derivatives of the time by x: Izzo's equation (22).
    fn derivatives(&self, trial: &Trial) -> [f64; 3] {
        let (lambda, Trial { x, kappa, y, time, .. }) = (self.lambda, *trial);
        let cube = lambda * lambda * lambda;
        if kappa.abs() < 1e-7 && self.revolutions == 0.0 {
            // Its limit at the parabola; the quotients below are no longer good.
            return [-0.4 * (1.0 - cube * lambda * lambda), 0.0, 0.0];
        }
        let first = (3.0 * time * x - 2.0 + 2.0 * cube * x / y) / kappa;
        let second = (3.0 * time + 5.0 * x * first + 2.0 * self.rest * cube / (y * y * y)) / kappa;
        let fifth = cube * lambda * lambda / (y * y * y * y * y);
        let third = (7.0 * x * second + 8.0 * first - 6.0 * self.rest * fifth * x) / kappa;
        [first, second, third]
    }

    /// One step of Householder's third-order method.
    fn householder(residual: f64, [d1, d2, d3]: [f64; 3]) -> f64 {
        let denominator = d1 * (d1 * d1 - residual * d2) + d3 * residual * residual / 6.0;
        -residual * (d1 * d1 - 0.5 * residual * d2) / denominator
    }

    /// Searches w between 0, where the time is infinite, and a bound up to which it falls, from a start between them.
    fn search(&self, target: f64, start: f64, mut high: f64) -> (f64, u32) {
        // Near the least time two solutions come together, and the order of the method is lower.
        let close = if self.revolutions > 0.0 { 1e-9 } else { CLOSE };
        let mut low = 0.0;
        let mut w = start;
        for iterations in 1..=LIMIT {
            let trial = self.at(w);
            let residual = trial.time - target;
            if residual == 0.0 {
                return (w, iterations);
            }
            if residual > 0.0 {
                low = w
            } else {
                high = w
            }
            // Where the time hardly changes, for the short way between near places, derivatives are rounding: steps
            // alone say nothing.
            let is_near = residual.abs() <= 0.1 * target;
            let mut step = self.side * Self::householder(residual, self.derivatives(&trial));
            if !(w + step > low && w + step < high) {
                let small = is_near && step.abs() <= 4.0 * f64::EPSILON * w;
                step = if small {
                    return (w, iterations);
                } else if high.is_finite() {
                    0.5 * (low + high) - w
                } else {
                    w
                };
            }
            w += step;
            if is_near && step.abs() <= close * w {
                return (w, iterations);
            }
        }
        (w, LIMIT)
    }

    /// The `w = 1 + x` of the least time of these revolutions, where its derivative, which grows, is zero.
    fn least(&self) -> f64 {
        let (mut low, mut high, mut w) = (0.0, 2.0, 1.0);
        for _ in 0..LIMIT {
            let [d1, d2, d3] = self.derivatives(&self.at(w));
            if d1 < 0.0 {
                low = w
            } else {
                high = w
            }
            let mut step = -2.0 * d1 * d2 / (2.0 * d2 * d2 - d1 * d3);
            if !(w + step > low && w + step < high) {
                step = 0.5 * (low + high) - w;
            }
            w += step;
            if step.abs() <= 1e-12 * w {
                break;
            }
        }
        w
    }
}

/// Bisection alone would end within this many steps.
const LIMIT: u32 = 100;

/// A time that differs by more than this part was not found.
const NOT_FOUND: f64 = 1e-6;

/// A step of this part of w leaves an error of its fourth power.
const CLOSE: f64 = 1e-5;

/// The conic from one place to another.
///
/// ```
/// use mbs_orbit::{EARTH_MU, kepler, lambert, vector::StateVector};
///
/// // From over Greenwich to 90° east, both 7000 km from the centre, in half an hour.
/// let (from, to) = ([7e6, 0.0, 0.0], [0.0, 7e6, 0.0]);
/// let arc = lambert::arc(EARTH_MU, &from, &to, 1800.0, &lambert::Route::prograde()).unwrap();
/// let there = kepler::propagate(EARTH_MU, &StateVector::new(from, arc.departure), 1800.0).unwrap().state;
/// assert!((0..3).all(|i| (there.position[i] - to[i]).abs() < 1e-6));
/// ```
///
/// | argument     | meaning                         | unit  |
/// |--------------|---------------------------------|-------|
/// | `mu`         | G times the mass of the centre  | m³/s² |
/// | `from`, `to` | places relative to the centre   | m     |
/// | `time`       | from one to the other           | s     |
/// | `route`      | which of the conics             |       |
///
/// # Errors
/// [`Error`].
pub fn arc(mu: f64, from: &Vector, to: &Vector, time: f64, route: &Route) -> Result<ConicArc, Error> {
    check::positive("μ", mu)?;
    check::positive("time", time)?;
    let geometry = Geometry::new(from, to, &route.pole)?;
    let unit = Scalar::sqrt(geometry.s / (2.0 * mu)) * geometry.s;
    let target = time / unit;
    let revolutions = f64::from(route.revolutions);
    let mut flight = Flight { lambda: geometry.lambda, rest: geometry.rest, revolutions, side: 1.0 };
    let (start, bound) = if route.revolutions == 0 {
        (1.0 + single_revolution_start(&flight, target), f64::INFINITY)
    } else {
        let turning = flight.least();
        let least = flight.at(turning).time;
        if target < least {
            return Err(Must::BeAtLeast(least * unit).broken_by("time of that many revolutions", time).into());
        }
        let bound;
        (flight.side, bound) = match route.branch {
            Branch::SmallerAxis => (1.0, turning),
            Branch::LargerAxis => (-1.0, 2.0 - turning),
        };
        let start = many_revolutions_start(target, revolutions, route.branch);
        (if start < bound { start } else { 0.5 * bound }, bound)
    };
    let (w, iterations) = flight.search(target, start, bound);
    let Trial { x, y, eta, time, .. } = flight.at(w);
    // Gooding's velocities; y + λ x without cancellation, as η.
    let lambda = geometry.lambda;
    let sum = if lambda * x < 0.0 { geometry.rest / (y - lambda * x) } else { y + lambda * x };
    let gamma = Scalar::sqrt(0.5 * mu * geometry.s);
    let Geometry { falling, rising, .. } = geometry;
    let transverse = gamma * geometry.sigma * sum;
    let departure = combined(
        gamma * (lambda * y * falling - x * rising) / geometry.r1,
        &geometry.radial[0],
        transverse / geometry.r1,
        &geometry.across[0],
    );
    let arrival = combined(
        gamma * (x * falling - lambda * y * rising) / geometry.r2,
        &geometry.radial[1],
        transverse / geometry.r2,
        &geometry.across[1],
    );
    let finite = departure.iter().chain(&arrival).all(|x| x.is_finite());
    // A time that no x gives, by the rounding of both.
    let found = (time - target).abs() <= NOT_FOUND * target;
    if finite && found && eta.is_finite() && geometry.chord > 0.0 {
        Ok(ConicArc { departure, arrival, iterations })
    } else {
        Err(Failure::OutOfRange.into())
    }
}

/// After Izzo: three pieces of the time as a function of x, with `T₀ = T(0)` and the parabola's `T₁ = T(1)`, inverted.
///
/// ```text
/// x = (T₀/T)^{2/3} − 1                     T ≥ T₀
/// x = (T/T₀)^{ln 2/ln(T₁/T₀)} − 1          T₁ ≤ T < T₀
/// x = 5 T₁ (T₁ − T)/(2 T (1 − λ⁵)) + 1     T < T₁
/// ```
///
/// The second one meets the others at both of its ends.
fn single_revolution_start(flight: &Flight, target: f64) -> f64 {
    let Flight { lambda, rest, .. } = *flight;
    let root = Scalar::sqrt(rest);
    let straight = Scalar::atan2(root, lambda) + lambda * root;
    let cube = lambda * lambda * lambda;
    let parabola = 2.0 / 3.0 * (1.0 - cube);
    if target >= straight {
        Scalar::powf(straight / target, 2.0 / 3.0) - 1.0
    } else if target < parabola {
        2.5 * parabola * (parabola - target) / (target * (1.0 - cube * lambda * lambda)) + 1.0
    } else {
        Scalar::exp(LN_2 * Scalar::ln(target / straight) / Scalar::ln(parabola / straight)) - 1.0
    }
}

/// After Izzo: the two asymptotes of the time with M revolutions, inverted; as w.
///
/// ```text
/// (1 + x)/(1 − x) = ((M + 1) π/8T)^{2/3}     the smaller axis, w = 1 + x
/// (1 + x)/(1 − x) = (8T/Mπ)^{2/3}            the larger axis, w = 1 − x
/// ```
fn many_revolutions_start(target: f64, revolutions: f64, branch: Branch) -> f64 {
    if branch == Branch::LargerAxis {
        let ratio = Scalar::powf(8.0 * target / (revolutions * PI), 2.0 / 3.0);
        2.0 / (ratio + 1.0)
    } else {
        let ratio = Scalar::powf((revolutions + 1.0) * PI / (8.0 * target), 2.0 / 3.0);
        2.0 * ratio / (ratio + 1.0)
    }
}
