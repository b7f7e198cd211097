//! The quadrotor's examples as outside programs call them: what they print and what they write.

use std::path::Path;
use std::process::Output;

use crate::support::{figure, good, json, keys, number, numbers, refused, run};
use mbs_landing::quadrotor::backstepping::Reference;
use mbs_landing::quadrotor::heave::Heave;
use serde_json::Value;

const LANDING: &str = env!("CARGO_BIN_EXE_quadrotor_landing");
const MONTE_CARLO: &str = env!("CARGO_BIN_EXE_landing_monte_carlo");
const SWEEP: &str = env!("CARGO_BIN_EXE_landing_sweep");

/// Touchdown time \[s\], relative velocity \[m/s\] and horizontal offset \[m\] of `quad.landing` of the reference
/// values.
const LANDINGS: [(&str, &str, [f64; 3]); 4] = [
    ("I", "exact", [13.254_642_785_856_516, -0.200_219_070_194_215_8, 8.003_225_359_706_338e-8]),
    ("I", "small_angle", [13.254_642_806_506_784, -0.200_219_079_165_423_36, 8.006_023_104_986_414e-8]),
    ("II", "exact", [13.253_187_507_321_867, -0.198_488_288_738_778_1, 3.621_129_885_747_774e-5]),
    ("II", "small_angle", [13.253_187_511_549_939, -0.198_488_290_675_218_9, 3.673_239_971_465_485e-5]),
];

/// Landings of descents that follow the platform's elevation itself, down to 1 cm: `I_direct_zd_eq_zp_tol_1cm_exact`
/// and its twin.
const UNGUIDED: [(&str, [f64; 3]); 2] = [
    ("I", [3.118_381_781_435_118, -0.053_729_426_163_125_37, 0.032_867_561_905_870_04]),
    ("II", [3.190_676_895_328_071, -0.060_882_583_368_030_54, 0.099_941_829_697_004_71]),
];

#[test]
fn landings_are_those_of_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let found = json(&good(LANDING, &["--json", "--out", folder.path().to_str().unwrap()]));
    assert_eq!(keys(&found), ["I", "II", "marine", "unguided", "gusts", "assumed"]);
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
    for (case, expected) in UNGUIDED {
        let names = ["touchdown_time", "relative_velocity", "horizontal_offset"];
        for (name, expected) in names.iter().zip(expected) {
            let found = number(&found["unguided"][case][name]);
            assert!((found - expected).abs() <= 1e-6, "{case} unguided {name}: {found}, not {expected}");
        }
    }
    gusts_scatter_landings_about_those_in_steady_wind(&found["gusts"]);
    let figures = (2..=9).map(|number| format!("figure_5_{number}"));
    let marine = ["path", "elevation", "attitude", "forces"].map(|what| format!("marine_{what}"));
    let others = ["case_I_gusts", "case_II_gusts", "unguided_I", "unguided_II"].map(String::from);
    for name in figures.chain(marine).chain(others).chain(PLATFORM_RUNS.map(|run| run.to_string())) {
        figure(folder.path(), &name);
    }
    for name in PLATFORM_RUNS {
        tables_of_the_platform_are_landings(folder.path(), name);
    }
    for (case, heave) in [("I", Heave::CASE_I), ("II", Heave::CASE_II)] {
        the_platform_is_flagged(&found[case]);
        forces_of_the_legs_are_lagranges(folder.path(), case, heave, &found[case]["platform"]);
    }
    the_deck_at_sea_is_met(&found["marine"]);
}

const PLATFORM_RUNS: [&str; 6] = [
    "case_I_platform_full",
    "case_I_platform_scaled",
    "case_II_platform_full",
    "case_II_platform_scaled",
    "marine_platform_full",
    "marine_platform_scaled",
];

fn rows(folder: &Path, name: &str) -> Vec<Vec<f64>> {
    let mut table = csv::Reader::from_path(folder.join(format!("{name}.csv"))).unwrap();
    table.deserialize().map(Result::unwrap).collect()
}

/// The heave in full is out of the legs' stroke, and said to be; what is scaled keeps all limits. Either is a landing.
fn the_platform_is_flagged(case: &Value) {
    let on_platform = &case["platform"];
    // 1.1 m less 1.45 m
    assert!(number(&on_platform["lowest_about_home"]) < -0.3);
    let [full, scaled] = ["full", "scaled"].map(|name| &on_platform[name]);
    assert_eq!((&full["within_limits"], &scaled["within_limits"]), (&Value::from(false), &Value::from(true)));
    let longest = numbers(&full["leg_length"])[1];
    assert!((longest - 1.70 - number(&full["out_of_stroke"])).abs() < 1e-12 && longest > 3.0);
    assert_eq!(number(&scaled["out_of_stroke"]), 0.0);
    let [scale, middle] = ["scale", "middle"].map(|name| number(&scaled[name]));
    assert!(scale > 0.1 && scale < 0.3 && middle == 1.1, "{scale} {middle}");
    for (name, expected) in [("touchdown_time", 5e-3), ("relative_velocity", 2e-3), ("horizontal_offset", 1e-5)] {
        let difference = number(&full["difference"][name]);
        let exact = number(&case["exact"][name]);
        // The exact deck on the raised platform is that of the thesis, to what the integrator leaves.
        assert!((number(&full[name]) - exact - difference).abs() < 1e-7, "{name}");
        assert!(difference != 0.0 && difference.abs() < expected, "{name}: {difference}");
    }
    assert!(number(&full["tracking_error_max"]) > 100.0 * number(&full["tracking_error_touchdown"]));
}

