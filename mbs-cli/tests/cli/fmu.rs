//! `mbs fmu`: what is in an FMU, and what it does in masters: one in C, linked with its sources, and FMPy's.

use std::collections::BTreeSet;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::linearize::CRANKS;
use crate::{Outcome, Workshop, command};

const WARNINGS: [&str; 7] = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"];
const SANITIZERS: [&str; 3] = ["-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// The entries of an archive.
fn entries(workshop: &Workshop, name: &str) -> Vec<(String, Vec<u8>)> {
    let bytes = std::fs::read(workshop.path(name)).unwrap();
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let entry = |i| {
        let mut file = archive.by_index(i).unwrap();
        let mut content = Vec::new();
        file.read_to_end(&mut content).unwrap();
        (file.name().to_string(), content)
    };
    (0..count).map(entry).collect()
}

fn description(workshop: &Workshop, name: &str) -> String {
    let (first, content) = entries(workshop, name).remove(0);
    assert_eq!(first, "modelDescription.xml");
    String::from_utf8(content).unwrap()
}

/// The values of an attribute, in order.
fn values<'t>(text: &'t str, attribute: &str) -> Vec<&'t str> {
    let begin = format!(" {attribute}=\"");
    text.split(&begin).skip(1).map(|rest| &rest[..rest.find('"').unwrap()]).collect()
}

/// The sources of an FMU with the masters beside them; none where there is no C compiler.
fn sources(workshop: &Workshop, name: &str) -> Option<PathBuf> {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("skipped: cc, which is not there");
        return None;
    }
    let folder = workshop.path(&format!("{name}.sources"));
    std::fs::create_dir(&folder).unwrap();
    for (name, content) in entries(workshop, name) {
        if let Some(name) = name.strip_prefix("sources/") {
            std::fs::write(folder.join(name), content).unwrap();
        }
    }
    let masters = [
        ("master.h", include_str!("../fmu/master.h")),
        ("master2.c", include_str!("../fmu/master2.c")),
        ("master3.c", include_str!("../fmu/master3.c")),
        ("both.c", include_str!("../fmu/both.c")),
    ];
    masters.iter().for_each(|(name, text)| std::fs::write(folder.join(name), text).unwrap());
    Some(folder)
}

