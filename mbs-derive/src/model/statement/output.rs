//! `output name = value;`, `output name[i] = value;`: what is put out, in which shape and under which functions.

use std::collections::BTreeMap;

use crate::catalogue::{names, names_of_output};
use crate::diagnostic::Code;
use crate::expr::Expr;
use crate::model::lagrangian::{Output, OutputValue};
use crate::model::names::family::Family;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::Dimension;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::{Free, Scalar, Tensor, Value};
use crate::parse::syntax::{Expression, Name, Span};

/// Longer arrays are a slip of the pen.
const MAX_LENGTH: usize = 10_000;

/// Methods that every generated mechanism has beside its functions: an output of that name would be a second one.
const METHODS: [&str; 4] = ["new", "try_new", "default", "params"];

/// An output, or an array of them, as far as its statements have been met.
pub(in crate::model) struct Outputs<'g> {
    pub(in crate::model) family: Family,
    docs: Vec<String>,
    elements: BTreeMap<usize, Shown<'g>>,
    /// How many of them ask for the rates of their Jacobians.
    requests: usize,
}

/// A value in world axes, with the unit of each of its numbers, empty of the literal 0; none where it was refused.
type Shown<'g> = Resolved<(OutputValue<'g>, Vec<String>)>;

impl<'d, 'g> Resolver<'d, 'g> {
    /// `output name = value;`, `output name[i] = value;`
    pub(in crate::model) fn output(
        &mut self,
        docs: &[String],
        name: &Name,
        index: Option<&Expression>,
        value: &Expression,
        jacobian_rate: Option<&Span>,
    ) -> Resolved<()> {
        let number = self.number_of(index, MAX_LENGTH, "output");
        let value = self.argument(value);
        if let Ok(value) = &value {
            self.note_meaning(&name.span, &value.value);
        }
        let number = number?;
        let position = self.noted_output(docs, name, number)?;
        if let (Ok(value), None) = (&value, number) {
            self.give(name, &value.value);
        }
        let shown = value.and_then(|value| self.shown(&value)).and_then(|shown| match jacobian_rate {
            Some(request) => self.check_jacobian_rate(&name.text, &shown.0, request).map(|()| shown),
            None => Ok(shown),
        });
        let outputs = &mut self.found.outputs[position];
        outputs.requests += usize::from(jacobian_rate.is_some());
        outputs.elements.insert(number.unwrap_or(0), shown);
        Ok(())
    }

    fn noted_output(&mut self, docs: &[String], name: &Name, number: Option<usize>) -> Resolved<usize> {
        let known = self.found.functions_of_outputs.get(&name.text).copied();
        match known.filter(|&known| self.found.outputs[known].family.name.text == name.text) {
            Some(known) if self.found.outputs[known].family.is_array || number.is_some() || self.is_in_a_loop() => {
                self.join(|resolver| &mut resolver.found.outputs[known].family, name, number, "output")?;
                Ok(known)
            }
            _ => {
                let functions = names_of_output(&name.text);
                self.check_output_name(name, &functions)?;
                let position = self.found.outputs.len();
                self.found.functions_of_outputs.extend(functions.into_iter().map(|function| (function, position)));
                let (family, docs) = (Family::new(name, number), docs.to_vec());
                self.found.outputs.push(Outputs { family, docs, elements: BTreeMap::new(), requests: 0 });
                Ok(position)
            }
        }
    }

    /// All outputs in order of declaration, arrays put together.
    pub(in crate::model) fn gather_outputs(&mut self) {
        for Outputs { family, docs, elements, requests } in std::mem::take(&mut self.found.outputs) {
            let name = family.name.text.clone();
            if requests > 0 && requests < elements.len() {
                let message = format!("`jacobian_rate` is asked for by some elements of `{name}`, not by all");
                self.refuse(Code::JacobianRate, &family.name.span, message, "write it in each of their statements");
            }
            let complete = self.complete(&family, "output").is_ok();
            let Ok(mut elements) = elements.into_values().collect::<Resolved<Vec<_>>>() else { continue };
            let shown = match family.is_array {
                true if complete => self.combined_values(elements, &family.name.span),
                true => Err(Refused),
                false => elements.pop().ok_or(Refused),
            };
            if let Ok((value, units)) = shown {
                self.lagrangian.outputs.push(Output {
                    name,
                    docs,
                    units: completed(units),
                    value,
                    jacobian_rate: requests > 0,
                });
            }
        }
    }

