//! What the program says of itself: help with examples that run, completions, manual pages, pages of diagnostics; and
//! how it says it: colours, JSON, exit codes.

use std::process::{Command, Stdio};

use serde_json::Value;

use crate::{Outcome, Workshop, command, keys};

/// Commands that are listed, `help` aside.
fn commands(workshop: &Workshop) -> Vec<String> {
    let help = workshop.good(&["--help"]);
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let rows = list.lines().take_while(|line| !line.trim().is_empty());
    // A description that goes on in the next line is indented further.
    let names = rows.filter_map(|line| line.strip_prefix("  ")?.split(' ').next().filter(|name| !name.is_empty()));
    names.map(str::to_string).filter(|name| name != "help").collect()
}

/// Words as a shell takes them: apart at spaces, but not within single quotes.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (number, part) in line.split('\'').enumerate() {
        match number % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_string)),
            _ => words.push(part.to_string()),
        }
    }
    words
}

#[test]
fn help_fits_on_a_screen() {
    let workshop = Workshop::new();
    let help = workshop.good(&["--help"]);
    assert!(help.lines().count() <= 40, "{}:\n{help}", help.lines().count());
    assert!(help.contains("Exit codes: 0 fine, 1 the model or the input is bad, 2 wrong usage"), "{help}");
    assert!(workshop.good(&["-h"]).lines().count() <= 40);
    let all = commands(&workshop);
    for name in ["check", "simulate", "sweep", "new", "explain", "watch", "completions", "man"] {
        assert!(all.iter().any(|command| command == name), "{name} is not among {all:?}");
    }
}

/// A link that hangs from the world.
const ARM: &str = r#"<robot name="arm">
  <link name="base"/>
  <link name="upper">
    <inertial>
      <origin xyz="0 0 -0.3"/>
      <mass value="2"/>
      <inertia ixx="0.06" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.001"/>
    </inertial>
  </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/>
    <child link="upper"/>
    <axis xyz="0 1 0"/>
  </joint>
</robot>
"#;

