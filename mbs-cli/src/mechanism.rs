//! From a file to a proved derivation: the passes of the generator, and the warnings on the way.

use std::path::Path;
use std::time::Instant;

use mbs_derive::emit::Options;
use mbs_derive::expr::Graph;
use mbs_derive::optimise::{Derivation, FunctionKind};
use mbs_derive::source::Sources;
use mbs_derive::{Analysis, Error};
use serde::{Deserialize, Serialize};

use crate::cache::Cache;
use crate::check::Evidence;
use crate::failure::Failure;
use crate::files::Files;
use crate::message::Messages;
use crate::output;
use crate::scene::Scene;
use crate::simulate::drive;

/// A mechanism whose programs are proved.
#[derive(Serialize, Deserialize)]
pub(crate) struct Mechanism {
    /// The programs.
    pub(crate) derivation: Derivation,
    /// How many rigid bodies and particles it was declared with.
    pub(crate) bodies: usize,
    /// At how many states it was proved.
    pub(crate) proved_at: usize,
    /// At how many of them some motion has no inertia.
    pub(crate) singular_at: usize,
    /// How much of it is proved exactly.
    pub(crate) evidence: Evidence,
    /// What standard error says of it.
    warnings: Messages,
}

impl Mechanism {
    /// What standard error says of it.
    pub(crate) fn warnings(&self) -> &Messages {
        &self.warnings
    }
}

/// A mechanism as it was just derived.
pub(crate) struct Derived<T> {
    /// With its proof.
    pub(crate) mechanism: Mechanism,
    /// From text to programs, reading and proof excluded, in seconds.
    pub(crate) derive_seconds: f64,
    /// What was taken from it besides.
    pub(crate) also: T,
}

/// Code, and what standard error says of the mechanism.
#[derive(Serialize, Deserialize)]
struct Code {
    text: String,
    warnings: Messages,
}

/// What a [`Mechanism`] is kept as.
pub(crate) const MECHANISM: &str = "mechanism";

/// What a [`Scene`] is kept as.
pub(crate) const SCENE: &str = "scene";

/// Reads a mechanism and what it imports, and notes the files.
pub(crate) fn open(path: &Path, files: &mut Files) -> Result<Sources, Failure> {
    if path == Path::new("-") {
        let message = "a mechanism is read from a file, beside which its imports are, not from standard input; a file called \
                       `-` is `./-`";
        return Err(Failure::of_usage(message));
    }
    let sources = mbs_derive::read(path).map_err(|report| Failure::from(Messages::of_file(report)))?;
    for (number, name) in sources.names().enumerate() {
        files.reads(if number == 0 { "the mechanism" } else { "the import" }, Path::new(name));
    }
    Ok(sources)
}

/// Notes the file that an earlier call has kept.
pub(crate) fn note(what: &str, sources: &Sources, cache: &Cache, files: &mut Files) {
    if let Some(path) = cache.path(what, sources) {
        files.reads("the derivation in", &path);
    }
}

/// Reads, derives and proves; for commands that write no files.
pub(crate) fn read(path: &Path, cache: &Cache) -> Result<Mechanism, Failure> {
    proved(&open(path, &mut Files::default())?, cache)
}

/// Derives and proves, unless an earlier call has; warnings go to standard error.
pub(crate) fn proved(sources: &Sources, cache: &Cache) -> Result<Mechanism, Failure> {
    let mechanism = proved_quietly(sources, cache)?;
    output::report(&mechanism.warnings);
    Ok(mechanism)
}

/// An error for a command that needs matrices and derivatives, of a mechanism so large that they are not derived.
pub(crate) fn has_matrices(derivation: &Derivation, command: &str) -> Result<(), Failure> {
    match derivation.function(FunctionKind::Linearize) {
        Some(_) => Ok(()),
        None => Err(Failure::new(format_args!(
            "{} has {} coordinates: of so large a mechanism the dynamics alone is derived, and {command} needs matrices and \
             derivatives",
            derivation.name,
            derivation.dof()
        ))),
    }
}

/// Reads, derives and proves, before warnings are reported.
fn proved_quietly(sources: &Sources, cache: &Cache) -> Result<Mechanism, Failure> {
    cache.or_make(MECHANISM, sources, || derived_and(sources, |_| ()).map(|derived| derived.mechanism))
}

