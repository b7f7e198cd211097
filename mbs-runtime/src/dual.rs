//! Dual numbers: a value and its derivative along one direction.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::dynamics::{Elimination, Factors, Terms};
use crate::scalar::Scalar;

/// `value + derivative · ε` with `ε² = 0`: a number that carries its derivative along one direction.
///
/// Generated code evaluated in dual numbers gives its own exact derivative, an oracle for the Jacobians it also
/// emits. `Dual<Dual<T>>` carries second derivatives.
///
/// ```
/// use mbs_runtime::{Dual, Scalar};
///
/// let x = Dual::variable(2.0);
/// let y = x * x * x;
/// assert_eq!((y.value, y.derivative), (8.0, 12.0));
/// ```
///
/// Comparisons ([`Scalar::less`] and the others) look at the value alone: each side of a branch is differentiated by
/// itself. `==` compares both parts. `|x|` has the derivative 0 at 0, `√x` an infinite or undefined one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dual<T> {
    /// The number itself.
    pub value: T,
    /// Its derivative.
    pub derivative: T,
}

impl<T: Scalar> Dual<T> {
    /// The number that the derivative is taken by: `x' = 1`.
    #[inline]
    pub fn variable(value: T) -> Self {
        Self { value, derivative: T::one() }
    }

    /// A number that does not depend on it: `c' = 0`.
    #[inline]
    pub fn constant(value: T) -> Self {
        Self { value, derivative: T::zero() }
    }

