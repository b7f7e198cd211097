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

use super::super::body::{Block, Statement, locals};
use super::super::expression::Tree;
use super::super::links;
use super::super::walk::Writer;

/// Statements in one block.
const LONGEST: usize = 1000;

/// The statements of a block, in blocks if they are many. What is computed on demand stands between the blocks: its
/// type has no name, so it cannot be declared before.
pub(super) fn statements(block: &Block, writer: &Writer<'_, '_>) -> Vec<String> {
    let count = block.statements.len();
    if count <= LONGEST {
        return writer.statements(block);
    }
    let length = count.div_ceil(count.div_ceil(LONGEST));
    let runs = block.statements.chunk_by(|a, b| !is_on_demand(a) && !is_on_demand(b));
    let pieces: Vec<&[Statement]> = runs.flat_map(|run| run.chunks(length)).collect();
    let leaving = leaving(&pieces, &block.results);
    let names: Vec<&str> = leaving.iter().map(|local| writer.body.locals[*local].as_str()).collect();
    let (mut links, mut numbers) = (links::starts(&block.statements, &writer.body.links), 0..);
    let blocks = pieces.iter().flat_map(|piece| {
        let lines = piece.iter().zip(numbers.by_ref()).flat_map(|(statement, i)| {
            let leaves = statement.binds().iter().any(|local| leaving.contains(local));
            let assigned = move |line: String| match line.strip_prefix("let ") {
                Some(assignment) if leaves => assignment.to_string(),
                _ => line,
            };
            writer.below_link(links.remove(&i), statement).map(assigned)
        });
        let lines: Vec<String> = lines.collect();
        let around = if piece.iter().any(is_on_demand) { [None, None] } else { [Some("{"), Some("}")] };
        let [open, close] = around.map(|brace| brace.map(str::to_string));
        open.into_iter().chain(lines).chain(close)
    });
    std::iter::once(format!("let [{}]: [T; {}];", names.join(", "), names.len())).chain(blocks).collect()
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
        read_outside.extend(statement.reads().into_iter().filter(outside));
    }
    read_outside.extend(locals(results).into_iter().filter(|local| blocks.contains_key(local)));
    let leaves = |statement: &&Statement| statement.binds().iter().any(|local| read_outside.contains(local));
    numbered().map(|(_, statement)| statement).filter(leaves).flat_map(Statement::binds).collect()
}
