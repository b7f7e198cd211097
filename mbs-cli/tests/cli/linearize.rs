//! `mbs linearize`: systems whose matrices and poles are known by hand or from the literature, and what is refused.

use nalgebra::Matrix4;
use serde_json::Value;

use crate::{Workshop, command, keys};

fn linearized(workshop: &Workshop, arguments: &[&str]) -> Value {
    let arguments = [&["linearize"], arguments, &["--json"]].concat();
    serde_json::from_str(&workshop.good(&arguments)).unwrap()
}

/// A mechanism of the repository, to which there is a link here: it becomes a file of the package.
fn known(file: &str) -> String {
    format!("{}/tests/mechanisms/{file}", env!("CARGO_MANIFEST_DIR"))
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    serde_json::from_value(value.clone()).unwrap()
}

fn assert_matrix(found: &Value, expected: &[&[f64]], tolerance: f64) {
    let found = matrix(found);
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(*expected).all(|(x, y)| (x - y).abs() <= tolerance), "{found:?}, not {expected:?}");
    }
}

fn poles(report: &Value) -> Vec<[f64; 2]> {
    let number = |pole: &Value, key: &str| pole[key].as_f64().unwrap();
    report["poles"].as_array().unwrap().iter().map(|pole| [number(pole, "re"), number(pole, "im")]).collect()
}

#[track_caller]
fn assert_pole(report: &Value, [re, im]: [f64; 2], tolerance: f64) {
    let found = poles(report);
    assert!(found.iter().any(|pole| (pole[0] - re).hypot(pole[1] - im) <= tolerance), "{re} {im}: {found:?}");
}

fn names(report: &Value, list: &str) -> Vec<String> {
    let word = |entry: &Value, key: &str| entry[key].as_str().unwrap().to_string();
    let entries = report[list].as_array().unwrap().iter();
    entries.map(|entry| format!("{} [{}]", word(entry, "name"), word(entry, "unit"))).collect()
}

#[test]
fn a_pendulum_upright_and_hanging() {
    let workshop = Workshop::new();
    let (m, l, g, b): (f64, f64, f64, f64) = (3.0, 2.0, 10.0, 0.25);
    let inertia = m * l * l;
    for (q, sign) in [("0", -1.0), ("3.141592653589793", 1.0)] {
        let report = linearized(&workshop, &["pendulum.mbs", "--state", &format!("{{\"q\": [{q}]}}")]);
        assert_eq!(
            keys(&report),
            [
                "state",
                "accelerations",
                "states",
                "inputs",
                "outputs",
                "a",
                "b",
                "c",
                "d",
                "poles",
                "controllability_rank",
                "observability_rank"
            ]
        );
        assert_matrix(&report["a"], &[&[0.0, 1.0], &[sign * g / l, -b / inertia]], 1e-14);
        assert_matrix(&report["b"], &[&[0.0], &[1.0 / inertia]], 1e-16);
        assert_matrix(&report["c"], &[&[0.0, 0.0]], 1e-15);
        assert_eq!(names(&report, "states"), ["theta [rad]", "theta_dot [rad/s]"]);
        assert_eq!(names(&report, "inputs"), ["tau [N*m]"]);
        assert_eq!(names(&report, "outputs"), ["height [m]"]);
        let half = -0.5 * b / inertia;
        let square = half * half + sign * g / l;
        if sign > 0.0 {
            assert_pole(&report, [half + square.sqrt(), 0.0], 1e-13);
            assert_pole(&report, [half - square.sqrt(), 0.0], 1e-13);
        } else {
            assert_pole(&report, [half, (-square).sqrt()], 1e-13);
            let frequency = report["poles"][0]["natural_frequency"].as_f64().unwrap();
            let damping = report["poles"][0]["damping_ratio"].as_f64().unwrap();
            assert!((frequency - (g / l).sqrt()).abs() < 1e-13 && (damping + half / frequency).abs() < 1e-14);
        }
        assert_eq!(report["controllability_rank"], 2);
    }
}

