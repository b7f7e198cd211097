//! Touch, trip of the latches, capture or rebound.
//!
//! The ring of [`docking_bodies`](super::docking_bodies) is pressed from touch on; where its depth reaches that of
//! the trip, latches close if the ports are within their limits, and hold what they have. Where they do not, the ring
//! pushes back.
//!
//! # Source
//! Fehse, *Automated Rendezvous and Docking of Spacecraft*, 2003, section 8.3; the limits are those of the initial
//! contact in the *International Docking System Standard*, recalled.

use core::f64::consts::PI;
use core::ops::ControlFlow;

use mbs_models::Error;
use mbs_models::check::{self, Invalid};
use mbs_runtime::{Dop853, Event, IntegrationError, Integrator, Projected, Projector, Scalar, State, Summary};

use super::bodies::{Misalignment, Pair};
use super::docking_bodies::{DockingBodies, Params};
use crate::vector::{Vector, minus, norm};

/// Forces and torques: on the chaser, then on the station, each in its own axes.
pub(super) type Inputs = [f64; 12];

const MEMORY: usize = Projector::<f64, [f64; 0]>::size(14, 2);
/// Between two looks at the ring \[s\].
const LOOK: f64 = 0.02;

/// What the ports must be within for latches to close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Latches {
    /// Beside the axis, at the trip \[m\].
    pub lateral: f64,
    /// Between the approach and the chaser's own, at the trip \[rad\].
    pub tilt: f64,
    /// About the approach, at the trip \[rad\].
    pub roll: f64,
    /// Least and greatest speed along the approach, at touch \[m/s\].
    pub closing: [f64; 2],
    /// Across it, at touch \[m/s\].
    pub sliding: f64,
    /// Angular velocity, at touch \[rad/s\].
    pub turning: f64,
    /// Of the ring: a port farther from the axis does not touch it \[m\].
    pub ring: f64,
}

impl Latches {
    /// The initial contact conditions of the International Docking System Standard, recalled; here angles and what is
    /// beside the axis are asked for at the trip. The radius of the ring is assumed.
    pub const STANDARD: Self = Self {
        lateral: 0.10,
        tilt: 4.0 * PI / 180.0,
        roll: 4.0 * PI / 180.0,
        closing: [0.05, 0.10],
        sliding: 0.04,
        turning: 0.20 * PI / 180.0,
        ring: 0.60,
    };

    /// What keeps them open: the first that is out of its limits.
    #[must_use]
    pub fn refuse(&self, touch: &Misalignment, trip: &Misalignment) -> Option<Limit> {
        // What is NaN is out of its limits.
        let within = |value: f64, most: f64| value <= most;
        let tests = [
            (Limit::TooSlow, touch.closing() >= self.closing[0]),
            (Limit::TooFast, within(touch.closing(), self.closing[1])),
            (Limit::Sliding, within(touch.sliding(), self.sliding)),
            (Limit::Turning, within(touch.turning(), self.turning)),
            (Limit::Lateral, within(trip.lateral(), self.lateral)),
            (Limit::Tilt, within(trip.tilt, self.tilt)),
            (Limit::Roll, within(trip.roll.abs(), self.roll)),
        ];
        tests.into_iter().find(|(_, holds)| !holds).map(|(limit, _)| limit)
    }

    pub(super) fn check(&self) -> Result<(), Invalid> {
        check::not_negative("latches.closing", self.closing)?;
        let limits = [
            ("latches.lateral", self.lateral),
            ("latches.tilt", self.tilt),
            ("latches.roll", self.roll),
            ("latches.sliding", self.sliding),
            ("latches.turning", self.turning),
            ("latches.ring", self.ring),
        ];
        check::each(check::not_negative, limits)
    }
}

/// What keeps latches open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The ring is met too slowly.
    TooSlow,
    /// The ring is met too fast.
    TooFast,
    /// It is met across.
    Sliding,
    /// It is met turning.
    Turning,
    /// Beside the axis.
    Lateral,
    /// The axes are not parallel.
    Tilt,
    /// Turned about the axis.
    Roll,
}

/// How it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Latches hold.
    Captured,
    /// The ports have parted again.
    Bounced,
    /// The chaser's port passed beside the ring.
    Missed,
    /// The time was up while the ring was pressed.
    Pressed,
}

/// A contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// How it ended.
    pub outcome: Outcome,
    /// When ports touched \[s\].
    pub time: f64,
    /// How ports were to each other when they touched.
    pub touch: Misalignment,
    /// When the depth was that of the trip.
    pub trip: Option<Misalignment>,
    /// What kept latches open.
    pub refused: Option<Limit>,
    /// The greatest depth \[m\].
    pub depth: f64,
    /// The greatest force of the ring \[N\].
    pub force: f64,
    /// The energy integral at touch and at the end \[J\].
    pub energy: [f64; 2],
    /// At the end \[s\].
    pub end: f64,
    /// Of the ports at the end.
    pub ports: Misalignment,
}

/// What the ring looks like on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressing {
    /// The time \[s\].
    pub time: f64,
    /// The states of both bodies.
    pub pair: Pair,
    /// The misalignment of the ports.
    pub ports: Misalignment,
    /// Of the ring on the chaser \[N\].
    pub force: f64,
    /// The energy integral \[J\].
    pub energy: f64,
}

