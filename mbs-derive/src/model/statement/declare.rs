//! `param`, `coord`, `input`, `prescribed` and `const`: quantities with units.

use crate::diagnostic::Code;
use crate::model::value::constant::Dependence;
use crate::model::value::dimension::{Dimension, Measure, measure};
use crate::model::value::evaluate::{Argument, Resolved, Resolver};
use crate::model::value::usage::in_words;
use crate::variable::Variable;

use crate::expr::{Expr, Matrix, Number, Vector};
use crate::model::names::scope::Origin;
use crate::model::value::quantity::UnitsInPlace;
use crate::model::value::{Free, Scalar, Tensor, Value};
use crate::parse::syntax::{Expression, ExpressionKind, Quantity, Span};

/// Longer arrays are a slip of the pen.
const MAX_LENGTH: i64 = 10_000;

/// Matrices that are generated and proved grow with the square and the cube of the number of coordinates; the dynamics
/// of a chain grow with it.
pub(in crate::model) const MAX_COORDINATES: usize = 3_000;

impl<'d, 'g> Resolver<'d, 'g> {
    /// `param length: m = 0.5;`
    pub(in crate::model) fn parameter(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let (length, measure) = (self.size(quantity), self.measure(quantity, "param"));
        let value = self.default_of(quantity, measure.as_ref().ok(), length);
        let (Ok(length), Ok(measure), Ok(defaults)) = (length, measure, value) else {
            return self.declare(&quantity.name, Origin::Parameter, None);
        };
        let name = &quantity.name.text;
        let symbols = match length {
            None => vec![self.lagrangian.parameter(name, &measure.si, defaults[0])],
            Some(_) => self.lagrangian.parameter_array(name, &measure.si, defaults),
        };
        document(&mut self.lagrangian.parameters, quantity);
        self.note_conditions(quantity, &measure);
        if quantity.columns.is_some()
            && let Ok(Some(rows)) = self.length(quantity)
        {
            if let Some(parameter) = self.lagrangian.parameters.last_mut() {
                parameter.columns = Some(symbols.len() / rows);
            }
            return self.declare_matrix(quantity, &symbols, measure.dimension, rows);
        }
        self.declare_symbols(quantity, Origin::Parameter, symbols, measure.dimension, length)
    }

    /// What was declared of the last parameter besides its name: another unit than those of the SI, that it is
    /// positive.
    fn note_conditions(&mut self, quantity: &Quantity, measure: &Measure) {
        let Some(parameter) = self.lagrangian.parameters.last_mut() else { return };
        parameter.declared_unit =
            quantity.unit.as_ref().filter(|_| !measure.scale.is_one()).map(|unit| unit.to_string());
        parameter.positive = quantity.positive.is_some();
        let wrong = parameter.defaults.iter().map(|value| value.to_f64()).find(|value| *value <= 0.0);
        if let (Some(span), Some(value)) = (&quantity.positive, wrong) {
            let message = format!("`{}` is declared positive, its default is {value}", quantity.name.text);
            let _ = self.refuse(Code::NotPositive, span, message, "leave `positive` out, or choose another default");
        }
    }