#[test]
fn a_state_that_rests_is_found() {
    let workshop = Workshop::new();
    let angle = 0.5_f64;
    let held = linearized(&workshop, &["pendulum.mbs", "--state", "{\"q\": [0.5]}", "--trim", "tau"]);
    let torque = 3.0 * 10.0 * 2.0 * angle.sin();
    assert!((held["state"]["u"][0].as_f64().unwrap() - torque).abs() < 1e-12, "{held}");
    assert_eq!(held["state"]["q"][0], 0.5);
    let swung = linearized(&workshop, &["pendulum.mbs", "--state", "{\"q\": [0.3], \"u\": [30]}", "--trim", "theta"]);
    assert!((swung["state"]["q"][0].as_f64().unwrap() - 0.5_f64.asin()).abs() < 1e-12, "{swung}");
    let report =
        workshop.bad(&["linearize", "pendulum.mbs", "--state", "{\"q\": [0.3], \"u\": [90]}", "--trim", "theta"]);
    assert!(report.starts_with("error: no equilibrium was found: the acceleration of `theta` stays at "), "{report}");
}

/// Rates and inputs in an output count: `f dt(x)` has slopes in both.
#[test]
fn outputs_of_rates_and_inputs() {
    let workshop = Workshop::new();
    let cart = "mechanism Cart { param m: kg = 2; coord x: m; input f: N; kinetic += 1/2*m*dt(x)^2; force x += f; \
                output power = f*dt(x); output there = world*translation([x, 0, 0]); }";
    workshop.write("cart.mbs", cart);
    let report = linearized(&workshop, &["cart.mbs", "--state", "{\"q\": [1], \"qd\": [3], \"u\": [5]}"]);
    assert_eq!(report["outputs"].as_array().unwrap().len(), 13);
    let names = names(&report, "outputs");
    assert_eq!(
        [&names[0], &names[1], &names[4]],
        ["power [kg·m²/s³]", "there_position_0 [m]", "there_rotation_0_0 [1]"]
    );
    assert_eq!(matrix(&report["c"])[..2], [[0.0, 5.0], [1.0, 0.0]]);
    assert_eq!(matrix(&report["d"])[..2], [[3.0], [0.0]]);
    assert_eq!(report["accelerations"][0], 2.5);
}

#[test]
fn a_sampled_system() {
    let workshop = Workshop::new();
    workshop.write(
        "cart.mbs",
        "mechanism Cart { param m: kg = 2; coord x: m; input f: N; kinetic += 1/2*m*dt(x)^2; force x += f; }",
    );
    let report = linearized(&workshop, &["cart.mbs", "--state", "{\"q\": [0]}", "--sample-time", "0.5"]);
    assert_matrix(&report["a"], &[&[1.0, 0.5], &[0.0, 1.0]], 1e-15);
    assert_matrix(&report["b"], &[&[0.0625], &[0.25]], 1e-15);
    assert_eq!(report["sample_time"], 0.5);
    // Poles of the sampled pendulum are the exponentials of those of the continuous one.
    let slow = linearized(&workshop, &["pendulum.mbs", "--state", "{\"q\": [0]}"]);
    let sampled = linearized(&workshop, &["pendulum.mbs", "--state", "{\"q\": [0]}", "--sample-time", "0.1"]);
    for [re, im] in poles(&slow) {
        let (sin, cos) = (0.1 * im).sin_cos();
        assert_pole(&sampled, [(0.1 * re).exp() * cos, (0.1 * re).exp() * sin], 1e-13);
    }
    let frequency = |report: &Value| report["poles"][0]["natural_frequency"].as_f64().unwrap();
    assert!((frequency(&slow) - frequency(&sampled)).abs() < 1e-12);
}

/// A thousandth of a milligram on a spring, undamped: its push is large in SI units.
#[test]
fn a_sampled_system_of_small_masses() {
    let workshop = Workshop::new();
    let text = "mechanism Tiny { param m: kg = 1e-9; param k: N/m = 1e-9; coord x: m; input f: N; \
                kinetic += 1/2*m*dt(x)^2; potential += 1/2*k*x^2; force x += f; }";
    workshop.write("tiny.mbs", text);
    let report = linearized(&workshop, &["tiny.mbs", "--state", "{\"q\": [0]}", "--sample-time", "100"]);
    let (sin, cos) = 100.0_f64.sin_cos();
    assert_matrix(&report["a"], &[&[cos, sin], &[-sin, cos]], 4e-14);
    let damping = report["poles"][0]["damping_ratio"].as_f64().unwrap();
    assert!(damping.abs() < 1e-13, "{damping}");
}

