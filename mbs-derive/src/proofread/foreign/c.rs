//! A header of C, C++, CUDA or OpenCL C.

use crate::emit::Language;
use crate::expr::Function;
use crate::model::requirement::Condition;
use crate::optimise::{Derivation, FunctionKind, Instruction};
use crate::shape::Shape;
use crate::variable::{Variable, count};

use super::sheet::{Argued, Ending, Expected, Routine, Sheet, joined};

/// A header; behind it, where an interface is asked for, what forward dynamics of a mechanism compares.
pub(super) fn text(mut sheet: Sheet<'_, '_>, compared: Option<&Derivation>) -> Expected {
    let prefix = sheet.identifiers.mechanism.clone();
    let guard = format!("MBS_{}_H", prefix.to_uppercase());
    let library = "#ifndef MBS_LIBRARY_TRIGONOMETRY\n#define MBS_LIBRARY_TRIGONOMETRY\n#endif\n";
    let mut text = format!("#ifndef {guard}\n#define {guard}\n⟨shared⟩\n");
    text += if sheet.is_library { library } else { "" };
    text += "⟨shared⟩\n";
    text += &sizes(&sheet, &prefix);
    text += &parameters(&mut sheet, &prefix);
    text += &tables(&mut sheet, &prefix);
    text += &check(&mut sheet, &prefix);
    let begin = sheet.scope("new", "params->", true);
    text += &format!("{begin} MBS_FN {prefix} {prefix}_new(const {prefix}_parameters *params)\n{{ {prefix} self; ⟨⟩ ");
    text += "self.params = *params; ⟨⟩ return self; }\n";
    let routines = sheet.routines("self->params.");
    for routine in &routines {
        text += &function(&mut sheet, routine, &prefix);
    }
    let functions: Vec<Signature> =
        routines.iter().filter(|routine| routine.ending != Ending::Motion).map(Signature::of).collect();
    match sheet.dialect.language {
        Language::Cpp => text += &class(&sheet, &prefix, &functions),
        Language::Cuda | Language::Opencl => text += &kernels(&prefix, &functions),
        _ => {}
    }
    text += &format!("\n#endif /* {guard} */\n");
    text += &compared.map(|derivation| switches(&mut sheet, &prefix, derivation)).unwrap_or_default();
    sheet.finished(text)
}

/// What an interface has behind the header: left sides less right ones, and arguments of signs.
fn switches(sheet: &mut Sheet<'_, '_>, prefix: &str, derivation: &Derivation) -> String {
    let program = derivation.function(FunctionKind::ForwardDynamics).map(|function| &function.program);
    let (mut comparisons, mut signs) = (Vec::new(), Vec::new());
    for instruction in program.into_iter().flat_map(|program| &program.instructions) {
        match *instruction {
            Instruction::Less(a, b) if !comparisons.contains(&(a, b, false)) => comparisons.push((a, b, false)),
            Instruction::LessEqual(a, b) if !comparisons.contains(&(a, b, true)) => comparisons.push((a, b, true)),
            Instruction::Call(Function::Signum, a) if !signs.contains(&a) => signs.push(a),
            _ => {}
        }
    }
    let operands = comparisons.iter().flat_map(|&(a, b, _)| [a, b]).chain(signs.iter().copied()).collect();
    let begin = sheet.scope("mbs_fmu_switches", "self->params.", false);
    let values = sheet.switches(program, operands);
    let (pairs, signs) = values.split_at(2 * comparisons.len());
    let differences = pairs.chunks(2).zip(&comparisons).map(|(pair, (.., equal_too))| {
        (format!("({}) - ({})", pair[0], pair[1]), if *equal_too { "-MBS_TINY" } else { "MBS_TINY" })
    });
    let all = differences.chain(signs.iter().map(|sign| (sign.clone(), "MBS_TINY")));
    let lines = all.enumerate().map(|(k, (difference, at_zero))| {
        let is_other = format!("if (!(result[{k}] < 0.0 || result[{k}] > 0.0)) result[{k}] = {at_zero};\n");
        format!("result[{k}] = {difference};\n{is_other}")
    });
    let lines: String = lines.collect();
    format!(
        "#define MBS_TINY 2.2250738585072014e-308\n{begin}\nstatic void mbs_fmu_switches(const {prefix} *self, \
         mbs_real t, const mbs_real *prescribed, const mbs_real *q, const mbs_real *qd, const mbs_real *u, \
         mbs_real *result)\n{{ (void)self; (void)t; (void)prescribed; (void)q; (void)qd; (void)u; (void)result; \
         ⟨⟩ {lines} }}\n"
    )
}

