//! `mbs ops`.

use serde_json::Value;

use crate::{Workshop, keys};

#[test]
fn json_has_the_shape_of_the_contract() {
    let workshop = Workshop::new();
    let json: Value = serde_json::from_str(&workshop.good(&["ops", "pendulum.mbs", "--json"])).unwrap();
    assert_eq!(keys(&json), ["mechanism", "derive_seconds", "functions"]);
    assert_eq!(json["mechanism"], "Pendulum");
    assert!((0.0..60.0).contains(&json["derive_seconds"].as_f64().unwrap()));
    let required = [
        "mass_matrix",
        "coriolis_matrix",
        "gravity",
        "bias",
        "inverse_dynamics",
        "forward_dynamics",
        "linearize",
        "inverse_dynamics_jacobian",
    ];
    for name in required {
        let counts = &json["functions"][name];
        assert_eq!(keys(counts), ["add", "mul", "div", "sqrt", "sincos", "other", "flops"], "{name}");
        let count = |key: &str| counts[key].as_u64().unwrap();
        assert_eq!(count("flops"), count("add") + count("mul"), "{name}");
    }
    // m l² is computed once, by the constructor; m g l too, and multiplied by one sine.
    assert_eq!(json["functions"]["mass_matrix"]["flops"], 0);
    assert_eq!(json["functions"]["gravity"]["mul"], 1);
    assert_eq!(json["functions"]["gravity"]["sincos"], 1);
}

#[test]
fn the_table_is_aligned() {
    let workshop = Workshop::new();
    let table = workshop.good(&["ops", "chain.mbs"]);
    let rows: Vec<&str> = table.lines().skip(2).collect();
    assert!(table.starts_with("Chain: 2 coordinates, derived in "), "{table}");
    assert!(rows[0].starts_with("function ") && rows[0].ends_with(" flops"), "{table}");
    assert!(rows.iter().any(|row| row.starts_with("forward_dynamics ")), "{table}");
    assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{table}");
}

/// What it costs not to multiply out a spring's stretch is told; where nothing is spent there is no such column.
#[test]
fn explanations_tell_what_is_spent_on_digits() {
    let workshop = Workshop::new();
    let sprung = "mechanism Sprung { param m: kg = 1; param k: N/m = 1e9; param rest: m = 0.1; param l: m = 0.5; coord a: rad; \
                  let tip = [l*sin(a), 0, -l*cos(a)]; kinetic += particle(m, tip); \
                  potential += spring(k, hypot(tip.x - l/5, tip.z + l), rest); }";
    workshop.write("sprung.mbs", sprung);
    let table = workshop.good(&["ops", "sprung.mbs", "--explain"]);
    assert!(table.contains("spent on digits") && table.contains("wrong where r is near rest"), "{table}");
    assert!(!workshop.good(&["ops", "pendulum.mbs", "--explain"]).contains("spent on digits"));
}

/// Derivatives of long chains have one route, the recursion over their links, and stay in their columns.
#[test]
fn explanations_of_long_chains_have_the_recursion() {
    let workshop = Workshop::new();
    let chain = "mechanism Chain { coord q[31]: rad; gravity([0, -9.81 m/s^2, 0]); let mut link = world; for i in 0..31 { \
                 link = link*rot_z(q[i])*translation([1 m, 0 m, 0 m]); kinetic += particle(1 kg, link.origin()); } }";
    workshop.write("chain.mbs", chain);
    let table = workshop.good(&["ops", "chain.mbs", "--explain"]);
    let rows: Vec<&str> =
        table.lines().skip_while(|line| !line.starts_with("function  ") || line.ends_with("flops")).collect();
    let row = rows.iter().find(|row| row.starts_with("inverse_dynamics_jacobian")).unwrap();
    assert!(row.contains(" recursive ") && row.len() == rows[0].len(), "{table}");
}

/// A pendulum's functions are right to a few units in the last place, but for the digits that a far angle has lost.
#[cfg(feature = "accuracy")]
#[test]
fn accuracy_is_measured_in_units_of_the_last_place() {
    let workshop = Workshop::new();
    let json: Value = serde_json::from_str(&workshop.good(&["ops", "pendulum.mbs", "--accuracy", "--json"])).unwrap();
    let functions = json["accuracy"].as_object().unwrap();
    assert_eq!(functions.len(), json["functions"].as_object().unwrap().len());
    for (name, function) in functions {
        assert_eq!(keys(function), ["ulp", "condition", "ratio", "at", "numbers", "states"], "{name}");
        let number = |key: &str| function[key].as_f64().unwrap();
        assert!(number("ratio") <= 8.0 && number("ulp") <= 8.0 * number("condition").max(1.0), "{name}: {function}");
        assert!(function["states"].as_u64().unwrap() >= 3, "{name}");
    }
    assert!(functions.values().any(|function| function["ulp"].as_f64().unwrap() > 0.0));
    let table = workshop.good(&["ops", "pendulum.mbs", "--accuracy"]);
    assert!(table.contains("error [ulp]") && table.contains("forward_dynamics "), "{table}");
}
