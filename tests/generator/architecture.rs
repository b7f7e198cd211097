//! Which folder may use which: what ARCHITECTURE.md says in its table of arrows is what the sources do.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use mbs_derive::expr::Graph;
use mbs_derive::{declared, derived};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// From each name to those that it uses.
type Arrows = BTreeMap<String, BTreeSet<String>>;

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The rows `| name | may use |` of the table of ARCHITECTURE.md behind a heading.
fn allowed(heading: &str) -> Arrows {
    let text = read(&Path::new(ROOT).join("ARCHITECTURE.md"));
    let (_, section) = text.split_once(heading).expect("the heading is there");
    let rows = section.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    let names = |cell: &str| cell.split(['`', ',', ' ', '–']).filter(|n| !n.is_empty()).map(String::from).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').collect();
        let users: BTreeSet<String> = names(cells[0]);
        users.into_iter().map(|user| (user, names(cells[1]))).collect::<Vec<_>>()
    };
    rows.skip(2).flat_map(row).collect()
}

/// All sources below a folder, without those of tests.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            match entry.extension().and_then(|extension| extension.to_str()) {
                _ if entry.is_dir() => folders.push(entry),
                Some("rs") => found.push(entry),
                _ => {}
            }
        }
    }
    found.sort();
    found
}

/// What stands in a source before its tests, without comments.
fn code(source: &str) -> String {
    let before_tests = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    before_tests.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Files that are modules for tests alone: their declaration stands behind `#[cfg(test)]`.
fn is_for_tests(file: &Path) -> bool {
    let module = file.file_stem().expect("a name").to_string_lossy().into_owned();
    let parents = [file.with_file_name("mod.rs"), file.parent().expect("a folder").with_extension("rs")];
    parents.iter().filter_map(|parent| std::fs::read_to_string(parent).ok()).any(|text| {
        ["", "pub(crate) "].iter().any(|public| text.contains(&format!("#[cfg(test)]\n{public}mod {module};")))
    })
}

/// What the paths of a group lead to first: `a` and `b` of `{a, b::c}`, and `a` of `a::b`.
fn first_names(path: &str) -> Vec<&str> {
    let word = |text: &str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let Some(group) = path.strip_prefix('{') else { return vec![&path[..word(path)]] };
    let (mut depth, mut names, mut begins) = (1, Vec::new(), true);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => break,
            '}' => depth -= 1,
            ',' => begins = depth == 1,
            _ if begins && !c.is_whitespace() => {
                names.push(&group[at..at + word(&group[at..])]);
                begins = false;
            }
            _ => {}
        }
    }
    names
}

#[test]
fn groups_are_read() {
    assert_eq!(first_names("a_1::b;"), ["a_1"]);
    assert_eq!(first_names("{a, b::c};"), ["a", "b"]);
    assert_eq!(first_names("{\n    a::{self, x, y::{z}}, c as d,\n    E,\n};\nuse f::{g}"), ["a", "c", "E"]);
}

/// What `lib.rs` gives another name at the root: from the name to the module that it stands in.
fn names_at_the_root(lib: &str) -> BTreeMap<String, String> {
    let uses = lib.split("pub use ").skip(1).map(|rest| rest.split(';').next().unwrap_or_default());
    let all = |path: &str| {
        let (module, names) = path.split_once("::").expect("a path");
        let names = if names.starts_with('{') { first_names(names) } else { names.rsplit("::").take(1).collect() };
        names.into_iter().map(|name| (name.to_string(), module.to_string())).collect::<Vec<_>>()
    };
    uses.flat_map(all).collect()
}

