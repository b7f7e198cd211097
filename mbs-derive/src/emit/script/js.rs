//! `Derivation` → JavaScript: one ES module without dependencies.

use crate::optimise::Derivation;
use crate::shape::Shape;
use crate::variable::component_names;

use super::super::name::{prefixed, second};
use super::super::rolled::Loops;
use super::super::walk::{
    Argued, Ending, Motion, Place, Routine, Side, Sizes, Syntax, Walk, block_comment, defaults, if_else, indented,
    plain,
};
use super::super::{Identifiers, Options, doc};
use super::list;
use super::pieces::needed;

/// What the modules share.
pub(in crate::emit) const SHARED: &str = include_str!("prelude.mjs");

/// The module of a mechanism; `source` is what its first line calls the declaration.
pub(in crate::emit) fn js(derivation: &Derivation, source: &str, options: &Options) -> String {
    let walk = Walk::new(derivation, source, options);
    let class = Js.identifier(&plain(&walk.names.mechanism));
    let text = format!("{}{}", tables(&walk), class_of(&walk, &class));
    format!("{}\n{}{text}", block_comment(&walk.docs(), 0), needed(SHARED, "//", &text))
}

/// Reserved words, what functions of a class have names for, and what they call.
const TAKEN: &str = "arguments await break case catch class const constructor continue debugger default delete do else enum eval \
    export extends false finally for function if implements import in instanceof interface let new null package \
    private protected public return static super switch this throw true try typeof var void while with yield \
    undefined NaN Infinity Math Number Array Object params q qd qdd u t prescribed multipliers mass_matrix \
    reciprocals right_side system motion sizes parts";

pub(super) struct Js;

impl Syntax for Js {
    fn identifier(&self, name: &str) -> String {
        let plain = plain(name);
        prefixed(&plain, "js_", |plain| {
            let is_taken = TAKEN.split(' ').any(|word| word == plain) && plain != "t";
            is_taken || plain.starts_with("mbs_") || plain.contains("__")
        })
    }

    fn constant(&self, value: f64) -> String {
        if value == std::f64::consts::PI { "Math.PI".to_string() } else { format!("{value:?}") }
    }

    fn hoisted(&self, name: &str) -> String {
        format!("this.#{}", self.identifier(name))
    }

    fn and(&self) -> &'static str {
        "&&"
    }

    fn not(&self) -> &'static str {
        "!"
    }

    fn select(&self, condition: &str, [then, otherwise]: [&str; 2], _known: bool) -> String {
        format!("{condition} ? {then} : {otherwise}")
    }

    fn call(&self, name: &str, arguments: &[String]) -> String {
        let arguments = arguments.join(", ");
        match name {
            "ln" => format!("Math.log({arguments})"),
            "powf" => format!("Math.pow({arguments})"),
            "sech" => format!("(1.0 / Math.cosh({arguments}))"),
            "signum" | "own_sin" | "own_cos" => format!("mbs_{name}({arguments})"),
            name => format!("Math.{name}({arguments})"),
        }
    }

    fn comment(&self, text: &str) -> String {
        format!("// {text}")
    }

    fn loops(&self) -> Option<&dyn Loops> {
        Some(self)
    }

    fn bind(&self, name: &str, value: &str) -> String {
        format!("const {name} = {value};")
    }

    fn sin_cos(&self, [sin, cos]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("const [{sin}, {cos}] = mbs_sin_cos({angle});")]
    }

    fn spline(&self, table: usize, order: usize, x: &str) -> String {
        format!("mbs_spline(TABLE_{table}_PLACES, TABLE_{table}_ROWS, {order}, {x})")
    }

    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String> {
        let begin = vec![format!("let {};", names.join(", ")), format!("if ({condition}) {{")];
        if_else(begin, names, &sides, ["} else {", "}"], 2)
    }

    fn read(&self, place: &Place<'_>) -> String {
        match place {
            Place::Argument(name, i) => format!("{name}[{i}]"),
            Place::Prescribed(i, order) => format!("prescribed[{i}][{order}]"),
            Place::Parameter(name, indices) => {
                let indices: String = indices.iter().map(|i| format!("[{i}]")).collect();
                format!("this.params.{}{indices}", field(name))
            }
        }
    }
}

