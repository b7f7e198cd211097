//! SI dimensions and the units that declarations are written in.

use std::fmt;

use crate::diagnostic::nearest;
use crate::expr::Number;
use crate::parse::syntax::{Span, Unit};

/// Base units in the order of a dimension's exponents.
const BASE: [&str; 7] = ["kg", "m", "s", "A", "K", "mol", "cd"];

/// No quantity of mechanics comes near; beyond, a declaration has run away.
const LARGEST_EXPONENT: i64 = 1000;

/// Exponents of the SI base units; angles are plain numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dimension([Exponent; 7]);

/// A rational in lowest terms with a positive denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Exponent {
    numerator: i16,
    denominator: i16,
}

impl Dimension {
    /// That of plain numbers and angles.
    pub(crate) const ONE: Dimension = Dimension::integers([0; 7]);
    /// kg
    pub(crate) const MASS: Dimension = Dimension::integers([1, 0, 0, 0, 0, 0, 0]);
    /// m
    pub(crate) const LENGTH: Dimension = Dimension::integers([0, 1, 0, 0, 0, 0, 0]);
    /// s
    pub(crate) const TIME: Dimension = Dimension::integers([0, 0, 1, 0, 0, 0, 0]);
    /// 1/s
    pub(crate) const ANGULAR_VELOCITY: Dimension = Dimension::integers([0, 0, -1, 0, 0, 0, 0]);
    /// m/s
    pub(crate) const VELOCITY: Dimension = Dimension::integers([0, 1, -1, 0, 0, 0, 0]);
    /// m/s²
    pub(crate) const ACCELERATION: Dimension = Dimension::integers([0, 1, -2, 0, 0, 0, 0]);
    /// kg·m²
    pub(crate) const INERTIA: Dimension = Dimension::integers([1, 2, 0, 0, 0, 0, 0]);
    /// kg·m²/s²
    pub(crate) const ENERGY: Dimension = Dimension::integers([1, 2, -2, 0, 0, 0, 0]);
    /// kg·m²/s³
    pub(crate) const POWER: Dimension = Dimension::integers([1, 2, -3, 0, 0, 0, 0]);

    const fn integers(exponents: [i8; 7]) -> Dimension {
        let mut dimension = [Exponent { numerator: 0, denominator: 1 }; 7];
        let mut i = 0;
        while i < 7 {
            dimension[i].numerator = exponents[i] as i16;
            i += 1;
        }
        Dimension(dimension)
    }

    /// That of a product; `None` where an exponent runs away.
    pub(crate) fn times(self, other: Dimension) -> Option<Dimension> {
        self.combine(other, 1)
    }

    /// That of a quotient; `None` where an exponent runs away.
    pub(crate) fn over(self, other: Dimension) -> Option<Dimension> {
        self.combine(other, -1)
    }

    /// The exponents of kg, m, s, A, K, mol and cd, if they are whole.
    pub(in crate::model) fn whole(self) -> Option<[i16; 7]> {
        self.0.iter().all(|exponent| exponent.denominator == 1).then(|| self.0.map(|exponent| exponent.numerator))
    }

    fn combine(self, other: Dimension, sign: i64) -> Option<Dimension> {
        let mut result = self;
        for (a, b) in result.0.iter_mut().zip(other.0) {
            let (p, q) = (i64::from(a.denominator), i64::from(b.denominator));
            *a = Exponent::new(i64::from(a.numerator) * q + sign * i64::from(b.numerator) * p, p * q)?;
        }
        Some(result)
    }

    /// That of a power with the exponent `numerator / denominator`; `None` where an exponent runs away.
    pub(crate) fn power(self, numerator: i32, denominator: i32) -> Option<Dimension> {
        let mut result = self;
        for exponent in &mut result.0 {
            let n = i64::from(exponent.numerator).checked_mul(i64::from(numerator))?;
            *exponent = Exponent::new(n, i64::from(exponent.denominator).checked_mul(i64::from(denominator))?)?;
        }
        Some(result)
    }
}