/// Which folders of mbs-derive use which, by their paths from the crate's root: through groups and by the names that
/// `lib.rs` exports, too.
fn arrows_in_the_generator() -> Arrows {
    let root = Path::new(ROOT).join("mbs-derive/src");
    let modules: BTreeSet<String> = std::fs::read_dir(&root)
        .expect("mbs-derive/src")
        .map(|entry| entry.expect("an entry").path().file_stem().expect("a name").to_string_lossy().into_owned())
        .filter(|name| name != "lib")
        .collect();
    let exported = names_at_the_root(&code(&read(&root.join("lib.rs"))));
    let mut arrows: Arrows = modules.iter().map(|module| (module.clone(), BTreeSet::new())).collect();
    for file in sources(&root).into_iter().filter(|file| !is_for_tests(file)) {
        let inside = file.strip_prefix(&root).expect("below the root").with_extension("");
        let user = inside.iter().next().expect("a name").to_string_lossy().into_owned();
        let Some(used) = arrows.get_mut(&user) else { continue };
        for name in code(&read(&file)).split("crate::").skip(1).flat_map(first_names) {
            let module = if modules.contains(name) { Some(name) } else { exported.get(name).map(String::as_str) };
            let module = module.unwrap_or_else(|| panic!("{}: `{name}` is no module", file.display()));
            if module != user {
                used.insert(module.to_string());
            }
        }
    }
    arrows
}

/// A statement without the feature that it is behind.
fn unconditional(statement: &str) -> &str {
    let behind = if statement.starts_with("#[cfg(") { statement.split_once(']') } else { None };
    behind.map_or(statement, |(_, behind)| behind.trim())
}

/// `lib.rs` names modules and exports, and has nothing of its own: what stood there would hide who uses whom.
#[test]
fn the_root_of_the_generator_is_a_list() {
    let lib = code(&read(&Path::new(ROOT).join("mbs-derive/src/lib.rs")));
    let statements = lib.split(';').map(str::trim).filter(|statement| !statement.is_empty());
    let other: Vec<_> = statements
        .filter(|s| !["mod ", "pub mod ", "pub use "].iter().any(|word| unconditional(s).starts_with(word)))
        .collect();
    assert!(other.is_empty(), "{other:?}");
}

/// Which members of the workspace depend on which, those for tests and builds included.
fn arrows_between_crates() -> Arrows {
    let manifest = |folder: &str| read(&Path::new(ROOT).join(folder).join("Cargo.toml"));
    let workspace = manifest("");
    let (_, members) = workspace.split_once("members = [").expect("a workspace");
    let (members, _) = members.split_once(']').expect("the end of its members");
    let members: Vec<&str> = members.split('"').skip(1).step_by(2).collect();
    let used = |member: &str| {
        let manifest_of_user = manifest(member);
        let depends = |other: &&str| {
            let manifest = manifest(other);
            let (_, name) = manifest.split_once("name = \"").expect("the name of a package");
            let name = name.split('"').next().expect("a name");
            *other != member
                && manifest_of_user
                    .lines()
                    .any(|line| line.starts_with(&format!("{name}.")) || line.starts_with(&format!("{name} ")))
        };
        members.iter().filter(|other| depends(other)).map(|other| (*other).to_string()).collect()
    };
    members.iter().map(|member| ((*member).to_string(), used(member))).collect()
}

#[track_caller]
fn hold(found: &Arrows, allowed: &Arrows) {
    assert_eq!(found.keys().collect::<Vec<_>>(), allowed.keys().collect::<Vec<_>>(), "each has a row of the table");
    for (user, used) in found {
        let refused: Vec<_> = used.difference(&allowed[user]).collect();
        assert!(refused.is_empty(), "{user} uses {refused:?}, which ARCHITECTURE.md does not allow");
        let unused: Vec<_> = allowed[user].difference(used).collect();
        assert!(unused.is_empty(), "ARCHITECTURE.md allows {user} to use {unused:?}, which it does not need");
    }
}

/// Nothing leads back to where it came from.
#[track_caller]
fn assert_one_way(arrows: &Arrows) {
    let mut left: BTreeSet<&String> = arrows.keys().collect();
    while !left.is_empty() {
        let done: Vec<&String> =
            left.iter().copied().filter(|user| arrows[*user].iter().all(|used| !left.contains(used))).collect();
        assert!(!done.is_empty(), "a circle of {left:?}");
        done.iter().for_each(|user| assert!(left.remove(user)));
    }
}

