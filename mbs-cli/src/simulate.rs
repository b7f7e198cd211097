//! `mbs simulate`: a motion as a table and as a figure.
//!
//! - [`motion`]: integration, and what is recorded of it;
//! - [`progress`]: the progress bar;
//! - [`table`][]: CSV;
//! - [`figure`]: SVG and PNG.

mod figure;
mod motion;
mod progress;
mod table;

use std::path::PathBuf;

use figure::Format;
use motion::{Method, Motion};

use crate::failure::Failure;
use crate::mechanism;
use crate::output::{self, Staged};
use crate::state::{self, Point, Request};

/// Integrate a mechanism's equations of motion from a state; inputs and parameters stay as they are.
///
/// The CSV has the header `t,<coordinates>,<coordinates>_dot,energy`, energy being T + V, and one row every `--dt` seconds;
/// the last row is at the end time exactly.
#[derive(clap::Args)]
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
    /// Integration method.
    #[arg(long, value_enum, default_value_t = Method::Dop853)]
    method: Method,
    /// Relative tolerance of dop853 [default: 1e-10].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    rtol: Option<f64>,
    /// Absolute tolerance of dop853 [default: 1e-12].
    #[arg(long, value_parser = positive, allow_negative_numbers = true)]
    atol: Option<f64>,
    /// Seconds between rows, and the step of rk4; a thousandth of the duration if not given.
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true)]
    dt: Option<f64>,
    /// Write the table to a file instead of standard output.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw coordinates, velocities and energies over time.
    #[arg(long, value_name = "FILE.svg|FILE.png", value_parser = figure_path)]
    plot: Option<(PathBuf, Format)>,
}

/// Integrates, then writes.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let derivation = mechanism::read(&arguments.file)?.derivation;
    let point = match state::read(&arguments.state, &derivation)? {
        Request::One(point) => point,
        Request::Many(points) => {
            return Err(Failure::new(format_args!(
                "a motion starts from one state, found an array of {}",
                points.len()
            )));
        }
    };
    let times = times(&point, arguments)?;
    if arguments.method == Method::Rk4 && (arguments.rtol.is_some() || arguments.atol.is_some()) {
        output::report("warning: rk4 has no error control, --rtol and --atol do nothing\n");
    }
    let (relative, absolute) = (arguments.rtol.unwrap_or(1e-10), arguments.atol.unwrap_or(1e-12));
    let motion = Motion::integrate(&derivation, &point, &times, arguments.method, relative, absolute)?;
    deliver(&motion, arguments)
}

/// Files bear their names only after all have been written.
fn deliver(motion: &Motion, arguments: &Arguments) -> Result<(), Failure> {
    if let (Some(csv), Some((plot, _))) = (&arguments.csv, &arguments.plot)
        && csv == plot
    {
        return Err(Failure::new(format_args!("--csv and --plot name the same file, {}", csv.display())));
    }
    let csv = table::csv(motion);
    let mut staged = Vec::new();
    if let Some(path) = &arguments.csv {
        staged.push(Staged::new(path, csv.as_bytes())?);
    }
    if let Some((path, format)) = &arguments.plot {
        staged.push(Staged::new(path, &figure::draw(motion, *format)?)?);
    }
    staged.into_iter().try_for_each(Staged::commit)?;
    match arguments.csv {
        None => output::print(&csv),
        Some(_) => Ok(()),
    }
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
    if end == start {
        return Ok(vec![start]);
    }
    let step = arguments.dt.unwrap_or((end - start) / 1000.0);
    // A last row that would differ from the one before by rounding alone is left out.
    let count = ((end - start) / step - 1e-9).ceil().max(1.0);
    if count > MOST {
        return Err(Failure::new(format_args!("--dt {step:?} gives {count:e} rows; at most {MOST} are kept")));
    }
    let mut times: Vec<f64> = (0..count as usize).map(|i| start + i as f64 * step).collect();
    times.push(end);
    Ok(times)
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    if number.is_finite() { Ok(number) } else { Err("it must be finite".to_string()) }
}

fn positive(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number > 0.0 { Ok(number) } else { Err("it must be positive".to_string()) }
}

fn figure_path(text: &str) -> Result<(PathBuf, Format), String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("svg") => Ok((path, Format::Svg)),
        Some("png") => Ok((path, Format::Png)),
        _ => Err("a figure ends in .svg or .png".to_string()),
    }
}
