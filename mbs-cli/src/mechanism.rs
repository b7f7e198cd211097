//! From a file to a proved derivation: the passes of the generator, and what the user is told on the way.

use std::fs;
use std::path::Path;
use std::time::Instant;

use mbs_derive::derive::{self, Equations};
use mbs_derive::expr::Graph;
use mbs_derive::model::Lagrangian;
use mbs_derive::optimise::{self, Derivation};
use mbs_derive::{Error, declared, emit, verify};

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
    read_and(path, |_, _| ()).map(|(mechanism, ())| mechanism)
}

/// The equations as a page of a textbook, proved like the programs.
pub(crate) fn latex(path: &Path) -> Result<String, Failure> {
    read_and(path, |lagrangian, routes| emit::latex(lagrangian, &routes[0])).map(|(_, text)| text)
}

fn read_and<T>(path: &Path, also: impl Fn(&Lagrangian<'_>, &[Equations<'_>]) -> T) -> Result<(Mechanism, T), Failure> {
    let name = path.display().to_string();
    let source = read_text(path)?;
    let refused = |error: Error| Failure::rendered(error.render(&name, &source));

    let start = Instant::now();
    let graph = Graph::verbatim();
    let (lagrangian, warnings) = declared(&source, &graph, &[]).map_err(|errors| refused(errors.into()))?;
    let derived = Graph::new();
    let routes = derive::routes(&lagrangian, &derived);
    let derivation = optimise::straight_line(&lagrangian, &routes);
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
    Ok((mechanism, also(&lagrangian, &routes)))
}

/// A text file; where it is not UTF-8 the report says in which line.
fn read_text(path: &Path) -> Result<String, Failure> {
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| Failure::new(format_args!("cannot read {name}: {error}")))?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..valid]).into_owned();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let (line, column) = (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1);
        Failure::rendered(format!("error: this is not UTF-8 text\n --> {name}:{line}:{column}\n"))
    })
}
