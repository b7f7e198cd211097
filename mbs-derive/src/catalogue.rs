//! Every generated function, declared once, in the order of the documentation.
//!
//! An entry is all that there is to say of a function: what it is called, what it takes, which of the [`Equations`] it
//! computes in which shape and where there is one, its documentation with units, the runtime's trait that it belongs
//! to, and what is proved of it. Whoever wants a function asks for its [`FunctionKind`].

mod entry;

use crate::equations::{Equations, Route};
use crate::shape::Shape;

pub(crate) use entry::{About, Claim, Entry, Roots, Trait};
pub use entry::{Argument, Completion};

use Argument::{Multipliers, Q, Qd, Qdd, U};
use entry::lower_triangle;

/// The kinds of functions with their entries: those of a mechanism, and those of each output and of each reaction,
/// which have its number.
macro_rules! catalogue {
    (
        mechanism { $($(#[$doc:meta])* $kind:ident $entry:tt)* }
        output { $($(#[$output_doc:meta])* $output:ident $output_entry:tt)* }
        reaction { $($(#[$reaction_doc:meta])* $reaction:ident $reaction_entry:tt)* }
    ) => {
        /// What a generated function computes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub enum FunctionKind {
            $($(#[$doc])* $kind,)*
            $($(#[$output_doc])* $output(usize),)*
            $($(#[$reaction_doc])* $reaction(usize),)*
        }

        impl FunctionKind {
            const OF_MECHANISM: &'static [FunctionKind] = &[$(Self::$kind),*];
            const OF_OUTPUT: &'static [fn(usize) -> FunctionKind] = &[$(Self::$output),*];
            const OF_REACTION: &'static [fn(usize) -> FunctionKind] = &[$(Self::$reaction),*];

            pub(crate) fn entry(self) -> Entry {
                match self {
                    $(Self::$kind => Entry $entry,)*
                    $(Self::$output(_) => Entry $output_entry,)*
                    $(Self::$reaction(_) => Entry $reaction_entry,)*
                }
            }

            /// The number of the output that the function is of.
            pub fn output(self) -> Option<usize> {
                match self {
                    $(Self::$output(number) => Some(number),)*
                    _ => None,
                }
            }

            /// The number of the reaction that the function is of.
            pub fn reaction(self) -> Option<usize> {
                match self {
                    $(Self::$reaction(number) => Some(number),)*
                    _ => None,
                }
            }
        }
    };
}

catalogue! {
    mechanism {
        /// T
        KineticEnergy {
            name: "kinetic_energy",
            arguments: &[Q, Qd],
            roots: |e, _| Roots::of(Shape::Scalar, vec![e.lagrange.kinetic_energy]),
            doc: |about| format!("Kinetic energy `T`{}.", about.in_joules()),
            notes: |_| Vec::new(),
            of_trait: Some(Trait::Energies),
            claim: Claim::Energies,
        }
        /// V
        PotentialEnergy {
            name: "potential_energy",
            arguments: &[Q],
            roots: |e, _| Roots::of(Shape::Scalar, vec![e.lagrange.potential_energy]),
            doc: |about| format!("Potential energy `V`{}.", about.in_joules()),
            notes: |_| Vec::new(),
            of_trait: Some(Trait::Energies),
            claim: Claim::Energies,
        }
        /// `p = ∂L/∂q̇`
        Momentum {
            name: "momentum",
            arguments: &[Q, Qd],
            roots: |e, _| Roots::vector(&e.lagrange.momentum),
            doc: |about| format!("Generalized momenta `p = ∂L/∂q̇`, {}.", about.shape),
            notes: |about| about.forces("Forces times s"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::Momentum,
        }
        /// `M = ∂²L/∂q̇²`
        MassMatrix {
            name: "mass_matrix",
            arguments: &[Q],
            roots: |e, _| Roots::of(Shape::Symmetric(e.symbols.q.len()), lower_triangle(&e.lagrange.mass_matrix)),
            doc: |about| format!("Mass matrix `M = ∂²L/∂q̇²`, {}, both triangles filled.", about.shape),
            notes: |about| about.forces("Rows are forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::MassMatrix,
        }
        /// C
        CoriolisMatrix {
            name: "coriolis_matrix",
            arguments: &[Q, Qd],
            roots: |e, _| {
                (!e.left_out.coriolis_matrix).then(|| Roots::matrix(&e.lagrange.coriolis_matrix, e.symbols.q.len()))?
            },
            doc: |about| format!(
                "Coriolis matrix `C` in Christoffel's form, {}: `Ṁ + ∂M/∂t − 2C` is skew-symmetric.", about.shape
            ),
            notes: |about| about.forces("Rows are forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::CoriolisMatrix,
        }
        /// G
        Gravity {
            name: "gravity",
            arguments: &[Q],
            // Its claim is that of C.
            roots: |e, _| (!e.left_out.coriolis_matrix).then(|| Roots::vector(&e.lagrange.gravity))?,
            doc: |about| format!("Gravity and other forces of position `G = −∂L₀/∂q + ∂a/∂t`, {}.", about.shape),
            notes: |about| about.forces("Forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::CoriolisMatrix,
        }
        /// `h = C q̇ + G`
        Bias {
            name: "bias",
            arguments: &[Q, Qd],
            roots: |e, _| Roots::vector(&e.lagrange.bias),
            doc: |about| format!("Bias `h = C q̇ + G` without forming `C`, {}.", about.shape),
            notes: |about| about.forces("Forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::Bias,
        }
        /// `∂D/∂q̇`
        DissipationForce {
            name: "dissipation_force",
            arguments: &[Q, Qd],
            roots: |e, _| Roots::vector(&e.lagrange.dissipation_force),
            doc: |about| format!("Dissipation `∂D/∂q̇`, on the side of `M q̈`, {}.", about.shape),
            notes: |about| about.forces("Forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::DissipationForce,
        }
        /// Q
        GeneralizedForce {
            name: "generalized_force",
            arguments: &[Q, Qd, U],
            roots: |e, _| Roots::vector(&e.lagrange.generalized_force),
            doc: |about| format!("Generalized force `Q` of the inputs and declared forces, {}.", about.shape),
            notes: |about| about.forces("Forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::GeneralizedForce,
        }
        /// `M q̈ + C q̇ + G + ∂D/∂q̇`
        InverseDynamics {
            name: "inverse_dynamics",
            arguments: &[Q, Qd, Qdd],
            roots: |e, _| Roots::vector(&e.lagrange.inverse_dynamics),
            doc: |about| format!("Inverse dynamics `M q̈ + C q̇ + G + ∂D/∂q̇`, {}; `Q` is not subtracted.", about.shape),
            notes: |about| about.forces("Forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::InverseDynamics,
        }
        /// q̈
        ForwardDynamics {
            name: "forward_dynamics",
            arguments: &[Q, Qd, U],
            roots: |e, _| {
                let forward = &e.forward_dynamics;
                match &forward.unrolled {
                    Some(accelerations) => Roots::accelerations(accelerations),
                    None if forward.mass_matrix.is_empty() => None,
                    None => {
                        Roots::of(Shape::Vector(e.symbols.q.len()), forward.right_side.clone())?.solved_by(forward)
                    }
                }
            },
            doc: |about| match about.is_constrained() {
                false => format!(
                    "Accelerations `q̈ = M⁻¹ (Q − C q̇ − G − ∂D/∂q̇)`, {}, by {}.",
                    about.shape,
                    if about.route == Route::Articulated { "articulated bodies" } else { "`M = L D Lᵀ`" }
                ),
                true => format!(
                    "Accelerations `q̈` of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ` and `A q̈ + γ = 0`, {}, by the runtime's \
                     `{}`; `multipliers` are λ.",
                    about.shape,
                    if about.is_eliminated { "sparse_solve" } else { "constrained_solve" }
                ),
            },
            notes: |about| about.where_singular(),
            of_trait: Some(Trait::Dynamics),
            claim: Claim::ForwardDynamics,
        }
        /// `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u`
        Linearize {
            name: "linearize",
            arguments: &[Q, Qd, U],
            roots: |e, _| {
                let is_asked_for = !e.left_out.linearization;
                is_asked_for.then(|| Roots::linearization(e, &e.derivatives))?
            },
            doc: |_| "Derivatives `∂q̈/∂q`, `∂q̈/∂q̇`, `∂q̈/∂u` of forward dynamics.".to_string(),
            notes: |about| about.where_singular(),
            of_trait: Some(Trait::Linearized),
            claim: Claim::Linearization,
        }
        /// `∂q̈/∂parameters`
        LinearizeParameters {
            name: "linearize_parameters",
            arguments: &[Q, Qd, U],
            roots: |e, _| {
                let shape = Shape::Matrix(e.symbols.q.len(), e.symbols.parameters.len());
                let roots = Roots::of(shape, e.derivatives.linearization.parameters.concat())?;
                let is_asked_for = !e.left_out.linearization && !e.symbols.parameters.is_empty();
                is_asked_for.then(|| roots.solved_by(&e.forward_dynamics))?
            },
            doc: |about| format!("Derivatives `∂q̈/∂parameters` of forward dynamics, {}.", about.shape),
            notes: |about| {
                let columns = format!("Columns are the parameters: `{}`.", about.parameters.join("`, `"));
                [about.where_singular(), vec![columns]].concat()
            },
            of_trait: None,
            claim: Claim::LinearizationInParameters,
        }
        /// `∂τ/∂q`, `∂τ/∂q̇`
        InverseDynamicsJacobian {
            name: "inverse_dynamics_jacobian",
            arguments: &[Q, Qd, Qdd],
            roots: |e, _| {
                let is_asked_for = !e.left_out.inverse_dynamics_jacobian;
                is_asked_for.then(|| Roots::inverse_dynamics_jacobian(e, &e.derivatives))?
            },
            doc: |_| "Derivatives `∂τ/∂q`, `∂τ/∂q̇` of inverse dynamics `τ`; `∂τ/∂q̈` is `M`.".to_string(),
            notes: |about| about.forces("Rows are forces"),
            of_trait: Some(Trait::Mechanism),
            claim: Claim::InverseDynamicsJacobian,
        }
        /// First integrals; their names are the derivation's.
        Conserved {
            name: "conserved",
            arguments: &[Q, Qd],
            roots: |e, _| Roots::vector(&e.conserved.iter().map(|integral| integral.value).collect::<Vec<_>>()),
            doc: |about| match about.conserved.is_empty() {
                true => "No first integrals were found.".to_string(),
                false => "First integrals: constant along motions with `u = 0`, `D = 0`.".to_string(),
            },
            notes: |about| {
                let meaning = |name: &str| match name.strip_prefix("p_") {
                    Some(coordinate) => format!("the momentum of `{coordinate}`, which does not occur in `L`"),
                    None => {
                        "`q̇·∂L/∂q̇ − L`, the energy `T + V` where `T` is quadratic in `q̇` and `L = T − V`".to_string()
                    }
                };
                about.conserved.iter().map(|name| format!("- `{name}`: {}", meaning(name))).collect()
            },
            of_trait: None,
            claim: Claim::Conserved,
        }
        /// φ, or the Pfaffian rows at q̇
        Constraint {
            name: "constraint",
            arguments: &[Q, Qd],
            roots: |e, _| if_constrained(e, Roots::vector(&e.constraints.value)),
            doc: |about| format!("What must vanish: `φ(q, t)`, or `a·q̇ + b` of Pfaffian constraints, {}.", about.shape),
            notes: |about| about.rows(),
            of_trait: Some(Trait::Constrained),
            claim: Claim::Constraint,
        }
        /// `A q̇ + b`
        ConstraintRate {
            name: "constraint_rate",
            arguments: &[Q, Qd],
            roots: |e, _| if_constrained(e, Roots::vector(&e.constraints.rate)),
            doc: |about| format!("What velocities must satisfy: `A q̇ + b`, {}.", about.shape),
            notes: |about| about.rows(),
            of_trait: Some(Trait::Constrained),
            claim: Claim::ConstraintRate,
        }
        /// `∂(A q̇ + b)/∂q`
        ConstraintRateJacobian {
            name: "constraint_rate_jacobian",
            arguments: &[Q, Qd],
            roots: |e, _| if_constrained(e, Roots::matrix(&e.constraints.rate_jacobian, e.symbols.q.len())),
            doc: |about| format!(
                "Derivatives `∂(A q̇ + b)/∂q`, {}, which the runtime's `Reduction` asks for.", about.shape
            ),
            notes: |about| about.rows(),
            of_trait: Some(Trait::Constrained),
            claim: Claim::ConstraintRateJacobian,
        }
        /// A
        ConstraintJacobian {
            name: "constraint_jacobian",
            arguments: &[Q],
            roots: |e, _| if_constrained(e, Roots::matrix(&e.constraints.jacobian, e.symbols.q.len())),
            doc: |about| format!("Constraint matrix `A`, {}: `∂φ/∂q`, or `a` of Pfaffian constraints.", about.shape),
            notes: |about| about.rows(),
            of_trait: Some(Trait::Constrained),
            claim: Claim::ConstraintBias,
        }
        /// γ
        ConstraintBias {
            name: "constraint_bias",
            arguments: &[Q, Qd],
            roots: |e, _| if_constrained(e, Roots::vector(&e.constraints.bias)),
            doc: |about| format!("Bias `γ = Ȧ q̇ + ḃ` of `A q̈ + γ = 0`, {}.", about.shape),
            notes: |about| about.rows(),
            of_trait: Some(Trait::Constrained),
            claim: Claim::ConstraintBias,
        }
        /// λ
        Multipliers {
            name: "multipliers",
            arguments: &[Q, Qd, U],
            roots: |e, _| {
                let roots = Roots::of(Shape::Vector(e.constraints.count()), e.forward_dynamics.right_side.clone())?;
                let roots = if_constrained(e, roots.solved_by(&e.forward_dynamics))?;
                Some(Roots { completion: Completion::SolveMultipliers, ..roots })
            },
            doc: |about| format!("Lagrange multipliers `λ` of `M q̈ + C q̇ + G + ∂D/∂q̇ = Q + Aᵀ λ`, {}.", about.shape),
            notes: |about| {
                let least = "Where rows depend on others they are the least of those that give the same `Aᵀ λ`.";
                [about.rows(), vec![least.to_string()], about.where_singular()].concat()
            },
            of_trait: Some(Trait::Constrained),
            claim: Claim::ForwardDynamics,
        }
    }

    output {
        /// The value of the output with this number.
        Output {
            name: "",
            arguments: &[Q],
            roots: |e, i| Roots::of(e.outputs[i].shape, e.outputs[i].value.clone()),
            doc: |about| match about.shape {
                Shape::Pose => format!("Output `{}`: position in m and attitude in the world.", about.of),
                Shape::Poses(n) => format!("Output `{}`, {n} poses: positions in m and attitudes in the world.", about.of),
                shape => format!("Output `{}`, {shape}.", about.of),
            },
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
        /// The velocity of the output with this number.
        OutputVelocity {
            name: "_velocity",
            arguments: &[Q],
            roots: |e, i| {
                let shape = match e.outputs[i].shape {
                    Shape::Pose => Shape::Vector(6),
                    Shape::Poses(n) => Shape::Matrix(n, 6),
                    shape => shape,
                };
                Roots::of(shape, e.outputs[i].velocity.clone()?)
            },
            doc: |about| match (about.is_pose, about.shape) {
                (false, shape) => format!("Time derivative of the output `{}`, {shape}.", about.of),
                (true, shape) => format!(
                    "Velocity of the origin of {}`{}`, then its angular velocity, in world axes, in m/s and rad/s.",
                    if matches!(shape, Shape::Matrix(..)) { "each pose of " } else { "" },
                    about.of
                ),
            },
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
        /// The Jacobian of the output with this number.
        OutputJacobian {
            name: "_jacobian",
            arguments: &[Q],
            roots: |e, i| Roots::matrix(&e.outputs[i].jacobian, e.symbols.q.len()),
            doc: |about| format!("Jacobian of the output `{}`, {}: {}.", about.of, about.shape, match about.has_velocity {
                true => "derivatives of its velocity by `q̇`",
                false => "its derivatives by `q`",
            }),
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
        /// The derivatives by q̇ of the output with this number, which depends on velocities.
        OutputJacobianQd {
            name: "_jacobian_qd",
            arguments: &[Q],
            roots: |e, i| Roots::matrix(e.outputs[i].jacobian_qd.as_ref()?, e.symbols.qd.len()),
            doc: |about| format!("Derivatives of the output `{}` by `q̇`, {}.", about.of, about.shape),
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
        /// The derivatives by u of the output with this number, which depends on inputs.
        OutputJacobianU {
            name: "_jacobian_u",
            arguments: &[Q],
            roots: |e, i| Roots::matrix(e.outputs[i].jacobian_u.as_ref()?, e.symbols.u.len()),
            doc: |about| format!("Derivatives of the output `{}` by `u`, {}.", about.of, about.shape),
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
        /// The time derivative of the Jacobian of the output with this number.
        OutputJacobianRate {
            name: "_jacobian_rate",
            arguments: &[Q],
            roots: |e, i| Roots::matrix(e.outputs[i].jacobian_rate.as_ref()?, e.symbols.q.len()),
            doc: |about| format!(
                "Time derivative `J̇` of the Jacobian `J` of the output `{}`, {}: {}.",
                about.of, about.shape, match about.is_rheonomic {
                    true => "where its velocity is `J q̇ + b`, its acceleration is `J q̈ + J̇ q̇ + ḃ`",
                    false => "its acceleration is `J q̈ + J̇ q̇`",
                }
            ),
            notes: |_| Vec::new(),
            of_trait: None,
            claim: Claim::Outputs,
        }
    }

    reaction {
        /// The wrenches at the joints of the reaction with this number.
        Reaction {
            name: "",
            arguments: &[Q, Qd, Qdd],
            roots: |e, i| Roots::of(e.reactions[i].shape, e.reactions[i].values.clone()),
            doc: |about| format!(
                "Reaction `{}`, {}: what the part before the joint exerts on the part behind it, in the axes of the joint's \
                 pose, about its origin.",
                about.of, about.shape
            ),
            notes: |about| {
                let units = about.force_units.iter().map(|_| "Forces in N, moments in N·m.".to_string()).collect();
                let multipliers = match about.arguments.contains(&Multipliers) {
                    true => ", and `multipliers` those of `multipliers`",
                    false => "",
                };
                let of_motion = format!("For the motion itself, `qdd` is what `forward_dynamics` gives{multipliers}.");
                [about.declared.clone(), units, vec![of_motion]].concat()
            },
            of_trait: None,
            claim: Claim::Reactions,
        }
    }
}

/// What there is only with constraints.
fn if_constrained<'g>(equations: &Equations<'g>, roots: Option<Roots<'g>>) -> Option<Roots<'g>> {
    roots.filter(|_| equations.constraints.count() > 0)
}

/// The functions of a mechanism, in the order of the documentation.
pub(crate) fn functions<'g>(equations: &Equations<'g>) -> Vec<(FunctionKind, Roots<'g>)> {
    let of_each = |kinds: &'static [fn(usize) -> FunctionKind], count: usize| {
        (0..count).flat_map(move |number| kinds.iter().map(move |kind| (kind(number), number)))
    };
    let kinds = FunctionKind::OF_MECHANISM.iter().map(|&kind| (kind, 0));
    let kinds = kinds.chain(of_each(FunctionKind::OF_OUTPUT, equations.outputs.len()));
    let kinds = kinds.chain(of_each(FunctionKind::OF_REACTION, equations.reactions.len()));
    let kinds = kinds.filter(|(kind, _)| !equations.left_out.mass_matrix || FunctionKind::OF_DYNAMICS.contains(kind));
    kinds.filter_map(|(kind, number)| Some((kind, (kind.entry().roots)(equations, number)?))).collect()
}

/// The names of the functions of a mechanism, all that it may have.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    FunctionKind::OF_MECHANISM.iter().map(|kind| kind.name())
}

/// The names of the functions of an output, all that it may have.
pub(crate) fn names_of_output(output: &str) -> Vec<String> {
    FunctionKind::OF_OUTPUT.iter().map(|kind| format!("{output}{}", kind(0).name())).collect()
}

impl FunctionKind {
    /// Energies, forces, dynamics and rows of constraints: the functions that are as long as their mechanism.
    pub(crate) const OF_DYNAMICS: [FunctionKind; 10] = [
        FunctionKind::KineticEnergy,
        FunctionKind::PotentialEnergy,
        FunctionKind::DissipationForce,
        FunctionKind::GeneralizedForce,
        FunctionKind::InverseDynamics,
        FunctionKind::ForwardDynamics,
        FunctionKind::Constraint,
        FunctionKind::ConstraintRate,
        FunctionKind::ConstraintBias,
        FunctionKind::Multipliers,
    ];

    /// The name of the function; of an output's or a reaction's what stands behind their own.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The functions of a trait.
    pub(crate) fn of_trait(of: Trait) -> impl Iterator<Item = FunctionKind> {
        Self::OF_MECHANISM.iter().copied().filter(move |kind| kind.entry().of_trait == Some(of))
    }

    /// The output or the reaction that the function is of, as declared; empty for the mechanism.
    fn of<'e>(self, equations: &'e Equations<'_>) -> &'e str {
        let output = self.output().map(|number| &equations.outputs[number].name);
        output.or(self.reaction().map(|number| &equations.reactions[number].name)).map_or("", String::as_str)
    }

    /// Its name in full.
    pub(crate) fn full_name(self, equations: &Equations<'_>) -> String {
        format!("{}{}", self.of(equations), self.name())
    }

    /// What it takes beside t and prescribed motions.
    pub(crate) fn arguments(self, roots: &Roots<'_>) -> Vec<Argument> {
        let mut arguments = self.entry().arguments.to_vec();
        if self.output().or(self.reaction()).is_some() {
            arguments.extend(roots.arguments());
        }
        arguments.sort();
        arguments.dedup();
        arguments
    }
}
