//! A station on its orbit, as the generated mechanisms of relative motion are told about it, and a body that flies
//! about it.
//!
//! ```text
//! r̈ = r ν̇² − μ/r²,   ν̈ = −2 ṙ ν̇/r,   v² = μ (1 + e)/q at the periapsis, at the distance q
//! ```
//!
//! # Source
//! Thesis, section 7.5; Battin, *An Introduction to the Mathematics and Methods of Astrodynamics*, 1999, chapter 3.

use core::fmt;

use mbs_models::{Error, Failure, check};
use mbs_runtime::{Scalar, State};

use super::kepler::propagate;
use super::vector::StateVector;
use mbs_models::relative_lvlh::{Params, RelativeLvlh};

/// A station that falls freely about a centre, at its periapsis at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    mu: f64,
    periapsis: f64,
    eccentricity: f64,
    mass: f64,
    /// At the periapsis, in the plane of the orbit, with it on the first axis.
    start: StateVector,
}

/// An orbit that dips below the surface of the centre: it is computed, about a centre that is a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BelowTheSurface {
    /// Smallest distance from the centre \[m\].
    pub periapsis: f64,
    /// Radius of the body at the centre \[m\].
    pub surface: f64,
}

impl fmt::Display for BelowTheSurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { periapsis, surface } = self;
        write!(f, "the orbit comes as near as {periapsis} m to the centre, below the surface at {surface} m")
    }
}

impl Station {
    /// On a circle.
    ///
    /// | argument | meaning                        | unit  |
    /// |----------|--------------------------------|-------|
    /// | `mu`     | G times the mass of the centre | m³/s² |
    /// | `radius` | of the circle                  | m     |
    ///
    /// # Errors
    /// [`Failure::Invalid`], [`Failure::OutOfRange`].
    pub fn on_a_circle(mu: f64, radius: f64) -> Result<Self, Error> {
        Self::from_periapsis(mu, radius, 0.0)
    }

    /// On any conic, from its periapsis on; an eccentricity of 1 is a parabola.
    ///
    /// | argument       | meaning                          | unit  |
    /// |----------------|----------------------------------|-------|
    /// | `mu`           | G times the mass of the centre   | m³/s² |
    /// | `periapsis`   | smallest distance from the centre | m    |
    /// | `eccentricity` | 0 or more                        | 1     |
    ///
    /// # Errors
    /// [`Failure::Invalid`], [`Failure::OutOfRange`].
    pub fn from_periapsis(mu: f64, periapsis: f64, eccentricity: f64) -> Result<Self, Error> {
        check::positive("mu", mu)?;
        check::positive("periapsis", periapsis)?;
        check::not_negative("eccentricity", eccentricity)?;
        let speed = Scalar::sqrt(mu * (1.0 + eccentricity) / periapsis);
        let start = StateVector::new([periapsis, 0.0, 0.0], [0.0, speed, 0.0]);
        let station = Self { mu, periapsis, eccentricity, mass: 0.0, start };
        let (rate, period) = (station.rate(), station.period());
        if rate > 0.0 && rate.is_finite() && period > 0.0 { Ok(station) } else { Err(Failure::OutOfRange.into()) }
    }

    /// The station with a mass that attracts as a point \[kg\].
    ///
    /// # Errors
    /// [`Failure::Invalid`].
    pub fn with_mass(self, mass: f64) -> Result<Self, Error> {
        check::not_negative("station mass", mass)?;
        Ok(Self { mass, ..self })
    }

    /// A warning where the orbit dips below a surface.
    #[must_use]
    pub fn below(&self, surface: f64) -> Option<BelowTheSurface> {
        (self.periapsis < surface).then_some(BelowTheSurface { periapsis: self.periapsis, surface })
    }

    /// Time of a revolution \[s\]; infinite on parabolas and hyperbolas.
    #[must_use]
    pub fn period(&self) -> f64 {
        if self.eccentricity >= 1.0 {
            return f64::INFINITY;
        }
        let axis = self.periapsis / (1.0 - self.eccentricity);
        2.0 * core::f64::consts::PI * axis * Scalar::sqrt(axis / self.mu)
    }

