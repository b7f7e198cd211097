//! Functions written in the language: those of the mechanism, and those of the library.
//!
//! A call gives the body a scope of its own, in which the arguments are values of any shape and dimension, and
//! evaluates it: a function is as polymorphic as its body.

use std::collections::BTreeSet;

use crate::diagnostic::Code;
use crate::model::names::scope::{Binding, Origin};
use crate::model::value::Value;
use crate::model::value::builtin;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::parse;
use crate::parse::syntax::{Declaration, Expression, ExpressionKind, Name, Span, Statement, StatementKind};

/// Calls that one mechanism may make: `f(f(x)) + f(f(x))` doubles them at each level.
pub(in crate::model) const MAX_CALLS: usize = 100_000;

/// Whose text a function stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) enum Home {
    Library,
    /// An imported file.
    Import,
    Mechanism,
}

/// One function.
#[derive(Clone, Copy, Debug)]
pub(in crate::model) struct Function<'d> {
    name: &'d Name,
    parameters: &'d [Name],
    body: &'d Expression,
    pub(in crate::model) home: Home,
    /// It calls itself, which has been reported.
    circular: bool,
}

/// A call that is being made.
#[derive(Clone, Debug)]
pub(in crate::model) struct Call {
    pub(in crate::model) name: String,
    pub(in crate::model) span: Span,
    pub(in crate::model) home: Home,
    /// Whether it is a part that is being built.
    pub(in crate::model) is_part: bool,
}

impl Call {
    /// For a note at its place.
    pub(in crate::model) fn described(&self) -> String {
        match self.is_part {
            true => format!("in this use of the part `{}`", self.name),
            false => format!("in this call of `{}`", self.name),
        }
    }
}

impl Function<'_> {
    /// Where it is declared.
    pub(in crate::model) fn place(&self) -> Span {
        self.name.span.clone()
    }

    /// As it is called; for messages.
    pub(in crate::model) fn form(&self) -> String {
        let names: Vec<&str> = self.parameters.iter().map(|parameter| parameter.text.as_str()).collect();
        format!("{}({})", self.name.text, names.join(", "))
    }
}

/// The functions that every mechanism may call.
pub(in crate::model) fn library() -> Declaration {
    parse::declaration(include_str!("library.mbs")).expect("the library is well-formed")
}

// ---- declarations

impl<'d, 'g> Resolver<'d, 'g> {
    /// The library's functions.
    pub(in crate::model) fn provide(&mut self, statements: &'d [Statement]) {
        for statement in statements {
            if let StatementKind::Function { name, parameters, body } = &statement.kind {
                let function = Function { name, parameters, body, home: Home::Library, circular: false };
                self.names.functions.insert(&name.text, function);
            }
        }
    }

    /// A function of the mechanism or of an imported file; it may take the name of one of the library.
    pub(in crate::model) fn function(&mut self, name: &'d Name, parameters: &'d [Name], body: &'d Expression) {
        if builtin::form_of_function(&name.text).is_some() && !builtin::REPLACEABLE.contains(&name.text.as_str()) {
            self.refuse(
                Code::BuiltIn,
                &name.span,
                format!("the function `{}` is built in", name.text),
                "choose another name",
            );
            return;
        }
        for (i, parameter) in parameters.iter().enumerate() {
            if parameters[..i].iter().any(|other| other.text == parameter.text) {
                let message = format!("`{}` has two arguments called `{}`", name.text, parameter.text);
                self.refuse(Code::ArgumentsAlike, &parameter.span, message, "choose another name");
            }
        }
        let own = self.names.functions.get(name.text.as_str()).filter(|known| known.home != Home::Library);
        let own = own.map(|known| (known.name.span.clone(), "a function"));
        let imported = self.names.scope.get(&name.text).map(|known| (known.span.clone(), known.origin.described()));
        if let Some((first, what)) = own.or(imported) {
            let message = format!("`{}` is already {what}", name.text);
            self.refuse_twice(&name.span, message, "choose another name".to_string(), first);
            return;
        }
        let home = self.home();
        self.names.functions.insert(&name.text, Function { name, parameters, body, home, circular: false });
    }

