//! `Derivation` → Python: one NumPy module, for single states and for batches of them.

use crate::optimise::Derivation;
use crate::shape::Shape;
use crate::variable::component_names;

use super::super::name::{prefixed, second};
use super::super::rolled::Loops;
use super::super::walk::{Ending, Motion, Place, Routine, Side, Sizes, Syntax, Walk, defaults, indented, plain};
use super::super::{Identifiers, Options, doc};
use super::list;
use super::pieces::{needed, uses};

/// What the modules share.
pub(in crate::emit) const SHARED: &str = include_str!("prelude.py");

/// The module of a mechanism; `source` is what its first line calls the declaration.
pub(in crate::emit) fn python(derivation: &Derivation, source: &str, options: &Options) -> String {
    let walk = Walk::new(derivation, source, options);
    let class = Python.identifier(&plain(&walk.names.mechanism));
    let routines = walk.routines(&Python);
    let body = format!("{}{}", parameters(&walk), class_of(&walk, &class, &routines));
    let tables = tables(&walk);
    let shared = needed(SHARED, "#", &body);
    let body = format!("{}{tables}{}{body}", results(&routines, &body), spaced(&shared));
    let code = without_texts(&body);
    let is_imported = |module: &str| uses(&code, module);
    let mut text = docstring(&walk.docs(), 0);
    text += "\n";
    for (module, line) in [
        ("math", "import math\n"),
        ("dataclass", "from dataclasses import dataclass\n"),
        ("SimpleNamespace", "from types import SimpleNamespace\n"),
        ("NamedTuple", "from typing import NamedTuple\n"),
    ] {
        text += if is_imported(module) { line } else { "" };
    }
    text + "\nimport numpy as np\n\n\n" + &body
}

/// The code without what stands in quotes, documentation included.
fn without_texts(code: &str) -> String {
    let outside_of = |text: &str, quote: &str| text.split(quote).step_by(2).collect::<Vec<_>>().join(" ");
    outside_of(&outside_of(code, "\"\"\""), "\"")
}

/// Keywords.
const KEYWORDS: &str = "False None True and as assert async await break class continue def del elif else except finally for \
    from global if import in is lambda nonlocal not or pass raise return try while with yield";

/// What functions have names for, and what they call.
const TAKEN: &str = "np math Params Pose Wrench NamedTuple SimpleNamespace dataclass batch solved sizes values self params q \
    qd qdd u t prescribed multipliers mass_matrix reciprocals";

fn is_keyword(name: &str) -> bool {
    KEYWORDS.split(' ').any(|word| word == name)
}

/// The name of a method or of a parameter.
fn member(name: &str) -> String {
    prefixed(name, "py_", is_no_member)
}

fn is_no_member(name: &str) -> bool {
    name.starts_with('_') || is_keyword(name)
}

/// The name of a method, where others are of the class, or its decorators read them there.
fn method_name(name: &str) -> String {
    second(&member(name), &["coordinates", "inputs", "np"])
}

/// What a text calls things.
pub(in crate::emit) fn identifiers(walk: &Walk<'_>) -> Identifiers {
    let function = |(i, _): &(usize, _)| {
        let name = method_name(&plain(&walk.names.functions[*i]));
        (*i, name.clone(), name)
    };
    let mechanism = Python.identifier(&plain(&walk.names.mechanism));
    Identifiers {
        class: mechanism.clone(),
        mechanism,
        parameters: walk.parameters().map(|(_, name)| member(&name)).collect(),
        functions: walk.functions.iter().map(function).collect(),
        motion: format!("_{}", plain(&walk.names.constrained_motion)),
    }
}

/// The identifier for a name, of a file as well.
pub(in crate::emit) fn identifier(name: &str) -> String {
    Python.identifier(name)
}

pub(super) struct Python;

impl Syntax for Python {
    fn identifier(&self, name: &str) -> String {
        let plain = plain(name);
        prefixed(&plain, "py_", |plain| {
            let is_taken = TAKEN.split(' ').any(|word| word == plain) && plain != "t";
            is_taken || plain.starts_with("mbs_") || is_no_member(plain)
        })
    }

