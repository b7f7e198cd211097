//! `mbs sweep` of constrained mechanisms: the table says a member's start as it was.

use crate::constrained::ROD;
use crate::{Outcome, Workshop};

/// Of the rod of 2 m, whose bob is at (x, z); `start` is the moment in which the motion begins.
fn sweep(tables: &str) -> (Outcome, Vec<Vec<String>>) {
    sweep_of(ROD, tables)
}

/// As of the rod, of another mechanism with the coordinates x and z.
fn sweep_of(mechanism: &str, tables: &str) -> (Outcome, Vec<Vec<String>>) {
    let workshop = Workshop::new();
    workshop.write("rod.mbs", mechanism);
    let rest = "[quantities]\nat = \"x\"\nheight = \"z\"\nspeed = \"dt(x)\"\n";
    let motion = if tables.contains("[motion]") { tables.to_string() } else { format!("{tables}\n[motion]") };
    workshop.write("plan.toml", format!("mechanism = \"rod.mbs\"\n{motion}\nduration = \"1e-12 s\"\n{rest}"));
    let outcome = workshop.mbs(&["sweep", "plan.toml", "--interpret", "--out", "table.csv"]);
    let table = if outcome.code == 0 { workshop.read("table.csv") } else { String::new() };
    let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    (outcome, rows.map(|row| row.splitn(6, ',').map(str::to_string).collect()).collect())
}

#[track_caller]
fn near(cell: &str, expected: f64) {
    let found: f64 = cell.parse().unwrap();
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

#[test]
fn what_varies_is_held_and_what_is_not_named_follows() {
    let (outcome, rows) = sweep("[vary]\nx = { values = [1.2, 1.6] }\nx_dot = { values = [0.5] }\n[fixed]\nz = -1.5");
    assert_eq!(outcome.code, 0, "{}", outcome.stderr);
    for (row, [x, z]) in rows.iter().zip([[1.2, -1.6], [1.6, -1.2]]) {
        near(&row[1], x);
        near(&row[3], x);
        near(&row[4], z);
        near(row[5].trim_end_matches(','), 0.5);
    }
    // What is fixed was a guess, and one that could not be had.
    let warning = "warning: the constraints do not let 2 members start as `[fixed]` says; the first is 0: `z` starts at -1.6 \
                   instead of -1.5; `hold = […]` in `[motion]` names what is meant, the rest is then a guess\n";
    assert_eq!(outcome.stderr, warning);
    // Said to be a guess, it is one.
    let (outcome, rows) = sweep("[vary]\nx = { values = [1.2] }\n[fixed]\nz = -1.5\n[motion]\nhold = [\"x\"]");
    assert_eq!(outcome.stderr, "");
    near(&rows[0][3], -1.6);
}

/// A bob at (x, y, z) on a rod of 2 m: two degrees of freedom.
const BALL: &str = "mechanism Ball {
  param m: kg = 1; param l: m = 2; param g: m/s^2 = 9.81;
  coord x: m; coord y: m; coord z: m;
  kinetic += 1/2*m*(dt(x)^2 + dt(y)^2 + dt(z)^2);
  potential += m*g*z;
  constraint rod: x^2 + y^2 + z^2 = l^2;
}
";

#[test]
fn what_varies_is_held_beside_what_the_plan_holds() {
    let tables = "[vary]\nx = { values = [1.2, 1.6] }\n[fixed]\ny = 0.5\nz = -1.5\n[motion]\nhold = [\"y\"]";
    let (outcome, rows) = sweep_of(BALL, tables);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    for (row, x) in rows.iter().zip([1.2_f64, 1.6]) {
        near(&row[2], x);
        near(&row[3], -(4.0 - 0.25 - x * x).sqrt());
    }
    assert_eq!(rows.len(), 2);
}

