//! Why an ensemble is not finished.

use std::io;
use std::path::{Path, PathBuf};

/// Why an ensemble is not finished; what is done of it stays.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// A file or a folder did not do what it should.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// With which file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The folder holds members of another ensemble.
    #[error("{} holds members of another run: {changed} since; remove it, or write to another file", folder.display())]
    Changed {
        /// The folder.
        folder: PathBuf,
        /// `the plan has changed`
        changed: String,
    },
    /// Another process appends to the same file.
    #[error("{} is being written by another process", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// The table is there already.
    #[error("{} is there already; remove it, or write to another file", path.display())]
    Exists {
        /// The table.
        path: PathBuf,
    },
    /// A file is no table, or not the one that is wanted.
    #[error("{}: {reason}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A rank that is not below the number of ranks.
    #[error("there is no rank {rank} of {ranks}: the first is 0")]
    Rank {
        /// Whose share it is.
        rank: u64,
        /// How many ranks there are.
        ranks: u64,
    },
    /// Members that nobody has done.
    #[error("members {first} to {last} are missing")]
    Missing {
        /// The first that is missing.
        first: u64,
        /// The last of those that follow it.
        last: u64,
    },
}

impl SweepError {
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        SweepError::Io { action, path: path.to_path_buf(), source }
    }

    pub(crate) fn table(path: &Path, reason: &str) -> Self {
        SweepError::Table { path: path.to_path_buf(), reason: reason.to_string() }
    }

    pub(crate) fn changed(folder: &Path, names: &[String]) -> Self {
        let verb = if names.len() == 1 { "has" } else { "have" };
        SweepError::Changed { folder: folder.to_path_buf(), changed: format!("{} {verb} changed", names.join(" and ")) }
    }
}
