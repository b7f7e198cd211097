//! Statements, in order: local names, loops, choices. In reading order:
//!
//! - [`declare`]: parameters, coordinates, inputs, prescribed motions, constants; [`given`]: numbers with units, in SI
//!   units;
//! - [`energy`]: energies, generalized forces; [`body`]: bodies; [`gravity`]: the field that all bodies weigh in;
//! - [`point_force`]: forces at points, torques; [`constraint`]: constraints; [`output`]: outputs;
//! - [`reaction`]: joints whose wrenches are asked for, held and let go; [`drawing`]: what bodies look like.

pub(in crate::model) mod body;
pub(in crate::model) mod constraint;
pub(in crate::model) mod declare;
pub(in crate::model) mod drawing;
pub(in crate::model) mod energy;
pub(crate) mod given;
pub(in crate::model) mod gravity;
pub(in crate::model) mod output;
pub(in crate::model) mod point_force;
pub(in crate::model) mod reaction;

use crate::diagnostic::Code;
use crate::model::names::function::Home;
use crate::model::names::scope::{Binding, Origin};
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::quantity::UnitsInPlace;
use crate::model::value::{Scalar, Shape, Value, shared};
use crate::parse::syntax::{Expression, Name, Quantity, Span, Statement, StatementKind};

/// Turns that the loops of one mechanism may take, all together.
pub(in crate::model) const MAX_TURNS: usize = 100_000;

/// Blocks within blocks.
const MAX_BLOCKS: usize = 100;

impl<'d, 'g> Resolver<'d, 'g> {
    /// What names stand for, before any statement is looked at.
    pub(in crate::model) fn survey(&mut self, statements: &'d [Statement]) {
        for statement in statements {
            let (name, value) = match &statement.kind {
                StatementKind::Param(Quantity { name, value, .. })
                | StatementKind::Coord(Quantity { name, value, .. })
                | StatementKind::Input(Quantity { name, value, .. })
                | StatementKind::Prescribed(Quantity { name, value, .. })
                | StatementKind::Const(Quantity { name, value, .. }) => (name, value.as_ref()),
                StatementKind::Let { name, value, .. } => (name, Some(value)),
                StatementKind::Elements { name, .. } => (name, None),
                StatementKind::Function { name, parameters, body } => {
                    self.function(name, parameters, body);
                    continue;
                }
                StatementKind::Part { name, parameters, body } => {
                    self.part(name, parameters, body);
                    continue;
                }
                StatementKind::Instance { name, .. } => (name, None),
                StatementKind::Assign { .. }
                | StatementKind::Energy { .. }
                | StatementKind::ForceAt { .. }
                | StatementKind::TorqueOn { .. }
                | StatementKind::Gravity { .. }
                | StatementKind::Reaction { .. }
                | StatementKind::Constraint { .. }
                | StatementKind::Force { .. }
                | StatementKind::Output { .. }
                | StatementKind::Shape { .. }
                | StatementKind::For { .. }
                | StatementKind::If { .. } => continue,
            };
            self.names.definitions.entry(&name.text).or_insert(value);
        }
        self.check_circles();
    }

    /// All statements; `false` where the mechanism has outgrown its limits and the rest is not looked at.
    pub(in crate::model) fn statements(&mut self, statements: &'d [Statement]) -> bool {
        statements.iter().all(|statement| {
            // Why it was refused has been noted; the next one may be right.
            let _ = self.statement(statement);
            !self.exhausted(&statement.span) && !self.report.errors.is_full()
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
                let has_unit = self.units_in_place(value) != UnitsInPlace::None;
                let value = self.definition(name, value).ok();
                if let Some(value) = value.as_ref().filter(|_| !mutable) {
                    self.remember(&name.text, self.effort.numbers.clone(), value);
                }
                self.declare(name, origin, value)?;
                self.names.scope.note_unit(&name.text, has_unit);
                Ok(())
            }
            StatementKind::Elements { mutable, name, lengths } => self.declare_elements(name, *mutable, lengths),
            StatementKind::Assign { name, indices, value } if indices.is_empty() => self.assign(name, value),
            StatementKind::Assign { name, indices, value } => self.assign_element(name, indices, value),
            StatementKind::Energy { term, value } => self.energy(*term, value),
            StatementKind::Force { coordinate, index, value } => self.force(coordinate, index.as_ref(), value),
            StatementKind::ForceAt { point, value } => self.force_at(point, value),
            StatementKind::TorqueOn { pose, value } => self.torque_on(pose, value),
            StatementKind::Gravity { acceleration } if self.is_in_a_loop() => {
                let help = "one statement acts on all bodies, wherever they stand: move it out of the loop";
                let _ = self.argument(acceleration);
                Err(self.refuse(Code::NotHere, &statement.span, "`gravity` cannot stand in a loop", help))
            }
            StatementKind::Gravity { .. } if self.names.scope.is_in_part() => {
                Err(self.not_in_a_part("gravity", &statement.span))
            }
            // Known from the start.
            StatementKind::Part { .. } => self.outermost("part", &statement.span),
            StatementKind::Instance { part, name, index, arguments } => {
                self.instance(part, name, index.as_ref(), arguments, &statement.span)
            }
            StatementKind::Gravity { acceleration } => self.gravity(acceleration, &statement.span),
            StatementKind::Reaction { docs, name, index, pose, element } => {
                self.reaction(docs, &self.path(name), index.as_ref(), pose, element)
            }
            StatementKind::Constraint { docs, name, index, left, right } => {
                self.constraint(docs, &self.path(name), index.as_ref(), left, right)
            }
            StatementKind::Output { docs, name, index, value, jacobian_rate } => {
                self.output(docs, &self.path(name), index.as_ref(), value, jacobian_rate.as_ref())
            }
            StatementKind::Shape { pose, kind, file, sizes } => {
                self.shape(pose, kind, file.as_deref(), sizes, &statement.span)
            }
            StatementKind::For { variable, start, end, body } => self.repeat(variable, start, end, body),
            StatementKind::If { branches, otherwise } => self.choose(branches, otherwise),
        }
    }

