//! A mission from burn to burn.

use core::f64::consts::PI;

use super::super::clohessy_wiltshire::{self, Transfer};
use super::super::elements::Elements;
use super::super::lambert::{self, Route};
use super::super::lvlh::{Frame, RelativeMotion};
use super::super::vector::{StateVector, Vector, dot, minus, norm, plus, scaled};
use super::super::yamanaka_ankersen;
use super::glideslope::Glideslope;
use super::phasing::{Phasing, Plan};
use super::safety::{Zone, Zones};
use super::{Burn, LinearModel, Mission, Moment, Phase, PhaseReport, Report};
use mbs_models::{Error, Failure};

/// What there is not where no plan waits as little and stays as high as it is to.
const NO_PHASING: &str = "plan of phasing within the longest wait and above the lowest altitude";
/// How often the way is looked at far from the sphere \[s\].
const SPARSE: f64 = 20.0;
/// How often the way is looked at near to the sphere, at most \[s\].
const DENSE: f64 = 0.5;
/// How often the time of contact is halved: to less than the resolution of the clock.
const HALVINGS: u32 = 60;

pub(super) fn fly(
    mission: &Mission,
    thrust: impl FnMut(&Burn) -> Vector,
    observe: impl FnMut(&Moment),
) -> Result<Report, Error> {
    let warnings = mission.warnings()?;
    let relative = Frame::of(&mission.station)?.to_relative(&mission.vehicle);
    let mut flight = Flight {
        mission,
        zones: mission.zones(),
        thrust,
        observe,
        time: 0.0,
        motion: RelativeMotion { station: mission.station, relative },
        phase: Phase::Phasing,
        phases: [PhaseReport::default(); 5],
        zone: Zone::Outside,
        in_corridor: true,
        keep_out_violations: 0,
        corridor_violations: 0,
    };
    flight.look();
    let plan = flight.phasing()?;
    flight.begin(Phase::Homing);
    flight.leg(&mission.homing_end, mission.homing_duration)?;
    flight.begin(Phase::Closing);
    let gate = plus(&mission.port(), &scaled(mission.approach_distance, &mission.axis.outward()));
    flight.leg(&gate, mission.closing_duration)?;
    flight.begin(Phase::Approach);
    let [first, last] = mission.approach_speeds;
    let slope = Glideslope::new(mission.approach_distance - mission.docking_distance, first, last)?;
    flight.pulses(&slope, mission.docking_distance, mission.approach_pulses, mission.approach_pulses)?;
    flight.begin(Phase::Docking);
    let slope = Glideslope::new(mission.docking_distance, last, last)?;
    flight.pulses(&slope, 0.0, mission.docking_pulses, mission.docking_pulses - 1)?;
    let contact = flight.contact(&slope)?;
    flight.finish();
    Ok(Report {
        phases: flight.phases,
        plan,
        contact,
        keep_out_violations: flight.keep_out_violations,
        corridor_violations: flight.corridor_violations,
        warnings,
    })
}

struct Flight<'a, T, O> {
    mission: &'a Mission,
    zones: Zones,
    thrust: T,
    observe: O,
    time: f64,
    motion: RelativeMotion,
    phase: Phase,
    phases: [PhaseReport; 5],
    zone: Zone,
    in_corridor: bool,
    keep_out_violations: u32,
    corridor_violations: u32,
}

