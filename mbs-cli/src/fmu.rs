//! `mbs fmu`: a mechanism for the tools that speak FMI.
//!
//! - [`variable`]: its variables, their units ([`unit`](mod@unit)) and dependencies;
//! - [`description`]: modelDescription.xml, and [`xml`];
//! - [`model`]: model.h, by which the sources know the mechanism;
//! - `fmi2.c`, `fmi3.c` and the headers beside them: the functions of the standards, the same for all mechanisms;
//! - [`binary`]: the shared library.
//!
//! Standards: *Functional Mock-up Interface for Model Exchange and Co-Simulation*, 2.0.4, and *Functional Mock-up
//! Interface Specification*, 3.0.1, Modelica Association.

mod binary;
mod description;
mod model;
mod unit;
mod variable;
mod xml;

use std::io::{Cursor, Write};
use std::path::PathBuf;

use mbs_derive::Digest;
use mbs_derive::emit;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::variable::component_names;
use mbs_runtime::RedundantRows;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use crate::cache::Cache;
use crate::equations::Equations;
use crate::failure::Failure;
use crate::files::Files;
use crate::simulate::assembly;
use crate::state::{self, Point, Request};
use crate::{mechanism, output};
use description::Description;
use model::Model;

/// Derive and prove the equations of motion, and pack them as an FMU: model exchange and co-simulation, with sources of
/// C and, where there is a C compiler, a shared library for this machine.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  mbs fmu pendulum.mbs --out pendulum.fmu --sources-only")]
pub(crate) struct Arguments {
    /// The mechanism.
    #[arg(value_name = "FILE.mbs")]
    file: PathBuf,
    /// The version of the standard.
    #[arg(long, value_enum, default_value_t = Fmi::Three)]
    fmi: Fmi,
    /// Start values: a file with a JSON object {"t": 0, "q": […], "qd": […], "u": […], "params": {…}}, all but q
    /// optional. `-` is standard input; JSON itself is taken, too. Zero and the declared parameters if not given.
    #[arg(long, value_name = "STATE.json")]
    state: Option<String>,
    /// Relative tolerance of co-simulation where the environment gives none; the absolute one is a hundredth of it.
    #[arg(long, default_value_t = 1e-10, value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// The C compiler, which arguments may follow; what the variables MBS_CC or CC name, or else cc, gcc or clang, if
    /// not given.
    #[arg(long, value_name = "COMMAND", conflicts_with = "sources_only")]
    compiler: Option<String>,
    /// Compile nothing: the environment will.
    #[arg(long)]
    sources_only: bool,
    /// Where to write it.
    #[arg(long, value_name = "FILE.fmu")]
    out: PathBuf,
}

/// A version of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Fmi {
    /// FMI 2.0.
    #[value(name = "2")]
    Two,
    /// FMI 3.0.
    #[value(name = "3")]
    Three,
}

/// The header that is made of the mechanism's own.
const MODEL: &str = "model.h";

/// What both versions share, in the order in which it is included.
const SHARED: [(&str, &str); 5] = [
    ("instance.h", include_str!("fmu/instance.h")),
    ("jacobian.h", include_str!("fmu/jacobian.h")),
    ("constraints.h", include_str!("fmu/constraints.h")),
    ("integration.h", include_str!("fmu/integration.h")),
    ("states.h", include_str!("fmu/states.h")),
];

/// Derives, compiles, packs.
pub(crate) fn run(arguments: &Arguments, cache: &Cache) -> Result<(), Failure> {
    let mut files = Files::default();
    let sources = mechanism::open(&arguments.file, &mut files)?;
    if let Some(state) = &arguments.state {
        state::note(state, &mut files);
    }
    mechanism::note(mechanism::MECHANISM, &sources, cache, &mut files);
    files.writes("--out", &arguments.out)?;
    let derivation = mechanism::proved(&sources, cache)?.derivation;
    mechanism::has_matrices(&derivation, "an FMU")?;
    let point = start(arguments, &derivation)?;
    let archive = packed(arguments, &sources, &derivation, &point)?;
    output::write(&arguments.out, &archive)?;
    output::wrote(&[&arguments.out])
}

/// The start values, brought onto the constraints.
fn start(arguments: &Arguments, derivation: &Derivation) -> Result<Point, Failure> {
    let rest = serde_json::json!({ "q": vec![0.0; derivation.dof()] }).to_string();
    let signals = component_names(&derivation.prescribed);
    let request = match &arguments.state {
        None => state::read(&rest, derivation, &signals)?,
        Some(state) => state::read(state, derivation, &[])?,
    };
    let Request::One(mut point) = request else {
        return Err(Failure::new("an FMU starts from one state, found an array"));
    };
    if !derivation.constraints.is_empty() {
        let equations = Equations::new(derivation, &point)?;
        let mut motion = equations.start();
        let held = assembly::Held::nothing(derivation.dof());
        let moved =
            assembly::assemble(&equations, &mut motion, &held, RedundantRows::LeaveOut).map_err(Failure::new)?;
        moved.iter().for_each(output::warn);
        (point.state.q, point.state.qd) = (motion.q, motion.qd);
    }
    Ok(point)
}