    /// Row by row.
    fn declare_matrix(
        &mut self,
        quantity: &Quantity,
        symbols: &[Expr<'g>],
        dimension: Dimension,
        rows: usize,
    ) -> Resolved<()> {
        let dimension = self.dimension(dimension);
        let of_row =
            |row: &[Expr<'g>]| row.iter().map(|&e| Value::Scalar(Scalar::new(e, dimension))).collect::<Vec<_>>();
        let rows: Vec<_> = symbols.chunks(symbols.len() / rows).map(of_row).collect();
        let rows: Resolved<Vec<_>> = rows.into_iter().map(|row| self.array(row, &quantity.name.span)).collect();
        let value = rows.and_then(|rows| self.array(rows, &quantity.name.span)).ok();
        self.declare(&quantity.name, Origin::Parameter, value)
    }

    /// `coord theta: rad;`
    pub(in crate::model) fn coordinate(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let (length, measure) = (self.length(quantity), self.unscaled(quantity, "coord"));
        let first = self.lagrangian.dof();
        let (Ok(length), Ok(measure)) = (length, measure) else {
            return self.declare(&quantity.name, Origin::Coordinate(first), None);
        };
        if first + length.unwrap_or(1) > MAX_COORDINATES {
            let message = format!("a mechanism has at most {MAX_COORDINATES} coordinates");
            let _ =
                self.refuse(Code::ArraySize, &quantity.name.span, message, "derive a part of it, or fewer elements");
            return self.declare(&quantity.name, Origin::Coordinate(first), None);
        }
        let symbols = self.lagrangian.coordinate(&quantity.name.text, &measure.si, length);
        document(&mut self.lagrangian.coordinates, quantity);
        self.declare_symbols(quantity, Origin::Coordinate(first), symbols, measure.dimension, length)
    }

    /// `input push: N;`
    pub(in crate::model) fn input(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let (length, measure) = (self.length(quantity), self.unscaled(quantity, "input"));
        let (Ok(length), Ok(measure)) = (length, measure) else {
            return self.declare(&quantity.name, Origin::Input, None);
        };
        let symbols = self.lagrangian.input(&quantity.name.text, &measure.si, length);
        document(&mut self.lagrangian.inputs, quantity);
        self.declare_symbols(quantity, Origin::Input, symbols, measure.dimension, length)
    }

    /// `prescribed heave: m;`, `prescribed heave: m = a * sin(w * t);`
    pub(in crate::model) fn prescribed(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let Some(formula) = &quantity.value else { return self.signal(quantity) };
        let (length, measure) = (self.length(quantity), self.measure(quantity, "prescribed"));
        let value = self.definition(&quantity.name, formula);
        let motion = match (value, length, measure) {
            (Ok(value), Ok(length), Ok(measure)) => self.motion(quantity, &value, length, &measure, &formula.span),
            _ => Err(crate::model::value::evaluate::Refused),
        };
        self.declare(&quantity.name, Origin::Prescribed, motion.ok())
    }

    /// Given at run time, with two derivatives.
    fn signal(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let (length, measure) = (self.length(quantity), self.unscaled(quantity, "prescribed"));
        let (Ok(length), Ok(measure)) = (length, measure) else {
            return self.declare(&quantity.name, Origin::Prescribed, None);
        };
        let symbols = self.lagrangian.prescribe(&quantity.name.text, &measure.si, length);
        document(&mut self.lagrangian.prescribed, quantity);
        self.declare_symbols(quantity, Origin::Prescribed, symbols, measure.dimension, length)
    }

    /// Given by a formula.
    fn motion(
        &mut self,
        quantity: &Quantity,
        value: &Value<'g>,
        length: Option<usize>,
        measure: &Measure,
        span: &Span,
    ) -> Resolved<Value<'g>> {
        let name = &quantity.name.text;
        if !measure.scale.is_one() {
            let at = quantity.unit.as_ref().map_or(&quantity.name.span, |unit| &unit.span);
            let help = format!("write `prescribed {name}: {} = …;`", measure.si);
            return Err(self.refuse(Code::GivenInSi, at, format!("`{name}` is a formula, in SI units"), help));
        }
        let elements = match (value, length) {
            (Value::Scalar(_), length) => vec![value.clone(); length.unwrap_or(1)],
            (_, Some(length)) => {
                let elements = self.elements(&Argument { value: value.clone(), span: span.clone() })?;
                self.check_length(elements.len(), length, span)?;
                elements
            }
            (other, None) => {
                let message = format!("`{name}` is one number, this is {}", other.described());
                return Err(self.refuse(
                    Code::OneNumber,
                    span,
                    message,
                    "write `let` for anything else, or declare a length: `[3]`",
                ));
            }
        };
        let mut values = Vec::new();
        for element in elements {
            let argument = Argument { value: element, span: span.clone() };
            let expr = self.of_dimension(&argument, &format!("`{name}`"), measure.dimension)?;
            let moved = Dependence::COORDINATE.or(Dependence::VELOCITY).or(Dependence::INPUT);
            if self.known.facts.dependence(expr).on(moved) {
                let help =
                    "a prescribed motion is a formula of `t`, constants and parameters; write `let` for anything else";
                return Err(self.refuse(
                    Code::PrescribedByState,
                    span,
                    "a prescribed motion does not depend on coordinates or inputs",
                    help,
                ));
            }
            values.push(Value::Scalar(Scalar::new(expr, self.dimension(measure.dimension))));
        }
        match (length, values.pop()) {
            (None, Some(value)) => Ok(value),
            (_, last) => self.array(values.into_iter().chain(last).collect(), span),
        }
    }

    /// `const d[6]: m = [0.78, …];`
    pub(in crate::model) fn constant(&mut self, quantity: &'d Quantity) -> Resolved<()> {
        let (length, measure) = (self.length(quantity), self.measure_if_any(quantity));
        let has_unit = match &measure {
            Ok(Some(measure)) => measure.si != "1" || !measure.scale.is_one(),
            _ => quantity.value.as_ref().is_some_and(|value| self.units_in_place(value) != UnitsInPlace::None),
        };
        let value = self.value_of_constant(quantity, measure, length);
        self.declare(&quantity.name, Origin::Constant, value.ok())?;
        self.names.scope.note_unit(&quantity.name.text, has_unit);
        Ok(())
    }

    fn declare_symbols(
        &mut self,
        quantity: &Quantity,
        origin: Origin,
        symbols: Vec<Expr<'g>>,
        dimension: Dimension,
        length: Option<usize>,
    ) -> Resolved<()> {
        let dimension = self.dimension(dimension);
        let mut values: Vec<_> = symbols.iter().map(|&s| Value::Scalar(Scalar::new(s, dimension))).collect();
        let value = match length {
            None => values.pop(),
            Some(_) => self.array(values, &quantity.name.span).ok(),
        };
        self.declare(&quantity.name, origin, value)
    }
}

fn document(variables: &mut [Variable], quantity: &Quantity) {
    if let Some(variable) = variables.last_mut() {
        variable.docs = quantity.docs.clone();
    }
}

// ---- lengths and units

impl<'d, 'g> Resolver<'d, 'g> {
    fn length(&mut self, quantity: &Quantity) -> Resolved<Option<usize>> {
        quantity.length.as_ref().map(|length| self.array_length(length)).transpose()
    }

