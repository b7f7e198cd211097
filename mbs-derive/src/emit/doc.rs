//! What the generated documentation says: equations, shapes, units, operation counts.

use std::collections::{BTreeSet, HashSet};

use proc_macro2::TokenStream;
use quote::quote;

use crate::catalogue::{About, FunctionKind};
use crate::expr::Symbol;
use crate::model::requirement::{Condition, Requirement};
use crate::optimise::{Derivation, Function, Instruction, Operations, Value};
use crate::shape::Shape;
use crate::variable::Variable;
use crate::variable::component_names;

use super::links;

/// Doc attributes, one a line.
pub(super) fn attributes(lines: &[String]) -> TokenStream {
    let lines = lines.iter().map(|line| match line.trim_end() {
        "" => String::new(),
        line => format!(" {line}"),
    });
    quote!(#(#[doc = #lines])*)
}

/// What the documentation of a mechanism's struct says: what was declared, the equation, coordinates, inputs, operation
/// counts.
pub(super) fn mechanism(derivation: &Derivation, functions: &[&Function]) -> Vec<String> {
    let mut lines = declared(&derivation.docs);
    if lines.is_empty() {
        lines.push(format!("The mechanism `{}`.", derivation.name));
    }
    lines.extend(equation(derivation).iter().map(ToString::to_string));
    lines.extend(variables("coordinate", &derivation.coordinates));
    lines.extend(variables("input", &derivation.inputs));
    lines.extend(["", "What a call costs; a mass matrix is counted by its lower triangle:", ""].map(str::to_string));
    lines.push(
        "| function | additions | multiplications | divisions | roots | sine–cosine pairs | others |".to_string(),
    );
    lines.push("|---|---|---|---|---|---|---|".to_string());
    lines.extend(functions.iter().map(|function| {
        let Operations { add, mul, div, sqrt, sincos, other } = function.operations;
        format!("| `{}` | {add} | {mul} | {div} | {sqrt} | {sincos} | {other} |", function.name)
    }));
    lines
}

/// What the documentation of a module with this code says: its mechanism, the key to its locals where there is one, and
/// what constants are made of that were regrouped.
pub(super) fn module<'c>(
    derivation: &Derivation,
    module: &str,
    mechanism: &str,
    code: impl IntoIterator<Item = &'c str>,
) -> Vec<String> {
    let mut lines = vec![format!("The mechanism [`{mechanism}`]({module}::{mechanism}).")];
    let programs = derivation.functions.iter().map(|function| &function.program).chain([&derivation.constructor]);
    let notes = programs.flat_map(|program| &program.notes).map(|(_, name)| name.trim_start_matches("by_"));
    let letters = |name: &'_ str| name.split(|c: char| c.is_ascii_digit()).next().map(str::to_string);
    let is_between = |c: char| !c.is_alphanumeric() && c != '_';
    let words: HashSet<&str> = code.into_iter().flat_map(|text| text.split(is_between)).collect();
    // Values that are written inside others have no name in the code.
    let mut written: BTreeSet<String> =
        words.iter().filter_map(|word| letters(word.trim_start_matches("by_"))).collect();
    if derivation.functions.iter().any(|function| links::are_many(&function.program)) {
        // In loops over links j stands for their numbers.
        let before_number = |word: &&str| word.rfind('j').map(|at| word[..at].trim_start_matches("by_").to_string());
        written.extend(words.iter().filter_map(before_number));
    }
    let letters: BTreeSet<String> = notes.filter_map(letters).filter(|name| written.contains(name)).collect();
    if !letters.is_empty() {
        let told = KEY.iter().filter(|(names, _)| names.iter().any(|name| letters.contains(*name)));
        let told: Vec<String> = told.map(|(_, line)| format!("- {line};")).collect();
        let (head, parts, source) = match told.is_empty() {
            true => ("Locals:", "parts of what is named.", None),
            false => (
                KEY_TO_LOCALS,
                "parts of what is named, or the same in other axes fixed in the link.",
                Some(SOURCES_OF_KEY),
            ),
        };
        lines.extend(["", head, ""].map(str::to_string));
        lines.extend(told);
        lines.push(
            "- `by_…`: a derivative by what follows; `…_neg`, `…_squared`: its negative, its square;".to_string(),
        );
        lines.push(format!("- `…_a`, `…_b`: {parts}"));
        lines.extend(regrouped(derivation, &words));
        lines.extend(source.into_iter().flat_map(|source| [String::new(), source.to_string()]));
    }
    lines
}

