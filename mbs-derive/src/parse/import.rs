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
use super::robot::is_robot;
use super::syntax::{Declaration, Import, Name, Span, Statement, StatementKind};
use super::{MAX_TOKENS, csv, lexer};
use crate::diagnostic::{Code, Diagnostics};
use crate::source::{Sources, is_table};

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
            errors.finish(Declaration { imports, imported, statements, of_robots, ..declaration })
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
    (Some(Declaration { dimensionless: false, imports, imported, name, docs, statements, of_robots: 0 }), false, errors)
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
mod tests {
    use super::*;
    use crate::parse;
    use crate::source::Unreadable;

    /// The texts of some files as `name: text`, the first of them the mechanism's.
    fn gathered(files: &[(&str, &str)]) -> Sources {
        let text =
            |name: &str| files.iter().find(|(other, _)| *other == name).map(|(_, text)| text.as_bytes().to_vec());
        let missing = || Unreadable::new("there is no such file", "look for it");
        Sources::gather(files[0].0, files[0].1, |name| text(name).ok_or_else(missing))
    }

    fn messages(result: Result<impl Sized, Diagnostics>, sources: &Sources) -> Vec<String> {
        let line = |m: &crate::diagnostic::Diagnostic| {
            let (name, text, span) = sources.locate(&m.span);
            format!("{name}: {}: {}; {}", &text[span], m.message, m.help.as_deref().unwrap_or("no help"))
        };
        result.err().unwrap_or_default().iter().map(line).collect()
    }

    fn refused(files: &[(&str, &str)], expected: &[&str]) {
        let sources = gathered(files);
        assert_eq!(messages(parse::declaration_of(&sources), &sources), expected, "{files:?}");
    }

    #[test]
    fn paths_are_found_at_the_top() {
        let check = |text: &str, expected: &[&str]| assert_eq!(paths(text), expected, "{text}");
        check("import \"a\"; import\n\"b\";mechanism A { import \"c\"; }", &["a", "b"]);
        check("\u{feff}// import \"x\";\n/* /* */ */ #![dimensionless]\n/// d\nimport \"a\" // c\n;", &["a"]);
        check("import \"a\"\nimport \"b\"", &["a", "b"]);
        check("import a; import \"/b\"; import \"\"; import \"c\";", &["c"]);
        check("import a\nimport \"b\"; const c = 1; import \"d\";", &["b"]);
        check("import", &[]);
        check("import \"", &[]);
        check("#", &[]);
        check("/* import \"a\"", &[]);
    }

    #[test]
    fn what_a_file_needs_comes_before_its_own() {
        let files = [
            ("m.mbs", "/// d\nimport \"a.mbs\"; import \"x/b.mbs\";\nmechanism M { coord x: m; }"),
            ("a.mbs", "//! a\nimport \"x/b.mbs\"; const a = 1 + b; fn f(x) = [x.y, -x[a]];"),
            ("x/b.mbs", "import \"../c.mbs\"; /// Two.\nconst b[2]: m^2 = if c < 1 { 2 } else { f(3).g(4) };"),
            ("c.mbs", "const c = 0;"),
        ];
        let sources = gathered(&files);
        let declaration = parse::declaration_of(&sources).unwrap();
        let texts = |statements: &[Statement]| -> Vec<String> {
            let text = |s: &Statement| {
                let (name, text, span) = sources.locate(&s.span);
                format!("{name}: {}", &text[span])
            };
            statements.iter().map(text).collect()
        };
        let expected = [
            "c.mbs: const c = 0;",
            "x/b.mbs: const b[2]: m^2 = if c < 1 { 2 } else { f(3).g(4) };",
            "a.mbs: const a = 1 + b;",
            "a.mbs: fn f(x) = [x.y, -x[a]];",
        ];
        assert_eq!(texts(&declaration.imported), expected);
        assert_eq!(declaration.docs, ["d"]);
        assert!(declaration.to_string().starts_with("import \"a.mbs\";\nimport \"x/b.mbs\";\n/// d\n"));
        // Every place has moved with its file.
        let file = sources.file(2);
        let Some(Shared::Declarations(alone)) = grammar::shared(files[2].1).content else { panic!("declarations") };
        let places = |statements: &[Statement]| -> Vec<usize> {
            let text = format!("{statements:?}");
            let spans = text.split("span: ").skip(1).map(|rest| rest.split("..").next().unwrap().parse().unwrap());
            spans.collect()
        };
        let shifted: Vec<usize> = places(&alone).iter().map(|start| start + file.start).collect();
        assert_eq!(shifted, places(&declaration.imported[1..2]));
    }

