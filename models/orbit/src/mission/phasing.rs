//! From far away to a point behind the station on its orbit, by two burns.
//!
//! Two plans compete: half an ellipse that touches both orbits, begun when the phase is right, and the best of
//! Lambert's arcs over departures and durations. The first is the cheapest between circles in one plane, but only there
//! it arrives; the second arrives always.
//!
//! # Source
//! Curtis, *Orbital Mechanics for Engineering Students*, 2020, chapter 6; Izzo, *Revisiting Lambert's problem*, 2015.

use core::f64::consts::PI;

use mbs_models::Error;
use mbs_runtime::Scalar;

use super::super::elements::Elements;
use super::super::integrals::angular_momentum;
use super::super::kepler::propagate;
use super::super::lambert::{self, Route};
use super::super::vector::{StateVector, Vector, cross, dot, minus, norm, scaled};

/// What phasing has to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phasing {
    /// G times the mass of the centre \[m³/s²\].
    pub mu: f64,
    /// Inertial, at the beginning \[m, m/s\].
    pub station: StateVector,
    /// The vehicle, likewise.
    pub vehicle: StateVector,
    /// The point to get to is where the station was so long ago \[s\].
    pub lag: f64,
    /// The longest wait before the first burn \[s\].
    pub longest_wait: f64,
    /// No arc comes nearer to the centre \[m\].
    pub lowest: f64,
    /// How far a plan may miss the point \[m\].
    pub tolerance: f64,
}

/// How a plan was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Half an ellipse that touches both orbits.
    TwoImpulse,
    /// Lambert's problem.
    Lambert,
}

/// Two burns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// How it was found.
    pub method: Method,
    /// Until the first burn \[s\].
    pub wait: f64,
    /// From the first burn to the second \[s\].
    pub duration: f64,
    /// Inertial velocity after the first burn \[m/s\].
    pub departure: Vector,
    /// Both burns together \[m/s\].
    pub delta_v: f64,
    /// How far from the point it ends \[m\].
    pub miss: f64,
    /// Distance of the arc's nearest point from the centre, passed or not \[m\].
    pub nearest: f64,
}

/// Departures and durations of the grid that Lambert's arcs are first looked for on.
const DEPARTURES: usize = 96;
const DURATIONS: usize = 24;
/// Halvings of the grid's steps about the best of them.
const REFINEMENTS: usize = 24;

impl Phasing {
    /// The point behind the station at a time.
    ///
    /// # Errors
    /// [`Error`].
    pub fn aim(&self, time: f64) -> Result<StateVector, Error> {
        Ok(propagate(self.mu, &self.station, time - self.lag)?.state)
    }

    /// The cheaper plan of those that arrive; none where neither does.
    ///
    /// # Errors
    /// [`Error`] of the station or the vehicle.
    pub fn plan(&self) -> Result<Option<Plan>, Error> {
        let [two_impulse, lambert] = [self.two_impulse()?, self.lambert()?];
        let arrives = |plan: &Plan| plan.miss <= self.tolerance && plan.nearest >= self.lowest;
        let better = |a: Plan, b: Plan| if b.delta_v < a.delta_v { b } else { a };
        Ok(match (two_impulse.filter(arrives), lambert) {
            (Some(a), Some(b)) => Some(better(a, b)),
            (one, other) => one.or(other),
        })
    }