    /// The Jacobian of what depends on velocities changes with accelerations, and the rates of inputs are not known.
    fn check_jacobian_rate(&mut self, name: &str, value: &OutputValue<'g>, request: &Span) -> Resolved<()> {
        // Places are made of positions.
        let components = value.numbers();
        let depends =
            components.into_iter().fold(Dependence::default(), |all, e| all.or(self.known.facts.dependence(e)));
        let what = match (depends.on(Dependence::VELOCITY), depends.on(Dependence::INPUT)) {
            (true, _) => "velocities",
            (false, true) => "inputs",
            (false, false) => return Ok(()),
        };
        let message = format!("`{name}` depends on {what}: its Jacobian has no rate that is a function of the state");
        Err(self.refuse(Code::JacobianRate, request, message, "leave it out; positions and attitudes have one"))
    }

    /// `what` is put out under this name; functions of every mechanism are called otherwise.
    pub(in crate::model) fn check_is_free(&mut self, name: &Name, functions: &[String], what: &str) -> Resolved<()> {
        if functions.iter().any(|f| METHODS.into_iter().chain(names()).any(|known| known == f)) {
            let message = format!("`{}` is a function of every mechanism", name.text);
            return Err(self.refuse(
                Code::BuiltIn,
                &name.span,
                message,
                format!("choose another name for this {what}"),
            ));
        }
        Ok(())
    }

    fn check_output_name(&mut self, name: &Name, functions: &[String]) -> Resolved<()> {
        let known = functions.iter().filter_map(|function| self.found.functions_of_outputs.get(function)).min();
        if let Some(&position) = known {
            let other = &self.found.outputs[position].family.name.text;
            let message =
                format!("there is already an output `{other}`, with its `{other}_velocity` and `{other}_jacobian`");
            return Err(self.refuse(Code::NameClash, &name.span, message, "choose another name"));
        }
        if let Some(joint) = self.found.joints.iter().find(|joint| functions.contains(&joint.family.name.text)) {
            let (message, first) =
                (format!("there is already a reaction `{}`", joint.family.name.text), joint.family.name.span.clone());
            return Err(self.refuse_twice(&name.span, message, "choose another name".to_string(), first));
        }
        self.check_is_free(name, functions, "output")
    }
}

// ---- values

