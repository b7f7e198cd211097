//! Kernels of CUDA and OpenCL: each function for many states at once, a structure of arrays.

use std::fmt::Write;

use super::super::walk::{Routine, block_comment};
use super::function::Signature;
use super::{Header, head};

impl Header<'_> {
    pub(super) fn kernels(&self, routines: &[&Routine]) -> String {
        let kernels = routines.iter().map(|routine| self.kernel(&self.signature(routine)));
        self.constructor_kernel() + &kernels.collect::<String>()
    }

    /// The mechanism made where its parameters are.
    fn constructor_kernel(&self) -> String {
        let prefix = &self.prefix;
        let docs = format!("{prefix}_new, for one work item.");
        let arguments = [format!("MBS_GLOBAL const {prefix}_parameters *params"), format!("MBS_GLOBAL {prefix} *self")];
        let mut text = block_comment(&[docs], 0);
        text += &head(&format!("MBS_KERNEL {prefix}_new_kernel"), &arguments);
        let _ = writeln!(text, "    const {prefix}_parameters mbs_params = *params;");
        let _ = writeln!(text, "    *self = {prefix}_new(&mbs_params);\n}}\n");
        text
    }

    fn kernel(&self, signature: &Signature) -> String {
        let (prefix, Signature { name, arguments, .. }) = (&self.prefix, signature);
        let returned = [("result".to_string(), 1)];
        let outputs = if signature.returns { &returned[..] } else { &signature.outputs };
        let start = ["unsigned int states".to_string(), format!("MBS_GLOBAL const {prefix} *self")];
        let inputs = arguments.iter().map(|(name, _)| format!("MBS_GLOBAL const mbs_real *{name}"));
        let results = outputs.iter().map(|(name, _)| format!("MBS_GLOBAL mbs_real *{name}"));
        let declared: Vec<String> = start.into_iter().chain(inputs).chain(results).collect();
        let docs = format!("{name} of many states: number k of state i is at `k*states + i`.");
        let mut text = block_comment(&[docs], 0) + &head(&format!("MBS_KERNEL {name}_kernel"), &declared);
        text += "    const size_t mbs_state = MBS_STATE;\n    if (mbs_state >= states) {\n        return;\n    }\n";
        let _ = writeln!(text, "    const {prefix} mbs_self = *self;");
        let mut given = vec!["&mbs_self".to_string()];
        for (name, count) in arguments {
            match count {
                None => given.push(format!("{name}[mbs_state]")),
                Some(count) => {
                    let _ = writeln!(text, "    mbs_real mbs_{name}[{count}];");
                    let _ = writeln!(text, "    mbs_gather(states, mbs_state, {count}, {name}, mbs_{name});");
                    given.push(format!("mbs_{name}"));
                }
            }
        }
        if signature.returns {
            let _ = writeln!(text, "    result[mbs_state] = {name}({});\n}}\n", given.join(", "));
            return text;
        }
        for (name, count) in outputs {
            let _ = writeln!(text, "    mbs_real mbs_{name}[{count}];");
            given.push(format!("mbs_{name}"));
        }
        let _ = writeln!(text, "    {name}({});", given.join(", "));
        for (name, count) in outputs {
            let _ = writeln!(text, "    mbs_scatter(states, mbs_state, {count}, mbs_{name}, {name});");
        }
        text + "}\n\n"
    }
}
