//! Pass 2: `Declaration` → [`Lagrangian`]; a user's mistakes end here.
//!
//! `resolve` goes through the statements in order and builds the expressions of the mechanism as they were written.
//! In reading order:
//!
//! - `frame`: the tree of frames, each with its pose and its twist;
//! - `lagrangian`: the result, and the calls that it is written by; `picture`: what there is to draw;
//! - `landmark`: what some of its expressions stand for in space;
//! - `names`: what names stand for: variables, functions, parts, arrays, what is imported;
//! - `value`: what expressions stand for: numbers with dimensions, vectors, points and poses with frames;
//! - `statement`: what statements do: declare, add energies and forces, constrain, put out;
//! - `check`: what must hold of the finished mechanism, and what it was probably not meant to do.

mod check;
mod effort;
pub(crate) mod frame;
pub(crate) mod lagrangian;
pub(crate) mod landmark;
#[cfg(test)]
pub(crate) mod manual;
mod names;
mod picture;
mod report;
mod statement;
mod value;

use crate::diagnostic::Diagnostics;
use crate::expr::Graph;
use crate::parse::StatementKind;
use crate::parse::syntax::{Declaration, Span};
use names::function;
use statement::drawing::has_shapes;
use statement::reaction::Hold;
use value::builtin::{self, Builtin};
use value::dimension::{NamedUnit, UNITS};
use value::evaluate::Resolver;

pub(crate) use check::{requirement, sample};
pub(crate) use frame::{Edge, FrameId};
pub(crate) use lagrangian::{Body, Constraint, PointForce, Reaction};
pub use lagrangian::{ConstraintKind, Lagrangian, OutputValue};
pub use statement::given::Unit;

/// What a declaration means, in the verbatim `graph`, and warnings about it.
///
/// # Errors
/// Every mistake in the declaration, in source order.
pub(crate) fn resolve<'g>(
    declaration: &Declaration,
    graph: &'g Graph,
) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    let library = function::library();
    let mut resolver = gone_through(declaration, &library, graph, Hold::of(declaration), false);
    if has_shapes(declaration) {
        let drawn = gone_through(declaration, &library, graph, Hold::of(declaration), true);
        if drawn.report.errors.has_errors() {
            return Err(drawn.report.errors);
        }
        resolver.lagrangian.drawn = Some(Box::new(Lagrangian(drawn.lagrangian)));
    }
    if !resolver.report.errors.has_errors() {
        resolver.check(&declaration.name);
    }
    if resolver.report.errors.has_errors() {
        return Err(resolver.report.errors);
    }
    if let Some(hold) = resolver.released() {
        let Resolver { lagrangian, report, .. } = gone_through(declaration, &library, graph, hold, false);
        if report.errors.has_errors() {
            return Err(report.errors);
        }
        resolver.warn_of_idle_reactions(&lagrangian);
        resolver.lagrangian.released = Some(Box::new(Lagrangian(lagrangian)));
    }
    resolver.report.errors.append(declaration.warnings.clone());
    Ok((Lagrangian(resolver.lagrangian), resolver.report.errors))
}

/// What is wrong with a declaration or doubtful in it, and what its names stand for, in words, by their places: also
/// where it is wrong. With `is_whole` the mechanism as a whole is checked, too.
pub(crate) fn surveyed(declaration: &Declaration, is_whole: bool) -> (Diagnostics, Vec<(Span, String)>) {
    let (graph, library) = (Graph::verbatim(), function::library());
    let mut resolver = gone_through(declaration, &library, &graph, Hold::of(declaration), true);
    if is_whole && !resolver.report.errors.has_errors() {
        resolver.check(&declaration.name);
    }
    (resolver.report.errors, resolver.names.meanings.into_values().collect())
}

/// Kind, name, and form or meaning of all words that a text may be made of besides names of its own.
pub(crate) fn words() -> Vec<(&'static str, String, String)> {
    let builtin = |kind, table: &'static [Builtin]| table.iter().map(move |f| (kind, f.name.into(), f.form().into()));
    let unit = |unit: &NamedUnit| ("unit", unit.name.to_string(), unit.in_words());
    let library = function::library();
    let of_library = library.statements.iter().filter_map(|statement| match &statement.kind {
        StatementKind::Function { name, parameters, .. } => {
            let parameters: Vec<&str> = parameters.iter().map(|parameter| parameter.text.as_str()).collect();
            Some(("function", name.text.clone(), format!("{}({})", name.text, parameters.join(", "))))
        }
        _ => None,
    });
    let functions = builtin("function", builtin::FUNCTIONS).chain(of_library);
    functions.chain(builtin("method", builtin::METHODS)).chain(UNITS.iter().map(unit)).collect()
}

/// The statements in order; `draws` says whether shapes are among them.
fn gone_through<'d, 'g>(
    declaration: &'d Declaration,
    library: &'d Declaration,
    graph: &'g Graph,
    hold: Hold<'g>,
    draws: bool,
) -> Resolver<'d, 'g> {
    let mut resolver = Resolver::new(graph, &declaration.name.text, declaration.dimensionless, hold);
    resolver.draws = draws;
    resolver.lagrangian.docs = declaration.docs.clone();
    resolver.provide(&library.statements);
    resolver.import(&declaration.imported);
    resolver.survey(&declaration.statements);
    resolver.statements(&declaration.statements);
    resolver.weigh();
    resolver.gather_outputs();
    resolver.check_families();
    resolver.let_go();
    resolver
}