#[test]
fn passes_of_the_generator_look_one_way() {
    let arrows = arrows_in_the_generator();
    hold(&arrows, &allowed("## Arrows"));
    assert_one_way(&arrows);
}

/// What mbs-derive is made of in a build, each package with its features, as `cargo tree` prints it.
fn parts_of_the_generator(build: &str) -> BTreeSet<String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.current_dir(ROOT).args(["tree", "--locked", "--no-dedupe", "--prefix", "depth", "--format", " {p}: {f}"]);
    let output = cargo.args(build.split_whitespace()).output().expect("cargo starts");
    assert!(output.status.success(), "cargo tree {build}: {}", String::from_utf8_lossy(&output.stderr));
    let (mut parts, mut inside) = (BTreeSet::new(), None);
    for line in String::from_utf8(output.stdout).expect("UTF-8").lines() {
        let Some((depth, package)) = line.split_once(' ') else { continue };
        let depth: usize = depth.parse().expect("a depth");
        inside = inside.filter(|of| depth > *of).or(package.starts_with("mbs-derive ").then_some(depth));
        if inside.is_some() {
            parts.insert(package.to_owned());
        }
    }
    parts
}

/// With another feature of one of its parts it would be compiled again, which takes longer than all else of a build.
#[test]
fn one_generator_serves_programs_build_scripts_and_tests() {
    let workspace = parts_of_the_generator("--workspace -e no-dev");
    assert!(workspace.len() > 8, "{workspace:?}");
    let systems = "-p mbs-models -p mbs-arm -p mbs-platform -p mbs-landing -p mbs-orbit";
    for build in [
        "--workspace --features mbs-cli/accuracy,mbs-cli/lsp,mbs-cli/parquet,mbs-cli/mpi,mbs-runtime/libm,mbs-runtime/rayon",
        "-p mbs-cli -e no-dev",
        "-p mbs-examples -e no-dev",
        "-p mbs-examples --features russell",
        "-p mbs-tests",
        "-p mbs-benches --no-default-features",
        &format!("{systems} --no-default-features --features libm -e no-dev"),
    ] {
        assert_eq!(parts_of_the_generator(build), workspace, "{build}");
    }
}

#[test]
fn crates_look_one_way() {
    let arrows = arrows_between_crates();
    hold(&arrows, &allowed("Between crates:"));
    assert_one_way(&arrows);
    assert!(arrows["mbs-derive"].is_empty() && arrows["mbs-runtime"].is_empty());
}

/// The manual has a row for every function of the catalogue.
#[test]
fn the_manual_says_what_each_function_is() {
    let text = "#![dimensionless] mechanism A { param m: 1 = 2; coord x: 1; coord y: 1; constraint c: x = y; \
                kinetic += m*(dt(x)^2 + dt(y)^2); }";
    let graph = Graph::verbatim();
    let (lagrangian, _) = declared(text, &graph, &[]).expect("as good as any");
    let manual = read(&Path::new(ROOT).join("docs/language.md"));
    let (_, section) = manual.split_once("| function | |\n").expect("the table is there");
    let rows = section.lines().take_while(|line| line.starts_with('|')).filter_map(|line| line.split('|').nth(1));
    let said: BTreeSet<&str> = rows.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    let derivation = derived(&lagrangian);
    assert_eq!(said, derivation.functions.iter().map(|function| function.name.as_str()).collect());
}

/// Sources that are written by hand, below the folders of the workspace's members.
fn written_by_hand() -> Vec<PathBuf> {
    [
        "mbs-derive",
        "mbs-runtime",
        "mbs-chart",
        "mbs-ensemble",
        "mbs-native",
        "mbs-cli",
        "models",
        "tests",
        "examples",
        "benches",
    ]
    .iter()
    .flat_map(|folder| sources(&Path::new(ROOT).join(folder)))
    .filter(|file| !file.iter().any(|part| part == "target"))
    .collect()
}

#[test]
fn no_source_is_longer_than_600_lines() {
    let long: Vec<_> = written_by_hand().into_iter().filter(|file| read(file).lines().count() > 600).collect();
    assert!(long.is_empty(), "split {long:?}");
}

