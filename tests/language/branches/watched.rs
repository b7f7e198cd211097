//! Numbers that tell what is computed with them.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use mbs_derive::expr::{Binary, Function, Value};
use mbs_runtime::Scalar;

/// What was computed. Signs, comparisons and choices are not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Sums and differences.
    pub(crate) sums: usize,
    /// Products.
    pub(crate) products: usize,
    /// Quotients.
    pub(crate) quotients: usize,
    /// Square roots.
    pub(crate) roots: usize,
    /// Sines and cosines, each by itself.
    pub(crate) waves: usize,
    /// Logarithms.
    pub(crate) logarithms: usize,
    /// Other functions.
    pub(crate) others: usize,
    /// What has no finite value: the root or the logarithm of a negative number, a quotient by zero.
    pub(crate) undefined: usize,
}

thread_local! {
    static TALLY: Cell<Tally> = Cell::default();
}

/// A double whose operations are counted, in generated code and in the interpreter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Watched(pub(crate) f64);

impl Watched {
    /// What `work` gives, and what it computed.
    pub(crate) fn tally<R>(work: impl FnOnce() -> R) -> (R, Tally) {
        TALLY.set(Tally::default());
        (work(), TALLY.get())
    }

    fn count(value: f64, operation: fn(&mut Tally) -> &mut usize) -> Self {
        let mut tally = TALLY.get();
        *operation(&mut tally) += 1;
        tally.undefined += usize::from(!value.is_finite());
        TALLY.set(tally);
        Watched(value)
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident $count:ident;)*) => {$(
        impl $operator for Watched {
            type Output = Watched;
            fn $method(self, other: Watched) -> Watched {
                Watched::count($operator::$method(self.0, other.0), |tally| &mut tally.$count)
            }
        }
    )*};
}
operators!(Add add sums; Sub sub sums; Mul mul products; Div div quotients;);

impl Neg for Watched {
    type Output = Watched;
    fn neg(self) -> Watched {
        Watched(-self.0)
    }
}

macro_rules! functions {
    ($($name:ident $count:ident;)*) => {$(
        fn $name(self) -> Self {
            Watched::count(Scalar::$name(self.0), |tally| &mut tally.$count)
        }
    )*};
}

impl Scalar for Watched {
    type Mask = bool;

    fn from_f64(value: f64) -> Self {
        Watched(value)
    }

    functions! {
        sqrt roots; ln logarithms;
        tan others; asin others; acos others; atan others; sinh others; cosh others; tanh others; exp others;
        abs others; signum others;
    }

    fn sin(self) -> Self {
        Watched::count(f64::sin_cos_all([self.0]).0[0], |tally| &mut tally.waves)
    }
    fn cos(self) -> Self {
        Watched::count(f64::sin_cos_all([self.0]).1[0], |tally| &mut tally.waves)
    }
    fn sin_cos(self) -> (Self, Self) {
        (Scalar::sin(self), Scalar::cos(self))
    }
    fn atan2(self, x: Self) -> Self {
        Watched::count(self.0.atan2(x.0), |tally| &mut tally.others)
    }
    fn powf(self, exponent: Self) -> Self {
        Watched::count(self.0.powf(exponent.0), |tally| &mut tally.others)
    }
    fn is_finite(self) -> bool {
        self.0.is_finite()
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn equal(self, other: Self) -> bool {
        self.0 == other.0
    }
    fn blend(mask: bool, then: Self, otherwise: Self) -> Self {
        if mask { then } else { otherwise }
    }
}

impl Value for Watched {
    fn constant(value: f64) -> Self {
        Watched(value)
    }
    fn neg(self) -> Self {
        -self
    }
    fn add(self, other: Self) -> Self {
        self + other
    }
    fn sub(self, other: Self) -> Self {
        self - other
    }
    fn mul(self, other: Self) -> Self {
        self * other
    }
    fn div(self, other: Self) -> Self {
        self / other
    }
    fn power(self, halves: i32) -> Self {
        assert_eq!(halves, 1, "Programs know no powers but roots");
        Scalar::sqrt(self)
    }
    fn call(self, function: Function) -> Self {
        let value = function.value(self.0);
        match function {
            Function::Sin | Function::Cos => Watched::count(value, |tally| &mut tally.waves),
            Function::Ln => Watched::count(value, |tally| &mut tally.logarithms),
            _ => Watched::count(value, |tally| &mut tally.others),
        }
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        Watched::count(function.value(self.0, other.0), |tally| &mut tally.others)
    }
    fn rate(self) -> Self {
        Watched(f64::NAN)
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
}
