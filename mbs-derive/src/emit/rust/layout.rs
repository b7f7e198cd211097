//! Statements that the formatter would leave as they are: it reads one name for a run of them, and their lines are put
//! in its place. Reading all as tokens would make writing a module longer by a third.

use super::super::walk::Routine;

/// The formatter breaks lines that are longer than this.
const WIDTH: usize = 89;

/// How far to the right statements of a function stand: within the module, the implementation and the function.
const INDENT: usize = 12;

/// The statements of the routine with this number, as they are to be read as tokens.
pub(super) fn abbreviated(number: usize, routine: &Routine) -> String {
    let mut indent = INDENT;
    let are_formatted = routine.lines.iter().map(|line| {
        match line.as_str() {
            "{" => indent += 4,
            "}" => indent -= 4,
            _ => {}
        }
        is_formatted(line, indent)
    });
    let are_formatted: Vec<bool> = are_formatted.collect();
    let (mut text, mut start) = (String::new(), 0);
    for run in are_formatted.chunk_by(|a, b| a == b) {
        let end = start + run.len();
        text += &match run[0] {
            true => format!("lines!({number}, {start}, {end});\n"),
            false => routine.lines[start..end].join("\n") + "\n",
        };
        start = end;
    }
    text
}

/// Whether the formatter leaves a statement as it is.
fn is_formatted(line: &str, indent: usize) -> bool {
    let is_one = line.starts_with("let ") && line.ends_with(';') && line.is_ascii();
    is_one && indent + line.len() <= WIDTH && !line.contains(['{', '|', '"', '\n'])
}

/// The formatted text with the lines of routines that names stand for.
pub(super) fn unabbreviated(text: &str, routines: &[Routine]) -> String {
    let mut whole = String::with_capacity(4 * text.len());
    for line in text.lines() {
        let indent = &line[..line.len() - line.trim_start().len()];
        let lines = named(line).map_or(&[][..], |[number, start, end]| &routines[number].lines[start..end]);
        for statement in lines {
            [indent, statement, "\n"].into_iter().for_each(|part| whole.push_str(part));
        }
        if lines.is_empty() {
            [line, "\n"].into_iter().for_each(|part| whole.push_str(part));
        }
    }
    whole
}

/// The routine, and of its lines the first one and that behind the last one, that a line of the formatted text names.
fn named(line: &str) -> Option<[usize; 3]> {
    let mut numbers = line.trim_start().strip_prefix("lines!(")?.strip_suffix(");")?.split(", ").map(str::parse);
    let mut next = || numbers.next()?.ok();
    Some([next()?, next()?, next()?])
}
