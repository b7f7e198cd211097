//! `mbs import`, by the worked example of docs/import.md.

use crate::Workshop;

/// The page, which a package of mbs-cli alone does not have.
fn manual() -> Option<String> {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/import.md")).ok()
}

/// The block of the manual whose fence names a file.
fn block(name: &str) -> String {
    let manual = manual().expect("the page is there");
    let (_, rest) = manual.split_once(&format!(" {name}\n")).expect("the block is there");
    rest.split("```").next().unwrap().to_string()
}

/// With the files of the page, if there is the page.
fn workshop() -> Option<Workshop> {
    manual()?;
    let workshop = Workshop::new();
    workshop.write("crane.urdf", block("crane.urdf"));
    workshop.write("held_crane.mbs", block("held_crane.mbs"));
    Some(workshop)
}

#[test]
fn the_worked_example_is_what_is_printed() {
    let Some(workshop) = workshop() else { return };
    assert_eq!(workshop.good(&["import", "crane.urdf"]), block("crane.mbs"));
    assert_eq!(workshop.good(&["import", "crane.urdf", "--out", "crane.mbs"]), "");
    assert_eq!(workshop.read("crane.mbs"), block("crane.mbs"));
    assert!(workshop.good(&["check", "crane.mbs"]).starts_with("Crane: 1 coordinate"));
    // The moment of inertia about the hinge, and with the load: J + m c² = 16.2 + 40·1.1², and 15·2.2² more.
    let mass = |model: &str| {
        workshop.eval(model, r#"{"q": [0.4], "qd": [0], "u": [0]}"#)["mass_matrix"][0][0].as_f64().unwrap()
    };
    assert!((mass("crane.mbs") - 64.6).abs() < 1e-12);
    assert!((mass("held_crane.mbs") - 137.2).abs() < 1e-12);
}

#[test]
fn imported_robots_move_with_inputs_by_formulas() {
    let Some(workshop) = workshop() else { return };
    let state = r#"{"q": [0.4]}"#;
    let arguments =
        ["simulate", "held_crane.mbs", "--state", state, "--t-end", "0.1", "--input", "luff_torque=3*sin(2*t)"];
    assert!(workshop.good(&arguments).starts_with("t,luff"));
    // Warnings about the robot's file stay.
    workshop.write("crane.urdf", block("crane.urdf").replace("rpy=\"0 1.57079632679 0\"", "rpy=\"0 90 0\""));
    for count in [arguments.len() - 2, arguments.len()] {
        let stderr = workshop.mbs(&arguments[..count]).stderr;
        assert!(stderr.starts_with("warning[MBS0310]: crane.urdf:10:29: the attitude of a visual"), "{stderr}");
    }
}

#[test]
fn options_choose_how_it_is_written() {
    let Some(workshop) = workshop() else { return };
    assert!(workshop.good(&["import", "crane.urdf", "--parameters"]).contains("    param boom_mass: kg = 40;\n"));
    let free = workshop.good(&["import", "crane.urdf", "--floating", "--angles"]);
    assert!(free.contains("    coord column_joint_attitude[3]: rad;\n"), "{free}");
}

/// Nothing is half-written, and nothing that is there is lost.
#[test]
fn bad_files_are_reported_and_write_nothing() {
    let Some(workshop) = workshop() else { return };
    workshop.write("bad.urdf", block("crane.urdf").replace("izz=\"16.2\"", "izz=\"160\""));
    workshop.write("crane.mbs", "what was there");
    let report = workshop.bad(&["import", "bad.urdf", "--out", "crane.mbs"]);
    assert!(
        report.starts_with("error[MBS0310]: no body has the inertia of the link `boom`")
            && report.contains(" --> bad.urdf:4:5\n"),
        "{report}"
    );
    assert_eq!(workshop.read("crane.mbs"), "what was there");
    let report = workshop.bad(&["import", "crane.urdf", "--out", "crane.urdf"]);
    assert!(report.contains("would overwrite a file in use"), "{report}");
    assert!(workshop.bad(&["import", "none.urdf"]).starts_with("error: cannot read none.urdf: "));
    assert!(workshop.bad(&["import", "."]).starts_with("error: cannot read .: "));
    workshop.write("latin.urdf", b"<robot name=\"\xe4\"/>");
    assert!(workshop.bad(&["import", "latin.urdf"]).starts_with("error[MBS01"));
    workshop.write("loose.mbs", "import \"bad.urdf\";\nmechanism A { }\n");
    let report = workshop.bad(&["check", "loose.mbs"]);
    assert!(
        report.starts_with(
            "error[MBS0301]: cannot import `bad.urdf`: bad.urdf:4:5: no body has the inertia of the link `boom`"
        ),
        "{report}"
    );
}

/// Meshes are looked for, and their paths are seen from the folder of what is written.
#[test]
fn meshes_are_found_in_folders_above() {
    let Some(workshop) = workshop() else { return };
    for folder in ["crane_description/urdf", "crane_description/meshes", "out"] {
        std::fs::create_dir_all(workshop.path(folder)).unwrap();
    }
    let mesh = |path: &str| {
        let crane = block("crane.urdf");
        let (before, rest) = crane.split_once("<cylinder").unwrap();
        let (_, after) = rest.split_once("/>").unwrap();
        format!("{before}<mesh filename=\"{path}\" scale=\"0.001 0.001 0.001\"/>{after}")
    };
    workshop.write("crane_description/urdf/crane.urdf", mesh("package://crane_description/meshes/boom.stl"));
    workshop.write("crane_description/meshes/boom.stl", "solid");
    workshop.good(&["import", "crane_description/urdf/crane.urdf", "--out", "out/crane.mbs"]);
    let text = workshop.read("out/crane.mbs");
    assert!(text.contains("+= mesh(\"../crane_description/meshes/boom.stl\", 0.001);\n"), "{text}");
    workshop.write("crane_description/urdf/crane.urdf", mesh("../meshes/mast.stl"));
    let outcome = workshop.mbs(&["import", "crane_description/urdf/crane.urdf"]);
    assert_eq!(outcome.code, 0);
    let expected = "warning[MBS0310]: the mesh `../meshes/mast.stl` of the link `boom` is not drawn\n  --> crane_description/urdf/crane.urdf:11:";
    assert!(outcome.stderr.starts_with(expected), "{}", outcome.stderr);
}
