//! Conditions: `if … { … } else { … }` as a value and as a statement, and what is no comparison.

use super::reader::{Parsed, Reader, Refused};
use super::syntax::{Expression, ExpressionKind, Statement, StatementKind};
use crate::diagnostic::Code;

const FORM: &str = "write `if x < 0 { a } else { b }`";

impl Reader<'_> {
    /// `conditional := "if" expression "{" expression "}" "else" (conditional | "{" expression "}")`
    pub(super) fn conditional(&mut self) -> Parsed<Box<Expression>> {
        let here = self.next();
        self.enter(&here)?;
        self.eat_word("if");
        let condition = self.operators()?;
        let yes = self.branch()?;
        if !self.eat_word("else") {
            return Err(self.no_else());
        }
        let no = match self.word() {
            Some("if") => self.conditional()?,
            _ => self.branch()?,
        };
        self.depth -= 1;
        Ok(Box::new(Expression { kind: ExpressionKind::If(condition, yes, no), span: here.start..self.last }))
    }

    /// `choice := "if" expression block ("else" "if" expression block)* ("else" block)?`
    pub(super) fn choice(&mut self) -> Parsed<Statement> {
        let first = self.next().start;
        let (mut branches, mut otherwise) = (Vec::new(), Vec::new());
        while self.eat_word("if") {
            let condition = self.expression()?;
            branches.push((condition, self.block("write `if n == 1 { … } else { … }`")?));
            if !self.eat_word("else") {
                break;
            }
            if self.word().is_none_or(|text| text != "if") {
                otherwise = self.block("write `if n == 1 { … } else { … }`")?;
                break;
            }
        }
        Ok(Statement { kind: StatementKind::If { branches, otherwise }, span: first..self.last })
    }

    /// `block := "{" statement* "}"`
    fn block(&mut self, form: &str) -> Parsed<Vec<Statement>> {
        if !self.opens('{') {
            return Err(match self.sign() {
                Some("&" | "|" | "=" | "=>") => self.stray_in_condition(),
                _ => self.unexpected("a `{`", form),
            });
        }
        self.open()?;
        let statements = self.statements();
        self.close();
        Ok(statements)
    }

    /// `"{" expression "}"`
    fn branch(&mut self) -> Parsed<Box<Expression>> {
        if !self.opens('{') {
            return Err(self.no_branch());
        }
        self.open()?;
        let value = self.operators()?;
        if !self.is_at_end() {
            return Err(self.stray_in_branch());
        }
        self.close();
        Ok(value)
    }

    fn no_else(&mut self) -> Refused {
        self.unexpected("`else`", "a value is needed on both sides: `if x < 0 { a } else { b }`")
    }

    /// Between a condition and the braces that it needs.
    fn no_branch(&mut self) -> Refused {
        match self.sign() {
            Some("&" | "|" | "=" | "=>") => self.stray_in_condition(),
            _ => self.unexpected("a `{`", FORM),
        }
    }

    fn stray_in_condition(&mut self) -> Refused {
        if self.peek("=") {
            let here = self.next();
            return self.refuse(
                Code::ConditionForm,
                here,
                "`=` is not a comparison",
                "write `==`, of constants, `<`, `<=`, `>` or `>=`",
            );
        }
        self.stray()
    }

    fn stray_in_branch(&mut self) -> Refused {
        if self.peek(";") {
            let here = self.next();
            return self.refuse(
                Code::ConditionForm,
                here,
                "a branch is one value",
                "leave the `;` out: `if x < 0 { a } else { b }`",
            );
        }
        self.stray()
    }

    pub(super) fn chained_comparison(&mut self) -> Refused {
        let here = self.last - 1..self.last;
        self.refuse(Code::ConditionForm, here, "a comparison has two sides", "write `a < b && b < c`")
    }
}

/// Message and help for a sign that looks like a condition.
pub(super) fn no_condition(sign: &str) -> (String, &'static str) {
    let two = "write `&&` for \"and\", `||` for \"or\"";
    match sign {
        "=>" => ("`=>` is not a comparison".to_string(), "write `>=`"),
        _ => (format!("`{sign}` is not an operator"), two),
    }
}

#[cfg(test)]
mod tests {
    use super::super::check::{prefix, refused, report, statement};
    use super::super::syntax::StatementKind;

    #[test]
    fn conditions_bind_as_in_rust() {
        let check = |text: &str, expected: &str| match statement(&format!("let x = {text};")) {
            StatementKind::Let { value, .. } => assert_eq!(prefix(&value), expected, "{text}"),
            other => panic!("{other:?}"),
        };
        check("if a < b { c } else { d }", "(if (< a b) c d)");
        check("if a<-b{c}else{d}", "(if (< a (neg b)) c d)");
        check(
            "if a + 1 <= b*2 && c > d || e >= f { 1 } else { 2 }",
            "(if (or (and (<= (+ a 1) (* b 2)) (> c d)) (>= e f)) 1 2)",
        );
        check("if a < b || c < d && e < f { 1 } else { 2 }", "(if (or (< a b) (and (< c d) (< e f))) 1 2)");
        check("if !(a < b) && !!(c < d) { 1 } else { 2 }", "(if (and (not (< a b)) (not (not (< c d)))) 1 2)");
        check("if a < 0 { 1 } else if a < 1 { 2 } else { 3 }", "(if (< a 0) 1 (if (< a 1) 2 3))");
        check("if (a < b) { [c, d] } else { f(e) }", "(if (< a b) [c d] f(e))");
        check("2 * if a < b { c } else { d } + 1", "(+ (* 2 (if (< a b) c d)) 1)");
        check("if a == b || c != d { 1 } else { 2 }", "(if (or (== a b) (!= c d)) 1 2)");
        check("if a < b { v } else { w }.norm()", "(if (< a b) v w).norm()");
        check("f(if a < b { c } else { d }, e)", "f((if (< a b) c d) e)");
        check("-if a < b { c } else { d }", "(neg (if (< a b) c d))");
    }