/// Compiles a master with all warnings, and with sanitizers where the compiler has them.
fn compiled(folder: &Path, master: &str) {
    let compile = |options: &[&str]| {
        let arguments = [&WARNINGS[..], options, &[master, "-o", "master", "-lm"]].concat();
        Command::new("cc").args(arguments).current_dir(folder).output().unwrap()
    };
    std::fs::write(folder.join("nothing.c"), "int main(void) { return 0; }\n").unwrap();
    let can = Command::new("cc").args(SANITIZERS).args(["nothing.c", "-o", "nothing"]).current_dir(folder).output();
    let options = if can.is_ok_and(|output| output.status.success()) { &SANITIZERS[..] } else { &[][..] };
    let output = compile(options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Its sources with the master for any mechanism, compiled; the workshop is where they are. None without a compiler.
fn packed(text: &str, state: &str) -> Option<(Workshop, PathBuf)> {
    let workshop = Workshop::new();
    workshop.write("a.mbs", text);
    workshop.good(&["fmu", "a.mbs", "--sources-only", "--state", state, "--out", "a.fmu"]);
    let folder = sources(&workshop, "a.fmu")?;
    compiled(&folder, "both.c");
    Some((workshop, folder))
}

fn run(folder: &Path, arguments: &[&str]) -> Outcome {
    Outcome::of(Command::new(folder.join("master")).args(arguments).current_dir(folder).output().unwrap())
}

#[test]
fn an_fmu_has_what_the_standards_ask_for() {
    let workshop = Workshop::new();
    for (version, main, token) in [("2", "fmi2.c", "guid"), ("3", "fmi3.c", "instantiationToken")] {
        let made = |out: &str| {
            workshop.good(&["fmu", "pendulum.mbs", "--fmi", version, "--sources-only", "--out", out]);
            std::fs::read(workshop.path(out)).unwrap()
        };
        assert_eq!(made("a.fmu"), made("b.fmu"), "the same bytes");
        let names: Vec<String> = entries(&workshop, "a.fmu").into_iter().map(|(name, _)| name).collect();
        let files = ["modelDescription.xml", "sources/pendulum.h", "sources/model.h", "sources/instance.h"];
        assert_eq!(names[..4], files);
        assert_eq!(names[8], format!("sources/{main}"));
        let text = description(&workshop, "a.fmu");
        let (_, variables) = text.split_once("<ModelVariables>").unwrap();
        let (variables, structure) = variables.split_once("</ModelVariables>").unwrap();
        let expected = [
            "time",
            "theta",
            "theta_dot",
            "der(theta)",
            "der(theta_dot)",
            "tau",
            "m",
            "l",
            "g",
            "b",
            "height",
            "kinetic_energy",
            "potential_energy",
            "energy",
        ];
        assert_eq!(values(variables, "name"), expected);
        let references: Vec<String> = (0..expected.len()).map(|i| i.to_string()).collect();
        assert_eq!(values(variables, "valueReference"), references);
        assert_eq!(values(variables, "start"), ["0.0", "0.0", "0.0", "3.0", "2.0", "10.0", "0.25"]);
        let first = if version == "2" { 1 } else { 0 };
        assert_eq!(values(variables, "derivative"), [format!("{}", 1 + first), format!("{}", 2 + first)]);
        // θ̈ depends on θ, θ̇ and the torque.
        let all = format!("{} {} {}", 1 + first, 2 + first, 5 + first);
        assert!(values(structure, "dependencies").contains(&all.as_str()), "{structure}");
        assert!(
            text.contains("<Unit name=\"N*m*s/rad\"><BaseUnit kg=\"1\" m=\"2\" s=\"-1\" rad=\"-1\"/></Unit>"),
            "{text}"
        );
        let token = values(&text, token)[0];
        assert_eq!(token.len(), 38);
        // Another start is another FMU.
        pack_released(&workshop, version, "a.fmu");
        assert_ne!(
            values(&description(&workshop, "a.fmu"), if version == "2" { "guid" } else { "instantiationToken" })[0],
            token
        );
    }
}

/// Packs the sources of the pendulum, which is let go at 1 rad.
fn pack_released(workshop: &Workshop, version: &str, out: &str) {
    let options = ["--fmi", version, "--sources-only", "--state", "{\"theta\": 1}", "--out", out];
    workshop.good(&[&["fmu", "pendulum.mbs"][..], &options].concat());
}

#[test]
fn names_are_told_apart() {
    let workshop = Workshop::new();
    workshop.write(
        "names.mbs",
        "mechanism Names {
         /// A mass < 5 & \"small\".\n param energy: kg = 1; param x_dot: m = 2; param time: m = 1; coord x: m;
         kinetic += energy*dt(x)^2/2; potential += (1 N/m)*(x - x_dot - time)^2; output lambda = x; }",
    );
    workshop.good(&["fmu", "names.mbs", "--sources-only", "--out", "names.fmu"]);
    let text = description(&workshop, "names.fmu");
    let (_, variables) = text.split_once("<ModelVariables>").unwrap();
    let names = values(variables.split_once("</ModelVariables>").unwrap().0, "name");
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{names:?}");
    assert!(names.contains(&"energy_2") && names.contains(&"time_2"), "{names:?}");
    assert!(text.contains("A mass &lt; 5 &amp; &quot;small&quot;."), "{text}");
    let says = ["Rate of x.", "Derivative of x.", "Acceleration of x."].map(|says| format!("description=\"{says}\""));
    assert!(says.iter().all(|says| text.contains(says)) && !text.contains(": \""), "{text}");
}

/// Of a mechanism in plain numbers, time and energies have no units either.
#[test]
fn plain_numbers_have_no_units() {
    let workshop = Workshop::new();
    let text =
        "#![dimensionless] mechanism Orbit { param mu: 1 = 0.1; coord x: 1; kinetic += dt(x)^2; force x += mu; }";
    workshop.write("orbit.mbs", text);
    workshop.good(&["fmu", "orbit.mbs", "--sources-only", "--out", "orbit.fmu"]);
    let text = description(&workshop, "orbit.fmu");
    assert!(!text.contains("nit=") && !text.contains("<Unit"), "{text}");
}

#[test]
fn masters_in_c_find_a_pendulum_and_are_refused_what_is_wrong() {
    let workshop = Workshop::new();
    for version in ["2", "3"] {
        let out = format!("{version}.fmu");
        pack_released(&workshop, version, &out);
        let Some(folder) = sources(&workshop, &out) else { return };
        compiled(&folder, &format!("master{version}.c"));
        assert_eq!(run(&folder, &[]), Outcome { code: 0, stdout: "good\n".to_string(), stderr: String::new() });
    }
}

/// Events, signals and constraints: both ways of integration against `mbs simulate`.
#[test]
fn motions_are_those_of_the_program() {
    let signals =
        "{\"q\": [0.4, 0.9], \"u\": [0.3], \"prescribed\": {\"slide\": [0, 0.1, 0.6], \"spin\": [1.5, 0, 0]}}";
    let slides = ["--signal", "slide=0.1*t + 0.3*t^2", "--signal", "spin=1.5"];
    // Of a signal that model exchange is told nothing of it stays as it is: co-simulation alone.
    let none: &[&str] = &[];
    let cases = [
        (
            ["gate", include_str!("../fmu/gate.mbs")],
            ["{\"q\": [0, 0.1], \"qd\": [1.5, 0], \"u\": [0.1]}"; 2],
            none,
            true,
        ),
        (
            ["turning", include_str!("../fmu/turning.mbs")],
            [signals, "{\"q\": [0.4, 0.9], \"u\": [0.3]}"],
            slides.as_slice(),
            false,
        ),
        (
            ["cartesian_pendulum", include_str!("../mechanisms/cartesian_pendulum.mbs")],
            ["{\"q\": [0.6, -0.8]}"; 2],
            none,
            true,
        ),
    ];
    for ([name, text], [state, simulated], drive, exchanges) in cases {
        let workshop = Workshop::new();
        let file = format!("{name}.mbs");
        workshop.write(&file, text);
        let fmu = workshop.mbs(&["fmu", &file, "--sources-only", "--state", state, "--out", "a.fmu"]);
        assert_eq!(fmu.code, 0, "{}", fmu.stderr);
        let Some(folder) = sources(&workshop, "a.fmu") else { return };
        compiled(&folder, "both.c");
        let arguments = [
            "simulate", &file, "--state", simulated, "--t-end", "1.5", "--dt", "0.25", "--rtol", "1e-13", "--atol",
            "1e-15",
        ];
        let table = workshop.mbs(&[&arguments[..], drive].concat()).stdout;
        let numbers = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = table.lines().skip(1).map(numbers).collect();
        for kind in if exchanges { &["0", "1"][..] } else { &["0"][..] } {
            let Outcome { code, stdout, .. } = run(&folder, &[*kind, "1.5", "0.25", "1000"]);
            assert_eq!(code, 0, "{name}: {stdout}");
            let (motion, rest): (Vec<&str>, Vec<&str>) =
                stdout.lines().partition(|line| line.starts_with(|c: char| c.is_ascii_digit()));
            assert_eq!(motion.len(), rows.len(), "{stdout}");
            for (found, expected) in motion.into_iter().map(numbers).zip(&rows) {
                for (a, b) in found.iter().zip(expected) {
                    assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{name}, {kind}: {found:?}, not {expected:?}");
                }
            }
            if name == "gate" && *kind == "1" {
                let events: usize = rest[0].strip_prefix("events ").unwrap().parse().unwrap();
                assert!(events >= 5, "{events}");
            }
        }
    }
}

/// The rod of a pendulum becomes longer between two steps: it goes on as a new FMU would from the same state, which
/// is brought onto the constraint before it moves.
#[test]
fn steps_begin_on_the_constraints_of_parameters_as_they_are() {
    let text = include_str!("../mechanisms/cartesian_pendulum.mbs");
    let Some((_workshop, folder)) = packed(text, "{\"q\": [0.6, -0.8]}") else { return };
    let Outcome { code, stdout, .. } = run(&folder, &["2", "1", "0.5", "1"]);
    assert_eq!(code, 0, "{stdout}");
    let numbers = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = stdout.lines().filter(|line| line.starts_with("1,")).map(numbers).collect();
    let [tuned, new] = &rows[..] else { panic!("{stdout}") };
    assert!(tuned.iter().zip(new).all(|(a, b)| (a - b).abs() < 1e-10), "{stdout}");
    assert!((new[1].hypot(new[2]) - 1.2).abs() < 1e-9, "{stdout}");
}

/// What comes and goes within a communication step: a booster of 0.1 s, and a soft ceiling that is touched for
/// 2 atan(10)/ω = 0.093 s of two seconds.
#[test]
fn conditions_that_change_and_change_back_within_a_step_are_seen() {
    let bump = "mechanism Bump { coord x: m; kinetic += 1/2*(1 kg)*dt(x)^2;
        force x += if abs(x - 5.27 m) < 0.05 m { 10 N } else { 0 N }; }";
    let ceiling = "mechanism Ceiling { param k: N/m = 1000; param h: m = 4.5; coord z: m;
        kinetic += 1/2*(1 kg)*dt(z)^2; potential += (1 kg)*(10 m/s^2)*z;
        force z += if z > h { -k*(z - h) } else { 0 }; }";
    // It leaves the ceiling downwards as fast as it came, at √(10² − 2·10·4.5) m/s.
    let speed = 10_f64.sqrt();
    let fall = 2.0 - (10.0 - speed) / 10.0 - 2.0 * 10_f64.atan() / 1000_f64.sqrt();
    let fallen = [4.5 - speed * fall - 5.0 * fall.powi(2), -speed - 10.0 * fall];
    // Work of 10 N along 0.1 m; what is left of the way after the booster, which takes (√3 − 1)/10 s.
    let boosted = [5.32 + 3_f64.sqrt() * (100.0 - 5.22 - (3_f64.sqrt() - 1.0) / 10.0), 3_f64.sqrt()];
    for (text, rate, end, dt, expected) in
        [(bump, 1.0, "100", "0.2", boosted), (ceiling, 10.0, "2", "2", fallen), (ceiling, 10.0, "2", "0.25", fallen)]
    {
        let state = format!("{{\"q\": [0], \"qd\": [{rate}]}}");
        let Some((_workshop, folder)) = packed(text, &state) else { return };
        let Outcome { code, stdout, .. } = run(&folder, &["0", end, dt, "1"]);
        assert_eq!(code, 0, "{stdout}");
        let last: Vec<f64> = stdout.lines().last().unwrap().split(',').skip(1).map(|x| x.parse().unwrap()).collect();
        for (found, expected) in last.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{last:?}, not {expected:?}");
        }
    }
}

