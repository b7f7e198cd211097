//! `mbs fmt`.

use std::io::Write;
use std::process::Stdio;

use crate::{Outcome, PENDULUM, Workshop, command};

/// The pendulum as somebody in a hurry wrote it.
fn untidy() -> String {
    PENDULUM.replace("    ", "\t").replace(" = ", "=").replace("tau;\n", "tau ; // drive\n\n\n\n")
}

#[test]
fn files_are_formatted_in_place() {
    let workshop = Workshop::new();
    workshop.write("untidy.mbs", untidy());
    let tidy = PENDULUM.replace("+= tau;\n", "+= tau; // drive\n\n");
    assert_eq!(workshop.good(&["fmt", "untidy.mbs", "pendulum.mbs"]), "");
    assert_eq!(workshop.read("untidy.mbs"), tidy);
    assert_eq!(workshop.read("pendulum.mbs"), PENDULUM);
    assert_eq!(workshop.files(), ["chain.mbs", "pendulum.mbs", "untidy.mbs"], "nothing is left beside it");
    assert_eq!(workshop.good(&["fmt", "--check", "untidy.mbs", "pendulum.mbs", "chain.mbs"]), "");
}

#[test]
fn check_names_the_files_and_writes_nothing() {
    let workshop = Workshop::new();
    workshop.write("untidy.mbs", untidy());
    let report = workshop.bad(&["fmt", "--check", "untidy.mbs", "pendulum.mbs"]);
    assert_eq!(report, "error: untidy.mbs is not formatted; `mbs fmt` does it\n");
    assert_eq!(workshop.read("untidy.mbs"), untidy());
}

#[test]
fn what_cannot_be_read_is_left_alone_and_the_rest_is_formatted() {
    let workshop = Workshop::new();
    let wrong = "mechanism A {\n  coord x:m\n  kinetic += x }\n";
    workshop.write("wrong.mbs", wrong);
    workshop.write("latin.mbs", b"mechanism A { // \xe9\n}");
    workshop.write("table.csv", "a\n1\n");
    workshop.write("untidy.mbs", untidy());
    let report = workshop.bad(&["fmt", "wrong.mbs", "missing.mbs", "latin.mbs", "table.csv", ".", "untidy.mbs"]);
    for part in [
        "a `;` is missing\n --> wrong.mbs:2:12",
        "cannot read missing.mbs: ",
        "latin.mbs:1:18",
        "table.csv is a table",
        "cannot read .: ",
    ] {
        assert!(report.contains(part), "{part} is not in {report}");
    }
    assert_eq!(workshop.read("wrong.mbs"), wrong);
    assert_ne!(workshop.read("untidy.mbs"), untidy());
    // A file to be imported is one, too; an empty one is none.
    workshop.write("shared.mbs", "const a=1;");
    workshop.good(&["fmt", "shared.mbs"]);
    assert_eq!(workshop.read("shared.mbs"), "const a = 1;\n");
    workshop.write("empty.mbs", "");
    assert!(workshop.bad(&["fmt", "empty.mbs"]).contains("this file declares no mechanism"));
}

#[test]
fn standard_input_is_written_to_standard_output() {
    let workshop = Workshop::new();
    let run = |arguments: &[&str], text: &str| {
        let mut child = command(&workshop.path(""), arguments);
        let mut child = child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        Outcome::of(child.wait_with_output().unwrap())
    };
    let tidy = PENDULUM.replace("+= tau;\n", "+= tau; // drive\n\n");
    assert_eq!(run(&["fmt", "-"], &untidy()), Outcome { code: 0, stdout: tidy.clone(), stderr: String::new() });
    assert_eq!(run(&["fmt", "-", "--check"], &tidy).code, 0);
    let Outcome { code, stdout, stderr } = run(&["fmt", "-", "--check"], &untidy());
    assert_eq!((code, stdout.as_str()), (1, ""));
    assert_eq!(stderr, "error: standard input is not formatted; `mbs fmt` does it\n");
    let Outcome { code, stdout, stderr } = run(&["fmt", "-"], "mechanism {");
    assert_eq!((code, stdout.as_str()), (1, ""));
    assert!(stderr.contains(" --> standard input:1:"), "{stderr}");
}

/// A link keeps leading to the file, which keeps its permissions.
#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let workshop = Workshop::new();
    workshop.write("untidy.mbs", untidy());
    std::fs::set_permissions(workshop.path("untidy.mbs"), std::fs::Permissions::from_mode(0o640)).unwrap();
    symlink("untidy.mbs", workshop.path("link.mbs")).unwrap();
    workshop.good(&["fmt", "link.mbs"]);
    assert!(workshop.path("link.mbs").is_symlink());
    assert_ne!(workshop.read("untidy.mbs"), untidy());
    let mode = std::fs::metadata(workshop.path("untidy.mbs")).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}

#[test]
fn wrong_usage_is_told() {
    let workshop = Workshop::new();
    assert_eq!(workshop.mbs(&["fmt"]).code, 2);
    assert!(workshop.good(&["fmt", "--help"]).contains("mbs fmt pendulum.mbs"));
}
