//! `mbs linearize`: the linear system about a state, what it does by itself, and what its inputs reach.

mod along;
mod exponential;
mod observation;
mod reduction;
mod system;
mod trim;

use std::fmt::Write as _;
use std::path::PathBuf;

use mbs_derive::optimise::Derivation;
use mbs_derive::variable::Variable;
use mbs_derive::variable::component_names;
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};

use crate::cache::Cache;
use crate::check::freedom::LostRank;
use crate::failure::Failure;
use crate::simulate::positive;
use crate::state::{self, Point, Request};
use crate::words::without_noise;
use crate::{mechanism, output};

use self::system::System;

/// Linearize a mechanism about a state: A, B, C, D in independent coordinates, poles, and what inputs reach.
///
/// The change of the state x = (coordinates, velocities) obeys x' = A x + B u, that of the outputs is y = C x + D u; SI
/// units, angles in radians. Where accelerations are not zero at the state, it is linearized about the motion through
/// it.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs linearize pendulum.mbs --state '{\"theta\": 0.1}' --trim theta")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// The state, as for `mbs eval`: a file with a JSON object, `-` for standard input, or JSON itself.
    #[arg(long, value_name = "STATE.json")]
    state: String,
    /// Search for a state without accelerations, on the constraints, near the given one: what may be changed, separated
    /// by commas. Coordinates and inputs by their names (`q_0` of an array q, `q` for all of it), velocities as in the
    /// table of `mbs simulate` (`x_dot`). The rest stays as given.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    trim: Vec<String>,
    /// With --trim, coordinates whose accelerations need not vanish: in a steady turn along x, the velocity across, y.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "trim")]
    accelerating: Vec<String>,
    /// Take these coordinates, and their velocities, as the independent ones; else they are chosen.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    independent: Vec<String>,
    /// The sampled system instead, with inputs held this long, in s.
    #[arg(long, value_name = "T", value_parser = positive, allow_negative_numbers = true)]
    sample_time: Option<f64>,
}

/// Prints the linear system.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let derivation = mechanism::read(&arguments.file, cache)?.derivation;
    mechanism::has_matrices(&derivation, "a linearization")?;
    let mut point = match state::read(&arguments.state, &derivation, &[])? {
        Request::One(point) => point,
        Request::Many(_) => return Err(Failure::new("`mbs linearize` takes one state, not an array of them")),
    };
    let names = component_names(&derivation.coordinates);
    let independent = numbers(&arguments.independent, &names, "coordinates", &derivation)?;
    if !arguments.trim.is_empty() {
        let free = numbers(&arguments.trim, &trim::names(&derivation), "quantities that can be trimmed", &derivation)?;
        let accelerating = numbers(&arguments.accelerating, &names, "coordinates", &derivation)?;
        trim::trim(&derivation, &mut point, &free, &accelerating)?;
    }
    LostRank::of(&derivation).warn(&point, "the state")?;
    let mut system = system::linearize(&derivation, &point, &independent)?;
    if let Some(time) = arguments.sample_time {
        system = system.sampled(time)?;
    }
    let mut report = Report::new(&derivation, &point, &system, arguments.sample_time);
    report.is_steady = !arguments.accelerating.is_empty();
    output::answer(|| report.json(), || report.text())
}

/// Which names these are, each once; that of an array, `q`, or of its rates, `q_dot`, stands for all of it.
fn numbers(given: &[String], known: &[String], what: &str, derivation: &Derivation) -> Result<Vec<usize>, Failure> {
    let mut found = Vec::new();
    let arrays =
        || derivation.coordinates.iter().chain(&derivation.inputs).filter(|variable| variable.length.is_some());
    for name in given.iter().map(|name| name.trim()) {
        let of = |suffix: &str| {
            let array = arrays().find(|variable| name.strip_suffix(suffix) == Some(variable.name.as_str()))?;
            let names: Vec<String> = array.component_names().iter().map(|name| format!("{name}{suffix}")).collect();
            names.iter().map(|name| known.iter().position(|known| known == name)).collect::<Option<Vec<usize>>>()
        };
        let one = known.iter().position(|known| known == name).map(|number| vec![number]);
        let Some(numbers) = one.or_else(|| of("")).or_else(|| of("_dot")) else {
            return Err(Failure::new(format_args!("unknown name `{name}`{}", state::hint(name, known, what))));
        };
        if numbers.iter().any(|number| found.contains(number)) {
            return Err(Failure::new(format_args!("`{name}` is named twice")));
        }
        found.extend(numbers);
    }
    Ok(found)
}