/// What is written of a proved mechanism, unless an earlier call has written it: `what` tells it from other writings.
pub(crate) fn code(
    what: &str,
    sources: &Sources,
    cache: &Cache,
    write: impl FnOnce(&Derivation) -> Result<String, Error>,
) -> Result<String, Failure> {
    kept(what, sources, cache, || {
        let Mechanism { derivation, warnings, .. } = proved_quietly(sources, cache)?;
        let text = write(&derivation).map_err(|error| Failure::from(Messages::of_error(&error, sources)))?;
        Ok(Code { text, warnings })
    })
}

/// What is written of some functions of a mechanism, which alone are derived and proved.
pub(crate) fn chosen(
    what: &str,
    sources: &Sources,
    cache: &Cache,
    options: &Options,
    write: impl FnOnce(&Derivation) -> Result<String, Error>,
) -> Result<String, Failure> {
    kept(what, sources, cache, || {
        let Mechanism { derivation, warnings, .. } = derived_with(sources, options, |_| ())?.mechanism;
        let text = write(&derivation).map_err(|error| Failure::from(Messages::of_error(&error, sources)))?;
        Ok(Code { text, warnings })
    })
}

/// The equations as a page of a textbook, proved like the programs.
pub(crate) fn latex(what: &str, sources: &Sources, cache: &Cache) -> Result<String, Failure> {
    kept(what, sources, cache, || {
        let derived = derived_and(sources, |analysis| analysis.latex())?;
        Ok(Code { text: derived.also, warnings: derived.mechanism.warnings })
    })
}

/// What there is to see of a mechanism.
pub(crate) fn scene(sources: &Sources, cache: &Cache) -> Result<Scene, Failure> {
    cache.or_make(SCENE, sources, || {
        let graph = Graph::verbatim();
        let analysis = Analysis::of(sources, &graph);
        let scene = analysis.map(|analysis| Scene::of(&analysis));
        scene.map_err(|error| Failure::from(Messages::of_error(&error, sources)))
    })
}

fn kept(
    what: &str,
    sources: &Sources,
    cache: &Cache,
    make: impl FnOnce() -> Result<Code, Failure>,
) -> Result<String, Failure> {
    let Code { text, warnings } = cache.or_make(what, sources, make)?;
    output::report(&warnings);
    Ok(text)
}

/// Derives and proves, whatever is kept, and takes something else from it besides; warnings go to standard error.
pub(crate) fn proved_and<T>(sources: &Sources, also: impl Fn(&Analysis<'_>) -> T) -> Result<Derived<T>, Failure> {
    let derived = derived_and(sources, also)?;
    output::report(&derived.mechanism.warnings);
    Ok(derived)
}

/// Derived and proved, with what `also` takes from the analysis, before warnings are reported.
pub(crate) fn derived_and<T>(sources: &Sources, also: impl Fn(&Analysis<'_>) -> T) -> Result<Derived<T>, Failure> {
    derived_with(sources, &Options::default(), also)
}

fn derived_with<T>(
    sources: &Sources,
    options: &Options,
    also: impl Fn(&Analysis<'_>) -> T,
) -> Result<Derived<T>, Failure> {
    let refused = |error: Error| Failure::from(Messages::of_error(&error, sources));

    let start = Instant::now();
    let graph = Graph::verbatim();
    let analysis = Analysis::with_options(sources, &graph, options).map_err(refused)?;
    let derive_seconds = start.elapsed().as_secs_f64();

    let proof = analysis.prove(analysis.programs()).map_err(refused)?;
    let also = also(&analysis);
    // What is evaluated along a motion, and enters no equation, may have kinks.
    let mut warnings = analysis.warnings(Some(&proof));
    let watched = drive::places_of_watched(sources.main().text.as_deref().unwrap_or_default());
    warnings.retain(|warning| !watched.iter().any(|place| place.contains(&warning.span.start)));
    let mechanism = Mechanism {
        bodies: analysis.lagrangian().bodies().0.len(),
        proved_at: proof.states,
        singular_at: proof.singular,
        evidence: Evidence::of(&proof),
        warnings: Messages::of(&warnings, sources),
        derivation: analysis.into_programs(),
    };
    Ok(Derived { mechanism, derive_seconds, also })
}
