//! Ensembles of motions: what varies from member to member, all members on all cores, and what they say together.
//!
//! A member is a function of the plan and of its index alone: its values depend neither on other members nor on
//! threads, their number or their order. So the table of an ensemble is the same bytes by whatever machines it was
//! made, and a run that was killed goes on from where it was.
//!
//! - [`plan`]: a text of TOML says what varies and how;
//! - [`design`]: from an index to a member's values;
//! - [`distribution`], [`sequence`]: quantiles of distributions, and points of the unit cube to ask for;
//! - [`sweep`]: members on all cores, or on several machines; [`journal`]: what is done of them; [`table`]: CSV,
//!   Parquet;
//! - [`statistics`]: what all members say together, and how sure that is;
//! - [`fault`]: what is wrong with a plan; [`error`]: why a run is not finished; [`vocabulary`]: the variables that a
//!   plan may speak of.

pub mod design;
pub mod distribution;
pub mod error;
pub mod fault;
pub mod journal;
pub mod plan;
pub mod sequence;
pub mod statistics;
pub mod sweep;
pub mod table;
pub mod vocabulary;

pub use design::{Design, Member};
pub use distribution::Distribution;
pub use error::SweepError;
pub use fault::{Fault, Faults};
pub use plan::Plan;
pub use sweep::{Motion, Share, Sweep};
pub use vocabulary::{Variables, Vocabulary};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
