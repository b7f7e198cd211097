//! The style of files: nothing but white space changes, what is formatted stays as it is, and the models of the
//! repository are in the style.

use std::path::{Path, PathBuf};

use mbs_derive::emit::Options;
use mbs_derive::parse;
use mbs_derive::source::{Sources, Unreadable};
use mbs_tests::random::Random;
use mbs_tests::referee::draw::draw;
use mbs_tests::robustness::{Models, model, mutation};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// All files of the model language below some folders, those of `bad/` too where they are text.
fn files(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let mut waiting: Vec<PathBuf> = folders.iter().map(|folder| Path::new(ROOT).join(folder)).collect();
    let mut found = Vec::new();
    while let Some(folder) = waiting.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if entry.is_dir() && !entry.ends_with("target") {
                waiting.push(entry);
            } else if entry.extension().is_some_and(|extension| extension == "mbs") {
                found.extend(String::from_utf8(std::fs::read(&entry).expect("a file")).ok().map(|text| (entry, text)));
            }
        }
    }
    found.sort();
    found
}

/// Words, numbers, signs and documentation, the last without the white space that lines end with.
fn tokens(text: &str) -> Vec<String> {
    let trimmed = |text: &str| text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n");
    Sources::new("", text).tokens().0.into_iter().map(|span| trimmed(&text[span])).collect()
}

/// All that is neither a token nor white space, in order.
fn comments(text: &str) -> String {
    let (mut found, mut end) = (String::new(), 0);
    let last = text.len()..text.len();
    for span in Sources::new("", text).tokens().0.into_iter().chain(std::iter::once(last)) {
        found.extend(
            text[end..span.start].chars().filter(|c| !c.is_whitespace() && !"\u{200e}\u{200f}\u{feff}".contains(*c)),
        );
        end = span.end;
    }
    found
}

/// What must hold of every text; whether it could be formatted.
#[track_caller]
fn hold(name: &str, text: &str) -> bool {
    let sources = Sources::new(name, text);
    let Ok(formatted) = sources.formatted() else {
        assert!(parse::declaration_of(&sources).is_err(), "{name} can be read, but not formatted\n{text}");
        return false;
    };
    assert_eq!(tokens(&formatted), tokens(text), "{name}\n{text}\n--- formatted\n{formatted}");
    assert_eq!(comments(&formatted), comments(text), "{name}\n{text}\n--- formatted\n{formatted}");
    let again = Sources::new(name, &formatted).formatted();
    assert_eq!(again.as_deref(), Ok(formatted.as_str()), "{name} is formatted twice\n{text}");
    let read =
        |text: &str| parse::declaration_of(&Sources::new(name, text)).map(|declaration| declaration.to_string()).ok();
    assert_eq!(read(&formatted), read(text), "{name} says something else\n{text}\n--- formatted\n{formatted}");
    let is_tidy = |line: &str| line.trim_end() == line;
    assert!(formatted.lines().all(is_tidy) && formatted.ends_with('\n') && !formatted.ends_with("\n\n"), "{formatted}");
    true
}

/// The text with other white space, that says the same: blanks where there are some, and around signs that bind alike.
fn scrambled(text: &str, random: &mut Random) -> String {
    let (mut result, mut end) = (String::new(), 0);
    for span in Sources::new("", text).tokens().0 {
        let gap = &text[end..span.start];
        let (is_bare, breaks) = (gap.trim().is_empty(), gap.contains('\n'));
        match (is_bare, breaks, random.bits() % 4) {
            (true, false, 0) if !gap.is_empty() => result += "   ",
            (true, false, 1) if !gap.is_empty() => result += "\t",
            (true, true, 0) => result += "\n",
            (true, true, 1) => result += "\r\n\n\n  ",
            (true, true, 2) => result += &gap.replace(' ', ""),
            _ => result += gap,
        }
        result += &text[span.clone()];
        if matches!(&text[span.clone()], ";" | "," | "+=" | "(") && random.one_in(3) {
            result += " ";
        }
        end = span.end;
    }
    result + &text[end..]
}

#[test]
fn the_models_of_the_repository_are_in_the_style() {
    let folders = [
        "models",
        "examples",
        "tests/mechanisms",
        "tests/platform",
        "tests/misprints",
        "mbs-cli/tests",
        "mbs-derive/src",
    ];
    let files = files(&folders);
    assert!(files.len() > 80, "{}", files.len());
    let is_other = |(name, text): &&(PathBuf, String)| {
        assert!(hold(&name.display().to_string(), text));
        Sources::new("", text).formatted().as_ref() != Ok(text)
    };
    let others: Vec<_> =
        files.iter().filter(is_other).map(|(name, _)| name.strip_prefix(ROOT).unwrap_or(name)).collect();
    assert!(others.is_empty(), "`mbs fmt` changes {others:?}");
    for (name, text) in Models::read().mechanisms {
        assert!(hold(&name, &text));
        assert_eq!(Sources::new("", &text).formatted().as_ref(), Ok(&text), "{name}");
    }
}

#[test]
fn wrong_models_are_left_alone_or_keep_what_they_say() {
    let files = files(&["tests/bad"]);
    let formatted = files.iter().filter(|(name, text)| hold(&name.display().to_string(), text)).count();
    assert!(files.len() > 100 && formatted > 50 && formatted < files.len(), "{formatted} of {}", files.len());
}

