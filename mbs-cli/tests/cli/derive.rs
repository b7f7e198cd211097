//! `mbs derive`.

use serde_json::Value;

use crate::{Workshop, keys};

#[test]
fn two_runs_give_the_same_bytes() {
    let workshop = Workshop::new();
    for model in ["pendulum.mbs", "chain.mbs"] {
        for emit in ["rust", "c", "cpp", "cuda", "opencl", "python", "js", "matlab", "latex", "json"] {
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

/// Kept apart from the code of all functions.
#[test]
fn functions_may_be_chosen() {
    let workshop = Workshop::new();
    for (emit, begins) in [("rust", "pub fn "), ("js", "  ")] {
        let all = workshop.good(&["derive", "chain.mbs", "--emit", emit]);
        let some = workshop.good(&["derive", "chain.mbs", "--emit", emit, "--only", "bias,forward_dynamics"]);
        let has = |code: &str, name: &str| code.lines().any(|line| line.contains(&format!("{begins}{name}(")));
        for (name, is_chosen) in [("bias", true), ("forward_dynamics", true), ("linearize", false), ("gravity", false)]
        {
            assert!(has(&all, name) && has(&some, name) == is_chosen, "{emit}: {name}\n{some}");
        }
        assert!(some.len() < all.len());
    }
    let report = workshop.bad(&["derive", "chain.mbs", "--only", "bios"]);
    assert!(report.contains("`bios`") && report.contains("bias"), "{report}");
    let report = workshop.misused(&["derive", "chain.mbs", "--only", "bias", "--emit", "json"]);
    assert_eq!(report, "error: `--emit json` is of all functions: leave `--only` out\n");
}

/// Kept apart from the code with the runtime's own.
#[test]
fn sines_may_be_those_of_the_library() {
    let workshop = Workshop::new();
    let own = workshop.good(&["derive", "pendulum.mbs", "--emit", "js"]);
    assert_eq!(workshop.good(&["derive", "pendulum.mbs", "--emit", "js", "--trigonometry", "polynomials"]), own);
    let library = workshop.good(&["derive", "pendulum.mbs", "--emit", "js", "--trigonometry", "library"]);
    assert!(library.contains("Math.sin(theta)") && !own.contains("Math.sin(theta)"), "{library}");
    let header = workshop.good(&["derive", "pendulum.mbs", "--emit", "c", "--trigonometry", "library"]);
    assert!(header.contains("#define MBS_LIBRARY_TRIGONOMETRY"), "{header}");
    let report = workshop.misused(&["derive", "pendulum.mbs", "--emit", "latex", "--trigonometry", "library"]);
    assert_eq!(report, "error: `--emit latex` computes no sines: leave `--trigonometry` out\n");
}

#[test]
fn json_holds_every_program() {
    let workshop = Workshop::new();
    let json: Value = serde_json::from_str(&workshop.good(&["derive", "chain.mbs", "--emit", "json"])).unwrap();
    let expected = ["mechanism", "coordinates", "parameters", "inputs", "depends_on_time", "constructor", "functions"];
    assert_eq!(keys(&json)[..7], expected);
    assert_eq!(keys(&json)[7..], ["prescribed", "constraints", "elimination", "graph", "splines"]);
    assert_eq!(json["parameters"][0]["defaults"], serde_json::json!([1.0, 2.0]));
    let mass_matrix = &json["functions"]["mass_matrix"];
    assert_eq!(mass_matrix["returns"][0]["shape"], serde_json::json!(["symmetric", 2]));
    assert_eq!(mass_matrix["results"].as_array().unwrap().len(), 3);
}

#[test]
fn json_holds_the_samples_of_tables() {
    let workshop = Workshop::new();
    workshop.write(
        "table.mbs",
        "mechanism A { param m: kg = 1; coord x: m; kinetic += 1/2*m*dt(x)^2; const at[3]: m = [0, 1, 3];
         const pull[3]: N = [0, 2, 2]; force x += -table(x, at, pull) - table(2*x, at, pull); }",
    );
    let json: Value = serde_json::from_str(&workshop.good(&["derive", "table.mbs", "--emit", "json"])).unwrap();
    let rows = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [1.0, 2.0, 0.0], [3.0, 2.0, 0.0]];
    assert_eq!(json["splines"], serde_json::json!([{ "places": [0.0, 1.0, 3.0], "rows": rows }]));
    let instructions = json["functions"]["generalized_force"]["instructions"].as_array().unwrap();
    assert_eq!(
        instructions.iter().filter(|i| i[0] == "spline" && i[1] == 0 && i[2] == 0).count(),
        2,
        "{instructions:?}"
    );
    let nodes = json["graph"]["nodes"].as_array().unwrap();
    assert_eq!(nodes.iter().filter(|node| node["operation"] == "spline" && node["order"] == 1).count(), 2, "slopes");
}

#[test]
fn latex_is_a_page_of_a_textbook() {
    let workshop = Workshop::new();
    let page = workshop.good(&["derive", "pendulum.mbs", "--emit", "latex"]);
    assert!(page.contains("\\ddot{\\theta}"), "{page}");
    assert!(page.starts_with("\\documentclass{article}") && page.ends_with("\\end{document}\n"), "{page}");
    assert_eq!(page.matches('{').count(), page.matches('}').count());
}

#[test]
fn what_cannot_be_written_is_not_begun() {
    let workshop = Workshop::new();
    std::fs::create_dir(workshop.path("folder")).unwrap();
    let report = workshop.bad(&["derive", "pendulum.mbs", "--out", "missing/pendulum.rs"]);
    assert!(report.starts_with("error: cannot write missing/pendulum.rs: "), "{report}");
    assert!(report.contains("; make the folder first, or name another"), "{report}");
    let report = workshop.bad(&["derive", "pendulum.mbs", "--out", "folder"]);
    assert!(report.starts_with("error: cannot write folder: "), "{report}");
}
