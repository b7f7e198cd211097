//! Integration, and what is recorded of it.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::variable::component_names;
use mbs_runtime::{ConstraintError, Constraints, Event, IntegrationError, RedundantRows, Step, Summary};

use super::assembly::Held;
use super::column::{Column, of_variables};
use super::drive::Driven;
use super::method::{Accuracy, Method};
use super::progress::Progress;
use super::record::Recorder;
use super::until::Ending;
use super::{assembly, collapse};
use crate::equations::{Equations, Motion as Moving, Solver};
use crate::failure::Failure;
use crate::output;
use crate::state::Point;
use crate::words::vector;

/// What is done about constraints that an integration does not keep by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Drift {
    /// States are projected onto the constraints after each step.
    Projected,
    /// Baumgarte's stabilization with the gains α and β.
    Baumgarte([f64; 2]),
    /// Nothing.
    Left,
}

/// How to integrate, and how constraints are kept.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(crate) method: Method,
    pub(crate) accuracy: Accuracy,
    pub(crate) drift: Drift,
    pub(crate) redundant_rows: RedundantRows,
    /// What stays as given when the first state is assembled.
    pub(crate) held: Held,
}

impl Settings {
    /// How far a projection may move a state: a thousandth, or what the tolerances let the integrator err.
    fn near(&self) -> f64 {
        const LEAST: f64 = 1e-3;
        // Between its ends a step may err by more than there.
        let error = 20.0 * (self.accuracy.relative + self.accuracy.absolute);
        if self.method.has_error_control() { error.max(LEAST) } else { LEAST }
    }

    /// What may lead past a state in which constraints lose rank: error control comes ever nearer to it, steps of one
    /// length step over it.
    fn way_past_lost_rank(&self) -> &'static str {
        if self.method.has_error_control() {
            "a fixed step (method rk4) or other tolerances may pass it"
        } else {
            "another step may pass it, a shorter one where it is too long for the motion"
        }
    }
}

/// A motion, row by row.
#[derive(Debug)]
pub(crate) struct Motion {
    /// The mechanism's name.
    pub(crate) name: String,
    /// What stands behind the time.
    pub(crate) columns: Vec<Column>,
    /// In order of time.
    pub(crate) rows: Vec<Row>,
    /// Why it ends with these rows, before its end.
    pub(crate) stopped: Option<String>,
}

/// What is recorded at one time.
#[derive(Debug)]
pub(crate) struct Row {
    /// Time in seconds.
    pub(crate) t: f64,
    /// T
    pub(crate) kinetic: f64,
    /// V
    pub(crate) potential: f64,
    /// In the order of the columns.
    pub(crate) values: Vec<f64>,
}

impl Motion {
    /// From a state over the given times, the first of which is the state's; as far as it comes, if that is further
    /// than its first row; or to where a formula passes zero.
    pub(crate) fn integrate(
        derivation: &Derivation,
        start: &Point,
        times: &[f64],
        settings: &Settings,
        driven: Driven,
        recorder: &Recorder<'_>,
        ending: Option<Ending>,
    ) -> Result<Motion, Failure> {
        let equations = Equations::new(derivation, start)?.with_driven(driven);
        if settings.method.is_for_separable() && equations.depends_on_velocities() {
            output::warn("accelerations depend on velocities: the method is of order 1 and not symplectic here");
        }
        let (rows, outcome) = Run { equations: &equations, settings, is_attended: true }.rows(times, recorder, ending);
        let stopped = outcome.err();
        if let Some(reason) = stopped.as_ref().filter(|_| rows.len() < 2) {
            return Err(Failure::new(reason));
        }
        let columns = distinct([standard_columns(derivation), recorder.columns()].concat());
        Ok(Motion { name: derivation.name.clone(), columns, rows, stopped })
    }

    /// To its end.
    pub(crate) fn whole(self) -> Result<Motion, Failure> {
        match &self.stopped {
            Some(reason) => Err(Failure::new(reason)),
            None => Ok(self),
        }
    }
}

/// With names of their own: what has the name of an earlier column is called by its kind, too, `outputs_energy`.
fn distinct(columns: Vec<Column>) -> Vec<Column> {
    let mut taken: BTreeSet<String> = columns.iter().map(|column| column.name.clone()).collect();
    let mut seen = BTreeSet::new();
    let renamed = columns.into_iter().map(|column| {
        if seen.insert(column.name.clone()) {
            return column;
        }
        let mut name = format!("{}_{}", column.what, column.name);
        while !taken.insert(name.clone()) {
            name.push('_');
        }
        Column { label: name.clone(), name, ..column }
    });
    renamed.collect()
}

