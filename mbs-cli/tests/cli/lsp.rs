//! `mbs lsp`, asked by messages as editors send them.

mod editor;

use std::thread;
use std::time::Duration;

use serde_json::{Value, json};

use crate::Workshop;
use editor::Editor;

/// Line and column, in units of UTF-16, of the `|` in a piece of a text that has none.
#[track_caller]
fn place(text: &str, marked: &str) -> (usize, usize) {
    let (before, behind) = marked.split_once('|').expect("a mark");
    let offset = text.find(&format!("{before}{behind}")).expect("the piece") + before.len();
    let line = text[..offset].matches('\n').count();
    let start = text[..offset].rfind('\n').map_or(0, |newline| newline + 1);
    (line, text[start..offset].encode_utf16().count())
}

fn range(line: usize, from: usize, to_line: usize, to: usize) -> Value {
    json!({ "start": { "line": line, "character": from }, "end": { "line": to_line, "character": to } })
}

const CART: &str = "\
import \"lib.mbs\";
/// 𝛉: a cart on a rail.
mechanism Cart {
    /// Mass of the cart.
    param mass: kg = 2;
    coord x: m;
    input push: N;
    let speed = dt(x); /* 𝛉 */ let momentum = mass*speed;
    kinetic += half(momentum*speed);
    potential += mass*g*x;
    force x += push;
    /// Where it is.
    output place = x;
}
";

const LIB: &str = "/// Standard gravity.\nconst g: m/s^2 = 9.80665;\nfn half(a) = a/2;\n";

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("cart.mbs", CART);
    workshop.write("lib.mbs", LIB);
    workshop
}