    fn constant(&self, value: f64) -> String {
        if value == std::f64::consts::PI { "math.pi".to_string() } else { format!("{value:?}") }
    }

    fn hoisted(&self, name: &str) -> String {
        format!("self._{}", plain(name))
    }

    fn and(&self) -> &'static str {
        "&"
    }

    fn and_is_tight(&self) -> bool {
        true
    }

    fn not(&self) -> &'static str {
        "~"
    }

    fn select(&self, condition: &str, [then, otherwise]: [&str; 2], _known: bool) -> String {
        format!("np.where({condition}, {then}, {otherwise})")
    }

    fn call(&self, name: &str, arguments: &[String]) -> String {
        let arguments = arguments.join(", ");
        match name {
            "ln" => format!("np.log({arguments})"),
            "powf" => format!("np.power({arguments})"),
            "sech" => format!("(1.0 / np.cosh({arguments}))"),
            "signum" | "own_sin" | "own_cos" => format!("mbs_{name}({arguments})"),
            "asin" | "acos" | "atan" | "atan2" => format!("np.arc{}({arguments})", &name[1..]),
            name => format!("np.{name}({arguments})"),
        }
    }

    fn comment(&self, text: &str) -> String {
        format!("# {text}")
    }

    fn loops(&self) -> Option<&dyn Loops> {
        Some(self)
    }

    fn bind(&self, name: &str, value: &str) -> String {
        format!("{name} = {value}")
    }

    fn sin_cos(&self, [sin, cos]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("{sin}, {cos} = mbs_sin_cos({angle})")]
    }

    fn spline(&self, table: usize, order: usize, x: &str) -> String {
        format!("mbs_spline(TABLE_{table}_PLACES, TABLE_{table}_ROWS, {order}, {x})")
    }

    /// A batch may go both ways.
    fn branch(&self, names: &[String], condition: &str, [then, otherwise]: [Side; 2]) -> Vec<String> {
        let values = names.iter().zip(then.values.iter().zip(&otherwise.values));
        let chosen = values.map(|(name, (a, b))| self.bind(name, &self.select(condition, [a, b], true)));
        let chosen: Vec<String> = chosen.collect();
        then.lines.into_iter().chain(otherwise.lines).chain(chosen).collect()
    }

    fn read(&self, place: &Place<'_>) -> String {
        match place {
            Place::Argument(name, i) => format!("{name}[..., {i}]"),
            Place::Prescribed(i, order) => format!("prescribed[..., {i}, {order}]"),
            Place::Parameter(name, indices) => {
                let name = member(name);
                let indices: Vec<String> = indices.iter().map(ToString::to_string).collect();
                if indices.is_empty() {
                    format!("self._params.{name}")
                } else {
                    format!("self._params.{name}[{}]", indices.join(", "))
                }
            }
        }
    }
}

/// Two empty lines between definitions.
fn spaced(shared: &str) -> String {
    shared.replace("\n\ndef ", "\n\n\ndef ").replace("\n\nclass ", "\n\n\nclass ")
        + if shared.is_empty() { "" } else { "\n" }
}

fn tables(walk: &Walk<'_>) -> String {
    let numbers = |values: &[f64]| list(&values.iter().map(|&x| Python.constant(x)).collect::<Vec<_>>(), ["[", "]"]);
    let table = |(number, spline): (usize, &crate::expr::Spline)| {
        let rows: Vec<String> = spline.rows().iter().map(|row| numbers(row)).collect();
        let (places, rows) = (numbers(spline.places()), list(&rows, ["[", "]"]));
        format!(
            "TABLE_{number}_PLACES = np.array({places}, dtype=np.float64)\n\nTABLE_{number}_ROWS = np.array({rows})\n\n\n"
        )
    };
    walk.names.splines.iter().enumerate().map(table).collect()
}

