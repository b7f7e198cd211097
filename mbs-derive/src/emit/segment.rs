//! Long bodies in blocks.
//!
//! Each `let` opens a scope in the one before, and the compiler recurses over scopes: rustc 1.95 on x86-64 Linux, in
//! debug mode, overflows its stack at 3400 of them (the linearization of an 18-link pendulum) and does not at 2200
//! (that of a six-joint arm). So a body of more than [`LONGEST`] statements is cut into blocks, and what leaves a block
//! is declared before all of them.
//!
//! Blocks and not functions: code generation at `opt-level = 3` takes 1.1 s for 8 700 operations in one function (the
//! arm), 0.9 s for 33 000 and 3 s for 73 000 (pendulums of 18 and 24 links); in functions that hand their values over
//! in an array it takes two to four times as long.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::Statement;
use super::expression::Tree;
use super::name::ident;
use super::text::{Text, each_leaf};

/// Statements in one block.
const LONGEST: usize = 1000;

/// Statements, in blocks if they are many; `results` follow them. What is computed on demand stands between the blocks:
/// its type has no name, so it cannot be declared before.
pub(super) fn statements(statements: &[Statement], results: &[Tree], text: &Text<'_, '_>) -> TokenStream {
    let count = statements.len();
    if count <= LONGEST {
        let statements = statements.iter().map(|s| text.statement(s, &BTreeSet::new()));
        return quote!(#(#statements)*);
    }
    let length = count.div_ceil(count.div_ceil(LONGEST));
    let pieces: Vec<&[Statement]> =
        statements.chunk_by(|a, b| !is_on_demand(a) && !is_on_demand(b)).flat_map(|run| run.chunks(length)).collect();
    let leaving = leaving(&pieces, results);
    let names = leaving.iter().map(|local| ident(text.local(*local)));
    let blocks = pieces.iter().map(|piece| {
        let statements = piece.iter().map(|s| text.statement(s, &leaving));
        if piece.iter().any(is_on_demand) { quote!(#(#statements)*) } else { quote!({ #(#statements)* }) }
    });
    let count = Literal::usize_unsuffixed(leaving.len());
    quote!(let [#(#names),*]: [T; #count]; #(#blocks)*)
}

fn is_on_demand(statement: &Statement) -> bool {
    matches!(statement, Statement::OnDemand(..))
}

/// The locals that are read outside of the block that binds them; those of one statement leave together.
fn leaving(pieces: &[&[Statement]], results: &[Tree]) -> BTreeSet<usize> {
    let numbered = || pieces.iter().enumerate().flat_map(|(i, piece)| piece.iter().map(move |s| (i, s)));
    let in_blocks = numbered().filter(|(_, statement)| !is_on_demand(statement));
    let blocks: BTreeMap<usize, usize> =
        in_blocks.flat_map(|(i, statement)| statement.binds().into_iter().map(move |local| (local, i))).collect();
    let mut read_outside = BTreeSet::new();
    for (i, statement) in numbered() {
        let outside = |local: &usize| blocks.get(local).is_some_and(|&block| block != i);
        read_outside.extend(locals(statement.trees()).into_iter().filter(outside));
    }
    read_outside.extend(locals(results.iter().collect()).into_iter().filter(|local| blocks.contains_key(local)));
    let leaves = |statement: &&Statement| statement.binds().iter().any(|local| read_outside.contains(local));
    numbered().map(|(_, statement)| statement).filter(leaves).flat_map(Statement::binds).collect()
}

/// The locals in these expressions.
fn locals(trees: Vec<&Tree>) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    each_leaf(trees.into_iter(), &mut |leaf| {
        if let Tree::Local(local) = leaf {
            found.insert(*local);
        }
    });
    found
}
