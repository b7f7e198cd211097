//! `mbs report`: all that is known of a mechanism on one page, with its motion, in one file that asks for no other.
//!
//! - [`mod@page`]: the page, section by section; [`html`]: its elements;
//! - [`about`]: what the scripts are told;
//! - [`start`]: a state to begin with, where none is given; [`accuracy`]: what rounding does along the motion from it;
//! - `report/page.html`, `style.css`, `*.js`: the page's own parts, modules that are written one after the other into
//!   one script. `dop853.js`, `projection.js` and `motion.js` are tested in node against `mbs simulate`.

mod about;
mod accuracy;
mod html;
mod page;
mod start;

use std::path::PathBuf;

use mbs_derive::Analysis;
use mbs_derive::emit::{Language, Options};
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::cache::Cache;
use crate::failure::Failure;
use crate::files::Files;
use crate::mechanism::{self, Mechanism};
use crate::ops::explanation::Explanation;
use crate::output;
use crate::scene::{Scene, mesh};
use crate::state::{self, Point, Request};

/// Write a page about a mechanism: its declaration, typeset equations, costs, accuracy and proof, and the mechanism
/// itself, moving, with sliders for parameters and state.
///
/// The page is one file without network: it opens from a disk, in any browser. Its motion is computed in it, by the
/// emitted JavaScript.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs report pendulum.mbs --state '{\"theta\": 0.5}' --out report.html")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// Write to a file instead of standard output.
    #[arg(long, value_name = "FILE.html")]
    out: Option<PathBuf>,
    /// The state from which it moves at first: a file, `-` for standard input, or JSON itself, {"q": […], "qd": […],
    /// "u": […], "params": {…}}, all but q optional. One that moves is chosen if not given.
    #[arg(long, value_name = "STATE.json")]
    state: Option<String>,
    /// Seconds from there.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = duration)]
    t_end: f64,
}

/// What a report says whatever the state is; kept from call to call.
#[derive(Serialize, Deserialize)]
struct Parts {
    mechanism: Mechanism,
    /// Typeset, as HTML.
    equations: String,
    /// The routes and their costs, as JSON.
    costs: String,
    scene: Scene,
}

/// Writes the page.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut files = Files::default();
    let sources = mechanism::open(&arguments.file, &mut files)?;
    mechanism::note(REPORT, &sources, cache, &mut files);
    if let Some(state) = &arguments.state {
        state::note(state, &mut files);
    }
    if let Some(out) = &arguments.out {
        files.writes("--out", out)?;
    }
    let parts = parts(&sources, cache)?;
    if let Some(out) = &arguments.out {
        let mut read = Files::default();
        mesh::note(&parts.scene, &sources, &mut read);
        read.writes("--out", out)?;
    }
    output::report(parts.mechanism.warnings());
    let derivation = &parts.mechanism.derivation;
    mechanism::has_matrices(derivation, "a report")?;
    let start = match &arguments.state {
        None => start::of(derivation),
        Some(state) => one(state, derivation)?,
    };
    let page = page::page(&sources, &parts, &start, arguments.t_end)?;
    match &arguments.out {
        Some(out) => {
            output::write(out, page.as_bytes())?;
            output::wrote(&[out])
        }
        None => output::answer(|| json!({ "page": page }), || page.clone()),
    }
}

/// What [`Parts`] are kept as.
const REPORT: &str = "report";

fn parts(sources: &Sources, cache: &Cache) -> Result<Parts, Failure> {
    cache.or_make(REPORT, sources, || {
        let also = |analysis: &Analysis<'_>| {
            (analysis.mathml(), Explanation::of(analysis).object().to_string(), Scene::of(analysis))
        };
        let derived = mechanism::derived_and(sources, also)?;
        let (equations, costs, scene) = derived.also;
        Ok(Parts { mechanism: derived.mechanism, equations, costs, scene })
    })
}

fn one(argument: &str, derivation: &Derivation) -> Result<Point, Failure> {
    match state::read(argument, derivation, &[])? {
        Request::One(point) => Ok(point),
        Request::Many(points) => {
            Err(Failure::new(format_args!("a motion starts from one state, found an array of {}", points.len())))
        }
    }
}

/// A module of JavaScript with these functions alone, as an expression: its class.
fn module(derivation: &Derivation, source: &str, functions: Vec<String>) -> String {
    let options = Options::default().functions(functions);
    let module = Language::Js.write(derivation, source, &options);
    // The class is the last of what the module has, and the only thing that it exports.
    format!("(() => {{\n{}\n}})()", module.trim_end().replace("\nexport class ", "\nreturn class "))
}

/// JSON inside a script: nothing in it ends the script.
fn in_script(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

fn duration(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().map_err(|error| error.to_string())?;
    if seconds > 0.0 && seconds.is_finite() { Ok(seconds) } else { Err("it must be positive".to_string()) }
}
