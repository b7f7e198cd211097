//! How the vehicle really moves between burns: the nonlinear relative motion, with or without the station's own
//! attraction.
//!
//! Without it both are Kepler motions, [`relative_motion`]. With it, in axes that do not turn, ρ from the station at R,
//!
//! ```text
//! ρ̈ = −(μ/r³) (ρ − f(q) R) − G m_t ρ/ρ³,   r = |R + ρ|,
//! q = ρ·(ρ + 2 R)/R²,   f(q) = q (3 + 3 q + q²)/(1 + (1 + q)^{3/2})
//! ```
//!
//! where nothing cancels for small ρ.
//!
//! # Source
//! Thesis, equation (7.11), corrected; Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999,
//! on Encke's method.

use core::ops::ControlFlow;

use mbs_models::Error;
use mbs_runtime::{Dop853, Integrator, Scalar, State};

use super::super::kepler::propagate;
use super::super::lvlh::{Frame, RelativeMotion, relative_motion};
use super::super::vector::{StateVector, Vector, dot, norm, plus, scaled};

/// What attracts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attraction {
    /// G times the mass of the centre \[m³/s²\].
    pub centre: f64,
    /// G times the mass of the station, a point in the origin of its frame; zero for none \[m³/s²\].
    pub station: f64,
}

impl Attraction {
    /// The motion after a time, in the station's frames.
    ///
    /// # Errors
    /// [`Error`].
    pub fn coast(&self, motion: &RelativeMotion, time: f64) -> Result<RelativeMotion, Error> {
        if self.station == 0.0 {
            return relative_motion(self.centre, &motion.station, &motion.relative, time);
        }
        let mut state = State::from(Frame::of(&motion.station)?.turned_out(&motion.relative));
        let station = |t: f64| propagate(self.centre, &motion.station, t);
        let acceleration = |t: f64, position: &Vector, _: &Vector, result: &mut Vector| {
            // What is not a number ends the integration.
            *result = station(t).map_or([f64::NAN; 3], |at| self.acceleration(&at.state.position, position));
        };
        Dop853::new(1e-13, 1e-14).integrate(acceleration, 0.0, time, &mut state, |_| ControlFlow::Continue(()))?;
        let end = station(time)?.state;
        let relative = Frame::of(&end)?.turned_in(&StateVector::from(state));
        Ok(RelativeMotion { station: end, relative })
    }

    /// `ρ̈` in axes that do not turn.
    fn acceleration(&self, station: &Vector, position: &Vector) -> Vector {
        let square = dot(station, station);
        let twice = plus(position, &scaled(2.0, station));
        let q = dot(position, &twice) / square;
        let root = Scalar::sqrt(1.0 + q);
        let f = q * (3.0 + q * (3.0 + q)) / (1.0 + (1.0 + q) * root);
        let r = root * Scalar::sqrt(square);
        let tide = -self.centre / (r * r * r);
        let distance = norm(position);
        let own = if distance > 0.0 { -self.station / (distance * distance * distance) } else { f64::NAN };
        core::array::from_fn(|i| tide * (position[i] - f * station[i]) + own * position[i])
    }
}
