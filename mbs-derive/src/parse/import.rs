//! `import "file.mbs";`: the statement, files of shared constants and functions, and how a mechanism is put together.
//!
//! ```text
//! import := "import" "\"" path "\"" ";"
//! shared := ("//!" doc | import)* (doc* (const | fn) ";")*
//! ```
//!
//! A file whose name ends with `.csv` is a table, whose columns are constants; one that ends with `.urdf`, `.sdf` or
//! `.xml` is a robot, whose statements are the mechanism's. A file counts once, wherever it is
//! imported, and what it imports comes before what it declares.

use std::vec;

use super::grammar::{self, File};
use super::reader::{Parsed, Reader, Refused};
use super::syntax::{Declaration, Import, Name, Span, Statement, StatementKind};
use super::{MAX_TOKENS, csv, lexer};
use crate::diagnostic::{Code, Diagnostics};
use crate::source::{Sources, is_robot, is_table};

// ---- the statement

/// The paths that a text imports, as far as it can be read: what [`Reader::import`] accepts at the top of a file, and
/// more.
pub(crate) fn paths(text: &str) -> Vec<String> {
    let mut paths = Vec::new();
    let mut rest = behind_comments(text.strip_prefix('\u{feff}').unwrap_or(text));
    loop {
        if let Some(attribute) = rest.strip_prefix('#') {
            let end = attribute.find(']').map_or(attribute.len(), |end| end + 1);
            rest = behind_comments(&attribute[end..]);
            continue;
        }
        let Some(behind) = rest.strip_prefix("import").map(behind_comments) else { return paths };
        rest = match behind.strip_prefix('"').and_then(|path| path.split_once('"')) {
            Some((path, behind)) => {
                paths.extend(problem(path).is_none().then(|| path.to_string()));
                let behind = behind_comments(behind);
                behind_comments(behind.strip_prefix(';').unwrap_or(behind))
            }
            // What is wrong with it the grammar will say; others may follow.
            None => behind_comments(behind.split_once([';', '\n']).map_or("", |(_, rest)| rest)),
        }
    }
}

/// The text behind comments and white space.
fn behind_comments(text: &str) -> &str {
    let mut rest = text.trim_start_matches(lexer::is_space);
    loop {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            lexer::block_comment_length(rest.as_bytes()).unwrap_or(rest.len())
        } else {
            return rest;
        };
        rest = rest[length..].trim_start_matches(lexer::is_space);
    }
}

/// What is wrong with a path, and what to write.
fn problem(path: &str) -> Option<(&'static str, &'static str)> {
    if path.is_empty() {
        Some(("this path is empty", FORM))
    } else if path.starts_with('/') || std::path::Path::new(path).is_absolute() {
        let help = "write where it is from the folder of this file, `../` for the folder above";
        Some(("an import is not an absolute path", help))
    } else {
        None
    }
}

const FORM: &str = "write `import \"file.mbs\";`";

impl Reader<'_> {
    /// `import := "import" "\"" path "\"" ";"`, noted in `imports`.
    pub(super) fn import(&mut self) -> Parsed<()> {
        let start = self.next().start;
        self.eat_word("import");
        let here = self.next();
        let Some(path) = self.path() else {
            return Err(self.unexpected("a path in quotation marks", FORM));
        };
        match problem(path) {
            Some((message, help)) => {
                self.errors.error(Code::ImportPath, here, message).help(help);
            }
            None => self.imports.push(Import { path: path.to_string(), span: start..self.last }),
        }
        if self.eat(";").is_none() {
            self.errors
                .error(Code::MissingSemicolon, self.last..self.last, "a `;` is missing")
                .help("end the import with `;`");
        }
        Ok(())
    }

    /// Goes to the next line, or behind the `;`.
    pub(super) fn behind_import(&mut self) {
        while !self.is_at_end() && !self.begins_line() && !self.skip() {}
    }

    pub(super) fn late_import(&mut self, here: Span) -> Refused {
        self.refuse(
            Code::ImportTooLate,
            here,
            "imports stand at the top of a file",
            "move it there, before all that is declared",
        )
    }
}

// ---- files of shared declarations

/// What a file that is no mechanism may hold, as it was read.
pub(super) enum Shared {
    /// It is a mechanism.
    Mechanism,
    /// Its constants and functions.
    Declarations(Vec<Statement>),
}

