//! `mbs eval`: the JSON of DESIGN section 8 to the letter, and states that are refused.

use serde_json::{Value, json};

use crate::{Workshop, keys};

/// Numbers agree to rounding; everything else is equal.
fn assert_close(found: &Value, expected: &Value) {
    match (found, expected) {
        (Value::Number(found), Value::Number(expected)) => {
            let (found, expected) = (found.as_f64().unwrap(), expected.as_f64().unwrap());
            assert!((found - expected).abs() <= 1e-13 * expected.abs().max(1.0), "{found} instead of {expected}");
        }
        (Value::Array(found), Value::Array(expected)) => {
            assert_eq!(found.len(), expected.len());
            found.iter().zip(expected).for_each(|(found, expected)| assert_close(found, expected));
        }
        (Value::Object(entries), Value::Object(expected_entries)) => {
            assert_eq!(keys(found), keys(expected));
            entries.values().zip(expected_entries.values()).for_each(|(found, expected)| assert_close(found, expected));
        }
        _ => assert_eq!(found, expected),
    }
}

#[test]
fn a_pendulum_by_hand() {
    let (m, l, g, b): (f64, f64, f64, f64) = (3.0, 2.0, 10.0, 0.5);
    let (theta, omega, alpha, tau): (f64, f64, f64, f64) = (0.3, 0.7, -0.2, 1.1);
    let inertia = m * l * l;
    let gravity = m * g * l * theta.sin();
    let acceleration = (tau - gravity - b * omega) / inertia;
    let potential = m * g * l * (1.0 - theta.cos());
    let expected = json!({
        "mass_matrix": [[inertia]],
        "coriolis_matrix": [[0.0]],
        "gravity": [gravity],
        "bias": [gravity],
        "dissipation_force": [b * omega],
        "generalized_force": [tau],
        "inverse_dynamics": [inertia * alpha + gravity + b * omega],
        "inverse_dynamics_jacobian": { "q": [[m * g * l * theta.cos()]], "qd": [[b]] },
        "forward_dynamics": [acceleration],
        "linearize": {
            "q": [[-g / l * theta.cos()]],
            "qd": [[-b / inertia]],
            "u": [[1.0 / inertia]],
            "params": [[
                -(tau - b * omega) / (inertia * m),
                -2.0 * (tau - b * omega) / (inertia * l) + gravity / (inertia * l),
                -theta.sin() / l,
                -omega / inertia,
            ]],
        },
        "multipliers": [],
        "kinetic_energy": 0.5 * inertia * omega * omega,
        "potential_energy": potential,
        "conserved": { "energy_integral": 0.5 * inertia * omega * omega + potential },
        "outputs": { "height": l * (1.0 - theta.cos()) },
    });
    let state =
        r#"{"t": 1, "q": [0.3], "qd": [0.7], "qdd": [-0.2], "u": [1.1], "params": {"b": 0.5}, "prescribed": {}}"#;
    assert_close(&Workshop::new().eval("pendulum.mbs", state), &expected);
}