/// What a text calls things.
pub(in crate::emit) fn identifiers(walk: &Walk<'_>) -> Identifiers {
    let function = |(i, _): &(usize, _)| {
        let name = member(&plain(&walk.names.functions[*i]));
        (*i, name.clone(), name)
    };
    let mechanism = Js.identifier(&plain(&walk.names.mechanism));
    Identifiers {
        class: mechanism.clone(),
        mechanism,
        parameters: walk.parameters().map(|(_, name)| field(&name)).collect(),
        functions: walk.functions.iter().map(function).collect(),
        motion: format!("#{}", plain(&walk.names.constrained_motion)),
    }
}

/// The name of a method.
fn member(name: &str) -> String {
    second(name, &["constructor"])
}

/// Any name is a property's, but one.
fn field(name: &str) -> String {
    prefixed(name, "js_", |name| name == "__proto__")
}

fn tables(walk: &Walk<'_>) -> String {
    let numbers = |values: &[f64]| list(&values.iter().map(|&x| Js.constant(x)).collect::<Vec<_>>(), ["[", "]"]);
    let table = |(number, spline): (usize, &crate::expr::Spline)| {
        let rows: Vec<String> = spline.rows().iter().map(|row| numbers(row)).collect();
        let (places, rows) = (numbers(spline.places()), list(&rows, ["[", "]"]));
        format!("const TABLE_{number}_PLACES = {places};\n\nconst TABLE_{number}_ROWS = {rows};\n\n")
    };
    walk.names.splines.iter().enumerate().map(table).collect()
}

fn class_of(walk: &Walk<'_>, class: &str) -> String {
    let names =
        |names: Vec<String>| list(&names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>(), ["[", "]"]);
    let derivation = walk.derivation;
    let summary = format!("The mechanism `{}`: its equations of motion.", derivation.name);
    let mut text = format!("{}export class {class} {{\n", block_comment(&[summary], 0));
    for (docs, name, variables) in [
        ("Names of the coordinates, in the order of `q`, `qd`, `qdd`.", "coordinates", &derivation.coordinates),
        ("Names of the inputs, in the order of `u`.", "inputs", &derivation.inputs),
    ] {
        text += &block_comment(&[docs.to_string()], 2);
        text += &format!("  static {name} = {};\n\n", names(component_names(variables)));
    }
    text += &constructor(walk, class);
    for routine in walk.routines(&Js) {
        text += &method(walk, &routine);
    }
    text.trim_end().to_string() + "\n}\n"
}

fn constructor(walk: &Walk<'_>, class: &str) -> String {
    let (lines, hoisted) = walk.constructor(&Js);
    let mut text: String = hoisted.iter().map(|(name, _)| format!("  #{};\n", Js.identifier(name))).collect();
    if !hoisted.is_empty() {
        text += "\n";
    }
    text += &block_comment(&["The declared parameters.".to_string()], 2);
    text += "  static defaults() {\n    return {\n";
    for (parameter, name) in walk.parameters() {
        text += &block_comment(&doc::parameter(parameter), 6);
        let value = defaults(parameter, &|x| Js.constant(x), &|values| format!("[{}]", values.join(", ")));
        text += &format!("      {}: {value},\n", field(&name));
    }
    text += "    };\n  }\n\n";
    text += &block_comment(
        &[
            "With these parameters, of which those that are left out are as declared.".to_string(),
            String::new(),
            format!("@param {{Partial<ReturnType<typeof {class}.defaults>>}} params"),
            "@throws {RangeError} a parameter is unknown, of another shape or not finite".to_string(),
        ],
        2,
    );
    text +=
        &format!("  constructor(params = {{}}) {{\n    this.params = mbs_parameters({class}.defaults(), params);\n");
    indented(&lines, 4).for_each(|line| text += &(line + "\n"));
    for (name, value) in &hoisted {
        text += &format!("    {} = {value};\n", Js.hoisted(name));
    }
    text + "  }\n\n"
}

