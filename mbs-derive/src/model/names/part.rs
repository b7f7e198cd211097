//! Parts: `part link(m, pose) { … }` once, `link arm(m, pose);` many times.
//!
//! A use gives the body a scope of its own, in which the arguments are values of any shape, and goes through its
//! statements there. What it names becomes the part's own by a path: the output `tip` of `arm` is `arm_tip`, that of
//! `leg[1]` is `leg_1_tip`. What it declares can be asked for as `arm.tip`.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use crate::diagnostic::{Code, nearest};
use crate::model::names::function::{Call, Home};
use crate::model::names::scope::{Binding, Origin};
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::{Array, Instance, Value};
use crate::parse::syntax::{Expression, Name, Span, Statement};

/// Parts that one mechanism may have: parts of parts double with each level.
pub(in crate::model) const MAX_PARTS: usize = 10_000;

/// Parts within parts, and loops.
const MAX_DEPTH: usize = 100;

/// One part.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) struct Part<'d> {
    name: &'d Name,
    parameters: &'d [Name],
    body: &'d [Statement],
    home: Home,
}

/// The parts that there are, and those that are being built.
#[derive(Debug, Default)]
pub(in crate::model) struct Parts<'d, 'g> {
    known: BTreeMap<&'d str, Part<'d>>,
    used: BTreeSet<&'d str>,
    built: usize,
    open: Vec<Open<'g>>,
}

/// A part that is being built.
#[derive(Debug)]
struct Open<'g> {
    /// `leg_1_`: what its names begin with.
    prefix: String,
    /// Its outputs so far.
    outputs: BTreeMap<String, Value<'g>>,
}

impl Part<'_> {
    /// As it is used; for messages.
    fn form(&self) -> String {
        let names: Vec<&str> = self.parameters.iter().map(|parameter| parameter.text.as_str()).collect();
        format!("{} name({});", self.name.text, names.join(", "))
    }
}

// ---- declarations

impl<'d, 'g> Resolver<'d, 'g> {
    pub(in crate::model) fn part(&mut self, name: &'d Name, parameters: &'d [Name], body: &'d [Statement]) {
        for (i, parameter) in parameters.iter().enumerate() {
            if parameters[..i].iter().any(|other| other.text == parameter.text) {
                let message = format!("`{}` has two arguments called `{}`", name.text, parameter.text);
                self.refuse(Code::ArgumentsAlike, &parameter.span, message, "choose another name");
            }
        }
        let part = Part { name, parameters, body, home: self.home() };
        if let Some(first) = self.names.parts.known.get(name.text.as_str()).map(|known| known.name.span.clone()) {
            let message = format!("`{}` is already a part", name.text);
            self.refuse_twice(&name.span, message, "choose another name".to_string(), first);
            return;
        }
        self.names.parts.known.insert(&name.text, part);
    }

    /// What is wrong in a part is found where it is used.
    pub(in crate::model) fn check_parts(&mut self) {
        let parts = &self.names.parts;
        let unused = parts.known.values().filter(|p| p.home == Home::Mechanism && !parts.used.contains(&*p.name.text));
        let unused: Vec<&'d Name> = unused.map(|part| part.name).collect();
        for name in unused {
            let warning = self.report.errors.warning(
                Code::Unused,
                name.span.clone(),
                format!("the part `{}` is never used", name.text),
            );
            warning.help("so it has not been checked");
        }
    }

    /// A declaration that belongs to the mechanism.
    pub(in crate::model) fn not_in_a_part(&mut self, keyword: &str, span: &Span) -> Refused {
        let help = match keyword {
            "gravity" => "one statement acts on all bodies, those of parts too: move it to the mechanism",
            "fn" | "part" => "move it to where the part itself is declared",
            _ => "declare it in the mechanism, and give it to the part as an argument",
        };
        self.refuse(Code::NotHere, span, format!("`{keyword}` cannot stand in a part"), help)
    }
}

