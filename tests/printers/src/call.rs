//! How generated functions are called from another language: which arguments they take, how many numbers each is.

use mbs_derive::optimise::{Argument, Derivation, Function};
use mbs_derive::variable::Variable;

fn count(variables: &[Variable]) -> usize {
    variables.iter().map(Variable::count).sum()
}

/// Names and lengths of the arguments of all functions, in the order in which a state is written down.
pub fn arguments(of: &Derivation) -> [(&'static str, usize); 7] {
    [
        ("t", 1),
        ("prescribed", 3 * count(&of.prescribed)),
        ("q", of.dof()),
        ("qd", of.dof()),
        ("qdd", of.dof()),
        ("u", count(&of.inputs)),
        ("multipliers", of.constraints.len()),
    ]
}

/// Whether a function takes the argument of this name.
pub fn takes(of: &Derivation, function: &Function, name: &str) -> bool {
    let argument = match name {
        "t" => return of.depends_on_time,
        "prescribed" => return !of.prescribed.is_empty(),
        "q" => Argument::Q,
        "qd" => Argument::Qd,
        "qdd" => Argument::Qdd,
        "u" => Argument::U,
        _ => Argument::Multipliers,
    };
    function.arguments.contains(&argument)
}
