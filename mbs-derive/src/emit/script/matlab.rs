//! `Derivation` → MATLAB and Octave: one function file, which gives a struct of functions.

use std::fmt::Write;

use crate::optimise::Derivation;
use crate::shape::Shape;
use crate::variable::component_names;

use super::super::name::{prefixed, second};
use super::super::rolled::Loops;
use super::super::walk::{Ending, Motion, Place, Routine, Side, Sizes, Syntax, Walk, defaults, if_else, plain};
use super::super::{Identifiers, Options, doc};
use super::pieces::needed;

/// What the files share.
pub(in crate::emit) const SHARED: &str = concat!(include_str!("prelude.m"), "\n\n", include_str!("constrained.m"));

/// The file of a mechanism; `source` is what its first line calls the declaration.
pub(in crate::emit) fn matlab(derivation: &Derivation, source: &str, options: &Options) -> String {
    let walk = Walk::new(derivation, source, options);
    let routines = walk.routines(&Matlab);
    let mut text = main(&walk, &routines);
    for routine in &routines {
        text += &function(&walk, routine);
    }
    text += &tables(&walk);
    let shared = needed(SHARED, "%", &text);
    (text + &shared).trim_end().to_string() + "\n"
}

/// Keywords of MATLAB and Octave.
const KEYWORDS: &str = "break case catch classdef continue do else elseif end end_try_catch end_unwind_protect endfor \
    endfunction endif endparfor endswitch endwhile for function global if otherwise parfor persistent return spmd switch \
    try until unwind_protect unwind_protect_cleanup while __FILE__ __LINE__ arguments enumeration events \
    methods properties";

/// What functions have names for, and what they call.
const TAKEN: &str = "sin cos tan atan atan2 sinh cosh tanh exp abs zeros struct repmat pi e i j Inf NaN eps error reshape ans \
    c given params q qd qdd u prescribed multipliers mass_matrix factors reciprocals right_side system motion sizes parts \
    result jacobian";

/// What the file calls besides: a mechanism of such a name would be called in its place.
const CALLED: &str = "acos all any arrayfun asin diag double false fieldnames find fix floor isempty isequal isfield isfinite \
    isnan isnumeric isreal isvector log log2 mat2str max min mod nargin numel prod size sqrt strjoin tril true";

fn is_keyword(name: &str) -> bool {
    KEYWORDS.split(' ').any(|word| word == name)
}

/// The name of a field.
fn member(name: &str) -> String {
    shortened(prefixed(name, "m_", is_no_member))
}

fn is_no_member(name: &str) -> bool {
    name.starts_with('_') || is_keyword(name)
}

/// MATLAB's names have no more letters.
const LONGEST: usize = 63;

fn shortened(name: String) -> String {
    if name.len() <= LONGEST {
        return name;
    }
    // FNV-1a, which keeps long names apart.
    let hash = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    format!("{}_{hash:08x}", &name[..LONGEST - 9])
}

/// What a mechanism's file and its main function are called.
pub(in crate::emit) fn file(mechanism: &str) -> String {
    let is_called = CALLED.split(' ').any(|word| word == mechanism);
    if is_called { format!("m_{mechanism}") } else { Matlab.identifier(mechanism) }
}

pub(super) struct Matlab;

impl Syntax for Matlab {
    fn identifier(&self, name: &str) -> String {
        let plain = plain(name);
        shortened(prefixed(&plain, "m_", |plain| {
            let begins = ["mbs_", "by_q"].iter().any(|start| plain.starts_with(start));
            begins || plain == "by_u" || TAKEN.split(' ').any(|word| word == plain) || is_no_member(plain)
        }))
    }

    fn constant(&self, value: f64) -> String {
        if value == std::f64::consts::PI { "pi".to_string() } else { format!("{value:?}") }
    }

    fn hoisted(&self, name: &str) -> String {
        format!("c.{}", self.identifier(name))
    }

