//! The program `mbs` as outside programs call it: what it prints, what it writes, how it ends.

mod book;
mod cache;
mod check;
mod compiled;
mod constrained;
mod derive;
mod eval;
mod files;
mod fmu;
mod format;
mod graph;
mod help;
mod import;
mod linearize;
#[cfg(feature = "lsp")]
mod lsp;
mod motion;
mod new;
mod ops;
mod page;
mod parameters;
mod report;
mod robot;
mod simulate;
mod start;
mod summary;
mod sweep;
mod watch;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// `M = m l²`, `G = m g l sin θ`, `∂D/∂θ̇ = b θ̇`, `Q = tau`.
const PENDULUM: &str = "\
/// A bob on a massless rod.
mechanism Pendulum {
    param m: kg = 3;
    param l: m = 2;
    param g: m/s^2 = 10;
    param b: N*m*s/rad = 0.25;
    coord theta: rad;
    input tau: N*m;
    kinetic += 1/2 * m * (l * dt(theta))^2;
    potential += m * g * l * (1 - cos(theta));
    dissipation += 1/2 * b * dt(theta)^2;
    force theta += tau;
    output height = l * (1 - cos(theta));
}
";

/// Two masses between springs, as arrays: no inputs, no dissipation, outputs of several shapes.
const CHAIN: &str = "\
mechanism Chain {
    param m[2]: kg = [1, 2];
    param k: N/m = 5;
    const reach: m = 1;
    coord x[2]: m;
    for i in 0..2 {
        kinetic += 1/2 * m[i] * dt(x[i])^2;
    }
    potential += 1/2 * k * (x[1] - x[0])^2;
    output middle = [(x[0] + x[1]) / 2, 0, reach];
    output hand = world * dh(pi / 2, x[0], reach, 0);
}
";

/// A directory of its own for each test, with the mechanisms in it.
struct Workshop(tempfile::TempDir);

/// How a run ended.
#[derive(Debug, PartialEq)]
struct Outcome {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Outcome {
    fn of(output: Output) -> Self {
        Outcome {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Workshop {
    fn new() -> Self {
        let workshop = Workshop(tempfile::tempdir().unwrap());
        workshop.write("pendulum.mbs", PENDULUM);
        workshop.write("chain.mbs", CHAIN);
        workshop
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// The names of the files in it, hidden ones too, sorted.
    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs `mbs` here.
    fn mbs(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(command(self.0.path(), arguments).stdin(Stdio::null()).output().unwrap())
    }

    /// Runs `mbs`, which must end with 0 and no complaint, and returns what it printed.
    fn good(&self, arguments: &[&str]) -> String {
        let Outcome { code, stdout, stderr } = self.mbs(arguments);
        assert_eq!((code, stderr.as_str()), (0, ""), "{arguments:?}");
        stdout
    }

    /// Runs `mbs`, which must end with 1, print nothing and write nothing, and returns its complaint.
    fn bad(&self, arguments: &[&str]) -> String {
        self.failed(1, arguments)
    }

    /// Runs what is wrong usage, with exit code 2.
    fn misused(&self, arguments: &[&str]) -> String {
        self.failed(2, arguments)
    }

    /// Simulates what stops before its end, into `motion.csv`: what standard error says.
    fn stopped(&self, arguments: &[&str]) -> String {
        let Outcome { code, stdout, stderr } = self.mbs(&[arguments, &["--csv", "motion.csv"]].concat());
        assert_eq!((code, stdout.as_str()), (1, ""), "{arguments:?}: {stderr}");
        let (reason, table) = (stderr.lines().last().unwrap(), self.read("motion.csv"));
        let last = table.lines().last().unwrap();
        assert_eq!(last.strip_prefix("# stopped: "), reason.strip_prefix("error: "));
        stderr
    }

    fn failed(&self, expected: i32, arguments: &[&str]) -> String {
        let before = self.files();
        let Outcome { code, stdout, stderr } = self.mbs(arguments);
        assert_eq!((code, stdout.as_str()), (expected, ""), "{arguments:?}: {stderr}");
        assert_eq!(self.files(), before);
        assert!(!stderr.contains("panicked"), "{stderr}");
        stderr
    }

    /// Runs `mbs eval`.
    fn eval(&self, model: &str, state: &str) -> Value {
        serde_json::from_str(&self.good(&["eval", model, "--state", state])).unwrap()
    }
}

fn command(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mbs"));
    // No test sees what another one, or the user, has derived.
    command.current_dir(directory).args(arguments).env("MBS_CACHE_DIR", "");
    command
}

/// The keys of a JSON object, in order.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn wrong_usage_ends_with_2() {
    let workshop = Workshop::new();
    let usages: [&[&str]; 11] = [
        &[],
        &["fly"],
        &["check"],
        &["check", "pendulum.mbs", "chain.mbs"],
        &["eval", "pendulum.mbs"],
        &["derive", "pendulum.mbs", "--emit", "fortran"],
        &["simulate", "pendulum.mbs", "--t-end", "1"],
        &["simulate", "pendulum.mbs", "--state", "{\"q\": [0]}", "--t-end", "soon"],
        &["simulate", "pendulum.mbs", "--state", "{\"q\": [0]}", "--t-end", "1", "--rtol", "-1"],
        &["simulate", "pendulum.mbs", "--state", "{\"q\": [0]}", "--t-end", "1", "--dt", "NaN"],
        &["simulate", "pendulum.mbs", "--state", "{\"q\": [0]}", "--t-end", "1", "--plot", "motion.gif"],
    ];
    for usage in usages {
        let Outcome { code, stdout, stderr } = workshop.mbs(usage);
        assert_eq!((code, stdout.as_str()), (2, ""), "{usage:?}");
        assert!(stderr.contains("mbs") || stderr.contains("--"), "{stderr}");
    }
    assert!(workshop.good(&["--help"]).contains("simulate"));
    assert!(workshop.good(&["--version"]).starts_with("mbs "));
}

#[test]
fn unreadable_mechanisms_end_with_1() {
    let workshop = Workshop::new();
    workshop.write("latin1.mbs", b"mechanism Caf\xe9 {}\n");
    std::fs::create_dir(workshop.path("folder.mbs")).unwrap();
    for command in ["check", "derive", "ops"] {
        assert!(workshop.bad(&[command, "missing.mbs"]).starts_with("error: cannot read missing.mbs: "));
        assert!(workshop.bad(&[command, "folder.mbs"]).starts_with("error: cannot read folder.mbs: "));
        let report = workshop.bad(&[command, "latin1.mbs"]);
        assert!(report.starts_with("error[MBS0101]: this is not UTF-8 text\n --> latin1.mbs:1:14\n"), "{report}");
        assert!(report.ends_with("this byte was probably meant as `é`\n"), "{report}");
        assert!(!workshop.bad(&[command, "/dev/null"]).is_empty());
    }
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let workshop = Workshop::new();
    // Far more than a pipe holds.
    let arguments = ["simulate", "pendulum.mbs", "--state", "{\"q\": [1]}", "--t-end", "1", "--dt", "1e-5"];
    let mut child =
        command(workshop.0.path(), &arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), [].as_slice()));
}