/// Also their code is the same.
#[test]
fn other_white_space_is_the_same_mechanism() {
    let mut random = Random::new(19);
    for (name, text) in Models::read().mechanisms {
        for _ in 0..4 {
            assert!(hold(&name, &scrambled(&text, &mut random)), "{name}");
        }
    }
    for name in ["pendulum", "cart_pole", "four_bar", "kepler", "heavy_top"] {
        let text = std::fs::read_to_string(Path::new(ROOT).join(format!("models/mechanisms/{name}.mbs"))).expect(name);
        let formatted = Sources::new(name, &scrambled(&text, &mut random)).formatted().expect(name);
        let code = |text: &str| mbs_derive::generate(name, text, &Options::default()).expect(name).code;
        assert_eq!(code(&formatted), code(&text), "{name}");
    }
}

#[test]
fn drawn_models_keep_what_they_say() {
    for seed in 0..300 {
        let drawn = draw(seed, None, &[]);
        let mut random = Random::new(seed);
        assert!(hold(&format!("seed {seed}"), &drawn.text));
        assert!(hold(&format!("seed {seed}, scrambled"), &scrambled(&drawn.text, &mut random)));
    }
}

/// Texts from the grammar, most of them wrong, and models that are damaged.
#[test]
fn random_texts_keep_what_they_say() {
    let config = Config { failure_persistence: None, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[19; 32]));
    let mut formatted = 0;
    for _ in 0..400 {
        let text = model::text().new_tree(&mut runner).expect("a text").current();
        formatted += usize::from(hold("random", &text));
    }
    let models = Models::read().mechanisms;
    for i in 0..800 {
        let edits = mutation::edits().new_tree(&mut runner).expect("edits").current();
        let bytes = mutation::damaged(&models[i % models.len()].1, &edits);
        if let Ok(text) = String::from_utf8(bytes) {
            formatted += usize::from(hold("damaged", &text));
        }
    }
    assert!(formatted > 100, "{formatted}");
}

#[test]
fn the_style_is_this() {
    #[track_caller]
    fn check(text: &str, expected: &str) {
        assert!(hold("style", text));
        assert_eq!(Sources::new("style", text).formatted().as_deref(), Ok(expected));
    }
    check(
        "\u{feff}/* first */ //! About.\n\n\n\n#! [ dimensionless ]\nimport   \"a.mbs\" ;import\"b.mbs\";\n\n/// Doc.   \n\nmechanism   A{\n\n\
         param m [ 3 ]:kg * m ^ 2=[ 1,2 , 3 ] , positive;\n\n\n\nlet a=-x ^ -2+b*c/ d+0.3 kg*m+0.3 kg *m;}",
        "/* first */ //! About.\n\n#![dimensionless]\nimport \"a.mbs\";\nimport \"b.mbs\";\n\n/// Doc.\nmechanism A {\n    \
         param m[3]: kg*m^2 = [1, 2, 3], positive;\n\n    let a = -x^-2 + b*c / d + 0.3 kg*m + 0.3 kg * m;\n}\n",
    );
    check(
        "mechanism A{for i in 0 .. n+1{a=a;}if(n==1)||!(m<2){b=b;}else if n>1{}else{c=c; // why\n}\npart p(x,y){}p q [0] (1,[2]);}",
        "mechanism A {\n    for i in 0..n + 1 {\n        a = a;\n    }\n    if (n == 1) || !(m < 2) {\n        b = b;\n    } else if n > 1 {} \
         else {\n        c = c; // why\n    }\n    part p(x, y) {}\n    p q[0](1, [2]);\n}\n",
    );
    check(
        "mechanism A {\nkinetic  += a;   // one\npotential+= b;   // two\nforce x    += c;\nforce long += d; // three\n\nkinetic   += e;\n}\n",
        "mechanism A {\n    kinetic   += a;   // one\n    potential += b;   // two\n    force x    += c;\n    force long += d; // three\n\n    kinetic += e;\n}\n",
    );
    check(
        "mechanism A {\n    let a = f(\n  b, // why\n c\n+ d\n  )\n - [e\n, g];\n        // own\n\n    /* more\n  of it */\n}\n// end",
        "mechanism A {\n    let a = f(\n        b, // why\n        c\n            + d\n    )\n        - [e\n                , g];\n    // own\n\n    \
         /* more\n  of it */\n}\n// end\n",
    );
    check(
        "mechanism A { gravity [0,0,- g]; gravity - g; force at(p) += [u,0,-u]; torque on -q += if a<b {1}else{ -2 }; x = 2 . norm ( ); }",
        "mechanism A {\n    gravity [0, 0, -g];\n    gravity -g;\n    force at (p) += [u, 0, -u];\n    torque on -q += if a < b { 1 } \
         else { -2 };\n    x = 2.norm();\n}\n",
    );
    check("const a=1;\r\nfn f(x)=x ;\r\n", "const a = 1;\r\nfn f(x) = x;\r\n");
    assert!(Sources::new("", "mechanism A { let a = ; }").formatted().is_err());
    assert!(Sources::new("", "").formatted().is_err());
    let missing = |_: &str| Err(Unreadable::new("there is no such file", "look for it"));
    let imports = Sources::gather("a.mbs", "import \"b.mbs\" ;\nconst c = b;", missing);
    assert_eq!(
        imports.formatted().as_deref(),
        Ok("import \"b.mbs\";\nconst c = b;\n"),
        "what is imported is not asked for"
    );
}