    fn and(&self) -> &'static str {
        "&&"
    }

    fn not(&self) -> &'static str {
        "~"
    }

    fn select(&self, condition: &str, [then, otherwise]: [&str; 2], _known: bool) -> String {
        format!("mbs_choose({condition}, {then}, {otherwise})")
    }

    fn call(&self, name: &str, arguments: &[String]) -> String {
        let arguments = arguments.join(", ");
        match name {
            "sech" => format!("(1.0 / cosh({arguments}))"),
            "sqrt" | "ln" | "asin" | "acos" | "powf" | "signum" | "own_sin" | "own_cos" => {
                format!("mbs_{name}({arguments})")
            }
            name => format!("{name}({arguments})"),
        }
    }

    fn comment(&self, text: &str) -> String {
        format!("% {text}")
    }

    fn loops(&self) -> Option<&dyn Loops> {
        Some(self)
    }

    fn bind(&self, name: &str, value: &str) -> String {
        format!("{name} = {value};")
    }

    fn sin_cos(&self, [sin, cos]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("[{sin}, {cos}] = mbs_sin_cos({angle});")]
    }

    fn spline(&self, table: usize, order: usize, x: &str) -> String {
        format!("mbs_spline(c.table_{table}_places, c.table_{table}_rows, {order}, {x})")
    }

    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String> {
        if_else(vec![format!("if {condition}")], names, &sides, ["else", "end"], 2)
    }

    fn read(&self, place: &Place<'_>) -> String {
        match place {
            Place::Argument(name, i) => format!("{name}({})", i + 1),
            Place::Prescribed(i, order) => format!("prescribed({}, {})", i + 1, order + 1),
            Place::Parameter(name, indices) => {
                let (name, indices): (_, Vec<String>) =
                    (member(name), indices.iter().map(|i| (i + 1).to_string()).collect());
                if indices.is_empty() {
                    format!("c.params.{name}")
                } else {
                    format!("c.params.{name}({})", indices.join(", "))
                }
            }
        }
    }
}

fn tables(walk: &Walk<'_>) -> String {
    let mut text = String::new();
    let row = |values: &[f64]| values.iter().map(|&x| Matlab.constant(x)).collect::<Vec<_>>().join(", ");
    for (number, spline) in walk.names.splines.iter().enumerate() {
        let _ = writeln!(
            text,
            "function [places, rows] = table_{number}()\nplaces = [{}];\nrows = [",
            row(spline.places())
        );
        for values in spline.rows() {
            let _ = writeln!(text, "  {}", row(values));
        }
        text += "];\nend\n\n";
    }
    text
}

fn main(walk: &Walk<'_>, routines: &[Routine]) -> String {
    let derivation = walk.derivation;
    let name = file(&walk.snake_case());
    let cells =
        |names: Vec<String>| format!("{{{}}}", names.iter().map(|n| format!("'{n}'")).collect::<Vec<_>>().join(", "));
    let mut docs = vec![
        format!("{}  Equations of motion of the mechanism {}.", name.to_uppercase(), derivation.name),
        format!("  m = {name}() has the functions with the declared parameters, m = {name}(params) with those"),
        "  of a struct; what it leaves out is as declared. m.params are the parameters.".to_string(),
        String::new(),
    ];
    docs.extend(walk.docs());
    docs.extend([String::new(), "Parameters:".to_string()]);
    for (parameter, field) in walk.parameters() {
        docs.push(format!("- {}: {}", member(&field), doc::parameter(parameter).join(" ")));
    }
    let mut text = format!("function m = {name}(given)\n{}", comment(&docs));
    text += "if nargin < 1\n  given = struct();\nend\nparams = struct();\n";
    for (parameter, field) in walk.parameters() {
        let list = |values: &[String]| {
            let is_matrix = values.iter().any(|value| value.starts_with('['));
            let values: Vec<&str> = values.iter().map(|value| value.trim_matches(['[', ']'])).collect();
            format!("[{}]", values.join(if is_matrix { "; " } else { ", " }))
        };
        let value = defaults(parameter, &|x| Matlab.constant(x), &list);
        let _ = writeln!(text, "params.{} = {value};", member(&field));
    }
    text += "c.params = mbs_parameters(params, given);\n";
    for number in 0..walk.names.splines.len() {
        let _ = writeln!(text, "[c.table_{number}_places, c.table_{number}_rows] = table_{number}();");
    }
    let (lines, hoisted) = walk.constructor(&Matlab);
    lines.iter().for_each(|line| text += &format!("{line}\n"));
    for (name, value) in &hoisted {
        let _ = writeln!(text, "{} = {value};", Matlab.hoisted(name));
    }
    text += "m = struct();\nm.params = c.params;\n";
    let _ = writeln!(text, "m.coordinates = {};", cells(component_names(&derivation.coordinates)));
    let _ = writeln!(text, "m.inputs = {};", cells(component_names(&derivation.inputs)));
    for routine in routines.iter().filter(|routine| !matches!(routine.ending, Ending::Motion)) {
        let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
        let given = std::iter::once("c").chain(names.iter().copied()).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "m.{} = @({}) {}({given});", field(routine), names.join(", "), local_function(routine));
    }
    text + "end\n\n"
}

