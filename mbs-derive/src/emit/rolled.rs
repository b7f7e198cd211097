//! Statements that are the same for each link of a long chain, once, in loops over the links.
//!
//! Groups of statements of links that follow each other, outwards or inwards, are one loop where they are the same
//! trees: with own locals in the place of own locals, those of the neighbour, or of the same link in an earlier sweep,
//! in the place of those, arguments of the neighbour in the place of arguments, and numbers in the place of numbers,
//! which then come from a table, as parameters and what is known before the loop come from a list. A turn of the loop
//! may be the groups of several links: where signs alternate, or joints of several kinds follow each other. What other
//! groups read is kept in arrays with a component for each turn. Run through, the loops are the statements that there
//! were, and their values have the same bits.
//!
//! - `group`: statements by their links, and which of them are alike;
//! - `run`: groups that repeat;
//! - `form`: how what differs between the turns of a loop is written;
//! - `printer`: the loops, in all languages alike but for how a component is written;
//! - `lines`: how a language writes them.

mod form;
mod group;
mod lines;
mod printer;
mod run;
#[cfg(test)]
mod tests;

use super::body::Body;
use super::expression::Tree;
use group::Groups;
pub(super) use lines::{Loops, around, head_of_c, lines, wrapped};
use printer::Printer;
use run::FEW;

/// In this many rounds at most, groups at the ends that differ from the rest are set apart.
const ROUNDS: usize = 40;

/// A body in loops.
struct Rolled {
    /// The texts of locals, those of the body first; of what is kept in arrays and tables and of arguments these are
    /// `q[i - 1]`.
    locals: Vec<String>,
    /// Names and lengths of arrays.
    arrays: Vec<(String, usize)>,
    /// Names and numbers of tables.
    tables: Vec<(String, Vec<f64>)>,
    steps: Vec<Step>,
    /// The results, each a component of an array.
    results: Vec<Tree>,
}

/// A step of a rolled body.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    /// `let local = tree;`
    Let(usize, Tree),
    /// `let list = [tree, tree];`
    List(String, Vec<Tree>),
    /// `array[i] = tree;`
    Keep(usize, Tree),
    /// What follows is of this link.
    Link(i64),
    /// What follows is of the links from one to another.
    Links([i64; 2]),
    /// `let (sines, cosines) = T::sin_cos_all(angles);` of this many angles.
    SinesAndCosines { names: [String; 2], angles: String, count: usize },
    /// A loop.
    Loop(Turns, Vec<Step>),
}

/// The turns of a loop, outwards from the first index to before the end, or inwards from the last one to the first.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Turns {
    pub(super) index: String,
    pub(super) first: usize,
    pub(super) end: usize,
    pub(super) is_inwards: bool,
}

/// The body in loops; `None` where nothing is gained, or where there are branches.
fn rolled(body: &Body<'_>, loops: &dyn Loops) -> Option<Rolled> {
    let groups = Groups::of(body)?;
    let mut excluded = vec![false; groups.all.len()];
    for _ in 0..ROUNDS {
        let runs = run::runs(&groups, &excluded);
        match form::forms(&groups, &runs) {
            Ok((forms, seeds)) => {
                let rolled: usize = runs.iter().map(|run| run.groups.len()).sum();
                return (rolled > 2 * FEW).then(|| Printer::new(body, loops, &groups, &runs, &forms, &seeds).print());
            }
            Err(wrong) => wrong.into_iter().flatten().for_each(|group| excluded[group] = true),
        }
    }
    None
}
