//! Expressions: operators, and what stands behind values; conditions and numbers have files of their own.

use super::keyword::keyword;
use super::reader::{Parsed, Reader, Refused};
use super::syntax::{BinaryOperator, Comparison, Expression, ExpressionKind, Name, Span};
use crate::diagnostic::Code;

/// What stands between two operands.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Infix {
    Arithmetic(BinaryOperator),
    Comparison(Comparison),
    And,
    Or,
}

/// An operator whose right operand is still to come.
enum Pending {
    /// The sign, and where it stands.
    Negate(Span),
    /// `!`, and where it stands.
    Not(Span),
    /// The operator and its left operand.
    Infix(Infix, Box<Expression>),
}

impl Pending {
    /// Whether it takes the operand on its right before `next`, which stands behind that operand, does.
    fn precedes(&self, next: Option<Infix>) -> bool {
        let (tightness, leftward) = match self {
            Pending::Negate(_) | Pending::Not(_) => (6, true),
            Pending::Infix(operator, _) => (tightness(*operator), *operator != Infix::Arithmetic(BinaryOperator::Pow)),
        };
        next.is_none_or(|next| tightness > self::tightness(next) || tightness == self::tightness(next) && leftward)
    }

    fn apply(self, value: Box<Expression>) -> Box<Expression> {
        let end = value.span.end;
        let (kind, start) = match self {
            Pending::Negate(sign) => (ExpressionKind::Negate(value), sign.start),
            Pending::Not(sign) => (ExpressionKind::Not(value), sign.start),
            Pending::Infix(operator, left) => {
                let start = left.span.start;
                let kind = match operator {
                    Infix::Arithmetic(operator) => ExpressionKind::Binary(operator, left, value),
                    Infix::Comparison(comparison) => ExpressionKind::Compare(comparison, left, value),
                    Infix::And => ExpressionKind::And(left, value),
                    Infix::Or => ExpressionKind::Or(left, value),
                };
                (kind, start)
            }
        };
        Box::new(Expression { kind, span: start..end })
    }

    /// Whether it makes the expression deeper on the right.
    fn nests(&self) -> bool {
        matches!(self, Pending::Negate(_) | Pending::Not(_) | Pending::Infix(Infix::Arithmetic(BinaryOperator::Pow), _))
    }
}

/// The `/` or `^` right before an operand, signs aside.
fn divides(pending: &[Pending]) -> Option<BinaryOperator> {
    let mut operators = pending.iter().rev().skip_while(|operator| matches!(operator, Pending::Negate(_)));
    match operators.next()? {
        Pending::Infix(Infix::Arithmetic(operator @ (BinaryOperator::Div | BinaryOperator::Pow)), _) => Some(*operator),
        _ => None,
    }
}

/// How tightly an operator binds; a sign, at 6, binds more loosely than a power: `-x^2` is `-(x^2)`.
fn tightness(operator: Infix) -> u8 {
    match operator {
        Infix::Or => 1,
        Infix::And => 2,
        Infix::Comparison(_) => 3,
        Infix::Arithmetic(BinaryOperator::Add | BinaryOperator::Sub) => 4,
        Infix::Arithmetic(BinaryOperator::Mul | BinaryOperator::Div) => 5,
        Infix::Arithmetic(BinaryOperator::Pow) => 7,
    }
}

