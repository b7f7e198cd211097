//! The functions of a mechanism.

use crate::shape::Shape;

use super::super::walk::{Argued, Ending, Motion, Routine, block_comment};
use super::{Header, assigned, head, inside};

/// What a function takes and gives.
pub(super) struct Signature {
    pub(super) name: String,
    /// Names of arguments, and how many numbers each is; a number has none.
    pub(super) arguments: Vec<Argued>,
    /// Names of results, and how many numbers each is; none where a number is returned.
    pub(super) outputs: Vec<(String, usize)>,
    pub(super) returns: bool,
}

impl Header<'_> {
    pub(super) fn signature(&self, routine: &Routine) -> Signature {
        let is_motion = routine.is_motion();
        let returns = matches!(routine.parts.as_slice(), [(_, Shape::Scalar)]);
        let parts = routine.parts.iter().filter(|_| !returns).map(|(part, shape)| {
            let name = match part.as_str() {
                "" => "result".to_string(),
                "qdd" if is_motion => "accelerations".to_string(),
                "multipliers" if is_motion => "forces".to_string(),
                part => format!("by_{part}"),
            };
            (name, shape.entries())
        });
        let outputs = parts.filter(|(_, count)| *count > 0).collect();
        // One after the other: value, rate and second derivative of each motion.
        let arguments = routine.arguments.iter().map(|&(name, count)| match name {
            "prescribed" => (name, count.map(|motions| 3 * motions)),
            _ => (name, count),
        });
        Signature { name: self.name(&routine.name), arguments: arguments.collect(), outputs, returns }
    }

    pub(super) fn function(&self, routine: &Routine) -> String {
        let signature = self.signature(routine);
        let solution = if routine.is_motion() { self.constrained_solution() } else { String::new() };
        let results = signature.outputs.iter().map(|(name, count)| format!("mbs_real {name}[{count}]"));
        let declared: Vec<String> = self.declared(&signature.arguments).chain(results).collect();
        let kind = if signature.returns { "mbs_real" } else { "void" };
        let mut text = solution + &block_comment(&routine.docs, 0);
        text += &head(&format!("MBS_FN {kind} {}", signature.name), &declared);
        text += &unused(&signature.arguments);
        text += &self.body(routine, &signature);
        text + "}\n\n"
    }

    /// The mechanism and the arguments as they are declared.
    fn declared(&self, arguments: &[Argued]) -> impl Iterator<Item = String> {
        let inputs = arguments.iter().map(|(name, count)| match count {
            None => format!("mbs_real {name}"),
            Some(count) => format!("const mbs_real {name}[{count}]"),
        });
        std::iter::once(format!("const {} *self", self.prefix)).chain(inputs)
    }

    fn body(&self, routine: &Routine, signature: &Signature) -> String {
        let (n, k) = (self.derivation.dof(), self.derivation.constraints.len());
        let before = match (routine.motion, &routine.ending) {
            (Motion::Given, _) => String::new(),
            (Motion::Accelerations, _) => {
                let dynamics = self.name(&self.walk.forward_dynamics());
                format!("    mbs_real qdd[{n}];\n{}", call(&dynamics, &signature.arguments, &["qdd"]))
            }
            (Motion::Constrained, Ending::OfMotion("qdd")) => {
                format!("    mbs_real multipliers[{k}];\n{}", self.motion(signature, ["result", "multipliers"]))
            }
            (Motion::Constrained, Ending::OfMotion(_)) => {
                format!("    mbs_real qdd[{n}];\n{}", self.motion(signature, ["qdd", "result"]))
            }
            (Motion::Constrained, _) => {
                let declared = format!("    mbs_real qdd[{n}], multipliers[{k}];\n    (void)multipliers;\n");
                declared + &self.motion(signature, ["qdd", "multipliers"])
            }
        };
        let after = match &routine.ending {
            Ending::Values => returned(&routine.values, signature),
            Ending::Solve => self.solved(routine, &signature.outputs),
            Ending::Motion => self.constrained(routine),
            Ending::OfMotion(_) => String::new(),
            Ending::Slopes(sizes) => self.constrained_slopes(routine, sizes, signature),
        };
        before + &inside(&routine.lines) + &after
    }

    /// The call that gives accelerations and multipliers.
    fn motion(&self, signature: &Signature, results: [&str; 2]) -> String {
        call(&self.name(&self.walk.names.constrained_motion), &signature.arguments, &results)
    }

    /// A function's name, where nothing has to be escaped and the header's own names are taken.
    pub(super) fn name(&self, function: &str) -> String {
        format!("{}_{}", self.prefix, plain(function))
    }
}

fn call(function: &str, arguments: &[Argued], results: &[&str]) -> String {
    let given: Vec<&str> = arguments.iter().map(|(name, _)| *name).chain(results.iter().copied()).collect();
    format!("    {function}(self, {});\n", given.join(", "))
}

/// Compilers are told that an argument may not be read.
fn unused(arguments: &[Argued]) -> String {
    let rest: String = arguments.iter().map(|(name, _)| format!("    (void){name};\n")).collect();
    format!("    (void)self;\n{rest}")
}

/// What a function returns or writes.
fn returned(values: &[Vec<String>], signature: &Signature) -> String {
    if signature.returns {
        return format!("    return {};\n", values[0][0]);
    }
    let values = values.iter().filter(|values| !values.is_empty()).zip(&signature.outputs);
    values.map(|(values, (name, _))| copied(name, values).unwrap_or_else(|| assigned(name, values.iter()))).collect()
}

/// A loop that copies what loops over links have left in one array.
fn copied(name: &str, values: &[String]) -> Option<String> {
    let component = |value: &String| {
        let (array, place) = value.strip_suffix(']')?.split_once('[')?;
        Some((array.to_string(), place.parse::<usize>().ok()?))
    };
    let (array, first) = component(values.first()?)?;
    let is_whole = values.iter().zip(first..).all(|(value, place)| *value == format!("{array}[{place}]"));
    let shift = if first > 0 { format!(" + {first}") } else { String::new() };
    is_whole.then(|| {
        let count = values.len();
        format!(
            "    for (int mbs_i = 0; mbs_i < {count}; mbs_i += 1) {{\n        \
             {name}[mbs_i] = {array}[mbs_i{shift}];\n    }}\n"
        )
    })
}

/// The name of a function after the prefix.
pub(super) fn plain(name: &str) -> String {
    let plain = name.strip_prefix("r#").unwrap_or(name);
    let own = ["parameters", "default_parameters", "check", "new", "constrained_solution"];
    let is_taken = own.contains(&plain) || plain.starts_with("table_") || plain.ends_with("_kernel");
    if is_taken { format!("{plain}_2") } else { plain.to_string() }
}
