//! What loops over the links of a long chain need in languages that are not compiled.

use super::super::rolled::{Loops, Turns, around, head_of_c, wrapped};
use super::super::walk::Syntax;
use super::WIDEST;
use super::js::Js;
use super::matlab::Matlab;
use super::python::Python;

impl Loops for Js {
    fn list(&self, name: &str, values: &[String]) -> Vec<String> {
        wrapped(&format!("const {name} = ["), values, "];", WIDEST)
    }

    fn array(&self, name: &str, count: usize) -> String {
        format!("const {name} = new Float64Array({count});")
    }

    fn sines_and_cosines(&self, [sines, cosines]: &[String; 2], angles: &str, _count: usize) -> Vec<String> {
        vec![format!("const [{sines}, {cosines}] = mbs_sin_cos_all({angles});")]
    }

    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String> {
        around(head_of_c("let", turns), &statements, 2, Some("}"))
    }
}

impl Loops for Python {
    /// Axes of batches are in front.
    fn argument(&self, name: &str, place: &str) -> String {
        format!("{name}[..., {place}]")
    }

    fn keep(&self, component: &str, value: &str) -> String {
        self.bind(component, value)
    }

    fn list(&self, name: &str, values: &[String]) -> Vec<String> {
        wrapped(&format!("{name} = ["), values, "]", WIDEST)
    }

    /// A list, as its components may be numbers or whole batches of them.
    fn array(&self, name: &str, count: usize) -> String {
        format!("{name} = [0.0] * {count}")
    }

    fn sines_and_cosines(&self, [sines, cosines]: &[String; 2], angles: &str, _count: usize) -> Vec<String> {
        vec![format!("{sines}, {cosines} = mbs_sin_cos_all({angles})")]
    }

    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String> {
        let Turns { index, first, end, is_inwards } = turns;
        let range = if *first == 0 { format!("range({end})") } else { format!("range({first}, {end})") };
        let links = if *is_inwards { format!("reversed({range})") } else { range };
        around(format!("for {index} in {links}:"), &statements, 4, None)
    }
}

impl Loops for Matlab {
    fn first(&self) -> i64 {
        1
    }

    fn component(&self, array: &str, place: &str) -> String {
        format!("{}({place})", self.identifier(array))
    }

    fn argument(&self, name: &str, place: &str) -> String {
        format!("{name}({place})")
    }

    fn list(&self, name: &str, values: &[String]) -> Vec<String> {
        let mut lines = wrapped(&format!("{name} = ["), values, "];", WIDEST);
        // The end of a line is one of a row, unless it is said that the row goes on.
        let close = lines.len() - 1;
        lines[..close].iter_mut().for_each(|line| line.push_str(" ..."));
        lines
    }

    fn array(&self, name: &str, count: usize) -> String {
        format!("{name} = zeros(1, {count});")
    }

    fn sines_and_cosines(&self, [sines, cosines]: &[String; 2], angles: &str, _count: usize) -> Vec<String> {
        vec![format!("[{sines}, {cosines}] = mbs_sin_cos_all({angles});")]
    }

    fn repeated(&self, turns: &Turns, statements: Vec<String>) -> Vec<String> {
        let Turns { index, first, end, is_inwards } = turns;
        let links = if *is_inwards { format!("{}:-1:{first}", end - 1) } else { format!("{first}:{}", end - 1) };
        around(format!("for {index} = {links}"), &statements, 2, Some("end"))
    }
}
