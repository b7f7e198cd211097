//! Identifiers: those of the declaration where there is one, never a keyword, never the same twice.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Span};

use crate::expr::{Number, Spline, Symbol, Trigonometry};
use crate::optimise::{Derivation, Instruction, Program, Value};
use crate::variable::Variable;
use crate::variable::component_names;

/// Names that a local may not take: generics, parameters of functions, and what patterns would take for constants.
const RESERVED: [&str; 14] = [
    "ELIMINATION",
    "T",
    "t",
    "params",
    "None",
    "Some",
    "Ok",
    "Err",
    "CONSERVED",
    "PARAMETERS",
    "mass_matrix",
    "right_side",
    "factors",
    "result",
];

/// Arguments that a component may shadow where it is destructured after all others that are read.
pub(super) const ARGUMENTS: [&str; 6] = ["q", "qd", "qdd", "u", "prescribed", "multipliers"];

/// What a struct cannot be called: names that the module has for other types and for modules, and the primitive types.
const TYPES: [&str; 23] = [
    "coordinate",
    "input",
    "Params",
    "UncheckedParams",
    "Self",
    "T",
    "bool",
    "char",
    "f32",
    "f64",
    "i8",
    "i16",
    "i32",
    "i64",
    "i128",
    "isize",
    "str",
    "u8",
    "u16",
    "u32",
    "u64",
    "u128",
    "usize",
];

/// Names of methods that generated functions may not take.
const METHODS: [&str; 5] = ["new", "try_new", "params", "default", "clone"];

/// Keywords that `r#` does not escape.
const UNESCAPABLE: [&str; 4] = ["self", "Self", "super", "crate"];

/// Longest name that is made up from a formula.
const LONGEST: usize = 24;

/// The identifier for a name: as it is, where Rust allows it.
pub(super) fn identifier(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("_{plain}") } else { plain };
    // Keywords have letters alone, at most eight: syn is not asked about other names.
    let may_be_keyword = plain.len() <= 8 && plain.bytes().all(|c| c.is_ascii_alphabetic());
    let is_keyword = may_be_keyword && syn::parse_str::<Ident>(&plain).is_err();
    if is_keyword || ["_", "gen"].contains(&plain.as_str()) { format!("{plain}_") } else { plain }
}

/// The identifier for a name that users of the code write: `r#type` of a keyword, which is as near as Rust comes to it;
/// `self_` of the few that cannot be escaped.
pub(super) fn escaped(name: &str) -> String {
    let raw = format!("r#{name}");
    let is_keyword = identifier(name) == format!("{name}_") && syn::parse_str::<Ident>(&raw).is_ok();
    if is_keyword && !UNESCAPABLE.contains(&name) { raw } else { identifier(name) }
}

/// Tokens of an identifier.
pub(super) fn ident(name: &str) -> Ident {
    match name.strip_prefix("r#") {
        Some(keyword) => Ident::new_raw(keyword, Span::call_site()),
        None => Ident::new(name, Span::call_site()),
    }
}

/// A name with a prefix where a language has another meaning for it, and where it reads like a name with that prefix:
/// different names stay different.
pub(super) fn prefixed(name: &str, prefix: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut rest = Some(name);
    while let Some(inner) = rest {
        if is_taken(inner) {
            return format!("{prefix}{name}");
        }
        rest = inner.strip_prefix(prefix);
    }
    name.to_string()
}

/// A name with a number behind it where something else has it, and where it reads like such a name.
pub(super) fn second(name: &str, taken: &[&str]) -> String {
    if taken.contains(&name.trim_end_matches("_2")) { format!("{name}_2") } else { name.to_string() }
}

/// `CartPole` → `cart_pole`, `Arm6` → `arm6`, `NPendulum` → `n_pendulum`, `SCARA` → `scara`.
pub(super) fn snake_case(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    let mut snake = String::new();
    for (i, c) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| letters[i]);
        let after = letters.get(i + 1);
        let word_ends = before.is_some_and(|b| b.is_ascii_lowercase() || b.is_ascii_digit());
        let acronym_ends =
            before.is_some_and(|b| b.is_ascii_uppercase()) && after.is_some_and(char::is_ascii_lowercase);
        if c.is_ascii_uppercase() && (word_ends || acronym_ends) {
            snake.push('_');
        }
        snake.push(c.to_ascii_lowercase());
    }
    snake
}