fn has_kernels(sheet: &Sheet<'_, '_>) -> bool {
    matches!(sheet.dialect.language, Language::Cuda | Language::Opencl)
}

fn sizes(sheet: &Sheet<'_, '_>, prefix: &str) -> String {
    let (upper, derivation) = (prefix.to_uppercase(), sheet.derivation);
    let mut text = String::new();
    for (length, kind, variables) in [("DOF", "Q", &derivation.coordinates), ("INPUTS", "U", &derivation.inputs)] {
        text += &format!("#define {upper}_{length} {}\n", count(variables));
        let place = |variable: &Variable| format!("#define {upper}_{kind}_{} {}\n", variable.name, variable.first);
        text += &variables.iter().map(place).collect::<String>();
    }
    if has_kernels(sheet) {
        let parameters = count(&derivation.parameters).max(1);
        text += &format!("#define {upper}_PARAMETERS {parameters}\n⟨count {parameters}⟩\n");
    }
    text
}

fn parameters(sheet: &mut Sheet<'_, '_>, prefix: &str) -> String {
    let derivation = sheet.derivation;
    let field = |(parameter, field): (&Variable, &String)| {
        let lengths: String = parameter.lengths().iter().map(|n| format!("[{n}]")).collect();
        format!("mbs_real {field}{lengths};\n")
    };
    let mut fields: String = derivation.parameters.iter().zip(&sheet.identifiers.parameters).map(field).collect();
    let list = |values: &[String]| format!("{{{}}}", values.join(", "));
    let values = derivation.parameters.iter().map(|parameter| sheet.defaults(parameter, &list) + ",\n");
    let mut values: String = values.collect();
    if derivation.parameters.is_empty() {
        fields = "mbs_real none;\n".to_string();
        values = sheet.constant(0.0) + ",\n";
    }
    let begin = sheet.scope("default_parameters", "", false);
    format!(
        "typedef struct {prefix}_parameters {{ {fields} }} {prefix}_parameters;\n\
         {begin} MBS_FN {prefix}_parameters {prefix}_default_parameters(void)\n{{\n\
         const {prefix}_parameters params = {{ {values} }}; return params; }}\n\
         typedef struct {prefix} {{ {prefix}_parameters params; ⟨fields⟩ }} {prefix};\n"
    )
}

fn tables(sheet: &mut Sheet<'_, '_>, prefix: &str) -> String {
    let mut text = String::new();
    for (number, spline) in sheet.derivation.splines().into_iter().enumerate() {
        let is_inside = sheet.dialect.language != Language::Opencl;
        let (name, kind) = (format!("{prefix}_table_{number}"), if is_inside { "static" } else { "__constant" });
        let (count, columns) = (spline.places().len(), spline.degree() + 2);
        let mut list = |values: &[f64]| {
            let values: Vec<String> = values.iter().map(|&value| sheet.constant(value)).collect();
            values.join(", ")
        };
        let places = list(spline.places());
        let rows: String = spline.rows().iter().map(|row| list(row) + ",\n").collect();
        let constants = format!(
            "{kind} const mbs_real {name}_places[{count}] = {{{places}}};\n\
             {kind} const mbs_real {name}_rows[{}] = {{ {rows} }};\n",
            spline.rows().len() * columns
        );
        let head = format!("MBS_FN mbs_real {name}(int order, mbs_real x) {{\n");
        let call = format!("return mbs_spline({count}, {name}_places, {columns}, {name}_rows, order, x); }}\n");
        let begin = sheet.scope("tables", "", false);
        text += &if is_inside { begin + &head + &constants + &call } else { begin + &constants + &head + &call };
    }
    text
}

