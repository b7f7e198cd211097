//! A declaration as text again: what is read from it is the same declaration, places aside.

use std::fmt::{self, Display, Formatter};

use super::syntax::{
    BinaryOperator, Comparison, Declaration, EnergyTerm, Expression, ExpressionKind, Quantity, Statement,
    StatementKind, Unit,
};

impl Display for Declaration {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.dimensionless {
            writeln!(f, "#![dimensionless]")?;
        }
        self.imports.iter().try_for_each(|import| writeln!(f, "import \"{}\";", import.path))?;
        docs(f, &self.docs, 0)?;
        writeln!(f, "mechanism {} {{", self.name.text)?;
        self.statements.iter().skip(self.of_robots).try_for_each(|statement| lines(f, statement, 1))?;
        writeln!(f, "}}")
    }
}

impl Display for Statement {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        lines(f, self, 0)
    }
}

const INDENT: &str = "    ";

fn lines(f: &mut Formatter<'_>, statement: &Statement, depth: usize) -> fmt::Result {
    let indent = INDENT.repeat(depth);
    match &statement.kind {
        StatementKind::Param(quantity) => declared(f, "param", quantity, depth),
        StatementKind::Coord(quantity) => declared(f, "coord", quantity, depth),
        StatementKind::Input(quantity) => declared(f, "input", quantity, depth),
        StatementKind::Const(quantity) => declared(f, "const", quantity, depth),
        StatementKind::Let { mutable, name, value } => {
            writeln!(f, "{indent}let {}{} = {value};", if *mutable { "mut " } else { "" }, name.text)
        }
        StatementKind::Elements { mutable, name, lengths } => {
            write!(f, "{indent}let {}{}", if *mutable { "mut " } else { "" }, name.text)?;
            indices(f, lengths)?;
            writeln!(f, ";")
        }
        StatementKind::Assign { name, indices: element, value } => {
            write!(f, "{indent}{}", name.text)?;
            indices(f, element)?;
            writeln!(f, " = {value};")
        }
        StatementKind::Energy { term, value } => writeln!(f, "{indent}{term} += {value};"),
        StatementKind::Force { coordinate, index: Some(index), value } => {
            writeln!(f, "{indent}force {}[{index}] += {value};", coordinate.text)
        }
        StatementKind::Force { coordinate, index: None, value } => {
            writeln!(f, "{indent}force {} += {value};", coordinate.text)
        }
        StatementKind::Function { name, parameters, body } => {
            let names: Vec<&str> = parameters.iter().map(|parameter| parameter.text.as_str()).collect();
            writeln!(f, "{indent}fn {}({}) = {body};", name.text, names.join(", "))
        }
        StatementKind::Prescribed(quantity) => declared(f, "prescribed", quantity, depth),
        StatementKind::ForceAt { point, value } => writeln!(f, "{indent}force at {point} += {value};"),
        StatementKind::TorqueOn { pose, value } => writeln!(f, "{indent}torque on {pose} += {value};"),
        StatementKind::Gravity { acceleration } => writeln!(f, "{indent}gravity {acceleration};"),
        StatementKind::Part { name, parameters, body } => {
            let names: Vec<&str> = parameters.iter().map(|parameter| parameter.text.as_str()).collect();
            writeln!(f, "{indent}part {}({}) {{", name.text, names.join(", "))?;
            body.iter().try_for_each(|statement| lines(f, statement, depth + 1))?;
            writeln!(f, "{indent}}}")
        }
        StatementKind::Instance { part, name, index, arguments } => {
            let index = index.as_ref().map(|index| format!("[{index}]")).unwrap_or_default();
            let arguments: Vec<String> = arguments.iter().map(Expression::to_string).collect();
            writeln!(f, "{indent}{} {}{index}({});", part.text, name.text, arguments.join(", "))
        }
        StatementKind::Reaction { docs: about, name, index, pose, element } => {
            docs(f, about, depth)?;
            write!(f, "{indent}reaction {}", name.text)?;
            indices(f, index.as_slice())?;
            write!(f, " at {}", pose.text)?;
            indices(f, element)?;
            writeln!(f, ";")
        }
        StatementKind::Constraint { docs: about, name, index, left, right } => {
            docs(f, about, depth)?;
            write!(f, "{indent}constraint {}", name.text)?;
            indices(f, index.as_slice())?;
            writeln!(f, ": {left} = {right};")
        }
        StatementKind::Output { docs: about, name, index, value, jacobian_rate } => {
            docs(f, about, depth)?;
            write!(f, "{indent}output {}", name.text)?;
            indices(f, index.as_slice())?;
            writeln!(f, " = {value}{};", if jacobian_rate.is_some() { ", jacobian_rate" } else { "" })
        }
        StatementKind::Shape { pose, kind, file, sizes } => {
            let file = file.iter().map(|path| format!("\"{path}\""));
            let sizes: Vec<String> = file.chain(sizes.iter().map(Expression::to_string)).collect();
            writeln!(f, "{indent}shape {pose} += {}({});", kind.text, sizes.join(", "))
        }
        StatementKind::For { variable, start, end, body } => {
            writeln!(f, "{indent}for {} in {start}..{end} {{", variable.text)?;
            body.iter().try_for_each(|statement| lines(f, statement, depth + 1))?;
            writeln!(f, "{indent}}}")
        }
        StatementKind::If { branches, otherwise } => {
            write!(f, "{indent}")?;
            for (i, (condition, body)) in branches.iter().enumerate() {
                writeln!(f, "{}if {condition} {{", if i > 0 { " else " } else { "" })?;
                body.iter().try_for_each(|statement| lines(f, statement, depth + 1))?;
                write!(f, "{indent}}}")?;
            }
            if !otherwise.is_empty() {
                writeln!(f, " else {{")?;
                otherwise.iter().try_for_each(|statement| lines(f, statement, depth + 1))?;
                write!(f, "{indent}}}")?;
            }
            writeln!(f)
        }
    }
}

