//! The lines of a body in loops, in any language that can write them.

use super::super::expression::Tree;
use super::super::walk::{Syntax, Writer, indented};
use super::{Step, Turns, rolled};

/// How a language writes what loops need beside statements.
pub(in crate::emit) trait Loops: Syntax {
    /// The index of the first component of an array.
    fn first(&self) -> i64 {
        0
    }
    /// A component of an array, a list or a table.
    fn component(&self, array: &str, place: &str) -> String {
        format!("{}[{place}]", self.identifier(array))
    }
    /// A component of an argument.
    fn argument(&self, name: &str, place: &str) -> String {
        format!("{name}[{place}]")
    }
    /// Gives a component of an array its value.
    fn keep(&self, component: &str, value: &str) -> String {
        format!("{component} = {value};")
    }
    /// A table of numbers: a list of constants, where they have to be nothing else.
    fn table(&self, name: &str, numbers: &[f64]) -> Vec<String> {
        let numbers: Vec<String> = numbers.iter().map(|&number| self.constant(number)).collect();
        self.list(name, &numbers)
    }
    /// A list of values.
    fn list(&self, name: &str, values: &[String]) -> Vec<String>;
    /// A component of a table, as a value.
    fn entry(&self, component: String) -> String {
        component
    }
    /// An array whose components are given values one after the other.
    fn array(&self, name: &str, count: usize) -> String;
    /// Arrays of the sines and the cosines of this many angles.
    fn sines_and_cosines(&self, names: &[String; 2], angles: &str, count: usize) -> Vec<String>;
    /// Statements that are carried out once a turn.
    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String>;
}

/// The lines of a body of a long chain, and its values; `None` where it is not written in loops.
pub(in crate::emit) fn lines(writer: &Writer<'_, '_>, loops: &dyn Loops) -> Option<(Vec<String>, Vec<String>)> {
    let (body, syntax) = (writer.body, writer.syntax);
    let rolled = Some(body).filter(|body| body.is_of_long_chain).and_then(|body| rolled(body, loops))?;
    let tables = rolled.tables.iter().flat_map(|(name, numbers)| loops.table(&syntax.identifier(name), numbers));
    let arrays = rolled.arrays.iter().map(|(name, count)| loops.array(&syntax.identifier(name), *count));
    let mut lines: Vec<String> = tables.chain(arrays).collect();
    let renamed = body.renamed(rolled.locals);
    let writer = Writer { body: &renamed, ..*writer };
    lines.extend(rolled.steps.iter().flat_map(|step| of_step(step, &writer, loops)));
    Some((lines, rolled.results.iter().map(|tree| writer.print(tree)).collect()))
}

fn of_step(step: &Step, writer: &Writer<'_, '_>, loops: &dyn Loops) -> Vec<String> {
    let syntax = writer.syntax;
    let name = |local: &usize| syntax.leaf(&Tree::Local(*local), writer.body);
    match step {
        Step::Let(local, tree) => vec![syntax.bind(&name(local), &writer.print(tree))],
        Step::List(list, values) => {
            let values: Vec<String> = values.iter().map(|value| writer.print(value)).collect();
            loops.list(&syntax.identifier(list), &values)
        }
        Step::Keep(place, tree) => vec![loops.keep(&name(place), &writer.print(tree))],
        Step::Link(link) => vec![syntax.comment(&format!("Link {link}."))],
        Step::Links([first, last]) => vec![syntax.comment(&format!("Links {first} to {last}."))],
        Step::SinesAndCosines { names, angles, count } => {
            let names = names.each_ref().map(|name| syntax.identifier(name));
            loops.sines_and_cosines(&names, &syntax.identifier(angles), *count)
        }
        Step::Loop(turns, steps) => {
            loops.repeated(turns, steps.iter().flat_map(|step| of_step(step, writer, loops)).collect())
        }
    }
}

/// The head of a loop, as C writes it, with an index that is declared by this word.
pub(in crate::emit) fn head_of_c(declared: &str, turns: &Turns) -> String {
    let Turns { index, first, end, is_inwards } = turns;
    match is_inwards {
        false => format!("for ({declared} {index} = {first}; {index} < {end}; {index} += 1) {{"),
        true => format!("for ({declared} {index} = {}; {index} >= {first}; {index} -= 1) {{", end - 1),
    }
}

/// A loop: what it begins with, its statements, and what it ends with.
pub(in crate::emit) fn around(head: String, statements: &[String], by: usize, end: Option<&str>) -> Vec<String> {
    std::iter::once(head).chain(indented(statements, by)).chain(end.map(String::from)).collect()
}

/// A list with several values in a line, a comma behind each, and what is before and behind it in lines of their own.
pub(in crate::emit) fn wrapped(open: &str, values: &[String], close: &str, widest: usize) -> Vec<String> {
    let mut lines = vec![open.to_string(), "   ".to_string()];
    for value in values {
        match lines.last_mut().filter(|line| line.len() + value.len() + 2 <= widest) {
            Some(line) => line.extend([" ", value, ","]),
            None => lines.push(format!("    {value},")),
        }
    }
    lines.push(close.to_string());
    lines
}
