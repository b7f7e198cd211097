//! Derivatives of a generated function along a change of the state, by dual numbers.

use mbs_derive::expr::Dual;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function};

use crate::state::Point;

/// A mechanism at a state, of which changes are followed.
pub(super) struct Along<'d> {
    interpreter: Interpreter<'d, Dual<f64>>,
    state: State<Dual<f64>>,
}

impl<'d> Along<'d> {
    pub(super) fn new(derivation: &'d Derivation, point: &Point) -> Self {
        let given = &point.state;
        let state = State {
            t: Dual::fixed(given.t),
            q: fixed(&given.q),
            qd: fixed(&given.qd),
            qdd: fixed(&given.qdd),
            u: fixed(&given.u),
            prescribed: given.prescribed.iter().map(|signal| signal.map(Dual::fixed)).collect(),
        };
        Along { interpreter: Interpreter::with_parameters(derivation, fixed(&point.parameters)), state }
    }

    /// The derivative of the function's results where q, q̇ and u change so; an empty change is none.
    pub(super) fn slope(&self, function: &Function, [q, qd, u]: [&[f64]; 3]) -> Vec<f64> {
        let mut state = self.state.clone();
        for (numbers, change) in [(&mut state.q, q), (&mut state.qd, qd), (&mut state.u, u)] {
            numbers.iter_mut().zip(change).for_each(|(number, &change)| number.derivative = change);
        }
        self.interpreter.evaluate(function, &state).into_iter().map(|value| value.derivative).collect()
    }
}

fn fixed(values: &[f64]) -> Vec<Dual<f64>> {
    values.iter().map(|&x| Dual::fixed(x)).collect()
}
