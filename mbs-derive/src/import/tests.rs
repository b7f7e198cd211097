//! Small files, each with one way to say something: what it means, against numbers of other programs, and what is
//! refused because it would mean something else.

mod mjcf;
mod sdf;
mod urdf;

use crate::Analysis;
use crate::expr::Graph;
use crate::interpret::{Interpreter, State};
use crate::source::Sources;

/// Written in the language.
fn text(file: &str, xml: &str) -> String {
    written(file, xml, false)
}

/// Written in the language, with a base that moves freely where no joint holds it.
fn floating(file: &str, xml: &str) -> String {
    written(file, xml, true)
}

fn written(file: &str, xml: &str, is_floating: bool) -> String {
    match Sources::robot(file, xml).floating(is_floating).text(&|_| None) {
        Ok((text, _)) => text,
        Err(errors) => panic!("{}\n{xml}", errors.render(file, xml)),
    }
}

/// What functions of a mechanism give at a state, without inputs.
fn values<const N: usize>(text: &str, q: &[f64], qd: &[f64], names: [&str; N]) -> [Vec<f64>; N] {
    driven(text, q, qd, &[], names)
}

/// What functions of a mechanism give at a state, with these inputs; the others are zero.
fn driven<const N: usize>(text: &str, q: &[f64], qd: &[f64], u: &[f64], names: [&str; N]) -> [Vec<f64>; N] {
    let (sources, graph) = (Sources::new("robot.mbs", text), Graph::verbatim());
    let analysis =
        Analysis::of(&sources, &graph).unwrap_or_else(|error| panic!("{}\n{text}", error.render_in(&sources)));
    assert_eq!(analysis.warnings(None).render_in(&sources), "", "{text}");
    let programs = analysis.programs();
    let inputs = programs.inputs.iter().map(|input| input.count()).sum();
    let u = u.iter().copied().chain(std::iter::repeat(0.0)).take(inputs).collect();
    let state = State { q: q.to_vec(), qd: qd.to_vec(), qdd: vec![0.0; q.len()], u, ..State::default() };
    names.map(|name| {
        let function = programs.named(name).unwrap_or_else(|| panic!("there is no {name}\n{text}"));
        Interpreter::new(programs).evaluate(function, &state)
    })
}

#[track_caller]
fn near(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let scale = expected.iter().fold(1e-6, |largest: f64, value| largest.max(value.abs()));
    let is_near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-9 * scale);
    assert!(is_near, "{what}\n{found:?}\n{expected:?}");
}

/// M by rows and C q̇ + G of a file, at q = (0.3, −0.4, 0.5) and q̇ = (0.7, −0.2, 0.9), or the first numbers of these.
#[track_caller]
fn moves(file: &str, xml: &str, mass_matrix: &[f64], bias: &[f64]) {
    let (text, n) = (text(file, xml), bias.len());
    let [m, h] = values(&text, &[0.3, -0.4, 0.5][..n], &[0.7, -0.2, 0.9][..n], ["mass_matrix", "bias"]);
    near(&format!("M\n{text}"), &m, mass_matrix);
    near(&format!("C q̇ + G\n{text}"), &h, bias);
}

#[track_caller]
fn refused(file: &str, xml: &str, message: &str) {
    match Sources::robot(file, xml).text(&|_| None) {
        Ok((text, _)) => panic!("it is read:\n{text}"),
        Err(errors) => {
            let messages: Vec<String> = errors.iter().map(|error| error.message.clone()).collect();
            assert_eq!(messages, [message], "{}", errors.render(file, xml));
        }
    }
}