/// `<coordinates>,<coordinates>_dot,energy`, then multipliers and residuals of constraints.
fn standard_columns(derivation: &Derivation) -> Vec<Column> {
    let mut velocities = of_variables("velocities", &derivation.coordinates, "_dot", "/s");
    for (column, name) in velocities.iter_mut().zip(component_names(&derivation.coordinates)) {
        column.label = format!("d{name}/dt");
    }
    let rows = |what, prefix: &str, unit: usize| -> Vec<Column> {
        let rows = derivation.constraints.iter().zip(&derivation.constraint_units);
        rows.map(|(row, units)| Column::new(what, &format!("{prefix}{row}"), &units[unit])).collect()
    };
    [
        of_variables("coordinates", &derivation.coordinates, "", ""),
        velocities,
        vec![Column::new("energy", "energy", "J")],
        rows("multipliers", "lambda_", 1),
        rows("residuals", "residual_", 0),
    ]
    .concat()
}

/// What looks at a motion while it is integrated.
pub(crate) trait Onlooker {
    /// The motion starts.
    fn begin(&mut self, t: f64, moving: &Moving) -> Result<(), String>;

    /// It has come from one time to another; `inside` tells where it was at any time between them, both included.
    fn step(&mut self, from: f64, to: f64, inside: &mut Inside<'_>) -> Result<(), String>;
}

/// The state at a time of a step, on the constraints if the motion is kept there.
pub(crate) type Inside<'a> = dyn FnMut(f64, &mut Moving) -> Result<(), String> + 'a;

/// One integration.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a, 'd> {
    pub(crate) equations: &'a Equations<'d>,
    pub(crate) settings: &'a Settings,
    /// Whether somebody watches: a bar shows how far it has come, and warnings are written.
    pub(crate) is_attended: bool,
}

impl<'a, 'd> Run<'a, 'd> {
    /// The rows at these times, and what it took; or those before it stopped, and why.
    fn rows(
        self,
        times: &[f64],
        recorder: &'a Recorder<'d>,
        ending: Option<Ending>,
    ) -> (Vec<Row>, Result<Summary, String>) {
        let end = times.last().copied().unwrap_or(self.equations.start_time());
        let rows = Vec::with_capacity(times.len());
        let mut recording = Recording { run: self, solver: self.solver(), recorder, remaining: times, rows };
        let ending = ending.as_ref();
        let function =
            ending.map(|ending| move |t: f64, moving: &Moving| ending.formula.value(self.equations, t, moving));
        let mut events: Vec<Event<'_, Vec<f64>>> = Vec::new();
        if let (Some(function), Some(ending)) = (&function, ending) {
            events.push(Event::new(function).direction(ending.direction).terminal());
        }
        let names: Vec<&str> = ending.iter().map(|ending| ending.text.as_str()).collect();
        let outcome = self.follow(end, (&mut events, &names), &mut recording).and_then(|(summary, last)| {
            // Ended by its event between two rows.
            if !recording.remaining.is_empty() && recording.rows.last().is_some_and(|row| row.t < summary.time) {
                recording.record(summary.time, &last)?;
            }
            Ok(summary)
        });
        (recording.rows, outcome)
    }