/// A condition that changes without end: friction that jumps where a mass comes to rest on its own.
#[test]
fn friction_that_jumps_at_rest_is_refused_with_its_reason() {
    // It comes to rest at 0.5 s and at 2 s; driven from one side, it goes back more slowly than it came.
    for (drive, end, rest) in [("0 N", "1", 0.5), ("1.5 N", "3", 2.0)] {
        let force = format!("force x += {drive} - (2 N)*signum(dt(x));");
        let text = format!("mechanism Sledge {{ coord x: m; kinetic += 1/2*(1 kg)*dt(x)^2; {force} }}");
        let Some((_workshop, folder)) = packed(&text, "{\"q\": [0], \"qd\": [1]}") else { return };
        let Outcome { code, stdout, .. } = run(&folder, &["0", end, "0.1", "1"]);
        let (_, said) = stdout.split_once("fmi3DoStep: ").expect(&stdout);
        let (said, t) = said.split_once(", as of friction").unwrap().0.split_once(" t = ").expect(&stdout);
        let t: f64 = t.split(' ').next().unwrap().parse().unwrap();
        assert!(code != 0 && said.starts_with("a ") && (t - rest).abs() < 1e-6, "{stdout}");
    }
}

/// Files of the FMU's own have names that mechanisms may have, too.
#[test]
fn mechanisms_are_called_as_they_like() {
    for name in ["Model", "Instance", "States", "Constraints", "Integration", "Jacobian", "Math", "Stdio"]
        .into_iter()
        .chain(["Fmu", "FmuValues", "FmuInstance", "AllFinite", "StatesSet", "ModeName", "TimeSet", "SameSides"])
        .chain(["Mode", "Communication"])
    {
        // Their functions would be `fmu_place`, `mode_name`, and `communication_step`.
        let outputs = "output place = x; output name = x; output step = x;";
        let text = format!("mechanism {name} {{ coord x: m; kinetic += 1/2*(1 kg)*dt(x)^2; {outputs} }}");
        let Some((_workshop, folder)) = packed(&text, "{\"q\": [0], \"qd\": [1]}") else { return };
        let Outcome { code, stdout, .. } = run(&folder, &["0", "1", "0.5", "1"]);
        assert_eq!(code, 0, "{name}: {stdout}");
        let last: Vec<f64> = stdout.lines().last().unwrap().split(',').map(|x| x.parse().unwrap()).collect();
        assert!((last[1] - 1.0).abs() < 1e-9, "{name}: {stdout}");
    }
}