/// The forces of figures 5.5 and 5.9 against Lagrange's equation of the heave alone, by hand: with the legs' horizontal
/// reach c, `l² = z² + c²`, the sine `z/l` of a leg's elevation, its turning `c ż / l²`, and
///
/// ```text
/// 6 F z/l = M z̈ + ½ M′ ż² + V′
/// ```
fn forces_of_the_legs_are_lagranges(folder: &Path, case: &str, heave: Heave<4>, on_platform: &Value) {
    let middle = number(&on_platform["full"]["middle"]);
    let (platform, g) = (250.0, 9.80665);
    let (cylinder, centre, piston, top, turning) = (35.0, 0.35, 15.0, 0.4, 3.0 + 1.5 + 35.0 * 0.35 * 0.35);
    let c2: f64 = 1.308_634_132_273_f64.powi(2) - 1.21;
    let mass = |z: f64| {
        let l2 = z * z + c2;
        let turned = turning + piston * (l2.sqrt() - top).powi(2);
        platform + 6.0 * (turned * c2 / (l2 * l2) + piston * z * z / l2)
    };
    let table = rows(folder, &format!("case_{case}_legs"));
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for row in &table {
        let Reference { value, rate, acceleration } = heave.at(row[0]);
        let (z, h) = (middle + value, 1e-4);
        let l = (z * z + c2).sqrt();
        assert!((row[1] - l).abs() < 1e-9 && (row[7] - rate * z / l).abs() < 1e-9);
        let slope = (mass(z + h) - mass(z - h)) / (2.0 * h);
        let rise = c2 / l.powi(3);
        let weight = platform * g + 6.0 * g * (cylinder * centre * rise + piston * (1.0 - top * rise));
        let force = (mass(z) * acceleration + 0.5 * slope * rate * rate + weight) * l / z / 6.0;
        for found in &row[13..19] {
            assert!((found - force).abs() < 1e-5 * platform * g, "{found}, not {force}");
            range = [range[0].min(*found), range[1].max(*found)];
        }
    }
    assert_eq!(range, ["min", "max"].map(|key| number(&on_platform["leg_force"][key])));
}

/// Rows end at the touchdown: the height over the deck comes down to what the vehicle sinks from one row to the next,
/// at a little more than 0.2 m/s.
fn tables_of_the_platform_are_landings(folder: &Path, name: &str) {
    let table = rows(folder, name);
    assert!(table.len() > 1300 && table[0].len() == 3 + 12 + 18, "{name}");
    assert!(table.iter().all(|row| row[2] > 0.0), "{name}");
    let [before, last] = [2, 1].map(|back| &table[table.len() - back]);
    let period = last[0] - before[0];
    assert!((period - 0.01).abs() < 1e-9 && last[2] < 0.21 * period, "{name}");
}

fn the_deck_at_sea_is_met(marine: &Value) {
    for flight in ["exact", "small_angle", "lqr", "ground_effect"] {
        let end = &marine[flight];
        let [offset, velocity, attitude] =
            ["offset_deck", "velocity_deck", "attitude_deck_deg"].map(|name| numbers(&end[name]));
        assert!(offset[2].abs() < 1e-9 && velocity[2] == number(&end["relative_velocity"]), "{flight}");
        assert!((offset[0].hypot(offset[1]) - number(&end["horizontal_offset"])).abs() < 1e-15, "{flight}");
        assert!(velocity[2] < -0.15 && velocity[2] > -0.25 && offset[0].hypot(offset[1]) < 0.02, "{flight}");
        // A deck that rolls by 6.5° and pitches by 3.5° at most; the yaw is followed.
        assert!(attitude[0].abs() < 7.0 && attitude[1].abs() < 4.0 && attitude[2].abs() < 0.5, "{flight}");
    }
    assert_eq!(marine["platform"]["full"]["within_limits"], false);
    assert_eq!(marine["platform"]["scaled"]["within_limits"], true);
}

