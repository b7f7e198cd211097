//! `mbs watch`.

use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::Value;

use crate::{Outcome, Workshop, command};

/// A running `mbs watch`, whose lines come from both streams.
struct Watch(Child, Receiver<String>);

impl Watch {
    fn begin(workshop: &Workshop, file: &str) -> Self {
        let mut command = command(workshop.0.path(), &["watch", file, "--every", "20", "--json"]);
        let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let (sender, lines) = channel();
        let (stdout, stderr) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
        let to = sender.clone();
        std::thread::spawn(move || BufReader::new(stdout).lines().map_while(Result::ok).try_for_each(|l| to.send(l)));
        std::thread::spawn(move || {
            BufReader::new(stderr).lines().map_while(Result::ok).try_for_each(|l| sender.send(l))
        });
        Watch(child, lines)
    }

    fn next(&self) -> Value {
        let line = self.1.recv_timeout(Duration::from_secs(60)).expect("a line within a minute");
        serde_json::from_str(&line).unwrap_or_else(|error| panic!("{error}: {line}"))
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn changes_are_checked_those_of_imports_too() {
    let workshop = Workshop::new();
    workshop.write("own.mbs", format!("import \"gravity.mbs\";\n{}", crate::PENDULUM.replace("= 10;", "= standard;")));
    workshop.write("gravity.mbs", "const standard: m/s^2 = 10;\n");
    let watch = Watch::begin(&workshop, "own.mbs");
    assert_eq!(watch.next()["mechanism"], "Pendulum");
    // A mistake in the imported file, then its removal, then all is well again.
    workshop.write("gravity.mbs", "const standard: m/s = 10;\n");
    let message = watch.next();
    assert_eq!((&message["severity"], &message["code"]), (&"error".into(), &"MBS0412".into()), "{message}");
    std::fs::remove_file(workshop.path("gravity.mbs")).unwrap();
    assert_eq!(watch.next()["code"], "MBS0301");
    // Put in place of it, as editors do.
    workshop.write("new.mbs", "const standard: m/s^2 = 9.81;\n");
    std::fs::rename(workshop.path("new.mbs"), workshop.path("gravity.mbs")).unwrap();
    assert_eq!(watch.next()["mechanism"], "Pendulum");
    // The mechanism itself.
    workshop.write("own.mbs", crate::PENDULUM.replace("Pendulum", "Swing"));
    assert_eq!(watch.next()["mechanism"], "Swing");
    // Nothing changes, nothing is said.
    workshop.write("own.mbs", crate::PENDULUM.replace("Pendulum", "Swing"));
    assert!(watch.1.recv_timeout(Duration::from_millis(300)).is_err());
}

#[test]
fn once_is_a_check() {
    let workshop = Workshop::new();
    assert_eq!(workshop.good(&["watch", "pendulum.mbs", "--once"]), workshop.good(&["check", "pendulum.mbs"]));
    workshop.write("bad.mbs", crate::PENDULUM.replace("kinetic", "potential"));
    let Outcome { code, stderr, .. } = workshop.mbs(&["check", "bad.mbs"]);
    assert_eq!((code, workshop.bad(&["watch", "bad.mbs", "--once"])), (1, stderr));
}
