//! A mechanism read, derived and proved.

use std::collections::BTreeMap;

use mbs_derive::expr::{Graph, Number};
use mbs_derive::interpret::{Interpreter, State, Violation};
use mbs_derive::model::Unit;
use mbs_derive::optimise::{Argument, Derivation, Function, Shape};
use mbs_derive::source::{Sources, Unreadable};
use mbs_derive::variable::{Variable, component_names};
use mbs_derive::{Analysis, emit};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::columns;
use crate::portable::{Portable, plain, portable};
use crate::report::{Failure, diagnostics};

/// What is to be compiled.
#[derive(Clone, Debug, Deserialize)]
pub struct Request {
    /// What reports and generated code call the text.
    pub name: String,
    /// The mechanism.
    pub text: String,
    /// What it imports, by name.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

/// A mechanism whose programs are proved.
#[derive(Debug)]
pub struct Model {
    sources: Sources,
    derivation: Derivation,
    /// All that there is to say of it.
    description: Value,
}

/// A state, and the parameters that hold there.
#[derive(Clone, Debug)]
pub struct Point {
    /// Time, coordinates, velocities, accelerations, inputs, prescribed motions.
    pub state: State,
    /// Flattened in declaration order.
    pub parameters: Vec<f64>,
}

impl Model {
    /// Reads, derives and proves.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn compile(request: &Request) -> Result<Self, Failure> {
        let read = |name: &str| {
            let file = request.files.get(name).map(|text| text.clone().into_bytes());
            file.ok_or_else(|| Unreadable::new("it is not among the files that were given", "give its text in `files`"))
        };
        let sources = Sources::gather(&request.name, &request.text, read);
        let refused = |error| Failure::of_model(&error, &sources);
        let graph = Graph::verbatim();
        let analysis = Analysis::of(&sources, &graph).map_err(refused)?;
        let proof = analysis.prove(analysis.programs()).map_err(refused)?;
        let warnings = analysis.warnings(Some(&proof));
        let mut description = describe(analysis.programs());
        description["proof"] = json!({ "states": proof.states, "singular": proof.singular });
        description["warnings"] = diagnostics(&warnings, &sources).into();
        description["report"] = warnings.render_in(&sources).into();
        Ok(Model { derivation: analysis.into_programs(), sources, description })
    }

    /// The programs.
    pub fn derivation(&self) -> &Derivation {
        &self.derivation
    }

    /// Names, units, shapes, documentation and operation counts.
    pub fn description(&self) -> &Value {
        &self.description
    }

    /// Its code, read again.
    ///
    /// # Errors
    /// There is no such language, or the text is not what was proved.
    pub fn printed(&self, language: &str) -> Result<String, Failure> {
        let (derivation, name, options) = (&self.derivation, self.sources.portable_name(), emit::Options::default());
        match language {
            "rust" | "c" => {
                let language = if language == "c" { emit::Language::C } else { emit::Language::Rust };
                let code = language.write(derivation, name, &options);
                let read = derivation.proofread(language, &options, &code);
                read.map(|()| code).map_err(|misprint| Failure::of_model(&misprint.into(), &self.sources))
            }
            "review" => Ok(derivation.review(name)),
            "latex" | "mathml" => {
                let graph = Graph::verbatim();
                let analysis = Analysis::of(&self.sources, &graph);
                let analysis = analysis.map_err(|error| Failure::of_model(&error, &self.sources))?;
                Ok(if language == "latex" { analysis.latex() } else { analysis.mathml() })
            }
            _ => {
                let languages = "rust, c, latex, mathml, review";
                Err(Failure::of_input(format!("there is no language `{language}`; there are {languages}")))
            }
        }
    }

    /// The results of the function with this number, part by part and row by row.
    ///
    /// # Errors
    /// There is no such function, or the mechanism cannot have these parameters.
    pub fn evaluate(&self, function: usize, point: &Point) -> Result<Vec<f64>, Failure> {
        let function = self.derivation.functions.get(function);
        let function = function.ok_or_else(|| Failure::of_input("there is no such function"))?;
        let interpreter = Interpreter::with_parameters(&self.derivation, portable(&point.parameters));
        Ok(plain(interpreter.evaluate(function, &as_portable(&point.state))))
    }

    /// Takes t, q, q̇, q̈, u, three numbers for each prescribed motion, and the parameters apart.
    ///
    /// # Errors
    /// There are more or fewer numbers, or the mechanism cannot have these parameters.
    pub fn point(&self, numbers: &[f64]) -> Result<Point, Failure> {
        let count = |variables: &[Variable]| variables.iter().map(Variable::count).sum::<usize>();
        let d = &self.derivation;
        let (n, u, p) = (d.dof(), count(&d.inputs), count(&d.prescribed));
        let parameters = count(&d.parameters);
        let expected = 1 + 3 * n + u + 3 * p + parameters;
        if numbers.len() != expected {
            return Err(Failure::of_input(format!("a state has {expected} numbers, found {}", numbers.len())));
        }
        let mut rest = numbers;
        let mut take = |count: usize| {
            let (taken, behind) = rest.split_at(count);
            rest = behind;
            taken.to_vec()
        };
        let t = take(1)[0];
        let [q, qd, qdd] = [take(n), take(n), take(n)];
        let u = take(u);
        let prescribed = take(3 * p).chunks(3).map(|signal| [signal[0], signal[1], signal[2]]).collect();
        let parameters = take(parameters);
        let broken = Violation::all(d, &parameters);
        if let Some(Violation { quantity, value, must }) = broken.first() {
            return Err(Failure::of_input(format!("params: `{quantity}` {must}, it is {value:?}")));
        }
        Ok(Point { state: State { t, q, qd, qdd, u, prescribed }, parameters })
    }
}