/// What does not hold of parameters.
fn check(sheet: &mut Sheet<'_, '_>, prefix: &str) -> String {
    let derivation = sheet.derivation;
    let begin = sheet.scope("check", "params->", false);
    let mut text = format!(
        "{begin} MBS_FN int {prefix}_check(const {prefix}_parameters *params, MBS_TEXT const char **quantity, \
         mbs_real *value)\n{{ int error = 0; (void)params; *quantity = \"\"; *value = MBS_C(0.0);\n"
    );
    let require = |condition: &str, quantity: &str, value: &str| {
        format!("error = error ? error : mbs_require({condition}, {quantity:?}, {value}, quantity, value);\n")
    };
    for parameter in &derivation.parameters {
        for (i, name) in parameter.component_names().iter().enumerate() {
            let value = sheet.parameter(parameter.first + i);
            text += &require("MBS_FINITE", name, &value);
        }
    }
    let values = sheet.required();
    if !values.is_empty() {
        text += "if (error) { return error; } ⟨⟩\n";
    }
    for (number, (requirement, values)) in derivation.conditions(&values).enumerate() {
        let condition = match requirement.condition {
            Condition::Finite => "MBS_FINITE",
            Condition::NotZero => "MBS_NOT_ZERO",
            Condition::NotNegative => "MBS_NOT_NEGATIVE",
            Condition::Positive => "MBS_POSITIVE",
            Condition::SemiDefinite => "MBS_SEMI_DEFINITE",
            Condition::InertiaOfABody => "MBS_INERTIA_OF_A_BODY",
        };
        let quantity = &requirement.quantity;
        text += &match values {
            [value] => require(condition, quantity, value),
            values => format!(
                "const mbs_real mbs_inertia_{number}[6] = {{{}}};\nerror = error ? error : \
                 mbs_require_inertia({condition}, {quantity:?}, mbs_inertia_{number}, quantity, value);\n",
                values.join(", ")
            ),
        };
    }
    text + "return error; }\n"
}

/// What a function takes and gives.
struct Signature {
    name: String,
    known_as: String,
    /// Names, and how many numbers each is; a number has none.
    arguments: Vec<Argued>,
    /// None where a number is returned.
    outputs: Vec<(String, usize)>,
    returns: bool,
}

impl Signature {
    fn of(routine: &Routine<'_>) -> Self {
        let returns = matches!(routine.parts.as_slice(), [(_, Shape::Scalar)]);
        let name = |part: &str| match part {
            "" => "result".to_string(),
            "qdd" if routine.ending == Ending::Motion => "accelerations".to_string(),
            "multipliers" if routine.ending == Ending::Motion => "forces".to_string(),
            part => format!("by_{part}"),
        };
        let outputs = routine.parts.iter().map(|(part, shape)| (name(part), shape.entries()));
        let arguments = routine.arguments.iter().map(|&(name, count)| match name {
            "prescribed" => (name, count.map(|motions| 3 * motions)),
            _ => (name, count),
        });
        Signature {
            name: routine.name.clone(),
            known_as: routine.known_as.clone(),
            arguments: arguments.collect(),
            outputs: outputs.filter(|(_, count)| !returns && *count > 0).collect(),
            returns,
        }
    }

    /// A call of a function of the same arguments.
    fn call(&self, function: &str, results: &str) -> String {
        let arguments: String = self.arguments.iter().map(|(name, _)| format!("{name}, ")).collect();
        format!("{function}(self, {arguments}{results});\n")
    }
}

