//! The motion with constraints at one state, and its derivatives: the system is factorized, and its rounding bounded,
//! once.

use crate::expr::{Dual, Solutions, Terms, Value, remainder, remainder_sizes};
use crate::interpret::System;

/// q̈ and λ, and what solves their system.
pub(super) struct Motion<'a, V> {
    solve: Solutions<'a, V>,
    solution: Vec<V>,
}

impl<'a, V: Value + 'a> Motion<'a, V> {
    pub(super) fn new(n: usize, system: System<V>, vectors: &[usize]) -> Self {
        let solve = V::constrained_columns(n, system.mass, system.jacobian, vectors);
        let solution = solve(&[system.right_side], &none()).remove(0);
        Motion { solve, solution }
    }

    /// The derivative of q̈ along that of the system: from `K x = b` follows `K x′ = b′ − K′ x`.
    pub(super) fn slope(&self, n: usize, system: &System<Dual<V>>) -> Vec<V> {
        let rate = |numbers: &[Dual<V>]| numbers.iter().map(|v| v.derivative).collect::<Vec<_>>();
        let [mass, jacobian, right_side] = [&system.mass, &system.jacobian, &system.right_side].map(|v| rate(v));
        let rest = remainder(&mass, &jacobian, &right_side, &self.solution, n);
        let sizes = vec![remainder_sizes(&jacobian, &right_side, &self.solution, n)];
        let mut rates = (self.solve)(&[rest], &Terms { sizes, ..none() }).remove(0);
        rates.truncate(n);
        rates
    }
}

fn none<V>() -> Terms<V> {
    Terms { sizes: Vec::new(), motion: Vec::new(), scales: Vec::new() }
}