    /// Integrates to this time, or to an event that ends it, before an onlooker; the state there. Events have names,
    /// for messages.
    pub(crate) fn follow(
        self,
        end: f64,
        (events, names): (&mut [Event<'_, Vec<f64>>], &[&str]),
        onlooker: &mut dyn Onlooker,
    ) -> Result<(Summary, Moving), String> {
        let (equations, start) = (self.equations, self.equations.start_time());
        let mut motion = equations.start();
        self.begin(&mut motion)?;
        let first = motion.clone();

        let mut solver = self.solver();
        let mut projector = equations.projector(self.settings.redundant_rows);
        let (near, way) = (self.settings.near(), self.settings.way_past_lost_rank());
        let is_projected = equations.rows() > 0 && self.settings.drift == Drift::Projected;
        let mut closed = |t: f64, moving: &mut Moving| {
            if !is_projected {
                return Ok(());
            }
            let free = moving.clone();
            projector
                .project(equations, t, moving)
                .map_err(|error| {
                    let is_lost = matches!(error, ConstraintError::Redundant { .. }) && t > start;
                    let explained = assembly::explained(equations, error, t, &free);
                    if is_lost { format!("{explained}; {way}") } else { explained }
                })
                .and_then(|()| match assembly::stays_near(near, &free, moving) {
                    true => Ok(()),
                    false => Err(assembly::strayed(equations, &first, t, [&free, moving], way)),
                })
        };

        onlooker.begin(start, &motion)?;
        let mut progress = if self.is_attended { Progress::new(start, end) } else { Progress::unseen(start, end) };
        let accelerations = |t: f64, q: &Vec<f64>, qd: &Vec<f64>, qdd: &mut Vec<f64>| {
            progress.at(t);
            // The method tries shorter steps; what is wrong is said where there is no way on.
            if equations.at(t, q, qd, |state| solver.put_accelerations(state, qdd)).is_err() {
                qdd.fill(f64::NAN);
            }
        };
        let observer = |step: &mut dyn Step<Vec<f64>>| {
            let (from, to) = (step.previous_time(), step.time());
            let mut inside = |t: f64, state: &mut Moving| {
                // Whatever is returned then, the integration ends with the reason of the method.
                step.interpolate(t, state).map_err(|error| error.to_string())?;
                closed(t, state)
            };
            onlooker.step(from, to, &mut inside)?;
            if is_projected {
                let mut end = step.state().clone();
                closed(to, &mut end)?;
                step.replace(&end);
            }
            Ok(ControlFlow::Continue(()))
        };
        let method = self.settings.method;
        let span = (start, end);
        let outcome = method.integrate(self.settings.accuracy, accelerations, span, &mut motion, events, observer);
        progress.finish();
        match outcome {
            Ok(summary) => Ok((summary, motion)),
            Err(IntegrationError::Stopped { error, .. }) => Err(format!("the integration stopped: {error}")),
            Err(IntegrationError::NonFiniteEvent { time, event }) => {
                let name = names.get(event).copied().unwrap_or_default();
                let state = format!("q = {}, qd = {}", vector(&motion.q), vector(&motion.qd));
                Err(format!(
                    "the integration stopped: `{name}` is infinite or NaN right after t = {time:?}, at {state}"
                ))
            }
            Err(error) => Err(self.stopped(error, &motion)),
        }
    }

    /// The first state, on the constraints unless they are left alone.
    fn begin(&self, motion: &mut Moving) -> Result<(), String> {
        let (equations, settings) = (self.equations, self.settings);
        if equations.rows() == 0 {
            return Ok(());
        }
        let notice = match settings.drift {
            Drift::Left => assembly::leave_open(equations, motion, settings.redundant_rows),
            Drift::Projected | Drift::Baumgarte(_) => {
                assembly::assemble(equations, motion, &settings.held, settings.redundant_rows)
            }
        };
        notice?.iter().filter(|_| self.is_attended).for_each(output::warn);
        Ok(())
    }

    /// What solves for accelerations and multipliers.
    pub(crate) fn solver(&self) -> Solver<'a, 'd> {
        let Settings { drift, redundant_rows, .. } = *self.settings;
        match (drift, redundant_rows) {
            _ if self.equations.rows() == 0 => Solver::closed(self.equations),
            (Drift::Baumgarte(gains), _) => Solver::numerical(self.equations, redundant_rows, gains),
            (_, RedundantRows::Refuse) => Solver::closed(self.equations),
            _ => Solver::numerical(self.equations, redundant_rows, [0.0; 2]),
        }
    }

    /// One line with the time and the state from which there was no way on.
    fn stopped(&self, error: IntegrationError<String>, motion: &Moving) -> String {
        let t = error.time().unwrap_or(self.equations.start_time());
        let (q, qd) = (&motion.q, &motion.qd);
        let state = self.equations.state(t, q, qd);
        let mut solver = self.solver();
        let hint = match solver.accelerations(&state) {
            Ok(_) => collapse::hint(self.equations, &mut solver, t, motion, self.settings.way_past_lost_rank()),
            Err(_) if !self.equations.are_finite(&state) => "; inertia or forces are not finite there".to_string(),
            Err(reason) => format!("; {}", assembly::explained(self.equations, reason, t, motion)),
        };
        format!("the integration stopped: {error}, at q = {}, qd = {}{hint}", vector(q), vector(qd))
    }
}

/// What keeps rows.
struct Recording<'a, 'd> {
    run: Run<'a, 'd>,
    solver: Solver<'a, 'd>,
    recorder: &'a Recorder<'d>,
    /// The times that have not come yet.
    remaining: &'a [f64],
    rows: Vec<Row>,
}

impl Onlooker for Recording<'_, '_> {
    fn begin(&mut self, t: f64, moving: &Moving) -> Result<(), String> {
        while self.next_until(t).is_some() {
            self.record(t, moving)?;
        }
        Ok(())
    }

    fn step(&mut self, _: f64, to: f64, inside: &mut Inside<'_>) -> Result<(), String> {
        let mut sampled = self.run.equations.start();
        while let Some(time) = self.next_until(to) {
            inside(time, &mut sampled)?;
            self.record(time, &sampled)?;
        }
        Ok(())
    }
}

impl Recording<'_, '_> {
    /// The next time, if it is not after `end`.
    fn next_until(&mut self, end: f64) -> Option<f64> {
        let (&next, rest) = self.remaining.split_first()?;
        (next <= end).then(|| {
            self.remaining = rest;
            next
        })
    }

    /// What is recorded of a state, all of it numbers.
    fn record(&mut self, t: f64, moving: &Moving) -> Result<(), String> {
        let (equations, solver) = (self.run.equations, &mut self.solver);
        let state = equations.state(t, &moving.q, &moving.qd);
        let [kinetic, potential] =
            [FunctionKind::KineticEnergy, FunctionKind::PotentialEnergy].map(|kind| equations.call(kind, &state)[0]);
        let multipliers =
            solver.multipliers(&state).map_err(|error| assembly::explained(equations, error, t, moving))?;
        let recorded = self
            .recorder
            .values(equations, solver, &state, &multipliers)
            .map_err(|error| assembly::explained(equations, error, t, moving))?;
        let constraints = [multipliers, equations.rows_of(FunctionKind::Constraint, &state)].concat();
        let at = format!("at t = {t:?}, q = {}, qd = {}", vector(&state.q), vector(&state.qd));
        if !(kinetic + potential).is_finite() {
            return Err(format!("T is {kinetic:?}, V is {potential:?}, {at}"));
        }
        if !constraints.iter().all(|x| x.is_finite()) {
            return Err(format!("a multiplier or a constraint is infinite or NaN, {at}"));
        }
        if let Some(i) = recorded.iter().position(|x| !x.is_finite()) {
            return Err(format!("`{}` is {:?}, {at}", self.recorder.columns()[i].name, recorded[i]));
        }
        let values = [state.q, state.qd, vec![kinetic + potential], constraints, recorded].concat();
        self.rows.push(Row { t, kinetic, potential, values });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use mbs_derive::expr::Graph;
    use mbs_derive::interpret::State;
    use mbs_derive::{declared, derived};

    use super::*;

    /// 1 mg on a thread of 2 cm, attitude by a quaternion: with M of 1e-12 kg m² and singular, accelerations that lose
    /// digits would make the steps as short as a nanosecond.
    const BEAD: &str = "mechanism Bead {
        param m: kg = 1e-6; param r: m = 1e-3; param l: m = 0.02; param g: m/s^2 = 9.81;
        coord p[3]: m; coord e[4]: 1;
        let body = translation(p) * quaternion(e[0], e[1], e[2], e[3]);
        kinetic += rigid_body(m, [0, 0, 0], diag(0.4, 0.5, 0.6)*m*r^2, body);
        potential += m*g*p[2];
        let hook = body.point([0, 0, r]);
        constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1;
        constraint thread: hook.x^2 + hook.y^2 + hook.z^2 = l^2;
    }";

    #[test]
    fn small_bodies_take_no_more_steps_than_their_motion_asks_for() {
        let graph = Graph::verbatim();
        let derivation = derived(&declared(BEAD, &graph, &[]).unwrap().0);
        let state = State {
            t: 0.0,
            q: vec![0.012, 0.0, -0.017, 1.0, 0.0, 0.0, 0.0],
            qd: vec![0.0, 0.1, 0.0, 0.0, 3.0, 0.0, 0.0],
            qdd: vec![0.0; 7],
            u: Vec::new(),
            prescribed: Vec::new(),
        };
        let start = Point { state, accelerations_are_given: false, parameters: vec![1e-6, 1e-3, 0.02, 9.81] };
        let settings = Settings {
            method: Method::Dop853,
            accuracy: Accuracy {
                relative: 1e-10,
                absolute: 1e-12,
                step: 1e-4,
                longest: f64::INFINITY,
                most_steps: 10_000,
            },
            drift: Drift::Projected,
            redundant_rows: RedundantRows::Refuse,
            held: Held::nothing(7),
        };
        let (equations, recorder) = (Equations::new(&derivation, &start).unwrap(), Recorder::new(&derivation, &[]));
        let run = Run { equations: &equations, settings: &settings, is_attended: true };
        let (rows, outcome) = run.rows(&[0.0, 0.05], &recorder, None);
        let summary = outcome.unwrap();
        assert!(summary.evaluations < 10_000, "{summary:?}");
        let energy = |row: &Row| row.kinetic + row.potential;
        assert!((energy(&rows[1]) - energy(&rows[0])).abs() < 1e-9 * rows[0].kinetic, "{rows:?}");
    }
}
