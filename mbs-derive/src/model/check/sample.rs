//! Random states, the same in every process, at which declarations are tried and derivations are proved.

use crate::expr::Number;
use crate::numeric::Random;
use crate::state::State;
use crate::variable::count;

use crate::model::lagrangian::Draft;

impl Random {
    /// A state of a mechanism: angles over the whole circle, all else of order one.
    pub fn state(&mut self, lagrangian: &Draft<'_>) -> State {
        let (n, inputs) = (lagrangian.dof(), count(&lagrangian.inputs));
        State {
            t: 2.0 * self.symmetric(),
            q: self.vector(n, std::f64::consts::PI),
            qd: self.vector(n, 2.0),
            qdd: self.vector(n, 2.0),
            u: self.vector(inputs, 2.0),
            prescribed: (0..count(&lagrangian.prescribed)).map(|_| [0, 1, 2].map(|_| self.symmetric())).collect(),
        }
    }
}

/// The declared defaults of all parameters, flattened.
pub(crate) fn default_parameters(lagrangian: &Draft<'_>) -> Vec<f64> {
    lagrangian.parameters.iter().flat_map(|p| &p.defaults).copied().map(Number::to_f64).collect()
}
