//! `mbs simulate`.

use crate::{Outcome, Workshop};

/// Header and rows of a CSV.
fn table(csv: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = csv.lines();
    let header = lines.next().unwrap().split(',').collect();
    let rows = lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    (header, rows)
}

/// The chain's masses 1 and 2 on a spring of 5 swing at `√(5/1 + 5/2)` against each other; their centre stays.
fn chain_at(t: f64) -> [f64; 4] {
    let omega = 7.5_f64.sqrt();
    let (stretch, rate) = (3.0 * (omega * t).cos(), -3.0 * omega * (omega * t).sin());
    [-2.0 / 3.0 * stretch, 1.0 / 3.0 * stretch, -2.0 / 3.0 * rate, 1.0 / 3.0 * rate]
}

const CHAIN_START: &str = r#"{"q": [-2, 1]}"#;

fn check_chain(arguments: &[&str], tolerance: f64, times: &[f64]) {
    let workshop = Workshop::new();
    let all = [&["simulate", "chain.mbs", "--state", CHAIN_START], arguments].concat();
    let csv = workshop.good(&all);
    let (header, rows) = table(&csv);
    assert_eq!(header, ["t", "x_0", "x_1", "x_0_dot", "x_1_dot", "energy"]);
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), times);
    for row in rows {
        for (found, expected) in row[1..5].iter().zip(chain_at(row[0])) {
            assert!((found - expected).abs() < tolerance, "{found} instead of {expected} at {}", row[0]);
        }
        assert!((row[5] - 22.5).abs() < 10.0 * tolerance);
    }
}

#[test]
fn rows_every_dt_and_one_at_the_end() {
    let times = [0.0, 0.25, 0.5, 0.75, 1.0, 1.1];
    check_chain(&["--t-end", "1.1", "--dt", "0.25"], 1e-9, &times);
    // 0.3/0.1 is not 3 in binary: the last row comes once, at the time asked for.
    check_chain(&["--t-end", "0.3", "--dt", "0.1", "--method", "dop853"], 1e-9, &[0.0, 0.1, 0.2, 0.3]);
    let fine: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.002).chain([2.0]).collect();
    check_chain(&["--t-end", "2"], 1e-9, &fine);
}

#[test]
fn rk4_steps_by_dt() {
    check_chain(&["--t-end", "0.5", "--method", "rk4", "--dt", "0.125"], 1e-2, &[0.0, 0.125, 0.25, 0.375, 0.5]);
    let fine: Vec<f64> = (0..512).map(|i| f64::from(i) / 1024.0).chain([0.5]).collect();
    check_chain(&["--t-end", "0.5", "--method", "rk4", "--dt", "0.0009765625"], 1e-11, &fine);
}

