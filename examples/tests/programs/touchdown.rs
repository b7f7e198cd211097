//! What becomes of the vehicle after the touchdown, as an outside program calls it.

use crate::support::{figure, good, json, keys, number, run};

const TOUCHDOWN: &str = env!("CARGO_BIN_EXE_touchdown");
const WEIGHT: f64 = 40.0 * 9.80665;

#[test]
fn endings_are_told_apart_and_the_platform_carries_the_vehicle() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(TOUCHDOWN, &["--json", "--out", folder.path().to_str().unwrap()]));
    assert_eq!(keys(&found), ["by_hand", "planned", "carried", "assumed"]);
    assert!(found["assumed"]["landing.gear"]["value"].as_str().unwrap().contains("1e4 N/m"));

    let by_hand = &found["by_hand"];
    for (name, ending) in [("rest", "rest"), ("sliding", "sliding"), ("tip_over", "tipped over")] {
        assert_eq!(by_hand[name]["ending"], ending);
    }
    assert!(number(&by_hand["rebound"]["rebounds"]) >= 3.0 && number(&by_hand["rest"]["rebounds"]) == 0.0);
    // Falling 5 cm with 0.2 m/s it is there after `√(v² + 2gh) − v` over g; with air a little later.
    let touch = ((0.04 + 2.0 * 9.80665 * 0.05_f64).sqrt() - 0.2) / 9.80665;
    assert!((number(&by_hand["rest"]["first_touch"]) - touch).abs() < 1e-4);
    // Down 35° with a friction of 0.6, `½ g (sin α − μ cos α) t²` of almost 4 s.
    let (sin, cos) = 35.0_f64.to_radians().sin_cos();
    let way = 0.5 * 9.80665 * (sin - 0.6 * cos) * (4.0 - touch).powi(2);
    let slid = number(&by_hand["sliding"]["slid"]);
    assert!((slid - way).abs() < 0.15 * way, "{slid} m, not about {way} m");

    for group in ["by_hand", "planned", "carried"] {
        for (name, one) in found[group].as_object().unwrap() {
            assert!(number(&one["energy_error"]) < 1e-8, "{group} {name}");
            let suffix = if group == "carried" { "_platform" } else { "" };
            let name = format!("touchdown_{name}{suffix}");
            figure(folder.path(), &name);
            assert!(folder.path().join(name + ".csv").metadata().unwrap().len() > 1000);
        }
    }
    for name in ["I", "marine"] {
        assert_eq!(found["planned"][name]["ending"], "rest");
    }
    for name in ["I", "II", "marine"] {
        let one = &found["carried"][name];
        assert_eq!(one["ending"], "rest");
        // What the legs lift more is what the vehicle presses with: its weight, give or take what heaves.
        let [lift, push] = ["added_lift", "push"].map(|key| number(&one[key]));
        assert!(
            (push / WEIGHT - 1.0).abs() < 0.15 && (lift - push).abs() < 0.03 * WEIGHT,
            "{name}: {lift} N, {push} N"
        );
        // By `m g/(M ω²)`, M between the plate's mass and that with all of the legs.
        let sag = number(&one["sag"]);
        assert!(sag > WEIGHT / (550.0 * 64.0) && sag < 1.1 * WEIGHT / (250.0 * 64.0), "{name}: {sag} m");
    }
}

#[test]
fn wrong_usage_ends_with_2() {
    assert_eq!(run(TOUCHDOWN, &["--fast"]).status.code(), Some(2));
}