impl Exponent {
    fn new(numerator: i64, denominator: i64) -> Option<Exponent> {
        if denominator == 0 {
            return None;
        }
        let divisor = gcd(numerator, denominator) * denominator.signum();
        let (n, d) = (numerator / divisor, denominator / divisor);
        let small = n.abs() <= LARGEST_EXPONENT && d <= LARGEST_EXPONENT;
        small.then_some(Exponent { numerator: n as i16, denominator: d as i16 })
    }
}

fn gcd(a: i64, b: i64) -> i64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

/// `kg·m²/s²`, `1/s`, `kg/(m·s²)`; a plain number is `1`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let factors = |sign: i16| -> Vec<String> {
            let wanted = BASE.iter().zip(self.0).filter(|(_, e)| e.numerator.signum() == sign);
            wanted.map(|(base, e)| format!("{base}{}", superscript(e.numerator.abs(), e.denominator))).collect()
        };
        let (above, below) = (factors(1), factors(-1));
        f.write_str(&if above.is_empty() { "1".to_string() } else { above.join("·") })?;
        match below.len() {
            0 => Ok(()),
            1 => write!(f, "/{}", below[0]),
            _ => write!(f, "/({})", below.join("·")),
        }
    }
}

fn superscript(numerator: i16, denominator: i16) -> String {
    match (numerator, denominator) {
        (1, 1) => String::new(),
        (n, 1) => n.to_string().chars().map(raised).collect(),
        (n, d) => format!("^({n}/{d})"),
    }
}

fn raised(digit: char) -> char {
    digit.to_digit(10).and_then(|value| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(value as usize)).unwrap_or(digit)
}

impl Dimension {
    /// As declarations write it: `kg*m^2/s^2`.
    pub(in crate::model) fn in_ascii(self) -> String {
        let plain = |c: char| match "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|raised| raised == c) {
            Some(digit) => digit.to_string(),
            None if c == '·' => "*".to_string(),
            None => c.to_string(),
        };
        let (mut text, mut raised) = (String::new(), false);
        for c in self.to_string().chars() {
            let is_raised = "⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c);
            if is_raised && !raised {
                text.push('^');
            }
            text += &plain(c);
            raised = is_raised;
        }
        text
    }
}

/// What is to be multiplied to make the one dimension of the other, for messages.
pub(in crate::model) fn lacking(wanted: Dimension, found: Dimension) -> String {
    match wanted.over(found) {
        Some(Dimension::ONE) | None => String::new(),
        Some(missing) => format!("it lacks a factor of {missing}"),
    }
}

/// What the second of two things lacks, where it is a power of one base unit: others say nothing about what was meant.
pub(in crate::model) fn second_lacks(first: Dimension, second: Dimension) -> String {
    lacks_power(first, second, "the second")
}

/// What something called `what` lacks, where it is a power of one base unit.
pub(in crate::model) fn lacks_power(wanted: Dimension, found: Dimension, what: &str) -> String {
    let single = |d: &Dimension| d.0.iter().filter(|exponent| exponent.numerator != 0).count() == 1;
    match wanted.over(found).filter(single) {
        Some(missing) => format!("{what} lacks a factor of {missing}"),
        None => String::new(),
    }
}

/// Units that other people use, and what they are here.
const FOREIGN: [(&[&str], &str); 17] = [
    (&["lb", "lbs", "lbm"], "0.45359237 kg"),
    (&["oz"], "0.028349523125 kg"),
    (&["lbf"], "4.4482216 N"),
    (&["kp", "kgf"], "9.80665 N"),
    (&["inch", "inches"], "25.4 mm"),
    (&["ft", "foot", "feet"], "0.3048 m"),
    (&["mile", "miles", "mi"], "1609.344 m"),
    (&["psi"], "6894.757 Pa"),
    (&["hp"], "745.7 W"),
    (&["rev", "turn", "turns"], "360 deg"),
    (&["degree", "degrees", "grad"], "`deg`"),
    (&["radian", "radians"], "`rad`"),
    (&["sec", "second", "seconds"], "`s`"),
    (&["meter", "metre", "meters", "metres"], "`m`"),
    (&["kilogram", "kilograms", "kilo"], "`kg`"),
    (&["Newton", "newton", "newtons"], "`N`"),
    (&["Joule", "joule", "joules"], "`J`"),
];