    /// A function that calls itself, directly or through others, has no value.
    pub(in crate::model) fn check_circles(&mut self) {
        let names: Vec<&'d str> = self.names.functions.keys().copied().collect();
        for name in names {
            if self.names.functions[name].circular {
                continue;
            }
            let Some(circle) = self.circle(name) else { continue };
            for member in &circle {
                if let Some(function) = self.names.functions.get_mut(member) {
                    function.circular = true;
                }
            }
            let message = format!("`{name}` calls itself: {} → {name}", circle.join(" → "));
            let place = self.names.functions[name].name.span.clone();
            self.refuse(
                Code::Recursion,
                &place,
                message,
                "a function is a formula: repeat with a `for` loop and a `let mut`",
            );
        }
    }

    /// From a function through those that it calls back to it.
    fn circle(&self, start: &'d str) -> Option<Vec<&'d str>> {
        // One path at a time; what has been tried leads nowhere.
        let (mut path, mut tried) = (vec![(start, self.callees(start))], BTreeSet::new());
        while let Some((_, callees)) = path.last_mut() {
            match callees.pop() {
                Some(next) if next == start => return Some(path.into_iter().map(|(name, _)| name).collect()),
                Some(next) if tried.insert(next) => path.push((next, self.callees(next))),
                Some(_) => {}
                None => drop(path.pop()),
            }
        }
        None
    }

    /// The functions of the same home that a function calls, the last one first: those of other homes do not call back.
    fn callees(&self, name: &str) -> Vec<&'d str> {
        let Some(caller) = self.names.functions.get(name) else { return Vec::new() };
        let called = |part: &'d Expression| match &part.kind {
            ExpressionKind::Call(name, _) => {
                let found = self.names.functions.get_key_value(name.text.as_str());
                found.filter(|(_, function)| function.home == caller.home).map(|(name, _)| *name)
            }
            _ => None,
        };
        caller.body.parts().filter_map(called).collect()
    }

    /// What is wrong in a function is found where it is called: one that never is may be wrong in any way.
    pub(in crate::model) fn check_calls(&mut self) {
        let unused = |function: &&Function<'d>| {
            function.home == Home::Mechanism && !self.names.called.contains(function.name.text.as_str())
        };
        let unused: Vec<&'d Name> =
            self.names.functions.values().filter(unused).map(|function| function.name).collect();
        for name in unused {
            let warning =
                self.report.errors.warning(Code::Unused, name.span.clone(), format!("`{}` is never called", name.text));
            warning.help("so it has not been checked");
        }
    }
}

// ---- calls