/// The language has a lexer and a parser of its own.
#[test]
fn syn_and_quote_are_for_emitted_rust_alone() {
    let generator = Path::new(ROOT).join("mbs-derive/src");
    let is_of = |file: &PathBuf, pass: &str| {
        file.starts_with(generator.join(pass)) || *file == generator.join(pass).with_extension("rs")
    };
    let names = ["syn::", "quote::", "proc_macro2::", "prettyplease::"];
    let uses = |file: &PathBuf| names.iter().any(|name| code(&read(file)).contains(name));
    let elsewhere = |file: &PathBuf| !is_of(file, "emit") && !is_of(file, "proofread") && uses(file);
    let found: Vec<_> = sources(&generator).into_iter().filter(elsewhere).collect();
    assert!(found.is_empty(), "{found:?}");
}

/// Rows of tables aside, and the documentation of generated code, which is wrapped where it is written.
#[test]
fn comments_are_as_wide_as_code() {
    let is_wide = |line: &&str| {
        let text = line.trim_start();
        text.starts_with("//")
            && line.chars().count() > 120
            && !text.trim_start_matches(['/', '!', ' ']).starts_with('|')
    };
    let files = written_by_hand().into_iter().filter(|file| !file.ends_with("emit/rust.rs"));
    let wide: Vec<_> =
        files.flat_map(|file| read(&file).lines().filter(is_wide).map(String::from).collect::<Vec<_>>()).collect();
    assert!(wide.is_empty(), "wider than 120 columns: {wide:#?}");
}

/// The documentation of items, a block each, its first paragraph in one line.
fn docs(text: &str) -> Vec<String> {
    let mut docs = vec![Vec::new()];
    for line in text.lines() {
        let line = line.trim_start();
        match line.strip_prefix("///").or(line.strip_prefix("//!")).map(str::trim) {
            Some(line) => docs.last_mut().expect("begun").push(line),
            None => docs.push(Vec::new()),
        }
    }
    docs.iter().filter(|doc| !doc.is_empty()).map(|doc| doc.join(" ")).collect()
}

/// What is wrong with a doc comment that does not stand alone: it speaks of what stands before it, or of nothing.
fn hangs(doc: &str) -> Option<&'static str> {
    let words: Vec<&str> = doc.split(' ').collect();
    let unit = doc.starts_with("\\[") && doc.trim_end_matches('.').ends_with("\\]") && !doc[2..].contains("\\[");
    let refers = ["of", "with", "for", "as", "but", "less", "about", "in", "by", "at", "beside", "from", "and"];
    let is_same = words.starts_with(&["The", "same"]) && words.get(2).is_none_or(|word| refers.contains(word));
    let of_what = words[0] == "Of" && words.iter().take_while(|word| !word.starts_with("\\[")).count() <= 4;
    if unit {
        Some("a unit is no sentence")
    } else if is_same || ["The same,", "The same.", "Likewise", "From both"].iter().any(|begin| doc.starts_with(begin))
    {
        Some("say what it is, not that it is the same")
    } else if of_what && words[words.len() - 1].ends_with(['.', ']']) {
        Some("say what it is, not of what")
    } else if ["o much", "o many", "o often"].iter().any(|end| {
        ["s", "S"].iter().any(|so| {
            let words = format!(" {so}{end}");
            format!(" {doc} ")
                .match_indices(&words)
                .any(|(at, _)| !doc[at + words.len() - 1..].starts_with(char::is_alphabetic))
        })
    }) {
        Some("say how much, how many or how often")
    } else {
        None
    }
}

