//! The whole generator run on one text, and what must hold of the result.

use std::fmt::{Debug, Display};

use mbs_derive::diagnostic::Diagnostics;
use mbs_derive::emit::{Language, Options};
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::model::Lagrangian;
use mbs_derive::numeric::Random;
use mbs_derive::optimise::Derivation;
use mbs_derive::source::Sources;
use mbs_derive::variable::component_names;
use mbs_derive::verify::Failure;
use mbs_derive::{Analysis, Error, parse};

/// How far a text came.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// It is not a text of the language.
    Unread,
    /// It was read, and its meaning refused.
    Refused,
    /// It has equations, which could not be proved: its energies are not finite, or its inertia is negative.
    Unproved,
    /// It has become Rust.
    Generated,
}

/// Mechanisms of more coordinates are not written as a page of a textbook here: it takes long.
const TEXTBOOK: usize = 2;

/// Runs every pass on a text.
///
/// # Errors
/// What does not hold that should.
pub fn examine(sources: &Sources) -> Result<Outcome, String> {
    let declaration = match parse::declaration_of(sources) {
        Ok(declaration) => declaration,
        Err(errors) => return reported(&errors, sources).map(|()| Outcome::Unread),
    };
    read_back(&declaration, sources)?;
    let graph = Graph::verbatim();
    let analysis = match Analysis::of(sources, &graph) {
        Ok(analysis) => analysis,
        Err(Error::Declaration(errors)) => return reported(&errors, sources).map(|()| Outcome::Refused),
        Err(error) => return Err(format!("{error}")),
    };
    let warnings = analysis.warnings(None);
    if warnings.iter().next().is_some() {
        reported(&warnings, sources)?;
    }
    evaluated(analysis.lagrangian(), analysis.programs())?;
    if analysis.lagrangian().dof() <= TEXTBOOK && analysis.latex().is_empty() {
        return Err("the page of the textbook is empty".to_string());
    }
    generated(&analysis, sources)
}

/// What a declaration is printed as is read as the same declaration.
///
/// # Errors
/// What differs.
pub fn read_back(declaration: &(impl Debug + Display), sources: &Sources) -> Result<(), String> {
    let printed = printed(&declaration.to_string(), sources);
    match parse::declaration_of(&printed) {
        Ok(again) => same("the declaration", &without_places(declaration), &without_places(&again)),
        Err(errors) => Err(format!("what was printed is refused:\n{}", errors.render_in(&printed))),
    }
}

/// The same code comes out a second time; a proof never fails by the generator's fault.
fn generated(analysis: &Analysis<'_>, sources: &Sources) -> Result<Outcome, String> {
    match analysis.rust(&Options::default()) {
        Ok(generated) => {
            let graph = Graph::verbatim();
            let again = Analysis::of(sources, &graph).map_err(|error| format!("the second time: {error}"))?;
            let again = Language::Rust.write(again.programs(), &sources.main().name, &Options::default());
            same("generated code", &generated.code, &again).map(|()| Outcome::Generated)
        }
        Err(Error::Proof(
            Failure::TooFewStates { .. } | Failure::NegativeInertia { .. } | Failure::Overflow { .. },
        )) => Ok(Outcome::Unproved),
        Err(error) => Err(format!("{error}")),
    }
}

fn same(what: &str, one: &str, other: &str) -> Result<(), String> {
    if one == other { Ok(()) } else { Err(format!("{what} differs:\n{one}\n---\n{other}")) }
}

/// Every message is about a place within its file, between characters, and the report names it.
pub fn reported(messages: &Diagnostics, sources: &Sources) -> Result<(), String> {
    if messages.iter().next().is_none() {
        return Err("it is refused without a message".to_string());
    }
    for message in messages.iter() {
        let places = message.notes.iter().map(|note| &note.span).chain([&message.span]);
        for place in places {
            let (_, text, span) = sources.locate(place);
            if text.get(span.clone()).is_none() {
                return Err(format!("`{}` is about {span:?} of a text of {} bytes", message.message, text.len()));
            }
        }
        if message.message.is_empty() || message.message.ends_with('.') && !message.message.ends_with("..") {
            return Err(format!("a message has no text, or a full stop: `{}`", message.message));
        }
    }
    placed(&messages.render_in(sources), sources)
}

/// Every `--> file:line:column` of a report is within the file.
fn placed(report: &str, sources: &Sources) -> Result<(), String> {
    let places: Vec<&str> = report.lines().filter_map(|line| line.trim_start().strip_prefix("--> ")).collect();
    if places.is_empty() {
        return Err(format!("a report without a place:\n{report}"));
    }
    for place in places {
        if !is_within(place, sources) {
            return Err(format!("{place} is not within the text:\n{report}"));
        }
    }
    Ok(())
}

fn is_within(place: &str, sources: &Sources) -> bool {
    let mut parts = place.rsplitn(3, ':');
    let mut number = || parts.next().and_then(|part| part.parse::<usize>().ok());
    let (Some(column), Some(line)) = (number(), number()) else { return false };
    let name = parts.next().unwrap_or_default();
    let Some(file) = (0..sources.count()).map(|i| sources.file(i)).find(|file| file.name == name) else { return false };
    let lines = file.text.as_deref().unwrap_or_default().split('\n');
    let length = lines.into_iter().nth(line.wrapping_sub(1)).map(|text| text.chars().count());
    column >= 1 && length.is_some_and(|length| column <= length + 1)
}

/// The text that a declaration was printed as, which is to be read again, in place of the mechanism's own.
fn printed(text: &str, sources: &Sources) -> Sources {
    // What is imported stands in the text again, and was read already.
    let again = (0..sources.count()).skip(1).map(|i| sources.file(i)).collect::<Vec<_>>();
    let read = |name: &str| match again.iter().find(|file| file.name == name).map(|file| file.text.clone()) {
        Some(text) => text.map(String::into_bytes),
        None => Err(mbs_derive::source::Unreadable::new("there is no such file", "")),
    };
    Sources::gather(&sources.main().name, text, read)
}

/// As `Debug` writes it, without byte ranges; `1.` is printed as `1.0`.
fn without_places(value: &impl Debug) -> String {
    let text = format!("{value:?}").replace(".\")", ".0\")");
    let mut shown = String::with_capacity(text.len());
    for (i, part) in text.split("..").enumerate() {
        let begun = part.trim_start_matches(|c: char| c.is_ascii_digit() && i > 0);
        shown += begun.trim_end_matches(|c: char| c.is_ascii_digit());
    }
    shown
}

/// Every function has all its values, at rest at the origin and at random states; finite or not.
fn evaluated(lagrangian: &Lagrangian<'_>, derivation: &Derivation) -> Result<(), String> {
    let interpreter = Interpreter::new(derivation);
    let mut random = Random::new(1);
    for state in [zero(lagrangian), random.state(lagrangian), random.state(lagrangian)] {
        for function in &derivation.functions {
            let found = interpreter.evaluate(function, &state).len();
            let expected: usize = function.results.iter().map(|part| part.shape.entries()).sum();
            if found != expected {
                return Err(format!("{} has {found} values, not {expected}", function.name));
            }
        }
    }
    Ok(())
}

fn zero(lagrangian: &Lagrangian<'_>) -> State {
    let n = lagrangian.dof();
    State {
        t: 0.0,
        q: vec![0.0; n],
        qd: vec![0.0; n],
        qdd: vec![0.0; n],
        u: vec![0.0; component_names(&lagrangian.inputs).len()],
        prescribed: vec![[0.0; 3]; component_names(&lagrangian.prescribed).len()],
    }
}
