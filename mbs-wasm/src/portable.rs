//! Doubles whose elementary functions give the same bits on every machine.

use mbs_derive::expr::{Binary, Function, Value};

/// A double; sine, logarithm and their like are computed by the libm crate, in a page as on any other machine.
///
/// ```
/// use mbs_derive::expr::{Function, Value};
/// use mbs_wasm::portable::Portable;
/// assert_eq!(Portable(0.5).call(Function::Sin).0.to_bits(), Function::Sin.folded(0.5).to_bits());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portable(pub f64);

impl Value for Portable {
    fn constant(value: f64) -> Self {
        Portable(value)
    }
    fn neg(self) -> Self {
        Portable(-self.0)
    }
    fn add(self, other: Self) -> Self {
        Portable(self.0 + other.0)
    }
    fn sub(self, other: Self) -> Self {
        Portable(self.0 - other.0)
    }
    fn mul(self, other: Self) -> Self {
        Portable(self.0 * other.0)
    }
    fn div(self, other: Self) -> Self {
        Portable(self.0 / other.0)
    }
    fn power(self, halves: i32) -> Self {
        Portable(self.0.power(halves))
    }
    fn call(self, function: Function) -> Self {
        Portable(function.folded(self.0))
    }
    fn call2(self, function: Binary, other: Self) -> Self {
        Portable(function.folded(self.0, other.0))
    }
    fn rate(self) -> Self {
        Portable(f64::NAN)
    }
    fn less(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn less_equal(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn exponent(self) -> i32 {
        self.0.exponent()
    }
}

/// As what the interpreter computes with.
pub(crate) fn portable(numbers: &[f64]) -> Vec<Portable> {
    numbers.iter().copied().map(Portable).collect()
}

/// As plain doubles.
pub(crate) fn plain(numbers: Vec<Portable>) -> Vec<f64> {
    numbers.into_iter().map(|number| number.0).collect()
}