/// Names and units of components.
fn units(variables: &[Variable]) -> Vec<String> {
    variables.iter().flat_map(|variable| std::iter::repeat_n(variable.unit.clone(), variable.count())).collect()
}

/// Poles below this part of the largest one are those of integrators, which rounding has moved.
const ROUNDING: f64 = 1e-12;

/// Real parts below this part of the largest pole are what rounding leaves of zero.
const NOISE: f64 = 1e-15;

/// What is printed.
struct Report<'a> {
    point: &'a Point,
    system: &'a System,
    states: Vec<[String; 2]>,
    inputs: Vec<[String; 2]>,
    /// Eigenvalues of A, slow ones first, where they were found.
    poles: Option<Vec<Complex<f64>>>,
    sample_time: Option<f64>,
    ranks: [usize; 2],
    /// Whether accelerations are those of a steady motion that was searched for.
    is_steady: bool,
}

impl<'a> Report<'a> {
    fn new(derivation: &Derivation, point: &'a Point, system: &'a System, sample_time: Option<f64>) -> Self {
        let (names, units_of_q) = (component_names(&derivation.coordinates), units(&derivation.coordinates));
        let rate = |unit: &str| if unit == "1" { "1/s".to_string() } else { format!("{unit}/s") };
        let positions = system.coordinates.iter().map(|&i| [names[i].clone(), units_of_q[i].clone()]);
        let velocities = system.speeds.iter().map(|&i| [format!("{}_dot", names[i]), rate(&units_of_q[i])]);
        let inputs = component_names(&derivation.inputs).into_iter().zip(units(&derivation.inputs));
        let poles = system.poles();
        if poles.is_none() {
            output::warn("the eigenvalues of A were not found, or are too large: there are no poles");
        }
        Report {
            point,
            system,
            states: positions.chain(velocities).collect(),
            inputs: inputs.map(|(name, unit)| [name, unit]).collect(),
            poles,
            sample_time,
            ranks: [system.controllability_rank(), system.observability_rank()],
            is_steady: false,
        }
    }

    /// The pole of the continuous system.
    fn continuous(&self, pole: Complex<f64>) -> Complex<f64> {
        self.sample_time.map_or(pole, |time| Complex::new(magnitude(pole).ln(), pole.im.atan2(pole.re)) / time)
    }

    fn json(&self) -> Value {
        let named = |list: &[[String; 2]]| -> Value {
            list.iter().map(|[name, unit]| json!({ "name": name, "unit": unit })).collect()
        };
        let state = &self.point.state;
        let of_poles = |poles: &Vec<Complex<f64>>| poles.iter().map(|&pole| self.json_of_pole(pole)).collect();
        let poles: Value = self.poles.as_ref().map_or(Value::Null, of_poles);
        let mut report = json!({
            "state": { "t": state.t, "q": state.q, "qd": state.qd, "u": state.u },
            "accelerations": self.system.accelerations,
            "states": named(&self.states),
            "inputs": named(&self.inputs),
            "outputs": named(&self.system.outputs),
            "a": rows(&self.system.a),
            "b": rows(&self.system.b),
            "c": rows(&self.system.c),
            "d": rows(&self.system.d),
            "poles": poles,
            "controllability_rank": self.ranks[0],
            "observability_rank": self.ranks[1],
        });
        if let Some(time) = self.sample_time {
            report["sample_time"] = json!(time);
        }
        report
    }

    fn json_of_pole(&self, pole: Complex<f64>) -> Value {
        let continuous = self.continuous(pole);
        json!({
            "re": pole.re,
            "im": pole.im,
            "natural_frequency": magnitude(continuous),
            "damping_ratio": damping(continuous),
        })
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let state = &self.point.state;
        let [q, qd, u] = [&state.q, &state.qd, &state.u].map(|numbers| without_noise(numbers));
        let _ = writeln!(text, "about t = {:?}, q = {q:?}, qd = {qd:?}, u = {u:?}", state.t);
        let greatest = self.system.accelerations.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        if greatest > 1e-9 {
            let what = if self.is_steady { "accelerations that may remain:" } else { "no equilibrium: accelerations" };
            let _ = writeln!(text, "{what} {:?}", without_noise(&self.system.accelerations));
        }
        if let Some(time) = self.sample_time {
            let _ = writeln!(text, "sampled every {time:?} s");
        }
        let label = |[name, unit]: &[String; 2]| format!("{name} [{unit}]");
        let states: Vec<String> = self.states.iter().map(label).collect();
        let inputs: Vec<String> = self.inputs.iter().map(label).collect();
        let outputs: Vec<String> = self.system.outputs.iter().map(label).collect();
        let rates: Vec<String> = match self.sample_time {
            Some(_) => self.states.iter().map(|[name, unit]| format!("next {name} [{unit}]")).collect(),
            None => self.states.iter().map(|[name, unit]| format!("d/dt {name} [{unit}]")).collect(),
        };
        table(&mut text, "A", &rates, &states, &self.system.a);
        table(&mut text, "B", &rates, &inputs, &self.system.b);
        table(&mut text, "C", &outputs, &states, &self.system.c);
        table(&mut text, "D", &outputs, &inputs, &self.system.d);
        self.push_poles(&mut text);
        let (count, [controllable, observable]) = (self.states.len(), self.ranks);
        let reached = match self.inputs.len() {
            0 => "no inputs".to_string(),
            _ => format!("{controllable} of {count} states are controllable"),
        };
        let seen = match (self.system.outputs.len(), self.inputs.len()) {
            (0, _) => "no outputs".to_string(),
            (_, 0) => format!("{observable} of {count} states are observable"),
            _ => format!("{observable} observable"),
        };
        let _ = writeln!(text, "\n{reached}, {seen}");
        text
    }