/// What the function is in the struct.
fn field(routine: &Routine) -> String {
    field_name(&routine.name)
}

fn field_name(name: &str) -> String {
    second(&member(name), &["coordinates", "inputs"])
}

/// What the function is called in the file, where it must not hide one of the library.
fn local_function(routine: &Routine) -> String {
    Matlab.identifier(&format!("f_{}", routine.name))
}

/// What a text calls things.
pub(in crate::emit) fn identifiers(walk: &Walk<'_>) -> Identifiers {
    let local = |name: &str| Matlab.identifier(&format!("f_{}", plain(name)));
    let function = |(i, _): &(usize, _)| {
        let name = &walk.names.functions[*i];
        (*i, local(name), field_name(&plain(name)))
    };
    let mechanism = file(&walk.snake_case());
    Identifiers {
        class: mechanism.clone(),
        mechanism,
        parameters: walk.parameters().map(|(_, name)| member(&name)).collect(),
        functions: walk.functions.iter().map(function).collect(),
        motion: local(&walk.names.constrained_motion),
    }
}

/// Names of what is returned.
fn results(routine: &Routine) -> Vec<String> {
    routine
        .parts
        .iter()
        .map(|(name, _)| if name.is_empty() { "result".to_string() } else { format!("by_{name}") })
        .collect()
}

fn function(walk: &Walk<'_>, routine: &Routine) -> String {
    let results = match routine.ending {
        Ending::Motion => vec!["qdd".to_string(), "multipliers".to_string()],
        _ => results(routine),
    };
    let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
    let given = std::iter::once("c").chain(names.iter().copied()).collect::<Vec<_>>().join(", ");
    let returned = if let [result] = results.as_slice() { result.clone() } else { format!("[{}]", results.join(", ")) };
    let mut lines = Vec::new();
    if !matches!(routine.ending, Ending::OfMotion(_)) {
        for (name, count) in &routine.arguments {
            let (check, count) = match (*name, count) {
                (_, None) => ("mbs_sized", 1),
                ("prescribed", Some(count)) => ("mbs_signals", *count),
                (_, Some(count)) => ("mbs_sized", *count),
            };
            lines.push(format!("{name} = {check}('{name}', {name}, {count});"));
        }
    }
    let motion = || Matlab.identifier(&format!("f_{}", plain(&walk.names.constrained_motion)));
    match (routine.motion, &routine.ending) {
        (Motion::Given, _) => {}
        (Motion::Accelerations, _) => {
            lines.push(format!("qdd = {}({given});", Matlab.identifier(&format!("f_{}", walk.forward_dynamics()))));
        }
        (Motion::Constrained, Ending::OfMotion("qdd")) => lines.push(format!("result = {}({given});", motion())),
        (Motion::Constrained, Ending::OfMotion(_)) => lines.push(format!("[~, result] = {}({given});", motion())),
        (Motion::Constrained, _) => {
            let taken = if routine.reads_multipliers { "[qdd, multipliers]" } else { "qdd" };
            lines.push(format!("{taken} = {}({given});", motion()));
        }
    }
    lines.extend(routine.lines.iter().cloned());
    lines.extend(ending(walk, routine, &results));
    let body: String = lines.iter().map(|line| format!("{line}\n")).collect();
    format!("function {returned} = {}({given})\n{}{body}end\n\n", local_function(routine), comment(&routine.docs))
}