/// Of each regrouped constant that has a name in the code the parameters that it is made of.
fn regrouped(derivation: &Derivation, words: &HashSet<&str>) -> Vec<String> {
    let is_one = |name: &str| {
        let joint = ["mr", "hr", "sr"].iter().find_map(|letters| name.strip_prefix(letters));
        joint.is_some_and(|joint| joint.starts_with(|c: char| c.is_ascii_digit())) && words.contains(name)
    };
    let constructor = &derivation.constructor;
    let names = component_names(&derivation.parameters);
    let line = |(value, name): &(Value, String)| {
        let mut is_part = vec![false; value.index() + 1];
        is_part[value.index()] = true;
        let mut parameters = BTreeSet::new();
        for i in (0..=value.index()).rev() {
            let instruction = constructor.instructions[i];
            if is_part[i] {
                instruction.operands().for_each(|operand| is_part[operand.index()] = true);
            }
            if let (true, Instruction::Symbol(Symbol::Parameter(number))) = (is_part[i], instruction) {
                parameters.insert(number as usize);
            }
        }
        let parameters: Vec<String> = parameters.into_iter().map(|number| format!("`{}`", names[number])).collect();
        format!("- `{name}`: {};", parameters.join(", "))
    };
    let mut lines: Vec<String> = constructor.notes.iter().filter(|(_, name)| is_one(name)).map(line).collect();
    let Some(last) = lines.last_mut() else { return lines };
    last.truncate(last.len() - 1);
    last.push('.');
    let head = ["", "What regrouped constants are made of, beside lengths and angles that are constant:", ""];
    head.map(str::to_string).into_iter().chain(lines).collect()
}

const KEY_TO_LOCALS: &str = "Locals with the number j of a joint, from 1 at the base, are of the link behind it, in its axes, about its origin:";

/// Whether locals with these letters before a number belong to the link with that number.
pub(super) fn is_of_link(letters: &str) -> bool {
    let is_of_links = |names: &[&str]| names.iter().all(|name| !name.ends_with('_'));
    KEY.iter().any(|(names, _)| is_of_links(names) && names.contains(&letters))
}

/// What `derive/tree/notation.rs` calls what is on the way to results: names without the number and axes, and the line.
const KEY: [(&[&str], &str); 11] = [
    (&["w", "v"], "`wjx`, `vjx`: angular velocity, velocity of the origin"),
    (&["wd", "a"], "`wdjx`, `ajx`: their rates, the latter less gravity"),
    (&["u"], "`ujxy`: entry of U = [ω̇]× + [ω]×[ω]×, by which points of the link accelerate"),
    (
        &["fi", "ni", "f", "n"],
        "`fijx`, `nijx`: force and couple that move the link alone; `fjx`, `njx`: that the joint transmits",
    ),
    (
        &["mc", "hc", "sc"],
        "`mcj`, `hcjx`, `scjxy`: mass, first and second moments of all behind the joint, as one body",
    ),
    (
        &["fq", "nq", "fqd", "nqd"],
        "`fqjx`, `nqjx`, `fqdjx`, `nqdjx`: what the position and the rate of the joint alone change of `fjx`, `njx`",
    ),
    (&["pc", "lc"], "`pcjxy`, `lcjx`: moments and momentum of what moves within that body"),
    (
        &["ma", "ha", "ja", "fa", "na"],
        "`majxy`, `hajxy`, `jajxy`, `fajx`, `najx`: how all behind the joint resists, further joints free: M, H, J of `f = M a + H α + fa`, `n = Hᵀ a + J α + na`",
    ),
    (
        &["fu", "nu", "fd", "nd", "tu", "td", "wda", "aa"],
        "`fujx`, `nujx`: its resistance U to the joint, `fdjx`, `ndjx`: U/D, D that along the joint; `tuj`, `tdj`: what drives the joint, over D; `wdajx`, `aajx`: α, a, what q̈ adds",
    ),
    (
        &["mr", "hr", "sr"],
        "`mrj`, `hrjx`, `srjxy`: mass and moments regrouped: what the joint does not feel is moved to the link before",
    ),
    (
        &["l_", "d_", "ld_"],
        "`m_i_j`, `l_i_j`, `d_i`, `y_i`, with coordinates from 0: entries of M = L D Lᵀ, L, D, and of L⁻¹ times a right side",
    ),
];