impl<'d, 'g> Resolver<'d, 'g> {
    /// In world axes, with the units of its components.
    fn shown(&mut self, value: &Argument<'g>) -> Shown<'g> {
        match &value.value {
            Value::Scalar(Scalar { expr, dimension }) => Ok((OutputValue::Scalar(*expr), vec![dimension.to_string()])),
            Value::Vector(_) | Value::Point(_) => {
                let vector @ Free { dimension, .. } = self.vector(value)?;
                let components = self.in_world(vector).0;
                let is_zero = components.iter().all(|component| component.is_zero());
                let unit = if is_zero { String::new() } else { dimension.to_string() };
                Ok((OutputValue::Array(components.to_vec()), vec![unit; 3]))
            }
            Value::Matrix(_) => {
                let Tensor { entries, dimension, .. } = self.matrix_in_world(value)?;
                let rows = entries.0.map(|row| row.to_vec()).to_vec();
                Ok((OutputValue::Matrix(rows), vec![dimension.to_string(); 9]))
            }
            Value::Pose(_) => {
                let units =
                    [vec![self.dimension(Dimension::LENGTH).to_string(); 3], vec![Dimension::ONE.to_string(); 9]];
                Ok((OutputValue::Pose(self.frame(value)?), units.concat()))
            }
            Value::Part(_) => Err(self.no_value_of_a_part(value)),
            Value::Array(array) => {
                let mut elements = Vec::new();
                for element in array.values() {
                    let (shown, units) = self.shown(&Argument { value: element.clone(), span: value.span.clone() })?;
                    // The literal 0 has any unit.
                    let is_zero = matches!(shown, OutputValue::Scalar(number) if number.is_zero());
                    elements.push((shown, if is_zero { vec![String::new()] } else { units }));
                }
                self.combined_values(elements, &value.span)
            }
        }
    }

    /// Values of one shape as one value: numbers as an array, rows as a matrix, matrices and poses as arrays of them.
    fn combined_values(&mut self, values: Vec<(OutputValue<'g>, Vec<String>)>, span: &Span) -> Shown<'g> {
        let (values, units): (Vec<_>, Vec<_>) = values.into_iter().unzip();
        Ok((self.together(values, span)?, units.concat()))
    }

    fn together(&mut self, values: Vec<OutputValue<'g>>, span: &Span) -> Resolved<OutputValue<'g>> {
        let (mut numbers, mut rows, mut matrices, mut poses) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (count, mut deeper) = (values.len(), false);
        for value in values {
            match value {
                OutputValue::Scalar(number) => numbers.push(number),
                OutputValue::Array(row) => rows.push(row),
                OutputValue::Matrix(matrix) => matrices.push(matrix),
                OutputValue::Pose(frame) => poses.push(frame),
                OutputValue::Matrices(_) | OutputValue::Poses(_) => deeper = true,
            }
        }
        let same_rows = |rows: &[Vec<Expr<'g>>]| rows.iter().all(|row| row.len() == rows[0].len());
        let help = "write several outputs";
        if deeper {
            let message = "an output is a number, a vector, a matrix or a pose, rows of numbers, or an array of these";
            Err(self.refuse(Code::OutputShape, span, message, help))
        } else if numbers.len() == count {
            Ok(OutputValue::Array(numbers))
        } else if rows.len() == count {
            match same_rows(&rows) {
                true => Ok(OutputValue::Matrix(rows)),
                false => Err(self.refuse(Code::OutputShape, span, "the rows of an output have equal lengths", help)),
            }
        } else if matrices.len() == count {
            let first = &matrices[0];
            match matrices.iter().all(|m| m.len() == first.len() && m[0].len() == first[0].len()) {
                true => Ok(OutputValue::Matrices(matrices)),
                false => Err(self.refuse(
                    Code::OutputShape,
                    span,
                    "the matrices of an output have equal numbers of rows and columns",
                    help,
                )),
            }
        } else if poses.len() == count {
            Ok(OutputValue::Poses(poses))
        } else {
            let kinds = [
                (numbers.is_empty(), "numbers"),
                (rows.is_empty(), "rows of numbers"),
                (matrices.is_empty(), "matrices"),
                (poses.is_empty(), "poses"),
            ];
            let mut met = kinds.into_iter().filter(|(none, _)| !none).map(|(_, kind)| kind);
            let (one, other) = (met.next().unwrap_or_default(), met.next().unwrap_or_default());
            let message = format!("some elements of this output are {one}, others are {other}");
            Err(self.refuse(Code::OutputShape, span, message, "write several outputs, or elements of one shape"))
        }
    }
}

/// A literal 0 has the unit that all others share.
fn completed(units: Vec<String>) -> Vec<String> {
    let mut known: Vec<&String> = units.iter().filter(|unit| !unit.is_empty()).collect();
    known.dedup();
    let shared = match known.as_slice() {
        [] => Dimension::ONE.to_string(),
        [one] => one.to_string(),
        _ => String::new(),
    };
    units.into_iter().map(|unit| if unit.is_empty() { shared.clone() } else { unit }).collect()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::model::check::trial::{mechanism, near, refusals, refused, value, value_with_unit};
    use crate::model::{FrameId, OutputValue};

    /// What an output may not be called is what is emitted for a mechanism with everything that one may have.
    #[test]
    fn outputs_cannot_take_the_name_of_a_function() {
        let text = "#![dimensionless] mechanism A { param m: 1 = 2; coord x: 1; coord y: 1; constraint c: x = y; \
                    kinetic += m*(dt(x)^2 + dt(y)^2); output o = x; }";
        let code = crate::generate("a", text, &Default::default()).expect("as good as any").code;
        // An output may have the name of a function that only the trait has.
        let (code, _) = code.split_once("::mbs_runtime::Constraints<T> for").expect("a constrained mechanism");
        let functions = code.lines().filter_map(|line| line.trim().trim_start_matches("pub ").strip_prefix("fn "));
        let names = functions.filter_map(|rest| rest.split(['(', '<']).next());
        // A private one gives way, and `check` is a function of the parameters.
        let public = names.filter(|name| !["constrained_motion", "check"].contains(name));
        let emitted: BTreeSet<&str> = public.filter(|name| *name != "o" && !name.starts_with("o_")).collect();
        assert_eq!(emitted, super::METHODS.into_iter().chain(super::names()).collect());
    }

    #[test]
    fn outputs_of_every_shape() {
        assert_eq!(value_with_unit("", "2*x"), (vec![0.6], "m".to_string()));
        let units = |value: &str| {
            mechanism(&format!("output result = {value};"), |lagrangian| lagrangian.outputs[0].units.join(" "))
        };
        assert_eq!(units("[x, y, 0]"), "m m m");
        assert_eq!(units("[x, theta, theta]"), "m 1 1");
        assert_eq!(units("[[x, y], [theta, 0]]"), "m m 1 ");
        assert_eq!(units("diag(m, m, m)"), ["kg"; 9].join(" "));
        assert_eq!(units("[[0, 0, 0], [0, 0, 0]]"), ["1"; 6].join(" "));
        assert_eq!(units("world"), "m m m 1 1 1 1 1 1 1 1 1");
        assert_eq!(value("", "[[1, 2], [3, 4], [5, 6]]"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        near(
            &value("let a = rot_z(pi/2);", "[a * [1, 2, 3], a * [0, 0, 1]]"),
            &[-2.0, 1.0, 3.0, 0.0, 0.0, 1.0],
            "rows in world axes",
        );
        mechanism(
            "/// Where it ends.\noutput flange = world; output q = q; output a = particle(m, [x, y, z]);",
            |lagrangian| {
                assert!(matches!(lagrangian.outputs[0].value, OutputValue::Pose(FrameId::WORLD)));
                assert_eq!(lagrangian.outputs[0].docs, ["Where it ends."]);
                assert!(matches!(&lagrangian.outputs[1].value, OutputValue::Array(values) if values.len() == 2));
                assert!(matches!(lagrangian.outputs[2].value, OutputValue::Scalar(_)));
            },
        );
        let frames = "let a = rot_z(theta); let b = translation([x, 0, 0])*a;";
        mechanism(
            &format!("{frames} output poses = [a, b]; output matrices = [diag(1, 2, 3), a.rotation()];"),
            |found| {
                assert!(matches!(&found.outputs[0].value, OutputValue::Poses(frames) if frames.len() == 2));
                assert!(matches!(&found.outputs[1].value, OutputValue::Matrices(matrices) if matrices[1].len() == 3));
            },
        );
        refused(
            "output a = [[1, 2], [3]];",
            "[[1, 2], [3]]: the rows of an output have equal lengths; write several outputs",
        );
        refused(
            "output a = [world, x];",
            "[world, x]: some elements of this output are numbers, others are poses; write several outputs, or elements of one shape",
        );
        refused(
            "output a = [[world, world], [world, world]];",
            "[[world, world], [world, world]]: an output is a number, a vector, a matrix or a pose, rows of numbers, or an \
             array of these; write several outputs",
        );
        refused(
            "output a = x; output a = y;",
            "a: there is already an output `a`, with its `a_velocity` and `a_jacobian`; choose another name",
        );
        refused(
            "output a = x; output a_jacobian = y;",
            "a_jacobian: there is already an output `a`, with its `a_velocity` and `a_jacobian`; choose another name",
        );
        let help = "leave it out; positions and attitudes have one";
        let why = |what: &str| {
            format!(
                "jacobian_rate: `a` depends on {what}: its Jacobian has no rate that is a function of the state; {help}"
            )
        };
        refused("output a = [x, dt(x)/t, 0*x/t], jacobian_rate;", &why("velocities"));
        refused("output a = u*x, jacobian_rate;", &why("inputs"));
        refused("output a = [[dt(x), 0], [u*x/k/t, 0]], jacobian_rate;", &why("velocities"));
        refused(
            "output a = x, jacobian_rate; output a_jacobian_rate = y;",
            "a_jacobian_rate: there is already an output `a`, with its `a_velocity` and `a_jacobian`; choose another name",
        );
        mechanism(
            "prescribed s: m; output a = s*x*t/t, jacobian_rate; output b = [x, dt(s)/k*m/t/t, 0], jacobian_rate; \
             output c = world, jacobian_rate; output d = x;",
            |lagrangian| {
                let asked: Vec<bool> = lagrangian.outputs.iter().map(|output| output.jacobian_rate).collect();
                assert_eq!(asked, [true, true, true, false]);
            },
        );
        refused(
            "output bias = x;",
            "bias: `bias` is a function of every mechanism; choose another name for this output",
        );
    }

    #[test]
    fn loops_declare_arrays_of_outputs() {
        assert_eq!(value("for i in 0..2 { output a[i] = q[i]; }", "x"), [0.3]);
        let declared = |statements: &str, look: fn(&OutputValue<'_>) -> bool| {
            mechanism(statements, |found| assert!(look(&found.outputs[0].value), "{statements}"));
        };
        let row = |value: &OutputValue<'_>| matches!(value, OutputValue::Array(row) if row.len() == 2);
        declared("for i in 0..2 { output a[i] = q[i]; }", row);
        declared("output a[1] = q[1]; output a[0] = x/l;", row);
        let matrix = |value: &OutputValue<'_>| matches!(value, OutputValue::Matrix(rows) if rows[1].len() == 3);
        declared("for i in 0..2 { output a[i] = rot_z(q[i])*[l, 0, 0]; }", matrix);
        let poses = |value: &OutputValue<'_>| matches!(value, OutputValue::Poses(frames) if frames.len() == 2);
        declared("for i in 0..2 {\n/// Links.\noutput a[i] = rot_z(q[i]); }", poses);
        let matrices = |value: &OutputValue<'_>| matches!(value, OutputValue::Matrices(all) if all.len() == 2);
        declared("for i in 0..2 { output a[i] = rot_z(q[i]).rotation(), jacobian_rate; }", matrices);
        declared("for i in 0..2 { if i == 1 { output a = [x, y]; } }", row);
        mechanism("for i in 0..2 {\n/// Both.\noutput a[i] = [q[i], l/l, 0]; } output b = x;", |found| {
            let names: Vec<_> = found.outputs.iter().map(|o| (o.name.as_str(), o.units[0].as_str())).collect();
            assert_eq!((names, &*found.outputs[0].docs[0]), (vec![("a", "1"), ("b", "m")], "Both."));
        });
        refused(
            "for i in 0..2 { output a = x; }",
            "a: each turn of the loop declares an output `a`; give it an index: `output a[i]`, which runs from 0",
        );
        refused(
            "for i in 0..2 { output a[0] = x; }",
            "a: several turns of the loop declare an output `a[0]`; give it an index that is another one in each turn",
        );
        refused(
            "for i in 1..3 { output a[i] = x; }",
            "a: there is no output `a[0]`; indices run from 0 on, without gaps",
        );
        refused(
            "output a[0] = x; output a[1] = [x, y];",
            "a: some elements of this output are numbers, others are rows of numbers; write several outputs, or elements of \
             one shape",
        );
        refused(
            "output a[0] = x; output a = y;",
            "a: `a` is both one output and an array; give all of them an index, or another name",
        );
        refused(
            "output a[0] = x; output a[0] = y;",
            "a: there is already an output `a[0]`; each index stands for one output",
        );
        refused(
            "output a[0] = x, jacobian_rate; output a[1] = y;",
            "a: `jacobian_rate` is asked for by some elements of `a`, not by all; write it in each of their statements",
        );
        refused("output a[i] = x;", "i: `i` is not declared; did you mean `pi`?");
        assert_eq!(refusals("for i in 0..3 { output a[i] = nothing_like_it; }").len(), 1);
    }
}
