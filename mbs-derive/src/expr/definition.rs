//! What constants are folded from, for who wants to fold them again: a test, over numbers of more digits.

use std::cell::RefCell;
use std::collections::HashMap;

use super::evaluate::Value;
use super::function::{Binary, Function};
use super::number::Number;
use super::spline::Spline;

/// The operation that a constant which no fraction holds is the result of.
#[derive(Clone, Debug)]
pub(super) enum Definition {
    /// As it was given.
    Double(f64),
    Sum(Number, Number),
    Product(Number, Number),
    Quotient(Number, Number),
    /// The second is in halves.
    Power(Number, i32),
    Call(Function, Number),
    Call2(Binary, Number, Number),
    /// A derivative of this order.
    Spline(Spline, usize, Number),
}

thread_local! {
    /// Nothing is kept of constants but while somebody asks.
    static DEFINITIONS: RefCell<Option<Vec<(Number, Definition)>>> = const { RefCell::new(None) };
}

/// The number, of which it is kept how it came about, where somebody asks.
pub(super) fn define(number: Number, definition: impl FnOnce() -> Definition) -> Number {
    DEFINITIONS.with_borrow_mut(|kept| {
        if let Some(kept) = kept {
            kept.push((number, definition()));
        }
    });
    number
}

impl Number {
    /// What `compute` returns, and each constant that it folds and no fraction holds, beside the value of the same
    /// operations over other numbers.
    ///
    /// # Panics
    /// Where a constant was folded before and is no fraction.
    pub fn refolded<V: Value, T>(compute: impl FnOnce() -> T) -> (T, Vec<(Number, V)>) {
        DEFINITIONS.set(Some(Vec::new()));
        let result = compute();
        let definitions = DEFINITIONS.take().unwrap_or_default();
        let mut known: HashMap<Number, V> = HashMap::new();
        let mut values = Vec::new();
        for (number, definition) in definitions {
            let of = |operand: Number| match operand {
                Number::Exact { .. } => V::number(operand),
                Number::Real { .. } => *known.get(&operand).expect("defined before it is used"),
            };
            let value = match definition {
                Definition::Double(value) => V::constant(value),
                Definition::Sum(a, b) => of(a).add(of(b)),
                Definition::Product(a, b) => of(a).mul(of(b)),
                Definition::Quotient(a, b) => of(a).div(of(b)),
                Definition::Power(a, halves) => of(a).power(halves),
                Definition::Call(function, a) => of(a).call(function),
                Definition::Call2(function, a, b) => of(a).call2(function, of(b)),
                Definition::Spline(spline, order, a) => of(a).spline(&spline, order),
            };
            known.insert(number, value);
            values.push((number, value));
        }
        (result, values)
    }
}