/// `e^(-2000)` is zero.
#[test]
fn what_decays_within_a_sample_is_damped() {
    let workshop = Workshop::new();
    let text = "mechanism Light { param m: kg = 1e-3; param b: N*s/m = 2; coord x: m; kinetic += 1/2*m*dt(x)^2; \
                dissipation += 1/2*b*dt(x)^2; }";
    workshop.write("light.mbs", text);
    let arguments = ["light.mbs", "--state", "{\"q\": [0]}", "--sample-time", "1"];
    let report = linearized(&workshop, &arguments);
    assert_eq!(report["poles"][0]["re"], 0.0);
    assert_eq!(report["poles"][0]["damping_ratio"], 1.0);
    assert_eq!(report["poles"][0]["natural_frequency"], Value::Null);
    let shown = workshop.good(&[&["linearize"], &arguments[..]].concat());
    assert!(
        shown.contains("a pole at 0: what it moves has decayed within a sample\n") && !shown.contains("NaN"),
        "{shown}"
    );
}

/// Entries whose squares overflow are balanced in other units.
#[test]
fn poles_of_any_size_are_found() {
    let workshop = Workshop::new();
    let text = "mechanism Stiff { coord x: m; input f: N; kinetic += 1/2*1e-100*1 kg*dt(x)^2; \
                potential += 1/2*1e100*1 N/m*x^2; force x += f; }";
    workshop.write("stiff.mbs", text);
    let report = linearized(&workshop, &["stiff.mbs", "--state", "{\"q\": [0]}"]);
    for [re, im] in poles(&report) {
        assert!(re.abs() < 1e88 && (im.abs() / 1e100 - 1.0).abs() < 1e-12, "{re} {im}");
    }
    assert_eq!(report["controllability_rank"], 2);
}

/// In Cartesian coordinates, one of which follows from the other: the poles are those of the pendulum.
#[test]
fn constraints_leave_independent_coordinates() {
    let workshop = Workshop::new();
    let file = known("cartesian_pendulum.mbs");
    let report = linearized(&workshop, &[&file, "--state", "{\"q\": [0, -1]}"]);
    assert_eq!(names(&report, "states"), ["x [m]", "x_dot [m/s]"]);
    assert_matrix(&report["a"], &[&[0.0, 1.0], &[-9.80665, 0.0]], 1e-13);
    // At an angle, from a guess off the circle; the poles do not depend on the coordinate that is named.
    let slanted = "{\"q\": [0.6, 0.81]}";
    let off = workshop.bad(&["linearize", &file, "--state", slanted]);
    assert!(off.starts_with("error: the state is not on the constraints: `length` is off by "), "{off}");
    let found = linearized(&workshop, &[&file, "--state", "{\"q\": [0.001, -0.99]}", "--trim", "x,y"]);
    assert_pole(&found, [0.0, 9.80665_f64.sqrt()], 1e-10);
    let tied = workshop.bad(&["linearize", &file, "--state", "{\"q\": [0, -1]}", "--independent", "y"]);
    assert_eq!(tied, "error: the constraints hold the coordinates of `--independent`, or tie them to each other\n");
}

#[test]
fn a_bicycle_weaves_and_capsizes_as_published() {
    let workshop = Workshop::new();
    let file = known("whipple_bicycle.mbs");
    // Meijaard and others, 2007, table 2: castering, capsize, and weave at 5 m/s.
    let state = format!("{{\"q\": [0,0,0,0,0,0,0,0], \"qd\": [5,0,0,0,0,0,{},{}]}}", -5.0 / 0.3, -5.0 / 0.35);
    let report = linearized(&workshop, &[&file, "--state", &state]);
    assert_eq!(report["states"].as_array().unwrap().len(), 10);
    for [re, im] in [
        [-14.078_389_692_798_22, 0.0],
        [-0.322_866_429_004_09, 0.0],
        [-0.775_341_882_195_85, 4.464_867_713_788_23],
        [-0.775_341_882_195_85, -4.464_867_713_788_23],
    ] {
        assert_pole(&report, [re, im], 1e-8);
    }
}

