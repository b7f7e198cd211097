//! Tries the mutants of `tests/mutants/*.txt`, each in a copy of the repository, and reports those that no test notices.
//!
//! ```text
//! cargo run -p mbs-tests --bin mutants -- [runtime] [generator] [--only WORDS]… [--skip N] [--take N]
//! ```
//!
//! The copy holds the files that git knows, as they are in the working tree; its target folder is `target/mutants` and stays for
//! the next time. A mutant is noticed where its test fails, or takes ten times as long as without it, and at least a minute. One
//! that does not compile is a mistake of the table. Exit code 1 where one survives.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};

use mbs_tests::mutants::{Mutant, parse};

fn main() -> ExitCode {
    let found = arguments().and_then(|mutants| {
        let copy = Copy::new()?;
        run(&copy, &mutants)
    });
    match found {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// The mutants asked for.
fn arguments() -> Result<Vec<Mutant>, String> {
    let (mut tables, mut only, mut skip, mut take) = (Vec::new(), Vec::new(), 0, usize::MAX);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut next = || words.next().ok_or(format!("`{word}` needs something behind it"));
        let number = |text: String| text.parse().map_err(|_| format!("`{text}` is not a number of mutants"));
        match word.as_str() {
            "runtime" => tables.push(include_str!("../../mutants/runtime.txt")),
            "generator" => tables.push(include_str!("../../mutants/generator.txt")),
            "--only" => only.push(next()?),
            "--skip" => skip = number(next()?)?,
            "--take" => take = number(next()?)?,
            _ => {
                return Err(format!(
                    "what is `{word}`? Usage: mutants [runtime] [generator] [--only WORDS]… [--skip N] [--take N]"
                ));
            }
        }
    }
    if tables.is_empty() {
        tables = vec![include_str!("../../mutants/runtime.txt"), include_str!("../../mutants/generator.txt")];
    }
    let all: Result<Vec<_>, _> = tables.into_iter().map(parse).collect();
    // Those whose names hold any of the words.
    let is_meant = |mutant: &Mutant| only.is_empty() || only.iter().any(|words| mutant.name.contains(words));
    Ok(all?.into_iter().flatten().filter(is_meant).skip(skip).take(take).collect())
}

/// Tries them; how many are not noticed or cannot be made.
fn run(copy: &Copy, mutants: &[Mutant]) -> Result<usize, String> {
    // How long the tests take as they are; they must pass.
    let mut usual = BTreeMap::new();
    for mutant in mutants {
        if !usual.contains_key(&mutant.test) {
            let begin = Instant::now();
            if copy.test(&mutant.test, Duration::from_secs(3600))? != Outcome::Passed {
                return Err(format!("`cargo test {}` fails without any mutant", mutant.test.join(" ")));
            }
            usual.insert(&mutant.test, begin.elapsed());
        }
    }
    let begin = Instant::now();
    let mut left = Vec::new();
    for (index, mutant) in mutants.iter().enumerate() {
        let outcome =
            copy.with(mutant, || copy.test(&mutant.test, (10 * usual[&mutant.test]).max(Duration::from_secs(60))))?;
        println!(
            "{:3} of {}  {:6.1} s  {outcome:<22} {}",
            index + 1,
            mutants.len(),
            begin.elapsed().as_secs_f64(),
            mutant.name
        );
        if matches!(outcome, Outcome::Passed | Outcome::NotCompiled) {
            left.push((outcome, mutant));
        }
    }
    println!(
        "{} of {} mutants noticed in {:.0} s",
        mutants.len() - left.len(),
        mutants.len(),
        begin.elapsed().as_secs_f64()
    );
    for (outcome, mutant) in &left {
        println!("{outcome}: {}\n  {}\n  - {}\n  + {}", mutant.name, mutant.file, mutant.original, mutant.replacement);
    }
    Ok(left.len())
}

/// What a test says of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Failed,
    TookTooLong,
    NotCompiled,
    Passed,
}

impl std::fmt::Display for Outcome {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Failed => "noticed",
            Self::TookTooLong => "noticed by its time",
            Self::NotCompiled => "DOES NOT COMPILE",
            Self::Passed => "SURVIVES",
        })
    }
}

/// A copy of the repository, removed at the end.
struct Copy {
    folder: tempfile::TempDir,
    target: PathBuf,
}

impl Copy {
    fn new() -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the crate has no parent folder")?;
        let said = |error: std::io::Error| error.to_string();
        let folder = tempfile::tempdir().map_err(said)?;
        let known = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
        let listed = Command::new("git").args(known).current_dir(root).output().map_err(said)?;
        for file in listed.stdout.split(|&byte| byte == 0).filter(|name| !name.is_empty()) {
            let file = std::str::from_utf8(file).map_err(|error| error.to_string())?;
            // What was removed and not yet committed is listed all the same.
            if !root.join(file).is_file() {
                continue;
            }
            let to = folder.path().join(file);
            std::fs::create_dir_all(to.parent().ok_or("a file without a folder")?).map_err(said)?;
            std::fs::copy(root.join(file), to).map_err(said)?;
        }
        Ok(Self { folder, target: root.join("target").join("mutants") })
    }

    /// Does something while the mutant is in place.
    fn with<T>(&self, mutant: &Mutant, act: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
        let file = self.folder.path().join(&mutant.file);
        let source = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", mutant.file))?;
        let write = |text: &str| std::fs::write(&file, text).map_err(|error| format!("{}: {error}", mutant.file));
        write(&mutant.apply(&source)?)?;
        let done = act();
        write(&source)?;
        done
    }

    fn test(&self, arguments: &[String], limit: Duration) -> Result<Outcome, String> {
        if !self.cargo(arguments, &["--no-run"])?.wait().map_err(|error| error.to_string())?.success() {
            return Ok(Outcome::NotCompiled);
        }
        let mut run = self.cargo(arguments, &[])?;
        let begin = Instant::now();
        loop {
            match run.try_wait().map_err(|error| error.to_string())? {
                Some(status) if status.success() => return Ok(Outcome::Passed),
                Some(_) => return Ok(Outcome::Failed),
                None if begin.elapsed() > limit => break,
                None => std::thread::sleep(Duration::from_millis(20)),
            }
        }
        // The test itself is a child of cargo, which its end does not stop.
        let _ = Command::new("kill").args(["--", &format!("-{}", run.id())]).status();
        let _ = (run.kill(), run.wait());
        Ok(Outcome::TookTooLong)
    }

    fn cargo(&self, arguments: &[String], more: &[&str]) -> Result<std::process::Child, String> {
        let mut command = Command::new(env!("CARGO"));
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        // Options of cargo stand before `--`.
        let end = arguments.iter().position(|word| word == "--").unwrap_or(arguments.len());
        command
            .args(["test", "--quiet"])
            .args(&arguments[..end])
            .args(more)
            .args(&arguments[end..])
            .env("CARGO_TARGET_DIR", &self.target)
            .env("RUST_BACKTRACE", "0")
            .env("INSTA_UPDATE", "no")
            .current_dir(self.folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command.spawn().map_err(|error| error.to_string())
    }
}
