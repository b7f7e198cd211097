//! Random mechanisms, right by construction: dimensions fit, every coordinate has inertia or a constraint that carries
//! it, no function leaves its domain.
//!
//! - `scalar`: numbers, lengths and angles that depend on positions; `frame`: poses, places and bodies;
//! - `statement`: energies, forces, outputs; `constraint`: constraints;
//! - `part`: statements that are used many times; `sample`: tables; `array`: arrays and matrices of parameters;
//! - `corner`: branches, absolute values and conditions on which a careless proof would cry wolf.

mod array;
mod constraint;
mod corner;
mod frame;
mod part;
mod sample;
mod scalar;
mod statement;

use std::collections::{BTreeMap, BTreeSet};

use crate::random::Random;

/// What a random mechanism may be made of, beside the plainest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Construct {
    /// Chains and trees of frames with bodies.
    Trees,
    /// Energies written with `dt`, masses that depend on places, terms linear in the velocities.
    Energies,
    /// `if … else`, `min`, `max`, `clamp`, `abs`, `signum`.
    Branches,
    /// Functions of the text.
    Functions,
    /// Constants and functions of other files.
    Imports,
    /// Arrays and loops.
    Loops,
    /// Prescribed motions, with and without a formula, and t itself.
    Signals,
    /// Holonomic and Pfaffian constraints, coordinates without inertia of their own.
    Constraints,
    /// Loops that a constraint closes, by rows that are redundant where they hold.
    Closures,
    /// Bodies that roll.
    Rolling,
    /// Keywords of Rust, and words that begin statements, as names.
    Keywords,
    /// Bodies whose attitude is a unit quaternion.
    Quaternions,
    /// The statement that acts on all bodies.
    Gravity,
    /// Forces at points, torques on bodies.
    PointForces,
    /// Dissipation, and forces on coordinates.
    Forces,
    /// Wrenches at joints.
    Reactions,
    /// Outputs of all shapes.
    Outputs,
    /// Parameters and constants in units that are not SI.
    Units,
    /// Very large and very small masses, lengths and times.
    Scales,
    /// Statements that are used many times.
    Parts,
    /// Values between samples, from the text and from files.
    Tables,
    /// Inertias, axes, vectors and quaternions as arrays, matrices of parameters, roll, pitch and yaw.
    Arrays,
    /// No dimensional analysis.
    Dimensionless,
}

impl Construct {
    /// All of them.
    pub const ALL: [Self; 23] = [
        Self::Trees,
        Self::Energies,
        Self::Branches,
        Self::Functions,
        Self::Imports,
        Self::Loops,
        Self::Signals,
        Self::Constraints,
        Self::Closures,
        Self::Rolling,
        Self::Keywords,
        Self::Quaternions,
        Self::Gravity,
        Self::PointForces,
        Self::Forces,
        Self::Reactions,
        Self::Outputs,
        Self::Units,
        Self::Scales,
        Self::Parts,
        Self::Tables,
        Self::Arrays,
        Self::Dimensionless,
    ];

    /// As it is written on the command line.
    pub fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// What brings many coordinates with it.
const LARGE: [Construct; 5] =
    [Construct::Loops, Construct::Closures, Construct::Rolling, Construct::Quaternions, Construct::Parts];

/// A text, and what it imports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawn {
    /// The mechanism.
    pub text: String,
    /// Texts by their paths.
    pub imports: BTreeMap<String, String>,
    /// What it is made of.
    pub constructs: BTreeSet<Construct>,
}

/// The mechanism of a seed; `wanted` is among what it is made of, `without` is not.
pub fn draw(seed: u64, wanted: Option<Construct>, without: &[Construct]) -> Drawn {
    let mut random = Random::new(seed);
    // Nearly all constructs are met once in three, so that pairs are met often, and mechanisms stay small.
    let mut constructs: BTreeSet<Construct> = Construct::ALL.into_iter().filter(|_| random.one_in(3)).collect();
    // Of those that bring many coordinates most mechanisms have one: what a mechanism costs grows with the cube of
    // their number.
    if !random.one_in(8) {
        let kept = LARGE[(random.bits() % LARGE.len() as u64) as usize];
        constructs.retain(|construct| *construct == kept || !LARGE.contains(construct));
    }
    constructs.extend(wanted);
    constructs.retain(|construct| !without.contains(construct));
    if wanted != Some(Construct::Dimensionless) && !random.one_in(3) {
        constructs.remove(&Construct::Dimensionless);
    }
    if constructs.contains(&Construct::Reactions) {
        constructs.insert(Construct::Trees);
    }
    let mut draw = Draw::new(random, constructs);
    draw.mechanism();
    draw.finished()
}

