//! How a state after a time depends on the state before it: the state transition matrix of Kepler's motion.
//!
//! ```text
//! Φ = ∂(r, v)/∂(r₀, v₀) = | R̃  R |     √μ C = 3 U₅ − χ U₄ − √μ Δt U₂
//!                         | Ṽ  V |
//! ```
//!
//! with Lagrange's coefficients, `r = F r₀ + G v₀` and `v = F_t r₀ + G_t v₀`, and
//!
//! ```text
//! R̃ = r/μ (v − v₀)(v − v₀)ᵀ + (r₀ (1 − F) r r₀ᵀ + C v r₀ᵀ)/r₀³ + F 1
//! R = r₀/μ (1 − F) ((r − r₀) v₀ᵀ − (v − v₀) r₀ᵀ) + C/μ v v₀ᵀ + G 1
//! Ṽ = −(v − v₀) r₀ᵀ/r₀² − r (v − v₀)ᵀ/r² + F_t (1 − r rᵀ/r² + (r vᵀ − v rᵀ) r (v − v₀)ᵀ/(μ r)) − μ C r r₀ᵀ/(r³ r₀³)
//! V = r₀/μ (v − v₀)(v − v₀)ᵀ + (r₀ (1 − F) r r₀ᵀ − C r v₀ᵀ)/r³ + G_t 1
//! ```
//!
//! where `r vᵀ` is a product of vectors, and r beside a scalar its length. U are the universal functions of the way χ
//! between both states, `U_k(χ; α) = χ^k Σ_n (−α χ²)^n/(2n + k)!`.
//!
//! # Accuracy
//! On hyperbolas large terms cancel far out: with e = 20, 600 times as far as at the nearest point on both ends of the
//! way and more, five digits.
//!
//! # Source
//! Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999: the blocks in the universal
//! functions.

use core::f64::consts::PI;

use mbs_models::{Error, Failure, check};
use mbs_runtime::Scalar;

use super::kepler::Conic;
use super::universal::Universal;
use super::vector::{StateVector, minus, norm};

/// A state after a time, and its derivatives by the state before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// As [`propagate`](super::kepler::propagate) gives it.
    pub state: StateVector,
    /// `∂(r, v)/∂(r₀, v₀)`: position, then velocity, `matrix[row][column]`.
    pub matrix: [[f64; 6]; 6],
}

/// The state after a time, and the state transition matrix.
///
/// | argument | meaning                        | unit   |
/// |----------|--------------------------------|--------|
/// | `mu`     | G times the mass of the centre | m³/s²  |
/// | `state`  | relative to the centre         | m, m/s |
/// | `time`   | how far to go                  | s      |
///
/// # Errors
/// [`Error`].
pub fn state_transition(mu: f64, state: &StateVector, time: f64) -> Result<Transition, Error> {
    let conic = Conic::through(mu, state)?;
    check::finite("time", time)?;
    let arrival = conic.after(time)?;
    let end = if time == 0.0 { *state } else { arrival.state };
    let (way, rest) = conic.way(&arrival);
    let matrix = Blocks::new(mu, state, &end, time, conic.alpha(), way, rest).matrix();
    if matrix.iter().flatten().all(|x| x.is_finite()) {
        Ok(Transition { state: end, matrix })
    } else {
        Err(Failure::OutOfRange.into())
    }
}

/// What the blocks are made of, in Battin's letters.
struct Blocks {
    mu: f64,
    start: StateVector,
    end: StateVector,
    r0: f64,
    r: f64,
    /// Lagrange's coefficients; `1 − F`, `1 − G_t` and `G` without cancellation.
    one_minus_f: f64,
    g: f64,
    f_dot: f64,
    one_minus_g_dot: f64,
    c: f64,
}

impl Blocks {
    fn new(mu: f64, start: &StateVector, end: &StateVector, time: f64, alpha: f64, way: f64, rest: f64) -> Self {
        let root = Scalar::sqrt(mu);
        let (r0, r) = (norm(&start.position), norm(&end.position));
        // Over more than half a revolution the universal functions are those of the way that is left to a whole one.
        let turn = if alpha > 0.0 { 2.0 * PI / Scalar::sqrt(alpha) } else { f64::INFINITY };
        let short = if rest > 0.5 * turn {
            rest - turn
        } else if rest < -0.5 * turn {
            rest + turn
        } else {
            rest
        };
        let periodic = Universal::at(short, alpha);
        let u3 = if short == way { periodic.u3 } else { periodic.u3 + (way - short) / alpha };
        let c = (Universal::secular(way, alpha, periodic.u2, u3) - root * time * periodic.u2) / root;
        let sigma = super::vector::dot(&start.position, &start.velocity) / root;
        Self {
            mu,
            start: *start,
            end: *end,
            r0,
            r,
            one_minus_f: periodic.u2 / r0,
            g: (r0 * periodic.u1 + sigma * periodic.u2) / root,
            f_dot: -root * periodic.u1 / (r0 * r),
            one_minus_g_dot: periodic.u2 / r,
            c,
        }
    }

    fn matrix(&self) -> [[f64; 6]; 6] {
        let Self { mu, r0, r, c, .. } = *self;
        let (x0, v0) = (&self.start.position, &self.start.velocity);
        let (x, v) = (&self.end.position, &self.end.velocity);
        let (dx, dv) = (minus(x, x0), minus(v, v0));
        let momentum_like = |i: usize, k: usize| x[i] * v[k] - v[i] * x[k];
        let (cube0, cube) = (r0 * r0 * r0, r * r * r);
        let mut matrix = [[0.0; 6]; 6];
        for i in 0..3 {
            // Row of (r vᵀ − v rᵀ) r.
            let turned: f64 = (0..3).map(|k| momentum_like(i, k) * x[k]).sum();
            for j in 0..3 {
                let one = if i == j { 1.0 } else { 0.0 };
                matrix[i][j] = r / mu * dv[i] * dv[j]
                    + (r0 * self.one_minus_f * x[i] * x0[j] + c * v[i] * x0[j]) / cube0
                    + (1.0 - self.one_minus_f) * one;
                matrix[i][j + 3] =
                    r0 / mu * self.one_minus_f * (dx[i] * v0[j] - dv[i] * x0[j]) + c / mu * v[i] * v0[j] + self.g * one;
                matrix[i + 3][j] = -dv[i] * x0[j] / (r0 * r0) - x[i] * dv[j] / (r * r)
                    + self.f_dot * (one - x[i] * x[j] / (r * r) + turned * dv[j] / (mu * r))
                    - mu * c * x[i] * x0[j] / (cube * cube0);
                matrix[i + 3][j + 3] = r0 / mu * dv[i] * dv[j]
                    + (r0 * self.one_minus_f * x[i] * x0[j] - c * x[i] * v0[j]) / cube
                    + (1.0 - self.one_minus_g_dot) * one;
            }
        }
        matrix
    }
}
