//! Units: what one is in SI, and the exponents of its dimension.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::number::Real;
use super::syntax::{Expression, Kind, Unit};
use super::wide::{Wide, decimal, degree};

/// Exponents of kg, m, s, A, K, mol and cd.
pub(super) type Dimension = [f64; 7];

/// A plain number's.
pub(super) const PLAIN: Dimension = [0.0; 7];

/// Section 9 of the manual: name, value in SI, exponents of kg, m, s, A.
const UNITS: [(&str, &str, [i8; 4]); 46] = [
    ("kg", "1", [1, 0, 0, 0]),
    ("g", "1e-3", [1, 0, 0, 0]),
    ("t", "1e3", [1, 0, 0, 0]),
    ("m", "1", [0, 1, 0, 0]),
    ("km", "1e3", [0, 1, 0, 0]),
    ("dm", "1e-1", [0, 1, 0, 0]),
    ("cm", "1e-2", [0, 1, 0, 0]),
    ("mm", "1e-3", [0, 1, 0, 0]),
    ("um", "1e-6", [0, 1, 0, 0]),
    ("s", "1", [0, 0, 1, 0]),
    ("ms", "1e-3", [0, 0, 1, 0]),
    ("us", "1e-6", [0, 0, 1, 0]),
    ("min", "60", [0, 0, 1, 0]),
    ("h", "3600", [0, 0, 1, 0]),
    ("rad", "1", [0, 0, 0, 0]),
    ("N", "1", [1, 1, -2, 0]),
    ("mN", "1e-3", [1, 1, -2, 0]),
    ("kN", "1e3", [1, 1, -2, 0]),
    ("MN", "1e6", [1, 1, -2, 0]),
    ("J", "1", [1, 2, -2, 0]),
    ("kJ", "1e3", [1, 2, -2, 0]),
    ("MJ", "1e6", [1, 2, -2, 0]),
    ("W", "1", [1, 2, -3, 0]),
    ("kW", "1e3", [1, 2, -3, 0]),
    ("MW", "1e6", [1, 2, -3, 0]),
    ("Pa", "1", [1, -1, -2, 0]),
    ("kPa", "1e3", [1, -1, -2, 0]),
    ("MPa", "1e6", [1, -1, -2, 0]),
    ("GPa", "1e9", [1, -1, -2, 0]),
    ("bar", "1e5", [1, -1, -2, 0]),
    ("Hz", "1", [0, 0, -1, 0]),
    ("kHz", "1e3", [0, 0, -1, 0]),
    ("A", "1", [0, 0, 0, 1]),
    ("mA", "1e-3", [0, 0, 0, 1]),
    ("V", "1", [1, 2, -3, -1]),
    ("C", "1", [0, 0, 1, 1]),
    ("T", "1", [1, 0, -2, -1]),
    ("Wb", "1", [1, 2, -2, -1]),
    ("H", "1", [1, 2, -2, -2]),
    ("F", "1", [-1, -2, 4, 2]),
    ("ohm", "1", [1, 2, -3, -2]),
    ("K", "1", [0, 0, 0, 0]),
    ("mol", "1", [0, 0, 0, 0]),
    ("cd", "1", [0, 0, 0, 0]),
    ("deg", "0", [0, 0, 0, 0]),
    ("rpm", "0", [0, 0, -1, 0]),
];

/// What one of this unit is in SI, and its dimension.
pub(super) fn meaning(unit: &Unit) -> Result<(Wide, Dimension), String> {
    let (mut scale, mut dimension) = (Wide::from(1.0), PLAIN);
    for (name, power) in unit {
        let row = UNITS.iter().find(|(known, ..)| known == name).ok_or_else(|| format!("the unit {name}"))?;
        let one = match name.as_str() {
            "deg" => degree(),
            "rpm" => degree() * 6.0,
            _ => decimal(row.1).ok_or("a scale")?,
        };
        scale = scale * if power.fract() == 0.0 { one.powi(*power as i64) } else { one.powf((*power).into()) };
        row.2.iter().zip(&mut dimension).for_each(|(&exponent, sum)| *sum += f64::from(exponent) * power);
        match name.as_str() {
            "K" => dimension[4] += power,
            "mol" => dimension[5] += power,
            "cd" => dimension[6] += power,
            _ => {}
        }
    }
    Ok((scale, dimension))
}

/// Whether this is the name of a unit.
pub(super) fn is_unit(name: &str) -> bool {
    UNITS.iter().any(|(known, ..)| *known == name)
}

/// Whether two units are of one quantity.
pub(super) fn same_quantity(one: &str, other: &str) -> bool {
    let of = |name: &str| UNITS.iter().find(|(known, ..)| *known == name).map(|(_, _, exponents)| exponents);
    of(one) == of(other)
}

/// Whether a quantity stands in a value: then nothing in it is converted again.
pub(super) fn holds_quantity(value: &Expression) -> bool {
    matches!(value.kind, Kind::Quantity(..)) || value.parts().into_iter().any(holds_quantity)
}

/// The dimension of a value made of numbers and of constants with these dimensions.
pub(super) fn dimension(value: &Expression, constants: &BTreeMap<Rc<str>, Dimension>) -> Dimension {
    let of = |value: &Expression| dimension(value, constants);
    match &value.kind {
        Kind::Quantity(_, unit) => meaning(unit).map_or(PLAIN, |(_, dimension)| dimension),
        Kind::Name(name) => constants.get(name).copied().unwrap_or(PLAIN),
        Kind::Index(base, _) | Kind::Unary(_, base) | Kind::Field(base, _) => of(base),
        Kind::Array(entries) => entries.first().map_or(PLAIN, of),
        Kind::If(_, taken, _) => of(taken),
        Kind::Binary("*", left, right) => sum(of(left), of(right), 1.0),
        Kind::Binary("/", left, right) => sum(of(left), of(right), -1.0),
        Kind::Binary("^", base, exponent) => of(base).map(|e| e * number(exponent)),
        // The literal 0 fits every dimension.
        Kind::Binary("+" | "-", left, right) if of(left) == PLAIN => of(right),
        Kind::Binary("+" | "-", left, _) => of(left),
        Kind::Call(name, arguments) if matches!(name.as_ref(), "abs" | "min" | "max" | "hypot" | "clamp") => {
            arguments.first().map_or(PLAIN, of)
        }
        Kind::Call(name, arguments) if name.as_ref() == "sqrt" => {
            arguments.first().map_or(PLAIN, |a| of(a).map(|e| e / 2.0))
        }
        _ => PLAIN,
    }
}

fn sum(left: Dimension, right: Dimension, sign: f64) -> Dimension {
    std::array::from_fn(|i| left[i] + sign * right[i])
}

/// An exponent: a number, its negative, or a quotient.
fn number(value: &Expression) -> f64 {
    match &value.kind {
        Kind::Number(value) => value.hi(),
        Kind::Unary(_, value) => -number(value),
        Kind::Binary("/", top, bottom) => number(top) / number(bottom),
        _ => f64::NAN,
    }
}
