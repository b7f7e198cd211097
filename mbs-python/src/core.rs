//! A mechanism: derived, proved, compiled; its parameters; and what there is to say of it.

use std::sync::{Arc, Mutex, PoisonError, RwLock};

use mbs_derive::builder::Mechanism;
use mbs_derive::expr::{Graph, Number};
use mbs_derive::interpret::Violation;
use mbs_derive::optimise::{Derivation, Shape};
use mbs_derive::source::{Source, Sources, Unreadable};
use mbs_derive::variable::{Variable, component_names};
use mbs_derive::{Analysis, Error, emit};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::array::{self, Input};
use crate::engine::{Engine, Values};
use crate::function::{self, Function};
use crate::native;
use crate::{ModelError, builder, guarded, refused};

/// A mechanism with values for its parameters.
#[pyclass(frozen, module = "mbs._mbs")]
pub(crate) struct Core {
    pub(crate) engine: Arc<Engine>,
    pub(crate) values: Arc<RwLock<Arc<Values>>>,
    about: Arc<About>,
}

/// What was said of it when it was derived.
struct About {
    /// Names of the functions, and what their documentation says.
    functions: Vec<(String, Vec<String>)>,
    warnings: String,
    latex: String,
    /// Why it is not compiled.
    reason: Option<String>,
    proved_at: usize,
    /// Names and texts of its files, its own first; none where calls have written it.
    texts: Vec<(String, String)>,
}

/// What a mechanism is written as.
enum Written {
    Text(Sources),
    Calls(Box<Mechanism>),
}

impl Written {
    fn sources(&self) -> Sources {
        match self {
            Written::Text(sources) => sources.clone(),
            Written::Calls(mechanism) => mechanism.sources(),
        }
    }
}

/// Which mechanism was derived from texts.
#[derive(PartialEq)]
struct Derived {
    sources: Sources,
    freeze: Vec<String>,
    backend: Backend,
    surroundings: native::Surroundings,
}

/// The last that were derived in this process, the latest at the end.
static KEPT: Mutex<Vec<(Derived, Core)>> = Mutex::new(Vec::new());

/// More of them are not kept.
const MOST_KEPT: usize = 16;

impl Core {
    /// From texts, unless it is known from before; with the declared parameters.
    fn of_texts(sources: Sources, freeze: Vec<String>, backend: Backend) -> PyResult<Self> {
        let wanted = Derived { sources, freeze, backend, surroundings: native::surroundings() };
        let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        {
            let mut kept = kept();
            if let Some(place) = kept.iter().position(|(derived, _)| *derived == wanted) {
                let latest = kept.remove(place);
                let core = latest.1.copy();
                kept.push(latest);
                return Ok(core);
            }
        }
        let core = Core::of(&Written::Text(wanted.sources.clone()), &wanted.freeze, backend)?;
        // Where a compiler failed, it is asked again.
        if core.about.reason.is_none() || backend == Backend::Interpreter {
            let mut kept = kept();
            if kept.len() == MOST_KEPT {
                kept.remove(0);
            }
            kept.push((wanted, core.copy()));
        }
        Ok(core)
    }

    fn of(written: &Written, freeze: &[String], backend: Backend) -> Result<Self, PyErr> {
        let graph = Graph::verbatim();
        let wrong = |error: Error| ModelError::new_err(error.render_in(&written.sources()));
        let analysis = match written {
            Written::Text(sources) => Analysis::frozen(sources, &graph, freeze),
            Written::Calls(mechanism) => Analysis::written(mechanism, &graph, freeze),
        };
        let analysis = analysis.map_err(wrong)?;
        let proof = analysis.prove(analysis.programs()).map_err(wrong)?;
        let warnings = analysis.warnings(Some(&proof)).render_in(&written.sources());
        let latex = analysis.latex();
        let derivation = analysis.into_programs();
        let (library, reason) = match backend {
            Backend::Interpreter => (None, Some("the interpreter was asked for".to_string())),
            Backend::Auto | Backend::C => match native::library(&derivation) {
                Ok(library) => (Some(library), None),
                Err(reason) => (None, Some(reason)),
            },
        };
        if let (Backend::C, Some(reason)) = (backend, &reason) {
            return Err(PyRuntimeError::new_err(format!("not compiled: {reason}")));
        }
        let functions = emit::Language::documented(&derivation);
        let read = |file: &Source| Some((file.name.clone(), file.text.clone().ok()?));
        let texts = match written {
            Written::Text(sources) => (0..sources.count()).filter_map(|number| read(sources.file(number))).collect(),
            Written::Calls(_) => Vec::new(),
        };
        let about = About { functions, warnings, latex, reason, proved_at: proof.states, texts };
        let parameters = &derivation.parameters;
        let defaults = parameters.iter().flat_map(|p| &p.defaults).copied().map(Number::to_f64).collect();
        let engine = Engine::new(derivation, library);
        let values = engine.values(defaults);
        Ok(Core { engine: Arc::new(engine), values: Arc::new(RwLock::new(Arc::new(values))), about: Arc::new(about) })
    }

