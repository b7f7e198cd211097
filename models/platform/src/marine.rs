//! A marine platform with four degrees of freedom in a sea and in gusts, under control: what surrounds the generated
//! dynamics of [`marine_platform`](mbs_models::marine_platform).
//!
//! | asked for                                              | here                                      |
//! |--------------------------------------------------------|-------------------------------------------|
//! | displacement, metacentric heights, natural periods      | [`hull`]: closed forms                    |
//! | a sea by its significant wave height and its peak period | [`spectrum`]: JONSWAP; [`sea`]: its waves |
//! | forces of the sea and of gusts                           | [`excitation`], [`wind`]                  |
//! | thrusters and who commands them                          | [`thrusters`], [`control`]                |
//! | the motion                                               | [`simulation`]                            |
//! | a deck that moves as was computed                        | [`recorded`]                              |
//!
//! Coordinates are `q = (z, φ, θ, ψ)`: heave of the mass centre from rest \[m\] and the angles of `R = Rz(ψ) Ry(θ)
//! Rx(φ)` \[rad\]; the mooring holds surge and sway. Axes: x ahead, y to the left, z up.
//!
//! Chapter 6 of the thesis names a marine platform with four degrees of freedom and gives no number of it; everything
//! here is assumed.

pub mod control;
pub mod excitation;
pub mod hull;
pub mod recorded;
pub mod sea;
pub mod simulation;
pub mod spectrum;
pub mod thrusters;
pub mod wind;

use mbs_models::check::Invalid;
use mbs_runtime::IntegrationError;
use mbs_runtime::control::ControlError;

/// `(z, φ, θ, ψ)` \[m, rad\], their rates or accelerations; or a force and three moments \[N, N·m\].
pub type Four = [f64; 4];

/// Why there is no sea, no platform or no motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MarineError {
    /// A number that this does not work with.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// Waves of this height and period would break.
    #[error("waves of {height} m and {period} s are too steep: 2π Hs/(g Tp²) is {steepness}, at most {limit} here")]
    TooSteep {
        /// Significant wave height Hs \[m\].
        height: f64,
        /// Peak period Tp \[s\].
        period: f64,
        /// `2π Hs/(g Tp²)`.
        steepness: f64,
        /// The most that it may be at this period.
        limit: f64,
    },
    /// The platform does not float with its columns in the water, or it does not float upright.
    #[error(
        "the platform does not float upright: draught of its columns {draught} m, metacentric heights {heights:?} m"
    )]
    Unstable {
        /// How deep the columns are at rest \[m\].
        draught: f64,
        /// For roll and pitch \[m\].
        heights: [f64; 2],
    },
    /// Still water does not cut a column between its ends, where the hydrostatics hold.
    #[error("at t = {time} s column {column} is {depth} m deep in still water, and only {least} to {most} m count")]
    OffTheColumns {
        /// When \[s\].
        time: f64,
        /// The column, counted from 0.
        column: usize,
        /// How deep its lower end is \[m\].
        depth: f64,
        /// The least that counts \[m\].
        least: f64,
        /// The length of the column \[m\].
        most: f64,
    },
    /// There is no regulator.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// The integration failed.
    #[error(transparent)]
    Integration(#[from] IntegrationError),
}
