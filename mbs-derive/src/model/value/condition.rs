//! `if … { … } else { … }`: each branch is a value of its own, and the condition chooses between them.
//!
//! What is known at build time is decided at build time, and the other branch is not looked at: loops may ask for their
//! turn. Known is as well how things compare that are equal for all values, as `l/l` and 1: rounding must not choose
//! between branches, one way here and the other way there.

use crate::diagnostic::Code;
use crate::expr::{Condition, Expr, Function, Id, Matrix, Node, Vector};
use crate::model::lagrangian::Choice;
use crate::model::value::evaluate::{Argument, Refused, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::model::value::{Free, Point, Scalar, Shape, Tensor, Value, shared};
use crate::parse::syntax::{Comparison, Expression, ExpressionKind, Span};

/// Whether a condition holds.
#[derive(Clone, Copy)]
enum Truth<'g> {
    Known(bool),
    Open(Condition<'g>),
}

impl<'d, 'g> Resolver<'d, 'g> {
    #[inline(never)]
    pub(in crate::model) fn conditional(
        &mut self,
        condition: &Expression,
        yes: &Expression,
        no: &Expression,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let place = &condition.span;
        match self.condition(condition) {
            Ok(Truth::Known(true)) => self.expression(yes),
            Ok(Truth::Known(false)) => self.expression(no),
            Ok(Truth::Open(condition)) => {
                let (yes, no) = (self.argument(yes), self.argument(no));
                let (yes, no, before) = (yes?, no?, self.graph.len());
                let value = self.chosen(condition, &yes, &no, span)?;
                self.note_choices(before, place);
                Ok(value)
            }
            Err(Refused) => {
                let _ = (self.expression(yes), self.expression(no));
                Err(Refused)
            }
        }
    }

    /// Whether a condition holds, of what is known at build time.
    pub(in crate::model) fn decided(&mut self, condition: &Expression) -> Resolved<bool> {
        match self.condition(condition)? {
            Truth::Known(holds) => Ok(holds),
            Truth::Open(open) => {
                let help = match self.known.facts.dependence(open.0).moves() {
                    false => "a parameter may change at run time: declare it as `const name = …;`",
                    true => "while it moves a value is chosen: `let f = if a < b { … } else { … };`, `kinetic += if …`",
                };
                let message = "statements are chosen at build time, and this is not known then";
                Err(self.refuse(Code::ChosenAtBuildTime, &condition.span, message, help))
            }
        }
    }

    /// Notes where the choices stand that have been made since the graph had `before` nodes.
    fn note_choices(&mut self, before: usize, condition: &Span) {
        let place = self.report.place(condition).0;
        for index in before..self.graph.len() {
            let id = Id(index as u32);
            if matches!(self.graph.node(id), Node::Select(..)) {
                let choice = Choice { place: place.clone(), is_condition: true };
                self.lagrangian.choices.entry(id).or_insert(choice);
            }
        }
    }

    /// A condition where a value is wanted.
    pub(in crate::model) fn no_value(&mut self, expression: &Expression) -> Refused {
        let help = "conditions stand behind `if`: `if x < 0 { a } else { b }`";
        self.refuse(Code::ConditionAsValue, &expression.span, "a condition is not a value", help)
    }
}

// ---- conditions

impl<'d, 'g> Resolver<'d, 'g> {
    fn condition(&mut self, expression: &Expression) -> Resolved<Truth<'g>> {
        self.deeper(&expression.span)?;
        let truth = self.truth(expression);
        self.effort.depth -= 1;
        truth
    }

    fn truth(&mut self, expression: &Expression) -> Resolved<Truth<'g>> {
        match &expression.kind {
            ExpressionKind::Compare(comparison, left, right) => {
                self.comparison(*comparison, left, right, &expression.span)
            }
            ExpressionKind::And(a, b) => match self.condition(a) {
                Ok(Truth::Known(false)) => Ok(Truth::Known(false)),
                a => match (a, self.condition(b)?) {
                    (Ok(Truth::Known(_)), b) => Ok(b),
                    (a, Truth::Known(true)) => a,
                    (a, Truth::Known(false)) => a.map(|_| Truth::Known(false)),
                    (Ok(Truth::Open(a)), Truth::Open(b)) => Ok(Truth::Open(a.and(b))),
                    (Err(refused), _) => Err(refused),
                },
            },
            ExpressionKind::Or(a, b) => match self.condition(a) {
                Ok(Truth::Known(true)) => Ok(Truth::Known(true)),
                a => match (a, self.condition(b)?) {
                    (Ok(Truth::Known(_)), b) => Ok(b),
                    (a, Truth::Known(false)) => a,
                    (a, Truth::Known(true)) => a.map(|_| Truth::Known(true)),
                    (Ok(Truth::Open(a)), Truth::Open(b)) => Ok(Truth::Open(a.or(b))),
                    (Err(refused), _) => Err(refused),
                },
            },
            ExpressionKind::Not(a) => Ok(match self.condition(a)? {
                Truth::Known(known) => Truth::Known(!known),
                Truth::Open(condition) => Truth::Open(condition.not()),
            }),
            _ => {
                let value = self.argument(expression)?;
                let message = format!("a condition compares two numbers, this is {}", value.value.described());
                let help = "write `a < b`, `a <= b`, `a > b` or `a >= b`; of constants `a == b` or `a != b` as well";
                Err(self.refuse(Code::ConditionAsValue, &expression.span, message, help))
            }
        }
    }

    #[inline(never)]
    fn comparison(
        &mut self,
        comparison: Comparison,
        left: &Expression,
        right: &Expression,
        span: &Span,
    ) -> Resolved<Truth<'g>> {
        let (left, right) = (self.argument(left), self.argument(right));
        let (left, right) = (left?, right?);
        let (a, b) = (self.scalar(&left), self.scalar(&right));
        let (a, b) = (a?, b?);
        if shared(a.fit(), b.fit()).is_none() {
            let (a, b) = (in_words(a.dimension), in_words(b.dimension));
            let message = format!("a comparison needs equal dimensions, these are {a} and {b}");
            return Err(self.refuse(Code::UnequalDimensions, span, message, ""));
        }
        match comparison {
            Comparison::Less => Ok(self.less(a.expr, b.expr)),
            Comparison::LessEqual => Ok(self.less_equal(a.expr, b.expr)),
            Comparison::Greater => Ok(self.less(b.expr, a.expr)),
            Comparison::GreaterEqual => Ok(self.less_equal(b.expr, a.expr)),
            Comparison::Equal => self.equal(a.expr, b.expr, span).map(Truth::Known),
            Comparison::NotEqual => self.equal(a.expr, b.expr, span).map(|equal| Truth::Known(!equal)),
        }
    }

    /// Of constants: what changes is equal for no time, or at all times but none.
    fn equal(&mut self, a: Expr<'g>, b: Expr<'g>, span: &Span) -> Resolved<bool> {
        if let (Some(a), Some(b)) = (self.known.facts.constant(a), self.known.facts.constant(b)) {
            return Ok((a + -b).is_zero());
        }
        let dependence = self.known.facts.dependence(a).or(self.known.facts.dependence(b));
        if dependence.moves() {
            let message = "`==` and `!=` compare constants: in a motion they hold for no time, or for all but none";
            return Err(self.refuse(
                Code::EqualityInMotion,
                span,
                message,
                "write `<`, `<=`, `>` or `>=`; an equation is a `constraint`",
            ));
        }
        let message = "`==` and `!=` compare constants, what parameters are is known at run time only";
        Err(self.refuse(
            Code::EqualityInMotion,
            span,
            message,
            "declare it as `const name = …;`, or write `<`, `<=`, `>` or `>=`",
        ))
    }

    fn less(&mut self, a: Expr<'g>, b: Expr<'g>) -> Truth<'g> {
        match (self.known.facts.constant(a), self.known.facts.constant(b)) {
            (Some(a), Some(b)) => Truth::Known((a + -b).is_negative()),
            _ if self.known.facts.are_equal(a, b) => Truth::Known(false),
            _ => Truth::Open(a.less(b)),
        }
    }

    /// `abs` or `signum`. Of what is zero for all values they are zero: it is at the corner everywhere, and rounding
    /// must not choose a sign.
    pub(super) fn cornered(&mut self, function: Function, x: Expr<'g>) -> Expr<'g> {
        let zero = self.graph.integer(0);
        if self.known.facts.are_equal(x, zero) { zero } else { x.call(function) }
    }

    fn less_equal(&mut self, a: Expr<'g>, b: Expr<'g>) -> Truth<'g> {
        match (self.known.facts.constant(a), self.known.facts.constant(b)) {
            (Some(a), Some(b)) => Truth::Known(!(b + -a).is_negative()),
            _ if self.known.facts.are_equal(a, b) => Truth::Known(true),
            _ => Truth::Open(a.less_equal(b)),
        }
    }
}

