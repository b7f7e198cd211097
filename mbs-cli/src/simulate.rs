//! `mbs simulate`: a motion as a table and as a figure.
//!
//! - [`method`]: the choice of an integrator;
//! - [`assembly`]: the first state on the constraints;
//! - [`motion`]: integration, and what is recorded of it; [`collapse`]: where it ends early, what is measured there;
//! - [`drive`]: inputs and prescribed signals over time, as formulas and tables; [`curve`]: functions through tables;
//! - [`until`]: what ends a motion before its time; [`formula`]: what is evaluated along it;
//! - [`record`]: what is recorded besides; [`mod@column`]: names and units;
//! - [`progress`]: the progress bar;
//! - [`table`][]: CSV;
//! - [`figure`]: SVG and PNG;
//! - [`gltf`]: an animation; `mcap`: a recording for viewers of logs, `parquet`: the table for programs, features.

pub(crate) mod assembly;
mod collapse;
pub(crate) mod column;
mod curve;
pub(crate) mod drive;
mod figure;
pub(crate) mod formula;
mod gltf;
#[cfg(feature = "mcap")]
mod mcap;
pub(crate) mod method;
pub(crate) mod motion;
#[cfg(feature = "parquet")]
mod parquet;
mod progress;
pub(crate) mod record;
mod table;
mod until;

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mbs_chart::Format;
use mbs_derive::interpret::State;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::variable::component_names;

use assembly::Held;
use drive::{Drive, Drives};
use method::{Accuracy, MOST_STEPS, Method};
use motion::{Drift, Motion, Settings};
use record::{Record, Recorder};
use until::Until;

use crate::cache::Cache;
use crate::equations::{Equations, Redundant};
use crate::failure::Failure;
use crate::files::Files;
use crate::mechanism;
use crate::output::{self, Staged};
use crate::scene::{Scene, mesh};
use crate::state::{self, Point, Request};

/// Integrate a mechanism's equations of motion from a state; parameters stay as they are, and so do inputs and
/// prescribed signals that are not given by --input and --signal.
///
/// The CSV has the header `t,<coordinates>,<coordinates>_dot,energy`, energy being T + V, and one row every `--dt`
/// seconds; the last row is at the end time exactly. Where there are constraints, multipliers `lambda_<row>` and what
/// is left of the rows, `residual_<row>`, follow; the motion starts from the nearest state that satisfies them and is
/// kept on them. Of a motion that stops before its end the rows so far are written, if there are two or more, with the
/// last line `# stopped: …`.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  mbs simulate pendulum.mbs --state '{\"theta\": 0.5}' --t-end 10 --csv motion.csv --plot motion.svg"
)]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// A file with a JSON object {"t": 0, "q": […], "qd": […], "u": […], "params": {…}}, all but q optional. `-` is
    /// standard input; JSON itself is taken, too.
    #[arg(long, value_name = "STATE.json")]
    state: String,
    /// End time in seconds; the start is the state's t.
    #[arg(long, value_name = "SECONDS", value_parser = finite, allow_negative_numbers = true)]
    t_end: f64,
    /// End the motion where a formula in the model language passes zero, before --t-end: `theta`, `height - 0.5*l
    /// falling`, `dt(x) rising`. The last row is that moment.
    #[arg(long, value_name = "FORMULA [rising|falling]", allow_hyphen_values = true)]
    until: Option<Until>,
    /// Integration method.
    #[arg(long, value_enum, default_value_t = Method::Dop853)]
    method: Method,
    /// Relative tolerance of dop853 and dopri5 [default: 1e-10].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    rtol: Option<f64>,
    /// Absolute tolerance of dop853 and dopri5 [default: 1e-12].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    atol: Option<f64>,
    /// Seconds between rows, and the step of methods without error control, which is a little less where the duration
    /// is no multiple of it; a thousandth of the duration if not given.
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// The longest step of dop853 and dopri5, which may step over what comes and goes in less time: a short push, a
    /// bump, a contact [default: --dt].
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true)]
    max_step: Option<f64>,
    /// How constraints are kept: `state`, positions and velocities are projected after each step;
    /// `baumgarte:ALPHA,BETA`, stabilization with these gains in 1/s; `none`.
    #[arg(long, value_name = "HOW", default_value = "state", value_parser = drift)]
    project: Drift,
    /// Constraints that depend on others: an error, or multipliers of the least norm.
    #[arg(long, value_enum, default_value_t = Redundant::Refuse)]
    redundant: Redundant,
    /// Coordinates that stay as given, with their velocities, when the first state is brought onto the constraints.
    #[arg(long, value_name = "COORDINATES", value_delimiter = ',')]
    hold: Vec<String>,
    /// An input over time: `push=2*sin(3*t)` is a formula in the model language of t, coordinates, velocities,
    /// parameters and outputs; `push=@table.csv` a table of times and values, straight in between. Of an array:
    /// `tau_0=…`, `tau[0]=…`, `tau=[…, …]`, `tau=@table.csv`. May be given several times.
    #[arg(long, value_name = "NAME=FORMULA|NAME=@FILE.csv")]
    input: Vec<Drive>,
    /// A prescribed signal over time: a formula of t and parameters, which is differentiated; or a table, through which
    /// a cubic spline goes, which overshoots beside jumps. Of an array as for --input. May be given several times.
    #[arg(long, value_name = "NAME=FORMULA|NAME=@FILE.csv")]
    signal: Vec<Drive>,
    /// Record more columns: outputs, inputs, accelerations, reactions, conserved; multipliers are recorded in any case.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT,…")]
    record: Vec<Record>,
    /// End the names of the columns in their units: `x_dot_m_s`, `tau_Nm`, `rate_per_s`.
    #[arg(long)]
    units: bool,
    /// Write the table to a file instead of standard output.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw coordinates, velocities, energies and what is recorded over time, a panel for each unit.
    #[arg(long, value_name = "FILE.svg|FILE.png", value_parser = output::figure_path)]
    plot: Option<(PathBuf, Format)>,
    /// Write the moving bodies as an animated glTF 2.0 binary, for any viewer: inertia ellipsoids, points, and lines
    /// between what is joined.
    #[arg(long, value_name = "FILE.glb")]
    gltf: Option<PathBuf>,
    /// Write the table as Apache Parquet, too: a column of doubles for each of the CSV's.
    #[cfg(feature = "parquet")]
    #[arg(long, value_name = "FILE.parquet")]
    parquet: Option<PathBuf>,
    /// Write the table and the frames of bodies as an MCAP recording, for viewers of robots' logs.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "FILE.mcap")]
    mcap: Option<PathBuf>,
}

