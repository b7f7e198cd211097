//! Functions of a mechanism, compiled by the system's C compiler at run time and called.
//!
//! - [`Compilers`]: which ones are asked, by name or by the environment;
//! - [`Library`]: the generated C of a mechanism, compiled and loaded; [`Instance`]: the same with values of its
//!   parameters, which is called;
//! - [`arguments`]: what a function takes, in the order of the generated C;
//! - [`NotCompiled`], [`Misfit`]: why there is no library, and why a call is refused.
//!
//! Products and sums are not contracted, so that results are the bits of `mbs_derive::interpret`.

mod argument;
mod compiler;
mod error;
mod library;
mod source;

pub use argument::{Argument, Kind, arguments};
pub use compiler::Compilers;
pub use error::{Misfit, NotCompiled};
pub use library::{Instance, Library, MOST};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
