//! Derives a mechanism's equations of motion from its energies, proves them, and emits them as Rust.
//!
//! A mechanism is a file of energies in a small language; [`generate`] turns its text into a module of readable
//! `no_std` Rust. Build scripts call [`compile`] or [`Config`], which do the same for files:
//!
//! ```no_run
//! // build.rs
//! mbs_derive::compile("mechanisms/cart_pole.mbs");
//! ```
//!
//! and the crate includes the module with `mbs_runtime::include_mechanism!("cart_pole");`.
//!
//! The generator is a straight pipeline; each pass is a function from the former one's result to its own:
//!
//! ```text
//! text ──parse──▶ Declaration ──model──▶ Lagrangian ──derive──▶ Equations ──optimise──▶ Derivation (Programs)
//!      ──verify──▶ the Programs proved against the energies ──emit──▶ Rust
//!                                                           └─interpret──▶ numbers, in process
//! ```
//!
//! - [`expr`]: the calculus: a hash-consed expression graph with exact constants, and its derivatives;
//! - [`parse`], [`model`]: the language; [`builder`]: mechanisms written as Rust values, in place of a text;
//! - [`Analysis`]: what is derived from one mechanism, pass by pass; [`Generated`], [`Error`]: what comes of it;
//! - [`derive`](mod@derive): mechanics: Lagrange's equations, still symbolic;
//! - `catalogue`: every generated function, declared once ([`optimise::FunctionKind`]);
//! - [`optimise`]: straight-line programs and their operation counts;
//! - [`verify`]: the proof; [`interpret`]: Programs run in process; [`emit`]: Rust; `latex`: equations on paper;
//! - `proofread`: the emitted text read again and compared with the Programs;
//! - `span`, `state`, [`variable`], [`numeric`]: what several passes need, and no mechanics;
//! - [`diagnostic`]: what is wrong with a declaration, where, and what to write instead;
//! - [`source`]: the files of a mechanism: its own, and those that it imports;
//! - `import`: robots of other formats, as texts of the language (feature `import`);
//! - `scene`: what there is to see of a mechanism;
//! - `review`: a mechanism as people review it; `survey`: what an editor asks while a text is being written;
//! - `cargo`: build scripts, the only input and output.

mod analysis;
pub mod builder;
mod cargo;
mod catalogue;
pub mod derive;
pub mod diagnostic;
pub mod emit;
mod equations;
pub mod expr;
mod generated;
#[cfg(feature = "import")]
mod import;
pub mod interpret;
mod latex;
mod mistake;
pub mod model;
pub mod numeric;
pub mod optimise;
pub mod parse;
mod proofread;
mod review;
mod scene;
mod shape;
pub mod source;
mod span;
mod state;
mod survey;
pub mod variable;
pub mod verify;

pub use analysis::{Analysis, declared, derived, generate};
pub use cargo::{Config, Digest, Report, compile, read, review, try_compile};
pub use generated::{Error, Generated};