/// For the interpreter.
pub(crate) fn as_portable(state: &State) -> State<Portable> {
    State {
        t: Portable(state.t),
        q: portable(&state.q),
        qd: portable(&state.qd),
        qdd: portable(&state.qdd),
        u: portable(&state.u),
        prescribed: state.prescribed.iter().map(|signal| signal.map(Portable)).collect(),
    }
}

fn describe(derivation: &Derivation) -> Value {
    let variables = |variables: &[Variable]| variables.iter().map(variable).collect::<Value>();
    let rows = derivation.constraints.iter().zip(&derivation.constraint_units).zip(&derivation.holonomic);
    let constraints = rows.map(|((name, [unit, multiplier_unit]), holonomic)| {
        let [unit, multiplier_unit] = [unit, multiplier_unit].map(|unit| Unit(unit).in_ascii());
        json!({ "name": name, "unit": unit, "multiplier_unit": multiplier_unit, "holonomic": holonomic })
    });
    let documented = emit::Language::documented(derivation).into_iter();
    json!({
        "name": derivation.name,
        "docs": text_of(&derivation.docs),
        "coordinates": variables(&derivation.coordinates),
        "parameters": variables(&derivation.parameters),
        "inputs": variables(&derivation.inputs),
        "prescribed": variables(&derivation.prescribed),
        "coordinate_names": component_names(&derivation.coordinates),
        "input_names": component_names(&derivation.inputs),
        "prescribed_names": component_names(&derivation.prescribed),
        "parameter_names": component_names(&derivation.parameters),
        "constraints": constraints.collect::<Value>(),
        "conserved": derivation.conserved,
        "depends_on_time": derivation.depends_on_time,
        "functions": documented.zip(&derivation.functions).map(|((_, docs), f)| function(derivation, f, &docs)).collect::<Value>(),
        "columns": columns::columns(derivation).into_iter().map(|c| json!([c.name, c.unit])).collect::<Value>(),
    })
}

fn variable(variable: &Variable) -> Value {
    json!({
        "name": variable.name,
        "docs": text_of(&variable.docs),
        "unit": variable.unit,
        "declared_unit": variable.declared_unit,
        "lengths": variable.lengths(),
        "first": variable.first,
        "components": variable.component_names(),
        "defaults": variable.defaults.iter().map(|&number| Number::to_f64(number)).collect::<Value>(),
        "positive": variable.positive,
    })
}

fn function(derivation: &Derivation, function: &Function, docs: &[String]) -> Value {
    let arguments = function.arguments.iter().map(|argument| match argument {
        Argument::Q => "q",
        Argument::Qd => "qd",
        Argument::Qdd => "qdd",
        Argument::U => "u",
        Argument::Multipliers => "multipliers",
    });
    let results = function.results.iter().map(|part| {
        let (kind, shape) = shape(part.shape);
        json!({ "name": part.name, "kind": kind, "shape": shape })
    });
    let count = function.operations;
    json!({
        "name": function.name,
        "docs": docs.join("\n"),
        "arguments": arguments.collect::<Value>(),
        "results": results.collect::<Value>(),
        "units": columns::output_of(derivation, function)
            .map(|number| derivation.output_units[number].iter().map(|unit| Unit(unit).in_ascii()).collect::<Value>()),
        "operations": {
            "add": count.add, "mul": count.mul, "div": count.div, "sqrt": count.sqrt, "sincos": count.sincos,
            "other": count.other, "flops": count.flops(),
        },
    })
}

/// What a value is, and its lengths.
fn shape(shape: Shape) -> (&'static str, Vec<usize>) {
    match shape {
        Shape::Scalar => ("number", vec![]),
        Shape::Vector(n) => ("array", vec![n]),
        Shape::Matrix(rows, columns) => ("array", vec![rows, columns]),
        Shape::Symmetric(n) => ("array", vec![n, n]),
        Shape::Matrices(n, rows, columns) => ("array", vec![n, rows, columns]),
        Shape::Pose => ("pose", vec![]),
        Shape::Poses(n) => ("pose", vec![n]),
        Shape::Wrench => ("wrench", vec![]),
        Shape::Wrenches(n) => ("wrench", vec![n]),
    }
}

fn text_of(docs: &[String]) -> String {
    docs.iter().map(|line| line.trim()).collect::<Vec<_>>().join("\n").trim().to_string()
}
