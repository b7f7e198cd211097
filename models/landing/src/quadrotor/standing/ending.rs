//! How it ends: rest, sliding, tip-over told apart, and the extremes on the way.

use mbs_models::quadrotor_quaternion::QuadrotorQuaternion;
use mbs_runtime::{Scalar, State, to_matrix};
use nalgebra::Vector3;

use super::{Moment, twist};
use crate::quadrotor::gear::Gear;

/// What counts as rest against the deck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Still {
    /// Of the mass centre, at most \[m/s\].
    pub speed: f64,
    /// Angular velocity, at most \[rad/s\].
    pub rate: f64,
    /// For so long \[s\].
    pub duration: f64,
}

impl Default for Still {
    /// 5 mm/s and 0.02 rad/s for two seconds, assumed.
    fn default() -> Self {
        Still { speed: 0.005, rate: 0.02, duration: 2.0 }
    }
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// It stands, and has done so since this time \[s\].
    Rest {
        /// Since when \[s\].
        since: f64,
    },
    /// It tipped over at this time \[s\].
    TippedOver {
        /// The time \[s\].
        time: f64,
    },
    /// It still slides when the time is over: feet on the deck move along it faster than they creep.
    Sliding,
    /// It is off the deck when the time is over.
    Airborne,
    /// It rocks, sinks or creeps on its feet when the time is over.
    Moving,
}

/// A vehicle that has come down, and what happened on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settled {
    /// How it ended.
    pub ending: Ending,
    /// When a foot touched first \[s\]; never, where none did.
    pub first_touch: Option<f64>,
    /// How often it touched with all feet off before.
    pub touches: usize,
    /// How often all feet left the deck after they had touched.
    pub rebounds: usize,
    /// The longest way of a foot along the deck \[m\].
    pub slid: f64,
    /// How far the mass centre has come along the deck since the beginning, as the deck sees it \[m\].
    pub displaced: f64,
    /// The greatest force of a leg along the deck's normal \[N\], at the milliseconds.
    pub greatest_leg_force: f64,
    /// The greatest one of all four \[N\].
    pub greatest_force: f64,
    /// The greatest depth of a foot \[m\].
    pub greatest_depth: f64,
    /// The greatest tilt against the deck \[rad\].
    pub greatest_tilt: f64,
    /// The greatest change of the balance of energy, over the greatest energy that was dissipated, moved or stored.
    pub energy_error: f64,
    /// The end.
    pub last: Moment,
}

/// Between the vehicle's vertical axis and the deck's normal \[rad\].
pub(super) fn tilt(moment: &Moment, vehicle: &QuadrotorQuaternion<f64>) -> f64 {
    let own: Vector3<f64> = twist(vehicle, &moment.vehicle).rotation.column(2).into_owned();
    let normal: Vector3<f64> = to_matrix(&moment.deck.rotation).column(2).into_owned();
    let across = own.cross(&normal);
    Scalar::atan2(Scalar::sqrt(across.dot(&across)), own.dot(&normal))
}

/// Feet that creep are slower than this many creep speeds.
const CREEPING: f64 = 10.0;

/// What is gathered on the way.
pub(super) struct Watch {
    /// Since when it has been still.
    since: Option<f64>,
    rest: Option<f64>,
    start: f64,
    /// The mass centre as the deck saw it.
    place: Option<[f64; 2]>,
    /// At the beginning \[J\].
    energy: Option<f64>,
    balance: Option<f64>,
    error: f64,
    turnover: f64,
    leg_force: f64,
    force: f64,
    depth: f64,
    tilt: f64,
}

impl Watch {
    pub(super) fn new(start: f64) -> Self {
        Watch {
            since: None,
            rest: None,
            start,
            place: None,
            energy: None,
            balance: None,
            error: 0.0,
            turnover: 0.0,
            leg_force: 0.0,
            force: 0.0,
            depth: 0.0,
            tilt: 0.0,
        }
    }