fn method(walk: &Walk<'_>, routine: &Routine) -> String {
    let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
    let name = match &routine.ending {
        Ending::Motion => format!("#{}", routine.name),
        _ => member(&routine.name),
    };
    let mut docs = routine.docs.clone();
    docs.push(String::new());
    docs.extend(routine.arguments.iter().map(|argument| documented(*argument)));
    docs.push(format!("@returns {{{}}}", returned_type(routine)));
    let mut lines: Vec<String> = routine
        .arguments
        .iter()
        .map(|(name, count)| match count {
            Some(count) => format!("mbs_sized(\"{name}\", {name}, {count});"),
            None => format!("mbs_sized(\"{name}\", [{name}], 1);"),
        })
        .collect();
    let (arguments, forward_dynamics) = (names.join(", "), || walk.forward_dynamics());
    match (routine.motion, &routine.ending) {
        (Motion::Given, _) => {}
        (Motion::Accelerations, _) => lines.push(format!("const qdd = this.{}({arguments});", forward_dynamics())),
        (Motion::Constrained, Ending::OfMotion(part)) => {
            lines.push(format!("return this.#{}({arguments}).{part};", plain(&walk.names.constrained_motion)));
        }
        (Motion::Constrained, _) => {
            let multipliers = if routine.reads_multipliers { ", multipliers" } else { "" };
            let motion = plain(&walk.names.constrained_motion);
            lines.push(format!("const {{ qdd{multipliers} }} = this.#{motion}({arguments});"));
        }
    }
    lines.extend(routine.lines.iter().cloned());
    lines.extend(ending(walk, routine));
    let body: String = indented(&lines, 4).map(|line| line + "\n").collect();
    format!("{}  {name}({arguments}) {{\n{}  }}\n\n", block_comment(&docs, 2), body)
}

fn ending(walk: &Walk<'_>, routine: &Routine) -> Vec<String> {
    let n = walk.derivation.dof();
    let flat = |values: &[String]| list(values, ["[", "]"]);
    let returned = |parts: Vec<String>| {
        let all = match parts.as_slice() {
            [part] => part.clone(),
            parts => {
                let named = routine.parts.iter().zip(parts).map(|((name, _), part)| format!("{name}: {part}"));
                list(&named.collect::<Vec<_>>(), ["{ ", " }"])
            }
        };
        format!("return {all};").lines().map(String::from).collect::<Vec<_>>()
    };
    let statement = |text: String| text.lines().map(String::from).collect::<Vec<_>>();
    // `part` flat.
    let in_shape = |part: String, shape: Shape| match shape {
        Shape::Matrix(rows, 0) => format!("[{}]", vec!["[]"; rows].join(", ")),
        Shape::Matrix(_, columns) => format!("mbs_rows({part}, {columns})"),
        _ => part,
    };
    match &routine.ending {
        Ending::OfMotion(_) => Vec::new(),
        Ending::Values => {
            let parts = routine.parts.iter().zip(&routine.values);
            returned(parts.map(|((_, shape), values)| shaped(*shape, &mut values.iter().cloned())).collect())
        }
        Ending::Solve => {
            let mut lines = statement(format!("const mass_matrix = {};", flat(&routine.mass_matrix)));
            lines.push(format!("const reciprocals = mbs_ldlt({n}, mass_matrix);"));
            let right_sides = routine.values.iter().zip(routine.widths());
            let parts = routine.parts.iter().zip(right_sides).map(|((_, shape), (right_side, width))| {
                let solve = format!("mbs_ldlt_solve({n}, {width}, mass_matrix, reciprocals, {})", flat(right_side));
                in_shape(solve, *shape)
            });
            let parts: Vec<String> = parts.collect();
            lines.extend(returned(parts));
            lines
        }
        Ending::Motion | Ending::Slopes(_) => {
            let mut lines = statement(format!(
                "const system = new mbs_NullSpace({n}, [{}], {}, {});",
                walk.vectors().join(", "),
                flat(&routine.mass_matrix),
                flat(&routine.jacobian)
            ));
            lines.extend(statement(format!("const right_side = {};", flat(&routine.values.concat()))));
            if let Ending::Slopes(sizes) = &routine.ending {
                let widths: Vec<String> = routine.widths().iter().map(ToString::to_string).collect();
                let sizes = match sizes {
                    Sizes::Parameters(all) => flat(all),
                    Sizes::State(kinds, inputs) => {
                        let kinds: Vec<String> = kinds.iter().map(ToString::to_string).collect();
                        format!("mbs_state_sizes(q, qd, [{}], {inputs})", kinds.join(", "))
                    }
                };
                lines.extend(statement(format!("const sizes = {sizes};")));
                lines.push(format!(
                    "const parts = mbs_slopes(system, right_side, [{}], Array.from(qdd), sizes);",
                    widths.join(", ")
                ));
                let parts =
                    routine.parts.iter().enumerate().map(|(i, (_, shape))| in_shape(format!("parts[{i}]"), *shape));
                lines.extend(returned(parts.collect()));
            } else {
                lines.push("const [motion] = system.solve([right_side], [], []);".to_string());
                lines.push(format!("return {{ qdd: motion.slice(0, {n}), multipliers: motion.slice({n}) }};"));
            }
            lines
        }
    }
}