const SOURCES_OF_KEY: &str =
    "Sources: Khalil & Dombre, *Modeling, Identification and Control of Robots*, 2002, chapter 9; docs/structured.md.";

/// The equation of motion, and what constraints add to it.
fn equation(derivation: &Derivation) -> &'static [&'static str] {
    match derivation.constraints.is_empty() {
        true => &["", "```text", "M q̈ + C q̇ + G + ∂D/∂q̇ = Q", "```"],
        false => &["", "```text", "M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ", "A q̈ + γ = 0", "```"],
    }
}

/// A table of coordinates or inputs.
fn variables(kind: &str, variables: &[Variable]) -> Vec<String> {
    if variables.is_empty() {
        return Vec::new();
    }
    let row = |v: &Variable| {
        let array = v.length.map(|n| format!("[{n}]")).unwrap_or_default();
        format!("| `{}{array}` | {} | {} |", v.name, unit(&v.unit), declared(&v.docs).join(" ").replace('|', "\\|"))
    };
    let head = [String::new(), format!("| {kind} | unit | meaning |"), "|---|---|---|".to_string()];
    head.into_iter().chain(variables.iter().map(row)).collect()
}

/// What the documentation of a field of `Params` says.
pub(super) fn parameter(variable: &Variable) -> Vec<String> {
    let mut lines = declared(&variable.docs);
    let default = match (variable.length, variable.defaults.first()) {
        (None, Some(value)) => format!(", default: {:?}", value.to_f64()),
        (Some(_), _) | (_, None) => String::new(),
    };
    let facts = format!("Unit: {}{default}.", unit(&variable.unit));
    match lines.as_mut_slice() {
        [line] => *line = format!("{line} {facts}"),
        _ => lines.push(facts),
    }
    lines
}

/// What the documentation of `Params::check` says.
pub(super) fn requirements(derivation: &Derivation) -> Vec<String> {
    let mut lines = vec!["Whether the mechanism can have these parameters: all of them finite.".to_string()];
    if !derivation.requirements.is_empty() {
        lines.extend(["Besides, wherever its energies ask for it:", ""].map(str::to_string));
    }
    lines.extend(derivation.requirements.iter().map(|Requirement { quantity, condition }| {
        let must = match condition {
            Condition::Finite => "is finite",
            Condition::NotZero => "is not zero",
            Condition::NotNegative => "is not negative",
            Condition::Positive => "is positive",
            Condition::SemiDefinite => "has no negative principal moment",
            Condition::InertiaOfABody => {
                "is the inertia of a body: principal moments `0 ≤ a ≤ b ≤ c ≤ a + b`, to a thousandth"
            }
        };
        format!("- `{quantity}` {must}")
    }));
    lines.extend(["", "# Errors", "The first that does not hold, with its value."].map(str::to_string));
    lines
}

/// The lines of a doc comment, blank ones at its ends removed.
fn declared(docs: &[String]) -> Vec<String> {
    let lines: Vec<String> =
        docs.iter().map(|line| line.strip_prefix(' ').unwrap_or(line).trim_end().to_string()).collect();
    let first = lines.iter().position(|line| !line.is_empty()).unwrap_or(lines.len());
    let last = lines.iter().rposition(|line| !line.is_empty()).map_or(first, |last| last + 1);
    lines[first..last].to_vec()
}

/// `N*m` → `N·m`, `m/s^2` → `m/s²`
fn unit(written: &str) -> String {
    match written {
        "" | "1" => "1".to_string(),
        _ => written.replace('*', "·").replace("^2", "²").replace("^3", "³"),
    }
}

