//! A second reading of the language, and random mechanisms to hold the generator against it.
//!
//! The referee was written from `docs/language.md` alone and shares no code with the generator: it carries out the
//! statements of a text at one state after the other, with dual numbers, and gets Lagrange's equations by
//! differentiating what comes out. It is slow and plain on purpose.
//!
//! - `token`, `syntax`: tokens and grammar; `unit`: units and dimensions; `mechanism`: what is declared;
//! - `wide`: numbers of twice the digits; `number`: doubles with roundings made worse, dual numbers;
//! - `value`, `builtin`, `table`, `evaluate`: values, functions and statements;
//! - `trace`: the calculation written down, and differentiated;
//! - `lagrange`, `solve`, `quantities`: from the statements to everything that a generated function returns;
//! - `manifold`: states at which constraints hold;
//! - [`mod@draw`]: random mechanisms;
//! - [`mod@judge`]: the generator against all that; `conserved`: first integrals; `gauge`: what unit quaternions leave
//!   open;
//! - [`mod@shrink`]: faults in small texts.

mod builtin;
mod conserved;
pub mod draw;
mod evaluate;
mod gauge;
pub mod judge;
mod lagrange;
mod manifold;
mod mechanism;
mod number;
mod quantities;
pub mod shrink;
mod solve;
mod syntax;
mod table;
mod token;
mod trace;
mod unit;
mod value;
mod wide;

pub use draw::{Construct, Drawn, draw, draw_piecewise};
pub use judge::{Fault, Judged, judge, proved};
pub use shrink::{shrink, shrink_unproved};