#[test]
fn a_typo_is_underlined_and_mended() {
    let mut editor = Editor::new(workshop());
    let wrong = CART.replace("mass*speed;", "mas*speed;");
    editor.open("cart.mbs", &wrong);
    let found = editor.problems("cart.mbs");
    assert_eq!(found.len(), 1, "{found:?}");
    // Behind a letter of two units.
    let (line, column) = place(&wrong, "= |mas*speed");
    assert_eq!(found[0]["range"], range(line, column, line, column + 3));
    assert_eq!(found[0]["message"], "`mas` is not declared\nhelp: did you mean `mass`?");
    assert_eq!((&found[0]["severity"], &found[0]["source"]), (&json!(1), &json!("mbs")));
    assert_eq!(found[0]["code"], "MBS0501", "what `mbs explain` has a page for");
    let uri = editor.uri("cart.mbs");
    let actions = editor.ask("textDocument/codeAction", json!({
        "textDocument": { "uri": uri }, "range": range(line, column, line, column), "context": { "diagnostics": [] },
    }));
    assert_eq!((&actions[0]["title"], &actions[0]["kind"]), (&json!("write `mass`"), &json!("quickfix")));
    assert_eq!(actions[0]["isPreferred"], false, "it is a guess");
    let edit = actions[0]["edit"]["changes"][&uri][0].clone();
    editor.change("cart.mbs", json!([{ "range": edit["range"], "text": edit["newText"] }]));
    assert_eq!(editor.problems("cart.mbs"), [Value::Null; 0]);
    // Errors of the parser, and a fix that is an insertion.
    editor.change("cart.mbs", json!([{ "text": CART.replace("push;\n    ///", "push\n    ///") }]));
    let found = editor.problems("cart.mbs");
    assert_eq!(found[0]["message"], "a `;` is missing\nhelp: end the statement with `;`");
    let actions = editor.ask(
        "textDocument/codeAction",
        json!({
            "textDocument": { "uri": uri }, "range": found[0]["range"], "context": { "diagnostics": [] },
        }),
    );
    assert_eq!(actions[0]["edit"]["changes"][&uri][0]["newText"], ";");
    assert_eq!(actions[0]["isPreferred"], true);
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_is_wrong_in_an_import_is_shown_there() {
    let mut editor = Editor::new(workshop());
    editor.open("cart.mbs", CART);
    assert_eq!(editor.problems("cart.mbs"), [Value::Null; 0]);
    let (cart, lib) = (editor.uri("cart.mbs"), editor.uri("lib.mbs"));
    // The text in the editor counts before that on the disk.
    editor.open("lib.mbs", &LIB.replace("a/2", "a/θ"));
    let found = editor.problems("lib.mbs");
    assert_eq!(found[0]["message"], "names are made of ASCII letters, digits and `_`\nhelp: write `theta`");
    assert_eq!(found[0]["range"], range(2, 15, 2, 16));
    editor.change("lib.mbs", json!([{ "text": LIB.replace("fn half", "fn halff") }]));
    editor.problems("lib.mbs");
    assert_eq!(editor.problems[&lib], [Value::Null; 0]);
    let found = editor.problems[&cart].clone();
    assert_eq!(found[0]["message"], "there is no function `half`\nhelp: did you mean `halff(a)`?");
    editor.change("lib.mbs", json!([{ "text": LIB.replace("fn half(a) = a/2", "fn half(a) = a + 1") }]));
    editor.problems("lib.mbs");
    let found = editor.problems[&lib].clone();
    assert!(found[0]["message"].as_str().unwrap().contains("dimension"), "{found:?}");
    assert_eq!(found[0]["relatedInformation"][0]["location"]["uri"], cart, "the call that led there");
    // Closed without being saved: the disk counts again.
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": lib } }));
    assert_eq!(editor.problems("cart.mbs"), [Value::Null; 0]);
    assert_eq!(editor.problems[&lib], [Value::Null; 0]);
    // The text that a robot has become is in no file: the import is marked.
    let still = "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/>\
        <inertia ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'/></inertial></link>\
        <joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>";
    editor.workshop.write("r.urdf", still);
    editor.open("robot.mbs", "// 1\nimport \"r.urdf\";\nmechanism Robot { }\n");
    let found = editor.problems("robot.mbs");
    assert_eq!(found[0]["range"], range(1, 0, 1, 15));
    assert!(
        found[0]["message"].as_str().unwrap().starts_with("`mbs import r.urdf`:12:11: `j` has no inertia"),
        "{found:?}"
    );
    // A file that is gone.
    std::fs::remove_file(editor.workshop.path("lib.mbs")).unwrap();
    editor.tell("workspace/didChangeWatchedFiles", json!({ "changes": [{ "uri": lib, "type": 3 }] }));
    let found = editor.problems("cart.mbs");
    assert!(found[0]["message"].as_str().unwrap().starts_with("cannot import `lib.mbs`"), "{found:?}");
    assert_eq!(editor.end(), 0);
}

#[test]
fn names_say_what_they_stand_for() {
    let mut editor = Editor::new(workshop());
    editor.open("cart.mbs", CART);
    let mut check = |marked: &str, expected: &[&str]| {
        let text = editor.hover("cart.mbs", CART, marked);
        for part in expected {
            assert!(text.contains(part), "{marked}: {part} is not in {text}");
        }
    };
    check("= |mass*speed", &["param mass: kg = 2;", "parameter `mass`: kg", "Mass of the cart."]);
    check("let |momentum", &["local name `momentum`: kg·m/s"]);
    check(
        "mass*|g*x",
        &["const g: m/s^2 = 9.80665;", "constant `g`: m/s² = 9.80665, of `lib.mbs`", "Standard gravity."],
    );
    check("|half(", &["fn half(a) = a/2;", "function `half`: kg·m²/s²"]);
    check("|dt(x)", &["dt(x)", "The time derivative."]);
    check("x: |m;", &["unit `m`: m"]);
    check("push: |N", &["unit `N`: kg·m/s²"]);
    check("|kinetic", &["A term of the kinetic energy"]);
    check("mechanism |Cart", &["mechanism `Cart`", "a cart on a rail"]);
    // Costs come when nothing is typed.
    let mut cost = String::new();
    for _ in 0..600 {
        cost = editor.hover("cart.mbs", CART, "output |place");
        if cost.contains("additions") {
            break;
        }
        thread::sleep(Duration::from_millis(100));
    }
    assert!(cost.contains("0 additions and multiplications") && cost.contains("Where it is."), "{cost}");
    assert!(editor.hover("cart.mbs", CART, "mechanism |Cart").contains("| `forward_dynamics` | "));
    assert_eq!(editor.hover("cart.mbs", CART, "| 2;"), "");
    assert_eq!(editor.end(), 0);
}

#[test]
fn definitions_references_and_names() {
    let mut editor = Editor::new(workshop());
    editor.open("cart.mbs", CART);
    let (cart, lib) = (editor.uri("cart.mbs"), editor.uri("lib.mbs"));
    let mut ask = |method: &str, marked: &str, more: Value| {
        let mut params = editor.at("cart.mbs", CART, marked);
        for (key, value) in more.as_object().unwrap() {
            params[key] = value.clone();
        }
        editor.ask(method, params)
    };
    let found = ask("textDocument/definition", "= |mass*speed", json!({}));
    assert_eq!((&found["uri"], &found["range"]), (&json!(cart), &range(4, 10, 4, 14)));
    let found = ask("textDocument/definition", "mass*|g*x", json!({}));
    assert_eq!((&found["uri"], &found["range"]), (&json!(lib), &range(1, 6, 1, 7)));
    assert_eq!(ask("textDocument/definition", "import \"l|ib", json!({}))["uri"], lib);
    assert_eq!(ask("textDocument/definition", "|dt(x)", json!({})), Value::Null);
    let count = |found: Value| found.as_array().unwrap().len();
    let context = |declaration: bool| json!({ "context": { "includeDeclaration": declaration } });
    assert_eq!(count(ask("textDocument/references", "= |mass*speed", context(true))), 3);
    assert_eq!(count(ask("textDocument/references", "= |mass*speed", context(false))), 2);
    assert_eq!(count(ask("textDocument/documentHighlight", "let |speed", json!({}))), 3);
    let place = ask("textDocument/prepareRename", "= |mass*speed", json!({}));
    let (line, column) = place_of("= |mass*speed");
    assert_eq!(place, range(line, column, line, column + 4));
    assert_eq!(ask("textDocument/prepareRename", "|dt(x)", json!({})), Value::Null);
    // In the import as well, and in a file that is not open.
    editor
        .workshop
        .write("other.mbs", "import \"lib.mbs\";\nmechanism B { coord y: m; let a = half(g); kinetic += y; }\n");
    let mut rename = |marked: &str, name: &str| {
        let mut params = editor.at("cart.mbs", CART, marked);
        params["newName"] = json!(name);
        editor.response("textDocument/rename", params)
    };
    let edits = rename("mass*|g*x", "gravity_of_earth")["result"]["changes"].clone();
    let lengths: Vec<(String, usize)> = edits
        .as_object()
        .unwrap()
        .iter()
        .map(|(uri, edits)| (uri.rsplit('/').next().unwrap().to_string(), count(edits.clone())))
        .collect();
    let expected = [("cart.mbs", 1), ("lib.mbs", 1), ("other.mbs", 1)].map(|(name, n)| (name.to_string(), n));
    assert_eq!(lengths, expected);
    let edits = rename("let |speed", "velocity")["result"]["changes"][&cart].clone();
    let renamed = edited(CART, &edits);
    assert_eq!(renamed, CART.replace("speed", "velocity"));
    for (name, reason) in [
        ("push", "`push` is already an input"),
        ("2x", "is not a name"),
        ("param", "word of the language"),
        ("θ", "is not a name"),
        ("", "is not a name"),
    ] {
        let refused = rename("let |speed", name)["error"]["message"].as_str().unwrap_or_default().to_string();
        assert!(refused.contains(reason), "{name}: {refused}");
    }
    assert_eq!(editor.end(), 0);
}

#[test]
fn names_of_an_imported_robot_are_known() {
    let robot = "<robot name='r'><link name='base'/><link name='boom'><inertial><mass value='1'/>\
        <inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\
        <joint name='luff' type='continuous'><parent link='base'/><child link='boom'/></joint></robot>";
    let text = "import \"r.urdf\";\nmechanism Held {\n    let tip = boom.point([1 m, 0, 0]);\n    output angle = luff;\n    \
                fn twice() = 2*luff;\n    output height = tip.z + ;\n}\n";
    let mut editor = Editor::new(workshop());
    editor.workshop.write("r.urdf", robot);
    editor.open("held.mbs", text);
    let found = editor.hover("held.mbs", text, "= |luff;");
    let expected = ["coord luff: rad;", "coordinate `luff`: 1, of `r.urdf`", "continuous"];
    assert!(expected.iter().all(|part| found.contains(part)), "{found}");
    let found = editor.hover("held.mbs", text, "= |boom.point");
    assert!(found.contains("local name `boom`: pose"), "{found}");
    let mut ask = |method: &str, marked: &str| {
        let mut params = editor.at("held.mbs", text, marked);
        params["context"] = json!({ "includeDeclaration": true });
        params["newName"] = json!("other");
        editor.response(method, params)
    };
    let import = ask("textDocument/definition", "= |boom.point")["result"].clone();
    assert!(import["uri"].as_str().unwrap().ends_with("/held.mbs") && import["range"] == range(0, 0, 0, 15));
    let found = ask("textDocument/references", "= |luff;")["result"].clone();
    let lines = [0, 1, 2].map(|i| found[i]["range"]["start"]["line"].clone());
    assert_eq!((lines, &found[2]), ([3, 4, 0].map(Value::from), &import));
    assert_eq!(ask("textDocument/prepareRename", "= |luff;")["result"], Value::Null);
    let refused = ask("textDocument/rename", "= |luff;")["error"]["message"].clone();
    assert_eq!(refused, "a name of a robot is renamed in the robot's file");
    let found = editor.ask("textDocument/completion", editor.at("held.mbs", text, "tip.z + |;")).to_string();
    let is_offered = |name: &&str| found.contains(&format!("\"label\":\"{name}\""));
    assert!(["luff", "boom", "luff_torque"].iter().all(is_offered), "{found}");
    assert_eq!(editor.end(), 0);
}

/// A rename that would change what a text means, or break it, is refused; what only looks like one is not.
#[test]
fn renamed_texts_mean_the_same() {
    const PARTS: &str = "import \"lib.mbs\";\nmechanism A {\n    part bob(m, x) {\n        let end = [x, 0, 3*x];\n        \
        kinetic += particle(m, end);\n        output tip = [x, 0, 2*x];\n    }\n    fn twice(a) = 2*a;\n    param k: N/m = 1;\n    \
        coord x: m;\n    coord q[2]: m;\n    let base = twice(x);\n    bob b(1 kg, x);\n    \
        kinetic += 1/2*(1 kg)*(dt(q[0])^2 + dt(q[1])^2);\n    potential += 3 N*b.tip.z + k*x^2 + g*base*(1 kg);\n    \
        output o = [sin(x/(1 m)), 0, 0];\n}\n";
    let mut editor = Editor::new(workshop());
    editor.open("parts.mbs", PARTS);
    assert_eq!(editor.problems("parts.mbs"), [Value::Null; 0]);
    // What is open in the editor counts.
    editor.open("lib.mbs", LIB);
    let mut check = |file: &str, text: &str, marked: &str, name: &str, reason: &str| {
        let mut params = editor.at(file, text, marked);
        params["newName"] = json!(name);
        let response = editor.response("textDocument/rename", params);
        let refused = response["error"]["message"].as_str().unwrap_or_default();
        assert!(refused.contains(reason) && refused.is_empty() == reason.is_empty(), "{marked} -> {name}: {response}");
    };
    for (marked, name, reason) in [
        ("output |tip", "end", "`end` is already a local name"),
        ("let |end", "tip", "`tip` is already an output"),
        ("fn |twice", "base", "`base`"),
        ("let |base", "twice", "`twice`"),
        ("fn |twice", "sin", "`sin`"),
        ("fn |twice", "particle", "`particle`"),
        ("output |o", "gravity", "`gravity`"),
        ("output |o", "mass_matrix", "`mass_matrix`"),
        ("param |k", "q_1", "`q_1`"),
        ("coord |x:", "energy", "`energy`"),
        ("part |bob", "part", "`part`"),
        ("param |k", "g", "`g` is already a constant"),
        ("param |k", "pi", "`pi`"),
        ("param |k", "if", "`if` is a word of the language"),
        // A function's argument hides what it does not use; an output may be called as a parameter is.
        ("fn twice(|a)", "k", ""),
        ("let |base", "tip", ""),
        ("output |tip", "top", ""),
    ] {
        check("parts.mbs", PARTS, marked, name, reason);
    }
    // In a file that imports the name.
    check("lib.mbs", LIB, "const |g:", "k", "`k` is already a parameter");
    check("lib.mbs", LIB, "const |g:", "g_0", "");
    assert_eq!(editor.end(), 0);
}

fn place_of(marked: &str) -> (usize, usize) {
    place(CART, marked)
}

/// A text with edits made, the last first.
fn edited(text: &str, edits: &Value) -> String {
    let offset = |position: &Value| {
        let (line, column) =
            (position["line"].as_u64().unwrap() as usize, position["character"].as_u64().unwrap() as usize);
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        let units: Vec<u16> = text[start..].encode_utf16().take(column).collect();
        start + String::from_utf16(&units).unwrap().len()
    };
    let mut edits: Vec<(usize, usize, &str)> = edits
        .as_array()
        .unwrap()
        .iter()
        .map(|edit| (offset(&edit["range"]["start"]), offset(&edit["range"]["end"]), edit["newText"].as_str().unwrap()))
        .collect();
    edits.sort();
    let mut text = text.to_string();
    for (start, end, with) in edits.into_iter().rev() {
        text.replace_range(start..end, with);
    }
    text
}

#[test]
fn what_may_be_written_is_offered() {
    let mut editor = Editor::new(workshop());
    let mut check = |text: &str, marked: &str, has: &[&str], has_not: &[&str]| {
        let text = CART.replace("    force x += push;\n", text);
        editor.open("cart.mbs", &text);
        let params = editor.at("cart.mbs", &text, marked);
        let found = editor.ask("textDocument/completion", params);
        let labels: Vec<&str> = found.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap()).collect();
        for label in has {
            assert!(labels.contains(label), "{marked}: no {label} in {labels:?}");
        }
        for label in has_not {
            assert!(!labels.contains(label), "{marked}: {label} in {labels:?}");
        }
        found
    };
    check("    po\n", "    po|\n", &["potential", "param", "let", "momentum"], &["sin", "kg", "half"]);
    let found = check(
        "    kinetic += ma\n",
        "+= ma|\n",
        &["mass", "x", "half", "g", "sin", "pi", "if"],
        &["kg", "param", "later"],
    );
    let mass = found.as_array().unwrap().iter().find(|item| item["label"] == "mass").unwrap();
    assert_eq!((&mass["detail"], &mass["documentation"]), (&json!("parameter: kg"), &json!("Mass of the cart.")));
    check("    param k: N\n", "k: N|\n", &["N", "kN", "kg", "rad"], &["mass", "sin"]);
    check("    let a = 2 k\n", "2 k|\n", &["kg", "km"], &["mass"]);
    check("    let a = place.\n", "place.|\n", &["x", "norm", "point"], &["mass", "sin"]);
    check(
        "    part p(m) { let inner = m; output tip = m; }\n    p arm(mass);\n    let a = arm.\n",
        "arm.|\n",
        &["inner", "tip"],
        &["x", "norm"],
    );
    let chosen = "    let a = if x > 0 m { ma } else { ha };\n";
    check(chosen, "{ ma|", &["mass", "half", "sin"], &["param"]);
    check(chosen, "{ ha|", &["mass", "half", "sin"], &["param"]);
    for statement in ["if half > 0 { po }", "for i in 0..2 { if i > 0 { po } }", "if half > 0 { let a = half; po }"] {
        check(&format!("    {statement}\n"), " po| }", &["potential", "let"], &["sin"]);
    }
    check("    // po\n", "// po|\n", &[], &["potential", "mass"]);
    assert_eq!(editor.end(), 0);
}

