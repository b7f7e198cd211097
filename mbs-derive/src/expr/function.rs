//! Functions of one and two arguments: name, derivative, value and Rust spelling side by side.

use crate::mistake::rule;

use super::graph::{Expr, HalfInteger};
use super::sin_cos::sin_cos;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Function {
    /// sine
    Sin,
    /// cosine
    Cos,
    /// tangent
    Tan,
    /// inverse sine, argument in [−1, 1]
    Asin,
    /// inverse cosine, argument in [−1, 1]
    Acos,
    /// inverse tangent
    Atan,
    /// hyperbolic sine
    Sinh,
    /// hyperbolic cosine
    Cosh,
    /// hyperbolic tangent
    Tanh,
    /// hyperbolic secant: no word of the language, but the root of tanh′, of which `1 − tanh²` leaves no digits far
    /// away
    Sech,
    /// exponential
    Exp,
    /// natural logarithm, argument positive
    Ln,
    /// absolute value
    Abs,
    /// −1, 0 or 1
    Signum,
}

/// A function of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Binary {
    /// `atan2(y, x)`: the angle of the point (x, y)
    Atan2,
    /// `powf(x, y)`: x^y for positive x
    Powf,
}

impl Function {
    /// Every function of one argument that a declaration may call.
    pub const ALL: [Function; 13] = [
        Function::Sin,
        Function::Cos,
        Function::Tan,
        Function::Asin,
        Function::Acos,
        Function::Atan,
        Function::Sinh,
        Function::Cosh,
        Function::Tanh,
        Function::Exp,
        Function::Ln,
        Function::Abs,
        Function::Signum,
    ];

    /// The name in declarations, and of the method on `Scalar`.
    pub fn name(self) -> &'static str {
        match self {
            Function::Sin => "sin",
            Function::Cos => "cos",
            Function::Tan => "tan",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Sinh => "sinh",
            Function::Cosh => "cosh",
            Function::Tanh => "tanh",
            Function::Sech => "sech",
            Function::Exp => "exp",
            Function::Ln => "ln",
            Function::Abs => "abs",
            Function::Signum => "signum",
        }
    }

    /// `f′(x)`, given `x` and `f(x)`.
    pub fn derivative<'g>(self, x: Expr<'g>, value: Expr<'g>) -> Expr<'g> {
        let one = x.graph().integer(1);
        match self {
            Function::Sin => x.cos(),
            Function::Cos => rule!("the derivative of cos", -x.sin(), x.sin()),
            Function::Tan => rule!("the derivative of tan", one + value.powi(2), one - value.powi(2)),
            Function::Asin => (one - x.powi(2)).power(HalfInteger::halves(-1)),
            Function::Acos => -(one - x.powi(2)).power(HalfInteger::halves(-1)),
            Function::Atan => (one + x.powi(2)).powi(-1),
            Function::Sinh => x.call(Function::Cosh),
            Function::Cosh => x.call(Function::Sinh),
            Function::Tanh => rule!("the derivative of tanh", x.call(Function::Sech).powi(2), x.call(Function::Sech)),
            Function::Sech => -value * x.call(Function::Tanh),
            Function::Exp => value,
            Function::Ln => x.powi(-1),
            Function::Abs => x.call(Function::Signum),
            Function::Signum => x.graph().integer(0),
        }
    }

    /// `f″(x)`, given `x` and `f(x)`.
    pub fn second_derivative<'g>(self, x: Expr<'g>, value: Expr<'g>) -> Expr<'g> {
        let one = x.graph().integer(1);
        match self {
            Function::Sin | Function::Cos => -value,
            Function::Tan => 2 * value * (one + value.powi(2)),
            Function::Asin => x * (one - x.powi(2)).power(HalfInteger::halves(-3)),
            Function::Acos => -x * (one - x.powi(2)).power(HalfInteger::halves(-3)),
            Function::Atan => -2 * x * (one + x.powi(2)).powi(-2),
            Function::Sinh | Function::Cosh | Function::Exp => value,
            Function::Tanh => -2 * value * x.call(Function::Sech).powi(2),
            Function::Sech => value * (x.call(Function::Tanh).powi(2) - value.powi(2)),
            Function::Ln => -x.powi(-2),
            Function::Abs | Function::Signum => x.graph().integer(0),
        }
    }

    /// `f(x)` as compiled code computes it on this machine.
    pub fn value(self, x: f64) -> f64 {
        match self {
            Function::Sin => sin_cos(x).0,
            Function::Cos => sin_cos(x).1,
            other => other.library_value(x),
        }
    }

    /// `f(x)` with the host's mathematics: what code compiled with [`Trigonometry::Library`](super::Trigonometry)
    /// computes on this machine.
    pub fn library_value(self, x: f64) -> f64 {
        match self {
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Sinh => x.sinh(),
            Function::Cosh => x.cosh(),
            Function::Tanh => x.tanh(),
            Function::Sech => 1.0 / x.cosh(),
            Function::Exp => x.exp(),
            Function::Ln => x.ln(),
            Function::Abs => x.abs(),
            Function::Signum => signum(x),
        }
    }

    /// `f(x)` by `libm`: the same bits on every machine, for constants folded at build time.
    pub fn folded(self, x: f64) -> f64 {
        match self {
            Function::Sin => libm::sin(x),
            Function::Cos => libm::cos(x),
            Function::Tan => libm::tan(x),
            Function::Asin => libm::asin(x),
            Function::Acos => libm::acos(x),
            Function::Atan => libm::atan(x),
            Function::Sinh => libm::sinh(x),
            Function::Cosh => libm::cosh(x),
            Function::Tanh => libm::tanh(x),
            Function::Sech => 1.0 / libm::cosh(x),
            Function::Exp => libm::exp(x),
            Function::Ln => libm::log(x),
            Function::Abs => x.abs(),
            Function::Signum => signum(x),
        }
    }

    /// Whether `f(−x) = f(x)`.
    pub(super) fn is_even(self) -> bool {
        matches!(self, Function::Cos | Function::Cosh | Function::Sech | Function::Abs)
    }

    /// Whether `f(−x) = −f(x)`.
    pub(super) fn is_odd(self) -> bool {
        match self {
            Function::Sin
            | Function::Tan
            | Function::Asin
            | Function::Atan
            | Function::Sinh
            | Function::Tanh
            | Function::Signum => true,
            Function::Cos
            | Function::Acos
            | Function::Cosh
            | Function::Sech
            | Function::Exp
            | Function::Ln
            | Function::Abs => false,
        }
    }
}

