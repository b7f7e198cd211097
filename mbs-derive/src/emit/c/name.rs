//! Identifiers that C, C++, OpenCL C and CUDA leave to a header.

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

/// Macros of the headers that headers of C++ include, besides those that begin or end as others do.
const MACROS: &[&str] = &[
    "errno",
    "alloca",
    "offsetof",
    "math_errhandling",
    "stdin",
    "stdout",
    "stderr",
    "BUFSIZ",
    "FILENAME_MAX",
    "FOPEN_MAX",
    "TMP_MAX",
    "L_tmpnam",
    "L_ctermid",
    "L_cuserid",
    "P_tmpdir",
    "RAND_MAX",
    "MB_CUR_MAX",
    "NFDBITS",
    "MAXFLOAT",
    "BYTE_ORDER",
    "BIG_ENDIAN",
    "LITTLE_ENDIAN",
    "PDP_ENDIAN",
    "WEOF",
    "WNOHANG",
    "WUNTRACED",
    "WSTOPPED",
    "WEXITED",
    "WCONTINUED",
    "WNOWAIT",
];

/// Whether a header of the library may define a macro of this name.
fn is_macro(name: &str) -> bool {
    let begins = |starts: &[&str]| starts.iter().any(|start| name.starts_with(start));
    let ends = |ends: &[&str]| ends.iter().any(|end| name.ends_with(end));
    // ISO/IEC 9899:2011, 7.31.3, leaves an E with a capital letter to errno.h; in use are those with three or more.
    let is_error =
        name.len() > 2 && name.starts_with('E') && name[1..].chars().all(|c| matches!(c, 'A'..='Z' | '0'..='9'));
    let is_limit = begins(&["INT", "UINT", "PTRDIFF", "SIZE", "WCHAR", "WINT", "SIG_ATOMIC"])
        && ends(&["_MAX", "_MIN", "_C", "_WIDTH"]);
    let is_of_math = begins(&["M_", "FP_", "MATH_", "SNAN", "HUGE_VAL"]);
    let is_of_the_system = begins(&["LC_", "SEEK_", "FD_", "EXIT_", "RENAME_"]);
    is_error || is_limit || is_of_math || is_of_the_system || MACROS.contains(&name)
}

/// The identifier for a name of Rust.
pub(super) fn identifier(name: &str) -> String {
    let plain = name.strip_prefix("r#").unwrap_or(name);
    let begins = |starts: &[&str]| starts.iter().any(|start| plain.starts_with(start));
    let is_reserved = begins(&["MBS_", "CL_", "CLK_", "_"]) || plain.contains("__") || is_macro(plain);
    let is_vector = |length: &&str| plain.strip_suffix(*length).is_some_and(|element| ELEMENTS.contains(&element));
    if is_reserved
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
    if ["mbs", "std"].contains(&mechanism) || LIBRARY.contains(&mechanism) {
        format!("c_{mechanism}")
    } else {
        identifier(mechanism)
    }
}

/// What a mechanism's class of C++ is called, in which `std` must be the library and `Parameters` its own type.
pub(super) fn class(mechanism: &str) -> String {
    if ["std", "Parameters"].contains(&mechanism) { format!("c_{mechanism}") } else { identifier(mechanism) }
}

/// What a method of the class is called.
pub(super) fn method(name: &str, class: &str) -> String {
    let own = if name == "Parameters" { format!("c_{name}") } else { identifier(name) };
    if own == class { format!("c_{own}") } else { own }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_header_may_define_is_called_otherwise() {
        for name in
            ["EOF", "EIO", "E2BIG", "ERANGE", "errno", "INT8_MAX", "SIZE_MAX", "SEEK_SET", "M_PI", "NAN", "double4"]
        {
            assert_eq!(identifier(name), format!("c_{name}"));
        }
        for name in ["E", "EI", "Ex", "INTake", "L_max", "mass", "M", "F_D"] {
            assert_eq!(identifier(name), name);
        }
        assert_eq!(
            ["mbs", "std", "sin", "mbs_arm", "arm"].map(prefix),
            ["c_mbs", "c_std", "c_sin", "c_mbs_arm", "arm"]
        );
    }
}
