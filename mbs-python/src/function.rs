//! What Python calls: arguments of any leading axes, results of the same.

use std::sync::{Arc, RwLock};

use mbs_derive::optimise::{self, FunctionKind, Shape};
use mbs_native::Kind;
pub(crate) use mbs_native::{Argument, arguments};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::array::{self, Input};
use crate::engine::{Engine, Values};
use crate::{guarded, refused};

/// The axes of a result behind the leading ones.
pub(crate) fn axes(shape: Shape) -> Vec<usize> {
    match shape {
        Shape::Scalar => Vec::new(),
        Shape::Vector(n) => vec![n],
        Shape::Matrix(rows, columns) => vec![rows, columns],
        Shape::Symmetric(n) => vec![n, n],
        Shape::Pose => vec![12],
        Shape::Wrench => vec![6],
        Shape::Wrenches(n) => vec![n, 6],
        Shape::Matrices(n, rows, columns) => vec![n, rows, columns],
        Shape::Poses(n) => vec![n, 12],
    }
}

/// One generated function, of one or many states.
#[pyclass(frozen, module = "mbs._mbs")]
pub(crate) struct Function {
    engine: Arc<Engine>,
    values: Arc<RwLock<Arc<Values>>>,
    number: usize,
    name: String,
    arguments: Vec<Argument>,
    /// Shape and size of each result.
    results: Vec<(Vec<usize>, usize)>,
    /// The function that gives multipliers where they are not given.
    multipliers: Option<Box<Function>>,
}

impl Function {
    pub(crate) fn new(engine: &Arc<Engine>, values: &Arc<RwLock<Arc<Values>>>, number: usize, name: &str) -> Self {
        let (derivation, arguments) = (&engine.derivation, arguments(&engine.derivation, number));
        let results = derivation.functions[number].results.iter();
        let results = results.map(|part| (axes(part.shape), part.shape.entries())).collect();
        let of_motion = derivation.functions.iter().position(|f| f.kind == FunctionKind::Multipliers);
        let takes = arguments.iter().any(|argument| argument.kind == Kind::Of(optimise::Argument::Multipliers));
        let multipliers = of_motion.filter(|_| takes);
        let multipliers = multipliers.map(|number| Box::new(Function::new(engine, values, number, "multipliers")));
        let (engine, values) = (Arc::clone(engine), Arc::clone(values));
        Function { engine, values, number, name: name.to_string(), arguments, results, multipliers }
    }

    fn called<'py>(&self, args: &Bound<'py, PyTuple>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let py = args.py();
        if args.len() != self.arguments.len() {
            let names: Vec<&str> = self.arguments.iter().map(|argument| argument.kind.name()).collect();
            let found = args.len();
            return Err(refused(format!("{}: expected the arguments {}, found {found}", self.name, names.join(", "))));
        }
        let mut found = None;
        let mut inputs = Vec::with_capacity(self.arguments.len());
        for (argument, value) in self.arguments.iter().zip(args.iter_borrowed()) {
            inputs.push(match &self.multipliers {
                Some(function) if value.is_none() => {
                    let given = function.arguments.iter().map(|needed| {
                        let place = self.arguments.iter().position(|own| own.kind == needed.kind);
                        place.map_or_else(|| Err(self.missing(function, needed)), |place| args.get_item(place))
                    });
                    let given = given.collect::<PyResult<Vec<_>>>()?;
                    let value = found.insert(function.called(&PyTuple::new(py, given)?)?.remove(0));
                    Input::of(argument.kind.name(), value)?
                }
                _ => Input::of(argument.kind.name(), &value)?,
            });
        }
        let batch = self.batch(&inputs, found.is_some())?;
        let count = size(&batch, &self.name)?;
        let mut copies: Vec<Vec<f64>> = Vec::new();
        if !batch.is_empty() {
            for (argument, input) in self.arguments.iter().zip(&inputs) {
                let (leading, n) = (leading(argument, input), argument.count());
                let is_as_it_is = input.values().len() == n || leading == batch;
                copies.push(if is_as_it_is { Vec::new() } else { spread(input.values(), leading, &batch, n)? });
            }
        }
        let mut operands: Vec<(&[f64], usize)> = Vec::with_capacity(inputs.len());
        for (i, (input, argument)) in inputs.iter().zip(&self.arguments).enumerate() {
            let copy = copies.get(i).filter(|copy| !copy.is_empty());
            let is_stepped = copy.is_some() || input.values().len() != argument.count();
            let values = copy.map_or(input.values(), Vec::as_slice);
            operands.push((values, if is_stepped { argument.count() } else { 0 }));
        }
        let shape = |axes: &Vec<usize>| [batch.as_slice(), axes].concat();
        let outputs = self.results.iter().map(|(axes, _)| array::zeros(py, &shape(axes)));
        let mut outputs = outputs.collect::<PyResult<Vec<_>>>()?;
        let mut results: Vec<&mut [f64]> = outputs.iter_mut().map(|output| output.values()).collect();
        let values = Arc::clone(&self.values.read().unwrap_or_else(|poisoned| poisoned.into_inner()));
        let engine = &self.engine;
        let mut run = || engine.evaluate(self.number, &values, &operands, count, &mut results);
        // Letting go of the interpreter costs more than a short function.
        if count > 16 || !engine.is_compiled(self.number) {
            py.detach(run)
        } else {
            run()
        }
        Ok(outputs.into_iter().map(array::Output::finished).collect())
    }

    /// Multipliers of the motion depend on what this function does not know.
    fn missing(&self, multipliers: &Function, needed: &Argument) -> PyErr {
        let arguments: Vec<&str> = multipliers.arguments.iter().map(|argument| argument.kind.name()).collect();
        refused(format!(
            "multipliers: those of the motion depend on `{}`, which {} does not take; give it multipliers({})",
            needed.kind.name(),
            self.name,
            arguments.join(", ")
        ))
    }

    /// The leading axes of the result; arguments are looked at.
    fn batch(&self, inputs: &[Input<'_>], multipliers_are_found: bool) -> PyResult<Vec<usize>> {
        let mut batch: Vec<usize> = Vec::new();
        for (argument, input) in self.arguments.iter().zip(inputs) {
            let (name, shape) = (argument.kind.name(), input.shape());
            if !shape.ends_with(&argument.shape) {
                let expected: Vec<String> = argument.shape.iter().map(|n| n.to_string()).collect();
                let expected = if expected.is_empty() { String::new() } else { format!(", {}", expected.join(", ")) };
                return Err(refused(format!(
                    "{name}: expected an array of the shape (...{expected}), found {shape:?} in {}",
                    self.name
                )));
            }
            // Those of the motion are NaN where there is none.
            let is_found = multipliers_are_found && name == "multipliers";
            if let Some(i) = input.values().iter().position(|x| !x.is_finite() && !is_found) {
                return Err(refused(format!("{name}: entry {i} is {}, in {}", input.values()[i], self.name)));
            }
            let leading = leading(argument, input);
            let missing = leading.len().saturating_sub(batch.len());
            batch.splice(0..0, std::iter::repeat_n(1, missing));
            let offset = batch.len() - leading.len();
            for (own, given) in batch[offset..].iter_mut().zip(leading) {
                match (*own, *given) {
                    (a, b) if a == b || b == 1 => {}
                    (1, b) => *own = b,
                    (a, b) => {
                        return Err(refused(format!(
                            "{name}: its leading axes {leading:?} do not go with those of the arguments before it, \
                             {b} is not {a}, in {}",
                            self.name
                        )));
                    }
                }
            }
        }
        Ok(batch)
    }
}