// ---- uses

impl<'d, 'g> Resolver<'d, 'g> {
    /// `link arm(m, pose);`, `link leg[i](m, pose);`
    pub(in crate::model) fn instance(
        &mut self,
        part: &'d Name,
        name: &Name,
        index: Option<&Expression>,
        arguments: &[Expression],
        span: &Span,
    ) -> Resolved<()> {
        let found = self.part_in_sight(part);
        let index = index.map(|index| self.argument(index)).transpose();
        let arguments = self.arguments(arguments);
        let number = match index.and_then(|index| self.next_number(name, index)) {
            Ok(number) => number,
            Err(Refused) => return Err(Refused),
        };
        let instance = match (found, arguments) {
            (Ok(found), Ok(arguments)) => self.built(found, part, name, number, arguments, span),
            _ => Err(Refused),
        };
        self.declare_instance(name, number, instance.ok());
        Ok(())
    }

    fn part_in_sight(&mut self, name: &Name) -> Resolved<Part<'d>> {
        let home = self.home();
        let in_sight = |part: &&Part<'d>| home == Home::Mechanism || part.home == home;
        if let Some(found) = self.names.parts.known.get(name.text.as_str()).filter(in_sight) {
            return Ok(*found);
        }
        let known = self.names.parts.known.values().filter(in_sight).map(|part| part.name.text.as_str());
        let help = match nearest(&name.text, known) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("declare it: `part {}(m, pose) {{ … }}`", name.text),
        };
        Err(self.refuse(Code::UnknownPart, &name.span, format!("there is no part `{}`", name.text), help))
    }

    /// The number of the instance, where it has an index; names and indices stand for one instance each.
    fn next_number(&mut self, name: &Name, index: Option<Argument<'g>>) -> Resolved<Option<usize>> {
        let in_loop = self.is_in_a_loop();
        let known =
            self.names.scope.in_body(&name.text).map(|known| (known.origin, known.span.clone(), known.value.clone()));
        let built = match (&known, &index) {
            (None, _) => 0,
            (Some((Origin::Part, _, Some(Value::Array(array)))), Some(_)) => array.values().len(),
            (Some((Origin::Part, _, None)), Some(_)) => return Err(Refused),
            (Some((Origin::Part, ..)), None) if in_loop => {
                let message = format!("each turn of the loop builds a part `{}`", name.text);
                return Err(self.refuse(
                    Code::IndexInALoop,
                    &name.span,
                    message,
                    format!("give it an index: `{}[i]`", name.text),
                ));
            }
            (Some((origin, first, _)), _) => {
                let message = format!("`{}` is already {}", name.text, origin.described());
                let (help, first) = ("choose another name".to_string(), first.clone());
                return Err(self.refuse_twice(&name.span, message, help, first));
            }
        };
        let Some(index) = index else { return Ok(None) };
        let number = self.integer(&index, "an index")?;
        if usize::try_from(number) != Ok(built) {
            let message = format!("the next part of `{}` is number {built}, this is {number}", name.text);
            return Err(self.refuse(
                Code::IndexWithGaps,
                &index.span,
                message,
                "indices run from 0 on, one after the other",
            ));
        }
        Ok(Some(built))
    }

    fn built(
        &mut self,
        found: Part<'d>,
        part: &'d Name,
        name: &Name,
        number: Option<usize>,
        arguments: Vec<Argument<'g>>,
        span: &Span,
    ) -> Resolved<Instance<'g>> {
        self.names.parts.used.insert(&found.name.text);
        self.check_use_of(found, part, arguments.len(), span)?;
        let own = number.map_or(format!("{}_", name.text), |i| format!("{}_{i}_", name.text));
        let prefix = format!("{}{own}", self.prefix());
        self.names.scope.enter_part(found.home != Home::Mechanism);
        for (parameter, argument) in found.parameters.iter().zip(arguments) {
            let binding = Binding::new(Origin::Argument, Some(argument.value), parameter.span.clone());
            // Two of one name have been reported.
            let _ = self.names.scope.declare(&parameter.text, binding);
        }
        self.report.calls.push(Call { name: part.text.clone(), span: span.clone(), home: found.home, is_part: true });
        self.names.parts.open.push(Open { prefix, outputs: BTreeMap::new() });
        self.effort.depth_of_blocks += 1;
        let loops = std::mem::take(&mut self.effort.loops);
        let errors = self.report.errors.error_count();
        let complete = self.statements(found.body);
        let is_whole = self.report.errors.error_count() == errors;
        self.effort.loops = loops;
        self.effort.depth_of_blocks -= 1;
        let given = self.names.parts.open.pop().map(|open| open.outputs).unwrap_or_default();
        let instance = Instance { is_whole, ..self.finished(part, given) };
        self.report.calls.pop();
        self.names.scope.leave();
        if complete { Ok(instance) } else { Err(Refused) }
    }

    fn check_use_of(&mut self, found: Part<'d>, part: &Name, given: usize, span: &Span) -> Resolved<()> {
        let wanted = found.parameters.len();
        if wanted != given {
            let noun = if wanted == 1 { "argument" } else { "arguments" };
            let verb = if given == 1 { "is" } else { "are" };
            let message = format!("the part `{}` takes {wanted} {noun}, {given} {verb} given", part.text);
            return Err(self.refuse(Code::ArgumentCount, &part.span, message, format!("write `{}`", found.form())));
        }
        let same = |call: &&Call| call.is_part && call.name == part.text;
        if self.report.calls.iter().any(|call| same(&call)) {
            let path: Vec<&str> =
                self.report.calls.iter().filter(|call| call.is_part).map(|call| call.name.as_str()).collect();
            let message = format!("the part `{}` is built of itself: {} → {}", part.text, path.join(" → "), part.text);
            return Err(self.refuse(Code::Recursion, span, message, "repeat with a `for` loop"));
        }
        self.names.parts.built += 1;
        if self.names.parts.built > MAX_PARTS {
            let message = format!("this mechanism has more than {MAX_PARTS} parts");
            return Err(self.refuse(Code::TooMuch, span, message, "do parts or loops repeat more than was meant?"));
        }
        if self.effort.depth_of_blocks >= MAX_DEPTH {
            let message = format!("parts and loops are nested deeper than {MAX_DEPTH} levels");
            return Err(self.refuse(Code::TooDeep, span, message, ""));
        }
        Ok(())
    }

    /// What a part gives: its outputs, and what its body declares.
    fn finished(&mut self, part: &Name, outputs: BTreeMap<String, Value<'g>>) -> Instance<'g> {
        let mut values: BTreeMap<_, _> = outputs.into_iter().map(|(name, value)| (name, Some(value))).collect();
        let mut twofold = Vec::new();
        for (name, binding) in self.names.scope.innermost() {
            if matches!(binding.origin, Origin::Local | Origin::Mutable | Origin::Constant | Origin::Part) {
                let value = match &binding.elements {
                    Some(elements) => elements.whole(),
                    None => binding.value.clone(),
                };
                match values.insert(name.clone(), value.clone()) {
                    Some(output) if value.is_some() && output != value => {
                        twofold.push((name.clone(), binding.origin, binding.span.clone()));
                    }
                    _ => {}
                }
            }
        }
        for (name, origin, span) in twofold {
            let message = format!("`{name}` is {} and an output of another value", origin.described());
            let help = format!("outside both would be `part.{name}`: choose another name");
            self.refuse(Code::NameClash, &span, message, help);
        }
        Instance { part: part.text.clone(), values, is_whole: true }
    }

    fn declare_instance(&mut self, name: &Name, number: Option<usize>, instance: Option<Instance<'g>>) {
        let instance = instance.map(|instance| Value::Part(Rc::new(instance)));
        if let Some(instance) = &instance {
            self.note_meaning(&name.span, instance);
        }
        let known = self.names.scope.in_body(&name.text).and_then(|known| match known.value.take() {
            Some(Value::Array(array)) => Some(array),
            _ => None,
        });
        let value = match (number, instance) {
            (None, instance) => instance,
            (Some(_), Some(instance)) => {
                let array =
                    known.map_or_else(|| Array::new(vec![instance.clone()]), |array| array.with(instance.clone()));
                array.map(Value::Array)
            }
            (Some(_), None) => None,
        };
        self.names.scope.declare_in_body(&name.text, Binding::new(Origin::Part, value, name.span.clone()));
    }
}

