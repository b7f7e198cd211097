//! Dispersions as outside programs call them: what two ways say of the same.

use crate::support::{figure, good, json, number, numbers, refused, run};

const DOCKING: &str = env!("CARGO_BIN_EXE_docking_dispersions");
const PLATFORM: &str = env!("CARGO_BIN_EXE_platform_sensitivity");
const SWEEP: &str = env!("CARGO_BIN_EXE_landing_sweep");

/// Over 3 km curvature is thousandths: deviations agree within four of their own errors, `4/√(2 N)`.
#[test]
fn linear_covariance_is_that_of_flights() {
    let found = json(&good(DOCKING, &["--json", "--members", "4000"]));
    assert_eq!(found["members"], 4000);
    for name in ["miss_x", "miss_y", "miss_z", "miss_v_x", "miss_v_y", "miss_v_z"] {
        let of = &found[name];
        let (linear, flown) = (number(&of["sd_linear"]), number(&of["sd"]));
        assert!((flown / linear - 1.0).abs() < 4.0 / 8000.0_f64.sqrt(), "{name}: {of}");
        assert!(number(&of["mean"]).abs() < 0.2 * linear, "{name}: {of}");
    }
    // Four deviations of a share of 4000.
    assert!((number(&found["within_95"]) - 0.95).abs() < 0.014, "{found}");
}

/// Thirty motions in dual numbers say of the mean square what hundreds say: the shares of the three numbers that decide
/// are within the bounds of their indices.
#[test]
fn gradients_predict_indices() {
    let found = json(&good(PLATFORM, &["--json", "--rows", "16"]));
    for quantity in ["rms", "peak"] {
        let parameters = found[quantity]["parameters"].as_object().unwrap();
        assert_eq!(parameters.len(), 30);
        let shares: f64 = parameters.values().map(|of| number(&of["by_gradient"])).sum();
        assert!((shares - 1.0).abs() < 1e-12, "{shares}");
    }
    let of = &found["rms"];
    // A deviation of 16 is known to a fifth.
    let ratio = number(&of["sd"]) / number(&of["sd_by_gradient"]);
    assert!((0.6..1.4).contains(&ratio), "{ratio}");
    for (name, least) in [("payload_mass", 0.5), ("platform_mass", 0.3), ("piston_mass", 0.03)] {
        let of = &of["parameters"][name];
        let (share, bounds) = (number(&of["by_gradient"]), numbers(&of["total_ci95"]));
        assert!(share > least && bounds[0] < share && share < bounds[1], "{name}: {of}");
    }
}

#[test]
fn figures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    good(DOCKING, &["--members", "50", "--out", out]);
    good(PLATFORM, &["--rows", "4", "--out", out]);
    good(SWEEP, &["--members", "12", "--out", out]);
    let texts = [
        ("docking_dispersions", "Where 50 of 50 flights miss"),
        ("platform_sensitivity", "Which numbers decide"),
        ("landings", "12 landings"),
    ];
    for (name, text) in texts {
        assert!(figure(folder.path(), name).contains(text), "{name}");
    }
}

/// What a plan says of motions would be in vain; a plan that is not there is named.
#[test]
fn what_a_program_would_not_do_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.toml");
    let told = || {
        let output = run(SWEEP, &["--plan", plan.to_str().unwrap()]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0));
        String::from_utf8(output.stderr).unwrap()
    };
    let missing = told();
    assert!(missing.contains("plan.toml: "), "{missing}");
    for (name, text) in [
        ("mechanism", "mechanism = \"pendulum.mbs\""),
        ("parameters", "[parameters]\ngain = \"2 N\""),
        ("inputs", "[inputs]\ntau = \"0\""),
        ("signals", "[signals]\nsea = \"0\""),
        ("motion", "[motion]\nduration = \"1 s\""),
        ("quantities", "[quantities]\nhighest = { max = \"z\" }"),
    ] {
        std::fs::write(&plan, format!("{text}\n[vary]\nmass = {{ uniform = [39, 41] }}\n")).unwrap();
        let (refused, line) = (told(), 1 + text.matches('\n').count());
        let expected = format!("plan.toml:{line}:");
        assert!(refused.contains(&expected) && refused.contains(&format!("has no `{name}`")), "{refused}");
    }
}

#[test]
fn wrong_usage_ends_with_2() {
    refused(DOCKING, &["--members", "1"]);
    refused(PLATFORM, &["--rows", "many"]);
}
