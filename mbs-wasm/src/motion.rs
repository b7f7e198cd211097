//! Integration, with events.

use std::cell::RefCell;
use std::ops::ControlFlow;

use mbs_runtime::{
    Constraints, Direction, Dop853, Dopri5, Event, GaussLegendre4, IntegrationError, Integrator, Projected,
    RedundantRows, Response, Rk4, SemiImplicitEuler, Step, StormerVerlet, Summary,
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::columns;
use crate::equations::{Drive, Equations, Moving};
use crate::model::{Model, Point};
use crate::report::Failure;

/// How to integrate, and what to watch.
#[derive(Clone, Debug, Deserialize)]
pub struct Settings {
    /// End time in s; the start is the state's.
    pub t_end: f64,
    /// Seconds between rows, and the step of methods without error control.
    pub dt: f64,
    /// The longest step of methods with error control, which step over what comes and goes in less time.
    pub max_step: f64,
    /// The method.
    pub method: Method,
    /// Relative tolerance of methods with error control.
    pub rtol: f64,
    /// Absolute tolerance of methods with error control.
    pub atol: f64,
    /// Whether states are projected onto constraints after each step.
    pub project: bool,
    /// Whether constraints may depend on others.
    pub redundant: bool,
    /// The coordinates that stay as given when the first state is brought onto the constraints.
    pub hold: Vec<usize>,
    /// What to watch.
    pub events: Vec<Watched>,
}

/// A method of the runtime.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs)] // the runtime documents them
pub enum Method {
    Dop853,
    Dopri5,
    Rk4,
    #[serde(rename = "gauss-legendre4")]
    GaussLegendre4,
    StormerVerlet,
    SemiImplicitEuler,
}

/// A column that passes a value.
#[derive(Clone, Debug, Deserialize)]
pub struct Watched {
    /// The number of the column.
    pub column: usize,
    /// What it passes.
    pub value: f64,
    /// Which way: -1 falling, 1 rising, 0 either.
    pub direction: i8,
    /// Whether the motion ends there.
    pub stop: bool,
    /// Velocities by number, and what they are multiplied by there: an impact.
    pub multiply: Vec<(usize, f64)>,
}

/// A motion, row by row.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The rows, one behind the other.
    pub rows: Vec<f64>,
    /// What it took, and what happened.
    pub summary: Value,
}

/// At most this many numbers are recorded: a quarter of a gigabyte.
const MOST: f64 = (1 << 25) as f64;

impl Motion {
    /// From a state to the end time, or to an event that ends it.
    ///
    /// # Errors
    /// Settings that mean nothing; or where the motion did not go on, and why.
    pub fn integrate(
        model: &Model,
        start: &Point,
        settings: &Settings,
        drive: Option<&Drive<'_>>,
    ) -> Result<Self, Failure> {
        let columns = columns::columns(model.derivation()).into_iter();
        let names: Vec<String> = columns.map(|column| column.name).collect();
        let times = times(start.state.t, settings, names.len())?;
        let equations = Equations::new(model, start, drive);
        let redundant_rows = if settings.redundant { RedundantRows::LeaveOut } else { RedundantRows::Refuse };
        let run = Run { equations: &equations, settings, names, redundant_rows };
        run.motion(&times)
    }
}

/// From the start in steps of `dt` to the end time, both included, for rows of `width` numbers.
fn times(start: f64, settings: &Settings, width: usize) -> Result<Vec<f64>, Failure> {
    let (end, step) = (settings.t_end, settings.dt);
    let is_positive = |x: f64| x > 0.0 && x.is_finite();
    if !(end >= start && (end - start).is_finite()) {
        return Err(Failure::of_input(format!("t_end: {end:?} must not lie before the start, {start:?}")));
    }
    for (name, value) in
        [("dt", step), ("max_step", settings.max_step), ("tolerance", settings.rtol), ("atol", settings.atol)]
    {
        if !is_positive(value) {
            return Err(Failure::of_input(format!("{name}: it must be positive and finite, found {value:?}")));
        }
    }
    if end == start {
        return Ok(vec![start]);
    }
    // A last row that would differ from the one before by rounding alone is left out.
    let count = ((end - start) / step - 1e-9).ceil().max(1.0);
    if count * width as f64 > MOST {
        return Err(Failure::of_input(format!("dt: {step:?} gives {count:e} rows, more than are kept")));
    }
    let mut times: Vec<f64> = (0..count as usize).map(|i| start + i as f64 * step).collect();
    times.push(end);
    Ok(times)
}

