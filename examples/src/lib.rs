//! What the examples share: their arguments, and the files they write.

pub mod arguments;
pub mod output;

/// What ends an example early.
pub type Failure = Box<dyn std::error::Error>;