impl<'d, 'g> Resolver<'d, 'g> {
    /// The value of `name(arguments)`.
    #[inline(never)]
    pub(in crate::model) fn value_of_function(
        &mut self,
        function: Function<'d>,
        name: &Name,
        arguments: Resolved<Vec<Argument<'g>>>,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        if function.home == Home::Mechanism {
            self.names.called.insert(&function.name.text);
        }
        let arguments = arguments?;
        if function.circular {
            return Err(Refused);
        }
        let (wanted, found) = (function.parameters.len(), arguments.len());
        if wanted != found {
            let message = format!(
                "`{}` takes {wanted} {}, {found} {} given",
                name.text,
                if wanted == 1 { "argument" } else { "arguments" },
                if found == 1 { "is" } else { "are" }
            );
            return Err(self.refuse(Code::ArgumentCount, &name.span, message, format!("write `{}`", function.form())));
        }
        self.effort.calls_so_far += 1;
        if self.effort.calls_so_far > MAX_CALLS {
            let message = format!("the functions of this mechanism are called more than {MAX_CALLS} times");
            return Err(self.refuse(Code::TooMuch, span, message, "name values that are used twice with `let`"));
        }
        self.body(function, arguments, span)
    }

    fn body(&mut self, function: Function<'d>, arguments: Vec<Argument<'g>>, span: &Span) -> Resolved<Value<'g>> {
        match function.home {
            Home::Mechanism => self.names.scope.enter_function(),
            Home::Import | Home::Library => self.names.scope.enter_shared_function(),
        }
        let numbers = self.whole_numbers(&arguments).filter(|_| function.home != Home::Library);
        for (parameter, argument) in function.parameters.iter().zip(arguments) {
            let binding = Binding::new(Origin::Argument, Some(argument.value), parameter.span.clone());
            // Two of one name have been reported.
            let _ = self.names.scope.declare(&parameter.text, binding);
        }
        self.report.calls.push(Call {
            name: function.name.text.clone(),
            span: span.clone(),
            home: function.home,
            is_part: false,
        });
        let value = self.expression(function.body);
        self.report.calls.pop();
        self.names.scope.leave();
        value.inspect(|value| {
            if function.home != Home::Library {
                self.note_meaning(&function.name.span, value);
            }
            self.remember_call(&function.name.text, numbers, value);
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{mechanism, near, refusals, refused, resolved, same, value, value_with_unit};

    #[test]
    fn functions_take_values_of_any_kind() {
        let square = "fn square(x) = x^2;";
        same(square, "square(x)", "x^2");
        assert_eq!(value_with_unit(square, "square(m)").1, "kg²");
        assert_eq!(value_with_unit(square, "square(dt(x))").1, "m²/s²");
        same(
            "fn energy(m, v) = 1/2*m*v.norm_squared();",
            "energy(2*m, dt([x, y, z]))",
            "m*dt([x, y, z]).norm_squared()",
        );
        same(
            "fn joint(angle, a) = rot_z(angle) * translation(a, 0, 0);",
            "joint(theta, l) * joint(q[0], l)",
            "rot_z(theta) * translation(l, 0, 0) * rot_z(q[0]) * translation(l, 0, 0)",
        );
        same("fn last(v) = v[1];", "last(q)", "q[1]");
        same("fn two() = 2;", "two()*x", "2*x");
        same("fn speed(p) = dt(p).norm();", "speed([x, y, 0])", "sqrt(dt(x)^2 + dt(y)^2)");
        near(
            &value("fn twice(x) = x + x; fn four(x) = twice(twice(x));", "four(1)"),
            &[4.0],
            "functions call functions",
        );
        // Before or behind its use, and in any statement.
        mechanism("kinetic += extra(m); fn extra(m) = 1/2*m*dt(x)^2; force x += f(u); fn f(u) = 2*u;", |lagrangian| {
            assert_eq!((lagrangian.kinetic.len(), lagrangian.forces.len()), (2, 2));
        });
        // Bodies stay visible.
        mechanism("fn ball(m, r) = particle(m, world.point(r)); kinetic += ball(m, [x, y, z]);", |lagrangian| {
            assert_eq!(lagrangian.bodies().0.len(), 1);
        });
    }

    #[test]
    fn functions_see_the_mechanism_and_their_arguments() {
        same("const n = 3; fn f(x) = n*x + y*u/u;", "f(m/m*l)", "3*l + y");
        near(
            &value("fn f(a) = a*late; const late = 5;", "f(2)"),
            &[10.0],
            "declared behind the function, before the call",
        );
        // An argument shadows a coordinate; a local name of the caller is not seen.
        near(&value("fn f(x) = 2*x; let a = 7;", "f(a)"), &[14.0], "shadowed");
        let help = "give it to the function as an argument; coordinates, parameters, inputs and constants it sees";
        refused(
            "let a = 7; fn f(x) = a*x; let b = f(2);",
            &format!("a: `a` is a `let`: a function does not see it; {help}"),
        );
        refused(
            "fn f(x) = i*x; for i in 0..2 { let b = f(2); }",
            &format!("i: `i` is a loop variable: a function does not see it; {help}"),
        );
        refused(
            "fn g(x) = y_0*x; fn f(y_0) = g(1); let b = f(2);",
            &format!("y_0: `y_0` is an argument: a function does not see it; {help}"),
        );
    }

    #[test]
    fn mistakes_show_the_body_and_the_call() {
        let source = "mechanism A {\nparam m: kg = 1;\ncoord x: m;\nkinetic += 1/2*m*dt(x)^2;\n\
                      fn inner(a) = a + x;\nfn outer(b) = 2*inner(b);\noutput r = outer(m);\n}";
        let report = resolved(source, |result| result.unwrap_err().render("a.mbs", source));
        let expected = "\
error[MBS0703]: a sum needs equal dimensions, this term is m, not kg
 --> a.mbs:5:19
  |
5 | fn inner(a) = a + x;
  |                   ^
note: in this call of `inner`
 --> a.mbs:6:17
  |
6 | fn outer(b) = 2*inner(b);
  |                 ^^^^^^^^
note: in this call of `outer`
 --> a.mbs:7:12
  |
7 | output r = outer(m);
  |            ^^^^^^^^
note: this is kg
 --> a.mbs:5:15
  |
5 | fn inner(a) = a + x;
  |               ^
";
        assert_eq!(report, expected);
        refused("fn f(x) = x; let a = f();", "f: `f` takes 1 argument, 0 are given; write `f(x)`");
        refused("fn f(x, y) = x; let a = f(1);", "f: `f` takes 2 arguments, 1 is given; write `f(x, y)`");
        refused(
            "fn fall(x) = x; let a = fal(1) + fall(1);",
            "fal: there is no function `fal`; did you mean `fall(x)`?",
        );
        refused("fn f(x) = x; let a = 2*f; let b = f(a);", "f: `f` is a function; write `f(x)`");
        refused("fn sin(x) = x;", "sin: the function `sin` is built in; choose another name");
        refused("fn f(x, x) = x; let a = f(1, 2);", "x: `f` has two arguments called `x`; choose another name");
        refused("fn f(x) = x; fn f(y) = y; let a = f(1);", "f: `f` is already a function; choose another name");
        refused("fn f(x) = x; let f = 1;", "f: `f` is already a function; choose another name");
        refused("fn f(x) = x;", "f: `f` is never called; so it has not been checked");
        assert_eq!(
            refusals("for i in 0..2 { fn f(x) = x; }"),
            ["fn f(x) = x;: `fn` cannot stand in a loop; functions are the mechanism's own: move it out of the loop"]
        );
    }

    #[test]
    fn recursion_is_refused() {
        let help = "a function is a formula: repeat with a `for` loop and a `let mut`";
        refused("fn f(n) = n*f(n - 1); let a = f(3);", &format!("f: `f` calls itself: f → f; {help}"));
        refused(
            "fn a(n) = b(n) + 1; fn b(n) = 2*c(n); fn c(n) = a(n); fn d(n) = a(n); let x_0 = d(1);",
            &format!("a: `a` calls itself: a → b → c → a; {help}"),
        );
        refused(
            "fn a(n) = if n < 1 { 1 } else { n*a(n - 1) }; let x_0 = a(3);",
            &format!("a: `a` calls itself: a → a; {help}"),
        );
    }

    #[test]
    fn calls_without_end_are_stopped() {
        let chain = |n: usize, body: fn(usize) -> String| {
            let mut text = String::from("fn f0(x) = x;");
            (1..=n).for_each(|i| text += &format!("fn f{i}(x) = {};", body(i)));
            format!("{text} let a = f{n}(1);")
        };
        let doubled = refusals(&chain(40, |i| format!("f{0}(x) + f{0}(x)", i - 1)));
        assert!(doubled[0].contains("are called more than 100000 times"), "{doubled:?}");
        let deep = refusals(&chain(2000, |i| format!("f{}(x)", i - 1)));
        assert!(deep[0].contains("nested deeper than 260 levels; the calls within calls count too"), "{deep:?}");
        assert!(refusals(&chain(100, |i| format!("f{}(x)", i - 1))).is_empty());
    }

    #[test]
    fn the_library() {
        same("", "spring(k, x, l)", "1/2*k*(x - l)^2");
        let friction = "const f_c: N = 2; const f_s: N = 3; const v_s: m/s = 0.1; const v_e: m/s = 0.01;";
        let v = 0.5f64;
        let expected = -(2.0 + (v / 0.1).powi(2).mul_add(-1.0, 0.0).exp()) * (v / 0.01).tanh();
        near(&value(friction, "coulomb_stribeck(dt(x), f_c, f_s, v_s, v_e)"), &[expected], "friction");
        assert_eq!(value_with_unit(friction, "coulomb_stribeck(dt(x), f_c, f_s, v_s, v_e)").1, "kg·m/s²");
        let contact = "const c: N*s/m = 0.1; fn at_height(h) = contact(h, k, c, dt(h));";
        near(
            &value(contact, "[at_height(x), at_height(y), at_height(x - y - 2*l)]"),
            &[0.0, 5.0 * 0.7 - 0.1 * 0.2, 25.0 - 0.03],
            "contact",
        );
        near(&value("const c: N*s/m = 100;", "contact(y, k, c, dt(y))"), &[0.0], "a contact never pulls");
        refused(
            "let a = spring(k, x, m);",
            "spring(k, x, m): in `spring`: a sum needs equal dimensions, this term is kg, not m",
        );
        // A mechanism may have its own.
        same("fn spring(x) = 2*x;", "spring(x)", "2*x");
    }

    #[test]
    fn a_name_may_be_that_of_a_library_function() {
        assert!(refusals("let spring = 1; let contact = 2*spring;").is_empty());
    }
}
