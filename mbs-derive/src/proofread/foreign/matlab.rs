//! A file of MATLAB and Octave.

use crate::shape::Shape;
use crate::variable::component_names;

use super::sheet::{Ending, Expected, Routine, Sheet};

pub(super) fn text(mut sheet: Sheet<'_, '_>) -> Expected {
    let derivation = sheet.derivation;
    let name = sheet.identifiers.mechanism.clone();
    let defaults = sheet.scope("defaults", "", false);
    let mut text = format!(
        "{defaults}\nfunction m = {name}(given)\nif nargin < 1\n  given = struct();\nend\nparams = struct();\n"
    );
    for (i, parameter) in derivation.parameters.iter().enumerate() {
        let list = |values: &[String]| {
            let is_matrix = values.iter().any(|value| value.starts_with('['));
            let values: Vec<&str> = values.iter().map(|value| value.trim_matches(['[', ']'])).collect();
            format!("[{}]", values.join(if is_matrix { "; " } else { ", " }))
        };
        let value = sheet.defaults(parameter, &list);
        text += &format!("params.{} = {value};\n", sheet.identifiers.parameters[i]);
    }
    text += "c.params = mbs_parameters(params, given);\n";
    for number in 0..derivation.splines().len() {
        text += &format!("[c.table_{number}_places, c.table_{number}_rows] = table_{number}();\n");
    }
    let cells = |names: Vec<String>| {
        let names: Vec<String> = names.iter().map(|name| format!("'{name}'")).collect();
        format!("{{{}}}", names.join(", "))
    };
    text += &format!("{}\n⟨⟩\nm = struct();\nm.params = c.params;\n", sheet.scope("constructor", "c.params.", true));
    text += &format!("m.coordinates = {};\n", cells(component_names(&derivation.coordinates)));
    text += &format!("m.inputs = {};\n", cells(component_names(&derivation.inputs)));
    let routines = sheet.routines("c.params.");
    for routine in routines.iter().filter(|routine| routine.ending != Ending::Motion) {
        let names = arguments(routine);
        let given: String = names.iter().map(|name| format!(", {name}")).collect();
        text += &format!("m.{} = @({}) {}(c{given});\n", routine.known_as, names.join(", "), routine.name);
    }
    text += "end\n";
    for routine in &routines {
        text += &function(&mut sheet, routine);
    }
    for (number, spline) in derivation.splines().into_iter().enumerate() {
        let mut row = |values: &[f64]| {
            let values: Vec<String> = values.iter().map(|&value| sheet.constant(value)).collect();
            values.join(", ")
        };
        let places = row(spline.places());
        let rows: String = spline.rows().iter().map(|values| row(values) + "\n").collect();
        let begin = sheet.scope("tables", "", false);
        text += &format!(
            "{begin}\nfunction [places, rows] = table_{number}()\nplaces = [{places}];\nrows = [\n{rows}];\nend\n"
        );
    }
    sheet.finished(text + "⟨shared⟩\n")
}

