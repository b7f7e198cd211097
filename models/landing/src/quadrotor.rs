//! A quadrotor that lands on a moving platform, as chapter 5 of the thesis treats it: what surrounds the generated
//! dynamics of
//! [`quadrotor_euler`](mbs_models::quadrotor_euler), and of
//! [`quadrotor_quaternion`](mbs_models::quadrotor_quaternion), the same vehicle without the singularity of the angles.
//!
//! | thesis                | here                                                                              |
//! |-----------------------|-----------------------------------------------------------------------------------|
//! | (5.1)–(5.7)           | [`quadrotor_euler`](mbs_models::quadrotor_euler), generated; [`mixer`]: (5.4)             |
//! | (5.8), (5.12)         | [`small_angle`]: the plant for small angles, corrected                              |
//! | (5.9)                 | [`heave`]: the platform's elevation; [`deck`]: it, and decks that move in six degrees of freedom |
//! | (5.10), (5.11)        | [`flatness`]: the attitude that an acceleration asks for                            |
//! | control law           | [`backstepping`]; for comparison [`lqr`]; [`adaptive`]: of a vehicle that nobody knows; [`rotors`]: speeds for generalized forces    |
//! | cases I and II        | [`approach`]: guidance; [`landing`]: simulation up to the [`touchdown`]; [`sampled`]: by a sampled controller; [`estimated`]: on what sensors say; [`driven`]: on the Stewart platform under control |
//! | 8.3, predictive control | `predictive`, with the feature of that name: landings that are planned anew while flying |
//! | ground effect         | [`ground_effect`], an option of the landing                                         |
//! | after the touchdown   | [`gear`]: four legs with friction; [`standing`]: rebound, sliding, tip-over, rest    |
//! | "various disturbances" | [`wind`]: shear and Dryden's turbulence                                            |
//!
//! Coordinates are those of the mechanism, `q = (x, y, z, φ, θ, ψ)`, attitude by `R = Rz(ψ) Ry(θ) Rx(φ)`, z up.
//!
//! # Source
//! Doctoral thesis *Dynamics of multibody systems in a gravitational field*, chapter 5.

pub mod adaptive;
pub mod approach;
pub mod backstepping;
pub mod deck;
pub mod driven;
pub mod estimated;
pub mod flatness;
pub mod gear;
pub mod ground_effect;
pub mod heave;
pub mod landing;
pub mod lqr;
pub mod mixer;
#[cfg(feature = "predictive")]
pub mod predictive;
pub mod rotors;
pub mod sampled;
pub mod small_angle;
pub mod standing;
pub mod touchdown;
pub mod wind;
mod zero_order_hold;
