//! NumPy's arrays as slices.
#![allow(unsafe_code)] // NumPy's memory is shared with Python: nothing but NumPy's own rules says who may write to it

use numpy::npyffi::flags::NPY_ARRAY_ALIGNED;
use numpy::{IxDyn, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::refused;

/// An array of doubles that lie row by row, which is kept alive.
pub(crate) struct Input<'py>(Bound<'py, PyArrayDyn<f64>>);

impl<'py> Input<'py> {
    /// The argument `name`: as it is, where it is an array of this kind already, else converted.
    pub(crate) fn of(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = value.cast::<PyArrayDyn<f64>>() {
            // SAFETY: it is an array, and Python is attached, so its header may be read.
            let is_aligned = unsafe { (*array.as_array_ptr()).fields.flags & NPY_ARRAY_ALIGNED != 0 };
            if array.is_c_contiguous() && is_aligned {
                return Ok(Input(array.clone()));
            }
        }
        converted(name, value)
    }

    pub(crate) fn shape(&self) -> &[usize] {
        self.0.shape()
    }

    /// The numbers; whoever writes to the array from another thread while they are read gets what he deserves from
    /// NumPy's own functions, too.
    pub(crate) fn values(&self) -> &[f64] {
        // SAFETY: contiguous and aligned, as `of` has seen; alive, because it is held.
        unsafe { self.0.as_slice() }.unwrap_or_default()
    }
}

/// By NumPy; what is no real number is refused.
fn converted<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Input<'py>> {
    let py = value.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    let wrong = |error: PyErr| refused(format!("{name}: {}", error.value(py)));
    let array = numpy.call_method1(intern!(py, "asarray"), (value,)).map_err(wrong)?;
    let kind: String = array.getattr(intern!(py, "dtype"))?.getattr(intern!(py, "kind"))?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        let kind = array.getattr(intern!(py, "dtype"))?;
        return Err(refused(format!("{name}: real numbers are expected, found an array of {kind}")));
    }
    let settings = PyDict::new(py);
    settings.set_item("dtype", numpy.getattr(intern!(py, "float64"))?)?;
    settings.set_item("order", "C")?;
    settings.set_item("copy", true)?;
    let array = numpy.call_method(intern!(py, "array"), (array,), Some(&settings)).map_err(wrong)?;
    Ok(Input(array.cast_into::<PyArrayDyn<f64>>().map_err(|error| refused(format!("{name}: {error}")))?))
}

/// A new array of zeros.
pub(crate) fn zeros<'py>(py: Python<'py>, shape: &[usize]) -> Output<'py> {
    Output(PyArrayDyn::zeros(py, IxDyn(shape), false))
}

/// A new array that Python has not seen yet.
pub(crate) struct Output<'py>(Bound<'py, PyArrayDyn<f64>>);

impl<'py> Output<'py> {
    pub(crate) fn values(&mut self) -> &mut [f64] {
        // SAFETY: new, therefore contiguous, aligned and nobody else's.
        unsafe { self.0.as_slice_mut() }.unwrap_or_default()
    }

    pub(crate) fn finished(self) -> Bound<'py, PyAny> {
        self.0.into_any()
    }
}

/// A new array with these numbers.
pub(crate) fn copied<'py>(py: Python<'py>, shape: &[usize], values: &[f64]) -> Bound<'py, PyAny> {
    let mut array = zeros(py, shape);
    array.values().copy_from_slice(values);
    array.finished()
}