/// A unit that declarations may use.
pub(in crate::model) struct NamedUnit {
    pub(in crate::model) name: &'static str,
    /// The unit without prefix that it is a multiple of.
    coherent: &'static str,
    /// How many of that: a fraction, and a power of π.
    multiple: (i64, i64, i8),
    /// Exponents of kg, m, s, A, K, mol, cd.
    exponents: [i8; 7],
}

const fn unit(name: &'static str, coherent: &'static str, multiple: (i64, i64, i8), exponents: [i8; 7]) -> NamedUnit {
    NamedUnit { name, coherent, multiple, exponents }
}

const ONCE: (i64, i64, i8) = (1, 1, 0);
const MASS: [i8; 7] = [1, 0, 0, 0, 0, 0, 0];
const LENGTH: [i8; 7] = [0, 1, 0, 0, 0, 0, 0];
const TIME: [i8; 7] = [0, 0, 1, 0, 0, 0, 0];
const ANGLE: [i8; 7] = [0; 7];
const FORCE: [i8; 7] = [1, 1, -2, 0, 0, 0, 0];
const ENERGY: [i8; 7] = [1, 2, -2, 0, 0, 0, 0];
const POWER: [i8; 7] = [1, 2, -3, 0, 0, 0, 0];
const PRESSURE: [i8; 7] = [1, -1, -2, 0, 0, 0, 0];
const CURRENT: [i8; 7] = [0, 0, 0, 1, 0, 0, 0];

#[rustfmt::skip]
pub(in crate::model) const UNITS: &[NamedUnit] = &[
    unit("kg",  "kg",  ONCE,              MASS),
    unit("g",   "kg",  (1, 1000, 0),      MASS),
    unit("t",   "kg",  (1000, 1, 0),      MASS),
    unit("m",   "m",   ONCE,              LENGTH),
    unit("km",  "m",   (1000, 1, 0),      LENGTH),
    unit("dm",  "m",   (1, 10, 0),        LENGTH),
    unit("cm",  "m",   (1, 100, 0),       LENGTH),
    unit("mm",  "m",   (1, 1000, 0),      LENGTH),
    unit("um",  "m",   (1, 1_000_000, 0), LENGTH),
    unit("s",   "s",   ONCE,              TIME),
    unit("ms",  "s",   (1, 1000, 0),      TIME),
    unit("us",  "s",   (1, 1_000_000, 0), TIME),
    unit("min", "s",   (60, 1, 0),        TIME),
    unit("h",   "s",   (3600, 1, 0),      TIME),
    unit("rad", "rad", ONCE,              ANGLE),
    unit("deg", "rad", (1, 180, 1),       ANGLE),
    unit("N",   "N",   ONCE,              FORCE),
    unit("mN",  "N",   (1, 1000, 0),      FORCE),
    unit("kN",  "N",   (1000, 1, 0),      FORCE),
    unit("MN",  "N",   (1_000_000, 1, 0), FORCE),
    unit("J",   "J",   ONCE,              ENERGY),
    unit("kJ",  "J",   (1000, 1, 0),      ENERGY),
    unit("MJ",  "J",   (1_000_000, 1, 0), ENERGY),
    unit("W",   "W",   ONCE,              POWER),
    unit("kW",  "W",   (1000, 1, 0),      POWER),
    unit("MW",  "W",   (1_000_000, 1, 0), POWER),
    unit("Pa",  "Pa",  ONCE,              PRESSURE),
    unit("kPa", "Pa",  (1000, 1, 0),      PRESSURE),
    unit("MPa", "Pa",  (1_000_000, 1, 0), PRESSURE),
    unit("GPa", "Pa",  (1_000_000_000, 1, 0), PRESSURE),
    unit("bar", "Pa",  (100_000, 1, 0),   PRESSURE),
    unit("Hz",  "Hz",  ONCE,              [0, 0, -1, 0, 0, 0, 0]),
    unit("kHz", "Hz",  (1000, 1, 0),      [0, 0, -1, 0, 0, 0, 0]),
    unit("rpm", "1/s", (1, 30, 1),        [0, 0, -1, 0, 0, 0, 0]),
    unit("A",   "A",   ONCE,              CURRENT),
    unit("mA",  "A",   (1, 1000, 0),      CURRENT),
    unit("K",   "K",   ONCE,              [0, 0, 0, 0, 1, 0, 0]),
    unit("mol", "mol", ONCE,              [0, 0, 0, 0, 0, 1, 0]),
    unit("cd",  "cd",  ONCE,              [0, 0, 0, 0, 0, 0, 1]),
    unit("V",   "V",   ONCE,              [1, 2, -3, -1, 0, 0, 0]),
    unit("C",   "C",   ONCE,              [0, 0, 1, 1, 0, 0, 0]),
    unit("T",   "T",   ONCE,              [1, 0, -2, -1, 0, 0, 0]),
    unit("Wb",  "Wb",  ONCE,              [1, 2, -2, -1, 0, 0, 0]),
    unit("H",   "H",   ONCE,              [1, 2, -2, -2, 0, 0, 0]),
    unit("F",   "F",   ONCE,              [-1, -2, 4, 2, 0, 0, 0]),
    unit("ohm", "ohm", ONCE,              [1, 2, -3, -2, 0, 0, 0]),
];