/// A steady wind W pushes by `½ C ρ A W²/m` along each axis, which the horizontal channel with `1 + k₁ k₂ = 2` yields
/// to by half of that \[m\]; the platform is at most 1.45 m off its mean height of 3 m, and W with it.
fn gusts_scatter_landings_about_those_in_steady_wind(gusts: &Value) {
    assert_eq!(keys(gusts), ["I", "II"]);
    let wind = |height: f64| 6.0 * (height / 0.3048 / 0.15_f64).ln() / (20.0 / 0.15_f64).ln();
    let offset = |height: f64| {
        let [x, y] = [0.75_f64.sqrt(), 0.5].map(|part| 0.5 * 1.225 * 0.5 * (part * wind(height)).powi(2) / 40.0 / 2.0);
        x.hypot(y)
    };
    for case in ["I", "II"] {
        let case = &gusts[case];
        assert_eq!((number(&case["members"]), number(&case["failed"])), (200.0, 0.0));
        let steady = number(&case["steady_wind"]["horizontal_offset"]);
        assert!(steady > 0.9 * offset(1.55) && steady < 1.1 * offset(4.45), "{steady}");
        let [mean, deviation] = numbers(&case["horizontal_offset"])[..] else { panic!("a spread") };
        assert!((mean - steady).abs() < deviation && deviation > 0.01, "{mean} ± {deviation} m about {steady} m");
        assert!(number(&case["horizontal_offset_max"]) > mean + deviation);
        let [time, spread] = numbers(&case["touchdown_time"])[..] else { panic!("a spread") };
        assert!((time - number(&case["steady_wind"]["touchdown_time"])).abs() < 3.0 * spread, "{time} ± {spread} s");
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
        // Student's 97.5 % of 23 degrees of freedom: tables have 2.069.
        let student = 0.5 * (high - low) / (deviation / 24.0_f64.sqrt());
        assert!((student - 2.069).abs() < 5e-4, "{name}: {student}");
    }
    assert_ne!(one["digest"], json(&good(MONTE_CARLO, &["--json", "--members", "23"]))["digest"]);
}

/// The landings of a plan: a table of rows that do not depend on threads.
#[test]
fn landings_of_a_plan_are_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let with = |threads: &str| {
        let table = folder.path().join(format!("{threads}.csv"));
        let file = table.to_str().unwrap();
        let found = json(&good(SWEEP, &["--json", "--members", "12", "--threads", threads, "--table", file]));
        (found, std::fs::read_to_string(table).unwrap())
    };
    let (one, table) = with("1");
    assert_eq!((&one, &table), (&with("2").0, &with("3").1));
    assert_eq!((&one["members"], &one["stopped"]), (&Value::from(12), &Value::from(0)));
    let rows: Vec<&str> = table.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!((rows.len(), rows[0].split(',').count()), (13, 1 + 9 + 3 + 1));
    // As fast as the reference touches down, but for what is scattered.
    let [mean, deviation] = ["mean", "sd"].map(|key| numbers(&one["touchdown_time"][key])[0]);
    assert!((mean - 13.25).abs() < 0.5 && deviation > 0.0, "{one}");
}

/// Whatever the sea and the sensors, it comes down at about the rate that is planned over the deck, 0.2 m/s.
#[test]
fn seas_and_sensors_are_drawn() {
    let plan = Path::new(env!("CARGO_MANIFEST_DIR")).join("ensembles/landing_seas.toml");
    let found = json(&good(SWEEP, &["--json", "--plan", plan.to_str().unwrap(), "--members", "24"]));
    assert_eq!((&found["members"], &found["stopped"]), (&Value::from(24), &Value::from(0)));
    let [mean, deviation] = ["mean", "sd"].map(|key| number(&found["relative_velocity"][key]));
    assert!((mean + 0.2).abs() < 0.05 && deviation > 1e-3, "{found}");
}

/// Bounds are those of independent landings; those of the design `chaos` are no sample.
#[test]
fn landings_have_bounds_where_a_plan_draws_them_independently() {
    let folder = tempfile::tempdir().unwrap();
    let with = |design: &str, json: &[&str]| {
        let plan = folder.path().join(format!("{design}.toml"));
        let members = if design == "chaos" { "" } else { "members = 6\n" };
        let text = format!("design = \"{design}\"\n{members}[vary]\nx = {{ uniform = [-1, 1] }}\n");
        std::fs::write(&plan, text).unwrap();
        run(SWEEP, &[&["--plan", plan.to_str().unwrap()], json].concat())
    };
    let printed = |output: Output| String::from_utf8(output.stdout).unwrap();
    for (design, bounds) in [("random", 3), ("latin-hypercube", 0), ("sobol", 0), ("saltelli", 0)] {
        let found = json(&printed(with(design, &["--json"])));
        for (name, _) in found.as_object().unwrap().iter().filter(|(_, entry)| entry["mean"].is_number()) {
            let entry = &found[name];
            assert_eq!((entry["ci95"].is_array(), &entry["q99_ci95"]), (bounds > 0, &Value::Null), "{design}: {found}");
        }
        let text = printed(with(design, &[]));
        let bounded = |line: &&str| line.contains(" mean ") && line.contains(" to ");
        assert_eq!(text.lines().filter(bounded).count(), bounds, "{text}");
    }
    let refused = with("chaos", &[]);
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(1) && told.contains("points with weights"), "{told}");
}

#[test]
fn wrong_usage_ends_with_2() {
    for arguments in [["--members", "1"], ["--members", "many"]] {
        refused(MONTE_CARLO, &arguments);
    }
}