/// The struct of a mechanism.
pub(super) fn type_name(mechanism: &str) -> String {
    if TYPES.contains(&mechanism) { format!("{mechanism}Mechanism") } else { escaped(mechanism) }
}

/// Names in use.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    taken: BTreeSet<String>,
}

impl Scope {
    fn with(names: &[&str]) -> Self {
        Scope { taken: names.iter().map(ToString::to_string).collect() }
    }

    /// `wish` if it is free, else the first free one of `wish_2`, `wish_3`, …; taken from now on.
    pub(super) fn unique(&mut self, wish: &str) -> String {
        let wish = identifier(wish);
        let numbered = (2..).map(|i| format!("{wish}_{i}"));
        let free = std::iter::once(wish.clone()).chain(numbered).find(|name| !self.taken.contains(name));
        let name = free.expect("there are more numbers than names");
        self.taken.insert(name.clone());
        name
    }

    /// Distinct names for what users of the code write: those that need no escape are as they are, whatever comes
    /// before.
    fn unique_escaped<'a>(&mut self, wishes: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
        let is_plain = |wish: &&str| escaped(wish) == **wish;
        let plain: Vec<String> = wishes.clone().filter(is_plain).map(|wish| self.unique(wish)).collect();
        let mut plain = plain.into_iter();
        let name = |wish: &str| {
            let name = escaped(wish);
            if name == wish {
                return plain.next().unwrap_or(name);
            }
            if self.taken.insert(name.clone()) { name } else { self.unique(wish) }
        };
        wishes.map(name).collect()
    }

    /// The name, if it is free; taken from now on.
    pub(super) fn exactly(&mut self, name: &str) -> Option<String> {
        let is_free = !self.taken.contains(name) && identifier(name) == name;
        is_free.then(|| {
            self.taken.insert(name.to_string());
            name.to_string()
        })
    }
}

/// All names of a mechanism but those of the locals of one function.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// Which sines and cosines are computed.
    pub(super) trigonometry: Trigonometry,
    /// The mechanism's struct.
    pub(super) mechanism: String,
    /// The fields of `Params`, one per declared parameter.
    pub(super) fields: Vec<String>,
    /// The methods, one per function.
    pub(super) functions: Vec<String>,
    /// A private method, which gives way to an output of its name.
    pub(super) constrained_motion: String,
    /// The function of the entries of M and A that are not zero, where they are eliminated in a known order.
    pub(super) constrained_system: String,
    /// A local: what the columns of a linearization are measured by.
    pub(super) scale: String,
    /// The splines of all programs, each once, as the constants `TABLE_0`, `TABLE_1`, ….
    pub(super) splines: Vec<Spline>,
    /// The fields that hold hoisted values.
    pub(super) hoisted: Vec<String>,
    /// Components as locals, by kind.
    coordinates: Vec<String>,
    velocities: Vec<String>,
    accelerations: Vec<String>,
    inputs: Vec<String>,
    parameters: Vec<String>,
    /// Value, first and second derivative of each prescribed motion.
    prescribed: Vec<[String; 3]>,
    multipliers: Vec<String>,
    /// What is taken in every function.
    scope: Scope,
}

