//! Where the vehicle is, from what its sensors say: an error-state Kalman filter.
//!
//! The nominal state, position and velocity of the IMU, attitude as a unit quaternion, biases of gyroscopes and
//! accelerometers ([`nominal`]), is led by the IMU; the filter estimates its 15 errors ([`filter`]),
//!
//! ```text
//! x = c + E (x̂ − c) + δx    v = E v̂ + δv    R = E R̂ = R̂ exp[δθ]×    b_g = b̂_g + δb_g    b_a = b̂_a + δb_a
//! ```
//!
//! with the rotation `E = R̂ exp[δθ]× R̂ᵀ` about a point c of the deck,
//!
//! and the 6 errors of a clone, the pose at the last image: an image is told of when the vehicle is elsewhere
//! already, and corrects the clone, by whose covariance with the present state that one is corrected, too.
//!
//! Transition and measurement matrices are Jacobians of outputs, generated from the mechanisms
//! [`strapdown`](mbs_models::sensors::strapdown) and [`sensor_head`](mbs_models::sensors::sensor_head) by coordinates,
//! velocities and inputs, and taken to errors by those of the quaternion. No derivative is typed here. The noise of the
//! filter is that of the sensors, sample by sample; nothing is tuned.
//!
//! The motion of the deck is known: position and attitude at each moment, as the controller knows it. What markers and
//! laser tell is where the vehicle is against the deck; with its motion known that is where it is in the world.
//!
//! # Sources
//! J. Solà, *Quaternion kinematics for the error-state Kalman filter*, 2017: the errors' reset. A. Barrau and S.
//! Bonnabel, *The invariant extended Kalman filter as a stable observer*, IEEE Transactions on Automatic Control 62:4,
//! 2017: errors that turn place and velocity, too. F. L. Markley,
//! *Attitude error representations for Kalman filtering*, 2003. S. I. Roumeliotis and J. W. Burdick, *Stochastic
//! cloning: a generalized framework for processing relative state measurements*, 2002: the clone. B. M. Bell and F. W.
//! Cathey, *The iterated Kalman filter update as a Gauss–Newton method*, 1993.

pub mod chi_square;
pub mod filter;
pub mod measurement;
pub mod nominal;