// ---- choices

impl<'d, 'g> Resolver<'d, 'g> {
    /// Component by component, in axes that both share.
    fn chosen(
        &mut self,
        condition: Condition<'g>,
        yes: &Argument<'g>,
        no: &Argument<'g>,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        match (yes.value.shape(), no.value.shape()) {
            (Shape::Number, Shape::Number) => {
                let (a, b) = (self.scalar(yes)?, self.scalar(no)?);
                let dimension = self.common_dimension(a.fit(), b.fit(), span)?;
                Ok(Value::Scalar(Scalar::new(self.select(condition, a.expr, b.expr), dimension)))
            }
            (Shape::Vector, Shape::Vector) => self.chosen_vector(condition, yes, no, span),
            (Shape::Matrix, Shape::Matrix) => {
                let (a, b) = (self.matrix_in_world(yes)?, self.matrix_in_world(no)?);
                let dimension = self.common_dimension(a.fit(), b.fit(), span)?;
                let entry = |i: usize, j: usize| self.select(condition, a.entries.0[i][j], b.entries.0[i][j]);
                let entries = Matrix([0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j))));
                Ok(Value::matrix(Tensor::plain(entries, dimension)))
            }
            (Shape::Array, Shape::Array) => {
                let (a, b) = (self.elements(yes)?, self.elements(no)?);
                if a.len() != b.len() {
                    return Err(self.different(yes, no, span));
                }
                let of = |value: Value<'g>| Argument { value, span: span.clone() };
                let pairs = a.into_iter().zip(b).map(|(a, b)| (of(a), of(b)));
                let values: Resolved<Vec<_>> = pairs.map(|(a, b)| self.chosen(condition, &a, &b, span)).collect();
                self.array(values?, span)
            }
            (Shape::Pose, Shape::Pose) => {
                let help = "choose between angles and lengths, and make the pose of them";
                Err(self.refuse(Code::BranchShapes, span, "a pose cannot depend on a condition", help))
            }
            _ => Err(self.different(yes, no, span)),
        }
    }

    /// Points of one frame stay points of it.
    fn chosen_vector(
        &mut self,
        condition: Condition<'g>,
        yes: &Argument<'g>,
        no: &Argument<'g>,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let choice =
            |a: Vector<'g>, b: Vector<'g>| Vector([0, 1, 2].map(|i| a.0[i].graph().select(condition, a.0[i], b.0[i])));
        if let (Value::Point(a), Value::Point(b)) = (&yes.value, &no.value)
            && a.frame == b.frame
        {
            return Ok(Value::Point(Point { coordinates: choice(a.coordinates, b.coordinates), frame: a.frame }));
        }
        let (a, b) = (self.vector(yes)?, self.vector(no)?);
        let dimension = self.common_dimension(a.fit(), b.fit(), span)?;
        let (a, b, frame) = self.aligned(a, b);
        Ok(Value::Vector(Free { components: choice(a, b), frame, dimension }))
    }

    fn select(&self, condition: Condition<'g>, yes: Expr<'g>, no: Expr<'g>) -> Expr<'g> {
        if yes == no { yes } else { self.graph.select(condition, yes, no) }
    }

    fn common_dimension(
        &mut self,
        a: (crate::model::value::dimension::Dimension, bool),
        b: (crate::model::value::dimension::Dimension, bool),
        span: &Span,
    ) -> Resolved<crate::model::value::dimension::Dimension> {
        shared(a, b).ok_or_else(|| {
            let message =
                format!("both branches need equal dimensions, these are {} and {}", in_words(a.0), in_words(b.0));
            self.refuse(Code::UnequalDimensions, span, message, "")
        })
    }

    fn different(&mut self, yes: &Argument<'g>, no: &Argument<'g>, span: &Span) -> Refused {
        let (yes, no) = (yes.value.described(), no.value.described());
        self.refuse(Code::BranchShapes, span, format!("both branches are of one shape, these are {yes} and {no}"), "")
    }

    /// `if a < b { a } else { b }`
    pub(in crate::model) fn smaller(&mut self, a: &Argument<'g>, b: &Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        self.extreme(a, b, a, b, span)
    }

    /// `if a < b { b } else { a }`
    pub(in crate::model) fn larger(&mut self, a: &Argument<'g>, b: &Argument<'g>, span: &Span) -> Resolved<Value<'g>> {
        self.extreme(a, b, b, a, span)
    }

    /// `if a < b { yes } else { no }`
    fn extreme(
        &mut self,
        a: &Argument<'g>,
        b: &Argument<'g>,
        yes: &Argument<'g>,
        no: &Argument<'g>,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let (x, y) = (self.scalar(a), self.scalar(b));
        let (x, y) = (x?, y?);
        if shared(x.fit(), y.fit()).is_none() {
            let message = format!("the arguments need equal dimensions, these are {} and {}", x.dimension, y.dimension);
            return Err(self.refuse(Code::UnequalDimensions, span, message, ""));
        }
        match self.less(x.expr, y.expr) {
            Truth::Known(true) => Ok(yes.value.clone()),
            Truth::Known(false) => Ok(no.value.clone()),
            Truth::Open(condition) => self.chosen(condition, yes, no, span),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::model::check::trial::{near, refusals, refused, same, value, value_with_unit};

    #[test]
    fn conditions_choose() {
        // x = 0.3, y = −0.7, z = 1.1
        let check = |condition: &str, expected: bool| {
            let text = format!("if {condition} {{ 1 }} else {{ 2 }}");
            assert_eq!(value("", &text), [if expected { 1.0 } else { 2.0 }], "{condition}");
        };
        check("x < y", false);
        check("x > y", true);
        check("x <= z", true);
        check("x >= z", false);
        check("x < z && y < z", true);
        check("x < z && y > z", false);
        check("x > z || y < z", true);
        check("!(x > z) && !(y > z || x > z)", true);
        check("t < 0", false);
        check("u*l > k*x^2", true);
        assert_eq!(value_with_unit("", "if x < 0 { l } else { 0 }"), (vec![0.0], "m".to_string()));
        same("", "if y < 0 { -y } else { y }", "abs(y)");
        same("", "if y > 0 { 1*l } else if x > 0 { 2*l } else { 3*l }", "2*l");
        same("", "dt(if y < 0 { -y } else { y })", "-dt(y)");
        // What is equal for all values is so whatever rounding makes of it.
        same("", "if l/l < 1 { x } else { y }", "y");
        same("", "if sin(x/l)^2 + cos(x/l)^2 >= 1 { x } else { y }", "x");
        same("", "if x < 0 || l/l > 1 { x } else if (x + y)^2 <= x^2 + 2*x*y + y^2 { y } else { z }", "y");
        // What holds of some functions alone: a table has no sign of its own.
        let table = "const s[3]: m = [-1, 0, 1]; const h[3]: N = [-1, 2, 8]; let right = table(x, s, h); \
                     let left = -table(-x, s, h);";
        same(table, "[max(left, right), abs(right - left)]", "[right, right - left]");
        same(table, "if table(0*x, s, h) > 0 { x } else { y }", "x");
        same(table, "signum(table(x, s, h) + table(-x, s, h))", "1");
        same("", "if atan2(x - x, y) <= 0 { x } else { y }", "y");
        same("", "abs(atan2(0*x, y))", "pi");
        // What is not a number on the other side does not matter.
        same("", "if y > 0 { sqrt(y) } else { 2*sqrt(-y) }", "2*sqrt(-y)");
        same("", "dt(if y > 0 { sqrt(y) } else { 2*sqrt(-y) })", "dt(2*sqrt(-y))");
    }

    #[test]
    fn every_shape_but_poses_can_be_chosen() {
        let poses = "let a = rot_z(theta); let b = a * rot_x(q[0]);";
        same("", "if x < 0 { [x, y, z] } else { 2*[x, y, z] }", "2*[x, y, z]");
        same(poses, "if x > 0 { a * [x, y, z] } else { b * [l, 0, 0] }", "a * [x, y, z]");
        same(poses, "if x < 0 { a * [x, y, z] } else { b * [l, 0, 0] }", "b * [l, 0, 0]");
        same(poses, "dt(if x > 0 { a.point([x, y, z]) } else { a.origin() })", "dt(a.point([x, y, z]))");
        same(poses, "if x < 0 { a.point([x, y, z]) } else { b.point([l, 0, 0]) }", "b.point([l, 0, 0])");
        same("", "if x < 0 { q } else { [1, 2] }", "[1, 2]");
        same("", "if x > 0 { diag(1, 2, 3) } else { diag(0, 0, 0) }", "diag(1, 2, 3)");
    }

    #[test]
    fn what_is_known_at_build_time_is_decided_then() {
        near(&value("let mut a = 0; for i in 0..4 { a = a + if i < 1 { 10 } else { i }; }", "a"), &[16.0], "turns");
        // The other branch is not looked at: not its index, nor its shape.
        near(
            &value("let mut p = [0, 0]; for i in 0..2 { p = if i >= 1 { [q[i], q[i - 1]] } else { p }; }", "p"),
            &[1.3, -0.9],
            "neighbours",
        );
        same("const n = 2;", "if n > 1 && n <= 2 { rot_z(theta) } else { 0 }", "rot_z(theta)");
        same("", "if 1/3 < 1/3 { x } else { y }", "y");
        same("", "if 2 <= 2 || q[7] > 0 { x } else { y }", "x");
        same("const n = 6/3;", "if n == 2 && !(n != 2) { x } else { q[7] }", "x");
        same("const d: mm = 3; const e: m = 3e-3;", "if d != e || d == 0 { x } else { y }", "y");
    }

    #[test]
    fn statements_are_chosen_at_build_time() {
        let chain =
            "let mut a = 0; for i in 0..4 { if i == 0 { a = 1; } else if i != 2 { a = a + 10; } else { a = a*2; } }";
        near(&value(chain, "a"), &[32.0], "a chain");
        near(&value("let a = 1; if a > 0 { let a = 2; let b = a; }", "a"), &[1.0], "a block of its own");
        near(
            &value("let mut a = 1; if a < 0 { a = nothing_like_it[7]; }", "a"),
            &[1.0],
            "the other side is not looked at",
        );
        near(&value("const n = 2; let p[n]; if n == 2 { p[0] = x; p[1] = y; }", "p"), &[0.3, -0.7], "elements");
        let now = "statements are chosen at build time, and this is not known then";
        let moving = "while it moves a value is chosen: `let f = if a < b { … } else { … };`, `kinetic += if …`";
        refused("if x < 0 { potential += k*x^2; }", &format!("x < 0: {now}; {moving}"));
        refused(
            "if dt(x) < 0 || x > l { force y += u; } else { let a = nothing; }",
            &format!("dt(x) < 0 || x > l: {now}; {moving}"),
        );
        let parameter = "a parameter may change at run time: declare it as `const name = …;`";
        refused("if 1 < 0 { } else if m > 0 { }", &format!("m > 0: {now}; {parameter}"));
        refused(
            "if x == 0 { }",
            "x == 0: `==` and `!=` compare constants: in a motion they hold for no time, or for all but none; write `<`, `<=`, \
             `>` or `>=`; an equation is a `constraint`",
        );
        refused(
            "let a = if m != 0 { x } else { y };",
            "m != 0: `==` and `!=` compare constants, what parameters are is known at run time only; declare it as `const name = …;`, \
             or write `<`, `<=`, `>` or `>=`",
        );
        refused(
            "if 1 == 1 { param n: kg = 1; }",
            "param n: kg = 1;: `param` cannot stand in an `if`; declare it before the `if`; how many there are may depend on a \
             constant: `q[n]`",
        );
        refused(
            "if 1 { }",
            "1: a condition compares two numbers, this is a number; write `a < b`, `a <= b`, `a > b` or \
                 `a >= b`; of constants `a == b` or `a != b` as well",
        );
        // What a choice that was given up would have done is not known.
        assert_eq!(refusals("let p[1]; if x < 0 { p[0] = 1; } output a = p;").len(), 1);
    }

    #[test]
    fn extremes() {
        assert_eq!(value("", "[min(x, y), max(x, y), clamp(z, x, l), clamp(y, x, l)]"), [-0.7, 0.3, 1.1, 0.3]);
        assert_eq!(value("", "[min(2, 3), max(2, 3), clamp(7, 2, 3)]"), [2.0, 3.0, 3.0]);
        assert_eq!(value_with_unit("", "max(y, 0)"), (vec![0.0], "m".to_string()));
        refused("let a = min(x, m);", "min(x, m): the arguments need equal dimensions, these are m and kg");
        refused("let a = max(x);", "max: `max` takes 2 arguments, 1 is given; write `max(a, b)`");
    }

    #[test]
    fn wrong_conditions() {
        refused("let a = if x < m { 1 } else { 2 };", "x < m: a comparison needs equal dimensions, these are m and kg");
        refused(
            "let a = if x < 1 { 1 } else { 2 };",
            "x < 1: a comparison needs equal dimensions, these are m and a plain number",
        );
        refused(
            "let a = if x < 0 { m } else { l };",
            "if x < 0 { m } else { l }: both branches need equal dimensions, these are kg and m",
        );
        refused(
            "let a = if x < 0 { [x, y, z] } else { l };",
            "if x < 0 { [x, y, z] } else { l }: both branches are of one shape, these are a vector and a number",
        );
        refused(
            "let a = if x < 0 { q } else { [1, 2, 3, 4] };",
            "if x < 0 { q } else { [1, 2, 3, 4] }: both branches are of one shape, these are an array of 2 and an array of 4",
        );
        refused(
            "let a = if x < 0 { rot_z(theta) } else { world };",
            "if x < 0 { rot_z(theta) } else { world }: a pose cannot depend on a condition; choose between angles and lengths, and make the pose of them",
        );
        refused(
            "let a = if x { 1 } else { 2 };",
            "x: a condition compares two numbers, this is a number; write `a < b`, `a <= b`, `a > b` or `a >= b`; of constants \
             `a == b` or `a != b` as well",
        );
        refused(
            "let a = if !x < 0 { 1 } else { 2 };",
            "!x: a condition is not a value; conditions stand behind `if`: `if x < 0 { a } else { b }`",
        );
        refused(
            "let a = (x < 0)*x;",
            "(x < 0): a condition is not a value; conditions stand behind `if`: `if x < 0 { a } else { b }`",
        );
        refused(
            "let a = if [x, y, z] < x { 1 } else { 2 };",
            "[x, y, z]: expected a number, found a vector; of a vector, `.x`, `.norm()` and `.dot(v)` are numbers",
        );
    }
}
