//! Textbook output: a page of LaTeX (amsmath) with the energies, M, C, G and the equations of motion.
//!
//! Each entry is tried in several forms (multiple angles, half angles, as derived) and written in the shortest. On
//! paper a sum is a list of products, so that is what everything here becomes: numbers, parameters, coordinates,
//! trigonometric functions, in this order. Nothing recurses on the depth of an expression; what is longer than anybody
//! would write is left out, and the page says so.
//!
//! - `page`: the page and its blocks;
//! - `algebra`: expressions as polynomials, in their shortest form;
//! - `atom`: what is not taken apart, its place in a product and its powers;
//! - `condition`: conditions of piecewise expressions;
//! - `square`: squares of sums;
//! - `writing`: how products and sums are written;
//! - `layout`: lines and their widths;
//! - `notation`: names of symbols, units;
//! - `number`: numbers;
//! - `prose`: doc comments.

mod algebra;
mod atom;
mod condition;
mod layout;
mod notation;
mod number;
mod page;
mod prose;
#[cfg(test)]
mod reader;
mod square;
#[cfg(test)]
mod tests;
mod writing;

use crate::derive::Equations;
use crate::derive::textbook::MOST_COORDINATES;
use crate::model::Lagrangian;

use page::Page;

/// Energies, matrices and equations of motion as a person would write them, whichever route they were derived by: a
/// page of LaTeX that pdflatex sets.
///
/// Entries of more than 40 terms are left out, and said to be; matrices and equations of mechanisms with more than four
/// coordinates are left out with their sizes.
pub(crate) fn page(lagrangian: &Lagrangian<'_>, equations: &Equations<'_>) -> String {
    let mut page = Page::new(lagrangian, equations.lagrange.kinetic_energy.graph());
    page.title(lagrangian);
    page.symbols(lagrangian);
    page.energies(lagrangian, equations);
    if lagrangian.dof() <= MOST_COORDINATES {
        page.terms(equations);
        page.constraints(lagrangian, equations);
        page.equations_of_motion(equations);
    } else {
        page.sizes(equations);
    }
    page.conserved(equations);
    page.end();
    page.text
}
