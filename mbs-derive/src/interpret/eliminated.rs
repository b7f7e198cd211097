//! Mechanisms whose system is eliminated in a known order: its matrices, the rank of A, and least changes.

use crate::expr::{Value, sparse};
use crate::optimise::{FunctionKind, ResultPart, Shape};
use crate::state::State;

use super::{Interpreter, System, expand_symmetric};

impl<V: Value> Interpreter<'_, V> {
    /// M or A of what forward dynamics sets up.
    pub(super) fn matrix_of_motion(&self, kind: FunctionKind, state: &State<V>) -> Option<Vec<V>> {
        let is_matrix = matches!(kind, FunctionKind::MassMatrix | FunctionKind::ConstraintJacobian);
        let function = self.derivation.function(FunctionKind::ForwardDynamics).filter(|_| is_matrix)?;
        self.derivation.elimination.as_ref()?;
        let System { mass, jacobian, .. } = self.system_of_motion(function, state);
        let n = self.derivation.dof();
        let symmetric = [ResultPart { name: "", shape: Shape::Symmetric(n) }];
        Some(if kind == FunctionKind::MassMatrix { expand_symmetric(&symmetric, mass) } else { jacobian })
    }

    /// The δ of least `δᵀ M δ` with `A δ = target` at a state, and the rank of A, of a mechanism that is eliminated in
    /// a known order; `None` of others, and where there is no δ.
    pub fn least_change(&self, state: &State<V>, target: &[V]) -> Option<(Vec<V>, usize)> {
        let elimination = self.derivation.elimination.as_ref()?;
        let function = self.derivation.function(FunctionKind::ForwardDynamics)?;
        let entries = self.run(&function.program, state, &[]);
        let factors = sparse::Factors::new(elimination, &entries[..elimination.entries.len()])?;
        let mut column = vec![V::constant(0.0); elimination.coordinates];
        column.extend(target);
        let mut change = factors.solution(elimination, &column)?;
        change.truncate(elimination.coordinates);
        Some((change, self.derivation.constraints.len() - factors.dependent_rows(elimination)))
    }
}
