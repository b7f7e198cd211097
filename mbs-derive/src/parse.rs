//! Pass 1: text → `Declaration`.
//!
//! `declaration` is the entry point. It reads every statement even after a mistake, so that one run reports all of
//! them. In reading order:
//!
//! - `syntax`: the declaration as it was written, what the next pass is given;
//! - `import`: the files that are imported, and all files together; `csv`: tables among them; `robot`:
//!   robots; `shift`: their places;
//! - `encoding`: bytes → text;
//! - `lexer`: text → tokens, with comments, brackets and characters checked; `lookalike`: characters that were meant as
//!   others;
//! - `grammar`: the file, and where statements begin and end; `statement`: what each says;
//! - `contextual`: statements that begin with a word that may be a name, too;
//! - `quantity`: what a declaration declares: names, units, values;
//! - `expression`: operators, calls, arrays; `number`: numbers; `in_place`: numbers with units; `condition`: `if` and
//!   `else`, comparisons; `misplaced`: what stands where no value does;
//! - `reader`: tokens and refusals, what all of these are written with;
//! - `keyword`: the words that cannot be names;
//! - `display`: the declaration as text again; `format`: a file in one style.

mod condition;
mod contextual;
mod csv;
mod display;
mod encoding;
mod expression;
mod format;
mod freeze;
mod grammar;
mod import;
mod in_place;
mod keyword;
mod lexer;
mod lookalike;
mod misplaced;
mod number;
mod quantity;
mod reader;
mod robot;
mod shift;
mod statement;
pub(crate) mod syntax;

use std::ops::Range;

use crate::diagnostic::Diagnostics;
use crate::source::{Sources, Unreadable};
pub use encoding::text;
#[cfg(test)]
pub(crate) use in_place::UNITS;
use syntax::Declaration;
pub use syntax::{Statement, StatementKind};

/// Delimiters, signs, powers and components may be nested this deep, all together.
///
/// What comes after the parser may recurse over a declaration: only the left operands of `+ - * /` run deeper, and
/// [`Expression::left_spine`](syntax::Expression::left_spine) walks them without recursion.
pub(crate) const MAX_DEPTH: usize = 256;

/// Names, numbers and signs that the files of a mechanism may have together: the memory that a declaration takes goes
/// with them, some hundred bytes each.
pub(crate) const MAX_TOKENS: usize = 1_000_000;

/// Reads the text of one `.mbs` file that imports nothing.
///
/// # Errors
/// Everything in the text that is not the model language, in source order.
pub(crate) fn declaration(source: &str) -> Result<Declaration, Diagnostics> {
    declaration_of(&Sources::new("", source))
}

/// Reads the file of a mechanism with all that it imports.
///
/// # Errors
/// Everything in the texts that is not the model language, in order of the files; files that cannot be imported.
pub fn declaration_of(sources: &Sources) -> Result<Declaration, Diagnostics> {
    import::declaration(sources)
}

/// Reads a file of constants and functions to be imported; `None` if it is not meant as one, but as a mechanism.
pub(crate) fn shared(sources: &Sources) -> Option<Result<Vec<Statement>, Diagnostics>> {
    import::shared(sources)
}

impl Sources {
    /// A text, and what it imports, directly or not: `read` is given the name of each file once and answers its bytes.
    /// Of robots, such as `robot.urdf`, the texts of their mechanisms are kept.
    pub fn gather(name: &str, text: &str, mut read: impl FnMut(&str) -> Result<Vec<u8>, Unreadable>) -> Self {
        Sources::followed(name, text, imports, |file| read(file).and_then(|bytes| robot::as_text(file, bytes)))
    }

    /// The text of the first file in the one style that files are written in; comments stay.
    ///
    /// ```
    /// # use mbs_derive::source::Sources;
    /// let text = "mechanism A { coord x:m; // along the rail\nkinetic+=dt(x)^2*1kg/2; }";
    /// let formatted = Sources::new("a.mbs", text).formatted().unwrap();
    /// assert_eq!(
    ///     formatted,
    ///     "mechanism A {\n    coord x: m; // along the rail\n    kinetic += dt(x)^2*1kg/2;\n}\n"
    /// );
    /// ```
    ///
    /// # Errors
    /// What in it is not the model language; what it imports and what its names mean is not looked at.
    pub fn formatted(&self) -> Result<String, Diagnostics> {
        format::formatted(self.main().text.as_deref().unwrap_or_default())
    }

