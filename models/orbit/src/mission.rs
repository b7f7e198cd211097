//! Rendezvous and docking with a station: planned by linear models, flown in the nonlinear motion.
//!
//! | phase        | from … to                                  | planned by                                                         |
//! |--------------|--------------------------------------------|--------------------------------------------------------------------|
//! | phasing      | its own orbit … behind the station         | [`phasing`]: half an ellipse or Lambert's arc, whichever is cheaper    |
//! | homing       | … a few kilometres behind                  | two impulses of a [`LinearModel`], and corrections on the way            |
//! | closing      | … the beginning of the approach            | likewise                                                           |
//! | approach     | … a few metres from the port               | [`glideslope`] along the V-bar or the R-bar, many pulses             |
//! | docking      | … contact                                  | pulses at a steady speed                                             |
//!
//! Every burn is planned from the state as it is then, so that what the linear model neglects and what thrusters do
//! wrong is corrected later; what is left at the port is reported. [`coast`] is how the vehicle moves in between,
//! [`safety`] where it may be.
//!
//! Places and velocities are in the station's frame, [`lvlh`](super::lvlh): x away from the centre, y along the motion,
//! z normal.
//!
//! ```
//! use mbs_orbit::mission::{Axis, Mission};
//!
//! let report = Mission::to_the_station(Axis::VBar).fly(|burn| burn.delta_v, |_| {}).unwrap();
//! assert_eq!(report.keep_out_violations, 0);
//! assert!(report.port_position_error() < 1e-3);
//! ```
//!
//! # Source
//! Fehse, *Automated Rendezvous and Docking of Spacecraft*, 2003, chapters 2 and 3; the numbers of the scenario are
//! assumed.

pub mod coast;
mod flight;
pub mod glideslope;
pub mod phasing;
pub mod safety;

use core::f64::consts::PI;

use mbs_models::{Error, check};
use mbs_runtime::Scalar;

use super::elements::Elements;
use super::vector::{StateVector, Vector, norm, scaled};
use super::{EARTH_MU, EARTH_RADIUS};
use coast::Attraction;
use glideslope::Glideslope;
use phasing::Plan;
use safety::{Zone, Zones};

/// G times a mass of 420 t, a station's \[m³/s²\].
pub const STATION_ATTRACTION: f64 = 6.6743e-11 * 420_000.0;

/// No phase lasts longer \[s\]: it is looked at every few seconds.
const LONGEST: f64 = 1e7;
/// After this many halvings milliseconds are left of the time.
const MOST_CORRECTIONS: f64 = 20.0;
/// A corridor is a cone \[rad\].
const WIDEST: f64 = 89.0 / 180.0 * PI;

/// Along which axis of its frame the station is approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Along the motion, from behind: the port looks to −y.
    VBar,
    /// Along the radius, from below: the port looks to −x.
    RBar,
}

impl Axis {
    /// Unit vector out of the port.
    #[must_use]
    pub fn outward(self) -> Vector {
        match self {
            Axis::VBar => [0.0, -1.0, 0.0],
            Axis::RBar => [-1.0, 0.0, 0.0],
        }
    }
}

/// The linear equations that burns near the station are planned by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinearModel {
    /// For a station on a circle.
    ClohessyWiltshire,
    /// For a station on an ellipse.
    YamanakaAnkersen,
}

/// Parts of a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Phase {
    /// Up to the point behind the station.
    Phasing,
    /// From there to a few kilometres.
    Homing,
    /// From there to where the approach begins.
    Closing,
    /// Along the corridor.
    Approach,
    /// The last metres, up to contact.
    Docking,
}

impl Phase {
    /// In order.
    pub const ALL: [Self; 5] = [Self::Phasing, Self::Homing, Self::Closing, Self::Approach, Self::Docking];

    /// One word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Phase::Phasing => "phasing",
            Phase::Homing => "homing",
            Phase::Closing => "closing",
            Phase::Approach => "approach",
            Phase::Docking => "docking",
        }
    }
}

