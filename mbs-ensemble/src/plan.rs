//! A plan: what varies, how often, and what is wanted of each motion, as a text of TOML.
//!
//! ```toml
//! mechanism = "pendulum.mbs"     # a path from the plan
//! members = 1000                 # how often what is drawn is drawn
//! seed = 1
//! design = "latin-hypercube"     # or "random", "sobol", "saltelli", "chaos"
//!
//! [parameters]                   # what formulas of inputs need and the mechanism does not have
//! gain = "2 N*m/rad"
//!
//! [inputs]                       # formulas, or `@table.csv`
//! tau = "-gain*theta"
//!
//! [fixed]                        # parameters, coordinates, rates and inputs that are the same in all members
//! l = "80 cm"
//!
//! [vary]
//! theta = { from = "10 deg", to = "170 deg", count = 17 }   # a grid: each value meets each of the others
//! gain = { values = [0, 2, 4] }
//! m = { normal = ["1 kg", "50 g"], within = ["0.8 kg", "1.2 kg"] }   # mean and deviation, and where it is cut off
//! g = { uniform = [9.78, 9.83] }
//!
//! [motion]
//! duration = "10 s"
//!
//! [quantities]
//! highest = { max = "l*(1 - cos(theta))" }
//! ```
//!
//! [`Plan::read`] finds what is wrong with the text alone; [`Plan::design`] asks a
//! [`Vocabulary`](crate::Vocabulary) for names and units.

mod reading;

use std::ops::Range;
use std::path::PathBuf;

use crate::fault::{Fault, Faults};
use crate::sequence::Kind;

/// Something with the bytes of the plan that it is written in.
#[derive(Clone, Debug, PartialEq)]
pub struct Located<T> {
    /// What is written.
    pub value: T,
    /// Where.
    pub span: Range<usize>,
}

/// An entry `name = value` of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Named<T> {
    /// The key.
    pub name: Located<String>,
    /// What it stands for.
    pub value: T,
}

/// A number in the unit of its variable, or a text with its own unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Amount {
    /// `2.5`
    Number(f64),
    /// `"20 deg"`
    Text(String),
}

/// How a variable differs from member to member.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// `values = […]`
    Values(Vec<Located<Amount>>),
    /// `from`, `to` and `count`, both ends included.
    Range {
        /// The first value.
        from: Located<Amount>,
        /// The last value.
        to: Located<Amount>,
        /// How many.
        count: u64,
    },
    /// `uniform = [lowest, highest]`
    Uniform([Located<Amount>; 2]),
    /// `triangular = [lowest, most likely, highest]`
    Triangular([Located<Amount>; 3]),
    /// `normal = [mean, deviation]`, cut off where `within = [lowest, highest]` says so.
    Normal {
        /// Mean and deviation.
        of: [Located<Amount>; 2],
        /// Lowest and highest value.
        within: Option<[Located<Amount>; 2]>,
    },
    /// `lognormal = [median, deviation of the logarithm]`
    Lognormal([Located<Amount>; 2]),
}

impl Spread {
    /// The amounts that are in the unit of the variable.
    pub fn amounts(&self) -> Vec<&Located<Amount>> {
        match self {
            Spread::Values(values) => values.iter().collect(),
            Spread::Range { from, to, .. } => vec![from, to],
            Spread::Uniform(bounds) => bounds.iter().collect(),
            Spread::Triangular(places) => places.iter().collect(),
            Spread::Normal { of, within } => of.iter().chain(within.iter().flatten()).collect(),
            Spread::Lognormal([median, _]) => vec![median],
        }
    }
}

/// A correlation of two variables: of the normal numbers that they are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// The two variables.
    pub of: [Located<String>; 2],
    /// From −1 to 1.
    pub coefficient: Located<f64>,
}

/// In which direction a formula passes zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// In either.
    #[default]
    Any,
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

