//! The final approach: from some tens of metres to the ring.
//!
//! Every period a reference along the approach, a [`Glideslope`] that goes on at its last speed, asks for a place of
//! the chaser's port before that of the station; control asks for a force and a torque,
//!
//! ```text
//! F = m [a_d − 2 ζ ω_n (ḋ − ḋ_d) − ω_n² (d − d_d) − a_CW]
//! ```
//!
//! with d from port to port in the axes of the station's and a_CW the accelerations of Clohessy and Wiltshire; jets
//! make pulses of them, and their plumes push the station. Jets are quiet from touch on.
//!
//! # Source
//! Fehse, *Automated Rendezvous and Docking of Spacecraft*, 2003, sections 5.4 and 6.2.

use core::f64::consts::PI;

use mbs_models::{Error, Failure, check};
use mbs_runtime::{Event, State};

use super::attitude::AttitudeControl;
use super::bodies::{Body, Misalignment, Pair, conjugate, product, rate, roll_pitch_yaw, turned, turned_back};
use super::docking_bodies::{DockingBodies, Params};
use super::jets::{JETS, JetSet, PerJet};
use super::plume::{Panel, Plume};
use super::ring::{Contact, Inputs, Latches, advance, meet};
use crate::mission::glideslope::Glideslope;
use crate::vector::{Vector, cross, minus, norm, plus, scaled};

/// How the chaser stands at the beginning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// From port to port along the approach \[m\].
    pub distance: f64,
    /// Beside the axis, in the port's second and third axis \[m\].
    pub aside: [f64; 2],
    /// Of the chaser's port against that of the station: roll, pitch, yaw \[rad\].
    pub angles: Vector,
    /// Of the chaser against the station, in its own axes \[rad/s\].
    pub spin: Vector,
}

/// A final approach to be flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftDocking {
    /// Bodies, ports and ring.
    pub params: Params<f64>,
    /// How it begins.
    pub start: Start,
    /// Speeds at the beginning and at touch \[m/s\].
    pub speeds: [f64; 2],
    /// What controls the attitude.
    pub attitude: AttitudeControl,
    /// Of the place, with the same law \[rad/s, 1\].
    pub place: [f64; 2],
    /// What the chaser pushes with.
    pub jets: JetSet,
    /// Their exhaust.
    pub plume: Plume,
    /// What it meets, in the axes of the station's port.
    pub panels: [Panel; 3],
    /// When ports are within limits.
    pub latches: Latches,
    /// The longest approach \[s\].
    pub longest: f64,
    /// How long the contact is looked at \[s\].
    pub contact: f64,
}

/// The way, once a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time \[s\].
    pub time: f64,
    /// The states of both bodies.
    pub pair: Pair,
    /// The misalignment of the ports.
    pub ports: Misalignment,
    /// The depth that the reference asks for \[m\].
    pub wanted: f64,
    /// Of the plumes on the station in this period \[N·s\].
    pub plume: f64,
    /// Of all jets in this period \[N·s\].
    pub impulse: f64,
    /// Of the ring on the chaser \[N\].
    pub ring: f64,
    /// The energy integral \[J\].
    pub energy: f64,
}

/// How it went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Touch and after.
    pub contact: Contact,
    /// The propellant \[kg\].
    pub propellant: f64,
    /// Pulses of all jets.
    pub pulses: u32,
    /// The impulse of all jets \[N·s\].
    pub impulse: f64,
    /// The greatest force of plumes on the station \[N\].
    pub plume_force: f64,
    /// Their greatest torque about its mass centre \[N·m\].
    pub plume_torque: f64,
    /// Their impulse on the station \[N·s\].
    pub plume_impulse: f64,
    /// The station at touch, which nobody controls.
    pub station: Body,
}

impl SoftDocking {
    /// Along the V-bar from 30 m, aside and turned by some degrees; all numbers are assumed.
    #[must_use]
    pub fn to_the_station() -> Self {
        const DEGREE: f64 = PI / 180.0;
        let panel = |middle: Vector, y: f64, z: f64| Panel { middle, halves: [[0.0, 0.0, z], [0.0, y, 0.0]] };
        Self {
            params: Params::default(),
            start: Start {
                distance: 30.0,
                aside: [0.6, -0.4],
                angles: [6.0 * DEGREE, -5.0 * DEGREE, 4.0 * DEGREE],
                spin: [0.1 * DEGREE, -0.15 * DEGREE, 0.1 * DEGREE],
            },
            speeds: [0.3, 0.07],
            attitude: AttitudeControl { frequency: 0.15, damping: 0.9 },
            place: [0.06, 0.9],
            jets: JetSet::capsule(20.0 * DEGREE),
            plume: Plume { exponent: 10.0, parts: 12 },
            // The port's face, and two solar arrays 10 m behind it.
            panels: [
                panel([0.0; 3], 2.0, 2.0),
                panel([10.0, 25.0, 0.0], 15.0, 6.0),
                panel([10.0, -25.0, 0.0], 15.0, 6.0),
            ],
            latches: Latches::STANDARD,
            longest: 1000.0,
            contact: 120.0,
        }
    }