fn function(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>, prefix: &str) -> String {
    let (n, k) = (sheet.derivation.dof(), sheet.derivation.constraints.len());
    let (signature, motion) = (Signature::of(routine), sheet.identifiers.motion.clone());
    let (kind, name) = (if signature.returns { "mbs_real" } else { "void" }, &signature.name);
    let inputs = signature.arguments.iter().map(|(name, count)| match count {
        None => format!(", mbs_real {name}"),
        Some(count) => format!(", const mbs_real {name}[{count}]"),
    });
    let outputs = signature.outputs.iter().map(|(name, count)| format!(", mbs_real {name}[{count}]"));
    let declared: String = inputs.chain(outputs).collect();
    let unused: String = signature.arguments.iter().map(|(name, _)| format!("(void){name}; ")).collect();
    let solution = if routine.ending == Ending::Motion { solution(sheet, prefix) } else { String::new() };
    let begin = &routine.begin;
    let head =
        format!("{begin} {solution} MBS_FN {kind} {name}(const {prefix} *self{declared})\n{{ (void)self; {unused}\n");
    let body = match routine.ending {
        Ending::Values if signature.returns => format!("⟨⟩ return {};", routine.values[0][0]),
        Ending::Values => {
            let parts = routine.values.iter().filter(|values| !values.is_empty()).zip(&signature.outputs);
            format!("⟨⟩ {}", parts.map(|(values, (name, _))| stored(name, values)).collect::<String>())
        }
        Ending::Solve { in_motion } => {
            let before = match in_motion {
                true => format!("mbs_real qdd[{n}];\n{}", signature.call(&sheet.forward_dynamics(), "qdd")),
                false => String::new(),
            };
            let mut text = format!("{before} ⟨⟩ mbs_real mass_matrix[{}], reciprocals[{n}];\n", n * n);
            text += &assigned("mass_matrix", &routine.masses);
            text += &format!("mbs_ldlt({n}, mass_matrix, reciprocals);\n");
            let parts = routine.values.iter().zip(routine.widths()).filter(|(_, width)| *width > 0);
            for ((values, width), (name, _)) in parts.zip(&signature.outputs) {
                text += &assigned(name, values);
                text += &format!("mbs_ldlt_solve({n}, {width}, mass_matrix, reciprocals, {name});\n");
            }
            text
        }
        Ending::Accelerations => {
            format!("mbs_real multipliers[{k}];\n{}", signature.call(&motion, "result, multipliers"))
        }
        Ending::Multipliers => format!("mbs_real qdd[{n}];\n{}", signature.call(&motion, "qdd, result")),
        Ending::Motion => {
            let (force, target) = routine.values[0].split_at(n);
            let arrays = [
                ("mbs_m", &routine.masses[..]),
                ("mbs_a", &routine.jacobian),
                ("mbs_force", force),
                ("mbs_target", target),
            ];
            let arrays: String = arrays.map(|(name, values)| initialized(name, values)).concat();
            let call = "mbs_m, mbs_a, 1, mbs_force, mbs_target, 0, 0, accelerations, forces";
            format!("⟨⟩ {arrays} {prefix}_constrained_solution({call});\n")
        }
        Ending::Slopes { .. } => {
            let call = signature.call(&motion, "qdd, multipliers");
            format!("mbs_real qdd[{n}], multipliers[{k}]; (void)multipliers;\n{call} ⟨⟩ ")
                + &slopes(sheet, routine, &signature, prefix)
        }
    };
    head + &body + "}\n"
}

fn solution(sheet: &Sheet<'_, '_>, prefix: &str) -> String {
    let (n, k) = (sheet.derivation.dof(), sheet.derivation.constraints.len());
    format!(
        "MBS_FN void {prefix}_constrained_solution(const mbs_real *m, const mbs_real *a, int count, \
         const mbs_real *force, const mbs_real *target, const mbs_real *qdd, const mbs_real *sizes, \
         mbs_real *accelerations, mbs_real *multipliers)\n{{\n\
         const int vectors[{k}] = {{{}}};\n\
         mbs_real reals[MBS_REALS({n}, {k})]; int ints[MBS_INTS({n}, {k})]; mbs_long longs[MBS_LONGS({n}, {k})];\n\
         mbs_system system; system.n = {n}; system.k = {k}; system.vectors = vectors;\n\
         mbs_constrained(&system, m, a, count, force, target, qdd, sizes, accelerations, multipliers,\n\
         reals, ints, longs); }}\n",
        sheet.vectors()
    )
}

