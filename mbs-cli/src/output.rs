//! Where results go: standard output, or files that are either whole or not there; and what standard error says.

use std::fmt::Display;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use mbs_chart::Format;
use mbs_derive::diagnostic::Severity;
use serde_json::Value;
use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::files;
use crate::message::Messages;

/// Whether the option `--json` was given. It is about everything that is written, so it is known everywhere.
static JSON: AtomicBool = AtomicBool::new(false);

/// From now on results and messages are JSON.
pub(crate) fn speak_json() {
    JSON.store(true, Ordering::Relaxed);
}

/// Whether results are JSON.
pub(crate) fn is_json() -> bool {
    JSON.load(Ordering::Relaxed)
}

/// Writes messages to standard error; there is nobody to tell if that fails. As JSON, an object a line; else with
/// colours, if it is a terminal and `NO_COLOR` is not set.
pub(crate) fn report(messages: &Messages) {
    let _ = if is_json() {
        let lines: String = messages.json().iter().map(|message| format!("{message}\n")).collect();
        io::stderr().write_all(lines.as_bytes())
    } else {
        anstream::stderr().write_all(painted(messages.text()).as_bytes())
    };
}

/// Warns of something that has no place in a text.
pub(crate) fn warn(message: impl Display) {
    report(&Messages::plain(Severity::Warning, message));
}

/// Errors red, warnings yellow, notes and places blue; terminals without colours are not shown the codes.
fn painted(report: &str) -> String {
    const PLAIN: &str = "\u{1b}[0m";
    let mut colour = "\u{1b}[1;31m";
    let mut line = |line: &str| {
        let word: String = line.chars().take_while(char::is_ascii_lowercase).collect();
        let title = line[word.len()..].find(": ").map(|end| word.len() + end);
        match (word.as_str(), title) {
            ("error" | "warning" | "note", Some(end)) => {
                colour = match word.as_str() {
                    "error" => "\u{1b}[1;31m",
                    "warning" => "\u{1b}[1;33m",
                    _ => "\u{1b}[1;34m",
                };
                format!("{colour}{}{PLAIN}{}", &line[..end], &line[end..])
            }
            _ if line.trim_start().starts_with("--> ") => format!("\u{1b}[34m{}{PLAIN}", line.trim_end()) + "\n",
            _ => match line.split_once(" | ") {
                Some((gutter, marks)) if marks.trim().chars().all(|c| c == '^') && !marks.trim().is_empty() => {
                    format!("{gutter} | {colour}{}{PLAIN}\n", marks.trim_end())
                }
                _ => line.to_string(),
            },
        }
    };
    report.split_inclusive('\n').map(&mut line).collect()
}

/// Prints a result: as JSON if that was asked for, else as text.
pub(crate) fn answer(object: impl FnOnce() -> Value, text: impl FnOnce() -> String) -> Result<(), Failure> {
    print(&if is_json() { json(&object()) } else { text() })
}

/// Tells which files were written, if JSON was asked for; people see them.
pub(crate) fn wrote(paths: &[&Path]) -> Result<(), Failure> {
    wrote_until(paths, None)
}

/// Tells which files were written, and why not all is in them that was asked for.
pub(crate) fn wrote_until(paths: &[&Path], stopped: Option<&str>) -> Result<(), Failure> {
    let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    let mut object = serde_json::json!({ "written": names });
    if let Some(reason) = stopped {
        object["stopped"] = reason.into();
    }
    if is_json() { print(&json(&object)) } else { Ok(()) }
}

/// Writes a result to standard output. A reader that has seen enough (`mbs … | head`) is no error.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    unless_unread(written).map_err(|error| Failure::new(format_args!("cannot write to standard output: {error}")))
}

fn unless_unread(written: io::Result<()>) -> io::Result<()> {
    written.or_else(|error| if error.kind() == ErrorKind::BrokenPipe { Ok(()) } else { Err(error) })
}

/// JSON for people and programs: indented, except what holds no further object or list, which stays on its line.
///
/// Numbers have as many digits as it takes to read the same number; infinity and NaN are `null`.
pub(crate) fn json(value: &Value) -> String {
    let mut text = String::new();
    push_json(value, 0, &mut text);
    text + "\n"
}