#[test]
fn arrays_matrices_poses_and_conserved_momenta() {
    let workshop = Workshop::new();
    let found = workshop.eval("chain.mbs", r#"{"q": [1, 3], "qd": [4, 5], "u": []}"#);
    assert_close(&found["mass_matrix"], &json!([[1.0, 0.0], [0.0, 2.0]]));
    assert_close(&found["forward_dynamics"], &json!([10.0, -5.0]));
    assert_close(&found["linearize"]["u"], &json!([[], []]));
    assert_close(&found["linearize"]["params"], &json!([[-10.0, 0.0, 2.0], [0.0, 2.5, -1.0]]));
    assert_close(&found["conserved"], &json!({ "energy_integral": 43.0 }));
    let hand = json!({ "position": [0.0, 1.0, 1.0], "rotation": [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] });
    assert_close(&found["outputs"], &json!({ "middle": [2.0, 0.0, 1.0], "hand": hand }));
}

/// `y = 2 sin x`: `J = 2 cos x`, `J̇ = −2 ẋ sin x`; only where it is asked for, other keys as before.
#[test]
fn rates_of_jacobians_stand_beside_their_outputs() {
    let workshop = Workshop::new();
    workshop.write(
        "pendulum.mbs",
        crate::PENDULUM.replace("output height", "output swing = 2*sin(theta), jacobian_rate; output height"),
    );
    let state = r#"{"q": [0.3], "qd": [0.7]}"#;
    let found = workshop.eval("pendulum.mbs", state);
    assert_eq!(crate::keys(&found["outputs"]), ["swing", "swing_jacobian_rate", "height"]);
    assert_close(&found["outputs"]["swing_jacobian_rate"], &json!([[-2.0 * 0.7 * 0.3f64.sin()]]));
    let table = workshop.good(&["ops", "pendulum.mbs"]);
    assert!(table.lines().any(|row| row.starts_with("swing_jacobian_rate ")), "{table}");
}

/// Of a mass on a rod in polar form by hand; at the accelerations of the motion, or at those that are given.
#[test]
fn reactions_by_joint() {
    let workshop = Workshop::new();
    assert!(workshop.eval("pendulum.mbs", r#"{"q": [0.3]}"#)["reactions"].is_null(), "only where there are any");
    workshop.write(
        "chain.mbs",
        "mechanism Chain { param m: kg = 2; param l: m = 0.5; param g: m/s^2 = 10; coord q[2]: rad; input tau: N*m; \
         let mut link = world; force q[1] += tau; \
         for i in 0..2 { link = link*rot_y(-q[i]); reaction joint[i] at link; link = link*translation([0, 0, -l]); \
         kinetic += particle(m, link.origin()); potential += m*g*link.origin().z; } }",
    );
    // Straight down and at rest, but for the torque on the elbow.
    let found = workshop.eval("chain.mbs", r#"{"q": [0, 0], "qdd": [0, 4], "u": [1]}"#);
    let wrench = |force: [f64; 3], moment: f64| json!({ "force": force, "moment": [0.0, moment, 0.0] });
    let reactions = json!({ "joint_0": wrench([4.0, 0.0, 40.0], -4.0), "joint_1": wrench([4.0, 0.0, 20.0], -2.0) });
    assert_close(&found["reactions"], &reactions);
    let found = workshop.eval("chain.mbs", r#"{"q": [0, 0], "u": [1]}"#);
    assert_close(&found["reactions"]["joint_0"]["moment"], &json!([0.0, 0.0, 0.0]));
    assert_close(&found["reactions"]["joint_1"]["moment"], &json!([0.0, -1.0, 0.0]));
    let report: Value = serde_json::from_str(&workshop.good(&["derive", "chain.mbs", "--emit", "json"])).unwrap();
    let joint = &report["functions"]["joint"];
    assert_eq!(joint["arguments"], json!(["q", "qd", "qdd"]));
    assert_eq!(joint["returns"][0]["shape"], json!(["wrenches", 2]));
    let table = workshop.good(&["ops", "chain.mbs"]);
    assert!(table.lines().any(|row| row.starts_with("joint ")), "{table}");
}

#[test]
fn parameters_by_name_whole_or_by_component() {
    let workshop = Workshop::new();
    let mass_matrix = |params: &str| {
        let found = workshop.eval("chain.mbs", &format!("{{\"q\": [0, 0], \"params\": {params}}}"));
        found["mass_matrix"].clone()
    };
    assert_close(&mass_matrix("{}"), &json!([[1.0, 0.0], [0.0, 2.0]]));
    assert_close(&mass_matrix(r#"{"m": [3, 4]}"#), &json!([[3.0, 0.0], [0.0, 4.0]]));
    assert_close(&mass_matrix(r#"{"m_1": 7}"#), &json!([[1.0, 0.0], [0.0, 7.0]]));
}

/// `y = l (1 − cos θ)`: its velocity and Jacobian are there for the asking.
#[test]
fn quantities_are_chosen_by_name() {
    let workshop = Workshop::new();
    let run =
        |only: &str| workshop.good(&["eval", "pendulum.mbs", "--state", r#"{"q": [0.3], "qd": [2]}"#, "--only", only]);
    let found: Value = serde_json::from_str(&run("height_velocity,mass_matrix,height_jacobian,outputs")).unwrap();
    assert_eq!(keys(&found), ["height_velocity", "mass_matrix", "height_jacobian", "outputs"]);
    let slope = 2.0 * 0.3f64.sin();
    assert_close(&found["height_velocity"], &json!(2.0 * slope));
    assert_close(&found["height_jacobian"], &json!([[slope]]));
    assert_close(&found["mass_matrix"], &json!([[12.0]]));
    let report = workshop.bad(&["eval", "pendulum.mbs", "--state", r#"{"q": [0.3]}"#, "--only", "mass_matrx"]);
    assert_eq!(report, "error: --only: there is no quantity `mass_matrx`; did you mean \"mass_matrix\"?\n");
}

#[test]
fn an_array_of_states_gives_an_array_of_results() {
    let workshop = Workshop::new();
    workshop.write("states.json", r#"[{"q": [0.1]}, {"q": [0.2], "qd": [1]}]"#);
    let many = workshop.eval("pendulum.mbs", "states.json");
    assert_eq!(many[0], workshop.eval("pendulum.mbs", r#"{"q": [0.1]}"#));
    assert_eq!(many[1], workshop.eval("pendulum.mbs", r#"{"q": [0.2], "qd": [1]}"#));
    assert_eq!(many.as_array().unwrap().len(), 2);
    assert_eq!(workshop.eval("pendulum.mbs", "[]"), json!([]));
}

/// A mass that is read and printed again: every digit survives both ways.
#[test]
fn numbers_survive_both_ways() {
    let workshop = Workshop::new();
    for mass in
        ["0.1", "1.0000000000000002", "2.2250738585072014e-308", "1.7976931348623157e308", "0.30000000000000004"]
    {
        let state = format!(r#"{{"q": [0, 0], "params": {{"m": [{mass}, 2]}}}}"#);
        let outcome = workshop.mbs(&["eval", "chain.mbs", "--state", &state]);
        let found: Value = serde_json::from_str(&outcome.stdout).unwrap();
        let printed = found["mass_matrix"][0][0].to_string();
        assert_eq!(printed.parse::<f64>().unwrap().to_bits(), mass.parse::<f64>().unwrap().to_bits());
    }
}

#[test]
fn what_is_not_finite_is_null_and_said_so() {
    let workshop = Workshop::new();
    let outcome = workshop.mbs(&["eval", "pendulum.mbs", "--state", r#"{"q": [0.5], "params": {"l": 0}}"#]);
    assert_eq!(outcome.code, 0);
    let found: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!((&found["forward_dynamics"], &found["mass_matrix"]), (&json!([null]), &json!([[0.0]])));
    let warning = "warning: infinite or NaN at the state, printed as null: forward_dynamics, linearize\n";
    assert_eq!(outcome.stderr, warning);
}

#[test]
fn wrong_states_are_refused_by_name() {
    let workshop = Workshop::new();
    let table = [
        ("{}", r#""q" is missing: 2 numbers (x_0, x_1), or one of them by its name"#),
        (r#"{"q": [1]}"#, r#""q" must hold 2 numbers (x_0, x_1), found 1"#),
        (r#"{"q": [1, 2], "qd": [1, 2, 3]}"#, r#""qd" must hold 2 numbers (x_0, x_1), found 3"#),
        (r#"{"q": [1, 2], "qdd": []}"#, r#""qdd" must hold 2 numbers (x_0, x_1), found 0"#),
        (r#"{"q": [1, 2], "u": [1]}"#, r#""u" must hold 0 numbers, found 1"#),
        (r#"{"q": 1}"#, r#""q" must be an array of 2 numbers (x_0, x_1), found the number 1"#),
        (r#"{"q": [1, NaN]}"#, r#""q"[1] (x_1) must be a finite number, found NaN"#),
        (r#"{"q": [1, -Infinity]}"#, r#""q"[1] (x_1) must be a finite number, found -Infinity"#),
        (r#"{"q": [1, "2"]}"#, r#""q"[1] (x_1) is "2": write a number and its unit, as in "20 deg""#),
        (r#"{"q": [1, "2 kg"]}"#, r#""q"[1] (x_1) is "2 kg": its unit `kg` does not fit, m is wanted"#),
        (r#"{"q": [1, null]}"#, r#""q"[1] (x_1) must be a finite number, found null"#),
        (r#"{"q": [1, 2], "t": []}"#, r#""t" must be a finite number, found an array"#),
        (r#"{"q": [1, 2], "dq": [1, 2]}"#, r#"unknown key "dq"; did you mean "qd"?"#),
        (r#"{"q": [1, 2], "speed": 1}"#, r#"unknown key "speed"; the keys are t, q, qd, qdd, u, params, prescribed"#),
        (r#"{"q": [1, 2], "params": [1]}"#, r#""params" must be an object {name: value}, found an array"#),
        (r#"{"q": [1, 2], "params": {"K": 1}}"#, r#"unknown parameter "params"."K"; did you mean "k"?"#),
        (
            r#"{"q": [1, 2], "params": {"stiffness": 1}}"#,
            r#"unknown parameter "params"."stiffness"; the parameters are m, k"#,
        ),
        (
            r#"{"q": [1, 2], "params": {"m": 1}}"#,
            r#""params"."m" must be an array of 2 numbers (m_0, m_1), found the number 1"#,
        ),
        (r#"{"q": [1, 2], "params": {"m": [1]}}"#, r#""params"."m" must hold 2 numbers (m_0, m_1), found 1"#),
        (r#"{"q": [1, 2], "params": {"k": [1]}}"#, r#""params"."k" must be a finite number, found an array"#),
        (
            r#"{"q": [1, 2], "prescribed": {"heave": [0, 0, 0]}}"#,
            r#"unknown signal "prescribed"."heave"; the mechanism has no prescribed signals"#,
        ),
        (
            r#"{"q": [1, 2], "params": {"m": [1, 2], "m_0": 3}}"#,
            r#""params"."m_0" is given twice, by itself and in "params"."m""#,
        ),
        ("7", r#"a state is an object {"q": […], …}, found the number 7"#),
    ];
    for (state, message) in table {
        workshop.write("state.json", state);
        assert_eq!(
            workshop.bad(&["eval", "chain.mbs", "--state", "state.json"]),
            format!("error: state.json: {message}\n")
        );
    }
}

#[test]
fn every_mistake_of_every_state_is_reported() {
    let workshop = Workshop::new();
    let report = workshop.bad(&["eval", "chain.mbs", "--state", r#"[{"q": [1, 2]}, {"q": [1], "z": 0}, 3]"#]);
    let expected = "\
error: --state: state 1: unknown key \"z\"; the keys are t, q, qd, qdd, u, params, prescribed
error: --state: state 1: \"q\" must hold 2 numbers (x_0, x_1), found 1
error: --state: state 2: a state is an object {\"q\": […], …}, found the number 3
";
    assert_eq!(report, expected);
}

#[test]
fn broken_files_are_refused_at_their_place() {
    let workshop = Workshop::new();
    workshop.write("broken.json", "{\"q\": [1, 2],\n \"qd\": [1 2]}");
    let report = workshop.bad(&["eval", "chain.mbs", "--state", "broken.json"]);
    let expected = "\
error[MBS0310]: unreadable JSON: expected `,` or `]`
 --> broken.json:2:11
  |
2 |  \"qd\": [1 2]}
  |           ^
";
    assert_eq!(report, expected);
    workshop.write("twice.json", "{\"q\": [1, 2], \"params\": {\"k\": 1,\n \"m\": [1, 2], \"k\": 2}}");
    let report = workshop.bad(&["eval", "chain.mbs", "--state", "twice.json"]);
    let expected = "\
error[MBS0310]: unreadable JSON: the key \"k\" stands here twice
 --> twice.json:2:17
  |
2 |  \"m\": [1, 2], \"k\": 2}}
  |                 ^
";
    assert_eq!(report, expected);
    let report = workshop.bad(&["eval", "chain.mbs", "--state", r#"{"q": [1, 2], "q": [3, NaN]}"#]);
    assert!(report.contains("the key \"q\" stands here twice"), "{report}");
    workshop.write("huge.json", "{\"q\": [1, 1e999]}");
    let report = workshop.bad(&["eval", "chain.mbs", "--state", "huge.json"]);
    assert!(report.starts_with("error[MBS0310]: unreadable JSON: number out of range\n --> huge.json:1:"), "{report}");
    workshop.write("binary.json", b"\xff\xfe");
    assert_eq!(
        workshop.bad(&["eval", "chain.mbs", "--state", "binary.json"]),
        "error: binary.json is not UTF-8 text\n"
    );
    let report = workshop.bad(&["eval", "chain.mbs", "--state", "missing.json"]);
    assert!(report.starts_with("error: cannot read missing.json: "), "{report}");
    assert!(workshop.bad(&["eval", "chain.mbs", "--state", "."]).starts_with("error: cannot read .: "));
}

/// The contract takes them for zero; a motion that was forgotten is not kept quiet about.
#[test]
fn signals_that_are_left_out_are_named() {
    let workshop = Workshop::new();
    workshop.write(
        "shaken.mbs",
        "mechanism Shaken { param m: kg = 1; param k: N/m = 2; coord x: m; prescribed p[2]: m; prescribed heave: m; \
         prescribed still: m = 0; kinetic += 1/2*m*(dt(x) + dt(p[0]) + dt(p[1]) + dt(heave))^2; potential += k*(x - still)^2; }",
    );
    let warned = |state: &str, expected: &str| {
        let found = workshop.mbs(&["eval", "shaken.mbs", "--state", state]);
        assert_eq!((found.code, found.stderr.as_str()), (0, expected), "{state}");
        assert!(found.stdout.contains("mass_matrix"));
    };
    warned(r#"{"q": [0]}"#, "warning: --state: \"prescribed\" does not give p_0, p_1, heave: zero, at rest\n");
    let all = r#"{"p_0": [0, 0, 0], "p_1": [0, 0, 0], "heave": [1, 0, 0]}"#;
    warned(&format!(r#"{{"q": [0], "prescribed": {all}}}"#), "");
    warned(
        &format!(
            r#"[{{"q": [0], "prescribed": {all}}}, {{"q": [0], "prescribed": {{"p_0": [0, 0, 0], "heave": [1, 0, 0]}}}}]"#
        ),
        "warning: --state: \"prescribed\" does not give p_1 in all states: zero, at rest\n",
    );
}

/// Outputs that depend on rates or inputs have derivatives by these, printed beside those by q; others have none to
/// show.
#[test]
fn derivatives_of_outputs_by_rates_and_inputs() {
    let workshop = Workshop::new();
    assert!(workshop.eval("pendulum.mbs", r#"{"q": [0.3]}"#)["output_jacobians"].is_null());
    let cart = "mechanism Cart { param m: kg = 2; coord x: m; coord y: m; input f[2]: N; \
                kinetic += 1/2*m*(dt(x)^2 + dt(y)^2); force x += f[0]; force y += f[1]; \
                output power = f[0]*dt(x)*y; output speed = [dt(x), 2*dt(y)]; output place = x; }";
    workshop.write("cart.mbs", cart.replace("*y;", "*sin(y/(1 m));"));
    let found = workshop.eval("cart.mbs", r#"{"q": [0.5, 0.3], "qd": [3, 4], "u": [5, 6]}"#);
    let (sin, cos) = 0.3_f64.sin_cos();
    let expected = json!({
        "power": { "q": [[0.0, 15.0 * cos]], "qd": [[5.0 * sin, 0.0]], "u": [[3.0 * sin, 0.0]] },
        "speed": { "q": [[0.0, 0.0], [0.0, 0.0]], "qd": [[1.0, 0.0], [0.0, 2.0]] },
    });
    assert_close(&found["output_jacobians"], &expected);
}

/// What two rows about one coordinate share is a matter of norm, what they bear together is not.
#[test]
fn redundant_rows_are_refused_or_share_what_they_bear() {
    let workshop = Workshop::new();
    let hung = "mechanism Hung { param m: kg = 2; param g: m/s^2 = 10; coord x: m; coord z: m; \
                kinetic += particle(m, [x, 0, z]); potential += m*g*z; constraint one: z = 0; constraint other: 3*z = -x^2/(1 m); }";
    workshop.write("hung.mbs", hung);
    let state =
        ["eval", "hung.mbs", "--state", r#"{"q": [0, 0]}"#, "--only", "forward_dynamics,multipliers,constraint_force"];
    let run = |rest: &[&str]| -> Value { serde_json::from_str(&workshop.good(&[&state, rest].concat())).unwrap() };
    let force = json!({ "forward_dynamics": [0.0, 0.0], "constraint_force": [0.0, 20.0] });
    for (rest, multipliers) in [
        // λ₁ + 3 λ₂ = m g with the least λ₁² + λ₂²,
        (&["--redundant", "least-norm"][..], json!([2.0, 6.0])),
        // and with the least λ₁² + (2 λ₂)²: rows are scaled by powers of two.
        (&[], json!([80.0 / 13.0, 60.0 / 13.0])),
    ] {
        let found = run(rest);
        assert_close(&found["multipliers"], &multipliers);
        assert_close(&found["forward_dynamics"], &force["forward_dynamics"]);
        assert_close(&found["constraint_force"], &force["constraint_force"]);
    }
    let report = workshop.bad(&[&state[..], &["--redundant", "refuse"]].concat());
    assert!(
        report.starts_with("error: constraint `") && report.contains("` depends on the others, at t = 0.0"),
        "{report}"
    );
    let idle = workshop.mbs(&["eval", "pendulum.mbs", "--state", r#"{"q": [0]}"#, "--redundant", "refuse"]);
    assert_eq!(
        (idle.code, idle.stderr.as_str()),
        (0, "warning: Pendulum has no constraints, --redundant does nothing\n")
    );
}

/// Rows that contradict each other leave no acceleration, however they are weighed.
#[test]
fn contradictions_are_null() {
    let workshop = Workshop::new();
    let text = "mechanism Torn { param m: kg = 2; param a: m/s^2 = 1; coord x: m; kinetic += 1/2*m*dt(x)^2; \
                constraint one: dt(x) = 0; constraint other: dt(x) = a*t; }";
    workshop.write("torn.mbs", text);
    for rest in [&[][..], &["--redundant", "least-norm"]] {
        let call = [&["eval", "torn.mbs", "--state", r#"{"q": [0]}"#, "--only", "forward_dynamics"], rest].concat();
        let found = workshop.mbs(&call);
        let value: Value = serde_json::from_str(&found.stdout).unwrap();
        assert_eq!((found.code, value), (0, json!({ "forward_dynamics": [null] })), "{}", found.stderr);
    }
}

/// What a list of a state and an array have in common is their name.
#[test]
fn arrays_that_are_called_as_lists_are_told_how_to_be_given() {
    let workshop = Workshop::new();
    let text = "mechanism Unsprung { param m: kg = 1; coord q[2]: m; coord u[2]: m; \
                for i in 0..2 { kinetic += 1/2*m*(dt(q[i])^2 + dt(u[i])^2); } }";
    workshop.write("unsprung.mbs", text);
    let refused = |state: &str| workshop.bad(&["eval", "unsprung.mbs", "--state", state]);
    let report = refused(r#"{"q": [1, 2], "u": [3, 4]}"#);
    let named =
        |key: &str| format!(r#"; "{key}" is the name of a variable, too, which is given by {{"q": {{"{key}": …}}}}"#);
    assert!(
        report.contains(&format!("\"q\" must hold 4 numbers (q_0, q_1, u_0, u_1), found 2{}", named("q"))),
        "{report}"
    );
    assert!(report.contains(&named("u")) && !report.contains("twice"), "{report}");
    workshop.eval("unsprung.mbs", r#"{"q": {"q": [1, 2], "u": [3, 4]}}"#);
    let report = refused(r#"{"q_0_dot": 1}"#);
    assert!(
        report.contains("\"q\" is missing: 4 numbers (q_0, q_1, u_0, u_1), or one of them by its name"),
        "{report}"
    );
}
