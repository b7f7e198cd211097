//! What was derived once: the same answers, damaged, old or crowded as the cache may be.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Stdio};

use same_file::Handle;

use crate::{Outcome, PENDULUM, Workshop, command};

const STATE: &str = "{\"q\": [0.5], \"qd\": [1], \"u\": [2]}";

/// Every command that derives, on the pendulum.
const CALLS: [&[&str]; 7] = [
    &["check", "pendulum.mbs"],
    &["eval", "pendulum.mbs", "--state", STATE],
    &["simulate", "pendulum.mbs", "--state", STATE, "--t-end", "0.1", "--dt", "0.05"],
    &["linearize", "pendulum.mbs", "--state", STATE],
    &["derive", "pendulum.mbs"],
    &["derive", "pendulum.mbs", "--emit", "latex"],
    &["derive", "pendulum.mbs", "--emit", "json"],
];

/// A workshop whose calls share a cache beside it.
struct Cached {
    workshop: Workshop,
    folder: tempfile::TempDir,
}

impl Cached {
    fn new() -> Self {
        let cached = Cached { workshop: Workshop::new(), folder: tempfile::tempdir().unwrap() };
        // Warnings are printed again at each call.
        cached.workshop.write("pendulum.mbs", PENDULUM.replace("coord", "param unused: kg = 1;\n    coord"));
        cached
    }

