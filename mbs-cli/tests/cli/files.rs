//! Outputs never overwrite what was read, nor each other.

use crate::{Outcome, Workshop};

const IMPORTING: &str = "import \"shared/steel.mbs\";\n\
                         mechanism Bar { const volume: m^3 = 1; coord x: m; kinetic += 1/2*density*volume*dt(x)^2; }";

/// A workshop with a mechanism that imports a file, a state, and another folder.
fn workshop() -> Workshop {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("shared")).unwrap();
    workshop.write("shared/steel.mbs", "const density: kg/m^3 = 7850;\n");
    workshop.write("bar.mbs", IMPORTING);
    workshop.write("state.json", "{\"q\": [0]}");
    workshop
}

/// Runs what must be refused with these words, all files as before.
fn refused(workshop: &Workshop, arguments: &[&str], words: &[&str]) {
    let names = ["pendulum.mbs", "bar.mbs", "shared/steel.mbs", "state.json"];
    let before = names.map(|name| workshop.read(name));
    let report = workshop.bad(arguments);
    assert_eq!(report.lines().count(), 1, "{report}");
    for word in words {
        assert!(report.contains(word), "{word}: {report}");
    }
    assert_eq!(names.map(|name| workshop.read(name)), before);
}

#[test]
fn code_does_not_replace_the_mechanism() {
    let workshop = workshop();
    for out in ["pendulum.mbs", "./pendulum.mbs", "shared/../pendulum.mbs"] {
        for emit in ["rust", "latex", "json"] {
            let words = ["--out ", out, "the mechanism pendulum.mbs was read"];
            refused(&workshop, &["derive", "pendulum.mbs", "--emit", emit, "--out", out], &words);
        }
    }
    let absolute = workshop.path("pendulum.mbs").display().to_string();
    refused(&workshop, &["derive", "pendulum.mbs", "--out", &absolute], &["was read"]);
    refused(&workshop, &["derive", &absolute, "--out", "pendulum.mbs"], &["was read"]);
    let words = ["--out shared/steel.mbs", "the import shared/steel.mbs was read"];
    refused(&workshop, &["derive", "bar.mbs", "--out", "shared/steel.mbs"], &words);
}

#[cfg(unix)]
#[test]
fn links_are_what_they_lead_to() {
    use std::os::unix::fs::symlink;
    let workshop = workshop();
    symlink("pendulum.mbs", workshop.path("link.rs")).unwrap();
    symlink("link.rs", workshop.path("link_of_a_link.rs")).unwrap();
    symlink("shared", workshop.path("folder")).unwrap();
    std::fs::hard_link(workshop.path("pendulum.mbs"), workshop.path("hard.rs")).unwrap();
    for out in ["link.rs", "link_of_a_link.rs", "hard.rs", "folder/../pendulum.mbs"] {
        refused(&workshop, &["derive", "pendulum.mbs", "--out", out], &["the mechanism pendulum.mbs was read"]);
        refused(&workshop, &["derive", out, "--out", "pendulum.mbs"], &["was read"]);
    }
    refused(&workshop, &["derive", "bar.mbs", "--out", "folder/steel.mbs"], &["the import shared/steel.mbs was read"]);
    // A link to a file of its own is written through, and stays a link; so is one that leads to nothing yet.
    workshop.write("old.rs", "");
    symlink("old.rs", workshop.path("through.rs")).unwrap();
    symlink("new.rs", workshop.path("dangling.rs")).unwrap();
    for (link, file) in [("through.rs", "old.rs"), ("dangling.rs", "new.rs")] {
        workshop.good(&["derive", "pendulum.mbs", "--out", link]);
        assert!(workshop.path(link).is_symlink());
        assert!(workshop.read(file).contains("struct Pendulum"));
    }
}

