//! From a file to a proved derivation: the passes of the generator, and what the user is told on the way.

use std::fs;
use std::path::Path;
use std::time::Instant;

use mbs_derive::expr::Graph;
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::Derivation;
use mbs_derive::{Error, declared, derived, emit, parse, verify};

use crate::failure::Failure;
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

/// Reads, derives and proves; warnings go to standard error.
pub(crate) fn read(path: &Path) -> Result<Mechanism, Failure> {
    read_and(path, |_| ()).map(|(mechanism, ())| mechanism)
}

/// The equations as a page of a textbook, proved like the programs.
pub(crate) fn latex(path: &Path) -> Result<String, Failure> {
    read_and(path, emit::latex).map(|(_, text)| text)
}

fn read_and<T>(path: &Path, also: impl Fn(&Lagrangian<'_>) -> T) -> Result<(Mechanism, T), Failure> {
    let name = path.display().to_string();
    let source = read_text(path)?;
    let refused = |error: Error| Failure::rendered(error.render(&name, &source));

    let start = Instant::now();
    let graph = Graph::verbatim();
    let (lagrangian, warnings) = declared(&source, &graph, &[]).map_err(|errors| refused(errors.into()))?;
    let derivation = derived(&lagrangian);
    let derive_seconds = start.elapsed().as_secs_f64();

    let proof = verify::against_energies(&lagrangian, &derivation).map_err(|failure| refused(failure.into()))?;
    output::report(&warnings.render(&name, &source));
    let mechanism = Mechanism {
        derivation,
        bodies: lagrangian.bodies.len(),
        proved_at: proof.states,
        singular_at: proof.singular,
        derive_seconds,
    };
    Ok((mechanism, also(&lagrangian)))
}

/// A text file; where it is not UTF-8 the report says in which line.
fn read_text(path: &Path) -> Result<String, Failure> {
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| Failure::new(format_args!("cannot read {name}: {error}")))?;
    parse::text(&name.to_string(), bytes).map_err(Failure::rendered)
}
