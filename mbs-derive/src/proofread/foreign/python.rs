//! A module of Python.

use crate::shape::Shape;
use crate::variable::component_names;

use super::sheet::{Ending, Expected, Routine, Sheet, joined};

pub(super) fn text(mut sheet: Sheet<'_, '_>) -> Expected {
    let derivation = sheet.derivation;
    let class = sheet.identifiers.mechanism.clone();
    let body = parameters(&mut sheet) + &class_of(&mut sheet, &class);
    let shapes = |is_it: fn(Shape) -> bool| {
        let functions = sheet.identifiers.functions.iter().map(|(i, ..)| &derivation.functions[*i]);
        functions.flat_map(|function| &function.results).any(|part| is_it(part.shape))
    };
    let mut results = String::new();
    let mut tuple = |name: &str, fields: &[&str]| {
        let fields: String = fields.iter().map(|field| format!("    {field}: np.ndarray\n")).collect();
        results += &format!("class {name}(NamedTuple):\n{fields}");
    };
    if shapes(|shape| matches!(shape, Shape::Pose | Shape::Poses(_))) {
        tuple("Pose", &["position", "rotation"]);
    }
    if shapes(|shape| matches!(shape, Shape::Wrench | Shape::Wrenches(_))) {
        tuple("Wrench", &["force", "moment"]);
    }
    for (i, name, _) in &sheet.identifiers.functions {
        let parts = &derivation.functions[*i].results;
        if parts.len() > 1 {
            tuple(&result_name(name), &parts.iter().map(|part| part.name).collect::<Vec<_>>());
        }
    }
    let mut tables = String::new();
    for (number, spline) in derivation.splines().into_iter().enumerate() {
        let mut numbers = |values: &[f64]| {
            let values: Vec<String> = values.iter().map(|&value| sheet.constant(value)).collect();
            list(&values)
        };
        let places = numbers(spline.places());
        let rows: Vec<String> = spline.rows().iter().map(|row| numbers(row)).collect();
        tables += &format!("{}\n", sheet.scope("tables", "", false));
        tables += &format!("TABLE_{number}_PLACES = np.array({places}, dtype=np.float64)\n");
        tables += &format!("TABLE_{number}_ROWS = np.array({})\n", list(&rows));
    }
    sheet.finished(format!("⟨imports⟩\nimport numpy as np\n{results}{tables}⟨shared⟩\n{body}"))
}

fn list(values: &[String]) -> String {
    format!("[{}]", values.join(", "))
}

/// `inverse_dynamics_jacobian` → `InverseDynamicsJacobianResult`
fn result_name(function: &str) -> String {
    let words = function.split('_').filter(|word| !word.is_empty());
    words.map(|word| word[..1].to_uppercase() + &word[1..]).collect::<String>() + "Result"
}

fn parameters(sheet: &mut Sheet<'_, '_>) -> String {
    let begin = sheet.scope("Params", "", false);
    let mut text = format!("{begin}\n@dataclass(frozen=True)\nclass Params:\n");
    let tuple = |values: &[String]| format!("({},)", values.join(", "));
    for (i, parameter) in sheet.derivation.parameters.iter().enumerate() {
        let (kind, value) =
            (if parameter.length.is_some() { "tuple" } else { "float" }, sheet.defaults(parameter, &tuple));
        text += &format!("    {}: {kind} = {value}\n", sheet.identifiers.parameters[i]);
    }
    text
}

