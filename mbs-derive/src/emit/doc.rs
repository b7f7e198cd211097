//! What the generated documentation says: equations, shapes, units, operation counts.

use proc_macro2::TokenStream;
use quote::quote;

use crate::expr::Symbol;
use crate::model::requirement::{Condition, Requirement};
use crate::optimise::{Argument, Derivation, Function, FunctionKind, Operations, Shape};
use crate::variable::Variable;
use crate::variable::component_names;

/// Doc attributes, one a line.
pub(super) fn attributes(lines: &[String]) -> TokenStream {
    let lines = lines.iter().map(|line| match line.trim_end() {
        "" => String::new(),
        line => format!(" {line}"),
    });
    quote!(#(#[doc = #lines])*)
}

/// Of a mechanism's struct: what was declared, the equation, coordinates, inputs, operation counts.
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

/// Of a field of `Params`.
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

/// Of `Params::check`.
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

/// Of a generated function.
pub(super) fn function(derivation: &Derivation, function: &Function) -> Vec<String> {
    let mut lines = vec![summary(derivation, function)];
    let units = force_units(derivation);
    let mut facts = Vec::new();
    match &function.kind {
        FunctionKind::Momentum => facts.extend(units.map(|units| format!("Forces times s: {units}."))),
        FunctionKind::Gravity
        | FunctionKind::Bias
        | FunctionKind::DissipationForce
        | FunctionKind::GeneralizedForce
        | FunctionKind::InverseDynamics => facts.extend(units.map(|units| format!("Forces: {units}."))),
        FunctionKind::MassMatrix | FunctionKind::CoriolisMatrix | FunctionKind::InverseDynamicsJacobian => {
            facts.extend(units.map(|units| format!("Rows are forces: {units}.")))
        }
        FunctionKind::ForwardDynamics | FunctionKind::Linearize | FunctionKind::LinearizeParameters => {
            facts.push(where_singular(derivation).to_string());
        }
        FunctionKind::Constraint
        | FunctionKind::ConstraintRate
        | FunctionKind::ConstraintRateJacobian
        | FunctionKind::ConstraintJacobian
        | FunctionKind::ConstraintBias => facts.push(rows(derivation)),
        FunctionKind::Multipliers => {
            facts.push(rows(derivation));
            facts
                .push("Where rows depend on others they are the least of those that give the same `Aᵀ λ`.".to_string());
            facts.push(where_singular(derivation).to_string());
        }
        FunctionKind::Conserved(names) => {
            facts.extend(names.iter().map(|name| format!("- `{name}`{}", first_integral(name))));
        }
        FunctionKind::KineticEnergy
        | FunctionKind::PotentialEnergy
        | FunctionKind::Output(_)
        | FunctionKind::OutputVelocity(_)
        | FunctionKind::OutputJacobian(_)
        | FunctionKind::OutputJacobianQd(_)
        | FunctionKind::OutputJacobianU(_)
        | FunctionKind::OutputJacobianRate(_) => {}
        FunctionKind::Reaction(number) => {
            facts.extend(derivation.reactions.get(*number).into_iter().flat_map(|reaction| declared(&reaction.docs)));
            facts.extend(reaction(derivation, function));
        }
    }
    if function.kind == FunctionKind::LinearizeParameters {
        let names = component_names(&derivation.parameters).join("`, `");
        facts.push(format!("Columns are the parameters: `{names}`."));
    }
    if !facts.is_empty() {
        lines.push(String::new());
        lines.extend(facts);
    }
    lines.push(String::new());
    lines.push(operations(function.operations));
    lines
}

fn rows(derivation: &Derivation) -> String {
    format!("Rows are the constraints: `{}`.", derivation.constraints.join("`, `"))
}

/// What there is where accelerations are not determined.
fn where_singular(derivation: &Derivation) -> &'static str {
    match derivation.constraints.is_empty() {
        true => {
            "Where `M` is singular the results are infinite, NaN or rounding; the integrators report what is not finite."
        }
        false => {
            "Where a motion that `A` leaves has no inertia, or rows contradict each other, all results are NaN; the integrators \
             report that."
        }
    }
}

