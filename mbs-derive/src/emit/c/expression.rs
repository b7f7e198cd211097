//! How values are written in C.

use super::super::body::Body;
use super::super::expression::{Tree, unfused};
use super::Header;

/// Keywords of C and C++, and what functions of a header have names for: a local or a field of such a name gets
/// another.
const TAKEN: &[&str] = &[
    "asm",
    "auto",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "continue",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "mutable",
    "namespace",
    "new",
    "operator",
    "private",
    "protected",
    "public",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typename",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "while",
    "and",
    "and_eq",
    "bitand",
    "bitor",
    "compl",
    "not",
    "not_eq",
    "or",
    "or_eq",
    "xor",
    "xor_eq",
    "nullptr",
    "constexpr",
    "consteval",
    "constinit",
    "decltype",
    "noexcept",
    "static_assert",
    "thread_local",
    "alignas",
    "alignof",
    "char8_t",
    "char16_t",
    "char32_t",
    "wchar_t",
    "concept",
    "requires",
    "co_await",
    "co_return",
    "co_yield",
    "const_cast",
    "dynamic_cast",
    "reinterpret_cast",
    "static_cast",
    "typeid",
    "size_t",
    "ptrdiff_t",
    "NULL",
    "self",
    "result",
    "reciprocals",
    "q",
    "qd",
    "qdd",
    "u",
    "prescribed",
    "multipliers",
    "NAN",
    "INFINITY",
    "HUGE_VAL",
    "HUGE_VALF",
    "HUGE_VALL",
    "typeof",
    "linux",
    "unix",
    "float_t",
    "double_t",
    "accelerations",
    "forces",
    "states",
    "params",
    "quantity",
    "value",
    "error",
    "order",
    // OpenCL C
    "half",
    "uchar",
    "ushort",
    "uint",
    "ulong",
    "global",
    "local",
    "constant",
    "kernel",
    "generic",
    "pipe",
    "read_only",
    "write_only",
    "read_write",
    "image1d_t",
    "image2d_t",
    "image3d_t",
    "event_t",
    "sampler_t",
    "vec_step",
    "uniform",
    // CUDA
    "threadIdx",
    "blockIdx",
    "blockDim",
    "gridDim",
    "warpSize",
];

/// Types of OpenCL C and CUDA, and how many numbers vectors of them have.
const ELEMENTS: [&str; 14] = [
    "bool", "char", "uchar", "short", "ushort", "int", "uint", "long", "ulong", "float", "double", "half", "longlong",
    "dim",
];
const LENGTHS: [&str; 6] = ["1", "2", "3", "4", "8", "16"];

/// What the headers of C declare besides: a mechanism of such a name gets another, for its struct stands beside them.
const LIBRARY: &[&str] = &[
    "acos",
    "acosh",
    "asin",
    "asinh",
    "atan",
    "atan2",
    "atanh",
    "cbrt",
    "ceil",
    "copysign",
    "cos",
    "cosh",
    "erf",
    "erfc",
    "exp",
    "exp2",
    "expm1",
    "fabs",
    "fdim",
    "floor",
    "fma",
    "fmax",
    "fmin",
    "fmod",
    "frexp",
    "gamma",
    "hypot",
    "ilogb",
    "isfinite",
    "isinf",
    "isnan",
    "isnormal",
    "j0",
    "j1",
    "jn",
    "ldexp",
    "lgamma",
    "log",
    "log10",
    "log1p",
    "log2",
    "logb",
    "lrint",
    "lround",
    "modf",
    "nan",
    "nearbyint",
    "nextafter",
    "pow",
    "remainder",
    "remquo",
    "rint",
    "round",
    "scalbn",
    "scalb",
    "signbit",
    "signgam",
    "significand",
    "sin",
    "sinh",
    "sqrt",
    "tan",
    "tanh",
    "tgamma",
    "trunc",
    "y0",
    "y1",
    "yn",
    "drem",
    "finite",
    "float_t",
    "double_t",
    "main",
    "abs",
    "labs",
    "llabs",
    "div",
    "ldiv",
    "lldiv",
    "exit",
    "abort",
    "atexit",
    "atof",
    "atoi",
    "atol",
    "strtod",
    "strtol",
    "rand",
    "srand",
    "malloc",
    "calloc",
    "realloc",
    "free",
    "qsort",
    "bsearch",
    "system",
    "getenv",
    "printf",
    "scanf",
    "puts",
    "gets",
    "getchar",
    "putchar",
    "fopen",
    "fclose",
    "remove",
    "rename",
    "tmpfile",
    "index",
    "rindex",
    "memcpy",
    "memset",
    "strlen",
    "time",
    "clock",
    "signal",
    "raise",
    "linux",
    "unix",
    "typeof",
    // OpenCL C and CUDA
    "cross",
    "dot",
    "distance",
    "length",
    "normalize",
    "clamp",
    "degrees",
    "radians",
    "mix",
    "step",
    "smoothstep",
    "sign",
    "select",
    "bitselect",
    "rotate",
    "clz",
    "popcount",
    "mad",
    "rsqrt",
    "rcbrt",
    "sincos",
    "sincospi",
    "sinpi",
    "cospi",
    "tanpi",
    "asinpi",
    "acospi",
    "atanpi",
    "exp10",
    "pown",
    "powr",
    "rootn",
    "fract",
    "min",
    "max",
    "norm",
    "barrier",
    "prefetch",
    "any",
    "all",
    "shuffle",
];