/// One integration.
struct Run<'a> {
    equations: &'a Equations<'a>,
    settings: &'a Settings,
    names: Vec<String>,
    redundant_rows: RedundantRows,
}

/// What the observer and the right-hand side stop with.
type Outcome = Result<Summary, IntegrationError<String>>;

const REFUSED: &str = "the inputs were not given";

impl Run<'_> {
    fn motion(&self, times: &[f64]) -> Result<Motion, Failure> {
        let (equations, settings, t) = (self.equations, self.settings, times[0]);
        let mut moving = equations.start();
        let given = moving.clone();
        let is_projected = equations.rows() > 0 && settings.project;
        if is_projected {
            let mut projector = equations.projector(self.redundant_rows);
            let assembled = projector.assemble(equations, t, &mut moving, |i| settings.hold.contains(&i));
            let refused = |error| Failure::of_motion(equations.explained(error), t, &given.q, &given.qd);
            assembled.map_err(refused)?;
        }
        let mut rows = Vec::new();
        let first = self.row(t, &moving).map_err(|error| Failure::of_motion(error, t, &moving.q, &moving.qd))?;
        rows.extend(first);
        let is_assembled = moved(&given.q, &moving.q) || moved(&given.qd, &moving.qd);

        let happened = RefCell::new(Vec::new());
        let outcome = self.integrate(is_projected, times, &mut moving, &mut rows, &happened);
        let summary = outcome.map_err(|error| {
            let t = error.time().unwrap_or(t);
            let message = match error {
                IntegrationError::Constraint { error, .. } => equations.explained(error),
                other => other.to_string(),
            };
            Failure::of_motion(message, t, &moving.q, &moving.qd)
        })?;
        if summary.stopped {
            let refused = |error| Failure::of_motion(error, summary.time, &moving.q, &moving.qd);
            let last = self.row(summary.time, &moving).map_err(refused)?;
            // A row that is due at the same time is this one, before the event's action.
            let width = last.len();
            if rows[rows.len() - width] == summary.time {
                rows.truncate(rows.len() - width);
            }
            rows.extend(last);
        }
        let summary = json!({
            "time": summary.time,
            "stopped": summary.stopped,
            "evaluations": summary.evaluations,
            "accepted": summary.accepted,
            "rejected": summary.rejected,
            "assembled": is_assembled,
            "rows": rows.len() / self.names.len(),
            "events": happened.into_inner(),
        });
        Ok(Motion { rows, summary })
    }

    fn integrate(
        &self,
        is_projected: bool,
        times: &[f64],
        moving: &mut Moving,
        rows: &mut Vec<f64>,
        happened: &RefCell<Vec<(usize, f64)>>,
    ) -> Outcome {
        let &Settings { rtol, atol, dt, max_step, t_end, .. } = self.settings;
        // Far from zero, rows may be closer than the shortest step that is tried.
        let longest = max_step.max(32.0 * f64::EPSILON * times[0].abs().max(t_end.abs()));
        // A step for each row at least.
        let steps = 1_000_000 + times.len();
        macro_rules! by {
            ($method:expr) => {{
                let method = $method;
                if is_projected {
                    let drift = self.equations.projector(self.redundant_rows).onto(self.equations);
                    self.by(&Projected { method, drift }, times, moving, rows, happened)
                } else {
                    self.by(&method, times, moving, rows, happened)
                }
            }};
        }
        match self.settings.method {
            Method::Dop853 => by!(Dop853::new(rtol, atol).with_max_step(longest).with_max_steps(steps)),
            Method::Dopri5 => by!(Dopri5::new(rtol, atol).with_max_step(longest).with_max_steps(steps)),
            Method::Rk4 => by!(Rk4::new(dt)),
            Method::GaussLegendre4 => by!(GaussLegendre4::new(dt)),
            Method::StormerVerlet => by!(StormerVerlet::new(dt)),
            Method::SemiImplicitEuler => by!(SemiImplicitEuler::new(dt)),
        }
    }

    fn by(
        &self,
        method: &impl Integrator<f64>,
        times: &[f64],
        moving: &mut Moving,
        rows: &mut Vec<f64>,
        happened: &RefCell<Vec<(usize, f64)>>,
    ) -> Outcome {
        let end = times[times.len() - 1];
        let acceleration = |t: f64, q: &Vec<f64>, qd: &Vec<f64>, qdd: &mut Vec<f64>| {
            let found = self.equations.accelerations(t, q, qd).ok_or(REFUSED.to_string())?;
            qdd.copy_from_slice(&found);
            Ok(())
        };
        let mut remaining = times[1..].iter().copied().peekable();
        let mut sampled = moving.clone();
        let observer = |step: &mut dyn Step<Vec<f64>>| {
            let until = step.time();
            while let Some(time) = remaining.next_if(|&time| time <= until) {
                if step.interpolate(time, &mut sampled).is_err() {
                    return Ok(ControlFlow::Break(until)); // it ends with that error
                }
                rows.extend(self.row(time, &sampled)?);
            }
            Ok(ControlFlow::Continue(()))
        };
        let watched = &self.settings.events;
        let functions: Vec<_> = watched.iter().map(|event| self.function(event)).collect();
        let mut actions: Vec<_> = watched.iter().enumerate().map(|(i, event)| action(i, event, happened)).collect();
        let events = functions.iter().zip(&mut actions).zip(watched);
        let mut events: Vec<Event<'_, Vec<f64>>> = events
            .map(|((function, action), event)| {
                let direction = match event.direction {
                    ..=-1 => Direction::Falling,
                    0 => Direction::Any,
                    1.. => Direction::Rising,
                };
                Event::new(function).direction(direction).with_action(action)
            })
            .collect();
        method.integrate_with_events(acceleration, times[0], end, moving, &mut events, observer)
    }

    /// What passes zero.
    fn function(&self, event: &Watched) -> impl Fn(f64, &Moving) -> f64 {
        let (column, value) = (event.column, event.value);
        move |t, moving| {
            let row = self.equations.row(t, &moving.q, &moving.qd);
            row.and_then(|row| row.get(column).copied()).unwrap_or(f64::NAN) - value
        }
    }

    /// What is recorded of a state, all of it numbers.
    fn row(&self, t: f64, moving: &Moving) -> Result<Vec<f64>, String> {
        let row = self.equations.row(t, &moving.q, &moving.qd).ok_or(REFUSED)?;
        match row.iter().position(|x| !x.is_finite()) {
            Some(i) => Err(format!("`{}` is {:?} at t = {t:?}", self.names[i], row[i])),
            None => Ok(row),
        }
    }
}

/// Notes that it happened, and does what was asked for.
fn action(
    number: usize,
    event: &Watched,
    happened: &RefCell<Vec<(usize, f64)>>,
) -> impl FnMut(f64, &mut Moving) -> Response {
    move |t, moving| {
        happened.borrow_mut().push((number, t));
        for &(velocity, factor) in &event.multiply {
            if let Some(velocity) = moving.qd.get_mut(velocity) {
                *velocity *= factor;
            }
        }
        if event.stop { Response::Stop } else { Response::Continue }
    }
}

/// By more than the rounding of an input.
fn moved(from: &[f64], to: &[f64]) -> bool {
    from.iter().zip(to).any(|(a, b)| (a - b).abs() > 1e-9 * (1.0 + a.abs()))
}