impl Arguments {
    /// Whether bodies are seen in what is written.
    fn shows_bodies(&self) -> bool {
        #[cfg(feature = "mcap")]
        if self.mcap.is_some() {
            return true;
        }
        self.gltf.is_some()
    }
}

/// Integrates, then writes.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut files = Files::default();
    let sources = mechanism::open(&arguments.file, &mut files)?;
    let until = arguments.until.as_ref();
    let watched = until.map_or(Ok(Vec::new()), |until| until.watched(&sources))?;
    let drives = Drives {
        options: drive::OPTIONS,
        inputs: &arguments.input,
        signals: &arguments.signal,
        parameters: &[],
        watched: &watched,
    };
    drives.note(&mut files);
    let sources = drives.declared(sources)?;
    mechanism::note(mechanism::MECHANISM, &sources, cache, &mut files);
    if arguments.shows_bodies() {
        mechanism::note(mechanism::SCENE, &sources, cache, &mut files);
    }
    check_outputs(arguments, &mut files)?;
    let refused = |failure| until.and_then(|until| until.refused(&sources)).unwrap_or(failure);
    let derivation = mechanism::proved(&sources, cache).map_err(refused)?.derivation;
    let ending = until.map(|until| until.resolved(&derivation)).transpose()?;
    let scene = arguments.shows_bodies().then(|| mechanism::scene(&sources, cache)).transpose()?;
    if let Some(scene) = scene.as_ref().filter(|_| arguments.gltf.is_some()) {
        let mut read = Files::default();
        mesh::note(scene, &sources, &mut read);
        check_outputs(arguments, &mut read)?;
    }
    let point = match state::read(&arguments.state, &derivation, &drives.signal_names(&derivation))? {
        Request::One(point) => point,
        Request::Many(points) => {
            return Err(Failure::new(format_args!(
                "a motion starts from one state, found an array of {}",
                points.len()
            )));
        }
    };
    let times = times(&point, arguments)?;
    warn_of_idle_options(arguments, &derivation);
    let driven = drives.resolved(&derivation, (times[0], times[times.len() - 1]))?;
    driven.warn();
    let contradicts = |(i, [_, rate, acceleration]): (usize, &[f64; 3])| {
        !driven.gives_signal(i) && (*rate != 0.0 || *acceleration != 0.0)
    };
    if point.state.prescribed.iter().enumerate().any(contradicts) {
        output::warn("prescribed signals stay as given: a value that stays contradicts a rate that is not zero");
    }
    let step = step(&point, arguments).unwrap_or(1.0);
    let settings = Settings {
        method: arguments.method,
        accuracy: Accuracy {
            relative: arguments.rtol.unwrap_or(1e-10),
            absolute: arguments.atol.unwrap_or(1e-12),
            step,
            longest: arguments.max_step.unwrap_or(step),
            // Each row takes a step at least.
            most_steps: MOST_STEPS + times.len(),
        },
        drift: arguments.project,
        redundant_rows: arguments.redundant.into(),
        held: held(&arguments.hold, &derivation)?,
    };
    let recorder = Recorder::new(&derivation, &arguments.record);
    let without = recorder.empty_handed();
    if !without.is_empty() {
        output::warn(format_args!("{} has no {} to record", derivation.name, without.join(", ")));
    }
    let motion = Motion::integrate(&derivation, &point, &times, &settings, driven, &recorder, ending)?;
    if let Some(reason) = &motion.stopped {
        // What cannot say that it is a part of a motion is not written. Why it is one is said in any case.
        let delivered = deliver(&motion, &[], arguments);
        let other = delivered.err().map(|failure| failure.text());
        return Err(Failure::several(&[Some(reason.clone()), other].into_iter().flatten().collect::<Vec<_>>()));
    }
    let is_at_end = motion.rows.last().is_some_and(|row| row.t >= arguments.t_end);
    if let (Some(until), true) = (until, is_at_end) {
        output::warn(format_args!("`{}` has not happened before --t-end", until.text()));
    }
    let mut others: Vec<(&Path, Vec<u8>)> = Vec::new();
    #[cfg(feature = "parquet")]
    if let Some(path) = &arguments.parquet {
        others.push((path, parquet::table(&motion, arguments.units)?));
    }
    if let Some(scene) = scene {
        let driven = drives.resolved(&derivation, (times[0], times[times.len() - 1]))?;
        let equations = Equations::new(&derivation, &point)?.with_driven(driven);
        if let Some(path) = &arguments.gltf {
            others.push((path, animation(&scene, &sources, &equations, &point, &motion)));
        }
        #[cfg(feature = "mcap")]
        if let Some(path) = &arguments.mcap {
            let interpreter = scene.interpreter(&point.parameters);
            let states = (0..motion.rows.len()).map(|row| state_of(&equations, &point, &motion, row));
            let sights: Vec<_> = states.map(|state| scene.at(&interpreter, &state)).collect();
            others.push((path, mcap::recording(&motion, &sights, arguments.units)?));
        }
    }
    deliver(&motion, &others, arguments)
}

