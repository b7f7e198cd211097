//! For tests: small mechanisms, resolved and tried at one state.

use crate::diagnostic::Diagnostics;
use crate::expr::{Expr, Graph, Symbol, carry_out, evaluate};
use crate::model::{Lagrangian, resolve};
use crate::parse;

/// What the statements of a trial find declared.
const PRELUDE: &str = "\
    param m: kg = 2; param l: m = 3; param k: N/m = 5;
    coord x: m; coord y: m; coord z: m; coord theta: rad; coord q[2]: rad; input u: N;
    kinetic += 1/2*m*(dt(x)^2 + dt(y)^2 + dt(z)^2 + l^2*(dt(theta)^2 + dt(q[0])^2 + dt(q[1])^2));
    potential += 1/2*k*x^2; force x += u;
";

/// x, y, z, theta, q of the trial state, then their rates.
const STATE: ([f64; 6], [f64; 6]) = ([0.3, -0.7, 1.1, 0.4, -0.9, 1.3], [0.5, 0.2, -0.6, 1.7, -0.8, 0.9]);

/// The value at the trial state of the symbols.
pub(in crate::model) fn at(symbol: Symbol) -> f64 {
    match symbol {
        Symbol::Time => 0.25,
        Symbol::Coordinate(i) => STATE.0[i as usize],
        Symbol::Velocity(i) => STATE.1[i as usize],
        Symbol::Acceleration(_) => f64::NAN,
        Symbol::Parameter(i) => [2.0, 3.0, 5.0][i as usize],
        Symbol::Input(_) => 1.5,
        Symbol::Prescribed(i, order) => [0.6, -1.4, 2.5][usize::from(order)] + f64::from(i),
        Symbol::Multiplier(_) => f64::NAN,
    }
}

/// The values of verbatim expressions at the trial state.
pub(in crate::model) fn values(exprs: &[Expr<'_>]) -> Vec<f64> {
    let graph = Graph::new();
    let along = |symbol| match symbol {
        Symbol::Coordinate(i) => Some(graph.symbol(Symbol::Velocity(i))),
        Symbol::Time => Some(graph.integer(1)),
        Symbol::Prescribed(i, order) => Some(graph.symbol(Symbol::Prescribed(i, order + 1))),
        _ => None,
    };
    evaluate(&carry_out(exprs, &graph, along), at)
}

/// Resolves one whole text and looks at the result.
pub(in crate::model) fn resolved<T>(
    source: &str,
    look: impl FnOnce(Result<(Lagrangian<'_>, Diagnostics), Diagnostics>) -> T,
) -> T {
    let declaration = parse::declaration(source).unwrap_or_else(|e| panic!("{}", e.render("trial", source)));
    let graph = Graph::verbatim();
    look(resolve(&declaration, &graph))
}

/// Resolves some statements behind the prelude.
pub(in crate::model) fn mechanism<T>(statements: &str, look: impl FnOnce(Lagrangian<'_>) -> T) -> T {
    let source = format!("mechanism A {{ {PRELUDE} {statements} }}");
    resolved(&source, |result| match result {
        Ok((lagrangian, _)) => look(lagrangian),
        Err(errors) => panic!("{}", errors.render("trial", &source)),
    })
}

/// What an expression is at the trial state, flattened, with the unit of its components, or all of them where they
/// differ.
pub(in crate::model) fn value_with_unit(statements: &str, expression: &str) -> (Vec<f64>, String) {
    mechanism(&format!("{statements} output result = {expression};"), |lagrangian| {
        let output = &lagrangian.outputs[lagrangian.outputs.len() - 1];
        let mut units = output.units.clone();
        units.dedup();
        (values(&output.value.components(&lagrangian.frames)), units.join(", "))
    })
}

/// What an expression is at the trial state.
pub(in crate::model) fn value(statements: &str, expression: &str) -> Vec<f64> {
    value_with_unit(statements, expression).0
}

/// Both expressions have the same value and unit.
pub(in crate::model) fn same(statements: &str, left: &str, right: &str) {
    let ((a, unit_a), (b, unit_b)) = (value_with_unit(statements, left), value_with_unit(statements, right));
    assert_eq!(unit_a, unit_b, "{left} and {right}");
    near(&a, &b, &format!("{left} and {right}"));
}

/// Equal but for rounding.
pub(in crate::model) fn near(a: &[f64], b: &[f64], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}: {a:?}, {b:?}");
    let close = a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + a.abs().max(b.abs())));
    assert!(close, "{what}: {a:?}, {b:?}");
}

/// The messages about a whole text: `the text: message; help`.
pub(in crate::model) fn messages(source: &str) -> Vec<String> {
    let of = |diagnostics: Diagnostics| {
        let shown = |m: &crate::diagnostic::Diagnostic| match &m.help {
            Some(help) => format!("{}: {}; {help}", &source[m.span.clone()], m.message),
            None => format!("{}: {}", &source[m.span.clone()], m.message),
        };
        diagnostics.iter().map(shown).collect()
    };
    resolved(source, |result| match result {
        Ok((_, warnings)) => of(warnings),
        Err(errors) => of(errors),
    })
}

/// The messages about some statements behind the prelude.
pub(in crate::model) fn refusals(statements: &str) -> Vec<String> {
    messages(&format!("mechanism A {{ {PRELUDE} {statements} }}"))
}

/// Statements that are refused with one message.
pub(in crate::model) fn refused(statements: &str, message: &str) {
    assert_eq!(refusals(statements), [message], "{statements}");
}