impl NamedUnit {
    fn find(name: &str) -> Option<&'static NamedUnit> {
        UNITS.iter().find(|unit| unit.name == name)
    }

    /// `1000 kg`, `kg·m/s²`.
    pub(in crate::model) fn in_words(&self) -> String {
        let dimension = Dimension::integers(self.exponents);
        let scale = self.scale();
        let base = if self.coherent == "rad" { "rad".to_string() } else { dimension.to_string() };
        if scale.is_one() { base } else { format!("{} {base}", scale.to_f64()) }
    }

    /// How many coherent units it is, exactly.
    fn scale(&self) -> Number {
        let (numerator, denominator, pi) = self.multiple;
        let fraction = Number::rational(numerator.into(), denominator.into()).unwrap_or(Number::ONE);
        if pi == 0 { fraction } else { fraction * Number::PI }
    }
}

/// What a unit means.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct Measure {
    /// Its dimension.
    pub(in crate::model) dimension: Dimension,
    /// How many SI units one of it is.
    pub(in crate::model) scale: Number,
    /// The SI unit that it is a multiple of, as one would write it: `N*m`, `m/s^2`, `1`.
    pub(in crate::model) si: String,
}

/// A unit that means nothing.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct UnitError {
    pub(in crate::model) span: Span,
    pub(in crate::model) message: String,
    pub(in crate::model) help: Option<String>,
}

/// What a unit means.
pub(in crate::model) fn measure(unit: &Unit) -> Result<Measure, UnitError> {
    let mut measure = Measure { dimension: Dimension::ONE, scale: Number::ONE, si: String::new() };
    for factor in &unit.factors {
        let named = NamedUnit::find(&factor.name.text).ok_or_else(|| unknown(&factor.name.text, &factor.name.span))?;
        let (n, d) = factor.exponent;
        let too_large = || UnitError {
            span: factor.name.span.clone(),
            message: format!("the exponent of `{}` is out of range", factor.name.text),
            help: None,
        };
        let dimension = Dimension::integers(named.exponents).power(n, d);
        measure.dimension = dimension.and_then(|d| measure.dimension.times(d)).ok_or_else(too_large)?;
        let coherent = |first: bool| match named.coherent.strip_prefix("1/") {
            Some(inverse) => written(inverse, -n, d, first),
            None => written(named.coherent, n, d, first),
        };
        let no_half = || UnitError {
            span: factor.name.span.clone(),
            message: format!("the exponent of `{}` is a whole or a half number, up to 20", factor.name.text),
            help: Some(format!("write `{}`, and the value in it", coherent(true))),
        };
        measure.scale = measure.scale * power(named.scale(), n, d).ok_or_else(no_half)?;
        measure.si += &coherent(measure.si.is_empty());
    }
    if measure.si.is_empty() {
        measure.si.push('1');
    }
    Ok(measure)
}