impl Names {
    pub(super) fn of(derivation: &Derivation, trigonometry: Trigonometry) -> Self {
        let mut scope = Scope::with(&RESERVED);
        let splines: Vec<Spline> = derivation.splines().into_iter().cloned().collect();
        scope.taken.extend((0..splines.len()).map(table));
        // A coordinate may be called `q`, for `let [q] = *q` is the first binding; inputs come after all coordinates.
        let coordinates = components(&derivation.coordinates, &mut scope, &["qd", "qdd", "u"]);
        let inputs = components(&derivation.inputs, &mut scope, &[]);
        let parameters = components(&derivation.parameters, &mut scope, &[]);
        for argument in ARGUMENTS {
            scope.taken.insert(argument.to_string());
        }
        let rates = |suffix: &str, scope: &mut Scope| -> Vec<String> {
            coordinates.iter().map(|name| scope.unique(&format!("{name}_{suffix}"))).collect()
        };
        let velocities = rates("dot", &mut scope);
        let accelerations = rates("ddot", &mut scope);
        let prescribed = component_names(&derivation.prescribed)
            .into_iter()
            .map(|name| ["", "_dot", "_ddot"].map(|suffix| scope.unique(&format!("{name}{suffix}"))));
        let prescribed = prescribed.collect();
        let multipliers = derivation.constraints.iter().map(|row| scope.unique(&format!("lambda_{row}"))).collect();
        let scale = if derivation.constraints.is_empty() { String::new() } else { scope.unique("scale") };
        let described = described(&derivation.constructor, &parameters);
        let hoisted = derivation.constructor.results.iter().enumerate().map(|(i, value)| {
            let note = || {
                derivation
                    .constructor
                    .notes
                    .iter()
                    .find(|(noted, name)| noted == value && !name.starts_with("by_"))
                    .map(|(_, name)| name)
            };
            let name = described[value.index()].as_ref().or_else(note).and_then(|name| scope.exactly(name));
            name.unwrap_or_else(|| scope.unique(&format!("k{i}")))
        });
        let hoisted = hoisted.collect();
        let mut fields = Scope::default();
        let mut methods = Scope::with(&METHODS);
        Names {
            trigonometry,
            mechanism: type_name(&derivation.name),
            fields: fields.unique_escaped(derivation.parameters.iter().map(|p| p.name.as_str())),
            functions: methods.unique_escaped(derivation.functions.iter().map(|f| f.name.as_str())),
            constrained_motion: methods.unique("constrained_motion"),
            constrained_system: methods.unique("constrained_system"),
            scale,
            splines,
            hoisted,
            coordinates,
            velocities,
            accelerations,
            inputs,
            parameters,
            prescribed,
            multipliers,
            scope,
        }
    }

    /// The local that holds a symbol.
    pub(super) fn symbol(&self, symbol: Symbol) -> &str {
        match symbol {
            Symbol::Time => "t",
            Symbol::Coordinate(i) => &self.coordinates[i as usize],
            Symbol::Velocity(i) => &self.velocities[i as usize],
            Symbol::Acceleration(i) => &self.accelerations[i as usize],
            Symbol::Parameter(i) => &self.parameters[i as usize],
            Symbol::Input(i) => &self.inputs[i as usize],
            Symbol::Prescribed(i, order) => &self.prescribed[i as usize][usize::from(order)],
            Symbol::Multiplier(i) => &self.multipliers[i as usize],
        }
    }

    /// The number of a spline.
    pub(super) fn spline(&self, spline: &Spline) -> usize {
        self.splines.iter().position(|known| known == spline).expect("all splines have numbers")
    }

    /// Where the locals of a function get their names.
    pub(super) fn function_scope(&self) -> Scope {
        self.scope.clone()
    }

    /// Where the locals of the constructor get theirs: the fields are no locals there.
    pub(super) fn constructor_scope(&self) -> Scope {
        let mut scope = self.scope.clone();
        scope.taken.retain(|name| !self.hoisted.contains(name));
        scope
    }
}

/// The constant that holds the spline with this number.
pub(super) fn table(number: usize) -> String {
    format!("TABLE_{number}")
}

/// The components of some variables, none of them called like an argument that is `read_later`.
fn components(variables: &[Variable], scope: &mut Scope, read_later: &[&str]) -> Vec<String> {
    let name = |name: String| {
        let wish = if read_later.contains(&name.as_str()) { format!("{name}_") } else { name };
        scope.unique(&wish)
    };
    component_names(variables).into_iter().map(name).collect()
}

/// How much of a formula a name says.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Grade {
    Atom,
    Product,
    Sum,
}

/// A name for each value that depends on parameters alone: `m_bob_length`, `m_cart_plus_m_bob`. `None` where it would
/// be long or could be misread.
fn described(program: &Program, parameters: &[String]) -> Vec<Option<String>> {
    let mut names: Vec<Option<(String, Grade)>> = Vec::new();
    for instruction in &program.instructions {
        let name = grade(*instruction, &names, parameters);
        names.push(name.filter(|(name, _)| name.len() <= LONGEST));
    }
    names.into_iter().map(|name| name.map(|(name, _)| name)).collect()
}