/// The motion as glTF.
fn animation(scene: &Scene, sources: &Sources, equations: &Equations<'_>, point: &Point, motion: &Motion) -> Vec<u8> {
    let (meshes, missing) = mesh::meshes(scene, sources);
    missing.iter().for_each(output::warn);
    let duration = motion.rows.last().map_or(0.0, |last| last.t) - motion.rows.first().map_or(0.0, |first| first.t);
    if let Some(factor) = gltf::slowdown(duration) {
        output::warn(format_args!("the animation takes 10 s, the motion {factor:.3} times as long"));
    }
    gltf::glb((scene, &meshes), &point.parameters, motion, |row| state_of(equations, point, motion, row))
}

/// The state of a row.
fn state_of(equations: &Equations<'_>, point: &Point, motion: &Motion, row: usize) -> State {
    let (n, row) = (point.state.q.len(), &motion.rows[row]);
    equations.state(row.t, &row.values[..n], &row.values[n..2 * n])
}

/// No output is a file that was read, or another output.
fn check_outputs(arguments: &Arguments, files: &mut Files) -> Result<(), Failure> {
    state::note(&arguments.state, files);
    if let Some(csv) = &arguments.csv {
        files.writes("--csv", csv)?;
    }
    if let Some((plot, _)) = &arguments.plot {
        files.writes("--plot", plot)?;
    }
    if let Some(gltf) = &arguments.gltf {
        files.writes("--gltf", gltf)?;
    }
    #[cfg(feature = "parquet")]
    if let Some(parquet) = &arguments.parquet {
        files.writes("--parquet", parquet)?;
    }
    #[cfg(feature = "mcap")]
    if let Some(mcap) = &arguments.mcap {
        files.writes("--mcap", mcap)?;
    }
    Ok(())
}