impl Binary {
    /// Every function of two arguments.
    pub const ALL: [Binary; 2] = [Binary::Atan2, Binary::Powf];

    /// The name in declarations, and of the method on `Scalar`.
    pub fn name(self) -> &'static str {
        match self {
            Binary::Atan2 => "atan2",
            Binary::Powf => "powf",
        }
    }

    /// `[∂f/∂a, ∂f/∂b]`, given `a`, `b` and `f(a, b)`.
    pub fn derivative<'g>(self, a: Expr<'g>, b: Expr<'g>, value: Expr<'g>) -> [Expr<'g>; 2] {
        match self {
            Binary::Atan2 => {
                let squared = a.powi(2) + b.powi(2);
                rule!("the derivative of atan2", [b / squared, -a / squared], [b / squared, a / squared])
            }
            // Not `b f/a`, which is 0/0 at a = 0.
            Binary::Powf => [b * a.call2(Binary::Powf, b - a.graph().integer(1)), value * a.call(Function::Ln)],
        }
    }

    /// `[∂²f/∂a², ∂²f/∂a∂b, ∂²f/∂b²]`, given `a`, `b` and `f(a, b)`.
    pub fn second_derivative<'g>(self, a: Expr<'g>, b: Expr<'g>, value: Expr<'g>) -> [Expr<'g>; 3] {
        let one = a.graph().integer(1);
        match self {
            Binary::Atan2 => {
                let fourth = (a.powi(2) + b.powi(2)).powi(-2);
                [-2 * a * b * fourth, (a.powi(2) - b.powi(2)) * fourth, 2 * a * b * fourth]
            }
            Binary::Powf => {
                let ln = a.call(Function::Ln);
                let lower = |k: i64| a.call2(Binary::Powf, b - a.graph().integer(k));
                [b * (b - one) * lower(2), lower(1) * (one + b * ln), value * ln.powi(2)]
            }
        }
    }

    /// `f(a, b)` with the host's mathematics: what compiled code gives on this machine.
    pub fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Atan2 => a.atan2(b),
            Binary::Powf => a.powf(b),
        }
    }

    /// `f(a, b)` by `libm`: the same bits on every machine, for constants folded at build time.
    pub fn folded(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Atan2 => libm::atan2(a, b),
            Binary::Powf => libm::pow(a, b),
        }
    }
}

/// −1, 0 or 1: the derivative of `|x|`, with 0 at the corner.
pub(crate) fn signum(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x + 0.0 // NaN stays, −0 becomes 0
    }
}
