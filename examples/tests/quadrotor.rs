//! The quadrotor's examples as outside programs call them: what they print and what they write.

mod support;

use serde_json::Value;
use support::{good, json, keys, numbers, run};

const LANDING: &str = env!("CARGO_BIN_EXE_quadrotor_landing");
const MONTE_CARLO: &str = env!("CARGO_BIN_EXE_landing_monte_carlo");

/// Touchdown time \[s\], relative velocity \[m/s\] and horizontal offset \[m\] of `quad.landing` of the reference values.
const LANDINGS: [(&str, &str, [f64; 3]); 4] = [
    ("I", "exact", [13.254_642_785_856_516, -0.200_219_070_194_215_8, 8.003_225_359_706_338e-8]),
    ("I", "small_angle", [13.254_642_806_506_784, -0.200_219_079_165_423_36, 8.006_023_104_986_414e-8]),
    ("II", "exact", [13.253_187_507_321_867, -0.198_488_288_738_778_1, 3.621_129_885_747_774e-5]),
    ("II", "small_angle", [13.253_187_511_549_939, -0.198_488_290_675_218_9, 3.673_239_971_465_485e-5]),
];

#[test]
fn landings_are_those_of_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(LANDING, &["--json", "--out", folder.path().to_str().unwrap()]));
    assert_eq!(keys(&found), ["I", "II"]);
    for (case, plant, expected) in LANDINGS {
        let end = &found[case][plant];
        let names = ["touchdown_time", "relative_velocity", "horizontal_offset"];
        for ((name, expected), tolerance) in names.iter().zip(expected).zip([1e-5, 1e-5, 1e-6]) {
            let found = numbers(&end[name])[0];
            assert!((found - expected).abs() <= tolerance, "{case} {plant} {name}: {found}, not {expected}");
        }
        for name in ["max_phi_deg", "max_theta_deg", "settling_time", "thrust_min", "thrust_max"] {
            assert!(numbers(&end[name])[0] > 0.0, "{case} {plant} {name}");
        }
    }
    for number in 2..=9 {
        for extension in ["svg", "png"] {
            let figure = folder.path().join(format!("figure_5_{number}.{extension}"));
            assert!(figure.metadata().unwrap().len() > 1000, "{}", figure.display());
        }
    }
}

#[test]
fn members_do_not_depend_on_the_number_of_threads() {
    let with = |threads| json(&good(MONTE_CARLO, &["--json", "--members", "24", "--threads", threads]));
    let (one, two) = (with("1"), with("2"));
    assert_eq!(one, two);
    assert_eq!((&one["members"], &one["failed"]), (&Value::from(24), &Value::from(0)));
    for name in ["touchdown_time", "relative_velocity", "horizontal_offset"] {
        let [mean, deviation] = ["mean", "sd"].map(|key| numbers(&one[name][key])[0]);
        let [low, high] = numbers(&one[name]["ci95"])[..] else { panic!("{name}") };
        assert!(low < mean && mean < high && deviation > 0.0, "{name}");
    }
    assert_ne!(one["digest"], json(&good(MONTE_CARLO, &["--json", "--members", "23"]))["digest"]);
}

#[test]
fn wrong_usage_ends_with_2() {
    for arguments in [["--members", "1"], ["--members", "many"], ["--fast", "--json"]] {
        let output = run(MONTE_CARLO, &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(output.stdout.is_empty() && output.stderr.starts_with(b"error: "));
    }
}