impl Reader<'_> {
    /// `shared := ("//!" doc | import)* (doc* ((const | fn) ";" | part))*`
    pub(super) fn shared(&mut self) -> Parsed<Shared> {
        if self.top_level().any(|word| word == "mechanism") {
            while !self.is_at_end() {
                self.skip();
            }
            return Ok(Shared::Mechanism);
        }
        let head = self.head();
        if let Some(attribute) = head.dimensionless {
            let error = self.errors.error(Code::Attribute, attribute, "this attribute belongs to a mechanism");
            error.help("leave it out: the mechanism that imports this file decides");
        }
        self.begin_at(head.of_statement);
        let statements = self.statements();
        for statement in &statements {
            if !matches!(
                statement.kind,
                StatementKind::Const(_) | StatementKind::Function { .. } | StatementKind::Part { .. }
            ) {
                let text = &self.source[statement.span.clone()];
                let keyword: String = text.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
                let message = format!("`{keyword}` stands in a file without a mechanism");
                let help = "files that are imported hold `const`, `fn` and `part` only: move it to the mechanism";
                self.errors.error(Code::ImportOfAMechanism, statement.span.clone(), message).help(help);
            }
        }
        Ok(Shared::Declarations(statements))
    }
}

impl<'s> Reader<'s> {
    /// The words that stand within no bracket.
    fn top_level(&self) -> impl Iterator<Item = &'s str> {
        let mut at = 0;
        std::iter::from_fn(move || {
            while at < self.tokens.len() {
                let word = self.word_at(at);
                at = self.behind(at);
                if word.is_some() {
                    return word;
                }
            }
            None
        })
    }

    /// Whether a file declares no mechanism, but something to be shared by them: its first word, imports aside, is
    /// `const`, `fn` or `part`, or it imports and no more.
    fn begins_as_shared(&self) -> bool {
        let mut words = self.top_level().peekable();
        let begins = words.peek().is_some_and(|first| ["import", "const", "fn", "part"].contains(first));
        begins && !words.any(|word| word == "mechanism")
    }
}

/// Whether a text can be cut into tokens and is meant to be imported.
pub(super) fn begins_as_shared(source: &str) -> bool {
    grammar::asked(source, Reader::begins_as_shared).unwrap_or(false)
}

// ---- all files together

/// The mechanism with all that it imports.
///
/// # Errors
/// All mistakes of all files, in the order of the files.
pub(super) fn declaration(sources: &Sources) -> Result<Declaration, Diagnostics> {
    let text = sources.main().text.as_deref().unwrap_or_default();
    let File { imports, content, tokens, errors } = grammar::mechanism(text);
    let (imported, mut statements, errors) = Walk::new(sources, State::Mechanism, tokens, errors).all(imports.clone());
    match content {
        Some(mut declaration) => {
            let of_robots = statements.len();
            statements.append(&mut declaration.statements);
            let warnings = errors.clone();
            errors.finish(Declaration { imports, imported, statements, of_robots, warnings, ..declaration })
        }
        None => Err(errors),
    }
}

/// The shared declarations of a file that is no mechanism, and of what it imports; `None` if it was not meant as one.
pub(super) fn shared(sources: &Sources) -> Option<Result<Vec<Statement>, Diagnostics>> {
    let text = sources.main().text.as_deref().unwrap_or_default();
    if !grammar::asked(text, Reader::begins_as_shared)? {
        return None;
    }
    let File { imports, content, tokens, errors } = grammar::shared(text);
    let (mut statements, _, errors) = Walk::new(sources, State::Open, tokens, errors).all(imports);
    if let Some(Shared::Declarations(own)) = content {
        statements.extend(own);
    }
    Some(errors.finish(statements))
}

/// The text of a mechanism with the statements of all that it imports put in place, before its own.
///
/// # Errors
/// Also a function of the mechanism that has the name of a built-in one which imported files call.
pub(super) fn in_one_text(sources: &Sources) -> Result<String, Diagnostics> {
    let text = sources.main().text.as_deref().unwrap_or_default();
    let Declaration { imports, imported, name, statements, of_robots, .. } = declaration(sources)?;
    let mut errors = Diagnostics::default();
    for name in statements.iter().filter_map(function_name).filter(|name| imported.iter().any(|s| calls(s, name))) {
        let message =
            format!("an imported file calls the built-in `{}`: in one text it would call this one", name.text);
        errors.error(Code::NameClash, name.span.clone(), message).help("choose another name");
    }
    errors.finish(())?;
    let (tokens, _) = sources.tokens();
    let behind_next = |at: usize| tokens.iter().find(|token| token.start >= at).map_or(at, |token| token.end);
    let (mut whole, mut from) = (String::new(), 0);
    for import in imports {
        whole += &text[from..import.span.start];
        let rest = &text[behind_next(import.span.end)..];
        from = text.len() - rest.trim_start().len();
    }
    let brace = behind_next(name.span.end);
    whole += &text[from..brace];
    for statement in imported.iter().chain(&statements[..of_robots]) {
        statement.to_string().lines().for_each(|line| whole += &format!("\n    {line}"));
    }
    Ok(whole + &text[brace..])
}

