//! Quantities in place, `0.3 kg`: their values, and names of the mechanism that might have been meant for their units.

use crate::diagnostic::Code;
use crate::expr::Number;
use crate::model::names::scope::Origin;
use crate::model::value::dimension::{Dimension, measure};
use crate::model::value::evaluate::{Refused, Resolved, Resolver};
use crate::model::value::{Scalar, Value};
use crate::parse::syntax::{BinaryOperator, Expression, ExpressionKind, Name, Span, Unit, UnitFactor};

/// Which of the numbers of a declaration have a unit of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::model) enum UnitsInPlace {
    None,
    Some,
    All,
}

/// Functions that give angles in radians.
const ARCS: [&str; 4] = ["asin", "acos", "atan", "atan2"];

impl<'d, 'g> Resolver<'d, 'g> {
    /// The number in SI units, with its dimension.
    pub(in crate::model) fn quantity(&mut self, decimal: &str, unit: &Unit, span: &Span) -> Resolved<Value<'g>> {
        for number in 0..unit.factors.len() {
            self.check_unit_name(decimal, unit, number)?;
        }
        let measure = match measure(unit) {
            Ok(measure) => measure,
            Err(error) => {
                return Err(self.refuse(Code::UnknownUnit, &error.span, error.message, error.help.unwrap_or_default()));
            }
        };
        let Some(number) = Number::parse_decimal(decimal) else {
            return Err(self.refuse(Code::NotANumber, span, format!("`{decimal}` is not a number"), ""));
        };
        let value = number * measure.scale;
        if value.is_zero() != number.is_zero() || !value.to_f64().is_finite() {
            let message = format!("in {} this is beyond the range of an `f64`", measure.si);
            return Err(self.refuse(Code::OutOfRange, span, message, "choose another unit"));
        }
        Ok(Value::Scalar(Scalar::new(self.graph.constant(value), self.dimension(measure.dimension))))
    }

    /// A name of the mechanism may be meant by the unit with this number: right behind the decimal only if nothing
    /// tells that apart, further on always, but for `m` and `s` where the dimensions of sums tell.
    fn check_unit_name(&mut self, decimal: &str, unit: &Unit, number: usize) -> Resolved<()> {
        let Name { text, span } = &unit.factors[number].name;
        if text == "t" && self.dimensionless {
            // Otherwise a mass and a time are told apart by their dimensions.
            let help = format!("write `{decimal}*t` with the time, `{decimal}*1000 kg` for tonnes");
            return Err(self.refuse(Code::UnitOrName, span, "`t` is a unit and the time", help));
        }
        let Some((origin, declared)) = self.meaning(text) else { return Ok(()) };
        let of_unit = measure(&Unit { factors: vec![plain(text, span)], span: span.clone() });
        let dimension = of_unit.map_or(Dimension::ONE, |measure| measure.dimension);
        let told_apart = !self.dimensionless && declared != dimension;
        if told_apart && (number == 0 || ["m", "s"].contains(&text.as_str())) {
            return Ok(());
        }
        let message = format!("`{text}` is a unit and {}", origin.described());
        let before = shown(decimal, &unit.factors[..number]);
        let sign = if unit.factors[number].exponent.0 < 0 { "/" } else { "*" };
        let help = match number {
            0 => format!(
                "write `{decimal}*{text}` for the product; for the quantity declare it: `const name: {text} = {decimal};`"
            ),
            _ => format!(
                "write `({before}){sign}{text}` for {}; for the quantity declare it: `const name: {unit} = {decimal};`",
                origin.described().replacen("a ", "the ", 1).replacen("an ", "the ", 1)
            ),
        };
        Err(self.refuse(Code::UnitOrName, span, message, help))
    }

    /// How a number of this name came to be, and its dimension.
    fn meaning(&self, name: &str) -> Option<(Origin, Dimension)> {
        let binding = self.names.scope.get(name)?;
        match binding.value {
            Some(Value::Scalar(scalar)) => Some((binding.origin, scalar.dimension)),
            _ => None,
        }
    }

    /// Where dimensions do not tell, plain numbers are in the declared unit; those with a unit are not, nor are names
    /// of values with a unit, nor what is made of such alone, nor arcs.
    pub(in crate::model) fn units_in_place(&self, value: &Expression) -> UnitsInPlace {
        let (mut with, mut without) = (false, false);
        let mut parts = vec![value];
        while let Some(part) = parts.pop() {
            match &part.kind {
                ExpressionKind::Quantity(..) => with = true,
                ExpressionKind::Call(function, _) if ARCS.contains(&function.text.as_str()) => with = true,
                ExpressionKind::Number(_) => without = true,
                // An exponent has no unit.
                ExpressionKind::Binary(BinaryOperator::Pow, base, _) => parts.push(base),
                _ => match part.element_of() {
                    Some((name, _)) if self.names.scope.get(name).is_some_and(|known| known.has_unit) => with = true,
                    Some(_) => without = true,
                    None => parts.extend(part.operands()),
                },
            }
        }
        match (with, without) {
            (true, false) => UnitsInPlace::All,
            (true, true) => UnitsInPlace::Some,
            (false, _) => UnitsInPlace::None,
        }
    }

    /// Numbers with a unit of their own beside what has none, in a declaration in a unit of this one of the SI.
    pub(in crate::model) fn mixed_units(&mut self, si: &str, span: &Span) -> Refused {
        let (what, example) = match si {
            "rad" => ("an angle", ", as in `[30 deg, 0.5 rad]`"),
            _ => ("a quantity", ""),
        };
        let message = format!("{what} with its unit stands beside numbers without one");
        self.refuse(
            Code::QuantityBesideNumbers,
            span,
            message,
            format!("give each its unit{example}, or declare it in `{si}`"),
        )
    }
}

