//! The shared library of an FMU, by the system's C compiler.

use mbs_native::{Compilers, NotCompiled};

use super::Fmi;
use crate::failure::Failure;
use crate::output;

/// How the sources are compiled: the bits of the Rust code, nothing visible but the functions of FMI.
const OPTIONS: [&str; 6] = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-fvisibility=hidden"];

/// The folder for libraries of this machine, as the standard calls it, and how they end; none where the program has not
/// been tried.
fn platform(fmi: Fmi) -> Option<&'static str> {
    match (std::env::consts::OS, std::env::consts::ARCH, fmi) {
        ("linux", "x86_64", Fmi::Two) => Some("linux64"),
        ("linux", "x86_64", Fmi::Three) => Some("x86_64-linux"),
        ("linux", "aarch64", Fmi::Three) => Some("aarch64-linux"),
        _ => None,
    }
}

/// What a compiler that fails has said.
const LOG: &str = "compiler.log";

/// The first line of a compiler's messages that says what is wrong: before it come the files that include each other,
/// and warnings.
fn reason(report: &str) -> &str {
    let is_error = |line: &&str| line.to_lowercase().contains("error");
    report.lines().find(is_error).or_else(|| report.lines().next()).unwrap_or("without a message")
}

/// The library and its name in the archive; none where there is no compiler, or no name for this machine, which
/// standard error says.
///
/// # Errors
/// The compiler that was named is not there, or the compiler fails.
pub(super) fn compiled(
    compiler: Option<&str>,
    fmi: Fmi,
    sources: &[(String, String)],
    main: &str,
    identifier: &str,
) -> Result<Option<(String, Vec<u8>)>, Failure> {
    let without = |why: &str| {
        output::warn(format_args!("{why}; the FMU has sources only"));
        Ok(None)
    };
    let Some(platform) = platform(fmi) else {
        return without("libraries are compiled on Linux alone");
    };
    let cannot = |error: &dyn std::fmt::Display| Failure::new(format_args!("cannot compile the FMU: {error}"));
    let compilers = compiler.map_or_else(Compilers::of_environment, Compilers::named);
    let Some(mut command) = compilers.commands().into_iter().next() else {
        let missing = NotCompiled::NoCompiler { names: compilers.names() };
        return if compiler.is_some() { Err(cannot(&missing)) } else { without(&missing.to_string()) };
    };
    let folder = tempfile::Builder::new().prefix("mbs-fmu-").tempdir().map_err(|error| cannot(&error))?;
    for (name, text) in sources {
        std::fs::write(folder.path().join(name), text).map_err(|error| cannot(&error))?;
    }
    let library = format!("{identifier}.so");
    command.args(OPTIONS).args(["-o", &library, main, "-lm"]).current_dir(folder.path());
    let output = command.output().map_err(|error| cannot(&error))?;
    if !output.status.success() {
        let report = String::from_utf8_lossy(&[output.stderr, output.stdout].concat()).into_owned();
        let program = command.get_program().display();
        if report.trim().is_empty() || std::fs::write(folder.path().join(LOG), &report).is_err() {
            return Err(cannot(&format_args!("`{program}` fails: {}", reason(&report))));
        }
        // Kept with the sources, for whoever wants to try again.
        let log = folder.keep().join(LOG);
        return Err(cannot(&format_args!(
            "`{program}` fails: {}; all it says is in {}",
            reason(&report),
            log.display()
        )));
    }
    let bytes = std::fs::read(folder.path().join(&library)).map_err(|error| cannot(&error))?;
    Ok(Some((format!("binaries/{platform}/{library}"), bytes)))
}

#[cfg(test)]
mod tests {
    use super::reason;

    #[test]
    fn the_line_that_says_what_is_wrong_is_found() {
        let gcc = "In file included from fmi3.c:58:\nb.h:1:2: warning: odd\nb.h:3:5: error: the reason\n   3 | x\n";
        assert_eq!(reason(gcc), "b.h:3:5: error: the reason");
        assert_eq!(reason("cannot\nmore"), "cannot");
        assert_eq!(reason(""), "without a message");
    }
}