fn push_json(value: &Value, depth: usize, text: &mut String) {
    let is_flat = |value: &Value| !value.is_object() && !value.is_array();
    let (open, items, close): (_, Vec<(String, &Value)>, _) = match value {
        Value::Array(items) if !items.iter().all(is_flat) => {
            ('[', items.iter().map(|item| (String::new(), item)).collect(), ']')
        }
        Value::Object(items) if !items.values().all(is_flat) => {
            ('{', items.iter().map(|(key, item)| (format!("{}: ", Value::from(key.as_str())), item)).collect(), '}')
        }
        _ => {
            *text += &value.to_string();
            return;
        }
    };
    text.push(open);
    for (i, (key, item)) in items.into_iter().enumerate() {
        *text += if i == 0 { "\n" } else { ",\n" };
        *text += &format!("{}{key}", "  ".repeat(depth + 1));
        push_json(item, depth + 1, text);
    }
    *text += &format!("\n{}{close}", "  ".repeat(depth));
}

/// Writes one file whole, or not at all.
pub(crate) fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    Staged::new(path, content)?.commit()
}

/// A file that is written, but does not bear its name yet: [`commit`](Staged::commit) gives it the name.
#[derive(Debug)]
pub(crate) struct Staged {
    /// As the user wrote it.
    path: PathBuf,
    content: Content,
}

#[derive(Debug)]
enum Content {
    /// A sibling of the file to be; dropped before it is renamed, it is removed.
    Sibling { file: NamedTempFile, target: PathBuf },
    /// What is there is not a regular file (`/dev/stdout`, a pipe) and cannot be replaced; it gets the bytes.
    Bytes(Vec<u8>),
}

impl Content {
    fn beside(target: PathBuf, content: &[u8], permissions: Option<fs::Permissions>) -> io::Result<Self> {
        let folder = target.parent().ok_or(ErrorKind::InvalidFilename)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".mbs-").suffix(".tmp");
        // As any new file, under the user's mask; temporary files are closed to others by default.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        let mut file = builder.tempfile_in(folder)?;
        file.write_all(content)?;
        if let Some(permissions) = permissions {
            file.as_file().set_permissions(permissions)?;
        }
        Ok(Content::Sibling { file, target })
    }
}

impl Staged {
    /// Writes `content` to a temporary sibling of `path`.
    pub(crate) fn new(path: &Path, content: &[u8]) -> Result<Self, Failure> {
        Self::try_new(path, content).map_err(|error| cannot_write(path, &error))
    }

    fn try_new(path: &Path, content: &[u8]) -> io::Result<Self> {
        let content = match fs::metadata(path) {
            Ok(there) if there.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(there) if !there.is_file() => Content::Bytes(content.to_vec()),
            Ok(there) if there.permissions().readonly() => return Err(ErrorKind::PermissionDenied.into()),
            // A symbolic link keeps pointing where it does.
            Ok(there) => Content::beside(path.canonicalize()?, content, Some(there.permissions()))?,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Content::beside(files::destination(path)?, content, None)?
            }
            Err(error) => return Err(error),
        };
        Ok(Staged { path: path.to_path_buf(), content })
    }

    /// Puts the file in place.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        let done = match self.content {
            Content::Sibling { file, target } => file.persist(target).map(drop).map_err(|error| error.error),
            Content::Bytes(bytes) => match fs::OpenOptions::new().write(true).open(&self.path) {
                Ok(mut file) => unless_unread(file.write_all(&bytes)),
                Err(error) => Err(error),
            },
        };
        done.map_err(|error| cannot_write(&self.path, &error))
    }
}

/// The path of a figure, whose ending says what it is.
pub(crate) fn figure_path(text: &str) -> Result<(PathBuf, Format), String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("svg") => Ok((path, Format::Svg)),
        Some("png") => Ok((path, Format::Png)),
        _ => Err("a figure ends in .svg or .png".to_string()),
    }
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format_args!("cannot write {}: {error}", path.display()))
}
