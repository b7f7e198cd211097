//! The generator and the integrators for a page: text of a mechanism → proved equations → code, numbers, motion.
//!
//! - [`model`]: a mechanism read, derived and proved; what there is to say of it; its code;
//! - [`columns`]: what a motion is a table of;
//! - [`equations`]: its functions along a motion;
//! - [`motion`]: integration, with events;
//! - [`portable`]: arithmetic that gives the same bits on every machine;
//! - [`report`]: what is wrong, as JSON;
//! - `session`: what the page calls, and the only place that is not safe Rust by the compiler's own account.
//!
//! The binding is nine functions of plain C over two buffers, one of text and one of numbers: `mbs.js` is written by
//! hand around it. `wasm-bindgen` would add a crate, a program of the same version, and generated JavaScript, for the
//! same two kinds of things that pass: JSON and doubles.

pub mod columns;
pub mod equations;
pub mod model;
pub mod motion;
pub mod portable;
pub mod report;
#[cfg(target_arch = "wasm32")]
mod session;
