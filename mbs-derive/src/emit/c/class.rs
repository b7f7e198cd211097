//! The class of a mechanism in C++17: its functions over `std::array`, the result returned.

use std::fmt::Write;

use super::super::walk::{Routine, block_comment};
use super::function::{Signature, plain};
use super::name::{class, method};
use super::{Header, head};

impl Header<'_> {
    /// Behind the functions of C, which it calls.
    pub(super) fn class(&self, routines: &[&Routine]) -> String {
        let (prefix, name) = (&self.prefix, class(&self.derivation.name));
        let mut text = String::from("namespace mbs {\n\n");
        text += &block_comment(&["The mechanism: functions take and return `std::array`.".to_string()], 0);
        let _ = writeln!(text, "class {name} {{\npublic:\n    using Parameters = ::{prefix}_parameters;\n");
        let docs = format!("Throws `std::invalid_argument` with what {prefix}_check refuses.");
        text += &block_comment(&[docs], 4);
        let _ = writeln!(text, "    explicit {name}(const Parameters &params = {prefix}_default_parameters())");
        let _ = writeln!(text, "        : mbs_self({prefix}_new(&params))\n    {{");
        text += "        const char *quantity = nullptr;\n        mbs_real value = 0;\n";
        let _ = writeln!(text, "        if ({prefix}_check(&params, &quantity, &value) != 0) {{");
        text += "            throw std::invalid_argument(std::string(quantity) + \" is \" + std::to_string(value));\n";
        text += "        }\n    }\n\n";
        let _ = writeln!(text, "    const Parameters &params() const {{ return mbs_self.params; }}\n");
        for routine in routines {
            text += &self.method(&method(&plain(&routine.name), &name), &self.signature(routine));
        }
        let _ = writeln!(text, "private:\n    ::{prefix} mbs_self;\n}};\n\n}} // namespace mbs\n");
        text
    }

    fn method(&self, name: &str, signature: &Signature) -> String {
        let array = |count: &usize| format!("std::array<mbs_real, {count}>");
        let arguments = signature.arguments.iter().map(|(name, count)| match count {
            None => format!("mbs_real {name}"),
            Some(count) => format!("const {} &{name}", array(count)),
        });
        let arguments: Vec<String> = arguments.collect();
        let given = signature.arguments.iter().map(|(name, count)| match count {
            None => (*name).to_string(),
            Some(_) => format!("{name}.data()"),
        });
        let mut given: Vec<String> = std::iter::once("&mbs_self".to_string()).chain(given).collect();
        let (fields, kind) = match signature.outputs.as_slice() {
            _ if signature.returns => (String::new(), "mbs_real".to_string()),
            [] => return String::new(),
            [(_, count)] => {
                given.push("mbs_result.data()".to_string());
                (String::new(), array(count))
            }
            parts => {
                given.extend(parts.iter().map(|(part, _)| format!("mbs_result.{part}.data()")));
                let fields: String =
                    parts.iter().map(|(part, count)| format!("        {} {part};\n", array(count))).collect();
                let kind = format!("{name}_results");
                (format!("    struct {kind} {{\n{fields}    }};\n\n"), kind)
            }
        };
        let docs = block_comment(&[format!("See {}.", signature.name)], 4);
        let declared = head(&format!("{kind} {name}"), &arguments).replace(")\n{\n", ") const\n{\n");
        let call = format!("{}({})", signature.name, given.join(", "));
        let body = match signature.returns {
            true => format!("    return {call};\n}}\n"),
            false => format!("    {kind} mbs_result;\n    {call};\n    return mbs_result;\n}}\n"),
        };
        let lines: String = (declared + &body).lines().map(|line| format!("    {line}\n")).collect();
        fields + &docs + &lines + "\n"
    }
}