/// `scale^(n/d)`; `None` where that cannot be had exactly.
fn power(scale: Number, n: i32, d: i32) -> Option<Number> {
    if scale.is_one() {
        return Some(Number::ONE);
    }
    let halves = n.checked_mul(2).filter(|halves| d != 0 && halves % d == 0 && halves.abs() <= 40)?;
    scale.power(halves / d)
}

fn written(name: &str, n: i32, d: i32, first: bool) -> String {
    let negative = (n < 0) != (d < 0);
    let sign = match (first, negative) {
        (true, false) => "",
        (false, false) => "*",
        (true, true) => "1/",
        (false, true) => "/",
    };
    match (n.unsigned_abs(), d.unsigned_abs()) {
        (1, 1) => format!("{sign}{name}"),
        (n, 1) => format!("{sign}{name}^{n}"),
        (n, d) => format!("{sign}{name}^({n}/{d})"),
    }
}

fn unknown(name: &str, span: &Span) -> UnitError {
    let other_case = UNITS.iter().map(|unit| unit.name).find(|unit| unit.eq_ignore_ascii_case(name));
    let product = (1..name.len()).filter(|&at| name.is_char_boundary(at)).map(|at| name.split_at(at));
    let product = product.filter(|(a, b)| NamedUnit::find(a).is_some() && NamedUnit::find(b).is_some());
    let meant = other_case.map(str::to_string).or_else(|| product.map(|(a, b)| format!("{a}*{b}")).next());
    let meant = meant.map(|meant| format!("did you mean `{meant}`?"));
    let meant = offset(name).or(meant).or_else(|| foreign(name)).or_else(|| {
        // One slip makes of any two letters a unit.
        let close = nearest(name, UNITS.iter().map(|unit| unit.name)).filter(|_| name.len() > 2);
        close.map(|meant| format!("did you mean `{meant}`?"))
    });
    let help =
        meant.or_else(|| Some("units are those of the SI: `kg`, `m`, `s`, `rad`, `N`, `J`, `W`, `Pa` …".to_string()));
    UnitError { span: span.clone(), message: format!("`{name}` is not a unit"), help }
}

/// What to write for a scale of temperature whose zero is not that of kelvin.
fn offset(name: &str) -> Option<String> {
    let is_scale =
        ["degC", "degF", "celsius", "fahrenheit", "°C", "°F"].iter().any(|scale| name.eq_ignore_ascii_case(scale));
    is_scale.then(|| "the zero of a unit is zero: temperatures are in kelvin, 20 °C are `293.15 K`".to_string())
}

