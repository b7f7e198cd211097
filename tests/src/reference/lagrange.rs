//! Lagrange's equations by nested dual numbers over the energies as they are written.
//!
//! A dual number is `a + b ε` with `ε² = 0`; a function of it yields its value and its derivative, exact up to
//! round-off. Duals over duals yield mixed second derivatives, and so on: no formula is ever transformed.
//!
//! # Source
//!
//! Clifford, *Preliminary sketch of biquaternions*, 1873 (dual numbers); Griewank, Walther, *Evaluating Derivatives*,
//! SIAM 2008, chapters 3 and 13 (forward mode, higher order). Mechanics: Goldstein, Poole, Safko, *Classical
//! Mechanics*, 3rd edition 2002, (1.57); Murray, Li, Sastry, *A Mathematical Introduction to Robotic Manipulation*,
//! 1994, (4.23) for the Christoffel form.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What an energy is computed with: `f64`, or [`Dual`] over another number.
pub trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A constant: every derivative is zero.
    fn constant(value: f64) -> Self;
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Square root; its derivative is not finite at zero.
    fn sqrt(self) -> Self;
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn sin(self) -> Self {
        Self::sin(self)
    }
    fn cos(self) -> Self {
        Self::cos(self)
    }
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
}

/// `value + derivative · ε`, `ε² = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The value.
    pub value: S,
    /// The derivative along the seeded direction.
    pub derivative: S,
}

impl<S> Dual<S> {
    fn new(value: S, derivative: S) -> Self {
        Self { value, derivative }
    }
}

impl<S: Number> Add for Dual<S> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.derivative + b.derivative)
    }
}

impl<S: Number> Sub for Dual<S> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.derivative - b.derivative)
    }
}

impl<S: Number> Mul for Dual<S> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::new(self.value * b.value, self.derivative * b.value + self.value * b.derivative)
    }
}

impl<S: Number> Mul<f64> for Dual<S> {
    type Output = Self;
    fn mul(self, b: f64) -> Self {
        Self::new(self.value * b, self.derivative * b)
    }
}

impl<S: Number> Div for Dual<S> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let quotient = self.value / b.value;
        Self::new(quotient, (self.derivative - quotient * b.derivative) / b.value)
    }
}

impl<S: Number> Neg for Dual<S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.value, -self.derivative)
    }
}

impl<S: Number> Number for Dual<S> {
    fn constant(value: f64) -> Self {
        Self::new(S::constant(value), S::constant(0.0))
    }
    fn sin(self) -> Self {
        Self::new(self.value.sin(), self.value.cos() * self.derivative)
    }
    fn cos(self) -> Self {
        Self::new(self.value.cos(), -self.value.sin() * self.derivative)
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, self.derivative / (root * 2.0))
    }
}

/// A mechanism by its energies, with `L = T − V`; both depend on time through `q` and `q̇` alone.
pub trait Energies<const N: usize> {
    /// `T(q, q̇)`, quadratic in `q̇`.
    fn kinetic<S: Number>(&self, q: &[S; N], qd: &[S; N]) -> S;
    /// `V(q)`.
    fn potential<S: Number>(&self, q: &[S; N]) -> S;
}

/// A mechanism of point masses by their positions: velocities are another dual derivative.
pub trait Particles<const N: usize> {
    /// Gravity along −z, in m/s².
    fn g(&self) -> f64;
    /// Mass and position of every particle.
    fn particles<S: Number>(&self, q: &[S; N]) -> Vec<(f64, [S; 3])>;
}

impl<const N: usize, P: Particles<N>> Energies<N> for P {
    /// `Σ ½ m |ṙ|²`.
    fn kinetic<S: Number>(&self, q: &[S; N], qd: &[S; N]) -> S {
        let path = along(q, qd);
        self.particles(&path).iter().fold(S::constant(0.0), |energy, (mass, position)| {
            position.iter().fold(energy, |energy, r| energy + r.derivative * r.derivative * (0.5 * mass))
        })
    }

