//! `mbs simulate` and `mbs check` of constrained mechanisms.

use serde_json::Value;

use crate::{Outcome, Workshop};

/// The pendulum of the other tests without friction, in Cartesian coordinates.
pub(crate) const ROD: &str = "\
mechanism Rod {
    param m: kg = 3;
    param l: m = 2;
    param g: m/s^2 = 10;
    coord x: m;
    coord z: m;
    kinetic += particle(m, [x, 0, z]);
    potential += m*g*z;
    constraint rod: (x^2 + z^2 - l^2)/l = 0;
}
";

/// Three equal parallel cranks carry a platform: one more than is needed.
pub(crate) const PARALLEL: &str = "\
mechanism Parallel {
    param m: kg = 2;
    param l: m = 0.5;
    param w: m = 1;
    param g: m/s^2 = 9.81;
    coord a[3]: rad;
    coord x: m;
    coord z: m;
    coord phi: rad;
    fn along(angle, length) = [length*cos(angle), 0, length*sin(angle)];
    for i in 0..3 {
        kinetic += 1/12*m*l^2*dt(a[i])^2;
    }
    kinetic += 1/2*m*(dt(x)^2 + dt(z)^2) + 1/24*m*w^2*dt(phi)^2;
    potential += m*g*z;
    constraint left: [x, 0, z] = along(phi, w/2) + along(a[0], l);
    constraint middle: [x, 0, z] = [w/2, 0, 0] + along(a[1], l);
    constraint right: [x, 0, z] = [w, 0, 0] - along(phi, w/2) + along(a[2], l);
}
";

/// The rod whose bob has an inertia of its own along z.
fn with_two_masses() -> String {
    let rod = ROD.replace("particle(m, [x, 0, z])", "1/2*m*dt(x)^2 + 1/2*m_z*dt(z)^2");
    rod.replace("param l:", "param m_z: kg = 1;\n    param l:")
}

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("rod.mbs", ROD);
    workshop.write("parallel.mbs", PARALLEL);
    workshop
}

/// The last row by column.
fn last(csv: &str) -> impl Fn(&str) -> f64 + use<> {
    let header: Vec<String> = csv.lines().next().unwrap().split(',').map(str::to_string).collect();
    let row: Vec<f64> = csv.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    move |name| row[header.iter().position(|column| column == name).unwrap()]
}

const START: &str = r#"{"q": [1.2, -1.6], "qd": [0.8, 0.6]}"#;