    fn start(&self, arguments: &[&str]) -> Child {
        let mut command = command(self.workshop.0.path(), arguments);
        command.env("MBS_CACHE_DIR", self.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn mbs(&self, arguments: &[&str]) -> Outcome {
        Outcome::of(self.start(arguments).wait_with_output().unwrap())
    }

    /// The entries, and which file each is: one that is written anew is another file of the same name.
    fn entries(&self) -> Vec<(PathBuf, Handle)> {
        let paths = fs::read_dir(self.folder.path()).unwrap().map(|entry| entry.unwrap().path());
        let mut entries: Vec<_> = paths.map(|path| (path.clone(), Handle::from_path(path).unwrap())).collect();
        entries.sort_by(|(one, _), (other, _)| one.cmp(other));
        entries
    }
}

#[test]
fn a_second_call_says_the_same_and_derives_nothing() {
    let cached = Cached::new();
    for call in CALLS {
        let plain = cached.workshop.mbs(call);
        assert!(plain.code == 0 && plain.stderr.contains("warning[MBS"), "{plain:?}");
        assert_eq!(cached.mbs(call), plain, "{call:?}");
    }
    let entries = cached.entries();
    assert_eq!(entries.len(), 4, "the mechanism, and three kinds of code");
    for call in CALLS {
        assert_eq!(cached.mbs(call), cached.workshop.mbs(call), "{call:?}");
    }
    assert!(cached.entries() == entries, "an entry was written anew");
}

/// What is known of a mechanism is read as it was written: branches, reactions, constraints, systems that are solved,
/// signals.
#[test]
fn derivations_of_all_kinds_are_kept() {
    for name in ["moving_frame", "n_pendulum", "branches", "arm_with_reactions", "whipple_bicycle"] {
        let cached = Cached::new();
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/mechanisms").join(name).with_extension("mbs");
        let call = ["derive", file.to_str().unwrap(), "--emit", "json"];
        let first = cached.mbs(&call);
        assert_eq!(first.code, 0, "{first:?}");
        // The graph is then written from the entry of the mechanism.
        let holds_code = |path: &PathBuf| fs::read(path).unwrap().windows(12).any(|word| word == b"\"mechanism\":");
        let paths: Vec<PathBuf> = cached.entries().into_iter().map(|(path, _)| path).collect();
        paths.iter().filter(|path| holds_code(path)).for_each(|path| fs::remove_file(path).unwrap());
        let [mechanism] = <[_; 1]>::try_from(cached.entries()).expect("one of two is left");
        assert_eq!(cached.mbs(&call), first);
        assert!(cached.entries().contains(&mechanism), "{name} was derived again");
    }
}

#[test]
fn damaged_entries_are_derived_again() {
    let cached = Cached::new();
    let plain = cached.workshop.mbs(CALLS[1]);
    assert_eq!(cached.mbs(CALLS[1]), plain);
    let path = cached.entries()[0].0.clone();
    let whole = fs::read(&path).unwrap();
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    let damaged = [Vec::new(), whole[..whole.len() / 2].to_vec(), flipped(0), flipped(40), flipped(whole.len() - 1)];
    for bytes in damaged {
        fs::write(&path, &bytes).unwrap();
        assert_eq!(cached.mbs(CALLS[1]), plain);
        assert!(fs::read(&path).unwrap() == whole, "the entry was mended");
    }
}

#[test]
fn what_was_changed_is_derived_again() {
    let cached = Cached::new();
    let workshop = &cached.workshop;
    let speed = |value: &str| {
        let outcome =
            cached.mbs(&["eval", "rod.mbs", "--state", "{\"q\": [0], \"qd\": [2]}", "--only", "kinetic_energy"]);
        assert_eq!(outcome.stdout, format!("{{\"kinetic_energy\":{value}}}\n"));
    };
    workshop.write("steel.mbs", "const mass: kg = 3;");
    workshop.write("rod.mbs", "import \"steel.mbs\"; mechanism Rod { coord x: m; kinetic += 1/2*mass*dt(x)^2; }");
    speed("6.0");
    workshop.write("steel.mbs", "const mass: kg = 5;");
    speed("10.0");
    workshop.write("rod.mbs", "import \"steel.mbs\"; mechanism Rod { coord x: m; kinetic += mass*dt(x)^2; }");
    speed("20.0");
    workshop.write("steel.mbs", "const mass: kg = 3;");
    speed("12.0");
    assert_eq!(cached.entries().len(), 4);
    fs::remove_file(workshop.path("steel.mbs")).unwrap();
    let outcome = cached.mbs(&["check", "rod.mbs"]);
    assert!(outcome.code == 1 && outcome.stderr.contains("steel.mbs"), "{outcome:?}");
}

#[test]
fn without_the_cache_nothing_is_read_or_written() {
    let cached = Cached::new();
    let plain = cached.workshop.mbs(CALLS[0]);
    for call in [["check", "pendulum.mbs", "--no-cache"], ["--no-cache", "check", "pendulum.mbs"]] {
        assert_eq!(cached.mbs(&call), plain);
    }
    assert!(cached.entries().is_empty());
    cached.mbs(CALLS[0]);
    let path = cached.entries()[0].0.clone();
    fs::write(&path, "damaged").unwrap();
    assert_eq!(cached.mbs(&["check", "pendulum.mbs", "--no-cache"]), plain);
    assert_eq!(fs::read(&path).unwrap(), b"damaged");
}

/// Times are those of a derivation.
#[test]
fn operations_are_counted_on_what_is_derived_now() {
    let cached = Cached::new();
    cached.mbs(&["ops", "pendulum.mbs", "--json"]);
    assert!(cached.entries().is_empty());
    CALLS.iter().for_each(|call| drop(cached.mbs(call)));
    let report: serde_json::Value =
        serde_json::from_str(&cached.mbs(&["ops", "pendulum.mbs", "--json"]).stdout).unwrap();
    assert!(report["derive_seconds"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_mechanism_that_is_refused_is_not_kept() {
    let cached = Cached::new();
    cached.workshop.write("bad.mbs", PENDULUM.replace("kinetic", "potential"));
    let first = cached.mbs(&["check", "bad.mbs"]);
    assert_eq!((first.code, &cached.mbs(&["check", "bad.mbs"])), (1, &first));
    assert!(cached.entries().is_empty());
}

#[test]
fn a_cache_that_cannot_be_written_is_none() {
    let cached = Cached::new();
    let plain = cached.workshop.mbs(CALLS[0]);
    let file = cached.folder.path().join("a_file");
    fs::write(&file, "").unwrap();
    for folder in [file.clone(), file.join("in_it")] {
        let output = command(cached.workshop.0.path(), CALLS[0]).env("MBS_CACHE_DIR", folder).output().unwrap();
        assert_eq!(Outcome::of(output), plain);
    }
}

#[test]
fn calls_at_once_do_not_disturb_each_other() {
    let cached = Cached::new();
    let plain = CALLS.map(|call| cached.workshop.mbs(call));
    for _ in 0..3 {
        let running: Vec<Child> = [CALLS, CALLS].concat().iter().map(|call| cached.start(call)).collect();
        for (i, child) in running.into_iter().enumerate() {
            assert_eq!(Outcome::of(child.wait_with_output().unwrap()), plain[i % CALLS.len()]);
        }
    }
    assert_eq!(cached.entries().len(), 4, "nothing unfinished is left");
}

/// Entries are files that were read, too.
#[test]
fn no_output_takes_the_place_of_an_entry() {
    let cached = Cached::new();
    cached.mbs(CALLS[1]);
    let entry = cached.entries()[0].0.clone();
    let before = fs::read(&entry).unwrap();
    for option in [
        &["derive", "pendulum.mbs", "--out"][..],
        &["simulate", "pendulum.mbs", "--t-end", "1", "--state", STATE, "--csv"],
    ] {
        let outcome = cached.mbs(&[option, &[entry.to_str().unwrap()]].concat());
        assert!(outcome.code == 1 && outcome.stderr.contains("would overwrite a file in use"), "{outcome:?}");
    }
    assert!(fs::read(&entry).unwrap() == before);
}
