//! What languages differ in: a table, a row a language.

use crate::emit::Language;
use crate::expr::{Binary, Function, Trigonometry};

use super::expression::{binary, unary};
use super::token::Lexis;

/// How statements stand in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// C, C++, CUDA and OpenCL C: results are written through pointers.
    C,
    Js,
    Python,
    Matlab,
}

/// What a function of a language computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meant {
    /// A constant of the number type.
    Itself,
    Root,
    Call(Function),
    Call2(Binary),
    Select,
    /// Sine and cosine, both.
    SinCos,
    /// Of places, rows, order and argument.
    Spline,
    Zeros,
    Struct,
    Repeated,
    /// An argument that is looked at.
    Argument,
}

/// How a language is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dialect {
    pub(super) family: Family,
    pub(super) lexis: Lexis,
    /// Operators of two operands, those that bind least first.
    pub(super) levels: &'static [&'static [&'static str]],
    pub(super) not: &'static str,
    /// Whether there is `c ? a : b`.
    pub(super) has_choices: bool,
    /// Whether `{ }` is a value with fields, no array.
    pub(super) has_objects: bool,
    /// What is around an index.
    pub(super) index: [&'static str; 2],
    /// The index of the first entry.
    pub(super) first: usize,
    /// What the mechanism is called in its functions.
    pub(super) itself: &'static str,
    pub(super) pi: &'static str,
    /// Functions of the language's library that are taken for what they are, beside those that are shared.
    pub(super) library: &'static [&'static str],
    /// What stands before elementary functions of the library.
    prefix: &'static str,
    /// Other names than those of `Scalar`, with these.
    renamed: &'static [(&'static str, &'static str)],
    /// Elementary functions that files bring with them: their names behind `mbs_`.
    own: &'static [&'static str],
    trigonometry: Trigonometry,
}

const INFIX: &[&[&str]] = &[&["&&"], &["<", "<="], &["+", "-"], &["*", "/"]];

const C: Dialect = Dialect {
    family: Family::C,
    lexis: Lexis {
        comment: "//",
        has_blocks: true,
        has_directives: true,
        quotes: "\"'",
        has_docstrings: false,
        has_rows: false,
    },
    levels: INFIX,
    not: "!",
    has_choices: true,
    has_objects: false,
    index: ["[", "]"],
    first: 0,
    itself: "self",
    pi: "",
    library: &[],
    prefix: "mbs_",
    renamed: &[],
    own: &[],
    trigonometry: Trigonometry::Library,
};

const JS: Dialect = Dialect {
    family: Family::Js,
    lexis: Lexis { quotes: "\"'`", has_directives: false, ..C.lexis },
    has_objects: true,
    itself: "this",
    pi: "Math.PI",
    library: &["Array.from"],
    prefix: "Math.",
    renamed: &[("log", "ln"), ("pow", "powf")],
    own: &["signum"],
    ..C
};

const PYTHON: Dialect = Dialect {
    family: Family::Python,
    lexis: Lexis {
        comment: "#",
        has_blocks: false,
        has_directives: false,
        quotes: "\"'",
        has_docstrings: true,
        has_rows: false,
    },
    levels: &[&["<", "<="], &["&"], &["+", "-"], &["*", "/"]],
    not: "~",
    has_choices: false,
    pi: "math.pi",
    library: &["np.broadcast_shapes", "np.array"],
    prefix: "np.",
    renamed: &[
        ("log", "ln"),
        ("power", "powf"),
        ("arcsin", "asin"),
        ("arccos", "acos"),
        ("arctan", "atan"),
        ("arctan2", "atan2"),
    ],
    own: &["signum"],
    ..C
};

const MATLAB: Dialect = Dialect {
    family: Family::Matlab,
    lexis: Lexis { comment: "%", has_blocks: false, has_directives: false, has_rows: true, ..C.lexis },
    not: "~",
    has_choices: false,
    index: ["(", ")"],
    first: 1,
    itself: "c",
    pi: "pi",
    prefix: "",
    own: &["sqrt", "ln", "asin", "acos", "powf", "signum"],
    ..C
};

impl Dialect {
    /// That of a language, with these sines; `None` of Rust.
    pub(super) fn of(language: Language, trigonometry: Trigonometry) -> Option<Self> {
        let dialect = match language {
            Language::Rust => return None,
            Language::C | Language::Cpp | Language::Cuda | Language::Opencl => return Some(C),
            Language::Js => JS,
            Language::Python => PYTHON,
            Language::Matlab => MATLAB,
        };
        Some(Dialect { trigonometry, ..dialect })
    }

    /// What a function computes, if it is one that is computed here.
    pub(super) fn function(&self, name: &str) -> Option<Meant> {
        let special = match (self.family, name) {
            (Family::C, "MBS_C") => Some(Meant::Itself),
            (Family::Python, "np.where") | (Family::Matlab, "mbs_choose") => Some(Meant::Select),
            (Family::Python, "mbs_argument") => Some(Meant::Argument),
            (Family::Matlab, "zeros") => Some(Meant::Zeros),
            (Family::Matlab, "struct") => Some(Meant::Struct),
            (Family::Matlab, "repmat") => Some(Meant::Repeated),
            (Family::Js | Family::Python | Family::Matlab, "mbs_spline") => Some(Meant::Spline),
            _ => None,
        };
        if special.is_some() {
            return special;
        }
        // C decides in its prelude whose sines they are.
        if self.family != Family::C && self.trigonometry == Trigonometry::Polynomials {
            match name {
                "mbs_sin_cos" => return Some(Meant::SinCos),
                "mbs_own_sin" => return Some(Meant::Call(Function::Sin)),
                "mbs_own_cos" => return Some(Meant::Call(Function::Cos)),
                _ if ["sin", "cos"].iter().any(|sine| name.strip_prefix(self.prefix) == Some(sine)) => return None,
                _ => {}
            }
        }
        let own = name.strip_prefix("mbs_").filter(|name| self.own.contains(name));
        let of_library = || {
            let name = name.strip_prefix(self.prefix)?;
            let renamed = self.renamed.iter().find(|(own, _)| *own == name).map(|(_, known)| *known);
            let is_other = self.own.contains(&name) || self.renamed.iter().any(|(_, known)| *known == name);
            renamed.or((!is_other).then_some(name))
        };
        let name = own.or_else(of_library)?;
        match name {
            "sqrt" => Some(Meant::Root),
            "sech" if self.family != Family::C => None,
            name => unary(name).map(Meant::Call).or_else(|| binary(name).map(Meant::Call2)),
        }
    }
}