/// The piecewise mechanism of a seed: conditions, corners and sides of every kind, in energies, forces, constraints and
/// outputs of what [`draw`] draws.
pub fn draw_piecewise(seed: u64) -> Drawn {
    let mut random = Random::new(seed ^ 0x636f_726e_6572);
    let mut constructs: BTreeSet<Construct> = PIECEWISE.into_iter().filter(|_| random.one_in(4)).collect();
    if constructs.contains(&Construct::Reactions) {
        constructs.insert(Construct::Trees);
    }
    let left_out = [(8, &OPAQUE[..]), (3, &ROOTS), (3, &LARGE_AND_SMALL)]
        .map(|(n, parts)| if random.one_in(n) { &[] } else { parts });
    let mut draw = Draw::new(random, constructs);
    draw.left_out = left_out.concat();
    draw.mechanism();
    draw.corners();
    draw.finished()
}

/// Functions of which fields know no law: where one is, what differs between sides of choices is proved in doubles.
const OPAQUE: [&str; 6] = ["atan", "asin", "acos", "ln(", "^(1/3)", "^sin"];

/// Roots: where some depend on others, nothing is proved in fields.
const ROOTS: [&str; 5] = ["sqrt", "hypot", "^1.5", "^2.5", "^(-1/2)"];

/// Numbers beside which others are lost.
const LARGE_AND_SMALL: [&str; 4] = ["1e12", "1e-200", "1e9", "1e16"];

/// What piecewise mechanisms are made of besides: no tables, because fields know no law of them.
const PIECEWISE: [Construct; 14] = [
    Construct::Trees,
    Construct::Energies,
    Construct::Branches,
    Construct::Functions,
    Construct::Signals,
    Construct::Constraints,
    Construct::Quaternions,
    Construct::Gravity,
    Construct::PointForces,
    Construct::Forces,
    Construct::Reactions,
    Construct::Outputs,
    Construct::Units,
    Construct::Scales,
];

/// A length or an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    Length,
    Angle,
}

/// A coordinate, as it is written.
#[derive(Clone, Debug)]
struct Coordinate {
    name: String,
    measure: Measure,
}

/// Keywords of Rust that are not keywords of the language, and words that have a meaning at some places of it.
const WORDS: [&str; 43] = [
    "abstract", "async", "await", "become", "box", "break", "continue", "crate", "do", "dyn", "enum", "extern",
    "final", "gen", "impl", "loop", "macro", "match", "mod", "move", "override", "priv", "pub", "ref", "return",
    "static", "struct", "super", "trait", "try", "type", "union", "unsafe", "use", "virtual", "where", "yield", "self",
    "part", "table", "rpy", "shape", "positive",
];

/// A mechanism in the making.
struct Draw {
    random: Random,
    constructs: BTreeSet<Construct>,
    /// Powers of ten of masses, lengths and times.
    scale: [i32; 3],
    declarations: Vec<String>,
    statements: Vec<String>,
    functions: Vec<String>,
    shared: Vec<String>,
    /// Tables in files of their own.
    tables: Vec<(String, String)>,
    /// Parameters by what they are a measure of.
    parameters: Vec<(String, [i32; 3])>,
    coordinates: Vec<Coordinate>,
    inputs: Vec<String>,
    /// What stands for a length or an angle beside coordinates.
    lengths: Vec<String>,
    angles: Vec<String>,
    plains: Vec<String>,
    /// Names of poses and of places that move.
    poses: Vec<String>,
    places: Vec<String>,
    /// Poses that a coordinate turns.
    turning: Vec<String>,
    /// Functions of one plain argument.
    plain_functions: Vec<String>,
    /// Those that a table gives, with kinks or without.
    tabulated: Vec<String>,
    /// Forms of numbers with one of these are left out.
    left_out: Vec<&'static str>,
    names: usize,
    /// Words that are names of nothing yet.
    words: Vec<&'static str>,
}

impl Draw {
    fn new(mut random: Random, constructs: BTreeSet<Construct>) -> Self {
        let mut exponent = |bound: u64| (random.bits() % (2 * bound + 1)) as i32 - bound as i32;
        let scale =
            if constructs.contains(&Construct::Scales) { [exponent(9), exponent(4), exponent(3)] } else { [0; 3] };
        Draw {
            random,
            constructs,
            scale,
            declarations: Vec::new(),
            statements: Vec::new(),
            functions: Vec::new(),
            shared: Vec::new(),
            tables: Vec::new(),
            parameters: Vec::new(),
            coordinates: Vec::new(),
            inputs: Vec::new(),
            lengths: Vec::new(),
            angles: Vec::new(),
            plains: Vec::new(),
            poses: Vec::new(),
            places: Vec::new(),
            turning: Vec::new(),
            plain_functions: Vec::new(),
            tabulated: Vec::new(),
            left_out: Vec::new(),
            names: 0,
            words: WORDS.to_vec(),
        }
    }

