//! What a function takes.

use mbs_derive::optimise::{self, Derivation};
use mbs_derive::variable::component_names;

/// One argument of a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// `t`, `prescribed`, `q`, `qd`, `qdd`, `u` or `multipliers`.
    pub name: &'static str,
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
    let time = derivation.depends_on_time.then_some(("t", Vec::new()));
    let prescribed = (signals > 0).then_some(("prescribed", vec![signals, 3]));
    let declared = derivation.functions[number].arguments.iter().map(|argument| match argument {
        optimise::Argument::Q => ("q", derivation.dof()),
        optimise::Argument::Qd => ("qd", derivation.dof()),
        optimise::Argument::Qdd => ("qdd", derivation.dof()),
        optimise::Argument::U => ("u", component_names(&derivation.inputs).len()),
        optimise::Argument::Multipliers => ("multipliers", derivation.constraints.len()),
    });
    let declared = declared.filter(|(_, count)| *count > 0).map(|(name, count)| (name, vec![count]));
    let all = time.into_iter().chain(prescribed).chain(declared);
    all.map(|(name, shape)| Argument { name, shape }).collect()
}
