//! Statements, in order: local names, loops, outputs; quantities and energies have files of their own.

use super::constant::Dependence;
use super::dimension::Dimension;
use super::evaluate::{Argument, Refused, Resolved, Resolver};
use super::function::Home;
use super::lagrangian::{Output, OutputValue};
use super::scope::{Binding, Origin};
use super::value::{Free, Scalar, Shape, Tensor, Value, shared};
use crate::expr::Expr;
use crate::parse::syntax::{Expression, Name, Quantity, Span, Statement, StatementKind};

/// Turns that the loops of one mechanism may take, all together.
pub(super) const MAX_TURNS: usize = 100_000;

/// Loops within loops.
const MAX_BLOCKS: usize = 100;

/// Functions that every generated mechanism has: an output of that name would be a second one.
#[rustfmt::skip]
const GENERATED: [&str; 24] = [
    "kinetic_energy", "potential_energy", "mass_matrix", "coriolis_matrix", "gravity", "bias", "momentum",
    "inverse_dynamics", "forward_dynamics", "linearize", "inverse_dynamics_jacobian", "dissipation_force",
    "generalized_force", "conserved", "constraint", "constraint_rate", "constraint_rate_jacobian", "constraint_jacobian",
    "constraint_bias", "multipliers",
    "linearize_parameters", "new", "default", "params",
];

impl<'d, 'g> Resolver<'d, 'g> {
    /// What names stand for, before any statement is looked at.
    pub(super) fn survey(&mut self, statements: &'d [Statement]) {
        for statement in statements {
            let (name, value) = match &statement.kind {
                StatementKind::Param(Quantity { name, value, .. })
                | StatementKind::Coord(Quantity { name, value, .. })
                | StatementKind::Input(Quantity { name, value, .. })
                | StatementKind::Prescribed(Quantity { name, value, .. })
                | StatementKind::Const(Quantity { name, value, .. }) => (name, value.as_ref()),
                StatementKind::Let { name, value, .. } => (name, Some(value)),
                StatementKind::Function { name, parameters, body } => {
                    self.function(name, parameters, body);
                    continue;
                }
                StatementKind::Assign { .. }
                | StatementKind::Energy { .. }
                | StatementKind::ForceAt { .. }
                | StatementKind::TorqueOn { .. }
                | StatementKind::Gravity { .. }
                | StatementKind::Reaction { .. }
                | StatementKind::Constraint { .. }
                | StatementKind::Force { .. }
                | StatementKind::Output { .. }
                | StatementKind::For { .. } => continue,
            };
            self.definitions.entry(&name.text).or_insert(value);
        }
        self.check_circles();
    }

    /// All statements; `false` where the mechanism has outgrown its limits and the rest is not looked at.
    pub(super) fn statements(&mut self, statements: &'d [Statement]) -> bool {
        statements.iter().all(|statement| {
            // Why it was refused has been noted; the next one may be right.
            let _ = self.statement(statement);
            !self.exhausted(&statement.span) && !self.errors.is_full()
        })
    }

