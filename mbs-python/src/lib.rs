//! The extension module `mbs._mbs`: mechanisms derived, proved, compiled and simulated for Python.
//!
//! - [`core`]: a mechanism from its text, file or calls, and its parameters;
//! - [`builder`]: calls recorded by Python, made anew on `mbs_derive::builder`;
//! - [`native`]: where functions are kept that a C compiler makes at run time (`mbs_native`);
//! - [`engine`]: one function at one state or many, compiled or interpreted, on several threads;
//! - [`function`]: what Python calls: shapes, broadcasting, results;
//! - [`array`]: NumPy's memory; unsafe, because NumPy shares it;
//! - [`simulate`]: motions by `mbs_runtime`, with inputs, events and constraints.
//!
//! What Python users see is written in Python, in `python/mbs`.

mod array;
mod builder;
mod core;
mod engine;
mod function;
mod native;
mod simulate;

use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

mod errors {
    #![allow(missing_docs)] // the macro has no place for them
    pyo3::create_exception!(
        mbs,
        ModelError,
        pyo3::exceptions::PyValueError,
        "A model is wrong: where, and what to write instead."
    );
    pyo3::create_exception!(mbs, SimulationError, pyo3::exceptions::PyRuntimeError, "A motion cannot be continued.");
}
pub(crate) use errors::{ModelError, SimulationError};

/// What a wrong argument raises.
pub(crate) fn refused(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}

/// A panic is a mistake of ours, and an error of Python all the same.
pub(crate) fn guarded<T>(work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        Err(PyRuntimeError::new_err(format!("a mistake of mbs, please report it: {said}")))
    })
}

#[pymodule]
fn _mbs(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("ModelError", py.get_type::<ModelError>())?;
    module.add("SimulationError", py.get_type::<SimulationError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<core::Core>()?;
    module.add_class::<function::Function>()?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(engine::set_threads, module)?)?;
    module.add_function(wrap_pyfunction!(engine::threads, module)?)
}