fn function_name(statement: &Statement) -> Option<&Name> {
    let StatementKind::Function { name, .. } = &statement.kind else { return None };
    Some(name)
}

/// Whether a statement that does not declare the function calls it.
fn calls(statement: &Statement, function: &Name) -> bool {
    let text = statement.to_string();
    let (tokens, _) = lexer::cut(&text);
    let text = |token: &lexer::Token| &text[token.span()];
    tokens
        .windows(3)
        .any(|w| text(&w[1]) == function.text && text(&w[2]) == "(" && ![".", "part"].contains(&text(&w[0])))
}

/// What can be read of a mechanism, or else of a file to be imported as a mechanism that has nothing of its own;
/// whether it is a mechanism; what is wrong with it.
pub(super) fn readable(sources: &Sources) -> (Option<Declaration>, bool, Diagnostics) {
    let text = sources.main().text.as_deref().unwrap_or_default();
    if !begins_as_shared(text) {
        let File { imports, content, tokens, errors } = grammar::mechanism(text);
        let (imported, mut statements, errors) =
            Walk::new(sources, State::Mechanism, tokens, errors).all(imports.clone());
        let whole = |declaration: Declaration| {
            let of_robots = statements.len();
            statements.extend(declaration.statements);
            Declaration { imports, imported, statements, of_robots, ..declaration }
        };
        return (content.map(whole), true, errors);
    }
    let File { imports, content, tokens, errors } = grammar::shared(text);
    let (mut imported, _, errors) = Walk::new(sources, State::Open, tokens, errors).all(imports.clone());
    if let Some(Shared::Declarations(own)) = content {
        imported.extend(own);
    }
    let name = Name { text: "Shared".to_string(), span: 0..0 };
    let (docs, statements) = (Vec::new(), Vec::new());
    let warnings = Diagnostics::default();
    let shared =
        Declaration { dimensionless: false, imports, imported, name, docs, statements, of_robots: 0, warnings };
    (Some(shared), false, errors)
}

/// How far a file has got.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Unread,
    /// It, or something that it imports, is being read.
    Open,
    Mechanism,
    Done,
}

/// From file to file along imports, depth first, without recursion.
struct Walk<'s> {
    sources: &'s Sources,
    states: Vec<State>,
    statements: Vec<Statement>,
    /// Of robots that the mechanism imports.
    of_robots: Vec<Statement>,
    /// In all files that were read.
    tokens: usize,
    errors: Diagnostics,
}

/// A file whose imports are being followed.
struct Open {
    file: usize,
    imports: vec::IntoIter<Import>,
    statements: Vec<Statement>,
}

impl<'s> Walk<'s> {
    /// `first` is what the first file is, `tokens` how many it has, `errors` are its errors.
    fn new(sources: &'s Sources, first: State, tokens: usize, errors: Diagnostics) -> Self {
        let mut states = vec![State::Unread; sources.count()];
        states[0] = first;
        Walk { sources, states, statements: Vec::new(), of_robots: Vec::new(), tokens, errors }
    }

    /// What the first file imports, in an order in which names are known before they are used: of shared files, of
    /// robots.
    fn all(mut self, imports: Vec<Import>) -> (Vec<Statement>, Vec<Statement>, Diagnostics) {
        let mut path = vec![Open { file: 0, imports: imports.into_iter(), statements: Vec::new() }];
        while let Some(open) = path.last_mut() {
            let from = open.file;
            match open.imports.next() {
                Some(import) => {
                    let next = self.follow(&path, from, &import);
                    path.extend(next);
                }
                None => {
                    self.states[from] = State::Done;
                    self.statements.append(&mut open.statements);
                    path.pop();
                }
            }
        }
        (self.statements, self.of_robots, self.errors)
    }

