//! Pass 2: [`Declaration`] → [`Lagrangian`]; a user's mistakes end here.
//!
//! [`resolve`] goes through the statements in order and builds the expressions of the mechanism as they were written.
//! In reading order:
//!
//! - [`frame`]: the tree of frames, each with its pose and its twist;
//! - [`lagrangian`]: the result, and the builder API that stands under the language;
//! - [`landmark`]: what some of its expressions stand for in space;
//! - [`dimension`]: SI dimensions and units;
//! - `value`: what expressions stand for; `scope`: what names stand for; `constant`: what is known of an expression;
//! - `statement`: statements in order; `element`: arrays that loops fill; `family`: declarations with an index;
//! - `declare`: parameters, coordinates, inputs, prescribed motions, constants; `output`: outputs;
//! - `energy`: energies, generalized forces; `point_force`: forces at points, torques; `constraint`: constraints;
//! - `gravity`: the field that all bodies weigh in;
//! - `part`: statements that are used many times;
//! - `reaction`: joints whose wrenches are asked for, held and let go;
//! - `evaluate`: expressions → values; `quantity`: numbers with units; `operator`: `+ - * / ^` and `dt`;
//! - `condition`: `if … else`;
//! - `difference`: differences of places, in their nearest common frame;
//! - `builtin`: functions and methods; `function`: functions written in the language; `body`: bodies;
//! - `attitude`: axes of parameters, arrays for several arguments; `interpolation`: tables;
//! - `import`: what imported files declare;
//! - `misplaced`: places that are counted from another origin than was meant;
//! - `moments`: whether an inertia is that of a body;
//! - `check`: what must hold of the finished mechanism; `singular`, `sign`: what it was probably not meant to do;
//! - [`requirement`]: what parameters must satisfy whenever they are set; [`given`]: numbers with units, in SI units;
//! - [`sample`]: random states; [`degree`]: what must hold of the energies: `velocity`: their degree; `rank`: the rows of constraints;
//!   `inertia`: of every motion;
//!   `closure`: whether constraints can hold together.

mod attitude;
mod body;
mod builtin;
mod check;
mod closure;
mod condition;
mod constant;
mod constraint;
mod declare;
pub mod degree;
mod difference;
pub mod dimension;
mod element;
mod energy;
mod evaluate;
mod family;
pub mod frame;
mod function;
pub mod given;
mod gravity;
mod import;
mod inertia;
mod interpolation;
pub mod lagrangian;
pub mod landmark;
#[cfg(test)]
pub(crate) mod manual;
mod misplaced;
pub(crate) mod moments;
mod operator;
mod output;
mod part;
mod point_force;
mod quantity;
mod rank;
mod reaction;
pub mod requirement;
pub mod sample;
mod scope;
mod sign;
mod singular;
mod statement;
#[cfg(test)]
mod trial;
mod value;
mod velocity;

use crate::diagnostic::Diagnostics;
use crate::expr::Graph;
use crate::parse::syntax::Declaration;
use evaluate::Resolver;
use reaction::Hold;

pub use frame::{Edge, Frame, FrameId, Frames};
pub use lagrangian::{Body, Choice, Constraint, ConstraintKind, Lagrangian, Output, OutputValue, PointForce, Reaction};

/// What a declaration means, in the verbatim `graph`, and warnings about it.
///
/// # Errors
/// Every mistake in the declaration, in source order.
pub fn resolve<'g>(declaration: &Declaration, graph: &'g Graph) -> Result<(Lagrangian<'g>, Diagnostics), Diagnostics> {
    let library = function::library();
    let mut resolver = gone_through(declaration, &library, graph, Hold::of(declaration));
    if !resolver.errors.has_errors() {
        resolver.check(&declaration.name);
    }
    if resolver.errors.has_errors() {
        return Err(resolver.errors);
    }
    if let Some(hold) = resolver.released() {
        let Resolver { lagrangian, errors, .. } = gone_through(declaration, &library, graph, hold);
        if errors.has_errors() {
            return Err(errors);
        }
        resolver.lagrangian.released = Some(Box::new(lagrangian));
    }
    Ok((resolver.lagrangian, resolver.errors))
}

/// The statements in order.
fn gone_through<'d, 'g>(
    declaration: &'d Declaration,
    library: &'d Declaration,
    graph: &'g Graph,
    hold: Hold<'g>,
) -> Resolver<'d, 'g> {
    let mut resolver = Resolver::new(graph, &declaration.name.text, declaration.dimensionless);
    resolver.hold = hold;
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