#[test]
fn motions_replace_neither_the_mechanism_nor_the_state() {
    let workshop = workshop();
    std::fs::copy(workshop.path("pendulum.mbs"), workshop.path("pendulum.svg")).unwrap();
    std::fs::copy(workshop.path("state.json"), workshop.path("state.png")).unwrap();
    let run = |model: &'static str, state: &'static str, rest: &[&'static str]| {
        [&["simulate", model, "--state", state, "--t-end", "1"], rest].concat()
    };
    let state = "{\"q\": [0]}";
    refused(
        &workshop,
        &run("pendulum.mbs", state, &["--csv", "./pendulum.mbs"]),
        &["--csv ./pendulum.mbs", "was read"],
    );
    refused(&workshop, &run("pendulum.svg", state, &["--plot", "pendulum.svg"]), &["--plot pendulum.svg", "was read"]);
    refused(&workshop, &run("bar.mbs", state, &["--csv", "shared/steel.mbs"]), &["the import shared/steel.mbs"]);
    let words = ["--csv shared/../state.json", "--state state.json was read"];
    refused(&workshop, &run("pendulum.mbs", "state.json", &["--csv", "shared/../state.json"]), &words);
    refused(&workshop, &run("pendulum.mbs", "state.png", &["--plot", "state.png"]), &["--state state.png was read"]);
}

#[test]
fn two_outputs_are_two_files() {
    let workshop = workshop();
    let run =
        |csv, plot| ["simulate", "pendulum.mbs", "--state", "state.json", "--t-end", "1", "--csv", csv, "--plot", plot];
    for (csv, plot) in [("motion.svg", "motion.svg"), ("motion.svg", "./motion.svg"), ("shared/../a.svg", "a.svg")] {
        refused(&workshop, &run(csv, plot), &["--plot", &format!("--csv {csv} is the same file")]);
    }
    workshop.write("old.svg", "");
    std::fs::hard_link(workshop.path("old.svg"), workshop.path("older.svg")).unwrap();
    refused(&workshop, &run("older.svg", "old.svg"), &["--csv older.svg is the same file"]);
}

#[cfg(unix)]
#[test]
fn a_state_from_standard_input_is_a_file_that_is_read() {
    let workshop = workshop();
    for state in ["-", "/dev/stdin"] {
        let run = ["simulate", "pendulum.mbs", "--state", state, "--t-end", "1", "--csv", "state.json"];
        let input = std::fs::File::open(workshop.path("state.json")).unwrap();
        let output = crate::command(workshop.0.path(), &run).stdin(input).output().unwrap();
        let report = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && report.contains("was read"), "{report}");
        assert_eq!(workshop.read("state.json"), "{\"q\": [0]}");
    }
}

/// `-` is standard input for states; as an output, or a mechanism, it would be a file of this name.
#[test]
fn a_file_called_by_a_dash_is_hardly_meant() {
    let workshop = workshop();
    let run = ["simulate", "pendulum.mbs", "--state", "state.json", "--t-end", "1", "--csv", "-"];
    for (arguments, option) in
        [(&run[..], "--csv"), (&["derive", "pendulum.mbs", "--emit", "c", "--out", "-"], "--out")]
    {
        let report = workshop.misused(arguments);
        assert!(report.starts_with(&format!("error: {option} is the name of a file: ")), "{report}");
    }
    for arguments in [&["check", "-"][..], &["eval", "-", "--state", "state.json"]] {
        assert!(workshop.misused(arguments).starts_with("error: a mechanism is read from a file"));
    }
    workshop.good(&["derive", "pendulum.mbs", "--emit", "c", "--out", "./-"]);
    assert!(workshop.read("-").contains("pendulum_forward_dynamics"));
}

/// A derivation that would fail is not begun where its output is refused.
#[test]
fn outputs_are_checked_first() {
    let workshop = workshop();
    workshop.write("wrong.mbs", "mechanism Wrong { }");
    let Outcome { code, stderr, .. } = workshop.mbs(&["derive", "wrong.mbs", "--out", "wrong.mbs"]);
    assert!(
        code == 1 && stderr.contains("the mechanism wrong.mbs was read") && stderr.lines().count() == 1,
        "{stderr}"
    );
}

/// A pipe has no path.
#[cfg(target_os = "linux")]
#[test]
fn standard_output_is_a_file_to_write_to() {
    let workshop = Workshop::new();
    let text = workshop.good(&["derive", "pendulum.mbs", "--emit", "js", "--out", "/dev/stdout"]);
    assert!(text.contains("massMatrix") || text.contains("mass_matrix"), "{text}");
}
