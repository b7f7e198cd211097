use crate::expr::Graph;
use crate::model::check::trial::{messages, near, refusals, refused, same, value, value_with_unit};
use crate::parse::syntax::{
    BinaryOperator, Declaration, EnergyTerm, Expression, ExpressionKind, Name, Statement, StatementKind,
};

#[test]
fn numbers_names_and_built_in_constants() {
    let check = |expression, expected: f64, unit: &str| {
        assert_eq!(value_with_unit("", expression), (vec![expected], unit.to_string()), "{expression}");
    };
    check("1/2", 0.5, "1");
    check("1e-3", 1e-3, "1");
    check("pi", std::f64::consts::PI, "1");
    check("180*deg", std::f64::consts::PI, "1");
    check("t", 0.25, "s");
    check("m", 2.0, "kg");
    check("x", 0.3, "m");
    check("q[1]", 1.3, "1");
    check("u", 1.5, "kg·m/s²");
    check("2^3^2", 512.0, "1");
    check("-2^2", -4.0, "1");
}

/// Nothing is turned into a frame's axes and back.
#[test]
fn velocities_along_axes_of_the_world_keep_their_digits() {
    let frame = "let pose = translation([x, 1e8*l, 0]) * rot_z(theta) * rot_y(y/l) * rot_x(x/l);";
    assert_eq!(value(frame, "dt(pose.origin()).x"), value("", "dt(x)"));
    assert_eq!(value(frame, "dt(pose.origin()).y"), value("", "0"));
    assert_eq!(value(frame, "dt(pose.origin()).z"), value("", "0"));
    let turning = "let arm = rot_z(theta) * translation([l, 0, 0]) * rot_y(y/l) * rot_x(x/l);";
    assert_eq!(value(turning, "dt(arm.origin()).z"), value("", "0"));
    near(&value(turning, "dt(arm.origin()).x"), &value("", "-l*sin(theta)*dt(theta)"), "a velocity");
}

#[test]
fn components_and_elements() {
    near(&value("", "[x, y, z].y"), &[-0.7], "a component");
    near(&value("", "[[1, 2], [3, 4]][1][0]"), &[3.0], "an element");
    near(&value("const n = 2;", "[x, y, z][n]"), &[1.1], "an element by a constant");
    same("let pose = translation([l, 0, 0]) * rot_z(theta);", "(pose * [x, y, z]).x", "x*cos(theta) - y*sin(theta)");
    same(
        "let pose = translation([l, 0, 0]) * rot_z(theta);",
        "pose.point([x, y, z]).x",
        "l + x*cos(theta) - y*sin(theta)",
    );
    same("", "diag(1, 2, 3)[1][1]", "2");
    same("", "translation(x, 0, 0).origin()[0]", "x");
    refused("let a = q[2];", "2: the index 2 is out of range: there are 2 elements; indices run from 0 to 1");
    refused("let a = q[0 - 1];", "0 - 1: the index -1 is out of range: there are 2 elements; indices run from 0 to 1");
    refused(
        "let a = q[m/m];",
        "m/m: an index must be a constant integer; it is made of numbers, constants and loop variables",
    );
    refused(
        "let a = q[1/2];",
        "1/2: an index must be a constant integer; it is made of numbers, constants and loop variables",
    );
    refused(
        "let a = m[0];",
        "m: a number has no elements; arrays are declared with their length: `param mass[6]: kg = 1;`",
    );
    refused(
        "let a = [x, y, z].w;",
        "w: there is no component `w`; vectors and points have `.x`, `.y` and `.z`, along the axes of the world",
    );
    refused("let a = [x, y, z].norm;", "norm: there is no component `norm`; write `v.norm()`");
    refused("let a = x.x;", "x: expected a vector, found a number; a vector is written `[x, y, z]`");
}

#[test]
fn unknown_names_get_the_nearest() {
    refused("let a = thetta;", "thetta: `thetta` is not declared; did you mean `theta`?");
    refused(
        "let a = mass_of_it;",
        "mass_of_it: `mass_of_it` is not declared; declare it: `param mass_of_it: m = …;` or `let mass_of_it = …;`",
    );
    refused("let a = theta_dot;", "theta_dot: `theta_dot` is not declared; the rate of `theta` is `dt(theta)`");
    refused("let a = sin;", "sin: `sin` is a function; write `sin(x)`");
    refused(
        "let a = late; let late = 1;",
        "late: `late` is declared further down; names are known from their declaration on: move it up",
    );
    // What is made of a refused value is refused without a word; the rest is looked at.
    assert_eq!(refusals("let a = nothing; let b = a + 1; let c = b * nowhere;").len(), 2);
    assert_eq!(refusals("let a = first_thing + second_thing;").len(), 2);
}