/// Values are boxed and refusals made in functions of their own, because debug builds have large stack frames and
/// these functions may call one another 256 levels deep.
impl Reader<'_> {
    /// As [`Reader::operators`], unboxed.
    pub(super) fn expression(&mut self) -> Parsed<Expression> {
        Ok(*self.operators()?)
    }

    /// `expression := all ("||" all)*`, `all := comparison ("&&" comparison)*`, `comparison := sum (compared sum)?`,
    /// `compared := "<" | "<=" | ">" | ">=" | "==" | "!="`, `sum := product (("+" | "-") product)*`,
    /// `product := signed (("*" | "/") signed)*`, `signed := ("-" | "!") signed | postfix ("^" signed)?`
    pub(super) fn operators(&mut self) -> Parsed<Box<Expression>> {
        // Every operator here binds more tightly than those before it.
        let mut pending: Vec<Pending> = Vec::new();
        let depth = self.depth;
        loop {
            self.signs(&mut pending)?;
            let mut value = self.postfix()?;
            let quantity = self.is_bare_quantity(&value);
            if quantity && let Some(operator) = divides(&pending) {
                return Err(self.quantity_behind(operator, &value));
            }
            let next = self.operator()?;
            if quantity && next == Some(Infix::Arithmetic(BinaryOperator::Pow)) {
                return Err(self.power_of_a_quantity(&value));
            }
            while let Some(operator) = pending.pop_if(|operator| operator.precedes(next)) {
                if let (Pending::Infix(Infix::Comparison(_), _), Some(Infix::Comparison(_))) = (&operator, next) {
                    return Err(self.chained_comparison());
                }
                self.depth -= usize::from(operator.nests());
                value = operator.apply(value);
            }
            match next {
                Some(operator) => {
                    self.push(&mut pending, Pending::Infix(operator, value))?;
                    // A chain of conditions is as deep as it is long, and is walked by recursion.
                    if matches!(operator, Infix::And | Infix::Or) {
                        self.enter(&(self.last - 2..self.last))?;
                    }
                }
                None => {
                    self.depth = depth;
                    return Ok(value);
                }
            }
        }
    }

    fn signs(&mut self, pending: &mut Vec<Pending>) -> Parsed<()> {
        loop {
            if let Some(sign) = self.eat("-") {
                self.push(pending, Pending::Negate(sign))?;
            } else if let Some(sign) = self.eat("!") {
                self.push(pending, Pending::Not(sign))?;
            } else {
                return Ok(());
            }
        }
    }

    fn push(&mut self, pending: &mut Vec<Pending>, operator: Pending) -> Parsed<()> {
        if operator.nests() {
            self.enter(&(self.last - 1..self.last))?;
        }
        pending.push(operator);
        Ok(())
    }

    /// The binary operator that stands next, if one does.
    fn operator(&mut self) -> Parsed<Option<Infix>> {
        let Some(sign) = self.sign() else { return Ok(None) };
        let operator = match sign {
            "+" => Infix::Arithmetic(BinaryOperator::Add),
            "-" => Infix::Arithmetic(BinaryOperator::Sub),
            "*" => Infix::Arithmetic(BinaryOperator::Mul),
            "/" => Infix::Arithmetic(BinaryOperator::Div),
            "^" => Infix::Arithmetic(BinaryOperator::Pow),
            "<" => Infix::Comparison(Comparison::Less),
            "<=" => Infix::Comparison(Comparison::LessEqual),
            ">" => Infix::Comparison(Comparison::Greater),
            ">=" => Infix::Comparison(Comparison::GreaterEqual),
            "==" => Infix::Comparison(Comparison::Equal),
            "!=" => Infix::Comparison(Comparison::NotEqual),
            "&&" => Infix::And,
            "||" => Infix::Or,
            "**" => return Err(self.double_star()),
            _ => return Ok(None),
        };
        self.eat(sign);
        Ok(Some(operator))
    }

    /// `postfix := primary ("." name | "." name "(" arguments ")" | "[" expression "]")*`
    fn postfix(&mut self) -> Parsed<Box<Expression>> {
        let (mut value, depth) = (self.primary()?, self.depth);
        while self.opens('[') || self.peek(".") {
            let here = self.last..self.last;
            value = if self.opens('[') {
                let index = self.bracketed()?;
                self.with(value, |value| ExpressionKind::Index(value, index))
            } else {
                self.member(value)?
            };
            self.enter(&here)?;
        }
        self.depth = depth;
        if self.opens('(') && !self.begins_line() {
            return Err(self.no_function());
        }
        Ok(value)
    }

    /// What `value` has become together with what was read behind it.
    fn with(&self, value: Box<Expression>, kind: impl FnOnce(Box<Expression>) -> ExpressionKind) -> Box<Expression> {
        let start = value.span.start;
        Box::new(Expression { kind: kind(value), span: start..self.last })
    }

    /// A `.` and behind it a component or a method.
    fn member(&mut self, value: Box<Expression>) -> Parsed<Box<Expression>> {
        self.eat(".");
        if self.number_at(self.at) {
            return Err(self.no_component());
        }
        let name = self.name("`.`")?;
        if self.opens('(') {
            let arguments = self.arguments()?;
            return Ok(self.with(value, |value| ExpressionKind::Method(value, name, arguments)));
        }
        if let ExpressionKind::Number(number) = &value.kind {
            let message = format!("a number has no component `{}`", name.text);
            return Err(self.refuse(
                Code::NumberForm,
                name.span,
                message,
                format!("write a digit behind the point: `{number}.0`"),
            ));
        }
        Ok(self.with(value, |value| ExpressionKind::Field(value, name)))
    }

    /// `primary := number | name | name "(" arguments ")" | "[" arguments "]" | "(" expression ")" | conditional`
    fn primary(&mut self) -> Parsed<Box<Expression>> {
        if self.opens('(') {
            self.parenthesized()
        } else if self.opens('[') {
            let start = self.next().start;
            let kind = ExpressionKind::Array(self.arguments()?);
            Ok(Box::new(Expression { kind, span: start..self.last }))
        } else if self.word().is_some_and(|text| text == "if") {
            self.conditional()
        } else if self.word().is_some() {
            let name = self.value_name()?;
            if self.opens('(') && !self.begins_line() {
                self.call(name)
            } else {
                Ok(Box::new(Expression { kind: ExpressionKind::Name(name.text), span: name.span }))
            }
        } else {
            self.number()
        }
    }

    fn call(&mut self, name: Name) -> Parsed<Box<Expression>> {
        let (start, arguments) = (name.span.start, self.arguments()?);
        Ok(Box::new(Expression { kind: ExpressionKind::Call(name, arguments), span: start..self.last }))
    }

    /// Its place includes the parentheses.
    fn parenthesized(&mut self) -> Parsed<Box<Expression>> {
        let start = self.next().start;
        self.open()?;
        let mut value = self.operators()?;
        if !self.is_at_end() {
            return Err(self.stray());
        }
        self.close();
        value.span = start..self.last;
        Ok(value)
    }

    /// `arguments := (expression ("," expression)* ","?)?`, between brackets of any kind.
    pub(super) fn arguments(&mut self) -> Parsed<Vec<Expression>> {
        self.open()?;
        let mut values = Vec::new();
        while !self.is_at_end() {
            values.push(self.expression()?);
            if !self.is_at_end() && self.eat(",").is_none() {
                return Err(self.stray());
            }
        }
        self.close();
        Ok(values)
    }

    /// `("[" expression "]")*`: the indices of an element, or the lengths of an array.
    pub(super) fn indices(&mut self) -> Parsed<Vec<Expression>> {
        let mut indices = Vec::new();
        while let Some(index) = self.index()? {
            indices.push(index);
        }
        Ok(indices)
    }

    /// `("[" expression "]")?`: an array's length, or an index.
    pub(super) fn index(&mut self) -> Parsed<Option<Expression>> {
        match self.opens('[') {
            true => Ok(Some(*self.bracketed()?)),
            false => Ok(None),
        }
    }

    /// `"[" expression "]"`
    fn bracketed(&mut self) -> Parsed<Box<Expression>> {
        self.open()?;
        let index = self.operators()?;
        if self.peek(",") {
            let span = self.next();
            return Err(self.refuse(
                Code::IndexForm,
                span,
                "an index is one number",
                "write `a[i][j]` for an element of a matrix",
            ));
        }
        if !self.is_at_end() {
            return Err(self.stray());
        }
        self.close();
        Ok(index)
    }

    pub(super) fn double_star(&mut self) -> Refused {
        let span = self.next();
        self.refuse(Code::ForeignOperator, span, "`**` is not an operator", "write `^` for a power: `x^2`")
    }

    /// A name that is not a keyword.
    fn value_name(&mut self) -> Parsed<Name> {
        let name = self.name("this")?;
        match keyword(&name.text) {
            Some(what) => {
                let message = format!("`{}` is {what}, not a value", name.text);
                let help = format!("names of your own are others, such as `{}_`", name.text);
                Err(self.refuse(Code::ReservedName, name.span, message, help))
            }
            None => Ok(name),
        }
    }

    fn no_function(&mut self) -> Refused {
        let here = self.next();
        self.refuse(
            Code::MissingOperator,
            here,
            "only a function's name can stand before `(`",
            "write `*` for a product",
        )
    }

    fn no_component(&mut self) -> Refused {
        let (here, found) = (self.next(), self.literal().unwrap_or_default());
        let help = "write `[0]` for the first component, `[1]` for the second";
        self.refuse(Code::NoComponent, here, format!("`.{found}` is not a component"), help)
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, report, statement};
    use super::super::declaration;
    use super::super::syntax::StatementKind;

    fn expression(text: &str) -> String {
        match statement(&format!("let x = {text};")) {
            StatementKind::Let { value, .. } => prefix(&value),
            other => panic!("{other:?}"),
        }
    }

    /// Runs `test` on a thread with the stack of a test thread, whatever `RUST_MIN_STACK` says.
    fn in_two_mebibytes(test: impl FnOnce() + Send + 'static) {
        std::thread::Builder::new().stack_size(2 << 20).spawn(test).unwrap().join().unwrap();
    }

    #[test]
    fn operators_bind_as_in_textbooks() {
        let check = |text: &str, expected: &str| assert_eq!(expression(text), expected, "{text}");
        check("a + b * c", "(+ a (* b c))");
        check("a - b - c + d", "(+ (- (- a b) c) d)");
        check("a / b / c * d", "(* (/ (/ a b) c) d)");
        check("1/2 * m * v^2", "(* (* (/ 1 2) m) (^ v 2))");
        check("-x^2", "(neg (^ x 2))");
        check("(-x)^2", "(^ (neg x) 2)");
        check("x^-2", "(^ x (neg 2))");
        check("x^-y^z", "(^ x (neg (^ y z)))");
        check("a^b^c", "(^ a (^ b c))");
        check("(a^b)^c", "(^ (^ a b) c)");
        check("-a * b", "(* (neg a) b)");
        check("a * -b", "(* a (neg b))");
        check("a - -b", "(- a (neg b))");
        check("a--b", "(- a (neg b))");
        check("- -a", "(neg (neg a))");
        check("2^x.y", "(^ 2 x.y)");
        check("-q[0]^2", "(neg (^ q[0] 2))");
        check("(a + b) * c", "(* (+ a b) c)");
    }

    #[test]
    fn reads_what_stands_behind_values() {
        let check = |text: &str, expected: &str| assert_eq!(expression(text), expected, "{text}");
        check("v.z", "v.z");
        check("x.y.z", "x.y.z");
        check("a.cross(b).norm()", "a.cross(b).norm()");
        check("a.dot(b, c,)", "a.dot(b c)");
        check("m[1][2]", "m[1][2]");
        check("[a, b][0]", "[a b][0]");
        check("[[1, 0], [0, 1],]", "[[1 0] [0 1]]");
        check("[]", "[]");
        check("f()", "f()");
        check("f(a)", "f(a)");
        check("dt(dt(x))", "dt(dt(x))");
        check("(a + b).norm()", "(+ a b).norm()");
        check("t + world.x + m", "(+ (+ t world.x) m)");
    }

    #[test]
    fn values_are_formulas() {
        let check = |value: &str, expected: &str| refused(&format!("let x = {value};"), expected);
        let value = "a value is a number, a name, a call `f(x)`, an array `[x, y, z]` or `( … )`";
        check("a b", "b: an operator is missing before `b`; write `*` for a product");
        check("2 (a)", "(: only a function's name can stand before `(`; write `*` for a product");
        check("a ** 2", "**: `**` is not an operator; write `^` for a power: `x^2`");
        check("a * * 2", "*: `**` is not an operator; write `^` for a power: `x^2`");
        check("+a", "+: a `+` before a value says nothing; leave it out");
        check("a + + b", "+: a `+` before a value says nothing; leave it out");
        check("a +", &format!(";: expected a value, found `;`; {value}"));
        check("f(a", "(: this `(` is not closed; write `)` before the `;` on line 2");
        check("f(, a)", &format!(",: expected a value, found `,`; {value}"));
        check("()", &format!("): expected a value, found `)`; {value}"));
        check("{ a }", &format!("{{: expected a value, found `{{`; {value}"));
        check("(a, b)", ",: `,` cannot stand here; write a vector as `[x, y, z]`");
        check("[0; 3]", ";: `;` cannot stand within brackets; write `,` between values");
        check("[a b]", "b: an operator is missing before `b`; write `*` for a product, `,` between two values");
        check("cos a", "a: the argument of `cos` stands in brackets; write `cos(a)`");
        check("1,5 + a", ",: a decimal point is a `.`; write `1.5`");
        check("a % b", "%: `%` is not an operator; the operators are `+`, `-`, `*`, `/` and `^`");
        check("a & b", "&: `&` is not an operator; write `&&` for \"and\", `||` for \"or\"");
        check("a <", &format!(";: expected a value, found `;`; {value}"));
        check("a = b", "=: `=` cannot stand behind a value; end the statement before with `;`");
        check("a..b", "..: a range stands behind `in` only; write `for i in 0..6 { … }`");
        check("2 : m", ":: `:` and a unit belong to declarations; a number has its unit right behind it: `2 m`");
        check("a {}", "{: `{` cannot stand behind a value; end the statement with `;`");
        check("if a", ";: expected a `{`, found `;`; write `if x < 0 { a } else { b }`");
        check("a if b", "if: an operator is missing before `if`; write `*` for a product");
        check(
            "force",
            "force: `force` is a keyword of the language, not a value; names of your own are others, such as `force_`",
        );
        check("q.0", "0: `.0` is not a component; write `[0]` for the first component, `[1]` for the second");
        check("q.", ";: expected a name after `.`, found `;`; a name begins with a letter");
        check("1.e5", "e5: a number has no component `e5`; write a digit behind the point: `1.0`");
        check(".5", ".: a number begins with a digit; write `0.5`");
        check("1.0f64", "1.0f64: a number has no type; write `1.0`");
        check("2x", "2x: `2x` is neither a number nor a name; write `2*x` for a product; `x` is not a unit");
        check("2m_m", "2m_m: `2m_m` is neither a number nor a name; write `2*m_m` for a product; `m_m` is not a unit");
        check("3m_1", "3m_1: `3m_1` is neither a number nor a name; write `3*m_1` for a product; `m_1` is not a unit");
        check(
            "1_0_m",
            "1_0_m: `1_0_m` is neither a number nor a name; write `10*_m` for a product; `_m` is not a unit",
        );
        check("1e_5", "1e_5: `1e_5` is neither a number nor a name; write `1*e_5` for a product; `e_5` is not a unit");
        check("1_f64", "1_f64: a number has no type; write `1`");
        check("0x10", "0x10: `0x10` is not a decimal number; write it with digits 0 to 9");
        check("1e400", "1e400: `1e400` is beyond the range of an `f64`; choose other units");
        check("1e-400", "1e-400: `1e-400` is beyond the range of an `f64`; choose other units");
        check("r#a", "r#a: `r#a` is not a name; write `a`");
        check("x'", "': `'` has no meaning in a mechanism; write `dt(x)` for the time derivative of `x`");
    }

    #[test]
    fn nesting_is_limited() {
        in_two_mebibytes(|| {
            let kinds = [
                ("(", "x", ")"),
                ("[", "x", "]"),
                ("f(", "x", ")"),
                ("-", "x", ""),
                ("- ", "x", ""),
                ("x^", "x", ""),
                ("x^-", "x", ""),
                ("-(", "x", ")"),
                ("a + b*x^(", "x", ")"),
                ("a[", "x", "]"),
                ("", "x", ".a"),
                ("", "x", ".f()"),
                ("", "x", "[1]"),
                ("x.f(", "1", ")"),
                ("{", "x", "}"),
            ];
            for (before, middle, after) in kinds {
                let nested = |n| format!("mechanism A {{ let x = {}{middle}{}; }}", before.repeat(n), after.repeat(n));
                if before != "{" {
                    assert_eq!(report(&nested(100)), [""; 0], "{before}");
                }
                for n in [255, 256, 257, 1000, 100_000] {
                    let _ = report(&nested(n));
                }
                let errors = report(&nested(1000));
                assert!(before == "{" || errors[0].contains("nested deeper than 256 levels"), "{before} {errors:?}");
            }
            let loops = |n: usize| format!("mechanism A {{ {} {} }}", "for i in 0..1 { ".repeat(n), "}".repeat(n));
            assert_eq!(report(&loops(255)), [""; 0]);
            assert_eq!(
                report(&loops(256)),
                ["{: this is nested deeper than 256 levels; name the inner values with `let`"]
            );
            let units = |n: usize| format!("mechanism A {{ coord x: {}m{}; }}", "1/(".repeat(n), ")".repeat(n));
            assert_eq!(report(&units(255)), [""; 0]);
            assert_eq!(report(&units(100_000)).len(), 1);
        });
    }

    #[test]
    fn the_deepest_expressions_are_read() {
        in_two_mebibytes(|| {
            // One level is the mechanism's braces.
            for (before, after) in [("(", ")"), ("-", ""), ("x^", ""), ("[", "]"), ("a + b*f(", ")")] {
                let nested = |n| format!("mechanism A {{ let x = {}x{}; }}", before.repeat(n), after.repeat(n));
                assert_eq!(report(&nested(255)), [""; 0], "{before}");
                assert_eq!(report(&nested(256)).len(), 1, "{before}");
            }
        });
    }

    #[test]
    fn long_sums_need_no_stack() {
        in_two_mebibytes(|| {
            for term in [" + x", " - x", " * x", " / x", " + 2 * x^2"] {
                let source = format!("mechanism A {{ let y = x{}; }}", term.repeat(100_000));
                let declaration = declaration(&source).unwrap();
                let StatementKind::Let { value, .. } = &declaration.statements[0].kind else { panic!() };
                assert_eq!(value.left_spine().1.len(), 100_000);
                assert_eq!(value.span, 22..source.len() - 3);
            }
            let source = format!("mechanism A {{ let y = x{} x; }}", " + x".repeat(100_000));
            assert_eq!(report(&source).len(), 1);
        });
    }
}
