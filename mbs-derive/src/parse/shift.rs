//! A file's places moved to where its text stands among those of all files.

use super::grammar::File;
use super::import::Shared;
use super::syntax::{Expression, ExpressionKind, Name, Quantity, Span, Statement, StatementKind, Unit};

impl File<Shared> {
    /// Adds `start` to every place.
    pub(super) fn shift(&mut self, start: usize) {
        self.errors.shift(start);
        for import in &mut self.imports {
            span(&mut import.span, start);
        }
        if let Some(Shared::Declarations(statements)) = &mut self.content {
            statements.iter_mut().for_each(|s| statement(s, start));
        }
    }
}

fn span(span: &mut Span, start: usize) {
    *span = span.start + start..span.end + start;
}

fn statement(statement: &mut Statement, start: usize) {
    span(&mut statement.span, start);
    match &mut statement.kind {
        StatementKind::Const(Quantity { name: declared, length, unit, value, .. }) => {
            name(declared, start);
            unit.iter_mut().for_each(|unit| shift_unit(unit, start));
            length.iter_mut().chain(value).for_each(|e| expression(e, start));
        }
        StatementKind::Function { name: declared, parameters, body } => {
            name(declared, start);
            parameters.iter_mut().for_each(|parameter| name(parameter, start));
            expression(body, start);
        }
        // Refused, with its place, which has been moved.
        StatementKind::Param(_)
        | StatementKind::Coord(_)
        | StatementKind::Input(_)
        | StatementKind::Prescribed(_)
        | StatementKind::Let { .. }
        | StatementKind::Elements { .. }
        | StatementKind::Assign { .. }
        | StatementKind::Energy { .. }
        | StatementKind::Force { .. }
        | StatementKind::ForceAt { .. }
        | StatementKind::TorqueOn { .. }
        | StatementKind::Gravity { .. }
        | StatementKind::Reaction { .. }
        | StatementKind::Constraint { .. }
        | StatementKind::Output { .. }
        | StatementKind::For { .. }
        | StatementKind::If { .. } => {}
    }
}

fn shift_unit(unit: &mut Unit, start: usize) {
    span(&mut unit.span, start);
    unit.factors.iter_mut().for_each(|factor| name(&mut factor.name, start));
}

fn name(name: &mut Name, start: usize) {
    span(&mut name.span, start);
}

/// Part by part, not by recursion: sums are as deep as they are long.
fn expression(whole: &mut Expression, start: usize) {
    let mut waiting = vec![whole];
    while let Some(part) = waiting.pop() {
        span(&mut part.span, start);
        match &mut part.kind {
            ExpressionKind::Number(_) | ExpressionKind::Name(_) => {}
            ExpressionKind::Quantity(_, unit) => shift_unit(unit, start),
            ExpressionKind::Negate(a) | ExpressionKind::Not(a) => waiting.push(a),
            ExpressionKind::Field(a, field) => {
                name(field, start);
                waiting.push(a);
            }
            ExpressionKind::Binary(_, a, b)
            | ExpressionKind::Index(a, b)
            | ExpressionKind::Compare(_, a, b)
            | ExpressionKind::And(a, b)
            | ExpressionKind::Or(a, b) => waiting.extend([&mut **a, &mut **b]),
            ExpressionKind::If(a, b, c) => waiting.extend([&mut **a, &mut **b, &mut **c]),
            ExpressionKind::Call(function, arguments) => {
                name(function, start);
                waiting.extend(arguments);
            }
            ExpressionKind::Array(elements) => waiting.extend(elements),
            ExpressionKind::Method(a, method, arguments) => {
                name(method, start);
                waiting.push(a);
                waiting.extend(arguments);
            }
        }
    }
}