    /// Whether it has been at rest for long enough; not while its rotors are running.
    pub(super) fn see(
        &mut self,
        moment: &Moment,
        vehicle: &QuadrotorQuaternion<f64>,
        still: &Still,
        running: bool,
    ) -> bool {
        self.gather(moment, vehicle);
        let ([x, y, z], turning) = against(moment, vehicle);
        let speed = Scalar::sqrt(x * x + y * y + z * z);
        let standing = moment.contact.normal.iter().filter(|&&normal| normal > 0.0).count() >= 3;
        if running || !standing || speed > still.speed || turning > still.rate {
            self.since = None;
            return false;
        }
        let since = *self.since.get_or_insert(moment.time);
        if moment.time - since >= still.duration {
            self.rest = Some(since);
        }
        self.rest.is_some()
    }

    fn gather(&mut self, moment: &Moment, vehicle: &QuadrotorQuaternion<f64>) {
        let contact = &moment.contact;
        self.place.get_or_insert(place(moment));
        self.leg_force = contact.normal.iter().copied().fold(self.leg_force, f64::max);
        self.force = self.force.max(contact.normal.iter().sum());
        self.depth = self.depth.max(contact.deepest());
        self.tilt = self.tilt.max(tilt(moment, vehicle));
        let balance = *self.balance.get_or_insert(moment.balance());
        self.error = self.error.max((moment.balance() - balance).abs());
        for turned in
            [moment.energy - *self.energy.get_or_insert(moment.energy), contact.stored, moment.dissipated, moment.work]
        {
            self.turnover = self.turnover.max(turned.abs());
        }
    }

    pub(super) fn settled(
        mut self,
        last: &Moment,
        vehicle: &QuadrotorQuaternion<f64>,
        gear: &Gear,
        first_touch: Option<f64>,
        [touches, rebounds]: [usize; 2],
        tipped: bool,
    ) -> Settled {
        self.gather(last, vehicle);
        let slips = last.contact.slip.iter().zip(&last.contact.normal).filter(|(_, normal)| **normal > 0.0);
        let fastest = slips.map(|(slip, _)| *slip).fold(0.0, f64::max);
        let ending = match self.rest {
            Some(since) => Ending::Rest { since },
            None if tipped => Ending::TippedOver { time: last.time },
            None if last.contact.deepest() < 0.0 => Ending::Airborne,
            None if fastest > CREEPING * gear.creep_speed => Ending::Sliding,
            None => Ending::Moving,
        };
        let ([x, y], [x_start, y_start]) = (place(last), self.place.unwrap_or_default());
        let [dx, dy] = [x - x_start, y - y_start];
        Settled {
            ending,
            first_touch: first_touch.filter(|time| *time >= self.start),
            touches,
            rebounds,
            slid: last.slid.into_iter().fold(0.0, f64::max),
            displaced: Scalar::sqrt(dx * dx + dy * dy),
            greatest_leg_force: self.leg_force,
            greatest_force: self.force,
            greatest_depth: self.depth,
            greatest_tilt: self.tilt,
            energy_error: if self.turnover > 0.0 { self.error / self.turnover } else { self.error },
            last: *last,
        }
    }
}

/// The mass centre in the plane of the deck \[m\].
fn place(Moment { vehicle: State { q, .. }, deck, .. }: &Moment) -> [f64; 2] {
    let offset = Vector3::new(q[0], q[1], q[2]) - Vector3::from(deck.position);
    let seen = to_matrix(&deck.rotation).tr_mul(&offset);
    [seen.x, seen.y]
}

/// Velocity of the mass centre against the deck \[m/s\], and the size of the angular velocity against it \[rad/s\].
fn against(moment: &Moment, vehicle: &QuadrotorQuaternion<f64>) -> ([f64; 3], f64) {
    let (own, deck) = (twist(vehicle, &moment.vehicle), &moment.deck);
    let turning = Vector3::from(deck.angular_velocity);
    let velocity =
        own.velocity - Vector3::from(deck.velocity) - turning.cross(&(own.position - Vector3::from(deck.position)));
    let rate = own.angular_velocity - turning;
    (velocity.into(), Scalar::sqrt(rate.dot(&rate)))
}