    fn follow(&mut self, path: &[Open], from: usize, import: &Import) -> Option<Open> {
        let Some(file) = self.sources.imported(from, &import.path) else {
            let help = "files are read by `mbs`, by `mbs_derive::compile`, and by `Sources::gather`";
            self.refuse(Code::ImportUnreadable, import, "this text was read without its files", help);
            return None;
        };
        match self.states[file] {
            State::Unread if is_robot(&self.sources.file(file).name) => {
                self.robot(file, from, import);
                None
            }
            State::Unread => self.open(file, import),
            State::Open => {
                self.circle(path, file, import);
                None
            }
            State::Mechanism => {
                self.no_mechanism(import);
                None
            }
            State::Done => None,
        }
    }

    fn open(&mut self, number: usize, import: &Import) -> Option<Open> {
        let file = self.sources.file(number);
        let text = match &file.text {
            Ok(text) => text,
            Err(unreadable) => {
                self.refuse(Code::ImportUnreadable, import, &unreadable.reason, &unreadable.help);
                return None;
            }
        };
        let mut read = if is_table(&file.name) { csv::read(text) } else { grammar::shared(text) };
        self.tokens += read.tokens;
        if self.tokens > MAX_TOKENS {
            self.states[number] = State::Done;
            let reason = format!("with it the mechanism is longer than {MAX_TOKENS} names, numbers and signs");
            self.refuse(Code::TooLong, import, &reason, "import constants and functions, not data");
            return None;
        }
        read.shift(file.start);
        match read.content {
            Some(Shared::Mechanism) => {
                self.states[number] = State::Mechanism;
                self.no_mechanism(import);
                None
            }
            content => {
                self.states[number] = State::Open;
                self.errors.append(read.errors);
                let statements = match content {
                    Some(Shared::Declarations(statements)) => statements,
                    Some(Shared::Mechanism) | None => Vec::new(),
                };
                Some(Open { file: number, imports: read.imports.into_iter(), statements })
            }
        }
    }

    /// The statements of a robot are the mechanism's own.
    fn robot(&mut self, number: usize, from: usize, import: &Import) {
        let file = self.sources.file(number);
        self.states[number] = State::Done;
        let text = match &file.text {
            Ok(text) => text,
            Err(unreadable) => {
                return self.refuse(Code::ImportUnreadable, import, &unreadable.reason, &unreadable.help);
            }
        };
        if self.states[from] != State::Mechanism {
            let help = "import it in the file of a mechanism: its coordinates are the mechanism's";
            return self.refuse(
                Code::ImportOfAMechanism,
                import,
                "it is a robot, this is a file of shared declarations",
                help,
            );
        }
        for warning in &file.warnings {
            let found = self.errors.warning(Code::Data, import.span.clone(), &warning.message);
            if !warning.help.is_empty() {
                found.help(&warning.help);
            }
        }
        let mut read = grammar::mechanism(text);
        self.tokens += read.tokens;
        if self.tokens > MAX_TOKENS {
            let reason = format!("with it the mechanism is longer than {MAX_TOKENS} names, numbers and signs");
            return self.refuse(Code::TooLong, import, &reason, "import a smaller robot");
        }
        read.shift(file.start);
        self.errors.append(read.errors);
        self.of_robots.extend(read.content.into_iter().flat_map(|declaration| declaration.statements));
    }

    fn refuse(&mut self, code: Code, import: &Import, reason: &str, help: &str) {
        self.errors.error(code, import.span.clone(), format!("cannot import `{}`: {reason}", import.path)).help(help);
    }

    fn no_mechanism(&mut self, import: &Import) {
        let help = "move the `const` and `fn` that both need to a file without a mechanism, and import that";
        self.refuse(Code::ImportOfAMechanism, import, "it is a mechanism", help);
    }

    /// The file is being read already.
    fn circle(&mut self, path: &[Open], file: usize, import: &Import) {
        let begin = path.iter().position(|open| open.file == file).unwrap_or(0);
        let circle = path[begin..].iter().map(|open| open.file).chain([file]);
        let names: Vec<&str> = circle.map(|file| self.sources.file(file).name.as_str()).collect();
        let reason = format!("the files import each other: {}", names.join(" → "));
        self.refuse(Code::ImportCycle, import, &reason, "move what both need to a third file, and import that in both");
    }
}

#[cfg(test)]
mod tests;
