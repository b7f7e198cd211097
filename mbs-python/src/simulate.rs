//! Motions: `mbs_runtime`'s integrators on a mechanism's forward dynamics.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::sync::Arc;

use mbs_derive::interpret::{self, Interpreter};
use mbs_derive::optimise::{Argument, FunctionKind};
use mbs_derive::variable::component_names;
use mbs_native::Kind;
use mbs_runtime::{
    ConstraintError, Constraints, Direction, Dop853, Dopri5, Event, GaussLegendre4, IntegrationError, Integrator,
    Projector, RedundantRows, Response, Rk4, SemiImplicitEuler, State, Step, StormerVerlet, Summary,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::array::{self, Input};
use crate::core::Core;
use crate::engine::{Engine, Values};
use crate::{SimulationError, function, guarded, refused};

/// A motion's own vectors.
type Moving = State<Vec<f64>>;

/// Inputs, or prescribed motions: numbers that stay, or a function of Python.
enum Given {
    Fixed(Vec<f64>),
    Called { name: &'static str, shape: Vec<usize>, function: Py<PyAny> },
}

impl Given {
    fn read(name: &'static str, shape: Vec<usize>, value: Option<Bound<'_, PyAny>>) -> PyResult<Self> {
        let count = shape.iter().product();
        match value {
            None => Ok(Given::Fixed(vec![0.0; count])),
            Some(function) if function.is_callable() => Ok(Given::Called { name, shape, function: function.unbind() }),
            Some(value) => Ok(Given::Fixed(read(name, &value, &shape)?)),
        }
    }

    /// The numbers at a state.
    fn at(&self, t: f64, state: Option<(&[f64], &[f64])>, numbers: &mut Vec<f64>) -> PyResult<()> {
        match self {
            Given::Fixed(fixed) => numbers.clone_from(fixed),
            Given::Called { name, shape, function } => {
                *numbers = Python::attach(|py| {
                    let value = match state {
                        Some((q, qd)) => function.bind(py).call1((t, vector(py, q)?, vector(py, qd)?)),
                        None => function.bind(py).call1((t,)),
                    };
                    read(name, &value?, shape)
                })?;
            }
        }
        Ok(())
    }
}

/// Finite numbers of a shape.
fn read(name: &str, value: &Bound<'_, PyAny>, shape: &[usize]) -> PyResult<Vec<f64>> {
    let input = Input::of(name, value)?;
    if input.shape() != shape {
        return Err(refused(format!("{name}: expected an array of the shape {shape:?}, found {:?}", input.shape())));
    }
    match input.values().iter().position(|x| !x.is_finite()) {
        Some(i) => Err(refused(format!("{name}: entry {i} is {}", input.values()[i]))),
        None => Ok(input.values().to_vec()),
    }
}

fn vector<'py>(py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    array::copied(py, &[values.len()], values)
}

/// An event as Python gives it: a function, a direction, whether it ends the motion, an action.
type Declared = (Py<PyAny>, i32, bool, Option<Py<PyAny>>);

/// The equations of motion with parameters, inputs and prescribed motions.
struct Equations {
    engine: Arc<Engine>,
    values: Arc<Values>,
    u: Given,
    prescribed: Given,
    /// The first error that Python raised.
    error: RefCell<Option<PyErr>>,
    calls: Cell<u32>,
}

impl Equations {
    fn number(&self, kind: FunctionKind) -> Option<usize> {
        self.engine.derivation.functions.iter().position(|f| f.kind == kind)
    }

    /// One result at one state.
    fn put(&self, kind: FunctionKind, t: f64, q: &[f64], qd: &[f64], result: &mut [f64]) {
        let Some(number) = self.number(kind) else {
            // M or A, where their system is eliminated: of large mechanisms they are no functions.
            let found = self.resting(t, q).and_then(|state| self.interpreter().call(kind, &state));
            return match found {
                Some(found) => result.copy_from_slice(&found),
                None => result.fill(f64::NAN),
            };
        };
        let (mut u, mut prescribed, zeros) = (Vec::new(), Vec::new(), vec![0.0; q.len()]);
        let wanted = function::arguments(&self.engine.derivation, number);
        let wants = |kind: Kind| wanted.iter().any(|argument| argument.kind == kind);
        let u_given = if wants(Kind::Of(Argument::U)) { self.u.at(t, Some((q, qd)), &mut u) } else { Ok(()) };
        let given = u_given.and_then(|()| match wants(Kind::Prescribed) {
            true => self.prescribed.at(t, None, &mut prescribed),
            false => Ok(()),
        });
        if let Err(error) = given {
            self.error.borrow_mut().get_or_insert(error);
            return result.fill(f64::NAN);
        }
        let t = [t];
        let arguments: Vec<(&[f64], usize)> = wanted
            .iter()
            .map(|argument| match argument.kind {
                Kind::Time => (&t[..], 0),
                Kind::Prescribed => (&prescribed[..], 0),
                Kind::Of(Argument::Q) => (q, 0),
                Kind::Of(Argument::Qd) => (qd, 0),
                Kind::Of(Argument::U) => (&u[..], 0),
                Kind::Of(Argument::Qdd | Argument::Multipliers) => (&zeros[..], 0),
            })
            .collect();
        self.engine.evaluate(number, &self.values, &arguments, 1, &mut [result]);
    }

    fn interpreter(&self) -> Interpreter<'_> {
        Interpreter::with_parameters(&self.engine.derivation, self.values.parameters.clone())
    }

    /// The coordinates and the prescribed motions at a time, without velocities; `None` where Python raises an error.
    fn resting(&self, t: f64, q: &[f64]) -> Option<interpret::State> {
        let mut prescribed = Vec::new();
        if let Err(error) = self.prescribed.at(t, None, &mut prescribed) {
            self.error.borrow_mut().get_or_insert(error);
            return None;
        }
        let derivation = &self.engine.derivation;
        let signals = prescribed.chunks_exact(3).map(|signal| [signal[0], signal[1], signal[2]]);
        let zeros = vec![0.0; q.len()];
        Some(interpret::State {
            t,
            q: q.to_vec(),
            qd: zeros.clone(),
            qdd: zeros,
            u: vec![0.0; derivation.inputs.iter().map(|input| input.count()).sum()],
            prescribed: signals.collect(),
        })
    }

    /// `q̈`; NaN once Python has raised an error, or the user has pressed Ctrl+C.
    fn accelerations(&self, t: f64, q: &[f64], qd: &[f64], qdd: &mut [f64]) {
        const PATIENCE: u32 = 1024;
        self.calls.set(self.calls.get().wrapping_add(1));
        if self.calls.get().is_multiple_of(PATIENCE)
            && let Err(error) = Python::attach(|py| py.check_signals())
        {
            self.error.borrow_mut().get_or_insert(error);
        }
        // Not in the condition: what is borrowed there stays borrowed.
        let has_failed = self.error.borrow().is_some();
        match has_failed {
            true => qdd.fill(f64::NAN),
            false => self.put(FunctionKind::ForwardDynamics, t, q, qd, qdd),
        }
    }

    fn rows(&self) -> usize {
        self.engine.derivation.constraints.len()
    }

    /// What a call of Python gives, or `none` and a note of the error.
    fn asked<T>(&self, none: T, ask: impl FnOnce(Python<'_>) -> PyResult<T>) -> T {
        if self.error.borrow().is_some() {
            return none;
        }
        Python::attach(ask).unwrap_or_else(|error| {
            self.error.borrow_mut().get_or_insert(error);
            none
        })
    }
}

impl Constraints<f64> for Equations {
    fn rows(&self) -> usize {
        self.rows()
    }

    fn is_holonomic(&self, row: usize) -> bool {
        self.engine.derivation.holonomic[row]
    }

    fn mass_matrix(&self, t: f64, q: &[f64], m: &mut [f64]) {
        self.put(FunctionKind::MassMatrix, t, q, &vec![0.0; q.len()], m);
    }

    fn position(&self, t: f64, q: &[f64], phi: &mut [f64]) {
        self.put(FunctionKind::Constraint, t, q, &vec![0.0; q.len()], phi);
    }

    fn rate(&self, t: f64, q: &[f64], qd: &[f64], rate: &mut [f64]) {
        self.put(FunctionKind::ConstraintRate, t, q, qd, rate);
    }

    fn jacobian(&self, t: f64, q: &[f64], a: &mut [f64]) {
        self.put(FunctionKind::ConstraintJacobian, t, q, &vec![0.0; q.len()], a);
    }

    fn least_change(&self, t: f64, q: &[f64], target: &[f64], change: &mut [f64]) -> Option<usize> {
        let (found, rank) = self.interpreter().least_change(&self.resting(t, q)?, target)?;
        change.copy_from_slice(&found);
        Some(rank)
    }
}

/// How to integrate.
struct Settings {
    method: String,
    rtol: f64,
    atol: f64,
    step: f64,
    max_step: f64,
    max_steps: usize,
}

const METHODS: [&str; 6] = ["dop853", "dopri5", "rk4", "gauss_legendre4", "stormer_verlet", "semi_implicit_euler"];

/// What is kept of a motion.
#[derive(Default)]
struct Rows {
    t: Vec<f64>,
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl Rows {
    fn push(&mut self, t: f64, moving: &Moving) {
        self.t.push(t);
        self.q.extend_from_slice(&moving.q);
        self.qd.extend_from_slice(&moving.qd);
    }
}

/// When an event happened, which one, and the state before its action.
type Log = Vec<(usize, f64, Vec<f64>, Vec<f64>)>;

struct Motion {
    rows: Rows,
    events: Log,
    end: Moving,
    summary: Summary,
}

impl Equations {
    fn motion(
        &self,
        settings: &Settings,
        (t, t_end): (f64, f64),
        times: Option<&[f64]>,
        start: Moving,
        declared: &[Declared],
        is_projected: bool,
    ) -> PyResult<Motion> {
        let size = Projector::<f64, Vec<f64>>::size(start.q.len(), self.rows());
        let projector = Projector::new(vec![0.0; size]).with_redundant_rows(RedundantRows::LeaveOut);
        let projector = RefCell::new(projector);
        let is_projected = is_projected && self.rows() > 0;
        // States that steps and actions lead to are brought onto the constraints as the first one is.
        let brought = |t: f64, state: &mut Moving| match is_projected {
            true => projector.borrow_mut().project(self, t, state),
            false => Ok(()),
        };
        let mut moving = start;
        let assembled = brought(t, &mut moving);
        self.raise()?;
        assembled.map_err(|error| refused(format!("q, qd: no state on the constraints is near: {error}")))?;
        let (mut rows, log) = (Rows::default(), RefCell::new(Log::new()));
        let functions: Vec<_> = declared.iter().map(|(function, ..)| self.event_function(function)).collect();
        let mut actions: Vec<_> = declared
            .iter()
            .enumerate()
            .map(|(i, (.., action))| self.event_action(i, action.as_ref(), &log, &brought))
            .collect();
        let mut events: Vec<Event<'_, Vec<f64>>> = Vec::new();
        for ((function, action), (_, direction, terminal, _)) in functions.iter().zip(&mut actions).zip(declared) {
            let direction = match direction {
                0 => Direction::Any,
                1.. => Direction::Rising,
                _ => Direction::Falling,
            };
            let event = Event::new(function).direction(direction).with_action(action);
            events.push(if *terminal { event.terminal() } else { event });
        }
        let is_between = |t0: f64, time: f64, end: f64| if t0 <= end { time <= end } else { time >= end };
        let mut remaining = times.unwrap_or_default().iter().copied().peekable();
        while remaining.next_if(|&time| time == t).is_some() {
            rows.push(t, &moving);
        }
        if times.is_none() {
            rows.push(t, &moving);
        }
        let mut sampled = moving.clone();
        let closed =
            |at: f64, state: &mut Moving| brought(at, state).map_err(|error| format!("off the constraints: {error}"));
        let observer = |step: &mut dyn Step<Vec<f64>>| {
            let (begin, end) = (step.previous_time(), step.time());
            if self.error.borrow().is_some() {
                return Err("an error of Python".to_string());
            }
            while let Some(time) = remaining.next_if(|&time| is_between(begin, time, end)) {
                if step.interpolate(time, &mut sampled).is_err() {
                    return Ok(ControlFlow::Break(end));
                }
                closed(time, &mut sampled)?;
                rows.push(time, &sampled);
            }
            if is_projected {
                sampled.clone_from(step.state());
                closed(end, &mut sampled)?;
                step.replace(&sampled);
            }
            if times.is_none() {
                rows.push(end, if is_projected { &sampled } else { step.state() });
            }
            Ok(ControlFlow::Continue(()))
        };
        let accelerations = |t: f64, q: &Vec<f64>, qd: &Vec<f64>, qdd: &mut Vec<f64>| self.accelerations(t, q, qd, qdd);
        let outcome = integrated(settings, accelerations, (t, t_end), &mut moving, &mut events, observer);
        self.raise()?;
        let summary = outcome.map_err(|error| {
            let (q, qd) = (&moving.q, &moving.qd);
            match error.time() {
                Some(_) => {
                    SimulationError::new_err(format!("the integration stopped: {error}, at q = {q:?}, qd = {qd:?}"))
                }
                None => refused(error.to_string()),
            }
        })?;
        drop(events);
        drop(actions);
        Ok(Motion { rows, events: log.into_inner(), end: moving, summary })
    }

    /// What Python has raised.
    fn raise(&self) -> PyResult<()> {
        self.error.borrow_mut().take().map_or(Ok(()), Err)
    }

    fn event_function(&self, function: &Py<PyAny>) -> impl Fn(f64, &Moving) -> f64 {
        move |t, state| {
            self.asked(f64::NAN, |py| {
                function.bind(py).call1((t, vector(py, &state.q)?, vector(py, &state.qd)?))?.extract()
            })
        }
    }

    /// `None`: go on; "stop", "restart"; or a pair of new coordinates and velocities.
    fn event_action(
        &self,
        number: usize,
        action: Option<&Py<PyAny>>,
        log: &RefCell<Log>,
        brought: &impl Fn(f64, &mut Moving) -> Result<(), ConstraintError>,
    ) -> impl FnMut(f64, &mut Moving) -> Response {
        move |t, state| {
            log.borrow_mut().push((number, t, state.q.clone(), state.qd.clone()));
            let Some(action) = action else { return Response::Continue };
            self.asked(Response::Stop, |py| {
                let answer = action.bind(py).call1((t, vector(py, &state.q)?, vector(py, &state.qd)?))?;
                if answer.is_none() {
                    return Ok(Response::Continue);
                }
                if let Ok(word) = answer.extract::<String>() {
                    return match word.as_str() {
                        "stop" => Ok(Response::Stop),
                        "restart" => Ok(Response::Restart),
                        _ => Err(refused(format!("action: {word:?} is neither \"stop\" nor \"restart\""))),
                    };
                }
                let pair = answer.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
                let pair = pair.ok_or_else(|| refused("action: it returns None, a word, or a pair (q, qd)"))?;
                let shape = [state.q.len()];
                let (q, qd) =
                    (read("action q", &pair.get_item(0)?, &shape)?, read("action qd", &pair.get_item(1)?, &shape)?);
                (state.q, state.qd) = (q, qd);
                let brought = brought(t, state);
                brought.map_err(|e| refused(format!("action: no state on the constraints is near: {e}")))?;
                Ok(Response::Continue)
            })
        }
    }
}

fn integrated(
    settings: &Settings,
    accelerations: impl FnMut(f64, &Vec<f64>, &Vec<f64>, &mut Vec<f64>),
    (t, t_end): (f64, f64),
    moving: &mut Moving,
    events: &mut [Event<'_, Vec<f64>>],
    observer: impl FnMut(&mut dyn Step<Vec<f64>>) -> Result<ControlFlow<f64>, String>,
) -> Result<Summary, IntegrationError<String>> {
    let Settings { rtol, atol, step, max_step, max_steps, .. } = *settings;
    macro_rules! by {
        ($method:expr) => {
            $method.integrate_with_events(accelerations, t, t_end, moving, events, observer)
        };
    }
    match settings.method.as_str() {
        "dop853" => by!(Dop853::new(rtol, atol).with_max_step(max_step).with_max_steps(max_steps)),
        "dopri5" => by!(Dopri5::new(rtol, atol).with_max_step(max_step).with_max_steps(max_steps)),
        "rk4" => by!(Rk4::new(step)),
        "gauss_legendre4" => by!(GaussLegendre4::new(step)),
        "stormer_verlet" => by!(StormerVerlet::new(step)),
        _ => by!(SemiImplicitEuler::new(step)),
    }
}

/// Times within a span, in its direction; those beyond its end by rounding are its end.
fn ordered(mut times: Vec<f64>, (begin, end): (f64, f64)) -> PyResult<Vec<f64>> {
    let rounding = 4.0 * f64::EPSILON * begin.abs().max(end.abs());
    let follows = |first: f64, second: f64| if begin <= end { first <= second } else { second <= first };
    let mut last = begin;
    for (i, time) in times.iter_mut().enumerate() {
        if !follows(*time, end) && (*time - end).abs() <= rounding {
            *time = end;
        }
        let wrong = |how: &str| refused(format!("times: entry {i}, {time:?}, {how}"));
        if !follows(begin, *time) {
            return Err(wrong(&format!("lies before the first time, t[0] = {begin:?}")));
        }
        if !follows(*time, end) {
            return Err(wrong(&format!("lies behind the last time, t[1] = {end:?}")));
        }
        if !follows(last, *time) {
            return Err(wrong(&format!("lies before the one before it, {last:?}; times go from t[0] to t[1]")));
        }
        last = *time;
    }
    Ok(times)
}

/// The motion from a state; see `Model.simulate`, which is its face.
#[pyfunction]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    core: PyRef<'py, Core>,
    q: &Bound<'py, PyAny>,
    qd: &Bound<'py, PyAny>,
    t: (f64, f64),
    times: Option<Bound<'py, PyAny>>,
    method: (String, f64, f64, f64, f64, usize),
    u: Option<Bound<'py, PyAny>>,
    prescribed: Option<Bound<'py, PyAny>>,
    events: Vec<Declared>,
    project: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let (method, rtol, atol, step, max_step, max_steps) = method;
    if !METHODS.contains(&method.as_str()) {
        return Err(refused(format!("method: {method:?} is none of {}", METHODS.join(", "))));
    }
    let settings = Settings { method, rtol, atol, step, max_step, max_steps };
    let derivation = core.derivation();
    let n = derivation.dof();
    let start = State::new(read("q", q, &[n])?, read("qd", qd, &[n])?);
    let times = match &times {
        None => None,
        Some(times) => {
            let count = Input::of("times", times)?.values().len();
            Some(read("times", times, &[count])?)
        }
    };
    for (name, time) in [("t[0]", t.0), ("t[1]", t.1)] {
        if !time.is_finite() {
            return Err(refused(format!("{name}: {time} is not finite")));
        }
    }
    let times = times.map(|times| ordered(times, t)).transpose()?;
    let equations = Equations {
        engine: Arc::clone(&core.engine),
        values: core.current(),
        u: Given::read("u", vec![component_names(&derivation.inputs).len()], u)?,
        prescribed: Given::read("prescribed", vec![component_names(&derivation.prescribed).len(), 3], prescribed)?,
        error: RefCell::new(None),
        calls: Cell::new(0),
    };
    let work = move || equations.motion(&settings, t, times.as_deref(), start, &events, project);
    let motion = py.detach(move || guarded(work))?;
    let result = PyDict::new(py);
    let rows = &motion.rows;
    result.set_item("t", vector(py, &rows.t)?)?;
    result.set_item("q", array::copied(py, &[rows.t.len(), n], &rows.q)?)?;
    result.set_item("qd", array::copied(py, &[rows.t.len(), n], &rows.qd)?)?;
    let events = motion.events.iter().map(|(i, t, q, qd)| Ok((*i, *t, vector(py, q)?, vector(py, qd)?)));
    result.set_item("events", events.collect::<PyResult<Vec<_>>>()?)?;
    let Summary { time, stopped, evaluations, accepted, rejected, .. } = motion.summary;
    result.set_item("end", (time, vector(py, &motion.end.q)?, vector(py, &motion.end.qd)?))?;
    result.set_item("stopped", stopped)?;
    result.set_item("counts", (evaluations, accepted, rejected))?;
    Ok(result)
}