/// The types of results that have parts.
fn results(routines: &[Routine], body: &str) -> String {
    let mut text = String::new();
    let mut class = |name: &str, docs: &str, fields: &[(&str, &str)]| {
        text += &format!("class {name}(NamedTuple):\n    \"\"\"{docs}\"\"\"\n\n");
        for (field, docs) in fields {
            text += &format!("    {field}: np.ndarray\n    \"\"\"{docs}\"\"\"\n");
        }
        text += "\n\n";
    };
    if uses(body, "mbs_pose") {
        let docs = "Where frames are, batches and arrays in the leading axes.";
        class(
            "Pose",
            docs,
            &[("position", "(..., 3), m"), ("rotation", "(..., 3, 3), columns are the axes of the frame")],
        );
    }
    if uses(body, "mbs_wrench") {
        let docs = "Forces and moments, batches and arrays in the leading axes.";
        class("Wrench", docs, &[("force", "(..., 3), N"), ("moment", "(..., 3), N·m")]);
    }
    for routine in routines.iter().filter(|routine| routine.parts.len() > 1) {
        if !matches!(routine.ending, Ending::Motion) {
            let parts = routine.parts.iter().map(|(name, _)| (name.as_str(), "derivatives by what it is called"));
            class(&result_name(routine), &format!("What `{}` returns.", routine.name), &parts.collect::<Vec<_>>());
        }
    }
    text
}

/// `inverse_dynamics_jacobian` → `InverseDynamicsJacobianResult`
fn result_name(routine: &Routine) -> String {
    let words = routine.name.split('_').map(|word| word[..1].to_uppercase() + &word[1..]);
    words.collect::<String>() + "Result"
}

fn parameters(walk: &Walk<'_>) -> String {
    let docs = format!("Parameters of {}.", walk.derivation.name);
    let mut text = format!("@dataclass(frozen=True)\nclass Params:\n    \"\"\"{docs}\"\"\"\n");
    for (parameter, name) in walk.parameters() {
        let kind = if parameter.length.is_some() { "tuple" } else { "float" };
        let tuple = |values: &[String]| format!("({},)", values.join(", "));
        let value = defaults(parameter, &|x| Python.constant(x), &tuple);
        text += &format!("\n    {}: {kind} = {value}\n{}", member(&name), docstring(&doc::parameter(parameter), 4));
    }
    text + "\n\n"
}