    fn statement(&mut self, statement: &'d Statement) -> Resolved<()> {
        match &statement.kind {
            StatementKind::Param(quantity) => {
                self.outermost("param", &statement.span).and_then(|()| self.parameter(quantity))
            }
            StatementKind::Coord(quantity) => {
                self.outermost("coord", &statement.span).and_then(|()| self.coordinate(quantity))
            }
            StatementKind::Input(quantity) => {
                self.outermost("input", &statement.span).and_then(|()| self.input(quantity))
            }
            StatementKind::Prescribed(quantity) => {
                self.outermost("prescribed", &statement.span).and_then(|()| self.prescribed(quantity))
            }
            StatementKind::Const(quantity) => self.constant(quantity),
            // Known from the start.
            StatementKind::Function { .. } => self.outermost("fn", &statement.span),
            StatementKind::Let { mutable, name, value } => {
                let origin = if *mutable { Origin::Mutable } else { Origin::Local };
                let value = self.definition(name, value).ok();
                self.declare(name, origin, value)
            }
            StatementKind::Assign { name, value } => self.assign(name, value),
            StatementKind::Energy { term, value } => self.energy(*term, value),
            StatementKind::Force { coordinate, index, value } => self.force(coordinate, index.as_ref(), value),
            StatementKind::ForceAt { point, value } => self.force_at(point, value),
            StatementKind::TorqueOn { pose, value } => self.torque_on(pose, value),
            StatementKind::Gravity { acceleration } => {
                self.outermost("gravity", &statement.span).and_then(|()| self.gravity(acceleration, &statement.span))
            }
            StatementKind::Reaction { docs, name, index, pose } => self.reaction(docs, name, index.as_ref(), pose),
            StatementKind::Constraint { docs, name, left, right } => {
                self.outermost("constraint", &statement.span).and_then(|()| self.constraint(docs, name, left, right))
            }
            StatementKind::Output { docs, name, value, jacobian_rate } => self
                .outermost("output", &statement.span)
                .and_then(|()| self.output(docs, name, value, jacobian_rate.as_ref())),
            StatementKind::For { variable, start, end, body } => self.repeat(variable, start, end, body),
        }
    }

    fn outermost(&mut self, keyword: &str, span: &Span) -> Resolved<()> {
        if self.scope.is_outermost() {
            return Ok(());
        }
        let message = format!("`{keyword}` cannot stand in a loop");
        let help = match keyword {
            "gravity" => "one statement acts on all bodies, wherever they stand: move it out of the loop",
            "fn" => "functions are the mechanism's own: move it out of the loop",
            "constraint" => "write one constraint of an array: `constraint name: [a, b] = [c, d];`",
            _ => "declare an array before the loop, and use its elements in it",
        };
        Err(self.refuse(span, message, help))
    }

