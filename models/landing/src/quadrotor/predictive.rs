//! Landings that are planned while they are flown: predictive control, and the landing that is the shortest in time.
//!
//! A plan is a motion over a horizon of N intervals, direct multiple shooting: states x₀ … x_N and rotor speeds u₀ …
//! u_{N−1} that are held for an interval, joined by steps of the generated equations of motion. Both kinds of landing
//! are the same [`OptimalControl`]; one has a horizon of fixed length and costs deviations, the other has its end as a
//! variable and costs time.
//!
//! ```text
//! min Σ ½ (x_k − x̄_k)ᵀ Q_k (x_k − x̄_k) + ½ (u_k − ū_k)ᵀ R (u_k − ū_k) + w T
//! x_{k+1} = F(x_k, u_k, T/N),   x₀ given,   u_min ≤ u_k ≤ u_max,   g_k(x_k, t₀ + T k/N) ≥ 0
//! ```
//!
//! | step                                                                 | here               |
//! |----------------------------------------------------------------------|--------------------|
//! | F and its exact derivatives, by the generated `linearize`             | [`step`]           |
//! | the problem, and a plan                                              | [`problem`]        |
//! | sequential quadratic programming; one quadratic program a sample     | [`sequential`]     |
//! | thrust, tilt, visibility, touchdown velocity, the deck not passed     | [`limits`]         |
//! | predictive control                                                   | [`controller`]     |
//! | the shortest landing                                                 | [`shortest`]       |
//! | both as they are flown, with a vehicle that is not the planned one    | [`flight`]         |
//!
//! # Source
//! H. G. Bock and K. J. Plitt, *A multiple shooting algorithm for direct solution of optimal control problems*, IFAC
//! World Congress 1984; M. Diehl, H. G. Bock and J. P. Schlöder, *A real-time iteration scheme for nonlinear
//! optimization in optimal feedback control*, SIAM Journal on Control and Optimization 43:5, 2005.

pub mod controller;
pub mod flight;
pub mod limits;
pub mod problem;
mod quadratic;
pub mod sequential;
pub mod shortest;
pub mod step;
#[cfg(test)]
mod tests;

pub use problem::OptimalControl;