    fn push_poles(&self, text: &mut String) {
        let Some(poles) = &self.poles else {
            text.push_str("\npoles: not found\n");
            return;
        };
        let unit = if self.sample_time.is_some() { "1" } else { "1/s" };
        let _ = writeln!(text, "\npoles [{unit}]                          frequency [rad/s]  damping");
        let sizes = poles.iter().map(|&pole| magnitude(self.continuous(pole))).filter(|size| size.is_finite());
        let fastest = sizes.fold(0.0, f64::max);
        let (rounding, noise_of_rates) = (ROUNDING * fastest, NOISE * fastest);
        let noise = NOISE * poles.iter().map(|&pole| magnitude(pole)).fold(0.0, f64::max);
        for &pole in poles {
            let continuous = self.continuous(pole);
            // Its sign, and its damping, are those of rounding errors.
            if magnitude(continuous) <= rounding {
                let value = if self.sample_time.is_some() { "1" } else { "0" };
                let _ = writeln!(text, "  {value:<34}  {:>16}  {:>7}", 0, "-");
                continue;
            }
            // So are the signs of what is nothing beside the fastest pole, or has no digits here.
            let real = if pole.re.abs() <= noise.max(5e-7) { 0.0 } else { pole.re };
            let damping = if continuous.re.abs() <= noise_of_rates { 0.0 } else { damping(continuous) };
            let damping = if damping.abs() < 5e-5 { 0.0 } else { damping };
            let value = format!("{real:.6} {} {:.6}i", if pole.im < 0.0 { '-' } else { '+' }, pole.im.abs());
            let _ = writeln!(text, "  {value:<34}  {:>16.6}  {damping:>7.4}", magnitude(continuous));
        }
        if poles.iter().any(|&pole| magnitude(self.continuous(pole)).is_infinite()) {
            let _ = writeln!(text, "a pole at 0: what it moves has decayed within a sample");
        }
    }
}

/// `|p|`.
fn magnitude(pole: Complex<f64>) -> f64 {
    pole.re.hypot(pole.im)
}

/// `−Re p/|p|`; 1 at zero, and where a sample leaves nothing.
fn damping(pole: Complex<f64>) -> f64 {
    let frequency = magnitude(pole);
    if frequency == 0.0 || frequency.is_infinite() { 1.0 } else { 0.0 - pole.re / frequency }
}

fn rows(matrix: &DMatrix<f64>) -> Value {
    matrix.row_iter().map(|row| Value::from(row.iter().copied().collect::<Vec<f64>>())).collect()
}

/// A matrix with names of rows and columns; nothing where it is empty.
fn table(text: &mut String, name: &str, rows: &[String], columns: &[String], matrix: &DMatrix<f64>) {
    if rows.is_empty() || columns.is_empty() {
        return;
    }
    let length = |list: &[String]| list.iter().map(|word| word.chars().count()).max().unwrap_or(0);
    let (first, width) = (length(rows).max(name.len()), length(columns).max(13));
    let _ = write!(text, "\n{name:<first$}");
    columns.iter().for_each(|column| {
        let _ = write!(text, "  {column:>width$}");
    });
    for (row, entries) in rows.iter().zip(matrix.row_iter()) {
        let _ = write!(text, "\n{row:<first$}");
        for entry in entries.iter() {
            // −0 is 0 to a reader.
            let _ = write!(text, "  {:>width$}", format!("{:.6e}", entry + 0.0));
        }
    }
    text.push('\n');
}