fn plain(name: &str, span: &Span) -> UnitFactor {
    UnitFactor { name: Name { text: name.to_string(), span: span.clone() }, exponent: (1, 1) }
}

/// `0.05 N*s`
fn shown(decimal: &str, factors: &[UnitFactor]) -> String {
    format!("{decimal} {}", Unit { factors: factors.to_vec(), span: 0..0 })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::model::check::trial::{
        mechanism, messages, near, refusals, refused, resolved, same, value, value_with_unit,
    };
    use crate::model::value::dimension;
    use crate::parse::UNITS;

    /// The parser knows the names of the units that this pass knows the values of, those of one quantity together.
    #[test]
    fn units_are_those_of_the_parser() {
        let mut parsed: Vec<&str> = UNITS.iter().flat_map(|names| names.iter().copied()).collect();
        let mut known: Vec<&str> = dimension::UNITS.iter().map(|unit| unit.name).collect();
        parsed.sort();
        known.sort();
        assert_eq!(parsed, known);
        for names in UNITS {
            let dimensions = names.iter().map(|name| value_with_unit("", &format!("1 {name}")).1);
            assert_eq!(dimensions.collect::<std::collections::BTreeSet<_>>().len(), 1, "{names:?}");
        }
    }

    #[test]
    fn quantities_have_their_dimension() {
        let check = |text: &str, expected: f64, unit: &str| {
            let (found, of) = value_with_unit("", text);
            near(&found, &[expected], text);
            assert_eq!(of, unit, "{text}");
        };
        check("0.3 kg", 0.3, "kg");
        check("250 g", 0.25, "kg");
        check("20 deg", 20.0 * PI / 180.0, "1");
        check("1500 rpm", 1500.0 * 2.0 * PI / 60.0, "1/s");
        check("9.81 m/s^2", 9.81, "m/s²");
        check("0.02 N*m*s", 0.02, "kg·m²/s");
        check("5 kN/mm", 5e6, "kg/s²");
        check("2 t", 2000.0, "kg");
        check("3 m^(1/2)", 3.0, "m^(1/2)");
        check("90 km/h", 25.0, "m/s");
        check("2 m + 3 cm - 1 mm", 2.029, "m");
        same("", "0.3 kg*9.81 m/s^2*z", "0.15*m*9.81*z*l/l*(l/(t*t))*t*t/l*1 m/s^2");
        same("", "2 rad/s*t", "2*t/(1 s)");
        same("", "x/(2 m)", "x/(2*(l/3))");
        assert_eq!(value("", "(2 m)^2/(1 m^2)"), [4.0]);
        assert!(
            refusals("kinetic += 1/2*0.3 kg*dt(y)^2; potential += 5 N/m*(x - 2 cm)^2; force x += -0.1 N*s/m*dt(x);")
                .is_empty()
        );
    }

    #[test]
    fn declarations_do_not_convert_twice() {
        let check = |declaration: &str, expected: f64| {
            mechanism(declaration, |lagrangian| {
                near(&[lagrangian.parameters[3].defaults[0].to_f64()], &[expected], declaration);
            });
        };
        check("param a: m = 50 cm;", 0.5);
        check("param a: mm = 50 cm;", 0.5);
        check("param a: deg = 30 deg;", PI / 6.0);
        check("param a: deg = -30 deg;", -PI / 6.0);
        check("param a: deg = 0.5 rad;", 0.5);
        check("param a: rad = 30 deg;", PI / 6.0);
        check("param a[2]: deg = [0.5 rad, 30 deg];", 0.5);
        check("param a: rpm = 60;", 2.0 * PI);
        check("param a: rpm = 2 Hz;", 2.0);
        near(&value("const a[2]: deg = [-0.5 rad, 30 deg];", "a"), &[-0.5, PI / 6.0], "constants");
        let mixed = "an angle with its unit stands beside numbers without one; give each its unit, as in `[30 deg, 0.5 rad]`, or \
                     declare it in `rad`";
        refused("param a[2]: deg = [0.5 rad, 30];", &format!("[0.5 rad, 30]: {mixed}"));
        refused("const a: deg = 2*0.5 rad;", &format!("2*0.5 rad: {mixed}"));
        check("param a: mm/m = 60;", 0.06);
        check("const b: mm/m = 60; param a: mm/m = b;", 0.06);
        check("const b[2]: g/kg = [5, 6]; param a: g/kg = b[0];", 0.005);
        check("const b: mm = 3; const c: m = 2; param a: mm/m = b/c;", 0.0015);
        check("const b: mm = 3; let c = 2*b/(1 m); param a: mm/m = c;", 0.006);
        check("const b: 1 = 3; param a: mm/m = 2*b;", 0.006);
        check("let mut b = 0; b = 30 deg; param a: deg = b;", PI / 6.0);
        check("let b[2]; b[0] = 30 deg; b[1] = 40 deg; param a[2]: deg = b;", PI / 6.0);
        check("fn twice(b) = 2*b; param a: deg = twice(30 deg);", PI / 3.0);
        check("param a: deg = atan(1);", PI / 4.0);
        check("const b: m = 3; param a: deg = atan2(b, 3 m);", PI / 4.0);
        let beside = "a quantity with its unit stands beside numbers without one; give each its unit, or declare it in";
        refused("const b: mm/m = 5; param a: mm/m = 2*b;", &format!("2*b: {beside} `m/m`"));
        refused(
            "param a: m = 50 kg;",
            "50 kg: m is declared, this is kg; a plain number is taken in the declared unit",
        );
    }

    /// Where nothing has a dimension, quantities have their unit all the same.
    #[test]
    fn quantities_without_dimensions_are_converted_once() {
        let first = |declaration: &str| {
            let text = format!("#![dimensionless] mechanism A {{ {declaration} coord x: 1; kinetic += a*dt(x)^2; }}");
            resolved(&text, |found| found.map(|(lagrangian, _)| lagrangian.parameters[0].defaults[0].to_f64()).unwrap())
        };
        near(&[first("param a: cm = 0.5 m;")], &[0.5], "quantity");
        near(&[first("param a: km/h = 36 km/h;")], &[10.0], "velocity");
        near(&[first("param a: km/h = 36;")], &[10.0], "plain");
        near(&[first("const b: mm = 500; param a: mm = b;")], &[0.5], "constant");
        near(&[first("const b: 1 = 500; param a: mm = b;")], &[0.5], "plain constant");
    }

    #[test]
    fn names_that_are_units_too() {
        // m is a parameter in kg: two metres, not two masses.
        assert_eq!(value_with_unit("", "2 m"), (vec![2.0], "m".to_string()));
        assert_eq!(value_with_unit("", "5 N*m"), (vec![5.0], "kg·m²/s²".to_string()));
        assert_eq!(value_with_unit("", "5 N * m").1, "kg²·m/s²");
        assert_eq!(value_with_unit("let g = 9.81 m/s^2;", "2 kg*g").1, "kg·m/s²");
        assert_eq!(value_with_unit("", "6 m/t").1, "m/s");
        refused(
            "let s = t; let a = 2 s;",
            "s: `s` is a unit and a `let`; write `2*s` for the product; for the quantity declare it: `const name: s = 2;`",
        );
        refused(
            "let s = t; let a = 2 m/s;",
            "s: `s` is a unit and a `let`; write `(2 m)/s` for the `let`; for the quantity declare it: `const name: m*s^-1 = 2;`",
        );
        refused(
            "coord h: m; kinetic += m*dt(h)^2; potential += 5 N*h;",
            "h: `h` is a unit and a coordinate; write `(5 N)*h` for the coordinate; for the quantity declare it: `const name: N*h = 5;`",
        );
        let found = messages(
            "#![dimensionless] mechanism A { param m: 1 = 2; coord x: 1; kinetic += m*dt(x)^2; potential += 2 m*x; }",
        );
        assert_eq!(
            found,
            [
                "m: `m` is a unit and a parameter; write `2*m` for the product; for the quantity declare it: `const name: m = 2;`"
            ]
        );
        let time = messages("#![dimensionless] mechanism A { coord x: 1; kinetic += dt(x)^2; force x += sin(5 t); }");
        assert_eq!(time, ["t: `t` is a unit and the time; write `5*t` with the time, `5*1000 kg` for tonnes"]);
        let plain = "#![dimensionless] mechanism A { coord x: 1; kinetic += 2 kg*dt(x)^2; potential += 30 deg*x; }";
        assert!(messages(plain).is_empty());
        refused("let a = 1e308 km;", "1e308 km: in m this is beyond the range of an `f64`; choose another unit");
    }
}