fn summary(derivation: &Derivation, function: &Function) -> String {
    let n = derivation.dof();
    let shape = function.results.first().map_or(String::new(), |part| shape(part.shape));
    let output = |suffix: &str| function.name.strip_suffix(suffix).unwrap_or(&function.name).to_string();
    let energy_unit = if force_units(derivation).is_some() { " in J" } else { "" };
    match &function.kind {
        FunctionKind::KineticEnergy => format!("Kinetic energy `T`{energy_unit}."),
        FunctionKind::PotentialEnergy => format!("Potential energy `V`{energy_unit}."),
        FunctionKind::Momentum => format!("Generalized momenta `p = ∂L/∂q̇`, {shape}."),
        FunctionKind::MassMatrix => format!("Mass matrix `M = ∂²L/∂q̇²`, {n} × {n}, both triangles filled."),
        FunctionKind::CoriolisMatrix => {
            format!("Coriolis matrix `C` in Christoffel's form, {shape}: `Ṁ + ∂M/∂t − 2C` is skew-symmetric.")
        }
        FunctionKind::Gravity => format!("Gravity and other forces of position `G = −∂L₀/∂q + ∂a/∂t`, {shape}."),
        FunctionKind::Bias => format!("Bias `h = C q̇ + G` without forming `C`, {shape}."),
        FunctionKind::DissipationForce => format!("Dissipation `∂D/∂q̇`, on the side of `M q̈`, {shape}."),
        FunctionKind::GeneralizedForce => format!("Generalized force `Q` of the inputs and declared forces, {shape}."),
        FunctionKind::InverseDynamics => {
            format!("Inverse dynamics `M q̈ + C q̇ + G + ∂D/∂q̇`, {shape}; `Q` is not subtracted.")
        }
        FunctionKind::ForwardDynamics => match derivation.constraints.is_empty() {
            true => format!("Accelerations `q̈ = M⁻¹ (Q − C q̇ − G − ∂D/∂q̇)`, {shape}, by `M = L D Lᵀ`."),
            false => format!(
                "Accelerations `q̈` of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ` and `A q̈ + γ = 0`, {shape}, by the runtime's \
                 `constrained_solve`; `multipliers` are λ."
            ),
        },
        FunctionKind::Constraint => {
            format!("What must vanish: `φ(q, t)`, or `a·q̇ + b` of Pfaffian constraints, {shape}.")
        }
        FunctionKind::ConstraintRate => format!("What velocities must satisfy: `A q̇ + b`, {shape}."),
        FunctionKind::ConstraintRateJacobian => {
            format!("Derivatives `∂(A q̇ + b)/∂q`, {shape}, which the runtime's `Reduction` asks for.")
        }
        FunctionKind::ConstraintJacobian => {
            format!("Constraint matrix `A`, {shape}: `∂φ/∂q`, or `a` of Pfaffian constraints.")
        }
        FunctionKind::ConstraintBias => format!("Bias `γ = Ȧ q̇ + ḃ` of `A q̈ + γ = 0`, {shape}."),
        FunctionKind::Multipliers => {
            format!("Lagrange multipliers `λ` of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`, {shape}.")
        }
        FunctionKind::Linearize => "Derivatives `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u` of forward dynamics.".to_string(),
        FunctionKind::LinearizeParameters => {
            format!("Derivatives `∂q̈/∂parameters` of forward dynamics, {shape}.")
        }
        FunctionKind::InverseDynamicsJacobian => {
            "Derivatives `∂τ/∂q`, `∂τ/∂q̇` of inverse dynamics `τ`; `∂τ/∂q̈` is `M`.".to_string()
        }
        FunctionKind::Conserved(names) if names.is_empty() => "No first integrals were found.".to_string(),
        FunctionKind::Conserved(_) => "First integrals: constant along motions with `u = 0`, `D = 0`.".to_string(),
        FunctionKind::Output(_) => match function.results.first().map(|part| part.shape) {
            Some(Shape::Pose) => format!("Output `{}`: position in m and attitude in the world.", function.name),
            Some(Shape::Poses(n)) => {
                format!("Output `{}`, {n} poses: positions in m and attitudes in the world.", function.name)
            }
            _ => format!("Output `{}`, {shape}.", function.name),
        },
        FunctionKind::OutputVelocity(number) if is_pose(derivation, *number) => {
            let (name, each) = match function.results.first().map(|part| part.shape) {
                Some(Shape::Matrix(..)) => (output("_velocity"), "each pose of "),
                _ => (output("_velocity"), ""),
            };
            format!(
                "Velocity of the origin of {each}`{name}`, then its angular velocity, in world axes, in m/s and rad/s."
            )
        }
        FunctionKind::OutputVelocity(_) => format!("Time derivative of the output `{}`, {shape}.", output("_velocity")),
        FunctionKind::OutputJacobian(number) => {
            let name = output("_jacobian");
            let has_velocity = derivation.functions.iter().any(|f| f.kind == FunctionKind::OutputVelocity(*number));
            if has_velocity {
                format!("Jacobian of the output `{name}`, {shape}: derivatives of its velocity by `q̇`.")
            } else {
                format!("Jacobian of the output `{name}`, {shape}: its derivatives by `q`.")
            }
        }
        FunctionKind::OutputJacobianQd(_) => {
            format!("Derivatives of the output `{}` by `q̇`, {shape}.", output("_jacobian_qd"))
        }
        FunctionKind::OutputJacobianU(_) => {
            format!("Derivatives of the output `{}` by `u`, {shape}.", output("_jacobian_u"))
        }
        FunctionKind::OutputJacobianRate(number) => {
            let name = output("_jacobian_rate");
            let motion = match is_rheonomic(derivation, *number) {
                true => "where its velocity is `J q̇ + b`, its acceleration is `J q̈ + J̇ q̇ + ḃ`",
                false => "its acceleration is `J q̈ + J̇ q̇`",
            };
            format!("Time derivative `J̇` of the Jacobian `J` of the output `{name}`, {shape}: {motion}.")
        }
        FunctionKind::Reaction(_) => format!(
            "Reaction `{}`, {shape}: what the part before the joint exerts on the part behind it, in the axes of the joint's \
             pose, about its origin.",
            function.name
        ),
    }
}

