//! C compilers, and the libraries that they make of a text: kept in a folder under its digest.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs};

use mbs_derive::Digest;

use crate::error::NotCompiled;

/// Bits are those of the interpreter: products and sums are not contracted; `errno` is not set.
const FLAGS: [&str; 7] = ["-std=c99", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared", "-w"];

/// GCC's long functions wait for memory less where they are scheduled with an eye on registers: arm6 takes 190 ns in
/// place of 220. Clang does so by itself and refuses the words.
const OF_GCC: [&str; 2] = ["-fschedule-insns", "-fsched-pressure"];

/// The C compilers that are asked, in this order, until one compiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compilers {
    /// Each a program, and arguments before ours.
    commands: Vec<Vec<OsString>>,
}

impl Compilers {
    /// What `MBS_CC`, which may be empty for none, or `CC` names; else `cc`, `gcc` and `clang`.
    ///
    /// Behind blanks there may be arguments, as in `ccache gcc`, unless all of it is a file.
    pub fn of_environment() -> Self {
        let named = ["MBS_CC", "CC"].into_iter().find_map(env::var_os);
        Self::of(match named {
            None => ["cc", "gcc", "clang"].map(|name| vec![OsString::from(name)]).to_vec(),
            Some(name) => vec![Self::words(&name)],
        })
    }

    fn words(command: &OsStr) -> Vec<OsString> {
        match command.to_str() {
            Some(text) if !Path::new(text).is_file() => text.split_whitespace().map(OsString::from).collect(),
            _ => vec![command.to_os_string()],
        }
    }

    /// One compiler, by a path or a name that is looked for in the folders of `PATH`, and arguments behind blanks.
    pub fn named(name: impl AsRef<OsStr>) -> Self {
        Self::of(vec![Self::words(name.as_ref())])
    }

    fn of(commands: Vec<Vec<OsString>>) -> Self {
        Compilers { commands: commands.into_iter().filter(|command| !command.is_empty()).collect() }
    }

    /// The files of those that are there.
    pub fn found(&self) -> Vec<PathBuf> {
        self.ready().map(|(path, _)| path).collect()
    }

    /// All of them, with their arguments, whether they are there or not.
    pub fn names(&self) -> Vec<String> {
        let name = |command: &Vec<OsString>| command.join(OsStr::new(" ")).to_string_lossy().into_owned();
        self.commands.iter().map(name).collect()
    }

    /// Those that are there, each to be called with more arguments, in whichever folder.
    pub fn commands(&self) -> Vec<Command> {
        let command = |(path, arguments): (PathBuf, &[OsString])| {
            let mut command = Command::new(std::path::absolute(&path).unwrap_or(path));
            command.args(arguments);
            command
        };
        self.ready().map(command).collect()
    }

    /// Those that are there, with their arguments.
    fn ready(&self) -> impl Iterator<Item = (PathBuf, &[OsString])> {
        let path = env::var_os("PATH");
        let folders: Vec<PathBuf> = path.map(|path| env::split_paths(&path).collect()).unwrap_or_default();
        let found = move |name: &OsString| {
            let path = PathBuf::from(name);
            let in_folders = || folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file());
            if path.components().count() > 1 { Some(path).filter(|path| path.is_file()) } else { in_folders() }
        };
        self.commands.iter().filter_map(move |command| {
            let (name, arguments) = command.split_first()?;
            Some((found(name)?, arguments))
        })
    }

    /// The library of a text, by the first compiler that makes one, unless the folder has it already.
    pub(crate) fn made(&self, text: &str, folder: &Path) -> Result<PathBuf, NotCompiled> {
        let ready: Vec<_> = self.ready().collect();
        if ready.is_empty() {
            return Err(NotCompiled::NoCompiler { names: self.names() });
        }
        let folder = opened(folder).map_err(|error| NotCompiled::Folder { folder: folder.to_path_buf(), error })?;
        let mut reports = Vec::new();
        for (compiler, arguments) in ready {
            match made(text, &compiler, arguments, &folder) {
                Ok(library) => return Ok(library),
                Err(report) => reports.push(report),
            }
        }
        Err(NotCompiled::Failed { reports })
    }
}

/// For nobody else's eyes or hands where it is made: what is in it is run.
fn opened(folder: &Path) -> std::io::Result<PathBuf> {
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(folder)?;
    fs::canonicalize(folder)
}

/// The path of the library, compiled unless it is there.
fn made(text: &str, compiler: &Path, arguments: &[OsString], folder: &Path) -> Result<PathBuf, String> {
    static CALLS: AtomicUsize = AtomicUsize::new(0);
    let stamp = fs::metadata(compiler).and_then(|file| file.modified()).map(|time| format!("{time:?}"));
    let version = env!("CARGO_PKG_VERSION");
    let program = format!("{} {arguments:?} {:?} {FLAGS:?} {OF_GCC:?} {version}", compiler.display(), stamp.ok());
    let name = Digest::of([text.as_bytes(), program.as_bytes()]).to_string();
    let own = format!("{}-{}", std::process::id(), CALLS.fetch_add(1, Ordering::Relaxed));
    let library = folder.join(format!("{name}.so"));
    let code = folder.join(format!("{name}.c"));
    // Digests are not against forgery: the text is compared.
    if library.is_file() && fs::read_to_string(&code).is_ok_and(|kept| kept == text) {
        return Ok(library);
    }
    let [unfinished_code, unfinished] = ["c", "so"].map(|kind| folder.join(format!("{name}-{own}.{kind}")));
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    fs::write(&unfinished_code, text).map_err(wrong)?;
    let compiled = |more: &[&str]| {
        let mut command = Command::new(compiler);
        command
            .args(arguments)
            .args(FLAGS)
            .args(more)
            .arg(&unfinished_code)
            .arg("-o")
            .arg(&unfinished)
            .arg("-lm")
            .output()
    };
    let run = match compiled(&OF_GCC) {
        Ok(run) if !run.status.success() => compiled(&[]),
        run => run,
    };
    let run = run.map_err(|error| format!("{}: {error}", compiler.display()));
    let made = run.and_then(|run| match run.status.success() {
        true => fs::rename(&unfinished, &library).and_then(|()| fs::rename(&unfinished_code, &code)).map_err(wrong),
        false => Err(format!("{}: {}", compiler.display(), String::from_utf8_lossy(&run.stderr).trim_end())),
    });
    if made.is_err() {
        let _ = (fs::remove_file(&unfinished), fs::remove_file(&unfinished_code));
    }
    made.map(|()| library)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compilers_have_arguments_behind_blanks() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a compiler");
        std::fs::write(&file, "").unwrap();
        assert_eq!(Compilers::named("ccache  gcc -O1 ").commands, [["ccache", "gcc", "-O1"]]);
        assert_eq!(Compilers::named(&file).commands, [[file.as_os_str()]]);
        assert!(Compilers::named("").commands.is_empty());
    }
}
