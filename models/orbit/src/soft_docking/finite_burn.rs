//! Burns that last: thrust and mass flow instead of an impulse.
//!
//! ```text
//! m r̈ = −μ m r/r³ + F d,   ṁ = −F/c,   Δv = c ln(m₀/m₁)
//! ```
//!
//! The vehicle is the generated mechanism of [`mbs_models::kepler`] with the mass that is left. A burn is begun half
//! of its duration before the impulse that it stands for, and holds its direction in inertial space; what it then
//! lacks, the gravity loss, falls with the square of the duration.
//!
//! # Source
//! Robbins, *An Analytical Study of the Impulsive Approximation*, AIAA Journal 4(8), 1966; Tsiolkovsky's equation.

use core::f64::consts::PI;
use core::ops::ControlFlow;

use mbs_models::kepler::{Kepler, Params};
use mbs_models::{Error, check};
use mbs_runtime::{Dop853, Integrator, Scalar, State};

use crate::kepler::propagate;
use crate::vector::{StateVector, Vector, cross, dot, minus, norm, scaled};

/// What a main engine does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engine {
    /// The thrust \[N\].
    pub thrust: f64,
    /// Effective velocity of the exhaust \[m/s\].
    pub exhaust_velocity: f64,
}

/// A vehicle that loses mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Inertial \[m, m/s\].
    pub state: StateVector,
    /// The mass \[kg\].
    pub mass: f64,
}

impl Engine {
    /// How long a change of velocity takes: `m₀ c/F (1 − exp(−Δv/c))` \[s\].
    #[must_use]
    pub fn duration(&self, mass: f64, delta_v: f64) -> f64 {
        let part = 1.0 - Scalar::exp(-delta_v / self.exhaust_velocity);
        mass * self.exhaust_velocity / self.thrust * part
    }

    /// The mass that is left after a time of thrust \[kg\].
    #[must_use]
    pub fn mass_after(&self, mass: f64, time: f64) -> f64 {
        mass - self.thrust / self.exhaust_velocity * time
    }

    /// Flies a change of velocity, an inertial vector; its place and time are those at the beginning of the burn.
    ///
    /// # Errors
    /// [`Error`].
    pub fn burn(&self, mu: f64, vehicle: &Vehicle, delta_v: &Vector) -> Result<(Vehicle, f64), Error> {
        check::positive("thrust", self.thrust)?;
        check::positive("exhaust_velocity", self.exhaust_velocity)?;
        check::positive("mass", vehicle.mass)?;
        let size = norm(delta_v);
        check::positive("delta_v", size)?;
        let (duration, force) = (self.duration(vehicle.mass, size), scaled(self.thrust / size, delta_v));
        let motion = |t: f64, q: &Vector, qd: &Vector, qdd: &mut Vector| {
            let body = Kepler::new(Params { mu, m: self.mass_after(vehicle.mass, t) });
            *qdd = body.forward_dynamics(q, qd, &force);
        };
        let mut state = State::from(vehicle.state);
        Dop853::new(1e-13, 1e-9).integrate(motion, 0.0, duration, &mut state, |_| ControlFlow::Continue(()))?;
        let mass = self.mass_after(vehicle.mass, duration);
        Ok((Vehicle { state: state.into(), mass }, duration))
    }
}

/// From one circle to a higher one: two impulses half an ellipse apart, flown by burns that last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raise {
    /// The changes of velocity of the two impulses \[m/s\].
    pub delta_v: [f64; 2],
    /// The durations of the two burns \[s\].
    pub durations: [f64; 2],
    /// What the first burn lacks of its change of velocity: less the impulse at the same place that leads to the same
    /// energy \[m/s\].
    pub gravity_loss: f64,
    /// By how much the orbit in the end is lower than the circle: at its periapsis, at its apoapsis \[m\].
    pub too_low: [f64; 2],
    /// The propellant \[kg\].
    pub propellant: f64,
}

impl Engine {
    /// Raises a vehicle of this mass from a circle to another by Hohmann's impulses, each flown about its time and
    /// along its direction.
    ///
    /// # Errors
    /// [`Error`].
    pub fn raise(&self, mu: f64, mass: f64, [from, to]: [f64; 2]) -> Result<Raise, Error> {
        check::positive("mu", mu)?;
        check::positive("radii", [from, to])?;
        let speed = |radius: f64, axis: f64| Scalar::sqrt(mu * (2.0 / radius - 1.0 / axis));
        let (axis, low, high) = (0.5 * (from + to), speed(from, from), speed(to, to));
        let delta_v = [speed(from, axis) - low, high - speed(to, axis)];
        let first = self.duration(mass, delta_v[0]);
        // On the circle, where half of the burn before the impulse is left.
        let (sin, cos) = Scalar::sin_cos(-0.5 * first * low / from);
        let state = StateVector::new([from * cos, from * sin, 0.0], [-low * sin, low * cos, 0.0]);
        let (vehicle, first) = self.burn(mu, &Vehicle { state, mass }, &[0.0, delta_v[0], 0.0])?;
        let energy = |state: &StateVector| 0.5 * dot(&state.velocity, &state.velocity) - mu / norm(&state.position);
        let reached = Scalar::sqrt(2.0 * (energy(&vehicle.state) + mu / from)) - low;
        let second = self.duration(vehicle.mass, delta_v[1]);
        let half = PI * axis * Scalar::sqrt(axis / mu);
        let state = propagate(mu, &vehicle.state, half - 0.5 * (first + second))?.state;
        let (end, second) = self.burn(mu, &Vehicle { state, mass: vehicle.mass }, &[0.0, -delta_v[1], 0.0])?;
        let StateVector { position, velocity } = &end.state;
        let axis = -0.5 * mu / energy(&end.state);
        // Laplace's vector: no square root of a difference on a circle.
        let laplace = scaled(1.0 / mu, &cross(velocity, &cross(position, velocity)));
        let eccentricity = norm(&minus(&laplace, &scaled(1.0 / norm(position), position)));
        Ok(Raise {
            delta_v,
            durations: [first, second],
            gravity_loss: delta_v[0] - reached,
            too_low: [to - axis * (1.0 - eccentricity), to - axis * (1.0 + eccentricity)],
            propellant: mass - end.mass,
        })
    }
}