/// The next values in this shape.
fn shaped(shape: Shape, values: &mut dyn Iterator<Item = String>) -> String {
    let several = |count: usize, shape: Shape, values: &mut dyn Iterator<Item = String>| {
        list(&(0..count).map(|_| shaped(shape, values)).collect::<Vec<_>>(), ["[", "]"])
    };
    match shape {
        Shape::Scalar => values.next().expect("a value for each component"),
        Shape::Vector(n) => several(n, Shape::Scalar, values),
        Shape::Matrix(rows, columns) => several(rows, Shape::Vector(columns), values),
        Shape::Symmetric(n) => several(n, Shape::Vector(n), values),
        Shape::Pose => {
            let position = shaped(Shape::Vector(3), values);
            let rotation = shaped(Shape::Matrix(3, 3), values);
            list(&[format!("position: {position}"), format!("rotation: {rotation}")], ["{ ", " }"])
        }
        Shape::Wrench => {
            let [force, moment] = [0, 1].map(|_| shaped(Shape::Vector(3), values));
            list(&[format!("force: {force}"), format!("moment: {moment}")], ["{ ", " }"])
        }
        Shape::Wrenches(n) => several(n, Shape::Wrench, values),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns), values),
        Shape::Poses(n) => several(n, Shape::Pose, values),
    }
}

fn documented((name, count): Argued) -> String {
    match (name, count) {
        (_, None) => format!("@param {{number}} {name} time, s"),
        ("prescribed", Some(count)) => {
            format!(
                "@param {{ArrayLike<ArrayLike<number>>}} {name} value, rate and second derivative of {count} motions"
            )
        }
        (_, Some(1)) => format!("@param {{ArrayLike<number>}} {name} 1 number"),
        (_, Some(count)) => format!("@param {{ArrayLike<number>}} {name} {count} numbers"),
    }
}

fn returned_type(routine: &Routine) -> String {
    fn of(shape: Shape) -> &'static str {
        match shape {
            Shape::Scalar => "number",
            Shape::Vector(_) => "number[]",
            Shape::Matrix(..) | Shape::Symmetric(_) => "number[][]",
            Shape::Pose => "{ position: number[], rotation: number[][] }",
            Shape::Wrench => "{ force: number[], moment: number[] }",
            Shape::Wrenches(_) => "{ force: number[], moment: number[] }[]",
            Shape::Matrices(..) => "number[][][]",
            Shape::Poses(_) => "{ position: number[], rotation: number[][] }[]",
        }
    }
    match routine.parts.as_slice() {
        [(_, shape)] => of(*shape).to_string(),
        parts => {
            let parts: Vec<String> = parts.iter().map(|(name, shape)| format!("{name}: {}", of(*shape))).collect();
            format!("{{ {} }}", parts.join(", "))
        }
    }
}