#[test]
fn symbols_hints_and_style() {
    let mut editor = Editor::new(workshop());
    let untidy = CART.replace("    ", "\t").replace(" += ", "+=");
    editor.open("cart.mbs", &untidy);
    let uri = editor.uri("cart.mbs");
    let document = json!({ "textDocument": { "uri": uri } });
    let symbols = editor.ask("textDocument/documentSymbol", document.clone());
    assert_eq!((&symbols[0]["name"], symbols.as_array().unwrap().len()), (&json!("Cart"), 1));
    assert_eq!(symbols[0]["range"]["end"]["line"], 13);
    let names: Vec<&Value> = symbols[0]["children"].as_array().unwrap().iter().map(|child| &child["name"]).collect();
    assert_eq!(names, ["mass", "x", "push", "speed", "momentum", "place"]);
    let hints =
        editor.ask("textDocument/inlayHint", json!({ "textDocument": { "uri": uri }, "range": range(0, 0, 99, 0) }));
    let labels: Vec<&Value> = hints.as_array().unwrap().iter().map(|hint| &hint["label"]).collect();
    assert_eq!(labels, [": m/s", ": kg·m/s", ": m"]);
    let (line, column) = place(&untidy, "momentum| = ");
    assert_eq!(hints[1]["position"], json!({ "line": line, "character": column }));
    let options = json!({ "textDocument": { "uri": uri }, "options": { "tabSize": 4, "insertSpaces": true } });
    let edits = editor.ask("textDocument/formatting", options.clone());
    let tidy = CART.replace(" let momentum", "\n    let momentum");
    assert_eq!(edited(&untidy, &edits).replace(" \n", "\n"), tidy);
    editor.change("cart.mbs", json!([{ "text": edits[0]["newText"] }]));
    assert_eq!(editor.ask("textDocument/formatting", options.clone()), json!([]));
    editor.change("cart.mbs", json!([{ "text": "mechanism {" }]));
    assert_eq!(editor.ask("textDocument/formatting", options), Value::Null);
    assert_eq!(editor.ask("textDocument/documentSymbol", document), json!([]));
    assert_eq!(editor.end(), 0);
}

