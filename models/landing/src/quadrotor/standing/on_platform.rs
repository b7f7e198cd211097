//! A vehicle on the Stewart platform under control: what its legs feel of the touchdown and of the weight.

use std::vec::Vec;

use mbs_models::Error;
use mbs_platform::{LegVector, PlatformMotion, Superposition};

use super::{Carried, Settled, Standing, Start, with_quaternion};
use crate::quadrotor::deck::MovingDeck;
use crate::quadrotor::driven::Drive;
use crate::quadrotor::landing::Landing;
use crate::quadrotor::touchdown::Touchdown;

/// What the platform's legs do at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legs {
    /// When \[s\].
    pub time: f64,
    /// Forces of the legs \[N\].
    pub forces: LegVector,
    /// How far the platform is above its plan \[m\].
    pub off: f64,
    /// Force of the vehicle's feet on the deck, along its normal \[N\].
    pub contact: f64,
}

/// A landing on the platform, and the vehicle that stands there.
#[derive(Clone, Debug)]
pub struct Stand {
    /// How the landing ended.
    pub landing: Touchdown,
    /// What became of the vehicle.
    pub settled: Settled,
    /// The legs, from shortly before the first touch on.
    pub legs: Vec<Legs>,
    /// The greatest force of a leg before and after the first touch \[N\].
    pub greatest: [f64; 2],
    /// How the legs' vertical forces at the end differ from those that the same motion asks for without the vehicle
    /// \[N\].
    pub added_lift: f64,
    /// What the vehicle presses the deck down with at the end \[N\]: its weight, and what its acceleration takes.
    pub push: f64,
    /// The vehicle's weight \[N\].
    pub weight: f64,
    /// Of the platform's frame below its plan at the end \[m\].
    pub sag: f64,
}

impl Stand {
    /// Lands with both controllers sampled once a period \[s\], then follows the vehicle; legs are kept from `before`
    /// the touchdown on \[s\].
    ///
    /// # Errors
    /// [`Error`] of the landing, of the platform and of what follows.
    pub fn of<const K: usize>(
        landing: &Landing<MovingDeck<Superposition<K>>>,
        drive: Drive,
        standing: &Standing,
        period: f64,
        before: f64,
    ) -> Result<Self, Error> {
        let planned = |t: f64| landing.deck.motion.at(t)[0][2];
        let mut legs = Vec::new();
        let end = landing.simulate_driven(Landing::initial_state(), &drive, period, |moment| {
            let off = moment.platform.q[2] - planned(moment.time);
            legs.push(Legs { time: moment.time, forces: moment.legs.force, off, contact: 0.0 });
        })?;
        let Touchdown { time, state: vehicle, deck, .. } = end.touchdown;
        let start = Start {
            time,
            vehicle: with_quaternion(&vehicle),
            platform: end.platform,
            rotor_speed: landing.command_over(&deck, time, &vehicle.q, &vehicle.qd).rotors.speed,
        };
        let carrier = Carried { deck: landing.deck, drive, controlled: true };
        let (mut after, mut failed) = (Vec::new(), None);
        let settled =
            standing.simulate(&carrier, &start, |moment| match carrier.forces(moment.time, &moment.platform) {
                Ok(forces) => {
                    let off = moment.platform.q[2] - planned(moment.time);
                    let contact = moment.contact.normal.iter().sum();
                    after.push(Legs { time: moment.time, forces, off, contact });
                }
                Err(error) => failed = Some(error),
            })?;
        if let Some(error) = failed {
            return Err(error);
        }
        let greatest =
            |legs: &[Legs]| legs.iter().flat_map(|legs| legs.forces).fold(0.0_f64, |most, force| most.max(force.abs()));
        let greatest = [greatest(&legs), greatest(&after)];
        let last = &settled.last;
        let platform = &carrier.drive.platform;
        let directions = platform.legs(&last.platform.q)?.direction;
        let lift = |forces: &LegVector| (0..6).map(|i| forces[i] * directions[i][2]).sum::<f64>();
        let plan = carrier.deck.motion.at(last.time)[2];
        let alone = platform.leg_forces(&last.platform.q, &last.platform.qd, &plan)?;
        let added_lift = lift(&carrier.forces(last.time, &last.platform)?) - lift(&alone);
        let sag = planned(last.time) - last.platform.q[2];
        let push = last.contact.force.z;
        let params = standing.vehicle.params();
        let weight = params.m * params.g;
        legs.retain(|legs| legs.time > time - before);
        legs.extend(after);
        Ok(Stand { landing: end.touchdown, settled, legs, greatest, added_lift, push, weight, sag })
    }
}
