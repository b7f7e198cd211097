//! Pass 2: [`Declaration`](crate::parse::syntax::Declaration) → [`Lagrangian`]; a user's mistakes end here.
//!
//! - [`frame`]: the tree of frames, each with its pose and its twist;
//! - [`lagrangian`]: the result, and the builder API that stands under the language.

pub mod frame;
pub mod lagrangian;

pub use frame::{Edge, Frame, FrameId, Frames};
pub use lagrangian::{Body, Lagrangian, Output, OutputValue, Variable};