    /// Chaser and station at the beginning: the station at rest in the axes of the orbit.
    #[must_use]
    pub fn pair(&self) -> Pair {
        let params = &self.params;
        let station = Body {
            position: [0.0; 3],
            velocity: [0.0; 3],
            attitude: [1.0, 0.0, 0.0, 0.0],
            spin: [0.0, 0.0, rate(params)],
        };
        let ring = roll_pitch_yaw(&params.station_port_attitude);
        let probe = product(&ring, &roll_pitch_yaw(&self.start.angles));
        let attitude = product(&probe, &conjugate(&roll_pitch_yaw(&params.chaser_port_attitude)));
        let [y, z] = self.start.aside;
        let port = plus(&params.station_port, &turned(&ring, &[-self.start.distance, y, z]));
        let spin = turned(&attitude, &self.start.spin);
        let arm = turned(&attitude, &params.chaser_port);
        // The port, not the mass centre, comes along the approach.
        let velocity = minus(&turned(&ring, &[self.speeds[0], 0.0, 0.0]), &cross(&spin, &arm));
        let chaser = Body {
            position: minus(&port, &arm),
            velocity,
            attitude,
            spin: plus(&self.start.spin, &turned_back(&attitude, &station.spin)),
        };
        Pair { chaser, station }
    }

    /// Flies it.
    ///
    /// # Errors
    /// [`Error`].
    pub fn fly(&self, mut observe: impl FnMut(&Moment)) -> Result<Report, Error> {
        self.check()?;
        let slope = Glideslope::new(self.start.distance, self.speeds[0], self.speeds[1])?;
        let mut params = self.params;
        let mut state = self.pair().to_state(&params);
        let (mut sums, mut owed) = (Sums::default(), [0.0; JETS]);
        let mut period = 0.0;
        let touched = loop {
            let t = period * self.jets.period;
            let pair = Pair::from_state(&params, &state);
            let ports = pair.misalignment(&params);
            if t > self.longest {
                return Err(Failure::NoContact { distance: -ports.place[0] }.at_time(t));
            }
            let wanted = self.reference(&slope, t);
            let thrusts = self.jets.allocate(&self.wrench(&params, &pair, &ports, &wanted));
            let open = self.jets.pulses(&thrusts, &mut owed);
            let before = sums;
            let bodies = DockingBodies::try_new(params)?;
            let energy = bodies.conserved(&state.q, &state.qd)[0];
            let touched = self.coast(&bodies, &mut state, t, &open, &mut sums)?;
            observe(&Moment {
                time: t,
                pair,
                ports,
                wanted: wanted[0],
                plume: sums.plume_impulse - before.plume_impulse,
                impulse: sums.impulse - before.impulse,
                ring: 0.0,
                energy,
            });
            params.chaser_mass = self.params.chaser_mass - sums.impulse / self.jets.exhaust_velocity;
            check::positive("chaser_mass", params.chaser_mass).map_err(|error| error.at_time(t))?;
            if let Some(time) = touched {
                break time;
            }
            period += 1.0;
        };
        let station = Pair::from_state(&params, &state).station;
        let contact = meet(&params, &self.latches, &mut state, [touched, touched + self.contact], |pressing| {
            observe(&Moment {
                time: pressing.time,
                pair: pressing.pair,
                ports: pressing.ports,
                wanted: 0.0,
                plume: 0.0,
                impulse: 0.0,
                ring: pressing.force,
                energy: pressing.energy,
            });
        })?;
        Ok(Report {
            contact,
            propellant: sums.impulse / self.jets.exhaust_velocity,
            pulses: sums.pulses,
            impulse: sums.impulse,
            plume_force: sums.plume_force,
            plume_torque: sums.plume_torque,
            plume_impulse: sums.plume_impulse,
            station,
        })
    }

    /// Depth that is wanted, its rate and its acceleration.
    fn reference(&self, slope: &Glideslope, t: f64) -> [f64; 3] {
        let [_, last] = self.speeds;
        let late = t - slope.duration();
        if late > 0.0 {
            return [last * late, last, 0.0];
        }
        let to_go = slope.distance(t);
        let speed = last - slope.rate() * to_go;
        [-to_go, speed, slope.rate() * speed]
    }