/// A row that depends on the others: co-simulation stays on them, the pendulum that all cranks are, and model exchange,
/// whose integrator leaves them, is refused.
#[test]
fn constraints_that_repeat_others_are_for_co_simulation() {
    let workshop = Workshop::new();
    workshop.write("cranks.mbs", CRANKS);
    let (l, q): (f64, f64) = (0.5, 0.7);
    let state = format!("{{\"q\": [{q}, {q}, {q}, {}, {}, 0]}}", l * q.sin(), -l * q.cos());
    workshop.good(&["fmu", "cranks.mbs", "--sources-only", "--state", &state, "--out", "a.fmu"]);
    let Some(folder) = sources(&workshop, "a.fmu") else { return };
    compiled(&folder, "both.c");
    let refused = run(&folder, &["1", "1.5", "0.25", "1000"]);
    let said = "fmi3EnterContinuousTimeMode: constraint `hinge_";
    assert!(refused.code != 0 && refused.stdout.contains(said), "{}", refused.stdout);
    assert!(refused.stdout.contains("depends on the others: use co-simulation"), "{}", refused.stdout);

    let pendulum = "mechanism Pendulum { coord q: rad; kinetic += 1/2*(1.25 kg)*(0.25 m^2)*dt(q)^2; \
        potential += -1.5*(1 kg)*(9.81 m/s^2)*(0.5 m)*cos(q); }";
    workshop.write("pendulum.mbs", pendulum);
    let steps = ["--state", "{\"q\": [0.7]}", "--t-end", "1.5", "--dt", "0.25", "--rtol", "1e-13", "--atol", "1e-15"];
    let expected = workshop.good(&[&["simulate", "pendulum.mbs"], &steps[..]].concat());
    let found = run(&folder, &["0", "1.5", "0.25", "1000"]);
    assert_eq!(found.code, 0, "{}", found.stdout);
    let angle = |line: &str| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    let pairs: Vec<[f64; 2]> =
        found.stdout.lines().zip(expected.lines().skip(1)).map(|(a, b)| [angle(a), angle(b)]).collect();
    assert!(pairs.len() == 7 && pairs.iter().all(|[a, b]| (a - b).abs() < 1e-8), "{pairs:?}");
}

