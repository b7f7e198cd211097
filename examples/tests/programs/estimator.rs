//! The estimator example as outside programs call it: whether it errs as much as it says.

use crate::support::{figure, good, json, keys, number, numbers, refused};
use serde_json::Value;

const ESTIMATOR: &str = env!("CARGO_BIN_EXE_estimator");

/// Averages over 500 landings are within bounds about as often as these say: of 27 times, which are not independent, at
/// most one is beyond 99 %.
#[test]
fn squares_of_errors_and_innovations_are_within_their_bounds() {
    let found = json(&good(ESTIMATOR, &["--json"]));
    assert_eq!(keys(&found), ["I", "II", "assumed"]);
    for case in ["I", "II"] {
        let of_case = &found[case];
        assert_eq!(of_case["runs"], 500);
        let nees = &of_case["nees"];
        // Tables of χ² end before 7500 degrees; a normal distribution of the same mean and variance is near.
        let half = 1.959_963_985 * (30.0_f64 / 500.0).sqrt();
        let [low, high] = [0, 1].map(|i| numbers(&nees["bounds_95"][i])[0]);
        assert!((low - (15.0 - half)).abs() < 0.01 && (high - (15.0 + half)).abs() < 0.01, "{low} {high}");
        let mean = numbers(&nees["mean"]);
        assert!(mean.len() > 25, "{mean:?}");
        for squares in [nees, &of_case["nis"]["range"], &of_case["nis"]["image"]] {
            assert!(number(&squares["outside_99"]) <= 1.0, "{case}: {squares}");
            let means = numbers(&squares["mean"]);
            let bounds = [0, 1].map(|i| numbers(&squares["bounds_99"][i]));
            let is_outside = |k: &usize| means[*k] < bounds[0][*k] || means[*k] > bounds[1][*k];
            assert_eq!((0..means.len()).filter(is_outside).count() as f64, number(&squares["outside_99"]));
        }
        for (of, ratios) in of_case["rms_over_sd"].as_object().unwrap() {
            assert!(numbers(ratios).iter().all(|ratio| (0.9..1.1).contains(ratio)), "{case} {of}: {ratios}");
        }
        // One in 100 000 is refused.
        assert!(number(&of_case["refused"]) <= 2e-5 * number(&of_case["measured"]), "{case}");

        let [estimated, exact] = ["estimated", "exact"].map(|who| &of_case["touchdown"][who]);
        let offset = |end: &Value| number(&end["horizontal_offset"]["max"]);
        assert!(offset(estimated) < 0.03 && offset(exact) < 1e-3, "{case}");
        assert!((number(&estimated["relative_velocity"]["mean"]) + 0.2).abs() < 2e-3, "{case}");
        assert!(number(&estimated["relative_velocity"]["sd"]) < 5e-3, "{case}");
        let times = [estimated, exact].map(|end| number(&end["touchdown_time"]["mean"]));
        assert!((times[0] - times[1]).abs() < 0.01, "{times:?}");
    }
    for key in ["gravity", "sensors.imu", "sensors.gyro", "sensors.camera", "estimator.start", "estimator.deck"] {
        assert!(found["assumed"][key]["value"].is_string(), "{key}");
    }
}

#[test]
fn results_are_the_same_for_any_number_of_threads() {
    let few = |threads: &str| good(ESTIMATOR, &["--json", "--members", "10", "--threads", threads]);
    assert_eq!(few("1"), few("3"));
}

#[test]
fn figures_and_errors_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let text = good(ESTIMATOR, &["--members", "10", "--out", folder.path().to_str().unwrap()]);
    assert!(
        text.contains("case II, 10 landings") && text.contains("assumed (reasons: docs/thesis/assumed.md)"),
        "{text}"
    );
    for case in ["I", "II"] {
        for name in ["errors", "consistency", "markers", "touchdown"] {
            figure(folder.path(), &format!("estimator_{name}_{case}"));
        }
        let table = std::fs::read_to_string(folder.path().join(format!("estimator_{case}.csv"))).unwrap();
        let rows = || table.lines().map(|line| line.split(',').collect::<Vec<_>>());
        assert_eq!(rows().next().unwrap()[..2], ["t_s", "error_place_x_m"]);
        let mut within = 0;
        for row in rows().skip(1) {
            let row: Vec<f64> = row.iter().map(|x| x.parse().unwrap()).collect();
            within += usize::from(row[1].abs() < 3.0 * row[16]);
        }
        assert!(within > 2000, "{within} moments within three standard deviations");
    }
}

#[test]
fn wrong_arguments_end_it() {
    for wrong in [["--members", "9"], ["--threads", "0"]] {
        refused(ESTIMATOR, &wrong);
    }
}
