//! Mechanisms whose system is eliminated in a known order: its matrices, the rank of A, and least changes.

use crate::expr::{Elimination, Value, largest, sparse};
use crate::optimise::{FunctionKind, ResultPart, Shape};
use crate::state::State;

use super::{Interpreter, System, expand_symmetric};

impl<'d, V: Value> Interpreter<'d, V> {
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

    /// The rank of A at a state, of a mechanism that is eliminated in a known order; `None` of others.
    pub fn rank(&self, state: &State<V>) -> Option<usize> {
        let (elimination, entries) = self.entries(state)?;
        Some(self.derivation.constraints.len() - sparse::dependent_rows(elimination, &entries)?)
    }

    /// The entries of M and A, of a mechanism that is eliminated in a known order.
    fn entries(&self, state: &State<V>) -> Option<(&'d Elimination, Vec<V>)> {
        let elimination = self.derivation.elimination.as_ref()?;
        let function = self.derivation.function(FunctionKind::ForwardDynamics)?;
        let mut entries = self.run(&function.program, state, &[]);
        entries.truncate(elimination.entries.len());
        Some((elimination, entries))
    }

    /// The δ of least `δᵀ M δ` with `A δ = target` at a state, of a mechanism that is eliminated in a known order;
    /// `None` of others, and where there is none.
    pub fn least_change(&self, state: &State<V>, target: &[V]) -> Option<Vec<V>> {
        let (elimination, entries) = self.entries(state)?;
        let mut column = vec![V::constant(0.0); elimination.coordinates];
        column.extend(target);
        let mut change = V::eliminated(elimination, entries)(&column);
        change.truncate(elimination.coordinates);
        change.iter().all(|&x| largest([x]).less(V::constant(f64::INFINITY))).then_some(change)
    }
}
