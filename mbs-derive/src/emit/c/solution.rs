//! Systems of linear equations in a function's last step: accelerations, multipliers and their derivatives.

use std::fmt::Write;

use super::super::walk::{Routine, Sizes, block_comment};
use super::function::Signature;
use super::{Header, assigned, head};

impl Header<'_> {
    /// `M⁻¹` of the right sides.
    pub(super) fn solved(&self, routine: &Routine, outputs: &[(String, usize)]) -> String {
        let n = self.derivation.dof();
        let mut text = format!("    mbs_real mass_matrix[{}], reciprocals[{n}];\n", n * n);
        text += &assigned("mass_matrix", routine.mass_matrix.iter());
        let _ = writeln!(text, "    mbs_ldlt({n}, mass_matrix, reciprocals);");
        let mut right_sides = routine.values.iter().flatten();
        for (name, count) in outputs {
            text += &assigned(name, right_sides.by_ref().take(*count));
            let columns = count / n;
            let _ = writeln!(text, "    mbs_ldlt_solve({n}, {columns}, mass_matrix, reciprocals, {name});");
        }
        text
    }

    /// What accelerations, multipliers and linearizations of a mechanism with constraints are solved by.
    pub(super) fn constrained_solution(&self) -> String {
        let (prefix, n, k) = (&self.prefix, self.derivation.dof(), self.derivation.constraints.len());
        let vectors = self.walk.vectors();
        let mut text = block_comment(&["M q̈ − Aᵀ λ = f, A q̈ = c, for right sides column by column.".to_string()], 0);
        let arguments = [
            "const mbs_real *m, const mbs_real *a, int count, const mbs_real *force, const mbs_real *target",
            "const mbs_real *qdd, const mbs_real *sizes, mbs_real *accelerations, mbs_real *multipliers",
        ];
        text += &head(&format!("MBS_FN void {prefix}_constrained_solution"), &arguments.map(str::to_string));
        let _ = writeln!(text, "    const int vectors[{k}] = {{{}}};", vectors.join(", "));
        let _ = writeln!(text, "    mbs_real reals[MBS_REALS({n}, {k})];\n    int ints[MBS_INTS({n}, {k})];");
        let _ = writeln!(text, "    mbs_long longs[MBS_LONGS({n}, {k})];\n    mbs_system system;");
        let _ = writeln!(text, "    system.n = {n};\n    system.k = {k};\n    system.vectors = vectors;");
        text += "    mbs_constrained(&system, m, a, count, force, target, qdd, sizes, accelerations, multipliers,\n";
        text + "        reals, ints, longs);\n}\n\n"
    }

    /// Accelerations and multipliers.
    pub(super) fn constrained(&self, routine: &Routine) -> String {
        let (prefix, [force, target]) = (&self.prefix, [&routine.values[0], &routine.values[1]]);
        let (masses, jacobian) = (&routine.mass_matrix, &routine.jacobian);
        let arrays = [("mbs_m", masses), ("mbs_a", jacobian), ("mbs_force", force), ("mbs_target", target)];
        let mut text: String = arrays.into_iter().map(|(name, values)| initialized(name, values)).collect();
        let call = "mbs_m, mbs_a, 1, mbs_force, mbs_target, 0, 0, accelerations, forces";
        let _ = writeln!(text, "    {prefix}_constrained_solution({call});");
        text
    }

    /// The columns of all parts solved for at once, and taken apart.
    pub(super) fn constrained_slopes(&self, routine: &Routine, sizes: &Sizes, signature: &Signature) -> String {
        let (prefix, n, k) = (&self.prefix, self.derivation.dof(), self.derivation.constraints.len());
        let widths = routine.widths();
        let count: usize = widths.iter().sum();
        let rows = routine.right_sides(n + k);
        let (force, target) = (rows[..n].concat(), rows[n..].concat());
        let (masses, jacobian) = (&routine.mass_matrix, &routine.jacobian);
        let arrays = [("mbs_m", masses), ("mbs_a", jacobian), ("mbs_force", &force), ("mbs_target", &target)];
        let mut text: String = arrays.into_iter().map(|(name, values)| initialized(name, values)).collect();
        text += &self.slope_sizes(sizes, count);
        let _ = writeln!(text, "    mbs_real mbs_slopes[{}];", n * count);
        let _ = writeln!(
            text,
            "    {prefix}_constrained_solution(\n        mbs_m, mbs_a, {count}, mbs_force, mbs_target, qdd, mbs_sizes, mbs_slopes, 0);"
        );
        let starts = widths.iter().scan(0, |next, &width| Some((std::mem::replace(next, *next + width), width)));
        let parts = starts.filter(|(_, width)| *width > 0);
        for ((name, _), (start, width)) in signature.outputs.iter().zip(parts) {
            let _ = writeln!(text, "    for (int i = 0; i < {n}; i++) {{");
            let _ = writeln!(text, "        for (int j = 0; j < {width}; j++) {{");
            let first = if start > 0 { format!("{start} + ") } else { String::new() };
            let _ = writeln!(text, "            {name}[i * {width} + j] = mbs_slopes[i * {count} + {first}j];");
            text += "        }\n    }\n";
        }
        text
    }

    /// How large that is by which each column of a linearization is a derivative.
    fn slope_sizes(&self, sizes: &Sizes, count: usize) -> String {
        let mut text = format!("    mbs_real mbs_sizes[{count}];\n");
        match sizes {
            Sizes::State(kinds, _) => {
                let n = self.derivation.dof();
                let kinds: Vec<String> = kinds.iter().map(ToString::to_string).collect();
                let _ = writeln!(text, "    const int mbs_kinds[{n}] = {{{}}};", kinds.join(", "));
                let _ = writeln!(text, "    mbs_state_sizes({n}, {count}, mbs_kinds, q, qd, mbs_sizes);");
            }
            Sizes::Parameters(fields) => text += &assigned("mbs_sizes", fields.iter()),
        }
        text
    }
}

/// `const mbs_real name[2] = {…};`, a value a line.
fn initialized(name: &str, values: &[String]) -> String {
    let lines: String = values.iter().map(|value| format!("        {value},\n")).collect();
    format!("    const mbs_real {name}[{}] = {{\n{lines}    }};\n", values.len())
}
