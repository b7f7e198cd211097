//! Parameters that a mechanism cannot have, and numbers with units.

use serde_json::{Value, json};

use crate::{Outcome, Workshop};

const CRANE: &str = "\
mechanism Crane {
    param m1: kg = 3;
    param m2: kg = 1;
    param l: m = 2, positive;
    param tilt: deg = 0;
    param moments[3]: kg*m^2 = [1, 1, 1];
    coord x: m;
    coord a: rad;
    input push: N;
    prescribed heave: m;
    const g: m/s^2 = 9.81;
    kinetic += 1/2*(m1 - m2)*dt(x)^2;
    kinetic += rigid_body(m2, [0, 0, 0], diag(moments[0], moments[1], moments[2]), translation([x, 0, 0])*rot_y(a));
    potential += m2*g*(l*cos(a + tilt) + heave);
    force x += push;
}
";

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("crane.mbs", CRANE);
    workshop
}

fn refused(workshop: &Workshop, model: &str, state: &str, message: &str) {
    let expected = format!("error: --state: {message}\n");
    assert_eq!(workshop.bad(&["eval", model, "--state", state]), expected);
    assert_eq!(workshop.bad(&["simulate", model, "--state", state, "--t-end", "1"]), expected);
}

#[test]
fn impossible_parameters_are_refused_by_name_and_value() {
    let workshop = workshop();
    let check = |params: &str, message: &str| {
        refused(&workshop, "crane.mbs", &format!("{{\"q\": [0, 0], \"params\": {params}}}"), message);
    };
    check(r#"{"m1": 0.5}"#, "\"params\": `m1 - m2` must not be negative, it is -0.5");
    check(r#"{"m2": -1}"#, "\"params\": `m2` must not be negative, it is -1.0");
    check(r#"{"l": 0}"#, "\"params\": `l` must be positive, it is 0.0");
    check(r#"{"l": -2}"#, "\"params\": `l` must be positive, it is -2.0");
    check(r#"{"l": NaN}"#, "\"params\".\"l\" must be a finite number, found NaN");
    check(
        r#"{"moments": [1, 1, 4]}"#,
        "\"params\": `diag(moments_0, moments_1, moments_2)` must have no principal moment greater than the sum of the other \
         two, it is 2.0",
    );
    refused(
        &workshop,
        "pendulum.mbs",
        r#"{"q": [0], "params": {"m": -1}}"#,
        "\"params\": `m` must not be negative, it is -1.0",
    );
}

#[test]
fn numbers_with_units_are_converted() {
    let workshop = workshop();
    let state = |q: &str, u: &str, tilt: &str, heave: &str| {
        format!(
            r#"{{"t": {heave}, "q": [1, {q}], "qd": [0, {q}], "qdd": [0, 0], "u": [{u}], "params": {{"tilt": {tilt}}},
                "prescribed": {{"heave": ["5 mm", "1 mm/s", "1 mm/s^2"]}}}}"#
        )
    };
    let eval = |state: &str| -> Value {
        let Outcome { code, stdout, stderr } = workshop.mbs(&["eval", "crane.mbs", "--state", state]);
        assert_eq!(code, 0, "{stderr}");
        serde_json::from_str(&stdout).unwrap()
    };
    let turn = 20f64.to_radians();
    let with_units = state("\"20 deg\"", "\"2 kN\"", "\"20 deg\"", "\"3 ms\"")
        .replace("\"qd\": [0, \"20 deg\"]", "\"qd\": [0, \"20 deg/s\"]");
    let plain = state(&turn.to_string(), "2000", &turn.to_string(), "0.003");
    assert_eq!(eval(&with_units), eval(&plain));
    assert_eq!(eval(&with_units)["generalized_force"], json!([2000.0, 0.0]));
    let wrong = |value: &str, message: &str| {
        let state = format!(r#"{{"q": [0, 0], "params": {{"tilt": {value}}}}}"#);
        refused(&workshop, "crane.mbs", &state, &format!("\"params\".\"tilt\" is {value}: {message}"));
    };
    wrong("\"20 m\"", "its unit `m` does not fit, an angle or a plain number is wanted");
    wrong("\"20\"", "write a number and its unit, as in \"20 deg\"");
    refused(
        &workshop,
        "crane.mbs",
        r#"{"q": ["1 kg", 0], "prescribed": {"heave": [0, 0, "1 m/s"]}}"#,
        "\"q\"[0] (x) is \"1 kg\": its unit `kg` does not fit, m is wanted\nerror: --state: \
         \"prescribed\".\"heave\"[2] (acceleration) is \"1 m/s\": its unit `m/s` does not fit, m/s² is wanted",
    );
}

/// 20 is 20 rad, as the contract has it; where degrees were declared that is said.
#[test]
fn plain_numbers_for_other_units_earn_a_warning() {
    let workshop = workshop();
    let run = |tilt: &str| {
        let state = format!(r#"{{"q": [0, 0], "params": {{"tilt": {tilt}}}, "prescribed": {{"heave": [0, 0, 0]}}}}"#);
        let Outcome { code, stdout, stderr } = workshop.mbs(&["eval", "crane.mbs", "--state", &state]);
        assert_eq!(code, 0);
        let found: Value = serde_json::from_str(&stdout).unwrap();
        (found["potential_energy"].as_f64().unwrap(), stderr)
    };
    let (energy, warning) = run("20");
    assert!((energy - 9.81 * 2.0 * 20f64.cos()).abs() < 1e-12);
    let expected = "warning: --state: \"params\".\"tilt\" is declared in deg; a plain number is in rad, write it with its unit, \
                    \"20 deg\"\n";
    assert_eq!(warning, expected);
    let (energy, warning) = run("\"20 deg\"");
    assert!((energy - 9.81 * 2.0 * 20f64.to_radians().cos()).abs() < 1e-12);
    assert_eq!(warning, "");
    assert_eq!(run("0").1, "");
}

#[test]
fn matrices_are_arrays_of_rows() {
    let workshop = workshop();
    workshop.write(
        "flywheel.mbs",
        "mechanism Flywheel { param a[2][3]: kg*m^2 = [[1, 2, 3], [4, 5, 6]]; coord q: rad; kinetic += 1/2*a[1][0]*dt(q)^2; \
         output all = [a[0][0], a[0][1], a[0][2], a[1][0], a[1][1], a[1][2]]; }",
    );
    let all = |params: &str| {
        let state = format!(r#"{{"q": [0], "params": {params}}}"#);
        workshop.eval("flywheel.mbs", &state)["outputs"]["all"].clone()
    };
    assert_eq!(all("{}"), json!([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    assert_eq!(all(r#"{"a": [[6, 5, 4], [3, 2, "6 g*m^2"]]}"#), json!([6.0, 5.0, 4.0, 3.0, 2.0, 0.006]));
    assert_eq!(all(r#"{"a_0_2": 7, "a_1_0": 8}"#), json!([1.0, 2.0, 7.0, 8.0, 5.0, 6.0]));
    let check = |params: &str, message: &str| {
        refused(&workshop, "flywheel.mbs", &format!("{{\"q\": [0], \"params\": {params}}}"), message);
    };
    check(r#"{"a": [1, 2, 3, 4, 5, 6]}"#, "\"params\".\"a\" must hold 2 arrays, one for each row, found 6");
    check(r#"{"a": 1}"#, "\"params\".\"a\" must hold 2 arrays, one for each row, found the number 1");
    check(r#"{"a": [[1, 2, 3], [4, 5]]}"#, "\"params\".\"a\"[1] must hold 3 numbers (a_1_0, a_1_1, a_1_2), found 2");
    check(r#"{"a": [[1, 2, 3], [4, null, 6]]}"#, "\"params\".\"a\"[1][1] (a_1_1) must be a finite number, found null");
    check(
        r#"{"a": [[1, 2, 3], [4, 5, 6]], "a_1_0": 8}"#,
        "\"params\".\"a_1_0\" is given twice, by itself and in \"params\".\"a\"",
    );
    assert!(workshop.good(&["check", "flywheel.mbs"]).contains("6 parameters (a[2][3])"), "both lengths are shown");
}