fn arguments(routine: &Routine<'_>) -> Vec<&'static str> {
    routine.arguments.iter().map(|(name, _)| *name).collect()
}

fn function(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>) -> String {
    let results: Vec<String> = match routine.ending {
        Ending::Motion => ["qdd", "multipliers"].map(String::from).to_vec(),
        _ => {
            let name = |name: &str| if name.is_empty() { "result".to_string() } else { format!("by_{name}") };
            routine.parts.iter().map(|(part, _)| name(part)).collect()
        }
    };
    let returned = if let [result] = results.as_slice() { result.clone() } else { format!("[{}]", results.join(", ")) };
    let given: String = arguments(routine).iter().map(|name| format!(", {name}")).collect();
    let (begin, name, motion) = (&routine.begin, &routine.name, sheet.identifiers.motion.clone());
    let head = format!("{begin}\nfunction {returned} = {name}(c{given})\n");
    let sized = routine.arguments.iter().map(|(name, count)| match (*name, count) {
        (name, None) => format!("{name} = mbs_sized('{name}', {name}, 1);\n"),
        ("prescribed", Some(count)) => format!("prescribed = mbs_signals('prescribed', prescribed, {count});\n"),
        (name, Some(count)) => format!("{name} = mbs_sized('{name}', {name}, {count});\n"),
    });
    let before = match routine.ending {
        Ending::Accelerations => return head + &format!("result = {motion}(c{given});\nend\n"),
        Ending::Multipliers => return head + &format!("[~, result] = {motion}(c{given});\nend\n"),
        Ending::Solve { in_motion: true } => format!("qdd = {}(c{given});\n", sheet.forward_dynamics()),
        Ending::Slopes { of_multipliers: true } => format!("[qdd, multipliers] = {motion}(c{given});\n"),
        Ending::Slopes { of_multipliers: false } => format!("qdd = {motion}(c{given});\n"),
        Ending::Values | Ending::Solve { in_motion: false } | Ending::Motion => String::new(),
    };
    let body = ending(sheet, routine, &results);
    format!("{head}{}{before}⟨⟩\n{body}end\n", sized.collect::<String>())
}

fn ending(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>, results: &[String]) -> String {
    let (n, k) = (sheet.derivation.dof(), sheet.derivation.constraints.len());
    let parts = || routine.parts.iter().map(|(_, shape)| *shape).zip(&routine.values).zip(results);
    match routine.ending {
        Ending::Accelerations | Ending::Multipliers => String::new(),
        Ending::Values => parts().map(|((shape, values), name)| assigned(name, shape, values)).collect(),
        Ending::Solve { .. } => {
            let solved = parts().map(|((shape, values), name)| {
                assigned(name, shape, values) + &format!("{name} = mbs_ldlt_solve(factors, reciprocals, {name});\n")
            });
            let masses = assigned("mass_matrix", Shape::Matrix(n, n), &routine.masses);
            format!("{masses}[factors, reciprocals] = mbs_ldlt(mass_matrix);\n{}", solved.collect::<String>())
        }
        Ending::Motion | Ending::Slopes { .. } => {
            let mut text = assigned("mass_matrix", Shape::Matrix(n, n), &routine.masses);
            text += &assigned("jacobian", Shape::Matrix(k, n), &routine.jacobian);
            text += &format!("system = mbs_null_space([{}], mass_matrix, jacobian);\n", sheet.vectors());
            if routine.ending == Ending::Motion {
                text += &assigned("right_side", Shape::Vector(n + k), &routine.values[0]);
                text += "motion = mbs_solve(system, right_side, [], []);\n";
                return text + &format!("qdd = motion(1:{n});\nmultipliers = motion({}:{});\n", n + 1, n + k);
            }
            let widths = routine.widths();
            for ((values, name), width) in routine.values.iter().zip(results).zip(&widths) {
                text += &assigned(name, Shape::Matrix(n + k, *width), values);
            }
            text += &match sheet.sizes(routine) {
                Some(parameters) => assigned("sizes", Shape::Vector(parameters.len()), &parameters),
                None => format!("sizes = mbs_state_sizes(q, qd, [{}], {});\n", sheet.kinds(), sheet.inputs()),
            };
            text += &format!("parts = mbs_solve(system, [{}], qdd, sizes);\n", results.join(", "));
            let mut first = 1;
            for (name, width) in results.iter().zip(widths) {
                text += &format!("{name} = parts(1:{n}, {first}:{});\n", first + width - 1);
                first += width;
            }
            text
        }
    }
}

/// Assigns numbers to a variable of this shape.
fn assigned(name: &str, shape: Shape, values: &[String]) -> String {
    let pose = |i: usize| match i % 12 {
        j @ 0..3 => format!("position({})", j + 1),
        j => format!("rotation({}, {})", j / 3, j % 3 + 1),
    };
    let wrench = |i: usize| format!("{}({})", if i % 6 < 3 { "force" } else { "moment" }, i % 3 + 1);
    let poses = "struct('position', zeros(3, 1), 'rotation', zeros(3))";
    let wrenches = "struct('force', zeros(3, 1), 'moment', zeros(3, 1))";
    let (start, place): (String, Box<dyn Fn(usize) -> String>) = match shape {
        Shape::Scalar => return format!("{name} = {};\n", values[0]),
        Shape::Vector(n) => (format!("zeros({n}, 1)"), Box::new(|i| format!("({}, 1)", i + 1))),
        Shape::Matrix(rows, columns) => (
            format!("zeros({rows}, {columns})"),
            Box::new(move |i| format!("({}, {})", i / columns + 1, i % columns + 1)),
        ),
        Shape::Symmetric(n) => {
            (format!("zeros({n}, {n})"), Box::new(move |i| format!("({}, {})", i / n + 1, i % n + 1)))
        }
        Shape::Matrices(n, rows, columns) => (
            format!("zeros({n}, {rows}, {columns})"),
            Box::new(move |i| {
                let (of, row) = (i / (rows * columns) + 1, i % (rows * columns) / columns + 1);
                format!("({of}, {row}, {})", i % columns + 1)
            }),
        ),
        Shape::Pose => (poses.to_string(), Box::new(move |i| format!(".{}", pose(i)))),
        Shape::Wrench => (wrenches.to_string(), Box::new(move |i| format!(".{}", wrench(i)))),
        Shape::Poses(n) => {
            (format!("repmat({poses}, {n}, 1)"), Box::new(move |i| format!("({}).{}", i / 12 + 1, pose(i))))
        }
        Shape::Wrenches(n) => {
            (format!("repmat({wrenches}, {n}, 1)"), Box::new(move |i| format!("({}).{}", i / 6 + 1, wrench(i))))
        }
    };
    let entries = values.iter().enumerate().map(|(i, value)| format!("{name}{} = {value};\n", place(i)));
    format!("{name} = {start};\n{}", entries.collect::<String>())
}