/// The proof finds what the declaration does not show.
#[test]
fn what_the_proof_finds_is_told() {
    let mut editor = Editor::new(workshop());
    let text = CART.replace("kinetic += half(momentum*speed);", "kinetic += half(momentum*speed)*(mass - 3 kg)/mass;");
    editor.open("cart.mbs", &text);
    for _ in 0..600 {
        if editor.problems("cart.mbs").iter().any(|found| found["message"].as_str().unwrap().contains("negative")) {
            assert_eq!(editor.end(), 0);
            return;
        }
        thread::sleep(Duration::from_millis(100));
    }
    panic!("{:?}", editor.problems("cart.mbs"));
}

/// Of several files that wait each is proved, and what was found stays while its text does.
#[test]
fn every_open_file_is_proved() {
    let stop = include_str!("../../../tests/bad/branch_never_taken.mbs");
    let mut editor = Editor::new(workshop());
    let names = ["a.mbs", "b.mbs", "c.mbs", "d.mbs"];
    names.iter().for_each(|name| editor.open(name, stop));
    let until_all = |editor: &mut Editor| {
        for _ in 0..600 {
            if names.iter().all(|name| editor.problems(name).iter().any(|found| found["code"] == "MBS1201")) {
                return;
            }
            thread::sleep(Duration::from_millis(100));
        }
        panic!("{:?}", editor.problems);
    };
    until_all(&mut editor);
    editor.tell("textDocument/didSave", json!({ "textDocument": { "uri": editor.uri("a.mbs") } }));
    for name in names {
        assert_eq!(editor.problems(name).len(), 1, "{name}");
    }
    // What is changed is proved again.
    editor.change("b.mbs", json!([{ "text": stop.replace("Stop", "Other") }]));
    assert_eq!(editor.problems("b.mbs").len(), 0);
    until_all(&mut editor);
    assert_eq!(editor.end(), 0);
}