    pub(in crate::model) fn array_length(&mut self, length: &Expression) -> Resolved<usize> {
        let argument = self.argument(length)?;
        match self.integer(&argument, "the length of an array")? {
            n @ 1..=MAX_LENGTH => Ok(n as usize),
            n => {
                let message = format!("an array has from 1 to {MAX_LENGTH} elements, not {n}");
                Err(self.refuse(Code::ArraySize, &length.span, message, ""))
            }
        }
    }

    /// How many numbers, rows times columns.
    fn size(&mut self, quantity: &Quantity) -> Resolved<Option<usize>> {
        let (rows, Some(columns)) = (self.length(quantity)?, &quantity.columns) else { return self.length(quantity) };
        let argument = self.argument(columns)?;
        let columns_wanted = self.integer(&argument, "the length of an array")?;
        let total = columns_wanted.checked_mul(rows.unwrap_or(1) as i64);
        match total {
            Some(total @ 1..=MAX_LENGTH) => Ok(Some(total as usize)),
            _ => {
                let message = format!("a matrix has from 1 to {MAX_LENGTH} numbers");
                Err(self.refuse(Code::ArraySize, &columns.span, message, ""))
            }
        }
    }

    /// The numbers of a default, row by row.
    fn flattened(&mut self, value: Value<'g>, span: &Span) -> Resolved<Vec<Value<'g>>> {
        if let Value::Scalar(_) = value {
            return Ok(vec![value]);
        }
        let mut numbers = Vec::new();
        for element in self.elements(&Argument { value, span: span.clone() })? {
            numbers.extend(self.flattened(element, span)?);
        }
        Ok(numbers)
    }

    /// That a default has as many rows and columns as declared.
    fn check_rows(&mut self, quantity: &Quantity, value: &Value<'g>, total: usize, span: &Span) -> Resolved<()> {
        let rows = self.length(quantity)?.unwrap_or(1);
        let elements = self.elements(&Argument { value: value.clone(), span: span.clone() })?;
        let columns = total / rows;
        let right = |element: &Value<'g>| match element {
            Value::Array(row) => {
                row.values().len() == columns && row.values().iter().all(|entry| matches!(entry, Value::Scalar(_)))
            }
            other => other.shape() == crate::model::value::Shape::Vector && columns == 3,
        };
        if elements.len() == rows && elements.iter().all(right) {
            return Ok(());
        }
        let message = format!("{rows} rows of {columns} are declared, this is {}", value.described());
        Err(self.refuse(Code::CountOfValues, span, message, "one value without brackets stands for all entries"))
    }

