//! Linear quadratic regulators: the stabilizing solutions of Riccati's equations.

use super::ControlError;
use super::dense::{difference, identity, is_finite, norm, product, scaled, solve, sum, symmetric, transpose};
use super::stability::Time;
use crate::scalar::Scalar;

/// The feedback `u = −K x` that makes a quadratic cost the least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulator<const N: usize, const U: usize> {
    /// K
    pub gain: [[f64; N]; U],
    /// X, symmetric: `xᵀ X x` is the least cost from the state x.
    pub cost: [[f64; N]; N],
}

type Square<const N: usize> = [[f64; N]; N];

/// The regulator of `ẋ = A x + B u` that makes `∫₀^∞ xᵀ Q x + uᵀ R u dt` least.
///
/// ```text
/// Aᵀ X + X A − X B R⁻¹ Bᵀ X + Q = 0,   K = R⁻¹ Bᵀ X
/// ```
///
/// | argument | meaning                                     | shape   |
/// |----------|---------------------------------------------|---------|
/// | `a`, `b` | the system                                  | `N × N`, `N × U` |
/// | `q`      | weight of the state, positive semidefinite  | `N × N` |
/// | `r`      | weight of the input, positive definite      | `U × U` |
///
/// The equation is turned into that of a sampled system by Cayley's transformation, and that one solved by doubling:
/// each iteration looks twice as far ahead. Of several parameters of the transformation the one that leaves the least
/// is taken, with steps of Newton's method as long as they help. States are balanced by powers of two before; then they
/// are scaled so that X has a diagonal of the order of 1, and all is done once more, which makes the result independent
/// of units.
///
/// # Errors
/// [`ControlError`].
///
/// # Source
/// E. K.-W. Chu, H.-Y. Fan and W.-W. Lin, *A structure-preserving doubling algorithm for continuous-time algebraic
/// Riccati equations*, Linear Algebra and its Applications 396, 2005, algorithm 1 (its equations 9 to 11 the
/// transformation); the steps of Newton's method: D. L. Kleinman, *On an iterative technique for Riccati equation
/// computations*, IEEE Transactions on Automatic Control 13:1, 1968.
pub fn lqr<const N: usize, const U: usize>(
    a: &Square<N>,
    b: &[[f64; U]; N],
    q: &Square<N>,
    r: &Square<U>,
) -> Result<Regulator<N, U>, ControlError> {
    let back = check(a, b, q, r)?;
    let g = symmetric(&product(b, &back));
    let cost = scaled_twice(&Equation { a: *a, g, h: symmetric(q) }, |equation, _| continuous(equation))?;
    let gain = product(&back, &cost);
    finished(Time::Continuous, a, b, q, Regulator { gain, cost })
}

/// The regulator of `x' = A x + B u` that makes `Σ₀^∞ xᵀ Q x + uᵀ R u` least.
///
/// ```text
/// X = Aᵀ X A − Aᵀ X B (R + Bᵀ X B)⁻¹ Bᵀ X A + Q,   K = (R + Bᵀ X B)⁻¹ Bᵀ X A
/// ```
///
/// Arguments as for [`lqr`]; `a` and `b` are those of the sampled system. A need not be regular.
///
/// # Errors
/// [`ControlError`].
///
/// # Source
/// E. K.-W. Chu, H.-Y. Fan, W.-W. Lin and C.-S. Wang, *Structure-preserving algorithms for periodic discrete-time
/// algebraic Riccati equations*, International Journal of Control 77:8, 2004, algorithm 2.1 with one period; then
/// Newton's method: G. A. Hewer, *An iterative technique for the computation of the steady state gains for the discrete
/// optimal regulator*, IEEE Transactions on Automatic Control 16:4, 1971.
pub fn discrete_lqr<const N: usize, const U: usize>(
    a: &Square<N>,
    b: &[[f64; U]; N],
    q: &Square<N>,
    r: &Square<U>,
) -> Result<Regulator<N, U>, ControlError> {
    let back = check(a, b, q, r)?;
    let g = symmetric(&product(b, &back));
    let cost = scaled_twice(&Equation { a: *a, g, h: symmetric(q) }, |equation, unit| {
        discrete(equation, &core::array::from_fn(|i| b[i].map(|entry| entry / unit[i])), r)
    })?;
    let gain = sampled_gain(a, b, r, &cost).ok_or(ControlError::NotStabilizable)?;
    finished(Time::Sampled, a, b, q, Regulator { gain, cost })
}

/// A regulator, if its loop is stable.
fn finished<const N: usize, const U: usize>(
    time: Time,
    a: &Square<N>,
    b: &[[f64; U]; N],
    q: &Square<N>,
    regulator: Regulator<N, U>,
) -> Result<Regulator<N, U>, ControlError> {
    let gain = &regulator.gain;
    let is_stable = is_finite(gain) && time.is_stabilized(&difference(a, &product(b, gain)), a, b, q)?;
    if is_stable { Ok(regulator) } else { Err(ControlError::NotStabilizable) }
}