/// The identifier for a name of Rust.
pub(super) fn identifier(name: &str) -> String {
    let plain = name.strip_prefix("r#").unwrap_or(name);
    let begins = |starts: &[&str]| starts.iter().any(|start| plain.starts_with(start));
    let is_macro = begins(&["MBS_", "M_", "FP_", "MATH_", "CL_", "CLK_", "_"]) || plain.contains("__");
    let is_vector = |length: &&str| plain.strip_suffix(*length).is_some_and(|element| ELEMENTS.contains(&element));
    if is_macro
        || LENGTHS.iter().any(is_vector)
        || TAKEN.contains(&plain)
        || begins(&["mbs_", "by_q"])
        || plain == "by_u"
    {
        format!("c_{plain}")
    } else {
        plain.to_string()
    }
}

/// What names of a mechanism begin with, and its struct is called.
pub(super) fn prefix(mechanism: &str) -> String {
    if LIBRARY.contains(&mechanism) { format!("c_{mechanism}") } else { identifier(mechanism) }
}

/// The shortest literal that reads back as a value, of the number type.
pub(super) fn constant(value: f64) -> String {
    if value == std::f64::consts::PI {
        "MBS_C(3.14159265358979323846)".to_string()
    } else {
        format!("MBS_C({value:?})")
    }
}

/// A body's leaves as C.
pub(super) struct Printer<'b, 'n> {
    pub(super) body: &'b Body<'n>,
    pub(super) header: &'b Header<'n>,
    /// What is before a field of the mechanism.
    pub(super) own: &'static str,
}

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Choice,
    And,
    Comparison,
    Sum,
    Product,
    Sign,
    Primary,
}

impl Printer<'_, '_> {
    pub(super) fn local(&self, local: usize) -> String {
        identifier(&self.body.locals[local])
    }

    pub(super) fn tree(&self, tree: &Tree) -> String {
        self.within(tree, Precedence::Choice)
    }

    fn within(&self, tree: &Tree, least: Precedence) -> String {
        use Precedence::{And, Choice, Comparison, Primary, Product, Sign, Sum};
        let binary = |a: &Tree, sign: &str, b: &Tree, own: Precedence, right: Precedence| {
            (own, format!("{} {sign} {}", self.within(a, own), self.within(b, right)))
        };
        let (precedence, text) = match tree {
            Tree::Constant(value) => (Primary, constant(*value)),
            Tree::Hoisted(_) => (Primary, format!("{}{}", self.own, identifier(self.body.name(tree)))),
            Tree::Symbol(_) | Tree::Local(_) => (Primary, identifier(self.body.name(tree))),
            Tree::Neg(a) => (Sign, format!("-{}", self.within(a, Primary))),
            Tree::Add(a, b) => binary(a, "+", b, Sum, Product),
            Tree::Sub(a, b) => binary(a, "-", b, Sum, Product),
            Tree::Mul(a, b) => binary(a, "*", b, Product, Sign),
            Tree::Div(a, b) => binary(a, "/", b, Product, Sign),
            Tree::Less(a, b) => binary(a, "<", b, Comparison, Sum),
            Tree::LessEqual(a, b) => binary(a, "<=", b, Comparison, Sum),
            Tree::And(a, b) => binary(a, "&&", b, And, Comparison),
            Tree::Not(a) => (Sign, format!("!{}", self.within(a, Primary))),
            Tree::Select(c, a, b) => {
                let [c, a, b] = [c, a, b].map(|part| self.within(part, And));
                (Choice, format!("{c} ? {a} : {b}"))
            }
            Tree::Method("mul_add", a, rest) => return self.within(&unfused(a, rest), least),
            Tree::Method(name, a, rest) => {
                let arguments: Vec<String> = std::iter::once(&**a).chain(rest).map(|part| self.tree(part)).collect();
                (Primary, format!("mbs_{name}({})", arguments.join(", ")))
            }
        };
        if precedence < least { format!("({text})") } else { text }
    }
}
