//! A module of JavaScript.

use crate::shape::Shape;
use crate::variable::component_names;

use super::sheet::{Ending, Expected, Routine, Sheet, joined};

pub(super) fn text(mut sheet: Sheet<'_, '_>) -> Expected {
    let class = sheet.identifiers.mechanism.clone();
    let derivation = sheet.derivation;
    let mut text = String::from("⟨shared⟩\n");
    for (number, spline) in derivation.splines().into_iter().enumerate() {
        let mut numbers = |values: &[f64]| list(values.iter().map(|&value| sheet.constant(value)));
        let places = numbers(spline.places());
        let rows = list(spline.rows().iter().map(|row| numbers(row)));
        let begin = sheet.scope("tables", "", false);
        text += &format!("{begin} const TABLE_{number}_PLACES = {places}; const TABLE_{number}_ROWS = {rows};\n");
    }
    text += &format!("export class {class} {{\n");
    for (name, variables) in [("coordinates", &derivation.coordinates), ("inputs", &derivation.inputs)] {
        let names = component_names(variables);
        text += &format!("static {name} = {};\n", list(names.iter().map(|name| format!("{name:?}"))));
    }
    let defaults = sheet.scope("defaults", "", false);
    text += &format!("⟨fields⟩ {defaults} static defaults() {{ return {{\n");
    let arrays = |values: &[String]| format!("[{}]", values.join(", "));
    for (i, parameter) in derivation.parameters.iter().enumerate() {
        let value = sheet.defaults(parameter, &arrays);
        text += &format!("{}: {value},\n", sheet.identifiers.parameters[i]);
    }
    let begin = sheet.scope("constructor", "this.params.", true);
    text += &format!("}}; }} {begin} constructor(params = {{}}) {{\n");
    text += &format!("this.params = mbs_parameters({class}.defaults(), params); ⟨⟩ }}\n");
    for routine in sheet.routines("this.params.") {
        text += &method(&mut sheet, &routine);
    }
    sheet.finished(text + "}\n")
}

fn list(values: impl Iterator<Item = String>) -> String {
    format!("[{}]", values.collect::<Vec<_>>().join(", "))
}

fn flat(values: &[String]) -> String {
    list(values.iter().cloned())
}

fn method(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>) -> String {
    let (n, k) = (sheet.derivation.dof(), sheet.derivation.constraints.len());
    let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
    let arguments = names.join(", ");
    let begins = routine.arguments.iter().map(|(name, count)| match count {
        Some(count) => format!("mbs_sized(\"{name}\", {name}, {count});\n"),
        None => format!("mbs_sized(\"{name}\", [{name}], 1);\n"),
    });
    let (begin, name, motion) = (&routine.begin, &routine.name, sheet.identifiers.motion.clone());
    let head = format!("{begin} {name}({arguments}) {{\n{}", begins.collect::<String>());
    let body = match routine.ending {
        Ending::Accelerations => format!("return this.{motion}({arguments}).qdd;\n"),
        Ending::Multipliers => format!("return this.{motion}({arguments}).multipliers;\n"),
        Ending::Values => {
            let parts = routine.parts.iter().zip(&routine.values);
            let parts = parts.map(|((_, shape), values)| shaped(*shape, &mut values.iter().cloned())).collect();
            format!("⟨⟩ {}", returned(routine, parts))
        }
        Ending::Solve { in_motion } => {
            let dynamics = sheet.forward_dynamics();
            let before = if in_motion { format!("const qdd = this.{dynamics}({arguments}); ") } else { String::new() };
            let parts = routine.parts.iter().zip(&routine.values).zip(routine.widths());
            let parts = parts.map(|(((_, shape), values), width)| {
                in_rows(format!("mbs_ldlt_solve({n}, {width}, mass_matrix, reciprocals, {})", flat(values)), *shape)
            });
            let masses = flat(&routine.masses);
            let returned = returned(routine, parts.collect());
            format!(
                "{before} ⟨⟩ const mass_matrix = {masses}; const reciprocals = mbs_ldlt({n}, mass_matrix);\n{returned}"
            )
        }
        Ending::Motion => format!(
            "⟨⟩ {} const [motion] = system.solve([right_side], [], []);\n\
             return {{ qdd: motion.slice(0, {n}), multipliers: motion.slice({n}) }};\n",
            system(sheet, routine, n)
        ),
        Ending::Slopes { of_multipliers } => {
            let multipliers = if of_multipliers { ", multipliers" } else { "" };
            let sizes = match sheet.sizes(routine) {
                Some(parameters) => flat(&parameters),
                None => format!("mbs_state_sizes(q, qd, [{}], {})", sheet.kinds(), sheet.inputs()),
            };
            let parts = routine.parts.iter().enumerate().map(|(i, (_, shape))| in_rows(format!("parts[{i}]"), *shape));
            debug_assert!(k > 0, "there are constraints");
            format!(
                "const {{ qdd{multipliers} }} = this.{motion}({arguments}); ⟨⟩ {} const sizes = {sizes};\n\
                 const parts = mbs_slopes(system, right_side, [{}], Array.from(qdd), sizes);\n{}",
                system(sheet, routine, n),
                joined(&routine.widths(), ", "),
                returned(routine, parts.collect())
            )
        }
    };
    head + &body + "}\n"
}

fn system(sheet: &Sheet<'_, '_>, routine: &Routine<'_>, n: usize) -> String {
    let (masses, jacobian, right_side) =
        (flat(&routine.masses), flat(&routine.jacobian), flat(&routine.values.concat()));
    let vectors = sheet.vectors();
    format!(
        "const system = new mbs_NullSpace({n}, [{vectors}], {masses}, {jacobian});\nconst right_side = {right_side};\n"
    )
}

fn returned(routine: &Routine<'_>, mut parts: Vec<String>) -> String {
    if parts.len() == 1 {
        return format!("return {};\n", parts.remove(0));
    }
    let named = routine.parts.iter().zip(parts).map(|((name, _), part)| format!("{name}: {part}"));
    format!("return {{ {} }};\n", named.collect::<Vec<_>>().join(", "))
}

/// A flat array in rows, where it is a matrix.
fn in_rows(part: String, shape: Shape) -> String {
    match shape {
        Shape::Matrix(rows, 0) => list((0..rows).map(|_| "[]".to_string())),
        Shape::Matrix(_, columns) => format!("mbs_rows({part}, {columns})"),
        _ => part,
    }
}

/// The next values in this shape.
fn shaped(shape: Shape, values: &mut dyn Iterator<Item = String>) -> String {
    let mut several =
        |count: usize, of: Shape| list((0..count).map(|_| shaped(of, values)).collect::<Vec<_>>().into_iter());
    match shape {
        Shape::Scalar => values.next().unwrap_or_default(),
        Shape::Vector(n) => several(n, Shape::Scalar),
        Shape::Matrix(rows, columns) => several(rows, Shape::Vector(columns)),
        Shape::Symmetric(n) => several(n, Shape::Vector(n)),
        Shape::Wrenches(n) => several(n, Shape::Wrench),
        Shape::Poses(n) => several(n, Shape::Pose),
        Shape::Matrices(n, rows, columns) => several(n, Shape::Matrix(rows, columns)),
        Shape::Pose => {
            let position = shaped(Shape::Vector(3), values);
            format!("{{ position: {position}, rotation: {} }}", shaped(Shape::Matrix(3, 3), values))
        }
        Shape::Wrench => {
            let force = shaped(Shape::Vector(3), values);
            format!("{{ force: {force}, moment: {} }}", shaped(Shape::Vector(3), values))
        }
    }
}