    /// `f(x)' = slope · x'`, where `slope` is `∂f/∂x` at the value of `self`.
    #[inline]
    fn chain(self, value: T, slope: T) -> Self {
        Self { value, derivative: slope * self.derivative }
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            derivative: self.derivative * other.value + self.value * other.derivative,
        }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - value * other.derivative) / other.value }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    type Mask = T::Mask;

    const ROUNDING: f64 = T::ROUNDING;

    /// That of the value.
    #[inline]
    fn exponent(self) -> i32 {
        self.value.exponent()
    }

    /// From `K x = b` follows `K x′ = b′ − K′ x`, in the basis of the values.
    fn constrained_solve<const N: usize, const K: usize, const C: usize>(
        m: &[[Self; N]; N],
        a: &[[Self; N]; K],
        force: &[[Self; C]; N],
        target: &[[Self; C]; K],
        terms: &Terms<'_, Self, N, K, C>,
    ) -> ([[Self; C]; N], [[Self; C]; K]) {
        let (values, rows) = (m.map(|row| row.map(|x| x.value)), a.map(|row| row.map(|x| x.value)));
        let (f, c) = (force.map(|row| row.map(|x| x.value)), target.map(|row| row.map(|x| x.value)));
        let sizes = terms.sizes.map(|sizes| sizes.map(|row| row.map(|x| x.value)));
        let (motion, scales) = (terms.motion.map(|q| q.map(|x| x.value)), terms.scales.map(|x| x.value));
        let vectors = terms.vectors;
        let terms = Terms { vectors, sizes: sizes.as_ref(), motion: motion.as_ref(), scales };
        let (q, l) = T::constrained_solve(&values, &rows, &f, &c, &terms);
        let (mut f, mut c) = (force.map(|row| row.map(|x| x.derivative)), target.map(|row| row.map(|x| x.derivative)));
        let mut sizes = c;
        for column in 0..C {
            for i in 0..N {
                let inertia = |j: usize| m[i.max(j)][i.min(j)].derivative;
                let rest = (0..N).fold(f[i][column], |rest, j| rest - inertia(j) * q[j][column]);
                f[i][column] = (0..K).fold(rest, |rest, k| rest + a[k][i].derivative * l[k][column]);
            }
            for k in 0..K {
                let mut size = c[k][column].abs();
                for j in 0..N {
                    let term = a[k][j].derivative * q[j][column];
                    c[k][column] = c[k][column] - term;
                    size = size + term.abs();
                }
                sizes[k][column] = size;
            }
        }
        let terms = Terms { vectors, sizes: Some(&sizes), ..Terms::unknown() };
        let (q_rate, l_rate) = T::constrained_solve(&values, &rows, &f, &c, &terms);
        let pair = |value, derivative| Self { value, derivative };
        let motion = |i: usize| core::array::from_fn(|j| pair(q[i][j], q_rate[i][j]));
        let multipliers = |k: usize| core::array::from_fn(|j| pair(l[k][j], l_rate[k][j]));
        (core::array::from_fn(motion), core::array::from_fn(multipliers))
    }

    /// From `K x = b` follows `K x′ = b′ − K′ x`, with the factors of the values.
    fn sparse_solve<const N: usize, const U: usize, const E: usize, const L: usize>(
        elimination: &Elimination<U, E, L>,
        factors: &Factors<Self, U, L>,
        right_side: &[Self; U],
        sizes: &[Self; U],
    ) -> [Self; U] {
        let values = factors.values();
        let (b, terms) = (right_side.map(|b| b.value), sizes.map(|size| size.value));
        let x = T::sparse_solve::<N, U, E, L>(elimination, &values, &b, &terms);
        let (b, terms) = factors.rates(elimination, right_side, &x);
        let rates = T::sparse_solve::<N, U, E, L>(elimination, &values, &b, &terms);
        core::array::from_fn(|i| Self { value: x[i], derivative: rates[i] })
    }

    #[inline]
    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }

    #[inline]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    #[inline]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline(always)]
    fn sin_cos_all<const N: usize>(angles: [Self; N]) -> ([Self; N], [Self; N]) {
        let (sin, cos) = T::sin_cos_all(angles.map(|angle| angle.value));
        let sines = core::array::from_fn(|i| angles[i].chain(sin[i], cos[i]));
        (sines, core::array::from_fn(|i| angles[i].chain(cos[i], -sin[i])))
    }

    #[inline]
    fn tan(self) -> Self {
        let tan = self.value.tan();
        self.chain(tan, T::one() + tan * tan)
    }

    #[inline]
    fn asin(self) -> Self {
        let slope = T::one() / (T::one() - self.value * self.value).sqrt();
        self.chain(self.value.asin(), slope)
    }

    #[inline]
    fn acos(self) -> Self {
        let slope = T::one() / (T::one() - self.value * self.value).sqrt();
        self.chain(self.value.acos(), -slope)
    }

    #[inline]
    fn atan(self) -> Self {
        self.chain(self.value.atan(), T::one() / (T::one() + self.value * self.value))
    }

    /// `(x y' − y x') / (x² + y²)`; where the squares leave the range of numbers, of x and y in units of the larger.
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let y = self;
        let (a, b) = (x.value, y.value);
        let cross = |a: T, b: T| a * y.derivative - b * x.derivative;
        let squared = a * a + b * b;
        // Zero or infinite, or so small that digits are lost.
        let least = squared * T::from_f64(T::ROUNDING);
        let plain = || cross(a, b) / squared;
        let scaled = || {
            let unit = T::select(a.abs().less(b.abs()), || b.abs(), || a.abs());
            let (a, b) = (a / unit, b / unit);
            cross(a, b) / (a * a + b * b) / unit
        };
        Self { value: b.atan2(a), derivative: T::select(least.equal(least + least), scaled, plain) }
    }

    #[inline]
    fn sinh(self) -> Self {
        self.chain(self.value.sinh(), self.value.cosh())
    }

    #[inline]
    fn cosh(self) -> Self {
        self.chain(self.value.cosh(), self.value.sinh())
    }

    #[inline]
    fn tanh(self) -> Self {
        let sech = self.value.sech();
        self.chain(self.value.tanh(), sech * sech)
    }

    #[inline]
    fn sech(self) -> Self {
        let sech = self.value.sech();
        self.chain(sech, -sech * self.value.tanh())
    }

    #[inline]
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.chain(exp, exp)
    }

    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::one() / self.value)
    }

    #[inline]
    fn sqrt(self) -> Self {
        let sqrt = self.value.sqrt();
        self.chain(sqrt, T::one() / (sqrt + sqrt))
    }

    /// `n xⁿ⁻¹ x' + xⁿ ln x · n'`; the first term is left out where `n = 0` or `x' = 0`, so that zero may be raised to
    /// powers that have no slope there, the second where `n' = 0`, so that a constant power of a negative number has
    /// its derivative, and where `xⁿ = 0`, which no positive power of zero changes.
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        let (x, n) = (self.value, exponent.value);
        let power = x.powf(n);
        let slope = || n * x.powf(n - T::one()) * self.derivative;
        let by_base = T::select(n.vanishes() | self.derivative.vanishes(), T::zero, slope);
        let by_both = || by_base + power * x.ln() * exponent.derivative;
        let is_by_base = exponent.derivative.vanishes() | power.vanishes();
        Self { value: power, derivative: T::select(is_by_base, || by_base, by_both) }
    }

    #[inline]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.signum())
    }

    #[inline]
    fn signum(self) -> Self {
        Self::constant(self.value.signum())
    }

    #[inline]
    fn mul_add(self, factor: Self, summand: Self) -> Self {
        Self {
            value: self.value.mul_add(factor.value, summand.value),
            derivative: self.derivative * factor.value + self.value * factor.derivative + summand.derivative,
        }
    }

    #[inline]
    fn is_finite(self) -> bool {
        self.value.is_finite() && self.derivative.is_finite()
    }

    #[inline]
    fn less(self, other: Self) -> Self::Mask {
        self.value.less(other.value)
    }

    #[inline]
    fn less_equal(self, other: Self) -> Self::Mask {
        self.value.less_equal(other.value)
    }

    #[inline]
    fn equal(self, other: Self) -> Self::Mask {
        self.value.equal(other.value)
    }

    #[inline]
    fn vanishes(self) -> Self::Mask {
        self.value.vanishes() & self.derivative.vanishes()
    }

    #[inline]
    fn blend(mask: Self::Mask, then: Self, otherwise: Self) -> Self {
        Self {
            value: T::blend(mask, then.value, otherwise.value),
            derivative: T::blend(mask, then.derivative, otherwise.derivative),
        }
    }
}