#[test]
fn definitions_in_a_circle_are_named() {
    let help = "a `let mut` can take a new value made of its old one: `x = x + …;`";
    refused("let a = b; let b = a;", &format!("b: `b` is defined by itself: a → b → a; {help}"));
    refused("let a = 1 + c; let b = 2*a; let c = -b;", &format!("c: `c` is defined by itself: a → c → b → a; {help}"));
    refused("let a = a + 1;", &format!("a: `a` is defined by itself: a → a; {help}"));
    refused("param p: m = c; const c = p;", &format!("c: `c` is defined by itself: p → c → p; {help}"));
    assert!(refusals("for i in 0..2 { let m = m + m; kinetic += m*dt(x)^2; }").is_empty());
}

#[test]
fn what_is_not_finite_is_refused() {
    refused("let a = sqrt(-2);", "sqrt(-2): this is not a finite real number");
    refused("let a = 1 + ln(0);", "ln(0): this is not a finite real number");
    refused("let a = x/(1 - 1);", "(1 - 1): division by zero");
    refused("let a = 0^(-1);", "0: division by zero");
    refused("let a = 1e300 * 1e300;", "1e300 * 1e300: this is not a finite real number");
    refused("let a = asin(2) * x;", "asin(2): this is not a finite real number");
}

#[test]
fn arrays_stay_small() {
    refused("let a = [];", "[]: an array has at least one element");
    let grown = refusals("let mut a = [1]; for i in 0..40 { a = [a, a]; }");
    assert_eq!(grown, ["[a, a]: this array is too large or nested too deeply"]);
}

#[test]
fn runaway_models_are_stopped() {
    let doubling = "let mut p = world; for i in 0..60 { p = p * rot_z(theta) * p; kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2, p); }";
    assert_eq!(
        refusals(doubling).last().map(|m| m.split_once(": ").unwrap().1.to_string()).as_deref(),
        Some(
            "the expressions of this mechanism grow beyond 2000000 nodes; do loops repeat more than was meant, or do values double in each turn?"
        )
    );
}

#[test]
fn dimensionless_mechanisms_are_not_analysed() {
    let model = "coord x: 1; param l: m = 2; kinetic += dt(x)^2 + l*dt(x)^2; potential += sin(l) + x;";
    assert!(messages(&format!("#![dimensionless] mechanism A {{ {model} }}")).is_empty());
    assert_eq!(messages(&format!("mechanism A {{ {model} }}")).len(), 2);
}

fn expression(kind: ExpressionKind) -> Expression {
    Expression { kind, span: 0..0 }
}

fn number(text: &str) -> Expression {
    expression(ExpressionKind::Number(text.to_string()))
}

fn declaration(value: Expression) -> Declaration {
    let name = Name { text: "A".to_string(), span: 0..0 };
    let kind = StatementKind::Energy { term: EnergyTerm::Kinetic, value };
    let statements = vec![Statement { kind, span: 0..0 }];
    let (imports, imported, warnings) = (Vec::new(), Vec::new(), crate::diagnostic::Diagnostics::default());
    Declaration { dimensionless: false, imports, imported, name, docs: Vec::new(), statements, of_robots: 0, warnings }
}

/// Built by hand, past the parser.
#[test]
fn no_syntax_tree_panics() {
    let deep = |wrap: fn(Box<Expression>) -> ExpressionKind, levels: usize| {
        (0..levels).fold(number("1"), |inner, _| expression(wrap(Box::new(inner))))
    };
    let left = |a| ExpressionKind::Binary(BinaryOperator::Add, a, Box::new(number("1")));
    let right = |a| ExpressionKind::Binary(BinaryOperator::Pow, Box::new(number("1")), a);
    for value in [
        number("1.2.3"),
        number(""),
        deep(ExpressionKind::Negate, 400),
        deep(|a| ExpressionKind::Array(vec![*a]), 400),
        deep(|a| ExpressionKind::Method(a, Name { text: "norm".to_string(), span: 0..0 }, Vec::new()), 400),
        deep(right, 400),
        deep(left, 100_000),
    ] {
        let graph = Graph::verbatim();
        assert!(crate::model::resolve(&declaration(value), &graph).is_err());
    }
}
