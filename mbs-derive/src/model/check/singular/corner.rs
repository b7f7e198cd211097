//! What the corner of an `abs` does to the derivatives of what it is in.

use super::{Fault, Search};
use crate::expr::{Dual, Symbol};
use crate::state::State;

impl Search<'_, '_, '_> {
    /// Whether the derivatives jump there, however small the step over it: `(|x| + x)²` is smooth at 0.
    pub(in crate::model) fn has_kink(&self, fault: &Fault, state: &State) -> bool {
        let tape = self.tape_of(fault.group);
        let slopes = |along: Symbol, step: f64| -> Vec<f64> {
            let values = tape.run(|symbol| {
                let (moved, slope) = if symbol == along { (step, 1.0) } else { (0.0, 0.0) };
                Dual::new(self.value(state, symbol) + moved, slope)
            });
            values.into_iter().map(|root| root.derivative).collect()
        };
        let jump = |along: Symbol, step: f64| -> (f64, f64) {
            let (above, below) = (slopes(along, step), slopes(along, -step));
            let pairs = || above.iter().zip(&below);
            (pairs().map(|(a, b)| (a - b).abs()).sum(), pairs().map(|(a, b)| a.abs() + b.abs()).sum())
        };
        self.symbols(&fault.arguments).into_iter().any(|symbol| {
            let ((wide, _), (narrow, size)) = (jump(symbol, 1e-6), jump(symbol, 1e-9));
            narrow > 0.5 * wide && narrow > 1e-9 * size
        })
    }

    /// Whether the second derivatives are the same on both sides, and another by rule at the corner, where `signum`
    /// is 0.
    pub(in crate::model) fn has_gap(&self, fault: &Fault, state: &State) -> bool {
        let tape = self.tape_of(fault.group);
        let curvature = |along: Symbol, step: f64| -> f64 {
            let values = tape.run(|symbol| {
                let (moved, slope) = if symbol == along { (step, 1.0) } else { (0.0, 0.0) };
                let value = Dual::new(self.value(state, symbol) + moved, slope);
                Dual::new(value, Dual::fixed(slope))
            });
            values.into_iter().map(|root| root.derivative.derivative).sum()
        };
        self.symbols(&fault.arguments).into_iter().any(|symbol| {
            let [below, at, above] = [-1e-6, 0.0, 1e-6].map(|step| curvature(symbol, step));
            let size = below.abs() + above.abs();
            (below - above).abs() < 1e-3 * size && (at - below).abs() > 0.1 * size
        })
    }
}