fn grade(
    instruction: Instruction,
    names: &[Option<(String, Grade)>],
    parameters: &[String],
) -> Option<(String, Grade)> {
    let at_most = |value: Value, limit: Grade| {
        names[value.index()].as_ref().filter(|(_, grade)| *grade <= limit).map(|(name, _)| name)
    };
    let both = |a: Value, b: Value, limit: Grade, between: &str| {
        Some(format!("{}{between}{}", at_most(a, limit)?, at_most(b, limit)?))
    };
    match instruction {
        Instruction::Constant(number) => Some((factor(number)?.to_string(), Grade::Atom)),
        Instruction::Symbol(Symbol::Parameter(i)) => Some((parameters[i as usize].clone(), Grade::Atom)),
        Instruction::Mul(a, b) if a == b => Some((format!("{}_squared", at_most(a, Grade::Atom)?), Grade::Product)),
        Instruction::Mul(a, b) => Some((both(a, b, Grade::Product, "_")?, Grade::Product)),
        Instruction::Div(a, b) => Some((both(a, b, Grade::Atom, "_per_")?, Grade::Sum)),
        Instruction::Add(a, b) => Some((both(a, b, Grade::Product, "_plus_")?, Grade::Sum)),
        Instruction::Sub(a, b) => Some((both(a, b, Grade::Product, "_minus_")?, Grade::Sum)),
        Instruction::Symbol(_)
        | Instruction::Hoisted(_)
        | Instruction::Neg(_)
        | Instruction::Sqrt(_)
        | Instruction::Call(..)
        | Instruction::Less(..)
        | Instruction::LessEqual(..)
        | Instruction::And(..)
        | Instruction::Not(_)
        | Instruction::Select(..)
        | Instruction::Spline(..)
        | Instruction::Call2(..) => None,
    }
}

fn factor(number: Number) -> Option<&'static str> {
    let names = [(0.5, "half"), (1.0, "one"), (2.0, "two"), (3.0, "three"), (4.0, "four")];
    names.into_iter().find(|(value, _)| *value == number.to_f64()).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_are_in_snake_case() {
        let cases = [
            ("CartPole", "cart_pole"),
            ("Arm6", "arm6"),
            ("Arm6Params", "arm6_params"),
            ("NPendulum", "n_pendulum"),
            ("SCARA", "scara"),
            ("XYTable", "xy_table"),
            ("Match", "match"),
        ];
        for (name, expected) in cases {
            assert_eq!(snake_case(name), expected);
        }
    }

    #[test]
    fn identifiers_are_never_keywords() {
        for (name, expected) in
            [("theta", "theta"), ("match", "match_"), ("gen", "gen_"), ("self", "self_"), ("2nd", "_2nd"), ("µ", "__")]
        {
            assert_eq!(identifier(name), expected);
        }
        // All keywords, and those that are kept for later.
        for keyword in
            "Self self gen abstract as async await become box break const continue crate do dyn else enum extern false \
            final fn for if impl in let loop macro match mod move mut override priv pub ref return static struct super \
            trait true try type typeof unsafe unsized use virtual where while yield"
                .split_whitespace()
        {
            assert_eq!(identifier(keyword), format!("{keyword}_"));
        }
    }

    #[test]
    fn what_users_write_is_escaped() {
        let cases = [("type", "r#type"), ("gen", "r#gen"), ("self", "self_"), ("crate", "crate_"), ("theta", "theta")];
        for (name, expected) in cases {
            assert_eq!(escaped(name), expected);
            assert_eq!(ident(expected).to_string(), expected);
        }
        let mut scope = Scope::default();
        let names = scope.unique_escaped(["self", "m", "self_", "type", "l", "type"].into_iter());
        assert_eq!(names, ["self__2", "m", "self_", "r#type", "l", "type_"]);
        assert_eq!((type_name("loop"), type_name("Self")), ("r#loop".to_string(), "SelfMechanism".to_string()));
        assert_eq!(type_name("coordinate"), "coordinateMechanism");
    }

    #[test]
    fn names_are_never_the_same_twice() {
        let mut scope = Scope::with(&["t"]);
        assert_eq!(scope.unique("t"), "t_2");
        assert_eq!(scope.unique("x"), "x");
        assert_eq!(scope.unique("x"), "x_2");
        assert_eq!(scope.exactly("x"), None);
        assert_eq!(scope.exactly("if"), None);
        assert_eq!(scope.exactly("y").as_deref(), Some("y"));
    }
}
