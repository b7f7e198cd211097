//! What the actuators allow: stroke, speed and force; and where a motion exceeds it.

use core::fmt;

use mbs_models::Error;
use mbs_models::check::{self, Invalid, Must};
use mbs_runtime::Scalar;

use super::{Coordinates, LegVector, Platform, PlatformMotion, Superposition};

/// Bounds of every leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorLimits {
    /// Length of a leg whose piston is all in \[m\].
    pub shortest: f64,
    /// Length of a leg whose piston is all out \[m\].
    pub longest: f64,
    /// Largest magnitude of the rate of a length \[m/s\].
    pub speed: f64,
    /// Largest magnitude of a force \[N\].
    pub force: f64,
}

impl ActuatorLimits {
    /// 1.05 m to 1.70 m, 0.6 m/s, 10 kN.
    ///
    /// # Source
    /// Assumed, of the size that a payload of 1500 kg asks for: no data of the manufacturer was at hand.
    pub const PS_6TL_1500: Self = Self { shortest: 1.05, longest: 1.70, speed: 0.6, force: 10e3 };

    /// Whether the stroke holds a length, and speed and force are positive; infinite ones are.
    ///
    /// # Errors
    /// [`Invalid`], the first that is not so.
    pub fn check(&self) -> Result<(), Invalid> {
        let Self { shortest, longest, speed, force } = *self;
        Must::BeAtLeast(0.0).check("shortest length", shortest)?;
        Must::BeAtLeast(shortest).check("longest length", longest)?;
        Must::BeMoreThan(0.0).check("largest speed", speed)?;
        Must::BeMoreThan(0.0).check("largest force", force)
    }

    /// Whether a leg of this length \[m\] is within the stroke; false for NaN.
    #[must_use]
    pub fn admits(&self, length: f64) -> bool {
        self.shortest <= length && length <= self.longest
    }

    /// The forces \[N\], each cut to what the actuator gives, for limits that pass the [check](Self::check).
    #[must_use]
    pub fn saturated(&self, forces: &LegVector) -> LegVector {
        // Where a force is NaN it stays so.
        forces.map(|force| match force {
            _ if force > self.force => self.force,
            _ if force < -self.force => -self.force,
            _ => force,
        })
    }

    /// What of these legs exceeds the limits, in order of legs.
    pub fn violations(self, time: f64, legs: LegState) -> impl Iterator<Item = Violation> {
        (0..6).flat_map(move |leg| {
            Quantity::ALL.into_iter().filter_map(move |quantity| {
                let (value, limit) = match quantity {
                    Quantity::TooShort => (legs.length[leg], self.shortest),
                    Quantity::TooLong => (legs.length[leg], self.longest),
                    Quantity::Speed => (legs.rate[leg], self.speed),
                    Quantity::Force => (legs.force[leg], self.force),
                };
                let violation = Violation { leg, quantity, time, value, limit };
                let is_within = violation.excess() <= 0.0;
                // NaN is not.
                (!is_within).then_some(violation)
            })
        })
    }
}

/// Which limit is exceeded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The length is below the stroke.
    TooShort,
    /// The length is above the stroke.
    TooLong,
    /// The rate of the length.
    Speed,
    /// The force.
    Force,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::TooShort, Self::TooLong, Self::Speed, Self::Force];

    /// `m`, `m/s` or `N`.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::TooShort | Self::TooLong => "m",
            Self::Speed => "m/s",
            Self::Force => "N",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TooShort | Self::TooLong => "stroke",
            Self::Speed => "speed",
            Self::Force => "force",
        })
    }
}

/// A limit that a leg exceeds at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// The leg, counted from 0.
    pub leg: usize,
    /// Which limit.
    pub quantity: Quantity,
    /// When \[s\].
    pub time: f64,
    /// What the leg has: m, m/s or N.
    pub value: f64,
    /// What it may have.
    pub limit: f64,
}

