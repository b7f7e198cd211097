//! Universal functions, and the time on a conic from an apsis.
//!
//! ```text
//! U_k(s; α) = s^k Σ_n (−α s²)^n / (2n + k)!,   dU_{k+1}/ds = U_k,   U_k + α U_{k+2} = s^k / k!
//! ```
//!
//! With `α = 1/a` and s counted from the nearest point, where r = q, every conic is
//!
//! ```text
//! r = q + e U₂,   r·v/√μ = e U₁,   √μ t = q s + e U₃
//! x = q − U₂,   y = √p U₁     towards the nearest point, and across
//! ```
//!
//! For s > 0 all terms of the first line are positive: nothing cancels, at no eccentricity. Therefore this project
//! counts from an apsis, where most texts count from the state that is given. Counted from the farthest point of an
//! ellipse the same lines hold with its distance for q and −e for e; there, too, small differences of time stay
//! accurate.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, sections 4.5 and 4.6.

use mbs_runtime::Scalar;

/// `U₀ … U₃` at one s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Universal {
    pub(super) u0: f64,
    pub(super) u1: f64,
    pub(super) u2: f64,
    pub(super) u3: f64,
}

/// Up to this |α s²| power series, from there on sines and exponentials: here `E − sin E` has lost one bit.
const SERIES: f64 = 3.0;

/// `1/k!`, `1/(k+2)!`, … enough of them that at [`SERIES`] the next term is below rounding.
const fn reciprocal_factorials<const N: usize>(k: u32) -> [f64; N] {
    let (mut list, mut n, mut factorial) = ([0.0; N], 0, 1.0);
    let mut i = 2;
    while i <= k {
        factorial *= i as f64;
        i += 1;
    }
    while n < N {
        list[n] = 1.0 / factorial;
        factorial *= ((k + 2 * n as u32 + 1) * (k + 2 * n as u32 + 2)) as f64;
        n += 1;
    }
    list
}

const C2: [f64; 11] = reciprocal_factorials(2);
const C3: [f64; 11] = reciprocal_factorials(3);
const C4: [f64; 11] = reciprocal_factorials(4);
const C5: [f64; 11] = reciprocal_factorials(5);

/// `Σ c_n (−z)^n`, Horner's scheme in z² for even and odd terms side by side.
#[inline]
fn series(c: &[f64; 11], z: f64) -> f64 {
    let w = z * z;
    let even = c[0] + w * (c[2] + w * (c[4] + w * (c[6] + w * (c[8] + w * c[10]))));
    let odd = c[1] + w * (c[3] + w * (c[5] + w * (c[7] + w * c[9])));
    even - z * odd
}

impl Universal {
    /// At s; beyond one revolution, too.
    #[inline]
    pub(super) fn at(s: f64, alpha: f64) -> Self {
        let z = alpha * s * s;
        if z.abs() < SERIES {
            let (c2, c3) = (series(&C2, z), series(&C3, z));
            Self { u0: 1.0 - z * c2, u1: s * (1.0 - z * c3), u2: s * s * c2, u3: s * s * c3 * s }
        } else if alpha > 0.0 {
            let w = Scalar::sqrt(alpha);
            let (half_sin, half_cos) = Scalar::sin_cos(0.5 * w * s);
            let u1 = 2.0 * half_sin * half_cos / w;
            let u2 = 2.0 * half_sin * half_sin / alpha;
            Self { u0: 1.0 - alpha * u2, u1, u2, u3: (s - u1) / alpha }
        } else {
            let w = Scalar::sqrt(-alpha);
            let growing = Scalar::exp(w * s.abs());
            let (u0, sinh) = (0.5 * (growing + 1.0 / growing), 0.5 * (growing - 1.0 / growing));
            let u1 = sinh.copysign(s) / w;
            Self { u0, u1, u2: (1.0 - u0) / alpha, u3: (s - u1) / alpha }
        }
    }

    /// `3 U₅ − s U₄`, which the derivatives of the time by the energy are made of.
    ///
    /// `u2` and `u3` are those of s, which may be many revolutions.
    #[inline]
    pub(super) fn secular(s: f64, alpha: f64, u2: f64, u3: f64) -> f64 {
        let z = alpha * s * s;
        if z.abs() < SERIES {
            let square = s * s;
            square * square * s * (3.0 * series(&C5, z) - series(&C4, z))
        } else {
            (s * u2 - 3.0 * u3) / alpha
        }
    }
}

/// Inverse hyperbolic sine, accurate relative to its value.
#[inline]
pub(super) fn asinh(x: f64) -> f64 {
    let a = x.abs();
    // Beyond, 1 is below the rounding of a², which may overflow.
    let y = if a > 1e8 { Scalar::ln(a) + core::f64::consts::LN_2 } else { Scalar::ln(a + Scalar::sqrt(a * a + 1.0)) };
    // ln(1 + …) has lost digits that one step of Newton's method brings back.
    let y = if a < 2.0 { y - (Scalar::sinh(y) - a) / Scalar::sqrt(a * a + 1.0) } else { y };
    y.copysign(x)
}

/// A conic as it is seen from an apsis; `1 − α q = e` and `p = q (1 + e)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// `1/a`: positive for ellipses, 0 for parabolas, negative for hyperbolas.
    pub(super) alpha: f64,
    /// Distance of the apsis.
    pub(super) q: f64,
    /// Eccentricity, negative from the farthest point.
    pub(super) e: f64,
}

/// Where on a conic a time is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) s: f64,
    pub(super) universal: Universal,
    pub(super) iterations: u32,
}

/// Search that does not end is a mistake of ours: bisection alone halves the error every time.
const LIMIT: u32 = 64;