    /// `Σ m g z`.
    fn potential<S: Number>(&self, q: &[S; N]) -> S {
        let weights = self.particles(q).into_iter().map(|(mass, [_, _, z])| z * (mass * self.g()));
        weights.fold(S::constant(0.0), |energy, term| energy + term)
    }
}

/// A uniform rod from one place to another: a sixth of its mass at each end and the rest in the middle have its mass,
/// its centre and its inertia (Simpson's rule is exact for a parabola).
pub fn rod<S: Number>(m: f64, a: [S; 3], b: [S; 3]) -> [(f64, [S; 3]); 3] {
    let at = |part: f64| from_fn(|k| a[k] * (1.0 - part) + b[k] * part);
    [(m / 6.0, at(0.0)), (m * 2.0 / 3.0, at(0.5)), (m / 6.0, at(1.0))]
}

/// `Eᵢ = d/dt ∂L/∂q̇ᵢ − ∂L/∂qᵢ`.
pub fn euler_lagrange<const N: usize>(
    system: &impl Energies<N>,
    q: &[f64; N],
    qd: &[f64; N],
    qdd: &[f64; N],
) -> [f64; N] {
    let lagrangian_slope = |i| {
        let [q, qd] = [along(q, &axis(i)), along(qd, &[0.0; N])];
        (system.kinetic(&q, &qd) - system.potential(&q)).derivative
    };
    // The outer ε is time, the inner one the velocity q̇ᵢ.
    let momentum_rate = |i| {
        let q = along(&along(q, &[0.0; N]), &along(qd, &[0.0; N]));
        let qd = along(&along(qd, &axis(i)), &along(qdd, &[0.0; N]));
        system.kinetic(&q, &qd).derivative.derivative
    };
    from_fn(|i| momentum_rate(i) - lagrangian_slope(i))
}

/// `M = ∂²T/∂q̇²`.
pub fn mass_matrix<const N: usize>(system: &impl Energies<N>, q: &[f64; N]) -> [[f64; N]; N] {
    mass_matrix_over(system, q)
}

/// `[i][j][k]`: `Γᵢⱼₖ = ½(∂Mᵢⱼ/∂qₖ + ∂Mᵢₖ/∂qⱼ − ∂Mⱼₖ/∂qᵢ)`.
pub fn christoffel<const N: usize>(system: &impl Energies<N>, q: &[f64; N]) -> [[[f64; N]; N]; N] {
    // slopes[k][i][j] = ∂Mᵢⱼ/∂qₖ.
    let slopes: [[[f64; N]; N]; N] =
        from_fn(|k| mass_matrix_over(system, &along(q, &axis(k))).map(|row| row.map(|entry| entry.derivative)));
    from_fn(|i| from_fn(|j| from_fn(|k| 0.5 * (slopes[k][i][j] + slopes[j][i][k] - slopes[i][j][k]))))
}

/// `Cᵢⱼ = Γᵢⱼₖ q̇ₖ`.
pub fn coriolis_matrix<const N: usize>(system: &impl Energies<N>, q: &[f64; N], qd: &[f64; N]) -> [[f64; N]; N] {
    christoffel(system, q).map(|symbols| super::product(&symbols, qd))
}

/// `G = ∂V/∂q`.
pub fn gravity<const N: usize>(system: &impl Energies<N>, q: &[f64; N]) -> [f64; N] {
    from_fn(|i| system.potential(&along(q, &axis(i))).derivative)
}

/// Entries of `M` one by one: both seeds in `q̇`, at `q̇ = 0`, which is as good as any since `T` is quadratic.
fn mass_matrix_over<const N: usize, S: Number>(system: &impl Energies<N>, q: &[S; N]) -> [[S; N]; N] {
    let q = q.map(|q| Dual::new(Dual::new(q, S::constant(0.0)), Dual::constant(0.0)));
    let entry = |i, j| {
        let qd = along(&along(&[S::constant(0.0); N], &axis(i)), &axis(j));
        system.kinetic(&q, &qd).derivative.derivative
    };
    from_fn(|i| from_fn(|j| entry(i, j)))
}

fn along<const N: usize, S: Copy>(values: &[S; N], direction: &[S; N]) -> [Dual<S>; N] {
    from_fn(|k| Dual::new(values[k], direction[k]))
}