/// `R⁻¹ Bᵀ`, of matrices that make sense.
fn check<const N: usize, const U: usize>(
    a: &Square<N>,
    b: &[[f64; U]; N],
    q: &Square<N>,
    r: &Square<U>,
) -> Result<[[f64; N]; U], ControlError> {
    for (matrix, finite) in [('A', is_finite(a)), ('B', is_finite(b)), ('Q', is_finite(q)), ('R', is_finite(r))] {
        if !finite {
            return Err(ControlError::NotFinite { matrix });
        }
    }
    check_weight('Q', q, false)?;
    check_weight('R', r, true)?;
    solve(*r, transpose(b)).ok_or(ControlError::NotFinite { matrix: 'R' })
}

/// Symmetric, and positive definite, or semidefinite at least: by the pivots of elimination, the largest first.
fn check_weight<const N: usize>(matrix: char, w: &Square<N>, definite: bool) -> Result<(), ControlError> {
    for row in 0..N {
        for column in 0..row {
            let (x, y) = (w[row][column], w[column][row]);
            if (x - y).abs() > 1e-12 * x.abs().max(y.abs()) {
                return Err(ControlError::NotSymmetric { matrix, row, column });
            }
        }
    }
    // In units of the diagonal, so that what rounding leaves of a difference of equal numbers is known.
    let diagonal: [f64; N] = core::array::from_fn(|i| w[i][i].abs());
    let unit = diagonal.map(|entry| if entry > 0.0 { Scalar::sqrt(entry) } else { 1.0 });
    let mut w: Square<N> = core::array::from_fn(|i| core::array::from_fn(|j| w[i][j] / unit[i] / unit[j]));
    let mut left = [true; N];
    for _ in 0..N {
        let larger = |best: usize, i: usize| if w[i][i] > w[best][best] { i } else { best };
        let Some(k) = (0..N).filter(|&i| left[i]).reduce(larger) else { break };
        let least = (0..N).filter(|&i| left[i]).reduce(|best, i| if w[i][i] < w[best][best] { i } else { best });
        let vanishes =
            w.iter().enumerate().all(|(i, row)| !left[i] || (0..N).all(|j| !left[j] || row[j].abs() <= ROUNDING));
        if !definite && vanishes {
            break;
        }
        if w[k][k] <= ROUNDING {
            let index = least.unwrap_or(k);
            return Err(ControlError::NotPositive {
                matrix,
                pivot: w[index][index] * unit[index] * unit[index],
                index,
            });
        }
        left[k] = false;
        let row = w[k];
        for i in (0..N).filter(|&i| left[i]) {
            for j in (0..N).filter(|&j| left[j]) {
                w[i][j] -= row[i] * row[j] / row[k];
            }
        }
    }
    Ok(())
}

/// A pivot of a weight with ones on its diagonal counts as zero below this.
const ROUNDING: f64 = 1e-13;

/// `A`, `G = B R⁻¹ Bᵀ` and `H = Q` of a Riccati equation.
#[derive(Clone, Copy)]
struct Equation<const N: usize> {
    a: Square<N>,
    g: Square<N>,
    h: Square<N>,
}

impl<const N: usize> Equation<N> {
    /// With `x = D z`: `D⁻¹ A D`, `D⁻¹ G D⁻¹`, `D H D`; its solution is `D X D`.
    fn scaled(&self, d: &[f64; N]) -> Self {
        Self {
            a: each(&self.a, |i, j| d[j] / d[i]),
            g: each(&self.g, |i, j| 1.0 / d[i] / d[j]),
            h: each(&self.h, |i, j| d[i] * d[j]),
        }
    }

    /// Powers of two that balance what drives each state with what it drives: rows of A and G with columns of A and H,
    /// G and H being weighed alike.
    fn balance(&self) -> [f64; N] {
        let mut d = [1.0; N];
        for _ in 0..30 {
            let Self { a, g, h } = self.scaled(&d);
            let weight =
                if norm(&g) > 0.0 && norm(&h) > 0.0 { Scalar::sqrt(norm(&g)) / Scalar::sqrt(norm(&h)) } else { 1.0 };
            let factors: [f64; N] = core::array::from_fn(|i| {
                let others = (0..N).filter(|&j| j != i);
                let row: f64 = others.clone().map(|j| a[i][j].abs()).sum::<f64>() + norm(&[g[i]]) / weight;
                let column: f64 = others.map(|j| a[j][i].abs()).sum::<f64>() + norm(&[h[i]]) * weight;
                if row > 0.0 && column > 0.0 { power_of_two(Scalar::sqrt(row / column)) } else { 1.0 }
            });
            if factors == [1.0; N] {
                break;
            }
            // One state at a time, or two that drive each other would overshoot.
            for i in 0..N {
                d[i] *= if factors[i] > 1.0 {
                    2.0
                } else if factors[i] < 1.0 {
                    0.5
                } else {
                    1.0
                };
            }
        }
        d
    }
}

