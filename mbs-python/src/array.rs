//! NumPy's arrays as slices.
#![allow(unsafe_code)] // NumPy's memory is shared with Python: nothing but NumPy's own rules says who may write to it

use std::ffi::c_int;

use numpy::npyffi::array::PyArray_Check;
use numpy::npyffi::flags::{NPY_ARRAY_ALIGNED, NPY_ARRAY_C_CONTIGUOUS};
use numpy::npyffi::objects::PyArrayObject;
use numpy::npyffi::types::NPY_TYPES;
use numpy::npyffi::{PY_ARRAY_API, npy_intp};
use numpy::{Element, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::refused;

/// An array of doubles that lie row by row, which is kept alive.
pub(crate) struct Input<'py> {
    shape: &'py [usize],
    values: &'py [f64],
    _owner: Bound<'py, PyAny>,
}

impl<'py> Input<'py> {
    /// The argument `name`: as it is, where it is an array of this kind already, else converted.
    pub(crate) fn of(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        match Input::seen(value) {
            Some(input) => Ok(input),
            None => converted(name, value),
        }
    }

    /// An array as it is: its header is read, which is a tenth of what NumPy's functions take.
    fn seen(value: &Bound<'py, PyAny>) -> Option<Self> {
        const PLAIN: i32 = NPY_ARRAY_ALIGNED | NPY_ARRAY_C_CONTIGUOUS;
        // SAFETY: Python is attached; of an array the header may be read. Numbers and shape stay where they are while
        // the array is held: NumPy does not resize what others hold. Whoever writes to it from another thread
        // meanwhile gets what NumPy's own functions would give him.
        unsafe {
            if PyArray_Check(value.py(), value.as_ptr()) == 0 {
                return None;
            }
            let array = &(*value.as_ptr().cast::<PyArrayObject>()).fields;
            let kind = &(*array.descr).fields;
            let is_plain = kind.type_num == NPY_TYPES::NPY_DOUBLE as i32 && kind.byteorder as u8 == b'=';
            if !is_plain || array.flags & PLAIN != PLAIN {
                return None;
            }
            let shape: &[usize] = match array.nd {
                0 => &[],
                axes => std::slice::from_raw_parts(array.dimensions.cast::<usize>(), axes as usize),
            };
            let count = shape.iter().product();
            let values: &[f64] = match count {
                0 => &[],
                count => std::slice::from_raw_parts(array.data.cast::<f64>(), count),
            };
            Some(Input { shape, values, _owner: value.clone() })
        }
    }

    pub(crate) fn shape(&self) -> &[usize] {
        self.shape
    }

    pub(crate) fn values(&self) -> &[f64] {
        self.values
    }
}

/// By NumPy; what is no real number is refused.
fn converted<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Input<'py>> {
    let py = value.py();
    let numpy = py.import(intern!(py, "numpy"))?;
    // Ctrl+C and a lack of memory are no faults of the argument.
    let wrong = |error: PyErr| match is_of_argument(&error, py) {
        true => refused(format!("{name}: {}", error.value(py))),
        false => error,
    };
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
    Input::seen(&array).ok_or_else(|| refused(format!("{name}: NumPy does not make an array of doubles of it")))
}

/// Whether NumPy says that a value is no array of numbers.
fn is_of_argument(error: &PyErr, py: Python<'_>) -> bool {
    error.is_instance_of::<PyValueError>(py)
        || error.is_instance_of::<PyTypeError>(py)
        || error.is_instance_of::<PyOverflowError>(py)
}

/// A new array of zeros, or NumPy's error: there is not enough memory, or there are too many axes.
pub(crate) fn zeros<'py>(py: Python<'py>, shape: &[usize]) -> PyResult<Output<'py>> {
    let refuse = || refused(format!("an array of the shape {shape:?} is too large"));
    let mut lengths =
        shape.iter().map(|&n| npy_intp::try_from(n)).collect::<Result<Vec<_>, _>>().map_err(|_| refuse())?;
    let axes = c_int::try_from(lengths.len()).map_err(|_| refuse())?;
    let kind = f64::get_dtype(py).into_dtype_ptr();
    // SAFETY: as many lengths as axes; NumPy takes the type over, and answers a new array of it, or null and an error.
    unsafe {
        let array = PY_ARRAY_API.PyArray_Zeros(py, axes, lengths.as_mut_ptr(), kind, 0);
        Ok(Output(Bound::from_owned_ptr_or_err(py, array)?.cast_into_unchecked()))
    }
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
pub(crate) fn copied<'py>(py: Python<'py>, shape: &[usize], values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    let mut array = zeros(py, shape)?;
    array.values().copy_from_slice(values);
    Ok(array.finished())
}