/// Where the weave's damping and the capsize mode's rate change their signs: Meijaard and others, 2007, section 5.
#[test]
fn a_bicycle_is_stable_between_two_speeds() {
    let folder = tempfile::tempdir().unwrap();
    let file = known("whipple_bicycle.mbs");
    let at = |speed: f64| -> Value {
        let state =
            format!("{{\"q\": [0,0,0,0,0,0,0,0], \"qd\": [{speed},0,0,0,0,0,{},{}]}}", -speed / 0.3, -speed / 0.35);
        let arguments =
            ["linearize", &file, "--state", &state, "--json", "--independent", "x,y,yaw,roll,steer,rear,front"];
        // Derived once.
        let output = command(folder.path(), &arguments).env("MBS_CACHE_DIR", folder.path()).output().unwrap();
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let weave = |speed: f64| poles(&at(speed)).iter().find(|pole| pole[1] > 1.0).unwrap()[0];
    assert!((root(weave, [4.0, 5.0]) - 4.292_382_536_341_11).abs() < 1e-9);
    // The product of the four poles of roll and steer; all others are zero.
    let capsize = |speed: f64| {
        let report = at(speed);
        let all = names(&report, "states");
        let own = ["roll [rad]", "steer [rad]", "roll_dot [rad/s]", "steer_dot [rad/s]"];
        let own = own.map(|name| all.iter().position(|known| known == name).unwrap());
        let a = matrix(&report["a"]);
        Matrix4::from_fn(|i, j| a[own[i]][own[j]]).determinant()
    };
    assert!((root(capsize, [5.0, 7.0]) - 6.024_262_015_388_37).abs() < 1e-9);
}

/// By bisection.
fn root(function: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    let rises = function(high) > 0.0;
    assert!(rises != (function(low) > 0.0), "no change of sign");
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if (function(middle) > 0.0) == rises { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Ogata, *Modern Control Engineering*, 5th ed. 2010, example 3-6, with friction of the rail; upright and hanging.
#[test]
fn a_pendulum_on_a_cart_is_that_of_the_textbook() {
    let workshop = Workshop::new();
    let file = known("cart_pole.mbs");
    let (cart, bob, l, g, b) = (1.0, 0.1, 0.5, 9.81, 0.05);
    for (angle, sign) in [("3.141592653589793", 1.0), ("0", -1.0)] {
        let report = linearized(&workshop, &[&file, "--state", &format!("{{\"q\": [0.3, {angle}]}}")]);
        assert_eq!(names(&report, "states"), ["x [m]", "theta [rad]", "x_dot [m/s]", "theta_dot [rad/s]"]);
        let a: [&[f64]; 4] = [
            &[0.0, 0.0, 1.0, 0.0],
            &[0.0, 0.0, 0.0, 1.0],
            &[0.0, bob * g / cart, -b / cart, 0.0],
            &[0.0, sign * (cart + bob) * g / (cart * l), -sign * b / (cart * l), 0.0],
        ];
        assert_matrix(&report["a"], &a, 1e-13);
        assert_matrix(&report["b"], &[&[0.0], &[0.0], &[1.0 / cart], &[sign / (cart * l)]], 1e-14);
        let tip: [&[f64]; 3] = [&[1.0, -sign * l, 0.0, 0.0], &[0.0; 4], &[0.0; 4]];
        assert_matrix(&report["c"], &tip, 1e-15);
        assert_matrix(&report["d"], &[&[0.0][..]; 3], 0.0);
        assert_eq!(report["controllability_rank"], 4);
    }
}

/// A linkage of one freedom: `J φ'' + ½ J' φ'² + V' = τ`, with J and V of the crank's angle alone; here from the
/// geometry of two circles that meet, without constraints.
mod four_bar {
    const M: [f64; 3] = [0.2, 0.5, 0.4];
    const L: [f64; 3] = [0.2, 0.6, 0.5];
    const GROUND: f64 = 0.55;

    /// Angles of coupler and rocker.
    pub(super) fn angles(crank: f64) -> [f64; 2] {
        let (x, z) = (GROUND - L[0] * crank.cos(), -L[0] * crank.sin());
        let distance = x.hypot(z);
        // The law of cosines in the triangle of coupler, rocker and the line between their far ends.
        let at_knee = ((L[1].powi(2) + distance.powi(2) - L[2].powi(2)) / (2.0 * L[1] * distance)).acos();
        let coupler = z.atan2(x) + at_knee;
        let meet = [L[1] * coupler.cos() - x, L[1] * coupler.sin() - z];
        [coupler, meet[1].atan2(meet[0])]
    }

    /// `dψ/dφ` of coupler and rocker: the velocity of the knee along and across them.
    pub(super) fn ratios(crank: f64) -> [f64; 2] {
        let [coupler, rocker] = angles(crank);
        let across = (coupler - rocker).sin();
        [L[0] * (rocker - crank).sin() / (L[1] * across), L[0] * (coupler - crank).sin() / (L[2] * across)]
    }

    fn inertia(crank: f64) -> f64 {
        let ([coupler, _], [k1, k2]) = (angles(crank), ratios(crank));
        // Of the coupler's middle: the knee's velocity and half of the coupler's own.
        let square = L[0].powi(2) + L[0] * L[1] * k1 * (crank - coupler).cos() + 0.25 * (L[1] * k1).powi(2);
        M[0] * L[0].powi(2) / 3.0 + M[1] * (square + (L[1] * k1).powi(2) / 12.0) + M[2] * (L[2] * k2).powi(2) / 3.0
    }

    fn potential(crank: f64) -> f64 {
        let [coupler, rocker] = angles(crank);
        let heights =
            [0.5 * L[0] * crank.sin(), L[0] * crank.sin() + 0.5 * L[1] * coupler.sin(), 0.5 * L[2] * rocker.sin()];
        9.81 * (0..3).map(|i| M[i] * heights[i]).sum::<f64>()
    }

    /// By five points, of error h⁴.
    pub(super) fn slope(function: impl Fn(f64) -> f64, x: f64) -> f64 {
        let h = 1e-3;
        let difference = |k: f64| function(x + k * h) - function(x - k * h);
        (8.0 * difference(1.0) - difference(2.0)) / (12.0 * h)
    }

    pub(super) fn acceleration(crank: f64, rate: f64, torque: f64) -> f64 {
        (torque - slope(potential, crank) - 0.5 * slope(inertia, crank) * rate * rate) / inertia(crank)
    }
}

#[test]
fn a_four_bar_linkage_is_reduced_to_its_crank() {
    let workshop = Workshop::new();
    let file = known("four_bar.mbs");
    for (crank, rate, torque) in [(0.8, 0.0, 0.3), (2.1, 1.7, -0.2), (-1.0, -3.0, 0.0)] {
        let ([coupler, rocker], [k1, k2]) = (four_bar::angles(crank), four_bar::ratios(crank));
        let state = format!(
            "{{\"q\": [{crank}, {coupler}, {rocker}], \"qd\": [{rate}, {}, {}], \"u\": [{torque}]}}",
            k1 * rate,
            k2 * rate
        );
        let report = linearized(&workshop, &[&file, "--state", &state, "--independent", "crank"]);
        assert_eq!(names(&report, "states"), ["crank [rad]", "crank_dot [rad/s]"]);
        let expected = four_bar::acceleration(crank, rate, torque);
        assert!((report["accelerations"][0].as_f64().unwrap() - expected).abs() < 1e-8 * (1.0 + expected.abs()));
        let by = [
            four_bar::slope(|crank| four_bar::acceleration(crank, rate, torque), crank),
            four_bar::slope(|rate| four_bar::acceleration(crank, rate, torque), rate),
            four_bar::slope(|torque| four_bar::acceleration(crank, rate, torque), torque),
        ];
        let size = 1.0 + by[0].abs() + by[1].abs();
        assert_matrix(&report["a"], &[&[0.0, 1.0], &[by[0], by[1]]], 1e-7 * size);
        assert_matrix(&report["b"], &[&[0.0], &[by[2]]], 1e-7 * by[2].abs());
        // The middle of the coupler moves with knee and coupler.
        let middle = [-0.2 * crank.sin() - 0.3 * k1 * coupler.sin(), 0.0, 0.2 * crank.cos() + 0.3 * k1 * coupler.cos()];
        let rows: Vec<[f64; 2]> = middle.iter().map(|&slope| [slope, 0.0]).collect();
        assert_matrix(&report["c"], &rows.iter().map(|row| row.as_slice()).collect::<Vec<_>>(), 1e-12);
    }
}

/// Three parallel cranks carry a platform, of which two would do: where one of them alone turned, the rows that depend
/// on others would contradict them.
pub(crate) const CRANKS: &str = "mechanism Cranks {
    param m: kg = 2; param l: m = 0.5; param g: m/s^2 = 9.81;
    coord q[3]: rad; coord x: m; coord z: m; coord tilt: rad; input drive: N*m;
    gravity [0, 0, -g]; force q[0] += drive;
    let platform = translation([x, 0, z])*rot_y(-tilt);
    kinetic += rigid_body(m, [0, 0, 0], diag(1, 1, 1)*m*l^2/12, platform);
    for i in 0..3 {
        let crank = translation([(i - 1)*l, 0, 0])*rot_y(-q[i]);
        kinetic += particle(m/3, crank.point([0, 0, -l/2]));
        constraint hinge[i]: crank.point([0, 0, -l]) = platform.point([(i - 1)*l, 0, 0]);
    }
    output lift = z; }";

/// All move as one pendulum, `5/4 m l² q̈ = τ − 3/2 m g l sin q`.
#[test]
fn cranks_more_than_needed_are_one_pendulum() {
    let workshop = Workshop::new();
    let (m, l, g): (f64, f64, f64) = (2.0, 0.5, 9.81);
    workshop.write("cranks.mbs", CRANKS);
    for (q, rate) in [(0.0_f64, 0.0), (0.7, 0.0), (0.7, 1.5), (-2.0, -3.0)] {
        let (sin, cos) = q.sin_cos();
        let state = serde_json::json!({
            "q": [q, q, q, l * sin, -l * cos, 0.0],
            "qd": [rate, rate, rate, l * cos * rate, l * sin * rate, 0.0],
            "u": [0.3],
        });
        let arguments = ["cranks.mbs", "--state", &state.to_string(), "--independent", "q_1"];
        let report = linearized(&workshop, &arguments);
        assert_matrix(&report["a"], &[&[0.0, 1.0], &[-1.2 * g / l * cos, 0.0]], 1e-9);
        assert_matrix(&report["b"], &[&[0.0], &[1.0 / (1.25 * m * l * l)]], 1e-12);
        assert_matrix(&report["c"], &[&[l * sin, 0.0]], 1e-12);
    }
    // Rows that repeat others do not keep the drive from being found that holds the cranks.
    let (sin, cos) = 0.7_f64.sin_cos();
    let state = serde_json::json!({ "q": [0.7, 0.7, 0.7, l * sin, -l * cos, 0.0] }).to_string();
    let report = linearized(&workshop, &["cranks.mbs", "--state", &state, "--trim", "drive"]);
    let drive = report["state"]["u"][0].as_f64().unwrap();
    assert!((drive - 1.5 * m * g * l * sin).abs() < 1e-9, "{drive}");
    let refused = workshop.bad(&["linearize", "cranks.mbs", "--state", &state, "--trim", "q_0"]);
    assert!(refused.contains("where constraints repeat others only inputs can be trimmed"), "{refused}");
}

#[test]
fn a_quadrotor_hovers() {
    let workshop = Workshop::new();
    let file = known("quadrotor_quaternion.mbs");
    let state = "{\"q\": [0,0,0,1,0,0,0], \"u\": [250,250,250,250], \"prescribed\": {\"wind_0\": [0,0,0], \"wind_1\": [0,0,0], \
                 \"wind_2\": [0,0,0]}}";
    let trim = "rotor_speed_0,rotor_speed_1,rotor_speed_2,rotor_speed_3";
    let report = linearized(&workshop, &[&file, "--state", state, "--trim", trim]);
    let speed = (40.0 * 9.80665 / 4.0 / 1.1e-3_f64).sqrt();
    for found in report["state"]["u"].as_array().unwrap() {
        assert!((found.as_f64().unwrap() - speed).abs() < 1e-9, "{found}");
    }
    // The scalar part of the quaternion follows from the others.
    assert_eq!(report["states"].as_array().unwrap().len(), 12);
    assert!(!names(&report, "states").iter().any(|name| name.starts_with("e_0")));
    assert_eq!(report["controllability_rank"], 12);
    assert!(poles(&report).iter().all(|pole| pole[0].hypot(pole[1]) < 1e-2), "{:?}", poles(&report));
}

#[test]
fn a_text_for_people() {
    let workshop = Workshop::new();
    let text = workshop.good(&["linearize", "pendulum.mbs", "--state", "{\"q\": [0]}"]);
    for part in
        ["d/dt theta_dot [rad/s]", "tau [N*m]", "\npoles [1/s]", "2 of 2 states are controllable, 0 observable\n"]
    {
        assert!(text.contains(part), "{text}");
    }
    // A car that nothing drives, seen by one output; integrators are at zero, whatever rounding leaves of them.
    workshop.write(
        "car.mbs",
        "mechanism Car { param m: kg = 1; param k: N/m = 3; param b: N*s/m = 0.7; coord p[2]: m;
         for i in 0..2 { kinetic += (i + 1)*m*dt(p[i])^2; } potential += 1/2*k*(p[1] - p[0])^2;
         dissipation += 1/2*b*(dt(p[1]) - dt(p[0]))^2; output gap = p[1] - p[0]; }",
    );
    let free = workshop.good(&["linearize", "car.mbs", "--state", "{\"p\": [0, 0]}", "--independent", "p"]);
    assert!(free.contains("\nno inputs, 2 of 4 states are observable\n"), "{free}");
    let zero = "\n  0                                                  0        -\n";
    assert!(free.contains(zero), "{free}");
    let silent = "mechanism Mass { coord x: m; input f: N; kinetic += 1/2*(1 kg)*dt(x)^2; force x += f; }";
    workshop.write("mass.mbs", silent);
    let silent = workshop.good(&["linearize", "mass.mbs", "--state", "{\"x\": 0}"]);
    assert!(silent.contains("\n2 of 2 states are controllable, no outputs\n"), "{silent}");
    let moving = workshop.good(&["linearize", "pendulum.mbs", "--state", "{\"q\": [1]}"]);
    assert!(moving.contains("\nno equilibrium: accelerations [-4.2"), "{moving}");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let workshop = Workshop::new();
    let refused =
        |more: &[&str]| workshop.bad(&[&["linearize", "pendulum.mbs", "--state", "{\"q\": [0]}"], more].concat());
    let sampled = ["linearize", "pendulum.mbs", "--state", "{\"q\": [0]}", "--sample-time", "0"];
    assert!(workshop.misused(&sampled).contains("'--sample-time <T>': it must be positive"));
    assert_eq!(refused(&["--trim", "thta"]), "error: unknown name `thta`; did you mean \"theta\"?\n");
    assert_eq!(refused(&["--trim", "tau,tau"]), "error: `tau` is named twice\n");
    let many = workshop.bad(&["linearize", "pendulum.mbs", "--state", "[{\"q\": [0]}]"]);
    assert_eq!(many, "error: `mbs linearize` takes one state, not an array of them\n");
}

/// `x y = 0` asks for `δy = 0` beside the origin, and for nothing at it.
#[test]
fn rows_that_vanish_here_alone_are_named() {
    let workshop = Workshop::new();
    let text =
        "mechanism Cross { coord x: m; coord y: m; kinetic += 1 kg*(dt(x)^2 + dt(y)^2); constraint lines: x*y = 0; }";
    workshop.write("cross.mbs", text);
    let report = workshop.bad(&["linearize", "cross.mbs", "--state", "{\"q\": [0, 0], \"qd\": [1, 0]}"]);
    let (warning, error) = report.split_once('\n').expect("two messages");
    assert!(
        warning.starts_with("warning: at the state the rank of the constraints is 0, at other states 1"),
        "{report}"
    );
    assert_eq!(
        error,
        "error: derivatives of accelerations are infinite or NaN at the state: there `lines` vanishes or depends on \
         other constraints, but not in neighbouring states\n"
    );
}

/// Of more than a hundred masses nothing but the dynamics is derived.
#[test]
fn what_needs_matrices_is_refused_where_they_are_not_derived() {
    let workshop = Workshop::new();
    let text = "mechanism Masses { coord x[101]: m; for i in 0..101 { kinetic += 1 kg*dt(x[i])^2/2; } }";
    workshop.write("masses.mbs", text);
    let state = format!("{{\"q\": {:?}}}", vec![0.0; 101]);
    for arguments in [
        ["linearize", "--state", &state, "masses.mbs"],
        ["report", "--state", &state, "masses.mbs"],
        ["fmu", "--out", "masses.fmu", "masses.mbs"],
    ] {
        let said = workshop.bad(&arguments);
        assert!(said.contains("Masses has 101 coordinates"), "{arguments:?}: {said}");
    }
}

/// That of the manual.
const DISK: &str = "\
/// A thin disk that rolls on a level floor.
mechanism RollingDisk {
    param m: kg = 1;
    param radius: m = 0.3;
    param g: m/s^2 = 9.81;
    coord x: m;
    coord y: m;
    coord heading: rad;
    coord lean: rad;
    coord spin: rad;
    // x ahead, y along the axle, z up in the plane of the disk; `frame` does not spin.
    let frame = translation([x, y, radius*cos(lean)]) * rot_z(heading) * rot_x(lean);
    let disk = frame * rot_y(spin);
    kinetic   += rigid_body(m, [0, 0, 0], diag(1, 2, 1)*m*radius^2/4, disk);
    potential += m*g*disk.origin().z;
    /// Two rows: the vertical one vanishes.
    constraint rolling: dt(disk.origin()) + angular_velocity(disk).cross(frame*[0, 0, -radius]) = 0;
}
";

/// A disk rolls in a circle: most of its poles are zero, and beside zeros and noise Francis' steps need more than their
/// neighbours to tell what is zero.
#[test]
fn poles_of_steady_motions_are_found() {
    let workshop = Workshop::new();
    workshop.write("disk.mbs", DISK);
    let poles = |x_dot: f64, heading_dot: f64, lean: f64, spin_dot: f64| {
        let state = format!(
            r#"{{"lean": {lean:?}, "x_dot": {x_dot:?}, "heading_dot": {heading_dot:?}, "spin_dot": {spin_dot:?}}}"#
        );
        let answer = workshop.good(&["linearize", "disk.mbs", "--state", &state, "--json"]);
        let answer: Value = serde_json::from_str(&answer).unwrap();
        let size = |pole: &Value| pole["re"].as_f64().unwrap().hypot(pole["im"].as_f64().unwrap());
        answer["poles"].as_array().unwrap().iter().map(size).collect::<Vec<f64>>()
    };
    // The last one by an independent derivation.
    let found = poles(-0.9819775155573364, 2.0, 0.3, -3.8642987985138006);
    assert_eq!(found.len(), 8);
    assert!((found[7] - 2.90724113).abs() < 1e-8 && found[5] < 1e-4, "{found:?}");
    poles(-2.2721285957510893, 1.3265370679216149, 0.4365346196275094, -8.134623987463982);
    poles(-4.4284069773593275, 1.5730906915124276, 0.8234056290043996, -15.915163519921208);
}

/// `p = ±i √(g/l)`: no damping, not a negative one.
#[test]
fn undamped_modes_have_no_sign() {
    let workshop = Workshop::new();
    let run = ["linearize", "pendulum.mbs", "--state", r#"{"theta": 0, "params": {"b": 0}}"#];
    let text = workshop.good(&run);
    assert!(text.contains("  2.236068   0.0000\n") && !text.contains("-0.0000"), "{text}");
    let json = workshop.good(&[run.as_slice(), &["--json"]].concat());
    assert!(json.contains(r#""damping_ratio":0.0"#) && !json.contains("-0.0,"), "{json}");
    // Hanging from the other side it falls: that sign counts.
    let text = workshop.good(&["linearize", "pendulum.mbs", "--state", r#"{"theta": "180 deg"}"#]);
    assert!(text.contains("  -1.0000\n"), "{text}");
}

/// The disk in a circle, from a guess of its speeds; in a turn the velocity turns with the heading.
#[test]
fn steady_turns_are_found() {
    let workshop = Workshop::new();
    workshop.write("disk.mbs", DISK);
    let state = r#"{"lean": 0.3, "x_dot": -1, "heading_dot": 2, "spin_dot": -4}"#;
    let run = ["linearize", "disk.mbs", "--state", state, "--trim", "x_dot,spin_dot"];
    let report = workshop.bad(&run);
    assert!(report.starts_with("error: no equilibrium was found: the acceleration of `y` stays at "), "{report}");
    assert!(report.contains("or the coordinate in `--accelerating` where a steady motion has such"), "{report}");
    let found = linearized(&workshop, &[&run[1..], &["--accelerating", "y"]].concat());
    let speeds = &found["state"]["qd"];
    for (number, expected) in [(0, -0.9819775155573364), (4, -3.8642987985138006)] {
        assert!((speeds[number].as_f64().unwrap() - expected).abs() < 1e-9, "{speeds}");
    }
    let text = workshop.good(&[run.as_slice(), &["--accelerating", "y"]].concat());
    assert!(text.contains("\naccelerations that may remain: [0.0, -1.96395503111"), "{text}");
    assert!(workshop.misused(&["linearize", "disk.mbs", "--state", state, "--accelerating", "y"]).contains("--trim"));
    // Free to choose all speeds, the nearest equilibrium is another motion.
    let free = ["--trim", "lean,x_dot,y_dot,heading_dot,spin_dot"];
    let rest = workshop.mbs(&[&run[..4], &free].concat());
    assert!(rest.stderr.starts_with("warning: the equilibrium is far from the state given: `"), "{}", rest.stderr);
}
