//! What this machine computes of the functions that a page evaluates: the interpreter of mbs-derive over
//! [`Portable`] numbers, from a list of states to the bits of all results.
//!
//! Reads lines of JSON, `{"name", "text", "files", "states"}`; for each of them writes a line: for each state, for each
//! function, the bits of its results as hexadecimal digits, one after the other. A state is t, q, q̇, q̈, u, prescribed
//! motions and parameters, each number as its bits.

use std::io::{BufRead, Write};

use mbs_derive::Analysis;
use mbs_derive::expr::Graph;
use mbs_derive::interpret::{Interpreter, State};
use mbs_derive::optimise::Derivation;
use mbs_derive::source::{Sources, Unreadable};
use mbs_derive::variable::Variable;
use mbs_wasm::portable::Portable;
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for line in std::io::stdin().lock().lines() {
        let request: Value = serde_json::from_str(&line?)?;
        let text = |value: &Value| value.as_str().map(str::to_string);
        let name = text(&request["name"]).ok_or("no name")?;
        let read = |file: &str| {
            let file = text(&request["files"][file]).map(String::into_bytes);
            file.ok_or_else(|| Unreadable::new("it is not there", ""))
        };
        let sources = Sources::gather(&name, request["text"].as_str().ok_or("no text")?, read);
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&sources, &graph).map_err(|error| error.render_in(&sources))?;
        analysis.prove(analysis.programs())?;
        let derivation = analysis.into_programs();
        let states = request["states"].as_array().ok_or("no states")?;
        let values: Vec<Value> = states.iter().map(|state| evaluated(&derivation, state)).collect::<Result<_, _>>()?;
        writeln!(std::io::stdout(), "{}", json!({ "values": values }))?;
    }
    Ok(())
}

fn evaluated(derivation: &Derivation, state: &Value) -> Result<Value, String> {
    let numbers = state.as_array().ok_or("a state is an array")?.iter();
    let bits = |value: &Value| u64::from_str_radix(value.as_str()?, 16).ok();
    let numbers: Option<Vec<Portable>> = numbers.map(|value| Some(Portable(f64::from_bits(bits(value)?)))).collect();
    let mut rest = numbers.ok_or("a number is its bits")?.into_iter();
    let count = |variables: &[Variable]| variables.iter().map(Variable::count).sum::<usize>();
    let mut take = |count: usize| -> Vec<Portable> { rest.by_ref().take(count).collect() };
    let n = derivation.dof();
    let t = take(1)[0];
    let [q, qd, qdd, u] = [n, n, n, count(&derivation.inputs)].map(&mut take);
    let prescribed = (0..count(&derivation.prescribed)).map(|_| take(3)).map(|x| [x[0], x[1], x[2]]).collect();
    let parameters = take(count(&derivation.parameters));
    let state = State { t, q, qd, qdd, u, prescribed };
    let interpreter = Interpreter::with_parameters(derivation, parameters);
    let hexadecimal = |numbers: Vec<Portable>| -> String {
        numbers.into_iter().map(|number| format!("{:016x}", number.0.to_bits())).collect()
    };
    Ok(derivation.functions.iter().map(|f| hexadecimal(interpreter.evaluate(f, &state))).collect())
}