/// The pendulum from three angles.
pub(crate) const SWINGS: &str = "\
mechanism = \"pendulum.mbs\"
[vary]
theta = { values = [\"10 deg\", \"20 deg\", \"30 deg\"] }
[motion]
duration = \"3 s\"
[quantities]
highest = { max = \"height\" }
";

/// Each example of each command runs as it stands there; what goes on until it is interrupted, until it has answered.
#[test]
fn examples_of_the_help_run() {
    let workshop = Workshop::new();
    workshop.write("arm.urdf", ARM);
    workshop.write("swings.toml", SWINGS);
    crate::new::checkout(&workshop, ".");
    // The language server speaks until it is told to end: `lsp.rs` talks with it.
    for name in commands(&workshop).into_iter().filter(|name| name != "lsp") {
        let help = workshop.good(&[&name, "--help"]);
        let (_, behind) = help.split_once("Example:\n").unwrap_or_else(|| panic!("{name} has no example:\n{help}"));
        let lines: Vec<&str> = behind
            .lines()
            .take_while(|line| line.starts_with("  "))
            .filter_map(|l| l.trim().strip_prefix("mbs "))
            .collect();
        assert!(!lines.is_empty(), "{help}");
        for line in lines {
            let arguments = words(line);
            let mut arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            assert_eq!(arguments[0], name, "{line}");
            if name == "watch" {
                arguments.push("--once");
            }
            let Outcome { code, stdout, stderr } = workshop.mbs(&arguments);
            assert_eq!((code, stderr.as_str()), (0, ""), "{line}: {stdout}");
        }
    }
    for file in [
        "pendulum.h",
        "motion.csv",
        "motion.svg",
        "swings.csv",
        "swings.svg",
        "pendulum.fmu",
        "report.html",
        "arm.mbs",
        "pendulum/Cargo.toml",
        "robots/picker/Cargo.toml",
    ] {
        assert!(workshop.path(file).exists(), "no example has written {file}");
    }
}

/// The README names them: a program without says how to have them, and does not list them.
#[test]
fn features_that_are_not_there_are_named() {
    let workshop = Workshop::new();
    let lacks = |arguments: &[&str], name: &str| {
        let says = format!("error: this mbs is built without its feature `{name}`");
        assert!(workshop.misused(arguments).starts_with(&says), "{arguments:?}");
        assert!(!workshop.good(&["--help"]).contains(&format!("\n  {name}")), "{name}");
        assert!(!workshop.good(&["ops", "--help"]).contains(&format!("--{name}")), "{name}");
    };
    if cfg!(not(feature = "lsp")) {
        lacks(&["lsp"], "lsp");
        lacks(&["lsp", "--stdio"], "lsp");
    }
    if cfg!(not(feature = "accuracy")) {
        lacks(&["ops", "pendulum.mbs", "--accuracy"], "accuracy");
    }
}

#[test]
fn codes_have_pages() {
    let workshop = Workshop::new();
    let list = workshop.good(&["explain"]);
    assert!(list.lines().count() > 100 && list.starts_with("MBS0101  "), "{list}");
    let page = workshop.good(&["explain", "703"]);
    assert!(page.starts_with("MBS0703: a sum of different dimensions\n\n"), "{page}");
    assert!(page.contains("\nwrong:\n\n    mechanism ") && page.contains("\nright:\n\n    mechanism "), "{page}");
    assert_eq!(workshop.good(&["explain", "mbs0703"]), page);
    assert!(workshop.bad(&["explain", "MBS9999"]).starts_with("error: there is no code `MBS9999`"));
    // Whoever has a message finds its page.
    workshop.write("bad.mbs", crate::PENDULUM.replace("(l * dt(theta))^2", "dt(theta)"));
    let report = workshop.bad(&["check", "bad.mbs"]);
    let code = report.split(['[', ']']).nth(1).unwrap();
    assert_eq!(code, "MBS0801");
    assert!(workshop.good(&["explain", code]).contains("energy"));
    let object: Value = serde_json::from_str(&workshop.good(&["explain", "0301", "--json"])).unwrap();
    assert_eq!(keys(&object), ["code", "title", "text", "wrong", "right"]);
    assert_eq!(object["wrong"][1]["file"], "steel.mbs");
}

#[test]
fn every_shell_has_completions() {
    let workshop = Workshop::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = workshop.good(&["completions", shell]);
        for word in ["simulate", "explain", "t-end", "no-cache"] {
            assert!(script.contains(word), "{shell} does not complete {word}");
        }
    }
    assert_eq!(workshop.mbs(&["completions", "tcsh"]).code, 2);
    // Where there is a bash, it takes the script and completes by it.
    let script = workshop.good(&["completions", "bash"]);
    workshop.write(
        "mbs.bash",
        script + "\nCOMP_WORDS=(mbs expl); COMP_CWORD=1; _mbs mbs expl mbs; echo \"${COMPREPLY[@]}\"\n",
    );
    if let Ok(output) = Command::new("bash").arg(workshop.path("mbs.bash")).stdin(Stdio::null()).output() {
        assert_eq!(Outcome::of(output).stdout, "explain\n");
    }
}

#[test]
fn the_manual_has_a_page_for_each_command() {
    let workshop = Workshop::new();
    workshop.good(&["man", "--out", "man"]);
    for name in commands(&workshop) {
        let page = workshop.read(&format!("man/mbs-{name}.1"));
        assert!(page.contains(&format!("mbs\\-{name}")) && page.contains(".SH SYNOPSIS"), "{page}");
    }
    let all = workshop.read("man/mbs.1");
    assert!(all.contains("Exit codes: 0 fine") && all.contains("mbs\\-simulate(1)"), "{all}");
    assert_eq!(workshop.good(&["man"]), all, "the same bytes each time");
    workshop.write("file", "");
    assert!(workshop.bad(&["man", "--out", "file"]).starts_with("error: cannot make the folder file: "));
}

/// `--json`: one value on standard output; messages on standard error, an object a line.
#[test]
fn every_command_speaks_json() {
    let workshop = Workshop::new();
    let json = |arguments: &[&str]| -> Value {
        let text = workshop.good(&[arguments, &["--json"]].concat());
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{arguments:?}: {error}: {text}"))
    };
    let state = ["--state", "{\"theta\": 0.5}"];
    let checked = json(&["check", "pendulum.mbs"]);
    assert_eq!((&checked["mechanism"], &checked["degrees_of_freedom"]), (&"Pendulum".into(), &1.into()));
    assert_eq!(checked["parameters"], serde_json::json!(["m", "l", "g", "b"]));
    assert_eq!(json(&["derive", "pendulum.mbs"])["emit"], "rust");
    assert!(json(&["derive", "pendulum.mbs", "--emit", "json"]).get("functions").is_some());
    assert_eq!(json(&["derive", "pendulum.mbs", "--out", "p.rs"])["written"], serde_json::json!(["p.rs"]));
    assert!(json(&["ops", "pendulum.mbs"])["functions"]["mass_matrix"].is_object());
    assert!(json(&["eval", "pendulum.mbs", state[0], state[1]])["mass_matrix"].is_array());
    assert!(json(&["linearize", "pendulum.mbs", state[0], state[1]]).is_object());
    let motion = json(&["simulate", "pendulum.mbs", state[0], state[1], "--t-end", "1", "--dt", "0.5"]);
    assert_eq!(motion["columns"], serde_json::json!(["t", "theta", "theta_dot", "energy"]));
    assert_eq!(motion["rows"].as_array().unwrap().len(), 3);
    let csv =
        json(&["simulate", "pendulum.mbs", state[0], state[1], "--t-end", "1", "--csv", "a.csv", "--plot", "a.svg"]);
    assert_eq!(csv["written"], serde_json::json!(["a.csv", "a.svg"]));
    assert_eq!(json(&["fmu", "pendulum.mbs", "--out", "p.fmu", "--sources-only"])["written"][0], "p.fmu");
    assert!(json(&["report", "pendulum.mbs"])["page"].as_str().unwrap().starts_with("<!doctype html>"));
    assert_eq!(json(&["report", "pendulum.mbs", "--out", "p.html"])["written"], serde_json::json!(["p.html"]));
    let body = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
    let joint = "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>";
    workshop.write("r.urdf", format!("<robot name='r'><link name='a'/><link name='b'>{body}</link>{joint}</robot>"));
    assert!(json(&["import", "r.urdf"])["text"].as_str().unwrap().contains("mechanism R {"));
    assert_eq!(json(&["import", "r.urdf", "--out", "r.mbs"])["written"], serde_json::json!(["r.mbs"]));
    workshop.write("untidy.mbs", crate::PENDULUM.replace("    ", "\t"));
    assert_eq!(json(&["fmt", "untidy.mbs", "r.mbs"])["written"], serde_json::json!(["untidy.mbs"]));
    workshop.write("swings.toml", SWINGS);
    crate::new::checkout(&workshop, ".");
    let swept = json(&["sweep", "swings.toml"]);
    assert_eq!((&swept["members"], &swept["written"]), (&3.into(), &serde_json::json!(["swings.csv"])));
    assert_eq!(json(&["plot", "swings.csv", "--out", "a.png"])["written"], serde_json::json!(["a.png"]));
    assert_eq!(json(&["new", "swing"])["template"], "pendulum");
    assert!(json(&["explain"]).as_array().unwrap().len() > 100);
    assert_eq!(json(&["completions", "fish"])["shell"], "fish");
    assert!(json(&["man"])["page"].is_string());
    assert_eq!(json(&["watch", "pendulum.mbs", "--once"])["mechanism"], "Pendulum");

    workshop.write("bad.mbs", crate::PENDULUM.replace("m * g * l * (1", "m * grav * l * (1"));
    let report = workshop.bad(&["--json", "check", "bad.mbs"]);
    let message: Value = serde_json::from_str(report.trim_end()).unwrap();
    let place = ["severity", "code", "file", "line", "column", "length"].map(|key| message[key].clone());
    let expected = ["error".into(), "MBS0501".into(), "bad.mbs".into(), 10.into(), 22.into(), 4.into()];
    assert_eq!(place, expected as [Value; 6], "{report}");
    let report = workshop.bad(&["--json", "check", "missing.mbs"]);
    let message: Value = serde_json::from_str(&report).unwrap();
    assert!(message["message"].as_str().unwrap().starts_with("cannot read missing.mbs"), "{report}");
    workshop.write("latin1.mbs", b"mechanism Caf\xe9 {}\n");
    let report = workshop.bad(&["--json", "check", "latin1.mbs"]);
    let message: Value = serde_json::from_str(&report).unwrap();
    let place = ["code", "file", "line", "column", "help"].map(|key| message[key].clone());
    let help = "save the file as UTF-8; this byte was probably meant as `é`";
    assert_eq!(place, ["MBS0101".into(), "latin1.mbs".into(), 1.into(), 14.into(), help.into()] as [Value; 5]);
    // Warnings too, whether derived now or kept.
    workshop.write("odd.mbs", crate::PENDULUM.replace("kinetic", "output size = abs(theta);\n    kinetic"));
    let warned = workshop.mbs(&["check", "odd.mbs", "--json"]);
    let warning: Value = serde_json::from_str(&warned.stderr).unwrap();
    assert_eq!((warned.code, &warning["severity"], &warning["code"]), (0, &"warning".into(), &"MBS0820".into()));
}

/// Pipes see no colours, whoever forces them does, and NO_COLOR is stronger.
#[test]
fn colours_are_for_terminals() {
    let workshop = Workshop::new();
    workshop.write("bad.mbs", crate::PENDULUM.replace("m * g * l * (1", "m * grav * l * (1"));
    let run = |variables: &[(&str, &str)]| {
        let mut command = command(workshop.0.path(), &["check", "bad.mbs"]);
        for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
            command.env_remove(name);
        }
        Outcome::of(command.envs(variables.iter().copied()).output().unwrap()).stderr
    };
    let plain = run(&[]);
    assert!(plain.starts_with("error[MBS0501]: ") && !plain.contains('\u{1b}'), "{plain}");
    let coloured = run(&[("CLICOLOR_FORCE", "1")]);
    assert!(coloured.starts_with("\u{1b}[1;31merror[MBS0501]\u{1b}[0m: "), "{coloured:?}");
    let mut uncoloured = coloured.clone();
    for code in ["\u{1b}[1;31m", "\u{1b}[34m", "\u{1b}[0m"] {
        uncoloured = uncoloured.replace(code, "");
    }
    assert_eq!(uncoloured, plain);
    assert_eq!(run(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]), plain);
    assert!(!run(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")]).contains('\u{1b}'));
}

/// 0 fine, 1 the model or the input is bad, 2 wrong usage, for commands that do not read a mechanism, too.
#[test]
fn exit_codes_are_those_of_the_help() {
    let workshop = Workshop::new();
    let check = |code: i32, arguments: &[&str]| assert_eq!(workshop.mbs(arguments).code, code, "{arguments:?}");
    check(0, &["check", "pendulum.mbs"]);
    check(0, &["explain", "101"]);
    check(1, &["check", "missing.mbs"]);
    check(1, &["explain", "9999"]);
    check(1, &["new", "pendulum.mbs"]);
    check(1, &["watch", "missing.mbs", "--once"]);
    check(2, &["check"]);
    check(2, &["new"]);
    check(2, &["new", "robot", "--template", "boat"]);
    check(2, &["completions"]);
    check(2, &["watch", "pendulum.mbs", "--every", "0"]);
}
