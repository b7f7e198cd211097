//! Sine and cosine as `mbs_runtime::Scalar::sin_cos_all` computes them, to the bit.

/// Which sines and cosines are computed. On one target and with one choice the bits never vary.
///
/// ```
/// use mbs_derive::emit::{Options, Trigonometry};
/// let text = "mechanism Swing { param j: kg*m^2 = 1; param w: J = 2; coord q: rad; kinetic += j*dt(q)^2/2; \
///             potential += -w*cos(q); }";
/// let code = |options: Options| mbs_derive::generate("swing.mbs", text, &options).unwrap().code;
/// assert!(code(Options::default()).contains("sin_cos_all"));
/// assert!(!code(Options::default().trigonometry(Trigonometry::Library)).contains("sin_cos_all"));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trigonometry {
    /// Those of `mbs_runtime::Scalar::sin_cos_all`: all angles of a function that are known together in one call, by
    /// polynomials, within 1 ulp, the same bits on every target for angles up to 1e5 rad.
    #[default]
    Polynomials,
    /// Those of the standard library, one by one; they depend on the platform.
    Library,
}

/// Larger angles are left to the library.
const REACH: f64 = 1e5;
/// 2/π
const TURNS: f64 = std::f64::consts::FRAC_2_PI;
/// 1.5 · 2⁵²: adding it leaves no digits behind the point.
const MAGIC: f64 = 6755399441055744.0;
/// π/2 in three parts.
const P: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];
/// `(sin y − y)/y³` in `y²`.
const S: [f64; 6] = [
    -0.1666666666666663,
    0.00833333333332184,
    -0.00019841269829358541,
    2.7557313538526334e-6,
    -2.5050734392422683e-8,
    1.5895433544930663e-10,
];
/// `(cos y − 1 + y²/2)/y⁴` in `y²`.
const C: [f64; 6] = [
    0.041666666666666595,
    -0.001388888888887334,
    2.4801587288999616e-5,
    -2.755731421606095e-7,
    2.087570523233725e-9,
    -1.1358739381498488e-11,
];

/// The steps are explained in `mbs-runtime/src/scalar/sin_cos.rs`; every rounding counts.
pub(super) fn sin_cos(x: f64) -> (f64, f64) {
    // A NaN goes to the library, too.
    if x.is_nan() || x.abs() > REACH {
        return (x.sin(), x.cos());
    }
    let k = (x * TURNS + MAGIC) - MAGIC;
    let r = x - k * P[0];
    let w = k * P[1];
    let h = r - w;
    let t = k * P[2] - ((r - h) - w);
    let y = h - t;
    let e = t - (h - y);
    let z = y * y;
    let z2 = z * z;
    let sum = |c: [f64; 6]| ((c[0] + z * c[1]) + z2 * (c[2] + z * c[3])) + (z2 * z2) * (c[4] + z * c[5]);
    let half = 0.5 * z;
    let one = 1.0 - half;
    let sin = y - (e * one - (z * y) * sum(S));
    let cos = one + (((1.0 - one) - half) + (z2 * sum(C) + y * e));
    match (k as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}