    /// Half an ellipse, begun as soon as it meets the point.
    ///
    /// The first burn is horizontal, in the plane of the vehicle's own motion.
    ///
    /// # Errors
    /// [`Error`].
    pub fn two_impulse(&self) -> Result<Option<Plan>, Error> {
        // The angle by which the point will be ahead of the end of the ellipse.
        let lead = |wait: f64| -> Result<(f64, f64), Error> {
            let vehicle = propagate(self.mu, &self.vehicle, wait)?.state;
            let r = norm(&vehicle.position);
            // The distance of the point depends on when it is met.
            let mut duration = PI * Scalar::sqrt(r / self.mu) * r;
            let mut aim = self.aim(wait + duration)?;
            for _ in 0..4 {
                let a = 0.5 * (r + norm(&aim.position));
                duration = PI * Scalar::sqrt(a / self.mu) * a;
                aim = self.aim(wait + duration)?;
            }
            let normal = angular_momentum(&vehicle);
            let opposite = scaled(-1.0, &vehicle.position);
            let across = scaled(1.0 / norm(&normal), &cross(&normal, &opposite));
            Ok((Scalar::atan2(dot(&aim.position, &across), dot(&aim.position, &opposite)), duration))
        };
        let step = self.longest_wait / DEPARTURES as f64;
        let (mut low, mut before) = (0.0, lead(0.0)?.0);
        for k in 1..=DEPARTURES {
            let mut high = k as f64 * step;
            let after = lead(high)?.0;
            // From one half turn to the other it jumps, and does not vanish.
            if (before > 0.0) != (after > 0.0) && (before - after).abs() < PI {
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if (lead(middle)?.0 > 0.0) == (before > 0.0) { low = middle } else { high = middle }
                }
                return self.half_ellipse(low, lead(low)?.1).map(Some);
            }
            (low, before) = (high, after);
        }
        Ok(None)
    }

    fn half_ellipse(&self, wait: f64, duration: f64) -> Result<Plan, Error> {
        let vehicle = propagate(self.mu, &self.vehicle, wait)?.state;
        let aim = self.aim(wait + duration)?;
        let (r, other) = (norm(&vehicle.position), norm(&aim.position));
        let horizontal = cross(&angular_momentum(&vehicle), &vehicle.position);
        let speed = Scalar::sqrt(2.0 * self.mu / r * (other / (r + other)));
        let departure = scaled(speed / norm(&horizontal), &horizontal);
        let end = propagate(self.mu, &StateVector::new(vehicle.position, departure), duration)?.state;
        Ok(Plan {
            method: Method::TwoImpulse,
            wait,
            duration,
            departure,
            delta_v: norm(&minus(&departure, &vehicle.velocity)) + norm(&minus(&aim.velocity, &end.velocity)),
            miss: norm(&minus(&end.position, &aim.position)),
            nearest: r.min(other),
        })
    }

    /// The cheapest of Lambert's arcs: of a grid, then by halved steps about the best so far.
    ///
    /// # Errors
    /// [`Error`].
    pub fn lambert(&self) -> Result<Option<Plan>, Error> {
        let r = norm(&self.station.position);
        let revolution = 2.0 * PI * Scalar::sqrt(r / self.mu) * r;
        let (mut wait_step, mut duration_step) = (self.longest_wait / DEPARTURES as f64, revolution / DURATIONS as f64);
        let mut best: Option<Plan> = None;
        let keep = |best: &mut Option<Plan>, wait: f64, duration: f64| -> Result<(), Error> {
            if (0.0..=self.longest_wait).contains(&wait)
                && duration > 0.0
                && let Some(plan) = self.arc(wait, duration)?
                && best.is_none_or(|best| plan.delta_v < best.delta_v)
            {
                *best = Some(plan);
            }
            Ok(())
        };
        for i in 0..=DEPARTURES {
            for j in 1..DURATIONS {
                keep(&mut best, i as f64 * wait_step, j as f64 * duration_step)?;
            }
        }
        for _ in 0..REFINEMENTS {
            let Some(Plan { wait, duration, .. }) = best else { break };
            for (i, j) in
                [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, -1.0)]
            {
                keep(&mut best, wait + i * wait_step, duration + j * duration_step)?;
            }
            if best.is_some_and(|best| best.wait == wait && best.duration == duration) {
                (wait_step, duration_step) = (0.5 * wait_step, 0.5 * duration_step);
            }
        }
        Ok(best)
    }

    /// One arc, if it is there and does not come too near to the centre.
    fn arc(&self, wait: f64, duration: f64) -> Result<Option<Plan>, Error> {
        let vehicle = propagate(self.mu, &self.vehicle, wait)?.state;
        let aim = self.aim(wait + duration)?;
        let route = Route::prograde().about(angular_momentum(&self.station));
        let Ok(arc) = lambert::arc(self.mu, &vehicle.position, &aim.position, duration, &route) else {
            return Ok(None);
        };
        let Ok(elements) = Elements::from_state(self.mu, &StateVector::new(vehicle.position, arc.departure)) else {
            return Ok(None);
        };
        let nearest = elements.periapsis();
        Ok((nearest >= self.lowest).then(|| Plan {
            method: Method::Lambert,
            wait,
            duration,
            departure: arc.departure,
            delta_v: norm(&minus(&arc.departure, &vehicle.velocity)) + norm(&minus(&aim.velocity, &arc.arrival)),
            miss: 0.0,
            nearest,
        }))
    }
}
