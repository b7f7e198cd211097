//! The program's reader of state files, compiled once more: a program is no library.

#[path = "../../../mbs-cli/src/state/reading.rs"]
pub(super) mod reading;
#[allow(dead_code)] // states need a part of it
#[path = "../../../mbs-cli/src/words.rs"]
mod words;