/// From touch on, without jets, for a time.
///
/// `params` say nothing of latches: they are open at the beginning. `state` is afterwards the one at the end.
///
/// # Errors
/// [`Error`]; NaN in the state is one of the integrator's.
pub fn meet(
    params: &Params<f64>,
    latches: &Latches,
    state: &mut State<[f64; 14]>,
    [time, end]: [f64; 2],
    mut observe: impl FnMut(&Pressing),
) -> Result<Contact, Error> {
    latches.check()?;
    let mut bodies = DockingBodies::try_new(Params { latched: 0.0, ..*params })?;
    let ports = |state: &State<[f64; 14]>| Pair::from_state(params, state).misalignment(params);
    let touch = ports(state);
    let energy = |bodies: &DockingBodies<f64>, state: &State<[f64; 14]>| bodies.conserved(&state.q, &state.qd)[0];
    let first = energy(&bodies, state);
    let mut contact = Contact {
        outcome: Outcome::Pressed,
        time,
        touch,
        trip: None,
        refused: None,
        depth: touch.place[0],
        force: 0.0,
        energy: [first, first],
        end: time,
        ports: touch,
    };
    if touch.lateral() > latches.ring {
        contact.outcome = Outcome::Missed;
        return Ok(contact);
    }
    let mut t = time;
    while t < end && contact.outcome != Outcome::Bounced {
        let until = (t + LOOK).min(end);
        // What is looked for: the trip while it has not come, the parting while latches do not hold.
        let depth = |at: f64| move |_: f64, state: &State<[f64; 14]>| ports(state).place[0] - at;
        let (trip, part) = (depth(params.trip_depth), depth(0.0));
        let mut events = [Event::new(&trip).rising(), Event::new(&part).falling()];
        if contact.trip.is_none() {
            events[0] = Event::new(&trip).rising().terminal();
        }
        if contact.outcome != Outcome::Captured {
            events[1] = Event::new(&part).falling().terminal();
        }
        let summary = advance(&bodies, &[0.0; 12], [t, until], state, &mut events)?;
        let (tripped, parted) = (events[0].count() > 0, events[1].count() > 0);
        t = summary.time;
        let now = ports(state);
        if summary.stopped && tripped && contact.trip.is_none() {
            contact.trip = Some(now);
            contact.refused = latches.refuse(&touch, &now);
            if contact.refused.is_none() {
                bodies = DockingBodies::try_new(Params { latched: 1.0, ..*params })?;
                contact.outcome = Outcome::Captured;
            }
        } else if summary.stopped && parted {
            contact.outcome = Outcome::Bounced;
        }
        let pressing = Pressing {
            time: t,
            pair: Pair::from_state(params, state),
            ports: now,
            force: ring_force(&bodies, state)?,
            energy: energy(&bodies, state),
        };
        contact.depth = contact.depth.max(now.place[0]);
        contact.force = contact.force.max(pressing.force);
        (contact.energy[1], contact.end, contact.ports) = (pressing.energy, t, now);
        observe(&pressing);
    }
    Ok(contact)
}

/// Of the ring on the chaser: what of its acceleration goes with the ring \[N\].
fn ring_force(bodies: &DockingBodies<f64>, state: &State<[f64; 14]>) -> Result<f64, Error> {
    let free = DockingBodies::try_new(Params {
        axial_stiffness: 0.0,
        lateral_stiffness: 0.0,
        angular_stiffness: 0.0,
        axial_damping: 0.0,
        lateral_damping: 0.0,
        angular_damping: 0.0,
        ..*bodies.params()
    })?;
    let [with, without] = [bodies, &free].map(|bodies| bodies.forward_dynamics(&state.q, &state.qd, &[0.0; 12]));
    let of_chaser = |qdd: &[f64; 14]| -> Vector { [qdd[0], qdd[1], qdd[2]] };
    Ok(bodies.params().chaser_mass * norm(&minus(&of_chaser(&with), &of_chaser(&without))))
}

/// Both bodies under constant forces in their own axes, up to the end or to an event that ends it.
pub(super) fn advance(
    bodies: &DockingBodies<f64>,
    inputs: &Inputs,
    [t, end]: [f64; 2],
    state: &mut State<[f64; 14]>,
    events: &mut [Event<'_, [f64; 14]>],
) -> Result<Summary, IntegrationError> {
    let motion =
        |_: f64, q: &[f64; 14], qd: &[f64; 14], qdd: &mut [f64; 14]| *qdd = bodies.forward_dynamics(q, qd, inputs);
    let drift = Projector::new([0.0; MEMORY]).onto(bodies);
    let method = Projected { method: Dop853::new(1e-11, 1e-12), drift };
    method.integrate_with_events(motion, t, end, state, events, |_| ControlFlow::Continue(()))
}

/// Frequency and damping ratio of the ring along the approach, of both masses against each other \[rad/s,
/// dimensionless\].
#[must_use]
pub fn axial_oscillator(params: &Params<f64>) -> [f64; 2] {
    let mass = params.chaser_mass * params.station_mass / (params.chaser_mass + params.station_mass);
    let frequency = Scalar::sqrt(params.axial_stiffness / mass);
    [frequency, params.axial_damping / (2.0 * mass * frequency)]
}