/// `mᵢⱼ f(i, j)`
fn each<const N: usize>(m: &Square<N>, f: impl Fn(usize, usize) -> f64) -> Square<N> {
    core::array::from_fn(|i| core::array::from_fn(|j| m[i][j] * f(i, j)))
}

/// The power of two nearest to a positive number, from 2⁻³⁰⁰ to 2³⁰⁰.
fn power_of_two(x: f64) -> f64 {
    let mut power = 1.0;
    while x > 1.5 * power && power < 1e90 {
        power *= 2.0;
    }
    while x < 0.75 * power && power > 1e-90 {
        power *= 0.5;
    }
    power
}

/// Solves, scales the states by the diagonal of the solution, and solves again. The method is told the units.
fn scaled_twice<const N: usize>(
    equation: &Equation<N>,
    method: impl Fn(&Equation<N>, &[f64; N]) -> Option<(Square<N>, f64)>,
) -> Result<Square<N>, ControlError> {
    let balance = equation.balance();
    let (first, left) = method(&equation.scaled(&balance), &balance).ok_or(ControlError::NotStabilizable)?;
    let d: [f64; N] = core::array::from_fn(|i| {
        let size = first[i][i];
        balance[i] * if size > 0.0 { power_of_two(1.0 / Scalar::sqrt(size)) } else { 1.0 }
    });
    let back = |x: &Square<N>, d: &[f64; N]| each(x, |i, j| 1.0 / d[i] / d[j]);
    match method(&equation.scaled(&d), &d) {
        Some((second, rest)) if rest <= GOOD && rest <= left.max(FINE) => Ok(back(&second, &d)),
        _ if left <= GOOD => Ok(back(&first, &balance)),
        _ => Err(ControlError::NotStabilizable),
    }
}

/// What a solution may leave of its equation, in units of the terms of which it is the sum. Where A is very unstable no
/// less is left.
const GOOD: f64 = 1e-6;

/// The solution in the better units is taken if it leaves no more than this, even where the first one leaves less.
const FINE: f64 = 1e-10;

/// Steps of Newton's method; as it is quadratic, it rarely needs more than three.
const NEWTON: usize = 20;

/// The solution of the continuous equation and what it leaves.
fn continuous<const N: usize>(equation: &Equation<N>) -> Option<(Square<N>, f64)> {
    let Equation { a, g, h } = equation;
    let size = norm(a) + Scalar::sqrt(norm(g)) * Scalar::sqrt(norm(h));
    let mut best: Option<(Square<N>, f64)> = None;
    for part in [1.0, 0.25, 0.0625, 4.0, 0.015_625, 16.0, 1.0 / 256.0, 1.0 / 4096.0] {
        let Some(mut x) = transformed(equation, part * size).and_then(|sampled| doubling(&sampled)) else { continue };
        for _ in 0..NEWTON {
            let Some(better) = kleinman(equation, &x) else { break };
            x = better;
        }
        let left = relative_residual(equation, &x);
        if best.is_none_or(|(_, least)| left < least) {
            best = Some((x, left));
        }
        if left < 1e-14 {
            break;
        }
    }
    best
}

/// `Aᵀ X + X A − X G X + H`
fn residual<const N: usize>(Equation { a, g, h }: &Equation<N>, x: &Square<N>) -> Square<N> {
    let xa = product(x, a);
    let linear = sum(&sum(&transpose(&xa), &xa), h);
    difference(&linear, &product(&product(x, g), x))
}

fn relative_residual<const N: usize>(equation: &Equation<N>, x: &Square<N>) -> f64 {
    let Equation { a, g, h } = equation;
    let terms = 2.0 * norm(&product(x, a)) + norm(&product(&product(x, g), x)) + norm(h);
    if terms == 0.0 { 0.0 } else { norm(&residual(equation, x)) / terms }
}

/// The equation of a sampled system with the same solution: Cayley's transformation with the parameter `gamma`.
fn transformed<const N: usize>(Equation { a, g, h }: &Equation<N>, gamma: f64) -> Option<Equation<N>> {
    let one = identity(1.0);
    // A − γ, W = (A − γ)ᵀ + H (A − γ)⁻¹ G
    let shifted = difference(a, &identity(gamma));
    let inverse = solve(shifted, one)?;
    let w = sum(&transpose(&shifted), &product(&product(h, &inverse), g));
    let back = scaled(2.0 * gamma, &solve(w, one)?);
    Some(Equation {
        a: sum(&one, &transpose(&back)),
        g: symmetric(&product(&product(&inverse, g), &back)),
        h: symmetric(&product(&product(&back, h), &inverse)),
    })
}