/// The units of forces, which are conjugate to the coordinates; `None` where the mechanism has no units.
fn force_units(derivation: &Derivation) -> Option<String> {
    let all = [&derivation.coordinates, &derivation.parameters, &derivation.inputs];
    if all.into_iter().flatten().all(|v| matches!(v.unit.as_str(), "" | "1")) {
        return None;
    }
    let conjugate = |v: &Variable| match v.unit.as_str() {
        "m" => "N".to_string(),
        "rad" | "" | "1" => "N·m".to_string(),
        other => format!("J/({})", unit(other)),
    };
    let units: Vec<String> = derivation.coordinates.iter().map(conjugate).collect();
    if units.iter().all(|u| *u == units[0]) {
        return Some(format!("in {}", units[0]));
    }
    let rows = derivation.coordinates.iter().zip(&units).map(|(v, unit)| format!("{unit} for `{}`", v.name));
    Some(rows.collect::<Vec<_>>().join(", "))
}

/// What the documentation of a generated function says.
///
/// A language may eliminate systems in the order that the derivation knows, or solve them in full.
pub(super) fn function(derivation: &Derivation, function: &Function, eliminates: bool) -> Vec<String> {
    let entry = function.kind.entry();
    let is_eliminated = eliminates && derivation.elimination.is_some();
    let about = About { is_eliminated, ..about(derivation, function) };
    let mut lines = vec![(entry.doc)(&about)];
    let notes = (entry.notes)(&about);
    if !notes.is_empty() {
        lines.push(String::new());
        lines.extend(notes);
    }
    // What is counted is the elimination, where there is one.
    if is_eliminated || derivation.elimination.is_none() || !function.completion.solves() {
        lines.extend([String::new(), operations(function.operations)]);
    }
    lines
}

/// What the catalogue asks for to say what a function computes.
fn about<'a>(derivation: &'a Derivation, function: &'a Function) -> About<'a> {
    let kind = function.kind;
    let value = kind.output().and_then(|number| derivation.function(FunctionKind::Output(number)));
    let velocity = kind.output().and_then(|number| derivation.function(FunctionKind::OutputVelocity(number)));
    let reaction = kind.reaction().and_then(|number| derivation.reactions.get(number));
    let is_rheonomic = |f: &Function| f.program.uses(|s| matches!(s, Symbol::Time | Symbol::Prescribed(..)));
    About {
        of: function.name.strip_suffix(kind.name()).unwrap_or(&function.name),
        shape: function.results[0].shape,
        route: function.route,
        arguments: &function.arguments,
        parameters: component_names(&derivation.parameters),
        constraints: &derivation.constraints,
        is_eliminated: false,
        conserved: &derivation.conserved,
        force_units: force_units(derivation),
        is_pose: value.is_some_and(|f| matches!(f.results[0].shape, Shape::Pose | Shape::Poses(_))),
        has_velocity: velocity.is_some(),
        is_rheonomic: value.is_some_and(is_rheonomic),
        declared: reaction.map_or(Vec::new(), |reaction| declared(&reaction.docs)),
    }
}

/// `Operations: 12 additions, 17 multiplications, 1 sine–cosine pair.`
fn operations(count: Operations) -> String {
    let Operations { add, mul, div, sqrt, sincos, other } = count;
    let kinds = [
        (add, "addition"),
        (mul, "multiplication"),
        (div, "division"),
        (sqrt, "square root"),
        (sincos, "sine–cosine pair"),
        (other, "other function"),
    ];
    let named = kinds.into_iter().filter(|(n, _)| *n > 0);
    let parts: Vec<String> = named.map(|(n, name)| format!("{n} {name}{}", if n == 1 { "" } else { "s" })).collect();
    if parts.is_empty() { "Operations: none.".to_string() } else { format!("Operations: {}.", parts.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_read_as_a_sentence() {
        let count = Operations { add: 12, mul: 1, sincos: 1, ..Operations::default() };
        assert_eq!(operations(count), "Operations: 12 additions, 1 multiplication, 1 sine–cosine pair.");
        assert_eq!(operations(Operations::default()), "Operations: none.");
    }

    #[test]
    fn units_read_as_in_print() {
        assert_eq!(unit("kg*m^2/s^2"), "kg·m²/s²");
        assert_eq!(unit(""), "1");
    }
}
