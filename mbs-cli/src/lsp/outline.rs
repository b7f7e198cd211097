//! What a file declares and where its names stand, read from its tokens alone: so it is there while the text is wrong.
//!
//! Every word of the text is a [`Word`] with its role; names are looked up by [`resolve`](super::resolve).

mod reader;

use std::ops::Range;

use mbs_derive::source::Sources;
use reader::Reader;

/// What a name is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Mechanism,
    Parameter,
    Coordinate,
    Input,
    Prescribed,
    Constant,
    Local,
    Loop,
    Argument,
    Function,
    Part,
    Instance,
    Output,
    Constraint,
    Reaction,
}

/// Names of one space hide each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Space {
    Value,
    Function,
    Part,
    Output,
    Constraint,
    Reaction,
    Mechanism,
}

impl Kind {
    pub(super) fn space(self) -> Space {
        match self {
            Kind::Parameter | Kind::Coordinate | Kind::Input | Kind::Prescribed | Kind::Constant => Space::Value,
            Kind::Local | Kind::Loop | Kind::Argument | Kind::Instance => Space::Value,
            Kind::Function => Space::Function,
            Kind::Part => Space::Part,
            Kind::Output => Space::Output,
            Kind::Constraint => Space::Constraint,
            Kind::Reaction => Space::Reaction,
            Kind::Mechanism => Space::Mechanism,
        }
    }

    /// Whether functions and parts see it that are declared beside it.
    pub(super) fn is_everywhere(self) -> bool {
        use Kind::{Constant, Coordinate, Function, Input, Parameter, Part, Prescribed};
        matches!(self, Parameter | Coordinate | Input | Prescribed | Constant | Function | Part)
    }

    pub(super) fn described(self) -> &'static str {
        match self {
            Kind::Mechanism => "mechanism",
            Kind::Parameter => "parameter",
            Kind::Coordinate => "coordinate",
            Kind::Input => "input",
            Kind::Prescribed => "prescribed motion",
            Kind::Constant => "constant",
            Kind::Local => "local name",
            Kind::Loop => "loop variable",
            Kind::Argument => "argument",
            Kind::Function => "function",
            Kind::Part => "part",
            Kind::Instance => "use of a part",
            Kind::Output => "output",
            Kind::Constraint => "constraint",
            Kind::Reaction => "reaction",
        }
    }
}

/// A name that is declared.
#[derive(Clone, Debug)]
pub(super) struct Symbol {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// The name's place.
    pub(super) span: Range<usize>,
    /// From the first word of its statement to its end.
    pub(super) statement: Range<usize>,
    pub(super) docs: String,
    /// The block that it is declared in.
    pub(super) scope: usize,
    /// Of a mechanism, a function or a part, its own block.
    pub(super) body: Option<usize>,
    /// Of the use of a part, the name of the part.
    pub(super) part: Option<String>,
    /// Whether a unit was written.
    pub(super) has_unit: bool,
}

/// A block; the first is the file.
#[derive(Clone, Debug)]
pub(super) struct Scope {
    pub(super) parent: usize,
    pub(super) span: Range<usize>,
    /// A function's or a part's: from outside only what is everywhere is seen.
    pub(super) is_body: bool,
}

/// What a word is used as.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Keyword,
    Unit,
    /// The symbol with this number is declared here.
    Declared(usize),
    /// A value is meant.
    Value,
    /// A function is called.
    Called,
    /// A part is used.
    Part,
    /// A component, a method or a member of a part: the words of the chain before it, the first one first, if it
    /// is one.
    Member(Vec<usize>),
}

#[derive(Clone, Debug)]
pub(super) struct Word {
    pub(super) span: Range<usize>,
    pub(super) role: Role,
    pub(super) scope: usize,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Outline {
    pub(super) symbols: Vec<Symbol>,
    pub(super) scopes: Vec<Scope>,
    pub(super) words: Vec<Word>,
    /// The paths of imports, quotation marks included.
    pub(super) paths: Vec<Range<usize>>,
    pub(super) is_mechanism: bool,
}

impl Outline {
    pub(super) fn of(text: &str) -> Self {
        let sources = Sources::new("", text);
        let tokens = sources.tokens().0;
        let whole = Scope { parent: 0, span: 0..text.len(), is_body: false };
        let outline = Outline { scopes: vec![whole], ..Outline::default() };
        // `1000 kg`: how many of the coherent unit it is.
        let coherent = |form: String| form.rsplit(' ').next().unwrap_or_default().to_string();
        let units = Sources::words().into_iter().filter(|(kind, ..)| *kind == "unit");
        let units = units.map(|(_, name, form)| (name, coherent(form))).collect();
        Reader::new(text, tokens, units, outline).read()
    }

    /// The word at an offset, or just before it.
    pub(super) fn word_at(&self, offset: usize) -> Option<usize> {
        let behind = self.words.partition_point(|word| word.span.start <= offset);
        behind.checked_sub(1).filter(|&i| self.words[i].span.end >= offset)
    }

    /// The innermost block around an offset.
    pub(super) fn scope_at(&self, offset: usize) -> usize {
        let around = |(_, scope): &(usize, &Scope)| scope.span.start <= offset && offset <= scope.span.end;
        self.scopes.iter().enumerate().filter(around).map(|(i, _)| i).next_back().unwrap_or(0)
    }
}
