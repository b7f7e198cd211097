//! What is done with bytes of any kind, and what must hold of the answer: the bodies of the fuzz targets. They are
//! compiled in two places: here, where tests run them on damaged texts, and in `fuzz/`, where libFuzzer draws bytes.
//!
//! - [`parser`]: cut into tokens, read, printed and formatted; [`front_end`]: names and dimensions, all messages
//!   rendered; [`pipeline`]: derived, proved and emitted in every language;
//! - [`state`]: a state file for `mbs eval --state`; [`import`]: a robot of another format, or a table.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::Graph;
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::{Derivation, Instruction};
use mbs_derive::source::{Sources, Unreadable};
use mbs_derive::variable::{Variable, component_names};
use mbs_derive::{Analysis, declared, derived, parse};

use super::examine::{self, Outcome, examine, reported};
use super::robot;
use super::state::reading::{self, Point, Refusal, Request};

/// One target: what is wrong with an answer is its error.
pub type Target = fn(&[u8]) -> Result<(), String>;

/// All targets by their names.
pub const TARGETS: [(&str, Target); 5] =
    [("parser", parser), ("front_end", front_end), ("pipeline", pipeline), ("state", state), ("import", import)];

const NAME: &str = "fuzzed.mbs";

/// Mechanisms of more coordinates are left to the tests of right models: proof and page take long.
const COORDINATES: usize = 2;

/// Expressions that are compared with the text again and proved have at most this many bytes.
const BYTES: usize = 4096;

/// The text that bytes are, or nothing where they are not UTF-8 and the report of that is as it should be.
fn text(bytes: &[u8]) -> Result<Option<String>, String> {
    match parse::text(NAME, bytes.to_vec()) {
        Ok(text) => Ok(Some(text)),
        Err(report) if report.contains(&format!("--> {NAME}:")) => Ok(None),
        Err(report) => Err(format!("a report without a place: {report}")),
    }
}

fn gathered(text: &str) -> Sources {
    Sources::gather(NAME, text, |_| Err(Unreadable::new("there is no such file", "look for it")))
}

/// Tokens lie in the text, what is read is printed as it is read again, and what is formatted is formatted already.
///
/// # Errors
/// What does not hold.
pub fn parser(bytes: &[u8]) -> Result<(), String> {
    let Some(text) = text(bytes)? else { return Ok(()) };
    let sources = gathered(&text);
    let (tokens, errors) = sources.tokens();
    if let Some(token) = tokens.iter().find(|token| text.get((*token).clone()).is_none()) {
        return Err(format!("a token at {token:?} of a text of {} bytes", text.len()));
    }
    said(&errors, &sources)?;
    match sources.formatted() {
        Ok(formatted) => {
            let again = Sources::new(NAME, &formatted).formatted();
            let again =
                again.map_err(|errors| format!("what was formatted is refused:\n{}", errors.render_in(&sources)));
            if again? != formatted {
                return Err(format!("what was formatted is formatted otherwise:\n{formatted}"));
            }
        }
        Err(errors) => reported(&errors, &sources)?,
    }
    match parse::declaration_of(&sources) {
        Ok(declaration) => examine::read_back(&declaration, &sources),
        Err(errors) => reported(&errors, &sources),
    }
}

/// All messages before anything is derived, those of an editor, too, are about places within their files; numbers that
/// are accepted are finite.
///
/// # Errors
/// What does not hold.
pub fn front_end(bytes: &[u8]) -> Result<(), String> {
    let Some(text) = text(bytes)? else { return Ok(()) };
    let sources = gathered(&text);
    let (errors, meanings) = sources.surveyed();
    said(&errors, &sources)?;
    if let Some((place, _)) = meanings.iter().find(|(place, _)| sources.locate(place).1.get(place.clone()).is_none()) {
        return Err(format!("a meaning at {place:?} of a text of {} bytes", text.len()));
    }
    let graph = Graph::verbatim();
    match declared(&text, &graph, &[]) {
        Ok((lagrangian, warnings)) => {
            said(&warnings, &Sources::new(NAME, &text))?;
            defaults_are_finite(&lagrangian)
        }
        Err(errors) => reported(&errors, &Sources::new("", &text)),
    }
}