#[test]
fn members_that_cannot_start_as_their_row_says_stop() {
    let stops = |tables: &str, expected: &str| {
        let (outcome, rows) = sweep(tables);
        assert_eq!(outcome.code, 0, "{}", outcome.stderr);
        let reason = rows.last().unwrap().last().unwrap();
        assert!(reason.contains(expected), "{reason}");
        assert!(outcome.stderr.starts_with("warning: 1 member of "), "{}", outcome.stderr);
    };
    let [starts, rest] = ["the constraints do not let it start as the table says: ", "; vary what they leave free"];
    stops(
        "[vary]\nx = { values = [1.2] }\nz = { values = [-1.6, -1.5] }",
        &format!("{starts}`z` would start at -1.6 instead of -1.5{rest}"),
    );
    // Held, the height leaves nothing to choose.
    stops(
        "[vary]\nx = { values = [1.5] }\n[fixed]\nz = -1.6\n[motion]\nhold = [\"z\"]",
        &format!("{starts}`x` would start at 1.1999999999999"),
    );
    stops("[vary]\nx = { values = [3] }\n[motion]\nhold = [\"x\"]", "; `hold` may leave too few coordinates free");
}

#[test]
fn held_names_are_coordinates_that_constraints_move() {
    let (outcome, _) = sweep("[vary]\nx = { values = [1] }\n[motion]\nhold = [\"x\", \"y\"]");
    let place = "error[MBS0310]: there is no coordinate `y`\n --> plan.toml:5:14\n";
    assert!(outcome.stderr.starts_with(place), "{}", outcome.stderr);
    let (outcome, _) = sweep("[vary]\nx = { values = [1] }\n[motion]\nheld = [\"x\"]");
    assert!(outcome.stderr.contains("help: did you mean `hold`?"), "{}", outcome.stderr);
    let (outcome, _) = sweep("[vary]\nx = { values = [1] }\n[motion]\nseconds = 1");
    assert_eq!(outcome.stderr.matches("`duration`").count(), 1, "{}", outcome.stderr);
    let workshop = crate::sweep::workshop();
    workshop.write("plan.toml", crate::sweep::PLAN.replace("[motion]", "[motion]\nhold = [\"x\"]"));
    let report = workshop.bad(&["sweep", "plan.toml"]);
    assert!(report.starts_with("error[MBS0310]: Spring has no constraints, `hold` does nothing\n"), "{report}");
}

/// Newton's method has no way from z = 0, where z changes nothing.
#[test]
fn what_is_not_named_follows_from_other_guesses_than_zero() {
    for motion in ["", "\n[motion]\nhold = [\"x\"]"] {
        let (outcome, rows) = sweep(&format!("[vary]\nx = {{ values = [1.2, 0.1] }}{motion}"));
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
        for (row, x) in rows.iter().zip([1.2_f64, 0.1]) {
            near(&row[2], x);
            near(&row[3], (4.0 - x * x).sqrt());
        }
        assert_eq!(rows.len(), 2);
    }
    // Where there is none from there either, it is said that there may be from others.
    let (_, rows) = sweep("[vary]\nx = { values = [3] }");
    let reason = rows[0].last().unwrap();
    let rest = "the rest follows; or it was not found from the guess, `[fixed]` may give another of `z`";
    assert!(reason.contains(rest), "{reason}");
}

/// Members of a program that let constraints move all of the state are no part of a table where what varies is held.
#[test]
fn members_that_started_by_other_rules_are_of_another_run() {
    let workshop = Workshop::new();
    workshop.write("rod.mbs", ROD);
    let plan = "mechanism = \"rod.mbs\"\n[vary]\nx = { values = [1.2, -1.2] }\n[fixed]\nz = -1.6\n[motion]\n\
                duration = \"1e-12 s\"\n[quantities]\nat = \"x\"\n";
    workshop.write("plan.toml", plan);
    workshop.good(&["sweep", "plan.toml", "--interpret", "--rank", "0", "--ranks", "2"]);
    let identity = workshop.read("plan.csv.parts/ensemble");
    let line = "start of members: on constraints, 2\n";
    assert!(identity.contains(line), "{identity}");
    workshop.write("plan.csv.parts/ensemble", identity.replace(line, ""));
    let report = workshop.bad(&["sweep", "plan.toml", "--interpret"]);
    assert!(report.contains("holds members of another run: the start of members has changed since"), "{report}");
}
