//! `mbs derive`.

use serde_json::Value;

use crate::{Workshop, keys};

#[test]
fn two_runs_give_the_same_bytes() {
    let workshop = Workshop::new();
    for model in ["pendulum.mbs", "chain.mbs"] {
        for emit in ["rust", "json"] {
            let first = workshop.good(&["derive", model, "--emit", emit]);
            let second = workshop.good(&["derive", model, "--emit", emit, "--out", "out.txt"]);
            assert_eq!(second, "");
            assert_eq!(workshop.read("out.txt"), first);
        }
    }
    assert_eq!(workshop.files(), ["chain.mbs", "out.txt", "pendulum.mbs"]);
}

#[test]
fn rust_names_its_source() {
    let workshop = Workshop::new();
    let code = workshop.good(&["derive", "pendulum.mbs"]);
    assert!(code.lines().next().unwrap().contains("pendulum.mbs"), "{code}");
    assert!(code.contains("struct Pendulum"), "{code}");
}

#[test]
fn json_holds_every_program() {
    let workshop = Workshop::new();
    let json: Value = serde_json::from_str(&workshop.good(&["derive", "chain.mbs", "--emit", "json"])).unwrap();
    let expected = ["mechanism", "coordinates", "parameters", "inputs", "depends_on_time", "constructor", "functions"];
    assert_eq!(keys(&json)[..7], expected);
    assert_eq!(keys(&json)[7..], ["prescribed", "constraints", "graph"]);
    assert_eq!(json["parameters"][0]["defaults"], serde_json::json!([1.0, 2.0]));
    let mass_matrix = &json["functions"]["mass_matrix"];
    assert_eq!(mass_matrix["returns"][0]["shape"], serde_json::json!(["symmetric", 2]));
    assert_eq!(mass_matrix["results"].as_array().unwrap().len(), 3);
}

#[test]
fn latex_is_a_page_of_a_textbook() {
    let workshop = Workshop::new();
    let page = workshop.good(&["derive", "pendulum.mbs", "--emit", "latex"]);
    assert!(page.contains("\\ddot{\\theta}"), "{page}");
    assert_eq!(page.matches('{').count(), page.matches('}').count());
}

#[test]
fn what_cannot_be_written_is_not_begun() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("folder")).unwrap();
    let report = workshop.bad(&["derive", "pendulum.mbs", "--out", "missing/pendulum.rs"]);
    assert!(report.starts_with("error: cannot write missing/pendulum.rs: "), "{report}");
    let report = workshop.bad(&["derive", "pendulum.mbs", "--out", "folder"]);
    assert!(report.starts_with("error: cannot write folder: "), "{report}");
}