// ---- names and values

impl<'g> Resolver<'_, 'g> {
    /// What the names of the part that is being built begin with; nothing in the mechanism itself.
    fn prefix(&self) -> &str {
        self.names.parts.open.last().map_or("", |open| &open.prefix)
    }

    /// A name with the path of the part that it stands in.
    pub(in crate::model) fn path(&self, name: &Name) -> Name {
        Name { text: format!("{}{}", self.prefix(), name.text), span: name.span.clone() }
    }

    /// Notes an output of the part that is being built.
    pub(in crate::model) fn give(&mut self, path: &Name, value: &Value<'g>) {
        if let Some(open) = self.names.parts.open.last_mut()
            && let Some(name) = path.text.strip_prefix(&open.prefix)
        {
            open.outputs.insert(name.to_string(), value.clone());
        }
    }

    /// `arm.tip`
    pub(in crate::model) fn value_of_part(&mut self, instance: &Instance<'g>, field: &Name) -> Resolved<Value<'g>> {
        if let Some(value) = instance.values.get(&field.text) {
            return value.clone().ok_or(Refused);
        }
        if !instance.is_whole {
            // It may be what has been refused.
            return Err(Refused);
        }
        let names = instance.values.keys().map(String::as_str);
        let help = match nearest(&field.text, names.clone()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None if instance.values.is_empty() => "it declares no `let` and no `output`".to_string(),
            None => format!("it has {}", names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")),
        };
        Err(self.refuse(
            Code::NoComponent,
            &field.span,
            format!("a part `{}` has no `{}`", instance.part, field.text),
            help,
        ))
    }

    /// A part where something else is wanted.
    pub(in crate::model) fn no_value_of_a_part(&mut self, part: &Argument<'g>) -> Refused {
        let name = match &part.value {
            Value::Part(instance) => instance.values.keys().next().cloned(),
            _ => None,
        };
        let help = format!("name what is meant of it: `{}`", name.map_or("part.name".into(), |n| format!("part.{n}")));
        self.refuse(Code::NotAValue, &part.span, "this is a part", help)
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, near, refusals, refused, same, value, values};

    const LINK: &str = "part link(m, l, pose) { \
                        let end = pose*translation([0, 0, -l]); kinetic += particle(m, end.origin()); \
                        potential += m*k/m*l*end.origin().z; output tip = end.origin(); }";

    #[test]
    fn a_part_is_its_statements() {
        let parts = format!("{LINK} link upper(m, l, rot_y(theta)); link lower(2*m, l, upper.end*rot_y(q[0]));");
        let by_hand = "let a = rot_y(theta)*translation([0, 0, -l]); let b = a*rot_y(q[0])*translation([0, 0, -l]); \
                       kinetic += particle(m, a.origin()); potential += m*k/m*l*a.origin().z; output upper_tip = a.origin(); \
                       kinetic += particle(2*m, b.origin()); potential += 2*m*k/(2*m)*l*b.origin().z; output lower_tip = b.origin();";
        let all = |statements: &str| {
            mechanism(statements, |lagrangian| {
                let names: Vec<String> = lagrangian.outputs.iter().map(|o| o.name.clone()).collect();
                let energies: Vec<f64> =
                    [&lagrangian.kinetic, &lagrangian.potential].into_iter().flat_map(|e| values(e)).collect();
                (names, energies, lagrangian.bodies().0.len())
            })
        };
        let ((names, energies, bodies), (names_by_hand, energies_by_hand, bodies_by_hand)) =
            (all(&parts), all(by_hand));
        assert_eq!((names, bodies), (names_by_hand, bodies_by_hand));
        near(&energies, &energies_by_hand, "energies");
        same(LINK, "[1, 2, 3].norm_squared()", "14");
    }

    #[test]
    fn parts_in_loops_have_an_index() {
        let chain = "part link(l, pose) { let end = pose*translation([0, 0, -l]); output tip = end.origin(); \
                     const half = 1/2; } \
                     let mut at = world; for i in 0..3 { link chain[i](l, at*rot_y(i*theta)); at = chain[i].end; }";
        same(chain, "chain[2].tip", "at.origin()");
        same(chain, "chain[1].half*x", "x/2");
        mechanism(chain, |lagrangian| {
            let names: Vec<&str> = lagrangian.outputs.iter().map(|o| o.name.as_str()).collect();
            assert_eq!(names, ["chain_0_tip", "chain_1_tip", "chain_2_tip"]);
        });
        refused(
            "part p(a) { let b = a; } for i in 0..2 { p c[2*i](x); }",
            "2*i: the next part of `c` is number 1, this is 2; indices run from 0 on, one after the other",
        );
        refused(
            "part p(a) { let b = a; } for i in 0..2 { p c(x); }",
            "c: each turn of the loop builds a part `c`; give it an index: `c[i]`",
        );
    }

    #[test]
    fn parts_are_made_of_parts() {
        let nested = "part wheel(r, pose) { output rim = pose.point([r, 0, 0]); } \
                      part axle(pose) { wheel left(l, pose); wheel right(2*l, pose*rot_z(theta)); \
                      for i in 0..2 { wheel spare[i](i*l, pose); } } axle front(translation([x, 0, 0]));";
        same(nested, "front.right.rim", "[x + 2*l*cos(theta), 2*l*sin(theta), 0]");
        same(nested, "front.spare[1].rim.x", "x + l");
        mechanism(nested, |lagrangian| {
            let names: Vec<&str> = lagrangian.outputs.iter().map(|o| o.name.as_str()).collect();
            assert_eq!(names, ["front_left_rim", "front_right_rim", "front_spare_0_rim", "front_spare_1_rim"]);
        });
        refused(
            "part a(y) { b inner(y); } part b(y) { a inner(y); } a top(x);",
            "a inner(y);: the part `a` is built of itself: a → b → a; repeat with a `for` loop",
        );
        let doubling: String =
            (1..20).map(|i| format!("part p{i}(y) {{ p{} a(y); p{} b(y); }} ", i - 1, i - 1)).collect();
        let all = refusals(&format!("part p0(y) {{ let z = y; }} {doubling} p19 top(x);"));
        assert!(all.iter().any(|m| m.contains("this mechanism has more than 10000 parts")), "{all:?}");
    }

    #[test]
    fn names_stay_in_their_part() {
        near(
            &value(
                "let end = 1; part p(x) { let end = 2*x; let mut sum = 0; for i in 0..3 { sum = sum + end; } } p one(5);",
                "end + one.sum",
            ),
            &[31.0],
            "a name of the part is another than that of the mechanism",
        );
        // A part sees parameters and coordinates, not `let` names.
        same("part p(a) { let b = a*l + x; } p one(2);", "one.b", "2*l + x");
        refused(
            "let own = 1; part p(a) { let b = a*own; } p one(2);",
            "own: `own` is a `let`: a part does not see it; give it to the part as an argument; coordinates, parameters, inputs and constants it sees",
        );
        refused(
            "part p(a) { let b = a; } p one(2); let c = b;",
            "b: `b` is not declared; declare it: `param b: m = …;` or `let b = …;`",
        );
        // An output of the same name has the same value.
        same("part p(a) { let b = 2*a; output b = b; const c = 3; output c = 3; } p one(x);", "one.b*one.c", "6*x");
        refused(
            "part p(a) { output b = 2*a; let b = a; } p one(x); p two(y);",
            "b: `b` is a `let` and an output of another value; outside both would be `part.b`: choose another name",
        );
        // A name of its own may be what a statement begins with.
        let named = "part link(part) { let gravity = 2*part; } link part(x); let mut gravity = 1; gravity = 3;";
        same(named, "gravity*part.gravity", "6*x");
    }

    #[test]
    fn forces_and_reactions_of_parts() {
        mechanism(
            "part motor(angle, c) { force angle += -c*dt(angle); } const c: N*m*s = 2; motor a(theta, c); motor b(q[1], c);",
            |l| {
                let targets: Vec<usize> = l.forces[1..].iter().map(|(number, _)| *number).collect();
                assert_eq!(targets, [3, 5]);
            },
        );
        refused(
            "part motor(angle, c) { force angle += -c*dt(angle); } const c: N*m*s = 2; motor a(2*theta, c);",
            "angle: `angle` is no coordinate here; a force acts on a coordinate: give the part one, or write `force at` and `torque on`",
        );
        let link = "part link(m, pose) { let joint = pose*rot_y(theta); reaction hinge at joint; \
                    kinetic += particle(m, joint.point([l, 0, 0])); constraint level: joint.point([l, 0, 0]).z = x; }";
        mechanism(&format!("{link} for i in 0..2 {{ link a[i](m, translation([0, 0, y + i*z])); }}"), |lagrangian| {
            let names: Vec<&str> = lagrangian.reactions.iter().map(|r| r.name.as_str()).collect();
            assert_eq!(names, ["a_0_hinge", "a_1_hinge"]);
            assert_eq!(lagrangian.constraints[1].name, "a_1_level");
            assert!(lagrangian.released.is_some());
        });
        refused(
            "part p(pose) { let a = pose*rot_y(theta); let b = a.origin(); reaction r at a; } p one(world);",
            "a: something was built on `a` before this reaction: it would not count; move the statement up, right behind \
             the one that gives `a` its value",
        );
    }

    #[test]
    fn wrong_parts() {
        refused("part p(a) { let b = a; }", "p: the part `p` is never used; so it has not been checked");
        refused("part ball(a) { let b = a; } bal one(x);", "bal: there is no part `bal`; did you mean `ball`?");
        refused(
            "part p(a, b) { let c = a*b; } p one(x);",
            "p: the part `p` takes 2 arguments, 1 is given; write `p name(a, b);`",
        );
        refused(
            "part p(a) { param m2: kg = 1; } p one(x);",
            "param m2: kg = 1;: `param` cannot stand in a part; declare it in the mechanism, and give it to the part as an argument",
        );
        refused("part p(a) { let b = a; } p one(x); let c = one.d;", "d: a part `p` has no `d`; it has `b`");
        refused(
            "part p(a) { let b = a; } p one(x); let c = one + 1;",
            "one: this is a part; name what is meant of it: `part.b`",
        );
        refused("part p(a) { let b = a; } p one(x); p one(y);", "one: `one` is already a part; choose another name");
        refused(
            "part p(a) { let b = a; } p one(x); output o = one;",
            "one: this is a part; name what is meant of it: `part.b`",
        );
        // What is wrong in a part is shown there, with its use.
        let text = "mechanism A { param m: kg = -1; coord x: m; part ball(m, r) { kinetic += particle(m, r); } \
                    ball one(2*m, [x, 0, 0]); ball two(-m, [2*x, 0, 0]); }";
        let report = crate::generate("a", text, &Default::default()).unwrap_err().render("a", text);
        assert!(
            report.contains("a mass is not negative") && report.contains("in this use of the part `ball`"),
            "{report}"
        );
    }
}