#[test]
fn libraries_are_compiled_where_there_is_a_compiler() {
    let workshop = Workshop::new();
    let mut without = command(workshop.0.path(), &["fmu", "pendulum.mbs", "--out", "a.fmu"]);
    let Outcome { code, stderr, .. } = Outcome::of(without.env("MBS_CC", "").output().unwrap());
    let words = "warning: there is no C compiler; the FMU has sources only\n";
    assert!(code == 0 && (stderr == words || !cfg!(target_os = "linux")), "{stderr}");
    assert!(entries(&workshop, "a.fmu").iter().all(|(name, _)| !name.starts_with("binaries")));
    let mut missing = command(workshop.0.path(), &["fmu", "pendulum.mbs", "--out", "a.fmu"]);
    let Outcome { stderr, .. } = Outcome::of(missing.env_remove("MBS_CC").env("CC", "no-such -m64").output().unwrap());
    let words = "warning: there is no C compiler `no-such -m64`; the FMU has sources only\n";
    assert!(stderr == words || !cfg!(target_os = "linux"), "{stderr}");
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        std::fs::remove_file(workshop.path("a.fmu")).unwrap();
        let report = workshop.bad(&["fmu", "pendulum.mbs", "--compiler", "false", "--out", "a.fmu"]);
        assert!(report.starts_with("error: cannot compile the FMU: `") && report.contains("/false` fails"), "{report}");
        let says = "In file included from fmi3.c:58:\\nb.h:3:5: error: the reason\\n    3 | x\\n";
        workshop.write("fails.sh", format!("#!/bin/sh\nprintf '{says}' >&2\nexit 1\n"));
        assert!(Command::new("chmod").arg("+x").arg(workshop.path("fails.sh")).status().unwrap().success());
        let report = workshop.bad(&["fmu", "pendulum.mbs", "--compiler", "./fails.sh", "--out", "a.fmu"]);
        let (reason, log) = report.trim_end().split_once("; all it says is in ").expect("where the log is");
        assert!(reason.ends_with("fails.sh` fails: b.h:3:5: error: the reason"), "{report}");
        let log = Path::new(log);
        assert_eq!(std::fs::read_to_string(log).unwrap().lines().count(), 3);
        let folder = log.parent().unwrap();
        assert!(folder.join("fmi3.c").is_file());
        std::fs::remove_dir_all(folder).unwrap();
        let report = workshop.bad(&["fmu", "pendulum.mbs", "--compiler", "no-such-compiler -m64", "--out", "a.fmu"]);
        assert_eq!(report, "error: cannot compile the FMU: there is no C compiler `no-such-compiler -m64`\n");
        if Command::new("cc").arg("--version").output().is_ok() {
            workshop.good(&["fmu", "pendulum.mbs", "--fmi", "2", "--out", "a.fmu"]);
            let library = entries(&workshop, "a.fmu").remove(1);
            assert!(library.0 == "binaries/linux64/pendulum.so" && library.1.starts_with(b"\x7fELF"));
            let first = std::fs::read(workshop.path("a.fmu")).unwrap();
            workshop.good(&["fmu", "pendulum.mbs", "--fmi", "2", "--compiler", "cc -pipe", "--out", "a.fmu"]);
            assert!(first == std::fs::read(workshop.path("a.fmu")).unwrap(), "the same bytes");
            // A path is seen from the folder that `mbs` is called in.
            let script = workshop.path("cc.sh");
            workshop.write("cc.sh", "#!/bin/sh\nexec cc \"$@\"\n");
            assert!(Command::new("chmod").arg("+x").arg(script).status().unwrap().success());
            workshop.good(&["fmu", "pendulum.mbs", "--fmi", "2", "--compiler", "./cc.sh", "--out", "a.fmu"]);
            assert!(first == std::fs::read(workshop.path("a.fmu")).unwrap(), "the same bytes");
        }
    }
}