impl Violation {
    /// By how much the limit is exceeded; negative where it is kept.
    #[must_use]
    pub fn excess(&self) -> f64 {
        match self.quantity {
            Quantity::TooShort => self.limit - self.value,
            Quantity::TooLong => self.value - self.limit,
            Quantity::Speed | Quantity::Force => self.value.abs() - self.limit,
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { leg, quantity, time, value, limit } = self;
        let unit = quantity.unit();
        write!(f, "t = {time:.3} s, leg {}: {quantity} {value:.4} {unit}, the limit is {limit} {unit}", leg + 1)
    }
}

/// What the legs do at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegState<T = f64> {
    /// Lengths \[m\].
    pub length: LegVector<T>,
    /// Their rates \[m/s\].
    pub rate: LegVector<T>,
    /// Forces \[N\].
    pub force: LegVector<T>,
}

impl<T: Scalar> LegState<T> {
    /// What the actuators do \[W\]: `P_i = F_i l̇_i`, negative where a leg is pushed in against its force.
    ///
    /// The six together are the rate at which the energy of platform, payload and legs grows.
    #[must_use]
    pub fn power(&self) -> LegVector<T> {
        core::array::from_fn(|i| self.force[i] * self.rate[i])
    }
}

/// A value, the leg that has it, counted from 1, and when \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// In its unit.
    pub value: f64,
    /// Counted from 1; 0 of no leg.
    pub leg: usize,
    /// When \[s\].
    pub time: f64,
}

/// The least and the greatest value of any leg over samples with their times \[s\], each where it is first met.
pub fn extremes(samples: impl Iterator<Item = (f64, LegVector)>) -> [Extreme; 2] {
    let mut found = [f64::INFINITY, f64::NEG_INFINITY].map(|value| Extreme { value, leg: 0, time: 0.0 });
    for (time, legs) in samples {
        for (leg, value) in legs.into_iter().enumerate() {
            let here = Extreme { value, leg: leg + 1, time };
            if value < found[0].value {
                found[0] = here;
            }
            if value > found[1].value {
                found[1] = here;
            }
        }
    }
    found
}

/// Where a motion exceeds one limit of one leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Excess {
    /// The first sample at which it does.
    pub first: Violation,
    /// The sample at which it does most.
    pub worst: Violation,
}

/// What a motion asks of the platform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// By leg and [`Quantity::ALL`]; `None` where the limit is kept.
    pub excesses: [[Option<Excess>; 4]; 6],
    /// Shortest and longest length of any leg \[m\].
    pub length: [f64; 2],
    /// The largest speed of any leg \[m/s\].
    pub speed: f64,
    /// The largest magnitude of any force \[N\].
    pub force: f64,
    /// The largest condition of the Jacobian by twists, and when \[s\].
    pub condition: (f64, f64),
}

/// A survey has no more samples than this.
pub const MOST_SAMPLES: u32 = 10_000_000;

impl Default for Survey {
    /// No sample taken in.
    fn default() -> Self {
        Survey {
            excesses: [[None; 4]; 6],
            length: [f64::INFINITY, f64::NEG_INFINITY],
            speed: 0.0,
            force: 0.0,
            condition: (0.0, 0.0),
        }
    }
}

impl Survey {
    /// Takes in what the legs do at a moment, and the condition of the Jacobian by twists.
    pub fn add(&mut self, limits: &ActuatorLimits, t: f64, legs: &LegState, condition: f64) {
        for leg in 0..6 {
            self.length[0] = self.length[0].min(legs.length[leg]);
            self.length[1] = self.length[1].max(legs.length[leg]);
            self.speed = self.speed.max(legs.rate[leg].abs());
            self.force = self.force.max(legs.force[leg].abs());
        }
        if condition > self.condition.0 {
            self.condition = (condition, t);
        }
        for violation in limits.violations(t, *legs) {
            let place = Quantity::ALL.iter().position(|quantity| *quantity == violation.quantity).unwrap_or(0);
            let excess = &mut self.excesses[violation.leg][place];
            let known = excess.get_or_insert(Excess { first: violation, worst: violation });
            if violation.excess() > known.worst.excess() {
                known.worst = violation;
            }
        }
    }

