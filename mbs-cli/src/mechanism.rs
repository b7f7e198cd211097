//! From a file to a proved derivation: the passes of the generator, and what the user is told on the way.

use std::path::Path;
use std::time::Instant;

use mbs_derive::derive::{self, Equations};
use mbs_derive::expr::Graph;
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::{self, Derivation};
use mbs_derive::source::Sources;
use mbs_derive::{Error, cargo, declared_from, emit, verify};

use crate::failure::Failure;
use crate::files::Files;
use crate::output;

/// A mechanism whose programs are proved.
pub(crate) struct Mechanism {
    /// The programs.
    pub(crate) derivation: Derivation,
    /// How many rigid bodies and particles it was declared with.
    pub(crate) bodies: usize,
    /// At how many states it was proved.
    pub(crate) proved_at: usize,
    /// At how many of them some motion has no inertia.
    pub(crate) singular_at: usize,
    /// From text to programs, reading and proof excluded, in seconds.
    pub(crate) derive_seconds: f64,
}

/// Reads a mechanism and what it imports, and notes the files.
pub(crate) fn open(path: &Path, files: &mut Files) -> Result<Sources, Failure> {
    let sources = cargo::read(path).map_err(Failure::rendered)?;
    for (number, name) in sources.names().enumerate() {
        files.reads(if number == 0 { "the mechanism" } else { "the import" }, Path::new(name));
    }
    Ok(sources)
}

/// Reads, derives and proves; for commands that write no files.
pub(crate) fn read(path: &Path) -> Result<Mechanism, Failure> {
    proved(&open(path, &mut Files::default())?)
}

/// Derives and proves; warnings go to standard error.
pub(crate) fn proved(sources: &Sources) -> Result<Mechanism, Failure> {
    proved_and(sources, |_, _, _| ()).map(|(mechanism, ())| mechanism)
}

/// The equations as a page of a textbook, proved like the programs.
pub(crate) fn latex(sources: &Sources) -> Result<String, Failure> {
    proved_and(sources, |lagrangian, routes, _| emit::latex(lagrangian, &routes[0])).map(|(_, text)| text)
}

/// Derives and proves, and takes something else from it besides.
pub(crate) fn proved_and<T>(
    sources: &Sources,
    also: impl Fn(&Lagrangian<'_>, &[Equations<'_>], &Derivation) -> T,
) -> Result<(Mechanism, T), Failure> {
    let refused = |error: Error| Failure::rendered(error.render_in(sources));

    let start = Instant::now();
    let graph = Graph::verbatim();
    let (lagrangian, mut warnings) = declared_from(sources, &graph, &[]).map_err(|errors| refused(errors.into()))?;
    let derived = Graph::new();
    let routes = derive::routes(&lagrangian, &derived);
    let derivation = optimise::straight_line(&lagrangian, &routes);
    let derive_seconds = start.elapsed().as_secs_f64();

    let proof = verify::against_energies(&lagrangian, &derivation).map_err(|failure| refused(failure.into()))?;
    proof.warn(&lagrangian, &mut warnings);
    output::report(&warnings.render_in(sources));
    let also = also(&lagrangian, &routes, &derivation);
    let mechanism = Mechanism {
        derivation,
        bodies: lagrangian.bodies().0.len(),
        proved_at: proof.states,
        singular_at: proof.singular,
        derive_seconds,
    };
    Ok((mechanism, also))
}