/// Which accelerations and multipliers a reaction is for, and its units.
fn reaction(derivation: &Derivation, function: &Function) -> Vec<String> {
    let has_units = force_units(derivation).is_some();
    let units = has_units.then(|| "Forces in N, moments in N·m.".to_string());
    let multipliers = function.arguments.contains(&Argument::Multipliers);
    let of_motion = match multipliers {
        true => {
            "For the motion itself, `qdd` is what `forward_dynamics` gives, and `multipliers` those of `multipliers`."
        }
        false => "For the motion itself, `qdd` is what `forward_dynamics` gives.",
    };
    units.into_iter().chain([of_motion.to_string()]).collect()
}

fn is_pose(derivation: &Derivation, output: usize) -> bool {
    let value = derivation.functions.iter().find(|f| f.kind == FunctionKind::Output(output));
    value.is_some_and(|f| f.results.iter().any(|part| matches!(part.shape, Shape::Pose | Shape::Poses(_))))
}

/// Whether an output changes while the coordinates stand still.
fn is_rheonomic(derivation: &Derivation, output: usize) -> bool {
    let value = derivation.functions.iter().find(|f| f.kind == FunctionKind::Output(output));
    value.is_some_and(|f| f.program.uses(|symbol| matches!(symbol, Symbol::Time | Symbol::Prescribed(..))))
}

fn first_integral(name: &str) -> String {
    match name.strip_prefix("p_") {
        Some(coordinate) => format!(": the momentum of `{coordinate}`, which does not occur in `L`"),
        None => ": `q̇·∂L/∂q̇ − L`, the energy `T + V` where `T` is quadratic in `q̇` and `L = T − V`".to_string(),
    }
}

fn shape(shape: Shape) -> String {
    match shape {
        Shape::Scalar => "one number".to_string(),
        Shape::Vector(1) => "1 component".to_string(),
        Shape::Vector(n) => format!("{n} components"),
        Shape::Matrix(rows, columns) => format!("{rows} × {columns}"),
        Shape::Symmetric(n) => format!("{n} × {n}"),
        Shape::Pose => "a pose".to_string(),
        Shape::Wrench => "a force and a moment".to_string(),
        Shape::Wrenches(n) => format!("{n} forces and moments"),
        Shape::Matrices(n, rows, columns) => format!("{n} matrices {rows} × {columns}"),
        Shape::Poses(n) => format!("{n} poses"),
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

/// The name of an argument.
pub(super) fn argument(argument: Argument) -> &'static str {
    match argument {
        Argument::Q => "q",
        Argument::Qd => "qd",
        Argument::Qdd => "qdd",
        Argument::U => "u",
        Argument::Multipliers => "multipliers",
    }
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
