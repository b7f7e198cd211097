//! The files of a command: none is both read and written, none is written twice.
//!
//! Files are told apart by what they are, not by how they are spelled: a link, a hard link, `./m.mbs` and
//! `sub/../m.mbs` are the file that they lead to.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use same_file::Handle;

use crate::failure::Failure;

/// What a command has read and is to write. Outputs are checked before work starts.
#[derive(Default)]
pub(crate) struct Files {
    known: Vec<Known>,
}

struct Known {
    identity: Identity,
    /// As the subject of a sentence: `the mechanism m.mbs was read`, `--csv names it, too`.
    clause: String,
}

impl Files {
    /// Notes a file that was read, or would have been, if it were there.
    pub(crate) fn reads(&mut self, what: &str, path: &Path) {
        if let Ok(identity) = Identity::of(path) {
            self.known.push(Known { identity, clause: format!("{what} {} was read", path.display()) });
        }
    }

    /// Notes that standard input was read.
    pub(crate) fn reads_standard_input(&mut self) {
        if let Ok(handle) = Handle::stdin() {
            self.known.push(Known { identity: Identity::There(handle), clause: "standard input was read".to_string() });
        }
    }

    /// Takes a file for an output.
    ///
    /// # Errors
    /// It is one that was read or is written by another option, it is a folder, or its folder is not there. `-` is
    /// standard input elsewhere: a file of this name is hardly meant.
    pub(crate) fn writes(&mut self, option: &str, path: &Path) -> Result<(), Failure> {
        if path == Path::new("-") {
            return Err(Failure::of_usage(format_args!(
                "{option} is the name of a file: where the command writes to standard output, it does without {option}; a \
                 file called `-` is `./-`"
            )));
        }
        let identity = Identity::of(path).map_err(|error| {
            let is_missing = error.kind() == ErrorKind::NotFound;
            let help = if is_missing { "; make the folder first, or name another" } else { "" };
            Failure::new(format_args!("cannot write {}: {error}{help}", path.display()))
        })?;
        if let Some(other) = self.known.iter().find(|known| known.identity == identity) {
            let name = path.display();
            return Err(Failure::new(format_args!("{option} {name} would overwrite a file in use: {}", other.clause)));
        }
        self.known.push(Known { identity, clause: format!("{option} {} is the same file", path.display()) });
        Ok(())
    }
}

/// What a path leads to.
#[derive(PartialEq, Eq)]
enum Identity {
    /// A file that is there.
    There(Handle),
    /// Where one is to be, or something that is not a regular file: the path without links.
    Place(PathBuf),
}

impl Identity {
    fn of(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
            // To open a pipe would wait for its other end.
            // Behind /dev/stdout may be one that has no path.
            Ok(there) if !there.is_file() => {
                Ok(Identity::Place(path.canonicalize().unwrap_or_else(|_| path.to_path_buf())))
            }
            Ok(_) => Handle::from_path(path).map(Identity::There).or_else(|_| path.canonicalize().map(Identity::Place)),
            Err(error) if error.kind() == ErrorKind::NotFound => destination(path).map(Identity::Place),
            Err(error) => Err(error),
        }
    }
}

/// Where a file will be that is not there yet: behind all links, in a folder that is there.
pub(crate) fn destination(path: &Path) -> io::Result<PathBuf> {
    const MOST_LINKS: usize = 40;
    let mut path = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?.to_os_string();
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = folder.canonicalize()?;
        match fs::read_link(folder.join(&name)) {
            Ok(target) => path = folder.join(target),
            Err(_) => return Ok(folder.join(name)),
        }
    }
    Err(io::Error::other("too many links"))
}
