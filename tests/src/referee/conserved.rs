//! First integrals: along the motion of the referee, without inputs and dissipation, they may not change.

use mbs_derive::expr::Dual;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{Derivation, Function};

/// By how much a first integral changes, of what its parts change by, that is no rounding.
const DRIFT: f64 = 1e-11;

/// Sets the derivative of one number.
type Change<'s> = Box<dyn Fn(&mut State<Dual<f64>>) + 's>;

/// What one number of the state is changed in, how fast it changes, and the size of the terms that its rate is made of.
struct Seed<'s> {
    change: Change<'s>,
    rate: f64,
    size: f64,
}

impl<'s> Seed<'s> {
    fn new(rate: f64, size: f64, change: impl Fn(&mut State<Dual<f64>>) + 's) -> Self {
        Seed { change: Box::new(change), rate, size }
    }
}

/// Compares each rate of change with the sum of the magnitudes of its parts; `sizes` are those of the accelerations.
///
/// # Errors
/// Which first integral changes, and how fast.
pub(super) fn unchanged(
    derivation: &Derivation,
    function: &Function,
    names: &[String],
    parameters: &[f64],
    state: &State,
    sizes: &[f64],
) -> Result<(), String> {
    let parameters = parameters.iter().map(|&p| Dual::fixed(p)).collect();
    let interpreter = Interpreter::with_parameters(derivation, parameters);
    let (mut rates, mut parts) = (vec![0.0; names.len()], vec![0.0; names.len()]);
    for seed in seeds(state, sizes) {
        let mut moving = state.along(|_| 0.0);
        (seed.change)(&mut moving);
        for (i, value) in interpreter.evaluate(function, &moving).iter().enumerate() {
            rates[i] += value.derivative * seed.rate;
            parts[i] += value.derivative.abs() * seed.size;
        }
    }
    for ((rate, parts), name) in rates.iter().zip(&parts).zip(names) {
        if rate.abs() > DRIFT * parts {
            return Err(format!("{name} changes by {rate:e} in a second, of parts of {parts:e}"));
        }
    }
    Ok(())
}

/// Each number of the state with its rate.
fn seeds<'s>(state: &State, sizes: &[f64]) -> Vec<Seed<'s>> {
    let mut seeds = vec![Seed::new(1.0, 1.0, |moving| moving.t.derivative = 1.0)];
    for (i, (&rate, &second)) in state.qd.iter().zip(&state.qdd).enumerate() {
        seeds.push(Seed::new(rate, rate.abs(), move |moving| moving.q[i].derivative = 1.0));
        seeds.push(Seed::new(second, sizes[i], move |moving| moving.qd[i].derivative = 1.0));
    }
    for (i, &[_, rate, second]) in state.prescribed.iter().enumerate() {
        seeds.push(Seed::new(rate, rate.abs(), move |moving| moving.prescribed[i][0].derivative = 1.0));
        seeds.push(Seed::new(second, second.abs(), move |moving| moving.prescribed[i][1].derivative = 1.0));
    }
    seeds
}