    /// Rate of turn at the periapsis \[rad/s\], at which a circle is run through.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.start.velocity[1] / self.periapsis
    }

    /// The inertial state at a time, in the plane of the orbit.
    ///
    /// # Errors
    /// [`Error`].
    pub fn state(&self, t: f64) -> Result<StateVector, Error> {
        propagate(self.mu, &self.start, t).map(|arrival| arrival.state)
    }

    /// Distance \[m\] and polar angle \[rad\], each with its first and second derivative: the prescribed signals of
    /// [`relative_lvlh`](mbs_models::relative_lvlh) and [`relative_cylindrical`](mbs_models::relative_cylindrical). The
    /// angle is the true anomaly within ±π; on a circle it goes on.
    ///
    /// `r̈ = r ν̇² − μ/r²`, `ν̈ = −2 ṙ ν̇/r`.
    ///
    /// # Errors
    /// [`Error`].
    pub fn signals(&self, t: f64) -> Result<[[f64; 3]; 2], Error> {
        check::finite("time", t)?;
        if self.eccentricity == 0.0 {
            let rate = self.rate();
            return finite([[self.periapsis, 0.0, 0.0], [rate * t, rate, 0.0]]);
        }
        let StateVector { position: [x, y, _], velocity: [u, v, _] } = self.state(t)?;
        let square = x * x + y * y;
        let r = Scalar::sqrt(square);
        let radial = (x * u + y * v) / r;
        let rate = self.periapsis * self.start.velocity[1] / square;
        let signal = [r, radial, r * rate * rate - self.mu / square];
        finite([signal, [Scalar::atan2(y, x), rate, -2.0 * radial * rate / r]])
    }

    /// The accelerations of a body about the station, in its local axes, as the integrators want them.
    ///
    /// Where the station's own motion is not found they are NaN, and the integrator reports the time.
    pub fn accelerations_about(&self) -> impl FnMut(f64, &[f64; 3], &[f64; 3], &mut [f64; 3]) + use<> {
        let station = *self;
        let body = RelativeLvlh::new(Params { mu: self.mu, station_mass: self.mass, ..Params::default() });
        move |t, q, qd, qdd| {
            *qdd = match station.signals(t) {
                Ok(signals) => body.forward_dynamics(&signals, q, qd, &[0.0; 3]),
                Err(_) => [f64::NAN; 3],
            };
        }
    }
}

fn finite(signals: [[f64; 3]; 2]) -> Result<[[f64; 3]; 2], Error> {
    if signals.iter().flatten().all(|x| x.is_finite()) { Ok(signals) } else { Err(Failure::OutOfRange.into()) }
}

/// Local axes to cylindrical coordinates r, θ, z about the station.
///
/// # Errors
/// [`Failure::Undetermined`] at r = 0, [`Failure::OutOfRange`].
pub fn to_cylindrical(local: &State<[f64; 3]>) -> Result<State<[f64; 3]>, Error> {
    let ([x, y, z], [u, v, w]) = (local.q, local.qd);
    let square = x * x + y * y;
    if square == 0.0 {
        return Err(Failure::Undetermined("the direction to a body at the station itself").into());
    }
    let r = Scalar::sqrt(square);
    let state = State { q: [r, Scalar::atan2(y, x), z], qd: [(x * u + y * v) / r, (x * v - y * u) / square, w] };
    if state.q.iter().chain(&state.qd).all(|x| x.is_finite()) { Ok(state) } else { Err(Failure::OutOfRange.into()) }
}

/// Cylindrical coordinates about the station to its local axes.
#[must_use]
pub fn from_cylindrical(cylindrical: &State<[f64; 3]>) -> State<[f64; 3]> {
    let ([r, theta, z], [r_dot, theta_dot, z_dot]) = (cylindrical.q, cylindrical.qd);
    let (sin, cos) = Scalar::sin_cos(theta);
    let [radial, across] = [r_dot, r * theta_dot];
    State { q: [r * cos, r * sin, z], qd: [radial * cos - across * sin, radial * sin + across * cos, z_dot] }
}
