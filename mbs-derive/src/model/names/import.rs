//! What imported files declare: known before the mechanism's own statements, and to each other only.

use std::collections::BTreeMap;

use crate::diagnostic::{Code, nearest};
use crate::model::names::function::{Function, Home};
use crate::model::value::evaluate::{Refused, Resolver};
use crate::parse::syntax::{Span, Statement};

impl<'d, 'g> Resolver<'d, 'g> {
    /// Declares the constants and functions of imported files; from here on names are the mechanism's own.
    pub(in crate::model) fn import(&mut self, statements: &'d [Statement]) {
        self.survey(statements);
        self.names.shared = self.names.functions.clone();
        self.statements(statements);
        self.names.definitions.clear();
        self.names.scope.enter();
    }

    /// Whose text is being looked at.
    pub(in crate::model) fn home(&self) -> Home {
        match self.report.calls.last() {
            Some(call) => call.home,
            None if self.names.scope.is_shared() => Home::Import,
            None => Home::Mechanism,
        }
    }

    /// The functions that may be called here: from an imported file one of the mechanism's own is not seen, and one of
    /// the library is seen behind it.
    pub(in crate::model) fn functions_in_sight(&self) -> &BTreeMap<&'d str, Function<'d>> {
        if self.home() == Home::Mechanism { &self.names.functions } else { &self.names.shared }
    }

    /// A name that no imported file declares, in one of them.
    pub(in crate::model) fn unknown_to_imports(&mut self, name: &str, span: &Span) -> Refused {
        let own = self.names.scope.hidden(name).filter(|_| self.home() == Home::Import);
        let seen: Vec<&str> = self.names.scope.names().map(|(name, _)| name).collect();
        match (own, nearest(name, seen)) {
            (Some(origin), _) => {
                let message = format!("`{name}` is {}: an imported file does not see it", origin.described());
                self.refuse(Code::OutOfSight, span, message, "give it to the function as an argument")
            }
            (None, Some(near)) => {
                let help = format!("did you mean `{near}`?");
                self.refuse(Code::Undeclared, span, format!("`{name}` is not declared"), help)
            }
            (None, None) => {
                let help = "an imported file sees arguments, and the constants and functions of imported files";
                self.refuse(Code::Undeclared, span, format!("`{name}` is not declared"), help)
            }
        }
    }