/// A rendezvous to be flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mission {
    /// What attracts, in the motion as it is.
    pub attraction: Attraction,
    /// Radius of the centre's surface \[m\].
    pub surface: f64,
    /// Inertial, at the beginning \[m, m/s\].
    pub station: StateVector,
    /// The vehicle, likewise.
    pub vehicle: StateVector,
    /// By which burns near the station are planned.
    pub model: LinearModel,
    /// Phasing ends so far behind the station, along its orbit \[m\].
    pub behind: f64,
    /// The longest wait before the first burn, like every duration at most 10⁷ \[s\].
    pub longest_wait: f64,
    /// No arc comes lower over the surface \[m\].
    pub lowest_altitude: f64,
    /// Phasing may aim so far beside its point; homing begins where it ends \[m\].
    pub phasing_tolerance: f64,
    /// Where homing ends \[m\].
    pub homing_end: Vector,
    /// How long it takes \[s\].
    pub homing_duration: f64,
    /// How long closing takes \[s\].
    pub closing_duration: f64,
    /// Corrections on the way of phasing, homing and closing each, at most 20: after half of the time, half of the
    /// rest, and so on.
    pub corrections: u32,
    /// Corrections that are smaller are left out \[m/s\].
    pub smallest_correction: f64,
    /// Along which axis the station is approached.
    pub axis: Axis,
    /// From the station's mass centre to the port \[m\].
    pub port_distance: f64,
    /// From the port to where the approach begins \[m\].
    pub approach_distance: f64,
    /// Speeds at both ends of the approach; the last is that of docking, too \[m/s\].
    pub approach_speeds: [f64; 2],
    /// Pulses of the approach.
    pub approach_pulses: u32,
    /// From the port to where docking begins \[m\].
    pub docking_distance: f64,
    /// Pulses of docking.
    pub docking_pulses: u32,
    /// Radius of the keep-out sphere \[m\].
    pub keep_out: f64,
    /// Half the opening of the approach corridor, at most 89° \[rad\].
    pub corridor_half_angle: f64,
    /// Radius of the corridor at the port \[m\].
    pub corridor_mouth: f64,
}

impl Mission {
    /// To a station on a circle 400 km up, inclined by 51.6°, from a circle 80 km lower, 18° behind and inclined by
    /// 0.01° more.
    ///
    /// All numbers but the station's altitude are assumed.
    #[must_use]
    pub fn to_the_station(axis: Axis) -> Self {
        const DEGREE: f64 = PI / 180.0;
        let circle = |altitude: f64, inclination: f64, argument: f64| {
            let r = EARTH_RADIUS + altitude;
            let v = Scalar::sqrt(EARTH_MU / r);
            let ((sin_i, cos_i), (sin, cos)) = (Scalar::sin_cos(inclination), Scalar::sin_cos(argument));
            StateVector::new([r * cos, r * sin * cos_i, r * sin * sin_i], [-v * sin, v * cos * cos_i, v * cos * sin_i])
        };
        Self {
            attraction: Attraction { centre: EARTH_MU, station: 0.0 },
            surface: EARTH_RADIUS,
            station: circle(400e3, 51.6 * DEGREE, 0.0),
            vehicle: circle(320e3, 51.61 * DEGREE, -18.0 * DEGREE),
            model: LinearModel::ClohessyWiltshire,
            behind: 30e3,
            longest_wait: 20_000.0,
            lowest_altitude: 150e3,
            phasing_tolerance: 5e3,
            // A vehicle that does not brake at the end of closing drifts past the sphere; to the R-bar only from below.
            homing_end: [if axis == Axis::RBar { -500.0 } else { 0.0 }, -2e3, 0.0],
            homing_duration: 2600.0,
            closing_duration: 2400.0,
            corrections: 3,
            smallest_correction: 1e-3,
            axis,
            port_distance: 15.0,
            approach_distance: 250.0,
            approach_speeds: [0.8, 0.05],
            approach_pulses: 20,
            docking_distance: 5.0,
            docking_pulses: 5,
            keep_out: 200.0,
            corridor_half_angle: 10.0 * DEGREE,
            corridor_mouth: 0.5,
        }
    }

    /// The port in the station's frame \[m\].
    #[must_use]
    pub fn port(&self) -> Vector {
        scaled(self.port_distance, &self.axis.outward())
    }

    /// Sphere and corridor.
    #[must_use]
    pub fn zones(&self) -> Zones {
        Zones {
            keep_out: self.keep_out,
            half_angle: self.corridor_half_angle,
            mouth: self.corridor_mouth,
            port: self.port(),
            outward: self.axis.outward(),
        }
    }

    /// What deserves a look before it is flown.
    ///
    /// # Errors
    /// [`Error`] where station or vehicle move along a straight line, or are not given by finite numbers.
    pub fn warnings(&self) -> Result<Warnings, Error> {
        let below = |state: &StateVector| -> Result<Option<f64>, Error> {
            let elements = Elements::from_state(self.attraction.centre, state)?;
            let altitude = elements.periapsis() - self.surface;
            Ok((altitude < 0.0).then_some(altitude))
        };
        Ok(Warnings { station_below_surface: below(&self.station)?, vehicle_below_surface: below(&self.vehicle)? })
    }

    /// Flies it.
    ///
    /// `thrust` receives every burn and returns what the thrusters make of it, in the same axes; `|burn| burn.delta_v`
    /// is what they should. `observe` sees the way, the closer the denser.
    ///
    /// # Errors
    /// [`Error`].
    pub fn fly(&self, thrust: impl FnMut(&Burn) -> Vector, observe: impl FnMut(&Moment)) -> Result<Report, Error> {
        self.check()?;
        flight::fly(self, thrust, observe)
    }

