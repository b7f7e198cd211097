//! `mbs simulate`: inputs and signals over time, what is recorded, states by name.

use crate::{Outcome, Workshop};

/// A cart on a spring whose wall is shaken, pushed by an input.
const SHAKEN: &str = "\
mechanism Shaken {
    param m: kg = 2;
    param k: N/m = 8;
    param a: m = 0.1;
    coord x: m;
    input push: N;
    prescribed wall: m;
    kinetic += 1/2*m*dt(x + wall)^2;
    potential += 1/2*k*x^2;
    force x += push;
    output place = x + wall;
    output spot = [x + wall, 0, a];
}
";

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("shaken.mbs", SHAKEN);
    workshop
}

/// Header and last row.
fn last(csv: &str) -> (Vec<String>, Vec<f64>) {
    let header = csv.lines().next().unwrap().split(',').map(String::from).collect();
    let row = csv.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    (header, row)
}

const RUN: [&str; 6] = ["simulate", "shaken.mbs", "--state", r#"{"x": 0.3}"#, "--t-end", "2"];

fn run(workshop: &Workshop, rest: &[&str]) -> (Vec<String>, Vec<f64>) {
    last(&workshop.good(&[RUN.as_slice(), rest].concat()))
}

/// `m ẍ = −k x − m ẅ + F` with `w = a sin ωt`, `F = b cos 3t`: forced vibrations, superposed.
#[test]
fn formulas_drive_inputs_and_signals() {
    let workshop = workshop();
    let rest = ["--input", "push=b*cos(w*t)", "--signal", "wall=a*sin(w*t)"];
    let text = SHAKEN.replace("coord x", "param b: N = 0.5; param w: 1/s = 3; coord x");
    workshop
        .write("shaken.mbs", text.replace("prescribed wall: m;", "").replace("coord x", "prescribed wall: m; coord x"));
    let (_, row) = run(&workshop, &rest);
    let (omega, w, t): (f64, f64, f64) = (2.0, 3.0, 2.0);
    // x_p = A cos wt + B sin wt
    let (a, b) = (0.25 / (4.0 - 9.0), 0.1 * 9.0 / (4.0 - 9.0));
    let (c, d) = (0.3 - a, -b * w / omega);
    let expected = a * (w * t).cos() + b * (w * t).sin() + c * (omega * t).cos() + d * (omega * t).sin();
    assert!((row[1] - expected).abs() < 1e-8, "{} instead of {expected}", row[1]);
    // The same in terms of outputs and of numbers: feedback of the place.
    let (_, once) = run(&workshop, &["--signal", "wall=a*sin(w*t)", "--input", "push=b*cos(w*t) - k*place/4"]);
    let (_, again) =
        run(&workshop, &["--signal", "wall=a*sin(w*t)", "--input", "push=b*cos(w*t) - k*(x + a*sin(w*t))/4"]);
    assert_eq!(once, again);
}

/// `ẍ = sin 3t` from rest, in plain numbers: `x = t/3 − sin(3t)/9`.
#[test]
fn formulas_of_time_alone_are_in_si_units() {
    let workshop = workshop();
    workshop.write("shaken.mbs", SHAKEN.replace("k: N/m = 8", "k: N/m = 0"));
    let rest = ["--input", "push=2*sin(3*t)", "--signal", "wall=0.5*t^2 + 1"];
    let csv = workshop
        .good(&[&["simulate", "shaken.mbs", "--state", r#"{"q": [0]}"#, "--t-end", "2"], rest.as_slice()].concat());
    let (_, row) = last(&csv);
    let expected = 2.0 / 3.0 - 6f64.sin() / 9.0 - 0.5 * 4.0;
    assert!((row[1] - expected).abs() < 1e-8, "{} instead of {expected}", row[1]);
}

/// A parabola through a spline is itself, so that the cart is under a steady acceleration of its wall.
#[test]
fn tables_drive_inputs_and_signals() {
    let workshop = workshop();
    let rows = |f: fn(f64) -> f64| -> String {
        (0..=20).map(|i| f64::from(i) / 10.0).map(|t| format!("{t},{}\n", f(t))).collect()
    };
    workshop.write("wall.csv", rows(|t| 0.5 * t * t));
    workshop.write("push.csv", format!("t,other,push\n{}", "0,9,2\n2,9,2\n"));
    let (_, row) = run(&workshop, &["--signal", "wall=@wall.csv", "--input", "push=@push.csv"]);
    // 2 ẍ = −8 x − 2·1 + 2
    assert!((row[1] - 0.3 * 4f64.cos()).abs() < 1e-8, "{}", row[1]);
    let bad = |rest: &[&str]| workshop.bad(&[RUN.as_slice(), rest].concat());
    let longer = ["--signal", "wall=@wall.csv", "--t-end", "3"];
    let mut arguments = RUN.to_vec();
    arguments.truncate(4);
    arguments.extend(longer);
    let report = workshop.bad(&arguments);
    assert_eq!(report, "error: wall.csv: it goes from t = 0.0 to 2.0, the motion from 0.0 to 3.0\n");
    workshop.write("wall.csv", "0,1\n0,2\n");
    assert!(bad(&["--signal", "wall=@wall.csv"]).contains("line 2: times must increase, 0.0 comes after 0.0"));
    workshop.write("wall.csv", "0,1\n1,x\n");
    assert!(bad(&["--signal", "wall=@wall.csv"]).contains("line 2, column 2: `x` is not a finite number"));
    assert!(bad(&["--signal", "wall=@missing.csv"]).starts_with("error: cannot read missing.csv: "));
    workshop.write("wall.csv", "0,1\n2,1\n");
    let report = bad(&["--signal", "wall=@wall.csv", "--csv", "wall.csv"]);
    assert!(report.contains("the table wall.csv was read"), "{report}");
}

/// The units of a header count, and its names: kilonewtons and milliseconds.
#[test]
fn tables_are_in_the_units_of_their_headers() {
    const DRIVEN: [&str; 4] = ["--input", "push=@push.csv", "--signal", "wall=0.5"];
    let workshop = workshop();
    workshop.write("push.csv", "t [s],other [m],push [N]\n0,9,2\n2,9,2.5\n");
    let (_, expected) = run(&workshop, &DRIVEN);
    workshop.write("push.csv", "t [ms], push [kN]\n0,0.002\n2000,0.0025\n");
    let (_, row) = run(&workshop, &DRIVEN);
    assert!(row.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{row:?} {expected:?}");
    let bad = |table: &str| {
        workshop.write("push.csv", table);
        workshop.bad(&[RUN.as_slice(), DRIVEN.as_slice()].concat())
    };
    let report = bad("t,force\n0,1\n2,1\n");
    assert_eq!(report, "error: push.csv: there is no column `push`; the columns are t, force\n");
    let report = bad("t,push [mm]\n0,1\n2,1\n");
    assert!(report.starts_with("error: push.csv: column `push`: its unit `mm` does not fit, "), "{report}");
    let report = bad("t [kg],push\n0,1\n2,1\n");
    assert!(report.starts_with("error: push.csv: column `t`: its unit `kg` does not fit, "), "{report}");
}

/// `tau` is no array of which `tau_hip` would be a component.
#[test]
fn formulas_are_in_the_unit_of_their_own_input() {
    let workshop = Workshop::new();
    let text = "mechanism Leg { coord x: m; coord hip: rad; input tau: N; input tau_hip: N*m; input toe[2]: N; \
                kinetic += 1/2*1 kg*dt(x)^2 + 1/2*1 kg*m^2*dt(hip)^2; force x += tau + toe[1]; force hip += tau_hip; }";
    workshop.write("leg.mbs", text);
    let run = ["simulate", "leg.mbs", "--state", r#"{"q": [0, 0]}"#, "--t-end", "1"];
    let (_, row) = last(&workshop.good(&[&run[..], &["--input", "tau_hip=2*t^0", "--input", "toe_1=3*t^0"]].concat()));
    assert!((row[1] - 1.5).abs() < 1e-9 && (row[2] - 1.0).abs() < 1e-9, "{row:?}");
}

/// Springs from an uneven road, and an input on each mass.
const ROUGH: &str = "mechanism Rough { param m: kg = 1; param k: N/m = 4; const n = 2; coord x[n]: m; prescribed road[n]: m;
    input f[n]: N; for i in 0..n { kinetic += 1/2*m*dt(x[i])^2; potential += 1/2*k*(x[i] - road[i])^2; force x[i] += f[i]; } }";

/// `x = road + f/k` is where a mass stays.
#[test]
fn elements_of_arrays_are_given_one_by_one_or_together() {
    let workshop = Workshop::new();
    workshop.write("rough.mbs", ROUGH);
    workshop.write("both.csv", "t,road[0] [mm],road_1,f[0] [kN],f_1\n0,20,0.5,0.002,0\n3,20,0.5,0.002,0\n");
    let simulate = ["simulate", "rough.mbs", "--state", r#"{"q": [0.52, 0.5]}"#, "--t-end", "2"];
    for given in [
        ["--signal", "road_0=0.02", "--signal", "road[1]=0.5", "--input", "f_0=2", "--input", "f[1]=0*t"],
        ["--signal", "road=[0.02, 0.5 + 0*max(t, 1)]", "--input", "f=[2, 0]", "--dt", "1", "--rtol", "1e-10"],
        ["--signal", "road=@both.csv", "--input", "f=@both.csv", "--dt", "1", "--rtol", "1e-10"],
        ["--signal", "road[0]=@both.csv", "--signal", "road_1=@both.csv", "--input", "f=[2 N, 0 N]", "--dt", "1"],
    ] {
        let (_, row) = last(&workshop.good(&[&simulate[..], &given].concat()));
        assert!((row[1] - 0.52).abs() < 1e-9 && (row[2] - 0.5).abs() < 1e-9, "{given:?}: {row:?}");
    }
    let bad = |given: &[&str], words: &str| {
        let report = workshop.mbs(&[&simulate[..], given].concat());
        assert!(report.code == 1 && report.stderr.contains(words), "{words}: {}", report.stderr);
    };
    let each = "`road` is an array, whose elements have a formula each: write `road_0=…`, `road_1=…`, or `road=[…, …]`";
    bad(&["--signal", "road=0.1*t"], each);
    bad(&["--input", "f=1"], "`f` is an array, whose elements have a formula each");
    bad(&["--signal", "road[0]=1"], "formulas give all elements of an array: write `road_1=…`, too");
    bad(
        &["--signal", "road_0=1", "--signal", "road_1=@both.csv"],
        "formulas give all elements of an array, or tables do",
    );
    bad(&["--signal", "road=[1, 2, 3]"], "`road` has 2 elements, this has 3");
    bad(&["--input", "f=[1, 2]", "--input", "f[1]=2"], "--input f_1 is given twice");
    bad(&["--input", "f=@both.csv", "--input", "f[1]=2"], "--input f_1 is given twice");
    bad(&["--signal", "road_2=1"], "there is no prescribed signal `road_2`");
    // Without a header all elements would have the second column.
    workshop.write("bare.csv", "0,20,0.5\n3,20,0.5\n");
    let header = "bare.csv: a table for a whole array needs a header, with a column for `f_0`: `t, f_0, …`";
    bad(&["--input", "f=@bare.csv", "--signal", "road=[0, 0]"], header);
    bad(&["--signal", "road=@bare.csv"], "needs a header, with a column for `road_0`");
    workshop.good(&[&simulate[..], &["--input", "f[1]=@bare.csv", "--signal", "road=[0, 0]"]].concat());
}

#[test]
fn columns_are_told_apart() {
    let workshop = Workshop::new();
    workshop.write("rough.mbs", ROUGH);
    let refused = |table: &str, words: &str| {
        workshop.write("f.csv", table);
        let run = ["simulate", "rough.mbs", "--state", "{\"q\": [0, 0]}", "--t-end", "1", "--input", "f_0=@f.csv"];
        let report = workshop.mbs(&[&run[..], &["--signal", "road=[0, 0]"]].concat());
        assert!(report.code == 1 && report.stderr.contains(words), "{words}: {}", report.stderr);
    };
    refused("t,f_0,f[0]\n0,1,5\n1,1,5\n", "f.csv: 2 columns are called `f_0`; leave one of them");
    refused(
        "f_0,t\n0,1\n1,2\n",
        "f.csv: the first column is `f_0`: put it behind that of the time, which is the first",
    );
    refused("t;f_0\n0;1\n1;2\n", "f.csv: columns are separated by commas, here by ';'; write commas");
    refused("t\tf_0\n0\t1\n1\t2\n", "f.csv: columns are separated by commas, here by '\\t'; write commas");
}

/// A bump: the spline through it falls far below the road.
#[test]
fn splines_that_overshoot_are_reported() {
    let workshop = workshop();
    workshop.write("wall.csv", "0,0\n0.5,0\n0.6,50\n0.7,50\n0.8,0\n0.9,0\n3,0\n");
    let outcome = workshop.mbs(&[RUN.as_slice(), &["--signal", "wall=@wall.csv"]].concat());
    let warning =
        "warning: --signal wall: the values of the table are from 0 to 50, the cubic spline through them goes from -";
    assert!(outcome.code == 0 && outcome.stderr.starts_with(warning), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("declare the signal by `table_monotone(t, times, values)`"), "{}", outcome.stderr);
    // So does every spline, a little.
    workshop.write("wall.csv", "0,0\n1,0\n1.5,25\n2,50\n2.5,50\n3,50\n");
    workshop.good(&[RUN.as_slice(), &["--signal", "wall=@wall.csv"]].concat());
}

/// A key that is the rate of a coordinate and an input is neither.
#[test]
fn names_of_two_numbers_are_refused() {
    let workshop = Workshop::new();
    let text = "mechanism Twin { coord theta: rad; input theta_dot: rad/s; kinetic += 1/2*1 kg*m^2*dt(theta)^2; \
                force theta += 1 N*m*s/rad*theta_dot; output energy = theta; output theta_dot_2 = dt(theta); }";
    workshop.write("twin.mbs", text);
    let run = |state| ["simulate", "twin.mbs", "--state", state, "--t-end", "0", "--record", "outputs,inputs"];
    let report = workshop.bad(&run(r#"{"theta": 0, "theta_dot": 1}"#));
    let words =
        r#""theta_dot" is the name of more than one number: write {"qd": {"theta": …}} or {"u": {"theta_dot": …}}"#;
    assert!(report.contains(words), "{report}");
    // In a table the standard columns keep their names.
    let (header, row) = last(&workshop.good(&run(r#"{"theta": 3, "qd": {"theta": 1}, "u": {"theta_dot": 2}}"#)));
    assert_eq!(header, ["t", "theta", "theta_dot", "energy", "outputs_energy", "theta_dot_2", "inputs_theta_dot"]);
    assert_eq!(row, [0.0, 3.0, 1.0, 0.5, 3.0, 1.0, 2.0]);
}

#[test]
fn wrong_formulas_are_refused() {
    let workshop = workshop();
    let bad = |rest: &[&str], words: &[&str]| {
        let report = workshop.bad(&[RUN.as_slice(), rest].concat());
        words.iter().for_each(|word| assert!(report.contains(word), "{word}: {report}"));
    };
    let still = ["--signal", "wall=a*sin(t/(1*t))"];
    bad(&["--input", "push=k*t"], &["--input push: it is in N, the formula is in "]);
    bad(&["--input", "push=2*", still[0], still[1]], &["error[MBS0201]: "]);
    bad(&["--input", "push=k*x; force x += push"], &["a formula is one expression"]);
    bad(&["--input", "push=k*y"], &["`y`"]);
    bad(&["--input", "push=push/2"], &["a formula does not depend on inputs"]);
    bad(&["--input", "push[0]=1"], &["--input: there is no input `push[0]`; the inputs are push"]);
    bad(&["--input", "push=1 N // x"], &["--input push: a formula has no comment; leave out what stands behind `//`"]);
    bad(&["--input", "pull=k*x"], &["--input: there is no input `pull`; the inputs are push"]);
    bad(&["--signal", "wal=a"], &["--signal: there is no prescribed signal `wal`; did you mean \"wall\"?"]);
    bad(&["--signal", "wall=x"], &["wall"]);
    let Outcome { code, .. } = workshop.mbs(&[RUN.as_slice(), &["--input", "push"]].concat());
    assert_eq!(code, 2);
}

#[test]
fn what_is_asked_for_is_recorded_with_units() {
    let workshop = workshop();
    let all = ["--record", "outputs,inputs,accelerations,conserved", "--signal", "wall=a", "--input", "push=k*x/4"];
    let (header, row) = run(&workshop, &all);
    let expected =
        ["t", "x", "x_dot", "energy", "place", "spot_0", "spot_1", "spot_2", "push", "x_ddot", "energy_integral"];
    assert_eq!(header, expected);
    let at = |name: &str| row[header.iter().position(|own| own == name).unwrap()];
    assert!((at("place") - at("x") - 0.1).abs() < 1e-12 && (at("spot_2") - 0.1).abs() < 1e-15);
    assert!((at("push") - 2.0 * at("x")).abs() < 1e-12);
    assert!((at("x_ddot") + 3.0 * at("x")).abs() < 1e-12, "{} {}", at("x_ddot"), at("x"));
    let (header, with_units) = run(&workshop, &[all.as_slice(), &["--units"]].concat());
    let expected = [
        "t_s",
        "x_m",
        "x_dot_m_s",
        "energy_J",
        "place_m",
        "spot_0_m",
        "spot_1_m",
        "spot_2_m",
        "push_N",
        "x_ddot_m_s2",
        "energy_integral_J",
    ];
    assert_eq!((header.as_slice(), with_units), (expected.map(String::from).as_slice(), row));
    let Outcome { stderr, .. } =
        workshop.mbs(&[RUN.as_slice(), &["--signal", "wall=a", "--record", "reactions"]].concat());
    assert_eq!(stderr, "warning: Shaken has no reactions to record\n");
    let figure = [all.as_slice(), &["--plot", "motion.svg", "--csv", "motion.csv"]].concat();
    workshop.good(&[RUN.as_slice(), &figure].concat());
    let svg = workshop.read("motion.svg");
    for label in ["coordinates [m]", "outputs [m]", "inputs [N]", "accelerations [m/s^2]", "conserved [J]"] {
        assert!(svg.contains(label), "{label}");
    }
}

/// Those of rows and multipliers follow from the rows; an output of several units is one column for each component.
#[test]
fn headers_name_the_units_of_what_follows() {
    let workshop = Workshop::new();
    let text = "mechanism Mixed { param m: kg = 1; param l: m = 2; coord x: m; coord z: m; coord a: rad; coord n: 1; \
                kinetic += particle(m, [x, 0, z]) + 1/2*m*l^2*(dt(a)^2 + dt(n)^2); constraint rod: x^2 + z^2 = l^2; \
                constraint turn: dt(a) = dt(n); output mixed = [x, a, 0]; output hand = translation([x, 0, z]); }";
    workshop.write("mixed.mbs", text);
    let run = ["simulate", "mixed.mbs", "--state", r#"{"q": [2, 0, 0, 0]}"#, "--t-end", "0", "--record", "outputs"];
    let header = |rest: &[&str]| -> Vec<String> {
        let csv = workshop.good(&[&run, rest].concat());
        assert!(csv.lines().all(|line| line.matches(',').count() == csv.lines().next().unwrap().matches(',').count()));
        csv.lines().next().unwrap().split(',').map(String::from).collect()
    };
    let plain = header(&[]);
    assert_eq!(
        plain[9..17],
        ["energy", "lambda_rod", "lambda_turn", "residual_rod", "residual_turn", "mixed_0", "mixed_1", "mixed_2"]
    );
    let found = header(&["--units"]);
    assert_eq!(
        found[..17],
        [
            "t_s",
            "x_m",
            "z_m",
            "a_rad",
            "n",
            "x_dot_m_s",
            "z_dot_m_s",
            "a_dot_rad_s",
            "n_dot_per_s",
            "energy_J",
            "lambda_rod_kg_s2",
            "lambda_turn_kgm2_s2",
            "residual_rod_m2",
            "residual_turn_per_s",
            "mixed_0_m",
            "mixed_1",
            "mixed_2",
        ]
    );
    assert_eq!([&found[17], &found[20]], ["hand_position_0_m", "hand_rotation_0_0"]);
    assert_eq!(found.len(), plain.len());
}

/// A motion that escapes in finite time, and one into a spring of 1e22 N/m.
#[test]
fn where_steps_collapse_is_measured() {
    let workshop = Workshop::new();
    let report = |statement: &str, state: &str| {
        let text = format!(
            "mechanism M {{ param m: kg = 1; param k: N/m = 1e22; param c: N*s^2/m^2 = 1; coord x: m; \
             kinetic += 1/2*m*dt(x)^2; {statement} }}"
        );
        workshop.write("m.mbs", text);
        workshop.stopped(&["simulate", "m.mbs", "--state", state, "--t-end", "5"])
    };
    let escape = report("force x += c*dt(x)^2;", r#"{"q": [0], "qd": [1]}"#);
    assert!(
        escape.contains("; forces are stiff there: the mass matrix, scaled by its diagonal, has a condition of 1.0e0"),
        "{escape}"
    );
    assert!(escape.contains("the fastest rate of the linearized motion is "), "{escape}");
}

#[test]
fn states_by_name() {
    let workshop = Workshop::new();
    let pendulum = workshop.eval("pendulum.mbs", r#"{"q": [0.3], "qd": [0.2], "qdd": [0.1], "u": [2]}"#);
    for state in [
        r#"{"q": {"theta": 0.3}, "qd": {"theta": 0.2}, "qdd": {"theta": 0.1}, "u": {"tau": 2}}"#,
        r#"{"theta": 0.3, "theta_dot": 0.2, "theta_ddot": 0.1, "tau": 2}"#,
        r#"{"theta": 0.3, "theta_dot": "0.2 rad/s", "qdd": [0.1], "tau": "2 N*m"}"#,
    ] {
        assert_eq!(workshop.eval("pendulum.mbs", state), pendulum, "{state}");
    }
    let chain = workshop.eval("chain.mbs", r#"{"q": [1, 3], "qd": [0, 5]}"#);
    assert_eq!(workshop.eval("chain.mbs", r#"{"x": [1, 3], "x_1_dot": 5}"#), chain);
    assert_eq!(workshop.eval("chain.mbs", r#"{"q": {"x_0": 1, "x_1": 3}, "qd": {"x_1": 5}}"#), chain);
    let bad = |state: &str, message: &str| {
        let expected = format!("error: --state: {message}\n");
        assert_eq!(workshop.bad(&["eval", "chain.mbs", "--state", state]), expected, "{state}");
    };
    bad(r#"{"q": {"y": 1}}"#, "unknown name \"q\".\"y\"; the names are x_0, x_1");
    bad(r#"{"q": [1, 2], "x_0": 1}"#, "\"x_0\" is given twice");
    bad(r#"{"x": [1]}"#, "\"x\" must hold 2 numbers (x_0, x_1), found 1");
    bad(r#"{"x_0_dot": 1}"#, "\"q\" is missing: 2 numbers (x_0, x_1), or one of them by its name");
}

/// Nothing is shown that the user has not written.
#[test]
fn mistakes_in_formulas_are_underlined_in_what_was_given() {
    let workshop = workshop();
    let shown = |option: &str, formula: &str, rest: [&str; 2]| {
        workshop.bad(&[RUN.as_slice(), &rest, &[option, formula]].concat())
    };
    let (wall, push) = (["--signal", "wall=0"], ["--input", "push=0"]);
    for (formula, place) in [
        ("push=2*foo(t)", "1:3\n  |\n1 | 2*foo(t)\n  |   ^^^\n"),
        ("push= 2*t + b", "1:7\n  |\n1 | 2*t + b\n  |       ^\n"),
        ("push=place + k", "1:9\n  |\n1 | place + k\n  |         ^\n"),
        ("push=2*sin(t", "1:6\n  |\n1 | 2*sin(t\n  |      ^\n"),
    ] {
        let report = shown("--input", formula, wall);
        assert!(report.contains(&format!(" --> --input push:{place}")), "{report}");
        assert!(!report.contains("formula_of") && !report.contains("unit_of"), "{report}");
    }
    let report = shown("--signal", "wall=k*t", push);
    assert!(report.contains(" --> --signal wall:1:1\n  |\n1 | k*t\n  | ^^^\n"), "{report}");
    // A mistake of the mechanism's own.
    workshop.write("shaken.mbs", SHAKEN.replace("force x += push", "force x += pusch"));
    let report = shown("--input", "push=2", wall);
    assert!(report.contains("--> shaken.mbs:10:16\n"), "{report}");
    assert!(report.contains("|     force x += pusch;\n"), "{report}");
}

/// `E = T + V` at the bottom: `θ̇² = 2 g (1 − cos θ₀)/l`, as in a plan with the same `until`.
#[test]
fn a_motion_ends_where_a_formula_passes_zero() {
    let workshop = Workshop::new();
    let state = r#"{"theta": 1, "params": {"b": 0}}"#;
    let run = ["simulate", "pendulum.mbs", "--state", state, "--t-end", "5", "--dt", "0.2", "--until"];
    let rows = |until: &str, more: &[&str]| -> Vec<Vec<f64>> {
        let csv = workshop.good(&[run.as_slice(), &[until], more].concat());
        csv.lines().skip(1).map(|row| row.split(',').map(|number| number.parse().unwrap()).collect()).collect()
    };
    let falling = rows("theta falling", &[]);
    let [t, theta, rate] = falling.last().unwrap()[..3] else { panic!("{falling:?}") };
    assert!(theta.abs() < 1e-12 && (rate + (10.0 * (1.0 - 1_f64.cos())).sqrt()).abs() < 1e-8, "{falling:?}");
    assert_eq!(falling.len(), (t / 0.2).ceil() as usize + 1);
    // On the way back, of the same formula; constraints, inputs and words do as well.
    assert!((rows("theta rising", &[]).last().unwrap()[0] - 3.0 * t).abs() < 1e-8);
    assert!((rows("-theta rising", &["--input", "tau=0*m*g*l*theta"]).last().unwrap()[0] - t).abs() < 1e-8);
    assert!((rows("height - 0.2*l falling", &[]).last().unwrap()[1] - 0.8_f64.acos()).abs() < 1e-9);
    workshop.write(
        "plan.toml",
        "mechanism = \"pendulum.mbs\"\n[vary]\ntheta = { values = [1] }\n[fixed]\nb = 0\n[motion]\nduration = \"5 s\"\n\
         until = { zero = \"theta\", direction = \"falling\" }\n[quantities]\nat = { final = \"t\" }\n",
    );
    workshop.good(&["sweep", "plan.toml", "--interpret"]);
    let table = workshop.read("plan.csv");
    let at: f64 = table.lines().last().unwrap().split(',').nth(2).unwrap().parse().unwrap();
    assert!((at - t).abs() < 1e-10, "{at} {t}");

    let never = workshop.mbs(&[run.as_slice(), &["theta - 2 rising"]].concat());
    let warning = "warning: `theta - 2 rising` has not happened before --t-end\n";
    assert_eq!((never.code, never.stderr.as_str()), (0, warning));
    let report = workshop.bad(&[run.as_slice(), &["tehta falling"]].concat());
    assert!(report.starts_with("error[MBS0310]: `tehta` is not declared\n --> --until:1:1\n"), "{report}");
    let report = workshop.bad(&[run.as_slice(), &["[theta, 0, 0]"]].concat());
    assert_eq!(report, "error: --until \"[theta, 0, 0]\": a formula that passes zero is one number\n");
    // The formula has no value past the bottom.
    let report = workshop.stopped(&[run.as_slice(), &["ln(theta) + 50"]].concat());
    let reason = "error: the integration stopped: `ln(theta) + 50` is infinite or NaN right after t = ";
    assert!(report.starts_with(reason) && !report.contains("mass matrix"), "{report}");
    let report = workshop.misused(&[run.as_slice(), &["falling"]].concat());
    assert!(report.contains("write a formula and, if need be, its direction: `height falling`"), "{report}");
}