    /// Where the names, numbers, signs and documentation comments of the first file stand, as far as it can be cut into
    /// these, and what of it cannot.
    pub fn tokens(&self) -> (Vec<Range<usize>>, Diagnostics) {
        let (tokens, errors) = lexer::cut(self.main().text.as_deref().unwrap_or_default());
        (tokens.into_iter().map(lexer::Token::span).collect(), errors)
    }
}

/// The text of a mechanism with what it imports put in place, before its own statements: one that needs no other.
pub(crate) fn in_one_text(sources: &Sources) -> Result<String, Diagnostics> {
    import::in_one_text(sources)
}

/// What can be read of a text with all that it imports, and whether that is a mechanism; what is wrong with it.
pub(crate) fn readable(sources: &Sources) -> (Option<Declaration>, bool, Diagnostics) {
    import::readable(sources)
}

/// The keywords, and the names that every mechanism knows: kind, word, what it is.
pub(crate) fn words() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    keyword::words()
}

/// The paths that a text imports, as they are written; what is wrong with other imports [`declaration_of`] will say.
pub(crate) fn imports(source: &str) -> Vec<String> {
    import::paths(source)
}

/// What the tests of this pass ask with.
#[cfg(test)]
mod check {
    use super::declaration;
    use super::syntax::{BinaryOperator, Comparison, Expression, ExpressionKind, Statement, StatementKind};

    /// The statements between the braces of a mechanism.
    fn statements(body: &str) -> Vec<Statement> {
        let source = format!("mechanism A {{ {body} }}");
        match declaration(&source) {
            Ok(declaration) => declaration.statements.clone(),
            Err(errors) => panic!("{}", errors.render("test", &source)),
        }
    }

    pub(super) fn statement(text: &str) -> StatementKind {
        let mut statements = statements(text);
        assert_eq!(statements.len(), 1, "{text}");
        statements.remove(0).kind
    }

    /// With the operator before its operands, as in `(+ a (* b c))`.
    pub(super) fn prefix(expression: &Expression) -> String {
        let all = |values: &[Expression]| values.iter().map(prefix).collect::<Vec<_>>().join(" ");
        match &expression.kind {
            ExpressionKind::Number(text) | ExpressionKind::Name(text) => text.clone(),
            ExpressionKind::Quantity(number, unit) => format!("{number}{{{unit}}}"),
            ExpressionKind::Negate(value) => format!("(neg {})", prefix(value)),
            ExpressionKind::Binary(operator, left, right) => {
                let sign = match operator {
                    BinaryOperator::Add => "+",
                    BinaryOperator::Sub => "-",
                    BinaryOperator::Mul => "*",
                    BinaryOperator::Div => "/",
                    BinaryOperator::Pow => "^",
                };
                format!("({sign} {} {})", prefix(left), prefix(right))
            }
            ExpressionKind::Call(name, values) => format!("{}({})", name.text, all(values)),
            ExpressionKind::Method(value, name, values) => format!("{}.{}({})", prefix(value), name.text, all(values)),
            ExpressionKind::Field(value, name) => format!("{}.{}", prefix(value), name.text),
            ExpressionKind::Index(value, index) => format!("{}[{}]", prefix(value), prefix(index)),
            ExpressionKind::Array(values) => format!("[{}]", all(values)),
            ExpressionKind::If(condition, yes, no) => {
                format!("(if {} {} {})", prefix(condition), prefix(yes), prefix(no))
            }
            ExpressionKind::Compare(comparison, left, right) => {
                let sign = match comparison {
                    Comparison::Less => "<",
                    Comparison::LessEqual => "<=",
                    Comparison::Greater => ">",
                    Comparison::GreaterEqual => ">=",
                    Comparison::Equal => "==",
                    Comparison::NotEqual => "!=",
                };
                format!("({sign} {} {})", prefix(left), prefix(right))
            }
            ExpressionKind::And(left, right) => format!("(and {} {})", prefix(left), prefix(right)),
            ExpressionKind::Or(left, right) => format!("(or {} {})", prefix(left), prefix(right)),
            ExpressionKind::Not(value) => format!("(not {})", prefix(value)),
        }
    }

    /// Every message with the text that it points at: `text: message; help`.
    pub(super) fn report(source: &str) -> Vec<String> {
        let errors = declaration(source).err().unwrap_or_default();
        let line = |m: &crate::diagnostic::Diagnostic| {
            format!("{}: {}; {}", &source[m.span.clone()], m.message, m.help.as_deref().unwrap_or("no help"))
        };
        errors.iter().map(line).collect()
    }

    /// The one error in the statements `body`.
    #[track_caller]
    pub(super) fn refused(body: &str, expected: &str) {
        assert_eq!(report(&format!("mechanism A {{\n{body}\n}}")), [expected], "{body}");
    }
}
