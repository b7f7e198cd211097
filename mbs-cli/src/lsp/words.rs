//! What the words of the language mean, in a sentence each: for hover and completion.

use mbs_derive::source::Sources;

/// A word that every mechanism knows.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// `keyword`, `constant`, `function`, `method`, `unit`.
    pub(super) kind: &'static str,
    pub(super) name: String,
    /// How it is called, or what it stands for.
    pub(super) form: String,
    /// What it does.
    pub(super) sentence: &'static str,
}

/// All of them.
pub(super) fn known() -> Vec<Known> {
    let words = Sources::words().into_iter();
    words.map(|(kind, name, form)| Known { kind, sentence: sentence(kind, &name), name, form }).collect()
}

fn sentence(kind: &str, name: &str) -> &'static str {
    let table: &[(&str, &str)] = match kind {
        "keyword" => KEYWORDS,
        "function" => FUNCTIONS,
        "method" => METHODS,
        _ => &[],
    };
    table.iter().find(|(word, _)| *word == name).map_or("", |(_, sentence)| sentence)
}

#[rustfmt::skip]
const KEYWORDS: &[(&str, &str)] = &[
    ("param", "A number or an array that can be set at run time, with its unit and its default: `param length: m = 0.5;`"),
    ("coord", "A generalized coordinate: `coord theta: rad;`"),
    ("input", "A generalized input, given while the mechanism moves: `input tau: N*m;`"),
    ("prescribed", "A motion given from outside, at run time or as a formula of `t`: `prescribed heave: m;`"),
    ("const", "A value fixed at build time: `const n = 6;`, `const d[2]: mm = [780, 410];`"),
    ("fn", "A function that is one formula: `fn square(x) = x^2;`"),
    ("let", "A local name for a value: `let bob = [x, 0, z];`"),
    ("mut", "A local name that takes new values: `let mut link = world;`"),
    ("for", "Statements repeated for whole numbers, the last excluded: `for i in 0..6 { … }`"),
    ("in", "Stands before the range of a loop: `for i in 0..6 { … }`"),
    ("if", "A choice of statements by constants, or of values: `if x < 0 { a } else { b }`"),
    ("else", "What counts where the condition of an `if` does not hold."),
    ("kinetic", "A term of the kinetic energy T: `kinetic += 1/2*m*dt(x)^2;`"),
    ("potential", "A term of the potential energy V: `potential += m*g*z;`"),
    ("dissipation", "A term of Rayleigh's dissipation function D: `dissipation += 1/2*b*dt(x)^2;`"),
    ("lagrangian", "A term of L that is neither kinetic nor potential energy."),
    ("force", "A generalized force on a coordinate, `force x += push;`, or a force at a point, `force at p += [0, 0, f];`"),
    ("torque", "A torque on a body: `torque on pose += [0, 0, u];`"),
    ("gravity", "The acceleration of the field that all bodies weigh in: `gravity [0, 0, -g];`"),
    ("reaction", "Force and moment that a joint transmits: `reaction hinge at link;`"),
    ("shape", "How a body is drawn, without a meaning for its motion: `shape link += box(0.2 m, 0.1 m, 0.1 m);`"),
    ("constraint", "An equation that the motion satisfies: `constraint rod: x^2 + y^2 = l^2;`"),
    ("output", "A value with its velocity and Jacobian: `output tip = bob;`"),
    ("part", "Statements that are used many times: `part link(m, pose) { … }`, used as `link arm(m, world);`"),
    ("mechanism", "What a file declares: `mechanism Name { … }`"),
    ("import", "Constants, functions and parts of another file, the columns of a table, or a robot: `import \"constants.mbs\";`"),
    ("at", "Stands before the point of a force or the pose of a reaction."),
    ("on", "Stands before the pose that a torque acts on."),
    ("positive", "Refuses a parameter that is not positive at run time: `param l: m = 1, positive;`"),
    ("jacobian_rate", "Asks for the time derivative of an output's Jacobian: `output tip = bob, jacobian_rate;`"),
];

#[rustfmt::skip]
const FUNCTIONS: &[(&str, &str)] = &[
    ("dt", "The time derivative."),
    ("sin", "The sine of an angle in radians."), ("cos", "The cosine of an angle in radians."),
    ("tan", "The tangent of an angle in radians."),
    ("asin", "The arc sine."), ("acos", "The arc cosine."), ("atan", "The arc tangent."),
    ("sinh", "The hyperbolic sine."), ("cosh", "The hyperbolic cosine."), ("tanh", "The hyperbolic tangent."),
    ("exp", "The exponential."), ("ln", "The natural logarithm."),
    ("abs", "The absolute value."), ("signum", "1, −1, or 0 of a zero."), ("sqrt", "The square root."),
    ("atan2", "The angle of the vector (x, y), from −π to π."), ("hypot", "The length of the vector (x, y)."),
    ("min", "The smaller of two numbers."), ("max", "The larger of two numbers."),
    ("clamp", "x, but at least `low` and at most `high`."),
    ("dot", "The scalar product of two vectors."), ("cross", "The vector product of two vectors."),
    ("rot_x", "The pose turned about x."), ("rot_y", "The pose turned about y."), ("rot_z", "The pose turned about z."),
    ("rotation", "The pose turned about an axis."), ("quaternion", "The pose turned by a unit quaternion, scalar part first."),
    ("rpy", "The pose turned by roll, pitch and yaw: `Rz(yaw) Ry(pitch) Rx(roll)`."),
    ("translation", "The pose shifted along x, y, z."),
    ("dh", "The pose of a joint by standard Denavit–Hartenberg parameters."),
    ("angular_velocity", "The angular velocity of a pose."),
    ("diag", "The matrix with these entries on its diagonal."),
    ("inertia", "The inertia tensor with these moments and products."),
    ("particle", "The kinetic energy of a point mass."), ("rigid_body", "The kinetic energy of a rigid body on a pose."),
    ("table", "Values between samples, along straight lines."),
    ("table_monotone", "Values between samples, smooth and without overshoot."),
    ("table_spline", "Values between samples, by a cubic spline."),
    ("spring", "The energy of a linear spring."),
    ("coulomb_stribeck", "The force of dry friction against a velocity, smooth at rest."),
    ("contact", "The force of a compliant contact, where the gap is negative."),
];

#[rustfmt::skip]
const METHODS: &[(&str, &str)] = &[
    ("dot", "The scalar product with another vector."), ("cross", "The vector product with another vector."),
    ("norm", "The length."), ("norm_squared", "The square of the length."),
    ("transpose", "The transposed matrix."), ("inverse", "The inverse pose."),
    ("point", "The place of a point that the pose carries."), ("origin", "The place of the pose's origin."),
    ("rotation", "The rotation matrix, from the axes of the pose to those of the world."),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_has_a_sentence() {
        let known = known();
        for Known { kind, name, form, sentence } in &known {
            let wanted = matches!(*kind, "keyword" | "function" | "method");
            assert_eq!(!sentence.is_empty(), wanted, "{kind} `{name}`");
            assert_eq!(form.is_empty(), *kind == "keyword", "{kind} `{name}`");
        }
        let tables = [("keyword", KEYWORDS), ("function", FUNCTIONS), ("method", METHODS)];
        for (kind, table) in tables {
            for (word, _) in table {
                assert!(known.iter().any(|k| k.kind == kind && k.name == *word), "there is no {kind} `{word}`");
            }
        }
    }
}
