//! How values and statements are written in C.

use super::super::rolled::Loops;
use super::super::walk::{Place, Side, Syntax, Wanted, if_else, one_angle};
use super::Header;
use super::name::identifier;

/// C within a function of a header.
pub(super) struct C<'h, 'd> {
    header: &'h Header<'d>,
    /// What is before a field of the mechanism.
    own: &'static str,
    /// What is before a parameter.
    params: &'static str,
}

impl<'d> Header<'d> {
    /// In functions of the mechanism.
    pub(super) fn in_function(&self) -> C<'_, 'd> {
        C { header: self, own: "self->", params: "self->params." }
    }

    /// Where the mechanism is made of its parameters.
    pub(super) fn in_constructor(&self) -> C<'_, 'd> {
        C { header: self, own: "self.", params: "params->" }
    }
}

/// The shortest literal that reads back as a value, of the number type.
pub(super) fn constant(value: f64) -> String {
    if value == std::f64::consts::PI {
        "MBS_C(3.14159265358979323846)".to_string()
    } else {
        format!("MBS_C({value:?})")
    }
}

impl Syntax for C<'_, '_> {
    fn identifier(&self, name: &str) -> String {
        identifier(name)
    }

    fn constant(&self, value: f64) -> String {
        constant(value)
    }

    fn hoisted(&self, name: &str) -> String {
        format!("{}{}", self.own, identifier(name))
    }

    fn and(&self) -> &'static str {
        "&&"
    }

    fn not(&self) -> &'static str {
        "!"
    }

    fn select(&self, condition: &str, [then, otherwise]: [&str; 2], _known: bool) -> String {
        format!("{condition} ? {then} : {otherwise}")
    }

    /// The prelude says whether sines and cosines are the library's.
    fn call(&self, name: &str, arguments: &[String]) -> String {
        format!("mbs_{}({})", name.strip_prefix("own_").unwrap_or(name), arguments.join(", "))
    }

    fn comment(&self, text: &str) -> String {
        format!("// {text}")
    }

    /// Kernels have no use for arrays of a long chain: each work item would have its own.
    fn loops(&self) -> Option<&dyn Loops> {
        (!self.header.has_kernels()).then_some(self)
    }

    fn bind(&self, name: &str, value: &str) -> String {
        format!("const mbs_real {name} = {value};")
    }

    fn sin_cos(&self, [sin, cos]: [&str; 2], angle: &str) -> Vec<String> {
        vec![format!("mbs_real {sin}, {cos};"), format!("mbs_sin_cos({angle}, &{sin}, &{cos});")]
    }

    /// Several angles by one call, which compilers turn into vector instructions. Kernels have no use for that: their
    /// work items are in lockstep themselves.
    fn sin_cos_all(&self, angles: &[Wanted], _library: bool, number: usize) -> Vec<String> {
        if angles.len() == 1 || self.header.has_kernels() {
            return angles.iter().flat_map(|angle| one_angle(self, angle, false)).collect();
        }
        let count = angles.len();
        let [given, sines, cosines] = ["angles", "sines", "cosines"].map(|name| format!("mbs_{name}_{number}"));
        let each: Vec<&str> = angles.iter().map(|wanted| wanted.angle.as_str()).collect();
        let mut lines = vec![
            format!("const mbs_real {given}[{count}] = {{{}}};", each.join(", ")),
            format!("mbs_real {sines}[{count}], {cosines}[{count}];"),
            format!("mbs_sin_cos_all({count}, {given}, {sines}, {cosines});"),
        ];
        for (i, Wanted { sin, cos, .. }) in angles.iter().enumerate() {
            for (local, values) in [(sin, &sines), (cos, &cosines)] {
                lines.extend(local.as_ref().map(|local| self.bind(local, &format!("{values}[{i}]"))));
            }
        }
        lines
    }

    fn spline(&self, table: usize, order: usize, x: &str) -> String {
        format!("{}({order}, {x})", self.header.table(table))
    }

    fn branch(&self, names: &[String], condition: &str, sides: [Side; 2]) -> Vec<String> {
        let begin = vec![format!("mbs_real {};", names.join(", ")), format!("if ({condition}) {{")];
        if_else(begin, names, &sides, ["} else {", "}"], 4)
    }

    fn read(&self, place: &Place<'_>) -> String {
        match place {
            Place::Argument(name, i) => format!("{name}[{i}]"),
            Place::Prescribed(i, order) => format!("prescribed[{}]", 3 * i + order),
            Place::Parameter(name, indices) => {
                let indices: String = indices.iter().map(|i| format!("[{i}]")).collect();
                format!("{}{}{indices}", self.params, identifier(name))
            }
        }
    }
}
