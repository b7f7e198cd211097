//! Derivatives of a generated function along a change of the state, by dual numbers.

use mbs_derive::expr::{Dual, Symbol};
use mbs_derive::interpret::Interpreter;
use mbs_derive::optimise::{Derivation, Function};

use crate::state::Point;

/// A mechanism at a state, of which changes are followed.
pub(super) struct Along<'p> {
    interpreter: Interpreter<'p, Dual<f64>>,
    point: &'p Point,
}

impl<'p> Along<'p> {
    pub(super) fn new(derivation: &'p Derivation, point: &'p Point) -> Self {
        let parameters = point.parameters.iter().map(|&x| Dual::fixed(x)).collect();
        Along { interpreter: Interpreter::with_parameters(derivation, parameters), point }
    }

    /// The derivative of the function's results where each variable changes by `direction(symbol)`.
    pub(super) fn slope(&self, function: &Function, direction: impl Fn(Symbol) -> f64) -> Vec<f64> {
        let results = self.interpreter.evaluate(function, &self.point.state.along(direction));
        results.into_iter().map(|value| value.derivative).collect()
    }
}