/// The columns of all parts solved for at once, and taken apart.
fn slopes(sheet: &mut Sheet<'_, '_>, routine: &Routine<'_>, signature: &Signature, prefix: &str) -> String {
    let (n, k, widths) = (sheet.derivation.dof(), sheet.derivation.constraints.len(), routine.widths());
    let columns: usize = widths.iter().sum();
    let row = |i: usize| {
        let parts = routine.values.iter().zip(&widths);
        parts.flat_map(move |(part, &width)| part[i * width..(i + 1) * width].iter().cloned())
    };
    let [force, target] = [0..n, n..n + k].map(|rows| rows.flat_map(row).collect::<Vec<_>>());
    let mut text = initialized("mbs_m", &routine.masses) + &initialized("mbs_a", &routine.jacobian);
    text += &(initialized("mbs_force", &force) + &initialized("mbs_target", &target));
    text += &format!("mbs_real mbs_sizes[{columns}];\n");
    text += &match sheet.sizes(routine) {
        Some(parameters) => assigned("mbs_sizes", &parameters),
        None => format!(
            "const int mbs_kinds[{n}] = {{{}}}; mbs_state_sizes({n}, {columns}, mbs_kinds, q, qd, mbs_sizes);\n",
            sheet.kinds()
        ),
    };
    text += &format!(
        "mbs_real mbs_slopes[{}]; {prefix}_constrained_solution(mbs_m, mbs_a, {columns}, mbs_force, mbs_target, qdd, \
         mbs_sizes, mbs_slopes, 0);\n",
        n * columns
    );
    let (mut start, mut outputs) = (0, signature.outputs.iter());
    for width in widths.into_iter().filter(|width| *width > 0) {
        let name = outputs.next().map_or("", |(name, _)| name);
        let first = if start > 0 { format!("{start} + ") } else { String::new() };
        text += &format!(
            "for (int i = 0; i < {n}; i++) {{ for (int j = 0; j < {width}; j++) {{\n\
             {name}[i * {width} + j] = mbs_slopes[i * {columns} + {first}j]; }} }}\n"
        );
        start += width;
    }
    text
}

/// What is written to an array of the caller: slots that follow each other.
fn stored(name: &str, values: &[String]) -> String {
    let number = |slot: &String| slot.trim_matches(['⟨', '⟩']).parse::<usize>().expect("slots have numbers");
    let first = values.first().map_or(0, number);
    format!("⟨stored {name} {first} {}⟩\n", first + values.len())
}

fn assigned(name: &str, values: &[String]) -> String {
    values.iter().enumerate().map(|(i, value)| format!("{name}[{i}] = {value};\n")).collect()
}

fn initialized(name: &str, values: &[String]) -> String {
    format!("const mbs_real {name}[{}] = {{ {}, }};\n", values.len(), values.join(", "))
}