    /// The value that a name is given, by an expression that must not come back to the name.
    pub(super) fn definition(&mut self, name: &'d Name, value: &Expression) -> Resolved<Value<'g>> {
        self.defining = self.scope.is_outermost().then_some(name.text.as_str());
        let value = self.expression(value);
        self.defining = None;
        value
    }

    /// Gives a name its meaning in the innermost block; `None` where its declaration was wrong.
    pub(super) fn declare(&mut self, name: &Name, origin: Origin, value: Option<Value<'g>>) -> Resolved<()> {
        let (text, span) = (&name.text, name.span.clone());
        if super::builtin::CONSTANTS.contains(&text.as_str()) {
            return Err(self.refuse(&span, format!("`{text}` is built in"), "choose another name"));
        }
        let function =
            self.functions.get(text.as_str()).filter(|f| f.home != Home::Library && self.scope.is_outermost());
        if let Some(first) = function.map(|f| f.place()) {
            // What is made of it is given up without a word.
            let _ = self.scope.declare(text, Binding::new(origin, None, span.clone()));
            let (message, help) = (format!("`{text}` is already a function"), "choose another name".to_string());
            return Err(self.refuse_twice(&span, message, help, first));
        }
        match self.scope.declare(text, Binding::new(origin, value, span.clone())) {
            Ok(()) => Ok(()),
            Err(known) => {
                let help = match known {
                    Origin::Mutable => format!("write `{text} = …;` to give it a new value"),
                    Origin::Local if matches!(origin, Origin::Local) => {
                        format!("declare the first as `let mut` and write `{text} = …;` here, or choose another name")
                    }
                    _ => "choose another name".to_string(),
                };
                let message = format!("`{text}` is already {}", known.described());
                match self.scope.get(text).map(|binding| binding.span.clone()) {
                    Some(first) if self.scope.is_outermost() => Err(self.refuse_twice(&span, message, help, first)),
                    _ => Err(self.refuse(&span, message, help)),
                }
            }
        }
    }

    fn assign(&mut self, name: &'d Name, value: &Expression) -> Resolved<()> {
        let value = self.argument(value);
        let Some(binding) = self.scope.get(&name.text) else {
            let message = format!("`{}` is not declared", name.text);
            return Err(self.refuse(&name.span, message, format!("write `let {} = …;`", name.text)));
        };
        if binding.origin != Origin::Mutable {
            let message = format!("`{}` is {}: it keeps its value", name.text, binding.origin.described());
            return Err(self.refuse(&name.span, message, "only what is declared by `let mut` takes a new one"));
        }
        if let (Some(old), Ok(new)) = (binding.value.clone(), &value) {
            self.check_assignment(&name.text, old, new)?;
        }
        if let Some(binding) = self.scope.get_mut(&name.text) {
            binding.value = value.ok().map(|argument| argument.value);
            binding.used = None;
        }
        Ok(())
    }

    /// A name keeps its shape, and a number its dimension.
    fn check_assignment(&mut self, name: &str, old: Value<'g>, new: &Argument<'g>) -> Resolved<()> {
        if old.shape() != new.value.shape() {
            let message = format!("`{name}` is {}, this is {}", old.described(), new.value.described());
            return Err(self.refuse(&new.span, message, "use another name for it"));
        }
        if old.shape() == Shape::Number {
            let old = self.scalar(&Argument { value: old, span: new.span.clone() })?;
            let found = self.scalar(new)?;
            if shared(old.fit(), found.fit()).is_none() {
                let message = format!("`{name}` is {}, this is {}", old.dimension, found.dimension);
                return Err(self.refuse(&new.span, message, "use another name for it"));
            }
        }
        Ok(())
    }
}

// ---- loops

impl<'d, 'g> Resolver<'d, 'g> {
    fn repeat(
        &mut self,
        variable: &'d Name,
        start: &Expression,
        end: &Expression,
        body: &'d [Statement],
    ) -> Resolved<()> {
        let (first, last) = (self.bound(start), self.bound(end));
        let (Ok(first), Ok(last)) = (first, last) else {
            return Err(Refused);
        };
        for number in first..last {
            self.turns += 1;
            if self.turns > MAX_TURNS {
                let message = format!("the loops of this mechanism take more than {MAX_TURNS} turns");
                return Err(self.refuse(
                    &(start.span.start..end.span.end),
                    message,
                    "is the range meant to be so long?",
                ));
            }
            // What is wrong in one turn is wrong in the next.
            if !self.turn(variable, number, body) {
                return Err(Refused);
            }
        }
        Ok(())
    }

    fn bound(&mut self, expression: &Expression) -> Resolved<i64> {
        let bound = self.argument(expression)?;
        self.integer(&bound, "the bound of a loop")
    }

    /// Whether all went well.
    fn turn(&mut self, variable: &Name, number: i64, body: &'d [Statement]) -> bool {
        let errors = self.errors.error_count();
        self.scope.enter();
        let value = Value::Scalar(Scalar::plain(self.graph.integer(number)));
        let declared = self.declare(variable, Origin::Loop, Some(value)).is_ok();
        self.depth_of_blocks += 1;
        let complete = if self.depth_of_blocks > MAX_BLOCKS {
            self.refuse(&variable.span, format!("loops are nested deeper than {MAX_BLOCKS} levels"), "");
            false
        } else {
            declared && self.statements(body)
        };
        self.depth_of_blocks -= 1;
        self.scope.leave();
        complete && self.errors.error_count() == errors
    }
}

// ---- outputs

impl<'d, 'g> Resolver<'d, 'g> {
    fn output(
        &mut self,
        docs: &[String],
        name: &Name,
        value: &Expression,
        jacobian_rate: Option<&Span>,
    ) -> Resolved<()> {
        let value = self.argument(value);
        self.check_output_name(name)?;
        let (value, unit) = self.shown(&value?)?;
        if let Some(request) = jacobian_rate {
            self.check_jacobian_rate(&name.text, &value, request)?;
        }
        let (name, docs) = (name.text.clone(), docs.to_vec());
        self.lagrangian.outputs.push(Output { name, docs, unit, value, jacobian_rate: jacobian_rate.is_some() });
        Ok(())
    }