/// `[i][j]`
fn indices(f: &mut Formatter<'_>, indices: &[Expression]) -> fmt::Result {
    indices.iter().try_for_each(|index| write!(f, "[{index}]"))
}

fn declared(f: &mut Formatter<'_>, keyword: &str, quantity: &Quantity, depth: usize) -> fmt::Result {
    docs(f, &quantity.docs, depth)?;
    write!(f, "{}{keyword} {}", INDENT.repeat(depth), quantity.name.text)?;
    if let Some(length) = &quantity.length {
        write!(f, "[{length}]")?;
    }
    if let Some(columns) = &quantity.columns {
        write!(f, "[{columns}]")?;
    }
    if let Some(unit) = &quantity.unit {
        write!(f, ": {unit}")?;
    }
    if let Some(value) = &quantity.value {
        write!(f, " = {value}")?;
    }
    if quantity.positive.is_some() {
        f.write_str(", positive")?;
    }
    writeln!(f, ";")
}

fn docs(f: &mut Formatter<'_>, docs: &[String], depth: usize) -> fmt::Result {
    let indent = INDENT.repeat(depth);
    docs.iter().try_for_each(|line| writeln!(f, "{}", format!("{indent}/// {line}").trim_end()))
}

impl Display for EnergyTerm {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            EnergyTerm::Kinetic => "kinetic",
            EnergyTerm::Potential => "potential",
            EnergyTerm::Dissipation => "dissipation",
            EnergyTerm::Lagrangian => "lagrangian",
        })
    }
}

impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        if self.factors.is_empty() {
            return f.write_str("1");
        }
        for (i, factor) in self.factors.iter().enumerate() {
            let times = if i > 0 { "*" } else { "" };
            write!(f, "{times}{}", factor.name.text)?;
            match factor.exponent {
                (1, 1) => {}
                (n, 1) => write!(f, "^{n}")?,
                (n, d) => write!(f, "^({n}/{d})")?,
            }
        }
        Ok(())
    }
}

impl Display for BinaryOperator {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            BinaryOperator::Add => " + ",
            BinaryOperator::Sub => " - ",
            BinaryOperator::Mul => "*",
            BinaryOperator::Div => "/",
            BinaryOperator::Pow => "^",
        })
    }
}

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Comparison::Less => " < ",
            Comparison::LessEqual => " <= ",
            Comparison::Greater => " > ",
            Comparison::GreaterEqual => " >= ",
            Comparison::Equal => " == ",
            Comparison::NotEqual => " != ",
        })
    }
}

/// How tightly the parts of an expression hang together: a choice least, a value most.
const CHOICE: u8 = 0;
const OR: u8 = 1;
const AND: u8 = 2;
const COMPARISON: u8 = 3;
const SUM: u8 = 4;
const PRODUCT: u8 = 5;
const SIGNED: u8 = 6;
const POWER: u8 = 7;
const VALUE: u8 = 8;