fn class_of(sheet: &mut Sheet<'_, '_>, class: &str) -> String {
    let derivation = sheet.derivation;
    let names = |names: Vec<String>| match names.as_slice() {
        [] => "()".to_string(),
        names => format!("({},)", names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")),
    };
    let coordinates = names(component_names(&derivation.coordinates));
    let inputs = names(component_names(&derivation.inputs));
    let fields = derivation.parameters.iter().zip(&sheet.identifiers.parameters).map(|(parameter, name)| {
        let lengths: String = parameter.lengths().iter().map(|n| format!(", {n}")).collect();
        format!("{name}=mbs_parameter(\"{name}\", params.{name}{lengths}), ")
    });
    let fields: String = fields.collect();
    let begin = sheet.scope("__init__", "self._params.", true);
    let mut text = format!(
        "class {class}:\n    coordinates = {coordinates}\n    inputs = {inputs}\n\
         {begin}\n    @np.errstate(all=\"ignore\")\n    def __init__(self, params=None):\n        \
         self.params = params = Params() if params is None else params\n        \
         self._params = SimpleNamespace({fields})\n⟨⟩\n"
    );
    for routine in sheet.routines("self._params.") {
        text += &method(sheet, &routine);
    }
    text
}

fn method(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>) -> String {
    let names: Vec<&str> = routine.arguments.iter().map(|(name, _)| *name).collect();
    let arguments = names.join(", ");
    let begins = routine.arguments.iter().map(|(name, count)| match (*name, count) {
        (name, None) => format!("        {name} = mbs_argument(\"{name}\", {name})\n"),
        ("prescribed", Some(count)) => {
            format!("        prescribed = mbs_argument(\"prescribed\", prescribed, {count}, 3)\n")
        }
        (name, Some(count)) => format!("        {name} = mbs_argument(\"{name}\", {name}, {count})\n"),
    });
    let shapes = routine.arguments.iter().map(|(name, count)| match (*name, count) {
        (name, None) => format!("{name}.shape"),
        ("prescribed", _) => "prescribed.shape[:-2]".to_string(),
        (name, Some(_)) => format!("{name}.shape[:-1]"),
    });
    let batch = format!("        batch = np.broadcast_shapes({})\n", shapes.collect::<Vec<_>>().join(", "));
    let (begin, name, motion) = (&routine.begin, &routine.name, sheet.identifiers.motion.clone());
    let all = std::iter::once("self").chain(names.iter().copied()).collect::<Vec<_>>().join(", ");
    let head = format!("{begin}\n    @np.errstate(all=\"ignore\")\n    def {name}({all}):\n");
    let number = match routine.ending {
        Ending::Accelerations => Some(0),
        Ending::Multipliers => Some(1),
        _ => None,
    };
    if let Some(number) = number {
        return head + &format!("        return self.{motion}({arguments})[{number}]\n");
    }
    let before = match routine.ending {
        Ending::Solve { in_motion: true } => {
            format!("        qdd = self.{}({arguments})\n", sheet.forward_dynamics())
        }
        Ending::Slopes { of_multipliers } => {
            let multipliers = if of_multipliers { "multipliers" } else { "_" };
            format!("        qdd, {multipliers} = self.{motion}({arguments})\n")
        }
        _ => String::new(),
    };
    let lines: String = ending(sheet, routine).iter().map(|line| format!("        {line}\n")).collect();
    head + &begins.collect::<String>() + &batch + &before + "⟨⟩\n" + &lines
}

fn ending(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>) -> Vec<String> {
    let (n, widths) = (sheet.derivation.dof(), routine.widths());
    let parts = || routine.parts.iter().map(|(_, shape)| *shape).zip(&routine.values);
    let returned = |mut parts: Vec<String>| match parts.len() {
        1 => format!("return {}", parts.remove(0)),
        _ => format!("return {}({})", result_name(&routine.name), parts.join(", ")),
    };
    match routine.ending {
        Ending::Accelerations | Ending::Multipliers => Vec::new(),
        Ending::Values => vec![returned(parts().map(|(shape, values)| filled(shape, &list(values))).collect())],
        Ending::Solve { .. } => {
            let rows: Vec<String> = routine.masses.chunks(n).map(list).collect();
            let solved = parts().zip(&widths).map(|((shape, values), width)| {
                let values = list(values);
                filled(shape, &format!("mbs_ldlt_solve({n}, {width}, mass_matrix, reciprocals, {values})"))
            });
            vec![
                format!("mass_matrix = {}", list(&rows)),
                format!("reciprocals = mbs_ldlt({n}, mass_matrix)"),
                returned(solved.collect()),
            ]
        }
        Ending::Motion | Ending::Slopes { .. } => {
            let all = [&routine.masses[..], &routine.jacobian, &routine.values.concat()].concat();
            let vectors = sheet.vectors();
            let values = format!("values = mbs_filled(batch, ({},), {})", all.len(), list(&all));
            if routine.ending == Ending::Motion {
                return vec![
                    values,
                    format!("solved = mbs_constrained({n}, [{vectors}], values, [1], None, None)[..., 0]"),
                    format!("return solved[..., :{n}], solved[..., {n}:]"),
                ];
            }
            let columns: usize = widths.iter().sum();
            let sizes = match sheet.sizes(routine) {
                Some(parameters) => format!("sizes = mbs_filled(batch, ({columns},), {})", list(&parameters)),
                None => format!("sizes = mbs_state_sizes(batch, q, qd, [{}], {})", sheet.kinds(), sheet.inputs()),
            };
            let starts = widths.iter().scan(0, |next, width| Some(std::mem::replace(next, *next + width)));
            let parts =
                starts.zip(&widths).map(|(first, width)| format!("solved[..., :{n}, {first}:{}]", first + width));
            let solved = joined(&widths, ", ");
            vec![
                values,
                sizes,
                format!("solved = mbs_constrained({n}, [{vectors}], values, [{solved}], qdd, sizes)"),
                returned(parts.collect()),
            ]
        }
    }
}

/// Values as arrays in this shape, behind the axes of the batch.
fn filled(shape: Shape, values: &str) -> String {
    let (fill, axes) = match shape {
        Shape::Scalar => return format!("mbs_filled(batch, (), {values})[()]"),
        Shape::Vector(n) => ("mbs_filled", format!("{n},")),
        Shape::Matrix(rows, columns) => ("mbs_filled", format!("{rows}, {columns}")),
        Shape::Symmetric(n) => ("mbs_filled", format!("{n}, {n}")),
        Shape::Matrices(n, rows, columns) => ("mbs_filled", format!("{n}, {rows}, {columns}")),
        Shape::Pose => ("mbs_pose", String::new()),
        Shape::Poses(n) => ("mbs_pose", format!("{n},")),
        Shape::Wrench => ("mbs_wrench", String::new()),
        Shape::Wrenches(n) => ("mbs_wrench", format!("{n},")),
    };
    format!("{fill}(batch, ({axes}), {values})")
}