/// Derived, proved, emitted in every language, and the same a second time.
///
/// # Errors
/// What does not hold.
pub fn pipeline(bytes: &[u8]) -> Result<(), String> {
    let Some(text) = text(bytes)?.filter(|text| text.len() <= BYTES) else { return Ok(()) };
    let sources = gathered(&text);
    let graph = Graph::verbatim();
    let size = declared(&text, &graph, &[]).map_or(0, |(lagrangian, _)| lagrangian.dof());
    if size > COORDINATES {
        return Ok(());
    }
    if examine(&sources)? != Outcome::Generated {
        return Ok(());
    }
    let graph = Graph::verbatim();
    let analysis = Analysis::of(&sources, &graph).map_err(|error| error.render_in(&sources))?;
    defaults_are_finite(analysis.lagrangian())?;
    constants_are_finite(analysis.programs())?;
    for language in Language::ALL {
        let written = language.write(analysis.programs(), NAME, &Options::default());
        if written.is_empty() || language.file_name(analysis.programs()).is_empty() {
            return Err(format!("nothing is written in {}", language.name()));
        }
        let read = analysis.programs().proofread(language, &Options::default(), &written);
        read.map_err(|misprint| format!("{}: {misprint}", language.name()))?;
    }
    if analysis.mathml().is_empty() {
        return Err("the page of the textbook is empty".to_string());
    }
    Ok(())
}

/// What states are read for: the first byte says which.
pub const STATES_OF: [&str; 3] = [
    "mechanism Spring { param m: kg = 1; param k[2]: N/mm = [4, 1]; coord x: m; input f: N; \
     kinetic += m*dt(x)^2/2; potential += (k[0] + k[1])*x^2/2; force x += f; }",
    "mechanism Driven { param l: m = 1, positive; param r[2][2]: m = [[1, 0], [0, 1]]; coord q[2]: rad; \
     prescribed lift: m; prescribed swing: m = 0.1 m*sin(2 s^-1*t); \
     kinetic += 1 kg*l^2*(dt(q[0])^2 + dt(q[1])^2)/2; potential += 9.81 N*(lift + swing)*cos(q[0]); \
     force q[1] += 1 N*r[0][1]*q[0]; }",
    "mechanism Wheel { coord x: m; coord angle: rad; coord v_dot: m; input u[2]: N; \
     kinetic += 1 kg*(dt(x)^2 + dt(v_dot)^2)/2 + 1 kg*m^2*dt(angle)^2/2; \
     constraint rolls: dt(x) = 0.3 m*dt(angle); force v_dot += u[0] + u[1]; }",
];

static DERIVATIONS: OnceLock<Vec<Derivation>> = OnceLock::new();

fn derivations() -> Vec<Derivation> {
    let of = |source: &&str| {
        let graph = Graph::verbatim();
        let (lagrangian, _) =
            declared(source, &graph, &[]).unwrap_or_else(|e| panic!("{}", e.render("state.mbs", source)));
        derived(&lagrangian)
    };
    STATES_OF.iter().map(of).collect()
}

/// States that are accepted are finite and have all their numbers; what is refused is about a place, or says why.
///
/// # Errors
/// What does not hold.
pub fn state(bytes: &[u8]) -> Result<(), String> {
    let Some((&which, rest)) = bytes.split_first() else { return Ok(()) };
    let Ok(text) = std::str::from_utf8(rest) else { return Ok(()) };
    let known = DERIVATIONS.get_or_init(derivations);
    stated(text, &known[usize::from(which) % known.len()])
}

