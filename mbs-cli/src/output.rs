//! Where results go: standard output, or files that are either whole or not there.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::files;

/// Writes a report to standard error; there is nobody to tell if that fails.
pub(crate) fn report(text: &str) {
    let _ = io::stderr().write_all(text.as_bytes());
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

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    Failure::new(format_args!("cannot write {}: {error}", path.display()))
}
