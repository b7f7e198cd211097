//! One function at many states: compiled where it is, else interpreted; on several threads where that pays.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::{self, Derivation};
use mbs_native::{Instance, Kind, Library};
use pyo3::prelude::*;

use crate::function::Argument;
use crate::refused;

/// Numbers of each argument of a function, and how many further those of the next state are: 0 where all share them.
pub(crate) type Arguments<'a> = [(&'a [f64], usize)];

/// Arguments of a function, at most.
const MOST: usize = 8;

/// How many threads may be used; 0: as many as the machine has.
static THREADS: AtomicUsize = AtomicUsize::new(0);

/// Sets how many threads large batches may take; 0 for as many as the machine has.
#[pyfunction]
pub(crate) fn set_threads(count: usize) -> PyResult<()> {
    const MOST: usize = 4096;
    if count > MOST {
        return Err(refused(format!("count: {count} threads are more than {MOST}")));
    }
    THREADS.store(count, Ordering::Relaxed);
    Ok(())
}

/// How many threads large batches may take.
#[pyfunction]
pub(crate) fn threads() -> usize {
    match THREADS.load(Ordering::Relaxed) {
        0 => thread::available_parallelism().map_or(1, usize::from),
        count => count,
    }
}

/// Parameters, and what compiled code makes of them.
pub(crate) struct Values {
    pub(crate) parameters: Vec<f64>,
    instance: Option<Instance>,
}

/// Programs, and compiled code of them where there is some.
pub(crate) struct Engine {
    pub(crate) derivation: Derivation,
    pub(crate) library: Option<Library>,
    arguments: Vec<Vec<Argument>>,
}

impl Engine {
    pub(crate) fn new(derivation: Derivation, library: Option<Library>) -> Self {
        let numbers = 0..derivation.functions.len();
        let arguments = numbers.map(|number| crate::function::arguments(&derivation, number)).collect();
        Engine { derivation, library, arguments }
    }

    /// With these parameters, which have been looked at.
    pub(crate) fn values(&self, parameters: Vec<f64>) -> Values {
        let instance = self.library.as_ref().and_then(|library| library.instance(&parameters).ok());
        Values { parameters, instance }
    }

    /// Whether the function with this number is compiled.
    pub(crate) fn is_compiled(&self, number: usize) -> bool {
        self.library.as_ref().is_some_and(|library| library.has(number))
    }

    /// Fills the results, one slice for each part, of `count` states.
    pub(crate) fn evaluate(
        &self,
        number: usize,
        values: &Values,
        arguments: &Arguments<'_>,
        count: usize,
        results: &mut [&mut [f64]],
    ) {
        let threads = self.worthwhile(number, count);
        if threads < 2 {
            return self.run(number, values, arguments, 0, count, results);
        }
        let (each, sizes) = (count.div_ceil(threads), self.sizes(number));
        let mut rest: Vec<&mut [f64]> = results.iter_mut().map(|result| &mut **result).collect();
        thread::scope(|scope| {
            for first in (0..count).step_by(each) {
                let count = each.min(count - first);
                let mut parts: Vec<&mut [f64]> = Vec::new();
                for (result, size) in rest.iter_mut().zip(&sizes) {
                    let (part, behind) = std::mem::take(result).split_at_mut(count * size);
                    parts.push(part);
                    *result = behind;
                }
                scope.spawn(move || self.run(number, values, arguments, first, count, &mut parts));
            }
        });
    }

    /// As many threads as have a tenth of a millisecond to do each, by the operations of the program.
    fn worthwhile(&self, number: usize, count: usize) -> usize {
        const LEAST: usize = 100_000;
        if count < 2 {
            return 1;
        }
        let function = &self.derivation.functions[number];
        let cost = if self.is_compiled(number) { 1 } else { 30 };
        let work = count.saturating_mul(cost * (function.program.instructions.len() + 10));
        threads().min(work / LEAST).min(count)
    }

    fn sizes(&self, number: usize) -> Vec<usize> {
        self.derivation.functions[number].results.iter().map(|part| part.shape.entries()).collect()
    }

    fn run(
        &self,
        number: usize,
        values: &Values,
        arguments: &Arguments<'_>,
        first: usize,
        count: usize,
        results: &mut [&mut [f64]],
    ) {
        if let Some(instance) = &values.instance
            && instance.has(number)
        {
            let mut operands: [(&[f64], usize); MOST] = [(&[], 0); MOST];
            for (operand, (data, stride)) in operands.iter_mut().zip(arguments) {
                *operand = (&data[(first * stride).min(data.len())..], *stride);
            }
            // What does not fit has been refused before; the interpreter would say where.
            if instance.call(number, &operands[..arguments.len()], count, results).is_ok() {
                return;
            }
        }
        let (derivation, function) = (&self.derivation, &self.derivation.functions[number]);
        let interpreter = Interpreter::with_parameters(derivation, values.parameters.clone());
        let sizes = self.sizes(number);
        let mut state = self.state();
        for i in 0..count {
            let mut multipliers = None;
            for (argument, (data, stride)) in self.arguments[number].iter().zip(arguments) {
                let given = &data[(first + i) * stride..][..argument.count()];
                match argument.kind {
                    Kind::Time => state.t = given[0],
                    Kind::Prescribed => {
                        state
                            .prescribed
                            .iter_mut()
                            .zip(given.chunks(3))
                            .for_each(|(signal, x)| signal.copy_from_slice(x));
                    }
                    Kind::Of(optimise::Argument::Q) => state.q.copy_from_slice(given),
                    Kind::Of(optimise::Argument::Qd) => state.qd.copy_from_slice(given),
                    Kind::Of(optimise::Argument::Qdd) => state.qdd.copy_from_slice(given),
                    Kind::Of(optimise::Argument::U) => state.u.copy_from_slice(given),
                    Kind::Of(optimise::Argument::Multipliers) => multipliers = Some(given),
                }
            }
            let found = interpreter.evaluate_with(function, &state, multipliers.unwrap_or_default());
            let mut found = found.as_slice();
            for (result, size) in results.iter_mut().zip(&sizes) {
                let (part, behind) = found.split_at(*size);
                result[i * size..][..*size].copy_from_slice(part);
                found = behind;
            }
        }
    }

    fn state(&self) -> State {
        let count = |variables: &[mbs_derive::variable::Variable]| variables.iter().map(|v| v.count()).sum();
        let zeros = |n: usize| vec![0.0; n];
        let (n, derivation) = (self.derivation.dof(), &self.derivation);
        let prescribed = vec![[0.0; 3]; count(&derivation.prescribed)];
        State { t: 0.0, q: zeros(n), qd: zeros(n), qdd: zeros(n), u: zeros(count(&derivation.inputs)), prescribed }
    }
}