#[test]
fn what_is_no_fmu_is_refused() {
    let workshop = Workshop::new();
    let report = workshop.bad(&["fmu", "pendulum.mbs", "--out", "pendulum.mbs"]);
    assert!(report.contains("--out pendulum.mbs would overwrite a file in use"), "{report}");
    let report = workshop.bad(&["fmu", "pendulum.mbs", "--state", "[{\"q\": [0]}]", "--out", "a.fmu"]);
    assert_eq!(report, "error: an FMU starts from one state, found an array\n");
    let report =
        workshop.bad(&["fmu", "pendulum.mbs", "--state", "{\"q\": [0], \"params\": {\"m\": -1}}", "--out", "a.fmu"]);
    assert!(report.contains("must not be negative"), "{report}");
    for tolerance in ["0", "NaN", "-1", "1"] {
        assert_eq!(workshop.mbs(&["fmu", "pendulum.mbs", "--tolerance", tolerance, "--out", "a.fmu"]).code, 2);
    }
    assert_eq!(workshop.mbs(&["fmu", "pendulum.mbs", "--fmi", "1", "--out", "a.fmu"]).code, 2);
}

/// FMPy: the interpreter is MBS_PYTHON, or python3.
fn python() -> Option<String> {
    let python = std::env::var("MBS_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let there = Command::new(&python).args(["-c", "import fmpy"]).output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: fmpy, `{python} -c 'import fmpy'` fails");
    }
    there.then_some(python)
}