/// Ten steps of `--dt` are ten whenever the motion begins, also where times tell it only roughly.
#[test]
fn fixed_steps_do_not_depend_on_the_time() {
    let workshop = Workshop::new();
    let energies = "kinetic += 0.5 kg*dt(x)^2; potential += (9.81 N)*x;";
    workshop.write("fall.mbs", format!("mechanism Fall {{ coord x: m; {energies} }}"));
    let place = |start: &str, end: &str, method: &str, dt: &str| {
        let state = format!(r#"{{"t": {start}, "q": [0]}}"#);
        let all = ["simulate", "fall.mbs", "--state", &state, "--t-end", end, "--method", method, "--dt", dt];
        let csv = workshop.good(&all);
        let (_, rows) = table(&csv);
        rows[rows.len() - 1][1]
    };
    // −g h² (1 + 2 + … + 10); eleven steps in the same time end at −5.3509.
    for start in [0, 1, 8, 10, 100, 1000] {
        let [start, end] = [start, start + 1].map(|t: i32| t.to_string());
        let found = place(&start, &end, "semi-implicit-euler", "0.1");
        assert!((found + 5.3955).abs() < 1e-12, "{found} from t = {start}");
    }
    // A duration that is no multiple: four steps of 0.25 s.
    let found = place("0", "1", "semi-implicit-euler", "0.3");
    assert!((found + 9.81 * 0.0625 * 10.0).abs() < 1e-12, "{found}");
    // Where times of the clock are 2 s apart, a step of 0.1 s is still one.
    let found = place("10000000000000000", "10000000000000016", "gauss-legendre4", "0.1");
    assert!((14.0..=16.0).contains(&(-2.0 * found / 9.81).sqrt()), "{found}");
}

#[test]
fn tolerances_are_heeded() {
    let workshop = Workshop::new();
    let last = |tolerances: &[&str]| {
        let all =
            [&["simulate", "chain.mbs", "--state", CHAIN_START, "--t-end", "20", "--dt", "2"], tolerances].concat();
        let csv = workshop.good(&all);
        (table(&csv).1.last().unwrap()[1] - chain_at(20.0)[0]).abs()
    };
    let (coarse, fine) = (last(&["--rtol", "1e-4", "--atol", "1e-4"]), last(&["--rtol", "1e-12", "--atol", "1e-14"]));
    assert!(fine < 1e-10 && coarse > 100.0 * fine, "{coarse:e} {fine:e}");
}

#[test]
fn the_state_says_when_and_with_what() {
    let workshop = Workshop::new();
    let state = r#"{"t": 2, "q": [0.5], "qd": [0.1], "u": [7], "params": {"g": 0, "b": 0}}"#;
    let csv = workshop.good(&["simulate", "pendulum.mbs", "--state", state, "--t-end", "3", "--dt", "0.5"]);
    let (header, rows) = table(&csv);
    assert_eq!(header, ["t", "theta", "theta_dot", "energy"]);
    // Weightless and without friction: θ̈ = tau / m l².
    for row in &rows {
        let t = row[0] - 2.0;
        assert!((row[1] - (0.5 + 0.1 * t + 7.0 / 12.0 * t * t / 2.0)).abs() < 1e-9);
        assert!((row[2] - (0.1 + 7.0 / 12.0 * t)).abs() < 1e-9);
    }
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [2.0, 2.5, 3.0]);
    let once = workshop.good(&["simulate", "pendulum.mbs", "--state", state, "--t-end", "2"]);
    assert_eq!(table(&once).1.len(), 1);
}