/// The unit vector along coordinate `i`.
fn axis<const N: usize, S: Number>(i: usize) -> [S; N] {
    from_fn(|k| S::constant(if k == i { 1.0 } else { 0.0 }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::assert_close;
    use crate::reference::tests::ROUND_OFF;

    /// Every operation against its derivative as a table of integrals has it; second derivatives by nesting.
    #[test]
    fn derivatives_of_the_operations() {
        let x: f64 = 0.7;
        let seed = Dual::new(Dual::new(x, 1.0), Dual::new(1.0, 0.0));
        let constant = Dual::constant(3.0);
        let cases = [
            ("sin", seed.sin(), [x.sin(), x.cos(), -x.sin()]),
            ("cos", seed.cos(), [x.cos(), -x.sin(), -x.cos()]),
            ("sqrt", seed.sqrt(), [x.sqrt(), 0.5 / x.sqrt(), -0.25 / (x * x.sqrt())]),
            ("square", seed * seed, [x * x, 2.0 * x, 2.0]),
            ("reciprocal", constant / seed, [3.0 / x, -3.0 / (x * x), 6.0 / (x * x * x)]),
            ("quotient", seed.sin() / seed.cos(), [x.tan(), 1.0 / x.cos().powi(2), 2.0 * x.tan() / x.cos().powi(2)]),
            ("scale", seed * seed * -2.0, [-2.0 * x * x, -4.0 * x, -4.0]),
            ("difference", constant - seed * seed, [3.0 - x * x, -2.0 * x, -2.0]),
            ("negation", -(seed * seed), [-x * x, -2.0 * x, -2.0]),
        ];
        for (what, got, want) in cases {
            // Mixed parts are symmetric: both first derivatives are the same.
            let got = [got.value.value, got.value.derivative, got.derivative.value, got.derivative.derivative];
            assert_close(what, &got, &[want[0], want[1], want[1], want[2]], ROUND_OFF);
        }
    }

    /// A planet in polar coordinates: `L = ½ m (ṙ² + r² θ̇²) + k/r`.
    struct Planet {
        mass: f64,
        k: f64,
    }

    impl Energies<2> for Planet {
        fn kinetic<S: Number>(&self, &[r, _]: &[S; 2], &[rd, thetad]: &[S; 2]) -> S {
            (rd * rd + r * r * thetad * thetad) * (0.5 * self.mass)
        }
        fn potential<S: Number>(&self, &[r, _]: &[S; 2]) -> S {
            S::constant(-self.k) / (r * r).sqrt()
        }
    }

    /// Goldstein 2002, section 3.2: `m r̈ − m r θ̇² + k/r²` and `d/dt (m r² θ̇)`.
    #[test]
    fn kepler_problem_in_polar_coordinates() {
        let planet = Planet { mass: 1.3, k: 2.1 };
        let Planet { mass: m, k } = planet;
        let ([r, theta], [rd, thetad], [rdd, thetadd]) = ([1.7, 0.4], [-0.3, 0.9], [0.6, -1.1]);
        let q = [r, theta];
        let radial = m * rdd - m * r * thetad * thetad + k / (r * r);
        let areal = m * r * r * thetadd + 2.0 * m * r * rd * thetad;
        let got = euler_lagrange(&planet, &q, &[rd, thetad], &[rdd, thetadd]);
        assert_close("Lagrange's equations", &got, &[radial, areal], ROUND_OFF);
        assert_close("M", &mass_matrix(&planet, &q).concat(), &[m, 0.0, 0.0, m * r * r], ROUND_OFF);
        assert_close("G", &gravity(&planet, &q), &[k / (r * r), 0.0], ROUND_OFF);
        // Γ_rθθ = −m r, Γ_θrθ = Γ_θθr = m r, the others zero.
        let coriolis = [0.0, -m * r * thetad, m * r * thetad, m * r * rd];
        assert_close("C", &coriolis_matrix(&planet, &q, &[rd, thetad]).concat(), &coriolis, ROUND_OFF);
    }
}
