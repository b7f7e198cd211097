//! What loops over the links of a long chain need in Rust.

use super::super::rolled::{Loops, Turns};
use super::syntax::{Rust, literal};

impl Loops for Rust<'_, '_> {
    fn table(&self, name: &str, numbers: &[f64]) -> Vec<String> {
        let numbers_in_text: Vec<String> = numbers.iter().map(|&number| literal(number)).collect();
        vec![format!("static {name}: [f64; {}] = [{}];", numbers.len(), numbers_in_text.join(", "))]
    }

    fn list(&self, name: &str, values: &[String]) -> Vec<String> {
        vec![format!("let {name} = [{}];", values.join(", "))]
    }

    fn entry(&self, component: String) -> String {
        format!("T::from_f64({component})")
    }

    fn array(&self, name: &str, count: usize) -> String {
        format!("let mut {name} = [T::zero(); {count}];")
    }

    fn sines_and_cosines(&self, [sines, cosines]: &[String; 2], angles: &str, _count: usize) -> Vec<String> {
        vec![format!("let ({sines}, {cosines}) = T::sin_cos_all({angles});")]
    }

    /// In one line: what stands in it is read as tokens.
    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String> {
        let Turns { index, first, end, is_inwards } = turns;
        let links = if *is_inwards { format!("({first}..{end}).rev()") } else { format!("{first}..{end}") };
        vec![format!("for {index} in {links} {{ {} }}", statements.join("\n"))]
    }
}