/// Assigns numbers to a variable of this shape.
fn assigned(name: &str, shape: Shape, values: &[String]) -> Vec<String> {
    let matrix = |start: String, rows: usize, columns: usize| {
        let entry =
            move |(i, value): (usize, &String)| format!("{name}({}, {}) = {value};", i / columns + 1, i % columns + 1);
        std::iter::once(format!("{name} = {start};"))
            .chain(values.iter().enumerate().map(entry))
            .take(1 + rows * columns)
    };
    let structs = |(first, rest): (&str, &str), count: Option<usize>, size: usize| {
        let zero = if size == 12 { "zeros(3)" } else { "zeros(3, 1)" };
        let start = format!("struct('{first}', zeros(3, 1), '{rest}', {zero})");
        let start = count.map_or(start.clone(), |n| format!("repmat({start}, {n}, 1)"));
        let entry = |(i, value): (usize, &String)| {
            let element = if count.is_some() { format!("({})", i / size + 1) } else { String::new() };
            let place = match i % size {
                j @ 0..3 => format!("{first}({})", j + 1),
                j if size == 12 => format!("{rest}({}, {})", j / 3, j % 3 + 1),
                j => format!("{rest}({})", j - 2),
            };
            format!("{name}{element}.{place} = {value};")
        };
        std::iter::once(format!("{name} = {start};")).chain(values.iter().enumerate().map(entry)).collect::<Vec<_>>()
    };
    match shape {
        Shape::Scalar => vec![format!("{name} = {};", values[0])],
        Shape::Vector(n) => matrix(format!("zeros({n}, 1)"), n, 1).collect(),
        Shape::Matrix(rows, columns) => matrix(format!("zeros({rows}, {columns})"), rows, columns).collect(),
        Shape::Symmetric(n) => matrix(format!("zeros({n}, {n})"), n, n).collect(),
        Shape::Pose => structs(("position", "rotation"), None, 12),
        Shape::Poses(n) => structs(("position", "rotation"), Some(n), 12),
        Shape::Wrench => structs(("force", "moment"), None, 6),
        Shape::Wrenches(n) => structs(("force", "moment"), Some(n), 6),
        Shape::Matrices(n, rows, columns) => {
            let entry = |(i, value): (usize, &String)| {
                let (of, within) = (i / (rows * columns), i % (rows * columns));
                format!("{name}({}, {}, {}) = {value};", of + 1, within / columns + 1, within % columns + 1)
            };
            let start = format!("{name} = zeros({n}, {rows}, {columns});");
            std::iter::once(start).chain(values.iter().enumerate().map(entry)).collect()
        }
    }
}

fn ending(walk: &Walk<'_>, routine: &Routine, results: &[String]) -> Vec<String> {
    let (n, k) = (walk.derivation.dof(), walk.derivation.constraints.len());
    let parts = || routine.parts.iter().map(|(_, shape)| *shape).zip(&routine.values).zip(results);
    let mut lines = Vec::new();
    match &routine.ending {
        Ending::OfMotion(_) => {}
        Ending::Values => {
            for ((shape, own), name) in parts() {
                lines.extend(assigned(name, shape, own));
            }
        }
        Ending::Solve => {
            lines.extend(assigned("mass_matrix", Shape::Matrix(n, n), &routine.mass_matrix));
            lines.push("[factors, reciprocals] = mbs_ldlt(mass_matrix);".to_string());
            for ((shape, own), name) in parts() {
                lines.extend(assigned(name, shape, own));
                lines.push(format!("{name} = mbs_ldlt_solve(factors, reciprocals, {name});"));
            }
        }
        Ending::Motion | Ending::Slopes(_) => {
            lines.extend(assigned("mass_matrix", Shape::Matrix(n, n), &routine.mass_matrix));
            lines.extend(assigned("jacobian", Shape::Matrix(k, n), &routine.jacobian));
            let vectors = walk.vectors().join(", ");
            lines.push(format!("system = mbs_null_space([{vectors}], mass_matrix, jacobian);"));
            let Ending::Slopes(sizes) = &routine.ending else {
                lines.extend(assigned("right_side", Shape::Vector(n + k), &routine.values.concat()));
                lines.push("motion = mbs_solve(system, right_side, [], []);".to_string());
                lines.push(format!("qdd = motion(1:{n});\nmultipliers = motion({}:{});", n + 1, n + k));
                return lines;
            };
            let widths = routine.widths();
            for (((_, own), name), width) in parts().zip(&widths) {
                lines.extend(assigned(name, Shape::Matrix(n + k, *width), own));
            }
            match sizes {
                Sizes::Parameters(all) => lines.extend(assigned("sizes", Shape::Vector(all.len()), all)),
                Sizes::State(kinds, inputs) => {
                    let kinds: Vec<String> = kinds.iter().map(ToString::to_string).collect();
                    lines.push(format!("sizes = mbs_state_sizes(q, qd, [{}], {inputs});", kinds.join(", ")));
                }
            }
            lines.push(format!("parts = mbs_solve(system, [{}], qdd, sizes);", results.join(", ")));
            let mut first = 1;
            for (name, width) in results.iter().zip(&widths) {
                lines.push(format!("{name} = parts(1:{n}, {first}:{});", first + width - 1));
                first += width;
            }
        }
    }
    lines
}