    /// The Jacobian of what depends on velocities changes with accelerations, and the rates of inputs are not known.
    fn check_jacobian_rate(&mut self, name: &str, value: &OutputValue<'g>, request: &Span) -> Resolved<()> {
        let components = match value {
            OutputValue::Scalar(expr) => vec![*expr],
            OutputValue::Array(row) => row.clone(),
            OutputValue::Matrix(rows) => rows.concat(),
            // Places are made of positions.
            OutputValue::Pose(_) => return Ok(()),
        };
        let depends = components.into_iter().fold(Dependence::default(), |all, e| all.or(self.facts.dependence(e)));
        let what = match (depends.on(Dependence::VELOCITY), depends.on(Dependence::INPUT)) {
            (true, _) => "velocities",
            (false, true) => "inputs",
            (false, false) => return Ok(()),
        };
        let message = format!("`{name}` depends on {what}: its Jacobian has no rate that is a function of the state");
        Err(self.refuse(request, message, "leave it out; positions and attitudes have one"))
    }

    /// `what` is put out under this name; functions of every mechanism are called otherwise.
    pub(super) fn check_is_free(&mut self, name: &Name, functions: &[String], what: &str) -> Resolved<()> {
        if functions.iter().any(|f| GENERATED.contains(&f.as_str())) {
            let message = format!("`{}` is a function of every mechanism", name.text);
            return Err(self.refuse(&name.span, message, format!("choose another name for this {what}")));
        }
        Ok(())
    }

    fn check_output_name(&mut self, name: &Name) -> Resolved<()> {
        let text = name.text.as_str();
        let functions = functions_of_output;
        let clashes = |other: &str| functions(other).iter().any(|f| functions(text).contains(f));
        if let Some(output) = self.lagrangian.outputs.iter().find(|output| clashes(&output.name)) {
            let other = &output.name;
            let message =
                format!("there is already an output `{other}`, with its `{other}_velocity` and `{other}_jacobian`");
            return Err(self.refuse(&name.span, message, "choose another name"));
        }
        if let Some(joint) = self.joints.iter().find(|joint| functions(text).contains(&joint.name.text)) {
            let (message, first) =
                (format!("there is already a reaction `{}`", joint.name.text), joint.name.span.clone());
            return Err(self.refuse_twice(&name.span, message, "choose another name".to_string(), first));
        }
        self.check_is_free(name, &functions(text), "output")
    }

    /// In world axes, with its unit.
    fn shown(&mut self, value: &Argument<'g>) -> Resolved<(OutputValue<'g>, String)> {
        match value.value.shape() {
            Shape::Number => {
                let Scalar { expr, dimension } = self.scalar(value)?;
                Ok((OutputValue::Scalar(expr), dimension.to_string()))
            }
            Shape::Vector => {
                let (components, dimensions) = self.row(value)?;
                Ok((OutputValue::Array(components), unit(dimensions)))
            }
            Shape::Matrix if matches!(value.value, Value::Matrix(_)) => {
                let Tensor { entries, dimension, .. } = self.matrix_in_world(value)?;
                Ok((OutputValue::Matrix(entries.0.map(|row| row.to_vec()).to_vec()), dimension.to_string()))
            }
            Shape::Pose => Ok((OutputValue::Pose(self.frame(value)?), String::from("m"))),
            Shape::Matrix | Shape::Array => self.shown_array(value),
        }
    }

    fn shown_array(&mut self, array: &Argument<'g>) -> Resolved<(OutputValue<'g>, String)> {
        let elements = self.elements(array)?;
        if elements.iter().all(|e| e.shape() == Shape::Number) {
            let (row, dimensions) = self.row(array)?;
            return Ok((OutputValue::Array(row), unit(dimensions)));
        }
        let (mut rows, mut dimensions) = (Vec::new(), Vec::new());
        for element in elements {
            let (row, found) = self.row(&Argument { value: element, span: array.span.clone() })?;
            rows.push(row);
            dimensions.extend(found);
        }
        if rows.iter().any(|row| row.len() != rows[0].len()) {
            let message = "the rows of an output have equal lengths";
            return Err(self.refuse(&array.span, message, "write several outputs"));
        }
        Ok((OutputValue::Matrix(rows), unit(dimensions)))
    }