/// A formula that passes zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// In the language of mechanisms.
    pub formula: Located<String>,
    /// Which passages count.
    pub direction: Direction,
}

/// How long a motion is, and how it is integrated.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// `duration = "10 s"`
    pub duration: Located<Amount>,
    /// `method = "dop853"`
    pub method: Option<Located<String>>,
    /// `rtol`, the relative tolerance of methods with error control.
    pub relative: Option<Located<f64>>,
    /// `atol`, their absolute tolerance.
    pub absolute: Option<Located<f64>>,
    /// `step`, that of methods without.
    pub step: Option<Located<Amount>>,
    /// `max_step`, the longest one of methods with error control.
    pub max_step: Option<Located<Amount>>,
    /// `redundant = "least-norm"`: what is done about constraints that depend on others; they are refused without.
    pub redundant: Option<Located<String>>,
    /// `hold = ["crank"]`: coordinates that keep their first positions and velocities where others follow from them.
    pub hold: Option<Vec<Located<String>>>,
    /// `until = { zero = "height", direction = "falling" }`: what ends it before.
    pub until: Option<Crossing>,
}

/// What is taken of a formula along a motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// Its value at the end.
    Final,
    /// Its least value.
    Min,
    /// Its greatest value.
    Max,
    /// Its mean over the time.
    Mean,
    /// When it first passes zero; missing where it does not.
    TimeOf(Direction),
    /// How often it passes zero.
    Count(Direction),
    /// 1 where it passes zero, else 0.
    Happened(Direction),
}

/// What is wanted of each motion: `{ max = "height" }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// What is taken of the formula.
    pub reduction: Reduction,
    /// In the language of mechanisms, or one of the words `energy`, `kinetic_energy` and `potential_energy`.
    pub formula: Located<String>,
}

/// A plan as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The file of the mechanism, a path from the plan.
    pub mechanism: Option<Located<PathBuf>>,
    /// How often what is drawn is drawn; 1 without.
    pub members: Option<Located<u64>>,
    /// What all random numbers come from.
    pub seed: u64,
    /// How what is drawn fills its space.
    pub kind: Kind,
    /// The degree of the polynomials of the design `chaos`.
    pub degree: Option<Located<u64>>,
    /// Parameters that the mechanism does not have, for formulas of inputs and signals: `gain = "20 N/rad"`.
    pub parameters: Vec<Named<Located<Amount>>>,
    /// Values that all members share.
    pub fixed: Vec<Named<Located<Amount>>>,
    /// What differs.
    pub vary: Vec<Named<Located<Spread>>>,
    /// What differs together.
    pub correlation: Vec<Correlation>,
    /// Inputs over time: formulas, or `@table.csv`.
    pub inputs: Vec<Named<Located<String>>>,
    /// Prescribed signals over time.
    pub signals: Vec<Named<Located<String>>>,
    /// How members move.
    pub motion: Option<Motion>,
    /// What is wanted of each motion.
    pub quantities: Vec<Named<Quantity>>,
}

impl Plan {
    /// Reads the text of a plan.
    ///
    /// ```
    /// use mbs_ensemble::Plan;
    /// let faults = Plan::read("members = 2\n[vary]\nm = { norml = [1, 2] }").unwrap_err();
    /// assert_eq!(faults.render("plan.toml", "members = 2\n[vary]\nm = { norml = [1, 2] }"),
    ///     "plan.toml:3:7: there is no key `norml`; did you mean `normal`?\n");
    /// ```
    ///
    /// # Errors
    /// All that is wrong with the text alone: it is no TOML, a key is not known, a value is of another kind.
    pub fn read(text: &str) -> Result<Plan, Faults> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let table = toml::de::DeTable::parse(text).map_err(|error| {
            let message = error.message().lines().next().unwrap_or_default();
            Fault::new(error.span().unwrap_or(0..0), format!("unreadable TOML: {message}"))
        })?;
        reading::plan(&table)
    }
}
