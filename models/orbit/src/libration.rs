//! The five places at which a small body rests relative to two primaries on circles, and what happens next to them.
//!
//! # Source
//! V. Szebehely, *Theory of Orbits*, 1967, chapters 4 and 5.

use mbs_models::check::Must;
use mbs_models::{Error, Failure};
use mbs_runtime::Scalar;

use mbs_models::cr3bp::{Cr3bp, Params};

/// The libration points by their customary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// Between the primaries.
    L1,
    /// Beyond the smaller one.
    L2,
    /// Beyond the larger one.
    L3,
    /// Ahead of the smaller one.
    L4,
    /// Behind the smaller one.
    L5,
}

impl Point {
    /// All five, in order.
    pub const ALL: [Self; 5] = [Self::L1, Self::L2, Self::L3, Self::L4, Self::L5];
}

/// L₁ to L₅ as `[x, y]` in the units and axes of [`cr3bp`](mbs_models::cr3bp), to the last digit or two.
///
/// L₁ lies between the primaries, L₂ beyond the smaller one, L₃ beyond the larger one; L₄ and L₅ make triangles of
/// equal sides with them, ahead of the smaller one and behind it. With γ the distance from the primary that is near,
/// the first three are roots of
///
/// ```text
/// L₁:  γ⁵ − (3 − μ) γ⁴ + (3 − 2μ) γ³ − μ γ² + 2μ γ − μ = 0              x = 1 − μ − γ
/// L₂:  γ⁵ + (3 − μ) γ⁴ + (3 − 2μ) γ³ − μ γ² − 2μ γ − μ = 0              x = 1 − μ + γ
/// L₃:  γ⁵ + (2 + μ) γ⁴ + (1 + 2μ) γ³ − (1 − μ)(γ² + 2 γ + 1) = 0        x = −μ − γ
/// ```
///
/// # Errors
/// [`Failure::Invalid`] for a mass ratio that is not in (0, ½].
pub fn points(mu: f64) -> Result<[[f64; 2]; 5], Error> {
    Must::BeMoreThan(0.0).check("part of the smaller primary", mu)?;
    Must::BeAtMost(0.5).check("part of the smaller primary", mu)?;
    let near = 1.0 - mu;
    let gammas = [
        [-mu, 2.0 * mu, -mu, 3.0 - 2.0 * mu, mu - 3.0, 1.0],
        [-mu, -2.0 * mu, -mu, 3.0 - 2.0 * mu, 3.0 - mu, 1.0],
        [-near, -2.0 * near, -near, 1.0 + 2.0 * mu, 2.0 + mu, 1.0],
    ]
    .map(|quintic| root(&quintic));
    let height = 0.5 * Scalar::sqrt(3.0);
    let corner = 0.5 - mu;
    Ok([[near - gammas[0], 0.0], [near + gammas[1], 0.0], [-mu - gammas[2], 0.0], [corner, height], [corner, -height]])
}

/// The root of a polynomial between 0, where it is negative, and 2, where it is positive: Newton's method, kept between
/// bounds. Coefficients from the lowest power on.
fn root(polynomial: &[f64; 6]) -> f64 {
    // L₁'s polynomial is positive at 1 and has no other root below.
    let (mut low, mut high) = (0.0, if polynomial[4] < 0.0 { 1.0 } else { 2.0 });
    let mut x = 0.5 * high;
    // Halving alone gets from 2 to any double in less.
    for _ in 0..2200 {
        let (value, slope) = polynomial.iter().rev().fold((0.0, 0.0), |(p, dp), c| (p * x + c, dp * x + p));
        if value == 0.0 {
            return x;
        }
        *(if value < 0.0 { &mut low } else { &mut high }) = x;
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == x || next == low || next == high {
            return next;
        }
        x = next;
    }
    x
}

/// Small motions about a libration point: in the plane the squares of their four rates, out of it an oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modes {
    /// λ² of the motions in the plane as `[real, imaginary]`; the rates are their four square roots.
    pub plane: [[f64; 2]; 2],
    /// λ² of the motion out of it, negative.
    pub normal: f64,
}

impl Modes {
    /// About a libration point, from the generated linearization of the spatial problem.
    ///
    /// With `δq̈ = A δq + B δq̇`, A symmetric and B the gyroscopic `2 [[0, 1], [−1, 0]]` of the plane,
    /// `λ⁴ + (4 − tr A) λ² + det A = 0`.
    ///
    /// # Errors
    /// [`Failure::Invalid`] for a mass ratio that is not in (0, ½], [`Failure::OutOfRange`] for one so small that
    /// rounding puts the point where the smaller primary is.
    pub fn about(mu: f64, point: Point) -> Result<Self, Error> {
        let [x, y] = points(mu)?[point as usize];
        let linear = Cr3bp::new(Params { mu }).linearize(&[x, y, 0.0], &[0.0; 3]);
        let [[a, b, _], [c, d, _], [_, _, normal]] = linear.q;
        if !linear.q.iter().flatten().all(|x| x.is_finite()) {
            return Err(Failure::OutOfRange.into());
        }
        let half = 0.5 * (a + d + linear.qd[0][1] * linear.qd[1][0]);
        let determinant = a * d - b * c;
        let discriminant = half * half - determinant;
        let plane = if discriminant >= 0.0 {
            let root = Scalar::sqrt(discriminant);
            let far = if half < 0.0 { half - root } else { half + root };
            [[far, 0.0], [determinant / far, 0.0]]
        } else {
            let imaginary = Scalar::sqrt(-discriminant);
            [[half, imaginary], [half, -imaginary]]
        };
        Ok(Self { plane, normal })
    }

    /// Whether small motions stay small to first order: every λ is imaginary. At L₄ and L₅ that is so for
    /// `27 μ (1 − μ) < 1`, up to Routh's mass ratio 0.0385209.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.plane.iter().all(|&[real, imaginary]| real < 0.0 && imaginary == 0.0) && self.normal < 0.0
    }

    /// The rate at which the fastest motion away from the point grows, per unit of time; 0 where none grows.
    #[must_use]
    pub fn growth(&self) -> f64 {
        // Re √(a + i b) = √((|a + i b| + a)/2)
        self.plane.iter().fold(0.0, |most, &[real, imaginary]| {
            let size = Scalar::sqrt(real * real + imaginary * imaginary);
            let growth = Scalar::sqrt(0.5 * (size + real).max(0.0));
            if growth > most { growth } else { most }
        })
    }
}