fn stated(text: &str, derivation: &Derivation) -> Result<(), String> {
    let reading = match reading::reading("state.json", text, derivation) {
        Ok(reading) => reading,
        Err(Refusal::Syntax(errors)) => return reported(&errors, &Sources::new("state.json", text)),
        Err(Refusal::Misfit(errors))
            if errors.iter().all(|error| error.starts_with("state.json: ")) && !errors.is_empty() =>
        {
            return Ok(());
        }
        Err(Refusal::Misfit(errors)) => return Err(format!("a refusal without a file: {errors:?}")),
    };
    let points = match &reading.request {
        Request::One(point) => std::slice::from_ref(point),
        Request::Many(points) => points,
    };
    let count = |variables: &[Variable]| component_names(variables).len();
    let (n, signals) = (count(&derivation.coordinates), count(&derivation.prescribed));
    let expected = [n, n, n, count(&derivation.inputs), signals, count(&derivation.parameters)];
    for Point { state, accelerations_are_given, parameters } in points {
        let (q, qd, qdd, u) = (&state.q, &state.qd, &state.qdd, &state.u);
        let found = [q.len(), qd.len(), qdd.len(), u.len(), state.prescribed.len(), parameters.len()];
        if found != expected {
            return Err(format!("{found:?} numbers, not {expected:?}"));
        }
        let numbers = [q, qd, qdd, u, parameters].into_iter().flatten();
        let numbers = numbers.chain(state.prescribed.iter().flatten()).chain([&state.t]);
        if let Some(number) = numbers.into_iter().find(|number| !number.is_finite()) {
            return Err(format!("{number} is accepted"));
        }
        if !accelerations_are_given && qdd.iter().any(|&qdd| qdd != 0.0) {
            return Err("accelerations that are not given".to_string());
        }
    }
    let are_below = |numbers: &BTreeSet<usize>, count: usize| numbers.iter().all(|&number| number < count);
    match are_below(&reading.left_out, signals) && are_below(&reading.plain, derivation.parameters.len()) {
        true => Ok(()),
        false => Err("a warning of what is not there".to_string()),
    }
}

/// Files that are imported: the first byte says of which kind.
pub const IMPORTED: [&str; 4] = ["robot.urdf", "robot.sdf", "robot.xml", "table.csv"];

/// A robot is read or refused with a place in its file; a table has finite values, or is refused.
///
/// # Errors
/// What does not hold.
pub fn import(bytes: &[u8]) -> Result<(), String> {
    let Some((&which, rest)) = bytes.split_first() else { return Ok(()) };
    let file = IMPORTED[usize::from(which & 3)];
    if file.ends_with(".csv") {
        return table(rest);
    }
    match std::str::from_utf8(rest) {
        Ok(xml) => robot::answered(u64::from(which >> 2), file, xml).map(|_| ()),
        Err(_) => Ok(()),
    }
}

/// Where a table is used.
const TABULATED: &str = "import \"table.csv\"; mechanism Tabulated { coord x: m; kinetic += 1 kg*dt(x)^2; \
    force x += -table_monotone(x, stretch, pull); }";

fn table(bytes: &[u8]) -> Result<(), String> {
    let read = |_: &str| Ok(bytes.to_vec());
    let sources = Sources::gather(NAME, TABULATED, read);
    let graph = Graph::verbatim();
    match Analysis::of(&sources, &graph) {
        Ok(analysis) => {
            said(&analysis.warnings(None), &sources)?;
            constants_are_finite(analysis.programs())
        }
        Err(mbs_derive::Error::Declaration(errors)) => reported(&errors, &sources),
        Err(error) => Err(format!("{error}")),
    }
}

/// Messages, of which there may be none.
fn said(messages: &mbs_derive::diagnostic::Diagnostics, sources: &Sources) -> Result<(), String> {
    if messages.iter().next().is_none() { Ok(()) } else { reported(messages, sources) }
}

fn defaults_are_finite(lagrangian: &Lagrangian<'_>) -> Result<(), String> {
    let mut parameters = lagrangian.parameters.iter();
    match parameters.find(|parameter| parameter.defaults.iter().any(|default| !default.to_f64().is_finite())) {
        Some(parameter) => Err(format!("`{}` has a default that is not finite", parameter.name)),
        None => Ok(()),
    }
}

fn constants_are_finite(derivation: &Derivation) -> Result<(), String> {
    let overflows =
        |instruction: &Instruction| matches!(instruction, Instruction::Constant(c) if !c.to_f64().is_finite());
    match derivation.functions.iter().find(|function| function.program.instructions.iter().any(overflows)) {
        Some(function) => Err(format!("`{}` has a constant that is not finite", function.name)),
        None => Ok(()),
    }
}