/// `θ` from below with `tan θ = 1.2/1.6`, `l θ̇ = 1`.
#[test]
fn the_rod_swings_as_the_pendulum_does() {
    let workshop = workshop();
    let state = format!(r#"{{"q": [{:?}], "qd": [0.5], "params": {{"b": 0}}}}"#, 0.75_f64.atan());
    let pendulum = last(&workshop.good(&["simulate", "pendulum.mbs", "--state", &state, "--t-end", "5"]));
    let (theta, rate) = (pendulum("theta"), pendulum("theta_dot"));
    let tension = 3.0 * (2.0 * rate * rate + 10.0 * theta.cos());
    for (method, tolerance) in [
        ("dop853", 1e-8),
        ("dopri5", 1e-7),
        ("gauss-legendre4", 1e-6),
        ("rk4", 1e-6),
        ("stormer-verlet", 0.1),
        ("semi-implicit-euler", 0.1),
    ] {
        let arguments = ["simulate", "rod.mbs", "--state", START, "--t-end", "5", "--dt", "0.005", "--method", method];
        let outcome = workshop.mbs(&arguments);
        let is_for_separable = tolerance == 0.1;
        assert_eq!(
            (outcome.code, outcome.stderr.starts_with("warning: ")),
            (0, is_for_separable),
            "{}",
            outcome.stderr
        );
        let rod = last(&outcome.stdout);
        for (name, expected) in [("x", 2.0 * theta.sin()), ("z", -2.0 * theta.cos())] {
            assert!((rod(name) - expected).abs() < tolerance, "{method}: {name} = {}", rod(name));
        }
        // (x² + z²)/l has the slope 2 along the rod.
        assert!((rod("lambda_rod") + tension / 2.0).abs() < 30.0 * tolerance, "{method}: {}", rod("lambda_rod"));
        assert!(rod("residual_rod").abs() < 1e-14, "{method}: {}", rod("residual_rod"));
    }
}

#[test]
fn drift_is_projected_stabilized_or_left() {
    let workshop = workshop();
    let residual = |how: &str| {
        let step = ["--method", "rk4", "--dt", "0.05", "--project", how];
        let run = [&["simulate", "rod.mbs", "--state", START, "--t-end", "50"], step.as_slice()].concat();
        last(&workshop.good(&run))("residual_rod")
    };
    let [projected, stabilized, left] = ["state", "baumgarte:10,10", "none"].map(|how| residual(how).abs());
    assert!(projected < 1e-14 && stabilized < left / 10.0 && stabilized > 1e-8, "{projected} {stabilized} {left}");
    // Without gains, the same equations by another factorization.
    assert!((residual("none") - residual("baumgarte:0,0")).abs() < 1e-9);
}

/// A projection takes away more where more error is allowed.
#[test]
fn loose_tolerances_are_no_branches() {
    let workshop = workshop();
    for method in ["dopri5", "dop853"] {
        for tolerance in ["1e-3", "1e-4"] {
            let options = ["--method", method, "--rtol", tolerance, "--atol", tolerance];
            let run = ["simulate", "rod.mbs", "--state", r#"{"q": [1.2, -1.6]}"#, "--t-end", "20"];
            let end = last(&workshop.good(&[run.as_slice(), &options].concat()));
            assert!(
                end("residual_rod").abs() < 1e-14 && end("energy") < 0.0,
                "{method} {tolerance}: {}",
                end("energy")
            );
        }
    }
}

#[test]
fn the_first_state_is_assembled() {
    let workshop = workshop();
    let run = |state: &str, rest: &[&str]| {
        let outcome = workshop.mbs(&[&["simulate", "rod.mbs", "--state", state, "--t-end", "0"], rest].concat());
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        (last(&outcome.stdout), outcome.stderr)
    };
    let (found, warning) = run(r#"{"q": [1.5, -2], "qd": [4, 0]}"#, &[]);
    assert!(warning.starts_with("warning: the state does not satisfy the constraints; the motion starts from q = ["));
    let (x, z) = (found("x"), found("z"));
    assert!((x - 1.2).abs() < 1e-14 && (z + 1.6).abs() < 1e-14, "{x} {z}");
    assert!((found("x_dot") - 2.56).abs() < 1e-14 && (found("z_dot") - 1.92).abs() < 1e-14);
    let (found, _) = run(r#"{"q": [1.2, -2], "qd": [4, 0]}"#, &["--hold", "x"]);
    assert_eq!((found("x"), found("x_dot")), (1.2, 4.0));
    assert!((found("z") + 1.6).abs() < 1e-14 && (found("z_dot") - 3.0).abs() < 1e-14);
    let (found, warning) = run(r#"{"q": [1.5, -2]}"#, &["--project", "none"]);
    assert_eq!((found("x"), found("z")), (1.5, -2.0));
    assert_eq!(warning, "warning: the motion starts off the constraints: `rod` by 1.125e0\n");
    let (found, warning) = run(r#"{"q": [1.2, -1.6], "qd": [1, 0]}"#, &["--project", "none"]);
    assert_eq!((found("x_dot"), found("z_dot")), (1.0, 0.0));
    assert_eq!(warning, "warning: the motion starts off the constraints: the rate of `rod` by 1.2e0\n");
}

/// Next to the centre of the circle Newton's first step is ten million lengths long.
#[test]
fn a_bad_guess_will_do() {
    let workshop = workshop();
    let run = |state: &str, rest: &[&str]| {
        let all = [&["simulate", "rod.mbs", "--state", state, "--t-end", "0"], rest].concat();
        let outcome = workshop.mbs(&all);
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        let found = last(&outcome.stdout);
        [found("x"), found("z")]
    };
    assert_eq!(run(r#"{"q": [1e-7, 0]}"#, &[]), [2.0, 0.0]);
    // All held, on the constraint.
    assert_eq!(run(r#"{"q": [1.2, -1.6], "qd": [0.8, 0.6]}"#, &["--hold", "x,z"]), [1.2, -1.6]);
}

/// The rod's mass in its other coordinate: M is singular, but not on the circle. `x = 2 cos α` without weight, `ẋ`
/// stays.
#[test]
fn inertia_is_needed_where_constraints_leave_motion() {
    let workshop = workshop();
    workshop.write("rod.mbs", with_two_masses());
    let state = r#"{"q": [1.2, -1.6], "qd": [0.8, 0.6], "params": {"m_z": 0, "g": 0}}"#;
    let end = last(&workshop.good(&["simulate", "rod.mbs", "--state", state, "--t-end", "0.5"]));
    assert!((end("x") - 1.6).abs() < 1e-12 && (end("z") + 1.2).abs() < 1e-12, "{} {}", end("x"), end("z"));
    assert!((end("x_dot") - 0.8).abs() < 1e-12 && end("lambda_rod").abs() < 1e-12);
    // At the side of the circle the motion is along z, and has none.
    let report = workshop.stopped(&["simulate", "rod.mbs", "--state", state, "--t-end", "5"]);
    assert!(report.starts_with("error: the integration stopped: "), "{report}");
    let nothing = r#"{"q": [2, 0], "params": {"m_z": 0}}"#;
    let report = workshop.bad(&["simulate", "rod.mbs", "--state", nothing, "--t-end", "5"]);
    assert!(report.starts_with("error: a motion that the constraints leave has no inertia, at t = 0.0"), "{report}");
}

/// A state that leaves out the quaternion of a free body: all its components are zero.
#[test]
fn a_quaternion_that_is_left_out_is_named() {
    let workshop = Workshop::new();
    workshop.write(
        "free.mbs",
        "mechanism Free { coord place[3]: m; coord attitude[4]: 1;
            kinetic += rigid_body(2 kg, [0, 0, 0], diag(1, 2, 3)*(1 kg*m^2), translation(place)*quaternion(attitude));
            constraint unit: attitude[0]^2 + attitude[1]^2 + attitude[2]^2 + attitude[3]^2 = 1; }",
    );
    let report = workshop.bad(&["simulate", "free.mbs", "--state", r#"{"place": [0, 0, 1]}"#, "--t-end", "1"]);
    let said = "; `unit` is open by -1e0, and at this state no coordinate changes it: give other values";
    assert!(report.contains(said), "{report}");
}

/// Hanging at rest, the rod carries the weight.
#[test]
fn the_force_of_constraints_is_evaluated() {
    let workshop = workshop();
    let evaluation = workshop.eval("rod.mbs", r#"{"q": [0, -2]}"#);
    // (x² + z²)/l has the slope −2 there.
    assert_eq!(evaluation["multipliers"], serde_json::json!([-15.0]));
    assert_eq!(evaluation["constraint_force"], serde_json::json!([0.0, 30.0]));
    assert!(workshop.eval("pendulum.mbs", r#"{"q": [1]}"#).get("constraint_force").is_none());
}

/// Points on a line that is hauled: how far is given, and how fast.
#[test]
fn prescribed_signals_that_contradict_themselves_are_named() {
    let workshop = Workshop::new();
    let hauled = "mechanism Hauled { param m: kg = 1; prescribed far: m; coord x: m; coord y: m; \
                  kinetic += particle(m, [x, y, 0]); constraint line: x = far; }";
    workshop.write("hauled.mbs", hauled);
    for (signal, warning) in [
        ("[1, 0, 0]", ""),
        (
            "[1, 2, 0]",
            "warning: prescribed signals stay as given: a value that stays contradicts a rate that is not zero\n",
        ),
    ] {
        let state = format!(r#"{{"q": [1, 0], "qd": [2, 1], "prescribed": {{"far": {signal}}}}}"#);
        let outcome = workshop.mbs(&["simulate", "hauled.mbs", "--state", &state, "--t-end", "0"]);
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        let warnings: Vec<&str> =
            outcome.stderr.split_inclusive('\n').filter(|line| line.contains("signals")).collect();
        assert_eq!(warnings.concat(), warning);
    }
}

#[test]
fn options_without_an_object_are_named() {
    let workshop = workshop();
    for (options, warning) in [
        (["--hold", "theta"], "warning: Pendulum has no constraints, --project, --redundant and --hold do nothing\n"),
        (["--project", "none"], "warning: Pendulum has no constraints, --project, --redundant and --hold do nothing\n"),
    ] {
        let run = ["simulate", "pendulum.mbs", "--state", r#"{"q": [1]}"#, "--t-end", "1"];
        let outcome = workshop.mbs(&[run.as_slice(), &options].concat());
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, warning));
    }
    let run = ["simulate", "rod.mbs", "--state", START, "--t-end", "1", "--project", "none", "--hold", "x"];
    let outcome = workshop.mbs(&run);
    let warning = "warning: with --project none the first state stays as given, --hold does nothing\n";
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, warning));
}

#[test]
fn what_does_not_close_is_refused() {
    let workshop = workshop();
    let bad = |state: &str, rest: &[&str]| {
        workshop.bad(&[&["simulate", "rod.mbs", "--state", state, "--t-end", "1", "--csv", "rod.csv"], rest].concat())
    };
    let report = bad(r#"{"q": [3, 1]}"#, &["--hold", "x"]);
    assert!(report.starts_with("error: the constraints do not close: `rod` stays open by "), "{report}");
    let hint = "at t = 0.0, q = [3.0, 1.0], qd = [0.0, 0.0]; `--hold` may leave too few coordinates free\n";
    assert!(report.ends_with(hint), "{report}");
    let report = bad(r#"{"q": [0, 0]}"#, &[]);
    assert!(
        report.starts_with("error: the constraints do not close: `rod` stays open by -2e0, at t = 0.0"),
        "{report}"
    );
    assert!(report.ends_with("; constraints lose rank there: another guess may do\n"), "{report}");
    let report = bad(START, &["--hold", "y"]);
    assert_eq!(report, "error: --hold: there is no coordinate `y`; the coordinates are x, z\n");
    for usage in
        [["--project", "states"], ["--project", "baumgarte:1"], ["--project", "baumgarte:-1,2"], ["--redundant", "no"]]
    {
        let outcome =
            workshop.mbs(&[&["simulate", "rod.mbs", "--state", START, "--t-end", "1"], usage.as_slice()].concat());
        assert_eq!((outcome.code, outcome.stdout.as_str()), (2, ""), "{usage:?}: {}", outcome.stderr);
    }
}

/// All cranks turn as one: `3/2 m l² α̈ = −m g l cos α`.
#[test]
fn redundant_rows_are_named_or_share_their_force() {
    let workshop = workshop();
    let state = r#"{"q": [1, 1, 1, 0.7701511529340698, 0.42073549240394825, 0]}"#;
    // The cranks lie in line at 0.49 s, where rows lose rank.
    let run = ["simulate", "parallel.mbs", "--state", state, "--t-end", "0.4"];
    let report = workshop.bad(&run);
    assert!(report.starts_with("error: constraint `"), "{report}");
    assert!(report.contains("depends on the others, at t = 0.0, q = [1.0, 1.0, 1.0, 0.77"), "{report}");
    let csv = workshop.good(&[run.as_slice(), &["--redundant", "least-norm"]].concat());
    let end = last(&csv);
    let one = "mechanism One { param l: m = 0.5; param m: kg = 2; param g: m/s^2 = 9.81; coord a: rad; \
               kinetic += 1/2*3/2*m*l^2*dt(a)^2; potential += m*g*l*sin(a); }";
    workshop.write("one.mbs", one);
    let expected = last(&workshop.good(&["simulate", "one.mbs", "--state", r#"{"q": [1]}"#, "--t-end", "0.4"]));
    for (name, value) in [("a_0", expected("a")), ("a_1", expected("a")), ("a_2", expected("a")), ("phi", 0.0)] {
        assert!((end(name) - value).abs() < 1e-9, "{name}: {} {value}", end(name));
    }
    assert!((end("energy") - expected("energy")).abs() < 1e-9);
    for [one, other] in
        [["left_1", "middle_1"], ["middle_1", "right_1"], ["left_0", "middle_0"], ["middle_0", "right_0"]]
    {
        let [one, other] = [one, other].map(|row| end(&format!("lambda_{row}")));
        assert!((one - other).abs() < 1e-6, "{one} {other}");
    }
    // Flattened, the parallelogram may go on as another: the motion ends there rather than on a branch of its choice.
    let run = ["simulate", "parallel.mbs", "--state", state, "--t-end", "3", "--redundant", "least-norm"];
    let report = workshop.stopped(&run);
    assert!(report.starts_with("error: the integration stopped: "), "{report}");
    assert!(report.contains("; constraints nearly lose rank there: but for "), "{report}");
    assert!(
        report.contains(" depends on the others, a fixed step (method rk4) or other tolerances may pass it, "),
        "{report}"
    );
}

/// The rows so far, which do not look as if they were all.
#[test]
fn a_motion_that_stops_is_written_as_far_as_it_came() {
    let workshop = workshop();
    // The bob without inertia along z comes to the height of the hinge at 1 s, infinitely fast.
    let state = r#"{"q": [1.2, -1.6], "qd": [0.8, 0.6], "params": {"m_z": 0, "g": 0}}"#;
    workshop.write("rod.mbs", with_two_masses());
    let run = ["simulate", "rod.mbs", "--state", state, "--t-end", "5", "--dt", "0.1"];
    let outcome = workshop.mbs(&run);
    assert_eq!(outcome.code, 1, "{}", outcome.stderr);
    let reason = "the integration stopped: the motion comes to a singular state at t = 0.9999999";
    assert!(outcome.stderr.starts_with(&format!("error: {reason}")), "{}", outcome.stderr);
    let way = "; a fixed step (method rk4) or other tolerances may pass it; ";
    assert!(outcome.stderr.contains(way), "{}", outcome.stderr);
    let lines: Vec<&str> = outcome.stdout.lines().collect();
    assert!(lines[10].starts_with("0.9,1.92"), "{:?}", lines[10]);
    assert!(lines[11].starts_with(&format!("# stopped: {reason}")) && lines.len() == 12, "{:?}", lines.last());
    let files = ["--csv", "rows.csv", "--plot", "rows.svg", "--gltf", "rows.glb"];
    let files = workshop.mbs(&[run.as_slice(), &files].concat());
    assert_eq!((files.code, files.stdout.as_str(), &files.stderr), (1, "", &outcome.stderr));
    assert_eq!(workshop.read("rows.csv"), outcome.stdout);
    assert!(workshop.read("rows.svg").contains("Rod, stopped after t = 0.9"));
    assert!(!workshop.path("rows.glb").exists());
    // What cannot be written is no reason to keep quiet about the motion.
    #[cfg(target_os = "linux")]
    {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let full = Outcome::of(crate::command(&workshop.path(""), &run).stdout(full).output().unwrap());
        let other = full.stderr.strip_prefix(&outcome.stderr).expect(&full.stderr);
        assert!(full.code == 1 && other.starts_with("error: cannot write to standard output: "), "{other}");
    }
    let json = workshop.mbs(&[run.as_slice(), &["--json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert!(json["stopped"].as_str().unwrap().starts_with(reason));
    assert_eq!(json["rows"].as_array().unwrap().len(), 10);
    let json = workshop.mbs(&[run.as_slice(), &["--json", "--csv", "rows.csv"]].concat());
    let json: Value = serde_json::from_str(&json.stdout).unwrap();
    assert!(json["stopped"].as_str().unwrap().starts_with(reason) && json["written"][0] == "rows.csv", "{json}");
}

/// The rod has full rank at all of its states.
#[test]
fn steps_that_are_too_long_are_not_called_singular_states_alone() {
    let workshop = workshop();
    let state = r#"{"q": [2, 0]}"#;
    let run = ["simulate", "rod.mbs", "--state", state, "--t-end", "3", "--dt", "0.07", "--method", "stormer-verlet"];
    let report = workshop.bad(&run);
    assert!(report.contains("and it may branch, or the steps are too long; another step may pass it, "), "{report}");
}

/// What is left of zero beside a length is not shown as a number that matters.
#[test]
fn states_are_shown_without_rounding() {
    let workshop = workshop();
    workshop.write("level.mbs", ROD.replace("potential += m*g*z", "constraint level: z = 0"));
    let run = ["simulate", "level.mbs", "--state", r#"{"q": [1.5, 1e-30], "qd": [1e-9, 1e-40]}"#, "--t-end", "0"];
    let warning = workshop.mbs(&run).stderr;
    assert!(warning.contains("the motion starts from q = [2.0, 0.0]"), "{warning}");
}

/// `ẋ = 0` and `ẋ = a t`: they agree on velocities at t = 0, and not on accelerations.
#[test]
fn accelerations_that_rows_contradict_end_the_motion() {
    let workshop = Workshop::new();
    let text = |other: &str| {
        format!(
            "mechanism Torn {{ param m: kg = 2; param a: m/s^2 = 1; coord x: m; kinetic += 1/2*m*dt(x)^2; \
             force x += m*a; constraint one: dt(x) = 0; constraint other: dt(x) = {other}; }}"
        )
    };
    workshop.write("torn.mbs", text("a*t"));
    workshop.write("whole.mbs", text("0"));
    for drift in ["none", "baumgarte:10,10"] {
        let run = |file: &str| {
            let rest = ["--t-end", "1", "--redundant", "least-norm", "--project", drift];
            workshop.mbs(&[["simulate", file, "--state", r#"{"q": [0]}"#].as_slice(), &rest].concat())
        };
        let torn = run("torn.mbs");
        assert_eq!((torn.code, torn.stdout.as_str()), (1, ""), "{drift}: {}", torn.stderr);
        assert!(torn.stderr.contains("` contradicts the others: "), "{drift}: {}", torn.stderr);
        assert!(torn.stderr.contains(" is left of it, at t = 0.0, q = [0.0]"), "{drift}: {}", torn.stderr);
        let whole = run("whole.mbs");
        assert_eq!(whole.code, 0, "{drift}: {}", whole.stderr);
        let end = last(&whole.stdout);
        assert!((end("lambda_one") + 1.0).abs() < 1e-12 && (end("lambda_other") + 1.0).abs() < 1e-12);
    }
}

#[test]
fn freedom_is_counted_by_rows_and_by_rank() {
    let workshop = workshop();
    let rod = workshop.good(&["check", "rod.mbs"]);
    assert!(rod.contains(", 1 constraint row: 1 degree of freedom; proved at "), "{rod}");
    // As small as a watch: 2 mm and a milligram.
    let small = ROD.replace("= 3", "= 1e-6").replace("l: m = 2", "l: m = 2e-3");
    workshop.write("small.mbs", small.replace("/l = 0", "/(1 m) = 0"));
    let small = workshop.good(&["check", "small.mbs"]);
    assert!(small.contains(", 1 constraint row: 1 degree of freedom; proved at "), "{small}");
    let parallel = workshop.good(&["check", "parallel.mbs"]);
    let expected = ", 6 constraint rows of rank 5: 1 degree of freedom (Grübler counts 0); proved at ";
    assert!(parallel.contains(expected), "{parallel}");
}

/// Bricard's mechanism: five links between six hinges in pairs of right angles move by one motion; with two links
/// folded onto each other, they move by two.
#[test]
fn freedom_depends_on_how_it_is_assembled() {
    let workshop = workshop();
    let text = "mechanism Bricard { param m: kg = 1; param l: m = 1; param g: m/s^2 = 9.81; coord a[5]: rad;
        gravity [0, -g, 0];
        let f1 = rot_y(a[0]);
        let f2 = f1*translation([l, 0, 0])*rot_z(a[1]);
        let f3 = f2*translation([0, -l, 0])*rot_x(a[2]);
        let f4 = f3*translation([0, 0, l])*rot_y(a[3]);
        let f5 = f4*translation([-l, 0, 0])*rot_z(a[4]);
        kinetic += rigid_body(m, [l/2, 0, 0], diag(0, 1, 1)*m*l^2/12, f1);
        kinetic += rigid_body(m, [0, -l/2, 0], diag(1, 0, 1)*m*l^2/12, f2);
        kinetic += rigid_body(m, [0, 0, l/2], diag(1, 1, 0)*m*l^2/12, f3);
        kinetic += rigid_body(m, [-l/2, 0, 0], diag(0, 1, 1)*m*l^2/12, f4);
        kinetic += rigid_body(m, [0, l/2, 0], diag(1, 0, 1)*m*l^2/12, f5);
        constraint hinge: f5.point([0, l, 0]) = [0, 0, l];
        let axis = f5*[1, 0, 0];
        constraint axis_y: axis.y = 0;
        constraint axis_z: axis.z = 0; }";
    workshop.write("bricard.mbs", text);
    let several = workshop.good(&["check", "bricard.mbs"]);
    let expected = ", 5 constraint rows of rank 3 or 4: 2 or 1 degrees of freedom, as it is assembled (Grübler counts 0); proved at ";
    assert!(several.contains(expected), "{several}");
    let assembled = workshop.good(&["check", "bricard.mbs", "--state", r#"{"q": [0, 0, 0, 0, 0]}"#]);
    let expected = ", 5 constraint rows of rank 4 at the state: 1 degree of freedom (Grübler counts 0); proved at ";
    assert!(assembled.contains(expected), "{assembled}");
    let object: Value = serde_json::from_str(&workshop.good(&["check", "bricard.mbs", "--json"])).unwrap();
    assert_eq!(object["degrees_of_freedom_found"], serde_json::json!([2, 1]));
}

#[test]
fn a_state_at_which_rows_are_missing_is_reported() {
    let workshop = workshop();
    // A wheel that may not slide along its axle, by two rows of which one is nothing where the axle is along x.
    let slides = "mechanism Wheels { param m: kg = 1; coord x: m; coord y: m; coord yaw: rad;
        kinetic += particle(m, [x, y, 0]) + 1/2*m*(1 m^2)*dt(yaw)^2;
        let axle = [cos(yaw), sin(yaw), 0];
        constraint blade: dt([x, y, 0]).dot(axle) = 0; constraint along: dt(x) = 0; }";
    workshop.write("slides.mbs", slides);
    let warning = "warning: at the state the rank of the constraints is 1, at other states 2, as `along` depends on other \
                   rows there, which leaves 2 degrees of freedom instead of 1; if the mechanism does not really gain a \
                   freedom there, a row is missing: `mbs explain MBS1006`\n";
    for command in ["eval", "linearize"] {
        let there = workshop.mbs(&[command, "slides.mbs", "--state", r#"{"yaw": 0}"#]);
        assert_eq!((there.code, there.stderr.as_str()), (0, warning), "{command}");
        workshop.good(&[command, "slides.mbs", "--state", r#"{"yaw": 0.3}"#]);
    }
    // Each state of an array is looked at.
    let states = r#"[{"yaw": 0}, {"yaw": 0.3}, {"yaw": 0}]"#;
    let each = workshop.mbs(&["eval", "slides.mbs", "--state", states]);
    let expected = [0, 2].map(|i| warning.replace("at the state", &format!("at state {i}"))).concat();
    assert_eq!((each.code, each.stderr), (0, expected));
    // What parameters make of a row is the same at other states.
    let scaled = slides.replace("dt(x) = 0", "k*dt(x) = 0").replace("param m", "param k: 1 = 1; param m");
    workshop.write("scaled.mbs", scaled);
    for k in [0, 1] {
        workshop.good(&["eval", "scaled.mbs", "--state", &format!(r#"{{"yaw": 0.3, "params": {{"k": {k}}}}}"#)]);
    }
    // No row is missing where rows depend on each other at every state on the constraints.
    workshop.good(&[
        "eval",
        "parallel.mbs",
        "--state",
        r#"{"a": ["90 deg", "90 deg", "90 deg"], "x": 0.5, "z": 0.5, "phi": 0}"#,
    ]);
}