    fn outermost(&mut self, keyword: &str, span: &Span) -> Resolved<()> {
        if self.names.scope.is_outermost() {
            return Ok(());
        }
        if self.names.scope.is_in_part() {
            return Err(self.not_in_a_part(keyword, span));
        }
        let (block, help) = match (self.is_in_a_loop(), keyword) {
            (true, "part") => ("a loop", "parts are the mechanism's own: move it out of the loop"),
            (false, "part") => ("an `if`", "parts are the mechanism's own: move it before the `if`"),
            (true, "fn") => ("a loop", "functions are the mechanism's own: move it out of the loop"),
            (true, _) => ("a loop", "declare an array before the loop, and use its elements in it"),
            (false, "fn") => ("an `if`", "functions are the mechanism's own: move it before the `if`"),
            (false, _) => {
                ("an `if`", "declare it before the `if`; how many there are may depend on a constant: `q[n]`")
            }
        };
        Err(self.refuse(Code::NotHere, span, format!("`{keyword}` cannot stand in {block}"), help))
    }

    /// The value that a name is given, by an expression that must not come back to the name.
    pub(in crate::model) fn definition(&mut self, name: &'d Name, value: &Expression) -> Resolved<Value<'g>> {
        self.names.defining = self.names.scope.is_outermost().then_some(name.text.as_str());
        let value = self.expression(value);
        self.names.defining = None;
        value
    }

    /// Gives a name its meaning in the innermost block; `None` where its declaration was wrong.
    pub(in crate::model) fn declare(&mut self, name: &Name, origin: Origin, value: Option<Value<'g>>) -> Resolved<()> {
        let (text, span) = (&name.text, name.span.clone());
        if let Some(value) = &value {
            self.note_meaning(&span, value);
        }
        if crate::model::value::builtin::CONSTANTS.contains(&text.as_str()) {
            return Err(self.refuse(Code::BuiltIn, &span, format!("`{text}` is built in"), "choose another name"));
        }
        let function = self
            .names
            .functions
            .get(text.as_str())
            .filter(|f| f.home != Home::Library && self.names.scope.is_outermost());
        if let Some(first) = function.map(|f| f.place()) {
            // What is made of it is given up without a word.
            let _ = self.names.scope.declare(text, Binding::new(origin, None, span.clone()));
            let (message, help) = (format!("`{text}` is already a function"), "choose another name".to_string());
            return Err(self.refuse_twice(&span, message, help, first));
        }
        match self.names.scope.declare(text, Binding::new(origin, value, span.clone())) {
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
                match self.names.scope.get(text).map(|binding| binding.span.clone()) {
                    Some(first) if self.names.scope.is_outermost() => {
                        Err(self.refuse_twice(&span, message, help, first))
                    }
                    _ => Err(self.refuse(Code::DeclaredTwice, &span, message, help)),
                }
            }
        }
    }

