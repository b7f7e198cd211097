//! A file's places moved to where its text stands among those of all files.

use super::grammar::File;
use super::import::Shared;
use super::syntax::{Declaration, Expression, ExpressionKind, Name, Quantity, Span, Statement, StatementKind, Unit};

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

impl File<Declaration> {
    /// Adds `start` to every place.
    pub(super) fn shift(&mut self, start: usize) {
        self.errors.shift(start);
        if let Some(declaration) = &mut self.content {
            name(&mut declaration.name, start);
            declaration.statements.iter_mut().for_each(|s| statement(s, start));
        }
    }
}

impl File<Quantity> {
    /// As if the quantity stood behind `start` bytes.
    pub(super) fn shift(&mut self, start: usize) {
        self.errors.shift(start);
        self.content.iter_mut().for_each(|q| quantity(q, start));
    }
}

fn span(span: &mut Span, start: usize) {
    *span = span.start + start..span.end + start;
}

fn statement(statement: &mut Statement, start: usize) {
    span(&mut statement.span, start);
    match &mut statement.kind {
        StatementKind::Param(q)
        | StatementKind::Coord(q)
        | StatementKind::Input(q)
        | StatementKind::Const(q)
        | StatementKind::Prescribed(q) => quantity(q, start),
        StatementKind::Function { name: declared, parameters, body } => {
            name(declared, start);
            parameters.iter_mut().for_each(|parameter| name(parameter, start));
            expression(body, start);
        }
        StatementKind::Let { name: declared, value, .. } => {
            name(declared, start);
            expression(value, start);
        }
        StatementKind::Elements { name: declared, lengths, .. } => {
            name(declared, start);
            lengths.iter_mut().for_each(|e| expression(e, start));
        }
        StatementKind::Assign { name: declared, indices, value } => {
            name(declared, start);
            indices.iter_mut().chain([value]).for_each(|e| expression(e, start));
        }
        StatementKind::Energy { value, .. } => expression(value, start),
        StatementKind::Gravity { acceleration } => expression(acceleration, start),
        StatementKind::Force { coordinate, index, value } => {
            name(coordinate, start);
            index.iter_mut().chain([value]).for_each(|e| expression(e, start));
        }
        StatementKind::ForceAt { point, value } => [point, value].into_iter().for_each(|e| expression(e, start)),
        StatementKind::TorqueOn { pose, value } => [pose, value].into_iter().for_each(|e| expression(e, start)),
        StatementKind::Reaction { name: declared, index, pose, element, .. } => {
            [declared, pose].into_iter().for_each(|n| name(n, start));
            index.iter_mut().chain(element).for_each(|e| expression(e, start));
        }
        StatementKind::Constraint { name: declared, index, left, right, .. } => {
            name(declared, start);
            index.iter_mut().chain([left, right]).for_each(|e| expression(e, start));
        }
        StatementKind::Output { name: declared, index, value, jacobian_rate, .. } => {
            name(declared, start);
            index.iter_mut().chain([value]).for_each(|e| expression(e, start));
            jacobian_rate.iter_mut().for_each(|place| span(place, start));
        }
        StatementKind::Shape { pose, kind, file: _, sizes } => {
            name(kind, start);
            sizes.iter_mut().chain([pose]).for_each(|e| expression(e, start));
        }
        StatementKind::For { variable, start: first, end, body } => {
            name(variable, start);
            [first, end].into_iter().for_each(|e| expression(e, start));
            body.iter_mut().for_each(|inner| self::statement(inner, start));
        }
        StatementKind::If { branches, otherwise } => {
            for (condition, body) in branches {
                expression(condition, start);
                body.iter_mut().for_each(|inner| self::statement(inner, start));
            }
            otherwise.iter_mut().for_each(|inner| self::statement(inner, start));
        }
        StatementKind::Part { name: declared, parameters, body } => {
            name(declared, start);
            parameters.iter_mut().for_each(|parameter| name(parameter, start));
            body.iter_mut().for_each(|inner| self::statement(inner, start));
        }
        StatementKind::Instance { part, name: declared, index, arguments } => {
            [part, declared].into_iter().for_each(|n| name(n, start));
            index.iter_mut().chain(arguments).for_each(|e| expression(e, start));
        }
    }
}

fn quantity(quantity: &mut Quantity, start: usize) {
    let Quantity { name: declared, length, columns, unit, value, positive, docs: _ } = quantity;
    positive.iter_mut().for_each(|place| span(place, start));
    name(declared, start);
    unit.iter_mut().for_each(|unit| shift_unit(unit, start));
    length.iter_mut().chain(columns).chain(value).for_each(|e| expression(e, start));
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
