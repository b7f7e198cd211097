//! What the tests of other languages share.
//!
//! - [`case`]: every mechanism of the repository, states, and what each function gives there;
//! - [`call`]: how functions are called from another language;
//! - [`depth`]: how much of it is run;
//! - [`tools`]: compilers and interpreters, two at a time;
//! - [`random`]: numbers without pattern, the same everywhere.

pub mod call;
pub mod case;
pub mod depth;
#[path = "../../src/random.rs"]
pub mod random;
pub mod tools;
