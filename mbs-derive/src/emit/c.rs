//! Pass 6, once more: [`Derivation`] → C99, one header a mechanism, and what C++, CUDA and OpenCL have besides.
//!
//! - `parameter`: parameters, what they must satisfy, and the struct of the mechanism;
//! - `function`: its functions; `solution`: systems that are solved for them;
//! - `class`: those of C++;
//! - `kernel`: the same for many states at once, in CUDA and OpenCL;
//! - `syntax`: how values and statements are written in C; `loops`: tables, arrays and loops of a long chain;
//! - `name`: identifiers that it has already;
//! - `interface`: how a header calls things, for who wraps it;
//! - `prelude`: what all headers share: the number type, elementary functions, solvers.
//!
//! What stands in a function, in which order, with which names, is said by the walk of `walk`.
//!
//! The header needs `math.h` alone, allocates nothing, and is C++ as well. It computes what the Rust computes, in the
//! same order: where only `+ − × ÷ √` occur the bits are the same, unless the compiler contracts products and sums (GCC
//! and Clang do not with `-ffp-contract=off`).

mod class;
mod function;
mod interface;
mod kernel;
mod loops;
mod name;
mod parameter;
mod prelude;
mod solution;
mod syntax;

use std::fmt::Write;

use crate::optimise::Derivation;
use crate::variable;

use super::walk::{Routine, Walk, block_comment};
use super::{Identifiers, Options};
pub use interface::Interface;
use name::prefix;
pub(super) use prelude::shared;
use syntax::constant;

/// What a header is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dialect {
    /// C99, which is C++ and, in functions of host and device, CUDA and HIP as well.
    C,
    /// A header of C99 with a class of C++17.
    Cpp,
    /// A header of C99 with kernels over many states, for CUDA and HIP.
    Cuda,
    /// OpenCL C with kernels over many states.
    OpenCl,
}

/// The header of a mechanism in C99; `source` is what its first line calls the declaration.
///
/// ```
/// use mbs_derive::{Analysis, expr::Graph, source::Sources};
/// let text = "mechanism Spring { param k: N/m = 4; coord x: m; kinetic += 1 kg*dt(x)^2/2; potential += k*x^2/2; }";
/// let graph = Graph::verbatim();
/// let analysis = Analysis::of(&Sources::new("spring.mbs", text), &graph).unwrap();
/// use mbs_derive::emit::Language;
/// let header = Language::C.write(analysis.programs(), "spring.mbs", &Default::default());
/// assert!(header.contains("MBS_FN mbs_real spring_potential_energy(const spring *self, const mbs_real q[1])"));
/// ```
pub(super) fn c(derivation: &Derivation, source: &str, options: &Options) -> String {
    written(derivation, source, options, Dialect::C)
}

/// The header of a mechanism in a dialect of C.
pub(super) fn written(derivation: &Derivation, source: &str, options: &Options, dialect: Dialect) -> String {
    Header::new(Walk::new(derivation, source, options), dialect).written()
}

/// What a header calls things.
pub(super) fn identifiers(walk: Walk<'_>) -> Identifiers {
    let header = Header::new(walk, Dialect::C);
    let class = name::class(&header.derivation.name);
    let function = |(i, _): &(usize, _)| {
        let name = &header.walk.names.functions[*i];
        (*i, header.name(name), name::method(&function::plain(name), &class))
    };
    Identifiers {
        mechanism: header.prefix.clone(),
        class: class.clone(),
        parameters: header.walk.parameters().map(|(_, field)| name::identifier(&field)).collect(),
        functions: header.walk.functions.iter().map(function).collect(),
        motion: header.name(&header.walk.names.constrained_motion),
    }
}

/// Lines of lists are no longer than this; a longer head of a function has a line for each argument.
const WIDEST: usize = 118;

struct Header<'d> {
    walk: Walk<'d>,
    derivation: &'d Derivation,
    /// What all names begin with.
    prefix: String,
    dialect: Dialect,
}

impl<'d> Header<'d> {
    fn new(walk: Walk<'d>, dialect: Dialect) -> Self {
        Header { derivation: walk.derivation, prefix: prefix(&walk.snake_case()), walk, dialect }
    }