/// The solution of `X = Aᵀ X (1 + G X)⁻¹ A + H` by doubling: `H` converges to it, quadratically.
fn doubling<const N: usize>(Equation { a, g, h }: &Equation<N>) -> Option<Square<N>> {
    let (mut a, mut g, mut h) = (*a, *g, *h);
    for _ in 0..64 {
        let w = sum(&identity(1.0), &product(&g, &h));
        let (wa, wg) = (solve(w, a)?, solve(w, g)?);
        let change = symmetric(&product(&transpose(&a), &product(&h, &wa)));
        g = sum(&g, &symmetric(&product(&a, &product(&wg, &transpose(&a)))));
        h = sum(&h, &change);
        a = product(&a, &wa);
        if !(is_finite(&a) && is_finite(&g) && is_finite(&h)) {
            return None;
        }
        if norm(&change) <= 1e-17 * norm(&h) {
            return Some(h);
        }
    }
    None
}

/// One step of Newton's method: `(A − G X)ᵀ Δ + Δ (A − G X) = −residual`, where that leaves less.
fn kleinman<const N: usize>(equation: &Equation<N>, x: &Square<N>) -> Option<Square<N>> {
    let closed = difference(&equation.a, &product(&equation.g, x));
    let gamma = norm(&closed);
    // As an equation of a sampled system: U = (γ − Aₖ)⁻¹ (γ + Aₖ), V = 2γ (γ − Aₖ)⁻ᵀ residual (γ − Aₖ)⁻¹.
    let inverse = solve(difference(&identity(gamma), &closed), identity(1.0))?;
    let u = product(&inverse, &sum(&identity(gamma), &closed));
    let v = scaled(2.0 * gamma, &product(&product(&transpose(&inverse), &residual(equation, x)), &inverse));
    let better = symmetric(&sum(x, &stein(u, v)?));
    (relative_residual(equation, &better) < relative_residual(equation, x)).then_some(better)
}

/// The solution of `Δ = Uᵀ Δ U + V` by doubling (R. A. Smith, *Matrix equation XA + BX = C*, 1968).
fn stein<const N: usize>(mut u: Square<N>, mut v: Square<N>) -> Option<Square<N>> {
    for _ in 0..64 {
        let change = product(&product(&transpose(&u), &v), &u);
        v = sum(&v, &change);
        u = product(&u, &u);
        if !(is_finite(&u) && is_finite(&v)) {
            return None;
        }
        if norm(&change) <= 1e-17 * norm(&v) {
            return Some(v);
        }
    }
    None
}

/// The solution of the sampled equation and what it leaves.
fn discrete<const N: usize, const U: usize>(
    equation: &Equation<N>,
    b: &[[f64; U]; N],
    r: &Square<U>,
) -> Option<(Square<N>, f64)> {
    let mut best: Option<(Square<N>, f64)> = None;
    let mut next = doubling(equation);
    for _ in 0..=NEWTON {
        let Some(x) = next else { break };
        let Some((better, left)) = hewer(equation, b, r, &x) else { break };
        if best.is_some_and(|(_, least)| left >= least) {
            break;
        }
        (best, next) = (Some((x, left)), better);
    }
    best
}

/// One step of Newton's method, the cost of the feedback K that X gives, and what X leaves of its equation:
/// `(A − B K)ᵀ X (A − B K) + Kᵀ R K + Q − X`.
fn hewer<const N: usize, const U: usize>(
    Equation { a, h, .. }: &Equation<N>,
    b: &[[f64; U]; N],
    r: &Square<U>,
    x: &Square<N>,
) -> Option<(Option<Square<N>>, f64)> {
    let gain = sampled_gain(a, b, r, x)?;
    let closed = difference(a, &product(b, &gain));
    let now = sum(h, &product(&transpose(&gain), &product(r, &gain)));
    let ahead = product(&transpose(&closed), &product(x, &closed));
    let residual = difference(&sum(&ahead, &now), x);
    let terms = norm(&ahead) + norm(&now) + norm(x);
    let left = if terms == 0.0 { 0.0 } else { norm(&residual) / terms };
    Some((stein(closed, now).map(|better| symmetric(&better)), left))
}

/// `(R + Bᵀ X B)⁻¹ Bᵀ X A`
fn sampled_gain<const N: usize, const U: usize>(
    a: &Square<N>,
    b: &[[f64; U]; N],
    r: &Square<U>,
    x: &Square<N>,
) -> Option<[[f64; N]; U]> {
    let xb = product(&transpose(b), x);
    solve(sum(r, &product(&xb, b)), product(&xb, a))
}