    /// Each file is short enough by itself.
    #[test]
    fn files_are_limited_together() {
        let table = format!("const a = {}1;", "1+".repeat(MAX_TOKENS / 4));
        let files =
            [("m.mbs", "import \"a.mbs\"; import \"b.mbs\"; mechanism M { }"), ("a.mbs", &table), ("b.mbs", &table)];
        let expected = "m.mbs: import \"b.mbs\": cannot import `b.mbs`: with it the mechanism is longer than 1000000 names, \
                        numbers and signs; import constants and functions, not data";
        refused(&files, &[expected]);
    }

    #[test]
    fn imports_that_cannot_be() {
        let mechanism = |imports: &str| format!("{imports} mechanism M {{ coord x: m; }}");
        let check = |imports: &str, expected: &[&str]| {
            let text = mechanism(imports);
            let files = [
                ("m.mbs", text.as_str()),
                ("n.mbs", "/// d\nconst a = 1; mechanism N { } junk"),
                ("wrong.mbs", "#![dimensionless] param m: kg = 1; const a = 2 x; fn f(x) = x;\nlet b = 1"),
                ("a.mbs", "import \"b.mbs\";"),
                ("b.mbs", "import \"c.mbs\";"),
                ("c.mbs", "import \"b.mbs\";"),
                ("self.mbs", "import \"self.mbs\";"),
                ("late.mbs", "const a = 1; import \"c.mbs\";"),
                ("empty.mbs", ""),
            ];
            refused(&files, expected);
        };
        check("import \"empty.mbs\"; import \"empty.mbs\";", &[]);
        check(
            "import \"o.mbs\";",
            &["m.mbs: import \"o.mbs\": cannot import `o.mbs`: there is no such file; look for it"],
        );
        let mechanism_help = "move the `const` and `fn` that both need to a file without a mechanism, and import that";
        let no_mechanism =
            format!("m.mbs: import \"n.mbs\": cannot import `n.mbs`: it is a mechanism; {mechanism_help}");
        check("import \"n.mbs\"; import \"n.mbs\";", &[&no_mechanism, &no_mechanism]);
        check(
            "import \"x/../m.mbs\";",
            &[&no_mechanism.replace("`n.mbs`", "`x/../m.mbs`").replace("\"n.mbs\"", "\"x/../m.mbs\"")],
        );
        let help = "move what both need to a third file, and import that in both";
        check(
            "import \"a.mbs\";",
            &[&format!(
                "c.mbs: import \"b.mbs\": cannot import `b.mbs`: the files import each other: b.mbs → c.mbs → b.mbs; {help}"
            )],
        );
        check(
            "import \"self.mbs\";",
            &[&format!(
                "self.mbs: import \"self.mbs\": cannot import `self.mbs`: the files import each other: self.mbs → self.mbs; {help}"
            )],
        );
        check(
            "import \"late.mbs\";",
            &["late.mbs: import: imports stand at the top of a file; move it there, before all that is declared"],
        );
        check(
            "import \"wrong.mbs\";",
            &[
                "wrong.mbs: #![dimensionless]: this attribute belongs to a mechanism; \
                 leave it out: the mechanism that imports this file decides",
                "wrong.mbs: param m: kg = 1;: `param` stands in a file without a mechanism; \
                 files that are imported hold `const`, `fn` and `part` only: move it to the mechanism",
                "wrong.mbs: x: an operator is missing before `x`; write `*` for a product; `x` is not a unit",
                "wrong.mbs: let b = 1: `let` stands in a file without a mechanism; \
                 files that are imported hold `const`, `fn` and `part` only: move it to the mechanism",
                "wrong.mbs: : a `;` is missing; end the statement with `;`",
            ],
        );
    }