#[test]
fn files_get_what_standard_output_would() {
    let workshop = Workshop::new();
    let run = ["simulate", "chain.mbs", "--state", CHAIN_START, "--t-end", "1"];
    let csv = workshop.good(&run);
    let files = ["--csv", "motion.csv", "--plot", "motion.svg"];
    assert_eq!(workshop.good(&[run.as_slice(), &files].concat()), "");
    assert_eq!(workshop.read("motion.csv"), csv);
    let svg = workshop.read("motion.svg");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
    for text in ["Chain", "t [s]", "coordinates [m]", "velocities [m/s]", "energy [J]", "x_1", "dx_0/dt", "T + V"] {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(workshop.good(&[run.as_slice(), &["--plot", "motion.png"]].concat()), csv);
    let png = std::fs::read(workshop.path("motion.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 10_000);
    assert_eq!(workshop.files(), ["chain.mbs", "motion.csv", "motion.png", "motion.svg", "pendulum.mbs"]);
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let workshop = Workshop::new();
    let bad = |state: &str, rest: &[&str]| {
        let all = [&["simulate", "pendulum.mbs", "--state", state, "--csv", "motion.csv", "--t-end"], rest].concat();
        workshop.bad(&all)
    };
    assert_eq!(bad("{}", &["1"]), "error: --state: \"q\" is missing: 1 number (theta), or one of them by its name\n");
    assert_eq!(bad(r#"[{"q": [0]}]"#, &["1"]), "error: a motion starts from one state, found an array of 1\n");
    assert_eq!(bad(r#"{"q": [0], "t": 1}"#, &["0.5"]), "error: --t-end 0.5 lies before the state's t = 1\n");
    assert_eq!(bad(r#"{"q": [0]}"#, &["-1"]), "error: --t-end -1 lies before the state's t = 0\n");
    let report = bad(r#"{"q": [0]}"#, &["1", "--dt", "1e-300"]);
    assert!(report.starts_with("error: --dt 1e-300 gives "), "{report}");
    let report = bad(r#"{"q": [0]}"#, &["1", "--plot", "missing/motion.svg"]);
    assert!(report.starts_with("error: cannot write missing/motion.svg: "), "{report}");
}

#[test]
fn an_integration_that_stops_says_where() {
    let workshop = Workshop::new();
    let state = r#"{"q": [0.5], "params": {"m": 0}}"#;
    let report = workshop.bad(&["simulate", "pendulum.mbs", "--state", state, "--t-end", "1", "--csv", "motion.csv"]);
    assert!(report.starts_with("error: the integration stopped: ") && report.lines().count() == 1, "{report}");
    assert!(report.contains("t = 0.0 s") && report.contains("q = [0.5], qd = [0.0]"), "{report}");
}

/// No NaN and no infinity in a table: 1/√r from the centre, √x of a negative x, forces that overflow.
#[test]
fn what_is_no_number_is_not_recorded() {
    let workshop = Workshop::new();
    let declare = |name: &str, statement: &str| {
        let text = format!(
            "mechanism M {{ param k: N*s^2/m^2 = 1; param c: N*m^2 = 1; param m: kg = 1; coord x: m; \
                            kinetic += 1/2*m*dt(x)^2; {statement} }}"
        );
        workshop.write(name, &text);
    };
    declare("well.mbs", "potential += -c/sqrt(x^2);");
    declare("blow_up.mbs", "force x += k*dt(x)^2;");
    let bad = |name: &str, state: &str, rest: &[&str]| {
        let all = [&["simulate", name, "--state", state, "--csv", "motion.csv"], rest].concat();
        workshop.bad(&all)
    };
    for end in ["0", "1"] {
        let report = bad("well.mbs", r#"{"q": [0]}"#, &["--t-end", end]);
        assert!(report.contains("error: T is 0.0, V is -inf, at t = 0.0, q = [0.0], qd = [0.0]\n"), "{report}");
    }
    // q̇ = 1/(1 − t). Fixed steps go past the end.
    for method in ["dop853", "dopri5", "rk4", "gauss-legendre4", "stormer-verlet", "semi-implicit-euler"] {
        let state = r#"{"q": [0], "qd": [1]}"#;
        let report =
            workshop.stopped(&["simulate", "blow_up.mbs", "--state", state, "--t-end", "5", "--method", method]);
        std::fs::remove_file(workshop.path("motion.csv")).unwrap();
        assert!(report.contains("error: the integration stopped: "), "{method}: {report}");
    }
    declare("pull.mbs", "force x += -c/x^2;");
    let report = bad("pull.mbs", r#"{"q": [0], "qd": [1]}"#, &["--t-end", "1"]);
    assert!(report.ends_with("at q = [0.0], qd = [1.0]; inertia or forces are not finite there\n"), "{report}");
}

#[test]
fn rk4_has_no_tolerances() {
    let workshop = Workshop::new();
    let run = ["simulate", "chain.mbs", "--state", CHAIN_START, "--t-end", "1", "--method", "rk4", "--rtol", "1e-3"];
    let Outcome { code, stderr, .. } = workshop.mbs(&run);
    assert_eq!(
        (code, stderr.as_str()),
        (0, "warning: rk4 has no error control, --rtol, --atol and --max-step do nothing\n")
    );
}

/// A push of one second out of ten, on a mass of 2 that is at rest; it is stepped over where that is allowed.
#[test]
fn short_pushes_are_not_stepped_over() {
    let workshop = Workshop::new();
    workshop.write("sled.mbs", "mechanism Sled { coord x: m; input f: N; kinetic += 1 kg*dt(x)^2; force x += f; }");
    let speed = |more: &[&str]| {
        let push = "f=if t > 5.2 && t < 6.2 { 1 } else { 0 }";
        let all = ["simulate", "sled.mbs", "--state", "{\"q\": [0]}", "--t-end", "10", "--input", push];
        let csv = workshop.good(&[&all, more].concat());
        table(&csv).1.last().unwrap()[2]
    };
    for options in [&[][..], &["--dt", "0.5"], &["--method", "dopri5"], &["--dt", "10", "--max-step", "0.1"]] {
        assert!((speed(options) - 0.5).abs() < 1e-8, "{options:?}: {}", speed(options));
    }
    assert_eq!(speed(&["--max-step", "10"]), 0.0);
}