/// The bytes of the archive.
fn packed(
    arguments: &Arguments,
    sources: &Sources,
    derivation: &Derivation,
    point: &Point,
) -> Result<Vec<u8>, Failure> {
    let (main, wrapper) = match arguments.fmi {
        Fmi::Two => ("fmi2.c", include_str!("fmu/fmi2.c")),
        Fmi::Three => ("fmi3.c", include_str!("fmu/fmi3.c")),
    };
    let name = &derivation.name;
    let mut interface = emit::Interface::of(derivation, sources.portable_name());
    let renamed;
    let derivation = if is_taken(&interface.prefix, wrapper) {
        let mut other = derivation.clone();
        other.altered().name += "Mechanism";
        interface = emit::Interface::of(&other, sources.portable_name());
        renamed = other;
        &renamed
    } else {
        derivation
    };
    derivation.proofread_interface(&interface).map_err(Failure::new)?;
    let header = std::mem::take(&mut interface.header);
    let model = Model { derivation, interface: &interface, point, tolerance: arguments.tolerance };
    let variables = variable::variables(derivation, point, interface.switches);
    let description = Description {
        fmi: arguments.fmi,
        name,
        docs: derivation.docs.join(" "),
        identifier: &interface.prefix,
        variables: &variables,
        is_differentiable: derivation.prescribed.is_empty(),
        drifts: !derivation.constraints.is_empty(),
        tolerance: arguments.tolerance,
    };
    // An FMU is another one as soon as anything in it is.
    let (model_alone, description_alone) = (model.written(""), description.written(""));
    let own = [header.as_str(), &model_alone, &description_alone, wrapper];
    let all = own.into_iter().chain(SHARED.map(|(_, text)| text));
    let token = token(Digest::of(all.map(str::as_bytes)));
    let mut texts = vec![(model.header(), header), (MODEL.to_string(), model.written(&token))];
    texts.extend(SHARED.map(|(name, text)| (name.to_string(), text.to_string())));
    texts.push((main.to_string(), wrapper.to_string()));
    if arguments.fmi == Fmi::Three {
        texts.push(("buildDescription.xml".to_string(), description::build(&interface.prefix)));
    }
    let library = match arguments.sources_only {
        true => None,
        false => binary::compiled(arguments.compiler.as_deref(), arguments.fmi, &texts, main, &interface.prefix)?,
    };
    let mut entries = vec![("modelDescription.xml".to_string(), description.written(&token).into_bytes())];
    entries.extend(library);
    entries.extend(texts.into_iter().map(|(name, text)| (format!("sources/{name}"), text.into_bytes())));
    archived(&entries).map_err(|error| Failure::new(format_args!("cannot pack {}: {error}", arguments.out.display())))
}

/// Whether the sources that all FMUs have declare a name that is this prefix, or begins with it and `_` as the names of
/// the mechanism's own functions do: that of an output is `mode_name`, that of a step `communication_step`.
fn is_taken(prefix: &str, wrapper: &str) -> bool {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let declares = |line: &str| {
        // What is within a type or a function is no trouble: `static int states_set(…`, `} fmu_values;`.
        let declared = !line.starts_with([' ', '#', '/', '*']);
        let ends = line.match_indices(prefix).filter(|(at, _)| !line[..*at].ends_with(is_word));
        let after = ends.map(|(at, _)| &line[at + prefix.len()..]);
        declared && after.into_iter().any(|rest| rest.starts_with(['(', ';', '_']))
    };
    let texts = SHARED.iter().map(|(_, text)| *text).chain([wrapper]);
    texts.into_iter().any(|text| text.lines().any(declares))
}

/// Stored as they are, in this order, without times: the same bytes for the same mechanism.
fn archived(entries: &[(String, Vec<u8>)]) -> zip::result::ZipResult<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::DEFAULT)
        .unix_permissions(0o644);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        writer.start_file(name.as_str(), options)?;
        writer.write_all(content)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// In the form of a GUID.
fn token(digest: Digest) -> String {
    let digits = digest.to_string();
    let parts: Vec<&str> = [(0, 8), (8, 12), (12, 16), (16, 20), (20, 32)].map(|(from, to)| &digits[from..to]).to_vec();
    format!("{{{}}}", parts.join("-"))
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    let is_good = (1e-14..=1e-2).contains(&number);
    if is_good { Ok(number) } else { Err("it must be between 1e-14 and 1e-2".to_string()) }
}
