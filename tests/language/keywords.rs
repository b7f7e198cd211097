//! Keywords of Rust as names: escaped where users of the generated code write them, as declared everywhere else.

use mbs_derive::emit::Options;
use mbs_tests::mechanisms::loop_::{Params, coordinate, input, r#loop as Loop};

/// Strict and reserved keywords of all editions, those that are keywords of the language left out.
const KEYWORDS: [&str; 44] = [
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "continue", "crate", "do", "dyn", "enum",
    "extern", "false", "final", "gen", "impl", "loop", "macro", "match", "mod", "move", "override", "priv", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof", "unsafe",
    "unsized", "use", "virtual", "where", "while", "yield",
];

/// Compiled as it stands in `mechanisms/keywords.mbs`.
#[test]
fn names_are_escaped_in_code() {
    let params = Params::<f64> { r#type: 1.5, r#box: 2.5, self__2: 3.5, Self_: 4.5, ..Params::default() };
    assert_eq!(params.self_, 12.0, "declared under this very name");
    assert_eq!((params.r#true, params.r#gen, params.crate_), ([13.0, 14.0], 7.0, 6.0));
    let mechanism = Loop::new(params);
    assert_eq!((coordinate::MATCH, coordinate::MOVE, input::AS), (0, 1..3, 2..4));
    let (s, q, qd) = ([[0.0; 3]], [0.5, 0.2, -0.3, 0.7, 0.7], [0.1, 0.4, 0.6, 0.0, 0.0]);
    assert_eq!(mechanism.r#mod(&s, &q), [13.0 * 0.2, 14.0 * -0.3]);
    assert_eq!(mechanism.mod_velocity(&s, &q, &qd), [13.0 * 0.4, 14.0 * 0.6]);
    assert_eq!(mechanism.r#return(&s, &q), 0.5 * 1.5);
    assert_eq!(mechanism.r#type(&s, &q, &qd), 0.1);
    assert_eq!(mechanism.self_(&s, &q), mechanism.r#yield(&s, &q).position);
}

#[test]
fn names_are_as_declared_in_json() {
    let source = include_str!("../mechanisms/keywords.mbs");
    let options = Options::default().serde(true);
    let code = mbs_derive::generate("keywords.mbs", source, &options).expect("as compiled").code;
    for (name, field) in [("type", "r#type"), ("self", "self__2"), ("Self", "Self_"), ("gen", "r#gen")] {
        let renamed = code.lines().skip_while(|line| line.trim() != format!("#[serde(rename = \"{name}\")]")).nth(1);
        assert_eq!(renamed.map(str::trim), Some(format!("pub {field}: T,").as_str()), "{name}");
    }
}

/// Each as everything that it may name, so that no word is forgotten.
#[test]
fn every_keyword_is_a_name() {
    for word in KEYWORDS {
        let source = format!(
            "mechanism {word} {{ param {word}: kg = 1; coord x: m; kinetic += 1/2*{word}*dt(x)^2;
             for i in 0..2 {{ let {word} = i; let a = {word}; }} output {word}_ = x; }}"
        );
        let generated = mbs_derive::generate("a.mbs", &source, &Options::default());
        let generated = generated.unwrap_or_else(|error| panic!("{}", error.render("a.mbs", &source)));
        let field = match word {
            "self" | "Self" | "super" | "crate" => format!("pub {word}_: T"),
            _ => format!("pub r#{word}: T"),
        };
        assert!(generated.code.contains(&field), "{word}: {}", generated.code);
        for (kind, sort) in [("coord", "m"), ("input", "N"), ("prescribed", "m")] {
            let source = format!(
                "mechanism A {{ coord x: m; {kind} {word}: {sort}; param m: kg = 1; output {word}_velocity = {word};
                 kinetic += 1/2*m*dt(x)^2; {} }}",
                if kind == "coord" { format!("kinetic += m*dt({word})^2;") } else { String::new() }
            );
            let generated = mbs_derive::generate("a.mbs", &source, &Options::default());
            let generated = generated.unwrap_or_else(|error| panic!("{}", error.render("a.mbs", &source)));
            assert!(generated.code.contains(&format!("fn {word}_velocity")), "{word}");
        }
    }
}