/// Says which of the options that were given have nothing to act on.
fn warn_of_idle_options(arguments: &Arguments, derivation: &Derivation) {
    let of_control = [arguments.rtol, arguments.atol, arguments.max_step];
    if !arguments.method.has_error_control() && of_control.iter().any(Option::is_some) {
        let method = arguments.method.to_possible_value();
        let name = method.as_ref().map_or("this method", |value| value.get_name());
        output::warn(format_args!("{name} has no error control, --rtol, --atol and --max-step do nothing"));
    }
    let is_held = !arguments.hold.is_empty();
    if derivation.constraints.is_empty()
        && (is_held || arguments.project != Drift::Projected || arguments.redundant != Redundant::Refuse)
    {
        let name = &derivation.name;
        output::warn(format_args!("{name} has no constraints, --project, --redundant and --hold do nothing"));
    } else if is_held && arguments.project == Drift::Left {
        output::warn("with --project none the first state stays as given, --hold does nothing");
    }
}

/// What `--hold` names.
fn held(names: &[String], derivation: &Derivation) -> Result<Held, Failure> {
    Held::named(names.iter().map(String::as_str), derivation, "--hold").map_err(|number| {
        let hint = state::hint(&names[number], &component_names(&derivation.coordinates), "coordinates");
        Failure::new(format_args!("--hold: there is no coordinate `{}`{hint}", names[number]))
    })
}

/// Files bear their names only after all have been written.
fn deliver(motion: &Motion, others: &[(&Path, Vec<u8>)], arguments: &Arguments) -> Result<(), Failure> {
    let csv = table::csv(motion, arguments.units);
    let mut staged = Vec::new();
    if let Some(path) = &arguments.csv {
        staged.push(Staged::new(path, csv.as_bytes())?);
    }
    if let Some((path, format)) = &arguments.plot {
        staged.push(Staged::new(path, &figure::draw(motion, *format)?)?);
    }
    for (path, bytes) in others {
        staged.push(Staged::new(path, bytes)?);
    }
    staged.into_iter().try_for_each(Staged::commit)?;
    let plot = arguments.plot.as_ref().map(|(path, _)| path.as_path());
    let named = [arguments.csv.as_deref(), plot].into_iter().flatten();
    let written: Vec<&Path> = named.chain(others.iter().map(|(path, _)| *path)).collect();
    match &arguments.csv {
        None => output::answer(|| table::object(motion, arguments.units, &written), || csv),
        Some(_) => output::wrote_until(&written, motion.stopped.as_deref()),
    }
}

/// The time from row to row, where there is a second one: not a difference of their times, which are rounded.
fn step(point: &Point, arguments: &Arguments) -> Option<f64> {
    let duration = arguments.t_end - point.state.t;
    (duration > 0.0).then(|| arguments.dt.unwrap_or(duration / 1000.0).min(duration))
}

/// From the state's time in steps of `--dt` to the end time, both included.
fn times(point: &Point, arguments: &Arguments) -> Result<Vec<f64>, Failure> {
    const MOST: f64 = 1e6;
    let (start, end) = (point.state.t, arguments.t_end);
    if end < start {
        return Err(Failure::new(format_args!("--t-end {end} lies before the state's t = {start}")));
    }
    if !(end - start).is_finite() {
        return Err(Failure::new(format_args!("from t = {start} to --t-end {end} is too long a time to be a number")));
    }
    let Some(step) = step(point, arguments) else { return Ok(vec![start]) };
    // A last row that would differ from the one before by rounding alone is left out.
    let count = ((end - start) / step - 1e-9).ceil().max(1.0);
    if count > MOST {
        return Err(Failure::new(format_args!("--dt {step:?} gives {count:e} rows; at most {MOST} are kept")));
    }
    let mut times: Vec<f64> = (0..count as usize).map(|i| start + i as f64 * step).collect();
    times.push(end);
    Ok(times)
}

fn drift(text: &str) -> Result<Drift, String> {
    let gain = |text: &str| match finite(text.trim()) {
        Ok(gain) if gain < 0.0 => Err(format!("a gain must not be negative, found {gain}")),
        gain => gain,
    };
    match text {
        "state" => Ok(Drift::Projected),
        "none" => Ok(Drift::Left),
        _ => match text.strip_prefix("baumgarte:").map(|gains| gains.split_once(',')) {
            Some(Some((alpha, beta))) => Ok(Drift::Baumgarte([gain(alpha)?, gain(beta)?])),
            _ => Err("one of `state`, `none`, `baumgarte:ALPHA,BETA`".to_string()),
        },
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    if number.is_finite() { Ok(number) } else { Err("it must be finite".to_string()) }
}

pub(crate) fn positive(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number > 0.0 { Ok(number) } else { Err("it must be positive".to_string()) }
}