#[test]
fn doc_comments_stand_alone() {
    for wrong in [
        "Likewise, by name.",
        "The same of D.",
        "The same.",
        "Of the ports.",
        "\\[m\\]",
        "Moves it so much.",
        "So often.",
    ] {
        assert!(hangs(wrong).is_some(), "{wrong}");
    }
    for right in ["The same edge is the same link.", "Of each row the first entry.", "The time \\[s\\].", "Also many."]
    {
        assert_eq!(hangs(right), None, "{right}");
    }
    let mut found = Vec::new();
    for file in written_by_hand() {
        let hanging = docs(&read(&file)).into_iter().filter_map(|doc| Some((hangs(&doc)?, doc)));
        found.extend(hanging.map(|(reason, doc)| format!("{}: {reason}: {doc}", file.display())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Who doubts a reference value makes it again.
#[test]
fn a_script_stands_beside_every_reference() {
    let folder = Path::new(ROOT).join("tests/data");
    // The arm on which operation counts are quoted is given, not computed. What stands in `experiment.json` is of a
    // program that flew the guided landing by itself: a second program of that size is what it is compared with.
    let given = ["arm6", "experiment"];
    let entries = std::fs::read_dir(&folder).expect("tests/data").map(|entry| entry.expect("an entry").path());
    let references: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|end| end == "json")).collect();
    assert!(references.len() > 7, "{references:?}");
    for reference in references {
        let name = reference.file_stem().expect("a name").to_string_lossy().into_owned();
        let script = reference.with_extension("py");
        assert_eq!(script.exists(), !given.contains(&name.as_str()), "{name}");
        let makes = |text: &str| text.starts_with(&format!("\"\"\"Makes {name}.json: "));
        assert!(!script.exists() || makes(&read(&script)), "{} says what it makes", script.display());
    }
}

/// A stranger finds what CONTRIBUTING.md sends them to.
#[test]
fn the_files_that_contributing_names_exist() {
    let text = read(&Path::new(ROOT).join("CONTRIBUTING.md"));
    let (_, section) = text.split_once("## Where it goes").expect("the heading is there");
    let table: Vec<&str> = section.lines().filter(|line| line.starts_with('|')).collect();
    let paths: Vec<&str> =
        table.iter().flat_map(|line| line.split('`').skip(1).step_by(2)).filter(|path| path.contains('/')).collect();
    assert!(table.len() > 8 && paths.len() > 12, "{table:?}");
    for path in paths {
        assert!(Path::new(ROOT).join(path).exists(), "CONTRIBUTING.md names {path}, which is not there");
    }
}

/// What a user of mbs-derive can name: types, traits, functions and macros in public modules, by their paths.
fn surface(file: &Path, path: &str) -> BTreeSet<String> {
    let text = read(file);
    let mut found = BTreeSet::new();
    for item in text.split("\npub ").skip(1) {
        let item = item.replace("unsafe ", "").replace('\n', " ");
        let (kind, rest) = item.split_once(' ').expect("an item has a name");
        let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
        match kind {
            "mod" => {
                let name = name(rest);
                let folder = if path.is_empty() { file.with_file_name("") } else { file.with_extension("") };
                found.extend(surface(&folder.join(format!("{name}.rs")), &format!("{path}{name}::")));
            }
            "use" => {
                let names = rest.split(';').next().unwrap_or_default();
                let names =
                    names.rsplit_once('{').map_or(names.rsplit("::").next().unwrap_or_default(), |(_, all)| all);
                let names = names.split([',', '}']).map(|name| name.trim().to_string());
                let is_constant = |name: &String| name.chars().all(|c| c.is_uppercase() || c == '_');
                found.extend(names.filter(|name| !name.is_empty() && !is_constant(name)).map(|n| format!("{path}{n}")));
            }
            "const" | "static" => {}
            _ => drop(found.insert(format!("{path}{}", name(rest.trim_start_matches("fn "))))),
        }
    }
    found.extend(text.split("#[macro_export]").skip(1).map(|_| format!("{path}a macro")));
    found
}

#[test]
fn users_of_the_generator_see_at_most_80_names() {
    let names = surface(&Path::new(ROOT).join("mbs-derive/src/lib.rs"), "");
    for known in ["compile", "Analysis", "builder::Mechanism", "expr::Graph", "optimise::FunctionKind", "model::Unit"] {
        assert!(names.contains(known), "{known} is not among {names:?}");
    }
    assert!(names.len() <= 80, "{}: {names:#?}", names.len());
}