/// With no more parentheses than it needs.
impl Display for Expression {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.kind {
            // As text it keeps what stands next to it from being read as digits.
            ExpressionKind::Number(text) if text.ends_with('.') => write!(f, "{text}0"),
            ExpressionKind::Number(text) | ExpressionKind::Name(text) => f.write_str(text),
            ExpressionKind::Quantity(text, unit) => write!(f, "{text} {unit}"),
            ExpressionKind::Negate(value) => {
                f.write_str("-")?;
                at_least(f, SIGNED, value)
            }
            ExpressionKind::Binary(..) => chain(f, self),
            ExpressionKind::Call(name, arguments) => {
                f.write_str(&name.text)?;
                list(f, '(', arguments, ')')
            }
            ExpressionKind::Method(value, name, arguments) => {
                at_least(f, VALUE, value)?;
                write!(f, ".{}", name.text)?;
                list(f, '(', arguments, ')')
            }
            ExpressionKind::Field(value, name) => {
                at_least(f, VALUE, value)?;
                write!(f, ".{}", name.text)
            }
            ExpressionKind::Index(value, index) => {
                at_least(f, VALUE, value)?;
                write!(f, "[{index}]")
            }
            ExpressionKind::Array(elements) => list(f, '[', elements, ']'),
            ExpressionKind::If(condition, yes, no) => match no.kind {
                ExpressionKind::If(..) => write!(f, "if {condition} {{ {yes} }} else {no}"),
                _ => write!(f, "if {condition} {{ {yes} }} else {{ {no} }}"),
            },
            ExpressionKind::Compare(comparison, left, right) => {
                pair(f, (SUM, left), &comparison.to_string(), (SUM, right))
            }
            ExpressionKind::And(left, right) => pair(f, (AND, left), " && ", (COMPARISON, right)),
            ExpressionKind::Or(left, right) => pair(f, (OR, left), " || ", (AND, right)),
            ExpressionKind::Not(value) => {
                f.write_str("!")?;
                at_least(f, SIGNED, value)
            }
        }
    }
}

/// `a*b + c`: a parenthesis around the left operand of an operator opens at the very beginning.
fn chain(f: &mut Formatter<'_>, expression: &Expression) -> fmt::Result {
    let (first, steps) = expression.left_spine();
    let parenthesized = |i: usize| {
        let left = if i == 0 { tightness(first) } else { operator_tightness(steps[i - 1].0).0 };
        left < operator_tightness(steps[i].0).1
    };
    (0..steps.len()).filter(|&i| parenthesized(i)).try_for_each(|_| f.write_str("("))?;
    write!(f, "{first}")?;
    for (i, (operator, right)) in steps.iter().enumerate() {
        write!(f, "{}{operator}", if parenthesized(i) { ")" } else { "" })?;
        at_least(f, operator_tightness(*operator).2, right)?;
    }
    Ok(())
}

fn pair(f: &mut Formatter<'_>, left: (u8, &Expression), sign: &str, right: (u8, &Expression)) -> fmt::Result {
    at_least(f, left.0, left.1)?;
    f.write_str(sign)?;
    at_least(f, right.0, right.1)
}

fn at_least(f: &mut Formatter<'_>, tight: u8, expression: &Expression) -> fmt::Result {
    if tightness(expression) < tight { write!(f, "({expression})") } else { write!(f, "{expression}") }
}

fn list(f: &mut Formatter<'_>, open: char, values: &[Expression], close: char) -> fmt::Result {
    write!(f, "{open}")?;
    for (i, value) in values.iter().enumerate() {
        write!(f, "{}{value}", if i > 0 { ", " } else { "" })?;
    }
    write!(f, "{close}")
}

fn tightness(expression: &Expression) -> u8 {
    match &expression.kind {
        ExpressionKind::If(..) => CHOICE,
        ExpressionKind::Or(..) => OR,
        ExpressionKind::And(..) => AND,
        ExpressionKind::Compare(..) => COMPARISON,
        ExpressionKind::Negate(_) | ExpressionKind::Not(_) => SIGNED,
        // In brackets where what follows might be read as part of its unit, or it as a divisor.
        ExpressionKind::Quantity(..) => SUM,
        ExpressionKind::Binary(operator, ..) => operator_tightness(*operator).0,
        ExpressionKind::Number(_)
        | ExpressionKind::Name(_)
        | ExpressionKind::Call(..)
        | ExpressionKind::Method(..)
        | ExpressionKind::Field(..)
        | ExpressionKind::Index(..)
        | ExpressionKind::Array(_) => VALUE,
    }
}