    #[test]
    fn a_text_alone_imports_nothing() {
        let sources = Sources::new("m.mbs", "import \"a.mbs\"; mechanism M { }");
        let expected = "m.mbs: import \"a.mbs\": cannot import `a.mbs`: this text was read without its files; \
                        files are read by `mbs`, by `mbs_derive::compile`, and by `Sources::gather`";
        assert_eq!(messages(parse::declaration_of(&sources), &sources), [expected]);
    }

    #[test]
    fn wrong_forms() {
        let form = "write `import \"file.mbs\";`";
        let check = |text: &str, expected: &str| refused(&[("m", text), ("a", "")], &[expected]);
        check("import a; mechanism M { }", &format!("m: a: expected a path in quotation marks, found `a`; {form}"));
        check("import; mechanism M { }", &format!("m: ;: expected a path in quotation marks, found `;`; {form}"));
        check("import \"\"; mechanism M { }", &format!("m: \"\": this path is empty; {form}"));
        let kg = "m: kg: expected `mechanism`, found `kg`; write `mechanism Name { … }`";
        let end = "m: : a `;` is missing; end the import with `;`";
        refused(&[("m", "import \"a\"kg; mechanism M { }"), ("a", "")], &[end, kg]);
        check("import \"a\" mechanism M { }", "m: : a `;` is missing; end the import with `;`");
        check("import \"a\"\nmechanism M { }", "m: : a `;` is missing; end the import with `;`");
        check(
            "import \"/a\"; mechanism M { }",
            "m: \"/a\": an import is not an absolute path; \
             write where it is from the folder of this file, `../` for the folder above",
        );
        check("import \"x\\a\"; mechanism M { }", "m: \\: this cannot stand in a path; write `/` between folders");
        check("import \"x\ta\"; mechanism M { }", "m: \t: this cannot stand in a path; leave it out");
        check("import \"a; mechanism M { }", "m: \": this quotation mark is never closed; write `\"` behind the path");
        let late = "imports stand at the top of a file; move it there, before all that is declared";
        check("mechanism M { import \"a\"; coord x: m; }", &format!("m: import: {late}"));
        check("mechanism M { } import \"a\";", &format!("m: import: {late}"));
        check(
            "mechanism M { let x = import; }",
            "m: import: `import` is a keyword of the language, not a value; names of your own are others, such as `import_`",
        );
    }

    #[test]
    fn files_to_be_shared_are_told_from_mechanisms() {
        let is_shared = |text: &str| parse::shared(&Sources::new("a", text)).is_some();
        for shared in ["const a = 1;", "//! d\n/// d\nfn f(x) = x;", "import \"b\";", "const", "fn f() = 1; param x;"] {
            assert!(is_shared(shared), "{shared}");
        }
        assert!(!is_shared("fn f( = 1;"), "what cannot be cut into tokens is reported as a mechanism");
        for other in
            ["", "// nothing", "mechanism A { }", "const a = 1; mechanism A { }", "import \"b\"; mechanism A {}"]
        {
            assert!(!is_shared(other), "{other}");
        }
        assert!(!is_shared("param m: kg = 1;"));
        let sources = Sources::new("a", "const a = 2 x;");
        let found = messages(parse::shared(&sources).unwrap(), &sources);
        assert_eq!(found, ["a: x: an operator is missing before `x`; write `*` for a product; `x` is not a unit"]);
    }
}