    /// Notes an error about a name that is declared at two places.
    pub(in crate::model) fn refuse_twice(
        &mut self,
        span: &Span,
        message: String,
        help: String,
        first: Span,
    ) -> Refused {
        self.report
            .errors
            .error(Code::DeclaredTwice, span.clone(), message)
            .help(help)
            .note(first, "it is declared here");
        Refused
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::Diagnostics;
    use crate::expr::{Graph, Symbol, evaluate};
    use crate::model::{OutputValue, resolve};
    use crate::parse::{self, syntax::Span};
    use crate::source::{Sources, Unreadable};

    const BODY: &str = "param m: kg = 2; coord x: m; kinetic += 1/2*m*dt(x)^2;";

    /// A mechanism that imports `a.mbs`, which may import `b.mbs`.
    fn sources(a: &str, b: &str, statements: &str) -> Sources {
        let text = format!("import \"a.mbs\"; mechanism M {{ {BODY} {statements} }}");
        Sources::gather("m.mbs", &text, |name| match name {
            "a.mbs" => Ok(a.as_bytes().to_vec()),
            "b.mbs" => Ok(b.as_bytes().to_vec()),
            _ => Err(Unreadable::new("", "")),
        })
    }

    /// The values of outputs, at `x = 3`.
    fn values(a: &str, b: &str, statements: &str) -> Vec<f64> {
        let sources = sources(a, b, statements);
        let graph = Graph::verbatim();
        let shown = |e: Diagnostics| e.render_in(&sources);
        let declaration = parse::declaration_of(&sources).map_err(shown).unwrap();
        let (lagrangian, warnings) = resolve(&declaration, &graph).map_err(shown).unwrap();
        assert_eq!(warnings.render_in(&sources), "");
        let exprs = lagrangian.outputs.iter().map(|output| match output.value {
            OutputValue::Scalar(expr) => expr,
            _ => panic!("numbers are asked for"),
        });
        evaluate(&exprs.collect::<Vec<_>>(), |symbol| match symbol {
            Symbol::Coordinate(0) => 3.0,
            Symbol::Parameter(0) => 2.0,
            _ => f64::NAN,
        })
    }

    /// The messages, each with the texts of its place and of its notes' places.
    fn refused(a: &str, b: &str, statements: &str, expected: &[&str]) {
        let sources = sources(a, b, statements);
        let graph = Graph::verbatim();
        let declaration = parse::declaration_of(&sources).unwrap_or_else(|e| panic!("{}", e.render_in(&sources)));
        let errors = resolve(&declaration, &graph).map(|(_, warnings)| warnings).unwrap_or_else(|errors| errors);
        let place = |span: &Span| {
            let (name, text, span) = sources.locate(span);
            format!("{name}: {}", &text[span])
        };
        let line = |m: &crate::diagnostic::Diagnostic| {
            let notes: String = m.notes.iter().map(|n| format!(" ({}, {})", n.message, place(&n.span))).collect();
            format!("{}: {}; {}{notes}", place(&m.span), m.message, m.help.as_deref().unwrap_or("no help"))
        };
        assert_eq!(errors.iter().map(line).collect::<Vec<_>>(), expected, "{a} {b} {statements}");
    }

    #[test]
    fn constants_and_functions_are_shared() {
        let a = "import \"b.mbs\"; const n = 2*base; fn twice(x) = n*x/base; fn unused(y) = nothing*y;";
        let b = "const base = 5; const idle: m = 1; fn cube(base) = base^3; const eight = cube(2);";
        let statements = "output a = twice(x); output b = n*eight; fn own(n) = twice(cube(n)) + base; output c = own(2); \
                          let mut sum = 0; for base in 0..3 { let n = base; sum = sum + n; } output d = sum;";
        assert_eq!(values(a, b, statements), [6.0, 80.0, 21.0, 3.0]);
    }

    /// What a mechanism declares by a name that the library has does not reach into what it imports.
    #[test]
    fn the_library_stays_the_library_in_an_imported_file() {
        let a = "fn energy(k, x) = spring(k, x, 0);";
        assert_eq!(
            values(a, "", "output e = energy(2, 3); fn spring(x) = energy(x, 1); output s = spring(7);"),
            [9.0, 3.5]
        );
        assert_eq!(values("fn spring(x) = 5*x;", "", "output s = spring(2);"), [10.0]);
    }

    #[test]
    fn imported_files_see_imported_files_only() {
        refused(
            "fn weight(h) = m*h;",
            "",
            "output w = weight(x);",
            &[
                "a.mbs: m: `m` is a parameter: an imported file does not see it; give it to the function as an argument \
               (in this call of `weight`, m.mbs: weight(x))",
            ],
        );
        refused(
            "fn f(y) = own(y);",
            "",
            "fn own(y) = y; output w = own(f(x));",
            &[
                "a.mbs: own: there is no function `own`; it is a function of the mechanism, which imported files do not see \
               (in this call of `f`, m.mbs: f(x))",
            ],
        );
        refused(
            "const lenght: m = 1; const two = 2*length; const far = distant;",
            "",
            "let length = 2*lenght;",
            &[
                "a.mbs: length: `length` is not declared; did you mean `lenght`?",
                "a.mbs: distant: `distant` is not declared; \
                 an imported file sees arguments, and the constants and functions of imported files",
            ],
        );
        refused(
            "fn f(length) = lenght;",
            "",
            "output w = f(x);",
            &["a.mbs: lenght: `lenght` is not declared; did you mean `length`? (in this call of `f`, m.mbs: f(x))"],
        );
    }

    #[test]
    fn a_name_is_declared_once_in_all_files() {
        let twice = |a: &str, b: &str, statements: &str, expected: &str| refused(a, b, statements, &[expected]);
        twice(
            "const k = 1;",
            "",
            "let k = 2;",
            "m.mbs: k: `k` is already a constant; choose another name (it is declared here, a.mbs: k)",
        );
        twice(
            "fn k(y) = 1;",
            "",
            "coord k: m; kinetic += m*dt(k)^2;",
            "m.mbs: k: `k` is already a function; choose another name (it is declared here, a.mbs: k)",
        );
        twice(
            "fn k(y) = 1;",
            "",
            "fn k(y) = y; output w = k(x);",
            "m.mbs: k: `k` is already a function; choose another name (it is declared here, a.mbs: k)",
        );
        twice(
            "const k = 1;",
            "",
            "fn k(y) = y; output w = k*x;",
            "m.mbs: k: `k` is already a constant; choose another name (it is declared here, a.mbs: k)",
        );
        twice(
            "import \"b.mbs\"; const k = 1;",
            "const k = 1;",
            "",
            "a.mbs: k: `k` is already a constant; choose another name (it is declared here, b.mbs: k)",
        );
        twice(
            "import \"b.mbs\"; fn k(y) = 1;",
            "const k = 1;",
            "",
            "b.mbs: k: `k` is already a function; choose another name (it is declared here, a.mbs: k)",
        );
        twice(
            "fn f(y) = g(y); fn g(y) = f(y);",
            "",
            "",
            "a.mbs: f: `f` calls itself: f → g → f; a function is a formula: repeat with a `for` loop and a `let mut`",
        );
    }
}