#[cfg(all(test, any(feature = "std", feature = "libm")))]
mod tests {
    use super::*;

    type Function = fn(Dual<Dual<f64>>) -> Dual<Dual<f64>>;

    /// First and second derivative against central differences of the derivative one order lower.
    fn check(name: &str, f: Function, x: f64) {
        let at = |x: f64| f(Dual { value: Dual::variable(x), derivative: Dual::constant(1.0) });
        let step = 1e-5;
        let (left, here, right) = (at(x - step), at(x), at(x + step));
        let slope = (right.value.value - left.value.value) / (2.0 * step);
        let curvature = (right.value.derivative - left.value.derivative) / (2.0 * step);
        // A central difference over 1e-5 is good to 1e-10 times the third derivative.
        assert!((here.value.derivative - slope).abs() < 1e-8 * (1.0 + slope.abs()), "{name}: first");
        assert_eq!(here.value.derivative, here.derivative.value, "{name}: the two first derivatives");
        assert!((here.derivative.derivative - curvature).abs() < 1e-8 * (1.0 + curvature.abs()), "{name}: second");
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let functions: [(&str, Function); 24] = [
            ("sin", |x| x.sin()),
            ("cos", |x| x.cos()),
            ("tan", |x| x.tan()),
            ("asin", |x| x.asin()),
            ("acos", |x| x.acos()),
            ("atan", |x| x.atan()),
            ("sinh", |x| x.sinh()),
            ("cosh", |x| x.cosh()),
            ("tanh", |x| x.tanh()),
            ("sech", |x| x.sech()),
            ("exp", |x| x.exp()),
            ("ln", |x| x.ln()),
            ("sqrt", |x| x.sqrt()),
            ("abs", |x| (-x).abs()),
            ("signum", |x| x.signum()),
            ("constant power", |x| x.powf(Scalar::from_f64(2.5))),
            ("constant base", |x| Dual::from_f64(2.5).powf(x)),
            ("power", |x| x.powf(x)),
            ("atan2, above", |x| x.atan2(Scalar::from_f64(-2.0))),
            ("atan2, below", |x| Dual::from_f64(-2.0).atan2(x)),
            ("mul_add", |x| x.mul_add(x.sin(), x.exp())),
            ("quotient", |x| x.sin() / (x + x * x)),
            ("difference", |x| x - x.cos()),
            ("select", |x| Dual::select(x.less(Dual::one()), || x * x * x, || -x)),
        ];
        for (name, f) in functions {
            for x in [0.3, 0.71] {
                check(name, f, x);
            }
        }
    }

