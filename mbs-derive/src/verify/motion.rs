//! The motion with constraints at one state, and its derivatives: the system is factorized, and its rounding bounded,
//! once.

use crate::expr::{Dual, Rounded, Solutions, Terms, Value, remainder, remainder_sizes};
use crate::interpret::System;

/// q̈ and λ, and what solves their system.
pub(super) struct Motion<'a> {
    solve: Solutions<'a, Rounded>,
    solution: Vec<Rounded>,
}

impl Motion<'_> {
    pub(super) fn new(n: usize, system: System<Rounded>, vectors: &[usize]) -> Self {
        let solve = Rounded::constrained_columns(n, system.mass, system.jacobian, vectors);
        let solution = solve(&[system.right_side], &Terms::default()).remove(0);
        Motion { solve, solution }
    }

    /// The derivative of q̈ along that of the system: from `K x = b` follows `K x′ = b′ − K′ x`.
    pub(super) fn slope(&self, n: usize, system: &System<Dual<Rounded>>) -> Vec<Rounded> {
        let rate = |numbers: &[Dual<Rounded>]| numbers.iter().map(|v| v.derivative).collect::<Vec<_>>();
        let [mass, jacobian, right_side] = [&system.mass, &system.jacobian, &system.right_side].map(|v| rate(v));
        let rest = remainder(&mass, &jacobian, &right_side, &self.solution, n);
        let sizes = vec![remainder_sizes(&jacobian, &right_side, &self.solution, n)];
        let mut rates = (self.solve)(&[rest], &Terms { sizes, ..Terms::default() }).remove(0);
        rates.truncate(n);
        rates
    }
}