    /// The numbers of an array or vector, and the dimensions of those that are not 0.
    fn row(&mut self, row: &Argument<'g>) -> Resolved<(Vec<Expr<'g>>, Vec<Dimension>)> {
        let elements = match &row.value {
            Value::Array(array) => array.values().to_vec(),
            Value::Vector(_) | Value::Point(_) => {
                let vector = self.vector(row)?;
                let Free { dimension, .. } = vector;
                let number = |expr| Value::Scalar(Scalar::new(expr, dimension));
                self.in_world(vector).0.map(number).to_vec()
            }
            Value::Scalar(_) => {
                let message = "some elements of this output are numbers, others are rows of them";
                return Err(self.refuse(&row.span, message, "write several outputs, or rows of equal length"));
            }
            other => {
                let message = format!(
                    "an output is a number, vector, matrix, pose, or rows of numbers; here is {}",
                    other.described()
                );
                return Err(self.refuse(&row.span, message, "write several outputs"));
            }
        };
        let mut numbers = (Vec::new(), Vec::new());
        for element in elements {
            let number = self.scalar(&Argument { value: element, span: row.span.clone() })?;
            numbers.0.push(number.expr);
            if !number.expr.is_zero() {
                numbers.1.push(number.dimension);
            }
        }
        Ok(numbers)
    }
}

/// The functions that an output becomes.
pub(super) fn functions_of_output(name: &str) -> [String; 4] {
    ["", "_velocity", "_jacobian", "_jacobian_rate"].map(|suffix| format!("{name}{suffix}"))
}

/// Of several numbers: the one that they share, else all.
fn unit(mut dimensions: Vec<Dimension>) -> String {
    if dimensions.is_empty() {
        dimensions.push(Dimension::ONE);
    }
    let mut texts: Vec<String> = dimensions.iter().map(Dimension::to_string).collect();
    texts.dedup();
    texts.join(", ")
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::trial::{mechanism, near, refusals, refused, value, value_with_unit};
    use super::super::{FrameId, OutputValue};

    /// [`GENERATED`](super::GENERATED) lists what is emitted for a mechanism with everything that one may have.
    #[test]
    fn outputs_cannot_take_the_name_of_a_function() {
        let text = "#![dimensionless] mechanism A { param m: 1 = 2; coord x: 1; coord y: 1; constraint c: x = y; \
                    kinetic += m*(dt(x)^2 + dt(y)^2); output o = x; }";
        let code = crate::generate("a", text, &Default::default()).expect("as good as any").code;
        // An output may have the name of a function that only the trait has.
        let (code, _) = code.split_once("::mbs_runtime::Constraints<T> for").expect("a constrained mechanism");
        let functions = code.lines().filter_map(|line| line.trim().trim_start_matches("pub ").strip_prefix("fn "));
        let names = functions.filter_map(|rest| rest.split(['(', '<']).next());
        let emitted: BTreeSet<&str> = names.filter(|name| *name != "o" && !name.starts_with("o_")).collect();
        assert_eq!(emitted, super::GENERATED.into());
    }

    #[test]
    fn blocks_shadow_and_assign() {
        near(&value("let mut a = 1; for i in 0..4 { a = a*2 + i; }", "a"), &[27.0], "assignment from a loop");
        near(&value("let a = 1; for i in 0..4 { let a = 2*i; let b = a; }", "a"), &[1.0], "shadowing");
        near(
            &value("let mut v = [0, 0, 0]; for i in 0..3 { for j in 0..i { v = v + [1, i, j]; } }", "v"),
            &[3.0, 5.0, 1.0],
            "nested loops",
        );
        near(&value("let mut a = 7; for i in 3..1 { a = 0; }", "a"), &[7.0], "an empty loop");
        near(&value("for i in 0..2 { let m = i; }", "m"), &[2.0], "a parameter shadowed in a loop");
    }

    /// Whether a loop goes on does not depend on warnings, however many.
    #[test]
    fn warnings_stop_no_loop() {
        let sum = "let mut a = 0; for i in 0..1500 { let angle = sin(40 + i); a = a + 1; }";
        near(&value(sum, "a"), &[1500.0], "degrees as radians in each turn");
    }

    #[test]
    fn names_are_declared_once() {
        refused("let m = 1;", "m: `m` is already a parameter; choose another name");
        refused(
            "let a = 1; let a = 2;",
            "a: `a` is already a `let`; declare the first as `let mut` and write `a = …;` here, or choose another name",
        );
        refused("let mut a = 1; let a = 2;", "a: `a` is already a `let mut`; write `a = …;` to give it a new value");
        refused("for i in 0..3 { let i = 1; }", "i: `i` is already a loop variable; choose another name");
        refused("coord x: m;", "x: `x` is already a coordinate; choose another name");
    }

    #[test]
    fn only_let_mut_takes_a_new_value() {
        refused(
            "let a = 1; a = 2;",
            "a: `a` is a `let`: it keeps its value; only what is declared by `let mut` takes a new one",
        );
        refused(
            "m = 2;",
            "m: `m` is a parameter: it keeps its value; only what is declared by `let mut` takes a new one",
        );
        refused(
            "for i in 0..9 { i = 2; }",
            "i: `i` is a loop variable: it keeps its value; only what is declared by `let mut` takes a new one",
        );
        refused("a = 2;", "a: `a` is not declared; write `let a = …;`");
        refused(
            "let mut a = 1; a = [1, 2, 3];",
            "[1, 2, 3]: `a` is a number, this is a vector; use another name for it",
        );
        refused("let mut a = m; a = l;", "l: `a` is kg, this is m; use another name for it");
        assert!(refusals("let mut a = 0; a = l; let mut p = world; p = p * rot_z(theta);").is_empty());
    }

    #[test]
    fn loops_have_constant_bounds() {
        refused(
            "for i in 0..m { }",
            "m: the bound of a loop must be a constant integer; a parameter may change at run time: declare it as `const name = …;`",
        );
        refused(
            "for i in 0..5/2 { }",
            "5/2: the bound of a loop must be a constant integer; it is made of numbers, constants and loop variables",
        );
        refused(
            "for i in 0..400 { for j in 0..400 { } }",
            "0..400: the loops of this mechanism take more than 100000 turns; is the range meant to be so long?",
        );
        // One report, not one for each turn; what was wrong in a loop is unknown behind it.
        refused(
            "let mut a = 0; for i in 0..5 { a = nothing_like_it; } let b = a;",
            "nothing_like_it: `nothing_like_it` is not declared; declare it: `param nothing_like_it: m = …;` or `let nothing_like_it = …;`",
        );
        refused(
            "for i in 0..2 { coord y: m; }",
            "coord y: m;: `coord` cannot stand in a loop; declare an array before the loop, and use its elements in it",
        );
        let nested = format!("{}{}", "for i in 0..1 { ".repeat(110), "} ".repeat(110));
        assert_eq!(refusals(&nested), ["i: loops are nested deeper than 100 levels"]);
    }

    #[test]
    fn outputs_of_every_shape() {
        assert_eq!(value_with_unit("", "2*x"), (vec![0.6], "m".to_string()));
        assert_eq!(value_with_unit("", "[x, y, z]").1, "m");
        assert_eq!(value_with_unit("", "[x, theta]").1, "m, 1");
        assert_eq!(value_with_unit("", "diag(m, m, m)").1, "kg");
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
        refused(
            "output a = [[1, 2], [3]];",
            "[[1, 2], [3]]: the rows of an output have equal lengths; write several outputs",
        );
        refused(
            "output a = [world, world];",
            "[world, world]: an output is a number, vector, matrix, pose, or rows of numbers; here is a pose; write several outputs",
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
        refused(
            "for i in 0..2 { output a = x; }",
            "output a = x;: `output` cannot stand in a loop; declare an array before the loop, and use its elements in it",
        );
    }
}
