use super::*;
use crate::parse;
use crate::source::Unreadable;

/// The texts of some files as `name: text`, the first of them the mechanism's.
fn gathered(files: &[(&str, &str)]) -> Sources {
    let text = |name: &str| files.iter().find(|(other, _)| *other == name).map(|(_, text)| text.as_bytes().to_vec());
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
fn what_is_imported_is_put_in_place() {
    let files = [
        ("m.mbs", "// a\nimport \"a.mbs\"; import \"t.csv\";\n\n/// d\nmechanism M {\n    coord x: m;\n}\n"),
        ("a.mbs", "//! a\n/// Two.\nconst a[2]: m = [1, 2];\nfn f(x) = a[0]*x;"),
        ("t.csv", "b [kg]\n3\n"),
    ];
    let declared = "    /// Two.\n    const a[2]: m = [1, 2];\n    fn f(x) = a[0]*x;\n    const b[1]: kg = [3];\n";
    let whole = in_one_text(&gathered(&files)).unwrap();
    assert_eq!(whole, format!("// a\n/// d\nmechanism M {{\n{declared}    coord x: m;\n}}\n"));
    assert_eq!(in_one_text(&gathered(&[("m.mbs", &whole)])).unwrap(), whole);
}

/// A file does not see the mechanism's functions, but in one text it would.
#[test]
fn imported_files_keep_the_built_in_functions() {
    let own = "import \"a.mbs\"; mechanism M { coord x: m; fn spring(k, l, r) = k*(l - r)^2; }";
    let check = |imported: &str, expected: &[&str]| {
        let sources = gathered(&[("m.mbs", own), ("a.mbs", imported)]);
        assert_eq!(messages(in_one_text(&sources), &sources), expected, "{imported}");
    };
    let message = "m.mbs: spring: an imported file calls the built-in `spring`: in one text it would call this one; \
                   choose another name";
    check("fn energy(k, x) = 2*spring(k, x, 0);", &[message]);
    check("part p(k, x) { for i in 0..2 { potential += spring(k, x, i); } }", &[message]);
    check(
        "/// As spring(k, x, 0).\nfn energy(k, spring) = k.spring(spring) + spring; part spring(k) { let a = k; }",
        &[],
    );
}

/// `//!` is about the file, `///` about what follows it.
#[test]
fn the_first_statement_of_a_shared_file_has_its_documentation() {
    for text in [
        "/// Two.\nconst a: m = 2;",
        "//! f\n/// Two.\nconst a: m = 2;",
        "import \"b.mbs\";\n/// Two.\nconst a: m = 2;",
    ] {
        let files =
            [("m.mbs", "import \"a.mbs\"; mechanism M { coord x: m; }"), ("a.mbs", text), ("b.mbs", "fn g(x) = x;")];
        let whole = in_one_text(&gathered(&files)).unwrap();
        assert!(whole.contains("/// Two.\n    const a: m = 2;") && !whole.contains("/// f"), "{text}\n{whole}");
    }
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
    check("import \"o.mbs\";", &["m.mbs: import \"o.mbs\": cannot import `o.mbs`: there is no such file; look for it"]);
    let mechanism_help = "move the `const` and `fn` that both need to a file without a mechanism, and import that";
    let no_mechanism = format!("m.mbs: import \"n.mbs\": cannot import `n.mbs`: it is a mechanism; {mechanism_help}");
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
    for other in ["", "// nothing", "mechanism A { }", "const a = 1; mechanism A { }", "import \"b\"; mechanism A {}"] {
        assert!(!is_shared(other), "{other}");
    }
    assert!(!is_shared("param m: kg = 1;"));
    let sources = Sources::new("a", "const a = 2 x;");
    let found = messages(parse::shared(&sources).unwrap(), &sources);
    assert_eq!(found, ["a: x: an operator is missing before `x`; write `*` for a product; `x` is not a unit"]);
}