    fn check(&self) -> Result<(), Error> {
        let positive = [
            ("attraction.centre", self.attraction.centre),
            ("surface", self.surface),
            ("behind", self.behind),
            ("longest_wait", self.longest_wait),
            ("homing_duration", self.homing_duration),
            ("closing_duration", self.closing_duration),
            ("port_distance", self.port_distance),
            ("approach_distance", self.approach_distance),
            ("approach_pulses", f64::from(self.approach_pulses)),
            ("docking_distance", self.docking_distance),
            ("docking_pulses", f64::from(self.docking_pulses)),
            ("approach_distance - docking_distance", self.approach_distance - self.docking_distance),
            ("keep_out", self.keep_out),
            ("corridor_half_angle", self.corridor_half_angle),
        ];
        check::positive("approach_speeds", self.approach_speeds)?;
        check::each(check::positive, positive)?;
        let not_negative = [
            ("attraction.station", self.attraction.station),
            ("lowest_altitude", self.lowest_altitude),
            ("phasing_tolerance", self.phasing_tolerance),
            ("smallest_correction", self.smallest_correction),
            ("corridor_mouth", self.corridor_mouth),
            ("distance of homing_end", norm(&self.homing_end)),
        ];
        check::each(check::not_negative, not_negative)?;
        let [first, last] = self.approach_speeds;
        let approach = Glideslope::new(self.approach_distance - self.docking_distance, first, last)?;
        let docking = Glideslope::new(self.docking_distance, last, last)?;
        let at_most = [
            ("longest_wait", self.longest_wait, LONGEST),
            ("homing_duration", self.homing_duration, LONGEST),
            ("closing_duration", self.closing_duration, LONGEST),
            ("duration of the approach", approach.duration(), LONGEST),
            ("duration of docking", docking.duration(), LONGEST),
            ("corridor_half_angle", self.corridor_half_angle, WIDEST),
            ("corrections", f64::from(self.corrections), MOST_CORRECTIONS),
        ];
        at_most.into_iter().try_for_each(|(parameter, value, limit)| check::within(parameter, value, [0.0, limit]))?;
        Ok(())
    }
}

/// What deserves a look, with the altitude of the orbit's lowest point \[m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warnings {
    /// The orbit of the station goes through the surface.
    pub station_below_surface: Option<f64>,
    /// That of the vehicle, before its first burn.
    pub vehicle_below_surface: Option<f64>,
}

/// A burn, an instantaneous change of velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burn {
    /// Since the beginning \[s\].
    pub time: f64,
    /// To which it belongs.
    pub phase: Phase,
    /// As planned, in the axes of the station's frame \[m/s\].
    pub delta_v: Vector,
}

/// Errors with which thrusters execute a burn, by standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrusterErrors {
    /// The standard deviation of the size, relative.
    pub size: f64,
    /// The standard deviation of the direction, about each axis \[rad\].
    pub direction: f64,
}

impl ThrusterErrors {
    /// What becomes of a burn \[m/s\]; `normal` gives random numbers of the standard normal distribution, of which it
    /// takes four.
    pub fn executed(&self, [x, y, z]: Vector, mut normal: impl FnMut() -> f64) -> Vector {
        let size = 1.0 + self.size * normal();
        let [a, b, c] = [(); 3].map(|()| self.direction * normal());
        // Turned by a small vector.
        [size * (x + b * z - c * y), size * (y + c * x - a * z), size * (z + a * y - b * x)]
    }
}

/// The vehicle on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Since the beginning \[s\].
    pub time: f64,
    /// What is flown.
    pub phase: Phase,
    /// In the station's frame \[m, m/s\].
    pub relative: StateVector,
    /// Where that is.
    pub zone: Zone,
}

/// One phase as it was flown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseReport {
    /// What the burns changed, as executed \[m/s\].
    pub delta_v: f64,
    /// How many.
    pub burns: u32,
    /// The duration \[s\].
    pub duration: f64,
    /// In the station's frame, before the next phase begins \[m, m/s\].
    pub end: StateVector,
    /// For homing and closing: how near the vehicle would come to the station's mass centre within one revolution if
    /// after the first burn there were no other \[m\].
    pub drift_clearance: Option<f64>,
}

/// A mission as it was flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// In the order of [`Phase::ALL`].
    pub phases: [PhaseReport; 5],
    /// How phasing was done.
    pub plan: Plan,
    /// Where it touched the plane of the port, relative to the port, and how fast \[m, m/s\].
    pub contact: StateVector,
    /// How often the vehicle came into the keep-out sphere beside the corridor.
    pub keep_out_violations: u32,
    /// How often it left the corridor between the beginning of the approach and contact.
    pub corridor_violations: u32,
    /// The warnings about the orbits.
    pub warnings: Warnings,
}

impl Report {
    /// All burns \[m/s\].
    #[must_use]
    pub fn total_delta_v(&self) -> f64 {
        self.phases.iter().map(|phase| phase.delta_v).sum()
    }

    /// From the beginning to contact \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|phase| phase.duration).sum()
    }

    /// Distance from the middle of the port at contact \[m\].
    #[must_use]
    pub fn port_position_error(&self) -> f64 {
        norm(&self.contact.position)
    }

    /// Relative speed at contact \[m/s\].
    #[must_use]
    pub fn port_velocity(&self) -> f64 {
        norm(&self.contact.velocity)
    }
}
