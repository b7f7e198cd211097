//! What loops over the links of a long chain need in C.

use super::super::rolled::{Loops, Turns, around, head_of_c, wrapped};
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
        around(head_of_c("int", turns), &statements, 4, Some("}"))
    }
}

/// An array of these values.
fn listed(declared: &str, values: &[String]) -> Vec<String> {
    wrapped(&format!("{declared}[{}] = {{", values.len()), values, "};", WIDEST)
}
