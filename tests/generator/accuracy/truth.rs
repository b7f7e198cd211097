//! What was declared, over 200 bits: the energies as written, and Lagrange's equations from them by nested dual
//! numbers.

use mbs_derive::expr::{Dual, Symbol, Value};
use mbs_derive::interpret::State;
use mbs_derive::verify::Witness;

use super::measure::exact::Exact;

/// T, V and `d/dt ∂L/∂q̇ − ∂L/∂q + ∂D/∂q̇`.
pub(crate) struct Truth {
    pub(crate) kinetic_energy: Exact,
    pub(crate) potential_energy: Exact,
    pub(crate) inverse_dynamics: Vec<Exact>,
}

impl Truth {
    pub(crate) fn at(witness: &Witness<'_, '_>, state: &State<Exact>, parameters: &[Exact]) -> Self {
        let [_, kinetic_energy, potential_energy, _] = witness.energies(state, parameters);
        let once: Vec<_> = parameters.iter().map(|&p| Dual::fixed(p)).collect();
        let twice: Vec<_> = once.iter().map(|&p| Dual::fixed(p)).collect();
        // ε along the motion, δ along a coordinate or its velocity.
        let along_path = state.along(|symbol| path(state, symbol));
        let one_if = |holds: bool| Exact::constant(f64::from(u8::from(holds)));
        let equation = |i: u32| {
            let in_velocity = |symbol| Dual::fixed(one_if(symbol == Symbol::Velocity(i)));
            let [l, _, _, d] = witness.energies(&along_path.along(in_velocity), &twice);
            let in_coordinate = |symbol| one_if(symbol == Symbol::Coordinate(i));
            let [varied, ..] = witness.energies(&state.along(in_coordinate), &once);
            l.derivative.derivative.sub(varied.derivative).add(d.derivative.value)
        };
        let inverse_dynamics = (0..state.q.len() as u32).map(equation).collect();
        Truth { kinetic_energy, potential_energy, inverse_dynamics }
    }
}

/// How the symbols change along the motion.
fn path(state: &State<Exact>, symbol: Symbol) -> Exact {
    match symbol {
        Symbol::Time => Exact::constant(1.0),
        Symbol::Coordinate(i) => state.qd[i as usize],
        Symbol::Velocity(i) => state.qdd[i as usize],
        Symbol::Prescribed(i, order @ (0 | 1)) => state.prescribed[i as usize][usize::from(order) + 1],
        // A third derivative is nowhere needed.
        Symbol::Prescribed(..) => Exact::constant(f64::NAN),
        Symbol::Acceleration(_) | Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Multiplier(_) => {
            Exact::constant(0.0)
        }
    }
}
