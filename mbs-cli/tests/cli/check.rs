//! `mbs check`.

use crate::Workshop;

#[test]
fn a_good_mechanism_is_summed_up_in_a_line() {
    let workshop = Workshop::new();
    let pendulum = workshop.good(&["check", "pendulum.mbs"]);
    let (summary, proof) = pendulum.split_once("; proved at ").unwrap();
    assert_eq!(summary, "Pendulum: 1 coordinate (theta), 1 input (tau), 4 parameters (m, l, g, b), 0 bodies");
    let (_, exact) = proof.split_once(" states; proved exactly: ").unwrap();
    let (identities, chance) = exact.split_once(" identities, chance of a false proof below 1e-").unwrap();
    assert!(identities.parse::<usize>().unwrap() > 20 && chance.trim_end().parse::<u32>().unwrap() > 30, "{exact}");
    assert_eq!(proof.lines().count(), 1, "{proof}");
    let chain = workshop.good(&["check", "chain.mbs"]);
    assert!(chain.starts_with("Chain: 2 coordinates (x[2]), 0 inputs, 3 parameters (m[2], k), 0 bodies; "), "{chain}");
}

#[test]
fn what_is_not_proved_exactly_is_named() {
    let workshop = Workshop::new();
    let text = "#![dimensionless] mechanism Odd { coord x: 1; kinetic += dt(x)^2; force x += ln(exp(x)); \
                output angle = [sin(0.12345678901234*x), 0, 0]; }";
    workshop.write("odd.mbs", text);
    let summary = workshop.good(&["check", "odd.mbs"]);
    assert!(summary.contains(" identities, chance of a false proof below 1e-"), "{summary}");
    assert!(summary.contains(" in doubles (") && summary.contains("of a high degree"), "{summary}");
    let details = workshop.good(&["check", "odd.mbs", "--verbose"]);
    assert!(
        details.starts_with(&summary) && details.contains("  3 points, one in each field of 2305843009208591759, ")
    );
    assert!(details.lines().any(|line| line.starts_with("  in doubles: output, ")), "{details}");
    let report: serde_json::Value = serde_json::from_str(&workshop.good(&["check", "odd.mbs", "--json"])).unwrap();
    let proof = &report["proof"];
    assert_eq!((proof["points"].as_u64(), proof["moduli"].as_array().map(Vec::len)), (Some(3), Some(3)), "{proof}");
    assert!(proof["exact"].as_u64().unwrap() > 20 && proof["degree"].as_u64().unwrap() > 1, "{proof}");
    assert!(proof["in_doubles"].as_array().is_some_and(|claims| claims.iter().any(|c| c["claim"] == "output")));
}

#[test]
fn a_mistake_is_underlined_at_its_place() {
    let workshop = Workshop::new();
    workshop.write("bad.mbs", crate::PENDULUM.replace("m * g * l * (1", "m * grav * l * (1"));
    let report = workshop.bad(&["check", "bad.mbs"]);
    assert!(report.starts_with("error[MBS0501]: ") && report.contains("--> bad.mbs:10:22\n"), "{report}");
    assert!(
        report.contains("potential += m * grav * l * (1 - cos(theta));\n") && report.contains("^^^^\n"),
        "{report}"
    );
}

/// No command works with a mechanism that is refused.
#[test]
fn every_command_refuses_what_check_refuses() {
    let workshop = Workshop::new();
    workshop.write("bad.mbs", crate::PENDULUM.replace("kinetic", "potential"));
    let state = ["--state", "{\"q\": [0]}"];
    let report = workshop.bad(&["check", "bad.mbs"]);
    assert!(report.contains("bad.mbs:"), "{report}");
    assert_eq!(workshop.bad(&["derive", "bad.mbs", "--out", "bad.rs"]), report);
    assert_eq!(workshop.bad(&["ops", "bad.mbs"]), report);
    assert_eq!(workshop.bad(&["eval", "bad.mbs", state[0], state[1]]), report);
    let simulate = ["simulate", "bad.mbs", state[0], state[1], "--t-end", "1", "--csv", "bad.csv"];
    assert_eq!(workshop.bad(&simulate), report);
}

/// Degrees of freedom at no state are none that could be counted.
#[test]
fn an_array_without_states_is_refused() {
    let workshop = Workshop::new();
    workshop.write("rod.mbs", crate::constrained::ROD);
    workshop.write("pendulum.mbs", crate::PENDULUM);
    for file in ["rod.mbs", "pendulum.mbs"] {
        let report = workshop.bad(&["check", file, "--state", "[]"]);
        assert_eq!(report, "error: the array of --state has no state: give one, or leave it out\n");
    }
}

/// Warnings are shown, and are no failure.
#[test]
fn warnings_are_no_errors() {
    let workshop = Workshop::new();
    workshop.write("odd.mbs", crate::PENDULUM.replace("kinetic", "output size = abs(theta);\n    kinetic"));
    let outcome = workshop.mbs(&["check", "odd.mbs"]);
    assert_eq!(outcome.code, 0);
    assert!(outcome.stdout.starts_with("Pendulum: 1 coordinate (theta), "), "{}", outcome.stdout);
    assert!(outcome.stderr.starts_with("warning[MBS0820]: this has a kink where `theta` = 0"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("--> odd.mbs:") && outcome.stderr.contains("abs(theta);\n"), "{}", outcome.stderr);
}

/// Polar coordinates have states without inertia; a unit quaternion has none, for it is nowhere zero.
#[test]
fn motions_without_inertia_are_those_that_can_be() {
    let workshop = Workshop::new();
    let polar = "mechanism Polar { param m: kg = 1; coord r: m; coord a: rad; \
                 kinetic += particle(m, [r*cos(a), r*sin(a), 0]); }";
    let body = "mechanism Body { param i: kg*m^2 = 2; coord e[4]: 1; \
                kinetic += rigid_body(1 kg, [0, 0, 0], i*diag(1, 1.2, 0.9), quaternion(e[0], e[1], e[2], e[3])); \
                constraint unit: e[0]^2 + e[1]^2 + e[2]^2 + e[3]^2 = 1; }";
    for (text, is_singular) in [(polar, true), (body, false)] {
        workshop.write("m.mbs", text);
        let report = workshop.good(&["check", "m.mbs"]);
        assert_eq!(report.contains(" of which some motion has no inertia"), is_singular, "{report}");
    }
}

/// `|z − a| + z − a` holds of its own accord on one side of a, and says z = a on the other.
#[test]
fn the_root_of_a_square_in_a_constraint_is_an_absolute_value() {
    let workshop = Workshop::new();
    for row in ["sqrt((z - a)^2) + (z - a)", "((z - a)^4)^(1/4) + z - a", "[0, z - a, 0].norm() + z - a"] {
        let text = format!(
            "mechanism Half {{ param m: kg = 1; param a: m = 0.3; coord x: m; coord z: m; \
             kinetic += 1/2*m*(dt(x)^2 + dt(z)^2); constraint row: {row} = 0; }}"
        );
        workshop.write("half.mbs", text);
        let summary = workshop.good(&["check", "half.mbs"]);
        assert!(summary.contains("1 constraint row") && summary.contains("proved exactly"), "{row}: {summary}");
    }
}
