//! Systems of linear equations in a function's last step: accelerations, multipliers and their derivatives.

use std::fmt::Write;

use crate::optimise::{Function, FunctionKind};

use super::function::{Signature, plain, unused};
use super::{Header, assigned, comment, head};

impl<'d> Header<'d> {
    /// `M⁻¹` of the right sides.
    pub(super) fn solved(&self, values: &[String], outputs: &[(String, usize)]) -> String {
        let n = self.derivation.dof();
        let (masses, mut rest) = values.split_at(n * n);
        let mut text = format!("    mbs_real mass_matrix[{}], reciprocals[{n}];\n", n * n);
        text += &assigned("mass_matrix", masses.iter());
        let _ = writeln!(text, "    mbs_ldlt({n}, mass_matrix, reciprocals);");
        for (name, count) in outputs {
            let (right_side, after) = rest.split_at(*count);
            rest = after;
            text += &assigned(name, right_side.iter());
            let columns = count / n;
            let _ = writeln!(text, "    mbs_ldlt_solve({n}, {columns}, mass_matrix, reciprocals, {name});");
        }
        text
    }

    /// Forward dynamics with constraints, where a function needs it.
    pub(super) fn constrained_forward_dynamics(&self) -> Option<&'d Function> {
        let is_needed = self.functions.iter().any(|(_, f)| f.completion.is_constrained());
        let forward_dynamics = self.derivation.function(FunctionKind::ForwardDynamics);
        forward_dynamics.filter(|_| is_needed)
    }

    /// What accelerations, multipliers and linearizations of a mechanism with constraints have in common.
    pub(super) fn constrained_motion(&self) -> String {
        let Some(function) = self.constrained_forward_dynamics() else { return String::new() };
        let (prefix, n, k) = (&self.prefix, self.derivation.dof(), self.derivation.constraints.len());
        let vectors: Vec<String> = self.derivation.constraint_vectors.iter().map(ToString::to_string).collect();
        let mut text = comment(&["M q̈ − Aᵀ λ = f, A q̈ = c, for right sides column by column.".to_string()], "");
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
        text += "        reals, ints, longs);\n}\n\n";

        let arguments = self.arguments(function);
        let results = [format!("mbs_real accelerations[{n}]"), format!("mbs_real forces[{k}]")];
        let declared: Vec<String> = self.declared(&arguments).chain(results).collect();
        text += &comment(&["Accelerations and multipliers.".to_string()], "");
        text += &head(&format!("MBS_FN void {}", self.motion_name()), &declared);
        text += &unused(&arguments);
        let (statements, values) = self.statements(function);
        text += &statements;
        let lengths = [("mbs_m", n * n), ("mbs_a", k * n), ("mbs_force", n), ("mbs_target", k)];
        let mut values = values.iter();
        for (name, count) in lengths {
            let _ = writeln!(text, "    mbs_real {name}[{count}];");
            text += &assigned(name, values.by_ref().take(count));
        }
        let call = "mbs_m, mbs_a, 1, mbs_force, mbs_target, 0, 0, accelerations, forces";
        let _ = writeln!(text, "    {prefix}_constrained_solution({call});\n}}\n");
        text
    }

    fn motion_name(&self) -> String {
        format!("{}_{}", self.prefix, plain(&self.names.constrained_motion))
    }

    /// The call that gives accelerations and multipliers.
    pub(super) fn motion(&self, arguments: &[(&str, Option<usize>)], qdd: &str, multipliers: &str) -> String {
        let given: Vec<&str> = arguments.iter().map(|(name, _)| *name).chain([qdd, multipliers]).collect();
        format!("    {}(self, {});\n", self.motion_name(), given.join(", "))
    }

    /// The columns of all parts solved for at once, and taken apart.
    pub(super) fn constrained_slopes(&self, function: &Function, signature: &Signature) -> String {
        let (prefix, n, k) = (&self.prefix, self.derivation.dof(), self.derivation.constraints.len());
        let mut text = format!("    mbs_real qdd[{n}], multipliers[{k}];\n    (void)multipliers;\n");
        text += &self.motion(&signature.arguments, "qdd", "multipliers");
        let (statements, values) = self.statements(function);
        text += &statements;
        let widths: Vec<usize> = function.results.iter().map(|part| part.shape.count() / n).collect();
        let count: usize = widths.iter().sum();
        let (masses, rest) = values.split_at(n * n);
        let (jacobian, mut rest) = rest.split_at(k * n);
        let mut rows: Vec<Vec<String>> = vec![Vec::new(); n + k];
        for &width in &widths {
            let (part, behind) = rest.split_at((n + k) * width);
            rows.iter_mut().enumerate().for_each(|(i, row)| row.extend_from_slice(&part[i * width..(i + 1) * width]));
            rest = behind;
        }
        let (force, target) = rows.split_at(n);
        let arrays = [
            ("mbs_m", masses.to_vec()),
            ("mbs_a", jacobian.to_vec()),
            ("mbs_force", force.concat()),
            ("mbs_target", target.concat()),
        ];
        for (name, values) in arrays {
            let _ = writeln!(text, "    mbs_real {name}[{}];", values.len());
            text += &assigned(name, values.iter());
        }
        text += &self.slope_sizes(function, count);
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
    fn slope_sizes(&self, function: &Function, count: usize) -> String {
        let mut text = format!("    mbs_real mbs_sizes[{count}];\n");
        if function.kind == FunctionKind::Linearize {
            let (n, kinds) = (self.derivation.dof(), self.derivation.coordinate_kinds());
            let kinds: Vec<String> = kinds.iter().map(ToString::to_string).collect();
            let _ = writeln!(text, "    const int mbs_kinds[{n}] = {{{}}};", kinds.join(", "));
            let _ = writeln!(text, "    mbs_state_sizes({n}, {count}, mbs_kinds, q, qd, mbs_sizes);");
        } else {
            let fields: Vec<String> = (0..count).map(|i| format!("self->params.{}", self.field(i))).collect();
            text += &assigned("mbs_sizes", fields.iter());
        }
        text
    }
}