    #[test]
    fn the_angle_of_a_point() {
        // On the unit circle the angle grows as fast as the point moves.
        let angle: f64 = 2.5;
        let t = Dual::variable(angle);
        let turned = t.sin().atan2(t.cos());
        assert!((turned.value - angle).abs() < 1e-15 && (turned.derivative - 1.0).abs() < 1e-15);
    }

    /// Along y at 45°, in any units: `x/(x² + y²) = 1/(2x)`.
    #[test]
    fn the_angle_of_a_point_in_any_units() {
        for size in [1e-300, 1e-200, 1e-162, 1e-155, 1e-10, 1.0, 1e150, 1e155, 1e300] {
            let angle = Dual::variable(size).atan2(Dual::constant(size));
            let expected = 0.5 / size;
            assert!((angle.derivative - expected).abs() <= 4e-16 * expected, "{size}: {angle:?}");
            let angle = Dual::constant(0.0).atan2(Dual { value: -size, derivative: 1.0 });
            assert_eq!(angle.derivative, 0.0, "{size}");
        }
        // Twice: −2 x y/(x² + y²)² at 45°.
        let y = Dual { value: Dual::variable(1e-100), derivative: Dual::constant(1.0) };
        let curvature = y.atan2(Dual::constant(Dual::constant(1e-100))).derivative.derivative;
        assert!((curvature / -0.5e200 - 1.0).abs() < 1e-15, "{curvature}");
        let centre = Dual::variable(0.0_f64).atan2(Dual::constant(0.0));
        assert!(centre.derivative.is_nan());
    }

    #[test]
    fn a_constant_power_of_a_negative_number() {
        let y = Dual::variable(-2.0).powf(Dual::constant(3.0));
        assert_eq!((y.value, y.derivative), (-8.0, 12.0));
    }

    /// `x⁰ = 1` everywhere, and a constant is one to any power.
    #[test]
    fn powers_of_zero() {
        for x in [0.0, -3.0, 2.0] {
            assert_eq!(Dual::variable(x).powf(Dual::constant(0.0)), Dual::constant(1.0), "{x}");
        }
        assert_eq!(Dual::constant(0.0).powf(Dual::constant(0.5)), Dual::constant(0.0));
        assert_eq!(Dual::variable(0.0).powf(Dual::constant(0.5)).derivative, f64::INFINITY);
        // No positive power of zero is anything else, whatever the power.
        assert_eq!(Dual::constant(0.0).powf(Dual::variable(0.5)), Dual::constant(0.0));
        assert_eq!(Dual::variable(0.0).powf(Dual::variable(1.0)), Dual::variable(0.0));
        assert_eq!(Dual::variable(0.0).powf(Dual::variable(2.0)), Dual::constant(0.0));
    }

    /// Whether the exponent varies is a matter of each lane.
    #[test]
    #[cfg(feature = "wide")]
    fn powers_in_lanes() {
        use wide::f64x4;
        let base = Dual { value: f64x4::new([-2.0, 2.0, 0.0, 3.0]), derivative: f64x4::splat(1.0) };
        let exponent = Dual { value: f64x4::splat(3.0), derivative: f64x4::new([0.0, 1.0, 0.0, 0.0]) };
        let found = base.powf(exponent);
        for lane in 0..4 {
            let alone =
                |x: Dual<f64x4>| Dual { value: x.value.to_array()[lane], derivative: x.derivative.to_array()[lane] };
            assert_eq!(alone(found), alone(base).powf(alone(exponent)), "{lane}");
        }
        assert_eq!(found.derivative.to_array()[0], 12.0);
    }

    /// `(xⁿ)''` with `n' = 0`, `n'' = 1`, and a logarithm that is there, and one that is not.
    #[test]
    fn exponents_that_begin_to_vary() {
        let exponent = Dual { value: Dual::constant(3.0), derivative: Dual { value: 0.0, derivative: 1.0 } };
        let at = |x: f64| Dual::constant(Dual::constant(x)).powf(exponent).derivative.derivative;
        assert!((at(2.0) - 8.0 * Scalar::ln(2.0_f64)).abs() < 1e-14 && at(-2.0).is_nan());
    }
}
