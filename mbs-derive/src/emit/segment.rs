//! Long bodies in blocks.
//!
//! Each `let` opens a scope in the one before, and the compiler recurses over scopes: rustc 1.95 on x86-64 Linux, in
//! debug mode, overflows its stack at 3400 of them (the linearization of an 18-link pendulum) and does not at 2200 (that
//! of a six-joint arm). So a body of more than [`LONGEST`] statements is cut into blocks, and what leaves a block is
//! declared before all of them.
//!
//! Blocks and not functions: code generation at `opt-level = 3` takes 1.1 s for 8 700 operations in one function (the
//! arm), 0.9 s for 33 000 and 3 s for 73 000 (pendulums of 18 and 24 links); in functions that hand their values over in
//! an array it takes two to four times as long.

use std::collections::BTreeSet;

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{Body, Statement, Text, each_leaf};
use super::expression::Tree;
use super::name::ident;

/// Statements in one block.
const LONGEST: usize = 1000;

/// The statements of a body, in blocks if they are many.
pub(super) fn statements(body: &Body<'_>, text: &Text<'_, '_>) -> TokenStream {
    let count = body.statements.len();
    let length = count.div_ceil(count.div_ceil(LONGEST).max(1)).max(1);
    if count <= length {
        let statements = body.statements.iter().map(|s| text.statement(s, &BTreeSet::new()));
        return quote!(#(#statements)*);
    }
    let leaving = leaving(body, length);
    let names = leaving.iter().map(|local| ident(&body.locals[*local]));
    let blocks = body.statements.chunks(length).map(|block| {
        let statements = block.iter().map(|s| text.statement(s, &leaving));
        quote!({ #(#statements)* })
    });
    let count = Literal::usize_unsuffixed(leaving.len());
    quote!(let [#(#names),*]: [T; #count]; #(#blocks)*)
}

/// The locals that are read outside of the block that binds them.
fn leaving(body: &Body<'_>, length: usize) -> BTreeSet<usize> {
    let mut blocks = vec![0; body.locals.len()];
    for (i, statement) in body.statements.iter().enumerate() {
        statement.binds().for_each(|local| blocks[local] = i / length);
    }
    let mut leaving = BTreeSet::new();
    for (i, statement) in body.statements.iter().enumerate() {
        each_local(statement.tree(), |local| leaving.extend((blocks[local] != i / length).then_some(local)));
    }
    body.results.iter().for_each(|tree| each_local(tree, |local| leaving.extend([local])));
    with_partners(body, leaving)
}

/// A sine and a cosine leave together.
fn with_partners(body: &Body<'_>, mut leaving: BTreeSet<usize>) -> BTreeSet<usize> {
    for statement in &body.statements {
        if let Statement::SinCos(sin, cos, _) = statement
            && (leaving.contains(sin) || leaving.contains(cos))
        {
            leaving.extend([*sin, *cos]);
        }
    }
    leaving
}

fn each_local(tree: &Tree, mut found: impl FnMut(usize)) {
    each_leaf(std::iter::once(tree), &mut |leaf| {
        if let Tree::Local(local) = leaf {
            found(*local);
        }
    });
}