    fn measure_if_any(&mut self, quantity: &Quantity) -> Resolved<Option<Measure>> {
        let Some(unit) = &quantity.unit else { return Ok(None) };
        match measure(unit) {
            Ok(measure) => Ok(Some(measure)),
            Err(error) => {
                Err(self.refuse(Code::UnknownUnit, &error.span, error.message, error.help.unwrap_or_default()))
            }
        }
    }

    fn measure(&mut self, quantity: &Quantity, keyword: &str) -> Resolved<Measure> {
        if let Some(measure) = self.measure_if_any(quantity)? {
            return Ok(measure);
        }
        let name = &quantity.name.text;
        let help = format!("write `{keyword} {name}: m`, `1` for a plain number");
        Err(self.refuse(Code::MissingUnit, &quantity.name.span, format!("`{name}` needs a unit"), help))
    }

    /// States and inputs are given at run time, in SI units: no other may be declared.
    fn unscaled(&mut self, quantity: &Quantity, keyword: &str) -> Resolved<Measure> {
        let measure = self.measure(quantity, keyword)?;
        if measure.scale.is_one() {
            return Ok(measure);
        }
        let name = &quantity.name.text;
        let span = quantity.unit.as_ref().map_or(&quantity.name.span, |unit| &unit.span);
        let message = format!("`{name}` is given at run time, in SI units");
        Err(self.refuse(Code::GivenInSi, span, message, format!("write `{keyword} {name}: {};`", measure.si)))
    }
}

// ---- values

impl<'d, 'g> Resolver<'d, 'g> {
    /// The defaults of a parameter in SI units, one for each component.
    fn default_of(
        &mut self,
        quantity: &'d Quantity,
        measure: Option<&Measure>,
        length: Resolved<Option<usize>>,
    ) -> Resolved<Vec<Number>> {
        let name = &quantity.name;
        let Some(expression) = &quantity.value else {
            let message = format!("the parameter `{}` needs a default", name.text);
            let help = "parameters can be set at run time; the default is what they are until then";
            return Err(self.refuse(Code::MissingValue, &name.span, message, help));
        };
        let value = self.definition(name, expression)?;
        let (measure, length) = (measure.ok_or(crate::model::value::evaluate::Refused)?, length?);
        let measure = self.measure_of(expression, measure)?;
        let value = self.in_unit(&value, Some(&measure), &expression.span, "the default of a parameter")?;
        let scalar = |resolver: &mut Self, value: &Value<'g>| {
            let scalar = resolver.scalar(&Argument { value: value.clone(), span: expression.span.clone() })?;
            resolver.known.facts.constant(scalar.expr).ok_or(crate::model::value::evaluate::Refused)
        };
        match (&value, length) {
            (value, Some(total)) if quantity.columns.is_some() && !matches!(value, Value::Scalar(_)) => {
                self.check_rows(quantity, value, total, &expression.span)?;
                let numbers = self.flattened(value.clone(), &expression.span)?;
                numbers.iter().map(|value| scalar(self, value)).collect()
            }
            (Value::Array(array), Some(length)) => {
                self.check_length(array.values().len(), length, &expression.span)?;
                array.values().iter().map(|value| scalar(self, value)).collect()
            }
            (Value::Vector(_), Some(3)) => {
                let elements = self.elements(&Argument { value, span: expression.span.clone() })?;
                elements.iter().map(|value| scalar(self, value)).collect()
            }
            (Value::Array(array), None) => {
                let message = format!("`{}` is one number, this is {}", name.text, value.described());
                let help = format!("write `param {}[{}]`", name.text, array.values().len());
                Err(self.refuse(Code::OneNumber, &expression.span, message, help))
            }
            (_, length) => scalar(self, &value).map(|number| vec![number; length.unwrap_or(1)]),
        }
    }