/// The class of C++.
fn class(sheet: &Sheet<'_, '_>, prefix: &str, functions: &[Signature]) -> String {
    let name = &sheet.identifiers.class;
    let mut text = format!(
        "namespace mbs {{ class {name} {{ public: using Parameters = ::{prefix}_parameters;\n\
         explicit {name}(const Parameters &params = {prefix}_default_parameters()) : mbs_self({prefix}_new(&params)) {{\n\
         const char *quantity = nullptr; mbs_real value = 0;\n\
         if ({prefix}_check(&params, &quantity, &value) != 0) {{\n\
         throw std::invalid_argument(std::string(quantity) + \" is \" + std::to_string(value)); }} }}\n\
         const Parameters &params() const {{ return mbs_self.params; }}\n"
    );
    let array = |count: usize| format!("std::array<mbs_real, {count}>");
    for Signature { name, known_as, arguments, outputs, returns } in functions {
        let declared = arguments.iter().map(|(name, count)| match count {
            None => format!("mbs_real {name}"),
            Some(count) => format!("const {} &{name}", array(*count)),
        });
        let given = arguments.iter().map(|(name, count)| match count {
            None => format!(", {name}"),
            Some(_) => format!(", {name}.data()"),
        });
        let (declared, given): (Vec<String>, String) = (declared.collect(), given.collect());
        let (declared, given) = (declared.join(", "), format!("{name}(&mbs_self{given}"));
        text += &match outputs.as_slice() {
            _ if *returns => format!("mbs_real {known_as}({declared}) const {{ return {given}); }}\n"),
            [] => String::new(),
            [(_, count)] => format!(
                "{kind} {known_as}({declared}) const {{ {kind} mbs_result; {given}, mbs_result.data()); \
                 return mbs_result; }}\n",
                kind = array(*count)
            ),
            parts => {
                let fields: String = parts.iter().map(|(part, count)| format!("{} {part}; ", array(*count))).collect();
                let results: String = parts.iter().map(|(part, _)| format!(", mbs_result.{part}.data()")).collect();
                format!(
                    "struct {known_as}_results {{ {fields} }};\n\
                     {known_as}_results {known_as}({declared}) const {{ {known_as}_results mbs_result; \
                     {given}{results}); return mbs_result; }}\n"
                )
            }
        };
    }
    text + &format!("private: ::{prefix} mbs_self; }}; }}\n")
}

/// The kernels of CUDA and OpenCL.
fn kernels(prefix: &str, functions: &[Signature]) -> String {
    let mut text = format!(
        "MBS_KERNEL {prefix}_new_kernel(MBS_GLOBAL const {prefix}_parameters *params, MBS_GLOBAL {prefix} *self) {{\n\
         const {prefix}_parameters mbs_params = *params; *self = {prefix}_new(&mbs_params); }}\n"
    );
    for Signature { name, arguments, outputs, returns, .. } in functions {
        let one = [("result".to_string(), 1)];
        let outputs = if *returns { &one[..] } else { outputs };
        let inputs = arguments.iter().map(|(name, _)| format!(", MBS_GLOBAL const mbs_real *{name}"));
        let results = outputs.iter().map(|(name, _)| format!(", MBS_GLOBAL mbs_real *{name}"));
        text += &format!(
            "MBS_KERNEL {name}_kernel(unsigned int states, MBS_GLOBAL const {prefix} *self{}) {{\n\
             const size_t mbs_state = MBS_STATE; if (mbs_state >= states) {{ return; }} const {prefix} mbs_self = *self;\n",
            inputs.chain(results).collect::<String>()
        );
        let mut given = "&mbs_self".to_string();
        for (name, count) in arguments {
            match count {
                None => given += &format!(", {name}[mbs_state]"),
                Some(count) => {
                    text += &format!(
                        "mbs_real mbs_{name}[{count}]; mbs_gather(states, mbs_state, {count}, {name}, mbs_{name});\n"
                    );
                    given += &format!(", mbs_{name}");
                }
            }
        }
        if *returns {
            text += &format!("result[mbs_state] = {name}({given}); }}\n");
            continue;
        }
        let own = outputs.iter().map(|(name, count)| format!("mbs_real mbs_{name}[{count}]; "));
        text += &own.collect::<String>();
        let names: Vec<String> = outputs.iter().map(|(name, _)| format!("mbs_{name}")).collect();
        let list = if names.is_empty() { String::new() } else { format!(", {}", joined(&names, ", ")) };
        text += &format!("{name}({given}{list});\n");
        let scattered = outputs
            .iter()
            .map(|(name, count)| format!("mbs_scatter(states, mbs_state, {count}, mbs_{name}, {name});\n"));
        text += &(scattered.collect::<String>() + "}\n");
    }
    text
}
