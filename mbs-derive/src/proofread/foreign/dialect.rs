//! What languages differ in: a table, a row a language.

use crate::emit::{Language, Trigonometry};
use crate::expr::{Binary, Function};

use super::super::token::{Lexis, Lines};

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
    Constant,
    Root,
    Call(Function),
    Call2(Binary),
    Select,
    /// A derivative of the spline with this number.
    Spline(usize, usize),
}

impl Meant {
    /// How many arguments it takes.
    pub(super) fn arguments(self) -> usize {
        match self {
            Meant::Constant | Meant::Root | Meant::Call(_) | Meant::Spline(..) => 1,
            Meant::Call2(_) => 2,
            Meant::Select => 3,
        }
    }
}

/// How a language is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dialect {
    pub(super) language: Language,
    pub(super) family: Family,
    pub(super) lexis: Lexis,
    /// Operators of two operands, those that bind least first.
    pub(super) levels: [&'static [&'static str]; 4],
    pub(super) not: &'static str,
    /// Whether there is `c ? a : b`.
    pub(super) has_choices: bool,
    /// What is around an index.
    pub(super) index: [&'static str; 2],
    /// The index of the first entry.
    pub(super) first: usize,
    /// What stands before a value that the constructor has computed, in the constructor and in functions.
    pub(super) own: [&'static str; 2],
    /// What stands before a statement of a function.
    pub(super) indent: &'static str,
    pub(super) pi: &'static str,
    /// What stands before elementary functions of the library.
    prefix: &'static str,
    /// Other names than those of `Scalar`, with these.
    renamed: &'static [(&'static str, &'static str)],
    /// Elementary functions that files bring with them: their names behind `mbs_`.
    brought: &'static [&'static str],
    trigonometry: Trigonometry,
}

const C: Dialect = Dialect {
    language: Language::C,
    family: Family::C,
    lexis: Lexis {
        comment: "//",
        has_blocks: true,
        joints: &[".", "->"],
        has_directives: true,
        quotes: "\"'",
        has_docstrings: false,
        lines: Lines::Free,
    },
    levels: [&["&&"], &["<", "<="], &["+", "-"], &["*", "/"]],
    not: "!",
    has_choices: true,
    index: ["[", "]"],
    first: 0,
    own: ["self.", "self->"],
    indent: "",
    pi: "",
    prefix: "mbs_",
    renamed: &[],
    brought: &[],
    trigonometry: Trigonometry::Library,
};

const JS: Dialect = Dialect {
    language: Language::Js,
    family: Family::Js,
    lexis: Lexis { quotes: "\"'`", has_directives: false, ..C.lexis },
    own: ["this.#", "this.#"],
    pi: "Math.PI",
    prefix: "Math.",
    renamed: &[("log", "ln"), ("pow", "powf")],
    brought: &["signum"],
    ..C
};

const PYTHON: Dialect = Dialect {
    language: Language::Python,
    family: Family::Python,
    lexis: Lexis {
        comment: "#",
        has_blocks: false,
        joints: C.lexis.joints,
        has_directives: false,
        quotes: "\"'",
        has_docstrings: true,
        lines: Lines::Indented,
    },
    levels: [&["<", "<="], &["&"], &["+", "-"], &["*", "/"]],
    not: "~",
    has_choices: false,
    own: ["self._", "self._"],
    indent: "        ",
    pi: "math.pi",
    prefix: "np.",
    renamed: &[
        ("log", "ln"),
        ("power", "powf"),
        ("arcsin", "asin"),
        ("arccos", "acos"),
        ("arctan", "atan"),
        ("arctan2", "atan2"),
    ],
    brought: &["signum"],
    ..C
};

const MATLAB: Dialect = Dialect {
    language: Language::Matlab,
    family: Family::Matlab,
    lexis: Lexis { comment: "%", has_blocks: false, has_directives: false, lines: Lines::Rows, ..C.lexis },
    not: "~",
    has_choices: false,
    index: ["(", ")"],
    first: 1,
    own: ["c.", "c."],
    pi: "pi",
    prefix: "",
    brought: &["sqrt", "ln", "asin", "acos", "powf", "signum"],
    ..C
};

impl Dialect {
    /// That of a language, with these sines; of Rust there is none.
    pub(super) fn of(language: Language, trigonometry: Trigonometry) -> Option<Self> {
        match language {
            Language::Rust => None,
            // A header decides in what it begins with whose sines it has.
            Language::C | Language::Cpp | Language::Cuda | Language::Opencl => Some(Dialect { language, ..C }),
            Language::Js => Some(Dialect { trigonometry, ..JS }),
            Language::Python => Some(Dialect { trigonometry, ..PYTHON }),
            Language::Matlab => Some(Dialect { trigonometry, ..MATLAB }),
        }
    }

    /// How tightly an operator of two operands binds, if it is one.
    pub(super) fn level(&self, operator: &str) -> Option<usize> {
        self.levels.iter().position(|operators| operators.contains(&operator))
    }

    /// Whether one call gives sine and cosine.
    pub(super) fn has_pairs(&self) -> bool {
        self.family == Family::C || self.trigonometry == Trigonometry::Polynomials
    }

    /// What a function computes, if it is one that is computed here.
    pub(super) fn function(&self, name: &str) -> Option<Meant> {
        match (self.family, name) {
            (Family::C, "MBS_C") => return Some(Meant::Constant),
            (Family::Python, "np.where") | (Family::Matlab, "mbs_choose") => return Some(Meant::Select),
            _ => {}
        }
        if self.family != Family::C && self.trigonometry == Trigonometry::Polynomials {
            match name {
                "mbs_own_sin" => return Some(Meant::Call(Function::Sin)),
                "mbs_own_cos" => return Some(Meant::Call(Function::Cos)),
                _ if name.strip_prefix(self.prefix).is_some_and(|name| ["sin", "cos"].contains(&name)) => return None,
                _ => {}
            }
        }
        let brought = name.strip_prefix("mbs_").filter(|name| self.brought.contains(name));
        let of_library = || {
            let name = name.strip_prefix(self.prefix)?;
            let renamed = self.renamed.iter().find(|(own, _)| *own == name).map(|(_, known)| *known);
            let is_other = self.brought.contains(&name) || self.renamed.iter().any(|(_, known)| *known == name);
            renamed.or((!is_other).then_some(name))
        };
        match brought.or_else(of_library)? {
            "sqrt" => Some(Meant::Root),
            // Elsewhere it is one divided by another one.
            "sech" => (self.family == Family::C).then_some(Meant::Call(Function::Sech)),
            name => {
                let unary = Function::ALL.into_iter().find(|function| function.name() == name).map(Meant::Call);
                let binary = || Binary::ALL.into_iter().find(|function| function.name() == name);
                unary.or_else(|| binary().map(Meant::Call2))
            }
        }
    }
}