    fn assign(&mut self, name: &'d Name, value: &Expression) -> Resolved<()> {
        let has_unit = self.units_in_place(value) != UnitsInPlace::None;
        let value = self.argument(value);
        let Some(binding) = self.names.scope.get(&name.text) else {
            let message = format!("`{}` is not declared", name.text);
            let help = match name.text.as_str() {
                // As a name it would have no weight.
                "gravity" => "write `gravity [0, 0, -g];` for the field that all bodies weigh in".to_string(),
                text => format!("write `let {text} = …;`"),
            };
            return Err(self.refuse(Code::Undeclared, &name.span, message, help));
        };
        if binding.elements.is_some() {
            let message = format!("the elements of `{}` are given their values one by one", name.text);
            return Err(self.refuse(Code::NoElements, &name.span, message, format!("write `{}[i] = …;`", name.text)));
        }
        if binding.origin != Origin::Mutable {
            let message = format!("`{}` is {}: it keeps its value", name.text, binding.origin.described());
            return Err(self.refuse(
                Code::KeepsItsValue,
                &name.span,
                message,
                "only what is declared by `let mut` takes a new one",
            ));
        }
        if let (Some(old), Ok(new)) = (binding.value.clone(), &value) {
            self.check_assignment(&name.text, old, new)?;
        }
        if let Some(binding) = self.names.scope.get_mut(&name.text) {
            binding.value = value.ok().map(|argument| argument.value);
            (binding.used, binding.has_unit) = (None, has_unit);
        }
        Ok(())
    }

    /// A name keeps its shape, and a number its dimension.
    pub(in crate::model) fn check_assignment(
        &mut self,
        name: &str,
        old: Value<'g>,
        new: &Argument<'g>,
    ) -> Resolved<()> {
        if old.shape() != new.value.shape() {
            let message = format!("`{name}` is {}, this is {}", old.described(), new.value.described());
            return Err(self.refuse(Code::OtherKind, &new.span, message, "use another name for it"));
        }
        if old.shape() == Shape::Number {
            let old = self.scalar(&Argument { value: old, span: new.span.clone() })?;
            let found = self.scalar(new)?;
            if shared(old.fit(), found.fit()).is_none() {
                let message = format!("`{name}` is {}, this is {}", old.dimension, found.dimension);
                return Err(self.refuse(Code::OtherKind, &new.span, message, "use another name for it"));
            }
        }
        Ok(())
    }
}

// ---- loops and choices

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn is_in_a_loop(&self) -> bool {
        self.effort.loops > 0
    }

    /// The statements behind the first condition that holds.
    fn choose(&mut self, branches: &'d [(Expression, Vec<Statement>)], otherwise: &'d [Statement]) -> Resolved<()> {
        let mut chosen = otherwise;
        for (condition, body) in branches {
            match self.decided(condition) {
                Ok(true) => {
                    chosen = body;
                    break;
                }
                Ok(false) => {}
                Err(Refused) => {
                    self.report.gave_up = true;
                    return Err(Refused);
                }
            }
        }
        let place = branches.first().map_or(0..0, |(condition, _)| condition.span.clone());
        self.names.scope.enter();
        let complete = self.block(chosen, &place);
        self.names.scope.leave();
        if complete { Ok(()) } else { Err(Refused) }
    }

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
            self.effort.turns += 1;
            if self.effort.turns > MAX_TURNS {
                let message = format!("the loops of this mechanism take more than {MAX_TURNS} turns");
                return Err(self.refuse(
                    Code::TooMuch,
                    &(start.span.start..end.span.end),
                    message,
                    "is the range meant to be so long?",
                ));
            }
            // What is wrong in one turn is wrong in the next.
            if !self.turn(variable, number, body) {
                self.report.gave_up = true;
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
        let errors = self.report.errors.error_count();
        self.names.scope.enter();
        let value = Value::Scalar(Scalar::plain(self.graph.integer(number)));
        let declared = self.declare(variable, Origin::Loop, Some(value)).is_ok();
        self.effort.loops += 1;
        self.effort.numbers.push(number);
        let complete = declared && self.block(body, &variable.span);
        self.effort.loops -= 1;
        self.effort.numbers.pop();
        self.names.scope.leave();
        complete && self.report.errors.error_count() == errors
    }

    /// The statements of a block that has been opened; whether all were looked at.
    fn block(&mut self, body: &'d [Statement], place: &Span) -> bool {
        self.effort.depth_of_blocks += 1;
        let complete = if self.effort.depth_of_blocks > MAX_BLOCKS {
            self.refuse(
                Code::TooDeep,
                place,
                format!("loops and `if` are nested deeper than {MAX_BLOCKS} levels"),
                "each `for` and each `if` is a level",
            );
            false
        } else {
            self.statements(body)
        };
        self.effort.depth_of_blocks -= 1;
        complete
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{near, refusals, refused, value};

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
            "gravity = [0, 0, -9.81 m/s^2];",
            "gravity: `gravity` is not declared; write `gravity [0, 0, -g];` for the field that all bodies weigh in",
        );
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
        assert_eq!(
            refusals(&nested),
            ["i: loops and `if` are nested deeper than 100 levels; each `for` and each `if` is a level"]
        );
    }
}