fn class_of(walk: &Walk<'_>, class: &str, routines: &[Routine]) -> String {
    let derivation = walk.derivation;
    let names = |names: Vec<String>| match names.as_slice() {
        [] => "()".to_string(),
        names => format!("({},)", names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")),
    };
    let mut text =
        format!("class {class}:\n    \"\"\"The mechanism `{}`: its equations of motion.\"\"\"\n\n", derivation.name);
    text += &format!("    coordinates = {}\n", names(component_names(&derivation.coordinates)));
    text += "    \"\"\"Names of the coordinates, in the order of `q`, `qd`, `qdd`.\"\"\"\n";
    text += &format!("    inputs = {}\n", names(component_names(&derivation.inputs)));
    text += "    \"\"\"Names of the inputs, in the order of `u`.\"\"\"\n\n";
    text += &constructor(walk);
    routines.iter().for_each(|routine| text += &method(walk, routine));
    text.trim_end().to_string() + "\n"
}

fn constructor(walk: &Walk<'_>) -> String {
    let (lines, hoisted) = walk.constructor(&Python);
    let mut text = String::from("    @np.errstate(all=\"ignore\")\n    def __init__(self, params=None):\n");
    text += "        \"\"\"With these parameters, else the declared ones; what depends on them alone is computed here.\"\"\"\n";
    text += "        self.params = params = Params() if params is None else params\n        self._params = SimpleNamespace(\n";
    for (parameter, name) in walk.parameters() {
        let name = member(&name);
        let lengths: String = parameter.lengths().iter().map(|n| format!(", {n}")).collect();
        text += &format!("            {name}=mbs_parameter(\"{name}\", params.{name}{lengths}),\n");
    }
    text += "        )\n";
    indented(&lines, 8).for_each(|line| text += &(line + "\n"));
    for (name, value) in &hoisted {
        text += &format!("        {} = {value}\n", Python.hoisted(name));
    }
    text + "\n"
}

fn method(walk: &Walk<'_>, routine: &Routine) -> String {
    let name = match &routine.ending {
        Ending::Motion => format!("_{}", routine.name),
        _ => method_name(&routine.name),
    };
    let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
    let arguments = names.join(", ");
    let mut docs = routine.docs.clone();
    docs.extend([String::new(), returned(routine)]);
    let mut lines: Vec<String> = routine
        .arguments
        .iter()
        .map(|(name, count)| match (*name, count) {
            (name, None) => format!("{name} = mbs_argument(\"{name}\", {name})"),
            ("prescribed", Some(count)) => format!("prescribed = mbs_argument(\"prescribed\", prescribed, {count}, 3)"),
            (name, Some(count)) => format!("{name} = mbs_argument(\"{name}\", {name}, {count})"),
        })
        .collect();
    let shapes = routine.arguments.iter().map(|(name, count)| match (*name, count) {
        (name, None) => format!("{name}.shape"),
        ("prescribed", _) => "prescribed.shape[:-2]".to_string(),
        (name, Some(_)) => format!("{name}.shape[:-1]"),
    });
    let batch = format!("batch = np.broadcast_shapes({})", shapes.collect::<Vec<_>>().join(", "));
    let constrained_motion = || plain(&walk.names.constrained_motion);
    match (routine.motion, &routine.ending) {
        (Motion::Constrained, Ending::OfMotion(part)) => {
            let number = usize::from(*part == "multipliers");
            lines = vec![format!("return self._{}({arguments})[{number}]", constrained_motion())];
        }
        (Motion::Given, _) => lines.push(batch),
        (Motion::Accelerations, _) => {
            lines.extend([batch, format!("qdd = self.{}({arguments})", member(&walk.forward_dynamics()))]);
        }
        (Motion::Constrained, _) => {
            let multipliers = if routine.reads_multipliers { "multipliers" } else { "_" };
            lines.extend([batch, format!("qdd, {multipliers} = self._{}({arguments})", constrained_motion())]);
        }
    }
    lines.extend(routine.lines.iter().cloned());
    lines.extend(ending(walk, routine));
    let body: String = indented(&lines, 8).map(|line| line + "\n").collect();
    let given = std::iter::once("self").chain(names).collect::<Vec<_>>().join(", ");
    format!("    @np.errstate(all=\"ignore\")\n    def {name}({given}):\n{}{body}\n", docstring(&docs, 8))
}

/// The shape of a result, and how it is filled.
fn shape(shape: Shape) -> (&'static str, String) {
    match shape {
        Shape::Scalar => ("mbs_filled", "()".to_string()),
        Shape::Vector(n) => ("mbs_filled", format!("({n},)")),
        Shape::Matrix(rows, columns) => ("mbs_filled", format!("({rows}, {columns})")),
        Shape::Symmetric(n) => ("mbs_filled", format!("({n}, {n})")),
        Shape::Matrices(n, rows, columns) => ("mbs_filled", format!("({n}, {rows}, {columns})")),
        Shape::Pose => ("mbs_pose", "()".to_string()),
        Shape::Poses(n) => ("mbs_pose", format!("({n},)")),
        Shape::Wrench => ("mbs_wrench", "()".to_string()),
        Shape::Wrenches(n) => ("mbs_wrench", format!("({n},)")),
    }
}

fn returned(routine: &Routine) -> String {
    let described = |of: Shape| match self::shape(of) {
        ("mbs_filled", axes) if axes == "()" => "numbers".to_string(),
        ("mbs_filled", axes) => format!("(..., {}", axes.trim_start_matches('(').replace(",)", ")")),
        ("mbs_pose", _) => "Pose".to_string(),
        _ => "Wrench".to_string(),
    };
    let parts = routine.parts.iter().map(|(name, shape)| {
        let colon = if name.is_empty() { "" } else { ": " };
        format!("{name}{colon}{}", described(*shape))
    });
    format!("Returns {}; leading axes of arguments are batches.", parts.collect::<Vec<_>>().join(", "))
}

fn ending(walk: &Walk<'_>, routine: &Routine) -> Vec<String> {
    let n = walk.derivation.dof();
    let filled = |of: Shape, values: &str| {
        let (fill, axes) = shape(of);
        let number = if of == Shape::Scalar { "[()]" } else { "" };
        format!("{fill}(batch, {axes}, {values}){number}")
    };
    let returned = |parts: Vec<String>| {
        let all = match parts.as_slice() {
            [part] => part.clone(),
            parts => list(parts, [&format!("{}(", result_name(routine)), ")"]),
        };
        format!("return {all}").lines().map(String::from).collect::<Vec<_>>()
    };
    let statement = |text: String| text.lines().map(String::from).collect::<Vec<_>>();
    let brackets = |values: &[String]| list(values, ["[", "]"]);
    let widths = routine.widths();
    match &routine.ending {
        Ending::OfMotion(_) => Vec::new(),
        Ending::Values => {
            let parts = routine.parts.iter().zip(&routine.values);
            returned(parts.map(|((_, shape), values)| filled(*shape, &brackets(values))).collect())
        }
        Ending::Solve => {
            let rows: Vec<String> = routine.mass_matrix.chunks(n).map(brackets).collect();
            let mut lines = statement(format!("mass_matrix = {}", brackets(&rows)));
            lines.push(format!("reciprocals = mbs_ldlt({n}, mass_matrix)"));
            let right_sides = routine.values.iter().zip(&widths);
            let parts = routine.parts.iter().zip(right_sides).map(|((_, shape), (own, width))| {
                filled(*shape, &format!("mbs_ldlt_solve({n}, {width}, mass_matrix, reciprocals, {})", brackets(own)))
            });
            let parts = parts.collect();
            lines.extend(returned(parts));
            lines
        }
        Ending::Motion | Ending::Slopes(_) => {
            let vectors = format!("[{}]", walk.vectors().join(", "));
            let values = [&routine.mass_matrix[..], &routine.jacobian, &routine.values.concat()].concat();
            let mut lines =
                statement(format!("values = mbs_filled(batch, ({},), {})", values.len(), brackets(&values)));
            if let Ending::Slopes(sizes) = &routine.ending {
                let columns: usize = widths.iter().sum();
                lines.extend(statement(match sizes {
                    Sizes::Parameters(all) => format!("sizes = mbs_filled(batch, ({columns},), {})", brackets(all)),
                    Sizes::State(kinds, inputs) => {
                        let kinds: Vec<String> = kinds.iter().map(ToString::to_string).collect();
                        format!("sizes = mbs_state_sizes(batch, q, qd, [{}], {inputs})", kinds.join(", "))
                    }
                }));
                let all: Vec<String> = widths.iter().map(ToString::to_string).collect();
                lines.push(format!(
                    "solved = mbs_constrained({n}, {vectors}, values, [{}], qdd, sizes)",
                    all.join(", ")
                ));
                let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
                let parts =
                    starts.zip(&widths).map(|(first, width)| format!("solved[..., :{n}, {first}:{}]", first + width));
                lines.extend(returned(parts.collect()));
            } else {
                lines.push(format!("solved = mbs_constrained({n}, {vectors}, values, [1], None, None)[..., 0]"));
                lines.push(format!("return solved[..., :{n}], solved[..., {n}:]"));
            }
            lines
        }
    }
}

/// A docstring; raw where it holds a backslash.
fn docstring(lines: &[String], by: usize) -> String {
    let text = lines.join("\n").replace("\"\"\"", "'''");
    let raw = if text.contains('\\') { "r" } else { "" };
    let lines: Vec<String> = text.trim_end().lines().map(|line| line.trim_end().to_string()).collect();
    let close = if lines.len() > 1 { format!("\n{}", " ".repeat(by)) } else { String::new() };
    let quoted: Vec<String> =
        format!("{raw}\"\"\"{}{close}\"\"\"", lines.join("\n")).lines().map(String::from).collect();
    // What closes a long one stands by itself, already indented.
    let last = quoted.len() - 1;
    quoted
        .iter()
        .enumerate()
        .map(|(i, line)| {
            if line.is_empty() || (i == last && i > 0) {
                format!("{line}\n")
            } else {
                format!("{}{line}\n", " ".repeat(by))
            }
        })
        .collect()
}
