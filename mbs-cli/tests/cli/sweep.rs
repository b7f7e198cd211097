//! `mbs sweep`: what a table holds, that it is the same bytes whatever made it, and what is said of plans that are
//! wrong.

use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use serde_json::Value;

use crate::{Outcome, Workshop, command};

/// `x = a cos(ω t)` with `ω² = k/m`.
pub(crate) const SPRING: &str = "\
mechanism Spring {
    param m: kg = 2;
    param k: N/m = 8;
    coord x: m;
    input push: N;
    kinetic += 1/2 * m * dt(x)^2;
    potential += 1/2 * k * x^2;
    force x += push;
}
";

pub(crate) const PLAN: &str = "\
mechanism = \"spring.mbs\"
members = 20
seed = 3

[fixed]
x = \"20 cm\"

[vary]
m = { normal = [\"2 kg\", \"100 g\"], within = [\"1 kg\", \"3 kg\"] }
k = { values = [\"8 N/m\", \"12 N/m\"] }

[motion]
duration = \"4 s\"

[quantities]
quarter = { time_of = \"x\", direction = \"falling\" }
least = { min = \"x\" }
greatest = { max = \"dt(x)\" }
mean_square = { mean = \"x^2\" }
zeros = { count = \"x\" }
beyond = { happened = \"x - 0.3*m_per_number\" }
never = { time_of = \"x - 0.3*m_per_number\" }
energy = { final = \"energy\" }
last = \"x\"

[parameters]
m_per_number = \"1 m\"
";

pub(crate) fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("spring.mbs", SPRING);
    workshop.write("plan.toml", PLAN);
    workshop
}

/// The rows of a table behind its comments, by the names of the columns; what is missing is NaN.
fn rows(table: &str) -> Vec<Vec<(String, f64)>> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| -> Vec<(String, f64)> {
        let cell = |(name, cell): (&&str, &str)| (name.to_string(), cell.parse().unwrap_or(f64::NAN));
        names.iter().zip(line.split(',')).map(cell).collect()
    };
    lines.map(row).collect()
}

fn number(row: &[(String, f64)], name: &str) -> f64 {
    row.iter().find(|(own, _)| own == name).unwrap_or_else(|| panic!("{name} is not among {row:?}")).1
}

#[test]
fn quantities_are_those_of_the_closed_form() {
    let workshop = workshop();
    let said = workshop.good(&["sweep", "plan.toml"]);
    assert!(said.starts_with("plan.csv: 40 members, 40 by "), "{said}");
    let table = workshop.read("plan.csv");
    assert!(table.starts_with("# program: mbs ") && table.contains("\n# unit of quarter: s\n"), "{table}");
    let rows = rows(&table);
    assert_eq!(rows.len(), 40);
    for (index, row) in rows.iter().enumerate() {
        let value = |name: &str| number(row, name);
        let check = |name: &str, expected: f64, tolerance: f64| {
            let found = value(name);
            assert!(
                (found - expected).abs() <= tolerance * (1.0 + expected.abs()),
                "{index}: {name} {found} {expected}"
            );
        };
        let omega = (value("k") / value("m")).sqrt();
        let half = |t: f64| t / 2.0 + (2.0 * omega * t).sin() / (4.0 * omega);
        check("member", index as f64, 0.0);
        check("quarter", std::f64::consts::FRAC_PI_2 / omega, 1e-9);
        check("least", -0.2, 1e-9);
        check("greatest", 0.2 * omega, 1e-9);
        check("mean_square", 0.04 * half(4.0) / 4.0, 1e-8);
        check("zeros", (4.0 * omega / std::f64::consts::PI + 0.5).floor(), 0.0);
        check("beyond", 0.0, 0.0);
        assert!(value("never").is_nan());
        check("energy", 0.5 * value("k") * 0.04, 1e-9);
        check("last", 0.2 * (4.0 * omega).cos(), 1e-8);
    }
    assert!(workshop.bad(&["sweep", "plan.toml"]).starts_with("error: plan.csv is there already; remove it, "));
}

/// One process on one thread, several threads, three ranks and their merger.
#[test]
fn tables_are_the_same_bytes_whatever_made_them() {
    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml", "--out", "one.csv", "--threads", "1"]);
    workshop.good(&["sweep", "plan.toml", "--out", "four.csv", "--threads", "4"]);
    let rank = |rank: &str| workshop.good(&["sweep", "plan.toml", "--out", "all.csv", "--rank", rank, "--ranks", "3"]);
    let said = rank("2");
    assert!(said.starts_with("14 members done by rank 2 of 3, by "), "{said}");
    assert!(said.ends_with("; `--merge` makes the table of all\n"), "{said}");
    let report = workshop.bad(&["sweep", "plan.toml", "--out", "all.csv", "--merge"]);
    assert_eq!(report, "error: members 0 to 25 are missing\n");
    rank("0");
    rank("1");
    workshop.good(&["sweep", "plan.toml", "--out", "all.csv", "--merge"]);
    let one = workshop.read("one.csv");
    assert!(one == workshop.read("four.csv") && one == workshop.read("all.csv"));
    assert!(!workshop.files().iter().any(|name| name.ends_with(".parts")), "{:?}", workshop.files());
}

/// Killed at any moment, begun again, until it is done: the same bytes as undisturbed. `MBS_CASES` says how often.
#[test]
fn killed_runs_go_on() {
    let cases = std::env::var("MBS_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(4);
    let workshop = workshop();
    workshop.write("plan.toml", PLAN.replace("members = 20", "members = 300"));
    workshop.good(&["sweep", "plan.toml", "--out", "calm.csv"]);
    let calm = workshop.read("calm.csv");
    let (mut kills, mut random) = (0, 12_345_u64);
    while kills < cases {
        // The mechanism is derived first, so that some are killed before their first member.
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let patience = Duration::from_millis(50 + (random >> 33) % 700);
        let mut child = command(workshop.0.path(), &["sweep", "plan.toml", "--out", "torn.csv", "--threads", "2"])
            .env("MBS_CACHE_DIR", workshop.path("cache"))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(patience);
        match child.try_wait().unwrap() {
            None => {
                child.kill().unwrap();
                child.wait().unwrap();
                kills += 1;
            }
            Some(status) => assert!(status.success(), "{status}"),
        }
        if workshop.path("torn.csv").exists() {
            assert!(workshop.read("torn.csv") == calm, "after {kills} kills");
            let _ = std::fs::remove_dir_all(workshop.path("torn.csv.parts"));
            std::fs::remove_file(workshop.path("torn.csv")).unwrap();
        }
    }
    workshop.good(&["sweep", "plan.toml", "--out", "torn.csv"]);
    assert!(workshop.read("torn.csv") == calm);
}

/// Ranks of a launcher, one of which is killed; fewer of them do the rest, and the last makes the table. Skipped, by
/// name, where there is no `mpirun` of OpenMPI.
#[cfg(target_os = "linux")]
#[test]
fn ranks_of_mpi_go_on_after_one_has_died() {
    let version = std::process::Command::new("mpirun").arg("--version").output();
    if !version.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("Open MPI")) {
        eprintln!("skipped: ranks of MPI, there is no mpirun of OpenMPI");
        return;
    }
    ranks_go_on(&["--launched"]);
    // With MPI ranks find each other.
    if cfg!(feature = "mpi") {
        ranks_go_on(&[]);
    }
}

/// Ranks that find each other by these arguments, of which one is killed, and the table that fewer of them end with.
#[cfg(target_os = "linux")]
#[track_caller]
fn ranks_go_on(arguments: &[&str]) {
    let workshop = workshop();
    workshop.write("plan.toml", PLAN.replace("members = 20", "members = 300"));
    workshop.good(&["sweep", "plan.toml", "--out", "one.csv"]);
    let program = env!("CARGO_BIN_EXE_mbs");
    let launch = |ranks: &str| {
        let mut command = std::process::Command::new("mpirun");
        command.args(["--allow-run-as-root", "--oversubscribe", "-n", ranks, program, "sweep", "plan.toml"]);
        command.args(["--out", "all.csv", "--threads", "1"]);
        command.args(arguments);
        command.current_dir(workshop.0.path()).env("MBS_CACHE_DIR", workshop.path("cache"));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    // The death of a rank ends the job, as `mpirun` sees to it: rank 1 of 4 is killed as soon as it has done something.
    let job = launch("4").spawn().unwrap();
    let rows = workshop.path("all.csv.parts/rows-1-of-4");
    while !std::fs::metadata(&rows).is_ok_and(|metadata| metadata.len() > 0) {
        std::thread::sleep(Duration::from_millis(2));
        assert!(!workshop.path("all.csv").exists(), "it was faster");
    }
    let victim = std::fs::read_dir("/proc")
        .unwrap()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok()?.parse().ok());
    let is_rank_1 = |pid: &u32| {
        std::fs::read(format!("/proc/{pid}/environ")).is_ok_and(|environment| {
            let has = |text: &str| environment.split(|byte| *byte == 0).any(|variable| variable == text.as_bytes());
            has("OMPI_COMM_WORLD_RANK=1") && has(&format!("MBS_CACHE_DIR={}", workshop.path("cache").display()))
        })
    };
    for pid in victim.filter(is_rank_1) {
        std::process::Command::new("kill").args(["-9", &pid.to_string()]).status().unwrap();
    }
    let ended = job.wait_with_output().unwrap();
    assert!(!ended.status.success() && !workshop.path("all.csv").exists(), "{ended:?}");
    let ended = launch("3").output().unwrap();
    assert!(ended.status.success(), "{ended:?}");
    assert!(workshop.read("all.csv") == workshop.read("one.csv"));
    assert!(!workshop.path("all.csv.parts").exists());
}

/// What a plan is refused with; nothing is written.
#[track_caller]
fn refused(from: &str, to: &str, expected: &str) {
    let workshop = workshop();
    assert!(PLAN.contains(from), "{from}");
    workshop.write("plan.toml", PLAN.replacen(from, to, 1));
    assert_eq!(workshop.bad(&["sweep", "plan.toml"]), expected);
}

#[test]
fn unknown_names_are_named() {
    refused(
        "x = \"20 cm\"",
        "x_dott = 1",
        "error[MBS0310]: there is no variable `x_dott`\n --> plan.toml:6:1\n  |\n6 | x_dott = 1\n  | ^^^^^^\n  \
         = help: did you mean `x_dot`?\n",
    );
    refused(
        "max = \"dt(x)\"",
        "max = \"dt(y)\"",
        "error[MBS0310]: `y` is not declared\n  --> plan.toml:18:24\n   |\n18 | greatest = { max = \"dt(y)\" }\n   \
         |                        ^\n   = help: declare it: `param y: m = …;` or `let y = …;`\n",
    );
    refused(
        "seed = 3",
        "sede = 3",
        "error[MBS0310]: there is no key `sede`\n --> plan.toml:3:1\n  |\n3 | sede = 3\n  | ^^^^\n  = help: did you mean `seed`?\n",
    );
    refused(
        "duration = \"4 s\"",
        "duration = \"4 s\"\nmethod = \"rk5\"",
        "error[MBS0310]: there is no method `rk5`\n  --> plan.toml:14:10\n   |\n14 | method = \"rk5\"\n   |          ^^^^^\n   \
         = help: did you mean `rk4`?\n",
    );
}

#[test]
fn wrong_units_are_named() {
    refused(
        "\"100 g\"",
        "\"100 mm\"",
        "error[MBS0310]: \"100 mm\": its unit `mm` does not fit, kg is wanted\n --> plan.toml:9:25\n  |\n9 | \
         m = { normal = [\"2 kg\", \"100 mm\"], within = [\"1 kg\", \"3 kg\"] }\n  |                         ^^^^^^^^\n",
    );
}

/// What a formula needs and the mechanism has not.
#[test]
fn added_parameters_are_numbers_with_units() {
    refused(
        "m_per_number = \"1 m\"",
        "m_per_number = \"one m\"",
        "error[MBS0310]: \"one m\": write a number and its unit, as in \"20 deg\"\n  --> plan.toml:27:16\n   |\n27 | \
         m_per_number = \"one m\"\n   |                ^^^^^^^\n",
    );
}

/// The tail of a normal distribution: found among all members before one of them moves.
#[test]
fn masses_that_are_not_positive_are_found_first() {
    refused(
        "[\"2 kg\", \"100 g\"], within = [\"1 kg\", \"3 kg\"]",
        "[\"2 kg\", \"1.5 kg\"]",
        "error[MBS0310]: member 6 cannot be: `m` must not be negative, it is -0.8723955934391521; 4 of 40 are such\n \
         --> plan.toml:9:1\n  |\n9 | m = { normal = [\"2 kg\", \"1.5 kg\"] }\n  | ^\n  \
         = help: cut the distribution off, `within = [lowest, highest]`, or let it be lognormal\n",
    );
}

/// What is begun is not mixed with what is changed.
#[test]
fn changes_between_two_runs_are_refused() {
    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml", "--rank", "0", "--ranks", "2"]);
    workshop.write("plan.toml", PLAN.replace("seed = 3", "seed = 4"));
    let report = |what: &str| {
        format!(
            "error: plan.csv.parts holds members of another run: {what} changed since; remove it, or write to another file\n"
        )
    };
    assert_eq!(workshop.bad(&["sweep", "plan.toml"]), report("the plan has"));
    workshop.write("spring.mbs", SPRING.replace("k: N/m = 8", "k: N/m = 9"));
    assert_eq!(workshop.bad(&["sweep", "plan.toml"]), report("the plan and the mechanism have"));
    workshop.write("plan.toml", PLAN);
    assert_eq!(workshop.bad(&["sweep", "plan.toml"]), report("the mechanism has"));
    workshop.write("spring.mbs", SPRING);
    workshop.good(&["sweep", "plan.toml"]);
}

#[test]
fn tables_that_cannot_be_written_are_found_first() {
    let workshop = workshop();
    assert!(
        workshop
            .bad(&["sweep", "plan.toml", "--out", "nowhere/a.csv"])
            .starts_with("error: cannot write nowhere/a.csv: ")
    );
    assert_eq!(workshop.mbs(&["sweep", "plan.toml", "--out", "a.txt"]).code, 2);
    workshop.write("plan.csv", "mine");
    assert!(workshop.bad(&["sweep", "plan.toml"]).starts_with("error: plan.csv is there already"));
    assert_eq!(workshop.read("plan.csv"), "mine");
}

/// A disk without space: what is done stays, and the same command goes on once there is some.
#[cfg(target_os = "linux")]
#[test]
fn no_space_left_is_no_loss() {
    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml", "--rank", "0", "--ranks", "2"]);
    let full = workshop.path("plan.csv.parts/rows-0-of-1");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let Outcome { code, stderr, .. } = workshop.mbs(&["sweep", "plan.toml"]);
    assert_eq!(code, 1);
    assert!(
        stderr.starts_with("error: cannot write plan.csv.parts/rows-0-of-1: No space left on device")
            && stderr.ends_with("; what is done stays in plan.csv.parts, the same command goes on\n"),
        "{stderr}"
    );
    std::fs::remove_file(full).unwrap();
    assert!(workshop.good(&["sweep", "plan.toml"]).contains("40 members, 20 by "));
}

/// Members that stop are rows, too.
#[test]
fn members_that_stop_say_why() {
    let workshop = workshop();
    let plan = PLAN.replace("last = \"x\"", "root = { max = \"sqrt(x)\" }");
    workshop.write("plan.toml", plan);
    let Outcome { code, stderr, .. } = workshop.mbs(&["sweep", "plan.toml"]);
    assert_eq!(code, 0);
    let expected = "warning: 40 members of 40 stopped; the first is 0: the integration stopped: `root` is NaN at t = ";
    assert!(stderr.starts_with(expected), "{stderr}");
    let table = workshop.read("plan.csv");
    assert!(table.lines().last().unwrap().contains(",,,,,,,,,\"the integration stopped: `root` is NaN"), "{table}");
}

/// The speed `a √(k/m)` depends on both alike where both scatter alike: half of the variance each, within a hundredth.
#[test]
fn summaries_tell_quantiles_and_sensitivities() {
    let workshop = workshop();
    let plan = PLAN
        .replace("seed = 3", "seed = 3\ndesign = \"saltelli\"")
        .replace("{ normal = [\"2 kg\", \"100 g\"], within = [\"1 kg\", \"3 kg\"] }", "{ lognormal = [\"2 kg\", 0.1] }")
        .replace("{ values = [\"8 N/m\", \"12 N/m\"] }", "{ lognormal = [\"8 N/m\", 0.1] }")
        .replace("members = 20", "members = 128");
    workshop.write("plan.toml", plan);
    let object: Value = serde_json::from_str(&workshop.good(&["sweep", "plan.toml", "--summary", "--json"])).unwrap();
    let speed = &object["summary"]["greatest"];
    let median = speed["quantiles"][1]["value"].as_f64().unwrap();
    assert!((median - 0.4).abs() < 0.01, "{speed}");
    // The members of a row share what is drawn.
    assert!(speed["mean_interval"].is_null() && speed["quantiles"][1]["interval"].is_null(), "{speed}");
    for name in ["m", "k"] {
        for index in ["first", "total"] {
            let value = speed["indices"][name][index]["value"].as_f64().unwrap();
            assert!((value - 0.5).abs() < 0.05, "{name} {index}: {speed}");
        }
    }
    assert_eq!((&object["summary"]["never"]["members"], &object["members"]), (&0.into(), &512.into()));
    std::fs::remove_file(workshop.path("plan.csv")).unwrap();
    let text = workshop.good(&["sweep", "plan.toml", "--summary"]);
    assert!(text.contains("\ngreatest [m/s]       512") && text.contains("\ngreatest             k   "), "{text}");
}

/// Histograms, fans and parallel coordinates; the same bytes each time.
#[test]
fn tables_are_drawn() {
    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml"]);
    let draw = |options: &[&str]| {
        workshop.good(&[&["plot", "plan.csv", "--out", "a.svg"], options].concat());
        workshop.read("a.svg")
    };
    let all = draw(&[]);
    assert!(["quarter [s]", "k [N/m]", "40 members"].iter().all(|text| all.contains(text)) && !all.contains("never"));
    assert_eq!(all, draw(&[]));
    let one = draw(&["--columns", "quarter"]);
    assert!(one.contains("quarter [s]") && !one.contains("greatest"));
    let fan = draw(&["--columns", "quarter", "--over", "k"]);
    assert!(fan.contains("median") && fan.contains("k [N/m]"));
    let parallel = draw(&["--parallel", "--columns", "m,k,quarter"]);
    assert!(parallel.contains("1: m, 2: k, 3: quarter"));
    let columns: Vec<String> = (0..101).map(|k| format!("c{k}")).collect();
    let rows = ["0", "1"].map(|value| [value; 101].join(","));
    workshop.write("wide.csv", [columns.join(",").as_str(), &rows[0], &rows[1], ""].join("\n"));
    assert!(
        workshop.bad(&["plot", "wide.csv", "--out", "b.png"]).starts_with("error: 101 panels are too many for a PNG")
    );
    workshop.good(&["plot", "wide.csv", "--out", "a.svg"]);
    let report = workshop.bad(&["plot", "plan.csv", "--out", "b.svg", "--over", "quater"]);
    assert_eq!(report, "error: there is no column `quater`; did you mean \"quarter\"?\n");
    assert!(workshop.bad(&["plot", "plan.csv", "--out", "plan.csv.svg/x.svg"]).starts_with("error: cannot write "));
    assert!(workshop.bad(&["plot", "missing.csv", "--out", "b.svg"]).starts_with("error: cannot read missing.csv: "));
}

#[test]
fn previews_run_nothing() {
    let workshop = workshop();
    let before = workshop.files();
    let text = workshop.good(&["sweep", "plan.toml", "--dry-run"]);
    assert!(text.starts_with("40 members\nvaries:\n  m [kg]: ") && text.contains("\n  quarter [s]\n"), "{text}");
    // As the plan says it.
    assert!(text.contains("  m [kg]: { normal = [2.0, 0.1], within = [1.0, 3.0] }\n"), "{text}");
    let object: Value = serde_json::from_str(&workshop.good(&["sweep", "plan.toml", "--dry-run", "--json"])).unwrap();
    assert_eq!((&object["members"], &object["varies"][1]["unit"]), (&40.into(), &"N/m".into()));
    assert_eq!(workshop.files(), before);
}

/// A motion ends where the plan says so, at the time of an event; on constraints as well.
#[test]
fn motions_end_at_events() {
    let workshop = workshop();
    // A bob on a rod of 1 m, in Cartesian coordinates.
    let text = "mechanism Bob { param m: kg = 1; param g: m/s^2 = 10; coord x: m; coord z: m; \
                kinetic += 1/2*m*(dt(x)^2 + dt(z)^2); potential += m*g*z; constraint rod: x^2 + z^2 = 1*m^2; }";
    workshop.write("bob.mbs", text.replace("1*m^2", "r^2").replace("coord x", "param r: m = 1; coord x"));
    let plan = "mechanism = \"bob.mbs\"\n[fixed]\nx = 1\n[vary]\nz_dot = { values = [0, -1] }\n[motion]\n\
                duration = 5\nuntil = { zero = \"x\", direction = \"falling\" }\n[quantities]\nspeed = \"dt(x)\"\n\
                time = { time_of = \"x\" }\nheight = { min = \"z\" }\nenergy = \"energy\"\n";
    workshop.write("plan.toml", plan);
    workshop.good(&["sweep", "plan.toml"]);
    for row in rows(&workshop.read("plan.csv")) {
        let speed = (2.0 * (10.0 + 0.5 * number(&row, "z_dot").powi(2))).sqrt();
        assert!((number(&row, "speed") + speed).abs() < 1e-7, "{row:?}");
        assert!((number(&row, "height") + 1.0).abs() < 1e-9, "{row:?}");
        assert!((number(&row, "energy") - 0.5 * number(&row, "z_dot").powi(2)).abs() < 1e-7, "{row:?}");
    }
}

/// A mass that coasts at 1 m/s past stripes, 5 cm·2π apart.
#[test]
fn what_is_faster_than_the_motion_is_seen() {
    let workshop = workshop();
    let plan = "mechanism = \"spring.mbs\"\n[fixed]\nk = 1e-12\nx_dot = 1\n[vary]\nm = { values = [1, 2] }\n\
                [motion]\nduration = 10\n[quantities]\nstripes = { count = \"sin(x/(0.05 m))\" }\n\
                square = { mean = \"sin(x/(0.05 m))^2\" }\nshare = { mean = \"if x > 3 m { 1 } else { 0 }\" }\n\
                noise = { mean = \"sin(x/(1 m))^2 + cos(x/(1 m))^2 - 1\" }\n";
    workshop.write("plan.toml", plan);
    workshop.good(&["sweep", "plan.toml"]);
    for row in rows(&workshop.read("plan.csv")) {
        assert_eq!(number(&row, "stripes"), 63.0);
        // Rounding alone, which no halving makes smooth.
        assert!(number(&row, "noise").abs() < 1e-15);
        let square = 0.5 - 0.05 * (20.0 / 0.05_f64).sin() / 40.0;
        assert!(
            (number(&row, "square") - square).abs() < 1e-7 && (number(&row, "share") - 0.7).abs() < 1e-7,
            "{row:?}"
        );
    }
    std::fs::remove_file(workshop.path("plan.csv")).unwrap();
    workshop.write("plan.toml", plan.replace("duration = 10", "duration = 10\nmethod = \"rk4\"\nmax_step = 1"));
    assert!(workshop.bad(&["sweep", "plan.toml"]).contains("the method has no error control, `max_step` does nothing"));
}

/// Greatest values just behind and just before the end of a step, of which the end is the greatest of nine places, and
/// which are hardly greater than one before.
#[test]
fn extrema_beside_the_end_of_a_step_are_seen() {
    let workshop = workshop();
    let bumps = |peak: &str| format!("exp(-((t - 0.5 s)/(0.05 s))^2) + 1.01*exp(-((t - {peak} s)/(0.05 s))^2)");
    let (behind, before, between) = (bumps("1.41249"), bumps("1.38751"), bumps("1.4125"));
    let plan = format!(
        "mechanism = \"spring.mbs\"\n[vary]\nm = {{ values = [1, 2] }}\n[motion]\nduration = 2\nmethod = \"rk4\"\n\
         step = 0.2\n[quantities]\nbehind = {{ max = \"{behind}\" }}\nbefore = {{ max = \"{before}\" }}\n\
         between = {{ max = \"{between}\" }}\nleast = {{ min = \"-({behind})\" }}\n"
    );
    workshop.write("plan.toml", plan);
    workshop.good(&["sweep", "plan.toml"]);
    for row in rows(&workshop.read("plan.csv")) {
        for (name, sign) in [("behind", 1.0), ("before", 1.0), ("between", 1.0), ("least", -1.0)] {
            assert!((number(&row, name) - sign * 1.01).abs() < 1e-9, "{row:?}");
        }
    }
}

/// Three parallel cranks, one more than is needed: refused, or borne by all.
#[test]
fn redundant_constraints_are_refused_or_left_out() {
    let workshop = workshop();
    workshop.write("parallel.mbs", crate::constrained::PARALLEL);
    let plan = "mechanism = \"parallel.mbs\"\n[fixed]\na_0 = 1\na_1 = 1\na_2 = 1\nx = 0.7701511529340698\n\
                z = 0.42073549240394825\n[vary]\nm = { values = [1, 2] }\n[motion]\nduration = 0.5\n\
                redundant = \"WAY\"\n[quantities]\nenergy = \"energy\"\nopen = \"a[0] - a[2]\"\n";
    workshop.write("plan.toml", plan.replace("WAY", "refuse"));
    let Outcome { code, stderr, .. } = workshop.mbs(&["sweep", "plan.toml", "--out", "a.csv"]);
    assert!(code == 0 && stderr.contains("warning: 2 members of 2 stopped; the first is 0: "), "{stderr}");
    workshop.write("plan.toml", plan.replace("WAY", "least-norm"));
    workshop.good(&["sweep", "plan.toml", "--out", "b.csv"]);
    for row in rows(&workshop.read("b.csv")) {
        let expected = number(&row, "m") * 9.81 * 0.420_735_492_403_948_25;
        assert!((number(&row, "energy") - expected).abs() < 1e-8 && number(&row, "open").abs() < 1e-9, "{row:?}");
    }
    workshop.write("plan.toml", plan.replace("WAY", "least-nrm"));
    let Outcome { code, stderr, .. } = workshop.mbs(&["sweep", "plan.toml", "--out", "c.csv"]);
    assert!(code == 1 && stderr.contains("there is no way with redundant constraints `least-nrm`"), "{stderr}");
    assert!(stderr.contains("did you mean `least-norm`?"), "{stderr}");
}

/// The plans of `examples/ensembles/` are good, and their members move; the repository has them, a package has not.
#[test]
fn plans_of_the_examples_run() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/ensembles");
    let Ok(entries) = std::fs::read_dir(&folder) else { return };
    // A plan without a mechanism is of a program.
    let is_ours = |path: &std::path::PathBuf| {
        path.extension().is_some_and(|extension| extension == "toml")
            && std::fs::read_to_string(path).unwrap().contains("\nmechanism = ")
    };
    let plans: Vec<_> = entries.map(|entry| entry.unwrap().path()).filter(is_ours).collect();
    assert!(plans.len() >= 3, "{plans:?}");
    let workshop = Workshop::new();
    for plan in plans {
        let name = format!("{}.csv", plan.file_stem().unwrap().to_string_lossy());
        workshop.good(&["sweep", plan.to_str().unwrap(), "--out", &name]);
        let table = workshop.read(&name);
        assert!(table.lines().count() > 20 && !table.contains("stopped:"), "{name}");
        // What is compiled, where there is a compiler, and what is interpreted are the same bytes.
        workshop.good(&["sweep", plan.to_str().unwrap(), "--out", "interpreted.csv", "--interpret"]);
        assert!(workshop.read("interpreted.csv") == table, "{name}");
        std::fs::remove_file(workshop.path("interpreted.csv")).unwrap();
        if name == "pendulum_periods.csv" {
            for row in rows(&table) {
                let (theta, l) = (number(&row, "theta"), number(&row, "l"));
                // Gauss: T/4 = π/2 √(l/g) / agm(1, cos(θ/2)).
                let (mut a, mut b) = (1.0_f64, (theta / 2.0).cos());
                for _ in 0..10 {
                    (a, b) = ((a + b) / 2.0, (a * b).sqrt());
                }
                let expected = std::f64::consts::FRAC_PI_2 * (l / 9.81).sqrt() / a;
                assert!((number(&row, "quarter") - expected).abs() < 1e-8, "{row:?} {expected}");
            }
        }
        if name == "cart_pole_dispersions.csv" {
            assert!(rows(&table).iter().all(|row| number(row, "fallen") == 0.0 && number(row, "left") < 0.01));
        }
    }
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_has_units_and_provenance() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    let workshop = workshop();
    workshop.good(&["sweep", "plan.toml", "--out", "a.parquet"]);
    workshop.good(&["sweep", "plan.toml", "--out", "b.parquet", "--threads", "1"]);
    let bytes = std::fs::read(workshop.path("a.parquet")).unwrap();
    assert!(bytes == std::fs::read(workshop.path("b.parquet")).unwrap());
    let reader = SerializedFileReader::new(std::fs::File::open(workshop.path("a.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let pairs = metadata.key_value_metadata().unwrap();
    let value = |key: &str| pairs.iter().find(|pair| pair.key == key).unwrap().value.clone().unwrap();
    assert_eq!((value("unit of quarter"), value("plan").len()), ("s".to_string(), 7 + 64));
    workshop.good(&["sweep", "plan.toml", "--out", "a.csv"]);
    let expected = rows(&workshop.read("a.csv"));
    let found: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!(found.get_double(3).unwrap(), number(expected, "quarter"));
        assert!(found.get_double(9).is_err(), "what does not exist is null");
    }
}