    pub(crate) fn derivation(&self) -> &Derivation {
        &self.engine.derivation
    }

    pub(crate) fn current(&self) -> Arc<Values> {
        Arc::clone(&self.values.read().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Backend {
    Auto,
    C,
    Interpreter,
}

fn backend(name: &str) -> PyResult<Backend> {
    match name {
        "auto" => Ok(Backend::Auto),
        "c" => Ok(Backend::C),
        "interpreter" => Ok(Backend::Interpreter),
        _ => Err(refused(format!("backend: {name:?} is none of \"auto\", \"c\", \"interpreter\""))),
    }
}

#[pymethods]
impl Core {
    /// From a text.
    #[staticmethod]
    fn from_text(py: Python<'_>, text: &str, name: &str, freeze: Vec<String>, backend: &str) -> PyResult<Self> {
        let backend = self::backend(backend)?;
        py.detach(|| guarded(|| Core::of_texts(Sources::new(name, text), freeze, backend)))
    }

    /// From a file, and those that it imports.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: std::path::PathBuf, freeze: Vec<String>, backend: &str) -> PyResult<Self> {
        let backend = self::backend(backend)?;
        py.detach(|| {
            guarded(|| {
                let sources = mbs_derive::read(&path).map_err(ModelError::new_err)?;
                Core::of_texts(sources, freeze, backend)
            })
        })
    }

    /// From the [texts](Core::texts) of another one: no file is read.
    #[staticmethod]
    fn from_texts(py: Python<'_>, texts: Vec<(String, String)>, freeze: Vec<String>, backend: &str) -> PyResult<Self> {
        let backend = self::backend(backend)?;
        let [(name, text), imported @ ..] = texts.as_slice() else { return Err(refused("texts: the list is empty")) };
        let read = |name: &str| match imported.iter().find(|(own, _)| own == name) {
            Some((_, text)) => Ok(text.clone().into_bytes()),
            None => Err(Unreadable::new("it is not among the texts", "compile the mechanism from its file")),
        };
        py.detach(|| guarded(|| Core::of_texts(Sources::gather(name, text, read), freeze, backend)))
    }

    /// From recorded calls of the builder's Python face.
    #[staticmethod]
    fn from_calls(calls: &Bound<'_, PyList>, freeze: Vec<String>, backend: &str) -> PyResult<Self> {
        let backend = self::backend(backend)?;
        let calls = builder::read(calls)?;
        calls.py_free(|mechanism| Core::of(&Written::Calls(Box::new(mechanism)), &freeze, backend))
    }

    /// The function with this number.
    fn function(&self, number: usize) -> PyResult<Function> {
        let (name, _) = self.about.functions.get(number).ok_or_else(|| refused(format!("no function {number}")))?;
        Ok(Function::new(&self.engine, &self.values, number, name))
    }

    /// Names and texts of the files that it was derived from, its own first.
    #[getter]
    fn texts(&self) -> Vec<(String, String)> {
        self.about.texts.clone()
    }

    /// The parameters, flattened in the order of their declaration.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values = self.current();
        array::copied(py, &[values.parameters.len()], &values.parameters)
    }

    /// Gives all parameters values, which must be such as the mechanism can have.
    fn set_parameters(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let input = Input::of("params", values)?;
        let (given, derivation) = (input.values(), self.derivation());
        let expected = component_names(&derivation.parameters).len();
        if input.shape() != [expected] {
            return Err(refused(format!("params: expected {expected} numbers, found the shape {:?}", input.shape())));
        }
        let broken = guarded(|| Ok(Violation::all(derivation, given)))?;
        if !broken.is_empty() {
            let each = broken.iter().map(|v| format!("params: `{}` {}, it is {:?}", v.quantity, v.must, v.value));
            return Err(refused(each.collect::<Vec<_>>().join("\n")));
        }
        let values = Arc::new(guarded(|| Ok(self.engine.values(given.to_vec())))?);
        *self.values.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = values;
        Ok(())
    }

    /// The same mechanism with parameters of its own.
    fn copy(&self) -> Self {
        let values = Arc::new(RwLock::new(self.current()));
        Core { engine: Arc::clone(&self.engine), values, about: Arc::clone(&self.about) }
    }

    /// Names, units, documentation: all that was declared and derived.
    #[getter]
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (derivation, about) = (self.derivation(), &self.about);
        let info = PyDict::new(py);
        info.set_item("name", &derivation.name)?;
        info.set_item("docs", text(&derivation.docs))?;
        let kinds = [
            ("coordinates", &derivation.coordinates),
            ("parameters", &derivation.parameters),
            ("inputs", &derivation.inputs),
            ("prescribed", &derivation.prescribed),
        ];
        for (kind, variables) in kinds {
            let all: Vec<_> = variables.iter().map(|v| variable(py, v)).collect::<PyResult<_>>()?;
            info.set_item(kind, all)?;
        }
        info.set_item("constraints", &derivation.constraints)?;
        info.set_item("constraint_units", derivation.constraint_units.iter().map(|[a, b]| (a, b)).collect::<Vec<_>>())?;
        info.set_item("conserved", &derivation.conserved)?;
        info.set_item("depends_on_time", derivation.depends_on_time)?;
        info.set_item("warnings", &about.warnings)?;
        info.set_item("latex", &about.latex)?;
        info.set_item("not_compiled", &about.reason)?;
        info.set_item("proved_at", about.proved_at)?;
        let functions = PyList::empty(py);
        for (number, (name, docs)) in about.functions.iter().enumerate() {
            let (function, entry) = (&derivation.functions[number], PyDict::new(py));
            let arguments = function::arguments(derivation, number);
            entry.set_item("name", name)?;
            entry.set_item("docs", text(docs))?;
            entry.set_item("arguments", arguments.into_iter().map(|a| (a.kind.name(), a.shape)).collect::<Vec<_>>())?;
            let results = function.results.iter().map(|part| (part.name, kind(part.shape), function::axes(part.shape)));
            entry.set_item("results", results.collect::<Vec<_>>())?;
            entry.set_item("compiled", self.engine.is_compiled(number))?;
            functions.append(entry)?;
        }
        info.set_item("functions", functions)?;
        Ok(info)
    }
}

fn kind(shape: Shape) -> &'static str {
    match shape {
        Shape::Pose | Shape::Poses(_) => "pose",
        Shape::Wrench | Shape::Wrenches(_) => "wrench",
        Shape::Scalar => "number",
        Shape::Vector(_) | Shape::Matrix(..) | Shape::Symmetric(_) | Shape::Matrices(..) => "array",
    }
}

fn text(docs: &[String]) -> String {
    docs.iter().map(|line| line.strip_prefix(' ').unwrap_or(line).trim_end()).collect::<Vec<_>>().join("\n")
}

fn variable<'py>(py: Python<'py>, v: &Variable) -> PyResult<Bound<'py, PyDict>> {
    let entry = PyDict::new(py);
    entry.set_item("name", &v.name)?;
    entry.set_item("docs", text(&v.docs))?;
    entry.set_item("unit", &v.unit)?;
    entry.set_item("shape", v.lengths())?;
    entry.set_item("first", v.first)?;
    entry.set_item("count", v.count())?;
    entry.set_item("components", v.component_names())?;
    Ok(entry)
}
