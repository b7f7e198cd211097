//! Identifiers that C, C++, OpenCL C and CUDA leave to a header.

use super::super::name::prefixed;

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
    "random",
    "srandom",
    "rand_r",
    "drand48",
    "erand48",
    "lrand48",
    "nrand48",
    "mrand48",
    "jrand48",
    "srand48",
    "seed48",
    "lcong48",
    "ecvt",
    "fcvt",
    "gcvt",
    "mblen",
    "rewind",
    "perror",
    "fread",
    "fwrite",
    "fseek",
    "ftell",
    "fflush",
    "basename",
    "bcopy",
    "bzero",
    "bcmp",
    "ffs",
    "strdup",
    "strfry",
    "memfrob",
    "memmove",
    "memcmp",
    "strcat",
    "strcpy",
    "strcmp",
    "strtok",
    "canonicalize",
    "fadd",
    "fsub",
    "fmul",
    "fdiv",
    "ffma",
    "fsqrt",
    "dadd",
    "daddl",
    "dsubl",
    "dmull",
    "ddivl",
    "dfmal",
    "dsqrtl",
    "faddl",
    "fsubl",
    "fmull",
    "fdivl",
    "ffmal",
    "fsqrtl",
    "nextup",
    "nextdown",
    "setpayload",
    "setpayloadsig",
    "getpayload",
    "totalorder",
    "totalordermag",
    "dremf",
    "llrint",
    "llround",
    "nexttoward",
    "roundeven",
    "fmaxmag",
    "fminmag",
    "fmaximum",
    "fminimum",
    "fromfp",
    "ufromfp",
    "llogb",
    "scalbln",
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

/// Macros of the headers that headers of C++ include, besides those that begin or end as others do; and the variable
/// of math.h that a local would hide.
const MACROS: &[&str] = &[
    "I",
    "errno",
    "signgam",
    "complex",
    "imaginary",
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

/// Macros of fenv.h, limits.h, signal.h and unistd.h that do not begin as many others do.
const OTHER_MACROS: &str = "CSIGNAL F_LOCK F_OK F_TEST F_TLOCK F_ULOCK L_INCR L_SET L_XTND MAX_CANON MAX_INPUT \
    MINSIGSTKSZ NGREG NSIG NZERO PIPE_BUF R_OK TIME_UTC W_OK X_OK SIGABRT SIGALRM SIGBUS SIGCHLD SIGCLD SIGCONT SIGFPE \
    SIGHUP SIGILL SIGINT SIGIO SIGIOT SIGKILL SIGPIPE SIGPOLL SIGPROF SIGPWR SIGQUIT SIGRTMAX SIGRTMIN SIGSEGV \
    SIGSTKFLT SIGSTKSZ SIGSTOP SIGSYS SIGTERM SIGTRAP SIGTSTP SIGTTIN SIGTTOU SIGURG SIGUSR1 SIGUSR2 SIGVTALRM \
    SIGWINCH SIGXCPU SIGXFSZ FE_ALL_EXCEPT FE_DFL_ENV FE_DIVBYZERO FE_DOWNWARD FE_INEXACT FE_INVALID FE_OVERFLOW \
    FE_TONEAREST FE_TOWARDZERO FE_UNDERFLOW FE_UPWARD";

/// What POSIX and C have limits of.
const LIMITED: &[&str] = &[
    "INT",
    "UINT",
    "PTRDIFF",
    "SIZE",
    "SSIZE",
    "WCHAR",
    "WINT",
    "SIG_ATOMIC",
    "BOOL",
    "CHAR",
    "SCHAR",
    "UCHAR",
    "SHRT",
    "USHRT",
    "LONG",
    "ULONG",
    "LLONG",
    "ULLONG",
    "MB_LEN",
    "NAME",
    "PATH",
    "LINE",
    "IOV",
    "HOST_NAME",
    "LOGIN_NAME",
    "TTY_NAME",
    "WORD",
    "RE_DUP",
    "RTSIG",
    "SEM_VALUE",
];

/// Whether a header of the library may define a macro of this name.
fn is_macro(name: &str) -> bool {
    let begins = |starts: &[&str]| starts.iter().any(|start| name.starts_with(start));
    let ends = |ends: &[&str]| ends.iter().any(|end| name.ends_with(end));
    // ISO/IEC 9899:2011, 7.31.3, leaves an E with a capital letter to errno.h; in use are those with three or more.
    let is_error =
        name.len() > 2 && name.starts_with('E') && name[1..].chars().all(|c| matches!(c, 'A'..='Z' | '0'..='9'));
    let is_limit = begins(LIMITED) && ends(&["_MAX", "_MIN", "_C", "_WIDTH", "_BIT"]);
    let is_of_math = begins(&["M_", "FP_", "MATH_", "SNAN", "HUGE_VAL", "DBL_", "FLT_", "LDBL_"]);
    let is_of_the_system = begins(&["LC_", "SEEK_", "FD_", "EXIT_", "RENAME_", "SIG_", "CLOCKS_"]);
    let is_another = MACROS.contains(&name) || OTHER_MACROS.split_whitespace().any(|other| other == name);
    is_error || is_limit || is_of_math || is_of_the_system || is_another
}

/// The identifier for a name of Rust.
pub(super) fn identifier(name: &str) -> String {
    prefixed(name.strip_prefix("r#").unwrap_or(name), "c_", is_taken)
}

fn is_taken(plain: &str) -> bool {
    let begins = |starts: &[&str]| starts.iter().any(|start| plain.starts_with(start));
    let is_reserved = begins(&["MBS_", "CL_", "CLK_", "_"]) || plain.contains("__") || is_macro(plain);
    let is_vector = |length: &&str| plain.strip_suffix(*length).is_some_and(|element| ELEMENTS.contains(&element));
    is_reserved
        || LENGTHS.iter().any(is_vector)
        || TAKEN.contains(&plain)
        || begins(&["mbs_", "by_q"])
        || plain == "by_u"
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
        // Macros of <complex.h>, <limits.h>, <float.h>, <signal.h>, and glibc's variable in <math.h>.
        assert_eq!(["complex", "imaginary"].map(prefix), ["c_complex", "c_imaginary"]);
        // And what would be called like one of them.
        let names = ["q", "c_q", "c_c_q", "double", "c_double", "c_mass"].map(identifier);
        assert_eq!(names, ["c_q", "c_c_q", "c_c_c_q", "c_double", "c_c_double", "c_mass"]);
        for name in ["I", "CHAR_BIT", "LONG_MAX", "PATH_MAX", "DBL_MAX", "FLT_DIG", "SIGINT", "F_OK", "signgam"] {
            assert_eq!(identifier(name), format!("c_{name}"));
        }
        for name in ["E", "EI", "Ex", "INTake", "L_max", "mass", "M", "F_D", "I_1", "J", "SIGMA", "i", "L_MAX"] {
            assert_eq!(identifier(name), name);
        }
        assert_eq!(
            ["mbs", "std", "sin", "mbs_arm", "arm"].map(prefix),
            ["c_mbs", "c_std", "c_sin", "c_mbs_arm", "arm"]
        );
    }
}