#[pymethods]
impl Function {
    #[pyo3(signature = (*args))]
    fn __call__<'py>(&self, args: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
        let py = args.py();
        let mut results = guarded(|| self.called(args))?;
        if results.len() > 1 {
            return Ok(PyTuple::new(py, results)?.into_any());
        }
        let result = results.remove(0);
        if self.results[0].0.is_empty() { scalar(result) } else { Ok(result) }
    }

    fn __repr__(&self) -> String {
        let how = if self.engine.is_compiled(self.number) { "compiled" } else { "interpreted" };
        format!("<{how} function {} of {}>", self.name, self.engine.derivation.name)
    }

    /// Whether a C compiler has made it.
    #[getter]
    fn is_compiled(&self) -> bool {
        self.engine.is_compiled(self.number)
    }
}

/// An array without axes as a number, others as they are.
fn scalar(result: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    let input = Input::of("result", &result)?;
    match (input.shape(), input.values()) {
        ([], [x]) => Ok(x.into_pyobject(result.py())?.into_any()),
        _ => Ok(result),
    }
}

fn leading<'a>(argument: &Argument, input: &'a Input<'_>) -> &'a [usize] {
    &input.shape()[..input.shape().len() - argument.shape.len()]
}

fn size(batch: &[usize], name: &str) -> PyResult<usize> {
    const MOST: usize = 1 << 40;
    let size = batch.iter().try_fold(1_usize, |size, &n| size.checked_mul(n)).filter(|size| *size < MOST);
    size.ok_or_else(|| refused(format!("{name}: {batch:?} are too many states")))
}

/// An argument of these leading axes, repeated to those of the batch; each entry has `n` numbers.
fn spread(values: &[f64], leading: &[usize], batch: &[usize], n: usize) -> PyResult<Vec<f64>> {
    let axes = batch.len();
    let own = |axis: usize| (axis + leading.len()).checked_sub(axes).map_or(1, |i| leading[i]);
    let mut strides = vec![0; axes];
    let mut stride = n;
    for axis in (0..axes).rev() {
        strides[axis] = if own(axis) == 1 { 0 } else { stride };
        stride *= own(axis);
    }
    let count = batch.iter().product::<usize>();
    let mut spread = Vec::new();
    let reserved = spread.try_reserve_exact(count * n);
    reserved.map_err(|_| PyMemoryError::new_err(format!("there is no memory for {count} states of {n} numbers")))?;
    let mut index = vec![0; axes];
    for _ in 0..count {
        let start: usize = index.iter().zip(&strides).map(|(i, stride)| i * stride).sum();
        spread.extend_from_slice(&values[start..start + n]);
        for axis in (0..axes).rev() {
            index[axis] += 1;
            if index[axis] < batch[axis] {
                break;
            }
            index[axis] = 0;
        }
    }
    Ok(spread)
}