#[test]
fn fmpy_validates_and_simulates() {
    let Some(python) = python() else { return };
    let workshop = Workshop::new();
    workshop.write("validate.py", include_str!("../fmu/validate.py"));
    workshop.write("gate.mbs", include_str!("../fmu/gate.mbs"));
    workshop.write(
        "cases.json",
        "[{\"model\": \"pendulum.mbs\", \"state\": {\"theta\": 1}, \"t_end\": 1, \"dt\": 0.1},
          {\"model\": \"gate.mbs\", \"state\": {\"q\": [0, 0.1], \"qd\": [1.5, 0], \"u\": [0.1]}, \"t_end\": 1, \"dt\": 0.1, \"events\": 3, \"substeps\": 400}]",
    );
    let output = Command::new(python)
        .args(["validate.py", env!("CARGO_BIN_EXE_mbs"), ".", "cases.json"])
        .env("MBS_CACHE_DIR", "")
        .current_dir(workshop.path("."))
        .output()
        .unwrap();
    let Outcome { code, stdout, stderr } = Outcome::of(output);
    assert_eq!(code, 0, "{stdout}{stderr}");
    assert_eq!(stdout.lines().count(), 4, "{stdout}");
}

/// The program of docs/fmu.md.
#[test]
fn the_manual_has_a_program_that_runs() {
    let Some(python) = python() else { return };
    let workshop = Workshop::new();
    workshop.write("cart_pole.mbs", include_str!("../mechanisms/cart_pole.mbs"));
    workshop.write("example.py", include_str!("../fmu/example.py"));
    workshop.good(&["fmu", "cart_pole.mbs", "--state", "{\"theta\": 0.2}", "--out", "cart_pole.fmu"]);
    let output = Command::new(python).arg("example.py").current_dir(workshop.path(".")).output().unwrap();
    let Outcome { code, stdout, stderr } = Outcome::of(output);
    assert_eq!(code, 0, "{stderr}");
    let state = "{\"theta\": 0.2, \"params\": {\"m_bob\": 0.2}}";
    let table = workshop.good(&["simulate", "cart_pole.mbs", "--state", state, "--t-end", "2", "--dt", "0.5"]);
    let numbers = |line: &str, by: char| line.split(by).map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let found: Vec<Vec<f64>> = stdout.lines().map(|line| numbers(line, ' ')).collect();
    let expected = table.lines().skip(1).map(|line| numbers(line, ','));
    assert_eq!(found.len(), 5, "{stdout}");
    for (found, expected) in found.iter().zip(expected) {
        let [t, x, theta, _, _, energy] = expected[..] else { panic!("{table}") };
        for (a, b) in found.iter().zip([t, x, theta, energy]) {
            assert!((a - b).abs() < 3e-9 * (1.0 + b.abs()), "{found:?}, not {expected:?}");
        }
    }
}