    #[test]
    fn wrong_conditions() {
        let check = |value: &str, expected: &str| refused(&format!("let x = {value};"), expected);
        let equals = "=: `=` is not a comparison; write `==`, of constants, `<`, `<=`, `>` or `>=`";
        check("if a = b { c } else { d }", equals);
        refused("if a = b { kinetic += c; }", equals);
        check("if a => b { c } else { d }", "=>: `=>` is not a comparison; write `>=`");
        check(
            "if a < b & c < d { c } else { d }",
            "&: `&` is not an operator; write `&&` for \"and\", `||` for \"or\"",
        );
        check("if a < b < c { c } else { d }", "<: a comparison has two sides; write `a < b && b < c`");
        check("if a < b c else d", "c: expected a `{`, found `c`; write `if x < 0 { a } else { b }`");
        let both = "a value is needed on both sides: `if x < 0 { a } else { b }`";
        check("if a < b { c }", &format!(";: expected `else`, found `;`; {both}"));
        check("if a < b { c; } else { d }", ";: a branch is one value; leave the `;` out: `if x < 0 { a } else { b }`");
        check("if a < b { c d } else { d }", "d: an operator is missing before `d`; write `*` for a product");
        check(
            "else { a }",
            "else: `else` is a keyword of the language, not a value; names of your own are others, such as `else_`",
        );
        // The rest of a statement says nothing of its own.
        check("if a < b { c } else { d ! }", "!: `!` is not an operator; the operators are `+`, `-`, `*`, `/` and `^`");
        check("if a ? b { c } else { d }", "?: expected a `{`, found `?`; write `if x < 0 { a } else { b }`");
    }

    #[test]
    fn statements_are_chosen() {
        let StatementKind::If { branches, otherwise } = statement(
            "if i == 0 { kinetic += x; let y = 1; } else if i < n { } else { if a < b { } output p[i] = x; }",
        ) else {
            panic!()
        };
        let conditions: Vec<_> = branches.iter().map(|(c, body)| (prefix(c), body.len())).collect();
        assert_eq!(conditions, [("(== i 0)".to_string(), 2), ("(< i n)".to_string(), 0)]);
        assert_eq!(otherwise.len(), 2);
        let form = "write `if n == 1 { … } else { … }`";
        refused("if a < b kinetic += x;", &format!("kinetic: expected a `{{`, found `kinetic`; {form}"));
        refused("if a < b { } else kinetic += x;", &format!("kinetic: expected a `{{`, found `kinetic`; {form}"));
        refused("else { }", "else: an `else` without its `if`; write `if n == 1 { … } else { … }`");
        refused(
            "if a < b { x; }",
            "x: `x` begins no statement; a statement begins with `param`, `coord`, `input`, \
                 `prescribed`, `const`, `fn`, `let`, `kinetic`, `potential`, `dissipation`, `lagrangian`, `force`, `torque`, \
                 `gravity`, `reaction`, `constraint`, `output`, `shape`, `part`, `for` or `if`, or is an assignment `x = …;`",
        );
        // Both are statements of their own.
        let source = "mechanism A { if a < b { } for i in 0..2 { } if c < d { } let x = 1; }";
        assert_eq!(super::super::declaration(source).unwrap().statements.len(), 4);
    }

    #[test]
    fn conditions_are_not_too_deep() {
        let checked = move || {
            let kinds = [
                ("if a < b { 1 } else ", "{ 2 }"),
                ("if a < b { 1 } else { ", "}"),
                ("if ", " < b { 1 } else { 2 }"),
                ("!", ""),
                ("", " && a"),
                ("a || ", ""),
            ];
            for (before, after) in kinds {
                let middle = if after == "{ 2 }" { "" } else { "a" };
                for n in [50, 84, 100, 254, 255, 256, 257, 1000, 50_000] {
                    let after = if after == "{ 2 }" { after.to_string() } else { after.repeat(n) };
                    let source = format!("mechanism A {{ let x = {}{middle}{after}; }}", before.repeat(n));
                    let found = report(&source);
                    assert!(n > 84 || found.is_empty(), "{before} {n} {found:?}");
                    let one = found.len() == 1 && found[0].contains("nested deeper");
                    assert!(n < 257 || one, "{before} {n} {:?}", &found[..found.len().min(3)]);
                }
            }
        };
        std::thread::Builder::new().stack_size(2 << 20).spawn(checked).unwrap().join().unwrap();
    }
}
