//! `mbs new`. That the crates build, run and pass their tests is `.ci/templates`.

use std::path::Path;

use crate::{Outcome, Workshop, command};

const TEMPLATES: [&str; 6] = ["pendulum", "arm", "linkage", "vehicle", "orbit", "ensemble"];

/// States from which each template's mechanism moves for a second.
const STATES: [&str; 6] = [
    r#"{"theta": 2.5}"#,
    r#"{"q": [0, -0.5, 1.2]}"#,
    r#"{"q": [0.5, 0.9, 1.6]}"#,
    r#"{"q": [0, 0, 0, 0.1], "u": [1000, 0]}"#,
    r#"{"q": [-4.4e6, 0, 0, 3.59e8, 0, 0], "qd": [0, -13, 0, 0, 1069, 0]}"#,
    r#"{"theta": 1}"#,
];

/// The names of all files below a folder.
fn files(folder: &Path) -> Vec<String> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            match entry.is_dir() {
                true => folders.push(entry),
                false => found.push(entry.strip_prefix(folder).unwrap().to_string_lossy().into_owned()),
            }
        }
    }
    found.sort();
    found
}

/// A workshop with a checkout in it, `mbs`.
fn workshop() -> Workshop {
    let workshop = Workshop::new();
    checkout(&workshop, "mbs");
    workshop
}

/// Makes a folder look like a checkout.
pub(crate) fn checkout(workshop: &Workshop, folder: &str) {
    let version = env!("CARGO_PKG_VERSION");
    for package in ["mbs-derive", "mbs-runtime"] {
        std::fs::create_dir_all(workshop.path(&format!("{folder}/{package}"))).unwrap();
        let manifest = format!("[package]\nname = \"{package}\"\nversion = \"{version}\"\n");
        workshop.write(&format!("{folder}/{package}/Cargo.toml"), manifest);
    }
}

#[test]
fn every_template_is_a_crate_with_a_good_mechanism() {
    let workshop = workshop();
    for (template, state) in TEMPLATES.into_iter().zip(STATES) {
        let folder = format!("my-{template}");
        let said = workshop.good(&["new", &folder, "--template", template, "--path", "mbs"]);
        assert!(said.contains(&format!("the crate `{folder}`")) && said.contains("cargo run"), "{said}");
        let mut expected = vec![
            ".gitignore".to_string(),
            "Cargo.toml".to_string(),
            "build.rs".to_string(),
            format!("mechanisms/{template}.mbs"),
            "src/main.rs".to_string(),
            "src/picture.rs".to_string(),
            "tests/review.rs".to_string(),
            format!("tests/snapshots/review__{template}.snap"),
        ];
        if template == "arm" {
            expected.insert(4, "mechanisms/links.csv".to_string());
        }
        assert_eq!(files(&workshop.path(&folder)), expected);
        let manifest = workshop.read(&format!("{folder}/Cargo.toml"));
        assert!(manifest.contains(&format!("name = \"{folder}\"")) && !manifest.contains("{{"), "{manifest}");
        assert_eq!(manifest.contains("rayon"), template == "ensemble");
        assert_eq!(manifest.matches("mbs-derive = ").count(), 2, "{manifest}");

        let mechanism = format!("{folder}/mechanisms/{template}.mbs");
        let checked = workshop.good(&["check", &mechanism]);
        assert!(checked.contains("; proved at "), "{checked}");
        workshop.good(&["fmt", "--check", &mechanism]);
        let motion =
            workshop.mbs(&["simulate", &mechanism, "--state", state, "--t-end", "1", "--dt", "0.1", "--atol", "1e-6"]);
        assert_eq!((motion.code, motion.stdout.lines().count()), (0, 12), "{}", motion.stderr);
        assert!(!motion.stdout.contains("NaN"), "{}", motion.stdout);

        // The snapshot is what the test will find.
        let review = workshop.0.path().join(&folder);
        let found = command(&review, &["derive", &format!("mechanisms/{template}.mbs"), "--review"]).output().unwrap();
        let snapshot = workshop.read(&format!("{folder}/tests/snapshots/review__{template}.snap"));
        assert_eq!(snapshot.splitn(3, "---\n").nth(2).unwrap(), Outcome::of(found).stdout);
    }
}

/// Of this repository; of another checkout; of that which it is made in.
#[test]
fn a_crate_depends_on_the_checkout_at_hand() {
    let workshop = workshop();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().canonicalize().unwrap();
    if root.join("mbs-derive/Cargo.toml").exists() {
        workshop.good(&["new", "given", "--path", &root.to_string_lossy()]);
        let manifest = workshop.read("given/Cargo.toml");
        let line = format!("mbs-runtime = {{ path = \"{}\" }}", root.join("mbs-runtime").display());
        assert!(manifest.contains(&line), "{manifest}");
    }
    workshop.good(&["new", "near", "--path", "mbs"]);
    assert!(workshop.read("near/Cargo.toml").contains("mbs-derive = { path = \"../mbs/mbs-derive\" }"));
    // Within a checkout nothing need be said.
    let within = Outcome::of(command(&workshop.path("mbs"), &["new", "inside"]).output().unwrap());
    assert_eq!((within.code, within.stderr.as_str()), (0, ""));
    assert!(workshop.read("mbs/inside/Cargo.toml").contains("mbs-derive = { path = \"../mbs-derive\" }"));
    let report = workshop.bad(&["new", "lost", "--path", "given"]);
    assert!(report.starts_with("error: --path: given is no checkout of mbs "), "{report}");
    // The program alone, as it is installed.
    let program = workshop.path("mbs-alone");
    std::fs::copy(env!("CARGO_BIN_EXE_mbs"), &program).unwrap();
    let alone = std::process::Command::new(program).args(["new", "lost"]).current_dir(workshop.path("")).output();
    let alone = Outcome::of(alone.unwrap());
    let report = "error: the crate depends on a checkout of mbs, and there is none around: name it by --path DIR\n";
    assert_eq!((alone.code, alone.stderr.as_str()), (1, report));
    assert!(!workshop.path("lost").exists());
}

#[test]
fn nothing_is_half_written_and_nothing_overwritten() {
    let workshop = workshop();
    workshop.write("taken", "a file");
    std::fs::create_dir_all(workshop.path("full/src")).unwrap();
    std::fs::create_dir(workshop.path("empty")).unwrap();
    for (name, why) in [
        ("taken", "there is a file of this name"),
        ("full", "the folder is not empty"),
        ("pendulum.mbs/robot", ""),
        ("2r", "it begins with a letter"),
        ("my robot", "it is made of ASCII letters"),
        ("self", "it is a keyword of Rust"),
        ("test", "the name is taken"),
        ("mbs-runtime", "the name is taken"),
        ("..", "write the name of a new folder"),
    ] {
        let report = workshop.bad(&["new", name, "--path", "mbs"]);
        assert!(report.starts_with("error: ") && report.contains(why), "{name}: {report}");
    }
    assert_eq!(workshop.read("taken"), "a file");
    workshop.good(&["new", "empty", "--path", "mbs"]);
    assert!(workshop.path("empty/src/main.rs").exists());
    assert!(workshop.bad(&["new", "empty", "--path", "mbs"]).contains("the folder is not empty"));
    assert!(workshop.files().iter().all(|name| !name.starts_with(".mbs-")), "{:?}", workshop.files());
}
