//! Whether every motion has inertia at a state.

use crate::catalogue::FunctionKind as Kind;
use crate::expr::{Number, Residue, Value};
use crate::interpret::{Interpreter, State};
use crate::numeric::echelon::Echelon;
use crate::optimise::{Derivation, Instruction};

use super::Failure;
use super::claim::Trial;

/// Whether some motion that the constraints allow has no inertia there; none has a negative one.
///
/// Of long chains M is not there: their accelerations are finite at all states that count.
///
/// Pivots tell where they are larger than rounding. Where they are not, the rank is found in a finite field, at points
/// that are zero where the state is.
pub(super) fn is_singular(trial: &Trial<'_>, state: &State, parameters: &[f64]) -> Result<bool, Failure> {
    if trial.derivation().function(Kind::MassMatrix).is_none() {
        return Ok(false);
    }
    let [(whole, rounding), allowed] = trial.inertia();
    if whole.smallest < -rounding.max(1e-9) {
        return Err(Failure::NegativeInertia { q: state.q.clone() });
    }
    let (on_allowed_motions, rounding) = allowed;
    if on_allowed_motions.smallest > rounding {
        return Ok(false);
    }
    Ok(is_singular_in_fields(trial.derivation(), state, parameters))
}

/// Whether a motion has no inertia at the state of a trial: M is singular to rounding, and in a finite field.
pub(super) fn is_undetermined(trial: &Trial<'_>, state: &State, parameters: &[f64]) -> bool {
    let [_, (on_allowed_motions, rounding)] = trial.inertia();
    on_allowed_motions.smallest.abs() <= rounding && is_singular_in_fields(trial.derivation(), state, parameters)
}

fn is_singular_in_fields(derivation: &Derivation, state: &State, parameters: &[f64]) -> bool {
    let first = is_singular_in_field::<0>(derivation, state, parameters);
    let second = is_singular_in_field::<1>(derivation, state, parameters);
    first.unwrap_or(true) && second.unwrap_or(true)
}

/// `None` where a constant is not exact, or nothing has a value.
fn is_singular_in_field<const K: usize>(derivation: &Derivation, state: &State, parameters: &[f64]) -> Option<bool> {
    const TRIED: u64 = 32;
    let functions =
        || [Kind::MassMatrix, Kind::ConstraintJacobian].into_iter().filter_map(|kind| derivation.function(kind));
    let programs = functions().map(|f| &f.program);
    let is_rounded = |i: &Instruction| matches!(i, Instruction::Constant(Number::Real { .. }));
    if programs.chain([&derivation.constructor]).flat_map(|program| &program.instructions).any(is_rounded) {
        return None;
    }
    let parameters: Vec<Residue<K>> = parameters.iter().map(|&value| Residue::constant(value)).collect();
    let interpreter = Interpreter::with_parameters(derivation, parameters);
    (0..TRIED).find_map(|point| {
        let n = derivation.dof();
        let state = in_field(state, point);
        let rows = functions().flat_map(|f| interpreter.evaluate(f, &state)).collect::<Vec<_>>();
        Echelon::of(rows.chunks(n).map(<[Residue<K>]>::to_vec).collect()).map(|echelon| echelon.rank() < n)
    })
}

/// Numbers without relations, but for zeros.
fn in_field<const K: usize>(state: &State, point: u64) -> State<Residue<K>> {
    let mut key = point << 32;
    let mut number = |value: f64| {
        key += 1;
        if value == 0.0 { Residue::constant(0.0) } else { Residue::random(key) }
    };
    State {
        t: number(state.t),
        q: state.q.iter().map(|&value| number(value)).collect(),
        qd: state.qd.iter().map(|&value| number(value)).collect(),
        qdd: state.qdd.iter().map(|&value| number(value)).collect(),
        u: state.u.iter().map(|&value| number(value)).collect(),
        prescribed: state.prescribed.iter().map(|signal| signal.map(&mut number)).collect(),
    }
}
