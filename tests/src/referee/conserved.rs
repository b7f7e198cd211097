//! First integrals: along the motion of the referee, without inputs and dissipation, they may not change.

use mbs_derive::expr::Dual;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function};

/// By how much a first integral changes, of what its parts change by, that is no rounding.
const DRIFT: f64 = 1e-11;

/// What one number of the state is changed in.
type Seed<'s> = Box<dyn Fn(&mut State<Dual<f64>>) + 's>;

/// Compares each rate of change with the sum of the magnitudes of its parts.
///
/// # Errors
/// Which first integral changes, and how fast.
pub(super) fn unchanged(
    derivation: &Derivation,
    function: &Function,
    names: &[String],
    parameters: &[f64],
    state: &State,
) -> Result<(), String> {
    let parameters = parameters.iter().map(|&p| Dual::fixed(p)).collect();
    let interpreter = Interpreter::with_parameters(derivation, parameters);
    let (mut rates, mut parts) = (vec![0.0; names.len()], vec![0.0; names.len()]);
    for seed in seeds(state) {
        let mut moving = lifted(state);
        seed(&mut moving);
        for (i, value) in interpreter.evaluate(function, &moving).iter().enumerate() {
            rates[i] += value.derivative;
            parts[i] += value.derivative.abs();
        }
    }
    for ((rate, parts), name) in rates.iter().zip(&parts).zip(names) {
        if rate.abs() > DRIFT * parts {
            return Err(format!("{name} changes by {rate:e} in a second, of parts of {parts:e}"));
        }
    }
    Ok(())
}

fn lifted(state: &State) -> State<Dual<f64>> {
    let all = |values: &[f64]| values.iter().map(|&x| Dual::fixed(x)).collect::<Vec<_>>();
    State {
        t: Dual::fixed(state.t),
        q: all(&state.q),
        qd: all(&state.qd),
        qdd: all(&state.qdd),
        u: all(&state.u),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Dual::fixed)).collect(),
    }
}

/// Each number of the state with its rate.
fn seeds(state: &State) -> Vec<Seed<'_>> {
    let mut seeds: Vec<Seed<'_>> = vec![Box::new(|moving| moving.t.derivative = 1.0)];
    for (i, (&rate, &second)) in state.qd.iter().zip(&state.qdd).enumerate() {
        seeds.push(Box::new(move |moving| moving.q[i].derivative = rate));
        seeds.push(Box::new(move |moving| moving.qd[i].derivative = second));
    }
    for (i, &[_, rate, second]) in state.prescribed.iter().enumerate() {
        seeds.push(Box::new(move |moving| moving.prescribed[i][0].derivative = rate));
        seeds.push(Box::new(move |moving| moving.prescribed[i][1].derivative = second));
    }
    seeds
}
