//! What loops over the links of a long chain need in C.

use super::super::rolled::{Loops, Turns};
use super::WIDEST;
use super::syntax::{C, constant};

impl Loops for C<'_, '_> {
    fn table(&self, name: &str, numbers: &[f64]) -> Vec<String> {
        let numbers: Vec<String> = numbers.iter().map(|&number| constant(number)).collect();
        listed(&format!("static const mbs_real {name}"), &numbers)
    }

    fn list(&self, name: &str, values: &[String]) -> Vec<String> {
        listed(&format!("const mbs_real {name}"), values)
    }

    fn number(&self, component: &str) -> String {
        component.to_string()
    }

    fn array(&self, name: &str, count: usize) -> String {
        format!("mbs_real {name}[{count}];")
    }

    fn sines_and_cosines(&self, [sines, cosines]: &[String; 2], angles: &str, count: usize) -> Vec<String> {
        vec![
            format!("mbs_real {sines}[{count}], {cosines}[{count}];"),
            format!("mbs_sin_cos_all({count}, {angles}, {sines}, {cosines});"),
        ]
    }

    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String> {
        let Turns { index, first, end, is_inwards } = turns;
        let head = match is_inwards {
            false => format!("for (int {index} = {first}; {index} < {end}; {index} += 1) {{"),
            true => format!("for (int {index} = {}; {index} >= {first}; {index} -= 1) {{", end - 1),
        };
        let inside = statements.into_iter().map(|line| format!("    {line}"));
        std::iter::once(head).chain(inside).chain(["}".to_string()]).collect()
    }
}

/// An array of these values, several in a line.
fn listed(declared: &str, values: &[String]) -> Vec<String> {
    let mut lines = vec![format!("{declared}[{}] = {{", values.len()), "   ".to_string()];
    for value in values {
        match lines.last_mut().filter(|line| line.len() + value.len() + 2 <= WIDEST) {
            Some(line) => line.extend([" ", value, ","]),
            None => lines.push(format!("    {value},")),
        }
    }
    lines.push("};".to_string());
    lines
}