    fn written(&self) -> String {
        let guard = format!("MBS_{}_H", self.prefix.to_uppercase());
        let routines = self.walk.routines(&self.in_function());
        let mut text = block_comment(&self.walk.docs(), 0);
        let _ = write!(text, "#ifndef {guard}\n#define {guard}\n\n{}", prelude::text(self));
        text += &self.sizes();
        text += &self.parameters();
        text += &self.tables();
        text += &self.check();
        text += &self.constructor();
        for routine in &routines {
            text += &self.function(routine);
        }
        let functions: Vec<&Routine> = routines.iter().filter(|routine| !routine.is_motion()).collect();
        match self.dialect {
            Dialect::C => {}
            Dialect::Cpp => text += &self.class(&functions),
            Dialect::Cuda | Dialect::OpenCl => text += &self.kernels(&functions),
        }
        let _ = writeln!(text, "#endif /* {guard} */");
        text
    }

    /// Numbers of coordinates and inputs, and the place of each; of a header with kernels also those of the structs.
    fn sizes(&self) -> String {
        let upper = self.prefix.to_uppercase();
        let mut text = String::new();
        let kinds = [("DOF", "Q", &self.derivation.coordinates), ("INPUTS", "U", &self.derivation.inputs)];
        for (count, kind, variables) in kinds {
            let _ = writeln!(text, "#define {upper}_{count} {}", variable::count(variables));
            for variable in variables {
                let _ = writeln!(text, "#define {upper}_{kind}_{} {}", variable.name, variable.first);
            }
        }
        if self.has_kernels() {
            let parameters = variable::count(&self.derivation.parameters).max(1);
            text += &block_comment(&["How many numbers the structs are, one after the other.".to_string()], 0);
            let _ = writeln!(text, "#define {upper}_PARAMETERS {parameters}");
            let _ = writeln!(text, "#define {upper}_NUMBERS {}", parameters + self.walk.hoisted().len());
        }
        text + "\n"
    }

    fn has_kernels(&self) -> bool {
        matches!(self.dialect, Dialect::Cuda | Dialect::OpenCl)
    }

    /// The splines that tables of the model are. OpenCL has constants outside of functions alone, CUDA inside.
    fn tables(&self) -> String {
        let list = |values: &[f64]| values.iter().map(|&x| constant(x)).collect::<Vec<_>>().join(", ");
        let mut text = String::new();
        for (number, spline) in self.walk.names.splines.iter().enumerate() {
            let (name, rows) = (self.table(number), spline.rows());
            let (places, columns) = (spline.places(), spline.degree() + 2);
            let is_inside = self.dialect != Dialect::OpenCl;
            let (kind, indent) = if is_inside { ("static const", "    ") } else { ("__constant const", "") };
            let mut constants = String::new();
            let _ =
                writeln!(constants, "{indent}{kind} mbs_real {name}_places[{}] = {{{}}};", places.len(), list(places));
            let _ = writeln!(constants, "{indent}{kind} mbs_real {name}_rows[{}] = {{", rows.len() * columns);
            rows.iter().for_each(|row| {
                let _ = writeln!(constants, "{indent}    {},", list(row));
            });
            let _ = writeln!(constants, "{indent}}};");
            let head = format!("MBS_FN mbs_real {name}(int order, mbs_real x)\n{{\n");
            let count = places.len();
            let call =
                format!("    return mbs_spline({count}, {name}_places, {columns}, {name}_rows, order, x);\n}}\n\n");
            text += &if is_inside { head + &constants + &call } else { constants + &head + &call };
        }
        text
    }

    fn table(&self, number: usize) -> String {
        format!("{}_table_{number}", self.prefix)
    }
}

/// Lines of a function's body.
fn inside(lines: &[String]) -> String {
    lines.iter().map(|line| format!("    {line}\n")).collect()
}

/// `head(arguments)`, on one line where it is short enough.
fn head(head: &str, arguments: &[String]) -> String {
    let one_line = format!("{head}({})", arguments.join(", "));
    match one_line.len() {
        0..=WIDEST => format!("{one_line}\n{{\n"),
        _ => format!("{head}(\n    {})\n{{\n", arguments.join(",\n    ")),
    }
}

/// `name[0] = …;`, one a line.
fn assigned<'a>(name: &str, values: impl Iterator<Item = &'a String>) -> String {
    values.enumerate().map(|(i, value)| format!("    {name}[{i}] = {value};\n")).collect()
}
