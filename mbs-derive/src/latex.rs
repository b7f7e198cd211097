//! Textbook output: a document of LaTeX (amsmath) with symbols and their defaults, outputs, energies, M, C, G and the
//! equations of motion.
//!
//! Each entry is tried in several forms (multiple angles, half angles, as derived) and written in the shortest. On
//! paper a sum is a list of products, so that is what everything here becomes: numbers, parameters, coordinates,
//! trigonometric functions, in this order. Nothing recurses on the depth of an expression; what is longer than anybody
//! would write is written by its recursion, and where even that is endless the page says which function computes it.
//!
//! - `page`: the page and its blocks; `plan`: what it shows, and by which route;
//! - `algebra`: expressions as polynomials, in their shortest form; `recursion`: what is too long for that, by named
//!   intermediate results;
//! - `atom`: what is not taken apart, its place in a product and its powers;
//! - `condition`: conditions of piecewise expressions;
//! - `square`: squares of sums; `angle`: sums of angles, `s_{23}`;
//! - `writing`: how products and sums are written;
//! - `layout`: lines and their widths;
//! - `notation`: names of symbols, units;
//! - `number`: numbers;
//! - `prose`: doc comments;
//! - `mathml`: the page as HTML with MathML.

mod algebra;
mod angle;
mod atom;
mod condition;
mod layout;
pub(crate) mod mathml;
mod notation;
mod number;
mod page;
mod plan;
#[cfg(test)]
mod proof;
mod prose;
#[cfg(test)]
mod reader;
mod recursion;
mod square;
#[cfg(test)]
mod tests;
mod writing;

use crate::derive::Equations;
use crate::model::Lagrangian;

use page::Page;

/// Energies, matrices, outputs and equations of motion as a person would write them: a page of LaTeX that pdflatex
/// sets.
///
/// Entries that are too long to be multiplied out, by the first of the routes, are written by the recursion that
/// computes them, by the cheapest route: a name for each intermediate result, which is used from there on.
pub(crate) fn page(lagrangian: &Lagrangian<'_>, routes: &[Equations<'_>]) -> String {
    composed(lagrangian, routes).finished()
}

fn composed<'g>(lagrangian: &Lagrangian<'_>, routes: &[Equations<'g>]) -> Page<'g> {
    let equations = &routes[0];
    let mut page = Page::new(lagrangian, routes);
    page.title(lagrangian);
    page.symbols(lagrangian);
    page.outputs(lagrangian, equations);
    page.energies(lagrangian, equations);
    page.terms(equations);
    page.constraints(lagrangian, equations);
    page.equations_of_motion(equations);
    page.conserved(equations);
    page
}
