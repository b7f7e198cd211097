//! The generated header, with a loop over states for each function that is wanted.

use std::fmt::Write;

use mbs_derive::emit::{Language, Options};
use mbs_derive::optimise::{Derivation, Function, Shape};
use mbs_derive::variable::component_names;

use crate::argument::{Kind, arguments};
use crate::error::NotCompiled;
use crate::library::MOST;

/// The text, and what the loop of each function is called, if it has one.
pub(crate) fn source(
    derivation: &Derivation,
    wanted: impl Fn(&Function) -> bool,
) -> Result<(String, Vec<Option<String>>), NotCompiled> {
    // Systems that the interpreter eliminates in a known order would be solved in full, and in other bits.
    let is_same = |function: &&Function| !function.completion.is_constrained();
    let same = derivation.functions.iter().filter(is_same).map(|function| function.name.as_str());
    let options = match &derivation.elimination {
        None => Options::default(),
        Some(_) => Options::default().functions(same),
    };
    let mut text = Language::C.write(derivation, "mbs-native", &options);
    let misprint = |reason: String| NotCompiled::Misprint { reason };
    derivation.proofread(Language::C, &options, &text).map_err(|error| misprint(error.to_string()))?;
    let prefix = text.split_once("_parameters {").and_then(|(before, _)| before.rsplit("typedef struct ").next());
    let prefix = prefix.ok_or_else(|| misprint("the header has no struct of parameters".to_string()))?.to_string();
    let parameters = component_names(&derivation.parameters).len();
    text += "#include <string.h>\n";
    let _ = writeln!(text, "size_t mbs_native_size(void) {{ return sizeof({prefix}); }}");
    let _ = writeln!(text, "void mbs_native_new(const double *mbs_from, void *mbs_own)\n{{");
    let _ = writeln!(text, "    {prefix}_parameters mbs_params = {prefix}_default_parameters();");
    let _ = match parameters {
        0 => writeln!(text, "    (void)mbs_from;"),
        _ => writeln!(text, "    memcpy(&mbs_params, mbs_from, {parameters} * sizeof(double));"),
    };
    let _ = writeln!(text, "    {prefix} mbs_new = {prefix}_new(&mbs_params);");
    text += "    memcpy(mbs_own, &mbs_new, sizeof mbs_new);\n}\n";
    let mut names = Vec::new();
    for (number, (name, _)) in Language::documented(derivation).iter().enumerate() {
        let is_taken = ["parameters", "default_parameters"].contains(&name.as_str());
        let function = format!("{prefix}_{name}{}", if is_taken { "_2" } else { "" });
        let heads = ["void", "mbs_real"].map(|kind| format!("MBS_FN {kind} {function}("));
        let of = &derivation.functions[number];
        let fits = of.results.len() <= MOST && arguments(derivation, number).len() <= MOST;
        if !wanted(of) || !fits || !heads.iter().any(|head| text.contains(head)) {
            names.push(None);
            continue;
        }
        text += &looped(derivation, number, &prefix, &function);
        names.push(Some(format!("mbs_native_{number}")));
    }
    Ok((text, names))
}

/// A function that calls another one at state after state.
fn looped(derivation: &Derivation, number: usize, prefix: &str, function: &str) -> String {
    let declared = arguments(derivation, number);
    let given = declared.iter().enumerate().map(|(i, argument)| match argument.kind {
        Kind::Time => format!(", mbs_args[{i}][mbs_i * mbs_by[{i}]]"),
        Kind::Prescribed | Kind::Of(_) => format!(", mbs_args[{i}] + mbs_i * mbs_by[{i}]"),
    });
    let given: String = given.collect();
    let parts = &derivation.functions[number].results;
    let is_scalar = matches!(parts.as_slice(), [part] if part.shape == Shape::Scalar);
    let mut call = if is_scalar { "mbs_out[0][mbs_i] = ".to_string() } else { String::new() };
    call += &format!("{function}(mbs_self{given}");
    if !is_scalar {
        for (i, part) in parts.iter().enumerate().filter(|(_, part)| part.shape.count() > 0) {
            call += &format!(", mbs_out[{i}] + mbs_i * {}", part.shape.entries());
        }
    }
    format!(
        "void mbs_native_{number}(const void *mbs_own, size_t mbs_count, const double *const *mbs_args,\n    \
         const size_t *mbs_by, double *const *mbs_out)\n{{\n    const {prefix} *const mbs_self = \
         (const {prefix} *)mbs_own;\n    (void)mbs_args;\n    (void)mbs_by;\n    \
         for (size_t mbs_i = 0; mbs_i < mbs_count; mbs_i++) {{\n        {call});\n    }}\n}}\n"
    )
}