fn foreign(name: &str) -> Option<String> {
    let (_, value) = FOREIGN.iter().find(|(names, _)| names.contains(&name))?;
    Some(if value.starts_with('`') { format!("write {value}") } else { format!("1 {name} is {value}") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse::syntax::{Name, UnitFactor};

    fn of(factors: &[(&str, i32, i32)]) -> Result<Measure, UnitError> {
        let name = |text: &str| Name { text: text.to_string(), span: 0..0 };
        let factors = factors.iter().map(|&(text, n, d)| UnitFactor { name: name(text), exponent: (n, d) }).collect();
        measure(&Unit { factors, span: 0..0 })
    }

    #[test]
    fn prints_as_in_a_textbook() {
        let print = |exponents| Dimension::integers(exponents).to_string();
        assert_eq!(Dimension::ENERGY.to_string(), "kg·m²/s²");
        assert_eq!(Dimension::ONE.to_string(), "1");
        assert_eq!(Dimension::ANGULAR_VELOCITY.to_string(), "1/s");
        assert_eq!(print(PRESSURE), "kg/(m·s²)");
        assert_eq!(print([0, 12, 0, 0, 0, 0, 0]), "m¹²");
        assert_eq!(Dimension::LENGTH.power(1, 2).unwrap().to_string(), "m^(1/2)");
        assert_eq!(Dimension::ENERGY.in_ascii(), "kg*m^2/s^2");
        assert_eq!(Dimension::integers(PRESSURE).in_ascii(), "kg/(m*s^2)");
    }

    #[test]
    fn algebra() {
        let speed = Dimension::LENGTH.over(Dimension::TIME).unwrap();
        assert_eq!(speed, Dimension::VELOCITY);
        assert_eq!(speed.power(2, 1).and_then(|v| v.times(Dimension::MASS)), Some(Dimension::ENERGY));
        assert_eq!(speed.power(2, 1).and_then(|v| v.power(1, 2)), Some(speed));
        assert_eq!(speed.power(-3, -3), Some(speed));
        assert_eq!(speed.power(1, 0), None);
        assert_eq!(speed.power(i32::MAX, 1), None);
        assert_eq!(Dimension::LENGTH.power(1000, 1).and_then(|d| d.times(d)), None);
    }

    #[test]
    fn units_are_exact_multiples_of_coherent_ones() {
        let check = |factors: &[_], scale: Number, si: &str, dimension: &str| {
            let measure = of(factors).unwrap();
            assert_eq!((measure.scale, measure.si.as_str()), (scale, si));
            assert_eq!(measure.dimension.to_string(), dimension);
        };
        let rational = |n, d| Number::rational(n, d).unwrap();
        check(&[], Number::ONE, "1", "1");
        check(&[("N", 1, 1), ("m", 1, 1)], Number::ONE, "N*m", "kg·m²/s²");
        check(&[("m", 1, 1), ("s", -2, 1)], Number::ONE, "m/s^2", "m/s²");
        check(&[("mm", 2, 1)], rational(1, 1_000_000), "m^2", "m²");
        check(&[("km", 1, 1), ("h", -1, 1)], rational(5, 18), "m/s", "m/s");
        check(&[("s", -1, 1)], Number::ONE, "1/s", "1/s");
        check(&[("m", 1, 3)], Number::ONE, "m^(1/3)", "m^(1/3)");
        check(&[("deg", 1, 1)], Number::PI * rational(1, 180), "rad", "1");
    }

    #[test]
    fn a_wrong_unit_gets_a_suggestion() {
        let help = |name: &str| of(&[(name, 1, 1)]).unwrap_err().help;
        assert_eq!(help("Nm").as_deref(), Some("did you mean `N*m`?"));
        assert_eq!(help("Kg").as_deref(), Some("did you mean `kg`?"));
        assert_eq!(help("lb").as_deref(), Some("1 lb is 0.45359237 kg"));
        assert_eq!(help("degrees").as_deref(), Some("write `deg`"));
        assert_eq!(help("kPaa").as_deref(), Some("did you mean `kPa`?"));
        let kelvin = "the zero of a unit is zero: temperatures are in kelvin, 20 °C are `293.15 K`";
        assert!(["degC", "DegF", "Celsius"].iter().all(|name| help(name).unwrap() == kelvin));
        assert!(help("furlong").unwrap().starts_with("units are those of the SI"));
        assert!(of(&[("m", 1, 0)]).is_err());
        let exponent = |name: &str, n, d| of(&[(name, n, d)]).map_err(|error| (error.message, error.help));
        let no_half = "the exponent of `mm` is a whole or a half number, up to 20".to_string();
        let help = |unit: &str| Some(format!("write `{unit}`, and the value in it"));
        assert_eq!(exponent("mm", 1, 3), Err((no_half.clone(), help("m^(1/3)"))));
        assert_eq!(exponent("mm", -21, 1), Err((no_half, help("1/m^21"))));
        assert!(of(&[("mm", i32::MIN, 1)]).is_err());
    }
}
