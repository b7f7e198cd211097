//! What a function takes.

use mbs_derive::optimise::{self, Derivation};
use mbs_derive::variable::component_names;

/// What an argument of a function is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The time, `t`.
    Time,
    /// Prescribed signals, each with its two derivatives, `prescribed`.
    Prescribed,
    /// What programs distinguish: `q`, `qd`, `qdd`, `u`, `multipliers`.
    Of(optimise::Argument),
}

impl Kind {
    /// Its name in generated code.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Time => "t",
            Kind::Prescribed => "prescribed",
            Kind::Of(argument) => argument.name(),
        }
    }
}

/// One argument of a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// What it is.
    pub kind: Kind,
    /// The lengths of its axes: none of a number, `[signals, 3]` of prescribed signals with their derivatives.
    pub shape: Vec<usize>,
}

impl Argument {
    /// How many numbers it has.
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }
}

/// What the function with this number takes, in the order of the generated Rust and C.
///
/// # Panics
/// If there is no function with this number.
pub fn arguments(derivation: &Derivation, number: usize) -> Vec<Argument> {
    let signals = component_names(&derivation.prescribed).len();
    let time = derivation.depends_on_time.then_some((Kind::Time, Vec::new()));
    let prescribed = (signals > 0).then_some((Kind::Prescribed, vec![signals, 3]));
    let declared = derivation.functions[number].arguments.iter().map(|&argument| {
        let count = match argument {
            optimise::Argument::Q | optimise::Argument::Qd | optimise::Argument::Qdd => derivation.dof(),
            optimise::Argument::U => component_names(&derivation.inputs).len(),
            optimise::Argument::Multipliers => derivation.constraints.len(),
        };
        (Kind::Of(argument), count)
    });
    let declared = declared.filter(|(_, count)| *count > 0).map(|(kind, count)| (kind, vec![count]));
    let all = time.into_iter().chain(prescribed).chain(declared);
    all.map(|(kind, shape)| Argument { kind, shape }).collect()
}