/// A step of this part of s leaves an error of its fourth power.
const CLOSE: f64 = 1e-5;

impl Shape {
    /// The ellipse as seen from its other apsis.
    #[inline]
    pub(super) fn seen_from_the_other_apsis(&self) -> Self {
        Self { q: (1.0 + self.e) / self.alpha, e: -self.e, ..*self }
    }

    /// Where on it is a point at the distance r with `r·v/√μ = σ`; on an ellipse the apsis is the nearer one.
    #[inline]
    pub(super) fn of_state(&self, r: f64, sigma: f64) -> (f64, Universal) {
        let Self { alpha, q, e } = *self;
        if alpha > 0.0 {
            let w = Scalar::sqrt(alpha);
            let sign = if e < 0.0 { -1.0 } else { 1.0 };
            let s = Scalar::atan2(sign * w * sigma, sign * (1.0 - alpha * r)) / w;
            return (s, Universal::at(s, alpha));
        }
        if alpha == 0.0 {
            return (sigma, Universal::at(sigma, alpha));
        }
        let w = Scalar::sqrt(-alpha);
        let s = asinh(w * sigma / e) / w;
        if -alpha * s * s < SERIES {
            return (s, Universal::at(s, alpha));
        }
        // Far out the state itself says more about the functions than the logarithm in s.
        let u1 = sigma / e;
        (s, Universal { u0: (1.0 - alpha * r) / e, u1, u2: (r - q) / e, u3: (s - u1) / alpha })
    }

    /// `√μ t` at s.
    #[inline]
    pub(super) fn time(&self, s: f64, universal: &Universal) -> f64 {
        self.q * s + self.e * universal.u3
    }

    /// The s at which `√μ t = time`, for an ellipse within half a revolution, from its farthest point within a quarter.
    ///
    /// `q s + e U₃(s)` grows with s, and its derivatives are r, e U₁ and e U₀; each iteration takes all three, which
    /// gives fourth order (Danby, *Fundamentals of Celestial Mechanics*, 1988, section 6.6), between bounds that
    /// bisection halves if need be. The search ends with a short step of fourth order, never with one of bisection, and
    /// with one of Newton's method.
    #[inline]
    pub(super) fn place(&self, time: f64) -> Place {
        let target = time.abs();
        let (mut low, mut high) =
            (0.0, if self.alpha > 0.0 { core::f64::consts::PI / Scalar::sqrt(self.alpha) } else { f64::INFINITY });
        let mut s = self.start(target).min(high);
        let mut iterations = 0;
        let mut universal = Universal::at(s, self.alpha);
        while target > 0.0 && iterations < LIMIT {
            iterations += 1;
            let f = self.time(s, &universal) - target;
            if f == 0.0 {
                break;
            }
            if f < 0.0 {
                low = s
            } else {
                high = s
            }
            let (next, converged) = self.next(s, f, &universal, low, high);
            // Where the bounds are neighbours there is nothing between them.
            let done = converged || next == s;
            s = next;
            universal = Universal::at(s, self.alpha);
            if done {
                break;
            }
        }
        let left = (target - self.time(s, &universal)) / (self.q + self.e * universal.u2);
        // Where nothing is finite there is no place, and none is made up.
        let left = if left.abs() <= CLOSE * s + f64::MIN_POSITIVE { left } else { f64::NAN };
        // What s cannot say by rounding, its functions can.
        let Universal { u0, u1, u2, u3 } = universal;
        let (u0, u1, u2, u3) = (u0 - self.alpha * u1 * left, u1 + u0 * left, u2 + u1 * left, u3 + u2 * left);
        let universal = Universal { u0, u1: u1.copysign(time), u2, u3: u3.copysign(time) };
        Place { s: (s + left).copysign(time), universal, iterations }
    }

    /// A better s than one at which the time is too large by f, and whether it is as good as the numbers are.
    #[inline]
    fn next(&self, s: f64, f: f64, universal: &Universal, low: f64, high: f64) -> (f64, bool) {
        let (d1, d2, d3) = (self.q + self.e * universal.u2, self.e * universal.u1, self.e * universal.u0);
        let newton = -f / d1;
        let halley = -f / (d1 + 0.5 * newton * d2);
        let step = -f / (d1 + halley * (0.5 * d2 + halley * d3 / 6.0));
        // Near the solution rounding may put a step beyond the bounds.
        if step.abs() <= CLOSE * s {
            (s + step, true)
        } else if s + step > low && s + step < high {
            (s + step, false)
        } else {
            (if high.is_finite() { low + 0.5 * (high - low) } else { 2.0 * s }, false)
        }
    }

    /// Near the solution: of `q s + e s³/6 = √μ t`, and for hyperbolas where that is far off of `e sinh H = M + H`
    /// besides.
    #[inline]
    fn start(&self, time: f64) -> f64 {
        let s = if self.e < 1e-3 {
            time / self.q
        } else {
            // As s³ + 3 p s = 2 m³, with s and p in units of m and m², which overflow nowhere.
            let m = Scalar::powf(time, 1.0 / 3.0) * Scalar::powf(3.0 / self.e, 1.0 / 3.0);
            let p = 2.0 * self.q / self.e / m / m;
            let a = Scalar::powf(1.0 + Scalar::sqrt(1.0 + p * p * p), 1.0 / 3.0);
            if p < 1e50 { 2.0 * m / (a * a + p + (p / a) * (p / a)) } else { time / self.q }
        };
        let w = Scalar::sqrt(self.alpha.abs());
        if self.alpha < 0.0 && w * s > 1.5 {
            let mean = w * w * w * time;
            let refined = |hyperbolic: f64| asinh((mean + hyperbolic) / self.e);
            refined(refined(w * s)) / w
        } else {
            s
        }
    }
}