#[test]
fn bad_messages_are_passed_over() {
    let mut editor = Editor::started(workshop());
    assert_eq!(editor.refused("textDocument/hover", json!({})), "`initialize` comes first");
    editor.refused("initialize", json!([1]));
    editor.ask("initialize", json!({ "capabilities": {} }));
    for bytes in
        ["Content-Length: 1\r\n\r\n{", "nonsense\r\n", "Content-Length: x\r\n", "\r\n", "Content-Length: 4\r\n\r\nnull"]
    {
        editor.raw(bytes.as_bytes());
    }
    editor.raw(b"Content-Length: 2\r\n\r\n\xff\xfe");
    editor.tell("textDocument/didOpen", json!({ "textDocument": 1 }));
    editor.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": "file:///nowhere.mbs", "version": 1 }, "contentChanges": [] }),
    );
    editor.tell("$/unknown", Value::Null);
    editor.send(&json!({ "jsonrpc": "2.0", "id": 77, "result": null }));
    assert_eq!(editor.refused("textDocument/dance", json!({})), "there is no `textDocument/dance`");
    assert!(editor.refused("textDocument/hover", json!({ "textDocument": {} })).contains("missing field"));
    let nowhere =
        json!({ "textDocument": { "uri": "file:///nowhere.mbs" }, "position": { "line": 9, "character": 9 } });
    assert_eq!(editor.ask("textDocument/hover", nowhere), Value::Null);
    editor.open("cart.mbs", CART);
    let far = json!({ "textDocument": { "uri": editor.uri("cart.mbs") }, "position": { "line": 4_000_000_000_u32, "character": 4_000_000_000_u32 } });
    assert_eq!(editor.ask("textDocument/hover", far), Value::Null);
    assert!(editor.ask("textDocument/codeAction", json!({
        "textDocument": { "uri": "untitled:Untitled-1" }, "range": range(0, 0, 0, 0), "context": { "diagnostics": [] },
    })).as_array().unwrap().is_empty());
    assert_eq!(editor.ask("shutdown", Value::Null), Value::Null);
    assert_eq!(editor.refused("textDocument/hover", json!({})), "after `shutdown` comes `exit`");
    editor.tell("exit", Value::Null);
    assert_eq!(editor.child.wait().unwrap().code(), Some(0));
}