    /// Force and torque in the chaser's axes.
    fn wrench(&self, params: &Params<f64>, pair: &Pair, ports: &Misalignment, wanted: &[f64; 3]) -> [f64; 6] {
        let Pair { chaser, station } = pair;
        let ring = product(&station.attitude, &roll_pitch_yaw(&params.station_port_attitude));
        let goal = product(&ring, &conjugate(&roll_pitch_yaw(&params.chaser_port_attitude)));
        let error = product(&conjugate(&goal), &chaser.attitude);
        let spin = turned_back(&chaser.attitude, &turned(&station.attitude, &station.spin));
        let torque = self.attitude.torque(&params.chaser_inertia, &error, &chaser.spin, &spin);
        let [frequency, damping] = self.place;
        let [place, speed, acceleration] = [0, 1, 2].map(|i| [wanted[i], 0.0, 0.0]);
        let asked: Vector = core::array::from_fn(|i| {
            acceleration[i]
                - 2.0 * damping * frequency * (ports.velocity[i] - speed[i])
                - frequency * frequency * (ports.place[i] - place[i])
        });
        let n = rate(params);
        let ([x, _, z], [u, v, _]) = (chaser.position, chaser.velocity);
        let tide = [3.0 * n * n * x + 2.0 * n * v, -2.0 * n * u, -n * n * z];
        let force = scaled(params.chaser_mass, &minus(&turned(&ring, &asked), &tide));
        let [f, g, h] = turned_back(&chaser.attitude, &force);
        [f, g, h, torque[0], torque[1], torque[2]]
    }

    /// A period in parts between which no valve moves; the time of touch where it comes.
    fn coast(
        &self,
        bodies: &DockingBodies<f64>,
        state: &mut State<[f64; 14]>,
        start: f64,
        open: &PerJet,
        sums: &mut Sums,
    ) -> Result<Option<f64>, Error> {
        let params = bodies.params();
        sums.pulses += open.iter().map(|time| u32::from(*time > 0.0)).sum::<u32>();
        let mut since = 0.0;
        while since < self.jets.period {
            let until = open.iter().filter(|time| **time > since).fold(self.jets.period, |next, time| next.min(*time));
            let on = open.map(|time| time > since);
            let inputs = self.inputs(params, &Pair::from_state(params, state), &on, sums);
            let depth =
                |_: f64, state: &State<[f64; 14]>| Pair::from_state(params, state).misalignment(params).place[0];
            let mut events = [Event::new(&depth).rising().terminal()];
            let summary = advance(bodies, &inputs, [start + since, start + until], state, &mut events)?;
            let lasted = summary.time - start - since;
            sums.impulse += lasted * self.jets.thrust * on.iter().map(|on| f64::from(u8::from(*on))).sum::<f64>();
            sums.plume_impulse += lasted * norm(&[inputs[6], inputs[7], inputs[8]]);
            if summary.stopped {
                return Ok(Some(summary.time));
            }
            since = until;
        }
        Ok(None)
    }

    /// Jets on the chaser, and their plumes on the station.
    fn inputs(&self, params: &Params<f64>, pair: &Pair, on: &[bool; JETS], sums: &mut Sums) -> Inputs {
        let Pair { chaser, station } = pair;
        let port = roll_pitch_yaw(&params.station_port_attitude);
        let ring = product(&station.attitude, &port);
        let origin = plus(&station.position, &turned(&station.attitude, &params.station_port));
        let mut sum = [[0.0; 3]; 4];
        for jet in (0..JETS).filter(|&jet| on[jet]) {
            let [force, torque] = self.jets.push(jet, self.jets.thrust);
            (sum[0], sum[1]) = (plus(&sum[0], &force), plus(&sum[1], &torque));
            let axis = turned_back(&ring, &turned(&chaser.attitude, &scaled(-1.0, &self.jets.jets[jet].push)));
            // The station is ahead: gas that goes back does not meet it.
            if axis[0] > 0.0 {
                let nozzle = plus(&chaser.position, &turned(&chaser.attitude, &self.jets.jets[jet].place));
                let nozzle = turned_back(&ring, &minus(&nozzle, &origin));
                let [force, torque] = self.plume.wrench(self.jets.thrust, &nozzle, &axis, &self.panels);
                let force = turned(&port, &force);
                let torque = plus(&turned(&port, &torque), &cross(&params.station_port, &force));
                (sum[2], sum[3]) = (plus(&sum[2], &force), plus(&sum[3], &torque));
            }
        }
        sums.plume_force = sums.plume_force.max(norm(&sum[2]));
        sums.plume_torque = sums.plume_torque.max(norm(&sum[3]));
        core::array::from_fn(|i| sum[i / 3][i % 3])
    }

    fn check(&self) -> Result<(), Error> {
        check::positive("start.distance", self.start.distance)?;
        check::finite("start.aside", self.start.aside)?;
        check::finite("start.angles", self.start.angles)?;
        check::finite("start.spin", self.start.spin)?;
        check::positive("attitude.frequency", self.attitude.frequency)?;
        check::not_negative("attitude.damping", self.attitude.damping)?;
        check::not_negative("place", self.place)?;
        check::within("longest", self.longest, [0.0, 1e5])?;
        check::within("contact", self.contact, [0.0, 1e4])?;
        self.jets.check()?;
        self.plume.check()?;
        for panel in &self.panels {
            check::finite("panels.middle", panel.middle)?;
            panel.halves.iter().try_for_each(|half| check::finite("panels.halves", *half))?;
        }
        Ok(self.latches.check()?)
    }
}

/// Up to now.
#[derive(Clone, Copy, Default)]
struct Sums {
    pulses: u32,
    impulse: f64,
    plume_impulse: f64,
    plume_force: f64,
    plume_torque: f64,
}
