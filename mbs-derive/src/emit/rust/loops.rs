//! A long chain's body in loops: its tables, its arrays, and its steps.

use super::super::rolled::{Step, rolled};
use super::super::walk::Writer;
use super::syntax::literal;

/// The lines of a body of a long chain, and its values; `None` where it is not written in loops.
pub(super) fn lines(writer: &Writer<'_, '_>) -> Option<(Vec<String>, Vec<String>)> {
    let body = writer.body;
    let rolled = Some(body).filter(|body| body.is_of_long_chain).and_then(rolled)?;
    let tables = rolled.tables.iter().map(|(name, numbers)| {
        let numbers_in_text: Vec<String> = numbers.iter().map(|&number| literal(number)).collect();
        format!("static {name}: [f64; {}] = [{}];", numbers.len(), numbers_in_text.join(", "))
    });
    let arrays = rolled.arrays.iter().map(|(name, count)| format!("let mut {name} = [T::zero(); {count}];"));
    let mut lines: Vec<String> = tables.chain(arrays).collect();
    let renamed = body.renamed(rolled.locals);
    let writer = Writer { body: &renamed, ..*writer };
    lines.extend(rolled.steps.iter().map(|step| line(step, &writer)));
    Some((lines, rolled.results.iter().map(|tree| writer.print(tree)).collect()))
}

fn line(step: &Step, writer: &Writer<'_, '_>) -> String {
    let name = |local: &usize| &writer.body.locals[*local];
    match step {
        Step::Let(local, tree) => format!("let {} = {};", name(local), writer.print(tree)),
        Step::Keep(place, tree) => format!("{} = {};", name(place), writer.print(tree)),
        Step::Link(link) => writer.syntax.comment(&format!("Link {link}.")),
        Step::Links([first, last]) => writer.syntax.comment(&format!("Links {first} to {last}.")),
        Step::SinesAndCosines([sines, cosines], angles) => {
            format!("let ({sines}, {cosines}) = T::sin_cos_all({angles});")
        }
        Step::Loop { index, first, end, stride, is_inwards, steps } => {
            let lines: Vec<String> = steps.iter().map(|step| line(step, writer)).collect();
            let links = match (stride, is_inwards) {
                (1, false) => format!("{first}..{end}"),
                (1, true) => format!("({first}..{end}).rev()"),
                (stride, false) => format!("({first}..{end}).step_by({stride})"),
                (stride, true) => format!("({first}..{end}).step_by({stride}).rev()"),
            };
            format!("for {index} in {links} {{ {} }}", lines.join("\n"))
        }
    }
}