#[test]
fn an_end_without_a_word_is_told_by_the_exit_code() {
    let mut editor = Editor::new(workshop());
    drop(editor.input.take());
    assert_eq!(editor.child.wait().unwrap().code(), Some(1));
    let mut editor = Editor::new(workshop());
    editor.tell("exit", Value::Null);
    assert_eq!(editor.child.wait().unwrap().code(), Some(1));
}

/// A thousand edits as somebody's cat makes them: the server goes on, and knows the text in the end.
#[test]
fn a_thousand_random_edits() {
    let mut editor = Editor::new(workshop());
    editor.open("cart.mbs", CART);
    let uri = editor.uri("cart.mbs");
    let mut text = CART.to_string();
    let mut state = 19_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below.max(1)
    };
    let pieces = [
        "",
        "",
        "",
        ";",
        "{",
        "}",
        "(",
        ")",
        "[",
        " ",
        "\n",
        "θ",
        "𝛉",
        "/*",
        "//",
        "\"",
        "let a = ",
        "x",
        "1e9",
        " kg",
        ".",
        "dt(",
        "for i in 0..3 {",
        "part p(",
        "import ",
        "\r\n",
        "if ",
    ];
    for step in 0..1000 {
        if step % 50 == 49 {
            text = CART.to_string();
            editor.change("cart.mbs", json!([{ "text": text }]));
        }
        let lines: Vec<&str> = text.split('\n').collect();
        let (first, more) = (random(lines.len()), random(2));
        let last = (first + more * random(3)).min(lines.len() - 1);
        let columns = |line: &str| line.trim_end_matches('\r').encode_utf16().count();
        let (mut from, mut to) = (random(columns(lines[first]) + 1), random(columns(lines[last]) + 1));
        if first == last && from > to {
            (from, to) = (to, from);
        }
        let to = if first == last { to.min(from + 5) } else { to };
        let piece = pieces[random(pieces.len())];
        let change = json!({ "range": range(first, from, last, to), "text": piece });
        let edit = json!([{ "range": range(first, from, last, to), "newText": piece }]);
        // Within a letter of two units: what is meant nobody knows.
        let is_within = |line: &str, column: usize| {
            String::from_utf16(&line.encode_utf16().take(column).collect::<Vec<_>>()).is_err()
        };
        if is_within(lines[first], from) || is_within(lines[last], to) {
            continue;
        }
        text = edited(&text, &edit);
        editor.change("cart.mbs", json!([change]));
        if step % 10 == 0 {
            let position = json!({ "textDocument": { "uri": uri }, "position": { "line": first, "character": from }, "context": { "includeDeclaration": true }, "newName": "other" });
            for method in [
                "hover",
                "definition",
                "references",
                "completion",
                "documentSymbol",
                "rename",
                "prepareRename",
                "documentHighlight",
            ] {
                let response = editor.response(&format!("textDocument/{method}"), position.clone());
                assert_ne!(response["error"]["code"], -32603, "a bug in {method}: {text}");
            }
            editor.ask(
                "textDocument/inlayHint",
                json!({ "textDocument": { "uri": uri }, "range": range(0, 0, last + 9, 0) }),
            );
        }
    }
    editor.change("cart.mbs", json!([{ "range": range(0, 0, 99_999, 0), "text": CART }]));
    assert_eq!(editor.problems("cart.mbs"), [Value::Null; 0]);
    assert!(editor.hover("cart.mbs", CART, "let |momentum").contains("kg·m/s"));
    assert_eq!(editor.end(), 0);
}