    fn value_of_constant(
        &mut self,
        quantity: &'d Quantity,
        measure: Resolved<Option<Measure>>,
        length: Resolved<Option<usize>>,
    ) -> Resolved<Value<'g>> {
        let Some(expression) = &quantity.value else {
            let message = format!("the constant `{}` needs a value", quantity.name.text);
            return Err(self.refuse(
                Code::MissingValue,
                &quantity.name.span,
                message,
                "write `= …`, or make it a `param`",
            ));
        };
        let value = self.definition(&quantity.name, expression)?;
        let measure = measure?.map(|measure| self.measure_of(expression, &measure)).transpose()?;
        let value = self.in_unit(&value, measure.as_ref(), &expression.span, "a `const`")?;
        match (&value, length?) {
            (_, Some(rows)) if quantity.columns.is_some() => self.frozen_rows(quantity, value, rows, &expression.span),
            (Value::Array(array), Some(length)) => {
                self.check_length(array.values().len(), length, &expression.span).map(|()| value)
            }
            (Value::Vector(_), Some(length)) if length == 3 || matches!(expression.kind, ExpressionKind::Array(_)) => {
                self.check_length(3, length, &expression.span)?;
                let elements = self.elements(&Argument { value, span: expression.span.clone() })?;
                self.array(elements, &expression.span)
            }
            // Is it meant to have one row each, or three times the same matrix?
            (Value::Matrix(_), Some(3)) => {
                let name = &quantity.name.text;
                let message = format!("`{name}` is an array of 3, this is {}", value.described());
                let help = "leave `[3]` out, or write `[…, …, …]` with three elements";
                Err(self.refuse(Code::CountOfValues, &expression.span, message, help))
            }
            (_, Some(length)) => self.array(vec![value; length], &expression.span),
            (_, None) => Ok(value),
        }
    }

    /// A frozen matrix, row by row as one of parameters: one number stands for all entries.
    fn frozen_rows(&mut self, quantity: &Quantity, value: Value<'g>, rows: usize, span: &Span) -> Resolved<Value<'g>> {
        let total = self.size(quantity)?.unwrap_or(rows);
        let entries = if let Value::Scalar(_) = value {
            vec![value; total]
        } else {
            self.check_rows(quantity, &value, total, span)?;
            self.flattened(value, span)?
        };
        let rows: Resolved<Vec<_>> = entries.chunks(total / rows).map(|row| self.array(row.to_vec(), span)).collect();
        self.array(rows?, span)
    }

    /// What plain numbers of a value are in: those that have their unit behind them are not in the declared one.
    fn measure_of(&mut self, value: &Expression, declared: &Measure) -> Resolved<Measure> {
        let dimensions_tell = declared.dimension != Dimension::ONE && !self.dimensionless;
        if dimensions_tell || declared.scale.is_one() {
            return Ok(declared.clone());
        }
        match self.units_in_place(value) {
            UnitsInPlace::None => Ok(declared.clone()),
            UnitsInPlace::All => Ok(Measure { scale: Number::ONE, ..declared.clone() }),
            UnitsInPlace::Some => Err(self.mixed_units(&declared.si, &value.span)),
        }
    }

    fn check_length(&mut self, found: usize, length: usize, span: &Span) -> Resolved<()> {
        match found {
            found if found == length => Ok(()),
            found => {
                let message = format!("this array has {found} elements, {length} are declared");
                Err(self.refuse(
                    Code::CountOfValues,
                    span,
                    message,
                    "one value without brackets stands for all elements",
                ))
            }
        }
    }

    /// Every number in a value folded to a constant; a plain number counts in the unit.
    fn in_unit(
        &mut self,
        value: &Value<'g>,
        measure: Option<&Measure>,
        span: &Span,
        what: &str,
    ) -> Resolved<Value<'g>> {
        let argument = |value: &Value<'g>| Argument { value: value.clone(), span: span.clone() };
        match value {
            Value::Scalar(_) => {
                let scalar = self.scalar(&argument(value))?;
                self.number_in_unit(scalar, measure, span, what).map(Value::Scalar)
            }
            Value::Array(array) => {
                let values: Resolved<Vec<_>> =
                    array.values().iter().map(|value| self.in_unit(value, measure, span, what)).collect();
                self.array(values?, span)
            }
            Value::Vector(_) | Value::Point(_) => {
                let vector @ Free { dimension, .. } = self.vector(&argument(value))?;
                let number = |expr| self.number_in_unit(Scalar::new(expr, dimension), measure, span, what);
                let [x, y, z] = vector.components.0.map(number);
                let (x, y, z) = (x?, y?, z?);
                let components = Vector([x.expr, y.expr, z.expr]);
                Ok(Value::Vector(Free { components, dimension: x.dimension, ..vector }))
            }
            Value::Matrix(matrix) => {
                let Tensor { entries, axes, dimension } = **matrix;
                let mut rows = entries.0;
                let mut found = dimension;
                for entry in rows.iter_mut().flatten() {
                    let number = self.number_in_unit(Scalar::new(*entry, dimension), measure, span, what)?;
                    (*entry, found) = (number.expr, number.dimension);
                }
                Ok(Value::matrix(Tensor { entries: Matrix(rows), axes, dimension: found }))
            }
            Value::Pose(_) | Value::Part(_) => {
                let message = format!("{what} is made of numbers, this is {}", value.described());
                Err(self.refuse(Code::OneNumber, span, message, "write `let` for anything else"))
            }
        }
    }

    fn number_in_unit(
        &mut self,
        Scalar { expr, dimension }: Scalar<'g>,
        measure: Option<&Measure>,
        span: &Span,
        what: &str,
    ) -> Resolved<Scalar<'g>> {
        let Some(number) = self.known.facts.constant(expr) else {
            let help = "it is made of numbers, `pi` and other constants; what is made of parameters is a `let`";
            return Err(self.refuse(Code::KnownAtBuildTime, span, format!("{what} must be known at build time"), help));
        };
        let Some(measure) = measure else {
            return Ok(Scalar::new(self.graph.constant(number), dimension));
        };
        let wanted = self.dimension(measure.dimension);
        if dimension != Dimension::ONE && dimension != wanted {
            let message = format!("{} is declared, this is {}", in_words(wanted), in_words(dimension));
            return Err(self.refuse(
                Code::OtherThanDeclared,
                span,
                message,
                "a plain number is taken in the declared unit",
            ));
        }
        let plain = dimension == Dimension::ONE || self.dimensionless;
        let in_radians =
            matches!((number, measure.scale), (Number::Exact { pi: 1.., .. }, Number::Exact { pi: 1.., .. }));
        if plain && in_radians {
            let help = "declare it in `rad`, or write the number of degrees alone";
            return Err(self.refuse(
                Code::RadiansAlready,
                span,
                "this angle is in radians already, as its `pi` or `deg` shows",
                help,
            ));
        }
        if measure.si == "rad" && measure.scale.is_one() {
            self.warn_of_degrees(number, span);
        }
        let converted = if plain { number * measure.scale } else { number };
        if converted.is_zero() && !number.is_zero() {
            let message = format!("in {} this is nearer to zero than an `f64` can be", measure.si);
            return Err(self.refuse(Code::OutOfRange, span, message, "choose other units, or check the exponent"));
        }
        let number = converted;
        Ok(Scalar::new(self.graph.constant(number), wanted))
    }
}

#[cfg(test)]
mod tests;
