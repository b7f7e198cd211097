//! What tables say in numbers: those that are made, those that are there already, and those of polynomials.

use serde_json::Value;

use crate::Outcome;
use crate::sweep::{PLAN, workshop};

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

/// The same numbers, whether the table is made or read; of the same plan alone.
#[test]
fn tables_that_are_there_are_read() {
    let workshop = workshop();
    let made = json(&workshop.good(&["sweep", "plan.toml", "--summary", "--json"]));
    let read = json(&workshop.good(&["sweep", "plan.toml", "--summary", "--json"]));
    assert_eq!((&made["summary"], &read["read"]), (&read["summary"], &Value::from("plan.csv")));
    assert!(workshop.good(&["sweep", "plan.toml", "--summary"]).starts_with("plan.csv: 40 members read\n"));
    let plotted = json(&workshop.good(&["plot", "plan.csv", "--summary", "--json", "--columns", "quarter,energy"]));
    assert_eq!(plotted["summary"]["quarter"], made["summary"]["quarter"]);
    assert_eq!(plotted["summary"].as_object().unwrap().len(), 2);
    assert!(workshop.good(&["plot", "plan.csv", "--summary"]).starts_with("40 members, 0 stopped\n"));
    assert_eq!(workshop.mbs(&["plot", "plan.csv"]).code, 2, "neither a figure nor a summary");
    workshop.write("plan.toml", PLAN.replace("seed = 3", "seed = 4"));
    let report = workshop.bad(&["sweep", "plan.toml", "--summary"]);
    assert!(report.starts_with("error: plan.csv is a table of another run: not of the plan as it is now;"), "{report}");
    assert!(workshop.bad(&["sweep", "plan.toml"]).starts_with("error: plan.csv is there already; "));
}

#[cfg(feature = "parquet")]
#[test]
fn tables_of_parquet_are_read() {
    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml", "--out", "a.csv"]);
    workshop.good(&["sweep", "plan.toml", "--out", "a.parquet"]);
    let summary = |name: &str| json(&workshop.good(&["plot", name, "--summary", "--json"]));
    assert_eq!(summary("a.csv"), summary("a.parquet"));
    let made = json(&workshop.good(&["sweep", "plan.toml", "--out", "a.parquet", "--summary", "--json"]));
    assert_eq!(made["summary"]["quarter"], summary("a.csv")["summary"]["quarter"]);
    let drawn = |name: &str| {
        workshop.good(&["plot", name, "--out", "a.svg"]);
        workshop.read("a.svg")
    };
    assert!(drawn("a.csv") == drawn("a.parquet"));
    workshop.write("torn.parquet", "PAR1");
    assert!(workshop.bad(&["plot", "torn.parquet", "--summary"]).starts_with("error: torn.parquet: "));
}

/// `v = a √(k/m)`: lognormal, with the mean `a √(k₀/m₀) exp(σ²/8 + σ²/8)`, and half of the variance of each.
#[test]
fn polynomials_tell_means_and_sensitivities() {
    let workshop = workshop();
    let plan = PLAN
        .replace("members = 20\n", "")
        .replace("seed = 3", "seed = 3\ndesign = \"chaos\"\ndegree = 4")
        .replace("{ normal = [\"2 kg\", \"100 g\"], within = [\"1 kg\", \"3 kg\"] }", "{ lognormal = [\"2 kg\", 0.1] }")
        .replace("{ values = [\"8 N/m\", \"12 N/m\"] }", "{ lognormal = [\"8 N/m\", 0.1] }");
    workshop.write("plan.toml", &plan);
    let object = json(&workshop.good(&["sweep", "plan.toml", "--summary", "--json"]));
    let speed = &object["summary"]["greatest"];
    let number = |value: &Value| value.as_f64().unwrap();
    let mean = 0.2 * 2.0 * (0.01_f64 / 4.0).exp();
    assert!((number(&speed["mean"]) - mean).abs() < 1e-8, "{speed}");
    assert!((number(&speed["deviation"]) / mean - (0.005_f64).exp_m1().sqrt()).abs() < 1e-6, "{speed}");
    assert!((number(&speed["quantiles"][1]["value"]) - 0.4).abs() < 1e-4, "{speed}");
    for name in ["m", "k"] {
        assert!((number(&speed["indices"][name]["first"]["value"]) - 0.5).abs() < 2e-3, "{speed}");
    }
    assert!(number(&speed["highest"]) < 1e-6 && speed["degree"] == 4 && object["members"] == 25, "{speed}");
    // What no member has has no polynomial.
    assert_eq!(object["summary"]["never"]["mean"], Value::Null);
    workshop.write("plan.toml", plan.replace("degree = 4", "degree = 4\ncorrelation = [[\"m\", \"k\", 0.5]]"));
    let Outcome { code, stderr, .. } = workshop.mbs(&["sweep", "plan.toml", "--out", "b.csv"]);
    assert!(code == 1 && stderr.contains("the design `chaos` is for independent variables"), "{stderr}");
}