impl<T: FnMut(&Burn) -> Vector, O: FnMut(&Moment)> Flight<'_, T, O> {
    /// Up to a velocity that stays behind the station.
    fn phasing(&mut self) -> Result<Plan, Error> {
        let mission = self.mission;
        let phasing = Phasing {
            mu: mission.attraction.centre,
            station: mission.station,
            vehicle: mission.vehicle,
            lag: mission.behind / norm(&mission.station.velocity),
            longest_wait: mission.longest_wait,
            lowest: mission.surface + mission.lowest_altitude,
            tolerance: mission.phasing_tolerance,
        };
        let plan = phasing.plan()?.ok_or(Failure::Missing(NO_PHASING))?;
        self.coast(plan.wait)?;
        self.burn_to(&plan.departure)?;
        let arrival = plan.wait + plan.duration;
        let aim = phasing.aim(arrival)?;
        let route = Route::prograde().about(Frame::of(&mission.station)?.axes()[2]);
        for _ in 0..mission.corrections {
            self.coast(0.5 * (arrival - self.time))?;
            let here = self.inertial()?;
            let rest = arrival - self.time;
            let arc = lambert::arc(phasing.mu, &here.position, &aim.position, rest, &route)
                .map_err(|error| error.or_at_time(self.time))?;
            if norm(&minus(&arc.departure, &here.velocity)) >= mission.smallest_correction {
                self.burn_to(&arc.departure)?;
            }
        }
        self.coast(arrival - self.time)?;
        self.burn_to(&aim.velocity)?;
        Ok(plan)
    }

    /// To a place in a time, with corrections.
    fn leg(&mut self, to: &Vector, duration: f64) -> Result<(), Error> {
        let end = self.time + duration;
        self.aim_at(to, duration, 0.0)?;
        self.phases[self.phase as usize].drift_clearance = Some(self.drift_clearance()?);
        for _ in 0..self.mission.corrections {
            self.coast(0.5 * (end - self.time))?;
            self.aim_at(to, end - self.time, self.mission.smallest_correction)?;
        }
        self.coast(end - self.time)
    }

    /// Along the corridor: `pulses` pulses of a slope that ends `before` the port, of which some are flown to their
    /// end.
    fn pulses(&mut self, slope: &Glideslope, before: f64, pulses: u32, coasted: u32) -> Result<(), Error> {
        let start = self.time;
        let interval = slope.duration() / f64::from(pulses);
        for k in 1..=pulses {
            let due = interval * f64::from(k);
            let to_go = if k == pulses { before } else { before + slope.distance(due) };
            let place = plus(&self.zones.port, &scaled(to_go, &self.zones.outward));
            let rest = start + due - self.time;
            self.aim_at(&place, rest, 0.0)?;
            if k <= coasted {
                self.coast(rest)?;
            }
        }
        Ok(())
    }

    /// After the last pulse: to where the vehicle touches the plane of the port.
    fn contact(&mut self, slope: &Glideslope) -> Result<StateVector, Error> {
        let interval = slope.duration() / f64::from(self.mission.docking_pulses);
        let port = self.zones.port;
        let to_go = |zones: &Zones, motion: &RelativeMotion| zones.from_port(&motion.relative.position).0;
        // Close to the end, then in steps over the plane.
        self.coast(0.9 * interval)?;
        let step = 0.05 * interval;
        let mut left = 42;
        loop {
            let next = self.after(step)?;
            if to_go(&self.zones, &next) <= 0.0 {
                break;
            }
            self.coast(step)?;
            left -= 1;
            if left == 0 {
                return Err(Failure::NoContact { distance: to_go(&self.zones, &self.motion) }.at_time(self.time));
            }
        }
        let (mut low, mut high) = (0.0, step);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if to_go(&self.zones, &self.after(middle)?) > 0.0 { low = middle } else { high = middle }
        }
        self.coast(high)?;
        let StateVector { position, velocity } = self.motion.relative;
        let beside = minus(&position, &port);
        let distance = norm(&beside);
        // NaN has not arrived there either.
        if distance <= self.zones.keep_out.max(self.mission.port_distance) {
            Ok(StateVector::new(beside, velocity))
        } else {
            Err(Failure::Missed { distance }.at_time(self.time))
        }
    }

    /// A burn that leads to a place after a time, by the linear model; left out where it is smaller than `smallest`.
    fn aim_at(&mut self, to: &Vector, time: f64, smallest: f64) -> Result<(), Error> {
        let RelativeMotion { station, relative } = self.motion;
        let Transfer { departure, .. } = match self.mission.model {
            LinearModel::ClohessyWiltshire => {
                let n = Frame::of(&station)?.rate();
                clohessy_wiltshire::transfer(n, &relative.position, to, time)
                    .map_err(|error| error.or_at_time(self.time))?
            }
            LinearModel::YamanakaAnkersen => {
                yamanaka_ankersen::transfer(self.mission.attraction.centre, &station, &relative.position, to, time)
                    .map_err(|error| error.or_at_time(self.time))?
            }
        };
        let delta_v = minus(&departure, &relative.velocity);
        if norm(&delta_v) < smallest { Ok(()) } else { self.burn(delta_v) }
    }

    /// To an inertial velocity.
    fn burn_to(&mut self, velocity: &Vector) -> Result<(), Error> {
        let change = minus(velocity, &self.inertial()?.velocity);
        let frame = Frame::of(&self.motion.station)?;
        let delta_v = core::array::from_fn(|i| dot(&frame.axes()[i], &change));
        self.burn(delta_v)
    }

    fn burn(&mut self, delta_v: Vector) -> Result<(), Error> {
        let executed = (self.thrust)(&Burn { time: self.time, phase: self.phase, delta_v });
        let size = norm(&executed);
        if !size.is_finite() {
            return Err(Failure::NotFinite("what the thrusters give").at_time(self.time));
        }
        self.motion.relative.velocity = plus(&self.motion.relative.velocity, &executed);
        let report = &mut self.phases[self.phase as usize];
        report.delta_v += size;
        report.burns += 1;
        Ok(())
    }

    fn inertial(&self) -> Result<StateVector, Error> {
        Ok(Frame::of(&self.motion.station)?.to_inertial(&self.motion.relative))
    }

    fn after(&self, time: f64) -> Result<RelativeMotion, Error> {
        let coast = self.mission.attraction.coast(&self.motion, time);
        coast.map_err(|error| error.or_at_time(self.time))
    }

    /// Without burns for a time, looked at on the way.
    fn coast(&mut self, duration: f64) -> Result<(), Error> {
        let end = self.time + duration;
        while self.time < end {
            let step = self.looking_step();
            // The last step ends where it shall, and is not shorter than half of one.
            let rest = end - self.time;
            let step = if rest <= step { rest } else { step.min(0.5 * rest) };
            self.motion = self.after(step)?;
            self.time = if step == rest { end } else { self.time + step };
            self.look();
        }
        Ok(())
    }

    /// So that half of the way to the sphere is the most that is gone unseen; in the corridor always often.
    fn looking_step(&self) -> f64 {
        let StateVector { position, velocity } = &self.motion.relative;
        match self.phase {
            Phase::Approach | Phase::Docking => DENSE,
            Phase::Phasing | Phase::Homing | Phase::Closing => {
                (0.5 * (norm(position) - self.zones.keep_out) / norm(velocity)).clamp(DENSE, SPARSE)
            }
        }
    }

    fn look(&mut self) {
        let relative = self.motion.relative;
        let zone = self.zones.of(&relative.position);
        if zone == Zone::KeepOut && self.zone != Zone::KeepOut {
            self.keep_out_violations += 1;
        }
        let in_corridor = match self.phase {
            Phase::Phasing | Phase::Homing | Phase::Closing => true,
            Phase::Approach | Phase::Docking => self.zones.is_in_corridor(&relative.position),
        };
        if !in_corridor && self.in_corridor {
            self.corridor_violations += 1;
        }
        (self.zone, self.in_corridor) = (zone, in_corridor);
        (self.observe)(&Moment { time: self.time, phase: self.phase, relative, zone });
    }

    /// How near the vehicle comes within one revolution from now if nothing more is done \[m\].
    fn drift_clearance(&self) -> Result<f64, Error> {
        let elements = Elements::from_state(self.mission.attraction.centre, &self.motion.station);
        let revolution = elements?.period(self.mission.attraction.centre);
        let mut nearest = norm(&self.motion.relative.position);
        // Of an open orbit as long as one would take on a circle.
        let r = norm(&self.motion.station.position);
        let circle = 2.0 * PI * r / norm(&self.motion.station.velocity);
        let end = if revolution.is_finite() { revolution } else { circle };
        let (mut motion, mut gone) = (self.motion, 0.0);
        while gone < end {
            let StateVector { position, velocity } = &motion.relative;
            // A hundredth of the way to the station: so accurate is the nearest distance.
            let step = (0.01 * norm(position) / norm(velocity)).clamp(DENSE, SPARSE);
            motion =
                self.mission.attraction.coast(&motion, step).map_err(|error| error.or_at_time(self.time + gone))?;
            gone += step;
            nearest = nearest.min(norm(&motion.relative.position));
        }
        Ok(nearest)
    }

    fn begin(&mut self, phase: Phase) {
        self.finish();
        self.phase = phase;
    }

    fn finish(&mut self) {
        let before: f64 = self.phases.iter().map(|phase| phase.duration).sum();
        let report = &mut self.phases[self.phase as usize];
        report.duration = self.time - before;
        report.end = self.motion.relative;
    }
}