/// Of what the operator makes, and what its left and right operands need at least.
fn operator_tightness(operator: BinaryOperator) -> (u8, u8, u8) {
    match operator {
        BinaryOperator::Add | BinaryOperator::Sub => (SUM, SUM, PRODUCT),
        BinaryOperator::Mul | BinaryOperator::Div => (PRODUCT, PRODUCT, SIGNED),
        BinaryOperator::Pow => (POWER, VALUE, SIGNED),
    }
}

#[cfg(test)]
mod tests {
    use super::super::declaration;

    /// Printed as written.
    fn check(source: &str) {
        let printed = |source: &str| match declaration(source) {
            Ok(declaration) => declaration.to_string(),
            Err(errors) => panic!("{}", errors.render("test", source)),
        };
        assert_eq!(printed(source), source);
    }

    #[test]
    fn statements_are_printed_as_written() {
        check(
            "\
#![dimensionless]
/// A pendulum.
///
/// On a cart.
mechanism Pendulum {
    /// Its mass.
    param m[2]: kg = [1.0, 2e-3];
    coord q: rad;
    input tau: kg*m^2*s^-2;
    /// Shaken.
    prescribed heave[2]: m;
    prescribed sway: m = a*sin(w*t);
    fn f(x, y) = x*y;
    fn one() = 1;
    const n = 6;
    const w: m^(1/2) = 1;
    param free: 1;
    let mut x = 1;
    x = 2;
    let p[n];
    let mut r[n][2*n];
    r[0][n - 1] = x;
    for i in 0..2*n {
        kinetic += 1/2*m[i]*dt(q)^2;
        for j in 0.0..1 {
        }
        /// Each tip.
        output tip[i] = p[i], jacobian_rate;
        constraint rod[i]: p[i] = x;
        reaction joint[i] at r[i][0];
        if i == 0 && n != 2 {
            p[i] = 1;
        } else if i > 1 {
            p[i] = 2;
        } else {
            if n < 2 {
            }
        }
    }
    potential += 1;
    dissipation += 1;
    lagrangian += 1;
    force q += tau;
    force q[n + 1] += -tau;
    force at tip += [0, 0, tau];
    torque on link*rot_z(q) += [0, 0, tau];
    shape link*rot_z(1) += box([1, 2, w]);
    shape p[0] += mesh(\"../meshes/link 1.stl\", 1e-3);
    /// The rod's length is fixed.
    constraint rod: x^2 + y^2 = l^2;
    /// The tip.
    output tip = [q, 0, -q.x];
}
",
        );
    }

    #[test]
    fn expressions_have_the_parentheses_they_need() {
        for value in [
            "a + b*c",
            "(a + b)*c",
            "a - (b - c)",
            "a - b - c",
            "a/(b*c)",
            "a/b*c",
            "-x^2",
            "(-x)^2",
            "x^-2",
            "x^y^z",
            "(x^y)^z",
            "((a + b)*c + d)^2",
            "-(a + b)",
            "-a*b",
            "a*-b",
            "--a",
            "(a + b).norm()",
            "(-a)[0]",
            "1.5.sin()",
            "f()",
            "[[1, 2], [3, 4]][0].x.f(a, b)",
            "a*(b + c)",
            "a^(b*c)",
            "a^(b + c)",
            "1.sin()",
            "-(a*b)",
            "-(-a)^2",
            "if a < b { c } else { d }",
            "if a < b && c > d || !(e <= f) { c } else { d }",
            "if (a || b) && !(c >= d && e) { 1 } else { 2 }",
            "if a && (b && c) { 1 } else if b { 2 } else { 3 }",
            "1 + (if a < b + c { c } else { d })*2",
            "-(if a < b { c } else { d })",
            "(if a < b { c } else { d }).norm()",
            "f(if a < b { [c, 1] } else { d })",
            "a - (2 kg)",
            "(2.5 m*s^-2)*s/(3 t)",
            "-(20 deg)",
            "[1 m, (2 s)^2]",
        ] {
            check(&format!("mechanism A {{\n    let x = {value};\n}}\n"));
        }
        assert!(declaration("mechanism A { let x = 1.; }").unwrap().to_string().contains("x = 1.0;"));
    }

    #[test]
    fn long_sums_are_printed_without_recursion() {
        let sum = " + x*y".repeat(100_000);
        std::thread::Builder::new()
            .stack_size(2 << 20)
            .spawn(move || check(&format!("mechanism A {{\n    let x = 1{sum};\n}}\n")))
            .unwrap()
            .join()
            .unwrap();
    }
}
