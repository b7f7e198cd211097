//! Motions of generated mechanisms: against references, over long runs, under constraints, in frames that move.

mod conservation;
mod constrained_motion;
mod constrained_units;
mod constraints;
mod mechanisms;
mod moving_frames;
mod reactions;
mod whipple_bicycle;