    fn has(&self, construct: Construct) -> bool {
        self.constructs.contains(&construct)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.random.bits() % n as u64) as usize
    }

    fn chance(&mut self, percent: u64) -> bool {
        self.random.bits() % 100 < percent
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        let i = self.below(from.len());
        from[i].clone()
    }

    /// A name that nothing else has.
    fn fresh(&mut self, stem: &str) -> String {
        self.fresh_but(&[], stem)
    }

    /// A name of a function that hides none that the text calls.
    fn fresh_function(&mut self, stem: &str) -> String {
        let called = [(Construct::Tables, "table"), (Construct::Arrays, "rpy")];
        let hidden: Vec<&str> = called.iter().filter(|(by, _)| self.has(*by)).map(|(_, name)| *name).collect();
        self.fresh_but(&hidden, stem)
    }

    /// A name of a part, which does not begin a statement of its own.
    fn fresh_part(&mut self, stem: &str) -> String {
        self.fresh_but(&["part"], stem)
    }

    fn fresh_but(&mut self, unfit: &[&str], stem: &str) -> String {
        self.names += 1;
        let fit: Vec<usize> = (0..self.words.len()).filter(|&at| !unfit.contains(&self.words[at])).collect();
        if self.has(Construct::Keywords) && self.chance(40) && !fit.is_empty() {
            let at = self.pick(&fit);
            return self.words.swap_remove(at).to_string();
        }
        format!("{stem}{}", self.names)
    }

    fn say(&mut self, statement: String) {
        self.statements.push(statement);
    }

    /// A number between 0.1 and 4, as people write them.
    fn number(&mut self) -> String {
        match self.below(5) {
            0 => format!("{}", 1 + self.below(3)),
            1 => format!("0.{}", 1 + self.below(99)),
            2 => format!("{}.{}", 1 + self.below(3), self.below(10)),
            3 => format!("{}/{}", 1 + self.below(5), 2 + self.below(5)),
            _ => format!("{}e-{}", 1 + self.below(30), 1),
        }
    }

    /// A parameter of this dimension in kg, m, s: one that there is, or a new one.
    fn parameter(&mut self, dimension: [i32; 3]) -> String {
        let known: Vec<String> =
            self.parameters.iter().filter(|(_, known)| *known == dimension).map(|(name, _)| name.clone()).collect();
        if !known.is_empty() && self.chance(60) {
            return self.pick(&known);
        }
        let (unit, shift) = self.unit(dimension);
        let exponent: i32 = dimension.iter().zip(self.scale).map(|(power, scale)| power * scale).sum();
        let value = self.scaled(exponent - shift);
        // A quantity in place; its unit cannot begin with `1/`, and a quotient has none.
        // Without dimensions nobody knows whether t is the time.
        let is_unknown = unit.starts_with('1') || unit == "t" && self.has(Construct::Dimensionless);
        if self.has(Construct::Units) && self.chance(15) && !is_unknown && !value.contains('/') {
            return format!("({value} {unit})");
        }
        let name = self.fresh("p");
        let constant = self.has(Construct::Units) && self.chance(20);
        let keyword = if constant { "const" } else { "param" };
        self.declarations.push(format!("{keyword} {name}: {unit} = {value};"));
        self.parameters.push((name.clone(), dimension));
        name
    }

    /// A positive number times a power of ten.
    fn scaled(&mut self, exponent: i32) -> String {
        if exponent == 0 {
            return self.number();
        }
        format!("{}.{}e{exponent}", 1 + self.below(4), self.below(100))
    }

    /// A unit of a dimension, and the power of ten that it is.
    fn unit(&mut self, dimension: [i32; 3]) -> (String, i32) {
        let plain = ["kg", "m", "s"];
        let other: &[(&str, [i32; 3], i32)] = &[
            ("g", [1, 0, 0], -3),
            ("t", [1, 0, 0], 3),
            ("mm", [0, 1, 0], -3),
            ("km", [0, 1, 0], 3),
            ("ms", [0, 0, 1], -3),
            ("kN", [1, 1, -2], 3),
            ("N/mm", [1, 0, -2], 3),
            ("mN*m", [1, 2, -2], -3),
            ("N*s/m", [1, 0, -1], 0),
            ("kg*cm^2", [1, 2, 0], -4),
            ("kW", [1, 2, -3], 3),
            ("1/ms", [0, 0, -1], 3),
            ("kHz", [0, 0, -1], 3),
            ("mm/ms^2", [0, 1, -2], 3),
        ];
        if self.has(Construct::Units) {
            let fitting: Vec<(&str, i32)> = other
                .iter()
                .filter(|(_, known, _)| *known == dimension)
                .map(|(unit, _, shift)| (*unit, *shift))
                .collect();
            if !fitting.is_empty() && self.chance(60) {
                let (unit, shift) = self.pick(&fitting);
                return (unit.to_string(), shift);
            }
        }
        let named = match dimension {
            [1, 1, -2] => "N",
            [1, 2, -2] => "J",
            [1, 0, -2] => "N/m",
            [1, 2, -3] => "W",
            [0, 0, 0] => "1",
            _ => {
                let factor = |(unit, power): (&str, &i32)| match power {
                    1 => unit.to_string(),
                    power => format!("{unit}^{power}"),
                };
                let factors = plain.into_iter().zip(&dimension).filter(|(_, power)| **power != 0).map(factor);
                return (factors.collect::<Vec<_>>().join("*"), 0);
            }
        };
        (named.to_string(), 0)
    }

    fn coordinate(&mut self, measure: Measure) -> String {
        let name = self.fresh(if measure == Measure::Length { "x" } else { "a" });
        let unit = if measure == Measure::Length { "m" } else { "rad" };
        self.declarations.push(format!("coord {name}: {unit};"));
        self.coordinates.push(Coordinate { name: name.clone(), measure });
        name
    }

    fn input(&mut self, unit: &str) -> String {
        let name = self.fresh("u");
        self.declarations.push(format!("input {name}: {unit};"));
        self.inputs.push(name.clone());
        name
    }

    /// Declarations and statements in an order that mostly does not matter.
    fn mechanism(&mut self) {
        if self.has(Construct::Gravity) {
            let (vector, turned) = (self.fixed_vector([0, 1, -2]), self.chance(30));
            self.say(format!("gravity {}{vector};", if turned { "rot_x(0.7) * " } else { "" }));
        }
        self.functions_of_the_text();
        self.signals();
        if self.has(Construct::Tables) {
            self.samples();
        }
        if self.has(Construct::Arrays) {
            self.grid();
        }
        let count = 1 + self.below(2);
        for _ in 0..count {
            let measure = if self.chance(50) { Measure::Length } else { Measure::Angle };
            let coordinate = self.coordinate(measure);
            self.own_inertia(&coordinate, measure);
        }
        if self.has(Construct::Trees) {
            self.tree();
        }
        if self.has(Construct::Quaternions) {
            self.quaternion_body();
        }
        if self.has(Construct::Loops) {
            self.loops();
        }
        if self.has(Construct::Parts) {
            self.parts();
        }
        if self.has(Construct::Closures) {
            self.closures();
        }
        if self.has(Construct::Rolling) {
            self.rolling();
        }
        self.energies();
        self.forces();
        if self.has(Construct::Constraints) {
            self.constraints();
        }
        if self.has(Construct::Outputs) {
            self.outputs();
        }
    }

    fn finished(mut self) -> Drawn {
        let mut text = String::new();
        let mut imports = BTreeMap::new();
        if !self.shared.is_empty() {
            imports.insert("shared.mbs".to_string(), self.shared.join("\n") + "\n");
            text += "import \"shared.mbs\";\n";
        }
        for (path, table) in std::mem::take(&mut self.tables) {
            text += &format!("import \"{path}\";\n");
            imports.insert(path, table);
        }
        if self.has(Construct::Dimensionless) {
            text += "#![dimensionless]\n";
        }
        text += "mechanism Random {\n";
        let functions = std::mem::take(&mut self.functions);
        for line in self.declarations.iter().chain(&functions).chain(&self.statements) {
            text += &format!("    {line}\n");
        }
        text += "}\n";
        Drawn { text, imports, constructs: self.constructs }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every word is a name of something, but none of what it would hide.
    #[test]
    fn words_are_names_where_they_may_be() {
        let texts: Vec<String> = (0..3000).map(|seed| draw(seed, Some(Construct::Keywords), &[]).text).collect();
        let anywhere = |what: &str| texts.iter().any(|text| text.contains(what));
        for text in &texts {
            assert!(!text.contains("part part("), "{text}");
            assert!(!(text.contains("fn table(") && text.contains("= table(r, ")), "{text}");
            assert!(!(text.contains("fn rpy(") && text.contains("* rpy(")), "{text}");
        }
        for word in WORDS {
            let declared = ["param", "coord", "let", "let mut", "output"].map(|what| format!("{what} {word}"));
            assert!(declared.iter().any(|what| anywhere(what)), "{word} names nothing");
        }
        assert!(anywhere("fn table(") && anywhere("fn rpy(") && anywhere("fn part("));
    }
}
