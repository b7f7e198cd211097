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
//! | means, amplitudes and periods of a record                | [`statistics`]                            |
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
pub mod statistics;
pub mod thrusters;
pub mod wind;

use mbs_models::check::{self, Invalid, Must};

/// `(z, φ, θ, ψ)` \[m, rad\], their rates or accelerations; or a force and three moments \[N, N·m\].
pub type Four = [f64; 4];

/// Random numbers from 0 to below 1, K of them for each of N.
fn drawn<const K: usize, const N: usize>(
    number: &'static str,
    mut uniform: impl FnMut() -> f64,
) -> Result<[[f64; K]; N], Invalid> {
    check::positive(number, N as f64)?;
    let mut drawn = [[0.0; K]; N];
    for number in drawn.iter_mut().flatten() {
        *number = uniform();
        if !(0.0..1.0).contains(number) {
            return Err(Must::BeWithin([0.0, 1.0]).broken_by("random number", *number));
        }
    }
    Ok(drawn)
}