fn comment(lines: &[String]) -> String {
    lines.iter().map(|line| format!("% {line}").trim_end().to_string() + "\n").collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::expr::{Binary, Function};

    /// A line without its comment and what it quotes; a quotation mark behind a value turns it.
    fn without_texts(line: &str) -> String {
        let (mut kept, mut quoted) = (String::new(), false);
        for c in line.chars() {
            let turns = kept.ends_with(|before: char| before.is_alphanumeric() || "_)]}.'".contains(before));
            match c {
                '\'' if quoted => quoted = false,
                '\'' if !turns => quoted = true,
                '%' if !quoted => break,
                _ if !quoted => kept.push(c),
                _ => {}
            }
        }
        kept
    }

    /// Its names, but those of fields, each with whether it is given a value on this line.
    fn names(line: &str) -> Vec<(&str, bool)> {
        let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let head = line.find(" = ").unwrap_or(if line.starts_with("function") { line.len() } else { 0 });
        let mut found = Vec::new();
        let mut at = 0;
        for word in line.split(|c: char| !is_letter(c)) {
            let end = at + word.len();
            let is_field = line[..at].ends_with('.');
            if word.starts_with(|c: char| c.is_ascii_alphabetic()) && !is_field {
                let is_parameter = line.starts_with("function") || line[..at].trim_end().ends_with("for");
                found.push((word, end <= head || is_parameter));
            }
            at = end + 1;
        }
        found
    }

    #[test]
    fn what_files_call_no_mechanism_is_called() {
        let text: Vec<String> = SHARED.lines().map(|line| without_texts(line.trim_start())).collect();
        let mut called: BTreeSet<&str> = BTreeSet::new();
        for function in text.chunk_by(|_, next| !next.starts_with("function ")) {
            let all: Vec<(&str, bool)> = function.iter().flat_map(|line| names(line)).collect();
            let assigned: BTreeSet<&str> = all.iter().filter(|(_, gets)| *gets).map(|(name, _)| *name).collect();
            called.extend(all.iter().map(|(name, _)| *name).filter(|name| !assigned.contains(name)));
        }
        let known: BTreeSet<&str> = TAKEN.split(' ').chain(CALLED.split(' ')).collect();
        let unknown: Vec<_> =
            called.iter().filter(|n| !n.starts_with("mbs_") && !is_keyword(n) && !known.contains(**n)).collect();
        assert_eq!(unknown, [&""; 0]);
        let idle: Vec<&str> = CALLED.split(' ').filter(|name| !called.contains(name) && *name != "nargin").collect();
        assert_eq!(idle, [""; 0]);
        let elementary = Function::ALL.iter().map(|f| f.name()).chain(Binary::ALL.iter().map(|f| f.name()));
        for name in elementary {
            let call = Matlab.call(name, &["x".to_string()]);
            let head = call.split(|c: char| !c.is_alphanumeric() && c != '_').find(|word| word.len() > 1).unwrap();
            let head = if name == "sech" { "cosh" } else { head };
            assert!(head.starts_with("mbs_") || known.contains(head), "{call}");
        }
        for name in known {
            assert_eq!(file(name), format!("m_{name}"));
        }
    }
}