    /// True where no limit is exceeded.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.excesses.as_flattened().iter().all(Option::is_none)
    }
}

impl Platform {
    /// Lengths, rates and forces of the legs for an imposed motion.
    ///
    /// # Errors
    /// [`Error`].
    pub fn leg_state(&self, q: &Coordinates, qd: &Coordinates, qdd: &Coordinates) -> Result<LegState, Error> {
        Ok(LegState { length: self.lengths(q)?, rate: self.leg_rates(q, qd)?, force: self.leg_forces(q, qd, qdd)? })
    }

    /// Whether the pose is in the workspace: all lengths within the stroke, and the pose not singular.
    ///
    /// # Errors
    /// [`Error`].
    pub fn reaches(&self, q: &Coordinates) -> Result<bool, Error> {
        let within = self.lengths(q)?.iter().all(|&length| self.limits.admits(length));
        Ok(within && !self.regularity(q)?.is_singular())
    }

    /// What the motion asks of the legs, sampled at `0, step, 2 step, …` up to `end` \[s\].
    ///
    /// # Errors
    /// [`Failure::Invalid`](mbs_models::Failure::Invalid) for samples or limits that there are not; of the first sample
    /// that has no legs or no forces, with its time.
    pub fn survey(&self, motion: &impl PlatformMotion, end: f64, step: f64) -> Result<Survey, Error> {
        check::positive("step", step)?;
        check::not_negative("end", end)?;
        Must::BeLessThan(f64::from(MOST_SAMPLES)).check("number of samples", end / step)?;
        self.limits.check()?;
        let mut survey = Survey::default();
        // Where the end is a multiple of the step but for rounding, it is the last sample.
        let last = (end / step * (1.0 + 4.0 * f64::EPSILON)) as u32;
        for sample in 0..=last {
            let t = (f64::from(sample) * step).min(end);
            let [q, qd, qdd] = motion.at(t);
            let pose = |error: Error| error.or_at_time(t);
            let legs = self.leg_state(&q, &qd, &qdd).map_err(pose)?;
            survey.add(&self.limits, t, &legs, self.regularity(&q).map_err(pose)?.condition);
        }
        Ok(survey)
    }

    /// The greatest factor up to 1 by which the motion can be scaled about its mean, so that the legs keep all limits
    /// at the samples `0, step, 2 step, …` up to `end` \[s\]; to a thousandth, rounded down.
    ///
    /// It is found by halving: a factor is taken to keep the limits where a greater one does. Zero where not even the
    /// mean keeps them. Factors at which a sample has no legs or no forces do not keep them.
    ///
    /// # Errors
    /// [`Failure::Invalid`](mbs_models::Failure::Invalid) for samples or limits that there are not; with its time where
    /// the mean has no legs or no forces.
    pub fn admissible_scale<const K: usize>(
        &self,
        motion: &Superposition<K>,
        end: f64,
        step: f64,
    ) -> Result<f64, Error> {
        let keeps = |thousandths: u32| match self.survey(&motion.scaled(f64::from(thousandths) / 1000.0), end, step) {
            Ok(survey) => Ok(survey.is_clear()),
            Err(Error { at: Some(_), .. }) if thousandths > 0 => Ok(false),
            Err(error) => Err(error),
        };
        if !keeps(0)? {
            return Ok(0.0);
        }
        if keeps(1000)? {
            return Ok(1.0);
        }
        let (mut good, mut bad) = (0, 1000);
        while bad - good > 1 {
            let middle = u32::midpoint(good, bad);
            if keeps(middle)? { good = middle } else { bad = middle }
        }
        Ok(f64::from(good) / 1000.0)
    }
}
