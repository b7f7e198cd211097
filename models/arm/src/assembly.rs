//! A SCARA that puts a peg into a chamfered hole: contact, compliance, and what it takes not to get stuck.
//!
//! - [`contact`]: peg and hole in the vertical plane of their errors, and the forces between them;
//! - [`cell`]: the generated dynamics of [`scara`](mbs_models::scara), the wrist that carries the peg, the control;
//! - [`insertion`]: a peg on its way from the feeder into the hole, and why it ends;
//! - [`whitney`]: quasi-static insertion in closed form, jamming and wedging.
//!
//! In the plane x is to the right and z is up; angles turn z towards x, so that what leans by `θ > 0` has its upper end
//! to the right.
//!
//! # Source
//! D. E. Whitney, *Quasi-static assembly of compliantly supported rigid parts*, Journal of Dynamic Systems,
//! Measurement, and Control 104:1, 1982; control: N. Hogan, *Impedance control: an approach to manipulation*, the same
//! journal, 107:1, 1985, part I.

pub mod cell;
pub mod contact;
pub mod insertion;
pub mod whitney;

pub use cell::{Cell, Impedance, Wanted, Wrist};
pub use contact::{Contact, Forces, Hole, Peg, PegMotion};
pub use insertion::{Insertion, Outcome, Sample, Task};
